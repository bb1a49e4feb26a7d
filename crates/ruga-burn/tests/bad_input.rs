//! Every mistake is named, with the value and with what is accepted; nothing panics.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod sheets;

use nalgebra::Vector3;
use ruga_burn::{
    BurnError, BurnLaw, BurnSettings, BurnSolver, BurnState, FieldMesh, Front, FrontCorrection,
    FrontDeath, FrontDesign, Radiation, Source,
};
use ruga_mesh::{PerEdge, PerFace, PerVertex, TriMesh};
use sheets::{Sheet, irregular, strip, unit_front};

const NONSENSE: [f64; 5] = [0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

fn law() -> BurnLaw {
    unit_front(3.43).law().unwrap()
}

/// Name of the number that is refused.
fn out_of_range<T>(result: Result<T, BurnError>) -> &'static str {
    match result.err().unwrap() {
        BurnError::OutOfRange { name, accepted, .. } => {
            assert!(!accepted.is_empty());
            name
        }
        other => panic!("{other}"),
    }
}

/// Field and element that are refused.
fn bad_value<T>(result: Result<T, BurnError>) -> (&'static str, usize) {
    match result.err().unwrap() {
        BurnError::FieldOutOfRange { field, element, .. } => (field, element),
        other => panic!("{other}"),
    }
}

fn wrong_size<T>(result: Result<T, BurnError>) -> (&'static str, usize, usize) {
    match result.err().unwrap() {
        BurnError::FieldSize {
            field,
            values,
            expected,
        } => (field, values, expected),
        other => panic!("{other}"),
    }
}

#[test]
fn laws() {
    for bad in NONSENSE {
        let refused = |law: BurnLaw| out_of_range(law.check());
        assert_eq!(
            refused(BurnLaw {
                diffusivity: bad,
                ..law()
            }),
            "diffusivity"
        );
        assert_eq!(
            refused(BurnLaw {
                burn_rate: bad,
                ..law()
            }),
            "burning rate"
        );
        assert_eq!(
            refused(BurnLaw {
                adiabatic_rise: bad,
                ..law()
            }),
            "adiabatic rise"
        );
        assert_eq!(
            refused(BurnLaw {
                loss_time: Some(bad),
                ..law()
            }),
            "loss time"
        );
        let radiating = |emissivity, areal_heat_capacity| BurnLaw {
            radiation: Some(Radiation {
                emissivity,
                areal_heat_capacity,
            }),
            ..law()
        };
        assert_eq!(refused(radiating(bad, 100.0)), "emissivity");
        assert_eq!(refused(radiating(1.2, 100.0)), "emissivity");
        assert_eq!(refused(radiating(0.5, bad)), "areal heat capacity");
        if bad != 0.0 {
            let cold = BurnLaw {
                surroundings: bad,
                ..law()
            };
            assert!(BurnSolver::new(strip(4, 1.0).field(), cold, BurnSettings::default()).is_err());
            assert!(cold.check().is_err() && Front::of(&cold).is_err());
            assert!(FrontDeath::of(&cold).is_err());
        }
    }
}

#[test]
fn temperatures_in_the_wrong_order() {
    let below = BurnLaw {
        adiabatic_rise: 150.0,
        ..law()
    };
    let error = BurnError::BurningBelowIgnition {
        burning: 450.0,
        ignition: 500.0,
    };
    assert_eq!(below.check(), Err(error.clone()));
    assert_eq!(Front::of(&below), Err(error.clone()));
    let design = FrontDesign {
        burning: 450.0,
        ..unit_front(2.0)
    };
    assert_eq!(design.law(), Err(error));
    assert!(
        FrontDesign {
            burning: 500.0,
            ..design
        }
        .law()
        .is_err()
    );

    let warm = BurnLaw {
        surroundings: 500.0,
        ..law()
    };
    let error = BurnError::IgnitionBelowSurroundings {
        ignition: 500.0,
        surroundings: 500.0,
    };
    assert_eq!(warm.check(), Err(error.clone()));
    let design = FrontDesign {
        surroundings: 500.0,
        ..unit_front(2.0)
    };
    assert_eq!(design.law(), Err(error));
}

