//! A large layer, solved in overlapping patches.
//!
//! The cost of one factorisation grows with the area of a layer to the power of 1.5, and one defect that
//! slides somewhere makes the whole of the layer go on. In patches each place takes the steps that it
//! needs: a patch is solved while everything around it stands still, patch after patch, until none of them
//! moves much any more (multiplicative Schwarz method, on the energy instead of a linear system). Patches
//! overlap, so that what one of them leaves at its border is mended by the next.
//!
//! From the second sweep on the whole goes on along what the last ones did before the next begins: where all patches
//! slide together, that is worth several sweeps.
//!
//! An averaging constraint reaches over several patches. The one with most of its weight restores it; in
//! the others the sum over their own vertices stays as it is, so that they cannot violate it.

mod division;
mod extrapolation;
mod patch;
mod sweep;
mod width;
mod work;

use std::sync::Arc;

use nalgebra::Vector3;
use rayon::prelude::*;
use ruga_mesh::TriMesh;
use ruga_shell::{LayerEnergy, PartIndex};
use ruga_solver::{
    AtSaddle, ConstraintRows, Iteration, Minimise, NewtonSettings, SolveReport, SolverError,
    StopRule,
};

use crate::run::layer_objective::work;
use crate::run::neighbourhood::Neighbourhood;
use division::{coloured, divided};
use extrapolation::Extrapolation;
use patch::{Patch, PatchRow, Solved, coordinates};
use sweep::{Next, Order};
use work::Work;

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

/// Gain of a sweep at which another is not worth it, in tolerances of the energy, where that is more than
/// [`LITTLE`]: of a state that is only passed, which has a larger tolerance, the next load moves what another sweep
/// would. A hand with bent fingers went on for six sweeps at such states, and then in wide patches.
const PASSED: f64 = 10.0;

/// The patches of a layer's mesh.
pub(crate) struct Patches {
    index: Arc<PartIndex>,
    patches: Vec<Patch>,
    order: Order,
    width: Width,
    /// Gain of a second sweep over that of the first, when there was one last.
    second_over_first: Option<f64>,
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

impl Whole<'_> {
    /// Energy at the free vertices' coordinates `x` (m), J.
    fn value(&self, x: &[f64]) -> f64 {
        self.energy.value(&self.placed(x)) - work(self.load, x)
    }

    /// Its derivative by them, N.
    fn gradient(&self, x: &[f64]) -> Vec<f64> {
        let mut gradient = vec![0.0; x.len()];
        self.energy.gradient(&self.placed(x), &mut gradient);
        for (gradient, force) in gradient.iter_mut().zip(self.load[0]) {
            *gradient -= force;
        }
        gradient
    }

    /// What every row lacks of its right-hand side.
    ///
    /// Patches hold what they share of a row, up to their tolerance and the thousandth that they do not know of. What
    /// that leaves is restored in the next sweep.
    fn missing(&self, x: &[f64]) -> Result<Vec<f64>, SolverError> {
        let mut missing = vec![0.0; self.targets.len()];
        self.rows.mul(x, &mut missing)?;
        for (missing, target) in missing.iter_mut().zip(self.targets) {
            *missing = target - *missing;
        }
        Ok(missing)
    }

    fn placed(&self, x: &[f64]) -> Vec<Vector3<f64>> {
        let mut positions = self.positions.to_vec();
        for (&v, x) in self.energy.free_vertices().iter().zip(x.chunks_exact(3)) {
            positions[v as usize] = Vector3::from_column_slice(x);
        }
        positions
    }
}

