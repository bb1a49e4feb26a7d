//! What lies below places of the skin: the layer below where there is one, the driver elsewhere.

use nalgebra::{Matrix2, SymmetricEigen, Vector2, Vector3};
use ruga_blend::{Driver, FaceStrain, PosedSurface, face_strains};
use ruga_mesh::{
    Id, LoopSurface, MaterialPoint, PerFace, PerVertex, SurfaceLookup, TriMesh, limit_rows,
};

use crate::skin_mesh::{SkinMesh, through_vertices};

/// Squared stretches by which the bending of the layer below may change a rest metric: where that
/// layer bends within twice its offset, the offset surface is about to turn inside out.
const TRANSFER_RANGE: [f64; 2] = [0.25, 2.25];

/// A place counts as beside the layer below when it lies this share of an edge outside.
const BESIDE: f64 = 1e-3;

/// Barycentric weight under which a place lies on the opposite edge.
const ON_EDGE: f64 = 1e-9;

/// A surface on which a layer would lie, and what of its bending the layer is not to feel.
#[derive(Clone, Debug)]
pub(crate) struct BelowSurface {
    /// The layer's own place in it: offsets are included.
    pub(crate) posed: PosedSurface,
    /// Per face the symmetric stretch of the rest metric, in the face's rest frame, that takes the
    /// untransferred part of the bending strain away.
    pub(crate) transfer: Option<Vec<Matrix2<f64>>>,
}

/// The layer below, with its shape.
pub(crate) struct LowerLayer<'a> {
    pub(crate) skin: &'a SkinMesh,
    pub(crate) positions: &'a [Vector3<f64>],
    /// Its distance from the driver, m.
    pub(crate) offset: f64,
}

/// How a layer lies on what is below.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Seat {
    /// Distance from the driver along its normal, m.
    pub(crate) offset: f64,
    /// Share of the bending strain of what lies below that the layer feels, 0 to 1.
    pub(crate) bending_transfer: f64,
    /// Tangential stiffness per area where it is not the layer's own, Pa/m.
    pub(crate) tie: Option<f64>,
}

/// The surface below the vertices of `skin`, whose rest positions include the seat's offset.
pub(crate) fn surface_below(
    driver: &Driver,
    skin: &SkinMesh,
    seat: Seat,
    control: &[Vector3<f64>],
    lower: Option<&LowerLayer<'_>>,
) -> BelowSurface {
    let mut middle = skin.points.pose(control);
    let mut distance = vec![seat.offset; middle.positions.len()];
    if let Some(lower) = lower {
        let covered = add_lower(driver, skin, control, lower, &mut middle);
        for (distance, _) in distance.iter_mut().zip(covered).filter(|(_, on)| *on) {
            *distance -= lower.offset;
        }
    }
    let lifted = |share: f64| -> Vec<Vector3<f64>> {
        let normals = middle.positions.iter().zip(&middle.normals).zip(&distance);
        normals.map(|((x, n), d)| x + n * (share * d)).collect()
    };
    let positions = lifted(1.0);
    let transfer = (seat.offset > 0.0 && seat.bending_transfer < 1.0).then(|| {
        // Where the layer rests, between the surface below and its own place.
        let rest: Vec<Vector3<f64>> = skin
            .rest
            .positions
            .iter()
            .zip(&skin.rest.normals)
            .zip(&distance)
            .map(|((x, n), d)| x - n * ((1.0 - seat.bending_transfer) * d))
            .collect();
        let part = face_strains(&skin.mesh, &rest, &lifted(seat.bending_transfer));
        let whole = face_strains(&skin.mesh, &skin.rest.positions, &positions);
        untransferred(&whole, &part)
    });
    BelowSurface {
        posed: PosedSurface {
            positions,
            ..middle
        },
        transfer,
    }
}

