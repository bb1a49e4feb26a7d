//! The surface on which a plan compares poses with layers.

mod planned_faces;

use std::sync::OnceLock;

use nalgebra::Vector2;
use rayon::prelude::*;
use ruga_blend::{BaseSurface, Driver, PosedSurface};
use ruga_material::{CAP_START, Wrinkling};
use ruga_mesh::{FaceId, Id, PerFace, VertexId, edge_distances};
use ruga_remesh::SizeLimits;

use crate::plan::creased_faces::CreasedFaces;
use crate::plan::fitted_faces::{creased_vertices, fitted_faces, graded_vertices};
use crate::plan::pose_plan::PlannedLayer;
use crate::plan::region::PoseStrains;
use crate::plan::skin_cost::{GRADING, Load, cost, factorisations};
use crate::plan::stacking::Stacking;
use crate::plan::surface_measures::{
    MAX_PLANNING_FACES, curvature, faces_within, mean_edge, needed_levels, output_coarseness,
    painted_ranges, per_face, uv_density, weighted_quantile,
};
use crate::plan::warnings::PosedPlan;
use crate::run::adaptivity::COARSEST;
use crate::skin::local_skin::wrinkling_on_face;
use crate::skin::mirror::Plane;
use crate::skin::place::ShapeCentres;
use crate::skin::skin_mesh::OUTPUT_SLACK;
use crate::{
    AppliedStrain, Coupling, LayerPlan, LayerSpec, LoadPath, Modelling, PosePlan, PoseSpec, Stack,
    StepperError,
};

pub use planned_faces::{PlannedFace, Treatment};

/// Base edges stay below this fraction of the wavelength, or the artist's facets imprint.
const FACET_FRACTION: f64 = 1.0 / 3.0;
/// Loads, as fractions of the last key, at which the way to the keys is looked at.
const PASSING: [f64; 3] = [0.25, 0.5, 0.75];

/// Faces that a thread reads the layer's map on at least.
const FACES_AT_ONCE: usize = 256;

/// The driver, or what a mask leaves of it, subdivided finely enough to measure strain on.
pub(crate) struct PlanningSurface<'a> {
    driver: &'a Driver,
    modelling: &'a Modelling,
    /// Side of the maps, texels.
    map_size: u32,
    surface: BaseSurface,
    rest: PosedSurface,
    /// Mean edge of every face, m.
    edges: PerFace<f64>,
    /// Largest normal curvature along the edges of every face, 1/m.
    curvatures: PerFace<f64>,
    /// Texels per metre at size 1.
    uv_density: PerFace<f64>,
    /// Centres of the driver's blend shapes, computed when a warning first names a place.
    shapes: OnceLock<ShapeCentres>,
}

impl<'a> PlanningSurface<'a> {
    /// Splits the driver as finely as the finest wave of the stack needs.
    ///
    /// # Errors
    /// [`StepperError::NoLayer`], and [`StepperError::BlackMask`] for a layer that is nowhere.
    pub(crate) fn new(
        driver: &'a Driver,
        stacking: &Stacking,
        modelling: &'a Modelling,
        map_size: u32,
    ) -> Result<Self, StepperError> {
        let layers = &stacking.specs;
        let waves = stacking.simulated.iter().map(|w| w.wavelength);
        let Some(wavelength) = waves.reduce(f64::min) else {
            return Err(StepperError::NoLayer);
        };
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
        // The longest edge does not decide: a few large triangles where nothing happens would have
        // all others split in four.
        let long = lengths[(lengths.len() - 1) * 95 / 100];
        // Subdivision near a border needs the faces beyond it, so that more are split than are
        // kept.
        let split = BaseSurface::split_count(driver, &faces);
        let mut levels = 0;
        while long / f64::from(1u32 << levels) > FACET_FRACTION * wavelength
            && (split << (2 * (levels + 1))) <= MAX_PLANNING_FACES
        {
            levels += 1;
        }
        let surface = BaseSurface::new(driver, &faces, levels, modelling.smoothing);
        let rest = surface.pose(driver.rest());
        let planning = Self {
            driver,
            modelling,
            map_size,
            edges: per_face(&surface, |corners, _| mean_edge(corners), &rest),
            curvatures: per_face(&surface, curvature, &rest),
            uv_density: uv_density(&surface, &rest),
            shapes: OnceLock::new(),
            surface,
            rest,
        };
        planning.check_masks(layers)?;
        Ok(planning)
    }

