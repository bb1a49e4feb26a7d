//! The mesh a layer is computed on, and the one it is handed out on.

use std::collections::VecDeque;
use std::sync::{Arc, Weak};

use nalgebra::{Matrix3, SymmetricEigen, Vector2, Vector3};
use ruga_blend::{BaseSurface, Driver, PosedSurface, Smoothing, SurfacePoints};
use ruga_material::PropertyMap;
use ruga_mesh::{
    FaceId, Id, LoopSurface, MaterialPoint, PerEdge, PerFace, PerVertex, SparseRows, SurfaceLookup,
    TriMesh, VertexId, limit_rows,
};
use ruga_remesh::{
    FaceDriver, PolyhedralSurface, Refinement, RemeshError, RemeshSettings, SizeLimits, Sizing,
    SizingInput, SurfaceMesh, remesh, sizing_field,
};

use crate::error::Halt;
use crate::skin::boundary_cut::{
    Cut, Piece, TooManyCrossings, blend, check_crossings, cut_along, faces_beside,
};
use crate::skin::facet_address::{FacetAddresses, Piece as Facets};
use crate::{LayerSpec, StepperError};

/// Corrections of control points towards a limit surface that passes through the vertices. The
/// limit alone loses some 4 % of a wave's amplitude at 12 points per wavelength; one correction
/// leaves 0.2 % of it, more would bring back what is as short as the edges and no wrinkle.
const INTERPOLATION_STEPS: usize = 1;

/// Lengths of edges, as multiples of what is wanted, that a mesh goes through. A mesh that is too
/// fine stays so up to a factor of 0.6, because edges between old vertices are spared; split edges
/// of a coarser one end nearer to what is wanted, with little more than half of the vertices. The
/// last round sees the sizing where the one before put its vertices.
const ROUNDS: [f64; 3] = [2.0, 1.0, 1.0];

/// Edges over those asked for that a fitted mesh may have here and there.
const TOO_LONG: f64 = 1.5;

/// Places found, or interpolated at, between two questions whether to go on.
const PLACES_AT_A_TIME: usize = 20_000;

/// A triangle mesh whose vertices are material points of the driver.
#[derive(Clone, Debug)]
pub(crate) struct SkinMesh {
    pub(crate) mesh: TriMesh,
    pub(crate) points: SurfacePoints,
    pub(crate) rest: PosedSurface,
    /// Faces beside a sharp boundary of the layer's map, each with a texture coordinate well inside
    /// it: their corners are on the boundary and say nothing about either side.
    pub(crate) beside: Vec<(FaceId, Vector2<f64>)>,
    /// What tells it from others; copies share it.
    pub(crate) identity: Identity,
}

/// Equal for an original and its copies only.
#[derive(Clone, Debug, Default)]
pub(crate) struct Identity(Arc<()>);

impl Identity {
    /// Something to know it by that does not keep it.
    pub(crate) fn mark(&self) -> Mark {
        Mark(Arc::downgrade(&self.0))
    }
}

/// Reminder of an [`Identity`].
#[derive(Debug)]
pub(crate) struct Mark(Weak<()>);

impl Mark {
    pub(crate) fn is_of(&self, identity: &Identity) -> bool {
        std::ptr::eq(self.0.as_ptr(), Arc::as_ptr(&identity.0))
    }

    /// Whether nothing of that identity is left.
    pub(crate) fn is_stale(&self) -> bool {
        self.0.strong_count() == 0
    }
}

