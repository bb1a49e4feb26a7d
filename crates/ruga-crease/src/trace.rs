//! Traces crease lines over the triangles of a surface.

use std::sync::OnceLock;

use nalgebra::{Vector2, Vector3};
use ruga_mesh::{
    FaceId, Id, MaterialPoint, PerFace, PlanarLookup, SurfaceLookup, TriMesh, VertexId,
};

use crate::layout_places::{BESIDE_UV, beside, longest_uv_side, onto_edges, uv_at};
use crate::line_input::{Corners, LineInput};
use crate::rounding::rounded;
use crate::walk::{Step, Stop, place_in, walk};
use crate::ways::{SpaceWay, UvWay};
use crate::{CreaseError, TracedLine};

/// Area of a triangle over its longest side squared below which it has none.
const LEAST_AREA: f64 = 1e-9;

/// Distance of the two points given on both sides of a seam, in longest sides of a triangle there, up to which
/// they are one place.
const SAME_PLACE: f64 = 0.25;

/// Distance of two points on a seam, in longest sides, up to which one place is likely to be meant, and times that they
/// are farther apart in the layout then.
const NEAR_SEAM: f64 = 2.0;
const FARTHER_BY_SEAM: f64 = 1.5;

/// Times that the two points of a seam are farther apart in the layout than on the surface, at the scale of the
/// triangles there. A step taken for a seam by mistake, where the layout is stretched, is walked in space.
const FARTHER: f64 = 4.0;

/// Step in the texture layout from a point on an edge to its sides.
const ASIDE: [f64; 2] = [3e-6, 2e-6];

/// Share of a line on the border at which it runs along it.
const MOST_ON_BORDER: f64 = 0.05;

/// Traces lines over a surface.
#[derive(Clone, Debug)]
pub struct LineTracer<'a> {
    mesh: &'a TriMesh,
    positions: &'a [Vector3<f64>],
    uvs: Option<&'a PerFace<[Vector2<f64>; 3]>>,
    space: SurfaceLookup<'a>,
    plane: OnceLock<PlanarLookup>,
}

impl<'a> LineTracer<'a> {
    /// A tracer for a mesh whose vertices are at `positions` (m).
    ///
    /// # Panics
    /// When there is not one position per vertex.
    pub fn new(mesh: &'a TriMesh, positions: &'a [Vector3<f64>]) -> Self {
        Self {
            mesh,
            positions,
            uvs: None,
            space: SurfaceLookup::new(mesh, positions),
            plane: OnceLock::new(),
        }
    }

    /// Adds texture coordinates per corner of every face.
    ///
    /// # Panics
    /// When there is not one entry per face.
    pub fn with_uvs(mut self, uvs: &'a PerFace<[Vector2<f64>; 3]>) -> Self {
        assert_eq!(uvs.len(), self.mesh.face_count(), "one entry per face");
        self.uvs = Some(uvs);
        self
    }

    /// Traces a line.
    ///
    /// # Errors
    /// Every [`CreaseError`] about points, seams, borders and triangles.
    pub fn trace(&self, line: &LineInput) -> Result<TracedLine, CreaseError> {
        let (steps, is_closed) = match line {
            LineInput::Uv {
                points,
                is_closed,
                corners,
            } => {
                check_points(points, *is_closed)?;
                (self.trace_uv(points, *is_closed, *corners)?, *is_closed)
            }
            LineInput::Positions {
                points,
                is_closed,
                reach,
                corners,
            } => {
                check_points(points, *is_closed)?;
                let curve = rounded(points, *is_closed, *corners);
                (self.trace_positions(&curve, *reach)?, *is_closed)
            }
            LineInput::Places { places, is_closed } => {
                let numbered = places.iter().copied().enumerate();
                let first = numbered.clone().next().filter(|_| *is_closed);
                let way: Vec<_> = numbered.chain(first).collect();
                (self.join(&way)?, *is_closed)
            }
            LineInput::Edges { vertices } => self.trace_edges(vertices)?,
        };
        self.finish(steps, is_closed)
    }

