//! The frames of a layer as one USD scene with time samples.

use std::fmt::Display;
use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use nalgebra::Vector3;

use crate::layer_frame::{FieldValues, LayerFrame};
use crate::{AtomicFile, IoError};

/// Frames of a layer on their way into a `.usda` file: one mesh prim whose attributes have a sample per frame.
///
/// The frame's number is the time code; lengths are metres, Y is up. Texture coordinates are `primvars:st`, V up;
/// fields are primvars by their names, with the unit in their documentation; `ruga:load` is the fraction of the
/// pose. Triangles and texture coordinates get a new sample only where they change, because USD holds those of
/// the frame before.
///
/// Samples wait in unnamed temporary files, so that a series takes no more memory than a frame. Nothing is in
/// place before [`UsdSeries::finish`].
#[derive(Debug)]
pub struct UsdSeries {
    path: PathBuf,
    name: String,
    attributes: Vec<Attribute>,
    /// Numbers of the first frame and of the last.
    frames: Option<[usize; 2]>,
}

/// Samples of one attribute.
#[derive(Debug)]
struct Attribute {
    /// Type and name, such as `point3f[] points`.
    declaration: String,
    /// What stands in brackets behind it.
    metadata: Vec<String>,
    samples: BufWriter<File>,
    /// Text of the last sample, if it is not written again.
    held: Option<String>,
}

/// How a sample goes on until the next one.
#[derive(Clone, Copy, PartialEq)]
enum Sampling {
    /// It is blended with the next one.
    Blended,
    /// It stays.
    Held,
}

impl UsdSeries {
    /// Begins the file at `path` for a layer of this name.
    pub fn new(path: &Path, name: &str) -> Self {
        Self {
            path: path.to_owned(),
            name: name.to_owned(),
            attributes: Vec::new(),
            frames: None,
        }
    }

    /// Adds a frame, whose number is larger than that of the last one.
    ///
    /// # Errors
    /// [`IoError::Unwritten`] when an index or a number is out of range, an array has another length than the mesh,
    /// or the frame has other fields or no larger number than the last one; [`IoError::Unwritable`] when there is no
    /// room for its samples.
    pub fn add(&mut self, frame: &LayerFrame<'_>) -> Result<(), IoError> {
        let path = self.path.clone();
        let unwritten = |reason: String| IoError::unwritten(&path, reason);
        frame.check().map_err(unwritten)?;
        if self.frames.is_some_and(|[_, last]| frame.number <= last) {
            return Err(unwritten(format!("frame {} comes too late", frame.number)));
        }
        let mut samples = Samples {
            of: self,
            number: frame.number,
            next: 0,
        };
        let outcome = samples.take(frame);
        outcome.map_err(|source| IoError::unwritable(&path, source))?;
        if samples.next != self.attributes.len() {
            return Err(unwritten(
                "a frame has fewer fields than the last".to_owned(),
            ));
        }
        let first = self.frames.map_or(frame.number, |[first, _]| first);
        self.frames = Some([first, frame.number]);
        Ok(())
    }

    /// Writes the file, whole or not at all; a series without frames writes none.
    ///
    /// # Errors
    /// [`IoError::Unwritable`].
    pub fn finish(mut self) -> Result<(), IoError> {
        let Some(frames) = self.frames else {
            return Ok(());
        };
        let mut file = AtomicFile::create(&self.path)?;
        let outcome = self.write(frames, &mut file);
        outcome.map_err(|source| IoError::unwritable(&self.path, source))?;
        file.commit()
    }

    fn write(&mut self, [first, last]: [usize; 2], file: &mut AtomicFile) -> io::Result<()> {
        let prim = identifier(&self.name);
        writeln!(file, "#usda 1.0")?;
        writeln!(file, "(\n    defaultPrim = \"{prim}\"")?;
        writeln!(
            file,
            "    startTimeCode = {first}\n    endTimeCode = {last}"
        )?;
        writeln!(
            file,
            "    framesPerSecond = 24\n    timeCodesPerSecond = 24"
        )?;
        writeln!(file, "    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n")?;
        let name = quoted(&self.name);
        writeln!(
            file,
            "def Mesh \"{prim}\" (\n    displayName = {name}\n)\n{{"
        )?;
        writeln!(file, "    uniform bool doubleSided = 1")?;
        writeln!(file, "    uniform token subdivisionScheme = \"none\"")?;
        for attribute in &mut self.attributes {
            attribute.write(file)?;
        }
        writeln!(file, "}}")
    }
}

/// The samples of one frame, attribute by attribute in the order of a series.
struct Samples<'s> {
    of: &'s mut UsdSeries,
    number: usize,
    next: usize,
}