impl SkinMesh {
    /// At rest `offset` above the driver; `None` as soon as `goes_on` says no.
    fn new(
        driver: &Driver,
        (mesh, points): (TriMesh, &[MaterialPoint]),
        smoothing: Smoothing,
        offset: f64,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<Self> {
        let points = SurfacePoints::new_while(driver, points, smoothing, goes_on)?;
        let on_driver = Self {
            rest: points.pose(driver.rest()),
            mesh,
            points,
            beside: Vec::new(),
            identity: Identity::default(),
        };
        Some(on_driver.lifted(offset))
    }

    /// At rest so much higher.
    fn lifted(mut self, offset: f64) -> Self {
        for (x, normal) in self.rest.positions.iter_mut().zip(&self.rest.normals) {
            *x += normal * offset;
        }
        self
    }

    /// The vertices' indices at the corners of every triangle.
    pub(crate) fn corner_indices(&self) -> Vec<[u32; 3]> {
        let faces = self.mesh.faces().as_slice().iter();
        faces.map(|corners| corners.map(|v| v.0)).collect()
    }
}

/// What a mesh of a region is to resolve.
pub(crate) struct MeshDemand<'a> {
    /// What drives wrinkles on every triangle of the region's mesh.
    pub(crate) drivers: &'a PerFace<FaceDriver>,
    /// Longest edge at every vertex, m.
    pub(crate) longest: &'a [f64],
    /// Largest ratio of edges along and across the wrinkles at every vertex; infinite where the
    /// mesh's own limit is enough.
    pub(crate) aspects: &'a [f64],
    pub(crate) refinement: Refinement,
    /// Vertices that there may be.
    pub(crate) budget: usize,
}

/// What a mesh of a region is to be like.
struct Wanted<'a> {
    surface: PolyhedralSurface<'a>,
    start: SurfaceMesh,
    sizing: Sizing,
    /// Edges over those asked for, where the budget does not allow them; 1 where it does.
    coarseness: f64,
}

/// A fitted mesh.
pub(crate) struct Adapted {
    pub(crate) skin: SkinMesh,
    /// Edges over those asked for, where the budget did not allow them; 1 where it did.
    pub(crate) coarseness: f64,
}

/// The uniform mesh of the active region: every triangle lies in one of the artist's, and, where the
/// layer's map is sharp, on one side of each of its boundaries.
#[derive(Clone, Debug)]
pub(crate) struct RegionMesh {
    pub(crate) skin: SkinMesh,
    /// Of the material points.
    uvs: Vec<[Vector2<f64>; 3]>,
    origins: PerFace<ruga_mesh::FaceOrigin>,
    /// Where results are shown.
    addresses: FacetAddresses,
    artist: Vec<u32>,
    /// Edges that a fitted mesh keeps.
    features: PerEdge<bool>,
    smoothing: Smoothing,
    offset: f64,
}

/// Whether the mesh of the region of `base` that `layer` covers can follow its map.
///
/// # Errors
/// [`StepperError::TooManyBoundaries`].
pub(crate) fn check_boundaries(
    driver: &Driver,
    base: &BaseSurface,
    layer: &LayerSpec,
) -> Result<(), StepperError> {
    let Some(map) = sharp_map(layer) else {
        return Ok(());
    };
    check_crossings(map, driver, piece_of(base)).map_err(|source| too_many(layer, source))
}

/// The map whose boundaries the layer's mesh is to follow.
pub(crate) fn sharp_map(layer: &LayerSpec) -> Option<&PropertyMap> {
    layer.map.as_deref().filter(|_| layer.sharp)
}

fn too_many(layer: &LayerSpec, crossings: TooManyCrossings) -> StepperError {
    StepperError::TooManyBoundaries {
        layer: layer.name.clone(),
        percent: 100.0 * crossings.share,
    }
}

fn piece_of(base: &BaseSurface) -> Piece {
    let (mesh, copied) = one_fan_per_vertex(base.mesh());
    let base_points = base.vertex_points();
    Piece {
        mesh,
        points: copied.iter().map(|v| base_points[v.index()]).collect(),
        origins: base.origins().clone(),
        uvs: base.uvs().as_slice().to_vec(),
    }
}

