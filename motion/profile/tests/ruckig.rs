//! Comparison with Ruckig: the fastest motion under limited jerk.

use super::random::{Case, Random};
use super::sampled;
use crate::{AxisLimits, Profile, RampType};
use std::env;
use std::fmt::Write as _;
use std::num::ParseFloatError;
use std::process::Command;

/// Version the test is about.
const VERSION: &str = "0.19.4";

const CASES: usize = 30_000;

/// Ruckig's answer for each case; `None`, with a message, if it is not installed.
fn durations(cases: &[Case]) -> Option<Vec<Result<f64, String>>> {
    let Some(python) = env::var_os("TWIN_RUCKIG_PYTHON").filter(|python| !python.is_empty()) else {
        println!("no ruckig {VERSION} here (TWIN_RUCKIG_PYTHON): not witnessed");
        return None;
    };
    let asked = Command::new(&python)
        .args(["-c", "import ruckig; print(ruckig.__version__)"])
        .output()
        .expect("TWIN_RUCKIG_PYTHON runs");
    let found = String::from_utf8_lossy(&asked.stdout);
    assert_eq!(found.trim(), VERSION, "TWIN_RUCKIG_PYTHON has another ruckig");
    let mut text = String::new();
    for Case { from, target, end_velocity, limits } in cases {
        let AxisLimits { velocity, acceleration, deceleration, jerk } = limits;
        writeln!(
            text,
            "{:?} {:?} {:?} {target:?} {end_velocity:?} {velocity:?} {acceleration:?} {deceleration:?} {jerk:?}",
            from.position, from.velocity, from.acceleration
        )
        .unwrap();
    }
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), text).unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/ruckig_durations.py");
    let output = Command::new(python).args(["-B", script]).arg(file.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let lines = String::from_utf8(output.stdout).unwrap();
    let parse = |line: &str| line.parse().map_err(|_invalid: ParseFloatError| line.to_owned());
    Some(lines.lines().map(parse).collect())
}

/// Comparison of our times with theirs.
#[derive(Debug, Default)]
struct Comparison {
    /// Where both have a motion.
    count: usize,
    /// Cases that Ruckig does not plan.
    refused: usize,
    /// Cases in which we are faster by more than 0.1 %.
    faster: usize,
    /// By how much we are slower at worst, as part of their time.
    worst: f64,
}

/// Against Ruckig; `None` without it. Panics with the case where we are slower by more than 0.1 %.
fn compare(cases: &[Case], comparable: impl Fn(&Case, &Profile) -> bool) -> Option<Comparison> {
    let theirs = durations(cases)?;
    assert_eq!(theirs.len(), cases.len());
    let mut comparison = Comparison::default();
    for (case, theirs) in cases.iter().zip(&theirs) {
        let Case { from, target, end_velocity, limits } = *case;
        let ours =
            Profile::to_position(from, target, end_velocity, limits, RampType::Parabolic).unwrap();
        let Ok(theirs) = *theirs else {
            comparison.refused += 1;
            continue;
        };
        if !comparable(case, &ours) {
            continue;
        }
        comparison.count += 1;
        let slower = (ours.duration() - theirs) / theirs.max(1e-6);
        assert!(slower < 1e-3, "ours {} s, theirs {theirs} s: {case:?}", ours.duration());
        comparison.worst = comparison.worst.max(slower);
        comparison.faster += usize::from(slower < -1e-3);
    }
    println!("against ruckig {VERSION}: {comparison:?}");
    Some(comparison)
}

fn cases(seed: u64, equal: bool, wanted: impl Fn(&Case) -> bool) -> Vec<Case> {
    let mut random = Random(seed);
    let mut cases = Vec::new();
    while cases.len() < CASES {
        let case = Case::new(&mut random, equal);
        if wanted(&case) {
            cases.push(case);
        }
    }
    cases
}

#[test]
fn random_moves_are_as_fast() {
    let cases = cases(8, true, Case::keeps_velocity);
    if let Some(comparison) = compare(&cases, |_, _| true) {
        assert!(comparison.count >= 20_000 && comparison.refused < 100, "{comparison:?}");
    }
}

/// Where the axis never turns, growth and fall of its speed are acceleration and deceleration in one direction, which
/// is what Ruckig limits.
#[test]
fn moves_with_a_deceleration_of_their_own_are_as_fast() {
    let onwards = |case: &Case| {
        case.keeps_velocity() && case.from.velocity >= 0.0 && case.end_velocity >= 0.0
    };
    let never_turns = |_: &Case, profile: &Profile| {
        sampled(profile, 200).iter().all(|(_, state)| state.velocity >= -1e-9)
    };
    if let Some(comparison) = compare(&cases(9, false, onwards), never_turns) {
        assert!(comparison.count >= 5_000 && comparison.refused < 100, "{comparison:?}");
    }
}

/// Starts with up to three times what is allowed.
#[test]
fn moves_that_start_beyond_the_limits_are_as_fast() {
    let mut cases = cases(10, true, |_| true);
    let mut random = Random(11);
    for case in &mut cases {
        case.from.velocity *= 3.0 * random.unit();
        case.from.acceleration *= 3.0 * random.unit();
    }
    if let Some(comparison) = compare(&cases, |_, _| true) {
        // Ruckig has no motion for the worst of them.
        assert!(comparison.count >= 29_000 && comparison.refused < 300, "{comparison:?}");
    }
}
