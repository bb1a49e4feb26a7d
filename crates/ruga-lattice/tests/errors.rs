//! Every refusal, with the value that caused it.

mod shapes;

use nalgebra::Vector3;
use ruga_lattice::{
    ElementId, Embedding, Lattice, LatticeEnergy, LatticeError, LatticePoint, LatticeSpec,
    SolidMaterial,
};
use ruga_mesh::{FaceId, MaterialPoint, VertexId};
use shapes::{Surface, block, spec, sphere, torus};

fn refused(surface: &Surface) -> LatticeError {
    surface.try_lattice(spec(4)).expect_err("must be refused")
}

fn cube() -> Surface {
    block([1.0, 1.0, 1.0], [2, 2, 2])
}

#[test]
fn an_open_surface_is_refused_with_its_open_edges() {
    let mut surface = cube();
    surface.faces.remove(0);
    let error = refused(&surface);
    assert!(
        matches!(error, LatticeError::OpenSurface { count: 3, .. }),
        "{error}"
    );
    surface.faces.remove(20);
    let error = refused(&surface);
    assert!(
        matches!(error, LatticeError::OpenSurface { count: 6, .. }),
        "{error}"
    );
    assert!(error.to_string().contains("6 open edges"), "{error}");
}

#[test]
fn crossing_faces_are_counted_and_named() {
    let needle = block([0.1, 0.1, 3.0], [1, 1, 1]).rotated([1.0, 2.0, 0.5], 0.2);
    let surface = cube().and(needle.clone().shifted(0.3, 0.62, -1.0));
    let LatticeError::SelfIntersection { count, faces } = refused(&surface) else {
        panic!("a needle through a cube");
    };
    let cube_faces = cube().faces.len() as u32;
    assert!(faces[0].0 < cube_faces && faces[1].0 >= cube_faces);
    // The eight faces around the needle pass through the lower and the upper side.
    assert!((8..40).contains(&count), "{count}");
    // A torus pressed through itself.
    let pinched = torus(1.0, 0.3, [24, 12]).map(|p| Vector3::new(p.x, p.y.abs() - 0.2 * p.y, p.z));
    assert!(matches!(
        refused(&pinched),
        LatticeError::SelfIntersection { .. }
    ));
}

#[test]
fn faces_in_one_plane_that_overlap_are_found() {
    // Two cubes on each other, one shifted along the common side.
    let surface = cube().and(cube().shifted(0.3, 0.17, 1.0));
    let error = refused(&surface);
    assert!(
        matches!(error, LatticeError::SelfIntersection { .. }),
        "{error}"
    );
    // A sheet folded flat onto itself: the apex of a tetrahedron pressed into its base.
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.2, 0.2]];
    let flat = Surface {
        positions: corners.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec(),
        faces: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    };
    let error = refused(&flat);
    assert!(
        matches!(error, LatticeError::SelfIntersection { .. }),
        "{error}"
    );
}

#[test]
fn neighbouring_faces_at_any_angle_are_no_intersection() {
    for height in [1e-6, 1e-3, 1.0] {
        let surface = sphere(1.0, 16, 9).map(|p| Vector3::new(p.x, p.y, p.z * height));
        surface.try_lattice(spec(3)).expect("thin, but a body");
    }
    // Two cubes that touch in a corner, by a vertex each.
    let touching = cube().and(cube().shifted(1.0, 1.0, 1.0));
    assert!(!matches!(
        touching.try_lattice(spec(3)),
        Err(LatticeError::SelfIntersection { .. })
    ));
}

#[test]
fn bodies_inside_out_or_within_each_other_are_refused() {
    let small = sphere(0.1, 8, 6).shifted(0.5, 0.5, 0.5);
    let outside = small.clone().shifted(3.0, 0.0, 0.0);
    for (surface, depths) in [
        (cube().inside_out(), 0),
        (cube().and(small.clone()), 1),
        (cube().and(outside.clone().inside_out()), 0),
    ] {
        let error = refused(&surface);
        assert!(
            matches!(error, LatticeError::WrongSide { depth, .. } if depth == depths),
            "{error}"
        );
    }
    for surface in [cube().and(small.inside_out()), cube().and(outside)] {
        surface
            .try_lattice(spec(4))
            .expect("a hollow, or a second body");
    }
}

#[test]
fn size_does_not_matter_but_has_limits() {
    let surface = sphere(1.0, 16, 9).rotated([1.0, 2.0, 3.0], 0.5);
    let unit = surface.lattice(spec(5));
    for scale in [1e-9, 1e-3, 1e6, 1e20] {
        let scaled = surface.clone().map(|p| p * scale).lattice(spec(5));
        assert_eq!(scaled.element_count(), unit.element_count());
        assert_eq!(scaled.node_count(), unit.node_count());
        let volume = scaled.volume() / (unit.volume() * scale * scale * scale);
        assert!((volume - 1.0).abs() < 1e-12);
    }
    for scale in [1e-150, 1e200] {
        let error = refused(&surface.clone().map(|p| p * scale));
        assert!(!error.to_string().is_empty());
    }
}

