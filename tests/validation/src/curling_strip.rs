//! The product's curl of a free strip that bends by itself, beside theory: a cylinder of its natural curvature.

use std::error::Error;

use nalgebra::{Matrix2, Vector2, Vector3};
use ruga_mesh::TriMesh;
use ruga_shell::{BendingModel, FaceParameters, LayerEnergy, LayerParameters};
use ruga_solver::{ConstraintRows, Kkt, LowerPattern, NewtonSettings, Objective, minimise};

use crate::{Rectangle, Strip, cpu_seconds};

/// Length of the strip (m); its width is a tenth.
pub const LENGTH: f64 = 1.0;

/// Width of the strip (m).
pub const WIDTH: f64 = 0.1;

/// Angle by which the strip turns more from load to load (rad). Half or twice as much takes a quarter more steps.
const TURN: f64 = 0.42;

/// How a strip came to rest, load by load: its natural curvature grows in equal parts.
#[derive(Clone, Debug)]
pub struct StripCurl {
    /// Triangles of its mesh.
    pub faces: usize,
    /// Curvature along the strip, mean over its length, over the natural one at full load: after each load.
    pub curls: Vec<f64>,
    /// Processor seconds of setting up and solving, meshing left out: after each load.
    pub seconds: Vec<f64>,
    /// Newton steps, over all loads.
    pub steps: usize,
    /// Whether the solver converged at every load.
    pub converged: bool,
    /// Triangles too large for the natural curvature.
    pub capped: usize,
}

impl StripCurl {
    /// Curvature at full load over the natural one.
    pub fn curl(&self) -> f64 {
        self.curls.last().copied().unwrap_or(f64::NAN)
    }

    /// Processor seconds of everything.
    pub fn total_seconds(&self) -> f64 {
        self.seconds.last().copied().unwrap_or(f64::NAN)
    }
}

/// Lets a flat strip of so many triangles across go to its natural `curvature` (1/m) along x.
///
/// # Errors
/// What shell and solver refuse: a curvature that is no number or zero, a thickness (m) that is not positive.
pub fn curling_strip(
    across: usize,
    curvature: f64,
    thickness: f64,
) -> Result<StripCurl, Box<dyn Error>> {
    let rectangle = Rectangle {
        length: LENGTH,
        width: WIDTH,
        radius: None,
    };
    let mesh = rectangle.meshed(WIDTH / across.max(1) as f64);
    let strip = Strip::of(&mesh, &rectangle);
    let rest: Vec<Vector3<f64>> = strip.points.iter().map(|p| p.push(0.0)).collect();
    let topology = strip.topology();
    let face = FaceParameters {
        young: 1e9,
        poisson: 0.3,
        thickness,
        normal_stiffness: 0.0,
        gradient_stiffness: 0.0,
    };

    let start = cpu_seconds();
    let layer = free_layer(&topology, &rest, face)?;
    let (starts, rows) = layer.pattern();
    let mut sheet = FreeSheet {
        pattern: LowerPattern::new(starts, rows)?,
        energy: face.bending_modulus() * curvature * curvature * LENGTH * WIDTH,
        edge: WIDTH / across.max(1) as f64,
        layer,
    };
    let held = held(&strip);
    let mut x: Vec<f64> = rest.iter().flatten().copied().collect();
    let targets: Vec<f64> = held.iter().map(|&i| x[i]).collect();
    let rows = ConstraintRows::new((0..=6).collect(), held, vec![1.0; 6], x.len())?;
    let mut kkt = Kkt::new(&sheet.pattern, &rows, 3)?;
    let settings = NewtonSettings::default();
    let mut found = StripCurl {
        faces: strip.faces.len(),
        curls: Vec::new(),
        seconds: Vec::new(),
        steps: 0,
        converged: true,
        capped: 0,
    };
    let loads = (curvature.abs() * LENGTH / TURN).ceil().max(1.0);
    let mut before = x.clone();
    for load in 1..=loads as usize {
        found.capped = sheet.bend(&strip, curvature * load as f64 / loads)?;
        // From where the last two loads point to; from the last state alone, thin strips take five times the steps.
        let ahead: Vec<f64> = x.iter().zip(&before).map(|(x, b)| 2.0 * x - b).collect();
        before = std::mem::replace(&mut x, ahead);
        let report = minimise(&sheet, &targets, &mut x, &mut kkt, &settings, &mut |_| true)?;
        found.steps += report.iterations;
        found.converged &= report.converged;
        found.seconds.push(cpu_seconds() - start);
        let reached = mean_curvature(&strip, &positions(&x));
        found.curls.push(reached / curvature);
    }
    Ok(found)
}

