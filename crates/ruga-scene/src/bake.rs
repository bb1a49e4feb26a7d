//! The map of one key of a pose, all layers together.

use ruga_bake::{BakeError, BakeSettings, Relief, Seams, TangentFrame, WrinkleMap, bake_detailed};
use ruga_blend::Weights;
use ruga_stepper::{KeyResult, LayerSurface, PoseSpec};

use crate::posed_frames::{moved_frames, posed_frames};
use crate::{Scene, SceneError, texture_space};

impl Scene {
    /// Bakes the map of a `key` of `pose`, with padding.
    ///
    /// It is as large and in the frame that the scene's `[bake]` asks for. Loops run on the threads
    /// of rayon's current pool; their number does not change the map.
    ///
    /// # Errors
    /// [`SceneError::Baking`], for instance where the mesh has no tangents.
    pub fn bake_key(&self, pose: &PoseSpec, key: &KeyResult) -> Result<WrinkleMap, SceneError> {
        let baking = |source| self.baking(&pose.name, source);
        let (artist, driver) = (&self.mesh.mesh, &self.driver);
        let frames = match &key.artist_positions {
            Some(positions) => moved_frames(artist, driver, positions),
            None => posed_frames(artist, driver, &pose.weights.scaled(key.load)),
        };
        let frames = frames.map_err(baking)?;
        let mut map = self.composed(key, &frames).map_err(baking)?;
        let blended = || driver.pose(&pose.weights.scaled(key.load));
        let posed = key.artist_positions.clone().unwrap_or_else(blended);
        self.add_mesh_details(&mut map, &frames, &posed)
            .map_err(baking)?;
        let corners = artist.triangles.iter();
        let welded = |vertex: u32| driver.welded()[vertex as usize].0;
        let corners: Vec<[u32; 3]> = corners.map(|t| t.map(welded)).collect();
        let uvs = texture_space::corners(&self.mesh).unwrap_or_default();
        Seams::new(driver.rest(), &corners, &uvs, &frames)
            .and_then(|seams| map.pad_across(&seams, self.file.bake.padding))
            .map_err(baking)?;
        Ok(map)
    }

    /// Tangent frames of the corners of the mesh file's triangles at rest.
    ///
    /// # Errors
    /// [`SceneError::Baking`] where the mesh has no tangents.
    pub fn rest_frames(&self) -> Result<Vec<[TangentFrame; 3]>, SceneError> {
        posed_frames(&self.mesh.mesh, &self.driver, &Weights::default())
            .map_err(|source| self.baking("rest", source))
    }

    /// The map of all layers at a key, without padding.
    fn composed(
        &self,
        key: &KeyResult,
        frames: &[[TangentFrame; 3]],
    ) -> Result<WrinkleMap, BakeError> {
        let details = self.details();
        let bake =
            |relief: &Relief<'_>| bake_detailed(relief, frames, &self.bake_settings(), &details);
        let mut whole: Option<WrinkleMap> = None;
        for zone in self.file.zones() {
            let is_of_zone = |layer: &&LayerSurface| {
                let mut names = zone.layers.iter().map(|&i| &self.layers[i].name);
                names.any(|name| *name == layer.name)
            };
            let mut layers = key.layers.iter().filter(is_of_zone);
            let Some(lowest) = layers.next() else {
                continue;
            };
            let mut of_zone = bake(&relief(lowest))?;
            // A layer's relief has those of the layers below in it, and covers what it covers.
            for layer in layers {
                of_zone.cover_with(&bake(&relief(layer))?)?;
            }
            whole = Some(match whole {
                // Each zone's relief is faded by its mask already.
                Some(mut map) => {
                    map.add(&of_zone)?;
                    map
                }
                None => of_zone,
            });
        }
        whole.map_or_else(|| bake(&EMPTY), Ok)
    }

    fn bake_settings(&self) -> BakeSettings {
        let bake = &self.file.bake;
        BakeSettings {
            size: bake.size,
            supersample: bake.supersample,
            frame: bake.frame,
        }
    }

    fn baking(&self, pose: &str, source: BakeError) -> SceneError {
        SceneError::Baking {
            mesh: self.mesh.path.clone(),
            pose: pose.to_owned(),
            source,
        }
    }
}

/// Nothing wrinkles: bakes neutral.
const EMPTY: Relief<'static> = Relief {
    positions: &[],
    driver_positions: &[],
    driver_normals: &[],
    offset: 0.0,
    faces: &[],
    uvs: &[],
    artist: &[],
};

fn relief(layer: &LayerSurface) -> Relief<'_> {
    Relief {
        positions: &layer.relief,
        driver_positions: &layer.driver_positions,
        driver_normals: &layer.driver_normals,
        offset: layer.offset,
        faces: &layer.faces,
        uvs: &layer.uvs,
        artist: &layer.artist,
    }
}
