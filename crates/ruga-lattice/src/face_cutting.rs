//! Cuts the faces of a surface along the cells of a grid.

use nalgebra::Vector3;
use ruga_mesh::{EdgeId, FaceId, Id, TriMesh, VertexId};

use crate::grid::{Grid, Index, Plane};

/// Least distance of a corner from a plane that it does not lie on, as a share of a cell.
///
/// Far above rounding, so that no decision hangs on it; far below [`Grid`]'s room for moving.
pub(crate) const CLEARANCE: f64 = 1e-9;

/// A coincidence that another position of the grid avoids; where it was met.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coincidence(pub(crate) Vector3<f64>);

/// Identity of a fragment's corner. The names are the same in every fragment that has the corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Corner {
    Vertex(VertexId),
    /// Where a mesh edge crosses a plane.
    OnEdge(EdgeId, Plane),
    /// Where the face crosses a line of the grid: two planes, lower axis first.
    OnLine([Plane; 2]),
}

/// Line that the side from one corner to the next lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Edge(EdgeId),
    Cut(Plane),
}

/// The part of a face that lies in one cell: a convex polygon, counter-clockwise as the face.
#[derive(Clone, Debug)]
pub(crate) struct Fragment {
    pub(crate) face: FaceId,
    pub(crate) cell: Index,
    pub(crate) corners: Vec<Corner>,
    /// Positions of the corners, m.
    pub(crate) positions: Vec<Vector3<f64>>,
    /// Side `i` runs from corner `i` to the next.
    pub(crate) sides: Vec<Side>,
}

impl Fragment {
    /// A fan of triangles that makes it up.
    pub(crate) fn triangles(&self) -> impl Iterator<Item = [Vector3<f64>; 3]> + '_ {
        let first = self.positions[0];
        let pairs = self.positions[1..].windows(2);
        pairs.map(move |pair| [first, pair[0], pair[1]])
    }
}

/// Cuts every face; fragments come in the order of the faces, then of their cells.
///
/// Decisions compare a corner's coordinate with a plane's. Corners are computed from the mesh edge
/// or face and the planes that they lie on alone, so both faces at an edge decide alike and the
/// fragments fit together without gaps.
pub(crate) fn cut_faces(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    grid: &Grid,
) -> Result<Vec<Fragment>, Coincidence> {
    let knife = Knife {
        mesh,
        positions,
        grid,
    };
    let mut fragments = Vec::with_capacity(mesh.face_count());
    for face in mesh.faces().ids() {
        let mut parts = vec![knife.whole(face)];
        for axis in 0..3 {
            let mut thinner = Vec::with_capacity(parts.len());
            for part in parts {
                knife.slice(part, axis, &mut thinner)?;
            }
            parts = thinner;
        }
        fragments.extend(parts);
    }
    Ok(fragments)
}

struct Knife<'a> {
    mesh: &'a TriMesh,
    positions: &'a [Vector3<f64>],
    grid: &'a Grid,
}

