//! The foundation of a whole layer: constant stiffness, a base that each frame replaces.

mod drifts;

use nalgebra::Vector3;

use ruga_mesh::{BlockPattern, BlockSlot, Id, SparseRows, TriMesh};

use crate::foundation::{Anchor, NormalFoundation, TangentialSpring};
use crate::layer_part::{PartNumbers, pick, rank};
use crate::line_anchor::{line_spring_energy, line_spring_pulls};
use crate::parameters::{check_finite, check_length};
use crate::shared_out::{for_each_mut, numbered, values};
use crate::sheet::Sheet;
use crate::stencil::FaceCorner;
use crate::{EnergyParts, LineAnchor, RestTriangle, ShellError};

/// Tolerance on the length of a base normal.
const UNIT_TOLERANCE: f64 = 1e-6;

#[derive(Clone, Debug)]
pub(crate) struct LayerFoundation {
    normal: Vec<NormalFoundation>,
    tangential_springs: Vec<TangentialSpring>,
    vertex_areas: Vec<f64>,
    /// Scalar stiffness between deviations, per vertex.
    diagonal: Vec<f64>,
    edges: Vec<EdgeSprings>,
    /// Where the surface below was last set.
    anchors: Vec<Anchor>,
    /// Tangential stiffness of each vertex (N/m³).
    tangential: Vec<f64>,
    /// Stiffness on the gradient of the drift (N/m).
    drift_gradient: f64,
    /// Scalar stiffness between drifts, per vertex; empty where there is none.
    drift_diagonal: Vec<f64>,
    lines: Vec<LineSpring>,
}

/// A line anchor on one of the edges.
#[derive(Clone, Copy, Debug)]
struct LineSpring {
    anchor: LineAnchor,
    /// Rank of the edge in [`LayerFoundation::edges`].
    edge: u32,
    ends: [u32; 2],
    /// `k_a` times the length of the edge (N/m).
    stiffness: f64,
}

/// Scalar stiffness between the ends of an edge.
#[derive(Clone, Debug)]
struct EdgeSprings {
    ends: [u32; 2],
    /// The faces at it, each with the corner at which it begins.
    sides: [Option<FaceCorner>; 2],
    slot: BlockSlot,
    /// Between deviations (N/m).
    stiffness: f64,
    /// Between drifts (N/m).
    drift: f64,
}

/// Stiffness of the springs below a layer, as it is between vertices (N/m).
///
/// ```text
/// F_ij = m_ij n_i n_j' + d_ij t_i (I - n_i n_i')
/// ```
/// `n` are the unit normals of the surface below. A stiffness on the gradient of the drift
/// ([`LayerEnergy::set_drift_gradient_stiffness`](crate::LayerEnergy::set_drift_gradient_stiffness)) is not in it.
#[derive(Clone, Debug)]
pub struct FoundationStiffness {
    /// `m`: a row per vertex, with the vertices that it shares an edge with and itself.
    pub normal: SparseRows,
    /// `t_i`: that of the tangential springs, one per vertex.
    pub tangential: Vec<f64>,
}

impl LayerFoundation {
    /// A foundation under the lower `sheet`, on `mesh`, with this tangential stiffness (N/m³) per
    /// vertex.
    pub(crate) fn new(
        (mesh, sheet): (&TriMesh, &Sheet),
        tangential: Vec<f64>,
        pattern: &BlockPattern,
        anchors: Vec<Anchor>,
    ) -> Self {
        let edges = mesh.edges().iter().map(|(id, edge)| {
            let ends = edge.vertices.map(|v| v.0);
            EdgeSprings {
                ends,
                sides: mesh.edge_sides(id).map(|side| side.map(FaceCorner::new)),
                slot: pattern.slot(ends[1], ends[0]),
                stiffness: 0.0,
                drift: 0.0,
            }
        });
        let mut this = Self {
            normal: Vec::new(),
            tangential_springs: Vec::new(),
            vertex_areas: Vec::new(),
            diagonal: Vec::new(),
            edges: edges.collect(),
            anchors,
            tangential,
            drift_gradient: 0.0,
            drift_diagonal: Vec::new(),
            lines: Vec::new(),
        };
        this.set_rest(sheet);
        this
    }

