//! One half of a symmetric layer against the whole of it.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod differences;
mod meshes;

use differences::{MODELS, dense};
use meshes::{Mesh, random_vector, rng, symmetric};
use nalgebra::{DMatrix, Matrix2, Vector3};
use rand::RngExt;
use ruga_shell::{BendingModel, FaceParameters, LayerEnergy, LayerParameters, PartIndex};

/// Vertices on the plane x = 0, a ring, which come first; inside are others.
const RING: usize = 24;
const INSIDE: usize = 90;

const FACE: FaceParameters = FaceParameters {
    young: 8.0,
    poisson: 0.4,
    thickness: 0.2,
    normal_stiffness: 1.5,
    gradient_stiffness: -0.1,
};

/// One half of a closed shell, the whole of it, and both in the same symmetric state.
struct Halved {
    half: LayerEnergy,
    whole: LayerEnergy,
    x: Vec<Vector3<f64>>,
}

fn reflected(p: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(-p.x, p.y, p.z)
}

/// A bowl of scattered points, its rim on the plane.
fn bowl() -> Mesh {
    let mut rng = rng(5);
    let rim = (0..RING).map(|i| {
        let angle = std::f64::consts::TAU * i as f64 / RING as f64;
        [3.0 * angle.cos(), 3.0 * angle.sin()]
    });
    let mut flat: Vec<[f64; 2]> = rim.collect();
    while flat.len() < RING + INSIDE {
        let at = [0, 1].map(|_| 2.8 * symmetric(&mut rng));
        let apart = |p: &[f64; 2]| (p[0] - at[0]).hypot(p[1] - at[1]) > 0.33;
        if at[0].hypot(at[1]) < 2.75 && flat.iter().all(apart) {
            flat.push(at);
        }
    }
    let points: Vec<_> = flat
        .iter()
        .map(|&[x, y]| delaunator::Point { x, y })
        .collect();
    let triangles = delaunator::triangulate(&points).triangles;
    Mesh {
        faces: triangles
            .chunks_exact(3)
            .map(|t| [t[0], t[2], t[1]].map(|v| v as u32))
            .collect(),
        positions: flat
            .iter()
            .map(|[y, z]| Vector3::new(0.2 * (9.0 - y * y - z * z).max(0.0), *y, *z))
            .collect(),
    }
}

/// Values of the half, then their images but for vertices on the plane.
fn doubled(values: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let images = values[RING..].iter().map(reflected);
    values.iter().copied().chain(images).collect()
}

fn halved(model: BendingModel) -> Halved {
    let mesh = bowl();
    let mut rng = rng(6);
    let count = mesh.positions.len();
    let image = |v: u32| match (v as usize) < RING {
        true => v,
        false => v + INSIDE as u32,
    };
    let images = mesh.faces.iter().map(|&[a, b, c]| [a, c, b].map(image));
    let both = Mesh {
        faces: mesh.faces.iter().copied().chain(images).collect(),
        positions: doubled(&mesh.positions),
    };
    let twice = |values: Vec<FaceParameters>| values.repeat(2);
    let mut parameters = LayerParameters::uniform(FACE, mesh.faces.len(), 0.0, count);
    for face in &mut parameters.faces {
        face.thickness += 0.05 * symmetric(&mut rng);
    }
    for stiffness in &mut parameters.tangential_stiffness {
        *stiffness = rng.random_range(0.5..1.0);
    }
    let stiffness = &parameters.tangential_stiffness;
    let of_both = LayerParameters {
        faces: twice(parameters.faces.clone()),
        tangential_stiffness: [stiffness.as_slice(), &stiffness[RING..]].concat(),
    };
    // Two vertices inside and one on the plane are held.
    let mut pinned = vec![false; count];
    [3, 40, 70].iter().for_each(|&v| pinned[v] = true);
    let pinned_both = [pinned.as_slice(), &pinned[RING..]].concat();
    let on_plane: Vec<_> = (0..count).map(|v| v < RING).collect();
    let at_rest = (
        &mesh.topology(),
        mesh.positions.as_slice(),
        pinned.as_slice(),
    );
    let half = LayerEnergy::half(at_rest, &on_plane, parameters, model);
    let (topology, rest) = (both.topology(), both.positions.as_slice());
    let whole = LayerEnergy::with_bending(&topology, rest, of_both, &pinned_both, model);
    let (mut half, mut whole) = (half.unwrap(), whole.unwrap());
    // The same in all directions, because rest frames of images begin along another edge.
    let stretches = vec![0.97 * Matrix2::identity(); mesh.faces.len()];
    half.set_rest_metric(&stretches).unwrap();
    whole.set_rest_metric(&stretches.repeat(2)).unwrap();
    let mut moved = |by: f64| -> Vec<Vector3<f64>> {
        let moved = mesh.positions.iter().enumerate().map(|(v, p)| {
            let mut way = by * random_vector(&mut rng);
            way.x *= f64::from(u8::from(v >= RING));
            p + way
        });
        moved.collect()
    };
    let angles = moved(0.05);
    half.set_rest_angles(&angles).unwrap();
    whole.set_rest_angles(&doubled(&angles)).unwrap();
    let x = moved(0.1);
    Halved { half, whole, x }
}

