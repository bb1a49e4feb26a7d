//! The energy of a part of a layer against that of the whole, with all other vertices held.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod differences;
mod meshes;
mod pairs;

use differences::{MODELS, dense};
use meshes::{Mesh, jittered, outline, random_vector, rng, symmetric};
use nalgebra::{DMatrix, Matrix2, Vector3};
use rand::RngExt;
use rand_pcg::Pcg64;
use ruga_shell::{
    BendingModel, FaceParameters, LayerEnergy, LayerParameters, LayerPart, PartIndex,
};

const COLUMNS: usize = 11;
const ROWS: usize = 10;

const FACE: FaceParameters = FaceParameters {
    young: 8.0,
    poisson: 0.4,
    thickness: 0.4,
    normal_stiffness: 1.5,
    gradient_stiffness: -0.4,
};

/// Rounding of a sum over the layer, as a share of its energy.
const TOLERANCE: f64 = 1e-12;

/// A layer, its surface when built, and a state.
struct Posed {
    layer: LayerEnergy,
    rest: Vec<Vector3<f64>>,
    faces: usize,
    x: Vec<Vector3<f64>>,
    rng: Pcg64,
}

/// A Delaunay mesh of scattered points: vertices have between three and nine neighbours or so.
fn irregular() -> Mesh {
    let positions = jittered(COLUMNS, ROWS, 1.0, 0.45, 21).positions;
    let points = positions.iter();
    let points: Vec<_> = points
        .map(|p| delaunator::Point { x: p.x, y: p.y })
        .collect();
    let triangles = delaunator::triangulate(&points).triangles;
    // Delaunator winds clockwise in a y-up plane.
    let faces = triangles.chunks_exact(3);
    Mesh {
        faces: faces
            .map(|t| [t[0], t[2], t[1]].map(|v| v as u32))
            .collect(),
        positions,
    }
}

fn posed(model: BendingModel, pinned: &[bool]) -> Posed {
    let mesh = irregular();
    let mut rng = rng(22);
    let (faces, count) = (mesh.faces.len(), mesh.positions.len());
    let mut parameters = LayerParameters::uniform(FACE, faces, 0.0, count);
    for face in &mut parameters.faces {
        face.thickness += 0.1 * symmetric(&mut rng);
        face.poisson += 0.05 * symmetric(&mut rng);
    }
    for stiffness in &mut parameters.tangential_stiffness {
        *stiffness = rng.random_range(0.5..1.0);
    }
    let bump = |p: &Vector3<f64>| p + Vector3::z() * (0.3 * (0.7 * p.x * p.y).sin());
    let rest: Vec<_> = mesh.positions.iter().map(bump).collect();
    let layer = LayerEnergy::with_bending(&mesh.topology(), &rest, parameters, pinned, model);
    let layer = layer.expect("a valid layer");
    let moved = |p: &Vector3<f64>| 0.95 * p + 0.1 * random_vector(&mut rng);
    let x = rest.iter().map(moved).collect();
    let mut posed = Posed {
        layer,
        rest,
        faces,
        x,
        rng,
    };
    posed.change();
    posed
}

/// The lower half of the outline and two vertices inside.
fn some_pinned() -> Vec<bool> {
    let mut pinned = outline(COLUMNS, ROWS);
    pinned[ROWS / 2 * COLUMNS..].fill(false);
    pinned[4 * COLUMNS + 3] = true;
    pinned[6 * COLUMNS + 7] = true;
    pinned
}

