//! The springs between two sheets of a layer.

use nalgebra::Vector3;

use ruga_mesh::{BlockPattern, BlockSlot};

use crate::stencil::{add_blocks, gather, slots};
use crate::{EnergyParts, LayerSpringParameters, LayerSpringState, LayerSprings, RestTriangle};

/// Springs per face, from the lower sheet to the upper one.
#[derive(Clone, Debug)]
pub(crate) struct SheetSprings {
    parameters: Vec<LayerSpringParameters>,
    offsets: Vec<f64>,
    elements: Vec<SpringElement>,
}

#[derive(Clone, Copy, Debug)]
struct SpringElement {
    springs: LayerSprings,
    /// Vertices of the lower corners, then of the upper ones.
    vertices: [u32; 6],
    slots: [BlockSlot; 21],
}

impl SheetSprings {
    /// Springs with these parameters per face and mid-surface offsets (m) per lower vertex, between
    /// faces and those above them, see [`both`]; `rest` are the lower ones.
    pub(crate) fn new(
        (faces, rest): (&[[u32; 6]], &[RestTriangle]),
        parameters: Vec<LayerSpringParameters>,
        offsets: Vec<f64>,
        pattern: &BlockPattern,
    ) -> Self {
        let elements = faces.iter().zip(rest).zip(&parameters);
        let elements = elements.map(|((&vertices, rest), parameters)| {
            let [a, b, c, ..] = vertices;
            let offsets = [a, b, c].map(|v| offsets[v as usize]);
            SpringElement {
                springs: LayerSprings::new(rest, parameters, offsets),
                vertices,
                slots: slots(pattern, &vertices),
            }
        });
        Self {
            elements: elements.collect(),
            parameters,
            offsets,
        }
    }

    /// Follows the lower sheet's rest metric.
    pub(crate) fn set_rest(&mut self, rest: &[RestTriangle]) {
        let elements = self.elements.iter_mut().zip(rest).zip(&self.parameters);
        for ((element, rest), parameters) in elements {
            let [a, b, c, ..] = element.vertices;
            // A rest metric is one in the plane: distances across the sheets do not follow it.
            let offsets = [a, b, c].map(|v| self.offsets[v as usize]);
            element.springs = LayerSprings::new(rest, parameters, offsets);
        }
    }

    pub(crate) fn parts(&self, x: &[Vector3<f64>]) -> EnergyParts {
        let mut parts = EnergyParts::default();
        for element in &self.elements {
            let [normal, gradient, tangential] =
                element.springs.values(&gather(x, &element.vertices));
            parts.normal += normal;
            parts.gradient += gradient;
            parts.tangential += tangential;
        }
        parts
    }

    pub(crate) fn add_gradient(
        &self,
        x: &[Vector3<f64>],
        pattern: &BlockPattern,
        gradient: &mut [f64],
    ) {
        for SpringElement {
            springs, vertices, ..
        } in &self.elements
        {
            let forces = springs.gradient(&gather(x, vertices));
            pattern.add_forces(gradient, vertices, &forces);
        }
    }

    /// Adds the second derivative to `exact` and its Gauss-Newton part to `relaxed`, unless empty.
    pub(crate) fn add_hessian(&self, x: &[Vector3<f64>], exact: &mut [f64], relaxed: &mut [f64]) {
        for SpringElement {
            springs,
            vertices,
            slots,
        } in &self.elements
        {
            let state = LayerSpringState::new(&gather(x, vertices));
            let mut blocks = springs.gauss_newton(&state);
            if !relaxed.is_empty() {
                add_blocks(relaxed, slots, &blocks);
            }
            springs.add_curvature(&state, &mut blocks);
            add_blocks(exact, slots, &blocks);
        }
    }
}

/// A face of the lower sheet, of so many vertices, and the one above it, numbered after them.
pub(crate) fn both([a, b, c]: [u32; 3], count: u32) -> [u32; 6] {
    [a, b, c, a + count, b + count, c + count]
}
