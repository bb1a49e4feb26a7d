//! What must not change: rigid motion costs nothing, rest is force-free, runs repeat bit by bit.

mod meshes;

use meshes::{jittered, random_rotation, random_vector, rng};
use nalgebra::{Matrix2, Vector3};
use ruga_shell::{BendingModel, FaceParameters, LayerEnergy, LayerParameters};

const SKIN: FaceParameters = FaceParameters {
    young: 6e8,
    poisson: 0.48,
    thickness: 1.2e-4,
    normal_stiffness: 0.0,
    gradient_stiffness: 0.0,
};

const MODELS: [BendingModel; 2] = [BendingModel::Hinge, BendingModel::VertexCurvature];

/// A curved sheet, free of any foundation unless `normal` is set.
fn sheet(
    model: BendingModel,
    normal: f64,
    tangential: f64,
) -> (LayerEnergy, Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let mesh = jittered(12, 11, 2e-4, 0.25, 5);
    let rest: Vec<_> = mesh
        .positions
        .iter()
        .map(|p| p + Vector3::z() * (2e-4 * (4e3 * p.x).sin()))
        .collect();
    let face = FaceParameters {
        normal_stiffness: normal,
        ..SKIN
    };
    let parameters =
        LayerParameters::uniform(face, mesh.faces.len(), tangential, mesh.positions.len());
    let pinned = vec![false; rest.len()];
    let layer = LayerEnergy::with_bending(&mesh.topology(), &rest, parameters, &pinned, model)
        .expect("a valid sheet");
    (layer, rest, mesh.faces)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |top, v| v.abs().max(top))
}

#[test]
fn rest_is_free_of_force() {
    for model in MODELS {
        let (layer, rest, _) = sheet(model, 1e9, 2e9);
        let mut gradient = vec![1.0; layer.dof_count()];
        layer.gradient(&rest, &mut gradient);
        let unit = SKIN.tension_modulus() * 2e-4;
        assert!(largest(&gradient) < 1e-13 * unit);
        assert!(layer.value(&rest) < 1e-26 * unit);
    }
}

/// A sheet bent isometrically has no energy once its angles there count as rest.
#[test]
fn rest_angles_can_be_those_of_another_shape() {
    for model in MODELS {
        let (mut layer, rest, _) = sheet(model, 0.0, 0.0);
        let bent: Vec<_> = rest
            .iter()
            .map(|x| {
                let (radius, height) = (3e-3, x.z);
                let angle = x.x / radius;
                Vector3::new(
                    (radius + height) * angle.sin(),
                    x.y,
                    (radius + height) * angle.cos() - radius,
                )
            })
            .collect();
        let bending = |layer: &LayerEnergy, x: &[Vector3<f64>]| layer.energy_parts(x).bending;
        let before = bending(&layer, &bent);
        layer.set_rest_angles(&bent).expect("as many positions");
        assert!(bending(&layer, &bent) < 1e-20 * before);
        let straight = bending(&layer, &rest);
        assert!(
            (straight / before - 1.0).abs() < 1e-6,
            "{straight} {before}"
        );
        assert!(layer.set_rest_angles(&bent[1..]).is_err());
    }
}

/// The factor scales bending alone, and a new rest metric keeps it.
#[test]
fn the_bending_factor_scales_bending() {
    for model in MODELS {
        let (mut layer, rest, faces) = sheet(model, 0.0, 0.0);
        let lifted: Vec<_> = rest
            .iter()
            .map(|x| x + Vector3::z() * (1e-4 * (5e3 * x.y).sin()))
            .collect();
        let before = layer.energy_parts(&lifted);
        layer.set_bending_factor(1.25).expect("a positive factor");
        let unstretched = vec![Matrix2::identity(); faces.len()];
        layer.set_rest_metric(&unstretched).expect("as many faces");
        let after = layer.energy_parts(&lifted);
        assert!((after.bending / before.bending - 1.25).abs() < 1e-12);
        assert!((after.membrane / before.membrane - 1.0).abs() < 1e-12);
        for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(layer.set_bending_factor(factor).is_err(), "{factor}");
        }
    }
}

