//! Sheets, fires and clocks for the tests.

#![allow(
    dead_code,
    unreachable_pub,
    reason = "each test file uses a part of this module"
)]

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ruga_burn::{BurnSettings, BurnSolver, BurnState, FieldMesh, FrontCorrection, FrontDesign};
use ruga_mesh::{PerVertex, TriMesh};

pub const SURROUNDINGS: f64 = 300.0;
pub const IGNITION: f64 = 500.0;
/// The heat ratios at which fronts are measured.
pub const HEAT_RATIOS: [f64; 4] = [2.0, 3.43, 5.71, 14.3];

pub struct Sheet {
    pub mesh: TriMesh,
    pub positions: Vec<Vector3<f64>>,
}

impl Sheet {
    pub fn field(&self) -> FieldMesh {
        FieldMesh::new(&self.mesh, &self.positions).unwrap()
    }

    pub fn per_vertex(&self, of: impl Fn(&Vector3<f64>) -> f64) -> PerVertex<f64> {
        self.positions.iter().map(of).collect()
    }
}

/// One row of square cells along x: a sheet in which heat flows in one dimension.
pub fn strip(cells: usize, edge: f64) -> Sheet {
    grid(
        [cells, 1],
        |_| 0,
        |i, j| Vector3::new(i * edge, j * edge, 0.0),
    )
}

/// Square cells, every vertex off the border moved by up to `jitter` edges, diagonals by chance.
pub fn irregular(cells: [usize; 2], edge: f64, jitter: f64, seed: u64) -> Sheet {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut sheet = grid(
        cells,
        |random| random.random_range(0..2),
        |i, j| Vector3::new(i * edge, j * edge, 0.0),
    );
    let size = cells.map(|n| n as f64 * edge);
    for x in &mut sheet.positions {
        for k in 0..2 {
            let shift = jitter * edge * random.random_range(-1.0..1.0);
            // On the border, vertices move along it; corners stay.
            let is_inside = |k: usize| x[k] > 0.5 * edge && x[k] < size[k] - 0.5 * edge;
            if is_inside(k) {
                x[k] += shift;
            }
        }
    }
    sheet
}

/// A rectangle whose inner vertices are those of a jittered square grid that is turned by `angle`.
pub fn turned(size: [f64; 2], edge: f64, angle: f64, seed: u64) -> Sheet {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut points = Vec::new();
    for k in 0..2 {
        let cells = (size[k] / edge).round();
        for i in 0..cells as usize {
            let along = i as f64 / cells * size[k];
            // Anticlockwise, each corner once.
            let sides = [(along, 0.0), (size[k] - along, size[1 - k])];
            points.extend(sides.map(|(x, y)| if k == 0 { [x, y] } else { [size[0] - y, x] }));
        }
    }
    let (sin, cos) = angle.sin_cos();
    let reach = ((size[0] + size[1]) / edge) as i32;
    for i in -reach..reach {
        for j in -reach..reach {
            let [i, j] = [i, j].map(|i| edge * (f64::from(i) + random.random_range(-0.25..0.25)));
            let place = [i * cos - j * sin, i * sin + j * cos];
            let depth = |k: usize| place[k].min(size[k] - place[k]);
            if depth(0) > 0.6 * edge && depth(1) > 0.6 * edge {
                points.push(place);
            }
        }
    }
    let places = points.iter().map(|p| Vector3::new(p[0], p[1], 0.0));
    delaunay(places.collect())
}

/// The Delaunay triangulation of places in the plane.
pub fn delaunay(positions: Vec<Vector3<f64>>) -> Sheet {
    let sites = positions.iter();
    let sites: Vec<_> = sites
        .map(|p| delaunator::Point { x: p.x, y: p.y })
        .collect();
    let corners = delaunator::triangulate(&sites).triangles;
    let faces = corners
        .chunks_exact(3)
        .map(|f| [f[0], f[2], f[1]].map(|v| v as u32));
    Sheet {
        mesh: TriMesh::new(sites.len(), faces.collect()).unwrap(),
        positions,
    }
}

/// A rectangle of irregular cells rolled to a closed tube around the x axis.
pub fn tube(cells: [usize; 2], edge: f64, jitter: f64, seed: u64) -> Sheet {
    let flat = irregular(cells, edge, jitter, seed);
    let around = cells[1] as f64 * edge;
    let radius = around / std::f64::consts::TAU;
    // The last row of vertices becomes the first.
    let row = (cells[0] + 1) as u32;
    let kept = row * cells[1] as u32;
    let faces = flat.mesh.faces().as_slice().iter();
    let faces = faces.map(|f| f.map(|v| if v.0 >= kept { v.0 - kept } else { v.0 }));
    let positions = flat.positions[..kept as usize].iter().map(|x| {
        let (sin, cos) = (x.y / radius).sin_cos();
        Vector3::new(x.x, radius * cos, radius * sin)
    });
    Sheet {
        mesh: TriMesh::new(kept as usize, faces.collect()).unwrap(),
        positions: positions.collect(),
    }
}

