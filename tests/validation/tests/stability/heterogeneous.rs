//! T14: a film that becomes ten times as thick within one triangle.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use ruga_constraint::{ClusterSettings, Kernel, Sampling, cluster_centres, constraint_rows};
use ruga_material::{PropertyImage, PropertyMap, Wrap};
use ruga_mesh::{MaterialPoint, PerVertex, VertexId, vertex_normals};
use ruga_remesh::{RemeshSettings, Sizing, SurfaceMesh, remesh};
use ruga_shell::LayerParameters;
use ruga_stepper::LayerSpec;
use ruga_validation::{
    FilmCoupling, FilmSpec, Finding, Patch, Rectangle, Sheet, SheetSpec, Strip, table_line,
};

use crate::{compress, draft, exact, patch, planned, simulated, skin};

const TEST: &str = "T14 thickness times 10 in one triangle";

const RATIO: f64 = 10.0;

/// The film, thick for the first waves of its length and thin for the rest.
struct Stepped {
    /// Thick and thin.
    specs: [FilmSpec; 2],
    rectangle: Rectangle,
    /// Where it steps, m.
    border: f64,
}

impl Stepped {
    /// `waves` thick ones long, of which `thin` have the thin film, and `width` of them wide.
    fn new(waves: f64, thin: f64, width: f64) -> Self {
        let thick_spec = FilmSpec {
            coupling: FilmCoupling::Elastic,
            ..FilmSpec::flat(150.0)
        };
        let mut thin_spec = thick_spec;
        thin_spec.film.thickness /= RATIO;
        let wavelength = thick_spec.theory().wavelength;
        Self {
            specs: [thick_spec, thin_spec],
            rectangle: Rectangle {
                length: waves * wavelength,
                width: width * wavelength,
                radius: None,
            },
            border: (waves - thin) * wavelength,
        }
    }

    /// Critical wavelength at a distance along the film, m.
    fn wavelength(&self, x: f64) -> f64 {
        let [thick, thin] = self.specs.map(|spec| spec.theory().wavelength);
        if x > self.border { thin } else { thick }
    }

    /// A mesh of `points` edges per local wavelength.
    fn meshed(&self, points: f64) -> SurfaceMesh {
        let mut mesh = self.rectangle.meshed(self.wavelength(0.0) / points);
        for _ in 0..4 {
            let edges = mesh.positions.as_slice().iter();
            let tensor =
                |p: &Vector3<f64>| Matrix3::identity() * (points / self.wavelength(p.x)).powi(2);
            let sizing = Sizing {
                tensors: edges.map(tensor).collect(),
            };
            let made = remesh(&mesh, &sizing, &self.rectangle, &RemeshSettings::default());
            mesh = made.expect("a valid sizing").mesh;
        }
        mesh
    }

    /// Centres of rows that are 1.5 local wavelengths apart, and that spacing everywhere.
    fn centres(&self, mesh: &SurfaceMesh) -> (Vec<VertexId>, PerVertex<f64>) {
        let positions = mesh.positions.as_slice();
        let spacings: PerVertex<f64> = positions
            .iter()
            .map(|p| 1.5 * self.wavelength(p.x))
            .collect();
        let all: Vec<VertexId> = spacings.ids().collect();
        let settings = ClusterSettings::default();
        let centres = cluster_centres(&mesh.mesh, positions, &spacings, &all, &settings);
        (centres.expect("valid centres"), spacings)
    }

    /// The film on a mesh, held by springs and rows.
    fn sheet(&self, mesh: &SurfaceMesh) -> (Sheet, Strip) {
        let strip = Strip::of(mesh, &self.rectangle);
        let [mut made, thin] = self.specs.map(|spec| SheetSpec::film(&spec, &strip));
        let is_thin = |x: f64| x > self.border;
        let faces = strip.faces.iter().enumerate().map(|(index, face)| {
            let middle: f64 = face.iter().map(|&v| strip.points[v as usize].x / 3.0).sum();
            let side = if is_thin(middle) { &thin } else { &made };
            side.parameters.faces[index]
        });
        let tangential = strip.points.iter().enumerate().map(|(index, p)| {
            let side = if is_thin(p.x) { &thin } else { &made };
            side.parameters.tangential_stiffness[index]
        });
        made.parameters = LayerParameters {
            faces: faces.collect(),
            tangential_stiffness: tangential.collect(),
        };
        made.averages = self.averages(mesh);
        (Sheet::new(made), strip)
    }

    fn averages(&self, mesh: &SurfaceMesh) -> Vec<Vec<(u32, f64)>> {
        let (centres, spacings) = self.centres(mesh);
        let place = |v: &VertexId| MaterialPoint::of_vertex(&mesh.mesh, *v);
        let places: Vec<_> = centres.iter().filter_map(place).collect();
        let kernel = |v: &VertexId| Kernel::beside_foundation(spacings[*v]);
        let kernels: Vec<_> = centres.iter().map(kernel).collect();
        let positions = mesh.positions.as_slice();
        let normals = vertex_normals(&mesh.mesh, positions);
        let sampling = Sampling::Quadrature;
        let set = constraint_rows(&mesh.mesh, positions, &normals, &places, &kernels, sampling);
        let rows = set.expect("rows").rows.into_iter();
        rows.map(|row| row.weights.iter().map(|(v, w)| (v.0, *w)).collect())
            .collect()
    }
}

