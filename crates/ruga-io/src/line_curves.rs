//! Lines that an artist draws beside the mesh, in the space of that mesh.

use nalgebra::{Matrix3, Matrix4, Vector3};

use crate::gltf_lines::read_gltf_lines;
use crate::line_joining::{LineElement, join};
use crate::obj_lines::read_obj_lines;
use crate::read_mesh::{LARGEST_COORDINATE, MeshFormat};
use crate::{IoError, MeshFile, ObjOptions};

/// A polyline in a mesh file.
#[derive(Clone, Debug, PartialEq)]
pub struct LineCurve {
    /// Its points, at least two (m); neighbours differ. A closed one does not repeat its first.
    pub points: Vec<Vector3<f64>>,
    /// Whether an edge joins the last point to the first.
    pub is_closed: bool,
}

/// Reads the lines of the mesh or object `name` in the file that `mesh` was read from.
///
/// In glTF these are primitives of lines, line loops and line strips of the mesh of that name, else
/// of the mesh of the node of that name; in OBJ the `l` elements of the object or group of that
/// name, in the unit of `obj`. Edges that come as pairs are joined where their ends are the same
/// point; where three or more of them meet, polylines end. A polyline has the direction of its
/// first edge in the file, and stands in the order of these edges. Strips and loops are taken as they
/// are.
///
/// # Shapes and units
/// Points are in metres in the space of [`MeshFile::mesh`], also after [`MeshFile::scaled`]: with the
/// mesh's world transform `[R S | t]`, a point `x` of the world is at `S (R S)⁻¹ (x - t)`. A mesh that
/// several nodes carry is where the node called `name` has it, else where the first has it.
///
/// # Errors
/// [`IoError::UnknownMesh`]; [`IoError::Malformed`] for a mesh without lines, or with a line that
/// cannot be read; the errors of reading the file again.
pub fn read_line_curves(
    mesh: &MeshFile,
    name: &str,
    obj: &ObjOptions,
) -> Result<Vec<LineCurve>, IoError> {
    let format = MeshFormat::of(&mesh.path)?;
    let found = match format {
        MeshFormat::Gltf => read_gltf_lines(&mesh.path, name)?,
        MeshFormat::Obj => read_obj_lines(&mesh.path, name, obj.length_unit)?,
    };
    let mut curves = join(&found.elements);
    let fault = |reason| IoError::malformed(&mesh.path, element(format, name), reason);
    if curves.is_empty() {
        return Err(fault(missing_lines(format, &found)));
    }
    place(mesh, &found.world_from_lines, &mut curves).map_err(fault)?;
    Ok(curves)
}

/// Line elements of one mesh as its file has them.
pub(crate) struct FoundLines {
    /// In file order and in the file's coordinates; all finite.
    pub(crate) elements: Vec<LineElement>,
    /// From the coordinates of `elements` to the file's world.
    pub(crate) world_from_lines: Matrix4<f64>,
    /// Whether the mesh has faces.
    pub(crate) has_faces: bool,
}

/// What makes lines appear in a glTF file.
pub(crate) const LOOSE_EDGES: &str = "Blender's glTF exporter drops edges that belong to no face \
     unless `Loose Edges` is on (under Data, Mesh)";

fn element(format: MeshFormat, name: &str) -> String {
    match format {
        MeshFormat::Gltf => format!("mesh `{name}`"),
        MeshFormat::Obj => format!("object `{name}`"),
    }
}

fn missing_lines(format: MeshFormat, found: &FoundLines) -> String {
    let fault = match (found.elements.is_empty(), found.has_faces) {
        (false, _) => "its lines have no length",
        (true, true) => "has faces and no lines",
        (true, false) => "has no lines",
    };
    let hint = match format {
        MeshFormat::Gltf => LOOSE_EDGES,
        MeshFormat::Obj => {
            "an OBJ file has lines as `l` elements, which Blender's exporter writes for \
             edges that belong to no face"
        }
    };
    format!("{fault}; expected edges that belong to no face. {hint}")
}

/// Moves points from the file's coordinates to those of the mesh.
fn place(
    mesh: &MeshFile,
    world_from_lines: &Matrix4<f64>,
    curves: &mut [LineCurve],
) -> Result<(), String> {
    let linear: Matrix3<f64> = mesh.world_from_node.fixed_view::<3, 3>(0, 0).into_owned();
    let inverse = linear
        .try_inverse()
        .ok_or("the mesh beside it is scaled to nothing along an axis")?;
    // The rotation alone, but also where a scale near one was rounded to one.
    let mesh_from_world = mesh.stretch * inverse;
    let mesh_origin: Vector3<f64> = mesh.world_from_node.fixed_view::<3, 1>(0, 3).into_owned();
    let world_from_lines = world_from_lines.fixed_view::<3, 4>(0, 0) * mesh.metres_per_unit;
    for point in curves.iter_mut().flat_map(|curve| &mut curve.points) {
        let in_world = world_from_lines * point.push(1.0);
        *point = mesh_from_world * (in_world - mesh_origin);
        // Written so that what is no number is refused.
        let fits = |c: &f64| c.abs() <= f64::from(LARGEST_COORDINATE);
        if let Some(value) = point.iter().find(|c| !fits(c)) {
            return Err(format!(
                "a coordinate of its lines is {value:e} m; accepted: numbers up to {LARGEST_COORDINATE:e}"
            ));
        }
    }
    Ok(())
}
