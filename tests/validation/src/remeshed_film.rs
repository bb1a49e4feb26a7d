//! A rectangle of film on a flat base whose mesh is exchanged while it is wrinkled.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use ruga_constraint::{ClusterSettings, Kernel, Sampling, cluster_centres, constraint_rows};
use ruga_material::Wrinkling;
use ruga_mesh::{
    Id, LoopSurface, PerVertex, SurfaceLookup, TriMesh, VertexId, limit_rows, vertex_normals,
};
use ruga_remesh::SurfaceMesh;
use ruga_shell::{
    BendingModel, HINGE_EXPONENT, LayerEnergy, ResponseQuery, face_corners, response_modulus,
};
use ruga_solver::{Kkt, LowerPattern, NewtonSettings, SolveReport, minimise};

use crate::film_objective::{FilmObjective, gather, scatter};
use crate::film_rows::{Row, side_rollers, to_constraint_rows};
use crate::{FilmCoupling, FilmSpec, Rectangle, Strip};

/// How the shape of a film gets from one mesh to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carry {
    /// Linear interpolation on the old mesh: [`ruga_remesh::Transfer`].
    Linear,
    /// The Loop limit of control points that are corrected once, so that it loses 0.2 % of a wave
    /// instead of 4 %: what the stepper hands results out with.
    Smooth,
}

/// What the averages of the film are held at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// The averages of the base at the film's own vertices, one row for both, as in the product.
    SameRow,
    /// The averages of the base, sampled on a mesh of its own, as in Li 2014.
    OwnMesh,
}

/// A film on a rectangle, and how it is discretised.
#[derive(Clone, Copy, Debug)]
pub struct RemeshedSpec {
    /// The film, flat.
    pub film: FilmSpec,
    /// Extent in critical wavelengths.
    pub waves: [f64; 2],
    /// Compression in critical strains.
    pub load: f64,
    /// How constraint functions are sampled.
    pub sampling: Sampling,
    /// What they are held at.
    pub target: Target,
    /// Whether the bending of every mesh is corrected by its measured response.
    pub is_calibrated: bool,
}

impl RemeshedSpec {
    /// A film of 5 by 2 wavelengths under three critical strains, as ruga holds it.
    pub fn wrinkled() -> Self {
        Self {
            film: FilmSpec::flat(150.0),
            waves: [5.0, 2.0],
            load: 3.0,
            sampling: Sampling::Quadrature,
            target: Target::SameRow,
            is_calibrated: true,
        }
    }
}

/// What a remesh ought not to change.
#[derive(Clone, Copy, Debug)]
pub struct WrinkledState {
    /// Energy below that of the flat film, J.
    pub gap: f64,
    /// `sqrt(2)` RMS height, m.
    pub amplitude: f64,
}

/// The film on its present mesh.
pub struct RemeshedFilm {
    spec: RemeshedSpec,
    theory: Wrinkling,
    rectangle: Rectangle,
    functions: Functions,
    mesh: SurfaceMesh,
    discrete: Discrete,
    positions: Vec<Vector3<f64>>,
}

impl RemeshedFilm {
    /// The film in the waves of linear theory, on a mesh of `points[1]` edges per wavelength, locally
    /// up to the share `jitter` more or less.
    ///
    /// The mesh has gone through both numbers of points twice: halves of halves of two triangles are
    /// too fine by up to a third and too regular, and the first remeshes of a film would be about
    /// that.
    pub fn new(spec: &RemeshedSpec, points: [f64; 2], jitter: f64) -> Self {
        let theory = spec.film.theory();
        let [length, width] = spec.waves.map(|waves| waves * theory.wavelength);
        let rectangle = Rectangle {
            length,
            width,
            radius: None,
        };
        let edges = points.map(|points| theory.wavelength / points);
        let mut mesh = rectangle.meshed(edges[0]);
        for (seed, &edge) in edges.iter().cycle().take(4).enumerate() {
            mesh = rectangle
                .remeshed(&mesh, edge, jitter, 100 + seed as u64)
                .mesh;
        }
        let functions = Functions::new(spec, &theory, &rectangle);
        let discrete = Discrete::new(spec, &theory, &mesh, (&functions, &rectangle));
        let mut film = Self {
            spec: *spec,
            theory,
            rectangle,
            functions,
            positions: Vec::new(),
            mesh,
            discrete,
        };
        film.restart();
        film
    }

