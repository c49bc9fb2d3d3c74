//! Time-optimal planning against independent references: least times in closed form, reachability analysis, LinuxCNC's
//! planner.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    dead_code,
    unreachable_pub,
    reason = "a test that cannot be set up has failed; the modules are shared with the benchmarks"
)]

mod cases;
mod circle;
#[cfg(test)]
mod converge;
#[cfg(test)]
#[path = "../benches/limit/curves.rs"]
mod curves;
mod differences;
#[cfg(test)]
mod golden;
#[cfg(test)]
mod least;
#[cfg(test)]
mod lines;
#[cfg(test)]
mod looser;
#[cfg(test)]
#[path = "../benches/limit/machines.rs"]
mod machines;
mod path;
mod planners;
mod programs;
#[cfg(test)]
mod reachability;
mod seven_segments;
mod solvers;
