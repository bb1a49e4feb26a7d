//! A skin pressed onto a ridge whose angle varies along its line: what crease elements can follow.
//!
//! ```text
//! u = s t d/2      t in [0, 1]: way along the line;  d: distance from it;  s: angle at its end
//! ```
//! The line gives way without a moment. Stiffness on the gradient of the distance from the ridge holds the
//! skin, so that it settles at what its elements can do best in the energy norm. Bending and stretching are
//! too weak to matter.

use nalgebra::{Vector2, Vector3};
use ruga_crease::TracedLine;
use ruga_mesh::{Id, TriMesh, mean_edge_lengths};
use ruga_shell::{BendingModel, Crease, FaceParameters, FoldSense, LayerParameters};
use ruga_solver::{FactorCost, NewtonSettings, SolveReport};

use crate::virtual_nodes::{LineEnds, VirtualNodes};
use crate::{DrawnSheet, Sheet, SheetSpec, cpu_seconds, feature_edges, unit_film};

/// Ends of the line, on two sides of the unit square.
const ENDS: [[f64; 2]; 2] = [[0.0, 0.413], [1.0, 0.577]];

/// Angle at the end of the line: small, so that slopes are angles.
const SLOPE: f64 = 0.02;

/// Elements that fold a skin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoldElement {
    /// None: the skin bends between the vertices that there are.
    Plain,
    /// The paper's: cut with virtual nodes, and sewn.
    VirtualNodes,
    /// The product's: edges on the line, and a crease on each.
    CreaseEdges,
}

/// How well a skin follows the ridge.
#[derive(Clone, Copy, Debug)]
pub struct FoldError {
    /// Edges along a side of the square.
    pub edges: usize,
    /// Triangles.
    pub faces: usize,
    /// Root of the energy of the error over that of the ridge.
    pub error: f64,
    /// Processor seconds of setting up and solving, meshing left out.
    pub seconds: f64,
    /// Cost of one factorisation.
    pub cost: FactorCost,
    /// Whether the solver converged.
    pub converged: bool,
}

/// A skin in the plane: a mesh, whole triangles with their material, and the side of the line that each is on.
struct Skin {
    mesh: TriMesh,
    rest: Vec<Vector3<f64>>,
    /// Material by barycentric coordinates, and its share.
    material: Vec<(Vec<[f64; 3]>, f64)>,
    /// Side of every node: 1 or -1.
    sides: Vec<f64>,
    ties: Vec<Vec<(u32, f64)>>,
    creases: Vec<(ruga_mesh::EdgeId, Crease)>,
}

/// Presses a skin of `edges` along a side onto the ridge.
///
/// # Panics
/// When the product refuses the skin.
pub fn fold_error(element: FoldElement, edges: usize) -> FoldError {
    let skin = Skin::new(element, edges);
    let start = cpu_seconds();
    let (sheet, report) = skin.pressed();
    FoldError {
        edges,
        faces: skin.mesh.face_count(),
        error: skin.error(sheet.positions()),
        seconds: cpu_seconds() - start,
        cost: sheet.factor_cost(),
        converged: report.converged,
    }
}

/// The paper's skin before it is pressed: its sheet on the ridge, its cut, and where its vertices are at rest.
///
/// # Panics
/// When the product refuses the skin.
pub fn sewn_ridge(edges: usize) -> (Sheet, VirtualNodes, Vec<Vector3<f64>>) {
    let drawn = unit_square(edges);
    let cut = VirtualNodes::cut(&drawn.mesh, &[line(&drawn)], LineEnds::AtVertices);
    let sheet = Skin::sewn(&drawn, &cut).laid();
    (sheet, cut, drawn.positions)
}

/// A unit square of so many squares along a side.
pub fn unit_square(edges: usize) -> DrawnSheet {
    let mut drawn = DrawnSheet::new(edges, 3);
    for x in &mut drawn.positions {
        *x /= edges as f64;
    }
    drawn
}

/// The ridge's line over a unit square.
pub fn line(drawn: &DrawnSheet) -> TracedLine {
    drawn.trace(ENDS.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec())
}

