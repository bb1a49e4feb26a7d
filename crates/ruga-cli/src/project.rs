//! A scene with everything that it names, read and converted.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use ruga_blend::Driver;
use ruga_io::{IoError, MeshFile, ObjOptions, Scene, read_mask, read_mesh, scene};
use ruga_stepper::{
    Body, LatticeError, LayerSpec, Mask, Modelling, PoseSpec, Region, StepperError, plan, plan_body,
};

use crate::arguments::Quality;
use crate::error::{CliError, counted};
use crate::placement::Placement;
use crate::planned::{Planned, ZonePlan};
use crate::{body, mesh_size, model, texture_space, zone_overlap};

/// What a command works on.
pub(crate) struct Project {
    /// The scene file, as it was given.
    pub(crate) path: PathBuf,
    pub(crate) scene: Scene,
    pub(crate) mesh: MeshFile,
    pub(crate) driver: Arc<Driver>,
    pub(crate) layers: Vec<LayerSpec>,
    pub(crate) poses: Vec<PoseSpec>,
    /// The body that the layer lies on, if it is one.
    pub(crate) body: Option<Body>,
    pub(crate) modelling: Modelling,
    /// What was assumed or left out while reading.
    pub(crate) warnings: Vec<String>,
}

impl Project {
    /// Reads the scene, its mesh and its mask; `poses` selects some, empty means all.
    ///
    /// # Errors
    /// The first thing that is wrong, naming file and key or element.
    pub(crate) fn read(
        path: &Path,
        poses: &[String],
        quality: Option<Quality>,
    ) -> Result<Self, CliError> {
        let scene = Scene::read(path)?;
        if let Some(refused) = model::bending_without_layer(&scene, path) {
            return Err(refused);
        }
        let layers = model::layers(&scene, path)?;
        let mesh = artist_mesh(&scene)?;
        let driver = driver(&mesh)?;
        let mut poses = model::poses(&scene, &driver, poses, path)?;
        set_motions(&scene, &mesh, &mut poses);
        let modelling = model::modelling(&scene, region(&scene)?, quality);
        let mut warnings = mesh_warnings(&mesh, &driver);
        warnings.extend(mesh_size::check(&scene, &mesh, &layers)?);
        warnings.extend(mask_warnings(&scene, path)?);
        warnings.extend(model::weight_warnings(&scene, &poses));
        warnings.extend(texture_space::check(&mesh)?);
        Ok(Self {
            path: path.to_owned(),
            warnings,
            body: body_of(&scene, &mesh, &layers),
            scene,
            mesh,
            driver: Arc::new(driver),
            layers,
            poses,
            modelling,
        })
    }

    /// What will be modelled, its place in the maps made sure of.
    ///
    /// # Errors
    /// [`CliError::Model`], such as a mask that leaves nothing; [`CliError::OverlappingUvs`];
    /// [`CliError::UvLayout`]; [`CliError::ZonesOverlap`].
    pub(crate) fn plan(&self) -> Result<Planned, CliError> {
        zone_overlap::check(self)?;
        let mut planned = self.planned().map_err(|source| match source {
            StepperError::Lattice(
                source @ (LatticeError::OpenSurface { .. }
                | LatticeError::SelfIntersection { .. }
                | LatticeError::WrongSide { .. }
                | LatticeError::CannotCut { .. }),
            ) => CliError::Surface {
                mesh: self.mesh.path.clone(),
                source,
            },
            other => CliError::Model {
                scene: self.path.clone(),
                source: Box::new(other),
            },
        })?;
        let active = |(index, pose): (usize, &PoseSpec)| {
            (pose.name.clone(), planned.active_triangles(index))
        };
        let active: Vec<_> = self.poses.iter().enumerate().map(active).collect();
        planned.warn(texture_space::check_active(&self.mesh, &active)?);
        Ok(planned)
    }

    fn planned(&self) -> Result<Planned, StepperError> {
        let (driver, poses, modelling) = (&self.driver, &self.poses, &self.modelling);
        let size = self.scene.bake.size;
        if let (Some(body), Some(layer)) = (&self.body, self.layers.first()) {
            let zone = ZonePlan {
                plan: plan_body(driver, layer, body, poses, modelling, size)?,
                layers: vec![0],
            };
            return Ok(Planned { zones: vec![zone] });
        }
        let zones = self.scene.zones().into_iter().map(|zone| {
            let of_zone = zone.layers.iter();
            let layers: Vec<LayerSpec> = of_zone.map(|i| self.layers[*i].clone()).collect();
            Ok(ZonePlan {
                plan: plan(driver, &layers, poses, modelling, size)?,
                layers: zone.layers,
            })
        });
        let zones = zones.collect::<Result<_, StepperError>>()?;
        Ok(Planned { zones })
    }
}

