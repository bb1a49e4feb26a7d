//! Who is whose neighbour on the head: two hexagons of triangles, sewn together at their rims.
//!
//! The front hexagon is the face; the back one has half as many rings, so that triangles are twice as
//! large where hair would be. Rows run from ear to ear. Eyes and mouth are slits along rows, each with
//! a strip of skin that turns inward. Mirroring a row mirrors the mesh.

use std::collections::BTreeMap;

use nalgebra::Vector2;

/// Rings of the front hexagon around its middle; even.
pub(super) const RINGS: i32 = 26;

/// Where a vertex is in the lattice: mirrored by changing the sign of `twice_column`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Site {
    pub(super) part: Part,
    pub(super) row: i32,
    /// Twice the number of edges from the middle of the row.
    pub(super) twice_column: i32,
}

/// What a vertex belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Part {
    /// The front hexagon; at a slit, the vertices above it and its corners.
    Front,
    /// Lower side of a slit.
    Below,
    /// Inner edge of the strip above a slit, and at its corners.
    InnerAbove,
    /// Inner edge of the strip below a slit.
    InnerBelow,
    /// The back hexagon.
    Back,
}

impl Site {
    pub(super) fn mirrored(self) -> Self {
        Self {
            twice_column: -self.twice_column,
            ..self
        }
    }

    /// Place in the plane of its hexagon, an edge of the lattice long 1.
    pub(super) fn place(self) -> Vector2<f64> {
        let height = 0.75_f64.sqrt();
        Vector2::new(
            0.5 * f64::from(self.twice_column),
            height * f64::from(self.row),
        )
    }

    /// The ring it lies on.
    pub(super) fn ring(self) -> i32 {
        let (row, column) = (self.row.abs(), self.twice_column.abs());
        row.max((row + column) / 2)
    }
}

/// A slit along a row, from corner to corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slit {
    pub(super) row: i32,
    pub(super) twice_columns: [i32; 2],
}

impl Slit {
    pub(super) fn mirrored(self) -> Self {
        let [from, to] = self.twice_columns;
        Self {
            row: self.row,
            twice_columns: [-to, -from],
        }
    }

    /// Its vertices counter-clockwise, as seen from the front, with the inner ones beside them.
    pub(super) fn turns(self) -> Vec<[Site; 2]> {
        let [from, to] = self.twice_columns;
        let site = |part, twice_column| Site {
            part,
            row: self.row,
            twice_column,
        };
        let below = (from + 2..to).step_by(2);
        let above = (from..to + 1).step_by(2).map(move |c| from + to - c);
        below
            .map(|c| [site(Part::Below, c), site(Part::InnerBelow, c)])
            .chain(above.map(|c| [site(Part::Front, c), site(Part::InnerAbove, c)]))
            .collect()
    }

    /// Where between its corners a vertex lies: -1 to 1.
    pub(super) fn share(self, twice_column: i32) -> f64 {
        let [from, to] = self.twice_columns;
        f64::from(2 * twice_column - from - to) / f64::from(to - from)
    }

    fn opens(self, site: Site) -> bool {
        let [from, to] = self.twice_columns;
        site.row == self.row && (from + 1..to).contains(&site.twice_column)
    }
}

/// Vertices and triangles, counter-clockwise as seen from outside.
pub(super) struct Lattice {
    pub(super) sites: Vec<Site>,
    pub(super) triangles: Vec<[usize; 3]>,
    /// The first triangle behind the rim of the front hexagon; those before it are the face.
    pub(super) first_behind: usize,
    ids: BTreeMap<Site, usize>,
}

impl Lattice {
    pub(super) fn new(slits: &[Slit]) -> Self {
        let mut lattice = Self {
            sites: Vec::new(),
            triangles: Vec::new(),
            first_behind: 0,
            ids: BTreeMap::new(),
        };
        for [a, b, c] in hexagon(Part::Front, RINGS) {
            let highest = a.row.max(b.row).max(c.row);
            let corner = |site: Site| {
                let is_below = highest == site.row && slits.iter().any(|s| s.opens(site));
                let part = if is_below { Part::Below } else { site.part };
                Site { part, ..site }
            };
            lattice.add([a, b, c].map(corner));
        }
        for slit in slits {
            lattice.strip(*slit);
        }
        lattice.first_behind = lattice.triangles.len();
        lattice.seam();
        for [a, b, c] in hexagon(Part::Back, RINGS / 2) {
            lattice.add([a, c, b]);
        }
        lattice
    }

