//! Curl of a strip, ours and by the springs of Jeong, Kim and Kim 2011: measured, and drawn into a panel.

use std::error::Error;

use serde::{Deserialize, Serialize};

use crate::cpu_seconds;
use crate::curling_strip::{WIDTH, curling_strip};
use crate::plot::colours::{BLUE, PAPER, RED};
use crate::plot::{Axis, Drawn, Lettering, PLAIN, Page, Panel, Shape, Title, stroke};
use crate::spring_sheet::Projection;
use crate::spring_sheet::curl::CurlStrip;

/// A strip that one method bent.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CurlRun {
    /// Whether springs did; otherwise the product.
    pub is_springs: bool,
    /// Distance of the two layers in cells of the springs.
    pub thickness: f64,
    /// Projections of the springs, or triangles across the product's strip.
    pub number: usize,
    /// Mean curvature over that wanted.
    pub curl: f64,
    /// Processor seconds.
    pub seconds: f64,
    /// Processor seconds after which the product, on its way there, is as near as the springs get.
    pub as_near: Option<f64>,
}

impl CurlRun {
    /// What the curvature is off by, over that wanted.
    pub fn error(&self) -> f64 {
        (self.curl - 1.0).abs()
    }
}

/// Distances of the two layers, in cells.
pub const THICKNESSES: [f64; 2] = [0.25, 0.0625];

/// Cells of the strip of springs: four across, as the coarsest of the product's meshes.
const CELLS: [usize; 2] = [40, 4];

/// What the corner layer is shorter by.
pub const SHRINKAGE: f64 = 0.02;

/// Projections after which springs are looked at.
pub const PROJECTIONS: [usize; 5] = [1, 7, 50, 200, 1000];

/// Triangles across the product's strip. Two are too few where layers are close: they cannot bend that far.
const ACROSS: [usize; 5] = [2, 4, 8, 16, 24];

/// Share of triangles too large for their natural curvature above which a strip is left out.
const MOST_CAPPED: f64 = 0.05;

/// Times that a run is made; the quickest counts.
pub const REPEATS: usize = 3;

/// Seconds from which on a run is made once.
const LONG: f64 = 1.0;

/// Measures both methods at both distances, or all but the finest of each if quick.
///
/// # Errors
/// What shell and solver refuse, and strips that do not come to rest.
pub fn measure_curls(quick: bool) -> Result<Vec<CurlRun>, Box<dyn Error>> {
    let of = |counts: &[usize]| counts[..counts.len() - usize::from(quick)].to_vec();
    let mut curls = Vec::new();
    for thickness in THICKNESSES {
        let mut best = springs(thickness, &of(&PROJECTIONS))?;
        for _ in 1..REPEATS {
            let again = springs(thickness, &of(&PROJECTIONS))?;
            for (best, again) in best.iter_mut().zip(again) {
                best.seconds = best.seconds.min(again.seconds);
            }
        }
        let near = best
            .iter()
            .map(CurlRun::error)
            .fold(f64::INFINITY, f64::min);
        curls.append(&mut best);
        for across in of(&ACROSS) {
            curls.extend(product(thickness, across, near)?);
        }
    }
    Ok(curls)
}

fn strip(thickness: f64) -> Result<CurlStrip, Box<dyn Error>> {
    let cell = WIDTH / CELLS[1] as f64;
    Ok(CurlStrip::new(CELLS, cell, thickness * cell, SHRINKAGE)?)
}

/// Curl by springs after numbers of projections, without the time of setting up.
fn springs(thickness: f64, projections: &[usize]) -> Result<Vec<CurlRun>, Box<dyn Error>> {
    let mut strip = strip(thickness)?;
    let (mut done, mut seconds) = (0, 0.0);
    let mut curls = Vec::new();
    for &number in projections {
        let settings = Projection {
            steps: number - done,
            threshold: 0.0,
            ..Projection::default()
        };
        let start = cpu_seconds();
        strip.project(&settings);
        seconds += cpu_seconds() - start;
        done = number;
        curls.push(CurlRun {
            is_springs: true,
            thickness,
            number,
            curl: strip.curl(),
            seconds,
            as_near: None,
        });
    }
    Ok(curls)
}

