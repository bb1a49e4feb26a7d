//! Lines from strokes in an image, and laws along a line.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use nalgebra::Vector2;
use ruga_crease::{Drive, GreyImage, LineLaw, SkeletonLine, SkeletonSettings, skeleton_lines};

const SIZE: usize = 96;

/// An image, bright where `is_line` says so of a texel's centre.
fn drawn(value: impl Fn(Vector2<f64>) -> f32) -> Vec<SkeletonLine> {
    let texel = |i: usize| Vector2::new((i % SIZE) as f64 + 0.5, (i / SIZE) as f64 + 0.5);
    let values: Vec<_> = (0..SIZE * SIZE)
        .map(|i| value(texel(i) / SIZE as f64))
        .collect();
    let image = GreyImage {
        width: SIZE,
        height: SIZE,
        values: &values,
    };
    skeleton_lines(&image, &SkeletonSettings::default()).unwrap()
}

fn near(p: Vector2<f64>, [a, b]: [[f64; 2]; 2], width: f64) -> bool {
    let (a, b) = (Vector2::from(a), Vector2::from(b));
    let share = ((p - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
    (p - a - (b - a) * share).norm() < width
}

fn length(line: &SkeletonLine) -> f64 {
    line.points
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).norm())
        .sum()
}

#[test]
fn a_thick_stroke_becomes_its_middle_line() {
    let stroke = [[0.2, 0.3], [0.8, 0.6]];
    let lines = drawn(|p| if near(p, stroke, 0.03) { 0.8 } else { 0.1 });
    assert_eq!(lines.len(), 1, "{lines:?}");
    let line = &lines[0];
    assert!(!line.is_closed);
    for p in &line.points {
        assert!(near(*p, stroke, 1.0 / SIZE as f64), "{p:?}");
    }
    // Thinning takes the rounded ends.
    assert!((length(line) - 0.67).abs() < 0.07, "{}", length(line));
    // Half of 0.06 of the image, but for the rounded ends.
    for half_width in &line.half_width[3..line.half_width.len() - 3] {
        assert!(
            (half_width - 0.03 * SIZE as f64).abs() < 0.8,
            "{half_width}"
        );
    }
}

#[test]
fn a_ring_is_closed_and_a_crossing_has_four_arms() {
    let ring = drawn(|p| {
        let r = (p - Vector2::new(0.5, 0.5)).norm();
        if (r - 0.3).abs() < 0.03 { 1.0 } else { 0.0 }
    });
    assert_eq!(ring.len(), 1, "{ring:?}");
    assert!(ring[0].is_closed);
    let radius = |p: &Vector2<f64>| (p - Vector2::new(0.5, 0.5)).norm();
    assert!(
        ring[0]
            .points
            .iter()
            .all(|p| (radius(p) - 0.3).abs() < 0.02)
    );

    let arms = [[[0.1, 0.5], [0.9, 0.52]], [[0.5, 0.1], [0.48, 0.9]]];
    let cross = drawn(|p| {
        if arms.iter().any(|arm| near(p, *arm, 0.02)) {
            1.0
        } else {
            0.0
        }
    });
    assert_eq!(cross.len(), 4, "{cross:?}");
    let total: f64 = cross.iter().map(length).sum();
    assert!((total - 1.6).abs() < 0.15, "{total}");
}

#[test]
fn small_rings_are_rings() {
    let middle = Vector2::repeat(48.0 / SIZE as f64);
    for radius in [1.0, 2.0, 3.0, 4.0] {
        let ring = drawn(|p| {
            // Measured from a texel's centre.
            let r = (p - middle).map(|c| c * SIZE as f64 - 0.5).norm();
            if (r - radius).abs() < 0.45 { 1.0 } else { 0.0 }
        });
        assert_eq!(ring.len(), 1, "{radius}: {ring:?}");
        assert!(ring[0].is_closed && ring[0].points.len() > 2, "{ring:?}");
    }
}

/// The tail of a lasso ends on the loop.
#[test]
fn a_loop_stays_where_another_line_ends_on_it() {
    let lines = drawn(|p| {
        let is_ring = ((p - Vector2::new(0.6, 0.5)).norm() - 0.2).abs() < 0.008;
        if is_ring || near(p, [[0.1, 0.5], [0.4, 0.5]], 0.006) {
            1.0
        } else {
            0.0
        }
    });
    let [closed, open] = [true, false].map(|is_closed| {
        let mut found = lines.iter().filter(|line| line.is_closed == is_closed);
        found.next().unwrap()
    });
    let node = closed.points[0];
    let ends = [open.points[0], open.points[open.points.len() - 1]];
    assert!(ends.contains(&node), "{node} {ends:?}");
}

#[test]
fn any_number_of_lines_may_be_accepted() {
    let mut values = vec![0.0; SIZE * SIZE];
    values[SIZE * 40 + 10..SIZE * 40 + 60].fill(1.0);
    let image = GreyImage {
        width: SIZE,
        height: SIZE,
        values: &values,
    };
    let settings = SkeletonSettings {
        most_lines: usize::MAX,
        ..SkeletonSettings::default()
    };
    assert_eq!(skeleton_lines(&image, &settings).unwrap().len(), 1);
}

#[test]
fn twigs_are_pruned() {
    let stroke = [[0.1, 0.5], [0.9, 0.5]];
    let lines = drawn(|p| {
        let is_twig = (p.x - 0.5).abs() < 0.006 && (p.y - 0.5).abs() < 0.03;
        if is_twig || near(p, stroke, 0.012) {
            1.0
        } else {
            0.0
        }
    });
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!((length(&lines[0]) - 0.8).abs() < 0.06);
}

#[test]
fn strength_fades_towards_the_ends() {
    let law = LineLaw {
        width: 1e-3,
        stiffness: 0.1,
        angle: 0.5,
        fade: [2.0, 1.0],
    };
    let taper = |at| law.taper(at, 10.0, false);
    assert_eq!(
        [0.0, 1.0, 2.0, 5.0, 9.0, 9.5, 10.0].map(taper),
        [0.0, 0.5, 1.0, 1.0, 1.0, 0.5, 0.0]
    );
    assert_eq!(law.taper(0.0, 10.0, true), 1.0);
    assert!((law.softness(1.0) - 9e-3).abs() < 1e-15);
    assert_eq!(law.softness(0.0), 0.0);
    assert_eq!(law.rest_angle(0.5), 0.25);
    // Without a fade a line is whole up to its ends.
    assert_eq!(
        LineLaw {
            fade: [0.0; 2],
            ..law
        }
        .taper(0.0, 10.0, false),
        1.0
    );
    assert_eq!(Drive::Load.strength(0.3, &[]), 0.3);
    assert_eq!(Drive::Always.strength(0.3, &[]), 1.0);
    assert_eq!(
        Drive::Weights(vec![(1, 2.0), (0, -1.0)]).strength(0.3, &[0.2, 0.4]),
        0.6000000000000001
    );
    assert_eq!(Drive::Weights(vec![(0, 9.0)]).strength(0.0, &[1.0]), 1.0);
}
