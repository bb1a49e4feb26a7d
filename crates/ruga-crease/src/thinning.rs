//! Thinning of a black and white image to its skeleton.

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

    /// Removes texels from the rim of every shape until lines of one texel are left, which hang together as the
    /// shapes did (Zhang and Suen 1984).
    pub(crate) fn thin(&mut self) {
        let mut set: Vec<usize> = (0..self.is_set.len())
            .filter(|&at| self.is_set[at])
            .collect();
        loop {
            let before = set.len();
            for pass in 0..2 {
                // All are judged before any goes, or a stroke would vanish from one side.
                let gone: Vec<_> = set
                    .iter()
                    .copied()
                    .filter(|&at| self.may_go(at, pass))
                    .collect();
                for at in gone {
                    self.is_set[at] = false;
                }
                set.retain(|&at| self.is_set[at]);
            }
            if set.len() == before {
                break;
            }
        }
        // The method leaves staircases two texels wide; a texel whose neighbours touch without it can go.
        for at in set {
            let [n, _, e, _, s, _, w, _] = self.neighbours(at);
            let beside = self.neighbours(at).iter().filter(|set| **set).count();
            let is_stair = n != s && e != w;
            if is_stair && beside == 2 {
                self.is_set[at] = false;
            }
        }
    }

    fn may_go(&self, at: usize, pass: usize) -> bool {
        let around = self.neighbours(at);
        let count = around.iter().filter(|set| **set).count();
        let enters = (0..8)
            .filter(|&k| !around[k] && around[(k + 1) % 8])
            .count();
        let [n, _, e, _, s, _, w, _] = around;
        let sides = match pass {
            0 => !(e && s && (n || w)),
            _ => !(n && w && (e || s)),
        };
        (2..=6).contains(&count) && enters == 1 && sides
    }
}