    /// Times the driver's faces are split in four.
    pub(crate) fn levels(&self) -> u32 {
        self.surface.levels()
    }

    /// Critical mode of the layer on every face, by its map and its variation.
    pub(crate) fn local_wrinkling(
        &self,
        layer: &LayerSpec,
        nominal: &Wrinkling,
    ) -> Result<PerFace<Wrinkling>, StepperError> {
        let faces = self.surface.mesh().faces().as_slice().par_iter();
        let faces = faces.zip(self.surface.uvs().as_slice());
        let wave = |(corners, uvs): (&[VertexId; 3], &[Vector2<f64>; 3])| {
            let corners = corners.map(|v| self.rest.positions[v.index()]);
            wrinkling_on_face(layer, nominal, (uvs, corners))
        };
        let found: Vec<_> = faces.with_min_len(FACES_AT_ONCE).map(wave).collect();
        // Of several errors the first is told, whoever was first.
        found.into_iter().collect()
    }

    /// The faces under the lines of a layer's creases.
    pub(crate) fn creased_faces(&self, layer: &LayerSpec) -> CreasedFaces {
        CreasedFaces::new(&self.surface, layer, &self.edges)
    }

    /// Whether every layer is somewhere on the mesh.
    fn check_masks(&self, layers: &[LayerSpec]) -> Result<(), StepperError> {
        let uvs = self.surface.uvs().as_slice();
        let is_nowhere = |layer: &&LayerSpec| {
            // The centres of faces decide here, as they do on what is simulated. A mask may touch a
            // triangle and still leave all centres black.
            let mut centres = uvs.iter().map(|[a, b, c]| (a + b + c) / 3.0);
            !centres.any(|centre| layer.presence.covers(centre))
        };
        layers.iter().find(is_nowhere).map_or(Ok(()), |layer| {
            Err(StepperError::BlackMask {
                layer: layer.name.clone(),
            })
        })
    }

