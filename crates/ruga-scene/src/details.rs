//! Details of a key's map that belong to the artist's mesh or to a fire.

use nalgebra::{Vector2, Vector3};
use ruga_bake::{BakeError, BurntFields, Detail, TangentFrame, WrinkleMap};
use ruga_blend::face_strains;
use ruga_material::local_wrinkling;
use ruga_mesh::{Id, face_areas};
use ruga_stepper::{KeyResult, LayerSpec, PoseSpec};

use crate::{Scene, texture_space};

impl Scene {
    /// The quantities beside normals and heights that the scene asks for.
    pub(crate) fn details(&self) -> Vec<Detail> {
        let kinds = self.file.bake.maps.iter();
        kinds.filter_map(|kind| kind.detail()).collect()
    }

    /// Adds the details of the posed mesh to the maps of all layers; `posed` are its welded vertices (m) at a
    /// load of a pose.
    pub(crate) fn add_mesh_details(
        &self,
        maps: &mut [WrinkleMap],
        frames: &[[TangentFrame; 3]],
        posed: &[Vector3<f64>],
        (pose, load): (&PoseSpec, f64),
    ) -> Result<(), BakeError> {
        let details = self.details();
        let uvs = texture_space::corners(&self.mesh).unwrap_or_default();
        if details.contains(&Detail::ObjectNormal) {
            for map in maps.iter_mut() {
                map.paint_object_normals(&uvs, frames)?;
            }
        }
        if details.contains(&Detail::Compression) {
            let ratios = self.compression(posed, (pose, load));
            for map in maps {
                map.paint_compression(&uvs, &ratios)?;
            }
        }
        Ok(())
    }

    /// Adds the details of a fire to the maps of a key; nothing where the sheet does not burn.
    pub(crate) fn add_fire_details(
        &self,
        maps: &mut [WrinkleMap],
        key: &KeyResult,
    ) -> Result<(), BakeError> {
        let mut layers = key.layers.iter();
        let Some(burnt) = layers.find_map(|layer| layer.burnt.as_ref()) else {
            return Ok(());
        };
        let fields = BurntFields {
            faces: &burnt.faces,
            uvs: &burnt.uvs,
            temperature: &burnt.temperature,
            fuel: &burnt.fuel,
            level: &burnt.level,
            char_thickness: burnt.char_thickness,
        };
        let details = self.details();
        let supersample = self.file.bake.supersample;
        let mut maps = maps.iter_mut();
        maps.try_for_each(|map| map.paint_burnt(&fields, &details, supersample))
    }

    /// Compression over the critical one at the corners of the file's triangles.
    ///
    /// A triangle has the largest ratio of all layers that lie on it, by its principal strains, what
    /// it has grown there and what is painted at its middle; a corner the mean of the triangles around its place in space,
    /// by area, so that the mask is continuous across UV seams.
    fn compression(&self, posed: &[Vector3<f64>], (pose, load): (&PoseSpec, f64)) -> Vec<[f64; 3]> {
        let driver = &self.driver;
        let strains = face_strains(driver.topology(), driver.rest(), posed);
        let areas = face_areas(driver.topology(), driver.rest());
        let mut sums = vec![[0.0; 2]; driver.rest().len()];
        for (face, corners) in driver.topology().faces().iter() {
            let uvs = &driver.uvs()[face];
            let middle = (uvs[0] + uvs[1] + uvs[2]) / 3.0;
            let ratios = self.layers.iter().map(|layer| {
                let critical = critical_strain(layer, &middle);
                let strain = layer.felt(pose, load, (driver, face), &strains[face]);
                let effective = strain.effective(layer.material.poisson);
                // What fades the layer fades the mask.
                critical.map_or(0.0, |critical| {
                    effective.max(0.0) / critical * layer.presence.grey(middle)
                })
            });
            let ratio = ratios.fold(0.0, f64::max);
            for vertex in corners {
                let [sum, weight] = &mut sums[vertex.index()];
                *sum += areas[face] * ratio;
                *weight += areas[face];
            }
        }
        let ratio = |vertex: u32| {
            let [sum, weight] = sums[driver.welded()[vertex as usize].index()];
            if weight > 0.0 { sum / weight } else { 0.0 }
        };
        let triangles = self.mesh.mesh.triangles.iter();
        triangles.map(|corners| corners.map(ratio)).collect()
    }
}

/// Critical strain of a layer at a texture coordinate; `None` where none wrinkles, which planning has
/// refused.
fn critical_strain(layer: &LayerSpec, uv: &Vector2<f64>) -> Option<f64> {
    let relative = layer.map.as_ref().map(|map| map.sample(uv));
    let relative = relative.unwrap_or_default();
    let local = local_wrinkling(&layer.material, &layer.substrate, layer.model, &relative);
    local.ok().map(|wrinkling| wrinkling.critical_strain)
}