impl Posed {
    /// Gives the layer another rest metric, natural strains and curvatures, rest angles, bending factor,
    /// material and base.
    fn change(&mut self) {
        let Self { layer, rng, .. } = self;
        let mut matrices = |scale: f64| -> Vec<_> {
            let matrix = |_| {
                let shear = symmetric(rng);
                scale * Matrix2::new(symmetric(rng), shear, shear, symmetric(rng))
            };
            (0..self.faces).map(matrix).collect()
        };
        let mut stretches = matrices(0.1);
        for stretch in &mut stretches {
            *stretch += Matrix2::identity();
        }
        layer.set_rest_metric(&stretches).unwrap();
        layer.set_natural_strains(&matrices(0.03)).unwrap();
        if layer.bending_model() == BendingModel::VertexCurvature {
            layer.set_natural_curvatures(&matrices(0.2)).unwrap();
        }
        let mut moved = |by: f64| -> Vec<_> {
            let rest = self.rest.iter();
            rest.map(|p| p + by * random_vector(rng)).collect()
        };
        layer.set_rest_angles(&moved(0.1)).unwrap();
        let points = moved(0.1);
        layer
            .set_bending_factor(rng.random_range(0.5..2.0))
            .unwrap();
        let mut faces = vec![FACE; self.faces];
        for face in &mut faces {
            face.young += symmetric(rng);
            face.thickness += 0.1 * symmetric(rng);
            face.normal_stiffness += 0.5 * symmetric(rng);
        }
        layer.set_face_parameters(&faces).unwrap();
        layer
            .set_drift_gradient_stiffness(rng.random_range(0.5..1.0))
            .unwrap();
        let left: Vec<_> = faces.iter().map(|_| rng.random_range(0.02..1.0)).collect();
        layer.set_area_left(&left).unwrap();
        let tilted = |_: &_| (Vector3::z() + 0.4 * random_vector(rng)).normalize();
        let normals: Vec<_> = points.iter().map(tilted).collect();
        let offsets: Vec<_> = points.iter().map(|_| rng.random_range(0.0..0.1)).collect();
        layer.set_base(&points, &normals, &offsets).unwrap();
    }

    /// Sets of free vertices: none, one inside, one at the border beside pinned ones, a disc, every
    /// third, all.
    fn patches(&self) -> Vec<Vec<u32>> {
        let free = self.layer.free_vertices();
        let [inside, border] = [5 * COLUMNS + 5, ROWS / 2 * COLUMNS].map(|v| v as u32);
        let centre = self.rest[inside as usize];
        let near = |v: &u32| (self.rest[*v as usize] - centre).norm() < 2.5;
        let patches = vec![
            vec![],
            vec![inside],
            vec![border],
            free.iter().copied().filter(near).collect(),
            free.iter().copied().step_by(3).collect(),
            free.to_vec(),
        ];
        assert!(
            patches[3].len() > 10,
            "a disc of {} vertices",
            patches[3].len()
        );
        patches
    }
}

/// The part of a layer of one sheet in which some vertices move.
fn part_of(layer: &LayerEnergy, free: &[u32]) -> LayerPart {
    PartIndex::new(layer).expect("one sheet").part(layer, free)
}

fn of_part<T: Copy>(part: &LayerPart, values: &[T]) -> Vec<T> {
    let vertices = part.vertices().iter();
    vertices.map(|&v| values[v as usize]).collect()
}

/// Gradient, exact and relaxed Hessian of a layer, and how many entries its pattern has between
/// unknowns of `kept` free vertices.
fn derivatives(
    layer: &LayerEnergy,
    x: &[Vector3<f64>],
    kept: &[usize],
) -> ([DMatrix<f64>; 3], usize) {
    let dofs: Vec<usize> = kept.iter().flat_map(|k| 3 * k..3 * k + 3).collect();
    let (starts, rows) = layer.pattern();
    // Not zero, so that whoever only adds is found out.
    let mut gradient = vec![7.0; layer.dof_count()];
    let mut exact = vec![7.0; rows.len()];
    let mut relaxed = exact.clone();
    layer.gradient(x, &mut gradient);
    layer.hessian(x, &mut exact, Some(&mut relaxed));
    let gradient = DMatrix::from_column_slice(gradient.len(), 1, &gradient);
    let matrix = |values: &[f64]| {
        let dense = dense((starts, rows), values);
        dense.select_rows(&dofs).select_columns(&dofs)
    };
    let is_kept = |dof: usize| dofs.binary_search(&dof).is_ok();
    let columns = starts.windows(2).enumerate().filter(|(c, _)| is_kept(*c));
    let entries = columns.flat_map(|(_, range)| &rows[range[0]..range[1]]);
    let count = entries.filter(|row| is_kept(**row as usize)).count();
    let all = [
        gradient.select_rows(&dofs),
        matrix(&exact),
        matrix(&relaxed),
    ];
    (all, count)
}

