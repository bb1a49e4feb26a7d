//! A sheet on its mesh: what it is made of, where it is, and what holds it.

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_mesh::{EdgeId, Id};
use ruga_shell::{BendingModel, ShellError};
use ruga_solver::{Iteration, NewtonSettings, SolveReport, SolverError};

use super::Sheet;
use super::burning::{Burning, FireState};
use super::fitting::Fitting;
use super::meshed::Meshed;
use super::objective::{Scales, SheetObjective};
use super::plan::longest_side;
use super::standing::Standing;
use crate::error::Halt;
use crate::run::layer_objective::{gather, scatter};
use crate::skin::skin_mesh::RegionMesh;
use crate::support::Moves;
use crate::support::contact::Contact;
use crate::support::motion::{Inertia, velocities};
use crate::support::obstacle::PlacedObstacle;
use crate::{CreaseReport, Dynamics, FaceState, LayerSpec, Modelling, PoseSpec, StepperError};

/// Distance at which an obstacle begins to push, in mean edges of the mesh: what it holds off lies on chords
/// between its vertices, which are about as far from a round obstacle.
const REACH: f64 = 0.1;

/// State of a free sheet during one pose: its mesh, its energy, what holds it, and where it is.
pub(super) struct SheetState<'a> {
    pub(super) spec: &'a LayerSpec,
    pub(super) sheet: &'a Sheet,
    /// The artist's surface, as fine as results show it.
    pub(super) region: RegionMesh,
    pub(super) bending: BendingModel,
    /// What it is computed on: the region's mesh, or one that is fine only where it burns.
    pub(super) meshed: Meshed,
    pub(super) fitting: Option<Fitting>,
    pub(super) scales: Scales,
    pub(super) moving: Moving,
    /// Largest natural curvature of every face, 1/m.
    pub(super) curvatures: Vec<f64>,
    /// Faces whose natural curvature is more than their edges can show.
    pub(super) capped: usize,
    pub(super) fire: Option<FireState<'a>>,
}

/// Positions and velocities of a sheet, places of obstacles, and what has burnt.
#[derive(Clone, Debug)]
pub(super) struct Moving {
    pub(super) positions: Vec<Vector3<f64>>,
    /// Per second, or where a step is an equilibrium per whole pose.
    pub(super) velocities: Vec<Vector3<f64>>,
    obstacles: Vec<PlacedObstacle>,
    pub(super) burning: Option<Burning>,
}

