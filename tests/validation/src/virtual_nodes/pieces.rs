//! Triangles in pieces: what straight cuts leave of each, by barycentric coordinates.

/// Distance in barycentric coordinates below which two points are one.
pub(super) const SAME: f64 = 1e-9;

/// A straight way through a triangle, from its border to its border, by barycentric coordinates.
pub(super) type Chord = [[f64; 3]; 2];

/// A convex part of a triangle.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// The triangle.
    pub(super) face: usize,
    /// Corners in order, by barycentric coordinates.
    pub(super) polygon: Vec<[f64; 3]>,
}

impl Piece {
    fn whole(face: usize) -> Self {
        Self {
            face,
            polygon: vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        }
    }

    /// Part of the triangle's area.
    pub(super) fn share(&self) -> f64 {
        let fan = self.polygon[1..].windows(2);
        fan.map(|pair| doubled_area([self.polygon[0], pair[0], pair[1]]))
            .sum()
    }

    /// Stretch of the side from `corner` to the next that belongs to the piece, in fractions of the way.
    pub(super) fn side(&self, corner: usize) -> Option<[f64; 2]> {
        let on_side = self
            .polygon
            .iter()
            .filter(|p| p[(corner + 2) % 3].abs() < SAME);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for point in on_side {
            low = low.min(point[(corner + 1) % 3]);
            high = high.max(point[(corner + 1) % 3]);
        }
        (high - low > SAME).then_some([low, high])
    }

    /// Whether a corner of the triangle belongs to the piece, and not only as the end of a cut.
    pub(super) fn has(&self, corner: usize) -> bool {
        self.polygon.iter().any(|p| p[corner] > 1.0 - SAME)
    }

    /// Corners of the polygon inside the triangle, where cuts cross.
    pub(super) fn crossings(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let inside = |p: &[f64; 3]| p.iter().all(|share| *share > SAME);
        self.polygon.iter().copied().filter(inside)
    }

    /// The parts on either side of the straight line through a chord.
    fn split(&self, chord: &Chord) -> Vec<Self> {
        let off = |p: &[f64; 3]| doubled_area([chord[0], chord[1], *p]);
        let half = |sign: f64| {
            let mut polygon = Vec::new();
            for (i, p) in self.polygon.iter().enumerate() {
                let q = &self.polygon[(i + 1) % self.polygon.len()];
                let [a, b] = [p, q].map(|p| sign * off(p));
                if a > -SAME {
                    polygon.push(*p);
                }
                if (a > SAME && b < -SAME) || (a < -SAME && b > SAME) {
                    let share = a / (a - b);
                    polygon.push(std::array::from_fn(|k| p[k] + share * (q[k] - p[k])));
                }
            }
            let face = self.face;
            Self { face, polygon }
        };
        let halves = [1.0, -1.0].map(half).into_iter();
        halves
            .filter(|half| half.polygon.len() > 2 && half.share() > SAME * SAME)
            .collect()
    }
}

/// What chords leave of a triangle.
pub(super) fn pieces(face: usize, chords: &[Chord]) -> Vec<Piece> {
    let mut all = vec![Piece::whole(face)];
    for chord in chords {
        all = all.iter().flat_map(|piece| piece.split(chord)).collect();
    }
    all
}

/// Area of a triangle in units of the one that barycentric coordinates are of, with its sign.
fn doubled_area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossing_cuts_leave_four_pieces_that_fill_the_triangle() {
        let chords = [
            [[0.5, 0.5, 0.0], [0.0, 0.4, 0.6]],
            [[0.3, 0.0, 0.7], [0.2, 0.8, 0.0]],
        ];
        let all = pieces(0, &chords);
        assert_eq!(all.len(), 4);
        let sum: f64 = all.iter().map(Piece::share).sum();
        assert!((sum - 1.0).abs() < 1e-12);
        assert_eq!(all.iter().filter(|p| p.crossings().count() == 1).count(), 4);
        let corners: usize = all
            .iter()
            .map(|p| (0..3).filter(|&c| p.has(c)).count())
            .sum();
        assert_eq!(corners, 3);
    }
}
