//! A film that grows on a base that keeps its size, beside one that is compressed by as much.

use ruga_stepper::Modelling;
use ruga_validation::{Cause, FlatFilm};

/// Compressions, in critical strains.
const LOADS: [f64; 3] = [1.2, 2.0, 4.0];

/// Onsets are found to 0.2 %, each of the two.
const RESOLUTION: f64 = 0.004;

/// Both differ by strains: a compressed base bends its film more sharply, a grown one leaves it the lengths in which
/// the base resists. Of the film 1000 times as stiff as its base that is half a per cent.
#[test]
fn growth_wrinkles_as_compression_by_the_same_strain() {
    let modelling = Modelling::standard();
    for ratio in [150.0, 1000.0] {
        let measured = [Cause::Shape, Cause::Growth].map(|cause| {
            let film = FlatFilm {
                waves: [6.0, 6.0],
                cause,
                ..FlatFilm::new(ratio)
            };
            let onset = film.onset(&modelling).expect("a film");
            let onset = onset.expect("a film that buckles");
            (film.states(&modelling, &LOADS).1, onset)
        });
        let critical = FlatFilm::new(ratio).theory().critical_strain;
        let [(by_shape, onset), (by_growth, own_onset)] = measured;
        println!("ratio {ratio}: onset {onset:.4} by a shape, {own_onset:.4} by growth");
        assert!((own_onset / onset - 1.0).abs() < RESOLUTION + critical);
        for ((load, shape), growth) in LOADS.iter().zip(by_shape).zip(by_growth) {
            let wavelength = growth.relative_wavelength / shape.relative_wavelength - 1.0;
            let amplitude = growth.amplitude / shape.amplitude - 1.0;
            println!("load {load}: wavelength {wavelength:+.4}, amplitude {amplitude:+.4}");
            assert!(wavelength.abs() < 1e-3 + 0.9 * critical * load.max(1.0).sqrt());
            // Just above the onset the amplitude follows the difference of the onsets.
            let of_onset = 0.5 * (own_onset / onset - 1.0).abs() * onset / (load - onset);
            assert!(amplitude.abs() < of_onset + 5e-3 + 0.5 * critical);
        }
    }
}
