//! Springs that draw a line of a layer towards a depth.

use ruga_mesh::EdgeId;

use crate::ShellError;

/// Springs that draw an edge of a layer down to a depth below the surface that carries it.
///
/// ```text
/// E = k_a/2 int (w + d)^2 ds                w: normal deviation from the surface below plus offset (m)
///   = k_a l/6 (u_0^2 + u_0 u_1 + u_1^2)     u = w + d, linear along the edge of rest length l
/// ```
/// With `a = k_a/(K0 l_b)`, `l_b = (D/K0)^(1/4)`: at `a = 20` a line at rest sinks to 0.91 of `d`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineAnchor {
    /// The edge, inner or at a border.
    pub edge: EdgeId,
    /// `k_a`: force per length of line and per depth (N/m² = Pa), ≥ 0.
    pub stiffness: f64,
    /// `d` at the two vertices of the edge, in its own order (m); negative to raise the line.
    pub depths: [f64; 2],
}

/// Energy (J) of springs along an edge, of a stiffness `k_a l` (N/m) in all, whose ends lie `excess` (m) over where
/// they are drawn to.
pub fn line_spring_energy(stiffness: f64, [u, v]: [f64; 2]) -> f64 {
    stiffness / 6.0 * (u * u + u * v + v * v)
}

/// The derivatives of [`line_spring_energy`] by the two excesses: what the springs pull the ends down with (N).
pub fn line_spring_pulls(stiffness: f64, [u, v]: [f64; 2]) -> [f64; 2] {
    [2.0 * u + v, u + 2.0 * v].map(|sum| stiffness / 6.0 * sum)
}

impl LineAnchor {
    pub(crate) fn check(&self) -> Result<(), ShellError> {
        let Self {
            stiffness, depths, ..
        } = *self;
        let [first, second] = depths;
        let is_stiffness = stiffness >= 0.0 && stiffness.is_finite();
        let checks = [
            ("line anchor stiffness", stiffness, is_stiffness, ">= 0"),
            ("line anchor depth", first, first.is_finite(), "finite"),
            ("line anchor depth", second, second.is_finite(), "finite"),
        ];
        match checks.into_iter().find(|(_, _, valid, _)| !valid) {
            None => Ok(()),
            Some((name, value, _, range)) => Err(ShellError::ParameterOutOfRange {
                element: "edge",
                index: ruga_mesh::Id::index(self.edge),
                name,
                value,
                range,
            }),
        }
    }
}
