//! What must survive a remesh: seams, corners, fixed vertices, the side of a touching pair.

mod shapes;

use std::collections::BTreeMap;

use nalgebra::Vector3;
use ruga_mesh::{FaceId, Id, MaterialPoint, PerEdge, PerFace, PerVertex, TriMesh, VertexId};
use ruga_remesh::{
    FeatureCurve, FeatureCurves, PolyhedralSurface, RemeshSettings, Remeshed, Sizing, Surface,
    SurfaceMesh, remesh,
};
use shapes::{Shape, Sheet, Waves, grid};

/// Remeshes to a uniform length with the default settings.
fn follow(mesh: &SurfaceMesh, edge: f64, surface: &dyn Surface) -> Remeshed {
    let sizing = Sizing::uniform(mesh.mesh.vertex_count(), edge).expect("a positive length");
    remesh(mesh, &sizing, surface, &RemeshSettings::default()).expect("valid input")
}

fn mark_edges(mesh: &mut SurfaceMesh, is_seam: impl Fn(Vector3<f64>) -> bool) {
    for (edge, ends) in mesh.mesh.edges().iter() {
        mesh.features[edge] |= ends.vertices.iter().all(|&v| is_seam(mesh.positions[v]));
    }
}

/// Total length of the marked edges that are not border, and how many there are.
fn seam_length(mesh: &SurfaceMesh) -> (f64, usize) {
    let inner = mesh
        .mesh
        .edges()
        .iter()
        .filter(|(e, edge)| mesh.features[*e] && !edge.is_border());
    inner.fold((0.0, 0), |(length, count), (_, edge)| {
        let [a, b] = edge.vertices;
        (
            length + (mesh.positions[a] - mesh.positions[b]).norm(),
            count + 1,
        )
    })
}

#[test]
fn a_straight_seam_is_split_and_collapsed_along_itself() {
    let mut mesh = grid(Shape::Flat, 16, 0.0, 1);
    mark_edges(&mut mesh, |p| p.x == 0.5);
    assert_eq!(seam_length(&mesh).1, 16);
    let mut counts = Vec::new();
    for edge in [0.02, 0.2, 0.05] {
        mesh = follow(&mesh, edge, &Sheet(Shape::Flat)).mesh;
        let (length, count) = seam_length(&mesh);
        assert!((length - 1.0).abs() < 1e-12, "{length}");
        counts.push(count);
        for (id, ends) in mesh.mesh.edges().iter() {
            let on_seam = ends.vertices.iter().all(|&v| mesh.positions[v].x == 0.5);
            assert!(!mesh.features[id] || ends.is_border() || on_seam);
        }
    }
    assert!(
        counts[0] > 40 && counts[1] < 9 && counts[2] > 14,
        "{counts:?}"
    );
}

