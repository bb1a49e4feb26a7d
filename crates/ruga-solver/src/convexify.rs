//! The smallest change of an indefinite Hessian that makes it usable for a descent step.
//!
//! Under compression the stress stiffness is what turns the Hessian indefinite, so it is what
//! is scaled back: `(1 - b) K + b K_S`, with `K_S` the Hessian without compressive stress and
//! `b` as small as the inertia allows. This scales the load itself, so the first mode to escape
//! is the one that buckles first. The alternatives measured worse: projecting element Hessians
//! removes stiffness that a wrinkled film really lacks and converges linearly, a mass shift
//! favours modes shorter than the critical one.

use crate::{Inertia, Kkt, SolverError};

/// Relaxations to try in turn where less than [`CLOSE_TO_CRITICAL`] allows may do: just past an
/// onset twice the needed one makes another mode the softest, and a film then wrinkles 7 % too
/// long.
const SMALL_RELAXATIONS: [f64; 4] = [1e-3, 4e-3, 1.6e-2, 6.4e-2];

/// Factor on the load from one large relaxation that was not enough to the next.
const LOAD_DECREASE: f64 = 0.7;
/// A load below this share is as good as none.
const LEAST_LOAD: f64 = 0.02;

/// The load that relaxation leaves must be at least this share of the largest that the inertia
/// allows, else the bracket is bisected. Further below, the softest mode is no longer the one
/// that buckles: with 0.5, three inverse iterations from a flat start at 1.1 of the critical
/// load ended in a stable mode, and with 0.85 a start at 5 takes twice as many iterations.
const CLOSE_TO_CRITICAL: f64 = 0.9;

/// Where a Hessian has at most so many modes of negative curvature, the relaxation beside that number
/// is tried first, unless it was in vain at the saddle before: it is rarely less than needed, and a larger one would
/// slow down the modes' growth.
const FEW_MODES: [(usize, f64); 2] = [(2, 1.6e-2), (8, 0.1)];
/// A Hessian with more modes of negative curvature than this keeps some of them through the next step.
const MANY_MODES: usize = 10;

/// Where any minimum will do, the pivots of a Hessian with at most so many modes of negative curvature are turned
/// positive: no further factorisation is needed. Steps of more modes at once hinder each other.
const MOST_TURNED: usize = 8;
/// Where there are more, the relaxation that is tried first and the factor on the load to the next: any that is enough
/// will do.
const FIRST_GUESS: f64 = 0.5;
const GUESS_DECREASE: f64 = 0.5;

/// Steps of [`CLOSE_TO_CRITICAL`] from a relaxation that was expected to be enough; those that follow
/// are steps of [`LOAD_DECREASE`], because the expectation was far off.
const SMALL_STEPS: usize = 3;

/// First diagonal shift, relative to the typical diagonal, once full relaxation was not enough.
const SMALLEST_SHIFT: f64 = 1e-6;
/// Factor from one diagonal shift to the next.
const SHIFT_GROWTH: f64 = 10.0;
/// Diagonal shift, relative to the typical diagonal, beyond which a Hessian counts as broken.
const LARGEST_SHIFT: f64 = 1e6;

/// Inertia of a Hessian and the change of it that [`Convexifier::factorize`] left in the factor.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Convexified {
    /// Inertia of the exact Hessian.
    pub(crate) exact: Inertia,
    pub(crate) relaxation: f64,
    pub(crate) shift: f64,
}

/// A Hessian with what it can be mixed with.
#[derive(Clone, Copy)]
pub(crate) struct Hessian<'a> {
    pub(crate) exact: &'a [f64],
    /// Without compressive stress.
    pub(crate) relaxed: &'a [f64],
    /// Added to the diagonal of either; may be empty.
    pub(crate) damping: &'a [f64],
}

