//! A sheet on its mesh: what it is made of, where it is, and what holds it.

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_material::RelativeProperties;
use ruga_mesh::{EdgeId, Id, PerFace, face_areas, mean_edge_lengths};
use ruga_shell::{BendingModel, FaceParameters, ShellError};
use ruga_solver::{Iteration, NewtonSettings, SolveReport, SolverError};

use super::Sheet;
use super::burning::{Burning, FireState};
use super::objective::{Scales, SheetObjective};
use super::plan::longest_side;
use super::standing::Standing;
use crate::run::layer_objective::{gather, scatter};
use crate::skin::local_skin::{relative_at_vertices, relative_on_faces};
use crate::skin::skin_mesh::{RegionMesh, SkinMesh};
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
    pub(super) region: RegionMesh,
    pub(super) bending: BendingModel,
    pub(super) standing: Standing,
    /// The handle that holds a vertex, and whether one does.
    pub(super) holders: Vec<Option<usize>>,
    pub(super) held: Vec<bool>,
    pub(super) masses: Vec<f64>,
    /// Rest area of every face, m², and its mass per area, kg/m².
    pub(super) face_areas: PerFace<f64>,
    pub(super) densities: Vec<f64>,
    /// Material on every face, and its bending modulus, J.
    pub(super) materials: Vec<FaceParameters>,
    moduli: Vec<f64>,
    /// Mean edge, m.
    edge: f64,
    scales: Scales,
    /// Pressure of an obstacle per depth, Pa/m.
    stiffness: f64,
    pub(super) moving: Moving,
    /// Faces whose natural curvature is more than their edges can show.
    pub(super) capped: usize,
    pub(super) fire: Option<FireState<'a>>,
}

