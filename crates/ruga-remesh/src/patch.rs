//! The mesh while it is remeshed: connectivity, what each vertex carries, and the measures that
//! decide about an operation.

use nalgebra::{Matrix3, Vector3};
use ruga_mesh::{FaceId, MaterialPoint, PerVertex, VertexId};

use crate::closest::descend;
use crate::half_edges::{HalfEdges, NONE};
use crate::sizing::{area_of_squares, metric_length};
use crate::tensor3::Tensor3;
use crate::{Metric, RemeshError, SizeLimits, Sizing, Surface, SurfaceMesh};

/// Metric length above which an edge is split: its halves are as far below one as it is above.
const SPLIT_ABOVE: f64 = 1.4;
/// Metric length under which an edge is collapsed; half of what is just split stays.
const COLLAPSE_BELOW: f64 = 0.7;
/// Metric length above which an edge between two vertices of the old mesh is split. The distance to
/// [`SPLIT_ABOVE`] is a hysteresis: a mesh that was just made, or whose sizing changed by a few per
/// cent, is left alone.
const SPLIT_OLD_ABOVE: f64 = 1.48;
/// Metric length under which an edge between two vertices of the old mesh is collapsed.
const COLLAPSE_OLD_BELOW: f64 = 0.63;

/// Cosine between a face's normal and the surface's at its corners under which an operation may
/// only improve matters: 60 degrees, well before a face folds over.
const UPRIGHT: f64 = 0.5;

/// Data that every measure reads at a vertex, together so that it comes from memory together.
#[derive(Clone, Copy, Debug)]
struct Site {
    position: Vector3<f64>,
    normal: Vector3<f64>,
    tensor: Tensor3,
}

/// What a vertex carries at a place of the surface.
pub(crate) struct Placed {
    site: Site,
    pub(crate) point: MaterialPoint,
    /// Place on the old mesh.
    origin: MaterialPoint,
}

pub(crate) struct Patch<'a> {
    pub(crate) topology: HalfEdges,
    sites: Vec<Site>,
    pub(crate) points: Vec<MaterialPoint>,
    /// The old vertex that each vertex is or was; `NONE` for born ones.
    old_vertices: Vec<u32>,
    /// Place of each new vertex on the old mesh; `None` for an old vertex at its old place.
    origins: Vec<Option<MaterialPoint>>,
    pub(crate) old: &'a SurfaceMesh,
    sizing: &'a Sizing,
    surface: &'a dyn Surface,
    /// Metric asked at new vertices instead of `sizing`, and limits that its answers are held to.
    metric: Option<(&'a Metric<'a>, SizeLimits)>,
    /// Whether an edge may collapse onto its middle where neither end will do.
    pub(crate) may_ends_meet: bool,
}

impl<'a> Patch<'a> {
    /// # Errors
    /// [`RemeshError::NonManifoldVertex`] where no face or more than one fan of faces meets.
    pub(crate) fn new(
        old: &'a SurfaceMesh,
        sizing: &'a Sizing,
        surface: &'a dyn Surface,
    ) -> Result<Self, RemeshError> {
        let site = |(v, &position)| Site {
            position,
            normal: surface.normal(old.points[v]),
            tensor: Tensor3::from_matrix(&sizing.tensors[v]),
        };
        Ok(Self {
            topology: HalfEdges::new(&old.mesh, &old.features).map_err(|v| {
                RemeshError::NonManifoldVertex {
                    vertex: VertexId(v),
                }
            })?,
            sites: old.positions.iter().map(site).collect(),
            points: old.points.as_slice().to_vec(),
            old_vertices: (0..old.mesh.vertex_count() as u32).collect(),
            origins: vec![None; old.mesh.vertex_count()],
            old,
            sizing,
            surface,
            metric: None,
            may_ends_meet: false,
        })
    }

    /// Asks `metric` at new vertices from now on.
    pub(crate) fn ask(&mut self, metric: &'a Metric<'a>, limits: SizeLimits) {
        self.metric = Some((metric, limits));
    }

    pub(crate) fn position(&self, v: u32) -> Vector3<f64> {
        self.sites[v as usize].position
    }

    /// Sizing tensor at a vertex, 1/m².
    pub(crate) fn tensor(&self, v: u32) -> Tensor3 {
        self.sites[v as usize].tensor
    }

    /// Whether a vertex was born or set free in this remesh.
    pub(crate) fn is_new(&self, v: u32) -> bool {
        self.origins[v as usize].is_some()
    }

