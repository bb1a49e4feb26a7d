//! Patterns in two directions: the simulator's shell against the spectral plate, on the same
//! periodic base.
//!
//! Angles are those of the slopes (across the crests), weighted with their squares. A pattern's
//! `alignment` is 1 if all crests are parallel and 0 without direction; its `crossing` is 1 for two
//! directions at right angles and 0 if all directions are as frequent.

#![allow(dead_code, reason = "the tests and the long runs each use a part")]

use nalgebra::Vector2;
use ruga_material::LayerMaterial;
use ruga_solver::NewtonSettings;
use ruga_stepper::LayerSurface;
use ruga_validation::FlatFilm;
use ruga_validation::reference::{
    Carrier, Grid, HeightField, Orientation, PatchRows, Plate, RelaxSettings, ShellPatch,
    StretchedSheet, noise, square,
};

/// So stiff a film that what a plate leaves out is below 1 %: the critical strain is 0.5 %.
pub(crate) const MODULUS_RATIO: f64 = 1000.0;

/// Sectors of a histogram of angles, 15 degrees each.
pub(crate) const SECTORS: usize = 12;

/// A patch, by its size in critical wavelengths and the points on each.
#[derive(Clone, Copy)]
pub(crate) struct Size {
    pub(crate) waves: usize,
    pub(crate) points: usize,
}

/// What a pattern is compared by.
pub(crate) struct Findings {
    /// Wave number, and the sizes of its components, over the critical one.
    pub(crate) wave: [f64; 3],
    /// `sqrt(<|grad w|^2> / <w^2>)` over the critical wave number.
    pub(crate) slope_wave: f64,
    /// Over `2 sqrt(eps_c)/k_c`.
    pub(crate) amplitude: f64,
    /// Energy below the flat state, over `C eps_c^2 / 2`.
    pub(crate) gap: f64,
    pub(crate) orientation: Orientation,
}

impl Findings {
    fn new(spec: &FlatFilm, field: &HeightField, energy_gap: f64) -> Self {
        let film = spec.theory();
        let k = film.wave_number;
        Self {
            wave: field.mean_wave([0.4 * k, 1.8 * k]).map(|found| found / k),
            slope_wave: field.slope_wave_number() / k,
            amplitude: 0.5 * field.amplitude() * k / film.critical_strain.sqrt(),
            gap: -energy_gap / (0.5 * film.membrane_stiffness * film.critical_strain.powi(2)),
            orientation: field.orientation(SECTORS),
        }
    }

    fn print(&self, name: &str) {
        let o = &self.orientation;
        println!(
            "{name:26} k {:.3} ({:.3} {:.3})  A {:.3}  gap {:.3}  alignment {:.2}  crossing {:.2}  tilt {:.1}  {:.2?}",
            self.wave[0],
            self.wave[1],
            self.wave[2],
            self.amplitude,
            self.gap,
            o.alignment(),
            o.crossing(),
            o.tilt().to_degrees(),
            o.shares
        );
    }
}

pub(crate) fn mean(findings: &[Findings], value: impl Fn(&Findings) -> f64) -> f64 {
    findings.iter().map(value).sum::<f64>() / findings.len() as f64
}

pub(crate) fn mean_orientation(findings: &[Findings]) -> Orientation {
    let all: Vec<_> = findings.iter().map(|f| f.orientation.clone()).collect();
    Orientation::mean(&all)
}

pub(crate) fn assert_near(what: &str, found: f64, wanted: f64, tolerance: f64) {
    let error = found / wanted - 1.0;
    assert!(
        error.abs() < tolerance,
        "{what}: {found:.4}, not {wanted:.4}, {error:+.3}"
    );
}

