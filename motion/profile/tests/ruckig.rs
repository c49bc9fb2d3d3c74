//! Comparison with Ruckig: the fastest motion under limited jerk.

use super::*;
use std::num::ParseFloatError;
use std::process::Command;
use std::{env, fs};

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
    let lines = cases.iter().map(|Case { from, target, end_velocity, limits }| {
        let State { position, velocity, acceleration } = from;
        let AxisLimits { velocity: most, acceleration: up, deceleration: down, jerk } = limits;
        let numbers =
            [position, velocity, acceleration, target, end_velocity, most, up, down, jerk];
        numbers.map(|number| format!("{number:?}")).join(" ") + "\n"
    });
    let file = tempfile::NamedTempFile::new().unwrap();
    fs::write(file.path(), lines.collect::<String>()).unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/ruckig_durations.py");
    let output = Command::new(python).args(["-B", script]).arg(file.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let lines = String::from_utf8(output.stdout).unwrap();
    let parse = |line: &str| line.parse().map_err(|_invalid: ParseFloatError| line.to_owned());
    Some(lines.lines().map(parse).collect())
}

/// Against Ruckig, if it is there: nowhere slower by more than 0.1 % of its time, in at least `least` cases with a motion
/// of both; it refuses fewer than `most`.
fn compare(cases: &[Case], comparable: fn(&Case, &Profile) -> bool, [least, most]: [usize; 2]) {
    let Some(theirs) = durations(cases) else { return };
    assert_eq!(theirs.len(), cases.len());
    let (mut count, mut refused, mut faster, mut worst) = (0, 0, 0, 0.0_f64);
    for (case, theirs) in cases.iter().zip(&theirs) {
        let Case { from, target, end_velocity, limits } = *case;
        let ours =
            Profile::to_position(from, target, end_velocity, limits, RampType::Parabolic).unwrap();
        let Ok(theirs) = *theirs else {
            refused += 1;
            continue;
        };
        if !comparable(case, &ours) {
            continue;
        }
        count += 1;
        let slower = (ours.duration() - theirs) / theirs.max(1e-6);
        assert!(slower < 1e-3, "ours {} s, theirs {theirs} s: {case:?}", ours.duration());
        worst = worst.max(slower);
        faster += usize::from(slower < -1e-3);
    }
    println!(
        "ruckig {VERSION}: {count} cases, {refused} refused, {faster} faster, slower by {worst}"
    );
    assert!(count >= least && refused < most, "{count} cases, {refused} refused");
}

#[test]
fn random_moves_are_as_fast() {
    compare(&cases(8, CASES, true, Case::keeps_velocity), |_, _| true, [20_000, 100]);
}

/// Where the axis never turns: Ruckig limits acceleration and deceleration in one direction.
#[test]
fn moves_with_a_deceleration_of_their_own_are_as_fast() {
    let onwards = |case: &Case| {
        case.keeps_velocity() && case.from.velocity >= 0.0 && case.end_velocity >= 0.0
    };
    let never_turns = |_: &Case, profile: &Profile| {
        sampled(profile, 200).iter().all(|(_, state)| state.velocity >= -1e-9)
    };
    compare(&cases(9, CASES, false, onwards), never_turns, [5_000, 100]);
}

/// Starts with up to three times what is allowed.
#[test]
fn moves_that_start_beyond_the_limits_are_as_fast() {
    let mut cases = cases(10, CASES, true, |_| true);
    let mut random = Random(11);
    for case in &mut cases {
        case.from.velocity *= 3.0 * random.unit();
        case.from.acceleration *= 3.0 * random.unit();
    }
    // Ruckig has no motion for the worst of them.
    compare(&cases, |_, _| true, [29_000, 300]);
}
