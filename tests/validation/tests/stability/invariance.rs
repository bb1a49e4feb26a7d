//! T4, T5 and T17: what must not matter: place, units, meshes, threads.

use nalgebra::{Rotation3, Vector3};
use ruga_constraint::{Kernel, Sampling, constraint_rows};
use ruga_mesh::{SurfaceLookup, vertex_normals};
use ruga_shell::BendingModel;
use ruga_stepper::Modelling;
use ruga_validation::{
    Carry, FilmCoupling, FilmSpec, Finding, Rectangle, RemeshedFilm, RemeshedSpec, Sheet,
    SheetSpec, Target, table_line,
};

use crate::{draft, exact, patch, patch_mesh, placed_patch, simulated, simulated_on, skin};

/// Energy gap and amplitude, without unit, at 2 critical strains of a film whose lengths are in
/// units of `unit` m, turned by `turn` and moved by `shift` wavelengths.
fn wrinkled(unit: f64, turn: &Rotation3<f64>, shift: f64) -> [f64; 2] {
    let mut spec = FilmSpec::flat(150.0);
    // Pressures in N per unit squared.
    spec.film.young *= unit * unit;
    spec.substrate.young *= unit * unit;
    spec.film.thickness /= unit;
    spec.substrate.thickness /= unit;
    let strip = spec.strip(4.0, 12);
    let theory = spec.theory();
    let offset = Vector3::new(0.6, -0.64, 0.48) * (shift * theory.wavelength);
    let moved = |p: &Vector3<f64>| turn * p + offset;
    let strain = 2.0 * theory.critical_strain;
    let mut made = SheetSpec::film(&spec, &strip).with_free_sides();
    made.rest = made.rest.iter().map(moved).collect();
    let base = spec.base.points(&strip, strain);
    let normal = turn * Vector3::z();
    let mut sheet = Sheet::new(made);
    sheet.lay_on(base.iter().map(moved).collect(), &vec![normal; base.len()]);
    sheet.displace(|p| {
        let along = (turn.inverse() * (p - offset)).x;
        normal * (spec.film.thickness * (theory.wave_number * along).sin())
    });
    assert!(sheet.solve(&exact()).converged);
    let area: f64 = sheet.areas().iter().sum();
    let scale = theory.membrane_stiffness * theory.critical_strain.powi(2) * area;
    let amplitude = sheet.amplitude(&normal, |_| true);
    [sheet.gap() / scale, amplitude / spec.film.thickness]
}

/// Distance, in wavelengths, between the averages of one function over two meshes of a plane that
/// lies `shift` wavelengths away.
fn drift(sampling: Sampling, shift: f64) -> f64 {
    let wavelength = FilmSpec::flat(150.0).theory().wavelength;
    let plane = Rectangle {
        length: 3.0 * wavelength,
        width: 2.0 * wavelength,
        radius: None,
    };
    let average = |points: f64| {
        let mesh = plane.meshed(wavelength / points);
        let positions = mesh.positions.as_slice();
        let lookup = SurfaceLookup::new(&mesh.mesh, positions);
        let side = Vector3::new(1.4 * wavelength, 0.2 * wavelength, 0.0);
        let place = lookup.closest(&side).expect("a surface").point;
        let normals = vertex_normals(&mesh.mesh, positions);
        let kernel = [Kernel::alone(wavelength)];
        let set = constraint_rows(&mesh.mesh, positions, &normals, &[place], &kernel, sampling);
        let set = set.expect("a row");
        let away = Vector3::x() * (shift * wavelength);
        let terms = set.rows[0].weights.iter();
        terms
            .map(|&(v, weight)| (mesh.positions[v] + away) * weight)
            .sum::<Vector3<f64>>()
    };
    (average(9.0) - average(13.0)).norm() / wavelength
}

/// Coordinates of a thousand wavelengths have an absolute error of `1e3 lam 2^-53`, which is
/// `1e-12` of an edge in strain, `1e-10` of the critical strain; it enters sums of thousands of
/// faces with either sign.
#[test]
fn t4_place_and_units() {
    let test = "T4 moved by 1e3 lam, turned, in mm";
    let [here, away] = [0.0, 1e3].map(|shift| drift(Sampling::AdjustedAsPrinted, shift));
    assert!(away > 1.0 && away > 10.0 * here, "{here} {away}");
    let numbers = format!("the average of a plane at its side drifts by {away:.0} lam");
    table_line(
        test,
        "papers: adjustment as printed",
        Finding::Fails,
        &numbers,
    );

    let [here, away] = [0.0, 1e3].map(|shift| drift(Sampling::Quadrature, shift));
    assert!((away - here).abs() < 1e-9, "{here} {away}");
    let none = Rotation3::identity();
    let turn = Rotation3::from_euler_angles(0.3, -0.7, 1.1);
    let plain = wrinkled(1.0, &none, 0.0);
    let others = [(1.0, none, 1e3), (1.0, turn, 1e3), (1e-3, none, 0.0)];
    let errors = others.iter().flat_map(|(unit, turn, shift)| {
        let other = wrinkled(*unit, turn, *shift);
        [0, 1].map(|i| (other[i] / plain[i] - 1.0).abs())
    });
    let worst = errors.fold(0.0, f64::max);
    assert!(worst < 1e-9, "{worst}");
    let numbers = format!("energy gap and amplitude within {worst:.0e}");
    table_line(test, "ruga", Finding::Holds, &numbers);
}