    /// The line along these steps.
    pub(crate) fn finish(
        &self,
        steps: Vec<Step>,
        is_closed: bool,
    ) -> Result<TracedLine, CreaseError> {
        self.check_faces(&steps)?;
        let traced = TracedLine::new(steps, is_closed, (self.mesh, self.positions));
        if traced.segments().is_empty() {
            return Err(CreaseError::ZeroLength);
        }
        self.check_border(&traced)?;
        Ok(traced)
    }

    fn trace_uv(
        &self,
        points: &[Vector2<f64>],
        is_closed: bool,
        corners: Corners,
    ) -> Result<Vec<Step>, CreaseError> {
        let uvs = self.texture()?;
        let jumps = self.jumps(uvs, points, is_closed)?;
        // A closed line that crosses seams is one run from its first jump on; runs between are smooth each.
        let count = points.len();
        let first = jumps.first().map_or(0, |jump| jump + 1);
        let order: Vec<_> = (0..count)
            .map(|i| if is_closed { (first + i) % count } else { i })
            .collect();
        let mut steps: Vec<Step> = Vec::new();
        let mut run = Vec::new();
        let mut runs = Vec::new();
        for &i in &order {
            run.push(i);
            if jumps.contains(&i) {
                runs.push(std::mem::take(&mut run));
            }
        }
        if !run.is_empty() {
            runs.push(run);
        }
        let is_ring = is_closed && jumps.is_empty();
        for run in runs {
            let of_run: Vec<_> = run.iter().map(|&i| points[i]).collect();
            let curve = rounded(&of_run, is_ring, corners);
            let place = |&(uv, i): &(Vector2<f64>, usize)| {
                let leg = run[i];
                let ends = [points[leg], points[(leg + 1) % count]];
                let found = self.locate(uvs, uv, leg);
                found.map_err(|error| self.off_island(uvs, (ends, leg), error))
            };
            let places = curve.iter().map(place).collect::<Result<Vec<_>, _>>()?;
            if let (Some(last), Some(next)) = (last_place(&steps), places.first()) {
                let leg = run[0].checked_sub(1).unwrap_or(count - 1);
                steps.extend(self.walk_in_space([last, *next], leg)?);
            }
            for (pair, ends) in curve.windows(2).zip(places.windows(2)) {
                let leg = run[pair[0].1];
                let found = self.walk_in_uv(uvs, [ends[0], ends[1]]);
                let ends = [points[leg], points[(leg + 1) % count]];
                steps.extend(found.map_err(|stop| self.stopped_between(uvs, ends, (stop, leg)))?);
            }
        }
        // The run after the last jump began with the first point after the first one.
        if let (true, Some(&leg), Some(first)) = (is_closed, jumps.first(), first_place(&steps))
            && let Some(last) = last_place(&steps)
        {
            steps.extend(self.walk_in_space([last, first], leg)?);
        }
        Ok(steps)
    }

    pub(crate) fn mesh(&self) -> &TriMesh {
        self.mesh
    }

