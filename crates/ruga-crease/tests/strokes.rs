//! Lines from painted strokes of any width and direction, alone and where they cross.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use nalgebra::Vector2;
use ruga_crease::{GreyImage, SkeletonLine, SkeletonSettings, skeleton_lines};

const SIZE: usize = 160;

/// A stroke with square ends (texels).
#[derive(Clone, Copy)]
struct Stroke {
    from: Vector2<f64>,
    to: Vector2<f64>,
    width: f64,
}

impl Stroke {
    /// A stroke of a direction (degrees) and length through a place.
    fn through(middle: Vector2<f64>, degrees: f64, length: f64, width: f64) -> Self {
        let half = direction(degrees) * (length / 2.0);
        Self {
            from: middle - half,
            to: middle + half,
            width,
        }
    }

    fn covers(&self, p: Vector2<f64>) -> bool {
        let along = self.to - self.from;
        let length = along.norm();
        let (along, from) = (along / length, p - self.from);
        (0.0..=length).contains(&from.dot(&along)) && from.perp(&along).abs() <= self.width / 2.0
    }
}

fn direction(degrees: f64) -> Vector2<f64> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Vector2::new(cos, sin)
}

/// An image of strokes, without grey.
fn image(strokes: &[Stroke]) -> Vec<f32> {
    let mut values = vec![0.0; SIZE * SIZE];
    for (i, value) in values.iter_mut().enumerate() {
        let centre = Vector2::new((i % SIZE) as f64 + 0.5, (i / SIZE) as f64 + 0.5);
        if strokes.iter().any(|stroke| stroke.covers(centre)) {
            *value = 1.0;
        }
    }
    values
}

fn lines(strokes: &[Stroke]) -> Vec<SkeletonLine> {
    lines_of(&image(strokes))
}

fn lines_of(values: &[f32]) -> Vec<SkeletonLine> {
    let image = GreyImage {
        width: SIZE,
        height: SIZE,
        values,
    };
    skeleton_lines(&image, &SkeletonSettings::default()).unwrap()
}

/// Length of a line (texels).
fn length(line: &SkeletonLine) -> f64 {
    let legs = line
        .points
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).norm());
    legs.sum::<f64>() * SIZE as f64
}

/// Both ends of a line (texels).
fn ends(line: &SkeletonLine) -> [Vector2<f64>; 2] {
    [line.points[0], line.points[line.points.len() - 1]].map(|p| p * SIZE as f64)
}

/// The place where all lines begin or end.
fn meeting(lines: &[SkeletonLine]) -> Option<Vector2<f64>> {
    let is_common = |p: &Vector2<f64>| lines.iter().all(|line| ends(line).contains(p));
    ends(&lines[0]).into_iter().find(is_common)
}

/// The middle of what is drawn, off the texels' grid.
fn middle() -> Vector2<f64> {
    Vector2::new(80.3, 79.6)
}

#[test]
fn strokes_at_any_angle_keep_their_length() {
    for width in [2.0, 3.0, 5.0, 8.0, 14.0] {
        for degrees in (0..180).step_by(3) {
            let lines = lines(&[Stroke::through(middle(), degrees.into(), 110.0, width)]);
            let lengths: Vec<_> = lines.iter().map(length).collect();
            assert_eq!(
                lines.len(),
                1,
                "{width} texels, {degrees} degrees: {lengths:?}"
            );
            // A middle line ends half a width before a square end, or in one of its corners.
            let is_near = (110.0 - width - 1.0..110.0 + width / 2.0).contains(&lengths[0]);
            assert!(is_near, "{width} texels, {degrees} degrees: {lengths:?}");
        }
    }
}

#[test]
fn crossing_strokes_meet_in_one_place() {
    for width in [2.0, 5.0, 8.0, 12.0] {
        for between in (20..=90).step_by(5) {
            for first in [0.0, 17.0, 35.0, 45.0, 53.0, 80.0, 90.0, 128.0] {
                let directions = [first, first + f64::from(between)];
                let stroke = |degrees| Stroke::through(middle(), degrees, 130.0, width);
                let lines = lines(&directions.map(stroke));
                let lengths: Vec<_> = lines.iter().map(length).collect();
                let case = format!("{width} texels, {directions:?} degrees: {lengths:?}");
                assert_eq!(lines.len(), 4, "{case}");
                let place = meeting(&lines).unwrap_or_else(|| panic!("{case}"));
                assert!((place - middle()).norm() < 2.0, "{case} {place}");
                let is_near = |length: &f64| (64.0 - width..66.0 + width / 2.0).contains(length);
                assert!(lengths.iter().all(is_near), "{case}");
            }
        }
    }
}

#[test]
fn a_star_has_as_many_lines_as_rays() {
    for count in [6, 8, 12, 16, 20] {
        for width in [1.5, 2.0, 3.0, 4.0] {
            for turn in [0.0, 5.7, 11.0] {
                let ray = |k: i32| Stroke {
                    from: middle(),
                    to: middle() + direction(turn + f64::from(360 * k) / f64::from(count)) * 70.0,
                    width,
                };
                let lines = lines(&(0..count).map(ray).collect::<Vec<_>>());
                let lengths: Vec<_> = lines.iter().map(length).collect();
                let case = format!("{count} rays of {width} texels from {turn}: {lengths:?}");
                assert_eq!(lines.len(), count as usize, "{case}");
                assert!(meeting(&lines).is_some(), "{case}");
                assert!(lengths.iter().all(|l| (l - 70.0).abs() < 5.0), "{case}");
            }
        }
    }
}

/// What joins two strokes at a distance is a stroke of its own.
#[test]
fn bars_that_are_drawn_stay() {
    for width in [2.0, 5.0, 8.0] {
        for turn in [0.0, 30.0, 45.0, 77.0] {
            let aside = direction(turn) * (2.0 * width + 4.0);
            let [left, right] = [middle() - aside, middle() + aside]
                .map(|middle| Stroke::through(middle, turn + 90.0, 100.0, width));
            let bar = Stroke::through(middle(), turn, 2.0 * aside.norm(), width);
            let lines = lines(&[left, right, bar]);
            let lengths: Vec<_> = lines.iter().map(length).collect();
            assert_eq!(
                lines.len(),
                5,
                "{width} texels, {turn} degrees: {lengths:?}"
            );
        }
    }
}

/// Single texels that are dark in a stroke of a worn brush are no loops.
#[test]
fn pinholes_are_filled() {
    let stroke = Stroke::through(middle(), 0.0, 110.0, 8.0);
    let mut values = image(&[stroke]);
    for x in [50, 70, 71, 100] {
        values[79 * SIZE + x] = 0.0;
    }
    let lines = lines_of(&values);
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!((length(&lines[0]) - 104.0).abs() < 5.0, "{lines:?}");
}
