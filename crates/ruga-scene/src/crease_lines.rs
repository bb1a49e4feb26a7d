//! Where the creases of a scene lie on its mesh.

use std::path::Path;

use nalgebra::Vector2;
use ruga_crease::{
    CreaseError, GreyImage, LineInput, LineTracer, SkeletonLine, SkeletonSettings, TracedLine,
    skeleton_lines,
};
use ruga_io::{ObjOptions, read_line_curves, read_mask};
use ruga_mesh::{FaceId, VertexId};

use crate::SceneError;
use crate::creases::CreasedMesh;
use crate::file::Crease;
use crate::painted_files::tile_files;

/// The key that says where a crease lies.
pub(crate) fn source_of(crease: &Crease) -> &'static str {
    match (&crease.image, &crease.line_mesh, crease.edges.is_empty()) {
        (Some(_), ..) => "image",
        (None, Some(_), _) => "line_mesh",
        (None, None, true) => "uv",
        (None, None, false) => "edges",
    }
}

impl CreasedMesh<'_> {
    /// The lines of a crease of a layer with waves of this length (m) and mesh edges of length `edge` (m), and a
    /// warning about those that are left out.
    pub(crate) fn lines(
        &self,
        numbered: (usize, &Crease),
        [wavelength, edge]: [f64; 2],
    ) -> Result<(Vec<TracedLine>, Option<String>), SceneError> {
        let (_, crease) = numbered;
        match (&crease.image, &crease.line_mesh) {
            (Some(image), _) => self.painted(numbered, image, edge),
            (None, Some(name)) => Ok((self.curves(numbered, name, wavelength)?, None)),
            (None, None) => Ok((vec![self.line(numbered)?], None)),
        }
    }

    /// The lines of another mesh or object of the mesh's file, projected to the mesh.
    fn curves(
        &self,
        (number, crease): (usize, &Crease),
        name: &str,
        wavelength: f64,
    ) -> Result<Vec<TracedLine>, SceneError> {
        let key = format!("creases[{number}].line_mesh");
        let options = ObjOptions {
            length_unit: self.scene.length_unit,
            ..ObjOptions::default()
        };
        let curves = read_line_curves(self.mesh, name, &options);
        let curves = curves.map_err(|source| SceneError::NamedFile {
            scene: self.path.to_owned(),
            key: key.clone(),
            source: Box::new(source),
        })?;
        let tracer = self.tracer();
        let trace = |curve: ruga_io::LineCurve| {
            let line = LineInput::Positions {
                points: curve.points,
                is_closed: curve.is_closed,
                reach: crease.reach.unwrap_or(wavelength),
                corners: corners(crease),
            };
            let traced = tracer.trace(&line);
            traced.map_err(|error| {
                let error = self.in_file(error, &[]);
                self.fault(key.clone(), format!("`{name}`: {error}"), None)
            })
        };
        curves.into_iter().map(trace).collect()
    }

    /// The line of a crease by texture coordinates or vertices.
    fn line(&self, (number, crease): (usize, &Crease)) -> Result<TracedLine, SceneError> {
        let key = format!("creases[{number}].{}", source_of(crease));
        let line = match crease.edges.is_empty() {
            true => LineInput::Uv {
                points: crease.uv.iter().map(|uv| (*uv).into()).collect(),
                is_closed: crease.closed,
                corners: corners(crease),
            },
            false => LineInput::Edges {
                vertices: self.welded(&key, &crease.edges)?,
            },
        };
        let traced = self.tracer().trace(&line);
        traced.map_err(|error| {
            let error = self.in_file(error, &crease.edges);
            let key = match place_of(&error) {
                Some(point) => format!("{key}[{point}]"),
                None => key,
            };
            self.fault(key, format!("{error}{}", self.way_round(&error)), None)
        })
    }

    /// What else may have to be done about an error: a triangle without area is left out, and in the texture there is a
    /// gap in its place.
    fn way_round(&self, error: &CreaseError) -> String {
        let is_gap = matches!(
            error,
            CreaseError::AcrossSeam { .. }
                | CreaseError::LeavesSurface { .. }
                | CreaseError::OutsideUv { .. }
        );
        match self.driver.degenerate_triangles() {
            [first, others @ ..] if is_gap => {
                let others = match others.len() {
                    0 => String::new(),
                    more => format!(" or another of {}", more + 1),
                };
                format!(
                    "; if triangle {first}{others} without area is left out there, lead the line round it"
                )
            }
            _ => String::new(),
        }
    }

    pub(crate) fn tracer(&self) -> &LineTracer<'_> {
        let driver = self.driver;
        self.tracer.get_or_init(|| {
            LineTracer::new(driver.topology(), driver.rest()).with_uvs(driver.uvs())
        })
    }

    /// The welded vertices of some of the file's.
    fn welded(&self, key: &str, vertices: &[u32]) -> Result<Vec<VertexId>, SceneError> {
        let welded = self.driver.welded();
        let vertex = |(i, v): (usize, &u32)| {
            let found = welded.get(*v as usize).copied();
            found.ok_or_else(|| {
                let reason = format!(
                    "found vertex {v}; accepted: 0 to {}, the vertices of the mesh file",
                    welded.len().saturating_sub(1)
                );
                self.fault(format!("{key}[{i}]"), reason, None)
            })
        };
        let found = vertices.iter().enumerate().map(vertex);
        let mut path: Vec<VertexId> = found.collect::<Result<_, _>>()?;
        // The file may have a vertex twice, on both sides of a seam.
        path.dedup();
        Ok(path)
    }

    /// An error with the triangles and vertices of the file in place of the welded mesh's; `path` are the file's
    /// vertices along the line.
    fn in_file(&self, mut error: CreaseError, path: &[u32]) -> CreaseError {
        let triangle = |face: &mut u32| *face = self.driver.triangles()[FaceId(*face)];
        match &mut error {
            CreaseError::OverlappingCharts { faces, .. } => faces.iter_mut().for_each(triangle),
            CreaseError::AcrossSeam { face, .. }
            | CreaseError::LeavesSurface { face, .. }
            | CreaseError::AlongBorder { face }
            | CreaseError::DegenerateFace { face } => triangle(face),
            CreaseError::NotAnEdge { vertices } => {
                let welded = |v: u32| self.driver.welded()[v as usize].0;
                let is_it = |pair: &&[u32]| [welded(pair[0]), welded(pair[1])] == *vertices;
                if let Some(&[from, to]) = path.windows(2).find(is_it) {
                    *vertices = [from, to];
                }
            }
            _ => {}
        }
        error
    }

    /// The lines of an image, and a warning about strokes that are left out because they are too short for a mesh
    /// with edges of length `edge` (m).
    fn painted(
        &self,
        (number, crease): (usize, &Crease),
        image: &Path,
        edge: f64,
    ) -> Result<(Vec<TracedLine>, Option<String>), SceneError> {
        let key = format!("creases[{number}].image");
        let tracer = self.tracer();
        let mut lines = Vec::new();
        let mut empty = None;
        for (tile, file) in tile_files(image, self.tiles) {
            let strokes = match self.drawn((&key, &file))? {
                Ok(strokes) => strokes,
                // Of several tiles only some may have lines.
                Err(error @ CreaseError::NoLineInImage { .. }) => {
                    empty.get_or_insert((file, error));
                    continue;
                }
                Err(error) => return Err(self.bad_image(&key, &file, error)),
            };
            for stroke in strokes {
                let points: Vec<_> = stroke.points.iter().map(|uv| tile.place(uv)).collect();
                let line = LineInput::Uv {
                    points: points.clone(),
                    is_closed: stroke.is_closed,
                    corners: corners(crease),
                };
                let traced = tracer.trace(&line).map_err(|error| {
                    let error = self.in_file(error, &[]);
                    self.bad_image(&key, &file, of_stroke(&error, &points))
                })?;
                lines.push(traced);
            }
        }
        if let (true, Some((file, error))) = (lines.is_empty(), empty) {
            return Err(self.bad_image(&key, &file, without_line(&error)));
        }
        let all = lines.len();
        let longest = lines.iter().map(TracedLine::length).fold(0.0, f64::max);
        // If all are too short, the longest is told of as a line that was given alone.
        lines.retain(|line| !line.is_too_short(edge) || line.length() == longest);
        let warning = (lines.len() < all).then(|| {
            format!(
                "crease `{}`: {} of {all} strokes in {} left out, because they are shorter than two edges of \
                 the mesh, which are {:.2} mm",
                crease.name,
                all - lines.len(),
                image.display(),
                1e3 * edge
            )
        });
        Ok((lines, warning))
    }

    fn bad_image(&self, key: &str, file: &Path, reason: impl std::fmt::Display) -> SceneError {
        self.fault(
            key.to_owned(),
            format!("{}: {reason}", file.display()),
            None,
        )
    }

    /// The middle lines of what is painted in an image.
    fn drawn(
        &self,
        (key, file): (&str, &Path),
    ) -> Result<Result<Vec<SkeletonLine>, CreaseError>, SceneError> {
        let image = read_mask(file).map_err(|source| SceneError::NamedFile {
            scene: self.path.to_owned(),
            key: key.to_owned(),
            source: Box::new(source),
        })?;
        let grey = GreyImage {
            width: image.width,
            height: image.height,
            values: &image.values,
        };
        Ok(skeleton_lines(&grey, &SkeletonSettings::default()))
    }
}

