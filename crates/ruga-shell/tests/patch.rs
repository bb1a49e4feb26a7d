//! Patch test: an affine field leaves no force inside, on any mesh.

mod meshes;

use meshes::{jittered, outline, random_rotation, rng};
use nalgebra::{Matrix3, Vector3};
use ruga_shell::{FaceParameters, LayerEnergy, LayerParameters};

#[test]
fn affine_fields_are_in_equilibrium() {
    let (columns, rows, edge) = (14, 13, 2e-4);
    let mesh = jittered(columns, rows, edge, 0.35, 21);
    let skin = FaceParameters {
        young: 6e8,
        poisson: 0.48,
        thickness: 1.2e-4,
        normal_stiffness: 0.0,
        gradient_stiffness: 0.0,
    };
    let parameters = LayerParameters::uniform(skin, mesh.faces.len(), 0.0, mesh.positions.len());
    let pinned = outline(columns, rows);
    let layer = LayerEnergy::new(&mesh.topology(), &mesh.positions, parameters, &pinned).unwrap();
    // Forces per width E h (1 - nu^2)^-1, so residuals below 1e-12 E h times an edge.
    let limit = 1e-12 * skin.young * skin.thickness * edge;
    let turn = random_rotation(&mut rng(22));
    let fields = [
        Matrix3::new(0.9, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        Matrix3::new(1.1, 0.3, 0.0, -0.1, 0.8, 0.0, 0.0, 0.0, 1.0),
        turn * Matrix3::new(1.0, 0.2, 0.0, 0.0, 1.3, 0.0, 0.0, 0.0, 1.0),
    ];
    let mut gradient = vec![0.0; layer.dof_count()];
    for field in fields {
        let x: Vec<Vector3<f64>> = mesh.positions.iter().map(|p| field * p).collect();
        layer.gradient(&x, &mut gradient);
        let worst = gradient.iter().fold(0.0, |top: f64, g| g.abs().max(top));
        assert!(worst < limit, "{worst:e} N against {limit:e} N");
        // The energy is that of the homogeneous strain.
        let strain = 0.5 * (field.transpose() * field - Matrix3::identity());
        let strain = strain.fixed_view::<2, 2>(0, 0).into_owned();
        let density = 0.5
            * skin.tension_modulus()
            * ((1.0 - skin.poisson) * strain.dot(&strain)
                + skin.poisson * strain.trace() * strain.trace());
        let area: f64 = layer.vertex_areas().iter().sum();
        assert!((layer.value(&x) / (density * area) - 1.0).abs() < 1e-12);
    }
}
