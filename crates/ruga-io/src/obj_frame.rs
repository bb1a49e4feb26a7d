//! One simulated frame as OBJ.

use std::fmt::{self, Write};
use std::path::Path;

use nalgebra::{Vector2, Vector3};

use crate::{IoError, write_atomically};

/// A simulated layer in one frame.
#[derive(Clone, Copy, Debug)]
pub struct ObjFrame<'a> {
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

/// Writes a frame: `v` in metres to the nanometre, `vt` with V pointing up, as OBJ has it.
///
/// # Errors
/// [`IoError::Unwritten`] when an index or a number is out of range, [`IoError::Unwritable`] when
/// the file cannot be written.
pub fn write_obj_frame(path: &Path, frame: &ObjFrame<'_>) -> Result<(), IoError> {
    check(frame).map_err(|reason| IoError::unwritten(path, reason))?;
    let mut text = String::with_capacity(64 * frame.positions.len());
    write_text(&mut text, frame).map_err(|error| IoError::unwritten(path, error.to_string()))?;
    write_atomically(path, text.as_bytes())
}

fn check(frame: &ObjFrame<'_>) -> Result<(), String> {
    let beyond = |triangles: &[[u32; 3]], count: usize| {
        triangles.iter().flatten().any(|i| *i as usize >= count)
    };
    let has_uvs = !frame.uv_triangles.is_empty();
    if has_uvs && frame.uv_triangles.len() != frame.triangles.len() {
        let (uvs, all) = (frame.uv_triangles.len(), frame.triangles.len());
        return Err(format!("{uvs} UV triangles for {all} triangles"));
    }
    if beyond(frame.triangles, frame.positions.len()) || beyond(frame.uv_triangles, frame.uvs.len())
    {
        return Err("an index reaches past its array".to_owned());
    }
    let finite = frame.positions.iter().flatten().all(|x| x.is_finite())
        && frame.uvs.iter().flatten().all(|x| x.is_finite());
    if !finite || frame.name.contains(['\n', '\r']) {
        return Err("a coordinate is not finite, or the name is more than a line".to_owned());
    }
    Ok(())
}

fn write_text(text: &mut String, frame: &ObjFrame<'_>) -> fmt::Result {
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
