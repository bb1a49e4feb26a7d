//! What will be modelled, where, how fine and at what cost; nothing is simulated here.

pub(crate) mod body_cost;
mod body_plan;
mod crease_places;
mod creased_faces;
mod fitted_faces;
mod planned_surface;
mod planning_surface;
mod pose_plan;
mod region;
mod skin_cost;
pub(crate) mod stacking;
pub(crate) mod surface_measures;
mod warnings;
mod waves;

use std::sync::Arc;

use nalgebra::Vector3;
use rayon::prelude::*;
use ruga_blend::{BaseSurface, Driver};
use ruga_material::{StackPair, Wrinkling};
use ruga_mesh::FaceId;

use crate::plan::crease_places::put_under_drawn_lines;
use crate::plan::planning_surface::PlanningSurface;
use crate::plan::pose_plan::PlannedLayer;
use crate::plan::stacking::Stacking;
use crate::plan::warnings::{never_fold_warnings, never_wrinkle_warnings};
use crate::skin::mirror::Plane;
use crate::skin::piece::Piece;
use crate::skin::refined::{Refined, in_all_directions, refined};
use crate::skin::skin_mesh::{check_boundaries, sharp_map};
use crate::support::Interior;
use crate::validation::{
    check_anchors, check_carried, check_growth, check_half, check_layer, check_map_size,
    check_modelling, check_motionless, check_pose, check_unslit,
};
use crate::{LayerSpec, Mask, Modelling, PoseSpec, Sheet, Stack, StepperError};

pub use body_plan::plan_body;
pub use planned_surface::PlannedSurface;
pub use planning_surface::{PlannedFace, Treatment};
pub use pose_plan::{AppliedStrain, LayerPlan, LoadPath, PaintedRanges, PosePlan};
pub use skin_cost::BYTES_PER_TEXEL;

/// Model of the poses, with everything that it was made from: [`Plan::simulate`] needs no more
/// than the number of a pose.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The poses, with what is simulated of each.
    pub poses: Vec<PosePlan>,
    /// Warnings for the user, of all poses.
    pub warnings: Vec<String>,
    /// The lattice inside a soft body; `None` where the posed driver carries the layers.
    pub interior: Option<InteriorPlan>,
    pub(crate) driver: Arc<Driver>,
    pub(crate) modelling: Modelling,
    /// The poses as they were asked for.
    pub(crate) specs: Vec<PoseSpec>,
    pub(crate) stacking: Stacking,
    /// Times the driver's faces are split in four where [`LayerPlan::region`] counts them.
    pub(crate) planning_levels: u32,
    /// The body below the layers, where there is one.
    pub(crate) body: Option<Arc<Interior>>,
    /// What acts on a layer that lies on nothing.
    pub(crate) sheet: Option<Arc<Sheet>>,
}

/// The lattice inside a soft body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InteriorPlan {
    /// Lattice elements.
    pub cells: usize,
    /// Lattice cells along the longest side.
    pub cells_along: u32,
    /// Edges of a lattice cell along x, y, z, m.
    pub cell_size: Vector3<f64>,
    /// Lattice nodes, held ones included.
    pub nodes: usize,
}

impl Plan {
    /// Per layer, bottom first, its wavelength, critical strain and coupling stiffnesses.
    pub fn wrinkling(&self) -> &[Wrinkling] {
        &self.stacking.wrinkling
    }

    /// Every layer with the one above it, bottom first: what the two would do together.
    pub fn pairs(&self) -> &[StackPair] {
        &self.stacking.pairs
    }

    /// Fraction of the bending strain of what lies below that layer number `layer` feels, by the scene or
    /// by what the stack means.
    ///
    /// # Panics
    /// If there is no layer of that number.
    pub fn bending_transfer(&self, layer: usize) -> f64 {
        self.stacking.attachments[layer].bending_transfer
    }

    /// What acts on the layer where it is a free sheet, with the edge that its mesh will have.
    pub fn sheet(&self) -> Option<&Sheet> {
        self.sheet.as_deref()
    }

    /// The file's triangles that have a simulated part in pose number `pose`, ascending.
    ///
    /// # Panics
    /// If there is no pose of that number.
    pub fn active_triangles(&self, pose: usize) -> Vec<u32> {
        let layers = self.poses[pose].layers.iter();
        let faces = layers.flat_map(|layer| &layer.region);
        let mut triangles: Vec<u32> = faces
            .map(|face| self.driver.triangles()[self.whole_face(*face)])
            .collect();
        triangles.sort_unstable();
        triangles.dedup();
        triangles
    }

