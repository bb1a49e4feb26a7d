//! A stylised head with blend shapes in ARKit's names.
//!
//! [`solid`] says where its skin is, [`lattice`] which vertices are neighbours; [`surface`] lays the
//! lattice on the skin and [`unfold`] lays the skin flat. [`shapes`] move it, [`paint()`] says what it is
//! like where.

mod eyeballs;
mod lattice;
mod openings;
mod paint;
mod shapes;
mod solid;
mod surface;
mod unfold;

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::Vector2;
use ruga_blend::{ArtistMesh, BlendError, BlendShape};

use super::finish;
use lattice::{Lattice, Part};
use openings::Openings;
pub(super) use paint::{TEXELS, paint};
use solid::Point;

/// The head, as its file holds it.
pub(super) struct Head {
    pub(super) mesh: ArtistMesh,
    /// Vertices and triangles of the skin; those after them are the eyeballs'.
    pub(super) skin: (Range<usize>, Range<usize>),
}

/// Makes the head.
pub(super) fn head() -> Result<Head, BlendError> {
    let openings = Openings::new();
    let lattice = Lattice::new(&openings.slits());
    let positions = surface::positions(&lattice, &openings);
    let unfolded = unfold::unfold(&lattice, &openings, &positions);
    let mut charts = Charts {
        positions: positions.clone(),
        uvs: unfolded.face.clone(),
        sources: (0..positions.len()).collect(),
        triangles: Vec::new(),
    };
    charts.cut(&lattice, &unfolded.back);
    let vertices = charts.positions.len();
    let triangles = charts.triangles.len();
    let shapes = shapes::shapes(&lattice, &openings, &positions);
    charts.add_eyeballs();
    let shapes = shapes.into_iter().map(|(name, ways)| BlendShape {
        name,
        position_deltas: charts.deltas(&ways),
        normal_deltas: None,
    });
    let mesh = ArtistMesh {
        name: "Face".to_owned(),
        shapes: shapes.collect(),
        positions: charts.positions,
        normals: None,
        uvs: Some(charts.uvs),
        triangles: charts.triangles,
    };
    Ok(Head {
        mesh: finish(mesh)?,
        skin: (0..vertices, 0..triangles),
    })
}

/// Vertices as the file has them: those on the rim of the face twice, once per chart.
struct Charts {
    positions: Vec<Point>,
    uvs: Vec<Vector2<f64>>,
    /// The vertex of the lattice that each is.
    sources: Vec<usize>,
    triangles: Vec<[u32; 3]>,
}

impl Charts {
    /// Adds the triangles, those behind the face in a chart of their own.
    fn cut(&mut self, lattice: &Lattice, back: &[Vector2<f64>]) {
        let mut behind = BTreeMap::new();
        for (index, triangle) in lattice.triangles.iter().enumerate() {
            let corner = |id: usize| {
                if index < lattice.first_behind {
                    return id as u32;
                }
                if lattice.sites[id].part == Part::Back {
                    self.uvs[id] = back[id];
                    return id as u32;
                }
                *behind.entry(id).or_insert_with(|| {
                    self.positions.push(self.positions[id]);
                    self.uvs.push(back[id]);
                    self.sources.push(id);
                    (self.positions.len() - 1) as u32
                })
            };
            let triangle = triangle.map(corner);
            self.triangles.push(triangle);
        }
    }

    fn add_eyeballs(&mut self) {
        for eye in eyeballs::eyeballs() {
            let first = self.positions.len() as u32;
            self.positions.extend(eye.positions);
            self.uvs.extend(eye.uvs);
            let triangles = eye.triangles.iter();
            self.triangles
                .extend(triangles.map(|t| t.map(|id| first + id)));
        }
    }

    /// A shape's displacements, from those of the lattice; eyeballs stay.
    fn deltas(&self, ways: &[Point]) -> Vec<Point> {
        let mut deltas: Vec<Point> = self.sources.iter().map(|id| ways[*id]).collect();
        deltas.resize(self.positions.len(), Point::zeros());
        deltas
    }
}
