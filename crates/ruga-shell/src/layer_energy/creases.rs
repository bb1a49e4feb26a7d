//! Creases of a layer and the anchors that draw them down.

use nalgebra::Vector3;
use ruga_mesh::EdgeId;

use super::LayerEnergy;
use crate::{Crease, CreaseState, LineAnchor, ShellError};

impl LayerEnergy {
    /// Puts creases on edges of the mesh, in place of any earlier ones; of a pair, in the lower sheet.
    ///
    /// A line that passes a vertex with a turn below 45 degrees folds by one angle there; where lines meet, turn
    /// more or end, every edge has its own. Rest metric, bending factor and rest angles may change later
    /// as without creases: fold angles count from the rest angles of the layer. Edges whose crease has
    /// neither compliance nor a rest angle are as any other.
    ///
    /// Forces that balance the layer on its base, so that it rests there by itself, are those of
    /// [`Self::without_creases`]: taken with creases they would balance them as well, and nothing would fold.
    ///
    /// # Errors
    /// [`ShellError::CreaseOutside`] for an edge at the border or out of the mesh,
    /// [`ShellError::CreaseTwice`], [`ShellError::ParameterOutOfRange`]; the layer is then unchanged.
    pub fn set_creases(&mut self, creases: &[(EdgeId, Crease)]) -> Result<(), ShellError> {
        self.sheets[0].set_creases(creases)
    }

    /// The layer as it is, but without creases and line anchors: its gradient at the base is what a base that
    /// carries the layer pushes back with.
    pub fn without_creases(&self) -> Self {
        let mut plain = self.clone();
        let cleared = plain.set_creases(&[]);
        let cleared = cleared.and_then(|()| plain.set_line_anchors(&[]));
        cleared.expect("no creases and no anchors are valid");
        plain
    }

    /// How the creases are folded at the positions `x` (m), in the order in which they were set; none in a
    /// [`crate::LayerPart`].
    pub fn crease_states(&self, x: &[Vector3<f64>]) -> Vec<CreaseState> {
        self.check(x);
        self.lower().crease_states(x)
    }

    /// Draws edges towards a depth below the surface that carries the layer, in place of any earlier
    /// anchors; of a pair, edges of the lower sheet. Forces that balance the layer on its base are those
    /// without them, see [`Self::without_creases`].
    ///
    /// # Errors
    /// [`ShellError::CreaseOutside`] for an edge that the mesh does not have,
    /// [`ShellError::ParameterOutOfRange`]; the layer is then unchanged.
    pub fn set_line_anchors(&mut self, anchors: &[LineAnchor]) -> Result<(), ShellError> {
        self.foundation.set_lines(anchors, &self.sheets[0])?;
        Ok(())
    }
}
