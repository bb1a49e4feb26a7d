//! One layer, held by a surface below it.

mod bending;
mod snapshot;
mod unwrinkled;

use nalgebra::{Matrix2, Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_blend::{Driver, FaceStrain, PosedSurface, face_strains};
use ruga_material::{CAP_START, Wrinkling, capped_strain};
use ruga_mesh::{FaceId, Id, PerFace, VertexId};
use ruga_shell::{BendingModel, FaceParameters, LayerParameters, ShellError};
use ruga_solver::{
    Iteration, Kkt, LowerPattern, Minimise, NewtonSettings, SolveReport, SolverError,
};

use crate::below::BelowSurface;
use crate::error::Halt;
use crate::layer_objective::{LayerObjective, gather, scatter};
use crate::local_skin::{LocalSkin, SkinProperties};
use crate::low_pass_rows::{RowCentre, low_pass_rows, row_centres};
use crate::motion::{Inertia, Motion};
use crate::preparing::Preparing;
use crate::relief::ReliefShares;
use crate::skin_energy::{SkinEnergy, UpperShell};
use crate::skin_mesh::{Interpolation, RegionMesh, SkinMesh};
use crate::strain_ratio::{StrainRatios, applied, applied_strains, green_strain};
use crate::{Dynamics, LayerSpec, StepperError};

/// Levenberg floor in units of `K0 V_i`: keeps modes that slide along themselves from having a
/// random sign, and is far below what any wrinkle feels.
const FLOOR: f64 = 1e-6;
/// Initial noise in thicknesses; a tenth picks a wrong wavelength.
const NOISE: f64 = 1e-3;

/// Least factor by which a rest triangle may shrink, so that one which collapses on the way keeps
/// an area.
const LEAST_STRETCH: f64 = 0.05;

/// Where a layer and the surface below it are.
pub(crate) struct LayerState {
    positions: Vec<Vector3<f64>>,
    below: BelowSurface,
    share: f64,
}

/// How a layer is held, beyond what its own material says.
#[derive(Clone, Debug)]
pub(crate) struct Holding {
    /// Tangential stiffness per area where it is not the layer's own, Pa/m.
    pub(crate) tie: Option<f64>,
    /// A layer that moves together with it.
    pub(crate) upper: Option<UpperShell>,
    /// How their bending is measured.
    pub(crate) bending: BendingModel,
    /// Where its rows are centred; by its wavelength where nothing is said.
    pub(crate) centres: Option<Vec<RowCentre>>,
}

/// A layer: mesh, energy, rows, and its present shape.
pub(crate) struct Layer {
    pub(crate) spec: LayerSpec,
    pub(crate) wrinkling: Wrinkling,
    skin: SkinMesh,
    properties: SkinProperties,
    /// What results are handed out on.
    region: RegionMesh,
    shares: ReliefShares,
    /// How they get there; `None` where that is the layer's own mesh.
    interpolation: Option<Interpolation>,
    bending: BendingModel,
    /// Response bending modulus of the uncorrected mesh over that of the material, once measured.
    pub(crate) bending_ratio: Option<f64>,
    areas: Vec<f64>,
    below: BelowSurface,
    /// What the surface below asks for, relative to the rest metric with its transfer.
    strains: PerFace<FaceStrain>,
    /// Share of the strain that is loaded, in (0, 1].
    share: f64,
    /// Of the layer's vertices, then of those of a layer that moves together with it.
    positions: Vec<Vector3<f64>>,
    /// Where these would be without wrinkles, on the surface below.
    base: Vec<Vector3<f64>>,
    energy: SkinEnergy,
    /// The layer that moves together with this one.
    upper: Option<UpperShell>,
    /// Whether the energy's rest metric may differ from the rest surface's.
    is_metric_changed: bool,
    /// Dead load on the coordinates that move, N.
    reaction: Vec<f64>,
    /// Velocities, where it moves in time.
    motion: Option<Motion>,
    free: Vec<VertexId>,
    floor: Vec<f64>,
    centres: Vec<RowCentre>,
    /// What the user should know about its rows.
    pub(crate) row_warning: Option<String>,
    kkt: Kkt,
}

impl Layer {
    /// Builds the layer on `adapted`, or else on the region's own mesh, at rest.
    pub(crate) fn new(
        driver: &Driver,
        spec: &LayerSpec,
        wrinkling: &Wrinkling,
        holding: Holding,
        (region, adapted): (RegionMesh, Option<SkinMesh>),
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
        // A mesh may be fitted so coarsely that all of it is border, which is held.
        let adapted =
            adapted.filter(|skin| skin.mesh.border_vertices().as_slice().contains(&false));
        let interpolation = match &adapted {
            Some(skin) => Some(
                preparing
                    .while_wanted(|goes_on| Interpolation::new(skin, &region.skin, goes_on))?,
            ),
            None => None,
        };
        let skin = adapted.unwrap_or_else(|| region.skin.clone());
        let rest = &skin.rest;
        let pinned = skin.mesh.border_vertices();
        let faces = skin.corner_indices();
        let Holding {
            tie,
            upper,
            bending,
            ..
        } = holding;
        let properties = SkinProperties::new(spec, wrinkling, tie, driver, &skin)?;
        preparing.step()?;
        let parameters = layer_parameters(&properties, spec.coupling.has_foundation());
        let surface = (rest.positions.as_slice(), rest.normals.as_slice());
        let energy = SkinEnergy::new(
            surface,
            &faces,
            parameters,
            upper.as_ref(),
            bending,
            pinned.as_slice(),
        )
        .map_err(shell)?;
        let positions = energy.laid_on(&rest.positions, &rest.normals);
        let vertices = rest.positions.len();
        let free: Vec<VertexId> = (0..positions.len())
            .map(VertexId::from_index)
            .filter(|v| !pinned[VertexId::from_index(v.index() % vertices)])
            .collect();
        if free.is_empty() {
            return Err(Halt::Failed(StepperError::NoRoom {
                layer: spec.name.clone(),
            }));
        }
        preparing.step()?;
        let (starts, entries) = energy.pattern();
        let pattern = LowerPattern::new(starts.to_vec(), entries.to_vec()).map_err(solver)?;
        let areas = energy.vertex_areas().to_vec();
        let floor = free
            .iter()
            .flat_map(|v| {
                let i = v.index() % vertices;
                let stiffness = properties.vertices[i].wrinkling.normal_stiffness;
                [FLOOR * stiffness * areas[i]; 3]
            })
            .collect();
        let centres = match holding.centres {
            Some(centres) => centres,
            None => row_centres(spec, &properties, &skin, &free)?,
        };
        preparing.step()?;
        let shares = ReliefShares::new(driver, spec, wrinkling, (&skin, &region.skin))?;
        preparing.step()?;
        let low_pass = low_pass_rows(
            spec,
            &centres,
            (&skin, wrinkling.wavelength),
            &pinned,
            &free,
        )?;
        preparing.step()?;
        let row_warning = low_pass.warning(driver, &skin);
        let kkt = Kkt::new(&pattern, &low_pass.rows, 3).map_err(solver)?;
        preparing.step()?;
        let mut layer = Self {
            spec: spec.clone(),
            wrinkling: *wrinkling,
            strains: face_strains(&skin.mesh, &rest.positions, &rest.positions),
            base: positions.clone(),
            positions,
            below: BelowSurface {
                posed: rest.clone(),
                transfer: None,
            },
            share: 1.0,
            properties,
            skin,
            region,
            shares,
            interpolation,
            bending,
            bending_ratio: None,
            areas,
            energy,
            upper,
            is_metric_changed: false,
            reaction: vec![0.0; 3 * free.len()],
            motion: None,
            free,
            floor,
            centres,
            row_warning,
            kkt,
        };
        layer.add_noise(seed);
        Ok(layer)
    }

    pub(crate) fn vertex_count(&self) -> usize {
        self.skin.mesh.vertex_count()
    }

    pub(crate) fn face_count(&self) -> usize {
        self.skin.mesh.face_count()
    }

    pub(crate) fn row_count(&self) -> usize {
        self.kkt.rows().count() / 3
    }

    /// A little of every wave, so that none has to grow out of rounding errors.
    fn add_noise(&mut self, seed: u64) {
        let vertices = self.vertex_count();
        let places = self.free.iter().map(|v| {
            let i = v.index() % vertices;
            (&self.properties.vertices[i], self.areas[i])
        });
        for (v, height) in self.free.iter().zip(noise(seed, places)) {
            let normal = self.skin.rest.normals[v.index() % vertices];
            self.positions[v.index()] += normal * height;
        }
    }

    /// Moves the surface below; the layer is carried along, turning with it.
    ///
    /// With a `share` under 1 the layer feels only that part of the surface's Green strain, while
    /// the surface stays where it is. Hinges and foundation stay those of the whole strain: with a
    /// rest metric between posed and rest, waves would be chosen in the posed surface's lengths and
    /// end up too long by the compression.
    ///
    /// The layer is not bent where it lies in the posed surface: folds that the artist has drawn
    /// sharper than the layer is thick would otherwise be unstable without any compression.
    pub(crate) fn set_below(
        &mut self,
        below: BelowSurface,
        share: f64,
    ) -> Result<(), StepperError> {
        let (old, new) = (&self.below.posed, &below.posed);
        let base = self.energy.laid_on(&new.positions, &new.normals);
        let vertices = self.vertex_count();
        for (i, base) in base.iter().enumerate() {
            let deviation = self.positions[i] - self.base[i];
            self.positions[i] = base + turn_between(old, new, i % vertices) * deviation;
        }
        self.base = base;
        self.strains = applied_strains(&self.skin, &below);
        self.energy
            .set_base(&new.positions, &new.normals)
            .and_then(|()| self.energy.set_rest_angles(&self.base))
            .map_err(|source| self.shell_error(source))?;
        self.below = below;
        self.share = share;
        self.set_rest_metric()?;
        if self.spec.coupling.has_foundation() {
            self.balance()?;
        }
        self.set_felt_strains(|_, applied| applied)
    }

    /// Sets the forces with which the surface below holds the layer in its own shape.
    ///
    /// The artist's posed shape is skin in equilibrium: against what a layer lying on it pulls and
    /// presses, the surface pushes back. Without this a layer under tension flattens
    /// the artist's shape, one under half of the critical compression doubles every bump as long
    /// as a wrinkle, and on a cylinder an elastic foundation delays the onset. Compression counts
    /// up to the critical strain, because a wrinkled layer carries no more.
    fn balance(&mut self) -> Result<(), StepperError> {
        let poisson = self.spec.material.poisson;
        let wanted = |critical: f64, [first, second]: [f64; 2]| {
            let second = second.min(critical / (1.0 + poisson));
            [(critical - poisson * second).min(first), second]
        };
        self.set_felt_strains(wanted)?;
        self.energy.gradient(&self.base, &mut self.reaction);
        Ok(())
    }

    /// Shrinks the rest metric with the surface below, face by face, where that asks for more than
    /// 15 %, and takes out what of its bending is not transferred.
    fn set_rest_metric(&mut self) -> Result<(), StepperError> {
        let capped = self.strains.as_slice().iter().any(|s| s.first > CAP_START);
        let changed = capped || self.below.transfer.is_some();
        if changed || self.is_metric_changed {
            let strains = self.strains.iter();
            let stretches: Vec<_> = strains.map(|(f, s)| self.rest_stretch(f, s)).collect();
            let outcome = self.energy.set_rest_metric(&stretches);
            outcome.map_err(|source| self.shell_error(source))?;
        }
        self.is_metric_changed = changed;
        Ok(())
    }

    fn rest_stretch(&self, face: FaceId, strain: &FaceStrain) -> Matrix2<f64> {
        let ratio = (1.0 - strain.first) / (1.0 - capped_strain(strain.first));
        let along = strain.direction * strain.direction.transpose();
        let stretch = Matrix2::identity() + along * (ratio.max(LEAST_STRETCH) - 1.0);
        match &self.below.transfer {
            Some(transfer) => stretch * transfer[face.index()],
            None => stretch,
        }
    }

    /// Lets the layer feel of every face's applied principal strains what `wanted` says, of the
    /// face's critical strain and these.
    fn set_felt_strains(
        &mut self,
        wanted: impl Fn(f64, [f64; 2]) -> [f64; 2],
    ) -> Result<(), StepperError> {
        let strains = self.strains.iter();
        let natural: Vec<_> = strains
            .map(|(face, strain)| {
                let critical = self.properties.faces[face].wrinkling.critical_strain;
                let felt = wanted(critical, applied(strain, self.share));
                green_strain(strain, applied(strain, 1.0)) - green_strain(strain, felt)
            })
            .collect();
        let outcome = self.energy.set_natural_strains(&natural);
        outcome.map_err(|source| self.shell_error(source))
    }

    fn shell_error(&self, source: ShellError) -> StepperError {
        StepperError::Shell {
            layer: self.spec.name.clone(),
            source,
        }
    }

    /// Takes over how `other`, the same layer on another mesh, deviates from the surface below;
    /// both are on the same one, and no layer moves together with them. False as soon as `goes_on`
    /// says no.
    pub(crate) fn take_shape(&mut self, other: &Layer, goes_on: &mut dyn FnMut() -> bool) -> bool {
        let Some(interpolation) = Interpolation::new(&other.skin, &self.skin, goes_on) else {
            return false;
        };
        let deviations = interpolation.apply(&other.deviations());
        for v in &self.free {
            let i = v.index();
            self.positions[i] = self.base[i] + deviations[i];
        }
        true
    }

    /// Way from the surface below to every vertex, m.
    fn deviations(&self) -> Vec<Vector3<f64>> {
        self.all_deviations().take(self.vertex_count()).collect()
    }

    /// The same of the layer that moves together with this one.
    fn upper_deviations(&self) -> Vec<Vector3<f64>> {
        self.all_deviations().skip(self.vertex_count()).collect()
    }

    fn all_deviations(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        let pairs = self.positions.iter().zip(&self.base);
        pairs.map(|(x, base)| x - base)
    }

    /// Lets the layer move in time from now on, first at rest.
    pub(crate) fn set_in_motion(&mut self, dynamics: Dynamics) {
        let vertices = self.properties.vertices.iter().zip(&self.areas);
        let mass = |(local, area): (&LocalSkin, &f64)| local.mass_per_area() * area;
        let mut masses: Vec<f64> = vertices.map(mass).collect();
        if let Some(upper) = &self.upper {
            masses.extend(self.areas.iter().map(|area| upper.mass_per_area() * area));
        }
        self.motion = Some(Motion::new(dynamics, masses));
    }

    /// Moves from where it was at `start` by one step in time, the present positions being a guess
    /// at where that ends.
    pub(crate) fn step_in_time(
        &mut self,
        start: &[Vector3<f64>],
        how: (Minimise, &NewtonSettings),
        keep_going: &mut dyn FnMut(&Iteration) -> bool,
    ) -> Result<SolveReport, SolverError> {
        let inertia = self.motion.as_ref().map(|motion| motion.inertia(start));
        let report = self.minimise_with(inertia.as_ref(), how, keep_going)?;
        if let Some(motion) = &mut self.motion {
            motion.moved(start, &self.positions);
        }
        Ok(report)
    }

    /// Finds the equilibrium near the present positions and moves there.
    pub(crate) fn minimise(
        &mut self,
        how: (Minimise, &NewtonSettings),
        keep_going: &mut dyn FnMut(&Iteration) -> bool,
    ) -> Result<SolveReport, SolverError> {
        self.minimise_with(None, how, keep_going)
    }

    fn minimise_with(
        &mut self,
        inertia: Option<&Inertia>,
        (minimise, settings): (Minimise, &NewtonSettings),
        keep_going: &mut dyn FnMut(&Iteration) -> bool,
    ) -> Result<SolveReport, SolverError> {
        // A row asks for the same average of the layer as of the surface below.
        let base = gather(&self.free, &self.base);
        let mut targets = vec![0.0; self.kkt.rows().count()];
        self.kkt.rows().mul(&base, &mut targets)?;
        let mut unknowns = gather(&self.free, &self.positions);
        let objective = LayerObjective {
            energy: &self.energy,
            free: &self.free,
            positions: &self.positions,
            pattern: self.kkt.pattern().clone(),
            floor: &self.floor,
            reaction: &self.reaction,
            base: &base,
            inertia: inertia.zip(self.motion.as_ref().map(Motion::masses)),
            vertex_area: self.areas.iter().sum::<f64>() / self.areas.len().max(1) as f64,
            energy_scale: self.strain_ratios().energy_scale(),
            wrinkling: &self.wrinkling,
            thickness: self.spec.material.thickness,
        };
        let report = minimise(
            &objective,
            &targets,
            &mut unknowns,
            &mut self.kkt,
            settings,
            keep_going,
        )?;
        scatter(&self.free, &unknowns, &mut self.positions);
        Ok(report)
    }

    /// Shape of the layer and of the surface below it, to return to.
    pub(crate) fn state(&self) -> LayerState {
        LayerState {
            positions: self.positions.clone(),
            below: self.below.clone(),
            share: self.share,
        }
    }

    /// Returns to an earlier shape, and the surface below to where it was then.
    pub(crate) fn restore(&mut self, state: &LayerState) -> Result<(), StepperError> {
        self.set_below(state.below.clone(), state.share)?;
        self.positions.clone_from(&state.positions);
        Ok(())
    }

    /// What the surface below asks of the faces, in their critical strains.
    pub(crate) fn strain_ratios(&self) -> StrainRatios<'_> {
        StrainRatios {
            skin: &self.skin,
            properties: &self.properties,
            poisson: self.spec.material.poisson,
            strains: &self.strains,
            fraction: self.share,
            is_capped: true,
        }
    }

    /// The largest strain that the surface below asks for, in critical strains.
    pub(crate) fn strain_ratio(&self) -> f64 {
        self.strain_ratios().largest()
    }

    /// Total elastic energy, J.
    pub(crate) fn energy(&self) -> f64 {
        self.energy.value(&self.positions)
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
        let normals = self.below.posed.normals.iter();
        normals.zip(deviations).map(|(n, d)| n.dot(d)).collect()
    }

    /// The layer that moves together with this one.
    pub(crate) fn upper(&self) -> Option<&UpperShell> {
        self.upper.as_ref()
    }

    /// Where the rows of the layer's coupling are centred.
    pub(crate) fn row_centres(&self) -> &[RowCentre] {
        &self.centres
    }

    /// The layer's mesh at rest.
    pub(crate) fn skin(&self) -> &SkinMesh {
        &self.skin
    }

    /// The mesh that results are handed out on.
    pub(crate) fn region(&self) -> &RegionMesh {
        &self.region
    }

    /// How results get to the mesh they are handed out on; `None` where that is the layer's own.
    pub(crate) fn interpolation(&self) -> Option<&Interpolation> {
        self.interpolation.as_ref()
    }

    /// Where the layer's vertices are, and those of a layer that moves together with it, m.
    pub(crate) fn positions(&self) -> &[Vector3<f64>] {
        &self.positions
    }
}

