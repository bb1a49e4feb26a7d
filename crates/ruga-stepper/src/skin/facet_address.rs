//! Where on the artist's flat triangles a place of the smooth surface is.
//!
//! Loop subdivision moves vertices sideways as well: where quads of a face are cut along either
//! diagonal, by half a millimetre and to the other side at every vertex. On the smooth surface
//! texture coordinates make up for it, but maps are looked at on the flat triangles, where straight
//! fine lines would come out as zigzags. So results are addressed by the place on those that lies
//! straight above or below, along the smooth surface's normal. The closest place would not do: under
//! a corner that stands out, the closest places avoid the corner.

use nalgebra::{Matrix2, Matrix2x3, Matrix3, Matrix3x2, Vector2, Vector3};
use rayon::prelude::*;
use ruga_blend::Driver;
use ruga_mesh::{FaceId, FaceOrigin, Id, MaterialPoint, PerFace, TriMesh};

use crate::skin::fading::faded_from;
use crate::skin::material_places::{is_on_border, uv};
use crate::skin::piece::uvs_of;

/// Distance from seams and borders, in largest ways sideways, over which addresses are faded back
/// to those of the material points, so that islands stay as large as they are.
const FADE: f64 = 4.0;

/// Part of the way from the flat triangle, in the texture, by which the place found may miss where the
/// triangle's own plane says it is; beyond, there is a seam between.
const CONTINUOUS: f64 = 0.5;

/// Barycentric weight by which a line may miss a triangle and still meet it, and triangles that one is
/// followed across: more lie around a corner only where the mesh is a fan.
const INSIDE: f64 = 1e-9;
const MOST_FACES: usize = 16;

/// Fraction of its area in the texture that a triangle keeps, and attempts to see to it. Around a vertex
/// of valence 4 the smooth surface really is that small: every split leaves 0.56 of what it leaves
/// elsewhere.
const LEAST_AREA: f64 = 1e-3;
const ATTEMPTS: usize = 8;

/// Height of a face over its longest edge, in the texture, up to which it is a thin one that a crease has left.
const THIN: f64 = 0.1;

/// Fraction of its area in the texture that a thin face keeps, and one over that by which it may grow.
const KEPT: f64 = 0.5;

/// Vertices or faces that a thread addresses at least.
const AT_ONCE: usize = 1024;

/// A mesh of places of the smooth surface, none of its faces across an edge of the driver.
pub(crate) struct Piece<'a> {
    pub(crate) mesh: &'a TriMesh,
    pub(crate) points: &'a [MaterialPoint],
    /// Rest position of the surface there, m.
    pub(crate) positions: &'a [Vector3<f64>],
    /// Unit normals of the surface there.
    pub(crate) normals: &'a [Vector3<f64>],
    pub(crate) origins: &'a PerFace<FaceOrigin>,
    pub(crate) driver: &'a Driver,
}

impl Piece<'_> {
    /// Texture coordinates of the material points of a face's corners.
    fn uvs(&self, face: usize) -> [Vector2<f64>; 3] {
        uvs_of(self.driver, &self.origins.as_slice()[face])
    }
}

/// Addresses of places of the smooth surface.
#[derive(Clone, Debug)]
pub(crate) struct FacetAddresses {
    /// Every vertex' shift from its material point, in the texture.
    shifts: Vec<Vector2<f64>>,
}

impl FacetAddresses {
    pub(crate) fn new(piece: &Piece<'_>) -> Self {
        let ways = ways(piece);
        // A shift that ended abruptly at a seam could fold the triangles beside it.
        let mut shifts = faded(piece, &ways);
        let is_held: Vec<bool> = ways.iter().map(Option::is_none).collect();
        for _ in 0..ATTEMPTS {
            if !straighten_thin(piece, &is_held, &mut shifts) {
                break;
            }
        }
        for _ in 0..ATTEMPTS {
            if !halve_where_folded(piece, &mut shifts) {
                break;
            }
        }
        Self { shifts }
    }

    /// Texture coordinates of the corners of a face of the mesh, which has this `origin`.
    pub(crate) fn uvs(
        &self,
        driver: &Driver,
        (corners, origin): ([u32; 3], &FaceOrigin),
    ) -> [Vector2<f64>; 3] {
        let uvs = uvs_of(driver, origin);
        std::array::from_fn(|k| uvs[k] + self.shifts[corners[k] as usize])
    }
}

/// Barycentric coordinates, in the driver's face that it lies in, of the corners of a face that has this `origin` and
/// these texture coordinates; they may be beyond the driver's face's edges.
pub(crate) fn corners_at(
    driver: &Driver,
    origin: &FaceOrigin,
    uvs: &[Vector2<f64>; 3],
) -> [[f64; 3]; 3] {
    barycentric(&driver.uvs()[origin.face], uvs)
        .filter(|corners| corners.as_flattened().iter().all(|w| w.abs() <= FAR_OUT))
        .unwrap_or(origin.corners)
}

