//! Relief at the vertices of the layer: height and tilt against the smooth driver.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use rayon::prelude::*;

use crate::surface_fit::{FittedNormal, Sample, SurfaceFit, fit_surface};
use crate::tangent_frames::any_orthogonal;
use crate::{Frame, Relief};

/// Relief at one vertex, for the rasteriser to interpolate.
///
/// The direction at a place is `base + tilt`, unit at vertices.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VertexRelief {
    /// [`Frame::Driver`]: the smooth driver normal. [`Frame::Mesh`]: the layer's normal.
    pub base: Vector3<f64>,
    /// Part of the direction that wrinkles add; zero in [`Frame::Mesh`].
    pub tilt: Vector3<f64>,
    /// Derivative of `tilt` (of `base` in [`Frame::Mesh`]) by the driver position, 1/m.
    pub slope: Matrix3<f64>,
    /// Wrinkle height, m.
    pub height: f64,
    /// Derivative of the height by the driver position.
    pub height_slope: Vector3<f64>,
}

/// Evaluates every vertex of the layer.
pub(crate) fn vertex_reliefs(relief: &Relief, frame: Frame) -> Vec<VertexRelief> {
    let rings = Rings::new(relief.positions.len(), relief.faces);
    // A pass of its own, because the fit at a vertex needs the feet of two rings around it.
    let feet: Vec<Foot> = (0..relief.positions.len())
        .into_par_iter()
        .map(|vertex| foot(relief, &rings, vertex))
        .collect();
    (0..relief.positions.len())
        .into_par_iter()
        .map_init(Vec::new, |samples, vertex| {
            let neighbours = rings.gather(vertex);
            samples.clear();
            samples.extend(
                neighbours
                    .ids()
                    .iter()
                    .map(|&other| sample(relief, &feet, vertex, other as usize)),
            );
            let normal = &relief.driver_normals[vertex];
            let mut fit = fit_surface(normal, samples);
            match frame {
                Frame::Driver => {
                    fit.foot =
                        upright_foot(relief, (vertex, &neighbours), &fit, samples, &feet[vertex]);
                    driver_relief(*normal, &feet[vertex], &fit)
                }
                Frame::Mesh => mesh_relief(&feet[vertex], &fit),
            }
        })
        .collect()
}

fn driver_relief(normal: Vector3<f64>, foot: &Foot, fit: &SurfaceFit) -> VertexRelief {
    // The foot points' curvature is taken off, not the driver's: both fits then share their error,
    // and where nothing wrinkles the slope is zero.
    let [du, dv] = [0, 1].map(|axis| fit.layer.derivative[axis] - fit.foot.derivative[axis]);
    let direction = rotate(&fit.foot, &fit.layer, &normal);
    VertexRelief {
        base: normal,
        tilt: direction - normal,
        slope: du * fit.axes[0].transpose() + dv * fit.axes[1].transpose(),
        height: foot.height,
        height_slope: height_slope(fit),
    }
}

/// Surface through the foot points around a vertex. Where the layer overhangs these run backwards, and their fit would
/// face down: there it is the driver's own.
///
/// Where the driver is bent more sharply than the layer is away from it, foot points run backwards, too, but with
/// them those of the layer without wrinkles. Layer and foot points then share the error of their fits, which stays
/// out of the map.
fn upright_foot(
    relief: &Relief,
    (vertex, neighbours): (usize, &Neighbours),
    fit: &SurfaceFit,
    samples: &[Sample],
    foot: &Foot,
) -> FittedNormal {
    let reliability = fit.foot.reliability();
    if reliability == 1.0 {
        return fit.foot;
    }
    let raised = |v: usize| relief.driver_positions[v] + relief.driver_normals[v] * relief.offset;
    let pairs = samples.iter().zip(neighbours.ids());
    let unwrinkled: Vec<_> = pairs
        .map(|(sample, &other)| Sample {
            foot: raised(other as usize) - raised(vertex),
            ..*sample
        })
        .collect();
    let driver = fit_surface(&relief.driver_normals[vertex], &unwrinkled).foot;
    let share = 1.0 - (driver.reliability() - reliability).max(0.0);
    let driver = FittedNormal {
        normal: foot.below,
        ..driver
    };
    fit.foot.blended(share, &driver)
}

