//! The maps of one key of a pose, all layers together.

use std::collections::BTreeSet;

use nalgebra::Vector3;
use ruga_bake::{BakeError, BakeSettings, Relief, Seams, TangentFrame, WrinkleMap, bake_squares};
use ruga_blend::Weights;
use ruga_io::MapKind;
use ruga_material::UvTile;
use ruga_mesh::Id;
use ruga_stepper::{KeyResult, LayerSurface, PoseSpec};

use crate::posed_frames::{computed_normals, moved_frames, posed_frames};
use crate::{Scene, SceneError, texture_space};

impl Scene {
    /// Bakes the maps of a `key` of `pose`, with padding: one, or of a mesh with UDIM tiles one for each tile
    /// in which something was baked, and at least one. Those of the other tiles are neutral.
    ///
    /// [`WrinkleMap::square`] is the tile. Maps are as large and in the frame that the scene's `[bake]` asks
    /// for. Loops run on the threads of rayon's current pool; their number does not change the maps.
    ///
    /// # Errors
    /// [`SceneError::Baking`], for instance where the mesh has no tangents.
    pub fn bake_key(
        &self,
        pose: &PoseSpec,
        key: &KeyResult,
    ) -> Result<Vec<WrinkleMap>, SceneError> {
        let baking = |source| self.baking(&pose.name, source);
        let (artist, driver) = (&self.mesh.mesh, &self.driver);
        let frames = match &key.artist_positions {
            Some(positions) => moved_frames(artist, driver, positions),
            None => posed_frames(artist, driver, &pose.weights.scaled(key.load)),
        };
        let frames = frames.map_err(baking)?;
        let mut maps = self.composed(key, &frames).map_err(baking)?;
        let blended = || driver.pose(&pose.weights.scaled(key.load));
        let posed = key.artist_positions.clone().unwrap_or_else(blended);
        self.add_mesh_details(&mut maps, &frames, &posed, (pose, key.load))
            .map_err(baking)?;
        self.add_fire_details(&mut maps, key).map_err(baking)?;
        let corners = artist.triangles.iter();
        let welded = |vertex: u32| driver.welded()[vertex as usize].0;
        let corners: Vec<[u32; 3]> = corners.map(|t| t.map(welded)).collect();
        let uvs = texture_space::corners(&self.mesh).unwrap_or_default();
        Seams::new(driver.rest(), &corners, &uvs, &frames)
            .and_then(|seams| WrinkleMap::pad_across(&mut maps, &seams, self.file.bake.padding))
            .map_err(baking)?;
        Ok(maps)
    }

    /// Tangent frames of the corners of the mesh file's triangles at rest.
    ///
    /// # Errors
    /// [`SceneError::Baking`] where the mesh has no tangents.
    pub fn rest_frames(&self) -> Result<Vec<[TangentFrame; 3]>, SceneError> {
        posed_frames(&self.mesh.mesh, &self.driver, &Weights::default())
            .map_err(|source| self.baking("rest", source))
    }

    /// Unit normals of the file's vertices where a body or a sheet has taken these (m): smooth but where the file's rest
    /// normals are not.
    ///
    /// # Panics
    /// When there is not one position per vertex of the file.
    pub fn moved_normals(&self, positions: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        computed_normals(&self.mesh.mesh, &self.driver, positions)
    }

    /// Tiles in which something is baked where these triangles of the file are simulated, ascending and at
    /// least one: theirs, and those beyond a seam, whose padding goes on with them. All tiles where maps of the
    /// whole mesh are asked for.
    pub(crate) fn baked_tiles(&self, simulated: &[u32]) -> Vec<UvTile> {
        let is_of_mesh = |kind: &MapKind| !kind.is_packed();
        if !self.is_tiled() || self.file.bake.maps.iter().any(is_of_mesh) {
            return self.tiles.clone();
        }
        let triangles = &self.mesh.mesh.triangles;
        let point = |vertex: u32| self.driver.welded()[vertex as usize].index();
        let mut is_touched = vec![false; self.driver.rest().len()];
        for vertex in simulated.iter().flat_map(|&t| triangles[t as usize]) {
            is_touched[point(vertex)] = true;
        }
        let uvs = texture_space::corners(&self.mesh).unwrap_or_default();
        let touched = triangles.iter().zip(&uvs);
        let touched = touched.filter(|(corners, _)| corners.iter().any(|&v| is_touched[point(v)]));
        let found: BTreeSet<UvTile> = touched
            .filter_map(|(_, uvs)| UvTile::of_triangle(uvs))
            .collect();
        match found.is_empty() {
            true => self.tiles[..1].to_vec(),
            false => found.into_iter().collect(),
        }
    }

    /// The maps of all layers at a key, without padding.
    fn composed(
        &self,
        key: &KeyResult,
        frames: &[[TangentFrame; 3]],
    ) -> Result<Vec<WrinkleMap>, BakeError> {
        let details = self.details();
        let settings = self.bake_settings();
        let layers = key.layers.iter();
        let simulated = layers.flat_map(|layer| layer.artist.iter().map(|(triangle, _)| *triangle));
        let tiles = self.baked_tiles(&simulated.collect::<Vec<_>>());
        let squares: Vec<[i32; 2]> = tiles.into_iter().map(UvTile::origin).collect();
        let bake =
            |relief: &Relief<'_>| bake_squares(relief, frames, &settings, &details, &squares);
        let mut whole: Option<Vec<WrinkleMap>> = None;
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
                for (map, upper) in of_zone.iter_mut().zip(bake(&relief(layer))?) {
                    map.cover_with(&upper)?;
                }
            }
            whole = Some(match whole {
                // Each zone's relief is faded by its mask already.
                Some(mut maps) => {
                    for (map, of_zone) in maps.iter_mut().zip(&of_zone) {
                        map.add(of_zone)?;
                    }
                    maps
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
