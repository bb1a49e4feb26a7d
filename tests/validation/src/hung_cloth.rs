//! A square cloth hung by two opposite corners, so that its upper half falls over, with a line from the one to the
//! other along which it folds (after figure 9 of Patkar, Jin and Fedkiw 2014).

use nalgebra::{Vector2, Vector3};
use ruga_crease::TracedLine;
use ruga_mesh::{Id, TriMesh};
use ruga_shell::{Crease, FaceParameters, FoldSense, LayerParameters};
use ruga_solver::NewtonSettings;

use crate::ridge::unit_square;
use crate::virtual_nodes::{LineEnds, SpringLaw, VirtualNodes};
use crate::{DrawnSheet, Sheet, SheetSpec, cpu_seconds, feature_edges, unit_film};

/// Tension (N/m) and thickness (m).
const TENSION: f64 = 120.0;
const THICKNESS: f64 = 0.01;
const POISSON: f64 = 0.3;

/// Weight per area, Pa, towards a corner between the two that it hangs by: the cloth bends by itself over a fifth of its
/// width.
const WEIGHT: Vector3<f64> = Vector3::new(-0.1, -0.1, 0.0);

/// Ends of the line: the corners by which the cloth is hung.
const ENDS: [[f64; 2]; 2] = [[0.0, 1.0], [1.0, 0.0]];

/// Distance from the corners at which the paper's line ends, from where it is extended to them: no line may go
/// through a vertex.
const INSET: f64 = 0.02;

/// Stiffness of the line over the bending modulus of the cloth, times 1 m.
const STIFFNESS: f64 = 4.0;

/// Angle by which the upper half is bent before it falls, rad.
const START: f64 = 1.0;

/// Squares along the side of the sheet to which meshes are fitted.
const DRAWN: usize = 8;

/// What folds a cloth along the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HungFold {
    /// Nothing.
    None,
    /// The product's creases.
    Crease,
    /// The paper's virtual nodes, which fold freely.
    VirtualNodes,
    /// The same with springs across the cut, as stiff as the creases as long as the fold is small.
    Springs,
}

/// A triangle in space, and where it is on the flat cloth.
pub type PlacedTriangle = ([Vector3<f64>; 3], [Vector2<f64>; 3]);

/// A cloth at rest under its weight.
pub struct HungCloth {
    /// Triangles of its material.
    pub triangles: Vec<PlacedTriangle>,
    /// Triangles that were computed.
    pub faces: usize,
    /// Processor seconds of setting up and solving, meshing left out.
    pub seconds: f64,
    /// Newton steps.
    pub iterations: usize,
    /// Whether the solver converged.
    pub converged: bool,
    /// Elastic energy and that of its weight, J.
    pub energy: f64,
    /// Mean fold angle of the line, degrees: that inside of creases, else from triangle to triangle.
    pub fold: f64,
}

/// Cloth that is to be hung: nodes and triangles with their material.
struct Cut {
    mesh: TriMesh,
    rest: Vec<Vector3<f64>>,
    /// Material by barycentric coordinates, and its share.
    material: Vec<(Vec<[f64; 3]>, f64)>,
    spec: SheetSpec,
    creases: Vec<(ruga_mesh::EdgeId, Crease)>,
}

/// Hangs a cloth of `edges` along a side.
///
/// # Panics
/// When the product refuses the cloth.
pub fn hang(fold: HungFold, edges: usize) -> HungCloth {
    // The paper's way cuts the mesh that there is; ours is fitted, to a sheet that need not be as fine.
    let is_sewn = matches!(fold, HungFold::VirtualNodes | HungFold::Springs);
    let drawn = unit_square(if is_sewn { edges } else { DRAWN });
    let [a, b] = ENDS.map(|[x, y]| Vector3::new(x, y, 0.0));
    let inset = if is_sewn {
        (b - a).normalize() * INSET
    } else {
        Vector3::zeros()
    };
    let line = drawn.trace(vec![a + inset, b - inset]);
    let cut = match fold {
        HungFold::None => Cut::fitted(&drawn, &[], edges),
        HungFold::Crease => Cut::fitted(&drawn, &[line], edges),
        HungFold::VirtualNodes => Cut::sewn(&drawn, &line, None),
        HungFold::Springs => Cut::sewn(&drawn, &line, Some(STIFFNESS)),
    };
    cut.hang()
}

