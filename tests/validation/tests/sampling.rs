//! How well rows average known fields on good and bad meshes, and how far a remesh moves them.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_constraint::{Kernel, Sampling, constraint_rows};
use ruga_mesh::{Id, SurfaceLookup, TriMesh, VertexId, vertex_normals};
use ruga_remesh::SurfaceMesh;

use ruga_validation::Rectangle;

/// Edges of the meshes, m.
const EDGE: f64 = 1e-3;
const SHEET: Rectangle = Rectangle {
    length: 0.06,
    width: 0.048,
    radius: None,
};
const SAMPLINGS: [Sampling; 3] = [Sampling::Area, Sampling::Adjusted, Sampling::Quadrature];

/// Places that errors and jumps are taken over. Ratios of two samplings' jumps scatter by a sixth from
/// one set of 16 places to the next, around 0.6 to 0.9 over 256 places: half of that with 64.
const PLACES: usize = 64;

/// A triangulation of the sheet.
struct Mesh {
    mesh: TriMesh,
    positions: Vec<Vector3<f64>>,
}

/// Delaunay triangles over rows of equilateral ones, inner vertices moved by up to `jitter` edges.
fn lattice(jitter: f64, edge: f64, seed: u64) -> Mesh {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let columns = (SHEET.length / edge).round() as usize;
    let rows = (SHEET.width / (0.866 * edge)).round() as usize;
    let mut positions = Vec::new();
    for row in 0..=rows {
        let last = columns + row % 2;
        for column in 0..=last {
            let shift = if row % 2 == 0 || column == 0 {
                0.0
            } else {
                0.5
            };
            let x = ((column as f64 - shift) / columns as f64).min(1.0) * SHEET.length;
            let y = row as f64 / rows as f64 * SHEET.width;
            let is_inner = row > 0 && row < rows && column > 0 && column < last;
            let reach = if is_inner { jitter * edge } else { 0.0 };
            let [dx, dy] = [0, 1].map(|_| reach * random.random_range(-1.0..1.0));
            positions.push(Vector3::new(x + dx, y + dy, 0.0));
        }
    }
    let points: Vec<_> = positions
        .iter()
        .map(|p| delaunator::Point { x: p.x, y: p.y })
        .collect();
    let corners = delaunator::triangulate(&points).triangles;
    // Points on the border make slivers without area; the others turn clockwise.
    let doubled = |[a, b, c]: [usize; 3]| {
        let [b, c] = [b, c].map(|i| positions[i] - positions[a]);
        b.cross(&c).z
    };
    let faces = corners
        .chunks_exact(3)
        .map(|c| [c[0], c[2], c[1]])
        .filter(|&face| doubled(face).abs() > 1e-6 * edge * edge)
        .map(|face| {
            if doubled(face) > 0.0 {
                face
            } else {
                [face[0], face[2], face[1]]
            }
        })
        .map(|face| face.map(|i| i as u32));
    let mesh = TriMesh::new(positions.len(), faces.collect()).expect("a triangulation");
    Mesh { mesh, positions }
}

fn wave(p: &Vector3<f64>) -> f64 {
    (WAVE_NUMBER * (0.8 * p.x + 0.6 * p.y) + 0.4).sin()
}

const WAVE_NUMBER: f64 = std::f64::consts::TAU / 30e-3;

/// The kernel's average of the wave around a place, over the part of its support on the sheet.
fn exact(kernel: Kernel, at: Vector3<f64>) -> f64 {
    let steps = 300;
    let step = 2.0 * kernel.radius() / steps as f64;
    let (mut mass, mut sum) = (0.0, 0.0);
    for i in 0..steps * steps {
        let offset = [i % steps, i / steps].map(|i| (i as f64 + 0.5) * step - kernel.radius());
        let p = at + Vector3::new(offset[0], offset[1], 0.0);
        let is_on = p.x >= 0.0 && p.x <= SHEET.length && p.y >= 0.0 && p.y <= SHEET.width;
        if is_on {
            let weight = kernel.weight(offset[0].hypot(offset[1]));
            mass += weight;
            sum += weight * wave(&p);
        }
    }
    sum / mass
}