fn mesh_relief(foot: &Foot, fit: &SurfaceFit) -> VertexRelief {
    let [du, dv] = fit.layer.derivative;
    VertexRelief {
        base: fit.layer.normal,
        tilt: Vector3::zeros(),
        slope: du * fit.axes[0].transpose() + dv * fit.axes[1].transpose(),
        height: foot.height,
        height_slope: height_slope(fit),
    }
}

fn height_slope(fit: &SurfaceFit) -> Vector3<f64> {
    fit.axes[0] * fit.height_slope[0] + fit.axes[1] * fit.height_slope[1]
}

/// `v` under the smallest rotation that takes the foot's normal to the layer's.
fn rotate(foot: &FittedNormal, layer: &FittedNormal, v: &Vector3<f64>) -> Vector3<f64> {
    let axis = foot.normal.cross(&layer.normal);
    let cosine = foot.normal.dot(&layer.normal);
    // Opposite normals have no smallest rotation.
    if cosine < -0.999 {
        return layer.normal;
    }
    // Rodrigues' formula with the sine in the length of the axis, so no angle is computed.
    v + axis.cross(v) + axis.cross(&axis.cross(v)) / (1.0 + cosine)
}

/// Foot point of a vertex of the layer on the driver.
#[derive(Debug, Clone, Copy)]
struct Foot {
    /// The vertex moved down to its rest distance from the driver, m.
    position: Vector3<f64>,
    /// Wrinkle height (m): how far down that is.
    height: f64,
    /// Unit normal of the driver there.
    below: Vector3<f64>,
}

/// Moves a vertex along the driver's normal to its rest distance.
///
/// A layer slides over the driver, so the driver's point `q` below `x` is not the vertex's own
/// material point `p`. With the driver's curvature `S = dn/dp` and the sliding `t`, the tangential
/// part of `x - p` brought down to the driver, `n_q = n cos + S t` and
/// `q = p + t - n (t·S t) / (1 + cos)` with `cos² = 1 - |S t|²`: second order in general, exact on
/// spheres and across cylinders. Height `w = n_q·(x - q) - offset`; foot point `x - w n_q`.
fn foot(relief: &Relief, rings: &Rings, vertex: usize) -> Foot {
    // Further than this the driver turns by 30 degrees under the sliding: no local model holds.
    const MAX_TURN: f64 = 0.5;
    let x = relief.positions[vertex];
    let p = relief.driver_positions[vertex];
    let n = relief.driver_normals[vertex];
    let rise = n.dot(&(x - p));
    let tangential = x - p - n * rise;

    let u = any_orthogonal(&n);
    let axes = [u, n.cross(&u)];
    let curvature = driver_curvature(relief, rings, vertex, &axes);
    // At the height `rise` a parallel surface is longer than the driver by `1 + curvature * rise`;
    // curvature is positive where the driver is convex.
    let lowering = Matrix2::identity() + curvature * rise;
    let sliding = Vector2::new(axes[0].dot(&tangential), axes[1].dot(&tangential));
    let sliding = match lowering.try_inverse() {
        // Near zero the layer is at a centre of curvature, where all normals of the driver meet and
        // none is below it. The sliding is then better left as it is.
        Some(inverse) if lowering.determinant() > 0.1 => inverse * sliding,
        _ => sliding,
    };
    let mut turn = curvature * sliding;
    if turn.norm() > MAX_TURN {
        turn *= MAX_TURN / turn.norm();
    }
    let cosine = (1.0 - turn.norm_squared()).sqrt();
    let world = |v: &Vector2<f64>| axes[0] * v.x + axes[1] * v.y;
    let below = n * cosine + world(&turn);
    let q = p + world(&sliding) - n * (sliding.dot(&turn) / (1.0 + cosine));
    let height = below.dot(&(x - q)) - relief.offset;
    Foot {
        position: x - below * height,
        height,
        below,
    }
}