/// Positions and velocities of a sheet, places of obstacles, and what has burnt.
#[derive(Clone, Debug)]
pub(super) struct Moving {
    pub(super) positions: Vec<Vector3<f64>>,
    /// Per second, or where a step is an equilibrium per whole pose.
    velocities: Vec<Vector3<f64>>,
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
    ) -> Result<Self, StepperError> {
        let skin = &region.skin;
        let holders = holders(sheet, &skin.rest.positions)?;
        let held: Vec<bool> = holders.iter().map(Option::is_some).collect();
        if held.iter().all(|held| *held) {
            return Err(StepperError::NoRoom {
                layer: spec.name.clone(),
            });
        }
        let materials = face_parameters(spec, driver, &region);
        let (mesh, rest) = (&skin.mesh, skin.rest.positions.as_slice());
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let of_faces = |value: fn(&FaceParameters) -> f64| -> Vec<f64> {
            materials.iter().map(value).collect()
        };
        let membrane = mean(&of_faces(|face| face.young * face.thickness));
        let moduli = of_faces(|face| {
            face.young * face.thickness.powi(3) / (12.0 * (1.0 - face.poisson * face.poisson))
        });
        let bending = modelling.bending;
        let part = Standing::whole(skin);
        let standing = Standing::new(spec, skin, part, &materials, &held, bending)?;
        let face_areas = face_areas(mesh, rest);
        let densities = materials
            .iter()
            .map(|face| face.thickness * spec.material.density);
        let densities: Vec<f64> = densities.collect();
        let on_faces = face_areas.as_slice().iter().zip(&densities);
        let on_faces: Vec<f64> = on_faces.map(|(area, density)| area * density).collect();
        let masses = lumped(skin, &on_faces);
        // Not the shortest edge: what is cut along a crease may be as small as it likes.
        let edge = mean(&mean_edge_lengths(mesh, rest));
        let weight = masses.iter().sum::<f64>() * sheet.gravity.norm();
        let fire = sheet.fire.as_ref().map(|fire| {
            FireState::new(
                fire,
                (driver, &region),
                materials.clone(),
                modelling.vertex_budget,
            )
        });
        let (fire, burning) = fire.transpose()?.unzip();
        Ok(Self {
            scales: Scales::new(
                mean(&moduli),
                [edge, longest_side(rest)],
                (weight, masses.len() as f64),
            ),
            moduli,
            materials,
            edge,
            stiffness: membrane / (edge * edge),
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
            capped: 0,
            bending,
            standing,
            spec,
            sheet,
            held,
            holders,
            masses,
            face_areas,
            densities,
            fire,
            region,
        })
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.masses.len()
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
        let rest = &self.region.skin.rest.positions;
        let placements: Vec<_> = (0..self.sheet.handles.len())
            .map(|handle| moves.handle(handle, time))
            .collect();
        for (i, holder) in self.holders.iter().enumerate() {
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
        let outcome = self.standing.energy.set_creases(&creases);
        outcome.map_err(|source| shell_error(self.spec, source))
    }

    /// Mean bending modulus of the faces beside an edge, J.
    fn modulus_beside(&self, edge: EdgeId) -> f64 {
        let faces = self.region.skin.mesh.edges()[edge].faces.into_iter();
        let moduli: Vec<f64> = faces
            .flatten()
            .map(|face| self.moduli[face.index()])
            .collect();
        moduli.iter().sum::<f64>() / moduli.len().max(1) as f64
    }

    /// How every crease has folded that has edges on the mesh.
    pub(super) fn crease_reports(&self) -> Vec<CreaseReport> {
        let positions = self.standing.of_vertices(&self.moving.positions);
        let states = self.standing.energy.crease_states(&positions);
        let rest = &self.region.skin.rest.positions;
        let mesh = &self.region.skin.mesh;
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
        let positions = self.standing.of_vertices(&self.moving.positions);
        let energies = self.standing.energy.face_energies(&positions, &positions);
        let faces = energies
            .iter()
            .flatten()
            .zip(self.standing.part.faces.as_slice());
        let mut states = vec![FaceState::default(); self.face_areas.len()];
        for (energy, face) in faces {
            let (area, material) = (self.face_areas[*face], &self.materials[face.index()]);
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
        let vertices = &self.standing.part.vertices;
        let free = self.standing.free.iter();
        let free: Vec<usize> = free.map(|v| vertices[*v].index()).collect();
        free.into_iter()
    }

    /// For every face whether it is still there.
    pub(super) fn stands(&self) -> Vec<bool> {
        let mut stands = vec![false; self.face_areas.len()];
        for face in self.standing.part.faces.as_slice() {
            stands[face.index()] = true;
        }
        stands
    }

    fn contact(&self) -> Contact {
        let reach = REACH * self.edge;
        Contact::of_stiffness(self.moving.obstacles.clone(), self.stiffness, reach)
    }

    fn is_touched(&self) -> bool {
        let positions = self.standing.of_vertices(&self.moving.positions);
        let areas = self.standing.energy.vertex_areas();
        self.contact().value(&positions, areas) > 0.0
    }

    /// Whether a vertex got through an obstacle on its way from an earlier state.
    pub(super) fn has_passed(&self, before: &Moving) -> bool {
        let [start, end] =
            [before, &self.moving].map(|at| self.standing.of_vertices(&at.positions));
        let start = (before.obstacles.as_slice(), start.as_slice());
        let contact = self.contact();
        contact.is_passed(start, &end, self.edge)
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
        let masses = self.standing.of_vertices(&self.masses);
        let mut positions = self.standing.of_vertices(&self.moving.positions);
        let inertia =
            inertia.map(|inertia| inertia.of_part(self.standing.of_vertices(&inertia.centres)));
        let weights: Option<Vec<f64>> = inertia
            .as_ref()
            .map(|inertia| masses.iter().map(|mass| inertia.weight(*mass)).collect());
        let damping = self.standing.damping(weights.as_deref());
        let Standing {
            part,
            energy,
            free,
            system,
            ..
        } = &mut self.standing;
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
        scatter(free, &unknowns, &mut positions);
        self.standing.put(&positions, &mut self.moving.positions);
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
        let positions = self.standing.of_vertices(&self.moving.positions);
        self.standing.energy.value(&positions)
    }

    /// Positions of all vertices, of which those that are gone go with the nearest that is there, m.
    pub(super) fn carried_positions(&self) -> Vec<Vector3<f64>> {
        let mesh = &self.region.skin.mesh;
        self.standing.carried(
            mesh,
            &self.region.skin.rest.positions,
            &self.moving.positions,
        )
    }
}

/// Masses of the vertices from those of the faces.
pub(super) fn lumped(skin: &SkinMesh, of_faces: &[f64]) -> Vec<f64> {
    let mut masses = vec![0.0; skin.mesh.vertex_count()];
    for (corners, mass) in skin.mesh.faces().as_slice().iter().zip(of_faces) {
        for v in corners {
            masses[v.index()] += mass / 3.0;
        }
    }
    masses
}

/// The handle of every vertex; of the first in whose box it is at rest.
fn holders(sheet: &Sheet, rest: &[Vector3<f64>]) -> Result<Vec<Option<usize>>, StepperError> {
    let mut holders = vec![None; rest.len()];
    for (number, handle) in sheet.handles.iter().enumerate() {
        let mut is_empty = true;
        let (mut low, mut high) = (Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN));
        for (holder, x) in holders.iter_mut().zip(rest) {
            let place = handle.turn * x + handle.shift;
            (low, high) = (low.inf(&place), high.sup(&place));
            if handle.holds(x) {
                is_empty &= holder.is_some();
                holder.get_or_insert(number);
            }
        }
        if is_empty {
            return Err(StepperError::EmptySheetHandle {
                handle: handle.name.clone(),
                boxes: Box::new([[handle.min, handle.max], [low, high]]),
            });
        }
    }
    Ok(holders)
}

/// The material on every face, by the map and the variation of the layer.
fn face_parameters(spec: &LayerSpec, driver: &Driver, region: &RegionMesh) -> Vec<FaceParameters> {
    let skin = &region.skin;
    let relative = relative_at_vertices(spec, driver, skin);
    let relative = relative_on_faces(spec, skin, &relative);
    let of_face = |relative: &RelativeProperties| {
        let local = relative.scaled(&spec.material);
        FaceParameters {
            young: local.young,
            poisson: local.poisson,
            thickness: local.thickness,
            normal_stiffness: 0.0,
            gradient_stiffness: 0.0,
        }
    };
    relative.as_slice().iter().map(of_face).collect()
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