/// Way along the line, in its lengths, and signed distance from it.
fn coordinates(at: &Vector3<f64>) -> [f64; 2] {
    let [a, b] = ENDS.map(Vector2::from);
    let (along, from) = (b - a, at.xy() - a);
    let length = along.norm();
    [
        along.dot(&from) / (length * length),
        along.perp(&from) / length,
    ]
}

/// Height of one side of the ridge, which goes on beyond the line.
fn height(at: &Vector3<f64>, side: f64) -> f64 {
    let [along, off] = coordinates(at);
    0.5 * SLOPE * side * along * off
}

/// Slope of one side of the ridge.
fn slope(at: &Vector3<f64>, side: f64) -> Vector2<f64> {
    let [along, off] = coordinates(at);
    let [a, b] = ENDS.map(Vector2::from);
    let length = (b - a).norm();
    let direction = (b - a) / length;
    let across = Vector2::new(-direction.y, direction.x);
    (direction * (off / length) + across * along) * (0.5 * SLOPE * side)
}

fn side_of(at: &Vector3<f64>) -> f64 {
    coordinates(at)[1].signum()
}

impl Skin {
    fn new(element: FoldElement, edges: usize) -> Self {
        let drawn = unit_square(edges);
        let line = line(&drawn);
        match element {
            FoldElement::VirtualNodes => {
                let cut = VirtualNodes::cut(&drawn.mesh, &[line], LineEnds::AtVertices);
                Self::sewn(&drawn, &cut)
            }
            FoldElement::Plain => {
                let mesh = drawn.mesh.clone();
                Self::whole(mesh, drawn.positions, Vec::new())
            }
            FoldElement::CreaseEdges => {
                let mean = mean_edge_lengths(&drawn.mesh, &drawn.positions);
                let edge = mean.iter().sum::<f64>() / mean.len() as f64;
                let made = drawn.fitted(&[line], edge, 1).pop().expect("one mesh");
                let free = Crease {
                    compliance: f64::MAX,
                    rest_angle: 0.0,
                    sense: FoldSense::Both,
                };
                let creases = feature_edges(&made).into_iter().map(|edge| (edge, free));
                let creases = creases.collect();
                Self::whole(made.mesh, made.positions.as_slice().to_vec(), creases)
            }
        }
    }

    fn whole(
        mesh: TriMesh,
        rest: Vec<Vector3<f64>>,
        creases: Vec<(ruga_mesh::EdgeId, Crease)>,
    ) -> Self {
        let all = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Self {
            material: vec![(all, 1.0); mesh.face_count()],
            sides: rest.iter().map(side_of).collect(),
            ties: Vec::new(),
            creases,
            mesh,
            rest,
        }
    }

    fn sewn(drawn: &DrawnSheet, cut: &VirtualNodes) -> Self {
        let rest = cut.spread(&drawn.positions);
        let mut sides: Vec<f64> = rest.iter().map(side_of).collect();
        // A copy belongs to the other side.
        for [_, copy] in cut.pairs() {
            sides[copy as usize] *= -1.0;
        }
        let faces = cut.faces.iter();
        Self {
            material: faces.map(|own| (own.material.clone(), own.share)).collect(),
            sides,
            ties: cut.rows.clone(),
            creases: Vec::new(),
            mesh: cut.mesh(),
            rest,
        }
    }

