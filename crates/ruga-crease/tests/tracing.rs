//! Lines over the triangles of a surface: where they run, how long they are, where they meet.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod sheets;

use std::f64::consts::{PI, TAU};

use nalgebra::{Vector2, Vector3};
use ruga_crease::{
    Corners, CreaseWarning, LineInput, LinePlaces, LineTracer, TracedLine, check_lines,
    line_crossings,
};
use ruga_mesh::{Id, MaterialPoint, TriMesh, VertexId};
use sheets::{Sheet, sphere, square, torn, tube};

fn uv(points: &[[f64; 2]]) -> LineInput {
    LineInput::Uv {
        points: points.iter().map(|&p| p.into()).collect(),
        is_closed: false,
        corners: Corners::Round,
    }
}

fn traced(sheet: &Sheet, line: &LineInput) -> TracedLine {
    let tracer = LineTracer::new(&sheet.mesh, &sheet.positions).with_uvs(&sheet.uvs);
    let line = tracer.trace(line).unwrap();
    check_chain(sheet, &line);
    line
}

fn position(sheet: &Sheet, place: MaterialPoint) -> Vector3<f64> {
    place.interpolate(&sheet.mesh, &sheet.positions)
}

/// Segments follow each other, of a closed line round and round, lie in their triangles and are as long as they
/// say.
fn check_chain(sheet: &Sheet, line: &TracedLine) {
    let mut at = 0.0;
    for (i, segment) in line.segments().iter().enumerate() {
        let [from, to] = [0.0, 1.0].map(|share| position(sheet, segment.place(share)));
        let least = segment
            .from
            .iter()
            .chain(&segment.to)
            .copied()
            .fold(1.0, f64::min);
        assert!(least > -1e-9, "{segment:?}");
        assert!(((to - from).norm() - segment.length).abs() < 1e-12);
        assert!((segment.start - at).abs() < 1e-12);
        at += segment.length;
        let first = line.segments().first().filter(|_| line.is_closed());
        let next = line.segments().get(i + 1).or(first);
        if let Some(next) = next {
            assert!(
                (position(sheet, next.place(0.0)) - to).norm() < 1e-9,
                "{segment:?} {next:?}"
            );
        }
    }
    assert!((line.length() - at).abs() < 1e-12);
}

#[test]
fn straight_lines_run_straight_at_any_angle() {
    let sheet = square(9, 0.3, 1);
    for i in 0..48 {
        let (sin, cos) = (TAU * f64::from(i) / 48.0).sin_cos();
        let [from, to] = [-0.43, 0.43].map(|r| [0.5 + r * cos, 0.5 + r * sin]);
        let line = traced(&sheet, &uv(&[from, to]));
        assert!((line.length() - 0.86).abs() < 1e-12, "{i}");
        let in_space = LineInput::Positions {
            points: [from, to].map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec(),
            is_closed: false,
            reach: 1e-6,
            corners: Corners::Round,
        };
        let again = traced(&sheet, &in_space);
        assert!((again.length() - 0.86).abs() < 1e-12, "{i}");
        let middle = position(&sheet, line.place(0.43).unwrap());
        assert!((middle - Vector3::new(0.5, 0.5, 0.0)).norm() < 1e-9);
    }
}

/// Along edges, through vertices, between lattice points: where rounding decides the side.
#[test]
fn lines_through_vertices_and_along_edges_are_whole() {
    let sheet = square(8, 0.0, 2);
    for ends in [
        [[0.25, 0.125], [0.25, 0.875]],
        [[0.0, 0.0], [1.0, 1.0]],
        [[0.125, 0.25], [0.875, 0.25]],
        [[0.25, 0.25], [0.75, 0.5]],
        [[0.0, 1.0], [1.0, 0.0]],
        [[0.5, 0.5], [0.5 + 1e-13, 0.75]],
    ] {
        for [a, b] in [ends, [ends[1], ends[0]]] {
            let line = traced(&sheet, &uv(&[a, b]));
            let length = (Vector2::from(a) - Vector2::from(b)).norm();
            assert!((line.length() - length).abs() < 1e-9, "{a:?} {b:?}");
        }
    }
}