/// Asserts that a part has the whole's derivatives at its free vertices, bit for bit.
fn check_derivatives(part: &LayerPart, posed: &Posed, free: &[u32]) {
    let (whole, energy) = (&posed.layer, part.energy());
    assert!(part.vertices().is_sorted_by(|a, b| a < b));
    let asked = energy.free_vertices().iter();
    let asked: Vec<_> = asked.map(|&v| part.vertices()[v as usize]).collect();
    assert_eq!(asked, free);

    let x = of_part(part, &posed.x);
    let in_whole: Vec<_> = free
        .iter()
        .map(|&v| whole.blocks().free(v).expect("a free vertex"))
        .collect();
    let in_part: Vec<_> = (0..free.len()).collect();
    let found = derivatives(energy, &x, &in_part);
    assert_eq!(found, derivatives(whole, &posed.x, &in_whole));
    assert_eq!(
        found.1,
        energy.pattern().1.len(),
        "no entries beyond the whole's"
    );
    for matrix in &found.0 {
        assert!(matrix.iter().all(|v| v.is_finite()));
    }
    assert_eq!(
        energy.deviations(&x),
        of_part(part, &whole.deviations(&posed.x))
    );
    assert_eq!(energy.vertex_areas(), of_part(part, whole.vertex_areas()));
    let (ours, theirs) = (energy.foundation_stiffness(), whole.foundation_stiffness());
    for (local, &v) in (0..).zip(part.vertices()) {
        let is_free = energy.blocks().free(local).is_some();
        // The spring of a vertex that stands still belongs to no free vertex.
        let expected = if is_free {
            theirs.tangential[v as usize]
        } else {
            0.0
        };
        assert_eq!(ours.tangential[local as usize], expected);
    }
}

/// Asserts that a part's energies change as the whole's do when its free vertices move.
fn check_differences(part: &LayerPart, posed: &mut Posed, free: &[u32]) {
    let mut y = posed.x.clone();
    for &vertex in free {
        y[vertex as usize] += 0.05 * random_vector(&mut posed.rng);
    }
    let parts = |layer: &LayerEnergy, x: &[Vector3<f64>]| {
        let parts = layer.energy_parts(x);
        let over = layer.value_over(x, &vec![Vector3::zeros(); x.len()]);
        [
            layer.value(x),
            over,
            parts.membrane,
            parts.bending,
            parts.normal,
            parts.gradient,
            parts.tangential,
        ]
    };
    let whole = [&posed.x, &y].map(|x| parts(&posed.layer, x));
    let ours = [&posed.x, &y].map(|x| parts(part.energy(), &of_part(part, x)));
    for k in 0..whole[0].len() {
        let [expected, found] = [whole, ours].map(|[before, after]| after[k] - before[k]);
        let scale = whole[0][k].abs() + whole[1][k].abs();
        assert!(
            (expected - found).abs() < TOLERANCE * scale,
            "energy {k}: {expected} {found} of {scale}"
        );
        assert!(free.is_empty() || expected.abs() > 1e4 * TOLERANCE * scale);
    }
}

#[test]
fn a_part_has_the_derivatives_of_the_whole() {
    for model in MODELS {
        let posed = posed(model, &some_pinned());
        for free in posed.patches() {
            let part = part_of(&posed.layer, &free);
            assert_eq!(part.energy().bending_model(), model);
            check_derivatives(&part, &posed, &free);
        }
    }
}

#[test]
fn a_part_has_the_value_differences_of_the_whole() {
    for model in MODELS {
        let mut posed = posed(model, &some_pinned());
        for free in posed.patches() {
            let part = part_of(&posed.layer, &free);
            check_differences(&part, &mut posed, &free);
        }
    }
}

#[test]
fn a_part_follows_the_whole() {
    for model in MODELS {
        let mut posed = posed(model, &some_pinned());
        let patches = posed.patches();
        let index = PartIndex::new(&posed.layer).expect("one sheet");
        let parts = patches.iter().map(|free| index.part(&posed.layer, free));
        let mut parts: Vec<_> = parts.collect();
        posed.change();
        for (part, free) in parts.iter_mut().zip(&patches) {
            let before = part.clone();
            part.follow(&posed.layer);
            check_derivatives(part, &posed, free);
            check_differences(part, &mut posed, free);
            let x = of_part(part, &posed.x);
            let [before, after] = [&before, &*part].map(|part| part.energy().value(&x));
            assert!(free.is_empty() || before != after);
        }
    }
}

