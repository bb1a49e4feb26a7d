//! The mesh that temperature and fuel live on.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use ruga_mesh::{Id, PerEdge, PerVertex, TriMesh};

use crate::error::check_field;
use crate::intrinsic::{FLIP_TOLERANCE, IntrinsicEdge, IntrinsicMesh};
use crate::{BurnError, BurnLaw};

/// Areas and cotangent weights of a triangulation in its rest metric.
///
/// The triangulation is flipped to an intrinsic Delaunay one when it is built, so that heat flows
/// along every edge from hot to cold and no time step makes a new extreme of temperature. Vertices and
/// their numbers stay; faces are named by the numbers that they had in the given mesh.
///
/// Where an edge of the border lies opposite an obtuse angle, its weight is negative and cannot be
/// flipped away: it is set to 0 and counted in [`FieldMesh::clipped`].
#[derive(Clone, Debug)]
pub struct FieldMesh {
    faces: Vec<[u32; 3]>,
    areas: PerVertex<f64>,
    spacings: PerVertex<f64>,
    edges: Vec<FieldEdge>,
    face_corners: Vec<[u32; 3]>,
    mixtures: BTreeMap<u32, Vec<(u32, f64)>>,
    mean_edge: f64,
    flips: usize,
    clipped: usize,
}

/// An edge along which heat flows.
#[derive(Clone, Debug)]
pub(crate) struct FieldEdge {
    pub(crate) vertices: [u32; 2],
    /// Flipped triangle and half the cotangent of its angle opposite the edge.
    sides: [Option<(u32, f64)>; 2],
}

impl FieldMesh {
    /// Builds the field mesh of a surface with rest positions (m), one per vertex.
    ///
    /// # Errors
    /// [`BurnError::FieldSize`], [`BurnError::FieldOutOfRange`] for a coordinate that is not finite,
    /// and those of [`FieldMesh::from_lengths`].
    pub fn new(mesh: &TriMesh, positions: &[Vector3<f64>]) -> Result<Self, BurnError> {
        let norms: Vec<f64> = positions.iter().map(|x| x.norm()).collect();
        let accepted = "finite coordinates (m)";
        check_field(
            "distance of a rest position from the origin",
            &norms,
            mesh.vertex_count(),
            accepted,
            f64::is_finite,
        )?;
        let lengths = mesh.edges().as_slice().iter().map(|edge| {
            let [a, b] = edge.vertices.map(|v| positions[v.index()]);
            (b - a).norm()
        });
        Self::from_lengths(mesh, &lengths.collect())
    }

    /// Builds the field mesh of a surface that is known by the rest lengths of its edges (m).
    ///
    /// # Errors
    /// [`BurnError::FieldSize`], [`BurnError::NoFaces`], [`BurnError::LooseVertex`], or
    /// [`BurnError::DegenerateFace`] for the first triangle without area.
    pub fn from_lengths(mesh: &TriMesh, lengths: &PerEdge<f64>) -> Result<Self, BurnError> {
        check_field(
            "rest length of an edge",
            lengths.as_slice(),
            mesh.edges().len(),
            "finite, at least 0 m",
            |length| length.is_finite() && length >= 0.0,
        )?;
        if mesh.face_count() == 0 {
            return Err(BurnError::NoFaces);
        }
        let mut intrinsic = IntrinsicMesh::new(mesh, lengths)?;
        intrinsic.flip_to_delaunay();
        let faces = mesh.faces().as_slice().iter().map(|f| f.map(|v| v.0));
        Self::of_intrinsic(intrinsic, mesh.vertex_count(), faces.collect())
    }

    fn of_intrinsic(
        intrinsic: IntrinsicMesh,
        vertex_count: usize,
        faces: Vec<[u32; 3]>,
    ) -> Result<Self, BurnError> {
        let face_corners: Vec<_> = (0..faces.len() as u32)
            .map(|f| intrinsic.corners(f))
            .collect();
        let areas = lumped_areas(&intrinsic, &face_corners, vertex_count);
        if let Some((vertex, _)) = areas.iter().find(|(_, area)| **area <= 0.0) {
            let vertex = vertex.index();
            return Err(BurnError::LooseVertex { vertex });
        }
        let all_edges: Vec<IntrinsicEdge> = intrinsic.edges().collect();
        let spacings = mean_lengths(&all_edges, vertex_count);
        let mean_edge =
            all_edges.iter().map(|edge| edge.length).sum::<f64>() / all_edges.len() as f64;
        let edges: Vec<FieldEdge> = all_edges.into_iter().filter_map(FieldEdge::new).collect();
        let clipped = edges.iter().filter(|edge| edge.is_clipped()).count();
        Ok(Self {
            faces,
            areas,
            spacings,
            edges,
            face_corners,
            mean_edge,
            flips: intrinsic.flips(),
            clipped,
            mixtures: intrinsic.into_mixtures(),
        })
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.areas.len()
    }

