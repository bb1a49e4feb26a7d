//! Creases of stars and hinges: derivatives, invariance, one-sidedness, and what they must leave alone.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

#[path = "../differences/mod.rs"]
mod differences;
#[path = "../meshes/mod.rs"]
mod meshes;

mod line_anchors;
mod refusals;

use differences::{MODELS, check_layer, dense};
use meshes::{jittered, random_rotation, random_vector, rng};
use nalgebra::{DVector, Vector3};
use ruga_mesh::{EdgeId, TriMesh};
use ruga_shell::{
    BendingModel, Crease, FaceParameters, FoldSense, LayerEnergy, LayerParameters, LineAnchor,
    PartIndex,
};

const COLUMNS: u32 = 7;
const ROWS: u32 = 6;

/// Paths of vertices, each (column, row), on the lattice that [`mesh`] jitters.
type Lines = &'static [&'static [(u32, u32)]];

const THROUGH: Lines = &[&[(0, 2), (1, 2), (2, 2), (3, 2), (4, 2), (5, 2), (6, 2)]];
const ENDS_INSIDE: Lines = &[&[(2, 2), (3, 2), (4, 2)]];
const KINK: Lines = &[&[(1, 2), (2, 2), (3, 2), (3, 3), (3, 4)]];
const OF_THREE: Lines = &[&[(1, 2), (2, 2), (3, 2), (4, 2)], &[(3, 2), (3, 3), (3, 4)]];
const OF_FOUR: Lines = &[
    &[(1, 2), (2, 2), (3, 2), (4, 2)],
    &[(2, 1), (3, 2), (3, 3), (3, 4)],
];
const FAN: Lines = &[
    &[(3, 2), (4, 2)],
    &[(3, 2), (3, 3)],
    &[(3, 2), (2, 3)],
    &[(3, 2), (2, 2)],
    &[(3, 2), (2, 1)],
    &[(3, 2), (3, 1)],
];
const ALL: [Lines; 6] = [THROUGH, ENDS_INSIDE, KINK, OF_THREE, OF_FOUR, FAN];

fn mesh() -> (TriMesh, Vec<Vector3<f64>>) {
    let mesh = jittered(COLUMNS as usize, ROWS as usize, 1.0, 0.2, 11);
    (mesh.topology(), mesh.positions)
}

/// The edge between two vertices of a mesh.
fn edge(mesh: &TriMesh, ends: [u32; 2]) -> EdgeId {
    let mut edges = mesh.edges().iter();
    let found = edges.find(|(_, edge)| {
        let vertices = edge.vertices.map(|v| v.0);
        vertices == ends || vertices == [ends[1], ends[0]]
    });
    found.expect("neighbours").0
}

fn edges(mesh: &TriMesh, lines: Lines) -> Vec<EdgeId> {
    let vertex = |(column, row): (u32, u32)| row * COLUMNS + column;
    let pairs = lines.iter().flat_map(|line| line.windows(2));
    pairs
        .map(|pair| edge(mesh, [vertex(pair[0]), vertex(pair[1])]))
        .collect()
}

fn layer(model: BendingModel) -> LayerEnergy {
    let (mesh, rest) = mesh();
    let face = FaceParameters {
        young: 8.0,
        poisson: 0.4,
        thickness: 0.6,
        normal_stiffness: 0.1,
        gradient_stiffness: 0.05,
    };
    let parameters = LayerParameters::uniform(face, mesh.face_count(), 0.2, rest.len());
    let pinned = vec![false; rest.len()];
    LayerEnergy::with_bending(&mesh, &rest, parameters, &pinned, model).unwrap()
}

/// A layer with creases of unequal compliance and rest angle on these lines.
fn creased(model: BendingModel, lines: Lines, sense: FoldSense) -> LayerEnergy {
    let sign = match sense {
        FoldSense::Mountain => -1.0,
        _ => 1.0,
    };
    let mut layer = layer(model);
    let on = edges(&mesh().0, lines).into_iter().zip(0..);
    let creases = on.map(|(edge, i)| {
        let crease = Crease {
            compliance: 3.0 + 2.0 * f64::from(i % 3),
            rest_angle: sign * (0.1 + 0.05 * f64::from(i % 2)),
            sense,
        };
        (edge, crease)
    });
    layer.set_creases(&creases.collect::<Vec<_>>()).unwrap();
    layer
}

