//! Typed handles and the arrays that open only with them.

use std::marker::PhantomData;
use std::ops::{Index, IndexMut};

/// A handle that counts up from zero.
pub trait Id: Copy {
    /// The handle of the `index`-th element, which must fit in 32 bits; beyond, the handle is that of
    /// another element.
    fn from_index(index: usize) -> Self;
    /// Position of this element in its array.
    fn index(self) -> usize;
}

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);

        impl Id for $name {
            #[inline]
            fn from_index(index: usize) -> Self {
                // Checked in release by the mesh, once for all of its elements.
                debug_assert!(index < u32::MAX as usize, "element count fits 32 bits");
                Self(index as u32)
            }

            #[inline]
            fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// A vertex.
    VertexId
);
id!(
    /// A triangle.
    FaceId
);
id!(
    /// An undirected edge.
    EdgeId
);

/// One `T` per element, opened with the element's id.
///
/// # Panics
/// Indexing panics when there is no element of that id.
#[derive(Clone, Debug, PartialEq)]
pub struct PerElement<I, T> {
    values: Vec<T>,
    id: PhantomData<I>,
}

/// One `T` per vertex.
pub type PerVertex<T> = PerElement<VertexId, T>;
/// One `T` per face.
pub type PerFace<T> = PerElement<FaceId, T>;
/// One `T` per edge.
pub type PerEdge<T> = PerElement<EdgeId, T>;

impl<I: Id, T> PerElement<I, T> {
    /// Number of elements.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether there is no element.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The values in order of their ids.
    pub fn as_slice(&self) -> &[T] {
        &self.values
    }

    /// The values in order of their ids.
    pub fn as_mut_slice(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// Gives the values back as a plain vector.
    pub fn into_vec(self) -> Vec<T> {
        self.values
    }

    /// Ids with their values, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (I, &T)> {
        self.values
            .iter()
            .enumerate()
            .map(|(i, value)| (I::from_index(i), value))
    }

    /// All ids, in order.
    pub fn ids(&self) -> impl ExactSizeIterator<Item = I> + use<I, T> {
        (0..self.values.len()).map(I::from_index)
    }
}

impl<I: Id, T: Clone> PerElement<I, T> {
    /// `count` copies of `value`.
    pub fn filled(count: usize, value: T) -> Self {
        vec![value; count].into()
    }
}

impl<I, T> From<Vec<T>> for PerElement<I, T> {
    fn from(values: Vec<T>) -> Self {
        Self {
            values,
            id: PhantomData,
        }
    }
}

impl<I: Id, T> FromIterator<T> for PerElement<I, T> {
    fn from_iter<It: IntoIterator<Item = T>>(values: It) -> Self {
        values.into_iter().collect::<Vec<T>>().into()
    }
}

impl<I: Id, T> Index<I> for PerElement<I, T> {
    type Output = T;

    fn index(&self, id: I) -> &T {
        &self.values[id.index()]
    }
}

impl<I: Id, T> IndexMut<I> for PerElement<I, T> {
    fn index_mut(&mut self, id: I) -> &mut T {
        &mut self.values[id.index()]
    }
}
