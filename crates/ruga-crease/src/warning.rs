//! What is odd about crease lines that can be used all the same.

/// Something about crease lines that may not be meant. Lines count from 0, in the order given; places are arc
/// lengths along them (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CreaseWarning {
    /// A line crosses itself: it folds there as where two lines meet.
    SelfCrossing {
        /// The line.
        line: usize,
        /// Where on it, both times.
        at: [f64; 2],
    },
    /// Two lines, or two parts of one, come closer than two edges without meeting: what lies between them is too
    /// narrow for the mesh.
    TooClose {
        /// The lines, equal for parts of one.
        lines: [usize; 2],
        /// Where on the first.
        at: f64,
        /// Least distance (m).
        distance: f64,
    },
    /// A stretch of a line runs along edges of the cut mesh that an earlier line has, or the line itself: they
    /// fold once, as the earlier one says.
    Shared {
        /// The line that has the edges, and the one that runs along them as well.
        lines: [usize; 2],
        /// From where to where on the second.
        at: [f64; 2],
    },
    /// A stretch of a line has no inner edges in the cut mesh.
    Gap {
        /// The line.
        line: usize,
        /// From where to where on it.
        at: [f64; 2],
    },
    /// No edge of the cut mesh lies on a line: it runs inside one face.
    NoEdges {
        /// The line.
        line: usize,
    },
}

/// Distance (m) up to which a line lies on itself: a hundredth of a millimetre is less than any mesh has.
const ON_ITSELF: f64 = 1e-5;

impl std::fmt::Display for CreaseWarning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.told(&|line| format!("line {line}")))
    }
}

impl CreaseWarning {
    /// The warning in words, with the lines as `name` calls them by their number.
    pub fn told(&self, name: &dyn Fn(usize) -> String) -> String {
        let mm = |metres: f64| metres * 1e3;
        match *self {
            Self::SelfCrossing { line, at: [a, b] } => format!(
                "{} crosses itself, {:.2} and {:.2} mm from its start, and folds there as where two lines cross",
                name(line),
                mm(a),
                mm(b)
            ),
            Self::TooClose {
                lines: [a, b],
                at,
                distance,
            } if a == b && distance < ON_ITSELF => format!(
                "{} lies on itself, {:.2} mm from its start, and folds once there; lead it along each place once",
                name(a),
                mm(at)
            ),
            Self::TooClose {
                lines: [a, b],
                at,
                distance,
            } => {
                let (who, whose, them) = match a == b {
                    true => (format!("{} comes", name(a)), "its start", "its parts"),
                    false => (
                        format!("{} and {} come", name(a), name(b)),
                        "the start of the first",
                        "them",
                    ),
                };
                let to_itself = if a == b { " of itself" } else { "" };
                format!(
                    "{who} within {:.2} mm{to_itself}, {:.2} mm from {whose}: the mesh is too coarse for two folds there; move {them} apart, or refine the mesh",
                    mm(distance),
                    mm(at)
                )
            }
            Self::Shared {
                lines: [first, second],
                at: [a, b],
            } => format!(
                "{} runs along {} from {:.2} to {:.2} mm from its start, where it folds nothing of its own",
                name(second),
                name(first),
                mm(a),
                mm(b)
            ),
            Self::Gap { line, at: [a, b] } => format!(
                "{} folds nothing from {:.2} to {:.2} mm from its start, where no edges of the mesh lie on it",
                name(line),
                mm(a),
                mm(b)
            ),
            Self::NoEdges { line } => format!(
                "{} lies inside one triangle of the mesh and folds nothing; lengthen it, or refine the mesh",
                name(line)
            ),
        }
    }
}
