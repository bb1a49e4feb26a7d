//! What one load step costs, counted in factorisations, and what a factorisation costs.
//!
//! A flat patch of 97 x 97 vertices, eight waves of the preset forehead-furrow long and wide,
//! compressed by 12 % in six load steps. Times are those of one thread and best of several; only
//! their ratios mean something on another machine. Run it with `cargo xtask bench`.

#![allow(clippy::print_stdout, reason = "a benchmark reports")]
#![allow(clippy::unwrap_used, reason = "a benchmark is not a library")]

use std::sync::Arc;
use std::time::Instant;

use faer::Par;
use faer::Side;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{SymmetricOrdering, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use nalgebra::{Vector2, Vector3};
use ruga_blend::{ArtistMesh, BaseSurface, BlendShape, Driver, PosedSurface, Smoothing};
use ruga_constraint::{ClusterSettings, Kernel, Sampling, cluster_centres, constraint_rows};
use ruga_material::{Preset, WavelengthModel, Wrinkling, preset, wrinkling};
use ruga_mesh::{FaceId, Id, MaterialPoint, PerVertex, VertexId};
use ruga_shell::{FaceParameters, LayerEnergy, LayerParameters};
use ruga_solver::{ConstraintRows, Kkt, LowerPattern};
use ruga_stepper::{
    Coupling, Frame, LayerSpec, LayerSurface, Modelling, Observer, Phase, PoseResult, PoseSpec,
    Presence, Progress, plan,
};

/// Faces of the artist's mesh per side, each split twice.
const COARSE: usize = 24;
const LEVELS: u32 = 2;
/// Side of the patch in wavelengths: 12 edges each.
const WAVES: f64 = 8.0;
const COMPRESSION: f64 = 0.12;
const STEPS: u32 = 6;

/// Goals, as printed beside what was measured.
const MICROSECONDS_PER_FACE: f64 = 1.5;
const ASSEMBLY_SHARE: f64 = 0.25;
const FRAME_FACTORIZATIONS: f64 = 12.0;
const MEGABYTES: f64 = 400.0;

fn skin() -> (&'static Preset, Wrinkling) {
    let skin = preset("forehead-furrow").unwrap();
    let model = WavelengthModel::Layer;
    (
        skin,
        wrinkling(&skin.layer, &skin.substrate, model).unwrap(),
    )
}

/// A square in the plane whose one shape compresses it along x.
fn patch(side: f64) -> Arc<Driver> {
    let count = COARSE + 1;
    let grid = (0..count * count).map(|i| [(i % count) as f64, (i / count) as f64]);
    let uvs: Vec<_> = grid
        .map(|[x, y]| Vector2::new(x, y) / COARSE as f64)
        .collect();
    let positions: Vec<_> = uvs
        .iter()
        .map(|uv| Vector3::new(side * uv.x, side * uv.y, 0.0))
        .collect();
    let mut triangles = Vec::new();
    for j in 0..COARSE {
        for i in 0..COARSE {
            let at = |i: usize, j: usize| (j * count + i) as u32;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1));
            if (i + j) % 2 == 0 {
                triangles.extend([[a, b, d], [a, d, c]]);
            } else {
                triangles.extend([[a, b, c], [b, d, c]]);
            }
        }
    }
    let compress = BlendShape {
        name: "compress".into(),
        position_deltas: positions
            .iter()
            .map(|p| Vector3::new(-COMPRESSION * p.x, 0.0, 0.0))
            .collect(),
        normal_deltas: None,
    };
    let artist = ArtistMesh {
        name: "patch".into(),
        positions,
        normals: None,
        uvs: Some(uvs),
        triangles,
        shapes: vec![compress],
    };
    Arc::new(Driver::new(&artist).unwrap())
}

