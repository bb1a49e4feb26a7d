//! What was found, in words.

use ruga_material::crease_onset;
use ruga_validation::fold_panel::{ELEMENTS, FoldRun, at_error, of_element};

use crate::block::Block;
use crate::drifts::WAYS;
use crate::findings::Findings;
use crate::hung::Hung;
use crate::onsets::{NO_LINE, kappa};

/// All of it, for people: the lines of the page, then tables.
pub(crate) fn words(findings: &Findings) -> String {
    let mut lines = lines(findings);
    lines.push(String::new());
    lines.push("A fold whose angle varies: edges, triangles, error in %, ms, million operations of a factorisation".to_owned());
    lines.extend(findings.folds.iter().map(|run| {
        format!(
            "  {:<28} {:>3} {:>6} {:>7.2} {:>9.2} {:>8.2}",
            run.element,
            run.edges,
            run.faces,
            100.0 * run.error,
            1e3 * run.seconds,
            1e-6 * run.flops
        )
    }));
    lines.push(String::new());
    let closed = crease_onset(kappa());
    lines.push(format!(
        "Load at which a film folds along a line of kappa {:.3}, closed form {closed:.4}",
        kappa()
    ));
    lines.extend(findings.onsets.iter().map(|onset| {
        let expected = if onset.way == NO_LINE { 1.0 } else { closed };
        let off = 100.0 * (onset.load / expected - 1.0);
        format!(
            "  {:<36} {:>3} points  {:.4}  {off:+.1} %",
            onset.way, onset.points, onset.load
        )
    }));
    lines.push(String::new());
    lines.push(
        "Pictures: triangles, processor seconds, fold in degrees, share of stretching".to_owned(),
    );
    lines.extend(findings.pictures.iter().map(|own| {
        format!(
            "  {:<14} {:>6} {:>7.1} {:>6.1} {:>6.3}  {}{}",
            own.file,
            own.faces,
            own.seconds,
            own.fold,
            own.membrane,
            own.what,
            failed(own.converged)
        )
    }));
    lines.extend(cloths(&findings.cloths));
    lines.extend(blocks(&findings.blocks));
    lines.join("\n") + "\n"
}

fn cloths(cloths: &[Hung]) -> Vec<String> {
    let head = "Cloth hung by two corners (hung.png, from left to right, a row after the other): triangles, \
                processor ms, Newton steps, energy with that of the weight in mJ, angle along the line in degrees";
    let mut lines = vec![String::new(), head.to_owned()];
    lines.extend(cloths.iter().map(|own| {
        format!(
            "  {:<36} {:>5} {:>7.1} {:>4} {:>9.3} {:>6.1}{}",
            own.what,
            own.faces,
            1e3 * own.seconds,
            own.iterations,
            1e3 * own.energy,
            own.fold,
            failed(own.converged)
        )
    }));
    lines
}

fn blocks(blocks: &[Block]) -> Vec<String> {
    let head = "Pressed block (block.png, from left to right): triangles of the skin, seconds, relief in mm; of every \
                line the mean and the largest fold in degrees and the mean depth in mm";
    let mut lines = vec![String::new(), head.to_owned()];
    lines.extend(blocks.iter().map(|own| {
        let folds = own.lines.iter().map(|line| {
            let [mean, largest] = line.fold;
            format!("  {mean:+.1} {largest:+.1} {:+.2}", 1e3 * line.depth)
        });
        format!(
            "  {:<26} {:>5} {:>6.1} {:>6.2}{}{}",
            own.what,
            own.faces,
            own.seconds,
            1e3 * own.relief,
            folds.collect::<String>(),
            failed(own.converged)
        )
    }));
    lines
}

fn failed(converged: bool) -> &'static str {
    if converged { "" } else { ", NOT CONVERGED" }
}

