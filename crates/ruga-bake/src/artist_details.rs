//! Details that belong to the artist's mesh: object-space normals and compression.

use nalgebra::{Vector2, Vector3};
use rayon::prelude::*;

use crate::detail_bake::blend;
use crate::error::{all_finite, same_length};
use crate::field_raster::Raster;
use crate::{BakeError, Detail, TangentFrame, WrinkleMap};

impl WrinkleMap {
    /// Adds the map of object-space normals: those that a shader makes of this normal map on the
    /// artist's posed mesh, `x T + y B + z N` with the interpolated, not normalised frame.
    ///
    /// Without wrinkles a texel has the mesh's own normal. `uvs` and `frames` are of every triangle of the
    /// mesh; the axes are those of the frames. Before padding.
    ///
    /// # Errors
    /// [`BakeError::LengthMismatch`], [`BakeError::NotFinite`].
    pub fn paint_object_normals(
        &mut self,
        uvs: &[[Vector2<f64>; 3]],
        frames: &[[TangentFrame; 3]],
    ) -> Result<(), BakeError> {
        same_length("frames", frames.len(), uvs.len())?;
        let mut texels = self.on_artist_mesh(uvs, |face, l| {
            let frame = &frames[face];
            let normal = blend(frame.map(|f| f.normal), l);
            let tangent = blend(frame.map(|f| f.tangent), l);
            let [n, t] = [normal, tangent];
            [n.x, n.y, n.z, t.x, t.y, t.z, frame[0].sign]
        })?;
        let normals = texels.par_drain(..).enumerate().map(|(texel, frame)| {
            let [nx, ny, nz, tx, ty, tz, sign] = frame?;
            let (n, t) = (Vector3::new(nx, ny, nz), Vector3::new(tx, ty, tz));
            let map = self.normal(texel);
            let direction = t * map.x + n.cross(&t) * (sign * map.y) + n * map.z;
            let unit = direction.try_normalize(0.0).unwrap_or_else(Vector3::z);
            Some([unit.x, unit.y, unit.z])
        });
        let normals: Vec<_> = normals.collect();
        self.paint(Detail::ObjectNormal, &normals);
        Ok(())
    }

    /// Adds the map of the compression at every corner of the mesh, over the critical one, linear inside
    /// the triangles and held between 0 and 1. Before padding.
    ///
    /// # Errors
    /// [`BakeError::LengthMismatch`], [`BakeError::NotFinite`].
    pub fn paint_compression(
        &mut self,
        uvs: &[[Vector2<f64>; 3]],
        ratios: &[[f64; 3]],
    ) -> Result<(), BakeError> {
        same_length("ratios", ratios.len(), uvs.len())?;
        all_finite("ratios", ratios, |corners| {
            corners.iter().all(|ratio| ratio.is_finite())
        })?;
        let texels = self.on_artist_mesh(uvs, |face, l| {
            let ratio: f64 = ratios[face].iter().zip(l).map(|(ratio, l)| ratio * l).sum();
            [ratio.clamp(0.0, 1.0)]
        })?;
        self.paint(Detail::Compression, &texels);
        Ok(())
    }

    /// Values at the texels' centres. One sample is enough: what lies between vertices is linear.
    fn on_artist_mesh<const N: usize>(
        &self,
        uvs: &[[Vector2<f64>; 3]],
        shade: impl Fn(usize, [f64; 3]) -> [f64; N] + Sync,
    ) -> Result<Vec<Option<[f64; N]>>, BakeError> {
        all_finite("uvs", uvs, |corners| {
            corners.iter().flatten().all(|c| c.is_finite())
        })?;
        let raster = Raster {
            size: self.size,
            supersample: 1,
            square: self.square,
        };
        Ok(raster.fill(uvs, shade))
    }
}
