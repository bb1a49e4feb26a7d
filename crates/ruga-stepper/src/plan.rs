//! What will be modelled, where, how fine and at what cost; nothing is simulated here.

use std::cell::OnceCell;

use nalgebra::{Matrix3, Vector3};
use ruga_blend::{BaseSurface, Driver, PosedSurface};
use ruga_material::{CAP_START, StackPair, Wrinkling};
use ruga_mesh::{FaceId, Id, PerFace};
use ruga_remesh::{FaceDriver, Refinement};

use crate::adaptivity::{COARSEST, aspect};
use crate::below::Seat;
use crate::layer_setup::layer_surface;
use crate::local_skin::wrinkling_on_face;
use crate::place::ShapeCentres;
use crate::plan_cost::{GRADING, Load, cost, factorisations};
use crate::plan_warnings::PosedPlan;
use crate::region::{ACTIVE_SHARE, Demand};
use crate::skin_energy::UpperShell;
use crate::skin_mesh::{check_boundaries, sharp_map};
use crate::stacking::Stacking;
use crate::validation::{PlannedFor, check_layer, check_map_size, check_modelling, check_pose};
use crate::{Coupling, EdgeLimits, LayerSpec, Mask, Modelling, PoseSpec, Stack, StepperError};

/// Faces of the planning surface above which it is not subdivided further: on a face of 18 thousand
/// triangles a million say the same areas as 300 thousand to 1 %, in five times the time.
pub(crate) const MAX_PLANNING_FACES: usize = 400_000;
/// Splits of one face in four; ten make a metre a millimetre.
pub(crate) const MAX_LEVELS: u32 = 10;
/// Base edges stay below this share of the wavelength, or the artist's facets imprint.
const FACET_SHARE: f64 = 1.0 / 3.0;
/// Loads, as shares of the last key, at which the way to the keys is looked at.
const PASSING: [f64; 3] = [0.25, 0.5, 0.75];
/// Edges beside the wrinkles over those across them, where a fitted mesh grows coarser.
const GRADED: f64 = 3.0;
/// Vertices of the uniform mesh that a fitted one may be handed out on, in vertex budgets.
pub(crate) const HANDED_OUT: f64 = 4.0;

/// What will be modelled.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Per layer, its wavelength, critical strain and coupling stiffnesses.
    pub wrinkling: Vec<Wrinkling>,
    /// Per pose, what is simulated.
    pub poses: Vec<PosePlan>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Every layer with the one above it: what the two would do together.
    pub pairs: Vec<StackPair>,
    pub(crate) specs: Vec<LayerSpec>,
    /// What is solved at once with its finest wave and its first onset.
    pub(crate) simulated: Vec<Wrinkling>,
    pub(crate) seats: Vec<Seat>,
    /// The layer that moves together with the lowest one.
    pub(crate) joint: Option<UpperShell>,
    pub(crate) planning_levels: u32,
    pub(crate) made_for: PlannedFor,
}

/// One pose's part of the plan.
#[derive(Clone, Debug)]
pub struct PosePlan {
    /// Name of the pose.
    pub name: String,
    /// How its load steps lead to its keys.
    pub path: LoadPath,
    /// Bottom first.
    pub layers: Vec<LayerPlan>,
}

/// How load steps lead from rest to a pose's keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LoadPath {
    /// The weights grow; one sequence passes all keys.
    #[default]
    Weight,
    /// The driver stands at a key while the strain grows from none to the key's; each key has a
    /// sequence of its own.
    ///
    /// For poses that on straight lines pass through strains that none of their keys has.
    Strain,
}

impl Plan {
    /// Whether the layers' meshes can follow the sharp boundaries of their maps.
    fn check_boundaries(&self, driver: &Driver, modelling: &Modelling) -> Result<(), StepperError> {
        for (index, spec) in self.specs.iter().enumerate() {
            if sharp_map(spec).is_none() {
                continue;
            }
            let mut checked: Vec<&LayerPlan> = Vec::new();
            for layer in self.poses.iter().map(|pose| &pose.layers[index]) {
                let is_same = |other: &&LayerPlan| {
                    other.levels == layer.levels && other.region == layer.region
                };
                if !layer.region.is_empty() && !checked.iter().any(is_same) {
                    let surface = layer_surface(driver, self, layer, modelling, &mut || true)
                        .expect("nothing ends it early");
                    check_boundaries(driver, &surface, spec)?;
                    checked.push(layer);
                }
            }
        }
        Ok(())
    }

