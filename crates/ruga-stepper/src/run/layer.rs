//! One layer, held by a surface below it.

mod absorption;
mod bending;
mod creases;
mod equilibrium;
mod face_states;
mod furrows;
mod load;
mod output;
mod pulls;
mod snapshot;
#[cfg(test)]
mod tests;
mod unwrinkled;

use std::sync::{Arc, OnceLock};

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_blend::{Driver, FaceStrain, PosedSurface, face_strains};
use ruga_constraint::SampleConstraints;
use ruga_material::Wrinkling;
use ruga_mesh::{Id, PerFace, PerVertex, VertexId};
use ruga_shell::{BendingModel, FaceParameters, LayerEnergy, LayerParameters};
use ruga_solver::{ConstraintRows, LowerPattern};

use crate::error::Halt;
use crate::preparing::Preparing;
use crate::run::low_pass_rows::{RowCentre, low_pass_rows, row_centres};
use crate::run::strain_ratio::StrainRatios;
use crate::skin::local_skin::{LocalSkin, SkinProperties};
use crate::skin::relief::ReliefWeights;
use crate::skin::skin_mesh::SkinMesh;
use crate::skin::upper_shell::UpperShell;
use crate::support::support_surface::{SupportSurface, TangentialSprings};
use crate::support::{Interior, Solid};
use crate::{LayerSpec, StepperError};

use absorption::Bands;
use creases::CreaseStrengths;
use pulls::ToldPulls;

pub(crate) use absorption::Absorption;
pub(crate) use load::LayerState;
pub(crate) use output::{OnOutput, Output, OutputMesh, Unmade};
pub(crate) use snapshot::{LayerView, Shape};

/// Levenberg damping in units of `K0 V_i`: keeps modes that slide along themselves from having a
/// random sign, and is far below what any wrinkle feels.
const DAMPING: f64 = 1e-6;
/// Initial noise in thicknesses; a tenth picks a wrong wavelength.
const NOISE: f64 = 1e-3;

/// How a layer is built, beyond what its own specification says.
#[derive(Clone, Debug)]
pub(crate) struct LayerOptions {
    /// Its tangential springs where they are not the layer's own.
    pub(crate) tangential: Option<TangentialSprings>,
    /// A layer that moves together with it.
    pub(crate) upper: Option<UpperShell>,
    /// Discrete bending energy.
    pub(crate) bending: BendingModel,
    /// Centres of its averaging constraints; chosen by its wavelength where there are none.
    pub(crate) centres: Option<Vec<RowCentre>>,
    /// Samples the rows around their centres.
    pub(crate) sample: SampleConstraints,
    /// The body below that moves with it.
    pub(crate) interior: Option<Arc<Interior>>,
}

/// A layer: mesh, energy, rows, and its present shape.
pub(crate) struct Layer {
    pub(crate) spec: LayerSpec,
    pub(crate) wrinkling: Wrinkling,
    skin: SkinMesh,
    properties: SkinProperties,
    /// Weights of the relief on its own mesh.
    weights: ReliefWeights,
    output: Output,
    bending: BendingModel,
    /// Response bending modulus of the uncorrected mesh over that of the material, once measured.
    pub(crate) bending_ratio: Option<f64>,
    areas: Vec<f64>,
    support: Arc<SupportSurface>,
    /// Strains that the support surface applies to the layer as it has grown.
    strains: PerFace<FaceStrain>,
    /// Strains of the support surface alone, relative to the rest metric with its transfer; `None` where they
    /// are those of the layer.
    driven: Option<PerFace<FaceStrain>>,
    /// Fraction of its strain that every face feels, in (0, 1].
    fractions: PerFace<f64>,
    /// Positions of the layer's vertices, then of those of a layer that moves together with it, m.
    positions: Vec<Vector3<f64>>,
    /// Positions of the vertices without wrinkles, on the support surface, m.
    base: Vec<Vector3<f64>>,
    /// Velocities of the vertices, m/s; empty until the first step in time.
    velocities: Vec<Vector3<f64>>,
    /// What its creases are drawn to.
    crease_strengths: CreaseStrengths,
    /// The skin beside creases that take up compression, and what they take up of the present strains.
    bands: Bands,
    absorption: Absorption,
    /// Masses of the vertices, kg.
    masses: Vec<f64>,
    energy: LayerEnergy,
    /// The layer that moves together with this one.
    upper: Option<UpperShell>,
    /// The body below that moves together with this one.
    solid: Option<Solid>,
    /// Whether the energy's rest metric may differ from the rest surface's.
    is_metric_changed: bool,
    /// Normals of a body's surface that the energy stands on; empty on a driver.
    held_normals: Vec<Vector3<f64>>,
    /// Factors of the energy's rest lengths on a body, per face; empty on a driver.
    held_ratios: Vec<f64>,
    /// Dead load on the coordinates that move, N.
    reaction: Vec<f64>,
    free: Vec<VertexId>,
    /// Levenberg damping of all unknowns, N/m.
    damping: Vec<f64>,
    centres: Vec<RowCentre>,
    /// Warning about its averaging constraints.
    pub(crate) row_warning: Option<String>,
    rows: ConstraintRows,
    /// What the rows are told of the pulls of anchors.
    pulls: ToldPulls,
    /// Sparsity of the layer's matrix, once it was asked for: in patches a layer is solved without.
    pattern: OnceLock<LowerPattern>,
}

