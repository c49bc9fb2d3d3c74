//! The worked vectors of the SoftMotion manual: language, preparation and interpolator.
//!
//! The numbers are data (`tests/data/softmotion-vectors.json`), inputs and expectations both. Every vector has one
//! test here that takes the inputs through the stages a program goes through and compares everything expected. The
//! table of tests must be the list of vectors, and a number that a test does not look at is a failure.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test that cannot be set up has failed"
)]

mod arcs;
mod curves;
mod interpolation;
mod operations;
mod preparation;
mod program;
mod vector;
mod words;

use serde_json::Value;
use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};

/// Which test exercises which vector.
const EXERCISED: [(&str, fn()); 31] = [
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
];

/// Every vector has its test, every test its vector, and each test looks at the vector it stands beside.
#[test]
fn every_vector_is_exercised() {
    let table: BTreeMap<_, _> = EXERCISED.into_iter().collect();
    assert_eq!(table.len(), EXERCISED.len(), "a vector stands in the table twice");
    let listed: Vec<_> = table.keys().copied().collect();
    let vectors = vector::all();
    let given: Vec<_> = vectors.keys().map(String::as_str).collect();
    assert_eq!(listed, given, "the table of tests and the vectors differ");
    for (id, test) in EXERCISED {
        vector::take_checked();
        test();
        assert_eq!(vector::take_checked(), [id], "the test listed for `{id}` looks at others");
    }
}

/// The vectors here are those of the digest, number for number. Skipped where the digest is not at hand.
#[test]
fn the_vectors_are_the_digests() {
    let Some(path) = digest() else {
        println!("skipped: no vectors of the digest (TWIN_SHARED, ../shared)");
        return;
    };
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path:?}: {error}"));
    let theirs = vector::parse(&text);
    let concerns = |id: &str| {
        ["cnc-", "prep-", "ipo-"].iter().any(|group| id.starts_with(group))
            || id == "x-interpolator"
    };
    let ours = vector::all();
    let ids: Vec<_> = theirs.keys().filter(|id| concerns(id)).collect();
    assert_eq!(ids, ours.keys().collect::<Vec<_>>());
    for (id, vector) in &ours {
        for part in ["inputs", "expected"] {
            let (ours, theirs) = (&vector[part], &theirs[id][part]);
            assert!(same(ours, theirs), "`{id}`: {part} are {ours}, those of the digest {theirs}");
        }
    }
}

/// Where the vectors of the digest are, if they are.
fn digest() -> Option<PathBuf> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?;
    let shared = env::var_os("TWIN_SHARED").map_or(workspace.join("../shared"), PathBuf::from);
    let path = shared.join("spec/vectors/softmotion-vectors.json");
    path.is_file().then_some(path)
}

/// The same names and numbers; 5 is 5.0.
fn same(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => a.as_f64() == b.as_f64(),
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b))
        }
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len() && a.iter().all(|(name, a)| b.get(name).is_some_and(|b| same(a, b)))
        }
        _ => a == b,
    }
}
