//! Slits in a block.

use std::collections::BTreeSet;

use nalgebra::Vector3;
use ruga_blend::BaseSurface;
use ruga_crease::{Corners, CreaseMemory, Drive, LineInput, LineLaw, LineTracer};
use ruga_lattice::{LatticeEnergy, LatticeObjective, Shape, SolidMaterial};
use ruga_mesh::VertexId;
use ruga_shell::FoldSense;
use ruga_solver::{ConstraintRows, Kkt, NewtonSettings, Objective, minimise};

use super::*;
use crate::support::embedding_lattice::lips::Lip;
use crate::test_drivers::{SIDES, block, knuckle};

fn body(shape: Shape) -> Body {
    Body {
        cells: Some(CELLS),
        shape,
        material: SolidMaterial {
            young: 5e4,
            poisson: 0.4,
        },
        density: 900.0,
        gravity: Vector3::zeros(),
        handles: Vec::new(),
        obstacles: Vec::new(),
        follow: None,
    }
}

/// A way over the top, in shares of its length and width.
type Way = [[f64; 2]; 2];

/// Where lines cross the block, in shares of its length: in the middle of a cell.
const LINE: f64 = 0.565;

/// Across the block, from a share of its width to the other end.
fn across(from: f64) -> Way {
    [[LINE, from], [LINE, 1.0 - from]]
}

/// Cells of 2.5 mm: 8 x 6 x 4 of them.
const CELLS: u32 = 8;
const CELL: f64 = 2.5e-3;

/// A layer with slits below lines over the top.
fn slitted(driver: &Driver, ways: &[Way], depth: f64) -> LayerSpec {
    let mut spec = knuckle();
    let tracer = LineTracer::new(driver.topology(), driver.rest());
    for way in ways {
        let points = way.map(|[x, y]| Vector3::new(x * SIDES[0], y * SIDES[1], SIDES[2]));
        let line = tracer.trace(&LineInput::Positions {
            points: points.to_vec(),
            is_closed: false,
            reach: 1e-4,
            corners: Corners::Keep,
        });
        spec.creases.push(CreaseSpec {
            name: format!("line {}", spec.creases.len()),
            line: line.expect("a line on the top"),
            law: LineLaw {
                width: 1e-3,
                stiffness: 0.1,
                angle: 0.0,
                fade: [0.0; 2],
            },
            is_ridge: false,
            sense: FoldSense::Both,
            drive: Drive::Load,
            anchor: None,
            slit: Some(depth),
            memory: CreaseMemory::default(),
            absorbs: false,
        });
    }
    spec
}

fn whole(shape: Shape) -> EmbeddingLattice {
    let lattice = EmbeddingLattice::new(&block(), &body(shape), 1e-3, Smoothing::None);
    lattice.expect("a block")
}

/// The block with the slits of a layer.
fn cut(shape: Shape, layer: LayerSpec) -> Result<EmbeddingLattice, StepperError> {
    let driver = block();
    let plain = whole(shape);
    let flesh = [plain.flesh_below(&driver, &layer.creases)];
    let on = (driver.as_ref(), Smoothing::None);
    plain.with_slits(on, &body(shape), &[layer], &flesh)
}

fn cut_along(shape: Shape, ways: &[Way], depth: f64) -> Result<EmbeddingLattice, StepperError> {
    cut(shape, slitted(&block(), ways, depth))
}

/// Nodes of a block that stands on its bottom, two places of whose top a force (N) draws apart, half a cell to either
/// side of the line in its middle; and how far they have moved apart (m).
fn drawn_apart(lattice: &Lattice, force: f64) -> (Vec<Vector3<f64>>, f64) {
    let rest = lattice.rest_positions();
    let pinned: Vec<bool> = rest.iter().map(|q| q.z < 0.0).collect();
    let material = body(Shape::Quadratic).material;
    let energy = LatticeEnergy::new(lattice, &material, &pinned).expect("a lattice");
    let place = |way: f64| Vector3::new(LINE * SIDES[0] + way, 0.5 * SIDES[1], SIDES[2]);
    let places = [-0.5, 0.5].map(|cells| place(cells * CELL));
    let points = lattice.locate_near(&places).expect("places");
    let places = Embedding::of_lattice_points(lattice, &points, &[Vector3::z(); 2]);
    let places = places.expect("two places");
    let load = places.pull_back(&[-Vector3::x() * force, Vector3::x() * force]);
    let objective = LatticeObjective::new(&energy, rest, &load, CELL).expect("one load per node");
    let mut unknowns = energy.unknowns(rest);
    let rows = ConstraintRows::new(vec![0], Vec::new(), Vec::new(), unknowns.len());
    let mut kkt = Kkt::new(objective.pattern(), &rows.expect("no rows"), 3).expect("a pattern");
    let settings = NewtonSettings::default();
    let solved = minimise(
        &objective,
        &[],
        &mut unknowns,
        &mut kkt,
        &settings,
        &mut |_| true,
    );
    assert!(solved.expect("a solvable load").converged);
    let q = objective.nodes(&unknowns);
    let moved = places.positions(&q);
    let apart = (moved[1] - moved[0]).x - CELL;
    (q, apart)
}

