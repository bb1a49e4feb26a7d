//! A few random inputs for everything that reads; `cargo xtask fuzz` tries as many as one likes.

use std::path::Path;

use ruga_tests::{Target, Verdict};

/// Tries inputs; each must be refused or taken, and some of both.
fn try_all(target: Target, numbers: impl IntoIterator<Item = u64>) {
    let fuzzer = Path::new(env!("CARGO_BIN_EXE_fuzz"));
    let [mut accepted, mut rejected] = [0; 2];
    for number in numbers {
        let folder = tempfile::tempdir().expect("a temporary folder");
        match target.try_input(number, folder.path(), fuzzer) {
            Verdict::Accepted => accepted += 1,
            Verdict::Rejected => rejected += 1,
            Verdict::Find(what) => panic!("{}-{number}: {what}", target.name()),
        }
    }
    assert!(accepted > 0 && rejected > 0, "{accepted} {rejected}");
}

#[test]
fn scenes_are_read_or_refused() {
    try_all(Target::Scene, 0..150);
}

#[test]
fn meshes_are_read_or_refused() {
    try_all(Target::Gltf, 0..100);
    try_all(Target::Obj, 0..100);
}

#[test]
fn images_are_read_or_refused() {
    try_all(Target::Png, 0..200);
    try_all(Target::Exr, 0..100);
}

#[test]
fn meshes_are_fitted_or_refused() {
    try_all(Target::Remesh, 0..150);
}

#[test]
fn scenes_are_baked_or_refused() {
    // Chosen for being quick.
    try_all(Target::Program, 200..212);
}
