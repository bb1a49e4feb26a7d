//! What was measured.

use ruga_validation::body::{Artefact, CellLimit, Dense, Isocontour, Locality, Size};
use serde::{Deserialize, Serialize};

/// The skins on whose wavelength goals stand.
pub(crate) const HYBRID: &str = "hybrid";
pub(crate) const HARD_ROWS: &str = "hard rows";

/// One measurement.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(tag = "part", rename_all = "kebab-case")]
pub(crate) enum Finding {
    Artefact(Artefact),
    Locality(Locality),
    CellLimit(CellLimit),
    Isocontour(Isocontour),
    Dense(Dense),
    Thrown(Throw),
    Size(Size),
}

/// A cushion that bounces and is pressed.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct Throw {
    /// s.
    pub(crate) time_step: f64,
    pub(crate) steps: u32,
    /// Of these, those that were made.
    pub(crate) frames: usize,
    /// Farthest way out of its room, in its heights.
    pub(crate) outside: f64,
    /// Least and greatest height over that at rest.
    pub(crate) heights: [f64; 2],
    pub(crate) factorizations: usize,
    pub(crate) converged: bool,
}

/// All of it.
#[derive(Debug, Default)]
pub(crate) struct Findings {
    pub(crate) samples: Vec<Isocontour>,
    pub(crate) dense: Vec<Dense>,
    pub(crate) cell_limits: Vec<CellLimit>,
    pub(crate) artefacts: Vec<Artefact>,
    pub(crate) localities: Vec<Locality>,
    pub(crate) thrown: Vec<Throw>,
    pub(crate) sizes: Vec<Size>,
}

/// Size of the relative error of one of a sample's wavelengths: of that soon after the onset (0) or at
/// the end (1). Infinite where the sample failed or nothing wrinkled, so that no failure makes a median
/// better.
pub(crate) fn sample_error(sample: &Isocontour, key: usize) -> f64 {
    size_of(sample.errors()[key].filter(|_| sample.converged))
}

/// Size of a relative error; infinite where there is none.
pub(crate) fn size_of(error: Option<f64>) -> f64 {
    let error = error.filter(|error| error.is_finite());
    error.map_or(f64::INFINITY, f64::abs)
}

impl Findings {
    pub(crate) fn of(lines: Vec<Finding>) -> Self {
        let mut all = Self::default();
        for line in lines {
            match line {
                Finding::Artefact(own) => all.artefacts.push(own),
                Finding::Locality(own) => all.localities.push(own),
                Finding::CellLimit(own) => all.cell_limits.push(own),
                Finding::Isocontour(own) => all.samples.push(own),
                Finding::Dense(own) => all.dense.push(own),
                Finding::Thrown(own) => all.thrown.push(own),
                Finding::Size(own) => all.sizes.push(own),
            }
        }
        all
    }

    /// Samples of one coupling.
    pub(crate) fn of_coupling<'a>(
        &'a self,
        coupling: &'a str,
    ) -> impl Iterator<Item = &'a Isocontour> {
        let samples = self.samples.iter();
        samples.filter(move |own| own.coupling == coupling)
    }

    /// Median size of a coupling's relative errors, soon after the onset (0) or at the end (1); `None`
    /// without samples.
    pub(crate) fn median_error(&self, coupling: &str, key: usize) -> Option<f64> {
        let samples = self.of_coupling(coupling);
        let mut errors: Vec<f64> = samples.map(|own| sample_error(own, key)).collect();
        errors.sort_by(f64::total_cmp);
        let middle = errors.len() / 2;
        match errors.len() % 2 {
            1 => Some(errors[middle]),
            _ => middle
                .checked_sub(1)
                .map(|below| 0.5 * (errors[below] + errors[middle])),
        }
    }

    /// How many times less the cells show with quadratic elements than with linear ones, in energy.
    pub(crate) fn smoother(&self) -> Option<f64> {
        let energy = |shape: &str| {
            let own = self.artefacts.iter().find(|own| own.shape == shape)?;
            Some(own.energy)
        };
        Some(energy("linear")? / energy("quadratic")?)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use ruga_validation::body::Sample;

    use super::*;

    /// A good sample of the default.
    pub(crate) fn sample(thickness: f64, ratio: f64, at_end: Option<f64>) -> Isocontour {
        Isocontour {
            sample: Sample { thickness, ratio },
            coupling: HYBRID.to_owned(),
            predicted: 0.01,
            measured: [Some(0.01), at_end],
            reported: None,
            demand: [1.2, 1.5],
            amplitude: 1.0,
            depth: 0.1,
            vertices: 100,
            converged: true,
            seconds: 1.0,
        }
    }

    pub(crate) fn artefact(shape: &str, energy: f64) -> Artefact {
        Artefact {
            shape: shape.to_owned(),
            energy,
            angle_deg: 0.1,
            demand: 0.5,
            profile: Vec::new(),
        }
    }

    #[test]
    fn lines_become_findings() {
        let lines = [
            Finding::Isocontour(sample(5e-4, 30.0, Some(0.0098))),
            Finding::Isocontour(sample(5e-4, 300.0, Some(0.0104))),
            Finding::Isocontour(sample(5e-4, 3000.0, None)),
            Finding::Artefact(artefact("linear", 5.0)),
            Finding::Artefact(artefact("quadratic", 0.5)),
        ];
        let lines = lines.map(|line| {
            let text = serde_json::to_string(&line).expect("a line");
            serde_json::from_str(&text).expect("the same line")
        });
        let findings = Findings::of(lines.into());
        assert_eq!(findings.samples.len(), 3);
        // Of 2 %, 4 % and a failure.
        let median = findings.median_error(HYBRID, 1).expect("three samples");
        assert!((median - 0.04).abs() < 1e-12);
        assert_eq!(findings.median_error(HARD_ROWS, 1), None);
        assert_eq!(findings.smoother(), Some(10.0));
    }
}