impl<'a> SheetState<'a> {
    /// The sheet at rest on the mesh of `region`.
    pub(super) fn new(
        driver: &Driver,
        (spec, sheet): (&'a LayerSpec, &'a Sheet),
        region: RegionMesh,
        modelling: &Modelling,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Self, Halt> {
        let fire = sheet.fire.as_ref();
        let fire = fire.map(|fire| FireState::new(driver, fire, &region, modelling.vertex_budget));
        let (mut fire, burning) = fire.transpose()?.unzip();
        let fitting = match (&fire, &burning) {
            (Some(fire), Some(burning)) => {
                Fitting::new((spec, sheet), (driver, &region), (fire, burning), goes_on)?
            }
            _ => None,
        };
        let (fitting, skin) = match fitting {
            Some((fitting, skin)) => (Some(fitting), skin),
            None => (None, region.skin.clone()),
        };
        let part = Standing::whole(&skin);
        let may_be_held = fitting.as_ref().map(Fitting::may_be_held);
        let on = (skin, part, may_be_held);
        let meshed = Meshed::new(driver, (spec, sheet), on, modelling.bending)?;
        let rest = &meshed.skin.rest.positions;
        if let Some(fire) = &mut fire {
            if let Some(fitting) = &fitting {
                let covering = fitting.covering(&fire.grid, &region, &meshed.skin);
                fire.lie_on(covering);
            }
            fire.put_on(driver, &meshed.skin, meshed.materials.clone());
        }
        Ok(Self {
            scales: scales(sheet, &meshed),
            moving: Moving {
                positions: rest.to_vec(),
                velocities: vec![Vector3::zeros(); rest.len()],
                obstacles: sheet
                    .obstacles
                    .iter()
                    .map(PlacedObstacle::at_rest)
                    .collect(),
                burning,
            },
            curvatures: vec![0.0; meshed.face_areas.len()],
            capped: 0,
            bending: modelling.bending,
            meshed,
            fitting,
            spec,
            sheet,
            fire,
            region,
        })
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.meshed.masses.len()
    }

    /// Puts handles, obstacles, growth, fire and creases where they are at a fraction of a pose, and free vertices
    /// where their velocity takes them from an earlier one.
    pub(super) fn place(
        &mut self,
        driver: &Driver,
        (pose, moves): (&PoseSpec, &Moves<'_>),
        [from, time]: [f64; 2],
        inertia: Option<&Inertia>,
    ) -> Result<(), StepperError> {
        let remains = self.burn((moves, [from, time]), inertia)?;
        let rest = &self.meshed.skin.rest.positions;
        let placements: Vec<_> = (0..self.sheet.handles.len())
            .map(|handle| moves.handle(handle, time))
            .collect();
        for (i, holder) in self.meshed.holders.iter().enumerate() {
            if let Some(handle) = holder {
                self.moving.positions[i] = placements[*handle].apply(&rest[i]);
            }
        }
        self.moving.obstacles = moves.obstacles(time);
        if !self.is_touched() {
            for i in self.free() {
                self.moving.positions[i] = match inertia {
                    Some(inertia) => inertia.centres[i],
                    // Where equilibria follow each other they go on as before.
                    None => self.moving.positions[i] + self.moving.velocities[i] * (time - from),
                };
            }
        }
        self.shape(driver, pose, time, remains)?;
        self.fold(pose, time)
    }

    fn fold(&mut self, pose: &PoseSpec, time: f64) -> Result<(), StepperError> {
        if self.region.skin.creases.is_empty() {
            return Ok(());
        }
        let mut creases = Vec::new();
        for on_edge in &self.region.skin.creases {
            let crease = &self.spec.creases[on_edge.line];
            let strength = crease.strength(&pose.weights, time);
            let modulus = self.modulus_beside(on_edge.edge);
            let made = crease.on_edge(on_edge.at, (strength, 1.0), modulus);
            creases.push((on_edge.edge, made));
        }
        let outcome = self.meshed.standing.energy.set_creases(&creases);
        outcome.map_err(|source| shell_error(self.spec, source))
    }

    /// Mean bending modulus of the faces beside an edge, J.
    fn modulus_beside(&self, edge: EdgeId) -> f64 {
        let faces = self.region.skin.mesh.edges()[edge].faces.into_iter();
        let moduli: Vec<f64> = faces
            .flatten()
            .map(|face| self.meshed.moduli[face.index()])
            .collect();
        moduli.iter().sum::<f64>() / moduli.len().max(1) as f64
    }

    /// How every crease has folded that has edges on the mesh.
    pub(super) fn crease_reports(&self) -> Vec<CreaseReport> {
        let positions = self.meshed.standing.of_vertices(&self.moving.positions);
        let states = self.meshed.standing.energy.crease_states(&positions);
        let rest = &self.meshed.skin.rest.positions;
        let mesh = &self.meshed.skin.mesh;
        let reports = self.spec.creases.iter().enumerate().map(|(line, spec)| {
            let own = self.region.skin.creases.iter().zip(&states);
            let mut report = CreaseReport::of(spec);
            for (crease, state) in own.filter(|(crease, _)| crease.line == line) {
                let [a, b] = mesh.edges()[crease.edge].vertices.map(|v| rest[v.index()]);
                // There is no surface below that it could be deep in.
                report.add((b - a).norm(), (state.angle, 0.0), state.energy);
            }
            report
        });
        let made = reports.filter(|report| report.length > 0.0);
        made.map(CreaseReport::finished).collect()
    }

    /// States of the faces: material and energies; a sheet has no compression that wrinkles it.
    pub(super) fn face_states(&self) -> Vec<FaceState> {
        let positions = self.meshed.standing.of_vertices(&self.moving.positions);
        let energies = self
            .meshed
            .standing
            .energy
            .face_energies(&positions, &positions);
        let faces = energies
            .iter()
            .flatten()
            .zip(self.meshed.standing.part.faces.as_slice());
        let mut states = vec![FaceState::default(); self.meshed.face_areas.len()];
        for (energy, face) in faces {
            let (area, material) = (
                self.meshed.face_areas[*face],
                &self.meshed.materials[face.index()],
            );
            states[face.index()] = FaceState {
                young: material.young,
                thickness: material.thickness,
                membrane_energy: energy.membrane / area,
                bending_energy: energy.bending / area,
                ..FaceState::default()
            };
        }
        states
    }

    /// Numbers of the vertices that are there and that nothing holds.
    fn free(&self) -> impl Iterator<Item = usize> + use<> {
        let vertices = &self.meshed.standing.part.vertices;
        let free = self.meshed.standing.free.iter();
        let free: Vec<usize> = free.map(|v| vertices[*v].index()).collect();
        free.into_iter()
    }

    /// For every face whether it is still there.
    pub(super) fn stands(&self) -> Vec<bool> {
        let mut stands = vec![false; self.meshed.face_areas.len()];
        for face in self.meshed.standing.part.faces.as_slice() {
            stands[face.index()] = true;
        }
        stands
    }

    fn contact(&self) -> Contact {
        let reach = REACH * self.meshed.edge;
        Contact::of_stiffness(
            self.moving.obstacles.clone(),
            self.meshed.stiffness(),
            reach,
        )
    }

    fn is_touched(&self) -> bool {
        let positions = self.meshed.standing.of_vertices(&self.moving.positions);
        let areas = self.meshed.standing.energy.vertex_areas();
        self.contact().value(&positions, areas) > 0.0
    }

    /// Whether a vertex got through an obstacle on its way from an earlier state.
    pub(super) fn has_passed(&self, before: &Moving) -> bool {
        let [start, end] =
            [before, &self.moving].map(|at| self.meshed.standing.of_vertices(&at.positions));
        let start = (before.obstacles.as_slice(), start.as_slice());
        let contact = self.contact();
        contact.is_passed(start, &end, self.meshed.edge)
    }

    /// Finds the equilibrium near the present state, or the end of a step in time, and moves there.
    pub(super) fn minimise(
        &mut self,
        inertia: Option<&Inertia>,
        (modelling, settings): (&Modelling, &NewtonSettings),
        keep_going: &mut dyn FnMut(&Iteration) -> bool,
    ) -> Result<SolveReport, StepperError> {
        let is_touched = self.is_touched();
        let contact = self.contact();
        let masses = self.meshed.standing.of_vertices(&self.meshed.masses);
        let positions = self.meshed.standing.of_vertices(&self.moving.positions);
        let inertia = inertia
            .map(|inertia| inertia.of_part(self.meshed.standing.of_vertices(&inertia.centres)));
        let weights: Option<Vec<f64>> = inertia
            .as_ref()
            .map(|inertia| masses.iter().map(|mass| inertia.weight(*mass)).collect());
        let damping = self.meshed.standing.damping(weights.as_deref());
        let Standing {
            part,
            energy,
            free,
            system,
            ..
        } = &mut self.meshed.standing;
        let Some((pattern, kkt)) = system else {
            return Ok(SolveReport::nothing_to_solve());
        };
        let mut unknowns = gather(free, &positions);
        let objective = SheetObjective {
            energy,
            free,
            positions: &positions,
            pattern,
            mesh: &part.mesh,
            damping: &damping,
            masses: &masses,
            areas: energy.vertex_areas(),
            gravity: self.sheet.gravity,
            contact,
            inertia: inertia.as_ref(),
            scales: self.scales,
        };
        let settings = NewtonSettings {
            overshoot: is_touched,
            ..*settings
        };
        let minimise = modelling.minimise;
        let solved = minimise(&objective, &[], &mut unknowns, kkt, &settings, keep_going);
        let report = solved.map_err(|source| solver_error(self.spec, source))?;
        let mut end = positions.clone();
        scatter(free, &unknowns, &mut end);
        objective.balance(&mut end);
        self.meshed.standing.put(&end, &mut self.moving.positions);
        Ok(report)
    }

    /// The term of a step in time that begins here.
    pub(super) fn inertia(&self, dynamics: Dynamics) -> Inertia {
        Inertia::new(dynamics, &self.moving.positions, &self.moving.velocities)
    }

    /// Takes over the velocities of a step from `before` that took so much time.
    pub(super) fn end_step(&mut self, before: &Moving, time: f64) {
        self.moving.velocities = velocities(&before.positions, &self.moving.positions, time);
    }

    /// Elastic energy, J.
    pub(super) fn elastic_energy(&self) -> f64 {
        let positions = self.meshed.standing.of_vertices(&self.moving.positions);
        self.meshed.standing.energy.value(&positions)
    }

    /// Values at the vertices of the region's mesh from positions (m) of those of its own.
    pub(super) fn on_region(&self, positions: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let Some(fitting) = &self.fitting else {
            return positions.to_vec();
        };
        let skin = &self.meshed.skin;
        // What has not moved stays where it is to the last digit.
        let moved = positions.iter().zip(&skin.rest.positions);
        let moved: Vec<Vector3<f64>> = moved.map(|(x, rest)| x - rest).collect();
        let moved = fitting.smooth((skin, &self.region), &moved);
        let rest = &self.region.skin.rest.positions;
        rest.iter().zip(moved).map(|(x, moved)| x + moved).collect()
    }

    /// Positions of all vertices, of which those that are gone go with the nearest that is there, m.
    pub(super) fn carried_positions(&self) -> Vec<Vector3<f64>> {
        self.carried(&self.moving.positions)
    }

    /// The same of vertices that are at `positions` (m).
    pub(super) fn carried(&self, positions: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let skin = &self.meshed.skin;
        let standing = &self.meshed.standing;
        standing.carried(&skin.mesh, &skin.rest.positions, positions)
    }
}

/// What tolerances are relative to, for a fresh sheet.
pub(super) fn scales(sheet: &Sheet, meshed: &Meshed) -> Scales {
    let weight = meshed.masses.iter().sum::<f64>() * sheet.gravity.norm();
    let side = longest_side(&meshed.skin.rest.positions);
    let vertices = meshed.masses.len() as f64;
    Scales::new(meshed.bending(), [meshed.edge, side], (weight, vertices))
}

pub(super) fn shell_error(spec: &LayerSpec, source: ShellError) -> StepperError {
    StepperError::Shell {
        layer: spec.name.clone(),
        source,
    }
}

pub(super) fn solver_error(spec: &LayerSpec, source: SolverError) -> StepperError {
    StepperError::Solver {
        layer: spec.name.clone(),
        source,
    }
}