    /// Recomputes every stiffness for the sheet's present rest metric.
    pub(crate) fn set_rest(&mut self, sheet: &Sheet) {
        let (faces, rest) = (sheet.faces(), sheet.rest());
        let (parameters, area_left) = (sheet.parameters(), sheet.area_left());
        self.normal = numbered(faces.len(), |face| {
            // What is gone is held by nothing.
            let p = &parameters[face];
            let stiffness = [p.normal_stiffness, p.gradient_stiffness];
            let [normal, gradient] = stiffness.map(|k| area_left[face] * k);
            NormalFoundation::new(&rest[face], normal, gradient)
        });
        let mut areas = vec![0.0; self.anchors.len()];
        let mut diagonal = vec![0.0; self.anchors.len()];
        let matrices = values(&self.normal, NormalFoundation::matrix);
        let areas_left = rest
            .iter()
            .zip(sheet.area_left())
            .map(|(rest, left)| left * rest.area());
        for ((face, area), matrix) in faces.iter().zip(areas_left).zip(&matrices) {
            for (corner, &vertex) in face.iter().enumerate() {
                areas[vertex as usize] += area / 3.0;
                diagonal[vertex as usize] += matrix[(corner, corner)];
            }
        }
        self.tangential_springs = areas
            .iter()
            .zip(&self.tangential)
            .map(|(area, k)| TangentialSpring {
                stiffness: area * k,
            })
            .collect();
        // Off-diagonal entries are kept per edge as scalars: a pair's block is the scalar times an
        // outer product of normals, and only the normals change from frame to frame.
        let entry = |side: FaceCorner| {
            let (face, corner) = side.pair();
            matrices[face.index()][(corner, (corner + 1) % 3)]
        };
        for_each_mut(&mut self.edges, |edge| {
            let entries = edge.sides.into_iter().flatten().map(entry);
            edge.stiffness = entries.sum();
        });
        for line in &mut self.lines {
            let edge = &mut self.edges[line.edge as usize];
            line.stiffness = line.anchor.stiffness * edge.length(rest);
            // The mass matrix of an edge: a third and a sixth of its length.
            edge.stiffness += line.stiffness / 6.0;
            for end in line.ends {
                diagonal[end as usize] += line.stiffness / 3.0;
            }
        }
        self.vertex_areas = areas;
        self.diagonal = diagonal;
        self.set_drift_rest(sheet);
    }

    /// Replaces all line anchors, over the sheet's present rest metric.
    pub(crate) fn set_lines(
        &mut self,
        anchors: &[LineAnchor],
        sheet: &Sheet,
    ) -> Result<(), ShellError> {
        let line = |&anchor: &LineAnchor| {
            anchor.check()?;
            let index = anchor.edge.index();
            // Edges are listed as in the mesh.
            let edge = self.edges.get(index);
            let edge = edge.ok_or(ShellError::CreaseOutside { edge: index })?;
            Ok(LineSpring {
                anchor,
                edge: anchor.edge.0,
                ends: edge.ends,
                stiffness: 0.0,
            })
        };
        self.lines = anchors.iter().map(line).collect::<Result<_, _>>()?;
        self.set_rest(sheet);
        Ok(())
    }

    /// The ends of every edge.
    pub(crate) fn edge_stencils(&self) -> impl Iterator<Item = &[u32]> {
        self.edges.iter().map(|edge| edge.ends.as_slice())
    }

    /// The foundation in a part of the layer; values are to
    /// be taken over.
    pub(crate) fn part(&self, numbers: &PartNumbers, pattern: &BlockPattern) -> Self {
        let edge = |&number: &u32| {
            let whole = &self.edges[number as usize];
            let ends = whole.ends.map(|v| rank(&numbers.vertices, v));
            EdgeSprings {
                ends,
                sides: whole.sides.map(|side| side.map(FaceCorner::of_no_face)),
                slot: pattern.slot(ends[1], ends[0]),
                stiffness: 0.0,
                drift: 0.0,
            }
        };
        Self {
            normal: Vec::new(),
            tangential_springs: Vec::new(),
            vertex_areas: Vec::new(),
            diagonal: Vec::new(),
            edges: numbers.edges.iter().map(edge).collect(),
            anchors: Vec::new(),
            tangential: Vec::new(),
            drift_gradient: 0.0,
            drift_diagonal: Vec::new(),
            lines: Vec::new(),
        }
    }

    /// Takes over the values of the whole that this is a part of.
    pub(crate) fn follow(&mut self, whole: &Self, numbers: &PartNumbers) {
        let vertices = &numbers.vertices;
        pick(&mut self.normal, &whole.normal, &numbers.faces);
        pick(&mut self.vertex_areas, &whole.vertex_areas, vertices);
        pick(&mut self.diagonal, &whole.diagonal, vertices);
        if whole.drift_diagonal.is_empty() {
            self.drift_diagonal.clear();
        } else {
            pick(&mut self.drift_diagonal, &whole.drift_diagonal, vertices);
        }
        pick(&mut self.anchors, &whole.anchors, vertices);
        pick(&mut self.tangential, &whole.tangential, vertices);
        pick(
            &mut self.tangential_springs,
            &whole.tangential_springs,
            vertices,
        );
        let springs = self.tangential.iter_mut().zip(&mut self.tangential_springs);
        for ((stiffness, spring), &is_free) in springs.zip(&numbers.is_free) {
            // The spring of a vertex that stands still is a stencil that no free vertex touches.
            if !is_free {
                (*stiffness, spring.stiffness) = (0.0, 0.0);
            }
        }
        for (edge, &number) in self.edges.iter_mut().zip(&numbers.edges) {
            let of_whole = &whole.edges[number as usize];
            edge.stiffness = of_whole.stiffness;
            edge.drift = of_whole.drift;
        }
        self.drift_gradient = whole.drift_gradient;
        let edges = &self.edges;
        let line = |whole: &LineSpring| {
            let edge = numbers.edges.binary_search(&whole.edge).ok()?;
            Some(LineSpring {
                edge: edge as u32,
                ends: edges[edge].ends,
                ..*whole
            })
        };
        self.lines = whole.lines.iter().filter_map(line).collect();
    }

