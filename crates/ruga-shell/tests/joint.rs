//! What two layers that move together must agree with: rest, rigid motion, a layer on a fixed base.

mod meshes;

use std::f64::consts::PI;

use meshes::{Mesh, jittered, lattice, outline, random_rotation, random_vector, rng};
use nalgebra::{Matrix2, Vector3};
use ruga_shell::{
    BendingModel, FaceParameters, LayerEnergy, LayerParameters, LayerSpringParameters,
    LayerSprings, RestTriangle, ShellError, UpperSheet,
};

const EDGE: f64 = 2e-4;
const OFFSET: f64 = 7e-4;
const LOWER: FaceParameters = FaceParameters {
    young: 4e6,
    poisson: 0.48,
    thickness: 1.3e-3,
    normal_stiffness: 9e7,
    gradient_stiffness: 293.0,
};
const UPPER: FaceParameters = FaceParameters {
    young: 6e8,
    poisson: 0.48,
    thickness: 1.2e-4,
    normal_stiffness: SPRINGS.normal_stiffness,
    gradient_stiffness: SPRINGS.gradient_stiffness,
};
const SPRINGS: LayerSpringParameters = LayerSpringParameters {
    normal_stiffness: 4.8e9,
    gradient_stiffness: 356.0,
    tangential_stiffness: 1e9,
};

fn layer(
    mesh: &Mesh,
    rest: &[Vector3<f64>],
    face: FaceParameters,
    tangential: f64,
    pinned: &[bool],
) -> LayerEnergy {
    let parameters = LayerParameters::uniform(face, mesh.faces.len(), tangential, rest.len());
    LayerEnergy::new(&mesh.topology(), rest, parameters, pinned).expect("a valid layer")
}

fn raised(rest: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    rest.iter().map(|p| p + Vector3::z() * OFFSET).collect()
}

/// `UPPER` on `lower`, on a flat mesh, and their unstrained positions.
fn pair_on(
    lower: FaceParameters,
    mesh: &Mesh,
    pinned: &[bool],
) -> (LayerEnergy, Vec<Vector3<f64>>) {
    let above = raised(&mesh.positions);
    let (faces, count) = (mesh.faces.len(), above.len());
    let joint = LayerEnergy::pair(
        (&mesh.topology(), &mesh.positions, pinned),
        LayerParameters::uniform(lower, faces, 0.0, count),
        upper(&above, faces),
        BendingModel::Hinge,
    )
    .expect("sheets that fit");
    (joint, [&mesh.positions[..], &above[..]].concat())
}

fn upper(rest: &[Vector3<f64>], faces: usize) -> UpperSheet {
    let tangential = SPRINGS.tangential_stiffness;
    UpperSheet {
        rest_positions: rest.to_vec(),
        parameters: LayerParameters::uniform(UPPER, faces, tangential, rest.len()),
        offsets: vec![OFFSET; rest.len()],
    }
}

fn flat_pair(mesh: &Mesh, pinned: &[bool]) -> (LayerEnergy, Vec<Vector3<f64>>) {
    pair_on(LOWER, mesh, pinned)
}

fn free(mesh: &Mesh) -> Vec<bool> {
    vec![false; mesh.positions.len()]
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |top, v| v.abs().max(top))
}

#[test]
fn an_unstrained_pair_is_free_of_force() {
    let mesh = jittered(10, 9, EDGE, 0.25, 21);
    let (joint, rest) = flat_pair(&mesh, &outline(10, 9));
    let mut gradient = vec![1.0; joint.dof_count()];
    joint.gradient(&rest, &mut gradient);
    let unit = UPPER.tension_modulus() * EDGE;
    assert!(largest(&gradient) < 1e-12 * unit);
    assert!(joint.value(&rest) < 1e-24 * unit * EDGE);
}

#[test]
fn rigid_motion_costs_the_springs_nothing() {
    let mesh = jittered(10, 9, EDGE, 0.25, 22);
    let (joint, rest) = flat_pair(&mesh, &free(&mesh));
    let mut rng = rng(23);
    let x: Vec<_> = rest
        .iter()
        .map(|p| p + random_vector(&mut rng) * (0.2 * EDGE))
        .collect();
    let before = joint.spring_parts(&x);
    assert!(before.normal > 0.0 && before.gradient > 0.0 && before.tangential > 0.0);
    for _ in 0..10 {
        let turn = random_rotation(&mut rng);
        let shift = random_vector(&mut rng) * 1e-2;
        let moved: Vec<_> = x.iter().map(|p| turn * p + shift).collect();
        let after = joint.spring_parts(&moved);
        for (a, b) in [
            (before.normal, after.normal),
            (before.gradient, after.gradient),
            (before.tangential, after.tangential),
        ] {
            assert!((a - b).abs() < 1e-10 * before.total());
        }
    }
}

