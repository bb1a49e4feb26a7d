//! One error against cost.

use super::labels::Labels;
use super::plan::{DEFAULT, ELASTIC, HINGED, Method, PAPERS, QUALITIES};
use super::results::{Measure, Point};
use super::verdict::{acceptance, curve, default_at, pareto};
use crate::drawing::{Anchor, Axis, Drawing, Style};

/// Of grid, secondary and primary text.
pub(super) const GRID: &str = "#e6e6e6";
pub(super) const FAINT: &str = "#6b6b6b";
pub(super) const INK: &str = "#1a1a1a";

/// Errors smaller than this are drawn at the lower edge: medians of what changes its sign.
const LEAST_SHARE: f64 = 5e-4;

/// How a method is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    pub(super) colour: &'static str,
    pale: &'static str,
    /// A name beside its line; without one a method is a cloud of pale marks.
    pub(super) name: Option<&'static str>,
    pub(super) width: f64,
    pub(super) dash: &'static str,
}

/// Colours by Okabe and Ito, told apart by all.
pub(super) fn look(method: &Method) -> Look {
    let (colour, pale) = match method.coupling {
        "hybrid" if method.bending == HINGED.bending => ("#cc79a7", "#e9c6d9"),
        "hybrid" => ("#0072b2", "#a6cbe3"),
        "elastic" => ("#009e73", "#a3d9c8"),
        _ => ("#d55e00", "#f2c3a0"),
    };
    let (name, width, dash) = if *method == DEFAULT {
        (Some("default: hybrid"), 3.2, "")
    } else if *method == PAPERS {
        (Some("papers: hard rows, MINRES"), 3.2, "")
    } else if *method == PAPERS.factorised() {
        (Some("papers’ rows, LDLᵀ"), 1.8, "7 5")
    } else if *method == ELASTIC {
        (Some("elastic"), 1.8, "")
    } else if *method == HINGED {
        (Some("hinges"), 1.8, "")
    } else {
        (None, 0.0, "")
    };
    Look {
        colour,
        pale,
        name,
        width,
        dash,
    }
}

/// Methods with a line, the most important one last, on top.
pub(super) fn lined() -> [Method; 5] {
    [PAPERS.factorised(), ELASTIC, HINGED, PAPERS, DEFAULT]
}

/// A panel's place on the page and its axes.
pub(super) struct Panel<'a> {
    points: &'a [Point],
    measure: Measure,
    /// Left, top, right, bottom of the field.
    frame: [f64; 4],
    x: Axis,
    y: Axis,
}

/// Degrees as they are, shares in per cent.
fn scale(measure: Measure) -> f64 {
    if measure.is_angle() { 1.0 } else { 100.0 }
}

fn title(measure: Measure) -> [&'static str; 2] {
    match measure {
        Measure::Normals => ["Normals", "RMS angle to the exact ones, degrees"],
        Measure::Wavelength => ["Wavelength", "of the first mode, error in %"],
        Measure::Amplitude => ["Amplitude", "at 2 and 4 critical strains, error in %"],
        Measure::Onset => ["Onset of wrinkling", "strain of the first mode, error in %"],
        Measure::Gap => ["Energy gap", "flat to wrinkled, error in %"],
        Measure::PatchNormals => [
            "Normals of the patch",
            "RMS angle to a finer mesh’s, degrees",
        ],
        Measure::PatchWavelength => ["Wavelength of the patch", "against a finer mesh, in %"],
        Measure::PatchAmplitude => ["Amplitude of the patch", "against a finer mesh, in %"],
    }
}

impl<'a> Panel<'a> {
    /// `x` is shared by all panels.
    pub(super) fn new(points: &'a [Point], measure: Measure, frame: [f64; 4], x: Axis) -> Self {
        let scale = scale(measure);
        let spreads = points.iter().filter_map(|point| point.errors.get(&measure));
        let values = spreads.flat_map(|s| [s.median, s.high]).map(|v| scale * v);
        let least = if measure.is_angle() {
            0.0
        } else {
            100.0 * LEAST_SHARE
        };
        let y = Axis::around(values, [frame[3] - 8.0, frame[1] + 22.0], 1.25).from(least);
        Self {
            points,
            measure,
            frame,
            x: x.at([frame[0] + 12.0, frame[2] - 12.0]),
            y,
        }
    }

    fn place(&self, point: &Point, error: f64) -> [f64; 2] {
        [self.x.place(point.cost()), self.height(error)]
    }

    fn height(&self, error: f64) -> f64 {
        let scale = scale(self.measure);
        self.y.place(scale * error)
    }