/// A slit of one and a half cells, with whole cells between its ends.
#[test]
fn a_slit_takes_away_what_holds_its_sides_together() {
    let depth = 1.5 * CELL;
    for (shape, expected) in [(Shape::Quadratic, 0.245), (Shape::Linear, 0.42)] {
        let whole = whole(shape).lattice;
        let cut = cut_along(shape, &[across(0.05)], depth)
            .expect("a slit")
            .lattice;
        assert!((cut.volume() / whole.volume() - 1.0).abs() < 1e-4);
        // Four cells across are parted, those of the ends are not.
        assert_eq!(cut.element_count(), whole.element_count() + 4);
        let [before, after] = [&whole, &cut].map(|lattice| 1.0 / drawn_apart(lattice, 1e-4).1);
        let left = after / before;
        println!("{shape:?}: {left:.3} of the stiffness is left");
        assert!((left - expected).abs() < 0.02, "{shape:?}: {left}");
    }
}

/// The layer's vertices go with the flesh on their side, and those on the line all with the left.
#[test]
fn a_layer_lies_on_both_sides_of_a_slit() {
    let driver = block();
    let lattice = cut_along(Shape::Quadratic, &[across(0.05)], 1.5 * CELL).expect("a slit");
    let (q, _) = drawn_apart(&lattice.lattice, 1e-3);
    let tracer = LineTracer::new(driver.topology(), driver.rest());
    for (beside, side) in [(-2e-4, -1.0), (0.0, -1.0), (2e-4, 1.0)] {
        let ends = [0.4, 0.6].map(|y| {
            let x = LINE * SIDES[0] + beside;
            Vector3::new(x, y * SIDES[1], SIDES[2])
        });
        let line = tracer.trace(&LineInput::Positions {
            points: ends.to_vec(),
            is_closed: false,
            reach: 1e-4,
            corners: Corners::Keep,
        });
        let line = line.expect("a line on the top");
        let places: Vec<MaterialPoint> = (0..=20)
            .filter_map(|i| line.place(line.length() * f64::from(i) / 20.0))
            .collect();
        let rest = SurfacePoints::new(&driver, places.clone(), Smoothing::None).pose(driver.rest());
        let embedded = lattice.embed(&places, &rest).expect("places");
        for (now, rest) in embedded.positions(&q).iter().zip(&rest.positions) {
            // Across is the left of a line that runs from the front to the back.
            let moved = (now - rest).x * side;
            assert!(moved > 1e-6, "{beside}: {moved:e}");
        }
    }
}

/// Pressed together the walls overlap, drawn apart they do not.
#[test]
fn the_overlap_of_walls_is_measured() {
    let lattice = cut_along(Shape::Quadratic, &[across(0.05)], 1.5 * CELL).expect("a slit");
    let (open, _) = drawn_apart(&lattice.lattice, 1e-3);
    let (pressed, together) = drawn_apart(&lattice.lattice, -1e-3);
    assert_eq!(lattice.slit_overlap(&open), None);
    let (overlap, crease) = lattice.slit_overlap(&pressed).expect("they overlap");
    assert_eq!(crease, "line 0");
    println!("{overlap:e} of {together:e}");
    assert!(
        overlap > -0.2 * together && overlap < -1.2 * together,
        "{overlap:e} {together:e}"
    );
    let whole = whole(Shape::Quadratic);
    assert_eq!(whole.slit_overlap(whole.lattice.rest_positions()), None);
}

