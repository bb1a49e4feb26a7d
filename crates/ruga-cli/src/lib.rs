//! The command `ruga`: command-line arguments go in, maps, meshes and an exit code come out.
#![doc = include_str!("../README.md")]
//!
//! ## Parts
//!
//! A *scene* is read with everything that it names (`ruga-scene`). A *plan* says what will be simulated
//! in each *pose*. `bake` and `simulate` work on as many poses at a time as there are threads and memory for,
//! and keep a *record* of each finished pose, so that an interrupted run can go on where it stopped. Report and
//! manifest are made of all records in the output folder that fit the scene, so that a run of one pose
//! leaves the others listed; one run at a time *locks* the folder. On a render farm each run is a *task*,
//! which locks its poses only, and a *merge* makes report and manifest; `job` writes both as a template. The
//! *preview* and *packed* maps are made of the files in the folder.
//!
//! Results are printed on stdout, progress and messages on stderr. Exit codes: 0 done; 1 ran, but
//! a pose did not converge or the run was interrupted, with the results written and marked; 2 could
//! not run. Lengths are metres in every file and in JSON; tables for people say their units.

mod arguments;
mod commands;
mod outcome;
mod run;

mod artist_file;
mod baked_poses;
mod canvas;
mod frame_files;
mod map_files;
mod memory_limit;
mod memory_size;
mod moved_mesh;
mod plan_page;
mod plan_painting;
mod plan_picture;
mod pose_queue;
mod pose_report;
mod pose_runs;
mod preview_fault;
mod preview_page;
mod summary;
mod tile_numbers;
mod time_left;
mod watch;

mod folder_lock;
mod folder_results;
mod kept_pose;
mod output_folder;
mod pack_files;
mod pose_inputs;
mod pose_record;
mod scene_origin;

mod fingerprint;
mod interrupt;
mod messages;
mod progress;
mod table;
mod templates;
mod warning_groups;

mod detail_files;
mod error;

pub use run::run;
