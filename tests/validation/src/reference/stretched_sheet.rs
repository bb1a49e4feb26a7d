//! A sheet that is pulled at two clamped ends and wrinkles along the pull, on no foundation.
//!
//! What the pull makes of the sheet, of length `L` and tension `T` per width, is a foundation
//! against waves across it, `K = T (pi/L)^2`; with the bending stiffness `B` their length is
//! `2 pi (B/K)^(1/4) = 2 sqrt(pi) (B/T)^(1/4) L^(1/2)` (Cerda and Mahadevan 2003).

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_material::LayerMaterial;
use ruga_shell::{FaceParameters, LayerEnergy, LayerParameters};
use ruga_solver::{
    ConstraintRows, Kkt, LowerPattern, NewtonSettings, Objective, SolveReport, minimise,
};

use crate::sheet::{gather, scatter};
use crate::{Strip, equilateral};

/// A sheet, twice as finely meshed across as along: wrinkles run along.
pub struct StretchedSheet {
    material: LayerMaterial,
    strip: Strip,
    energy: LayerEnergy,
    pattern: LowerPattern,
    positions: Vec<Vector3<f64>>,
    damping: Vec<f64>,
    stretch: f64,
}

/// A wrinkled sheet.
#[derive(Clone, Debug)]
pub struct SheetState {
    /// `2 pi sqrt(int w^2 / int w_y^2)`, in rest coordinates, m; squares as in [`square`].
    pub wavelength: f64,
    /// The same along the pull, twice the length of the wrinkles; Cerda and Mahadevan set it to
    /// `2 L`, m.
    pub lengthwise: f64,
    /// Largest height, m.
    pub height: f64,
    /// How the solve went.
    pub solve: SolveReport,
}

/// Length of an edge along the pull over that of an equilateral triangle as high: at 2 the hinges
/// across the wrinkles still bend as the plate does, because they lie along an edge.
const ASPECT: f64 = 2.0;

