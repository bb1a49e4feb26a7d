//! Normal maps of a bake, read between texels and laid over each other.

use std::error::Error;
use std::path::Path;

use nalgebra::{Vector2, Vector3};
use ruga_io::{Image, MapFormat, MapKind, map_file, read_image};

/// The normal map of a pose at its last key.
pub(super) struct NormalMap(Image);

impl NormalMap {
    pub(super) fn read(bake: &Path, pose: &str) -> Result<Self, Box<dyn Error>> {
        let path = bake.join(map_file(pose, 1.0, MapKind::Normal, MapFormat::Png16));
        let map = read_image(&path)?;
        if map.channels != 3 {
            return Err(format!("{}: a grey image, not a normal map", path.display()).into());
        }
        Ok(Self(map))
    }

    /// The normal (x right, y up, z outward) at a texture coordinate: the mean of four texels.
    fn at(&self, uv: Vector2<f64>) -> Vector3<f64> {
        let map = &self.0;
        let place = |coordinate: f64, texels: usize| {
            let at = (coordinate * texels as f64 - 0.5).clamp(0.0, (texels - 1) as f64);
            (at as usize, at.fract())
        };
        let ((column, right), (row, down)) = (place(uv.x, map.width), place(uv.y, map.height));
        let texel = |row: usize, column: usize| {
            let [row, column] = [row.min(map.height - 1), column.min(map.width - 1)];
            let start = 3 * (row * map.width + column);
            Vector3::from([0, 1, 2].map(|c| 2.0 * f64::from(map.values[start + c]) - 1.0))
        };
        let line = |row| texel(row, column) * (1.0 - right) + texel(row, column + 1) * right;
        (line(row) * (1.0 - down) + line(row + 1) * down).normalize()
    }
}

/// Normals of several maps laid over each other: reoriented normal mapping (Barré-Brisebois and Hill
/// 2012, *Blending in detail*).
pub(super) fn blended(maps: &[NormalMap], uv: Vector2<f64>) -> Vector3<f64> {
    maps.iter().fold(Vector3::z(), |below, map| {
        let above = map.at(uv);
        let t = below + Vector3::z();
        let u = Vector3::new(-above.x, -above.y, above.z);
        (t * (t.dot(&u) / t.z) - u).normalize()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(normals: &[[f32; 3]]) -> NormalMap {
        NormalMap(Image {
            width: normals.len(),
            height: 1,
            channels: 3,
            values: normals.concat(),
        })
    }

    #[test]
    fn a_neutral_map_changes_nothing() {
        let neutral = [0.5, 0.5, 1.0];
        let tilted = [0.8, 0.5, 0.9];
        let alone = blended(&[map(&[tilted])], Vector2::repeat(0.5));
        let both = blended(&[map(&[neutral]), map(&[tilted])], Vector2::repeat(0.5));
        assert!((alone - both).norm() < 1e-9);
        assert!(alone.x > 0.5 && alone.y.abs() < 1e-9);
    }

    #[test]
    fn between_texels_is_their_mean() {
        let map = map(&[[1.0, 0.5, 0.5], [0.0, 0.5, 1.0], [0.5, 0.5, 1.0]]);
        assert!((map.at(Vector2::new(1.0, 0.5)) - Vector3::z()).norm() < 1e-6);
        let middle = map.at(Vector2::new(1.0 / 3.0, 0.5));
        assert!((middle - Vector3::z()).norm() < 1e-6, "{middle}");
    }
}
