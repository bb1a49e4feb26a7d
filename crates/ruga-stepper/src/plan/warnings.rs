//! What the planner tells an artist: what happens, where, whether it matters, and what to do.

use std::sync::OnceLock;

use ruga_blend::{BaseSurface, Driver, PosedSurface};
use ruga_material::CAP_START;
use ruga_mesh::FaceId;

use crate::plan::region::{ACTIVE_FRACTION, PoseStrains};
use crate::plan::surface_measures::{OUTPUT_VERTICES, weighted_quantile};
use crate::skin::place::{ShapeCentres, place_of_faces, shape_words};
use crate::{AppliedStrain, LayerPlan, LayerSpec, Modelling, PosePlan, PoseSpec};

/// Areas below a hundredth of a square centimetre are not worth a warning, m².
const NEGLIGIBLE_AREA: f64 = 1e-6;

/// Squares of a wavelength in which a labyrinth has room for several directions.
const LABYRINTH: f64 = 4.0;

/// Points per wavelength below which a wrinkle is hardly one any more.
const FEWEST_POINTS: f64 = 5.0;

/// Texels per wavelength below which a map cannot hold it.
const FEWEST_TEXELS: f64 = 4.0;

/// Median strain, compression or stretch, beyond which what is posed is not skin any more: skin tears
/// at about as much stretch, and folds under half of that compression.
const NOT_SKIN: f64 = 0.3;

/// Critical strain that no compression reaches, whatever the pose: material numbers in another unit.
const UNBEARABLE: f64 = 1.0;

/// Vertices that no budget will ever allow: their factor alone would fill 40 GB.
const HOPELESS: f64 = 2e7;

/// One pose on the planning surface.
pub(crate) struct PosedPlan<'a> {
    pub(crate) driver: &'a Driver,
    /// Centres of the driver's blend shapes, computed when a warning first names a place.
    pub(crate) shapes: &'a OnceLock<ShapeCentres>,
    pub(crate) surface: &'a BaseSurface,
    pub(crate) rest: &'a PosedSurface,
    pub(crate) pose: &'a PoseSpec,
    pub(crate) modelling: &'a Modelling,
}

