//! Overlaps of UV triangles, found by a sweep over U.
//!
//! A line along V passes over the triangles from left to right. Those that it cuts stand in their
//! order along it, and before two of them can begin to overlap they are neighbours in that order,
//! so only pairs that become neighbours are tested (Shamos & Hoey 1976, *Geometric intersection
//! problems*, for segments). Of a pair that overlaps the later face is taken out: what stays on the
//! line is free of overlaps, and the number of tests is at most proportional to the number of faces,
//! however large, thin or many on one spot they are. A grid of cells would hold long strips and
//! stacks of large faces once per cell, each beside all others.

use nalgebra::Vector2;

use crate::sweep_line::SweepLine;
use crate::triangle_overlap::overlap;

/// Result of a sweep.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Sweep {
    /// Faces taken out until no two overlap, ascending; each overlaps an earlier face.
    pub(crate) taken_out: Vec<u32>,
    /// Comparisons and tests of pairs that it took.
    pub(crate) operations: usize,
}

/// Sweeps over `faces`, which are ascending and have areas that are not zero.
pub(crate) fn sweep(uvs: &[[Vector2<f64>; 3]], faces: &[u32]) -> Sweep {
    let mut sweeper = Sweeper {
        corners: faces
            .iter()
            .map(|&f| left_to_right(&uvs[f as usize]))
            .collect(),
        line: SweepLine::new(faces.len()),
        is_out: vec![false; faces.len()],
        operations: 0,
    };
    for (_, change, item) in events(&sweeper.corners) {
        match change {
            // A face that was taken out has left the line, but its end is still on the list.
            _ if sweeper.is_out[item as usize] => {}
            Change::Ends => sweeper.end(item),
            Change::Starts => sweeper.start(item),
        }
    }
    let out = faces.iter().zip(&sweeper.is_out);
    Sweep {
        taken_out: out.filter(|(_, out)| **out).map(|(&f, _)| f).collect(),
        operations: sweeper.operations,
    }
}

/// Change on the line as it goes on. Ends come first: triangles that only touch are
/// never on the line together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Change {
    Ends,
    Starts,
}

fn events(corners: &[[Vector2<f64>; 3]]) -> Vec<(f64, Change, u32)> {
    let mut events: Vec<_> = (0..)
        .zip(corners)
        .flat_map(|(item, [left, _, right])| {
            [
                (left.x, Change::Starts, item),
                (right.x, Change::Ends, item),
            ]
        })
        .collect();
    // Ties are decided to the last: an unstable sort promises no order among equals, and the
    // report must not depend on one.
    events.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    events
}

fn left_to_right(uvs: &[Vector2<f64>; 3]) -> [Vector2<f64>; 3] {
    let mut corners = *uvs;
    corners.sort_unstable_by(|a, b| a.x.total_cmp(&b.x));
    corners
}

/// The faces, numbered by their place among those swept over.
struct Sweeper {
    /// Their corners from left to right.
    corners: Vec<[Vector2<f64>; 3]>,
    line: SweepLine,
    is_out: Vec<bool>,
    operations: usize,
}

impl Sweeper {
    fn end(&mut self, item: u32) {
        let neighbours = self.line.remove(item);
        self.part(neighbours);
    }

    fn start(&mut self, item: u32) {
        loop {
            self.insert(item);
            let neighbours = self.line.neighbours(item);
            let Some(other) = neighbours
                .into_iter()
                .flatten()
                // Whatever lies behind a neighbour cannot begin to overlap before that neighbour
                // ends, and is tested when it does.
                .find(|&other| self.overlap(item, other))
            else {
                return;
            };
            let later = item.max(other);
            self.is_out[later as usize] = true;
            self.line.remove(later);
            if later == item {
                return;
            }
            // An order found among faces that overlap means nothing, so the place of the one that
            // stays is looked up again.
            self.end(item);
        }
    }

    /// Takes out what overlaps among faces that have become neighbours.
    fn part(&mut self, mut neighbours: [Option<u32>; 2]) {
        while let [Some(lower), Some(upper)] = neighbours {
            if !self.overlap(lower, upper) {
                return;
            }
            let later = lower.max(upper);
            self.is_out[later as usize] = true;
            neighbours = self.line.remove(later);
        }
    }

    fn overlap(&mut self, a: u32, b: u32) -> bool {
        self.operations += 1;
        overlap(&self.corners[a as usize], &self.corners[b as usize])
    }

    fn insert(&mut self, item: u32) {
        let Self {
            corners,
            line,
            operations,
            ..
        } = self;
        let this = &corners[item as usize];
        line.insert(item, |other| {
            *operations += 1;
            is_before(this, &corners[other as usize])
        });
    }
}

/// Whether `a` comes before `b` along V where the line cuts both.
///
/// Compared in the middle of what they share of U and not at the line, where triangles with a common
/// corner or edge touch.
fn is_before(a: &[Vector2<f64>; 3], b: &[Vector2<f64>; 3]) -> bool {
    let middle = 0.5 * (a[0].x.max(b[0].x) + a[2].x.min(b[2].x));
    center(a, middle) < center(b, middle)
}