    pub(super) fn draw(&self, drawing: &mut Drawing) {
        self.draw_axes(drawing);
        let mut labels = Labels::default();
        for point in self.points {
            if let Some(error) = point.error(self.measure) {
                labels.avoid(self.place(point, error), 3.0);
            }
        }
        for method in lined() {
            self.avoid_curve(&method, &mut labels);
        }
        self.draw_failures(drawing, &mut labels);
        for point in self
            .points
            .iter()
            .filter(|p| look(&p.setting.method).name.is_none())
        {
            if let Some(error) = point.error(self.measure) {
                let look = look(&point.setting.method);
                mark(
                    drawing,
                    self.place(point, error),
                    &point.setting.method,
                    look.pale,
                    3.2,
                );
            }
        }
        let line: Vec<[f64; 2]> = pareto(self.points, self.measure)
            .iter()
            .map(|(point, error)| self.place(point, *error))
            .collect();
        pareto_line(drawing, &line);
        for method in lined() {
            self.draw_curve(drawing, &method);
        }
        self.draw_promises(drawing, &mut labels);
        self.draw_names(drawing, &mut labels);
    }

    fn draw_axes(&self, drawing: &mut Drawing) {
        let [left, top, right, bottom] = self.frame;
        let style = Style {
            size: 12.5,
            colour: FAINT,
            anchor: Anchor::Middle,
            bold: false,
        };
        for (value, _) in self.x.ticks() {
            let x = self.x.place(value);
            drawing.line(&[[x, top], [x, bottom]], GRID, 1.0, "");
        }
        for (value, _) in self.y.ticks() {
            let y = self.y.place(value);
            drawing.line(&[[left, y], [right, y]], GRID, 1.0, "");
        }
        drawing.line(
            &[[left, top], [left, bottom], [right, bottom]],
            "#9a9a9a",
            1.2,
            "",
        );
        for value in self.x.labelled() {
            drawing.text([self.x.place(value), bottom + 17.0], &short(value), style);
        }
        for value in self.y.labelled() {
            let style = Style {
                anchor: Anchor::End,
                ..style
            };
            drawing.text(
                [left - 6.0, self.y.place(value) + 4.5],
                &short(value),
                style,
            );
        }
        let [name, unit] = title(self.measure);
        let style = Style {
            size: 17.0,
            colour: INK,
            anchor: Anchor::Start,
            bold: true,
        };
        drawing.text([left, top - 24.0], name, style);
        let style = Style {
            size: 13.0,
            colour: FAINT,
            bold: false,
            ..style
        };
        drawing.text([left, top - 7.0], unit, style);
        let style = Style {
            anchor: Anchor::End,
            ..style
        };
        drawing.text([right, bottom + 34.0], "processor seconds per frame", style);
    }

    /// Settings of which no run succeeded: crosses at the top, at their cost. That of crashes is
    /// not known; they are in the list of what failed.
    fn draw_failures(&self, drawing: &mut Drawing, labels: &mut Labels) {
        let y = self.frame[1] + 9.0;
        let of_problem = |p: &&Point| p.setting.problem == self.measure.problem();
        let failed = self.points.iter().filter(|p| p.failed == p.runs);
        let known = failed.filter(|p| p.seconds.is_some());
        for point in known.filter(of_problem) {
            let x = self.x.place(point.cost());
            let colour = look(&point.setting.method).colour;
            cross(drawing, [x, y], colour);
            labels.avoid([x, y], 6.0);
        }
    }

    /// Keeps labels off a line, every few pixels of it.
    fn avoid_curve(&self, method: &Method, labels: &mut Labels) {
        let curve = curve(self.points, *method, self.measure);
        let places: Vec<_> = curve
            .iter()
            .map(|(p, error)| self.place(p, *error))
            .collect();
        for ends in places.windows(2) {
            for step in 0..=20 {
                let share = f64::from(step) / 20.0;
                let at = [0, 1].map(|i| ends[0][i] + share * (ends[1][i] - ends[0][i]));
                labels.avoid(at, 2.0);
            }
        }
    }

