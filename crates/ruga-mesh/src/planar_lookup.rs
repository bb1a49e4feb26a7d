//! Lookup of the material point that carries a texture coordinate.

use nalgebra::Vector2;

use crate::{FaceId, MaterialPoint, PerFace};

/// Finds the face under a point of the UV plane; built once, asked many times.
///
/// A uniform grid of about as many cells as faces, each cell listing the faces whose bounding box
/// touches it. Where faces are so large, or so many lie on each other, that these lists would grow
/// out of proportion, cells are larger: memory stays proportional to the number of faces.
#[derive(Clone, Debug)]
pub struct PlanarLookup {
    triangles: PerFace<[Vector2<f64>; 3]>,
    low: Vector2<f64>,
    cell: f64,
    columns: usize,
    rows: usize,
    starts: Vec<u32>,
    entries: Vec<FaceId>,
}

/// Entries in the lists of all cells, per face, above which cells are made larger. A good chart has
/// three or four.
const MOST_ENTRIES: usize = 16;

impl PlanarLookup {
    /// Indexes triangles in the plane; faces with coordinates that are not finite are left out.
    pub fn new(triangles: PerFace<[Vector2<f64>; 3]>) -> Self {
        let finite = |t: &[Vector2<f64>; 3]| t.iter().flatten().all(|c| c.is_finite());
        let corners = || triangles.as_slice().iter().filter(|t| finite(t)).flatten();
        let low = corners().fold(Vector2::repeat(f64::INFINITY), |a, b| a.inf(b));
        let high = corners().fold(Vector2::repeat(f64::NEG_INFINITY), |a, b| a.sup(b));
        // A chart that is a line or a point needs a size to divide by.
        let extent = (high - low).map(|c| c.max(f64::MIN_POSITIVE));
        let count = triangles.len().max(1) as f64;
        let longest = extent.x.max(extent.y);
        // Square cells of the faces' mean area. On a narrow chart these would be many thousands in
        // a row, hence the bound.
        let cell = (extent.x / count * extent.y).sqrt().max(longest / 4096.0);
        let is_empty = corners().next().is_none();
        let mut lookup = Self {
            triangles,
            low,
            cell,
            columns: 1,
            rows: 1,
            starts: Vec::new(),
            entries: Vec::new(),
        };
        if !is_empty {
            lookup.choose_cells(extent);
        }
        lookup.fill();
        lookup
    }

    /// Doubles the cells until their lists are short enough, at the latest when there is one cell.
    fn choose_cells(&mut self, extent: Vector2<f64>) {
        let most = MOST_ENTRIES * self.triangles.len();
        loop {
            let size = |length: f64| ((length / self.cell) as usize + 1).clamp(1, 8192);
            (self.columns, self.rows) = (size(extent.x), size(extent.y));
            let covered = |[first, last]: [(usize, usize); 2]| {
                (last.0 - first.0 + 1) * (last.1 - first.1 + 1)
            };
            // Counted before the lists are made, for it is their memory that must not grow.
            let entries: usize = self.boxes().map(|(_, corners)| covered(corners)).sum();
            if entries <= most || self.columns * self.rows == 1 {
                return;
            }
            self.cell *= 2.0;
        }
    }

    /// Faces with finite coordinates, and the first and last cell of each one's bounding box.
    fn boxes(&self) -> impl Iterator<Item = (FaceId, [(usize, usize); 2])> + '_ {
        let finite = |t: &[Vector2<f64>; 3]| t.iter().flatten().all(|c| c.is_finite());
        let faces = self.triangles.iter().filter(move |(_, t)| finite(t));
        faces.map(|(face, t)| {
            let first = self.cell_of(t[0].inf(&t[1]).inf(&t[2]));
            let last = self.cell_of(t[0].sup(&t[1]).sup(&t[2]));
            (face, [first, last])
        })
    }

    fn fill(&mut self) {
        self.starts = vec![0; self.columns * self.rows + 1];
        let mut pairs: Vec<(u32, FaceId)> = Vec::with_capacity(2 * self.triangles.len());
        for (face, [first, last]) in self.boxes() {
            for row in first.1..=last.1 {
                for column in first.0..=last.0 {
                    pairs.push(((row * self.columns + column) as u32, face));
                }
            }
        }
        // By cell and then by face: so the first face that `locate` meets has the lowest id.
        pairs.sort_unstable();
        for (cell, _) in &pairs {
            self.starts[*cell as usize + 1] += 1;
        }
        for i in 1..self.starts.len() {
            self.starts[i] += self.starts[i - 1];
        }
        self.entries = pairs.into_iter().map(|pair| pair.1).collect();
    }

    fn cell_of(&self, point: Vector2<f64>) -> (usize, usize) {
        // The cast saturates and takes NaN to zero: places outside fall into a cell of the rim,
        // none of whose faces holds them.
        let index = |offset: f64, count: usize| ((offset / self.cell) as usize).min(count - 1);
        let offset = point - self.low;
        (index(offset.x, self.columns), index(offset.y, self.rows))
    }

    /// The face that contains `point`, the one with the lowest id on a common edge; `None` outside of
    /// all faces, as for a point that is not finite.
    pub fn locate(&self, point: Vector2<f64>) -> Option<MaterialPoint> {
        self.locate_all(point).next()
    }

    /// All faces that contain `point`, ascending: several on an edge, or where charts overlap.
    pub fn locate_all(&self, point: Vector2<f64>) -> impl Iterator<Item = MaterialPoint> + '_ {
        let (column, row) = self.cell_of(point);
        let cell = row * self.columns + column;
        let range = self.starts[cell] as usize..self.starts[cell + 1] as usize;
        self.entries[range].iter().filter_map(move |&face| {
            let barycentric = barycentric(self.triangles[face], point)?;
            // Rounding must not leave a gap along the common edge of two faces.
            let inside = barycentric.iter().all(|&b| b >= -1e-12);
            inside.then_some(MaterialPoint { face, barycentric })
        })
    }
}

/// Barycentric coordinates of a point of the plane; `None` for a triangle without area.
pub fn barycentric(triangle: [Vector2<f64>; 3], point: Vector2<f64>) -> Option<[f64; 3]> {
    let [a, b, c] = triangle;
    let cross = |u: Vector2<f64>, v: Vector2<f64>| u.x * v.y - u.y * v.x;
    // Signed: in a mirrored chart all three areas are negative, and the ratios are the same.
    let area = cross(b - a, c - a);
    let v = cross(point - a, c - a) / area;
    let w = cross(b - a, point - a) / area;
    // Tested after the division, which also finds an area so small that this overflows.
    (v.is_finite() && w.is_finite()).then_some([1.0 - v - w, v, w])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Id;

    #[test]
    fn outside_and_empty() {
        let empty = PlanarLookup::new(Vec::new().into());
        assert_eq!(empty.locate(Vector2::new(0.5, 0.5)), None);
        let one = PlanarLookup::new(
            vec![[
                Vector2::new(0.0, 0.0),
                Vector2::new(1.0, 0.0),
                Vector2::new(0.0, 1.0),
            ]]
            .into(),
        );
        assert_eq!(one.locate(Vector2::new(0.9, 0.9)), None);
        let found = one.locate(Vector2::new(0.25, 0.25)).expect("inside");
        assert_eq!(found.face, FaceId::from_index(0));
        assert!((found.barycentric[0] - 0.5).abs() < 1e-15);
    }
}
