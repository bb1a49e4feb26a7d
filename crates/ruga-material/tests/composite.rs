//! One layer that stands for two or more: its springs, its limits, what the notes measured.

mod skins;

use ruga_material::{
    MaterialError, StackLayer, StackPair, WavelengthModel, Wrinkling, composite_layers,
};
use skins::{FACE2, LK, MIDDLE, THIN_FILM, WEAK, assert_close, joint, pair, skin, stack};

/// The composite's springs give its wave, onset and stiffness; its material the same shell.
#[test]
fn composite_is_a_layer() {
    for values in [LK, THIN_FILM, FACE2, MIDDLE, WEAK] {
        let found = pair(values);
        let composite = found.composite().expect("springs hold");
        let (wave, layer) = (composite.wrinkling, composite.material);
        let sum = |part: fn(&Wrinkling) -> f64| {
            part(&found.lower.wrinkling) + part(&found.upper.wrinkling)
        };
        assert_close(
            wave.membrane_stiffness,
            sum(|w| w.membrane_stiffness),
            1e-14,
            "S'",
        );
        assert!(wave.bending_stiffness > sum(|w| w.bending_stiffness));
        assert_close(wave.wavelength, joint(&found).wavelength, 1e-14, "λ");
        assert_close(
            wave.critical_strain,
            joint(&found).critical_strain,
            1e-14,
            "e",
        );
        assert_close(
            layer.membrane_stiffness(),
            wave.membrane_stiffness,
            1e-13,
            "S'",
        );
        assert_close(
            layer.bending_stiffness(),
            wave.bending_stiffness,
            1e-13,
            "D'",
        );
        let mass = found.lower.material.thickness + found.upper.material.thickness;
        assert_close(
            layer.density * layer.thickness,
            1100.0 * mass,
            1e-13,
            "mass",
        );
        let force = |k: f64| {
            wave.bending_stiffness * k * k
                + wave.gradient_stiffness
                + wave.normal_stiffness / (k * k)
        };
        let least = force(wave.wave_number);
        assert_close(least, wave.critical_force, 1e-12, "N'");
        for factor in [0.3, 0.9, 1.1, 3.0] {
            assert!(force(factor * wave.wave_number) > least && least > 0.0);
        }
        let bound = 2.0 * (wave.bending_stiffness * wave.normal_stiffness).sqrt();
        assert!(wave.gradient_stiffness.abs() < bound);
    }
}

/// Layers 2.4, amplitudes of the composite (mm) by `A = 2/k √(e - e_j)`, where no nonlinearity enters
/// yet: LK at 1.3 % and 1.75 %, the middle pair at 4.6 %, face2 at 4.3 %. Two-digit strains leave
/// a tenth of the smallest, `e - e_j` being .13 % there.
#[test]
fn composite_amplitudes_of_the_notes() {
    for (values, strain, printed, within) in [
        (LK, 0.013, 0.132, 0.07),
        (LK, 0.0175, 0.296, 0.02),
        (MIDDLE, 0.046, 0.342, 0.03),
        (MIDDLE, 0.084, 1.030, 0.05),
        (FACE2, 0.043, 0.226, 0.03),
        (FACE2, 0.059, 0.496, 0.03),
    ] {
        let composite = pair(values).composite().expect("springs hold");
        let amplitude = 1e3 * composite.wrinkling.amplitude(strain);
        assert_close(
            amplitude,
            printed,
            within,
            &format!("{values:?} at {strain}"),
        );
    }
}

/// The less the upper layer carries, the more the pair is the lower layer alone.
#[test]
fn a_vanishing_upper_layer_leaves_the_lower_one() {
    let lower = stack(&[skin(2.0, 1.0)], skin(0.05, 10.0).as_substrate())[0];
    let mut last = f64::INFINITY;
    for share in [1e-1, 1e-2, 1e-3, 1e-4] {
        // Of constant modulus ratio, so that it keeps its critical strain and gets finer.
        let layers = stack(
            &[skin(2.0, 1.0), skin(6.0, share * 0.3)],
            skin(0.05, 10.0).as_substrate(),
        );
        let found = StackPair::new(&layers[0], &layers[1]).expect("valid materials");
        let off = (joint(&found).wavelength / lower.wrinkling.wavelength - 1.0).abs()
            + (joint(&found).critical_strain / lower.wrinkling.critical_strain - 1.0).abs();
        assert!(
            off < 0.2 * last && off < 2.0 * found.membrane_ratio,
            "{share}: {off}"
        );
        last = off;
        let composite = found.composite().expect("springs hold").wrinkling;
        let alone = lower.wrinkling;
        for (together, alone) in [
            (composite.bending_stiffness, alone.bending_stiffness),
            (composite.membrane_stiffness, alone.membrane_stiffness),
            (composite.normal_stiffness, alone.normal_stiffness),
            (composite.gradient_stiffness, alone.gradient_stiffness),
        ] {
            assert_close(
                together,
                alone,
                20.0 * found.membrane_ratio + 1e-6,
                "composite",
            );
        }
        assert_close(found.bending_transfer, 1.0, 1.1 * found.membrane_ratio, "β");
    }
    assert!(last < 1e-4, "{last}");
}

