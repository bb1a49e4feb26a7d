//! Stencils: their points and their blocks of the Hessian.

use nalgebra::{Matrix3, Vector3};
use ruga_mesh::{BlockPattern, BlockSlot, FaceId};

/// Stands for a face of the whole layer in stencils of a part, which have their stiffness from the
/// whole: whoever computes one from this face fails at once.
const NO_FACE: FaceId = FaceId(u32::MAX);

/// A corner of a face, in half the memory of a pair: stencils keep several, and there are many of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FaceCorner {
    face: FaceId,
    corner: u8,
}

impl FaceCorner {
    pub(crate) fn new((face, corner): (FaceId, usize)) -> Self {
        let corner = corner as u8;
        Self { face, corner }
    }

    pub(crate) fn pair(self) -> (FaceId, usize) {
        (self.face, usize::from(self.corner))
    }

    /// The same corner of [`NO_FACE`].
    pub(crate) fn of_no_face(self) -> Self {
        Self {
            face: NO_FACE,
            ..self
        }
    }
}

/// Points of a stencil, in the order of its vertices.
#[inline]
pub(crate) fn gather<const N: usize>(x: &[Vector3<f64>], vertices: &[u32; N]) -> [Vector3<f64>; N] {
    vertices.map(|v| x[v as usize])
}

/// Slots of the lower blocks of a stencil of `N` vertices, row by row.
pub(crate) fn slots<const N: usize, const M: usize>(
    pattern: &BlockPattern,
    vertices: &[u32; N],
) -> [BlockSlot; M] {
    let mut slots = pattern.stencil_slots(vertices);
    std::array::from_fn(|_| slots.next().expect("M is N (N + 1)/2"))
}

/// Adds a stencil's lower blocks to a Hessian.
#[inline]
pub(crate) fn add_blocks<const M: usize>(
    values: &mut [f64],
    slots: &[BlockSlot; M],
    blocks: &[Matrix3<f64>; M],
) {
    for (slot, block) in slots.iter().zip(blocks) {
        slot.add(values, block);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_takes_half_the_memory_of_a_pair() {
        assert_eq!(2 * size_of::<FaceCorner>(), size_of::<(FaceId, usize)>());
        let corner = FaceCorner::new((FaceId(7), 2));
        assert_eq!(corner.pair(), (FaceId(7), 2));
        assert_eq!(corner.of_no_face().pair(), (NO_FACE, 2));
    }
}
