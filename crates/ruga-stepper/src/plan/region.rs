//! Where a pose can wrinkle a layer: the active region.

use nalgebra::{Matrix2, Matrix3, Vector3, Vector6};
use rayon::prelude::*;
use ruga_blend::{BaseSurface, Driver, FaceStrain, PosedSurface, face_strains};
use ruga_mesh::{FaceId, Id, PerFace, TriMesh, edge_distances, face_normals, triangle_frame};

use crate::growth::PoseGrowth;
use crate::plan::pose_plan::{LoadPath, PlannedLayer};
use crate::run::strain_ratio::relative_to;
use crate::{PoseSpec, Presence, Region};

/// A face is active where the effective strain passes this fraction of the critical one.
pub(crate) const ACTIVE_FRACTION: f64 = 0.8;
/// Triangles compressed beyond this stay on the driver: the artist has drawn a fold.
const COLLAPSED: f64 = 0.6;
/// Area that wrinkles only on the way matters above this fraction of the area that wrinkles at the keys.
const DETOUR_FRACTION: f64 = 0.1;
/// The smaller compression over the larger one from which on both count the same.
const EQUALLY: f64 = 0.8;
/// Faces that a thread averages strains on at least.
const FACES_AT_ONCE: usize = 4096;
/// Least distance by which the active region grows, m.
const MIN_MARGIN: f64 = 4e-3;

/// The strain that a pose's keys ask of the faces of the planning surface.
pub(crate) struct PoseStrains {
    /// Largest effective strain over the keys, from smoothed tensors.
    pub(crate) effective: PerFace<f64>,
    /// Largest compression over the keys, without averaging.
    pub(crate) compression: PerFace<f64>,
    /// Faces that collapse or turn over at a key.
    pub(crate) folded: PerFace<bool>,
    /// Largest effective strain over the keys, without averaging.
    raw: PerFace<f64>,
    /// Effective strain at the last key, without averaging.
    last: PerFace<f64>,
    /// Principal compressions at the key that asks most, without averaging.
    pub(crate) principal: PerFace<[f64; 2]>,
    /// Largest effective strain on the way to the keys, without averaging.
    passing: PerFace<f64>,
    /// Fraction of the last key from which on, as weights grow, the effective strain is critical; 1
    /// where it never is.
    onset: PerFace<f64>,
    /// Faces that collapse or turn over on the way to the keys.
    passing_folded: PerFace<bool>,
    /// The layer's critical strain on every face.
    critical: PerFace<f64>,
    /// Rest area of every face, m².
    pub(crate) areas: PerFace<f64>,
}

impl PoseStrains {
    /// Area that the pose folds over or collapses, m².
    pub(crate) fn folded_area(&self) -> f64 {
        let folded = self.folded.iter().filter(|(_, folded)| **folded);
        // Not `sum`, which makes -0 of nothing.
        folded.fold(0.0, |sum, (face, _)| sum + self.areas[face])
    }

