//! What is wrong or odd about the creases of a layer together.

use std::collections::BTreeMap;

use ruga_crease::{CreaseError, CreaseWarning, TracedLine, check_lines};
use ruga_material::wrinkling;
use ruga_stepper::LayerSpec;

use crate::SceneError;
use crate::creases::CreasedMesh;
use crate::network_creases::NETWORK;

/// Something that is too close to a line.
struct Oddity {
    line: usize,
    /// How close (m).
    distance: f64,
    /// The warning.
    told: String,
}

impl CreasedMesh<'_> {
    /// Checks the lines of a layer against each other and the border of the mesh; each has a key. Returns warnings:
    /// an image may have hundreds of strokes, so that of what is alike only the worst is told, with a count.
    pub(crate) fn check_together(
        &self,
        (layer, keys): (&LayerSpec, &[String]),
        points: f64,
    ) -> Result<Vec<String>, SceneError> {
        let waves = wrinkling(&layer.material, &layer.substrate, layer.model);
        // A layer that cannot be has been refused.
        let Ok(waves) = waves else {
            return Ok(Vec::new());
        };
        let lines: Vec<TracedLine> = layer.creases.iter().map(|spec| spec.line.clone()).collect();
        let name = |line: usize| format!("crease `{}`", layer.creases[line].name);
        let on = (self.driver.topology(), self.driver.rest());
        let edge = self.wavelength(&waves, points) / points;
        let found = check_lines(&lines, on, edge).map_err(|error| {
            let (line, reason) = refusal(error, &name);
            self.fault(keys[line].clone(), reason, None)
        })?;
        let mut warnings = Vec::new();
        let mut close = Vec::new();
        for warning in &found {
            let told = warning.told(&name);
            match *warning {
                CreaseWarning::TooClose {
                    lines: [line, _],
                    distance,
                    ..
                } => close.push(Oddity {
                    line,
                    distance,
                    told,
                }),
                _ => warnings.push(told),
            }
        }
        let many = |key: &str, count| {
            format!(
                "`{key}`: {count} pairs of lines, or of parts of one, come closer than two edges of the mesh, \
                 {:.2} mm each; the closest:",
                1e3 * edge
            )
        };
        warnings.extend(worst_of_each(close, keys, &many));
        // Lines that wrinkles have left lie where nobody has drawn them.
        let drawn = lines.iter().enumerate();
        let drawn = drawn.filter(|(line, _)| keys[*line] != NETWORK);
        let beside = drawn.filter_map(|(line, traced)| {
            let ([from, to], distance) = traced.beside_border(on, edge)?;
            let told = format!(
                "{} comes within {:.2} mm of the border of the surface, between {:.2} and {:.2} mm from its start: \
                 that is less than an edge of the mesh, {:.2} mm, and too little to fold against; move the line \
                 inwards there",
                name(line),
                1e3 * distance,
                1e3 * from,
                1e3 * to,
                1e3 * edge
            );
            Some(Oddity {
                line,
                distance,
                told,
            })
        });
        let many = |key: &str, count| {
            format!(
                "`{key}`: {count} lines come closer to the border of the surface than an edge of the mesh; the \
                 closest:"
            )
        };
        warnings.extend(worst_of_each(beside.collect(), keys, &many));
        Ok(warnings)
    }
}

/// The line that is to blame for a refusal, and why, with lines called by `name`.
fn refusal(error: CreaseError, name: &dyn Fn(usize) -> String) -> (usize, String) {
    match error {
        CreaseError::TooShort { line, length, edge } => {
            let reason = format!(
                "{} is {:.2} mm long, less than two edges of the mesh, which are {:.2} mm; lengthen it, or leave it \
                 out",
                name(line),
                1e3 * length,
                1e3 * edge
            );
            (line, reason)
        }
        CreaseError::IdenticalLines { lines: [a, b] } => {
            let reason = format!(
                "{} and {} lie on each other; leave one out",
                name(a),
                name(b)
            );
            (b, reason)
        }
        other => (0, other.to_string()),
    }
}

/// One warning for the lines of each key: the words for the smallest distance, after those that `many` has for a key
/// and a count of several.
fn worst_of_each(
    alike: Vec<Oddity>,
    keys: &[String],
    many: &dyn Fn(&str, usize) -> String,
) -> Vec<String> {
    // By the first line of a key, so that they come in the order of the file.
    let mut of_keys: BTreeMap<Option<usize>, Vec<Oddity>> = BTreeMap::new();
    for oddity in alike {
        let key = &keys[oddity.line];
        let first = keys.iter().position(|other| other == key);
        of_keys.entry(first).or_default().push(oddity);
    }
    let told = of_keys.into_values().filter_map(|alike| {
        let count = alike.len();
        let mut alike = alike.into_iter();
        let first = alike.next()?;
        let worst = alike.fold(first, |worst, next| {
            if next.distance < worst.distance {
                next
            } else {
                worst
            }
        });
        Some(match count {
            1 => worst.told,
            _ => format!("{} {}", many(&keys[worst.line], count), worst.told),
        })
    });
    told.collect()
}
