//! Time of a bake on one thread (so: CPU time), and the accuracy that it buys.
//!
//! `cargo bench -p ruga-bake`. For comparison, Blender 4.5 takes 3.6 to 4.3 CPU seconds for the
//! 2048 map of 100 thousand triangles and is 0.97 degrees off.

#![allow(missing_docs, reason = "criterion's macros make public functions")]
#![allow(clippy::print_stdout, reason = "the accuracy is part of the result")]

#[path = "../tests/patch/mod.rs"]
mod patch;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::Vector3;
use patch::{Driver, Patch, baked, degrees, rms, texel_parameters, waves};
use ruga_bake::{BakeSettings, WrinkleMap, bake, check_uvs};

/// RMS error on the flat patch, degrees.
fn error(map: &WrinkleMap) -> f64 {
    let h = 1e-7;
    rms((0..map.normals.len()).step_by(7).map(|texel| {
        let [s, t] = texel_parameters(map, texel);
        let ds = (waves(s + h, t) - waves(s - h, t)) / (2.0 * h);
        let dt = (waves(s, t + h) - waves(s, t - h)) / (2.0 * h);
        degrees(&baked(map, texel), &Vector3::new(-ds, -dt, 1.0).normalize())
    }))
}

fn bakes(criterion: &mut Criterion) {
    let one_thread = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a pool of one thread");
    let mut group = criterion.benchmark_group("bake on one thread");
    group.sample_size(10);
    for (name, cells, size, supersample) in [
        ("1024, 100k triangles", 224, 1024, 1),
        ("2048, 100k triangles", 224, 2048, 1),
        ("2048, 100k triangles, 2x2 samples", 224, 2048, 2),
        ("2048, 2M triangles", 1008, 2048, 1),
    ] {
        let patch = Patch::new(Driver::Flat, [cells, 16], 0.0, waves);
        let settings = BakeSettings {
            size,
            supersample,
            ..BakeSettings::default()
        };
        let run = || bake(&patch.relief(), &patch.frames, &settings).expect("a valid patch");
        println!("{name}: {:.5} degrees RMS", error(&run()));
        group.bench_function(name, |b| {
            b.iter(|| one_thread.install(|| black_box(run())));
        });
    }
    let patch = Patch::new(Driver::Flat, [388, 1], 0.0, |_, _| 0.0);
    group.bench_function("UV check, 300k triangles", |b| {
        b.iter(|| one_thread.install(|| black_box(check_uvs(&patch.uvs))));
    });
    group.finish();
}

criterion_group!(benches, bakes);
criterion_main!(benches);
