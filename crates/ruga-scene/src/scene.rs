//! A scene with everything that it names, read and converted.

mod mask_warnings;
mod region;
mod zone_overlap;

use std::cell::OnceCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use ruga_blend::Driver;
use ruga_io::{IoError, MeshFile, ObjOptions, read_mesh};
use ruga_material::UvTile;
use ruga_stepper::{
    BYTES_PER_TEXEL, Body, Fire, LatticeError, LayerSpec, Modelling, PoseSpec, Region, Sheet,
    Stack, StepperError, plan, plan_body, plan_sheet,
};

use crate::creases::{CreasedMesh, add_creases, texel_warning};
use crate::file::{self, SceneFile};
use crate::growths::{add_growths, unused_growths};
use crate::painted_files::tile_files;
use crate::plan::{ScenePlan, ZonePlan};
use crate::scene::mask_warnings::mask_warnings;
use crate::scene::region::region;
use crate::symmetry::PoseImages;
use crate::uv_tiles::{are_tiled, driver_in_tiles};
use crate::{Mirror, SceneError, body, counted, mesh_size, model, painted_files, texture_space};

/// Requests to a scene beside what stands in its file.
#[derive(Clone, Debug, Default)]
pub struct SceneOptions {
    /// Names of the poses that are wanted; empty: all of them.
    pub poses: Vec<String>,
    /// Vertices per wavelength, in place of those that the file asks for.
    pub points_per_wavelength: Option<f64>,
}

/// A scene with everything that it names, as the other crates take it.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The scene file, as it was given.
    pub path: PathBuf,
    /// Content of the file, defaults filled in and paths resolved.
    pub file: SceneFile,
    /// The artist's mesh file.
    pub mesh: MeshFile,
    /// UDIM tiles that the mesh lies in, ascending; the first one alone where it has none.
    pub tiles: Vec<UvTile>,
    /// The welded mesh with its blend shapes; with UDIM tiles its texture coordinates keep a little away from
    /// the borders of tiles.
    pub driver: Arc<Driver>,
    /// The layers, in the order of the file.
    pub layers: Vec<LayerSpec>,
    /// The poses that are wanted.
    pub poses: Vec<PoseSpec>,
    /// Correspondence of the two sides of a mesh that is to mirror itself; without it every pose is simulated
    /// as it is.
    pub mirror: Option<Arc<Mirror>>,
    /// The body that the layer lies on, if it is one.
    pub body: Option<Body>,
    /// What acts on the layer, if it lies on nothing.
    pub sheet: Option<Sheet>,
    /// The choices that are not physics.
    pub modelling: Modelling,
    /// Warnings: what was assumed or left out while reading.
    pub warnings: Vec<String>,
}

impl Scene {
    /// Reads a scene, its mesh and its images.
    ///
    /// # Errors
    /// The first thing that is wrong, naming file and key or element.
    pub fn read(path: &Path) -> Result<Self, SceneError> {
        Self::read_with(path, &SceneOptions::default())
    }

    /// Reads a scene, its mesh and its images, with some poses only or another resolution.
    ///
    /// # Errors
    /// The first thing that is wrong, naming file and key or element.
    pub fn read_with(path: &Path, options: &SceneOptions) -> Result<Self, SceneError> {
        Inspection::new(path, options)?.into_scene()
    }

    /// Whether the mesh has UDIM tiles, so that there is a map for each of them.
    pub fn is_tiled(&self) -> bool {
        are_tiled(&self.tiles)
    }

    /// The files that an image of the scene stands for: one, or those of the mesh's tiles that are there.
    pub fn image_files(&self, image: &Path) -> Vec<PathBuf> {
        let files = tile_files(image, &self.tiles).into_iter();
        files.map(|(_, file)| file).collect()
    }

    /// Plans what will be modelled, and makes sure that it has a place in the maps.
    ///
    /// # Errors
    /// [`SceneError::Model`], such as a mask that leaves nothing; [`SceneError::OverlappingUvs`];
    /// [`SceneError::UvLayout`]; [`SceneError::ZonesOverlap`].
    pub fn plan(&self) -> Result<ScenePlan, SceneError> {
        zone_overlap::check(self)?;
        let mut planned = self.planned().map_err(|source| match source {
            StepperError::Lattice(
                source @ (LatticeError::OpenSurface { .. }
                | LatticeError::SelfIntersection { .. }
                | LatticeError::WrongSide { .. }
                | LatticeError::CannotCut { .. }),
            ) => SceneError::Surface {
                mesh: self.mesh.path.clone(),
                source,
            },
            StepperError::BlackMask { layer } => SceneError::BlackMask {
                scene: self.path.clone(),
                masks: masks_of(&self.file, &layer),
                layer,
            },
            other => SceneError::Model {
                scene: self.path.clone(),
                source: Box::new(other),
            },
        })?;
        let active =
            |(index, pose): (usize, &PoseSpec)| (pose.name.clone(), planned.shown_triangles(index));
        let active: Vec<_> = self.poses.iter().enumerate().map(active).collect();
        let told = texture_space::check_active((&self.mesh, &self.tiles), &active)?;
        planned.warn(told);
        if self.leaves_poses_out() {
            planned.drop_of_all_poses();
        }
        planned.warn(self.texel_warnings(&planned));
        let maps = active.iter().map(|(_, active)| self.map_bytes(active));
        planned.map_bytes = maps.collect();
        Ok(planned)
    }