impl RegionMesh {
    /// The region of `base` that `layer` covers, at rest `offset` above the driver.
    ///
    /// # Errors
    /// [`StepperError::TooManyBoundaries`]; [`Halt::Interrupted`] as soon as `goes_on`, which is
    /// asked between the steps, says no.
    pub(crate) fn new(
        driver: &Driver,
        layer: &LayerSpec,
        (base, smoothing, offset): (&BaseSurface, Smoothing, f64),
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Self, Halt> {
        let piece = piece_of(base);
        let Cut { piece, features } = match sharp_map(layer) {
            None => Cut::none(piece),
            Some(map) => cut_along(map, driver, piece).map_err(|source| too_many(layer, source))?,
        };
        let Piece {
            mesh,
            points,
            origins,
            uvs,
        } = piece;
        let beside = faces_beside(&mesh, &features).into_iter();
        let beside = beside
            .map(|(face, weights)| (face, blend(&uvs[face.index()], weights)))
            .collect();
        let skin = SkinMesh::new(driver, (mesh, &points), smoothing, 0.0, goes_on);
        let skin = skin.ok_or(Halt::Interrupted)?;
        let addresses = FacetAddresses::new(
            driver,
            &Facets {
                mesh: &skin.mesh,
                points: &points,
                positions: &skin.rest.positions,
                normals: &skin.rest.normals,
                origins: &origins,
                uvs: &uvs,
            },
        );
        let artist = origins.as_slice().iter();
        Ok(Self {
            features,
            skin: SkinMesh {
                beside,
                ..skin.lifted(offset)
            },
            uvs,
            addresses,
            artist: artist
                .map(|origin| driver.triangles()[origin.face])
                .collect(),
            origins,
            smoothing,
            offset,
        })
    }

    /// Texture coordinates of the material points of every triangle's corners, V down.
    #[cfg(test)]
    pub(crate) fn uvs(&self) -> &[[Vector2<f64>; 3]] {
        &self.uvs
    }

    /// Texture coordinates of every triangle's corners, V down, as the artist's flat triangles show
    /// them.
    pub(crate) fn shown_uvs(&self) -> &[[Vector2<f64>; 3]] {
        &self.addresses.uvs
    }

    /// For every triangle the file's triangle and its corners' places there.
    pub(crate) fn artist(&self) -> Vec<(u32, [[f64; 3]; 3])> {
        let triangles = self.artist.iter().copied();
        triangles
            .zip(self.addresses.corners.iter().copied())
            .collect()
    }

    /// A mesh of the region that is as fine as `demand` and the rest shape ask for, in the
    /// directions in which they do, or as the budget allows; `None` as soon as `goes_on`, which is
    /// asked between its steps, says no.
    pub(crate) fn adapted(
        &self,
        driver: &Driver,
        demand: &MeshDemand<'_>,
        settings: &RemeshSettings,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Adapted>, RemeshError> {
        let Wanted {
            surface,
            start,
            sizing: wanted,
            coarseness,
        } = self.wanted(demand, settings)?;
        if !goes_on() {
            return Ok(None);
        }
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
            let sizing = self.sizing_at(&made.points, &wanted, round * coarseness);
            made = remesh(&made, &sizing, &surface, &settings)?.mesh;
            if !goes_on() {
                return Ok(None);
            }
        }
        let on_driver = |point: &MaterialPoint| self.origins[point.face].place(point.barycentric);
        let points: Vec<MaterialPoint> = made.points.as_slice().iter().map(on_driver).collect();
        let beside = self.beside(&made);
        let places = (made.mesh, points.as_slice());
        let skin = SkinMesh::new(driver, places, self.smoothing, self.offset, goes_on);
        Ok(skin.map(|skin| Adapted {
            skin: SkinMesh { beside, ..skin },
            coarseness,
        }))
    }

    /// The faces of a fitted mesh beside features, each with a texture coordinate inside: that of the
    /// place of this mesh below, because a fitted face may lie across a seam.
    fn beside(&self, fitted: &SurfaceMesh) -> Vec<(FaceId, Vector2<f64>)> {
        let faces = faces_beside(&fitted.mesh, &fitted.features);
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
                (
                    face,
                    blend(&self.uvs[place.face.index()], place.barycentric),
                )
            })
            .collect()
    }

    /// What `demand` and the rest shape ask for at this mesh's vertices.
    fn wanted(
        &self,
        demand: &MeshDemand<'_>,
        settings: &RemeshSettings,
    ) -> Result<Wanted<'_>, RemeshError> {
        let mesh = &self.skin.mesh;
        let surface = PolyhedralSurface::new(mesh, &self.skin.rest.positions, &self.features)?;
        let start = SurfaceMesh {
            features: self.features.clone(),
            ..SurfaceMesh::on_surface(mesh.clone(), surface.vertex_points()?, &surface)?
        };
        let mut sizing = sizing_field(&SizingInput {
            mesh: &start,
            shape: &self.skin.rest.positions,
            velocity: None,
            driver: Some(demand.drivers),
            refinement: demand.refinement,
        })?;
        let limits = demand.longest.iter().zip(demand.aspects);
        for (tensor, (longest, aspect)) in sizing.tensors.as_mut_slice().iter_mut().zip(limits) {
            *tensor += Matrix3::identity() / (longest * longest);
            limit_aspect(tensor, *aspect);
        }
        let sizing = sizing.limited(&start, &surface, &settings.limits)?;
        let estimate = sizing.vertex_estimate(&start)? as f64;
        Ok(Wanted {
            coarseness: (estimate / demand.budget as f64).sqrt().max(1.0),
            surface,
            start,
            sizing,
        })
    }

    /// Share of this mesh's vertices under which the triangle of `layer`, a mesh of the same
    /// region, is longer than `demand` allows by the factor that a fitted mesh may have anywhere.
    pub(crate) fn share_too_coarse(
        &self,
        layer: &SkinMesh,
        places: &[MaterialPoint],
        demand: &MeshDemand<'_>,
        settings: &RemeshSettings,
    ) -> Result<f64, RemeshError> {
        let Wanted {
            sizing, coarseness, ..
        } = self.wanted(demand, settings)?;
        let longest = TOO_LONG * coarseness;
        let too_coarse = places.iter().zip(sizing.tensors.as_slice());
        let too_coarse = too_coarse.filter(|(place, tensor)| {
            let [a, b, c] = layer.mesh.faces()[place.face].map(|v| layer.rest.positions[v.index()]);
            [b - a, c - b, a - c]
                .iter()
                .any(|edge| edge.dot(&(*tensor * edge)) > longest * longest)
        });
        Ok(too_coarse.count() as f64 / places.len().max(1) as f64)
    }

    /// Sizing at places of this mesh from that at its vertices, for edges `coarseness` times as
    /// long.
    fn sizing_at(
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

/// The corner with the largest weight.
fn nearest(weights: [f64; 3]) -> usize {
    (1..3).fold(
        0,
        |best, i| if weights[i] > weights[best] { i } else { best },
    )
}

/// Shortens the long directions of a sizing tensor to `aspect` times the short one.
fn limit_aspect(tensor: &mut Matrix3<f64>, aspect: f64) {
    if aspect == f64::INFINITY {
        return;
    }
    let eigen = SymmetricEigen::new(*tensor);
    let least = eigen.eigenvalues.max() / (aspect * aspect);
    let values = eigen.eigenvalues.map(|value| value.max(least));
    let vectors = eigen.eigenvectors;
    *tensor = vectors * Matrix3::from_diagonal(&values) * vectors.transpose();
}

/// Smooth interpolation of what is known at a mesh's vertices.
///
/// The Loop limit of control values that are corrected until it passes through the given ones:
/// smooth as the limit, without its loss of amplitude.
#[derive(Clone, Debug)]
pub(crate) struct Interpolation {
    at_vertices: SparseRows,
    at_places: SparseRows,
    places: Vec<MaterialPoint>,
}

impl Interpolation {
    /// How values at the vertices of one mesh become values at those of another, of the same skin;
    /// `None` as soon as `goes_on` says no.
    pub(crate) fn new(
        from: &SkinMesh,
        to: &SkinMesh,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<Self> {
        let places = places_on(from, to, goes_on)?;
        let corners = PerVertex::filled(from.mesh.vertex_count(), false);
        let surface = LoopSurface::new(&from.mesh, &corners);
        let mut at_places = SparseRows::default();
        for chunk in places.chunks(PLACES_AT_A_TIME) {
            at_places.append(&surface.position_rows(chunk));
            if !goes_on() {
                return None;
            }
        }
        Some(Self {
            at_vertices: limit_rows(&from.mesh, &corners).position,
            at_places,
            places,
        })
    }

    /// Where on the one mesh the vertices of the other are.
    pub(crate) fn places(&self) -> &[MaterialPoint] {
        &self.places
    }

    pub(crate) fn apply(&self, values: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        self.at_places
            .apply(&through_vertices(&self.at_vertices, values))
    }
}

/// Control points whose limit surface, by the rows `at_vertices`, passes closer to `values`.
pub(crate) fn through_vertices(
    at_vertices: &SparseRows,
    values: &[Vector3<f64>],
) -> Vec<Vector3<f64>> {
    let mut control = values.to_vec();
    for _ in 0..INTERPOLATION_STEPS {
        let reached = at_vertices.apply(&control);
        for ((control, value), reached) in control.iter_mut().zip(values).zip(&reached) {
            *control += value - reached;
        }
    }
    control
}

/// The place of `layer` under every vertex of `region`, both at rest.
///
/// Found from neighbour to neighbour along the region, so that parts that touch are not confused;
/// `None` as soon as `goes_on` says no.
fn places_on(
    layer: &SkinMesh,
    region: &SkinMesh,
    goes_on: &mut dyn FnMut() -> bool,
) -> Option<Vec<MaterialPoint>> {
    let lookup = SurfaceLookup::new(&layer.mesh, &layer.rest.positions);
    let mesh = &region.mesh;
    let mut places: PerVertex<Option<MaterialPoint>> = PerVertex::filled(mesh.vertex_count(), None);
    let mut queue = VecDeque::new();
    let mut visited = 0;
    for seed in places.ids().collect::<Vec<_>>() {
        if places[seed].is_some() {
            continue;
        }
        places[seed] = lookup
            .closest(&region.rest.positions[seed.index()])
            .map(|found| found.point);
        queue.push_back(seed);
        while let Some(vertex) = queue.pop_front() {
            visited += 1;
            if visited % PLACES_AT_A_TIME == 0 && !goes_on() {
                return None;
            }
            let Some(near) = places[vertex] else { continue };
            for &face in mesh.vertex_faces(vertex) {
                for next in mesh.faces()[face] {
                    if places[next].is_none() {
                        places[next] = place_near(&lookup, region, near.face, vertex, next);
                        queue.push_back(next);
                    }
                }
            }
        }
    }
    let anywhere = MaterialPoint::at_corner(FaceId(0), 0);
    let found = places.into_vec().into_iter();
    Some(found.map(|place| place.unwrap_or(anywhere)).collect())
}

fn place_near(
    lookup: &SurfaceLookup<'_>,
    region: &SkinMesh,
    start: FaceId,
    from: VertexId,
    to: VertexId,
) -> Option<MaterialPoint> {
    let [from, to] = [from, to].map(|v| region.rest.positions[v.index()]);
    let reach = 2.0 * (to - from).norm();
    lookup
        .closest_near(start, &to, reach)
        .or_else(|| lookup.closest(&to))
        .map(|found| found.point)
}

/// The mesh with a vertex for every fan of faces, and the old vertex of every new one.
///
/// Two parts of a region that touch at a vertex only have nothing to do with each other.
fn one_fan_per_vertex(mesh: &TriMesh) -> (TriMesh, Vec<VertexId>) {
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for face in mesh.faces().as_slice() {
        faces.push(face.map(|v| v.0));
    }
    let mut copied: Vec<VertexId> = (0..mesh.vertex_count()).map(VertexId::from_index).collect();
    for vertex in (0..mesh.vertex_count()).map(VertexId::from_index) {
        for fan in fans(mesh, vertex).into_iter().skip(1) {
            let copy = copied.len() as u32;
            copied.push(vertex);
            for face in fan {
                let corners = &mut faces[face.index()];
                let corner = corners.iter_mut().find(|corner| **corner == vertex.0);
                if let Some(corner) = corner {
                    *corner = copy;
                }
            }
        }
    }
    let split = TriMesh::new(copied.len(), faces);
    (
        split.expect("fans taken apart leave a manifold a manifold"),
        copied,
    )
}

/// The faces around a vertex, in groups that hang together by edges.
fn fans(mesh: &TriMesh, vertex: VertexId) -> Vec<Vec<FaceId>> {
    let mut left: Vec<FaceId> = mesh.vertex_faces(vertex).to_vec();
    let mut fans = Vec::new();
    while let Some(first) = left.first().copied() {
        let mut fan = vec![first];
        left.remove(0);
        let mut next = 0;
        while next < fan.len() {
            for corner in 0..3 {
                let neighbour = mesh.neighbour(fan[next], corner);
                if let Some(at) = left.iter().position(|&f| Some(f) == neighbour) {
                    fan.push(left.remove(at));
                }
            }
            next += 1;
        }
        fans.push(fan);
    }
    fans
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// A grid of 24 by 24 squares of side 1, each cut in two.
    fn grid() -> (TriMesh, Vec<Vector3<f64>>) {
        let at = |i: u32, j: u32| 25 * j + i;
        let mut faces = Vec::new();
        for (i, j) in (0..24).flat_map(|j| (0..24).map(move |i| (i, j))) {
            faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
        let positions = (0..625).map(|v| Vector3::new(f64::from(v % 25), f64::from(v / 25), 0.0));
        (
            TriMesh::new(625, faces).expect("a grid"),
            positions.collect(),
        )
    }

    /// Of a wave of 12 edges, the limit through corrected points loses little, the plain one much.
    #[test]
    fn a_wave_keeps_its_amplitude() {
        let (mesh, positions) = grid();
        let corners = PerVertex::filled(625, false);
        let at_vertices = limit_rows(&mesh, &corners).position;
        let height = |p: &Vector3<f64>| Vector3::z() * (TAU * p.x / 12.0).sin();
        let wave: Vec<_> = positions.iter().map(height).collect();
        let corrected = at_vertices.apply(&through_vertices(&at_vertices, &wave));
        let plain = at_vertices.apply(&wave);
        // A crest in the middle of the grid.
        let crest = 25 * 12 + 15;
        let loss = |found: &[Vector3<f64>]| 1.0 - found[crest].z / wave[crest].z;
        assert!(loss(&plain).abs() > 0.02, "{}", loss(&plain));
        assert!(loss(&corrected).abs() < 0.003, "{}", loss(&corrected));
    }

    /// Two triangles that share a vertex alone come apart there, and nowhere else.
    #[test]
    fn fans_come_apart() {
        let mesh = TriMesh::new(5, vec![[0, 1, 2], [2, 3, 4]]).expect("two triangles");
        let (split, copied) = one_fan_per_vertex(&mesh);
        assert_eq!(split.vertex_count(), 6);
        assert_eq!(copied[5], VertexId(2));
        assert_eq!(split.faces().as_slice()[0].map(|v| v.0), [0, 1, 2]);
        assert_eq!(split.faces().as_slice()[1].map(|v| v.0), [5, 3, 4]);
        let (mesh, _) = grid();
        assert_eq!(one_fan_per_vertex(&mesh).1.len(), 625);
    }
}
