//! Where the stencils of a sheet add to the matrix.

use ruga_mesh::{BlockPattern, BlockSlot};

use crate::stencil::slots;

/// Slots of a sheet's stencils: of a large sheet a kilobyte for every vertex, so that they are looked up only where a
/// matrix is asked for.
#[derive(Clone, Debug)]
pub(crate) struct SheetSlots {
    /// Of every face.
    pub(crate) faces: Vec<[BlockSlot; 6]>,
    /// Of every hinge.
    pub(crate) hinges: Vec<[BlockSlot; 10]>,
    /// Of all stars, one after the other: as many as their vertices have pairs, themselves included.
    pub(crate) stars: Vec<BlockSlot>,
}

impl SheetSlots {
    /// Looks up the slots of stencils in a `pattern` that has them.
    pub(crate) fn new<'a>(
        pattern: &BlockPattern,
        faces: &[[u32; 3]],
        hinges: impl Iterator<Item = &'a [u32; 4]>,
        stars: impl Iterator<Item = &'a [u32]> + Clone,
    ) -> Self {
        let pairs = |star: &[u32]| star.len() * (star.len() + 1) / 2;
        let mut of_stars = Vec::with_capacity(stars.clone().map(pairs).sum());
        of_stars.extend(stars.flat_map(|star| pattern.stencil_slots(star)));
        Self {
            faces: faces.iter().map(|face| slots(pattern, face)).collect(),
            hinges: hinges.map(|hinge| slots(pattern, hinge)).collect(),
            stars: of_stars,
        }
    }
}
