//! Global functions: eigenvalues known in closed form, orthonormality, what is refused.

mod meshes;

use std::collections::BTreeMap;
use std::f64::consts::PI;

use meshes::{Patch, equilateral_rectangle, irregular_square};
use nalgebra::Vector3;
use ruga_constraint::{ConstraintError, ConstraintRow, Order, SpectralRows, spectral_rows};
use ruga_mesh::{FaceId, Id, TriMesh, VertexId, vertex_areas};

fn spectrum(patch: &Patch, count: usize) -> SpectralRows {
    let rows = spectral_rows(&patch.mesh, &patch.positions, count).expect("valid input");
    assert!(rows.converged, "{}", rows.residual);
    assert!(rows.residual < 1e-8, "{}", rows.residual);
    assert_eq!((rows.rows.len(), rows.eigenvalues.len()), (count, count));
    rows
}

/// A sphere: an icosahedron, each face split into four `levels` times.
fn sphere(radius: f64, levels: u32) -> Patch {
    let long = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut positions: Vec<Vector3<f64>> = Vec::new();
    for (a, b) in [(-1.0, long), (1.0, long), (-1.0, -long), (1.0, -long)] {
        positions.extend([
            Vector3::new(a, b, 0.0),
            Vector3::new(0.0, a, b),
            Vector3::new(b, 0.0, a),
        ]);
    }
    let mut faces = Vec::new();
    for a in 0..12_u32 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r] = [a, b, c].map(|i| positions[i as usize]);
                let is_edge = |d: Vector3<f64>| (d.norm() - 2.0).abs() < 1e-9;
                if is_edge(q - p) && is_edge(r - q) && is_edge(p - r) {
                    let outward = (q - p).cross(&(r - p)).dot(&p) > 0.0;
                    faces.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    for _ in 0..levels {
        faces = split(&mut positions, &faces);
    }
    let positions = positions.iter().map(|p| p.normalize() * radius).collect();
    Patch::new(positions, faces)
}

fn split(positions: &mut Vec<Vector3<f64>>, faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = BTreeMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let length = positions[a as usize].norm();
            let sum = positions[a as usize] + positions[b as usize];
            positions.push(sum.normalize() * length);
            positions.len() as u32 - 1
        })
    };
    let quarter = |&[a, b, c]: &[u32; 3]| {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
    };
    faces.iter().flat_map(quarter).collect()
}

/// A row's function at each vertex, `w A / m`.
fn function(row: &ConstraintRow, areas: &[f64]) -> Vec<f64> {
    let area: f64 = areas.iter().sum();
    let mut values = vec![0.0; areas.len()];
    for (vertex, weight) in &row.weights {
        values[vertex.index()] = weight * area / areas[vertex.index()];
    }
    values
}

#[test]
fn a_square_with_free_border() {
    // Sides of 2 m; an irregular mesh, in which no two eigenvalues are equal, and the error of
    // linear elements with lumped mass, of about (k h)^2 / 12, h the edge.
    let patch = irregular_square(40, 7, &[]);
    let count = 60;
    let found = spectrum(&patch, count).eigenvalues;
    let mut exact: Vec<f64> = (0..20)
        .flat_map(|m| (0..20).map(move |n| PI * PI * f64::from(m * m + n * n) / 4.0))
        .collect();
    exact.sort_by(f64::total_cmp);
    assert_eq!(found[0], 0.0);
    for (found, exact) in found.iter().zip(&exact).skip(1) {
        let bound = 1e-3 + 0.25 * exact * 0.05 * 0.05;
        assert!((found / exact - 1.0).abs() < bound, "{found} {exact}");
    }
}

#[test]
fn errors_fall_with_the_square_of_the_edge() {
    let error = |cells: usize| {
        let found = spectrum(&irregular_square(cells, 3, &[]), 10).eigenvalues[8];
        (found / (PI * PI * 8.0 / 4.0) - 1.0).abs()
    };
    let (coarse, fine) = (error(12), error(48));
    assert!(fine < coarse / 8.0, "{coarse} {fine}");
}