fn face(share: f64) -> FaceParameters {
    FaceParameters {
        young: share * TENSION / THICKNESS,
        poisson: POISSON,
        thickness: THICKNESS,
        normal_stiffness: 0.0,
        gradient_stiffness: 0.0,
    }
}

impl Cut {
    /// Edges on the lines, and a crease on each.
    fn fitted(drawn: &DrawnSheet, lines: &[TracedLine], edges: usize) -> Self {
        let made = drawn.fitted(lines, 1.0 / edges as f64, 2);
        let made = made.last().expect("there are fits");
        let crease = Crease {
            compliance: 1.0 / (STIFFNESS * face(1.0).bending_modulus()),
            rest_angle: 0.0,
            sense: FoldSense::Both,
        };
        let creases = feature_edges(made).into_iter().map(|edge| (edge, crease));
        let whole = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let material = vec![(whole, 1.0); made.mesh.face_count()];
        let rest = made.positions.as_slice().to_vec();
        Self {
            creases: creases.collect(),
            spec: spec(&made.mesh, &rest, &material),
            mesh: made.mesh.clone(),
            rest,
            material,
        }
    }

    fn sewn(drawn: &DrawnSheet, line: &TracedLine, stiffness: Option<f64>) -> Self {
        let cut = VirtualNodes::cut(
            &drawn.mesh,
            std::slice::from_ref(line),
            LineEnds::AtVertices,
        );
        let faces = cut.faces.iter();
        let material: Vec<_> = faces.map(|own| (own.material.clone(), own.share)).collect();
        let (mesh, rest) = (cut.mesh(), cut.spread(&drawn.positions));
        let mut spec = spec(&mesh, &rest, &material);
        if let Some(stiffness) = stiffness {
            let law = SpringLaw::ByDistance(stiffness * face(1.0).bending_modulus());
            spec.links = cut.springs(&drawn.positions, law);
        }
        spec.ties = cut.rows;
        Self {
            mesh,
            rest,
            material,
            spec,
            creases: Vec::new(),
        }
    }

    fn hang(self) -> HungCloth {
        let start = cpu_seconds();
        let mut sheet = Sheet::new(self.spec.clone());
        sheet.crease(&self.creases, &[]);
        let normals = vec![Vector3::z(); self.rest.len()];
        // The upper half is bent to an arc, so that it falls to a side that is known.
        sheet.lay_on(self.rest.iter().map(bent).collect(), &normals);
        sheet.weigh(&self.weights());
        let settings = NewtonSettings {
            energy_tolerance: 1e-8,
            max_iterations: 400,
            ..NewtonSettings::default()
        };
        let report = sheet.solve(&settings);
        let seconds = cpu_seconds() - start;
        HungCloth {
            triangles: self.triangles(sheet.positions()),
            faces: self.mesh.face_count(),
            seconds,
            iterations: report.iterations,
            converged: report.converged,
            energy: sheet.loaded_energy(),
            fold: match sheet.crease_states().as_slice() {
                [] => self.angle(sheet.positions()),
                states => {
                    let angles = states.iter().map(|own| own.angle.abs());
                    (angles.sum::<f64>() / states.len() as f64).to_degrees()
                }
            },
        }
    }

    /// A third of every triangle's material at each corner, N.
    fn weights(&self) -> Vec<Vector3<f64>> {
        let mut weights = vec![Vector3::zeros(); self.rest.len()];
        let faces = self.mesh.faces().as_slice().iter();
        for (face, (_, share)) in faces.zip(&self.material) {
            let [a, b, c] = face.map(|v| self.rest[v.index()]);
            let third = WEIGHT * (share * (b - a).cross(&(c - a)).norm() / 6.0);
            for v in face {
                weights[v.index()] += third;
            }
        }
        weights
    }

