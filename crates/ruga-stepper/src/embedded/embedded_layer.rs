//! A layer on a body: meshes, energies, and where everything is now.

use std::sync::Arc;

use nalgebra::{Rotation3, Vector3};
use ruga_blend::{FaceStrain, face_strains};
use ruga_lattice::Embedding;
use ruga_material::Wrinkling;
use ruga_mesh::PerFace;
use ruga_solver::{Iteration, Kkt, Minimise, NewtonSettings, SolveReport, SolverError};

use super::body_mesh::meshes;
use super::contact::Contact;
use super::handles::Moves;
use super::objective::{BodyObjective, Moment, Scales};
use super::obstacle::PlacedObstacle;
use super::plan::Interior;
use super::prediction::Prediction;
use super::system::BodySystem;
use crate::error::Halt;
use crate::layer::noise;
use crate::local_skin::SkinProperties;
use crate::motion::{Inertia, velocities};
use crate::preparing::Preparing;
use crate::relief::relief_shares;
use crate::skin_mesh::{Interpolation, RegionMesh, SkinMesh};
use crate::strain_ratio::StrainRatios;
use crate::{ComputedMesh, Dynamics, LayerSpec, LayerSurface, Phase, Plan, StepperError};

/// Where a body and its layer are.
#[derive(Clone, Debug)]
pub(crate) struct BodyState {
    /// The layer's vertices, m.
    pub(crate) x: Vec<Vector3<f64>>,
    /// Lattice nodes, m.
    pub(crate) q: Vec<Vector3<f64>>,
    /// Of the nodes, m/s.
    pub(crate) velocities: Vec<Vector3<f64>>,
    pub(crate) obstacles: Vec<PlacedObstacle>,
    /// Where the artist's vertices are drawn to; empty where nothing draws them, m.
    pub(crate) targets: Vec<Vector3<f64>>,
}

/// A body with its layer in one pose.
pub(crate) struct EmbeddedLayer<'p> {
    plan: &'p Plan,
    interior: &'p Interior,
    region: RegionMesh,
    /// Share of the relief that maps show at the region's vertices.
    shares: Vec<f64>,
    /// Of the region's vertices.
    region_embedding: Embedding,
    /// How results get there; `None` where that is the layer's own mesh.
    interpolation: Option<Interpolation>,
    /// Of the artist's vertices.
    control: Embedding,
    pub(crate) skin: SkinMesh,
    properties: SkinProperties,
    pub(crate) system: BodySystem,
    kkt: Kkt,
    prediction: Prediction,
    pub(crate) state: BodyState,
    /// Normals of the surface below in the last solve.
    normals: Vec<Vector3<f64>>,
    /// What they and an inertia make of the Hessian.
    constant: Option<(f64, Arc<Vec<f64>>)>,
}

/// Angle in rad by which the surface below may have turned before its foundation is set up anew.
const AS_BEFORE: f64 = 1e-4;

impl<'p> EmbeddedLayer<'p> {
    /// Builds the layer on the body as pose number `pose` has it, at rest.
    pub(crate) fn new(
        (plan, interior): (&'p Plan, &'p Interior),
        pose: usize,
        preparing: &mut Preparing<'_>,
    ) -> Result<Self, Halt> {
        let (driver, modelling) = (&plan.driver, &plan.modelling);
        let (spec, wrinkling) = (&plan.stacking.specs[0], &plan.stacking.simulated[0]);
        let (region, fitted) = meshes(plan, &plan.poses[pose].layers[0], preparing)?;
        preparing.step()?;
        let interpolation = match &fitted {
            Some(skin) => Some(
                preparing
                    .while_wanted(|goes_on| Interpolation::new(skin, &region.skin, goes_on))?,
            ),
            None => None,
        };
        let skin = fitted.unwrap_or_else(|| region.skin.clone());
        let properties = SkinProperties::new(spec, wrinkling, None, driver, &skin)?;
        let made_of = (&properties, modelling.bending);
        preparing.enter(Phase::Constraints)?;
        let system = BodySystem::new((plan, interior), &skin, made_of)?;
        preparing.step()?;
        let solver = |source| StepperError::Solver {
            layer: spec.name.clone(),
            source,
        };
        // A node of the lattice touches hundreds of vertices. Dissecting the graph with all nodes in
        // it is still better than to eliminate them last: by a tenth at six cells along a side, by a
        // third at ten.
        let kkt = Kkt::new(&system.layout.pattern, &system.rows, 3);
        preparing.step()?;
        let carrier = &interior.carrier;
        let rest = carrier.lattice.rest_positions();
        let mut layer = Self {
            state: BodyState {
                x: skin.rest.positions.clone(),
                q: rest.to_vec(),
                velocities: vec![Vector3::zeros(); rest.len()],
                obstacles: Vec::new(),
                targets: match &system.follow {
                    Some(_) => driver.rest().to_vec(),
                    None => Vec::new(),
                },
            },
            normals: system.embedding.normals(rest),
            constant: None,
            kkt: kkt.map_err(solver)?,
            prediction: Prediction::new(&system.lattice).map_err(solver)?,
            region_embedding: carrier.embed(&region.skin)?,
            shares: relief_shares(driver, spec, wrinkling, &region.skin)?,
            control: carrier.embed_control(driver)?,
            plan,
            interior,
            region,
            interpolation,
            skin,
            properties,
            system,
        };
        layer.add_noise(modelling.seed);
        Ok(layer)
    }

