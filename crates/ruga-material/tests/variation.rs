//! The unevenness of skin has the spread and the feature size that were asked for.

use nalgebra::Vector3;
use ruga_material::{MaterialError, PRESETS, Variation, VariationField};

const WAVELENGTH: f64 = 0.01;

fn field(spread: f64, scale: f64, seed: u64) -> VariationField {
    VariationField::new(Variation { spread, scale }, WAVELENGTH, seed).expect("a valid variation")
}

/// Places on a flat patch forty features wide, four places per feature.
fn patch(size: f64) -> impl Iterator<Item = Vector3<f64>> {
    let step = size / 4.0;
    (0..160 * 160).map(move |i| {
        Vector3::new(
            f64::from(i % 160) * step,
            f64::from(i / 160) * step,
            0.3 * WAVELENGTH,
        )
    })
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn spread_median_and_bounds_are_as_asked() {
    for (spread, scale, seed) in [(0.05, 1.0, 1), (0.2, 1.0, 2), (0.2, 3.0, 3), (0.5, 0.5, 4)] {
        let at = format!("spread {spread}, scale {scale}");
        let field = field(spread, scale, seed);
        let factors: Vec<f64> = patch(scale * WAVELENGTH)
            .map(|point| field.thickness_factor(&point))
            .collect();
        let average = mean(factors.iter().copied());
        let found = mean(factors.iter().map(|f| (f / average - 1.0).powi(2))).sqrt();
        assert!((found / spread - 1.0).abs() < 0.06, "{at}: {found}");
        // Even halves, and a mean above the median, as of any log-normal quantity.
        assert!(
            (median(factors.clone()) - 1.0).abs() < 0.15 * spread,
            "{at}"
        );
        let log_normal = (1.0 + spread * spread).sqrt();
        assert!(
            (average / log_normal - 1.0).abs() < 0.1 * spread,
            "{at}: {average}"
        );

        let [low, high] = field.bounds();
        assert!((low * high - 1.0).abs() < 1e-12);
        assert!(
            factors.iter().all(|factor| (low..=high).contains(factor)),
            "{at}"
        );
        // The bounds are of use: some place comes near them.
        let extreme = factors.iter().fold(1.0_f64, |a, f| a.max(f.max(1.0 / f)));
        assert!(extreme.ln() > 0.8 * high.ln(), "{at}: {extreme} of {high}");
    }
    let [low, high] = field(0.2, 1.0, 0).bounds();
    assert!((low - 0.61).abs() < 0.005 && (high - 1.64).abs() < 0.005);
}

/// Correlation of the logarithm at distance `r`, over many fields and in one direction.
fn correlation(scale: f64, r: f64, direction: Vector3<f64>) -> f64 {
    let size = scale * WAVELENGTH;
    let mut sums = [0.0; 2];
    for seed in 0..100 {
        let field = field(0.2, scale, seed);
        let at = |point: &Vector3<f64>| field.thickness_factor(point).ln();
        // Far apart, so that each place counts.
        for place in 0..35 {
            let point = 3.0 * size * Vector3::new(f64::from(place % 7), f64::from(place / 7), 0.1);
            let (here, there) = (at(&point), at(&(point + r * size * direction)));
            sums[0] += here * there;
            sums[1] += 0.5 * (here * here + there * there);
        }
    }
    sums[0] / sums[1]
}

#[test]
fn features_have_the_size_asked_for_in_all_directions() {
    let directions = [
        Vector3::x(),
        Vector3::z(),
        Vector3::new(0.6, -0.8, 0.0),
        Vector3::new(1.0, 1.0, 1.0).normalize(),
    ];
    // Correlation of both octaves; clipping changes it by less than the tolerance.
    let expected = |r: f64| {
        let octave = |r: f64| (-(2.0 * r).powi(2)).exp2();
        0.8 * octave(r) + 0.2 * octave(3.0 * r)
    };
    for (scale, direction) in [1.0, 0.4, 2.5, 1.0].into_iter().zip(directions) {
        for r in [0.1, 1.0 / 6.0, 0.3, 0.5, 1.0, 2.0] {
            let (found, expected) = (correlation(scale, r, direction), expected(r));
            assert!(
                (found - expected).abs() < 0.04,
                "{r} features apart along {direction:?}: {found}, not {expected}"
            );
        }
    }
}

#[test]
fn seeds_and_sides_differ_and_fields_repeat() {
    let [first, again, other] = [7, 7, 8].map(|seed| field(0.2, 1.0, seed));
    assert_eq!(first, again);
    let log = |field: &VariationField, point: &Vector3<f64>| field.thickness_factor(point).ln();
    let mut products = [0.0; 3];
    for point in patch(WAVELENGTH).map(|p| p + Vector3::new(0.001, 0.0, 0.0)) {
        let here = log(&first, &point);
        let mirrored = Vector3::new(-point.x, point.y, point.z);
        assert_eq!(here, log(&again, &point));
        products[0] += here * here;
        products[1] += here * log(&other, &point);
        products[2] += here * log(&first, &mirrored);
    }
    for product in &products[1..] {
        assert!(product.abs() < 0.1 * products[0], "{products:?}");
    }
}

/// The field is as smooth as its finest features: no step, no crease.
#[test]
fn neighbouring_places_hardly_differ() {
    let field = field(0.2, 1.0, 11);
    let step = Vector3::new(0.01 * WAVELENGTH, 0.0, 0.0);
    for point in patch(0.37 * WAVELENGTH).step_by(5) {
        let [left, here, right] =
            [point - step, point, point + step].map(|p| field.thickness_factor(&p));
        assert!((right - left).abs() < 0.1, "{point}");
        assert!((right - 2.0 * here + left).abs() < 0.01, "{point}");
    }
}

#[test]
fn an_even_layer_stays_even() {
    let field = field(0.0, 1.0, 5);
    for point in patch(WAVELENGTH).step_by(97) {
        assert_eq!(field.thickness_factor(&point), 1.0);
    }
}

#[test]
fn nonsense_is_refused_and_never_comes_out() {
    let with =
        |spread, scale, wavelength| VariationField::new(Variation { spread, scale }, wavelength, 1);
    for spread in [-0.1, 0.51, f64::NAN, f64::INFINITY, -f64::INFINITY] {
        let error = with(spread, 1.0, WAVELENGTH).unwrap_err();
        assert!(matches!(error, MaterialError::SpreadOutOfRange { .. }));
        assert!(error.to_string().contains("between 0 and 0.5"), "{error}");
    }
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for (scale, wavelength) in [(bad, WAVELENGTH), (1.0, bad)] {
            let error = with(0.2, scale, wavelength).unwrap_err();
            assert!(
                matches!(error, MaterialError::NotPositive { .. }),
                "{error}"
            );
        }
    }
    for (scale, wavelength) in [(1e-200, 1e-200), (1e200, 1e200), (1.0, 1e-308)] {
        let error = with(0.2, scale, wavelength).unwrap_err();
        assert!(matches!(error, MaterialError::Overflow { .. }), "{error}");
    }
    let field = field(0.2, 1.0, 5);
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
        assert_eq!(field.thickness_factor(&Vector3::new(0.0, bad, 0.0)), 1.0);
    }
    let far = field.thickness_factor(&Vector3::repeat(1e307));
    assert!(far.is_finite() && far > 0.0);
}

#[test]
fn presets_are_uneven_where_they_are_skin_and_even_where_they_are_references() {
    for preset in &PRESETS {
        let spread = match preset.name {
            "forehead-furrow" => 0.35,
            _ => 0.2,
        };
        let expected =
            (!preset.name.starts_with("reference-")).then_some(Variation { spread, scale: 1.0 });
        assert_eq!(preset.variation, expected, "{}", preset.name);
    }
}