/// `A = P^-1/2 W P^-1/2` per face, as stretch `A^1/2`, of the whole metric `W` and the part `P`
/// that is felt: with this rest metric a layer in `W` is strained as one in `P`. For bending about
/// one axis it is `l0' = l0 |dQ_t| / |dQ_teff|` of the notes.
fn untransferred(whole: &PerFace<FaceStrain>, part: &PerFace<FaceStrain>) -> Vec<Matrix2<f64>> {
    let pairs = whole.as_slice().iter().zip(part.as_slice());
    pairs
        .map(|(whole, part)| {
            let root = power(&part.cauchy_green, -0.5, [1e-4, f64::MAX]);
            let metric = root * whole.cauchy_green * root;
            power(&metric, 0.5, TRANSFER_RANGE)
        })
        .collect()
}

/// A power of a symmetric positive matrix, its eigenvalues held to a range.
fn power(matrix: &Matrix2<f64>, exponent: f64, [low, high]: [f64; 2]) -> Matrix2<f64> {
    let eigen = SymmetricEigen::new(*matrix);
    let values = eigen
        .eigenvalues
        .map(|value| value.clamp(low, high).powf(exponent));
    let vectors = eigen.eigenvectors;
    vectors * Matrix2::from_diagonal(&values) * vectors.transpose()
}

/// Adds to the driver what the layer below deviates from it, wherever that layer is.
///
/// Deviations, not positions, are interpolated: they vanish at the layer's ragged border, where a
/// smooth surface through positions would cut the corners.
fn add_lower(
    driver: &Driver,
    skin: &SkinMesh,
    control: &[Vector3<f64>],
    lower: &LowerLayer<'_>,
    middle: &mut PosedSurface,
) -> Vec<bool> {
    let places = places_above(skin, lower.skin);
    let inside: Vec<MaterialPoint> = places.iter().flatten().copied().collect();
    let corners = PerVertex::filled(lower.skin.mesh.vertex_count(), false);
    let at_vertices = limit_rows(&lower.skin.mesh, &corners).position;
    let rows = LoopSurface::new(&lower.skin.mesh, &corners).rows(&inside);
    let base = lower.skin.points.pose(control).positions;
    let deviations = lower.positions.iter().zip(&base);
    let deviations: Vec<Vector3<f64>> = deviations.map(|(x, base)| x - base).collect();
    let mut jets = rows
        .apply(&through_vertices(&at_vertices, &deviations))
        .into_iter()
        .zip(rows.apply(&lower.skin.rest.positions));
    let rest = skin.points.derivatives(driver.rest());
    let posed = skin.points.derivatives(control);
    for (i, place) in places.iter().enumerate() {
        let Some((deviation, lower_rest)) = place.and_then(|_| jets.next()) else {
            continue;
        };
        middle.positions[i] += deviation.position;
        let change = |tangent: &Vector3<f64>| {
            let [u, v] = coordinates(tangent, &lower_rest.first);
            deviation.first[0] * u + deviation.first[1] * v
        };
        let [first, second] = [0, 1].map(|d| posed[i][d] + change(&rest[i][d]));
        if let Some(normal) = first.cross(&second).try_normalize(0.0) {
            let tangent = first - normal * normal.dot(&first);
            middle.tangents[i] = tangent.try_normalize(0.0).unwrap_or(middle.tangents[i]);
            middle.normals[i] = normal;
        }
    }
    places.iter().map(Option::is_some).collect()
}

/// Coordinates of a tangent in a basis of the tangent plane, by least squares.
fn coordinates(tangent: &Vector3<f64>, [u, v]: &[Vector3<f64>; 2]) -> [f64; 2] {
    let gram = Matrix2::new(u.dot(u), u.dot(v), u.dot(v), v.dot(v));
    let right = Vector2::new(u.dot(tangent), v.dot(tangent));
    let solved = gram
        .try_inverse()
        .map_or_else(Vector2::zeros, |g| g * right);
    [solved.x, solved.y]
}

/// The place of the layer below under every vertex, where there is one.
fn places_above(skin: &SkinMesh, lower: &SkinMesh) -> Vec<Option<MaterialPoint>> {
    let lookup = SurfaceLookup::new(&lower.mesh, &lower.rest.positions);
    let border = lower.mesh.border_vertices();
    let vertices = skin.rest.positions.iter().zip(&skin.rest.normals);
    vertices
        .map(|(x, normal)| {
            let point = lookup.closest(x)?.point;
            let away = x - point.interpolate(&lower.mesh, &lower.rest.positions);
            let sideways = away - normal * normal.dot(&away);
            let [a, b, _] = lower.mesh.faces()[point.face].map(|v| v.index());
            let edge = lower.rest.positions[b] - lower.rest.positions[a];
            let is_beside = sideways.norm() > BESIDE * edge.norm();
            (!is_beside || !is_on_border(&lower.mesh, &border, &point)).then_some(point)
        })
        .collect()
}

