//! The mesh that a layer is computed on, and its output mesh.

use std::sync::OnceLock;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{Driver, PosedSurface, Smoothing, SurfacePoints};
use ruga_crease::{CreaseEdge, CreaseWarning, LinePlaces, TracedLine};
use ruga_material::PropertyMap;
use ruga_mesh::{FaceId, MaterialPoint, PerEdge, PerFace, SurfaceLookup, TriMesh, VertexId};
use ruga_remesh::{
    PolyhedralSurface, RemeshError, RemeshSettings, SizeLimits, Sizing, SurfaceMesh, remesh,
};

use crate::error::Halt;
use crate::skin::boundary_cut::{Cut, TooManyCrossings, check_crossings, cut_along, faces_beside};
use crate::skin::crease_cut::{Creased, cut_along_creases};
use crate::skin::fans::open_along;
use crate::skin::identity::Identity;
use crate::skin::mirror::Plane;
use crate::skin::piece::{Piece, blend, uvs_of};
use crate::{LayerSpec, StepperError};

mod output;
mod shown;
mod sizing;

pub(crate) use output::OUTPUT_SLACK;
pub(crate) use shown::ShownFaces;
pub(crate) use sizing::SizingStrains;

use sizing::RemeshInput;

/// Lengths of edges, as multiples of what is wanted, that a mesh goes through. A mesh that is too
/// fine stays so up to a factor of 0.6, because edges between old vertices are spared; split edges
/// of a coarser one end nearer to what is wanted, with little more than half of the vertices. The
/// last round sees the sizing where the one before put its vertices.
const ROUNDS: [f64; 3] = [2.0, 1.0, 1.0];

/// A triangle mesh whose vertices are material points of the driver.
#[derive(Clone, Debug)]
pub(crate) struct SkinMesh {
    pub(crate) mesh: TriMesh,
    pub(crate) points: SurfacePoints,
    pub(crate) rest: PosedSurface,
    /// Faces beside a sharp boundary of the layer's map, each with a texture coordinate well inside
    /// it: their corners are on the boundary and say nothing about either side.
    pub(crate) beside: Vec<(FaceId, Vector2<f64>)>,
    /// Edges on crease lines.
    pub(crate) creases: Vec<CreaseEdge>,
    /// Whether every vertex lies on the plane at which one half of a symmetric pose ends; empty without such a plane.
    pub(crate) on_plane: Vec<bool>,
    /// Identity of the mesh; copies share it.
    pub(crate) identity: Identity,
}

