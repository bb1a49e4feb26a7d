//! The lattice inside a driver's surface, and where places of that surface are in it.

mod lips;
mod slits;

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use ruga_blend::{BaseSurface, Driver, PosedSurface, Smoothing};
use ruga_lattice::{Embedding, Filling, Lattice, LatticeError, LatticeSpec};
use ruga_mesh::{
    FaceId, FaceOrigin, Id, MaterialPoint, PerFace, PerVertex, VertexId, vertex_normals,
};

use self::lips::Lips;
use super::flesh::Flesh;
use super::lattice_size::cells_for;
use crate::{Body, CreaseSpec, StepperError};

/// Faces from which on a surface is fine enough to enclose the body: the polyhedron through points
/// of a sphere then misses a thousandth of the volume.
const ENOUGH_FACES: usize = 4000;

/// Distance from the faces on its own lip of a slit, in their heights, up to which a place is put on one of them rather
/// than on a face of the other lip that it lies in. Lines are less than this off their chords, which the surface is cut
/// along; where a line does more between two chords, as in a hairpin, the faces decide.
const OFF_CHORD: f64 = 0.5;

/// The body that a driver's surface encloses, as a lattice.
///
/// It is built from the very surface that the layer lies on, not from the artist's control points,
/// which stand off a smooth surface: so its volume and its weight are those of what is seen.
#[derive(Clone, Debug)]
pub(crate) struct EmbeddingLattice {
    pub(crate) lattice: Lattice,
    /// Cells along the longest side.
    pub(crate) cells: u32,
    /// Sides of the body's box, m.
    pub(crate) sides: Vector3<f64>,
    surface: BaseSurface,
    faces: Faces,
    walls: Option<Walls>,
}

/// Faces of the surface that a lattice was built from.
#[derive(Clone, Debug)]
struct Faces {
    /// Place of every face in one of the driver's.
    origins: PerFace<FaceOrigin>,
    /// Faces in every face of the driver.
    of_driver: Vec<Vec<FaceId>>,
    /// The lips of slits; `None` without any.
    lips: Option<Lips>,
}

/// Places on both walls of slits that lie on each other at rest.
#[derive(Clone, Debug)]
struct Walls {
    /// Those on the left, and those on the right.
    sides: [Embedding; 2],
    /// The slit of every pair, by its number.
    slits: Vec<usize>,
    /// Names of the creases with a slit.
    names: Vec<String>,
}

impl EmbeddingLattice {
    pub(crate) fn new(
        driver: &Driver,
        body: &Body,
        wavelength: f64,
        smoothing: Smoothing,
    ) -> Result<Self, StepperError> {
        // Without smoothing the artist's triangles are the surface, and splitting them changes
        // nothing.
        let surface = surface_of(driver, smoothing, smoothing == Smoothing::Loop);
        let rest = surface.pose(driver.rest()).positions;
        let box_of = |bound: fn(&Vector3<f64>, &Vector3<f64>) -> Vector3<f64>| {
            let places = rest.iter().copied();
            places.reduce(|a, b| bound(&a, &b)).unwrap_or_default()
        };
        let sides = box_of(|a, b| a.sup(b)) - box_of(|a, b| a.inf(b));
        let chosen = || cells_for(&sides, body.shape, wavelength);
        let spec = spec_of(body, body.cells.unwrap_or_else(chosen));
        let lattice = Lattice::build(surface.mesh(), &rest, &spec);
        Ok(Self {
            lattice: lattice.map_err(|error| in_the_file(error, driver, &surface))?,
            cells: spec.cells,
            sides,
            faces: Faces::new(surface.origins(), driver.topology().face_count(), None),
            walls: None,
            surface,
        })
    }

    /// Of every crease with an anchor or a slit the least way (m) straight into the body, from where its line crosses
    /// edges of the driver to where the flesh ends; of others infinity.
    pub(crate) fn flesh_below(&self, driver: &Driver, creases: &[CreaseSpec]) -> Vec<f64> {
        let goes_down = |crease: &CreaseSpec| crease.anchor.is_some() || crease.slit.is_some();
        let mut least = vec![f64::INFINITY; creases.len()];
        if !creases.iter().any(goes_down) {
            return least;
        }
        let flesh = Flesh::new(driver, &self.surface, &self.sides);
        for (least, crease) in least.iter_mut().zip(creases) {
            if goes_down(crease) {
                let places = crease.line.places().into_par_iter();
                let ways = places.map(|place| flesh.below(&self.address(&place)));
                *least = ways.reduce(|| f64::INFINITY, f64::min);
            }
        }
        least
    }

    /// Embeds points of the driver, given at rest, in the lattice.
    pub(crate) fn embed(
        &self,
        points: &[MaterialPoint],
        rest: &PosedSurface,
    ) -> Result<Embedding, LatticeError> {
        let addresses: Vec<_> = points.iter().map(|point| self.address(point)).collect();
        Embedding::of_surface(&self.lattice, &addresses, &rest.positions, &rest.normals)
    }

