//! A square driver with layers' meshes on it, and a closed block, for tests.

use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BaseSurface, BlendShape, Driver, Smoothing};
use ruga_mesh::{FaceId, Id, VertexId};

use crate::skin::piece::Piece;
use crate::skin::skin_mesh::{RegionMesh, SkinMesh};
use crate::{Coupling, LayerSpec, Presence, Sampling};

pub(crate) const SIDE: f64 = 0.04;
const CELLS: usize = 20;

/// Position of a place of the square.
pub(crate) type Shape<'a> = &'a dyn Fn(Vector2<f64>) -> Vector3<f64>;

/// A square with a blend shape that takes it from one shape to another.
pub(crate) fn square(rest: Shape, bent: Shape) -> Driver {
    Driver::new(&square_mesh(rest, bent)).expect("a square")
}

/// The same as a file has it.
pub(crate) fn square_mesh(rest: Shape, bent: Shape) -> ArtistMesh {
    let places = (0..=CELLS).flat_map(|j| (0..=CELLS).map(move |i| [i, j]));
    let places: Vec<Vector2<f64>> = places
        .map(|c| SIDE * (Vector2::from(c.map(|c| c as f64 / CELLS as f64)).add_scalar(-0.5)))
        .collect();
    let at = |i: usize, j: usize| (j * (CELLS + 1) + i) as u32;
    let cells = (0..CELLS).flat_map(|j| (0..CELLS).map(move |i| (i, j)));
    let triangles = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    ArtistMesh {
        positions: places.iter().map(|p| rest(*p)).collect(),
        uvs: Some(places.clone()),
        triangles: triangles.collect(),
        shapes: vec![BlendShape {
            name: "bend".into(),
            position_deltas: places.iter().map(|p| bent(*p) - rest(*p)).collect(),
            normal_deltas: None,
        }],
        ..ArtistMesh::default()
    }
}

/// All of a driver as a layer's mesh, at a distance.
pub(crate) fn skin(driver: &Driver, levels: u32, offset: f64) -> SkinMesh {
    region(driver, levels, offset).skin
}

/// All of a driver as the output mesh of a layer.
pub(crate) fn region(driver: &Driver, levels: u32, offset: f64) -> RegionMesh {
    let faces: Vec<_> = driver.topology().faces().ids().collect();
    region_of(driver, &faces, levels, offset)
}

/// The faces in the middle of a square, half as wide, as the mesh of a layer.
pub(crate) fn middle(driver: &Driver, levels: u32) -> SkinMesh {
    let is_inside = |corners: &[VertexId; 3]| {
        let places = corners.map(|v| driver.rest()[v.index()]);
        places.iter().all(|x| x.xy().amax() < 0.25 * SIDE + 1e-9)
    };
    let faces = driver.topology().faces().iter();
    let inside = faces.filter(|(_, corners)| is_inside(corners));
    let inside: Vec<_> = inside.map(|(face, _)| face).collect();
    region_of(driver, &inside, levels, 0.0).skin
}

/// Some faces of a driver as the output mesh of a layer.
pub(crate) fn region_of(driver: &Driver, faces: &[FaceId], levels: u32, offset: f64) -> RegionMesh {
    let base = BaseSurface::new(driver, faces, levels, Smoothing::Loop);
    let on = (Piece::of(&base), Smoothing::Loop, offset);
    let region = RegionMesh::new(driver, &knuckle(), on, &mut || true);
    region.expect("a plain layer")
}

/// A layer held by springs alone.
pub(crate) fn knuckle() -> LayerSpec {
    let preset = ruga_material::preset("knuckle").expect("a preset");
    LayerSpec {
        name: "skin".into(),
        material: preset.layer,
        laminate: None,
        substrate: preset.substrate,
        model: ruga_material::WavelengthModel::Layer,
        coupling: Coupling::Elastic,
        sampling: Sampling::Quadrature,
        map: None,
        sharp: false,
        bending_transfer: None,
        variation: None,
        presence: Presence::default(),
        creases: Vec::new(),
        growths: Vec::new(),
    }
}

/// Sides of [`block`], m.
pub(crate) const SIDES: [f64; 3] = [0.02, 0.015, 0.01];

/// A block of 2 x 2 x 2 squares a side, with a shape that shears it.
pub(crate) fn block() -> Arc<Driver> {
    let at = |c: [usize; 3]| Vector3::from_fn(|axis, _| 0.5 * SIDES[axis] * c[axis] as f64);
    let mut mesh = ArtistMesh::default();
    for axis in 0..3 {
        let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
        for (side, [i, j]) in [0, 2]
            .map(|s| (0..2).flat_map(move |i| (0..2).map(move |j| (s, [i, j]))))
            .into_iter()
            .flatten()
        {
            let first = mesh.positions.len() as u32;
            for [u, v] in [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]] {
                let mut corner = [0; 3];
                corner[axis] = side;
                corner[a] = u;
                corner[b] = v;
                mesh.positions.push(at(corner));
            }
            let order = if side == 2 { [1, 2, 3] } else { [3, 2, 1] };
            let [p, q, r] = order.map(|k| first + k);
            mesh.triangles.extend([[first, p, q], [first, q, r]]);
        }
    }
    let sheared = |p: &Vector3<f64>| Vector3::new(0.2 * p.z, 0.0, 0.1 * p.x);
    mesh.shapes = vec![BlendShape {
        name: "shear".into(),
        position_deltas: mesh.positions.iter().map(sheared).collect(),
        normal_deltas: None,
    }];
    mesh.uvs = Some(
        mesh.positions
            .iter()
            .map(|p| Vector2::new(p.x, p.y + p.z))
            .collect(),
    );
    Arc::new(Driver::new(&mesh).expect("a closed block"))
}