#[test]
fn rigid_motion_costs_nothing() {
    for model in MODELS {
        let (layer, rest, _) = sheet(model, 0.0, 0.0);
        // One per cent strain on every face is what the energy is compared with.
        let stretched: Vec<_> = rest.iter().map(|x| 1.01 * x).collect();
        let scale = layer.value(&stretched);
        let mut gradient = vec![0.0; layer.dof_count()];
        for seed in 0..10 {
            let mut rng = rng(seed);
            let turn = random_rotation(&mut rng);
            let shift = random_vector(&mut rng) * 1e-2;
            let moved: Vec<_> = rest.iter().map(|x| turn * x + shift).collect();
            assert!(layer.value(&moved) < 1e-14 * scale);
            layer.gradient(&moved, &mut gradient);
            assert!(largest(&gradient) < 1e-10 * SKIN.tension_modulus() * 2e-4);
        }
    }
}

#[test]
fn moving_layer_and_base_together_changes_nothing() {
    for model in MODELS {
        let (mut layer, rest, _) = sheet(model, 1e9, 2e9);
        let mut rng = rng(77);
        let x: Vec<_> = rest
            .iter()
            .map(|x| x + random_vector(&mut rng) * 2e-5)
            .collect();
        let normals: Vec<_> = rest
            .iter()
            .map(|_| (Vector3::z() + 0.3 * random_vector(&mut rng)).normalize())
            .collect();
        let offsets: Vec<_> = (0..rest.len()).map(|i| 1e-6 * i as f64).collect();
        layer.set_base(&rest, &normals, &offsets).unwrap();
        let before = layer.energy_parts(&x);
        let turn = random_rotation(&mut rng);
        let shift = random_vector(&mut rng) * 1e-3;
        let moved = |points: &[Vector3<f64>]| -> Vec<_> {
            points.iter().map(|p| turn * p + shift).collect()
        };
        let turned: Vec<_> = normals.iter().map(|n| turn * n).collect();
        layer.set_base(&moved(&rest), &turned, &offsets).unwrap();
        let after = layer.energy_parts(&moved(&x));
        for (a, b) in [
            (before.membrane, after.membrane),
            (before.bending, after.bending),
            (before.normal, after.normal),
            (before.gradient, after.gradient),
            (before.tangential, after.tangential),
        ] {
            assert!((a - b).abs() <= 1e-10 * before.total());
        }
    }
}

#[test]
fn translation_sums_of_the_hessian_are_the_foundation_alone() {
    for model in MODELS {
        let (layer, rest, _) = sheet(model, 0.0, 0.0);
        let mut rng = rng(3);
        let x: Vec<_> = rest
            .iter()
            .map(|x| x + random_vector(&mut rng) * 3e-5)
            .collect();
        let (starts, rows) = layer.pattern();
        let mut values = vec![0.0; rows.len()];
        layer.hessian(&x, &mut values, None);
        // H t for a translation t along x: rows must vanish.
        let mut product = vec![0.0; layer.dof_count()];
        for column in 0..layer.dof_count() {
            for k in starts[column]..starts[column + 1] {
                let row = rows[k] as usize;
                product[row] += values[k] * f64::from(column.is_multiple_of(3));
                if row != column {
                    product[column] += values[k] * f64::from(row.is_multiple_of(3));
                }
            }
        }
        assert!(largest(&product) < 1e-12 * largest(&values));
    }
}

