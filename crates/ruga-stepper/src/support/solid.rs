//! A soft body under a layer: its unknowns, its energies, and how the layer hangs on them.

mod energy;

use std::sync::Arc;

use nalgebra::Vector3;
use ruga_blend::{Driver, PosedSurface, Weights};
use ruga_lattice::{Embedding, Lattice, LatticeEnergy};
use ruga_mesh::{SparseRows, vertex_areas};
use ruga_solver::{ConstraintRows, LowerPattern, SolverError};

use super::contact::Contact;
use super::handles::Moves;
use super::interior::Interior;
use super::layout::Layout;
use super::line_anchors::LineAnchors;
use super::mass::{BodyMass, diagonal};
use super::obstacle::PlacedObstacle;
use super::prediction::Prediction;
use super::springs::Springs;
use super::{Body, posed};
use crate::skin::skin_mesh::SkinMesh;
use crate::support::motion::{Inertia, velocities};
use crate::{LayerSpec, StepperError};
use ruga_shell::{LayerEnergy, LineAnchor};

pub(crate) use energy::Frozen;

/// Levenberg damping of a node, in units of the lattice's mean stiffness: gives the motions of a free
/// body a sign.
const DAMPING: f64 = 1e-9;

/// Shape of a body at one moment, and what is around it.
#[derive(Clone, Debug)]
pub(crate) struct SolidState {
    /// Positions of the lattice nodes, m.
    pub(crate) q: Vec<Vector3<f64>>,
    /// Velocities of the nodes, m/s.
    pub(crate) velocities: Vec<Vector3<f64>>,
    pub(crate) obstacles: Vec<PlacedObstacle>,
    /// Positions to which the artist's vertices are drawn; empty where nothing draws them, m.
    pub(crate) targets: Vec<Vector3<f64>>,
}

/// A body that moves together with the layer on it.
///
/// ```text
/// E(x, q) = layer(x, B q) + lattice(q) + contact(x) + anchors(x, q) - weight . q
///           + 1/2 sum k |C q - target|^2 + f/2 (q - c)' M (q - c)
/// ```
/// `x` are the layer's vertices, `q` the lattice's nodes, `B` and `C` the embeddings of the layer's and
/// the artist's vertices (Rémillard and Kry 2013, eq. 11 to 15).
pub(crate) struct Solid {
    interior: Arc<Interior>,
    driver: Arc<Driver>,
    /// Places of the layer's vertices in the lattice.
    embedding: Embedding,
    /// Places of the artist's vertices in the lattice.
    control: Embedding,
    /// Energy over the free nodes, and over all.
    lattice: LatticeEnergy,
    all_nodes: LatticeEnergy,
    /// Number of every node among the free ones.
    free_of: Vec<Option<u32>>,
    mass: BodyMass,
    /// Weight on every node, N.
    weight: Vec<Vector3<f64>>,
    follow: Option<Follow>,
    /// Springs that hold crease lines of the layer.
    anchors: Option<LineAnchors>,
    layout: Layout,
    /// Whether springs hold the layer on it.
    is_held: bool,
    /// Contribution of the coordinates of held nodes to each row.
    held_terms: SparseRows,
    prediction: Prediction,
    /// Rest areas of the layer's vertices, m².
    areas: Vec<f64>,
    /// Young's moduli of interior and layer, Pa, and the layer's thickness, m.
    stiffness: [f64; 2],
    thickness: f64,
    pub(crate) state: SolidState,
}

/// Springs from the artist's vertices to where blend shapes put them.
#[derive(Clone, Debug)]
struct Follow {
    /// Stiffness at every vertex of the artist's, N/m.
    stiffness: Vec<f64>,
    /// Their Hessian in the lattice's pattern, N/m.
    hessian: Vec<f64>,
}

