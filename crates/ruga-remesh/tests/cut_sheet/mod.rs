//! Sheets to be cut, what is measured of them, and what must hold of every cut.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use ruga_mesh::{Id, PerVertex, TriMesh, VertexId, face_areas, face_normals, subdivide};
use ruga_remesh::{CutPoint, LevelCut, shares_left};

use crate::shapes::{Shape, grid};

/// A mesh with positions, m.
pub(crate) struct Sheet {
    pub(crate) mesh: TriMesh,
    pub(crate) positions: Vec<Vector3<f64>>,
}

impl Sheet {
    pub(crate) fn new(positions: Vec<[f64; 2]>, faces: Vec<[u32; 3]>) -> Self {
        Self {
            mesh: TriMesh::new(positions.len(), faces).expect("a mesh"),
            positions: positions
                .iter()
                .map(|p| Vector3::new(p[0], p[1], 0.0))
                .collect(),
        }
    }

    /// The unit square, irregularly.
    pub(crate) fn square(n: usize, seed: u64) -> Self {
        let grid = grid(Shape::Flat, n, 0.25, seed);
        Self {
            mesh: grid.mesh,
            positions: grid.positions.into_vec(),
        }
    }

    /// Nearly equilateral triangles of edge 1 m.
    pub(crate) fn triangular(n: u32, seed: u64) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut jitter = || random.random_range(-0.08..0.08);
        let at = |i: u32, j: u32| j * (n + 1) + i;
        let (mut points, mut faces) = (Vec::new(), Vec::new());
        for j in 0..=n {
            for i in 0..=n {
                let [x, y] = [i, j].map(f64::from);
                points.push([x + 0.5 * y + jitter(), 0.75f64.sqrt() * y + jitter()]);
                if i < n && j < n {
                    faces.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                    faces.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
        Self::new(points, faces)
    }

    /// An octahedron, four times subdivided; the poles are at z = 1 m and -1 m, smoothed a little.
    pub(crate) fn ball() -> Self {
        let corners = [0, 1, 2].map(|axis| Vector3::ith(axis, 1.0));
        let corners = [corners, corners.map(|p| -p)].concat();
        let quarters = [[0, 1], [1, 3], [3, 4], [4, 0]];
        let faces = quarters.iter().flat_map(|&[a, b]| [[a, b, 2], [b, a, 5]]);
        let octahedron = TriMesh::new(6, faces.collect()).expect("a closed mesh");
        let fine = subdivide(&octahedron, 4, &PerVertex::filled(6, false));
        Self {
            mesh: fine.mesh,
            positions: fine.fine_from_coarse.apply(&corners),
        }
    }

    pub(crate) fn triangle() -> Self {
        Self::new(vec![[0.0, 0.0], [2.0, 0.0], [0.5, 1.5]], vec![[0, 1, 2]])
    }

    pub(crate) fn level(&self, of: impl Fn(&Vector3<f64>) -> f64) -> PerVertex<f64> {
        self.positions.iter().map(of).collect()
    }

    pub(crate) fn cut(&self, level: &PerVertex<f64>, snap: f64) -> Self {
        let cut = LevelCut::new(&self.mesh, level, snap).expect("a finite level");
        self.check(level, snap, &cut);
        let points = cut.vertices.as_slice().iter();
        Self {
            positions: points.map(|p| p.value(&self.positions)).collect(),
            mesh: cut.mesh,
        }
    }

    pub(crate) fn area(&self) -> f64 {
        let areas = face_areas(&self.mesh, &self.positions);
        areas.as_slice().iter().sum()
    }

    /// What the shares of the faces' areas add up to.
    pub(crate) fn area_by_shares(&self, level: &PerVertex<f64>) -> f64 {
        let shares = shares_left(&self.mesh, level).expect("a finite level");
        let areas = face_areas(&self.mesh, &self.positions);
        areas.iter().map(|(face, area)| area * shares[face]).sum()
    }

    /// Least height of every face over its longest edge.
    pub(crate) fn slenderness(&self) -> Vec<f64> {
        let areas = face_areas(&self.mesh, &self.positions);
        let corners = |face| self.mesh.faces()[face].map(|v| self.positions[v.index()]);
        let longest = |face| {
            let corners: [Vector3<f64>; 3] = corners(face);
            let edges = [0, 1, 2].map(|i| (corners[i] - corners[(i + 1) % 3]).norm());
            edges.into_iter().fold(0.0, f64::max)
        };
        let ratios = areas
            .iter()
            .map(|(f, area)| 2.0 * area / longest(f).powi(2));
        ratios.collect()
    }

    pub(crate) fn parts(&self) -> usize {
        self.mesh.connected_parts(|_| true).len()
    }

    /// Border loops; a vertex of a manifold lies on one at most.
    pub(crate) fn loops(&self) -> usize {
        let mut next = PerVertex::filled(self.mesh.vertex_count(), None);
        for (_, edge) in self.mesh.edges().iter().filter(|(_, e)| e.is_border()) {
            let follower = next[edge.vertices[0]].replace(edge.vertices[1]);
            assert_eq!(follower, None, "two borders at {:?}", edge.vertices[0]);
        }
        let mut loops = 0;
        for start in next.ids() {
            let mut at = start;
            loops += usize::from(next[start].is_some());
            while let Some(then) = next[at].take() {
                at = then;
            }
            // A way that ends elsewhere would be no loop.
            assert_eq!(at, start);
        }
        loops
    }

    pub(crate) fn euler_number(&self) -> i64 {
        let mesh = &self.mesh;
        mesh.vertex_count() as i64 - mesh.edges().len() as i64 + mesh.face_count() as i64
    }

    /// Whether a vertex of this sheet lies on the line, be it by snapping.
    fn is_on_line(&self, level: &PerVertex<f64>, snap: f64, vertex: VertexId) -> bool {
        let is_near = |other: VertexId| {
            let [here, there] = [level[vertex], level[other]];
            here * there < 0.0 && here / (here - there) < snap * (1.0 + 1e-12)
        };
        let faces = self.mesh.vertex_faces(vertex).iter();
        let mut neighbours = faces.flat_map(|&f| self.mesh.faces()[f]);
        level[vertex] == 0.0 || neighbours.any(is_near)
    }

    /// Asserts what must hold of any cut of this sheet: places, order, winding, manifoldness, borders.
    fn check(&self, level: &PerVertex<f64>, snap: f64, cut: &LevelCut) {
        self.check_places(level, snap, cut);
        let positions: Vec<_> = cut
            .vertices
            .iter()
            .map(|(_, p)| p.value(&self.positions))
            .collect();
        let normals = face_normals(&cut.mesh, &positions);
        let old_normals = face_normals(&self.mesh, &self.positions);
        let mut used = 0;
        for (face, corners) in cut.mesh.faces().iter() {
            let parent = cut.parents[face];
            assert!(
                normals[face].dot(&old_normals[parent]) > 0.0,
                "face {face:?} is turned over"
            );
            for v in corners {
                let ends = cut.vertices[*v].ends;
                assert!(
                    ends.iter()
                        .all(|end| self.mesh.faces()[parent].contains(end))
                );
                assert!(v.index() <= used, "vertices are numbered as they are used");
                used = used.max(v.index() + 1);
            }
        }
        assert_eq!(used, cut.mesh.vertex_count());
        assert!(cut.parents.as_slice().is_sorted());
        for v in cut.vertices.ids() {
            assert!(cut.mesh.ring(v).is_some(), "one fan at {v:?}");
        }
        for edge in cut.mesh.edges().as_slice().iter().filter(|e| e.is_border()) {
            let [a, b] = edge.vertices.map(|v| cut.vertices[v]);
            let is_on_line =
                |p: CutPoint| p.fraction > 0.0 || self.is_on_line(level, snap, p.ends[0]);
            assert!(
                self.is_on_border(a, b) || (is_on_line(a) && is_on_line(b)),
                "{a:?} {b:?}"
            );
        }
    }

    /// Vertices of the sheet that stay are positive or on the line, and others are where the level is zero.
    fn check_places(&self, level: &PerVertex<f64>, snap: f64, cut: &LevelCut) {
        for (_, point) in cut.vertices.iter() {
            let [start, end] = point.ends;
            if start == end {
                assert_eq!(point.fraction, 0.0);
                assert!(level[start] > 0.0 || self.is_on_line(level, snap, start));
                continue;
            }
            assert!(level[start] > 0.0 && level[end] < 0.0);
            let least = snap * (1.0 - 1e-12);
            assert!((least..=1.0 - least).contains(&point.fraction));
            let scale = level[start].max(-level[end]);
            assert!(point.value(level.as_slice()).abs() <= 1e-15 * scale);
        }
    }

    /// Whether two places of the sheet lie on one edge of its border.
    fn is_on_border(&self, a: CutPoint, b: CutPoint) -> bool {
        let is_in = |ends: [VertexId; 2]| {
            [a, b]
                .iter()
                .all(|p| p.ends.iter().all(|end| ends.contains(end)))
        };
        let edges = self.mesh.edges().as_slice().iter();
        edges
            .filter(|edge| edge.is_border())
            .any(|edge| is_in(edge.vertices))
    }
}
