//! Frames for ParaView: a VTU file each, and a PVD file that lists them.

use std::fmt::Write;
use std::path::Path;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;

use crate::layer_frame::{FieldValues, LayerFrame};
use crate::{IoError, write_atomically};

/// Number of the triangle among VTK's types of cells.
const TRIANGLE: u8 = 5;

/// Writes a frame as a VTK XML file of an unstructured grid, version 1.0.
///
/// Points are in metres (64 bits). Normals and fields of vertices are point data, those of triangles cell data, by
/// their names and with their units (32 bits); `load` is field data. Arrays are inline, in base64.
///
/// # Errors
/// [`IoError::Unwritten`] when an index or a number is out of range or an array has another length than the mesh,
/// [`IoError::Unwritable`] when the file cannot be written.
pub fn write_vtu(path: &Path, frame: &LayerFrame<'_>) -> Result<(), IoError> {
    let unwritten = |reason| IoError::unwritten(path, reason);
    frame.check().map_err(unwritten)?;
    write_atomically(path, vtu_text(frame).as_bytes())
}

/// Writes a list of frames for ParaView: the time of each, and its file relative to `path`.
///
/// # Errors
/// [`IoError::Unwritable`].
pub fn write_pvd(path: &Path, frames: &[(f64, String)]) -> Result<(), IoError> {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n",
    );
    for (time, file) in frames {
        let file = escaped(file);
        text += &format!("<DataSet timestep=\"{time}\" part=\"0\" file=\"{file}\"/>\n");
    }
    text += "</Collection>\n</VTKFile>\n";
    write_atomically(path, text.as_bytes())
}

fn vtu_text(frame: &LayerFrame<'_>) -> String {
    let mesh = &frame.mesh;
    let mut text = Elements(String::from("<?xml version=\"1.0\"?>\n"));
    text.open(
        "VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"",
    );
    text.open("UnstructuredGrid");
    text.open("FieldData");
    text.floats_64("load", " NumberOfTuples=\"1\"", [frame.load]);
    text.close("FieldData");
    let (points, cells) = (mesh.positions.len(), mesh.triangles.len());
    text.open(&format!(
        "Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\""
    ));
    text.open("Points");
    let vectors = " NumberOfComponents=\"3\"";
    let coordinates = mesh.positions.iter().flatten().copied();
    text.floats_64("Points", vectors, coordinates);
    text.close("Points");
    text.open("Cells");
    let corners = mesh.triangles.iter().flatten();
    let corners = corners.map(|&corner| i64::from(corner).to_le_bytes());
    text.array(["Int64", "connectivity", ""], "", corners);
    let ends = (1..=cells as i64).map(|cell| (3 * cell).to_le_bytes());
    text.array(["Int64", "offsets", ""], "", ends);
    text.array(
        ["UInt8", "types", ""],
        "",
        mesh.triangles.iter().map(|_| [TRIANGLE]),
    );
    text.close("Cells");
    text.open("PointData Normals=\"normals\"");
    let normals = frame.normals.iter().flatten().copied();
    text.floats(["Float32", "normals", vectors], "1", normals);
    for field in frame.fields {
        match field.values {
            FieldValues::Vertices(values) => {
                let kind = ["Float32", field.name, ""];
                text.floats(kind, field.unit, values.iter().copied());
            }
            FieldValues::VertexVectors(values) => {
                let kind = ["Float32", field.name, vectors];
                text.floats(kind, field.unit, values.iter().flatten().copied());
            }
            FieldValues::Faces(_) => {}
        }
    }
    text.close("PointData");
    text.open("CellData");
    for field in frame.fields {
        if let FieldValues::Faces(values) = field.values {
            let kind = ["Float32", field.name, ""];
            text.floats(kind, field.unit, values.iter().copied());
        }
    }
    text.close("CellData");
    text.close("Piece");
    text.close("UnstructuredGrid");
    text.close("VTKFile");
    text.0
}

/// XML text that grows by elements.
struct Elements(String);

impl Elements {
    fn open(&mut self, element: &str) {
        self.0 += &format!("<{element}>\n");
    }

    fn close(&mut self, name: &str) {
        self.0 += &format!("</{name}>\n");
    }

    fn floats_64(&mut self, name: &str, shape: &str, values: impl IntoIterator<Item = f64>) {
        let values = values.into_iter().map(f64::to_le_bytes);
        self.array(["Float64", name, shape], "", values);
    }

    fn floats(&mut self, kind: [&str; 3], unit: &str, values: impl Iterator<Item = f64>) {
        self.array(kind, unit, values.map(|value| (value as f32).to_le_bytes()));
    }

    /// An array of a type, a name and a shape, in attributes; a unit that is not empty is told in VTK's way.
    fn array<const BYTES: usize>(
        &mut self,
        [kind, name, shape]: [&str; 3],
        unit: &str,
        values: impl Iterator<Item = [u8; BYTES]>,
    ) {
        let data: Vec<u8> = values.flatten().collect();
        let mut block = (data.len() as u64).to_le_bytes().to_vec();
        block.extend(data);
        self.open(&format!(
            "DataArray type=\"{kind}\" Name=\"{name}\"{shape} format=\"binary\""
        ));
        BASE64_STANDARD.encode_string(&block, &mut self.0);
        self.0.push('\n');
        if !unit.is_empty() {
            let unit = escaped(unit);
            // Writing to a string does not fail.
            let _ = writeln!(
                self.0,
                "<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{unit}</InformationKey>"
            );
        }
        self.close("DataArray");
    }
}

/// Text as it stands in XML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}
