//! The references agree with each other where more than one of them holds.

#![allow(
    clippy::print_stdout,
    reason = "the measured values are what --nocapture is for"
)]

use ruga_material::{LayerMaterial, Substrate, WavelengthModel, Wrinkling, wrinkling};
use ruga_validation::FlatFilm;
use ruga_validation::reference::{
    Anchor, BendingLaw, Carrier, Chain, DenseBlock, FilmTheory, Grid, HeightField, Plate,
    RelaxSettings, noise, wave,
};

/// Points per wave of a chain.
const POINTS: usize = 64;

/// Of every film, m.
const THICKNESS: f64 = 1e-4;

/// The film of a modulus ratio, without tangential springs: the anchors have none.
fn film(modulus_ratio: f64) -> Wrinkling {
    Wrinkling {
        tangential_stiffness: 0.0,
        ..FlatFilm::new(modulus_ratio).theory()
    }
}

fn assert_near(what: &str, found: f64, wanted: f64, tolerance: f64) {
    let error = found / wanted - 1.0;
    println!("{what}: {found:.4e}, {wanted:.4e}, {error:+.5}");
    assert!(
        error.abs() < tolerance,
        "{what}: {found}, not {wanted}, {error:+.4}"
    );
}

/// The anchors are what hinges on equilateral triangles do when compressed along edges, in a box of
/// the critical wavelength.
#[test]
fn chain_with_the_hinges_of_the_anchors_reproduces_them() {
    for anchor in Anchor::ALL {
        let film = film(anchor.modulus_ratio);
        let chain = Chain {
            film,
            bending: BendingLaw::AlongEdges,
            points: POINTS,
        };
        let at = |what: &str| format!("ratio {}, {what}", anchor.modulus_ratio);
        let onset = chain.onset();
        let relative = onset.wavelength / film.wavelength;
        assert_near(&at("wavelength"), relative, anchor.wavelength, 0.002);
        let relative = onset.strain / film.critical_strain;
        assert_near(&at("onset"), relative, anchor.onset, 0.002);
        for (load, wanted) in Anchor::LOADS.iter().zip(anchor.amplitudes) {
            let strain = load * film.critical_strain;
            let state = chain.wrinkled(strain, film.wavelength);
            assert!(state.converged);
            let relative = state.amplitude / film.amplitude(strain);
            assert_near(&at(&format!("A at {load}")), relative, wanted, 0.005);
        }
        for &(load, wanted) in anchor.energy_gaps {
            let excess = (load - 1.0) * film.critical_strain;
            let gap = chain
                .wrinkled(load * film.critical_strain, film.wavelength)
                .energy_gap;
            let relative = gap / (-0.5 * film.membrane_stiffness * excess * excess);
            assert_near(&at(&format!("gap at {load}")), relative, wanted, 0.01);
        }
    }
}

/// The rule of the anchors: `eps_c (1 + eps_c)` and `lam_c (1 + eps_c/3)`. Without the hinges it is
/// `eps_c (1 + 7/6 eps_c)` and `lam_c (1 + eps_c/2)`.
#[test]
fn chain_buckles_where_the_closed_form_says() {
    for anchor in Anchor::ALL {
        for bending in [BendingLaw::Angle, BendingLaw::AlongEdges] {
            let film = film(anchor.modulus_ratio);
            let theory = FilmTheory {
                linear: film,
                bending,
            };
            let exact = theory.onset().expect("a strain far below 0.4");
            let chain = Chain {
                film,
                bending,
                points: POINTS,
            };
            let onset = chain.onset();
            let at = |what: &str| format!("ratio {}, {bending:?}, {what}", anchor.modulus_ratio);
            assert_near(&at("onset"), onset.strain, exact.strain, 5e-4);
            assert_near(&at("wavelength"), onset.wavelength, exact.wavelength, 5e-4);
            let [onset_order, wave_order] = match bending {
                BendingLaw::Angle => [7.0 / 6.0, 0.5],
                BendingLaw::AlongEdges => [17.0 / 18.0, 1.0 / 3.0],
            };
            let small = film.critical_strain;
            // What the first order leaves out is of the second.
            let left = 4.0 * small * small;
            let expanded = small * (1.0 + onset_order * small);
            assert_near(&at("expanded onset"), exact.strain, expanded, left);
            let expanded = film.wavelength * (1.0 + wave_order * small);
            assert_near(&at("expanded wavelength"), exact.wavelength, expanded, left);
        }
    }
}