#[test]
fn a_seam_is_crossed_by_points_on_both_sides() {
    let by = Vector2::new(0.5, 2.0);
    let sheet = torn(square(8, 0.0, 3), 0.5, by);
    let (left, right) = ([0.2, 0.3], [0.8 + by.x, 0.6 + by.y]);
    let seam = [0.5, 0.45];
    let beyond = [0.5 + by.x, 0.45 + by.y];
    let line = traced(&sheet, &uv(&[left, seam, beyond, right]));
    assert!(
        (line.length() - 0.6_f64.hypot(0.3)).abs() < 1e-9,
        "{}",
        line.length()
    );

    // Not quite the same place: the way goes on along the surface.
    let inside = [beyond[0] + 0.02, beyond[1]];
    let line = traced(&sheet, &uv(&[left, [0.48, 0.45], inside, right]));
    assert!(line.length() > 0.65 && line.length() < 0.7);
}

#[test]
fn rings_close_across_seams_too() {
    let ring = |n: i32, shift: &dyn Fn(Vector2<f64>) -> Vector2<f64>| -> Vec<Vector2<f64>> {
        let corner = |i: i32| {
            let (sin, cos) = (TAU * (f64::from(i) + 0.5) / f64::from(n)).sin_cos();
            shift(Vector2::new(0.5 + 0.3 * cos, 0.5 + 0.3 * sin))
        };
        (0..n).map(corner).collect()
    };
    let plain = square(10, 0.2, 4);
    let points = ring(12, &|p| p);
    let line = |points| LineInput::Uv {
        points,
        is_closed: true,
        corners: Corners::Round,
    };
    let whole = traced(&plain, &line(points));
    assert!(whole.is_closed());
    assert!(
        (whole.length() / (0.3 * TAU) - 1.0).abs() < 0.01,
        "{}",
        whole.length()
    );
    let ends = whole.places();
    let gap = position(&plain, ends[0]) - position(&plain, ends[ends.len() - 1]);
    assert!(gap.norm() < 1e-12);

    // The same in two charts, with points on both sides of the seam at x = 1/2.
    let by = Vector2::new(0.7, 0.0);
    let sheet = torn(square(10, 0.0, 4), 0.5, by);
    let half = |sign: f64, shift: Vector2<f64>| {
        let place = move |i: i32| {
            let (sin, cos) = (PI * (f64::from(i) / 8.0 - 0.5)).sin_cos();
            Vector2::new(0.5 + sign * 0.3 * cos.max(0.0), 0.5 + sign * 0.3 * sin) + shift
        };
        (0..=8).map(place)
    };
    let points: Vec<_> = half(1.0, by).chain(half(-1.0, Vector2::zeros())).collect();
    let torn = traced(&sheet, &line(points));
    assert!(
        (torn.length() / (0.3 * TAU) - 1.0).abs() < 0.01,
        "{}",
        torn.length()
    );
}

/// A place on a seam lies in faces of both charts, and the straight way of one runs through the other as well.
#[test]
fn a_leg_that_begins_on_a_seam_stays_in_its_chart() {
    for columns in [3, 10] {
        let sheet = tube(columns);
        for height in [0.5, 0.53] {
            let across = [0.8, 1.0, 0.0, 0.3].map(|u| [u, height]);
            let back = [0.3, 0.0, 1.0, 0.8].map(|u| [u, height]);
            for points in [across, back] {
                let line = traced(&sheet, &uv(&points));
                assert!((line.length() - 0.5).abs() < 1e-9, "{}", line.length());
            }
            // The long way round ends on the seam, too.
            let start = 1.0 - 0.9 / columns as f64;
            let round = traced(&sheet, &uv(&[[start, height], [0.0, height]]));
            assert!((round.length() - start).abs() < 1e-9, "{}", round.length());
            let ring = LineInput::Uv {
                points: [0.0, 0.3, 0.7, 1.0].map(|u| [u, height].into()).to_vec(),
                is_closed: true,
                corners: Corners::Round,
            };
            let ring = traced(&sheet, &ring);
            assert!((ring.length() - 1.0).abs() < 1e-9, "{}", ring.length());
        }
    }
}

/// Points near a seam, but not on it: the ring closes across the gap.
#[test]
fn a_ring_is_closed_where_its_points_leave_a_gap() {
    let sheet = tube(10);
    for points in [
        vec![0.02, 0.3, 0.7, 0.99],
        vec![0.7, 0.99, 0.02, 0.3],
        vec![0.99, 0.7, 0.3, 0.02],
    ] {
        let ring = LineInput::Uv {
            points: points.iter().map(|&u| [u, 0.53].into()).collect(),
            is_closed: true,
            corners: Corners::Round,
        };
        let ring = traced(&sheet, &ring);
        assert!((ring.length() - 1.0).abs() < 1e-9, "{}", ring.length());
    }
}

