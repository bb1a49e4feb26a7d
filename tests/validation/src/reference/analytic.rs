//! A film on Pasternak springs in closed form, with its strain taken as finite.
//!
//! ```text
//! W(g, psi) = C/2 ((g^2 - 1)/2)^2 + D/2 b(g) psi^2 + K0/2 w^2 + K1/2 w_X^2     per rest length
//! ```
//!
//! `g` is the stretch of the film's middle line and `psi` the rate of its angle, both over the rest
//! length; `b(g) = 1 - s + s g^2` says how a discrete bending feels the stretch
//! ([`BendingLaw`]). The linear theory of [`ruga_material::Wrinkling`] is the limit of small
//! critical strain.

use std::f64::consts::TAU;

use ruga_material::Wrinkling;

/// How bending feels that the film under it is compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BendingLaw {
    /// The square of the angle's rate over the rest length. Also hinges on equilateral triangles
    /// that are compressed across one of their edges.
    Angle,
    /// Hinges on equilateral triangles that are compressed along one of their edges: the law of the
    /// tabulated anchors.
    ///
    /// Of the energy 8/9 sit in hinges at 60 degrees to the compression. Their edges shorten to
    /// `m = sqrt(3/4 + g^2/4)`, and with the height of the triangles their angle becomes `m psi`.
    /// The hinges along the compression, the other 1/9, bend by `g psi`.
    AlongEdges,
}

impl BendingLaw {
    /// Share `s` of the stiffness that follows the square of the stretch.
    pub fn stretch_share(self) -> f64 {
        match self {
            Self::Angle => 0.0,
            Self::AlongEdges => 1.0 / 3.0,
        }
    }

    /// Stiffness at a squared stretch, over that of the film at rest.
    pub fn factor(self, squared_stretch: f64) -> f64 {
        1.0 + self.stretch_share() * (squared_stretch - 1.0)
    }
}

/// Where the flat film becomes unstable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onset {
    /// Nominal compressive strain.
    pub strain: f64,
    /// Wavelength in the rest configuration, m.
    pub wavelength: f64,
}

/// A film on Pasternak springs under plane strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmTheory {
    /// The stiffnesses, and what linear theory says.
    pub linear: Wrinkling,
    /// How bending feels the stretch.
    pub bending: BendingLaw,
}

/// Largest strain at which a flat film is asked for its stability.
const LARGEST_STRAIN: f64 = 0.4;

impl FilmTheory {
    /// Where the flat film becomes unstable; `None` beyond a strain of 0.4.
    ///
    /// A wave of number `k` on the flat film of stretch `g = 1 - eps` is neutral at
    ///
    /// ```text
    /// C (eps - eps^2/2) = D b(g)/g^2 k^2 + K0/k^2 + K1
    /// ```
    ///
    /// Minimised over `k` this is exact. Its expansion for a half-space (`K1 = D k_c^2`) is
    /// `eps_on = eps_c (1 + 7/6 eps_c)`, `lam_on = lam_c (1 + eps_c/2)` for [`BendingLaw::Angle`],
    /// and `eps_c (1 + 17/18 eps_c)`, `lam_c (1 + eps_c/3)` for [`BendingLaw::AlongEdges`].
    pub fn onset(&self) -> Option<Onset> {
        let excess = |strain: f64| {
            let soft = self.linear.normal_stiffness * self.bending_stiffness(strain);
            self.force(strain) - 2.0 * soft.sqrt() - self.linear.gradient_stiffness
        };
        let (mut low, mut high) = (0.0, LARGEST_STRAIN);
        if excess(high) < 0.0 {
            return None;
        }
        // The difference is below the rounding of a strain after sixty halvings.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if excess(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let ratio = self.linear.normal_stiffness / self.bending_stiffness(high);
        Some(Onset {
            strain: high,
            wavelength: TAU / ratio.sqrt().sqrt(),
        })
    }

