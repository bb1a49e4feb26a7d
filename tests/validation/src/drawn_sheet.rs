//! Flat sheets with lines drawn at will, as the product cuts and fits them.

use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_crease::{Corners, LineInput, LineTracer, MeshPiece, TracedLine, cut_lines};
use ruga_mesh::{EdgeId, Id, MaterialPoint, PerEdge, PerVertex, TriMesh, subdivide};
use ruga_remesh::{
    FeatureCurve, FeatureCurves, PolyhedralSurface, RemeshSettings, Sizing, SurfaceMesh, remesh,
};

/// A flat square sheet as an artist would draw it: squares of unit side, vertices moved about.
pub struct DrawnSheet {
    /// The artist's mesh.
    pub mesh: TriMesh,
    /// Where its vertices are.
    pub positions: Vec<Vector3<f64>>,
}

impl DrawnSheet {
    /// A sheet of `n` by `n` squares.
    ///
    /// # Panics
    /// When there are none.
    pub fn new(n: usize, seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut positions = Vec::new();
        for j in 0..=n {
            for i in 0..=n {
                let inner = i > 0 && j > 0 && i < n && j < n;
                let mut shift = || {
                    if inner {
                        0.3 * random.random_range(-1.0..1.0)
                    } else {
                        0.0
                    }
                };
                positions.push(Vector3::new(i as f64 + shift(), j as f64 + shift(), 0.0));
            }
        }
        let at = |i: usize, j: usize| (j * (n + 1) + i) as u32;
        let square = |k: usize| {
            let (i, j) = (k % n, k / n);
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        };
        let faces = (0..n * n).flat_map(square).collect();
        Self {
            mesh: TriMesh::new(positions.len(), faces).expect("a valid grid"),
            positions,
        }
    }

    /// Traces a polyline with rounded corners.
    ///
    /// # Panics
    /// When it leaves the sheet.
    pub fn trace(&self, points: Vec<Vector3<f64>>) -> TracedLine {
        let input = LineInput::Positions {
            points,
            is_closed: false,
            reach: 0.1,
            corners: Corners::Round,
        };
        let traced = LineTracer::new(&self.mesh, &self.positions).trace(&input);
        traced.expect("a line on the film")
    }

    /// Position on a line.
    ///
    /// # Panics
    /// When the line is empty.
    pub fn on(&self, line: &TracedLine, at: f64) -> Vector3<f64> {
        let place = line.place(at).expect("a line has segments");
        place.interpolate(&self.mesh, &self.positions)
    }

    /// The sheet in faces of an eighth of a square, cut along lines whose edges are features.
    ///
    /// # Panics
    /// When a part of a line could not be cut.
    pub fn cut(&self, lines: &[TracedLine]) -> SurfaceMesh {
        let corners = PerVertex::filled(self.mesh.vertex_count(), true);
        let fine = subdivide(&self.mesh, 3, &corners);
        let mut positions = vec![Vector3::zeros(); fine.mesh.vertex_count()];
        for (face, origin) in fine
            .mesh
            .faces()
            .as_slice()
            .iter()
            .zip(fine.origins.as_slice())
        {
            for (v, barycentric) in face.iter().zip(origin.corners) {
                let face = origin.face;
                let place = MaterialPoint { face, barycentric };
                positions[v.index()] = place.interpolate(&self.mesh, &self.positions);
            }
        }
        let piece = MeshPiece {
            mesh: fine.mesh,
            origins: fine.origins,
            positions,
        };
        let cut = cut_lines(lines, piece);
        assert_eq!(cut.warnings, []);
        let mesh = cut.piece.mesh;
        let mut points: Vec<Option<MaterialPoint>> = vec![None; mesh.vertex_count()];
        for (face, corners) in mesh.faces().iter() {
            for (corner, v) in corners.iter().enumerate() {
                let at = MaterialPoint::at_corner(face, corner);
                points[v.index()] = Some(cut.piece.origins[face].place(at.barycentric));
            }
        }
        // Vertices that a line passes closely are moved onto it.
        for vertex in &cut.vertices {
            points[vertex.vertex.index()] = Some(vertex.place);
        }
        let points: PerVertex<_> = points
            .into_iter()
            .map(|p| p.expect("no lonely vertex"))
            .collect();
        let positions = points
            .iter()
            .map(|(_, p)| p.interpolate(&self.mesh, &self.positions));
        let mut features = PerEdge::filled(mesh.edges().len(), false);
        for crease in &cut.edges {
            features[crease.edge] = true;
        }
        SurfaceMesh {
            positions: positions.collect(),
            fixed: PerVertex::filled(mesh.vertex_count(), false),
            mesh,
            points,
            features,
        }
    }

    /// The sheet fitted to edges of length `edge` along and across the lines, `times` over, of which every
    /// vertex wants up to a tenth more or less.
    ///
    /// # Panics
    /// When the edges are no proper size.
    pub fn fitted(&self, lines: &[TracedLine], edge: f64, times: u64) -> Vec<SurfaceMesh> {
        self.fitted_to(lines, &|_| edge, times)
    }

    /// The same with edges whose length depends on where they are.
    ///
    /// # Panics
    /// When the edges are no proper size.
    pub fn fitted_to(
        &self,
        lines: &[TracedLine],
        edge: &dyn Fn(&Vector3<f64>) -> f64,
        times: u64,
    ) -> Vec<SurfaceMesh> {
        let plain = PerEdge::filled(self.mesh.edges().len(), false);
        let surface = PolyhedralSurface::new(&self.mesh, &self.positions, &plain);
        let surface = surface.expect("arrays fit");
        let curves = lines.iter().map(|line| FeatureCurve {
            pieces: line
                .segments()
                .iter()
                .map(|s| [0.0, 1.0].map(|share| s.place(share)))
                .collect(),
            is_closed: line.is_closed(),
        });
        let surface = FeatureCurves::new(&surface, &curves.collect::<Vec<_>>());
        let mut mesh = self.cut(lines);
        let mut fits = Vec::new();
        for seed in 0..times {
            let mut random = Pcg64Mcg::seed_from_u64(seed);
            let tensor = |at: &Vector3<f64>| {
                let wanted = edge(at) * (1.0 + 0.1 * random.random_range(-1.0..1.0));
                Matrix3::identity() / (wanted * wanted)
            };
            let sizing = Sizing {
                tensors: mesh.positions.as_slice().iter().map(tensor).collect(),
            };
            let made = remesh(&mesh, &sizing, &surface, &RemeshSettings::default());
            mesh = made.expect("a valid sizing").mesh;
            fits.push(mesh.clone());
        }
        fits
    }
}

/// The edges of a fitted mesh that are features inside.
pub fn feature_edges(mesh: &SurfaceMesh) -> Vec<EdgeId> {
    let edges = mesh.mesh.edges().iter();
    let inner = edges.filter(|(id, edge)| mesh.features[*id] && !edge.is_border());
    inner.map(|(id, _)| id).collect()
}