/// Search for the smallest change that mends a Hessian; remembers what the last saddle took.
pub(crate) struct Convexifier {
    mixed: Vec<f64>,
    shifted_damping: Vec<f64>,
    /// The last relaxation that was enough.
    last: Option<f64>,
    /// Whether a smaller one had been tried then, in vain.
    is_least: bool,
    /// The relaxation of [`FEW_MODES`] that was tried at the last saddle, in vain.
    vain: Option<f64>,
    /// Inertia of the last exact Hessian that was factorised.
    exact: Option<Inertia>,
    /// Whether the last saddle was taken for one without a look at its exact Hessian.
    is_guessed: bool,
    /// Whether pivots may be turned: any minimum will do, and there are no rows.
    may_turn: bool,
    pub(crate) factorizations: usize,
}

impl Convexifier {
    /// Whether the last saddle was taken for one without a look at its exact Hessian.
    pub(crate) fn has_guessed(&self) -> bool {
        self.is_guessed
    }

    /// For a solve to which [any minimum](crate::NewtonSettings::any_minimum) will do, or not.
    pub(crate) fn new(kkt: &Kkt, any_minimum: bool) -> Self {
        Self {
            mixed: vec![0.0; kkt.pattern().entries()],
            shifted_damping: vec![0.0; kkt.pattern().size()],
            last: None,
            is_least: false,
            vain: None,
            exact: None,
            is_guessed: false,
            may_turn: any_minimum && kkt.rows().count() == 0,
            factorizations: 0,
        }
    }

    /// Factorises the Hessian, relaxed about as little as its inertia allows.
    ///
    /// The first search singles out the mode that buckles first, unless there is a `hint`: that is given
    /// for a pattern which is there already. Later ones begin at what the last saddle took.
    pub(crate) fn factorize(
        &mut self,
        kkt: &mut Kkt,
        hessian: Hessian<'_>,
        hint: Option<f64>,
    ) -> Result<Convexified, SolverError> {
        if let Some((exact, last)) = self.exact.zip(self.last).filter(|_| self.can_guess()) {
            self.is_guessed = true;
            let first = self.expected(last);
            return self.mend(kkt, hessian, exact, Some(first));
        }
        self.is_guessed = false;
        // The exact Hessian is tried even where a relaxation is expected: only its inertia proves a
        // minimum, and only its steps converge quadratically.
        let exact = self.inertia(kkt, hessian.exact, hessian.damping)?;
        self.exact = Some(exact);
        let vain = self.vain.take();
        if exact.is_minimum() {
            return Ok(Convexified {
                exact,
                relaxation: 0.0,
                shift: 0.0,
            });
        }
        if self.may_turn && exact.excess() <= MOST_TURNED && kkt.turn_negative_pivots() {
            return Ok(Convexified {
                exact,
                relaxation: 0.0,
                shift: 0.0,
            });
        }
        let hint = hint.or(self.may_turn.then_some(FIRST_GUESS));
        // A hint is tried as it is, because it may already be less than what is needed.
        let first = self.last.map(|last| self.expected(last)).or(hint);
        let few = FEW_MODES.iter().find(|few| exact.excess() <= few.0);
        if let Some((&(_, little), first)) = few.zip(first)
            && little < first
            // What was not enough is not in the next iteration, either, as a rule.
            && vain != Some(little)
        {
            if self.try_relaxation(kkt, hessian, little)? {
                (self.last, self.is_least) = (Some(little), false);
                return Ok(Convexified {
                    exact,
                    relaxation: little,
                    shift: 0.0,
                });
            }
            self.vain = Some(little);
        }
        self.mend(kkt, hessian, exact, first)
    }

    /// Whether what follows the last saddle is one, too: it had so many modes that one step does not
    /// take them all. Every other time, so that the step that does is not missed for long.
    fn can_guess(&self) -> bool {
        !self.is_guessed && self.exact.is_some_and(|exact| exact.excess() > MANY_MODES)
    }

    /// The relaxation to begin with where `last` was enough: a smaller one, unless that was in vain the last
    /// time; every other time is often enough to follow it down.
    fn expected(&self, last: f64) -> f64 {
        match self.is_least {
            true => last,
            false => step_down(last),
        }
    }