    /// Embeds the driver's own vertices, wherever they stand off its smooth surface.
    pub(crate) fn embed_control(&self, driver: &Driver) -> Result<Embedding, LatticeError> {
        let (mesh, rest) = (driver.topology(), driver.rest());
        let vertices = PerVertex::filled(mesh.vertex_count(), ());
        // A vertex without faces has no surface to move with; any will do.
        let somewhere = MaterialPoint::at_corner(FaceId(0), 0);
        let addresses: Vec<_> = (vertices.ids())
            .map(|v| self.address(&MaterialPoint::of_vertex(mesh, v).unwrap_or(somewhere)))
            .collect();
        let mut normals = vertex_normals(mesh, rest);
        for normal in &mut normals {
            if *normal == Vector3::zeros() {
                // An embedding wants unit normals. A vertex without one has no face with an area.
                *normal = Vector3::z();
            }
        }
        Embedding::of_surface(&self.lattice, &addresses, rest, &normals)
    }

    fn address(&self, point: &MaterialPoint) -> MaterialPoint {
        self.faces.address(point)
    }
}

impl Faces {
    fn new(origins: &PerFace<FaceOrigin>, of_driver: usize, lips: Option<Lips>) -> Self {
        let mut parts = vec![Vec::new(); of_driver];
        for (face, origin) in origins.iter() {
            parts[origin.face.index()].push(face);
        }
        Self {
            origins: origins.clone(),
            of_driver: parts,
            lips,
        }
    }

    /// The place that has the same address as one of the driver's faces. Beside a slit it is on a face of its own lip,
    /// also where the slit runs along a chord of its line, and the place lies between the two.
    fn address(&self, point: &MaterialPoint) -> MaterialPoint {
        let Some(lips) = &self.lips else {
            return self.innermost(&[*point], |_| 0.0);
        };
        // On an edge of the driver one of its faces may have the left lip, and another one the right.
        let addresses = lips.addresses(point);
        let lip = lips.of(&addresses);
        self.innermost(&addresses, |face| match lip {
            Some(lip) if lips.is_across(face, lip) => -OFF_CHORD,
            _ => 0.0,
        })
    }

    /// The place of one of these addresses that lies farthest inside of its face, in heights of that and with what is
    /// a `gain` of the face added.
    fn innermost(
        &self,
        addresses: &[MaterialPoint],
        gain: impl Fn(FaceId) -> f64,
    ) -> MaterialPoint {
        // A part without an area has no such coordinates.
        let place = |address: &MaterialPoint, face: FaceId| {
            let corners = self.origins[face].corners.map(Vector3::from);
            let inverse = Matrix3::from_columns(&corners).try_inverse()?;
            let local = inverse * Vector3::from(address.barycentric);
            let barycentric = local.into();
            Some(MaterialPoint { face, barycentric })
        };
        let inside = |p: &MaterialPoint| {
            let inside = p.barycentric.iter().copied().fold(f64::MAX, f64::min);
            inside + gain(p.face)
        };
        let places = addresses.iter().flat_map(|address| {
            let faces = self.of_driver[address.face.index()].iter();
            faces.filter_map(move |&face| place(address, face))
        });
        // Rounding may put a place on an edge outside of both faces beside it. The one that it is
        // least outside of serves as well.
        let best = places.max_by(|a, b| inside(a).total_cmp(&inside(b)));
        best.expect("every face has a part with an area")
    }
}

/// A driver's surface, split until it is fine if it is to be.
fn surface_of(driver: &Driver, smoothing: Smoothing, is_fine: bool) -> BaseSurface {
    let faces: Vec<FaceId> = driver.topology().faces().ids().collect();
    let mut levels = 0;
    while is_fine && (faces.len() << (2 * levels)) < ENOUGH_FACES {
        levels += 1;
    }
    BaseSurface::new(driver, &faces, levels, smoothing)
}

fn spec_of(body: &Body, cells: u32) -> LatticeSpec {
    LatticeSpec {
        cells,
        shape: body.shape,
        filling: Filling::Piece,
    }
}

/// Error about a driver's smooth surface, in terms of the vertices and triangles of its file; pairs of
/// faces that cross are still counted on the smooth surface.
fn in_the_file(error: LatticeError, driver: &Driver, surface: &BaseSurface) -> LatticeError {
    let triangle = |face: FaceId| FaceId(driver.triangles()[surface.origins()[face].face]);
    let vertex = |welded: VertexId| {
        let of_file = driver.welded().iter().position(|own| *own == welded);
        VertexId::from_index(of_file.expect("every vertex is one of the file's"))
    };
    match error {
        LatticeError::OpenSurface { .. } => {
            let edges = driver.topology().edges().as_slice().iter();
            let open: Vec<_> = edges.filter(|edge| edge.is_border()).collect();
            LatticeError::OpenSurface {
                count: open.len(),
                vertices: (open.first())
                    .expect("a smooth surface has the borders of its mesh")
                    .vertices
                    .map(vertex),
            }
        }
        LatticeError::SelfIntersection { count, faces } => LatticeError::SelfIntersection {
            count,
            faces: faces.map(triangle),
        },
        LatticeError::WrongSide {
            face,
            volume,
            depth,
        } => LatticeError::WrongSide {
            face: triangle(face),
            volume,
            depth,
        },
        other => other,
    }
}