/// Random heights at vertices with these properties and areas (m²), m.
pub(crate) fn noise<'a>(
    seed: u64,
    vertices: impl Iterator<Item = (&'a LocalSkin, f64)>,
) -> impl Iterator<Item = f64> {
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

/// How the surface turns at one vertex between two poses.
pub(crate) fn turn_between(
    old: &PosedSurface,
    new: &PosedSurface,
    vertex: usize,
) -> Rotation3<f64> {
    let frame = |surface: &PosedSurface| {
        let (n, t) = (surface.normals[vertex], surface.tangents[vertex]);
        Rotation3::from_basis_unchecked(&[t, n.cross(&t), n])
    };
    frame(new) * frame(old).inverse()
}

/// What a shell is made of, with the springs of its foundation where it is `held` by one.
pub(crate) fn layer_parameters(properties: &SkinProperties, held: bool) -> LayerParameters {
    let spring = |stiffness: f64| if held { stiffness } else { 0.0 };
    let face = |local: &LocalSkin| FaceParameters {
        young: local.material.young,
        poisson: local.material.poisson,
        thickness: local.material.thickness,
        normal_stiffness: spring(local.wrinkling.normal_stiffness),
        gradient_stiffness: spring(local.wrinkling.gradient_stiffness),
    };
    let tie = |local: &LocalSkin| spring(local.wrinkling.tangential_stiffness);
    LayerParameters {
        faces: properties.faces.as_slice().iter().map(face).collect(),
        tangential_stiffness: properties.vertices.iter().map(tie).collect(),
    }
}
