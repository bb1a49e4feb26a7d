//! Files of the load steps of a pose: one each, and series that grow with them.

use std::collections::BTreeMap;
use std::mem;
use std::path::Path;

use clap::ValueEnum;
use nalgebra::{Vector2, Vector3};
use ruga_io::{Field, FieldValues, FrameMesh, LayerFrame, UsdSeries, write_pvd, write_vtu};
use ruga_mesh::{TriMesh, vertex_normals};
use ruga_scene::Placement;
use ruga_stepper::{FaceState, Frame, LayerSurface};

use crate::error::CliError;
use crate::pose_record::PoseRecord;

/// File format of load steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FrameFormat {
    /// Meshes with texture coordinates.
    Obj,
    /// Meshes with fields, and a .pvd file that lists them, for ParaView.
    Vtu,
    /// One mesh per layer with fields, a time sample per load step (USD).
    Usda,
    /// The mesh of the scene as a sheet moves it, animated (glTF).
    Glb,
}

impl FrameFormat {
    /// Whether its files hold more than meshes.
    pub(crate) fn has_fields(self) -> bool {
        matches!(self, Self::Vtu | Self::Usda)
    }

    fn extension(self) -> &'static str {
        match self {
            Self::Obj => ".obj",
            Self::Vtu => ".vtu",
            Self::Usda => ".usda",
            Self::Glb => ".glb",
        }
    }

    /// Whether a pose has its load steps in this format; one in which nothing wrinkles has none.
    pub(crate) fn is_in(self, record: &PoseRecord) -> bool {
        let is_of_pose =
            |file: &String| file.starts_with("frames/") && file.ends_with(self.extension());
        record.report.frames == 0 || record.files.iter().any(is_of_pose)
    }
}

/// A quantity on triangles: its name, its unit, and where it stands.
type StateField = (&'static str, &'static str, fn(&FaceState) -> f64);

/// Quantities on the triangles of a layer, as files name them.
const STATE_FIELDS: [StateField; 8] = [
    ("strain_ratio", "1", |state| state.strain_ratio),
    ("critical_strain", "1", |state| state.critical_strain),
    ("wavelength", "m", |state| state.wavelength),
    ("young_modulus", "Pa", |state| state.young),
    ("thickness", "m", |state| state.thickness),
    ("membrane_energy", "J/m2", |state| state.membrane_energy),
    ("bending_energy", "J/m2", |state| state.bending_energy),
    ("foundation_energy", "J/m2", |state| state.foundation_energy),
];

/// The files of the load steps of one pose.
pub(crate) struct FrameFiles<'a> {
    /// Output folder, and the folder of the pose in it.
    output: &'a Path,
    folder: String,
    placement: Placement,
    formats: &'a [FrameFormat],
    /// Of all layers together: upper layers are in some load steps only, at the times of those below.
    times: LoadTimes,
    series: BTreeMap<String, Series>,
    /// Time, and the vertices of the mesh of the scene (m), in every load step of a zone, for a GLB.
    moved: Vec<(f64, Vec<Vector3<f64>>)>,
}

/// The files of one layer that grow with every load step.
struct Series {
    /// Time and file of every VTU so far.
    listed: Vec<(f64, String)>,
    usd: UsdSeries,
}

impl<'a> FrameFiles<'a> {
    /// The files of a pose, none of them written.
    pub(crate) fn new(
        output: &'a Path,
        pose: &str,
        placement: Placement,
        formats: &'a [FrameFormat],
    ) -> Self {
        Self {
            output,
            folder: format!("frames/{pose}"),
            placement,
            formats,
            times: LoadTimes::default(),
            series: BTreeMap::new(),
            moved: Vec::new(),
        }
    }

    /// Takes what was kept for a GLB: time, and where the vertices of the mesh of the scene are (m).
    pub(crate) fn take_moved(&mut self) -> Vec<(f64, Vec<Vector3<f64>>)> {
        mem::take(&mut self.moved)
    }

    /// Files of a layer that hold all its load steps, whatever formats are asked for.
    pub(crate) fn series_files(&self, layer: &str) -> [String; 2] {
        ["pvd", "usda"].map(|end| format!("{}/{layer}.{end}", self.folder))
    }

