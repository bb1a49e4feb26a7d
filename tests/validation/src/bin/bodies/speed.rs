//! What a frame of the largest bodies takes, against its goals.

use ruga_validation::body::Size;

use crate::findings::Findings;
use crate::verdict::Verdict;

/// Unknowns of the bodies on which goals stand: those of the paper's largest.
const UNKNOWNS: usize = 27_000;

/// Factorisations that the frame in which a body lands may take, and the middle one.
const FACTORIZATIONS: [f64; 2] = [12.0, 5.0];

/// Share of a frame that the inside may take.
const INSIDE: f64 = 0.1;

/// A line for every large body.
pub(crate) fn speeds(findings: &Findings) -> Vec<String> {
    let sizes = findings.sizes.iter();
    let lines: Vec<String> = sizes
        .filter(|own| own.own.counts[0] >= UNKNOWNS)
        .map(speed)
        .collect();
    if lines.is_empty() {
        let verdict = Verdict::NotMeasured;
        return vec![format!("speed (table 1), {UNKNOWNS} unknowns: {verdict}")];
    }
    lines
}

fn speed(own: &Size) -> String {
    // A run that broke off has not shown what it takes.
    let verdict = |value: f64, most: f64| Verdict::one(own.converged && value <= most);
    let factorizations = own.frame_factorizations();
    let [landing, middle] = [0, 1].map(|i| {
        let (count, most) = (factorizations[i], FACTORIZATIONS[i]);
        format!("{count:.1}, at most {most}: {}", verdict(count, most))
    });
    let inside = own.inside_share();
    let failed = if own.converged { "" } else { ", NOT CONVERGED" };
    format!(
        "speed (table 1), {} of {} unknowns, skin {:.2} mm thick and {} times as stiff: factorisations of the dearest frame, {landing}; of the middle one, {middle}; {:.1} s a frame, the paper's {:.1} s; assembly and forces of the inside {:.1} % of a frame, at most {:.0} %: {}{failed}",
        own.body.kind.name(),
        own.own.counts[0],
        1e3 * own.body.thickness,
        own.body.ratio,
        own.own.seconds[1],
        own.paper.seconds[1],
        100.0 * inside,
        100.0 * INSIDE,
        verdict(inside, INSIDE),
    )
}

#[cfg(test)]
mod tests {
    use ruga_validation::body::{Kind, Row, SizedBody};

    use super::*;

    fn pillow(unknowns: usize, frame: f64) -> Size {
        Size {
            body: SizedBody {
                kind: Kind::Cushion,
                thickness: 6e-4,
                ratio: 100.0,
                points: 1.0,
            },
            paper: Row {
                counts: [28194, 2108, 19792, 45],
                seconds: [2.961, 45.735, 0.521, 0.014, 0.005, 0.004],
            },
            own: Row {
                counts: [unknowns, 2096, 18206, 72],
                seconds: [2.7, frame, 0.5, 0.006, 0.4, 0.01],
            },
            iterations: [10, 4],
            factorizations: 1.2,
            converged: true,
        }
    }

    fn told<const N: usize>(sizes: [Size; N]) -> Vec<String> {
        speeds(&Findings {
            sizes: sizes.into(),
            ..Findings::default()
        })
    }

    #[test]
    fn a_frame_is_counted_and_compared() {
        let lines = told([pillow(27315, 20.0), pillow(3138, 20.0)]);
        assert_eq!(lines.len(), 1);
        for part in [
            "dearest frame, 12.0, at most 12: met",
            "middle one, 4.8, at most 5: met",
            "20.0 s a frame, the paper's 45.7 s",
            // (0.4 + 10 x 0.01) / 20.
            "inside 2.5 % of a frame, at most 10 %: met",
        ] {
            assert!(lines[0].contains(part), "{}", lines[0]);
        }
    }

    #[test]
    fn a_slow_inside_and_a_broken_run_miss() {
        let mut broken = pillow(27315, 20.0);
        broken.converged = false;
        let lines = told([pillow(27315, 4.0), broken]);
        assert!(lines[0].ends_with("12.5 % of a frame, at most 10 %: MISSED"));
        assert!(lines[1].ends_with("at most 10 %: MISSED, NOT CONVERGED"));
        assert!(!lines[1].contains("met"));
    }

    #[test]
    fn small_bodies_tell_nothing() {
        let lines = told([pillow(3138, 1.0)]);
        assert_eq!(lines, ["speed (table 1), 27000 unknowns: not measured"]);
    }
}
