//! `ruga simulate`: the layers' meshes in every load step, and the report.

use std::collections::BTreeMap;

use nalgebra::{Vector2, Vector3};
use ruga_io::{ObjFrame, write_obj_frame};
use ruga_stepper::{Frame, LayerSurface, PoseResult, PoseSpec};

use crate::arguments::RunArguments;
use crate::error::CliError;
use crate::moved_mesh::write_moved_mesh;
use crate::placement::Placement;
use crate::pose_record::remove_frames;
use crate::pose_runs::{PoseFiles, Product, run_poses};
use crate::project::Project;
use crate::run::Outcome;
use crate::{interrupt, messages, output_folder, summary};

/// Simulates the poses of a scene and writes their meshes.
///
/// # Errors
/// Whatever keeps a pose from being planned, simulated or written.
pub(crate) fn run(arguments: &RunArguments) -> Result<Outcome, CliError> {
    interrupt::listen();
    let project = Project::read(&arguments.scene, &arguments.poses, arguments.quality)?;
    let plan = project.plan()?;
    output_folder::prepare(&arguments.output)?;
    for warning in project.warnings.iter().chain(plan.warnings()) {
        messages::warning(warning);
    }
    let meshes = FrameMeshes {
        arguments,
        project: &project,
        placement: Placement::of(&project.mesh),
    };
    let records = run_poses(&project, &plan, arguments, &meshes)?;
    summary::conclude(&project, &plan, arguments, &records)
}

struct FrameMeshes<'a> {
    arguments: &'a RunArguments,
    project: &'a Project,
    placement: Placement,
}

impl Product for FrameMeshes<'_> {
    const COMMAND: &'static str = "simulate";
    const WANTS_FRAMES: bool = true;

    fn begin(&self, pose: &PoseSpec) {
        remove_frames(&self.arguments.output, &pose.name);
    }

    fn frame(&self, pose: &PoseSpec, frame: &Frame<'_>) -> Result<Vec<String>, CliError> {
        let mut files = Vec::new();
        for layer in frame.layers {
            let file = format!("frames/{}/{}.{:04}.obj", pose.name, layer.name, frame.index);
            self.write(&file, layer)?;
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
            self.write_obj(
                &file,
                &layer.name,
                &computed.positions,
                &computed.faces,
                (&computed.uvs, &computed.faces),
            )?;
            made.files.push(file);
        }
        for key in &result.keys {
            let file = write_moved_mesh(self.project, &self.arguments.output, pose, key)?;
            made.files.extend(file);
        }
        Ok(made)
    }
}

impl FrameMeshes<'_> {
    fn write(&self, file: &str, layer: &LayerSurface) -> Result<(), CliError> {
        let (uvs, uv_triangles) = shared_uvs(&layer.uvs);
        self.write_obj(
            file,
            &layer.name,
            &layer.positions,
            &layer.faces,
            (&uvs, &uv_triangles),
        )
    }

    fn write_obj(
        &self,
        file: &str,
        name: &str,
        positions: &[Vector3<f64>],
        triangles: &[[u32; 3]],
        (uvs, uv_triangles): (&[Vector2<f64>], &[[u32; 3]]),
    ) -> Result<(), CliError> {
        let positions: Vec<Vector3<f64>> = positions
            .iter()
            .map(|p| self.placement.in_world(p))
            .collect();
        let frame = ObjFrame {
            name,
            positions: &positions,
            triangles,
            uvs,
            uv_triangles,
        };
        Ok(write_obj_frame(&self.arguments.output.join(file), &frame)?)
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