/// Middle of what a line along V at `u` has in common with a triangle.
fn center([left, middle, right]: &[Vector2<f64>; 3], u: f64) -> f64 {
    let along = |a: &Vector2<f64>, b: &Vector2<f64>| {
        let width = b.x - a.x;
        // A side along V has no one place at its U; its middle stands for it.
        let t = if width > 0.0 {
            ((u - a.x) / width).clamp(0.0, 1.0)
        } else {
            0.5
        };
        a.y + t * (b.y - a.y)
    };
    let bent = if u < middle.x {
        along(left, middle)
    } else {
        along(middle, right)
    };
    0.5 * (along(left, right) + bent)
}

#[cfg(test)]
mod tests {
    use super::*;

    type Triangle = [Vector2<f64>; 3];

    /// Numbers in 0..1, the same in every run (splitmix64).
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        }

        fn point(&mut self) -> Vector2<f64> {
            Vector2::new(self.next(), self.next())
        }
    }

    fn swept(triangles: &[Triangle]) -> Sweep {
        sweep(triangles, &(0..triangles.len() as u32).collect::<Vec<_>>())
    }

    fn quad(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> [Triangle; 2] {
        [[a, b, c], [a, c, d]].map(|t| t.map(Vector2::from))
    }

    /// Small and large ones, slivers, corners on a lattice with all their common edges, vertical
    /// sides and equal corners.
    fn soup(numbers: &mut Numbers, steps: f64) -> Vec<Triangle> {
        let size = 0.02 + 0.5 * numbers.next().powi(2);
        let triangles = (0..80).map(|_| {
            let place = numbers.point();
            let thin = if numbers.next() < 0.3 { 1e-3 } else { 1.0 };
            [1.0, 1.0, thin].map(|scale| {
                let corner = place + size * scale * numbers.point();
                corner.map(|c| {
                    if steps > 0.0 {
                        (c * steps).round() / steps
                    } else {
                        c
                    }
                })
            })
        });
        triangles
            .filter(|t| crate::triangle_overlap::area(t).abs() > 1e-12)
            .collect()
    }

    #[test]
    fn what_stays_is_free_of_overlaps_and_what_goes_overlaps_an_earlier_face() {
        let mut numbers = Numbers(1);
        for case in 0..400 {
            let triangles = soup(&mut numbers, [0.0, 16.0, 64.0][case % 3]);
            let out = swept(&triangles).taken_out;
            let is_out = |face: usize| out.binary_search(&(face as u32)).is_ok();
            for face in 0..triangles.len() {
                let mut earlier = (0..face).filter(|&o| overlap(&triangles[face], &triangles[o]));
                if is_out(face) {
                    assert!(earlier.next().is_some(), "case {case}: {face} is alone");
                } else {
                    let both = earlier.find(|&o| !is_out(o));
                    assert_eq!(
                        both, None,
                        "case {case}: {face} stays with what it overlaps"
                    );
                }
            }
        }
    }

    fn grid(cells: usize) -> Vec<Triangle> {
        let at = |i: usize| i as f64 / cells as f64;
        (0..cells * cells)
            .flat_map(|cell| {
                let [x, y] = [cell % cells, cell / cells];
                let [a, b, c, d] = [at(x), at(y), at(x + 1), at(y + 1)];
                quad([a, b], [c, b], [c, d], [a, d])
            })
            .collect()
    }

    /// `count` strips side by side, each as long as all are wide, at an angle.
    fn strips(count: usize, angle: f64) -> Vec<Triangle> {
        let turn = nalgebra::Rotation2::new(angle);
        let at = |i: usize| i as f64 / count as f64;
        (0..count)
            .flat_map(|i| {
                quad(
                    [at(i), 0.0],
                    [at(i + 1), 0.0],
                    [at(i + 1), 1.0],
                    [at(i), 1.0],
                )
            })
            .map(|triangle| triangle.map(|p| turn * p))
            .collect()
    }

    /// `count` quads that all cover the tile, as where an image repeats.
    fn tiles(count: usize) -> Vec<Triangle> {
        (0..count)
            .flat_map(|_| quad([0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]))
            .collect()
    }

    #[test]
    fn operations_grow_as_n_log_n() {
        let mut found = Vec::new();
        for scale in [32, 64, 128] {
            let count = scale * scale;
            for (name, triangles, overlapping) in [
                ("grid", grid(scale), 0),
                ("upright strips", strips(count, 0.0), 0),
                (
                    "level strips",
                    strips(count, std::f64::consts::FRAC_PI_2),
                    0,
                ),
                ("slanted strips", strips(count, 0.7), 0),
                ("tiles", tiles(count), 2 * count - 2),
            ] {
                let sweep = swept(&triangles);
                assert_eq!(sweep.taken_out.len(), overlapping, "{name}");
                let n = triangles.len() as f64;
                let ratio = sweep.operations as f64 / (n * n.log2());
                found.push(format!(
                    "{name}, {n} faces: {} operations",
                    sweep.operations
                ));
                assert!(ratio < 3.0, "{name}: {ratio} n log n for {n} faces");
            }
        }
        // Shown with `--nocapture`.
        #[allow(clippy::print_stdout, reason = "the counts are what the test is about")]
        for line in found {
            println!("{line}");
        }
    }
}