    fn planned(&self) -> Result<ScenePlan, StepperError> {
        let (driver, modelling) = (&self.driver, &self.modelling);
        // Of paint that differs one half would be lost, and two layers in one system are solved whole.
        let is_alike = |mirror: &Arc<Mirror>| {
            let differs = mirror.warnings(&self.layers, Some(&self.modelling.region));
            differs.is_empty() && modelling.stack != Stack::Joint
        };
        let can_halve = self.mirror.as_ref().is_some_and(is_alike);
        let mirror = self.mirror.as_ref();
        let (images, poses) = PoseImages::new(mirror, driver, &self.poses, can_halve);
        let poses = &poses;
        let size = self.file.bake.size;
        if let Some(sheet) = &self.sheet {
            let zone = ZonePlan {
                plan: plan_sheet(driver, &self.layers[0], sheet, poses, modelling, size)?,
                layers: vec![0],
            };
            return Ok(ScenePlan::new(vec![zone], images));
        }
        if let Some(body) = &self.body {
            let zone = ZonePlan {
                plan: plan_body(driver, &self.layers, body, poses, modelling, size)?,
                layers: (0..self.layers.len()).collect(),
            };
            return Ok(ScenePlan::new(vec![zone], images));
        }
        let zones = self.file.zones().into_iter().map(|zone| {
            let of_zone = zone.layers.iter();
            let layers: Vec<LayerSpec> = of_zone.map(|i| self.layers[*i].clone()).collect();
            Ok(ZonePlan {
                plan: plan(driver, &layers, poses, modelling, size)?,
                layers: zone.layers,
            })
        });
        let zones = zones.collect::<Result<_, StepperError>>()?;
        Ok(ScenePlan::new(zones, images))
    }

    /// Whether the scene has poses beside those that are wanted.
    fn leaves_poses_out(&self) -> bool {
        let all = model::poses(&self.file, &self.driver, &[], &self.path);
        all.is_ok_and(|all| all.len() > self.poses.len())
    }

    /// Warnings of maps too small for the creases of a layer, each once.
    fn texel_warnings(&self, planned: &ScenePlan) -> Vec<String> {
        let least = |layer: usize| {
            let poses = (0..self.poses.len()).map(|pose| planned.pose_layers(pose)[layer]);
            let simulated = poses.filter(|plan| plan.vertices > 0);
            let texels = simulated.map(|plan| plan.texels_per_wavelength);
            texels.fold(f64::INFINITY, f64::min)
        };
        let layers = self.layers.iter().enumerate();
        layers
            .filter_map(|(i, layer)| texel_warning(layer, least(i), self.file.bake.size))
            .collect()
    }

    /// Bytes that the maps of the tiles with simulated skin take beside one of them, which the plan of a layer
    /// knows of; `active` are the simulated triangles of the file.
    fn map_bytes(&self, active: &[u32]) -> f64 {
        let others = self.baked_tiles(active).len().saturating_sub(1);
        others as f64 * BYTES_PER_TEXEL * f64::from(self.file.bake.size).powi(2)
    }
}

/// Every part of a scene that could be read, and everything that is wrong with the others.
#[derive(Debug)]
pub struct Inspection {
    /// The scene file, as it was given.
    pub path: PathBuf,
    /// Content of the file.
    pub file: SceneFile,
    /// The artist's mesh file and the welded mesh.
    pub mesh: Option<(MeshFile, Arc<Driver>)>,
    /// UDIM tiles that the mesh lies in, ascending; the first one alone where it has none.
    pub tiles: Vec<UvTile>,
    /// The layers.
    pub layers: Option<Vec<LayerSpec>>,
    /// Correspondence of the two sides of a mesh that is to mirror itself.
    pub mirror: Option<Arc<Mirror>>,
    /// Region where skin is simulated.
    pub region: Option<Region>,
    /// The poses that are wanted.
    pub poses: Option<Vec<PoseSpec>>,
    /// Warnings: what was assumed or left out.
    pub warnings: Vec<String>,
    /// Errors that keep the scene from being planned.
    pub problems: Vec<SceneError>,
    pub(crate) fire: Option<Fire>,
    points_per_wavelength: Option<f64>,
}

