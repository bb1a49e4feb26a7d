//! How far apart two meshes of a skin draw the same crease line.
//!
//! Each has chords of the line, of its own lengths. What lies between them is on one side of the line in the one mesh
//! and on the other side in the other: read where it is, a vertex on the line would be some way up a flank, and
//! one closely beside it on the wrong flank.

use std::collections::{BTreeMap, VecDeque};

use nalgebra::Vector3;
use ruga_mesh::{EdgeId, Id, MaterialPoint, VertexId};

use crate::skin::fading::faded;
use crate::skin::skin_mesh::SkinMesh;

/// Distance from a line, in edges along it, over which a shift fades. A chord is off its line by an
/// eighth of the angle that it turns by: at 10 degrees, and this reach, slopes beside it change by one in a hundred.
const REACH: f64 = 2.0;

/// Share of an edge along a line beyond which what is nearest is not the same place of it.
const FARTHEST: f64 = 0.25;

/// Where one mesh has the places that another has on and beside its crease lines.
pub(super) struct LineShift {
    /// What brings a line of the one mesh onto that of the other, at every vertex of the first (m).
    pub(super) shifts: Vec<Vector3<f64>>,
    /// The vertices on lines, with their places on edges of the other mesh.
    pub(super) on_line: Vec<(VertexId, MaterialPoint)>,
}

/// The shift of a vertex on a line (m), and the distance over which it fades (m).
#[derive(Clone, Copy)]
struct Source {
    shift: Vector3<f64>,
    reach: f64,
}

/// A crease edge near a vertex.
#[derive(Clone, Copy)]
struct Nearest {
    edge: usize,
    distance: f64,
    /// Share of the way along it.
    share: f64,
}

impl LineShift {
    /// Shifts from the vertices of `to` to the places of `from`, both at rest.
    pub(super) fn new(from: &SkinMesh, to: &SkinMesh) -> Self {
        let mut found = Self {
            shifts: vec![Vector3::zeros(); to.mesh.vertex_count()],
            on_line: Vec::new(),
        };
        let sources = found.sources(from, to);
        for (v, nearest) in nearest_edges(to, &sources).into_iter().enumerate() {
            let Some(nearest) = nearest else { continue };
            let ends = to.mesh.edges()[to.creases[nearest.edge].edge].vertices;
            let [a, b] = ends.map(|end| sources.get(&end));
            if let (Some(a), Some(b)) = (a, b) {
                let reach = a.reach + (b.reach - a.reach) * nearest.share;
                let left = 1.0 - faded(nearest.distance, reach);
                found.shifts[v] = a.shift.lerp(&b.shift, nearest.share) * left;
            }
        }
        for (&v, source) in &sources {
            found.shifts[v.index()] = source.shift;
        }
        found
    }

    /// The shifts of the vertices on lines that the other mesh has as well.
    fn sources(&mut self, from: &SkinMesh, to: &SkinMesh) -> BTreeMap<VertexId, Source> {
        let mut chords: BTreeMap<usize, Vec<Chord>> = BTreeMap::new();
        for crease in &from.creases {
            let ends = from.mesh.edges()[crease.edge].vertices;
            let ends = ends.map(|v| from.rest.positions[v.index()]);
            let chord = (crease.edge, ends);
            chords.entry(crease.line).or_default().push(chord);
        }
        let mut sources = BTreeMap::new();
        for crease in &to.creases {
            for v in to.mesh.edges()[crease.edge].vertices {
                if sources.contains_key(&v) {
                    continue;
                }
                let here = to.rest.positions[v.index()];
                let on_line = chords.get(&crease.line).map_or(&[][..], Vec::as_slice);
                if let Some((place, shift, length)) = nearest_on_line(from, on_line, &here) {
                    let reach = REACH * length;
                    sources.insert(v, Source { shift, reach });
                    self.on_line.push((v, place));
                }
            }
        }
        sources
    }
}

/// An edge on a crease line, and the places of its ends.
type Chord = (EdgeId, [Vector3<f64>; 2]);

/// The nearest place on the edges that a mesh has on a line, the way there (m), and the length of the edge (m).
fn nearest_on_line(
    skin: &SkinMesh,
    chords: &[Chord],
    here: &Vector3<f64>,
) -> Option<(MaterialPoint, Vector3<f64>, f64)> {
    let found = chords
        .iter()
        .map(|&(edge, chord)| (edge, chord, foot(here, chord)));
    let (edge, [a, b], (_, share)) = found.min_by(|a, b| a.2.0.total_cmp(&b.2.0))?;
    let (shift, length) = (a.lerp(&b, share) - here, (b - a).norm());
    let (face, corner) = skin.mesh.edge_sides(edge)[0]?;
    let first = skin.mesh.edges()[edge].vertices[0];
    let is_along = skin.mesh.faces()[face][corner] == first;
    let share = if is_along { share } else { 1.0 - share };
    let mut barycentric = [0.0; 3];
    barycentric[corner] = 1.0 - share;
    barycentric[(corner + 1) % 3] = share;
    let place = MaterialPoint { face, barycentric };
    (shift.norm() < FARTHEST * length).then_some((place, shift, length))
}

/// Distance of a place from a segment, and the share of the way along it at which that is.
fn foot(p: &Vector3<f64>, [a, b]: [Vector3<f64>; 2]) -> (f64, f64) {
    let along = b - a;
    let share = (p - a).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
    let share = share.clamp(0.0, 1.0);
    ((p - a - along * share).norm(), share)
}

