//! Whether a mesh is as large as something with skin, or in another unit than it was taken for.

use nalgebra::Vector3;
use ruga_io::{LengthUnit, MeshFile};
use ruga_material::wrinkling;
use ruga_stepper::LayerSpec;

use crate::SceneError;
use crate::file::SceneFile;

/// Nothing with skin is wider (m): an elephant is 4 m, a person 2 m.
const WIDEST: f64 = 5.0;

/// Nothing that somebody bakes is smaller (m): half the tip of a finger.
const NARROWEST: f64 = 5e-3;

/// Width in wavelengths from which on a mesh is in a wrong unit: as many furrows of a
/// forehead as fit into the height of a person. A giant whose waves are in proportion has no more.
const MANY_WAVES: f64 = 200.0;

/// Below this many wavelengths a mesh that is too small is in a wrong unit.
const FEW_WAVES: f64 = 4.0;

/// Widths in metres that make a unit a good guess: from a fingertip to a horse.
const LIKELY: std::ops::RangeInclusive<f64> = 0.01..=3.0;

/// The longest side of the box around the mesh, m.
pub fn width(mesh: &MeshFile) -> f64 {
    let corners = mesh.mesh.triangles.iter().flatten();
    let used = corners.filter_map(|&v| mesh.mesh.positions.get(v as usize));
    let mut low = Vector3::repeat(f64::INFINITY);
    let mut high = Vector3::repeat(f64::NEG_INFINITY);
    for position in used {
        low = low.inf(position);
        high = high.sup(position);
    }
    (high - low).max().max(0.0)
}

/// Refuses a mesh of a size that no skin has; returns a warning where that may be on purpose.
///
/// The scene has its word: with `scale`, or a `length_unit` other than metres, the size is what the
/// user says it is, and only a warning is left.
///
/// # Errors
/// [`SceneError::Unit`] with the key that mends it.
pub(crate) fn check(
    scene: &SceneFile,
    mesh: &MeshFile,
    layers: &[LayerSpec],
) -> Result<Option<String>, SceneError> {
    let width = width(mesh);
    // A sheet has no wave to compare with.
    let layers = if scene.sheet.is_some() { &[] } else { layers };
    let Some(wavelength) = shortest_wavelength(layers).filter(|_| width > 0.0) else {
        return Ok(None);
    };
    let waves = width / wavelength;
    let is_strange =
        (width > WIDEST && waves > MANY_WAVES) || (width < NARROWEST && waves < FEW_WAVES);
    let is_said = scene.driver.scale.is_some() || scene.length_unit != LengthUnit::Metre;
    if is_strange && !is_said {
        let (question, remedy) = words(mesh, width);
        return Err(SceneError::Unit {
            mesh: mesh.path.clone(),
            width: length(width),
            question,
            remedy,
        });
    }
    let size = |what: &str, or: &str| {
        let key = if is_said {
            "check the unit given"
        } else {
            "check the unit of the file"
        };
        Some(format!(
            "{}: the mesh is {} wide and its shortest wrinkles are {} long: {what}; {key} (`scale` \
             under [driver]){or}",
            mesh.path.display(),
            length(width),
            length(wavelength)
        ))
    };
    Ok(match waves {
        _ if is_strange && width > WIDEST => size("nothing with skin is that large", ""),
        waves if waves < 2.0 => size(
            "it has no room for two of them",
            ", or the layer's `thickness`, which is in metres",
        ),
        _ => None,
    })
}

fn shortest_wavelength(layers: &[LayerSpec]) -> Option<f64> {
    let wavelengths = layers.iter().filter_map(|layer| {
        let wrinkling = wrinkling(&layer.material, &layer.substrate, layer.model).ok()?;
        Some(wrinkling.wavelength)
    });
    wavelengths.min_by(f64::total_cmp)
}

/// Question what the unit might be, and advice what to write for each guess.
fn words(mesh: &MeshFile, width: f64) -> (String, String) {
    let is_obj = (mesh.path.extension()).is_some_and(|e| e.eq_ignore_ascii_case("obj"));
    let key = |name: &str, scale: f64| match name {
        "cm" | "mm" if is_obj => format!("`length_unit = \"{name}\"` at the top of the scene"),
        _ => format!("`scale = {scale}` under [driver]"),
    };
    let right = "if it is right, `scale = 1.0` under [driver] says so";
    let Some((unit, scale)) = likely_scale(width) else {
        let question = "in which unit is it?".to_owned();
        let remedy = "give `scale` under [driver]: metres per unit of the file";
        return (question, format!("{remedy}; {right}"));
    };
    let then = length(width * scale);
    match unit {
        "cm" | "mm" => {
            let word = if unit == "cm" {
                "centimetres"
            } else {
                "millimetres"
            };
            let remedy = format!(
                "if so, write {}: it is {then} then; {right}",
                key(unit, scale)
            );
            (format!("is it in {word}?"), remedy)
        }
        _ => {
            let question = format!("was it made {scale} times too small on its way?");
            let remedy = format!(
                "if so, write {}: it is {then} then; {right}",
                key(unit, scale)
            );
            (question, remedy)
        }
    }
}

/// Unit and metres per unit that make a mesh of this width likely, the commonest slip first.
pub fn likely_scale(width: f64) -> Option<(&'static str, f64)> {
    let slips = [("cm", 0.01), ("mm", 0.001), ("", 100.0), ("", 1000.0)];
    let is_too_wide = width > WIDEST;
    slips
        .into_iter()
        .filter(|(_, scale)| (*scale < 1.0) == is_too_wide)
        .find(|(_, scale)| LIKELY.contains(&(width * scale)))
}

/// Whether nothing with skin has this width (m).
pub fn is_unlikely(width: f64) -> bool {
    !(NARROWEST..=WIDEST).contains(&width)
}

/// A length in the unit that people would use for it.
pub fn length(metres: f64) -> String {
    let (value, unit) = match metres {
        m if m >= 1.0 => (m, "m"),
        m if m >= 0.02 => (100.0 * m, "cm"),
        m => (1000.0 * m, "mm"),
    };
    let rounded = if value >= 100.0 {
        value.round()
    } else {
        (10.0 * value).round() / 10.0
    };
    format!("{rounded} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_units_are_guessed() {
        for (width, scale) in [
            (21.0, Some(("cm", 0.01))),
            (180.0, Some(("cm", 0.01))),
            (1800.0, Some(("mm", 0.001))),
            (0.002, Some(("", 100.0))),
            (0.00002, Some(("", 1000.0))),
            (1e9, None),
        ] {
            assert_eq!(likely_scale(width), scale, "{width}");
        }
    }

    #[test]
    fn lengths_read_well() {
        for (metres, text) in [
            (21.04, "21 m"),
            (0.21, "21 cm"),
            (0.0103, "10.3 mm"),
            (1234.4, "1234 m"),
            (0.002, "2 mm"),
        ] {
            assert_eq!(length(metres), text);
        }
    }
}
