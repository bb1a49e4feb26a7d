//! Every mistake is named; nothing panics.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod sheets;

use nalgebra::{Vector2, Vector3};
use ruga_crease::{
    Corners, CreaseError, Drive, GreyImage, LineInput, LineLaw, LineTracer, SkeletonSettings,
    check_lines, skeleton_lines,
};
use ruga_mesh::{Id, TriMesh, VertexId};
use sheets::{Sheet, square, torn};

fn uv(points: &[[f64; 2]]) -> LineInput {
    LineInput::Uv {
        points: points.iter().map(|&p| p.into()).collect(),
        is_closed: false,
        corners: Corners::Round,
    }
}

fn space(points: &[[f64; 3]], reach: f64) -> LineInput {
    LineInput::Positions {
        points: points.iter().map(|&p| p.into()).collect(),
        is_closed: false,
        reach,
        corners: Corners::Round,
    }
}

fn refused(sheet: &Sheet, line: &LineInput) -> CreaseError {
    let tracer = LineTracer::new(&sheet.mesh, &sheet.positions).with_uvs(&sheet.uvs);
    let error = tracer.trace(line).unwrap_err();
    assert!(!error.to_string().is_empty());
    error
}

#[test]
fn points() {
    use CreaseError::*;
    let sheet = square(6, 0.2, 1);
    assert_eq!(refused(&sheet, &uv(&[])), TooFewPoints { count: 0 });
    assert_eq!(refused(&sheet, &uv(&[[0.5; 2]])), TooFewPoints { count: 1 });
    let ring = LineInput::Uv {
        points: vec![Vector2::new(0.2, 0.2), Vector2::new(0.8, 0.2)],
        is_closed: true,
        corners: Corners::Keep,
    };
    assert_eq!(refused(&sheet, &ring), TooFewPoints { count: 2 });
    // There and back is no ring.
    let ring = LineInput::Uv {
        points: [[0.2, 0.2], [0.8, 0.2], [0.2, 0.2]]
            .map(Vector2::from)
            .to_vec(),
        is_closed: true,
        corners: Corners::Keep,
    };
    assert_eq!(refused(&sheet, &ring), TooFewPoints { count: 2 });
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(
            refused(&sheet, &uv(&[[0.5; 2], [bad, 0.5]])),
            NotFinite { point: 1 }
        );
        let line = space(&[[0.5, 0.5, bad], [0.2; 3]], 1.0);
        assert_eq!(refused(&sheet, &line), NotFinite { point: 0 });
        let line = space(&[[0.5, 0.5, 0.0], [0.2, 0.2, 0.0]], -bad);
        assert!(matches!(
            refused(&sheet, &line),
            OutOfRange { name: "reach", .. }
        ));
    }
    assert_eq!(refused(&sheet, &uv(&[[0.5; 2]; 3])), ZeroLength);
    assert!(matches!(
        refused(&sheet, &uv(&[[0.5; 2], [1.5, 0.5]])),
        OutsideUv { point: 1, .. }
    ));
    let far = space(&[[0.5, 0.5, 0.0], [0.6, 0.5, 0.4]], 0.1);
    assert!(matches!(
        refused(&sheet, &far),
        BeyondReach { point: 1, .. }
    ));
}

#[test]
fn charts() {
    use CreaseError::*;
    let sheet = torn(square(6, 0.0, 2), 0.5, Vector2::new(0.5, 0.0));
    // The left chart ends at 1/2, the right one begins at 1.
    assert!(matches!(
        refused(&sheet, &uv(&[[0.3, 0.4], [1.2, 0.4]])),
        AcrossSeam { leg: 0, .. }
    ));
    let folded = torn(square(6, 0.0, 2), 0.5, Vector2::new(-0.35, 0.1));
    let inside = [[0.33, 0.43], [0.42, 0.45]];
    assert!(matches!(
        refused(&folded, &uv(&inside)),
        OverlappingCharts { .. }
    ));
    let bare = square(3, 0.0, 2);
    let tracer = LineTracer::new(&bare.mesh, &bare.positions);
    assert_eq!(tracer.trace(&uv(&inside)), Err(NoTextureCoordinates));
}