    /// Forgets the shape and takes that of linear theory.
    pub fn restart(&mut self) {
        let k = TAU / self.theory.wavelength;
        let excess = (self.spec.load - 1.0) * self.theory.critical_strain;
        let wave = |p: &Vector3<f64>| Vector3::z() * (2.0 / k * excess.sqrt() * (k * p.x).sin());
        let rest = self.mesh.positions.as_slice().iter();
        let places = rest.zip(&self.discrete.base);
        self.positions = places.map(|(p, base)| base + wave(p)).collect();
    }

    /// Vertices of the present mesh.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Exchanges the mesh for one of about `points` edges per wavelength, locally up to the share
    /// `jitter` more or less, and carries the deviation from the base over.
    pub fn remesh(&mut self, points: f64, jitter: f64, seed: u64, carry: Carry) {
        let edge = self.theory.wavelength / points;
        let made = self.rectangle.remeshed(&self.mesh, edge, jitter, seed);
        let deviations: Vec<_> = self.deviations().collect();
        let carried = match carry {
            Carry::Linear => made.transfer.rows.apply(&deviations),
            Carry::Smooth => smoothly(&self.mesh, &deviations, &made.mesh),
        };
        self.mesh = made.mesh;
        let given = (&self.functions, &self.rectangle);
        self.discrete = Discrete::new(&self.spec, &self.theory, &self.mesh, given);
        let lifted = self.discrete.base.iter().zip(carried);
        self.positions = lifted.map(|(base, u)| base + u).collect();
    }

    fn deviations(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        let pairs = self.positions.iter().zip(&self.discrete.base);
        pairs.map(|(x, base)| x - base)
    }

    /// Finds the equilibrium near the present shape.
    pub fn solve(&mut self) -> SolveReport {
        let discrete = &mut self.discrete;
        let mut x = gather(&discrete.free, &self.positions);
        let objective = FilmObjective {
            energy: &discrete.energy,
            free: &discrete.free,
            positions: &self.positions,
            pattern: discrete.kkt.pattern().clone(),
            floor: &discrete.floor,
            reaction: &vec![0.0; x.len()],
            base: &gather(&discrete.free, &discrete.base),
            theory: &self.theory,
            thickness: self.spec.film.film.thickness,
            area: discrete.energy.vertex_areas().iter().sum(),
        };
        // Energies are compared to a ten-thousandth of the gap.
        let settings = NewtonSettings {
            energy_tolerance: 1e-9,
            ..NewtonSettings::default()
        };
        let (targets, kkt) = (&discrete.targets, &mut discrete.kkt);
        let report = minimise(&objective, targets, &mut x, kkt, &settings, &mut |_| true);
        scatter(&discrete.free, &x, &mut self.positions);
        report.expect("valid input")
    }

    /// Energy and amplitude of the present shape.
    pub fn state(&self) -> WrinkledState {
        let energy = &self.discrete.energy;
        let (mut area, mut sum, mut square) = (0.0, 0.0, 0.0);
        for (u, a) in self.deviations().zip(energy.vertex_areas()) {
            area += a;
            sum += a * u.z;
            square += a * u.z * u.z;
        }
        let variance = square / area - (sum / area).powi(2);
        WrinkledState {
            gap: energy.value(&self.discrete.base) - energy.value(&self.positions),
            amplitude: (2.0 * variance).sqrt(),
        }
    }
}

/// Constraint functions: places and widths on the surface, which outlive every mesh.
struct Functions {
    centres: Vec<Vector3<f64>>,
    kernel: Kernel,
    /// What the base is sampled on where it has a mesh of its own.
    base: SurfaceMesh,
}