impl PosedPlan<'_> {
    /// Adds to `warnings` what the user should know about one layer, of whose faces the pose asks for
    /// `pose_strains`.
    pub(crate) fn warn(
        &self,
        plan: &LayerPlan,
        pose_strains: &PoseStrains,
        warnings: &mut Vec<String>,
    ) {
        let texts = self.layer_warnings(plan, pose_strains);
        let told = texts
            .into_iter()
            .map(|text| format!("pose '{}', layer '{}': {text}", self.pose.name, plan.name));
        warnings.extend(told);
    }

    fn layer_warnings(&self, plan: &LayerPlan, pose_strains: &PoseStrains) -> Vec<String> {
        let applied = plan.applied.unwrap_or_default();
        let folded = self.folded_warning(&applied, pose_strains);
        if plan.active_area == 0.0 {
            let strained = not_skin(self.median_strained(pose_strains), self.pose);
            return folded.into_iter().chain(strained).collect();
        }
        let resolution = resolution_warnings(plan.asked_points, plan.texels_per_wavelength);
        folded
            .into_iter()
            .chain(not_skin(applied.median, self.pose))
            .chain(self.capped_warning((plan, &applied), pose_strains))
            .chain(late_warning(plan))
            .chain(self.smooth_again_warning(plan, pose_strains))
            .chain(self.labyrinth_warning((plan, &applied), pose_strains))
            .chain(resolution)
            .chain(budget_warning((plan, &applied), self.modelling))
            .collect()
    }

    fn folded_warning(
        &self,
        applied: &AppliedStrain,
        pose_strains: &PoseStrains,
    ) -> Option<String> {
        (applied.folded_area > NEGLIGIBLE_AREA).then(|| {
            format!(
                "{:.2} cm2 of the driver fold over or collapse by more than 60 %, {}; they stay as the artist drew them, without wrinkles, and the rest is not affected. To wrinkle them, lower the weight or let the shape keep some width there",
                1e4 * applied.folded_area,
                self.place(pose_strains, &|face| pose_strains.folded[face])
            )
        })
    }

    fn capped_warning(
        &self,
        (plan, applied): (&LayerPlan, &AppliedStrain),
        pose_strains: &PoseStrains,
    ) -> Option<String> {
        let is_capped =
            |face| self.is_active(plan, face) && pose_strains.compression[face] > CAP_START;
        (applied.capped_area > NEGLIGIBLE_AREA).then(|| {
            format!(
                "{:.2} cm2 are compressed by more than 15 %, {}, where real skin folds or doubles its wrinkles. The map can be used there, but holds the wrinkles of 15 to 25 % compression, shallower than the pose asks for; if they look wrong, draw a crease that takes it up along the fold, with `absorb = true`, lower the weight or paint the place black in the region mask",
                1e4 * applied.capped_area,
                self.place(pose_strains, &is_capped)
            )
        })
    }

    /// Warning of wrinkles at an earlier key, on more skin than wrinkles at the last one, that are gone there.
    fn smooth_again_warning(&self, plan: &LayerPlan, pose_strains: &PoseStrains) -> Option<String> {
        let area_where = |test: &dyn Fn(FaceId) -> bool| -> f64 {
            let faces = pose_strains.areas.iter();
            let faces = faces.filter(|&(face, _)| self.is_active(plan, face) && test(face));
            faces.map(|(_, area)| area).sum()
        };
        let is_passing = |face| pose_strains.is_smooth_again(face);
        let passing = area_where(&is_passing);
        let staying =
            area_where(&|face| !is_passing(face) && pose_strains.strain_ratio(face) > 1.0);
        let last = self.pose.keys.last()?;
        (passing > staying.max(plan.wavelength.powi(2))).then(|| {
            format!(
                "{:.1} cm2 wrinkle at an earlier key and are smooth again at key {last}, {}: a blend shape moves its points on straight lines, so that a part that it turns is smaller half way. Where that is not wanted, bake the last key alone, with `keys = [{last:?}]` in the pose, which also takes less time",
                1e4 * passing,
                self.place(pose_strains, &is_passing)
            )
        })
    }

    fn labyrinth_warning(
        &self,
        (plan, applied): (&LayerPlan, &AppliedStrain),
        pose_strains: &PoseStrains,
    ) -> Option<String> {
        let is_labyrinth =
            |face| self.is_active(plan, face) && pose_strains.is_compressed_equally(face);
        (applied.labyrinth_area > LABYRINTH * plan.wavelength.powi(2)).then(|| {
            format!(
                "{:.2} cm2 are compressed about equally from all sides, {}, where wrinkles of real skin meander. Their depth and spacing are right, but the averaging constraints that hold the layer let them run in two crossing directions; if the map shows such squares, set `coupling = \"elastic\"` for this layer",
                1e4 * applied.labyrinth_area,
                self.place(pose_strains, &is_labyrinth)
            )
        })
    }

    fn is_active(&self, plan: &LayerPlan, face: FaceId) -> bool {
        let address = self.surface.ancestor(face, self.surface.levels());
        plan.region.binary_search(&address).is_ok()
    }

    /// Warning of a pose that compresses `area` (m²) on its way that is not compressed at
    /// its keys.
    pub(crate) fn detour_warning(&self, area: f64, pose_strains: &PoseStrains) -> String {
        format!(
            "pose '{}': between rest and its keys {:.1} cm2 are squeezed that are not squeezed at the keys, {}, because a blend shape moves its points on straight lines where a part turns. So that no wrinkle of that squeeze is left in the maps, every key is simulated from its own shape, with the strain growing from none. The maps are right; with several keys it takes longer",
            self.pose.name,
            1e4 * area,
            self.place(pose_strains, &|face| pose_strains.is_detour(face))
        )
    }

    /// Median effective strain where the pose strains the skin by more than the critical strain, either
    /// way; 0 where it does so nowhere.
    fn median_strained(&self, pose_strains: &PoseStrains) -> f64 {
        let is_strained =
            |face: &FaceId| pose_strains.effective[*face].abs() > pose_strains.critical(*face);
        let faces = self.surface.mesh().faces().ids().filter(is_strained);
        let faces: Vec<FaceId> = faces.collect();
        weighted_quantile(&faces, &pose_strains.effective, &pose_strains.areas, 0.5)
    }

    fn place(&self, pose_strains: &PoseStrains, is_in: &dyn Fn(FaceId) -> bool) -> String {
        let shapes = self.shapes.get_or_init(|| ShapeCentres::new(self.driver));
        let place = place_of_faces(
            shapes,
            (self.surface, self.rest),
            &pose_strains.areas,
            is_in,
        );
        // That a pose of one shape does something where that shape moves the skin is no news.
        let mut weights = self.pose.weights.iter();
        match (weights.next(), weights.next()) {
            (Some((shape, _)), None) => {
                let name = self.driver.shape_names().nth(shape);
                place.replace(&shape_words(name.unwrap_or_default()), "")
            }
            _ => place,
        }
    }
}