    /// Writes a load step and returns the new files.
    ///
    /// The list of VTU files is written anew at every one, so that a run that is killed leaves a list of what is
    /// there.
    ///
    /// # Errors
    /// [`CliError::Io`].
    pub(crate) fn add(&mut self, frame: &Frame<'_>) -> Result<Vec<String>, CliError> {
        if frame.index == 0 {
            // The next zone begins, whose layers have load steps of their own.
            self.times = LoadTimes::default();
            self.moved.clear();
        }
        let time = self.times.next(frame.load);
        if let (true, Some(places)) = (
            self.formats.contains(&FrameFormat::Glb),
            frame.artist_positions,
        ) {
            self.moved.push((time, places.to_vec()));
        }
        let mut files = Vec::new();
        for layer in frame.layers {
            let file = format!("{}/{}.{:04}", self.folder, layer.name, frame.index);
            let (uvs, uv_triangles) = shared_uvs(&layer.uvs);
            let mesh = FrameMesh {
                name: &layer.name,
                positions: &layer.positions,
                triangles: &layer.faces,
                uvs: &uvs,
                uv_triangles: &uv_triangles,
            };
            if self.formats.contains(&FrameFormat::Obj) {
                let file = format!("{file}.obj");
                self.placement.write_obj(&self.output.join(&file), &mesh)?;
                files.push(file);
            }
            if self.formats.iter().any(|format| format.has_fields()) {
                let quantities = Quantities::new(layer, &self.placement);
                let in_world = FrameMesh {
                    positions: &quantities.positions,
                    triangles: &quantities.triangles,
                    uv_triangles: &self.placement.outward(mesh.uv_triangles),
                    ..mesh
                };
                let fields = quantities.fields();
                let frame = LayerFrame {
                    mesh: in_world,
                    normals: &quantities.normals,
                    number: frame.index,
                    load: frame.load,
                    fields: &fields,
                };
                self.add_fields(&file, time, &frame, &mut files)?;
            }
        }
        Ok(files)
    }

    fn add_fields(
        &mut self,
        file: &str,
        time: f64,
        frame: &LayerFrame<'_>,
        files: &mut Vec<String>,
    ) -> Result<(), CliError> {
        let layer = frame.mesh.name;
        let [list, usd] = self.series_files(layer);
        let begun = || Series {
            listed: Vec::new(),
            usd: UsdSeries::new(&self.output.join(usd), layer),
        };
        let series = self.series.entry(layer.to_owned()).or_insert_with(begun);
        if self.formats.contains(&FrameFormat::Vtu) {
            let file = format!("{file}.vtu");
            write_vtu(&self.output.join(&file), frame)?;
            let name = file.rsplit('/').next().unwrap_or(&file);
            series.listed.push((time, name.to_owned()));
            write_pvd(&self.output.join(&list), &series.listed)?;
            files.push(file);
            if series.listed.len() == 1 {
                files.push(list);
            }
        }
        if self.formats.contains(&FrameFormat::Usda) {
            series.usd.add(frame)?;
        }
        Ok(())
    }

    /// Writes what holds all load steps of the pose, and returns the files.
    ///
    /// # Errors
    /// [`CliError::Io`].
    pub(crate) fn finish(&mut self) -> Result<Vec<String>, CliError> {
        let mut files = Vec::new();
        for (layer, series) in mem::take(&mut self.series) {
            if self.formats.contains(&FrameFormat::Usda) {
                series.usd.finish()?;
                let [_, usd] = self.series_files(&layer);
                files.push(usd);
            }
        }
        Ok(files)
    }
}

/// A layer in the world, with quantities on it.
struct Quantities {
    positions: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<Vector3<f64>>,
    displacements: Vec<Vector3<f64>>,
    heights: Vec<f64>,
    /// A list per entry of [`STATE_FIELDS`].
    states: Vec<Vec<f64>>,
}

impl Quantities {
    fn new(layer: &LayerSurface, placement: &Placement) -> Self {
        let positions = layer.positions.iter().map(|p| placement.in_world(p));
        let positions: Vec<_> = positions.collect();
        let triangles = placement.outward(&layer.faces);
        let mesh = TriMesh::new(positions.len(), triangles.clone())
            .expect("the triangles of a layer are those of a mesh");
        let displacements = layer.displacements();
        let heights = displacements.iter().zip(&layer.driver_normals);
        let states = layer.face_states.as_deref().unwrap_or_default();
        Self {
            normals: vertex_normals(&mesh, &positions),
            heights: heights.map(|(way, normal)| way.dot(normal)).collect(),
            displacements: displacements.iter().map(|d| placement.turn * d).collect(),
            states: STATE_FIELDS
                .iter()
                .map(|(.., value)| states.iter().map(value).collect())
                .collect(),
            positions,
            triangles,
        }
    }

