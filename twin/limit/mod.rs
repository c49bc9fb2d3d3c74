//! Time-optimal planning of programs: profile as a table (CSV) and as a picture (SVG), and summary for people and for
//! other programs.
//!
//! All outputs take [`ProfileSample`]s one by one in order of time. Their memory does not grow with the length of the
//! program.

mod binding;
mod controller;
mod csv;
#[cfg(test)]
mod curve_tests;
#[cfg(test)]
mod drag_tests;
#[cfg(test)]
mod effort_tests;
mod explain;
mod feeds;
mod gaps;
#[cfg(test)]
mod gear_tests;
mod json;
mod lines;
mod losses;
mod machine_path;
#[cfg(test)]
mod machine_tests;
mod out_of_reach;
mod picture;
mod plan;
mod sample;
mod slaves;
mod summary;
#[cfg(test)]
mod tests;
mod text;
#[cfg(test)]
mod turning_tests;
mod watch;

pub use binding::{Binding, Quantity};
pub use controller::ControllerProfile;
pub use csv::ProfileCsv;
pub use json::LimitReport;
pub use lines::{LineShare, write_lines};
pub(crate) use machine_path::Trial;
pub use machine_path::{AxisRules, MachinePath, MachinePathError};
pub(crate) use out_of_reach::out_of_reach;
pub use picture::Picture;
pub use plan::{LimitFailure, LimitRules, Profile, ProfileItem};
pub(crate) use plan::{not_solved, planner};
pub use sample::ProfileSample;
pub use summary::{BindingShare, Change, LimitSummary, Limits, LineLoss, Summing, Windows};
pub use text::write_summary;
