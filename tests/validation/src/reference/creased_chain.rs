//! A film with a crease across its middle in plane strain, as a chain of links and hinges.
//!
//! ```text
//! E = sum_links  C h/2 e^2  +  sum_hinges  D t^2/(2 h)  +  K0/2 int w^2  +  Kt/2 int u^2
//!   + (T - T0)^2 / (2 (h/D + c))  +  k_a/2 (w_0 + d)^2
//! ```
//! `e` is the strain of a link ([`LinkLaw`]), `t` the angle between two links and `T` that at the crease, positive in
//! a valley, where a hinge like the others is in series with the compliance `c` and the rest angle `T0`; `w` and `u`
//! are the way of a node from where the compressed base has it, across and along. The middle is a plane of symmetry,
//! so that one half is computed; its outer end lies on the base and turns freely.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2, Vector4};
use ruga_material::{CreaseLoad, Wrinkling};

use super::chain_energy::angle;
use super::dense_newton::{Derivatives, newton};

/// Compressions of the base at which films and chains are compared; the film wrinkles at 0.05.
pub const COMPRESSIONS: [f64; 11] = [
    -0.10, -0.05, 0.0, 0.02, 0.03, 0.04, 0.05, 0.06, 0.08, 0.10, 0.15,
];

/// How a link resists a change of its length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkLaw {
    /// By its stretch: `e = g - 1`.
    Hooke,
    /// By Green's strain, as the membrane of a shell: `e = (g^2 - 1)/2`.
    Green,
}

/// A film with a crease in its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CreasedChain {
    /// Stiffnesses of the film and its springs; there is no `K1`.
    pub film: Wrinkling,
    /// How its links resist.
    pub law: LinkLaw,
    /// Critical wavelengths from end to end.
    pub waves: usize,
    /// Links per wavelength; half of all links is a whole number.
    pub points: usize,
    /// Share of `K0` that sits at the nodes; the rest follows the links. 1/2 in a shell.
    pub lumped: f64,
    /// The crease; its load is that of the linear theory, and not used.
    pub crease: CreaseLoad,
}

/// A film in equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CreasedState {
    /// Depth of the crease in bending lengths.
    pub depth: f64,
    /// Internal fold angle of the crease, rad.
    pub angle: f64,
    /// Whether the last Newton step was short.
    pub converged: bool,
}

impl CreasedChain {
    /// Follows the film from compression to compression of its base, from flat on; `bump` (bending lengths) presses
    /// the crease down before the first of them.
    pub fn follow(&self, compressions: &[f64], bump: f64) -> Vec<CreasedState> {
        let unit = 1.0 / self.film.wave_number;
        let mut state = DVector::zeros(2 * self.links() - 1);
        state[0] = -bump * unit;
        let at = |&compression: &f64| {
            let half = Half {
                chain: self,
                compression,
            };
            let (_, converged) = newton(
                self.links() as f64 * self.link(),
                &|state| half.value(state),
                &|state| half.derivatives(state),
                &mut state,
            );
            CreasedState {
                depth: -state[0] / unit,
                angle: half.fold(&state),
                converged,
            }
        };
        compressions.iter().map(at).collect()
    }

    /// Links of one half.
    fn links(&self) -> usize {
        self.waves * self.points / 2
    }

    /// Length of a link at rest, m.
    fn link(&self) -> f64 {
        self.film.wavelength / self.points as f64
    }

    /// Compliance of the crease with the hinge at its node, rad/N.
    fn total_compliance(&self) -> f64 {
        self.link() / self.film.bending_stiffness + self.compliance()
    }

    /// Compliance of the crease alone, rad/N.
    fn compliance(&self) -> f64 {
        1.0 / (self.film.wave_number * self.crease.stiffness * self.film.bending_stiffness)
    }
}

/// Half of a chain on a base of some compression.
///
/// Unknowns: heights `w_0 .. w_(n-1)`, from the crease on, then ways along `u_1 .. u_(n-1)`.
struct Half<'a> {
    chain: &'a CreasedChain,
    compression: f64,
}