    /// Measures what the keys of a pose ask of `surface`, which is posed at each of them in `keys`.
    ///
    /// `passing` are surfaces on the way to the last key, each after a fraction of it, ascending.
    pub(crate) fn new(
        on: (&Driver, &BaseSurface, &PosedSurface),
        pose: &PoseSpec,
        keys: &[PosedSurface],
        passing: &[(f64, PosedSurface)],
        layer: &PlannedLayer<'_>,
    ) -> Self {
        let (_, surface, rest) = on;
        let growth = PoseGrowth::new(layer.spec, pose);
        let last = pose.keys.iter().copied().fold(0.0, f64::max);
        let poisson = layer.spec.material.poisson;
        let local = layer.local.as_slice().iter();
        let mesh = surface.mesh();
        let count = mesh.face_count();
        let normals = face_normals(mesh, &rest.positions);
        let mut pose_strains = Self {
            effective: PerFace::filled(count, f64::NEG_INFINITY),
            compression: PerFace::filled(count, f64::NEG_INFINITY),
            folded: PerFace::filled(count, false),
            raw: PerFace::filled(count, f64::NEG_INFINITY),
            last: PerFace::filled(count, f64::NEG_INFINITY),
            principal: PerFace::filled(count, [0.0; 2]),
            passing: PerFace::filled(count, f64::NEG_INFINITY),
            onset: PerFace::filled(count, 1.0),
            passing_folded: PerFace::filled(count, false),
            critical: local.map(|wrinkling| wrinkling.critical_strain).collect(),
            areas: normals.as_slice().iter().map(|n| 0.5 * n.norm()).collect(),
        };
        // Averaging over more than 2 mm would remove real gradients at lids and mouth corners.
        let width = (0.5 * layer.wrinkling.wavelength).min(2e-3);
        let mut before = (0.0, PerFace::filled(count, 0.0));
        // Strains on the way are not averaged, because the ones at the keys that they are compared
        // with are not. Averaging lowers peaks: on one side of the comparison alone it would hide
        // detours or invent them.
        let on_the_way: Vec<_> = passing
            .par_iter()
            .map(|(_, pose)| face_strains(mesh, &rest.positions, &pose.positions))
            .collect();
        for ((fraction, pose), strains) in passing.iter().zip(on_the_way) {
            mark_folded(mesh, pose, &strains, &mut pose_strains.passing_folded);
            let strains: PerFace<f64> = felt(on, strains, &growth, fraction * last)
                .iter()
                .map(|(_, strain)| strain.effective(poisson))
                .collect();
            let onset = &mut pose_strains.onset;
            note_onset(
                onset,
                &pose_strains.critical,
                (before.0, &before.1),
                (*fraction, &strains),
            );
            for face in pose_strains.areas.ids() {
                pose_strains.passing[face] = pose_strains.passing[face].max(strains[face]);
            }
            before = (*fraction, strains);
        }
        for (pose, load) in keys.iter().zip(&pose.keys) {
            let strains = face_strains(mesh, &rest.positions, &pose.positions);
            mark_folded(mesh, pose, &strains, &mut pose_strains.folded);
            let strains = felt(on, strains, &growth, *load);
            let smooth = smoothed_strains(mesh, &rest.positions, &strains, &normals, width);
            for face in pose_strains.areas.ids() {
                let first = strains[face].first;
                pose_strains.compression[face] = pose_strains.compression[face].max(first);
                let raw = strains[face].effective(poisson);
                // Keys ascend.
                pose_strains.last[face] = raw;
                // Directions are only comparable within one key: the principal strains of two keys
                // have their own axes.
                if raw > pose_strains.raw[face] {
                    pose_strains.raw[face] = raw;
                    pose_strains.principal[face] = [strains[face].first, strains[face].second];
                }
                let effective = smooth[face].effective(poisson);
                pose_strains.effective[face] = pose_strains.effective[face].max(effective);
            }
        }
        let Self {
            onset,
            critical,
            raw,
            ..
        } = &mut pose_strains;
        note_onset(onset, critical, (before.0, &before.1), (1.0, raw));
        pose_strains
    }

    /// Fraction of the load at which each face begins to wrinkle, in (0, 1]; 1 where it never does.
    pub(crate) fn onsets(&self, path: LoadPath) -> PerFace<f64> {
        match path {
            LoadPath::Weight => self.onset.clone(),
            LoadPath::Strain => {
                // Here the load is the fraction of the strain itself, so that the onset is the
                // ratio of the two.
                let fractions = self
                    .critical
                    .iter()
                    .map(|(face, critical)| critical / self.raw[face]);
                let wrinkles = |fraction: f64| fraction > 0.0 && fraction < 1.0;
                fractions
                    .map(|fraction| if wrinkles(fraction) { fraction } else { 1.0 })
                    .collect()
            }
        }
    }

    /// Area that would wrinkle on the way to the keys and at none of them, m²; zero when it is
    /// small beside what wrinkles at the keys or than a wavelength squared.
    ///
    /// A blend shape moves points on straight lines: a part that it turns by an angle `a` is
    /// shorter half way by the factor `cos(a / 2)`.
    pub(crate) fn detour(&self, wavelength: f64) -> f64 {
        let area_where = |test: &dyn Fn(FaceId) -> bool| -> f64 {
            let faces = self.areas.iter().filter(|&(face, _)| test(face));
            faces.map(|(_, area)| area).sum()
        };
        let critical = &self.critical;
        let at_keys = area_where(&|face| self.raw[face] > critical[face]);
        let on_the_way = area_where(&|face| self.is_detour(face));
        // With a path for every key all keys begin from rest, which takes as many times as long. A
        // small area is not worth that.
        let worth_it = (DETOUR_FRACTION * at_keys).max(wavelength * wavelength);
        if on_the_way > worth_it {
            on_the_way
        } else {
            0.0
        }
    }

