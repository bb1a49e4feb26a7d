//! The hinges and stars of a layer, each with its creases.

use nalgebra::{Matrix3, Vector3};
use ruga_mesh::{BlockSlot, EdgeId, FaceId, PerEdge};

use crate::crease::{Branch, StarFold};
use crate::hinge::{Hinge, HingeState};
use crate::stars::Star;
use crate::stencil::{FaceCorner, gather};
use crate::vertex_curvature::weighted;

/// Reflection at a plane of constant x.
const REFLECTION: Matrix3<f64> = Matrix3::new(-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);

/// Angle and frame of the hinge on these vertices, of which the last one is reflected at the edge's plane of constant
/// x where the hinge `is_mirrored`.
#[inline]
pub(super) fn hinge_state(
    x: &[Vector3<f64>],
    vertices: &[u32; 4],
    is_mirrored: bool,
) -> HingeState {
    let mut points = gather(x, vertices);
    if is_mirrored {
        // Both ends are on the plane, up to how well the artist has put them there.
        points[3].x = points[0].x + points[1].x - points[3].x;
    }
    HingeState::new(&points)
}

/// The hinge on an inner edge of a layer.
#[derive(Clone, Debug)]
pub(super) struct HingeElement {
    /// Its rest angle is the sum of the next two.
    pub(super) hinge: Hinge,
    /// Angle of the rest surface (rad).
    pub(super) surface_angle: f64,
    /// Angle that the natural curvature adds (rad).
    pub(super) natural_angle: f64,
    /// A crease in series with the hinge, which few have; none where there are stars.
    pub(super) crease: Option<Box<Branch>>,
    pub(super) edge: EdgeId,
    /// Tail, head, left and right apex; of a mirrored edge the left one twice.
    pub(super) vertices: [u32; 4],
    /// Whether the right face is the mirror image of the left one.
    pub(super) is_mirrored: bool,
    pub(super) sides: [FaceCorner; 2],
}

/// The star of a vertex of a layer.
#[derive(Clone, Debug)]
pub(super) struct StarElement {
    pub(super) star: Star,
    /// A row per inner edge, see [`crate::StarShape`].
    pub(super) rows: Vec<Vector3<f64>>,
    /// The hinge on each inner edge.
    pub(super) hinges: Vec<u32>,
    /// Creases in series with the star.
    pub(super) branches: Vec<Branch>,
}

impl HingeElement {
    /// Its two faces, each with the corner at which the edge begins; of a mirrored edge the left one twice.
    pub(super) fn sides(&self) -> [(FaceId, usize); 2] {
        self.sides.map(FaceCorner::pair)
    }

    pub(super) fn set_angles(&mut self, surface: f64, natural: f64) {
        (self.surface_angle, self.natural_angle) = (surface, natural);
        self.hinge.rest_angle = surface + natural;
    }

    pub(super) fn state(&self, x: &[Vector3<f64>]) -> HingeState {
        hinge_state(x, &self.vertices, self.is_mirrored)
    }

    /// Derivative of the angle by the vertices (rad/m).
    #[inline]
    pub(super) fn angle_gradient(&self, state: &HingeState) -> [Vector3<f64>; 4] {
        let gradient = state.angle_gradient();
        match self.is_mirrored {
            false => gradient,
            true => {
                let [tail, head, left, right] = gradient;
                [tail, head, left + REFLECTION * right, Vector3::zeros()]
            }
        }
    }

    /// Blocks in the order of [`Hinge::hessian`], by the vertices: those of a mirror image added to its original's.
    #[inline]
    pub(super) fn on_own_side(&self, mut blocks: [Matrix3<f64>; 10]) -> [Matrix3<f64>; 10] {
        if self.is_mirrored {
            let [.., by_tail, by_head, by_left, by_right] = blocks.map(|block| REFLECTION * block);
            blocks[3] += by_tail;
            blocks[4] += by_head;
            blocks[5] += by_left + by_left.transpose() + by_right * REFLECTION;
            blocks[6..].fill(Matrix3::zeros());
        }
        blocks
    }

    /// Energy (J).
    pub(super) fn value(&self, x: &[Vector3<f64>]) -> f64 {
        let state = self.state(x);
        match &self.crease {
            None => self.hinge.energy(&state),
            Some(branch) => self.fold(branch, &state).energy(),
        }
    }

    /// Derivative of the energy by the angle (J).
    #[inline]
    pub(super) fn moment(&self, state: &HingeState) -> f64 {
        match &self.crease {
            None => self.hinge.stiffness * self.hinge.bend(state),
            Some(branch) => branch.lever.dot(&self.fold(branch, state).moment),
        }
    }

    /// The hinge with the second derivative of the energy by the angle as its stiffness.
    #[inline]
    pub(super) fn softened(&self, state: &HingeState) -> Hinge {
        match &self.crease {
            None => self.hinge,
            Some(branch) => {
                let row =
                    Matrix3::from_columns(&[branch.lever, Vector3::zeros(), Vector3::zeros()]);
                let root = self
                    .fold(branch, state)
                    .softening()
                    .root(row)
                    .column(0)
                    .into_owned();
                Hinge {
                    stiffness: root.norm_squared(),
                    ..self.hinge
                }
            }
        }
    }

    pub(super) fn fold<'b>(&self, branch: &'b Branch, state: &HingeState) -> StarFold<'b> {
        let bend = branch.lever * self.hinge.bend(state);
        StarFold::new(std::slice::from_ref(branch), bend)
    }
}

impl StarElement {
    pub(super) fn new(star: Star, hinge_of: &PerEdge<u32>) -> Self {
        Self {
            rows: Vec::new(),
            hinges: star.folds.iter().map(|fold| hinge_of[fold.edge]).collect(),
            branches: Vec::new(),
            star,
        }
    }

    /// Energy (J).
    pub(super) fn value(&self, bends: &[f64]) -> f64 {
        match self.fold(bends) {
            None => 0.5 * self.bend(bends).norm_squared(),
            Some(fold) => fold.energy(),
        }
    }

    /// Derivative of the energy by the bend.
    pub(super) fn moment(&self, bends: &[f64]) -> Vector3<f64> {
        match self.fold(bends) {
            None => self.bend(bends),
            Some(fold) => fold.moment,
        }
    }

    /// How the creases of the star are folded, if it has any.
    pub(super) fn fold(&self, bends: &[f64]) -> Option<StarFold<'_>> {
        let fold = || StarFold::new(&self.branches, self.bend(bends));
        (!self.branches.is_empty()).then(fold)
    }

    /// Weighted bends of the star: half the square of this vector is its energy without creases.
    #[inline]
    pub(super) fn bend(&self, bends: &[f64]) -> Vector3<f64> {
        let folds = self.hinges.iter().map(|&hinge| bends[hinge as usize]);
        weighted(&self.rows, folds)
    }

    /// `J^T J`, with `J` the derivative of the star's bend, softened by its creases; `slots` begin with the star's,
    /// which are taken, and `slopes` is room to work in.
    pub(super) fn add_gauss_newton(
        &self,
        (bends, gradients): (&[f64], &[[Vector3<f64>; 4]]),
        slots: &mut impl Iterator<Item = BlockSlot>,
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
        if let Some(fold) = self.fold(bends) {
            let softening = fold.softening();
            for slope in slopes.iter_mut() {
                *slope = softening.root(*slope);
            }
        }
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
