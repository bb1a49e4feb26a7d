//! What is said on stdout and stderr.

use std::io::{self, Write};

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme};

use crate::error::CliError;
use crate::warning_groups::grouped;

/// A result, on stdout.
pub(crate) fn result(text: &str) {
    // A closed pipe (`ruga plan scene.toml | head`) is the reader's choice, not an error.
    let _ = writeln!(io::stdout().lock(), "{}", text.trim_end());
}

/// A message about the run, on stderr.
pub(crate) fn note(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Something that the user should know, on stderr.
pub(crate) fn warning(text: &str) {
    note(&format!("warning: {text}"));
}

/// Things that the user should know, on stderr, those of one kind in one message. `whole` says where
/// each of them can be read.
pub(crate) fn warnings<'a>(texts: impl IntoIterator<Item = &'a String>, whole: &str) {
    for text in grouped(texts.into_iter().map(String::as_str), whole) {
        warning(&text);
    }
}

/// Prints on stderr why the command could not run, or one of several reasons.
pub(crate) fn error(error: CliError) {
    let error: &dyn Diagnostic = &error;
    let mut text = String::new();
    let mut theme = if io::IsTerminal::is_terminal(&io::stderr()) {
        GraphicalTheme::unicode()
    } else {
        GraphicalTheme::none()
    };
    theme.characters.error = "error:".to_owned();
    // Lines are left whole, so that paths and names in them can be copied and searched for; and
    // every message has its cause in it.
    let handler = GraphicalReportHandler::new_themed(theme)
        .with_wrap_lines(false)
        .without_cause_chain();
    match handler.render_report(&mut text, error) {
        // Flush with the warnings around it; the lines of a long message keep their order of depth.
        Ok(()) => note(text.trim().replace("\n  ", "\n").trim_end()),
        Err(_) => note(&format!("error: {error}")),
    }
}
