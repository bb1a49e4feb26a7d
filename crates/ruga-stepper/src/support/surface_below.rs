//! The surface below the vertices of a layer, made for some of them at a time.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::Vector3;
use ruga_blend::{Driver, PosedSurface};
use ruga_mesh::vertex_normals;

use crate::skin::cover::Cover;
use crate::skin::parts::{VERTICES_AT_A_TIME, in_parts, in_parts_of};
use crate::skin::skin_mesh::SkinMesh;
use crate::support::support_surface::{Attachment, LowerLayer};
use crate::support::{Support, Under};

/// Width of the rim over which the normals of the layer below turn into the driver's, in the
/// distance between the two layers. That layer ends in a hinge; above a kink of 36 degrees, which a
/// real forehead has, skin would be stretched to twice its length or turned inside out.
const RIM: f64 = 4.0;

/// Cosine of half of a fold from which on the layer above does not rise with it any more: its edge would be as high
/// as a needle.
const LEAST_COSINE: f64 = 0.5;

/// The surface that a layer lies on, made at some of its vertices at a time.
pub(crate) struct SurfaceBelow<'s> {
    under: Box<dyn Under + 's>,
    vertices: usize,
    /// Distance of the layer from the driver, m.
    offset: f64,
    /// The layers between, bottom first.
    lower: Vec<Laid>,
}

/// A layer that another one lies on.
struct Laid {
    cover: Arc<Cover>,
    /// Control points of its deviations from what carries all layers, m.
    control: Vec<Vector3<f64>>,
    /// Normals of its vertices, where it has folds.
    normals: Vec<Vector3<f64>>,
    /// Height of the layer above over it, m.
    height: f64,
}

/// The surface below some vertices of a layer.
pub(crate) struct PartBelow {
    /// What carries all layers there.
    support: PosedSurface,
    /// What the layer lies on, without its own height above that.
    middle: PosedSurface,
    /// That height along the normals, m.
    distance: Vec<f64>,
}

impl PartBelow {
    /// What carries all layers, and the surface at the layer's own height.
    pub(crate) fn lifted_over_support(self) -> (PosedSurface, PosedSurface) {
        let surface = PosedSurface {
            positions: lifted(&self.middle, &self.distance, 1.0),
            ..self.middle
        };
        (self.support, surface)
    }
}