impl Samples<'_> {
    fn take(&mut self, frame: &LayerFrame<'_>) -> io::Result<()> {
        use Sampling::{Blended, Held};
        let mesh = &frame.mesh;
        let corners = mesh.triangles.iter().flatten();
        self.add(
            "int[] faceVertexCounts",
            &[],
            Held,
            array(mesh.triangles.iter().map(|_| 3)),
        )?;
        self.add("int[] faceVertexIndices", &[], Held, array(corners))?;
        self.add(
            "point3f[] points",
            &[],
            Blended,
            array(mesh.positions.iter().map(vector)),
        )?;
        let low = mesh.positions.iter().copied().reduce(|a, b| a.inf(&b));
        let high = mesh.positions.iter().copied().reduce(|a, b| a.sup(&b));
        let extent = low.iter().chain(&high).map(vector);
        self.add("float3[] extent", &[], Blended, array(extent))?;
        let on_vertices = "interpolation = \"vertex\"";
        let normals = array(frame.normals.iter().map(vector));
        self.add("normal3f[] normals", &[on_vertices], Blended, normals)?;
        let uvs = mesh.uvs.iter().map(|uv| {
            let [u, v] = [uv.x as f32, 1.0 - uv.y as f32];
            format!("({u}, {v})")
        });
        let on_corners = "interpolation = \"faceVarying\"";
        self.add("texCoord2f[] primvars:st", &[on_corners], Held, array(uvs))?;
        let of_corners = mesh.uv_triangles.iter().flatten();
        self.add("int[] primvars:st:indices", &[], Held, array(of_corners))?;
        for field in frame.fields {
            let unit = format!("doc = {}", quoted(&format!("unit: {}", field.unit)));
            let (kind, on, values) = match field.values {
                FieldValues::Vertices(values) => ("float", on_vertices, numbers(values)),
                FieldValues::VertexVectors(values) => {
                    ("vector3f", on_vertices, array(values.iter().map(vector)))
                }
                FieldValues::Faces(values) => {
                    ("float", "interpolation = \"uniform\"", numbers(values))
                }
            };
            let declaration = format!("{kind}[] primvars:{}", field.name);
            self.add(&declaration, &[&unit, on], Blended, values)?;
        }
        self.add(
            "custom double ruga:load",
            &[],
            Blended,
            frame.load.to_string(),
        )
    }

    fn add(
        &mut self,
        declaration: &str,
        metadata: &[&str],
        sampling: Sampling,
        value: String,
    ) -> io::Result<()> {
        if self.of.frames.is_none() {
            let folder = self.of.path.parent().unwrap_or(Path::new(""));
            self.of.attributes.push(Attribute {
                declaration: declaration.to_owned(),
                metadata: metadata.iter().map(|&line| line.to_owned()).collect(),
                samples: BufWriter::new(unnamed(folder)?),
                held: None,
            });
        }
        let attribute = self.of.attributes.get_mut(self.next);
        let Some(attribute) = attribute.filter(|known| known.declaration == declaration) else {
            let reason = format!("`{declaration}` is not what the last frame had");
            return Err(io::Error::other(reason));
        };
        self.next += 1;
        if attribute.held.as_ref() == Some(&value) {
            return Ok(());
        }
        writeln!(attribute.samples, "        {}: {value},", self.number)?;
        attribute.held = (sampling == Sampling::Held).then_some(value);
        Ok(())
    }
}

impl Attribute {
    fn write(&mut self, file: &mut AtomicFile) -> io::Result<()> {
        let declaration = &self.declaration;
        if !self.metadata.is_empty() {
            writeln!(file, "    {declaration} (")?;
            for line in &self.metadata {
                writeln!(file, "        {line}")?;
            }
            writeln!(file, "    )")?;
        }
        writeln!(file, "    {declaration}.timeSamples = {{")?;
        self.samples.flush()?;
        let samples = self.samples.get_mut();
        samples.rewind()?;
        io::copy(samples, file)?;
        writeln!(file, "    }}")
    }
}

/// A file that nobody sees, beside the result: where there is room for that, there is for samples.
fn unnamed(folder: &Path) -> io::Result<File> {
    if folder.as_os_str().is_empty() {
        return tempfile::tempfile_in(".");
    }
    fs::create_dir_all(folder)?;
    tempfile::tempfile_in(folder)
}

fn array(values: impl Iterator<Item = impl Display>) -> String {
    let mut text = String::from("[");
    for (number, value) in values.enumerate() {
        text += if number > 0 { ", " } else { "" };
        text += &value.to_string();
    }
    text + "]"
}

fn numbers(values: &[f64]) -> String {
    array(values.iter().map(|&value| value as f32))
}

fn vector(vector: &Vector3<f64>) -> String {
    let [x, y, z] = [vector.x, vector.y, vector.z].map(|c| c as f32);
    format!("({x}, {y}, {z})")
}

/// A name as USD has them for prims: ASCII letters, digits and `_`, the first one no digit.
fn identifier(name: &str) -> String {
    let part = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = name.chars().map(part).collect();
    match name.starts_with(|c: char| c.is_ascii_digit()) || name.is_empty() {
        true => format!("_{name}"),
        false => name,
    }
}

/// Text as USD writes it, in quotation marks.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
