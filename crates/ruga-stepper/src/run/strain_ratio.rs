//! What the surface below a layer asks of it: applied strains, and their ratio to the critical ones.

use nalgebra::{Matrix2, Vector2};
use rayon::prelude::*;
use ruga_blend::{FaceStrain, face_strains};
use ruga_material::capped_strain;
use ruga_mesh::{FaceId, Id, PerFace, face_areas};

use crate::run::layer::Absorption;
use crate::skin::local_skin::SkinProperties;
use crate::skin::skin_mesh::SkinMesh;
use crate::support::support_surface::SupportSurface;

/// Strain that a face beside a crease feels at most: from 0.42 on the membrane, linear in Green strain, pushes back less
/// the more it is compressed.
const MOST_FELT: f64 = 0.4;

/// Halvings of the bracket of a fraction: to nine digits.
const BISECTIONS: usize = 30;

/// The effective strain that is loaded on every face of a layer, over the face's critical strain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StrainRatios<'a> {
    pub(crate) skin: &'a SkinMesh,
    pub(crate) properties: &'a SkinProperties,
    pub(crate) poisson: f64,
    /// Applied strains: those of the surface below, relative to the layer's rest metric.
    pub(crate) strains: &'a PerFace<FaceStrain>,
    /// Fraction of the applied Green strain that every face feels, in (0, 1].
    pub(crate) fractions: &'a PerFace<f64>,
    /// What creases take up of the strains beyond the cap.
    pub(crate) absorption: &'a Absorption,
}

impl StrainRatios<'_> {
    /// The ratio of one face.
    pub(crate) fn of_face(&self, face: FaceId) -> f64 {
        self.of_face_at(self.fractions[face], face)
    }

    /// The compression across a line through a face that is loaded, with what compression along it adds, `en + nu et`;
    /// `across` is a unit vector in the face's frame at rest.
    pub(crate) fn across(&self, face: FaceId, across: &Vector2<f64>) -> f64 {
        let [first, second] = self
            .capped(face)
            .map(|strain| loaded(strain, self.fractions[face]));
        let share = self.strains[face].direction.dot(across).powi(2);
        let [over, along] =
            [share, 1.0 - share].map(|share| share * first + (1.0 - share) * second);
        over + self.poisson * along
    }

    /// The ratios of all faces.
    pub(crate) fn all(&self) -> PerFace<f64> {
        let faces = (0..self.strains.len()).into_par_iter();
        let ratios = faces.map(|face| self.of_face(FaceId::from_index(face)));
        ratios.collect::<Vec<_>>().into()
    }

    fn of_face_at(&self, fraction: f64, face: FaceId) -> f64 {
        self.at(self.capped(face), fraction, face)
    }

    fn capped(&self, face: FaceId) -> [f64; 2] {
        let strain = &self.strains[face];
        capped(strain, self.absorption.share(face, strain))
    }

    /// The ratio of a face with these capped principal strains, of which a fraction is loaded.
    fn at(&self, capped: [f64; 2], fraction: f64, face: FaceId) -> f64 {
        let [first, second] = capped.map(|strain| loaded(strain, fraction));
        let effective = first + self.poisson * second;
        effective / self.properties.on_face(face).wrinkling.critical_strain
    }

    /// The largest ratio of all faces.
    pub(crate) fn largest(&self) -> f64 {
        largest(&self.all())
    }

    /// The fractions of the faces' applied strains at which their ratios are what is `wanted` of each, above 0; all of
    /// it where that is not enough.
    pub(crate) fn fractions_of(&self, wanted: impl Fn(FaceId) -> f64 + Sync) -> PerFace<f64> {
        let faces: Vec<FaceId> = self.strains.ids().collect();
        let fractions = faces.into_par_iter();
        let fractions: Vec<f64> = fractions
            .map(|face| self.fraction_of(face, wanted(face)))
            .collect();
        fractions.into()
    }

    fn fraction_of(&self, face: FaceId, wanted: f64) -> f64 {
        let capped = self.capped(face);
        if self.at(capped, 1.0, face) <= wanted {
            return 1.0;
        }
        // The ratio is convex and 0 at 0, so that it is `wanted` once; where the face is stretched across
        // its compression it is far from proportional, and below 0 at first.
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if self.at(capped, middle, face) < wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    /// The fraction of the applied strain at which the first face reaches its critical strain; 1 where
    /// none does.
    pub(crate) fn onset(&self) -> f64 {
        let fractions = self.fractions_of(|_| 1.0);
        fractions.as_slice().iter().copied().fold(1.0, f64::min)
    }

    /// Corners of the faces that are loaded beyond their critical strain.
    pub(crate) fn supercritical_faces(&self) -> Vec<[u32; 3]> {
        let faces = self.strains.ids().filter(|face| self.of_face(*face) > 1.0);
        faces
            .map(|face| self.skin.mesh.faces()[face].map(|v| v.0))
            .collect()
    }

    /// Energy that wrinkling is about, J: what a critical compression costs, or what wrinkles save
    /// of a larger one, without what creases take up.
    pub(crate) fn energy_scale(&self) -> f64 {
        let areas = face_areas(&self.skin.mesh, &self.skin.rest.positions);
        let of_face = |face: FaceId| {
            let wrinkling = &self.properties.on_face(face).wrinkling;
            // Without a lower bound the scale, and with it every tolerance, would vanish at the
            // onset.
            let strain = capped(&self.strains[face], 0.0);
            let excess = (self.at(strain, self.fractions[face], face) - 1.0).max(1.0);
            let strain = wrinkling.critical_strain * excess;
            0.5 * wrinkling.membrane_stiffness * strain * strain * areas[face]
        };
        self.strains.ids().map(of_face).sum()
    }
}