/// A bowl (positive) or dome about the middle of the lattice, shaken.
fn bowl(depth: f64, seed: u64) -> Vec<Vector3<f64>> {
    let mut rng = rng(seed);
    let (_, rest) = mesh();
    let middle = Vector3::new(3.2, 2.2, 0.0);
    let bent = rest.iter().map(|p| {
        let height = depth * (p - middle).norm_squared();
        0.97 * p + Vector3::z() * height + 0.04 * random_vector(&mut rng)
    });
    bent.collect()
}

fn hessians(layer: &LayerEnergy, x: &[Vector3<f64>]) -> [Vec<f64>; 2] {
    let mut exact = vec![0.0; layer.pattern().1.len()];
    let mut relaxed = exact.clone();
    layer.hessian(x, &mut exact, Some(&mut relaxed));
    [exact, relaxed]
}

#[test]
fn derivatives_match_differences_where_lines_pass_end_turn_and_meet() {
    for model in MODELS {
        for (seed, lines) in (0..).zip(ALL) {
            check_layer(&creased(model, lines, FoldSense::Both), &bowl(0.1, seed));
        }
    }
}

#[test]
fn derivatives_match_differences_on_either_side_of_the_switch() {
    for model in MODELS {
        for (seed, lines) in (10..).zip(ALL) {
            for (sense, depth) in [(FoldSense::Valley, 0.1), (FoldSense::Mountain, -0.1)] {
                let layer = creased(model, lines, sense);
                for (depth, is_open) in [(depth, true), (-3.0 * depth, false)] {
                    let x = bowl(depth, seed);
                    let states = layer.crease_states(&x);
                    let folded = states.iter().filter(|state| state.angle != 0.0).count();
                    // Where lines meet, those that shut leave one or two a little open.
                    let all = states.len();
                    assert!(if is_open {
                        folded == all
                    } else {
                        2 * folded <= all
                    });
                    check_layer(&layer, &x);
                }
            }
        }
    }
}

