//! The bending energy of a whole layer, by either model.

mod creases;
mod elements;

use nalgebra::{Matrix2, Matrix3, Vector3};
use ruga_mesh::{BlockPattern, EdgeId, FaceId, Id, PerEdge, TriMesh, VertexId};

use crate::hinge::Hinge;
use crate::hinge_stiffness::{HINGE_EXPONENT, HingeShape};
use crate::layer_creases::HingeCrease;
use crate::layer_part::{PartNumbers, rank};
use crate::natural_curvature::NaturalAngles;
use crate::shared_out::{for_each_mut, in_order, values};
use crate::sharp_fold::SharpFold;
use crate::sheet_slots::SheetSlots;
use crate::stars::Star;
use crate::stencil::{FaceCorner, add_blocks};
use crate::{EnergyParts, FaceParameters, RestTriangle};
use elements::{HingeElement, StarElement, hinge_state};

/// Hinges at all inner edges and, if the model has them, the stars that their angles go into.
#[derive(Clone, Debug)]
pub(crate) struct LayerBending {
    hinges: Vec<HingeElement>,
    stars: Vec<StarElement>,
    factor: f64,
    creases: Vec<HingeCrease>,
    /// The stars with a crease on an inner edge: which star, and which edge has which crease.
    creased_stars: Vec<(u32, Vec<(u32, u32)>)>,
}

/// An inner edge of a mesh, without a stiffness.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InnerEdge {
    pub(crate) edge: EdgeId,
    /// Its two faces, each with the corner at which the edge begins; of a mirrored edge the left one twice.
    pub(crate) sides: [(FaceId, usize); 2],
    /// Tail, head, left and right apex.
    pub(crate) vertices: [u32; 4],
    /// Whether the right face is the mirror image of the left one.
    pub(crate) is_mirrored: bool,
}

