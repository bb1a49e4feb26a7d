//! The bending energy of a whole layer, by either model.

use nalgebra::{Matrix3, Vector3};

use crate::edges::Edge;
use crate::hinge::{Hinge, HingeState};
use crate::hinge_stiffness::{HINGE_EXPONENT, HingeShape};
use crate::layer_energy::gather;
use crate::pattern::{Pattern, Slot};
use crate::stars::{Star, inner_vertices, is_border_hinge, star_areas, stars};
use crate::vertex_curvature::{rows, weighted};
use crate::{BendingModel, LayerParameters, RestTriangle};

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
    /// Whether it has a stiffness of its own.
    stiff: bool,
}

#[derive(Clone, Debug)]
struct StarElement {
    star: Star,
    /// Per spoke, see [`rows`].
    rows: Vec<Vector3<f64>>,
    /// Per spoke, the hinge on it.
    hinges: Vec<u32>,
    /// Per spoke, where the hinge's four vertices are in the star.
    corners: Vec<[u8; 4]>,
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

/// The stars of a model and which vertices its stencils couple.
pub(crate) struct BendingStencils {
    stars: Vec<Star>,
}

impl BendingStencils {
    pub(crate) fn new(
        model: BendingModel,
        faces: &[[u32; 3]],
        edges: &[Edge],
        vertices: usize,
    ) -> Self {
        let stars = match model {
            BendingModel::Hinge => Vec::new(),
            BendingModel::VertexCurvature => stars(faces, edges, vertices),
        };
        Self { stars }
    }

    pub(crate) fn pairs(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.stars.iter().flat_map(Star::pairs)
    }
}

impl LayerBending {
    /// Rest angles are those of `rest`; stiffness is set later, because the rest metric changes it.
    pub(crate) fn new(
        stencils: BendingStencils,
        faces: &[[u32; 3]],
        edges: &[Edge],
        rest: &[Vector3<f64>],
        pattern: &Pattern,
    ) -> Self {
        let inner = inner_vertices(&stencils.stars, rest.len());
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
                stiff: is_border_hinge(topology, &inner),
            });
        }
        let stars = stencils.stars.into_iter();
        Self {
            stars: stars
                .map(|star| StarElement::new(star, &hinge_of, pattern))
                .collect(),
            hinges,
            factor: 1.0,
        }
    }

    /// Every two vertices that share a star.
    pub(crate) fn star_pairs(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.stars.iter().flat_map(|element| element.star.pairs())
    }

    pub(crate) fn set_factor(&mut self, factor: f64) {
        self.factor = factor;
    }

    /// Recomputes every stiffness for another rest metric or factor.
    pub(crate) fn set_rest(
        &mut self,
        faces: &[[u32; 3]],
        edges: &[Edge],
        rest: &[RestTriangle],
        parameters: &LayerParameters,
        vertices: usize,
    ) {
        let modulus = |face: usize| parameters.faces[face].bending_modulus();
        for element in self.hinges.iter_mut().filter(|element| element.stiff) {
            let edge = &edges[element.edge];
            let Some(right) = edge.right else { continue };
            let shape = HingeShape::between(edge.left, right, rest);
            let mean = 0.5 * (modulus(edge.left.face) + modulus(right.face));
            element.hinge.stiffness = self.factor * shape.stiffness(mean, HINGE_EXPONENT);
        }
        let areas = star_areas(
            self.stars.iter().map(|element| &element.star),
            faces,
            edges,
            rest,
            vertices,
        );
        for (element, area) in self.stars.iter_mut().zip(areas) {
            let star = &element.star;
            let stiffness = self.factor * area * star.mean(rest, modulus);
            let poisson = star.mean(rest, |face| parameters.faces[face].poisson);
            element.rows = rows(&star.shape(rest), stiffness, poisson);
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
        let bends: Vec<_> = self
            .hinges
            .iter()
            .map(|element| element.state(x).angle() - element.hinge.rest_angle)
            .collect();
        let hinges = self.hinges.iter().zip(&bends);
        let folds: f64 = hinges
            .map(|(element, bend)| 0.5 * element.hinge.stiffness * bend * bend)
            .sum();
        let curved = |star: &StarElement| 0.5 * star.bend(&bends).norm_squared();
        folds + self.stars.iter().map(curved).sum::<f64>()
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
                let blocks = element.add_gauss_newton(&state, pattern, relaxed);
                let moment = element.moment(&state);
                element.add_curvature(&state, moment, blocks, pattern, exact);
            }
            return;
        }
        let states = self.states(x);
        let moments = self.moments(&states);
        for ((element, state), moment) in self.hinges.iter().zip(&states).zip(moments) {
            let blocks = if element.stiff {
                element.add_gauss_newton(state, pattern, relaxed)
            } else {
                [Matrix3::zeros(); 10]
            };
            element.add_curvature(state, moment, blocks, pattern, exact);
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

    /// Derivative of the energy by the angle of each hinge (J).
    fn moments(&self, states: &[HingeState]) -> Vec<f64> {
        let elements = self.hinges.iter().zip(states);
        let bends: Vec<_> = elements
            .map(|(element, state)| state.angle() - element.hinge.rest_angle)
            .collect();
        let own = self.hinges.iter().zip(&bends);
        let mut moments: Vec<_> = own
            .map(|(element, bend)| element.hinge.stiffness * bend)
            .collect();
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

    fn moment(&self, state: &HingeState) -> f64 {
        self.hinge.stiffness * (state.angle() - self.hinge.rest_angle)
    }

    /// Returns the blocks that it adds.
    #[inline]
    fn add_gauss_newton(
        &self,
        state: &HingeState,
        pattern: &Pattern,
        relaxed: &mut [f64],
    ) -> [Matrix3<f64>; 10] {
        let blocks = self.hinge.gauss_newton(state);
        if !relaxed.is_empty() {
            self.add(&blocks, pattern, relaxed);
        }
        blocks
    }

    #[inline]
    fn add_curvature(
        &self,
        state: &HingeState,
        moment: f64,
        mut blocks: [Matrix3<f64>; 10],
        pattern: &Pattern,
        exact: &mut [f64],
    ) {
        state.add_curvature(moment, &mut blocks);
        self.add(&blocks, pattern, exact);
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
        let count = star.spokes.len();
        let corners = star.spokes.iter().enumerate().map(|(k, spoke)| {
            let [next, last] = [(k + 1) % count, (k + count - 1) % count];
            let [spoke_end, left, right] = [k, next, last].map(|k| k as u8 + 1);
            if spoke.outward {
                [0, spoke_end, left, right]
            } else {
                [spoke_end, 0, right, left]
            }
        });
        Self {
            rows: Vec::new(),
            hinges: star.spokes.iter().map(|s| hinge_of[s.edge]).collect(),
            corners: corners.collect(),
            slots: star.pairs().map(|[i, j]| pattern.slot(i, j)).collect(),
            star,
        }
    }

    /// Half its square is the energy.
    #[inline]
    fn bend(&self, bends: &[f64]) -> Vector3<f64> {
        let spokes = self.hinges.iter().map(|&hinge| bends[hinge as usize]);
        weighted(&self.rows, spokes)
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
        slopes.resize(self.rows.len() + 1, Matrix3::zeros());
        for ((&hinge, corners), row) in self.hinges.iter().zip(&self.corners).zip(&self.rows) {
            for (&i, g) in corners.iter().zip(&gradients[hinge as usize]) {
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