#[test]
fn designs() {
    for bad in NONSENSE {
        let refused = |design: FrontDesign| out_of_range(design.law());
        let good = unit_front(3.43);
        assert_eq!(refused(FrontDesign { speed: bad, ..good }), "front speed");
        assert_eq!(refused(FrontDesign { width: bad, ..good }), "front width");
        assert_eq!(
            refused(FrontDesign {
                ignition: bad,
                ..good
            }),
            "ignition temperature"
        );
        assert_eq!(
            refused(FrontDesign {
                burning: bad,
                ..good
            }),
            "temperature of burning"
        );
        assert_eq!(
            refused(FrontDesign {
                loss_time: Some(bad),
                ..good
            }),
            "loss time"
        );
    }
    // Burning barely above ignition, and enormously: an answer or an error, never a panic.
    for heat_ratio in [1.0 + 1e-12, 1.0001, 1e7, 1e12] {
        let design = unit_front(heat_ratio);
        if let Ok(law) = design.law() {
            let front = Front::of(&law).unwrap();
            assert!((front.speed - 1.0).abs() < 1e-3, "{heat_ratio} {front:?}");
        }
    }
}

#[test]
fn fronts_that_die() {
    let dying = BurnLaw {
        loss_time: Some(2.0),
        ..law()
    };
    let least = FrontDeath::of(&dying).unwrap().loss_time;
    let error = Front::of(&dying).unwrap_err();
    assert_eq!(
        error,
        BurnError::FrontDies {
            loss_time: 2.0,
            least
        }
    );
    assert!(error.to_string().contains("11.31") && error.to_string().contains("2.0"));
    // A sheet may still be stepped with such a law: the fire goes out.
    assert!(BurnSolver::new(strip(4, 1.0).field(), dying, BurnSettings::default()).is_ok());
}

#[test]
fn meshes() {
    let flat = |points: &[[f64; 2]]| -> Vec<Vector3<f64>> {
        points
            .iter()
            .map(|p| Vector3::new(p[0], p[1], 0.0))
            .collect()
    };
    let mesh = TriMesh::new(4, vec![[0, 1, 2], [2, 1, 3]]).unwrap();
    let degenerate = flat(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5]]);
    let error = FieldMesh::new(&mesh, &degenerate).err().unwrap();
    assert!(
        matches!(error, BurnError::DegenerateFace { face: 1, .. }),
        "{error}"
    );
    let coincident = flat(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 0.0]]);
    let error = FieldMesh::new(&mesh, &coincident).err().unwrap();
    assert!(
        matches!(error, BurnError::DegenerateFace { face: 1, .. }),
        "{error}"
    );
    let impossible: PerEdge<f64> = vec![1.0, 1.0, 1.0, 1.0, 3.0].into();
    let error = FieldMesh::from_lengths(&mesh, &impossible).err().unwrap();
    assert!(
        matches!(error, BurnError::DegenerateFace { face: 1, .. }),
        "{error}"
    );

    assert_eq!(wrong_size(FieldMesh::new(&mesh, &degenerate[..3])).1, 3);
    let mut infinite = flat(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
    assert!(FieldMesh::new(&mesh, &infinite).is_ok());
    infinite[2].y = f64::NAN;
    assert_eq!(bad_value(FieldMesh::new(&mesh, &infinite)).1, 2);
    let negative: PerEdge<f64> = vec![1.0, 1.0, 1.0, -1.0, 1.0].into();
    assert_eq!(bad_value(FieldMesh::from_lengths(&mesh, &negative)).1, 3);
    let short: PerEdge<f64> = vec![1.0; 4].into();
    assert_eq!(wrong_size(FieldMesh::from_lengths(&mesh, &short)).2, 5);

    let loose = TriMesh::new(4, vec![[0, 1, 3]]).unwrap();
    let square = flat(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
    let error = FieldMesh::new(&loose, &square).err().unwrap();
    assert_eq!(error, BurnError::LooseVertex { vertex: 2 });
    let empty = TriMesh::new(0, vec![]).unwrap();
    assert_eq!(FieldMesh::new(&empty, &[]).err(), Some(BurnError::NoFaces));
}

#[test]
fn states() {
    let field = irregular([3, 3], 1.0, 0.2, 1).field();
    let count = field.vertex_count();
    let filled = |value: f64| PerVertex::filled(count, value);
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let mut temperature = filled(300.0);
        temperature.as_mut_slice()[7] = bad;
        let refused = BurnState::new(&field, temperature, filled(1.0));
        assert_eq!(bad_value(refused), ("temperature", 7));
        assert_eq!(bad_value(BurnState::fresh(&field, bad)).1, 0);
    }
    for bad in [-0.1, 1.1, f64::NAN] {
        let mut fuel = filled(1.0);
        fuel.as_mut_slice()[2] = bad;
        let refused = BurnState::new(&field, filled(300.0), fuel);
        assert_eq!(bad_value(refused), ("fuel share", 2));
    }
    let short = PerVertex::filled(count - 1, 1.0);
    let refused = BurnState::new(&field, short.clone(), filled(1.0));
    assert_eq!(wrong_size(refused), ("temperature", count - 1, count));
    let refused = BurnState::new(&field, filled(300.0), short);
    assert_eq!(wrong_size(refused), ("fuel share", count - 1, count));
    let refused = BurnState::new(&field, filled(300.0), filled(0.0));
    assert_eq!(refused, Err(BurnError::NoFuel));
    let burnt_out = BurnState::restored(&field, filled(300.0), filled(0.0)).unwrap();
    assert!(burnt_out.is_burnt_out());
    assert!(BurnState::fresh(&field, 0.0).is_ok());
}