impl Layer {
    /// Builds the layer on `adapted`, or else on the output mesh itself, at rest.
    ///
    /// # Panics
    /// When the output mesh is to be made later, and `adapted` has no inner vertex.
    pub(crate) fn new(
        driver: &Arc<Driver>,
        spec: &LayerSpec,
        wrinkling: &Wrinkling,
        options: LayerOptions,
        (output, adapted): (OutputMesh, Option<SkinMesh>),
        seed: u64,
        preparing: &mut Preparing<'_>,
    ) -> Result<Self, Halt> {
        let shell = |source| StepperError::Shell {
            layer: spec.name.clone(),
            source,
        };
        let solver = |source| StepperError::Solver {
            layer: spec.name.clone(),
            source,
        };
        // A mesh may be fitted so coarsely that all of it is border.
        let adapted =
            adapted.filter(|skin| options.interior.is_some() || skin.has_inner_vertices());
        let weights = |skin: &SkinMesh| ReliefWeights::new(driver, spec, wrinkling, skin);
        let output = Output::new(output, adapted.as_ref(), weights, preparing)?;
        let skin = match (adapted, &output) {
            (Some(skin), _) => skin,
            (None, Output::Made(shown)) => shown.region.skin.clone(),
            (None, Output::Later(_)) => unreachable!("only a fitted layer is shown later"),
        };
        let rest = &skin.rest;
        let LayerOptions {
            tangential,
            upper,
            bending,
            centres,
            sample,
            interior,
        } = options;
        // A driver goes on beyond the layer, and holds its border; on a body nothing does.
        let pinned = match &interior {
            Some(_) => PerVertex::filled(rest.positions.len(), false),
            None => skin.held(),
        };
        let stiffness = tangential.map(|springs| springs.stiffness);
        let properties = SkinProperties::new(spec, wrinkling, stiffness, driver, &skin)?;
        preparing.step()?;
        let parameters = layer_parameters(&properties, spec.coupling.has_foundation());
        let surface = (rest.positions.as_slice(), rest.normals.as_slice());
        let (mesh, held) = (&skin.mesh, pinned.as_slice());
        let energy = match &upper {
            None => {
                let at_rest = (mesh, surface.0, held);
                LayerEnergy::half(at_rest, &skin.on_plane, parameters, bending)
            }
            Some(upper) => {
                let above = upper.sheet(surface, mesh.face_count());
                LayerEnergy::pair((mesh, surface.0, held), parameters, above, bending)
            }
        };
        let mut energy = energy.map_err(shell)?;
        if let Some(springs) = tangential.filter(|_| spec.coupling.has_foundation()) {
            let outcome = energy.set_drift_gradient_stiffness(springs.gradient);
            outcome.map_err(shell)?;
        }
        let positions = laid_on(rest, upper.as_ref());
        let vertices = rest.positions.len();
        let free: Vec<VertexId> = (0..positions.len())
            .map(VertexId::from_index)
            // Both sheets of a pair are held at the same places.
            .filter(|v| !pinned[VertexId::from_index(v.index() % vertices)])
            .collect();
        if free.is_empty() {
            return Err(Halt::Failed(StepperError::NoRoom {
                layer: spec.name.clone(),
            }));
        }
        preparing.step()?;
        let areas = energy.vertex_areas().to_vec();
        let of_vertex = |(local, area): (&LocalSkin, &f64)| local.mass_per_area() * area;
        let locals = properties.at_vertices();
        let mut masses: Vec<f64> = locals.zip(&areas).map(of_vertex).collect();
        let mut solid = match &interior {
            Some(interior) => {
                let of_upper = upper.as_ref().map_or(0.0, UpperShell::mass_per_area);
                let pairs = masses.iter().zip(&areas);
                // The upper sheet of a pair has no place of its own in the body and weighs on the
                // lower one's.
                let carried: Vec<f64> = pairs.map(|(mass, area)| mass + of_upper * area).collect();
                let body = (interior, driver);
                Some(Solid::new(body, spec, (&skin, &energy), &carried)?)
            }
            None => None,
        };
        if let Some(upper) = &upper {
            // They are extended only now: a body takes one mass per place, motion on a driver one
            // per vertex of both sheets.
            masses.extend(areas.iter().map(|area| upper.mass_per_area() * area));
        }
        preparing.step()?;
        let centres = match centres {
            Some(centres) => centres,
            None => row_centres(spec, &properties, &skin, &free)?,
        };
        preparing.step()?;
        let weights = weights(&skin)?;
        preparing.step()?;
        let low_pass = low_pass_rows((spec, sample), &centres, &skin, &pinned, &free)?;
        preparing.step()?;
        let row_warning = low_pass.warning(driver, &skin);
        let mut damping: Vec<f64> = free
            .iter()
            .flat_map(|v| {
                let i = v.index() % vertices;
                // It is relative to the foundation, or it would be too much where a layer is
                // painted soft and too little where it is stiff.
                let stiffness = properties.at_vertex(i).wrinkling.normal_stiffness;
                [DAMPING * stiffness * areas[i]; 3]
            })
            .collect();
        damping.extend(solid.iter().flat_map(Solid::damping));
        let rows = match &mut solid {
            Some(solid) => solid.hang(&low_pass.rows).map_err(solver)?,
            None => low_pass.rows,
        };
        preparing.step()?;
        let (held_normals, held_ratios) = match &solid {
            Some(_) => (rest.normals.clone(), vec![1.0; skin.mesh.face_count()]),
            None => (Vec::new(), Vec::new()),
        };
        let mut layer = Self {
            spec: spec.clone(),
            wrinkling: *wrinkling,
            strains: face_strains(&skin.mesh, &rest.positions, &rest.positions),
            driven: None,
            base: positions.clone(),
            support: Arc::new(SupportSurface {
                posed: rest.clone(),
                transfer: None,
                growth: None,
            }),
            fractions: PerFace::filled(skin.mesh.face_count(), 1.0),
            held_normals,
            held_ratios,
            velocities: Vec::new(),
            crease_strengths: CreaseStrengths::default(),
            bands: Bands::new(spec, &skin, &properties),
            absorption: Absorption::default(),
            properties,
            skin,
            weights,
            output,
            bending,
            bending_ratio: None,
            areas,
            energy,
            upper,
            is_metric_changed: false,
            reaction: vec![0.0; 3 * free.len()],
            positions,
            masses,
            solid,
            free,
            damping,
            centres,
            row_warning,
            rows,
            pulls: ToldPulls::default(),
            pattern: OnceLock::new(),
        };
        layer.add_noise(seed);
        layer.set_crease_strengths(layer.undrawn())?;
        Ok(layer)
    }

