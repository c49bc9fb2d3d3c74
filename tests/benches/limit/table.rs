//! Result table: computing times and durations of all planners side by side.

use crate::ours::{Found, METHODS, Problem};
use crate::path::as_float;
use crate::peer::{Answer, Peer};
use std::time::{Duration, Instant};

/// Runs in turn for each method, of which the fastest counts (what is slower has been disturbed): short ones more often.
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
    /// With limited jerk, s.
    least: Option<f64>,
}

/// One planner on it.
#[derive(Clone, Copy)]
struct Measured {
    /// s, if it finds a profile.
    duration: Option<f64>,
    /// Cells per second.
    rate: f64,
    /// Windows without an answer.
    failed: u64,
}

impl Row {
    /// Every planner in turn (the least time with limited jerk is given), so that all see the same machine.
    pub fn measured(
        name: String,
        problem: &Problem<'_>,
        least: Option<f64>,
        mut peer: Option<&mut Peer>,
    ) -> Self {
        let cells = problem.path.cells();
        let mut ours: Vec<(Option<Found>, Duration)> = vec![(None, Duration::MAX); METHODS.len()];
        let mut theirs: Option<(Answer, f64)> = None;
        for run in 0..runs(cells) {
            if let Some(peer) = peer.as_deref_mut() {
                let answer = if run == 0 { peer.take(problem.path) } else { peer.again() };
                let time = answer.construct + answer.solve;
                let best = theirs.map_or(time, |(_, best)| best.min(time));
                theirs = Some((answer, best));
            }
            for (method, (found, best)) in METHODS.iter().zip(&mut ours) {
                *best = (*best).min(timed(|| *found = (method.run)(problem)));
            }
        }
        let peer = theirs.map(|(answer, time)| Measured {
            duration: answer.duration,
            rate: as_float(cells) / time,
            failed: 0,
        });
        let ours = ours.into_iter().map(|(found, time)| Measured {
            duration: found.map(|found| found.duration),
            rate: found.map_or(f64::NAN, |found| as_float(found.cells) / time.as_secs_f64()),
            failed: found.map_or(0, |found| found.failed),
        });
        Self { name, cells, peer, ours: ours.collect(), least }
    }

    pub fn print(&self) {
        let mut line = format!("{:20}{:>7}", self.name, self.cells);
        line += &match self.peer {
            Some(Measured { duration, rate, .. }) => {
                format!("{}{:>9}", seconds(duration), thousands(rate))
            }
            None => format!("{:>10}{:>9}", "", ""),
        };
        for (method, ours) in METHODS.iter().zip(&self.ours) {
            let theirs = self.peer.and_then(|peer| peer.duration).filter(|_| method.same);
            let beside = match (ours.duration, theirs) {
                (Some(ours), Some(theirs)) => format!("{:>+10.1e}", ours / theirs - 1.0),
                (duration, _) => seconds(duration),
            };
            let ratio = self.peer.map_or(f64::NAN, |peer| ours.rate / peer.rate);
            line += &format!(" |{beside}{:>8}{ratio:>7.1}", thousands(ours.rate));
        }
        println!("{line}");
    }
}

/// Prints the head of the table.
pub fn head() {
    let mut top = format!("{:27}{:^19}", "", "toppra");
    let mut line = format!("{:20}{:>7}{:>10}{:>9}", "path", "cells", "s", "kpoint/s");
    for method in METHODS {
        top += &format!(" |{:^25}", method.name);
        let duration = if method.same { "longer" } else { "s" };
        line += &format!(" |{duration:>10}{:>8}{:>7}", "kpt/s", "ratio");
    }
    println!(
        "Velocity and acceleration limits at both ends of every cell; ratios are to toppra's points per second.\n\
         {top}\n{line}"
    );
}

/// The worst of every column.
pub fn summary(rows: &[Row]) {
    for (index, method) in METHODS.iter().enumerate() {
        let pairs = rows.iter().filter_map(|row| Some((row.ours.get(index)?, row.peer.as_ref()?)));
        let (mut ratios, mut longer) = (Vec::new(), f64::NEG_INFINITY);
        for (ours, theirs) in pairs {
            ratios.extend(Some(ours.rate / theirs.rate).filter(|ratio| ratio.is_finite()));
            if let (Some(ours), Some(theirs), true) = (ours.duration, theirs.duration, method.same)
            {
                longer = longer.max(ours / theirs - 1.0);
            }
        }
        ratios.sort_by(f64::total_cmp);
        let mut line = format!("{}:", method.name);
        if let [least, .., most] = ratios.as_slice() {
            let middle = ratios[ratios.len() / 2];
            line += &format!(
                " {least:.1} to {most:.1} times toppra's points per second, {middle:.1} in the middle;"
            );
        }
        if longer.is_finite() {
            line += &format!(" duration at most {longer:+.1e} against it;");
        }
        let none = rows.iter().filter(|row| row.ours[index].duration.is_none()).count();
        let failed: u64 = rows.iter().map(|row| row.ours[index].failed).sum();
        println!("{line} {none} paths without a profile, {failed} failed windows");
        if method.jerk {
            let losses =
                rows.iter().filter_map(|row| Some(row.ours[index].duration? / row.least? - 1.0));
            let loss = losses.fold(f64::NEG_INFINITY, f64::max);
            println!(
                "  at most {loss:.1e} longer than on grids four times as fine, each in one window"
            );
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

#[expect(clippy::disallowed_methods, reason = "a benchmark is about time")]
fn timed<T>(run: impl FnOnce() -> T) -> Duration {
    let start = Instant::now();
    std::hint::black_box(run());
    start.elapsed()
}
