//! A narrow strip of two layers, both solved at once or as the composite that stands for them.
//!
//! Ends are pinned and the sides slide, as those of a [`Film`](crate::Film): plane strain, and
//! no border along the wrinkles that would hold them down.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_material::{LayerMaterial, StackLayer, StackPair, Wrinkling};
use ruga_shell::{BendingModel, FaceParameters, LayerEnergy, LayerParameters, UpperSheet};
use ruga_solver::{AtSaddle, Kkt, LowerPattern, NewtonSettings, SolveReport, inertia_at, minimise};
use ruga_stepper::{LayerSpec, Stack};

use crate::film_objective::{FilmObjective, gather, scatter};
use crate::film_rows::{Row, side_rollers, to_constraint_rows};
use crate::{Base, Strip, equilateral};

/// Edges along y over those along x.
const ASPECT: f64 = 4.0;
/// Rows of triangles.
const ROWS: usize = 4;
/// Levenberg floor, as the product's layers have it, in units of `K0 V_i`.
const FLOOR: f64 = 1e-6;
/// Height over the amplitude from which on it is a crest, and below whose negative a valley: a quarter
/// of a sine each.
const TOP: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Noise at rest, in thicknesses of the upper layer.
const NOISE: f64 = 1e-3;
/// Left out at either end, in large wavelengths: pinned there, the layers fold at a hinge.
const REACH: f64 = 1.0;

/// Both layers of the strip, or the layer that stands for them.
pub struct StackStrip {
    /// Wave, onset and springs of the pair.
    pub wave: Wrinkling,
    /// Of the upper layer by itself, m.
    pub fine: f64,
    energy: LayerEnergy,
    strip: Strip,
    /// Distance of the upper layer, where it is one of its own, m.
    lever: Option<f64>,
    thickness: f64,
    free: Vec<u32>,
    kkt: Kkt,
    floor: Vec<f64>,
    positions: Vec<Vector3<f64>>,
    points: Vec<Vector3<f64>>,
}

/// The strip at one compression.
#[derive(Clone, Debug)]
pub struct StackState {
    /// Compression.
    pub strain: f64,
    /// How the solve went.
    pub solve: SolveReport,
    /// `sqrt(2)` RMS height of the lower layer, m.
    pub amplitude: f64,
    /// Of the lower layer, m, from the number of half-waves.
    pub wavelength: f64,
    /// RMS height of the upper layer over its mean over a fine wavelength, m, on crests and in
    /// valleys of the lower one, each a quarter of its wave; zero without an upper layer.
    pub fine: [f64; 2],
}

impl StackStrip {
    /// `waves` large wavelengths of `upper` on `lower`, with `points` edges per fine wavelength.
    ///
    /// # Panics
    /// When the pair has no joint wave, or for [`Stack::Nominal`], which has no common strip.
    pub fn new(layers: [&LayerSpec; 2], stack: Stack, waves: f64, points: f64) -> Self {
        let [lower, upper] = layers.map(|layer| {
            StackLayer::new(layer.material, &layer.substrate, layer.model).expect("a material")
        });
        let pair = StackPair::new(&lower, &upper).expect("a pair");
        let composite = pair.composite().expect("a joint wave");
        let wave = composite.wrinkling;
        let fine = upper.wrinkling.wavelength;
        let length = waves * wave.wavelength;
        let columns = (points * length / fine).round() as usize;
        let strip = equilateral(ASPECT * length, columns, ROWS).stretched(1.0 / ASPECT);
        let rest = Base::Flat.points(&strip, 0.0);
        let lever = 0.5 * (lower.material.thickness + upper.material.thickness);
        let (energy, lever) = match stack {
            Stack::Joint => (joint(&strip, &rest, &pair, lever), Some(lever)),
            Stack::Composite => {
                let layer = (&composite.material, &composite.wrinkling);
                let parameters = parameters(&strip, layer, wave.tangential_stiffness);
                (shell(&strip, &rest, parameters, None), None)
            }
            Stack::Nominal => panic!("each layer of a nominal stack has a strip of its own"),
        };
        let free = energy.free_vertices().to_vec();
        let (starts, entries) = energy.pattern();
        let pattern =
            LowerPattern::new(starts.to_vec(), entries.to_vec()).expect("a valid pattern");
        let mut all = strip.clone();
        if lever.is_some() {
            all.points.extend_from_slice(&strip.points);
        }
        let mut rows = side_rollers(&all, &free);
        rows.extend(level(&all, &free));
        let rows = to_constraint_rows(&rows, 3 * free.len());
        let areas = energy.vertex_areas();
        let floor = free
            .iter()
            .flat_map(|&v| [FLOOR * wave.normal_stiffness * areas[v as usize % areas.len()]; 3]);
        let positions = lifted(&rest, lever);
        Self {
            wave,
            fine,
            floor: floor.collect(),
            kkt: Kkt::new(&pattern, &rows, 3).expect("a valid system"),
            points: positions.clone(),
            positions,
            thickness: upper.material.thickness,
            energy,
            strip,
            lever,
            free,
        }
    }

