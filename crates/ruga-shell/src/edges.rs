//! The edges of an indexed triangle mesh and the faces on their two sides.

use crate::ShellError;

/// An edge as its left face winds it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    /// Tail and head.
    pub(crate) ends: [u32; 2],
    /// The face that winds tail→head, and the corner of that face which is the tail.
    pub(crate) left: Side,
    /// The face that winds head→tail, and the corner of it which is the head.
    pub(crate) right: Option<Side>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    pub(crate) face: usize,
    pub(crate) corner: usize,
}

impl Side {
    /// The vertex opposite the edge.
    pub(crate) fn apex(&self, faces: &[[u32; 3]]) -> u32 {
        faces[self.face][(self.corner + 2) % 3]
    }
}

impl Edge {
    /// Tail, head, left apex, right apex, if two faces meet here.
    pub(crate) fn hinge(&self, faces: &[[u32; 3]]) -> Option<([u32; 4], Side)> {
        let right = self.right?;
        let [tail, head] = self.ends;
        Some((
            [tail, head, self.left.apex(faces), right.apex(faces)],
            right,
        ))
    }
}

/// All edges, sorted by their lower and then their higher end.
pub(crate) fn edges(faces: &[[u32; 3]], vertices: usize) -> Result<Vec<Edge>, ShellError> {
    check_faces(faces, vertices)?;
    let mut halves: Vec<(u32, u32, Side)> = Vec::with_capacity(3 * faces.len());
    for (face, corners) in faces.iter().enumerate() {
        for corner in 0..3 {
            let (tail, head) = (corners[corner], corners[(corner + 1) % 3]);
            halves.push((tail, head, Side { face, corner }));
        }
    }
    halves.sort_by_key(|&(tail, head, side)| (tail.min(head), tail.max(head), side.face));
    let same = |a: &(u32, u32, Side), b: &(u32, u32, Side)| {
        a.0.min(a.1) == b.0.min(b.1) && a.0.max(a.1) == b.0.max(b.1)
    };
    halves
        .chunk_by(same)
        .map(|half| pair(half, faces))
        .collect()
}

fn pair(halves: &[(u32, u32, Side)], faces: &[[u32; 3]]) -> Result<Edge, ShellError> {
    let (tail, head, left) = halves[0];
    let right = match halves {
        [_] => None,
        [_, (other_tail, _, right)] => {
            if *other_tail == tail {
                return Err(ShellError::InconsistentOrientation { tail, head });
            }
            if left.apex(faces) == right.apex(faces) {
                return Err(ShellError::NonManifoldEdge { tail, head });
            }
            Some(*right)
        }
        _ => return Err(ShellError::NonManifoldEdge { tail, head }),
    };
    Ok(Edge {
        ends: [tail, head],
        left,
        right,
    })
}

fn check_faces(faces: &[[u32; 3]], count: usize) -> Result<(), ShellError> {
    for (face, corners) in faces.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= count) {
            return Err(ShellError::VertexOutOfRange {
                face,
                vertex,
                count,
            });
        }
        let [a, b, c] = *corners;
        if a == b || b == c || c == a {
            return Err(ShellError::RepeatedVertex { face });
        }
    }
    Ok(())
}
