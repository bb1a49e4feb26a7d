//! Description of a page's data, which its script reads first.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::Legend;
use crate::focus::Focus;
use crate::mesh_data::{MeshSections, PoseSections};

/// What the script reads first: where everything lies.
#[derive(Serialize)]
pub(crate) struct About<'a> {
    pub(crate) version: u32,
    /// Texels per side of a whole map.
    pub(crate) size: u32,
    /// Number of UDIM tiles; 0 for a mesh without, whose texture repeats.
    pub(crate) tiles: usize,
    /// Texels that the stored part of any map fits into.
    pub(crate) slot: [u32; 2],
    pub(crate) maps: Vec<MapPlace>,
    pub(crate) poses: Vec<AboutPose<'a>>,
    pub(crate) mesh: MeshSections,
    pub(crate) focus: Focus,
    /// Left out in pages of what was baked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) plan: Option<AboutPlan<'a>>,
}

#[derive(Serialize)]
pub(crate) struct MapPlace {
    /// Number of its UDIM tile.
    pub(crate) tile: usize,
    pub(crate) left: u32,
    pub(crate) top: u32,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

#[derive(Serialize)]
pub(crate) struct AboutPose<'a> {
    pub(crate) name: &'a str,
    pub(crate) weights: &'a BTreeMap<String, f64>,
    pub(crate) maps: Vec<AboutKey>,
    /// Left out in pages of what was baked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) plan: Option<AboutPlannedPose<'a>>,
    #[serde(flatten)]
    pub(crate) sections: PoseSections,
}

#[derive(Serialize)]
pub(crate) struct AboutKey {
    pub(crate) key: f64,
    /// Number of the map.
    pub(crate) map: usize,
}

/// Names and legend of the overlays of a plan.
#[derive(Serialize)]
pub(crate) struct AboutPlan<'a> {
    /// Names of the overlays that every pose may have.
    pub(crate) layers: &'a [String],
    #[serde(flatten)]
    pub(crate) legend: &'a Legend,
}

/// What a plan says of a pose.
#[derive(Serialize)]
pub(crate) struct AboutPlannedPose<'a> {
    pub(crate) notes: &'a [String],
    /// Number of each overlay; `None` where nothing wrinkles.
    pub(crate) overlays: Vec<Option<usize>>,
}

impl About<'_> {
    pub(crate) fn to_json(&self) -> String {
        serde_json::to_string(self).expect("structs of numbers, texts and lists always serialise")
    }
}