#[test]
fn half_of_the_energy_and_the_forces_of_the_whole() {
    for model in MODELS {
        let Halved { half, whole, x } = halved(model);
        let both = doubled(&x);
        let (own, all) = (half.energy_parts(&x), whole.energy_parts(&both));
        let pairs = [
            (own.membrane, all.membrane),
            (own.bending, all.bending),
            (own.normal, all.normal),
            (own.gradient, all.gradient),
            (own.tangential, all.tangential),
        ];
        for (own, all) in pairs {
            assert!(
                (2.0 * own - all).abs() < 1e-12 * all.abs(),
                "{model:?} {own} {all}"
            );
        }
        let mut forces = vec![7.0; half.dof_count()];
        half.gradient(&x, &mut forces);
        let mut of_both = vec![7.0; whole.dof_count()];
        whole.gradient(&both, &mut of_both);
        let scale = of_both.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        for (k, &vertex) in half.free_vertices().iter().enumerate() {
            let is_on_plane = (vertex as usize) < RING;
            for axis in 0..3 {
                // Free vertices of the half are the first ones of the whole.
                let of_whole = of_both[3 * k + axis];
                let expected = match (is_on_plane, axis) {
                    (true, 0) => 0.0,
                    (true, _) => 0.5 * of_whole,
                    (false, _) => of_whole,
                };
                let found = forces[3 * k + axis];
                assert!((found - expected).abs() < 1e-12 * scale, "{vertex} {axis}");
            }
        }
    }
}

#[test]
fn derivatives_are_those_of_the_energy() {
    for model in MODELS {
        let Halved { half, x, .. } = halved(model);
        let at = |q: &[f64]| {
            let mut x = x.clone();
            for (&v, q) in half.free_vertices().iter().zip(q.chunks(3)) {
                x[v as usize] = Vector3::from_column_slice(q);
            }
            x
        };
        let free = half.free_vertices().iter();
        let q: Vec<f64> = free.flat_map(|&v| x[v as usize].iter().copied()).collect();
        let gradient = |q: &[f64]| {
            let mut gradient = vec![0.0; q.len()];
            half.gradient(&at(q), &mut gradient);
            gradient
        };
        let is_across =
            |k: usize| k.is_multiple_of(3) && (half.free_vertices()[k / 3] as usize) < RING;
        let (starts, rows) = half.pattern();
        let mut values = [vec![7.0; rows.len()], vec![7.0; rows.len()]];
        let [exact, relaxed] = &mut values;
        half.hessian(&x, exact, Some(relaxed));
        let [exact, relaxed] = [0, 1].map(|i| dense((starts, rows), &values[i]));
        let forces = gradient(&q);
        let (step, mut most): (f64, f64) = (1e-5, 0.0);
        let scale = exact.amax();
        for k in 0..q.len() {
            let moved = |by: f64| {
                let mut q = q.clone();
                q[k] += by * step;
                q
            };
            if is_across(k) {
                assert!(exact[(k, k)] > 0.0 && relaxed[(k, k)] == exact[(k, k)]);
                let column = |m: &DMatrix<f64>| m.column(k).amax() == m[(k, k)];
                assert!(forces[k] == 0.0 && column(&exact) && column(&relaxed));
                assert_eq!(exact.column(k).iter().filter(|v| **v != 0.0).count(), 1);
                continue;
            }
            let [up, down] = [1.0, -1.0].map(|by| half.value(&at(&moved(by))));
            assert!(((up - down) / (2.0 * step) - forces[k]).abs() < 1e-6 * scale);
            let [up, down] = [1.0, -1.0].map(|by| gradient(&moved(by)));
            for (row, (up, down)) in up.iter().zip(&down).enumerate() {
                if !is_across(row) {
                    most = most.max(((up - down) / (2.0 * step) - exact[(row, k)]).abs());
                }
            }
        }
        assert!(most < 1e-6 * scale, "{most} of {scale}");
        let least = relaxed.symmetric_eigenvalues().min();
        assert!(least > -1e-9 * scale, "{least}");
    }
}

/// Some vertices on the plane and some inside, which touch them or not.
#[test]
fn parts_have_the_derivatives_of_the_half() {
    for model in MODELS {
        let Halved { half, x, .. } = halved(model);
        let free = half.free_vertices();
        let some = |step: usize| free.iter().copied().step_by(step).collect();
        let sets: [Vec<u32>; 4] = [
            free.to_vec(),
            some(3),
            free[..10].to_vec(),
            free[40..].to_vec(),
        ];
        let (starts, rows) = half.pattern();
        let mut exact = vec![7.0; rows.len()];
        half.hessian(&x, &mut exact, None);
        let exact = dense((starts, rows), &exact);
        let mut forces = vec![7.0; half.dof_count()];
        half.gradient(&x, &mut forces);
        for chosen in sets {
            let part = PartIndex::new(&half)
                .expect("one sheet")
                .part(&half, &chosen);
            let own: Vec<_> = part.vertices().iter().map(|&v| x[v as usize]).collect();
            let (starts, rows) = part.energy().pattern();
            let mut values = vec![7.0; rows.len()];
            part.energy().hessian(&own, &mut values, None);
            let mut of_part = vec![7.0; part.energy().dof_count()];
            part.energy().gradient(&own, &mut of_part);
            let rank = |v: &u32| free.binary_search(v).unwrap();
            let dofs: Vec<usize> = chosen
                .iter()
                .flat_map(|v| 3 * rank(v)..3 * rank(v) + 3)
                .collect();
            let expected = exact.select_rows(&dofs).select_columns(&dofs);
            assert_eq!(dense((starts, rows), &values), expected);
            let expected: Vec<_> = dofs.iter().map(|&k| forces[k]).collect();
            assert_eq!(of_part, expected);
        }
    }
}
