//! The upper one of two layers that move together.

use nalgebra::Vector3;
use ruga_material::StackPair;
use ruga_shell::{FaceParameters, LayerParameters, UpperSheet};

use crate::skin::local_skin::LocalSkin;

/// The upper one of two layers that move together.
#[derive(Clone, Debug)]
pub(crate) struct UpperShell {
    /// Name in reports.
    pub(crate) name: String,
    /// Number of the layer in its stack.
    pub(crate) index: usize,
    /// Mid-surface offset from the lower layer, m.
    pub(crate) offset: f64,
    /// What it is made of, and how it wrinkles by itself.
    pub(crate) local: LocalSkin,
    /// Stiffnesses towards the lower layer, Pa/m, N/m and Pa/m.
    normal: f64,
    gradient: f64,
    tangential: f64,
}

impl UpperShell {
    /// The upper layer of `pair`, number `index` of the stack.
    pub(crate) fn new(name: &str, index: usize, pair: &StackPair, offset: f64) -> Self {
        let springs = &pair.upper.wrinkling;
        Self {
            name: name.to_owned(),
            index,
            offset,
            local: LocalSkin {
                material: pair.upper.material,
                wrinkling: *springs,
            },
            // The springs stand for the lower layer being squeezed across its thickness, which a
            // shell cannot be. How the lower shell itself gives way comes in series with them, so
            // that nothing counts twice.
            normal: springs.normal_stiffness,
            gradient: springs.gradient_stiffness,
            // Of seven multiples between 0 and 100 only the shear stiffness itself gave wavelength
            // and strain of all pairs of layers that were compared with an exact stack.
            tangential: pair.shear_tangential_stiffness(),
        }
    }

    /// Thickness of the layer, m.
    pub(crate) fn thickness(&self) -> f64 {
        self.local.material.thickness
    }

    /// Mass per area, kg/m².
    pub(crate) fn mass_per_area(&self) -> f64 {
        self.local.mass_per_area()
    }

    /// Critical strain of the layer on the lower one.
    pub(crate) fn critical_strain(&self) -> f64 {
        self.local.wrinkling.critical_strain
    }

    /// The layer with so many faces above places (m) with these unit normals.
    pub(crate) fn sheet(
        &self,
        (points, normals): (&[Vector3<f64>], &[Vector3<f64>]),
        faces: usize,
    ) -> UpperSheet {
        let face = FaceParameters {
            young: self.local.material.young,
            poisson: self.local.material.poisson,
            thickness: self.local.material.thickness,
            normal_stiffness: self.normal,
            gradient_stiffness: self.gradient,
        };
        let vertices = points.len();
        UpperSheet {
            rest_positions: self.above(points, normals).collect(),
            parameters: LayerParameters::uniform(face, faces, self.tangential, vertices),
            offsets: vec![self.offset; vertices],
        }
    }

    /// Positions of its vertices over places (m) with these unit normals.
    pub(crate) fn above<'a>(
        &self,
        points: &'a [Vector3<f64>],
        normals: &'a [Vector3<f64>],
    ) -> impl Iterator<Item = Vector3<f64>> + use<'a> {
        let offset = self.offset;
        let pairs = points.iter().zip(normals);
        pairs.map(move |(point, normal)| point + normal * offset)
    }
}
