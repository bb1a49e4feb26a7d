//! What creases add to the cost of a film, and what a band of small triangles costs in their place.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use ruga_mesh::EdgeId;
use ruga_remesh::SurfaceMesh;
use ruga_shell::{BendingModel, Crease, FoldSense, LayerEnergy, LayerParameters};
use ruga_solver::{ConstraintRows, FactorCost, Kkt, LowerPattern, NewtonSettings};

use crate::{
    DrawnSheet, FilmCoupling, FilmSpec, Sheet, SheetSpec, Strip, cpu_seconds, edges_within,
    unit_face, unit_film, upright,
};

/// Cost of the Hessian of a film, without and with creases.
#[derive(Clone, Copy, Debug)]
pub struct CreaseCost {
    /// Entries of its pattern.
    pub entries: [usize; 2],
    /// Processor seconds of an assembly, the least of many.
    pub seconds: [f64; 2],
    /// Time of an assembly with creases over that of the one before it without, the median of many.
    pub share: f64,
}

/// Pairs of assemblies.
const REPEATS: usize = 51;

/// Assembles the Hessian of a film a dozen points per wavelength and `waves` wavelengths long, with `lines` across it.
///
/// # Panics
/// When the film has no room for the lines.
pub fn crease_cost(waves: usize, lines: usize) -> CreaseCost {
    let strip = lined_strip(waves, 4);
    let (theory, thickness) = unit_film(0.05);
    let parameters = LayerParameters::uniform(
        unit_face((&theory, thickness)),
        strip.faces.len(),
        theory.tangential_stiffness,
        strip.points.len(),
    );
    let mesh = strip.topology();
    let rest = strip.compressed(0.0);
    let layer = LayerEnergy::with_bending(
        &mesh,
        &rest,
        parameters,
        &strip.ends(),
        BendingModel::VertexCurvature,
    );
    let mut layer = layer.expect("a valid layer");
    let crease = Crease {
        compliance: 1.0 / (0.5 * TAU),
        rest_angle: 0.5,
        sense: FoldSense::Valley,
    };
    let creases = on_lines((&strip, waves), lines, crease);
    let mut cost = CreaseCost {
        entries: [0; 2],
        seconds: [f64::INFINITY; 2],
        share: 1.0,
    };
    let mut values = vec![0.0; layer.pattern().1.len()];
    // By turns, so that what else the machine does falls on both; and one layer, for where its arrays lie in memory
    // makes a tenth of the time.
    let mut turns = [[0.0; 2]; REPEATS];
    for turn in &mut turns {
        for (i, own) in [&[], creases.as_slice()].into_iter().enumerate() {
            layer.set_creases(own).expect("valid creases");
            let start = cpu_seconds();
            layer.hessian(&rest, &mut values, None);
            turn[i] = cpu_seconds() - start;
            cost.seconds[i] = cost.seconds[i].min(turn[i]);
            cost.entries[i] = layer.pattern().1.len();
        }
    }
    cost.share = median_share(&turns);
    cost
}

/// Points per wavelength of the films.
const POINTS: usize = 12;

/// A film with columns of vertices across it, so many wavelengths long and wide.
fn lined_strip(waves: usize, width: usize) -> Strip {
    upright(waves as f64, waves * POINTS, width * POINTS)
}

/// A crease on every edge of `lines` columns, evenly apart.
fn on_lines(
    (strip, waves): (&Strip, usize),
    lines: usize,
    crease: Crease,
) -> Vec<(EdgeId, Crease)> {
    let apart = waves * POINTS / (lines + 1);
    assert!(apart > 1, "room for the lines");
    let is_line =
        |column: usize| column > 0 && column <= lines * apart && column.is_multiple_of(apart);
    let column = |v: u32| strip.points[v as usize].x * POINTS as f64;
    let is_on = |v: u32| {
        let near = column(v).round();
        (column(v) - near).abs() < 1e-6 && is_line(near as usize)
    };
    let edges = edges_within(&strip.topology(), is_on).into_iter();
    edges.map(|edge| (edge, crease)).collect()
}

/// Cost of a load step of a film that wrinkles, without and with creases that hardly give way.
#[derive(Clone, Copy, Debug)]
pub struct FrameCost {
    /// Newton steps.
    pub iterations: [usize; 2],
    /// Processor seconds of the solve, the least of several.
    pub seconds: [f64; 2],
    /// Time of a frame with creases over that of the one before it without, the median of several.
    pub share: f64,
    /// Amplitude of the wrinkles in thicknesses.
    pub amplitudes: [f64; 2],
}

/// Pairs of frames.
const FRAMES: usize = 9;

/// Stiffness of the lines in units of the film's: so much that the film with lines wrinkles as that without does,
/// and takes as many Newton steps.
const HARDLY: f64 = 100.0;

/// Base compressions before the frame and after it, critical strains.
const COMPRESSIONS: [f64; 2] = [1.2, 1.4];