    /// How many layers have a mesh of their own.
    pub(crate) fn meshes(&self) -> usize {
        match self.joint {
            Some(_) => 1,
            None => self.specs.len(),
        }
    }

    /// Share of the bending strain of what lies below that layer number `layer` feels, by the scene or
    /// by what the stack means.
    ///
    /// # Panics
    /// If there is no layer of that number.
    pub fn bending_transfer(&self, layer: usize) -> f64 {
        self.seats[layer].bending_transfer
    }

    /// The file's triangles that have a simulated part in pose number `pose`, ascending.
    ///
    /// # Panics
    /// If there is no pose of that number, or `driver` is another than was planned for and has
    /// fewer faces.
    pub fn active_triangles(&self, driver: &Driver, pose: usize) -> Vec<u32> {
        let shift = 2 * self.planning_levels;
        let layers = self.poses[pose].layers.iter();
        let mut triangles: Vec<u32> = layers
            .flat_map(|layer| &layer.region)
            .map(|face| driver.triangles()[FaceId((face >> shift) as u32)])
            .collect();
        triangles.sort_unstable();
        triangles.dedup();
        triangles
    }
}

/// One layer in one pose.
#[derive(Clone, Debug)]
pub struct LayerPlan {
    /// Name of the layer.
    pub name: String,
    /// Critical wavelength, m.
    pub wavelength: f64,
    /// Critical strain.
    pub critical_strain: f64,
    /// What paint and natural unevenness make of them over the active area; `None` where all of it is
    /// the same, or nothing is simulated.
    pub painted: Option<PaintedRanges>,
    /// Median over the active area of the largest effective strain of the driver.
    pub strain_median: f64,
    /// Its 99th percentile.
    pub strain_p99: f64,
    /// Area that is simulated, m²; zero where the layer cannot wrinkle.
    pub active_area: f64,
    /// Active area compressed beyond 15 %, where the rest metric is capped, m².
    pub capped_area: f64,
    /// Area left on the driver because the pose folds or collapses it, m².
    pub folded_area: f64,
    /// Vertices, estimated.
    pub vertices: usize,
    /// Times the driver's faces are split in four.
    pub levels: u32,
    /// Edges per wavelength that this gives (median over the active area).
    pub points_per_wavelength: f64,
    /// Curvature measure `C / (R² K0)` at the 95th percentile of the rest curvature. By this share
    /// a foundation alone would delay the onset; the balance with the surface below removes the
    /// delay, and what is left near 1 is that the surface bends within one wavelength.
    pub chi: f64,
    /// Texels of the map per wavelength (median over the active area).
    pub texels_per_wavelength: f64,
    /// Expected time of the pose on one core, s.
    pub seconds: f64,
    /// Expected memory, bytes.
    pub memory: f64,
    /// Edges per wavelength asked for.
    pub(crate) asked_points: f64,
    /// Vertices that would meet what was asked for.
    pub(crate) needed: f64,
    /// Area where low-pass rows decide on the directions of a labyrinth, m².
    pub(crate) labyrinth_area: f64,
    pub(crate) region: Vec<u64>,
}

/// Range of a layer's properties over the active area of a pose, without the extreme hundredths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintedRanges {
    /// Critical wavelength, m.
    pub wavelength: [f64; 2],
    /// Critical strain.
    pub critical_strain: [f64; 2],
    /// Thickness, m.
    pub thickness: [f64; 2],
}

impl LayerPlan {
    /// A layer that is solved together with this one, on its mesh; the cost stands with this one.
    fn carried_along(&self, name: &str, numbers: &Wrinkling) -> Self {
        Self {
            name: name.to_owned(),
            wavelength: numbers.wavelength,
            critical_strain: numbers.critical_strain,
            seconds: 0.0,
            memory: 0.0,
            region: Vec::new(),
            ..self.clone()
        }
    }
}

