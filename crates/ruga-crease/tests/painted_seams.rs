//! Painted strokes over seams and up to borders of texture layouts.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod sheets;

use nalgebra::{Vector2, Vector3};
use ruga_crease::{
    Corners, GreyImage, LineInput, LineTracer, SkeletonSettings, Stroke, TracedLine, TracedStrokes,
    check_lines, skeleton_lines,
};
use ruga_mesh::PlanarLookup;
use sheets::{Sheet, square, tube};

const SIZE: usize = 512;

/// A texel on the sheet: the layout shows it at 4/5 of its size.
const TEXEL: f64 = 1.0 / (0.8 * SIZE as f64);

/// The unit square with its halves as two islands, a gap of a tenth of the texture between them.
fn halves(jitter: f64) -> Sheet {
    let mut sheet = square(8, jitter, 5);
    let uvs = sheet.uvs.as_slice().iter().map(|corners| {
        let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        corners.map(|p| in_layout(p, centre.x > 0.5))
    });
    sheet.uvs = uvs.collect();
    sheet
}

fn in_layout(p: Vector2<f64>, is_right: bool) -> Vector2<f64> {
    p * 0.8 + Vector2::new(if is_right { 0.15 } else { 0.05 }, 0.1)
}

/// Strokes as a program paints them on the surface, and `bleed` texels beyond the borders of islands: an image of
/// what `is_painted` says of a place of the sheet and of the half that it is in.
fn painted(
    sheet: &Sheet,
    bleed: f64,
    is_painted: impl Fn(Vector2<f64>, bool) -> bool,
) -> Vec<Stroke> {
    let lookup = PlanarLookup::new(sheet.uvs.clone());
    let is_island = |uv: Vector2<f64>| lookup.locate(uv).is_some();
    let offsets =
        (-1..=1).flat_map(|x| (-1..=1).map(move |y| Vector2::new(f64::from(x), f64::from(y))));
    let offsets: Vec<_> = offsets
        .map(|offset| offset * (bleed / SIZE as f64))
        .collect();
    let value = |i: usize| {
        let texel = Vector2::new((i % SIZE) as f64 + 0.5, (i / SIZE) as f64 + 0.5);
        let uv = texel / SIZE as f64;
        let is_right = uv.x > 0.5;
        let place = (uv - in_layout(Vector2::zeros(), is_right)) / 0.8;
        let is_there = offsets.iter().any(|offset| is_island(uv + offset));
        if is_there && is_painted(place, is_right) {
            1.0
        } else {
            0.0
        }
    };
    let values: Vec<f32> = (0..SIZE * SIZE).map(value).collect();
    strokes(&values)
}

fn strokes(values: &[f32]) -> Vec<Stroke> {
    let image = GreyImage {
        width: SIZE,
        height: SIZE,
        values,
    };
    let lines = skeleton_lines(&image, &SkeletonSettings::default()).unwrap();
    let stroke = lines.into_iter().map(|line| Stroke {
        points: line.points,
        half_width: line.half_width,
        texel: Vector2::repeat(1.0 / SIZE as f64),
        is_closed: line.is_closed,
    });
    stroke.collect()
}

fn traced(sheet: &Sheet, strokes: &[Stroke]) -> TracedStrokes {
    let tracer = LineTracer::new(&sheet.mesh, &sheet.positions).with_uvs(&sheet.uvs);
    let traced = tracer.trace_strokes(strokes, Corners::Round).unwrap();
    assert_eq!(traced.refused, []);
    traced
}

/// The lines of strokes that are all on the islands.
fn lines(sheet: &Sheet, strokes: &[Stroke]) -> Vec<TracedLine> {
    let traced = traced(sheet, strokes);
    assert_eq!((traced.outside, traced.shortened), (vec![], vec![]));
    // Segments follow each other, over seams too.
    for line in &traced.lines {
        for pair in line.segments().windows(2) {
            let [to, from] = [pair[0].place(1.0), pair[1].place(0.0)].map(|at| on(sheet, at));
            assert!((to - from).norm() < 1e-9, "{pair:?}");
        }
    }
    traced.lines
}

fn on(sheet: &Sheet, place: ruga_mesh::MaterialPoint) -> Vector3<f64> {
    place.interpolate(&sheet.mesh, &sheet.positions)
}

