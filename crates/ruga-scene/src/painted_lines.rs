//! Creases along the strokes of a painted image.

use std::path::{Path, PathBuf};

use nalgebra::Vector2;
use ruga_crease::{
    CreaseError, GreyImage, SkeletonSettings, Stroke, TracedLine, TracedStrokes, skeleton_lines,
};
use ruga_io::read_mask;
use ruga_material::UvTile;

use crate::SceneError;
use crate::crease_lines::corners;
use crate::creases::CreasedMesh;
use crate::file::Crease;
use crate::painted_files::tile_files;

/// Strokes that a message names by their places; it counts the others.
const MOST_NAMED: usize = 6;

/// Share of a line's length that the width of its stroke has at least, with a wavelength, where it is an area: a
/// broad brush is none.
const AREA: f64 = 0.25;

/// The strokes of all images of a crease.
#[derive(Default)]
struct Painted {
    strokes: Vec<Stroke>,
    /// The image of every stroke.
    files: Vec<PathBuf>,
}

impl CreasedMesh<'_> {
    /// The lines of an image in a layer with waves of this length (m) and mesh edges of length `edge` (m), and warnings
    /// about strokes that are left out, outside of the islands or too short for the mesh, and about areas.
    pub(crate) fn painted(
        &self,
        (number, crease): (usize, &Crease),
        image: &Path,
        [wavelength, edge]: [f64; 2],
    ) -> Result<(Vec<TracedLine>, Vec<String>), SceneError> {
        let key = format!("creases[{number}].image");
        let painted = self.strokes(&key, image)?;
        let traced = self
            .tracer()
            .trace_strokes(&painted.strokes, corners(crease));
        let traced = traced.map_err(|error| self.bad_image(&key, image, error))?;
        self.check_strokes(&key, &painted, &traced)?;
        let mut warnings = beside_islands((crease, image), &painted, &traced);
        warnings.extend(area_warning((crease, image), &traced, wavelength));
        let mut lines = traced.lines;
        let all = lines.len();
        let longest = lines.iter().map(TracedLine::length).fold(0.0, f64::max);
        // If all are too short, the longest is told of as a line that was given alone.
        lines.retain(|line| !line.is_too_short(edge) || line.length() == longest);
        if lines.len() < all {
            warnings.push(format!(
                "crease `{}`: {} of {all} lines of strokes in {} left out, because they are shorter than two edges of \
                 the mesh, which are {:.2} mm",
                crease.name,
                all - lines.len(),
                image.display(),
                1e3 * edge
            ));
        }
        Ok((lines, warnings))
    }

    /// The strokes of all images that a key names.
    fn strokes(&self, key: &str, image: &Path) -> Result<Painted, SceneError> {
        let mut painted = Painted::default();
        let mut empty = None;
        for (tile, file) in tile_files(image, self.tiles) {
            match self.drawn((key, &file), tile)? {
                Ok(strokes) => {
                    painted.files.extend(vec![file; strokes.len()]);
                    painted.strokes.extend(strokes);
                }
                // Of several tiles only some may have lines.
                Err(error @ CreaseError::NoLineInImage { .. }) => {
                    empty.get_or_insert((file, error));
                }
                Err(error) => return Err(self.bad_image(key, &file, error)),
            }
        }
        match empty.filter(|_| painted.strokes.is_empty()) {
            Some((file, error)) => Err(self.bad_image(key, &file, error)),
            None => Ok(painted),
        }
    }

    /// The strokes that are painted in the image of a tile.
    fn drawn(
        &self,
        (key, file): (&str, &Path),
        tile: UvTile,
    ) -> Result<Result<Vec<Stroke>, CreaseError>, SceneError> {
        let image = read_mask(file).map_err(|source| SceneError::NamedFile {
            scene: self.path.to_owned(),
            key: key.to_owned(),
            source: Box::new(source),
        })?;
        let grey = GreyImage {
            width: image.width,
            height: image.height,
            values: &image.values,
        };
        let lines = skeleton_lines(&grey, &SkeletonSettings::default());
        let size = Vector2::new(image.width, image.height);
        let texel = size.map(|count| 1.0 / count as f64);
        Ok(lines.map(|lines| {
            let strokes = lines.into_iter().map(|line| Stroke {
                points: line.points.iter().map(|uv| tile.place(uv)).collect(),
                half_width: line.half_width,
                texel,
                is_closed: line.is_closed,
            });
            strokes.collect()
        }))
    }

    /// Refuses strokes that are no lines, and images with none on the islands.
    fn check_strokes(
        &self,
        key: &str,
        painted: &Painted,
        traced: &TracedStrokes,
    ) -> Result<(), SceneError> {
        if let Some(first) = traced.refused.first() {
            let words = of_stroke(&self.in_file(first.error.clone(), &[]), first.uv);
            let others = &traced.refused[1..];
            let others = match others.len() {
                0 => String::new(),
                1 => format!("; so is one {}", near(others.iter().map(|other| other.uv))),
                more => format!(
                    "; {more} more cannot be used, {}",
                    near(others.iter().map(|other| other.uv))
                ),
            };
            let file = &painted.files[first.stroke];
            return Err(self.bad_image(key, file, format!("{words}{others}")));
        }
        // What touches an island in one point has no length there.
        let all = 0..painted.strokes.len();
        match painted.files.first() {
            Some(file) if traced.lines.is_empty() => {
                let places = near(all.clone().map(|i| painted.middle(i)));
                let what = match all.len() {
                    1 => format!("{places} a stroke lies"),
                    more => format!("all {more} strokes, {places}, lie"),
                };
                let reason =
                    format!("{what} outside the islands of the texture layout; paint inside them");
                Err(self.bad_image(key, file, reason))
            }
            _ => Ok(()),
        }
    }

    fn bad_image(&self, key: &str, file: &Path, reason: impl std::fmt::Display) -> SceneError {
        self.fault(
            key.to_owned(),
            format!("{}: {reason}", file.display()),
            None,
        )
    }
}