/// Finds out what `poses` ask of `layers`.
///
/// `map_size` is the side of the maps in texels.
///
/// # Errors
/// [`StepperError::Setting`] for a value out of range or that is no number, before any work is done;
/// bad materials, a black mask, no layer, a sharp map whose boundaries are nearly everywhere.
pub fn plan(
    driver: &Driver,
    layers: &[LayerSpec],
    poses: &[PoseSpec],
    modelling: &Modelling,
    map_size: u32,
) -> Result<Plan, StepperError> {
    check_modelling(modelling)?;
    check_map_size(map_size)?;
    layers.iter().try_for_each(check_layer)?;
    poses.iter().try_for_each(|pose| check_pose(driver, pose))?;
    let masked = modelling.region.mask();
    let layers: Vec<LayerSpec> = layers.iter().map(|layer| within(layer, masked)).collect();
    let stacking = Stacking::new(&layers, modelling.stack)?;
    let Stacking {
        specs: layers,
        simulated: wrinkling,
        ..
    } = &stacking;
    let Some(finest) = wrinkling.iter().map(|w| w.wavelength).reduce(f64::min) else {
        return Err(StepperError::NoLayer);
    };
    let planning = PlanningSurface::new(driver, modelling, layers, finest)?;
    // A layer that moves together with the lowest one has no mesh of its own.
    let simulated = match stacking.joint {
        Some(_) => 1,
        None => layers.len(),
    };
    let planned = layers
        .iter()
        .zip(wrinkling)
        .take(simulated)
        .enumerate()
        .map(|(index, (spec, numbers))| {
            let local = planning.local_wrinkling(spec, numbers)?;
            Ok(PlannedLayer {
                spec,
                numbers,
                local,
                points: modelling.points_of(index, simulated),
                is_lowest: index == 0,
            })
        })
        .collect::<Result<Vec<_>, StepperError>>()?;
    let mut warnings = stacking.warnings(modelling.stack);
    let mut pose_plans: Vec<PosePlan> = poses
        .iter()
        .map(|pose| planning.pose_plan(driver, &planned, pose, modelling, map_size, &mut warnings))
        .collect();
    if let (Some(upper), Some(pair)) = (&stacking.joint, stacking.pairs.first()) {
        for pose in &mut pose_plans {
            pose.layers[0].wavelength = stacking.wrinkling[0].wavelength;
            pose.layers[0].critical_strain = stacking.wrinkling[0].critical_strain;
            let carried = pose.layers[0].carried_along(&upper.name, &pair.upper.wrinkling);
            pose.layers.push(carried);
        }
    }
    let plan = Plan {
        joint: stacking.joint,
        wrinkling: stacking.wrinkling,
        simulated: stacking.simulated,
        pairs: stacking.pairs,
        specs: stacking.specs,
        seats: stacking.seats,
        poses: pose_plans,
        warnings,
        planning_levels: planning.surface.levels(),
        made_for: PlannedFor::new(driver, poses, modelling),
    };
    plan.check_boundaries(driver, modelling)?;
    Ok(plan)
}

/// The layer where the region's painted mask lets it be.
pub(crate) fn within(layer: &LayerSpec, region: Option<&Mask>) -> LayerSpec {
    let mut layer = layer.clone();
    layer.presence.masks.extend(region.cloned());
    layer
}

/// A layer with its critical wave, by itself and on every face of the planning surface.
pub(crate) struct PlannedLayer<'a> {
    pub(crate) spec: &'a LayerSpec,
    pub(crate) numbers: &'a Wrinkling,
    pub(crate) local: PerFace<Wrinkling>,
    /// Edges per wavelength asked for.
    pub(crate) points: f64,
    /// Whether it lies on the driver.
    pub(crate) is_lowest: bool,
}

