//! Ruckig as peer: the same moves, planned by its C++ library.

use super::{MOVES, Move, moves};
use crate::python::Package;
use criterion::Criterion;
use std::env;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};
use twin_profile::RampType;

const RUCKIG: Package =
    Package { name: "ruckig", requirement: "ruckig==0.19.4", variable: "TWIN_RUCKIG_PYTHON" };

/// Number of runs, of which the fastest counts: slower ones were disturbed.
const RUNS: usize = 7;
/// Passes over the table per run of ours; the peer does as many.
const PASSES: usize = 30;

/// Prints the time per move of both and their ratio.
pub fn compare(_: &mut Criterion) {
    if !env::args().any(|argument| argument == "--bench") {
        return; // cargo only tests that the benchmark can be run
    }
    let folder = tempfile::tempdir().expect("a place for moves");
    for (what, moving) in [("from rest to rest", false), ("from any state of motion", true)] {
        let moves = moves(moving);
        let file = folder.path().join("moves");
        fs::write(&file, table(&moves)).expect("room for moves");
        let (mut ours, mut theirs) = (f64::INFINITY, f64::INFINITY);
        let mut sums = [0.0, 0.0];
        for _ in 0..RUNS {
            let [our_sum, their_sum] = &mut sums;
            ours = ours.min(timed(&moves, our_sum));
            let Some((time, sum)) = asked(&folder.path().join("program"), &file) else {
                println!("peer, ruckig: not to be had, ours {ours:.0} ns per move {what}");
                return;
            };
            theirs = theirs.min(time);
            *their_sum = sum;
        }
        let [our_sum, their_sum] = sums;
        println!(
            "{what}: ours {ours:.0} ns per move, ruckig {theirs:.0} ns, {:.2} times as fast; the moves take {our_sum:.3} s \
             and {their_sum:.3} s",
            theirs / ours
        );
    }
}

/// A move per line.
fn table(moves: &[Move]) -> String {
    let mut text = String::new();
    for Move { from, target, end_velocity, limits } in moves {
        let start = [from.position, from.velocity, from.acceleration, *target, *end_velocity];
        let most = [limits.velocity, limits.acceleration, limits.deceleration, limits.jerk];
        for number in start.into_iter().chain(most) {
            write!(text, "{number:?} ").expect("memory");
        }
        text.push('\n');
    }
    text
}

/// ns per move of the fastest pass of ours, and the sum of the durations.
#[expect(clippy::disallowed_methods, reason = "a benchmark is about time")]
fn timed(moves: &[Move], sum: &mut f64) -> f64 {
    let mut least = Duration::MAX;
    for _ in 0..PASSES {
        let start = Instant::now();
        *sum = moves.iter().map(|one| one.duration(RampType::Parabolic)).sum();
        least = least.min(start.elapsed());
    }
    least.as_secs_f64() * 1e9 / f64::from(u32::try_from(MOVES).expect("a small table"))
}

/// The same of the peer; none, with a line that says why, where it is not to be had.
fn asked(program: &Path, file: &Path) -> Option<(f64, f64)> {
    let mut command = RUCKIG.script("ruckig_moves.py")?;
    command.arg(program).arg(file).stdin(Stdio::null());
    let output = command.output().expect("the peer starts");
    if !output.status.success() {
        println!("peer, ruckig: {}", String::from_utf8_lossy(&output.stderr));
        return None;
    }
    let answer = String::from_utf8_lossy(&output.stdout).into_owned();
    let mut numbers = answer.split_whitespace().map(str::parse);
    Some((numbers.next()?.ok()?, numbers.next()?.ok()?))
}
