//! The energy of one layer, or of two that move together.

use nalgebra::{Matrix2, Vector3};
use ruga_material::{LayerMaterial, StackPair};
use ruga_shell::{
    BendingModel, FaceParameters, FoundationStiffness, JointEnergy, LayerEnergy, LayerParameters,
    ShellError, TieParameters,
};

/// The upper one of two layers that move together.
#[derive(Clone, Debug)]
pub(crate) struct UpperShell {
    /// Name in reports.
    pub(crate) name: String,
    /// Number of the layer in its stack.
    pub(crate) index: usize,
    /// Distance of the mid-surfaces, m.
    pub(crate) lever: f64,
    material: LayerMaterial,
    tie: TieParameters,
}

impl UpperShell {
    /// Number `index` of the stack, named `name`, the upper one of `pair`.
    pub(crate) fn new(name: &str, index: usize, pair: &StackPair, lever: f64) -> Self {
        let springs = &pair.upper.wrinkling;
        Self {
            name: name.to_owned(),
            index,
            lever,
            material: pair.upper.material,
            tie: TieParameters {
                normal_stiffness: springs.normal_stiffness,
                gradient_stiffness: springs.gradient_stiffness,
                tangential_stiffness: pair.shear_tie(),
            },
        }
    }

    /// m.
    pub(crate) fn thickness(&self) -> f64 {
        self.material.thickness
    }

    /// kg/m².
    pub(crate) fn mass_per_area(&self) -> f64 {
        self.material.density * self.material.thickness
    }

    /// The shell without anything below it.
    fn parameters(&self, faces: usize, vertices: usize) -> LayerParameters {
        let face = FaceParameters {
            young: self.material.young,
            poisson: self.material.poisson,
            thickness: self.material.thickness,
            normal_stiffness: 0.0,
            gradient_stiffness: 0.0,
        };
        LayerParameters::uniform(face, faces, 0.0, vertices)
    }
}

/// The energy that a solve minimises: positions are those of the lower layer, then, where there is
/// one, those of the upper.
#[derive(Clone, Debug)]
pub(crate) enum SkinEnergy {
    One(Box<LayerEnergy>),
    Two(Box<JointEnergy>, f64),
}

impl SkinEnergy {
    /// A layer at rest at `rest` (m), and an upper one along the unit `normals` above it.
    pub(crate) fn new(
        (rest, normals): (&[Vector3<f64>], &[Vector3<f64>]),
        faces: &[[u32; 3]],
        parameters: LayerParameters,
        upper: Option<&UpperShell>,
        bending: BendingModel,
        pinned: &[bool],
    ) -> Result<Self, ShellError> {
        let lower = LayerEnergy::with_bending(rest, faces, parameters, pinned, bending)?;
        let Some(upper) = upper else {
            return Ok(Self::One(Box::new(lower)));
        };
        let above = lifted(rest, normals, upper.lever);
        let parameters = upper.parameters(faces.len(), rest.len());
        let shell = LayerEnergy::with_bending(&above, faces, parameters, pinned, bending)?;
        let ties = vec![upper.tie; faces.len()];
        let levers = vec![upper.lever; rest.len()];
        let joint = JointEnergy::new(lower, shell, &ties, &levers)?;
        Ok(Self::Two(Box::new(joint), upper.lever))
    }

    /// Where the layers would lie on a surface without wrinkles.
    pub(crate) fn laid_on(
        &self,
        points: &[Vector3<f64>],
        normals: &[Vector3<f64>],
    ) -> Vec<Vector3<f64>> {
        let mut positions = points.to_vec();
        if let Self::Two(_, lever) = self {
            positions.extend(lifted(points, normals, *lever));
        }
        positions
    }

    pub(crate) fn set_base(
        &mut self,
        points: &[Vector3<f64>],
        normals: &[Vector3<f64>],
    ) -> Result<(), ShellError> {
        let no_offset = vec![0.0; points.len()];
        match self {
            Self::One(layer) => layer.set_base(points, normals, &no_offset),
            Self::Two(joint, _) => joint.set_base(points, normals, &no_offset),
        }
    }