#[test]
fn a_sphere() {
    let radius = 0.03;
    let patch = sphere(radius, 4);
    // All of l = 0 to 6: multiplicities 1, 3, 5, 7, ...
    let found = spectrum(&patch, 49).eigenvalues;
    let mut index = 0;
    for l in 0..7_u32 {
        let exact = f64::from(l * (l + 1)) / (radius * radius);
        for _ in 0..=2 * l {
            let error = (found[index] - exact).abs() / exact.max(1.0);
            // Linear elements with lumped mass: (k h)^2 / 12, with the edge h = 0.07 radii.
            let bound = 0.0005 * f64::from(l * (l + 1)) + 1e-9;
            assert!(error < bound, "l {l}: {} {exact}", found[index]);
            index += 1;
        }
    }
}

#[test]
fn functions_are_orthonormal_in_the_mean() {
    for patch in [irregular_square(15, 1, &[]), sphere(1.0, 2)] {
        let spectrum = spectrum(&patch, 40);
        let areas = vertex_areas(&patch.mesh, &patch.positions);
        let area: f64 = areas.iter().sum();
        let functions: Vec<_> = (spectrum.rows.iter())
            .map(|row| function(row, &areas))
            .collect();
        for (i, f) in functions.iter().enumerate() {
            for (j, g) in functions.iter().enumerate() {
                let terms = f.iter().zip(g).zip(&areas);
                let mean: f64 = terms.map(|((f, g), m)| m * f * g / area).sum();
                let wanted = f64::from(u8::from(i == j));
                assert!((mean - wanted).abs() < 1e-10, "{i} {j} {mean}");
            }
            let sum: f64 = spectrum.rows[i].weights.iter().map(|pair| pair.1).sum();
            let wanted = f64::from(u8::from(i == 0));
            assert!((sum - wanted).abs() < 1e-10, "{i} {sum}");
            let top = f.iter().copied().fold(0.0, f64::max);
            let bottom = f.iter().copied().fold(0.0, f64::min);
            assert!(top > -bottom * (1.0 - 1e-5), "{i}: {bottom} to {top}");
        }
    }
}

#[test]
fn the_first_row_is_the_average() {
    let patch = irregular_square(10, 5, &[]);
    let set = spectrum(&patch, 3);
    let areas = vertex_areas(&patch.mesh, &patch.positions);
    let area: f64 = areas.iter().sum();
    let first = &set.rows[0];
    assert_eq!((first.centre, first.order), (0, Order::Constant));
    assert_eq!(first.weights.len(), patch.mesh.vertex_count());
    for (vertex, weight) in &first.weights {
        assert!((weight * area / areas[vertex.index()] - 1.0).abs() < 1e-12);
    }
    assert_eq!((set.rows[2].centre, set.rows[2].order), (2, Order::Global));
}

/// Two squares apart from each other: every eigenvalue twice, and the first function is constant
/// over both.
#[test]
fn pieces_that_are_alike() {
    let one = irregular_square(12, 2, &[]);
    let count = one.positions.len();
    let far = |p: &Vector3<f64>| p + Vector3::new(5.0, 0.0, 0.0);
    let positions: Vec<_> = (one.positions.iter().copied())
        .chain(one.positions.iter().map(far))
        .collect();
    let moved = one
        .face_list()
        .into_iter()
        .map(|f| f.map(|v| v + count as u32));
    let faces = one.face_list().into_iter().chain(moved).collect();
    let single = spectrum(&one, 10).eigenvalues;
    let double = spectrum(&Patch::new(positions, faces), 20);
    for (i, value) in double.eigenvalues.iter().enumerate() {
        let expected = single[i / 2];
        assert!(
            (value - expected).abs() < 1e-8 * (1.0 + expected),
            "{i}: {value} {expected}"
        );
    }
    let sum: f64 = double.rows[0].weights.iter().map(|pair| pair.1).sum();
    assert!((sum - 1.0).abs() < 1e-12);
}

#[test]
fn same_input_same_bits() {
    let patch = sphere(0.1, 3);
    assert_eq!(spectrum(&patch, 30), spectrum(&patch, 30));
}

