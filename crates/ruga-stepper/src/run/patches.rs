//! A large layer, solved in overlapping patches.
//!
//! The cost of one factorisation grows with the area of a layer to the power of 1.5, and one defect that
//! slides somewhere makes the whole of the layer go on. In patches each place takes the steps that it
//! needs: a patch is solved while everything around it stands still, patch after patch, until none of them
//! moves much any more (multiplicative Schwarz method, on the energy instead of a linear system). Patches
//! overlap, so that what one of them leaves at its border is mended by the next.
//!
//! An averaging constraint reaches over several patches. The one with most of its weight restores it; in
//! the others the sum over their own vertices stays as it is, so that they cannot violate it.

mod division;
mod width;

use nalgebra::Vector3;
use rayon::prelude::*;
use ruga_mesh::{TriMesh, VertexId};
use ruga_shell::{LayerEnergy, LayerPart};
use ruga_solver::{
    ConstraintRows, Inertia, Iteration, Kkt, LowerPattern, Minimise, NewtonSettings, Objective,
    SolveReport, SolverError, StopRule,
};

use crate::Modelling;
use crate::run::layer_objective::LayerObjective;
use crate::run::layer_run::SLOWLY_LESS;
use crate::run::neighbourhood::Neighbourhood;
use division::{coloured, divided};

pub(crate) use width::Width;

/// Overlap in edges at least. A smile at 6 points per wavelength ends .2 % from the whole's amplitude with six
/// edges, and 3 % from it with three.
const LEAST_OVERLAP: f64 = 4.0;

/// Share of a constraint's absolute weights that a patch has to have, or it does not know of it: what such
/// a patch can violate is less than what the tolerance of its own steps leaves.
const LEAST_SHARE: f64 = 1e-3;

/// Gain of a sweep, in energy scales, at which another is not worth it. The seams between patches then
/// hardly move, and a hand with bent fingers has .2 % more energy than after ten times the work on the whole.
const LITTLE: f64 = 1e-3;

/// The patches of a layer's mesh.
pub(crate) struct Patches {
    patches: Vec<Patch>,
    /// Numbers of patches that may be solved at the same time, as no stencil joins them.
    colours: Vec<Vec<usize>>,
    width: Width,
}

/// Some vertices that move together, while all others stand still.
struct Patch {
    part: LayerPart,
    /// Its free vertices by their number in the part.
    free: Vec<VertexId>,
    /// Ranks of these among the layer's free ones.
    ranks: Vec<usize>,
    /// Rank of each vertex of the part among the layer's free ones; `None` where it is pinned.
    around: Vec<Option<usize>>,
    pattern: LowerPattern,
    rows: Vec<PatchRow>,
    kkt: Kkt,
    /// Numbers of the patches that see its vertices move.
    neighbours: Vec<usize>,
    damping: Vec<f64>,
    /// Share of the layer's free vertices.
    share: f64,
    /// Convexification of the first step of the last solve.
    relaxation: f64,
}

/// What a patch has of one averaging constraint.
struct PatchRow {
    /// Number of the constraint in the layer.
    row: usize,
    /// Share of its absolute weights.
    share: f64,
    /// Whether no other patch has more of it.
    is_kept: bool,
}

/// A layer that is solved in patches: everything about it but where its free vertices are.
#[derive(Clone, Copy)]
pub(crate) struct Whole<'a> {
    pub(crate) energy: &'a LayerEnergy,
    /// Positions of all vertices, of which only the pinned ones are read, m.
    pub(crate) positions: &'a [Vector3<f64>],
    /// Dead load on the free vertices, N, and where these are when it does no work, m.
    pub(crate) load: [&'a [f64]; 2],
    pub(crate) rows: &'a ConstraintRows,
    /// Right-hand sides of the rows.
    pub(crate) targets: &'a [f64],
    pub(crate) scales: Scales<'a>,
}

/// Scales of a layer's objective.
#[derive(Clone, Copy)]
pub(crate) struct Scales<'a> {
    /// Energy that wrinkling is about, J.
    pub(crate) energy: f64,
    /// Mean area of a vertex, m².
    pub(crate) vertex_area: f64,
    pub(crate) wrinkling: &'a ruga_material::Wrinkling,
    /// Thickness of the layer, m.
    pub(crate) thickness: f64,
}

/// What a patch has become.
struct Solved {
    /// Coordinates of its free vertices, m.
    own: Vec<f64>,
    /// Energy that it lost, less what restoring constraints took, J.
    gain: f64,
    report: SolveReport,
}

