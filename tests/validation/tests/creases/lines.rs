//! Meshes with a line drawn at will, as the product cuts and fits them.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use nalgebra::Vector3;
use ruga_crease::{LinePlaces, TracedLine};
use ruga_material::crease_onset;
use ruga_mesh::{EdgeId, Id, VertexId};
use ruga_remesh::SurfaceMesh;
use ruga_shell::{
    BendingModel, Crease, FoldSense, HINGE_EXPONENT, LayerParameters, ResponseQuery,
    creased_response, face_corners,
};
use ruga_validation::{DrawnSheet, Sheet, SheetSpec, feature_edges, unit_face, unit_film};

use crate::exact;

/// Side of the square film, wavelengths.
const SIDE: f64 = 8.0;

/// Reduced load at which a film, held at its border and compressed along `direction`, folds along edges with
/// this reduced stiffness.
fn onset(mesh: &SurfaceMesh, edges: &[EdgeId], direction: Vector3<f64>, kappa: f64) -> f64 {
    let k = std::f64::consts::TAU;
    let crease = Crease {
        compliance: 1.0 / (k * kappa),
        rest_angle: 0.0,
        sense: FoldSense::Both,
    };
    let creases: Vec<_> = edges.iter().map(|&edge| (edge, crease)).collect();
    let (positions, border) = (mesh.positions.as_slice(), mesh.mesh.border_vertices());
    let query = ResponseQuery {
        mesh: &mesh.mesh,
        corners: &face_corners(&mesh.mesh, positions),
        directions: &vec![direction; mesh.mesh.face_count()],
        fixed: border.as_slice(),
        bending_modulus: 1.0,
        poisson: 0.48,
        bending_model: BendingModel::VertexCurvature,
        hinge_exponent: HINGE_EXPONENT,
        normal_stiffness: k.powi(4),
        gradient_stiffness: 0.0,
    };
    let response = creased_response(&query, &creases).expect("a valid query");
    assert!(response.converged);
    response.critical_force / (2.0 * k * k)
}

/// A straight line through the film's middle at an angle to its sides (degrees), and the direction across.
fn straight(degrees: f64) -> (Vec<Vector3<f64>>, Vector3<f64>) {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let along = Vector3::new(-sin, cos, 0.0);
    let middle = Vector3::new(0.5 * SIDE, 0.5 * SIDE, 0.0);
    // From border to border.
    let reach = 0.5 * SIDE / cos.abs().max(sin.abs()) * (1.0 - 1e-9);
    let points = [-1.0, 1.0].map(|end| middle + along * (end * reach));
    (points.to_vec(), Vector3::new(cos, sin, 0.0))
}

const CASES: [(f64, f64); 4] = [(8.0, 0.02), (0.884, 0.02), (0.162, 0.03), (0.0, 0.03)];

/// Measured: 0.998, 0.990, 1.002 and 1.014, and within 0.3 % of each other.
#[test]
fn a_line_at_any_angle_gives_way_at_the_closed_form() {
    for (kappa, bound) in CASES {
        let ratio = |degrees: f64| {
            let (points, across) = straight(degrees);
            let drawn = DrawnSheet::new(SIDE as usize, 3);
            let fits = drawn.fitted(&[drawn.trace(points)], 1.0 / 12.0, 3);
            onset(&fits[2], &feature_edges(&fits[2]), across, kappa) / crease_onset(kappa)
        };
        let ratios = [0.0, 15.0, 30.0, 45.0].map(ratio);
        let (low, high) = ratios
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(low, high), &r| {
                (low.min(r), high.max(r))
            });
        assert!(
            low > 1.0 - bound && high < 1.0 + bound,
            "{kappa}: {ratios:?}"
        );
        assert!(high - low < 0.01, "{kappa}: {ratios:?}");
    }
}

