//! Pages of plots: panels with axes, and marks, lines and texts on them, as a PNG file.
//!
//! `plotters` draws axes and rasterises; fonts come from the crate `dejavu`, so that a page is the
//! same on every machine. Lengths are in units of a page, y down. Everything is drawn three times as
//! large and reduced again, which smooths what `plotters` draws with steps.

use std::error::Error;
use std::ops::Range;
use std::path::Path;

use plotters::chart::ChartBuilder;
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::drawing::{DrawingArea, IntoDrawingArea};
use plotters::element::{Circle, PathElement, Polygon, Text};
use plotters::prelude::{BitMapBackend, Color, DashedLineSeries, ShapeStyle, WHITE};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontStyle, IntoFont, TextStyle, register_font};
use ruga_io::{PngTexels, write_png};

/// What drawing gives: nothing, or why it could not be done.
pub type Drawn = Result<(), Box<dyn Error>>;

pub use plotters::style::RGBColor as Colour;

/// Colours by Okabe and Ito, told apart by all.
pub mod colours {
    use super::Colour;

    /// Blue.
    pub const BLUE: Colour = Colour(0x00, 0x72, 0xb2);
    /// Light blue.
    pub const SKY: Colour = Colour(0x56, 0xb4, 0xe9);
    /// Orange.
    pub const ORANGE: Colour = Colour(0xe6, 0x9f, 0x00);
    /// Vermilion.
    pub const RED: Colour = Colour(0xd5, 0x5e, 0x00);
    /// Green.
    pub const GREEN: Colour = Colour(0x00, 0x9e, 0x73);
    /// Purple.
    pub const PURPLE: Colour = Colour(0xcc, 0x79, 0xa7);
    /// Text that matters.
    pub const INK: Colour = Colour(0x1a, 0x1a, 0x1a);
    /// Text that explains.
    pub const FAINT: Colour = Colour(0x6b, 0x6b, 0x6b);
    /// Lines at the ticks of an axis.
    pub const GRID: Colour = Colour(0xe6, 0xe6, 0xe6);
    /// The sheet.
    pub const PAPER: Colour = Colour(0xff, 0xff, 0xff);
}

use colours::{FAINT, GRID, INK, PAPER};

/// Pixels per unit, before they are reduced.
const SCALE: f64 = 3.0;

/// The nearest pixel.
fn pixels(units: f64) -> i32 {
    (SCALE * units).round() as i32
}

/// How a text looks and which of its ends is at its place.
#[derive(Clone, Copy, Debug)]
pub struct Lettering {
    /// Height of the font.
    pub size: f64,
    /// Colour of the letters.
    pub colour: Colour,
    /// Whether letters are heavy.
    pub bold: bool,
    /// 0 if the text begins at its place, 0.5 if its middle is there, 1 if it ends there.
    pub anchor: f64,
}

/// Small text that explains.
pub const NOTE: Lettering = Lettering {
    size: 13.0,
    colour: FAINT,
    bold: false,
    anchor: 0.0,
};

/// Ordinary text.
pub const PLAIN: Lettering = Lettering {
    size: 14.0,
    colour: INK,
    ..NOTE
};

/// The name of a panel.
pub const HEADING: Lettering = Lettering {
    size: 17.0,
    bold: true,
    ..PLAIN
};

/// How a line looks.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    /// Colour of the line.
    pub colour: Colour,
    /// Width of the line.
    pub width: f64,
    /// Whether it is broken.
    pub dashed: bool,
}

/// A line without gaps.
pub const fn stroke(colour: Colour, width: f64) -> Stroke {
    Stroke {
        colour,
        width,
        dashed: false,
    }
}

/// Shapes of marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A disc.
    Round,
    /// A square.
    Square,
    /// Two strokes through each other.
    Cross,
}

/// A sheet that is drawn on.
pub struct Page<'a> {
    area: DrawingArea<BitMapBackend<'a>, Shift>,
}

