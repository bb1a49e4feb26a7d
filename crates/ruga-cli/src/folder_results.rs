//! What stands in an output folder, of this run and of earlier ones.

use std::path::Path;

use ruga_scene::counted;

use crate::error::CliError;
use crate::messages;
use crate::pose_inputs::ScenePose;
use crate::pose_record::{PoseRecord, Records};
use crate::scene_origin::SceneOrigin;

/// The poses of a scene in its output folder.
#[derive(Debug)]
pub(crate) struct FolderResults {
    records: Records,
    /// Those that fit this version of the scene, in its order: what report and manifest list.
    pub(crate) current: Vec<PoseRecord>,
    /// Notes for the user about the others.
    pub(crate) notes: Vec<String>,
}

impl FolderResults {
    /// Reads the records of every pose.
    ///
    /// Poses made from an older version of the scene are not listed: their maps may have another size
    /// or frame than the manifest says, and would show another skin. Nothing of them is removed, and
    /// where the scene becomes what it was they are listed again.
    pub(crate) fn read(records: &Records, poses: &[ScenePose]) -> Self {
        let (mut older, mut incomplete) = (Vec::new(), Vec::new());
        let mut current = Vec::new();
        for pose in poses {
            match records.read(&pose.name) {
                Some(record) if record.inputs != pose.inputs.text() => older.push(&pose.name),
                Some(record) if !record.is_whole(&records.output) => incomplete.push(&pose.name),
                record => current.extend(record),
            }
        }
        let all = records.all();
        let names = all.iter().map(|record| &record.report.name);
        let is_gone = |name: &&String| !poses.iter().any(|pose| pose.name == **name);
        let gone: Vec<&String> = names.filter(is_gone).collect();
        let not_listed = |names: &[&String], why: &str| {
            let poses = listed(names);
            let text = format!("not listed in the results, because {why}: {poses}");
            (!names.is_empty()).then_some(text)
        };
        let notes = [
            not_listed(
                &older,
                "made from an older version of the scene, its mesh, its images or of ruga (their files \
                 are still there; bake or simulate them again)",
            ),
            not_listed(&incomplete, "some of their files are gone"),
            not_listed(
                &gone,
                "the scene has them no more (their files are still there)",
            ),
        ];
        Self {
            records: records.clone(),
            current,
            notes: notes.into_iter().flatten().collect(),
        }
    }

    /// Removes what finished poses have left of earlier runs. Report and manifest are written before,
    /// so that they never name files that are gone, wherever a run is killed.
    ///
    /// # Errors
    /// A record cannot be written.
    pub(crate) fn remove_leftovers(&self) -> Result<(), CliError> {
        let finished = self.current.iter().filter(|pose| !pose.report.interrupted);
        for pose in finished.filter(|pose| !pose.leftovers.is_empty()) {
            self.records.remove(&pose.leftovers);
            self.records.write(&PoseRecord {
                leftovers: Vec::new(),
                ..pose.clone()
            })?;
        }
        Ok(())
    }
}

/// `2 poses, `a` and others`, naming the first few.
fn listed(names: &[&String]) -> String {
    const MOST: usize = 5;
    let shown: Vec<String> = names.iter().take(MOST).map(|n| format!("`{n}`")).collect();
    let more = names.len().saturating_sub(MOST);
    let more = match more {
        0 => String::new(),
        _ => format!(" and {more} more"),
    };
    format!(
        "{} ({}{more})",
        counted(names.len(), "pose"),
        shown.join(", ")
    )
}

/// Makes sure that the folder is `own` scene's: it has results of no other one. With `force` those of
/// others are forgotten; their files stay until they are written over.
///
/// A scene that was renamed and not changed is the same one: its results still fit.
///
/// # Errors
/// [`CliError::OtherScene`].
pub(crate) fn claim(
    output: &Path,
    own: &SceneOrigin,
    poses: &[ScenePose],
    force: bool,
) -> Result<(), CliError> {
    let is_foreign = |record: &PoseRecord| {
        let fits = |pose: &ScenePose| {
            record.report.name == pose.name && record.inputs == pose.inputs.text()
        };
        record.origin != *own && !poses.iter().any(fits)
    };
    let commands = [Records::of_bake, Records::of_simulate, Records::of_age].map(|of| of(output));
    let mut foreign = Vec::new();
    for records in &commands {
        let others = records.all().into_iter().filter(is_foreign);
        foreign.extend(others.map(|record| (records, record)));
    }
    let Some((_, first)) = foreign.first() else {
        return Ok(());
    };
    let (origin, count) = (first.origin.clone(), foreign.len());
    if !force {
        return Err(CliError::OtherScene {
            path: output.to_owned(),
            count,
            other: origin.to_string(),
            own: own.to_string(),
        });
    }
    for (records, record) in &foreign {
        records.forget(&record.report.name)?;
    }
    messages::note(&format!(
        "{}: {} of the scene {origin} left out of the results from now on; files that this run does \
         not write stay",
        output.display(),
        counted(count, "pose"),
    ));
    Ok(())
}