#[test]
fn slits_that_cannot_be_are_refused() {
    let refused = |ways: &[Way], depth: f64| {
        let error = cut_along(Shape::Quadratic, ways, depth).expect_err("an error");
        error.to_string()
    };
    let says = |text: String, parts: &[&str]| {
        let mut rest = text.as_str();
        for part in parts {
            let at = rest.find(part);
            assert!(at.is_some(), "{text} lacks {part}");
            rest = &rest[at.unwrap_or_default()..];
        }
    };
    let line = across(0.05);
    let names = "layer 'skin', crease 'line 0': `slit` is";
    let shallow = [
        "0.00125 m",
        "at least 2.50 mm, the size of a cell",
        "`cells = 16`",
    ];
    says(
        refused(&[line], 0.5 * CELL),
        &[&[names][..], &shallow].concat(),
    );
    says(
        refused(&[line], 0.02),
        &[names, "0.02 m", "less than 10.00 mm, the depth of the body"],
    );
    says(
        refused(&[across(0.3)], 0.005),
        &[names, "0.005 m, but nothing can open it", "three cells"],
    );
    // Beside one that opens.
    let short = [[0.2, 0.4], [0.2, 0.6]];
    says(
        refused(&[line, short], 0.005),
        &["crease 'line 1': `slit` is", "nothing can open it"],
    );
    let along = [[0.3, 0.52], [0.8, 0.52]];
    says(
        refused(&[line, along], 0.004),
        &[
            "crease 'line 1': `slit` is",
            "one that meets that of crease 'line 0'",
        ],
    );
    let anchor = |depth: f64| {
        let mut layer = slitted(&block(), &[line], 1.5 * CELL);
        let stiffness = 20.0;
        layer.creases[0].anchor = Some(crate::CreaseAnchor { depth, stiffness });
        cut(Shape::Quadratic, layer)
            .err()
            .map(|error| error.to_string())
    };
    says(
        anchor(3e-3).expect("an error"),
        &[
            "crease 'line 0': `anchor.depth` is 0.003 m",
            "more than 0.00375 m",
        ],
    );
    assert_eq!(anchor(5e-3), None);
}

/// Up the front, over the top and down the back, round two sharp edges.
#[test]
fn a_slit_that_runs_into_itself_is_refused() {
    let driver = block();
    let tracer = LineTracer::new(driver.topology(), driver.rest());
    let low = 0.3 * SIDES[2];
    let [width, high] = [SIDES[1], SIDES[2]];
    let top = [[0.0, high], [0.5 * width, high], [width, high]];
    let points = [&[[0.0, low]], &top[..], &[[width, low]]].concat();
    let line = tracer.trace(&LineInput::Positions {
        points: (points.iter())
            .map(|[y, z]| Vector3::new(LINE * SIDES[0], *y, *z))
            .collect(),
        is_closed: false,
        reach: 1e-4,
        corners: Corners::Keep,
    });
    let line = line.expect("a line over both edges");
    let built = |depth: f64| {
        let mut layer = slitted(&driver, &[across(0.05)], depth);
        layer.creases[0].line = line.clone();
        cut(Shape::Quadratic, layer)
            .err()
            .map(|error| error.to_string())
    };
    let text = built(1.5 * CELL).expect("an error");
    assert!(
        text.contains("crease 'line 0': `slit` is 0.00375 m"),
        "{text}"
    );
    assert!(text.contains("its walls run into each other"), "{text}");
}

/// On a smooth body, whose normals turn along every line; cuts of half of its depth.
#[test]
fn smooth_bodies_are_cut_along_lines_any_way() {
    let driver = block();
    let plain = EmbeddingLattice::new(&driver, &body(Shape::Linear), 1e-3, Smoothing::Loop);
    let plain = plain.expect("a smooth block");
    let ways = [
        [[0.55, 0.2], [0.55, 0.8]],
        [[0.3, 0.25], [0.7, 0.75]],
        [[0.2, 0.48], [0.8, 0.52]],
        [[0.34, 0.7], [0.61, 0.21]],
    ];
    for way in ways {
        let layer = slitted(&driver, &[way], 4e-3);
        let flesh = [plain.flesh_below(&driver, &layer.creases)];
        let on = (driver.as_ref(), Smoothing::Loop);
        let cut = plain
            .clone()
            .with_slits(on, &body(Shape::Linear), &[layer], &flesh);
        let lattice = cut
            .unwrap_or_else(|error| panic!("{way:?}: {error}"))
            .lattice;
        assert!((lattice.volume() / plain.lattice.volume() - 1.0).abs() < 1e-3);
    }
}