/// Warnings of creases that no pose folds, one for each layer.
pub(crate) fn never_fold_warnings(poses: &[PosePlan], layers: &[LayerSpec]) -> Vec<String> {
    let layers = layers.iter().enumerate();
    let warning = |(index, layer): (usize, &LayerSpec)| {
        let folds = |number: usize| {
            let mut plans = poses.iter().map(|pose| &pose.layers[index]);
            plans.any(|plan| plan.creases.get(number) == Some(&true))
        };
        let creases = layer.creases.iter().enumerate();
        let names = creases.filter(|(number, _)| !folds(*number));
        let names: Vec<String> = names
            .map(|(_, crease)| format!("'{}'", crease.name))
            .collect();
        (!names.is_empty()).then(|| {
            format!(
                "layer '{}': no pose folds {}: none draws these creases or compresses the skin there enough, or a mask leaves that skin out",
                layer.name,
                names.join(", ")
            )
        })
    };
    layers.filter_map(warning).collect()
}

/// Warnings of the first `layers` layers of `poses` that wrinkle in none of them: a few words for each,
/// however many poses there are. Where some poses wrinkle a layer and others do not, that is as it
/// should be.
pub(crate) fn never_wrinkle_warnings(poses: &[PosePlan], layers: usize) -> Vec<String> {
    (0..layers)
        .filter_map(|layer| {
            let of_poses = poses.iter();
            let of_poses: Vec<_> = of_poses
                .map(|pose| (pose.name.as_str(), &pose.layers[layer]))
                .collect();
            never_wrinkles(&of_poses)
        })
        .collect()
}

/// Warning of a layer with its name and plan in every pose, if it wrinkles in none.
fn never_wrinkles(poses: &[(&str, &LayerPlan)]) -> Option<String> {
    let (_, plan) = poses.first()?;
    let (name, critical) = (&plan.name, 100.0 * plan.critical_strain);
    if plan.critical_strain > UNBEARABLE {
        return Some(format!(
            "layer '{name}' wrinkles only beyond {critical:.0} % compression, which no skin bears. Look at its numbers: `young` is in pascals (0.8 MPa is 0.8e6), `thickness` in metres (0.7 mm is 0.7e-3)"
        ));
    }
    if poses.iter().any(|(_, plan)| plan.active_area > 0.0) {
        return None;
    }
    let largest = |plan: &LayerPlan| plan.applied.map(|applied| applied.largest);
    let strains = poses
        .iter()
        .filter_map(|(pose, plan)| Some((*pose, largest(plan)?)));
    let strains = strains.filter(|(_, strain)| strain.is_finite());
    let (pose, strain) = strains.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let nowhere = match poses.len() {
        1 => format!("layer '{name}' does not wrinkle in pose '{pose}'"),
        count => format!("layer '{name}' wrinkles in none of {count} poses"),
    };
    let most = match poses.len() {
        1 => "the pose compresses the skin".to_owned(),
        _ => format!("pose '{pose}', which compresses the skin most, does so"),
    };
    let reached = match strain {
        strain if strain <= 0.0 => "nowhere".to_owned(),
        strain if strain > ACTIVE_FRACTION * plan.critical_strain => format!(
            "as much only in spots that are smaller than a wrinkle of {:.1} mm",
            1e3 * plan.wavelength
        ),
        strain => format!("by at most {:.1} %", 100.0 * strain),
    };
    Some(format!(
        "{nowhere}: it wrinkles from {critical:.1} % compression on, and {most} {reached}. Raise the weights; or let it wrinkle earlier, with a lower `critical_strain`, a stiffer layer or a softer `[substrate]`"
    ))
}

