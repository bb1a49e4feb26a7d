//! `ruga new --mesh`: a scene for somebody's own mesh.

#![allow(clippy::print_stdout, reason = "a test that is skipped says so")]

mod fixture;

use std::path::{Path, PathBuf};

use fixture::Folder;

fn shared(name: &str) -> Option<PathBuf> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let path = data.join(name);
    let found = path.is_file();
    if !found {
        println!("{} is not there; skipped", path.display());
    }
    found.then_some(path)
}

/// Writes a scene for the mesh and plans it.
fn planned(folder: &Folder, mesh: &str) -> String {
    let run = folder.ruga(&format!("new --mesh {mesh} made")).exits(0);
    assert!(run.stdout.contains("ruga plan made"), "{}", run.stdout);
    assert_eq!(folder.files("made"), ["scene.toml"]);
    folder.ruga("plan made/scene.toml").exits(0);
    String::from_utf8(folder.read("made/scene.toml")).expect("text")
}

#[test]
fn the_forearm_again() {
    let folder = Folder::new();
    folder.ruga("new arm").exits(0);
    let scene = planned(&folder, "arm/forearm.glb");
    for line in [
        "mesh = \"../arm/forearm.glb\"",
        "mesh_name = \"Forearm\"",
        "preset = \"forehead-furrow\"",
        "weights = { \"twist\" = 1.0 }",
    ] {
        assert!(scene.contains(line), "no `{line}` in:\n{scene}");
    }
    assert!(!scene.contains("scale ="), "{scene}");
    // Once more, over nothing.
    folder
        .ruga("new --mesh arm/forearm.glb made")
        .exits(2)
        .says(&["made/scene.toml", "exists already"]);
}

#[test]
fn the_shared_face_and_hand() {
    for (name, preset) in [
        ("ict-facekit/ict_face_arkit.glb", "forehead-furrow"),
        ("makehuman-hand/mh_hand_forearm.glb", "knuckle"),
    ] {
        let Some(path) = shared(name) else { continue };
        let folder = Folder::new();
        // Written only: planning four poses of a face takes too long for a test.
        let path = path.to_string_lossy();
        folder.ruga(&format!("new --mesh {path} made")).exits(0);
        let scene = String::from_utf8(folder.read("made/scene.toml")).expect("text");
        ruga_scene::SceneFile::from_toml(&scene, "made/scene.toml".as_ref())
            .expect("a sound scene");
        assert!(scene.contains(&format!("preset = \"{preset}\"")), "{scene}");
        assert!(scene.contains("[[poses]]"), "{scene}");
    }
}

#[test]
fn a_mesh_that_nothing_moves() {
    let folder = Folder::new();
    folder.ruga("new --mesh patch.obj made").exits(2).says(&[
        "patch.obj",
        "no blend shapes",
        "ruga help scene",
    ]);
    assert!(!folder.path("made").exists());
}

#[test]
fn a_mesh_given_as_scene_is_sent_here() {
    let folder = Folder::new();
    folder.ruga("new arm").exits(0);
    folder
        .ruga("plan arm/forearm.glb")
        .exits(2)
        .says(&["this is a mesh", "`ruga new --mesh arm/forearm.glb DIR`"]);
}

/// Comments name files that are there.
#[test]
fn what_is_written_does_not_speak_of_our_folders() {
    let folder = Folder::new();
    for template in ["forearm", "finger"] {
        folder
            .ruga(&format!("new {template} --template {template}"))
            .exits(0);
        let scene = folder.read(&format!("{template}/scene.toml"));
        let scene = String::from_utf8(scene).expect("text");
        assert!(!scene.contains("assets/"), "{scene}");
        assert!(scene.contains("ruga plan scene.toml"), "{scene}");
    }
}
