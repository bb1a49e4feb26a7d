//! Faces per second on one core, refining and coarsening, at three sizes each four times the last.
//!
//! Goals: 35 thousand faces a second or better, and at most five times the time for four times
//! the faces. The faces counted are those of the larger of the two meshes.

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use ruga_remesh::{RemeshSettings, SurfaceMesh, remesh};
use shapes::{Shape, Sheet, Waves, grid};

fn follow(criterion: &mut Criterion, name: &str, cases: [(usize, f64); 3]) {
    let one_thread = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a pool of one thread");
    let mut group = criterion.benchmark_group(name);
    group.sample_size(10);
    for (cells, edge) in cases {
        let mesh = grid(Shape::Cylinder, cells, 0.2, 1);
        let waves = Waves {
            edge,
            range: 3.0,
            aspect: 2.0,
            seed: 2,
        };
        let sizing = waves.sizing(&mesh);
        let run = |mesh: &SurfaceMesh| {
            remesh(
                mesh,
                &sizing,
                &Sheet(Shape::Cylinder),
                &RemeshSettings::default(),
            )
            .expect("the settings are valid")
        };
        let faces = run(&mesh)
            .mesh
            .mesh
            .face_count()
            .max(mesh.mesh.face_count());
        group.throughput(Throughput::Elements(faces as u64));
        group.bench_function(BenchmarkId::from_parameter(faces), |bencher| {
            bencher.iter(|| one_thread.install(|| run(&mesh)));
        });
    }
    group.finish();
}

fn refine(criterion: &mut Criterion) {
    follow(criterion, "refine", [(15, 0.02), (30, 0.01), (60, 0.005)]);
}

fn coarsen(criterion: &mut Criterion) {
    follow(
        criterion,
        "coarsen",
        [(75, 0.03), (150, 0.015), (300, 0.0075)],
    );
}

fn adapt(criterion: &mut Criterion) {
    follow(
        criterion,
        "adapt",
        [(75, 0.0115), (150, 0.00575), (300, 0.002875)],
    );
}

criterion_group!(benches, refine, coarsen, adapt);
criterion_main!(benches);