/// Forces and moments of the springs balance: they hold nothing in space.
#[test]
fn the_pair_without_a_base_has_no_resultant() {
    let mesh = jittered(10, 9, EDGE, 0.25, 24);
    let bare = FaceParameters {
        normal_stiffness: 0.0,
        gradient_stiffness: 0.0,
        ..LOWER
    };
    let (joint, rest) = pair_on(bare, &mesh, &free(&mesh));
    let mut rng = rng(25);
    let x: Vec<_> = rest
        .iter()
        .map(|p| p + random_vector(&mut rng) * (0.2 * EDGE))
        .collect();
    let mut gradient = vec![0.0; joint.dof_count()];
    joint.gradient(&x, &mut gradient);
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    for (position, gradient) in x.iter().zip(gradient.chunks_exact(3)) {
        let gradient = Vector3::from_column_slice(gradient);
        force += gradient;
        moment += position.cross(&gradient);
    }
    let scale = largest(&gradient);
    assert!(force.amax() < 1e-12 * scale);
    assert!(moment.amax() < 1e-12 * scale * OFFSET);
}

/// On a flat lower layer that is held fast, the upper one is a layer on its own foundation: what
/// the sequential methods solve differs from this in the motion of the lower layer alone.
#[test]
fn an_upper_layer_on_a_fixed_lower_one_is_a_layer_on_its_base() {
    let mesh = jittered(10, 9, EDGE, 0.25, 26);
    let (joint, rest) = flat_pair(&mesh, &free(&mesh));
    let count = mesh.positions.len();
    let tangential = SPRINGS.tangential_stiffness;
    let alone = layer(&mesh, &rest[count..], UPPER, tangential, &free(&mesh));
    let mut rng = rng(27);
    let x: Vec<_> = (0..2 * count)
        .map(|v| {
            let share = if v < count { 0.0 } else { 0.2 };
            rest[v] + random_vector(&mut rng) * (share * EDGE)
        })
        .collect();
    let above = &x[count..];
    let energy = alone.value(above);
    assert!((joint.value(&x) - energy).abs() < 1e-12 * energy);

    let mut both = vec![0.0; joint.dof_count()];
    let mut one = vec![0.0; alone.dof_count()];
    joint.gradient(&x, &mut both);
    alone.gradient(above, &mut one);
    for (a, b) in both[3 * count..].iter().zip(&one) {
        assert!((a - b).abs() < 1e-12 * largest(&one));
    }

    let (starts, rows) = joint.pattern();
    let mut both = vec![0.0; rows.len()];
    let mut one = vec![0.0; alone.pattern().1.len()];
    joint.hessian(&x, &mut both, None);
    alone.hessian(above, &mut one, None);
    // The upper layer's columns come last and have no rows of the lower one.
    for (a, b) in both[starts[3 * count]..].iter().zip(&one) {
        assert!((a - b).abs() < 1e-12 * largest(&one));
    }
}

#[test]
fn the_springs_follow_the_rest_metric_of_the_lower_layer() {
    let mesh = jittered(10, 9, EDGE, 0.25, 28);
    let (mut joint, rest) = flat_pair(&mesh, &free(&mesh));
    let count = mesh.positions.len();
    let mut rng = rng(29);
    // Apart by a deviation with a gradient, and a drift.
    let x: Vec<_> = rest
        .iter()
        .enumerate()
        .map(|(v, p)| {
            if v < count {
                *p
            } else {
                p + random_vector(&mut rng) * EDGE
            }
        })
        .collect();
    let before = joint.spring_parts(&x);
    let faces = mesh.faces.len();
    let halved = Matrix2::identity() * 0.5;
    joint
        .set_rest_metric(&vec![halved; faces])
        .expect("as many faces");
    let after = joint.spring_parts(&x);
    // A quarter of the area; gradients twice as steep.
    assert!((after.normal / before.normal - 0.25).abs() < 1e-12);
    assert!((after.tangential / before.tangential - 0.25).abs() < 1e-12);
    assert!((after.gradient / before.gradient - 1.0).abs() < 1e-12);

    let turned = Matrix2::new(1.0, 0.0, 0.0, -1.0);
    let refused = joint.set_rest_metric(&vec![turned; faces]);
    assert!(matches!(refused, Err(ShellError::InvertedStretch { .. })));
    assert_eq!(joint.spring_parts(&x), after, "nothing was changed");
}

