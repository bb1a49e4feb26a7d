//! Energy of half a wave of a chain, with its derivatives.
//!
//! Unknowns: the heights `w_0 .. w_n`, then the slides `u_1 .. u_(n-1)` along the film; crest and
//! trough do not slide.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector, Matrix2, Matrix4, Vector2, Vector4};
use ruga_material::Wrinkling;

use super::analytic::BendingLaw;
use super::dense_newton::Derivatives;

/// Half a wave under a strain.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChainEnergy {
    pub(super) film: Wrinkling,
    pub(super) bending: BendingLaw,
    /// Segments of the half wave.
    pub(super) segments: usize,
    /// Rest length of a segment, m.
    pub(super) segment: f64,
    pub(super) strain: f64,
}

impl ChainEnergy {
    /// Rest length, m.
    pub(super) fn length(&self) -> f64 {
        self.segments as f64 * self.segment
    }

    pub(super) fn flat(&self) -> DVector<f64> {
        DVector::zeros(2 * self.segments)
    }

    /// A sine that strains the film evenly to the second order.
    pub(super) fn sine(&self, amplitude: f64) -> DVector<f64> {
        let mut state = self.flat();
        let wave_number = PI / self.length();
        for node in 0..=self.segments {
            let phase = wave_number * node as f64 * self.segment;
            state[node] = amplitude * phase.cos();
            if let Some(slide) = self.slide(node) {
                state[slide] = amplitude * amplitude * wave_number / 8.0 * (2.0 * phase).sin();
            }
        }
        state
    }

    /// `sqrt(2)` RMS height about its mean, m.
    pub(super) fn amplitude(&self, state: &DVector<f64>) -> f64 {
        let weight = |node: usize| self.share(node) / self.segments as f64;
        let mean: f64 = (0..=self.segments).map(|i| weight(i) * state[i]).sum();
        let square: f64 = (0..=self.segments)
            .map(|i| weight(i) * (state[i] - mean).powi(2))
            .sum();
        (2.0 * square).sqrt()
    }

    /// Energy per width, J/m.
    pub(super) fn value(&self, state: &DVector<f64>) -> f64 {
        let mut total = self.springs(state, None);
        for index in 0..self.segments {
            total += self.stretching(&self.edge(state, index)).0;
        }
        for node in 0..=self.segments {
            total += match self.edges_at(node) {
                [Some(before), Some(after)] => {
                    let edges = [self.edge(state, before), self.edge(state, after)];
                    self.turning(&edges).0
                }
                [Some(edge), None] | [None, Some(edge)] => self.end(&self.edge(state, edge)).0,
                [None, None] => 0.0,
            };
        }
        total
    }

    pub(super) fn derivatives(&self, state: &DVector<f64>) -> Derivatives {
        let size = 2 * self.segments;
        let (mut gradient, mut hessian) = (DVector::zeros(size), DMatrix::zeros(size, size));
        let mut value = self.springs(state, Some((&mut gradient, &mut hessian)));
        for index in 0..self.segments {
            let (energy, force, stiffness) = self.stretching(&self.edge(state, index));
            value += energy;
            self.add(
                &mut gradient,
                &mut hessian,
                &[index],
                force.as_slice(),
                &|i, j| stiffness[(i, j)],
            );
        }
        for node in 0..=self.segments {
            match self.edges_at(node) {
                [Some(before), Some(after)] => {
                    let edges = [self.edge(state, before), self.edge(state, after)];
                    let (energy, force, stiffness) = self.turning(&edges);
                    value += energy;
                    let edges = [before, after];
                    self.add(
                        &mut gradient,
                        &mut hessian,
                        &edges,
                        force.as_slice(),
                        &|i, j| stiffness[(i, j)],
                    );
                }
                [Some(edge), None] | [None, Some(edge)] => {
                    let (energy, force, stiffness) = self.end(&self.edge(state, edge));
                    value += energy;
                    self.add(
                        &mut gradient,
                        &mut hessian,
                        &[edge],
                        force.as_slice(),
                        &|i, j| stiffness[(i, j)],
                    );
                }
                [None, None] => {}
            }
        }
        (value, gradient, hessian)
    }

    /// Segments before and after a point.
    fn edges_at(&self, node: usize) -> [Option<usize>; 2] {
        [node.checked_sub(1), (node < self.segments).then_some(node)]
    }

