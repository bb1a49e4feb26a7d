//! One simulated frame as OBJ.

use std::fmt::{self, Write};
use std::path::Path;

use nalgebra::Vector3;

use crate::{FrameMesh, IoError, read_bytes, write_atomically};

/// Writes a frame: `v` in metres to the nanometre, `vt` with V pointing up, as OBJ has it.
///
/// # Errors
/// [`IoError::Unwritten`] when an index or a number is out of range, [`IoError::Unwritable`] when
/// the file cannot be written.
pub fn write_obj_frame(path: &Path, frame: &FrameMesh<'_>) -> Result<(), IoError> {
    frame
        .check()
        .map_err(|reason| IoError::unwritten(path, reason))?;
    let mut text = String::with_capacity(64 * frame.positions.len());
    write_text(&mut text, frame).map_err(|error| IoError::unwritten(path, error.to_string()))?;
    write_atomically(path, text.as_bytes())
}

/// Positions of the vertices of a frame that was written, m.
///
/// # Errors
/// [`IoError::Unreadable`]; [`IoError::Malformed`] for a vertex that has not three finite numbers.
pub fn read_obj_positions(path: &Path) -> Result<Vec<Vector3<f64>>, IoError> {
    let bytes = read_bytes(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let vertices = text.lines().enumerate();
    let vertices = vertices.filter_map(|(at, line)| Some((at, line.strip_prefix("v ")?)));
    let position = |(at, line): (usize, &str)| {
        let numbers = line.split_whitespace().map(str::parse::<f64>);
        let numbers: Vec<f64> = numbers.map_while(Result::ok).collect();
        match numbers.as_slice() {
            [x, y, z] if numbers.iter().all(|n| n.is_finite()) => Ok(Vector3::new(*x, *y, *z)),
            _ => {
                let reason = "a vertex of a frame has three finite numbers";
                Err(IoError::malformed(path, format!("line {}", at + 1), reason))
            }
        }
    };
    vertices.map(position).collect()
}

fn write_text(text: &mut String, frame: &FrameMesh<'_>) -> fmt::Result {
    writeln!(text, "o {}", frame.name)?;
    for p in frame.positions {
        writeln!(text, "v {:.9} {:.9} {:.9}", p.x, p.y, p.z)?;
    }
    for uv in frame.uvs {
        writeln!(text, "vt {:.9} {:.9}", uv.x, 1.0 - uv.y)?;
    }
    for (i, triangle) in frame.triangles.iter().enumerate() {
        let [a, b, c] = triangle.map(|corner| corner + 1);
        match frame.uv_triangles.get(i) {
            Some(uvs) => {
                let [s, t, u] = uvs.map(|corner| corner + 1);
                writeln!(text, "f {a}/{s} {b}/{t} {c}/{u}")?;
            }
            None => writeln!(text, "f {a} {b} {c}")?,
        }
    }
    Ok(())
}