/// Draws a white page of so many units and writes it, a pixel to a unit times 3 over `reduction`.
///
/// # Errors
/// What `draw` says, and files that cannot be written.
pub fn write_page(
    path: &Path,
    size: [f64; 2],
    reduction: usize,
    draw: impl FnOnce(&Page<'_>) -> Drawn,
) -> Drawn {
    for (style, font) in [
        (FontStyle::Normal, dejavu::sans::regular()),
        (FontStyle::Bold, dejavu::sans::bold()),
    ] {
        register_font("sans-serif", style, font).map_err(|_| "not a font")?;
    }
    let [width, height] = size.map(|side| pixels(side) as usize);
    let mut buffer = vec![u8::MAX; 3 * width * height];
    {
        let backend = BitMapBackend::with_buffer(&mut buffer, (width as u32, height as u32));
        let area = backend.into_drawing_area();
        area.fill(&WHITE)?;
        let page = Page { area };
        draw(&page)?;
        page.area.present()?;
    }
    let texels = reduced(&buffer, width, height, reduction);
    let [width, height] = [width, height].map(|side| side / reduction);
    Ok(write_png(path, width, height, PngTexels::Rgb8(&texels))?)
}

/// Means of squares of pixels.
fn reduced(buffer: &[u8], width: usize, height: usize, side: usize) -> Vec<u8> {
    let mean = |row: usize, column: usize, channel: usize| {
        let pixels = (0..side * side).map(|i| (row * side + i / side, column * side + i % side));
        let values = pixels.map(|(y, x)| u32::from(buffer[3 * (y * width + x) + channel]));
        (values.sum::<u32>() / (side * side) as u32) as u8
    };
    let rows = 0..height / side;
    rows.flat_map(|row| (0..width / side).map(move |column| (row, column)))
        .flat_map(|(row, column)| [0, 1, 2].map(|channel| mean(row, column, channel)))
        .collect()
}

impl Page<'_> {
    /// A text in one line, whose middle height is at its place, with a white rim that keeps it legible
    /// on lines.
    ///
    /// # Errors
    /// What the drawing library says.
    pub fn text(&self, at: [f64; 2], words: &str, style: Lettering) -> Drawn {
        let weight = match style.bold {
            true => FontStyle::Bold,
            false => FontStyle::Normal,
        };
        let font = ("sans-serif", SCALE * style.size * FONT, weight).into_font();
        let horizontal = match style.anchor {
            0.0 => HPos::Left,
            1.0 => HPos::Right,
            _ => HPos::Center,
        };
        let text = TextStyle::from(font).pos(Pos::new(horizontal, VPos::Center));
        let [x, y] = at.map(pixels);
        for i in 0..16 {
            let (sine, cosine) = (0.125 * f64::from(i) * std::f64::consts::PI).sin_cos();
            let rim = (x + pixels(2.0 * cosine), y + pixels(2.0 * sine));
            self.area.draw(&Text::new(words, rim, text.color(&PAPER)))?;
        }
        Ok(self
            .area
            .draw(&Text::new(words, (x, y), text.color(&style.colour)))?)
    }

    /// A line through places.
    ///
    /// # Errors
    /// What the drawing library says.
    pub fn line(&self, places: &[[f64; 2]], style: Stroke) -> Drawn {
        let path: Vec<_> = places.iter().map(|at| at.map(pixels).into()).collect();
        let shape = style.colour.stroke_width(pixels(style.width) as u32);
        if !style.dashed {
            return Ok(self.area.draw(&PathElement::new(path, shape))?);
        }
        let dashes = DashedLineSeries::new(path, pixels(7.0), pixels(5.0), shape);
        for dash in dashes {
            self.area.draw(&dash)?;
        }
        Ok(())
    }

    /// A mark of a radius, filled and with a rim.
    ///
    /// # Errors
    /// What the drawing library says.
    pub fn mark(&self, at: [f64; 2], shape: Shape, radius: f64, [fill, rim]: [Colour; 2]) -> Drawn {
        let [x, y] = at;
        let sides = |r: f64| {
            [
                [x - r, y - r],
                [x + r, y - r],
                [x + r, y + r],
                [x - r, y + r],
            ]
        };
        match shape {
            Shape::Round => {
                let middle: (i32, i32) = at.map(pixels).into();
                let disc = |r: f64, colour: Colour| Circle::new(middle, pixels(r), colour.filled());
                self.area.draw(&disc(radius, rim))?;
                self.area.draw(&disc(radius - RIM, fill))?;
            }
            Shape::Square => {
                for (r, colour) in [(radius, rim), (radius - RIM, fill)] {
                    let corners: Vec<_> = sides(r).map(|p| p.map(pixels).into()).into();
                    self.area.draw(&Polygon::new(corners, colour.filled()))?;
                }
            }
            Shape::Cross => {
                let [a, b, c, d] = sides(radius);
                self.line(&[a, c], stroke(fill, 1.8))?;
                self.line(&[b, d], stroke(fill, 1.8))?;
            }
        }
        Ok(())
    }
}

