//! A posed head, seen by an eye far away.

use nalgebra::{Matrix3, Rotation3, Vector2, Vector3};
use ruga_blend::{BaseSurface, PosedSurface};
use ruga_mesh::Id;
use ruga_validation::canvas::Canvas;
use ruga_validation::light::{Light, lit};

use super::colour::colour;
use super::normal_map::{NormalMap, blended};

/// How the head is turned, rad: to its left, and forward.
#[derive(Clone, Copy)]
pub(super) struct View {
    pub(super) turn: f64,
    pub(super) nod: f64,
}

/// The lamp, at the upper left: low enough that it grazes cheeks and forehead.
const LAMP: Vector3<f64> = Vector3::new(-0.62, 0.62, 0.55);
const SKY: f64 = 1.7;

/// Of the inside of the mouth.
const DARK: Light = Light::new(0.05, 0.012, 0.01);

/// A head and where it stands in the picture (m).
pub(super) struct Head<'a> {
    pub(super) surface: &'a BaseSurface,
    pub(super) rest: &'a [Vector3<f64>],
    pub(super) posed: PosedSurface,
    pub(super) maps: Vec<NormalMap>,
    pub(super) view: View,
    pub(super) at: Vector3<f64>,
}

impl Head<'_> {
    /// Places of all vertices in the picture, x right and y up.
    pub(super) fn places(&self) -> impl Iterator<Item = Vector2<f64>> {
        self.seen().into_iter().map(|p| p.xy())
    }

    pub(super) fn draw(&self, canvas: &mut Canvas) {
        let rotation = self.rotation();
        let seen = self.seen();
        let faces = self.surface.mesh().faces().iter();
        for ((_, vertices), (_, uvs)) in faces.zip(self.surface.uvs().iter()) {
            let ids = vertices.map(|v| v.index());
            let corners = ids.map(|id| seen[id]);
            let normals = ids.map(|id| rotation * self.posed.normals[id]);
            let rest = ids.map(|id| self.rest[id]);
            let away = (corners[1] - corners[0])
                .xy()
                .perp(&(corners[2] - corners[0]).xy())
                < 0.0;
            let right = rightward(corners, *uvs);
            canvas.triangle(corners, |shares| {
                if away {
                    return DARK;
                }
                let uv = mean2(*uvs, shares);
                let normal = mean(normals, shares).normalize();
                let frame = frame(normal, right);
                let normal = frame * blended(&self.maps, uv);
                lit(colour(mean(rest, shares), uv), normal, LAMP, SKY)
            });
        }
    }

    fn seen(&self) -> Vec<Vector3<f64>> {
        let rotation = self.rotation();
        let seen = |p: &Vector3<f64>| rotation * p + self.at;
        self.posed.positions.iter().map(seen).collect()
    }

    fn rotation(&self) -> Rotation3<f64> {
        Rotation3::from_axis_angle(&Vector3::x_axis(), self.view.nod)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), self.view.turn)
    }
}

/// The way in which U grows on a triangle.
fn rightward(corners: [Vector3<f64>; 3], uvs: [Vector2<f64>; 3]) -> Vector3<f64> {
    let [a, b] = [1, 2].map(|i| corners[i] - corners[0]);
    let [u, v] = [1, 2].map(|i| uvs[i] - uvs[0]);
    // V points down, so that unmirrored triangles have a negative determinant.
    (a * v.y - b * u.y) * u.perp(&v).signum()
}

/// Columns: right and up in the texture, and outward, for an unmirrored map.
fn frame(normal: Vector3<f64>, right: Vector3<f64>) -> Matrix3<f64> {
    let right = right - normal * normal.dot(&right);
    let right = right.try_normalize(0.0).unwrap_or_else(Vector3::x);
    Matrix3::from_columns(&[right, normal.cross(&right), normal])
}

fn mean(corners: [Vector3<f64>; 3], shares: [f64; 3]) -> Vector3<f64> {
    corners[0] * shares[0] + corners[1] * shares[1] + corners[2] * shares[2]
}

fn mean2(corners: [Vector2<f64>; 3], shares: [f64; 3]) -> Vector2<f64> {
    corners[0] * shares[0] + corners[1] * shares[1] + corners[2] * shares[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_and_up_are_those_of_the_texture() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]].map(Vector3::from);
        let uvs = [[0.0, 1.0], [0.5, 1.0], [0.0, 0.0]].map(Vector2::from);
        let frame = frame(Vector3::z(), rightward(corners, uvs));
        assert!((frame - Matrix3::identity()).norm() < 1e-12);
    }
}