/// The plate through a path of strains (critical ones) along x and y; findings at every step.
pub(crate) fn plate_path(
    spec: &FlatFilm,
    carrier: Carrier,
    size: Size,
    path: &[[f64; 2]],
    seed: u64,
) -> Vec<Findings> {
    let film = spec.theory();
    let side = size.waves as f64 * film.wavelength;
    let count = size.waves * 8;
    let grid = Grid::new([count; 2], [side; 2]);
    let plate = Plate::new(grid.clone(), film, spec.layer.material.poisson, carrier);
    let mut heights = noise(&grid, 1e-3 * spec.layer.material.thickness, seed);
    let settings = RelaxSettings {
        seed: 100 * seed,
        ..RelaxSettings::new(spec.layer.material.thickness)
    };
    let step = |loads: &[f64; 2]| {
        let strain = loads.map(|load| load * film.critical_strain);
        let relaxed = plate.relax(&mut heights, strain, &settings);
        assert!(relaxed.converged, "{relaxed:?}");
        let field = HeightField {
            grid: grid.clone(),
            heights: heights.clone(),
        };
        let found = Findings::new(spec, &field, relaxed.energy_gap);
        found.print(&format!("plate {seed} at {loads:.2?}"));
        found
    };
    path.iter().map(step).collect()
}

/// The flat shell.
pub(crate) fn shell(spec: &FlatFilm, rows: PatchRows, size: Size) -> ShellPatch {
    let film = spec.theory();
    let columns = size.waves * size.points;
    let edge = film.wavelength / size.points as f64;
    let lines = 2 * (columns as f64 / 3.0_f64.sqrt()).round() as usize;
    ShellPatch::new(&spec.layer.material, film, rows, [columns, lines], edge)
}

/// Solves a shell under critical strains along x and y.
pub(crate) fn solve(
    spec: &FlatFilm,
    shell: &mut ShellPatch,
    loads: &[f64; 2],
    seed: u64,
) -> Findings {
    let settings = NewtonSettings {
        seed,
        // A pattern without direction creeps along valleys of no consequence.
        energy_tolerance: 1e-5,
        max_iterations: 400,
        ..NewtonSettings::default()
    };
    let strain = loads.map(|load| load * spec.theory().critical_strain);
    let report = shell.solve(strain, &settings);
    println!(
        "{:?} after {} iterations, {} factorisations",
        report.stop, report.iterations, report.factorizations
    );
    assert!(report.converged);
    let found = Findings::new(spec, &shell.heights(), shell.energy_gap());
    found.print(&format!("shell {seed} at {loads:.2?}"));
    found
}

/// The shell through a path.
pub(crate) fn shell_path(
    spec: &FlatFilm,
    rows: PatchRows,
    size: Size,
    path: &[[f64; 2]],
    seed: u64,
) -> Vec<Findings> {
    let mut shell = shell(spec, rows, size);
    let grid = shell.heights().grid;
    let step = |(index, loads): (usize, &[f64; 2])| {
        // A pattern that is exactly straight stays so.
        let seed = 100 * seed + index as u64;
        shell.raise(&noise(&grid, 1e-3 * spec.layer.material.thickness, seed));
        solve(spec, &mut shell, loads, seed)
    };
    path.iter().enumerate().map(step).collect()
}

/// Equal compression along x and y, twice what wrinkles a film, at once from noise.
pub(crate) fn labyrinths(
    rows: PatchRows,
    size: Size,
    shells: u64,
    plates: u64,
) -> [Vec<Findings>; 2] {
    let spec = FlatFilm::new(MODULUS_RATIO);
    // Both directions press: the critical strain is that much smaller.
    let path = [[2.0 / (1.0 + spec.layer.material.poisson); 2]];
    let last = |mut steps: Vec<Findings>| steps.remove(steps.len() - 1);
    let shells = (1..=shells).map(|seed| last(shell_path(&spec, rows, size, &path, seed)));
    let shells = shells.collect();
    let plates = (1..=plates)
        .map(|seed| last(plate_path(&spec, Carrier::Pasternak, size, &path, seed)))
        .collect();
    [shells, plates]
}

/// Wave number within 5 % of the plate's, amplitude and energy within 3 %, no single direction.
/// Returns how much two directions at right angles prevail.
pub(crate) fn check_labyrinths(shells: &[Findings], plates: &[Findings]) -> f64 {
    let compare = |what: &str, tolerance: f64, value: fn(&Findings) -> f64| {
        let [found, wanted] = [mean(shells, value), mean(plates, value)];
        println!("{what}: shell {found:.4}, plate {wanted:.4}");
        assert_near(what, found, wanted, tolerance);
    };
    compare("wave number", 0.05, |f| f.wave[0]);
    compare("amplitude", 0.03, |f| f.amplitude);
    compare("energy gap", 0.03, |f| f.gap);
    let [shell, plate] = [shells, plates].map(mean_orientation);
    println!(
        "alignment {:.3} and {:.3}, crossing {:.3} and {:.3}, distance {:.3}",
        shell.alignment(),
        plate.alignment(),
        shell.crossing(),
        plate.crossing(),
        shell.distance(&plate)
    );
    assert!(shell.alignment() < 0.2);
    mean(shells, |f| f.orientation.crossing())
}

