//! Points that are one vertex, although a file repeats them.

use nalgebra::Vector3;

use crate::{Id, VertexId};

/// Which points of a list are the same, and what vertices they make.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Weld {
    /// The vertex that each point becomes.
    pub vertices: Vec<VertexId>,
    /// The first of the points that each vertex was made of; ascending.
    pub points: Vec<usize>,
}

/// Makes one vertex of all points that agree, to the last bit, in every one of the `columns`.
///
/// A column is one value per point: its position and, where there are blend shapes, its
/// displacement by each of them, so that lips which touch at rest stay apart. Files repeat a vertex
/// along the seams of its texture, and repeat it exactly; points that are merely close are left
/// alone.
///
/// ```
/// use nalgebra::Vector3;
/// use ruga_mesh::weld;
///
/// let [a, b, c] = [0.0, 1.0, 2.0].map(|x| Vector3::new(x, 0.0, 0.0));
/// let found = weld(&[&[a, b, a, c, b]]);
/// assert_eq!(found.vertices.iter().map(|v| v.0).collect::<Vec<_>>(), [0, 1, 0, 2, 1]);
/// assert_eq!(found.points, [0, 1, 3]);
/// ```
///
/// # Panics
/// When the columns differ in length.
pub fn weld(columns: &[&[Vector3<f64>]]) -> Weld {
    let count = columns.first().map_or(0, |column| column.len());
    assert!(
        columns.iter().all(|column| column.len() == count),
        "columns of one length"
    );
    // Adding zero turns -0 into 0, so that equal numbers have equal bits.
    let bits = |p: &Vector3<f64>| [p.x, p.y, p.z].map(|c| (c + 0.0).to_bits());
    let key = |point: usize| columns.iter().map(move |column| bits(&column[point]));
    let mut order: Vec<usize> = (0..count).collect();
    // Ties in the order of the points: each group then begins with its first point.
    order.sort_by(|&a, &b| key(a).cmp(key(b)).then(a.cmp(&b)));
    let mut first_alike = vec![0; count];
    for group in order.chunk_by(|&a, &b| key(a).eq(key(b))) {
        for &point in group {
            first_alike[point] = group[0];
        }
    }
    let mut points = Vec::new();
    let mut vertices: Vec<VertexId> = Vec::with_capacity(count);
    for (point, &first) in first_alike.iter().enumerate() {
        if first == point {
            vertices.push(VertexId::from_index(points.len()));
            points.push(point);
        } else {
            // The first of a group is never later than this point, so its vertex is known.
            vertices.push(vertices[first]);
        }
    }
    Weld { vertices, points }
}