#[test]
fn a_bent_seam_keeps_its_corner_and_its_new_vertices_lie_on_it() {
    // Seam along y = |x - 1/2|, on diagonals that lean with it.
    let base = grid(Shape::Flat, 8, 0.0, 1);
    let on_seam = |p: Vector3<f64>| (p.y - (p.x - 0.5).abs()).abs() < 1e-9;
    let mut faces = Vec::new();
    for j in 0..8u32 {
        for i in 0..8u32 {
            let v = j * 9 + i;
            let (a, b, c, d) = (v, v + 1, v + 10, v + 9);
            if i < 4 {
                faces.extend([[a, b, d], [b, c, d]]);
            } else {
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    let mesh = TriMesh::new(81, faces).expect("a grid is a mesh");
    let positions = base.positions.as_slice();
    let features: PerEdge<bool> = mesh
        .edges()
        .iter()
        .map(|(_, e)| e.vertices.iter().all(|&v| on_seam(positions[v.index()])))
        .collect();
    let surface = PolyhedralSurface::new(&mesh, positions, &features).expect("arrays fit");
    let points = surface.vertex_points().expect("no loose vertex");
    let mut start = SurfaceMesh::on_surface(mesh.clone(), points, &surface).expect("arrays fit");
    start.features = features.clone();
    let length = seam_length(&start).0;
    assert!((length - 2f64.sqrt()).abs() < 1e-12);
    let fine = follow(&start, 0.03, &surface).mesh;
    assert!((seam_length(&fine).0 - length).abs() < 1e-9);
    let coarse = follow(&fine, 0.3, &surface).mesh;
    assert!(
        (seam_length(&coarse).0 - length).abs() < 1e-9,
        "the corner was not cut"
    );
    assert!(seam_length(&coarse).1 <= 8);
}

#[test]
fn corners_and_area_of_a_square_survive_any_coarsening() {
    let fine = follow(&grid(Shape::Flat, 20, 0.2, 3), 0.03, &Sheet(Shape::Flat)).mesh;
    let coarse = follow(&fine, 1.0, &Sheet(Shape::Flat)).mesh;
    let count = coarse.mesh.face_count();
    assert!(count <= 24, "{count} faces, of {}", fine.mesh.face_count());
    for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
        assert!(
            coarse
                .positions
                .iter()
                .any(|(_, p)| *p == Vector3::new(x, y, 0.0))
        );
    }
}

#[test]
fn a_round_border_loses_no_more_than_its_corner_angle_allows() {
    // A fan of 96 triangles: turns of 3.75 degrees, so vertices go until turns reach 20.
    let rim = 96;
    let mut positions = vec![Vector3::zeros()];
    positions.extend((0..rim).map(|i| {
        let (s, c) = (f64::from(i) / f64::from(rim) * std::f64::consts::TAU).sin_cos();
        Vector3::new(c, s, 0.0)
    }));
    let faces = (0..rim)
        .map(|i| [0, 1 + i as u32, 1 + ((i + 1) % rim) as u32])
        .collect();
    let mesh = TriMesh::new(rim as usize + 1, faces).expect("a fan is a mesh");
    let features = PerEdge::filled(mesh.edges().len(), false);
    let surface = PolyhedralSurface::new(&mesh, &positions, &features).expect("arrays fit");
    let points = surface.vertex_points().expect("no loose vertex");
    let start = SurfaceMesh::on_surface(mesh.clone(), points, &surface).expect("arrays fit");
    let coarse = follow(&follow(&start, 0.2, &surface).mesh, 1.0, &surface).mesh;
    let area: f64 = ruga_mesh::face_normals(&coarse.mesh, coarse.positions.as_slice())
        .iter()
        .map(|(_, n)| n.norm() / 2.0)
        .sum();
    let lost = 1.0 - area / std::f64::consts::PI;
    // A circle of turns of 0.35 lacks 0.35^2 / 6, two per cent.
    assert!((0.01..0.021).contains(&lost), "{lost}");
}

#[test]
fn fixed_vertices_stay_where_they_are() {
    let mut mesh = grid(Shape::Sphere, 30, 0.2, 9);
    for (v, fixed) in mesh.fixed.as_mut_slice().iter_mut().enumerate() {
        *fixed = v % 37 == 5;
    }
    let result = follow(&mesh, 0.15, &Sheet(Shape::Sphere));
    let new_from_old = result.transfer.new_from_old(mesh.mesh.vertex_count());
    for (v, &fixed) in mesh.fixed.iter() {
        if fixed {
            let new = new_from_old[v].expect("a fixed vertex survives");
            assert_eq!(result.mesh.positions[new], mesh.positions[v]);
            assert!(result.mesh.fixed[new]);
        }
    }
    let carried = result.transfer.flags(&mesh.fixed, false);
    assert_eq!(carried, result.mesh.fixed);
    assert!(result.mesh.mesh.vertex_count() < mesh.mesh.vertex_count() / 3);
}

/// A closed block with sharp edges, of two triangles to each of its cells.
fn block(cells: [usize; 3], sides: Vector3<f64>) -> (TriMesh, Vec<Vector3<f64>>) {
    let mut numbers: BTreeMap<[usize; 3], u32> = BTreeMap::new();
    let mut faces = Vec::new();
    for axis in 0..3 {
        let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
        for side in [0, cells[axis]] {
            for i in 0..cells[a] {
                for j in 0..cells[b] {
                    let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
                    let [p, q, r, s] = corners.map(|[u, v]| {
                        let mut place = [0; 3];
                        (place[axis], place[a], place[b]) = (side, u, v);
                        let next = numbers.len() as u32;
                        *numbers.entry(place).or_insert(next)
                    });
                    match side {
                        0 => faces.extend([[p, r, q], [p, s, r]]),
                        _ => faces.extend([[p, q, r], [p, r, s]]),
                    }
                }
            }
        }
    }
    let mut positions = vec![Vector3::zeros(); numbers.len()];
    for (place, number) in numbers {
        positions[number as usize] =
            Vector3::from_fn(|k, _| sides[k] * place[k] as f64 / cells[k] as f64);
    }
    (
        TriMesh::new(positions.len(), faces).expect("a block"),
        positions,
    )
}

/// A coarse mesh cuts the edges and corners of a block. The middle of such a cut lies inside the block,
/// and the way to the surface from one end may lead to that end's side: halves of halves ran into the
/// corner, 1e-10 m apart.
#[test]
fn a_mesh_that_cuts_the_edges_of_a_block_is_refined_without_needles() {
    for cells in [[8, 6, 4], [16, 12, 8], [24, 18, 12]] {
        let (mesh, positions) = block(cells, Vector3::new(20.0, 15.0, 10.0));
        let features = PerEdge::filled(mesh.edges().len(), false);
        let surface = PolyhedralSurface::new(&mesh, &positions, &features).expect("arrays fit");
        let points = surface.vertex_points().expect("no loose vertex");
        let start = SurfaceMesh::on_surface(mesh.clone(), points, &surface).expect("arrays fit");
        for edge in [0.4, 0.5, 0.6, 0.7, 0.8] {
            let fine = follow(&follow(&start, 3.0 * edge, &surface).mesh, edge, &surface).mesh;
            let lengths = fine.mesh.edges().as_slice().iter().map(|ends| {
                let [a, b] = ends.vertices.map(|v| fine.positions[v]);
                (b - a).norm()
            });
            let least = lengths.fold(f64::INFINITY, f64::min);
            assert!(least > 0.25 * edge, "{cells:?}: {least} m of {edge}");
        }
    }
}

#[test]
fn lips_that_touch_are_not_confused() {
    // Two sheets in the same place, not connected: what is born on one stays on it.
    let sheet = grid(Shape::Flat, 4, 0.0, 1);
    let count = sheet.mesh.vertex_count() as u32;
    let mut faces: Vec<[u32; 3]> = sheet
        .mesh
        .faces()
        .iter()
        .map(|(_, f)| f.map(|v| v.0))
        .collect();
    let upper: Vec<[u32; 3]> = faces.iter().map(|f| f.map(|v| v + count)).collect();
    faces.extend(upper);
    let mesh = TriMesh::new(2 * count as usize, faces).expect("two grids");
    let positions: Vec<Vector3<f64>> = sheet
        .positions
        .as_slice()
        .iter()
        .chain(sheet.positions.as_slice())
        .copied()
        .collect();
    let features = PerEdge::filled(mesh.edges().len(), false);
    let surface = PolyhedralSurface::new(&mesh, &positions, &features).expect("arrays fit");
    let points = surface.vertex_points().expect("no loose vertex");
    let start = SurfaceMesh::on_surface(mesh.clone(), points, &surface).expect("arrays fit");
    let result = follow(&start, 0.05, &surface);
    let second_part = |mesh: &TriMesh| {
        let parts = mesh.connected_parts(|_| true);
        assert_eq!(parts.len(), 2);
        let mut is_second = PerFace::filled(mesh.face_count(), false);
        parts[1].iter().for_each(|&face| is_second[face] = true);
        is_second
    };
    let (component, new_component) = (second_part(&mesh), second_part(&result.mesh.mesh));
    for (face, corners) in result.mesh.mesh.faces().iter() {
        for &v in corners {
            let on: MaterialPoint = result.mesh.points[v];
            assert_eq!(component[on.face], new_component[face]);
            for (old, _) in result.transfer.rows.row(v.index()) {
                assert_eq!(old >= count, new_component[face]);
            }
        }
    }
}

#[test]
fn a_mesh_in_the_range_of_the_metric_is_left_alone() {
    let mesh = grid(Shape::Flat, 20, 0.1, 2);
    let result = follow(&mesh, 0.055, &Sheet(Shape::Flat));
    assert!(result.transfer.is_identity(mesh.mesh.vertex_count()));
    let other = Waves {
        edge: 0.02,
        range: 1.0,
        aspect: 1.0,
        seed: 1,
    }
    .sizing(&mesh);
    let result = remesh(
        &mesh,
        &other,
        &Sheet(Shape::Flat),
        &RemeshSettings::default(),
    );
    assert!(
        !result
            .expect("valid")
            .transfer
            .is_identity(mesh.mesh.vertex_count())
    );
}

#[test]
fn scalars_and_vectors_are_carried_alike() {
    let mesh = grid(Shape::Cylinder, 6, 0.2, 2);
    let result = follow(&mesh, 0.04, &Sheet(Shape::Cylinder));
    let values: PerVertex<Vector3<f64>> = mesh
        .positions
        .iter()
        .map(|(v, p)| p * (1.0 + v.index() as f64))
        .collect();
    let heights: Vec<f64> = values.as_slice().iter().map(|p| p.y).collect();
    let vectors = result.transfer.rows.apply(values.as_slice());
    for (vector, height) in vectors.iter().zip(result.transfer.rows.apply(&heights)) {
        assert!((vector.y - height).abs() < 1e-12);
    }
    let born = result
        .transfer
        .survivors
        .iter()
        .filter(|(_, s)| s.is_none())
        .count();
    assert!(born > 100);
    assert_eq!(result.transfer.survivors[VertexId(0)], Some(VertexId(0)));
}

/// A surface whose search never gets anywhere.
struct Stuck;

impl Surface for Stuck {
    fn position(&self, at: MaterialPoint) -> Vector3<f64> {
        Sheet(Shape::Flat).position(at)
    }

    fn normal(&self, _at: MaterialPoint) -> Vector3<f64> {
        Vector3::z()
    }

    fn closest(&self, near: MaterialPoint, _target: Vector3<f64>) -> MaterialPoint {
        near
    }
}

#[test]
fn a_surface_without_a_place_for_new_vertices_is_reported() {
    let mesh = grid(Shape::Flat, 5, 0.2, 1);
    let result = follow(&mesh, 0.02, &Stuck);
    assert!(!result.report.converged && result.report.too_long > 50);
    assert!(result.transfer.is_identity(mesh.mesh.vertex_count()));
}

/// A circle in a flat sheet, as a curve over its two faces.
fn circle(radius: f64) -> FeatureCurve {
    closed_curve(|turn| {
        let (sin, cos) = turn.sin_cos();
        [0.5 + radius * cos, 0.5 + radius * sin]
    })
}

/// A curve over the two faces of a flat sheet that closes after a full turn.
fn closed_curve(at: impl Fn(f64) -> [f64; 2]) -> FeatureCurve {
    let point = |i: u32| at(std::f64::consts::TAU * f64::from(i) / 720.0);
    // Pieces that cross the diagonal are addressed in one of its faces, with a weight below zero.
    let address = |[u, v]: [f64; 2], is_lower: bool| MaterialPoint {
        face: FaceId(u32::from(!is_lower)),
        barycentric: if is_lower {
            [1.0 - u, u - v, v]
        } else {
            [1.0 - v, u, v - u]
        },
    };
    let piece = |i: u32| {
        let [a, b] = [point(i), point(i + 1)];
        let is_lower = a[0] + b[0] >= a[1] + b[1];
        [a, b].map(|p| address(p, is_lower))
    };
    FeatureCurve {
        pieces: (0..720).map(piece).collect(),
        is_closed: true,
    }
}

#[test]
fn features_on_a_curve_are_split_on_the_curve_and_not_on_their_chords() {
    let sheet = Sheet(Shape::Flat);
    let mut mesh = grid(Shape::Flat, 12, 0.0, 3);
    // A square of edges whose corners and middles are moved onto the circle.
    let centre = Vector3::new(0.5, 0.5, 0.0);
    let on = |p: &Vector3<f64>| (p - centre).amax() > 0.24 && (p - centre).amax() < 0.26;
    let ring: Vec<_> = mesh.positions.iter().map(|(_, p)| on(p)).collect();
    for (edge, ends) in mesh.mesh.edges().iter() {
        mesh.features[edge] = ends.vertices.iter().all(|v| ring[v.index()]);
    }
    let moved = mesh
        .positions
        .iter()
        .zip(&ring)
        .map(|((_, p), &on)| match on {
            true => centre + (p - centre).normalize() * 0.3,
            false => *p,
        });
    let moved: Vec<_> = moved.collect();
    mesh.points = moved
        .iter()
        .map(|p| sheet.closest(mesh.points[VertexId(0)], *p))
        .collect();
    mesh.positions = moved.into();
    let curves = FeatureCurves::new(&sheet, &[circle(0.3)]);
    for edge in [0.03, 0.1, 0.02] {
        mesh = follow(&mesh, edge, &curves).mesh;
        let (length, _) = seam_length(&mesh);
        let exact = 0.3 * std::f64::consts::TAU;
        // The chords of a polygon with such sides.
        let chord = exact * (edge / 0.3).powi(2) / 24.0;
        assert!((length - exact).abs() < 4.0 * chord, "{edge}: {length}");
        for (id, ends) in mesh.mesh.edges().iter() {
            if mesh.features[id] && !ends.is_border() {
                for v in ends.vertices {
                    let off = (mesh.positions[v] - centre).norm() - 0.3;
                    assert!(off.abs() < 1e-5, "{off}");
                }
            }
        }
    }
}

/// At the crossing both stretches are equally near; the other end tells which one an edge lies on.
#[test]
fn a_curve_that_crosses_itself_is_followed_on_the_stretch_of_the_edge() {
    let eight = |turn: f64| {
        let (sin, cos) = (turn + 0.5 * std::f64::consts::PI).sin_cos();
        [0.5 + 0.3 * sin, 0.5 + 0.3 * sin * cos]
    };
    let sheet = Sheet(Shape::Flat);
    let curves = FeatureCurves::new(&sheet, &[closed_curve(eight)]);
    let place = |[x, y]: [f64; 2]| {
        let near = MaterialPoint::at_corner(FaceId(0), 0);
        sheet.closest(near, Vector3::new(x, y, 0.0))
    };
    for crossing in [0.5, 1.5].map(|turn| turn * std::f64::consts::PI) {
        for away in [-0.3, 0.3] {
            let ends = [crossing, crossing + away].map(|turn| place(eight(turn)));
            let [x, y] = eight(crossing + 0.5 * away);
            let middle = Vector3::new(x, y, 0.0);
            for between in [ends, [ends[1], ends[0]]] {
                let found = curves.closest_on_feature(between, middle);
                let off = (sheet.position(found) - middle).norm();
                assert!(off < 1e-4, "{crossing} {away}: {off}");
            }
        }
    }
}