/// Three coordinates of a corner of a face in the middle, two of the next and one of the last: as many as a rigid body
/// has. Held at an end, the other end would have twice as far to go.
fn held(strip: &Strip) -> Vec<usize> {
    let middle = Vector2::new(0.5 * LENGTH, 0.5 * WIDTH);
    let far = |face: &&[u32; 3]| (strip.points[face[0] as usize] - middle).norm();
    let nearest = strip.faces.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
    let [a, b, c] = nearest.copied().unwrap_or_default().map(|v| v as usize);
    let edge = strip.points[b] - strip.points[a];
    let turn = 3 * b + usize::from(edge.x.abs() > edge.y.abs());
    vec![3 * a, 3 * a + 1, 3 * a + 2, turn, 3 * b + 2, 3 * c + 2]
}

/// A sheet of one material that nothing holds.
fn free_layer(
    mesh: &TriMesh,
    rest: &[Vector3<f64>],
    face: FaceParameters,
) -> Result<LayerEnergy, Box<dyn Error>> {
    let parameters = LayerParameters::uniform(face, mesh.face_count(), 0.0, rest.len());
    let free = vec![false; rest.len()];
    let model = BendingModel::VertexCurvature;
    Ok(LayerEnergy::with_bending(
        mesh, rest, parameters, &free, model,
    )?)
}

fn positions(x: &[f64]) -> Vec<Vector3<f64>> {
    x.chunks_exact(3).map(Vector3::from_column_slice).collect()
}

/// Slope of the angle of faces against where they are along the strip, least squares: crest-positive.
///
/// A parabola through the strip would be off by more than the product once it has rolled up.
fn mean_curvature(strip: &Strip, x: &[Vector3<f64>]) -> f64 {
    let mut angles: Vec<[f64; 2]> = Vec::with_capacity(strip.faces.len());
    for face in &strip.faces {
        let [a, b, c] = face.map(|v| strip.points[v as usize]);
        let [p, q, r] = face.map(|v| x[v as usize]);
        let (u, v) = (b - a, c - a);
        // The direction of x at rest, now.
        let along = ((q - p) * v.y - (r - p) * u.y) / u.perp(&v);
        angles.push([(a.x + b.x + c.x) / 3.0, (-along.z).atan2(along.x)]);
    }
    angles.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for i in 1..angles.len() {
        let turns = (angles[i][1] - angles[i - 1][1]) / std::f64::consts::TAU;
        angles[i][1] -= std::f64::consts::TAU * turns.round();
    }
    let count = angles.len().max(1) as f64;
    let means = [0, 1].map(|k| angles.iter().map(|own| own[k]).sum::<f64>() / count);
    let (mut across, mut square) = (0.0, 0.0);
    for [at, angle] in angles {
        across += (at - means[0]) * (angle - means[1]);
        square += (at - means[0]).powi(2);
    }
    across / square
}

/// Energy of a sheet of which every vertex is an unknown.
struct FreeSheet {
    layer: LayerEnergy,
    pattern: LowerPattern,
    /// What flattening the cylinder takes (J), twice.
    energy: f64,
    edge: f64,
}

impl FreeSheet {
    /// Gives all faces a natural curvature (1/m) along x; says how many are too large for it.
    fn bend(&mut self, strip: &Strip, curvature: f64) -> Result<usize, Box<dyn Error>> {
        let tensors = strip.faces.iter().map(|own| {
            let [a, b] = [own[0], own[1]].map(|v| strip.points[v as usize]);
            let along = (b - a).normalize();
            let frame = Matrix2::from_columns(&[along, Vector2::new(-along.y, along.x)]);
            frame.transpose() * Matrix2::new(curvature, 0.0, 0.0, 0.0) * frame
        });
        let tensors: Vec<_> = tensors.collect();
        Ok(self.layer.set_natural_curvatures(&tensors)?)
    }
}

impl Objective for FreeSheet {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, x: &[f64]) -> f64 {
        self.layer.value(&positions(x))
    }

    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let positions = positions(x);
        self.layer.gradient(&positions, gradient);
        self.layer.value(&positions)
    }

    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        self.layer.hessian(&positions(x), exact, Some(relaxed));
    }

    fn energy_scale(&self) -> f64 {
        self.energy
    }

    fn force_scale(&self) -> f64 {
        self.energy / self.edge
    }

    fn length_scale(&self) -> f64 {
        self.edge
    }
}