impl StretchedSheet {
    /// A flat sheet of given length and width (m) with so many rows of triangles across.
    pub fn new(material: &LayerMaterial, extent: [f64; 2], rows: usize) -> Self {
        let height = extent[1] / rows as f64;
        let columns = (extent[0] / (ASPECT * height / 0.75_f64.sqrt())).round() as usize;
        let edge = height / 0.75_f64.sqrt();
        let mut strip = equilateral(columns as f64 * edge, columns, rows);
        let share = extent[0] / strip.length;
        for p in &mut strip.points {
            p.x *= share;
        }
        strip.length = extent[0];
        let rest: Vec<_> = strip.points.iter().map(|p| p.push(0.0)).collect();
        let face = FaceParameters {
            young: material.young,
            poisson: material.poisson,
            thickness: material.thickness,
            normal_stiffness: 0.0,
            gradient_stiffness: 0.0,
        };
        let parameters = LayerParameters::uniform(face, strip.faces.len(), 0.0, rest.len());
        let energy =
            LayerEnergy::new(&strip.topology(), &rest, parameters, &strip.ends()).expect("a sheet");
        let (starts, entries) = energy.pattern();
        let pattern =
            LowerPattern::new(starts.to_vec(), entries.to_vec()).expect("a valid pattern");
        Self {
            material: *material,
            strip,
            damping: vec![0.0; energy.dof_count()],
            energy,
            pattern,
            positions: rest,
            stretch: 0.0,
        }
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Wavelength of Cerda and Mahadevan at a nominal stretch, of wrinkles that are `length` long, m.
    pub fn theory(&self, stretch: f64, length: f64) -> f64 {
        let tension = self.material.young * self.material.thickness * stretch;
        2.0 * PI.sqrt() * (self.material.bending_stiffness() / tension).powf(0.25) * length.sqrt()
    }

    /// Pulls the flat sheet by a share of its length, disturbs it by a hundredth of its thickness,
    /// and lets it wrinkle.
    pub fn wrinkle(&mut self, stretch: f64, seed: u64) -> SheetState {
        self.stretch = stretch;
        let nu = self.material.poisson;
        let middle = 0.5 * self.strip.width;
        let ends = self.strip.ends();
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        for (x, (p, is_end)) in self
            .positions
            .iter_mut()
            .zip(self.strip.points.iter().zip(ends))
        {
            let narrowed = if is_end { 0.0 } else { nu * stretch };
            let height: f64 = random.random_range(-1e-2..1e-2);
            *x = Vector3::new(
                p.x * (1.0 + stretch),
                p.y - (p.y - middle) * narrowed,
                if is_end {
                    0.0
                } else {
                    height * self.material.thickness
                },
            );
        }
        self.set_floor();
        let free = self.energy.free_vertices().to_vec();
        let mut x = gather(&free, &self.positions);
        let rows = ConstraintRows::none(x.len());
        let mut kkt = Kkt::new(&self.pattern, &rows, 3).expect("a valid system");
        let settings = NewtonSettings {
            seed,
            ..NewtonSettings::default()
        };
        let solve =
            minimise(self, &[], &mut x, &mut kkt, &settings, &mut |_| true).expect("valid input");
        scatter(&free, &x, &mut self.positions);
        self.measure(solve)
    }

    /// Heights of all vertices, with their rest coordinates, m.
    pub fn heights(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        let pairs = self.strip.points.iter().zip(&self.positions);
        pairs.map(|(p, x)| p.push(x.z))
    }

    /// A millionth of what the pull holds the sheet with.
    fn set_floor(&mut self) {
        let spring = self.foundation();
        let areas = self.energy.vertex_areas();
        self.damping = self
            .energy
            .free_vertices()
            .iter()
            .flat_map(|&v| [1e-6 * spring * areas[v as usize]; 3])
            .collect();
    }

    /// `T (pi/L)^2`, Pa/m.
    fn foundation(&self) -> f64 {
        let tension = self.material.young * self.material.thickness * self.stretch;
        tension * (PI / self.strip.length).powi(2)
    }

    fn measure(&self, solve: SolveReport) -> SheetState {
        let (mut squares, mut slopes) = (0.0, [0.0; 2]);
        for face in &self.strip.faces {
            let p = face.map(|v| self.strip.points[v as usize]);
            let [a, b, c] = face.map(|v| self.positions[v as usize].z);
            let (s, t) = (p[1] - p[0], p[2] - p[0]);
            let twice_area = s.perp(&t);
            let across = (s.x * (c - a) - t.x * (b - a)) / twice_area;
            let along = (t.y * (b - a) - s.y * (c - a)) / twice_area;
            squares += twice_area * square(a, b, c);
            slopes[0] += twice_area * across * across;
            slopes[1] += twice_area * along * along;
        }
        let height = |x: &Vector3<f64>| x.z.abs();
        SheetState {
            wavelength: TAU * (squares / slopes[0]).sqrt(),
            lengthwise: TAU * (squares / slopes[1]).sqrt(),
            height: self.positions.iter().map(height).fold(0.0, f64::max),
            solve,
        }
    }

    fn all(&self, x: &[f64]) -> Vec<Vector3<f64>> {
        let mut positions = self.positions.clone();
        scatter(self.energy.free_vertices(), x, &mut positions);
        positions
    }
}

/// Mean square of heights over a triangle, half lumped and half consistent.
///
/// The slopes of a linear interpolant and these squares are short of a wave's by the same share;
/// consistent squares alone make a wave of 8 points 2.5 % shorter than it is.
pub fn square(a: f64, b: f64, c: f64) -> f64 {
    let own = a * a + b * b + c * c;
    0.5 * (((a + b + c).powi(2) + own) / 12.0 + own / 3.0)
}

impl Objective for StretchedSheet {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, x: &[f64]) -> f64 {
        self.energy.value(&self.all(x))
    }

    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let positions = self.all(x);
        self.energy.gradient(&positions, gradient);
        self.energy.value(&positions)
    }

    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        self.energy.hessian(&self.all(x), exact, Some(relaxed));
    }

    fn damping(&self) -> &[f64] {
        &self.damping
    }

    /// That of a film on the foundation which the pull makes, `C/2 (2 sqrt(B K)/C)^2`.
    fn energy_scale(&self) -> f64 {
        let force = 2.0 * (self.material.bending_stiffness() * self.foundation()).sqrt();
        0.5 * force * force / self.material.membrane_stiffness()
            * self.strip.length
            * self.strip.width
    }

    fn force_scale(&self) -> f64 {
        let share = self.strip.length * self.strip.width / self.positions.len() as f64;
        self.foundation() * self.material.thickness * share
    }

    fn length_scale(&self) -> f64 {
        self.material.thickness
    }
}
