//! The choice between the two bending energies.

/// How the bending energy of a layer is made up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BendingModel {
    /// A [`Hinge`](crate::Hinge) per inner edge: the cheaper one, and right on meshes that are
    /// nearly equilateral. On triangles stretched 2:1 it is from 20 % too soft to 170 % too stiff, by
    /// direction, and its Poisson ratio is -1/3 whatever the material's.
    Hinge,
    /// The curvature of a [`StarShape`](crate::StarShape) per vertex: the modulus is that of the plate, to
    /// 3 % at 12 edges per wavelength, on irregular triangles and on those stretched 2:1 in any
    /// direction or 4:1 with the short side across the wrinkles; the Poisson ratio is that of the
    /// material. At 4:1 with the long side across the wrinkles it is 6 to 23 % too stiff. The Hessian
    /// couples all vertices around a vertex, half as many again as with hinges, and takes twice as
    /// long.
    VertexCurvature,
}
