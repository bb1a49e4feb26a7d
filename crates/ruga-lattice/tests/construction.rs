//! Elements, nodes and volumes of known bodies (RK 5.1).

mod shapes;

use std::collections::BTreeSet;

use nalgebra::{Rotation3, Unit, Vector3};
use ruga_lattice::{ElementId, Lattice, LatticeSpec, Shape};
use ruga_mesh::{FaceId, MaterialPoint};
use shapes::{Surface, block, spec, sphere, torus, two_slabs};

fn linear(cells: u32) -> LatticeSpec {
    LatticeSpec {
        shape: Shape::Linear,
        ..spec(cells)
    }
}

fn nodes_of(lattice: &Lattice, element: ElementId) -> BTreeSet<u32> {
    let nodes: BTreeSet<u32> = (lattice.element_nodes(element).iter())
        .map(|n| n.0)
        .collect();
    assert_eq!(
        nodes.len(),
        lattice.shape().nodes_per_element(),
        "no node twice"
    );
    nodes
}

fn shared(lattice: &Lattice, a: u32, b: u32) -> usize {
    let [a, b] = [a, b].map(|e| nodes_of(lattice, ElementId(e)));
    a.intersection(&b).count()
}

/// Everything that holds for any lattice of a surface.
fn check(surface: &Surface, lattice: &Lattice) {
    let volume = surface.volume();
    assert!(
        (lattice.volume() / volume - 1.0).abs() < 1e-12,
        "volumes add up"
    );
    let cell = lattice.cell_size().product();
    for element in lattice.elements() {
        let share = lattice.element_volume(element) / cell;
        assert!(share > 0.0 && share < 1.0 + 1e-12, "{element:?}: {share}");
        nodes_of(lattice, element);
    }
    // Every face lies on the border of elements that reproduce it.
    let mesh = surface.mesh();
    for face in 0..surface.faces.len() as u32 {
        let point = MaterialPoint {
            face: FaceId(face),
            barycentric: [0.2, 0.5, 0.3],
        };
        let located = lattice.locate(&point).expect("a face of the surface");
        assert!(
            located
                .local
                .iter()
                .all(|t| (-1e-9..1.0 + 1e-9).contains(t))
        );
        let expected = point.interpolate(&mesh, &surface.positions);
        let found = lattice.position(&located, lattice.rest_positions());
        assert!((found - expected).norm() < 1e-13 * (1.0 + expected.norm()));
    }
}

#[test]
fn a_box_is_a_full_grid() {
    let surface = block([2.0, 1.0, 1.0], [4, 2, 2]).shifted(0.3, -5.0, 1.7);
    let lattice = surface.lattice(spec(4));
    check(&surface, &lattice);
    assert_eq!(lattice.element_count(), 4 * 2 * 2);
    assert_eq!(lattice.node_count(), 6 * 4 * 4);
    let trilinear = surface.lattice(linear(4));
    check(&surface, &trilinear);
    assert_eq!(trilinear.node_count(), 5 * 3 * 3);
    // Element 0, its upper neighbours along z, y and x, and the one across all three.
    for (other, [quadratic, linear]) in [(1, [18, 4]), (2, [18, 4]), (4, [18, 4]), (7, [8, 1])] {
        assert_eq!(shared(&lattice, 0, other), quadratic);
        assert_eq!(shared(&trilinear, 0, other), linear);
    }
}

#[test]
fn one_cell_holds_a_whole_body() {
    let surface = torus(1.0, 0.3, [24, 12]);
    let lattice = surface.lattice(spec(1));
    check(&surface, &lattice);
    assert_eq!((lattice.element_count(), lattice.node_count()), (1, 27));
}

#[test]
fn inner_cells_without_surface_are_full() {
    let surface = sphere(1.0, 40, 20);
    let lattice = surface.lattice(spec(8));
    check(&surface, &lattice);
    let cell = lattice.cell_size().product();
    let full = lattice
        .elements()
        .filter(|&e| lattice.element_volume(e) / cell > 1.0 - 1e-12);
    // Cells wholly within a ball of radius 4 cells: those whose far corner is.
    let half: Vec<i32> = (1..=4).collect();
    let within = half.iter().flat_map(|x| half.iter().map(move |y| (x, y)));
    let octant = within.flat_map(|(x, y)| half.iter().map(move |z| x * x + y * y + z * z));
    let expected = 8 * octant
        .filter(|&squared| f64::from(squared).sqrt() < 3.9)
        .count();
    assert_eq!(full.count(), expected);
}