/// The short lines of the page.
pub(crate) fn lines(findings: &Findings) -> Vec<String> {
    let mut lines = orders(&findings.folds);
    lines.extend(equal_errors(&findings.folds));
    for (_, way) in WAYS {
        let own = findings.drifts.iter().filter(|drift| drift.way == way);
        let gaps: Vec<_> = own.map(|drift| format!("{:.1e}", drift.last())).collect();
        if !gaps.is_empty() {
            lines.push(format!("Gap after 4 s, {way}: {} m", gaps.join(", ")));
        }
    }
    if let Some(rest) = &findings.rest {
        let last = rest.energies.last().copied().unwrap_or(f64::NAN);
        lines.push(format!(
            "Paper’s quasistatic way: energy {last:.2} times the least after {} steps,",
            rest.energies.len()
        ));
        lines.push(format!(
            "    the last step {:.2} times the second; hard rows: {} steps",
            rest.last_step, rest.newton_steps
        ));
    }
    if !findings.springs.is_empty() {
        lines.push(
            "Fold under one moment over theory’s, 12 places of a line on one mesh:".to_owned(),
        );
    }
    for own in &findings.springs {
        let (low, high) = own
            .folds
            .iter()
            .fold((f64::MAX, 0.0_f64), |(l, h), &f| (l.min(f), h.max(f)));
        lines.push(format!("    {}: {low:.3} to {high:.3}", own.what));
    }
    if let Some(cost) = &findings.cost {
        let share = |[a, b]: [f64; 2]| b / a;
        lines.push(format!(
            "Ten lines on one mesh: assembly {:+.1} %, no entry and no unknown",
            100.0 * (cost.assembly - 1.0)
        ));
        let step = |i: usize| 1e3 * cost.seconds[i] / cost.iterations[i] as f64;
        lines.push(format!(
            "    load step {:+.1} %; {:.1} and {:.1} ms a Newton step, {} and {} of them",
            100.0 * (cost.frame - 1.0),
            step(0),
            step(1),
            cost.iterations[0],
            cost.iterations[1]
        ));
        lines.push(format!(
            "A band of small triangles instead of a line: {:.1} times the triangles,",
            share(cost.faces.map(|n| n as f64))
        ));
        lines.push(format!(
            "    {:.1} times the work of a factorisation; edges {:.0} times shorter, which",
            share(cost.flops),
            1.0 / share(cost.shortest)
        ));
        lines.push("    is what steps of an explicit method shrink by".to_owned());
    }
    lines
}

fn orders(runs: &[FoldRun]) -> Vec<String> {
    let order = |name: &str| {
        let own = of_element(runs, name);
        let [first, .., last] = own.as_slice() else {
            return None;
        };
        let size = (last.edges as f64 / first.edges as f64).ln();
        let order = (first.error / last.error).ln() / size;
        Some(format!("Order of the error, {name}: {order:.2}"))
    };
    ELEMENTS.iter().filter_map(|own| order(own.1)).collect()
}

/// What the paper's best result costs with our elements.
fn equal_errors(runs: &[FoldRun]) -> Vec<String> {
    let [_, paper, ours] = ELEMENTS.map(|own| of_element(runs, own.1));
    let Some(best) = paper.last() else {
        return Vec::new();
    };
    let at = |quantity: &dyn Fn(&FoldRun) -> f64| at_error(&ours, best.error, quantity);
    let (Some(faces), Some(seconds)) = (at(&|run| run.faces as f64), at(&|run| run.seconds)) else {
        return Vec::new();
    };
    let beyond = if faces.1 { " (extrapolated)" } else { "" };
    vec![
        format!(
            "At the paper’s {:.1} % ({} triangles, {:.0} ms) ours takes{beyond}",
            100.0 * best.error,
            best.faces,
            1e3 * best.seconds
        ),
        format!(
            "    {:.0} triangles and {:.1} ms: {:.0} and {:.0} times less",
            faces.0,
            1e3 * seconds.0,
            best.faces as f64 / faces.0,
            best.seconds / seconds.0
        ),
    ]
}
