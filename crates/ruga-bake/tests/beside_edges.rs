//! A fold along a line that runs closely beside edges of the mesh is baked as well as any other.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod patch;

use std::f64::consts::TAU;

use nalgebra::{Vector2, Vector3};
use patch::{Driver, Patch, SIDE, baked, degrees, rms, scatter, texel_parameters, uv};
use ruga_bake::{BakeSettings, Relief, WrinkleMap, bake};
use ruga_crease::{Corners, LineInput, LineTracer, MeshPiece, cut_lines};
use ruga_mesh::{FaceOrigin, Id, PerFace, TriMesh};

/// Cells of the layer and of the artist's mesh along the side.
const CELLS: usize = 112;
const ARTIST_CELLS: usize = 14;

/// Length of an edge (m).
const EDGE: f64 = SIDE / CELLS as f64;

/// Depth of the fold (m), and the length over which its flanks flatten: both sides fall by 45 degrees.
const DEPTH: f64 = 8e-3;

/// Error of the heights (m): what a transfer from one mesh to another leaves.
const NOISE: f64 = 1e-3 * EDGE;

/// Distance from the line, in texels, from which on a texel sees one side alone.
const BESIDE: f64 = 1.0;

/// A line from border to border of the patch.
#[derive(Clone, Copy, Debug)]
enum Curve {
    /// Through a point on the middle row, at an angle (rad) to the columns.
    Straight { at: f64, angle: f64 },
    /// An arc that touches a column on the middle row.
    Arc { at: f64, radius: f64 },
}

impl Curve {
    /// Signed distance from it (m).
    fn off(&self, s: f64, t: f64) -> f64 {
        let middle = 0.5 * SIDE;
        match *self {
            Self::Straight { at, angle } => (s - at) * angle.cos() - (t - middle) * angle.sin(),
            Self::Arc { at, radius } => radius - (s - at + radius).hypot(t - middle),
        }
    }

    /// Points along it.
    fn points(&self) -> Vec<Vector2<f64>> {
        let middle = 0.5 * SIDE;
        let count = 400;
        let along = (0..=count).map(|i| f64::from(i) / f64::from(count) * SIDE);
        let points = along.map(|t| match *self {
            Self::Straight { at, angle } => [at + (t - middle) * angle.tan(), t],
            Self::Arc { at, radius } => {
                let down = radius - (radius * radius - (t - middle).powi(2)).sqrt();
                [at - down, t]
            }
        });
        points.map(uv).collect()
    }
}

/// A patch cut along a curve, with a vertex on either side of it.
struct Cut {
    positions: Vec<Vector3<f64>>,
    on_driver: Vec<Vector3<f64>>,
    normals: Vec<Vector3<f64>>,
    faces: Vec<[u32; 3]>,
    uvs: Vec<[Vector2<f64>; 3]>,
    artist: Vec<(u32, [[f64; 3]; 3])>,
    /// Least angle of a triangle (degrees).
    least_angle: f64,
}

fn height(curve: &Curve, s: f64, t: f64) -> f64 {
    -DEPTH * (-curve.off(s, t).abs() / DEPTH).exp() + 0.5e-3 * (TAU * t / 14e-3).sin()
}

