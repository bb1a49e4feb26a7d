//! A strip of film, compressed by the base it lies on.
//!
//! Ends are pinned, which suits whole half-waves; the sides slide (y fixed), which makes plane
//! strain. One wave is `wavelength` of the half-space theory.

use nalgebra::Vector3;
use ruga_constraint::{ClusterSettings, Kernel, Sampling, cluster_centres, constraint_rows};
use ruga_material::{LayerMaterial, Substrate, WavelengthModel, Wrinkling, wrinkling};
use ruga_mesh::{Id, PerVertex, TriMesh, VertexId, vertex_normals};
use ruga_shell::{FaceParameters, LayerEnergy, LayerParameters};
use ruga_solver::{
    AtSaddle, ConstraintRows, Kkt, LoadSettings, LoadStepper, LowerPattern, NewtonSettings,
    Objective, Outcome, SolveReport, StopRule, Verdict, inertia_at, minimise,
};

use crate::Strip;

/// Which terms hold the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmCoupling {
    /// Low-pass rows alone, at a spacing in thousandths of the wavelength.
    Constraint(u32),
    /// Foundation and tie.
    Elastic,
    /// Foundation, tie and rows at 1.5 wavelengths.
    Hybrid,
}

/// The shape of the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Base {
    /// The plane; x shrinks.
    Flat,
    /// A cylinder of this radius (m) around an axis along y; its arc shrinks.
    Cylinder(f64),
}

/// One kept load step.
#[derive(Clone, Debug)]
pub struct Step {
    /// Compression over the critical strain.
    pub load: f64,
    /// How the solve went.
    pub solve: SolveReport,
    /// `sqrt(2)` RMS height over `(2/k) sqrt(eps - eps_c)`; NaN below the critical strain.
    pub relative_amplitude: f64,
    /// Wavelength over the critical one, from zero crossings in material coordinates.
    pub relative_wavelength: f64,
}

/// The film and the base below it.
pub struct Film {
    /// What linear theory says.
    pub wrinkling: Wrinkling,
    thickness: f64,
    base: Base,
    strip: Strip,
    energy: LayerEnergy,
    free: Vec<u32>,
    kkt: Kkt,
    floor: Vec<f64>,
    positions: Vec<Vector3<f64>>,
    averages: usize,
}

impl Film {
    /// Film thickness in every test, m.
    pub const THICKNESS: f64 = 1e-4;

    /// Half-space theory of a film `ratio` times as stiff as its base.
    pub fn theory(ratio: f64) -> Wrinkling {
        let film = LayerMaterial {
            young: ratio * 1e5,
            poisson: 0.3,
            thickness: Self::THICKNESS,
            density: 1100.0,
        };
        let base = Substrate {
            young: 1e5,
            poisson: 0.3,
            thickness: 1.0,
        };
        wrinkling(&film, &base, WavelengthModel::HalfSpace).expect("valid materials")
    }

    /// Lays the film of modulus ratio `ratio` on a base.
    pub fn new(ratio: f64, strip: Strip, base: Base, coupling: FilmCoupling) -> Self {
        let theory = Self::theory(ratio);
        let rest: Vec<Vector3<f64>> = base_points(&strip, base, 0.0);
        let mesh = TriMesh::new(rest.len(), strip.faces.clone()).expect("a valid mesh");
        let tolerance = 1e-9 * strip.length;
        let pinned: Vec<bool> = strip
            .points
            .iter()
            .map(|p| p.x < tolerance || p.x > strip.length - tolerance)
            .collect();
        let held = !matches!(coupling, FilmCoupling::Constraint(_));
        let spring = |stiffness: f64| if held { stiffness } else { 0.0 };
        let face = FaceParameters {
            young: ratio * 1e5,
            poisson: 0.3,
            thickness: Self::THICKNESS,
            normal_stiffness: spring(theory.normal_stiffness),
            gradient_stiffness: spring(theory.gradient_stiffness),
        };
        let tie = spring(theory.tangential_stiffness);
        let parameters = LayerParameters::uniform(face, strip.faces.len(), tie, strip.points.len());
        let energy =
            LayerEnergy::new(&rest, &strip.faces, parameters, &pinned).expect("a valid layer");
        let free = energy.free_vertices().to_vec();
        let (starts, entries) = energy.pattern();
        let pattern =
            LowerPattern::new(starts.to_vec(), entries.to_vec()).expect("a valid pattern");
        let mut rows = averages(&mesh, &rest, &pinned, &free, &theory, coupling);
        let averages = rows.len();
        rows.extend(side_rollers(&strip, &free));
        let rows = to_rows(&rows, 3 * free.len());
        let areas = energy.vertex_areas();
        let floor = free
            .iter()
            .flat_map(|&v| [1e-6 * theory.normal_stiffness * areas[v as usize]; 3])
            .collect();
        Self {
            wrinkling: theory,
            thickness: Self::THICKNESS,
            base,
            kkt: Kkt::new(&pattern, &rows, 3).expect("a valid system"),
            positions: rest,
            strip,
            energy,
            free,
            floor,
            averages,
        }
    }

