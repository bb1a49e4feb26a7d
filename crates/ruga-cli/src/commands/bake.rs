//! `ruga bake`: wrinkle maps, the artist's mesh, manifest and report.

use rayon::{ThreadPool, ThreadPoolBuilder};
use ruga_bake::{BakeError, BakeSettings, Relief, TangentFrame, bake};
use ruga_blend::Weights;
use ruga_io::{WrinkleMap, Wrinkles, WrittenGlb, key_percent, scene};
use ruga_stepper::{Frame, KeyResult, LayerSurface, PoseResult, PoseSpec};

use crate::arguments::{BakeArguments, RunArguments};
use crate::artist_file::{file_name, refuse_own_folder, write_artist_mesh};
use crate::error::CliError;
use crate::folder_results::FolderResults;
use crate::map_files::write_maps;
use crate::moved_mesh::write_moved_mesh;
use crate::output_folder::OutputFolder;
use crate::pose_inputs::ScenePose;
use crate::pose_record::{PoseRecord, Records};
use crate::pose_runs::{PoseFiles, Product, run_poses, thread_count};
use crate::posed_frames::{moved_frames, posed_frames};
use crate::project::Project;
use crate::run::Outcome;
use crate::summary::{self, ALL_IN_REPORT};
use crate::{interrupt, messages, texture_space};

/// Simulates and bakes the poses of a scene.
///
/// # Errors
/// Whatever keeps a pose from being planned, simulated, baked or written.
pub(crate) fn run(bake: &BakeArguments) -> Result<Outcome, CliError> {
    let arguments = &bake.run;
    let pool = thread_pool(thread_count(arguments))?;
    let mut project =
        pool.install(|| Project::read(&arguments.scene, &arguments.poses, arguments.quality))?;
    let plan = pool.install(|| project.plan())?;
    // Until here nothing is written and Ctrl-C may end the process.
    interrupt::listen();
    if !bake.maps_only {
        refuse_own_folder(&arguments.output, &project.mesh, arguments.force)?;
    }
    let folder = OutputFolder::open(&project, arguments, "bake")?;
    let warnings = project.warnings.iter().chain(plan.warnings());
    messages::warnings(warnings, ALL_IN_REPORT);
    let maps = WrinkleMaps {
        project: &project,
        arguments,
        maps_only: bake.maps_only,
        pool: &pool,
        records: Records::of_bake(&arguments.output),
    };
    let poses = run_poses(&project, &plan, arguments, &folder, &maps);
    let results = FolderResults::read(&maps.records, &folder.poses);
    let poses = summary::unless_nothing_is_there(poses, arguments, &results)?;
    let about_mesh = match maps.write_common(&folder, &results.current) {
        Ok(about_mesh) => about_mesh,
        Err(error) => return Err(summary::first_error(poses, error)),
    };
    messages::warnings(about_mesh.iter(), ALL_IN_REPORT);
    project.warnings.extend(about_mesh);
    summary::conclude(&project, &plan, arguments, poses, &results)
}

/// Rayon's threads for the loops inside a bake; the global pool stays untouched.
fn thread_pool(threads: usize) -> Result<ThreadPool, CliError> {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| CliError::Threads {
            threads,
            reason: error.to_string(),
        })
}

struct WrinkleMaps<'a> {
    project: &'a Project,
    arguments: &'a RunArguments,
    maps_only: bool,
    pool: &'a ThreadPool,
    records: Records,
}

impl Product for WrinkleMaps<'_> {
    const WANTS_FRAMES: bool = false;

    fn records(&self) -> &Records {
        &self.records
    }

    /// Maps are written when the pose is done; until then the earlier ones stay listed.
    fn begin(&self, _: &PoseSpec) {}

    /// Maps are made of whole poses, not of their frames.
    fn frame(&self, _: &PoseSpec, _: &Frame<'_>) -> Result<Vec<String>, CliError> {
        Ok(Vec::new())
    }

    fn pose(&self, pose: &PoseSpec, result: &PoseResult) -> Result<PoseFiles, CliError> {
        let mut made = PoseFiles::default();
        for key in &result.keys {
            made.maps.extend(self.key(pose, key, &mut made.warnings)?);
            let file = format!("bodies/{}_{}.obj", pose.name, key_percent(key.load));
            if write_moved_mesh(self.project, &self.arguments.output.join(&file), pose, key)? {
                made.files.push(file);
            }
        }
        let maps = made.maps.iter().map(|map| map.file.clone());
        made.files.extend(maps);
        Ok(made)
    }
}