#[test]
fn slabs_a_tenth_of_a_cell_apart_do_not_stick() {
    for cells in [1, 2, 3, 7] {
        // The slabs' box is 1 x 1 x about 0.5, so a cell's height is about 1 / cells.
        let surface = two_slabs(0.1 / f64::from(cells));
        for spec in [spec(cells), linear(cells)] {
            let lattice = surface.lattice(spec);
            check(&surface, &lattice);
            let gap = 0.1 / f64::from(cells) / lattice.cell_size().z;
            assert!((0.05..0.21).contains(&gap), "{gap} of a cell");
            assert_eq!(bodies(&lattice), 2, "{cells} cells");
        }
    }
}

/// Number of groups of elements that hang together by their nodes.
fn bodies(lattice: &Lattice) -> usize {
    let mut groups: Vec<BTreeSet<u32>> = Vec::new();
    for element in lattice.elements() {
        let mut nodes = nodes_of(lattice, element);
        groups.retain(|group| {
            let joined = !group.is_disjoint(&nodes);
            if joined {
                nodes.extend(group);
            }
            !joined
        });
        groups.push(nodes);
    }
    groups.len()
}

/// Two prongs along x from 0.9 to 4, `gap` apart, on a common back: a mouth with its lips.
fn fork(gap: f64) -> Surface {
    let outline = [
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 1.0],
        [0.9, 1.0],
        [0.9, 1.0 + gap],
        [4.0, 1.0 + gap],
        [4.0, 2.0 + gap],
        [0.0, 2.0 + gap],
    ];
    let n = outline.len() as u32;
    let mut surface = Surface::default();
    for y in [0.0, 1.0] {
        let points = outline.map(|[x, z]| Vector3::new(x, y, z));
        surface.positions.extend(points);
    }
    for i in 0..n {
        let j = (i + 1) % n;
        surface.faces.extend([[i, n + j, j], [i, n + i, n + j]]);
    }
    for [a, b, c] in [
        [0, 1, 3],
        [1, 2, 3],
        [0, 3, 4],
        [0, 4, 7],
        [7, 4, 6],
        [4, 5, 6],
    ] {
        surface.faces.extend([[a, b, c], [n + a, n + c, n + b]]);
    }
    surface
}

#[test]
fn lips_hang_together_only_at_the_back() {
    let surface = fork(0.05);
    assert!(surface.volume() > 0.0);
    // With four cells along x there are two in height, so that the slot lies around a plane; with
    // six and ten it lies in one layer of cells, whose elements are superimposed.
    for cells in [4, 6, 10] {
        let lattice = surface.lattice(spec(cells));
        check(&surface, &lattice);
        assert_eq!(bodies(&lattice), 1);
        let element = |x: f64, z: f64| {
            let points = [Vector3::new(x, 0.5, z)];
            lattice.locate_near(&points).expect("finite")[0].element
        };
        let common = |x: f64| {
            let [a, b] = [0.99, 1.06].map(|z| element(x, z));
            let [a, b] = [a, b].map(|e| nodes_of(&lattice, e));
            a.intersection(&b).count()
        };
        assert_eq!(common(3.9), 0, "tips share nodes with {cells} cells");
        assert!(common(0.1) >= 18);
        let corners = [element(3.9, 0.99), element(3.9, 1.06)].map(|e| lattice.element_corner(e).z);
        assert_eq!(corners[0] == corners[1], cells > 4, "superimposed");
    }
}

#[test]
fn a_hollow_belongs_to_the_piece_around_it() {
    let ball = |radius: f64| sphere(radius, 12, 8).rotated([1.0, 2.0, 3.0], 0.7);
    let surface = block([1.0, 1.0, 1.0], [3, 3, 3])
        .and(ball(0.1).shifted(0.3, 0.3, 0.3).inside_out())
        .and(ball(0.08).shifted(0.55, 0.3, 0.3).inside_out())
        .and(ball(0.03).shifted(0.3, 0.3, 0.3));
    for cells in [1, 2, 3, 7] {
        let lattice = surface.lattice(spec(cells));
        check(&surface, &lattice);
        let kernel = lattice.locate(&MaterialPoint::at_corner(
            FaceId(surface.faces.len() as u32 - 1),
            0,
        ));
        let [shell] = lattice
            .locate_near(&[Vector3::new(0.3, 0.3, 0.45)])
            .expect("finite")[..]
        else {
            panic!("one point");
        };
        assert_ne!(kernel.expect("a face").element, shell.element);
    }
    let lattice = surface.lattice(spec(1));
    assert_eq!(
        lattice.element_count(),
        2,
        "the block with its hollows, and the kernel"
    );
}