    /// Number of averages (one per coordinate of each cluster).
    pub fn average_count(&self) -> usize {
        self.averages
    }

    /// Shrinks the base to `load` critical strains and carries the film along.
    fn set_load(&mut self, load: f64) {
        let strain = load * self.wrinkling.critical_strain;
        let points = base_points(&self.strip, self.base, strain);
        let normals = base_normals(&self.strip, self.base, strain);
        let zeros = vec![0.0; points.len()];
        self.energy
            .set_base(&points, &normals, &zeros)
            .expect("a valid base");
    }

    /// Film lying on the base at `load` critical strains, moved by noise of `noise` thicknesses.
    pub fn lay_down(&mut self, load: f64, noise: f64, seed: u64) {
        use rand::{RngExt, SeedableRng};
        let strain = load * self.wrinkling.critical_strain;
        self.set_load(load);
        self.positions = base_points(&self.strip, self.base, strain);
        let normals = base_normals(&self.strip, self.base, strain);
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        for &v in &self.free {
            let height = noise * self.thickness * random.random_range(-1.0..1.0);
            self.positions[v as usize] += normals[v as usize] * height;
        }
    }

    /// Solves at `load` from the present shape.
    pub fn solve(&mut self, load: f64, settings: &NewtonSettings) -> SolveReport {
        self.set_load(load);
        let strain = load * self.wrinkling.critical_strain;
        let points = base_points(&self.strip, self.base, strain);
        let mut targets = vec![0.0; self.kkt.rows().count()];
        self.kkt
            .rows()
            .mul(&gather(&self.free, &points), &mut targets)
            .expect("sizes match");
        for v in 0..self.positions.len() {
            if self.free.binary_search(&(v as u32)).is_err() {
                self.positions[v] = points[v];
            }
        }
        let mut x = gather(&self.free, &self.positions);
        let objective = FilmObjective {
            energy: &self.energy,
            free: &self.free,
            positions: &self.positions,
            pattern: self.kkt.pattern().clone(),
            floor: &self.floor,
            theory: &self.wrinkling,
            thickness: self.thickness,
            area: self.strip.length * self.strip.width,
        };
        let report = minimise(
            &objective,
            &targets,
            &mut x,
            &mut self.kkt,
            settings,
            &mut |_| true,
        )
        .expect("valid input");
        scatter(&self.free, &x, &mut self.positions);
        report
    }

    /// Whether the flat state at `load` is unstable; on a curved base the film settles first.
    fn buckles(&mut self, load: f64) -> bool {
        self.lay_down(load, 0.0, 0);
        if self.base == Base::Flat {
            let x = gather(&self.free, &self.positions);
            let objective = FilmObjective {
                energy: &self.energy,
                free: &self.free,
                positions: &self.positions,
                pattern: self.kkt.pattern().clone(),
                floor: &self.floor,
                theory: &self.wrinkling,
                thickness: self.thickness,
                area: 1.0,
            };
            let inertia = inertia_at(&objective, &x, &mut self.kkt).expect("factorisable");
            return !inertia.is_minimum();
        }
        let settings = NewtonSettings {
            at_saddle: AtSaddle::Stop,
            ..NewtonSettings::default()
        };
        self.solve(load, &settings).stop == StopRule::Saddle
    }

