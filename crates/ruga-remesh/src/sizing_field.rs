//! The sizing that a wrinkled shape and its driver ask for.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use ruga_mesh::{FaceId, Id, PerFace, PerVertex, face_areas, tangent_frame, vertex_normals};

use crate::sizing::setting;
use crate::surface::{check_finite, check_length};
use crate::tensor2::Tensor2;
use crate::{RemeshError, Sizing, SurfaceMesh};

/// Faces whose terms are found before they are added up, one after the other.
const AT_A_TIME: usize = 1 << 15;

/// Faces or vertices that a thread takes at least.
const AT_ONCE: usize = 1 << 9;

/// What the sizing is derived from.
#[derive(Clone, Copy, Debug)]
pub struct SizingInput<'a> {
    /// The mesh with its rest positions.
    pub mesh: &'a SurfaceMesh,
    /// Present position of every vertex, m.
    pub shape: &'a [Vector3<f64>],
    /// What drives wrinkles at every face.
    pub driver: Option<&'a PerFace<FaceDriver>>,
    /// How strongly each of these refines.
    pub refinement: Refinement,
}

/// How the driver compresses a face of the rest surface, and what the layer would make of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceDriver {
    /// Shortening `I - U`, with `U` the right stretch tensor in the tangent plane of the rest
    /// surface; positive where compressed, dimensionless.
    pub compression: Matrix3<f64>,
    /// Critical wavelength, m; positive.
    pub wavelength: f64,
    /// Critical strain, positive; infinite where the layer cannot wrinkle.
    pub critical_strain: f64,
    /// Poisson ratio of the layer: strain across counts as `e1 + nu e2` (notes: never e1 alone).
    pub poisson: f64,
}

/// How strongly shape, motion and driver refine. Infinite switches a term off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement {
    /// Turn of the normal along an edge of metric length one, radians, positive. Default 0.3, as
    /// Narain et al.; a smaller value draws wrinkles smoother at more vertices.
    pub angle: f64,
    /// Mesh points per critical wavelength across wrinkles, positive; default 12. At 8 wavelengths
    /// come out 3 % short, at 12 1 %, and cost grows with the square. It also bounds what
    /// curvature asks for: finer than this a layer has no shape to show.
    pub points_per_wavelength: f64,
    /// Ratios of effective compression to critical strain at which the driver's term sets in and
    /// is complete; increasing, not negative. Default 0.6 and 0.8: complete where the active region
    /// begins, so that wrinkles meet a mesh that waits for them. Lower values refine sooner.
    pub onset: [f64; 2],
}

impl Default for Refinement {
    fn default() -> Self {
        Self {
            angle: 0.3,
            points_per_wavelength: 12.0,
            onset: [0.6, 0.8],
        }
    }
}

/// The sizing of a shape: `M = finest(min(C, s), W)`, per vertex in the rest tangent plane.
///
/// ```text
/// C = (∇n)ᵀ ∇n / angle²           n: vertex normals of the shape
/// W = Σ s aᵢ dᵢ dᵢᵀ                 dᵢ: principal directions of the driver's compression eᵢ
/// s = (points_per_wavelength / wavelength)²
/// aᵢ = smooth step of (eᵢ + nu eⱼ) / critical_strain over onset; where the larger of the two
///      wrinkles, the smaller one's is ((1 - nu²) eᵢ / critical_strain + nu)
/// ```
/// The gradient is that of a linear field on the rest faces. C is that of Narain et al. (2012),
/// section 4.1, without what motion and compression add there: the driver knows the waves. Where drivers' directions disagree around
/// a vertex the mean of `W` is scaled up, so that no direction on its own is under-resolved.
///
/// The result knows no limits (edge lengths, aspect, grading): [`remesh`](crate::remesh) holds it
/// to its settings, and so does [`Sizing::limited`].
///
/// # Errors
/// Arrays that do not fit, settings or driver values out of range, positions that are not finite.
pub fn sizing_field(input: &SizingInput) -> Result<Sizing, RemeshError> {
    check(input)?;
    let SizingInput {
        mesh,
        shape,
        refinement,
        ..
    } = *input;
    let rest = mesh.positions.as_slice();
    let normals = vertex_normals(&mesh.mesh, shape);
    let areas = face_areas(&mesh.mesh, rest);
    let terms = |face: FaceId| {
        let corners = mesh.mesh.faces()[face];
        let at = |field: &[Vector3<f64>]| corners.map(|v| field[v.index()]);
        let hats = hat_gradients(at(rest));
        let turn = gradient(hats, at(&normals));
        let own = turn.transpose() * turn / (refinement.angle * refinement.angle);
        let wrinkles = input
            .driver
            .map(|drivers| wrinkle_term(&drivers[face], hats, &refinement));
        (own, wrinkles)
    };
    let mut sums = PerVertex::filled(mesh.mesh.vertex_count(), Sums::default());
    let count = mesh.mesh.face_count();
    for first in (0..count).step_by(AT_A_TIME) {
        let faces = first..count.min(first + AT_A_TIME);
        let each = faces.clone().into_par_iter().with_min_len(AT_ONCE);
        let found: Vec<_> = each.map(|face| terms(FaceId::from_index(face))).collect();
        for (face, (own, wrinkles)) in faces.map(FaceId::from_index).zip(found) {
            for vertex in mesh.mesh.faces()[face] {
                sums[vertex].add(areas[face], own, wrinkles);
            }
        }
    }
    let rest_normals = vertex_normals(&mesh.mesh, rest);
    let each = sums.as_slice().par_iter().zip(rest_normals);
    let tensor = |(sum, normal): (&Sums, _)| sum.tensor(&tangent_frame(normal, Vector3::zeros()));
    let tensors: Vec<_> = each.with_min_len(AT_ONCE).map(tensor).collect();
    Ok(Sizing {
        tensors: tensors.into(),
    })
}

