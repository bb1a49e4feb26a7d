//! A sheet on its mesh: what it is made of, where it is, and what holds it.

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_material::RelativeProperties;
use ruga_mesh::{EdgeId, Id, VertexId, face_areas, mean_edge_lengths};
use ruga_shell::{FaceParameters, LayerEnergy, LayerParameters, ShellError};
use ruga_solver::{Iteration, Kkt, LowerPattern, NewtonSettings, SolveReport, SolverError};

use super::Sheet;
use super::objective::{Scales, SheetObjective};
use super::plan::longest_side;
use crate::growth::PoseGrowth;
use crate::run::layer_objective::{gather, scatter};
use crate::skin::local_skin::{relative_at_vertices, relative_on_faces};
use crate::skin::skin_mesh::RegionMesh;
use crate::support::Moves;
use crate::support::contact::Contact;
use crate::support::motion::{Inertia, velocities};
use crate::support::obstacle::PlacedObstacle;
use crate::{CreaseReport, Dynamics, FaceState, LayerSpec, Modelling, PoseSpec, StepperError};

/// Distance at which an obstacle begins to push, in mean edges of the mesh: what it holds off lies on chords
/// between its vertices, which are about as far from a round obstacle.
const REACH: f64 = 0.1;

/// Levenberg damping in units of the mean membrane stiffness of a vertex: gives motions of a loose sheet a sign.
const DAMPING: f64 = 1e-10;

/// State of a free sheet during one pose: its mesh, its energy, what holds it, and where it is.
pub(super) struct SheetState<'a> {
    pub(super) spec: &'a LayerSpec,
    sheet: &'a Sheet,
    pub(super) region: RegionMesh,
    energy: LayerEnergy,
    pattern: LowerPattern,
    kkt: Kkt,
    free: Vec<VertexId>,
    /// The handle that holds a vertex.
    holders: Vec<Option<usize>>,
    masses: Vec<f64>,
    areas: Vec<f64>,
    damping: Vec<f64>,
    /// Material on every face, and its bending modulus, J.
    materials: Vec<FaceParameters>,
    moduli: Vec<f64>,
    /// Mean edge, m.
    edge: f64,
    scales: Scales,
    /// Pressure of an obstacle per depth, Pa/m.
    stiffness: f64,
    pub(super) moving: Moving,
    /// Faces whose natural curvature is more than their edges can show.
    pub(super) capped: usize,
}

/// Positions and velocities of a sheet, and places of obstacles.
#[derive(Clone, Debug)]
pub(super) struct Moving {
    pub(super) positions: Vec<Vector3<f64>>,
    /// Per second, or where a step is an equilibrium per whole pose.
    velocities: Vec<Vector3<f64>>,
    obstacles: Vec<PlacedObstacle>,
}

