//! `[pack]`: maps and masks in `packed`, what stands in `pack.json`, and what is refused.

mod fixture;

use fixture::Folder;
use ruga_bake::{POSES_PER_MASK, unpack};
use ruga_io::read_image;
use serde_json::Value;

/// A scene of two poses that overlap, packed into so many maps.
fn folder(maps: u32, more: &str) -> Folder {
    let folder = Folder::new();
    let second = "[[poses]]\nname = \"browDown_L\"\nweights = { squeeze = 0.8 }\nsteps = 2\n";
    folder.change("scene.toml", "[remesh]", &format!("{second}[remesh]"));
    folder.change("scene.toml", "squeezed", "browInnerUp_L");
    let pack = format!("[pack]\nmaps = {maps}\n{more}\n[bake]");
    folder.change("scene.toml", "[bake]", &pack);
    folder
}

/// A channel of a mask image.
fn mask(folder: &Folder, file: &Value, channel: &str) -> Vec<u8> {
    let path = folder
        .path("out/packed")
        .join(file.as_str().expect("a mask image with this channel"));
    let decoder = png::Decoder::new(std::io::BufReader::new(
        std::fs::File::open(path).expect("a mask image with this channel"),
    ));
    let mut reader = decoder.read_info().expect("a mask image with this channel");
    let mut texels = vec![
        0;
        reader
            .output_buffer_size()
            .expect("a mask image with this channel")
    ];
    reader
        .next_frame(&mut texels)
        .expect("a mask image with this channel");
    let number = "rgba"
        .find(channel)
        .expect("a mask image with this channel");
    texels
        .into_iter()
        .skip(number)
        .step_by(POSES_PER_MASK)
        .collect()
}

#[test]
fn every_pose_comes_back_from_the_packed_maps() {
    let folder = folder(2, "names = \"arkit\"");
    folder
        .ruga("bake scene.toml -o out --quality draft")
        .exits(0);
    let pack = folder.json("out/packed/pack.json");
    assert_eq!(pack["version"], 1);
    assert_eq!(pack["maps"].as_array().unwrap().len(), 2);
    let files = folder.files("out/packed");
    assert!(
        files.contains(&"Patch_wm2_normal_gl.png".to_owned()),
        "{files:?}"
    );
    for (pose, name) in [
        ("browInnerUp_L", "browInnerUp"),
        ("browDown_L", "browDownLeft"),
    ] {
        let packed = &pack["poses"][pose];
        assert_eq!(packed["name"], name);
        let map = &pack["maps"][packed["map"].as_u64().unwrap() as usize];
        let file = &map["masks"][packed["mask"].as_u64().unwrap() as usize];
        let mask = mask(&folder, file, packed["channel"].as_str().unwrap());
        assert!(mask.contains(&255));
        let image = &map["images"][0];
        let neutral = image["neutral"].as_array().unwrap();
        let neutral: Vec<f32> = neutral.iter().map(|n| n.as_f64().unwrap() as f32).collect();
        let path = folder
            .path("out/packed")
            .join(image["file"].as_str().unwrap());
        let found = unpack(&read_image(&path).unwrap().values, &neutral, mask);
        let own = folder.path(format!("out/maps/{pose}_100_normal.png"));
        let own = read_image(&own).unwrap().values;
        let worst = found
            .iter()
            .zip(&own)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f32::max);
        assert!(worst < 1.0 / 255.0, "{worst}");
        // Half way, wrinkles are less deep, and none are there at rest.
        let curve = packed["curve"].as_array().unwrap();
        let strengths = curve.iter().map(|point| point[1].as_f64().unwrap());
        let strengths: Vec<f64> = strengths.collect();
        assert_eq!((strengths[0], strengths[2]), (0.0, 1.0));
        assert!(strengths[1] > 0.1 && strengths[1] < 0.95, "{strengths:?}");
    }
}

#[test]
fn too_few_maps_are_refused_and_nothing_is_packed() {
    let folder = folder(1, "");
    let run = folder
        .ruga("bake scene.toml -o out --quality draft")
        .exits(2);
    for part in [
        "`pack.maps`: found 1",
        "`browInnerUp_L`, `browDown_L` overlap",
        "2 maps can",
    ] {
        assert!(run.stderr.contains(part), "{part}: {}", run.stderr);
    }
    assert!(!folder.path("out/packed").exists());
    // The maps themselves are there, and with one more map they need not be baked again.
    folder.change("scene.toml", "maps = 1", "maps = 2");
    let run = folder
        .ruga("bake scene.toml -o out --quality draft --resume")
        .exits(0);
    assert!(
        run.stderr.contains("is there from an earlier run"),
        "{}",
        run.stderr
    );
    assert!(folder.path("out/packed/pack.json").exists());
    assert!(folder.files("out/packed").len() > 2);
    // What was packed is of maps that were there then, and goes when it cannot be made anew.
    folder.change("scene.toml", "maps = 2", "maps = 1");
    folder
        .ruga("bake scene.toml -o out --quality draft --resume")
        .exits(2);
    assert!(folder.files("out/packed").is_empty());
}

#[test]
fn names_that_collide_are_refused_before_anything_is_baked() {
    let folder = folder(2, "names = \"arkit\"");
    folder.change("scene.toml", "browDown_L", "browInnerUp_R");
    let run = folder.ruga("bake scene.toml -o out").exits(2);
    let wanted = "poses `browInnerUp_L` and `browInnerUp_R` would both be `browInnerUp`";
    assert!(run.stderr.contains(wanted), "{}", run.stderr);
    assert!(!folder.path("out").exists());
}
