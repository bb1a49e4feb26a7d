//! Light that a relief leaves its own places: the horizon in some directions around each vertex.

use std::f64::consts::TAU;

use nalgebra::{Vector2, Vector3};
use rayon::prelude::*;

use crate::Relief;
use crate::face_adjacency::{NONE, adjacent_faces};
use crate::relief_normals::VertexRelief;
use crate::tangent_frames::any_orthogonal;

/// Directions in which the horizon is looked for. Over parallel grooves 8 are exact to a
/// hundred thousandth.
const DIRECTIONS: usize = 16;

/// Slope of the horizon that is not worth looking further for: it hides `1 / (1 + 20²)`, a quarter of
/// a percent, of the light from that side.
const LEAST_SLOPE: f64 = 0.05;

/// Cosine between driver normals from which on the surface has turned away, and its projection no
/// longer tells distances.
const LEAST_FACING: f64 = 0.3;

/// Triangles that one look passes at most.
const MOST_STEPS: usize = 512;

/// Share of the light of an even sky that reaches every vertex of a layer, 0 to 1.
///
/// The relief is taken as a field of heights over the driver unrolled around the vertex, which stands
/// on a level plane: what hides the sky are wrinkles alone. With `m` the greatest slope up to what is
/// seen along an azimuth, the horizon's zenith angle is `t = atan(1 / m)`, and with `n` the normal of
/// the relief the share of cosine-weighted light is the mean over azimuths of
/// `n_z sin² t + n_a (t - sin t cos t)`, `n_a` being the part of `n` along the azimuth. In the valley of a long
/// groove that is `cos atan m` (Hottel's crossed strings).
///
/// The way along an azimuth goes from triangle to triangle of the layer, across UV seams, and ends
/// where nothing of the layer is high enough to rise above the horizon.
pub(crate) fn open_sky(relief: &Relief, vertices: &[VertexRelief]) -> Vec<f64> {
    let highest = vertices.iter().fold(0.0, |most: f64, v| most.max(v.height));
    let terrain = Terrain {
        relief,
        vertices,
        adjacent: adjacent_faces(relief.faces),
        around: faces_around(relief.positions.len(), relief.faces),
        highest,
    };
    (0..vertices.len())
        .into_par_iter()
        .map(|vertex| terrain.share(vertex))
        .collect()
}

struct Terrain<'a> {
    relief: &'a Relief<'a>,
    vertices: &'a [VertexRelief],
    /// The face across the edge opposite each corner, or [`NONE`].
    adjacent: Vec<[u32; 3]>,
    /// Start of each vertex's faces, and the faces.
    around: (Vec<u32>, Vec<u32>),
    /// Largest height of all vertices, m.
    highest: f64,
}

/// A view from one vertex: its tangent plane and its height.
struct View {
    vertex: usize,
    axes: [Vector3<f64>; 2],
    foot: Vector3<f64>,
}

