//! A vector drawing, and its pixels.

use std::error::Error;
use std::fmt::Write;
use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{Options, Tree};

/// Family of all text; what has no such font takes its own.
const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

/// Where a text stands against its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// How a text looks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Style<'a> {
    pub(crate) size: f64,
    pub(crate) colour: &'a str,
    pub(crate) anchor: Anchor,
    pub(crate) bold: bool,
}

/// Elements in the order in which they are drawn; lengths in pixels, y down.
pub(crate) struct Drawing {
    size: [f64; 2],
    body: String,
}

impl Drawing {
    pub(crate) fn new(size: [f64; 2]) -> Self {
        let mut drawing = Self {
            size,
            body: String::new(),
        };
        drawing.element(&format!(
            r##"<rect width="{}" height="{}" fill="#ffffff"/>"##,
            size[0], size[1]
        ));
        drawing
    }

    fn element(&mut self, element: &str) {
        // Writing into a string has no way to fail.
        let _ = writeln!(self.body, "{element}");
    }

    /// A broken line; `dash` as in SVG, empty for none.
    pub(crate) fn line(&mut self, points: &[[f64; 2]], colour: &str, width: f64, dash: &str) {
        let points: Vec<String> = points
            .iter()
            .map(|[x, y]| format!("{x:.1},{y:.1}"))
            .collect();
        let dash = match dash {
            "" => String::new(),
            dash => format!(r#" stroke-dasharray="{dash}""#),
        };
        self.element(&format!(
            r#"<polyline points="{}" fill="none" stroke="{colour}" stroke-width="{width}" stroke-linejoin="round" stroke-linecap="round"{dash}/>"#,
            points.join(" ")
        ));
    }

    pub(crate) fn circle(
        &mut self,
        [x, y]: [f64; 2],
        radius: f64,
        fill: &str,
        stroke: (&str, f64),
    ) {
        self.element(&format!(
            r#"<circle cx="{x:.1}" cy="{y:.1}" r="{radius}" fill="{fill}" stroke="{}" stroke-width="{}"/>"#,
            stroke.0, stroke.1
        ));
    }

    pub(crate) fn square(&mut self, [x, y]: [f64; 2], half: f64, fill: &str, stroke: (&str, f64)) {
        self.element(&format!(
            r#"<rect x="{:.1}" y="{:.1}" width="{w}" height="{w}" fill="{fill}" stroke="{}" stroke-width="{}"/>"#,
            x - half,
            y - half,
            stroke.0,
            stroke.1,
            w = 2.0 * half,
        ));
    }

    /// A text with a white rim, which keeps it legible on lines.
    pub(crate) fn text(&mut self, [x, y]: [f64; 2], text: &str, style: Style) {
        let anchor = match style.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let weight = if style.bold { "bold" } else { "normal" };
        let text = text
            .replace('&', "&amp;")
            .replace('<', "&lt;")
            .replace('>', "&gt;");
        for rim in [
            r##" stroke="#ffffff" stroke-width="4" stroke-linejoin="round""##,
            "",
        ] {
            self.element(&format!(
                r#"<text x="{x:.1}" y="{y:.1}" font-family="{FAMILY}" font-size="{}" font-weight="{weight}" text-anchor="{anchor}" fill="{}"{rim}>{text}</text>"#,
                style.size, style.colour
            ));
        }
    }

    /// The SVG file.
    pub(crate) fn svg(&self) -> String {
        let [width, height] = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\">\n{}</svg>\n",
            self.body
        )
    }

    /// The PNG file, `scale` pixels to a unit; with fonts of our own, so that it looks the same on a
    /// machine without any.
    pub(crate) fn png(&self, scale: f32) -> Result<Vec<u8>, Box<dyn Error>> {
        let mut fonts = Database::new();
        for font in [dejavu::sans::regular(), dejavu::sans::bold()] {
            fonts.load_font_data(font.to_vec());
        }
        let options = Options {
            fontdb: Arc::new(fonts),
            ..Options::default()
        };
        let tree = Tree::from_str(&self.svg(), &options)?;
        let size = tree.size().to_int_size();
        let pixels = [size.width(), size.height()].map(|n| (n as f32 * scale).round() as u32);
        let mut pixmap = Pixmap::new(pixels[0], pixels[1]).ok_or("an empty page")?;
        resvg::render(
            &tree,
            Transform::from_scale(scale, scale),
            &mut pixmap.as_mut(),
        );
        Ok(pixmap.encode_png()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_drawn_without_fonts_of_the_system() {
        let mut drawing = Drawing::new([80.0, 20.0]);
        let blank = drawing.png(1.0).unwrap();
        let style = Style {
            size: 12.0,
            colour: "#000000",
            anchor: Anchor::Start,
            bold: false,
        };
        drawing.text([2.0, 14.0], "a < b & c", style);
        assert!(drawing.svg().contains("a &lt; b &amp; c"));
        assert!(drawing.png(1.0).unwrap().len() > blank.len() + 100);
    }
}