    /// Whether a face wrinkles at an earlier key and is smooth again at the last.
    pub(crate) fn is_smooth_again(&self, face: FaceId) -> bool {
        let critical = self.critical[face];
        self.raw[face] > critical && self.last[face] <= critical
    }

    /// Whether a face would wrinkle on the way to the keys and at none of them.
    pub(crate) fn is_detour(&self, face: FaceId) -> bool {
        let critical = self.critical[face];
        self.passing[face] > critical && self.raw[face] <= critical
    }

    /// The layer's critical strain.
    pub(crate) fn critical(&self, face: FaceId) -> f64 {
        self.critical[face]
    }

    /// Largest effective strain over the keys, in critical strains.
    pub(crate) fn strain_ratio(&self, face: FaceId) -> f64 {
        self.effective[face] / self.critical[face]
    }

    /// Whether a face may be wrinkled at a key.
    pub(crate) fn is_wrinkled(&self, face: FaceId) -> bool {
        self.strain_ratio(face) > ACTIVE_FRACTION
    }

    /// Faces that may be wrinkled at a key or, where weights grow, on the way to one.
    pub(crate) fn wrinkled(&self, path: LoadPath) -> PerFace<bool> {
        let is_wrinkled = |face: FaceId| {
            let on_the_way = path == LoadPath::Weight && self.passing[face] > self.critical[face];
            on_the_way || self.is_wrinkled(face)
        };
        self.areas.ids().map(is_wrinkled).collect()
    }

    /// Whether a face is compressed beyond its critical strain equally in all directions.
    pub(crate) fn is_compressed_equally(&self, face: FaceId) -> bool {
        let [first, second] = self.principal[face];
        self.strain_ratio(face) > 1.0 && second > EQUALLY * first
    }

    /// Leaves out, too, what collapses on the way: it cannot be followed there.
    pub(crate) fn exclude_passing_folds(&mut self) {
        for face in self.areas.ids() {
            self.folded[face] |= self.passing_folded[face];
        }
    }

    /// Faces on which a layer may be and that the pose does not fold, ascending.
    pub(crate) fn smooth_faces(&self, surface: &BaseSurface, presence: &Presence) -> Vec<FaceId> {
        let faces = surface.mesh().faces().ids();
        faces
            .filter(|&face| {
                let [a, b, c] = surface.uvs()[face];
                presence.covers((a + b + c) / 3.0) && !self.folded[face]
            })
            .collect()
    }

    /// Those of the `wanted` faces that are to be simulated, ascending; `creased` are those on lines that fold in the
    /// pose.
    pub(crate) fn active_faces(
        &self,
        (surface, rest): (&BaseSurface, &PosedSurface),
        (region, presence): (&Region, &Presence),
        wavelength: f64,
        creased: &[FaceId],
        wanted: &dyn Fn(FaceId) -> bool,
    ) -> Vec<FaceId> {
        let mesh = surface.mesh();
        let allowed = |face: FaceId| {
            let [a, b, c] = surface.uvs()[face];
            let centre = (a + b + c) / 3.0;
            presence.covers(centre)
        };
        let mut active: PerFace<bool> = mesh
            .faces()
            .ids()
            .map(|face| {
                // Half of the critical strain, tried first, took in 1.7 to 2.5 times this area on
                // six shapes of a face.
                let wrinkles = self.is_wrinkled(face);
                (matches!(region, Region::All) || wrinkles) && allowed(face)
            })
            .collect();
        if !matches!(region, Region::All) {
            // A patch smaller than the square of a wave has no room for one.
            drop_specks(mesh, &self.areas, &mut active, wavelength * wavelength);
            // A line that folds has room beside it, once the region has grown.
            creased.iter().for_each(|&face| active[face] = true);
            let margin = (2.0 * wavelength).max(MIN_MARGIN);
            // The border will be held on the driver. It has to lie where the skin stays smooth.
            grow(mesh, &rest.positions, &mut active, margin);
        }
        active
            .iter()
            // Folds and black paint are taken out once more, because growing has taken them in.
            .filter(|&(face, &on)| on && allowed(face) && !self.folded[face] && wanted(face))
            .map(|(face, _)| face)
            .collect()
    }
}