/// What becomes of the plate's labyrinth in a shell that starts from it; the plate's first.
pub(crate) fn given_labyrinth(rows: PatchRows, size: Size, seed: u64) -> [Findings; 2] {
    let spec = FlatFilm::new(MODULUS_RATIO);
    let film = spec.theory();
    let load = 2.0 / (1.0 + spec.layer.material.poisson);
    let mut shell = shell(&spec, rows, size);
    let grid = shell.heights().grid;
    let plate = Plate::new(
        grid.clone(),
        film,
        spec.layer.material.poisson,
        Carrier::Pasternak,
    );
    let mut heights = noise(&grid, 1e-3 * spec.layer.material.thickness, seed);
    let settings = RelaxSettings::new(spec.layer.material.thickness);
    let relaxed = plate.relax(&mut heights, [load * film.critical_strain; 2], &settings);
    assert!(relaxed.converged);
    let field = HeightField { grid, heights };
    let given = Findings::new(&spec, &field, relaxed.energy_gap);
    given.print("plate");
    let [along, across] = plate.slides(&field.heights);
    shell.displace(&[along, across, field.heights]);
    let found = solve(&spec, &mut shell, &[load; 2], seed);
    let distance = found.orientation.distance(&given.orientation);
    println!("distance of the histograms {distance:.3}");
    [given, found]
}

/// Without rows the plate's labyrinth is the shell's too: the same waves in the same directions, none
/// of them alone.
pub(crate) fn check_given_labyrinth(size: Size, tolerance: f64) {
    let [given, found] = given_labyrinth(PatchRows::None, size, 2);
    assert_near("wave number", found.wave[0], given.wave[0], tolerance);
    assert_near("amplitude", found.amplitude, given.amplitude, tolerance);
    assert_near("energy gap", found.gap, given.gap, tolerance);
    let (found, given) = (&found.orientation, &given.orientation);
    assert!(found.distance(given) < 4.0 * tolerance);
    assert!(found.alignment() < 0.15);
    assert!((found.crossing() - given.crossing()).abs() < 0.1);
}

/// `sqrt(int |grad w|^2 / int w^2)` (1/m, in rest lengths) and the alignment of the slopes, over the
/// triangles of a flat layer with both |x| and |y| up to `reach`.
pub(crate) fn measured(layer: &LayerSurface, reach: f64, stretch: f64) -> [f64; 2] {
    let (mut squares, mut slopes, mut turns) = (0.0, 0.0, Vector2::zeros());
    for face in layer.faces.iter() {
        let p = face.map(|v| layer.driver_positions[v as usize].xy() / stretch);
        let centre = (p[0] + p[1] + p[2]) / 3.0;
        if centre.amax() * stretch > reach {
            continue;
        }
        let [a, b, c] = face.map(|v| {
            let v = v as usize;
            (layer.positions[v] - layer.driver_positions[v]).z
        });
        let (s, t) = (p[1] - p[0], p[2] - p[0]);
        let twice_area = s.perp(&t);
        let slope = Vector2::new(
            (t.y * (b - a) - s.y * (c - a)) / twice_area,
            (s.x * (c - a) - t.x * (b - a)) / twice_area,
        );
        squares += twice_area * square(a, b, c);
        slopes += twice_area * slope.norm_squared();
        turns +=
            twice_area * Vector2::new(slope.x.powi(2) - slope.y.powi(2), 2.0 * slope.x * slope.y);
    }
    [(slopes / squares).sqrt(), turns.norm() / slopes]
}

/// Compression along x to 2.5 critical strains, then along y to as much.
pub(crate) const HERRINGBONE: [[f64; 2]; 6] = [
    [1.1, 0.0],
    [1.5, 0.0],
    [2.5, 0.0],
    [2.5, 1.15],
    [2.5, 1.6],
    [2.5, 2.5],
];