impl Solid {
    /// The body under `skin`, whose `energy` pins no vertex and whose vertices have these `masses` (kg).
    pub(crate) fn new(
        (interior, driver): (&Arc<Interior>, &Arc<Driver>),
        spec: &LayerSpec,
        (skin, energy): (&SkinMesh, &LayerEnergy),
        masses: &[f64],
    ) -> Result<Self, StepperError> {
        let (body, lattice) = (&interior.body, &interior.embedding_lattice.lattice);
        let solver = |source| StepperError::Solver {
            layer: spec.name.clone(),
            source,
        };
        let embedding = interior
            .embedding_lattice
            .embed(skin.points.points(), &skin.rest)?;
        let control = interior.embedding_lattice.embed_control(driver)?;
        let springs = Springs(energy.foundation_stiffness());
        let is_held = spec.coupling.has_foundation();
        let anchors = LineAnchors::new(lattice, spec, skin)?;
        let of_nodes = |pinned: &[bool]| -> Result<LatticeEnergy, StepperError> {
            // Springs couple nodes that share no element: their entries have to be there from the
            // beginning.
            let mut energy = LatticeEnergy::new(lattice, &body.material, pinned)?;
            if is_held {
                energy.couple_surface(&embedding, springs.stencils())?;
            }
            if let Some(anchors) = &anchors {
                anchors.couple(&mut energy)?;
            }
            Ok(energy)
        };
        let pinned = interior.held.pinned();
        // Held nodes have no unknowns, but they pull at the free ones when they move, and have
        // mass.
        let [free, all_nodes] = [of_nodes(&pinned)?, of_nodes(&vec![false; pinned.len()])?];
        let free_of = numbers(&free, lattice);
        let carried = (&embedding, masses);
        let mass = BodyMass::new(lattice, [&all_nodes, &free], body.density, carried)?;
        let follow = Follow::new(driver, &control, body, &free);
        let mut coupled = match &anchors {
            Some(anchors) => anchors.coupled_nodes(energy.vertex_count()),
            None => vec![Vec::new(); energy.vertex_count()],
        };
        // An upper layer hangs on the lower one alone.
        for (i, nodes) in coupled.iter_mut().enumerate().take(embedding.point_count()) {
            if is_held {
                nodes.extend(spring_nodes(&springs, &embedding, i));
            }
            *nodes = free_ones(nodes, &free_of);
        }
        let rest = lattice.rest_positions();
        Ok(Self {
            weight: weight(lattice, body, carried)?,
            layout: Layout::new(energy.blocks(), free.blocks(), &coupled).map_err(solver)?,
            held_terms: SparseRows::default(),
            prediction: Prediction::new(&free).map_err(solver)?,
            areas: energy.vertex_areas().to_vec(),
            stiffness: [body.material.young, spec.material.young],
            thickness: spec.material.thickness,
            state: SolidState {
                q: rest.to_vec(),
                velocities: vec![Vector3::zeros(); rest.len()],
                obstacles: body.obstacles.iter().map(PlacedObstacle::at_rest).collect(),
                targets: match &follow {
                    Some(_) => driver.rest().to_vec(),
                    None => Vec::new(),
                },
            },
            lattice: free,
            interior: Arc::clone(interior),
            driver: Arc::clone(driver),
            embedding,
            control,
            all_nodes,
            free_of,
            mass,
            follow,
            anchors,
            is_held,
        })
    }

    /// Replaces stiffness and depths of the springs along all edges of lines with an anchor, in the order of the
    /// mesh's.
    pub(crate) fn set_line_anchors(&mut self, on_edges: &[LineAnchor]) {
        if let Some(anchors) = &mut self.anchors {
            anchors.set(on_edges);
        }
    }

    /// Stands the energy on the present normals inside.
    pub(crate) fn hold(&mut self) {
        if let Some(anchors) = &mut self.anchors {
            anchors.hold(&self.state.q);
        }
    }

    /// Lower triangle of the Hessian by the layer's unknowns and the free nodes'.
    pub(crate) fn pattern(&self) -> &LowerPattern {
        &self.layout.pattern
    }

