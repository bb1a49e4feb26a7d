//! Roots and minima of functions of one number.

/// Steps after which a bracket has shrunk to rounding even by bisection alone.
const MOST_STEPS: usize = 200;

/// A root of `f` between `a` and `b`, where it has different signs; by Chandrupatla 1997, which needs
/// no derivative and is never slower than bisection by much.
pub(crate) fn root(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let (mut fa, mut fb) = (f(a), f(b));
    let mut t = 0.5;
    for _ in 0..MOST_STEPS {
        let x = a + t * (b - a);
        let fx = f(x);
        let (c, fc) = if (fx > 0.0) == (fa > 0.0) {
            (a, fa)
        } else {
            let dropped = (b, fb);
            (b, fb) = (a, fa);
            dropped
        };
        (a, fa) = (x, fx);
        let (best, f_best) = if fa.abs() < fb.abs() {
            (a, fa)
        } else {
            (b, fb)
        };
        let least_share = 2.0 * f64::EPSILON * best.abs() / (b - a).abs();
        if f_best == 0.0 || least_share.is_nan() || least_share > 0.5 {
            return best;
        }
        t = share(a, b, c, [fa, fb, fc]).clamp(least_share, 1.0 - least_share);
    }
    0.5 * (a + b)
}

/// Share of the bracket at which the inverse parabola through three points has its root; a half where
/// it cannot be trusted.
fn share(a: f64, b: f64, c: f64, [fa, fb, fc]: [f64; 3]) -> f64 {
    let xi = (a - b) / (c - b);
    let phi = (fa - fb) / (fc - fb);
    if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
        fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
    } else {
        0.5
    }
}

/// Where `f`, which falls and then rises, is least between `a` and `b`; by golden section, to half the
/// digits of a number, more than which the values cannot tell.
pub(crate) fn minimum(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut c, mut d) = (b - golden * (b - a), a + golden * (b - a));
    let (mut fc, mut fd) = (f(c), f(d));
    for _ in 0..MOST_STEPS {
        if (b - a).abs() <= 1e-8 * (a.abs() + b.abs()) {
            break;
        }
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = b - golden * (b - a);
            fc = f(c);
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + golden * (b - a);
            fd = f(d);
        }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::{minimum, root};

    #[test]
    fn roots_are_found_to_rounding() {
        let found = root(|x| x.exp() - 3.0, 0.0, 10.0);
        assert!((found - 3.0_f64.ln()).abs() < 1e-14);
        // A root that is flat to third order.
        assert!(root(|x| (x - 0.3).powi(3), -1.0, 2.0) - 0.3 < 1e-5);
        assert_eq!(root(|x| x, 0.0, 1.0), 0.0);
    }

    #[test]
    fn minima_are_found_to_half_the_digits() {
        let found = minimum(|x| (x - 0.7).powi(2) * (2.0 + x), 0.0, 5.0);
        assert!((found - 0.7).abs() < 1e-7);
    }
}
