//! Lines that wrinkles leave.

mod sheets;

use std::f64::consts::TAU;

use nalgebra::Vector3;
use ruga_crease::{FoldedLine, NewLines, Relief, Valley, valleys};
use sheets::square;

const WAVELENGTH: f64 = 0.2;
const AMPLITUDE: f64 = 0.02;

/// Valleys of waves on a jittered square with edges of a twelfth of their length, their crests at an angle.
fn of_waves(angle: f64) -> (Vec<Valley>, Vec<Vector3<f64>>, f64) {
    let sheet = square(60, 0.3, 7);
    let wave_number = TAU / WAVELENGTH;
    let (sin, cos) = f64::sin_cos(angle);
    let phase = |p: &Vector3<f64>| wave_number * (cos * p.x + sin * p.y);
    let heights: Vec<f64> = sheet
        .positions
        .iter()
        .map(|p| AMPLITUDE * phase(p).cos())
        .collect();
    let curvature = AMPLITUDE * wave_number * wave_number;
    let least = vec![0.5 * curvature; heights.len()];
    let relief = Relief {
        mesh: &sheet.mesh,
        positions: &sheet.positions,
        heights: &heights,
    };
    (valleys(&relief, &least), sheet.positions, curvature)
}

#[test]
fn valleys_of_waves_are_found_where_they_are() {
    for angle in [0.0, 0.4, 1.3] {
        let (found, positions, curvature) = of_waves(angle);
        let (mut worst, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
        let (sin, cos) = f64::sin_cos(angle);
        for point in found.iter().flat_map(|valley| &valley.points) {
            let [a, b] = point.vertices.map(|v| positions[v.0 as usize]);
            let place = a + (b - a) * point.fraction;
            if place.xy().iter().any(|c| !(0.05..0.95).contains(c)) {
                continue;
            }
            let waves = (cos * place.x + sin * place.y) / WAVELENGTH - 0.5;
            worst = worst.max((waves - waves.round()).abs());
            sum += point.curvature;
            count += 1.0;
        }
        let mean = sum / count / curvature;
        println!(
            "angle {angle}: {} valleys, {worst:.4} of a wave off at most, curvature {mean:.3}",
            found.len()
        );
        assert!(
            worst < 0.03,
            "a valley lies {worst} of a wave beside its place"
        );
        assert!((mean - 1.0).abs() < 0.1, "curvature {mean}");
        let longest = found.iter().map(|valley| valley.points.len()).max();
        assert!(longest > Some(60), "valleys are in pieces");
    }
}

#[test]
fn ridges_and_plains_have_no_valleys() {
    let sheet = square(20, 0.3, 3);
    let heights: Vec<f64> = sheet
        .positions
        .iter()
        .map(|p| -(p.x - 0.5).powi(2))
        .collect();
    for heights in [heights, vec![0.0; sheet.positions.len()]] {
        let relief = Relief {
            mesh: &sheet.mesh,
            positions: &sheet.positions,
            heights: &heights,
        };
        assert!(valleys(&relief, &vec![1e-3; heights.len()]).is_empty());
    }
}

fn line(y: f64, turn: f64) -> FoldedLine {
    FoldedLine {
        points: (0..=100)
            .map(|i| Vector3::new(0.01 * f64::from(i), y, 0.0))
            .collect(),
        turns: vec![turn; 101],
        is_closed: false,
    }
}

#[test]
fn lines_keep_apart_and_the_deeper_one_is_kept() {
    let mut lines = NewLines::new(0.1, 0.3, 0.2, []);
    let chosen = lines.choose(&[line(0.0, 0.5), line(0.05, 0.8), line(0.2, 0.3)]);
    let heights: Vec<f64> = chosen.iter().map(|line| line.points[0].y).collect();
    assert_eq!(heights, [0.05, 0.2]);
    // What is there already cuts a line in two, of which one is too short.
    let mut lines = NewLines::new(0.1, 0.3, 0.2, [Vector3::new(0.3, 0.0, 0.0)]);
    let chosen = lines.choose(&[line(0.0, 0.5)]);
    assert_eq!(chosen.len(), 1);
    assert!((chosen[0].points[0].x - 0.4).abs() < 0.011);
    assert!(
        chosen[0]
            .turns
            .iter()
            .all(|turn| (turn - 0.5).abs() < 1e-12)
    );
}

#[test]
fn a_ring_stays_a_ring_until_it_is_cut() {
    let ring = FoldedLine {
        points: (0..200)
            .map(|i| {
                let (sin, cos) = (TAU * f64::from(i) / 200.0).sin_cos();
                Vector3::new(cos, sin, 0.0)
            })
            .collect(),
        turns: vec![1.0; 200],
        is_closed: true,
    };
    let whole = NewLines::new(0.1, 0.3, 0.2, []).choose(std::slice::from_ref(&ring));
    assert!(whole.len() == 1 && whole[0].is_closed);
    let cut = NewLines::new(0.1, 0.3, 0.2, [Vector3::new(0.0, 1.0, 0.0)]).choose(&[ring]);
    assert!(cut.len() == 1 && !cut[0].is_closed, "{}", cut.len());
}
