//! What was found, in words.

use ruga_validation::curl_panel::{CurlRun, PROJECTIONS, THICKNESSES};

use crate::findings::Findings;

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
    lines.extend(errors(findings));
    lines.extend(pictures(findings));
    lines.extend(large(findings));
    lines.join("\n") + "\n"
}

/// Figure 8 in numbers.
fn errors(findings: &Findings) -> Vec<String> {
    let sums = findings.errors.iter().map(|own| own.iter().sum());
    let sums: Vec<f64> = sums.collect();
    let rises = sums.windows(2).filter(|pair| pair[1] > pair[0]).count();
    vec![
        String::new(),
        format!(
            "Figure 8: the sum of the norms of the constraints rises in {rises} of {} projection steps; the paper says in none",
            sums.len().saturating_sub(1)
        ),
    ]
}

/// Pictures, with times and what was measured in them.
fn pictures(findings: &Findings) -> Vec<String> {
    let title = "Pictures by the paper's springs and by ruga, after captions and text of its figures, which are not at hand";
    let mut lines = vec![String::new(), title.to_owned()];
    for own in &findings.pictures {
        lines.push(format!(
            "  {:<18} {:>6} springs {:>5} steps {:>7.2} s {:>6.1} ms a step   {}",
            own.file,
            own.springs,
            own.steps,
            own.seconds,
            1e3 * own.seconds / own.steps.max(1) as f64,
            own.what
        ));
        lines.extend(own.facts.iter().map(|fact| format!("      {fact}")));
    }
    lines
}

/// Steps of large sheets.
fn large(findings: &Findings) -> Vec<String> {
    let title = "A large sheet that burns: 10 by 7 cm, lit at a corner; steps of a tenth of a second, with frames";
    let mut lines = vec![String::new(), title.to_owned()];
    for own in &findings.large {
        let total: f64 = own.seconds.iter().sum();
        let percent = |k: usize| 100.0 * own.seconds[k] / total;
        let edges = match own.is_even {
            true => "edges of one length",
            false => "finer edges where it burns",
        };
        let all: usize = own.factorisations.iter().sum();
        let per_step = all as f64 / f64::from(own.steps);
        lines.push(format!(
            "  front {:.1} mm wide, {edges}, {} triangles: {per_step:.1} factorisations a step",
            1e3 * own.width,
            own.triangles
        ));
        lines.push(format!("      factorisations {:?}", own.factorisations));
        lines.push(format!("      iterations {:?}", own.iterations));
        lines.push(format!(
            "      {} steps of {:.1} s: temperature and fuel {:.0} %, {} new meshes {:.0} %, solver {:.0} %, cut and what is seen {:.0} %",
            own.steps,
            total / f64::from(own.steps),
            percent(0),
            own.remeshings,
            percent(1),
            percent(2),
            percent(3)
        ));
    }
    lines
}

/// What a run is called.
fn name(own: &CurlRun) -> String {
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
    let of = |&thickness: &f64| curl_lines(findings, thickness);
    let mut lines: Vec<String> = THICKNESSES.iter().flat_map(of).collect();
    if let Some(own) = findings.speeds.last() {
        let (springs, printed) = nearest(own.springs);
        let found = 1e6 * own.seconds / own.springs as f64;
        let printed = 1e3 * printed / springs as f64;
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

/// How far springs at a distance of their layers bend, and the product's coarsest mesh beside them.
fn curl_lines(findings: &Findings, thickness: f64) -> Vec<String> {
    let all = findings.curls.iter();
    let alike = all.filter(|own| own.thickness == thickness);
    let (springs, product): (Vec<&CurlRun>, Vec<&CurlRun>) = alike.partition(|own| own.is_springs);
    let seven = springs.iter().find(|own| own.number == PROJECTIONS[1]);
    let (Some(seven), Some(last)) = (seven, springs.last()) else {
        return Vec::new();
    };
    let mut lines = vec![
        format!(
            "Layers {thickness} of a cell apart: the springs bend to {:.0} % of what they want",
            100.0 * seven.curl
        ),
        format!(
            "    after 7 projections, to {:.0} % after {} ({:.0} ms)",
            100.0 * last.curl,
            last.number,
            1e3 * last.seconds
        ),
    ];
    if let Some(first) = product.first() {
        lines.push(format!(
            "    ruga, {} triangles across: {:.2} % off after {:.0} ms",
            first.number,
            100.0 * first.error(),
            1e3 * first.seconds
        ));
        lines.extend(first.as_near.map(|seconds| {
            let sooner = last.seconds / seconds;
            format!(
                "    and as near as the springs after {:.1} ms, {sooner:.0} times sooner",
                1e3 * seconds
            )
        }));
    }
    lines
}
