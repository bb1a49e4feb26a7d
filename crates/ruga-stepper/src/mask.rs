//! Painted masks over the UV square or UDIM tiles.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::Vector2;
use ruga_material::UvTile;

use crate::StepperError;
use crate::error::{Checked, refuse};

/// Painted grey images over the UV square or UDIM tiles; copies share their pixels.
#[derive(Clone, Debug)]
pub struct Mask {
    tiles: Tiles,
}

#[derive(Clone, Debug)]
enum Tiles {
    /// The mesh has no tiles.
    Square(Picture),
    /// Black where no tile is.
    Udim(BTreeMap<UvTile, Picture>),
}

/// A number that is painted as grey.
#[derive(Clone, Debug)]
pub struct PaintedNumber {
    /// Grey image; black where it is not.
    pub image: Mask,
    /// Numbers at black and at white.
    pub range: [f64; 2],
}

impl PaintedNumber {
    /// The number at a texture coordinate.
    pub(crate) fn at(&self, uv: Vector2<f64>) -> f64 {
        let [low, high] = self.range;
        low + (high - low) * self.image.grey(uv)
    }
}

/// A grey image over a unit square.
#[derive(Clone, Debug)]
struct Picture {
    width: u32,
    height: u32,
    values: Arc<[f32]>,
}

impl Mask {
    /// Grey value from which on skin is simulated: a sixteenth. Darker skin would show less than
    /// that fraction of its wrinkles, and scans and compressed pictures have such a grey for black.
    pub const DARKEST: f32 = 1.0 / 16.0;

    /// Makes a mask of `width` by `height` pixels from grey values in [0, 1], row by row, the first
    /// row at V = 0.
    ///
    /// # Errors
    /// [`StepperError::Setting`] for a mask without pixels, a number of values that is not
    /// `width * height`, or a value outside [0, 1].
    pub fn new(width: u32, height: u32, values: Vec<f32>) -> Result<Self, StepperError> {
        let picture = Picture::new(width, height, values)?;
        Ok(Self {
            tiles: Tiles::Square(picture),
        })
    }

    /// Makes a mask of UDIM tiles from the masks of each, which are over the unit square; it is black where
    /// there is none.
    ///
    /// Places are looked up in the tile that [`UvTile::at`] says.
    pub fn of_tiles(masks: impl IntoIterator<Item = (UvTile, Mask)>) -> Self {
        let pictures = masks.into_iter().filter_map(|(tile, mask)| {
            let picture = match mask.tiles {
                Tiles::Square(picture) => picture,
                Tiles::Udim(mut tiles) => tiles.remove(&tile)?,
            };
            Some((tile, picture))
        });
        Self {
            tiles: Tiles::Udim(pictures.collect()),
        }
    }

    /// Width and height of every image in pixels, with its grey values in [0, 1], row by row, the first row
    /// at the lowest V.
    pub fn images(&self) -> impl Iterator<Item = ([u32; 2], &[f32])> {
        let (one, tiles) = match &self.tiles {
            Tiles::Square(picture) => (Some(picture), None),
            Tiles::Udim(tiles) => (None, Some(tiles.values())),
        };
        let pictures = one.into_iter().chain(tiles.into_iter().flatten());
        pictures.map(|picture| ([picture.width, picture.height], &*picture.values))
    }

    /// Grey value at a texture coordinate, linear between the centres of pixels, 0 to 1; black
    /// outside the unit square, or the tiles.
    pub fn grey(&self, uv: Vector2<f64>) -> f64 {
        let found = self.picture(uv);
        found.map_or(0.0, |(picture, local)| picture.grey(local))
    }

    /// Whether the pixel under a texture coordinate is lighter than [`Self::DARKEST`].
    pub(crate) fn covers(&self, uv: Vector2<f64>) -> bool {
        let found = self.picture(uv);
        found.is_some_and(|(picture, local)| picture.covers(local))
    }

    /// Whether a pixel lighter than [`Self::DARKEST`] lies in the smallest upright rectangle around a triangle.
    pub(crate) fn touches(&self, corners: &[Vector2<f64>; 3]) -> bool {
        match &self.tiles {
            Tiles::Square(picture) => picture.touches(corners),
            Tiles::Udim(tiles) => tiles.iter().any(|(tile, picture)| {
                let local = corners.each_ref().map(|uv| tile.local(uv));
                picture.touches(&local)
            }),
        }
    }

    /// The image at a texture coordinate, and the coordinate in it.
    fn picture(&self, uv: Vector2<f64>) -> Option<(&Picture, Vector2<f64>)> {
        match &self.tiles {
            Tiles::Square(picture) => is_inside(uv).then_some((picture, uv)),
            Tiles::Udim(tiles) => {
                let tile = UvTile::at(&uv)?;
                Some((tiles.get(&tile)?, tile.local(&uv)))
            }
        }
    }
}

impl Picture {
    fn new(width: u32, height: u32, values: Vec<f32>) -> Result<Self, StepperError> {
        check_mask(width, height, &values)?;
        Ok(Self {
            width,
            height,
            values: values.into(),
        })
    }

    fn grey(&self, uv: Vector2<f64>) -> f64 {
        let uv = uv.map(|c| c.clamp(0.0, 1.0));
        let between = |c: f64, count: u32| {
            // A value stands at the centre of its pixel. Beyond the outermost centres the outermost
            // values go on.
            let place = (c * f64::from(count) - 0.5).clamp(0.0, f64::from(count - 1));
            let low = place.floor();
            let next = (low as usize + 1).min(count as usize - 1);
            ([low as usize, next], place - low)
        };
        let (columns, across) = between(uv.x, self.width);
        let (rows, down) = between(uv.y, self.height);
        let row = |y: usize| {
            let [a, b] = columns.map(|x| f64::from(self.values[y * self.width as usize + x]));
            a + (b - a) * across
        };
        let [top, bottom] = rows.map(row);
        top + (bottom - top) * down
    }

