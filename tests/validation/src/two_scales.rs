//! Small wrinkles on large ones, told apart: what a pair of layers does along lines across the
//! wrinkles.

use std::f64::consts::{FRAC_PI_4, PI};

use nalgebra::{Vector2, Vector3};
use ruga_stepper::LayerSurface;

use crate::{FlatSurface, Lines, Patch};

/// Width of the Gaussian mean that is taken off the fine height, in fine wavelengths: what stays is
/// 0.96 of a fine wave and a seventh of one that is 4.6 times as long.
const MEAN_WIDTH: f64 = 0.4;

/// Samples per fine wavelength along a line.
const SAMPLES: f64 = 16.0;

/// A wave counts as developed where its amplitude is this share of its largest.
const DEVELOPED: f64 = 0.6;

/// Where and how finely a pair of layers is looked at; all in m, at rest.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    /// Extent along x, about the middle.
    pub length: f64,
    /// Extent along y, about the middle.
    pub width: f64,
    /// Lines along x.
    pub lines: usize,
    /// The lower layer's predicted wavelength.
    pub large: f64,
    /// The upper layer's.
    pub fine: f64,
}

/// One line along x.
#[derive(Clone, Debug)]
pub struct Profile {
    /// Height of the lower layer over the driver, m.
    pub lower: Vec<f64>,
    /// Distance of the upper layer from the lower one along that one's normal, less its mean over
    /// about a fine wavelength, m.
    pub fine: Vec<f64>,
    /// Phase of the lower layer's wave: 0 on crests, ±π in valleys; `None` where it is not
    /// developed.
    pub phase: Vec<Option<f64>>,
}

/// RMS of the fine height by the phase of the large wave, each over a quarter of it, m.
#[derive(Clone, Copy, Debug)]
pub struct FineHeights {
    /// On crests.
    pub crest: f64,
    /// On flanks, both sides together: half of the wave.
    pub flank: f64,
    /// In valleys.
    pub valley: f64,
}

/// Lines across the wrinkles of two layers on a patch.
#[derive(Clone, Debug)]
pub struct TwoScales {
    /// Height of the upper layer over the driver.
    pub total: Lines,
    /// The lines.
    pub profiles: Vec<Profile>,
    /// Largest amplitude of the lower layer's wave, m.
    pub largest: f64,
}

impl TwoScales {
    /// Samples `lower` and the `upper` layer on it.
    ///
    /// # Panics
    /// When the window leaves the layers.
    pub fn new(patch: &Patch, lower: &LayerSurface, upper: &LayerSurface, window: &Window) -> Self {
        let surfaces =
            [lower, upper].map(|layer| FlatSurface::new(layer, [patch.length, patch.width]));
        let count = (SAMPLES * window.length / window.fine) as usize;
        let step = window.length / count as f64;
        let line = |j: usize| {
            let y = ((j as f64 + 0.5) / window.lines as f64 - 0.5) * window.width;
            let places =
                (0..=count).map(|i| Vector2::new(i as f64 * step - 0.5 * window.length, y));
            let places: Vec<_> = places.collect();
            profile(&surfaces, &places, step, window)
        };
        let (totals, mut profiles): (Vec<_>, Vec<Profile>) = (0..window.lines).map(line).unzip();
        let amplitudes = profiles
            .iter()
            .flat_map(|p| large_amplitudes(p, step, window));
        let largest = amplitudes.fold(0.0, f64::max);
        for profile in &mut profiles {
            let amplitudes = large_amplitudes(profile, step, window);
            for (phase, amplitude) in profile.phase.iter_mut().zip(amplitudes) {
                *phase = phase.filter(|_| amplitude > DEVELOPED * largest);
            }
        }
        Self {
            total: Lines {
                step,
                heights: totals,
            },
            profiles,
            largest,
        }
    }