/// The driver, or what a mask leaves of it, subdivided finely enough to measure strain on.
struct PlanningSurface {
    surface: BaseSurface,
    rest: PosedSurface,
    /// Mean edge of every face, m.
    edges: PerFace<f64>,
    /// Largest normal curvature along the edges of every face, 1/m.
    curvatures: PerFace<f64>,
    /// Texels per metre at size 1.
    uv_density: PerFace<f64>,
    /// Of the driver's blend shapes, once a place has to be named.
    shapes: OnceCell<ShapeCentres>,
}

impl PlanningSurface {
    fn new(
        driver: &Driver,
        modelling: &Modelling,
        layers: &[LayerSpec],
        wavelength: f64,
    ) -> Result<Self, StepperError> {
        let topology = driver.topology();
        let may_be_on = |face: &FaceId| {
            let corners = &driver.uvs()[*face];
            layers.iter().any(|layer| layer.presence.touches(corners))
        };
        let faces: Vec<FaceId> = topology.faces().ids().filter(may_be_on).collect();
        let mut lengths: Vec<f64> = faces
            .iter()
            .flat_map(|&face| {
                let [a, b, c] = topology.faces()[face].map(|v| driver.rest()[v.index()]);
                [(b - a).norm(), (c - b).norm(), (a - c).norm()]
            })
            .collect();
        if lengths.is_empty() {
            return Err(StepperError::BlackMask {
                layer: layers[0].name.clone(),
            });
        }
        lengths.sort_by(f64::total_cmp);
        let long = lengths[(lengths.len() - 1) * 95 / 100];
        let split = BaseSurface::split_count(driver, &faces);
        let mut levels = 0;
        while long / f64::from(1u32 << levels) > FACET_SHARE * wavelength
            && (split << (2 * (levels + 1))) <= MAX_PLANNING_FACES
        {
            levels += 1;
        }
        let surface = BaseSurface::new(driver, &faces, levels, modelling.smoothing);
        let rest = surface.pose(driver.rest());
        let planning = Self {
            edges: per_face(&surface, |corners, _| mean_edge(corners), &rest),
            curvatures: per_face(&surface, curvature, &rest),
            uv_density: uv_density(&surface, &rest),
            shapes: OnceCell::new(),
            surface,
            rest,
        };
        planning.check_masks(layers)?;
        Ok(planning)
    }

    /// How the layer wrinkles on every face, by its map and its variation.
    fn local_wrinkling(
        &self,
        layer: &LayerSpec,
        nominal: &Wrinkling,
    ) -> Result<PerFace<Wrinkling>, StepperError> {
        let faces = self.surface.mesh().faces().as_slice().iter();
        let uvs = self.surface.uvs().as_slice().iter();
        uvs.zip(faces)
            .map(|(uvs, corners)| {
                let corners = corners.map(|v| self.rest.positions[v.index()]);
                wrinkling_on_face(layer, nominal, (uvs, corners))
            })
            .collect()
    }

    /// Whether every layer is somewhere on the mesh.
    fn check_masks(&self, layers: &[LayerSpec]) -> Result<(), StepperError> {
        let uvs = self.surface.uvs().as_slice();
        let is_nowhere = |layer: &&LayerSpec| {
            let mut centres = uvs.iter().map(|[a, b, c]| (a + b + c) / 3.0);
            !centres.any(|centre| layer.presence.covers(centre))
        };
        layers.iter().find(is_nowhere).map_or(Ok(()), |layer| {
            Err(StepperError::BlackMask {
                layer: layer.name.clone(),
            })
        })
    }

