//! Tappets that a master passes from cycle to cycle (manual 4.4.2).
//!
//! A tappet is passed in the cycle in which the master reaches it or goes beyond it. It acts once, and not again before
//! the master has left the hysteresis band around it. A passage in a direction that does not count is ignored. Passages
//! come in the order in which the master makes them, each with its time, interpolated between the cycles.
//!
//! The manual defines passages only, and gives the bit an initial value (`bInitValue`, 5.5). So a master that is on a
//! tappet when the cam begins (`MC_CamIn`) has not passed it: the tappet acts when the master reaches it again, on a
//! periodic cam at the begin of the next pass. [`Tappet::is_at`] finds them.
//!
//! On a periodic cam the end of one pass and the begin of the next are one place. A pass is over before the next one
//! begins: forwards the tappets at the end act first, backwards those at the begin.

use super::reference::Cam;
use super::tappet::{Action, Passage, Tappet};
use std::cmp::Ordering;

/// A tappet that acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trigger {
    /// The group whose bit it acts on.
    pub group: i16,
    /// Its action.
    pub action: Action,
    /// Time of the passage, ns.
    pub time_ns: i64,
}

/// A cycle, as far as tappets see it: where the master came from and went to, on the scale of the cam but not wrapped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Move {
    /// Position of the master at its beginning.
    pub(super) from: f64,
    /// Position of the master at its end.
    pub(super) to: f64,
    /// Time of its beginning, ns.
    pub(super) from_ns: i64,
    /// Time of its end, ns.
    pub(super) to_ns: i64,
}

/// Of a master that makes more passes than this in one cycle, the last ones count.
const MOST_PASSES: f64 = 16.0;

/// Watches all tappets of a cam.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Watch {
    /// The tappets and, of each that has acted, the place the master has not yet left.
    tappets: Vec<(Tappet, Option<f64>)>,
    hysteresis: f64,
    /// Width of the cam, if it is periodic.
    width: Option<f64>,
    /// Begin and end of the cam, if it is periodic: one place, whatever the width is rounded to.
    seam: Option<[f64; 2]>,
    /// What acts in a cycle, where, and whether that is the end of a pass; kept for its memory.
    found: Vec<(Stands, Trigger)>,
}

/// Place of a tappet, with the pass to which it belongs at a seam.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stands {
    at: f64,
    ends_pass: bool,
}

impl Stands {
    /// In the order of a master that goes forwards.
    fn cmp(&self, other: &Self) -> Ordering {
        self.at.total_cmp(&other.at).then_with(|| other.ends_pass.cmp(&self.ends_pass))
    }
}

impl Watch {
    /// Watches those of a cam, periodic or not, with this hysteresis.
    pub(super) fn of(cam: &Cam, hysteresis: f64, repeated: bool) -> Self {
        let tappets = cam.tappets().iter().map(|tappet| (*tappet, None)).collect();
        let [start, end] = [cam.curve().start(), cam.curve().end()];
        let (width, seam) = (repeated.then_some(end - start), repeated.then_some([start, end]));
        Self { tappets, hysteresis: hysteresis.abs(), width, seam, found: Vec::new() }
    }

    /// Tappets that act in this cycle, in order.
    pub(super) fn passed(&mut self, step: &Move) -> impl Iterator<Item = Trigger> + '_ {
        let mut step = *step;
        if let Some(width) = self.width {
            let most = MOST_PASSES * width;
            step.from = step.from.clamp(step.to - most, step.to + most);
        }
        self.found.clear();
        let forwards = step.to > step.from;
        for (tappet, held) in &mut self.tappets {
            if held.is_some_and(|at| (step.from - at).abs() > self.hysteresis) {
                *held = None;
            }
            let wanted = match tappet.passage {
                Passage::Positive => forwards,
                Passage::Negative => !forwards,
                Passage::Every => true,
            };
            let (master, ends_pass) = tappet.first_place(self.seam);
            for at in places(master, self.width, &step).filter(|at| step.reaches(*at)) {
                // What has acted and not been left does not act again.
                if wanted && *held != Some(at) {
                    *held = Some(at);
                    let Tappet { group, action, .. } = *tappet;
                    let time_ns = step.time_at(at);
                    let stands = Stands { at, ends_pass };
                    self.found.push((stands, Trigger { group, action, time_ns }));
                }
            }
            if held.is_some_and(|at| (step.to - at).abs() > self.hysteresis) {
                *held = None;
            }
        }
        self.found.sort_by(|(a, _), (b, _)| if forwards { a.cmp(b) } else { b.cmp(a) });
        self.found.iter().map(|(_, trigger)| *trigger)
    }
}

impl Move {
    fn reaches(&self, at: f64) -> bool {
        if self.to > self.from {
            self.from < at && at <= self.to
        } else {
            self.to <= at && at < self.from
        }
    }

    fn time_at(&self, at: f64) -> i64 {
        let share = (at - self.from) / (self.to - self.from);
        #[expect(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            reason = "a share of a cycle"
        )]
        let after = (share * self.to_ns.saturating_sub(self.from_ns) as f64).round() as i64;
        self.from_ns.saturating_add(after)
    }
}