/// Largest relative changes of energy and amplitude where a patch is moved by 10 m, turned, or both.
fn moved_about(modelling: &Modelling) -> [f64; 2] {
    let (points, triangles) = patch_mesh();
    let run = |turn: Rotation3<f64>, shift: f64| {
        let offset = Vector3::new(0.6, -0.64, 0.48) * shift;
        let driver = placed_patch(&points, &triangles, |p| turn * p + offset);
        let result = simulated_on(&driver, &skin(), modelling, 4).expect("a patch");
        assert!(result.converged);
        [result.layers[0].energy, result.layers[0].amplitude]
    };
    let (none, turn) = (
        Rotation3::identity(),
        Rotation3::from_euler_angles(0.3, -0.7, 1.1),
    );
    let plain = run(none, 0.0);
    let others = [(none, 10.0), (turn, 0.0), (turn, 10.0)].map(|(turn, shift)| run(turn, shift));
    [0, 1].map(|i| {
        let changes = others.iter().map(|other| (other[i] / plain[i] - 1.0).abs());
        changes.fold(0.0, f64::max)
    })
}

/// Rounding decides which of equal edges the remesher splits: where a mesh lies then matters as
/// much as which mesh of the same fineness it is, and on a patch of four waves decides the pattern.
#[test]
fn t4_from_the_driver_on() {
    let test = "T4 moved by 10 m, turned";
    let fixed = Modelling {
        remesh: None,
        ..draft()
    };
    let [energy, amplitude] = moved_about(&fixed);
    // Matching second moments of the rows loses up to five digits of coordinates that are 10 m long.
    assert!(energy < 1e-6 && amplitude < 1e-5, "{energy} {amplitude}");
    let numbers = format!("energy within {energy:.0e}, A within {amplitude:.0e}");
    table_line(test, "ruga: no remesh", Finding::Holds, &numbers);
    let [energy, amplitude] = moved_about(&draft());
    assert!(energy < 2e-2 && amplitude < 0.15, "{energy} {amplitude}");
    let numbers = format!(
        "rounding decides between equal edges: another mesh, energy within {energy:.0e}, A {amplitude:.2}"
    );
    table_line(test, "ruga: remeshed", Finding::Bounded, &numbers);
}

/// Largest relative changes of energy gap and amplitude over `steps` remeshes; infinite where one of
/// them leads to no equilibrium.
fn remeshed(spec: &RemeshedSpec, steps: usize) -> [f64; 2] {
    let points = [12.5, 15.625];
    const LOST: [f64; 2] = [f64::INFINITY; 2];
    let mut film = RemeshedFilm::new(spec, points, 0.1);
    if !film.solve().converged {
        return LOST;
    }
    let mut states = Vec::new();
    // Where rows alone hold it, the film needs two meshes to find its wavelength.
    for step in 0..steps + 2 {
        film.remesh(points[step % 2], 0.1, 200 + step as u64, Carry::Smooth);
        if !film.solve().converged {
            return LOST;
        }
        states.push(film.state());
    }
    let changes = states[1..].windows(2).map(|pair| {
        let [before, after] = [&pair[0], &pair[1]];
        [
            (after.gap / before.gap - 1.0).abs(),
            (after.amplitude / before.amplitude - 1.0).abs(),
        ]
    });
    changes.fold([0.0; 2], |worst, change| {
        [worst[0].max(change[0]), worst[1].max(change[1])]
    })
}

/// A short version of `remeshing.rs`, which has more steps, widths and samplings.
#[test]
fn t5_remeshes() {
    let test = "T5 finer and coarser mesh at 3 eps_c";
    let spec = RemeshedSpec::wrinkled();
    let mut papers = RemeshedSpec {
        waves: [5.0, 1.0],
        sampling: Sampling::AdjustedAsPrinted,
        target: Target::OwnMesh,
        is_calibrated: false,
        ..spec
    };
    papers.film.coupling = FilmCoupling::Constraint(0.577);
    papers.film.bending = BendingModel::Hinge;
    let told = |[gap, amplitude]: [f64; 2]| {
        let [gap, amplitude] = [100.0 * gap, 100.0 * amplitude];
        format!("energy jumps by {gap:.2} % of the gap, amplitude by {amplitude:.2} %")
    };
    let change = remeshed(&papers, 2);
    assert!(change[0] > 0.1, "{change:?}");
    table_line(
        test,
        "papers: rows alone, as printed",
        Finding::Fails,
        &told(change),
    );
    let change = remeshed(&spec, 3);
    assert!(change[0] < 1e-3 && change[1] < 0.02, "{change:?}");
    table_line(test, "ruga", Finding::Holds, &told(change));
}

#[test]
fn t17_threads() {
    let test = "T17 1 or 2 threads, run again";
    let run = |threads: usize| -> Vec<u64> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.expect("threads");
        let result = pool.install(|| simulated(&patch(0.12), &skin(), &draft(), 4));
        let positions = result.keys[0].layers[0].positions.iter();
        let coordinates = positions.flat_map(|p| [p.x, p.y, p.z]);
        coordinates.map(f64::to_bits).collect()
    };
    table_line(test, "papers", Finding::NotApplicable, "not their subject");
    let once = run(1);
    assert!(!once.is_empty() && once == run(2) && once == run(1));
    let numbers = format!(
        "the same bits in {} coordinates of a simulated pose",
        once.len()
    );
    table_line(test, "ruga", Finding::Holds, &numbers);
}
