//! Which tappets a master passes from cycle to cycle (manual 4.4.2).
//!
//! A tappet is passed in the cycle in which the master comes to it or beyond: it acts once, then not again before the
//! master has left the band of hysteresis around it. A passage in the direction that it does not count is none. Passages come
//! in the order in which the master makes them, each with its time, interpolated between the cycles.

use super::tappet::{Action, Passage, Tappet};

/// A tappet that acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trigger {
    /// The group whose bit it acts on.
    pub group: i16,
    /// What it does.
    pub action: Action,
    /// When the master was there, ns.
    pub time_ns: i64,
}

/// A cycle, as far as tappets see it: where the master came from and went to, on the scale of the cam but not wrapped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Move {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) from_ns: i64,
    pub(crate) to_ns: i64,
}

/// Of a master that makes more passes than this in one cycle, the last ones count.
const MOST_PASSES: f64 = 16.0;

/// Watches all tappets of a cam.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Watch {
    /// The tappets and, of each that has acted, the place the master has not yet left.
    tappets: Vec<(Tappet, Option<f64>)>,
    hysteresis: f64,
    /// Width of the cam, if it is put end to end.
    width: Option<f64>,
    /// What acts in a cycle; kept for its memory.
    found: Vec<(f64, Trigger)>,
}

impl Watch {
    pub(crate) fn new(tappets: &[Tappet], hysteresis: f64, width: Option<f64>) -> Self {
        let tappets = tappets.iter().map(|tappet| (*tappet, None)).collect();
        Self { tappets, hysteresis: hysteresis.abs(), width, found: Vec::new() }
    }

    /// What acts in this cycle, in order.
    pub(crate) fn passed(&mut self, step: &Move) -> impl Iterator<Item = Trigger> + '_ {
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
            for at in places(tappet.master, self.width, &step).filter(|at| step.reaches(*at)) {
                // What has acted and not been left does not act again.
                if wanted && *held != Some(at) {
                    *held = Some(at);
                    let Tappet { group, action, .. } = *tappet;
                    let time_ns = step.time_at(at);
                    self.found.push((at, Trigger { group, action, time_ns }));
                }
            }
            if held.is_some_and(|at| (step.to - at).abs() > self.hysteresis) {
                *held = None;
            }
        }
        self.found.sort_by(|(a, _), (b, _)| if forwards { a.total_cmp(b) } else { b.total_cmp(a) });
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

/// Where tappets are looked for: ahead of the master, by the way it makes within the dead time.
///
/// That is where it will be if it goes on as it does. For one that brakes it comes nearer, but nothing is passed backwards
/// for that: it waits until the master has come up. When the master really turns, it begins again from the master: beyond
/// that nobody has been.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LookAhead {
    /// The master, and where has been looked for tappets last.
    x: f64,
    looked: f64,
    forwards: bool,
}

impl LookAhead {
    /// The master is at x of the cam with v u/s, and is looked for `dead_time_s` ahead.
    pub(crate) fn new(x: f64, v: f64, dead_time_s: f64) -> Self {
        Self { x, looked: x + v * dead_time_s, forwards: v >= 0.0 }
    }

    /// Looks on from elsewhere, without a way there.
    pub(crate) fn restart(&mut self, x: f64, v: f64, dead_time_s: f64) {
        let forwards = if v == 0.0 { self.forwards } else { v > 0.0 };
        *self = Self { forwards, ..Self::new(x, v, dead_time_s) };
    }

    /// Whether it goes forwards, or did when it moved last.
    pub(crate) fn is_forwards(&self) -> bool {
        self.forwards
    }

    /// Where has been looked last.
    pub(crate) fn looked(&self) -> f64 {
        self.looked
    }

    /// The same a cycle later; from where to where tappets are looked for in it.
    pub(crate) fn follow(&mut self, x: f64, v: f64, dead_time_s: f64) -> [f64; 2] {
        let before = std::mem::replace(&mut self.x, x);
        let way = x - before;
        // One that stands, and is to go on, has its direction by its velocity.
        let by = if way.abs() > 0.0 { way } else { v };
        let turns = (by > 0.0 && !self.forwards) || (by < 0.0 && self.forwards);
        let mut from = self.looked;
        if turns {
            self.forwards = by > 0.0;
            from = if self.forwards { from.max(before) } else { from.min(before) };
        }
        let ahead = x + v * dead_time_s;
        self.looked = if self.forwards { ahead.max(from) } else { ahead.min(from) };
        [from, self.looked]
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
    let width = width.unwrap_or(f64::INFINITY);
    // So far away that no number tells one pass from the next there is nothing to be passed.
    let next = move |pass: &f64| Some(pass + by).filter(|next| (next - pass).abs() > 0.0);
    std::iter::successors(Some(first), next)
        .map(move |pass| if pass == 0.0 { master } else { master + pass * width })
        .take_while(move |at| if forwards { *at <= to } else { *at >= to })
}
