//! A picture in memory: triangles, strokes and words on white.

use image::imageops::thumbnail;
use image::{Rgb, RgbImage};
use nalgebra::Vector2;
use plotters::drawing::IntoDrawingArea;
use plotters::element::Text;
use plotters::prelude::BitMapBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color as _, FontStyle, IntoFont, RGBColor, TextStyle, register_font};

/// Red, green and blue.
pub(crate) type Colour = [u8; 3];

/// A colour that words are legible in.
pub(crate) const INK: Colour = [40, 40, 40];

/// Pixels to a unit before the picture is made smaller again, which smooths edges.
const FINER: u32 = 2;

/// A picture with lengths in its final pixels, y down.
pub(crate) struct Canvas {
    pixels: RgbImage,
}

impl Canvas {
    /// A white picture.
    pub(crate) fn new(width: u32, height: u32) -> Self {
        let white = Rgb([u8::MAX; 3]);
        Self {
            pixels: RgbImage::from_pixel(FINER * width, FINER * height, white),
        }
    }

    /// Fills a triangle; what of it lies outside the picture is left out.
    pub(crate) fn triangle(&mut self, corners: [Vector2<f64>; 3], colour: Colour) {
        let [a, b, c] = corners.map(|corner| corner * f64::from(FINER));
        let area = (b - a).perp(&(c - a));
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
        let within = |value: f64, side: u32| value.clamp(0.0, f64::from(side)) as u32;
        let (width, height) = self.pixels.dimensions();
        for y in within(low.y.floor(), height)..within(high.y.ceil(), height) {
            for x in within(low.x.floor(), width)..within(high.x.ceil(), width) {
                let p = Vector2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let sides = [(a, b), (b, c), (c, a)];
                // Borders count as inside, or neighbours would leave a line of pixels white.
                let is_in = sides
                    .iter()
                    .all(|(from, to)| (to - from).perp(&(p - from)) * area >= 0.0);
                if is_in {
                    self.pixels.put_pixel(x, y, Rgb(colour));
                }
            }
        }
    }

    /// Fills an upright rectangle between two corners.
    pub(crate) fn rectangle(&mut self, [a, c]: [Vector2<f64>; 2], colour: Colour) {
        let (b, d) = (Vector2::new(c.x, a.y), Vector2::new(a.x, c.y));
        self.triangle([a, b, c], colour);
        self.triangle([a, c, d], colour);
    }

    /// Draws a straight line of that width.
    pub(crate) fn stroke(&mut self, [a, b]: [Vector2<f64>; 2], width: f64, colour: Colour) {
        let Some(along) = (b - a).try_normalize(0.0) else {
            return;
        };
        let side = 0.5 * width * Vector2::new(-along.y, along.x);
        self.triangle([a - side, b - side, b + side], colour);
        self.triangle([a - side, b + side, a + side], colour);
    }

    /// Writes words, each beginning at its place, which is half way up.
    pub(crate) fn words(&mut self, words: &[Words]) {
        // The font comes with the program, so that pictures are the same on every machine.
        let known = register_font("sans-serif", FontStyle::Normal, dejavu::sans::regular());
        known.unwrap_or_else(|_| unreachable!("the font that comes with the program can be read"));
        let (width, height) = self.pixels.dimensions();
        let area =
            BitMapBackend::with_buffer(&mut self.pixels, (width, height)).into_drawing_area();
        for one in words {
            let font = ("sans-serif", f64::from(FINER) * one.height).into_font();
            let [r, g, b] = INK;
            let ink = RGBColor(r, g, b).to_rgba();
            let style = TextStyle::from(font)
                .pos(Pos::new(HPos::Left, VPos::Center))
                .color(&ink);
            let place = [one.at.x, one.at.y].map(|value| (f64::from(FINER) * value) as i32);
            let text = Text::new(one.text.as_str(), (place[0], place[1]), style);
            area.draw(&text)
                .unwrap_or_else(|_| unreachable!("a picture in memory can be drawn on"));
        }
    }

    /// Width and height in pixels, and three bytes for each pixel, row by row.
    pub(crate) fn finished(self) -> ([u32; 2], Vec<u8>) {
        let (width, height) = self.pixels.dimensions();
        let [width, height] = [width, height].map(|side| side / FINER);
        let bytes = thumbnail(&self.pixels, width, height).into_raw();
        ([width, height], bytes)
    }
}

/// Some words and their place.
pub(crate) struct Words {
    pub(crate) text: String,
    pub(crate) at: Vector2<f64>,
    /// Height of the letters.
    pub(crate) height: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_covers_its_half_of_a_square_and_nothing_beyond_the_picture() {
        let mut canvas = Canvas::new(20, 10);
        let corner = Vector2::new;
        canvas.triangle(
            [corner(0.0, 0.0), corner(40.0, 0.0), corner(0.0, 40.0)],
            [0; 3],
        );
        let (size, bytes) = canvas.finished();
        assert_eq!((size, bytes.len()), ([20, 10], 600));
        assert!(bytes.iter().all(|&value| value == 0));
        let mut canvas = Canvas::new(10, 10);
        canvas.triangle(
            [corner(0.0, 0.0), corner(10.0, 0.0), corner(0.0, 10.0)],
            [0; 3],
        );
        let (_, bytes) = canvas.finished();
        let dark = bytes.chunks(3).filter(|pixel| pixel[0] < 128).count();
        assert!((45..=55).contains(&dark), "{dark} of 100");
    }
}
