//! What was found, in words.

use crate::findings::{Curl, Findings, PROJECTIONS, THICKNESSES};

/// Seven projection steps of the paper's table 2: springs, milliseconds. Its last row prints 10,000 springs, for which
/// the time per spring beside it would be wrong.
const PRINTED: [(usize, f64); 5] = [
    (1_000, 142.46),
    (4_000, 362.69),
    (16_000, 1268.0),
    (25_000, 1877.92),
    (100_000, 7412.92),
];

/// All of it, for people: the lines of the page, then tables.
pub(crate) fn words(findings: &Findings) -> String {
    let mut lines = lines(findings);
    lines.push(String::new());
    lines.push(
        "Curl of a strip ten times as long as wide: curvature over that wanted, off by %, ms"
            .to_owned(),
    );
    lines.extend(findings.curls.iter().map(|own| {
        format!(
            "  layers {:<6} of a cell apart  {:<24} {:>8.4} {:>9.3} {:>9.2}",
            own.thickness,
            name(own),
            own.curl,
            100.0 * own.error(),
            1e3 * own.seconds
        )
    }));
    lines.push(String::new());
    lines.push(
        "Seven projection steps: springs, iterations, ms, µs per spring; as printed".to_owned(),
    );
    for own in &findings.speeds {
        let per_spring = |seconds: f64, springs: usize| 1e6 * seconds / springs as f64;
        let (springs, printed) = nearest(own.springs);
        lines.push(format!(
            "  {:>7} {:>6} {:>9.2} {:>7.2}   {:>7.1}",
            own.springs,
            own.iterations,
            1e3 * own.seconds,
            per_spring(own.seconds, own.springs),
            per_spring(1e-3 * printed, springs)
        ));
    }
    lines.join("\n") + "\n"
}

/// What a run is called.
fn name(own: &Curl) -> String {
    match own.is_springs {
        true => format!("springs, {} projections", own.number),
        false => format!("ruga, {} triangles across", own.number),
    }
}

/// The row of the paper's table with the nearest number of springs.
fn nearest(springs: usize) -> (usize, f64) {
    let far = |row: &&(usize, f64)| row.0.abs_diff(springs);
    PRINTED
        .iter()
        .min_by_key(far)
        .copied()
        .unwrap_or(PRINTED[0])
}

/// The short lines of the page.
pub(crate) fn lines(findings: &Findings) -> Vec<String> {
    let mut lines = Vec::new();
    for thickness in THICKNESSES {
        let own = |is_springs: bool| {
            let all = findings.curls.iter();
            all.filter(move |c| c.thickness == thickness && c.is_springs == is_springs)
        };
        let after = |number: usize| own(true).find(|c| c.number == number);
        if let (Some(seven), Some(last)) = (after(PROJECTIONS[1]), own(true).last()) {
            lines.push(format!(
                "Layers {thickness} of a cell apart: the springs bend to {:.0} % of what they want",
                100.0 * seven.curl
            ));
            lines.push(format!(
                "    after 7 projections, to {:.0} % after {} ({:.0} ms)",
                100.0 * last.curl,
                last.number,
                1e3 * last.seconds
            ));
        }
        if let (Some(first), Some(last)) = (own(false).next(), own(true).last()) {
            lines.push(format!(
                "    ruga, {} triangles across: {:.2} % off after {:.0} ms",
                first.number,
                100.0 * first.error(),
                1e3 * first.seconds
            ));
            if let Some(seconds) = first.as_near {
                lines.push(format!(
                    "    and as near as the springs after {:.1} ms, {:.0} times sooner",
                    1e3 * seconds,
                    last.seconds / seconds
                ));
            }
        }
    }
    if let Some(own) = findings.speeds.last() {
        let (springs, printed) = nearest(own.springs);
        let [found, printed] = [
            1e6 * own.seconds / own.springs as f64,
            1e3 * printed / springs as f64,
        ];
        lines.push(format!(
            "Seven projection steps: {found:.1} µs per spring ({} springs, one thread);",
            own.springs
        ));
        lines.push(format!(
            "    the paper prints {printed:.0} µs (quad-core machine of 2011)"
        ));
    }
    lines
}