impl Patches {
    /// Divides a layer's free vertices, at `positions` at rest (m), into patches that reach into each other;
    /// `None` where one would do, or for a layer of two sheets.
    pub(crate) fn new(
        (mesh, positions): (&TriMesh, &[Vector3<f64>]),
        energy: &LayerEnergy,
        (rows, damping): (&ConstraintRows, &[f64]),
        (modelling, width): (&Modelling, Width),
    ) -> Result<Option<Self>, SolverError> {
        let free = energy.free_vertices();
        let overlap = (width.overlap() * modelling.points_per_wavelength).max(LEAST_OVERLAP);
        let cores = divided(
            positions,
            free.to_vec(),
            width.core(modelling.most_in_whole()),
        );
        if cores.len() < 2 {
            return Ok(None);
        }
        let around = Neighbourhood::new(mesh);
        let mut patches = Vec::with_capacity(cores.len());
        for core in &cores {
            let moving = around.grown(core, overlap.ceil() as usize, free);
            let Some(part) = LayerPart::new(energy, &moving) else {
                return Ok(None);
            };
            patches.push(Patch::new(part, (&moving, free), (rows, damping))?);
        }
        keep_rows(&mut patches, rows.count());
        let colours = coloured(&join(&mut patches, free.len()));
        Ok(Some(Self {
            patches,
            colours,
            width,
        }))
    }

    /// Minimises the energy over all free vertices, from their coordinates `x` (m), and leaves it there.
    ///
    /// It has converged when a sweep gains [`LITTLE`] and every patch is at a minimum, to the tolerance of
    /// `settings`. Sweeps that do not get there end without, as the patches' width says. `keep_going` is
    /// asked whenever some patches are done.
    pub(crate) fn minimise(
        &mut self,
        whole: Whole<'_>,
        x: &mut [f64],
        (minimise, settings): (Minimise, &NewtonSettings),
        keep_going: &mut dyn FnMut(&Iteration) -> bool,
    ) -> Result<SolveReport, SolverError> {
        for patch in &mut self.patches {
            patch.part.follow(whole.energy);
        }
        let tolerated = settings.energy_tolerance * whole.scales.energy;
        let mut is_due = vec![true; self.patches.len()];
        let mut reports: Vec<Option<SolveReport>> = vec![None; self.patches.len()];
        let mut done = Work::default();
        let (mut before, mut sweeps) = (f64::INFINITY, 0);
        loop {
            let mut gained = 0.0;
            for colour in &self.colours {
                let due: Vec<usize> = colour.iter().copied().filter(|&i| is_due[i]).collect();
                let seen: &[f64] = x;
                let solved = each(&mut self.patches, &due, |patch| {
                    patch.solve(whole, seen, (minimise, settings))
                });
                for (&i, solved) in due.iter().zip(solved) {
                    let (solved, patch) = (solved?, &self.patches[i]);
                    for (value, place) in solved.own.iter().zip(coordinates(&patch.ranks)) {
                        x[place] = *value;
                    }
                    done.add(&solved.report, patch.share);
                    gained += solved.gain.abs();
                    // Where a constraint had to be restored the energy may have risen.
                    let is_moved = solved.gain.abs() > tolerated * patch.share;
                    // One that has not converged may have, once its neighbours have moved.
                    is_due[i] = false;
                    if is_moved {
                        patch.neighbours.iter().for_each(|&j| is_due[j] = true);
                    }
                    reports[i] = Some(solved.report);
                }
                if !keep_going(&done.iteration(settings)) {
                    return Ok(done.report(&reports, Some(StopRule::Interrupted)));
                }
            }
            if gained <= LITTLE * whole.scales.energy || is_due.iter().all(|due| !due) {
                return Ok(done.report(&reports, None));
            }
            sweeps += 1;
            if self.width.ends(sweeps, gained / before) {
                return Ok(done.report(&reports, Some(StopRule::IterationLimit)));
            }
            before = gained;
        }
    }
}

/// What `solve` makes of those of the `patches` that are `due`, which are ascending, side by side where the
/// pool has threads for it.
fn each<T: Send>(
    patches: &mut [Patch],
    due: &[usize],
    solve: impl Fn(&mut Patch) -> T + Send + Sync,
) -> Vec<T> {
    let all = patches.iter_mut().enumerate();
    let chosen = all.filter(|(i, _)| due.binary_search(i).is_ok());
    let chosen: Vec<&mut Patch> = chosen.map(|(_, patch)| patch).collect();
    chosen.into_par_iter().map(solve).collect()
}