/// At a switch, found to all digits, the gradients on its two sides are one.
#[test]
fn the_gradient_is_continuous_where_a_crease_shuts() {
    for model in MODELS {
        let layer = creased(model, OF_FOUR, FoldSense::Valley);
        let (open, shut) = (bowl(0.1, 7), bowl(-0.3, 7));
        let between = |share: f64| -> Vec<_> {
            let pairs = open.iter().zip(&shut);
            pairs.map(|(a, b)| a.lerp(b, share)).collect()
        };
        let folded = |share: f64| {
            let states = layer.crease_states(&between(share));
            states.iter().filter(|state| state.angle != 0.0).count()
        };
        let gradient = |share: f64| {
            let mut gradient = vec![0.0; layer.dof_count()];
            layer.gradient(&between(share), &mut gradient);
            DVector::from_vec(gradient)
        };
        let way = (gradient(1.0) - gradient(0.0)).norm();
        let mut switches = 0;
        for i in 0..100 {
            let [mut low, mut high] = [i, i + 1].map(|i| f64::from(i) / 100.0);
            let before = folded(low);
            if folded(high) == before {
                continue;
            }
            while high - low > 1e-12 {
                let middle = 0.5 * (low + high);
                if folded(middle) == before {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let step = (gradient(high) - gradient(low)).norm();
            assert!(step < 1e-6 * way, "{model:?} at {low}: {step} of {way}");
            switches += 1;
        }
        assert!(switches > 2, "{switches}");
    }
}

#[test]
fn gauss_newton_is_positive_and_rigid_motions_cost_nothing() {
    for model in MODELS {
        for lines in ALL {
            for sense in [FoldSense::Both, FoldSense::Valley] {
                let layer = creased(model, lines, sense);
                let x = bowl(0.1, 3);
                let [_, relaxed] = hessians(&layer, &x);
                let values = dense(layer.pattern(), &relaxed).symmetric_eigenvalues();
                assert!(values.min() > -1e-12 * values.max());

                let turn = random_rotation(&mut rng(4));
                let moved: Vec<_> = x
                    .iter()
                    .map(|p| turn * p + Vector3::new(3.0, -2.0, 5.0))
                    .collect();
                let [before, after] = [&x, &moved].map(|x| layer.energy_parts(x).bending);
                assert!((after / before - 1.0).abs() < 1e-12);
            }
        }
    }
}

/// Neither compliance nor rest angle: not a bit changes.
#[test]
fn a_crease_as_stiff_as_the_layer_changes_nothing() {
    for model in MODELS {
        let plain = layer(model);
        let mut creased = plain.clone();
        let crease = Crease {
            compliance: Crease::strip_compliance(0.3, 1.0, 0.1),
            rest_angle: 0.0,
            sense: FoldSense::Valley,
        };
        let on = edges(&mesh().0, OF_THREE).into_iter();
        creased
            .set_creases(&on.map(|edge| (edge, crease)).collect::<Vec<_>>())
            .unwrap();
        let x = bowl(0.1, 5);
        assert_eq!(plain.value(&x), creased.value(&x));
        let gradient = |layer: &LayerEnergy| {
            let mut gradient = vec![0.0; layer.dof_count()];
            layer.gradient(&x, &mut gradient);
            gradient
        };
        assert_eq!(gradient(&plain), gradient(&creased));
        assert_eq!(hessians(&plain, &x), hessians(&creased, &x));
    }
}

/// The energy is the least over all fold angles, found here by trying.
#[test]
fn a_fold_takes_the_angle_of_least_energy() {
    // Two squares that share an edge along y: both end stars are open and have the edge alone.
    let rest: Vec<_> = [-1.0, 0.0, 1.0]
        .into_iter()
        .flat_map(|x| [Vector3::new(x, 0.0, 0.0), Vector3::new(x, 1.0, 0.0)])
        .collect();
    let faces = vec![[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]];
    let mesh = TriMesh::new(6, faces).unwrap();
    let face = FaceParameters {
        young: 10.0,
        poisson: 0.0,
        thickness: 0.5,
        normal_stiffness: 0.0,
        gradient_stiffness: 0.0,
    };
    let on = edge(&mesh, [2, 3]);
    for model in MODELS {
        let parameters = LayerParameters::uniform(face, 4, 0.0, 6);
        let mut layer =
            LayerEnergy::with_bending(&mesh, &rest, parameters, &[false; 6], model).unwrap();
        let crease = Crease {
            compliance: 20.0,
            rest_angle: 0.4,
            sense: FoldSense::Valley,
        };
        let plain = layer.clone();
        layer.set_creases(&[(on, crease)]).unwrap();
        let bending = |layer: &LayerEnergy, valley: f64| {
            let up = |p: &Vector3<f64>| match p.x > 0.0 {
                true => Vector3::new(valley.cos() * p.x, p.y, valley.sin() * p.x),
                false => *p,
            };
            let x: Vec<_> = rest.iter().map(up).collect();
            let state = layer.crease_states(&x);
            (layer.energy_parts(&x).bending, state)
        };
        for valley in [0.0, 0.4, 0.9, -0.3, -1.0] {
            // The edge is one metre long.
            let trial = |phi: f64| bending(&plain, valley - phi).0 + (phi - 0.4).powi(2) / 40.0;
            let tried = (0..=20_000).map(|i| trial(f64::from(i) * 1e-4));
            let least = tried.fold(f64::INFINITY, f64::min);
            let (found, state) = bending(&layer, valley);
            assert!(
                (found - least).abs() < 1e-7,
                "{model:?} {valley}: {found} {least}"
            );
            assert!((trial(state[0].angle) - found).abs() < 1e-12, "{state:?}");
            assert!(state[0].angle >= 0.0);
        }
    }
}

#[test]
fn extremes_stay_finite() {
    for model in MODELS {
        for compliance in [0.0, 1e-300, 1e-9, 1e9, 1e300, f64::INFINITY] {
            for rest_angle in [0.0, 1e-9, 3.1] {
                let mut layer = layer(model);
                let crease = Crease {
                    compliance,
                    rest_angle,
                    sense: FoldSense::Valley,
                };
                let on = edges(&mesh().0, FAN)
                    .into_iter()
                    .chain(edges(&mesh().0, &[&[(0, 3), (1, 3)]]));
                layer
                    .set_creases(&on.map(|edge| (edge, crease)).collect::<Vec<_>>())
                    .unwrap();
                for x in [bowl(0.1, 1), bowl(-3.0, 1), vec![Vector3::zeros(); 42]] {
                    let mut gradient = vec![0.0; layer.dof_count()];
                    layer.gradient(&x, &mut gradient);
                    let [exact, relaxed] = hessians(&layer, &x);
                    let states = layer.crease_states(&x);
                    let states = states.iter().flat_map(|s| [&s.angle, &s.energy]);
                    let all = gradient.iter().chain(&exact).chain(&relaxed).chain(states);
                    assert!(all.chain([&layer.value(&x)]).all(|v| v.is_finite()));
                }
            }
        }
    }
}

#[test]
fn a_part_of_a_creased_layer_has_its_forces() {
    for model in MODELS {
        let mut whole = creased(model, OF_FOUR, FoldSense::Valley);
        whole.set_line_anchors(&anchors()).unwrap();
        let x = bowl(0.1, 8);
        let free: Vec<u32> = (8..30).collect();
        let part = PartIndex::new(&whole).unwrap().part(&whole, &free);
        let local: Vec<_> = part.vertices().iter().map(|&v| x[v as usize]).collect();
        let mut gradient = vec![0.0; whole.dof_count()];
        whole.gradient(&x, &mut gradient);
        let mut of_part = vec![0.0; part.energy().dof_count()];
        part.energy().gradient(&local, &mut of_part);
        assert_eq!(of_part, gradient[3 * 8..3 * 30]);
    }
}

/// Against a base that balances all but creases and anchors, a valley sinks and folds.
#[test]
fn a_crease_folds_at_the_base_that_balances_the_layer_without_it() {
    let (_, rest) = mesh();
    for model in MODELS {
        // Stressed on its base, so that the balance is not zero.
        let base: Vec<_> = rest.iter().map(|p| 0.97 * p).collect();
        let mut plain = layer(model);
        let (normals, offsets) = (vec![Vector3::z(); rest.len()], vec![0.0; rest.len()]);
        plain.set_base(&base, &normals, &offsets).unwrap();
        let gradient = |layer: &LayerEnergy, x: &[Vector3<f64>]| {
            let mut gradient = vec![0.0; layer.dof_count()];
            layer.gradient(x, &mut gradient);
            DVector::from_vec(gradient)
        };
        let reaction = gradient(&plain, &base);
        assert!(reaction.amax() > 1e-3);
        let creases = edges(&mesh().0, THROUGH).into_iter().map(|edge| {
            let crease = Crease {
                compliance: 3.0,
                rest_angle: 0.5,
                sense: FoldSense::Valley,
            };
            (edge, crease)
        });
        let mut creased = plain.clone();
        creased.set_creases(&creases.collect::<Vec<_>>()).unwrap();
        creased.set_line_anchors(&anchors()).unwrap();
        assert_eq!(gradient(&creased.without_creases(), &base), reaction);

        // What is left of the forces at the base sinks the line and folds it.
        let force = &reaction - gradient(&creased, &base);
        let down = |column: u32| -force[3 * (2 * COLUMNS + column) as usize + 2];
        assert!((1..6).all(|column| down(column) > 1e-3));
        let moved = base.iter().zip(force.as_slice().chunks_exact(3));
        let moved: Vec<_> = moved
            .map(|(p, force)| p + Vector3::from_column_slice(force) * 1e-2)
            .collect();
        let [before, after] = [&base, &moved].map(|x| creased.crease_states(x));
        assert!(before.iter().zip(&after).all(|(a, b)| b.angle > a.angle));
    }
}

fn anchors() -> Vec<LineAnchor> {
    let on = edges(&mesh().0, THROUGH).into_iter().zip(0..);
    let anchor = |(edge, i)| LineAnchor {
        edge,
        stiffness: 0.5,
        depths: [0.1 * f64::from(i), 0.1 * f64::from(i + 1)],
    };
    on.map(anchor).collect()
}
