//! Output meshes that are fine where wrinkles may be, and coarse elsewhere.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use ruga_blend::Driver;
use ruga_mesh::{Edge, EdgeId, FaceId, Id, PerEdge, PerFace, TriMesh};

use crate::skin::piece::Piece;

/// Halvings of an edge, at most: seven more than make a metre a millimetre.
const MOST_PASSES: u32 = 17;

/// Edges that a thread measures at least.
const EDGES_AT_ONCE: usize = 1024;

/// What a piece with smaller faces was made from.
pub(crate) struct Refined {
    pub(crate) whole: Piece,
    /// For every small face the face of the whole that it lies in.
    pub(crate) origins: PerFace<FaceId>,
}

/// A copy of a piece with edges halved until none is longer than 1 in the measure of a face beside it, a tensor of
/// squared inverse lengths (1/m²) that its parts keep; `None` as soon as `goes_on`, which is asked between its passes,
/// says no.
///
/// With any edge of a face its longest one is halved, too (Rivara 1984), or every pass would make angles
/// smaller beside faces that are split more often.
pub(crate) fn refined(
    driver: &Driver,
    whole: Piece,
    measures: &PerFace<Matrix3<f64>>,
    goes_on: &mut dyn FnMut() -> bool,
) -> Option<(Piece, Refined)> {
    let mut piece = whole.clone();
    let mut positions = piece.flat_positions(driver);
    let mut origins: PerFace<FaceId> = piece.mesh.faces().ids().collect();
    for _ in 0..MOST_PASSES {
        let measure = |face: FaceId| measures[origins[face]];
        let halved = edges_to_halve(&piece.mesh, &positions, &measure);
        if !halved.as_slice().contains(&true) {
            break;
        }
        let middle = |halved: &bool| halved.then_some(0.5);
        let places: Vec<Option<f64>> = halved.as_slice().iter().map(middle).collect();
        let split = piece.split(&places, &mut positions);
        origins = split.parents.iter().map(|&face| origins[face]).collect();
        if !goes_on() {
            return None;
        }
    }
    Some((piece, Refined { whole, origins }))
}

/// The measure in which edges up to `longest` (m) are no longer than 1.
pub(crate) fn in_all_directions(longest: f64) -> Matrix3<f64> {
    Matrix3::from_diagonal_element(longest.powi(-2))
}

