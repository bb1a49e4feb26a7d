//! `ruga bake`: wrinkle maps, the artist's mesh, manifest and report.

use rayon::{ThreadPool, ThreadPoolBuilder};
use ruga_bake::{BakeSettings, Relief, TangentFrame, bake};
use ruga_blend::Weights;
use ruga_io::{WrinkleMap, Wrinkles, key_percent, scene};
use ruga_stepper::{Frame, KeyResult, LayerSurface, PoseResult, PoseSpec};

use crate::arguments::RunArguments;
use crate::artist_file::{file_name, write_artist_mesh};
use crate::error::CliError;
use crate::map_files::write_maps;
use crate::moved_mesh::write_moved_mesh;
use crate::pose_record::PoseRecord;
use crate::pose_runs::{PoseFiles, Product, run_poses, thread_count};
use crate::posed_frames::{moved_frames, posed_frames};
use crate::project::Project;
use crate::run::Outcome;
use crate::{interrupt, messages, output_folder, summary, texture_space};

/// Simulates and bakes the poses of a scene.
///
/// # Errors
/// Whatever keeps a pose from being planned, simulated, baked or written.
pub(crate) fn run(arguments: &RunArguments) -> Result<Outcome, CliError> {
    interrupt::listen();
    let pool = thread_pool(thread_count(arguments))?;
    let project =
        pool.install(|| Project::read(&arguments.scene, &arguments.poses, arguments.quality))?;
    let plan = pool.install(|| project.plan())?;
    output_folder::prepare(&arguments.output)?;
    for warning in project.warnings.iter().chain(plan.warnings()) {
        messages::warning(warning);
    }
    let maps = WrinkleMaps {
        project: &project,
        arguments,
        pool: &pool,
    };
    let records = run_poses(&project, &plan, arguments, &maps)?;
    maps.write_common(&records)?;
    summary::conclude(&project, &plan, arguments, &records)
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
    pool: &'a ThreadPool,
}

impl Product for WrinkleMaps<'_> {
    const COMMAND: &'static str = "bake";
    const WANTS_FRAMES: bool = false;

    /// Maps are written when the pose is done; until then the earlier ones are of use.
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
        let bake = |relief: &Relief<'_>| {
            let baked = self
                .pool
                .install(|| bake(relief, &frames, &self.settings()));
            baked.map_err(|source| self.baking(pose, source))
        };
        // A layer's relief has those of the layers below in it, and covers what it covers.
        let mut map = match key.layers.first() {
            Some(lowest) => bake(&relief(lowest))?,
            None => bake(&EMPTY)?,
        };
        for layer in key.layers.iter().skip(1) {
            let upper = bake(&relief(layer))?;
            map.cover_with(&upper)
                .map_err(|source| self.baking(pose, source))?;
        }
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

    fn baking(&self, pose: &PoseSpec, source: ruga_bake::BakeError) -> CliError {
        CliError::Baking {
            mesh: self.project.mesh.path.clone(),
            pose: pose.name.clone(),
            source,
        }
    }

    /// Writes what all poses share: the mesh and the manifest.
    fn write_common(&self, records: &[Option<PoseRecord>]) -> Result<(), CliError> {
        let project = self.project;
        let finished = || records.iter().flatten();
        let maps: Vec<WrinkleMap> = finished().flat_map(|r| r.maps.iter().cloned()).collect();
        let rest: Vec<[TangentFrame; 3]> =
            posed_frames(&project.mesh.mesh, &project.driver, &Weights::default()).map_err(
                |source| CliError::Baking {
                    mesh: project.mesh.path.clone(),
                    pose: "rest".to_owned(),
                    source,
                },
            )?;
        let name = file_name(&project.mesh);
        let path = self.arguments.output.join(format!("{name}.glb"));
        write_artist_mesh(&path, &project.mesh, &rest, &maps)?;
        let bake = &project.scene.bake;
        let mut manifest = Wrinkles::new(&project.mesh.mesh.name, bake.frame, bake.size);
        let shapes: Vec<&str> = project.driver.shape_names().collect();
        for (pose, _) in project
            .poses
            .iter()
            .zip(records)
            .filter(|(_, r)| r.is_some())
        {
            let weights = pose.weights.0.iter();
            let named = weights.map(|&(shape, weight)| (shapes[shape].to_owned(), weight));
            manifest.poses.insert(pose.name.clone(), named.collect());
        }
        manifest.maps = maps;
        Ok(manifest.write(&self.arguments.output.join("wrinkles.json"))?)
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
        positions: &layer.positions,
        driver_positions: &layer.driver_positions,
        driver_normals: &layer.driver_normals,
        offset: layer.offset,
        faces: &layer.faces,
        uvs: &layer.uvs,
        artist: &layer.artist,
    }
}
