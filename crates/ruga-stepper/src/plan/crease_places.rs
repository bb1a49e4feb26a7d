//! Crease lines from where they are drawn, the artist's flat triangles, to the smooth surface.
//!
//! Loop subdivision moves places sideways, by millimetres beside triangles of a centimetre, and maps are
//! addressed by what lies straight above or below on the flat ones. A line that ran through the same material
//! points would come out of the maps bent where it was drawn straight.

use nalgebra::Vector3;
use ruga_blend::{Driver, Smoothing, SurfacePoints};
use ruga_crease::{LineInput, LineTracer, TracedLine};
use ruga_mesh::{MaterialPoint, SurfaceLookup};

use crate::CreaseSpec;
use crate::plan::stacking::Stacking;

/// Points of a line per wavelength.
const POINTS: f64 = 12.0;

/// Points of a line at most.
const MOST_POINTS: f64 = 1e5;

/// Steps towards the place of the smooth surface that lies under a place of a flat triangle, each from where the
/// one before ended.
const STEPS: usize = 4;

/// Moves the lines of all creases under where they are drawn.
pub(crate) fn put_under_drawn_lines(
    driver: &Driver,
    smoothing: Smoothing,
    stacking: &mut Stacking,
) {
    let layers = stacking.specs.iter_mut().zip(&stacking.wrinkling);
    for (layer, wave) in layers.filter(|(layer, _)| !layer.creases.is_empty()) {
        let on = (driver, smoothing);
        layer.creases = under_drawn_lines(on, &layer.creases, wave.wavelength);
    }
}

/// The creases of a layer of this wavelength (m) with their lines under where they are drawn. A line that cannot
/// be followed there, as over a border, stays where it is.
fn under_drawn_lines(
    (driver, smoothing): (&Driver, Smoothing),
    creases: &[CreaseSpec],
    wavelength: f64,
) -> Vec<CreaseSpec> {
    if smoothing == Smoothing::None {
        return creases.to_vec();
    }
    let tracer = LineTracer::new(driver.topology(), driver.rest());
    let lookup = SurfaceLookup::new(driver.topology(), driver.rest());
    let moved = creases.iter().map(|crease| {
        let drawn = points_of(&crease.line, wavelength / POINTS);
        let line = tracer.trace(&LineInput::Places {
            places: under((driver, smoothing), &lookup, &drawn),
            is_closed: crease.line.is_closed(),
        });
        CreaseSpec {
            line: line.unwrap_or_else(|_| crease.line.clone()),
            ..crease.clone()
        }
    });
    moved.collect()
}

/// Points along a line, `distance` (m) apart.
fn points_of(line: &TracedLine, distance: f64) -> Vec<MaterialPoint> {
    let count = (line.length() / distance).ceil().clamp(2.0, MOST_POINTS) as u32;
    let last = count - u32::from(line.is_closed());
    let at = |i: u32| line.length() * f64::from(i) / f64::from(count);
    (0..=last).filter_map(|i| line.place(at(i))).collect()
}

/// The material points whose places on the smooth surface lie straight under or above those of `drawn` on flat
/// triangles.
fn under(
    (driver, smoothing): (&Driver, Smoothing),
    lookup: &SurfaceLookup<'_>,
    drawn: &[MaterialPoint],
) -> Vec<MaterialPoint> {
    let flat = |place: &MaterialPoint| place.interpolate(driver.topology(), driver.rest());
    let mut places = drawn.to_vec();
    for _ in 0..STEPS {
        let smooth = SurfacePoints::new(driver, places.clone(), smoothing).pose(driver.rest());
        let surface = smooth.positions.iter().zip(&smooth.normals);
        for ((place, wanted), (at, normal)) in places.iter_mut().zip(drawn).zip(surface) {
            let off = flat(wanted) - at;
            let sideways: Vector3<f64> = off - normal * normal.dot(&off);
            let target = flat(place) + sideways;
            let reach = 2.0 * sideways.norm();
            if let Some(found) = lookup.closest_near(place.face, &target, reach) {
                *place = found.point;
            }
        }
    }
    places
}