/// Shift from a vertex' place on its flat triangle to the one above or below where the surface is:
/// its length, m, and its vector in the texture; `None` across a seam or at one, or on the border.
type Way = Option<(f64, Vector2<f64>)>;

fn ways(piece: &Piece<'_>) -> Vec<Way> {
    let driver = piece.driver;
    let border = driver.topology().border_vertices();
    let seams = seam_vertices(piece);
    let lines = piece.positions.par_iter().zip(piece.normals);
    let vertices = piece.points.par_iter().zip(lines).zip(seams);
    vertices
        .with_min_len(AT_ONCE)
        .map(|((point, line), is_seam)| {
            // On a border the shift could lead out of the texture's island, and at a seam there are
            // two islands to shift in.
            (!is_seam && !is_on_border(driver.topology(), &border, point))
                .then(|| way(driver, point, line))
                .flatten()
        })
        .collect()
}

fn way(driver: &Driver, point: &MaterialPoint, line: (&Vector3<f64>, &Vector3<f64>)) -> Way {
    let x = line.0;
    let flat = point.interpolate(driver.topology(), driver.rest());
    let place = along_normal(driver, point.face, line)?;
    let sideways = (place.interpolate(driver.topology(), driver.rest()) - flat).norm();
    let way = uv(driver, &place) - uv(driver, point);
    let texture = in_texture(driver, point.face)?;
    let away = x - flat;
    // Where the smooth surface meets the flat one, both ways are nothing but rounding.
    let rounding = 1e-9 * longest_edge(driver, point.face);
    let slack = CONTINUOUS * away.norm() + rounding;
    ((way - texture * away).norm() <= slack * texture.norm()).then_some((sideways, way))
}

/// The place where a line from `x` along the normal meets the flat triangles, followed from `face`
/// on across the edges that it passes.
fn along_normal(
    driver: &Driver,
    mut face: FaceId,
    (x, normal): (&Vector3<f64>, &Vector3<f64>),
) -> Option<MaterialPoint> {
    let mesh = driver.topology();
    for _ in 0..MOST_FACES {
        let [a, b, c] = mesh.faces()[face].map(|v| driver.rest()[v.index()]);
        let inverse = Matrix3::from_columns(&[b - a, c - a, *normal]).try_inverse()?;
        let met = inverse * (x - a);
        let barycentric = [1.0 - met.x - met.y, met.x, met.y];
        let (least, weight) = (0..3)
            .map(|corner| (corner, barycentric[corner]))
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        if weight >= -INSIDE {
            return Some(MaterialPoint { face, barycentric });
        }
        // The most negative weight names the edge that the line has passed: the one opposite that
        // corner.
        face = mesh.neighbour(face, (least + 1) % 3)?;
    }
    None
}

fn longest_edge(driver: &Driver, face: FaceId) -> f64 {
    let [a, b, c] = driver.topology().faces()[face].map(|v| driver.rest()[v.index()]);
    (b - a).norm().max((c - b).norm()).max((a - c).norm())
}

/// Derivative of a face's texture coordinates by the place in space.
fn in_texture(driver: &Driver, face: FaceId) -> Option<Matrix2x3<f64>> {
    let [a, b, c] = driver.topology().faces()[face].map(|v| driver.rest()[v.index()]);
    let edges = Matrix3x2::from_columns(&[b - a, c - a]);
    let coordinates = (edges.transpose() * edges).try_inverse()? * edges.transpose();
    let [p, q, r] = driver.uvs()[face];
    Some(Matrix2::from_columns(&[q - p, r - p]) * coordinates)
}

/// Barycentric coordinate at which a triangle has too little texture to measure places by.
const FAR_OUT: f64 = 3.0;

/// Vertices with more than one texture coordinate.
fn seam_vertices(piece: &Piece<'_>) -> Vec<bool> {
    let mut known: Vec<Option<Vector2<f64>>> = vec![None; piece.points.len()];
    let mut seams = vec![false; piece.points.len()];
    let all = piece.driver.uvs().as_slice().iter().flatten();
    let scale: f64 = all.map(Vector2::amax).fold(1.0, f64::max);
    for (face, corners) in piece.mesh.faces().as_slice().iter().enumerate() {
        for (vertex, uv) in corners.iter().zip(piece.uvs(face)) {
            let i = vertex.index();
            match &known[i] {
                // As far as rounding goes: faces that share an edge may interpolate it apart.
                Some(known) => seams[i] |= (known - uv).amax() > 1e-9 * scale,
                None => known[i] = Some(uv),
            }
        }
    }
    seams
}

