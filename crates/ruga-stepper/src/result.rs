//! What a simulated pose gives back.

use std::sync::Arc;

use nalgebra::{Vector2, Vector3};
use ruga_blend::Driver;
use ruga_solver::{SolveReport, StopRule};

use crate::skin::material_places::uv;
use crate::skin::measure::waviness;
use crate::skin::skin_mesh::SkinMesh;
use crate::{BurntSurface, CreaseSpec, LayerPlan, PaintedRanges};

/// A triangle of the file, and barycentric coordinates of three corners in it.
pub type ArtistPlace = (u32, [[f64; 3]; 3]);

/// One layer in one load step, with the smooth driver under each of its vertices.
#[derive(Clone, Debug, Default)]
pub struct LayerSurface {
    /// Name of the layer.
    pub name: String,
    /// Vertex positions, m.
    pub positions: Vec<Vector3<f64>>,
    /// Vertex positions as maps show them (m): every layer's relief by its strength, faded to nothing
    /// at painted borders ([`Presence`](crate::Presence)), where skin is strained to less than half of what
    /// wrinkles it, and where the surface is bent about as sharply as the layer is thick.
    pub relief: Vec<Vector3<f64>>,
    /// The posed driver at the vertices' material points, or the surface of the body there, m.
    pub driver_positions: Vec<Vector3<f64>>,
    /// Unit normals of that surface there.
    pub driver_normals: Vec<Vector3<f64>>,
    /// Distance of the layer from the driver at rest, along the normal, m.
    pub offset: f64,
    /// Triangles. Keys on the same output mesh share this list, `uvs` and `artist`.
    pub faces: Arc<[[u32; 3]]>,
    /// Texture coordinates of the corners of every triangle, V down.
    pub uvs: Arc<[[Vector2<f64>; 3]]>,
    /// For every triangle the file's triangle whose skin it is, and where the texture coordinates of its
    /// corners lie in it; beside an edge of that triangle its barycentric coordinates may leave [0, 1].
    pub artist: Arc<[ArtistPlace]>,
    /// Whether every vertex lies on the plane at which one half of a symmetric pose ends ([`PoseSpec::half`]); empty
    /// where there is no such plane.
    ///
    /// [`PoseSpec::half`]: crate::PoseSpec::half
    pub on_plane: Arc<[bool]>,
    /// Mesh that it was computed on.
    pub computed: ComputedMesh,
    /// State of every triangle, for an observer who wants it
    /// ([`Observer::wants_face_states`](crate::Observer::wants_face_states)).
    pub face_states: Option<Vec<FaceState>>,
    /// Temperature and fuel of a sheet that burns; the triangles above are then what is left of it.
    pub burnt: Option<BurntSurface>,
}

/// Material and load of a layer on one triangle of its output mesh: means over the triangles of the mesh that it
/// was computed on in which the corners lie.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaceState {
    /// Compression that the surface below applies, `e1 + nu e2`, as far as it is loaded, over the critical
    /// strain: beyond 1 the layer wrinkles; below 0 it is stretched.
    pub strain_ratio: f64,
    /// Compression at which the layer begins to wrinkle there.
    pub critical_strain: f64,
    /// Critical wavelength, m.
    pub wavelength: f64,
    /// Young's modulus, Pa.
    pub young: f64,
    /// Thickness, m.
    pub thickness: f64,
    /// Energy of in-plane strain per area of the skin at rest, J/m².
    pub membrane_energy: f64,
    /// Energy of bending per area at rest, J/m².
    pub bending_energy: f64,
    /// Energy of the springs to what lies below per area at rest, J/m²; none in a layer that moves together with
    /// the one below.
    pub foundation_energy: f64,
}

/// The mesh on which a layer was computed: finer only where, and in the direction that, it
/// wrinkles. The output mesh lies in the file's own triangles instead.
#[derive(Clone, Debug, Default)]
pub struct ComputedMesh {
    /// Vertex positions, m.
    pub positions: Vec<Vector3<f64>>,
    /// Triangles.
    pub faces: Vec<[u32; 3]>,
    /// Texture coordinate of every vertex's material point, V down; at a seam of one of its sides.
    /// Maps and frames are addressed by the place on the file's flat triangles that lies straight
    /// above or below.
    pub uvs: Vec<Vector2<f64>>,
}

