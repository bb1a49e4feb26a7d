//! A film on a half-space under even compression, as the product simulates it on a patch.

use std::f64::consts::{PI, TAU};

use nalgebra::{Vector2, Vector3};
use ruga_material::{LayerMaterial, Substrate, WavelengthModel, Wrinkling, wrinkling};
use ruga_stepper::{
    Grows, GrowthDirection, GrowthSpec, LayerSpec, LayerSurface, Mask, Modelling, Observer,
    PaintedNumber, PoseResult, Progress, Silent, StepperError, plan,
};

use crate::{FlatSurface, Lines, patch_driver, patch_pose};

/// Texels of the map that plans are made for.
const TEXELS: u32 = 1024;

/// Lines along the compression on which the wavelength is measured.
const LINES: usize = 12;

/// Samples per critical wavelength along a line.
const SAMPLES: f64 = 32.0;

/// Wavelengths, over the critical one, between which the film's is looked for.
const RANGE: [f64; 2] = [0.6, 1.6];

/// Texels of a painted growth.
const PAINTED: u32 = 512;

/// Distance of the loads at which the onset is looked for, as a share of them, and how many there are
/// in the bracket of 1.1/1.05 that a run leaves.
const ONSET_STEP: f64 = 0.004;
const ONSET_LOADS: i32 = 13;
/// Load far above any onset, in critical strains.
const BRACKETED: f64 = 1.5;

/// A film 0.1 mm thick on a half-space, on a rectangular patch that a blend shape compresses along x, or that
/// grows against its base as much: evenly, but for both ends, towards which the compression fades out.
///
/// The product holds the film at the border of the patch. Where the compression fades, wrinkles end by
/// themselves, so that no end makes them a whole number of half-waves. The sides flatten them; what is
/// measured is measured in the middle.
#[derive(Clone, Debug)]
pub struct FlatFilm {
    /// The film, what carries it, and how it is held.
    pub layer: LayerSpec,
    /// Extent of the even part along the compression and across it, in critical wavelengths.
    pub waves: [f64; 2],
    /// Compression of the full pose, in critical strains.
    pub load: f64,
    /// Squares of the artist's mesh per critical wavelength, at least.
    pub squares: f64,
    /// Seed by which the artist's vertices are moved about; without one they form squares.
    pub mesh_seed: Option<u64>,
    /// Radius of the cylinder about an axis along y on which the patch lies, in critical wavelengths; flat
    /// without.
    pub radius: Option<f64>,
    /// Cause of its compression.
    pub cause: Cause,
}

/// What compresses a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// A blend shape.
    Shape,
    /// Its own growth on a base that stays as it is.
    Growth,
}

/// Length of either end over which the compression fades, in critical wavelengths.
const FADING: f64 = 2.0;

/// Width of the frame inside the even part that is not measured, in critical wavelengths: along the
/// compression and across it.
const MARGINS: [f64; 2] = [1.0, 2.0];

/// What is measured on a film at one load.
#[derive(Clone, Copy, Debug)]
pub struct FilmState {
    /// `sqrt(2)` RMS height about the mean, in the middle of the patch, m.
    pub amplitude: f64,
    /// The amplitude over `(2/k) sqrt(eps - eps_c)`, of the wave number found; NaN below the critical
    /// strain and infinite at it.
    pub relative_amplitude: f64,
    /// Wavelength in material coordinates over the critical one.
    pub relative_wavelength: f64,
    /// Mean height in the middle, m.
    pub lift: f64,
}

/// Ends a run behind a fraction of its pose.
struct UpTo(f64);

impl Observer for UpTo {
    fn progress(&mut self, progress: Progress) -> bool {
        progress.load < self.0 * (1.0 + 1e-9)
    }

    fn wants_frames(&self) -> bool {
        // Only what goes on from load to load finds an onset.
        true
    }
}

impl FlatFilm {
    /// Makes a film `ratio` times as stiff as its base, to be compressed to four critical strains.
    pub fn new(ratio: f64) -> Self {
        let substrate = Substrate {
            young: 1e5,
            poisson: 0.3,
            thickness: 1.0,
        };
        let material = LayerMaterial {
            young: ratio * substrate.young,
            poisson: substrate.poisson,
            thickness: 1e-4,
            density: 1100.0,
        };
        Self {
            layer: LayerSpec {
                model: WavelengthModel::HalfSpace,
                ..LayerSpec::new("film", material, substrate)
            },
            waves: [8.0, 6.0],
            load: 4.0,
            squares: 1.0,
            mesh_seed: None,
            radius: None,
            cause: Cause::Shape,
        }
    }