impl Patch {
    /// A patch of the vertices that are `moving`, of all that are `free` in the layer; both are ascending.
    fn new(
        part: LayerPart,
        (moving, free): (&[u32], &[u32]),
        (rows, damping): (&ConstraintRows, &[f64]),
    ) -> Result<Self, SolverError> {
        let rank = |v: &u32| free.binary_search(v).ok();
        let ranks: Vec<usize> = moving.iter().filter_map(rank).collect();
        let energy = part.energy();
        let (starts, entries) = energy.pattern();
        let pattern = LowerPattern::new(starts.to_vec(), entries.to_vec())?;
        let (rows, own) = restricted(rows, &ranks)?;
        Ok(Self {
            kkt: Kkt::new(&pattern, &own, 3)?,
            free: energy
                .free_vertices()
                .iter()
                .map(|&v| VertexId(v))
                .collect(),
            around: part.vertices().iter().map(rank).collect(),
            damping: coordinates(&ranks).map(|i| damping[i]).collect(),
            share: ranks.len() as f64 / free.len().max(1) as f64,
            neighbours: Vec::new(),
            relaxation: 0.0,
            pattern,
            ranks,
            rows,
            part,
        })
    }

    /// Minimises the energy over its own vertices, the others at their coordinates in `x`.
    fn solve(
        &mut self,
        whole: Whole<'_>,
        x: &[f64],
        (minimise, settings): (Minimise, &NewtonSettings),
    ) -> Result<Solved, SolverError> {
        let own =
            |values: &[f64]| -> Vec<f64> { coordinates(&self.ranks).map(|i| values[i]).collect() };
        let mut unknowns = own(x);
        let targets = self.targets(&whole, x, &unknowns)?;
        let vertices = self.part.vertices().iter().zip(&self.around);
        let positions: Vec<_> = vertices
            .map(|(&v, rank)| match rank {
                Some(rank) => Vector3::from_column_slice(&x[3 * rank..3 * rank + 3]),
                None => whole.positions[v as usize],
            })
            .collect();
        let [reaction, base] = whole.load.map(own);
        let objective = LayerObjective {
            energy: self.part.energy(),
            free: &self.free,
            positions: &positions,
            pattern: self.pattern.clone(),
            damping: &self.damping,
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
        let (kkt, goes_on) = (&mut self.kkt, &mut |_: &Iteration| true);
        let solved = minimise(&objective, &targets, &mut unknowns, kkt, &settings, goes_on);
        // Those of all patches together are nearly half of what patches take.
        self.kkt.release();
        let report = solved?;
        if report.converged && report.first_relaxation > 0.0 {
            self.relaxation = report.first_relaxation;
        }
        Ok(Solved {
            gain: before - report.energy,
            own: unknowns,
            report,
        })
    }

    /// Right-hand sides of its rows: what is left of a target by all other vertices where it keeps the row,
    /// and else what its `own` coordinates have.
    fn targets(&self, whole: &Whole<'_>, x: &[f64], own: &[f64]) -> Result<Vec<f64>, SolverError> {
        let mut targets = vec![0.0; self.rows.len()];
        self.kkt.rows().mul(own, &mut targets)?;
        for (target, part) in targets.iter_mut().zip(&self.rows) {
            if part.is_kept {
                let (columns, weights) = whole.rows.row(part.row);
                let terms = columns.iter().zip(weights);
                let now: f64 = terms.map(|(&i, weight)| weight * x[i]).sum();
                *target += whole.targets[part.row] - now;
            }
        }
        Ok(targets)
    }
}

/// Numbers of the coordinates of free vertices with these ranks.
fn coordinates(ranks: &[usize]) -> impl Iterator<Item = usize> + '_ {
    ranks.iter().flat_map(|rank| 3 * rank..3 * rank + 3)
}

/// What the vertices with these `ranks`, ascending, have of the rows of a layer.
fn restricted(
    rows: &ConstraintRows,
    ranks: &[usize],
) -> Result<(Vec<PatchRow>, ConstraintRows), SolverError> {
    let (mut parts, mut starts) = (Vec::new(), vec![0]);
    let (mut columns, mut values) = (Vec::new(), Vec::new());
    for row in 0..rows.count() {
        let (all, weights) = rows.row(row);
        let whole: f64 = weights.iter().map(|weight| weight.abs()).sum();
        let of_patch = |(&column, &weight): (&usize, &f64)| {
            let own = ranks.binary_search(&(column / 3)).ok()?;
            Some((3 * own + column % 3, weight))
        };
        let own: Vec<(usize, f64)> = all.iter().zip(weights).filter_map(of_patch).collect();
        let share = own.iter().map(|(_, weight)| weight.abs()).sum::<f64>() / whole;
        if share > LEAST_SHARE {
            columns.extend(own.iter().map(|(column, _)| column));
            values.extend(own.iter().map(|(_, weight)| weight));
            starts.push(columns.len());
            parts.push(PatchRow {
                row,
                share,
                is_kept: false,
            });
        }
    }
    let own = ConstraintRows::new(starts, columns, values, 3 * ranks.len())?;
    Ok((parts, own))
}

