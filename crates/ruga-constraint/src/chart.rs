//! The surface around a centre, laid out in its tangent plane and cut to what the centre sees.

use nalgebra::{Vector2, Vector3};
use ruga_mesh::{FaceId, Id, TangentCentre, TriMesh, VertexId, tangent_coordinates};

use crate::centre::Centre;

/// Faces whose edges change length by more than this factor in the chart straddle its far side,
/// where coordinates coming around a finger from two sides meet.
const LARGEST_STRETCH: f64 = 1.5;
/// Part of a product of lengths below which a cross product counts as zero.
const PARALLEL: f64 = 1e-12;

/// Makes charts of one mesh.
pub(crate) struct Charts<'a> {
    mesh: &'a TriMesh,
    positions: &'a [Vector3<f64>],
    normals: &'a [Vector3<f64>],
    /// Longest edge at each vertex, m.
    reach: &'a [f64],
    /// Place of each vertex in the chart being made; `ABSENT` outside.
    slots: Vec<u32>,
}

const ABSENT: u32 = u32::MAX;

/// A neighbourhood in the tangent plane of its centre, which is the origin.
pub(crate) struct Chart {
    /// Vertices, ascending.
    pub(crate) vertices: Vec<VertexId>,
    /// Their places, m.
    pub(crate) places: Vec<Vector2<f64>>,
    /// The faces that the centre sees, as indices into `vertices`.
    pub(crate) faces: Vec<[u32; 3]>,
    /// True where a border of the surface comes nearer than the radius asked for.
    pub(crate) is_clipped: bool,
}

