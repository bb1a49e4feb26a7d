//! The mesh that results have.

use std::sync::Arc;

use nalgebra::Vector2;
use rayon::prelude::*;
use ruga_blend::Driver;
use ruga_mesh::{FaceOrigin, Id};

use super::{RegionMesh, SkinMesh};
use crate::ArtistPlace;
use crate::skin::facet_address::{FacetAddresses, Piece, corners_at};

/// Faces that a thread addresses at least.
const FACES_AT_ONCE: usize = 1024;

/// Triangles of an output mesh as results have them.
#[derive(Clone, Debug)]
pub(crate) struct ShownFaces {
    /// The corners of every triangle as results number them: vertices on creases once for each side.
    pub(crate) faces: Arc<[[u32; 3]]>,
    /// Texture coordinates of every triangle's corners, V down, as the artist's flat triangles show them.
    pub(crate) uvs: Arc<[[Vector2<f64>; 3]]>,
    /// The file's triangle under every triangle, and its corners' places there.
    pub(crate) artist: Arc<[ArtistPlace]>,
}

impl ShownFaces {
    /// Triangles with these corners in the mesh, and those that `results` have instead, if others.
    fn new(
        driver: &Driver,
        (corners, results): (Vec<[u32; 3]>, Option<Vec<[u32; 3]>>),
        origins: &[FaceOrigin],
        addresses: &FacetAddresses,
    ) -> Self {
        let uvs = in_place(corners.len(), |face| {
            addresses.uvs(driver, (corners[face], &origins[face]))
        });
        let artist = in_place(corners.len(), |face| {
            let origin = &origins[face];
            let places = corners_at(driver, origin, &uvs[face]);
            (driver.triangles()[origin.face], places)
        });
        Self {
            faces: results.unwrap_or(corners).into(),
            uvs,
            artist,
        }
    }
}

/// A list of what `of` gives, made where it stays: from a list of its own it would be there twice.
fn in_place<T: Clone + Default + Send>(count: usize, of: impl Fn(usize) -> T + Sync) -> Arc<[T]> {
    let mut list: Arc<[T]> = std::iter::repeat_n(T::default(), count).collect();
    let own = Arc::get_mut(&mut list).expect("nobody else has it yet");
    let places = own.par_iter_mut().enumerate().with_min_len(FACES_AT_ONCE);
    places.for_each(|(i, place)| *place = of(i));
    list
}

impl RegionMesh {
    /// The triangles as results have them, which are found when they are asked for first.
    pub(crate) fn shown(&self, driver: &Driver) -> &ShownFaces {
        self.shown.get_or_init(|| {
            let results = self.opened.as_ref().map(|opened| opened.0.clone());
            let corners = (self.skin.corner_indices(), results);
            ShownFaces::new(
                driver,
                corners,
                self.origins.as_slice(),
                &self.addresses(driver),
            )
        })
    }

    /// The triangles as results have them; the mesh is given up on the way, which takes more memory than these.
    pub(crate) fn into_shown(self, driver: &Driver) -> ShownFaces {
        if let Some(shown) = self.shown.get() {
            return shown.clone();
        }
        let addresses = self.addresses(driver);
        let Self {
            skin,
            origins,
            opened,
            features,
            lines,
            ..
        } = self;
        let corners = skin.corner_indices();
        drop((skin, features, lines));
        let results = opened.map(|opened| opened.0);
        ShownFaces::new(driver, (corners, results), origins.as_slice(), &addresses)
    }

    /// Where on the artist's flat triangles its vertices are shown.
    fn addresses(&self, driver: &Driver) -> FacetAddresses {
        let SkinMesh {
            mesh, points, rest, ..
        } = &self.skin;
        // Addresses are places of the driver, not of the layer above it.
        let places = rest.positions.par_iter().zip(&rest.normals);
        let positions: Vec<_> = places.map(|(x, n)| x - n * self.offset).collect();
        FacetAddresses::new(&Piece {
            mesh,
            points: points.points(),
            positions: &positions,
            normals: &rest.normals,
            origins: &self.origins,
            driver,
        })
    }

    /// Values at the vertices of results for those at the vertices of this mesh.
    pub(crate) fn on_both_sides<T: Copy>(&self, values: Vec<T>) -> Vec<T> {
        match &self.opened {
            Some((_, opened)) => opened.iter().map(|v| values[v.index()]).collect(),
            None => values,
        }
    }
}