/// Compresses a wrinkled film a dozen points per wavelength, `waves` wavelengths long and half as wide, a little more,
/// with `lines` across it and without.
///
/// # Panics
/// When the film has no room for the lines, or a solve does not converge.
pub fn frame_cost(waves: usize, lines: usize) -> FrameCost {
    let strip = lined_strip(waves, waves / 2);
    let critical = 0.05;
    let (theory, thickness) = unit_film(critical);
    let film = FilmSpec {
        coupling: FilmCoupling::Elastic,
        ..FilmSpec::flat(150.0)
    };
    let mut spec = SheetSpec::film(&film, &strip);
    (spec.theory, spec.thickness) = (theory, thickness);
    spec.parameters = LayerParameters::uniform(
        unit_face((&theory, thickness)),
        strip.faces.len(),
        theory.tangential_stiffness,
        strip.points.len(),
    );
    let crease = Crease {
        compliance: 1.0 / (HARDLY * TAU),
        rest_angle: 0.0,
        sense: FoldSense::Both,
    };
    let creases = on_lines((&strip, waves), lines, crease);
    let mut sheet = Sheet::new(spec);
    let [before, after] = COMPRESSIONS.map(|share| strip.compressed(share * critical));
    let normals = vec![Vector3::z(); strip.points.len()];
    let settings = NewtonSettings::default();
    let mut cost = FrameCost {
        iterations: [0; 2],
        seconds: [f64::INFINITY; 2],
        share: 1.0,
        amplitudes: [0.0; 2],
    };
    let mut turns = [[0.0; 2]; FRAMES];
    for turn in &mut turns {
        for (i, own) in [&[], creases.as_slice()].into_iter().enumerate() {
            sheet.crease(own, &[]);
            sheet.lay_on(before.clone(), &normals);
            sheet.lie_down(Vector3::z(), 0.1, 7);
            let first = sheet.solve(&settings);
            sheet.lay_on(after.clone(), &normals);
            let start = cpu_seconds();
            let report = sheet.solve(&settings);
            turn[i] = cpu_seconds() - start;
            cost.seconds[i] = cost.seconds[i].min(turn[i]);
            assert!(first.converged && report.converged, "{report:?}");
            cost.iterations[i] = report.iterations;
            cost.amplitudes[i] = sheet.amplitude(&Vector3::z(), |_| true) / thickness;
        }
    }
    cost.share = median_share(&turns);
    cost
}

/// Median of the second times over the first ones. What else the machine does lasts longer than a turn, and falls on
/// both.
fn median_share(turns: &[[f64; 2]]) -> f64 {
    let mut shares: Vec<_> = turns.iter().map(|turn| turn[1] / turn[0]).collect();
    shares.sort_by(f64::total_cmp);
    shares[shares.len() / 2]
}

/// Elements of a film with one line: as an edge with a crease, and as a band resolved by three edges.
#[derive(Clone, Copy, Debug)]
pub struct BandCost {
    /// Triangles, of the film with a crease and of that with a band.
    pub faces: [usize; 2],
    /// Cost of one factorisation.
    pub factor: [FactorCost; 2],
    /// Shortest edge (wavelengths), which limits the step of an explicit method.
    pub shortest: [f64; 2],
}

/// Width of the band (wavelengths).
pub const BAND: f64 = 0.02;

/// How fast edges grow beside the band, per distance.
const GROWTH: f64 = 0.3;

/// Meshes both films, four wavelengths square and a dozen points per wavelength.
///
/// # Panics
/// When a mesh cannot be made.
pub fn band_cost() -> BandCost {
    let drawn = DrawnSheet::new(4, 3);
    let [a, b] = [[0.0, 1.7], [4.0, 2.3]].map(|[x, y]| Vector3::new(x, y, 0.0));
    let line = drawn.trace(vec![a, b]);
    let across = Vector3::z().cross(&(b - a)).normalize();
    let edge = 1.0 / 12.0;
    let graded = |p: &Vector3<f64>| {
        let beside = ((p - a).dot(&across).abs() - 0.5 * BAND).max(0.0);
        (BAND / 3.0 + GROWTH * beside).min(edge)
    };
    // The first fits of the graded mesh only bring its edges near what is asked for.
    let lines = std::slice::from_ref(&line);
    let uniform = drawn.fitted_to(lines, &|_| edge, 2);
    let band = drawn.fitted_to(lines, &graded, 4);
    let last = [uniform, band].map(|mut fits| fits.pop().expect("there are fits"));
    let factor = [&last[0], &last[1]].map(factor_cost);
    let shortest = [&last[0], &last[1]].map(|made| {
        let edges = made.mesh.edges().as_slice().iter();
        let lengths = edges.map(|edge| {
            let [p, q] = edge.vertices.map(|v| made.positions[v]);
            (q - p).norm()
        });
        lengths.fold(f64::INFINITY, f64::min)
    });
    BandCost {
        faces: [&last[0], &last[1]].map(|made| made.mesh.face_count()),
        factor,
        shortest,
    }
}

/// Cost of a factorisation of a film's Hessian.
fn factor_cost(made: &SurfaceMesh) -> FactorCost {
    let (theory, thickness) = unit_film(0.05);
    let parameters = LayerParameters::uniform(
        unit_face((&theory, thickness)),
        made.mesh.face_count(),
        theory.tangential_stiffness,
        made.mesh.vertex_count(),
    );
    let (rest, free) = (&made.positions, vec![false; made.mesh.vertex_count()]);
    let layer = LayerEnergy::with_bending(
        &made.mesh,
        rest.as_slice(),
        parameters,
        &free,
        BendingModel::VertexCurvature,
    );
    let layer = layer.expect("a valid layer");
    let (starts, rows) = layer.pattern();
    let pattern = LowerPattern::new(starts.to_vec(), rows.to_vec()).expect("a valid pattern");
    let kkt = Kkt::new(&pattern, &ConstraintRows::none(pattern.size()), 3);
    kkt.expect("a valid system").cost()
}