    /// The body's part of the Levenberg damping, N/m.
    pub(crate) fn damping(&self) -> impl Iterator<Item = f64> + use<> {
        let rest = self.interior.embedding_lattice.lattice.rest_positions();
        let (starts, rows) = self.lattice.pattern();
        let mut hessian = vec![0.0; rows.len()];
        self.lattice.hessian(rest, &mut hessian, None);
        let unknowns = self.lattice.dof_count();
        let sum: f64 = starts[..unknowns].iter().map(|&k| hessian[k]).sum();
        std::iter::repeat_n(DAMPING * sum / unknowns.max(1) as f64, unknowns)
    }

    /// Replaces rows of the layer by `H (x - B q)`: averages of the layer against the same averages of
    /// the surface below.
    pub(crate) fn hang(
        &mut self,
        of_layer: &ConstraintRows,
    ) -> Result<ConstraintRows, SolverError> {
        let layer = self.layout.layer_unknowns();
        let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        let mut weights = vec![0.0; self.free_of.len()];
        self.held_terms = SparseRows::default();
        for row in 0..of_layer.count() {
            let (own, own_weights) = of_layer.row(row);
            columns.extend_from_slice(own);
            values.extend_from_slice(own_weights);
            // A row averages one component.
            let axis = own.first().map_or(0, |column| column % 3);
            for (column, weight) in own.iter().zip(own_weights) {
                for (node, fraction) in self.embedding.rows().row(column / 3) {
                    weights[node as usize] += weight * fraction;
                }
            }
            let mut held = Vec::new();
            for (node, weight) in weights.iter_mut().enumerate() {
                let weight = std::mem::take(weight);
                match self.free_of[node] {
                    _ if weight == 0.0 => {}
                    Some(free) => {
                        columns.push(layer + 3 * free as usize + axis);
                        values.push(-weight);
                    }
                    None => held.push(((3 * node + axis) as u32, weight)),
                }
            }
            self.held_terms.push_row(&mut held);
            starts.push(columns.len());
        }
        ConstraintRows::new(starts, columns, values, layer + self.lattice.dof_count())
    }

    /// Right-hand sides of the rows, by the held nodes where they are.
    pub(crate) fn row_targets(&self) -> Vec<f64> {
        let coordinates: Vec<f64> = self.state.q.iter().flatten().copied().collect();
        self.held_terms.apply(&coordinates)
    }

    /// The body's surface under the layer's vertices; where it has collapsed with the frame of `before`.
    pub(crate) fn surface(&self, before: &PosedSurface) -> PosedSurface {
        let all = 0..self.embedding.point_count();
        posed((&self.embedding, all), &self.state.q, before)
    }

