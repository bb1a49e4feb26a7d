//! Topology, typed ids, material points, Loop subdivision and surface lookup for triangle meshes.
#![doc = include_str!("../README.md")]
//!
//! ## Parts
//!
//! A [`TriMesh`] is faces, edges and their incidence; it never holds positions. A
//! [`MaterialPoint`] (face, barycentric coordinates) is the one address for a place on a surface.
//! [`subdivide`] refines a mesh by Loop's rules and says, as [`SparseRows`], how any per-vertex
//! quantity follows; [`limit_rows`] evaluates the limit surface at vertices and [`LoopSurface`] at
//! any material point, where a [`SurfaceJet`] tells normal and curvature. [`PlanarLookup`] finds
//! the material point under a texture coordinate, [`SurfaceLookup`] the closest one to a point in
//! space; [`tangent_coordinates`] unrolls a neighbourhood. [`weld`] joins vertices that a file repeats, and
//! [`intersecting_pairs`] finds where a surface passes through itself.
//!
//! Positions given to a function are in metres, but nothing here depends on the unit.

mod block_pattern;
mod box_spline;
mod edge_split;
mod error;
mod face_place;
mod geodesic;
mod geometry;
mod ids;
mod irregular_sector;
mod limit_points;
mod loop_subdivision;
mod loop_surface;
mod material_point;
mod planar_lookup;
mod self_intersection;
mod sparse_rows;
mod surface_jet;
mod surface_lookup;
mod tangent_coordinates;
mod topology;
mod vertex_fan;
mod weld;

pub use material_point::MaterialPoint;
pub use topology::{Edge, Submesh, TriMesh};
pub use vertex_fan::VertexFan;

pub use block_pattern::{BlockPattern, BlockSlot};
pub use edge_split::{BornVertex, EdgeSplit, SplitFaces, split_edges, split_faces};
pub use error::MeshError;
pub use geodesic::{edge_distances, edge_distances_with_starts};
pub use geometry::{
    face_areas, face_normals, mean_edge_lengths, sharp_border_corners, triangle_frame,
    vertex_areas, vertex_means, vertex_normals,
};
pub use ids::{EdgeId, FaceId, Id, PerEdge, PerElement, PerFace, PerVertex, VertexId};
pub use limit_points::LimitPoints;
pub use loop_subdivision::{
    FaceOrigin, LimitRows, Subdivision, limit_rows, limit_rows_at, subdivide, subdivide_while,
};
pub use loop_surface::{LimitPointRows, LoopSurface};
pub use planar_lookup::{PlanarLookup, barycentric};
pub use self_intersection::intersecting_pairs;
pub use sparse_rows::SparseRows;
pub use surface_jet::{SurfaceJet, TangentPlane};
pub use surface_lookup::{ClosestPlace, SurfaceLookup, closest_on_triangle};
pub use tangent_coordinates::{
    TangentCentre, TangentCoordinates, tangent_coordinates, tangent_frame,
};
pub use weld::{Weld, weld};
