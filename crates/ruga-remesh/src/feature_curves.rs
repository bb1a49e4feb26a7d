//! A surface with curves that features of a mesh are kept on.

use nalgebra::Vector3;
use ruga_mesh::MaterialPoint;

use crate::Surface;

/// Distance of the ends of an edge from a curve, in lengths of the edge, up to which the edge lies on the curve:
/// what chords of a curve over a bent surface leave, and less than there is between two curves.
const ON_CURVE: f64 = 0.1;

/// A curve over a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureCurve {
    /// Its pieces in order, each with both ends addressed in one face, in which it runs straight.
    pub pieces: Vec<[MaterialPoint; 2]>,
    /// Whether it ends where it began.
    pub is_closed: bool,
}

/// A [`Surface`] with curves: features whose ends lie on one of them are split on it.
///
/// An edge that approximates a bent curve is a chord, and halves of chords do not come nearer to the curve.
/// Split here, they do. Features that lie on no curve are those of the surface itself.
pub struct FeatureCurves<'a> {
    surface: &'a dyn Surface,
    curves: Vec<Polyline>,
}

/// A curve with the positions of its pieces (m).
struct Polyline {
    pieces: Vec<Piece>,
    is_closed: bool,
}

struct Piece {
    ends: [MaterialPoint; 2],
    positions: [Vector3<f64>; 2],
    /// Length of the curve before it (m).
    start: f64,
    length: f64,
}

/// Where a curve comes closest to a place.
#[derive(Clone, Copy)]
struct Closest {
    piece: usize,
    /// Fraction of the way along the piece.
    fraction: f64,
    distance: f64,
    /// Length of the curve before it (m).
    at: f64,
}

impl<'a> FeatureCurves<'a> {
    /// The surface with some curves on it.
    ///
    /// # Panics
    /// When a piece of a curve has its ends in two faces, or names one that the surface does not have.
    pub fn new(surface: &'a dyn Surface, curves: &[FeatureCurve]) -> Self {
        let curves = curves.iter().map(|curve| Polyline::new(surface, curve));
        Self {
            surface,
            curves: curves.collect(),
        }
    }

    /// The place of a curve between two of its places that is closest to a target, if they lie on one.
    fn on_curve(&self, ends: [Vector3<f64>; 2], target: Vector3<f64>) -> Option<MaterialPoint> {
        let reach = ON_CURVE * (ends[1] - ends[0]).norm();
        let found = self.curves.iter().filter_map(|curve| {
            let [a, b] = curve.nearest_passages(ends, reach)?;
            Some((a.distance.max(b.distance), curve, [a.at, b.at]))
        });
        // Where curves cross, an end lies on both.
        let (_, curve, between) = found.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let closest = curve.closest(target, between)?;
        Some(curve.place(closest))
    }
}

impl Polyline {
    fn new(surface: &dyn Surface, curve: &FeatureCurve) -> Self {
        let mut start = 0.0;
        let piece = |ends: &[MaterialPoint; 2]| {
            assert_eq!(ends[0].face, ends[1].face, "a piece lies in one face");
            let positions = ends.map(|end| surface.position(end));
            let length = (positions[1] - positions[0]).norm();
            let before = start;
            start += length;
            Piece {
                ends: *ends,
                positions,
                start: before,
                length,
            }
        };
        Self {
            pieces: curve.pieces.iter().map(piece).collect(),
            is_closed: curve.is_closed,
        }
    }

    fn length(&self) -> f64 {
        self.pieces
            .last()
            .map_or(0.0, |piece| piece.start + piece.length)
    }

    /// Passages of the curve by two places within reach (m), of all such pairs the one least apart along it: a curve
    /// that crosses itself passes the crossing twice, and only one of the two leads to the other place.
    fn nearest_passages(&self, places: [Vector3<f64>; 2], reach: f64) -> Option<[Closest; 2]> {
        let [first, second] = places.map(|place| self.passages(place, reach));
        let pairs = first
            .iter()
            .flat_map(|a| second.iter().map(move |b| [*a, *b]));
        pairs.min_by(|p, q| {
            let [p, q] = [p, q].map(|[a, b]| self.apart([a.at, b.at]));
            p.total_cmp(&q)
        })
    }

