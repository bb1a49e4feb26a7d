//! A slab of soft stuff with a skin on its top, held by slices across x.

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, Driver, Smoothing};
use ruga_constraint::SampleConstraints;
use ruga_material::{
    LayerMaterial, MaterialError, Substrate, WavelengthModel, Wrinkling, wrinkling,
};
use ruga_solver::{Minimise, minimise};
use ruga_stepper::{
    Body, CellShape, ComputedMesh, Coupling, EdgeLimits, Handle, Keyframe, LayerReport, LayerSpec,
    Mask, Modelling, Motion, Observer, PoseSpec, Presence, Region, Sampling, Silent, SolidMaterial,
    plan_body,
};

use super::Sheet;

/// Poisson ratio of skin and inside; with the same of both only the ratio of their moduli matters.
const POISSON: f64 = 0.4;

/// Squares of the artist's mesh over the height, where nothing is measured.
const SQUARES_DOWN: usize = 4;

/// Load steps; the simulator adds its own where the skin buckles.
const STEPS: u32 = 2;

/// A slab from the origin to `size`, its skin on the side of largest z.
#[derive(Clone, Debug)]
pub struct Slab {
    /// m.
    pub size: Vector3<f64>,
    /// Lattice cells along x.
    pub cells: u32,
    /// The lattice's elements.
    pub shape: CellShape,
    /// Young's modulus of the inside, Pa.
    pub young: f64,
    /// The skin's over that of the inside.
    pub ratio: f64,
    /// Of the skin, m.
    pub thickness: f64,
    /// How the two hold together.
    pub coupling: Coupling,
    /// What samples the rows of that.
    pub sample: SampleConstraints,
    /// Edges of the skin's mesh per wavelength.
    pub points: f64,
    /// Whether the skin's mesh is fitted, or the grid that results are handed out on.
    pub is_fitted: bool,
    /// Slices that are held: name, and x from and to, m. Those of the cells whose centre is inside
    /// move.
    pub slices: Vec<(&'static str, [f64; 2])>,
}

/// A slab after its motion.
#[derive(Clone, Debug)]
pub struct SlabRun {
    /// The skin at every key that was reached.
    pub sheets: Vec<Sheet>,
    /// What the simulator measured at the last one.
    pub report: LayerReport,
    /// Whether every step found its equilibrium.
    pub converged: bool,
    /// What the simulator warned of.
    pub warnings: Vec<String>,
    /// Time that it took, s.
    pub seconds: f64,
    /// The mesh of the skin, where it ended.
    pub cover: ComputedMesh,
}

/// What a coupling is called in tables.
pub fn coupling_name(coupling: Coupling) -> &'static str {
    match coupling {
        Coupling::Constraint => "hard rows",
        Coupling::Elastic => "elastic",
        Coupling::Hybrid => "hybrid",
    }
}

impl Slab {
    /// The skin, and the inside as it sees it.
    pub fn materials(&self) -> (LayerMaterial, Substrate) {
        let skin = LayerMaterial {
            young: self.ratio * self.young,
            poisson: POISSON,
            thickness: self.thickness,
            density: 1000.0,
        };
        let inside = Substrate {
            young: self.young,
            poisson: POISSON,
            thickness: self.size.z,
        };
        (skin, inside)
    }

    /// Theory's numbers for the skin.
    ///
    /// # Errors
    /// Impossible materials.
    pub fn theory(&self) -> Result<Wrinkling, MaterialError> {
        let (skin, inside) = self.materials();
        wrinkling(&skin, &inside, WavelengthModel::HalfSpace)
    }

    /// From rest to where the motions end, by way of `keys`, the loads at which the skin is looked
    /// at.
    ///
    /// # Errors
    /// Whatever the simulator refuses.
    pub fn simulate(&self, motions: Vec<Motion>, keys: &[f64]) -> Result<SlabRun, Box<dyn Error>> {
        self.simulate_by(minimise, motions, (keys, STEPS))
    }

    /// [`simulate`](Self::simulate) by another method, in so many load steps.
    ///
    /// # Errors
    /// Whatever the simulator refuses.
    pub fn simulate_by(
        &self,
        minimise: Minimise,
        motions: Vec<Motion>,
        (keys, steps): (&[f64], u32),
    ) -> Result<SlabRun, Box<dyn Error>> {
        self.simulate_before(minimise, motions, (keys, steps), &mut Silent)
    }

