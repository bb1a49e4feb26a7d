//! One error against cost.

use ruga_validation::plot::colours::{BLUE, GREEN, INK, PAPER, PURPLE, RED};
use ruga_validation::plot::{
    Axis, Colour, Drawn, Lettering, PLAIN, Page, Panel, Shape, Stroke, Title, stroke,
};

use crate::plan::{DEFAULT, ELASTIC, HINGED, PAPERS, QUALITIES};
use crate::results::{Measure, Point};
use crate::setting::{Bending, Coupling, Mesh, Method, Solver};
use crate::verdict::{acceptance, curve, default_at, pareto};

/// Errors smaller than this are drawn at the lower edge: medians of what changes its sign.
const LEAST_SHARE: f64 = 5e-4;

/// Methods with a line, the most important one last, on top.
const LINED: [Method; 5] = [
    Method {
        solver: Solver::Ldlt,
        ..PAPERS
    },
    ELASTIC,
    HINGED,
    PAPERS,
    DEFAULT,
];

/// What a method's lines and marks are drawn in.
pub(crate) fn colour(method: &Method) -> Colour {
    match method.coupling {
        Coupling::Hybrid if method.bending == Bending::Hinge => PURPLE,
        Coupling::Hybrid => BLUE,
        Coupling::Elastic => GREEN,
        Coupling::Constraint => RED,
    }
}

/// The line of a method: strong where it is the default or the papers', broken where the papers' rows
/// are factorised.
pub(crate) fn method_stroke(method: &Method) -> Stroke {
    let is_strong = [DEFAULT, PAPERS].contains(method);
    Stroke {
        dashed: *method == PAPERS.factorised(),
        ..stroke(colour(method), if is_strong { 3.2 } else { 1.8 })
    }
}

/// Degrees as they are, shares in per cent.
fn scale(measure: Measure) -> f64 {
    if measure.is_angle() { 1.0 } else { 100.0 }
}

fn title(measure: Measure) -> Title<'static> {
    let [name, note] = match measure {
        Measure::Normals => ["Normals", "RMS angle to the exact ones, degrees"],
        Measure::Wavelength => ["Wavelength", "at 2 critical strains, error in %"],
        Measure::Amplitude => ["Amplitude", "at 2 and 4 critical strains, error in %"],
        Measure::Onset => [
            "Onset of wrinkling",
            "strain at which it begins, error in %",
        ],
        Measure::PatchNormals => [
            "Normals of the patch",
            "RMS angle to a finer mesh’s, degrees",
        ],
        Measure::PatchWavelength => ["Wavelength of the patch", "against a finer mesh, in %"],
        Measure::PatchAmplitude => ["Amplitude of the patch", "against a finer mesh, in %"],
    };
    Title {
        name,
        note,
        across: "processor seconds per key",
    }
}

/// The points of a measure, and where they are on the page.
struct Errors<'r, 'p> {
    page: &'r Page<'p>,
    panel: Panel<'p>,
    points: &'r [Point],
    measure: Measure,
}

/// Draws a measure's panel; `costs` is shared by panels beside each other.
pub(crate) fn draw(
    page: &Page<'_>,
    frame: [f64; 4],
    costs: Axis,
    points: &[Point],
    measure: Measure,
) -> Drawn {
    let scale = scale(measure);
    let spreads = points.iter().filter_map(|point| point.errors.get(&measure));
    let values = spreads.flat_map(|s| [s.median, s.high]).map(|v| scale * v);
    let least = match measure.is_angle() {
        true => 0.0,
        false => 100.0 * LEAST_SHARE,
    };
    let errors = Axis::logarithmic(values, 1.6).from(least);
    let errors = Errors {
        page,
        panel: Panel::draw(page, frame, title(measure), [costs, errors])?,
        points,
        measure,
    };
    errors.draw_others()?;
    errors.draw_failures(frame[1])?;
    errors.draw_pareto()?;
    for method in &LINED {
        errors.draw_curve(method)?;
    }
    errors.draw_promises()?;
    errors.draw_qualities()
}

impl Errors<'_, '_> {
    fn place(&self, point: &Point, error: f64) -> [f64; 2] {
        self.panel
            .place([point.cost(), scale(self.measure) * error])
    }

    /// Pale marks of methods without a line.
    fn draw_others(&self) -> Drawn {
        for point in self.points {
            let method = &point.setting.method;
            if let Some(error) = point.error(self.measure)
                && !LINED.contains(method)
            {
                let pale = |channel: u8| 255 - (255 - channel) / 3;
                let Colour(r, g, b) = colour(method);
                let pale = Colour(pale(r), pale(g), pale(b));
                mark(self.page, self.place(point, error), method, pale, 3.4)?;
            }
        }
        Ok(())
    }