/// As many functions as vertices, on meshes smaller than a block and larger.
#[test]
fn every_function_there_is() {
    for (cells, count) in [(1, 4), (4, 25), (6, 49)] {
        let patch = irregular_square(cells, 9, &[]);
        let values = spectrum(&patch, count).eigenvalues;
        assert!(values.is_sorted(), "{values:?}");
        let first: Vec<f64> = spectrum(&patch, 3).eigenvalues;
        for (all, few) in values.iter().zip(&first) {
            assert!((all - few).abs() < 1e-8 * (1.0 + few), "{all} {few}");
        }
    }
}

#[test]
fn eigenvalues_know_no_place_and_scale_with_the_inverse_square() {
    let patch = irregular_square(12, 4, &[]);
    let values = spectrum(&patch, 20).eigenvalues;
    let moved = patch.mapped(|p| 1e-3 * Vector3::new(p.y, p.z, p.x) + Vector3::new(3.0, -2.0, 1.0));
    for (a, b) in values.iter().zip(spectrum(&moved, 20).eigenvalues) {
        assert!((a - 1e-6 * b).abs() < 1e-6 * (1.0 + a), "{a} {b}");
    }
}

#[test]
fn what_is_refused() {
    let patch = irregular_square(3, 1, &[]);
    for count in [0, 17] {
        let error = spectral_rows(&patch.mesh, &patch.positions, count);
        let expected = ConstraintError::FunctionCount {
            count,
            vertices: 16,
        };
        assert_eq!(error.expect_err("a wrong count"), expected);
        let words = ["from 1 to 16", &count.to_string()].map(str::to_owned);
        assert!(words.iter().all(|word| expected.to_string().contains(word)));
    }
    let flat: Vec<_> = (patch.positions.iter())
        .map(|p| Vector3::new(p.x, 0.0, 0.0))
        .collect();
    let error = spectral_rows(&patch.mesh, &flat, 2).expect_err("no areas");
    assert_eq!(error, ConstraintError::DegenerateFace { face: FaceId(0) });
    let loose = TriMesh::new(4, vec![[0, 1, 3]]).expect("a valid mesh");
    let places = [[0.0, 0.0], [1.0, 0.0], [5.0, 5.0], [0.0, 1.0]];
    let places = places.map(|[x, y]| Vector3::new(x, y, 0.0));
    let error = spectral_rows(&loose, &places, 2).expect_err("a loose vertex");
    assert_eq!(
        error,
        ConstraintError::LooseVertex {
            vertex: VertexId(2)
        }
    );
    let error = spectral_rows(&patch.mesh, &patch.positions[1..], 2);
    assert!(matches!(error, Err(ConstraintError::WrongLength { .. })));
    let mut broken = patch.positions.clone();
    broken[4].x = f64::NAN;
    let error = spectral_rows(&patch.mesh, &broken, 2);
    assert!(matches!(
        error,
        Err(ConstraintError::PositionNotFinite { .. })
    ));
}

/// Weyl's law with its term for a free border: below the wave number `k` lie about
/// `A k^2 / (4 pi) + P k / (4 pi)` functions. Were one missed, all later ones would be too high.
#[test]
fn many_functions_are_as_dense_as_they_should_be() {
    let patch = equilateral_rectangle(0.2, 0.2, 0.2 / 44.0);
    let set = spectrum(&patch, 250);
    let areas = vertex_areas(&patch.mesh, &patch.positions);
    let area: f64 = areas.iter().sum();
    // The rows' ends are ragged, so that two sides are longer than they look.
    let perimeter = 2.0 * 0.2 * (1.0 + 2.0 / 3.0_f64.sqrt());
    for (index, value) in set.eigenvalues.iter().enumerate().skip(30) {
        let k = value.sqrt();
        let expected = (area * k * k + perimeter * k) / (4.0 * PI);
        let error = expected / (index as f64) - 1.0;
        assert!(error.abs() < 0.12, "{index}: {error}");
    }
}
