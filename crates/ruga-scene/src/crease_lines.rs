//! Where the creases of a scene lie on its mesh.

use ruga_crease::{CreaseError, LineInput, LineTracer, TracedLine};
use ruga_io::{ObjOptions, read_line_curves};
use ruga_mesh::{FaceId, VertexId};

use crate::SceneError;
use crate::creases::CreasedMesh;
use crate::file::Crease;

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
    /// The lines of a crease of a layer with waves of this length (m) and mesh edges of length `edge` (m), and
    /// warnings about those that are left out.
    pub(crate) fn lines(
        &self,
        numbered: (usize, &Crease),
        [wavelength, edge]: [f64; 2],
    ) -> Result<(Vec<TracedLine>, Vec<String>), SceneError> {
        let (_, crease) = numbered;
        match (&crease.image, &crease.line_mesh) {
            (Some(image), _) => self.painted(numbered, image, [wavelength, edge]),
            (None, Some(name)) => Ok((self.curves(numbered, name, wavelength)?, Vec::new())),
            (None, None) => Ok((vec![self.line(numbered)?], Vec::new())),
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
            let key = match error.point() {
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
    pub(crate) fn in_file(&self, mut error: CreaseError, path: &[u32]) -> CreaseError {
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
}

pub(crate) fn corners(crease: &Crease) -> ruga_crease::Corners {
    match crease.corners {
        crate::file::Corners::Round => ruga_crease::Corners::Round,
        crate::file::Corners::Keep => ruga_crease::Corners::Keep,
    }
}