/// Longest edge at each vertex, m.
pub(crate) fn reach(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Vec<f64> {
    let mut reach = vec![0.0_f64; mesh.vertex_count()];
    for (_, edge) in mesh.edges().iter() {
        let [a, b] = edge.vertices.map(Id::index);
        let length = (positions[a] - positions[b]).norm();
        reach[a] = reach[a].max(length);
        reach[b] = reach[b].max(length);
    }
    reach
}

impl<'a> Charts<'a> {
    /// For a mesh in which the longest edge at every vertex is its [`reach`].
    pub(crate) fn new(
        mesh: &'a TriMesh,
        positions: &'a [Vector3<f64>],
        normals: &'a [Vector3<f64>],
        reach: &'a [f64],
    ) -> Self {
        Self {
            mesh,
            positions,
            normals,
            reach,
            slots: vec![ABSENT; mesh.vertex_count()],
        }
    }

    /// Everything within `radius` of `centre`, with all faces that touch that disc.
    pub(crate) fn around(&mut self, centre: &Centre, radius: f64) -> Chart {
        let (vertices, places) = self.lay_out(centre, radius);
        for (slot, vertex) in vertices.iter().enumerate() {
            self.slots[vertex.index()] = slot as u32;
        }
        let mut chart = Chart {
            vertices,
            places,
            faces: Vec::new(),
            is_clipped: false,
        };
        let borders = self.collect_faces(&mut chart, radius);
        chart.is_clipped = !borders.is_empty();
        // Without a border near by all of the disc is seen, which spares most centres the test of
        // every face against every border.
        if chart.is_clipped {
            chart.hide(centre, &borders);
        }
        // Only what was set is cleared: all slots would cost the whole mesh for each centre.
        for vertex in &chart.vertices {
            self.slots[vertex.index()] = ABSENT;
        }
        chart
    }

    fn tangent_centre(&self, centre: &Centre) -> TangentCentre {
        TangentCentre {
            origin: centre.interpolate(self.positions),
            normal: centre.interpolate(self.normals).normalize(),
            axis: centre.axis(self.mesh, self.positions),
            around: match centre.weights() {
                [(own, _)] => vec![*own],
                _ => centre.neighbours(self.mesh).collect(),
            },
        }
    }

    fn lay_out(&self, centre: &Centre, radius: f64) -> (Vec<VertexId>, Vec<Vector2<f64>>) {
        let place = self.tangent_centre(centre);
        let own_reach = centre
            .carriers()
            .fold(0.0_f64, |m, v| m.max(self.reach[v.index()]));
        // A guess that holds where edges are alike; longer ones further out make the loop go on.
        let mut laid_out = radius + 2.0 * own_reach;
        loop {
            let found =
                tangent_coordinates(self.mesh, self.positions, self.normals, &place, laid_out);
            // A face that touches the disc has its corners within one edge of a vertex inside it,
            // or spans it whole.
            let longest = found
                .iter()
                .filter(|found| found.place.norm() <= radius)
                .fold(0.0_f64, |m, found| m.max(self.reach[found.vertex.index()]));
            if radius + longest <= laid_out {
                return found.into_iter().map(|f| (f.vertex, f.place)).unzip();
            }
            // A little more than needed, or rounding could ask for another round.
            laid_out = radius + 1.001 * longest;
        }
    }

    /// Adds the faces that lie whole and sound in the chart; returns the border edges near by, the
    /// surface to their left.
    fn collect_faces(&self, chart: &mut Chart, radius: f64) -> Vec<[Vector2<f64>; 2]> {
        let mut borders = Vec::new();
        for &vertex in &chart.vertices {
            for &face in self.mesh.vertex_faces(vertex) {
                let corners = self.mesh.faces()[face];
                let slots = corners.map(|v| self.slots[v.index()]);
                // A face is met at each of its corners; it is taken at the lowest.
                let is_first = corners.iter().all(|&v| v >= vertex);
                if !is_first || slots.contains(&ABSENT) {
                    continue;
                }
                let places = slots.map(|s| chart.places[s as usize]);
                if !self.is_sound(face, places) {
                    continue;
                }
                chart.faces.push(slots);
                for corner in 0..3 {
                    let segment = [places[corner], places[(corner + 1) % 3]];
                    let is_border = self.mesh.neighbour(face, corner).is_none();
                    if is_border && distance_from_origin(segment) < radius {
                        borders.push(segment);
                    }
                }
            }
        }
        borders
    }

    fn is_sound(&self, face: FaceId, places: [Vector2<f64>; 3]) -> bool {
        let points = self.mesh.faces()[face].map(|v| self.positions[v.index()]);
        let is_kept = (0..3).all(|i| {
            let j = (i + 1) % 3;
            let (flat, true_length) = (
                (places[j] - places[i]).norm(),
                (points[j] - points[i]).norm(),
            );
            flat <= LARGEST_STRETCH * true_length && true_length <= LARGEST_STRETCH * flat
        });
        // Clockwise faces lie where the chart has folded over: no stretch of edges shows that.
        is_kept && cross(places[1] - places[0], places[2] - places[0]) > 0.0
    }
}

impl Chart {
    /// Drops the faces that the centre doesn't see: those behind a slit, a hole or a bay.
    ///
    /// A face counts by its middle, so that the two lips of a closed slit stay apart.
    fn hide(&mut self, centre: &Centre, borders: &[[Vector2<f64>; 2]]) {
        // A border that the centre lies on hides nothing, being at no distance; only the centre's
        // own faces tell inwards from outwards there.
        let own_sectors = self.own_sectors(centre);
        let places = &self.places;
        self.faces.retain(|face| {
            let middle = face
                .iter()
                .fold(Vector2::zeros(), |sum, &s| sum + places[s as usize])
                / 3.0;
            let leaves_inwards = own_sectors
                .iter()
                .any(|[right, left]| cross(*right, middle) >= 0.0 && cross(middle, *left) >= 0.0);
            leaves_inwards && !borders.iter().any(|&border| is_behind(middle, border))
        });
    }

    /// The directions in which the faces at the centre lie: from the centre they are seen through
    /// the edges that it doesn't lie on.
    fn own_sectors(&self, centre: &Centre) -> Vec<[Vector2<f64>; 2]> {
        let own: Vec<u32> = centre
            .carriers()
            .filter_map(|v| Some(self.vertices.binary_search(&v).ok()? as u32))
            .collect();
        let holds = |corners: &[u32]| own.iter().all(|slot| corners.contains(slot));
        let edges = self.faces.iter().filter(|face| holds(&face[..]));
        edges
            .flat_map(|face| (0..3).map(|i| [face[i], face[(i + 1) % 3]]))
            .filter(|edge| !holds(&edge[..]))
            .map(|edge| edge.map(|slot| self.places[slot as usize]))
            .collect()
    }

    /// One flag per vertex: whether it belongs to a face that the centre sees.
    pub(crate) fn seen_vertices(&self) -> Vec<bool> {
        let mut seen = vec![false; self.vertices.len()];
        for &slot in self.faces.iter().flatten() {
            seen[slot as usize] = true;
        }
        seen
    }
}

/// Says whether the straight way from the origin to `point` leaves the surface through `border`.
fn is_behind(point: Vector2<f64>, [tail, head]: [Vector2<f64>; 2]) -> bool {
    let along = head - tail;
    let zero = PARALLEL * along.norm_squared();
    // The surface lies to the left of a border: negative is outside.
    let ends_outside = cross(along, point - tail) < -zero;
    let starts_inside = cross(along, -tail) > zero;
    // Closed at both ends: nothing slips through between two edges of a border.
    ends_outside && starts_inside && cross(point, tail) * cross(point, head) <= 0.0
}

fn distance_from_origin([tail, head]: [Vector2<f64>; 2]) -> f64 {
    let along = head - tail;
    let part = -tail.dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
    (tail + along * part.clamp(0.0, 1.0)).norm()
}

fn cross(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}
