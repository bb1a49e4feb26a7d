//! The artist's mesh where a simulation has taken it: blend shapes of a GLB, and animations that play them.

use std::ops::Range;

use nalgebra::Vector3;
use serde_json::{Value, json};

use crate::glb_buffer::GlbBuffer;
use crate::glb_frames::{FileSpace, single, unit};
use crate::json_text::JsonObject;
use crate::{MeshFile, key_percent};

/// The artist's mesh at a key of a pose that has moved it otherwise than by its blend shapes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MovedMesh {
    /// Name of the pose.
    pub pose: String,
    /// Fraction of the pose, above 0.
    pub key: f64,
    /// Time from the beginning of the pose at which the mesh is there, above 0, s.
    pub seconds: f64,
    /// Positions of the file's vertices in the axes of [`MeshFile::mesh`], m.
    pub positions: Vec<Vector3<f64>>,
    /// Unit normals there.
    pub normals: Vec<Vector3<f64>>,
}

/// Blend shapes that are added to those of a file.
pub(crate) struct AddedShapes<'a> {
    moved: &'a [MovedMesh],
    file: &'a MeshFile,
    /// Vertex ranges that are written, whether with normals, and their targets.
    written: Vec<(Range<usize>, bool, Vec<Value>)>,
}

impl<'a> AddedShapes<'a> {
    pub(crate) fn new(file: &'a MeshFile, moved: &'a [MovedMesh]) -> Self {
        Self {
            moved,
            file,
            written: Vec::new(),
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.moved.is_empty()
    }

    /// Names of the file's shapes and, after them, of those that are added: pose and key, numbered where the file has
    /// such a name already.
    pub(crate) fn names(&self) -> Vec<String> {
        let shapes = self.file.mesh.shapes.iter();
        let mut names: Vec<String> = shapes.map(|shape| shape.name.clone()).collect();
        for moved in self.moved {
            let base = format!("{}_{}", moved.pose, key_percent(moved.key));
            let mut name = base.clone();
            let mut number = 2;
            while names.contains(&name) {
                name = format!("{base}_{number}");
                number += 1;
            }
            names.push(name);
        }
        names
    }

    /// Morph targets of a range of vertices, whose rest `normals` are those that it is written with, if it has any.
    pub(crate) fn targets(
        &mut self,
        buffer: &mut GlbBuffer,
        space: &FileSpace,
        (range, normals): (&Range<usize>, Option<&[Vector3<f64>]>),
    ) -> Vec<Value> {
        let same = |(other, with, _): &&(Range<usize>, bool, _)| {
            other == range && *with == normals.is_some()
        };
        if let Some((_, _, targets)) = self.written.iter().find(same) {
            return targets.clone();
        }
        let rest = &self.file.mesh.positions;
        let targets = self.moved.iter().map(|moved| {
            let ways = range.clone().map(|v| moved.positions[v] - rest[v]);
            let ways: Vec<[f32; 3]> = ways.map(|way| single(space.way(&way))).collect();
            let mut target = json!({ "POSITION": buffer.deltas(&ways) });
            if let Some(normals) = normals {
                let turns = range.clone().map(|v| {
                    let [before, after] = [unit(&normals[v]), unit(&moved.normals[v])];
                    single(space.normal(&after) - space.normal(&before))
                });
                let turns: Vec<[f32; 3]> = turns.collect();
                target["NORMAL"] = json!(buffer.deltas(&turns));
            }
            target
        });
        let targets: Vec<Value> = targets.collect();
        self.written
            .push((range.clone(), normals.is_some(), targets.clone()));
        targets
    }

    /// One animation per pose, which leads `nodes` from rest through its keys.
    pub(crate) fn animations(&self, buffer: &mut GlbBuffer, nodes: &[usize]) -> Vec<Value> {
        let mut poses: Vec<&str> = Vec::new();
        for moved in self.moved {
            if !poses.contains(&moved.pose.as_str()) {
                poses.push(&moved.pose);
            }
        }
        if nodes.is_empty() {
            return Vec::new();
        }
        let animation = |pose: &&str| {
            let sampler = self.sampler(buffer, pose);
            let channel = |node: &usize| json!({ "sampler": 0, "target": { "node": node, "path": "weights" } });
            let channels: Vec<Value> = nodes.iter().map(channel).collect();
            json!({ "name": pose, "samplers": [sampler], "channels": channels })
        };
        poses.iter().map(animation).collect()
    }

    fn sampler(&self, buffer: &mut GlbBuffer, pose: &str) -> Value {
        let own = self.moved.iter().enumerate();
        let mut own: Vec<(usize, &MovedMesh)> = own.filter(|(_, m)| m.pose == pose).collect();
        own.sort_by(|a, b| a.1.seconds.total_cmp(&b.1.seconds));
        let defaults = self.file.default_weights.iter().map(|w| *w as f32);
        let defaults: Vec<f32> = defaults.collect();
        let row = |shown: Option<usize>| {
            let added = (0..self.moved.len()).map(move |i| f32::from(u8::from(shown == Some(i))));
            defaults.iter().copied().chain(added)
        };
        let mut times = vec![0.0];
        let mut weights: Vec<f32> = row(None).collect();
        for (number, moved) in own {
            let time = moved.seconds as f32;
            // Times have to grow.
            if times.last().is_some_and(|last| time > *last) {
                times.push(time);
                weights.extend(row(Some(number)));
            }
        }
        json!({
            "input": buffer.times(&times),
            "interpolation": "LINEAR",
            "output": buffer.scalars(&weights),
        })
    }

    /// `weights` of a mesh or a node of a document, with those of the shapes that are added.
    pub(crate) fn extend_weights(&self, of: &mut JsonObject) -> serde_json::Result<()> {
        let Some(mut weights) = of.read::<Vec<Value>>("weights") else {
            return Ok(());
        };
        weights.resize(weights.len() + self.moved.len(), json!(0.0));
        of.set("weights", &weights)
    }
}

/// Numbers of the nodes of a document that carry a mesh.
pub(crate) fn carriers(root: &JsonObject, mesh: usize) -> Vec<usize> {
    let nodes = root.array("nodes");
    let is_carrier = |node: &usize| {
        let node = JsonObject::parse(nodes[*node].get());
        node.is_ok_and(|node| node.read::<usize>("mesh") == Some(mesh))
    };
    (0..nodes.len()).filter(is_carrier).collect()
}

/// Whether an animation of a document drives the weights of one of these nodes, by as many numbers as there are shapes.
pub(crate) fn are_weights_animated(root: &JsonObject, nodes: &[usize]) -> bool {
    let animations: Vec<Value> = root.read("animations").unwrap_or_default();
    let channels = animations.iter().flat_map(|a| a["channels"].as_array());
    channels.flatten().any(|channel| {
        let target = &channel["target"];
        let node = target["node"].as_u64();
        let is_ours = node.is_some_and(|n| nodes.iter().any(|own| *own as u64 == n));
        let pointer = target["extensions"]["KHR_animation_pointer"]["pointer"].as_str();
        let is_pointed = pointer.is_some_and(|pointer| pointer.ends_with("/weights"));
        is_ours && target["path"] == "weights" || is_pointed
    })
}