    /// Relaxes a Hessian of that `exact` inertia, from a `first` relaxation on upwards if there is one.
    fn mend(
        &mut self,
        kkt: &mut Kkt,
        hessian: Hessian<'_>,
        exact: Inertia,
        first: Option<f64>,
    ) -> Result<Convexified, SolverError> {
        let found = match first {
            None => self.relax(kkt, hessian)?,
            Some(first) => self.relax_from(kkt, hessian, first)?,
        };
        let relaxation = found.unwrap_or(1.0);
        self.last = Some(relaxation);
        self.is_least = first.is_some_and(|first| first < relaxation);
        // What is indefinite without any compression is not the load's doing: only a diagonal
        // helps.
        let shift = match found {
            Some(_) => 0.0,
            None => self.shift(kkt, hessian)?,
        };
        Ok(Convexified {
            exact,
            relaxation,
            shift,
        })
    }

    /// Finds a relaxation that is enough, from `first` on upwards, and leaves its factor; `None` when
    /// even 1 is not enough.
    fn relax_from(
        &mut self,
        kkt: &mut Kkt,
        hessian: Hessian<'_>,
        first: f64,
    ) -> Result<Option<f64>, SolverError> {
        // From below, so that the first success is the least on the ladder and stays in the factor: more
        // would slow down the growth of the modes and their search.
        let mut relaxation = first;
        let mut steps = 0;
        while !self.try_relaxation(kkt, hessian, relaxation)? {
            if relaxation == 1.0 {
                return Ok(None);
            }
            let decrease = match steps {
                1.. if self.may_turn => GUESS_DECREASE,
                ..SMALL_STEPS => CLOSE_TO_CRITICAL,
                _ => LOAD_DECREASE,
            };
            relaxation = step_up(relaxation, decrease);
            steps += 1;
        }
        Ok(Some(relaxation))
    }

    /// Finds the relaxation and leaves its factor; `None` when even 1 is not enough.
    fn relax(&mut self, kkt: &mut Kkt, hessian: Hessian<'_>) -> Result<Option<f64>, SolverError> {
        let largest_small = 1.0 - CLOSE_TO_CRITICAL;
        // The largest of the small ones comes first: it tells in one factorisation which search to
        // do.
        if self.try_relaxation(kkt, hessian, largest_small)? {
            return self.relax_little(kkt, hessian).map(Some);
        }
        let mut too_little = largest_small;
        // The load shrinks by a constant factor, because `CLOSE_TO_CRITICAL` is a ratio of loads.
        let mut enough = 1.0 - (1.0 - too_little) * LOAD_DECREASE;
        while !self.try_relaxation(kkt, hessian, enough)? {
            if enough == 1.0 {
                return Ok(None);
            }
            too_little = enough;
            let load = (1.0 - enough) * LOAD_DECREASE;
            enough = if load < LEAST_LOAD { 1.0 } else { 1.0 - load };
        }
        let mut in_factor = enough;
        // Where only full relaxation is enough, no bracket is narrow as a ratio: it has no load left.
        while 1.0 - enough < CLOSE_TO_CRITICAL * (1.0 - too_little)
            && 1.0 - too_little >= LEAST_LOAD
        {
            // A geometric mean of loads would stay at zero when full relaxation is the upper end.
            in_factor = 0.5 * (enough + too_little);
            if self.try_relaxation(kkt, hessian, in_factor)? {
                enough = in_factor;
            } else {
                too_little = in_factor;
            }
        }
        // The last trial may have been one that failed, and the caller solves with the factor.
        if in_factor != enough {
            self.try_relaxation(kkt, hessian, enough)?;
        }
        Ok(Some(enough))
    }

    /// The least of the small relaxations that is enough, or where none is the next larger one, which is known to be;
    /// its factor is left.
    fn relax_little(&mut self, kkt: &mut Kkt, hessian: Hessian<'_>) -> Result<f64, SolverError> {
        // Halving: what is more than enough is enough, too.
        let (mut least, mut end) = (0, SMALL_RELAXATIONS.len());
        let mut in_factor = None;
        while least < end {
            let middle = (least + end) / 2;
            match self.try_relaxation(kkt, hessian, SMALL_RELAXATIONS[middle])? {
                true => end = middle,
                false => least = middle + 1,
            }
            in_factor = Some(middle);
        }
        let enough = SMALL_RELAXATIONS.get(least);
        let enough = enough.copied().unwrap_or(1.0 - CLOSE_TO_CRITICAL);
        if in_factor != Some(least) {
            // It is known to be enough: this only brings its factor back.
            self.try_relaxation(kkt, hessian, enough)?;
        }
        Ok(enough)
    }