    pub(crate) fn is_fixed(&self, v: u32) -> bool {
        self.old_vertex(v).is_some_and(|old| self.old.fixed[old])
    }

    /// Whether a vertex is neither fixed nor on a border or feature.
    pub(crate) fn is_free(&self, v: u32) -> bool {
        !self.is_fixed(v) && self.topology.neighbours(v).all(|(_, feature)| !feature)
    }

    /// Place of a vertex on the old mesh.
    pub(crate) fn origin(&self, v: u32) -> MaterialPoint {
        self.origins[v as usize].unwrap_or_else(|| {
            self.old_vertex(v)
                .and_then(|old| MaterialPoint::of_vertex(&self.old.mesh, old))
                .expect("every old vertex has a face, which was checked when the patch was made")
        })
    }

    /// The old vertex that a vertex is, wherever it is now.
    pub(crate) fn old_vertex(&self, v: u32) -> Option<VertexId> {
        let old = self.old_vertices[v as usize];
        (old != NONE).then_some(VertexId(old))
    }

    /// Numbers vertices and faces along a curve that fills space, so that what is near on the
    /// surface is near in memory. Splits number them by the length of edges, and on a hundred
    /// thousand faces every pass after that would take twice as long.
    pub(crate) fn renumber(&mut self) {
        let place = places_on_curve(&self.sites);
        let mut order: Vec<u32> = (0..self.sites.len() as u32).collect();
        order.sort_by_key(|&v| place[v as usize]);
        self.topology.renumber(&order);
        self.sites = order.iter().map(|&v| self.sites[v as usize]).collect();
        self.points = order.iter().map(|&v| self.points[v as usize]).collect();
        self.origins = order.iter().map(|&v| self.origins[v as usize]).collect();
        self.old_vertices = order
            .iter()
            .map(|&v| self.old_vertices[v as usize])
            .collect();
    }

    /// The old vertex that a vertex is, at its old place.
    pub(crate) fn survivor(&self, v: u32) -> Option<VertexId> {
        // One that was moved has to be interpolated like a new one, however little it moved.
        self.old_vertex(v)
            .filter(|&old| self.position(v) == self.old.positions[old])
    }

    /// Lets edges collapse onto their middles from now on.
    pub(crate) fn let_ends_meet(&mut self) {
        self.may_ends_meet = true;
    }

    /// Lets an old vertex be moved like a new one.
    pub(crate) fn set_free(&mut self, v: u32) {
        if !self.is_fixed(v) {
            // An origin of its own is what marks a vertex as new.
            self.origins[v as usize] = Some(self.origin(v));
        }
    }

    /// Metric length between two vertices, with the mean of their tensors.
    pub(crate) fn length(&self, a: u32, b: u32) -> f64 {
        let (a, b) = (&self.sites[a as usize], &self.sites[b as usize]);
        // Of the tensors, not of two lengths: between vertices the field is their interpolation
        // (Narain et al. 2012), and one root does.
        let mean = (a.tensor + b.tensor) * 0.5;
        metric_length(&(b.position - a.position), &mean)
    }

    pub(crate) fn half_edge_length(&self, h: u32) -> f64 {
        self.length(self.topology.tail(h), self.topology.head(h))
    }

    /// Whether an edge is longer than its metric allows.
    pub(crate) fn is_long(&self, h: u32, length: f64) -> bool {
        // Hysteresis is for edges that were there before. What is made here is brought into the
        // narrower range, or the next remesh would find it at the bound.
        let is_old = !self.is_new(self.topology.tail(h)) && !self.is_new(self.topology.head(h));
        length > if is_old { SPLIT_OLD_ABOVE } else { SPLIT_ABOVE }
    }

    /// Whether an edge is shorter than its metric wants.
    pub(crate) fn is_short(&self, h: u32, length: f64) -> bool {
        let is_old = !self.is_new(self.topology.tail(h)) && !self.is_new(self.topology.head(h));
        length
            < if is_old {
                COLLAPSE_OLD_BELOW
            } else {
                COLLAPSE_BELOW
            }
    }

    /// Whether an operation may make an edge between two vertices.
    pub(crate) fn may_join(&self, a: u32, b: u32) -> bool {
        // The narrower bound for all: no operation makes what a split would undo.
        self.length(a, b) <= SPLIT_ABOVE
    }