    fn fields(&self) -> Vec<Field<'_>> {
        let of_vertices = [
            (
                "displacement",
                FieldValues::VertexVectors(&self.displacements),
            ),
            ("height", FieldValues::Vertices(&self.heights)),
        ];
        let of_vertices = of_vertices.map(|(name, values)| Field {
            name,
            unit: "m",
            values,
        });
        let of_faces = STATE_FIELDS.iter().zip(&self.states);
        let of_faces = of_faces.map(|(&(name, unit, _), values)| Field {
            name,
            unit,
            values: FieldValues::Faces(values),
        });
        of_vertices.into_iter().chain(of_faces).collect()
    }
}

/// Times of load steps, which ascend: their loads, and where a load is no larger than the one before, because the
/// strain of the next key grows from none, it begins where that ended.
#[derive(Default)]
struct LoadTimes {
    begin: f64,
    last: f64,
}

impl LoadTimes {
    fn next(&mut self, load: f64) -> f64 {
        if load <= self.last {
            self.begin += self.last;
        }
        self.last = load;
        self.begin + load
    }
}

/// Every texture coordinate once, and where the corners find theirs.
fn shared_uvs(corners: &[[Vector2<f64>; 3]]) -> (Vec<Vector2<f64>>, Vec<[u32; 3]>) {
    let mut known = BTreeMap::new();
    let mut uvs = Vec::new();
    let mut index = |uv: Vector2<f64>| -> u32 {
        *known
            .entry([uv.x.to_bits(), uv.y.to_bits()])
            .or_insert_with(|| {
                uvs.push(uv);
                uvs.len() as u32 - 1
            })
    };
    let triangles = corners
        .iter()
        .map(|triangle| triangle.map(&mut index))
        .collect();
    (uvs, triangles)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use nalgebra::Matrix3;

    use super::*;

    /// A triangle.
    fn layer(name: &str) -> LayerSurface {
        let positions = vec![Vector3::zeros(), Vector3::x(), Vector3::y()];
        LayerSurface {
            name: name.to_owned(),
            driver_positions: positions.clone(),
            driver_normals: vec![Vector3::z(); 3],
            positions,
            faces: [[0, 1, 2]].into(),
            uvs: [[Vector2::zeros(), Vector2::x(), Vector2::y()]].into(),
            face_states: Some(vec![FaceState::default()]),
            ..LayerSurface::default()
        }
    }

    #[test]
    fn stacked_layers_are_listed_at_the_same_times() {
        let folder = tempfile::tempdir().expect("a folder");
        let placement = Placement {
            turn: Matrix3::identity(),
            shift: Vector3::zeros(),
        };
        let mut files = FrameFiles::new(folder.path(), "pose", placement, &[FrameFormat::Vtu]);
        let both = [layer("low"), layer("high")];
        // Two keys; the upper layer is there at the end of each. Then another zone.
        let other = [layer("other")];
        let frames = [
            (0, 0.25, &both[..1]),
            (1, 0.5, &both[..]),
            (2, 0.5, &both[..1]),
            (3, 1.0, &both[..]),
            (0, 1.0, &other[..]),
        ];
        for (index, load, layers) in frames {
            let frame = Frame {
                index,
                load,
                layers,
                artist_positions: None,
            };
            files.add(&frame).expect("a folder to write to");
        }
        let times = |layer: &str| -> Vec<f64> {
            let list = folder.path().join(format!("frames/pose/{layer}.pvd"));
            let text = fs::read_to_string(list).expect("a list");
            let times = text.split("timestep=\"").skip(1);
            let times = times.filter_map(|rest| rest.split('"').next()?.parse().ok());
            times.collect()
        };
        assert_eq!(times("low"), [0.25, 0.5, 1.0, 1.5]);
        assert_eq!(times("high"), [0.5, 1.5]);
        assert_eq!(times("other"), [1.0]);
    }

    #[test]
    fn times_ascend_also_where_loads_begin_anew() {
        let mut times = LoadTimes::default();
        let found = [0.25, 0.5, 0.25, 0.75, 1.0, 1.0].map(|load| times.next(load));
        assert_eq!(found, [0.25, 0.5, 0.75, 1.25, 1.5, 2.5]);
    }
}