/// Another mesh of the same surface follows the line by other chords. What is on the line goes with the left all the
/// same, and what is beside it with its own side, however much the line bends and turns between the edges.
#[test]
fn other_meshes_lie_on_the_same_lips() {
    let driver = block();
    let plain = EmbeddingLattice::new(&driver, &body(Shape::Linear), 1e-3, Smoothing::Loop);
    let plain = plain.expect("a smooth block");
    let faces: Vec<FaceId> = driver.topology().faces().ids().collect();
    let tracer = LineTracer::new(driver.topology(), driver.rest());
    let arc = |turn: f64| {
        let (sin, cos) = turn.sin_cos();
        [0.5 + 0.23 * cos, 0.55 + 0.3 * sin]
    };
    let half_ring: Vec<_> = (-12..=12).map(|i| arc(f64::from(i) / 8.0)).collect();
    for way in [
        vec![[0.3, 0.25], [0.5, 0.45], [0.7, 0.75]],
        vec![[0.3, 0.25], [0.48, 0.52], [0.7, 0.3]],
        // Along edges of the driver.
        vec![[0.2, 0.5], [0.5, 0.5], [0.8, 0.5]],
        half_ring,
    ] {
        let mut layer = slitted(&driver, &[across(0.05)], 4e-3);
        let points = way.iter();
        let points = points.map(|[x, y]| Vector3::new(x * SIDES[0], y * SIDES[1], SIDES[2]));
        let line = tracer.trace(&LineInput::Positions {
            points: points.collect(),
            is_closed: false,
            reach: 1e-4,
            corners: Corners::Round,
        });
        layer.creases[0].line = line.expect("a line on the top");
        let flesh = [plain.flesh_below(&driver, &layer.creases)];
        let on = (driver.as_ref(), Smoothing::Loop);
        let cut = plain.clone();
        let cut = cut.with_slits(on, &body(Shape::Linear), &[layer.clone()], &flesh);
        let cut = cut.unwrap_or_else(|error| panic!("{way:?}: {error}"));
        let lips = cut.faces.lips.as_ref().expect("a slit");
        for levels in 2..=6 {
            let other = BaseSurface::new(&driver, &faces, levels, Smoothing::Loop);
            let other = cut_along_creases(&driver, &layer.creases, Cut::none(Piece::of(&other)));
            let mesh = &other.piece.mesh;
            let length = layer.creases[0].line.length();
            let ends = |crease: &CreaseEdge| mesh.edges()[crease.edge].vertices;
            let on_line: BTreeSet<VertexId> = other.creases.iter().flat_map(ends).collect();
            let is_across = |v: VertexId, lip: Lip| {
                let address = cut.address(&other.piece.points[v.index()]);
                lips.is_across(address.face, lip)
            };
            // The slit runs out where it ends.
            let inside = other.creases.iter().filter(|crease| {
                let [from, to] = crease.at;
                from.min(to).min(length - from.max(to)) > 0.1 * length
            });
            let (mut count, mut across) = (0, [0; 2]);
            for crease in inside {
                count += 1;
                let own = ends(crease);
                across[0] += own.iter().filter(|v| is_across(**v, Lip::Left)).count();
                let is_along = crease.at[0] < crease.at[1];
                for (side, face) in mesh.edges()[crease.edge].faces.into_iter().enumerate() {
                    let corners = mesh.faces()[face.expect("an edge inside")];
                    let apex = corners.into_iter().filter(|v| !on_line.contains(v));
                    let lip = if (side == 0) == is_along {
                        Lip::Left
                    } else {
                        Lip::Right
                    };
                    across[1] += apex.filter(|v| is_across(*v, lip)).count();
                }
            }
            assert!(
                count > 1 && across == [0; 2],
                "{way:?}, {levels}: {across:?} of {count}"
            );
        }
    }
}

/// A closed line cuts a plug out of the top.
#[test]
fn a_closed_line_cuts_all_around() {
    let driver = block();
    let mut layer = slitted(&driver, &[across(0.05)], 1.5 * CELL);
    let tracer = LineTracer::new(driver.topology(), driver.rest());
    let corners = [[0.2, 0.2], [0.8, 0.2], [0.8, 0.8], [0.2, 0.8]];
    let line = tracer.trace(&LineInput::Positions {
        points: corners
            .map(|[x, y]| Vector3::new(x * SIDES[0], y * SIDES[1], SIDES[2]))
            .to_vec(),
        is_closed: true,
        reach: 1e-4,
        corners: Corners::Keep,
    });
    layer.creases[0].line = line.expect("a line on the top");
    let whole = whole(Shape::Quadratic).lattice;
    let cut = cut(Shape::Quadratic, layer).expect("a slit").lattice;
    assert!(cut.element_count() > whole.element_count() + 8);
    assert!((cut.volume() / whole.volume() - 1.0).abs() < 1e-3);
}