    /// Settings of which no run succeeded: crosses at the top, at their cost. That of panics is not
    /// known; they are in the list of what failed.
    fn draw_failures(&self, top: f64) -> Drawn {
        let failed = self.points.iter().filter(|p| p.failed == p.runs);
        let own = failed.filter(|p| p.setting.problem == self.measure.problem());
        for point in own.filter(|p| p.seconds.is_some()) {
            let [x, _] = self.place(point, 1.0);
            let colours = [colour(&point.setting.method); 2];
            self.page.mark([x, top + 9.0], Shape::Cross, 4.0, colours)?;
        }
        Ok(())
    }

    fn draw_pareto(&self) -> Drawn {
        let best = pareto(self.points, self.measure);
        let places = best.iter().map(|(point, error)| self.place(point, *error));
        pareto_line(self.page, &places.collect::<Vec<_>>())
    }

    fn draw_curve(&self, method: &Method) -> Drawn {
        let curve = curve(self.points, *method, self.measure);
        let thin = stroke(colour(method), 1.2);
        for (point, error) in &curve {
            let spreads = (point.errors.get(&self.measure), &point.seconds);
            let (Some(errors), Some(seconds)) = spreads else {
                continue;
            };
            let [x, y] = self.place(point, *error);
            let ends = [errors.low, errors.high].map(|error| self.place(point, error));
            self.page.line(&ends, thin)?;
            for [_, end] in ends {
                self.page.line(&[[x - 3.0, end], [x + 3.0, end]], thin)?;
            }
            let ends = [seconds.low, seconds.high].map(|s| [self.panel.place([s, 1.0])[0], y]);
            self.page.line(&ends, thin)?;
        }
        let places: Vec<_> = curve
            .iter()
            .map(|(p, error)| self.place(p, *error))
            .collect();
        self.page.line(&places, method_stroke(method))?;
        for ((point, _), at) in curve.iter().zip(places) {
            let radius = if is_quality(point) { 7.0 } else { 4.4 };
            mark(self.page, at, method, colour(method), radius)?;
        }
        Ok(())
    }

    /// What the default promises at its qualities: bars that its marks have to be below.
    fn draw_promises(&self) -> Drawn {
        let own = acceptance(self.points);
        for promise in own.iter().filter(|promise| promise.measure == self.measure) {
            let is_it = |p: &&Point| p.setting == default_at(promise.points, self.measure);
            if let Some(point) = self.points.iter().find(is_it) {
                promise_bar(self.page, self.place(point, promise.accepted))?;
            }
        }
        Ok(())
    }

    /// The names of the default's qualities, to the lower left of its line.
    fn draw_qualities(&self) -> Drawn {
        let default = curve(self.points, DEFAULT, self.measure);
        for (name, quality) in QUALITIES {
            let is_it = |own: &&(&Point, f64)| own.0.setting.points == quality;
            if let Some((point, error)) = default.iter().find(is_it) {
                let [x, y] = self.place(point, *error);
                let style = Lettering {
                    size: 13.0,
                    bold: true,
                    anchor: 0.5,
                    ..PLAIN
                };
                self.page
                    .text([x, y + 18.0], &format!("{name} {quality}"), style)?;
            }
        }
        Ok(())
    }
}

fn is_quality(point: &Point) -> bool {
    let is_named = QUALITIES.iter().any(|own| own.1 == point.setting.points);
    point.setting.method == DEFAULT && is_named
}

/// A yellow band with a rim, so that it is seen under lines and without colours.
pub(crate) fn pareto_line(page: &Page<'_>, places: &[[f64; 2]]) -> Drawn {
    page.line(places, stroke(INK, 8.0))?;
    page.line(places, stroke(Colour(0xff, 0xe6, 0x80), 6.0))
}

/// A bar with teeth towards what is allowed.
pub(crate) fn promise_bar(page: &Page<'_>, [x, y]: [f64; 2]) -> Drawn {
    page.line(&[[x - 12.0, y], [x + 12.0, y]], stroke(BLUE, 2.6))?;
    for tooth in [-8.0, 0.0, 8.0] {
        page.line(&[[x + tooth, y], [x + tooth, y + 6.0]], stroke(BLUE, 1.4))?;
    }
    Ok(())
}

/// The mark of a method: round if factorised, square if iterated; hollow on a uniform mesh.
pub(crate) fn mark(
    page: &Page<'_>,
    at: [f64; 2],
    method: &Method,
    colour: Colour,
    radius: f64,
) -> Drawn {
    let colours = match method.mesh {
        Mesh::Uniform => [PAPER, colour],
        Mesh::Adaptive | Mesh::AdaptiveTwo => [colour, PAPER],
    };
    let shape = match method.solver {
        Solver::Ldlt => Shape::Round,
        Solver::Minres => Shape::Square,
    };
    page.mark(at, shape, radius, colours)
}

/// An axis of costs for all points of a problem that panels beside each other show.
pub(crate) fn costs(points: &[Point], measure: Measure) -> Axis {
    let own = points
        .iter()
        .filter(|p| p.setting.problem == measure.problem());
    let costs = own.flat_map(|p| p.seconds.iter().flat_map(|s| [s.low, s.high]));
    Axis::logarithmic(costs, 1.15)
}