fn ends(sheet: &Sheet, line: &TracedLine) -> [Vector2<f64>; 2] {
    [0.0, line.length()].map(|at| on(sheet, line.place(at).unwrap()).xy())
}

/// Largest distance of a line from the straight one between two places (texels), but for what is near its ends.
fn off(sheet: &Sheet, line: &TracedLine, [a, b]: [Vector2<f64>; 2]) -> f64 {
    let along = (b - a).normalize();
    let samples = (5..=95).map(|i| line.length() * f64::from(i) / 100.0);
    let places = samples.map(|at| on(sheet, line.place(at).unwrap()).xy());
    places
        .map(|p| along.perp(&(p - a)).abs())
        .fold(0.0, f64::max)
        / TEXEL
}

fn is_near(p: Vector2<f64>, [a, b]: [Vector2<f64>; 2], half_width: f64) -> bool {
    let share = ((p - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
    (p - a - (b - a) * share).norm() < half_width * TEXEL
}

/// Ends of a stroke through the middle of the seam, at an angle to it (degrees).
fn through(y: f64, degrees: f64) -> [Vector2<f64>; 2] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let half = Vector2::new(sin, cos) * 0.35;
    let middle = Vector2::new(0.5, y);
    [middle - half, middle + half]
}

#[test]
fn strokes_on_both_sides_of_a_seam_are_one_line() {
    for jitter in [0.0, 0.2] {
        let sheet = halves(jitter);
        for degrees in [90.0, 60.0, 35.0, 130.0] {
            let stroke = through(0.503, degrees);
            for half_width in [1.2, 2.5, 5.0, 9.0] {
                for bleed in [0.0, 2.0, 8.0, 16.0] {
                    let is_painted = |p, _| is_near(p, stroke, half_width);
                    let strokes = painted(&sheet, bleed, is_painted);
                    let found = lines(&sheet, &strokes);
                    let case = format!(
                        "{jitter} {degrees} degrees, {half_width} texels, {bleed}: {:?}",
                        found.iter().map(TracedLine::length).collect::<Vec<_>>()
                    );
                    assert_eq!(found.len(), 1, "{case}");
                    // As the same line given by texture coordinates, but for its ends.
                    let length = found[0].length();
                    let slack = (2.0 * half_width + 4.0) * TEXEL;
                    assert!((length - 0.7).abs() < slack, "{case}");
                    let off = off(&sheet, &found[0], stroke);
                    assert!(off < 1.0 + 0.3 * half_width, "{case}: {off} texels off");
                    let on = (&sheet.mesh, sheet.positions.as_slice());
                    assert_eq!(check_lines(&found, on, 0.01).unwrap(), [], "{case}");
                }
            }
        }
    }
}

#[test]
fn a_joined_line_is_the_one_by_texture_coordinates() {
    let sheet = halves(0.0);
    let [from, to] = through(0.45, 75.0);
    let seam = (from + to) / 2.0;
    let points = [(from, false), (seam, false), (seam, true), (to, true)];
    let given = LineInput::Uv {
        points: points.map(|(p, is_right)| in_layout(p, is_right)).to_vec(),
        is_closed: false,
        corners: Corners::Round,
    };
    let tracer = LineTracer::new(&sheet.mesh, &sheet.positions).with_uvs(&sheet.uvs);
    let given = tracer.trace(&given).unwrap();
    let strokes = painted(&sheet, 3.0, |p, _| is_near(p, [from, to], 4.0));
    let found = &lines(&sheet, &strokes)[0];
    let samples = |line: &TracedLine| -> Vec<Vector3<f64>> {
        let at = (0..=1000).map(|i| line.length() * f64::from(i) / 1000.0);
        at.map(|at| on(&sheet, line.place(at).unwrap())).collect()
    };
    let given = samples(&given);
    for p in samples(found).iter().filter(|p| (0.2..0.8).contains(&p.x)) {
        let distances = given.iter().map(|q| (p - q).norm());
        let distance = distances.fold(f64::INFINITY, f64::min);
        assert!(distance < 1.2 * TEXEL, "{p}: {} texels", distance / TEXEL);
    }
}

#[test]
fn a_stroke_on_one_side_ends_on_the_seam_and_on_the_border() {
    for jitter in [0.0, 0.2] {
        let sheet = halves(jitter);
        for (bleed, half_width) in [(0.0, 1.2), (0.0, 6.0), (2.0, 6.0), (16.0, 6.0)] {
            let across = [Vector2::new(-0.2, 0.3), Vector2::new(1.2, 0.36)];
            let strokes = painted(&sheet, bleed, |p, is_right| {
                !is_right && is_near(p, across, half_width)
            });
            let found = lines(&sheet, &strokes);
            assert_eq!(found.len(), 1, "{bleed} {half_width}");
            let mut ends = ends(&sheet, &found[0]);
            ends.sort_by(|a, b| a.x.total_cmp(&b.x));
            assert!(ends[0].x.abs() < 1e-9, "{ends:?}");
            let at_seam = if jitter == 0.0 { 1e-9 } else { 0.03 };
            assert!((ends[1].x - 0.5).abs() < at_seam, "{ends:?}");
            assert!(off(&sheet, &found[0], across) < 2.0);
            // Another stroke beyond the seam, but not there.
            let strokes = painted(&sheet, bleed, |p, is_right| {
                let aside = Vector2::new(0.0, (2.0 * half_width + 6.0) * TEXEL);
                is_near(if is_right { p - aside } else { p }, across, half_width)
            });
            assert_eq!(lines(&sheet, &strokes).len(), 2, "{bleed} {half_width}");
        }
    }
}

#[test]
fn strokes_side_by_side_are_not_mixed_up() {
    for jitter in [0.0, 0.2] {
        let sheet = halves(jitter);
        for half_width in [1.5, 4.0, 8.0] {
            for bleed in [0.0, 2.0, 8.0] {
                // As near as two strokes of an image may be, and the right halves a texel aside.
                let apart = (half_width + 1.6) * TEXEL;
                let pair = [-apart, apart].map(|aside| {
                    [
                        Vector2::new(0.1, 0.5 + aside),
                        Vector2::new(0.9, 0.5 + aside),
                    ]
                });
                let strokes = painted(&sheet, bleed, |p, is_right| {
                    let aside = Vector2::new(0.0, if is_right { TEXEL } else { 0.0 });
                    pair.iter()
                        .any(|stroke| is_near(p + aside, *stroke, half_width))
                });
                let found = lines(&sheet, &strokes);
                assert_eq!(found.len(), 2, "{half_width} {bleed}");
                for (line, stroke) in found.iter().zip(pair) {
                    assert!(off(&sheet, line, stroke) < 2.5, "{half_width} {bleed}");
                }
            }
        }
    }
}

#[test]
fn rings_over_seams_are_closed() {
    let sheet = halves(0.2);
    let ring = painted(&sheet, 2.0, |p, _| {
        ((p - Vector2::new(0.52, 0.5)).norm() - 0.25).abs() < 4.0 * TEXEL
    });
    let found = lines(&sheet, &ring);
    assert_eq!(found.len(), 1);
    assert!(found[0].is_closed());
    assert!((found[0].length() / (0.5 * std::f64::consts::PI) - 1.0).abs() < 0.03);

    // Inside of one island.
    let ring = painted(&sheet, 0.0, |p, _| {
        ((p - Vector2::new(0.25, 0.5)).norm() - 0.15).abs() < 4.0 * TEXEL
    });
    let found = lines(&sheet, &ring);
    assert_eq!(found.len(), 1);
    assert!(found[0].is_closed());
    let on = (&sheet.mesh, sheet.positions.as_slice());
    assert_eq!(check_lines(&found, on, 0.01).unwrap(), []);

    // One island whose own borders meet.
    let sheet = tube(12);
    let values: Vec<f32> = (0..SIZE * SIZE)
        .map(|i| {
            if (250..258).contains(&(i / SIZE)) {
                1.0
            } else {
                0.0
            }
        })
        .collect();
    let found = lines(&sheet, &strokes(&values));
    assert_eq!(found.len(), 1);
    assert!(found[0].is_closed());
    assert!(
        (found[0].length() - 1.0).abs() < 1e-3,
        "{}",
        found[0].length()
    );
}

#[test]
fn strokes_outside_of_all_islands_are_told_of() {
    let sheet = halves(0.0);
    let bar = |x: std::ops::Range<usize>, y: std::ops::Range<usize>, i: usize| {
        x.contains(&(i % SIZE)) && y.contains(&(i / SIZE))
    };
    let image = |is_painted: &dyn Fn(usize) -> bool| -> Vec<f32> {
        (0..SIZE * SIZE)
            .map(|i| if is_painted(i) { 1.0 } else { 0.0 })
            .collect()
    };
    // In the gap, on an island, and from there far beyond its border.
    let values = image(&|i| {
        bar(254..258, 20..40, i)
            || bar(60..180, 200..204, i)
            || bar(120..124, 300..510, i)
            || bar(254..258, 300..400, i)
    });
    let all = strokes(&values);
    let found = traced(&sheet, &all);
    assert_eq!(found.lines.len(), 2);
    let starts = |numbers: &[usize]| {
        numbers
            .iter()
            .map(|i| all[*i].points[0].y)
            .collect::<Vec<_>>()
    };
    assert_eq!(found.outside.len(), 2, "{:?}", starts(&found.outside));
    assert_eq!(found.shortened, [] as [usize; 0]);
    // More of it outside than on the island.
    let values = image(&|i| bar(120..124, 400..510, i));
    assert_eq!(traced(&sheet, &strokes(&values)).shortened, [0]);
    // Across the gap.
    let values = image(&|i| bar(60..450, 200..206, i));
    let found = lines(&sheet, &strokes(&values));
    assert_eq!(found.len(), 1);
}

/// An image of a stroke from a point to another (texels), `wave` texels to and fro of the straight line.
fn image_of([a, b]: [Vector2<f64>; 2], half_width: f64, wave: f64) -> Vec<f32> {
    let along = (b - a).normalize();
    let value = |i: usize| {
        let p = Vector2::new((i % SIZE) as f64 + 0.5, (i / SIZE) as f64 + 0.5) - a;
        let way = along.dot(&p);
        let aside = along.perp(&p) - wave * (way / 12.0).sin();
        if (0.0..=(b - a).norm()).contains(&way) && aside.abs() < half_width {
            1.0
        } else {
            0.0
        }
    };
    (0..SIZE * SIZE).map(value).collect()
}

/// Paint that runs over the gap aslant comes out on skin that is not beside it.
#[test]
fn a_stroke_that_strays_onto_another_island_ends_on_its_own() {
    let sheet = halves(0.0);
    let uv = |x: f64, y: f64| Vector2::new(x, y) * SIZE as f64;
    let values = image_of([uv(0.25, 0.3), uv(0.58, 0.5)], 3.0, 0.0);
    let all = strokes(&values);
    let found = traced(&sheet, &all);
    assert_eq!(found.astray, [0]);
    let [line] = &found.lines[..] else {
        panic!("{} lines", found.lines.len())
    };
    let [mut from, mut to] = ends(&sheet, line);
    if from.x > to.x {
        std::mem::swap(&mut from, &mut to);
    }
    assert!(from.x < 0.3 && (to.x - 0.5).abs() < 1e-9, "{from} {to}");
    // What reaches as far on either island is meant.
    let values = image_of([uv(0.1, 0.3), uv(0.9, 0.6)], 3.0, 0.0);
    let found = traced(&sheet, &strokes(&values));
    assert_eq!((found.astray.len(), found.lines.len()), (1, 2));
}

/// A stroke along a border that is now on one side of it, now on the other, is one line.
#[test]
fn a_stroke_along_a_border_is_one_line() {
    for jitter in [0.0, 0.3] {
        let sheet = halves(jitter);
        for (off, wave) in [(0.0, 1.5), (-1.0, 3.0), (1.0, 0.0)] {
            let at = |x: f64| Vector2::new(x * SIZE as f64, 0.1 * SIZE as f64 + off);
            let values = image_of([at(0.12), at(0.4)], 4.0, wave);
            let found = traced(&sheet, &strokes(&values));
            let lengths: Vec<_> = found
                .lines
                .iter()
                .map(|line| line.length() / TEXEL)
                .collect();
            assert_eq!(lengths.len(), 1, "{jitter} {off} {wave}: {lengths:?}");
            // What of it ends outside is left out, half a wave at most.
            assert!((100.0..165.0).contains(&lengths[0]), "{lengths:?}");
        }
    }
}
