//! Which triangles of the mesh of temperature and fuel lie on which triangle of the sheet's.

use nalgebra::Vector3;
use ruga_mesh::{
    ClosestPlace, FaceId, Id, MaterialPoint, PerFace, SurfaceLookup, closest_on_triangle,
};

use super::field_grid::{FieldGrid, lifted};
use crate::skin::skin_mesh::{RegionMesh, SkinMesh};

/// Reach of a search for a place on another mesh, over the way from where it begins: on coarser facets neighbours' places
/// may be farther apart than they are.
const REACH: f64 = 2.0;

/// Middles of the four like parts of a triangle, the one in the middle first, in its barycentric coordinates.
const QUARTERS: [[f64; 3]; 4] = [
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
    [2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0],
];

/// The triangles of the sheet that those of the field mesh lie on.
///
/// A triangle of the field mesh is divided in four, and each part belongs to the triangle of the sheet that its middle
/// lies on, whole, so that no mesh of the sheet gains or loses any fuel. Where one mesh lies in the other, nothing is
/// divided.
pub(super) struct Covering {
    /// The triangle of the sheet under the middle of every triangle of the field mesh.
    owners: PerFace<FaceId>,
    /// Triangles of the field mesh, those of the sheet under them, and the area that they share, m².
    shared: Vec<(FaceId, FaceId, f64)>,
    /// Area of the field mesh on every triangle of the sheet, m².
    areas: Vec<f64>,
    /// Triangles of the sheet that no part lies on, with the field's triangle under them.
    uncovered: Vec<(FaceId, FaceId)>,
}

impl Covering {
    /// The field mesh on the region's mesh, in whose triangles its own lie.
    pub(super) fn of_region(grid: &FieldGrid, region: &RegionMesh) -> Self {
        let owners = grid.origins.iter().map(|(_, origin)| origin.face);
        let owners: PerFace<FaceId> = owners.collect();
        let shared = owners
            .iter()
            .map(|(field, owner)| (field, *owner, grid.areas[field]));
        let faces = region.skin.mesh.face_count();
        Self::new(shared.collect(), owners, faces, |_| None)
    }

    /// The field mesh on `skin`, a mesh of the region whose vertices lie at `points` of the region's mesh, with the
    /// vertices of that mesh at `places` of its own.
    pub(super) fn of_fitted(
        grid: &FieldGrid,
        (region, skin): (&RegionMesh, &SkinMesh),
        points: &[MaterialPoint],
        places: &[MaterialPoint],
    ) -> Self {
        let coarse = &region.skin.mesh;
        let on_skin = SurfaceLookup::new(&skin.mesh, &skin.rest.positions);
        let mut owners = Vec::with_capacity(grid.mesh.face_count());
        let mut shared = Vec::new();
        for (field, corners) in grid.mesh.faces().iter() {
            let corners = corners.map(|v| grid.rest[v.index()]);
            let quarters = QUARTERS.map(|parts| between(&corners, parts));
            let start = coarse.faces()[grid.origins[field].face][0].index();
            let from = (places[start].face, region.skin.rest.positions[start]);
            let middle = nearest(&on_skin, from, &quarters[0]);
            owners.push(middle);
            let mut own = [middle; 4];
            let corners = skin.mesh.faces()[middle].map(|v| skin.rest.positions[v.index()]);
            for (own, quarter) in own.iter_mut().zip(&quarters).skip(1) {
                // Most triangles lie in one.
                let (parts, _) = closest_on_triangle(&corners, quarter);
                if !parts.iter().all(|part| *part > 0.0) {
                    *own = nearest(&on_skin, (middle, quarters[0]), quarter);
                }
            }
            let quarter = 0.25 * grid.areas[field];
            shared.extend(own.map(|owner| (field, owner, quarter)));
        }
        let on_region = SurfaceLookup::new(coarse, &region.skin.rest.positions);
        let under = |face: FaceId| {
            let corners = skin.mesh.faces()[face].map(|v| v.index());
            let middle = between(&corners.map(|v| skin.rest.positions[v]), QUARTERS[0]);
            let from = (points[corners[0]].face, skin.rest.positions[corners[0]]);
            let reach = REACH * (middle - from.1).norm();
            let found = on_region.closest_near(from.0, &middle, reach)?;
            under_place(grid, &found)
        };
        Self::new(shared, owners.into(), skin.mesh.face_count(), under)
    }

