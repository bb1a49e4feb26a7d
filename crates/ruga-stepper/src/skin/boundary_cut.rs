//! Cuts a mesh along the sharp boundaries of a painted map, so that each face lies on one side.
//!
//! Every edge that a boundary crosses gets a vertex there, and the faces around it are split. A boundary that
//! passes a vertex closely goes through it instead, because faces far smaller than the rest would help
//! nobody. What is still crossed, as by a band that passes between two vertices, is cut in further passes.
//! Then the edges on both sides of which the paint differs are features.
//!
//! Left as without cuts: corners of a boundary inside a face, which become chords, and what is finer
//! than a fifth of an edge.

use nalgebra::{Vector2, Vector3};
use ruga_blend::Driver;
use ruga_material::{BoundaryCrossing, PropertyMap, SHARP_RATIO, sharp_edges};
use ruga_mesh::{
    BornVertex, Edge, EdgeId, FaceId, Id, PerEdge, TriMesh, VertexId, mean_edge_lengths,
};

use crate::skin::piece::{Piece, Split, blend, edge_corner, uvs_of};

/// Distance of a crossing from a vertex, in edges, up to which the boundary goes through the vertex:
/// the mesh's error of place, and the least side of the faces that cutting makes.
const SNAP: f64 = 0.02;

/// Distance of a crossing, in edges, from a vertex that lies on the boundary already, up to which the
/// boundary goes through it. More than [`SNAP`], or the boundary would
/// leave along one edge of a vertex that another one has drawn it to, and turn by a right angle.
const SNAP_ON_BOUNDARY: f64 = 0.2;

/// Passes: three bands may lie across one edge.
const MOST_PASSES: usize = 6;

/// Fraction of a mesh's edges that boundaries may cross. Stripes of a whole wavelength cross one edge
/// in six; what crosses every third is finer than any wrinkle, or noise.
const MOST_CROSSED: f64 = 0.35;

/// Weights of the corners for a place inside a face that has one edge on a boundary: near the corner
/// off it, because antialiased paint is mixed for a texel or two beside the boundary.
const BESIDE: [f64; 2] = [0.15, 0.7];

/// A piece whose edges follow the boundaries.
pub(crate) struct Cut {
    pub(crate) piece: Piece,
    /// Edges across which the paint jumps.
    pub(crate) features: PerEdge<bool>,
}

impl Cut {
    /// The piece as it is.
    pub(crate) fn none(piece: Piece) -> Self {
        Self {
            features: PerEdge::filled(piece.mesh.edges().len(), false),
            piece,
        }
    }
}

/// Boundaries cross too many edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TooManyCrossings {
    /// Fraction of the edges.
    pub(crate) fraction: f64,
}

/// Whether a piece of the driver can be cut along the boundaries of `map`.
pub(crate) fn check_crossings(
    map: &PropertyMap,
    driver: &Driver,
    piece: Piece,
) -> Result<(), TooManyCrossings> {
    refuse_too_many(&Cutter::new(map, driver, piece).crossings())
}

/// `crossings` are those of every edge.
fn refuse_too_many(crossings: &[Vec<BoundaryCrossing>]) -> Result<(), TooManyCrossings> {
    let crossed = crossings.iter().filter(|found| !found.is_empty()).count();
    let fraction = crossed as f64 / crossings.len().max(1) as f64;
    match fraction > MOST_CROSSED {
        true => Err(TooManyCrossings { fraction }),
        false => Ok(()),
    }
}

/// Cuts a piece of the driver along the boundaries of `map`; a map without any leaves it as it is.
pub(crate) fn cut_along(
    map: &PropertyMap,
    driver: &Driver,
    piece: Piece,
) -> Result<Cut, TooManyCrossings> {
    let mut cutter = Cutter::new(map, driver, piece);
    for pass in 0..MOST_PASSES {
        let crossings = cutter.crossings();
        // Later passes look at faces that the first one made, of which many are crossed.
        if pass == 0 {
            refuse_too_many(&crossings)?;
        }
        // This is before any edge is cut, or one would be cut beside a vertex that the boundary
        // goes through.
        cutter.snap(&crossings);
        let places = cutter.places(&crossings);
        if places.iter().all(Option::is_none) {
            break;
        }
        cutter.cut(&places);
    }
    Ok(Cut {
        features: cutter.features(),
        piece: cutter.piece,
    })
}

