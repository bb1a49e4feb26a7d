//! The bending energy of a whole layer, by either model.

use nalgebra::{Matrix3, Vector3};

use ruga_mesh::{BlockPattern, BlockSlot, EdgeId, FaceId, Id, PerEdge, TriMesh};

use crate::hinge::{Hinge, HingeState};
use crate::hinge_stiffness::{HINGE_EXPONENT, HingeShape};
use crate::stars::Star;
use crate::stencil::{add_blocks, gather, slots};
use crate::vertex_curvature::weighted;
use crate::{FaceParameters, RestTriangle};

/// Hinges at all inner edges and, if the model has them, the stars that their angles go into.
#[derive(Clone, Debug)]
pub(crate) struct LayerBending {
    hinges: Vec<HingeElement>,
    stars: Vec<StarElement>,
    factor: f64,
}

/// An inner edge of a mesh, without a stiffness.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InnerEdge {
    pub(crate) edge: EdgeId,
    /// Its two faces, each with the corner at which the edge begins.
    pub(crate) sides: [(FaceId, usize); 2],
    /// Tail, head, left and right apex.
    pub(crate) vertices: [u32; 4],
}

#[derive(Clone, Copy, Debug)]
struct HingeElement {
    hinge: Hinge,
    vertices: [u32; 4],
    sides: [(FaceId, usize); 2],
    slots: [BlockSlot; 10],
}

#[derive(Clone, Debug)]
struct StarElement {
    star: Star,
    /// A row per inner edge, see [`crate::StarShape`].
    rows: Vec<Vector3<f64>>,
    /// The hinge on each inner edge.
    hinges: Vec<u32>,
    slots: Vec<BlockSlot>,
}

/// The edges between two faces, by their lower and then their higher end.
pub(crate) fn inner_edges(mesh: &TriMesh) -> Vec<InnerEdge> {
    let inner = mesh.edges().iter().filter_map(|(id, edge)| {
        let ([left, right], [Some(first), Some(second)]) = (mesh.edge_sides(id), edge.apexes)
        else {
            return None;
        };
        let [tail, head] = edge.vertices;
        Some(InnerEdge {
            edge: id,
            sides: [left?, right?],
            vertices: [tail, head, first, second].map(|v| v.0),
        })
    });
    let mut inner: Vec<_> = inner.collect();
    // Sums run in this order: it depends on the vertices alone, not on how the mesh lists edges.
    inner.sort_by_key(|inner| {
        let [tail, head, ..] = inner.vertices;
        (tail.min(head), tail.max(head))
    });
    inner
}

impl LayerBending {
    /// Bending at these inner edges and stars of a mesh.
    ///
    /// Rest angles are those of `rest`; stiffness is set later, because the rest metric changes it.
    pub(crate) fn new(
        stars: Vec<Star>,
        (mesh, inner): (&TriMesh, &[InnerEdge]),
        rest: &[Vector3<f64>],
        pattern: &BlockPattern,
    ) -> Self {
        // Stars name mesh edges; a hinge's number is its rank among the inner ones.
        let mut hinge_of = PerEdge::filled(mesh.edges().len(), 0);
        for (hinge, inner) in (0..).zip(inner) {
            hinge_of[inner.edge] = hinge;
        }
        let hinge = |&InnerEdge {
                         sides, vertices, ..
                     }: &InnerEdge| HingeElement {
            hinge: Hinge {
                // With stars a hinge only measures its angle, and this stays zero.
                stiffness: 0.0,
                rest_angle: HingeState::new(&gather(rest, &vertices)).angle(),
            },
            vertices,
            sides,
            slots: slots(pattern, &vertices),
        };
        Self {
            stars: stars
                .into_iter()
                .map(|star| StarElement::new(star, &hinge_of, pattern))
                .collect(),
            hinges: inner.iter().map(hinge).collect(),
            factor: 1.0,
        }
    }

    pub(crate) fn set_factor(&mut self, factor: f64) {
        self.factor = factor;
    }

