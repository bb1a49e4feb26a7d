//! `[sheet]`: a layer that lies on nothing.

use ruga_io::MapKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::fault::{Checked, fault, positive};
use super::validate_interior::{finite, mover_faults};
use super::{Handle, LayerDefinition, Movers, Obstacle, Region, SceneFile, Stack};

/// `[sheet]`: the one layer of the scene is a thin sheet that lies on nothing, such as paper, a leaf or cloth, held
/// by handles and pushed by obstacles, and the mesh is its shape at rest.
///
/// It is given by `young` and `thickness` or by `plies`, has neither `[substrate]` nor mask, and covers all of the mesh. Poses move
/// handles and obstacles and switch growths on, and each of their `steps` is an equilibrium or, with `mode =
/// "dynamic"` under `[solver]`, a step in time. Places and directions are in the axes of the world, lengths in metres.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sheet {
    /// Acceleration of its mass, m/s2; none if left out. It acts in full from the first step on.
    pub gravity: [f64; 3],
    /// Longest edge of the mesh that is simulated, m. If left out it is a sixtieth of the longest side of the
    /// sheet, and where the sheet burns at most half the width of the front: the mesh then follows the fire.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edge: Option<f64>,
    /// Parts of the sheet that are held and moved.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub handles: Vec<Handle>,
    /// What it cannot enter.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<Obstacle>,
}

impl Sheet {
    /// What poses can move.
    pub fn movers(&self) -> Movers<'_> {
        Movers {
            table: "sheet",
            handles: &self.handles,
            obstacles: &self.obstacles,
            sources: &[],
        }
    }
}

impl SceneFile {
    pub(super) fn sheet_faults(&self) -> Checked {
        let Some(sheet) = &self.sheet else {
            return Ok(());
        };
        finite("sheet.gravity", &sheet.gravity)?;
        sheet
            .edge
            .map_or(Ok(()), |edge| positive("sheet.edge", edge))?;
        mover_faults(&sheet.movers())?;
        if self.interior.is_some() {
            let accepted = "either [interior], a soft body, or [sheet]";
            return fault("sheet", "both", accepted);
        }
        if self.substrate.is_some() {
            let accepted = "no [substrate] with [sheet], which lies on nothing";
            return fault("substrate", "one", accepted);
        }
        if let [_, _, ..] = self.layers.as_slice() {
            let found = format!("{} of them", self.layers.len());
            return fault("layers", found, "one layer with [sheet]");
        }
        let layer = &self.layers[0];
        let is_wanted = matches!(layer.definition(), Some(LayerDefinition::Wanted { .. }));
        if is_wanted || layer.preset.is_some() {
            let accepted =
                "`young` and `thickness` with [sheet], or `plies`: it has no wavelength of its own";
            return fault("layers[0]", "another description", accepted);
        }
        if let Some(mask) = &layer.mask {
            let accepted = "no mask with [sheet], which covers all of the mesh";
            return fault("layers[0].mask", mask.display(), accepted);
        }
        let wavelength = layer.map.as_ref().and_then(|map| map.wavelength);
        if let Some(range) = wavelength {
            let accepted =
                "`young` and `thickness` alone with [sheet]: it has no wavelength of its own";
            return fault("layers[0].map.wavelength", format!("{range:?}"), accepted);
        }
        if let Region::Mask(mask) = &self.driver.region {
            let accepted = "\"auto\" or \"all\" with [sheet], which covers all of the mesh";
            return fault("driver.region", mask.display(), accepted);
        }
        if self.driver.symmetry.is_some() {
            let accepted = "nothing with [sheet], which moves as a whole";
            return fault("driver.symmetry", "\"x\"", accepted);
        }
        if self.stack != Stack::Nominal {
            return fault(
                "stack",
                "another",
                "\"nominal\" with [sheet], which has one layer",
            );
        }
        if self.bake.maps.contains(&MapKind::Compression) {
            let accepted = "other maps with [sheet], which has no compression that wrinkles it";
            return fault("bake.maps", "\"compression\"", accepted);
        }
        if self.memory.is_some() {
            return fault("memory", "one", "no [memory] with [sheet]");
        }
        for (i, pose) in self.poses.iter().enumerate() {
            if !pose.weights.is_empty() {
                let accepted = "no blend shapes with [sheet], which goes where motions, gravity and growths take it";
                return fault(&format!("poses[{i}].weights"), "some", accepted);
            }
        }
        Ok(())
    }
}
