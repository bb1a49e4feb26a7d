//! What was measured, out of its lines.

use serde_json::Value;

/// The skins on whose wavelength goals stand.
pub(super) const HYBRID: &str = "hybrid";
pub(super) const HARD_ROWS: &str = "hard rows";

/// All of it.
#[derive(Debug, Default)]
pub(super) struct Findings {
    pub(super) samples: Vec<Sample>,
    pub(super) dense: Vec<Dense>,
    pub(super) cell_limits: Vec<CellLimit>,
    pub(super) artefacts: Vec<Artefact>,
    pub(super) localities: Vec<Locality>,
    pub(super) thrown: Vec<Thrown>,
    pub(super) sizes: Vec<Size>,
}

/// A slab that was pushed together.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    pub(super) coupling: String,
    /// m.
    pub(super) thickness: f64,
    pub(super) ratio: f64,
    /// Wavelength of theory, m.
    pub(super) predicted: f64,
    /// Soon after the onset and at the end, m.
    pub(super) measured: [Option<f64>; 2],
    /// The simulator's own measure, m.
    pub(super) reported: Option<f64>,
    /// Effective compression in critical strains.
    pub(super) demand: [f64; 2],
    pub(super) vertices: f64,
    pub(super) converged: bool,
    pub(super) seconds: f64,
}

impl Sample {
    /// Relative errors of both wavelengths.
    pub(super) fn errors(&self) -> [Option<f64>; 2] {
        self.measured
            .map(|measured| measured.map(|m| m / self.predicted - 1.0))
    }

    /// Size of one of them: of that soon after the onset (0) or at the end (1). Infinite where the sample
    /// failed or nothing wrinkled, so that no failure makes a median better.
    pub(super) fn error_size(&self, key: usize) -> f64 {
        size_of(self.errors()[key].filter(|_| self.converged))
    }
}

/// Of an error; infinite where there is none.
fn size_of(error: Option<f64>) -> f64 {
    let error = error.filter(|error| error.is_finite());
    error.map_or(f64::INFINITY, f64::abs)
}

/// The same skin as a volume.
#[derive(Debug, Clone)]
pub(super) struct Dense {
    /// m.
    pub(super) thickness: f64,
    pub(super) ratio: f64,
    /// Wavelengths, m.
    pub(super) volume: f64,
    pub(super) embedded: Option<f64>,
}

impl Dense {
    /// Relative error of the embedded skin.
    pub(super) fn error(&self) -> Option<f64> {
        self.embedded.map(|embedded| embedded / self.volume - 1.0)
    }

    /// Its size, infinite where nothing wrinkled.
    pub(super) fn error_size(&self) -> f64 {
        size_of(self.error())
    }
}

/// A slab on a lattice of some fineness.
#[derive(Debug, Clone)]
pub(super) struct CellLimit {
    /// Wavelengths to a cell.
    pub(super) cell: f64,
    /// Relative error of the wavelength at the end.
    pub(super) error: Option<f64>,
}

/// What a lattice's cells do to a skin that does not wrinkle.
#[derive(Debug, Clone)]
pub(super) struct Artefact {
    pub(super) shape: String,
    /// Beside a smooth skin, over that of the smooth one.
    pub(super) energy: f64,
    pub(super) angle_deg: f64,
    /// Cells and degrees.
    pub(super) profile: Vec<[f64; 2]>,
}

/// Where a bar that is bent at one end wrinkles.
#[derive(Debug, Clone)]
pub(super) struct Locality {
    pub(super) coupling: String,
    pub(super) outside: f64,
    pub(super) converged: bool,
    /// In wavelengths.
    pub(super) bent: [f64; 2],
    /// Wavelengths and thicknesses.
    pub(super) profile: Vec<[f64; 2]>,
}

/// A cushion that bounces and is pressed.
#[derive(Debug, Clone)]
pub(super) struct Thrown {
    pub(super) time_step: f64,
    pub(super) steps: f64,
    /// Of these, those that were made.
    pub(super) frames: f64,
    /// Farthest way out of its room, in its heights.
    pub(super) outside: f64,
    /// Least and greatest height over that at rest.
    pub(super) heights: [f64; 2],
    pub(super) factorizations: f64,
    pub(super) converged: bool,
}

/// A body as large as one of the papers'.
#[derive(Debug, Clone)]
pub(super) struct Size {
    pub(super) body: String,
    /// Of the skin, m.
    pub(super) thickness: f64,
    /// Of the moduli of skin and inside.
    pub(super) ratio: f64,
    pub(super) paper: Row,
    pub(super) own: Row,
    /// Newton steps in the dearest frame and in the middle one.
    pub(super) iterations: [f64; 2],
    /// Factorisations over Newton steps.
    pub(super) factorizations: f64,
    pub(super) converged: bool,
}

impl Size {
    /// Factorisations of the dearest frame and of the middle one: their Newton steps times what one takes
    /// on average over the run.
    pub(super) fn frame_factorizations(&self) -> [f64; 2] {
        self.iterations.map(|steps| steps * self.factorizations)
    }

    /// Share of a frame that assembly and forces of the inside take, once each in every Newton step:
    /// one Hessian is assembled for all factorisations of a step, and the column of assembly has all
    /// steps of a frame. Forces are taken as often as in the dearest frame, which is too often rather
    /// than too seldom.
    pub(super) fn inside_share(&self) -> f64 {
        let [_, frame, _, _, assembly, forces] = self.own.seconds;
        (assembly + self.iterations[0] * forces) / frame
    }
}

