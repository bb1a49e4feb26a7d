//! A soft body as the simulation has it.

use super::Body;
use super::embedding_lattice::EmbeddingLattice;
use super::handles::HeldNodes;

/// A body, its lattice, and what holds it.
#[derive(Clone, Debug)]
pub(crate) struct Interior {
    pub(crate) body: Body,
    pub(crate) embedding_lattice: EmbeddingLattice,
    pub(crate) held: HeldNodes,
}