    pub(crate) fn texture(&self) -> Result<&'a PerFace<[Vector2<f64>; 3]>, CreaseError> {
        self.uvs.ok_or(CreaseError::NoTextureCoordinates)
    }

    /// Finds places in the texture layout.
    pub(crate) fn plane(&self, uvs: &PerFace<[Vector2<f64>; 3]>) -> &PlanarLookup {
        self.plane.get_or_init(|| PlanarLookup::new(uvs.clone()))
    }

    /// The way straight in the texture layout.
    pub(crate) fn walk_in_uv(
        &self,
        uvs: &PerFace<[Vector2<f64>; 3]>,
        ends: [MaterialPoint; 2],
    ) -> Result<Vec<Step>, Stop> {
        let points = ends.map(|end| uv_at(uvs, &end));
        // Two points beside one corner of an island are that corner.
        if points[0] == points[1] {
            return Ok(Vec::new());
        }
        walk(self.mesh, &UvWay::new(uvs, self.mesh, points), ends)
    }

    /// Why the curve from one point of a line to the next is off all islands: the straight way is, too, or the
    /// curve reaches beyond a border.
    fn off_island(
        &self,
        uvs: &PerFace<[Vector2<f64>; 3]>,
        (ends, leg): ([Vector2<f64>; 2], usize),
        error: CreaseError,
    ) -> CreaseError {
        let [Ok(from), Ok(to)] = ends.map(|uv| self.locate(uvs, uv, leg)) else {
            return error;
        };
        match self.walk_in_uv(uvs, [from, to]) {
            Err(stop) => self.stopped_between(uvs, ends, (stop, leg)),
            Ok(_) => error,
        }
    }

    /// Why the way from one point of a line to the next stops: both may be meant as one place of a seam.
    fn stopped_between(
        &self,
        uvs: &PerFace<[Vector2<f64>; 3]>,
        points: [Vector2<f64>; 2],
        (stop, leg): (Stop, usize),
    ) -> CreaseError {
        let [Ok(from), Ok(to)] = points.map(|uv| self.locate(uvs, uv, leg)) else {
            return stopped(stop, leg);
        };
        let on_edges = [from, to].map(|place| place.barycentric.contains(&0.0));
        let [a, b] = [from, to].map(|place| place.interpolate(self.mesh, self.positions));
        let (distance, side) = ((b - a).norm(), self.longest_side(from.face));
        let step = (points[1] - points[0]).norm();
        let scale = longest_uv_side(&uvs[from.face]) / side;
        let is_seam = step > FARTHER_BY_SEAM * scale * distance;
        match on_edges == [true; 2] && is_seam && distance < NEAR_SEAM * side {
            true => CreaseError::ApartOnSeam { leg, distance },
            false => stopped(stop, leg),
        }
    }

    /// Legs that join the same place in two charts.
    fn jumps(
        &self,
        uvs: &PerFace<[Vector2<f64>; 3]>,
        points: &[Vector2<f64>],
        is_closed: bool,
    ) -> Result<Vec<usize>, CreaseError> {
        let count = points.len();
        let legs = if is_closed { count } else { count - 1 };
        let places = points
            .iter()
            .enumerate()
            .map(|(i, uv)| self.locate(uvs, *uv, i));
        let places = places.collect::<Result<Vec<_>, _>>()?;
        let is_jump = |&leg: &usize| {
            let ends = [places[leg], places[(leg + 1) % count]];
            let [a, b] = ends.map(|place| place.interpolate(self.mesh, self.positions));
            let near = SAME_PLACE * self.longest_side(ends[0].face);
            let step = (points[(leg + 1) % count] - points[leg]).norm();
            let distance = (b - a).norm();
            let is_farther = |end: &MaterialPoint| {
                let scale = longest_uv_side(&uvs[end.face]) / self.longest_side(end.face);
                step > FARTHER * scale * distance
            };
            distance <= near && step > BESIDE_UV && ends.iter().all(is_farther)
        };
        Ok((0..legs).filter(is_jump).collect())
    }

    /// The place of a point of the texture layout.
    pub(crate) fn locate(
        &self,
        uvs: &PerFace<[Vector2<f64>; 3]>,
        uv: Vector2<f64>,
        point: usize,
    ) -> Result<MaterialPoint, CreaseError> {
        let lookup = self.plane(uvs);
        let Some(first) = lookup.locate(uv) else {
            let outside = CreaseError::OutsideUv {
                point,
                uv: uv.into(),
            };
            return beside(uvs, uv).map(onto_edges).ok_or(outside);
        };
        let aside = Vector2::from(ASIDE);
        // On an edge charts that touch do not overlap, but those beside it may.
        for near in [uv, uv + aside, uv - aside] {
            let all = lookup.locate_all(near);
            let is_inside = |place: &MaterialPoint| place.barycentric.iter().all(|&b| b > 1e-9);
            let mut inside = all.filter(is_inside);
            if let (Some(one), Some(other)) = (inside.next(), inside.next()) {
                return Err(CreaseError::OverlappingCharts {
                    point,
                    uv: uv.into(),
                    faces: [one.face.0, other.face.0],
                });
            }
        }
        Ok(onto_edges(first))
    }

    fn trace_positions(
        &self,
        curve: &[(Vector3<f64>, usize)],
        reach: f64,
    ) -> Result<Vec<Step>, CreaseError> {
        if reach.is_nan() || reach <= 0.0 {
            return Err(CreaseError::OutOfRange {
                name: "reach",
                value: reach,
                range: "> 0",
            });
        }
        let place = |&(at, point): &(Vector3<f64>, usize)| {
            let found = self.space.closest(&at);
            let distance = found.map_or(f64::INFINITY, |found| found.distance);
            let found = found.filter(|found| found.distance <= reach);
            let found = found.ok_or(CreaseError::BeyondReach {
                point,
                distance,
                reach,
            })?;
            Ok((point, found.point))
        };
        let places = curve.iter().map(place).collect::<Result<Vec<_>, _>>()?;
        self.join(&places)
    }

    /// The ways from each of some places to the next; every place with the number of the point before it.
    fn join(&self, places: &[(usize, MaterialPoint)]) -> Result<Vec<Step>, CreaseError> {
        let mut steps = Vec::new();
        for ends in places.windows(2) {
            steps.extend(self.walk_in_space([ends[0].1, ends[1].1], ends[0].0)?);
        }
        Ok(steps)
    }

    /// The way in the plane through two places and the normal between them.
    pub(crate) fn walk_in_space(
        &self,
        ends: [MaterialPoint; 2],
        leg: usize,
    ) -> Result<Vec<Step>, CreaseError> {
        let [from, to] = ends.map(|place| place.interpolate(self.mesh, self.positions));
        if from == to && place_in(self.mesh, &ends[1], ends[0].face).is_some() {
            return Ok(Vec::new());
        }
        let normal = ends.iter().map(|end| {
            let [a, b, c] = self.corners(end.face);
            (b - a)
                .cross(&(c - a))
                .try_normalize(0.0)
                .unwrap_or_else(Vector3::zeros)
        });
        let way = SpaceWay {
            tracer: self,
            from,
            to: (to - from) / (to - from).norm_squared().max(f64::MIN_POSITIVE),
            across: normal.sum::<Vector3<f64>>().cross(&(to - from)),
        };
        walk(self.mesh, &way, ends).map_err(|stop| stopped(stop, leg))
    }

    fn trace_edges(&self, vertices: &[VertexId]) -> Result<(Vec<Step>, bool), CreaseError> {
        if vertices.len() < 2 {
            let count = vertices.len();
            return Err(CreaseError::TooFewPoints { count });
        }
        let unknown = |v: &&VertexId| v.index() >= self.mesh.vertex_count();
        if let Some(vertex) = vertices.iter().find(unknown) {
            return Err(CreaseError::UnknownVertex { vertex: vertex.0 });
        }
        let steps = vertices
            .windows(2)
            .map(|pair| self.edge_step([pair[0], pair[1]]));
        let steps = steps.collect::<Result<_, _>>()?;
        let is_closed = vertices.first() == vertices.last();
        match distinct(vertices) {
            count if is_closed && count < 3 => Err(CreaseError::TooFewPoints { count }),
            _ => Ok((steps, is_closed)),
        }
    }

    fn edge_step(&self, ends: [VertexId; 2]) -> Result<Step, CreaseError> {
        let faces = self.mesh.vertex_faces(ends[0]).iter();
        let corner = |face: FaceId, v| self.mesh.faces()[face].iter().position(|&w| w == v);
        let step = |&face: &FaceId| {
            let [from, to] = ends.map(|v| corner(face, v));
            let at = |corner| MaterialPoint::at_corner(face, corner).barycentric;
            (ends[0] != ends[1]).then_some((face, at(from?), at(to?)))
        };
        faces.clone().find_map(step).ok_or(CreaseError::NotAnEdge {
            vertices: ends.map(|v| v.0),
        })
    }

    pub(crate) fn corners(&self, face: FaceId) -> [Vector3<f64>; 3] {
        self.mesh.faces()[face].map(|v| self.positions[v.index()])
    }

    fn longest_side(&self, face: FaceId) -> f64 {
        let [a, b, c] = self.corners(face);
        (b - a).norm().max((c - b).norm()).max((a - c).norm())
    }

    fn check_faces(&self, steps: &[Step]) -> Result<(), CreaseError> {
        let is_flat = |face: FaceId| {
            let [a, b, c] = self.corners(face);
            let area = 0.5 * (b - a).cross(&(c - a)).norm();
            let least = LEAST_AREA * self.longest_side(face).powi(2);
            area.is_nan() || area <= least
        };
        match steps.iter().find(|step| is_flat(step.0)) {
            None => Ok(()),
            Some((face, ..)) => Err(CreaseError::DegenerateFace { face: face.0 }),
        }
    }

    /// Refuses a line of which more than a little lies on border edges.
    fn check_border(&self, line: &TracedLine) -> Result<(), CreaseError> {
        let on_border = line.segments().iter().filter(|segment| {
            (0..3).any(|corner| {
                let opposite = (corner + 2) % 3;
                let is_on = |b: &[f64; 3]| b[opposite].abs() < 1e-9;
                is_on(&segment.from)
                    && is_on(&segment.to)
                    && self.mesh.neighbour(segment.face, corner).is_none()
            })
        });
        let mut on_border = on_border.peekable();
        let first = on_border.peek().map(|segment| segment.face.0);
        let length: f64 = on_border.map(|segment| segment.length).sum();
        match first {
            Some(face) if length > MOST_ON_BORDER * line.length() => {
                Err(CreaseError::AlongBorder { face })
            }
            _ => Ok(()),
        }
    }
}