    fn try_relaxation(
        &mut self,
        kkt: &mut Kkt,
        hessian: Hessian<'_>,
        relaxation: f64,
    ) -> Result<bool, SolverError> {
        let mut mixed = std::mem::take(&mut self.mixed);
        let entries = mixed.iter_mut().zip(hessian.exact).zip(hessian.relaxed);
        for ((mixed, exact), relaxed) in entries {
            *mixed = (1.0 - relaxation) * exact + relaxation * relaxed;
        }
        let inertia = self.inertia(kkt, &mixed, hessian.damping);
        self.mixed = mixed;
        Ok(inertia?.is_minimum())
    }

    /// Factorises the fully relaxed Hessian; grows a diagonal shift until its inertia is right,
    /// from 0.
    pub(crate) fn shift(
        &mut self,
        kkt: &mut Kkt,
        hessian: Hessian<'_>,
    ) -> Result<f64, SolverError> {
        let Hessian {
            relaxed, damping, ..
        } = hessian;
        if self.inertia(kkt, relaxed, damping)?.is_minimum() {
            return Ok(0.0);
        }
        let unit = kkt.typical_diagonal();
        let mut shift = SMALLEST_SHIFT;
        while shift <= LARGEST_SHIFT {
            let mut shifted = std::mem::take(&mut self.shifted_damping);
            for (i, shifted) in shifted.iter_mut().enumerate() {
                // Without damping there is nothing to add to.
                *shifted = damping.get(i).unwrap_or(&0.0) + shift * unit;
            }
            let inertia = self.inertia(kkt, relaxed, &shifted);
            self.shifted_damping = shifted;
            if inertia?.is_minimum() {
                return Ok(shift);
            }
            shift *= SHIFT_GROWTH;
        }
        // No single pivot is to blame.
        Err(SolverError::Breakdown { pivot: 0 })
    }

    /// A factor that breaks down counts as one with a negative pivot too many: relaxing or
    /// shifting moves the pivot off zero.
    fn inertia(
        &mut self,
        kkt: &mut Kkt,
        values: &[f64],
        damping: &[f64],
    ) -> Result<Inertia, SolverError> {
        self.factorizations += 1;
        let rows = kkt.rows().count();
        match kkt.factorize(values, damping) {
            Err(SolverError::Breakdown { .. }) => Ok(Inertia {
                negative: rows + 1,
                rows,
            }),
            other => other,
        }
    }
}

/// The next smaller relaxation worth trying.
fn step_down(relaxation: f64) -> f64 {
    let largest_small = 1.0 - CLOSE_TO_CRITICAL;
    if 1.0 - relaxation < LEAST_LOAD {
        return 1.0 - LEAST_LOAD;
    }
    if relaxation > largest_small {
        // One step is the accuracy to which `relax` would search.
        return (1.0 - (1.0 - relaxation) / CLOSE_TO_CRITICAL).max(largest_small);
    }
    let smaller = SMALL_RELAXATIONS.iter().rev().find(|&&it| it < relaxation);
    smaller.copied().unwrap_or(relaxation)
}

/// The next larger relaxation worth trying, at most 1; of a large one, with `decrease` times the load.
fn step_up(relaxation: f64, decrease: f64) -> f64 {
    let largest_small = 1.0 - CLOSE_TO_CRITICAL;
    if relaxation >= largest_small {
        let load = (1.0 - relaxation) * decrease;
        return if load < LEAST_LOAD { 1.0 } else { 1.0 - load };
    }
    let larger = SMALL_RELAXATIONS.iter().find(|&&it| it > relaxation);
    larger.copied().unwrap_or(largest_small)
}