    /// Finds out what a pose asks of the layers, and adds to `warnings` what the user should know.
    pub(crate) fn pose_plan(
        &self,
        layers: &[PlannedLayer<'_>],
        pose: &PoseSpec,
        warnings: &mut Vec<String>,
    ) -> PosePlan {
        let (keys, passing) = self.posed(pose);
        let on = (self.driver, &self.surface, &self.rest);
        let mut pose_strains: Vec<PoseStrains> = layers
            .iter()
            .map(|layer| PoseStrains::new(on, pose, &keys, &passing, layer))
            .collect();
        let about = PosedPlan {
            driver: self.driver,
            shapes: &self.shapes,
            surface: &self.surface,
            rest: &self.rest,
            pose,
            modelling: self.modelling,
        };
        let path = load_path(&pose_strains, layers, &about, warnings);
        // A strain path stands at its key from the beginning and never sees what folds on the way.
        if path == LoadPath::Weight {
            pose_strains
                .iter_mut()
                .for_each(PoseStrains::exclude_passing_folds);
        }
        let layers = layers
            .iter()
            .zip(&pose_strains)
            .map(|(layer, pose_strains)| {
                let plan = self.layer_plan(layer, pose_strains, (pose, path));
                about.warn(&plan, pose_strains, warnings);
                plan
            })
            .collect();
        PosePlan {
            name: pose.name.clone(),
            path,
            layers,
        }
    }

    /// The surface at every key of a pose, and on the way to the last one, after fractions of it.
    fn posed(&self, pose: &PoseSpec) -> (Vec<PosedSurface>, [(f64, PosedSurface); PASSING.len()]) {
        let driver = self.driver;
        let posed = |load: f64| self.surface.pose(&driver.pose(&pose.weights.scaled(load)));
        let last = pose.keys.iter().copied().fold(0.0, f64::max);
        let keys = pose.keys.iter().map(|&key| posed(key)).collect();
        // A part that turns is shortest half way. The quarters beside tell when a face gets there.
        let passing = PASSING.map(|fraction| (fraction, posed(fraction * last)));
        (keys, passing)
    }

    /// Number and mean length (m) of the edges around the `active` faces. However finely these are split, the
    /// corners between such edges are what a fitted mesh keeps of its border.
    fn border(&self, active: &[FaceId]) -> (f64, f64) {
        let mesh = self.surface.mesh();
        let mut is_active = PerFace::filled(mesh.face_count(), false);
        for &face in active {
            is_active[face] = true;
        }
        let (mut edges, mut length) = (0.0, 0.0);
        for &face in active {
            let beyond = (0..3).map(|corner| mesh.neighbour(face, corner));
            let outer = beyond.filter(|next| next.is_none_or(|next| !is_active[next]));
            let outer = outer.count() as f64;
            edges += outer;
            length += outer * self.edges[face];
        }
        (edges, length / edges.max(1.0))
    }

    fn layer_plan(
        &self,
        layer: &PlannedLayer<'_>,
        pose_strains: &PoseStrains,
        (pose, path): (&PoseSpec, LoadPath),
    ) -> LayerPlan {
        let (modelling, map_size) = (self.modelling, self.map_size);
        let PlannedLayer {
            spec,
            wrinkling,
            local,
            creased,
            points: asked,
            is_lowest,
        } = layer;
        let wavelengths = local
            .as_slice()
            .iter()
            .map(|wrinkling| wrinkling.wavelength);
        let wavelengths: PerFace<f64> = wavelengths.collect();
        // One margin for all of a region, wide enough for its longest wave.
        let longest = wavelengths.as_slice().iter().copied().fold(0.0, f64::max);
        let where_to = (&modelling.region, &spec.presence);
        let folding = creased.in_pose(layer, pose, pose_strains);
        let creased: Vec<FaceId> = folding.iter().flat_map(|line| line.faces.clone()).collect();
        let on = (&self.surface, &self.rest);
        let plane = pose.half.then(|| Plane::of(self.driver));
        let wanted = |face: FaceId| {
            let mut corners = self.surface.mesh().faces()[face].into_iter();
            let is_right =
                |plane: Plane| corners.any(|v| plane.is_right(&self.rest.positions[v.index()]));
            plane.is_none_or(is_right)
        };
        let active = pose_strains.active_faces(on, where_to, longest, &creased, &wanted);
        let quantile = |field: &PerFace<f64>, fraction: f64| {
            weighted_quantile(&active, field, &pose_strains.areas, fraction)
        };
        // Where nothing wrinkles, all of the skin tells how far the pose is from it.
        let smooth = match active.is_empty() {
            true => pose_strains.smooth_faces(&self.surface, &spec.presence),
            false => Vec::new(),
        };
        let strained = if active.is_empty() { &smooth } else { &active };
        let strain = |fraction: f64| {
            let (effective, areas) = (&pose_strains.effective, &pose_strains.areas);
            match strained.is_empty() {
                true => f64::NAN,
                false => weighted_quantile(strained, effective, areas, fraction),
            }
        };
        let area_where = |test: &dyn Fn(FaceId) -> bool| -> f64 {
            let areas = active
                .iter()
                .filter(|&&f| test(f))
                .map(|&f| pose_strains.areas[f]);
            // Not `sum`, which makes -0 of nothing.
            areas.fold(0.0, |sum, area| sum + area)
        };
        let (median, long) = (quantile(&self.edges, 0.5), quantile(&self.edges, 0.95));
        let planned = self.surface.levels();
        // The active faces are those of the planning surface, which may be coarser or finer than
        // the layer will be.
        let faces_at =
            |levels: u32| active.len() as f64 * 4f64.powi(levels as i32 - planned as i32);
        let edges_at = |levels: u32| {
            let split = 2f64.powi(levels as i32 - planned as i32);
            (median / split, long / split)
        };
        // The shortest twentieth does not count: a few strokes of paint would split all of the
        // mesh.
        let shortest = match active.is_empty() {
            true => wrinkling.wavelength,
            false => quantile(&wavelengths, 0.05),
        };
        let longest = Some(FACET_FRACTION * shortest);
        let levels = needed_levels((shortest / asked, longest), modelling, faces_at, edges_at);
        // Euler's formula: half as many vertices as triangles, and half of those on the border. A
        // compact region of `n` triangles has some `2 sqrt(n)` of these.
        let vertices_of = |faces: f64| 0.5 * faces + faces.sqrt();
        let uniform_points = shortest / edges_at(levels).0;
        let (needed, points) = match modelling.remesh {
            Some(limits) => {
                let shape = (pose_strains, &self.curvatures);
                let on = (self.surface.mesh(), self.rest.positions.as_slice());
                let skin = (&wavelengths, spec.material.poisson);
                let faces = fitted_faces((on, &active), shape, skin, &limits, *asked);
                let coarsest = COARSEST * wrinkling.wavelength;
                let length: f64 = folding.iter().map(|line| line.length).sum();
                let needed = GRADING * vertices_of(faces)
                    + graded_vertices(self.border(&active), coarsest.min(limits.max_edge))
                    + creased_vertices(length, wrinkling.wavelength, *asked);
                // Vertices go with the square of the points per wavelength.
                let short = (modelling.vertex_budget as f64 / needed).min(1.0).sqrt();
                let points = asked * short;
                (needed, points)
            }
            // Refinement goes in steps of four.
            None if uniform_points < 0.9 * asked => {
                (4.0 * vertices_of(faces_at(levels)), uniform_points)
            }
            None => (vertices_of(faces_at(levels)), uniform_points),
        };
        let levels = match modelling.remesh {
            Some(_) => levels.min(planned),
            None => levels,
        };
        let output = modelling.remesh.map(|limits| {
            let wrinkled = match is_lowest {
                true => {
                    let mut wrinkled = pose_strains.wrinkled(path);
                    creased.iter().for_each(|&face| wrinkled[face] = true);
                    Some(wrinkled)
                }
                // What a layer below asks of those on it is not known before it is simulated.
                false => None,
            };
            let finest = |face: FaceId| (wavelengths[face] / asked).max(limits.min_edge);
            let mut edges = self.output_edges(&active, wrinkled, (&wavelengths, &finest));
            // A face counts, even if it is not split.
            let least = 4f64.powi(levels as i32 - planned as i32);
            let areas = active.iter().map(|&face| pose_strains.areas[face]);
            let faces = areas
                .zip(&edges)
                .map(|(area, &edge)| faces_within(area, edge).max(least));
            let whole = vertices_of(faces.sum());
            let coarseness = output_coarseness(whole, modelling);
            edges.iter_mut().for_each(|edge| *edge *= coarseness);
            (whole / (coarseness * coarseness), edges, coarseness)
        });
        let (output_vertices, output_edges, points) = match output {
            Some((vertices, edges, coarseness)) => {
                (vertices, edges, points.min(asked / coarseness))
            }
            None => (vertices_of(faces_at(levels)), Vec::new(), points),
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
        let curvature = quantile(&self.curvatures, 0.95);
        let capped_area = area_where(&|f| pose_strains.compression[f] > CAP_START);
        let lowest = (*is_lowest && !active.is_empty()).then(|| Load {
            // The least of all does not count: one extreme triangle begins to wrinkle at next to no
            // load.
            onset: quantile(&pose_strains.onsets(path), 0.01),
            vertices: unknowns as f64,
            capped: capped_area / area_where(&|_| true),
        });
        let work = factorisations(lowest, pose, path);
        let most_in_whole = match modelling.stack {
            // Two sheets in one are never divided.
            Stack::Joint => usize::MAX,
            Stack::Nominal | Stack::Composite => modelling.most_in_whole(*asked),
        };
        let layer = (unknowns, *is_lowest);
        let (seconds, memory) = cost(layer, most_in_whole, output_vertices, map_size, work);
        LayerPlan {
            name: spec.name.clone(),
            wavelength: wrinkling.wavelength,
            critical_strain: wrinkling.critical_strain,
            painted: painted_ranges(spec, &active, local, &pose_strains.areas),
            applied: Some(AppliedStrain {
                median: strain(0.5),
                p99: strain(0.99),
                largest: strained
                    .iter()
                    .map(|&face| pose_strains.effective[face])
                    .fold(f64::NEG_INFINITY, f64::max),
                capped_area,
                folded_area: pose_strains.folded_area(),
                chi: wrinkling.curvature_measure(1.0 / curvature),
                labyrinth_area: match spec.coupling {
                    // Without averaging constraints nothing hinders the domains of a labyrinth from
                    // sliding.
                    Coupling::Elastic => 0.0,
                    Coupling::Hybrid | Coupling::Constraint => {
                        area_where(&|f| pose_strains.is_compressed_equally(f))
                    }
                },
            }),
            active_area: area_where(&|_| true),
            vertices: if active.is_empty() { 0 } else { vertices },
            levels,
            points_per_wavelength: points,
            asked_points: *asked,
            needed,
            texels_per_wavelength: quantile(&self.uv_density, 0.5) * f64::from(map_size) * shortest,
            seconds,
            memory,
            region: active
                .iter()
                .map(|&face| self.surface.ancestor(face, planned))
                .collect(),
            output_edges,
            creases: folding.iter().map(|line| !line.faces.is_empty()).collect(),
        }
    }

    /// Longest edges, m, of an output mesh in the `active` faces: by `finest` within a wavelength of
    /// where it may be wrinkled, everywhere if that is not known, and longer beyond.
    fn output_edges(
        &self,
        active: &[FaceId],
        wrinkled: Option<PerFace<bool>>,
        (wavelengths, finest): (&PerFace<f64>, &dyn Fn(FaceId) -> f64),
    ) -> Vec<f64> {
        let finest = |face: FaceId| OUTPUT_SLACK * finest(face);
        let Some(wrinkled) = wrinkled else {
            return active.iter().map(|&face| finest(face)).collect();
        };
        let mesh = self.surface.mesh();
        let sources = wrinkled.iter().filter(|(_, on)| **on);
        let sources: Vec<_> = sources.flat_map(|(face, _)| mesh.faces()[face]).collect();
        let longest = active.iter().map(|&face| wavelengths[face]);
        // Distances beyond the reach are infinite; there edges are as long as facets may be.
        let reach = 2.0 * longest.fold(0.0, f64::max);
        let distances = edge_distances(mesh, &self.rest.positions, sources, reach);
        let edge = |&face: &FaceId| {
            let wavelength = wavelengths[face];
            let corners = mesh.faces()[face].iter().map(|&v| distances[v]);
            // Waves run out within one length beside the place that they come from.
            let beyond = corners.fold(f64::INFINITY, f64::min) - wavelength;
            let grown = finest(face) + SizeLimits::default().grading * beyond.max(0.0);
            grown.min(FACET_FRACTION * wavelength).max(finest(face))
        };
        active.iter().map(edge).collect()
    }
}

/// Chooses the path of a pose, and says so where it is not the plain one.
fn load_path(
    pose_strains: &[PoseStrains],
    layers: &[PlannedLayer<'_>],
    about: &PosedPlan<'_>,
    warnings: &mut Vec<String>,
) -> LoadPath {
    let detours = pose_strains.iter().zip(layers);
    let detours = detours.map(|(pose_strains, layer)| {
        (
            pose_strains.detour(layer.wrinkling.wavelength),
            pose_strains,
        )
    });
    // Upper layers lie on what the lowest one has become, so that all take the same path: one layer
    // with a detour decides for all.
    let largest = detours.max_by(|a, b| a.0.total_cmp(&b.0));
    let Some((area, pose_strains)) = largest.filter(|(area, _)| *area > 0.0) else {
        return LoadPath::Weight;
    };
    warnings.push(about.detour_warning(area, pose_strains));
    LoadPath::Strain
}
