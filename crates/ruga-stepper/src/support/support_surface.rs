//! The surface that a layer lies on: the layer below where there is one, driver or body elsewhere.

use nalgebra::{Matrix2, SymmetricEigen, Vector3};
use rayon::prelude::*;
use ruga_blend::{Driver, FaceStrain, PosedSurface, face_strains};
use ruga_mesh::PerFace;

use crate::skin::cover::Covers;
use crate::skin::skin_mesh::SkinMesh;
use crate::support::Support;
use crate::support::surface_below::{SurfaceBelow, lifted};

/// Squared stretches by which the bending of the layer below may change a rest metric: where that
/// layer bends within twice its offset, the offset surface is about to turn inside out.
const TRANSFER_RANGE: [f64; 2] = [0.25, 2.25];

/// Surface that a layer lies on, the part of its bending that the layer does not take over, and what the layer has
/// grown there.
#[derive(Clone, Debug)]
pub(crate) struct SupportSurface {
    /// Positions and normals at the layer's vertices; offsets are included.
    pub(crate) posed: PosedSurface,
    /// Per face the symmetric stretch of the rest metric, in the face's rest frame, that takes the
    /// untransferred part of the bending strain away.
    pub(crate) transfer: Option<Vec<Matrix2<f64>>>,
    /// Per face the symmetric stretch by which the layer's own lengths have changed, in the face's rest frame.
    pub(crate) growth: Option<PerFace<Matrix2<f64>>>,
}

impl SupportSurface {
    /// The same layer on a body whose surface is now this one.
    pub(crate) fn on_body(&self, posed: PosedSurface) -> Self {
        Self {
            posed,
            // Only upper layers leave a part of the bending below out. A body carries the lowest one.
            transfer: None,
            growth: self.growth.clone(),
        }
    }

    /// The surface below a layer that has grown like this.
    pub(crate) fn grown(self, growth: Option<PerFace<Matrix2<f64>>>) -> Self {
        Self { growth, ..self }
    }
}

/// Gives the support surface of a mesh.
pub(crate) type SupportOf<'a> = Box<dyn Fn(&SkinMesh) -> SupportSurface + 'a>;

/// The layer below, with its shape.
#[derive(Clone, Copy)]
pub(crate) struct LowerLayer<'a> {
    pub(crate) skin: &'a SkinMesh,
    pub(crate) positions: &'a [Vector3<f64>],
    /// Positions of its vertices as maps show them, m.
    pub(crate) shown: &'a [Vector3<f64>],
    /// Distance of the layer from the driver, m.
    pub(crate) offset: f64,
    /// Projections of other layers onto it, as far as they are known.
    pub(crate) covers: &'a Covers,
}

/// The layers in the shapes that maps show.
pub(crate) fn as_shown<'a>(layers: &[LowerLayer<'a>]) -> Vec<LowerLayer<'a>> {
    let shown = |layer: &LowerLayer<'a>| LowerLayer {
        positions: layer.shown,
        ..*layer
    };
    layers.iter().map(shown).collect()
}

/// How a layer is attached to its support surface.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Attachment {
    /// Distance from the driver along its normal, m.
    pub(crate) offset: f64,
    /// Fraction of the support surface's bending strain that the layer takes over, 0 to 1.
    pub(crate) bending_transfer: f64,
    /// Its tangential springs where they are not the layer's own.
    pub(crate) tangential: Option<TangentialSprings>,
}

/// What keeps a layer from sliding over another one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TangentialSprings {
    /// Stiffness per area, Pa/m.
    pub(crate) stiffness: f64,
    /// Stiffness on the gradient of the sliding, N/m.
    pub(crate) gradient: f64,
}