fn first_place(steps: &[Step]) -> Option<MaterialPoint> {
    let &(face, barycentric, _) = steps.first()?;
    Some(MaterialPoint { face, barycentric })
}

fn last_place(steps: &[Step]) -> Option<MaterialPoint> {
    let &(face, _, barycentric) = steps.last()?;
    Some(MaterialPoint { face, barycentric })
}

pub(crate) fn stopped(stop: Stop, leg: usize) -> CreaseError {
    match stop {
        Stop::Border(face) => CreaseError::LeavesSurface { leg, face: face.0 },
        Stop::Seam(face) => CreaseError::AcrossSeam { leg, face: face.0 },
        Stop::Lost => CreaseError::NoWay { leg },
    }
}

fn check_points<const D: usize>(
    points: &[nalgebra::SVector<f64, D>],
    is_closed: bool,
) -> Result<(), CreaseError> {
    let count = points.len();
    if count < if is_closed { 3 } else { 2 } {
        return Err(CreaseError::TooFewPoints { count });
    }
    let is_finite = |p: &nalgebra::SVector<f64, D>| p.iter().all(|c| c.is_finite());
    if let Some(point) = points.iter().position(|p| !is_finite(p)) {
        return Err(CreaseError::NotFinite { point });
    }
    match distinct(points) {
        1 => Err(CreaseError::ZeroLength),
        2 if is_closed => Err(CreaseError::TooFewPoints { count: 2 }),
        _ => Ok(()),
    }
}

/// How many points of a line differ, up to three: a ring of two is a way there and back.
fn distinct<T: PartialEq>(points: &[T]) -> usize {
    let Some(first) = points.first() else {
        return 0;
    };
    match points.iter().find(|p| *p != first) {
        None => 1,
        Some(second) if points.iter().all(|p| p == first || p == second) => 2,
        Some(_) => 3,
    }
}