    /// Half-space theory.
    ///
    /// # Panics
    /// When a material is out of range.
    pub fn theory(&self) -> Wrinkling {
        let LayerSpec {
            material,
            substrate,
            model,
            ..
        } = &self.layer;
        wrinkling(material, substrate, *model).expect("valid materials")
    }

    /// Extent of the patch, m.
    pub fn extent(&self) -> [f64; 2] {
        let [length, width] = self.waves;
        [length + 2.0 * FADING, width].map(|waves| waves * self.theory().wavelength)
    }

    /// Extent of the part that is measured, about the middle, m.
    pub fn middle(&self) -> [f64; 2] {
        let wavelength = self.theory().wavelength;
        [0, 1].map(|i| (self.waves[i] - 2.0 * MARGINS[i]) * wavelength)
    }

    /// Half of the even part, the length over which the compression fades, and how far beyond the even part `x` is, m.
    fn fading(&self, x: f64) -> [f64; 3] {
        let wavelength = self.theory().wavelength;
        let [even, fading] = [0.5 * self.waves[0], FADING].map(|waves| waves * wavelength);
        [even, fading, (x.abs() - even).clamp(0.0, fading)]
    }

    /// Where the full pose puts what is at `x`, m.
    fn posed(&self, x: f64) -> f64 {
        if self.cause == Cause::Growth {
            return x;
        }
        let [even, fading, beyond] = self.fading(x);
        // The integral of a cosine's half-wave from 1 to 0.
        let wave = 0.5 * (beyond + fading / PI * (PI * beyond / fading).sin());
        x - self.load * self.theory().critical_strain * (x.abs().min(even) + wave).copysign(x)
    }

    /// Growth of the film that compresses it as a blend shape does at a load, in critical strains.
    fn growth_at(&self, load: f64) -> f64 {
        1.0 / (1.0 - load * self.theory().critical_strain) - 1.0
    }

    /// The growth that compresses the film as the blend shape would, painted where it fades.
    fn growth(&self) -> GrowthSpec {
        let share = |i: u32| {
            let u = (f64::from(i) + 0.5) / f64::from(PAINTED);
            let [_, fading, beyond] = self.fading((u - 0.5) * self.extent()[0]);
            let load = 0.5 * self.load * (1.0 + (PI * beyond / fading).cos());
            (self.growth_at(load) / self.growth_at(self.load)) as f32
        };
        let image = Mask::new(PAINTED, 1, (0..PAINTED).map(share).collect());
        GrowthSpec {
            name: "growth".to_owned(),
            grows: Grows::Layer,
            along: self.growth_at(self.load),
            across: 0.0,
            curl: [0.0; 2],
            direction: GrowthDirection::Angle(0.0),
            paint: Some(PaintedNumber {
                image: image.expect("greys from 0 to 1"),
                range: [0.0, 1.0],
            }),
        }
    }

    /// Fraction of the pose at which the film is compressed by a load, in critical strains.
    fn fraction(&self, load: f64) -> f64 {
        match self.cause {
            Cause::Shape => load / self.load,
            Cause::Growth => self.growth_at(load) / self.growth_at(self.load),
        }
    }

    /// Load (critical strains) at a fraction of the pose.
    fn load_at(&self, fraction: f64) -> f64 {
        match self.cause {
            Cause::Shape => fraction * self.load,
            Cause::Growth => {
                let growth = fraction * self.growth_at(self.load);
                growth / (1.0 + growth) / self.theory().critical_strain
            }
        }
    }

    /// Where `x`, an arc on a cylinder, and `y` are in space, m.
    fn place(&self, x: f64, y: f64) -> Vector3<f64> {
        let Some(waves) = self.radius else {
            return Vector3::new(x, y, 0.0);
        };
        let radius = waves * self.theory().wavelength;
        let (sin, cos) = (x / radius).sin_cos();
        Vector3::new(radius * sin, y, radius * cos)
    }