/// The largest of some ratios.
pub(crate) fn largest(ratios: &PerFace<f64>) -> f64 {
    // Tension, whose ratio is negative, asks for nothing.
    ratios.as_slice().iter().copied().fold(0.0, f64::max)
}

/// The strains of the surface below on every face, the untransferred part of its bending taken away.
pub(crate) fn driven_strains(skin: &SkinMesh, support: &SupportSurface) -> PerFace<FaceStrain> {
    let strains = face_strains(&skin.mesh, &skin.rest.positions, &support.posed.positions);
    let Some(transfer) = &support.transfer else {
        return strains;
    };
    let pairs = strains.as_slice().par_iter().zip(transfer);
    let strains = pairs.map(|(strain, stretch)| relative_to(strain, stretch));
    strains.collect::<Vec<_>>().into()
}

/// The strains that the surface below applies to every face of the layer as it has grown.
pub(crate) fn applied_strains(skin: &SkinMesh, support: &SupportSurface) -> PerFace<FaceStrain> {
    let driven = driven_strains(skin, support);
    match &support.growth {
        None => driven,
        Some(growth) => relative_to_growth(&driven, growth),
    }
}

/// These strains of a surface below, as a layer with such growth feels them.
pub(crate) fn relative_to_growth(
    driven: &PerFace<FaceStrain>,
    growth: &PerFace<Matrix2<f64>>,
) -> PerFace<FaceStrain> {
    let pairs = driven.as_slice().par_iter().zip(growth.as_slice());
    let strains = pairs.map(|(strain, stretch)| relative_to(strain, stretch));
    strains.collect::<Vec<_>>().into()
}

/// The strain of a face whose rest lengths have changed by a stretch.
pub(crate) fn relative_to(strain: &FaceStrain, stretch: &Matrix2<f64>) -> FaceStrain {
    // Transfer and growth are held to stretches that have an inverse.
    let inverse = stretch.try_inverse().unwrap_or_else(Matrix2::identity);
    FaceStrain::from_cauchy_green(inverse.transpose() * strain.cauchy_green * inverse)
}

/// Principal strains, capped but for a share `taken_up` by a crease, of which only a part is loaded: `fraction` times
/// their Green strain.
pub(crate) fn applied(strain: &FaceStrain, taken_up: f64, fraction: f64) -> [f64; 2] {
    capped(strain, taken_up).map(|strain| loaded(strain, fraction))
}

/// Principal strains, capped but for a share `taken_up` by a crease.
fn capped(strain: &FaceStrain, taken_up: f64) -> [f64; 2] {
    // The second strain is not capped, because the rest metric shrinks along the first alone.
    [first_felt(strain, taken_up), strain.second]
}

/// The larger principal strain, capped but for a share `taken_up` by a crease.
pub(crate) fn first_felt(strain: &FaceStrain, taken_up: f64) -> f64 {
    let capped = capped_strain(strain.first);
    (capped + taken_up * (strain.first - capped)).min(MOST_FELT.max(capped))
}

/// The compression whose Green strain is a fraction of that of `compression`.
fn loaded(compression: f64, fraction: f64) -> f64 {
    let squared = (1.0 - compression).powi(2);
    1.0 - (1.0 - fraction * (1.0 - squared)).max(0.0).sqrt()
}

/// Green strain of these compressions along the principal directions of `strain`.
pub(crate) fn green_strain(strain: &FaceStrain, compressions: [f64; 2]) -> Matrix2<f64> {
    let [first, second] = compressions.map(|e| 0.5 * ((1.0 - e).powi(2) - 1.0));
    let along = strain.direction * strain.direction.transpose();
    along * first + (Matrix2::identity() - along) * second
}
