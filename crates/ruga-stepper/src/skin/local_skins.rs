//! What a layer is made of at all places of a mesh.

use crate::skin::local_skin::LocalSkin;

/// The layer at places with numbers.
#[derive(Clone, Debug)]
pub(crate) enum LocalSkins {
    /// The same at so many places. A list of it took a fifteenth of a layer's memory.
    Even(LocalSkin, usize),
    Uneven(Vec<LocalSkin>),
}

impl LocalSkins {
    /// The layer at one of them.
    pub(crate) fn at(&self, place: usize) -> &LocalSkin {
        match self {
            Self::Even(local, _) => local,
            Self::Uneven(locals) => &locals[place],
        }
    }

    /// The layer at all of them, in their order.
    pub(crate) fn all(&self) -> impl ExactSizeIterator<Item = &LocalSkin> + Clone {
        let count = match self {
            Self::Even(_, count) => *count,
            Self::Uneven(locals) => locals.len(),
        };
        (0..count).map(|place| self.at(place))
    }
}