#[test]
fn chain_follows_the_closed_amplitude_and_energy() {
    for (ratio, tolerances) in [(150.0, [0.01, 0.02]), (1000.0, [0.003, 0.008])] {
        let film = film(ratio);
        let bending = BendingLaw::Angle;
        let theory = FilmTheory {
            linear: film,
            bending,
        };
        let chain = Chain {
            film,
            bending,
            points: POINTS,
        };
        let wavelength = chain.onset().wavelength;
        for load in Anchor::LOADS {
            let strain = load * film.critical_strain;
            let state = chain.wrinkled(strain, wavelength);
            let at = |what: &str| format!("ratio {ratio}, {what} at {load}");
            let amplitude = theory.amplitude(strain);
            assert_near(&at("A"), state.amplitude, amplitude, tolerances[0]);
            let gap = theory.energy_gap(strain);
            assert_near(&at("gap"), state.energy_gap, gap, tolerances[1]);
        }
    }
}

/// What is left of a chain's mesh: nothing that matters between 32 and 64 points.
#[test]
fn chain_is_resolved() {
    let film = film(150.0);
    let [coarse, fine] = [32, 64].map(|points| Chain {
        film,
        bending: BendingLaw::Angle,
        points,
    });
    let strain = 2.0 * film.critical_strain;
    let [a, b] = [coarse, fine].map(|chain| chain.wrinkled(strain, film.wavelength));
    assert_near("amplitude", a.amplitude, b.amplitude, 0.002);
    assert_near("onset", coarse.onset().strain, fine.onset().strain, 0.002);
}

/// A plate of two waves by one, moved from a small wave.
fn relaxed_wave(film: Wrinkling, carrier: Carrier, strain: [f64; 2]) -> (HeightField, f64) {
    let grid = Grid::new([32, 16], [2.0 * film.wavelength, film.wavelength]);
    let plate = Plate::new(grid.clone(), film, 0.3, carrier);
    let mut heights = wave(&grid, 1e-3 / film.wave_number, [2, 0]);
    let settings = RelaxSettings {
        tolerance: 1e-12,
        kick: 0.0,
        ..RelaxSettings::new(THICKNESS)
    };
    let relaxed = plate.relax(&mut heights, strain, &settings);
    assert!(relaxed.converged, "{relaxed:?}");
    (HeightField { grid, heights }, relaxed.energy_gap)
}

/// Foeppl-von Karman, one sine: `A = (2/k) sqrt(eps - eps_c)` and `-C/2 (eps - eps_c)^2`, whatever
/// the foundation.
#[test]
fn plate_with_one_wave_is_linear_theory() {
    let stiff = film(1000.0);
    // A skin on a layer half a wave thick.
    let substrate = Substrate {
        young: 1e5,
        poisson: 0.48,
        thickness: 0.5 * stiff.wavelength,
    };
    let thin = FlatFilm::new(1000.0).layer.material;
    let on_layer = wrinkling(&thin, &substrate, WavelengthModel::Layer).expect("valid materials");
    let on_layer = Wrinkling {
        tangential_stiffness: 0.0,
        ..on_layer
    };
    for (film, carrier) in [
        (stiff, Carrier::Pasternak),
        (stiff, Carrier::HalfSpace),
        (on_layer, Carrier::Pasternak),
        (on_layer, Carrier::Layer(substrate)),
    ] {
        for load in [1.2, 2.0, 4.0] {
            let strain = load * film.critical_strain;
            let (field, gap) = relaxed_wave(film, carrier, [strain, 0.0]);
            let amplitude = film.amplitude(strain);
            assert_near("A", field.amplitude(), amplitude, 1e-4);
            let wanted = -0.5 * film.membrane_stiffness * (strain - film.critical_strain).powi(2);
            assert_near("gap", gap, wanted, 1e-4);
            let k = field.mean_wave([0.5 * film.wave_number, 1.5 * film.wave_number])[0];
            assert_near("k", k, film.wave_number, 1e-9);
        }
    }
}