/// The surface below the vertices of `skin`, whose rest positions include the attachment's offset: what carries
/// all layers, and on it the `lower` ones, bottom first.
pub(crate) fn support_surface(
    on: (&Driver, &dyn Support),
    skin: &SkinMesh,
    attachment: Attachment,
    lower: &[LowerLayer<'_>],
) -> SupportSurface {
    let (middle, distance) = SurfaceBelow::new(on, skin, attachment, lower).whole();
    let positions = lifted(&middle, &distance, 1.0);
    let transfer = (attachment.offset > 0.0 && attachment.bending_transfer < 1.0).then(|| {
        // Where the layer rests, between the surface below and its own place.
        let rest: Vec<Vector3<f64>> = skin
            .rest
            .positions
            .iter()
            .zip(&skin.rest.normals)
            .zip(&distance)
            .map(|((x, n), d)| x - n * ((1.0 - attachment.bending_transfer) * d))
            .collect();
        let part = lifted(&middle, &distance, attachment.bending_transfer);
        let part = face_strains(&skin.mesh, &rest, &part);
        let whole = face_strains(&skin.mesh, &skin.rest.positions, &positions);
        untransferred(&whole, &part)
    });
    SupportSurface {
        posed: PosedSurface {
            positions,
            ..middle
        },
        transfer,
        growth: None,
    }
}

/// `A = P^-1/2 W P^-1/2` per face, as stretch `A^1/2`, of the whole metric `W` and the part `P`
/// that is taken over: with this rest metric a layer in `W` is strained as one in `P`. For bending about
/// one axis it is `l0' = l0 |dQ_t| / |dQ_teff|` of the notes.
fn untransferred(whole: &PerFace<FaceStrain>, part: &PerFace<FaceStrain>) -> Vec<Matrix2<f64>> {
    let pairs = whole.as_slice().par_iter().zip(part.as_slice());
    pairs
        .map(|(whole, part)| {
            // A part that collapses a face has no inverse root. Held at a hundredth of its length
            // it gives a metric that the range below bounds.
            let root = power(&part.cauchy_green, -0.5, [1e-4, f64::MAX]);
            let metric = root * whole.cauchy_green * root;
            power(&metric, 0.5, TRANSFER_RANGE)
        })
        .collect()
}

/// A power of a symmetric positive matrix, its eigenvalues held to a range.
fn power(matrix: &Matrix2<f64>, exponent: f64, [low, high]: [f64; 2]) -> Matrix2<f64> {
    let eigen = SymmetricEigen::new(*matrix);
    let values = eigen
        .eigenvalues
        .map(|value| value.clamp(low, high).powf(exponent));
    let vectors = eigen.eigenvectors;
    vectors * Matrix2::from_diagonal(&values) * vectors.transpose()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use nalgebra::Vector2;
    use ruga_crease::CreaseEdge;
    use ruga_mesh::{Id, VertexId};

    use super::*;
    use crate::support::PosedDriver;
    use crate::test_drivers::{SIDE, Shape, middle, skin, square};

    const OFFSET: f64 = 7e-4;
    const TRANSFER: f64 = 0.3;

    /// Places of faces and the stretches of their rest metrics, where the flat square is bent to
    /// `shape`; in its plane's axes, away from its border.
    fn stretches(shape: Shape) -> Vec<(Vector2<f64>, Matrix2<f64>)> {
        let driver = square(&|p| Vector3::new(p.x, p.y, 0.0), shape);
        let skin = skin(&driver, 1, OFFSET);
        let attachment = Attachment {
            offset: OFFSET,
            bending_transfer: TRANSFER,
            tangential: None,
        };
        let control = driver.pose(&driver.weights([("bend", 1.0)]).expect("a shape"));
        let support = PosedDriver { control };
        let below = support_surface((&driver, &support), &skin, attachment, &[]);
        let transfer = below.transfer.expect("a part is not transferred");
        let faces = skin.mesh.faces().as_slice().iter().zip(transfer);
        faces
            .map(|(corners, stretch)| {
                let [a, b, c] = corners.map(|v| skin.rest.positions[v.index()]);
                let [u, v] = ruga_mesh::triangle_frame(&[a, b, c]).map(|axis| axis.xy());
                let axes = Matrix2::from_columns(&[u, v]);
                let centre = (a + b + c).xy() / 3.0;
                (centre, axes * stretch * axes.transpose())
            })
            .filter(|(centre, _)| centre.amax() < 0.25 * SIDE)
            .collect()
    }

    /// `(1 + t k) / (1 + b t k)` for the curvature `k` of a crest.
    fn expected(curvature: f64) -> f64 {
        let bent = OFFSET * curvature;
        (1.0 + bent) / (1.0 + TRANSFER * bent)
    }

    fn sorted(stretch: &Matrix2<f64>) -> [f64; 2] {
        let values = stretch.symmetric_eigenvalues();
        [values.min(), values.max()]
    }

    /// The layer below meets its border at 35 degrees; above the kink nothing is stretched or
    /// squeezed by much more than the layer below is.
    #[test]
    fn a_layer_goes_over_to_the_driver_at_the_border_of_the_one_below() {
        let flat = |p: Vector2<f64>| Vector3::new(p.x, p.y, 0.0);
        let driver = square(&flat, &flat);
        let upper = skin(&driver, 2, OFFSET);
        let half = 0.25 * SIDE;
        let lower = middle(&driver, 0);
        let hump = |x: &Vector3<f64>| {
            let [u, v] = [x.x, x.y].map(|x| (0.5 * PI * x / half).cos());
            x + Vector3::z() * (0.7 * 2.0 * half / PI * u * v)
        };
        let positions: Vec<_> = lower.rest.positions.iter().map(hump).collect();
        let below = LowerLayer {
            skin: &lower,
            positions: &positions,
            shown: &positions,
            offset: 0.0,
            covers: &Covers::default(),
        };
        let attachment = Attachment {
            offset: OFFSET,
            bending_transfer: 1.0,
            tangential: None,
        };
        let control = driver.rest().to_vec();
        let support = PosedDriver { control };
        let surface = support_surface((&driver, &support), &upper, attachment, &[below]);
        let own = face_strains(&lower.mesh, &lower.rest.positions, &positions);
        let strains = face_strains(&upper.mesh, &upper.rest.positions, &surface.posed.positions);
        let range = |strains: &PerFace<FaceStrain>| {
            let strains = strains.as_slice().iter();
            strains.fold([0.0_f64; 2], |[low, high], s| {
                [low.min(s.second), high.max(s.first)]
            })
        };
        let ([low, high], [low_below, high_below]) = (range(&strains), range(&own));
        assert!(low > low_below - 0.1, "stretched by {}", -low);
        // Without the rim 0.68.
        assert!(high < high_below + 0.2, "squeezed by {high}");
    }

    /// Above a valley of 100 degrees a layer keeps its distance from both sides and does not go through itself.
    #[test]
    fn a_layer_goes_into_a_fold_of_the_one_below() {
        let flat = |p: Vector2<f64>| Vector3::new(p.x, p.y, 0.0);
        let driver = square(&flat, &flat);
        let (mut lower, upper) = (skin(&driver, 1, 0.0), skin(&driver, 3, OFFSET));
        let (sin, cos) = 50_f64.to_radians().sin_cos();
        let folded = |x: &Vector3<f64>| Vector3::new(cos * x.x, x.y, sin * x.x.abs());
        let positions: Vec<_> = lower.rest.positions.iter().map(folded).collect();
        let on_line = |v: VertexId| lower.rest.positions[v.index()].x.abs() < 1e-9;
        let edges = lower.mesh.edges().iter();
        let line = edges.filter(|(_, edge)| edge.vertices.into_iter().all(on_line));
        let line = line.map(|(edge, _)| CreaseEdge {
            edge,
            line: 0,
            at: [0.0; 2],
        });
        let line: Vec<CreaseEdge> = line.collect();
        assert!(!line.is_empty());
        let attachment = Attachment {
            offset: OFFSET,
            bending_transfer: 1.0,
            tangential: None,
        };
        let control = driver.rest().to_vec();
        let support = PosedDriver { control };
        let mut backwards = [0; 2];
        let mut heights = [0.0; 2];
        for (creases, backwards) in [Vec::new(), line].into_iter().zip(&mut backwards) {
            lower.creases = creases;
            heights = [f64::MAX, f64::MIN];
            let below = LowerLayer {
                skin: &lower,
                positions: &positions,
                shown: &positions,
                offset: 0.0,
                covers: &Covers::default(),
            };
            let surface = support_surface((&driver, &support), &upper, attachment, &[below]);
            let places = &surface.posed.positions;
            let faces = upper.mesh.faces().as_slice().iter();
            // The driver stays where it is, so that the border is another matter.
            let inside = faces.filter(|face| {
                face.iter()
                    .all(|v| upper.rest.positions[v.index()].xy().amax() < 0.25 * SIDE)
            });
            for face in inside {
                let [a, b, c] = face.map(|v| places[v.index()]);
                if (b - a).cross(&(c - a)).z <= 0.0 {
                    *backwards += 1;
                }
                let height = (cos * a.z - sin * a.x.abs()) / OFFSET;
                heights = [heights[0].min(height), heights[1].max(height)];
            }
            println!("{backwards} triangles lie backwards, heights {heights:?}");
        }
        // Over the bottom, which is rounded over an edge of the lower mesh, it is nearer to where the sides
        // would meet.
        assert!(heights[0] > 0.7 && heights[1] < 1.05, "{heights:?}");
        assert!(backwards[0] > 0, "nothing to mend");
        assert_eq!(backwards[1], 0);
    }

    /// Round the cylinder the rest metric takes up what is not transferred, along it nothing.
    #[test]
    fn a_cylinder_stretches_the_rest_metric_around_it() {
        let radius = 0.015;
        let cylinder = |p: Vector2<f64>| {
            let angle = p.x / radius;
            radius * Vector3::new(angle.sin(), p.y / radius, angle.cos() - 1.0)
        };
        for (_, stretch) in stretches(&cylinder) {
            let [along, around] = sorted(&stretch);
            assert!((along - 1.0).abs() < 1e-5, "{along}");
            assert!((around - expected(1.0 / radius)).abs() < 2e-4, "{around}");
        }
    }

    /// In the middle of a saddle one direction is stretched and one shortened, each by its own
    /// curvature; for small ones the fraction that is not transferred times the bending strain.
    #[test]
    fn a_saddle_has_both_signs() {
        let saddle = |curvature: f64| {
            let shape = move |p: Vector2<f64>| {
                let height = 0.5 * curvature * (p.y * p.y - p.x * p.x);
                Vector3::new(p.x, p.y, height)
            };
            let mut found = stretches(&shape);
            found.sort_by(|a, b| a.0.norm().total_cmp(&b.0.norm()));
            // The two faces that share the middle.
            0.5 * (found[0].1 + found[1].1)
        };
        let curvature = 1.0 / 0.015;
        let [low, high] = sorted(&saddle(curvature));
        assert!((high - expected(curvature)).abs() < 2e-3, "{high}");
        assert!((low - expected(-curvature)).abs() < 2e-3, "{low}");
        let step = 0.5;
        let slope = (saddle(step) - saddle(-step)) / (2.0 * step);
        let [low, high] = sorted(&slope);
        let expected = (1.0 - TRANSFER) * OFFSET;
        assert!((high / expected - 1.0).abs() < 0.02, "{high} {expected}");
        assert!((low / expected + 1.0).abs() < 0.02, "{low} {expected}");
    }
}