/// Faces beside features, each with weights of its corners for a place well inside it.
pub(crate) fn faces_beside(mesh: &TriMesh, features: &PerEdge<bool>) -> Vec<(FaceId, [f64; 3])> {
    let mut on_feature = vec![false; mesh.vertex_count()];
    for (edge, _) in features.iter().filter(|(_, is_feature)| **is_feature) {
        for v in mesh.edges()[edge].vertices {
            on_feature[v.index()] = true;
        }
    }
    let faces = mesh.faces().iter();
    faces
        .filter_map(|(face, corners)| {
            let on = corners.map(|v| on_feature[v.index()]);
            on.contains(&true).then(|| (face, inside(on)))
        })
        .collect()
}

/// Weights of a face's corners, of which some are `on` a boundary, for a place inside.
fn inside(on: [bool; 3]) -> [f64; 3] {
    match on.iter().filter(|on| **on).count() {
        2 => on.map(|on| if on { BESIDE[0] } else { BESIDE[1] }),
        _ => [1.0 / 3.0; 3],
    }
}

struct Cutter<'a> {
    map: &'a PropertyMap,
    driver: &'a Driver,
    piece: Piece,
    /// On the driver's facets, m: lengths are all that is asked of them.
    positions: Vec<Vector3<f64>>,
    /// Mean length of the uncut edges around every vertex, m.
    sizes: Vec<f64>,
    on_boundary: Vec<bool>,
    /// Faces that the last pass made.
    is_new: Vec<bool>,
}

impl<'a> Cutter<'a> {
    fn new(map: &'a PropertyMap, driver: &'a Driver, piece: Piece) -> Self {
        let positions = piece.flat_positions(driver);
        let vertices = positions.len();
        Self {
            map,
            driver,
            sizes: mean_edge_lengths(&piece.mesh, &positions),
            positions,
            on_boundary: vec![false; vertices],
            is_new: vec![true; piece.mesh.face_count()],
            piece,
        }
    }

    /// Where boundaries cross every edge, from its first vertex on; none on an edge that lies on
    /// one, where rounding alone would decide.
    fn crossings(&self) -> Vec<Vec<BoundaryCrossing>> {
        let edges = self.piece.mesh.edges().iter();
        edges
            .map(|(id, edge)| {
                let is_new = edge.faces.iter().flatten().any(|f| self.is_new[f.index()]);
                let [a, b] = edge.vertices.map(|v| self.on_boundary[v.index()]);
                if !is_new || (a && b) {
                    return Vec::new();
                }
                self.crossings_of(id, edge)
            })
            .collect()
    }

    /// The crossings of one edge, on the side of a seam where the paint jumps most.
    fn crossings_of(&self, id: EdgeId, edge: &Edge) -> Vec<BoundaryCrossing> {
        let mut lines: Vec<[Vector2<f64>; 2]> = Vec::new();
        for &face in edge.faces.iter().flatten() {
            let line = self.line(face, id, edge);
            // Only at a seam do two faces read an edge at different places of the map.
            if !lines.contains(&line) {
                lines.push(line);
            }
        }
        let largest =
            |found: &[BoundaryCrossing]| found.iter().fold(0.0, |most: f64, c| most.max(c.ratio));
        let sides = lines.iter().map(|[from, to]| {
            let found = self.map.crossings(from, to, SHARP_RATIO);
            found.expect("the ratio is above 1")
        });
        sides
            .reduce(|best, other| match largest(&other) > largest(&best) {
                true => other,
                false => best,
            })
            .unwrap_or_default()
    }

    /// Texture coordinates of an edge's two vertices as one of its faces has them.
    fn line(&self, face: FaceId, id: EdgeId, edge: &Edge) -> [Vector2<f64>; 2] {
        let mesh = &self.piece.mesh;
        let corner = edge_corner(mesh, face, id);
        let uvs = uvs_of(self.driver, &self.piece.origins[face]);
        let [tail, head] = [uvs[corner], uvs[(corner + 1) % 3]];
        match mesh.faces()[face][corner] == edge.vertices[0] {
            true => [tail, head],
            false => [head, tail],
        }
    }

