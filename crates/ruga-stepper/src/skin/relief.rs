//! How much of a layer's relief results show: its strength, its masks' grey, and a fade at borders.

use nalgebra::{Rotation3, Vector3};
use ruga_blend::{Driver, PosedSurface};
use ruga_material::Wrinkling;

use crate::skin::fading::{distances_from, faded};
use crate::skin::material_places::{is_on_border, uv};
use crate::skin::skin_mesh::SkinMesh;
use crate::skin::wavelength_field::WavelengthField;
use crate::{LayerSpec, StepperError};

/// Width of the fade inside a border, in wavelengths: the ring of pinned vertices ends a wrinkle at
/// full slope, and half a wave is the least over which a crest runs out without a corner.
pub(crate) const FADE: f64 = 0.5;

/// Grey at a border up to which the painted mask itself has faded the relief.
const FADED: f64 = 0.25;

/// Factors on a layer's relief at the vertices of a mesh, whatever the pose.
#[derive(Clone, Debug)]
pub(crate) struct ReliefWeights {
    pub(crate) weights: Vec<f64>,
    /// Vertices where the region is cut off from skin that goes on.
    pub(crate) is_cut: Vec<bool>,
}

impl ReliefWeights {
    /// Computes the factors for `skin`, a mesh of the layer's region.
    ///
    /// Relief fades inside the border of the region, which is held on the surface below, unless that is
    /// the border of the artist's mesh: there is no skin beyond it to be cut from.
    pub(crate) fn new(
        driver: &Driver,
        spec: &LayerSpec,
        nominal: &Wrinkling,
        skin: &SkinMesh,
    ) -> Result<Self, StepperError> {
        let points = skin.points.points();
        let outline = driver.topology().border_vertices();
        let border = skin.held();
        let is_cut: Vec<bool> = points
            .iter()
            .zip(border.as_slice())
            .map(|(place, on_border)| {
                *on_border
                    && !is_on_border(driver.topology(), &outline, place)
                    && spec.presence.grey(uv(driver, place)) > FADED
            })
            .collect();
        let mut weights = vec![spec.presence.strength; points.len()];
        if is_cut.contains(&true) {
            let wavelengths = WavelengthField::new(spec, nominal, driver, skin);
            // The wavelength is a search for a minimum, and few vertices are near a border.
            let furthest = FADE * wavelengths.longest();
            let distances = distances_from(&skin.mesh, &skin.rest.positions, &is_cut, furthest);
            for (vertex, distance) in distances.into_iter().enumerate() {
                if distance.is_finite() {
                    weights[vertex] *= faded(distance, FADE * wavelengths.at(vertex)?);
                }
            }
        }
        for (weight, place) in weights.iter_mut().zip(points) {
            *weight *= spec.presence.grey(uv(driver, place));
        }
        Ok(Self { weights, is_cut })
    }
}

/// Positions of the vertices on a surface `shown` below them, which keep their `weights` of the
/// deviation from the real one.
pub(crate) fn shown_positions(
    positions: &[Vector3<f64>],
    real: &PosedSurface,
    shown: &PosedSurface,
    weights: &[f64],
) -> Vec<Vector3<f64>> {
    (0..positions.len())
        .map(|i| {
            let deviation = positions[i] - real.positions[i];
            // The surface shown is turned where the layer below it is shown flatter than it is.
            let turned = turn_between(real, shown, i) * deviation;
            shown.positions[i] + weights[i] * turned
        })
        .collect()
}

/// Rotation of the surface at one vertex between two poses.
pub(crate) fn turn_between(
    old: &PosedSurface,
    new: &PosedSurface,
    vertex: usize,
) -> Rotation3<f64> {
    let frame = |surface: &PosedSurface| {
        let (n, t) = (surface.normals[vertex], surface.tangents[vertex]);
        Rotation3::from_basis_unchecked(&[t, n.cross(&t), n])
    };
    frame(new) * frame(old).inverse()
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;
    use ruga_material::wrinkling;

    use super::*;
    use crate::test_drivers::{SIDE, knuckle, middle, square_mesh};
    use crate::{Mask, Presence};

    /// Weights on the inner half of a square, under one grey everywhere: the least and the greatest at
    /// its border, and the least well inside.
    fn weights(grey: f32, strength: f64) -> [f64; 3] {
        let flat = |p: Vector2<f64>| Vector3::new(p.x, p.y, 0.0);
        let mut mesh = square_mesh(&flat, &flat);
        for uv in mesh.uvs.iter_mut().flatten() {
            *uv = (*uv / SIDE).add_scalar(0.5);
        }
        let driver = Driver::new(&mesh).expect("a square");
        let inside = |x: &Vector3<f64>, half: f64| x.xy().amax() < half + 1e-9;
        let skin = middle(&driver, 1);
        let spec = LayerSpec {
            presence: Presence {
                masks: vec![Mask::new(1, 1, vec![grey]).expect("a grey")],
                strength,
            },
            ..knuckle()
        };
        let nominal = wrinkling(&spec.material, &spec.substrate, spec.model).expect("a preset");
        let found = ReliefWeights::new(&driver, &spec, &nominal, &skin).expect("weights");
        let found = found.weights;
        let border = skin.mesh.border_vertices();
        let of_border = || found.iter().zip(border.as_slice()).filter(|(_, b)| **b);
        let of_middle = found.iter().zip(&skin.rest.positions);
        let of_middle = of_middle.filter(|(_, x)| inside(x, 0.25 * SIDE - nominal.wavelength));
        [
            of_border().map(|(weight, _)| *weight).fold(1.0, f64::min),
            of_border().map(|(weight, _)| *weight).fold(0.0, f64::max),
            of_middle.map(|(weight, _)| *weight).fold(1.0, f64::min),
        ]
    }

    /// A mask that is cut off fades by distance, one whose own grey has faded at the border by that
    /// alone: both at once would eat half a wavelength of what the artist has painted.
    #[test]
    fn a_soft_mask_is_its_own_fade() {
        let near = |found: [f64; 3], expected: [f64; 3]| {
            let pairs = found.iter().zip(&expected);
            assert!(
                pairs.clone().all(|(f, e)| (f - e).abs() < 1e-6),
                "{found:?}"
            );
        };
        near(weights(1.0, 1.0), [0.0, 0.0, 1.0]);
        near(weights(0.5, 1.5), [0.0, 0.0, 0.75]);
        near(weights(0.25, 1.0), [0.25, 0.25, 0.25]);
        near(weights(0.2, 1.0), [0.2, 0.2, 0.2]);
    }
}