    /// Recomputes every stiffness for another rest metric or factor.
    pub(crate) fn set_rest(&mut self, rest: &[RestTriangle], parameters: &[FaceParameters]) {
        let modulus = |face: usize| parameters[face].bending_modulus();
        let factor = self.factor;
        // Under the other model a mesh without stars has no inner edge either, so that emptiness
        // tells the two models apart.
        if self.stars.is_empty() {
            for element in &mut self.hinges {
                let shape = HingeShape::between(element.sides, rest);
                let [left, right] = element.sides.map(|(face, _)| modulus(face.index()));
                let mean = 0.5 * (left + right);
                element.hinge.stiffness = factor * shape.stiffness(mean, HINGE_EXPONENT);
            }
        }
        for element in &mut self.stars {
            let shape = element.star.shape(rest);
            // Modulus and Poisson ratio are means over the star, because one curvature serves all
            // of its faces.
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

    pub(crate) fn add_gradient(
        &self,
        x: &[Vector3<f64>],
        pattern: &BlockPattern,
        gradient: &mut [f64],
    ) {
        if self.stars.is_empty() {
            for element in &self.hinges {
                let forces = element.hinge.gradient(&gather(x, &element.vertices));
                pattern.add_forces(gradient, &element.vertices, &forces);
            }
            return;
        }
        let states = self.states(x);
        // An edge belongs to the stars of both its ends. Summed into one moment, they need its
        // derivatives only once.
        let moments = self.moments(&states);
        for ((element, state), moment) in self.hinges.iter().zip(&states).zip(moments) {
            let forces = state.angle_gradient().map(|g| g * moment);
            pattern.add_forces(gradient, &element.vertices, &forces);
        }
    }

    /// Adds the second derivative to `exact`, and its Gauss-Newton part to `relaxed` unless that is
    /// empty.
    pub(crate) fn add_hessian(&self, x: &[Vector3<f64>], exact: &mut [f64], relaxed: &mut [f64]) {
        if self.stars.is_empty() {
            for element in &self.hinges {
                let state = element.state(x);
                // The square alone serves as the relaxed Hessian: the rest goes with the bending
                // moment and may be indefinite.
                let mut blocks = element.hinge.gauss_newton(&state);
                if !relaxed.is_empty() {
                    add_blocks(relaxed, &element.slots, &blocks);
                }
                element.hinge.add_curvature(&state, &mut blocks);
                add_blocks(exact, &element.slots, &blocks);
            }
            return;
        }
        let states = self.states(x);
        // The second derivative has two parts of different reach: curvature of an angle couples the
        // four vertices of its hinge, squares couple all vertices of a star. Only the squares are
        // semidefinite, and the relaxed Hessian takes no other part.
        let moments = self.moments(&states);
        for ((element, state), moment) in self.hinges.iter().zip(&states).zip(moments) {
            let mut blocks = [Matrix3::zeros(); 10];
            state.add_curvature(moment, &mut blocks);
            add_blocks(exact, &element.slots, &blocks);
        }
        let gradients: Vec<_> = states.iter().map(HingeState::angle_gradient).collect();
        let mut slopes = Vec::new();
        for star in &self.stars {
            star.add_gauss_newton(&gradients, &mut slopes, exact, relaxed);
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
}

impl StarElement {
    fn new(star: Star, hinge_of: &PerEdge<u32>, pattern: &BlockPattern) -> Self {
        Self {
            rows: Vec::new(),
            hinges: star.folds.iter().map(|fold| hinge_of[fold.edge]).collect(),
            slots: pattern.stencil_slots(&star.vertices).collect(),
            star,
        }
    }

    /// Weighted bends of the star: half the square of this vector is its energy.
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
        exact: &mut [f64],
        relaxed: &mut [f64],
    ) {
        slopes.clear();
        slopes.resize(self.star.vertices.len(), Matrix3::zeros());
        for ((&hinge, fold), row) in self.hinges.iter().zip(&self.star.folds).zip(&self.rows) {
            for (&i, g) in fold.corners.iter().zip(&gradients[hinge as usize]) {
                slopes[i as usize] += row * g.transpose();
            }
        }
        let mut slots = self.slots.iter();
        for (i, slope) in slopes.iter().enumerate() {
            for (other, slot) in slopes[..=i].iter().zip(slots.by_ref()) {
                let block = slope.tr_mul(other);
                slot.add(exact, &block);
                if !relaxed.is_empty() {
                    slot.add(relaxed, &block);
                }
            }
        }
    }
}