fn check(input: &SizingInput) -> Result<(), RemeshError> {
    input.mesh.check()?;
    let vertices = input.mesh.mesh.vertex_count();
    check_length("shape", input.shape.len(), vertices)?;
    let Refinement {
        angle,
        points_per_wavelength,
        onset,
    } = input.refinement;
    setting("angle", angle, "positive", |v| v > 0.0)?;
    setting(
        "points_per_wavelength",
        points_per_wavelength,
        "positive, finite",
        |v| v > 0.0 && v.is_finite(),
    )?;
    setting("onset[0]", onset[0], "0 or more", |v| v >= 0.0)?;
    setting("onset[1]", onset[1], "above onset[0], finite", |v| {
        v > onset[0] && v.is_finite()
    })?;
    check_finite(input.shape)?;
    if let Some(drivers) = input.driver {
        check_length("driver", drivers.len(), input.mesh.mesh.face_count())?;
        drivers
            .iter()
            .try_for_each(|(face, driver)| check_driver(face, driver))?;
    }
    Ok(())
}

fn check_driver(face: FaceId, driver: &FaceDriver) -> Result<(), RemeshError> {
    let FaceDriver {
        compression,
        wavelength,
        critical_strain,
        poisson,
    } = *driver;
    let values = [
        (
            "compression",
            compression.norm(),
            "finite",
            compression.norm().is_finite(),
        ),
        (
            "wavelength",
            wavelength,
            "positive, finite",
            wavelength > 0.0 && wavelength.is_finite(),
        ),
        (
            "critical_strain",
            critical_strain,
            "positive",
            critical_strain > 0.0,
        ),
        (
            "poisson",
            poisson,
            "-1 to 0.5",
            (-1.0..=0.5).contains(&poisson),
        ),
    ];
    match values.into_iter().find(|value| !value.3) {
        Some((what, value, accepted, _)) => Err(RemeshError::Face {
            face,
            what,
            value,
            accepted,
        }),
        None => Ok(()),
    }
}

/// Gradients of a face's three hat functions, 1/m, in its plane; zero for a degenerate face.
fn hat_gradients([a, b, c]: [Vector3<f64>; 3]) -> [Vector3<f64>; 3] {
    let normal = (b - a).cross(&(c - a));
    let square = normal.norm_squared();
    if square == 0.0 {
        return [Vector3::zeros(); 3];
    }
    [c - b, a - c, b - a].map(|opposite| normal.cross(&opposite) / square)
}

/// Gradient of the linear field with the given corner values: maps a step on the rest face to the
/// change of the field.
fn gradient(hats: [Vector3<f64>; 3], values: [Vector3<f64>; 3]) -> Matrix3<f64> {
    (0..3).fold(Matrix3::zeros(), |sum, i| {
        sum + values[i] * hats[i].transpose()
    })
}

