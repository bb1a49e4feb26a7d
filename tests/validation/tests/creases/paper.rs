//! A ring of paper folded along its middle: the curved crease bends as geometry says.

use nalgebra::Vector3;
use ruga_mesh::EdgeId;
use ruga_shell::{HINGE_EXPONENT, Hinge, HingeShape, RestTriangle};
use ruga_validation::{FoldedPaper, edges_within};

/// Angle of the sector, rad, and half of its width, in radii of its middle.
const SECTOR: f64 = 100.0 * std::f64::consts::PI / 180.0;
const HALF_WIDTH: f64 = 0.2;

/// Rows of triangles from the middle to either border.
const ROWS: usize = 8;

/// A sector of a ring of unit radius with a crease along its middle.
struct Ring {
    paper: FoldedPaper,
    line: Vec<EdgeId>,
    /// Vertices of the middle, along it.
    middle: Vec<usize>,
}

impl Ring {
    fn new(thickness: f64) -> Self {
        let (paper, middle) = FoldedPaper::ring(SECTOR, HALF_WIDTH, ROWS, thickness);
        Self {
            line: edges_within(&paper.mesh, |v| middle.contains(&v)),
            paper,
            middle: middle.map(|v| v as usize).collect(),
        }
    }

    /// Folds the crease to a rest angle.
    fn fold(&mut self, degrees: f64) {
        let folds: Vec<_> = self
            .line
            .iter()
            .map(|&edge| (edge, degrees.to_radians()))
            .collect();
        let report = self.paper.fold(&folds);
        assert!(report.converged, "{degrees}: {report:?}");
    }

    /// Share of the edges on the crease in the energy of plain hinges on all edges.
    fn share_of_crease(&self) -> f64 {
        let x = self.paper.sheet.positions();
        let corners = self.paper.mesh.faces().as_slice().iter().enumerate();
        let rest = corners.map(|(i, face)| {
            let corners = face.map(|v| self.paper.rest[v.0 as usize]);
            RestTriangle::new(&corners, i).expect("a proper triangle")
        });
        let rest: Vec<_> = rest.collect();
        let (mut on, mut all) = (0.0, 0.0);
        for (id, edge) in self.paper.mesh.edges().iter() {
            let sides = self.paper.mesh.edge_sides(id);
            let ([Some((left, tail)), Some((right, head))], [Some(c), Some(d)]) =
                (sides, edge.apexes)
            else {
                continue;
            };
            let [left, right] = [left, right].map(|face| &rest[face.0 as usize]);
            let shape = HingeShape::new(left, tail, right, head);
            let [a, b] = edge.vertices;
            let points = [a, b, c, d].map(|v| x[v.0 as usize]);
            let hinge = Hinge {
                stiffness: shape.stiffness(self.paper.modulus, HINGE_EXPONENT),
                rest_angle: 0.0,
            };
            let energy = hinge.value(&points);
            all += energy;
            if self.line.contains(&id) {
                on += energy;
            }
        }
        on / all
    }

    /// Fold angle in the middle of the arc, rad.
    fn angle(&self) -> f64 {
        let states = self.paper.sheet.crease_states();
        let near = &states[states.len() / 2 - 2..states.len() / 2 + 2];
        near.iter().map(|state| state.angle).sum::<f64>() / near.len() as f64
    }

    /// Curvature of the middle of the arc, from the circle through three of its points.
    fn curvature(&self) -> f64 {
        let x = self.paper.sheet.positions();
        let (centre, reach) = (self.middle.len() / 2, self.middle.len() / 24);
        let [a, b, c] = [centre - reach, centre, centre + reach].map(|i| x[self.middle[i]]);
        2.0 * (b - a).cross(&(c - b)).norm() / ((b - a).norm() * (c - b).norm() * (c - a).norm())
    }