impl Inspection {
    /// Looks at every part of a scene, whatever is wrong with the others.
    ///
    /// # Errors
    /// The scene's own error when its file cannot be read at all.
    pub fn new(path: &Path, options: &SceneOptions) -> Result<Self, SceneError> {
        let mut inspection = Self {
            path: path.to_owned(),
            file: SceneFile::read(path)?,
            mesh: None,
            tiles: vec![UvTile::FIRST],
            layers: None,
            mirror: None,
            region: None,
            poses: None,
            warnings: Vec::new(),
            problems: Vec::new(),
            fire: None,
            points_per_wavelength: options.points_per_wavelength,
        };
        // Read first, because images are read for its tiles; what is wrong with it is told after the layers.
        let mesh = artist_mesh(&inspection.file, path);
        if let Ok(mesh) = &mesh {
            inspection.tiles = texture_space::tiles(mesh, inspection.file.driver.tiles);
        }
        inspection.look_at_layers();
        inspection.look_at_mesh(mesh, &options.poses);
        inspection.look_at_fire();
        inspection.look_at_masks();
        inspection.look_at_symmetry();
        Ok(inspection)
    }

    /// The whole scene.
    ///
    /// # Errors
    /// The first of the problems.
    pub fn into_scene(mut self) -> Result<Scene, SceneError> {
        if !self.problems.is_empty() {
            return Err(self.problems.swap_remove(0));
        }
        let whole = "a scene without problems has all its parts";
        let (mesh, driver) = self.mesh.expect(whole);
        let layers = self.layers.expect(whole);
        let region = self.region.expect(whole);
        Ok(Scene {
            body: body::body_of(&self.file, &mesh, &layers),
            sheet: body::sheet_of(&self.file, &mesh, self.fire),
            modelling: model::modelling(&self.file, region, self.points_per_wavelength),
            path: self.path,
            file: self.file,
            mesh,
            tiles: self.tiles,
            driver,
            layers,
            poses: self.poses.expect(whole),
            mirror: self.mirror,
            warnings: self.warnings,
        })
    }

    /// The value, or nothing and one more problem.
    fn keep<T>(&mut self, result: Result<T, SceneError>) -> Option<T> {
        result.map_err(|error| self.problems.push(error)).ok()
    }

    fn look_at_layers(&mut self) {
        let refused = model::bending_without_layer(&self.file, &self.path);
        self.problems.extend(refused);
        let layers = model::layers(&self.file, &self.path, &self.tiles);
        self.layers = self.keep(layers);
        if let Some(layers) = &mut self.layers {
            let added = add_growths(&self.file, &self.path, &self.tiles, layers);
            self.keep(added);
            self.warnings.extend(unused_growths(&self.file));
        }
        if let Some(layers) = &self.layers {
            let presets = model::preset_warnings(&self.file, layers);
            self.warnings.extend(presets);
        }
    }

    fn look_at_mesh(&mut self, mesh: Result<MeshFile, SceneError>, wanted: &[String]) {
        let Some(mesh) = self.keep(mesh) else { return };
        let uvs = texture_space::check(&mesh, &self.tiles);
        let driver = driver_of(&mesh).map(|driver| match are_tiled(&self.tiles) {
            true => driver_in_tiles(driver),
            false => driver,
        });
        let Some(driver) = self.keep(driver) else {
            self.keep(uvs);
            return;
        };
        self.warnings.extend(mesh_warnings(&mesh, &driver));
        let poses = model::poses(&self.file, &driver, wanted, &self.path);
        self.poses = self.keep(poses);
        self.look_at_creases(&mesh, &driver);
        if let Some(layers) = &self.layers {
            let size = mesh_size::check(&self.file, &mesh, layers);
            let size = self.keep(size);
            self.warnings.extend(size.flatten());
        }
        if let Some(poses) = &mut self.poses {
            body::set_motions(&self.file, &mesh, poses);
            let weights = model::weight_warnings(&self.file, poses);
            self.warnings.extend(weights);
        }
        let uvs = self.keep(uvs);
        self.warnings.extend(uvs.into_iter().flatten());
        self.mesh = Some((mesh, Arc::new(driver)));
    }

    fn look_at_creases(&mut self, mesh: &MeshFile, driver: &Driver) {
        let points = self.points();
        let Some(layers) = &mut self.layers else {
            return;
        };
        let on = CreasedMesh {
            scene: &self.file,
            path: &self.path,
            mesh,
            driver,
            tiles: &self.tiles,
            tracer: OnceCell::new(),
        };
        let added = add_creases(&on, points, layers);
        let told = self.keep(added);
        self.warnings.extend(told.into_iter().flatten());
    }