/// Five drawn meshes, each fitted. Measured: 0.990 to 0.991 and 1.013 to 1.014 of the closed form.
#[test]
fn a_line_gives_way_alike_on_five_fitted_meshes() {
    let (points, across) = straight(30.0);
    for kappa in [0.884, 0.0] {
        let ratios = [1, 2, 3, 4, 5].map(|seed| {
            let drawn = DrawnSheet::new(SIDE as usize, seed);
            let fits = drawn.fitted(&[drawn.trace(points.clone())], 1.0 / 12.0, 3);
            onset(&fits[2], &feature_edges(&fits[2]), across, kappa) / crease_onset(kappa)
        });
        println!("kappa {kappa}: {ratios:.4?} of the closed form");
        let is_right = |r: &f64| (r - 1.0).abs() < 0.03 && (r - ratios[0]).abs() < 0.01;
        assert!(ratios.iter().all(is_right), "{kappa}: {ratios:?}");
    }
}

/// A line along edges of the drawn mesh, and the same where it goes across them and the mesh is cut along it. Measured:
/// within 0.15 %.
#[test]
fn a_line_off_the_edges_gives_way_as_one_on_them() {
    let (points, across) = straight(0.0);
    let off = DrawnSheet::new(SIDE as usize, 3);
    let mut on = DrawnSheet::new(SIDE as usize, 3);
    let column = (0.5 * SIDE) as usize;
    for row in 0..=SIDE as usize {
        on.positions[row * (SIDE as usize + 1) + column].x = 0.5 * SIDE;
    }
    for (kappa, _) in CASES {
        let [on, off] = [&on, &off].map(|drawn| {
            let fits = drawn.fitted(&[drawn.trace(points.clone())], 1.0 / 12.0, 3);
            onset(&fits[2], &feature_edges(&fits[2]), across, kappa)
        });
        println!("kappa {kappa}: {:.4} of the onset on edges", off / on);
        assert!((off / on - 1.0).abs() < 0.01, "{kappa}: {off} {on}");
    }
}

/// Fifty lines that meet in one vertex, where they are closer than the film's edges are long.
#[test]
fn a_fan_of_lines_folds() {
    let drawn = DrawnSheet::new(SIDE as usize, 3);
    let middle = Vector3::new(0.5 * SIDE, 0.5 * SIDE, 0.0);
    let ray = |i: usize| {
        let (sin, cos) = (TAU * i as f64 / 50.0).sin_cos();
        drawn.trace(vec![
            middle,
            middle + Vector3::new(cos, sin, 0.0) * (0.3 * SIDE),
        ])
    };
    let lines: Vec<_> = (0..50).map(ray).collect();
    let fits = drawn.fitted(&lines, 1.0 / 12.0, 2);
    let [energy, depth] = folded(&fits[1]);
    // Wavelengths, over the vertices of all lines: each takes of the fold what the others leave.
    assert!(
        energy.is_finite() && (depth / 7.2e-3 - 1.0).abs() < 0.2,
        "{energy} {depth}"
    );
}