    /// How high the fine wrinkles are on the parts of the large wave.
    pub fn fine_heights(&self) -> FineHeights {
        let rms = |is_part: &dyn Fn(f64) -> bool| {
            let samples = self
                .profiles
                .iter()
                .flat_map(|p| p.fine.iter().zip(&p.phase));
            let heights = samples.filter(|(_, phase)| phase.is_some_and(is_part));
            let (sum, count) = heights.fold((0.0, 0.0), |(sum, count), (height, _)| {
                (sum + height * height, count + 1.0)
            });
            (sum / count).sqrt()
        };
        FineHeights {
            crest: rms(&|phase| phase.abs() < FRAC_PI_4),
            flank: rms(&|phase| (FRAC_PI_4..PI - FRAC_PI_4).contains(&phase.abs())),
            valley: rms(&|phase| phase.abs() > PI - FRAC_PI_4),
        }
    }
}

fn profile(
    [lower, upper]: &[FlatSurface<'_>; 2],
    places: &[Vector2<f64>],
    step: f64,
    window: &Window,
) -> (Vec<f64>, Profile) {
    let below: Vec<_> = places.iter().map(|&place| lower.position(place)).collect();
    let above: Vec<_> = places.iter().map(|&place| upper.position(place)).collect();
    let normals = normals(&below, (0.1 * window.large / step) as usize);
    let distance: Vec<f64> = (0..places.len())
        .map(|i| normals[i].dot(&(above[i] - below[i])))
        .collect();
    let mean = gaussian_mean(&distance, MEAN_WIDTH * window.fine / step);
    let heights: Vec<f64> = below.iter().map(|x| x.z - lower.offset()).collect();
    let quarter = quarter(step, window);
    let phase = |i: usize| {
        let [height, slope] = quadrature(&heights, quarter, i)?;
        Some(slope.atan2(height))
    };
    let total = above.iter().map(|x| x.z - upper.offset()).collect();
    let fine = distance.iter().zip(mean).map(|(d, mean)| d - mean);
    let profile = Profile {
        fine: fine.collect(),
        phase: (0..places.len()).map(phase).collect(),
        lower: heights,
    };
    (total, profile)
}

/// Upward normals of a curve in planes of constant y, from chords of `reach` samples either way.
fn normals(curve: &[Vector3<f64>], reach: usize) -> Vec<Vector3<f64>> {
    let last = curve.len() - 1;
    (0..curve.len())
        .map(|i| {
            let reach = reach.min(i).min(last - i).max(1);
            let chord = curve[(i + reach).min(last)] - curve[i.saturating_sub(reach)];
            Vector3::new(-chord.z, 0.0, chord.x).normalize()
        })
        .collect()
}

/// The mean of `values` about each, Gaussian with a standard deviation of `width` samples.
fn gaussian_mean(values: &[f64], width: f64) -> Vec<f64> {
    let reach = (3.0 * width) as usize;
    (0..values.len())
        .map(|i| {
            let range = i.saturating_sub(reach)..(i + reach + 1).min(values.len());
            let (sum, weights) = range.fold((0.0, 0.0), |(sum, weights), j| {
                let weight = (-0.5 * ((j as f64 - i as f64) / width).powi(2)).exp();
                (sum + weight * values[j], weights + weight)
            });
            sum / weights
        })
        .collect()
}

/// Samples in a quarter of the large wave.
fn quarter(step: f64, window: &Window) -> usize {
    (0.25 * window.large / step).round() as usize
}

/// A wave's height about the middle of its neighbours half a wave away, and its height a quarter of
/// a wave later less the one a quarter before: `A cos φ` and `-A sin φ`, twice each.
fn quadrature(heights: &[f64], quarter: usize, i: usize) -> Option<[f64; 2]> {
    let at = |j: usize| heights.get(j);
    let before = at(i.checked_sub(2 * quarter)?)?;
    let after = at(i + 2 * quarter)?;
    let height = heights[i] - 0.5 * (before + after);
    let slope = at(i + quarter)? - at(i - quarter)?;
    Some([height, slope])
}

/// Amplitude of the lower layer's wave about each sample; zero near the ends, m.
fn large_amplitudes(profile: &Profile, step: f64, window: &Window) -> Vec<f64> {
    let quarter = quarter(step, window);
    let amplitude = |i: usize| {
        let quadrature = quadrature(&profile.lower, quarter, i);
        quadrature.map_or(0.0, |[height, slope]| 0.5 * height.hypot(slope))
    };
    (0..profile.lower.len()).map(amplitude).collect()
}
