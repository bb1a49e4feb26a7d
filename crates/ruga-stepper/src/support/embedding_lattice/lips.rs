//! On which lip of a slit places of a driver's surface lie.
//!
//! Slits run along chords of their lines, and meshes of layers have other chords of the same lines. What is between a
//! chord and its line would lie on the other lip than its neighbours. So the line itself says on which lip a place is.

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_crease::TracedLine;
use ruga_mesh::{FaceId, FaceOrigin, Id, MaterialPoint, PerFace, TriMesh};

/// Distance from a line, in edges of the lattice's surface there, up to which places are on it, and so on the left: as
/// far beside it as a mesh with edges twice as long leaves its vertices.
const NEAR_LINE: f64 = 0.02;

/// Barycentric coordinate up to which a place is on an edge of the driver: rounding.
const ON_EDGE: f64 = 1e-9;

/// Share by which distances from parts of a line differ that are the same: rounding.
const SAME: f64 = 1e-9;

/// One of the two lips of a slit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lip {
    /// That to the left of its line, and skin on the line itself.
    Left,
    Right,
}

/// The lines of slits, and the faces of a lattice's surface beside them.
#[derive(Clone, Debug)]
pub(super) struct Lips {
    driver: TriMesh,
    rest: Vec<Vector3<f64>>,
    /// Ends of the parts of lines in every face of the driver, m.
    parts: PerFace<Vec<[Vector3<f64>; 2]>>,
    /// Distance from a line up to which places of every face of the driver are on it, m.
    near: PerFace<f64>,
    /// Whether faces of the lattice's surface touch the left lip of a slit, and the right one.
    touches: PerFace<[bool; 2]>,
}

impl Lips {
    /// Those of slits along `lines`, on a surface with faces in these places of the driver's.
    pub(super) fn new<'a>(
        driver: &Driver,
        lines: impl Iterator<Item = &'a TracedLine>,
        (origins, touches): (&PerFace<FaceOrigin>, PerFace<[bool; 2]>),
    ) -> Self {
        let (mesh, rest) = (driver.topology(), driver.rest());
        let mut counts = PerFace::filled(mesh.face_count(), 0);
        for (_, origin) in origins.iter() {
            counts[origin.face] += 1;
        }
        let near = mesh.faces().iter().map(|(face, corners)| {
            let [a, b, c] = corners.map(|v| rest[v.index()]);
            let square: f64 = (b - a).cross(&(c - a)).norm() / f64::from(counts[face].max(1));
            NEAR_LINE * square.sqrt()
        });
        let mut parts = PerFace::filled(mesh.face_count(), Vec::new());
        for segment in lines.flat_map(TracedLine::segments) {
            let ends = [0.0, 1.0].map(|share| segment.place(share).interpolate(mesh, rest));
            parts[segment.face].push(ends);
        }
        Self {
            near: near.collect(),
            parts,
            driver: mesh.clone(),
            rest: rest.to_vec(),
            touches,
        }
    }

    /// A place by all faces of the driver that have it: on an edge two, in a corner those around it.
    pub(super) fn addresses(&self, point: &MaterialPoint) -> Vec<MaterialPoint> {
        let corners = self.driver.faces()[point.face].into_iter();
        let on = corners.zip(point.barycentric);
        let on: Vec<_> = on.filter(|(_, weight)| *weight > ON_EDGE).collect();
        let mut found = vec![*point];
        if on.len() == 3 || on.is_empty() {
            return found;
        }
        for &face in self.driver.vertex_faces(on[0].0) {
            let corners = self.driver.faces()[face];
            let has_all = on.iter().all(|(v, _)| corners.contains(v));
            if has_all && face != point.face {
                let weight = |v| on.iter().find(|on| on.0 == v).map_or(0.0, |on| on.1);
                let barycentric = corners.map(weight);
                found.push(MaterialPoint { face, barycentric });
            }
        }
        found
    }

    /// The lip on which a place with these addresses is, by the part of a line that is nearest to it; `None` where its
    /// faces have no line.
    pub(super) fn of(&self, addresses: &[MaterialPoint]) -> Option<Lip> {
        let mut nearest: Option<(f64, f64, f64)> = None;
        for address in addresses {
            let [a, b, c] = self.driver.faces()[address.face].map(|v| self.rest[v.index()]);
            let normal = (b - a).cross(&(c - a)).try_normalize(0.0);
            let here = address.interpolate(&self.driver, &self.rest);
            for part in &self.parts[address.face] {
                let (distance, left) = from_part(&here, part, &normal.unwrap_or_default());
                let is_nearer = nearest.is_none_or(|(least, most, _)| {
                    // Where a line turns, both parts are as far from what is outside of the turn. That which goes more
                    // across the way there tells the side, however sharp the turn.
                    let is_same = (distance - least).abs() <= SAME * least;
                    if is_same {
                        left.abs() > most.abs()
                    } else {
                        distance < least
                    }
                });
                if is_nearer {
                    nearest = Some((distance, left, self.near[address.face]));
                }
            }
        }
        nearest.map(
            |(distance, left, near)| match left >= 0.0 || distance <= near {
                true => Lip::Left,
                false => Lip::Right,
            },
        )
    }

    /// Whether a face of the lattice's surface touches the other lip and not this one.
    pub(super) fn is_across(&self, face: FaceId, lip: Lip) -> bool {
        let other = match lip {
            Lip::Left => [false, true],
            Lip::Right => [true, false],
        };
        self.touches[face] == other
    }
}

/// Distance of a place from a part of a line, and how far it is to the left of the straight line through that (m), seen
/// from where the `normal` of both points.
fn from_part(
    here: &Vector3<f64>,
    [from, to]: &[Vector3<f64>; 2],
    normal: &Vector3<f64>,
) -> (f64, f64) {
    let (way, along) = (here - from, to - from);
    let share = way.dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
    let distance = (way - along * share.clamp(0.0, 1.0)).norm();
    let left = normal.cross(&along).dot(&way) / along.norm().max(f64::MIN_POSITIVE);
    (distance, left)
}