/// Where the critical strain is small, plate and chain are the same film; also with the
/// tangential springs that a shell has.
#[test]
fn plate_agrees_with_the_chain_at_small_strain() {
    let held = FlatFilm::new(3e5).theory();
    for film in [film(3e5), held] {
        let chain = Chain {
            film,
            bending: BendingLaw::Angle,
            points: POINTS,
        };
        for load in [1.5, 4.0] {
            let strain = load * film.critical_strain;
            let state = chain.wrinkled(strain, film.wavelength);
            let (field, gap) = relaxed_wave(film, Carrier::Pasternak, [strain, 0.0]);
            assert_near("A", field.amplitude(), state.amplitude, 1e-3);
            assert_near("gap", gap, state.energy_gap, 2e-3);
        }
    }
}

/// From noise a plate finds the wave and the energy of linear theory.
#[test]
fn plate_finds_its_wave_from_noise() {
    let film = film(1000.0);
    let strain = 1.5 * film.critical_strain;
    let grid = Grid::new([96, 32], [8.0 * film.wavelength, 2.0 * film.wavelength]);
    let plate = Plate::new(grid.clone(), film, 0.3, Carrier::HalfSpace);
    let mut heights = noise(&grid, 1e-2 / film.wave_number, 3);
    let relaxed = plate.relax(&mut heights, [strain, 0.0], &RelaxSettings::new(THICKNESS));
    println!("{relaxed:?}");
    assert!(relaxed.converged);
    let field = HeightField { grid, heights };
    let k = field.mean_wave([0.5 * film.wave_number, 1.5 * film.wave_number])[0];
    assert_near("k", k, film.wave_number, 0.5 / 8.0);
    let spectrum = field.spectrum(0.2 * film.wave_number, 10);
    println!("{spectrum:?}");
    let total: f64 = spectrum.iter().sum();
    assert!(spectrum[4] + spectrum[5] > 0.95 * total, "around k_c");
    assert!(field.orientation(18).alignment() > 0.95);
    let gap = -0.5 * film.membrane_stiffness * (strain - film.critical_strain).powi(2);
    assert_near("gap", relaxed.energy_gap, gap, 0.05);
}

/// Skin a millimetre thick, `ratio` times as stiff as the block of three centimetres below.
fn skin_on_block(ratio: f64) -> (LayerMaterial, Substrate) {
    let skin = LayerMaterial {
        young: ratio * 1e4,
        poisson: 0.45,
        thickness: 1e-3,
        density: 1e3,
    };
    let block = Substrate {
        young: 1e4,
        poisson: 0.45,
        thickness: 0.03,
    };
    (skin, block)
}

/// Theory puts the block's forces on the skin's mid-surface; the volume knows that they act on its
/// lower face, and that a pressed block is no longer the block at rest.
#[test]
fn dense_volume_wrinkles_like_a_shell_on_a_bonded_layer() {
    for (ratio, tolerance) in [(30.0, 0.06), (300.0, 0.02), (3000.0, 0.02)] {
        let (skin, block) = skin_on_block(ratio);
        let theory = wrinkling(&skin, &block, WavelengthModel::Layer).unwrap();
        let dense = DenseBlock::new(skin, block);
        let onset = dense.onset([0.8, 1.25].map(|share| share * theory.wavelength));
        let strain = theory.critical_strain * (1.0 + 7.0 / 6.0 * theory.critical_strain);
        assert_near("wavelength", onset.wavelength, theory.wavelength, tolerance);
        assert_near("onset", onset.strain, strain, tolerance);
    }
}

#[test]
fn dense_volume_is_resolved() {
    let (skin, block) = skin_on_block(300.0);
    let dense = DenseBlock::new(skin, block);
    let finer = DenseBlock {
        along: 7,
        through: 2,
        down: 14,
        ..dense
    };
    let [coarse, fine] = [dense, finer].map(|block| block.onset_at(0.029));
    assert_near("resolution", coarse, fine, 0.005);
}
