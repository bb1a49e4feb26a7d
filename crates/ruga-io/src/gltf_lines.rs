//! Lines of a glTF mesh.

use std::path::Path;

use gltf::json::accessor::Type;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use nalgebra::Vector3;

use crate::IoError;
use crate::gltf_container::Container;
use crate::gltf_mesh::{attribute, select_mesh};
use crate::gltf_placement::world_from_named_node;
use crate::line_curves::{FoundLines, LOOSE_EDGES};
use crate::line_joining::LineElement;

/// Reads the primitives of lines of the mesh of that name, else of the node of that name.
pub(crate) fn read_gltf_lines(path: &Path, name: &str) -> Result<FoundLines, IoError> {
    let container = Container::read(path)?;
    let number = select_mesh(&container, Some(name))
        .map_err(|error| explain_empty_node(&container, name, error))?;
    let mut found = FoundLines {
        elements: Vec::new(),
        world_from_lines: world_from_named_node(&container, number, name)?,
        has_faces: false,
    };
    let primitives = &container.root.meshes[number].primitives;
    for (index, primitive) in primitives.iter().enumerate() {
        let element = format!("primitive {index} of mesh {number}");
        match primitive.mode {
            Checked::Invalid => return Err(container.malformed(element, "its mode is unknown")),
            Checked::Valid(Mode::Points) => {}
            Checked::Valid(mode @ (Mode::Lines | Mode::LineLoop | Mode::LineStrip)) => {
                let points = corners(&container, primitive, &element)?;
                let lines = elements(mode, points);
                let lines = lines.map_err(|reason| container.malformed(element, reason))?;
                found.elements.extend(lines);
            }
            Checked::Valid(_) => found.has_faces = true,
        }
    }
    Ok(found)
}

/// A mesh of which an exporter drops everything leaves a node of its name behind.
fn explain_empty_node(container: &Container, name: &str, error: IoError) -> IoError {
    let mut nodes = container.root.nodes.iter();
    let is_empty = nodes.any(|node| node.name.as_deref() == Some(name) && node.mesh.is_none());
    if !is_empty {
        return error;
    }
    let reason = format!("has no mesh, and so no lines. {LOOSE_EDGES}");
    container.malformed(format!("node `{name}`"), reason)
}

/// Positions of the corners of a primitive, in its order.
fn corners(
    container: &Container,
    primitive: &Primitive,
    element: &str,
) -> Result<Vec<Vector3<f64>>, IoError> {
    let accessor = attribute(primitive, Semantic::Positions)
        .ok_or_else(|| container.malformed(element, "has no POSITION"))?;
    let role = format!("POSITION of {element}");
    let positions = container.read_vectors::<3>(accessor, Type::Vec3, &role)?;
    let positions: Vec<Vector3<f64>> = positions.into_iter().map(Vector3::from).collect();
    let Some(indices) = primitive.indices else {
        return Ok(positions);
    };
    let role = format!("indices of {element}");
    let indices = container.read_indices(indices, positions.len(), &role)?;
    Ok(indices.iter().map(|i| positions[*i as usize]).collect())
}

fn elements(mode: Mode, points: Vec<Vector3<f64>>) -> Result<Vec<LineElement>, String> {
    let count = points.len();
    match mode {
        _ if count < 2 => Err(format!("has {count} corner; a line has at least 2")),
        Mode::LineLoop => Ok(vec![LineElement::Loop(points)]),
        Mode::LineStrip => Ok(vec![LineElement::Strip(points)]),
        _ if !count.is_multiple_of(2) => Err(format!("has {count} corners, not a multiple of 2")),
        _ => {
            let pairs = points.chunks_exact(2);
            Ok(pairs.map(|p| LineElement::Pair([p[0], p[1]])).collect())
        }
    }
}