    /// The driver's face that a face of a [`LayerPlan::region`] is a part of.
    fn whole_face(&self, face: u64) -> FaceId {
        FaceId((face >> (2 * self.planning_levels)) as u32)
    }

    /// Number of layers with a mesh of their own.
    pub(crate) fn meshes(&self) -> usize {
        self.stacking.meshes()
    }

    /// The part of the base surface that `layer` is simulated on, its edges up to `coarseness` times as long as its
    /// results need where they may be wrinkled, in any direction, and the same as fine as its shape alone asks for;
    /// `None` as soon as `goes_on` says no. Of `is_half` the part with positive x.
    pub(crate) fn layer_pieces(
        &self,
        (layer, is_half, coarseness): (&LayerPlan, bool, f64),
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<(Piece, Refined)> {
        // Splitting begins at the driver's own triangles, because the layer may be coarser or finer
        // than the surface on which its region was found. Parts of one triangle stand side by side
        // in the region, so that removing repetitions side by side removes all.
        let mut coarse: Vec<FaceId> = layer.region.iter().map(|f| self.whole_face(*f)).collect();
        coarse.dedup();
        let smoothing = self.modelling.smoothing;
        let driver = &self.driver;
        let whole = BaseSurface::new_while(driver, &coarse, layer.levels, smoothing, goes_on)?;
        // Faces larger than the region's are taken when any part of them is in it.
        let level = self.planning_levels.min(layer.levels);
        let shift = 2 * (self.planning_levels - level);
        let mut region: Vec<u64> = layer.region.iter().map(|face| face >> shift).collect();
        region.dedup();
        let wanted = |face: &FaceId| region.binary_search(&whole.ancestor(*face, level)).is_ok();
        let faces: Vec<FaceId> = whole.mesh().faces().ids().filter(wanted).collect();
        if !goes_on() {
            return None;
        }
        let base = whole.restrict(&faces);
        let longest = |face: FaceId| {
            // The parts of a face stand side by side in the region.
            let own = base.ancestor(face, level);
            let first = layer.region.partition_point(|part| part >> shift < own);
            let parts = layer.region[first..]
                .iter()
                .zip(layer.output_edges.iter().skip(first));
            let parts = parts.take_while(|(part, _)| *part >> shift == own);
            parts.map(|(_, edge)| *edge).fold(f64::INFINITY, f64::min)
        };
        let faces: Vec<FaceId> = base.mesh().faces().ids().collect();
        let (piece, faces) = match is_half {
            true => Plane::of(driver).right_of(driver, Piece::of(&base)),
            false => (Piece::of(&base), faces),
        };
        let faces = faces.into_iter();
        let measures = faces.map(|face| in_all_directions(coarseness * longest(face)));
        refined(driver, piece, &measures.collect(), goes_on)
    }

    /// Refuses maps with sharp boundaries that the layers' meshes cannot follow.
    pub(crate) fn check_boundaries(&self) -> Result<(), StepperError> {
        for (index, spec) in self.stacking.specs.iter().enumerate() {
            if sharp_map(spec).is_none() {
                continue;
            }
            let mut checked: Vec<&LayerPlan> = Vec::new();
            for (layer, pose) in self
                .poses
                .iter()
                .map(|pose| &pose.layers[index])
                .zip(&self.specs)
            {
                // Poses often share a region, and looking for boundaries means splitting all of it
                // anew.
                let is_same = |other: &&LayerPlan| {
                    other.levels == layer.levels
                        && other.region == layer.region
                        && other.output_edges == layer.output_edges
                };
                if !layer.region.is_empty() && !checked.iter().any(is_same) {
                    let pieces = self.layer_pieces((layer, pose.half, 1.0), &mut || true);
                    let (piece, _) = pieces.expect("nothing ends it early");
                    check_boundaries(&self.driver, piece, spec)?;
                    checked.push(layer);
                }
            }
        }
        Ok(())
    }
}

/// Finds out what `poses` ask of `layers` that the posed driver carries.
///
/// `map_size` is the side of the maps in texels.
///
/// # Errors
/// [`StepperError::Setting`] for a value out of range or that is no number, before any work is done;
/// bad materials, a black mask, no layer, a sharp map whose boundaries are nearly everywhere, a motion
/// in a pose: without a body there is nothing to move.
pub fn plan(
    driver: &Arc<Driver>,
    layers: &[LayerSpec],
    poses: &[PoseSpec],
    modelling: &Modelling,
    map_size: u32,
) -> Result<Plan, StepperError> {
    check_modelling(modelling)?;
    check_map_size(map_size)?;
    layers.iter().try_for_each(check_layer)?;
    layers.iter().try_for_each(check_carried)?;
    layers.iter().try_for_each(check_anchors)?;
    layers.iter().try_for_each(check_unslit)?;
    let is_plain = modelling.stack != Stack::Joint
        && layers
            .iter()
            .all(|layer| layer.creases.is_empty() && layer.growths.is_empty());
    check_half(driver, poses, is_plain)?;
    for pose in poses {
        check_pose(driver, pose)?;
        check_motionless(pose)?;
        layers
            .iter()
            .try_for_each(|layer| check_growth(layer, pose))?;
    }
    let region = modelling.region.mask();
    // The region's mask becomes one of every layer's, so that both kinds cut and fade alike.
    let layers: Vec<LayerSpec> = layers.iter().map(|layer| within(layer, region)).collect();
    let mut stacking = Stacking::new(&layers, modelling.stack)?;
    put_under_drawn_lines(driver, modelling.smoothing, &mut stacking);
    let surface = PlanningSurface::new(driver, &stacking, modelling, map_size)?;
    let planned = planned_layers(&surface, &stacking, modelling)?;
    let mut warnings = stacking.warnings(modelling.stack);
    let pose_plan = |pose: &PoseSpec| {
        let mut own = Vec::new();
        let mut pose = surface.pose_plan(&planned, pose, &mut own);
        add_carried_along(&mut pose, &stacking);
        (pose, own)
    };
    let found: Vec<_> = poses.par_iter().map(pose_plan).collect();
    let (poses_planned, of_poses): (Vec<PosePlan>, Vec<_>) = found.into_iter().unzip();
    warnings.extend(of_poses.into_iter().flatten());
    warnings.extend(never_wrinkle_warnings(&poses_planned, planned.len()));
    warnings.extend(never_fold_warnings(&poses_planned, &stacking.specs));
    let plan = Plan {
        poses: poses_planned,
        warnings,
        interior: None,
        planning_levels: surface.levels(),
        driver: Arc::clone(driver),
        modelling: modelling.clone(),
        specs: poses.to_vec(),
        stacking,
        body: None,
        sheet: None,
    };
    // Only a run cuts the meshes, but there an error would come minutes later, with the layer.
    plan.check_boundaries()?;
    Ok(plan)
}

/// The layers that have a mesh of their own, with their waves on every face of `surface`.
fn planned_layers<'a>(
    surface: &PlanningSurface<'_>,
    stacking: &'a Stacking,
    modelling: &Modelling,
) -> Result<Vec<PlannedLayer<'a>>, StepperError> {
    let meshes = stacking.meshes();
    // A layer that moves together with the lowest one has no mesh of its own to plan.
    let layers = stacking.specs.iter().zip(&stacking.simulated).take(meshes);
    let planned = layers.enumerate().map(|(index, (spec, wrinkling))| {
        Ok(PlannedLayer {
            spec,
            wrinkling,
            local: surface.local_wrinkling(spec, wrinkling)?,
            creased: surface.creased_faces(spec),
            points: modelling.points_of(index, meshes),
            is_lowest: index == 0,
        })
    });
    planned.collect()
}

/// Adds to a pose the layer that moves together with the lowest one, where there is one.
pub(crate) fn add_carried_along(pose: &mut PosePlan, stacking: &Stacking) {
    if let (Some(upper), Some(pair)) = (&stacking.joint, stacking.pairs.first()) {
        // The mesh was planned for the finest wave of the pair. What is reported is the wave in
        // which both wrinkle together.
        pose.layers[0].wavelength = stacking.wrinkling[0].wavelength;
        pose.layers[0].critical_strain = stacking.wrinkling[0].critical_strain;
        let carried = pose.layers[0].carried_along(&upper.name, &pair.upper.wrinkling);
        pose.layers.push(carried);
    }
}

/// The layer where the region's painted mask lets it be.
pub(crate) fn within(layer: &LayerSpec, region: Option<&Mask>) -> LayerSpec {
    let mut layer = layer.clone();
    layer.presence.masks.extend(region.cloned());
    layer
}
