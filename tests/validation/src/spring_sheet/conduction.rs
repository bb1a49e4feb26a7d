//! Heat along springs, by the paper's umbrella operator.

use nalgebra::Vector3;

/// Residual over right-hand side at which the implicit step counts as solved: errors of temperature of a millionth of a
/// kelvin, which no front can tell.
const TOLERANCE: f64 = 1e-9;

/// Springs as conductors: the scale-dependent umbrella operator of Desbrun et al. 1999, eq. (3) of the paper.
///
/// ```text
/// L(u_i) = 2/E_i sum_j (u_j - u_i)/d_ij,      E_i = sum_j d_ij,      j over all particles that a spring joins to i
/// ```
///
/// On every star that looks alike in all directions of its plane this is *half* the Laplacian, so that a sheet conducts
/// heat as if its diffusivity were half of what is asked for; on others it is not even zero for linear fields. It is
/// not symmetric: heat is not kept where the stars differ.
#[derive(Clone, Debug)]
pub struct Conduction {
    /// Springs, and `1/d` of each (1/m).
    links: Vec<([usize; 2], f64)>,
    /// `E` of each particle (m); zero where no spring ends.
    spans: Vec<f64>,
}

impl Conduction {
    /// Takes the springs between `ends`, as long as they are between `positions` (m). Springs without length, and those
    /// to particles that are not there, conduct nothing.
    pub fn new(ends: impl Iterator<Item = [u32; 2]>, positions: &[Vector3<f64>]) -> Self {
        let mut spans = vec![0.0; positions.len()];
        let mut links = Vec::new();
        for own in ends {
            let own = own.map(|p| p as usize);
            let [Some(a), Some(b)] = own.map(|p| positions.get(p)) else {
                continue;
            };
            let length = (a - b).norm();
            if length > 0.0 {
                own.iter().for_each(|&p| spans[p] += length);
                links.push((own, 1.0 / length));
            }
        }
        Self { links, spans }
    }

    /// The operator of eq. (3) on one value a particle: 1/m2 times their unit.
    ///
    /// # Panics
    /// When there are fewer values than particles.
    pub fn laplacian(&self, values: &[f64]) -> Vec<f64> {
        let mut sums = self.differences(values);
        for (sum, span) in sums.iter_mut().zip(&self.spans) {
            *sum *= if *span > 0.0 { 2.0 / span } else { 0.0 };
        }
        sums
    }

    /// One step of implicit Euler of eq. (2), `(1 - reach L) T = T_before`; gives the iterations.
    ///
    /// `reach` is diffusivity times time step (m2). The matrix is not symmetric, but its rows times `E` are those of a
    /// matrix that is, and positive: `(E + 2 reach G) T = E T_before` with `G` the graph Laplacian of weights `1/d`.
    /// So conjugate gradients do; they start from the temperatures before the step and are scaled by the diagonal.
    ///
    /// # Panics
    /// When there are fewer temperatures than particles.
    pub fn step(&self, reach: f64, temperatures: &mut [f64]) -> usize {
        let mut diagonal = self.spans.clone();
        for &([a, b], weight) in &self.links {
            diagonal[a] += 2.0 * reach * weight;
            diagonal[b] += 2.0 * reach * weight;
        }
        let scaled = |(r, d): (&f64, &f64)| if *d > 0.0 { r / d } else { 0.0 };
        let flows = self.differences(temperatures);
        let mut rest: Vec<f64> = flows.iter().map(|flow| 2.0 * reach * flow).collect();
        let wanted = self.spans.iter().zip(&*temperatures);
        let enough = TOLERANCE * TOLERANCE * wanted.map(|(e, t)| (e * t).powi(2)).sum::<f64>();
        let mut way: Vec<f64> = rest.iter().zip(&diagonal).map(scaled).collect();
        let mut square = dot(&rest, &way);
        for iteration in 0..rest.len() {
            if dot(&rest, &rest) <= enough {
                return iteration;
            }
            let flows = self.differences(&way);
            let product = self.spans.iter().zip(&way).zip(&flows);
            let product: Vec<f64> = product
                .map(|((span, own), flow)| span * own - 2.0 * reach * flow)
                .collect();
            let length = square / dot(&way, &product);
            for (i, own) in way.iter().enumerate() {
                temperatures[i] += length * own;
                rest[i] -= length * product[i];
            }
            let before = square;
            let next: Vec<f64> = rest.iter().zip(&diagonal).map(scaled).collect();
            square = dot(&rest, &next);
            for (own, next) in way.iter_mut().zip(next) {
                *own = next + square / before * *own;
            }
        }
        rest.len()
    }

    /// `sum_j (u_j - u_i)/d_ij` of all particles.
    fn differences(&self, values: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.spans.len()];
        for &([a, b], weight) in &self.links {
            let flow = weight * (values[b] - values[a]);
            sums[a] += flow;
            sums[b] -= flow;
        }
        sums
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
