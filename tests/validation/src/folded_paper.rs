//! Paper of unit size with creases that fold it.

use nalgebra::Vector3;
use ruga_mesh::{EdgeId, TriMesh};
use ruga_shell::{Crease, FaceParameters, FoldSense, LayerParameters};
use ruga_solver::{NewtonSettings, SolveReport};

use crate::{Sheet, SheetSpec, unit_film};

/// Young's modulus (Pa) and Poisson's ratio.
const YOUNG: f64 = 1e9;
const POISSON: f64 = 0.3;

/// Stiffness of a crease, in bending moduli of the paper over its unit of length.
const CREASE: f64 = 20.0;

/// Steps in which a fold is made.
const STEPS: u32 = 6;

/// Flat paper of which one face is held, with creases along edges.
pub struct FoldedPaper {
    /// The paper and its state.
    pub sheet: Sheet,
    /// Its mesh.
    pub mesh: TriMesh,
    /// Where its vertices are when it is flat.
    pub rest: Vec<Vector3<f64>>,
    /// Bending modulus (N m).
    pub modulus: f64,
}

impl FoldedPaper {
    /// Thickness of the paper in pictures.
    pub const THICKNESS: f64 = 0.004;

    /// Lays paper of a thickness flat and holds its face number `held`.
    ///
    /// # Panics
    /// When the faces are no mesh.
    pub fn new(rest: Vec<Vector3<f64>>, faces: Vec<[u32; 3]>, held: usize, thickness: f64) -> Self {
        let face = FaceParameters {
            young: YOUNG,
            poisson: POISSON,
            thickness,
            normal_stiffness: 0.0,
            gradient_stiffness: 0.0,
        };
        let modulus = face.bending_modulus();
        let (mut theory, _) = unit_film(0.05);
        theory.bending_stiffness = modulus;
        theory.membrane_stiffness = face.tension_modulus();
        // Scales for the solver: bent by a radian over the width.
        theory.critical_strain = 0.01;
        theory.normal_stiffness = modulus;
        let parameters = LayerParameters::uniform(face, faces.len(), 0.0, rest.len());
        // Against rigid motion.
        let held = faces[held];
        let pinned = (0..rest.len() as u32).map(|v| held.contains(&v)).collect();
        let mesh = TriMesh::new(rest.len(), faces.clone()).expect("a valid mesh");
        let spec = SheetSpec::bare(
            (theory, thickness),
            (rest.clone(), faces),
            parameters,
            pinned,
        );
        Self {
            sheet: Sheet::new(spec),
            mesh,
            rest,
            modulus,
        }
    }

    /// Folds the paper in steps: edges, and the rest angles of their creases (rad), positive in a valley.
    ///
    /// # Panics
    /// When the layer refuses the creases.
    pub fn fold(&mut self, folds: &[(EdgeId, f64)]) -> SolveReport {
        let mut report = None;
        for step in 1..=STEPS {
            let share = f64::from(step) / f64::from(STEPS);
            let crease = |angle: f64| Crease {
                compliance: 1.0 / (CREASE * self.modulus),
                rest_angle: angle * share,
                sense: FoldSense::Both,
            };
            let creases: Vec<_> = folds
                .iter()
                .map(|&(edge, angle)| (edge, crease(angle)))
                .collect();
            self.sheet.crease(&creases, &[]);
            // Paper slides into its curve in steps of a hundred iterations: a membrane that is a million times
            // as stiff as bending.
            let settings = NewtonSettings {
                energy_tolerance: 1e-8,
                max_iterations: 400,
                ..NewtonSettings::default()
            };
            let last = self.sheet.solve(&settings);
            let is_done = !last.converged;
            report = Some(last);
            if is_done {
                break;
            }
        }
        report.expect("there is a step")
    }

    /// A sector of a ring of unit radius, as wide as twice `half_width`, in `rows` of triangles to either side of
    /// its middle; and the vertices of the middle, along it.
    ///
    /// # Panics
    /// Without rows.
    pub fn ring(
        angle: f64,
        half_width: f64,
        rows: usize,
        thickness: f64,
    ) -> (Self, std::ops::Range<u32>) {
        let row = half_width / rows as f64;
        // Even rows have one vertex more than odd ones, which begin half a step later.
        let steps = (angle / (row / 0.75_f64.sqrt())).round() as usize;
        let (mut rest, mut arcs) = (Vec::new(), Vec::new());
        for j in 0..=2 * rows {
            let radius = 1.0 - half_width + j as f64 * row;
            let first = rest.len() as u32;
            let shift = if j % 2 == 0 { 0.0 } else { 0.5 };
            for i in 0..=steps + j % 2 {
                let share = ((i as f64 - shift) / steps as f64).clamp(0.0, 1.0);
                let (sin, cos) = (angle * (share - 0.5)).sin_cos();
                rest.push(Vector3::new(radius * sin, radius * cos, 0.0));
            }
            arcs.push(first..rest.len() as u32);
        }
        let faces = arcs.windows(2).flat_map(|pair| ladder(&pair[0], &pair[1]));
        let faces: Vec<_> = faces.collect();
        // At an end of the outer border.
        let held = faces.len() - 1;
        let paper = Self::new(rest, faces, held, thickness);
        (paper, arcs[rows].clone())
    }
}

/// Triangles between two rows of vertices, of which one has one more.
fn ladder(low: &std::ops::Range<u32>, high: &std::ops::Range<u32>) -> Vec<[u32; 3]> {
    let (longer, shorter, flip) = match low.len() > high.len() {
        true => (low, high, false),
        false => (high, low, true),
    };
    // Seen with the longer row below, counter-clockwise; radii grow upwards and arcs clockwise.
    let turn = |[a, b, c]: [u32; 3]| if flip { [a, b, c] } else { [a, c, b] };
    let mut faces = Vec::new();
    for i in 0..longer.len() as u32 - 1 {
        let (a, b) = (longer.start + i, longer.start + i + 1);
        if i > 0 {
            faces.push(turn([a, shorter.start + i, shorter.start + i - 1]));
        }
        faces.push(turn([a, b, shorter.start + i]));
    }
    faces
}

/// Inner edges whose two ends are both in a set of vertices.
pub fn edges_within(mesh: &TriMesh, is_in: impl Fn(u32) -> bool) -> Vec<EdgeId> {
    let edges = mesh.edges().iter();
    let inside =
        edges.filter(|(_, edge)| !edge.is_border() && edge.vertices.iter().all(|v| is_in(v.0)));
    inside.map(|(id, _)| id).collect()
}