/// What the rows around places make of the wave.
fn averages(mesh: &Mesh, centres: &[Vector3<f64>], kernel: Kernel, sampling: Sampling) -> Vec<f64> {
    let lookup = SurfaceLookup::new(&mesh.mesh, &mesh.positions);
    let places: Vec<_> = centres
        .iter()
        .map(|p| lookup.closest(p).expect("a surface").point)
        .collect();
    let set = constraint_rows(
        &mesh.mesh,
        &mesh.positions,
        &vertex_normals(&mesh.mesh, &mesh.positions),
        &places,
        &vec![kernel; places.len()],
        sampling,
    )
    .expect("valid rows");
    let value = |v: VertexId| wave(&mesh.positions[v.index()]);
    let average = |weights: &[(VertexId, f64)]| weights.iter().map(|(v, w)| w * value(*v)).sum();
    set.rows.iter().map(|row| average(&row.weights)).collect()
}

fn rms(differences: impl Iterator<Item = f64>) -> f64 {
    let squares: Vec<f64> = differences.map(|d| d * d).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Each kind of mesh with another one of its kind, by a remesh that is coarser by a fifth.
fn meshes() -> Vec<(&'static str, [Mesh; 2])> {
    let of = |made: SurfaceMesh| Mesh {
        mesh: made.mesh,
        positions: made.positions.as_slice().to_vec(),
    };
    let lattices = |jitter| [lattice(jitter, EDGE, 1), lattice(jitter, 1.2 * EDGE, 2)];
    let isotropic = SHEET.meshed(EDGE);
    let again = SHEET.remeshed(&isotropic, 1.2 * EDGE, 0.1, 3).mesh;
    let stretched = [1.0, 1.2].map(|size| SHEET.fitted([size * EDGE, 3.0 * size * EDGE], 0.1, 5));
    vec![
        ("regular", lattices(0.0)),
        ("jitter .3", lattices(0.3)),
        ("jitter .45", lattices(0.45)),
        ("remeshed", [of(isotropic), of(again)]),
        ("remeshed 3:1", stretched.map(of)),
    ]
}

/// Places whose supports lie on the sheet, or that lie on its border or near it.
fn places(kernel: Kernel, is_inner: bool) -> Vec<Vector3<f64>> {
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let margin = if is_inner {
        kernel.radius() + EDGE
    } else {
        0.0
    };
    let place = (0..PLACES).map(|i| {
        let x = random.random_range(margin..SHEET.length - margin);
        let y = random.random_range(margin..SHEET.width - margin);
        match i % 2 {
            _ if is_inner => Vector3::new(x, y, 0.0),
            0 => Vector3::new(x, 0.3 * kernel.sigma, 0.0),
            _ => Vector3::new(SHEET.length, y, 0.0),
        }
    });
    place.collect()
}

/// Root mean squares over places: of the error, and of the jump from one mesh to the other.
fn errors(
    pair: &[Mesh; 2],
    places: &[Vector3<f64>],
    kernel: Kernel,
    truth: &[f64],
) -> [[f64; 2]; 3] {
    SAMPLINGS.map(|sampling| {
        let [here, there] = pair
            .each_ref()
            .map(|mesh| averages(mesh, places, kernel, sampling));
        [truth, &there].map(|other| rms(here.iter().zip(other).map(|(a, b)| a - b)))
    })
}

/// Of a wave of height one and 30 edges. Kernels with sigma of 6 edges, as beside a foundation, and
/// 1.6, at which supports hold 50 vertices.
#[test]
fn quadrature_is_the_best_sampling_on_good_and_bad_meshes() {
    let meshes = meshes();
    let narrow = Kernel {
        sigma: 1.6 * EDGE,
        cut: 2.5,
    };
    for kernel in [Kernel::beside_foundation(12.0 * EDGE), narrow] {
        for is_inner in [true, false] {
            let places = places(kernel, is_inner);
            let truth: Vec<f64> = places.iter().map(|&at| exact(kernel, at)).collect();
            let edges = kernel.sigma / EDGE;
            println!(
                "sigma of {edges:.1} edges, inside {is_inner}: error and jump of {SAMPLINGS:?}"
            );
            for (name, pair) in &meshes {
                let found = errors(pair, &places, kernel, &truth);
                let line = found.map(|[error, jump]| format!("{error:8.1e} {jump:8.1e}"));
                println!("{name:14} {}", line.join("   "));
                let [_, adjusted, quadrature] = found;
                assert!(
                    quadrature[0] < 1.2 * adjusted[0] + 1e-5,
                    "{name}: {found:?}"
                );
                if is_inner {
                    assert!(quadrature[0] < 4e-4, "{name}: {found:?}");
                    assert!(quadrature[1] < 1.1 * adjusted[1], "{name}: {found:?}");
                }
            }
        }
    }
}