#[test]
fn runs_repeat_bit_by_bit() {
    for model in MODELS {
        let (first, rest, _) = sheet(model, 1e9, 2e9);
        let (second, _, _) = sheet(model, 1e9, 2e9);
        let x: Vec<_> = rest.iter().map(|x| 0.97 * x).collect();
        let both = [&first, &second].map(|layer| {
            let mut gradient = vec![0.0; layer.dof_count()];
            let mut hessian = vec![0.0; layer.pattern().1.len()];
            layer.gradient(&x, &mut gradient);
            layer.hessian(&x, &mut hessian, None);
            (layer.value(&x).to_bits(), gradient, hessian)
        });
        assert_eq!(both[0], both[1]);
    }
}

#[test]
fn a_rest_stretch_moves_the_rest_state_to_the_stretched_shape() {
    let mesh = jittered(9, 8, 2e-4, 0.2, 9);
    let parameters = LayerParameters::uniform(SKIN, mesh.faces.len(), 0.0, mesh.positions.len());
    let pinned = vec![false; mesh.positions.len()];
    let mut layer =
        LayerEnergy::new(&mesh.topology(), &mesh.positions, parameters, &pinned).unwrap();
    // 30 % along a slanted direction, told to each face in its own frame.
    let along = Vector3::new(0.8, 0.6, 0.0);
    let stretches: Vec<_> = mesh
        .faces
        .iter()
        .map(|face| {
            let frame = ruga_mesh::triangle_frame(&face.map(|v| mesh.positions[v as usize]));
            let d = nalgebra::Vector2::new(frame[0].dot(&along), frame[1].dot(&along));
            Matrix2::identity() - 0.3 * d * d.transpose()
        })
        .collect();
    layer.set_rest_metric(&stretches).unwrap();
    let squeezed: Vec<_> = mesh
        .positions
        .iter()
        .map(|x| x - along * (0.3 * along.dot(x)))
        .collect();
    let unit = SKIN.tension_modulus() * 2e-4;
    let mut gradient = vec![0.0; layer.dof_count()];
    layer.gradient(&squeezed, &mut gradient);
    assert!(largest(&gradient) < 1e-13 * unit);
    let area: f64 = layer.vertex_areas().iter().sum();
    layer
        .set_rest_metric(&vec![Matrix2::identity(); mesh.faces.len()])
        .unwrap();
    let unstretched: f64 = layer.vertex_areas().iter().sum();
    assert!((area / unstretched - 0.7).abs() < 1e-12);
}

/// Every stencil gives all of its energy to its faces, over another base, too.
#[test]
fn energies_of_faces_add_up_to_the_whole() {
    for model in MODELS {
        let (mut layer, rest, faces) = sheet(model, 1e9, 2e9);
        layer.set_drift_gradient_stiffness(40.0).expect("valid");
        let mut rng = rng(17);
        let x: Vec<_> = rest
            .iter()
            .map(|p| p + 5e-5 * random_vector(&mut rng))
            .collect();
        let base: Vec<_> = rest.iter().map(|p| p + Vector3::z() * 1e-5).collect();
        let [found]: [_; 1] = layer
            .face_energies(&x, &base)
            .try_into()
            .expect("one sheet");
        assert_eq!(found.len(), faces.len());
        let total: f64 = found.iter().map(|face| face.total()).sum();
        let whole = layer.value_over(&x, &base);
        assert!((total / whole - 1.0).abs() < 1e-12, "{total} of {whole}");
        let bending: f64 = found.iter().map(|face| face.bending).sum();
        let whole = layer.energy_parts(&x).bending;
        assert!(
            (bending / whole - 1.0).abs() < 1e-12,
            "{bending} of {whole}"
        );
    }
}

/// A longer slice would keep what was there before.
#[test]
#[should_panic(expected = "one value per entry of the pattern")]
fn a_hessian_of_another_length_is_refused() {
    let (layer, rest, _) = sheet(BendingModel::Hinge, 1e9, 0.0);
    let entries = layer.pattern().1.len();
    layer.hessian(&rest, &mut vec![0.0; entries + 1], None);
}