/// Width of a mark's rim.
const RIM: f64 = 1.6;

/// Heights in `plotters` are from the top of the highest letter to the bottom of the lowest.
const FONT: f64 = 1.17;

/// What a side of a panel means.
#[derive(Clone, Debug)]
pub struct Axis {
    range: [f64; 2],
    ticks: Vec<f64>,
    is_logarithmic: bool,
}

/// Numbers that fit beside an axis.
const MOST_TICKS: usize = 12;

impl Axis {
    /// Equal differences are equally long.
    pub fn linear(range: [f64; 2], ticks: Vec<f64>) -> Self {
        Self {
            range,
            ticks,
            is_logarithmic: false,
        }
    }

    /// Equal ratios are equally long: around some values, a little wider than they are.
    ///
    /// Ticks are at 1, 2 and 5 times powers of ten, or only at these where that is too many.
    pub fn logarithmic(values: impl Iterator<Item = f64>, room: f64) -> Self {
        let values = values.filter(|value| *value > 0.0 && value.is_finite());
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), v| {
            (low.min(v), high.max(v))
        });
        let (low, high) = if low <= high { (low, high) } else { (0.1, 1.0) };
        let range = [low / room, high * room];
        let decades = range[0].log10().floor() as i32..=range[1].log10().ceil() as i32;
        let ticks = |factors: &[f64]| -> Vec<f64> {
            let ticks = decades
                .clone()
                .flat_map(|d| factors.iter().map(move |f| f * 10_f64.powi(d)));
            ticks
                .filter(|v| (range[0]..=range[1]).contains(v))
                .collect()
        };
        let all = ticks(&[1.0, 2.0, 5.0]);
        Self {
            ticks: if all.len() > MOST_TICKS {
                ticks(&[1.0])
            } else {
                all
            },
            range,
            is_logarithmic: true,
        }
    }

    /// The same with other ticks.
    pub fn with_ticks(self, ticks: Vec<f64>) -> Self {
        Self { ticks, ..self }
    }

    /// The same from this value on, if it begins lower.
    pub fn from(mut self, least: f64) -> Self {
        self.range[0] = self.range[0].max(least);
        let [low, _] = self.range;
        self.ticks.retain(|tick| *tick >= low);
        self
    }

    /// How far along the side a value is, those outside at the nearest end.
    fn share(&self, value: f64) -> f64 {
        let scaled = |value: f64| match self.is_logarithmic {
            true => value.ln(),
            false => value,
        };
        let [low, high] = self.range.map(scaled);
        ((scaled(value) - low) / (high - low)).clamp(0.0, 1.0)
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        from + (self.share(*value) * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        match hint.weight().allow_light_points() {
            true => Vec::new(),
            false => self.ticks.clone(),
        }
    }

    fn range(&self) -> Range<f64> {
        self.range[0]..self.range[1]
    }
}

impl ValueFormatter<f64> for Axis {
    /// Without superfluous digits.
    fn format(value: &f64) -> String {
        let text = format!("{value:.3}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    }
}

/// A panel's words.
#[derive(Clone, Copy, Debug)]
pub struct Title<'a> {
    /// What it is about.
    pub name: &'a str,
    /// What is drawn upwards, and anything else to know.
    pub note: &'a str,
    /// What is drawn to the right.
    pub across: &'a str,
}

/// A field with two axes, on which values have places.
pub struct Panel<'a> {
    field: DrawingArea<BitMapBackend<'a>, Cartesian2d<Axis, Axis>>,
}

