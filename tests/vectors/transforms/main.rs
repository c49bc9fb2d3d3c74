//! The worked vectors of the SoftMotion manual: transforms and frames.
//!
//! The numbers are in the same file as those of motion (`tests/data/softmotion-vectors.json`), and the same rules hold:
//! the table of tests is the list of vectors, and an unused number is a failure.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test that cannot be set up has failed"
)]

mod frames;
mod gantries;
mod scaras;
#[path = "../table.rs"]
mod table;
mod tripods;
#[path = "../vector.rs"]
#[allow(dead_code, reason = "these vectors have no programs and no lists of points")]
mod vector;

use table::{Exercise, Owner};

/// Table of vectors and the tests that exercise them.
const EXERCISED: [Exercise; 18] = [
    ("trafo-gantry3", gantries::three_axes),
    ("trafo-cutter", gantries::cutter),
    ("trafov-gantry3", gantries::velocities),
    ("trafo-tool1", gantries::tool_on_one_leg),
    ("trafo-tool2", gantries::tool_on_two_legs),
    ("trafo-gantryH2", gantries::h_belt),
    ("trafo-scara2-low", scaras::two_arms_low),
    ("trafo-scara2-high", scaras::two_arms_high),
    ("trafo-scara2-unreachable", scaras::two_arms_too_short),
    ("trafo-scara3", scaras::three_arms),
    ("trafo-tripod", tripods::within_reach),
    ("trafo-tripod-unreachable", tripods::out_of_reach),
    ("trafo-rpy", frames::angles),
    ("trafo-rpy-singular", frames::angles_with_x_upright),
    ("trafo-rpy-errors", frames::no_axes_of_a_frame),
    ("trafo-coord3d", frames::coordinates),
    ("trafo-cuboid", frames::cuboid),
    ("trafo-calcdir", frames::directions),
];

#[test]
fn every_vector_is_exercised() {
    table::every_vector_is_exercised(Owner::Kinematics, &EXERCISED);
}

#[test]
fn the_vectors_are_the_digests() {
    table::the_vectors_are_the_digests(Owner::Kinematics);
}