    /// Amplitude (m) at a nominal compressive strain; 0 below the onset.
    ///
    /// The film keeps the stretch `g` of its onset, and a sine takes up the rest of the length:
    /// `1 - eps = <sqrt(g^2 - w_X^2)>`, to the second order in the excess strain `d`. With
    /// `y = (k A)^2/4` this reads `y/g + 3/4 y^2 = d`. To the first order it is linear theory's
    /// `(2/k) sqrt(eps - eps_c)`.
    ///
    /// # Validity
    /// Within 1 % of the chain from 1.5 to 4 critical strains where the critical strain is below
    /// 0.02, within 3 % at 0.07.
    pub fn amplitude(&self, strain: f64) -> f64 {
        let Some(onset) = self.onset().filter(|onset| onset.strain < strain) else {
            return 0.0;
        };
        let stretch = 1.0 - onset.strain;
        let excess = strain - onset.strain;
        let y = 2.0 * excess / (1.0 / stretch + (stretch.powi(-2) + 3.0 * excess).sqrt());
        onset.wavelength / TAU * 2.0 * y.sqrt()
    }

    /// Energy per rest area (J/m^2) of the wrinkled film less that of the flat one, at most 0.
    ///
    /// The wrinkled film keeps the force of its onset. To the lowest order
    /// `-C/2 (eps - eps_c)^2`.
    ///
    /// # Validity
    /// Within 2 % of the chain up to 4 critical strains where the critical strain is below 0.02, within
    /// 10 % at 0.07.
    pub fn energy_gap(&self, strain: f64) -> f64 {
        let Some(onset) = self.onset().filter(|onset| onset.strain < strain) else {
            return 0.0;
        };
        let force = self.force(onset.strain) * (1.0 - onset.strain);
        self.flat_energy(onset.strain) + force * (strain - onset.strain) - self.flat_energy(strain)
    }

    /// Energy of the flat film per rest area, J/m^2.
    pub fn flat_energy(&self, strain: f64) -> f64 {
        0.5 * self.linear.membrane_stiffness * green(strain).powi(2)
    }

    /// Second Piola-Kirchhoff force per width of the flat film, compression positive, N/m.
    fn force(&self, strain: f64) -> f64 {
        self.linear.membrane_stiffness * green(strain)
    }

    /// Bending stiffness of the flat film against waves of its rest configuration, N m.
    fn bending_stiffness(&self, strain: f64) -> f64 {
        let squared = (1.0 - strain).powi(2);
        self.linear.bending_stiffness * self.bending.factor(squared) / squared
    }
}

/// Green strain, compression positive.
fn green(strain: f64) -> f64 {
    strain - 0.5 * strain * strain
}

/// What a finely resolved film of triangles does (48 points per wavelength, equilateral, compressed
/// along edges), for one ratio of film to half-space modulus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// Plane-strain modulus of the film over that of the half-space.
    pub modulus_ratio: f64,
    /// Wavelength at the onset over the critical one.
    pub wavelength: f64,
    /// Strain at the onset over the critical one.
    pub onset: f64,
    /// Amplitudes at [`Anchor::LOADS`] over `(2/k_c) sqrt(eps - eps_c)`, in waves of the critical
    /// length.
    pub amplitudes: [f64; 5],
    /// Strains over the critical one, and the energy gaps there over `-C/2 (eps - eps_c)^2`, where
    /// they were measured.
    pub energy_gaps: &'static [(f64, f64)],
}

impl Anchor {
    /// Strains over the critical one at which amplitudes are given.
    pub const LOADS: [f64; 5] = [1.2, 1.5, 2.0, 3.0, 4.0];

    /// The measured films.
    pub const ALL: [Self; 3] = [
        Self {
            modulus_ratio: 20.0,
            wavelength: 1.027,
            onset: 1.079,
            amplitudes: [0.753, 0.883, 0.910, 0.901, 0.875],
            energy_gaps: &[],
        },
        Self {
            modulus_ratio: 150.0,
            wavelength: 1.006,
            onset: 1.018,
            amplitudes: [0.946, 0.972, 0.978, 0.975, 0.970],
            energy_gaps: &[(3.0, 0.900), (4.0, 0.890)],
        },
        Self {
            modulus_ratio: 1000.0,
            wavelength: 1.001,
            onset: 1.005,
            amplitudes: [0.985, 0.992, 0.994, 0.994, 0.992],
            energy_gaps: &[],
        },
    ];
}
