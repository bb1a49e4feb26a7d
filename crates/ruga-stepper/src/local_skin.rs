//! What a layer is made of, and how it wrinkles, at every place of a mesh.

use nalgebra::Vector2;
use ruga_blend::Driver;
use ruga_material::{LayerMaterial, RelativeProperties, Wrinkling, local_wrinkling};
use ruga_mesh::{FaceId, Id, MaterialPoint, PerFace};

use crate::skin_mesh::SkinMesh;
use crate::{LayerSpec, StepperError};

/// The layer at one place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalSkin {
    pub(crate) material: LayerMaterial,
    pub(crate) wrinkling: Wrinkling,
}

/// The layer at the vertices and on the faces of a mesh.
#[derive(Clone, Debug)]
pub(crate) struct SkinProperties {
    pub(crate) vertices: Vec<LocalSkin>,
    pub(crate) faces: PerFace<LocalSkin>,
}

impl SkinProperties {
    /// `tie` is the tangential stiffness (Pa/m) where it is not the layer's own.
    ///
    /// Samples the layer's map at the vertices; a face has the mean of its corners' properties
    /// (Li 2014, 5.2).
    pub(crate) fn new(
        spec: &LayerSpec,
        nominal: &Wrinkling,
        tie: Option<f64>,
        driver: &Driver,
        skin: &SkinMesh,
    ) -> Result<Self, StepperError> {
        let (vertices, faces) = (skin.mesh.vertex_count(), skin.mesh.face_count());
        let Some(map) = &spec.map else {
            let everywhere = LocalSkin {
                material: spec.material,
                wrinkling: *nominal,
            };
            return Ok(Self {
                vertices: vec![everywhere; vertices],
                faces: PerFace::filled(faces, everywhere),
            });
        };
        let places = skin.points.points().iter();
        let relative: Vec<RelativeProperties> =
            places.map(|place| map.sample(&uv(driver, place))).collect();
        let local = |relative: &RelativeProperties| -> Result<LocalSkin, StepperError> {
            let mut local = local_skin(spec, relative)?;
            if let Some(tie) = tie {
                local.wrinkling.tangential_stiffness = tie;
            }
            Ok(local)
        };
        let corners = skin.mesh.faces().as_slice().iter();
        Ok(Self {
            faces: corners
                .map(|corners| local(&mean(corners.map(|v| relative[v.index()]))))
                .collect::<Result<_, _>>()?,
            vertices: relative.iter().map(local).collect::<Result<_, _>>()?,
        })
    }
}

/// The layer where its map says `relative`.
pub(crate) fn local_skin(
    spec: &LayerSpec,
    relative: &RelativeProperties,
) -> Result<LocalSkin, StepperError> {
    let wrinkling = local_wrinkling(&spec.material, &spec.substrate, spec.model, relative);
    Ok(LocalSkin {
        material: relative.scaled(&spec.material),
        wrinkling: wrinkling.map_err(|source| StepperError::Material {
            layer: spec.name.clone(),
            source,
        })?,
    })
}

/// Texture coordinate of a place of the driver.
pub(crate) fn uv(driver: &Driver, place: &MaterialPoint) -> Vector2<f64> {
    let face: FaceId = place.face;
    let [a, b, c] = driver.uvs()[face];
    let [u, v, w] = place.barycentric;
    a * u + b * v + c * w
}

fn mean(corners: [RelativeProperties; 3]) -> RelativeProperties {
    let of =
        |property: fn(&RelativeProperties) -> f64| corners.iter().map(property).sum::<f64>() / 3.0;
    RelativeProperties {
        wavelength: of(|p| p.wavelength),
        young: of(|p| p.young),
        thickness: of(|p| p.thickness),
    }
}
