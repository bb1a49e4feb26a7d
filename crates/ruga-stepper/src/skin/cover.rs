//! Which place of one layer every vertex of another lies on.

use std::borrow::Cow;
use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::{Matrix2, Vector2, Vector3};
use rayon::prelude::*;
use ruga_blend::Driver;
use ruga_mesh::{
    Id, LimitPoints, LoopSurface, MaterialPoint, PerVertex, SparseRows, SurfaceLookup,
    TangentPlane, TriMesh, limit_rows,
};

use crate::skin::fading::faded_from;
use crate::skin::folds_below::{FoldBelow, folds_below};
use crate::skin::identity::Mark;
use crate::skin::interpolation::{places_of_limit, through_vertices};
use crate::skin::material_places::is_on_border;
use crate::skin::mirror::Images;
use crate::skin::parts::in_parts;
use crate::skin::skin_mesh::SkinMesh;

/// A place counts as beside the layer below when it lies this fraction of an edge outside.
const BESIDE: f64 = 1e-3;

/// Places that a thread looks for at least.
const PLACES_AT_ONCE: usize = 256;

/// Projection of a layer onto the one below it: takes values of the lower to the upper one.
#[derive(Debug)]
pub(crate) struct Cover {
    /// The vertices above that lie on it.
    vertices: Vec<u32>,
    /// Weight of each of these vertices, rising from 0 beside the layer below to 1.
    weights: Vec<f64>,
    /// Limit surface of the lower layer at these vertices.
    limit: LimitPoints,
    /// Limit surface of the lower layer at its own vertices.
    at_vertices: SparseRows,
    /// What of the lower layer is whose mirror image, of one half of a symmetric pose.
    images: Option<Images>,
    /// Per covered vertex the fold of the lower layer that it lies close to; empty where that has no creases.
    folds: Vec<Option<FoldBelow>>,
    /// Per covered vertex the upper mesh's tangents at rest, as columns, in the lower one's.
    tangents: Vec<Matrix2<f64>>,
}

impl Cover {
    fn new(driver: &Driver, skin: &SkinMesh, lower: &SkinMesh, rim: f64) -> Self {
        let mirrored = lower.mirrored();
        let (mesh, rest) = match &mirrored {
            None => (&lower.mesh, &lower.rest.positions),
            Some(whole) => (&whole.mesh, &whole.positions),
        };
        let places = places_above(skin, (mesh, rest));
        let beside: Vec<bool> = places.iter().map(Option::is_none).collect();
        let weights = faded_from(&skin.mesh, &skin.rest.positions, &beside, rim);
        let (vertices, inside): (Vec<u32>, Vec<MaterialPoint>) = (0..)
            .zip(places)
            .filter_map(|(vertex, place)| Some((vertex, place?)))
            .unzip();
        let corners = PerVertex::filled(mesh.vertex_count(), false);
        let at_vertices = limit_rows(mesh, &corners).position;
        let inside = match lower.creases.is_empty() {
            true => {
                let above = &skin.rest.positions;
                let above = match vertices.len() == above.len() {
                    true => Cow::Borrowed(above),
                    false => Cow::Owned(vertices.iter().map(|&v| above[v as usize]).collect()),
                };
                let free = vec![false; above.len()];
                let on = (mesh, rest.as_slice(), &at_vertices);
                places_of_limit(on, inside, (&above, &free), &mut || true)
                    .expect("nothing ends it early")
            }
            // They say on which side of a fold a vertex lies.
            false => inside,
        };
        let folds = folds_below(lower, &inside, rim);
        let surface = LoopSurface::new(mesh, &corners);
        let limit = LimitPoints::new(surface, inside, &mut || true).expect("nothing ends it early");
        let of_part = |around: Range<usize>| -> Vec<Matrix2<f64>> {
            let ranks = ranks_in(&vertices, &around);
            let along = skin.points.some_derivatives(around.clone(), driver.rest());
            let planes = limit.some_planes(ranks.clone(), rest);
            let places = vertices[ranks].iter().zip(&planes);
            let columns = places.map(|(&vertex, plane)| {
                let along = along[vertex as usize - around.start];
                Matrix2::from_columns(&along.map(|tangent| coordinates(&tangent, &plane.first)))
            });
            columns.collect()
        };
        let mut tangents = Vec::with_capacity(vertices.len());
        let count = skin.mesh.vertex_count();
        in_parts(count, of_part, |part| tangents.extend(part));
        Self {
            tangents,
            folds,
            at_vertices,
            images: mirrored.map(|whole| whole.images),
            limit,
            weights: vertices.iter().map(|&v| weights[v as usize]).collect(),
            vertices,
        }
    }

