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

    pub(crate) fn is_valid(&self) -> bool {
        let valid = |x: f64| x.is_finite() && x > 0.0;
        valid(self.sigma) && valid(self.cut) && valid(self.radius())
    }
}