#[test]
fn points_beside_a_sphere_are_projected() {
    let sheet = sphere(4);
    let meridian = |i: i32| {
        let (sin, cos) = (0.3 + 2.4 * f64::from(i) / 12.0).sin_cos();
        Vector3::new(sin * 0.8, sin * 0.6, cos) * 1.02
    };
    let line = LineInput::Positions {
        points: (0..=12).map(meridian).collect(),
        is_closed: false,
        reach: 0.05,
        corners: Corners::Round,
    };
    let line = traced(&sheet, &line);
    assert!((line.length() - 2.4).abs() < 0.01, "{}", line.length());
    for place in line.places() {
        let p = position(&sheet, place);
        assert!((p.x * 0.6 - p.y * 0.8).abs() < 5e-3);
    }
}

#[test]
fn edge_paths_run_along_edges() {
    let sheet = square(6, 0.2, 5);
    let row = (0..=6).map(|i| VertexId::from_index(3 * 7 + i)).collect();
    let line = traced(&sheet, &LineInput::Edges { vertices: row });
    let chords = (0..6).map(|i| (sheet.positions[22 + i] - sheet.positions[21 + i]).norm());
    assert!((line.length() - chords.sum::<f64>()).abs() < 1e-12);
    assert!(!line.is_closed());
    let ring = [16, 17, 24, 23, 16].map(VertexId::from_index).to_vec();
    assert!(traced(&sheet, &LineInput::Edges { vertices: ring }).is_closed());
}

#[test]
fn crossings_are_found_once_with_their_arc_lengths() {
    let sheet = square(8, 0.25, 6);
    let lines = [
        uv(&[[0.1, 0.5], [0.9, 0.5]]),
        uv(&[[0.5, 0.1], [0.5, 0.9]]),
        // Touches the first with its end.
        uv(&[[0.3, 0.5], [0.2, 0.8]]),
    ];
    let lines = lines.map(|line| traced(&sheet, &line));
    let found = line_crossings(&lines, &sheet.mesh);
    let pairs: Vec<_> = found.iter().map(|c| c.lines).collect();
    assert_eq!(pairs, [[0, 1], [0, 2]], "{found:?}");
    assert!((found[0].at[0] - 0.4).abs() < 1e-9 && (found[0].at[1] - 0.4).abs() < 1e-9);
    assert!((found[1].at[0] - 0.2).abs() < 1e-9 && found[1].at[1].abs() < 1e-9);
    // In vertices and on edges of a regular sheet as well.
    let sheet = square(8, 0.0, 6);
    let lines = [
        uv(&[[0.0, 0.5], [1.0, 0.5]]),
        uv(&[[0.25, 0.25], [0.75, 0.75]]),
    ];
    let lines = lines.map(|line| traced(&sheet, &line));
    assert_eq!(line_crossings(&lines, &sheet.mesh).len(), 1);
}

#[test]
fn odd_lines_are_told_of() {
    let sheet = square(8, 0.2, 7);
    let surface = (&sheet.mesh, sheet.positions.as_slice());
    let warnings = |lines: &[LineInput]| {
        let lines: Vec<_> = lines.iter().map(|line| traced(&sheet, line)).collect();
        check_lines(&lines, surface, 0.02).unwrap()
    };
    assert_eq!(warnings(&[uv(&[[0.1, 0.5], [0.9, 0.5]])]), []);
    // Meeting is no reason to warn, running side by side is.
    let crossed = [uv(&[[0.1, 0.5], [0.9, 0.5]]), uv(&[[0.2, 0.2], [0.8, 0.8]])];
    assert_eq!(warnings(&crossed), []);
    let beside = [
        uv(&[[0.1, 0.5], [0.9, 0.5]]),
        uv(&[[0.1, 0.53], [0.9, 0.53]]),
    ];
    assert!(matches!(
        warnings(&beside)[..],
        [CreaseWarning::TooClose { lines: [0, 1], .. }]
    ));
    let loops = uv(&[[0.1, 0.4], [0.8, 0.4], [0.8, 0.8], [0.4, 0.8], [0.4, 0.1]]);
    let found = warnings(&[loops]);
    assert!(
        matches!(found[..], [CreaseWarning::SelfCrossing { line: 0, .. }]),
        "{found:?}"
    );
    assert!(found[0].to_string().contains("crosses itself"));
    let hairpin = uv(&[[0.1, 0.4], [0.8, 0.4], [0.8, 0.43], [0.1, 0.43]]);
    assert!(matches!(
        warnings(&[hairpin])[..],
        [CreaseWarning::TooClose { lines: [0, 0], .. }]
    ));
    let back = uv(&[[0.1, 0.4], [0.8, 0.4], [0.1, 0.4]]);
    let told = warnings(&[back])[0].to_string();
    assert!(told.contains("lies on itself"), "{told}");
}

