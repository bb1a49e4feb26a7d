//! Why the heat equation here is not that of Jeong, Kim, Kim 2011: their Laplacian is half of it.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod sheets;

use ruga_burn::{BurnLaw, Front};
use sheets::{IGNITION, SURROUNDINGS, unit_front};

/// Vertices of a square grid, endless across: neighbours and their distances.
struct Grid {
    neighbours: Vec<Vec<(usize, f64)>>,
    across: usize,
}

impl Grid {
    fn new(along: usize, across: usize, edge: f64, reach: &[[i32; 2]]) -> Self {
        let neighbours = (0..along * across).map(|v| {
            let (i, j) = ((v / across) as i32, (v % across) as i32);
            let near = reach.iter().map(|[di, dj]| {
                let row = (i + di).clamp(0, along as i32 - 1);
                let column = (j + dj).rem_euclid(across as i32);
                let distance = edge * f64::from(di * di + dj * dj).sqrt();
                (row as usize * across + column as usize, distance)
            });
            near.collect()
        });
        Self {
            neighbours: neighbours.collect(),
            across,
        }
    }

    /// `L(x_i) = 2/E sum (x_j - x_i)/d_ij`, `E = sum d_ij`: eq. (3) of the paper.
    fn umbrella(&self, v: usize, x: &[f64]) -> f64 {
        let near = &self.neighbours[v];
        let whole: f64 = near.iter().map(|(_, distance)| distance).sum();
        let terms = near.iter().map(|&(u, distance)| (x[u] - x[v]) / distance);
        2.0 / whole * terms.sum::<f64>()
    }

    /// Speed of a front, with explicit steps `dt` so short that they do not matter.
    fn speed(&self, law: &BurnLaw, edge: f64, dt: f64) -> f64 {
        let count = self.neighbours.len();
        let is_ash = |v: usize| ((v / self.across) as f64) * edge < 4.0;
        let pick = |ash: f64, fresh: f64| -> Vec<f64> {
            (0..count)
                .map(|v| if is_ash(v) { ash } else { fresh })
                .collect()
        };
        let mut temperature = pick(law.burning(), SURROUNDINGS);
        let mut fuel = pick(0.0, 1.0);
        let whole: f64 = fuel.iter().sum();
        let (mut times, mut time) = (Vec::new(), 0.0);
        while times.len() < 2 {
            let flow: Vec<f64> = (0..count).map(|v| self.umbrella(v, &temperature)).collect();
            for v in 0..count {
                let above = (temperature[v] - IGNITION).max(0.0);
                let burnt = (dt * law.burn_rate * above).min(fuel[v]);
                fuel[v] -= burnt;
                temperature[v] += dt * law.diffusivity * flow[v] + law.adiabatic_rise * burnt;
            }
            time += dt;
            let burnt = (whole - fuel.iter().sum::<f64>()) / self.across as f64 * edge;
            if burnt >= [8.0, 14.0][times.len()] {
                times.push(time);
            }
        }
        6.0 / (times[1] - times[0])
    }
}

#[test]
fn fronts_of_the_paper_are_slow_by_the_root_of_a_half() {
    let (edge, dt) = (0.125, 0.002);
    let law = unit_front(5.71).law().unwrap();
    let exact = Front::of(&law).unwrap().speed;
    let edges = [[1, 0], [0, 1], [-1, 0], [0, -1]];
    let corners = [[1, 1], [-1, 1], [-1, -1], [1, -1]];
    let square = Grid::new(200, 3, edge, &edges).speed(&law, edge, dt) / exact;
    let with_diagonals: Vec<_> = edges.into_iter().chain(corners).collect();
    let diagonals = Grid::new(200, 3, edge, &with_diagonals).speed(&law, edge, dt) / exact;
    println!("paper {square:.4} {diagonals:.4}");
    for factor in [square, diagonals] {
        assert!((factor / 0.5_f64.sqrt() - 1.0).abs() < 0.01, "{factor}");
    }
}