    /// The skin on the ridge, before it settles.
    fn laid(&self) -> Sheet {
        let thickness = 1e-3;
        let faces = self.material.iter().map(|(_, share)| FaceParameters {
            // A tenth of the foundation's stiffness on gradients.
            young: 0.1 / thickness * share,
            poisson: 0.0,
            thickness,
            normal_stiffness: *share,
            gradient_stiffness: *share,
        });
        let parameters = LayerParameters {
            faces: faces.collect(),
            tangential_stiffness: vec![1.0; self.rest.len()],
        };
        let (mut theory, _) = unit_film(0.05);
        theory.normal_stiffness = 1.0;
        theory.membrane_stiffness = 1.0;
        // The energy scale is that of the ridge.
        theory.critical_strain = SLOPE;
        let faces = self.mesh.faces().as_slice().iter();
        let faces = faces.map(|face| face.map(|v| v.0)).collect();
        let free = vec![false; self.rest.len()];
        let mut spec = SheetSpec::bare(
            (theory, thickness),
            (self.rest.clone(), faces),
            parameters,
            free,
        );
        spec.bending = BendingModel::VertexCurvature;
        spec.ties.clone_from(&self.ties);
        let mut sheet = Sheet::new(spec);
        sheet.crease(&self.creases, &[]);
        let base = self.rest.iter().zip(&self.sides);
        let base = base.map(|(at, &side)| Vector3::new(at.x, at.y, height(at, side)));
        sheet.lay_on(base.collect(), &vec![Vector3::z(); self.rest.len()]);
        sheet
    }

    fn pressed(&self) -> (Sheet, SolveReport) {
        let mut sheet = self.laid();
        let settings = NewtonSettings {
            energy_tolerance: 1e-8,
            ..NewtonSettings::default()
        };
        let report = sheet.solve(&settings);
        (sheet, report)
    }

    /// Root of the integral of the square of the error of the slope, over that of the slope.
    fn error(&self, positions: &[Vector3<f64>]) -> f64 {
        let (mut error, mut all) = (0.0, 0.0);
        for (face, (material, _)) in self.mesh.faces().as_slice().iter().zip(&self.material) {
            let rest = face.map(|v| self.rest[v.index()]);
            let found = gradient(&rest, face.map(|v| positions[v.index()].z));
            let at =
                |share: &[f64; 3]| rest[0] * share[0] + rest[1] * share[1] + rest[2] * share[2];
            let places: Vec<_> = material.iter().map(at).collect();
            let [a, b, c] = rest;
            let is_sewn = !self.ties.is_empty();
            // What a whole triangle has on either side of the line counts by itself.
            for side in [1.0, -1.0] {
                let polygon = match is_sewn {
                    true if own_side(&places) != side => continue,
                    true => places.clone(),
                    false => clipped(&[a, b, c], side),
                };
                for (p, weight) in midpoints(&polygon) {
                    let exact = slope(&p, side);
                    error += weight * (found - exact).norm_squared();
                    all += weight * exact.norm_squared();
                }
            }
        }
        (error / all).sqrt()
    }
}

/// The side of the line on which material lies.
fn own_side(polygon: &[Vector3<f64>]) -> f64 {
    let sum: f64 = polygon.iter().map(|p| coordinates(p)[1]).sum();
    sum.signum()
}

/// Slope of a plane over a triangle with these heights.
fn gradient([a, b, c]: &[Vector3<f64>; 3], heights: [f64; 3]) -> Vector2<f64> {
    let (u, v) = ((b - a).xy(), (c - a).xy());
    let [du, dv] = [heights[1] - heights[0], heights[2] - heights[0]];
    Vector2::new(du * v.y - dv * u.y, dv * u.x - du * v.x) / u.perp(&v)
}

/// The part of a triangle on one side of the line.
fn clipped(corners: &[Vector3<f64>; 3], side: f64) -> Vec<Vector3<f64>> {
    let mut polygon = Vec::new();
    for i in 0..3 {
        let (p, q) = (corners[i], corners[(i + 1) % 3]);
        let [a, b] = [p, q].map(|p| side * coordinates(&p)[1]);
        if a >= 0.0 {
            polygon.push(p);
        }
        if a * b < 0.0 {
            polygon.push(p + (q - p) * (a / (a - b)));
        }
    }
    polygon
}

/// Points and weights that integrate squares over a polygon exactly.
fn midpoints(polygon: &[Vector3<f64>]) -> Vec<(Vector3<f64>, f64)> {
    let mut points = Vec::new();
    for pair in polygon.get(1..).unwrap_or_default().windows(2) {
        let [a, b, c] = [polygon[0], pair[0], pair[1]];
        let weight = (b - a).xy().perp(&(c - a).xy()).abs() / 6.0;
        points.extend([(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5].map(|p| (p, weight)));
    }
    points
}
