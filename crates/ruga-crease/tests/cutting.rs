//! Meshes that are cut along lines: edges on the lines, nothing lost, no gaps.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod sheets;

use std::f64::consts::TAU;

use nalgebra::{Vector2, Vector3};
use ruga_crease::{
    Corners, CreaseWarning, LineCut, LineInput, LinePlaces, LineTracer, MeshPiece, TracedLine,
    cut_lines,
};
use ruga_mesh::{FaceId, Id, MaterialPoint, PerVertex, VertexId, face_areas, subdivide};
use sheets::{Sheet, square};

fn uv(points: &[[f64; 2]], is_closed: bool) -> LineInput {
    LineInput::Uv {
        points: points.iter().map(|&p| p.into()).collect(),
        is_closed,
        corners: Corners::Round,
    }
}

fn traced(sheet: &Sheet, line: &LineInput) -> TracedLine {
    let tracer = LineTracer::new(&sheet.mesh, &sheet.positions).with_uvs(&sheet.uvs);
    tracer.trace(line).unwrap()
}

/// A piece of a sheet's triangles, each in `4^levels` parts.
fn piece(sheet: &Sheet, levels: u32) -> MeshPiece {
    // Linear, so that faces lie in the triangles that they come from.
    let corners = PerVertex::filled(sheet.mesh.vertex_count(), true);
    let fine = subdivide(&sheet.mesh, levels, &corners);
    let mut positions = vec![Vector3::zeros(); fine.mesh.vertex_count()];
    for (face, origin) in fine
        .mesh
        .faces()
        .as_slice()
        .iter()
        .zip(fine.origins.as_slice())
    {
        for (v, barycentric) in face.iter().zip(origin.corners) {
            let face = origin.face;
            let place = MaterialPoint { face, barycentric };
            positions[v.index()] = place.interpolate(&sheet.mesh, &sheet.positions);
        }
    }
    MeshPiece {
        mesh: fine.mesh,
        origins: fine.origins,
        positions,
    }
}

/// Nothing is lost, every edge lies on its line, and the whole line has edges but for less than an edge at
/// either tip.
fn check(sheet: &Sheet, lines: &[TracedLine], before: &MeshPiece, cut: &LineCut, edge: f64) {
    assert_eq!(cut.warnings, []);
    let area = |piece: &MeshPiece| {
        face_areas(&piece.mesh, &piece.positions)
            .as_slice()
            .iter()
            .sum::<f64>()
    };
    assert!((area(&cut.piece) / area(before) - 1.0).abs() < 1e-12);
    for (face, corners) in cut.piece.mesh.faces().iter() {
        let (origin, part) = (&cut.piece.origins[face], &cut.parts[face]);
        for (corner, v) in corners.iter().enumerate() {
            let x = cut.piece.positions[v.index()];
            let places = [
                (
                    origin.place(MaterialPoint::at_corner(face, corner).barycentric),
                    &sheet.mesh,
                    &sheet.positions,
                ),
                (
                    part.place(MaterialPoint::at_corner(face, corner).barycentric),
                    &before.mesh,
                    &before.positions,
                ),
            ];
            for (place, mesh, positions) in places {
                assert!((place.interpolate(mesh, positions) - x).norm() < 1e-12);
            }
        }
    }
    for vertex in &cut.vertices {
        let on = vertex.place.interpolate(&sheet.mesh, &sheet.positions);
        let off = (on - cut.piece.positions[vertex.vertex.index()]).norm();
        assert!(off < 0.03 * edge, "{vertex:?} is {off} off");
    }
    for (number, line) in lines.iter().enumerate() {
        let of_line = cut.edges.iter().filter(|edge| edge.line == number);
        let covered: f64 = of_line
            .clone()
            // Of a closed line as well.
            .map(|edge| (edge.at[1] - edge.at[0]).abs())
            .sum();
        let tips = if line.is_closed() { 1e-9 } else { 2.5 * edge };
        assert!(
            covered > line.length() - tips,
            "{covered} of {}",
            line.length()
        );
        for edge in of_line {
            let ends = cut.piece.mesh.edges()[edge.edge].vertices;
            for (v, at) in ends.into_iter().zip(edge.at) {
                let on = line
                    .place(at)
                    .unwrap()
                    .interpolate(&sheet.mesh, &sheet.positions);
                let off = (on - cut.piece.positions[v.index()]).norm();
                assert!(off < 0.03 * edge_length(before), "{off}");
            }
        }
    }
}

fn edge_length(piece: &MeshPiece) -> f64 {
    let lengths = piece.mesh.edges().as_slice().iter().map(|edge| {
        let [a, b] = edge.vertices.map(|v| piece.positions[v.index()]);
        (b - a).norm()
    });
    lengths.clone().sum::<f64>() / lengths.count() as f64
}

