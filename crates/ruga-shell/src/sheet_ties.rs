//! The springs between two sheets of a layer.

use nalgebra::{Matrix3, Vector3};

use crate::layer_energy::gather;
use crate::pattern::{Pattern, Slot};
use crate::{EnergyParts, LayerTie, RestTriangle, TieParameters, TieState};

/// A tie per face, from the lower sheet to the upper one.
#[derive(Clone, Debug)]
pub(crate) struct SheetTies {
    parameters: Vec<TieParameters>,
    levers: Vec<f64>,
    elements: Vec<TieElement>,
}

#[derive(Clone, Copy, Debug)]
struct TieElement {
    tie: LayerTie,
    /// Lower corners, then upper ones.
    vertices: [u32; 6],
    slots: [Slot; 15],
}

/// Row and column, within a tie, of the off-diagonal blocks in the order of the slots, and their
/// positions in the stencil's list of lower blocks.
const PAIRS: [([usize; 2], usize); 15] = [
    ([1, 0], 1),
    ([2, 0], 3),
    ([2, 1], 4),
    ([3, 0], 6),
    ([3, 1], 7),
    ([3, 2], 8),
    ([4, 0], 10),
    ([4, 1], 11),
    ([4, 2], 12),
    ([4, 3], 13),
    ([5, 0], 15),
    ([5, 1], 16),
    ([5, 2], 17),
    ([5, 3], 18),
    ([5, 4], 19),
];
const DIAGONAL: [usize; 6] = [0, 2, 5, 9, 14, 20];

impl SheetTies {
    /// Ties with these parameters per face and levers (m) per vertex, on `faces` of a lower sheet of
    /// `count` vertices, the upper ones being numbered after them.
    pub(crate) fn new(
        (faces, rest, count): (&[[u32; 3]], &[RestTriangle], usize),
        parameters: Vec<TieParameters>,
        levers: Vec<f64>,
        pattern: &Pattern,
    ) -> Self {
        let elements = faces.iter().zip(rest).zip(&parameters);
        let elements = elements.map(|((face, rest), parameters)| {
            let vertices = both(face, count);
            TieElement {
                tie: LayerTie::new(rest, parameters, face.map(|v| levers[v as usize])),
                vertices,
                slots: PAIRS.map(|([i, j], _)| pattern.slot(vertices[i], vertices[j])),
            }
        });
        Self {
            elements: elements.collect(),
            parameters,
            levers,
        }
    }

    /// Every two vertices that share a tie on one of `faces`, but for those of one sheet.
    pub(crate) fn pairs(faces: &[[u32; 3]], count: usize) -> impl Iterator<Item = [u32; 2]> + '_ {
        faces.iter().flat_map(move |face| {
            let vertices = both(face, count);
            (0..9).map(move |k| [vertices[k / 3], vertices[3 + k % 3]])
        })
    }

    /// Follows the lower sheet's rest metric.
    pub(crate) fn set_rest(&mut self, rest: &[RestTriangle]) {
        let elements = self.elements.iter_mut().zip(rest).zip(&self.parameters);
        for ((element, rest), parameters) in elements {
            let [a, b, c, ..] = element.vertices;
            let levers = [a, b, c].map(|v| self.levers[v as usize]);
            element.tie = LayerTie::new(rest, parameters, levers);
        }
    }

    pub(crate) fn parts(&self, x: &[Vector3<f64>]) -> EnergyParts {
        let mut parts = EnergyParts::default();
        for element in &self.elements {
            let [normal, gradient, tangential] = element.tie.values(&gather(x, &element.vertices));
            parts.normal += normal;
            parts.gradient += gradient;
            parts.tangential += tangential;
        }
        parts
    }

    pub(crate) fn add_gradient(&self, x: &[Vector3<f64>], pattern: &Pattern, gradient: &mut [f64]) {
        for TieElement { tie, vertices, .. } in &self.elements {
            let forces = tie.gradient(&gather(x, vertices));
            pattern.add_forces(gradient, vertices, &forces);
        }
    }

    /// An empty `relaxed` is not wanted; it takes the Gauss-Newton part.
    pub(crate) fn add_hessian(
        &self,
        x: &[Vector3<f64>],
        pattern: &Pattern,
        exact: &mut [f64],
        relaxed: &mut [f64],
    ) {
        for element in &self.elements {
            let state = TieState::new(&gather(x, &element.vertices));
            let mut blocks = element.tie.gauss_newton(&state);
            let add = |values: &mut [f64], blocks: &[Matrix3<f64>; 21]| {
                for (&vertex, block) in element.vertices.iter().zip(DIAGONAL) {
                    pattern.add_diagonal(values, vertex, &blocks[block]);
                }
                for (&slot, (_, block)) in element.slots.iter().zip(PAIRS) {
                    Pattern::add_block(values, slot, &blocks[block]);
                }
            };
            if !relaxed.is_empty() {
                add(relaxed, &blocks);
            }
            element.tie.add_curvature(&state, &mut blocks);
            add(exact, &blocks);
        }
    }
}

/// A face of the lower sheet and the one above it.
fn both([a, b, c]: &[u32; 3], count: usize) -> [u32; 6] {
    let above = |vertex: &u32| vertex + count as u32;
    [*a, *b, *c, above(a), above(b), above(c)]
}
