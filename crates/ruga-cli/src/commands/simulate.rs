//! `ruga simulate`: the layers' meshes in every load step, and the report.

use std::collections::BTreeMap;
use std::fs;
use std::sync::{Mutex, MutexGuard, PoisonError};

use nalgebra::Vector3;
use ruga_io::{FrameMesh, MovedMesh, WrittenGlb, key_percent};
use ruga_scene::{Placement, Scene};
use ruga_stepper::{Frame, PoseResult, PoseSpec};

use crate::arguments::{RunArguments, SimulateArguments};
use crate::artist_file::{file_name, write_artist_mesh};
use crate::error::CliError;
use crate::folder_results::FolderResults;
use crate::frame_files::{FrameFiles, FrameFormat};
use crate::memory_limit::refuse_too_little;
use crate::moved_mesh::write_moved_mesh;
use crate::outcome::Outcome;
use crate::output_folder::OutputFolder;
use crate::pose_record::{PoseRecord, Records, remove_frames};
use crate::pose_runs::{PoseFiles, Product, run_poses, thread_count, thread_pool};
use crate::summary::{self, ALL_IN_REPORT};
use crate::{interrupt, messages};

/// Simulates the poses of a scene and writes their meshes.
///
/// # Errors
/// Whatever keeps a pose from being planned, simulated or written.
pub(crate) fn run(arguments: &SimulateArguments) -> Result<Outcome, CliError> {
    let (arguments, formats) = (&arguments.run, arguments.formats.as_slice());
    let pool = thread_pool(thread_count(arguments))?;
    let options = arguments.scene_options();
    let mut scene = pool.install(|| Scene::read_with(&arguments.scene, &options))?;
    if formats.contains(&FrameFormat::Glb) && scene.sheet.is_none() {
        let scene = scene.path.clone();
        return Err(CliError::NoSheet { scene });
    }
    // Frames are of every pose as it is: the meshes that they were computed on have no mirror image.
    scene.mirror = None;
    let plan = pool.install(|| scene.plan())?;
    drop(pool);
    let records = Records::of_simulate(&arguments.output);
    let earlier = arguments.resume.then_some(&records);
    refuse_too_little(arguments.memory.as_ref(), &scene, &plan, earlier)?;
    // Until here nothing is written and Ctrl-C may end the process.
    interrupt::listen();
    let folder = OutputFolder::open(&scene, arguments, "simulate")?;
    let warnings = scene.warnings.iter().chain(plan.warnings());
    messages::warnings(warnings, ALL_IN_REPORT);
    let placement = Placement::of(&scene.mesh);
    let files = |pose: &PoseSpec| {
        let files = FrameFiles::new(&arguments.output, &pose.name, placement, formats);
        (pose.name.clone(), Mutex::new(files))
    };
    let meshes = FrameMeshes {
        arguments,
        scene: &scene,
        folder: &folder,
        formats,
        placement,
        records,
        frames: scene.poses.iter().map(files).collect(),
    };
    let poses = run_poses(&scene, &plan, arguments, &folder, &meshes);
    let results = FolderResults::read(&meshes.records, &folder.poses);
    let poses = summary::unless_nothing_is_there(poses, arguments, &results)?;
    summary::conclude(&scene, &plan, arguments, poses, &results)
}

struct FrameMeshes<'a> {
    arguments: &'a RunArguments,
    scene: &'a Scene,
    folder: &'a OutputFolder,
    formats: &'a [FrameFormat],
    placement: Placement,
    records: Records,
    /// Files of the load steps of every pose.
    frames: BTreeMap<String, Mutex<FrameFiles<'a>>>,
}

impl Product for FrameMeshes<'_> {
    const WANTS_FRAMES: bool = true;

    fn records(&self) -> &Records {
        &self.records
    }

    fn wants_face_states(&self) -> bool {
        self.formats.iter().any(|format| format.has_fields())
    }

    fn has_all_of(&self, record: &PoseRecord) -> bool {
        self.formats.iter().all(|format| format.is_in(record))
    }

    fn begin(&self, pose: &PoseSpec) {
        remove_frames(&self.arguments.output, &pose.name);
        let frames = self.frames(pose);
        for layer in &self.scene.layers {
            let glb = self.glb_file(pose);
            for file in frames.series_files(&layer.name).into_iter().chain([glb]) {
                // One that is not there, or stays, shows what an earlier run has made.
                let _ = fs::remove_file(self.arguments.output.join(file));
            }
        }
    }

    fn frame(&self, pose: &PoseSpec, frame: &Frame<'_>) -> Result<Vec<String>, CliError> {
        self.frames(pose).add(frame)
    }

    /// The meshes of the last key, as they were computed on; and a body's mesh at every key.
    fn pose(&self, pose: &PoseSpec, result: &PoseResult) -> Result<PoseFiles, CliError> {
        let mut made = PoseFiles::default();
        made.files.extend(self.frames(pose).finish()?);
        let moved = self.frames(pose).take_moved();
        if !moved.is_empty() {
            let written = self.write_glb(pose, moved)?;
            made.warnings.extend(written.warnings);
            made.files.push(self.glb_file(pose));
        }
        for layer in result.keys.last().iter().flat_map(|key| &key.layers) {
            let file = format!("meshes/{}/{}.obj", pose.name, layer.name);
            let computed = &layer.computed;
            let frame = FrameMesh {
                name: &layer.name,
                positions: &computed.positions,
                triangles: &computed.faces,
                uvs: &computed.uvs,
                uv_triangles: &computed.faces,
            };
            self.write(&file, &frame)?;
            made.files.push(file);
        }
        for key in &result.keys {
            let percent = key_percent(key.load);
            let file = format!("meshes/{}/body_{percent}.obj", pose.name);
            if write_moved_mesh(self.scene, &self.arguments.output.join(&file), pose, key)? {
                made.files.push(file);
            }
        }
        Ok(made)
    }
}

impl<'a> FrameMeshes<'a> {
    fn frames(&self, pose: &PoseSpec) -> MutexGuard<'_, FrameFiles<'a>> {
        let frames = &self.frames[&pose.name];
        frames.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The GLB of a pose, relative to the output folder.
    fn glb_file(&self, pose: &PoseSpec) -> String {
        format!("frames/{}/{}.glb", pose.name, file_name(&self.scene.mesh))
    }

    /// Writes the mesh of the scene with a blend shape per load step.
    fn write_glb(
        &self,
        pose: &PoseSpec,
        moved: Vec<(f64, Vec<Vector3<f64>>)>,
    ) -> Result<WrittenGlb, CliError> {
        let scene = self.scene;
        let seconds = self.folder.pose(&pose.name).seconds;
        let moved = moved.into_iter().map(|(time, control)| {
            let positions = scene.driver.unweld(&control);
            MovedMesh {
                pose: pose.name.clone(),
                key: time,
                seconds: time * seconds,
                normals: scene.moved_normals(&positions),
                positions,
            }
        });
        let moved: Vec<MovedMesh> = moved.collect();
        let path = self.arguments.output.join(self.glb_file(pose));
        write_artist_mesh(&path, &scene.mesh, &scene.rest_frames()?, (&[], &moved))
    }

    fn write(&self, file: &str, frame: &FrameMesh<'_>) -> Result<(), CliError> {
        let path = self.arguments.output.join(file);
        Ok(self.placement.write_obj(&path, frame)?)
    }
}
