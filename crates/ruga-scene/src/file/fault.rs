//! A value of a scene that is not accepted, and the checks that find it.

use std::path::Path;

use super::names::{file_name_fault, same_file};
use super::read::scene_error;
use crate::SceneError;

/// A key and what is wrong with its value.
pub(super) struct Fault {
    pub(super) key: String,
    pub(super) reason: String,
    /// The accepted value that was probably meant.
    pub(super) suggestion: Option<String>,
}

impl Fault {
    pub(super) fn at(self, path: &Path) -> SceneError {
        scene_error(path, &self.key, None, &self.reason, self.suggestion)
    }
}

pub(super) type Checked = Result<(), Fault>;

pub(super) fn fault(key: &str, found: impl std::fmt::Display, accepted: &str) -> Checked {
    Err(Fault {
        key: key.to_owned(),
        reason: format!("found {found}; accepted: {accepted}"),
        suggestion: None,
    })
}

/// Those of `keys` that are given, for messages.
pub(super) fn names_given(keys: &[(&str, bool)]) -> String {
    let given: Vec<&str> = keys.iter().filter(|key| key.1).map(|key| key.0).collect();
    match given.as_slice() {
        [] => "none of them".to_owned(),
        names => names.join(", "),
    }
}

pub(super) fn positive(key: &str, value: f64) -> Checked {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    fault(key, shortly(value), "a number above 0")
}

pub(super) fn not_negative(key: &str, value: f64) -> Checked {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    fault(key, shortly(value), "a number from 0")
}

/// A number as it is, unless that takes many digits: then with its power of ten.
pub(super) fn shortly(value: f64) -> String {
    let size = value.abs();
    match size.is_finite() && value != 0.0 && !(1e-6..1e9).contains(&size) {
        true => format!("{value:e}"),
        false => value.to_string(),
    }
}

/// A value above 0 and up to 1; of one beyond, what it is in hundredths is suggested.
pub(super) fn fraction_of_pose(key: &str, value: f64) -> Checked {
    if value > 0.0 && value <= 1.0 {
        return Ok(());
    }
    Err(Fault {
        key: key.to_owned(),
        reason: format!("found {value}; accepted: a fraction above 0, up to 1; 0.5 is half way"),
        suggestion: of_hundred(value),
    })
}

/// The fraction that was probably meant by a number of per cent.
pub(super) fn of_hundred(percent: f64) -> Option<String> {
    (percent > 1.0 && percent <= 100.0).then(|| (percent / 100.0).to_string())
}

pub(super) fn within(key: &str, value: u64, least: u64, most: u64) -> Checked {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    let accepted = match most {
        u64::MAX => format!("a whole number from {least}"),
        _ => format!("a whole number from {least} to {most}"),
    };
    fault(key, value, &accepted)
}

pub(super) fn unique_name<'a>(
    key: &str,
    name: &str,
    mut earlier: impl Iterator<Item = &'a String>,
) -> Checked {
    if let Some(reason) = file_name_fault(name) {
        let accepted = format!("a name that can be part of a file name, but {reason}");
        return fault(key, format!("`{name}`"), &accepted);
    }
    if earlier.any(|other| same_file(other, name)) {
        let accepted = "names that differ in more than letter case";
        return fault(key, format!("`{name}` twice"), accepted);
    }
    Ok(())
}