    /// Distances of a crossing from both ends of its edge, in edges of the uncut mesh.
    fn distances(&self, edge: &Edge, crossing: &BoundaryCrossing) -> [f64; 2] {
        let [a, b] = edge.vertices.map(Id::index);
        let length = (self.positions[b] - self.positions[a]).norm();
        // Distances are in edges of the uncut mesh: measured by its own shorter edges, every pass
        // would make smaller faces than the one before.
        let along = [crossing.parameter, 1.0 - crossing.parameter];
        [
            along[0] * length / self.sizes[a],
            along[1] * length / self.sizes[b],
        ]
    }

    /// Lets boundaries that pass a vertex closely go through it.
    fn snap(&mut self, crossings: &[Vec<BoundaryCrossing>]) {
        for (edge, found) in self.piece.mesh.edges().as_slice().iter().zip(crossings) {
            for crossing in found {
                let distances = self.distances(edge, crossing);
                for (v, distance) in edge.vertices.into_iter().zip(distances) {
                    if distance < SNAP {
                        self.on_boundary[v.index()] = true;
                    }
                }
            }
        }
    }

    /// Where each edge is to be cut, as a fraction of the way: at its largest jump.
    fn places(&self, crossings: &[Vec<BoundaryCrossing>]) -> Vec<Option<f64>> {
        let edges = self.piece.mesh.edges().as_slice().iter();
        edges
            .zip(crossings)
            .map(|(edge, found)| {
                let on = edge.vertices.map(|v| self.on_boundary[v.index()]);
                if on == [true; 2] {
                    return None;
                }
                let least = on.map(|on| if on { SNAP_ON_BOUNDARY } else { SNAP });
                let is_inside = |crossing: &&BoundaryCrossing| {
                    let distances = self.distances(edge, crossing);
                    distances[0] >= least[0] && distances[1] >= least[1]
                };
                let inside = found.iter().filter(is_inside);
                // One cut to an edge and pass. A further jump on it lies on one of the halves in
                // the next pass.
                let best = inside.reduce(|best, c| if c.ratio > best.ratio { c } else { best });
                best.map(|crossing| crossing.parameter)
            })
            .collect()
    }

    fn cut(&mut self, places: &[Option<f64>]) {
        let Split { born, parents } = self.piece.split(places, &mut self.positions);
        for BornVertex {
            ends: [a, b],
            fraction,
            ..
        } in born
        {
            let [a, b] = [a, b].map(|v| self.sizes[v.index()]);
            self.sizes.push(a + (b - a) * fraction);
            self.on_boundary.push(true);
        }
        // The parts of a face stand side by side.
        let is_part = |at: usize, beside: Option<usize>| {
            beside.is_some_and(|beside| parents.get(beside) == Some(&parents[at]))
        };
        let parts = 0..parents.len();
        self.is_new = parts
            .map(|at| is_part(at, at.checked_sub(1)) || is_part(at, Some(at + 1)))
            .collect();
    }

    /// Edges between vertices on a boundary, on both sides of which the paint differs.
    fn features(&self) -> PerEdge<bool> {
        let mesh = &self.piece.mesh;
        let is_on = |v: VertexId| self.on_boundary[v.index()];
        let faces = mesh.faces().iter();
        let values: Vec<_> = faces
            .map(|(face, corners)| {
                let uvs = uvs_of(self.driver, &self.piece.origins[face]);
                self.map.sample(&blend(&uvs, inside(corners.map(is_on))))
            })
            .collect();
        let pair = |edge: &Edge| match edge.vertices.map(is_on) {
            [true, true] => edge.faces.map(|face| face.map(Id::index)),
            _ => [None; 2],
        };
        let pairs: Vec<_> = mesh.edges().as_slice().iter().map(pair).collect();
        // A thin face is inside the mixed paint beside the boundary, and has half of the jump.
        let sharp = sharp_edges(&pairs, &values, SHARP_RATIO.sqrt());
        sharp.expect("the ratio is above 1").into()
    }
}
