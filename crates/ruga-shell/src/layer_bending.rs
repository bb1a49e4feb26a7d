//! The bending energy of a whole layer, by either model.

use nalgebra::{Matrix3, Vector3};

use crate::edges::Edge;
use crate::hinge::{Hinge, HingeState};
use crate::hinge_stiffness::{HINGE_EXPONENT, HingeShape};
use crate::layer_energy::gather;
use crate::pattern::{Pattern, Slot};
use crate::stars::{Star, stars};
use crate::vertex_curvature::weighted;
use crate::{BendingModel, FaceParameters, RestTriangle};

/// Hinges at all inner edges and, if the model has them, the stars that their angles go into.
#[derive(Clone, Debug)]
pub(crate) struct LayerBending {
    hinges: Vec<HingeElement>,
    stars: Vec<StarElement>,
    factor: f64,
}

#[derive(Clone, Copy, Debug)]
struct HingeElement {
    hinge: Hinge,
    vertices: [u32; 4],
    /// Index of the edge it lies on.
    edge: usize,
    slots: [Slot; 6],
}

#[derive(Clone, Debug)]
struct StarElement {
    star: Star,
    /// Per inner edge, see [`crate::StarShape`].
    rows: Vec<Vector3<f64>>,
    /// Per inner edge, the hinge on it.
    hinges: Vec<u32>,
    /// Of the blocks below the diagonal, row by row.
    slots: Vec<Slot>,
}

/// Row and column, within a hinge, of the off-diagonal blocks in the order of the slots, and their
/// positions in the list of lower blocks.
const HINGE_PAIRS: [([usize; 2], usize); 6] = [
    ([1, 0], 1),
    ([2, 0], 3),
    ([2, 1], 4),
    ([3, 0], 6),
    ([3, 1], 7),
    ([3, 2], 8),
];
const HINGE_DIAGONAL: [usize; 4] = [0, 2, 5, 9];

/// The stars that a model bends at; none with hinges.
pub(crate) fn bending_stars(model: BendingModel, faces: &[[u32; 3]], edges: &[Edge]) -> Vec<Star> {
    match model {
        BendingModel::Hinge => Vec::new(),
        BendingModel::VertexCurvature => stars(faces, edges),
    }
}

impl LayerBending {
    /// Rest angles are those of `rest`; stiffness is set later, because the rest metric changes it.
    pub(crate) fn new(
        stars: Vec<Star>,
        faces: &[[u32; 3]],
        edges: &[Edge],
        rest: &[Vector3<f64>],
        pattern: &Pattern,
    ) -> Self {
        let mut hinge_of = vec![0; edges.len()];
        let mut hinges = Vec::new();
        for (edge, topology) in edges.iter().enumerate() {
            let Some((vertices, _)) = topology.hinge(faces) else {
                continue;
            };
            hinge_of[edge] = hinges.len() as u32;
            hinges.push(HingeElement {
                hinge: Hinge {
                    stiffness: 0.0,
                    rest_angle: HingeState::new(&gather(rest, &vertices)).angle(),
                },
                vertices,
                edge,
                slots: HINGE_PAIRS.map(|([i, j], _)| pattern.slot(vertices[i], vertices[j])),
            });
        }
        Self {
            stars: stars
                .into_iter()
                .map(|star| StarElement::new(star, &hinge_of, pattern))
                .collect(),
            hinges,
            factor: 1.0,
        }
    }

    pub(crate) fn set_factor(&mut self, factor: f64) {
        self.factor = factor;
    }

    /// Recomputes every stiffness for another rest metric or factor.
    pub(crate) fn set_rest(
        &mut self,
        edges: &[Edge],
        rest: &[RestTriangle],
        parameters: &[FaceParameters],
    ) {
        let modulus = |face: usize| parameters[face].bending_modulus();
        let factor = self.factor;
        if self.stars.is_empty() {
            for element in &mut self.hinges {
                let edge = &edges[element.edge];
                let Some(right) = edge.right else { continue };
                let shape = HingeShape::between(edge.left, right, rest);
                let mean = 0.5 * (modulus(edge.left.face) + modulus(right.face));
                element.hinge.stiffness = factor * shape.stiffness(mean, HINGE_EXPONENT);
            }
        }
        for element in &mut self.stars {
            let shape = element.star.shape(rest);
            let stiffness = factor * shape.area() * element.star.mean(rest, modulus);
            let poisson = |face: usize| parameters[face].poisson;
            element.rows = shape.rows(stiffness, element.star.mean(rest, poisson));
        }
    }

    pub(crate) fn set_rest_angles(&mut self, positions: &[Vector3<f64>]) {
        for element in &mut self.hinges {
            element.hinge.rest_angle = element.state(positions).angle();
        }
    }

    pub(crate) fn value(&self, x: &[Vector3<f64>]) -> f64 {
        if self.stars.is_empty() {
            let hinges = self.hinges.iter();
            return hinges
                .map(|element| element.hinge.value(&gather(x, &element.vertices)))
                .sum();
        }
        let bends = self.bends(&self.states(x));
        let curved = |star: &StarElement| 0.5 * star.bend(&bends).norm_squared();
        self.stars.iter().map(curved).sum()
    }