    fn triangles(&self, positions: &[Vector3<f64>]) -> Vec<PlacedTriangle> {
        let mut all = Vec::new();
        let faces = self.mesh.faces().as_slice().iter();
        for (face, (polygon, _)) in faces.zip(&self.material) {
            let at = |places: &[Vector3<f64>], s: &[f64; 3]| {
                let corners = face.map(|v| places[v.index()]);
                corners[0] * s[0] + corners[1] * s[1] + corners[2] * s[2]
            };
            for pair in polygon[1..].windows(2) {
                let fan = [&polygon[0], &pair[0], &pair[1]];
                all.push((
                    fan.map(|s| at(positions, s)),
                    fan.map(|s| at(&self.rest, s).xy()),
                ));
            }
        }
        all
    }

    /// Mean angle between the triangles on either side of the line, degrees, at the middle of each of so many parts
    /// of it.
    fn angle(&self, positions: &[Vector3<f64>]) -> f64 {
        const PARTS: usize = 40;
        let [a, b] = ENDS.map(Vector2::from);
        let across = Vector2::new(a.y - b.y, b.x - a.x).normalize() * 1e-6;
        let triangles = self.triangles(positions);
        let normal = |at: Vector2<f64>| {
            let found = triangles.iter().find(|(_, flat)| {
                let inside = ruga_mesh::barycentric(*flat, at);
                inside.is_some_and(|shares| shares.iter().all(|s| *s >= -1e-9))
            });
            let ([p, q, r], _) = found?;
            (q - p).cross(&(r - p)).try_normalize(0.0)
        };
        let angle = |part: usize| {
            let at = a + (b - a) * ((part as f64 + 0.5) / PARTS as f64);
            let [one, other] = [normal(at - across)?, normal(at + across)?];
            Some(one.dot(&other).clamp(-1.0, 1.0).acos().to_degrees())
        };
        let angles: Vec<_> = (0..PARTS).filter_map(angle).collect();
        angles.iter().sum::<f64>() / angles.len() as f64
    }
}

fn spec(mesh: &TriMesh, rest: &[Vector3<f64>], material: &[(Vec<[f64; 3]>, f64)]) -> SheetSpec {
    let parameters = LayerParameters {
        faces: material.iter().map(|(_, share)| face(*share)).collect(),
        tangential_stiffness: vec![0.0; rest.len()],
    };
    let (mut theory, _) = unit_film(0.05);
    theory.bending_stiffness = face(1.0).bending_modulus();
    theory.membrane_stiffness = face(1.0).tension_modulus();
    // Scales for the solver: bent by a radian over the width.
    theory.normal_stiffness = theory.bending_stiffness;
    theory.critical_strain = 0.01;
    let is_held = |p: &Vector3<f64>| {
        let corners = ENDS.map(Vector2::from);
        corners.iter().any(|corner| (p.xy() - corner).norm() < 1e-9)
    };
    let pinned = rest.iter().map(is_held).collect();
    let faces = mesh.faces().as_slice().iter();
    let faces = faces.map(|face| face.map(|v| v.0)).collect();
    SheetSpec::bare(
        (theory, THICKNESS),
        (rest.to_vec(), faces),
        parameters,
        pinned,
    )
}

/// Where a point of the flat cloth is when its upper half is an arc that ends at an angle of [`START`].
fn bent(p: &Vector3<f64>) -> Vector3<f64> {
    let up = Vector3::new(1.0, 1.0, 0.0).normalize();
    let middle = Vector3::new(0.5, 0.5, 0.0);
    let height = (p - middle).dot(&up);
    if height <= 0.0 {
        return *p;
    }
    let curvature = START / 0.5_f64.sqrt();
    let (sin, cos) = (curvature * height).sin_cos();
    p + up * (sin / curvature - height) + Vector3::z() * ((1.0 - cos) / curvature)
}
