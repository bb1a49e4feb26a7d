//! Whether a line lies where one of a network of creases lay, and what of its memory is where along it.

use nalgebra::Vector3;
use ruga_blend::Driver;
use ruga_crease::{CreaseMemory, TracedLine};

use crate::network::KeptCrease;

/// How a line runs along the places of a remembered one: from which end, and how far off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fit {
    /// Share of the line at which the remembered one starts.
    start: f64,
    /// Whether it runs the other way round.
    is_turned: bool,
    /// The place that is farthest off.
    pub(crate) farthest: Moved,
}

/// A place of a line, and where it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moved {
    /// Share of the remembered line.
    pub(crate) share: f64,
    /// Where it was, m.
    pub(crate) was: Vector3<f64>,
    /// Where it is, m.
    pub(crate) is: Vector3<f64>,
}

impl Moved {
    /// Distance between both, m.
    fn distance(&self) -> f64 {
        (self.is - self.was).norm()
    }
}

/// How a line over a mesh at rest runs along the places of a remembered one, in whichever of its directions is
/// nearer; a ring may begin anywhere. `None` where there are no places.
pub(crate) fn best_fit(kept: &KeptCrease, line: &TracedLine, driver: &Driver) -> Option<Fit> {
    let places: Vec<Vector3<f64>> = kept.places_m.iter().map(|p| (*p).into()).collect();
    let first = places.first()?;
    let starts = match line.is_closed() {
        true => [nearest_share(line, first, driver); 2],
        false => [0.0, 1.0],
    };
    let fits = starts.into_iter().zip([false, true]);
    let fits = fits.filter_map(|(start, is_turned)| {
        let moved = places.iter().enumerate().filter_map(|(i, was)| {
            let share = i as f64 / (places.len() - 1).max(1) as f64;
            let at = along(start, is_turned, share) * line.length();
            let is = line.place(at)?;
            Some(Moved {
                share,
                was: *was,
                is: is.interpolate(driver.topology(), driver.rest()),
            })
        });
        let farthest = moved.max_by(|a, b| a.distance().total_cmp(&b.distance()))?;
        Some(Fit {
            start,
            is_turned,
            farthest,
        })
    });
    fits.min_by(|a, b| a.farthest.distance().total_cmp(&b.farthest.distance()))
}

impl Fit {
    /// Largest distance from where the line was, m.
    pub(crate) fn off(&self) -> f64 {
        self.farthest.distance()
    }

    /// What a remembered line keeps, along the line that lies there now.
    pub(crate) fn memory(&self, kept: &KeptCrease, is_closed: bool) -> CreaseMemory {
        let memory = kept.memory();
        if self.start == 0.0 && !self.is_turned {
            return memory;
        }
        let samples = memory.samples().iter().map(|&(share, kept)| {
            let share = along(self.start, self.is_turned, share);
            match is_closed {
                true => (share.rem_euclid(1.0), kept),
                false => (share, kept),
            }
        });
        match is_closed {
            true => CreaseMemory::around(samples.collect()),
            false => CreaseMemory::new(samples.collect()),
        }
    }
}

/// Share of a line at a share of a remembered one that starts at `start` of it; of a ring it may lie in another round.
fn along(start: f64, is_turned: bool, share: f64) -> f64 {
    match is_turned {
        true => start - share,
        false => start + share,
    }
}

/// Share of a line's length at which it is nearest to a point.
fn nearest_share(line: &TracedLine, point: &Vector3<f64>, driver: &Driver) -> f64 {
    let (mesh, rest) = (driver.topology(), driver.rest());
    let on_segments = line.segments().iter().map(|segment| {
        let [from, to] = [0.0, 1.0].map(|end| segment.place(end).interpolate(mesh, rest));
        let way = to - from;
        let share = ((point - from).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
        let distance = (from + way * share - point).norm();
        (distance, segment.start + segment.length * share)
    });
    let nearest = on_segments.min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.map_or(0.0, |(_, at)| at / line.length())
}
