//! `ruga bake`: wrinkle maps, the artist's mesh, manifest, preview and report.

use rayon::ThreadPool;
use ruga_io::{MovedMesh, WrinkleMap, Wrinkles, WrittenGlb};
use ruga_scene::{Scene, counted};
use ruga_stepper::{Frame, KeyResult, PoseResult, PoseSpec};

use crate::arguments::{BakeArguments, RunArguments};
use crate::artist_file::{file_name, refuse_own_folder, write_artist_mesh};
use crate::baked_poses::baked_poses;
use crate::error::CliError;
use crate::folder_results::FolderResults;
use crate::map_files::KeyMaps;
use crate::memory_limit::refuse_too_little;
use crate::moved_mesh::{moved_file, moved_meshes, write_moved_mesh};
use crate::outcome::Outcome;
use crate::output_folder::OutputFolder;
use crate::pack_files::{remove_packed, write_packed};
use crate::pose_inputs::ScenePose;
use crate::pose_record::{PoseRecord, Records};
use crate::pose_runs::{PoseFiles, Product, run_poses, thread_count, thread_pool};
use crate::summary::{self, ALL_IN_REPORT};
use crate::tile_numbers::tile_numbers;
use crate::{interrupt, messages, preview_page};

/// Simulates and bakes the poses of a scene.
///
/// # Errors
/// Whatever keeps a pose from being planned, simulated, baked or written.
pub(crate) fn run(bake: &BakeArguments) -> Result<Outcome, CliError> {
    let arguments = &bake.run;
    let pool = thread_pool(thread_count(arguments))?;
    let options = arguments.scene_options();
    let mut scene = pool.install(|| Scene::read_with(&arguments.scene, &options))?;
    let plan = pool.install(|| scene.plan())?;
    let records = Records::of_bake(&arguments.output);
    if !bake.merge {
        let earlier = arguments.resume.then_some(&records);
        refuse_too_little(arguments.memory.as_ref(), &scene, &plan, earlier)?;
    }
    // Until here nothing is written and Ctrl-C may end the process.
    interrupt::listen();
    if !bake.maps_only {
        refuse_own_folder(&arguments.output, &scene.mesh, arguments.force)?;
    }
    let folder = match bake.task {
        true => OutputFolder::open_for_task(&scene, arguments)?,
        false => OutputFolder::open(&scene, arguments, "bake")?,
    };
    let warnings = scene.warnings.iter().chain(plan.warnings());
    messages::warnings(warnings, ALL_IN_REPORT);
    if scene.is_tiled() {
        let tiles = counted(scene.tiles.len(), "UDIM tile");
        messages::note(&format!(
            "the mesh lies in {tiles} ({}), and every map is a file for each; `tiles` under [driver] can say \
             otherwise",
            tile_numbers(&scene.tiles)
        ));
    }
    let maps = WrinkleMaps {
        scene: &scene,
        arguments,
        maps_only: bake.maps_only,
        pool: &pool,
        records,
    };
    if bake.task {
        let poses = run_poses(&scene, &plan, arguments, &folder, &maps)?;
        return Ok(summary::conclude_task(&scene, &plan, &poses));
    }
    let poses = match bake.merge {
        true => Ok(baked_poses(&scene, &folder, &maps.records)?),
        false => run_poses(&scene, &plan, arguments, &folder, &maps),
    };
    let results = FolderResults::read(&maps.records, &folder.poses);
    let poses = summary::unless_nothing_is_there(poses, arguments, &results)?;
    let about_mesh = match maps.write_common(&folder, &results.current) {
        Ok(about_mesh) => about_mesh,
        Err(error) => return Err(summary::first_error(poses, error)),
    };
    messages::warnings(about_mesh.iter(), ALL_IN_REPORT);
    scene.warnings.extend(about_mesh);
    if bake.maps_only {
        preview_page::remove(&arguments.output);
    } else {
        let about_preview = pool.install(|| preview_page::renew(&arguments.output));
        messages::warnings(about_preview.iter(), ALL_IN_REPORT);
        scene.warnings.extend(about_preview);
    }
    let packed = remove_packed(&arguments.output).map_err(CliError::from);
    let packed = packed.and_then(|()| match &scene.file.pack {
        Some(pack) if poses.is_ok() && !interrupt::asked() => {
            let poses = (results.current.as_slice(), folder.poses.as_slice());
            pool.install(|| write_packed(&arguments.output, &scene, pack, poses))
        }
        _ => Ok(()),
    });
    let poses = match packed {
        Ok(()) => poses,
        Err(error) => Err(summary::first_error(poses, error)),
    };
    summary::conclude(&scene, &plan, arguments, poses, &results)
}

struct WrinkleMaps<'a> {
    scene: &'a Scene,
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
            let file = moved_file(&pose.name, key.load);
            if write_moved_mesh(self.scene, &self.arguments.output.join(&file), pose, key)? {
                made.files.push(file);
            }
        }
        made.files
            .extend(made.maps.iter().flat_map(WrinkleMap::files));
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
        let maps = self.pool.install(|| self.scene.bake_key(pose, key))?;
        let folded: usize = maps.iter().map(|map| map.folded_samples).sum();
        if folded > 0 {
            warnings.push(format!(
                "at key {} the layer folds over itself in {} texels; a normal map cannot show that and is \
                 as steep there as it can be: give the pose a smaller weight if it looks wrong",
                key.load, folded
            ));
        }
        let baked = KeyMaps {
            folder: &self.arguments.output,
            scene: self.scene,
            pose: &pose.name,
            key: key.load,
            maps,
        };
        baked.write()
    }

    /// Writes what all poses in the folder share, the mesh and the manifest; returns what the user
    /// should know about the mesh.
    fn write_common(
        &self,
        folder: &OutputFolder,
        poses: &[PoseRecord],
    ) -> Result<Vec<String>, CliError> {
        let scene = self.scene;
        let maps = poses.iter().flat_map(|pose| pose.maps.iter().cloned());
        let maps: Vec<WrinkleMap> = maps.collect();
        let mut warnings = Vec::new();
        let bake = &scene.file.bake;
        let mut manifest = Wrinkles::new(&scene.mesh.mesh.name, bake.frame, bake.size);
        if !self.maps_only {
            let output = (self.arguments.output.as_path(), folder);
            let (moved, about_files) = moved_meshes(scene, output, poses);
            let written = self.write_mesh(&maps, &moved)?;
            manifest.glb = Some(written.reference);
            warnings = about_files;
            warnings.extend(written.warnings);
        }
        let is_there = |pose: &&ScenePose| poses.iter().any(|p| p.report.name == pose.name);
        for pose in folder.poses.iter().filter(is_there) {
            let weights = pose.weights.clone();
            manifest.poses.insert(pose.name.clone(), weights);
            if !pose.growths.is_empty() {
                let growths = pose.growths.clone();
                manifest.growths.insert(pose.name.clone(), growths);
            }
        }
        manifest.maps = maps;
        manifest.write(&self.arguments.output.join("wrinkles.json"))?;
        Ok(warnings)
    }

    fn write_mesh(&self, maps: &[WrinkleMap], moved: &[MovedMesh]) -> Result<WrittenGlb, CliError> {
        let mesh = &self.scene.mesh;
        let rest = self.scene.rest_frames()?;
        let path = self
            .arguments
            .output
            .join(format!("{}.glb", file_name(mesh)));
        write_artist_mesh(&path, mesh, &rest, (maps, moved))
    }
}