    /// A little of every wave, so that none has to grow out of rounding errors.
    fn add_noise(&mut self, seed: u64) {
        let areas = self.system.areas.iter().copied();
        let vertices = self.properties.vertices.iter().zip(areas);
        let normals = self.normals.iter().zip(noise(seed, vertices));
        for (x, (normal, height)) in self.state.x.iter_mut().zip(normals) {
            *x += normal * height;
        }
    }

    /// Puts handles, obstacles and targets where they are at `time`; the inside moves with the
    /// handles, and the layer with the inside.
    pub(crate) fn place(
        &mut self,
        (moves, weights): (&Moves<'_>, &ruga_blend::Weights),
        time: f64,
    ) -> Result<(), StepperError> {
        let mut ways = self.handle_ways(moves, time);
        if ways.iter().any(|way| *way != Vector3::zeros()) {
            let both = [&self.system.all_nodes, &self.system.lattice];
            match self.prediction.fill_in(both, &self.state.q, &mut ways) {
                // Then the elements beside the handles take up all of the motion.
                Ok(()) | Err(SolverError::Breakdown { .. }) => {}
                Err(source) => return Err(self.solver_error(source)),
            }
        }
        self.move_nodes(&ways);
        self.set_surroundings((moves, weights), time);
        Ok(())
    }

    /// The same for a step in time: as long as nothing is touched, the inside goes where its velocity
    /// takes it; else it stays where it is, for velocities then lead into obstacles, and Newton's method
    /// is up to twice as long on its way out. Returns what the step adds to the energy.
    pub(crate) fn place_in_time(
        &mut self,
        (moves, weights): (&Moves<'_>, &ruga_blend::Weights),
        time: f64,
        dynamics: Dynamics,
    ) -> Inertia {
        let inertia = Inertia::new(dynamics, &self.state.q, &self.state.velocities);
        let mut ways = self.handle_ways(moves, time);
        if !self.is_touched() {
            for &node in self.system.lattice.free_nodes() {
                let node = node as usize;
                ways[node] = inertia.centres[node] - self.state.q[node];
            }
        }
        self.move_nodes(&ways);
        self.set_surroundings((moves, weights), time);
        inertia
    }

    fn set_surroundings(
        &mut self,
        (moves, weights): (&Moves<'_>, &ruga_blend::Weights),
        time: f64,
    ) {
        self.state.obstacles = moves.obstacles(time);
        if self.system.follow.is_some() {
            self.state.targets = self.plan.driver.pose(&weights.scaled(time));
        }
    }

    /// Ways of the held nodes from where they are to where they are at `time`; 0 for others.
    fn handle_ways(&self, moves: &Moves<'_>, time: f64) -> Vec<Vector3<f64>> {
        let rest = self.interior.carrier.lattice.rest_positions();
        let handles = self.interior.body.handles.len();
        let placements: Vec<_> = (0..handles).map(|i| moves.handle(i, time)).collect();
        let nodes = self
            .interior
            .held
            .holder
            .iter()
            .zip(rest)
            .zip(&self.state.q);
        let way = |((holder, rest), q): ((&Option<usize>, &Vector3<f64>), &Vector3<f64>)| {
            holder.map_or(Vector3::zeros(), |i| placements[i].apply(rest) - q)
        };
        nodes.map(way).collect()
    }

    /// Moves the nodes; the layer is carried along, turning with the surface below.
    fn move_nodes(&mut self, ways: &[Vector3<f64>]) {
        let embedding = &self.system.embedding;
        let before = Frames::new(embedding, &self.state.q);
        for (q, way) in self.state.q.iter_mut().zip(ways) {
            *q += way;
        }
        let after = Frames::new(embedding, &self.state.q);
        for (i, x) in self.state.x.iter_mut().enumerate() {
            let turn = after.rotations[i] * before.rotations[i].inverse();
            *x = after.positions[i] + turn * (*x - before.positions[i]);
        }
    }

    /// Finds the equilibrium near the present state, or the end of a step in time, and moves there.
    pub(crate) fn minimise(
        &mut self,
        inertia: Option<Inertia>,
        (minimise, settings): (Minimise, &NewtonSettings),
        keep_going: &mut dyn FnMut(&Iteration) -> bool,
    ) -> Result<SolveReport, SolverError> {
        if self.turned() > AS_BEFORE {
            self.normals = self.present_normals();
            self.constant = None;
        }
        let moment = self.moment(inertia);
        let targets = self.system.row_targets(&self.state.q);
        let mut unknowns = self.unknowns();
        let objective = BodyObjective {
            system: &self.system,
            moment: &moment,
            scales: self.scales(),
        };
        let report = minimise(
            &objective,
            &targets,
            &mut unknowns,
            &mut self.kkt,
            settings,
            keep_going,
        )?;
        self.set_unknowns(&unknowns);
        Ok(report)
    }

    /// Takes over the velocities of a step from a state `before`, s.
    pub(crate) fn take_velocities(&mut self, before: &BodyState, time_step: f64) {
        self.state.velocities = velocities(&before.q, &self.state.q, time_step);
    }

    /// What the next solve holds fast.
    pub(crate) fn moment(&mut self, inertia: Option<Inertia>) -> Moment {
        let factor = inertia.as_ref().map_or(0.0, |inertia| inertia.weight(1.0));
        let known = self.constant.take().filter(|(of, _)| *of == factor);
        let (_, constant) = known.unwrap_or_else(|| {
            let values = self.system.constant_hessian(&self.normals, factor);
            (factor, Arc::new(values))
        });
        self.constant = Some((factor, Arc::clone(&constant)));
        let BodyState {
            q,
            obstacles,
            targets,
            ..
        } = &self.state;
        Moment {
            q: q.clone(),
            normals: self.normals.clone(),
            constant,
            contact: self.contact(obstacles.clone()),
            targets: targets.clone(),
            inertia,
        }
    }

    /// Whether an obstacle pushes.
    pub(crate) fn is_touched(&self) -> bool {
        let contact = self.contact(self.state.obstacles.clone());
        contact.value(&self.state.x, &self.system.areas) > 0.0
    }

    fn contact(&self, obstacles: Vec<PlacedObstacle>) -> Contact {
        let young = [
            self.interior.body.material.young,
            self.spec().material.young,
        ];
        Contact::new(obstacles, young, self.thickness())
    }

    pub(crate) fn unknowns(&self) -> Vec<f64> {
        let mut unknowns: Vec<f64> = self.state.x.iter().flat_map(|x| [x.x, x.y, x.z]).collect();
        unknowns.extend(self.system.lattice.unknowns(&self.state.q));
        unknowns
    }

    fn set_unknowns(&mut self, unknowns: &[f64]) {
        let (layer, body) = unknowns.split_at(self.system.layout.shell_unknowns());
        for (x, entries) in self.state.x.iter_mut().zip(layer.chunks_exact(3)) {
            *x = Vector3::from_column_slice(entries);
        }
        self.system.lattice.set_unknowns(body, &mut self.state.q);
    }

    /// Normals of the surface below; where it has collapsed, those of before.
    fn present_normals(&self) -> Vec<Vector3<f64>> {
        let mut normals = self.system.embedding.normals(&self.state.q);
        for (normal, before) in normals.iter_mut().zip(&self.normals) {
            if *normal == Vector3::zeros() {
                *normal = *before;
            }
        }
        normals
    }

    /// Largest angle by which the surface below has turned since the normals of the last solve, rad.
    pub(crate) fn turned(&self) -> f64 {
        let pairs = self.normals.iter().zip(self.present_normals());
        pairs
            .map(|(old, new)| old.cross(&new).norm().atan2(old.dot(&new)))
            .fold(0.0, f64::max)
    }

    /// Whether a vertex got through an obstacle on its way from an earlier state.
    pub(crate) fn has_passed(&self, before: &BodyState) -> bool {
        let contact = self.contact(self.state.obstacles.clone());
        contact.is_passed(
            (&before.obstacles, &before.x),
            &self.state.x,
            self.thickness(),
        )
    }

    /// Deepest way of a vertex into an obstacle, m.
    pub(crate) fn penetration(&self) -> f64 {
        let contact = self.contact(self.state.obstacles.clone());
        contact.penetration(&self.state.x)
    }

    pub(crate) fn scales(&self) -> Scales {
        let areas = &self.system.areas;
        let vertex_area = areas.iter().sum::<f64>() / areas.len().max(1) as f64;
        Scales {
            energy: self.strain_ratios(&self.strains()).energy_scale(),
            force: self.wrinkling().normal_stiffness * self.thickness() * vertex_area,
            length: self.thickness(),
        }
    }

    /// Strains of the surface below under the layer's faces.
    pub(crate) fn strains(&self) -> PerFace<FaceStrain> {
        let below = self.system.embedding.positions(&self.state.q);
        face_strains(&self.skin.mesh, &self.skin.rest.positions, &below)
    }

    /// What the surface below asks of the faces, which has these strains, in their critical ones.
    fn strain_ratios<'s>(&'s self, strains: &'s PerFace<FaceStrain>) -> StrainRatios<'s> {
        StrainRatios {
            skin: &self.skin,
            properties: &self.properties,
            poisson: self.spec().material.poisson,
            strains,
            fraction: 1.0,
            is_capped: false,
        }
    }

    /// The largest strain that the surface below asks for, in critical strains.
    pub(crate) fn strain_ratio(&self) -> f64 {
        self.strain_ratios(&self.strains()).largest()
    }

    /// Faces that the surface below compresses beyond the critical strain.
    pub(crate) fn supercritical_faces(&self) -> Vec<[u32; 3]> {
        self.strain_ratios(&self.strains()).supercritical_faces()
    }

    /// Wrinkle heights, m.
    pub(crate) fn heights(&self) -> Vec<f64> {
        let normals = self.present_normals();
        let pairs = normals.iter().zip(self.deviations());
        pairs.map(|(n, e)| n.dot(&e)).collect()
    }

    /// From the surface below to the layer, m.
    fn deviations(&self) -> Vec<Vector3<f64>> {
        let below = self.system.embedding.positions(&self.state.q);
        let pairs = self.state.x.iter().zip(&below);
        pairs.map(|(x, below)| x - below).collect()
    }

    /// Elastic energy of layer, foundation and inside, J.
    pub(crate) fn energy(&self) -> f64 {
        let BodySystem {
            shell,
            foundation,
            lattice,
            ..
        } = &self.system;
        let e = self.deviations();
        let springs = foundation.as_ref().map_or(0.0, |foundation| {
            let forces = foundation.forces(&self.normals, &e);
            forces.iter().zip(&e).map(|(f, e)| 0.5 * f.dot(e)).sum()
        });
        shell.value(&self.state.x) + springs + lattice.value(&self.state.q)
    }

    /// Where the artist's vertices are, in the order of [`ruga_blend::Driver::pose`], m.
    pub(crate) fn artist_positions(&self) -> Vec<Vector3<f64>> {
        self.control.positions(&self.state.q)
    }

    /// The layer as others see it.
    pub(crate) fn snapshot(&self) -> LayerSurface {
        let q = &self.state.q;
        let below = self.region_embedding.positions(q);
        let deviations = match &self.interpolation {
            None => self.deviations(),
            Some(interpolation) => interpolation.apply(&self.deviations()),
        };
        let pairs = below.iter().zip(&deviations);
        let positions = pairs.clone().map(|(b, e)| b + e).collect();
        let shown = pairs
            .zip(&self.shares)
            .map(|((b, e), share)| b + e * *share);
        LayerSurface {
            name: self.spec().name.clone(),
            positions,
            relief: shown.collect(),
            driver_normals: self.region_embedding.normals(q),
            driver_positions: below,
            offset: 0.0,
            faces: self.region.skin.corner_indices(),
            uvs: self.region.shown_uvs().to_vec(),
            artist: self.region.artist(),
            computed: ComputedMesh::new(&self.plan.driver, &self.skin, &self.state.x),
        }
    }

    pub(crate) fn thickness(&self) -> f64 {
        self.spec().material.thickness
    }

    fn spec(&self) -> &LayerSpec {
        &self.plan.stacking.specs[0]
    }

    fn wrinkling(&self) -> &Wrinkling {
        &self.plan.stacking.simulated[0]
    }

    pub(crate) fn solver_error(&self, source: SolverError) -> StepperError {
        StepperError::Solver {
            layer: self.spec().name.clone(),
            source,
        }
    }
}

/// An embedded surface with how it has turned.
struct Frames {
    positions: Vec<Vector3<f64>>,
    rotations: Vec<Rotation3<f64>>,
}

impl Frames {
    fn new(embedding: &Embedding, q: &[Vector3<f64>]) -> Self {
        let [first, second] = [0, 1].map(|k| embedding.tangent_rows()[k].apply(q));
        let rotation = |(a, b): (&Vector3<f64>, &Vector3<f64>)| {
            let along = a.try_normalize(0.0);
            let normal = a.cross(b).try_normalize(0.0);
            match along.zip(normal) {
                Some((t, n)) => Rotation3::from_basis_unchecked(&[t, n.cross(&t), n]),
                None => Rotation3::identity(),
            }
        };
        Self {
            positions: embedding.positions(q),
            rotations: first.iter().zip(&second).map(rotation).collect(),
        }
    }
}
