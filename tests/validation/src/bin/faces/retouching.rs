//! Faults that an artist would have to retouch: relief in skin that does not wrinkle, speckle in skin that does.

use std::error::Error;
use std::path::Path;

use nalgebra::{Matrix2, Vector2, Vector3};
use ruga_bake::{Coverage, WrinkleMap};
use ruga_mesh::triangle_frame;
use ruga_scene::{Scene, SceneOptions};
use ruga_stepper::{FaceState, KeyResult, LayerSurface, Modelling, Observer};
use ruga_validation::asset;

use crate::baking::Quality;
use crate::rows::{Bench, Lines};
use crate::scenes::{Model, preset_layer};
use crate::speckle::speckle;
use crate::table::{Goal, Line};

/// Largest angle of a map where nothing wrinkles, degrees.
const NEUTRAL_DEG: f64 = 0.2;

/// Strain ratio below which skin is quiet: it does not wrinkle.
const QUIET: f64 = 0.5;

/// Length of a way of straight and slanting steps from texel to texel over that of the straight way, at most: at half of
/// the angle between the two, `1/cos(22.5°)`.
const STEPPED: f64 = 1.083;

/// Largest fraction of the relief's energy in wavelengths under 40 % of the critical one, percent.
const SPECKLE_PERCENT: f64 = 1.0;

/// Keys of every pose: the last alone, which a plan's picture shows.
const KEYS: [f64; 1] = [1.0];

/// What was found in a pose.
struct Found {
    pose: String,
    /// Texels of quiet skin, and those of them that are tilted too far.
    quiet: usize,
    tilted: usize,
    /// Largest angle there, a quarter of a wavelength or more from other skin, degrees.
    steepest: f64,
    /// Percent of squared heights, and of squared slopes, in short waves.
    speckle: [f64; 2],
}

impl Bench {
    /// Bakes every pose of two faces and looks at maps where skin is smooth, and at short waves.
    pub(crate) fn retouching(&self) -> Lines {
        let quality = self.quality.unwrap_or(Quality::Standard);
        let folder = self.folder.join(quality.name()).join("retouching");
        std::fs::create_dir_all(&folder)?;
        let mut scenes = vec![("our face", asset("face/scene.toml"))];
        if let Some(face) = Model::face() {
            let layers = [preset_layer("forehead-furrow")];
            let path = folder.join("scene.toml");
            std::fs::write(&path, face.scene("", &layers, (&face.shapes()?, &KEYS))?)?;
            scenes.push(("shared face", path));
        }
        let mut lines = Vec::new();
        for (name, path) in scenes {
            lines.extend(summary(name, &looked_at(&path, quality)?));
        }
        Ok(lines)
    }
}

/// Simulates and bakes every pose of a scene at its last key.
fn looked_at(path: &Path, quality: Quality) -> Result<Vec<Found>, Box<dyn Error>> {
    let mut scene = Scene::read_with(path, &SceneOptions::default())?;
    scene.modelling = Modelling {
        points_per_wavelength: quality.points(),
        ..scene.modelling
    };
    for pose in &mut scene.poses {
        pose.keys = KEYS.to_vec();
    }
    let plan = scene.plan()?;
    let mut found = Vec::new();
    for (number, pose) in scene.poses.iter().enumerate() {
        let result = plan.simulate(number, &mut StatesOfFaces)?;
        let Some(key) = result.keys.last() else {
            eprintln!("{}: no result", pose.name);
            continue;
        };
        // Both faces lie in one tile.
        let map = &scene.bake_key(pose, key)?[0];
        let asked = Asked::new(map.size, key)?;
        let own = found_in(&pose.name, map, &asked, key)?;
        eprintln!(
            "{}: {} of {} quiet texels, up to {:.2} degrees; speckle {:.2} % of heights, {:.2} % of slopes",
            own.pose, own.tilted, own.quiet, own.steepest, own.speckle[0], own.speckle[1]
        );
        found.push(own);
    }
    Ok(found)
}

