//! `ruga simulate`: the layers' meshes in every load step, and the report.

use std::collections::BTreeMap;

use nalgebra::Vector2;
use ruga_io::{FrameMesh, key_percent};
use ruga_scene::{Placement, Scene};
use ruga_stepper::{Frame, PoseResult, PoseSpec};

use crate::arguments::RunArguments;
use crate::error::CliError;
use crate::folder_results::FolderResults;
use crate::memory_limit::refuse_too_little;
use crate::moved_mesh::write_moved_mesh;
use crate::outcome::Outcome;
use crate::output_folder::OutputFolder;
use crate::pose_record::{Records, remove_frames};
use crate::pose_runs::{PoseFiles, Product, run_poses};
use crate::summary::{self, ALL_IN_REPORT};
use crate::{interrupt, messages};

/// Simulates the poses of a scene and writes their meshes.
///
/// # Errors
/// Whatever keeps a pose from being planned, simulated or written.
pub(crate) fn run(arguments: &RunArguments) -> Result<Outcome, CliError> {
    let scene = Scene::read_with(&arguments.scene, &arguments.scene_options())?;
    let plan = scene.plan()?;
    let records = Records::of_simulate(&arguments.output);
    let earlier = arguments.resume.then_some(&records);
    refuse_too_little(arguments.memory.as_ref(), &scene, &plan, earlier)?;
    // Until here nothing is written and Ctrl-C may end the process.
    interrupt::listen();
    let folder = OutputFolder::open(&scene, arguments, "simulate")?;
    let warnings = scene.warnings.iter().chain(plan.warnings());
    messages::warnings(warnings, ALL_IN_REPORT);
    let meshes = FrameMeshes {
        arguments,
        scene: &scene,
        placement: Placement::of(&scene.mesh),
        records,
    };
    let poses = run_poses(&scene, &plan, arguments, &folder, &meshes);
    let results = FolderResults::read(&meshes.records, &folder.poses);
    let poses = summary::unless_nothing_is_there(poses, arguments, &results)?;
    summary::conclude(&scene, &plan, arguments, poses, &results)
}

struct FrameMeshes<'a> {
    arguments: &'a RunArguments,
    scene: &'a Scene,
    placement: Placement,
    records: Records,
}

impl Product for FrameMeshes<'_> {
    const WANTS_FRAMES: bool = true;

    fn records(&self) -> &Records {
        &self.records
    }

    fn begin(&self, pose: &PoseSpec) {
        remove_frames(&self.arguments.output, &pose.name);
    }

    fn frame(&self, pose: &PoseSpec, frame: &Frame<'_>) -> Result<Vec<String>, CliError> {
        let mut files = Vec::new();
        for layer in frame.layers {
            let file = format!("frames/{}/{}.{:04}.obj", pose.name, layer.name, frame.index);
            let (uvs, uv_triangles) = shared_uvs(&layer.uvs);
            let frame = FrameMesh {
                name: &layer.name,
                positions: &layer.positions,
                triangles: &layer.faces,
                uvs: &uvs,
                uv_triangles: &uv_triangles,
            };
            self.write(&file, &frame)?;
            files.push(file);
        }
        Ok(files)
    }

    /// The meshes of the last key, as they were computed on; and a body's mesh at every key.
    fn pose(&self, pose: &PoseSpec, result: &PoseResult) -> Result<PoseFiles, CliError> {
        let mut made = PoseFiles::default();
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

impl FrameMeshes<'_> {
    fn write(&self, file: &str, frame: &FrameMesh<'_>) -> Result<(), CliError> {
        let path = self.arguments.output.join(file);
        Ok(self.placement.write_obj(&path, frame)?)
    }
}

/// Every texture coordinate once, and where the corners find theirs.
fn shared_uvs(corners: &[[Vector2<f64>; 3]]) -> (Vec<Vector2<f64>>, Vec<[u32; 3]>) {
    let mut known = BTreeMap::new();
    let mut uvs = Vec::new();
    let mut index = |uv: Vector2<f64>| -> u32 {
        *known
            .entry([uv.x.to_bits(), uv.y.to_bits()])
            .or_insert_with(|| {
                uvs.push(uv);
                uvs.len() as u32 - 1
            })
    };
    let triangles = corners
        .iter()
        .map(|triangle| triangle.map(&mut index))
        .collect();
    (uvs, triangles)
}
