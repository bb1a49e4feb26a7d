//! Marching triangles: what is left of the drawn mesh, and of the springs, where material has burnt away.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::lattice::SpringLattice;
use super::spring_set::SpringError;

/// What is left of a drawn triangle, by how many of its corners have mass to lose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remains {
    /// All of it: no corner is burnt.
    Whole,
    /// One corner is cut off.
    Quadrilateral,
    /// One corner is left, or two of which one is just burnt.
    Triangle,
    /// Nothing: no corner has mass to lose.
    Dropped,
}

/// What is left of a sheet, after Losasso et al. 2006.
///
/// The drawn mesh has four triangles a cell, around a virtual centre in the mean of its corners. Level set is the
/// relative mass `m' = m - m_loss`; on an edge it is linear, eq. (7), and at a virtual centre the mean of its corners,
/// which the paper does not say. A corner whose relative mass is zero counts as unburnt, but a triangle needs
/// one that is more, or it would be a line or a point.
#[derive(Clone, Debug, Default)]
pub struct Remnant {
    /// Corners, virtual centres and cut edges (m).
    pub points: Vec<Vector3<f64>>,
    /// Triangles, wound as the cells are.
    pub faces: Vec<[u32; 3]>,
    /// What is left of each drawn triangle; number `4 c + k` lies at side `k` of cell `c`.
    pub remains: Vec<Remains>,
}

/// The drawn mesh with a level at each of its vertices, and the points that are kept.
struct Marching {
    places: Vec<Vector3<f64>>,
    levels: Vec<f64>,
    /// Kept points by the ends of the edge that they cut; a vertex is an edge from itself to itself.
    kept: BTreeMap<[u32; 2], u32>,
    points: Vec<Vector3<f64>>,
}

impl Remnant {
    /// Cuts the drawn mesh at positions (m) of a lattice where the relative mass (kg) of the corners is zero.
    ///
    /// Particles without a relative mass count as burnt.
    pub fn new(
        lattice: &SpringLattice,
        positions: &[Vector3<f64>],
        relative_masses: &[f64],
    ) -> Self {
        let mut marching = Marching::new(lattice, positions, relative_masses);
        let mut remnant = Self::default();
        let corners = lattice.corner_count() as u32;
        for (cell, centre) in lattice.cells().iter().zip(corners..) {
            for k in 0..4 {
                let triangle = [cell[k], cell[(k + 1) % 4], centre];
                let polygon = marching.clipped(triangle);
                remnant.remains.push(match polygon.len() {
                    3 if marching.is_whole(triangle) => Remains::Whole,
                    3 => Remains::Triangle,
                    4 => Remains::Quadrilateral,
                    _ => Remains::Dropped,
                });
                let fan = polygon.get(1..).unwrap_or_default().windows(2);
                let faces = fan.map(|pair| [polygon[0], pair[0], pair[1]]);
                remnant.faces.extend(faces);
            }
        }
        remnant.points = marching.points;
        remnant
    }

    /// Springs that hold what is left: those beside which a drawn triangle is there. The lattice is never cut, and a
    /// burnt particle stays as long as a spring ends at it.
    ///
    /// # Errors
    /// None for the lattice that the remnant was cut from.
    pub fn springs(&self, lattice: &SpringLattice) -> Result<SpringLattice, SpringError> {
        lattice.without_burnt(|triangle| {
            let own = self.remains.get(triangle as usize);
            own.is_some_and(|own| *own != Remains::Dropped)
        })
    }

    /// Area of all faces (m2).
    pub fn area(&self) -> f64 {
        self.faces.iter().map(|face| self.face_area(face)).sum()
    }

    /// Area of each piece that hangs together at its points (m2), the largest first.
    pub fn pieces(&self) -> Vec<f64> {
        let mut parents: Vec<usize> = (0..self.points.len()).collect();
        for &[a, b, c] in &self.faces {
            let first = root(&mut parents, a as usize);
            for other in [b, c] {
                let other = root(&mut parents, other as usize);
                parents[other] = first;
            }
        }
        let mut areas = BTreeMap::new();
        for face in &self.faces {
            let piece = root(&mut parents, face[0] as usize);
            *areas.entry(piece).or_insert(0.0) += self.face_area(face);
        }
        let mut areas: Vec<f64> = areas.into_values().collect();
        areas.sort_by(|a, b| b.total_cmp(a));
        areas
    }

    fn face_area(&self, face: &[u32; 3]) -> f64 {
        let [a, b, c] = face.map(|p| self.points[p as usize]);
        0.5 * (b - a).cross(&(c - a)).norm()
    }
}

/// The first of all points that hang together with one, found through parents, which are shortened on the way.
fn root(parents: &mut [usize], mut point: usize) -> usize {
    while parents[point] != point {
        parents[point] = parents[parents[point]];
        point = parents[point];
    }
    point
}

impl Marching {
    fn new(lattice: &SpringLattice, positions: &[Vector3<f64>], relative_masses: &[f64]) -> Self {
        let corners = lattice.corner_count();
        let level = |p: usize| relative_masses.get(p).copied().unwrap_or(f64::NAN);
        let mut places = positions.get(..corners).unwrap_or_default().to_vec();
        let mut levels: Vec<f64> = (0..places.len()).map(level).collect();
        for cell in lattice.cells() {
            let all = cell.map(|p| p as usize);
            places.push(all.iter().map(|&p| places[p]).sum::<Vector3<f64>>() * 0.25);
            levels.push(all.iter().map(|&p| levels[p]).sum::<f64>() * 0.25);
        }
        Self {
            places,
            levels,
            kept: BTreeMap::new(),
            points: Vec::new(),
        }
    }

    fn is_whole(&self, triangle: [u32; 3]) -> bool {
        triangle.iter().all(|&p| self.levels[p as usize] >= 0.0)
    }

    /// The part of a triangle above the level zero; empty if no corner is.
    fn clipped(&mut self, triangle: [u32; 3]) -> Vec<u32> {
        let levels = triangle.map(|p| self.levels[p as usize]);
        if !levels.iter().any(|level| *level > 0.0) {
            return Vec::new();
        }
        let mut polygon = Vec::with_capacity(4);
        for k in 0..3 {
            let next = (k + 1) % 3;
            let (p, q) = (triangle[k], triangle[next]);
            if levels[k] >= 0.0 {
                polygon.push(self.point([p, p]));
            }
            // Not by the sign of a product, which underflows.
            if levels[k].min(levels[next]) < 0.0 && levels[k].max(levels[next]) > 0.0 {
                // Always from the same end, so that both triangles beside the edge have one point.
                polygon.push(self.point([p.min(q), p.max(q)]));
            }
        }
        polygon
    }

    /// The number of a kept point, which is made when it is first asked for.
    fn point(&mut self, edge: [u32; 2]) -> u32 {
        if let Some(&found) = self.kept.get(&edge) {
            return found;
        }
        let [p, q] = edge.map(|p| p as usize);
        self.points.push(if p == q {
            self.places[p]
        } else {
            let t = self.levels[p] / (self.levels[p] - self.levels[q]);
            self.places[p] * (1.0 - t) + self.places[q] * t
        });
        let made = self.points.len() as u32 - 1;
        self.kept.insert(edge, made);
        made
    }
}
