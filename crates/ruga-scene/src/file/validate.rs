//! What a scene must mean, beyond being well-formed.

use std::path::Path;

use super::fault::{
    Checked, Fault, fault, fraction_of_pose, not_negative, positive, unique_name, within,
};
use super::names::usable_file_name;
use super::validate_interior::motion_faults;
use super::{Driver, Movers, Pose, SceneFile};
use ruga_blend::nearest;
use ruga_io::LengthUnit;
use ruga_io::key_percent;

use crate::SceneError;

/// The widest range that sliders of blend shapes have, Blender's. What lies beyond was meant as per
/// cent.
const LARGEST_WEIGHT: f64 = 10.0;

/// Blend shapes or poses that a message lists: a face has dozens.
const LISTED_NAMES: usize = 12;

impl SceneFile {
    /// The version of the layout that this crate reads.
    pub const VERSION: u32 = 1;

    /// Checks ranges, names and contradictions; `path` is for messages.
    ///
    /// # Errors
    /// [`SceneError::Key`] for the first fault, in the order of the file, with `[interior]` before
    /// the poses.
    pub fn validate(&self, path: &Path) -> Result<(), SceneError> {
        self.faults().map_err(|fault| fault.at(path))
    }

    /// The poses of the scene; when it has none, one per blend shape and one per growth; when there is
    /// none of these either, one pose `rest` of a body on which gravity acts.
    ///
    /// Names made from shapes are usable as file names: what is not becomes `_`.
    ///
    /// # Errors
    /// [`SceneError::Key`] when a pose weighs a blend shape that is not among `shapes`, when blend
    /// shapes are to move a body that does not follow them, or when there is neither pose nor shape
    /// nor growth nor gravity; `path` is for messages.
    pub fn poses_or_shapes(&self, shapes: &[String], path: &Path) -> Result<Vec<Pose>, SceneError> {
        let fault = (self.nothing_moves(shapes))
            .or_else(|| self.unknown_shape(shapes))
            .or_else(|| self.shape_without_effect(shapes));
        if let Some(fault) = fault {
            return Err(fault.at(path));
        }
        if !self.poses.is_empty() {
            return Ok(self.poses.clone());
        }
        // Nothing draws a sheet to blend shapes.
        let shapes = if self.sheet.is_some() { &[] } else { shapes };
        if shapes.is_empty() && self.growths.is_empty() {
            return Ok(vec![Pose::at_rest("rest")]);
        }
        let mut names = Vec::new();
        let growths = self.growths.iter().map(|growth| &growth.name);
        for name in shapes.iter().chain(growths.clone()) {
            names.push(usable_file_name(name, &names));
        }
        let of_growths = names.split_off(shapes.len()).into_iter().zip(growths);
        let of_shapes = names.into_iter().zip(shapes);
        let of_shapes = of_shapes.map(|(name, shape)| Pose::of_shape(name, shape));
        let of_growths = of_growths.map(|(name, growth)| Pose::of_growth(name, growth));
        Ok(of_shapes.chain(of_growths).collect())
    }

    fn nothing_moves(&self, shapes: &[String]) -> Option<Fault> {
        if !self.poses.is_empty() || !shapes.is_empty() || !self.growths.is_empty() {
            return None;
        }
        let (key, reason) = match &self.interior {
            None if self.sheet.is_some() => match self.moves_by_itself() {
                true => return None,
                false => (
                    "sheet",
                    "nothing moves the sheet: give [[poses]] with motions, [[growths]], [[creases]] or gravity",
                ),
            },
            None => (
                "driver.mesh",
                "the mesh has no blend shapes, so there is nothing to pose",
            ),
            Some(interior) if interior.gravity == [0.0; 3] => (
                "interior",
                "nothing moves the body: give [[poses]] with motions, or gravity",
            ),
            Some(_) => return None,
        };
        Some(Fault {
            key: key.to_owned(),
            reason: reason.to_owned(),
            suggestion: None,
        })
    }

    fn unknown_shape(&self, shapes: &[String]) -> Option<Fault> {
        self.poses.iter().enumerate().find_map(|(i, pose)| {
            let shape = pose.weights.keys().find(|shape| !shapes.contains(shape))?;
            Some(Fault {
                key: format!("poses[{i}].weights.{shape}"),
                reason: format!(
                    "pose `{}`: the mesh has no blend shape `{shape}`; it has {}",
                    pose.name,
                    listed(shapes.iter().map(String::as_str))
                ),
                suggestion: nearest(shape, shapes.iter().map(String::as_str)),
            })
        })
    }