    pub(super) fn id(&self, site: Site) -> usize {
        self.ids[&site]
    }

    /// For each vertex the one on the other side of the face.
    pub(super) fn mirror(&self) -> Vec<usize> {
        self.sites.iter().map(|s| self.id(s.mirrored())).collect()
    }

    /// For each vertex those that share an edge with it, in ascending order.
    pub(super) fn neighbours(&self) -> Vec<Vec<usize>> {
        let mut neighbours = vec![Vec::new(); self.sites.len()];
        for triangle in &self.triangles {
            for i in 0..3 {
                let [a, b] = [triangle[i], triangle[(i + 1) % 3]];
                neighbours[a].push(b);
                neighbours[b].push(a);
            }
        }
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
        }
        neighbours
    }

    fn add(&mut self, corners: [Site; 3]) {
        let triangle = corners.map(|site| {
            *self.ids.entry(site).or_insert_with(|| {
                self.sites.push(site);
                self.sites.len() - 1
            })
        });
        self.triangles.push(triangle);
    }

    /// Skin from the edge of a slit inward; diagonals mirrored.
    fn strip(&mut self, slit: Slit) {
        let turns = slit.turns();
        for (i, [outer, inner]) in turns.iter().enumerate() {
            let [next_outer, next_inner] = turns[(i + 1) % turns.len()];
            if outer.twice_column + next_outer.twice_column > 0 {
                self.add([*outer, next_outer, next_inner]);
                self.add([*outer, next_inner, *inner]);
            } else {
                self.add([*outer, next_outer, *inner]);
                self.add([next_outer, next_inner, *inner]);
            }
        }
    }

    /// Three triangles per edge of the back hexagon's rim.
    fn seam(&mut self) {
        let (front, back) = (rim(Part::Front, RINGS), rim(Part::Back, RINGS / 2));
        for i in 0..back.len() {
            let [a, b] = [back[i], back[(i + 1) % back.len()]];
            let [p, q, r] = [0, 1, 2].map(|k| front[(2 * i + k) % front.len()]);
            self.add([p, a, q]);
            self.add([a, b, q]);
            self.add([q, b, r]);
        }
    }
}

/// Triangles of a hexagon, counter-clockwise with x to the right and rows upwards.
fn hexagon(part: Part, rings: i32) -> Vec<[Site; 3]> {
    let is_inside = |site: &Site| site.ring() <= rings;
    let site = |row, twice_column| Site {
        part,
        row,
        twice_column,
    };
    let mut triangles = Vec::new();
    for row in -rings..rings {
        let half = 2 * rings - row.abs();
        for column in (-half - 2..=half + 2).step_by(2) {
            let upward = [
                site(row, column),
                site(row, column + 2),
                site(row + 1, column + 1),
            ];
            let downward = [
                site(row, column),
                site(row + 1, column + 1),
                site(row + 1, column - 1),
            ];
            for triangle in [upward, downward] {
                if triangle.iter().all(is_inside) {
                    triangles.push(triangle);
                }
            }
        }
    }
    triangles
}

/// The outer ring of a hexagon, counter-clockwise from its right corner.
fn rim(part: Part, rings: i32) -> Vec<Site> {
    let mut site = Site {
        part,
        row: 0,
        twice_column: 2 * rings,
    };
    let mut sites = Vec::new();
    // Steps along the six sides: rows, and twice the columns.
    for (up, right) in [(1, -1), (0, -2), (-1, -1), (-1, 1), (0, 2), (1, 1)] {
        for _ in 0..rings {
            sites.push(site);
            site.row += up;
            site.twice_column += right;
        }
    }
    sites
}
