//! Which triangles of the mesh of temperature and fuel lie on which triangle of the sheet's.

use nalgebra::Vector3;
use ruga_mesh::{FaceId, Id, MaterialPoint, PerFace, SurfaceLookup};

use super::field_grid::FieldGrid;
use crate::skin::skin_mesh::{RegionMesh, SkinMesh};

/// Reach of a search for the middle of a triangle from one of its corners, over the way between the two: on coarser
/// facets neighbours' places may be farther apart than they are.
const REACH: f64 = 2.0;

/// The triangles of the sheet that those of the field mesh lie on.
///
/// A triangle of the field mesh belongs to the one that its middle lies on, whole, so that no mesh of the sheet gains or
/// loses any fuel. Where one mesh lies in the other nothing is cut by that.
pub(super) struct Covering {
    /// The triangle of the sheet under every triangle of the field mesh.
    owners: PerFace<FaceId>,
    /// Rest area of the field's triangles on every triangle of the sheet, m².
    areas: Vec<f64>,
    /// Triangles of the sheet that no middle lies on, with the field's triangle under theirs.
    bare: Vec<(FaceId, FaceId)>,
}

impl Covering {
    /// The field mesh on the region's mesh, in whose triangles its own lie.
    pub(super) fn of_region(grid: &FieldGrid, region: &RegionMesh) -> Self {
        let owners = grid.origins.as_slice().iter().map(|origin| origin.face);
        let faces = region.skin.mesh.face_count();
        Self::new(grid, owners.collect(), faces, |_| None)
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
        let lookup = SurfaceLookup::new(&skin.mesh, &skin.rest.positions);
        let faces = grid.mesh.faces().iter().zip(grid.origins.as_slice());
        let owners = faces.map(|((_, corners), origin)| {
            let middle = corners
                .map(|v| grid.rest[v.index()])
                .iter()
                .sum::<Vector3<f64>>()
                / 3.0;
            let start = coarse.faces()[origin.face][0].index();
            let way = (middle - region.skin.rest.positions[start]).norm();
            let near = places[start].face;
            let found = lookup.closest_near(near, &middle, REACH * way);
            found.map_or(near, |found| found.point.face)
        });
        let under = SurfaceLookup::new(coarse, &region.skin.rest.positions);
        let beneath = |face: FaceId| {
            let corners = skin.mesh.faces()[face].map(|v| v.index());
            let middle = corners
                .map(|v| skin.rest.positions[v])
                .iter()
                .sum::<Vector3<f64>>()
                / 3.0;
            let way = (middle - skin.rest.positions[corners[0]]).norm();
            let near = points[corners[0]].face;
            let found = under.closest_near(near, &middle, REACH * way);
            let below = found.map_or(near, |found| found.point.face);
            let origins = grid.origins.as_slice();
            let first = origins.partition_point(|origin| origin.face < below);
            (first < origins.len()).then(|| FaceId::from_index(first))
        };
        Self::new(grid, owners.collect(), skin.mesh.face_count(), beneath)
    }

    fn new(
        grid: &FieldGrid,
        owners: PerFace<FaceId>,
        faces: usize,
        beneath: impl Fn(FaceId) -> Option<FaceId>,
    ) -> Self {
        let mut areas = vec![0.0; faces];
        for (field, owner) in owners.iter() {
            areas[owner.index()] += grid.areas[field];
        }
        let bare = (0..faces).map(FaceId::from_index);
        let bare = bare.filter(|face| areas[face.index()] == 0.0);
        let bare = bare.filter_map(|face| Some((face, beneath(face)?)));
        Self {
            bare: bare.collect(),
            owners,
            areas,
        }
    }

    /// The triangle of the sheet under a triangle of the field mesh.
    pub(super) fn owner(&self, field: FaceId) -> FaceId {
        self.owners[field]
    }

    /// Rest area of the field's triangles on a triangle of the sheet, m²; of all of them.
    pub(super) fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// Sums over the field's triangles on every triangle of the sheet of values times areas (m²); where there are none,
    /// the value of the one under it.
    pub(super) fn sums<const N: usize>(
        &self,
        grid: &FieldGrid,
        value: impl Fn(FaceId) -> [f64; N],
    ) -> Vec<[f64; N]> {
        let mut sums = vec![[0.0; N]; self.areas.len()];
        for (field, owner) in self.owners.iter() {
            let area = grid.areas[field];
            for (sum, value) in sums[owner.index()].iter_mut().zip(value(field)) {
                *sum += area * value;
            }
        }
        for (face, field) in &self.bare {
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
