//! What a line keeps where it fades towards its ends.

use ruga_crease::{CreaseMemory, FoldedLine, Kept, LineLaw, TracedLine};

use crate::Scene;
use crate::folds::CreaseFolds;
use crate::network::KeptCrease;
use crate::network_creases::FADE;

/// Memory of a line by samples of it that keeps nowhere beside `full` more than at the nearest sample in there, or than
/// it kept `before`.
///
/// What a line keeps fades with everything else of it. Near an end skin is folded beyond what is left there, so that
/// each pose would add to an angle of which it feels a small part only, without end.
pub(crate) fn levelled(
    samples: Vec<(f64, Kept)>,
    [from, to]: [f64; 2],
    before: &CreaseMemory,
) -> CreaseMemory {
    let memory = CreaseMemory::new(samples);
    let samples = memory.samples();
    // Where no sample lies in there, the next one counts.
    let highest = samples.len().saturating_sub(1);
    let first = samples.partition_point(|sample| sample.0 < from);
    let first = first.min(highest);
    let last = samples.partition_point(|sample| sample.0 <= to);
    let last = last.saturating_sub(1).max(first);
    let level = |(number, &(share, kept)): (usize, &(f64, Kept))| {
        let bound = samples[number.clamp(first, last)].1;
        let before = before.at(share);
        let most = bound.angle.abs().max(before.angle.abs());
        let levelled = Kept {
            angle: kept.angle.clamp(-most, most),
            softness: kept.softness.min(bound.softness.max(before.softness)),
        };
        (share, levelled)
    };
    CreaseMemory::new(samples.iter().enumerate().map(level).collect())
}

/// The same of a line that wrinkles have left in a layer of this wavelength (m).
pub(crate) fn levelled_new(
    samples: Vec<(f64, Kept)>,
    line: &FoldedLine,
    wavelength: f64,
) -> CreaseMemory {
    let fade = match line.is_closed {
        true => 0.0,
        false => (FADE * wavelength / line.length()).min(0.5),
    };
    levelled(samples, [fade, 1.0 - fade], &CreaseMemory::default())
}

/// Shares of a line between which the edges that it was simulated on, in poses that fold it like this, have no part in
/// the fades of its ends.
pub(crate) fn full_strength(law: &LineLaw, line: &TracedLine, folds: &[&CreaseFolds]) -> [f64; 2] {
    if line.is_closed() {
        return [0.0, 1.0];
    }
    let [start, end] = law.fade.map(|fade| fade / line.length());
    let middles = folds.iter().map(|folds| {
        let middles = folds.along.iter().map(|sample| sample[0]);
        middles.collect::<Vec<f64>>()
    });
    let (mut from, mut to) = (start, 1.0 - end);
    for middles in middles {
        let back: Vec<f64> = middles.iter().rev().map(|share| 1.0 - share).collect();
        from = from.max(beyond(&middles, start));
        to = to.min(1.0 - beyond(&back, end));
    }
    match from <= to {
        true => [from, to],
        // All of it fades: what is strongest counts.
        false => [0.5 * (from + to); 2],
    }
}

/// Middle of the first edge after a fade of this share, by the `middles` of edges in order; the end of the fade where
/// none has a part in it.
fn beyond(middles: &[f64], fade: f64) -> f64 {
    let begins_there = |pair: &[f64]| 2.0 * pair[0] - pair[1] < fade;
    if fade == 0.0 || !middles.windows(2).next().is_some_and(begins_there) {
        return fade;
    }
    // An edge begins after the middle of the one before.
    let pairs = middles.windows(2).find(|pair| pair[0] >= fade);
    pairs.map_or(fade, |pair| pair[1])
}

impl Scene {
    /// Largest angle (rad), with its sign, that a crease of a network of this scene is folded by without anything that
    /// folds it: what it keeps, as far as it does not fade.
    pub fn largest_kept(&self, kept: &KeptCrease) -> f64 {
        let layer = self.layers.iter().find(|layer| layer.name == kept.layer);
        let mut creases = layer.iter().flat_map(|layer| &layer.creases);
        let drawn = creases.find(|crease| crease.name == kept.name);
        let memory = kept.memory();
        let Some(crease) = drawn else {
            return memory.largest_angle();
        };
        let (length, is_closed) = (crease.line.length(), crease.line.is_closed());
        let strength = |share: f64| crease.law.taper(share * length, length, is_closed);
        let samples = memory.samples().iter();
        let angles = samples.map(|(share, kept)| strength(*share) * kept.angle);
        angles.fold(0.0, |a, b| if b.abs() > a.abs() { b } else { a })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_is_kept_towards_an_end_than_beyond_its_fade() {
        let levels = |full: [f64; 2], before: f64| {
            let angles = [0.1, 0.9, -0.9, 0.5, 0.2, 0.8, 0.4, 0.3, 0.2, 0.6, 0.6];
            let samples = angles.iter().enumerate().map(|(i, &angle): (usize, &f64)| {
                let softness = angle.abs();
                (0.1 * i as f64, Kept { angle, softness })
            });
            let before = [before; 2].map(|angle| {
                let softness = angle;
                (0.5, Kept { angle, softness })
            });
            let before = CreaseMemory::new(before.to_vec());
            let memory = levelled(samples.collect(), full, &before);
            let kept = memory.samples().iter().map(|(_, kept)| {
                assert_eq!(kept.softness, kept.angle.abs());
                kept.angle
            });
            kept.collect::<Vec<f64>>()
        };
        let levelled = [0.1, 0.5, -0.5, 0.5, 0.2, 0.8, 0.4, 0.3, 0.2, 0.2, 0.2];
        assert_eq!(levels([0.25, 0.85], 0.0), levelled);
        assert_eq!(levels([0.0, 1.0], 0.0)[2], -0.9);
        // What was kept before stays.
        assert_eq!(levels([0.25, 0.85], 0.6)[..3], [0.1, 0.6, -0.6]);
        assert_eq!(levels([0.25, 0.85], 0.6)[9..], [0.6; 2]);
        let one = [0.1, 0.3, -0.3, 0.3, 0.2, 0.3, 0.3, 0.3, 0.2, 0.3, 0.3];
        assert_eq!(levels([0.65, 0.66], 0.0), one);
    }

    #[test]
    fn an_edge_that_reaches_into_a_fade_is_not_beyond_it() {
        // Edges that end at 0.2, 0.4 and so on.
        let middles = [0.1, 0.3, 0.5, 0.7, 0.9];
        assert_eq!(beyond(&middles, 0.25), 0.5);
        assert_eq!(beyond(&middles, 0.05), 0.3);
        assert_eq!(beyond(&middles, 0.0), 0.0);
        // Those towards the end were not simulated.
        assert_eq!(beyond(&middles[2..], 0.25), 0.25);
        assert_eq!(beyond(&middles[..1], 0.25), 0.25);
    }
}