/// The shift of every vertex in the texture: more of its way with the distance from those with none.
fn faded(piece: &Piece<'_>, ways: &[Way]) -> Vec<Vector2<f64>> {
    let reach = FADE * ways.iter().flatten().map(|way| way.0).fold(0.0, f64::max);
    if reach == 0.0 {
        return vec![Vector2::zeros(); ways.len()];
    }
    let held: Vec<bool> = ways.iter().map(Option::is_none).collect();
    let weights = faded_from(piece.mesh, piece.positions, &held, reach);
    let shifts = ways.iter().zip(weights);
    shifts
        .map(|(way, weight)| way.map_or_else(Vector2::zeros, |way| way.1 * weight))
        .collect()
}

fn shifted(piece: &Piece<'_>, shifts: &[Vector2<f64>], face: usize) -> [Vector2<f64>; 3] {
    let (corners, uvs) = (
        piece.mesh.faces()[FaceId::from_index(face)],
        piece.uvs(face),
    );
    std::array::from_fn(|k| uvs[k] + shifts[corners[k].index()])
}

/// Twice the area of a face in the texture.
fn area([a, b, c]: &[Vector2<f64>; 3]) -> f64 {
    (b - a).perp(&(c - a))
}

/// Lets the corner opposite the longest edge of a thin face go with that edge, where the face would lose much of its
/// area; whether there were any.
///
/// Shifts bend at edges of the driver. A crease that runs closely beside one leaves faces so thin that the bend alone
/// turns them over; halved shifts would then dent the line by as much as the shift is long.
fn straighten_thin(piece: &Piece<'_>, is_held: &[bool], shifts: &mut [Vector2<f64>]) -> bool {
    let mut found = false;
    for face in 0..piece.mesh.face_count() {
        let uvs = piece.uvs(face);
        let (start, longest) = (0..3)
            .map(|k| (k, (uvs[(k + 1) % 3] - uvs[k]).norm_squared()))
            .fold(
                (0, 0.0),
                |most, side| if side.1 > most.1 { side } else { most },
            );
        let before = area(&uvs);
        if before.abs() > THIN * longest {
            continue;
        }
        let after = area(&shifted(piece, shifts, face)) / before;
        let corners = piece.mesh.faces()[FaceId::from_index(face)].map(Id::index);
        let [a, b, c] = std::array::from_fn(|k| (start + k) % 3);
        if (KEPT..=1.0 / KEPT).contains(&after) || is_held[corners[c]] {
            continue;
        }
        let along = uvs[b] - uvs[a];
        let share = (uvs[c] - uvs[a]).dot(&along) / longest;
        shifts[corners[c]] = shifts[corners[a]].lerp(&shifts[corners[b]], share);
        found = true;
    }
    found
}

/// Halves the shifts at the corners of faces that have all but lost their area; whether there were
/// any.
fn halve_where_folded(piece: &Piece<'_>, shifts: &mut [Vector2<f64>]) -> bool {
    let is_folded = |face: usize| {
        let before = area(&piece.uvs(face));
        let after = area(&shifted(piece, shifts, face));
        after * before.signum() < LEAST_AREA * before.abs()
    };
    let faces = (0..piece.mesh.face_count()).into_par_iter();
    let faces = faces.with_min_len(AT_ONCE);
    let folded: Vec<usize> = faces.filter(|&face| is_folded(face)).collect();
    for &face in &folded {
        for vertex in piece.mesh.faces()[FaceId::from_index(face)] {
            // Shifts are halved and looked at again, because neighbours share the vertices.
            shifts[vertex.index()] *= 0.5;
        }
    }
    !folded.is_empty()
}