    /// Load at which the film buckles, over the critical strain, to 0.2 %.
    pub fn onset(&mut self, mut low: f64, mut high: f64) -> f64 {
        while high - low > 0.002 * low {
            let middle = 0.5 * (low + high);
            if self.buckles(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        0.5 * (low + high)
    }

    /// Loads up to the last of `loads`, through the onset; a step for each load kept.
    pub fn ramp(&mut self, loads: &[f64], seed: u64) -> Vec<Step> {
        let full = *loads.last().expect("some load");
        let keys: Vec<f64> = loads.iter().map(|l| l / full).collect();
        let mut stepper =
            LoadStepper::new(&keys, LoadSettings::default()).expect("increasing loads");
        self.lay_down(0.0, 1e-3, seed);
        let mut kept = self.positions.clone();
        let mut kept_load = 0.0;
        let mut steps = Vec::new();
        while let Some(trial) = stepper.next_trial() {
            let load = trial.load * full;
            self.carry(kept_load, load);
            let settings = NewtonSettings {
                at_saddle: if trial.probe {
                    AtSaddle::Stop
                } else {
                    AtSaddle::Leave
                },
                seed,
                ..NewtonSettings::default()
            };
            let solve = self.solve(load, &settings);
            let outcome =
                if solve.stop == StopRule::Saddle || (solve.left_saddle && solve.converged) {
                    Outcome::Buckled
                } else if solve.converged {
                    Outcome::Stable
                } else {
                    Outcome::Failed
                };
            if stepper.report(outcome) == Verdict::Keep {
                kept.clone_from(&self.positions);
                kept_load = load;
                steps.push(self.measure(load, solve));
            } else {
                self.positions.clone_from(&kept);
            }
        }
        steps
    }

    /// Moves the film with the base from one load to another.
    fn carry(&mut self, from: f64, to: f64) {
        let eps = self.wrinkling.critical_strain;
        let old = base_points(&self.strip, self.base, from * eps);
        let new = base_points(&self.strip, self.base, to * eps);
        for (x, (a, b)) in self.positions.iter_mut().zip(old.iter().zip(&new)) {
            *x += b - a;
        }
    }

    /// Heights over the base, m.
    pub fn heights(&self, load: f64) -> Vec<f64> {
        let strain = load * self.wrinkling.critical_strain;
        let points = base_points(&self.strip, self.base, strain);
        let normals = base_normals(&self.strip, self.base, strain);
        (0..points.len())
            .map(|i| normals[i].dot(&(self.positions[i] - points[i])))
            .collect()
    }

    /// Amplitude and wavelength of the present shape.
    pub fn measure(&self, load: f64, solve: SolveReport) -> Step {
        let heights = self.heights(load);
        let areas = self.energy.vertex_areas();
        let total: f64 = areas.iter().sum();
        let squares: f64 = heights.iter().zip(areas).map(|(w, a)| w * w * a).sum();
        let amplitude = (2.0 * squares / total).sqrt();
        let theory = &self.wrinkling;
        let excess = (load - 1.0) * theory.critical_strain;
        let wavelength = self.wavelength(&heights);
        let wave_number = std::f64::consts::TAU / wavelength;
        Step {
            load,
            solve,
            relative_amplitude: amplitude / (2.0 / wave_number * excess.sqrt()),
            relative_wavelength: wavelength / theory.wavelength,
        }
    }

    /// Twice the length over the number of half-waves that fits `heights` best, in material
    /// coordinates: the strongest sine with nodes at both pinned ends.
    fn wavelength(&self, heights: &[f64]) -> f64 {
        let areas = self.energy.vertex_areas();
        let strength = |half_waves: usize| -> f64 {
            let k = std::f64::consts::PI * half_waves as f64 / self.strip.length;
            heights
                .iter()
                .zip(&self.strip.points)
                .zip(areas)
                .map(|((w, p), a)| w * (k * p.x).sin() * a)
                .sum::<f64>()
                .abs()
        };
        let most = (4.0 * self.strip.length / self.wrinkling.wavelength) as usize;
        let best = (1..=most)
            .max_by(|&a, &b| strength(a).total_cmp(&strength(b)))
            .unwrap_or(1);
        2.0 * self.strip.length / best as f64
    }
}

fn base_points(strip: &Strip, base: Base, strain: f64) -> Vec<Vector3<f64>> {
    strip
        .points
        .iter()
        .map(|p| {
            let x = (p.x - 0.5 * strip.length) * (1.0 - strain);
            match base {
                Base::Flat => Vector3::new(x, p.y, 0.0),
                Base::Cylinder(radius) => {
                    let (sin, cos) = (x / radius).sin_cos();
                    Vector3::new(radius * sin, p.y, radius * cos)
                }
            }
        })
        .collect()
}

fn base_normals(strip: &Strip, base: Base, strain: f64) -> Vec<Vector3<f64>> {
    strip
        .points
        .iter()
        .map(|p| match base {
            Base::Flat => Vector3::z(),
            Base::Cylinder(radius) => {
                let x = (p.x - 0.5 * strip.length) * (1.0 - strain);
                let (sin, cos) = (x / radius).sin_cos();
                Vector3::new(sin, 0.0, cos)
            }
        })
        .collect()
}

type Row = Vec<(usize, f64)>;

fn averages(
    mesh: &TriMesh,
    rest: &[Vector3<f64>],
    pinned: &[bool],
    free: &[u32],
    theory: &Wrinkling,
    coupling: FilmCoupling,
) -> Vec<Row> {
    let (spacing, kernel) = match coupling {
        FilmCoupling::Elastic => return Vec::new(),
        FilmCoupling::Hybrid => {
            let spacing = 1.5 * theory.wavelength;
            (spacing, Kernel::beside_foundation(spacing))
        }
        FilmCoupling::Constraint(thousandths) => (
            f64::from(thousandths) * 1e-3 * theory.wavelength,
            Kernel::alone(theory.wavelength),
        ),
    };
    let candidates: Vec<VertexId> = free.iter().map(|&v| VertexId(v)).collect();
    let centres = cluster_centres(
        mesh,
        rest,
        &PerVertex::filled(mesh.vertex_count(), spacing),
        &candidates,
        &ClusterSettings::default(),
    )
    .expect("valid centres");
    let set = constraint_rows(
        mesh,
        rest,
        &vertex_normals(mesh, rest),
        &centres,
        &vec![kernel; centres.len()],
        Sampling::Quadrature,
    )
    .expect("valid rows");
    let mut rows = Vec::new();
    for row in &set.rows {
        for axis in 0..3 {
            rows.push(
                row.weights
                    .iter()
                    .filter(|(v, _)| !pinned[v.index()])
                    .filter_map(|(v, w)| {
                        let unknown = free.binary_search(&v.0).ok()?;
                        Some((3 * unknown + axis, *w))
                    })
                    .collect(),
            );
        }
    }
    rows
}

/// Fixes y along both sides, in groups of three so that no group is cut.
fn side_rollers(strip: &Strip, free: &[u32]) -> Vec<Row> {
    let tolerance = 1e-9 * strip.length;
    let mut rows: Vec<Row> = free
        .iter()
        .enumerate()
        .filter(|(_, v)| {
            let y = strip.points[**v as usize].y;
            y < tolerance || y > strip.width - tolerance
        })
        .map(|(unknown, _)| vec![(3 * unknown + 1, 1.0)])
        .collect();
    // A vertex on the side is one unknown in y; the last group may be short.
    rows.sort_by_key(|row| row[0].0);
    rows
}

fn to_rows(rows: &[Row], unknowns: usize) -> ConstraintRows {
    let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for row in rows {
        columns.extend(row.iter().map(|entry| entry.0));
        values.extend(row.iter().map(|entry| entry.1));
        starts.push(columns.len());
    }
    ConstraintRows::new(starts, columns, values, unknowns).expect("valid rows")
}

fn gather(free: &[u32], positions: &[Vector3<f64>]) -> Vec<f64> {
    free.iter()
        .flat_map(|&v| {
            let p = positions[v as usize];
            [p.x, p.y, p.z]
        })
        .collect()
}

fn scatter(free: &[u32], x: &[f64], positions: &mut [Vector3<f64>]) {
    for (&v, x) in free.iter().zip(x.chunks_exact(3)) {
        positions[v as usize] = Vector3::new(x[0], x[1], x[2]);
    }
}

struct FilmObjective<'a> {
    energy: &'a LayerEnergy,
    free: &'a [u32],
    positions: &'a [Vector3<f64>],
    pattern: LowerPattern,
    floor: &'a [f64],
    theory: &'a Wrinkling,
    thickness: f64,
    area: f64,
}

impl FilmObjective<'_> {
    fn all(&self, x: &[f64]) -> Vec<Vector3<f64>> {
        let mut positions = self.positions.to_vec();
        scatter(self.free, x, &mut positions);
        positions
    }
}

impl Objective for FilmObjective<'_> {
    fn pattern(&self) -> &LowerPattern {
        &self.pattern
    }

    fn value(&self, x: &[f64]) -> f64 {
        self.energy.value(&self.all(x))
    }

    fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let positions = self.all(x);
        self.energy.gradient(&positions, gradient);
        self.energy.value(&positions)
    }

    fn hessian(&self, x: &[f64], exact: &mut [f64], relaxed: &mut [f64]) {
        self.energy.hessian(&self.all(x), exact, Some(relaxed));
    }

    fn floor(&self) -> &[f64] {
        self.floor
    }

    fn energy_scale(&self) -> f64 {
        0.5 * self.theory.membrane_stiffness * self.theory.critical_strain.powi(2) * self.area
    }

    fn force_scale(&self) -> f64 {
        self.theory.normal_stiffness * self.thickness * self.area / self.positions.len() as f64
    }

    fn length_scale(&self) -> f64 {
        self.thickness
    }
}