/// The way along existing edges that keeps nearest to a straight line.
fn zigzag(mesh: &SurfaceMesh, ends: [Vector3<f64>; 2]) -> Vec<EdgeId> {
    let along = (ends[1] - ends[0]).normalize();
    let off = |p: Vector3<f64>| {
        let from = p - ends[0];
        (from - along * from.dot(&along)).norm()
    };
    let nearest = |end: Vector3<f64>| {
        let all = mesh.positions.iter().map(|(v, p)| ((p - end).norm(), v));
        all.min_by(|a, b| a.0.total_cmp(&b.0))
            .expect("a mesh has vertices")
            .1
    };
    let mut edges: BTreeMap<VertexId, Vec<(VertexId, EdgeId, f64)>> = BTreeMap::new();
    for (id, edge) in mesh
        .mesh
        .edges()
        .iter()
        .filter(|(_, edge)| !edge.is_border())
    {
        let [a, b] = edge.vertices;
        let [p, q] = [a, b].map(|v| mesh.positions[v]);
        let cost = (q - p).norm() * (1.0 + 20.0 * off((p + q) * 0.5));
        edges.entry(a).or_default().push((b, id, cost));
        edges.entry(b).or_default().push((a, id, cost));
    }
    let (start, goal) = (nearest(ends[0]), nearest(ends[1]));
    let mut best = BTreeMap::from([(start, (0.0, None))]);
    // Bellman and Ford: short, and the mesh is small.
    loop {
        let mut is_done = true;
        for (v, beside) in &edges {
            let Some(&(cost, _)) = best.get(v) else {
                continue;
            };
            for &(w, id, step) in beside {
                let new = cost + step;
                if best.get(&w).is_none_or(|&(old, _)| new < old - 1e-12) {
                    best.insert(w, (new, Some((*v, id))));
                    is_done = false;
                }
            }
        }
        if is_done {
            break;
        }
    }
    let mut path = Vec::new();
    let mut at = goal;
    while let Some(&(_, Some((before, edge)))) = best.get(&at) {
        path.push(edge);
        at = before;
    }
    path
}

/// The smoothest zigzag there is: 2 and 9 % over the closed form, 3 and 9 % over edges on the line. One that keeps
/// nearer to the line turns more at its vertices and is stiffer still.
#[test]
fn a_zigzag_of_existing_edges_is_too_stiff() {
    let drawn = DrawnSheet::new(SIDE as usize, 3);
    let (points, across) = straight(15.0);
    let bare = &drawn.fitted(&[], 1.0 / 12.0, 3)[2];
    let path = zigzag(bare, [points[0], points[1]]);
    let lined = &drawn.fitted(&[drawn.trace(points)], 1.0 / 12.0, 3)[2];
    // Kinks of more than 45 degrees count as the ends of two lines, each with a fold of its own, which makes a
    // zigzag less stiff than one fold along all of it.
    for (kappa, least) in [(0.884, 0.02), (0.162, 0.06)] {
        let high = onset(bare, &path, across, kappa);
        let right = onset(lined, &feature_edges(lined), across, kappa);
        assert!(high / right > 1.0 + least, "{kappa}: {high} {right}");
    }
}

/// An arc that turns by 137 degrees.
fn arc(drawn: &DrawnSheet) -> TracedLine {
    let point = |i: i32| {
        let (sin, cos) = (2.4 * f64::from(i) / 16.0 + 0.4).sin_cos();
        Vector3::new(0.5 * SIDE + 2.6 * cos, 2.6 * sin + 1.5, 0.0)
    };
    drawn.trace((0..=16).map(point).collect())
}

/// Length of a fitted line, largest distance of a vertex from where it was drawn, and largest turn at a vertex
/// (degrees).
fn shape(drawn: &DrawnSheet, line: &TracedLine, mesh: &SurfaceMesh) -> [f64; 3] {
    let edges = feature_edges(mesh);
    let ends = |edge: EdgeId| mesh.mesh.edges()[edge].vertices;
    let samples = (0..40_000).map(|i| drawn.on(line, line.length() * f64::from(i) / 39_999.0));
    let samples: Vec<_> = samples.collect();
    let (mut length, mut off) = (0.0, 0.0_f64);
    let mut beside: BTreeMap<VertexId, Vec<Vector3<f64>>> = BTreeMap::new();
    for edge in edges {
        let [a, b] = ends(edge);
        let along = mesh.positions[b] - mesh.positions[a];
        length += along.norm();
        beside.entry(a).or_default().push(along);
        beside.entry(b).or_default().push(-along);
        let distances = samples.iter().map(|q| (q - mesh.positions[a]).norm());
        off = off.max(distances.fold(f64::INFINITY, f64::min));
    }
    let inner = beside.values().filter(|all| all.len() == 2);
    let turns = inner.map(|all| std::f64::consts::PI - all[0].angle(&all[1]));
    [length, off, turns.fold(0.0, f64::max).to_degrees()]
}

