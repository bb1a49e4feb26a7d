//! What is kept of a finished pose, so that a later run need not repeat it.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use ruga_io::{IoError, PoseReport, WrinkleMap, write_atomically};
use serde::{Deserialize, Serialize};

use crate::error::CliError;
use crate::fingerprint::Fingerprint;

/// `poses/<pose>.json`: written when all files of the pose are.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct PoseRecord {
    /// Fingerprint of everything the pose was made from.
    pub(crate) inputs: String,
    /// Its entry in the report.
    pub(crate) report: PoseReport,
    /// Its entries in the manifest.
    pub(crate) maps: Vec<WrinkleMap>,
    /// Its files, relative to the output folder.
    pub(crate) files: Vec<String>,
    /// What the user should know.
    pub(crate) warnings: Vec<String>,
}

impl PoseRecord {
    /// The record of a pose made from the same `inputs`, if all its files are still there.
    pub(crate) fn find(folder: &Path, pose: &str, inputs: Fingerprint) -> Option<Self> {
        let record = Self::read(folder, pose)?;
        let whole = record.files.iter().all(|file| folder.join(file).is_file());
        (record.inputs == inputs.text() && record.report.name == pose && whole).then_some(record)
    }

    /// Forgets the pose before its files are touched: a record never vouches for files of two
    /// runs. Returns the files that it knew.
    ///
    /// # Errors
    /// The record is there and cannot be removed.
    pub(crate) fn forget(folder: &Path, pose: &str) -> Result<Vec<String>, CliError> {
        let files = Self::read(folder, pose).map_or_else(Vec::new, |record| record.files);
        let path = path(folder, pose);
        match fs::remove_file(&path) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => {
                Err(IoError::Unwritable { path, source }.into())
            }
            _ => Ok(files),
        }
    }

    /// Removes files of an `earlier` run that this one has not written again, such as the maps of
    /// keys that are gone. Frames leave maps alone and maps frames: the other command's results
    /// stay good.
    pub(crate) fn remove_leftovers(&self, folder: &Path, earlier: &[String]) {
        let own: Vec<_> = self.files.iter().map(|file| kind(file)).collect();
        let is_left = |file: &&String| own.contains(&kind(file)) && !self.files.contains(file);
        remove(folder, earlier.iter().filter(is_left));
    }

    fn read(folder: &Path, pose: &str) -> Option<Self> {
        let text = fs::read(path(folder, pose)).ok()?;
        serde_json::from_slice(&text).ok()
    }

    /// Writes the record, whole or not at all.
    ///
    /// # Errors
    /// [`IoError::Unwritable`].
    pub(crate) fn write(&self, folder: &Path) -> Result<(), CliError> {
        let text = serde_json::to_vec_pretty(self)
            .expect("structs of numbers, strings, lists and string-keyed maps always serialise");
        Ok(write_atomically(&path(folder, &self.report.name), &text)?)
    }
}

/// First part of a file's path: what kind of result it is. Where a body is belongs to its maps.
fn kind(file: &str) -> Option<&str> {
    match file.split('/').next() {
        Some("bodies") => Some("maps"),
        other => other,
    }
}

/// Removes a pose's frames, of whatever earlier run, before new ones are written among them.
pub(crate) fn remove_frames(folder: &Path, pose: &str) {
    let Ok(entries) = fs::read_dir(folder.join("frames").join(pose)) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_frame = name.to_str().and_then(|name| name.strip_suffix(".obj"));
        let number = is_frame.and_then(|stem| stem.rsplit_once('.'));
        if number.is_some_and(|(_, n)| n.len() >= 4 && n.bytes().all(|b| b.is_ascii_digit())) {
            // What cannot be removed is written over, or left behind as it was.
            let _ = fs::remove_file(entry.path());
        }
    }
}

fn remove<'a>(folder: &Path, files: impl Iterator<Item = &'a String>) {
    let is_inside = |file: &String| {
        let mut parts = Path::new(file).components();
        parts.all(|part| matches!(part, Component::Normal(_)))
    };
    for file in files.filter(|file| is_inside(file)) {
        // What is gone already, or cannot be removed, does no harm to this run.
        let _ = fs::remove_file(folder.join(file));
    }
}

fn path(folder: &Path, pose: &str) -> PathBuf {
    folder.join("poses").join(format!("{pose}.json"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_to_the_last_bit() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let inputs = Fingerprint::new();
        // Three that were read back one bit off.
        let numbers = [
            0.009071926551786267,
            3.5664748782203764e-7,
            6.791338225313123e-9,
        ];
        for number in numbers {
            let mut report = PoseReport {
                name: "a".to_owned(),
                ..PoseReport::default()
            };
            report.layers.push(ruga_io::LayerReport {
                energy_j: Some(number),
                ..ruga_io::LayerReport::default()
            });
            let record = PoseRecord {
                inputs: inputs.text(),
                report: report.clone(),
                maps: Vec::new(),
                files: Vec::new(),
                warnings: Vec::new(),
            };
            record.write(folder.path()).expect("a folder to write to");
            let found = PoseRecord::find(folder.path(), "a", inputs).expect("the record");
            assert_eq!(found.report, report);
        }
    }

    #[test]
    fn leftovers_of_the_other_command_stay() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let earlier = ["frames/a/skin.0007.obj", "maps/a_100_normal.png"];
        for file in earlier {
            let path = folder.path().join(file);
            fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
            fs::write(path, "x").expect("a file");
        }
        let record = PoseRecord {
            inputs: String::new(),
            report: PoseReport::default(),
            maps: Vec::new(),
            files: vec!["frames/a/skin.0000.obj".to_owned()],
            warnings: Vec::new(),
        };
        record.remove_leftovers(folder.path(), &earlier.map(str::to_owned));
        assert!(!folder.path().join(earlier[0]).exists());
        assert!(folder.path().join(earlier[1]).exists());
    }

    #[test]
    fn frames_go_before_new_ones_come_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let frames = folder.path().join("frames/a");
        fs::create_dir_all(&frames).expect("a folder");
        for name in [
            "skin.0007.obj",
            "skin.0123.obj",
            "mine.obj",
            "skin.0007.blend",
        ] {
            fs::write(frames.join(name), "x").expect("a file");
        }
        remove_frames(folder.path(), "a");
        remove_frames(folder.path(), "b");
        let left = fs::read_dir(&frames).expect("a folder");
        let mut left: Vec<_> = left.flatten().map(|entry| entry.file_name()).collect();
        left.sort();
        assert_eq!(left, ["mine.obj", "skin.0007.blend"]);
    }
}