    /// The same before the eyes of somebody, who may want every load step as a result.
    pub(super) fn simulate_before(
        &self,
        minimise: Minimise,
        motions: Vec<Motion>,
        (keys, steps): (&[f64], u32),
        observer: &mut dyn Observer,
    ) -> Result<SlabRun, Box<dyn Error>> {
        let start = Instant::now();
        let driver = self.driver()?;
        let modelling = Modelling {
            minimise,
            ..self.modelling()
        };
        let pose = PoseSpec {
            name: "pose".into(),
            weights: Default::default(),
            keys: keys.to_vec(),
            steps,
            motions,
            growths: Vec::new(),
            half: false,
        };
        let layer = skin_of(self.materials(), self.coupling);
        let plan = plan_body(&driver, &[layer], &self.body(), &[pose], &modelling, 1024)?;
        let result = plan.simulate(0, observer)?;
        let missing = || format!("no result: {}", result.warnings.join("; "));
        let report = result.layers.first().ok_or_else(missing)?;
        if result.keys.len() < keys.len() {
            return Err(missing().into());
        }
        let layers = result.keys.iter().flat_map(|key| &key.layers);
        Ok(SlabRun {
            sheets: layers
                .clone()
                .map(|layer| Sheet::new(layer, [self.size.x, self.size.y]))
                .collect(),
            report: report.clone(),
            converged: result.converged,
            warnings: result.warnings,
            seconds: start.elapsed().as_secs_f64(),
            cover: (layers.last())
                .map_or_else(ComputedMesh::default, |layer| layer.computed.clone()),
        })
    }

    pub(super) fn body(&self) -> Body {
        let slice = |(name, [from, to]): &(&str, [f64; 2])| {
            let corners = [[*from, -1.0, -1.0], [*to, 1.0, 1.0]];
            Handle::new(*name, corners.map(Vector3::from))
        };
        Body {
            cells: Some(self.cells),
            shape: self.shape,
            material: SolidMaterial {
                young: self.young,
                poisson: POISSON,
            },
            density: 1000.0,
            gravity: Vector3::zeros(),
            handles: self.slices.iter().map(slice).collect(),
            obstacles: Vec::new(),
            follow: None,
        }
    }

    fn modelling(&self) -> Modelling {
        Modelling {
            points_per_wavelength: self.points,
            sample: self.sample,
            smoothing: Smoothing::None,
            remesh: self.is_fitted.then(EdgeLimits::default),
            // The top has the left half of the texture.
            region: Region::Mask(Mask::new(2, 1, vec![1.0, 0.0]).expect("two pixels")),
            ..Modelling::default()
        }
    }

    /// A box of squares that are as fine as the skin's mesh is asked to be.
    pub(super) fn driver(&self) -> Result<Arc<Driver>, Box<dyn Error>> {
        let edge = self.theory()?.wavelength / self.points;
        let along = |axis: usize| ((self.size[axis] / edge).round() as usize).max(1);
        let squares = [along(0), along(1), SQUARES_DOWN];
        let mut mesh = ArtistMesh::default();
        let mut uvs = Vec::new();
        for axis in 0..3 {
            for is_high in [false, true] {
                self.add_side(&mut mesh, &mut uvs, squares, (axis, is_high));
            }
        }
        mesh.uvs = Some(uvs);
        Ok(Arc::new(Driver::new(&mesh)?))
    }

    fn add_side(
        &self,
        mesh: &mut ArtistMesh,
        uvs: &mut Vec<Vector2<f64>>,
        squares: [usize; 3],
        (axis, is_high): (usize, bool),
    ) {
        let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
        let first = mesh.positions.len() as u32;
        let shift = if axis == 2 && is_high { 0.0 } else { 0.5 };
        for j in 0..=squares[b] {
            for i in 0..=squares[a] {
                let [u, v] = [i as f64 / squares[a] as f64, j as f64 / squares[b] as f64];
                let mut place = Vector3::zeros();
                place[axis] = if is_high { self.size[axis] } else { 0.0 };
                place[a] = u * self.size[a];
                place[b] = v * self.size[b];
                mesh.positions.push(place);
                uvs.push(Vector2::new(0.5 * u + shift, v));
            }
        }
        let at = |i: usize, j: usize| first + (j * (squares[a] + 1) + i) as u32;
        for j in 0..squares[b] {
            for i in 0..squares[a] {
                let [p, q, r, s] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                mesh.triangles.extend(match is_high {
                    true => [[p, q, r], [p, r, s]],
                    false => [[p, r, q], [p, s, r]],
                });
            }
        }
    }
}

/// A skin of these materials, as a half-space sees it.
pub(super) fn skin_of(
    (material, substrate): (LayerMaterial, Substrate),
    coupling: Coupling,
) -> LayerSpec {
    LayerSpec {
        name: "skin".into(),
        material,
        laminate: None,
        substrate,
        model: WavelengthModel::HalfSpace,
        coupling,
        sampling: Sampling::Quadrature,
        map: None,
        sharp: false,
        bending_transfer: None,
        variation: None,
        presence: Presence::default(),
        creases: Vec::new(),
        growths: Vec::new(),
    }
}

/// The slice of this name goes straight by `way` (m) along x.
pub fn push(of: &str, way: f64) -> Motion {
    let frame = Keyframe {
        at: 1.0,
        translation: Vector3::x() * way,
        turn: Vector3::zeros(),
        about: Vector3::zeros(),
    };
    Motion {
        of: of.into(),
        keyframes: vec![frame],
    }
}
