//! What is kept of a finished pose, so that a later run need not repeat it.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use ruga_io::{IoError, MapKind, PoseReport, WrinkleMap, write_atomically};
use serde::{Deserialize, Serialize};

use crate::error::CliError;
use crate::fingerprint::Fingerprint;
use crate::scene_origin::SceneOrigin;

/// A pose whose files are written; an interrupted one has those of the keys that were finished.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct PoseRecord {
    /// The scene that the pose belongs to.
    pub(crate) origin: SceneOrigin,
    /// Fingerprint of everything the pose was made from but the quality.
    pub(crate) inputs: String,
    /// The quality: vertices per wavelength that were asked for.
    pub(crate) points_per_wavelength: f64,
    /// The keys that were reached, as fractions of the pose.
    pub(crate) keys: Vec<f64>,
    /// Its entry in the report.
    pub(crate) report: PoseReport,
    /// Its entries in the manifest.
    pub(crate) maps: Vec<WrinkleMap>,
    /// Its files, relative to the output folder.
    pub(crate) files: Vec<String>,
    /// Files of earlier runs that this one has not written again, such as the maps of keys that are
    /// gone. They go when the pose is finished and nothing lists them any more.
    pub(crate) leftovers: Vec<String>,
    /// Warnings for the user.
    pub(crate) warnings: Vec<String>,
}

impl PoseRecord {
    /// Whether the pose was made from just these inputs and its files are there.
    pub(crate) fn is_current(&self, output: &Path, inputs: Fingerprint) -> bool {
        self.inputs == inputs.text() && self.is_whole(output)
    }

    /// The last key that was reached.
    pub(crate) fn last_key(&self) -> Option<f64> {
        self.keys.last().copied()
    }

    /// The map of a kind at a key.
    pub(crate) fn map(&self, kind: MapKind, key: f64) -> Option<&WrinkleMap> {
        let mut maps = self.maps.iter();
        maps.find(|map| map.kind == kind && map.key == key)
    }

    /// The map of a kind at the last key.
    pub(crate) fn last_map(&self, kind: MapKind) -> Option<&WrinkleMap> {
        self.map(kind, self.last_key()?)
    }

    /// Whether all its files are still there.
    pub(crate) fn is_whole(&self, output: &Path) -> bool {
        self.files.iter().all(|file| output.join(file).is_file())
    }
}

/// The records of what one command made in an output folder: `poses/<pose>.json` of `bake`,
/// `poses/frames/<pose>.json` of `simulate`, `poses/age/<pose>.json` of `age`. Each command has its own, so that
/// none loses what another has made.
#[derive(Clone, Debug)]
pub(crate) struct Records {
    /// The output folder.
    pub(crate) output: PathBuf,
    /// Folder of the records.
    folder: PathBuf,
}

impl Records {
    /// Records of `ruga bake`.
    pub(crate) fn of_bake(output: &Path) -> Self {
        Self {
            output: output.to_owned(),
            folder: output.join("poses"),
        }
    }

    /// Records of `ruga simulate`.
    pub(crate) fn of_simulate(output: &Path) -> Self {
        Self {
            output: output.to_owned(),
            folder: output.join("poses").join("frames"),
        }
    }

    /// Records of `ruga age`.
    pub(crate) fn of_age(output: &Path) -> Self {
        Self {
            output: output.to_owned(),
            folder: output.join("poses").join("age"),
        }
    }

    /// The record of a pose, if there is one that can be read.
    pub(crate) fn read(&self, pose: &str) -> Option<PoseRecord> {
        let text = fs::read(self.path(pose)).ok()?;
        let record: PoseRecord = serde_json::from_slice(&text).ok()?;
        (record.report.name == pose).then_some(record)
    }