impl<'a> SheetState<'a> {
    /// The sheet at rest on the mesh of `region`.
    pub(super) fn new(
        driver: &Driver,
        (spec, sheet): (&'a LayerSpec, &'a Sheet),
        region: RegionMesh,
        modelling: &Modelling,
    ) -> Result<Self, StepperError> {
        let shell = |source| shell_error(spec, source);
        let skin = &region.skin;
        let holders = holders(sheet, &skin.rest.positions)?;
        let held: Vec<bool> = holders.iter().map(Option::is_some).collect();
        let materials = face_parameters(spec, driver, &region);
        let parameters = LayerParameters {
            tangential_stiffness: vec![0.0; skin.mesh.vertex_count()],
            faces: materials.clone(),
        };
        let (mesh, rest) = (&skin.mesh, skin.rest.positions.as_slice());
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let of_faces = |value: fn(&FaceParameters) -> f64| -> Vec<f64> {
            materials.iter().map(value).collect()
        };
        let membrane = mean(&of_faces(|face| face.young * face.thickness));
        let moduli = of_faces(|face| {
            face.young * face.thickness.powi(3) / (12.0 * (1.0 - face.poisson * face.poisson))
        });
        let mut energy =
            LayerEnergy::with_bending(mesh, rest, parameters, &held, modelling.bending)
                .map_err(shell)?;
        // A curved sheet has no stress where it is at rest.
        energy.set_rest_angles(rest).map_err(shell)?;
        let areas = energy.vertex_areas().to_vec();
        let mut masses = vec![0.0; areas.len()];
        let face_areas = face_areas(mesh, rest);
        for ((face, corners), material) in mesh.faces().iter().zip(&materials) {
            for v in corners {
                let density = spec.material.density * material.thickness;
                masses[v.index()] += face_areas[face] * density / 3.0;
            }
        }
        // Not the shortest edge: what is cut along a crease may be as small as it likes.
        let edge = mean(&mean_edge_lengths(mesh, rest));
        let free: Vec<VertexId> = (0..held.len())
            .map(VertexId::from_index)
            .filter(|v| !held[v.index()])
            .collect();
        if free.is_empty() {
            return Err(StepperError::NoRoom {
                layer: spec.name.clone(),
            });
        }
        let solver = |source| solver_error(spec, source);
        let (starts, entries) = energy.blocks().shared();
        let pattern = LowerPattern::new(starts, entries).map_err(solver)?;
        let unknowns = 3 * free.len();
        let weight = masses.iter().sum::<f64>() * sheet.gravity.norm();
        let rows = ruga_solver::ConstraintRows::new(vec![0], Vec::new(), Vec::new(), unknowns);
        let rows = rows.map_err(solver)?;
        let kkt = Kkt::new(&pattern, &rows, 3).map_err(solver)?;
        Ok(Self {
            damping: vec![DAMPING * membrane; unknowns],
            materials,
            scales: Scales::new(
                mean(&moduli),
                [edge, longest_side(rest)],
                (weight, masses.len() as f64),
            ),
            moduli,
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
            },
            capped: 0,
            spec,
            sheet,
            region,
            energy,
            pattern,
            kkt,
            free,
            holders,
            masses,
            areas,
        })
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.masses.len()
    }

    /// Puts handles, obstacles, growth and creases where they are at a fraction of a pose, and free vertices where
    /// their velocity takes them from an earlier one.
    pub(super) fn place(
        &mut self,
        driver: &Driver,
        (pose, moves): (&PoseSpec, &Moves<'_>),
        [from, time]: [f64; 2],
        inertia: Option<&Inertia>,
    ) -> Result<(), StepperError> {
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
            for v in &self.free {
                let i = v.index();
                self.moving.positions[i] = match inertia {
                    Some(inertia) => inertia.centres[i],
                    // Where equilibria follow each other they go on as before.
                    None => self.moving.positions[i] + self.moving.velocities[i] * (time - from),
                };
            }
        }
        self.grow(driver, pose, time)?;
        self.fold(pose, time)
    }

    fn grow(&mut self, driver: &Driver, pose: &PoseSpec, time: f64) -> Result<(), StepperError> {
        let growth = PoseGrowth::new(self.spec, pose);
        let Some(stretches) = growth.on_skin(driver, &self.region.skin, time) else {
            return Ok(());
        };
        let curvatures = growth.curls_on_skin(driver, &self.region.skin, time);
        let outcome = self.energy.set_rest_metric(stretches.as_slice());
        let outcome =
            outcome.and_then(|()| self.energy.set_natural_curvatures(curvatures.as_slice()));
        self.capped = outcome.map_err(|source| shell_error(self.spec, source))?;
        Ok(())
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
        let outcome = self.energy.set_creases(&creases);
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
        let states = self.energy.crease_states(&self.moving.positions);
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
        let positions = &self.moving.positions;
        let energies = self.energy.face_energies(positions, positions);
        let skin = &self.region.skin;
        let areas = face_areas(&skin.mesh, &skin.rest.positions);
        let faces = energies.iter().flatten().zip(areas.as_slice());
        let states = faces
            .zip(&self.materials)
            .map(|((energy, area), material)| FaceState {
                young: material.young,
                thickness: material.thickness,
                membrane_energy: energy.membrane / area,
                bending_energy: energy.bending / area,
                ..FaceState::default()
            });
        states.collect()
    }

    fn contact(&self) -> Contact {
        let reach = REACH * self.edge;
        Contact::of_stiffness(self.moving.obstacles.clone(), self.stiffness, reach)
    }

    fn is_touched(&self) -> bool {
        self.contact().value(&self.moving.positions, &self.areas) > 0.0
    }

    /// Whether a vertex got through an obstacle on its way from an earlier state.
    pub(super) fn has_passed(&self, before: &Moving) -> bool {
        let start = (before.obstacles.as_slice(), before.positions.as_slice());
        let contact = self.contact();
        contact.is_passed(start, &self.moving.positions, self.edge)
    }

    /// Finds the equilibrium near the present state, or the end of a step in time, and moves there.
    pub(super) fn minimise(
        &mut self,
        inertia: Option<&Inertia>,
        (modelling, settings): (&Modelling, &NewtonSettings),
        keep_going: &mut dyn FnMut(&Iteration) -> bool,
    ) -> Result<SolveReport, StepperError> {
        let mut unknowns = gather(&self.free, &self.moving.positions);
        let objective = SheetObjective {
            energy: &self.energy,
            free: &self.free,
            positions: &self.moving.positions,
            pattern: &self.pattern,
            damping: &self.damping,
            masses: &self.masses,
            areas: &self.areas,
            gravity: self.sheet.gravity,
            contact: self.contact(),
            inertia,
            scales: self.scales,
        };
        let settings = NewtonSettings {
            overshoot: self.is_touched(),
            ..*settings
        };
        let minimise = modelling.minimise;
        let kkt = &mut self.kkt;
        let solved = minimise(&objective, &[], &mut unknowns, kkt, &settings, keep_going);
        let report = solved.map_err(|source| solver_error(self.spec, source))?;
        scatter(&self.free, &unknowns, &mut self.moving.positions);
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
        self.energy.value(&self.moving.positions)
    }
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

fn shell_error(spec: &LayerSpec, source: ShellError) -> StepperError {
    StepperError::Shell {
        layer: spec.name.clone(),
        source,
    }
}

fn solver_error(spec: &LayerSpec, source: SolverError) -> StepperError {
    StepperError::Solver {
        layer: spec.name.clone(),
        source,
    }
}
