//! Blend-shape driver: weights in, posed positions and normals at material points out.
//!
//! An [`ArtistMesh`] is what the file holds. A [`Driver`] welds it and blends:
//! `x(w) = rest + sum_i w_i delta_i` (Li 2014, 5.3). A [`BaseSurface`] is the smooth Loop limit
//! surface through it, addressed by material points; [`face_strains`] says what a pose asks of the
//! skin. Lengths are metres; texture coordinates have V down as in glTF.
//!
//! ```
//! use nalgebra::{Vector2, Vector3};
//! use ruga_blend::{ArtistMesh, BaseSurface, BlendShape, Driver, Smoothing, face_strains};
//!
//! let square = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]];
//! let artist = ArtistMesh {
//!     name: "patch".into(),
//!     positions: square.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec(),
//!     normals: None,
//!     uvs: Some(square.map(|[x, y]| Vector2::new(10.0 * x, 10.0 * y)).to_vec()),
//!     triangles: vec![[0, 1, 2], [0, 2, 3]],
//!     shapes: vec![BlendShape {
//!         name: "compress".into(),
//!         position_deltas: square.map(|[x, _]| Vector3::new(-0.1 * x, 0.0, 0.0)).to_vec(),
//!         normal_deltas: None,
//!     }],
//! };
//! let driver = Driver::new(&artist)?;
//! let faces: Vec<_> = driver.topology().faces().ids().collect();
//! let base = BaseSurface::new(&driver, &faces, 2, Smoothing::Loop);
//! let rest = base.pose(driver.rest());
//! let posed = base.pose(&driver.pose(&driver.weights([("compress", 1.0)])?));
//! for (_, strain) in face_strains(base.mesh(), &rest.positions, &posed.positions).iter() {
//!     assert!((strain.first - 0.1).abs() < 1e-12);
//! }
//! # Ok::<(), ruga_blend::BlendError>(())
//! ```

mod artist_mesh;
mod base_surface;
mod driver;
mod error;
mod strain;
mod surface_points;

pub use artist_mesh::{ArtistMesh, BlendShape};
pub use base_surface::{BaseSurface, PosedSurface, Smoothing};
pub use driver::{Driver, Weights};
pub use error::BlendError;
pub use strain::{FaceStrain, face_strains, rest_frame};
pub use surface_points::SurfacePoints;