    /// Shape of a triangle in the mean metric of its corners: 1 for equilateral, 0 for degenerate.
    pub(crate) fn quality(&self, [a, b, c]: [u32; 3]) -> f64 {
        // The sum will do: a shape is a ratio.
        let mean = self.tensor(a) + self.tensor(b) + self.tensor(c);
        let [p, q, r] = [a, b, c].map(|v| self.position(v));
        let [x, y, z] = [q - p, r - q, p - r].map(|e| mean.square(&e));
        let sum = x + y + z;
        if sum > 0.0 {
            // 4 sqrt(3) A / (sum of squared sides).
            6.928_203_230_275_509 * area_of_squares(x, y, z) / sum
        } else {
            0.0
        }
    }

    /// Smallest cosine between a face's normal and the surface's normals at its corners.
    pub(crate) fn uprightness(&self, corners: [u32; 3]) -> f64 {
        let [p, q, r] = corners.map(|v| self.position(v));
        let normal = (q - p).cross(&(r - p));
        let length = normal.norm();
        // A face without area is as bad as one that is turned over.
        if length == 0.0 {
            return -1.0;
        }
        let cosine = |v: u32| normal.dot(&self.sites[v as usize].normal) / length;
        corners.map(cosine).into_iter().fold(1.0, f64::min)
    }

    /// Whether faces with uprightness `after` may replace faces with `before`.
    pub(crate) fn stays_upright(before: f64, after: f64) -> bool {
        // However bad it was before, what is made may not be upside down.
        after >= UPRIGHT.min(before) && after > 0.0
    }

    /// Corners of the face of a half-edge, its tail first.
    pub(crate) fn corners(&self, h: u32) -> [u32; 3] {
        [
            self.topology.tail(h),
            self.topology.head(h),
            self.topology.apex(h),
        ]
    }

    /// The vertex that would split an edge: the place of the surface closest to its middle, of a feature the
    /// one on its curve.
    pub(crate) fn middle(&self, h: u32) -> Placed {
        let (a, b) = (self.topology.tail(h), self.topology.head(h));
        let middle = (self.position(a) + self.position(b)) * 0.5;
        let ends = [self.points[a as usize], self.points[b as usize]];
        // A feature's middle belongs on its curve; the closest place of the surface lies beside it.
        let point = if self.topology.is_feature(h) {
            self.surface.closest_on_feature(ends, middle)
        } else {
            // Across a sharp edge of the surface the way from one end may stop right below the middle,
            // on that end's side, where halves of halves would run into the edge and never cross it.
            let places = ends.map(|end| self.surface.closest(end, middle));
            let [first, second] =
                places.map(|place| (self.surface.position(place) - middle).norm());
            places[usize::from(second < first)]
        };
        self.placed(point, self.origin(a).face)
    }

    /// Splits an edge at its [`middle`](Self::middle); says whether it did: that place must be closer to
    /// both ends than they are to each other and fold no face over.
    pub(crate) fn try_split(&mut self, h: u32, middle: Placed) -> bool {
        let m = self.sites.len() as u32;
        // The vertex is put in before it is judged, since measures read vertices by number.
        self.sites.push(middle.site);
        self.points.push(middle.point);
        self.origins.push(Some(middle.origin));
        let is_sound = self.is_sound_split(h, m);
        if is_sound {
            self.topology.split(h);
            self.old_vertices.push(NONE);
        } else {
            self.sites.pop();
            self.points.pop();
            self.origins.pop();
        }
        is_sound
    }

    /// Says whether a surface put the middle `m` of an edge where it is of use.
    ///
    /// Refining a coarse mesh may tilt faces, and mends that as it goes on; only a face that turns
    /// over is refused.
    fn is_sound_split(&self, h: u32, m: u32) -> bool {
        let (a, b) = (self.topology.tail(h), self.topology.head(h));
        let distance = |v: u32, w: u32| (self.position(v) - self.position(w)).norm_squared();
        let is_between = distance(a, m).max(distance(m, b)) < distance(a, b);
        let mut sides = [Some(h), self.topology.twin(h)].into_iter().flatten();
        is_between
            && sides.all(|side| {
                let [tail, head, apex] = self.corners(side);
                let halves = [[tail, m, apex], [m, head, apex]].map(|f| self.uprightness(f));
                let after = halves[0].min(halves[1]);
                after > 0.0 || after >= self.uprightness([tail, head, apex])
            })
    }

