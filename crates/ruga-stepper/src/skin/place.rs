//! Where on the model something is, in words that an artist can look up: a box of the texture and the
//! blend shape that moves the skin nearest to it.

use std::collections::BTreeMap;

use nalgebra::{Vector2, Vector3};
use ruga_blend::{BaseSurface, Driver, PosedSurface};
use ruga_material::UvTile;
use ruga_mesh::{FaceId, Id, PerFace};

/// Fraction of an area from which on its largest connected part stands for all of it.
const ALL_OF_IT: f64 = 0.9;

/// Every blend shape with its centre: the mean of the vertices at rest, weighted with the squares of
/// how far the shape moves them. Shapes that move nothing have none.
#[derive(Clone, Debug)]
pub(crate) struct ShapeCentres(Vec<(String, Vector3<f64>)>);

impl ShapeCentres {
    pub(crate) fn new(driver: &Driver) -> Self {
        let centre = |name: &str| Some((name.to_owned(), centre_of(driver, name)?));
        Self(driver.shape_names().filter_map(centre).collect())
    }

    /// The shape with its centre nearest to a place at rest.
    fn nearest(&self, place: Vector3<f64>) -> Option<&str> {
        let distance = |shape: &(String, Vector3<f64>)| (shape.1 - place).norm();
        let nearest = self.0.iter();
        let nearest = nearest.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.map(|(name, _)| name.as_str())
    }
}

fn centre_of(driver: &Driver, shape: &str) -> Option<Vector3<f64>> {
    let posed = driver.pose(&driver.weights([(shape, 1.0)]).ok()?);
    let (mut sum, mut total) = (Vector3::zeros(), 0.0);
    for (rest, posed) in driver.rest().iter().zip(&posed) {
        // The weights are squares, or wide parts that hardly move would draw the centre away from
        // those that do.
        let weight = (posed - rest).norm_squared();
        sum += rest * weight;
        total += weight;
    }
    (total > 0.0).then(|| sum / total)
}

/// Names the place of some faces of a surface at rest: `at u 0.41 to 0.55, v 0.20 to 0.31 (near where
/// blend shape 'browInnerUp' moves the skin)`; of the largest connected part where there are several.
///
/// `areas` are those of all faces; without faces there is no place, and the text is empty.
pub(crate) fn place_of_faces(
    shapes: &ShapeCentres,
    (surface, rest): (&BaseSurface, &PosedSurface),
    areas: &PerFace<f64>,
    is_in: &dyn Fn(FaceId) -> bool,
) -> String {
    let area_of = |faces: &[FaceId]| faces.iter().map(|&f| areas[f]).sum::<f64>();
    let parts = surface.mesh().connected_parts(is_in);
    let whole: f64 = parts.iter().map(|part| area_of(part)).sum();
    let largest = parts
        .iter()
        .max_by(|a, b| area_of(a).total_cmp(&area_of(b)));
    let Some(part) = largest else {
        return String::new();
    };
    let uvs = part.iter().flat_map(|&face| surface.uvs()[face]);
    let corners = part.iter().flat_map(|&face| surface.mesh().faces()[face]);
    let positions = corners.map(|v| rest.positions[v.index()]);
    let place = place_of_points(shapes, uvs, positions);
    match area_of(part) < ALL_OF_IT * whole {
        true => format!("{place}, and elsewhere"),
        false => place,
    }
}

/// Names the place of some points of the driver, given by their texture coordinates and where they
/// are at rest (m).
pub(crate) fn place_of_points(
    shapes: &ShapeCentres,
    uvs: impl Iterator<Item = Vector2<f64>>,
    positions: impl Iterator<Item = Vector3<f64>>,
) -> String {
    let uvs: Vec<Vector2<f64>> = uvs.collect();
    let (sum, count) = positions.fold((Vector3::zeros(), 0), |(sum, n), p| (sum + p, n + 1));
    let (tile, [low, high]) = box_of(&uvs);
    let square = format!(
        "at u {:.2} to {:.2}, v {:.2} to {:.2} from the map's upper left{}",
        low.x,
        high.x,
        low.y,
        high.y,
        tile.map_or(String::new(), |tile| format!(" in tile {}", tile.number()))
    );
    match shapes.nearest(sum / f64::from(count.max(1))) {
        Some(name) => square + &shape_words(name),
        None => square,
    }
}

/// Smallest and largest of some texture coordinates; where they leave the first square, those in the UDIM tile
/// that most of them lie in, relative to it.
fn box_of(uvs: &[Vector2<f64>]) -> (Option<UvTile>, [Vector2<f64>; 2]) {
    let extent = |of: &mut dyn Iterator<Item = Vector2<f64>>| {
        let start = [Vector2::repeat(f64::MAX), Vector2::repeat(f64::MIN)];
        of.fold(start, |[low, high], uv| [low.inf(&uv), high.sup(&uv)])
    };
    let whole = extent(&mut uvs.iter().copied());
    // Coordinates on the border belong to the next tile by their number alone.
    if whole.iter().flatten().all(|c| (0.0..=1.0).contains(c)) {
        return (None, whole);
    }
    let mut counts: BTreeMap<UvTile, usize> = BTreeMap::new();
    for tile in uvs.iter().filter_map(UvTile::at) {
        *counts.entry(tile).or_default() += 1;
    }
    let Some((&tile, _)) = counts.iter().rev().max_by_key(|(_, count)| **count) else {
        return (None, whole);
    };
    let inside = uvs.iter().filter(|uv| UvTile::at(uv) == Some(tile));
    (Some(tile), extent(&mut inside.map(|uv| tile.local(uv))))
}

/// Words that name the blend shape nearest to a place, behind it.
pub(crate) fn shape_words(name: &str) -> String {
    format!(" (near where blend shape '{name}' moves the skin)")
}