    /// The vertices above that lie on the layer below, ascending.
    pub(crate) fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Per covered vertex 0 to 1: 1 where every vertex within the rim is covered too, 0 beside those
    /// that are not.
    pub(crate) fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Whether there may be a fold close to a covered vertex: only where the layer below has creases.
    pub(crate) fn has_folds(&self) -> bool {
        !self.folds.is_empty()
    }

    /// The fold of the layer below that is closer to the `i`-th covered vertex than the rim is wide.
    pub(crate) fn fold(&self, i: usize) -> Option<&FoldBelow> {
        self.folds.get(i)?.as_ref()
    }

    /// Ranks, among the covered vertices, of those that are some `vertices` of the mesh above.
    pub(crate) fn ranks(&self, vertices: &Range<usize>) -> Range<usize> {
        ranks_in(&self.vertices, vertices)
    }

    /// Control points that interpolate vectors at the lower layer's vertices, for [`Self::interpolate`].
    pub(crate) fn control(&self, values: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        // The limit surface alone loses some per cent of a wave, which would be missing in the map.
        match &self.images {
            None => through_vertices(&self.at_vertices, values),
            Some(images) => through_vertices(&self.at_vertices, &images.vectors(values)),
        }
    }

    /// Interpolates vectors, given by their `control` points, to the covered vertices with these `ranks` among them;
    /// [`Self::along`] turns the derivatives.
    pub(crate) fn interpolate(
        &self,
        control: &[Vector3<f64>],
        ranks: Range<usize>,
    ) -> Vec<TangentPlane> {
        self.limit.some_planes(ranks, control)
    }

    /// Derivatives along the upper mesh's own tangents of what is interpolated at the `i`-th covered vertex.
    pub(crate) fn along(&self, i: usize, interpolated: &TangentPlane) -> [Vector3<f64>; 2] {
        let ([u, v], tangents) = (interpolated.first, &self.tangents[i]);
        [0, 1].map(|k| u * tangents[(0, k)] + v * tangents[(1, k)])
    }
}

/// The covers between meshes that still exist: finding one takes longer than a step of the solver,
/// and meshes last for many.
#[derive(Debug, Default)]
pub(crate) struct Covers {
    known: RefCell<Vec<([Mark; 2], Arc<Cover>)>>,
}

impl Covers {
    /// The cover of `lower` by `skin`, with a rim of that width, m, the same for every call with these
    /// meshes.
    pub(crate) fn of(
        &self,
        driver: &Driver,
        skin: &SkinMesh,
        lower: &SkinMesh,
        rim: f64,
    ) -> Arc<Cover> {
        let mut known = self.known.borrow_mut();
        // Meshes are fitted anew from key to key, and their covers would pile up.
        known.retain(|(pair, _)| !pair.iter().any(Mark::is_stale));
        let found = known.iter().find(|([above, below], _)| {
            above.is_of(&skin.identity) && below.is_of(&lower.identity)
        });
        if let Some((_, cover)) = found {
            return Arc::clone(cover);
        }
        let cover = Arc::new(Cover::new(driver, skin, lower, rim));
        let pair = [skin, lower].map(|mesh| mesh.identity.mark());
        known.push((pair, Arc::clone(&cover)));
        cover
    }

