//! Crease elements at equal error, ours and those of Patkar, Jin and Fedkiw 2014: measured, and drawn into a
//! panel.

use serde::{Deserialize, Serialize};

use crate::plot::colours::{BLUE, FAINT, PAPER, RED};
use crate::plot::{
    Axis, Colour, Drawn, Lettering, PLAIN, Page, Panel, Shape, Stroke, Title, stroke,
};
use crate::ridge::{FoldElement, fold_error};

/// A skin that was pressed onto a ridge whose angle varies.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FoldRun {
    /// Name of its elements.
    pub element: String,
    /// Edges along a side.
    pub edges: usize,
    /// Triangles.
    pub faces: usize,
    /// Root of the energy of the error over that of the ridge.
    pub error: f64,
    /// Processor seconds, meshing left out.
    pub seconds: f64,
    /// Multiplications and additions of one factorisation.
    pub flops: f64,
}

/// Elements, their names, and what they are drawn in.
pub const ELEMENTS: [(FoldElement, &str, Colour); 3] = [
    (FoldElement::Plain, "no crease", FAINT),
    (FoldElement::VirtualNodes, "virtual nodes (the paper)", RED),
    (FoldElement::CreaseEdges, "edges on the crease (ruga)", BLUE),
];

/// Times that a run is made; the quickest counts.
const REPEATS: usize = 3;

/// Measures all elements on meshes of 8 to 64 edges along a side, or to 32 if quick.
pub fn measure_folds(quick: bool) -> Vec<FoldRun> {
    let sizes: &[usize] = match quick {
        true => &[8, 16, 32],
        false => &[8, 16, 32, 64],
    };
    let mut runs = Vec::new();
    for (element, name, _) in ELEMENTS {
        for &edges in sizes {
            let mut least = fold_error(element, edges);
            for _ in 1..REPEATS {
                least.seconds = least.seconds.min(fold_error(element, edges).seconds);
            }
            runs.push(FoldRun {
                element: name.to_owned(),
                edges,
                faces: least.faces,
                error: least.error,
                seconds: least.seconds,
                flops: least.cost.flops,
            });
        }
    }
    runs
}

/// The runs of one element.
pub fn of_element<'a>(runs: &'a [FoldRun], name: &str) -> Vec<&'a FoldRun> {
    runs.iter().filter(|run| run.element == name).collect()
}

/// What an element's first runs say a quantity is at an `error`: along a straight line of logarithms through
/// the two runs beside it, or beyond the last two. The flag says that it is beyond.
pub fn at_error(
    runs: &[&FoldRun],
    error: f64,
    quantity: impl Fn(&FoldRun) -> f64,
) -> Option<(f64, bool)> {
    let found = runs.windows(2).find(|pair| pair[1].error <= error);
    let pair = found.or_else(|| runs.windows(2).last())?;
    let [a, b] = [pair[0], pair[1]];
    let share = (a.error / error).ln() / (a.error / b.error).ln();
    let [low, high] = [a, b].map(&quantity);
    let is_beyond = !(0.0..=1.0).contains(&share);
    Some((low * (high / low).powf(share), is_beyond))
}

/// What a panel has across.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoldCost {
    /// Triangles.
    Faces,
    /// Processor seconds.
    Seconds,
}

impl FoldCost {
    fn of(self, run: &FoldRun) -> f64 {
        match self {
            Self::Faces => run.faces as f64,
            Self::Seconds => 1e3 * run.seconds,
        }
    }
}

/// Draws error against cost.
///
/// # Errors
/// What the drawing library says.
pub fn draw_folds(page: &Page<'_>, frame: [f64; 4], runs: &[FoldRun], cost: FoldCost) -> Drawn {
    let (name, across) = match cost {
        FoldCost::Faces => ("A fold whose angle varies", "triangles"),
        FoldCost::Seconds => ("Crease elements at equal error", "processor milliseconds"),
    };
    let title = Title {
        name,
        note: "upwards: error of the slopes in the energy norm, %",
        across,
    };
    let x = Axis::logarithmic(runs.iter().map(|run| cost.of(run)), 1.5);
    let y = Axis::logarithmic(runs.iter().map(|run| 100.0 * run.error), 1.6);
    let panel = Panel::draw(page, frame, title, [x, y])?;
    for (_, name, colour) in ELEMENTS {
        let own = of_element(runs, name);
        let values: Vec<_> = own
            .iter()
            .map(|run| [cost.of(run), 100.0 * run.error])
            .collect();
        let places = panel.places(&values);
        page.line(&places, fold_stroke(colour))?;
        for at in places {
            page.mark(at, Shape::Round, 5.0, [colour, PAPER])?;
        }
    }
    // Names at the lower left, where no line is.
    let [left, _, _, bottom] = frame;
    for (line, (_, name, colour)) in ELEMENTS.iter().rev().enumerate() {
        let at = [left + 12.0, bottom - 16.0 - 19.0 * line as f64];
        let style = Lettering {
            colour: *colour,
            ..PLAIN
        };
        page.text(at, name, style)?;
    }
    Ok(())
}

fn fold_stroke(colour: Colour) -> Stroke {
    stroke(colour, if colour == FAINT { 1.8 } else { 2.8 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_at_equal_error_lie_on_lines_of_logarithms() {
        let run = |edges: usize, error: f64| FoldRun {
            element: String::new(),
            edges,
            faces: edges * edges,
            error,
            seconds: 1.0,
            flops: 1.0,
        };
        let runs = [run(10, 0.1), run(20, 0.05), run(40, 0.025)];
        let runs: Vec<_> = runs.iter().collect();
        let faces = |error| at_error(&runs, error, |run| run.faces as f64).expect("a line");
        assert!((faces(0.05).0 - 400.0).abs() < 1e-6 && !faces(0.05).1);
        assert!((faces(0.0125).0 - 6400.0).abs() < 1e-6 && faces(0.0125).1);
        assert!((faces(0.2).0 - 25.0).abs() < 1e-6 && faces(0.2).1);
    }
}