/// Five fits, each of the mesh before: energy and mean depth of a film that its crease folds. Measured: 0.35 % and
/// 0.2 %, what two meshes of this fineness differ by; length 0.002 %.
#[test]
fn refits_keep_a_curve_and_what_it_does() {
    let drawn = DrawnSheet::new(SIDE as usize, 5);
    let line = arc(&drawn);
    let edge = 1.0 / 12.0;
    let fits = drawn.fitted(std::slice::from_ref(&line), edge, 5);
    let shapes: Vec<_> = fits.iter().map(|mesh| shape(&drawn, &line, mesh)).collect();
    // A line ends at the last edge that it crosses: up to a face of the mesh that is cut is lost at a tip.
    assert!(shapes[0][0] > line.length() - 0.25, "{shapes:?}");
    // Which line an edge lies on, and where along it, is known after every fit.
    let places = LinePlaces::new(std::slice::from_ref(&line), &drawn.mesh);
    for mesh in &fits {
        let marked = feature_edges(mesh);
        let is_marked = |edge| marked.contains(&edge);
        let found = places.edges(&mesh.mesh, mesh.points.as_slice(), is_marked);
        assert_eq!(found.len(), marked.len());
        let covered: f64 = found
            .iter()
            .map(|edge| (edge.at[1] - edge.at[0]).abs())
            .sum();
        assert!(
            (covered / shapes[0][0] - 1.0).abs() < 2e-3,
            "{covered} {shapes:?}"
        );
    }
    let states: Vec<_> = fits.iter().map(folded).collect();
    for ([length, off, turn], [energy, depth]) in shapes.iter().zip(&states) {
        assert!((length / shapes[0][0] - 1.0).abs() < 0.005, "{shapes:?}");
        assert!(*off < 0.002 * edge && *turn < 10.0, "{shapes:?}");
        // Measured .35 %: every fit has other triangles beside the line, and the energy is that of 12 vertices per
        // wavelength.
        assert!((energy / states[0][0] - 1.0).abs() < 0.005, "{states:?}");
        assert!((depth / states[0][1] - 1.0).abs() < 0.02, "{states:?}");
    }
}

/// Energy, and mean depth over the vertices of the line, of a film at rest whose crease wants 30 degrees.
fn folded(mesh: &SurfaceMesh) -> [f64; 2] {
    let (theory, thickness) = unit_film(0.05);
    let face = unit_face((&theory, thickness));
    let faces: Vec<_> = mesh
        .mesh
        .faces()
        .as_slice()
        .iter()
        .map(|face| face.map(|v| v.0))
        .collect();
    let rest = mesh.positions.as_slice().to_vec();
    let parameters =
        LayerParameters::uniform(face, faces.len(), theory.tangential_stiffness, rest.len());
    let pinned = mesh.mesh.border_vertices().as_slice().to_vec();
    let mut sheet = Sheet::new(SheetSpec::bare(
        (theory, thickness),
        (rest, faces),
        parameters,
        pinned,
    ));
    let crease = Crease {
        compliance: 1.0 / (0.5 * TAU),
        rest_angle: 30_f64.to_radians(),
        sense: FoldSense::Valley,
    };
    let edges = feature_edges(mesh);
    let creases: Vec<_> = edges.iter().map(|&edge| (edge, crease)).collect();
    sheet.crease(&creases, &[]);
    let report = sheet.solve(&exact());
    assert!(report.converged, "{report:?}");
    let ends = edges
        .iter()
        .flat_map(|&edge| mesh.mesh.edges()[edge].vertices);
    let depths: Vec<_> = ends.map(|v| -sheet.positions()[v.index()].z).collect();
    [
        sheet.energy(),
        depths.iter().sum::<f64>() / depths.len() as f64,
    ]
}
