//! Cost of one gradient and one exact Hessian, per face, at about 9.4 thousand vertices, with either
//! bending model, and with ten creases across the layer.

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Matrix2, Vector3};
use ruga_mesh::TriMesh;
use ruga_shell::{BendingModel, Crease, FaceParameters, FoldSense, LayerEnergy, LayerParameters};

const SIDE: usize = 97;

/// A layer with creases along so many of its rows, a wrinkled state, and the number of its faces.
fn layer(model: BendingModel, creases: usize) -> (LayerEnergy, Vec<Vector3<f64>>, usize) {
    let edge = 2e-4;
    let mut rest = Vec::new();
    for j in 0..SIDE {
        for i in 0..SIDE {
            let x = i as f64 + 0.5 * (j % 2) as f64;
            rest.push(Vector3::new(
                x * edge,
                j as f64 * edge * 0.75_f64.sqrt(),
                0.0,
            ));
        }
    }
    let mut faces = Vec::new();
    for j in 0..SIDE - 1 {
        for i in 0..SIDE - 1 {
            let at = |i: usize, j: usize| (j * SIDE + i) as u32;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1));
            if j % 2 == 0 {
                faces.extend([[a, b, c], [b, d, c]]);
            } else {
                faces.extend([[a, b, d], [a, d, c]]);
            }
        }
    }
    let skin = FaceParameters {
        young: 6e8,
        poisson: 0.48,
        thickness: 1.2e-4,
        normal_stiffness: 5e9,
        gradient_stiffness: 1e3,
    };
    let mesh = TriMesh::new(rest.len(), faces).expect("a lattice");
    let parameters = LayerParameters::uniform(skin, mesh.face_count(), 1e10, rest.len());
    let pinned = vec![false; rest.len()];
    let mut layer = LayerEnergy::with_bending(&mesh, &rest, parameters, &pinned, model)
        .expect("a valid lattice");
    let row = |v: u32| v as usize / SIDE;
    let is_creased =
        |row: usize| row > 0 && row.is_multiple_of(SIDE / 11) && row <= creases * (SIDE / 11);
    let crease = Crease {
        compliance: Crease::strip_compliance(skin.thickness, 0.1, skin.bending_modulus()),
        rest_angle: 0.3,
        sense: FoldSense::Valley,
    };
    let on_line = mesh.edges().iter().filter(|(_, edge)| {
        let [a, b] = edge.vertices.map(|v| row(v.0));
        a == b && is_creased(a)
    });
    let creases: Vec<_> = on_line.map(|(edge, _)| (edge, crease)).collect();
    layer.set_creases(&creases).expect("inner edges");
    let wrinkled = rest
        .iter()
        .map(|p| Vector3::new(0.97 * p.x, p.y, 5e-5 * (2.5e3 * p.x).sin()))
        .collect();
    (layer, wrinkled, mesh.face_count())
}

fn assembly(criterion: &mut Criterion) {
    measure(criterion, "assembly", (BendingModel::Hinge, 0));
    measure(
        criterion,
        "assembly, stars",
        (BendingModel::VertexCurvature, 0),
    );
    let creased = (BendingModel::VertexCurvature, 10);
    measure(criterion, "assembly, stars, ten creases", creased);
}

fn measure(criterion: &mut Criterion, name: &str, (model, creases): (BendingModel, usize)) {
    let (mut layer, x, faces) = layer(model, creases);
    let mut gradient = vec![0.0; layer.dof_count()];
    let mut exact = vec![0.0; layer.pattern().1.len()];
    let mut relaxed = exact.clone();
    // Throughput is printed as elements (faces) per second; 0.67 M/s is 1.5 us per face.
    let mut group = criterion.benchmark_group(name);
    group.throughput(criterion::Throughput::Elements(faces as u64));
    group.bench_function("value", |b| b.iter(|| layer.value(&x)));
    group.bench_function("gradient", |b| b.iter(|| layer.gradient(&x, &mut gradient)));
    group.bench_function("gradient and exact Hessian", |b| {
        b.iter(|| {
            layer.gradient(&x, &mut gradient);
            layer.hessian(&x, &mut exact, None);
        });
    });
    group.bench_function("exact and relaxed Hessian", |b| {
        b.iter(|| layer.hessian(&x, &mut exact, Some(&mut relaxed)));
    });
    let unstretched = vec![Matrix2::identity(); faces];
    group.bench_function("new rest metric", |b| {
        b.iter(|| layer.set_rest_metric(&unstretched).expect("as many faces"));
    });
    group.finish();
}

criterion_group!(benches, assembly);
criterion_main!(benches);