    /// Share of a point that belongs to the half wave.
    fn share(&self, node: usize) -> f64 {
        if node == 0 || node == self.segments {
            0.5
        } else {
            1.0
        }
    }

    /// Unknown of a point's slide.
    fn slide(&self, node: usize) -> Option<usize> {
        (node > 0 && node < self.segments).then(|| self.segments + node)
    }

    /// Vector of a segment, along the film and up, m.
    fn edge(&self, state: &DVector<f64>, index: usize) -> Vector2<f64> {
        let slide = |node: usize| self.slide(node).map_or(0.0, |slide| state[slide]);
        Vector2::new(
            self.segment * (1.0 - self.strain) + slide(index + 1) - slide(index),
            state[index + 1] - state[index],
        )
    }

    /// St. Venant-Kirchhoff membrane: `C a/8 (|e|^2/a^2 - 1)^2`.
    fn stretching(&self, edge: &Vector2<f64>) -> (f64, Vector2<f64>, Matrix2<f64>) {
        let a = self.segment;
        let excess = edge.norm_squared() / (a * a) - 1.0;
        let stiffness = self.film.membrane_stiffness / (2.0 * a);
        (
            0.25 * stiffness * a * a * excess * excess,
            edge * (stiffness * excess),
            (Matrix2::from_diagonal_element(excess) + edge * edge.transpose() * (2.0 / (a * a)))
                * stiffness,
        )
    }

    /// Bending at an inner point: `D/(2a) b(g) psi^2` with the angle `psi` between two segments and
    /// the mean of their squared stretches.
    fn turning(&self, edges: &[Vector2<f64>; 2]) -> (f64, Vector4<f64>, Matrix4<f64>) {
        let a = self.segment;
        let scale = self.film.bending_stiffness / (2.0 * a);
        let [
            (first, by_first, twice_first),
            (second, by_second, twice_second),
        ] = edges.map(angle);
        let turn = second - first;
        let by_turn = Vector4::new(-by_first.x, -by_first.y, by_second.x, by_second.y);
        let mut twice_turn = Matrix4::zeros();
        twice_turn
            .fixed_view_mut::<2, 2>(0, 0)
            .copy_from(&-twice_first);
        twice_turn
            .fixed_view_mut::<2, 2>(2, 2)
            .copy_from(&twice_second);
        let share = self.bending.stretch_share() / (a * a);
        let squared = 0.5 * (edges[0].norm_squared() + edges[1].norm_squared()) / (a * a);
        let factor = self.bending.factor(squared);
        let by_factor = Vector4::new(edges[0].x, edges[0].y, edges[1].x, edges[1].y) * share;
        let mixed = by_factor * by_turn.transpose();
        (
            scale * factor * turn * turn,
            (by_factor * (turn * turn) + by_turn * (2.0 * factor * turn)) * scale,
            (Matrix4::from_diagonal_element(share * turn * turn)
                + (mixed + mixed.transpose()) * (2.0 * turn)
                + by_turn * by_turn.transpose() * (2.0 * factor)
                + twice_turn * (2.0 * factor * turn))
                * scale,
        )
    }

    /// Bending at crest or trough: half of the angle between a segment and its mirror image.
    fn end(&self, edge: &Vector2<f64>) -> (f64, Vector2<f64>, Matrix2<f64>) {
        let a = self.segment;
        let scale = self.film.bending_stiffness / a;
        let (tilt, by_tilt, twice_tilt) = angle(*edge);
        let share = self.bending.stretch_share() / (a * a);
        let factor = self.bending.factor(edge.norm_squared() / (a * a));
        let by_factor = edge * (2.0 * share);
        let mixed = by_factor * by_tilt.transpose();
        (
            scale * factor * tilt * tilt,
            (by_factor * (tilt * tilt) + by_tilt * (2.0 * factor * tilt)) * scale,
            (Matrix2::from_diagonal_element(2.0 * share * tilt * tilt)
                + (mixed + mixed.transpose()) * (2.0 * tilt)
                + by_tilt * by_tilt.transpose() * (2.0 * factor)
                + twice_tilt * (2.0 * factor * tilt))
                * scale,
        )
    }