/// A pose after simulation.
#[derive(Clone, Debug, Default)]
pub struct PoseResult {
    /// Results at the pose's keys, in order; fewer when interrupted or given up. A key at which
    /// nothing can wrinkle has no layers.
    pub keys: Vec<KeyResult>,
    /// Measurements per layer, bottom first.
    pub layers: Vec<LayerReport>,
    /// Load steps solved.
    pub frames: usize,
    /// Whether every solve met its stop rule.
    pub converged: bool,
    /// Whether the observer stopped the work.
    pub interrupted: bool,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// The layers at one key.
#[derive(Clone, Debug, Default)]
pub struct KeyResult {
    /// Fraction of the pose.
    pub load: f64,
    /// Layers, bottom first.
    pub layers: Vec<LayerSurface>,
    /// Positions of the driver's vertices (m) if they moved with a [`Body`](crate::Body) and not by blend
    /// shapes alone, m.
    pub artist_positions: Option<Vec<Vector3<f64>>>,
}

/// Measurements on one layer, at the last load unless said otherwise.
#[derive(Clone, Debug, Default)]
pub struct LayerReport {
    /// Name of the layer.
    pub name: String,
    /// Vertices; of a burning sheet that is meshed anew the most that it has had.
    pub vertices: usize,
    /// Triangles, likewise.
    pub faces: usize,
    /// Constraint rows per coordinate.
    pub constraints: usize,
    /// Wavelength of the linear theory, m.
    pub wavelength_predicted: f64,
    /// Critical strain of the linear theory.
    pub critical_strain_predicted: f64,
    /// Ranges of painted and naturally uneven properties where the layer is simulated.
    pub painted: Option<PaintedRanges>,
    /// Dominant wavelength along the surface, m; `None` where nothing wrinkles.
    pub wavelength: Option<f64>,
    /// `sqrt(2)` times the RMS height where the driver asks for more than the critical strain, m.
    pub amplitude: f64,
    /// Elastic energy, J.
    pub energy: f64,
    /// Newton iterations over all load steps.
    pub newton_iterations: usize,
    /// Factorisations over all load steps.
    pub factorizations: usize,
    /// Relative residual of the last solve.
    pub residual: f64,
    /// Why the last solve ended: the Newton decrement usually falls below its tolerance long
    /// before the residual does, because a pattern slides along itself almost freely.
    pub stop: Option<StopRule>,
    /// Response bending modulus of this very mesh over that of the material.
    pub bending_ratio: Option<f64>,
    /// Fraction of the pose at which the layer begins to wrinkle: found by bisection where every frame was
    /// wanted, or else an estimate, where a part of a key's strain first reaches the critical one on some
    /// face; `None` for motion in time, which looks for none.
    pub onset_load: Option<f64>,
    /// Area of the skin (m²) by which it is compressed, in the last state, beyond what wrinkles take
    /// ([`ruga_material::capped_strain`]) and creases take up ([`CreaseSpec::absorbs`](crate::CreaseSpec::absorbs)). Of
    /// layers on each other each has its own.
    pub left_out: f64,
    /// Creases that have edges on its mesh.
    pub creases: Vec<CreaseReport>,
    /// Triangles of a sheet that cross others of it, at the last key or where the pose ended; `None` of other layers.
    pub intersections: Option<usize>,
    /// What its fire has done, of a sheet that burns.
    pub fire: Option<FireReport>,
}

/// What a fire on a sheet has done.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FireReport {
    /// Vertices of the mesh of temperature and fuel.
    pub field_vertices: usize,
    /// Factorisations of the matrix of the heat: one, until much has burnt or a step has another length.
    pub factorisations: usize,
    /// Share of the fuel that is left.
    pub fuel_left: f64,
    /// Mass that is left, kg.
    pub mass: f64,
    /// Median speed of the front where it has passed, m/s.
    pub front_speed: Option<f64>,
    /// Pieces that the sheet is in.
    pub pieces: usize,
    /// Pieces that have vanished: they were too small, or had fallen far.
    pub vanished: usize,
    /// Area of these when fresh, m².
    pub vanished_area: f64,
    /// Faces whose natural curvature is cut to what their edges can show.
    pub capped: usize,
    /// How often the sheet was meshed anew, to be fine where it burns.
    pub remeshed: usize,
}

/// How a crease has folded, at the last load.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CreaseReport {
    /// Name of the crease.
    pub name: String,
    /// Length of line on the mesh, m.
    pub length: f64,
    /// Mean fold angle along the line, positive in a valley, rad.
    pub fold: f64,
    /// Largest fold angle, rad.
    pub largest_fold: f64,
    /// Mean depth below the surface that carries the layer; negative for a height, m.
    pub depth: f64,
    /// Largest depth, of a mountain fold height, m.
    pub largest_depth: f64,
    /// Energy in the crease itself, J.
    pub energy: f64,
    /// Share of the length that is folded by 5 degrees or more.
    pub folded_share: f64,
    /// How it has folded from place to place along the line.
    pub along: Vec<FoldSample>,
}

/// How a crease has folded in a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FoldSample {
    /// Share of the line's length.
    pub share: f64,
    /// Fold angle (rad), positive in a valley.
    pub fold: f64,
    /// Angle at which it has no moment (rad), by what draws it in this pose and by what it keeps.
    pub rest: f64,
    /// Its own softness, without what it has gained, m.
    pub softness: f64,
}

/// Angle from which on a crease counts as folded, rad.
const FOLDED: f64 = 5.0 * std::f64::consts::PI / 180.0;

impl CreaseReport {
    /// The report of a crease before any edge is counted.
    pub(crate) fn of(crease: &CreaseSpec) -> Self {
        Self {
            name: crease.name.clone(),
            ..Self::default()
        }
    }

