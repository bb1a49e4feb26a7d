//! Thinning of a black and white image to its skeleton.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};
use std::f64::consts::SQRT_2;

/// A line goes into a corner of a shape only if the shape widens less than this on each side per length along it:
/// if the corner is sharper than 60 degrees. So the square end of a stroke does not become a fork.
pub(crate) const BLUNT: f64 = 0.5;

/// Most texels of a hole that is no part of a drawing, and times by which its shape has more at least: a dot with a
/// hole is a ring.
const LARGEST_PINHOLE: usize = 8;
const PINHOLE_SHARE: usize = 50;

/// Texels of an image that are set, row by row.
#[derive(Clone, Debug)]
pub(crate) struct Bitmap {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) is_set: Vec<bool>,
}

/// Steps around a texel, clockwise from above.
const AROUND: [[i64; 2]; 8] = [
    [0, -1],
    [1, -1],
    [1, 0],
    [1, 1],
    [0, 1],
    [-1, 1],
    [-1, 0],
    [-1, -1],
];

impl Bitmap {
    /// The eight neighbours of a texel, clockwise from above; none is set beyond the rim.
    fn neighbours(&self, at: usize) -> [bool; 8] {
        AROUND.map(|step| {
            self.beside(at, step)
                .is_some_and(|other| self.is_set[other])
        })
    }

    fn beside(&self, at: usize, [across, down]: [i64; 2]) -> Option<usize> {
        let (x, y) = (
            (at % self.width) as i64 + across,
            (at / self.width) as i64 + down,
        );
        let is_inside = (0..self.width as i64).contains(&x) && (0..self.height as i64).contains(&y);
        is_inside.then_some(y as usize * self.width + x as usize)
    }

    /// The texels set around one, those that share a side first.
    pub(crate) fn set_beside(&self, at: usize) -> Vec<usize> {
        let order = [0, 2, 4, 6, 1, 3, 5, 7].map(|k| AROUND[k]);
        let beside = order.into_iter().filter_map(|step| self.beside(at, step));
        beside.filter(|&other| self.is_set[other]).collect()
    }

    /// Sets the texels of small holes in large shapes: where strokes cross at a small angle, the tip of the notch
    /// between them falls apart into holes, and each would become a loop.
    pub(crate) fn fill_pinholes(&mut self) {
        let is_set = |at: Option<usize>| at.is_some_and(|at| self.is_set[at]);
        // The first texel of a hole has nothing of it above or to the left.
        let is_first = |at: &usize| {
            let before = [[0, -1], [-1, 0]].map(|step| self.beside(*at, step));
            !self.is_set[*at] && before.into_iter().all(is_set)
        };
        let firsts = (0..self.is_set.len()).filter(is_first);
        let holes = firsts.filter_map(|first| {
            let hole = self.region(first, LARGEST_PINHOLE)?;
            let is_at_rim =
                |at: &usize| AROUND.iter().any(|step| self.beside(*at, *step).is_none());
            let shape = self.region(first - self.width, PINHOLE_SHARE * hole.len());
            (shape.is_none() && !hole.iter().any(is_at_rim)).then_some(hole)
        });
        for at in holes.flatten().collect::<Vec<_>>() {
            self.is_set[at] = true;
        }
    }

    /// The texels that hang together with one, unless they are more than `most`: those set by sides and corners, those
    /// not set by sides.
    fn region(&self, start: usize, most: usize) -> Option<BTreeSet<usize>> {
        let is_set = self.is_set[start];
        let stride = if is_set { 1 } else { 2 };
        let (mut region, mut left) = (BTreeSet::from([start]), vec![start]);
        while let Some(at) = left.pop() {
            let steps = AROUND.iter().step_by(stride);
            let beside = steps.filter_map(|step| self.beside(at, *step));
            left.extend(beside.filter(|&at| self.is_set[at] == is_set && region.insert(at)));
            if region.len() > most {
                return None;
            }
        }
        Some(region)
    }

    /// Squared distance of every texel to the nearest one that is not set, or beyond the rim (texels, between
    /// centres).
    pub(crate) fn depths(&self) -> Vec<u32> {
        let width = self.width;
        // First within columns, down and up; beyond the rim nothing is set.
        let mut upright = vec![0_u32; self.is_set.len()];
        for at in (0..self.is_set.len()).filter(|&at| self.is_set[at]) {
            upright[at] = at.checked_sub(width).map_or(0, |above| upright[above]) + 1;
        }
        for at in (0..self.is_set.len()).rev().filter(|&at| self.is_set[at]) {
            let below = upright.get(at + width).map_or(0, |below| *below);
            upright[at] = upright[at].min(below + 1);
        }
        let mut depths = vec![0_u32; self.is_set.len()];
        for (row, depths) in upright.chunks(width).zip(depths.chunks_mut(width)) {
            depths_in_row(row, depths);
        }
        depths
    }

