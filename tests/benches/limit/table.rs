//! Times and durations, side by side.

use crate::ours::METHODS;
use crate::path::{Path, as_float};
use crate::peer::{Answer, Peer};
use std::time::{Duration, Instant};

/// Runs in turn for each method, of which the median counts: short ones more often.
fn runs(cells: usize) -> usize {
    if cells <= 1_000 { 9 } else { 3 }
}

/// One path.
pub struct Row {
    name: String,
    cells: usize,
    peer: Option<Measured>,
    /// As [`METHODS`].
    ours: Vec<Measured>,
}

/// One planner on it.
#[derive(Clone, Copy)]
struct Measured {
    /// s, if it finds a profile.
    duration: Option<f64>,
    /// Cells per second.
    rate: f64,
}

impl Row {
    /// Every planner in turn, so that all see the same machine.
    pub fn measured(name: String, path: &Path, mut peer: Option<&mut Peer>) -> Self {
        let mut ours = vec![(None, Vec::new()); METHODS.len()];
        let mut theirs: Vec<Answer> = Vec::new();
        for run in 0..runs(path.cells()) {
            if let Some(peer) = peer.as_deref_mut() {
                theirs.push(if run == 0 { peer.take(path) } else { peer.again() });
            }
            for (method, (duration, times)) in METHODS.iter().zip(&mut ours) {
                times.push(timed(|| *duration = (method.duration)(path)).as_secs_f64());
            }
        }
        let rate = |times: Vec<f64>| as_float(path.cells()) / median(times);
        let peer = theirs.first().map(|answer| Measured {
            duration: answer.duration,
            rate: rate(theirs.iter().map(|answer| answer.construct + answer.solve).collect()),
        });
        let ours =
            ours.into_iter().map(|(duration, times)| Measured { duration, rate: rate(times) });
        Self { name, cells: path.cells(), peer, ours: ours.collect() }
    }

    pub fn print(&self) {
        let mut line = format!("{:20}{:>7}", self.name, self.cells);
        line += &match self.peer {
            Some(Measured { duration, rate }) => {
                format!("{}{:>9}", seconds(duration), thousands(rate))
            }
            None => format!("{:>10}{:>9}", "", ""),
        };
        for (method, ours) in METHODS.iter().zip(&self.ours) {
            // With limited jerk the duration is another one.
            let shorter = self.peer.filter(|_| !method.jerk).and_then(|peer| peer.duration);
            let beside = match (ours.duration, shorter) {
                (Some(ours), Some(theirs)) => format!("{:>+10.1e}", ours / theirs - 1.0),
                (duration, _) => seconds(duration),
            };
            let ratio = self.peer.map_or(f64::NAN, |peer| ours.rate / peer.rate);
            line += &format!(" |{beside}{:>8}{ratio:>7.1}", thousands(ours.rate));
        }
        println!("{line}");
    }
}

/// What the columns are.
pub fn head() {
    let mut top = format!("{:27}{:^19}", "", "toppra");
    let mut line = format!("{:20}{:>7}{:>10}{:>9}", "path", "cells", "s", "kpoint/s");
    for method in METHODS {
        top += &format!(" |{:^25}", method.name);
        let duration = if method.jerk { "s" } else { "duration" };
        line += &format!(" |{duration:>10}{:>8}{:>7}", "kpt/s", "ratio");
    }
    println!(
        "Velocity and acceleration limits at both ends of every cell; ratios are to toppra's points per second."
    );
    println!("{top}\n{line}");
}

/// The worst of every column, and what windows lose.
pub fn summary(rows: &[Row]) {
    for (index, method) in METHODS.iter().enumerate() {
        let pairs = rows.iter().filter_map(|row| Some((row.ours.get(index)?, row.peer.as_ref()?)));
        let (mut ratio, mut longer) = (f64::INFINITY, f64::NEG_INFINITY);
        for (ours, theirs) in pairs {
            ratio = ratio.min(ours.rate / theirs.rate);
            if let (Some(ours), Some(theirs), false) = (ours.duration, theirs.duration, method.jerk)
            {
                longer = longer.max(ours / theirs - 1.0);
            }
        }
        let failed = rows.iter().filter(|row| row.ours[index].duration.is_none()).count();
        let mut line =
            format!("{}: at least {ratio:.1} times toppra's points per second", method.name);
        if longer.is_finite() {
            line += &format!(", duration at most {longer:+.1e} against it");
        }
        println!("{line}, {failed} paths without a profile");
        if let Some(whole) =
            method.whole.and_then(|name| METHODS.iter().position(|m| m.name == name))
        {
            let losses = rows.iter().filter_map(|row| {
                Some(row.ours[index].duration? / row.ours[whole].duration? - 1.0)
            });
            let loss = losses.fold(f64::NEG_INFINITY, f64::max);
            println!("  windows lose at most {loss:.1e} against one over the whole path");
        }
    }
    let theirs = rows.iter().filter_map(|row| row.peer);
    let failed = theirs.filter(|peer| peer.duration.is_none()).count();
    println!("toppra: {failed} paths without a profile");
}

fn seconds(duration: Option<f64>) -> String {
    duration.map_or_else(|| format!("{:>10}", "none"), |duration| format!("{duration:>10.5}"))
}

fn thousands(rate: f64) -> String {
    format!("{:.1}", rate * 1e-3)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[expect(clippy::disallowed_methods, reason = "a benchmark is about time")]
fn timed<T>(run: impl FnOnce() -> T) -> Duration {
    let start = Instant::now();
    std::hint::black_box(run());
    start.elapsed()
}