impl<'a> Panel<'a> {
    /// Draws title and axes of a field: left, top, right, bottom.
    ///
    /// # Errors
    /// What the drawing library says.
    pub fn draw(
        page: &Page<'a>,
        frame: [f64; 4],
        title: Title<'_>,
        [x, y]: [Axis; 2],
    ) -> Result<Self, Box<dyn Error>> {
        let [left, top, right, bottom] = frame;
        page.text([left, top - 29.0], title.name, HEADING)?;
        page.text([left, top - 12.0], title.note, NOTE)?;
        let (beside, below) = (60.0, 44.0);
        let corner = (pixels(left - beside), pixels(top));
        let size = (pixels(right - left + beside), pixels(bottom - top + below));
        let area = page.area.clone().shrink(corner, size);
        let mut chart = ChartBuilder::on(&area)
            .x_label_area_size(pixels(below))
            .y_label_area_size(pixels(beside))
            .build_cartesian_2d(x, y)?;
        let label = |size: f64| {
            ("sans-serif", SCALE * size * FONT)
                .into_font()
                .color(&FAINT)
        };
        let line = |colour: Colour, width: f64| -> ShapeStyle {
            colour.stroke_width(pixels(width) as u32)
        };
        chart
            .configure_mesh()
            .bold_line_style(line(GRID, 1.0))
            .axis_style(line(Colour(0x9a, 0x9a, 0x9a), 1.2))
            .label_style(label(12.5))
            .axis_desc_style(label(13.0))
            .x_desc(title.across)
            .draw()?;
        let field = chart.plotting_area().clone();
        Ok(Self { field })
    }

    /// Where a value is on the page; one outside of the field at the nearest border.
    pub fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (x, y) = self.field.map_coordinate(&(x, y));
        [x, y].map(|pixel| f64::from(pixel) / SCALE)
    }

    /// Where values are on the page.
    pub fn places(&self, values: &[[f64; 2]]) -> Vec<[f64; 2]> {
        values.iter().map(|value| self.place(*value)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_places_and_axes_their_numbers() {
        let axis = Axis::logarithmic([0.1, 10.0].into_iter(), 1.0);
        let labels: Vec<String> = axis.ticks.iter().map(Axis::format).collect();
        assert_eq!(labels, ["0.1", "0.2", "0.5", "1", "2", "5", "10"]);
        let wide = Axis::logarithmic([1e-3, 1e3].into_iter(), 1.0);
        assert_eq!(wide.ticks.len(), 7);
        let empty = Axis::logarithmic(std::iter::empty(), 1.0);
        assert!(empty.share(0.5).is_finite());

        let folder = std::env::temp_dir().join(format!("ruga-page-{}", std::process::id()));
        let title = Title {
            name: "name",
            note: "note",
            across: "across",
        };
        let other = Axis::linear([0.0, 4.0], vec![0.0, 2.0, 4.0]);
        write_page(&folder, [300.0, 200.0], 3, |page| {
            let panel = Panel::draw(page, [80.0, 40.0, 280.0, 140.0], title, [axis, other])?;
            for (value, place) in [
                ([0.1, 0.0], [80.0, 140.0]),
                ([1.0, 2.0], [180.0, 90.0]),
                ([100.0, 9.0], [280.0, 40.0]),
            ] {
                let found = panel.place(value);
                assert!(
                    (0..2).all(|i| (found[i] - place[i]).abs() < 1.0),
                    "{found:?}"
                );
            }
            page.text([100.0, 100.0], "a < b & c", PLAIN)
        })
        .expect("a page");
        let image = ruga_io::read_image(&folder).expect("a picture");
        std::fs::remove_file(&folder).expect("the picture");
        assert_eq!([image.width, image.height], [300, 200]);
        assert!(image.values.iter().any(|value| *value < 0.2));
    }
}