fn found_in(
    pose: &str,
    map: &WrinkleMap,
    asked: &Asked,
    key: &KeyResult,
) -> Result<Found, Box<dyn Error>> {
    let mut own = Found {
        pose: pose.to_owned(),
        quiet: 0,
        tilted: 0,
        steepest: 0.0,
        speckle: [0.0; 2],
    };
    let distances = asked.to_loud();
    for (texel, normal) in map.normals.iter().enumerate() {
        if !asked.is_quiet[texel] || map.coverage[texel] != Coverage::Covered {
            continue;
        }
        let degrees = angle_deg(normal);
        own.quiet += 1;
        own.tilted += usize::from(degrees > NEUTRAL_DEG);
        if distances[texel] > asked.room[texel] {
            own.steepest = own.steepest.max(degrees);
        }
    }
    for layer in &key.layers {
        let short = speckle(layer, states(layer)?)?;
        for (most, own) in own.speckle.iter_mut().zip(short) {
            *most = most.max(100.0 * own);
        }
    }
    Ok(own)
}

/// What the run says of every face of a layer.
fn states(layer: &LayerSurface) -> Result<&[FaceState], Box<dyn Error>> {
    let states = layer.face_states.as_deref();
    states.ok_or_else(|| format!("{}: no strains", layer.name).into())
}

fn angle_deg(normal: &[f32; 3]) -> f64 {
    let [x, y, z] = normal.map(f64::from);
    x.hypot(y).atan2(z).to_degrees()
}

/// Watches nothing, and asks for how strained skin is.
struct StatesOfFaces;

impl Observer for StatesOfFaces {
    fn wants_frames(&self) -> bool {
        false
    }

    fn wants_face_states(&self) -> bool {
        true
    }
}

/// What the run itself says of the texels of a map.
struct Asked {
    size: usize,
    /// Whether no layer is strained anywhere in them to half of what wrinkles it.
    is_quiet: Vec<bool>,
    /// Distance from other skin (texels) beyond which it is a quarter of the longest wavelength away, whichever way
    /// the texture is stretched. Relief fades by distances on the skin: with those in the texture, what is shown there
    /// was smooth skin with room where the texture runs closer the other way.
    room: Vec<f32>,
}

impl Asked {
    fn new(size: u32, key: &KeyResult) -> Result<Self, Box<dyn Error>> {
        let texels = (size * size) as usize;
        let mut asked = Self {
            size: size as usize,
            is_quiet: vec![true; texels],
            room: vec![0.0; texels],
        };
        for layer in &key.layers {
            let faces = layer.faces.iter().zip(layer.uvs.iter());
            for (state, (face, uvs)) in states(layer)?.iter().zip(faces) {
                let corners = face.map(|v| layer.driver_positions[v as usize]);
                let quarter = 0.25 * state.wavelength * stretch(&corners, uvs);
                let room = (STEPPED * f64::from(size) * quarter) as f32;
                for_texels(size, *uvs, |texel| {
                    asked.is_quiet[texel] &= state.strain_ratio < QUIET;
                    asked.room[texel] = asked.room[texel].max(room);
                });
            }
        }
        Ok(asked)
    }

    /// Distance of every texel from skin that is not quiet (texels), over straight and slanting steps.
    fn to_loud(&self) -> Vec<f32> {
        let size = self.size;
        let start = self
            .is_quiet
            .iter()
            .map(|quiet| if *quiet { f32::INFINITY } else { 0.0 });
        let mut distances: Vec<f32> = start.collect();
        let texels: Vec<usize> = (0..size * size).collect();
        let mut pass = |order: &mut dyn Iterator<Item = &usize>, steps: [(isize, isize); 4]| {
            for &texel in order {
                let (row, column) = ((texel / size) as isize, (texel % size) as isize);
                for (down, right) in steps {
                    let (row, column) = (row + down, column + right);
                    let inside = 0..size as isize;
                    if inside.contains(&row) && inside.contains(&column) {
                        let step = f32::hypot(down as f32, right as f32);
                        let other = distances[row as usize * size + column as usize];
                        distances[texel] = distances[texel].min(other + step);
                    }
                }
            }
        };
        pass(&mut texels.iter(), [(-1, -1), (-1, 0), (-1, 1), (0, -1)]);
        pass(&mut texels.iter().rev(), [(1, 1), (1, 0), (1, -1), (0, 1)]);
        distances
    }
}

