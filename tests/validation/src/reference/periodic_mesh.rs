//! Rows of equilateral triangles on a periodic rectangle, with copies beyond its border.

use nalgebra::Vector3;

/// A periodic mesh laid out in the plane with a margin of copied triangles around it.
///
/// ```text
/// row 2   o---o---o---o      vertex (i, j) of the rectangle is number j columns + i;
///          \ / \ / \ / \     odd rows stand half an edge further
/// row 1     o---o---o---o
///          / \ / \ / \ /
/// row 0   o---o---o---o
/// ```
#[derive(Clone, Debug)]
pub(super) struct PeriodicMesh {
    /// Edges along x.
    pub(super) columns: usize,
    /// Rows of triangles along y, even.
    pub(super) rows: usize,
    /// Length of an edge, m.
    pub(super) edge: f64,
    /// Rest positions, copies included, m.
    pub(super) points: Vec<Vector3<f64>>,
    /// Triangles, counter-clockwise, copies included.
    pub(super) faces: Vec<[u32; 3]>,
    /// Whether a triangle is a copy.
    pub(super) is_copy: Vec<bool>,
    /// Per vertex: which vertex of the rectangle it is, and how many periods along x and y it
    /// stands away from there.
    pub(super) origins: Vec<(usize, [i32; 2])>,
}

impl PeriodicMesh {
    /// A rectangle of so many edges and rows, with `margin` rings of copied triangles.
    ///
    /// # Panics
    /// When the number of rows is odd: odd rows are shifted.
    pub(super) fn new(columns: usize, rows: usize, edge: f64, margin: usize) -> Self {
        assert!(rows.is_multiple_of(2), "rows repeat in pairs");
        let height = edge * 0.75_f64.sqrt();
        let (wide, beyond) = (columns + 2 * margin + 1, margin as i32);
        let index = |i: i32, j: i32| ((j + beyond) as usize * wide + (i + beyond) as usize) as u32;
        let mut mesh = Self {
            columns,
            rows,
            edge,
            points: Vec::new(),
            faces: Vec::new(),
            is_copy: Vec::new(),
            origins: Vec::new(),
        };
        let [nx, ny] = [columns as i32, rows as i32];
        for j in -beyond..=ny + beyond {
            for i in -beyond..=nx + beyond {
                let odd = j.rem_euclid(2);
                let x = f64::from(i) + 0.5 * f64::from(odd);
                mesh.points
                    .push(Vector3::new(x * edge, f64::from(j) * height, 0.0));
                let origin = j.rem_euclid(ny) * nx + i.rem_euclid(nx);
                let cell = [i.div_euclid(nx), j.div_euclid(ny)];
                mesh.origins.push((origin as usize, cell));
                if i == nx + beyond || j == ny + beyond {
                    continue;
                }
                let [here, next] = [index(i, j), index(i + 1, j)];
                let [above, after] = [index(i, j + 1), index(i + 1, j + 1)];
                mesh.faces.extend(if odd == 0 {
                    [[here, next, above], [next, after, above]]
                } else {
                    [[here, next, after], [here, after, above]]
                });
                let is_inside = (0..nx).contains(&i) && (0..ny).contains(&j);
                mesh.is_copy.extend([!is_inside; 2]);
            }
        }
        mesh
    }

    /// Periods along x and y, m.
    pub(super) fn extent(&self) -> [f64; 2] {
        [
            self.columns as f64 * self.edge,
            self.rows as f64 * self.edge * 0.75_f64.sqrt(),
        ]
    }

    /// Number of vertices of the rectangle.
    pub(super) fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// Whether a vertex, copies included, is the one inside the rectangle.
    pub(super) fn is_original(&self, vertex: usize) -> bool {
        self.origins[vertex].1 == [0, 0]
    }

    /// Number, copies included, of a vertex of the rectangle.
    pub(super) fn originals(&self) -> Vec<usize> {
        let mut found = vec![0; self.count()];
        for vertex in (0..self.points.len()).filter(|&v| self.is_original(v)) {
            found[self.origins[vertex].0] = vertex;
        }
        found
    }
}
