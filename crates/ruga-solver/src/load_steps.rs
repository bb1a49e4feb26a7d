//! The sequence of loads that leads through the onset of buckling.
//!
//! Wrinkles choose their wavelength at the first load past the onset and do not merge later.
//! So the first buckled state is made at 1.05 to 1.1 of the onset, found by bisection on
//! unbuckled states, and only then do the steps grow.

use crate::SolverError;

/// Settings of a [`LoadStepper`].
#[derive(Debug, Clone, PartialEq)]
pub struct LoadSettings {
    /// Largest ratio of a load to the one before it, once buckled. At least 1.001, below which loads
    /// hardly grow; default 1.5; up to 2 the wavelength is kept.
    pub growth: f64,
    /// Load of the first buckled state over the smallest load known to buckle. Above 1,
    /// default 1.05.
    pub landing: f64,
    /// Bisection ends when the bracket of the onset is this narrow, as a ratio. Above 1,
    /// default 1.1 / 1.05, so that the landing lies at 1.05 to 1.1 of the onset.
    pub bracket: f64,
    /// Steps below this share of the full load are given up. At least 1e-9, well above rounding, and
    /// below 1; default 1e-3.
    pub smallest_step: f64,
}

impl Default for LoadSettings {
    fn default() -> Self {
        Self {
            growth: 1.5,
            landing: 1.05,
            bracket: 1.1 / 1.05,
            smallest_step: 1e-3,
        }
    }
}

impl LoadSettings {
    fn check(&self) -> Result<(), SolverError> {
        let is_ratio = |value: f64| value > 1.0 && value.is_finite();
        let settings = [
            (
                "growth",
                self.growth,
                self.growth >= LEAST_GROWTH && self.growth.is_finite(),
            ),
            ("landing", self.landing, is_ratio(self.landing)),
            ("bracket", self.bracket, is_ratio(self.bracket)),
            (
                "smallest_step",
                self.smallest_step,
                (LEAST_STEP..1.0).contains(&self.smallest_step),
            ),
        ];
        match settings.into_iter().find(|(_, _, is_sound)| !is_sound) {
            None => Ok(()),
            Some((setting, value, _)) => Err(SolverError::Setting { setting, value }),
        }
    }
}

/// Least [`LoadSettings::growth`]: a load that grows by less hardly reaches its key.
const LEAST_GROWTH: f64 = 1.001;
/// Least [`LoadSettings::smallest_step`]: rounding swallows smaller ones, and trials never end.
const LEAST_STEP: f64 = 1e-9;

/// A load to solve at, from the last state that was kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// The load, in (0, 1].
    pub load: f64,
    /// Whether a buckled result will be discarded, so that the solve may end at the first sign
    /// of a saddle ([`AtSaddle::Stop`](crate::AtSaddle::Stop)).
    pub probe: bool,
}

/// What came of a [`Trial`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Converged, the Hessian never indefinite on the way.
    Stable,
    /// The Hessian was indefinite: the onset lies below this load.
    Buckled,
    /// Not converged for another reason.
    Failed,
}

/// What to do with the state that a [`Trial`] ended in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Keep it: the next trial starts from it.
    Keep,
    /// Restore the last state that was kept.
    Discard,
    /// Restore the last state that was kept; the sequence ends before its last key.
    GiveUp,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// Nothing buckled yet.
    Unbuckled,
    /// The onset lies between the last kept load and this one.
    Bracketed(f64),
    /// Buckled states are kept.
    Buckled,
    Ended,
}

/// Decides which loads to solve at; knows nothing of what a load is.
///
/// Ask [`next_trial`](Self::next_trial), solve, [`report`](Self::report), obey the verdict,
/// until there is no next trial. Every key load is hit exactly unless the stepper gives up.
#[derive(Debug, Clone)]
pub struct LoadStepper {
    keys: Vec<f64>,
    settings: LoadSettings,
    kept: f64,
    phase: Phase,
    /// Longest step since the last failure.
    longest_step: f64,
    trial: Option<Trial>,
}