    pub(crate) fn vertex_count(&self) -> usize {
        self.skin.mesh.vertex_count()
    }

    pub(crate) fn face_count(&self) -> usize {
        self.skin.mesh.face_count()
    }

    pub(crate) fn row_count(&self) -> usize {
        self.rows.count() / 3
    }

    /// A little of every wave, so that none has to grow out of rounding errors.
    fn add_noise(&mut self, seed: u64) {
        let vertices = self.vertex_count();
        let places = self.free.iter().map(|v| {
            let i = v.index() % vertices;
            (self.properties.at_vertex(i), self.areas[i])
        });
        for (v, height) in self.free.iter().zip(noise(seed, places)) {
            let normal = self.skin.rest.normals[v.index() % vertices];
            // Noise acts along the normal alone: in the surface it would stretch the membrane,
            // which is far stiffer than the layer is in bending.
            self.positions[v.index()] += normal * height;
        }
        self.stay_on_plane();
    }

    /// Displacement of every vertex from the surface below, m.
    fn deviations(&self) -> Vec<Vector3<f64>> {
        self.all_deviations().take(self.vertex_count()).collect()
    }

    /// Displacements of the layer that moves together with this one from where it would lie, m.
    fn upper_deviations(&self) -> Vec<Vector3<f64>> {
        self.all_deviations().skip(self.vertex_count()).collect()
    }

    fn all_deviations(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        let pairs = self.positions.iter().zip(&self.base);
        pairs.map(|(x, base)| x - base)
    }