/// Times the solve of every load step that is kept.
struct Watch {
    started: Instant,
    iterations: usize,
    /// Of the solve that ended last: seconds, Newton iterations.
    solved: (f64, usize),
    /// Load, seconds, Newton iterations.
    frames: Vec<(f64, f64, usize)>,
    shape: LayerSurface,
}

impl Watch {
    fn new() -> Self {
        Self {
            started: Instant::now(),
            iterations: 0,
            solved: (0.0, 0),
            frames: Vec::new(),
            shape: LayerSurface::default(),
        }
    }
}

impl Observer for Watch {
    fn phase(&mut self, _: usize, phase: Phase) {
        // Each trial samples and solves; what is kept is sampled once more before it is handed out.
        if phase == Phase::Sampling {
            if self.iterations > 0 {
                self.solved = (self.started.elapsed().as_secs_f64(), self.iterations);
            }
            self.started = Instant::now();
            self.iterations = 0;
        }
    }

    fn progress(&mut self, _: Progress) -> bool {
        self.iterations += 1;
        true
    }

    fn frame(&mut self, frame: &Frame<'_>) {
        let (seconds, iterations) = self.solved;
        self.frames.push((frame.load, seconds, iterations));
        self.shape = frame.layers[0].clone();
    }
}

/// Runs the first `steps` of the load steps; the same path whatever their number.
fn run(driver: &Arc<Driver>, steps: u32, watch: &mut Watch) -> PoseResult {
    let (skin, _) = skin();
    let layers = [LayerSpec {
        name: "skin".into(),
        material: skin.layer,
        laminate: None,
        substrate: skin.substrate,
        model: WavelengthModel::Layer,
        coupling: Coupling::Hybrid,
        sampling: Sampling::default(),
        map: None,
        sharp: false,
        bending_transfer: None,
        variation: None,
        presence: Presence::default(),
        creases: Vec::new(),
        growths: Vec::new(),
    }];
    let weight = f64::from(steps) / f64::from(STEPS);
    let poses = [PoseSpec {
        name: "compress".into(),
        weights: driver.weights([("compress", weight)]).unwrap(),
        keys: vec![1.0],
        steps,
        motions: Vec::new(),
        growths: Vec::new(),
        half: false,
    }];
    let modelling = Modelling {
        // The planner counts the longest edges, the diagonals.
        points_per_wavelength: 8.0,
        region: ruga_stepper::Region::All,
        // The very mesh that a factorisation is timed on.
        remesh: None,
        ..Modelling::default()
    };
    let plan = plan(driver, &layers, &poses, &modelling, 2048).unwrap();
    plan.simulate(0, watch).unwrap()
}

/// The layer that the run simulates, open to view.
struct Shell {
    surface: BaseSurface,
    rest: PosedSurface,
    energy: LayerEnergy,
    pattern: LowerPattern,
    free: Vec<VertexId>,
}

impl Shell {
    fn new(driver: &Driver) -> Self {
        let (skin, wrinkling) = skin();
        let faces: Vec<FaceId> = driver.topology().faces().ids().collect();
        let surface = BaseSurface::new(driver, &faces, LEVELS, Smoothing::Loop);
        let rest = surface.pose(driver.rest());
        let mesh = surface.mesh();
        let face = FaceParameters {
            young: skin.layer.young,
            poisson: skin.layer.poisson,
            thickness: skin.layer.thickness,
            normal_stiffness: wrinkling.normal_stiffness,
            gradient_stiffness: wrinkling.gradient_stiffness,
        };
        let tangential = wrinkling.tangential_stiffness;
        let parameters =
            LayerParameters::uniform(face, mesh.face_count(), tangential, mesh.vertex_count());
        let pinned = mesh.border_vertices();
        let free = pinned.iter().filter(|(_, pinned)| !**pinned);
        let free = free.map(|(v, _)| v).collect();
        let energy =
            LayerEnergy::new(mesh, &rest.positions, parameters, pinned.as_slice()).unwrap();
        let (starts, rows) = energy.pattern();
        let pattern = LowerPattern::new(starts.to_vec(), rows.to_vec()).unwrap();
        Self {
            surface,
            rest,
            energy,
            pattern,
            free,
        }
    }

