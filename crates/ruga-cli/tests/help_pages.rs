//! `ruga help`: the reference of scenes and presets, and its pages in `docs/`.

mod fixture;

use std::fs;
use std::path::Path;

use fixture::Folder;

#[test]
fn pages_in_docs_are_what_the_command_says() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    for topic in ["scene", "presets"] {
        let said = Folder::new().ruga(&format!("help {topic}")).exits(0).stdout;
        let page = docs.join(format!("{topic}.md"));
        let kept = fs::read_to_string(&page).unwrap_or_default();
        assert!(
            kept.replace("\r\n", "\n") == said,
            "docs/{topic}.md is old; renew it with `cargo run -- help {topic} > docs/{topic}.md`"
        );
    }
}

#[test]
fn the_example_is_a_scene() {
    let page = Folder::new().ruga("help scene").exits(0).stdout;
    let example = page
        .split("```")
        .nth(1)
        .and_then(|it| it.strip_prefix("toml\n"));
    let text = example.expect("an example");
    let scene = ruga_scene::SceneFile::from_toml(text, Path::new("scene.toml"));
    assert_eq!(scene.expect("a scene").poses[0].name, "frown");
}

#[test]
fn keys_have_their_defaults_and_presets_their_numbers() {
    let scene = Folder::new().ruga("help scene").exits(0).stdout;
    for text in [
        "## `[[layers]]`",
        "- `mask` (text, optional): Grey image over the UV square",
        "- `strength` (number, default `1.0`)",
        "- `mesh` (text, needed)",
        "- `scale` (number, optional): Metres per unit of the mesh file",
        "  - `\"composite\"`:",
        "## `[[interior.handles]]`",
    ] {
        assert!(scene.contains(text), "no `{text}` in:\n{scene}");
    }
    let presets = Folder::new().ruga("help presets").exits(0).stdout;
    for preset in &ruga_material::PRESETS {
        assert!(presets.contains(&format!("## `{}`", preset.name)));
    }
    assert!(presets.contains("thickness = 7e-4"), "{presets}");
}

#[test]
fn help_still_explains_commands() {
    let folder = Folder::new();
    let all = folder.ruga("help").exits(0).stdout;
    assert_eq!(all, folder.ruga("--help").exits(0).stdout);
    assert!(all.contains("ruga help scene"), "{all}");
    let bake = folder.ruga("help bake").exits(0).stdout;
    assert!(
        bake.contains("--quality") && bake.contains("ruga bake"),
        "{bake}"
    );
    folder.ruga("help nose").exits(2).says(&["nose", "presets"]);
}