    /// Removes texels from the rim of every shape, those nearest to the rim first, until lines of one texel are left
    /// that hang together as the shapes did (distance-ordered homotopic thinning, Pudney 1998); `depths` are those
    /// of [`Self::depths`].
    ///
    /// Peeling off layers (Zhang and Suen 1984) needs no distances, but eats strokes near 45 degrees from their ends
    /// and leaves long bars where strokes cross at small angles.
    pub(crate) fn thin(&mut self, depths: &[u32]) {
        let is_rim = |at: &usize| depths[*at] == 1;
        let rim = (0..self.is_set.len()).filter(is_rim);
        let mut queue: BinaryHeap<_> = rim.map(|at| Reverse((depths[at], at))).collect();
        while let Some(Reverse((_, at))) = queue.pop() {
            if self.is_set[at] && self.may_go(at, depths) {
                self.is_set[at] = false;
                queue.extend(
                    self.set_beside(at)
                        .into_iter()
                        .map(|at| Reverse((depths[at], at))),
                );
            }
        }
        // What counted as the end of a wider line may be the corner of a staircase by now. Corners go first, or a
        // staircase would go from its end.
        self.remove_while(Self::is_spare_corner);
        self.remove_while(Self::is_spare);
    }

    /// Removes texels one by one until none is left of which `is_spare` holds.
    fn remove_while(&mut self, is_spare: impl Fn(&Self, usize) -> bool) {
        let is_set = |at: &usize| self.is_set[*at];
        let mut left: Vec<_> = (0..self.is_set.len()).filter(is_set).collect();
        while let Some(at) = left.pop() {
            if self.is_set[at] && is_spare(self, at) {
                self.is_set[at] = false;
                left.extend(self.set_beside(at));
            }
        }
    }

    fn may_go(&self, at: usize, depths: &[u32]) -> bool {
        let around = self.neighbours(at);
        is_simple(around) && (!is_end(around) || self.is_blunt(at, depths))
    }

    /// Whether a line that ends at a texel is only the way into a blunt corner of its shape.
    fn is_blunt(&self, at: usize, depths: &[u32]) -> bool {
        let depth = |at: usize| f64::from(depths[at]).sqrt();
        self.set_beside(at).into_iter().any(|other| {
            let is_level = other.abs_diff(at) == 1 || other.abs_diff(at) == self.width;
            let step = if is_level { 1.0 } else { SQRT_2 };
            depth(other) - depth(at) > BLUNT * step
        })
    }

    /// Whether a texel is the corner of a staircase, whose neighbours hang together without it.
    fn is_spare_corner(&self, at: usize) -> bool {
        let [n, _, e, _, s, _, w, _] = self.neighbours(at);
        n != s && e != w && self.is_spare(at)
    }

    /// Whether a texel is not the end of a line, and its neighbours hang together without it.
    fn is_spare(&self, at: usize) -> bool {
        let around = self.neighbours(at);
        is_simple(around) && around.iter().filter(|set| **set).count() > 1
    }
}

/// Squared distances in a row of texels, from distances within columns: the lower envelope of a parabola for each
/// column (Meijster, Roerdink and Hesselink 2000).
fn depths_in_row(upright: &[u32], depths: &mut [u32]) {
    // Columns are numbered from 1: those before the first and after the last are beyond the rim.
    let squared = |column: i64| {
        let row = usize::try_from(column - 1).ok();
        row.and_then(|x| upright.get(x))
            .map_or(0, |upright| i64::from(*upright).pow(2))
    };
    let parabola = |at: i64, column: i64| (at - column).pow(2) + squared(column);
    // Columns whose parabolas are lowest somewhere, and where they begin to be.
    let mut lowest = vec![(0, 0)];
    for column in 1..=upright.len() as i64 + 1 {
        while let Some(&(last, from)) = lowest.last()
            && parabola(from, last) > parabola(from, column)
        {
            lowest.pop();
        }
        let from = lowest.last().map_or(0, |&(last, _)| {
            let rise = column.pow(2) - last.pow(2) + squared(column) - squared(last);
            1 + rise / (2 * (column - last))
        });
        lowest.push((column, from));
    }
    for (x, depth) in depths.iter_mut().enumerate().rev() {
        let at = x as i64 + 1;
        while lowest.len() > 1 && lowest[lowest.len() - 1].1 > at {
            lowest.pop();
        }
        let nearest = parabola(at, lowest[lowest.len() - 1].0);
        *depth = u32::try_from(nearest).unwrap_or(u32::MAX);
    }
}