fn solver(sheet: &Sheet) -> BurnSolver {
    BurnSolver::new(sheet.field(), law(), BurnSettings::default()).unwrap()
}

#[test]
fn steps() {
    let sheet = irregular([3, 3], 1.0, 0.2, 1);
    let mut solver = solver(&sheet);
    let mut state = BurnState::fresh(solver.mesh(), 300.0).unwrap();
    for bad in NONSENSE {
        let refused = solver.step(&mut state, &[], bad);
        assert_eq!(out_of_range(refused), "time step");
        let settings = BurnSettings {
            advance: Some(bad),
            ..BurnSettings::default()
        };
        let refused = BurnSolver::new(sheet.field(), law(), settings);
        assert_eq!(out_of_range(refused), "advance per substep");
    }
    let error = solver.step(&mut state, &[], 1e6).unwrap_err();
    assert!(matches!(
        error,
        BurnError::TooManySubsteps {
            time_step: 1e6,
            limit: 100_000,
            ..
        }
    ));
    let mut other = BurnState::fresh(&strip(9, 1.0).field(), 300.0).unwrap();
    let refused = solver.step(&mut other, &[], 0.1);
    assert_eq!(wrong_size(refused), ("state", 20, 16));
    // Beyond floating point.
    let whole = BurnSettings {
        advance: None,
        correction: FrontCorrection::Uncorrected,
    };
    let mut solver = BurnSolver::new(sheet.field(), law(), whole).unwrap();
    let uneven = sheet.per_vertex(|x| 600.0 + x.x);
    let fuel = sheet.per_vertex(|_| 1.0);
    let mut state = BurnState::new(solver.mesh(), uneven, fuel).unwrap();
    let before = state.clone();
    let error = solver.step(&mut state, &[], 1e308).unwrap_err();
    assert_eq!(error, BurnError::Unsolvable { substep: 1e308 });
    assert_eq!(state, before);
}

#[test]
fn sources_factors_and_shares() {
    let sheet = irregular([3, 3], 1.0, 0.2, 1);
    let mut solver = solver(&sheet);
    let mut state = BurnState::fresh(solver.mesh(), 300.0).unwrap();
    let good = Source {
        temperature: 900.0,
        coefficient: 1.0,
        weights: sheet.per_vertex(|_| 1.0),
    };
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let hot = Source {
            temperature: bad,
            ..good.clone()
        };
        assert_eq!(
            out_of_range(solver.step(&mut state, &[hot], 0.1)),
            "temperature of a source"
        );
        let strong = Source {
            coefficient: bad,
            ..good.clone()
        };
        let refused = solver.step(&mut state, &[good.clone(), strong], 0.1);
        assert_eq!(out_of_range(refused), "coefficient of a source");
        let mut wide = good.clone();
        wide.weights.as_mut_slice()[5] = bad;
        assert_eq!(
            bad_value(wide.check(solver.mesh())),
            ("weight of a source", 5)
        );
        let mut factors = sheet.per_vertex(|_| 1.0);
        factors.as_mut_slice()[4] = bad;
        let settings = BurnSettings::default();
        let refused = BurnSolver::with_speed_factors(sheet.field(), law(), factors, settings);
        assert_eq!(bad_value(refused), ("speed factor", 4));
        let mut shares: PerFace<f64> = vec![1.0; sheet.mesh.face_count()].into();
        shares.as_mut_slice()[6] = bad;
        assert_eq!(bad_value(solver.set_conducting(&shares)).1, 6);
    }
    let short = Source {
        weights: vec![1.0; 3].into(),
        ..good
    };
    assert_eq!(
        wrong_size(short.check(solver.mesh())),
        ("weight of a source", 3, 16)
    );
    assert_eq!(wrong_size(solver.set_conducting(&vec![1.0; 3].into())).1, 3);
    // Nothing of all this has moved the state.
    assert_eq!(state, BurnState::fresh(solver.mesh(), 300.0).unwrap());
}