impl Painted {
    /// Texture coordinates in the middle of a stroke.
    fn middle(&self, stroke: usize) -> Vector2<f64> {
        let points = &self.strokes[stroke].points;
        points.get(points.len() / 2).copied().unwrap_or_default()
    }
}

/// Warnings of strokes outside of the islands, and of those of which more lies there than paint that bleeds over
/// borders.
fn beside_islands(
    (crease, image): (&Crease, &Path),
    painted: &Painted,
    traced: &TracedStrokes,
) -> Vec<String> {
    let told = |strokes: &[usize], words: [&str; 2]| {
        let places = near(strokes.iter().map(|i| painted.middle(*i)));
        let [what, what_of_one] = words;
        let what = if strokes.len() == 1 {
            what_of_one
        } else {
            what
        };
        (!strokes.is_empty()).then(|| {
            format!(
                "crease `{}`: {} of {} strokes in {}, {places}, {what}",
                crease.name,
                strokes.len(),
                painted.strokes.len(),
                image.display()
            )
        })
    };
    let outside = told(
        &traced.outside,
        [
            "lie outside the islands of the texture layout and are left out",
            "lies outside the islands of the texture layout and is left out",
        ],
    );
    let shortened = told(
        &traced.shortened,
        [
            "lie in part outside the islands of the texture layout, where nothing folds",
            "lies in part outside the islands of the texture layout, where nothing folds",
        ],
    );
    let astray = told(
        &traced.astray,
        [
            "run over a gap of the texture layout onto an island that does not meet them there; what is short there \
             is left out. Paint them on one island, or on both sides of a seam",
            "runs over a gap of the texture layout onto an island that does not meet it there; what is short there \
             is left out. Paint it on one island, or on both sides of a seam",
        ],
    );
    let all = outside.into_iter().chain(shortened).chain(astray);
    all.collect()
}

/// Warning of painted areas, whose middle line means little; of several about the widest.
fn area_warning(
    (crease, image): (&Crease, &Path),
    traced: &TracedStrokes,
    wavelength: f64,
) -> Option<String> {
    let areas = traced.lines.iter().zip(&traced.widths);
    let areas = areas
        .filter(|(line, stroke)| stroke.width > wavelength && stroke.width > AREA * line.length());
    let (line, widest) = areas.max_by(|a, b| a.1.width.total_cmp(&b.1.width))?;
    Some(format!(
        "crease `{}`: {} a stroke in {} is {:.0} texels or {:.1} mm wide and its middle line {:.1} mm long: that is an \
         area and no line; paint lines as thin strokes",
        crease.name,
        near([widest.uv].into_iter()),
        image.display(),
        widest.texels,
        1e3 * widest.width,
        1e3 * line.length()
    ))
}

/// Where strokes are, in words.
fn near(places: impl ExactSizeIterator<Item = Vector2<f64>>) -> String {
    let more = places.len().saturating_sub(MOST_NAMED);
    let named = places.take(MOST_NAMED);
    let named: Vec<String> = named
        .map(|uv| format!("({:.3}, {:.3})", uv.x, uv.y))
        .collect();
    let more = match more {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("near UV {}{more}", named.join(", "))
}

/// What is wrong with a stroke of an image near a place, whose points nobody has numbered.
fn of_stroke(error: &CreaseError, uv: Vector2<f64>) -> String {
    let near = near([uv].into_iter());
    match error {
        CreaseError::AcrossSeam { face, .. } => format!(
            "{near} a stroke crosses a UV seam at triangle {face}; paint it on one island, or give the line by `uv` or `line_mesh`"
        ),
        CreaseError::LeavesSurface { face, .. } => {
            format!("{near} a stroke leaves the surface at triangle {face}; keep it on the skin")
        }
        CreaseError::OverlappingCharts { faces: [a, b], .. } => format!(
            "{near} a stroke lies in triangles {a} and {b}, which overlap in the texture layout; give the line by `line_mesh`, or move one of the islands"
        ),
        other => format!("{near} is a stroke that cannot be used: {other}"),
    }
}