impl Half<'_> {
    fn value(&self, state: &DVector<f64>) -> f64 {
        self.derivatives_into(state, None)
    }

    fn derivatives(&self, state: &DVector<f64>) -> Derivatives {
        let size = state.len();
        let (mut gradient, mut hessian) = (DVector::zeros(size), DMatrix::zeros(size, size));
        let value = self.derivatives_into(state, Some((&mut gradient, &mut hessian)));
        (value, gradient, hessian)
    }

    /// Internal fold angle: what is over the rest angle divides by compliance between hinge and crease.
    fn fold(&self, state: &DVector<f64>) -> f64 {
        let rest = self.chain.crease.rest_angle;
        let (tilt, ..) = angle(self.vector(state, 0));
        let share = self.chain.compliance() / self.chain.total_compliance();
        rest + share * (2.0 * tilt - rest)
    }

    fn derivatives_into(&self, state: &DVector<f64>, target: Target<'_>) -> f64 {
        let mut sum = Sum { value: 0.0, target };
        for link in 0..self.chain.links() {
            let here = self.vector(state, link);
            let (value, force, stiffness) = self.stretching(&here);
            sum.value += value;
            self.add(&mut sum, &[link], force.as_slice(), &|i, j| {
                stiffness[(i, j)]
            });
            self.add_springs(&mut sum, state, link);
            match link.checked_sub(1) {
                None => self.add_crease(&mut sum, state),
                Some(before) => self.add_hinge(&mut sum, state, [before, link]),
            }
        }
        sum.value
    }

    fn add_hinge(&self, sum: &mut Sum<'_>, state: &DVector<f64>, links: [usize; 2]) {
        let scale = self.chain.film.bending_stiffness / self.chain.link();
        let [(a, by_a, twice_a), (b, by_b, twice_b)] = links.map(|l| angle(self.vector(state, l)));
        let turn = b - a;
        let by_turn = Vector4::new(-by_a.x, -by_a.y, by_b.x, by_b.y);
        let twice = |i: usize, j: usize| match (i / 2, j / 2) {
            (0, 0) => -twice_a[(i, j)],
            (1, 1) => twice_b[(i - 2, j - 2)],
            _ => 0.0,
        };
        sum.value += 0.5 * scale * turn * turn;
        self.add(
            sum,
            &links,
            (by_turn * (scale * turn)).as_slice(),
            &|i, j| scale * (by_turn[i] * by_turn[j] + turn * twice(i, j)),
        );
    }

    /// Half of the crease's energy and of its anchor's: the other half is beyond the middle.
    fn add_crease(&self, sum: &mut Sum<'_>, state: &DVector<f64>) {
        let CreaseLoad {
            rest_angle,
            anchor,
            anchor_depth,
            ..
        } = self.chain.crease;
        let scale = 1.0 / self.chain.total_compliance();
        let (tilt, by_tilt, twice_tilt) = angle(self.vector(state, 0));
        let excess = 2.0 * tilt - rest_angle;
        sum.value += 0.25 * scale * excess * excess;
        self.add(
            sum,
            &[0],
            (by_tilt * (scale * excess)).as_slice(),
            &|i, j| scale * (2.0 * by_tilt[i] * by_tilt[j] + excess * twice_tilt[(i, j)]),
        );
        let unit = 1.0 / self.chain.film.wave_number;
        let stiffness = 0.5 * anchor * self.chain.film.normal_stiffness * unit;
        let off = state[0] + anchor_depth * unit;
        sum.value += 0.5 * stiffness * off * off;
        sum.add_gradient(0, stiffness * off);
        sum.add_hessian(0, 0, stiffness);
    }

    /// `K0`, and ties at the nodes, of one link.
    fn add_springs(&self, sum: &mut Sum<'_>, state: &DVector<f64>, link: usize) {
        let (film, h) = (&self.chain.film, self.chain.link());
        // At each end 1/2 of what is lumped, and the consistent 1/3 and 1/6.
        let lumped = self.chain.lumped;
        let own = h * film.normal_stiffness * (0.5 * lumped + (1.0 - lumped) / 3.0);
        let other = h * film.normal_stiffness * (1.0 - lumped) / 6.0;
        let tie = 0.5 * h * film.tangential_stiffness;
        let [a, b] = [link, link + 1].map(|node| self.height(node));
        let [p, q] = [link, link + 1].map(|node| self.way(node));
        for (one, another, stiffness) in [
            (a, a, own),
            (b, b, own),
            (a, b, other),
            (b, a, other),
            (p, p, tie),
            (q, q, tie),
        ] {
            if let (Some(one), Some(another)) = (one, another) {
                sum.value += 0.5 * stiffness * state[one] * state[another];
                sum.add_gradient(one, stiffness * state[another]);
                sum.add_hessian(one, another, stiffness);
            }
        }
    }

    fn stretching(&self, vector: &Vector2<f64>) -> (f64, Vector2<f64>, Matrix2<f64>) {
        let h = self.chain.link();
        let (stiffness, stretch) = (self.chain.film.membrane_stiffness, vector.norm() / h);
        // Strain, and its derivatives by the vector.
        let (strain, by, twice) = match self.chain.law {
            LinkLaw::Hooke => {
                let along = vector / vector.norm();
                let across = Matrix2::identity() - along * along.transpose();
                (stretch - 1.0, along / h, across / (stretch * h * h))
            }
            LinkLaw::Green => (
                0.5 * (stretch * stretch - 1.0),
                vector / (h * h),
                Matrix2::identity() / (h * h),
            ),
        };
        let force = stiffness * h * strain;
        (
            0.5 * force * strain,
            by * force,
            by * by.transpose() * (stiffness * h) + twice * force,
        )
    }

    /// Unknown of a node's height.
    fn height(&self, node: usize) -> Option<usize> {
        (node < self.chain.links()).then_some(node)
    }

    /// Unknown of a node's way along.
    fn way(&self, node: usize) -> Option<usize> {
        let links = self.chain.links();
        (node > 0 && node < links).then(|| links + node - 1)
    }

    /// From a node to the next, m.
    fn vector(&self, state: &DVector<f64>, link: usize) -> Vector2<f64> {
        let of = |unknown: Option<usize>| unknown.map_or(0.0, |unknown| state[unknown]);
        Vector2::new(
            self.chain.link() * (1.0 - self.compression) + of(self.way(link + 1))
                - of(self.way(link)),
            of(self.height(link + 1)) - of(self.height(link)),
        )
    }

    /// Adds derivatives by the vectors of some links to those by the unknowns.
    fn add(
        &self,
        sum: &mut Sum<'_>,
        links: &[usize],
        force: &[f64],
        stiffness: &dyn Fn(usize, usize) -> f64,
    ) {
        let unknowns = |coordinate: usize| {
            let link = links[coordinate / 2];
            [(link, -1.0), (link + 1, 1.0)].map(|(node, sign)| match coordinate % 2 {
                0 => (self.way(node), sign),
                _ => (self.height(node), sign),
            })
        };
        for i in 0..force.len() {
            for (row, sign) in unknowns(i) {
                let Some(row) = row else { continue };
                sum.add_gradient(row, sign * force[i]);
                for j in 0..force.len() {
                    for (column, other) in unknowns(j) {
                        let Some(column) = column else { continue };
                        sum.add_hessian(row, column, sign * other * stiffness(i, j));
                    }
                }
            }
        }
    }
}

