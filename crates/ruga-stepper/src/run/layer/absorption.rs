//! Compression beyond the cap that creases take up: skin that a pose presses together by a third folds there.

use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::{Vector2, Vector3};
use ruga_blend::FaceStrain;
use ruga_crease::CreaseEdge;
use ruga_material::capped_strain;
use ruga_mesh::{FaceId, Id, PerFace, VertexId, face_areas, triangle_frame};

use crate::LayerSpec;
use crate::skin::crease_neighbours::near_creases;
use crate::skin::local_skin::SkinProperties;
use crate::skin::skin_mesh::SkinMesh;

/// Largest angle of a fold that takes up compression (rad): beyond, its sides come close to each other, and nothing
/// would hold them apart.
const LARGEST_FOLD: f64 = 100.0 * PI / 180.0;

/// Share of the reach of a crease, one wavelength, up to which it takes up all that it can: a sudden end would be a
/// step in what the skin feels.
const FULL: f64 = 0.7;

/// Length of a way along edges over that of the straight one, at most: on regular triangles 1.15.
const DETOUR: f64 = 1.3;

/// Share of what carries the skin that is left below the largest fold, whose sides part from it.
const LEFT_BELOW: f64 = 0.2;

/// The skin beside those creases of a layer that take up compression.
#[derive(Debug, Default)]
pub(super) struct Bands {
    /// By the lines that they are closest to, and along these.
    faces: Vec<BandFace>,
    /// The edges of these creases, likewise.
    edges: Vec<BandEdge>,
}

/// A face within reach of a crease.
#[derive(Debug)]
struct BandFace {
    face: FaceId,
    area: f64,
    /// Across the crease, in the frame of the face at rest.
    across: Vector2<f64>,
    /// The part of what it is compressed by that the crease may take up: less towards the end of its reach.
    part: f64,
    /// The part that the end of the crease leaves of that.
    taper: f64,
    /// Rank of the closest edge, its line, and the arc length (m) there.
    edge: usize,
    line: usize,
    at: f64,
}

/// An edge on a crease.
#[derive(Debug)]
struct BandEdge {
    /// Rank among all edges on creases.
    rank: usize,
    line: usize,
    /// Length of the line where it is closed, m.
    around: Option<f64>,
    at: f64,
    length: f64,
    /// Reach of the crease there, m.
    reach: f64,
}

/// What the creases of a layer take up in one pose.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Absorption {
    /// Of every face the way across its crease, in the frame of the face at rest, and the share of compression along it
    /// beyond the cap that the layer feels all the same; empty for none.
    faces: Vec<(Vector2<f64>, f64)>,
    /// Share of what carries every face that is left; empty for all.
    carried: Vec<f64>,
    /// The folds, by edges on creases; empty for none.
    folds: Vec<AbsorbedFold>,
}

/// Fold of an edge that takes up what the skin beside it is compressed by beyond the cap.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct AbsorbedFold {
    /// Angle from flat (rad).
    pub(super) angle: f64,
    /// Depth below the far ends of its sides (m).
    pub(super) depth: f64,
}

impl AbsorbedFold {
    /// A part of the fold.
    pub(super) fn part(self, share: f64) -> Self {
        Self {
            angle: share * self.angle,
            depth: share * self.depth,
        }
    }

    /// The fold a `share` of the way to another one.
    pub(super) fn towards(self, other: Self, share: f64) -> Self {
        Self {
            angle: self.angle + share * (other.angle - self.angle),
            depth: self.depth + share * (other.depth - self.depth),
        }
    }

    /// The angle over that of the largest fold.
    pub(super) fn share_of_largest(self) -> f64 {
        self.angle / LARGEST_FOLD
    }
}

