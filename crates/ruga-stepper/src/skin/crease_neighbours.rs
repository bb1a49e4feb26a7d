//! The skin beside creases, and the way they run there.

use nalgebra::Vector3;
use ruga_mesh::{Id, PerVertex, VertexId, edge_distances};

use crate::skin::skin_mesh::SkinMesh;

/// A vertex near a crease.
pub(crate) struct NearCrease {
    pub(crate) vertex: usize,
    /// Its distance from the crease along edges, m.
    pub(crate) distance: f64,
    /// Unit vector along the crease at its closest place.
    pub(crate) along: Vector3<f64>,
    /// Vertex on a crease, the closest one up to an edge.
    pub(crate) origin: VertexId,
}

/// The vertices within `reach` (m) of those creases for whose lines `is_meant` holds, the closest first.
pub(crate) fn near_creases(
    skin: &SkinMesh,
    reach: f64,
    is_meant: impl Fn(usize) -> bool,
) -> Vec<NearCrease> {
    let creases = skin.creases.iter().filter(|crease| is_meant(crease.line));
    if creases.clone().next().is_none() {
        return Vec::new();
    }
    let (mesh, rest) = (&skin.mesh, &skin.rest.positions);
    let mut along = vec![Vector3::zeros(); rest.len()];
    let mut origins: PerVertex<VertexId> = (0..rest.len()).map(VertexId::from_index).collect();
    let mut on: Vec<VertexId> = Vec::new();
    for crease in creases {
        let ends = mesh.edges()[crease.edge].vertices;
        let way = rest[ends[1].index()] - rest[ends[0].index()];
        for v in ends {
            // Edges of a line run one way or the other.
            let sum: &mut Vector3<f64> = &mut along[v.index()];
            *sum += if way.dot(sum) < 0.0 { -way } else { way };
        }
        on.extend(ends);
    }
    let distances = edge_distances(mesh, rest, on, reach);
    let near = distances
        .iter()
        .filter(|(_, distance)| distance.is_finite());
    let mut near: Vec<(VertexId, f64)> = near.map(|(v, distance)| (v, *distance)).collect();
    near.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    let found = near.into_iter().map(|(v, distance)| {
        if distance > 0.0 {
            // What is closest among the neighbours has been reached before.
            let around = mesh.vertex_faces(v).iter();
            let around = around.flat_map(|&face| mesh.faces()[face]);
            let closest = around.min_by(|a, b| distances[*a].total_cmp(&distances[*b]));
            along[v.index()] = closest.map_or(Vector3::zeros(), |other| along[other.index()]);
            origins[v] = closest.map_or(v, |other| origins[other]);
        }
        let direction = along[v.index()].try_normalize(0.0);
        NearCrease {
            vertex: v.index(),
            distance,
            along: direction.unwrap_or_else(Vector3::zeros),
            origin: origins[v],
        }
    });
    found.collect()
}
