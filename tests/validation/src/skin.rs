//! A mesh with blend shapes, covered by one layer of skin: planned, simulated and baked.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use nalgebra::Vector3;
use ruga_bake::{BakeSettings, Relief, TangentFrame, WrinkleMap, bake, tangent_frames};
use ruga_blend::{BaseSurface, Driver, Weights, face_strains};
use ruga_io::{MeshFile, ObjOptions, read_mesh};
use ruga_material::{WavelengthModel, preset};
use ruga_mesh::Id;
use ruga_stepper::{
    Coupling, KeyResult, LayerReport, LayerSpec, LayerSurface, Modelling, Observer, Plan,
    PoseResult, PoseSpec, Presence, Sampling, Silent, plan,
};

/// A mesh under one layer.
pub struct Skin {
    /// The artist's file.
    pub file: MeshFile,
    /// Its driver.
    pub driver: Arc<Driver>,
    /// The layer on it.
    pub layer: LayerSpec,
}

/// A folder beside the crates, or beside the repository.
fn beside(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)
}

/// A file of the shared data, if this checkout has them; says so where it has not.
#[expect(
    clippy::print_stdout,
    reason = "a test that checks nothing has to say so"
)]
pub fn shared_data(name: &str) -> Option<PathBuf> {
    let path = beside("../../../shared/data").join(name);
    let is_there = path.exists();
    if !is_there {
        println!("skipped: no {}", path.display());
    }
    is_there.then_some(path)
}

/// A file of the repository's assets.
pub fn asset(name: &str) -> PathBuf {
    beside("../../assets").join(name)
}

/// A scene of this package.
pub fn test_scene(name: &str) -> PathBuf {
    beside("scenes").join(name)
}

