//! Faces that meet along edges.

/// Face number that stands for none.
pub(crate) const NONE: u32 = u32::MAX;

/// The face across the edge opposite each corner; [`NONE`] at borders and where more than two meet.
pub(crate) fn adjacent_faces(faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut edges: Vec<([u32; 2], u32, u8)> = Vec::with_capacity(3 * faces.len());
    for (face, corners) in (0..).zip(faces) {
        for corner in 0..3 {
            let [a, b] = [corners[(corner + 1) % 3], corners[(corner + 2) % 3]];
            edges.push(([a.min(b), a.max(b)], face, corner as u8));
        }
    }
    edges.sort_unstable();
    let mut adjacent = vec![[NONE; 3]; faces.len()];
    for same in edges.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, one, at), (_, other, there)] = same {
            adjacent[*one as usize][*at as usize] = *other;
            adjacent[*other as usize][*there as usize] = *one;
        }
    }
    adjacent
}
