//! Whole runs of the `twin` binary against expectations that do not come from it.
//!
//! Every folder of `tests/data` is a case: `case.toml` says what to run, with which exit status it must end, what it
//! must print, and, always, where the expected values come from. Paths are relative to the folder; `machines/` and
//! `examples/` at the beginning of an argument are those of the workspace. `cases.toml` has the same keys for the folders
//! of `../shared/cases`.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test that cannot be set up has failed"
)]

mod approach;
mod cam;
mod cam_extremes;
mod cam_forms;
mod canonical;
mod case;
mod cases;
mod check_limits;
mod collision;
mod compare;
mod desk;
mod drive;
mod drive_beforehand;
mod drive_home;
mod drive_repair;
mod drive_stop;
mod drive_words;
mod emulate;
mod explain;
mod finite;
mod handling;
mod in_loop;
mod job;
mod job_cams;
mod job_steps;
mod limit;
mod long_input;
mod machine;
mod modbus;
mod motors;
mod net;
mod outputs;
mod path;
mod process;
mod program_text;
mod real;
mod real_encoders;
mod real_losses;
mod real_stops;
mod real_switches;
mod recording;
mod reference;
mod remedies;
mod run_keys;
mod run_limits;
mod sequence;
mod shop;
mod spindle;
mod subroutines;
mod surroundings;
mod switch_points;
mod targets;
mod tune_alike;
mod tune_cam;
mod tune_least;
mod tune_limits;
mod tune_recorded;
mod tune_start;
mod tune_tappets;
mod tuning;
mod urdf;
mod verdict;

use desk::{root, word};
