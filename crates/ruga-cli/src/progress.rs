//! How far the poses are: bars on a terminal, lines elsewhere, or nothing.

use std::io::{self, IsTerminal};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use crate::arguments::RunArguments;
use crate::messages;

/// Ways to tell how far the poses are.
enum Telling {
    /// Bars on a terminal, which make way for a line per pose.
    Bars(MultiProgress),
    /// A line when a pose begins and one when it ends.
    Lines,
    /// Nothing, as the user wishes.
    Nothing,
}

/// How far the poses in work are.
pub(crate) struct PoseProgress {
    telling: Telling,
    total: usize,
}

impl PoseProgress {
    /// Draws bars if stderr is a terminal, and says nothing where the run is to be quiet.
    pub(crate) fn new(total: usize, arguments: &RunArguments) -> Self {
        let telling = match (arguments.quiet, io::stderr().is_terminal()) {
            (true, _) => Telling::Nothing,
            (false, true) => Telling::Bars(MultiProgress::new()),
            (false, false) => Telling::Lines,
        };
        Self { telling, total }
    }

    /// A pose begins, `number` counting from 1. The bar runs to 1000.
    pub(crate) fn start(&self, name: &str, number: usize) -> ProgressBar {
        let Telling::Bars(bars) = &self.telling else {
            let total = self.total;
            self.note(&format!("pose `{name}` ({number} of {total}) started"));
            return ProgressBar::hidden();
        };
        const LAYOUT: &str = "{prefix} [{bar:30}] {percent:>3} % {elapsed} {msg}";
        let style = ProgressStyle::with_template(LAYOUT)
            .expect("the template has only keys that indicatif knows")
            .progress_chars("=> ");
        let bar = ProgressBar::new(1000).with_style(style);
        bars.add(bar.with_prefix(name.to_owned()))
    }

    /// A pose has ended; its bar makes way for one line.
    pub(crate) fn end(&self, bar: &ProgressBar, text: &str) {
        bar.finish_and_clear();
        self.note(text);
    }

    /// A message that leaves the bars whole.
    pub(crate) fn note(&self, text: &str) {
        match &self.telling {
            Telling::Bars(bars) => bars.suspend(|| messages::note(text)),
            Telling::Lines => messages::note(text),
            Telling::Nothing => {}
        }
    }
}
