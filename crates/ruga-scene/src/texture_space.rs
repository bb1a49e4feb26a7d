//! Whether the UVs of a mesh can carry the maps of a pose.

use nalgebra::Vector2;
use ruga_bake::{UvLayout, UvReport, check_uvs, uv_layout};
use ruga_io::MeshFile;
use ruga_material::UvTile;

use crate::file::Tiles;
use crate::uv_tiles::{are_tiled, tiles_of};
use crate::{SceneError, counted};

/// Share of the skin in the unit square below which there is none: what rounding leaves of a layout
/// that was moved by whole tiles.
const LEAST_INSIDE: f64 = 1e-4;

/// Share of the skin outside the square, and in islands that lie in several tiles, from which on the
/// layout is taken to repeat, or to have another scale.
const REPEATED: f64 = 0.5;

/// Share of mirrored skin from which on V is taken to be upside down. Half of a face is often
/// mirrored on purpose.
const FLIPPED: f64 = 0.95;

/// Distance by which 32-bit texture coordinates miss the border of a tile.
const ROUNDING: f64 = 1e-5;

/// UVs of every triangle of the file, V down; `None` where the file has none.
pub(crate) fn corners(mesh: &MeshFile) -> Option<Vec<[Vector2<f64>; 3]>> {
    let uvs = mesh.mesh.uvs.as_ref()?;
    let triangles = mesh.mesh.triangles.iter();
    Some(triangles.map(|t| t.map(|v| uvs[v as usize])).collect())
}

/// The UDIM tiles of a mesh, ascending; the first one alone where it has none.
pub(crate) fn tiles(mesh: &MeshFile, wanted: Tiles) -> Vec<UvTile> {
    let uvs = corners(mesh).unwrap_or_default();
    tiles_of(&uvs, &areas(mesh), wanted)
}

/// Areas of every triangle of the file, m².
fn areas(mesh: &MeshFile) -> Vec<f64> {
    let at = |v: u32| mesh.mesh.positions[v as usize];
    let triangles = mesh.mesh.triangles.iter();
    triangles
        .map(|&[a, b, c]| (at(b) - at(a)).cross(&(at(c) - at(a))).norm() / 2.0)
        .collect()
}

/// Refuses UVs that no map can show, and says what else is unusual about them.
///
/// Returns warnings with counts: overlaps anywhere, UVs outside the unit square or the mesh's `tiles`,
/// triangles without a place in them, V upside down.
///
/// # Errors
/// [`SceneError::MissingUvs`]; [`SceneError::UvLayout`] when all UVs are on one spot, or none in the
/// square.
pub(crate) fn check(mesh: &MeshFile, tiles: &[UvTile]) -> Result<Vec<String>, SceneError> {
    let Some(uvs) = corners(mesh) else {
        // The driver refuses a mesh without UVs before this is asked.
        return Ok(Vec::new());
    };
    let report = check_uvs(&uvs);
    if let Some(&first) = report.missing.first() {
        return Err(SceneError::MissingUvs {
            mesh: mesh.path.clone(),
            count: report.missing.len(),
            first,
        });
    }
    let whose = format!("`{}`", mesh.mesh.name);
    let layout = uv_layout(&uvs, &areas(mesh)).ok_or_else(|| not_unwrapped(mesh, &uvs))?;
    let is_tiled = are_tiled(tiles);
    if !is_tiled && layout.inside < LEAST_INSIDE {
        return Err(outside(mesh, &whose, &layout));
    }
    let mut warnings = Vec::new();
    let mut warn = |text: String| warnings.push(format!("{}: {text}", mesh.path.display()));
    if let Some((face, other)) = report.overlaps.first() {
        warn(format!(
            "the texture coordinates of {} overlap others, the first are {other} and {face}; \
             wrinkles on one show on the other; give each its own place, unless the copies are \
             meant",
            counted(report.overlapping, "triangle")
        ));
    }
    let in_no_tile = in_no_tile(&uvs, &report.zero_area);
    if let Some(&first) = in_no_tile.first().filter(|_| is_tiled) {
        warn(format!(
            "the texture coordinates of {} are not in one UDIM tile, the first is triangle {first}, {}; it \
             cannot wrinkle: move it into a tile if it should",
            counted(in_no_tile.len(), "triangle"),
            tile_fault(&uvs[first as usize])
        ));
    }
    if let Some(first) = report.outside.first().filter(|_| !is_tiled) {
        warn(format!(
            "the texture coordinates of {} leave the square from 0 to 1, the first is triangle \
             {first}; what lies outside is not baked, {} of the skin; move it into the square if it is to \
             wrinkle, or write `tiles = \"udim\"` under [driver] if these are UDIM tiles",
            counted(report.outside.len(), "triangle"),
            percent(1.0 - layout.inside)
        ));
    }
    if let Some(first) = report.zero_area.first() {
        warn(format!(
            "the texture coordinates of {} have no area, the first is triangle {first}; it shows \
             no wrinkles: unwrap it if it should",
            counted(report.zero_area.len(), "triangle")
        ));
    }
    if layout.mirrored > FLIPPED {
        warn(format!(
            "the texture coordinates are mirrored on {} of the skin, as if V ran the other way than \
             it does in this kind of file; if your images lie on the mesh upside down, the maps will \
             too, with green reversed: flip V where the file was exported",
            percent(layout.mirrored)
        ));
    }
    Ok(warnings)
}

