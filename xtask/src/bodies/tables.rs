//! The samples as tables.

use std::fmt::Write;

use super::findings::Findings;

/// A line per slab.
pub(super) fn isocontours(findings: &Findings) -> String {
    let mut table = "coupling,thickness_m,modulus_ratio,predicted_m,after_onset_m,at_end_m,reported_m,\
                     error_after_onset,error_at_end,demand_after_onset,demand_at_end,vertices,converged,\
                     seconds\n"
        .to_owned();
    for own in &findings.samples {
        // Writing to a string cannot fail.
        let _ = writeln!(
            table,
            "{},{:.6e},{},{:.6e},{},{},{},{},{},{:.3},{:.3},{},{},{:.2}",
            own.coupling,
            own.thickness,
            own.ratio,
            own.predicted,
            cell(own.measured[0]),
            cell(own.measured[1]),
            cell(own.reported),
            cell(own.errors()[0]),
            cell(own.errors()[1]),
            own.demand[0],
            own.demand[1],
            own.vertices,
            own.converged,
            own.seconds,
        );
    }
    table
}

/// A line per volume.
pub(super) fn dense(findings: &Findings) -> String {
    let mut table = "thickness_m,modulus_ratio,volume_m,embedded_m,error\n".to_owned();
    for own in &findings.dense {
        let _ = writeln!(
            table,
            "{:.6e},{},{:.6e},{},{}",
            own.thickness,
            own.ratio,
            own.volume,
            cell(own.embedded),
            cell(own.error()),
        );
    }
    table
}

/// Nothing for what was not there to be measured.
fn cell(value: Option<f64>) -> String {
    value.map_or(String::new(), |value| format!("{value:.6e}"))
}