pub(crate) fn check_herringbone(shell: &[Findings], plate: &[Findings], tolerances: [f64; 2]) {
    let [wave, energy] = tolerances;
    let straight = &shell[2];
    assert!(straight.orientation.alignment() > 0.99, "straight first");
    let [found, wanted] = [shell, plate].map(|steps| &steps[5]);
    // As many crests along x as there were.
    assert_near("crests along x", found.wave[1], straight.wave[1], 0.1);
    assert_near("wave number", found.wave[0], wanted.wave[0], wave);
    // The box holds a few jogs, a whole number, chosen by the noise where the crests give way.
    assert_near("jogs along y", found.wave[2], wanted.wave[2], 0.15);
    assert_near("amplitude", found.amplitude, wanted.amplitude, energy);
    assert_near("energy gap", found.gap, wanted.gap, energy);
    let (found, wanted) = (&found.orientation, &wanted.orientation);
    let distance = found.distance(wanted);
    println!("distance of the histograms {distance:.3}");
    assert!(distance < 0.15);
    // Two directions, equally frequent, nearly at right angles; few slopes along x or y.
    assert!((found.left_share() - 0.5).abs() < 0.05);
    let tilt = found.tilt().to_degrees();
    assert!((30.0..50.0).contains(&tilt), "tilt {tilt}");
    assert!((tilt - wanted.tilt().to_degrees()).abs() < 3.0);
    let near_diagonals = found.shares[2..=4].iter().chain(&found.shares[8..=10]);
    assert!(near_diagonals.sum::<f64>() > 0.75);
}

/// Wavelength and length of the wrinkles, and the wavelength that theory has for this length (m), of
/// a sheet pulled by some shares of its own.
pub(crate) fn stretched(thinness: f64, rows: usize, stretches: &[f64]) -> Vec<[f64; 3]> {
    let width = 0.1;
    let material = LayerMaterial {
        young: 1e6,
        poisson: 0.3,
        thickness: width / thinness,
        density: 1100.0,
    };
    let length = 2.5 * width;
    let pull = |&stretch: &f64| {
        let mut sheet = StretchedSheet::new(&material, [length, width], rows);
        let state = sheet.wrinkle(stretch, 1);
        let inside = 0.5 * state.lengthwise;
        println!(
            "width/thickness {thinness}, stretch {stretch}: lam/W {:.4}, over theory {:.3}; wrinkles {:.3} as long as the sheet, over their theory {:.3}; height/h {:.2}, {} iterations",
            state.wavelength / width,
            state.wavelength / sheet.theory(stretch, length),
            inside / length,
            state.wavelength / sheet.theory(stretch, inside),
            state.height / material.thickness,
            state.solve.iterations
        );
        assert!(state.solve.converged);
        assert!(state.height > material.thickness, "wrinkled");
        [state.wavelength, inside, sheet.theory(stretch, inside)]
    };
    stretches.iter().map(pull).collect()
}

/// The law `lam = 2 sqrt(pi) (B/T)^(1/4) L^(1/2)` holds with the length of the wrinkles in the place
/// of the sheet's. They cover seven tenths of it, and shrink as the pull grows: by the sheet's own
/// length, wavelengths come out a sixth too short and fall faster than with the power -1/4.
pub(crate) fn check_stretched(thinness: f64, rows: usize, stretches: &[f64], tolerances: [f64; 2]) {
    let found = stretched(thinness, rows, stretches);
    let last = stretches.len() - 1;
    let pull = (stretches[last] / stretches[0]).ln();
    let raw = (found[last][0] / found[0][0]).ln() / pull;
    let reduced = raw - 0.5 * (found[last][1] / found[0][1]).ln() / pull;
    println!("exponent {raw:.3}, of wrinkles of one length {reduced:.3}");
    assert!((reduced + 0.25).abs() < tolerances[0], "{reduced}");
    assert!((raw + 0.25).abs() < 0.05, "{raw}");
    for [wavelength, _, theory] in found {
        assert_near("wavelength", wavelength, theory, tolerances[1]);
    }
}
