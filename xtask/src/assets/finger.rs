//! A finger: a tube with round ends, slightly bent at rest, and the shape that flexes its joint.
//!
//! It points up y with its back to `+z`; the texture's seam runs along the back, where no wrinkles
//! form. A point on it is an arc length along the centre line and an angle around it.

use std::f64::consts::{PI, TAU};

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendError, BlendShape};

use super::finish;

/// Radius of the finger, m.
const RADIUS: f64 = 0.008;

/// Length between the round ends, m; 80 mm with them.
const TUBE: f64 = 0.064;

/// Vertices around: edges of 3.6 mm.
const AROUND: u32 = 14;

/// Strips along the tube: near-equilateral triangles.
const STRIPS: u32 = 20;

/// Vertices of the rings of a round end, from the tube to the pole, which makes one more.
const CAP_RINGS: [u32; 3] = [14, 10, 6];

/// Turn of the centre line from end to end at rest, rad.
const NATURAL_BEND: f64 = 0.26;

/// Turn of the joint, rad (50 degrees).
const FLEXION: f64 = 50.0 * PI / 180.0;

/// Length of the centre line over which the joint turns, m.
const JOINT: f64 = 0.020;

/// The joint's axis lies this far from the centre line towards the palm, m. There skin neither
/// shortens nor stretches; on the centre line itself the palm side would shorten too much.
const AXIS: f64 = 0.004;

/// Length over which skin slides to share the joint's shortening and stretching, m.
const SHARED: f64 = 0.056;

/// Arc length from the tube to a pole, m: radius of the discs in the texture.
const QUARTER: f64 = PI / 2.0 * RADIUS;

/// Width of the unrolled tube, m; every other row sticks out by half a cell.
const TUBE_CHART: f64 = (AROUND as f64 + 0.5) / AROUND as f64 * TAU * RADIUS;

/// Room left in the texture around all and between charts: share of the texture, m.
const MARGIN: f64 = 0.02;
const GAP: f64 = 0.003;

/// The finger, as its file holds it.
pub(super) fn mesh() -> Result<ArtistMesh, BlendError> {
    let mut charts = Charts::default();
    charts.tube();
    charts.cap(End::Base);
    charts.cap(End::Tip);
    let positions: Vec<_> = charts.points.iter().map(|p| position(*p, 0.0)).collect();
    let flexed = charts.points.iter().map(|p| position(*p, FLEXION));
    let flex = BlendShape {
        name: "flex".to_owned(),
        position_deltas: flexed.zip(&positions).map(|(f, p)| f - p).collect(),
        normal_deltas: None,
    };
    finish(ArtistMesh {
        name: "Finger".to_owned(),
        positions,
        normals: None,
        uvs: Some(charts.uvs),
        triangles: charts.triangles,
        shapes: vec![flex],
    })
}

/// A point of the finger's skin.
#[derive(Clone, Copy, Debug)]
struct SkinPoint {
    /// Arc length along the rest centre line, 0 to `TUBE`.
    along: f64,
    /// Angle around, from the back by `+x` to the palm.
    around: f64,
    /// Latitude on a round end: 0 on the tube, `PI / 2` at the tip's pole, negative at the base.
    latitude: f64,
}

#[derive(Clone, Copy, Debug)]
enum End {
    Base,
    Tip,
}

/// Vertices with their texture coordinates, chart by chart: the tube, then the two ends, each its
/// own island so that no triangle of the texture is squeezed. Vertices on two charts' border are
/// made from the same [`SkinPoint`], so they have the same position to the last bit.
#[derive(Default)]
struct Charts {
    points: Vec<SkinPoint>,
    uvs: Vec<Vector2<f64>>,
    triangles: Vec<[u32; 3]>,
}