/// Warning of a pose that deforms half of what it deforms by more than skin bears, where half
/// of it has at least the effective strain `median`.
fn not_skin(median: f64, pose: &PoseSpec) -> Option<String> {
    if median.abs() <= NOT_SKIN {
        return None;
    }
    let change = match median > 0.0 {
        true => "compressed",
        false => "stretched",
    };
    // Strain grows about in proportion to the weights.
    let factor = CAP_START / median.abs();
    let advice = match pose.weights.iter().collect::<Vec<_>>().as_slice() {
        [(_, weight)] => format!("a weight of {:.1} instead of {weight}", factor * weight),
        _ => format!("{factor:.1} times these weights"),
    };
    Some(format!(
        "half of the skin that the pose moves is {change} by more than {:.0} %; this is not skin any more, which bears about 15 %. The maps will not look like skin: did you mean {advice}?",
        100.0 * median.abs()
    ))
}

fn late_warning(plan: &LayerPlan) -> Option<String> {
    (plan.critical_strain > CAP_START && plan.critical_strain <= UNBEARABLE).then(|| {
        format!(
            "the layer's critical strain of {:.1} % is beyond 15 %, from where on compression counts less and less: it wrinkles late or not at all. Take a lower `critical_strain`, or a stiffer layer",
            100.0 * plan.critical_strain
        )
    })
}

/// Warnings of too few edges or texels per wavelength.
pub(crate) fn resolution_warnings(asked_points: f64, texels: f64) -> Vec<String> {
    let mut warnings = Vec::new();
    if asked_points < FEWEST_POINTS {
        warnings.push(format!(
            "remesh.points_per_wavelength asks for {asked_points:.1}: below {FEWEST_POINTS:.0} wrinkles come out several per cent too high; `--quality draft` has 6"
        ));
    }
    if texels < FEWEST_TEXELS {
        warnings.push(format!(
            "{texels:.1} texels per wavelength are too few; bake larger maps or enlarge the UV islands"
        ));
    }
    warnings
}

/// Warning where the budget does not allow the mesh that was asked for.
fn budget_warning(
    (plan, applied): (&LayerPlan, &AppliedStrain),
    modelling: &Modelling,
) -> Option<String> {
    let (reached, asked) = (plan.points_per_wavelength, plan.asked_points);
    // The planner leaves edges up to a tenth too long by itself, because the next split would cost
    // four times as much.
    if reached >= 0.9 * asked {
        return None;
    }
    let effect = match reached < FEWEST_POINTS {
        true => "too few for the wrinkles to be right",
        false => "wrinkles come out a few per cent too high",
    };
    if plan.needed <= modelling.vertex_budget as f64 {
        // The output mesh bounds the fitted one.
        return Some(format!(
            "the layer gets {reached:.1} of {asked} points per wavelength: the artist's mesh is not split further, because results would need more than {} vertices: {effect}. Raise `driver.vertex_budget`, or simulate less skin with a mask",
            OUTPUT_VERTICES * modelling.vertex_budget as f64
        ));
    }
    Some(format!(
        "{asked} points per wavelength need about {:.0} vertices, and the vertex budget of {} stops refinement at {reached:.1}: {effect}. {}",
        plan.needed,
        modelling.vertex_budget,
        remedy((plan, applied), modelling)
    ))
}

/// Change that brings the vertices under the budget.
fn remedy((plan, applied): (&LayerPlan, &AppliedStrain), modelling: &Modelling) -> String {
    let area = 1e4 * plan.active_area;
    if plan.needed > HOPELESS {
        return format!(
            "No budget is enough for waves of {:.3} mm on {area:.1} cm2: check the unit of the mesh and the layer's thickness, or paint a small region mask",
            1e3 * plan.wavelength
        );
    }
    let fraction = (modelling.vertex_budget as f64 / plan.needed).min(1.0);
    // A draft asks for six points.
    let quality = match plan.points_per_wavelength >= 6.0 {
        true => "`--quality draft` fits the budget",
        false => "`--quality draft` does not fit the budget either",
    };
    format!(
        "Raise `driver.vertex_budget`, paint a region mask that leaves at most {:.2} of the {area:.2} cm2 that are simulated, or raise the critical strain above {:.1} %, so that half as much of the pose wrinkles; {quality}",
        fraction * area,
        100.0 * applied.median.max(plan.critical_strain)
    )
}