/// The body below the layer, where the scene has one.
pub(crate) fn body_of(scene: &Scene, mesh: &MeshFile, layers: &[LayerSpec]) -> Option<Body> {
    let (interior, layer) = (scene.interior.as_ref()?, layers.first()?);
    Some(body::body(interior, &layer.substrate, &Placement::of(mesh)))
}

/// Gives each of `poses` the motions that the scene lists for it.
pub(crate) fn set_motions(scene: &Scene, mesh: &MeshFile, poses: &mut [PoseSpec]) {
    let placement = Placement::of(mesh);
    for pose in poses {
        pose.motions = body::motions(scene, &pose.name, &placement);
    }
}

/// The artist's mesh, read from the file that the scene names.
pub(crate) fn artist_mesh(scene: &Scene) -> Result<MeshFile, CliError> {
    let options = ObjOptions {
        targets: scene.driver.targets.clone(),
        length_unit: scene.length_unit,
    };
    let name = scene.driver.mesh_name.as_deref();
    let mesh = read_mesh(&scene.driver.mesh, name, &options)?;
    Ok(match scene.driver.scale {
        Some(metres_per_unit) => mesh.scaled(metres_per_unit),
        None => mesh,
    })
}

/// The welded mesh with its blend shapes.
pub(crate) fn driver(mesh: &MeshFile) -> Result<Driver, CliError> {
    Driver::new(&mesh.mesh).map_err(|source| CliError::Mesh {
        mesh: mesh.path.clone(),
        source,
    })
}

/// What the reader and the welding left out.
pub(crate) fn mesh_warnings(mesh: &MeshFile, driver: &Driver) -> Vec<String> {
    let mut warnings = mesh.warnings.clone();
    let degenerate = driver.degenerate_triangles();
    if let Some(first) = degenerate.first() {
        warnings.push(format!(
            "{}: {} without area left out, the first is triangle {first}",
            mesh.path.display(),
            counted(degenerate.len(), "triangle")
        ));
    }
    warnings
}

/// Where skin is simulated, the mask read.
pub(crate) fn region(scene: &Scene) -> Result<Region, CliError> {
    Ok(match &scene.driver.region {
        scene::Region::Auto => Region::Auto,
        scene::Region::All => Region::All,
        scene::Region::Mask(path) => Region::Mask(mask(path)?),
    })
}

/// What is unusual about the masks of the region and of the layers.
///
/// # Errors
/// [`IoError::SceneImage`] for a mask that cannot be read, naming its key.
pub(crate) fn mask_warnings(scene: &Scene, path: &Path) -> Result<Vec<String>, CliError> {
    let region = match &scene.driver.region {
        scene::Region::Mask(mask) => Some(("driver.region".to_owned(), mask)),
        scene::Region::Auto | scene::Region::All => None,
    };
    let layers = scene.layers.iter().enumerate();
    let layers =
        layers.filter_map(|(i, layer)| Some((format!("layers[{i}].mask"), layer.mask.as_ref()?)));
    let mut warnings = Vec::new();
    for (key, file) in region.into_iter().chain(layers) {
        let image = read_mask(file).map_err(|source| IoError::SceneImage {
            scene: path.to_owned(),
            key: key.clone(),
            source: Box::new(source),
        })?;
        let mut warn = |what: String| warnings.push(format!("`{key}`: {}: {what}", file.display()));
        if image.width != image.height {
            let (width, height) = (image.width, image.height);
            warn(format!(
                "the mask is {width} x {height} texels; it is stretched over the whole UV square"
            ));
        }
        if image.had_transparency {
            warn("the mask is transparent in places; they count as black".to_owned());
        }
    }
    Ok(warnings)
}

/// The grey image at a path.
pub(crate) fn mask(path: &Path) -> Result<Mask, CliError> {
    let image = read_mask(path)?;
    let side = |texels: usize| u32::try_from(texels).unwrap_or(u32::MAX);
    let mask = Mask::new(side(image.width), side(image.height), image.values);
    mask.map_err(|source| CliError::Model {
        scene: path.to_owned(),
        source: Box::new(source),
    })
}