impl Patches {
    /// Divides the free vertices of a layer that asks for so many `points` per wavelength, at `positions` at rest
    /// (m), into patches that reach into each other; `None` where one would do, or for a layer of two sheets. What they
    /// need to know of the whole is shared with `others` of the same layer.
    pub(crate) fn new(
        (mesh, positions): (&TriMesh, &[Vector3<f64>]),
        (energy, rows): (&LayerEnergy, &ConstraintRows),
        (points, most_in_whole, width): (f64, usize, Width),
        others: Option<&Self>,
    ) -> Option<Self> {
        let free = energy.free_vertices();
        let most = width.core(most_in_whole);
        if free.len() <= most {
            return None;
        }
        // Of two sheets there are no parts, and the upper one's vertices have no places in the mesh.
        let index = match others {
            Some(others) => Arc::clone(&others.index),
            None => Arc::new(PartIndex::new(energy)?),
        };
        let overlap = (width.overlap() * points).max(LEAST_OVERLAP);
        let cores = divided(positions, free.to_vec(), most);
        let near = Neighbourhood::new(mesh);
        let rank = |v: &u32| free.binary_search(v).ok();
        let around_core = |core: &Vec<u32>| {
            let moving = near.grown(core, overlap.ceil() as usize, free);
            let part = index.part(energy, &moving);
            let around: Vec<usize> = part.vertices().iter().filter_map(rank).collect();
            let ranks = moving.iter().filter_map(rank).collect();
            (Patch::new(ranks, free.len()), around)
        };
        let (mut patches, around): (Vec<_>, Vec<_>) = cores.par_iter().map(around_core).unzip();
        let movers = movers(&patches, free.len());
        share_rows(&mut patches, &movers, rows);
        keep_rows(&mut patches, rows.count());
        let order = join(&mut patches, &around, &movers);
        Some(Self {
            index,
            patches,
            order,
            width,
            second_over_first: None,
            keeps: !Width::Wide.suits(free.len(), most_in_whole),
        })
    }

    /// Forgets what patches are solved with; the next solve sets it up anew.
    pub(crate) fn release(&mut self) {
        self.patches.iter_mut().for_each(Patch::release);
    }

    /// Minimises the energy over all free vertices, from their coordinates `x` (m), and leaves it there.
    ///
    /// It has converged when a sweep gains [`LITTLE`], or [`PASSED`] tolerances, and every patch has: in the first
    /// sweep to `settings`, later to [`LITTLE`], but to `settings` again where that did not move it; where nothing else
    /// is left, such patches alone are solved. With [`AtSaddle::Pass`] it does without its second sweep where that
    /// would gain as little, by what the last second sweep gained. Sweeps that do not get there, with an
    /// [`Extrapolation`] after the second and each that follows, end without, as the patches' width says.
    /// `keep_going` is asked whenever a patch is done, from any thread.
    pub(crate) fn minimise(
        &mut self,
        whole: Whole<'_>,
        x: &mut [f64],
        (minimise, settings): (Minimise, &NewtonSettings),
        keep_going: &mut (dyn FnMut(&Iteration) -> bool + Send),
    ) -> Result<SolveReport, SolverError> {
        for patch in &mut self.patches {
            patch.follow(&whole);
            patch.is_exact = false;
        }
        let little = LITTLE.max(PASSED * settings.energy_tolerance) * whole.scales.energy;
        let tolerated = settings.energy_tolerance * whole.scales.energy;
        let mut is_due = vec![true; self.patches.len()];
        let mut reports: Vec<Option<SolveReport>> = vec![None; self.patches.len()];
        let mut done = Work::default();
        let (mut before, mut sweeps) = (f64::INFINITY, 0);
        let (mut is_ahead, mut is_closing) = (false, false);
        let (index, keeps) = (&*self.index, self.keeps);
        let later = NewtonSettings {
            energy_tolerance: settings.energy_tolerance.max(LITTLE),
            ..settings.clone()
        };
        let mut extrapolation = Extrapolation::default();
        loop {
            let start = x.to_vec();
            let missing = whole.missing(x)?;
            // Gain, scaled to the whole layer, above which a patch's neighbours are solved again.
            let noticed = if is_closing { little } else { tolerated };
            // What is shown, which depends on who is done first.
            let mut shown = done.clone();
            let mut is_stopped = false;
            let solved = self.order.sweep(
                &mut self.patches,
                (x, &mut is_due),
                |patch, x| {
                    let is_exact = sweeps == 0 || patch.is_exact;
                    let accuracy = if is_exact { settings } else { &later };
                    patch.solve((whole, index), (x, &missing), (minimise, accuracy), keeps)
                },
                |patch: &Patch, solved: &Result<Solved, SolverError>, (x, is_due)| {
                    let Ok(solved) = solved else {
                        return Next::Fail;
                    };
                    for (value, place) in solved.own.iter().zip(coordinates(&patch.ranks)) {
                        x[place] = *value;
                    }
                    // Where a constraint had to be restored the energy may have risen.
                    if solved.gain.abs() > noticed * patch.share {
                        patch.neighbours.iter().for_each(|&j| is_due[j] = true);
                    }
                    shown.add(&solved.report, patch.share);
                    is_stopped = !keep_going(&shown.iteration(settings));
                    match is_stopped {
                        true => Next::Stop,
                        false => Next::GoOn,
                    }
                },
            );
            let mut gained = 0.0;
            let mut is_open = false;
            for (i, solved) in solved.into_iter().enumerate() {
                if let Some(solved) = solved.transpose()? {
                    let (report, patch) = (solved.report, &mut self.patches[i]);
                    // Its last step would have risen, so that it takes shorter ones.
                    patch.is_exact = !is_closing
                        && report.converged
                        && report.decrement > settings.energy_tolerance
                        && solved.gain <= 0.0;
                    is_due[i] |= patch.is_exact;
                    is_open |= patch.is_exact;
                    gained += solved.gain.abs();
                    done.add(&report, patch.share);
                    reports[i] = Some(report);
                }
            }
            if is_stopped {
                return Ok(done.report(&reports, Some(StopRule::Interrupted)));
            }
            // One that has not converged may have, once its neighbours have moved.
            let is_nobody_due = is_due.iter().all(|due| !due);
            let all_converged = reports.iter().flatten().all(|report| report.converged);
            let has_converged = !is_open && all_converged;
            if sweeps == 1 && has_converged && !is_closing {
                self.second_over_first = Some(gained / before);
            }
            let is_passed = sweeps == 0 && settings.at_saddle == AtSaddle::Pass;
            let second = self.second_over_first.filter(|_| is_passed);
            let is_little =
                gained <= little || second.is_some_and(|share| share * gained <= little);
            if is_little && has_converged || is_nobody_due {
                return Ok(done.report(&reports, None));
            }
            sweeps += 1;
            // A sweep of a few patches says nothing about how fast all of them are.
            let share = if is_closing { 0.0 } else { gained / before };
            if self.width.ends(sweeps, share, little / gained) {
                return Ok(done.report(&reports, Some(StopRule::IterationLimit)));
            }
            if !is_closing {
                before = gained;
            }
            // The first sweep still finds the equilibrium of every patch, and restores averages. A sweep that gained
            // little from where an extrapolation had led is not worth another.
            let is_worth_more = all_converged && !is_closing && !(is_little && is_ahead);
            is_ahead =
                sweeps > 1 && is_worth_more && extrapolation.step(&whole, (&start, x), tolerated);
            // One of many patches always had a last step that would have risen. Where nothing else is left, all others
            // would go on with it for sweep after sweep, each with such a patch among them.
            let was_closing = is_closing;
            is_closing = is_little && all_converged && !is_ahead;
            if is_closing {
                let exact = self.patches.iter().map(|patch| patch.is_exact);
                is_due = exact.collect();
            } else if is_ahead || was_closing {
                is_due.fill(true);
            }
        }
    }
}

