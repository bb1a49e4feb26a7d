//! Which texture coordinates a material's maps use, and how they are transformed.

use gltf::json::extensions::texture::TextureTransform;
use gltf::json::material::{Material, NormalTexture};
use gltf::json::texture;
use nalgebra::Vector2;
use serde_json::Value;

use crate::MapCoordinates;

/// A set of texture coordinates with the transform that a material lays over it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TexCoord {
    /// The `n` of `TEXCOORD_n`.
    pub(crate) set: u32,
    offset: Vector2<f64>,
    rotation: f64,
    scale: Vector2<f64>,
}

impl TexCoord {
    /// The sets to look for, best first: the normal texture's, the base colour's, the first.
    pub(crate) fn candidates(material: Option<&Material>) -> Vec<Self> {
        let normal = material.and_then(|m| m.normal_texture.as_ref());
        let color = material.and_then(|m| m.pbr_metallic_roughness.base_color_texture.as_ref());
        normal
            .map(Self::of_normal_texture)
            .into_iter()
            .chain(color.map(Self::of_texture))
            .chain([Self::plain(0)])
            .collect()
    }

    /// The coordinates as `wrinkles.json` says them of a primitive.
    pub(crate) fn of_maps(&self, primitive: usize) -> MapCoordinates {
        let plain = Self::plain(self.set);
        MapCoordinates {
            set: self.set,
            offset: (self.offset != plain.offset).then(|| self.offset.into()),
            rotation: (self.rotation != plain.rotation).then_some(self.rotation),
            scale: (self.scale != plain.scale).then(|| self.scale.into()),
            ..MapCoordinates::plain(primitive)
        }
    }

    fn plain(set: u32) -> Self {
        Self {
            set,
            offset: Vector2::zeros(),
            rotation: 0.0,
            scale: Vector2::repeat(1.0),
        }
    }

    fn of_normal_texture(info: &NormalTexture) -> Self {
        // The gltf crate knows this extension on ordinary textures only.
        let transform = info
            .extensions
            .as_ref()
            .and_then(|extensions| extensions.others.get("KHR_texture_transform"))
            .and_then(|value: &Value| serde_json::from_value(value.clone()).ok());
        Self::transformed(info.tex_coord, transform.as_ref())
    }

    fn of_texture(info: &texture::Info) -> Self {
        let transform = info
            .extensions
            .as_ref()
            .and_then(|extensions| extensions.texture_transform.as_ref());
        Self::transformed(info.tex_coord, transform)
    }

    fn transformed(set: u32, transform: Option<&TextureTransform>) -> Self {
        let Some(transform) = transform else {
            return Self::plain(set);
        };
        let [x, y] = transform.offset.0.map(f64::from);
        let [sx, sy] = transform.scale.0.map(f64::from);
        Self {
            set: transform.tex_coord.unwrap_or(set),
            offset: Vector2::new(x, y),
            rotation: f64::from(transform.rotation.0),
            scale: Vector2::new(sx, sy),
        }
    }

    /// The coordinates that address the texture.
    ///
    /// `uv' = offset + R scale uv`, `R` counter-clockwise as seen, with V pointing down: the sense
    /// of the extension's worked example, opposite to its GLSL listing.
    pub(crate) fn apply(&self, uv: [f64; 2]) -> Vector2<f64> {
        let (sin, cos) = self.rotation.sin_cos();
        let scaled = self.scale.component_mul(&Vector2::from(uv));
        let turned = Vector2::new(
            cos * scaled.x + sin * scaled.y,
            cos * scaled.y - sin * scaled.x,
        );
        self.offset + turned
    }
}