fn corners(crease: &Crease) -> ruga_crease::Corners {
    match crease.corners {
        crate::file::Corners::Round => ruga_crease::Corners::Round,
        crate::file::Corners::Keep => ruga_crease::Corners::Keep,
    }
}

/// Why an image shows no line: what is as bright as one may still be no stroke.
fn without_line(error: &CreaseError) -> String {
    let CreaseError::NoLineInImage { bright, threshold } = *error else {
        return error.to_string();
    };
    let least = (100.0 * threshold).round();
    let why = match bright {
        0 => return error.to_string(),
        1 => format!("only 1 texel is as bright as {least} %, and a line needs several in a row"),
        more => format!("{more} texels are as bright as {least} %, but too few of them in a row"),
    };
    format!("the image shows no line: {why}; paint lines white on black")
}

/// Number of the point at which, or after which, a line is wrong.
fn place_of(error: &CreaseError) -> Option<usize> {
    match *error {
        CreaseError::NotFinite { point }
        | CreaseError::OutsideUv { point, .. }
        | CreaseError::OverlappingCharts { point, .. } => Some(point),
        CreaseError::AcrossSeam { leg, .. }
        | CreaseError::LeavesSurface { leg, .. }
        | CreaseError::NoWay { leg } => Some(leg),
        _ => None,
    }
}

/// What is wrong with a stroke of an image, whose points nobody has numbered.
fn of_stroke(error: &CreaseError, points: &[Vector2<f64>]) -> String {
    let near = place_of(error).or(Some(0)).and_then(|i| points.get(i));
    let near = near.map_or(String::new(), |uv| {
        format!("near UV ({:.3}, {:.3}) ", uv.x, uv.y)
    });
    match error {
        CreaseError::OutsideUv { .. } => {
            format!(
                "{near}a stroke lies outside the islands of the texture layout; paint it inside them"
            )
        }
        CreaseError::AcrossSeam { face, .. } => format!(
            "{near}a stroke crosses a UV seam at triangle {face}; paint it in one island, or give the line by `uv` or `edges`"
        ),
        CreaseError::LeavesSurface { face, .. } => {
            format!("{near}a stroke leaves the surface at triangle {face}; keep it on the skin")
        }
        CreaseError::OverlappingCharts { faces: [a, b], .. } => format!(
            "{near}a stroke lies in triangles {a} and {b}, which overlap in the texture layout; give the line by `edges`, or move one of the islands"
        ),
        other => format!("{near}is a stroke that cannot be used: {other}"),
    }
}
