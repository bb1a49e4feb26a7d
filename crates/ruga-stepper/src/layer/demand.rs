//! What the surface below asks of a layer, in its critical strains.

use nalgebra::Matrix2;
use ruga_blend::{FaceStrain, face_strains};
use ruga_material::capped_strain;
use ruga_mesh::{FaceId, Id, PerFace};

use super::Layer;
use crate::below::BelowSurface;
use crate::skin_mesh::SkinMesh;

impl Layer {
    /// Faces on which the surface below asks for more than the critical strain.
    pub(crate) fn supercritical_faces(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        let mesh = &self.skin.mesh;
        self.strains
            .iter()
            .filter(|(face, s)| self.face_demand(*face, s) > 1.0)
            .map(move |(face, _)| mesh.faces()[face].map(|v| v.0))
    }

    /// Largest effective strain that the surface below asks for, in critical strains.
    pub(crate) fn demand(&self) -> f64 {
        let strains = self.strains.iter();
        strains
            .map(|(face, s)| self.face_demand(face, s))
            .fold(0.0, f64::max)
    }

    /// The share of the strain at which the demand is `wanted`; all of it where that is not enough.
    pub(crate) fn share_for(&self, wanted: f64) -> f64 {
        let demand = |share: f64| {
            let faces = self.strains.iter();
            faces
                .map(|(face, s)| self.face_demand_at(share, face, s))
                .fold(0.0, f64::max)
        };
        if demand(1.0) <= wanted {
            return 1.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        // To a per cent of the share: the onset is not known better.
        while high - low > 0.01 * high {
            let middle = 0.5 * (low + high);
            if demand(middle) < wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    /// Effective strain that a face is loaded with, in its critical strains.
    pub(super) fn face_demand(&self, face: FaceId, strain: &FaceStrain) -> f64 {
        self.face_demand_at(self.share, face, strain)
    }

    fn face_demand_at(&self, share: f64, face: FaceId, strain: &FaceStrain) -> f64 {
        let [first, second] = offered(strain, share);
        let effective = first + self.spec.material.poisson * second;
        effective / self.properties.faces[face].wrinkling.critical_strain
    }

    /// Energy that wrinkling is about, J: what a critical compression costs, or what wrinkles save
    /// of a larger one.
    pub(super) fn energy_scale(&self) -> f64 {
        let faces = self.skin.mesh.faces();
        let of_face = |(face, strain): (FaceId, &FaceStrain)| {
            let [a, b, c] = faces[face].map(|v| self.skin.rest.positions[v.index()]);
            let area = 0.5 * (b - a).cross(&(c - a)).norm();
            let numbers = &self.properties.faces[face].wrinkling;
            let excess = (self.face_demand(face, strain) - 1.0).max(1.0);
            let strain = numbers.critical_strain * excess;
            0.5 * numbers.membrane_stiffness * strain * strain * area
        };
        self.strains.iter().map(of_face).sum()
    }
}

/// What the surface below asks of every face, the untransferred part of its bending taken away.
pub(crate) fn offered_strains(skin: &SkinMesh, below: &BelowSurface) -> PerFace<FaceStrain> {
    let strains = face_strains(&skin.mesh, &skin.rest.positions, &below.posed.positions);
    let Some(transfer) = &below.transfer else {
        return strains;
    };
    let pairs = strains.as_slice().iter().zip(transfer);
    pairs
        .map(|(strain, stretch)| {
            let inverse = stretch.try_inverse().unwrap_or_else(Matrix2::identity);
            FaceStrain::from_cauchy_green(inverse.transpose() * strain.cauchy_green * inverse)
        })
        .collect()
}

/// Principal strains, capped, of which only a share is felt: `share` times their Green strain.
pub(super) fn offered(strain: &FaceStrain, share: f64) -> [f64; 2] {
    [capped_strain(strain.first), strain.second].map(|strain| {
        let squared = (1.0 - strain).powi(2);
        1.0 - (1.0 - share * (1.0 - squared)).max(0.0).sqrt()
    })
}

/// Green strain of these compressions along the principal directions of `strain`.
pub(super) fn green_strain(strain: &FaceStrain, compressions: [f64; 2]) -> Matrix2<f64> {
    let [first, second] = compressions.map(|e| 0.5 * ((1.0 - e).powi(2) - 1.0));
    let along = strain.direction * strain.direction.transpose();
    along * first + (Matrix2::identity() - along) * second
}