impl Functions {
    fn new(spec: &RemeshedSpec, theory: &Wrinkling, rectangle: &Rectangle) -> Self {
        let wavelength = theory.wavelength;
        let (spacing, kernel) = match spec.film.coupling {
            FilmCoupling::Constraint(spacing) => (spacing * wavelength, Kernel::alone(wavelength)),
            FilmCoupling::Hybrid | FilmCoupling::Elastic => {
                let spacing = 1.5 * wavelength;
                (spacing, Kernel::beside_foundation(spacing))
            }
        };
        let fine = rectangle.meshed(wavelength / 20.0);
        let positions = fine.positions.as_slice();
        let spacings = PerVertex::filled(positions.len(), spacing);
        let all: Vec<VertexId> = spacings.ids().collect();
        let settings = ClusterSettings::default();
        let chosen = match spec.film.coupling {
            FilmCoupling::Elastic => Vec::new(),
            _ => cluster_centres(&fine.mesh, positions, &spacings, &all, &settings)
                .expect("valid centres"),
        };
        Self {
            centres: chosen.iter().map(|&v| fine.positions[v]).collect(),
            kernel,
            base: rectangle.meshed(wavelength / 9.0),
        }
    }

    /// Weights of every function at the vertices of a mesh.
    fn sample(&self, mesh: &SurfaceMesh, sampling: Sampling) -> Vec<Vec<(VertexId, f64)>> {
        let positions = mesh.positions.as_slice();
        let lookup = SurfaceLookup::new(&mesh.mesh, positions);
        let place = |p: &Vector3<f64>| lookup.closest(p).expect("a surface").point;
        let set = constraint_rows(
            &mesh.mesh,
            positions,
            &vertex_normals(&mesh.mesh, positions),
            &self.centres.iter().map(place).collect::<Vec<_>>(),
            &vec![self.kernel; self.centres.len()],
            sampling,
        )
        .expect("valid rows");
        assert_eq!(set.rows.len(), self.centres.len());
        set.rows.into_iter().map(|row| row.weights).collect()
    }
}

/// What depends on the mesh.
struct Discrete {
    energy: LayerEnergy,
    free: Vec<u32>,
    kkt: Kkt,
    floor: Vec<f64>,
    targets: Vec<f64>,
    /// Vertices of the base under load, m.
    base: Vec<Vector3<f64>>,
}

impl Discrete {
    fn new(
        spec: &RemeshedSpec,
        theory: &Wrinkling,
        mesh: &SurfaceMesh,
        (functions, rectangle): (&Functions, &Rectangle),
    ) -> Self {
        let strip = Strip::of(mesh, rectangle);
        let rest = mesh.positions.as_slice();
        let pinned = strip.ends();
        let parameters = spec.film.parameters(&strip);
        let bending = spec.film.bending;
        let mut energy =
            LayerEnergy::with_bending(&strip.topology(), rest, parameters, &pinned, bending)
                .expect("a valid layer");
        let base = compressed(spec, theory, rest);
        let (normals, offsets) = (vec![Vector3::z(); rest.len()], vec![0.0; rest.len()]);
        energy
            .set_base(&base, &normals, &offsets)
            .expect("a valid base");
        if spec.is_calibrated {
            let factor = bending_factor(&spec.film, rest, &strip.topology(), &pinned);
            energy
                .set_bending_factor(factor)
                .expect("a positive factor");
        }
        let free = energy.free_vertices().to_vec();
        let (mut rows, mut targets) = held_averages(spec, theory, mesh, functions, &free, &base);
        for roller in side_rollers(&strip, &free) {
            let unknown = roller[0].0;
            targets.push(base[free[unknown / 3] as usize][unknown % 3]);
            rows.push(roller);
        }
        let (starts, entries) = energy.pattern();
        let pattern = LowerPattern::new(starts.to_vec(), entries.to_vec()).expect("a pattern");
        let rows = to_constraint_rows(&rows, 3 * free.len());
        let areas = energy.vertex_areas();
        let floor = |&v: &u32| [1e-6 * theory.normal_stiffness * areas[v as usize]; 3];
        Self {
            kkt: Kkt::new(&pattern, &rows, 3).expect("a valid system"),
            floor: free.iter().flat_map(floor).collect(),
            energy,
            free,
            targets,
            base,
        }
    }
}