/// Refuses poses whose active triangles (numbers of the file, each once) have no place of their own
/// in the maps.
///
/// Returns a warning for every pose that only other poses keep from being refused.
///
/// # Errors
/// [`SceneError::OverlappingUvs`] naming two triangles; [`SceneError::UvLayout`] when what is active in
/// any pose lies outside the square, or on a layout larger than it, or when a triangle is not in one of
/// the mesh's `tiles`.
pub(crate) fn check_active(
    (mesh, tiles): (&MeshFile, &[UvTile]),
    poses: &[(String, Vec<u32>)],
) -> Result<Vec<String>, SceneError> {
    let Some(uvs) = corners(mesh) else {
        return Ok(Vec::new());
    };
    let areas = areas(mesh);
    let layout = |active: &[u32]| {
        let uvs = chosen(active, &uvs);
        let areas: Vec<_> = active.iter().map(|&t| areas[t as usize]).collect();
        uv_layout(&uvs, &areas)
    };
    let mut all: Vec<u32> = poses
        .iter()
        .flat_map(|(_, active)| active)
        .copied()
        .collect();
    all.sort_unstable();
    all.dedup();
    if are_tiled(tiles) {
        for (pose, active) in poses {
            let chosen = chosen(active, &uvs);
            let report = check_uvs(&chosen);
            refuse_overlaps((mesh, pose), active, &report)?;
            refuse_several_tiles((mesh, pose), active, (&chosen, &report))?;
        }
        return Ok(Vec::new());
    }
    let whose = format!("the skin of `{}` that is simulated", mesh.mesh.name);
    match layout(&all) {
        Some(layout) if layout.inside < LEAST_INSIDE => return Err(outside(mesh, &whose, &layout)),
        Some(layout) if layout.inside < 1.0 - REPEATED && layout.astride > REPEATED => {
            return Err(too_large(mesh, &whose, &layout));
        }
        _ => {}
    }
    let mut warnings = Vec::new();
    for (pose, active) in poses {
        refuse_overlaps((mesh, pose), active, &check_uvs(&chosen(active, &uvs)))?;
        if let Some(layout) = layout(active).filter(|layout| layout.inside < LEAST_INSIDE) {
            warnings.push(format!(
                "{}: pose `{pose}`: the texture coordinates of the skin that is simulated {}; the \
                 maps of this pose are neutral: move that skin into the square if it is to wrinkle",
                mesh.path.display(),
                place(&layout)
            ));
        }
    }
    Ok(warnings)
}

/// Texture coordinates of these triangles.
fn chosen(triangles: &[u32], uvs: &[[Vector2<f64>; 3]]) -> Vec<[Vector2<f64>; 3]> {
    triangles.iter().map(|&t| uvs[t as usize]).collect()
}

fn refuse_overlaps(
    (mesh, pose): (&MeshFile, &str),
    active: &[u32],
    report: &UvReport,
) -> Result<(), SceneError> {
    match report.overlaps.first() {
        None => Ok(()),
        Some(&(face, other)) => Err(SceneError::OverlappingUvs {
            mesh: mesh.path.clone(),
            pose: pose.to_owned(),
            first: active[other as usize],
            second: active[face as usize],
            triangles: report.overlapping,
        }),
    }
}

/// Triangles, but for those without area, that lie in several tiles or in none.
fn in_no_tile(uvs: &[[Vector2<f64>; 3]], zero_area: &[u32]) -> Vec<u32> {
    let all = 0..uvs.len() as u32;
    let has_area = |triangle: &u32| zero_area.binary_search(triangle).is_err();
    all.filter(has_area)
        .filter(|&triangle| UvTile::of_triangle(&uvs[triangle as usize]).is_none())
        .collect()
}

fn refuse_several_tiles(
    (mesh, pose): (&MeshFile, &str),
    active: &[u32],
    (chosen, report): (&[[Vector2<f64>; 3]], &UvReport),
) -> Result<(), SceneError> {
    let outside = in_no_tile(chosen, &report.zero_area);
    let Some(&first) = outside.first() else {
        return Ok(());
    };
    Err(SceneError::UvLayout {
        mesh: mesh.path.clone(),
        problem: format!(
            "{} of the skin that pose `{pose}` wrinkles {} not in one UDIM tile, the first is triangle {}, {}",
            counted(outside.len(), "triangle"),
            if outside.len() == 1 { "is" } else { "are" },
            active[first as usize],
            tile_fault(&chosen[first as usize])
        ),
        advice: "move every island into one tile, with U from 0 to 10 and V from 0 up; if the mesh has no \
                 UDIM tiles, `tiles = \"one\"` under [driver] bakes the square from 0 to 1 alone",
    })
}

