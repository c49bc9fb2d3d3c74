//! Trip point of a probing move (RS274: G38.2 to G38.5) by the clearances along it.
//!
//! Check, run, limit, path and view read programs with the same surroundings ([`crate::ProgramConditions::rs274`]).

use std::fmt;
use twin_gcode::rs274::{Position, ProbePath, ProbeTarget};
use twin_path::ProbeTrip;

/// Nearer than this is touching, m: the rounding of distances.
pub const TOUCH: f64 = 1e-8;

/// Farther than this is free again, m: more than [`TOUCH`], so that rounding does not release.
pub const RELEASE: f64 = 1e-6;

/// Accuracy of the trip position along the move, m.
const PLACE: f64 = 1e-9;

/// Smallest thickness that is found for sure, m.
const SHORTEST_STEP: f64 = 1e-5;

/// Longest step along a move, m: distances may shrink faster than the tool moves.
const LONGEST_STEP: f64 = 1e-3;

/// Most steps along a move.
const MOST_STEPS: f64 = 1e6;

/// Distance of a machine from the surfaces that its probe can touch.
pub trait Clearance: fmt::Debug {
    /// Distance (m; 0 or less: touching) with the point at `at`, in the frame of the path, on the way along `path`.
    /// None at unreachable positions.
    fn at(&mut self, at: &Position, path: &ProbePath) -> Option<f64>;
}

/// Trip position of a probing move, from the distances along it.
///
/// Steps are half the remaining distance, at least ten micrometres; the step that trips is bisected. The search
/// ends where the machine cannot go: axis motion reports that.
#[derive(Debug)]
pub struct TripSearch<C> {
    clearance: C,
}

impl<C: Clearance> TripSearch<C> {
    /// A search with distances from `clearance`.
    pub fn new(clearance: C) -> Self {
        Self { clearance }
    }
}

impl<C: Clearance> ProbeTarget for TripSearch<C> {
    fn trip(&mut self, path: &ProbePath) -> Option<f64> {
        let tripped = |distance: f64| match path.trips {
            ProbeTrip::Touch => distance <= TOUCH,
            ProbeTrip::Release => distance > RELEASE,
        };
        let mut distance = self.clearance.at(&between(path, 0.0), path)?;
        if tripped(distance) {
            return Some(0.0);
        }
        let length = length(path);
        if length <= 0.0 {
            return None;
        }
        let shortest = SHORTEST_STEP.max(length / MOST_STEPS);
        let mut before = 0.0;
        while before < 1.0 {
            let step = match path.trips {
                ProbeTrip::Touch => (0.5 * distance).clamp(shortest, LONGEST_STEP.max(shortest)),
                // What touches says nothing of how far it is from being free.
                ProbeTrip::Release => shortest,
            };
            let mut behind = (before + step / length).min(1.0);
            distance = self.clearance.at(&between(path, behind), path)?;
            if !tripped(distance) {
                before = behind;
                continue;
            }
            while (behind - before) * length > PLACE {
                let middle = before.midpoint(behind);
                if middle <= before || middle >= behind {
                    break;
                }
                if tripped(self.clearance.at(&between(path, middle), path)?) {
                    behind = middle;
                } else {
                    before = middle;
                }
            }
            return Some(behind);
        }
        None
    }
}

/// Length of a move, m: the longest of those in X Y Z, in U V W and, a millimetre a degree, in A B C.
fn length(path: &ProbePath) -> f64 {
    let norm = |from: [f64; 3], to: [f64; 3]| {
        from.iter().zip(to).map(|(from, to)| (to - from).powi(2)).sum::<f64>().sqrt()
    };
    let linear = norm(path.start.linear, path.end.linear);
    let parallel = norm(path.start.parallel, path.end.parallel);
    linear.max(parallel).max(norm(path.start.rotary, path.end.rotary) * 1e-3)
}

/// Axis positions at `part` of a move.
fn between(path: &ProbePath, part: f64) -> Position {
    let of = |from: [f64; 3], to: [f64; 3]| {
        let mut at = from;
        for (at, to) in at.iter_mut().zip(to) {
            *at += (to - *at) * part;
        }
        at
    };
    let linear = of(path.start.linear, path.end.linear);
    let rotary = of(path.start.rotary, path.end.rotary);
    Position { linear, rotary, parallel: of(path.start.parallel, path.end.parallel) }
}
