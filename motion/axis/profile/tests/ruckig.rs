//! Ruckig as witness: the fastest motion under limited jerk.

use super::random::{Case, Random};
use crate::axis::profile::{AxisLimits, Profile, RampType};
use std::env;
use std::fmt::Write as _;
use std::process::Command;

/// Version the test is about.
const VERSION: &str = "0.19.4";

const CASES: usize = 40_000;

/// What Ruckig says for each case; `None`, and a word about it, without it.
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
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/axis/profile/tests/ruckig_durations.py");
    let output = Command::new(python).args(["-B", script]).arg(file.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let lines = String::from_utf8(output.stdout).unwrap();
    let parse = |line: &str| line.parse().map_err(|_| line.to_owned());
    Some(lines.lines().map(parse).collect())
}

#[test]
fn the_fastest_motions_are_as_fast_as_those_of_ruckig() {
    let mut random = Random(8);
    let mut cases = Vec::new();
    while cases.len() < CASES {
        let case = Case::new(&mut random, true);
        if case.keeps_velocity() {
            cases.push(case);
        }
    }
    let Some(theirs) = durations(&cases) else { return };
    assert_eq!(theirs.len(), cases.len());
    let (mut slower, mut faster, mut refused, mut worst) = (0, 0, 0, 0.0_f64);
    for (case, theirs) in cases.iter().zip(&theirs) {
        let Case { from, target, end_velocity, limits } = *case;
        let ours =
            Profile::to_position(from, target, end_velocity, limits, RampType::Parabolic).unwrap();
        let Ok(theirs) = theirs else {
            refused += 1;
            continue;
        };
        let excess = (ours.duration() - theirs) / theirs.max(1e-6);
        worst = worst.max(excess);
        if excess > 1e-3 {
            slower += 1;
            if slower < 6 { println!("ours {} theirs {theirs}: {case:?}", ours.duration()); }
        } else if excess < -1e-6 {
            faster += 1;
            if faster < 4 { println!("FASTER ours {} theirs {theirs}: {case:?}", ours.duration()); }
        }
    }
    println!("{CASES} cases: {slower} slower by more than 0.1 %, at worst by {worst:e}; {faster} faster, {refused} refused by Ruckig");
    assert_eq!(slower, 0);
}