    /// Puts handles, obstacles and targets where they are at `time`; the inside moves with the handles.
    pub(crate) fn place(
        &mut self,
        (moves, weights): (&Moves<'_>, &Weights),
        time: f64,
    ) -> Result<(), SolverError> {
        let mut steps = self.handle_displacements(moves, time);
        // Without a handle that moves there is nothing to predict from.
        if steps.iter().any(|step| *step != Vector3::zeros()) {
            let both = [&self.all_nodes, &self.lattice];
            match self.prediction.fill_in(both, &self.state.q, &mut steps) {
                // Then the elements beside the handles take up all of the motion.
                Ok(()) | Err(SolverError::Breakdown { .. }) => {}
                Err(source) => return Err(source),
            }
        }
        self.move_nodes(&steps);
        self.set_surroundings((moves, weights), time);
        Ok(())
    }

    /// Does the same for a step in time that begins with the layer at `x` (m): the free nodes go where
    /// their velocity takes them, unless something is touched; velocities then lead into obstacles, and
    /// Newton's method is up to twice as long on its way out.
    pub(crate) fn place_in_time(
        &mut self,
        (moves, weights): (&Moves<'_>, &Weights),
        time: f64,
        (inertia, x): (&Inertia, &[Vector3<f64>]),
    ) {
        let mut steps = self.handle_displacements(moves, time);
        if !self.is_touched(x) {
            for &node in self.lattice.free_nodes() {
                let node = node as usize;
                steps[node] = inertia.centres[node] - self.state.q[node];
            }
        }
        self.move_nodes(&steps);
        self.set_surroundings((moves, weights), time);
    }

    fn move_nodes(&mut self, steps: &[Vector3<f64>]) {
        for (q, step) in self.state.q.iter_mut().zip(steps) {
            *q += step;
        }
    }

    fn set_surroundings(&mut self, (moves, weights): (&Moves<'_>, &Weights), time: f64) {
        self.state.obstacles = moves.obstacles(time);
        if self.follow.is_some() {
            self.state.targets = self.driver.pose(&weights.scaled(time));
        }
    }

    /// Displacements of the held nodes from where they are to where they are at `time`; 0 for others.
    fn handle_displacements(&self, moves: &Moves<'_>, time: f64) -> Vec<Vector3<f64>> {
        let rest = self.interior.embedding_lattice.lattice.rest_positions();
        let handles = self.interior.body.handles.len();
        let placements: Vec<_> = (0..handles).map(|i| moves.handle(i, time)).collect();
        let holders = self.interior.held.holder.iter();
        let nodes = holders.zip(rest).zip(&self.state.q);
        let step = |((holder, rest), q): ((&Option<usize>, &Vector3<f64>), &Vector3<f64>)| {
            holder.map_or(Vector3::zeros(), |i| placements[i].apply(rest) - q)
        };
        nodes.map(step).collect()
    }

    /// Takes over the velocities of a step from nodes at `start` (m) that took so many seconds.
    pub(crate) fn take_velocities(&mut self, start: &[Vector3<f64>], time_step: f64) {
        self.state.velocities = velocities(start, &self.state.q, time_step);
    }

    /// The positions that obstacles touch: of two sheets one on the other those of the upper one.
    fn outer<'x>(&self, x: &'x [Vector3<f64>]) -> &'x [Vector3<f64>] {
        &x[x.len() - self.areas.len()..]
    }

    fn contact(&self) -> Contact {
        let obstacles = self.state.obstacles.clone();
        Contact::new(obstacles, self.stiffness, self.thickness)
    }

    /// Whether an obstacle pushes at a layer with its vertices at `x` (m).
    pub(crate) fn is_touched(&self, x: &[Vector3<f64>]) -> bool {
        self.contact().value(self.outer(x), &self.areas) > 0.0
    }

    /// Whether a vertex got through an obstacle on its way from `x` (m) among the obstacles of an
    /// earlier state to where it is `now`.
    pub(crate) fn has_passed(
        &self,
        (before, x): (&SolidState, &[Vector3<f64>]),
        now: &[Vector3<f64>],
    ) -> bool {
        let start = (before.obstacles.as_slice(), self.outer(x));
        self.contact()
            .is_passed(start, self.outer(now), self.thickness)
    }

    /// Deepest displacement of a vertex into an obstacle, m.
    pub(crate) fn penetration(&self, x: &[Vector3<f64>]) -> f64 {
        self.contact().penetration(self.outer(x))
    }

    /// Deepest overlap of the walls of a slit (m), and the name of its crease; `None` where no walls overlap.
    pub(crate) fn slit_overlap(&self) -> Option<(f64, &str)> {
        self.interior.embedding_lattice.slit_overlap(&self.state.q)
    }

    /// Coordinates of the free nodes.
    pub(crate) fn unknowns(&self) -> Vec<f64> {
        self.lattice.unknowns(&self.state.q)
    }

    pub(crate) fn set_unknowns(&mut self, unknowns: &[f64]) {
        self.lattice.set_unknowns(unknowns, &mut self.state.q);
    }

    /// All nodes with the free ones there, and the surface below the layer's vertices.
    pub(crate) fn at(&self, unknowns: &[f64]) -> (Vec<Vector3<f64>>, Vec<Vector3<f64>>) {
        let mut q = self.state.q.clone();
        self.lattice.set_unknowns(unknowns, &mut q);
        let below = self.embedding.positions(&q);
        (q, below)
    }

    /// Elastic energy of the inside, J.
    pub(crate) fn elastic_energy(&self) -> f64 {
        self.lattice.value(&self.state.q)
    }

    /// Derivative of the energy of the line anchors by a layer's vertices at `x` (m), some of which are there several
    /// times, N.
    pub(crate) fn anchor_pulls(&self, x: &[Vector3<f64>]) -> Vec<(u32, Vector3<f64>)> {
        let anchors = self.anchors.as_ref();
        anchors.map_or_else(Vec::new, |anchors| {
            anchors.gradient(x, &self.state.q).on_vertices
        })
    }

    /// Energy of the line anchors between it and a layer with its vertices at `x` (m), J.
    pub(crate) fn anchor_energy(&self, x: &[Vector3<f64>]) -> f64 {
        let anchors = self.anchors.as_ref();
        anchors.map_or(0.0, |anchors| anchors.value(x, &self.state.q))
    }

    /// Positions of the artist's vertices, in the order of [`Driver::pose`], m.
    pub(crate) fn artist_positions(&self) -> Vec<Vector3<f64>> {
        self.control.positions(&self.state.q)
    }
}

#[cfg(test)]
impl Solid {
    pub(crate) fn blocks(&self) -> &ruga_mesh::BlockPattern {
        &self.layout.blocks
    }