    /// Three rows for every centre that moves itself.
    fn rows(&self, spacing: f64, kernel: Kernel) -> ConstraintRows {
        let mesh = self.surface.mesh();
        let (rest, free) = (&self.rest, &self.free);
        let spacings = PerVertex::filled(mesh.vertex_count(), spacing);
        let settings = ClusterSettings::default();
        let centres = cluster_centres(mesh, &rest.positions, &spacings, free, &settings).unwrap();
        let place = |&centre: &VertexId| MaterialPoint::of_vertex(mesh, centre);
        let centres: Vec<_> = centres.iter().filter_map(place).collect();
        let kernels = vec![kernel; centres.len()];
        let (points, normals) = (&rest.positions, &rest.normals);
        let set = constraint_rows(
            mesh,
            points,
            normals,
            &centres,
            &kernels,
            Sampling::default(),
        );
        let mut unknown = vec![None; mesh.vertex_count()];
        for (i, v) in free.iter().enumerate() {
            unknown[v.index()] = Some(3 * i);
        }
        let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        for row in set.unwrap().rows {
            for axis in 0..3 {
                for (v, weight) in &row.weights {
                    if let Some(first) = unknown[v.index()] {
                        columns.push(first + axis);
                        values.push(*weight);
                    }
                }
                starts.push(columns.len());
            }
        }
        ConstraintRows::new(starts, columns, values, self.pattern.size()).unwrap()
    }
}

/// Shortest of `count` runs (s).
fn best(count: usize, mut run: impl FnMut()) -> f64 {
    let seconds = (0..count).map(|_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    });
    seconds.fold(f64::INFINITY, f64::min)
}

/// faer's Cholesky factorisation of the Hessian alone in its own ordering (s).
fn plain_cholesky(pattern: &LowerPattern, values: &[f64]) -> f64 {
    let starts = pattern.column_starts().to_vec();
    let rows = pattern.rows().iter().map(|&row| row as usize).collect();
    let size = pattern.size();
    let structure = SymbolicSparseColMat::new_checked(size, size, starts, None, rows);
    let order = SymmetricOrdering::Amd;
    let options = Default::default();
    let symbolic =
        factorize_symbolic_cholesky(structure.as_ref(), Side::Lower, order, options).unwrap();
    let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
    let mut memory = MemBuffer::new(scratch);
    let matrix = SparseColMat::new(structure, values.to_vec());
    let mut factor = vec![0.0; symbolic.len_val()];
    best(7, || {
        symbolic
            .factorize_numeric_llt(
                &mut factor,
                matrix.as_ref(),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .unwrap();
    })
}

/// Prints factorisation and refined solve with `rows` in units of `reference` (s); returns the
/// time of the factorisation (s).
fn kkt(name: &str, shell: &Shell, rows: &ConstraintRows, values: &[f64], reference: f64) -> f64 {
    let mut kkt = Kkt::new(&shell.pattern, rows, 3).unwrap();
    let damping = vec![0.0; shell.pattern.size()];
    let factor = best(7, || {
        kkt.factorize(values, &damping).unwrap();
    });
    let force = vec![1.0; shell.pattern.size()];
    let offset = vec![0.0; rows.count()];
    let (mut step, mut multipliers) = (force.clone(), offset.clone());
    let solve = best(7, || {
        kkt.solve(&force, &offset, &mut step, &mut multipliers)
            .unwrap();
    });
    let cost = kkt.cost();
    let triples = rows.count() / 3;
    println!(
        "  {name:<14} {triples:>4} triples: factor {:.2}, solve {:.2}, both {:.2}; \
         {:.1} M entries, {:.2} Gflop, {:.0} Gflop/s",
        factor / reference,
        solve / reference,
        (factor + solve) / reference,
        cost.factor_entries as f64 / 1e6,
        cost.flops / 1e9,
        cost.flops / 1e9 / factor,
    );
    factor
}

/// Largest resident memory of this process so far (MB), where the system tells.
fn peak_megabytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1024.0)
}