    /// Strains of the support surface over the critical strains, per face.
    pub(crate) fn strain_ratios(&self) -> StrainRatios<'_> {
        StrainRatios {
            skin: &self.skin,
            properties: &self.properties,
            poisson: self.spec.material.poisson,
            strains: &self.strains,
            fractions: &self.fractions,
            absorption: &self.absorption,
        }
    }

    /// The largest strain that the surface below asks for, in critical strains.
    pub(crate) fn strain_ratio(&self) -> f64 {
        self.strain_ratios().largest()
    }

    /// Total elastic energy, of a body that moves with the layer too, J.
    pub(crate) fn energy(&self) -> f64 {
        // A body's surface may have moved since the energy was set up.
        let support = &self.support.posed.positions;
        let of_body = |solid: &Solid| solid.elastic_energy() + solid.anchor_energy(&self.positions);
        let inside = self.solid.as_ref().map_or(0.0, of_body);
        self.energy.value_over(&self.positions, support) + inside
    }

    /// The body below that moves together with this layer.
    pub(crate) fn solid(&self) -> Option<&Solid> {
        self.solid.as_ref()
    }

    /// Averaging constraints over all unknowns, and the Hessian's lower triangle.
    pub(crate) fn system(&self) -> (&LowerPattern, &ConstraintRows) {
        (self.pattern(), &self.rows)
    }

    /// Gives back the sparsity of its matrix and the places of its blocks, which only solves of the whole take.
    pub(crate) fn release_pattern(&mut self) {
        self.pattern = OnceLock::new();
        self.energy.release_slots();
    }

    fn pattern(&self) -> &LowerPattern {
        self.pattern.get_or_init(|| match &self.solid {
            Some(solid) => solid.pattern().clone(),
            None => {
                let (starts, entries) = self.energy.blocks().shared();
                LowerPattern::new(starts, entries).expect("blocks of free vertices")
            }
        })
    }

    /// Wrinkle heights, m.
    pub(crate) fn heights(&self) -> Vec<f64> {
        self.along_normals(&self.deviations())
    }

    /// Wrinkle heights of the layer that moves together with this one, m.
    pub(crate) fn upper_heights(&self) -> Vec<f64> {
        self.along_normals(&self.upper_deviations())
    }

    fn along_normals(&self, deviations: &[Vector3<f64>]) -> Vec<f64> {
        let normals = self.support.posed.normals.iter();
        normals.zip(deviations).map(|(n, d)| n.dot(d)).collect()
    }

    /// The layer that moves together with this one.
    pub(crate) fn upper(&self) -> Option<&UpperShell> {
        self.upper.as_ref()
    }

    /// Centres of the layer's averaging constraints.
    pub(crate) fn row_centres(&self) -> &[RowCentre] {
        &self.centres
    }

    /// The layer's mesh at rest.
    pub(crate) fn skin(&self) -> &SkinMesh {
        &self.skin
    }

    /// Positions of the layer's vertices, then of those of a layer that moves together with it, m.
    pub(crate) fn positions(&self) -> &[Vector3<f64>] {
        &self.positions
    }
}

/// Positions of the vertices on a surface without wrinkles, then of those of an upper layer, m.
fn laid_on(surface: &PosedSurface, upper: Option<&UpperShell>) -> Vec<Vector3<f64>> {
    let mut positions = surface.positions.clone();
    if let Some(upper) = upper {
        positions.extend(upper.above(&surface.positions, &surface.normals));
    }
    positions
}

/// Random heights at vertices with these properties and areas (m²), m.
pub(crate) fn noise<'a>(
    seed: u64,
    vertices: impl Iterator<Item = (&'a LocalSkin, f64)>,
) -> impl Iterator<Item = f64> {
    // A named generator keeps its numbers from version to version, unlike the standard one of
    // `rand`.
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    vertices.map(move |(local, area)| noise_size(local, area) * random.random_range(-1.0..1.0))
}

/// Largest noise at a vertex with this area (m²), m.
fn noise_size(local: &LocalSkin, area: f64) -> f64 {
    let usual_edge = local.wrinkling.wavelength / 12.0;
    // Where the artist's mesh is much finer than asked for, the same noise would fold it.
    let fineness = (area / (usual_edge * usual_edge)).min(1.0);
    NOISE * local.material.thickness * fineness
}

/// Parameters of a shell, with the springs of its foundation where it is `held` by one.
pub(crate) fn layer_parameters(properties: &SkinProperties, held: bool) -> LayerParameters {
    let spring = |stiffness: f64| if held { stiffness } else { 0.0 };
    let face = |local: &LocalSkin| FaceParameters {
        young: local.material.young,
        poisson: local.material.poisson,
        thickness: local.material.thickness,
        normal_stiffness: spring(local.wrinkling.normal_stiffness),
        gradient_stiffness: spring(local.wrinkling.gradient_stiffness),
    };
    let tangential = |local: &LocalSkin| spring(local.wrinkling.tangential_stiffness);
    LayerParameters {
        faces: properties.on_faces().map(face).collect(),
        tangential_stiffness: properties.at_vertices().map(tangential).collect(),
    }
}