    pub(crate) fn set_anchors(&mut self, anchors: Vec<Anchor>) {
        self.anchors = anchors;
    }

    pub(crate) fn vertex_areas(&self) -> &[f64] {
        &self.vertex_areas
    }

    pub(crate) fn anchors(&self) -> &[Anchor] {
        &self.anchors
    }

    /// Anchors with the present normals at other points.
    pub(crate) fn anchors_at(&self, points: &[Vector3<f64>]) -> Vec<Anchor> {
        assert_eq!(points.len(), self.anchors.len(), "one point per vertex");
        let anchors = self.anchors.iter().zip(points);
        let moved = anchors.map(|(anchor, &point)| Anchor { point, ..*anchor });
        moved.collect()
    }

    pub(crate) fn stiffness(&self) -> FoundationStiffness {
        let of_vertex = |(i, m): (u32, &f64)| vec![(i, *m)];
        let mut rows: Vec<_> = (0..).zip(&self.diagonal).map(of_vertex).collect();
        for edge in &self.edges {
            let [i, j] = edge.ends;
            rows[i as usize].push((j, edge.stiffness));
            rows[j as usize].push((i, edge.stiffness));
        }
        let mut normal = SparseRows::default();
        rows.iter_mut().for_each(|row| normal.push_row(row));
        FoundationStiffness {
            normal,
            tangential: self
                .tangential_springs
                .iter()
                .map(|spring| spring.stiffness)
                .collect(),
        }
    }

    /// Energies of the `K0` and `K1` terms, of the `Kt` and `Kg` terms together, and of the line anchors (J).
    pub(crate) fn values(
        &self,
        faces: &[[u32; 3]],
        anchors: &[Anchor],
        x: &[Vector3<f64>],
    ) -> [f64; 4] {
        // Each vertex has its own normal, and scalars are what is differentiated. On a curved base
        // the gradient of the vector from the base would bring in the turning of the normal times
        // the drift.
        let w = deviations(anchors, x);
        let (mut normal, mut gradient) = (0.0, 0.0);
        for (face, stencil) in faces.iter().zip(&self.normal) {
            let [k0, k1] = stencil.values(face.map(|v| w[v as usize]));
            normal += k0;
            gradient += k1;
        }
        let tangential: f64 = self
            .tangential_springs
            .iter()
            .zip(anchors)
            .zip(x)
            .map(|((spring, anchor), x)| spring.value(anchor, x))
            .sum();
        let tangential = tangential + self.drift_value(anchors, x);
        let lines = self.lines.iter().map(|line| line.value(&w));
        [normal, gradient, tangential, lines.sum()]
    }

    /// Adds the energies (J) to the faces of the `sheet`; that of a vertex's tangential spring by their area.
    pub(crate) fn add_to_faces(
        &self,
        sheet: &Sheet,
        anchors: &[Anchor],
        x: &[Vector3<f64>],
        parts: &mut [EnergyParts],
    ) {
        let w = deviations(anchors, x);
        let areas = sheet.rest().iter().zip(sheet.area_left());
        let areas = areas.map(|(rest, left)| left * rest.area());
        let faces = sheet.faces().iter().zip(areas).zip(&self.normal);
        for (((face, area), stencil), parts) in faces.zip(&mut *parts) {
            let [k0, k1] = stencil.values(face.map(|v| w[v as usize]));
            parts.normal += k0;
            parts.gradient += k1;
            for v in face.map(|v| v as usize) {
                // A vertex has a third of the area of each of its faces.
                let share = area / 3.0 / self.vertex_areas[v];
                parts.tangential += share * self.tangential_springs[v].value(&anchors[v], &x[v]);
            }
        }
        self.add_drifts_to_faces(sheet, anchors, x, parts);
    }