    fn new(
        shared: Vec<(FaceId, FaceId, f64)>,
        owners: PerFace<FaceId>,
        faces: usize,
        under: impl Fn(FaceId) -> Option<FaceId>,
    ) -> Self {
        let mut areas = vec![0.0; faces];
        for (_, owner, area) in &shared {
            areas[owner.index()] += area;
        }
        let uncovered = (0..faces).map(FaceId::from_index);
        let uncovered = uncovered.filter(|face| areas[face.index()] == 0.0);
        let uncovered = uncovered.filter_map(|face| Some((face, under(face)?)));
        Self {
            uncovered: uncovered.collect(),
            shared,
            owners,
            areas,
        }
    }

    /// The triangle of the sheet under the middle of a triangle of the field mesh.
    pub(super) fn owner(&self, field: FaceId) -> FaceId {
        self.owners[field]
    }

    /// Triangles of the field mesh, and those of the sheet on which they or parts of them lie.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (FaceId, FaceId)> + '_ {
        let shared = self.shared.iter().map(|(field, owner, _)| (*field, *owner));
        shared.chain(self.uncovered.iter().map(|(owner, field)| (*field, *owner)))
    }

    /// Area of the field mesh on every triangle of the sheet, m²; together all of its area.
    pub(super) fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// Sums over what lies on every triangle of the sheet of values of the field's triangles times areas (m²); where
    /// nothing does, the value of the one under it.
    pub(super) fn sums<const N: usize>(&self, value: impl Fn(FaceId) -> [f64; N]) -> Vec<[f64; N]> {
        let mut sums = vec![[0.0; N]; self.areas.len()];
        for (field, owner, area) in &self.shared {
            for (sum, value) in sums[owner.index()].iter_mut().zip(value(*field)) {
                *sum += area * value;
            }
        }
        for (face, field) in &self.uncovered {
            sums[face.index()] = value(*field);
        }
        sums
    }

    /// What the sums over a triangle of the sheet are to be divided by.
    pub(super) fn weight(&self, face: FaceId) -> f64 {
        match self.areas[face.index()] {
            0.0 => 1.0,
            area => area,
        }
    }
}

/// A place in a triangle with these corners, m.
fn between(corners: &[Vector3<f64>; 3], [u, v, w]: [f64; 3]) -> Vector3<f64> {
    let [a, b, c] = corners;
    a * u + b * v + c * w
}

/// The triangle of a mesh that is closest to a place, from one that is closest to another.
fn nearest(
    lookup: &SurfaceLookup<'_>,
    (near, from): (FaceId, Vector3<f64>),
    place: &Vector3<f64>,
) -> FaceId {
    let reach = REACH * (place - from).norm();
    let found = lookup.closest_near(near, place, reach);
    found.map_or(near, |found| found.point.face)
}

/// The triangle of the field mesh at a place of the region's mesh.
fn under_place(grid: &FieldGrid, place: &ClosestPlace) -> Option<FaceId> {
    let origins = grid.origins.as_slice();
    let face = place.point.face;
    let own = origins.partition_point(|origin| origin.face < face)
        ..origins.partition_point(|origin| origin.face <= face);
    let far = |number: &usize| {
        let middle = lifted(QUARTERS[0], &origins[*number].corners);
        let pairs = middle.iter().zip(&place.point.barycentric);
        pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>()
    };
    let nearest = own.min_by(|a, b| far(a).total_cmp(&far(b)));
    nearest.map(FaceId::from_index)
}
