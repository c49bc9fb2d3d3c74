//! LinuxCNC's interpreter as peer: the same program through `rs274 -g`.

use super::contour::Dialect;
use super::pipeline::{plan, prepare};
use super::{LINES, din66025, rs274, text};
use criterion::Criterion;
use std::hint::black_box;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Number of runs, of which the fastest counts: slower ones were disturbed.
const RUNS: usize = 7;

/// Prints lines per second of decoding and planning, and of the peer, which decodes only and prints what it has found,
/// to where it costs least.
pub fn compare(_: &mut Criterion) {
    let texts = [text(Dialect::Din66025), text(Dialect::Rs274)];
    let [din, rs] = &texts;
    let folder = tempfile::tempdir().expect("a place for a program");
    let file = folder.path().join("contour.ngc");
    std::fs::write(&file, rs).expect("room for a program");
    let (mut ours, mut theirs) = ([Duration::MAX; 2], None::<Duration>);
    for _ in 0..RUNS {
        // One after the other, so that all see the same machine.
        let [of_din, of_rs] = &mut ours;
        *of_din = (*of_din).min(timed(|| plan(prepare(din66025(black_box(din))))));
        *of_rs = (*of_rs).min(timed(|| plan(prepare(rs274(black_box(rs))))));
        let peer = interpreted(&file);
        theirs = theirs.into_iter().chain(peer).min();
    }
    println!("{LINES} lines of G1, the fastest of {RUNS} runs in turn:");
    let rate = |time: Duration| f64::from(LINES) / time.as_secs_f64() / 1e6;
    for (name, time) in ["DIN 66025", "RS274"].into_iter().zip(ours) {
        let ratio = theirs.map_or_else(String::new, |theirs| {
            format!(", {:.1} times the peer", theirs.as_secs_f64() / time.as_secs_f64())
        });
        println!("  {name}, decode, prepare and plan: {:.2} million lines/s{ratio}", rate(time));
    }
    match theirs {
        Some(time) => println!("  peer, LinuxCNC's rs274 -g: {:.3} million lines/s", rate(time)),
        None => println!("  peer, LinuxCNC's rs274 -g: not installed"),
    }
}

#[expect(clippy::disallowed_methods, reason = "a benchmark is about time")]
fn timed<T>(run: impl FnOnce() -> T) -> Duration {
    let start = Instant::now();
    black_box(run());
    start.elapsed()
}

/// Time of the peer; none if it is not installed.
fn interpreted(file: &Path) -> Option<Duration> {
    let mut command = Command::new("rs274");
    command.arg("-g").arg(file).current_dir(file.parent()?);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut status = None;
    let time = timed(|| status = command.status().ok());
    assert!(status?.success(), "the peer does not run the program");
    Some(time)
}