    /// A body goes where its inside goes: blend shapes move it by `follow` or not at all.
    fn shape_without_effect(&self, shapes: &[String]) -> Option<Fault> {
        const REMEDY: &str = "`follow` in [interior] (Pa/m), by which the surface is drawn to them";
        if self.interior.as_ref()?.follow.is_some() {
            return None;
        }
        let posed = |(i, pose): (usize, &Pose)| {
            (!pose.weights.is_empty()).then(|| format!("poses[{i}].weights"))
        };
        let (key, remedy) = match self.poses.iter().enumerate().find_map(posed) {
            Some(key) => (key, REMEDY.to_owned()),
            None if self.poses.is_empty() && !shapes.is_empty() => (
                "poses".to_owned(),
                format!("{REMEDY}; or [[poses]] with motions"),
            ),
            None => return None,
        };
        Some(Fault {
            key,
            reason: format!("blend shapes alone do not move a body; accepted: {remedy}"),
            suggestion: None,
        })
    }

    fn faults(&self) -> Checked {
        if self.version != Self::VERSION {
            return fault("version", self.version, "this ruga reads version 1");
        }
        self.driver.faults(self.length_unit)?;
        self.layer_faults()?;
        self.crease_faults()?;
        self.growth_faults()?;
        self.memory_faults()?;
        // Before the poses, which name its parts.
        if let Some(interior) = &self.interior {
            interior.faults(self.layers.len())?;
            if self.driver.symmetry.is_some() {
                let accepted = "nothing with [interior]: a soft body moves as a whole";
                return fault("driver.symmetry", "\"x\"", accepted);
            }
        }
        self.sheet_faults()?;
        self.burn_faults()?;
        self.pose_faults()?;
        self.solver_faults()?;
        self.remesh_faults()?;
        self.bake_faults()?;
        let Some(pack) = &self.pack else {
            return Ok(());
        };
        pack.faults()?;
        if !self.bake.maps.iter().any(|kind| kind.is_packed()) {
            let accepted = "with [pack], a kind that is of wrinkles alone, such as \"normal\"";
            return fault("bake.maps", "none that can be packed", accepted);
        }
        Ok(())
    }

    /// What poses can move, in a scene with a body or a sheet.
    fn movers(&self) -> Option<Movers<'_>> {
        let of_body = self.interior.as_ref().map(|interior| interior.movers());
        let sources = self.burn.as_ref().map_or(&[][..], |burn| &burn.sources);
        let of_sheet = self.sheet.as_ref().map(|sheet| Movers {
            sources,
            ..sheet.movers()
        });
        of_body.or(of_sheet)
    }

    /// Whether a body or a sheet moves without anything of a pose: gravity acts on it, or creases fold it.
    fn moves_by_itself(&self) -> bool {
        let of_body = self.interior.as_ref().map(|interior| interior.gravity);
        let of_sheet = self.sheet.as_ref().map(|sheet| sheet.gravity);
        let gravity = of_body.or(of_sheet);
        let is_creased = self.sheet.is_some() && !self.creases.is_empty();
        is_creased || self.burn.is_some() || gravity.is_some_and(|gravity| gravity != [0.0; 3])
    }

    fn pose_faults(&self) -> Checked {
        for (i, pose) in self.poses.iter().enumerate() {
            let key = format!("poses[{i}]");
            pose.faults(&key, self.movers(), self.moves_by_itself())?;
            self.pose_growth_faults(&key, pose)?;
            let earlier = self.poses.iter().take(i).map(|other| &other.name);
            unique_name(&format!("{key}.name"), &pose.name, earlier)?;
        }
        Ok(())
    }

    fn solver_faults(&self) -> Checked {
        positive("solver.time_step", self.solver.time_step)?;
        not_negative("solver.damping", self.solver.damping)?;
        let tolerance = self.solver.tolerance;
        if !(tolerance > 0.0 && tolerance < 1.0) {
            return fault(
                "solver.tolerance",
                tolerance,
                "a number above 0 and below 1",
            );
        }
        Ok(())
    }

    fn remesh_faults(&self) -> Checked {
        let remesh = &self.remesh;
        // Two points per wave are its Nyquist limit; three are the least that can bend.
        let points = remesh.points_per_wavelength;
        if !(points >= 3.0 && points.is_finite()) {
            return fault("remesh.points_per_wavelength", points, "a number from 3");
        }
        not_negative("remesh.min_edge", remesh.min_edge)?;
        positive("remesh.max_edge", remesh.max_edge)?;
        if remesh.min_edge >= remesh.max_edge {
            let accepted = format!("a length below max_edge = {}", remesh.max_edge);
            return fault("remesh.min_edge", remesh.min_edge, &accepted);
        }
        if !(1.0..=4.0).contains(&remesh.aspect) {
            return fault("remesh.aspect", remesh.aspect, "a number from 1 to 4");
        }
        Ok(())
    }

    fn bake_faults(&self) -> Checked {
        let bake = &self.bake;
        within("bake.size", u64::from(bake.size), 16, 16_384)?;
        within(
            "bake.padding",
            u64::from(bake.padding),
            0,
            u64::from(bake.size),
        )?;
        if ![1, 2, 4].contains(&bake.supersample) {
            return fault("bake.supersample", bake.supersample, "1, 2 or 4");
        }
        positive("bake.curvature_length", bake.curvature_length)?;
        for (i, kind) in bake.maps.iter().enumerate() {
            if bake.maps.iter().take(i).any(|other| other == kind) {
                return fault(&format!("bake.maps[{i}]"), kind.word(), "each kind once");
            }
        }
        if bake.maps.is_empty() {
            return fault("bake.maps", "[]", "at least one kind, such as \"normal\"");
        }
        Ok(())
    }
}