    /// Forgets what is known of where `skin` lies on other layers, where it is not expected to be asked for again.
    pub(crate) fn forget(&self, skin: &SkinMesh) {
        let mut known = self.known.borrow_mut();
        known.retain(|([above, _], _)| !above.is_of(&skin.identity));
    }
}

/// Where, in an ascending list of `covered` vertices, those with such numbers are.
fn ranks_in(covered: &[u32], vertices: &Range<usize>) -> Range<usize> {
    let before = |v: usize| covered.partition_point(|&covered| (covered as usize) < v);
    before(vertices.start)..before(vertices.end)
}

/// Coordinates of a tangent in a basis of the tangent plane, by least squares.
fn coordinates(tangent: &Vector3<f64>, [u, v]: &[Vector3<f64>; 2]) -> Vector2<f64> {
    let gram = Matrix2::new(u.dot(u), u.dot(v), u.dot(v), v.dot(v));
    let right = Vector2::new(u.dot(tangent), v.dot(tangent));
    gram.try_inverse()
        .map_or_else(Vector2::zeros, |g| g * right)
}

/// The place of the layer below under every vertex, where there is one.
fn places_above(
    skin: &SkinMesh,
    (mesh, rest): (&TriMesh, &[Vector3<f64>]),
) -> Vec<Option<MaterialPoint>> {
    let lookup = SurfaceLookup::new(mesh, rest);
    let border = mesh.border_vertices();
    let positions = skin.rest.positions.par_iter();
    let vertices = positions
        .zip(&skin.rest.normals)
        .with_min_len(PLACES_AT_ONCE);
    vertices
        .map(|(x, normal)| {
            let point = lookup.closest(x)?.point;
            let away = x - point.interpolate(mesh, rest);
            let sideways = away - normal * normal.dot(&away);
            let [a, b, _] = mesh.faces()[point.face].map(|v| v.index());
            let edge = rest[b] - rest[a];
            // Over the layer below the way to the closest place goes along the normal. Beside it
            // the closest place lies on its border, with a way sideways.
            let is_beside = sideways.norm() > BESIDE * edge.norm();
            (!is_beside || !is_on_border(mesh, &border, &point)).then_some(point)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_drivers::{SIDE, skin, square};

    const OFFSET: f64 = 7e-4;

    /// Also over its vertices and edges, where what is closest lies on the border of a facet.
    #[test]
    fn a_layer_covers_all_of_a_bumpy_one() {
        let bumps = |p: Vector2<f64>| {
            let height = 1e-3 * (500.0 * p.x).sin() * (500.0 * p.y).cos();
            Vector3::new(p.x, p.y, height)
        };
        let driver = square(&bumps, &bumps);
        let lower = skin(&driver, 0, 0.0);
        for levels in [0, 1] {
            let upper = skin(&driver, levels, OFFSET);
            let cover = Cover::new(&driver, &upper, &lower, OFFSET);
            let positions = (0..).zip(&upper.rest.positions);
            let uncovered = positions
                .filter(|(_, x)| x.xy().amax() < 0.45 * SIDE)
                .filter(|(vertex, _)| cover.vertices().binary_search(vertex).is_err());
            assert_eq!(uncovered.count(), 0, "at level {levels}");
        }
    }

    /// The same meshes have one cover, which goes with either of them.
    #[test]
    fn covers_are_kept_as_long_as_their_meshes() {
        let flat = |p: Vector2<f64>| Vector3::new(p.x, p.y, 0.0);
        let driver = square(&flat, &flat);
        let covers = Covers::default();
        let [lower, upper] = [0.0, OFFSET].map(|offset| skin(&driver, 0, offset));
        let first = covers.of(&driver, &upper, &lower, OFFSET);
        let again = covers.of(&driver, &upper.clone(), &lower, OFFSET);
        assert!(Arc::ptr_eq(&first, &again));
        drop(upper);
        let other = covers.of(&driver, &skin(&driver, 0, OFFSET), &lower, OFFSET);
        assert!(!Arc::ptr_eq(&first, &other));
        assert_eq!(covers.known.borrow().len(), 1);
    }
}
