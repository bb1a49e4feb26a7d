//! The table of times.

use std::fmt::Write;

use crate::findings::Findings;

/// The papers' table of times (RK, table 1) beside ours, for people.
pub(crate) fn sizes(findings: &Findings) -> String {
    let mut table = "\
Bodies of the sizes of Remillard and Kry 2013 (RK), table 1; seconds, on one thread. A pillow of 50 cm
falls, lands and is pressed in steps of 0.02 s; a bar is bent and a slab pushed together from equilibrium
to equilibrium, both with all of their skin on top, and the slab in five elements, for of one nothing
would be free between what is held. A frame is the mean of those with more than three Newton steps,
everything included; A skin and A inside are what its Hessians take if they are made alone, F one set of
forces. Skins are RK's, but for the first two: theirs, too thin for the mesh, would have a constraint for
every vertex here, as the third has in both, and the last bar and slab here.

      unknowns  constr.    faces  elements |  set-up    frame   A skin   F skin  A inside  F inside
"
    .to_owned();
    for own in &findings.sizes {
        let [most, middle] = own.iterations;
        let times = own.factorizations;
        let failed = if own.converged { "" } else { ", NOT CONVERGED" };
        let _ = writeln!(
            table,
            "{}, skin {:.2} mm thick and {} times as stiff: {middle} Newton steps in the middle frame, {most} in the dearest; {times:.1} factorisations each{failed}",
            own.body.kind.name(),
            1e3 * own.body.thickness,
            own.body.ratio,
        );
        for (source, row) in [("ruga", &own.own), ("RK", &own.paper)] {
            let [unknowns, rows, faces, elements] = row.counts;
            let [set_up, frame, skin, skin_forces, inside, inside_forces] = row.seconds;
            let _ = writeln!(
                table,
                "{source:<5} {unknowns:>8} {rows:>8} {faces:>8} {elements:>9} | {set_up:>7.2} {frame:>8.2} {skin:>8.3} {skin_forces:>8.4} {inside:>9.4} {inside_forces:>9.4}",
            );
        }
    }
    table
}
