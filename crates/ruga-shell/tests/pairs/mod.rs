//! Two pairs of layers, and the strain at which waves appear in them in theory.
#![allow(dead_code, reason = "each test file uses its own part")]

use nalgebra::{Matrix2, Vector3};
use ruga_shell::{BendingModel, FaceParameters, LayerEnergy, LayerParameters, UpperSheet};

use crate::meshes::lattice;

pub(crate) const POISSON: f64 = 0.48;

/// What is in and under a layer: Young's modulus, thickness, `K0`, `K1`.
pub(crate) struct Shell {
    pub(crate) young: f64,
    pub(crate) thickness: f64,
    pub(crate) normal: f64,
    pub(crate) gradient: f64,
}

impl Shell {
    pub(crate) fn parameters(&self) -> FaceParameters {
        FaceParameters {
            young: self.young,
            poisson: POISSON,
            thickness: self.thickness,
            normal_stiffness: self.normal,
            gradient_stiffness: self.gradient,
        }
    }

    pub(crate) fn membrane(&self) -> f64 {
        self.parameters().tension_modulus()
    }

    pub(crate) fn bending(&self) -> f64 {
        self.parameters().bending_modulus()
    }
}

pub(crate) struct Pair {
    pub(crate) lower: Shell,
    pub(crate) upper: Shell,
    /// `Kt` (N/m³).
    pub(crate) tangential: f64,
    /// Strain and wavelength at which the exact elastic stack wrinkles as a whole.
    pub(crate) stack: (f64, f64),
}

/// Li 2014's dermis and epidermis: the upper membrane is 14 times as stiff as the lower one.
pub(crate) fn thick() -> Pair {
    let lower = Shell {
        young: 4e6,
        thickness: 1.3e-3,
        normal: 9.03e7,
        gradient: 293.0,
    };
    let upper = Shell {
        young: 6e8,
        thickness: 1.2e-4,
        normal: 4.80e9,
        gradient: 356.0,
    };
    Pair::new(lower, upper, (0.0120, 12.2e-3))
}

/// A film of 12 MPa, 0.05 mm on 2 MPa, 1 mm on a substrate of 50 kPa, 10 mm: membrane ratio 0.3.
pub(crate) fn soft() -> Pair {
    let lower = Shell {
        young: 2e6,
        thickness: 1e-3,
        normal: 7.882e6,
        gradient: 34.18,
    };
    let upper = Shell {
        young: 1.2e7,
        thickness: 5e-5,
        normal: 1.0334e10,
        gradient: 40.97,
    };
    Pair::new(lower, upper, (0.041, 16.1e-3))
}

impl Pair {
    /// The tangential stiffness is the shear of the lower layer across its thickness.
    pub(crate) fn new(lower: Shell, upper: Shell, stack: (f64, f64)) -> Self {
        let tangential = lower.young / (2.0 * (1.0 + POISSON)) / lower.thickness;
        Self {
            lower,
            upper,
            tangential,
            stack,
        }
    }

    /// The same bending, springs and sandwich with membranes `factor` times as stiff: all strains
    /// are divided by it, and finite strain drops out.
    pub(crate) fn stiffened(self, factor: f64) -> Self {
        let shell = |shell: Shell| Shell {
            young: shell.young * factor.powf(1.5),
            thickness: shell.thickness / factor.sqrt(),
            ..shell
        };
        Self {
            lower: shell(self.lower),
            upper: shell(self.upper),
            tangential: self.tangential * factor,
            stack: (self.stack.0 / factor, self.stack.1),
        }
    }

    pub(crate) fn offset(&self) -> f64 {
        0.5 * (self.lower.thickness + self.upper.thickness)
    }

    /// `e(k)`: the smallest eigenvalue of `A v = e B v`, with
    ///
    /// ```text
    /// A = [[D1 k^4 + Ks + Kn + Kq t^2 k^2,  -Kn], [-Kn,  D2 k^4 + Kn]]    B = diag(S1 k^2, S2 k^2)
    /// Ks = K0_1 + K1_1 k^2    Kn = K0_2 + K1_2 k^2    1/Kq = 1/(S1 k^2) + 1/Kt + 1/(S2 k^2)
    /// ```
    ///
    /// `facets` is a bending stiffness (N m) added to the lower shell's.
    pub(crate) fn theory(&self, wave_number: f64, facets: f64) -> f64 {
        let squared = wave_number * wave_number;
        let (lower, upper, t) = (&self.lower, &self.upper, self.offset());
        let below = lower.normal + lower.gradient * squared;
        let between = upper.normal + upper.gradient * squared;
        let loads = [lower, upper].map(|shell| shell.membrane() * squared);
        let shear = 1.0 / (1.0 / loads[0] + 1.0 / self.tangential + 1.0 / loads[1]);
        let first = (lower.bending() + facets) * squared * squared
            + below
            + between
            + shear * t * t * squared;
        let second = upper.bending() * squared * squared + between;
        let coupling = -between / (loads[0] * loads[1]).sqrt();
        Matrix2::new(first / loads[0], coupling, coupling, second / loads[1])
            .symmetric_eigenvalues()
            .min()
    }

    /// What the facets' normals add to the bending stiffness (N m), as `LayerSprings` states it.
    pub(crate) fn facets(&self, edge: f64) -> f64 {
        3.0 / 16.0 * self.tangential * self.offset().powi(2) * edge * edge
    }

    /// The pair on a lattice of edge `edge`, and its positions when unstrained.
    pub(crate) fn build(
        &self,
        columns: usize,
        rows: usize,
        edge: f64,
    ) -> (LayerEnergy, Vec<Vector3<f64>>) {
        let mesh = lattice(columns, rows, edge);
        let (faces, count) = (mesh.faces.len(), mesh.positions.len());
        let above: Vec<_> = mesh
            .positions
            .iter()
            .map(|p| p + Vector3::z() * self.offset())
            .collect();
        let uniform = |face, tangential| LayerParameters::uniform(face, faces, tangential, count);
        let upper = UpperSheet {
            rest_positions: above.clone(),
            parameters: uniform(self.upper.parameters(), self.tangential),
            offsets: vec![self.offset(); count],
        };
        let joint = LayerEnergy::pair(
            (&mesh.topology(), &mesh.positions, &vec![false; count]),
            uniform(self.lower.parameters(), 0.0),
            upper,
            BendingModel::Hinge,
        )
        .expect("a valid lattice");
        (joint, [mesh.positions, above].concat())
    }
}
