//! The lattice inside a driver's surface, and where places of that surface are in it.

use nalgebra::{Matrix3, Vector3};
use ruga_blend::{BaseSurface, Driver, PosedSurface, Smoothing};
use ruga_lattice::{Embedding, Filling, Lattice, LatticeError, LatticeSpec};
use ruga_mesh::{FaceId, Id, MaterialPoint, PerVertex, VertexId, vertex_normals};

use super::flesh::Flesh;
use super::lattice_size::cells_for;
use crate::{Body, CreaseSpec, StepperError};

/// Faces from which on a surface is fine enough to enclose the body: the polyhedron through points
/// of a sphere then misses a thousandth of the volume.
const ENOUGH_FACES: usize = 4000;

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
}

impl EmbeddingLattice {
    pub(crate) fn new(
        driver: &Driver,
        body: &Body,
        wavelength: f64,
        smoothing: Smoothing,
    ) -> Result<Self, StepperError> {
        let faces: Vec<FaceId> = driver.topology().faces().ids().collect();
        let mut levels = 0;
        // Without smoothing the artist's triangles are the surface, and splitting them changes
        // nothing.
        while smoothing == Smoothing::Loop && (faces.len() << (2 * levels)) < ENOUGH_FACES {
            levels += 1;
        }
        let surface = BaseSurface::new(driver, &faces, levels, smoothing);
        let rest = surface.pose(driver.rest()).positions;
        let box_of = |bound: fn(&Vector3<f64>, &Vector3<f64>) -> Vector3<f64>| {
            let places = rest.iter().copied();
            places.reduce(|a, b| bound(&a, &b)).unwrap_or_default()
        };
        let sides = box_of(|a, b| a.sup(b)) - box_of(|a, b| a.inf(b));
        let chosen = || cells_for(&sides, body.shape, wavelength);
        let spec = LatticeSpec {
            cells: body.cells.unwrap_or_else(chosen),
            shape: body.shape,
            filling: Filling::Piece,
        };
        let lattice = Lattice::build(surface.mesh(), &rest, &spec);
        Ok(Self {
            lattice: lattice.map_err(|error| in_the_file(error, driver, &surface))?,
            cells: spec.cells,
            sides,
            surface,
        })
    }

    /// Of every crease the least way (m) straight into the body, from its line to where the flesh ends.
    pub(crate) fn flesh_below(&self, driver: &Driver, creases: &[CreaseSpec]) -> Vec<f64> {
        let flesh = Flesh::new(driver, &self.surface, &self.sides);
        let least = |crease: &CreaseSpec| {
            let places = crease.line.places();
            let ways = places.iter().map(|place| flesh.below(&self.address(place)));
            ways.fold(f64::INFINITY, f64::min)
        };
        creases.iter().map(least).collect()
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

    /// The place of the lattice's surface that has the same address as one of the driver's faces.
    fn address(&self, point: &MaterialPoint) -> MaterialPoint {
        let children = 1usize << (2 * self.surface.levels());
        let first = point.face.index() * children;
        let place = |face: FaceId| {
            let corners = self.surface.origins()[face].corners.map(Vector3::from);
            let inverse = Matrix3::from_columns(&corners).try_inverse();
            let local = inverse.unwrap_or_else(Matrix3::zeros) * Vector3::from(point.barycentric);
            MaterialPoint {
                face,
                barycentric: local.into(),
            }
        };
        let inside = |p: &MaterialPoint| p.barycentric.iter().copied().fold(f64::MAX, f64::min);
        let places = (first..first + children).map(|face| place(FaceId::from_index(face)));
        // Rounding may put a place on an edge outside of both faces beside it. The one that it is
        // least outside of serves as well.
        let best = places.max_by(|a, b| inside(a).total_cmp(&inside(b)));
        best.expect("every face has at least one child")
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