#[test]
fn bad_arrays_and_settings_are_named() {
    let mesh = cube().mesh();
    let positions = cube().positions;
    let build = |positions: &[Vector3<f64>], spec| Lattice::build(&mesh, positions, &spec);
    let length = build(&positions[1..], spec(3)).expect_err("too short");
    assert!(
        matches!(
            length,
            LatticeError::Length {
                found: 25,
                expected: 26,
                ..
            }
        ),
        "{length}"
    );
    for value in [f64::NAN, f64::INFINITY] {
        let mut broken = positions.clone();
        broken[7].y = value;
        let error = build(&broken, spec(3)).expect_err("not finite");
        assert!(
            matches!(error, LatticeError::NotFinite { index: 7, .. }),
            "{error}"
        );
    }
    for cells in [0, 65, u32::MAX] {
        let error = build(&positions, spec(cells)).expect_err("out of range");
        assert!(
            matches!(error, LatticeError::Setting { name: "cells", .. }),
            "{error}"
        );
    }
    let nothing = Surface::default();
    assert_eq!(refused(&nothing), LatticeError::NoFaces);
    let point = cube().map(|_| Vector3::zeros());
    assert!(point.try_lattice(LatticeSpec::default()).is_err());
}

#[test]
fn bad_materials_and_points_are_named() {
    let lattice = cube().lattice(spec(2));
    let pinned = vec![false; lattice.node_count()];
    let with = |young, poisson| {
        LatticeEnergy::new(&lattice, &SolidMaterial { young, poisson }, &pinned).expect_err("bad")
    };
    for (young, poisson, expected) in [
        (0.0, 0.3, "young"),
        (f64::NAN, 0.3, "young"),
        (1.0, 0.5, "poisson"),
        (1.0, -1.0, "poisson"),
        (1.0, f64::NAN, "poisson"),
    ] {
        let error = with(young, poisson);
        assert!(
            matches!(error, LatticeError::Setting { name, .. } if name == expected),
            "{error}"
        );
    }
    assert!(lattice.node_masses(-1.0).is_err());

    let point = |face, weight| MaterialPoint {
        face: FaceId(face),
        barycentric: [weight, 0.5, 0.5],
    };
    let error = Embedding::of_points(&lattice, &[point(0, 0.0), point(48, 0.0)]);
    let error = error.expect_err("48 faces");
    assert!(
        matches!(
            error,
            LatticeError::FaceOutOfRange {
                point: 1,
                count: 48,
                ..
            }
        ),
        "{error}"
    );
    let error = Embedding::of_points(&lattice, &[point(0, f64::NAN)]).expect_err("not finite");
    assert!(
        matches!(error, LatticeError::NotFinite { index: 0, .. }),
        "{error}"
    );
    assert!(lattice.locate_near(&[Vector3::repeat(f64::NAN)]).is_err());
    let inside: LatticePoint = lattice.locate_near(&[Vector3::zeros()]).expect("finite")[0];
    let error = Embedding::of_lattice_points(&lattice, &[inside], &[Vector3::zeros()]);
    assert!(matches!(
        error,
        Err(LatticeError::NoNormal { point: 0, .. })
    ));

    let strays = [
        (
            LatticePoint {
                element: ElementId(8),
                ..inside
            },
            "element 8, but the lattice has 8 elements",
        ),
        (
            LatticePoint {
                local: Vector3::new(0.5, f64::NAN, 0.5),
                ..inside
            },
            "place 1 is not finite",
        ),
    ];
    for (stray, said) in strays {
        let error = Embedding::of_lattice_points(&lattice, &[inside, stray], &[Vector3::z(); 2]);
        let error = error.expect_err("no point of this lattice").to_string();
        assert!(error.contains(said), "{error}");
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let error = lattice.gravity_load(1000.0, &Vector3::new(0.0, bad, 0.0));
        let error = error.expect_err("no acceleration").to_string();
        assert_eq!(error, "component of gravity 1 is not finite");
    }

    let mut loose = cube();
    loose.positions.push(Vector3::repeat(0.5));
    let error = Embedding::of_vertices(&loose.lattice(spec(2))).expect_err("no face");
    assert_eq!(
        error,
        LatticeError::IsolatedVertex {
            vertex: VertexId(26)
        }
    );
}

#[test]
fn bodies_that_touch_are_refused_or_stay_apart() {
    // Face on face, mirrored so that the common squares coincide: contact without overlap of
    // volume, which the cutting cannot tell from a crossing.
    let error = refused(&cube().and(cube().shifted(0.0, 0.0, 1.0)));
    assert!(
        matches!(
            error,
            LatticeError::SelfIntersection { .. } | LatticeError::CannotCut { .. }
        ),
        "{error}"
    );
}
