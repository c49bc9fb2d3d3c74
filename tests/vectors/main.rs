//! The worked vectors of the SoftMotion manual: language, preparation, interpolator, cams and axes.
//!
//! The numbers are data (`tests/data/softmotion-vectors.json`), inputs and expectations both. Every vector has one test
//! here that takes the inputs through the stages a program goes through and compares everything expected. The table of
//! tests must be the list of vectors, and an unused number is a failure.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test that cannot be set up has failed"
)]

mod arcs;
mod axis;
mod blocks;
mod cams;
mod curves;
mod interpolation;
mod operations;
mod preparation;
mod program;
mod table;
mod vector;
mod words;

use table::{Exercise, Owner};

/// Table of vectors and the tests that exercise them.
const EXERCISED: [Exercise; 47] = [
    ("cnc-arc-R-semicircle", arcs::by_radius_semicircle),
    ("cnc-arc-IJ-same", arcs::by_center),
    ("cnc-arc-R-minor", arcs::by_radius_minor),
    ("cnc-arc-full", arcs::full_circle),
    ("cnc-arc-fallback", arcs::mismatched_center),
    ("cnc-helix", arcs::helix),
    ("cnc-arc-major", arcs::three_quarters),
    ("cnc-ellipse-G8", curves::ellipse_clockwise),
    ("cnc-ellipse-G9", curves::ellipse_counter_clockwise),
    ("cnc-parabola", curves::parabola),
    ("cnc-spline-stairs", curves::spline_over_stairs),
    ("cnc-spline-between-lines", curves::spline_between_lines),
    ("cnc-switch-points", words::switch_points),
    ("cnc-two-switches", words::two_switches),
    ("cnc-S-profile", words::s_profile),
    ("cnc-loop", words::loop_on_the_implicit_variable),
    ("cnc-g91-g92", words::relative_targets_and_set_positions),
    ("cnc-split", operations::split),
    ("cnc-reverse-arc", operations::reversed_arc),
    ("cnc-rotate-queue", operations::turned_and_scaled),
    ("cnc-transition", preparation::transition),
    ("prep-toolcorr-inner", preparation::inner_corner),
    ("prep-toolcorr-outer", preparation::outer_corner),
    ("prep-round-60", preparation::rounded_corner),
    ("prep-smooth-90", preparation::smoothed_corner),
    ("prep-avoidloop", preparation::avoided_loop),
    ("prep-limitcirc", preparation::circular_limits),
    ("ipo-trapezoid", interpolation::trapezoid),
    ("ipo-sigmoid", interpolation::sigmoid),
    ("ipo-triangle", interpolation::triangle),
    ("x-interpolator", interpolation::by_position),
    ("cam-rest-rest", cams::rest_to_rest),
    ("cam-general", cams::general),
    ("cam-line", cams::line),
    ("cam-table-equi", cams::equidistant_table),
    ("cam-table-scaling", cams::table_scaling),
    ("cam-bounds", cams::bounds),
    ("cam-camin-scaling", cams::scaling),
    ("cam-periodic-offsets", cams::periodic_offsets),
    ("cam-register-deadtime", cams::dead_time),
    ("axis-ramps", axis::ramps),
    ("axis-position-profile", axis::position_profile),
    ("axis-acceleration-profile", axis::acceleration_profile),
    ("axis-direction", blocks::direction),
    ("axis-units", blocks::conversions),
    ("gear-in-pos", blocks::gear_in_position),
    ("diag-tracking", blocks::tracking_error),
];

#[test]
fn every_vector_is_exercised() {
    table::every_vector_is_exercised(Owner::Motion, &EXERCISED);
}

#[test]
fn the_vectors_are_the_digests() {
    table::the_vectors_are_the_digests(Owner::Motion);
}
