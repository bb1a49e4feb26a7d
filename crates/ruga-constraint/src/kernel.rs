//! The Gaussian that weights a neighbourhood.

/// A radial Gaussian, cut off and lowered so that it reaches zero at the cut.
///
/// `g(r) = exp(-r²/2σ²) - exp(-c²/2)` for `r < cσ`, else 0; unnormalised. A plain cut (both papers,
/// c = 2) leaves a step of 13 % over which weights pop when a vertex enters the support; a shift
/// removes the step. A smoother end would need a wider support to pass the same wavelengths.
///
/// # Response
/// What a normalised row makes of `sin(kx)`, against the uncut Gaussian `exp(-σ²k²/2)`:
///
/// | σk | 1 | 1.5 | 2 | 2.5 | π | 4.71 |
/// |---|---|---|---|---|---|---|
/// | uncut | .607 | .325 | .135 | .044 | .007 | .000 |
/// | c = 3 | .638 | .354 | .146 | .044 | .008 | -.001 |
/// | c = 2.5 | .684 | .412 | .186 | .053 | .000 | .001 |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel {
    /// Standard deviation of the uncut Gaussian, m; positive.
    pub sigma: f64,
    /// Radius of the support in units of `sigma`; positive, usually 2 to 3.
    pub cut: f64,
}

impl Kernel {
    /// The papers' kernel for rows that act alone: σ = wavelength/π, cut at 3σ.
    ///
    /// Goes with a spacing of half a wavelength to wavelength/√3: such rows set the wavelength of
    /// the film by their spacing, at √3 to 2 times it.
    ///
    /// 3 instead of their 2 keeps the response at the critical wavelength (σk = 2) at .146, near
    /// the uncut e⁻² = .135.
    pub fn alone(wavelength: f64) -> Self {
        Self {
            sigma: wavelength / std::f64::consts::PI,
            cut: 3.0,
        }
    }

    /// The kernel for rows beside an elastic foundation: σ = spacing/2, cut at 2.5σ.
    ///
    /// Goes with a spacing of 1.5 wavelengths; between 1.3 and 2, away from 1.
    ///
    /// Wider, and the rows of a hex lattice resolve each other badly; narrower, and the rows'
    /// reactions imprint on a curved base as a ripple at the spacing.
    pub fn beside_foundation(spacing: f64) -> Self {
        Self {
            sigma: 0.5 * spacing,
            cut: 2.5,
        }
    }

    /// Radius of the support, m.
    pub fn radius(&self) -> f64 {
        self.sigma * self.cut
    }

    /// The unnormalised weight at a distance from the centre, m.
    pub fn weight(&self, distance: f64) -> f64 {
        let half_square = |t: f64| (-0.5 * t * t).exp();
        (half_square(distance / self.sigma) - half_square(self.cut)).max(0.0)
    }

    /// Mean of `x²` over a full support, m2: σ² for an uncut Gaussian.
    ///
    /// `σ² P₃/P₂` with `Pₙ(S) = Σ_{j ≥ n} Sʲ/j!`, `S = c²/2`: the incomplete gamma functions of the
    /// cut and lowered Gaussian, times `exp S`. Sums of positive terms, so right for any cut.
    pub(crate) fn second_moment(&self) -> f64 {
        let half_square = 0.5 * self.cut * self.cut;
        // Beyond, the share that is cut off is below rounding.
        if half_square > 50.0 {
            return self.sigma * self.sigma;
        }
        // Terms over the first one, Sʲ 2/j! for j from 2 and without the common factor S².
        let (mut term, mut tail, mut index) = (1.0, 0.0, 2.0);
        // Terms grow until their index passes S; before that a small one says nothing of what
        // follows.
        while term > f64::EPSILON * tail || index < half_square {
            index += 1.0;
            term *= half_square / index;
            tail += term;
        }
        self.sigma * self.sigma * tail / (1.0 + tail)
    }

    pub(crate) fn is_valid(&self) -> bool {
        let valid = |x: f64| x.is_finite() && x > 0.0;
        valid(self.sigma) && valid(self.cut) && valid(self.radius())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_moment_is_that_of_the_kernel() {
        for cut in [1e-3, 0.5, 2.0, 2.5, 3.0, 8.0, 20.0] {
            let kernel = Kernel { sigma: 0.7, cut };
            let steps = 20_000;
            let (mut mass, mut moment) = (0.0, 0.0);
            for i in 0..steps {
                let r = (f64::from(i) + 0.5) / f64::from(steps) * kernel.radius();
                mass += r * kernel.weight(r);
                moment += 0.5 * r.powi(3) * kernel.weight(r);
            }
            let error = kernel.second_moment() / (moment / mass) - 1.0;
            // The weight itself has few digits where the cut is small.
            assert!(error.abs() < 1e-6 || cut < 0.01, "{cut}: {error}");
            assert!(error.abs() < 1e-3, "{cut}: {error}");
        }
        for cut in [1e-200, 100.0, 1e200] {
            let share = Kernel { sigma: 1.0, cut }.second_moment();
            assert!((0.0..=1.0).contains(&share), "{cut}: {share}");
        }
    }
}