fn cut(curve: &Curve) -> Cut {
    let patch = Patch::new(Driver::Flat, [CELLS, ARTIST_CELLS], 0.0, |_, _| 0.0);
    let artist = Patch::new(Driver::Flat, [ARTIST_CELLS, ARTIST_CELLS], 0.0, |_, _| 0.0);
    let mesh = |patch: &Patch| TriMesh::new(patch.positions.len(), patch.faces.clone()).unwrap();
    let artist_mesh = mesh(&artist);
    let uvs: PerFace<_> = artist.uvs.clone().into();
    let tracer = LineTracer::new(&artist_mesh, &artist.positions).with_uvs(&uvs);
    let line = tracer.trace(&LineInput::Uv {
        points: curve.points(),
        is_closed: false,
        corners: Corners::Keep,
    });
    let lines = [line.unwrap()];
    let origin = |&(face, corners): &(u32, [[f64; 3]; 3])| FaceOrigin {
        face: ruga_mesh::FaceId(face),
        corners,
    };
    let cut = cut_lines(
        &lines,
        MeshPiece {
            mesh: mesh(&patch),
            origins: patch.artist.iter().map(origin).collect(),
            positions: patch.positions.clone(),
        },
    );
    assert_eq!(cut.warnings, []);
    let (mesh, flat) = (&cut.piece.mesh, &cut.piece.positions);
    let mut is_crease = vec![false; mesh.edges().len()];
    cut.edges
        .iter()
        .for_each(|e| is_crease[e.edge.index()] = true);
    // One of the two sides, from face to face.
    let mut is_right = vec![false; mesh.face_count()];
    is_right[0] = true;
    let mut queue = vec![ruga_mesh::FaceId(0)];
    while let Some(face) = queue.pop() {
        for (corner, edge) in mesh.face_edges(face).into_iter().enumerate() {
            if let Some(next) = mesh.neighbour(face, corner)
                && !is_crease[edge.index()]
                && !is_right[next.index()]
            {
                is_right[next.index()] = true;
                queue.push(next);
            }
        }
    }
    assert!(is_right.contains(&false), "the line goes through");
    let mut copies = vec![None; flat.len()];
    let mut on_driver = flat.clone();
    let mut copied = Vec::new();
    for edge in &cut.edges {
        for v in mesh.edges()[edge.edge].vertices {
            copies[v.index()].get_or_insert_with(|| {
                on_driver.push(flat[v.index()]);
                copied.push(v.index());
                on_driver.len() as u32 - 1
            });
        }
    }
    let faces = mesh.faces().iter().map(|(face, corners)| {
        corners.map(|v| match (is_right[face.index()], copies[v.index()]) {
            (true, Some(copy)) => copy,
            _ => v.0,
        })
    });
    let faces: Vec<_> = faces.collect();
    let place = |v: u32| on_driver[v as usize];
    let angle = |[a, b, c]: [Vector3<f64>; 3]| (b - a).angle(&(c - a)).to_degrees();
    let angles = faces.iter().flat_map(|f| {
        let [a, b, c] = f.map(place);
        [angle([a, b, c]), angle([b, c, a]), angle([c, a, b])]
    });
    Cut {
        least_angle: angles.fold(180.0, f64::min),
        positions: on_driver
            .iter()
            .enumerate()
            .map(|(v, p)| {
                let v = if v < flat.len() {
                    v
                } else {
                    copied[v - flat.len()]
                };
                p + Vector3::z() * (height(curve, p.x, p.y) + NOISE * scatter(v))
            })
            .collect(),
        normals: vec![Vector3::z(); on_driver.len()],
        uvs: faces
            .iter()
            .map(|f| f.map(|v| uv([place(v).x, place(v).y])))
            .collect(),
        artist: cut
            .piece
            .origins
            .as_slice()
            .iter()
            .map(|origin| (origin.face.0, origin.corners))
            .collect(),
        faces,
        on_driver,
    }
}

/// RMS and largest error of the normals outside of the line's texel (degrees).
fn errors(curve: &Curve, map: &WrinkleMap) -> [f64; 2] {
    let texel = SIDE / f64::from(map.size);
    let exact = |s: f64, t: f64| {
        let h = 1e-7;
        let ds = height(curve, s + h, t) - height(curve, s - h, t);
        let dt = height(curve, s, t + h) - height(curve, s, t - h);
        Vector3::new(-ds, -dt, 2.0 * h).normalize()
    };
    let texels = (0..map.normals.len()).filter_map(|i| {
        let [s, t] = texel_parameters(map, i);
        let is_beside = curve.off(s, t).abs() > BESIDE * texel;
        is_beside.then(|| degrees(&baked(map, i), &exact(s, t)))
    });
    let texels: Vec<_> = texels.collect();
    [
        rms(texels.iter().copied()),
        texels.iter().copied().fold(0.0, f64::max),
    ]
}

/// Errors of the map of a fold along a curve, and the least angle of its mesh (degrees).
fn measured(curve: &Curve) -> [f64; 3] {
    let cut = cut(curve);
    let frames = Patch::new(Driver::Flat, [ARTIST_CELLS, ARTIST_CELLS], 0.0, |_, _| 0.0).frames;
    let relief = Relief {
        positions: &cut.positions,
        driver_positions: &cut.on_driver,
        driver_normals: &cut.normals,
        offset: 0.0,
        faces: &cut.faces,
        uvs: &cut.uvs,
        artist: &cut.artist,
    };
    let settings = BakeSettings {
        size: 256,
        ..BakeSettings::default()
    };
    let [rms, most] = errors(curve, &bake(&relief, &frames, &settings).unwrap());
    [rms, most, cut.least_angle]
}

#[test]
fn a_fold_beside_edges_has_no_specks() {
    // A column along edges of the artist's mesh, whose corners stay, and one inside its triangles.
    for column in [CELLS / 2, CELLS / 2 + 3] {
        let at = |off: f64| (column as f64 + off) * EDGE;
        let beside = [1e-5, 1e-3, 1e-2, 0.1].map(|off| Curve::Straight {
            at: at(off),
            angle: 0.0,
        });
        let aslant = [0.1_f64, 1.0, 3.0].map(|angle| Curve::Straight {
            at: at(1e-2),
            angle: angle.to_radians(),
        });
        let arcs = [0.0, 0.1].map(|off| Curve::Arc {
            at: at(off),
            radius: 2.0 * SIDE,
        });
        let curves = beside.into_iter().chain(aslant).chain(arcs);
        // Every third on the other column, which is the easier one.
        let each = if column == CELLS / 2 { 1 } else { 3 };
        for curve in curves.step_by(each) {
            let [rms, most, least] = measured(&curve);
            println!("{curve:?}: {rms:.3}, {most:.2} degrees; least angle {least:.3}");
            assert!(rms < 0.06, "{curve:?}: {rms} degrees");
            // A vertex that stays may be a hundredth of an edge beside the line that goes through it.
            assert!(most < 0.6, "{curve:?}: {most} degrees");
        }
    }
}
