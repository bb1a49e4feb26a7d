//! A flat patch of skin that a blend shape compresses to three critical strains in its middle and
//! not at all at its ends, through the product's own planner and stepper: what a user waits for.
//!
//! Nobody knows its wrinkles exactly; they are compared with those of a finer mesh.

use std::f64::consts::PI;
use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BlendShape, Driver};
use ruga_material::WavelengthModel;
use ruga_mesh::{Id, PerFace, PlanarLookup};
use ruga_stepper::{
    Coupling as Held, EdgeLimits, LayerSpec, LayerSurface, Modelling, Observer, PoseSpec, Presence,
    Progress, plan,
};
use ruga_validation::FilmSpec;

use crate::cpu_time::cpu_seconds;
use crate::results::Measure;
use crate::setting::{Coupling, Outcome, PatchShape, Run};

const RATIO: f64 = 150.0;
/// Extent in wavelengths.
const WAVES: [f64; 2] = [8.0, 3.0];
/// Compression in the middle, in critical strains.
const PEAK: f64 = 3.0;
/// Load steps to full weight.
const STEPS: u32 = 6;
/// Squares of the artist's mesh.
const SQUARES: [usize; 2] = [32, 12];
/// Texels of the map that the plan is for.
const TEXELS: u32 = 1024;

/// Extent in wavelengths, about the middle, of what is compared, and samples along it and across.
const COMPARED: [f64; 2] = [4.0, 1.0];
const SAMPLES: [usize; 2] = [128, 8];

/// Runs it and measures; without a reference it becomes one.
pub(crate) fn measure(request: &Run, reference: Option<&PatchShape>) -> Outcome {
    let spec = FilmSpec::flat(RATIO);
    let wavelength = spec.theory().wavelength;
    let driver = driver(
        WAVES.map(|waves| waves * wavelength),
        PEAK * spec.theory().critical_strain,
    );
    let pose = PoseSpec {
        name: "compress".to_owned(),
        weights: driver.weights([("compress", 1.0)]).expect("its only shape"),
        keys: vec![1.0],
        steps: STEPS,
        motions: Vec::new(),
    };
    let (layers, modelling) = ([layer(&spec, request)], modelling(request));
    let start = cpu_seconds();
    let mut watch = Watch {
        end: start + request.limit_s,
    };
    let poses = std::slice::from_ref(&pose);
    let result = plan(&driver, &layers, poses, &modelling, TEXELS)
        .and_then(|plan| plan.simulate(0, &mut watch));
    let cpu_s = cpu_seconds() - start;
    let result = match result {
        Ok(result) => result,
        Err(error) => return Outcome::failed(error.to_string()),
    };
    let report = &result.layers[0];
    let mut outcome = Outcome {
        failure: match (result.interrupted, result.converged) {
            (true, _) => Some("time limit".to_owned()),
            (_, false) => Some("did not converge".to_owned()),
            _ => None,
        },
        cpu_s,
        frames: STEPS as usize,
        vertices: report.vertices,
        rows: report.constraints,
        newton_iterations: report.newton_iterations,
        ..Outcome::default()
    };
    let surface = result.keys.last().and_then(|key| key.layers.last());
    let (Some(surface), Some(found)) = (surface, report.wavelength) else {
        outcome.failure = outcome.failure.or(Some("stayed flat".to_owned()));
        return outcome;
    };
    let shape = PatchShape {
        wavelength: found,
        amplitude: report.amplitude,
        lines: lines(surface, wavelength),
    };
    match reference {
        Some(reference) => compare(&shape, reference, &mut outcome),
        None => outcome.shape = Some(shape),
    }
    outcome
}

/// Stops a run that takes too long.
struct Watch {
    end: f64,
}

impl Observer for Watch {
    fn progress(&mut self, _: Progress) -> bool {
        cpu_seconds() < self.end
    }

    fn wants_frames(&self) -> bool {
        false
    }
}

fn layer(spec: &FilmSpec, request: &Run) -> LayerSpec {
    LayerSpec {
        name: "film".to_owned(),
        material: spec.film,
        substrate: spec.substrate,
        model: WavelengthModel::HalfSpace,
        coupling: match request.setting.method.coupling {
            Coupling::Constraint => Held::Constraint,
            Coupling::Elastic => Held::Elastic,
            Coupling::Hybrid => Held::Hybrid,
        },
        sampling: request.setting.method.sampling.kind(),
        map: None,
        sharp: false,
        bending_transfer: None,
        variation: None,
        presence: Presence::default(),
    }
}

fn modelling(request: &Run) -> Modelling {
    let method = request.setting.method;
    Modelling {
        points_per_wavelength: f64::from(request.setting.points),
        remesh: method.aspect().map(|aspect| EdgeLimits {
            aspect,
            ..EdgeLimits::default()
        }),
        bending: method.bending.model(),
        minimise: method.solver.minimise(),
        seed: request.seed,
        ..Modelling::default()
    }
}

