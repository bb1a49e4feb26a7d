//! How a crease is folded.

/// Fold angle and energy of the crease on one edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CreaseState {
    /// Internal fold angle `phi` (rad), positive in a valley, the mean of the stars at both ends. The
    /// dihedral angle of the edge tends to it only with the first power of the edge's length.
    pub angle: f64,
    /// Energy of the crease alone (J), a part of the bending energy.
    pub energy: f64,
}