    fn draw_curve(&self, drawing: &mut Drawing, method: &Method) {
        let look = look(method);
        let curve = curve(self.points, *method, self.measure);
        for (point, _) in &curve {
            let error = point.errors.get(&self.measure);
            let (Some(spread), Some(seconds)) = (error, &point.seconds) else {
                continue;
            };
            let [x, y] = self.place(point, spread.median);
            let ends = [spread.low, spread.high].map(|error| self.height(error));
            drawing.line(&ends.map(|end| [x, end]), look.colour, 1.2, "");
            for end in ends {
                drawing.line(&[[x - 3.0, end], [x + 3.0, end]], look.colour, 1.2, "");
            }
            let ends = [seconds.low, seconds.high].map(|s| [self.x.place(s), y]);
            drawing.line(&ends, look.colour, 1.2, "");
        }
        let line: Vec<_> = curve
            .iter()
            .map(|(p, error)| self.place(p, *error))
            .collect();
        drawing.line(&line, look.colour, look.width, look.dash);
        for (point, error) in &curve {
            let radius = if is_quality(point) { 7.0 } else { 4.2 };
            mark(
                drawing,
                self.place(point, *error),
                &point.setting.method,
                look.colour,
                radius,
            );
        }
    }

    /// What the default promises at its qualities: bars that its marks have to be below.
    fn draw_promises(&self, drawing: &mut Drawing, labels: &mut Labels) {
        let own = acceptance(self.points);
        for promise in own.iter().filter(|promise| promise.measure == self.measure) {
            let is_it = |p: &&Point| p.setting == default_at(promise.points, self.measure);
            if let Some(point) = self.points.iter().find(is_it) {
                let place = self.place(point, promise.accepted);
                promise_bar(drawing, place);
                labels.avoid(place, 10.0);
            }
        }
    }

    fn draw_names(&self, drawing: &mut Drawing, labels: &mut Labels) {
        let style = Style {
            size: 13.0,
            colour: INK,
            anchor: Anchor::Start,
            bold: true,
        };
        let default = curve(self.points, DEFAULT, self.measure);
        for (name, quality) in QUALITIES {
            let is_it = |own: &&(&Point, f64)| own.0.setting.points == quality;
            if let Some((point, error)) = default.iter().find(is_it) {
                let at = [self.place(point, *error)];
                labels.write(
                    drawing,
                    &at,
                    &format!("{name} {quality}"),
                    style,
                    self.frame,
                );
            }
        }
        for method in lined().iter().rev() {
            let look = look(method);
            let curve = curve(self.points, *method, self.measure);
            let places = curve.iter().rev().map(|(p, error)| self.place(p, *error));
            let places: Vec<_> = places.collect();
            if let Some(name) = look.name {
                let style = Style {
                    colour: look.colour,
                    ..style
                };
                labels.write(drawing, &places, name, style, self.frame);
            }
        }
    }
}

fn is_quality(point: &Point) -> bool {
    let is_named = QUALITIES
        .iter()
        .any(|quality| quality.1 == point.setting.points);
    point.setting.method == DEFAULT && is_named
}

/// Where every run failed.
pub(super) fn cross(drawing: &mut Drawing, [x, y]: [f64; 2], colour: &str) {
    for [from, to] in [[-4.0, 4.0], [4.0, -4.0]] {
        let stroke = [[x - 4.0, y + from], [x + 4.0, y + to]];
        drawing.line(&stroke, colour, 1.8, "");
    }
}

/// A yellow band with a rim, so that it is seen under lines and without colours.
pub(super) fn pareto_line(drawing: &mut Drawing, line: &[[f64; 2]]) {
    drawing.line(line, "#000000", 8.0, "");
    drawing.line(line, "#ffe680", 6.0, "");
}

/// A bar with teeth towards what is allowed.
pub(super) fn promise_bar(drawing: &mut Drawing, [x, y]: [f64; 2]) {
    drawing.line(&[[x - 12.0, y], [x + 12.0, y]], "#0072b2", 2.6, "");
    for tooth in [-8.0, 0.0, 8.0] {
        drawing.line(&[[x + tooth, y], [x + tooth, y + 6.0]], "#0072b2", 1.4, "");
    }
}

/// The mark of a method: round if factorised, square if iterated; hollow on a uniform mesh.
pub(super) fn mark(
    drawing: &mut Drawing,
    at: [f64; 2],
    method: &Method,
    colour: &str,
    radius: f64,
) {
    let (fill, stroke) = match method.mesh {
        "adaptive" | "adaptive-two" => (colour, ("#ffffff", 1.2)),
        _ => ("#ffffff", (colour, 1.8)),
    };
    match method.solver {
        "ldlt" => drawing.circle(at, radius, fill, stroke),
        _ => drawing.square(at, 0.9 * radius, fill, stroke),
    }
}

/// A number without superfluous digits.
fn short(value: f64) -> String {
    let digits = (-value.log10().floor()).max(0.0) as usize;
    format!("{value:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [0.005, 0.1, 1.0, 20.0].map(short),
            ["0.005", "0.1", "1", "20"]
        );
    }
}