/// Longest edge over shortest, in the triangle where they differ most.
fn largest_edge_ratio(positions: &[Vector3<f64>], faces: &[[u32; 3]]) -> f64 {
    let ratios = faces.iter().map(|face| {
        let [a, b, c] = face.map(|v| positions[v as usize]);
        let lengths = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        longest / lengths.iter().copied().fold(f64::MAX, f64::min)
    });
    ratios.fold(1.0, f64::max)
}

#[test]
fn t14_spacing_follows_the_wavelength() {
    let film = Stepped::new(4.0, 0.6, 3.0);
    let mesh = film.meshed(5.0);
    let (centres, spacings) = film.centres(&mesh);
    let place = |v: VertexId| mesh.positions[v];
    let nearest = |v: VertexId| {
        let others = centres.iter().filter(|&&other| other != v);
        let distances = others.map(|&other| (place(other) - place(v)).norm());
        distances.fold(f64::MAX, f64::min) / spacings[v]
    };
    // Those beside the step have the other side's for neighbours.
    let share = |is_thin: bool| {
        let own = centres
            .iter()
            .filter(|&&v| (place(v).x > film.border) == is_thin);
        let inner = own.filter(|&&v| (place(v).x - film.border).abs() > spacings[v]);
        let shares: Vec<f64> = inner.map(|&v| nearest(v)).collect();
        assert!(!shares.is_empty());
        (
            shares.iter().sum::<f64>() / shares.len() as f64,
            shares.len(),
        )
    };
    let ((thick, few), (thin, many)) = (share(false), share(true));
    assert!(
        (0.7..1.2).contains(&thick) && (0.7..1.2).contains(&thin),
        "{thick} {thin}"
    );
    let faces: Vec<[u32; 3]> = mesh
        .mesh
        .faces()
        .as_slice()
        .iter()
        .map(|f| f.map(|v| v.0))
        .collect();
    let ratio = largest_edge_ratio(mesh.positions.as_slice(), &faces);
    assert!(ratio < 4.0, "{ratio}");
    let numbers = format!(
        "nearest rows at {thick:.2} and {thin:.2} local spacings ({few} and {many} rows); edges in a triangle differ {ratio:.1} times at most"
    );
    table_line(TEST, "ruga: rows and mesh", Finding::Holds, &numbers);
}

#[test]
fn t14_both_sides_wrinkle() {
    let film = Stepped::new(3.4, 0.4, 0.3);
    let (mut sheet, strip) = film.sheet(&film.meshed(12.0));
    let [thick, thin] = &film.specs;
    let mut steps = 0;
    for load in [1.08, 1.5, 2.0] {
        compress(&mut sheet, thick, &strip, load);
        if load < 1.1 {
            sheet.lie_down(Vector3::z(), 1e-4, 1);
        }
        let solve = sheet.solve(&exact());
        assert!(solve.converged, "{solve:?}");
        steps += solve.iterations;
    }
    // At 2 critical strains the amplitude is the thickness.
    let wavelength = film.wavelength(0.0);
    let height = |from: f64, to: f64| {
        sheet.amplitude(&Vector3::z(), |p| {
            let waves = (p.x + 0.5 * strip.length) / wavelength;
            waves > from && waves < to
        })
    };
    let (low, high) = (
        height(0.5, 2.5) / thick.film.thickness,
        height(3.1, 3.3) / thin.film.thickness,
    );
    assert!((0.75..1.1).contains(&low), "{low}");
    assert!((0.8..1.6).contains(&high), "{high}");
    let numbers = format!(
        "converges in {steps} steps at 3 loads; A over local theory: thick {low:.2}, thin (0.4 thick waves long) {high:.2}"
    );
    table_line(TEST, "ruga: film", Finding::Bounded, &numbers);
    table_line(
        TEST,
        "papers",
        Finding::NotApplicable,
        "LK's spacing follows lam too",
    );
}

/// Skin that a map makes ten times as thin over a tenth of a patch.
fn painted() -> LayerSpec {
    const TEXELS: usize = 512;
    let value = |texel: usize| f32::from(u8::from(texel % TEXELS < 9 * TEXELS / 10));
    let thickness = PropertyImage {
        width: TEXELS,
        height: 1,
        values: (0..TEXELS).map(value).collect(),
        range: [1.0 / RATIO, 1.0],
    };
    let map = PropertyMap::new(None, None, Some(thickness), Wrap::ClampToEdge).expect("a map");
    LayerSpec {
        map: Some(Arc::new(map)),
        ..skin()
    }
}

#[test]
fn t14_painted() {
    let narrow = Patch {
        width: 0.01,
        ..patch(0.12)
    };
    let plan = planned(&narrow, &painted(), &draft());
    assert!(plan.warnings.is_empty(), "{:?}", plan.warnings);
    let result = simulated(&narrow, &painted(), &draft(), 4);
    assert!(result.converged && result.warnings.is_empty());
    let computed = &result.keys[0].layers[0].computed;
    let ratio = largest_edge_ratio(&computed.positions, &computed.faces);
    assert!(ratio < 13.0, "{ratio}");
    let numbers = format!(
        "painted, from the driver on: converges on {} vertices; edges in a triangle differ {ratio:.1} times at most",
        result.layers[0].vertices
    );
    table_line(TEST, "ruga: stepper", Finding::Bounded, &numbers);
}