/// Barycentric coordinates of three places of the texture in a face of it.
fn barycentric(face: &[Vector2<f64>; 3], places: &[Vector2<f64>; 3]) -> Option<[[f64; 3]; 3]> {
    let [a, b, c] = face;
    let inverse = Matrix2::from_columns(&[b - a, c - a]).try_inverse()?;
    Some(places.map(|place| {
        let t = inverse * (place - a);
        [1.0 - t.x - t.y, t.x, t.y]
    }))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::skin::skin_mesh::RegionMesh;
    use crate::test_drivers::{SIDE, region, square_mesh};

    /// A flat square of triangles cut along either diagonal, its vertices moved by up to `jitter`,
    /// its texture as flat as itself.
    fn uneven(jitter: f64) -> Driver {
        let mut random = Pcg64Mcg::seed_from_u64(3);
        let flat = |p: Vector2<f64>| Vector3::new(p.x, p.y, 0.0);
        let mut mesh = square_mesh(&flat, &flat);
        for x in &mut mesh.positions {
            if x.amax() < 0.49 * SIDE {
                x.x += jitter * random.random_range(-1.0..1.0);
                x.y += jitter * random.random_range(-1.0..1.0);
            }
        }
        // Every other pair of triangles cut the other way.
        for pair in mesh.triangles.chunks_exact_mut(2).step_by(2) {
            let ([a, b, c], d) = (pair[0], pair[1][2]);
            pair.copy_from_slice(&[[a, b, d], [b, c, d]]);
        }
        mesh.uvs = Some(mesh.positions.iter().map(Vector3::xy).collect());
        Driver::new(&mesh).expect("a square")
    }

    /// Largest distance in the middle between where a vertex is and where `uvs` show it.
    fn misses(region: &RegionMesh, uvs: &[[Vector2<f64>; 3]]) -> f64 {
        let faces = region.skin.mesh.faces().as_slice().iter().zip(uvs);
        let corners = faces.flat_map(|(corners, uvs)| corners.iter().zip(uvs));
        corners
            .map(|(v, uv)| (region.skin.rest.positions[v.index()].xy(), uv))
            .filter(|(x, _)| x.amax() < 0.3 * SIDE)
            .map(|(x, uv)| (x - uv).norm())
            .fold(0.0, f64::max)
    }

    #[test]
    fn places_are_shown_where_they_are() {
        // Without jitter many vertices stay where they are, with nothing but rounding between.
        for jitter in [0.0, 3e-4] {
            let driver = uneven(jitter);
            let region = region(&driver, 3, 5e-4);
            let faces = region.skin.mesh.faces().ids();
            let uvs: Vec<_> = faces.map(|face| region.uvs(&driver, face)).collect();
            let [before, after] =
                [&uvs[..], &region.shown(&driver).uvs].map(|uvs| misses(&region, uvs));
            assert!(before > 1e-4, "{before} m");
            assert!(after < 1e-12, "{after} m");
        }
    }

    /// The square's border stays the border of its texture, and nothing is folded.
    #[test]
    fn islands_stay_whole() {
        let driver = uneven(3e-4);
        let region = region(&driver, 2, 0.0);
        let area = |[a, b, c]: &[Vector2<f64>; 3]| 0.5 * (b - a).perp(&(c - a));
        let areas: Vec<f64> = region.shown(&driver).uvs.iter().map(area).collect();
        assert!(areas.iter().all(|area| *area > 0.0));
        let total: f64 = areas.iter().sum();
        assert!((total / (SIDE * SIDE) - 1.0).abs() < 1e-9, "{total}");
    }

    /// The texture of one half lies elsewhere: no address crosses the seam.
    #[test]
    fn seams_are_not_crossed() {
        let mut random = Pcg64Mcg::seed_from_u64(4);
        let flat = |p: Vector2<f64>| Vector3::new(p.x, p.y, 0.0);
        let mut mesh = square_mesh(&flat, &flat);
        let own = mesh.positions.len() as u32;
        let on_seam = |x: &Vector3<f64>| x.x.abs() < 1e-9 && x.y.abs() < 0.49 * SIDE;
        for x in &mut mesh.positions {
            x.y += if on_seam(x) {
                2e-4 * random.random_range(-1.0..1.0)
            } else {
                0.0
            };
        }
        let copies = mesh.positions.clone();
        let far = Vector2::new(1.0, 0.0);
        let uvs: Vec<_> = copies.iter().map(Vector3::xy).collect();
        mesh.uvs = Some(
            uvs.iter()
                .copied()
                .chain(uvs.iter().map(|uv| uv + far))
                .collect(),
        );
        mesh.positions.extend(copies.iter().copied());
        for shape in &mut mesh.shapes {
            shape.position_deltas = vec![Vector3::zeros(); mesh.positions.len()];
        }
        for corners in &mut mesh.triangles {
            if corners.iter().any(|v| copies[*v as usize].x > 1e-9) {
                *corners = corners.map(|v| v + own);
            }
        }
        let driver = Driver::new(&mesh).expect("a square in two halves");
        let region = region(&driver, 2, 0.0);
        let total: f64 = (region.shown(&driver).uvs.iter())
            .map(|[a, b, c]| 0.5 * (b - a).perp(&(c - a)))
            .inspect(|area| assert!(*area > 0.0))
            .sum();
        assert!((total / (SIDE * SIDE) - 1.0).abs() < 1e-9, "{total}");
        for uvs in region.shown(&driver).uvs.iter() {
            assert!(uvs.iter().all(|uv| uv.x < 0.5) || uvs.iter().all(|uv| uv.x > 0.5));
        }
    }
}
