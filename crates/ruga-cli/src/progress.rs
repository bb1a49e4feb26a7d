//! How far the poses are: bars on a terminal, lines elsewhere.

use std::io::{self, IsTerminal};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use crate::messages;

/// The bars of all poses in work.
pub(crate) struct PoseProgress {
    bars: Option<MultiProgress>,
    total: usize,
}

impl PoseProgress {
    /// Draws bars if stderr is a terminal.
    pub(crate) fn new(total: usize) -> Self {
        Self {
            bars: io::stderr().is_terminal().then(MultiProgress::new),
            total,
        }
    }

    /// A pose begins, `number` counting from 1. The bar runs to 1000.
    pub(crate) fn start(&self, name: &str, number: usize) -> ProgressBar {
        let Some(bars) = &self.bars else {
            let total = self.total;
            messages::note(&format!("pose `{name}` ({number} of {total}) started"));
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
        match &self.bars {
            Some(bars) => bars.suspend(|| messages::note(text)),
            None => messages::note(text),
        }
    }
}