impl Charts {
    /// `at`: metres on the unrolled skin from the lower left of the texture, V up.
    fn vertex(&mut self, point: SkinPoint, at: Vector2<f64>) -> u32 {
        let scale = (1.0 - 2.0 * MARGIN) / (TUBE_CHART + GAP + 2.0 * QUARTER);
        self.points.push(point);
        self.uvs.push(Vector2::new(
            MARGIN + scale * at.x,
            1.0 - MARGIN - scale * at.y,
        ));
        self.points.len() as u32 - 1
    }

    /// Rows of vertices, each shifted by half a cell against the one below; the first vertex of a
    /// row comes again as its last, on the other side of the seam.
    fn tube(&mut self) {
        let rows: Vec<Vec<u32>> = (0..=STRIPS).map(|row| self.tube_row(row)).collect();
        for (strip, pair) in rows.windows(2).enumerate() {
            let (low, high) = (&pair[0], &pair[1]);
            for i in 0..AROUND as usize {
                let (a, b, c, d) = (low[i], low[i + 1], high[i], high[i + 1]);
                let pair = if strip.is_multiple_of(2) {
                    [[a, b, c], [c, b, d]]
                } else {
                    [[a, d, c], [a, b, d]]
                };
                self.triangles.extend(pair);
            }
        }
    }

    fn tube_row(&mut self, row: u32) -> Vec<u32> {
        let along = TUBE * f64::from(row) / f64::from(STRIPS);
        let shift = f64::from(row % 2) / 2.0;
        let angle = |i: u32| TAU * (f64::from(i) + shift) / f64::from(AROUND);
        (0..=AROUND)
            .map(|i| {
                let point = SkinPoint {
                    along,
                    around: angle(i % AROUND),
                    latitude: 0.0,
                };
                self.vertex(point, Vector2::new(RADIUS * angle(i), along))
            })
            .collect()
    }

    /// A disc with true lengths from the pole outward.
    fn cap(&mut self, end: End) {
        let mut ring = self.ring(end, 0, AROUND);
        for (index, &count) in (0..).zip(&CAP_RINGS) {
            let inner = self.ring(end, index + 1, count);
            self.stitch(end, index, &ring, &inner);
            ring = inner;
        }
        let pole = self.ring(end, CAP_RINGS.len() as u32 + 1, 1);
        for i in 0..ring.len() {
            self.add(end, [ring[i], ring[(i + 1) % ring.len()], pole[0]]);
        }
    }

    /// One ring of a disc, from the tube (0) to the pole.
    fn ring(&mut self, end: End, index: u32, count: u32) -> Vec<u32> {
        let share = f64::from(index) / (CAP_RINGS.len() as f64 + 1.0);
        let radius = (1.0 - share) * QUARTER;
        let (along, sign, low) = match end {
            End::Base => (0.0, -1.0, 0.0),
            End::Tip => (TUBE, 1.0, 2.0 * QUARTER + GAP),
        };
        let centre = Vector2::new(TUBE_CHART + GAP + QUARTER, low + QUARTER);
        (0..count)
            .map(|i| {
                let around = TAU * ring_share(index, i, count);
                // Seen from outside, the angle runs one way around the tip's pole and the other
                // way around the base's.
                let direction = match end {
                    End::Base => Vector2::new(around.sin(), around.cos()),
                    End::Tip => Vector2::new(around.cos(), around.sin()),
                };
                let point = SkinPoint {
                    along,
                    around,
                    latitude: sign * share * PI / 2.0,
                };
                self.vertex(point, centre + radius * direction)
            })
            .collect()
    }

    /// Joins ring `index` to the next one inwards, going around both by the shorter diagonal.
    fn stitch(&mut self, end: End, index: u32, outer: &[u32], inner: &[u32]) {
        let (n, m) = (outer.len(), inner.len());
        let diagonal = |i: usize, j: usize| {
            let outer = ring_share(index, i as u32, n as u32);
            (outer - ring_share(index + 1, j as u32, m as u32)).abs()
        };
        let (mut i, mut j) = (0, 0);
        while i < n || j < m {
            if j == m || (i < n && diagonal(i + 1, j) <= diagonal(i, j + 1)) {
                self.add(end, [outer[i % n], outer[(i + 1) % n], inner[j % m]]);
                i += 1;
            } else {
                self.add(end, [outer[i % n], inner[(j + 1) % m], inner[j % m]]);
                j += 1;
            }
        }
    }