/// Seconds of one factorisation of the layer that the run simulates.
fn compare_linear_algebra(shell: &Shell, shape: &LayerSurface) -> f64 {
    let (_, wrinkling) = skin();
    let wavelength = wrinkling.wavelength;
    let mut energy = shell.energy.clone();
    let (points, normals) = (&shape.driver_positions, &shape.driver_normals);
    energy
        .set_base(points, normals, &vec![0.0; points.len()])
        .unwrap();
    let x = &shape.positions;
    let mut gradient = vec![0.0; energy.dof_count()];
    let mut exact = vec![0.0; shell.pattern.entries()];
    let mut relaxed = exact.clone();
    let assembly = best(7, || {
        energy.gradient(x, &mut gradient);
        energy.hessian(x, &mut exact, None);
    });
    let both = best(7, || {
        energy.gradient(x, &mut gradient);
        energy.hessian(x, &mut exact, Some(&mut relaxed));
    });
    // The relaxed Hessian stands in for the exact one, which plain Cholesky may refuse.
    let reference = plain_cholesky(&shell.pattern, &relaxed);
    println!("relative to faer's Cholesky of the Hessian alone ({reference:.3} s):");
    let hybrid = 1.5 * wavelength;
    let narrow = WAVES * wavelength / 26.0;
    let none = ConstraintRows::none(shell.pattern.size());
    kkt("no rows", shell, &none, &relaxed, reference);
    let rows = shell.rows(hybrid, Kernel::beside_foundation(hybrid));
    let factor = kkt("hybrid", shell, &rows, &relaxed, reference);
    let rows = shell.rows(narrow, Kernel::alone(2.0 * narrow));
    kkt("constraint", shell, &rows, &relaxed, reference);
    let faces = shell.surface.mesh().face_count() as f64;
    println!(
        "assembly: gradient and Hessian {:.2} us per face (goal {MICROSECONDS_PER_FACE}), {:.2} of a \
         factorisation (goal {ASSEMBLY_SHARE}); with the relaxed Hessian {:.2} us, {:.2}",
        assembly / faces * 1e6,
        assembly / factor,
        both / faces * 1e6,
        both / factor,
    );
    factor
}

fn main() {
    let (_, wrinkling) = skin();
    let driver = patch(WAVES * wrinkling.wavelength);
    let mut before = Watch::new();
    let earlier = run(&driver, STEPS - 1, &mut before);
    let mut watch = Watch::new();
    let whole = run(&driver, STEPS, &mut watch);
    let memory = peak_megabytes();
    let report = &whole.layers[0];
    println!(
        "patch: {} vertices, {} faces, {} triples; converged: {}, {} iterations, {} factorisations",
        report.vertices,
        report.faces,
        report.constraints,
        whole.converged,
        report.newton_iterations,
        report.factorizations,
    );
    let shell = Shell::new(&driver);
    let factor = compare_linear_algebra(&shell, &watch.shape);
    for (load, seconds, iterations) in &watch.frames {
        println!(
            "frame at {:.1} %: {iterations} iterations, {:.1} factorisations' time",
            100.0 * COMPRESSION * load,
            seconds / factor,
        );
    }
    let (_, seconds, _) = watch.frames[watch.frames.len() - 1];
    println!(
        "warm frame: {} factorisations, {:.1} factorisations' time (goal {FRAME_FACTORIZATIONS})",
        report.factorizations - earlier.layers[0].factorizations,
        seconds / factor,
    );
    if let Some(memory) = memory {
        println!("peak memory: {memory:.0} MB (goal {MEGABYTES})");
    }
}