    /// Forces of the springs on every vertex, against them: the derivative of the energy by `x` (N).
    pub(crate) fn forces(
        &self,
        faces: &[[u32; 3]],
        anchors: &[Anchor],
        x: &[Vector3<f64>],
    ) -> Vec<Vector3<f64>> {
        let w = deviations(anchors, x);
        // Faces add scalars, and a vertex makes one force of their sum: the normal is the vertex's.
        let mut by_deviation = vec![0.0; w.len()];
        for (face, stencil) in faces.iter().zip(&self.normal) {
            let force = stencil.gradient(face.map(|v| w[v as usize]));
            for (&vertex, force) in face.iter().zip(force) {
                by_deviation[vertex as usize] += force;
            }
        }
        for line in &self.lines {
            for (end, force) in line.ends.iter().zip(line.forces(&w)) {
                by_deviation[*end as usize] += force;
            }
        }
        let vertices = anchors
            .iter()
            .zip(&self.tangential_springs)
            .zip(x)
            .zip(by_deviation);
        let mut forces: Vec<_> = vertices
            .map(|(((anchor, spring), x), force)| {
                anchor.normal * force + spring.gradient(anchor, x)
            })
            .collect();
        self.add_drift_forces(anchors, x, &mut forces);
        forces
    }

    /// Adds the second derivative, which is constant as long as the base stands still, in the order of `pattern`.
    pub(crate) fn add_hessian(&self, pattern: &BlockPattern, values: &mut [f64]) {
        let vertices = (0..)
            .zip(&self.anchors)
            .zip(&self.diagonal)
            .zip(&self.tangential_springs);
        for (((vertex, anchor), stiffness), spring) in vertices {
            let n = anchor.normal;
            let block = n * n.transpose() * *stiffness
                + spring.hessian(anchor)
                + self.drift_block(vertex as usize);
            pattern.slot(vertex, vertex).add(values, &block);
        }
        for edge in &self.edges {
            let [tail, head] = edge.ends.map(|v| self.anchors[v as usize].normal);
            // Rows are the head's and columns the tail's, as the slot was asked for; with two
            // normals the block is not symmetric.
            let block = head * tail.transpose() * edge.stiffness + self.drift_edge_block(edge);
            edge.slot.add(values, &block);
        }
    }
}

impl EdgeSprings {
    /// Length (m) among these rest triangles, the mean of what its sides say.
    fn length(&self, rest: &[RestTriangle]) -> f64 {
        let sides = self.sides.iter().flatten().map(|side| side.pair());
        let lengths = sides.map(|(face, corner)| rest[face.index()].seen_from_edge(corner).0);
        lengths.sum::<f64>() / self.sides.iter().flatten().count() as f64
    }
}

impl LineSpring {
    /// Heights of the ends over where the anchor would have them (m).
    fn excess(&self, w: &[f64]) -> [f64; 2] {
        [0, 1].map(|i| w[self.ends[i] as usize] + self.anchor.depths[i])
    }

    fn value(&self, w: &[f64]) -> f64 {
        line_spring_energy(self.stiffness, self.excess(w))
    }

    /// Derivative of the energy by the deviations of the ends (N).
    fn forces(&self, w: &[f64]) -> [f64; 2] {
        line_spring_pulls(self.stiffness, self.excess(w))
    }
}

/// Heights over the surface below (m).
pub(crate) fn deviations(anchors: &[Anchor], x: &[Vector3<f64>]) -> Vec<f64> {
    let pairs = anchors.iter().zip(x);
    pairs.map(|(anchor, x)| anchor.deviation(x)).collect()
}

/// Base points, normals and offsets as anchors, checked.
pub(crate) fn anchors(
    points: &[Vector3<f64>],
    normals: &[Vector3<f64>],
    offsets: &[f64],
    vertices: usize,
) -> Result<Vec<Anchor>, ShellError> {
    check_length("base points", vertices, points.len())?;
    check_length("base normals", vertices, normals.len())?;
    check_length("base offsets", vertices, offsets.len())?;
    // Points before all else: normals that a caller computed from them are worthless all around one
    // that is not finite, and would be blamed for it, at another vertex.
    check_finite("base point", points.iter().flatten(), 3)?;
    check_finite("base normal", normals.iter().flatten(), 3)?;
    check_finite("base offset", offsets.iter(), 1)?;
    (0..vertices)
        .map(|vertex| {
            let (normal, offset) = (normals[vertex], offsets[vertex]);
            let point = points[vertex] + normal * offset;
            if !point.iter().all(|c| c.is_finite()) {
                let what = "base point with offset";
                return Err(ShellError::NotFinite { what, vertex });
            }
            let length = normal.norm();
            // Single precision rounds to 1e-7; what is off by more was never normalised.
            if (length - 1.0).abs() > UNIT_TOLERANCE {
                return Err(ShellError::NormalNotUnit { vertex, length });
            }
            Ok(Anchor {
                point,
                // Within the tolerance, too, a length other than one would scale the stiffness.
                normal: normal / length,
            })
        })
        .collect()
}