/// The patches, ascending, that move each of so many free vertices.
fn movers(patches: &[Patch], free: usize) -> Vec<Vec<usize>> {
    let mut movers = vec![Vec::new(); free];
    for (i, patch) in patches.iter().enumerate() {
        patch.ranks.iter().for_each(|&rank| movers[rank].push(i));
    }
    movers
}

/// Tells every patch of the `rows` that it has more than [`LEAST_SHARE`] of. All rows are gone through once: to look
/// for every patch's would take time with the square of the area.
fn share_rows(patches: &mut [Patch], movers: &[Vec<usize>], rows: &ConstraintRows) {
    let mut own = vec![0.0; patches.len()];
    for row in 0..rows.count() {
        let (columns, weights) = rows.row(row);
        let mut touched = Vec::new();
        for (column, weight) in columns.iter().zip(weights) {
            for &i in &movers[column / 3] {
                // Most columns follow others of the same patch.
                if own[i] == 0.0 {
                    touched.push(i);
                }
                own[i] += weight.abs();
            }
        }
        let whole: f64 = weights.iter().map(|weight| weight.abs()).sum();
        for i in touched {
            let share = std::mem::take(&mut own[i]) / whole;
            if share > LEAST_SHARE {
                patches[i].rows.push(PatchRow {
                    row,
                    share,
                    is_kept: false,
                });
            }
        }
    }
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

/// Finds the neighbours of every patch, of which each sees the vertices with the ranks in `around`, by the patches
/// that move each vertex, and brings the patches into the order of a sweep.
fn join(patches: &mut Vec<Patch>, around: &[Vec<usize>], movers: &[Vec<usize>]) -> Order {
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
    for near in &mut neighbours {
        near.sort_unstable();
        near.dedup();
    }
    // Groups of patches that do not see each other come one after the other, so that few wait for others.
    let sorted = coloured(&neighbours).concat();
    let mut places = vec![0; sorted.len()];
    for (place, &i) in sorted.iter().enumerate() {
        places[i] = place;
    }
    for (patch, near) in patches.iter_mut().zip(neighbours) {
        patch.neighbours = near.into_iter().map(|j| places[j]).collect();
    }
    let mut placed: Vec<(usize, Patch)> = places.into_iter().zip(patches.drain(..)).collect();
    placed.sort_by_key(|(place, _)| *place);
    patches.extend(placed.into_iter().map(|(_, patch)| patch));
    Order::new(patches.iter().map(|patch| patch.neighbours.as_slice()))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use ruga_shell::{BendingModel, FaceParameters, LayerParameters, UpperSheet};

    use super::*;

    /// A strip of 82 vertices in two rows, where it rests.
    pub(super) fn strip() -> (TriMesh, Vec<Vector3<f64>>, LayerParameters) {
        let faces = (0..40).map(|i| 2 * i);
        let faces = faces.flat_map(|a| [[a, a + 2, a + 1], [a + 1, a + 2, a + 3]]);
        let mesh = TriMesh::new(82, faces.collect()).expect("a strip");
        let place = |i: usize| Vector3::new((i / 2) as f64, (i % 2) as f64, 0.0);
        let face = FaceParameters {
            young: 1.0,
            poisson: 0.5,
            thickness: 0.1,
            normal_stiffness: 1.0,
            gradient_stiffness: 0.0,
        };
        let parameters = LayerParameters::uniform(face, 80, 1.0, 82);
        (mesh, (0..82).map(place).collect(), parameters)
    }

    /// Two sheets on one mesh have twice as many vertices as it has places, and are not divided.
    #[test]
    fn a_pair_of_sheets_is_solved_as_a_whole() {
        let (mesh, rest, parameters) = strip();
        let above = UpperSheet {
            rest_positions: rest.iter().map(|x| x + 0.1 * Vector3::z()).collect(),
            parameters: parameters.clone(),
            offsets: vec![0.1; 82],
        };
        let (held, model) = ([false; 82], BendingModel::VertexCurvature);
        let divided = |energy: &LayerEnergy| {
            let rows = ConstraintRows::none(energy.dof_count());
            let asked = (6.0, 30, Width::Narrow);
            Patches::new((&mesh, &rest), (energy, &rows), asked, None).is_some()
        };
        let single = LayerEnergy::with_bending(&mesh, &rest, parameters.clone(), &held, model);
        assert!(divided(&single.expect("a layer")));
        let pair = LayerEnergy::pair((&mesh, &rest, &held), parameters, above, model);
        assert!(!divided(&pair.expect("a pair")));
    }

    /// Two patches that share a vertex: rows on one of them, on both, and with next to nothing on the first.
    #[test]
    fn patches_know_of_the_rows_that_they_have_a_share_of() {
        let mut patches = [vec![0, 1], vec![1, 2, 3]].map(|ranks| Patch::new(ranks, 4));
        let columns = vec![0, 4, 3, 6, 9, 0, 11];
        let weights = vec![1.0, -1.0, 1.0, -2.0, 1.0, 1e-4, 1.0];
        let rows = ConstraintRows::new(vec![0, 2, 5, 7], columns, weights, 12).expect("rows");
        let movers = movers(&patches, 4);
        share_rows(&mut patches, &movers, &rows);
        keep_rows(&mut patches, rows.count());
        let known = |patch: &Patch| -> Vec<_> {
            let rows = patch.rows.iter();
            rows.map(|part| (part.row, part.share, part.is_kept))
                .collect()
        };
        assert_eq!(known(&patches[0]), [(0, 1.0, true), (1, 0.25, false)]);
        let [(0, half, false), (1, whole, true), (2, most, true)] = known(&patches[1])[..] else {
            panic!("{:?}", known(&patches[1]));
        };
        assert_eq!([half, whole], [0.5, 1.0]);
        assert!((most - 1.0).abs() < 1e-3, "{most}");
    }
}