    /// Closest place of every stretch of the curve that comes within reach (m) of a place.
    fn passages(&self, place: Vector3<f64>, reach: f64) -> Vec<Closest> {
        let all = [0.0, self.length()];
        let mut passages: Vec<Closest> = Vec::new();
        let mut last_near = None;
        let pieces = self.pieces.iter().enumerate();
        for found in pieces.filter_map(|(i, piece)| piece.closest(i, place, all)) {
            if found.distance > reach {
                continue;
            }
            let goes_on = last_near.is_some_and(|last: usize| last + 1 == found.piece);
            last_near = Some(found.piece);
            match passages.last_mut().filter(|_| goes_on) {
                Some(passage) if found.distance < passage.distance => *passage = found,
                Some(_) => {}
                None => passages.push(found),
            }
        }
        passages
    }

    /// Length of the curve between two places on it (m), of a closed one the shorter way.
    fn apart(&self, [from, to]: [f64; 2]) -> f64 {
        let apart = (to - from).abs();
        match self.is_closed {
            true => apart.min(self.length() - apart),
            false => apart,
        }
    }

    /// The place closest to a target of what lies between two places on the curve; on a closed curve that is the
    /// shorter way.
    fn closest(&self, target: Vector3<f64>, [a, b]: [f64; 2]) -> Option<Closest> {
        let ranges = self.ranges(a.min(b), a.max(b));
        let pieces = self.pieces.iter().enumerate();
        let places = pieces.flat_map(|(i, piece)| {
            ranges
                .iter()
                .filter_map(move |range| piece.closest(i, target, *range))
        });
        places.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    fn ranges(&self, from: f64, to: f64) -> Vec<[f64; 2]> {
        let length = self.length();
        match self.is_closed && to - from > 0.5 * length {
            true => vec![[0.0, from], [to, length]],
            false => vec![[from, to]],
        }
    }

    fn place(&self, at: Closest) -> MaterialPoint {
        let [from, to] = self.pieces[at.piece].ends;
        let mix = |i: usize| {
            from.barycentric[i] + (to.barycentric[i] - from.barycentric[i]) * at.fraction
        };
        MaterialPoint {
            face: from.face,
            barycentric: std::array::from_fn(mix),
        }
    }
}

impl Piece {
    /// The closest place of the piece within a range of lengths of the curve (m).
    fn closest(&self, piece: usize, target: Vector3<f64>, [from, to]: [f64; 2]) -> Option<Closest> {
        if self.length == 0.0 || self.start > to || self.start + self.length < from {
            return None;
        }
        let [a, b] = self.positions;
        let share = |at: f64| ((at - self.start) / self.length).clamp(0.0, 1.0);
        let along = (target - a).dot(&(b - a)) / (self.length * self.length);
        let fraction = along.clamp(share(from), share(to));
        Some(Closest {
            piece,
            fraction,
            distance: (a + (b - a) * fraction - target).norm(),
            at: self.start + self.length * fraction,
        })
    }
}

impl Surface for FeatureCurves<'_> {
    fn contains(&self, at: MaterialPoint) -> bool {
        self.surface.contains(at)
    }

    fn position(&self, at: MaterialPoint) -> Vector3<f64> {
        self.surface.position(at)
    }

    fn normal(&self, at: MaterialPoint) -> Vector3<f64> {
        self.surface.normal(at)
    }

    fn closest(&self, near: MaterialPoint, target: Vector3<f64>) -> MaterialPoint {
        self.surface.closest(near, target)
    }

    fn closest_on_feature(
        &self,
        between: [MaterialPoint; 2],
        target: Vector3<f64>,
    ) -> MaterialPoint {
        let ends = between.map(|end| self.surface.position(end));
        let on_curve = self.on_curve(ends, target);
        on_curve.unwrap_or_else(|| self.surface.closest_on_feature(between, target))
    }
}