    /// What a vertex carries at a place of the surface.
    ///
    /// `start` is the face of the old mesh where it was or where its edge began: a search over the whole mesh
    /// could land on a part that only comes near in space.
    fn placed(&self, point: MaterialPoint, start: FaceId) -> Placed {
        let (position, normal) = (self.surface.position(point), self.surface.normal(point));
        let old = self.old;
        let origin = descend(&old.mesh, old.positions.as_slice(), start, position);
        let asked = self
            .metric
            .as_ref()
            .and_then(|(metric, limits)| limits.hold(&metric(point, position), normal));
        let tensor = asked.unwrap_or_else(|| interpolate(old, &self.sizing.tensors, origin));
        Placed {
            site: Site {
                position,
                normal,
                tensor: tangent_part(tensor, normal),
            },
            point,
            origin,
        }
    }

    /// Moves a new vertex along the surface towards `target`; undone unless `accept` agrees.
    pub(crate) fn try_move(
        &mut self,
        v: u32,
        target: Vector3<f64>,
        accept: impl Fn(&Self) -> bool,
    ) -> bool {
        let wanted = self.surface.closest(self.points[v as usize], target);
        self.try_place(v, wanted, None, accept)
    }

    /// Moves the second of two vertices to their middle, with the mean of their tensors; undone
    /// unless `accept` agrees.
    ///
    /// The mean, not what the old mesh interpolates there: so what is refused here is refused
    /// again when this mesh has become the old one.
    pub(crate) fn try_merge(
        &mut self,
        [gone, kept]: [u32; 2],
        accept: impl Fn(&Self) -> bool,
    ) -> bool {
        let middle = (self.position(gone) + self.position(kept)) * 0.5;
        let mean = (self.tensor(gone) + self.tensor(kept)) * 0.5;
        let wanted = self.surface.closest(self.points[kept as usize], middle);
        self.try_place(kept, wanted, Some(mean), accept)
    }

    /// Puts a vertex at a place of the surface, with a tensor if one is given; undone unless
    /// `accept` agrees.
    fn try_place(
        &mut self,
        v: u32,
        wanted: MaterialPoint,
        tensor: Option<Tensor3>,
        accept: impl Fn(&Self) -> bool,
    ) -> bool {
        let i = v as usize;
        let (site, point, origin) = (self.sites[i], self.points[i], self.origins[i]);
        let placed = self.placed(wanted, self.origin(v).face);
        // Moved first and judged then, as `accept` measures the mesh as it would be.
        self.sites[i] = placed.site;
        self.points[i] = placed.point;
        self.origins[i] = Some(placed.origin);
        if let Some(tensor) = tensor {
            self.sites[i].tensor = tangent_part(tensor.matrix(), self.sites[i].normal);
        }
        let is_accepted = accept(self);
        if !is_accepted {
            (self.sites[i], self.points[i], self.origins[i]) = (site, point, origin);
        }
        is_accepted
    }
}

/// Place of each site on Morton's curve through the bounding box, in cells of a thousandth of its
/// longest side.
fn places_on_curve(sites: &[Site]) -> Vec<u32> {
    let first = sites
        .first()
        .map_or_else(Vector3::zeros, |site| site.position);
    let low = sites
        .iter()
        .fold(first, |low, site| low.inf(&site.position));
    let high = sites
        .iter()
        .fold(first, |high, site| high.sup(&site.position));
    // Ten bits for each axis: three times ten is what a u32 holds.
    let scale = 1023.0 / (high - low).max().max(f64::MIN_POSITIVE);
    let spread = |x: f64| {
        (0..10).fold(0u32, |sum, bit| {
            sum | (((x as u32 >> bit) & 1) << (3 * bit))
        })
    };
    sites
        .iter()
        .map(|site| (site.position - low) * scale)
        .map(|p| spread(p.x) | (spread(p.y) << 1) | (spread(p.z) << 2))
        .collect()
}

/// Linear interpolation of tensors on the old mesh.
fn interpolate(
    old: &SurfaceMesh,
    tensors: &PerVertex<Matrix3<f64>>,
    at: MaterialPoint,
) -> Matrix3<f64> {
    let corners = old.mesh.faces()[at.face];
    let mut sum = Matrix3::zeros();
    for (corner, weight) in corners.into_iter().zip(at.barycentric) {
        sum += tensors[corner] * weight;
    }
    sum
}

/// The tensor that ignores the part of an edge along `normal`.
fn tangent_part(tensor: Matrix3<f64>, normal: Vector3<f64>) -> Tensor3 {
    let projection = Matrix3::identity() - normal * normal.transpose();
    Tensor3::from_matrix(&(projection * tensor * projection))
}
