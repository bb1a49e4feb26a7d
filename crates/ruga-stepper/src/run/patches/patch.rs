//! One patch of a layer, and what it is solved with.

use nalgebra::Vector3;
use ruga_mesh::VertexId;
use ruga_shell::{LayerPart, PartIndex};
use ruga_solver::{
    ConstraintRows, EliminationOrder, Iteration, Kkt, LowerPattern, Minimise, NewtonSettings,
    Objective, SolveReport, SolverError,
};

use super::Whole;
use crate::run::layer_objective::LayerObjective;
use crate::run::layer_run::SLOWLY_LESS;

/// Some vertices that move together, while all others stand still.
pub(super) struct Patch {
    /// Ranks of these vertices among the layer's free ones, ascending.
    pub(super) ranks: Vec<usize>,
    pub(super) rows: Vec<PatchRow>,
    /// Numbers of the patches that see its vertices move.
    pub(super) neighbours: Vec<usize>,
    /// Share of the layer's free vertices.
    pub(super) share: f64,
    /// Whether a whole step that ends less exact solves would have raised its energy.
    pub(super) is_exact: bool,
    /// Convexification of the first step of the last solve.
    relaxation: f64,
    /// What it is solved with, where that is kept from one solve to the next.
    kept: Option<System>,
    /// Order of elimination, where that is all that is kept: a tenth of the work on a layer, for little memory.
    order: Option<EliminationOrder>,
}

/// What a patch has of one averaging constraint.
pub(super) struct PatchRow {
    /// Number of the constraint in the layer.
    pub(super) row: usize,
    /// Share of its absolute weights.
    pub(super) share: f64,
    /// Whether no other patch has more of it.
    pub(super) is_kept: bool,
}

/// Energy of a patch, and what its matrix is factorised with.
struct System {
    part: LayerPart,
    /// The free vertices by their number in the part.
    free: Vec<VertexId>,
    /// Rank of each vertex of the part among the layer's free ones; `None` where it is pinned.
    around: Vec<Option<usize>>,
    pattern: LowerPattern,
    kkt: Kkt,
    damping: Vec<f64>,
}

/// What a patch has become.
pub(super) struct Solved {
    /// Coordinates of its free vertices, m.
    pub(super) own: Vec<f64>,
    /// Energy that it lost, less what restoring constraints took, J.
    pub(super) gain: f64,
    pub(super) report: SolveReport,
}

impl Patch {
    /// A patch of the vertices with these `ranks` among so many free ones, which knows of no rows yet.
    pub(super) fn new(ranks: Vec<usize>, free: usize) -> Self {
        Self {
            rows: Vec::new(),
            neighbours: Vec::new(),
            share: ranks.len() as f64 / free.max(1) as f64,
            is_exact: false,
            relaxation: 0.0,
            kept: None,
            order: None,
            ranks,
        }
    }