impl Terrain<'_> {
    fn share(&self, vertex: usize) -> f64 {
        let own = &self.vertices[vertex];
        let up = self.relief.driver_normals[vertex];
        let u = any_orthogonal(&up);
        let view = View {
            vertex,
            axes: [u, up.cross(&u)],
            foot: self.foot(vertex),
        };
        let normal = own.base + own.tilt;
        let rise = normal.dot(&up);
        let mut sum = 0.0;
        for direction in 0..DIRECTIONS {
            let angle = TAU * direction as f64 / DIRECTIONS as f64;
            let along = Vector2::new(angle.cos(), angle.sin());
            let lean = normal.dot(&view.axes[0]) * along.x + normal.dot(&view.axes[1]) * along.y;
            // The plane tangent to the relief hides what lies below it, and the level plane the
            // rest. A relief that hangs over sees only what its own plane leaves.
            let own_plane = -lean / rise.max(1e-3);
            let slope = self.horizon(&view, along, own_plane.max(0.0));
            let zenith = (1.0_f64).atan2(slope);
            sum += rise * zenith.sin().powi(2) + lean * (zenith - zenith.sin() * zenith.cos());
        }
        (sum / DIRECTIONS as f64).clamp(0.0, 1.0)
    }

    fn foot(&self, vertex: usize) -> Vector3<f64> {
        let normal = self.relief.driver_normals[vertex];
        self.relief.positions[vertex] - normal * self.vertices[vertex].height
    }

    /// A vertex in the plane of a view.
    fn place(&self, view: &View, vertex: usize) -> Vector2<f64> {
        let step = self.foot(vertex) - view.foot;
        Vector2::new(step.dot(&view.axes[0]), step.dot(&view.axes[1]))
    }

    fn rise(&self, view: &View, vertex: usize) -> f64 {
        self.vertices[vertex].height - self.vertices[view.vertex].height
    }

    /// Slope up to the horizon along a direction, at least `slope`.
    fn horizon(&self, view: &View, along: Vector2<f64>, mut slope: f64) -> f64 {
        let Some((mut face, mut right, mut left)) = self.first_edge(view, along) else {
            return slope;
        };
        let most = self.highest - self.vertices[view.vertex].height;
        let mut reached = 0.0;
        for _ in 0..MOST_STEPS {
            let [p, q] = [right, left].map(|v| self.place(view, v));
            let (before, behind) = (p.perp(&along), along.perp(&q));
            let part = before / (before + behind);
            let distance = (p + (q - p) * part).dot(&along);
            // Around a vertex on the way the distance stays; one that goes back has reached a fold of
            // the driver.
            if distance.is_nan() || distance < reached * (1.0 - 1e-6) {
                break;
            }
            reached = distance;
            let [low, high] = [right, left].map(|v| self.rise(view, v));
            slope = slope.max((low + (high - low) * part) / distance);
            if most <= distance * slope.max(LEAST_SLOPE) {
                break;
            }
            let Some(next) = self.across(face, right, left) else {
                break;
            };
            face = next;
            let corners = self.relief.faces[face as usize].map(|v| v as usize);
            let Some(apex) = corners.into_iter().find(|&v| v != right && v != left) else {
                break;
            };
            let normals = &self.relief.driver_normals;
            if normals[apex].dot(&normals[view.vertex]) < LEAST_FACING {
                break;
            }
            match along.perp(&self.place(view, apex)) > 0.0 {
                true => left = apex,
                false => right = apex,
            }
        }
        slope
    }

    /// The face around the vertex that a direction leads into, with the corners on its right and on
    /// its left.
    fn first_edge(&self, view: &View, along: Vector2<f64>) -> Option<(u32, usize, usize)> {
        let (starts, faces) = &self.around;
        let range = starts[view.vertex] as usize..starts[view.vertex + 1] as usize;
        faces[range].iter().find_map(|&face| {
            let corners = self.relief.faces[face as usize].map(|v| v as usize);
            let at = corners.iter().position(|&v| v == view.vertex)?;
            let [right, left] = [corners[(at + 1) % 3], corners[(at + 2) % 3]];
            let [p, q] = [right, left].map(|v| self.place(view, v));
            let is_between = p.perp(&along) >= 0.0 && along.perp(&q) > 0.0;
            is_between.then_some((face, right, left))
        })
    }

    /// The face behind the edge between two corners of another.
    fn across(&self, face: u32, right: usize, left: usize) -> Option<u32> {
        let corners = self.relief.faces[face as usize];
        let opposite = corners
            .iter()
            .position(|&v| v as usize != right && v as usize != left)?;
        let next = self.adjacent[face as usize][opposite];
        (next != NONE).then_some(next)
    }
}

/// The faces around every vertex, by start and number.
fn faces_around(vertices: usize, faces: &[[u32; 3]]) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0_u32; vertices + 1];
    for &vertex in faces.iter().flatten() {
        starts[vertex as usize + 1] += 1;
    }
    for vertex in 0..vertices {
        starts[vertex + 1] += starts[vertex];
    }
    let mut next = starts.clone();
    let mut around = vec![0; 3 * faces.len()];
    for (face, corners) in (0..).zip(faces) {
        for &vertex in corners {
            around[next[vertex as usize] as usize] = face;
            next[vertex as usize] += 1;
        }
    }
    (starts, around)
}