impl WrinkleMaps<'_> {
    /// Bakes and writes the maps of one key.
    fn key(
        &self,
        pose: &PoseSpec,
        key: &KeyResult,
        warnings: &mut Vec<String>,
    ) -> Result<Vec<WrinkleMap>, CliError> {
        let project = self.project;
        let (artist, driver) = (&project.mesh.mesh, &project.driver);
        let frames = match &key.artist_positions {
            Some(positions) => moved_frames(artist, driver, positions),
            None => posed_frames(artist, driver, &pose.weights.scaled(key.load)),
        };
        let frames = frames.map_err(|source| self.baking(pose, source))?;
        let baked = self.pool.install(|| self.composed(key, &frames));
        let mut map = baked.map_err(|source| self.baking(pose, source))?;
        let islands = texture_space::corners(&project.mesh).unwrap_or_default();
        map.pad(&islands, project.scene.bake.padding)
            .map_err(|source| self.baking(pose, source))?;
        if map.folded_samples > 0 {
            warnings.push(format!(
                "at key {} the layer folds over in {} texels, which a normal map cannot hold",
                key.load, map.folded_samples
            ));
        }
        let folder = &self.arguments.output;
        write_maps(folder, &project.scene.bake, &pose.name, key.load, &map)
    }

    /// The map of all layers at a key, without padding.
    fn composed(
        &self,
        key: &KeyResult,
        frames: &[[TangentFrame; 3]],
    ) -> Result<ruga_bake::WrinkleMap, BakeError> {
        let project = self.project;
        let bake = |relief: &Relief<'_>| bake(relief, frames, &self.settings());
        let mut whole: Option<ruga_bake::WrinkleMap> = None;
        for zone in project.scene.zones() {
            let is_of_zone = |layer: &&LayerSurface| {
                let mut names = zone.layers.iter().map(|&i| &project.layers[i].name);
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

    fn settings(&self) -> BakeSettings {
        let bake = &self.project.scene.bake;
        BakeSettings {
            size: bake.size,
            supersample: bake.supersample,
            frame: match bake.frame {
                scene::Frame::Driver => ruga_bake::Frame::Driver,
                scene::Frame::Mesh => ruga_bake::Frame::Mesh,
            },
        }
    }

    fn baking(&self, pose: &PoseSpec, source: BakeError) -> CliError {
        CliError::Baking {
            mesh: self.project.mesh.path.clone(),
            pose: pose.name.clone(),
            source,
        }
    }

    /// Writes what all poses in the folder share, the mesh and the manifest; returns what the user
    /// should know about the mesh.
    fn write_common(
        &self,
        folder: &OutputFolder,
        poses: &[PoseRecord],
    ) -> Result<Vec<String>, CliError> {
        let project = self.project;
        let maps = poses.iter().flat_map(|pose| pose.maps.iter().cloned());
        let maps: Vec<WrinkleMap> = maps.collect();
        let mut warnings = Vec::new();
        let bake = &project.scene.bake;
        let mut manifest = Wrinkles::new(&project.mesh.mesh.name, bake.frame, bake.size);
        if !self.maps_only {
            let written = self.write_mesh(&maps)?;
            manifest.glb = Some(written.reference);
            warnings = written.warnings;
        }
        let is_there = |pose: &&ScenePose| poses.iter().any(|p| p.report.name == pose.name);
        for pose in folder.poses.iter().filter(is_there) {
            let weights = pose.weights.clone();
            manifest.poses.insert(pose.name.clone(), weights);
        }
        manifest.maps = maps;
        manifest.write(&self.arguments.output.join("wrinkles.json"))?;
        Ok(warnings)
    }

    fn write_mesh(&self, maps: &[WrinkleMap]) -> Result<WrittenGlb, CliError> {
        let mesh = &self.project.mesh;
        let rest = posed_frames(&mesh.mesh, &self.project.driver, &Weights::default());
        let rest: Vec<[TangentFrame; 3]> = rest.map_err(|source| CliError::Baking {
            mesh: mesh.path.clone(),
            pose: "rest".to_owned(),
            source,
        })?;
        let path = self
            .arguments
            .output
            .join(format!("{}.glb", file_name(mesh)));
        write_artist_mesh(&path, mesh, &rest, maps)
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