    /// Points per wavelength that were asked for.
    pub(crate) fn points(&self) -> f64 {
        let asked = self.file.remesh.points_per_wavelength;
        self.points_per_wavelength.unwrap_or(asked)
    }

    fn look_at_symmetry(&mut self) {
        let Some((mesh, driver)) = &self.mesh else {
            return;
        };
        if self.file.driver.symmetry.is_none() {
            return;
        }
        let mirror = Mirror::new(&mesh.mesh, driver).map_err(|source| SceneError::NotSymmetric {
            scene: self.path.clone(),
            mesh: mesh.path.clone(),
            source,
        });
        if let (Ok(mirror), Some(layers)) = (&mirror, &self.layers) {
            self.warnings
                .extend(mirror.warnings(layers, self.region.as_ref()));
        }
        self.mirror = self.keep(mirror).map(Arc::new);
    }

    fn look_at_masks(&mut self) {
        let region = region(&self.file, &self.path, &self.tiles);
        self.region = self.keep(region);
        self.warnings.extend(mask_warnings(&self.file, &self.tiles));
        let uncovered = painted_files::warnings(&self.file, &self.tiles);
        self.warnings.extend(uncovered);
    }
}

/// The artist's mesh, read from the file that the scene names.
fn artist_mesh(scene: &SceneFile, path: &Path) -> Result<MeshFile, SceneError> {
    let options = ObjOptions {
        targets: scene.driver.targets.clone(),
        length_unit: scene.length_unit,
    };
    let name = scene.driver.mesh_name.as_deref();
    let mesh = read_mesh(&scene.driver.mesh, name, &options)
        .map_err(|error| mesh_error(error, scene, path))?;
    Ok(match scene.driver.scale {
        Some(metres_per_unit) => mesh.scaled(metres_per_unit),
        None => mesh,
    })
}

/// The error of a mesh; of one that cannot be opened, with the key that names it.
fn mesh_error(error: IoError, scene: &SceneFile, path: &Path) -> SceneError {
    let file = match &error {
        IoError::Unreadable { path, .. }
        | IoError::Directory { path }
        | IoError::UnknownFormat { path, .. } => path,
        _ => return error.into(),
    };
    let mut targets = scene.driver.targets.iter();
    let key = match targets.find(|(_, target)| *target == file) {
        Some((shape, _)) => format!("driver.targets.{shape}"),
        None if *file == scene.driver.mesh => "driver.mesh".to_owned(),
        // A part of a mesh, such as the buffer of a glTF file, has no key.
        None => return error.into(),
    };
    SceneError::NamedFile {
        scene: path.to_owned(),
        key,
        source: Box::new(error),
    }
}

/// The welded mesh with its blend shapes.
///
/// # Errors
/// [`SceneError::Mesh`] when it cannot be driven.
pub fn driver_of(mesh: &MeshFile) -> Result<Driver, SceneError> {
    Driver::new(&mesh.mesh).map_err(|source| SceneError::Mesh {
        mesh: mesh.path.clone(),
        source,
    })
}

/// Warnings about what the reader and the welding left out.
fn mesh_warnings(mesh: &MeshFile, driver: &Driver) -> Vec<String> {
    let mut warnings = mesh.warnings.clone();
    let degenerate = driver.degenerate_triangles();
    if let Some(first) = degenerate.first() {
        warnings.push(format!(
            "{}: {} without area left out, the first is triangle {first}; the skin has no gap there, and \
             nothing needs to be done",
            mesh.path.display(),
            counted(degenerate.len(), "triangle")
        ));
    }
    warnings
}

/// The masks that decide where a layer is, each with its key and image.
fn masks_of(scene: &SceneFile, layer: &str) -> String {
    let own = scene.layers.iter().position(|other| other.name == layer);
    let zone = own.and_then(|own| {
        scene
            .zones()
            .into_iter()
            .find(|zone| zone.layers.contains(&own))
    });
    let lowest = zone.map(|zone| zone.layers[0]);
    let mut numbers: Vec<usize> = lowest.into_iter().chain(own).collect();
    numbers.dedup();
    let of_layers = numbers.into_iter().filter_map(|i| {
        let image = scene.layers[i].mask.as_ref()?;
        Some(format!("`layers[{i}].mask` ({})", image.display()))
    });
    let of_region = match &scene.driver.region {
        file::Region::Mask(image) => Some(format!("`driver.region` ({})", image.display())),
        file::Region::Auto | file::Region::All => None,
    };
    let masks: Vec<String> = of_region.into_iter().chain(of_layers).collect();
    match masks.as_slice() {
        [] => "the masks".to_owned(),
        masks => masks.join(" and "),
    }
}