/// A layer cut in two glued halves is the layer: laminate theory, up to the shear of the lower half,
/// which Kirchhoff's plate has not.
#[test]
fn two_halves_of_a_layer() {
    let whole = skin(4.0, 0.02);
    let half = skin(4.0, 0.01);
    let substrate = skin(0.004, 10.0).as_substrate();
    let lower = StackLayer::new(half, &substrate, WavelengthModel::Layer).expect("valid");
    // The halves' own interface is rigid: an upper half held with its own modulus has a wave of
    // about its thickness, so springs far stiffer than the substrate.
    let upper = StackLayer::new(half, &half.as_substrate(), WavelengthModel::Layer).expect("valid");
    let found = StackPair::new(&lower, &upper)
        .expect("valid")
        .composite()
        .expect("holds");
    let alone = StackLayer::new(whole, &substrate, WavelengthModel::Layer)
        .expect("valid")
        .wrinkling;
    assert_close(
        found.wrinkling.membrane_stiffness,
        alone.membrane_stiffness,
        1e-12,
        "S",
    );
    assert_close(
        found.wrinkling.bending_stiffness,
        alone.bending_stiffness,
        0.02,
        "D",
    );
    // The stack is eight times as stiff as its lower layer, whose springs are a fit at half the
    // wavelength and too stiff here: 16 % short. Known limit, see `StackPair`.
    let short = found.wrinkling.wavelength / alone.wavelength;
    assert!((short - 0.836).abs() < 0.005, "{short}");
}

#[test]
fn composites_of_one_two_and_three() {
    let substrate = skin(0.024, 8.0).as_substrate();
    let layers = [skin(0.3, 1.0), skin(14.0, 0.05), skin(40.0, 0.002)];
    assert_eq!(composite_layers(&[]), Ok(Vec::new()));

    let one = stack(&layers[..1], substrate);
    let found = composite_layers(&one).expect("one layer");
    assert_eq!(
        (found[0].material, found[0].wrinkling),
        (one[0].material, one[0].wrinkling)
    );

    let two = stack(&layers[..2], substrate);
    let found = composite_layers(&two).expect("two layers");
    let pair = StackPair::new(&two[0], &two[1]).expect("valid");
    assert_eq!(Ok(found[0]), pair.composite());
    assert_eq!(found[1].wrinkling, two[1].wrinkling);

    // A third layer that hardly carries anything changes hardly anything, and stiffens.
    let three = stack(&layers, substrate);
    let with_third = composite_layers(&three).expect("three layers");
    let share = three[2].wrinkling.membrane_stiffness / found[0].wrinkling.membrane_stiffness;
    let (before, after) = (found[0].wrinkling, with_third[0].wrinkling);
    assert!(after.bending_stiffness > before.bending_stiffness);
    assert_close(after.wavelength, before.wavelength, 2.0 * share, "λ");
    assert_close(
        after.critical_strain,
        before.critical_strain,
        2.0 * share,
        "e",
    );
    assert_close(
        after.membrane_stiffness,
        three
            .iter()
            .map(|layer| layer.wrinkling.membrane_stiffness)
            .sum(),
        1e-13,
        "S",
    );
    let pair = StackPair::new(&three[1], &three[2]).expect("valid");
    assert_eq!(Ok(with_third[1]), pair.composite());
}

/// Springs far stiffer against slopes than any foundation give a wave that no fit of value and slope
/// can hold.
#[test]
fn composite_springs_keep_to_their_bound() {
    let good = pair(WEAK);
    let mut lower = good.lower;
    let wave = &mut lower.wrinkling;
    wave.gradient_stiffness = 30.0 * wave.bending_stiffness * wave.wave_number.powi(2);
    let found = StackPair::new(&lower, &good.upper)
        .expect("finite")
        .composite();
    match found {
        Err(MaterialError::CompositeUnstable {
            gradient_stiffness,
            bound,
        }) => {
            assert!(gradient_stiffness > bound && bound > 0.0);
        }
        other => panic!("{other:?}"),
    }
}
