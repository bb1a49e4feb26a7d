//! Creases on the edges of a layer, gathered into branches per star or hinge.

use nalgebra::Vector3;
use ruga_mesh::{EdgeId, FaceId, Id, PerEdge};

use crate::crease::{Branch, Crease};
use crate::stars::Star;
use crate::{FaceParameters, HingeShape, ResponseQuery, RestTriangle, ShellError};

/// Turn of a line at a vertex (rad) up to which it folds by one angle there. A line that turns more is
/// two that meet: their folds are about different axes.
const SMOOTH_TURN: f64 = std::f64::consts::FRAC_PI_4;

/// A crease on a hinge of a layer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HingeCrease {
    pub(crate) hinge: u32,
    pub(crate) crease: Crease,
}

/// Crease with the sizes of the rest triangles around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SizedCrease {
    crease: Crease,
    /// Compliance within its bounds (rad/N).
    compliance: f64,
    /// Length of the edge (m).
    length: f64,
}

impl SizedCrease {
    /// The crease on the edge with these sides, in a layer of this bending modulus (N m) and foundation
    /// `K0` (N/m³).
    pub(crate) fn new(
        crease: Crease,
        sides: [(FaceId, usize); 2],
        rest: &[RestTriangle],
        [modulus, foundation]: [f64; 2],
    ) -> Self {
        let length = HingeShape::between(sides, rest).length();
        Self {
            crease,
            compliance: crease.bounded_compliance(length, modulus, foundation),
            length,
        }
    }

    /// The sized crease on an edge of a layer with these parameters.
    pub(crate) fn in_layer(
        crease: Crease,
        sides: [(FaceId, usize); 2],
        rest: &[RestTriangle],
        parameters: &[FaceParameters],
    ) -> Self {
        let mean = |value: &dyn Fn(&FaceParameters) -> f64| {
            let [left, right] = sides.map(|(face, _)| value(&parameters[face.index()]));
            0.5 * (left + right)
        };
        let modulus = mean(&FaceParameters::bending_modulus);
        let foundation = mean(&|face| face.normal_stiffness);
        Self::new(crease, sides, rest, [modulus, foundation])
    }

    /// The crease in a hinge of this stiffness (J), taken as a star with one row along x.
    pub(crate) fn of_hinge(&self, stiffness: f64) -> Branch {
        let lever = Vector3::x() * stiffness.sqrt();
        Branch::new(0, lever, self.compliance / self.length, &self.crease)
    }

    /// The half of the crease that one of the stars at its ends owns.
    fn of_star(&self, fold: u32, row: Vector3<f64>) -> Branch {
        Branch::new(
            fold,
            row,
            self.compliance / (0.5 * self.length),
            &self.crease,
        )
    }
}

/// The branches of a star with these creases on its inner edges, whose rows are given.
///
/// A line that passes smoothly folds by one angle, so that it keeps its resistance to torsion. Where lines
/// meet or one turns or ends, each edge has an angle of its own.
pub(crate) fn star_branches(
    creases: &[(u32, SizedCrease)],
    (star, rest): (&Star, &[RestTriangle]),
    rows: &[Vector3<f64>],
) -> Vec<Branch> {
    let branch = |(fold, crease): &(u32, SizedCrease)| crease.of_star(*fold, rows[*fold as usize]);
    if let [first, second] = creases
        && star.turn(rest, [first.0, second.0]) < SMOOTH_TURN
        && let Some(joined) = branch(first).joined(&branch(second))
    {
        return vec![joined];
    }
    creases.iter().map(branch).collect()
}

/// The crease on each edge, if it has one that is not plain.
pub(crate) fn sized_creases(
    query: &ResponseQuery,
    rest: &[RestTriangle],
    creases: &[(EdgeId, Crease)],
) -> Result<PerEdge<Option<SizedCrease>>, ShellError> {
    let mut sized = PerEdge::filled(query.mesh.edges().len(), None);
    let stiffness = [query.bending_modulus, query.normal_stiffness];
    for &(edge, crease) in creases {
        let index = edge.index();
        crease.check(index)?;
        let sides = (index < sized.len()).then(|| query.mesh.edge_sides(edge));
        let Some([Some(left), Some(right)]) = sides else {
            return Err(ShellError::CreaseOutside { edge: index });
        };
        if !crease.is_plain() {
            let crease = SizedCrease::new(crease, [left, right], rest, stiffness);
            if sized[edge].replace(crease).is_some() {
                return Err(ShellError::CreaseTwice { edge: index });
            }
        }
    }
    Ok(sized)
}