/// One row per coordinate of each cluster, over the vertices that move, and its right-hand side.
fn held_averages(
    spec: &RemeshedSpec,
    theory: &Wrinkling,
    mesh: &SurfaceMesh,
    functions: &Functions,
    free: &[u32],
    base: &[Vector3<f64>],
) -> (Vec<Row>, Vec<f64>) {
    let average = |row: &[(VertexId, f64)], points: &[Vector3<f64>]| {
        let terms = row.iter().map(|(v, weight)| points[v.index()] * *weight);
        terms.sum::<Vector3<f64>>()
    };
    let weights = functions.sample(mesh, spec.sampling);
    let wanted: Vec<Vector3<f64>> = match spec.target {
        Target::SameRow => weights.iter().map(|row| average(row, base)).collect(),
        Target::OwnMesh => {
            let points = compressed(spec, theory, functions.base.positions.as_slice());
            let rows = functions.sample(&functions.base, spec.sampling);
            rows.iter().map(|row| average(row, &points)).collect()
        }
    };
    let (mut rows, mut targets) = (Vec::new(), Vec::new());
    for (row, wanted) in weights.iter().zip(wanted) {
        let is_free = |v: VertexId| free.binary_search(&v.0);
        let moving: Vec<(usize, f64)> = row
            .iter()
            .filter_map(|&(v, weight)| Some((is_free(v).ok()?, weight)))
            .collect();
        let held: Vec<_> = row
            .iter()
            .copied()
            .filter(|(v, _)| is_free(*v).is_err())
            .collect();
        // Pinned vertices are where they ought to be.
        let target = wanted - average(&held, base);
        for axis in 0..3 {
            rows.push(
                moving
                    .iter()
                    .map(|(u, weight)| (3 * u + axis, *weight))
                    .collect(),
            );
            targets.push(target[axis]);
        }
    }
    (rows, targets)
}

fn compressed(spec: &RemeshedSpec, theory: &Wrinkling, rest: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let stretch = 1.0 - spec.load * theory.critical_strain;
    let place = |p: &Vector3<f64>| Vector3::new(p.x * stretch, p.y, 0.0);
    rest.iter().map(place).collect()
}

/// Factor on the bending of a mesh that makes up for what it responds with, as a layer does it.
pub(crate) fn bending_factor(
    spec: &FilmSpec,
    rest: &[Vector3<f64>],
    mesh: &TriMesh,
    pinned: &[bool],
) -> f64 {
    let theory = spec.theory();
    let response = response_modulus(&ResponseQuery {
        mesh,
        corners: &face_corners(mesh, rest),
        directions: &vec![Vector3::x(); mesh.face_count()],
        fixed: pinned,
        bending_modulus: theory.bending_stiffness,
        hinge_exponent: HINGE_EXPONENT,
        poisson: spec.film.poisson,
        bending_model: spec.bending,
        normal_stiffness: theory.normal_stiffness,
        gradient_stiffness: theory.gradient_stiffness,
    });
    let ratio = response
        .ok()
        .filter(|response| response.converged)
        .map(|response| response.bending_modulus / theory.bending_stiffness)
        .filter(|ratio| *ratio >= 0.5)
        .map_or(1.0, |ratio| ratio.min(2.0));
    match spec.bending {
        BendingModel::Hinge => 1.0 / ratio,
        BendingModel::VertexCurvature => 1.0 / ratio.min(1.0),
    }
}

/// Values at the vertices of a new mesh, on the smooth surface through those of the old one.
fn smoothly(old: &SurfaceMesh, values: &[Vector3<f64>], new: &SurfaceMesh) -> Vec<Vector3<f64>> {
    // Without its corners marked, the border would mix what is pinned with what slides.
    let corners = old.fixed.clone();
    let reached = limit_rows(&old.mesh, &corners).position.apply(values);
    let corrected = values.iter().zip(&reached);
    let control: Vec<_> = corrected
        .map(|(value, reached)| value * 2.0 - reached)
        .collect();
    let lookup = SurfaceLookup::new(&old.mesh, old.positions.as_slice());
    let place = |p: &Vector3<f64>| lookup.closest(p).expect("a surface").point;
    let places: Vec<_> = new.positions.as_slice().iter().map(place).collect();
    let limit = LoopSurface::new(&old.mesh, &corners).rows(&places);
    limit.position.apply(&control)
}
