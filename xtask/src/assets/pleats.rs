//! A flat sector of a ring, and the lines along which it is pleated, which all run to the ring's centre.

use std::fmt::{Error, Write};

/// Angle of a panel between two creases, degrees, and the number of panels. It is odd, so that the middle of one lies
/// on the y axis.
const PANEL: f64 = 12.0;
const PANELS: u32 = 23;
/// Inner and outer radius, m.
const RADII: [f64; 2] = [0.04, 0.1];
/// Cells across a panel and from the inner border to the outer one.
const CELLS: [u32; 2] = [2, 8];
/// Share of the texture that is left free on each side.
const MARGIN: f64 = 0.02;

/// An OBJ file, in metres: the object `Pleats`, around the origin in the plane z = 0, and the curves `Mountains` and
/// `Valleys` on it by turns.
pub(super) fn file() -> Result<String, Error> {
    let mut text = String::from("o Pleats\n");
    let [across, rows] = CELLS;
    let columns = across * PANELS;
    for (j, i) in (0..=rows).flat_map(|j| (0..=columns).map(move |i| (j, i))) {
        let out = f64::from(j) / f64::from(rows);
        let [x, y] = place(f64::from(i) / f64::from(across), out);
        let texture = |c: f64| 0.5 + (0.5 - MARGIN) * c / RADII[1];
        writeln!(text, "v {x:.9} {y:.9} 0")?;
        writeln!(text, "vt {:.6} {:.6}", texture(x), texture(y))?;
    }
    for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
        let a = j * (columns + 1) + i + 1;
        let [b, c, d] = [a + 1, a + columns + 2, a + columns + 1];
        // Diagonals alternate, so that the mesh prefers no direction.
        let halves = match (i + j) % 2 {
            0 => [[a, d, c], [a, c, b]],
            _ => [[a, d, b], [b, d, c]],
        };
        for [a, b, c] in halves {
            writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}")?;
        }
    }
    for (name, first) in [("Mountains", 1), ("Valleys", 2)] {
        writeln!(text, "o {name}")?;
        for crease in (first..PANELS).step_by(2) {
            for out in [0.0, 1.0] {
                let [x, y] = place(f64::from(crease), out);
                writeln!(text, "v {x:.9} {y:.9} 0")?;
            }
            writeln!(text, "l -2 -1")?;
        }
    }
    Ok(text)
}

/// A place (m): `panels` counts from one straight border, `out` is the share of the way from the inner arc to the outer.
fn place(panels: f64, out: f64) -> [f64; 2] {
    let (sin, cos) = (PANEL * (panels - 0.5 * f64::from(PANELS)))
        .to_radians()
        .sin_cos();
    let radius = RADII[0] + (RADII[1] - RADII[0]) * out;
    [radius * sin, -radius * cos]
}