impl SkinMesh {
    /// The mesh at rest `offset` (m) above the driver; `None` as soon as `goes_on` returns false.
    fn new(
        driver: &Driver,
        (mesh, points): (TriMesh, Vec<MaterialPoint>),
        smoothing: Smoothing,
        offset: f64,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<Self> {
        let points = SurfacePoints::new_while(driver, points, smoothing, goes_on)?;
        let mut rest = points.pose(driver.rest());
        for (x, normal) in rest.positions.iter_mut().zip(&rest.normals) {
            *x += normal * offset;
        }
        Some(Self {
            rest,
            mesh,
            points,
            beside: Vec::new(),
            creases: Vec::new(),
            on_plane: Vec::new(),
            identity: Identity::default(),
        })
    }

    /// Whether some vertex is not held by the driver.
    pub(crate) fn has_inner_vertices(&self) -> bool {
        self.held().as_slice().contains(&false)
    }

    /// The vertices' indices at the corners of every triangle.
    pub(crate) fn corner_indices(&self) -> Vec<[u32; 3]> {
        let faces = self.mesh.faces().as_slice().iter();
        faces.map(|corners| corners.map(|v| v.0)).collect()
    }
}

/// A fitted mesh.
pub(crate) struct Adapted {
    pub(crate) skin: SkinMesh,
    /// Edges over those asked for, where the budget did not allow them; 1 where it did.
    pub(crate) coarseness: f64,
    /// What was asked for at the vertices of the region's mesh.
    pub(crate) sizing: Sizing,
}

/// The output mesh of the active region: every triangle lies in one of the artist's, and, where the
/// layer's map is sharp, on one side of each of its boundaries.
#[derive(Clone, Debug)]
pub(crate) struct RegionMesh {
    pub(crate) skin: SkinMesh,
    origins: PerFace<ruga_mesh::FaceOrigin>,
    /// Triangles as results have them, once they were asked for.
    shown: OnceLock<ShownFaces>,
    /// Edges that a fitted mesh keeps: boundaries of the layer's map, and creases.
    features: PerEdge<bool>,
    /// The layer's creases over this mesh.
    lines: Vec<TracedLine>,
    /// Stretches of creases that fold as another one says.
    pub(crate) shared: Vec<CreaseWarning>,
    /// The corners of every triangle of results, whose vertices on creases are there once for each side, and for every
    /// vertex of results that of this mesh; `None` without creases.
    opened: Option<(Vec<[u32; 3]>, Vec<VertexId>)>,
    smoothing: Smoothing,
    offset: f64,
    /// Whether it is one half of a symmetric pose.
    is_half: bool,
}

/// Whether `piece`, the region that `layer` covers, can be made to follow its map.
///
/// # Errors
/// [`StepperError::TooManyBoundaries`].
pub(crate) fn check_boundaries(
    driver: &Driver,
    piece: Piece,
    layer: &LayerSpec,
) -> Result<(), StepperError> {
    let Some(map) = sharp_map(layer) else {
        return Ok(());
    };
    check_crossings(map, driver, piece).map_err(|source| too_many(layer, source))
}

/// The map whose boundaries the layer's mesh is to follow.
pub(crate) fn sharp_map(layer: &LayerSpec) -> Option<&PropertyMap> {
    layer.map.as_deref().filter(|_| layer.sharp)
}

fn too_many(layer: &LayerSpec, crossings: TooManyCrossings) -> StepperError {
    StepperError::TooManyBoundaries {
        layer: layer.name.clone(),
        percent: 100.0 * crossings.fraction,
    }
}

impl RegionMesh {
    /// The region `piece` that `layer` covers, at rest `offset` above the driver.
    ///
    /// # Errors
    /// [`StepperError::TooManyBoundaries`]; [`Halt::Interrupted`] as soon as `goes_on`, which is
    /// asked between the steps, says no.
    pub(crate) fn new(
        driver: &Driver,
        layer: &LayerSpec,
        (piece, smoothing, offset): (Piece, Smoothing, f64),
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Self, Halt> {
        let cut = match sharp_map(layer) {
            None => Cut::none(piece),
            Some(map) => cut_along(map, driver, piece).map_err(|source| too_many(layer, source))?,
        };
        let Creased {
            piece,
            boundaries,
            creases,
            lines,
            shared,
        } = cut_along_creases(driver, &layer.creases, cut);
        let Piece {
            mesh,
            points,
            origins,
        } = piece;
        let beside = faces_beside(&mesh, &boundaries).into_iter();
        let mut features = boundaries;
        for crease in &creases {
            features[crease.edge] = true;
        }
        let beside = beside
            .map(|(face, weights)| (face, blend(&uvs_of(driver, &origins[face]), weights)))
            .collect();
        let opened = (!creases.is_empty())
            .then(|| open_along(&mesh, creases.iter().map(|crease| crease.edge)));
        let skin = SkinMesh::new(driver, (mesh, points), smoothing, offset, goes_on);
        let skin = skin.ok_or(Halt::Interrupted)?;
        Ok(Self {
            features,
            lines,
            shared,
            opened,
            skin: SkinMesh {
                beside,
                creases,
                ..skin
            },
            shown: OnceLock::new(),
            origins,
            smoothing,
            offset,
            is_half: false,
        })
    }

    /// The region as one half of a symmetric pose, whose skin goes on beyond the plane `x = 0`.
    pub(crate) fn halved(mut self, driver: &Driver) -> Self {
        self.is_half = true;
        let (mesh, places) = (&self.skin.mesh, self.skin.points.points());
        self.skin.on_plane = Plane::of(driver).holds(driver, mesh, places);
        self
    }

    /// Texture coordinates of the material points of a triangle's corners, V down.
    pub(crate) fn uvs(&self, driver: &Driver, face: FaceId) -> [Vector2<f64>; 3] {
        uvs_of(driver, &self.origins[face])
    }

    /// A mesh of the region that is as fine as `strains` and the rest shape ask for, in the
    /// directions in which they do, or as the budget allows; `None` as soon as `goes_on`, which is
    /// asked between its steps, says no.
    pub(crate) fn adapted(
        &self,
        driver: &Driver,
        strains: &SizingStrains<'_>,
        settings: &RemeshSettings,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Adapted>, RemeshError> {
        let RemeshInput {
            surface,
            start,
            sizing: wanted,
            coarseness,
        } = self.remesh_input(strains, settings)?;
        if !goes_on() {
            return Ok(None);
        }
        // The sizing has been limited and graded already. Once more would act on the coarser
        // rounds, whose edges are longer on purpose.
        let settings = RemeshSettings {
            limits: SizeLimits {
                min_edge: 0.0,
                max_edge: f64::MAX,
                aspect: settings.limits.aspect,
                grading: f64::INFINITY,
            },
            ..*settings
        };
        let mut made = start;
        for round in ROUNDS {
            // The sizing is known at this mesh's vertices, and the fitted one has others after
            // every round.
            let sizing = self.sizing_at(&made.points, &wanted, round * coarseness);
            made = remesh(&made, &sizing, &surface, &settings)?.mesh;
            if !goes_on() {
                return Ok(None);
            }
        }
        let skin = self.placed(driver, &made, goes_on);
        Ok(skin.map(|skin| Adapted {
            skin,
            coarseness,
            sizing: wanted,
        }))
    }

    /// A mesh on this one's facets, at its places of the driver; `None` as soon as `goes_on` says no.
    pub(crate) fn placed(
        &self,
        driver: &Driver,
        made: &SurfaceMesh,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<SkinMesh> {
        let on_driver = |point: &MaterialPoint| self.origins[point.face].place(point.barycentric);
        let points: Vec<MaterialPoint> = made.points.as_slice().iter().map(on_driver).collect();
        let creases = self.creases_of(made);
        let beside = self.beside(driver, made, &creases);
        let places = (made.mesh.clone(), points);
        let skin = SkinMesh::new(driver, places, self.smoothing, self.offset, goes_on)?;
        let on_plane = match self.is_half {
            true => Plane::of(driver).holds(driver, &skin.mesh, skin.points.points()),
            false => Vec::new(),
        };
        Some(SkinMesh {
            beside,
            creases,
            on_plane,
            ..skin
        })
    }

    /// Its facets as the surface of a fitted mesh, and itself on them.
    pub(crate) fn on_facets(&self) -> Result<(PolyhedralSurface<'_>, SurfaceMesh), RemeshError> {
        let mesh = &self.skin.mesh;
        let surface = PolyhedralSurface::new(mesh, &self.skin.rest.positions, &self.features)?;
        let own = SurfaceMesh {
            features: self.features.clone(),
            ..SurfaceMesh::on_surface(mesh.clone(), surface.vertex_points()?, &surface)?
        };
        Ok((surface, own))
    }

    /// The edges of a fitted mesh on crease lines.
    fn creases_of(&self, fitted: &SurfaceMesh) -> Vec<CreaseEdge> {
        if self.skin.creases.is_empty() {
            return Vec::new();
        }
        let is_inner_feature =
            |edge| fitted.features[edge] && !fitted.mesh.edges()[edge].is_border();
        LinePlaces::new(&self.lines, &self.skin.mesh).edges(
            &fitted.mesh,
            fitted.points.as_slice(),
            is_inner_feature,
        )
    }

    /// The faces of a fitted mesh beside features, each with a texture coordinate inside: that of the
    /// place of this mesh below, because a fitted face may lie across a seam.
    fn beside(
        &self,
        driver: &Driver,
        fitted: &SurfaceMesh,
        creases: &[CreaseEdge],
    ) -> Vec<(FaceId, Vector2<f64>)> {
        // The skin is the same on both sides of a crease.
        let mut boundaries = fitted.features.clone();
        for crease in creases {
            boundaries[crease.edge] = false;
        }
        let faces = faces_beside(&fitted.mesh, &boundaries);
        if faces.is_empty() {
            return Vec::new();
        }
        let lookup = SurfaceLookup::new(&self.skin.mesh, &self.skin.rest.positions);
        faces
            .into_iter()
            .map(|(face, weights)| {
                let corners = fitted.mesh.faces()[face];
                let weighted = corners.iter().zip(weights);
                let target: Vector3<f64> = weighted.map(|(&v, w)| fitted.positions[v] * w).sum();
                let near = fitted.points[corners[nearest(weights)]];
                // All of the way from the corner to the target is within this reach.
                let reach = (fitted.positions[corners[nearest(weights)]] - target).norm();
                let found = lookup.closest_near(near.face, &target, reach);
                let place = found.map_or(near, |found| found.point);
                let uvs = self.uvs(driver, place.face);
                (face, blend(&uvs, place.barycentric))
            })
            .collect()
    }
}

/// The corner with the largest weight.
fn nearest(weights: [f64; 3]) -> usize {
    (1..3).fold(
        0,
        |best, i| if weights[i] > weights[best] { i } else { best },
    )
}