/// A tensor of the face's plane with its eigenvalues mapped; zero for a degenerate face.
fn principal(
    tensor: &Matrix3<f64>,
    hats: [Vector3<f64>; 3],
    map: impl Fn(f64) -> f64,
) -> Matrix3<f64> {
    let normal = hats[0].cross(&hats[1]);
    match normal.try_normalize(0.0) {
        Some(normal) => {
            let frame = tangent_frame(normal, hats[0]);
            Tensor2::in_frame(tensor, &frame)
                .map_eigenvalues(map)
                .in_space(&frame)
        }
        None => Matrix3::zeros(),
    }
}

/// What the driver asks for at a face.
#[derive(Clone, Copy)]
struct Wrinkles {
    tensor: Matrix3<f64>,
    /// Larger eigenvalue of the tensor, 1/m².
    finest: f64,
    /// The eigenvalue of complete refinement `s`, 1/m².
    most: f64,
}

fn wrinkle_term(driver: &FaceDriver, hats: [Vector3<f64>; 3], refinement: &Refinement) -> Wrinkles {
    let trace = driver.compression.trace();
    let tensor = principal(&driver.compression, hats, |e| {
        driver.wrinkle_size(e, trace - e, refinement)
    });
    Wrinkles {
        tensor,
        finest: tensor.symmetric_eigenvalues().max(),
        most: driver.finest(refinement),
    }
}

impl FaceDriver {
    /// `s aᵢ` of [`sizing_field`]: the eigenvalue, 1/m², that wrinkles across the direction of
    /// principal compression `strain` ask of the sizing, where that across it is `other`.
    ///
    /// The tensor [`Self::compression`] is not used: whoever knows no directions can still tell
    /// lengths, `1 / sqrt` of it, and so the number of vertices.
    pub fn wrinkle_size(&self, strain: f64, other: f64, refinement: &Refinement) -> f64 {
        let [from, to] = refinement.onset;
        let ratio = demand(strain, other, self) / self.critical_strain;
        let t = ((ratio - from) / (to - from)).clamp(0.0, 1.0);
        self.finest(refinement) * t * t * (3.0 - 2.0 * t)
    }

    fn finest(&self, refinement: &Refinement) -> f64 {
        (refinement.points_per_wavelength / self.wavelength).powi(2)
    }
}

/// Strain that drives wrinkles across the direction of principal compression `e`, beside `other`.
///
/// `e + nu other` for the larger of the two. Where that one wrinkles, its force stays at the
/// critical one, and the smaller one is left with `(1 - nu^2) e + nu critical`: skin that is
/// squeezed one way only wrinkles one way only, however much it is squeezed.
fn demand(e: f64, other: f64, driver: &FaceDriver) -> f64 {
    let poisson = driver.poisson;
    if e >= other {
        return e + poisson * other;
    }
    let first = (other + poisson * e).min(driver.critical_strain);
    (1.0 - poisson * poisson) * e + poisson * first
}

/// Sums over the faces around a vertex, weighted by rest area.
#[derive(Clone, Debug, Default)]
struct Sums {
    area: f64,
    own: Matrix3<f64>,
    wrinkles: Matrix3<f64>,
    finest: f64,
    most: Option<f64>,
}

impl Sums {
    fn add(&mut self, area: f64, own: Matrix3<f64>, wrinkles: Option<Wrinkles>) {
        self.area += area;
        self.own += own * area;
        if let Some(term) = wrinkles {
            self.wrinkles += term.tensor * area;
            self.finest += term.finest * area;
            *self.most.get_or_insert(0.0) += term.most * area;
        }
    }

    fn tensor(&self, frame: &[Vector3<f64>; 2]) -> Matrix3<f64> {
        if self.area <= 0.0 {
            return Matrix3::zeros();
        }
        let own = Tensor2::in_frame(&(self.own / self.area), frame);
        let Some(most) = self.most.map(|most| most / self.area) else {
            return own.in_space(frame);
        };
        let mean = Tensor2::in_frame(&(self.wrinkles / self.area), frame);
        let largest = mean.eigenvalues()[0];
        let wrinkles = if largest > 0.0 {
            mean.scaled(self.finest / self.area / largest)
        } else {
            mean
        };
        // A millionth of the finest length: far under every limit, and it keeps both definite.
        let least = most * 1e-12;
        let own = own.map_eigenvalues(|value| value.clamp(least, most));
        let wrinkles = wrinkles.map_eigenvalues(|value| value.clamp(least, most));
        own.finest(wrinkles).in_space(frame)
    }
}