impl Driver {
    fn faults(&self, length_unit: LengthUnit) -> Checked {
        within("driver.vertex_budget", self.vertex_budget, 1, u64::MAX)?;
        let is_obj = has_extension(&self.mesh, "obj");
        if !self.targets.is_empty() && !is_obj {
            let accepted = "only OBJ meshes take targets from files";
            return fault("driver.targets", self.mesh.display(), accepted);
        }
        if let Some(scale) = self.scale {
            positive("driver.scale", scale)?;
        }
        if length_unit == LengthUnit::Metre {
            return Ok(());
        }
        let (unit, metres) = (length_unit.word(), length_unit.metres());
        if let Some(scale) = self.scale {
            let accepted = format!("one of the two; `scale = {metres}` alone means {unit}, too");
            let found = format!("{scale} beside `length_unit = \"{unit}\"`");
            return fault("driver.scale", found, &accepted);
        }
        if !is_obj {
            let accepted = format!(
                "only with OBJ meshes; for {}, `scale = {metres}` under [driver]",
                self.mesh.display()
            );
            return fault("length_unit", format!("\"{unit}\""), &accepted);
        }
        Ok(())
    }
}

impl Pose {
    fn faults(&self, key: &str, movers: Option<Movers<'_>>, moves: bool) -> Checked {
        within(&format!("{key}.steps"), u64::from(self.steps), 1, 100_000)?;
        let grows = !self.growths.is_empty();
        if self.weights.is_empty() && !grows && movers.is_none() {
            let accepted = "at least one blend shape, or `growths`";
            return fault(&format!("{key}.weights"), "{}", accepted);
        }
        if self.weights.is_empty() && self.motions.is_empty() && !moves && !grows {
            let table = movers.map_or("interior", |movers| movers.table);
            let accepted =
                format!("`motions`, `weights` or `growths` here, or `gravity` in [{table}]");
            return fault(key, "nothing that moves it", &accepted);
        }
        for (shape, weight) in &self.weights {
            if !weight.is_finite() {
                let key = format!("{key}.weights.{shape}");
                return fault(&key, weight, "a finite number");
            }
            if weight.abs() > LARGEST_WEIGHT {
                return Err(Fault {
                    key: format!("{key}.weights.{shape}"),
                    reason: format!(
                        "found {weight}; accepted: -{LARGEST_WEIGHT} to {LARGEST_WEIGHT}, where 1 is \
                         the whole shape"
                    ),
                    suggestion: Some((weight / 100.0).to_string()),
                });
            }
        }
        if self.keys.is_empty() {
            return fault(
                &format!("{key}.keys"),
                "[]",
                "at least one fraction above 0, up to 1, such as `[0.5, 1.0]`",
            );
        }
        for (i, fraction) in self.keys.iter().enumerate() {
            let key = format!("{key}.keys[{i}]");
            fraction_of_pose(&key, *fraction)?;
            let percent = key_percent(*fraction);
            let clash = self.keys.iter().take(i).any(|k| key_percent(*k) == percent);
            if clash || percent == "0" {
                return fault(
                    &key,
                    fraction,
                    "fractions at least 0.001 apart, and from 0.001",
                );
            }
        }
        motion_faults(key, &self.motions, movers)
    }
}

/// The names of blend shapes or poses, the first dozen of many.
pub(super) fn listed<'a>(all: impl ExactSizeIterator<Item = &'a str>) -> String {
    let left_out = all.len().saturating_sub(LISTED_NAMES);
    let names: Vec<String> = all
        .take(LISTED_NAMES)
        .map(|name| format!("`{name}`"))
        .collect();
    match left_out {
        0 if names.is_empty() => "none".to_owned(),
        0 => names.join(", "),
        more => format!("{} and {more} more", names.join(", ")),
    }
}

pub(super) fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension()
        .is_some_and(|found| found.eq_ignore_ascii_case(extension))
}