/// Whether shapes and holes stay as many without a texel that has these neighbours (Hilditch 1969): a shape holds
/// together by sides and corners, what is around it by sides alone.
fn is_simple(around: [bool; 8]) -> bool {
    let enters = |k: &usize| !around[*k] && (around[k + 1] || around[(k + 2) % 8]);
    [0, 2, 4, 6].iter().filter(|k| enters(k)).count() == 1
}

/// Whether a line of one or two texels' width ends at a texel with these neighbours (Guo and Hall 1989).
fn is_end(around: [bool; 8]) -> bool {
    let pairs = |shift: usize| {
        let is_pair = |k: &usize| around[(k + shift) % 8] || around[(k + shift + 1) % 8];
        [0, 2, 4, 6].iter().filter(|k| is_pair(k)).count()
    };
    pairs(0).min(pairs(1)) < 2
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    const SIDE: usize = 64;

    /// Discs and lone texels, and the same number of discs cut out again.
    fn blobs(rng: &mut Pcg64Mcg) -> Bitmap {
        let mut blobs = Bitmap {
            width: SIDE,
            height: SIDE,
            is_set: (0..SIDE * SIDE).map(|_| rng.random_bool(0.02)).collect(),
        };
        for value in [true, false] {
            for _ in 0..12 {
                let [x, y, radius] = [64.0, 64.0, 9.0].map(|most| rng.random_range(0.0..most));
                for at in 0..SIDE * SIDE {
                    let [across, down] = [(at % SIDE) as f64 - x, (at / SIDE) as f64 - y];
                    if across.hypot(down) < radius {
                        blobs.is_set[at] = value;
                    }
                }
            }
        }
        blobs
    }

    /// Numbers of shapes, and of what they part: holes and the ground around all, which has a rim here.
    fn counts(bitmap: &Bitmap) -> [usize; 2] {
        let mut padded = Bitmap {
            width: SIDE + 2,
            height: SIDE + 2,
            is_set: vec![false; (SIDE + 2) * (SIDE + 2)],
        };
        for at in 0..SIDE * SIDE {
            padded.is_set[(at / SIDE + 1) * padded.width + at % SIDE + 1] = bitmap.is_set[at];
        }
        [true, false].map(|value| {
            let all = 0..padded.is_set.len();
            let mut left: BTreeSet<_> = all.filter(|&at| padded.is_set[at] == value).collect();
            let mut count = 0;
            while let Some(&at) = left.first() {
                for at in padded.region(at, usize::MAX).unwrap() {
                    left.remove(&at);
                }
                count += 1;
            }
            count
        })
    }

    #[test]
    fn thinned_blobs_are_lines_of_one_texel_that_hang_together_as_before() {
        let mut rng = Pcg64Mcg::seed_from_u64(7);
        for _ in 0..100 {
            let blobs = blobs(&mut rng);
            let mut thinned = blobs.clone();
            thinned.thin(&blobs.depths());
            assert_eq!(counts(&thinned), counts(&blobs));
            for at in (0..SIDE * SIDE).filter(|&at| thinned.is_set[at]) {
                assert!(blobs.is_set[at]);
                // So a block of four texels is left only where each of them holds a line by its corner.
                assert!(!thinned.is_spare(at), "{at}");
            }
        }
    }

    #[test]
    fn depths_are_distances_to_the_nearest_texel_that_is_not_set() {
        let mut rng = Pcg64Mcg::seed_from_u64(8);
        let blobs = blobs(&mut rng);
        let squared = |a: usize, b: usize| {
            let [x, y] = [(a % SIDE).abs_diff(b % SIDE), (a / SIDE).abs_diff(b / SIDE)];
            (x * x + y * y) as u32
        };
        for (at, depth) in blobs.depths().into_iter().enumerate() {
            let unset = (0..SIDE * SIDE).filter(|&other| !blobs.is_set[other]);
            let (x, y) = (at % SIDE, at / SIDE);
            let rim = [x + 1, y + 1, SIDE - x, SIDE - y].map(|way| (way * way) as u32);
            let nearest = unset.map(|other| squared(at, other)).chain(rim).min();
            assert_eq!(Some(depth), nearest);
        }
    }
}
