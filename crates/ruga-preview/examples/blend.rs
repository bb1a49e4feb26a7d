//! Blends the normal maps of a baked folder as engines should, for comparison: `blend BAKED OUT [POSE=WEIGHT+...]...`
//! writes `OUT/POSE=WEIGHT+....png` of 8 bits; without names each pose at .5 and 1, the first two together and .3.

#![allow(clippy::print_stdout, reason = "an example reports what it wrote")]

use std::error::Error;
use std::path::Path;

use ruga_bake::{KeyNormals, between_keys, lay_over};
use ruga_io::{MapKind, NormalY, PngTexels, WrinkleMap, Wrinkles, read_image, write_png};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [baked, out, wishes @ ..] = &arguments[..] else {
        return Err("blend BAKED OUT [POSE=WEIGHT+...]...".into());
    };
    let baked = Path::new(baked);
    let text = std::fs::read_to_string(baked.join("wrinkles.json"))?;
    let manifest: Wrinkles = serde_json::from_str(&text)?;
    let mut wishes = wishes.to_vec();
    if wishes.is_empty() {
        wishes = all_poses(&manifest);
    }
    for wish in &wishes {
        let normals = blended(baked, &manifest, wish)?;
        let code = |c: f32| (255.0 * (0.5 * c + 0.5)).round() as u8;
        let texels: Vec<u8> = normals.iter().flatten().map(|&c| code(c)).collect();
        let side = manifest.size as usize;
        let path = Path::new(out).join(format!("{wish}.png"));
        write_png(&path, side, side, PngTexels::Rgb8(&texels))?;
        println!("{}", path.display());
    }
    Ok(())
}

/// Each pose half and whole, and blends of the first two.
fn all_poses(manifest: &Wrinkles) -> Vec<String> {
    let names: Vec<&String> = manifest.poses.keys().collect();
    let mut wishes: Vec<String> = names
        .iter()
        .flat_map(|name| [format!("{name}=0.5"), format!("{name}=1")])
        .collect();
    if let [first, second, ..] = &names[..] {
        wishes.push(format!("{first}=0.5+{second}=1"));
        wishes.push(format!("{first}=0.3+{second}=0.8"));
    }
    wishes
}

/// Poses over each other in the order in which the manifest lists their maps.
fn blended(baked: &Path, manifest: &Wrinkles, wish: &str) -> Result<Vec<[f32; 3]>, Box<dyn Error>> {
    let texels = manifest.size as usize * manifest.size as usize;
    let mut blend = vec![[0.0, 0.0, 1.0]; texels];
    let mut weights = Vec::new();
    for part in wish.split('+') {
        let (pose, weight) = part.split_once('=').ok_or("expected POSE=WEIGHT")?;
        let maps = manifest
            .maps
            .iter()
            .filter(|map| map.kind == MapKind::Normal);
        let first = maps.clone().position(|map| map.pose == pose);
        weights.push((first.ok_or("no such pose")?, pose, weight.parse::<f64>()?));
    }
    weights.sort_by_key(|(first, ..)| *first);
    for (_, pose, weight) in weights {
        let maps = manifest.maps.iter();
        let of_pose = maps.filter(|map| map.kind == MapKind::Normal && map.pose == pose);
        let mut keys = Vec::new();
        for map in of_pose {
            keys.push((map.key, normals_of(baked, map)?));
        }
        let keys: Vec<KeyNormals<'_>> = keys
            .iter()
            .map(|(key, normals)| KeyNormals { key: *key, normals })
            .collect();
        lay_over(&mut blend, &between_keys(&keys, weight))?;
    }
    Ok(blend)
}

fn normals_of(baked: &Path, map: &WrinkleMap) -> Result<Vec<[f32; 3]>, Box<dyn Error>> {
    let image = read_image(&baked.join(&map.files()[0]))?;
    let up = if map.green == Some(NormalY::Down) {
        -1.0
    } else {
        1.0
    };
    let is_coded = map.neutral[0] > 0.0;
    let decoded = |c: f32| if is_coded { 2.0 * c - 1.0 } else { c };
    let texels = image.values.chunks_exact(3);
    Ok(texels
        .map(|n| [decoded(n[0]), up * decoded(n[1]), decoded(n[2])])
        .collect())
}
