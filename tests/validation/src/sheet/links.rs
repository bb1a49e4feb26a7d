//! Springs without length between vertices of a sheet, which its own energy does not know.

use nalgebra::Vector3;
use ruga_solver::LowerPattern;

/// A spring that pulls two vertices together.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    /// The vertices; both move.
    pub vertices: [u32; 2],
    /// Stiffness (N/m).
    pub stiffness: f64,
}

/// Links in the pattern of a sheet's Hessian.
pub(super) struct Links {
    links: Vec<Link>,
    /// Where every entry of the layer's own pattern is in the pattern with links.
    slots: Vec<usize>,
    /// Where the entries of every link and axis are: both on the diagonal, and the one off it.
    entries: Vec<[usize; 3]>,
    /// First unknowns of the ends of every link.
    unknowns: Vec<[usize; 2]>,
    pattern: LowerPattern,
}

impl Links {
    /// Adds links to a layer's pattern: column starts and rows.
    pub(super) fn new(links: &[Link], free: &[u32], (starts, rows): (&[usize], &[u32])) -> Self {
        let column = |column: usize| {
            let rows = rows[starts[column]..starts[column + 1]].iter();
            rows.map(|&row| row as usize)
        };
        let size = starts.len() - 1;
        let unknown = |v: u32| 3 * free.binary_search(&v).expect("links join what moves");
        let unknowns: Vec<_> = links
            .iter()
            .map(|link| link.vertices.map(unknown))
            .collect();
        let own = (0..size).flat_map(|c| column(c).map(move |row| vec![c, row]));
        let added = unknowns
            .iter()
            .flat_map(|&[a, b]| [0, 1, 2].map(|axis| vec![a + axis, b + axis]));
        let pattern = if links.is_empty() {
            LowerPattern::new(starts.to_vec(), rows.to_vec())
        } else {
            let stencils: Vec<_> = own.chain(added).collect();
            LowerPattern::from_stencils(size, stencils.iter().map(Vec::as_slice))
        };
        let pattern = pattern.expect("a valid pattern");
        let position = |a: usize, b: usize| {
            let position = pattern.position(a.max(b), a.min(b));
            position.expect("the pattern was made of these")
        };
        let slots = match links {
            [] => Vec::new(),
            _ => {
                let all = (0..size).flat_map(|c| column(c).map(move |row| [row, c]));
                all.map(|[row, c]| position(row, c)).collect()
            }
        };
        let entries = unknowns.iter().flat_map(|&[a, b]| {
            let of_axis = |axis: usize| {
                let [a, b] = [a + axis, b + axis];
                [position(a, a), position(b, b), position(a, b)]
            };
            [0, 1, 2].map(of_axis)
        });
        Self {
            entries: entries.collect(),
            links: links.to_vec(),
            slots,
            unknowns,
            pattern,
        }
    }

    /// The pattern with links.
    pub(super) fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    /// Energy (J).
    pub(super) fn value(&self, positions: &[Vector3<f64>]) -> f64 {
        let energies = self.links.iter().map(|link| {
            let [a, b] = link.vertices.map(|v| positions[v as usize]);
            0.5 * link.stiffness * (a - b).norm_squared()
        });
        energies.sum()
    }

    /// Adds forces against the links to a gradient (N).
    pub(super) fn add_gradient(&self, x: &[f64], gradient: &mut [f64]) {
        for (link, &[a, b]) in self.links.iter().zip(&self.unknowns) {
            for axis in 0..3 {
                let force = link.stiffness * (x[a + axis] - x[b + axis]);
                gradient[a + axis] += force;
                gradient[b + axis] -= force;
            }
        }
    }

    /// Writes the layer's Hessians, of the layer's own pattern, and the links into arrays of the pattern with
    /// links.
    pub(super) fn hessian(
        &self,
        layer: impl FnOnce(&mut [f64], &mut [f64]),
        exact: &mut [f64],
        relaxed: &mut [f64],
    ) {
        if self.links.is_empty() {
            return layer(exact, relaxed);
        }
        let mut own = [vec![0.0; self.slots.len()], vec![0.0; self.slots.len()]];
        let [of_exact, of_relaxed] = &mut own;
        layer(of_exact, of_relaxed);
        for (own, values) in own.iter().zip([exact, relaxed]) {
            values.fill(0.0);
            for (&slot, value) in self.slots.iter().zip(own) {
                values[slot] = *value;
            }
            for (link, axes) in self.links.iter().zip(self.entries.chunks_exact(3)) {
                for [a, b, off] in axes {
                    values[*a] += link.stiffness;
                    values[*b] += link.stiffness;
                    values[*off] -= link.stiffness;
                }
            }
        }
    }
}
