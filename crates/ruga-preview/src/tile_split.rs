//! A mesh with UDIM tiles as the page takes it: the tiles side by side, with room between them.

use std::borrow::Cow;
use std::collections::BTreeSet;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendShape};

/// Distance along U from one tile to the next: half a unit of room on both sides, so that a place on the border
/// of a tile, or rounded beyond it, is in no other.
const PITCH: f64 = 2.0;

/// The squares of texture space that have maps, and the mesh that is laid out for them.
pub(crate) struct TileSplit<'a> {
    /// Lowest U and V of each square, V down; empty for a mesh without tiles, whose only map repeats.
    squares: Vec<[i32; 2]>,
    /// The mesh; of one with tiles, vertices that triangles of several tiles share are split.
    pub(crate) mesh: Cow<'a, ArtistMesh>,
}

impl<'a> TileSplit<'a> {
    /// Lays a mesh out for maps of these squares, which may come several times; one whose maps all repeat stays as
    /// it is.
    pub(crate) fn new(
        mesh: &'a ArtistMesh,
        squares: impl Iterator<Item = Option<[i32; 2]>>,
    ) -> Self {
        let squares: Vec<[i32; 2]> = squares
            .flatten()
            .collect::<BTreeSet<_>>()
            .into_iter()
            .collect();
        if squares.is_empty() {
            return Self::repeating(mesh);
        }
        let place = |number: usize, place| place + Vector2::new(PITCH * number as f64, 0.0);
        let mesh = Cow::Owned(laid_out(mesh, &squares, place));
        Self { squares, mesh }
    }

    /// A mesh without tiles, as it is.
    pub(crate) fn repeating(mesh: &'a ArtistMesh) -> Self {
        Self {
            squares: Vec::new(),
            mesh: Cow::Borrowed(mesh),
        }
    }

    /// Number of tiles; 0 for a mesh without.
    pub(crate) fn count(&self) -> usize {
        self.squares.len()
    }

    /// Number of the square of a map, from 0; the first for maps that repeat.
    pub(crate) fn number(&self, square: Option<[i32; 2]>) -> usize {
        let found = self.squares.iter().position(|other| Some(*other) == square);
        found.unwrap_or(0)
    }

    /// Number of the tile in which a place of the mesh lies, and the place in it.
    pub(crate) fn local(&self, uv: Vector2<f64>) -> (usize, Vector2<f64>) {
        if self.squares.is_empty() {
            return (0, uv);
        }
        let number = ((uv.x + 0.5) / PITCH).floor();
        (number as usize, Vector2::new(uv.x - PITCH * number, uv.y))
    }
}

/// The mesh with every triangle where `place` has its tile, by the tile's number and the place in it, from 0 to 1;
/// triangles in none of `squares` have the next number.
pub(crate) fn laid_out(
    mesh: &ArtistMesh,
    squares: &[[i32; 2]],
    place: impl Fn(usize, Vector2<f64>) -> Vector2<f64>,
) -> ArtistMesh {
    let Some(uvs) = &mesh.uvs else {
        return mesh.clone();
    };
    let number_of = |corners: &[u32; 3]| {
        let middle: Vector2<f64> = corners.iter().map(|&v| uvs[v as usize] / 3.0).sum();
        let square = [middle.x, middle.y].map(|c| c.floor() as i32);
        let number = squares.iter().position(|other| *other == square);
        (number.unwrap_or(squares.len()), square)
    };
    let placed: Vec<(usize, [i32; 2])> = mesh.triangles.iter().map(number_of).collect();
    // A vertex in every tile that it is needed in, in the order of the file.
    let corners = mesh.triangles.iter().zip(&placed);
    let uses = corners.flat_map(|(corners, (number, square))| {
        corners
            .iter()
            .map(move |&vertex| (vertex, *number, *square))
    });
    let vertices: Vec<(u32, usize, [i32; 2])> = uses.collect::<BTreeSet<_>>().into_iter().collect();
    let vertex = |of: u32, (number, square): (usize, [i32; 2])| {
        let found = vertices.binary_search(&(of, number, square));
        found.map_or(0, |index| index as u32)
    };
    let copied = |values: &Vec<Vector3<f64>>| -> Vec<Vector3<f64>> {
        let values = vertices.iter().map(|(of, ..)| values[*of as usize]);
        values.collect()
    };
    let uv = |&(of, number, [u, v]): &(u32, usize, [i32; 2])| {
        let local = uvs[of as usize] - Vector2::new(f64::from(u), f64::from(v));
        place(number, local)
    };
    let shape = |shape: &BlendShape| BlendShape {
        name: shape.name.clone(),
        position_deltas: copied(&shape.position_deltas),
        normal_deltas: shape.normal_deltas.as_ref().map(copied),
    };
    ArtistMesh {
        name: mesh.name.clone(),
        positions: copied(&mesh.positions),
        normals: mesh.normals.as_ref().map(copied),
        uvs: Some(vertices.iter().map(uv).collect()),
        triangles: mesh
            .triangles
            .iter()
            .zip(&placed)
            .map(|(corners, place)| corners.map(|of| vertex(of, *place)))
            .collect(),
        shapes: mesh.shapes.iter().map(shape).collect(),
    }
}
