//! One constraint function on two meshes of one surface gives one average.

mod meshes;

use meshes::{Patch, irregular_square};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_constraint::{Kernel, Sampling};

const KERNEL: Kernel = Kernel {
    sigma: 0.16,
    cut: 2.5,
};
/// Supports of centres up to here lie inside [-1, 1]².
const INSIDE: f64 = 0.55;

/// Places of [-1, 1]²: inside, near the border, and on it. Anywhere in the faces.
fn places(reach: std::ops::Range<f64>) -> Vec<[f64; 2]> {
    let mut random = Pcg64Mcg::seed_from_u64(11);
    let mut place = || [0, 1].map(|_| random.random_range(-1.0..=1.0_f64));
    let norm = |[x, y]: &[f64; 2]| x.abs().max(y.abs());
    let candidates = std::iter::repeat_with(&mut place).take(2000);
    candidates
        .filter(|p| reach.contains(&norm(p)))
        .take(30)
        .collect()
}

/// A coarse and a fine mesh, with other points, other triangles and borders cut at other places.
fn two_meshes(surface: Lift) -> [Patch; 2] {
    [(23, 1), (50, 2)].map(|(cells, seed)| irregular_square(cells, seed, &[]).mapped(surface))
}

/// Largest difference of a field's averages on two meshes.
fn difference(
    meshes: &[Patch; 2],
    centres: &[Vector3<f64>],
    sampling: Sampling,
    field: impl Fn(&Vector3<f64>) -> f64,
) -> f64 {
    let averages = meshes.each_ref().map(|patch| -> Vec<f64> {
        let set = patch.rows_at(&patch.places_near(centres), KERNEL, sampling);
        assert_eq!(set.rows.len(), centres.len());
        assert!(set.degraded.is_empty(), "{:?}", set.degraded);
        let average = |row| patch.average(row, &field);
        set.rows.iter().map(average).collect()
    });
    let pairs = averages[0].iter().zip(&averages[1]);
    pairs.fold(0.0, |worst, (a, b)| worst.max((a - b).abs()))
}

/// From the plane to a place in space.
type Lift = fn(Vector3<f64>) -> Vector3<f64>;

/// Flat, part of a tube and a cap of a sphere, with radii of 3 and 6 support radii.
const SURFACES: [(&str, Lift); 3] = [
    ("flat", |p| p),
    ("tube", |p| {
        let radius = 1.25;
        let (sin, cos) = (p.x / radius).sin_cos();
        Vector3::new(radius * sin, p.y, radius * cos)
    }),
    ("cap", |p| {
        let radius = 2.5_f64;
        Vector3::new(
            p.x,
            p.y,
            (radius.powi(2) - p.x.powi(2) - p.y.powi(2)).sqrt(),
        )
    }),
];

/// Places inside, near the border, and on it.
fn regions() -> [(&'static str, Vec<[f64; 2]>); 3] {
    let border = (0..30).map(|i| [-1.0, -0.97 + 0.0653 * f64::from(i)]);
    [
        ("inside", places(0.0..INSIDE)),
        ("near the border", places(0.7..0.99)),
        ("on the border", border.collect()),
    ]
}

fn affine(p: &Vector3<f64>) -> f64 {
    0.7 * p.x - 0.4 * p.y + 0.2 * p.z
}

/// Of height one, a wavelength in four supports.
fn smooth(p: &Vector3<f64>) -> f64 {
    (2.0 * p.x + 0.4).sin() * (1.5 * p.y - 0.3).cos() + p.z
}

#[test]
fn averages_of_an_affine_field_on_a_plane_are_the_same_on_every_mesh() {
    let meshes = two_meshes(|p| p);
    for (region, places) in regions() {
        let centres: Vec<_> = places
            .iter()
            .map(|&[x, y]| Vector3::new(x, y, 0.0))
            .collect();
        let worst = |sampling| difference(&meshes, &centres, sampling, affine) / KERNEL.radius();
        // A clipped kernel's centroid is integrated on the mesh, by a rule of degree five.
        let bound = if region == "inside" { 1e-13 } else { 3e-4 };
        for sampling in [Sampling::Adjusted, Sampling::Quadrature] {
            let worst = worst(sampling);
            assert!(worst < bound, "{sampling:?} {region}: {worst:.1e}");
        }
        let area = worst(Sampling::Area);
        assert!(area > 1e-3, "{region}: {area:.1e}");
    }
}

#[test]
fn averages_of_a_smooth_field_are_nearly_the_same_on_flat_and_curved_meshes() {
    println!("support of 4.6 and 10 edges:          area  adjusted  quadrature");
    for (name, surface) in SURFACES {
        let meshes = two_meshes(surface);
        for (region, places) in regions() {
            let centres: Vec<_> = places
                .iter()
                .map(|&[x, y]| surface(Vector3::new(x, y, 0.0)))
                .collect();
            let [area, adjusted, quadrature] =
                [Sampling::Area, Sampling::Adjusted, Sampling::Quadrature]
                    .map(|sampling| difference(&meshes, &centres, sampling, smooth));
            println!("{name:5} {region:16} {area:18.1e} {adjusted:9.1e} {quadrature:11.1e}");
            assert!(adjusted < 3e-3 && adjusted < area, "{name} {region}");
            // The average of what is linear on each triangle misses the field's curvature by the
            // same amount everywhere: f'' h²/12 and twice that, 3e-3 for the coarse mesh.
            assert!(quadrature < 4e-3, "{name} {region}");
        }
    }
}

#[test]
fn a_row_moves_as_little_as_its_centre() {
    let patch = irregular_square(30, 4, &[[0.2, -0.2]]);
    let centre = Vector3::new(0.2, -0.2, 0.0);
    let vertex = patch.vertex_near(centre);
    assert!((patch.positions[vertex.0 as usize] - centre).norm() < 1e-12);
    for sampling in [Sampling::Area, Sampling::Adjusted, Sampling::Quadrature] {
        let at_vertex = patch.rows(&[vertex], KERNEL, sampling);
        let value = patch.average(&at_vertex.rows[0], smooth);
        for step in [1e-3, 1e-5, 1e-7] {
            let beside = patch.places_near(&[centre + Vector3::new(step, 0.4 * step, 0.0)]);
            let set = patch.rows_at(&beside, KERNEL, sampling);
            let change = (patch.average(&set.rows[0], smooth) - value).abs();
            // Quadrature's lattice turns when another vertex gives its axis.
            let bound = 4.0 * step + 2e-5;
            assert!(change < bound, "{sampling:?} {step}: {change:.1e}");
        }
    }
}
