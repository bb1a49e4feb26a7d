//! The map from nodes to the surface: exact, smooth across elements, and its transpose.

mod shapes;

use nalgebra::{Matrix3, Vector3};
use ruga_lattice::{Embedding, Lattice, LatticePoint, LatticeSpec, Shape};
use ruga_mesh::{FaceId, MaterialPoint, vertex_normals};
use shapes::{Surface, block, random_vector, rng, spec, sphere, torus, two_slabs};

fn linear(cells: u32) -> LatticeSpec {
    LatticeSpec {
        shape: Shape::Linear,
        ..spec(cells)
    }
}

fn shaken(lattice: &Lattice, noise: f64) -> Vec<Vector3<f64>> {
    let mut rng = rng(4);
    let rest = lattice.rest_positions().iter();
    rest.map(|x| x + random_vector(&mut rng) * noise).collect()
}

#[test]
fn affine_motion_is_exact() {
    let f = Matrix3::new(1.3, 0.4, 0.1, -0.2, 0.7, 0.3, 0.0, 0.5, 1.1);
    let shift = Vector3::new(3.0, -2.0, 7.0);
    let surface = torus(1.0, 0.35, [30, 14]).and(two_slabs(0.03).shifted(2.0, 0.0, 0.0));
    for spec in [spec(7), linear(7)] {
        let lattice = surface.lattice(spec);
        let embedding = Embedding::of_vertices(&lattice).expect("no loose vertex");
        let q: Vec<_> = lattice
            .rest_positions()
            .iter()
            .map(|x| f * x + shift)
            .collect();
        for (found, rest) in embedding.positions(&q).iter().zip(&surface.positions) {
            assert!((found - (f * rest + shift)).norm() < 1e-13);
        }
        // Normals turn by the cofactor matrix.
        let cofactor = f.try_inverse().expect("regular").transpose();
        let normals = vertex_normals(&surface.mesh(), &surface.positions);
        for (found, rest) in embedding.normals(&q).iter().zip(&normals) {
            assert!((found - (cofactor * rest).normalize()).norm() < 1e-12);
        }
    }
}

#[test]
fn rows_weigh_the_nodes_of_one_element_and_sum_to_one() {
    let surface = sphere(1.0, 20, 12);
    for (spec, count) in [(spec(5), 27), (linear(5), 8)] {
        let lattice = surface.lattice(spec);
        let embedding = Embedding::of_vertices(&lattice).expect("no loose vertex");
        let [along, across] = embedding.tangent_rows();
        for row in 0..embedding.point_count() {
            assert_eq!(embedding.rows().row(row).count(), count);
            let sum = |terms: &mut dyn Iterator<Item = (u32, f64)>| terms.map(|t| t.1).sum::<f64>();
            assert!((sum(&mut embedding.rows().row(row)) - 1.0).abs() < 1e-14);
            for tangent in [along, across] {
                assert!(sum(&mut tangent.row(row)).abs() < 1e-13 / lattice.cell_size().min());
            }
        }
    }
}

/// At points of the surface on planes between cells: the lattice's points there in the elements on
/// both sides.
fn border_points(surface: &Surface, lattice: &Lattice) -> Vec<[LatticePoint; 2]> {
    let mesh = surface.mesh();
    let corner = lattice.element_corner(lattice.elements().next().expect("an element"));
    let mut points = Vec::new();
    for (face, vertices) in mesh.faces().iter() {
        let [a, b] = [vertices[0], vertices[1]].map(|v| surface.positions[v.0 as usize]);
        for axis in 0..3 {
            // Where the side a b crosses a plane, if it crosses one.
            let cells = |p: Vector3<f64>| (p[axis] - corner[axis]) / lattice.cell_size()[axis];
            let plane = cells(a).max(cells(b)).floor();
            if plane <= cells(a).min(cells(b)) {
                continue;
            }
            let share = (plane - cells(a)) / (cells(b) - cells(a));
            let at = |share: f64| {
                let barycentric = [1.0 - share, share, 0.0];
                let point = MaterialPoint { face, barycentric };
                lattice.locate(&point).expect("on the surface")
            };
            let border = a + (b - a) * share;
            let [low, high] = [at(share - 1e-6), at(share + 1e-6)];
            if low.element != high.element {
                points.push([low, high].map(|p| lattice.locate_in(p.element, &border)));
            }
        }
    }
    points
}

/// Largest jump of position and of a unit normal across borders between elements.
fn jumps(surface: &Surface, spec: LatticeSpec) -> [f64; 2] {
    let lattice = surface.lattice(spec);
    let points = border_points(surface, &lattice);
    assert!(points.len() > 50, "{}", points.len());
    let q = shaken(&lattice, 0.1 * lattice.cell_size().min());
    let normal = vec![Vector3::new(0.6, 0.0, 0.8); points.len()];
    let side = |k: usize| {
        let points: Vec<LatticePoint> = points.iter().map(|pair| pair[k]).collect();
        let embedding =
            Embedding::of_lattice_points(&lattice, &points, &normal).expect("good normals");
        (embedding.positions(&q), embedding.normals(&q))
    };
    let [low, high] = [side(0), side(1)];
    let largest = |a: &[Vector3<f64>], b: &[Vector3<f64>]| {
        let differences = a.iter().zip(b).map(|(a, b)| (a - b).norm());
        differences.fold(0.0, f64::max)
    };
    [largest(&low.0, &high.0), largest(&low.1, &high.1)]
}