fn cut_and_check(sheet: &Sheet, levels: u32, lines: &[LineInput]) -> LineCut {
    let lines: Vec<_> = lines.iter().map(|line| traced(sheet, line)).collect();
    let before = piece(sheet, levels);
    let cut = cut_lines(&lines, before.clone());
    check(sheet, &lines, &before, &cut, edge_length(&before));
    cut
}

#[test]
fn straight_lines_at_any_angle() {
    let sheet = square(5, 0.3, 1);
    for i in 0..24 {
        let (sin, cos) = (TAU * f64::from(i) / 24.0).sin_cos();
        let ends = [-0.43, 0.43].map(|r| [0.5 + r * cos, 0.5 + r * sin]);
        cut_and_check(&sheet, 2, &[uv(&ends, false)]);
    }
}

#[test]
fn lines_along_edges_and_through_vertices_need_no_cut() {
    let sheet = square(6, 0.0, 2);
    let cut = cut_and_check(&sheet, 1, &[uv(&[[0.25, 0.0], [0.25, 1.0]], false)]);
    assert_eq!(cut.edges.len(), 12);
    let path = LineInput::Edges {
        vertices: (0..7).map(|i| VertexId::from_index(3 * 7 + i)).collect(),
    };
    let sheet = square(6, 0.25, 3);
    let before = piece(&sheet, 1).mesh.face_count();
    let cut = cut_and_check(&sheet, 1, &[path]);
    assert_eq!((cut.edges.len(), cut.piece.mesh.face_count()), (12, before));
}

#[test]
fn curves_rings_and_crossings() {
    let sheet = square(6, 0.25, 4);
    let wave: Vec<_> = (0..=24)
        .map(|i| {
            let x = 0.08 + 0.84 * f64::from(i) / 24.0;
            [x, 0.5 + 0.2 * (9.0 * x).sin()]
        })
        .collect();
    let ring: Vec<_> = (0..16)
        .map(|i| {
            let (sin, cos) = (TAU * f64::from(i) / 16.0).sin_cos();
            [0.5 + 0.31 * cos, 0.5 + 0.31 * sin]
        })
        .collect();
    let lines = [
        uv(&wave, false),
        uv(&ring, true),
        uv(&[[0.1, 0.1], [0.9, 0.93]], false),
    ];
    for levels in [1, 2, 3] {
        let cut = cut_and_check(&sheet, levels, &lines);
        // Lines that cross share a vertex, or two pass it within a hundredth of an edge.
        let junctions = cut.vertices.iter().filter(|a| {
            cut.vertices
                .iter()
                .any(|b| b.vertex == a.vertex && b.line != a.line)
        });
        assert!(junctions.count() >= 8, "{levels}");
    }
}

/// A ring's last edge ends where the ring is as long as it is, not where it begins.
#[test]
fn arc_lengths_go_on_where_a_ring_closes() {
    let sheet = square(6, 0.25, 10);
    let ring: Vec<_> = (0..16)
        .map(|i| {
            let (sin, cos) = (TAU * f64::from(i) / 16.0).sin_cos();
            [0.5 + 0.31 * cos, 0.5 + 0.31 * sin]
        })
        .collect();
    let ring = [traced(&sheet, &uv(&ring, true))];
    let cut = cut_lines(&ring, piece(&sheet, 2));
    let mut points = vec![None; cut.piece.mesh.vertex_count()];
    for vertex in &cut.vertices {
        points[vertex.vertex.index()] = Some(vertex.place);
    }
    let elsewhere = MaterialPoint::at_corner(FaceId(0), 0);
    let points: Vec<_> = points.iter().map(|p| p.unwrap_or(elsewhere)).collect();
    let of_cut: Vec<_> = cut.edges.iter().map(|edge| edge.edge).collect();
    let places = LinePlaces::new(&ring, &sheet.mesh);
    let found = places.edges(&cut.piece.mesh, &points, |edge| of_cut.contains(&edge));
    assert_eq!(found.len(), of_cut.len());
    for edge in cut.edges.iter().chain(&found) {
        let [a, b] = cut.piece.mesh.edges()[edge.edge].vertices;
        let length = (cut.piece.positions[a.index()] - cut.piece.positions[b.index()]).norm();
        let along = (edge.at[1] - edge.at[0]).abs();
        assert!(along < 1.1 * length + 1e-3, "{edge:?} {length}");
    }
}