/// Curl by the product, of a strip that wants the same curvature, and when it is as `near` to that; nothing if its
/// triangles are too large.
fn product(thickness: f64, across: usize, near: f64) -> Result<Option<CurlRun>, Box<dyn Error>> {
    let wanted = strip(thickness)?.wanted;
    let sheet = thickness * WIDTH / CELLS[1] as f64;
    let mut best = curling_strip(across, wanted, sheet)?;
    for _ in 1..REPEATS {
        if best.total_seconds() < LONG {
            let again = curling_strip(across, wanted, sheet)?;
            if again.total_seconds() < best.total_seconds() {
                best = again;
            }
        }
    }
    if !best.converged {
        return Err(format!("{across} triangles across do not come to rest").into());
    }
    let share = best.capped as f64 / best.faces as f64;
    let mut way = best.curls.iter().zip(&best.seconds);
    let as_near = way.find(|(curl, _)| (*curl - 1.0).abs() <= near);
    Ok((share < MOST_CAPPED).then_some(CurlRun {
        is_springs: false,
        thickness,
        number: across,
        curl: best.curl(),
        seconds: best.total_seconds(),
        as_near: as_near.map(|(_, seconds)| *seconds),
    }))
}

/// Processor seconds of the projections after which springs are nearest to the curl, at a distance of their layers, over
/// those after which the product is as near: speed against the paper's way at equal error. Of the product's meshes the
/// one that is there first counts.
pub fn times_sooner(runs: &[CurlRun], thickness: f64) -> Option<f64> {
    let own = || runs.iter().filter(|own| own.thickness == thickness);
    let springs = own().filter(|own| own.is_springs);
    let nearest = springs.min_by(|a, b| a.error().total_cmp(&b.error()))?;
    let product = own().filter_map(|own| own.as_near);
    let first = product.min_by(f64::total_cmp)?;
    Some(nearest.seconds / first)
}

/// Draws error of the curl over processor time, of both methods.
///
/// # Errors
/// What the drawing library says.
pub fn draw_curls(page: &Page<'_>, frame: [f64; 4], runs: &[CurlRun], thickness: f64) -> Drawn {
    let name = format!("Curl, layers {thickness} of a cell apart");
    let title = Title {
        name: &name,
        note: "upwards: curvature off by, %; numbers: projections, triangles across",
        across: "processor milliseconds",
    };
    let own: Vec<&CurlRun> = runs
        .iter()
        .filter(|own| own.thickness == thickness)
        .collect();
    let place = |own: &CurlRun| [1e3 * own.seconds, 100.0 * own.error()];
    let [x, y] = [0, 1].map(|side| {
        let values = own.iter().map(|own| place(own)[side]);
        Axis::logarithmic(values, 2.6)
    });
    let panel = Panel::draw(page, frame, title, [x, y])?;
    let [left, _, _, bottom] = frame;
    for (is_springs, name, colour) in [(true, "springs (the paper)", RED), (false, "ruga", BLUE)] {
        let runs = own.iter().filter(|own| own.is_springs == is_springs);
        let runs: Vec<_> = runs.map(|own| (own.number, place(own))).collect();
        let values: Vec<_> = runs.iter().map(|run| run.1).collect();
        let places = panel.places(&values);
        page.line(&places, stroke(colour, 2.4))?;
        let style = Lettering { colour, ..PLAIN };
        for (at, (number, _)) in places.into_iter().zip(&runs) {
            page.mark(at, Shape::Round, 5.0, [colour, PAPER])?;
            let above = Lettering {
                anchor: 0.5,
                ..style
            };
            page.text([at[0], at[1] - 14.0], &number.to_string(), above)?;
        }
        let line = bottom - if is_springs { 34.0 } else { 15.0 };
        page.text([left + 10.0, line], name, style)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_error_is_what_the_springs_reach() {
        let run = |is_springs: bool, seconds: f64, as_near: Option<f64>| CurlRun {
            is_springs,
            thickness: 0.25,
            number: 1,
            // The springs are nearest after 0.6 s, and farther off after that.
            curl: 1.0 - (seconds - 0.6).abs(),
            seconds,
            as_near,
        };
        let runs = [
            run(true, 0.1, None),
            run(true, 0.6, None),
            run(true, 0.9, None),
            run(false, 0.5, Some(0.03)),
            run(false, 0.2, Some(0.02)),
        ];
        let found = times_sooner(&runs, 0.25).expect("both were measured");
        assert!((found - 30.0).abs() < 1e-12);
        assert_eq!(times_sooner(&runs, 0.5), None);
        assert_eq!(times_sooner(&runs[..3], 0.25), None);
    }
}
