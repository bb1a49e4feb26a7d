//! Creases and anchors that are refused, and leave a layer as it is.

use ruga_mesh::EdgeId;
use ruga_shell::{BendingModel, Crease, FoldSense, LineAnchor, ShellError};

use super::{THROUGH, bowl, edge, edges, layer, mesh};

#[test]
fn what_cannot_be_creased_is_refused() {
    let (mesh, _) = mesh();
    let good = Crease {
        compliance: 1.0,
        rest_angle: 0.1,
        sense: FoldSense::Valley,
    };
    let [inside, next, ..] = edges(&mesh, THROUGH)[..] else {
        panic!("six edges")
    };
    let border = edge(&mesh, [0, 1]);
    let mut layer = layer(BendingModel::VertexCurvature);
    layer.set_creases(&[(inside, good)]).unwrap();
    let x = bowl(0.1, 2);
    let before = layer.value(&x);
    let mut refuse = |creases: &[(EdgeId, Crease)]| layer.set_creases(creases).unwrap_err();
    assert!(matches!(
        refuse(&[(border, good)]),
        ShellError::CreaseOutside { .. }
    ));
    assert!(matches!(
        refuse(&[(EdgeId(9999), good)]),
        ShellError::CreaseOutside { edge: 9999 }
    ));
    assert!(matches!(
        refuse(&[(next, good), (next, good)]),
        ShellError::CreaseTwice { .. }
    ));
    for bad in [
        Crease {
            compliance: -1.0,
            ..good
        },
        Crease {
            compliance: f64::NAN,
            ..good
        },
        Crease {
            rest_angle: f64::NAN,
            ..good
        },
        Crease {
            rest_angle: 3.2,
            ..good
        },
        Crease {
            rest_angle: -0.1,
            ..good
        },
        Crease {
            sense: FoldSense::Mountain,
            ..good
        },
    ] {
        assert!(matches!(
            refuse(&[(next, bad)]),
            ShellError::ParameterOutOfRange { .. }
        ));
    }
    assert_eq!(layer.value(&x), before);
    let anchor = LineAnchor {
        edge: inside,
        stiffness: -1.0,
        depths: [0.0; 2],
    };
    assert!(layer.set_line_anchors(&[anchor]).is_err());
    let anchor = LineAnchor {
        edge: EdgeId(9999),
        stiffness: 1.0,
        ..anchor
    };
    assert!(layer.set_line_anchors(&[anchor]).is_err());
}
