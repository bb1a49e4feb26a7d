//! How fine a mesh of a region is to be, and whether one is.

use nalgebra::{Matrix3, SymmetricEigen};
use rayon::prelude::*;
use ruga_mesh::{Id, MaterialPoint, PerFace, PerVertex, vertex_areas};
use ruga_remesh::{
    FaceDriver, PolyhedralSurface, Refinement, RemeshError, RemeshSettings, Sizing, SizingInput,
    SurfaceMesh, sizing_field,
};

use super::{RegionMesh, SkinMesh};

/// Edges over those asked for that a fitted mesh may have here and there.
const TOO_LONG: f64 = 1.5;

/// Compressions and edge lengths that a mesh of a region is fitted to.
pub(crate) struct SizingStrains<'a> {
    /// Compression that drives wrinkles on every triangle of the region's mesh.
    pub(crate) drivers: &'a PerFace<FaceDriver>,
    /// Longest edges at every vertex, as a sizing tensor: squared inverse lengths (1/m²).
    pub(crate) least: &'a [Matrix3<f64>],
    /// Largest ratio of edges along and across the wrinkles at every vertex; infinite where the
    /// mesh's own limit is enough.
    pub(crate) aspects: &'a [f64],
    pub(crate) refinement: Refinement,
    /// Largest number of vertices.
    pub(crate) budget: usize,
}

/// Surface and sizing that the remesher is given.
pub(super) struct RemeshInput<'a> {
    pub(super) surface: PolyhedralSurface<'a>,
    pub(super) start: SurfaceMesh,
    pub(super) sizing: Sizing,
    /// Edges over those asked for, where the budget does not allow them; 1 where it does.
    pub(super) coarseness: f64,
}

impl RegionMesh {
    /// Surface and sizing for `strains` and the rest shape at this mesh's vertices.
    pub(super) fn remesh_input(
        &self,
        strains: &SizingStrains<'_>,
        settings: &RemeshSettings,
    ) -> Result<RemeshInput<'_>, RemeshError> {
        let (surface, start) = self.on_facets()?;
        let mut sizing = sizing_field(&SizingInput {
            mesh: &start,
            shape: &self.skin.rest.positions,
            driver: Some(strains.drivers),
            refinement: strains.refinement,
        })?;
        let tensors = sizing.tensors.as_mut_slice().par_iter_mut();
        let limits = strains.least.par_iter().zip(strains.aspects);
        tensors.zip(limits).for_each(|(tensor, (least, aspect))| {
            // A sum is no coarser than either term in any direction, and smooth where the larger
            // one changes.
            *tensor += least;
            limit_aspect(tensor, *aspect);
        });
        let sizing = sizing.limited(&start, &surface, &settings.limits)?;
        let estimate = sizing.vertex_estimate(&start)? as f64;
        Ok(RemeshInput {
            coarseness: (estimate / strains.budget as f64).sqrt().max(1.0),
            surface,
            start,
            sizing,
        })
    }

    /// Fraction of the vertices asked for by `strains` at whose place the triangle of `layer`, a mesh of the same
    /// region, is longer than they allow by the factor that a fitted mesh may have anywhere.
    pub(crate) fn fraction_too_coarse(
        &self,
        layer: &SkinMesh,
        places: &[MaterialPoint],
        strains: &SizingStrains<'_>,
        settings: &RemeshSettings,
    ) -> Result<f64, RemeshError> {
        let RemeshInput {
            sizing, coarseness, ..
        } = self.remesh_input(strains, settings)?;
        // Where the budget leaves edges too long everywhere, a new mesh would be no finer.
        let longest = TOO_LONG * coarseness;
        // This mesh has few vertices where nothing wrinkled before, though many may be asked for there now.
        let areas = vertex_areas(&self.skin.mesh, &self.skin.rest.positions);
        let (mut too_coarse, mut all) = (0.0, 0.0);
        for ((place, tensor), area) in places.iter().zip(sizing.tensors.as_slice()).zip(areas) {
            let asked = area * vertices_per_area(tensor);
            let [a, b, c] = layer.mesh.faces()[place.face].map(|v| layer.rest.positions[v.index()]);
            let mut edges = [b - a, c - b, a - c].into_iter();
            if edges.any(|edge| edge.dot(&(tensor * edge)) > longest * longest) {
                too_coarse += asked;
            }
            all += asked;
        }
        Ok(too_coarse / f64::max(all, f64::MIN_POSITIVE))
    }

    /// Sizing at places of this mesh from that at its vertices, for edges `coarseness` times as
    /// long.
    pub(super) fn sizing_at(
        &self,
        places: &PerVertex<MaterialPoint>,
        sizing: &Sizing,
        coarseness: f64,
    ) -> Sizing {
        let tensor = |place: &MaterialPoint| {
            let corners = self.skin.mesh.faces()[place.face].iter();
            let weighted = corners.zip(place.barycentric);
            let sum = weighted.map(|(&v, weight)| sizing.tensors[v] * weight);
            sum.sum::<Matrix3<f64>>() / (coarseness * coarseness)
        };
        Sizing {
            tensors: places.as_slice().iter().map(tensor).collect(),
        }
    }
}

/// Vertices per area that a sizing tensor asks for, up to a factor.
fn vertices_per_area(tensor: &Matrix3<f64>) -> f64 {
    let mut values = tensor.symmetric_eigenvalues();
    // The least is that of the normal.
    values.as_mut_slice().sort_by(|a, b| b.total_cmp(a));
    (values[0] * values[1]).max(0.0).sqrt()
}

/// Shortens the long directions of a sizing tensor to `aspect` times the short one.
pub(super) fn limit_aspect(tensor: &mut Matrix3<f64>, aspect: f64) {
    if aspect == f64::INFINITY {
        return;
    }
    let eigen = SymmetricEigen::new(*tensor);
    // Values are inverse squares of lengths: to raise small ones shortens the long direction, while
    // to lower large ones would leave wrinkles unresolved.
    let least = eigen.eigenvalues.max() / (aspect * aspect);
    let values = eigen.eigenvalues.map(|value| value.max(least));
    let vectors = eigen.eigenvectors;
    *tensor = vectors * Matrix3::from_diagonal(&values) * vectors.transpose();
}
