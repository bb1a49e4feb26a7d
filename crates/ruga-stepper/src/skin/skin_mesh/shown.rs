//! The mesh that results have.

use std::borrow::Cow;
use std::sync::Arc;

use nalgebra::Vector2;
use ruga_mesh::{Id, VertexId};

use super::{RegionMesh, SkinMesh};
use crate::ArtistPlace;

/// An output mesh as results have it.
pub(crate) struct ShownMesh<'r> {
    pub(crate) skin: Cow<'r, SkinMesh>,
    /// The corners of every triangle as results number them: vertices on creases once for each side.
    pub(crate) faces: Arc<[[u32; 3]]>,
    /// Texture coordinates of every triangle's corners, V down, as the artist's flat triangles show them.
    pub(crate) uvs: Arc<[[Vector2<f64>; 3]]>,
    /// The file's triangle under every triangle, and its corners' places there.
    pub(crate) artist: Arc<[ArtistPlace]>,
    /// For every vertex of results the vertex of this mesh; `None` without creases.
    opened: Option<Cow<'r, [VertexId]>>,
}

impl RegionMesh {
    /// The mesh as results have it.
    pub(crate) fn shown(&self) -> ShownMesh<'_> {
        ShownMesh {
            skin: Cow::Borrowed(&self.skin),
            faces: Arc::clone(&self.shown_faces),
            uvs: Arc::clone(&self.shown_uvs),
            artist: Arc::clone(&self.artist),
            opened: self.opened.as_deref().map(Cow::Borrowed),
        }
    }

    /// The mesh as results have it, without what other meshes are fitted to it by, a fifth of its memory.
    pub(crate) fn into_shown(self) -> ShownMesh<'static> {
        ShownMesh {
            skin: Cow::Owned(self.skin),
            faces: self.shown_faces,
            uvs: self.shown_uvs,
            artist: self.artist,
            opened: self.opened.map(Cow::Owned),
        }
    }
}

impl ShownMesh<'_> {
    /// Values at the vertices of results for those at the vertices of this mesh.
    pub(crate) fn on_both_sides<T: Copy>(&self, values: Vec<T>) -> Vec<T> {
        match &self.opened {
            Some(opened) => opened.iter().map(|v| values[v.index()]).collect(),
            None => values,
        }
    }
}