/// Gradient and Hessian, where they are wanted.
type Target<'a> = Option<(&'a mut DVector<f64>, &'a mut DMatrix<f64>)>;

/// An energy that is added up, with its derivatives.
struct Sum<'a> {
    value: f64,
    target: Target<'a>,
}

impl Sum<'_> {
    fn add_gradient(&mut self, row: usize, force: f64) {
        if let Some((gradient, _)) = &mut self.target {
            gradient[row] += force;
        }
    }

    fn add_hessian(&mut self, row: usize, column: usize, stiffness: f64) {
        if let Some((_, hessian)) = &mut self.target {
            hessian[(row, column)] += stiffness;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit_film;

    fn crease(stiffness: f64, degrees: f64) -> CreaseLoad {
        CreaseLoad {
            load: 0.0,
            stiffness,
            rest_angle: degrees.to_radians(),
            anchor: 0.0,
            anchor_depth: 0.0,
        }
    }

    fn anchored() -> CreaseLoad {
        CreaseLoad {
            anchor: 2.0,
            anchor_depth: 0.5,
            ..crease(0.5, 0.0)
        }
    }

    /// A chain of four wavelengths of linear links on springs at its nodes, as that of the prototype from which the table is.
    fn prototype(crease: CreaseLoad) -> CreasedChain {
        CreasedChain {
            film: unit_film(0.05).0,
            law: LinkLaw::Hooke,
            waves: 4,
            points: 12,
            lumped: 1.0,
            crease,
        }
    }

    #[test]
    fn derivatives_are_those_of_the_value() {
        for law in [LinkLaw::Hooke, LinkLaw::Green] {
            let chain = CreasedChain {
                law,
                waves: 2,
                points: 6,
                lumped: 0.5,
                crease: CreaseLoad {
                    rest_angle: 0.5,
                    ..anchored()
                },
                ..prototype(anchored())
            };
            let half = Half {
                chain: &chain,
                compression: 0.08,
            };
            let size = 2 * chain.links() - 1;
            let state = DVector::from_fn(size, |i, _| 0.03 * (1.7 * i as f64).sin());
            let (_, gradient, hessian) = half.derivatives(&state);
            let step = 1e-6;
            for i in 0..size {
                let [mut up, mut down] = [state.clone(), state.clone()];
                up[i] += step;
                down[i] -= step;
                let slope = (half.value(&up) - half.value(&down)) / (2.0 * step);
                assert!((slope - gradient[i]).abs() < 1e-6 * gradient.amax(), "{i}");
                let forces = [&up, &down].map(|x| half.derivatives(x).1);
                let column = (&forces[0] - &forces[1]) / (2.0 * step);
                let error = (column - hessian.column(i)).amax();
                assert!(error < 1e-7 * hessian.amax(), "{law:?} {i}: {error}");
            }
        }
    }

    /// Depths in bending lengths and angles in degrees, as the prototype's table has them.
    #[test]
    fn linear_links_give_the_prototypes_depths_and_angles() {
        let stiff = [
            0.033, 0.049, 0.101, 0.171, 0.242, 0.340, 0.439, 0.512, 0.587, 0.647, 0.758,
        ];
        let soft = [
            0.038, 0.102, 0.228, 0.371, 0.482, 0.560, 0.635, 0.694, 0.797,
        ];
        let drawn = [
            0.246, 0.292, 0.327, 0.373, 0.425, 0.467, 0.513, 0.550, 0.621,
        ];
        let pressed = [0.321, 0.426, 0.526, 0.599, 0.728];
        let angles = [17.0, 23.0, 28.0, 36.0, 43.0, 48.0, 55.0, 61.0, 71.0];
        for (crease, depths, bump) in [
            (crease(0.5, 30.0), &stiff[..], 0.0),
            (crease(0.1, 30.0), &soft, 0.0),
            (anchored(), &drawn, 0.0),
            (crease(0.5, 0.0), &pressed, 0.1),
        ] {
            let from = COMPRESSIONS.len() - depths.len();
            let found = prototype(crease).follow(&COMPRESSIONS[from..], bump);
            for (own, depth) in found.iter().zip(depths) {
                assert!(own.converged, "{crease:?}");
                let error = own.depth - depth;
                assert!(error.abs() < 0.00055, "{crease:?}: {} {depth}", own.depth);
            }
            if from == 0 {
                for (own, angle) in found[2..].iter().zip(angles) {
                    let error = own.angle.to_degrees() - angle;
                    assert!(error.abs() < 0.5, "{}, {angle}", own.angle.to_degrees());
                }
            }
        }
    }

    #[test]
    fn finer_chains_converge_with_the_second_order() {
        for law in [LinkLaw::Hooke, LinkLaw::Green] {
            let depths = [12, 24, 48].map(|points| {
                let chain = CreasedChain {
                    law,
                    points,
                    lumped: 0.5,
                    ..prototype(crease(0.5, 30.0))
                };
                chain.follow(&[0.0, 0.02], 0.0)[1].depth
            });
            let order = ((depths[1] - depths[0]) / (depths[2] - depths[1])).log2();
            assert!((1.7..2.3).contains(&order), "{law:?} {depths:?}: {order}");
        }
    }
}