/// Words for a triangle that is not in one tile, V *up*, as editors show it.
fn tile_fault(uvs: &[Vector2<f64>; 3]) -> String {
    let corner = |uv: &Vector2<f64>| format!("({:.3}, {:.3})", uv.x, 1.0 - uv.y);
    let corners = uvs.each_ref().map(corner).join(", ");
    // Towards the middle, where a corner on a border is in the triangle's own tile.
    let middle = (uvs[0] + uvs[1] + uvs[2]) / 3.0;
    let tile = |uv: &Vector2<f64>| UvTile::at(&(uv + (middle - uv) * ROUNDING));
    let Some(mut tiles) = uvs.iter().map(tile).collect::<Option<Vec<UvTile>>>() else {
        return format!("which reaches beyond all tiles with its corners at {corners}");
    };
    tiles.sort_unstable();
    tiles.dedup();
    let numbers: Vec<String> = tiles.iter().map(|tile| tile.number().to_string()).collect();
    format!(
        "which spans tiles {} with its corners at {corners}",
        numbers.join(" and ")
    )
}

fn not_unwrapped(mesh: &MeshFile, uvs: &[[Vector2<f64>; 3]]) -> SceneError {
    let mut all = uvs.iter().flatten();
    let first = all.next().copied().unwrap_or_default();
    let found = match all.all(|uv| *uv == first) {
        // Zero in the file is one where V was turned over on reading.
        true if first.x == 0.0 && (first.y == 0.0 || first.y == 1.0) => "are all zero",
        true => "all lie on one point",
        false => "have no area",
    };
    SceneError::UvLayout {
        mesh: mesh.path.clone(),
        problem: format!(
            "the texture coordinates of `{}` {found}: the mesh is not unwrapped",
            mesh.mesh.name
        ),
        advice: "unwrap the mesh, so that every part of the skin has its own place in the square \
                 from 0 to 1, and export it again",
    }
}

fn outside(mesh: &MeshFile, whose: &str, layout: &UvLayout) -> SceneError {
    SceneError::UvLayout {
        mesh: mesh.path.clone(),
        problem: format!("the texture coordinates of {whose} {}", place(layout)),
        advice: "move them to the square from 0 to 1, or to UDIM tiles, with U from 0 to 10 and V from 0 up; \
                 with `tiles = \"one\"` under [driver] only that square is baked",
    }
}

fn too_large(mesh: &MeshFile, whose: &str, layout: &UvLayout) -> SceneError {
    let [low, high] = extent(layout);
    SceneError::UvLayout {
        mesh: mesh.path.clone(),
        problem: format!(
            "the texture coordinates of {whose} span {} x {} tiles, from {} to {}; only {} of it \
             lies in the square from 0 to 1",
            high[0] - low[0],
            high[1] - low[1],
            point(low),
            point(high),
            percent(layout.inside)
        ),
        advice: "scale them down into the square from 0 to 1: a wrinkle map does not repeat; if these are UDIM \
                 tiles, write `tiles = \"udim\"` under [driver]",
    }
}

/// Words for the place of a layout that is outside the square.
fn place(layout: &UvLayout) -> String {
    let [low, high] = extent(layout);
    let range = format!("from {} to {}", point(low), point(high));
    match [high[0] - low[0], high[1] - low[1]] {
        [1, 1] => format!("all lie in the tile {range}"),
        [across, up] => {
            format!("span {across} x {up} tiles, {range}, none of it in the square from 0 to 1")
        }
    }
}

/// The first and last corner of the tiles that a layout lies in, V *up*, as editors show it.
fn extent(layout: &UvLayout) -> [[i64; 2]; 2] {
    // Far beyond any layout, but small enough for integers and their differences.
    let tile = |c: f64| c.clamp(-1e12, 1e12) as i64;
    let low = [layout.low.x, 1.0 - layout.high.y].map(|c| tile((c + ROUNDING).floor()));
    let high = [layout.high.x, 1.0 - layout.low.y].map(|c| tile((c - ROUNDING).ceil()));
    [low, [0, 1].map(|c| high[c].max(low[c] + 1))]
}

fn point([u, v]: [i64; 2]) -> String {
    format!("({u}, {v})")
}

fn percent(share: f64) -> String {
    match 100.0 * share {
        small if small < 1.0 => "less than 1 %".to_owned(),
        share => format!("{share:.0} %"),
    }
}