/// The strains of a layer that has grown, at a load, on a surface with these ones.
pub(crate) fn felt(
    (driver, surface, rest): (&Driver, &BaseSurface, &PosedSurface),
    strains: PerFace<FaceStrain>,
    growth: &PoseGrowth<'_>,
    load: f64,
) -> PerFace<FaceStrain> {
    if growth.is_none() {
        return strains;
    }
    let faces = surface.mesh().faces();
    let grown = strains.iter().map(|(face, strain)| {
        let corners = faces[face].map(|v| rest.positions[v.index()]);
        let whole = (driver, surface.origins()[face].face);
        let stretch = growth.on_part(whole, &surface.uvs()[face], &corners, load);
        relative_to(strain, &stretch)
    });
    grown.collect()
}

/// Notes on which faces the effective strain first becomes critical between two fractions of the last
/// key.
fn note_onset(
    onset: &mut PerFace<f64>,
    critical: &PerFace<f64>,
    before: (f64, &PerFace<f64>),
    now: (f64, &PerFace<f64>),
) {
    for (face, &critical) in critical.iter() {
        let (low, high) = (before.1[face], now.1[face]);
        // Only the first crossing counts. A face may fall below its critical strain again on the
        // way.
        if onset[face] == 1.0 && low < critical && critical <= high {
            onset[face] = before.0 + (now.0 - before.0) * (critical - low) / (high - low);
        }
    }
}

/// Marks the faces that one pose collapses or turns over.
fn mark_folded(
    mesh: &TriMesh,
    pose: &PosedSurface,
    strains: &PerFace<FaceStrain>,
    folded: &mut PerFace<bool>,
) {
    let normals = face_normals(mesh, &pose.positions);
    for (face, vertices) in mesh.faces().iter() {
        // Strains cannot tell a face that is turned over: they see lengths, not sides.
        let outward: Vector3<f64> = vertices.iter().map(|v| pose.normals[v.index()]).sum();
        let turned_over = outward.dot(&normals[face]) <= 0.0;
        folded[face] |= turned_over || strains[face].first > COLLAPSED;
    }
}

/// Strains from tensors averaged over about `width`, by diffusion from face to face.
///
/// Averaging the tensor keeps direction and size together; faces that meet at a crease sharper
/// than acos 0.3 do not mix.
fn smoothed_strains(
    mesh: &TriMesh,
    rest: &[Vector3<f64>],
    strains: &PerFace<FaceStrain>,
    normals: &PerFace<Vector3<f64>>,
    width: f64,
) -> PerFace<FaceStrain> {
    let frames: PerFace<[Vector3<f64>; 2]> = mesh
        .faces()
        .as_slice()
        .iter()
        .map(|face| triangle_frame(&face.map(|v| rest[v.index()])))
        .collect();
    // Most of the time goes into fetching tensors, so that they have no number twice.
    let mut tensors: Vec<Vector6<f64>> = strains
        .iter()
        .map(|(face, strain)| packed(&lift(&strain.cauchy_green, &frames[face])))
        .collect();
    // Tensors are weighted by area, or the finer side of a change of size would count for more.
    let areas: Vec<f64> = normals.as_slice().iter().map(|n| 0.5 * n.norm()).collect();
    let neighbours: Vec<[Option<FaceId>; 3]> = mesh
        .faces()
        .ids()
        .map(|face| {
            std::array::from_fn(|corner| {
                mesh.neighbour(face, corner).filter(|&next| {
                    let (a, b) = (normals[face], normals[next]);
                    a.dot(&b) > 0.3 * a.norm() * b.norm()
                })
            })
        })
        .collect();
    let area: f64 = areas.iter().sum();
    // Triangles are taken as equilateral ones of the mean area. A pass moves three quarters of a
    // face's tensor to the centres beside it, `edge / sqrt(3)` away: an eighth of the edge's square
    // in each direction.
    let mean_edge_squared = area / mesh.face_count() as f64 * 4.0 / 3f64.sqrt();
    let passes = (8.0 * width * width / mean_edge_squared)
        .round()
        .clamp(0.0, 40.0) as u32;
    // A new list for every pass would cost as much as the sums.
    let mut before = tensors.clone();
    for _ in 0..passes {
        std::mem::swap(&mut before, &mut tensors);
        let tensors = tensors.par_iter_mut().with_min_len(FACES_AT_ONCE);
        tensors.enumerate().for_each(|(i, tensor)| {
            let (mut sum, mut weight) = (before[i] * areas[i], areas[i]);
            for next in neighbours[i].iter().flatten().map(|next| next.index()) {
                sum += before[next] * areas[next];
                weight += areas[next];
            }
            *tensor = sum / weight;
        });
    }
    frames
        .iter()
        .map(|(face, [u, v])| {
            let t = unpacked(&tensors[face.index()]);
            let shear = u.dot(&(t * v));
            let flat = Matrix2::new(u.dot(&(t * u)), shear, shear, v.dot(&(t * v)));
            FaceStrain::from_cauchy_green(flat)
        })
        .collect()
}