/// The edges between two faces, or between one and its mirror image where both ends are `on_plane` (empty for no
/// plane), by their lower and then their higher end.
pub(crate) fn inner_edges(mesh: &TriMesh, on_plane: &[bool]) -> Vec<InnerEdge> {
    let is_on_plane = |v: VertexId| on_plane.get(v.index()).copied().unwrap_or(false);
    let inner = mesh.edges().iter().filter_map(|(id, edge)| {
        let [left, right] = mesh.edge_sides(id);
        let is_mirrored = edge.is_border() && edge.vertices.into_iter().all(is_on_plane);
        let (right, second) = match is_mirrored {
            true => (left, edge.apexes[0]),
            false => (right, edge.apexes[1]),
        };
        let [tail, head] = edge.vertices;
        Some(InnerEdge {
            edge: id,
            sides: [left?, right?],
            vertices: [tail, head, edge.apexes[0]?, second?].map(|v| v.0),
            is_mirrored,
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
    ) -> Self {
        // Stars name mesh edges; a hinge's number is its rank among the inner ones.
        let mut hinge_of = PerEdge::filled(mesh.edges().len(), 0);
        for (hinge, inner) in (0..).zip(inner) {
            hinge_of[inner.edge] = hinge;
        }
        let hinge = |&InnerEdge {
                         sides,
                         vertices,
                         edge,
                         is_mirrored,
                     }: &InnerEdge| {
            let surface_angle = hinge_state(rest, &vertices, is_mirrored).angle();
            HingeElement {
                hinge: Hinge {
                    stiffness: 0.0,
                    rest_angle: surface_angle,
                },
                surface_angle,
                natural_angle: 0.0,
                crease: None,
                edge,
                vertices,
                is_mirrored,
                sides: sides.map(FaceCorner::new),
            }
        };
        Self {
            stars: stars
                .into_iter()
                .map(|star| StarElement::new(star, &hinge_of))
                .collect(),
            hinges: values(inner, hinge),
            factor: 1.0,
            creases: Vec::new(),
            creased_stars: Vec::new(),
        }
    }

    /// The vertices of every hinge and star.
    pub(crate) fn stencils(&self) -> impl Iterator<Item = &[u32]> {
        let hinges = self.hinge_stencils().map(<[u32; 4]>::as_slice);
        hinges.chain(self.star_stencils())
    }

    /// The hinges' vertices.
    pub(crate) fn hinge_stencils(&self) -> impl Iterator<Item = &[u32; 4]> {
        self.hinges.iter().map(|hinge| &hinge.vertices)
    }

    /// The stars' vertices.
    pub(crate) fn star_stencils(&self) -> impl Iterator<Item = &[u32]> + Clone {
        self.stars.iter().map(|star| star.star.vertices.as_slice())
    }

    /// The vertices of one hinge.
    pub(crate) fn hinge(&self, number: u32) -> &[u32] {
        &self.hinges[number as usize].vertices
    }

    /// The vertices of one star, and the hinges that it needs.
    pub(crate) fn star(&self, number: u32) -> (&[u32], &[u32]) {
        let element = &self.stars[number as usize];
        (&element.star.vertices, &element.hinges)
    }

    /// Bending in a part of the layer; stiffness and angles are to be taken over.
    pub(crate) fn part(&self, numbers: &PartNumbers) -> Self {
        let hinge = |&number: &u32| {
            let whole = &self.hinges[number as usize];
            HingeElement {
                vertices: whole.vertices.map(|v| rank(&numbers.vertices, v)),
                sides: whole.sides.map(FaceCorner::of_no_face),
                ..whole.clone()
            }
        };
        let star = |&number: &u32| {
            let whole = &self.stars[number as usize];
            let hinges = whole.hinges.iter().map(|&h| rank(&numbers.hinges, h));
            StarElement {
                star: whole.star.part(&numbers.vertices),
                rows: Vec::new(),
                hinges: hinges.collect(),
                branches: Vec::new(),
            }
        };
        Self {
            hinges: numbers.hinges.iter().map(hinge).collect(),
            stars: numbers.stars.iter().map(star).collect(),
            factor: self.factor,
            creases: Vec::new(),
            creased_stars: Vec::new(),
        }
    }

    /// Takes over stiffness and rest angles of the whole that this is a part of.
    pub(crate) fn follow(&mut self, whole: &Self, numbers: &PartNumbers) {
        self.factor = whole.factor;
        for (element, &number) in self.hinges.iter_mut().zip(&numbers.hinges) {
            // Its vertices are the part's own.
            *element = HingeElement {
                edge: element.edge,
                vertices: element.vertices,
                sides: element.sides,
                ..whole.hinges[number as usize].clone()
            };
        }
        for (element, &number) in self.stars.iter_mut().zip(&numbers.stars) {
            let StarElement { rows, branches, .. } = &whole.stars[number as usize];
            element.rows.clone_from(rows);
            element.branches.clone_from(branches);
        }
    }

    pub(crate) fn set_factor(&mut self, factor: f64) {
        self.factor = factor;
    }

    /// Recomputes every stiffness for another rest metric, factor or material, with the share of each
    /// face's area that is left.
    pub(crate) fn set_rest(
        &mut self,
        rest: &[RestTriangle],
        (parameters, area_left): (&[FaceParameters], &[f64]),
    ) {
        // A face that is partly gone bends as it did, with less stiffness: its shape is that of the whole.
        let modulus = |face: usize| area_left[face] * parameters[face].bending_modulus();
        let factor = self.factor;
        // With stars a hinge measures its angle, and its stiffness is that of a sharp fold alone.
        for_each_mut(&mut self.hinges, |element| {
            let sides = element.sides();
            let shape = HingeShape::between(sides, rest);
            let [left, right] = sides.map(|(face, _)| modulus(face.index()));
            let mean = 0.5 * (left + right);
            // Half of a mirrored edge's energy belongs to the other half of the layer.
            let share = if element.is_mirrored { 0.5 } else { 1.0 };
            element.hinge.stiffness = share * factor * shape.stiffness(mean, HINGE_EXPONENT);
        });
        for_each_mut(&mut self.stars, |element| {
            let shape = element.star.shape(rest);
            // Modulus and Poisson ratio are means over the star, because one curvature serves all
            // of its faces.
            let stiffness = factor * shape.area() * element.star.mean(rest, modulus);
            let poisson = |face: usize| parameters[face].poisson;
            element.rows = shape.rows(stiffness, element.star.mean(rest, poisson));
        });
        self.size_creases(rest, parameters);
    }

    pub(crate) fn set_rest_angles(&mut self, positions: &[Vector3<f64>]) {
        for_each_mut(&mut self.hinges, |element| {
            element.set_angles(element.state(positions).angle(), element.natural_angle);
        });
    }

    /// Replaces the angles that a natural curvature (1/m) per face adds, and returns how many faces are
    /// capped.
    pub(crate) fn set_natural_curvatures(
        &mut self,
        rest: &[RestTriangle],
        curvatures: &[Matrix2<f64>],
    ) -> usize {
        let sides = self.hinges.iter().map(HingeElement::sides);
        let natural = NaturalAngles::new(sides, rest, curvatures);
        for (element, angle) in self.hinges.iter_mut().zip(natural.angles) {
            element.set_angles(element.surface_angle, angle);
        }
        natural.capped_faces
    }

    pub(crate) fn value(&self, x: &[Vector3<f64>]) -> f64 {
        // Under the other model a mesh without stars has no inner edge either, so that emptiness
        // tells the two models apart.
        if self.stars.is_empty() {
            let hinges = self.hinges.iter();
            return hinges.map(|element| element.value(x)).sum();
        }
        let bends = self.bends(x);
        let curved = values(&self.stars, |star| star.value(&bends));
        let sharp = self.sharp_folds(&bends).map(|(_, fold)| fold.value);
        curved.into_iter().sum::<f64>() + sharp.sum::<f64>()
    }

    /// Adds the energy (J) to the faces of the stencils: a star's by their area, half of a hinge's and of a
    /// sharp fold's to each side.
    pub(crate) fn add_to_faces(
        &self,
        x: &[Vector3<f64>],
        rest: &[RestTriangle],
        faces: &mut [EnergyParts],
    ) {
        let mut add_halves = |element: &HingeElement, value: f64| {
            for (face, _) in element.sides() {
                faces[face.index()].bending += 0.5 * value;
            }
        };
        if self.stars.is_empty() {
            for element in &self.hinges {
                add_halves(element, element.value(x));
            }
            return;
        }
        let bends = self.bends(x);
        for (i, fold) in self.sharp_folds(&bends) {
            add_halves(&self.hinges[i], fold.value);
        }
        for element in &self.stars {
            let value = element.value(&bends);
            for (face, share) in element.star.shares(rest) {
                faces[face].bending += share * value;
            }
        }
    }

    pub(crate) fn add_gradient(
        &self,
        x: &[Vector3<f64>],
        pattern: &BlockPattern,
        gradient: &mut [f64],
    ) {
        if self.stars.is_empty() {
            for element in &self.hinges {
                let state = element.state(x);
                let moment = element.moment(&state);
                let forces = element.angle_gradient(&state).map(|g| g * moment);
                pattern.add_forces(gradient, &element.vertices, &forces);
            }
            return;
        }
        // An edge belongs to the stars of both its ends. Summed into one moment, they need its
        // derivatives only once. States are found twice: those of all hinges at once would take half as much memory as
        // the layer.
        let moments = self.moments(&self.bends(x));
        let forces = |i: usize, element: &HingeElement| {
            let gradient = element.angle_gradient(&element.state(x));
            gradient.map(|g| g * moments[i])
        };
        in_order(&self.hinges, forces, |element, forces| {
            pattern.add_forces(gradient, &element.vertices, &forces);
        });
    }

    /// Adds the second derivative to `exact`, and its Gauss-Newton part to `relaxed` unless that is
    /// empty.
    pub(crate) fn add_hessian(
        &self,
        x: &[Vector3<f64>],
        slots: &SheetSlots,
        exact: &mut [f64],
        relaxed: &mut [f64],
    ) {
        if self.stars.is_empty() {
            for (element, slots) in self.hinges.iter().zip(&slots.hinges) {
                let state = element.state(x);
                // The square alone serves as the relaxed Hessian: the rest goes with the bending
                // moment and may be indefinite.
                let mut blocks = element.softened(&state).gauss_newton(&state);
                if !relaxed.is_empty() {
                    add_blocks(relaxed, slots, &element.on_own_side(blocks));
                }
                state.add_curvature(element.moment(&state), &mut blocks);
                add_blocks(exact, slots, &element.on_own_side(blocks));
            }
            return;
        }
        let states: Vec<_> = self.hinges.iter().map(|element| element.state(x)).collect();
        // The second derivative has two parts of different reach: curvature of an angle couples the
        // four vertices of its hinge, squares couple all vertices of a star. Only the squares are
        // semidefinite, and the relaxed Hessian takes no other part.
        let elements = self.hinges.iter().zip(&states);
        let bends = elements.map(|(element, state)| element.hinge.bend(state));
        let bends: Vec<f64> = bends.collect();
        let moments = self.moments(&bends);
        let elements = self.hinges.iter().zip(&slots.hinges);
        for (((element, slots), state), moment) in elements.zip(&states).zip(moments) {
            let mut blocks = [Matrix3::zeros(); 10];
            state.add_curvature(moment, &mut blocks);
            add_blocks(exact, slots, &element.on_own_side(blocks));
        }
        let elements = self.hinges.iter().zip(&states);
        let gradients: Vec<_> = elements
            .map(|(element, state)| element.angle_gradient(state))
            .collect();
        let (mut of_stars, mut slopes) = (slots.stars.iter().copied(), Vec::new());
        for star in &self.stars {
            let at = (bends.as_slice(), gradients.as_slice());
            star.add_gauss_newton(at, &mut of_stars, &mut slopes, exact, relaxed);
        }
        for (i, fold) in self.sharp_folds(&bends) {
            let stiffened = Hinge {
                stiffness: fold.curvature,
                ..self.hinges[i].hinge
            };
            let blocks = self.hinges[i].on_own_side(stiffened.gauss_newton(&states[i]));
            add_blocks(exact, &slots.hinges[i], &blocks);
            if !relaxed.is_empty() {
                add_blocks(relaxed, &slots.hinges[i], &blocks);
            }
        }
    }

    /// The hinges that are bent sharply, by their number.
    fn sharp_folds(&self, bends: &[f64]) -> impl Iterator<Item = (usize, SharpFold)> {
        let all = self.hinges.iter().zip(bends).enumerate();
        all.filter_map(|(i, (element, &bend))| {
            Some((i, SharpFold::new(bend, element.hinge.stiffness)?))
        })
    }

    /// How far each angle is from its rest value (rad).
    fn bends(&self, x: &[Vector3<f64>]) -> Vec<f64> {
        values(&self.hinges, |element| {
            element.hinge.bend(&element.state(x))
        })
    }

    /// Derivative by each angle of the energy of stars and sharp folds (J).
    fn moments(&self, bends: &[f64]) -> Vec<f64> {
        let mut moments = vec![0.0; bends.len()];
        let of_star = |_: usize, star: &StarElement| star.moment(bends);
        in_order(&self.stars, of_star, |star, moment| {
            for (&hinge, row) in star.hinges.iter().zip(&star.rows) {
                moments[hinge as usize] += row.dot(&moment);
            }
        });
        for (i, fold) in self.sharp_folds(bends) {
            moments[i] += fold.slope;
        }
        moments
    }
}