impl Knife<'_> {
    fn whole(&self, face: FaceId) -> Fragment {
        let vertices = self.mesh.faces()[face];
        Fragment {
            face,
            cell: [0; 3],
            corners: vertices.map(Corner::Vertex).to_vec(),
            positions: vertices.map(|v| self.positions[v.index()]).to_vec(),
            sides: self.mesh.face_edges(face).map(Side::Edge).to_vec(),
        }
    }

    /// Cuts along every plane of one axis and says which cells the parts lie in.
    fn slice(
        &self,
        mut rest: Fragment,
        axis: usize,
        parts: &mut Vec<Fragment>,
    ) -> Result<(), Coincidence> {
        let along = || rest.positions.iter().map(|p| p[axis]);
        let low = along().fold(f64::INFINITY, f64::min);
        let high = along().fold(f64::NEG_INFINITY, f64::max);
        let guess = ((low - self.grid.origin[axis]) / self.grid.size[axis]) as u32;
        // The quotient may round up past a plane. One cell too low costs a comparison, one too high
        // a cut.
        rest.cell[axis] = guess.saturating_sub(1);
        for index in guess.saturating_sub(1) + 1..self.grid.counts[axis] {
            let plane = Plane { axis, index };
            let coordinate = self.grid.coordinate(plane);
            if coordinate >= high {
                break;
            }
            if coordinate > low {
                let (lower, upper) = self.split(&rest, plane)?;
                parts.push(lower);
                rest = upper;
            }
            rest.cell[axis] = index;
        }
        parts.push(rest);
        Ok(())
    }

    fn split(&self, whole: &Fragment, plane: Plane) -> Result<(Fragment, Fragment), Coincidence> {
        let coordinate = self.grid.coordinate(plane);
        let clearance = CLEARANCE * self.grid.size[plane.axis];
        let distance = |p: &Vector3<f64>| p[plane.axis] - coordinate;
        // A corner on the plane would fall to one side or the other by rounding, differently for
        // the faces around it. The grid moves instead.
        if let Some(&close) = (whole.positions.iter()).find(|p| distance(p).abs() <= clearance) {
            return Err(Coincidence(close));
        }
        let mut halves = [whole.empty(), whole.empty()];
        let mut crossings = 0;
        for (i, (&corner, &position)) in whole.corners.iter().zip(&whole.positions).enumerate() {
            let next = (i + 1) % whole.corners.len();
            let here = usize::from(distance(&position) > 0.0);
            let there = usize::from(distance(&whole.positions[next]) > 0.0);
            halves[here].push(corner, position, whole.sides[i]);
            if here != there {
                let (corner, position) = self.crossing(whole, i, plane);
                halves[here].push(corner, position, Side::Cut(plane));
                halves[there].push(corner, position, whole.sides[i]);
                crossings += 1;
            }
        }
        let [lower, upper] = halves;
        // A convex polygon crosses a plane twice. Whatever does otherwise is thinner than rounding.
        if crossings == 2 {
            Ok((lower, upper))
        } else {
            Err(Coincidence(whole.positions[0]))
        }
    }

    /// Where a side of a fragment crosses a plane.
    fn crossing(&self, whole: &Fragment, side: usize, plane: Plane) -> (Corner, Vector3<f64>) {
        match whole.sides[side] {
            Side::Edge(edge) => (Corner::OnEdge(edge, plane), self.on_edge(edge, plane)),
            Side::Cut(first) => {
                // Axes are cut in order, so that the earlier plane has the lower axis.
                let line = [first, plane];
                (Corner::OnLine(line), self.on_line(whole.face, line))
            }
        }
    }

    fn on_edge(&self, edge: EdgeId, plane: Plane) -> Vector3<f64> {
        // From the edge's own ends and not from the fragment's corners: the faces on both sides get
        // the same bits.
        let ends = self.mesh.edges()[edge].vertices;
        let ends = ends.map(|v| self.positions[v.index()]);
        between(ends, plane.axis, self.grid.coordinate(plane))
    }

    /// Where a face crosses the line of two planes: on its cut along the first.
    fn on_line(&self, face: FaceId, [first, second]: [Plane; 2]) -> Vector3<f64> {
        let coordinate = self.grid.coordinate(first);
        let mut ends = [Vector3::zeros(); 2];
        let mut found = 0;
        for edge in self.mesh.face_edges(face) {
            let [a, b] = self.mesh.edges()[edge].vertices;
            // Around a triangle the side changes twice or never, so that no third end is found.
            let is_below = |v: VertexId| self.positions[v.index()][first.axis] < coordinate;
            if is_below(a) != is_below(b) {
                ends[found % 2] = self.on_edge(edge, first);
                found += 1;
            }
        }
        between(ends, second.axis, self.grid.coordinate(second))
    }
}

impl Fragment {
    fn empty(&self) -> Self {
        Self {
            face: self.face,
            cell: self.cell,
            corners: Vec::with_capacity(self.corners.len() + 1),
            positions: Vec::with_capacity(self.corners.len() + 1),
            sides: Vec::with_capacity(self.corners.len() + 1),
        }
    }

    fn push(&mut self, corner: Corner, position: Vector3<f64>, side: Side) {
        self.corners.push(corner);
        self.positions.push(position);
        self.sides.push(side);
    }
}

/// The point of a segment at a coordinate that lies between those of its ends.
fn between(ends: [Vector3<f64>; 2], axis: usize, coordinate: f64) -> Vector3<f64> {
    let [a, b] = ends;
    let share = (coordinate - a[axis]) / (b[axis] - a[axis]);
    let mut point = a + (b - a) * share;
    // Exactly on the plane: comparisons with the same plane meet no rounding any more.
    point[axis] = coordinate;
    point
}