    fn covers(&self, uv: Vector2<f64>) -> bool {
        let [x, y] = self.pixel(uv);
        self.values[y * self.width as usize + x] >= Mask::DARKEST
    }

    fn touches(&self, corners: &[Vector2<f64>; 3]) -> bool {
        let [a, b, c] = corners;
        let (low, high) = (a.inf(b).inf(c), a.sup(b).sup(c));
        // This is asked first, because `pixel` moves what lies outside to the nearest pixel of the
        // border.
        let is_beside = |c: usize| high[c] < 0.0 || low[c] > 1.0;
        if is_beside(0) || is_beside(1) {
            return false;
        }
        let [[left, top], [right, bottom]] = [low, high].map(|corner| self.pixel(corner));
        (top..=bottom).any(|y| {
            let row = y * self.width as usize;
            let pixels = &self.values[row + left..=row + right];
            pixels.iter().any(|&value| value >= Mask::DARKEST)
        })
    }

    /// Column and row of the pixel under a texture coordinate, or of the next one to it.
    fn pixel(&self, uv: Vector2<f64>) -> [usize; 2] {
        // A conversion of what is negative is zero.
        let pixel = |c: f64, count: u32| ((c * f64::from(count)) as usize).min(count as usize - 1);
        [pixel(uv.x, self.width), pixel(uv.y, self.height)]
    }
}

/// Coordinates of the border come a rounding beyond the square out of files and interpolation.
const ROUNDING: f64 = 1e-6;

fn is_inside(uv: Vector2<f64>) -> bool {
    let tile = -ROUNDING..=1.0 + ROUNDING;
    tile.contains(&uv.x) && tile.contains(&uv.y)
}

/// Checks the pixels of a mask.
fn check_mask(width: u32, height: u32, values: &[f32]) -> Checked {
    let of = "mask";
    for (field, side) in [("width", width), ("height", height)] {
        if side == 0 {
            return refuse(of, field, side, "a number from 1");
        }
    }
    let pixels = u64::from(width) * u64::from(height);
    if values.len() as u64 != pixels {
        let accepted = format!("{width} x {height} = {pixels} values");
        let found = format!("a list of {}", values.len());
        return refuse(of, "values", found, accepted);
    }
    match values.iter().position(|v| !(0.0..=1.0).contains(v)) {
        None => Ok(()),
        Some(i) => refuse(of, format!("values[{i}]"), values[i], "a grey in [0, 1]"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_is_linear_between_the_centres_of_pixels() {
        let mask = Mask::new(2, 2, vec![0.0, 1.0, 0.5, 0.5]).expect("four pixels");
        let grey = |u: f64, v: f64| mask.grey(Vector2::new(u, v));
        assert_eq!(grey(0.25, 0.25), 0.0);
        assert_eq!(grey(0.5, 0.25), 0.5);
        assert_eq!(grey(0.75, 0.5), 0.75);
        assert_eq!(grey(0.0, 1.0), 0.5);
        assert_eq!(grey(1.0, 0.0), 1.0);
        assert_eq!(grey(1.1, 0.5), 0.0);
        assert_eq!(grey(f64::NAN, 0.5), 0.0);
        assert!(!mask.covers(Vector2::new(0.25, 0.25)));
        assert!(mask.covers(Vector2::new(0.25, 0.75)));
    }

    #[test]
    fn a_tile_has_its_own_image_and_is_black_without() {
        let tile = |number| UvTile::from_number(number).expect("a tile");
        let even = |grey| Mask::new(1, 1, vec![grey]).expect("one pixel");
        let mask = Mask::of_tiles([(tile(1001), even(0.25)), (tile(1012), even(1.0))]);
        let grey = |u: f64, v: f64| mask.grey(Vector2::new(u, v));
        assert_eq!([grey(0.5, 0.5), grey(1.5, -0.5)], [0.25, 1.0]);
        assert_eq!([grey(1.5, 0.5), grey(-0.5, 0.5)], [0.0, 0.0]);
        assert!(mask.covers(Vector2::new(1.5, -0.5)));
        assert!(!mask.covers(Vector2::new(1.5, 0.5)));
        let triangle = |u: f64, v: f64| {
            mask.touches(
                &[[0.0, 0.0], [0.5, 0.0], [0.0, 0.5]].map(|[x, y]| Vector2::new(u + x, v + y)),
            )
        };
        assert!(triangle(1.2, -0.8) && triangle(0.2, 0.2));
        assert!(!triangle(2.2, -0.8) && !triangle(0.2, -1.8));
        assert_eq!(mask.images().count(), 2);
    }

    #[test]
    fn a_mask_touches_triangles_with_a_white_pixel_in_their_rectangle() {
        let mut values = vec![0.0; 16];
        // Third row, second column.
        values[9] = 1.0;
        let mask = Mask::new(4, 4, values).expect("sixteen pixels");
        let triangle = |corners: [[f64; 2]; 3]| mask.touches(&corners.map(Vector2::from));
        assert!(triangle([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]));
        assert!(triangle([[-1.0, 0.6], [0.3, 0.6], [-1.0, 0.7]]));
        assert!(!triangle([[0.0, 0.0], [0.2, 0.0], [0.0, 1.0]]));
        assert!(!triangle([[0.0, 0.0], [1.0, 0.0], [0.0, 0.49]]));
        assert!(!triangle([[1.2, 0.6], [1.5, 0.6], [1.2, 0.7]]));
        assert!(!triangle([
            [f64::NAN, 0.6],
            [f64::NAN, 0.6],
            [f64::NAN, 0.7]
        ]));
    }
}