/// Area-weighted unit normals of the vertices.
fn vertex_normals(mesh: &Mesh, positions: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let mut sums = vec![Vector3::zeros(); positions.len()];
    for face in &mesh.faces {
        let [a, b, c] = face.map(|v| positions[v as usize]);
        let normal = (b - a).cross(&(c - a));
        face.iter().for_each(|&v| sums[v as usize] += normal);
    }
    sums.iter().map(|normal| normal.normalize()).collect()
}

/// Arms along the mean of the facets' normals keep the energy of `D_facet = 3/16 Kt t^2 e^2`.
#[test]
fn facets_bend_as_stiffly_as_documented() {
    let (columns, rows) = (9, 9);
    let mesh = lattice(columns, rows, EDGE);
    let middle = (rows / 2) * columns + columns / 2;
    let curvature = 1e-3 / EDGE;
    for direction in 0..7 {
        let (sin, cos) = (f64::from(direction) * PI / 7.0).sin_cos();
        let bent = |p: &Vector3<f64>| {
            let s = (p - mesh.positions[middle]).dot(&Vector3::new(cos, sin, 0.0));
            p + Vector3::z() * (0.5 * curvature * s * s)
        };
        let below: Vec<_> = mesh.positions.iter().map(bent).collect();
        let normals = vertex_normals(&mesh, &below);
        // Six faces, of which there are two per vertex.
        let around = mesh.faces.iter().filter(|f| f.contains(&(middle as u32)));
        let energy: f64 = around
            .map(|face| {
                let rest = RestTriangle::new(&face.map(|v| mesh.positions[v as usize]), 0)
                    .expect("equilateral");
                let [a, b, c] = face.map(|v| below[v as usize]);
                let [p, q, r] = face.map(|v| below[v as usize] + normals[v as usize] * OFFSET);
                let [_, _, drift] =
                    LayerSprings::new(&rest, &SPRINGS, [OFFSET; 3]).values(&[a, b, c, p, q, r]);
                drift / 3.0
            })
            .sum();
        let area = EDGE * EDGE * 0.75_f64.sqrt();
        let found = 2.0 * energy / (area * curvature * curvature);
        let expected = 3.0 / 16.0 * SPRINGS.tangential_stiffness * (OFFSET * EDGE).powi(2);
        assert!(
            (found / expected - 1.0).abs() < 1e-4,
            "{}",
            found / expected
        );
    }
}

#[test]
fn sheets_that_do_not_fit_are_refused() {
    let mesh = jittered(6, 5, EDGE, 0.25, 30);
    let (faces, count) = (mesh.faces.len(), mesh.positions.len());
    let join = |upper: UpperSheet| {
        let lower = LayerParameters::uniform(LOWER, faces, 0.0, count);
        let on = (&mesh.topology(), &mesh.positions[..], &free(&mesh)[..]);
        LayerEnergy::pair(on, lower, upper, BendingModel::Hinge).map(|_| ())
    };
    let whole = || upper(&raised(&mesh.positions), faces);
    assert_eq!(join(whole()), Ok(()));
    let [
        mut slack,
        mut no_offset,
        mut few_offsets,
        mut few_faces,
        mut few_places,
    ] = [0; 5].map(|_| whole());
    slack.parameters.tangential_stiffness[0] = -1.0;
    no_offset.offsets[0] = f64::NAN;
    for upper in [slack, no_offset] {
        let refused = join(upper);
        assert!(matches!(
            refused,
            Err(ShellError::ParameterOutOfRange { index: 0, .. })
        ));
    }
    few_offsets.offsets.pop();
    few_faces.parameters.faces.pop();
    few_places.rest_positions.pop();
    for upper in [few_offsets, few_faces, few_places] {
        let refused = join(upper);
        assert!(matches!(refused, Err(ShellError::LengthMismatch { .. })));
    }
}