#[test]
fn fifty_lines_from_one_point() {
    let sheet = square(4, 0.2, 5);
    let ray = |i: u32| {
        let (sin, cos) = (TAU * f64::from(i) / 50.0).sin_cos();
        uv(&[[0.5, 0.5], [0.5 + 0.45 * cos, 0.5 + 0.45 * sin]], false)
    };
    let lines: Vec<_> = (0..50).map(|i| traced(&sheet, &ray(i))).collect();
    let cut = cut_lines(&lines, piece(&sheet, 3));
    // Around the point there is no room for them all, and they are told of there.
    let is_near = |warning: &CreaseWarning| match warning {
        CreaseWarning::Gap { at, .. } | CreaseWarning::Shared { at, .. } => at[1] < 0.02,
        _ => false,
    };
    assert!(cut.warnings.iter().all(is_near), "{:?}", cut.warnings);
    for line in 0..50 {
        assert!(cut.edges.iter().filter(|edge| edge.line == line).count() >= 4);
    }
}

#[test]
fn a_line_inside_one_triangle_has_no_edges() {
    let sheet = square(2, 0.0, 6);
    let middle = sheet.uvs.as_slice()[0].iter().sum::<Vector2<f64>>() / 3.0;
    let ends = [middle, middle + Vector2::new(0.03, 0.01)].map(|p| [p.x, p.y]);
    let line = traced(&sheet, &uv(&ends, false));
    let cut = cut_lines(&[line], piece(&sheet, 0));
    assert_eq!(cut.warnings, [CreaseWarning::NoEdges { line: 0 }]);
    assert_eq!(cut.piece.mesh.face_count(), 8);
}

fn path(vertices: &[u32]) -> LineInput {
    LineInput::Edges {
        vertices: vertices.iter().map(|&v| VertexId(v)).collect(),
    }
}