/// Shape operator of the driver at a vertex in `axes` (1/m): symmetric least squares of the
/// driver's normals over the first ring, zero where that does not determine it.
fn driver_curvature(
    relief: &Relief,
    rings: &Rings,
    vertex: usize,
    axes: &[Vector3<f64>; 2],
) -> Matrix2<f64> {
    let mut moments = Matrix2::zeros();
    let mut turns = Matrix2::zeros();
    for &other in rings.first(vertex) {
        let plane = |v: Vector3<f64>| Vector2::new(axes[0].dot(&v), axes[1].dot(&v));
        let other = other as usize;
        let step = plane(relief.driver_positions[other] - relief.driver_positions[vertex]);
        let turn = plane(relief.driver_normals[other] - relief.driver_normals[vertex]);
        // Step and turn both grow with the edge; without the weight the longest would decide.
        let weight = 1.0 / step.norm_squared().max(f64::MIN_POSITIVE);
        moments += step * step.transpose() * weight;
        turns += turn * step.transpose() * weight;
    }
    match moments.try_inverse() {
        // Neighbours on one line know nothing of the curvature across it.
        Some(inverse) if moments.determinant() > 1e-6 * moments.trace().powi(2) => {
            let curvature = turns * inverse;
            // A shape operator is symmetric; the rest is error of the fit.
            (curvature + curvature.transpose()) / 2.0
        }
        _ => Matrix2::zeros(),
    }
}

fn sample(relief: &Relief, feet: &[Foot], vertex: usize, other: usize) -> Sample {
    Sample {
        driver: relief.driver_positions[other] - relief.driver_positions[vertex],
        facing: relief.driver_normals[other].dot(&relief.driver_normals[vertex]),
        layer: relief.positions[other] - relief.positions[vertex],
        foot: feet[other].position - feet[vertex].position,
        height: feet[other].height - feet[vertex].height,
    }
}

/// Vertices joined to each vertex by an edge.
struct Rings {
    starts: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Rings {
    /// A cubic has nine coefficients; with fewer neighbours than this another ring is taken.
    const ENOUGH: usize = 15;
    /// Bounds the work at vertices of very high valence.
    const MOST: usize = 40;

    fn new(vertices: usize, faces: &[[u32; 3]]) -> Self {
        let mut starts = vec![0_u32; vertices + 1];
        for &vertex in faces.iter().flatten() {
            starts[vertex as usize + 1] += 2;
        }
        for vertex in 0..vertices {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut doubled = vec![0; starts[vertices] as usize];
        for &[a, b, c] in faces {
            for [from, to] in [[a, b], [a, c], [b, c], [b, a], [c, a], [c, b]] {
                doubled[next[from as usize] as usize] = to;
                next[from as usize] += 1;
            }
        }
        Self::without_repeats(&starts, &mut doubled)
    }

    /// Drops repeated neighbours: interior edges come twice, once from either face.
    fn without_repeats(starts: &[u32], doubled: &mut [u32]) -> Self {
        let mut rings = Self {
            starts: Vec::with_capacity(starts.len()),
            neighbours: Vec::with_capacity(doubled.len() / 2),
        };
        rings.starts.push(0);
        for range in starts.windows(2) {
            let ring = &mut doubled[range[0] as usize..range[1] as usize];
            ring.sort_unstable();
            let mut last = None;
            for &vertex in ring.iter() {
                if last != Some(vertex) {
                    rings.neighbours.push(vertex);
                }
                last = Some(vertex);
            }
            rings.starts.push(rings.neighbours.len() as u32);
        }
        rings
    }

    fn first(&self, vertex: usize) -> &[u32] {
        &self.neighbours[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// Two rings of neighbours, three where two are too few (borders, corners).
    fn gather(&self, vertex: usize) -> Neighbours {
        let mut found = Neighbours {
            ids: [0; Self::MOST],
            count: 0,
        };
        self.add_around(vertex, vertex, &mut found);
        let mut ring = 0..found.count;
        for _ in 1..3 {
            let end = found.count;
            for index in ring {
                self.add_around(found.ids[index] as usize, vertex, &mut found);
            }
            ring = end..found.count;
            if found.count >= Self::ENOUGH {
                break;
            }
        }
        found
    }

    fn add_around(&self, center: usize, vertex: usize, found: &mut Neighbours) {
        for &other in self.first(center) {
            // At most 40 ids, so a linear search will do.
            let known = other as usize == vertex || found.ids().contains(&other);
            if !known && found.count < Self::MOST {
                found.ids[found.count] = other;
                found.count += 1;
            }
        }
    }
}

/// The vertices around one, nearest ring first.
struct Neighbours {
    ids: [u32; Rings::MOST],
    count: usize,
}

impl Neighbours {
    fn ids(&self) -> &[u32] {
        &self.ids[..self.count]
    }
}