    pub(crate) fn momentum(&self) -> Vec<Vector3<f64>> {
        self.mass.times(&self.state.velocities)
    }
}

impl Follow {
    fn new(
        driver: &Driver,
        control: &Embedding,
        body: &Body,
        lattice: &LatticeEnergy,
    ) -> Option<Self> {
        let stiffness = body.follow?;
        let areas = vertex_areas(driver.topology(), driver.rest());
        // Springs act by area, or what the artist has meshed finely would be drawn harder.
        let stiffness: Vec<f64> = areas.iter().map(|area| stiffness * area).collect();
        let mut hessian = vec![0.0; lattice.pattern().1.len()];
        lattice.add_pulled_back(control, &diagonal(&stiffness), &mut hessian);
        Some(Self { stiffness, hessian })
    }
}

fn numbers(free: &LatticeEnergy, lattice: &Lattice) -> Vec<Option<u32>> {
    let mut free_of = vec![None; lattice.node_count()];
    for (number, &node) in free.free_nodes().iter().enumerate() {
        free_of[node as usize] = Some(number as u32);
    }
    free_of
}

fn weight(
    lattice: &Lattice,
    body: &Body,
    (embedding, masses): (&Embedding, &[f64]),
) -> Result<Vec<Vector3<f64>>, StepperError> {
    let gravity = &body.gravity;
    let mut weight = lattice.gravity_load(body.density, gravity)?;
    let of_layer: Vec<_> = masses.iter().map(|mass| gravity * *mass).collect();
    for (sum, force) in weight.iter_mut().zip(embedding.pull_back(&of_layer)) {
        *sum += force;
    }
    Ok(weight)
}

/// The nodes that the springs couple a vertex with, some of them several times.
fn spring_nodes(
    springs: &Springs,
    embedding: &Embedding,
    vertex: usize,
) -> impl Iterator<Item = u32> {
    let rows = springs.neighbours(vertex).map(|j| embedding.rows().row(j));
    rows.flatten().map(|(node, _)| node)
}

/// Numbers of the free ones among `nodes`, each once, ascending.
fn free_ones(nodes: &[u32], free_of: &[Option<u32>]) -> Vec<u32> {
    let free = nodes.iter().filter_map(|&node| free_of[node as usize]);
    let mut free: Vec<u32> = free.collect();
    free.sort_unstable();
    free.dedup();
    free
}