    /// Simulates the film in `steps` load steps to its last load, with results at `loads`, in critical
    /// strains.
    ///
    /// # Errors
    /// What planner and stepper refuse.
    pub fn simulate(
        &self,
        modelling: &Modelling,
        (loads, steps): (&[f64], u32),
        observer: &mut dyn Observer,
    ) -> Result<PoseResult, StepperError> {
        let extent = self.extent();
        let squares = self.squares / self.theory().wavelength;
        let squares = extent.map(|m| (squares * m - 1e-9).ceil() as usize);
        let shape = |p: Vector2<f64>| [p.x, self.posed(p.x)].map(|x| self.place(x, p.y));
        let driver = patch_driver(extent, squares, self.mesh_seed, shape);
        let keys = loads.iter().map(|load| self.fraction(*load)).collect();
        let mut pose = patch_pose(&driver, keys, steps);
        let mut layer = self.layer.clone();
        if self.cause == Cause::Growth {
            let growth = self.growth();
            pose.growths = vec![(growth.name.clone(), 1.0)];
            layer.growths.push(growth);
        }
        plan(&driver, &[layer], &[pose], modelling, TEXELS)?.simulate(0, observer)
    }

    /// Results at `loads`, in critical strains, reached in no more steps than they are, and the state
    /// of the film at each.
    ///
    /// # Panics
    /// When the product refuses the film or finds no equilibrium.
    pub fn states(&self, modelling: &Modelling, loads: &[f64]) -> (PoseResult, Vec<FilmState>) {
        let result = self.simulate(modelling, (loads, 1), &mut Silent);
        let result = result.expect("a film that can be simulated");
        assert!(result.converged, "{:?}", result.warnings);
        let keys = result.keys.iter().zip(loads);
        let states = keys
            .map(|(key, &load)| self.state(&key.layers[0], load))
            .collect();
        (result, states)
    }

    /// Load at which the film first buckles, in critical strains, to 0.2 %; `None` where it does not.
    ///
    /// One run finds a bracket of it, another goes through that in small steps.
    ///
    /// # Errors
    /// What planner and stepper refuse.
    pub fn onset(&self, modelling: &Modelling) -> Result<Option<f64>, StepperError> {
        // The mesh is fitted to the last key, and ought to be the same in all runs.
        let last = self.fraction(BRACKETED);
        let loads = [BRACKETED, self.load];
        let bracketed = self.simulate(modelling, (&loads, 1), &mut UpTo(last))?;
        let Some(bound) = bracketed.layers[0].onset_load else {
            return Ok(None);
        };
        let load = |i: i32| self.load_at(bound) * (1.0 + ONSET_STEP).powi(i);
        let mut loads: Vec<f64> = (-ONSET_LOADS..=0).map(load).collect();
        if bound < 1.0 - 1e-9 {
            loads.push(self.load);
        }
        let mut watch = UpTo(bound);
        let result = self.simulate(modelling, (&loads, 1), &mut watch)?;
        let buckled = result.layers[0].onset_load;
        // A trial that buckles lies half a step above the onset in the mean.
        Ok(buckled.map(|load| self.load_at(load) * (1.0 - 0.5 * ONSET_STEP)))
    }

    /// Measures the film at `load` critical strains.
    pub fn state(&self, surface: &LayerSurface, load: f64) -> FilmState {
        let theory = self.theory();
        let flat = FlatSurface::new(surface, self.extent());
        let lines = self.lines(&flat);
        let wavelength = lines.peak(RANGE.map(|share| share * theory.wavelength));
        // Of a flat film no wavelength matters.
        let wavelength = wavelength.unwrap_or(theory.wavelength);
        // Whole waves.
        let [length, width] = self.middle();
        let length = (length / wavelength).floor().max(1.0) * wavelength;
        let [lift, amplitude] = flat.moments([length, width]);
        let excess = (load - 1.0) * theory.critical_strain;
        FilmState {
            amplitude,
            relative_amplitude: amplitude * TAU / wavelength * 0.5 / excess.sqrt(),
            relative_wavelength: wavelength / theory.wavelength,
            lift,
        }
    }

    fn lines(&self, flat: &FlatSurface<'_>) -> Lines {
        let step = self.theory().wavelength / SAMPLES;
        flat.lines(self.middle(), step, LINES)
    }
}