    /// Pasternak springs, half lumped and half consistent as in a shell, and tangential springs.
    fn springs(
        &self,
        state: &DVector<f64>,
        target: Option<(&mut DVector<f64>, &mut DMatrix<f64>)>,
    ) -> f64 {
        let (a, film) = (self.segment, &self.film);
        // On one segment: lumped 1/2, consistent (1/3, 1/6), and the gradient's 1, -1.
        let own = film.normal_stiffness * a * (0.25 + 1.0 / 6.0) + film.gradient_stiffness / a;
        let other = film.normal_stiffness * a / 12.0 - film.gradient_stiffness / a;
        let tangential = film.tangential_stiffness * a;
        let mut entries = Vec::new();
        for index in 0..self.segments {
            entries.extend([
                (index, index, own),
                (index + 1, index + 1, own),
                (index, index + 1, other),
                (index + 1, index, other),
            ]);
        }
        entries.extend((0..=self.segments).filter_map(|node| {
            let slide = self.slide(node)?;
            Some((slide, slide, tangential))
        }));
        if let Some((gradient, hessian)) = target {
            for &(i, j, stiffness) in &entries {
                gradient[i] += stiffness * state[j];
                hessian[(i, j)] += stiffness;
            }
        }
        let energy =
            |&(i, j, stiffness): &(usize, usize, f64)| 0.5 * stiffness * state[i] * state[j];
        entries.iter().map(energy).sum()
    }

    /// Adds derivatives by the coordinates of some segments to those by the unknowns.
    fn add(
        &self,
        gradient: &mut DVector<f64>,
        hessian: &mut DMatrix<f64>,
        edges: &[usize],
        force: &[f64],
        stiffness: &dyn Fn(usize, usize) -> f64,
    ) {
        let unknowns = |coordinate: usize| {
            let (edge, is_height) = (edges[coordinate / 2], coordinate % 2 == 1);
            [(edge, -1.0), (edge + 1, 1.0)].map(|(node, sign)| {
                let unknown = if is_height {
                    Some(node)
                } else {
                    self.slide(node)
                };
                (unknown, sign)
            })
        };
        for (i, force) in force.iter().enumerate() {
            for (row, sign) in unknowns(i) {
                let Some(row) = row else { continue };
                gradient[row] += sign * force;
                for j in 0..2 * edges.len() {
                    for (column, other) in unknowns(j) {
                        let Some(column) = column else { continue };
                        hessian[(row, column)] += sign * other * stiffness(i, j);
                    }
                }
            }
        }
    }
}

/// Angle of a segment above the film's direction, with its derivatives.
pub(super) fn angle(edge: Vector2<f64>) -> (f64, Vector2<f64>, Matrix2<f64>) {
    let square = edge.norm_squared();
    let (x, z) = (edge.x, edge.y);
    let twice = Matrix2::new(2.0 * x * z, z * z - x * x, z * z - x * x, -2.0 * x * z);
    (
        z.atan2(x),
        Vector2::new(-z, x) / square,
        twice / (square * square),
    )
}

#[cfg(test)]
mod tests {
    use ruga_material::{LayerMaterial, Substrate, WavelengthModel, wrinkling};

    use super::*;

    #[test]
    fn derivatives_are_those_of_the_value() {
        let film = LayerMaterial {
            young: 2e6,
            poisson: 0.3,
            thickness: 1e-3,
            density: 1100.0,
        };
        let base = Substrate {
            young: 1e5,
            poisson: 0.3,
            thickness: 1.0,
        };
        let film = wrinkling(&film, &base, WavelengthModel::HalfSpace).expect("valid materials");
        for bending in [BendingLaw::Angle, BendingLaw::AlongEdges] {
            let energy = ChainEnergy {
                film,
                bending,
                segments: 6,
                segment: film.wavelength / 12.0,
                strain: 0.15,
            };
            let state = energy
                .sine(0.7 * film.amplitude(0.15))
                .map(|x| 1.1 * x + 1e-6);
            let (_, gradient, hessian) = energy.derivatives(&state);
            let step = 1e-5 * energy.segment;
            for i in 0..state.len() {
                let mut beside = [state.clone(), state.clone()];
                beside[0][i] += step;
                beside[1][i] -= step;
                let [up, down] = &beside;
                let slope = (energy.value(up) - energy.value(down)) / (2.0 * step);
                assert!((slope - gradient[i]).abs() < 1e-6 * gradient.amax(), "{i}");
                let forces = beside.each_ref().map(|x| energy.derivatives(x).1);
                let column = (&forces[0] - &forces[1]) / (2.0 * step);
                let error = (column - hessian.column(i)).amax();
                assert!(error < 1e-7 * hessian.amax(), "{i}: {error}");
            }
        }
    }
}