    /// Triangles are given counter-clockwise for the tip; the base faces the other way.
    fn add(&mut self, end: End, [a, b, c]: [u32; 3]) {
        self.triangles.push(match end {
            End::Tip => [a, b, c],
            End::Base => [a, c, b],
        });
    }
}

/// Share of a full turn of vertex `i` of a ring of `count`; every other ring starts half a cell
/// later, as the rows of the tube do.
fn ring_share(index: u32, i: u32, count: u32) -> f64 {
    (f64::from(i) + f64::from(index % 2) / 2.0) / f64::from(count)
}

/// Position (m) of a point of the skin when the joint has turned by `flexion`.
fn position(point: SkinPoint, flexion: f64) -> Vector3<f64> {
    let along = slide(point, flexion);
    let angle = bend(along, flexion);
    let direction = Vector3::new(0.0, angle.cos(), -angle.sin());
    let back = Vector3::new(0.0, angle.sin(), angle.cos());
    let outward = Vector3::x() * point.around.sin() + back * point.around.cos();
    let shape = outward * point.latitude.cos() + direction * point.latitude.sin();
    centre_line(along, flexion) + RADIUS * shape
}

/// Angle of the centre line towards the palm, against y.
fn bend(along: f64, flexion: f64) -> f64 {
    NATURAL_BEND * (along / TUBE - 0.5) + flexion * joint_share(along)
}

/// Share of the joint's turn up to here: a smooth step, its slope zero at both ends.
fn joint_share(along: f64) -> f64 {
    let t = ((along - TUBE / 2.0) / JOINT + 0.5).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Share of the skin's lengthening up to here: the integral of a raised cosine.
fn shared(along: f64) -> f64 {
    let t = ((along - TUBE / 2.0) / SHARED + 0.5).clamp(0.0, 1.0);
    t - (TAU * t).sin() / TAU
}

/// Arc length (m) along the flexed finger at which a point of the skin comes to lie.
///
/// Skin at distance `d` from the joint's axis lengthens by `d * flexion` in all, on the palm side
/// negatively. It would all happen within `JOINT`; skin slides so that it happens over `SHARED`:
/// the flexed length up to there equals the rest length up to the point plus its share.
fn slide(point: SkinPoint, flexion: f64) -> f64 {
    let lengthening = (AXIS + RADIUS * point.around.cos()) * flexion;
    let wanted = point.along + lengthening * shared(point.along);
    let length = |along: f64| along + lengthening * joint_share(along);
    let (mut low, mut high) = (0.0, TUBE);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if length(middle) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Halves 64 mm down to the spacing of floating-point numbers.
const BISECTIONS: u32 = 50;

/// The centre line from the base, which stays where it is; lengthened by the joint's axis lying
/// beside it. Simpson's rule.
fn centre_line(along: f64, flexion: f64) -> Vector3<f64> {
    const INTERVALS: u32 = 128;
    let step = along / f64::from(INTERVALS);
    let rate = |s: f64| {
        let angle = bend(s, flexion);
        let t = ((s - TUBE / 2.0) / JOINT + 0.5).clamp(0.0, 1.0);
        let curvature = flexion * 6.0 * t * (1.0 - t) / JOINT;
        Vector3::new(0.0, angle.cos(), -angle.sin()) * (1.0 + AXIS * curvature)
    };
    let sum: Vector3<f64> = (0..=INTERVALS)
        .map(|i| {
            let weight = match i {
                0 | INTERVALS => 1.0,
                _ if i.is_multiple_of(2) => 2.0,
                _ => 4.0,
            };
            rate(step * f64::from(i)) * weight
        })
        .sum();
    sum * (step / 3.0)
}
