//! Small wrinkles on large ones, told apart: what a pair of layers does along lines across the
//! wrinkles.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use nalgebra::{Vector2, Vector3};
use ruga_mesh::{Id, PerFace, PlanarLookup, VertexId};
use ruga_stepper::LayerSurface;

use crate::Patch;

/// Width of the Gaussian mean that is taken off the fine height, in fine wavelengths: what stays is
/// 0.96 of a fine wave and a seventh of one that is 4.6 times as long.
const MEAN_WIDTH: f64 = 0.4;

/// Samples per fine wavelength along a line.
const SAMPLES: f64 = 16.0;

/// Wavelengths at which a peak is looked for: half a per cent apart.
const WAVELENGTHS: usize = 200;

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
    /// Height of the upper layer over the driver, m.
    pub total: Vec<f64>,
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
    /// Distance between samples, m.
    pub step: f64,
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
        let surfaces = [lower, upper].map(|layer| Sampled::new(patch, layer));
        let count = (SAMPLES * window.length / window.fine) as usize;
        let step = window.length / count as f64;
        let line = |j: usize| {
            let y = ((j as f64 + 0.5) / window.lines as f64 - 0.5) * window.width;
            let places =
                (0..=count).map(|i| Vector2::new(i as f64 * step - 0.5 * window.length, y));
            let places: Vec<_> = places.collect();
            profile(&surfaces, &places, step, window)
        };
        let mut profiles: Vec<Profile> = (0..window.lines).map(line).collect();
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
            step,
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

    /// The wavelength inside `range` (m) at which the total height has most power; `None` when that
    /// is an end of the range, and no peak.
    pub fn peak(&self, range: [f64; 2]) -> Option<f64> {
        let ratio = (range[1] / range[0]).ln() / WAVELENGTHS as f64;
        let wavelength = |i: usize| range[0] * (ratio * i as f64).exp();
        let powers: Vec<f64> = (0..=WAVELENGTHS)
            .map(|i| self.power(wavelength(i)))
            .collect();
        let best = (0..=WAVELENGTHS).max_by(|&a, &b| powers[a].total_cmp(&powers[b]))?;
        (1..WAVELENGTHS).contains(&best).then(|| wavelength(best))
    }

    /// Mean over the lines of the squared amplitude of the total height's wave of length
    /// `wavelength` (m), under a Hann window, m².
    pub fn power(&self, wavelength: f64) -> f64 {
        let of_line = |profile: &Profile| {
            let count = profile.total.len();
            let mean = profile.total.iter().sum::<f64>() / count as f64;
            let (mut real, mut imaginary, mut weights) = (0.0, 0.0, 0.0);
            for (i, height) in profile.total.iter().enumerate() {
                let weight = (PI * i as f64 / (count - 1) as f64).sin().powi(2);
                let (sin, cos) = (TAU * i as f64 * self.step / wavelength).sin_cos();
                real += weight * (height - mean) * cos;
                imaginary += weight * (height - mean) * sin;
                weights += weight;
            }
            4.0 * (real * real + imaginary * imaginary) / (weights * weights)
        };
        self.profiles.iter().map(of_line).sum::<f64>() / self.profiles.len() as f64
    }
}

/// A layer that can be asked for by its places at rest.
struct Sampled<'a> {
    layer: &'a LayerSurface,
    lookup: PlanarLookup,
}

impl<'a> Sampled<'a> {
    fn new(patch: &Patch, layer: &'a LayerSurface) -> Self {
        let material = |v: u32| patch.material(&layer.driver_positions[v as usize]);
        let triangles = layer.faces.iter().map(|face| face.map(material));
        Self {
            layer,
            lookup: PlanarLookup::new(triangles.collect::<PerFace<_>>()),
        }
    }

    /// Position in space of the layer's material at a place of the patch, m.
    fn position(&self, place: Vector2<f64>) -> Vector3<f64> {
        let point = self.lookup.locate(place).expect("a place of the layer");
        let face = self.layer.faces[point.face.index()];
        let corners = face.map(|v| self.layer.positions[VertexId(v).index()]);
        let weighted = corners.iter().zip(point.barycentric);
        weighted.map(|(x, weight)| x * weight).sum()
    }
}

fn profile(
    [lower, upper]: &[Sampled<'_>; 2],
    places: &[Vector2<f64>],
    step: f64,
    window: &Window,
) -> Profile {
    let below: Vec<_> = places.iter().map(|&place| lower.position(place)).collect();
    let above: Vec<_> = places.iter().map(|&place| upper.position(place)).collect();
    let normals = normals(&below, (0.1 * window.large / step) as usize);
    let distance: Vec<f64> = (0..places.len())
        .map(|i| normals[i].dot(&(above[i] - below[i])))
        .collect();
    let mean = gaussian_mean(&distance, MEAN_WIDTH * window.fine / step);
    let lower: Vec<f64> = below.iter().map(|x| x.z - lower.layer.offset).collect();
    let quarter = quarter(step, window);
    let phase = |i: usize| {
        let [height, slope] = quadrature(&lower, quarter, i)?;
        Some(slope.atan2(height))
    };
    Profile {
        total: above.iter().map(|x| x.z - upper.layer.offset).collect(),
        fine: distance
            .iter()
            .zip(mean)
            .map(|(d, mean)| d - mean)
            .collect(),
        phase: (0..places.len()).map(phase).collect(),
        lower,
    }
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