    /// Compresses the base to `strain` and carries the layers along.
    fn set_strain(&mut self, strain: f64) {
        let base = Base::Flat.points(&self.strip, strain);
        let normals = vec![Vector3::z(); base.len()];
        self.energy
            .set_base(&base, &normals, &vec![0.0; base.len()])
            .expect("a valid base");
        let points = lifted(&base, self.lever);
        for (x, (old, new)) in self
            .positions
            .iter_mut()
            .zip(self.points.iter().zip(&points))
        {
            *x += new - old;
        }
        self.points = points;
    }

    /// The layers lying on the base at `strain`.
    fn lay_down(&mut self, strain: f64) {
        self.set_strain(strain);
        self.positions.clone_from(&self.points);
    }

    fn objective(&mut self) -> (FilmObjective<'_>, &mut Kkt) {
        let objective = FilmObjective {
            energy: &self.energy,
            free: &self.free,
            positions: &self.positions,
            pattern: self.kkt.pattern().clone(),
            floor: &self.floor,
            reaction: &[],
            base: &[],
            theory: &self.wave,
            thickness: self.thickness,
            area: self.strip.length * self.strip.width,
        };
        (objective, &mut self.kkt)
    }

    /// Strain at which the layers no longer lie flat, to a five-hundredth of it.
    ///
    /// # Panics
    /// When it does not lie between `low` and `high`.
    pub fn onset(&mut self, mut low: f64, mut high: f64) -> f64 {
        let mut is_flat = |strain: f64| {
            self.lay_down(strain);
            let x = gather(&self.free, &self.positions);
            let (objective, kkt) = self.objective();
            let inertia = inertia_at(&objective, &x, kkt).expect("factorisable");
            inertia.is_minimum()
        };
        assert!(
            is_flat(low) && !is_flat(high),
            "no onset in {low} to {high}"
        );
        while high - low > 0.002 * low {
            let middle = 0.5 * (low + high);
            if is_flat(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// Compresses the strip to one strain after another, from small noise.
    pub fn ramp(&mut self, strains: &[f64], seed: u64) -> Vec<StackState> {
        self.lay_down(0.0);
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        for &v in &self.free {
            self.positions[v as usize].z += NOISE * self.thickness * random.random_range(-1.0..1.0);
        }
        let settings = NewtonSettings {
            at_saddle: AtSaddle::Leave,
            seed,
            ..NewtonSettings::default()
        };
        let compress = |&strain: &f64| self.solve(strain, &settings);
        strains.iter().map(compress).collect()
    }

    fn solve(&mut self, strain: f64, settings: &NewtonSettings) -> StackState {
        self.set_strain(strain);
        // Rollers hold y where the base has it.
        let base = gather(&self.free, &self.points);
        let mut held = vec![0.0; self.kkt.rows().count()];
        self.kkt.rows().mul(&base, &mut held).expect("sizes match");
        let mut x = gather(&self.free, &self.positions);
        let (objective, kkt) = self.objective();
        let solve =
            minimise(&objective, &held, &mut x, kkt, settings, &mut |_| true).expect("valid input");
        scatter(&self.free, &x, &mut self.positions);
        self.measure(strain, solve)
    }

    fn measure(&self, strain: f64, solve: SolveReport) -> StackState {
        let count = self.strip.points.len();
        let heights: Vec<f64> = self.positions[..count].iter().map(|x| x.z).collect();
        let [first, last] = [
            REACH * self.wave.wavelength,
            self.strip.length - REACH * self.wave.wavelength,
        ];
        let areas = self.energy.vertex_areas();
        let inside = self
            .strip
            .points
            .iter()
            .map(|p| (first..last).contains(&p.x));
        let (mut total, mut moments) = (0.0, [0.0; 2]);
        for ((w, a), _) in heights
            .iter()
            .zip(areas)
            .zip(inside)
            .filter(|(_, inside)| *inside)
        {
            total += a;
            moments[0] += w * a;
            moments[1] += w * w * a;
        }
        let [mean, square] = moments.map(|m| m / total);
        let amplitude = (2.0 * (square - mean * mean)).sqrt();
        StackState {
            strain,
            solve,
            amplitude,
            wavelength: self.strip.wavelength(&heights, areas, self.wave.wavelength),
            fine: self.fine_heights(amplitude),
        }
    }

    /// Along the lower side of the strip, whose vertices are evenly spaced.
    fn fine_heights(&self, amplitude: f64) -> [f64; 2] {
        let count = self.strip.points.len();
        let Some(upper) = self.positions.get(count..2 * count) else {
            return [0.0; 2];
        };
        let along = (0..count).filter(|&v| self.strip.points[v].y < 1e-9);
        let line: Vec<[f64; 2]> = along
            .map(|v| [self.positions[v].z, upper[v].z - self.positions[v].z])
            .collect();
        let width = (self.fine * line.len() as f64 / self.strip.length).round() as usize;
        let (mut squares, mut samples) = ([0.0; 2], [0.0; 2]);
        for window in line.windows(width) {
            let mean = window.iter().map(|[_, above]| above).sum::<f64>() / width as f64;
            let [below, above] = window[width / 2];
            let part = match below / amplitude {
                height if height > TOP => 0,
                height if height < -TOP => 1,
                _ => continue,
            };
            squares[part] += (above - mean).powi(2);
            samples[part] += 1.0;
        }
        [0, 1].map(|part| (squares[part] / f64::max(samples[part], 1.0)).sqrt())
    }
}

/// Where the layers are that lie flat on `points`.
fn lifted(points: &[Vector3<f64>], lever: Option<f64>) -> Vec<Vector3<f64>> {
    let above = lever
        .iter()
        .flat_map(|t| points.iter().map(move |p| p + Vector3::z() * *t));
    points.iter().copied().chain(above).collect()
}

/// Equal heights across the strip, in every other row of vertices: what is so narrow would else
/// bend across as it likes, and turn about its length where springs push it away from the base, as
/// those of a composite do.
fn level(strip: &Strip, free: &[u32]) -> Vec<Row> {
    let step = 2.0 * strip.width / ROWS as f64;
    let tolerance = 1e-9 * strip.length;
    let row = |j: usize| {
        let y = j as f64 * step;
        let is_on = move |v: &u32| (strip.points[*v as usize].y - y).abs() < tolerance;
        let vertices = free.iter().enumerate().filter(move |(_, v)| is_on(v));
        vertices.map(|(unknown, _)| unknown)
    };
    // All have the same vertices, in the same order.
    let pairs = (1..=ROWS / 2).flat_map(|j| row(j - 1).zip(row(j)));
    pairs
        .map(|(a, b)| vec![(3 * a + 2, 1.0), (3 * b + 2, -1.0)])
        .collect()
}

fn joint(strip: &Strip, rest: &[Vector3<f64>], pair: &StackPair, lever: f64) -> LayerEnergy {
    let [below, above] = [&pair.lower, &pair.upper].map(|of| (&of.material, &of.wrinkling));
    let upper = UpperSheet {
        rest_positions: rest.iter().map(|p| p + Vector3::z() * lever).collect(),
        parameters: parameters(strip, above, pair.shear_tie()),
        levers: vec![lever; rest.len()],
    };
    let lower = parameters(strip, below, below.1.tangential_stiffness);
    shell(strip, rest, lower, Some(upper))
}

/// What a layer of the strip is made of, with its springs to what is below.
fn parameters(
    strip: &Strip,
    (material, springs): (&LayerMaterial, &Wrinkling),
    tie: f64,
) -> LayerParameters {
    let face = FaceParameters {
        young: material.young,
        poisson: material.poisson,
        thickness: material.thickness,
        normal_stiffness: springs.normal_stiffness,
        gradient_stiffness: springs.gradient_stiffness,
    };
    LayerParameters::uniform(face, strip.faces.len(), tie, strip.points.len())
}

fn shell(
    strip: &Strip,
    rest: &[Vector3<f64>],
    parameters: LayerParameters,
    upper: Option<UpperSheet>,
) -> LayerEnergy {
    let (ends, bending) = (strip.ends(), BendingModel::VertexCurvature);
    let energy = match upper {
        Some(upper) => {
            LayerEnergy::pair((&strip.topology(), rest, &ends), parameters, upper, bending)
        }
        None => LayerEnergy::with_bending(&strip.topology(), rest, parameters, &ends, bending),
    };
    energy.expect("a valid layer")
}