/// Direction of a master.
///
/// It turns where it has gone back by more than a slack from the farthest point of the way before: less is the jitter of
/// an axis that is held there.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Heading {
    forwards: bool,
    farthest: f64,
}

impl Heading {
    /// The master is at x with v u/s; where it has turned, if it has.
    fn follow(&mut self, x: f64, v: f64, slack: f64) -> Option<f64> {
        let back = if self.forwards { self.farthest - x } else { x - self.farthest };
        let goes_back = if self.forwards { v < 0.0 } else { v > 0.0 };
        // One at rest that is to go on has its direction by its velocity.
        let turns = back > slack || (slack == 0.0 && back == 0.0 && goes_back);
        let before = self.farthest;
        if turns {
            self.forwards = !self.forwards;
        }
        if turns || back < 0.0 {
            self.farthest = x;
        }
        turns.then_some(before)
    }
}

/// Look-ahead position of tappets: ahead of the master by its distance within the dead time.
///
/// That is where it will be if it goes on as it does. For one that brakes it comes nearer, but nothing is passed backwards
/// for that: it waits until the master has come up. When the master really turns, by more than the hysteresis, it begins
/// again from where it has turned: beyond that it has not been. Without a dead time there is nothing to take back, and it
/// is where the master is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LookAhead {
    heading: Heading,
    /// Where has been looked for tappets last.
    looked: f64,
}

/// Dead time of the look-ahead, and the hysteresis of a reversal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lead {
    /// Dead time of the output, s.
    pub(super) dead_time_s: f64,
    /// In the unit of the place.
    pub(super) hysteresis: f64,
}

impl LookAhead {
    /// The master is at x of the cam with v u/s, and is looked for `dead_time_s` ahead.
    pub(super) fn new(x: f64, v: f64, dead_time_s: f64) -> Self {
        let heading = Heading { forwards: v >= 0.0, farthest: x };
        Self { heading, looked: x + v * dead_time_s }
    }

    /// Last look-ahead position.
    pub(super) fn looked(&self) -> f64 {
        self.looked
    }

    /// The same a cycle later; from where to where tappets are looked for in it.
    pub(super) fn follow(&mut self, x: f64, v: f64, by: Lead) -> [f64; 2] {
        let slack = if by.dead_time_s == 0.0 { 0.0 } else { by.hysteresis.abs() };
        let mut from = self.looked;
        let turned = self.heading.follow(x, v, slack);
        let forwards = self.heading.forwards;
        if let Some(farthest) = turned {
            from = if forwards { from.max(farthest) } else { from.min(farthest) };
        }
        let ahead = x + v * by.dead_time_s;
        self.looked = if forwards { ahead.max(from) } else { ahead.min(from) };
        [from, self.looked]
    }
}

impl Tappet {
    /// Whether it is at x of a cam, periodic if begin and end are given.
    #[expect(
        clippy::float_cmp,
        reason = "a place that is reached to the last digit, as in every cycle"
    )]
    pub(super) fn is_at(&self, x: f64, seam: Option<[f64; 2]>) -> bool {
        let width = seam.map(|[start, end]| end - start);
        let (master, _) = self.first_place(seam);
        let pass = width.map_or(0.0, |width| ((x - master) / width).round());
        place(master, pass, width) == x
    }

    /// A place from which all others are whole passes apart, and whether it ends a pass: at the end of a cam that is put end to
    /// end it is that of the begin, so that both are the same to the last digit.
    #[expect(clippy::float_cmp, reason = "the end of the cam is exact")]
    fn first_place(&self, seam: Option<[f64; 2]>) -> (f64, bool) {
        match seam {
            Some([start, end]) if self.master == end => (start, true),
            _ => (self.master, false),
        }
    }
}

/// Place of a tappet in a pass of a cam.
fn place(master: f64, pass: f64, width: Option<f64>) -> f64 {
    match width {
        Some(width) if pass != 0.0 => master + pass * width,
        _ => master,
    }
}

/// The places of a tappet in all passes of a cam that a master may come to, in its order.
fn places(master: f64, width: Option<f64>, step: &Move) -> impl Iterator<Item = f64> {
    let forwards = step.to > step.from;
    let (to, pass) = match width {
        None => (step.to, 0.0),
        Some(width) => (step.to, (step.from - master) / width),
    };
    // One pass more: the quotient may have been rounded over the tappet.
    let (first, by) = if forwards { (pass.floor(), 1.0) } else { (pass.ceil(), -1.0) };
    // A cam that is passed once has one place. So far away that no number tells one pass from the next there is nothing to be
    // passed.
    let goes_on = move |pass: &f64, next: &f64| width.is_some() && (next - pass).abs() > 0.0;
    let next = move |pass: &f64| Some(pass + by).filter(|next| goes_on(pass, next));
    std::iter::successors(Some(first), next)
        .map(move |pass| place(master, pass, width))
        .take_while(move |at| if forwards { *at <= to } else { *at >= to })
}
