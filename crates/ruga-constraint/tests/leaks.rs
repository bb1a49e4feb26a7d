//! Supports end at slits and don't pass through thin fingers.

mod meshes;

use meshes::{Patch, equilateral_rectangle};
use nalgebra::Vector3;
use ruga_constraint::{Kernel, Sampling};
use ruga_mesh::{FaceId, Id, MaterialPoint, VertexId};

const SAMPLINGS: [Sampling; 3] = [Sampling::Area, Sampling::Adjusted, Sampling::Quadrature];

/// A square of quads with half as long edges in x, cut open along x = 0 for y < `tip`.
///
/// Vertices on the cut are doubled; the copies belong to the faces at x > 0.
fn slit_square(cells: usize, tip: f64) -> Patch {
    let step = 2.0 / cells as f64;
    let mut positions = Vec::new();
    for row in 0..=cells {
        for column in 0..=cells {
            let place = [column, row].map(|i| i as f64 * step - 1.0);
            positions.push(Vector3::new(place[0], place[1], 0.0));
        }
    }
    let stride = cells as u32 + 1;
    let mut copies = vec![None; positions.len()];
    for row in 0..=cells {
        let vertex = row * (cells + 1) + cells / 2;
        if positions[vertex].y < tip {
            copies[vertex] = Some(positions.len() as u32);
            positions.push(positions[vertex]);
        }
    }
    let mut faces = Vec::new();
    for row in 0..cells as u32 {
        for column in 0..cells as u32 {
            let a = row * stride + column;
            let corners = [a, a + 1, a + stride + 1, a + stride].map(|v| {
                let copy = copies[v as usize].filter(|_| column as usize >= cells / 2);
                copy.unwrap_or(v)
            });
            let [a, b, c, d] = corners;
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    Patch::new(positions, faces)
}

#[test]
fn nothing_crosses_a_slit() {
    let kernel = Kernel {
        sigma: 0.2,
        cut: 2.0,
    };
    // The slit runs through the whole support, and ends inside it.
    for tip in [2.0, 0.2] {
        let patch = slit_square(40, tip);
        let centre = patch.vertex_near(Vector3::new(-0.1, 0.0, 0.0));
        let origin = patch.positions[centre.index()];
        // Beyond the slit the centre sees what lies above the line through the tip.
        let slope = (tip - origin.y) / -origin.x;
        for sampling in SAMPLINGS {
            let set = patch.rows(&[centre], kernel, sampling);
            let beyond = set.rows[0].weights.iter().filter(|(v, _)| {
                let p = patch.positions[v.index()];
                let is_hidden = p.x > 0.051 && p.y < origin.y + slope * (p.x - origin.x) - 0.1;
                // Copies on the slit hang on faces on the other side.
                is_hidden || (v.index() >= 41 * 41 && p.y < tip - 0.051)
            });
            let leaked: f64 = beyond.map(|pair| pair.1).sum();
            assert_eq!(leaked, 0.0, "{sampling:?}, tip at {tip}");
            let sum: f64 = set.rows[0].weights.iter().map(|pair| pair.1).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn both_lips_of_a_slit_are_served_alike() {
    let kernel = Kernel {
        sigma: 0.2,
        cut: 2.0,
    };
    let patch = slit_square(40, 2.0);
    for sampling in SAMPLINGS {
        // A vertex on the slit and its copy see one half of the square each.
        let own = patch.vertex_near(Vector3::zeros());
        let copy = VertexId(41 * 41 + 20);
        assert_eq!(patch.positions[own.index()], patch.positions[copy.index()]);
        let set = patch.rows(&[own, copy], kernel, sampling);
        let mean_x = |row: usize| -> f64 {
            let weights = &set.rows[row].weights;
            weights
                .iter()
                .map(|(v, w)| w * patch.positions[v.index()].x)
                .sum()
        };
        assert!(mean_x(0) < -0.05 && mean_x(1) > 0.05, "{sampling:?}");
        assert!((mean_x(0) + mean_x(1)).abs() < 1e-3, "{sampling:?}");
    }
}

#[test]
fn a_centre_on_a_lip_or_as_good_as_on_it_sees_one_side_of_the_slit() {
    let patch = slit_square(40, 2.0);
    let is_on_slit = |v: VertexId| patch.positions[v.index()].x.abs() < 1e-9;
    let is_left = |v: VertexId| v.index() < 41 * 41 && patch.positions[v.index()].x < 1e-9;
    let corners = |face: FaceId| patch.mesh.faces()[face];
    let is_lip = |&face: &FaceId| {
        let on_slit = corners(face).iter().filter(|&&v| is_on_slit(v)).count();
        on_slit == 2 && corners(face).iter().all(|&v| is_left(v))
    };
    let face = patch.mesh.faces().ids().filter(is_lip).nth(20);
    let face = face.expect("a lip along the whole slit");
    // A distance from the lip, in heights of the face.
    let place = |distance: f64| {
        let own = |v: VertexId| {
            if is_on_slit(v) {
                0.5 * (1.0 - distance)
            } else {
                distance
            }
        };
        MaterialPoint {
            face,
            barycentric: corners(face).map(own),
        }
    };
    let kernel = Kernel {
        sigma: 0.2,
        cut: 2.0,
    };
    for sampling in SAMPLINGS {
        for distance in [0.0, 1e-17, 1e-13, -1e-13, 1e-10, 1e-8, 1e-3, 0.5] {
            let set = patch.rows_at(&[place(distance)], kernel, sampling);
            let row = &set.rows[0];
            assert!(
                row.weights.iter().all(|(v, _)| is_left(*v)),
                "{sampling:?} {distance}"
            );
            let centroid = patch.average(row, |p| p.x);
            assert!(centroid < -0.05, "{sampling:?} {distance}: {centroid}");
        }
    }
}

#[test]
fn nothing_passes_around_the_corner_of_a_hole_from_its_rim() {
    // A ring of faces around a square hole: from the middle of one side of the hole the far side
    // is across the hole, within the radius, and unseen.
    let whole = slit_square(40, -2.0);
    let is_hole = |f: &[u32; 3]| {
        f.iter().all(|&v| {
            let p = whole.positions[v as usize];
            p.x.abs() < 0.101 && p.y.abs() < 0.101
        })
    };
    let faces: Vec<[u32; 3]> = whole
        .face_list()
        .into_iter()
        .filter(|f| !is_hole(f))
        .collect();
    let patch = Patch::new(whole.positions, faces);
    let kernel = Kernel {
        sigma: 0.2,
        cut: 2.0,
    };
    let centre = patch.vertex_near(Vector3::new(-0.1, 0.0, 0.0));
    for sampling in SAMPLINGS {
        let set = patch.rows(&[centre], kernel, sampling);
        let across: f64 = set.rows[0]
            .weights
            .iter()
            .filter(|(v, _)| {
                let p = patch.positions[v.index()];
                p.x > 0.09 && p.y.abs() < 0.3
            })
            .map(|pair| pair.1)
            .sum();
        assert_eq!(across, 0.0, "{sampling:?}");
    }
}

/// A closed tube of circumference 2 and length 3 about the y axis, 40 vertices around.
fn finger() -> Patch {
    let flat = equilateral_rectangle(2.0, 3.0, 0.05);
    let columns = 41;
    let row_of = |v: u32| v / columns;
    let glue = |v: u32| row_of(v) * 40 + v % columns % 40;
    let radius = 1.0 / std::f64::consts::PI;
    let mut positions = vec![Vector3::zeros(); flat.positions.len() / 41 * 40];
    for (v, p) in flat.positions.iter().enumerate() {
        let (sin, cos) = (p.x / radius).sin_cos();
        positions[glue(v as u32) as usize] = Vector3::new(radius * sin, p.y, radius * cos);
    }
    let faces = flat.face_list().into_iter().map(|f| f.map(glue)).collect();
    Patch::new(positions, faces)
}

#[test]
fn nothing_passes_through_a_finger() {
    let patch = finger();
    let radius = 1.0 / std::f64::consts::PI;
    let centre = patch.vertex_near(Vector3::new(0.0, 1.5, radius));
    for sampling in SAMPLINGS {
        // The straight way through is 0.64, around 1.0; the support reaches 0.8 along the surface.
        let kernel = Kernel {
            sigma: 0.4,
            cut: 2.0,
        };
        let set = patch.rows(&[centre], kernel, sampling);
        let opposite: f64 = set.rows[0]
            .weights
            .iter()
            .filter(|(v, _)| {
                let p = patch.positions[v.index()];
                p.z < -0.9 * radius && (p.y - 1.5).abs() < 0.3
            })
            .map(|pair| pair.1)
            .sum();
        assert_eq!(opposite, 0.0, "{sampling:?}");
    }
}

#[test]
fn a_support_wider_than_a_finger_stays_balanced_and_finite() {
    let patch = finger();
    let radius = 1.0 / std::f64::consts::PI;
    let centre = patch.vertex_near(Vector3::new(0.0, 1.5, radius));
    for sampling in SAMPLINGS {
        let kernel = Kernel {
            sigma: 0.6,
            cut: 2.0,
        };
        let set = patch.rows(&[centre], kernel, sampling);
        let weights = &set.rows[0].weights;
        let sum: f64 = weights.iter().map(|pair| pair.1).sum();
        let sideways: f64 = weights
            .iter()
            .map(|(v, w)| w * patch.positions[v.index()].x)
            .sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sampling:?}");
        assert!(weights.iter().all(|pair| pair.1 >= 0.0), "{sampling:?}");
        assert!(sideways.abs() < 0.02 * radius, "{sampling:?}: {sideways}");
    }
}