    /// Minimises the energy over its own vertices, the others at their coordinates in `x`. `missing` is what each
    /// row of the layer lacks of its right-hand side, and `keeps` whether the next solve of the same layer will find
    /// again what this one has set up.
    pub(super) fn solve(
        &mut self,
        (whole, index): (Whole<'_>, &PartIndex),
        (x, missing): (&[f64], &[f64]),
        (minimise, settings): (Minimise, &NewtonSettings),
        keeps: bool,
    ) -> Result<Solved, SolverError> {
        let mut system = match self.kept.take() {
            Some(system) => system,
            None => {
                let order = self.order.take();
                System::new((&whole, index), self, order)?
            }
        };
        let own =
            |values: &[f64]| -> Vec<f64> { coordinates(&self.ranks).map(|i| values[i]).collect() };
        let mut unknowns = own(x);
        let targets = self.targets(system.kkt.rows(), (&unknowns, missing))?;
        let vertices = system.part.vertices().iter().zip(&system.around);
        let positions: Vec<_> = vertices
            .map(|(&v, rank)| match rank {
                Some(rank) => Vector3::from_column_slice(&x[3 * rank..3 * rank + 3]),
                None => whole.positions[v as usize],
            })
            .collect();
        let [reaction, base] = whole.load.map(own);
        let objective = LayerObjective {
            energy: system.part.energy(),
            free: &system.free,
            positions: &positions,
            pattern: system.pattern.clone(),
            damping: &system.damping,
            reaction: &reaction,
            base: &base,
            inertia: None,
            solid: None,
            vertex_area: whole.scales.vertex_area,
            energy_scale: whole.scales.energy * self.share,
            wrinkling: whole.scales.wrinkling,
            thickness: whole.scales.thickness,
        };
        let settings = NewtonSettings {
            first_relaxation: SLOWLY_LESS * self.relaxation,
            ..settings.clone()
        };
        let before = objective.value(&unknowns);
        let (kkt, goes_on) = (&mut system.kkt, &mut |_: &Iteration| true);
        let report = minimise(&objective, &targets, &mut unknowns, kkt, &settings, goes_on)?;
        if report.converged && report.first_relaxation > 0.0 {
            self.relaxation = report.first_relaxation;
        }
        if keeps {
            // Else there would be a matrix and a factor of every patch at once.
            system.kkt.release();
            self.kept = Some(system);
        } else {
            self.order = Some(system.kkt.into_order());
        }
        Ok(Solved {
            gain: before - report.energy,
            own: unknowns,
            report,
        })
    }

    /// Forgets what it is solved with, but for the order of elimination.
    pub(super) fn release(&mut self) {
        if let Some(system) = self.kept.take() {
            self.order = Some(system.kkt.into_order());
        }
    }

    /// Takes over what has changed in the layer since the last solve.
    pub(super) fn follow(&mut self, whole: &Whole<'_>) {
        if let Some(system) = &mut self.kept {
            system.part.follow(whole.energy);
        }
    }

    /// Right-hand sides of its `rows`: what its `own` coordinates have, and where it keeps the row what that is
    /// `missing`.
    fn targets(
        &self,
        rows: &ConstraintRows,
        (own, missing): (&[f64], &[f64]),
    ) -> Result<Vec<f64>, SolverError> {
        let mut targets = vec![0.0; self.rows.len()];
        rows.mul(own, &mut targets)?;
        let kept = targets.iter_mut().zip(&self.rows);
        for (target, part) in kept.filter(|(_, part)| part.is_kept) {
            *target += missing[part.row];
        }
        Ok(targets)
    }
}

impl System {
    /// What `patch` is solved with, which is eliminated in this `order`, if that is known.
    fn new(
        (whole, index): (&Whole<'_>, &PartIndex),
        patch: &Patch,
        order: Option<EliminationOrder>,
    ) -> Result<Self, SolverError> {
        let free = whole.energy.free_vertices();
        let moving: Vec<u32> = patch.ranks.iter().map(|&rank| free[rank]).collect();
        let part = index.part(whole.energy, &moving);
        let energy = part.energy();
        let (starts, entries) = energy.blocks().shared();
        let pattern = LowerPattern::new(starts, entries)?;
        let rows = restricted(whole.rows, &patch.rows, &patch.ranks)?;
        Ok(Self {
            kkt: match order {
                None => Kkt::new(&pattern, &rows, 3)?,
                Some(order) => Kkt::with_order(&pattern, &rows, 3, order)?,
            },
            free: energy
                .free_vertices()
                .iter()
                .map(|&v| VertexId(v))
                .collect(),
            around: part
                .vertices()
                .iter()
                .map(|v| free.binary_search(v).ok())
                .collect(),
            damping: coordinates(&patch.ranks)
                .map(|i| whole.damping[i])
                .collect(),
            pattern,
            part,
        })
    }
}

/// Numbers of the coordinates of free vertices with these ranks.
pub(super) fn coordinates(ranks: &[usize]) -> impl Iterator<Item = usize> + '_ {
    ranks.iter().flat_map(|rank| 3 * rank..3 * rank + 3)
}

/// What the vertices with these `ranks`, ascending, have of some rows of a layer.
fn restricted(
    rows: &ConstraintRows,
    parts: &[PatchRow],
    ranks: &[usize],
) -> Result<ConstraintRows, SolverError> {
    let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for part in parts {
        let (all, weights) = rows.row(part.row);
        for (column, weight) in all.iter().zip(weights) {
            if let Ok(own) = ranks.binary_search(&(column / 3)) {
                columns.push(3 * own + column % 3);
                values.push(*weight);
            }
        }
        starts.push(columns.len());
    }
    ConstraintRows::new(starts, columns, values, 3 * ranks.len())
}
