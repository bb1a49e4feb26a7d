//! Where the artist's mesh stands in the world.

use std::path::Path;

use nalgebra::{Matrix3, Vector3};
use ruga_io::{FrameMesh, IoError, MeshFile, write_obj_frame};

/// Way from the axes of the file, in which everything is computed, to those of the world: a turn,
/// or a reflection, and a shift.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// A rotation or a reflection.
    pub turn: Matrix3<f64>,
    /// Place of the file's origin in the world (m).
    pub shift: Vector3<f64>,
}

impl Placement {
    /// `world_from_node = turn * stretch`, and the mesh has been stretched already.
    pub fn of(mesh: &MeshFile) -> Self {
        let world = &mesh.world_from_node;
        let linear = world.fixed_view::<3, 3>(0, 0).into_owned();
        Self {
            turn: mesh.stretch.try_inverse().map_or(linear, |s| linear * s),
            shift: world.fixed_view::<3, 1>(0, 3).into_owned(),
        }
    }

    /// A place in the file, in the world.
    pub fn in_world(&self, position: &Vector3<f64>) -> Vector3<f64> {
        self.turn * position + self.shift
    }

    /// Triangles that have the same side out in the world as in the file.
    pub fn outward(&self, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let is_mirrored = self.turn.determinant() < 0.0;
        let order = |&[a, b, c]: &[u32; 3]| if is_mirrored { [a, c, b] } else { [a, b, c] };
        triangles.iter().map(order).collect()
    }

    /// Writes what is in the axes of the file where it is in the world, the same side out.
    ///
    /// # Errors
    /// Those of [`write_obj_frame`].
    pub fn write_obj(&self, path: &Path, frame: &FrameMesh<'_>) -> Result<(), IoError> {
        let positions = frame.positions.iter().map(|p| self.in_world(p));
        let in_world = FrameMesh {
            positions: &positions.collect::<Vec<_>>(),
            triangles: &self.outward(frame.triangles),
            uv_triangles: &self.outward(frame.uv_triangles),
            ..*frame
        };
        write_obj_frame(path, &in_world)
    }

    /// A place in the world, in the axes of the file.
    pub fn place_in_file(&self, position: [f64; 3]) -> Vector3<f64> {
        self.turn.transpose() * (Vector3::from(position) - self.shift)
    }

    /// A way, a force or an acceleration.
    pub fn way_in_file(&self, way: [f64; 3]) -> Vector3<f64> {
        self.turn.transpose() * Vector3::from(way)
    }

    /// Axis times angle: a reflection turns the other way.
    pub fn turn_in_file(&self, turn: [f64; 3]) -> Vector3<f64> {
        self.turn.determinant().signum() * self.way_in_file(turn)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Rotation3;

    use super::*;

    #[test]
    fn what_moves_in_the_world_moves_in_the_file() {
        let turned = Rotation3::from_scaled_axis(Vector3::new(0.3, -0.5, 1.1)).into_inner();
        let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0));
        for turn in [turned, turned * mirror] {
            let shift = Vector3::new(1.0, -2.0, 3.0);
            let placement = Placement { turn, shift };
            let (about, by, way) = ([0.1, 0.2, 0.3], [0.4, 0.5, -0.6], [2.0, 1.0, 0.5]);
            let moved = |place: Vector3<f64>, about: Vector3<f64>, by, way: Vector3<f64>| {
                Rotation3::from_scaled_axis(by) * (place - about) + about + way
            };
            let place = Vector3::new(-0.7, 0.8, 0.9);
            let in_file = moved(
                place,
                placement.place_in_file(about),
                placement.turn_in_file(by),
                placement.way_in_file(way),
            );
            let in_world = moved(
                placement.in_world(&place),
                about.into(),
                by.into(),
                way.into(),
            );
            assert!((placement.in_world(&in_file) - in_world).norm() < 1e-14);
        }
    }
}