impl LoadStepper {
    /// Starts at load 0 with the loads that must be hit: strictly increasing, in (0, 1].
    ///
    /// # Errors
    /// [`SolverError::Setting`] for keys or settings outside their ranges.
    pub fn new(keys: &[f64], settings: LoadSettings) -> Result<Self, SolverError> {
        let mut previous = 0.0;
        for &value in keys {
            // Negated, so that a load which is not a number is refused.
            if !(value > previous && value <= 1.0) {
                let setting = "key load";
                return Err(SolverError::Setting { setting, value });
            }
            previous = value;
        }
        settings.check()?;
        Ok(Self {
            keys: keys.to_vec(),
            settings,
            kept: 0.0,
            phase: Phase::Unbuckled,
            longest_step: 1.0,
            trial: None,
        })
    }

    /// The load whose state was kept last; 0 at the start.
    pub fn kept_load(&self) -> f64 {
        self.kept
    }

    /// The next load, or `None` when the last key was kept or the stepper gave up.
    ///
    /// Asking again without a [`report`](Self::report) returns the same trial.
    pub fn next_trial(&mut self) -> Option<Trial> {
        let key = *self.keys.iter().find(|&&key| key > self.kept)?;
        let reach = (self.kept + self.longest_step).min(key);
        self.trial = match self.phase {
            // Before the onset the state does not depend on the way to it: steps may be long.
            Phase::Unbuckled => Some(Trial {
                load: reach,
                probe: true,
            }),
            // Just past the onset the critical mode is the only unstable one, so it sets the
            // wavelength.
            Phase::Bracketed(buckled) if self.is_narrow(buckled) => Some(Trial {
                load: (buckled * self.settings.landing).min(key),
                probe: false,
            }),
            Phase::Bracketed(buckled) => Some(Trial {
                // The kept load may be zero, where a geometric mean would stay.
                load: 0.5 * (self.kept + buckled),
                probe: true,
            }),
            Phase::Buckled => Some(Trial {
                load: reach.min(self.kept * self.settings.growth),
                probe: false,
            }),
            Phase::Ended => None,
        };
        self.trial
    }

    /// Takes the outcome of the last trial and says what to do with its state.
    ///
    /// Without a trial to report on the verdict is [`Verdict::Discard`].
    pub fn report(&mut self, outcome: Outcome) -> Verdict {
        let Some(trial) = self.trial.take() else {
            return Verdict::Discard;
        };
        match outcome {
            Outcome::Failed => self.shorten(trial),
            Outcome::Buckled if trial.probe => {
                self.phase = Phase::Bracketed(trial.load);
                Verdict::Discard
            }
            Outcome::Buckled | Outcome::Stable => {
                // A landing that turns out stable ends the bracket as well: it is as narrow as it
                // gets.
                if !trial.probe {
                    self.phase = Phase::Buckled;
                }
                self.kept = trial.load;
                // What failed may lie behind: the step recovers as fast as it shrank.
                self.longest_step = (2.0 * self.longest_step).min(1.0);
                Verdict::Keep
            }
        }
    }

    /// Narrow enough to land: relative to the load, or down to the smallest step.
    fn is_narrow(&self, buckled: f64) -> bool {
        // While the kept load is zero no bracket is narrow as a ratio, hence the absolute width.
        buckled <= self.kept * self.settings.bracket
            || buckled - self.kept <= self.settings.smallest_step
    }

    /// Halves the step after a failure.
    fn shorten(&mut self, trial: Trial) -> Verdict {
        self.longest_step = 0.5 * (trial.load - self.kept);
        // In a bracket the next trial is fixed, so only a step can be shortened.
        let bracketed = matches!(self.phase, Phase::Bracketed(_));
        // A probe that failed counts as buckled: the bracket narrows, and the sequence ends.
        if bracketed && trial.probe {
            self.phase = Phase::Bracketed(trial.load);
            return Verdict::Discard;
        }
        if bracketed || self.longest_step < self.settings.smallest_step {
            self.phase = Phase::Ended;
            return Verdict::GiveUp;
        }
        Verdict::Discard
    }
}