impl Bands {
    /// The skin within a wavelength of the creases of `layer` that take up compression, each face with the closest.
    pub(super) fn new(layer: &LayerSpec, skin: &SkinMesh, properties: &SkinProperties) -> Self {
        let absorbs = |line: usize| layer.creases[line].absorbs;
        if !skin.creases.iter().any(|crease| absorbs(crease.line)) {
            return Self::default();
        }
        let (mesh, rest) = (&skin.mesh, &skin.rest.positions);
        let mut edges = Vec::new();
        let mut at_vertex: Vec<Vec<usize>> = vec![Vec::new(); rest.len()];
        let own = skin.creases.iter().enumerate();
        let mut own: Vec<_> = own.filter(|(_, crease)| absorbs(crease.line)).collect();
        let middle = |crease: &CreaseEdge| 0.5 * (crease.at[0] + crease.at[1]);
        own.sort_by(|(_, a), (_, b)| a.line.cmp(&b.line).then(middle(a).total_cmp(&middle(b))));
        for (rank, crease) in own {
            let ends = mesh.edges()[crease.edge].vertices.map(Id::index);
            ends.iter().for_each(|&v| at_vertex[v].push(edges.len()));
            let waves = ends.map(|v| properties.at_vertex(v).wrinkling.wavelength);
            let line = &layer.creases[crease.line].line;
            edges.push(BandEdge {
                rank,
                line: crease.line,
                around: line.is_closed().then(|| line.length()),
                at: middle(crease),
                length: (rest[ends[1]] - rest[ends[0]]).norm(),
                reach: 0.5 * (waves[0] + waves[1]),
            });
        }
        let longest = edges.iter().map(|edge| edge.reach).fold(0.0, f64::max);
        let mut origins: Vec<Option<VertexId>> = vec![None; rest.len()];
        for near in near_creases(skin, DETOUR * longest, absorbs) {
            origins[near.vertex] = Some(near.origin);
        }
        let areas = face_areas(mesh, rest);
        let band = |(face, corners): (FaceId, &[VertexId; 3])| {
            let places = corners.map(|v| rest[v.index()]);
            let centre = places.iter().sum::<Vector3<f64>>() / 3.0;
            let origins = corners.iter().filter_map(|v| origins[v.index()]);
            let around = origins.flat_map(|v| &at_vertex[v.index()]);
            let measured = around.map(|&edge| {
                let crease = &skin.creases[edges[edge].rank];
                let [a, b] = mesh.edges()[crease.edge].vertices.map(|v| rest[v.index()]);
                let along = b - a;
                let share = ((centre - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
                let distance = (centre - a - along * share).norm();
                let at = crease.at[0] + (crease.at[1] - crease.at[0]) * share;
                (distance, edge, at, along)
            });
            let (distance, edge, at, along) = measured.min_by(|a, b| a.0.total_cmp(&b.0))?;
            let inside = (1.0 - distance / edges[edge].reach) / (1.0 - FULL);
            let part = inside.clamp(0.0, 1.0);
            let [x, y] = triangle_frame(&places).map(|axis| axis.dot(&along));
            let across = Vector2::new(-y, x).try_normalize(0.0)?;
            (part > 0.0).then_some(BandFace {
                face,
                area: areas[face],
                across,
                part,
                taper: layer.creases[edges[edge].line].taper(at),
                edge,
                line: edges[edge].line,
                at,
            })
        };
        let mut faces: Vec<_> = mesh.faces().iter().filter_map(band).collect();
        faces.sort_by(|a, b| a.line.cmp(&b.line).then(a.at.total_cmp(&b.at)));
        Self { faces, edges }
    }

    /// What the creases take up of these `strains`; of so many edges on creases.
    pub(super) fn absorption(&self, strains: &PerFace<FaceStrain>, edges: usize) -> Absorption {
        // What each face is compressed by across the crease, beyond the cap.
        let excess = |face: &BandFace| {
            let strain = &strains[face.face];
            along(strain, &face.across) * (strain.first - capped_strain(strain.first)).max(0.0)
        };
        let excesses: Vec<f64> = self.faces.iter().map(excess).collect();
        if excesses.iter().all(|excess| *excess == 0.0) {
            return Absorption::default();
        }
        let most = 1.0 - (0.5 * LARGEST_FOLD).cos();
        let mut folds = vec![AbsorbedFold::default(); edges];
        // Of each edge the share of what there is that its fold can take up, and the fold over the largest.
        let mut taken = vec![[1.0, 0.0]; self.edges.len()];
        for (edge, taken) in self.edges.iter().zip(&mut taken) {
            // As far along the line as across it: a fold does not change within its own width.
            let near = |at: f64| {
                let way = (at - edge.at).abs();
                let way = edge
                    .around
                    .map_or(way, |around| way.min((around - way).abs()));
                (1.0 - way / edge.reach).max(0.0)
            };
            let (mut lost, mut area) = (0.0, 0.0);
            let own = edge.reached(&self.faces, |face| (face.line, face.at));
            for (face, excess) in self.faces[own.clone()].iter().zip(&excesses[own]) {
                let part = near(face.at) * face.area * face.part;
                lost += part * excess;
                area += part;
            }
            if lost <= 0.0 {
                continue;
            }
            let own = edge.reached(&self.edges, |edge| (edge.line, edge.at));
            let lengths = self.edges[own].iter();
            let length: f64 = lengths.map(|other| near(other.at) * other.length).sum();
            // Two sides, each as wide as half of the band, that turn until the band is as much narrower.
            let asked = lost / area;
            let half = (1.0 - asked.min(most)).acos();
            let fold = AbsorbedFold {
                angle: 2.0 * half,
                depth: 0.5 * area / length * half.sin(),
            };
            folds[edge.rank] = fold;
            *taken = [(most / asked).min(1.0), fold.share_of_largest()];
        }
        let mut faces = vec![(Vector2::zeros(), 0.0); strains.len()];
        let mut carried = vec![1.0; strains.len()];
        for face in &self.faces {
            let [share, fold] = taken[face.edge];
            let part = face.part * face.taper;
            faces[face.face.index()] = (face.across, part * share);
            carried[face.face.index()] = 1.0 - part * fold * (1.0 - LEFT_BELOW);
        }
        Absorption {
            faces,
            carried,
            folds,
        }
    }
}

impl BandEdge {
    /// Range of the elements, sorted by line and arc length, that may be within reach along the line.
    fn reached<T>(&self, sorted: &[T], place: impl Fn(&T) -> (usize, f64)) -> Range<usize> {
        let (low, high) = match self.around {
            None => (self.at - self.reach, self.at + self.reach),
            Some(_) => (f64::NEG_INFINITY, f64::INFINITY),
        };
        let before = |element: &T, line: usize, at: f64| {
            let place = place(element);
            place.0 < line || place.0 == line && place.1 < at
        };
        let start = sorted.partition_point(|element| before(element, self.line, low));
        let end = sorted.partition_point(|element| {
            before(element, self.line, high) || place(element) == (self.line, high)
        });
        start..end
    }
}

/// Share of a strain's compression that is along a direction in the frame at rest.
fn along(strain: &FaceStrain, direction: &Vector2<f64>) -> f64 {
    strain.direction.dot(direction).powi(2)
}

impl Absorption {
    /// Share of a `strain` of a face beyond the cap that the layer feels all the same.
    pub(crate) fn share(&self, face: FaceId, strain: &FaceStrain) -> f64 {
        let of_face = self.faces.get(face.index());
        of_face.map_or(0.0, |(across, share)| share * along(strain, across))
    }

    /// Share of what carries a face that is left.
    pub(super) fn carried(&self, face: usize) -> f64 {
        self.carried.get(face).copied().unwrap_or(1.0)
    }

    /// Number of edges on creases that there are folds of.
    pub(super) fn edges(&self) -> usize {
        self.folds.len()
    }

    /// Fold of an edge by its rank among those on creases.
    pub(super) fn fold(&self, rank: usize) -> AbsorbedFold {
        self.folds.get(rank).copied().unwrap_or_default()
    }
}
