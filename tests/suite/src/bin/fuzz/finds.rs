//! The finds of a target, those of one kind together.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use ruga_tests::Target;

/// Inputs of one kind that are kept.
const KEPT: usize = 3;

/// Finds by kind: what was said, numbers left out.
pub(crate) struct Finds {
    folder: PathBuf,
    target: Target,
    kinds: BTreeMap<String, Kind>,
}

#[derive(Default)]
struct Kind {
    numbers: Vec<u64>,
    what: String,
}

impl Finds {
    pub(crate) fn new(folder: &Path, target: Target) -> Self {
        Self {
            folder: folder.to_owned(),
            target,
            kinds: BTreeMap::new(),
        }
    }

    /// Remembers a find. Its input is in the folder; of each kind a few are left there.
    pub(crate) fn add(&mut self, number: u64, what: &str) {
        let words = what.split(|c: char| !c.is_alphabetic());
        let key: String = words.filter(|word| word.len() > 1).take(25).collect();
        let kind = self.kinds.entry(key).or_default();
        let name = format!("{}-{number}", self.target.name());
        let input = self.folder.join(&name);
        if kind.numbers.len() < KEPT {
            eprintln!("find {name}: {what}");
            // The message is in the table too.
            let _ = fs::write(input.join("find.txt"), what);
        } else {
            let _ = fs::remove_dir_all(input);
        }
        if kind.numbers.is_empty() {
            kind.what = what.to_owned();
        }
        kind.numbers.push(number);
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.kinds.is_empty()
    }

    pub(crate) fn count(&self) -> u64 {
        self.kinds
            .values()
            .map(|kind| kind.numbers.len() as u64)
            .sum()
    }

    pub(crate) fn print(&self) {
        for kind in self.kinds.values() {
            let first = kind.numbers.first().copied().unwrap_or_default();
            let short: String = kind.what.chars().take(300).collect();
            println!(
                "{} x {}-{first}: {short}",
                kind.numbers.len(),
                self.target.name()
            );
        }
    }
}
