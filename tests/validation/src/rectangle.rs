//! A rectangle, flat or bent, as the surface that meshes live on.

use nalgebra::{Matrix3, Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_mesh::{FaceId, MaterialPoint, PerVertex, TriMesh};
use ruga_remesh::{RemeshSettings, Remeshed, Sizing, Surface, SurfaceMesh, remesh};

/// `[0, length] x [0, width]`, in the plane z = 0 or rolled about an axis along y.
///
/// Its base mesh is two triangles in these coordinates; positions are exact, not on facets.
#[derive(Clone, Copy, Debug)]
pub struct Rectangle {
    /// Extent along x, or the arc, m.
    pub length: f64,
    /// Extent along y, m.
    pub width: f64,
    /// Radius of the cylinder that it is bent to, m; flat without.
    pub radius: Option<f64>,
}

impl Rectangle {
    /// A mesh with edges of about this length, m; its corners are fixed.
    pub fn meshed(&self, edge: f64) -> SurfaceMesh {
        let mesh = TriMesh::new(4, vec![[0, 1, 2], [0, 2, 3]]).expect("two triangles");
        let (l, w) = (self.length, self.width);
        let corners = [[0.0, 0.0], [l, 0.0], [l, w], [0.0, w]];
        let points = corners.map(|[x, y]| self.address(Vector2::new(x, y)));
        let coarse = SurfaceMesh::on_surface(mesh, points.to_vec().into(), self);
        let mut coarse = coarse.expect("a point per vertex");
        coarse.fixed = PerVertex::filled(4, true);
        let sizing = Sizing::uniform(4, edge).expect("a positive length");
        let made = remesh(&coarse, &sizing, self, &RemeshSettings::default());
        made.expect("a valid sizing").mesh
    }

    /// A remesh with edges of about `edge` (m), of which every vertex wants up to the share
    /// `jitter` more or less.
    pub fn remeshed(&self, mesh: &SurfaceMesh, edge: f64, jitter: f64, seed: u64) -> Remeshed {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let tensors = (0..mesh.mesh.vertex_count()).map(|_| {
            let wanted = edge * (1.0 + jitter * random.random_range(-1.0..1.0));
            Matrix3::identity() / (wanted * wanted)
        });
        let sizing = Sizing {
            tensors: tensors.collect(),
        };
        remesh(mesh, &sizing, self, &RemeshSettings::default()).expect("a valid sizing")
    }

    /// A flat mesh with edges of about `edges[0]` along x and `edges[1]` along y (m), of which
    /// every vertex wants up to the share `jitter` more or less.
    ///
    /// It has been remeshed three times, by when it no longer shows the halving that it began with.
    pub fn fitted(&self, edges: [f64; 2], jitter: f64, seed: u64) -> SurfaceMesh {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut settings = RemeshSettings::default();
        // The remesher's own bound is that of hinges; jitter changes both lengths alike.
        settings.limits.aspect = edges[1] / edges[0];
        let mut mesh = self.meshed(edges[0]);
        for _ in 0..3 {
            let tensors = (0..mesh.mesh.vertex_count()).map(|_| {
                let share = 1.0 + jitter * random.random_range(-1.0..1.0);
                let [x, y] = edges.map(|edge| (edge * share).powi(-2));
                Matrix3::from_diagonal(&Vector3::new(x, y, 0.0))
            });
            let sizing = Sizing {
                tensors: tensors.collect(),
            };
            let made = remesh(&mesh, &sizing, self, &settings);
            mesh = made.expect("a valid sizing").mesh;
        }
        mesh
    }

    /// Coordinates of a place, m.
    pub fn coordinates(&self, at: MaterialPoint) -> Vector2<f64> {
        let [_, b, c] = at.barycentric;
        let [x, y] = if at.face == LOWER {
            [b + c, c]
        } else {
            [b, b + c]
        };
        Vector2::new(self.length * x, self.width * y)
    }

    /// Distance of a point from the whole plane or cylinder, along its normal, m.
    pub fn height(&self, point: &Vector3<f64>) -> f64 {
        self.radius
            .map_or(point.z, |radius| point.xz().norm() - radius)
    }

    /// The place with the given coordinates, or the nearest one.
    fn address(&self, coordinates: Vector2<f64>) -> MaterialPoint {
        let x = (coordinates.x / self.length).clamp(0.0, 1.0);
        let y = (coordinates.y / self.width).clamp(0.0, 1.0);
        if y <= x {
            MaterialPoint {
                face: LOWER,
                barycentric: [1.0 - x, x - y, y],
            }
        } else {
            MaterialPoint {
                face: UPPER,
                barycentric: [1.0 - y, x, y - x],
            }
        }
    }
}

/// The triangle of the corners (0, 0), (1, 0), (1, 1).
const LOWER: FaceId = FaceId(0);
/// The triangle of the corners (0, 0), (1, 1), (0, 1).
const UPPER: FaceId = FaceId(1);

impl Surface for Rectangle {
    fn position(&self, at: MaterialPoint) -> Vector3<f64> {
        let place = self.coordinates(at);
        match self.radius {
            None => Vector3::new(place.x, place.y, 0.0),
            Some(radius) => {
                let (sin, cos) = (place.x / radius).sin_cos();
                Vector3::new(radius * sin, place.y, radius * cos)
            }
        }
    }

    fn normal(&self, at: MaterialPoint) -> Vector3<f64> {
        match self.radius {
            None => Vector3::z(),
            Some(radius) => {
                let (sin, cos) = (self.coordinates(at).x / radius).sin_cos();
                Vector3::new(sin, 0.0, cos)
            }
        }
    }

    fn closest(&self, _near: MaterialPoint, target: Vector3<f64>) -> MaterialPoint {
        let x = match self.radius {
            None => target.x,
            Some(radius) => radius * target.x.atan2(target.z),
        };
        self.address(Vector2::new(x, target.y))
    }
}