/// Edges that are too long for a face beside them, and with them the longest of every face that loses
/// one.
fn edges_to_halve(
    mesh: &TriMesh,
    positions: &[Vector3<f64>],
    measure: &(dyn Fn(FaceId) -> Matrix3<f64> + Sync),
) -> PerEdge<bool> {
    let squared = |face: FaceId, edge: EdgeId| {
        let [a, b] = mesh.edges()[edge].vertices.map(|v| positions[v.index()]);
        (b - a).dot(&(measure(face) * (b - a)))
    };
    let is_too_long = |(id, edge): (usize, &Edge)| {
        let mut beside = edge.faces.iter().flatten();
        beside.any(|&face| squared(face, EdgeId::from_index(id)) > 1.0)
    };
    let edges = mesh
        .edges()
        .as_slice()
        .par_iter()
        .with_min_len(EDGES_AT_ONCE);
    let too_long: Vec<bool> = edges.enumerate().map(is_too_long).collect();
    let mut halved = PerEdge::from(too_long);
    let mut pending: Vec<EdgeId> = halved
        .iter()
        .filter(|(_, on)| **on)
        .map(|(id, _)| id)
        .collect();
    while let Some(edge) = pending.pop() {
        for face in mesh.edges()[edge].faces.into_iter().flatten() {
            let own = mesh.face_edges(face).into_iter();
            let own = own.map(|edge| (edge, squared(face, edge)));
            // Of equal ones the first, whatever corner a face begins with.
            let most = own.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
            let (most, _) = most.expect("a face has three edges");
            if !halved[most] {
                halved[most] = true;
                pending.push(most);
            }
        }
    }
    halved
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use ruga_blend::{BaseSurface, Smoothing};

    use super::*;
    use crate::test_drivers::{SIDE, square_mesh};

    /// A flat square of right triangles as a piece, and its driver.
    fn square() -> (Driver, Piece) {
        let flat = |p: nalgebra::Vector2<f64>| Vector3::new(p.x, p.y, 0.0);
        let driver = Driver::new(&square_mesh(&flat, &flat)).expect("a square");
        let faces: Vec<FaceId> = driver.topology().faces().ids().collect();
        let piece = Piece::of(&BaseSurface::new(&driver, &faces, 0, Smoothing::Loop));
        (driver, piece)
    }

    fn corners(piece: &Piece, driver: &Driver, face: FaceId) -> [Vector3<f64>; 3] {
        let positions = piece.flat_positions(driver);
        piece.mesh.faces()[face].map(|v| positions[v.index()])
    }

    /// Edges are short where it is asked for, the area stays, every face lies in its face of the driver,
    /// and no angle becomes smaller than half of a right triangle's beside a face split many times.
    #[test]
    fn edges_are_halved_where_they_are_too_long() {
        let (driver, piece) = square();
        let coarse = driver.rest().iter().map(|x| x.x).fold(f64::MIN, f64::max);
        let wanted = |centre: Vector3<f64>| {
            if centre.norm() < 0.2 * SIDE {
                SIDE / 300.0
            } else {
                coarse
            }
        };
        let longest = piece.mesh.faces().ids().map(|face| {
            let [a, b, c] = corners(&piece, &driver, face);
            wanted((a + b + c) / 3.0)
        });
        let longest: PerFace<f64> = longest.collect();
        let before = piece.mesh.face_count();
        let measures = longest
            .as_slice()
            .iter()
            .map(|&edge| in_all_directions(edge));
        let fine = refined(&driver, piece.clone(), &measures.collect(), &mut || true)
            .expect("nothing ends it");
        let (fine, from) = fine;
        assert!(
            fine.mesh.face_count() > 4 * before,
            "{}",
            fine.mesh.face_count()
        );
        let positions = fine.flat_positions(&driver);
        let (mut area, mut least) = (0.0, f64::INFINITY);
        for (face, vertices) in fine.mesh.faces().iter() {
            let [a, b, c] = vertices.map(|v| positions[v.index()]);
            area += 0.5 * (b - a).cross(&(c - a)).norm();
            let origin = &fine.origins[face];
            assert_eq!(from.whole.origins[from.origins[face]].face, origin.face);
            let asked = longest[origin.face];
            for [p, q, r] in [[a, b, c], [b, c, a], [c, a, b]] {
                assert!((q - p).norm() <= asked, "{} m of {asked}", (q - p).norm());
                least = f64::min(least, (q - p).angle(&(r - p)));
            }
            for (corner, weights) in vertices.iter().zip(origin.corners) {
                let there =
                    driver.topology().faces()[origin.face].map(|v| driver.rest()[v.index()]);
                let place: Vector3<f64> = there.iter().zip(weights).map(|(x, w)| x * w).sum();
                assert!((place - positions[corner.index()]).norm() < 1e-12);
            }
        }
        assert!((area / (SIDE * SIDE) - 1.0).abs() < 1e-12, "{area}");
        assert!(least.to_degrees() > 22.4, "{} degrees", least.to_degrees());
    }

    /// What is short enough stays as it is; who asks for an end gets one.
    #[test]
    fn short_edges_stay_and_interrupts_are_heard() {
        let (driver, piece) = square();
        let faces = piece.mesh.face_count();
        let same = refined(
            &driver,
            piece.clone(),
            &PerFace::filled(faces, in_all_directions(SIDE)),
            &mut || true,
        );
        assert_eq!(same.expect("nothing ends it").0.mesh.face_count(), faces);
        let fine = PerFace::filled(faces, in_all_directions(1e-3 * SIDE));
        assert!(refined(&driver, piece, &fine, &mut || false).is_none());
    }
}