/// A line of the table of sizes.
#[derive(Debug, Clone)]
pub(super) struct Row {
    /// Unknowns and rows of the skin, its triangles, elements of the inside.
    pub(super) counts: [f64; 4],
    /// Set-up, a frame, and in it assembly of the skin in all Newton steps, once its forces; the same of
    /// the inside; s.
    pub(super) seconds: [f64; 6],
}

impl Findings {
    pub(super) fn read(lines: &[Value]) -> Self {
        let mut findings = Self::default();
        for line in lines {
            match line["part"].as_str() {
                Some("isocontours") => findings.samples.push(sample(line)),
                Some("dense") => findings.dense.push(Dense {
                    thickness: number(&line["thickness_m"]),
                    ratio: number(&line["ratio"]),
                    volume: number(&line["volume_m"]),
                    embedded: line["embedded_m"].as_f64(),
                }),
                Some("cell limit") => findings.cell_limits.push(CellLimit {
                    cell: number(&line["cell"]),
                    error: line["errors"][1].as_f64(),
                }),
                Some("artefact") => findings.artefacts.push(Artefact {
                    shape: word(&line["shape"]),
                    energy: number(&line["energy"]),
                    angle_deg: number(&line["angle_deg"]),
                    profile: profile(&line["profile"]),
                }),
                Some("locality") => findings.localities.push(Locality {
                    coupling: word(&line["coupling"]),
                    outside: number(&line["outside"]),
                    converged: line["converged"] == true,
                    bent: pair(&line["bent"]),
                    profile: profile(&line["profile"]),
                }),
                Some("thrown") => findings.thrown.push(Thrown {
                    time_step: number(&line["time_step_s"]),
                    steps: number(&line["steps"]),
                    frames: number(&line["frames"]),
                    outside: number(&line["outside"]),
                    heights: pair(&line["heights"]),
                    factorizations: number(&line["factorizations"]),
                    converged: line["converged"] == true,
                }),
                Some("size") => findings.sizes.push(Size {
                    body: word(&line["body"]),
                    thickness: number(&line["thickness_m"]),
                    ratio: number(&line["ratio"]),
                    paper: row(&line["paper"]),
                    own: row(&line["own"]),
                    iterations: pair(&line["iterations"]),
                    factorizations: number(&line["factorizations"]),
                    converged: line["converged"] == true,
                }),
                _ => {}
            }
        }
        findings
    }

    /// Samples of one coupling.
    pub(super) fn of<'a>(&'a self, coupling: &'a str) -> impl Iterator<Item = &'a Sample> {
        self.samples
            .iter()
            .filter(move |own| own.coupling == coupling)
    }

    /// Median size of a coupling's relative errors, soon after the onset (0) or at the end (1); `None`
    /// without samples.
    pub(super) fn median_error(&self, coupling: &str, key: usize) -> Option<f64> {
        let mut errors: Vec<f64> = self.of(coupling).map(|own| own.error_size(key)).collect();
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
    pub(super) fn smoother(&self) -> Option<f64> {
        let energy = |shape: &str| {
            let own = self.artefacts.iter().find(|own| own.shape == shape)?;
            Some(own.energy)
        };
        Some(energy("linear")? / energy("quadratic")?)
    }
}

fn sample(line: &Value) -> Sample {
    let measured = &line["measured_m"];
    Sample {
        coupling: word(&line["coupling"]),
        thickness: number(&line["thickness_m"]),
        ratio: number(&line["ratio"]),
        predicted: number(&line["predicted_m"]),
        measured: [measured[0].as_f64(), measured[1].as_f64()],
        reported: line["reported_m"].as_f64(),
        demand: pair(&line["demand"]),
        vertices: number(&line["vertices"]),
        converged: line["converged"] == true,
        seconds: number(&line["seconds"]),
    }
}

fn row(value: &Value) -> Row {
    Row {
        counts: std::array::from_fn(|i| number(&value["counts"][i])),
        seconds: std::array::from_fn(|i| number(&value["seconds"][i])),
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn word(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

fn pair(value: &Value) -> [f64; 2] {
    [number(&value[0]), number(&value[1])]
}

fn profile(value: &Value) -> Vec<[f64; 2]> {
    value.as_array().into_iter().flatten().map(pair).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn lines_become_findings() {
        let sample = |ratio: f64, measured: Option<f64>| {
            json!({
                "part": "isocontours", "coupling": "hybrid", "thickness_m": 5e-4, "ratio": ratio,
                "predicted_m": 0.01, "measured_m": [0.01, measured], "demand": [1.2, 1.5],
                "converged": true,
            })
        };
        let artefact = |shape: &str, energy: f64| json!({ "part": "artefact", "shape": shape, "energy": energy });
        let lines = [
            sample(30.0, Some(0.0098)),
            sample(300.0, Some(0.0104)),
            sample(3000.0, None),
            artefact("linear", 5.0),
            artefact("quadratic", 0.5),
        ];
        let findings = Findings::read(&lines);
        assert_eq!(findings.samples.len(), 3);
        // Of 2 %, 4 % and a failure.
        let median = findings.median_error(HYBRID, 1).expect("three samples");
        assert!((median - 0.04).abs() < 1e-12);
        assert_eq!(findings.median_error(HARD_ROWS, 1), None);
        assert_eq!(findings.smoother(), Some(10.0));
    }
}
