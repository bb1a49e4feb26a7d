//! A narrow strip of two layers, both solved at once or as the composite that stands for them.
//!
//! Ends are pinned and the sides slide, as those of a [`Film`](crate::Film): plane strain, and
//! no border along the wrinkles that would hold them down.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_material::{CompositeLayer, LayerMaterial, StackLayer, StackPair, Wrinkling};
use ruga_shell::{
    BendingModel, FaceParameters, JointEnergy, LayerEnergy, LayerParameters, TieParameters,
};
use ruga_solver::{AtSaddle, Kkt, LowerPattern, NewtonSettings, SolveReport, inertia_at, minimise};
use ruga_stepper::{LayerSpec, Stack};

use crate::film_objective::{FilmObjective, SheetEnergy, gather, scatter};
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
    energy: StackEnergy,
    strip: Strip,
    lever: f64,
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

enum StackEnergy {
    Joint(Box<JointEnergy>),
    Composite(Box<LayerEnergy>),
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
        let energy = match stack {
            Stack::Joint => StackEnergy::joint(&strip, &rest, &pair, lever),
            Stack::Composite => StackEnergy::composite(&strip, &rest, &composite),
            Stack::Nominal => panic!("each layer of a nominal stack has a strip of its own"),
        };
        let free = energy.free_vertices().to_vec();
        let (starts, entries) = energy.pattern();
        let pattern =
            LowerPattern::new(starts.to_vec(), entries.to_vec()).expect("a valid pattern");
        let all = energy.both(&strip);
        let mut rows = side_rollers(&all, &free);
        rows.extend(level(&all, &free));
        let rows = to_constraint_rows(&rows, 3 * free.len());
        let areas = energy.lower().vertex_areas();
        let floor = free
            .iter()
            .flat_map(|&v| [FLOOR * wave.normal_stiffness * areas[v as usize % areas.len()]; 3]);
        let positions = energy.lifted(&rest, lever);
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
        self.energy.set_base(&base, &normals);
        let points = self.energy.lifted(&base, self.lever);
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

    fn objective(&mut self) -> (FilmObjective<'_, StackEnergy>, &mut Kkt) {
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
        let areas = self.energy.lower().vertex_areas();
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

impl StackEnergy {
    fn composite(strip: &Strip, rest: &[Vector3<f64>], composite: &CompositeLayer) -> Self {
        let CompositeLayer {
            material,
            wrinkling,
        } = composite;
        Self::Composite(Box::new(shell(strip, rest, material, Some(wrinkling))))
    }

    fn joint(strip: &Strip, rest: &[Vector3<f64>], pair: &StackPair, lever: f64) -> Self {
        let springs = &pair.upper.wrinkling;
        let tie = TieParameters {
            normal_stiffness: springs.normal_stiffness,
            gradient_stiffness: springs.gradient_stiffness,
            tangential_stiffness: pair.shear_tie(),
        };
        let above: Vec<_> = rest.iter().map(|p| p + Vector3::z() * lever).collect();
        let lower = shell(
            strip,
            rest,
            &pair.lower.material,
            Some(&pair.lower.wrinkling),
        );
        let upper = shell(strip, &above, &pair.upper.material, None);
        let ties = vec![tie; strip.faces.len()];
        let levers = vec![lever; rest.len()];
        let joint = JointEnergy::new(lower, upper, &ties, &levers).expect("equal meshes");
        Self::Joint(Box::new(joint))
    }

    fn lower(&self) -> &LayerEnergy {
        match self {
            Self::Joint(joint) => joint.lower(),
            Self::Composite(layer) => layer,
        }
    }

    /// Where the layers are that lie flat on `points`.
    fn lifted(&self, points: &[Vector3<f64>], lever: f64) -> Vec<Vector3<f64>> {
        let above = points.iter().map(|p| p + Vector3::z() * lever);
        match self {
            Self::Joint(_) => points.iter().copied().chain(above).collect(),
            Self::Composite(_) => points.to_vec(),
        }
    }

    /// The strip with the vertices of all layers.
    fn both(&self, strip: &Strip) -> Strip {
        let mut all = strip.clone();
        if let Self::Joint(_) = self {
            all.points.extend_from_slice(&strip.points);
        }
        all
    }

    fn set_base(&mut self, points: &[Vector3<f64>], normals: &[Vector3<f64>]) {
        let offsets = vec![0.0; points.len()];
        let done = match self {
            Self::Joint(joint) => joint.set_base(points, normals, &offsets),
            Self::Composite(layer) => layer.set_base(points, normals, &offsets),
        };
        done.expect("a valid base");
    }

    fn free_vertices(&self) -> &[u32] {
        match self {
            Self::Joint(joint) => joint.free_vertices(),
            Self::Composite(layer) => layer.free_vertices(),
        }
    }

    fn pattern(&self) -> (&[usize], &[usize]) {
        match self {
            Self::Joint(joint) => joint.pattern(),
            Self::Composite(layer) => layer.pattern(),
        }
    }
}

impl SheetEnergy for StackEnergy {
    fn value(&self, x: &[Vector3<f64>]) -> f64 {
        match self {
            Self::Joint(joint) => joint.value(x),
            Self::Composite(layer) => layer.value(x),
        }
    }

    fn gradient(&self, x: &[Vector3<f64>], gradient: &mut [f64]) {
        match self {
            Self::Joint(joint) => joint.gradient(x, gradient),
            Self::Composite(layer) => layer.gradient(x, gradient),
        }
    }

    fn hessian(&self, x: &[Vector3<f64>], exact: &mut [f64], relaxed: &mut [f64]) {
        match self {
            Self::Joint(joint) => joint.hessian(x, exact, Some(relaxed)),
            Self::Composite(layer) => layer.hessian(x, exact, Some(relaxed)),
        }
    }
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

/// A layer of the strip; `springs` on the base, or none.
fn shell(
    strip: &Strip,
    rest: &[Vector3<f64>],
    material: &LayerMaterial,
    springs: Option<&Wrinkling>,
) -> LayerEnergy {
    let [normal, gradient, tie] = springs.map_or([0.0; 3], |on| {
        [
            on.normal_stiffness,
            on.gradient_stiffness,
            on.tangential_stiffness,
        ]
    });
    let face = FaceParameters {
        young: material.young,
        poisson: material.poisson,
        thickness: material.thickness,
        normal_stiffness: normal,
        gradient_stiffness: gradient,
    };
    let parameters = LayerParameters::uniform(face, strip.faces.len(), tie, rest.len());
    let bending = BendingModel::VertexCurvature;
    LayerEnergy::with_bending(rest, &strip.faces, parameters, &strip.ends(), bending)
        .expect("a valid layer")
}
