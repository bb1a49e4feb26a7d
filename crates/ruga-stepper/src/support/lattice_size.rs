//! How fine a body's lattice should be, and what is wrong with one that is not.

use nalgebra::Vector3;
use ruga_lattice::{Lattice, MAX_CELLS, Shape, cell_size};

use crate::Body;

/// Lattice cells over the wavelength below which the lattice itself wrinkles: in waves of two cells,
/// which give way in it as well as in the foundation that stands for the same inside. The rows of a
/// hybrid coupling keep these apart from two wavelengths on. A slab of cells of 1.2 to 2 wavelengths
/// has waves within 3 % of theory, one of 1.0 has them 9 % and one of 0.9 80 % too long. Longer cells,
/// measured up to 4 wavelengths, do waves little harm: 3.5 %. What bounds cells from above is how the
/// body bends.
const LEAST_CELL: f64 = 1.15;

/// Cells across the thinnest side with which a body bends as it should: a bar of one quadratic element
/// across is within a hundredth of beam theory, one of trilinear ones bends a third too little.
const fn cells_across(shape: Shape) -> f64 {
    match shape {
        Shape::Quadratic => 1.0,
        Shape::Linear => 3.0,
    }
}

/// Poisson ratio beyond which a coarse lattice locks, and cells from which it hardly does: at 0.48
/// and 8 cells a bar is 12 % too stiff in bending.
const LOCKING: (f64, u32) = (0.45, 16);

/// Cells along the longest side that nobody asked for: of a body without thin parts.
const USUAL_CELLS: u32 = 6;

/// Times as many across the thinnest side as it needs, where nothing speaks against it.
const AMPLE: f64 = 2.0;

/// Cells of the whole box up to which a lattice nobody asked for is worth its time.
const AFFORDABLE: f64 = 2000.0;

/// Cells along the longest of a body's `sides` (m) with which it bends and bulges freely; fewer where
/// they would be shorter than its waves (m) allow or too many, and never less than one.
pub(crate) fn cells_for(sides: &Vector3<f64>, shape: Shape, wavelength: f64) -> u32 {
    let wanted = (AMPLE * cells_across(shape) * sides.max() / sides.min()).round();
    // Casts saturate.
    let wanted = (wanted as u32).clamp(USUAL_CELLS, MAX_CELLS);
    let fits = |cells: &u32| {
        let size = cell_size(sides, *cells);
        let count = sides.component_div(&size).product();
        size.min() >= LEAST_CELL * wavelength && count <= AFFORDABLE
    };
    (1..=wanted).rev().find(fits).unwrap_or(1)
}

/// Advice for a number of cells that the user chose, and for one that was computed.
fn advice(body: &Body, chosen: &'static str, planned: &'static str) -> &'static str {
    match body.cells {
        Some(_) => chosen,
        None => planned,
    }
}

/// Warnings of a lattice of so many cells along the longest of the body's `sides` (m) that does not suit
/// waves of this length, m.
pub(crate) fn lattice_warnings(
    (lattice, cells, sides): (&Lattice, u32, &Vector3<f64>),
    body: &Body,
    wavelength: f64,
) -> Vec<String> {
    let cell = lattice.cell_size();
    let (shortest, longest) = (cell.min(), cell.max());
    let mut warnings = Vec::new();
    if shortest < LEAST_CELL * wavelength {
        warnings.push(format!(
            "interior: lattice cells of {:.2} mm are shorter than {LEAST_CELL} wavelengths of {:.2} mm, so that the lattice wrinkles too and waves come out up to twice as long{}",
            1e3 * shortest,
            1e3 * wavelength,
            advice(body, "; take fewer cells", "")
        ));
    }
    let thinnest = sides.min();
    let across = cells_across(body.shape);
    // The grid fits the body's box, so that whole numbers of cells are usual.
    if across * longest > 1.001 * thinnest {
        warnings.push(format!(
            "interior: lattice cells of {:.2} mm are too long for the body's thinnest side of {:.2} mm, which needs {across} of them to bend freely{}",
            1e3 * longest,
            1e3 * thinnest,
            advice(body, "; take more cells", "; more would be shorter than its waves allow")
        ));
    }
    let (poisson, enough) = LOCKING;
    if body.material.poisson > poisson && cells < enough {
        warnings.push(format!(
            "interior: at a Poisson ratio of {} a lattice of {} cells locks and is too stiff in bending (by 12 % at 0.48 and 8 cells); take at most {poisson}, or more cells",
            body.material.poisson, cells
        ));
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_as_many_as_bending_wants_and_waves_allow() {
        let cells = |sides: [f64; 3], wavelength| {
            cells_for(&Vector3::from(sides), Shape::Quadratic, wavelength)
        };
        let (cushion, rod) = ([0.12, 0.12, 0.04], [1.0, 0.1, 0.1]);
        assert_eq!([cells(cushion, 0.001), cells(rod, 0.001)], [6, 20]);
        // Of 2 cm; of 3 and 4, for five would leave 2 cm in height; of what there is.
        assert_eq!(cells(cushion, 0.0173), 6);
        assert_eq!(cells(cushion, 0.0175), 4);
        assert_eq!(cells(cushion, 1.0), 1);
        let linear = cells_for(&Vector3::from(rod), Shape::Linear, 0.001);
        // 55 x 6 x 6; 60 would be enough to bend, and too many.
        assert_eq!(linear, 55);
        // 31 x 31 x 2; 32 x 32 x 2 would be too many.
        assert_eq!(cells([1.0, 1.0, 0.05], 0.001), 31);
    }
}
