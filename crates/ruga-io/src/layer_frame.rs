//! One simulated frame of a layer: its mesh, and quantities on it.

use nalgebra::{Vector2, Vector3};

/// The mesh of a simulated layer in one frame.
#[derive(Clone, Copy, Debug)]
pub struct FrameMesh<'a> {
    /// Name of the object.
    pub name: &'a str,
    /// World positions, m.
    pub positions: &'a [Vector3<f64>],
    /// Indices into `positions`, counter-clockwise from outside.
    pub triangles: &'a [[u32; 3]],
    /// Texture coordinates, V pointing down.
    pub uvs: &'a [Vector2<f64>],
    /// Indices into `uvs`, corner by corner with `triangles`; empty when there are none.
    pub uv_triangles: &'a [[u32; 3]],
}

/// A frame of a layer with quantities on its mesh, as one of a series.
#[derive(Clone, Copy, Debug)]
pub struct LayerFrame<'a> {
    /// The mesh.
    pub mesh: FrameMesh<'a>,
    /// Unit normals of its vertices.
    pub normals: &'a [Vector3<f64>],
    /// Number of the frame in its series.
    pub number: usize,
    /// Fraction of the pose, in (0, 1].
    pub load: f64,
    /// Quantities on the mesh, the same ones in every frame of a series.
    pub fields: &'a [Field<'a>],
}

/// A quantity on the mesh of a layer.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    /// Name: letters, digits and `_`, the first one a letter.
    pub name: &'a str,
    /// Unit, such as `m`; `1` for a ratio.
    pub unit: &'a str,
    /// Its values.
    pub values: FieldValues<'a>,
}

/// Values of a quantity.
#[derive(Clone, Copy, Debug)]
pub enum FieldValues<'a> {
    /// A number per vertex.
    Vertices(&'a [f64]),
    /// A vector per vertex.
    VertexVectors(&'a [Vector3<f64>]),
    /// A number per triangle.
    Faces(&'a [f64]),
}

impl FrameMesh<'_> {
    /// What keeps it from being written.
    pub(crate) fn check(&self) -> Result<(), String> {
        let beyond = |triangles: &[[u32; 3]], count: usize| {
            triangles.iter().flatten().any(|i| *i as usize >= count)
        };
        let has_uvs = !self.uv_triangles.is_empty();
        if has_uvs && self.uv_triangles.len() != self.triangles.len() {
            let (uvs, all) = (self.uv_triangles.len(), self.triangles.len());
            return Err(format!("{uvs} UV triangles for {all} triangles"));
        }
        if beyond(self.triangles, self.positions.len()) || beyond(self.uv_triangles, self.uvs.len())
        {
            return Err("an index reaches past its array".to_owned());
        }
        let finite = self.positions.iter().flatten().all(|x| x.is_finite())
            && self.uvs.iter().flatten().all(|x| x.is_finite());
        if !finite || self.name.contains(['\n', '\r']) {
            return Err("a coordinate is not finite, or the name is more than a line".to_owned());
        }
        Ok(())
    }
}

impl LayerFrame<'_> {
    /// What keeps it from being written.
    pub(crate) fn check(&self) -> Result<(), String> {
        self.mesh.check()?;
        let (vertices, faces) = (self.mesh.positions.len(), self.mesh.triangles.len());
        if !self.load.is_finite() {
            return Err(format!("a load of {}", self.load));
        }
        let normals = Field {
            name: "normals",
            unit: "1",
            values: FieldValues::VertexVectors(self.normals),
        };
        for field in self.fields.iter().chain([&normals]) {
            let (found, expected, is_finite) = match field.values {
                FieldValues::Vertices(v) => (v.len(), vertices, v.iter().all(|x| x.is_finite())),
                FieldValues::Faces(v) => (v.len(), faces, v.iter().all(|x| x.is_finite())),
                FieldValues::VertexVectors(v) => {
                    let is_finite = v.iter().flatten().all(|x| x.is_finite());
                    (v.len(), vertices, is_finite)
                }
            };
            let name = field.name;
            if found != expected {
                return Err(format!(
                    "`{name}` has {found} values for {expected} elements"
                ));
            }
            if !is_finite {
                return Err(format!("`{name}` has a value that is not finite"));
            }
            if !is_identifier(name) {
                return Err(format!("`{name}` is no name of a field"));
            }
        }
        Ok(())
    }
}

/// Whether a name consists of ASCII letters, digits and `_`, the first one no digit.
fn is_identifier(name: &str) -> bool {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    !name.starts_with(|c: char| c.is_ascii_digit()) && !name.is_empty() && name.chars().all(is_part)
}