/// A rectangle about the origin, shrunk along x by `peak` in the middle and not at all at the ends.
fn driver([length, width]: [f64; 2], peak: f64) -> Arc<Driver> {
    let [columns, rows] = SQUARES;
    let uv = |i: usize, j: usize| Vector2::new(i as f64 / columns as f64, j as f64 / rows as f64);
    let uvs: Vec<_> = (0..=rows)
        .flat_map(|j| (0..=columns).map(move |i| uv(i, j)))
        .collect();
    let place = |uv: &Vector2<f64>| Vector3::new((uv.x - 0.5) * length, (uv.y - 0.5) * width, 0.0);
    let positions: Vec<_> = uvs.iter().map(place).collect();
    // The integral of -peak (1 + cos(2 pi x / length)) / 2.
    let moved = |p: &Vector3<f64>| {
        let wave = length / (2.0 * PI) * (2.0 * PI * p.x / length).sin();
        Vector3::new(-0.5 * peak * (p.x + wave), 0.0, 0.0)
    };
    let vertex = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
    let square = |i: usize, j: usize| {
        let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(k, l)| vertex(i + k, j + l));
        match (i + j) % 2 {
            0 => [[a, b, c], [a, c, d]],
            _ => [[a, b, d], [b, c, d]],
        }
    };
    let triangles = (0..rows).flat_map(|j| (0..columns).flat_map(move |i| square(i, j)));
    let artist = ArtistMesh {
        name: "patch".to_owned(),
        shapes: vec![BlendShape {
            name: "compress".to_owned(),
            position_deltas: positions.iter().map(moved).collect(),
            normal_deltas: None,
        }],
        triangles: triangles.collect(),
        positions,
        normals: None,
        uvs: Some(uvs),
    };
    Arc::new(Driver::new(&artist).expect("a rectangle"))
}

/// Smooth normals along lines across the wrinkles, as a normal map has them, in the plane of the
/// posed driver.
fn lines(surface: &LayerSurface, wavelength: f64) -> Vec<Vec<f64>> {
    let posed = &surface.driver_positions;
    let triangles = surface
        .faces
        .iter()
        .map(|face| face.map(|v| posed[v as usize].xy()));
    let lookup = PlanarLookup::new(triangles.collect::<PerFace<_>>());
    let mut normals = vec![Vector3::zeros(); posed.len()];
    for face in &surface.faces {
        let [a, b, c] = face.map(|v| surface.positions[v as usize]);
        for v in face {
            normals[*v as usize] += (b - a).cross(&(c - a));
        }
    }
    let normal = |place: Vector2<f64>| {
        let point = lookup.locate(place).expect("a place of the patch");
        let face = surface.faces[point.face.index()];
        let terms = face.iter().zip(point.barycentric);
        let sum: Vector3<f64> = terms
            .map(|(v, b)| normals[*v as usize].normalize() * b)
            .sum();
        sum.normalize()
    };
    let [columns, rows] = SAMPLES;
    let at = |i: usize, count: usize, extent: f64| {
        ((i as f64 + 0.5) / count as f64 - 0.5) * extent * wavelength
    };
    let line = |j: usize| {
        let places = (0..columns)
            .map(|i| Vector2::new(at(i, columns, COMPARED[0]), at(j, rows, COMPARED[1])));
        // Four digits are a hundredth of a degree.
        let round = |value: f64| (1e4 * value).round() * 1e-4;
        places
            .map(normal)
            .flat_map(|n| [round(n.x), round(n.y)])
            .collect()
    };
    (0..rows).map(line).collect()
}

fn compare(shape: &PatchShape, reference: &PatchShape, outcome: &mut Outcome) {
    let errors = &mut outcome.errors;
    errors.insert(
        Measure::PatchWavelength,
        shape.wavelength / reference.wavelength - 1.0,
    );
    errors.insert(
        Measure::PatchAmplitude,
        shape.amplitude / reference.amplitude - 1.0,
    );
    let pairs = shape.lines.iter().zip(&reference.lines);
    let squares: Vec<f64> = pairs
        .map(|(line, wanted)| best_shift(line, wanted))
        .collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    errors.insert(Measure::PatchNormals, mean.sqrt());
}

/// Mean squared angle (degrees) between two lines of normals, one of them shifted as suits it best,
/// by half a wave either way: phase is arbitrary.
fn best_shift(line: &[f64], wanted: &[f64]) -> f64 {
    let count = line.len() / 2;
    let normal = |line: &[f64], i: usize| {
        let [x, y] = [line[2 * i], line[2 * i + 1]];
        Vector3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
    };
    let reach = 0.5 * count as f64 / COMPARED[0];
    let squared = |shift: f64| {
        let (mut sum, mut terms) = (0.0, 0.0);
        for i in 0..count {
            let place = i as f64 + shift;
            if place < 0.0 || place >= (count - 1) as f64 {
                continue;
            }
            let (low, share) = (place as usize, place.fract());
            let shifted = normal(line, low) * (1.0 - share) + normal(line, low + 1) * share;
            sum += shifted.angle(&normal(wanted, i)).to_degrees().powi(2);
            terms += 1.0;
        }
        sum / terms
    };
    let steps = (10.0 * reach) as i32;
    let shifts = (-steps..=steps).map(|step| 0.1 * f64::from(step));
    shifts.map(squared).fold(f64::INFINITY, f64::min)
}