    /// Normal curvature of a flank across its rulings, in a row of vertices beside the crease, over that of the
    /// developable surface which folds along the crease as curved as it is: `κ sin(γ/2)/(1 + d)` at a distance `d`, for
    /// a crease that is part of a unit circle while it is flat.
    fn ruling_curvature(&self, row: isize) -> f64 {
        let x = self.paper.sheet.positions();
        let from_middle = |p: &Vector3<f64>| p.norm() - 1.0;
        let distance = HALF_WIDTH * row as f64 / ROWS as f64;
        let rest = &self.paper.rest;
        let own = (0..rest.len()).filter(|&v| (from_middle(&rest[v]) - distance).abs() < 1e-9);
        let mut own: Vec<usize> = own.collect();
        own.sort_by(|a, b| rest[*a].x.total_cmp(&rest[*b].x));
        let (centre, reach) = (own.len() / 2, own.len() / 24);
        let [a, b, c] = [centre - reach, centre, centre + reach].map(|i| x[own[i]]);
        let (ab, bc, ac) = (b - a, c - b, c - a);
        // Towards the centre of the circle through the three, as long as it is curved.
        let inwards = (bc / bc.norm() - ab / ab.norm()).normalize();
        let towards = inwards * (2.0 * ab.cross(&bc).norm() / (ab.norm() * bc.norm() * ac.norm()));
        let chord = ac.normalize();
        let nearest = self.middle.iter().map(|&v| x[v]);
        let nearest = nearest.min_by(|p, q| (p - b).norm().total_cmp(&(q - b).norm()));
        let along_ruling = (b - nearest.expect("a crease")).normalize();
        let normal = chord.cross(&along_ruling).normalize();
        let at_crease = self.curvature() * (0.5 * self.angle()).sin();
        towards.dot(&normal).abs() * (1.0 + distance) / at_crease
    }

    /// Largest distance of the crease from its mean plane.
    fn off_plane(&self) -> f64 {
        let x = self.paper.sheet.positions();
        let points: Vec<_> = self.middle.iter().map(|&v| x[v]).collect();
        let mean = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
        let spread = points.iter().map(|p| (p - mean) * (p - mean).transpose());
        let spread: nalgebra::Matrix3<f64> = spread.sum();
        let axes = spread.symmetric_eigen();
        let normal = axes
            .eigenvectors
            .column(axes.eigenvalues.imin())
            .into_owned();
        points
            .iter()
            .map(|p| (p - mean).dot(&normal).abs())
            .fold(0.0, f64::max)
    }
}

#[test]
fn a_curved_fold_bends_as_its_geodesic_curvature_says() {
    for degrees in [46.0, 92.0] {
        let mut off_by = Vec::new();
        for thickness in [0.004, 0.002] {
            let mut ring = Ring::new(thickness);
            ring.fold(degrees);
            let (angle, curvature) = (ring.angle(), ring.curvature());
            let parts = ring.paper.sheet.parts();
            let membrane = parts.membrane / parts.total();
            let (off, share) = (ring.off_plane(), ring.share_of_crease());
            let geodesic = curvature * (0.5 * angle).cos();
            let case = format!("{degrees} degrees, {thickness} thick");
            let rulings = [-6, -4, 4, 6].map(|row| ring.ruling_curvature(row));
            println!("{case}: curvature across rulings, over theory's: {rulings:.4?}");
            // Measured: 0.7 to 1.0 % in the mean of both flanks, and 1.8 % at most in a row of the thicker paper.
            let mean = rulings.iter().sum::<f64>() / rulings.len() as f64;
            assert!((mean - 1.0).abs() < 0.01, "{case}: {rulings:?}");
            assert!(
                rulings.iter().all(|r| (r - 1.0).abs() < 0.02),
                "{case}: {rulings:?}"
            );
            println!(
                "{case}: {geodesic:.4}, off its plane {off:.4}, membrane {membrane:.3}, crease {share:.3}"
            );
            assert!(off < 0.001, "{case}: {off}");
            assert!(membrane < 0.025, "{case}: {membrane}");
            assert!(share > 0.98, "{case}: {share}");
            off_by.push((geodesic - 1.0).abs());
        }
        // Geometry speaks of paper without thickness. In a layer beside the fold, as wide as the root of the
        // thickness, it bends back a little, so that the angle at the line is not that from side to side. Measured:
        // 0.17 and 0.13 % at 46 degrees, 1.06 and 0.79 % at 91; meshes twice as fine change the second decimal.
        let [thick, thin] = off_by[..] else {
            unreachable!("two thicknesses")
        };
        assert!(thin < 0.01, "{degrees}: {thin}");
        assert!(thin < 0.85 * thick, "{degrees}: {thin} of {thick}");
    }
}