/// Two squares side by side with a gap between, and one square of which a corner is cut out.
#[test]
fn parts_and_borders() {
    use CreaseError::*;
    let one = square(4, 0.0, 3);
    let count = one.positions.len() as u32;
    let beside = one.positions.iter().map(|p| p + Vector3::x() * 1.05);
    let positions: Vec<_> = one.positions.iter().copied().chain(beside).collect();
    let faces = one
        .mesh
        .faces()
        .as_slice()
        .iter()
        .map(|face| face.map(|v| v.0));
    let faces: Vec<_> = faces
        .clone()
        .chain(faces.map(|face| face.map(|v| v + count)))
        .collect();
    let mesh = TriMesh::new(positions.len(), faces).unwrap();
    let uvs = mesh
        .faces()
        .as_slice()
        .iter()
        .map(|face| face.map(|v| positions[v.index()].xy()));
    let lips = Sheet {
        uvs: uvs.collect(),
        mesh,
        positions,
    };
    let across = space(&[[0.6, 0.5, 0.0], [1.5, 0.5, 0.0]], 0.1);
    assert!(matches!(
        refused(&lips, &across),
        LeavesSurface { leg: 0, .. }
    ));
    assert!(matches!(
        refused(&lips, &uv(&[[0.6, 0.5], [1.5, 0.5]])),
        LeavesSurface { .. }
    ));
    let along = uv(&[[0.1, 0.0], [0.9, 0.0]]);
    assert!(matches!(refused(&lips, &along), AlongBorder { .. }));
    let edge = LineInput::Edges {
        vertices: (0..5).map(VertexId::from_index).collect(),
    };
    assert!(matches!(refused(&lips, &edge), AlongBorder { .. }));
}

#[test]
fn edge_paths() {
    use CreaseError::*;
    let sheet = square(4, 0.0, 4);
    let path = |vertices: &[u32]| LineInput::Edges {
        vertices: vertices.iter().map(|&v| VertexId(v)).collect(),
    };
    assert_eq!(refused(&sheet, &path(&[6])), TooFewPoints { count: 1 });
    assert_eq!(
        refused(&sheet, &path(&[6, 7, 6])),
        TooFewPoints { count: 2 }
    );
    assert_eq!(
        refused(&sheet, &path(&[6, 7, 6, 7, 6])),
        TooFewPoints { count: 2 }
    );
    assert_eq!(
        refused(&sheet, &path(&[6, 8])),
        NotAnEdge { vertices: [6, 8] }
    );
    assert_eq!(
        refused(&sheet, &path(&[6, 6])),
        NotAnEdge { vertices: [6, 6] }
    );
    assert_eq!(
        refused(&sheet, &path(&[6, 999])),
        UnknownVertex { vertex: 999 }
    );
}

#[test]
fn degenerate_triangles() {
    let mut sheet = square(6, 0.0, 5);
    // A vertex drawn onto its neighbour.
    sheet.positions[24] = sheet.positions[25];
    let line = uv(&[[0.1, 0.48], [0.9, 0.48]]);
    assert!(matches!(
        refused(&sheet, &line),
        CreaseError::DegenerateFace { .. }
    ));
    // Where texture triangles have no area: a way is found or its lack is told.
    let flat = sheet
        .uvs
        .as_slice()
        .iter()
        .map(|uvs| uvs.map(|uv| Vector2::new(uv.x, 0.0)));
    sheet.uvs = flat.collect();
    assert!(matches!(
        refused(&sheet, &line),
        CreaseError::OutsideUv { .. }
    ));
}