#[test]
fn a_hollow_is_not_given_to_a_bigger_piece_of_the_same_cell() {
    let hollow = sphere(0.04, 8, 6)
        .rotated([1.0, 2.0, 3.0], 0.7)
        .inside_out();
    let thin = block([1.0, 1.0, 0.1], [4, 4, 1]);
    let thick = block([1.0, 1.0, 0.3], [4, 4, 1]).shifted(0.0, 0.0, 0.12);
    let surface = thin.and(thick).and(hollow.clone().shifted(0.2, 0.3, 0.05));
    let lattice = surface.lattice(spec(2));
    check(&surface, &lattice);
    let points = [Vector3::new(0.2, 0.3, 0.095), Vector3::new(0.2, 0.3, 0.2)];
    let located = lattice.locate_near(&points).expect("finite");
    let [below, above] = [0, 1].map(|k| lattice.element_volume(located[k].element));
    // A quarter of each slab, but for the grid's slack; the hollow is negative.
    assert!((below - (0.025 + hollow.volume())).abs() < 1e-5, "{below}");
    assert!((above - 0.075).abs() < 2e-5, "{above}");
    assert!(hollow.volume() < -1e-4);
}

#[test]
fn any_orientation_and_resolution_fits_together() {
    for seed in 0..8u32 {
        let turn = f64::from(seed) * 0.37;
        let surface = torus(1.0, 0.35, [30, 14])
            .rotated([1.0, 0.3, f64::from(seed) - 3.0], turn)
            .shifted(0.1 * turn, -3.0, 1e3);
        let lattice = surface.lattice(spec(2 + seed));
        assert!((lattice.volume() / surface.volume() - 1.0).abs() < 1e-9);
        let lattice = torus(1.0, 0.35, [30, 14]).lattice(spec(2 + seed));
        check(&torus(1.0, 0.35, [30, 14]), &lattice);
    }
}

#[test]
fn symmetric_bodies_whose_vertices_lie_on_planes_are_cut_elsewhere() {
    for cells in 1..9 {
        let surface = block([1.0, 1.0, 1.0], [cells; 3]);
        let lattice = surface.lattice(spec(cells as u32));
        check(&surface, &lattice);
        assert_eq!(lattice.element_count(), cells.pow(3));
    }
}

/// Two linked rings, and how deep a point lies in them (m, negative inside).
fn chain() -> (Surface, impl Fn(&Vector3<f64>) -> f64) {
    let (ring, tube) = (1.0, 0.28);
    let link = torus(ring, tube, [60, 28]);
    let other = |p: &Vector3<f64>| Vector3::new(p.x + 1.0, p.z, -p.y);
    let surface = link
        .clone()
        .and(link.map(other))
        .rotated([1.0, 0.4, 0.2], 0.6);
    let turn = Rotation3::from_axis_angle(&Unit::new_normalize(Vector3::new(1.0, 0.4, 0.2)), -0.6);
    let depth = move |p: &Vector3<f64>| {
        let p = turn * p;
        let to_ring = |p: Vector3<f64>| (p.xy().norm() - ring).hypot(p.z) - tube;
        to_ring(p).min(to_ring(Vector3::new(p.x - 1.0, -p.z, p.y)))
    };
    (surface, depth)
}

#[test]
fn pieces_are_those_of_a_flood_fill() {
    let (surface, depth) = chain();
    for cells in [1, 2, 3, 5] {
        let lattice = surface.lattice(spec(cells));
        check(&surface, &lattice);
        assert_eq!(bodies(&lattice), 2, "the links are apart");
        let pieces = lattice.elements().map(|e| check_cell(&lattice, e, &depth));
        assert!(pieces.max() > Some(1), "no elements are superimposed");
    }
}

/// All samples of a cell that hang together lie in one element, and those that don't in several;
/// how many there are.
fn check_cell(
    lattice: &Lattice,
    element: ElementId,
    depth: impl Fn(&Vector3<f64>) -> f64,
) -> usize {
    const N: usize = 10;
    let corner = lattice.element_corner(element);
    let place = |at: [usize; 3]| {
        let local = Vector3::from(at.map(|i| (i as f64 + 0.5) / N as f64));
        corner + local.component_mul(&lattice.cell_size())
    };
    let all = (0..N * N * N).map(|s| [s / (N * N), s / N % N, s % N]);
    // Clear of the facets, which lie a little inside the round torus.
    let mut left: BTreeSet<[usize; 3]> = all.filter(|&at| depth(&place(at)) < -0.01).collect();
    let mut seen = BTreeSet::new();
    while let Some(seed) = left.pop_first() {
        let mut group = vec![seed];
        let mut next = 0;
        while let Some(&at) = group.get(next) {
            next += 1;
            for axis in 0..3 {
                for step in [usize::MAX, 1] {
                    let mut beside = at;
                    beside[axis] = at[axis].wrapping_add(step);
                    if left.remove(&beside) {
                        group.push(beside);
                    }
                }
            }
        }
        let points: Vec<Vector3<f64>> = group.iter().map(|&at| place(at)).collect();
        let located = lattice.locate_near(&points).expect("finite");
        assert!(located.iter().all(|p| p.element == located[0].element));
        let is_new = seen.insert(located[0].element);
        assert!(
            is_new || group.len() < 4,
            "a group of {} shares an element",
            group.len()
        );
    }
    seen.len()
}