    /// Every record that can be read, by name.
    pub(crate) fn all(&self) -> Vec<PoseRecord> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let names = entries.filter_map(|entry| {
            let name = entry.file_name().into_string().ok()?;
            Some(name.strip_suffix(".json")?.to_owned())
        });
        let mut names: Vec<String> = names.collect();
        names.sort();
        names.iter().filter_map(|name| self.read(name)).collect()
    }

    /// Writes a record, whole or not at all.
    ///
    /// # Errors
    /// [`IoError::Unwritable`].
    pub(crate) fn write(&self, record: &PoseRecord) -> Result<(), CliError> {
        let text = serde_json::to_vec_pretty(record)
            .expect("structs of numbers, strings, lists and string-keyed maps always serialise");
        Ok(write_atomically(&self.path(&record.report.name), &text)?)
    }

    /// Forgets the pose before its files are touched: a record never vouches for files of two
    /// runs. Returns the files that it knew.
    ///
    /// # Errors
    /// The record is there and cannot be removed.
    pub(crate) fn forget(&self, pose: &str) -> Result<Vec<String>, CliError> {
        let known = self
            .read(pose)
            .map_or_else(Vec::new, |record| [record.files, record.leftovers].concat());
        let path = self.path(pose);
        match fs::remove_file(&path) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => {
                Err(IoError::Unwritable { path, source }.into())
            }
            _ => Ok(known),
        }
    }

    /// Removes files of earlier runs.
    pub(crate) fn remove(&self, leftovers: &[String]) {
        let is_inside = |file: &&String| {
            let mut parts = Path::new(file).components();
            parts.all(|part| matches!(part, Component::Normal(_)))
        };
        for file in leftovers.iter().filter(is_inside) {
            // What is gone already, or cannot be removed, does no harm to this run.
            let _ = fs::remove_file(self.output.join(file));
        }
    }

    fn path(&self, pose: &str) -> PathBuf {
        self.folder.join(format!("{pose}.json"))
    }
}

/// Removes a pose's frames, of whatever earlier run, before new ones are written among them.
pub(crate) fn remove_frames(folder: &Path, pose: &str) {
    let Ok(entries) = fs::read_dir(folder.join("frames").join(pose)) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_frame = name.to_str().and_then(|name| {
            let mut ends = [".obj", ".vtu"].into_iter();
            ends.find_map(|end| name.strip_suffix(end))
        });
        let number = is_frame.and_then(|stem| stem.rsplit_once('.'));
        if number.is_some_and(|(_, n)| n.len() >= 4 && n.bytes().all(|b| b.is_ascii_digit())) {
            // What cannot be removed is written over, or left behind as it was.
            let _ = fs::remove_file(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(name: &str) -> PoseRecord {
        PoseRecord {
            origin: SceneOrigin {
                scene: "../scene.toml".to_owned(),
                mesh: "Patch".to_owned(),
            },
            inputs: Fingerprint::new().text(),
            points_per_wavelength: 12.0,
            keys: vec![1.0],
            report: PoseReport {
                name: name.to_owned(),
                ..PoseReport::default()
            },
            maps: Vec::new(),
            files: Vec::new(),
            leftovers: Vec::new(),
            warnings: Vec::new(),
        }
    }

    #[test]
    fn numbers_come_back_to_the_last_bit() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let records = Records::of_bake(folder.path());
        // Three that were read back one bit off.
        let numbers = [
            0.009071926551786267,
            3.5664748782203764e-7,
            6.791338225313123e-9,
        ];
        for number in numbers {
            let mut record = record("a");
            record.report.layers.push(ruga_io::LayerReport {
                energy_j: Some(number),
                ..ruga_io::LayerReport::default()
            });
            records.write(&record).expect("a folder to write to");
            let found = records.read("a").expect("the record");
            assert_eq!(found.report, record.report);
        }
    }

    #[test]
    fn each_command_has_its_own_records() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let [baked, simulated] =
            [Records::of_bake, Records::of_simulate].map(|of| of(folder.path()));
        baked.write(&record("b")).expect("a folder to write to");
        baked.write(&record("a")).expect("a folder to write to");
        simulated.write(&record("c")).expect("a folder to write to");
        let names = |records: &Records| -> Vec<String> {
            let all = records.all().into_iter();
            all.map(|record| record.report.name).collect()
        };
        assert_eq!(names(&baked), ["a", "b"]);
        assert_eq!(names(&simulated), ["c"]);
    }

    #[test]
    fn what_a_record_says_outside_its_folder_is_left_alone() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let out = folder.path().join("out");
        fs::create_dir_all(&out).expect("a folder");
        for path in [folder.path().join("mine"), out.join("old")] {
            fs::write(path, "x").expect("a file");
        }
        let leftovers = ["../mine", "old"].map(str::to_owned);
        Records::of_bake(&out).remove(&leftovers);
        assert!(folder.path().join("mine").exists());
        assert!(!out.join("old").exists());
    }

    #[test]
    fn frames_go_before_new_ones_come_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let frames = folder.path().join("frames/a");
        fs::create_dir_all(&frames).expect("a folder");
        for name in [
            "skin.0007.obj",
            "skin.0123.vtu",
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
