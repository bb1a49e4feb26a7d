//! No damage to a scene makes its reader panic, or return what it would not read again.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod fixture;

use fixture::{Folder, SCENE};
use proptest::prelude::*;
use ruga_scene::SceneFile;

/// Bytes to overwrite, and where to cut.
fn damage() -> impl Strategy<Value = (Vec<(usize, u8)>, Option<usize>)> {
    (
        prop::collection::vec((any::<usize>(), any::<u8>()), 1..6),
        prop::option::weighted(0.2, any::<usize>()),
    )
}

fn apply(bytes: &[u8], (writes, cut): &(Vec<(usize, u8)>, Option<usize>)) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for (at, value) in writes {
        let at = at % bytes.len();
        bytes[at] = *value;
    }
    if let Some(cut) = cut {
        bytes.truncate(cut % (bytes.len() + 1));
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_scene(damage in damage()) {
        let folder = Folder::new();
        let path = folder.file("scene.toml", apply(SCENE.as_bytes(), &damage));
        if let Ok(scene) = SceneFile::read(&path) {
            prop_assert!(SceneFile::from_toml(&scene.to_toml(), &path).is_ok());
        }
    }
}