    pub(crate) fn add_gradient(&self, x: &[Vector3<f64>], pattern: &Pattern, gradient: &mut [f64]) {
        if self.stars.is_empty() {
            for element in &self.hinges {
                let forces = element.hinge.gradient(&gather(x, &element.vertices));
                pattern.add_forces(gradient, &element.vertices, &forces);
            }
            return;
        }
        let states = self.states(x);
        let moments = self.moments(&states);
        for ((element, state), moment) in self.hinges.iter().zip(&states).zip(moments) {
            let forces = state.angle_gradient().map(|g| g * moment);
            pattern.add_forces(gradient, &element.vertices, &forces);
        }
    }

    /// Adds the second derivative to `exact`, and its Gauss-Newton part to `relaxed` unless that is
    /// empty.
    pub(crate) fn add_hessian(
        &self,
        x: &[Vector3<f64>],
        pattern: &Pattern,
        exact: &mut [f64],
        relaxed: &mut [f64],
    ) {
        if self.stars.is_empty() {
            for element in &self.hinges {
                let state = element.state(x);
                let mut blocks = element.hinge.gauss_newton(&state);
                if !relaxed.is_empty() {
                    element.add(&blocks, pattern, relaxed);
                }
                element.hinge.add_curvature(&state, &mut blocks);
                element.add(&blocks, pattern, exact);
            }
            return;
        }
        let states = self.states(x);
        let moments = self.moments(&states);
        for ((element, state), moment) in self.hinges.iter().zip(&states).zip(moments) {
            let mut blocks = [Matrix3::zeros(); 10];
            state.add_curvature(moment, &mut blocks);
            element.add(&blocks, pattern, exact);
        }
        let gradients: Vec<_> = states.iter().map(HingeState::angle_gradient).collect();
        let mut slopes = Vec::new();
        for star in &self.stars {
            star.add_gauss_newton(&gradients, &mut slopes, pattern, exact, relaxed);
        }
    }

    fn states(&self, x: &[Vector3<f64>]) -> Vec<HingeState> {
        self.hinges.iter().map(|element| element.state(x)).collect()
    }

    /// How far each angle is from its rest value (rad).
    fn bends(&self, states: &[HingeState]) -> Vec<f64> {
        let elements = self.hinges.iter().zip(states);
        elements
            .map(|(element, state)| state.angle() - element.hinge.rest_angle)
            .collect()
    }

    /// Derivative of the stars' energy by each angle (J).
    fn moments(&self, states: &[HingeState]) -> Vec<f64> {
        let bends = self.bends(states);
        let mut moments = vec![0.0; bends.len()];
        for star in &self.stars {
            let bend = star.bend(&bends);
            for (&hinge, row) in star.hinges.iter().zip(&star.rows) {
                moments[hinge as usize] += row.dot(&bend);
            }
        }
        moments
    }
}

impl HingeElement {
    fn state(&self, x: &[Vector3<f64>]) -> HingeState {
        HingeState::new(&gather(x, &self.vertices))
    }

    #[inline]
    fn add(&self, blocks: &[Matrix3<f64>; 10], pattern: &Pattern, values: &mut [f64]) {
        for (&vertex, block) in self.vertices.iter().zip(HINGE_DIAGONAL) {
            pattern.add_diagonal(values, vertex, &blocks[block]);
        }
        for (&slot, (_, block)) in self.slots.iter().zip(HINGE_PAIRS) {
            Pattern::add_block(values, slot, &blocks[block]);
        }
    }
}

impl StarElement {
    fn new(star: Star, hinge_of: &[u32], pattern: &Pattern) -> Self {
        Self {
            rows: Vec::new(),
            hinges: star.folds.iter().map(|fold| hinge_of[fold.edge]).collect(),
            slots: star.pairs().map(|[i, j]| pattern.slot(i, j)).collect(),
            star,
        }
    }

    /// Half its square is the energy.
    #[inline]
    fn bend(&self, bends: &[f64]) -> Vector3<f64> {
        let folds = self.hinges.iter().map(|&hinge| bends[hinge as usize]);
        weighted(&self.rows, folds)
    }

    /// `J^T J`, with `J` the derivative of the star's bend; `slopes` is room to work in.
    fn add_gauss_newton(
        &self,
        gradients: &[[Vector3<f64>; 4]],
        slopes: &mut Vec<Matrix3<f64>>,
        pattern: &Pattern,
        exact: &mut [f64],
        relaxed: &mut [f64],
    ) {
        slopes.clear();
        slopes.resize(self.star.vertices().count(), Matrix3::zeros());
        for ((&hinge, fold), row) in self.hinges.iter().zip(&self.star.folds).zip(&self.rows) {
            for (&i, g) in fold.corners.iter().zip(&gradients[hinge as usize]) {
                slopes[i as usize] += row * g.transpose();
            }
        }
        let mut slots = self.slots.iter();
        for (i, (slope, vertex)) in slopes.iter().zip(self.star.vertices()).enumerate() {
            for (other, &slot) in slopes[..i].iter().zip(slots.by_ref()) {
                let block = slope.tr_mul(other);
                Pattern::add_block(exact, slot, &block);
                if !relaxed.is_empty() {
                    Pattern::add_block(relaxed, slot, &block);
                }
            }
            let block = slope.tr_mul(slope);
            pattern.add_diagonal(exact, vertex, &block);
            if !relaxed.is_empty() {
                pattern.add_diagonal(relaxed, vertex, &block);
            }
        }
    }
}