/// Lets every row be kept by the patch that has most of it.
fn keep_rows(patches: &mut [Patch], rows: usize) {
    let mut most = vec![0.0_f64; rows];
    for part in patches.iter().flat_map(|patch| &patch.rows) {
        most[part.row] = most[part.row].max(part.share);
    }
    let mut is_kept = vec![false; rows];
    for part in patches.iter_mut().flat_map(|patch| &mut patch.rows) {
        // Of equals the first.
        part.is_kept = part.share == most[part.row] && !is_kept[part.row];
        is_kept[part.row] |= part.is_kept;
    }
}

/// Finds the neighbours of every patch, of a layer with so many free vertices.
fn join(patches: &mut [Patch], free: usize) -> Vec<Vec<usize>> {
    let mut movers = vec![Vec::new(); free];
    for (i, patch) in patches.iter().enumerate() {
        patch.ranks.iter().for_each(|&rank| movers[rank].push(i));
    }
    let mut neighbours = vec![Vec::new(); patches.len()];
    for (i, patch) in patches.iter().enumerate() {
        for &mover in patch
            .around
            .iter()
            .flatten()
            .flat_map(|&rank| &movers[rank])
        {
            if mover != i {
                neighbours[i].push(mover);
                neighbours[mover].push(i);
            }
        }
        neighbours[i].sort_unstable();
        neighbours[i].dedup();
    }
    for (patch, near) in patches.iter_mut().zip(&mut neighbours) {
        near.sort_unstable();
        near.dedup();
        patch.neighbours.clone_from(near);
    }
    neighbours
}

/// What the solves of all patches took together, each counted by its share of the layer.
#[derive(Default)]
struct Work {
    iterations: f64,
    factorizations: f64,
    relaxation: f64,
    first_relaxation: f64,
    shift: f64,
    left_saddle: bool,
}

impl Work {
    fn add(&mut self, report: &SolveReport, share: f64) {
        self.iterations += share * report.iterations as f64;
        self.factorizations += share * report.factorizations as f64;
        self.relaxation = self.relaxation.max(report.relaxation_used);
        self.first_relaxation = self.first_relaxation.max(report.first_relaxation);
        self.shift = self.shift.max(report.shift_used);
        self.left_saddle |= report.left_saddle;
    }

    /// For those who watch: only the count is of the whole.
    fn iteration(&self, settings: &NewtonSettings) -> Iteration {
        Iteration {
            index: self.iterations as usize,
            energy: f64::NAN,
            decrement: settings.energy_tolerance,
            residual: f64::NAN,
            relaxation: self.relaxation,
        }
    }

    /// The report of all, from the last one of every patch; `stop` is why the sweeps ended early.
    fn report(self, last: &[Option<SolveReport>], stop: Option<StopRule>) -> SolveReport {
        let last = || last.iter().flatten();
        let failed = last().find(|report| !report.converged);
        let most = |of: fn(&SolveReport) -> f64| last().map(of).fold(0.0, f64::max);
        let inertias: Option<Vec<Inertia>> = last().map(|report| report.inertia).collect();
        let excess = |all: Vec<Inertia>| -> usize {
            let each = all.iter();
            each.map(|one| one.negative.saturating_sub(one.rows)).sum()
        };
        SolveReport {
            converged: stop.is_none() && failed.is_none(),
            stop: stop.unwrap_or(failed.map_or(StopRule::Decrement, |report| report.stop)),
            iterations: self.iterations.ceil() as usize,
            factorizations: self.factorizations.ceil() as usize,
            energy: last().map(|report| report.energy).sum(),
            residual: most(|report| report.residual),
            decrement: last().map(|report| report.decrement).sum(),
            infeasibility: most(|report| report.infeasibility),
            inertia: inertias.map(|all| Inertia {
                negative: excess(all),
                rows: 0,
            }),
            relaxation_used: self.relaxation,
            first_relaxation: self.first_relaxation,
            shift_used: self.shift,
            left_saddle: self.left_saddle,
            multipliers: Vec::new(),
        }
    }
}