/// Nothing else in the part changes either: a base of one frame does not outlive the next.
#[test]
fn a_part_that_follows_is_the_part_made_anew() {
    for model in MODELS {
        let mut posed = posed(model, &some_pinned());
        for free in posed.patches() {
            let mut part = part_of(&posed.layer, &free);
            posed.change();
            let anew = |posed: &Posed| format!("{:?}", part_of(&posed.layer, &free));
            part.follow(&posed.layer);
            assert_eq!(format!("{part:?}"), anew(&posed));
            posed.layer.set_drift_gradient_stiffness(0.0).unwrap();
            part.follow(&posed.layer);
            assert_eq!(format!("{part:?}"), anew(&posed));
        }
    }
}

/// With other base points, too, and the springs' pull on each vertex that moves.
#[test]
fn a_part_has_the_gradient_of_the_whole_over_other_points() {
    for model in MODELS {
        let mut posed = posed(model, &some_pinned());
        for free in posed.patches() {
            let part = part_of(&posed.layer, &free);
            let rest = posed.rest.iter();
            let moved = rest.map(|p| p + 0.1 * random_vector(&mut posed.rng));
            let points: Vec<_> = moved.collect();
            let (whole, energy) = (&posed.layer, part.energy());
            let mut gradient = vec![7.0; whole.dof_count()];
            let mut ours = vec![7.0; energy.dof_count()];
            let pull = whole.gradient_over(&posed.x, &points, &mut gradient);
            let (x, points) = (of_part(&part, &posed.x), of_part(&part, &points));
            let our_pull = energy.gradient_over(&x, &points, &mut ours);
            for ((k, &v), &local) in free.iter().enumerate().zip(energy.free_vertices()) {
                let at = 3 * whole.blocks().free(v).expect("a free vertex");
                assert_eq!(ours[3 * k..3 * k + 3], gradient[at..at + 3]);
                assert_eq!(our_pull[local as usize], pull[v as usize]);
            }
        }
    }
}

#[test]
fn a_part_of_all_vertices_has_the_value_of_the_whole() {
    for model in MODELS {
        let posed = posed(model, &[false; COLUMNS * ROWS]);
        let part = part_of(&posed.layer, posed.layer.free_vertices());
        assert_eq!(part.vertices().len(), posed.x.len());
        let [ours, theirs] = [part.energy(), &posed.layer].map(|layer| layer.value(&posed.x));
        assert!((ours - theirs).abs() < TOLERANCE * theirs.abs());
    }
}

/// A stencil that no free vertex touches is left out, and so are the vertices beyond the stencils.
#[test]
fn a_part_is_as_small_as_its_stencils() {
    for model in MODELS {
        let posed = posed(model, &some_pinned());
        let free = &posed.patches()[1];
        let part = part_of(&posed.layer, free);
        let mut known = vec![free[0]];
        // A star beside a free vertex reaches as far as the apex of a hinge: two rings.
        for _ in 0..2 {
            let faces = irregular().faces.into_iter();
            let beside = faces.filter(|face| face.iter().any(|v| known.contains(v)));
            known = beside.flatten().collect();
        }
        assert!(part.vertices().iter().all(|v| known.contains(v)));
        assert!(part.vertices().len() < posed.x.len() / 3);
    }
}

#[test]
fn a_pair_of_sheets_has_no_parts() {
    let (pair, _) = pairs::thick().build(4, 4, 1e-3);
    assert!(PartIndex::new(&pair).is_none());
}

#[test]
#[should_panic(expected = "vertex 0 is pinned")]
fn a_pinned_vertex_is_not_free_in_a_part() {
    let posed = posed(BendingModel::Hinge, &some_pinned());
    part_of(&posed.layer, &[0]);
}

/// Rather than to bend by a stiffness made of faces that the part doesn't have.
#[test]
fn a_copy_of_a_part_refuses_another_bending_factor() {
    for model in MODELS {
        let posed = posed(model, &some_pinned());
        let part = part_of(&posed.layer, &posed.patches()[3]);
        let set = || part.energy().clone().set_bending_factor(2.0);
        assert!(std::panic::catch_unwind(set).is_err());
    }
}
