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
mod patch;
mod width;
mod work;

use nalgebra::Vector3;
use rayon::prelude::*;
use ruga_mesh::TriMesh;
use ruga_shell::{LayerEnergy, LayerPart};
use ruga_solver::{
    ConstraintRows, Iteration, Minimise, NewtonSettings, SolveReport, SolverError, StopRule,
};

use crate::run::neighbourhood::Neighbourhood;
use division::{coloured, divided};
use patch::{Patch, coordinates};
use work::Work;

pub(crate) use width::Width;

/// Overlap in edges at least. A smile at 6 points per wavelength ends .2 % from the whole's amplitude with six
/// edges, and 3 % from it with three.
const LEAST_OVERLAP: f64 = 4.0;

/// Gain of a sweep, in energy scales, at which another is not worth it. The seams between patches then
/// hardly move, and a hand with bent fingers has .2 % more energy than after ten times the work on the whole.
const LITTLE: f64 = 1e-3;

/// The patches of a layer's mesh.
pub(crate) struct Patches {
    patches: Vec<Patch>,
    /// Numbers of patches that may be solved at the same time, as no stencil joins them.
    colours: Vec<Vec<usize>>,
    width: Width,
    /// Whether what patches are solved with is kept from one solve to the next of a key: quicker, but too much memory
    /// where the layer is large.
    keeps: bool,
}

/// A layer that is solved in patches: everything about it but where its free vertices are.
#[derive(Clone, Copy)]
pub(crate) struct Whole<'a> {
    pub(crate) energy: &'a LayerEnergy,
    /// Positions of all vertices, of which only the pinned ones are read, m.
    pub(crate) positions: &'a [Vector3<f64>],
    /// Dead load on the free vertices, N, and where these are when it does no work, m.
    pub(crate) load: [&'a [f64]; 2],
    /// Levenberg damping of the free vertices' coordinates, N/m.
    pub(crate) damping: &'a [f64],
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

impl Patches {
    /// Divides the free vertices of a layer that asks for so many `points` per wavelength, at `positions` at rest
    /// (m), into patches that reach into each other; `None` where one would do, or for a layer of two sheets.
    pub(crate) fn new(
        (mesh, positions): (&TriMesh, &[Vector3<f64>]),
        (energy, rows): (&LayerEnergy, &ConstraintRows),
        (points, most_in_whole, width): (f64, usize, Width),
    ) -> Option<Self> {
        let free = energy.free_vertices();
        let overlap = (width.overlap() * points).max(LEAST_OVERLAP);
        let cores = divided(positions, free.to_vec(), width.core(most_in_whole));
        if cores.len() < 2 {
            return None;
        }
        let near = Neighbourhood::new(mesh);
        let (mut patches, mut around) = (Vec::new(), Vec::new());
        let rank = |v: &u32| free.binary_search(v).ok();
        for core in &cores {
            let moving = near.grown(core, overlap.ceil() as usize, free);
            let part = LayerPart::new(energy, &moving)?;
            around.push(part.vertices().iter().filter_map(rank).collect());
            let ranks = moving.iter().filter_map(rank).collect();
            patches.push(Patch::new(ranks, free.len(), rows));
        }
        keep_rows(&mut patches, rows.count());
        let colours = coloured(&join(&mut patches, &around, free.len()));
        Some(Self {
            patches,
            colours,
            width,
            keeps: !Width::Wide.suits(free.len(), most_in_whole),
        })
    }

    /// Forgets what patches are solved with; the next solve sets it up anew.
    pub(crate) fn release(&mut self) {
        self.patches.iter_mut().for_each(Patch::release);
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
            patch.follow(&whole);
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
                let (seen, keeps): (&[f64], _) = (x, self.keeps);
                let solved = each(&mut self.patches, &due, |patch| {
                    patch.solve(whole, seen, (minimise, settings), keeps)
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

/// Finds the neighbours of every patch, of which each sees the vertices with the ranks in `around`, of a
/// layer with so many free vertices.
fn join(patches: &mut [Patch], around: &[Vec<usize>], free: usize) -> Vec<Vec<usize>> {
    let mut movers = vec![Vec::new(); free];
    for (i, patch) in patches.iter().enumerate() {
        patch.ranks.iter().for_each(|&rank| movers[rank].push(i));
    }
    let mut neighbours = vec![Vec::new(); patches.len()];
    for (i, around) in around.iter().enumerate() {
        for &mover in around.iter().flat_map(|&rank| &movers[rank]) {
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