/// No edge twice and none at the border, which no layer would take.
fn assert_inner_once(cut: &LineCut) {
    let mut edges: Vec<_> = cut.edges.iter().map(|edge| edge.edge).collect();
    let mesh = &cut.piece.mesh;
    assert!(edges.iter().all(|&edge| !mesh.edges()[edge].is_border()));
    edges.sort_by_key(|edge| edge.0);
    assert!(edges.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn lines_with_a_common_stem_share_its_edges() {
    let sheet = square(6, 0.2, 7);
    let row = |columns: std::ops::Range<u32>| columns.map(|i| 3 * 7 + i).collect::<Vec<_>>();
    let mut second = row(1..4);
    second.extend([3 * 7 + 3 + 7, 3 * 7 + 3 + 14]);
    let lines = [path(&row(1..6)), path(&second)].map(|line| traced(&sheet, &line));
    let cut = cut_lines(&lines, piece(&sheet, 0));
    assert_inner_once(&cut);
    let of_line = |line| cut.edges.iter().filter(|e| e.line == line).count();
    assert_eq!([0, 1].map(of_line), [4, 2]);
    let [
        CreaseWarning::Shared {
            lines: [0, 1],
            at: [from, to],
        },
    ] = cut.warnings[..]
    else {
        panic!("{:?}", cut.warnings)
    };
    let stem: f64 = lines[1].segments()[..2].iter().map(|s| s.length).sum();
    assert!(from.abs() < 1e-12 && (to - stem).abs() < 1e-12);
    // The whole of a line.
    let lines = [path(&row(1..6)), path(&row(2..5))].map(|line| traced(&sheet, &line));
    let cut = cut_lines(&lines, piece(&sheet, 0));
    assert_inner_once(&cut);
    assert!(
        matches!(
            cut.warnings[..],
            [CreaseWarning::Shared { lines: [0, 1], .. }]
        ),
        "{:?}",
        cut.warnings
    );
}

#[test]
fn what_runs_along_the_border_has_no_edges() {
    let sheet = square(40, 0.0, 8);
    // A fortieth of it.
    let mut vertices = vec![0];
    vertices.extend((0..40).map(|i| 1 + 41 * i));
    let line = traced(&sheet, &path(&vertices));
    let cut = cut_lines(&[line], piece(&sheet, 0));
    assert_inner_once(&cut);
    assert_eq!(cut.edges.len(), 39);
    assert!(
        matches!(cut.warnings[..], [CreaseWarning::Gap { line: 0, .. }]),
        "{:?}",
        cut.warnings
    );
}

/// A hairpin inside a face leaves its vertex and comes back to it: no edge is that.
#[test]
fn a_hairpin_inside_a_face_has_no_edge() {
    let sheet = square(4, 0.0, 9);
    let mut gaps = 0;
    for i in 0..24 {
        let (sin, cos) = (TAU * (f64::from(i) + 0.4) / 24.0).sin_cos();
        // Nearer than the far side of any face, farther than where both passages would be one.
        let tip = [0.5 + 0.165 * cos, 0.5 + 0.165 * sin];
        let line = LineInput::Uv {
            points: [[0.25, 0.5], [0.5, 0.5], tip, [0.5, 0.5], [0.5, 0.75]]
                .map(Vector2::from)
                .to_vec(),
            is_closed: false,
            corners: Corners::Keep,
        };
        let cut = cut_lines(&[traced(&sheet, &line)], piece(&sheet, 0));
        assert_inner_once(&cut);
        assert_eq!(cut.edges.len(), 2, "{:?}", cut.edges);
        let is_gap = |warning: &CreaseWarning| matches!(warning, CreaseWarning::Gap { .. });
        assert!(cut.warnings.iter().all(is_gap), "{:?}", cut.warnings);
        gaps += cut.warnings.len();
    }
    // In the face that has both edges the vertex is passed but once.
    assert!(gaps > 12, "{gaps}");
}

/// Least angle of a triangle of a flat piece (degrees).
fn least_angle(piece: &MeshPiece) -> f64 {
    let angles = piece.mesh.faces().as_slice().iter().flat_map(|corners| {
        let [a, b, c] = corners.map(|v| piece.positions[v.index()]);
        [[a, b, c], [b, c, a], [c, a, b]].map(|[a, b, c]| (b - a).angle(&(c - a)))
    });
    angles.fold(TAU, f64::min).to_degrees()
}

/// Largest turn of a line from edge to edge (degrees), and the length of its edges over its own.
fn kink_and_length(cut: &LineCut) -> [f64; 2] {
    let step = |edge: &ruga_crease::CreaseEdge| {
        let [a, b] = cut.piece.mesh.edges()[edge.edge].vertices;
        let way = cut.piece.positions[b.index()] - cut.piece.positions[a.index()];
        if edge.at[0] < edge.at[1] { way } else { -way }
    };
    let steps: Vec<_> = cut.edges.iter().map(step).collect();
    let kinks = steps.windows(2).map(|pair| pair[0].angle(&pair[1]));
    let length: f64 = steps.iter().map(Vector3::norm).sum();
    let wanted = cut.edges.iter().map(|edge| (edge.at[1] - edge.at[0]).abs());
    [
        kinks.fold(0.0, f64::max).to_degrees(),
        length / wanted.sum::<f64>(),
    ]
}

/// Beside a row of edges, and at small angles to it, vertices go onto the line: nothing thin is left, and the line is
/// as long and as straight as it was.
#[test]
fn lines_beside_edges_leave_no_thin_triangles() {
    let sheet = square(1, 0.0, 11);
    let edge = 1.0 / 16.0;
    let offs = [0.0, 1e-5, 1e-3, 1e-2, 3e-2, 0.1, 0.2, 0.3];
    let angles = [0.0_f64, 0.1, 1.0, 3.0, 20.0];
    for (off, angle) in offs
        .iter()
        .flat_map(|off| angles.map(|angle| (*off, angle)))
    {
        let rise = 0.2 * angle.to_radians().tan();
        let y = (3.0 + off) * edge;
        let line = uv(&[[0.3, y - rise], [0.7, y + rise]], false);
        let cut = cut_and_check(&sheet, 4, &[line]);
        let [kink, length] = kink_and_length(&cut);
        let least = least_angle(&cut.piece);
        println!("{off} {angle}: {least:.1}, {kink:.2} degrees, {length:.6}");
        assert!(least > 8.0, "{off} {angle}: {least}");
        assert!(kink < 1e-3, "{off} {angle}: {kink}");
    }
}

/// Where vertices cannot go, as at corners of the traced mesh, a line is off by less than a hundredth of an edge.
#[test]
fn lines_stay_on_their_curves() {
    let sheet = square(6, 0.25, 12);
    for i in 0..12 {
        let angle = 0.5 + 0.1 * f64::from(i);
        let (sin, cos) = angle.sin_cos();
        let arc: Vec<_> = (0..=60)
            .map(|k| {
                let t = f64::from(k) / 60.0 - 0.5;
                let bow = 0.3 * t * t;
                [
                    0.5 + 0.8 * t * cos - bow * sin,
                    0.5 + 0.8 * t * sin + bow * cos,
                ]
            })
            .collect();
        let before = piece(&sheet, 3);
        let line = traced(&sheet, &uv(&arc, false));
        let cut = cut_lines(std::slice::from_ref(&line), before.clone());
        for vertex in &cut.vertices {
            let on = vertex.place.interpolate(&sheet.mesh, &sheet.positions);
            let off = (on - cut.piece.positions[vertex.vertex.index()]).norm();
            assert!(off < 0.011 * edge_length(&before), "{off}");
        }
        let [kink, length] = kink_and_length(&cut);
        println!(
            "{angle:.1}: {kink:.2} degrees, {length:.6}, {:.2}",
            least_angle(&cut.piece)
        );
        assert!(kink < 10.0, "{kink}");
        assert!((length - 1.0).abs() < 5e-3, "{length}");
    }
}