impl<'s> SurfaceBelow<'s> {
    /// The surface below `skin`, a mesh that is attached like this: what carries all layers, and on it the `lower`
    /// ones, bottom first.
    pub(crate) fn new(
        (driver, support): (&Driver, &'s dyn Support),
        skin: &'s SkinMesh,
        attachment: Attachment,
        lower: &[LowerLayer<'_>],
    ) -> Self {
        let laid = |lower: &LowerLayer<'_>| {
            let height = attachment.offset - lower.offset;
            let cover = lower.covers.of(driver, skin, lower.skin, RIM * height);
            // The base is without any offset, so that a deviation includes the lower layer's. Deviations, not
            // positions, are interpolated: they vanish at the layer's ragged border, where a smooth surface through
            // positions would cut the corners.
            let base = support.pose(lower.skin).positions;
            let deviations = lower.positions.iter().zip(&base);
            let deviations: Vec<Vector3<f64>> = deviations.map(|(x, base)| x - base).collect();
            Laid {
                control: cover.control(&deviations),
                normals: match cover.has_folds() {
                    true => vertex_normals(&lower.skin.mesh, lower.positions),
                    false => Vec::new(),
                },
                cover,
                height,
            }
        };
        Self {
            under: support.under(skin),
            vertices: skin.mesh.vertex_count(),
            offset: attachment.offset,
            lower: lower.iter().map(laid).collect(),
        }
    }

    /// The surface at some of the vertices.
    pub(crate) fn at(&self, vertices: Range<usize>) -> PartBelow {
        let support = self.under.pose(vertices.clone());
        let mut middle = support.clone();
        let mut distance = vec![self.offset; vertices.len()];
        if !self.lower.is_empty() {
            let derivatives = self.under.derivatives(vertices.clone());
            // What an upper one of them covers is its surface; where it is not, that of the next lower one.
            for lower in &self.lower {
                let on = (&support, derivatives.as_slice(), vertices.clone());
                lower.lay(on, &mut middle, &mut distance);
            }
        }
        PartBelow {
            support,
            middle,
            distance,
        }
    }

    /// Unit normals of the surface at all vertices.
    pub(crate) fn normals(&self) -> Vec<Vector3<f64>> {
        let mut normals = Vec::with_capacity(self.vertices);
        let of_part = |vertices| self.at(vertices).middle.normals;
        in_parts(self.vertices, of_part, |part| normals.extend(part));
        normals
    }

    /// The surface at all vertices, without the layer's own height above it, and that height (m).
    pub(super) fn whole(&self) -> (PosedSurface, Vec<f64>) {
        self.whole_in_parts(VERTICES_AT_A_TIME)
    }

    fn whole_in_parts(&self, most: usize) -> (PosedSurface, Vec<f64>) {
        let mut middle = PosedSurface {
            positions: Vec::with_capacity(self.vertices),
            normals: Vec::with_capacity(self.vertices),
            tangents: Vec::with_capacity(self.vertices),
        };
        let mut distance = Vec::with_capacity(self.vertices);
        in_parts_of(
            most,
            self.vertices,
            |vertices| self.at(vertices),
            |part| {
                middle.positions.extend(part.middle.positions);
                middle.normals.extend(part.middle.normals);
                middle.tangents.extend(part.middle.tangents);
                distance.extend(part.distance);
            },
        );
        (middle, distance)
    }

    /// The surface at all vertices at the layer's own height.
    pub(crate) fn lifted(&self) -> PosedSurface {
        let (middle, distance) = self.whole();
        PosedSurface {
            positions: lifted(&middle, &distance, 1.0),
            ..middle
        }
    }
}

impl Laid {
    /// Puts this layer, at some vertices of the one above, in the place of what lies below it, wherever it is. Over a
    /// rim its normals turn into those of what is there without it. `distance` becomes how far along the normals the
    /// layer above is (m).
    ///
    /// Beside a fold they turn into the one between its two sides, which would cross each other above it: the layer
    /// above then has a fold of its own, as high above both sides as elsewhere.
    fn lay(
        &self,
        (support, derivatives, vertices): (&PosedSurface, &[[Vector3<f64>; 2]], Range<usize>),
        middle: &mut PosedSurface,
        distance: &mut [f64],
    ) {
        let cover = &self.cover;
        let ranks = cover.ranks(&vertices);
        let changes = cover.interpolate(&self.control, ranks.clone());
        for (k, change) in ranks.zip(&changes) {
            let (vertex, fraction) = (cover.vertices()[k] as usize, cover.weights()[k]);
            let i = vertex - vertices.start;
            let [along_u, along_v] = cover.along(k, change);
            // It is added to the driver's or body's own place, because the deviation of a layer counts
            // from there and not from another layer that is covered too.
            middle.positions[i] = support.positions[i] + change.position;
            let first = derivatives[i][0] + along_u;
            let second = derivatives[i][1] + along_v;
            let normal = first.cross(&second).try_normalize(0.0);
            let mut rise = 1.0;
            let normal = normal.map(|normal| match cover.fold(k) {
                None => normal,
                Some(fold) => {
                    let [a, b] = fold.ends.map(|v| self.normals[v]);
                    let turned = a.lerp(&b, fold.fraction).lerp(&normal, fold.beside);
                    let turned = turned.try_normalize(0.0).unwrap_or(normal);
                    rise += fraction * (1.0 / turned.dot(&normal).max(LEAST_COSINE) - 1.0);
                    turned
                }
            });
            distance[i] = rise * self.height;
            let normal = normal.map(|normal| middle.normals[i].lerp(&normal, fraction));
            if let Some(normal) = normal.and_then(|normal| normal.try_normalize(0.0)) {
                // The normal has been turned in the rim, so that the first tangent is no longer at
                // right angles to it.
                let tangent = first - normal * normal.dot(&first);
                middle.tangents[i] = tangent.try_normalize(0.0).unwrap_or(middle.tangents[i]);
                middle.normals[i] = normal;
            }
        }
    }
}

/// Places at a `fraction` of their distance (m) above a surface.
pub(super) fn lifted(surface: &PosedSurface, distance: &[f64], fraction: f64) -> Vec<Vector3<f64>> {
    let places = surface.positions.iter().zip(&surface.normals).zip(distance);
    places.map(|((x, n), d)| x + n * (fraction * d)).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::skin::cover::Covers;
    use crate::support::PosedDriver;
    use crate::test_drivers::{middle, skin, square};

    /// Over a layer that covers the middle alone, which is lifted there.
    #[test]
    fn parts_of_the_surface_are_the_same_as_all_of_it() {
        let bowl = |p: Vector2<f64>| Vector3::new(p.x, p.y, 3.0 * p.norm_squared());
        let driver = square(&bowl, &bowl);
        let upper = skin(&driver, 2, 7e-4);
        let lower = middle(&driver, 0);
        let lift = |x: &Vector3<f64>| x + Vector3::z() * 1e-3 * (900.0 * x.x).sin();
        let positions: Vec<_> = lower.rest.positions.iter().map(lift).collect();
        let below = LowerLayer {
            skin: &lower,
            positions: &positions,
            shown: &positions,
            offset: 0.0,
            covers: &Covers::default(),
        };
        let support = PosedDriver {
            control: driver.rest().to_vec(),
        };
        let attachment = Attachment {
            offset: 7e-4,
            ..Attachment::default()
        };
        let surface = SurfaceBelow::new((&driver, &support), &upper, attachment, &[below]);
        let [(all, heights), (parts, part_heights)] =
            [usize::MAX >> 1, 7].map(|most| surface.whole_in_parts(most));
        assert!(all.positions.len() > 100 && all.positions == parts.positions);
        assert!(all.normals == parts.normals && all.tangents == parts.tangents);
        assert!(heights == part_heights && surface.normals() == all.normals);
        let [flat, lifted] = [&[][..], &[below]].map(|lower| {
            let on = (&driver, &support as &dyn Support);
            SurfaceBelow::new(on, &upper, attachment, lower).lifted()
        });
        let moved = flat.positions.iter().zip(&lifted.positions);
        let moved = moved.filter(|(flat, lifted)| flat != lifted).count();
        assert!(moved > 10 && moved < flat.positions.len() / 2, "{moved}");
    }
}
