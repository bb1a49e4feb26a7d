//! Vertices that share a normal.

use nalgebra::Vector3;
use ruga_mesh::Id;

use crate::{ArtistMesh, Driver};

/// Rest normals closer than this are one that was rounded.
const SAME_NORMAL: f64 = 1e-2;

/// Vertices of the file that have one normal, however a pose moves them: those at one place whose rest
/// normals are the same, or all at one place where the file has none.
///
/// A mean over the triangles around a group is smooth across the seams of a texture and keeps hard edges.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SmoothGroups {
    /// Number of the group of every vertex of the file, from 0.
    pub of_vertex: Vec<u32>,
    /// How many groups there are.
    pub count: usize,
}

impl SmoothGroups {
    /// The groups of a mesh; `driver` is made of it and says which vertices are at one place in every pose.
    pub fn new(artist: &ArtistMesh, driver: &Driver) -> Self {
        let mut at_place: Vec<Vec<(Vector3<f64>, u32)>> = vec![Vec::new(); driver.rest().len()];
        let mut count = 0;
        let mut of_vertex = Vec::with_capacity(driver.welded().len());
        for (vertex, welded) in driver.welded().iter().enumerate() {
            let normals = artist.normals.as_ref();
            let normal = normals.map_or_else(Vector3::zeros, |normals| normals[vertex]);
            let known = &mut at_place[welded.index()];
            let same = |(other, _): &&(Vector3<f64>, u32)| (other - normal).norm() < SAME_NORMAL;
            let group = match known.iter().find(same) {
                Some((_, group)) => *group,
                None => {
                    known.push((normal, count));
                    count += 1;
                    count - 1
                }
            };
            of_vertex.push(group);
        }
        Self {
            of_vertex,
            count: count as usize,
        }
    }
}