/// Whether a place lies on the border of its mesh. On an edge or a vertex in the middle nothing is
/// beside the mesh, however much the facets' normals there differ from the surface's.
fn is_on_border(mesh: &TriMesh, border: &PerVertex<bool>, place: &MaterialPoint) -> bool {
    let corners = mesh.faces()[place.face];
    let weight = |corner: usize| place.barycentric[corner % 3];
    (0..3).any(|corner| {
        let on_edge = weight(corner + 2) < ON_EDGE;
        let at_vertex = on_edge && weight(corner + 1) < ON_EDGE;
        on_edge && mesh.neighbour(place.face, corner).is_none()
            || at_vertex && border[corners[corner]]
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;
    use ruga_blend::{ArtistMesh, BaseSurface, BlendShape, Smoothing, rest_frame};

    use super::*;
    use crate::skin_mesh::RegionMesh;
    use crate::{Coupling, LayerSpec, Sampling};

    const SIDE: f64 = 0.04;
    const CELLS: usize = 20;
    const OFFSET: f64 = 7e-4;
    const TRANSFER: f64 = 0.3;

    type Shape<'a> = &'a dyn Fn(Vector2<f64>) -> Vector3<f64>;

    /// A square with a blend shape that takes it from one shape to another.
    fn square(rest: Shape, bent: Shape) -> Driver {
        let places = (0..=CELLS).flat_map(|j| (0..=CELLS).map(move |i| [i, j]));
        let places: Vec<Vector2<f64>> = places
            .map(|c| SIDE * (Vector2::from(c.map(|c| c as f64 / CELLS as f64)).add_scalar(-0.5)))
            .collect();
        let at = |i: usize, j: usize| (j * (CELLS + 1) + i) as u32;
        let cells = (0..CELLS).flat_map(|j| (0..CELLS).map(move |i| (i, j)));
        let triangles = cells.flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        Driver::new(&ArtistMesh {
            positions: places.iter().map(|p| rest(*p)).collect(),
            uvs: Some(places.clone()),
            triangles: triangles.collect(),
            shapes: vec![BlendShape {
                name: "bend".into(),
                position_deltas: places.iter().map(|p| bent(*p) - rest(*p)).collect(),
                normal_deltas: None,
            }],
            ..ArtistMesh::default()
        })
        .expect("a square")
    }

    /// All of a driver as a layer's mesh, at a distance.
    fn skin(driver: &Driver, levels: u32, offset: f64) -> SkinMesh {
        let faces: Vec<_> = driver.topology().faces().ids().collect();
        let base = BaseSurface::new(driver, &faces, levels, Smoothing::Loop);
        let preset = ruga_material::preset("knuckle").expect("a preset");
        let layer = LayerSpec {
            name: "skin".into(),
            material: preset.layer,
            substrate: preset.substrate,
            model: ruga_material::WavelengthModel::Layer,
            coupling: Coupling::Elastic,
            sampling: Sampling::Quadrature,
            map: None,
            sharp: false,
            bending_transfer: None,
        };
        let region = RegionMesh::new(driver, &base, &layer, Smoothing::Loop, offset);
        region.expect("a plain layer").skin
    }

    /// Places of faces and the stretches of their rest metrics, where the flat square is bent to
    /// `shape`; in its plane's axes, away from its border.
    fn stretches(shape: Shape) -> Vec<(Vector2<f64>, Matrix2<f64>)> {
        let driver = square(&|p| Vector3::new(p.x, p.y, 0.0), shape);
        let skin = skin(&driver, 1, OFFSET);
        let seat = Seat {
            offset: OFFSET,
            bending_transfer: TRANSFER,
            tie: None,
        };
        let control = driver.pose(&driver.weights([("bend", 1.0)]).expect("a shape"));
        let below = surface_below(&driver, &skin, seat, &control, None);
        let transfer = below.transfer.expect("a part is not transferred");
        let faces = skin.mesh.faces().as_slice().iter().zip(transfer);
        faces
            .map(|(corners, stretch)| {
                let [a, b, c] = corners.map(|v| skin.rest.positions[v.index()]);
                let [u, v] = rest_frame([a, b, c]).map(|axis| axis.xy());
                let axes = Matrix2::from_columns(&[u, v]);
                let centre = (a + b + c).xy() / 3.0;
                (centre, axes * stretch * axes.transpose())
            })
            .filter(|(centre, _)| centre.amax() < 0.25 * SIDE)
            .collect()
    }

    /// `(1 + t k) / (1 + b t k)` for the curvature `k` of a crest.
    fn expected(curvature: f64) -> f64 {
        let bent = OFFSET * curvature;
        (1.0 + bent) / (1.0 + TRANSFER * bent)
    }

    fn sorted(stretch: &Matrix2<f64>) -> [f64; 2] {
        let values = stretch.symmetric_eigenvalues();
        [values.min(), values.max()]
    }

    /// Also over its vertices and edges, where what is closest lies on the border of a facet.
    #[test]
    fn a_layer_covers_all_of_a_bumpy_one() {
        let bumps = |p: Vector2<f64>| {
            let height = 1e-3 * (500.0 * p.x).sin() * (500.0 * p.y).cos();
            Vector3::new(p.x, p.y, height)
        };
        let driver = square(&bumps, &bumps);
        let lower = skin(&driver, 0, 0.0);
        for levels in [0, 1] {
            let upper = skin(&driver, levels, OFFSET);
            let places = places_above(&upper, &lower);
            let inside = upper
                .rest
                .positions
                .iter()
                .map(|x| x.xy().amax() < 0.45 * SIDE);
            let uncovered = places
                .iter()
                .zip(inside)
                .filter(|(p, inside)| p.is_none() && *inside);
            assert_eq!(uncovered.count(), 0, "at level {levels}");
        }
    }

    /// Round the cylinder the rest metric takes up what is not transferred, along it nothing.
    #[test]
    fn a_cylinder_stretches_the_rest_metric_around_it() {
        let radius = 0.015;
        let cylinder = |p: Vector2<f64>| {
            let angle = p.x / radius;
            radius * Vector3::new(angle.sin(), p.y / radius, angle.cos() - 1.0)
        };
        for (_, stretch) in stretches(&cylinder) {
            let [along, around] = sorted(&stretch);
            assert!((along - 1.0).abs() < 1e-5, "{along}");
            assert!((around - expected(1.0 / radius)).abs() < 2e-4, "{around}");
        }
    }

    /// In the middle of a saddle one direction is stretched and one shortened, each by its own
    /// curvature; for small ones the share that is not transferred times the bending strain.
    #[test]
    fn a_saddle_has_both_signs() {
        let saddle = |curvature: f64| {
            let shape = move |p: Vector2<f64>| {
                let height = 0.5 * curvature * (p.y * p.y - p.x * p.x);
                Vector3::new(p.x, p.y, height)
            };
            let mut found = stretches(&shape);
            found.sort_by(|a, b| a.0.norm().total_cmp(&b.0.norm()));
            // The two faces that share the middle.
            0.5 * (found[0].1 + found[1].1)
        };
        let curvature = 1.0 / 0.015;
        let [low, high] = sorted(&saddle(curvature));
        assert!((high - expected(curvature)).abs() < 2e-3, "{high}");
        assert!((low - expected(-curvature)).abs() < 2e-3, "{low}");
        let step = 0.5;
        let slope = (saddle(step) - saddle(-step)) / (2.0 * step);
        let [low, high] = sorted(&slope);
        let expected = (1.0 - TRANSFER) * OFFSET;
        assert!((high / expected - 1.0).abs() < 0.02, "{high} {expected}");
        assert!((low / expected + 1.0).abs() < 0.02, "{low} {expected}");
    }
}