#[test]
fn normals_are_continuous_across_quadratic_elements_and_jump_across_linear_ones() {
    let surface = torus(1.0, 0.35, [40, 20]);
    let [position, normal] = jumps(&surface, spec(6));
    assert!(
        position < 1e-14 && normal < 1e-12,
        "{position:e} {normal:e}"
    );
    let [position, normal] = jumps(&surface, linear(6));
    assert!(position < 1e-14, "{position:e}");
    assert!(normal > 0.1, "{normal}");
}

#[test]
fn normals_are_those_of_the_moved_surface() {
    // Against the surface's own normals, from points a small step apart.
    let surface = block([1.0, 1.0, 1.0], [3, 3, 3]);
    let lattice = surface.lattice(spec(3));
    let q = shaken(&lattice, 0.05);
    let step = 1e-5;
    for face in (0..surface.faces.len() as u32).map(FaceId) {
        let at = |u: f64, v: f64| MaterialPoint {
            face,
            barycentric: [0.4 - u - v, 0.3 + u, 0.3 + v],
        };
        let points = [
            at(0.0, 0.0),
            at(step, 0.0),
            at(-step, 0.0),
            at(0.0, step),
            at(0.0, -step),
        ];
        let embedding = Embedding::of_points(&lattice, &points).expect("on the surface");
        let x = embedding.positions(&q);
        let expected = (x[1] - x[2]).cross(&(x[3] - x[4])).normalize();
        assert!((embedding.normals(&q)[0] - expected).norm() < 1e-8);
    }
}

#[test]
fn pulled_back_forces_do_the_same_work() {
    let lattice = torus(1.0, 0.35, [30, 14]).lattice(spec(5));
    let embedding = Embedding::of_vertices(&lattice).expect("no loose vertex");
    let mut rng = rng(9);
    let mut random =
        |count: usize| -> Vec<_> { (0..count).map(|_| random_vector(&mut rng)).collect() };
    let (q, forces) = (
        random(lattice.node_count()),
        random(embedding.point_count()),
    );
    let work = |f: &[Vector3<f64>], x: &[Vector3<f64>]| -> f64 {
        f.iter().zip(x).map(|(f, x)| f.dot(x)).sum()
    };
    let on_points = work(&forces, &embedding.positions(&q));
    let on_nodes = work(&embedding.pull_back(&forces), &q);
    assert!(
        (on_points - on_nodes).abs() < 1e-11,
        "{on_points} {on_nodes}"
    );
    let total: Vector3<f64> = embedding.pull_back(&forces).iter().sum();
    assert!((total - forces.iter().sum::<Vector3<f64>>()).norm() < 1e-12);
}

#[test]
fn points_off_the_surface_belong_to_the_closest_piece() {
    let lattice = two_slabs(0.02).lattice(spec(2));
    let near = |z: f64| {
        let points = [Vector3::new(0.3, 0.6, z)];
        lattice.locate_near(&points).expect("finite")[0]
    };
    let [lower, upper] = [near(0.24), near(0.28)];
    let nodes = |p: LatticePoint| lattice.element_nodes(p.element).to_vec();
    assert!(nodes(lower).iter().all(|n| !nodes(upper).contains(n)));
    // In the gap, a little nearer to one side; and far outside.
    assert_eq!(near(0.258).element, lower.element);
    assert_eq!(near(0.262).element, upper.element);
    assert_eq!(near(-7.0).element, near(0.01).element);
    assert_eq!(near(7.0).element, near(0.5).element);
    for point in [lower, near(-7.0), near(0.26)] {
        let found = lattice.position(&point, lattice.rest_positions());
        assert!((found.xy() - nalgebra::Vector2::new(0.3, 0.6)).norm() < 1e-13);
        assert!(
            (lattice.deformation(&point, lattice.rest_positions()) - Matrix3::identity()).norm()
                < 1e-12
        );
    }
    // A point a quarter above the lower slab's upper side is carried by that slab all the same.
    let mesh = two_slabs(0.02).mesh();
    let points: Vec<MaterialPoint> = (mesh.faces().ids())
        .map(|face| MaterialPoint::at_corner(face, 0))
        .collect();
    let surface = two_slabs(0.02);
    let raise = |p: &MaterialPoint| p.interpolate(&mesh, &surface.positions) + Vector3::z() * 0.25;
    let raised: Vec<_> = points.iter().map(raise).collect();
    let normals = vec![Vector3::z(); points.len()];
    let on = Embedding::of_points(&lattice, &points).expect("on the surface");
    let above = Embedding::of_surface(&lattice, &points, &raised, &normals).expect("above it");
    for row in 0..points.len() / 2 {
        let nodes = |e: &Embedding| e.rows().row(row).map(|t| t.0).collect::<Vec<_>>();
        let shared = nodes(&on)
            .iter()
            .filter(|&n| nodes(&above).contains(n))
            .count();
        assert!(shared > 0, "another slab's nodes");
    }
}