/// The six numbers of a symmetric matrix.
fn packed(t: &Matrix3<f64>) -> Vector6<f64> {
    Vector6::new(t.m11, t.m22, t.m33, t.m12, t.m13, t.m23)
}

/// The symmetric matrix of six numbers.
fn unpacked(t: &Vector6<f64>) -> Matrix3<f64> {
    Matrix3::new(t[0], t[3], t[4], t[3], t[1], t[5], t[4], t[5], t[2])
}

/// The tensor in space, with a unit normal part so that tilting a face does not read as strain.
fn lift(tensor: &Matrix2<f64>, [u, v]: &[Vector3<f64>; 2]) -> Matrix3<f64> {
    let n = u.cross(v);
    u * u.transpose() * tensor[(0, 0)]
        + (u * v.transpose() + v * u.transpose()) * tensor[(0, 1)]
        + v * v.transpose() * tensor[(1, 1)]
        + n * n.transpose()
}

/// Switches off connected parts smaller than `min_area`.
fn drop_specks(mesh: &TriMesh, areas: &PerFace<f64>, active: &mut PerFace<bool>, min_area: f64) {
    for part in mesh.connected_parts(|face| active[face]) {
        if part.iter().map(|&face| areas[face]).sum::<f64>() < min_area {
            part.iter().for_each(|&face| active[face] = false);
        }
    }
}

fn grow(mesh: &TriMesh, rest: &[Vector3<f64>], active: &mut PerFace<bool>, margin: f64) {
    let sources: Vec<_> = active
        .iter()
        .filter(|(_, on)| **on)
        .flat_map(|(face, _)| mesh.faces()[face])
        .collect();
    // Distances beyond the margin are infinite.
    let distances = edge_distances(mesh, rest, sources, margin);
    for face in mesh.faces().ids() {
        active[face] |= mesh.faces()[face].iter().all(|&v| distances[v].is_finite());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symmetric_matrices_stay_the_same() {
        let t = Matrix3::new(1.0, 4.0, 5.0, 4.0, 2.0, 6.0, 5.0, 6.0, 3.0);
        assert_eq!(unpacked(&packed(&t)), t);
    }

    #[test]
    fn wrinkling_begins_between_the_surfaces_that_were_looked_at() {
        let field = |values: [f64; 4]| -> PerFace<f64> { values.into_iter().collect() };
        let critical = field([1.0; 4]);
        // Evenly; never; on the way only; at the end only.
        let looked_at = [
            (0.0, field([0.0; 4])),
            (0.5, field([2.0, 0.5, 4.0, 0.0])),
            (1.0, field([4.0, 0.9, 0.0, 1.0])),
        ];
        let mut onset = PerFace::filled(4, 1.0);
        for pair in looked_at.windows(2) {
            let [before, now] = [0, 1].map(|i: usize| (pair[i].0, &pair[i].1));
            note_onset(&mut onset, &critical, before, now);
        }
        assert_eq!(onset.as_slice(), [0.25, 1.0, 0.125, 1.0]);
    }
}