fn grid(
    cells: [usize; 2],
    diagonal: impl Fn(&mut Pcg64Mcg) -> u32,
    place: impl Fn(f64, f64) -> Vector3<f64>,
) -> Sheet {
    let mut random = Pcg64Mcg::seed_from_u64(17);
    let row = cells[0] as u32 + 1;
    let mut positions = Vec::new();
    for j in 0..=cells[1] {
        positions.extend((0..=cells[0]).map(|i| place(i as f64, j as f64)));
    }
    let mut faces = Vec::new();
    for j in 0..cells[1] as u32 {
        for i in 0..cells[0] as u32 {
            let a = j * row + i;
            let [b, c, d] = [a + 1, a + row + 1, a + row];
            faces.extend(match diagonal(&mut random) {
                0 => [[a, b, c], [a, c, d]],
                _ => [[a, b, d], [b, c, d]],
            });
        }
    }
    Sheet {
        mesh: TriMesh::new(positions.len(), faces).unwrap(),
        positions,
    }
}

/// A front of speed 1 and width 1 without loss.
pub fn unit_front(heat_ratio: f64) -> FrontDesign {
    FrontDesign {
        speed: 1.0,
        width: 1.0,
        ignition: IGNITION,
        burning: SURROUNDINGS + heat_ratio * (IGNITION - SURROUNDINGS),
        surroundings: SURROUNDINGS,
        loss_time: None,
    }
}

pub fn settings(advance: f64, correction: FrontCorrection) -> BurnSettings {
    BurnSettings {
        advance: Some(advance),
        correction,
    }
}

/// Fresh sheet, except for hot ash where `ahead`, the distance (m) from the fire's edge, is negative.
pub fn lit(sheet: &Sheet, hot: f64, ahead: impl Fn(&Vector3<f64>) -> f64) -> BurnState {
    let pick =
        |ash: f64, fresh: f64| sheet.per_vertex(|x| if ahead(x) < 0.0 { ash } else { fresh });
    BurnState::new(&sheet.field(), pick(hot, SURROUNDINGS), pick(0.0, 1.0)).unwrap()
}

/// Time at which each vertex passed ignition; not a number where it did not.
pub fn crossing_times(
    solver: &mut BurnSolver,
    state: &mut BurnState,
    substep: f64,
    until: f64,
) -> Vec<f64> {
    let mut times = vec![f64::NAN; state.fuel().len()];
    let mut before = state.temperature().clone();
    for k in 0..(until / substep) as usize {
        solver.step(state, &[], substep).unwrap();
        for (v, &now) in state.temperature().iter() {
            let (last, time) = (before[v], &mut times[v.0 as usize]);
            if time.is_nan() && last <= IGNITION && now > IGNITION {
                *time = (k as f64 + (IGNITION - last) / (now - last)) * substep;
            }
        }
        before.clone_from(state.temperature());
    }
    times
}

/// Speed and direction of the plane that fits crossing times best where `is_measured`.
pub fn fitted_speed(
    sheet: &Sheet,
    times: &[f64],
    is_measured: impl Fn(&Vector3<f64>) -> bool,
) -> f64 {
    let (mut square, mut right) = (nalgebra::Matrix3::zeros(), Vector3::zeros());
    for (x, &time) in sheet.positions.iter().zip(times) {
        if is_measured(x) {
            assert!(!time.is_nan(), "the front came by at {x}");
            let row = Vector3::new(x.x, x.y, 1.0);
            square += row * row.transpose();
            right += row * time;
        }
    }
    let fit = square.lu().solve(&right).unwrap();
    1.0 / fit.xy().norm()
}

/// Speed of a front along a strip of cells `edge` (m) wide, by the fuel that it burns between two
/// amounts, given as lengths of the strip (m).
pub fn strip_speed(
    solver: &mut BurnSolver,
    state: &mut BurnState,
    [edge, substep]: [f64; 2],
    between: [f64; 2],
) -> f64 {
    let (mut times, mut burnt, mut time) = (Vec::new(), 0.0, 0.0);
    while times.len() < 2 {
        let report = solver.step(state, &[], substep).unwrap();
        assert!(time < 1e3, "the front moves");
        let length = report.burnt / edge;
        (burnt, time) = (burnt + length, time + substep);
        let mark = between[times.len()];
        if burnt >= mark {
            times.push(time - substep * (burnt - mark) / length);
        }
    }
    (between[1] - between[0]) / (times[1] - times[0])
}