    /// Counts in an edge of a length (m) with its fold angle and depth.
    pub(crate) fn add(&mut self, length: f64, (fold, depth): (f64, f64), energy: f64) {
        self.length += length;
        self.fold += length * fold;
        self.depth += length * depth;
        self.largest_fold = larger(self.largest_fold, fold);
        self.largest_depth = larger(self.largest_depth, depth);
        self.energy += energy;
        if fold.abs() >= FOLDED {
            self.folded_share += length;
        }
    }

    /// Makes means of the sums over a line that has a length.
    pub(crate) fn finished(mut self) -> Self {
        self.fold /= self.length;
        self.depth /= self.length;
        self.folded_share /= self.length;
        self
    }
}

/// Of two numbers the one that is farther from 0.
fn larger(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}

impl LayerSurface {
    /// Ways of the vertices from where they would be without wrinkles: from the driver at their material points,
    /// plus the layer's offset along its normal, m. A layer on another one has those of the layers below in them.
    pub fn displacements(&self) -> Vec<Vector3<f64>> {
        let smooth = self.driver_positions.iter().zip(&self.driver_normals);
        let pairs = self.positions.iter().zip(smooth);
        pairs.map(|(x, (p, n))| x - p - n * self.offset).collect()
    }

    /// Takes over the lists of `other` that are the same as its own: an output mesh that is made anew for every key
    /// is kept once.
    pub fn share_lists(&mut self, other: &Self) {
        share(&mut self.faces, &other.faces);
        share(&mut self.uvs, &other.uvs);
        share(&mut self.artist, &other.artist);
        share(&mut self.on_plane, &other.on_plane);
    }
}

fn share<T: PartialEq>(own: &mut Arc<[T]>, other: &Arc<[T]>) {
    if own == other {
        *own = Arc::clone(other);
    }
}

impl FaceState {
    /// Mean of three states.
    pub(crate) fn mean(states: [&Self; 3]) -> Self {
        let mean = |value: fn(&Self) -> f64| states.map(value).iter().sum::<f64>() / 3.0;
        Self {
            strain_ratio: mean(|state| state.strain_ratio),
            critical_strain: mean(|state| state.critical_strain),
            wavelength: mean(|state| state.wavelength),
            young: mean(|state| state.young),
            thickness: mean(|state| state.thickness),
            membrane_energy: mean(|state| state.membrane_energy),
            bending_energy: mean(|state| state.bending_energy),
            foundation_energy: mean(|state| state.foundation_energy),
        }
    }
}

impl PoseResult {
    /// Adds a warning about a layer in a pose, unless it is there already.
    pub(crate) fn warn(&mut self, pose: &str, layer: &str, warning: &str) {
        let text = format!("pose '{pose}', layer '{layer}': {warning}");
        if !self.warnings.contains(&text) {
            self.warnings.push(text);
        }
    }
}

impl ComputedMesh {
    /// The mesh `skin` with its vertices at `positions` (m).
    pub(crate) fn new(driver: &Driver, skin: &SkinMesh, positions: &[Vector3<f64>]) -> Self {
        let points = skin.points.points().iter();
        Self {
            positions: positions.to_vec(),
            faces: skin.corner_indices(),
            uvs: points.map(|point| uv(driver, point)).collect(),
        }
    }
}

/// Amplitude below which a layer counts as flat, in thicknesses.
const LEAST_AMPLITUDE: f64 = 0.01;

impl LayerReport {
    /// Report of a layer before it is simulated.
    pub(crate) fn planned(layer: &LayerPlan) -> Self {
        Self {
            name: layer.name.clone(),
            wavelength_predicted: layer.wavelength,
            critical_strain_predicted: layer.critical_strain,
            painted: layer.painted,
            ..Self::default()
        }
    }

    /// Measures wavelength and amplitude of a layer of this thickness (m), from its `heights` (m) over
    /// some faces of a mesh that at `rest` has its vertices there (m).
    pub(crate) fn measure(
        &mut self,
        (heights, rest): (&[f64], &[Vector3<f64>]),
        faces: &[[u32; 3]],
        thickness: f64,
    ) {
        let waves = waviness(heights, rest, faces.iter().copied());
        // What was measured at an earlier key may be gone.
        self.amplitude = waves.map_or(0.0, |waves| waves.amplitude);
        // This is ten times the noise that a layer begins with. Below, a wavelength would be one of
        // the noise.
        let wrinkled = waves.filter(|waves| waves.amplitude > LEAST_AMPLITUDE * thickness);
        self.wavelength = wrinkled.map(|waves| waves.wavelength);
    }

    /// Counts in what a solve has done.
    pub(crate) fn count(&mut self, solve: &SolveReport) {
        self.newton_iterations += solve.iterations;
        self.factorizations += solve.factorizations;
    }

    /// Takes from the solve that is kept how exactly and why it ended.
    pub(crate) fn end_with(&mut self, solve: &SolveReport) {
        self.residual = solve.residual;
        self.stop = Some(solve.stop);
    }
}
