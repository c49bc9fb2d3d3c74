//! Tests of axes and their blocks, cycle by cycle.

#![allow(
    clippy::float_cmp,
    reason = "set-points that are exact: targets, values at rest, what was written"
)]

mod blocks;
mod cam_starts;
mod cams;
mod counters;
mod direct;
mod examples;
mod framework;
mod gears;
mod homing;
mod invariants;
mod jerk;
mod kept_apart;
mod latched;
mod refusals;
mod rig;
mod silence;
mod states;
mod steps;
mod switch;
mod tables;
mod targets;
mod zeros;