#[test]
fn lines_together() {
    let sheet = square(6, 0.1, 6);
    let tracer = LineTracer::new(&sheet.mesh, &sheet.positions).with_uvs(&sheet.uvs);
    let line = tracer.trace(&uv(&[[0.2, 0.5], [0.8, 0.5]])).unwrap();
    let part = tracer.trace(&uv(&[[0.3, 0.5], [0.7, 0.5]])).unwrap();
    let surface = (&sheet.mesh, sheet.positions.as_slice());
    let check = |lines: &[_], edge: f64| check_lines(lines, surface, edge).unwrap_err();
    let short = check(std::slice::from_ref(&part), 0.3);
    assert!(matches!(short, CreaseError::TooShort { line: 0, .. }));
    let same = check(&[line, part.clone()], 0.05);
    assert_eq!(same, CreaseError::IdenticalLines { lines: [0, 1] });
    assert!(matches!(
        check(&[part], 0.0),
        CreaseError::OutOfRange { name: "edge", .. }
    ));
}

#[test]
fn laws() {
    let law = LineLaw {
        width: 1e-3,
        stiffness: 0.1,
        angle: 0.5,
        fade: [1e-3, 2e-3],
    };
    assert_eq!(law.check(), Ok(()));
    for (bad, expected) in [
        (LineLaw { width: 0.0, ..law }, "width"),
        (LineLaw { width: -1.0, ..law }, "width"),
        (
            LineLaw {
                stiffness: 0.0,
                ..law
            },
            "stiffness",
        ),
        (
            LineLaw {
                stiffness: 1.01,
                ..law
            },
            "stiffness",
        ),
        (
            LineLaw {
                stiffness: f64::NAN,
                ..law
            },
            "stiffness",
        ),
        (LineLaw { angle: 3.2, ..law }, "angle"),
        (LineLaw { angle: -0.1, ..law }, "angle"),
        (
            LineLaw {
                fade: [-1.0, 0.0],
                ..law
            },
            "fade at the start",
        ),
        (
            LineLaw {
                fade: [0.0, f64::INFINITY],
                ..law
            },
            "fade at the end",
        ),
    ] {
        let found = bad.check();
        assert!(matches!(found, Err(CreaseError::OutOfRange { name, .. }) if name == expected));
    }
    let drive = Drive::Weights(vec![(0, 1.0), (7, 5.0)]);
    assert_eq!(drive.strength(1.0, &[0.25]), 0.25);
    assert_eq!(drive.strength(1.0, &[f64::NAN]), 0.0);
    assert_eq!(Drive::Load.strength(f64::NAN, &[]), 0.0);
}

#[test]
fn images() {
    use CreaseError::*;
    let settings = SkeletonSettings::default();
    let refuse = |width, height, values: &[f32]| {
        let image = GreyImage {
            width,
            height,
            values,
        };
        let lines = skeleton_lines(&image, &settings).map(|lines| lines.len());
        lines.unwrap_err()
    };
    assert!(matches!(refuse(0, 0, &[]), ImageSize { .. }));
    assert!(matches!(
        refuse(4, 4, &[0.0; 15]),
        ImageSize { values: 15, .. }
    ));
    assert!(matches!(
        refuse(1, 1, &[1.0]),
        NoLineInImage { bright: 1, .. }
    ));
    assert!(matches!(
        refuse(16, 16, &[0.0; 256]),
        NoLineInImage { bright: 0, .. }
    ));
    assert!(matches!(
        refuse(16, 16, &[f32::NAN; 256]),
        NoLineInImage { bright: 0, .. }
    ));
    assert!(matches!(refuse(16, 16, &[1.0; 256]), AllLineInImage { .. }));
    let mut noise = vec![0.0; 128 * 128];
    let mut state = 1u32;
    for value in &mut noise {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *value = if state >> 30 == 0 { 1.0 } else { 0.0 };
    }
    assert!(matches!(refuse(128, 128, &noise), TooManyBranches { .. }));
}