    fn pose_plan(
        &self,
        driver: &Driver,
        layers: &[PlannedLayer<'_>],
        pose: &PoseSpec,
        modelling: &Modelling,
        map_size: u32,
        warnings: &mut Vec<String>,
    ) -> PosePlan {
        let posed = |load: f64| self.surface.pose(&driver.pose(&pose.weights.scaled(load)));
        let keys: Vec<PosedSurface> = pose.keys.iter().map(|&key| posed(key)).collect();
        let last = pose.keys.iter().copied().fold(0.0, f64::max);
        let passing = PASSING.map(|share| (share, posed(share * last)));
        let mut demands: Vec<Demand> = layers
            .iter()
            .map(|layer| Demand::new(&self.surface, &self.rest, &keys, &passing, layer))
            .collect();
        let about = PosedPlan {
            driver,
            shapes: &self.shapes,
            surface: &self.surface,
            rest: &self.rest,
            pose,
            modelling,
        };
        let path = load_path(&demands, layers, &about, warnings);
        if path == LoadPath::Weight {
            demands.iter_mut().for_each(Demand::exclude_passing_folds);
        }
        let layers = layers
            .iter()
            .zip(&demands)
            .map(|(layer, demand)| {
                let plan = self.layer_plan(layer, demand, (pose, path), modelling, map_size);
                about.warn(&plan, demand, warnings);
                plan
            })
            .collect();
        PosePlan {
            name: pose.name.clone(),
            path,
            layers,
        }
    }

    fn layer_plan(
        &self,
        layer: &PlannedLayer<'_>,
        demand: &Demand,
        (pose, path): (&PoseSpec, LoadPath),
        modelling: &Modelling,
        map_size: u32,
    ) -> LayerPlan {
        let PlannedLayer {
            spec,
            numbers,
            local,
            points: asked,
            is_lowest,
        } = layer;
        let waves = local.as_slice().iter().map(|numbers| numbers.wavelength);
        let longest = waves.fold(0.0, f64::max);
        let where_to = (&modelling.region, &spec.presence);
        let active = demand.active_faces(&self.surface, &self.rest, where_to, longest);
        let quantile = |field: &PerFace<f64>, share: f64| {
            weighted_quantile(&active, field, &demand.areas, share)
        };
        let area_where = |test: &dyn Fn(FaceId) -> bool| -> f64 {
            let areas = active
                .iter()
                .filter(|&&f| test(f))
                .map(|&f| demand.areas[f]);
            // Not `sum`, which makes -0 of nothing.
            areas.fold(0.0, |sum, area| sum + area)
        };
        let (median, long) = (quantile(&self.edges, 0.5), quantile(&self.edges, 0.95));
        let planned = self.surface.levels();
        let faces_at =
            |levels: u32| active.len() as f64 * 4f64.powi(levels as i32 - planned as i32);
        let edges_at = |levels: u32| {
            let split = 2f64.powi(levels as i32 - planned as i32);
            (median / split, long / split)
        };
        let wavelengths = local.as_slice().iter().map(|numbers| numbers.wavelength);
        let wavelengths: PerFace<f64> = wavelengths.collect();
        let shortest = match active.is_empty() {
            true => numbers.wavelength,
            false => quantile(&wavelengths, 0.05),
        };
        let longest = Some(FACET_SHARE * shortest);
        let levels = needed_levels((shortest / asked, longest), modelling, faces_at, edges_at);
        let vertices_of = |faces: f64| 0.5 * faces + faces.sqrt();
        let uniform_points = shortest / edges_at(levels).0;
        let (needed, points) = match modelling.remesh {
            Some(limits) => {
                let faces = {
                    let skin = (&wavelengths, spec.material.poisson);
                    fitted_faces(&active, demand, skin, &limits, *asked)
                };
                let needed = GRADING * vertices_of(faces);
                let short = (modelling.vertex_budget as f64 / needed).min(1.0).sqrt();
                let points = asked * short;
                (needed, points.min(uniform_points))
            }
            // Refinement goes in steps of four.
            None if uniform_points < 0.9 * asked => {
                (4.0 * vertices_of(faces_at(levels)), uniform_points)
            }
            None => (vertices_of(faces_at(levels)), uniform_points),
        };
        let vertices = match modelling.remesh {
            Some(_) => needed.min(modelling.vertex_budget as f64),
            None => vertices_of(faces_at(levels)),
        } as usize;
        // Two layers on one mesh have twice the unknowns.
        let unknowns = match modelling.stack {
            Stack::Joint => 2 * vertices,
            Stack::Nominal | Stack::Composite => vertices,
        };
        let handed_out = vertices_of(faces_at(levels));
        let strain = quantile(&demand.effective, 0.99);
        let curvature = quantile(&self.curvatures, 0.95);
        let lowest = (*is_lowest && !active.is_empty()).then(|| Load {
            onset: quantile(&demand.onsets(path), 0.01),
            bend: numbers.wavelength * curvature,
            spread: (quantile(&wavelengths, 0.95) / shortest).max(1.0),
        });
        let work = factorisations(lowest, pose, path);
        let (seconds, memory) = cost(unknowns, handed_out, map_size, work);
        LayerPlan {
            name: spec.name.clone(),
            wavelength: numbers.wavelength,
            critical_strain: numbers.critical_strain,
            painted: painted_ranges(spec, &active, local, &demand.areas),
            strain_median: quantile(&demand.effective, 0.5),
            strain_p99: strain,
            active_area: area_where(&|_| true),
            capped_area: area_where(&|f| demand.compression[f] > CAP_START),
            folded_area: demand
                .folded
                .iter()
                .filter(|(_, folded)| **folded)
                .map(|(f, _)| demand.areas[f])
                .fold(0.0, |sum, area| sum + area),
            vertices: if active.is_empty() { 0 } else { vertices },
            levels,
            points_per_wavelength: points,
            asked_points: *asked,
            needed,
            labyrinth_area: match spec.coupling {
                Coupling::Elastic => 0.0,
                Coupling::Hybrid | Coupling::Constraint | Coupling::Spectral => {
                    area_where(&|f| demand.is_pressed_equally(f))
                }
            },
            chi: numbers.curvature_measure(1.0 / curvature),
            texels_per_wavelength: quantile(&self.uv_density, 0.5) * f64::from(map_size) * shortest,
            seconds,
            memory,
            region: active
                .iter()
                .map(|&face| self.surface.ancestor(face, planned))
                .collect(),
        }
    }
}

/// What paint and variation make of a layer over the active faces.
fn painted_ranges(
    spec: &LayerSpec,
    active: &[FaceId],
    local: &PerFace<Wrinkling>,
    areas: &PerFace<f64>,
) -> Option<PaintedRanges> {
    if active.is_empty() || (spec.map.is_none() && spec.variation.is_none()) {
        return None;
    }
    let range = |value: fn(&Wrinkling) -> f64| {
        let field: PerFace<f64> = local.as_slice().iter().map(value).collect();
        [0.01, 0.99].map(|share| weighted_quantile(active, &field, areas, share))
    };
    Some(PaintedRanges {
        wavelength: range(|numbers| numbers.wavelength),
        critical_strain: range(|numbers| numbers.critical_strain),
        thickness: range(|numbers| {
            (12.0 * numbers.bending_stiffness / numbers.membrane_stiffness).sqrt()
        }),
    })
}

/// Triangles of a mesh fitted to what a pose asks for.
///
/// Where the layer wrinkles, edges across the wrinkles have the asked share of a wavelength, along
/// them they are longer by the aspect, unless it wrinkles that way too; elsewhere they grow towards
/// half a wavelength.
fn fitted_faces(
    active: &[FaceId],
    demand: &Demand,
    (wavelengths, poisson): (&PerFace<f64>, f64),
    limits: &EdgeLimits,
    points: f64,
) -> f64 {
    let refinement = Refinement {
        points_per_wavelength: points,
        ..Refinement::default()
    };
    let per_area = |face: FaceId| {
        let wavelength = wavelengths[face];
        let longest = (COARSEST * wavelength).min(limits.max_edge);
        let across = (wavelength / points).max(limits.min_edge);
        let (across, along) = match demand.demand(face) > ACTIVE_SHARE {
            true => {
                let driver = FaceDriver {
                    compression: Matrix3::zeros(),
                    wavelength,
                    critical_strain: demand.critical(face),
                    poisson,
                };
                let [first, second] = demand.principal[face];
                let size = driver.wrinkle_size(second, first, &refinement);
                let along = (aspect(limits, points) * across).min(longest);
                (across, along.min(size.sqrt().recip()).max(across))
            }
            false => (GRADED * across, GRADED * across),
        };
        4.0 / (3f64.sqrt() * across.min(longest) * along.min(longest))
    };
    active
        .iter()
        .map(|&face| demand.areas[face] * per_area(face))
        .sum()
}

/// Chooses the path of a pose, and says so where it is not the plain one.
fn load_path(
    demands: &[Demand],
    layers: &[PlannedLayer<'_>],
    about: &PosedPlan<'_>,
    warnings: &mut Vec<String>,
) -> LoadPath {
    let detours = demands.iter().zip(layers);
    let detours = detours.map(|(demand, layer)| (demand.detour(layer.numbers.wavelength), demand));
    let largest = detours.max_by(|a, b| a.0.total_cmp(&b.0));
    let Some((area, demand)) = largest.filter(|(area, _)| *area > 0.0) else {
        return LoadPath::Weight;
    };
    warnings.push(about.detour_warning(area, demand));
    LoadPath::Strain
}

/// Splits until the median edge meets the target (m) and few edges are far off or longer than facets
/// may be (m), or the budget is spent.
///
/// `faces_at` and `edges_at` (median and 95th percentile, m) say what a number of splits gives.
pub(crate) fn needed_levels(
    (target, longest): (f64, Option<f64>),
    modelling: &Modelling,
    faces_at: impl Fn(u32) -> f64,
    edges_at: impl Fn(u32) -> (f64, f64),
) -> u32 {
    // A tenth of slack: the next split would quadruple the cost for little.
    let is_coarse = |levels: u32| {
        let (median, long) = edges_at(levels);
        let is_faceted = longest.is_some_and(|longest| long > longest);
        median > 1.1 * target || long > 1.65 * target || is_faceted
    };
    // A fitted mesh is handed out on the uniform one, which costs little.
    let vertices = match modelling.remesh {
        Some(_) => HANDED_OUT * modelling.vertex_budget as f64,
        None => modelling.vertex_budget as f64,
    };
    let budget = 2.0 * vertices;
    let mut levels = 0;
    while is_coarse(levels) && levels < MAX_LEVELS && faces_at(levels + 1) <= budget {
        levels += 1;
    }
    levels
}

fn mean_edge([a, b, c]: [Vector3<f64>; 3]) -> f64 {
    ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0
}

fn curvature(corners: [Vector3<f64>; 3], normals: [Vector3<f64>; 3]) -> f64 {
    (0..3)
        .map(|i| {
            let j = (i + 1) % 3;
            (normals[j] - normals[i]).norm() / (corners[j] - corners[i]).norm()
        })
        .fold(0.0, f64::max)
}

pub(crate) fn per_face(
    surface: &BaseSurface,
    measure: impl Fn([Vector3<f64>; 3], [Vector3<f64>; 3]) -> f64,
    rest: &PosedSurface,
) -> PerFace<f64> {
    surface
        .mesh()
        .faces()
        .as_slice()
        .iter()
        .map(|face| {
            let corners = face.map(|v| rest.positions[v.index()]);
            measure(corners, face.map(|v| rest.normals[v.index()]))
        })
        .collect()
}

/// Share of the texture's side per metre of every face.
pub(crate) fn uv_density(surface: &BaseSurface, rest: &PosedSurface) -> PerFace<f64> {
    surface
        .mesh()
        .faces()
        .iter()
        .map(|(face, vertices)| {
            let [a, b, c] = vertices.map(|v| rest.positions[v.index()]);
            let [p, q, r] = surface.uvs()[face];
            let area = (b - a).cross(&(c - a)).norm();
            let uv = (q - p).perp(&(r - p)).abs();
            (uv / area).sqrt()
        })
        .collect()
}

/// Value of a field below which so large a share of the faces' weights lies.
pub(crate) fn weighted_quantile(
    faces: &[FaceId],
    field: &PerFace<f64>,
    weights: &PerFace<f64>,
    share: f64,
) -> f64 {
    let mut pairs: Vec<(f64, f64)> = faces.iter().map(|&f| (field[f], weights[f])).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = pairs.iter().map(|p| p.1).sum();
    let mut sum = 0.0;
    for (value, weight) in &pairs {
        sum += weight;
        if sum >= share * total {
            return *value;
        }
    }
    0.0
}