/// Texture coordinates per metre of skin, the way in which they are the most.
fn stretch(corners: &[Vector3<f64>; 3], uvs: &[Vector2<f64>; 3]) -> f64 {
    let frame = triangle_frame(corners);
    let flat = |corner: usize| {
        let way = corners[corner] - corners[0];
        Vector2::new(way.dot(&frame[0]), way.dot(&frame[1]))
    };
    let skin = Matrix2::from_columns(&[flat(1), flat(2)]);
    let texture = Matrix2::from_columns(&[uvs[1] - uvs[0], uvs[2] - uvs[0]]);
    let from_skin = skin.try_inverse().unwrap_or_else(Matrix2::zeros);
    (texture * from_skin).singular_values().max()
}

/// Calls `act` with every texel that a face touches.
///
/// Where the texture is squeezed a face is smaller than a texel, holds the centre of none, and is shown all the same.
fn for_texels(size: u32, uvs: [Vector2<f64>; 3], mut act: impl FnMut(usize)) {
    let [a, b, c] = uvs.map(|uv| uv * f64::from(size));
    let turn = cross(b - a, c - a).signum();
    let bounds = |of: fn(&Vector2<f64>) -> f64| {
        let [low, high] = [f64::min, f64::max].map(|pick| pick(pick(of(&a), of(&b)), of(&c)));
        let last = i64::from(size) - 1;
        (low.floor() as i64).clamp(0, last)..=(high.ceil() as i64 - 1).clamp(0, last)
    };
    for row in bounds(|p| p.y) {
        for column in bounds(|p| p.x) {
            let centre = Vector2::new(column as f64 + 0.5, row as f64 + 0.5);
            let is_beyond = |(p, q): (Vector2<f64>, Vector2<f64>)| {
                // The corner of the texel that lies furthest on the inner side.
                let reach = 0.5 * (q - p).lp_norm(1);
                turn * cross(p - centre, q - centre) < -reach
            };
            if ![(b, c), (c, a), (a, b)].into_iter().any(is_beyond) {
                act((row * i64::from(size) + column) as usize);
            }
        }
    }
}

fn cross(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}

/// The worst of all poses, and how many miss.
fn summary(name: &str, found: &[Found]) -> Vec<Line> {
    let most = |of: fn(&Found) -> f64| found.iter().map(of).fold(0.0, f64::max);
    let tilted = |own: &Found| 100.0 * own.tilted as f64 / (own.quiet.max(1)) as f64;
    vec![
        Line::judged(
            format!(
                "{name}, {} poses, steepest in smooth skin with room for a wave",
                found.len()
            ),
            (Goal::AtMost(NEUTRAL_DEG), "degrees"),
            most(|own| own.steepest),
        ),
        Line::note(format!(
            "{name}, texels of smooth skin steeper than that, at most {:.3} %",
            found.iter().map(tilted).fold(0.0, f64::max)
        )),
        Line::judged(
            format!("{name}, squared heights in short waves, worst"),
            (Goal::AtMost(SPECKLE_PERCENT), "%"),
            most(|own| own.speckle[0]),
        ),
        Line::note(format!(
            "{name}, squared slopes in short waves, worst {:.2} %",
            most(|own| own.speckle[1])
        )),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texels(uvs: [[f64; 2]; 3]) -> Vec<usize> {
        let mut found = Vec::new();
        for_texels(4, uvs.map(|[u, v]| Vector2::new(u, v)), |texel| {
            found.push(texel)
        });
        found
    }

    #[test]
    fn a_face_smaller_than_a_texel_is_in_one() {
        // A quarter is a texel.
        assert_eq!(texels([[0.51, 0.26], [0.56, 0.26], [0.51, 0.31]]), [6]);
        assert_eq!(texels([[0.51, 0.26], [0.51, 0.31], [0.56, 0.26]]), [6]);
    }

    #[test]
    fn a_face_is_in_the_texels_that_it_touches() {
        let corner = texels([[0.0, 0.0], [0.6, 0.0], [0.0, 0.6]]);
        assert_eq!(corner, [0, 1, 2, 4, 5, 8]);
        assert_eq!(texels([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]).len(), 13);
    }
}