/// The arms of a figure eight, of which thinning makes two loops that begin and end in its middle.
#[test]
fn loops_that_meet_where_they_begin_are_not_too_close() {
    let sheet = square(8, 0.2, 7);
    let surface = (&sheet.mesh, sheet.positions.as_slice());
    for slant in [0.0, 0.8] {
        // Drops whose tips are in the middle.
        let drop = |side: f64| {
            let point = |i: i32| {
                let (sin, cos) = (TAU * f64::from(i) / 24.0).sin_cos();
                let away = 0.2 * (1.0 - cos);
                let up = 0.2 * sin * (away / 0.2).min(1.0);
                Vector2::new(0.5 + side * away + slant * up, 0.5 + up)
            };
            LineInput::Uv {
                points: (0..24).map(point).collect(),
                is_closed: true,
                corners: Corners::Round,
            }
        };
        let lines = [-1.0, 1.0].map(|side| traced(&sheet, &drop(side)));
        assert_eq!(check_lines(&lines, surface, 0.01).unwrap(), [], "{slant}");
    }
}

#[test]
fn lines_are_found_at_their_places() {
    let sheet = square(8, 0.25, 9);
    let lines = [
        uv(&[[0.1, 0.5], [0.9, 0.52]]),
        uv(&[[0.5, 0.1], [0.52, 0.9]]),
    ];
    let lines = lines.map(|line| traced(&sheet, &line));
    let places = LinePlaces::new(&lines, &sheet.mesh);
    for (number, line) in lines.iter().enumerate() {
        for i in 0..=200 {
            let at = line.length() * f64::from(i) / 200.0;
            let found = places.passages(&line.place(at).unwrap());
            let own = found.iter().find(|passage| passage.0 == number).unwrap();
            assert!((own.1 - at).abs() < 1e-9);
        }
    }
    let crossing = line_crossings(&lines, &sheet.mesh)[0];
    let both = places.passages(&crossing.place);
    assert_eq!(both.iter().map(|p| p.0).collect::<Vec<_>>(), [0, 1]);
    let beside = MaterialPoint::at_corner(sheet.mesh.vertex_faces(VertexId(0))[0], 0);
    assert!(places.passages(&beside).is_empty());
}

/// A vertex with fifty faces, and a line right through it.
#[test]
fn a_pole_is_passed() {
    let rim = (0..50).map(|i| {
        let (sin, cos) = (TAU * f64::from(i) / 50.0).sin_cos();
        Vector3::new(cos, sin, 0.0)
    });
    let positions: Vec<_> = std::iter::once(Vector3::zeros()).chain(rim).collect();
    let faces = (0..50).map(|i| [0, 1 + i, 1 + (i + 1) % 50]).collect();
    let mesh = TriMesh::new(51, faces).unwrap();
    let uvs = mesh
        .faces()
        .as_slice()
        .iter()
        .map(|face| face.map(|v| positions[v.index()].xy()));
    let sheet = Sheet {
        uvs: uvs.collect(),
        mesh,
        positions,
    };
    for i in 0..60 {
        let (sin, cos) = (TAU * f64::from(i) / 60.0).sin_cos();
        let line = traced(
            &sheet,
            &uv(&[[-0.9 * cos, -0.9 * sin], [0.9 * cos, 0.9 * sin]]),
        );
        assert!((line.length() - 1.8).abs() < 1e-9);
    }
}

#[test]
fn ten_thousand_points_are_traced() {
    let sheet = square(12, 0.2, 8);
    let wave = |i: i32| {
        let x = 0.05 + 0.9 * f64::from(i) / 1e4;
        Vector2::new(x, 0.5 + 0.3 * (20.0 * x).sin())
    };
    let line = LineInput::Uv {
        points: (0..=10_000).map(wave).collect(),
        is_closed: false,
        corners: Corners::Keep,
    };
    let line = traced(&sheet, &line);
    assert!(line.segments().len() > 10_000);
}
