//! T4, T5 and T17: what must not matter: place, units, meshes, threads.

use nalgebra::{Rotation3, Vector3};
use ruga_constraint::{Kernel, SampleConstraints, Sampling, constraint_rows};
use ruga_mesh::{SurfaceLookup, vertex_normals};
use ruga_shell::BendingModel;
use ruga_stepper::{Coupling, EdgeLimits, Modelling};
use ruga_validation::baselines::adjusted_as_printed;
use ruga_validation::{FilmSpec, Finding, FlatFilm, Rectangle, Sheet, SheetSpec, table_line};

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
    let base = strip.compressed(strain);
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
fn drift(sample: SampleConstraints, shift: f64) -> f64 {
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
        let set = sample(
            &mesh.mesh,
            positions,
            &normals,
            &[place],
            &kernel,
            Sampling::Quadrature,
        );
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
    let [here, away] = [0.0, 1e3].map(|shift| drift(adjusted_as_printed, shift));
    assert!(away > 1.0 && away > 10.0 * here, "{here} {away}");
    let numbers = format!("the average of a plane at its side drifts by {away:.0} lam");
    table_line(
        test,
        "papers: adjustment as printed",
        Finding::Fails,
        &numbers,
    );

    let [here, away] = [0.0, 1e3].map(|shift| drift(constraint_rows, shift));
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
    assert!(energy < 1e-6 && amplitude < 1e-3, "{energy} {amplitude}");
    let numbers = format!("energy within {energy:.0e}, A within {amplitude:.0e}");
    table_line(test, "ruga: no remesh", Finding::Holds, &numbers);
    let [energy, amplitude] = moved_about(&draft());
    assert!(energy < 2e-2 && amplitude < 0.15, "{energy} {amplitude}");
    let numbers = format!(
        "rounding decides between equal edges: another mesh, energy within {energy:.0e}, A {amplitude:.2}"
    );
    table_line(test, "ruga: remeshed", Finding::Bounded, &numbers);
}

/// Largest relative change of amplitude and wavelength from mesh to mesh, at 3 critical strains: finer and
/// coarser in turn, on uneven artist's meshes.
fn remeshed(coupling: Coupling, bending: BendingModel) -> [f64; 2] {
    let states = [(1, 12.5), (2, 15.625), (3, 12.5), (4, 15.625)].map(|(seed, points)| {
        let mut film = FlatFilm {
            waves: [4.0, 5.0],
            load: 3.0,
            mesh_seed: Some(seed),
            ..FlatFilm::new(150.0)
        };
        film.layer.coupling = coupling;
        let aspect = match bending {
            BendingModel::Hinge => 2.0,
            BendingModel::VertexCurvature => EdgeLimits::default().aspect,
        };
        let modelling = Modelling {
            points_per_wavelength: points,
            bending,
            remesh: Some(EdgeLimits {
                aspect,
                ..EdgeLimits::default()
            }),
            ..Modelling::default()
        };
        let (_, states) = film.states(&modelling, &[3.0]);
        [states[0].amplitude, states[0].relative_wavelength]
    });
    [0, 1].map(|i| {
        let changes = states
            .windows(2)
            .map(|pair| (pair[1][i] / pair[0][i] - 1.0).abs());
        changes.fold(0.0, f64::max)
    })
}

#[test]
fn t5_remeshes() {
    let test = "T5 finer and coarser mesh at 3 eps_c";
    let told = |[amplitude, wavelength]: [f64; 2]| {
        let [amplitude, wavelength] = [100.0 * amplitude, 100.0 * wavelength];
        format!("amplitude differs by {amplitude:.1} %, wavelength by {wavelength:.1} %")
    };
    let change = remeshed(Coupling::Constraint, BendingModel::Hinge);
    table_line(test, "rows alone, hinges", Finding::Fails, &told(change));
    assert!(change[0] > 0.02, "{change:?}");
    let change = remeshed(Coupling::Hybrid, BendingModel::VertexCurvature);
    table_line(test, "ruga", Finding::Holds, &told(change));
    assert!(change[0] < 0.02 && change[1] < 0.02, "{change:?}");
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
