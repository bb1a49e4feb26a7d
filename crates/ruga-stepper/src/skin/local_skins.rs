//! Material and wrinkling at many places, kept once where they are the same.

use crate::skin::local_skin::LocalSkin;

/// Material and wrinkling of a layer at numbered places: the vertices or the faces of a mesh.
///
/// Most layers are even, and a list of what they are everywhere would be a fifteenth of the memory that they take while
/// they are solved.
#[derive(Clone, Debug)]
pub(crate) enum LocalSkins {
    /// The same at all `count` places.
    Even { local: LocalSkin, count: usize },
    /// Something else at every place.
    Uneven(Vec<LocalSkin>),
}

impl LocalSkins {
    /// Material and wrinkling at one place.
    pub(crate) fn at(&self, place: usize) -> &LocalSkin {
        match self {
            Self::Even { local, count } => {
                debug_assert!(place < *count, "place {place} of {count}");
                local
            }
            Self::Uneven(locals) => &locals[place],
        }
    }

    /// Material and wrinkling at all places, ascending.
    pub(crate) fn all(&self) -> impl ExactSizeIterator<Item = &LocalSkin> + Clone {
        let count = match self {
            Self::Even { count, .. } => *count,
            Self::Uneven(locals) => locals.len(),
        };
        (0..count).map(|place| self.at(place))
    }
}