    /// `positions` of all layers.
    pub(crate) fn set_rest_angles(&mut self, positions: &[Vector3<f64>]) -> Result<(), ShellError> {
        match self {
            Self::One(layer) => layer.set_rest_angles(positions),
            Self::Two(joint, _) => joint.set_rest_angles(positions),
        }
    }

    /// One stretch per face, of all layers.
    pub(crate) fn set_rest_metric(&mut self, stretches: &[Matrix2<f64>]) -> Result<(), ShellError> {
        match self {
            Self::One(layer) => layer.set_rest_metric(stretches),
            Self::Two(joint, _) => joint.set_rest_metric(stretches, stretches),
        }
    }

    /// One Green strain without stress per face, of all layers.
    pub(crate) fn set_natural_strains(
        &mut self,
        strains: &[Matrix2<f64>],
    ) -> Result<(), ShellError> {
        match self {
            Self::One(layer) => layer.set_natural_strains(strains),
            Self::Two(joint, _) => joint.set_natural_strains(strains, strains),
        }
    }

    pub(crate) fn set_bending_factor(&mut self, factor: f64) -> Result<(), ShellError> {
        match self {
            Self::One(layer) => layer.set_bending_factor(factor),
            Self::Two(joint, _) => joint.set_bending_factor(factor),
        }
    }

    /// Column starts and rows of the Hessian's lower triangle.
    pub(crate) fn pattern(&self) -> (&[usize], &[usize]) {
        match self {
            Self::One(layer) => layer.pattern(),
            Self::Two(joint, _) => joint.pattern(),
        }
    }

    /// Rest area of every vertex of the mesh, m².
    pub(crate) fn vertex_areas(&self) -> &[f64] {
        match self {
            Self::One(layer) => layer.vertex_areas(),
            Self::Two(joint, _) => joint.lower().vertex_areas(),
        }
    }

    pub(crate) fn value(&self, x: &[Vector3<f64>]) -> f64 {
        match self {
            Self::One(layer) => layer.value(x),
            Self::Two(joint, _) => joint.value(x),
        }
    }

    /// Energy (J) with the surface below at other `points` (m) but with the same normals.
    pub(crate) fn value_over(&self, x: &[Vector3<f64>], points: &[Vector3<f64>]) -> f64 {
        match self {
            Self::One(layer) => layer.value_over(x, points),
            Self::Two(joint, _) => joint.value_over(x, points),
        }
    }

    /// Writes the gradient with the surface below at other `points` (m), and returns how the springs
    /// below pull at the vertices of the mesh (N).
    pub(crate) fn gradient_over(
        &self,
        x: &[Vector3<f64>],
        points: &[Vector3<f64>],
        gradient: &mut [f64],
    ) -> Vec<Vector3<f64>> {
        match self {
            Self::One(layer) => layer.gradient_over(x, points, gradient),
            Self::Two(joint, _) => joint.gradient_over(x, points, gradient),
        }
    }

    /// Stiffness of the springs below the lower layer.
    pub(crate) fn foundation_stiffness(&self) -> FoundationStiffness {
        match self {
            Self::One(layer) => layer.foundation_stiffness(),
            Self::Two(joint, _) => joint.lower().foundation_stiffness(),
        }
    }

    /// Number of vertices, of both layers.
    pub(crate) fn vertex_count(&self) -> usize {
        match self {
            Self::One(layer) => layer.vertex_count(),
            Self::Two(joint, _) => joint.vertex_count(),
        }
    }

    pub(crate) fn gradient(&self, x: &[Vector3<f64>], gradient: &mut [f64]) {
        match self {
            Self::One(layer) => layer.gradient(x, gradient),
            Self::Two(joint, _) => joint.gradient(x, gradient),
        }
    }

    pub(crate) fn hessian(&self, x: &[Vector3<f64>], exact: &mut [f64], relaxed: &mut [f64]) {
        match self {
            Self::One(layer) => layer.hessian(x, exact, Some(relaxed)),
            Self::Two(joint, _) => joint.hessian(x, exact, Some(relaxed)),
        }
    }
}

fn lifted(points: &[Vector3<f64>], normals: &[Vector3<f64>], lever: f64) -> Vec<Vector3<f64>> {
    let pairs = points.iter().zip(normals);
    pairs
        .map(|(point, normal)| point + normal * lever)
        .collect()
}