    /// Number of faces, before and after flipping.
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// Area of the sheet that each vertex stands for (m²): a third of the flipped triangles around it.
    pub fn areas(&self) -> &PerVertex<f64> {
        &self.areas
    }

    /// Mean length of the edges (m).
    pub fn mean_edge(&self) -> f64 {
        self.mean_edge
    }

    /// Number of edges that were flipped to make the triangulation Delaunay.
    pub fn flips(&self) -> usize {
        self.flips
    }

    /// Number of edges whose weight stayed negative and was set to 0: border edges opposite an obtuse
    /// angle, which then conduct too little.
    pub fn clipped(&self) -> usize {
        self.clipped
    }

    /// Edges of this mesh per width of a front, from which its accuracy follows: 2 is a draft, 4 the
    /// standard, 8 fine.
    ///
    /// # Errors
    /// Those of [`Front::of`](crate::Front::of).
    pub fn edges_per_width(&self, law: &BurnLaw) -> Result<f64, BurnError> {
        Ok(crate::Front::of(law)?.width / self.mean_edge)
    }

    /// Mean length of the edges at each vertex (m).
    pub(crate) fn spacings(&self) -> &PerVertex<f64> {
        &self.spacings
    }

    pub(crate) fn edges(&self) -> &[FieldEdge] {
        &self.edges
    }

    /// Shares of the flipped triangles that conduct, from those of the given ones.
    ///
    /// A flipped triangle conducts as the mean of the given ones under it, weighted by area; but not at
    /// all when it has a corner around which everything is gone.
    pub(crate) fn flipped_shares(&self, shares: &[f64]) -> Vec<f64> {
        let mut largest = vec![0.0_f64; self.vertex_count()];
        for (corners, &share) in self.faces.iter().zip(shares) {
            for &v in corners {
                largest[v as usize] = largest[v as usize].max(share);
            }
        }
        let mut flipped = shares.to_vec();
        for (&face, mixture) in &self.mixtures {
            let mean = mixture
                .iter()
                .map(|&(part, weight)| weight * shares[part as usize])
                .sum();
            let corners = self.face_corners[face as usize];
            let is_cut_off = corners.iter().any(|&v| largest[v as usize] == 0.0);
            flipped[face as usize] = if is_cut_off { 0.0 } else { mean };
        }
        flipped
    }
}

impl FieldEdge {
    /// None for an edge that begins and ends at one vertex: it carries no heat.
    fn new(edge: IntrinsicEdge) -> Option<Self> {
        let [a, b] = edge.vertices;
        (a != b).then_some(Self {
            vertices: edge.vertices,
            sides: edge.sides,
        })
    }

    /// Whether heat would flow against the difference of temperature, by more than rounding.
    fn is_clipped(&self) -> bool {
        let halves = || self.sides.iter().flatten().map(|side| side.1);
        halves().sum::<f64>() < -FLIP_TOLERANCE * halves().map(f64::abs).sum::<f64>()
    }

    /// Conductance of the edge per diffusivity, where `shares` of the flipped triangles are left; not negative.
    pub(crate) fn conductance(&self, shares: &[f64]) -> f64 {
        let sides = self.sides.iter().flatten();
        let sum: f64 = sides
            .map(|&(face, half)| shares[face as usize] * half)
            .sum();
        sum.max(0.0)
    }
}

fn lumped_areas(
    intrinsic: &IntrinsicMesh,
    face_corners: &[[u32; 3]],
    vertex_count: usize,
) -> PerVertex<f64> {
    let mut areas = vec![0.0; vertex_count];
    for (face, corners) in face_corners.iter().enumerate() {
        for &v in corners {
            areas[v as usize] += intrinsic.area(face as u32) / 3.0;
        }
    }
    areas.into()
}

fn mean_lengths(edges: &[IntrinsicEdge], vertex_count: usize) -> PerVertex<f64> {
    let mut sums = vec![(0.0, 0.0_f64); vertex_count];
    for edge in edges {
        for v in edge.vertices {
            sums[v as usize].0 += edge.length;
            sums[v as usize].1 += 1.0;
        }
    }
    sums.iter().map(|(sum, count)| sum / count).collect()
}