/// A layer of a preset, held the default way.
///
/// # Panics
/// When the preset is unknown.
pub fn skin_layer(name: &str, preset_name: &str) -> LayerSpec {
    let preset = preset(preset_name).expect("a preset");
    LayerSpec {
        name: name.to_owned(),
        material: preset.layer,
        laminate: None,
        substrate: preset.substrate,
        model: WavelengthModel::Layer,
        coupling: Coupling::Hybrid,
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

/// What was measured on a layer, in a line.
pub fn findings(layer: &LayerReport) -> String {
    format!(
        "{}: {} vertices, onset {:?}, wavelength {:.2} of {:.2} mm, amplitude {:.4} mm, {} factorisations",
        layer.name,
        layer.vertices,
        layer.onset_load,
        1e3 * layer.wavelength.unwrap_or(f64::NAN),
        1e3 * layer.wavelength_predicted,
        1e3 * layer.amplitude,
        layer.factorizations
    )
}

/// Wants every frame and looks at none.
pub struct EveryFrame;

impl Observer for EveryFrame {}

impl Skin {
    /// Reads the only mesh of a file and covers it with a preset, held the default way.
    ///
    /// # Panics
    /// When the file is no such mesh or the preset is unknown.
    pub fn new(path: &Path, preset_name: &str) -> Self {
        let file = read_mesh(path, None, &ObjOptions::default()).expect("a mesh that can be read");
        let driver = Driver::new(&file.mesh).expect("a mesh that can be simulated");
        let driver = Arc::new(driver);
        let layer = skin_layer("skin", preset_name);
        Self {
            file,
            driver,
            layer,
        }
    }

    /// Keeps the triangles that a blend shape moves, by more than a tenth of a millimetre.
    ///
    /// # Panics
    /// When the shape is unknown, or moves nothing.
    pub fn cut_out(mut self, shape: &str) -> Self {
        let mesh = &mut self.file.mesh;
        let moved = mesh.shapes.iter().find(|s| s.name == shape);
        let deltas = &moved.expect("a shape of the mesh").position_deltas;
        let moves = |v: &u32| deltas[*v as usize].norm() > 1e-4;
        mesh.triangles.retain(|corners| corners.iter().any(moves));
        let driver = Driver::new(mesh).expect("a shape that moves something");
        self.driver = Arc::new(driver);
        self
    }

    /// A pose with one key, at full weight.
    ///
    /// # Panics
    /// When a shape is unknown.
    pub fn pose(&self, weights: &[(&str, f64)], steps: u32) -> PoseSpec {
        PoseSpec {
            name: weights.iter().map(|w| w.0).collect::<Vec<_>>().join("+"),
            weights: self
                .driver
                .weights(weights.iter().copied())
                .expect("shapes of the mesh"),
            keys: vec![1.0],
            steps,
            motions: Vec::new(),
            growths: Vec::new(),
            half: false,
        }
    }

    /// Largest effective strain that a pose asks of the base surface split `levels` times.
    pub fn largest_strain(&self, weights: &Weights, levels: u32, modelling: &Modelling) -> f64 {
        let faces: Vec<_> = self.driver.topology().faces().ids().collect();
        let base = BaseSurface::new(&self.driver, &faces, levels, modelling.smoothing);
        let rest = base.pose(self.driver.rest());
        let posed = base.pose(&self.driver.pose(weights));
        face_strains(base.mesh(), &rest.positions, &posed.positions)
            .iter()
            .map(|(_, strain)| strain.effective(self.layer.material.poisson))
            .fold(0.0, f64::max)
    }

    /// The plan of one pose.
    ///
    /// # Panics
    /// When the planner refuses.
    pub fn plan(&self, pose: &PoseSpec, modelling: &Modelling) -> Plan {
        let layers = std::slice::from_ref(&self.layer);
        let poses = std::slice::from_ref(pose);
        plan(&self.driver, layers, poses, modelling, 1024).expect("a pose that can be planned")
    }

    /// Plans and simulates one pose.
    ///
    /// # Panics
    /// When planner or stepper refuse.
    pub fn simulate(&self, pose: &PoseSpec, modelling: &Modelling) -> PoseResult {
        self.simulate_stack(std::slice::from_ref(&self.layer), pose, modelling)
    }

    /// The same for these layers instead of its own.
    ///
    /// # Panics
    /// When planner or stepper refuse.
    pub fn simulate_stack(
        &self,
        layers: &[LayerSpec],
        pose: &PoseSpec,
        modelling: &Modelling,
    ) -> PoseResult {
        self.watch(layers, pose, modelling, &mut Silent)
    }

    /// Simulates layers from load to load, as for an observer who wants every frame, which finds the onset.
    ///
    /// # Panics
    /// When planner or stepper refuse.
    pub fn follow(
        &self,
        layers: &[LayerSpec],
        pose: &PoseSpec,
        modelling: &Modelling,
    ) -> PoseResult {
        self.watch(layers, pose, modelling, &mut EveryFrame)
    }

    fn watch(
        &self,
        layers: &[LayerSpec],
        pose: &PoseSpec,
        modelling: &Modelling,
        observer: &mut dyn Observer,
    ) -> PoseResult {
        let poses = std::slice::from_ref(pose);
        let plan =
            plan(&self.driver, layers, poses, modelling, 1024).expect("a pose that can be planned");
        plan.simulate(0, observer)
            .expect("a pose that can be simulated")
    }

    /// The map of one key, without padding.
    ///
    /// # Panics
    /// When the baker refuses.
    pub fn bake(&self, pose: &PoseSpec, key: &KeyResult, size: u32) -> WrinkleMap {
        let settings = BakeSettings {
            size,
            ..BakeSettings::default()
        };
        let frames = self.posed_frames(&pose.weights.scaled(key.load));
        let Some(layer) = key.layers.last() else {
            return bake(&EMPTY, &frames, &settings).expect("nothing can be baked");
        };
        bake(&relief(layer), &frames, &settings).expect("a layer that can be baked")
    }

    /// Tangent frames of the posed artist's mesh, with smooth normals.
    fn posed_frames(&self, weights: &Weights) -> Vec<[TangentFrame; 3]> {
        let control = self.driver.pose(weights);
        let welded = |v: u32| self.driver.welded()[v as usize].index();
        let mut sums = vec![Vector3::zeros(); control.len()];
        for corners in &self.file.mesh.triangles {
            let corners = corners.map(welded);
            let [a, b, c] = corners.map(|v| control[v]);
            for v in corners {
                sums[v] += (b - a).cross(&(c - a));
            }
        }
        let vertices = 0..self.file.mesh.positions.len() as u32;
        let (positions, normals): (Vec<_>, Vec<_>) = vertices
            .map(welded)
            .map(|v| {
                let normal = sums[v].try_normalize(0.0).unwrap_or_else(Vector3::z);
                (control[v], normal)
            })
            .unzip();
        let uvs = self.file.mesh.uvs.as_deref().unwrap_or_default();
        tangent_frames(&positions, &normals, uvs, &self.file.mesh.triangles)
            .expect("a mesh with tangents")
    }
}

/// The relief of a layer at full height, whatever maps show of it.
pub(crate) fn relief(layer: &LayerSurface) -> Relief<'_> {
    Relief {
        positions: &layer.positions,
        driver_positions: &layer.driver_positions,
        driver_normals: &layer.driver_normals,
        offset: layer.offset,
        faces: &layer.faces,
        uvs: &layer.uvs,
        artist: &layer.artist,
    }
}

/// A layer without triangles.
const EMPTY: Relief<'static> = Relief {
    positions: &[],
    driver_positions: &[],
    driver_normals: &[],
    offset: 0.0,
    faces: &[],
    uvs: &[],
    artist: &[],
};

/// Tilt of every texel's normal against neutral, degrees.
pub fn tilts(map: &WrinkleMap) -> impl Iterator<Item = f64> + '_ {
    map.normals.iter().map(|n| {
        let [x, y, z] = n.map(f64::from);
        x.hypot(y).atan2(z).to_degrees()
    })
}
