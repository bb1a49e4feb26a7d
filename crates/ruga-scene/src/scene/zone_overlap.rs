//! Whether the masks of zones leave every place of the skin to one of them, or blend.

use nalgebra::Vector2;
use ruga_material::UvTile;

use crate::Scene;
use crate::SceneError;

/// Sum of the zones' greys at a place that is not an overlap yet: images are 8 bit, and the smooth
/// edges of two masks that touch share a texel.
const MOST: f64 = 1.1;

/// Places looked at along each side of a triangle.
const PLACES: u32 = 4;

/// Refuses zones of which two claim a place wholly.
///
/// Two skins cannot be in one place, so that wrinkles of both, each computed as if it were alone,
/// would be added at full height. Where greys add up to white, they are a cross-fade.
///
/// # Errors
/// [`SceneError::ZonesOverlap`] with the place of the largest sum.
pub(crate) fn check(scene: &Scene) -> Result<(), SceneError> {
    let zones = scene.file.zones();
    if zones.len() < 2 {
        return Ok(());
    }
    let lowest = zones.iter().map(|zone| &scene.layers[zone.layers[0]]);
    let presences: Vec<_> = lowest.map(|layer| &layer.presence).collect();
    let greys = |uv: Vector2<f64>| presences.iter().map(move |presence| presence.grey(uv));
    let places = scene.driver.uvs().as_slice().iter().flat_map(places);
    let sums = places.map(|uv| (greys(uv).sum::<f64>(), uv));
    let Some((sum, at)) = sums.max_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Ok(());
    };
    if sum <= MOST {
        return Ok(());
    }
    let mut claims: Vec<(f64, &str)> = greys(at)
        .zip(&zones)
        .map(|(grey, zone)| (grey, zone.name.unwrap_or_default()))
        .collect();
    claims.sort_by(|a, b| b.0.total_cmp(&a.0));
    let tile = UvTile::at(&at).filter(|_| scene.is_tiled());
    let at = tile.unwrap_or(UvTile::FIRST).local(&at);
    Err(SceneError::ZonesOverlap {
        scene: scene.path.clone(),
        first: claims[0].1.to_owned(),
        second: claims[1].1.to_owned(),
        tile: tile.map(UvTile::number),
        u: at.x,
        v: at.y,
        percent: 100.0 * sum,
    })
}

/// Places all over a triangle of the texture.
fn places(corners: &[Vector2<f64>; 3]) -> impl Iterator<Item = Vector2<f64>> + use<> {
    let [a, b, c] = *corners;
    (0..=PLACES).flat_map(move |i| {
        (0..=PLACES - i).map(move |j| {
            let [s, t] = [i, j].map(|k| f64::from(k) / f64::from(PLACES));
            a + (b - a) * s + (c - a) * t
        })
    })
}
