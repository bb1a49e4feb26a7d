//! Lines of an OBJ object: its `l` elements.
//!
//! tobj makes polygons of those with more than two vertices, so they are read here.

use std::path::Path;

use nalgebra::{Matrix4, Vector3};

use crate::error::read_bytes;
use crate::gltf_uri::shortened;
use crate::line_curves::FoundLines;
use crate::line_joining::LineElement;
use crate::obj_mesh::UNNAMED;
use crate::{IoError, LengthUnit};

/// Reads the `l` elements of the object or group of that name.
///
/// One of two vertices is an edge to be joined to others, as Blender writes them; one of more is a
/// polyline.
pub(crate) fn read_obj_lines(
    path: &Path,
    name: &str,
    unit: LengthUnit,
) -> Result<FoundLines, IoError> {
    let bytes = read_bytes(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let mut reader = LineReader::new(name);
    for (index, line) in text.lines().enumerate() {
        let number = index + 1;
        reader
            .read(number, line)
            .map_err(|reason| malformed(path, number, reason))?;
    }
    if !reader.is_found {
        return Err(IoError::unknown_mesh(path, name, reader.names));
    }
    let resolved = reader.lines.iter().map(|line| {
        let element = reader.resolve(line);
        element.map_err(|reason| malformed(path, line.number, reason))
    });
    Ok(FoundLines {
        elements: resolved.collect::<Result<_, _>>()?,
        world_from_lines: Matrix4::new_scaling(unit.metres()),
        has_faces: reader.has_faces,
    })
}

fn malformed(path: &Path, line: usize, reason: String) -> IoError {
    IoError::malformed(path, format!("line {line}"), reason)
}

/// An `l` element before all vertices are known.
struct Line {
    /// Its line in the file, from 1.
    number: usize,
    /// Vertices before it, which negative indices count back from.
    so_far: usize,
    indices: Vec<i64>,
}

struct LineReader<'a> {
    name: &'a str,
    object: &'a str,
    group: &'a str,
    vertices: Vec<Vector3<f64>>,
    lines: Vec<Line>,
    has_faces: bool,
    is_found: bool,
    /// Objects and groups of the file, in order.
    names: Vec<String>,
}

impl<'a> LineReader<'a> {
    fn new(name: &'a str) -> Self {
        Self {
            name,
            object: UNNAMED,
            group: "",
            vertices: Vec::new(),
            lines: Vec::new(),
            has_faces: false,
            is_found: false,
            names: Vec::new(),
        }
    }

    fn read(&mut self, number: usize, text: &'a str) -> Result<(), String> {
        let text = text.trim();
        let (word, rest) = text
            .split_once(|c: char| c.is_ascii_whitespace())
            .unwrap_or((text, ""));
        let rest = rest.trim();
        match word {
            "v" => self.vertices.push(vertex(rest)?),
            "o" if rest.is_empty() => self.enter(UNNAMED, ""),
            "o" => self.enter(rest, ""),
            "g" => self.enter(self.object, rest),
            "l" | "f" => {
                self.note_unnamed();
                if self.is_selected() {
                    self.has_faces |= word == "f";
                    if word == "l" {
                        self.add_line(number, rest)?;
                    }
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// A new object ends the group before it.
    fn enter(&mut self, object: &'a str, group: &'a str) {
        (self.object, self.group) = (object, group);
        let entered = if group.is_empty() { object } else { group };
        if entered != UNNAMED {
            self.note(entered);
        }
        self.is_found |= self.is_selected();
    }

    /// Elements before any name belong to an object that [`read_mesh`](crate::read_mesh) calls so.
    fn note_unnamed(&mut self) {
        if self.object == UNNAMED && self.group.is_empty() {
            self.note(UNNAMED);
            self.is_found |= self.is_selected();
        }
    }

    fn note(&mut self, name: &str) {
        if !name.is_empty() && self.names.last().is_none_or(|last| last != name) {
            self.names.push(name.to_owned());
        }
    }

    /// A `g` may name several groups, or one with spaces in its name.
    fn is_selected(&self) -> bool {
        let mut groups = self.group.split_ascii_whitespace();
        [self.object, self.group].contains(&self.name) || groups.any(|group| group == self.name)
    }

    fn add_line(&mut self, number: usize, text: &str) -> Result<(), String> {
        let corners = text.split_ascii_whitespace();
        let corners = corners.take_while(|corner| !corner.starts_with('#'));
        let indices = corners.map(vertex_index).collect::<Result<Vec<_>, _>>()?;
        if indices.len() < 2 {
            let count = indices.len();
            return Err(format!("`l` names {count} of at least 2 vertices"));
        }
        self.lines.push(Line {
            number,
            so_far: self.vertices.len(),
            indices,
        });
        Ok(())
    }

    fn resolve(&self, line: &Line) -> Result<LineElement, String> {
        let points = line.indices.iter().map(|index| self.point(*index, line));
        let points = points.collect::<Result<Vec<_>, _>>()?;
        Ok(match points[..] {
            [a, b] => LineElement::Pair([a, b]),
            _ => LineElement::Strip(points),
        })
    }

    fn point(&self, index: i64, line: &Line) -> Result<Vector3<f64>, String> {
        let distance = usize::try_from(index.unsigned_abs()).unwrap_or(usize::MAX);
        let place = match index {
            0.. => distance.checked_sub(1),
            _ => line.so_far.checked_sub(distance),
        };
        let count = self.vertices.len();
        let point = place.and_then(|place| self.vertices.get(place));
        let point = point.ok_or_else(|| {
            format!(
                "line index {index}: the file has {count} vertices; accepted: 1 to {count}, or \
                 negative numbers that count back from the line"
            )
        })?;
        match point.iter().all(|c| c.is_finite()) {
            true => Ok(*point),
            false => Err(format!(
                "a coordinate of vertex {index} is not a finite number"
            )),
        }
    }
}

/// The position; a fourth number is a weight, more are colours.
fn vertex(text: &str) -> Result<Vector3<f64>, String> {
    let numbers = text.split_ascii_whitespace().take(3);
    let numbers: Vec<f64> = numbers.filter_map(|word| word.parse().ok()).collect();
    match numbers[..] {
        [x, y, z] => Ok(Vector3::new(x, y, z)),
        _ => Err(format!(
            "`v {}` does not begin with three numbers",
            shortened(text)
        )),
    }
}

/// The vertex of a corner such as `3` or `-1/2`.
fn vertex_index(corner: &str) -> Result<i64, String> {
    let index = corner.split('/').next().unwrap_or_default();
    let fault = |_| format!("`{}` is not the number of a vertex", shortened(corner));
    index.parse().map_err(fault)
}