/// The nearest crease edge of every vertex within reach of one, found from vertex to vertex.
fn nearest_edges(skin: &SkinMesh, sources: &BTreeMap<VertexId, Source>) -> Vec<Option<Nearest>> {
    let mut nearest: Vec<Option<Nearest>> = vec![None; skin.mesh.vertex_count()];
    let mut queue = VecDeque::new();
    let mut offer = |v: VertexId, edge: usize, queue: &mut VecDeque<_>| {
        let ends = skin.mesh.edges()[skin.creases[edge].edge].vertices;
        let reach = ends.map(|end| sources.get(&end).map_or(0.0, |source| source.reach));
        let chord = ends.map(|end| skin.rest.positions[end.index()]);
        let (distance, share) = foot(&skin.rest.positions[v.index()], chord);
        let known = nearest[v.index()].map_or(f64::INFINITY, |known| known.distance);
        // Along a line the next edge is as near at their common end.
        if distance < known && distance < reach[0].min(reach[1]) {
            nearest[v.index()] = Some(Nearest {
                edge,
                distance,
                share,
            });
            queue.push_back((v, edge));
        }
    };
    for (edge, crease) in skin.creases.iter().enumerate() {
        for v in skin.mesh.edges()[crease.edge].vertices {
            offer(v, edge, &mut queue);
        }
    }
    while let Some((v, edge)) = queue.pop_front() {
        for &face in skin.mesh.vertex_faces(v) {
            for next in skin.mesh.faces()[face]
                .into_iter()
                .filter(|&next| next != v)
            {
                // Edges on one line follow each other.
                for beside in edge.saturating_sub(1)..(edge + 2).min(skin.creases.len()) {
                    offer(next, beside, &mut queue);
                }
            }
        }
    }
    nearest
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use nalgebra::{Matrix3, Vector2};
    use ruga_blend::{BaseSurface, Smoothing};
    use ruga_crease::{Corners, CreaseMemory, Drive, LineInput, LineLaw, LineTracer};
    use ruga_mesh::PerFace;
    use ruga_remesh::{FaceDriver, Refinement, RemeshSettings};
    use ruga_shell::FoldSense;

    use super::*;
    use crate::skin::interpolation::Interpolation;
    use crate::skin::interpolation::Values;
    use crate::skin::piece::Piece;
    use crate::skin::skin_mesh::{RegionMesh, SizingStrains};
    use crate::test_drivers::{SIDE, knuckle, square};
    use crate::{CreaseSpec, LayerSpec};

    const RADIUS: f64 = 0.25 * SIDE;

    /// Length over which the flanks of the fold flatten (m).
    const FLANK: f64 = 0.2 * SIDE;

    /// A fold of 90 degrees along a ring, on a mesh whose edges turn by 10 degrees along it, is one on a
    /// mesh with shorter edges: as deep everywhere, and as steep beside.
    #[test]
    fn a_round_fold_is_transferred_without_scallops() {
        let flat = |p: Vector2<f64>| Vector3::new(p.x, p.y, 0.0);
        let driver = square(&flat, &flat);
        let points = (0..72).map(|i| {
            let (sin, cos) = (TAU * f64::from(i) / 72.0).sin_cos();
            Vector2::new(cos, sin) * RADIUS
        });
        let tracer = LineTracer::new(driver.topology(), driver.rest()).with_uvs(driver.uvs());
        let line = tracer.trace(&LineInput::Uv {
            points: points.collect(),
            is_closed: true,
            corners: Corners::Round,
        });
        let ring = CreaseSpec {
            name: "ring".into(),
            line: line.expect("a ring on the square"),
            law: LineLaw {
                width: 1e-4,
                stiffness: 0.1,
                angle: 0.0,
                fade: [0.0; 2],
            },
            is_ridge: false,
            sense: FoldSense::Both,
            drive: Drive::Load,
            anchor: None,
            slit: None,
            memory: CreaseMemory::default(),
            absorbs: false,
        };
        let layer = LayerSpec {
            creases: vec![ring],
            ..knuckle()
        };
        let faces: Vec<_> = driver.topology().faces().ids().collect();
        let base = BaseSurface::new(&driver, &faces, 2, Smoothing::None);
        let on = (Piece::of(&base), Smoothing::None, 0.0);
        let region = RegionMesh::new(&driver, &layer, on, &mut || true).expect("a region");
        let idle = FaceDriver {
            compression: Matrix3::zeros(),
            wavelength: 1.0,
            critical_strain: 1.0,
            poisson: 0.3,
        };
        let length: f64 = RADIUS * 10_f64.to_radians();
        let vertices = region.skin.mesh.vertex_count();
        let strains = SizingStrains {
            drivers: &PerFace::filled(region.skin.mesh.face_count(), idle),
            least: &vec![Matrix3::identity() / (length * length); vertices],
            aspects: &vec![1.0; vertices],
            refinement: Refinement::default(),
            budget: 1_000_000,
        };
        let fitted = region.adapted(&driver, &strains, &RemeshSettings::default(), &mut || true);
        let fitted = fitted.expect("a mesh").expect("nobody interrupts").skin;
        let transfer = Interpolation::new(&fitted, &region.skin, &mut || true);
        let height = |p: &Vector3<f64>| {
            let off = p.xy().norm() - RADIUS;
            Vector3::z() * (-FLANK * (-off.abs() / FLANK).exp())
        };
        let values: Vec<_> = fitted.rest.positions.iter().map(height).collect();
        let [found] = transfer
            .expect("nobody interrupts")
            .apply([Values::Vectors(&values)]);
        let LineShift { shifts, on_line } = LineShift::new(&fitted, &region.skin);
        let most = shifts.iter().map(Vector3::norm).fold(0.0, f64::max) / length;
        assert!(most > 0.015, "the chords are off by {most}");
        // What is left are the chords of the region's own mesh.
        for (v, _) in on_line {
            let error = (found[v.index()].z + FLANK).abs() / length;
            assert!(error < 0.01, "{v:?}: {error}");
        }
    }
}
