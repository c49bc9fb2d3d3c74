//! A switch of `MC_DigitalCamSwitch` in time: what is advanced is looked for ahead of the axis, what is delayed waits.
//!
//! ```text
//! position ── ahead by an advance ─▶ on from its begin to its end ── later by a delay ─▶ output
//! ```

use super::switch::{CamSwitch, SwitchDirection, Track};
use crate::cam::passage::{Heading, Lead, LookAhead, Move, Watch};
use crate::cam::{Action, MAX_PULSES, Passage, Tappet, TappetBit};

/// The axis in a cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ahead {
    /// Unwound, u.
    pub(super) position: f64,
    /// u/s.
    pub(super) velocity: f64,
    pub(super) period: Option<f64>,
    /// Whether it went forwards when it moved last.
    pub(super) went_forwards: bool,
    /// Whether nothing is known of where it was before.
    pub(super) begins: bool,
    pub(super) from_ns: i64,
    pub(super) now_ns: i64,
}

/// A switch and how it stands.
#[derive(Clone, Debug)]
pub(super) struct Switched {
    switch: CamSwitch,
    /// Which way the axis goes, and where it is looked for for switching on and off.
    seen: Option<(Heading, [LookAhead; 2])>,
    /// Of one by position: whether the axis is on it, delays aside, and when that shows.
    inside: bool,
    spans: Vec<Span>,
    /// Of one by time.
    watch: Option<Watch>,
    bit: TappetBit,
}

/// From when to when an output is on, ns.
#[derive(Clone, Copy, Debug)]
struct Span {
    on_ns: i64,
    off_ns: Option<i64>,
}

impl Switched {
    pub(super) fn new(switch: CamSwitch) -> Self {
        let bit = TappetBit::default();
        Self { switch, seen: None, inside: false, spans: Vec::new(), watch: None, bit }
    }

    pub(super) fn track(&self) -> u8 {
        self.switch.track
    }

    /// Off, with nothing to come.
    pub(super) fn disable(&mut self) {
        *self = Self::new(self.switch);
    }

    /// A cycle; whether it is on.
    pub(super) fn advance(&mut self, at: &Ahead, track: &Track) -> bool {
        let Ahead { position, velocity, begins, .. } = *at;
        let advances =
            [track.on_compensation, track.off_compensation].map(|later| (-later).max(0.0));
        let hysteresis = track.hysteresis.abs();
        let went_forwards = self.seen.map_or(at.went_forwards, |(it, _)| it.is_forwards());
        let new = || {
            let forwards = if velocity == 0.0 { went_forwards } else { velocity > 0.0 };
            let heading = Heading::new(position, forwards);
            (heading, advances.map(|advance| LookAhead::along(heading, velocity, advance)))
        };
        let known = self.seen.filter(|_| !begins);
        let (mut heading, [mut on, mut off]) = known.unwrap_or_else(new);
        heading.follow(position, velocity, hysteresis);
        let [by_on, by_off] = advances.map(|dead_time_s| Lead { dead_time_s, hysteresis });
        let way = on.follow(position, velocity, by_on);
        off.follow(position, velocity, by_off);
        self.seen = Some((heading, [on, off]));
        match self.switch.duration {
            None => {
                self.by_position(heading.is_forwards(), [on, off].map(|it| it.looked()), at, track)
            }
            Some(duration) => self.by_time(way, duration, at, track),
        }
    }

    fn by_position(&mut self, forward: bool, looks: [f64; 2], at: &Ahead, track: &Track) -> bool {
        let inside = self.counts(forward) && self.is_inside(forward, looks, at.period, track);
        let [on_later, off_later] =
            [track.on_compensation, track.off_compensation].map(|later| ns(later.max(0.0)));
        if at.begins {
            // Nothing has been passed: what is on here is, whatever would have come.
            self.spans.clear();
            if inside {
                self.spans.push(Span { on_ns: at.now_ns, off_ns: None });
            }
        } else if inside && !self.inside {
            if self.spans.len() < MAX_PULSES {
                let on_ns = at.now_ns.saturating_add(on_later);
                self.spans.push(Span { on_ns, off_ns: None });
            }
        } else if self.inside
            && !inside
            && let Some(span) = self.spans.last_mut()
        {
            span.off_ns.get_or_insert(at.now_ns.saturating_add(off_later));
        }
        self.inside = inside;
        self.spans.retain(|span| span.off_ns.is_none_or(|off| off > at.now_ns));
        self.spans.iter().any(|span| span.on_ns <= at.now_ns)
    }

    fn counts(&self, forward: bool) -> bool {
        match self.switch.direction {
            SwitchDirection::Both => true,
            SwitchDirection::Positive => forward,
            SwitchDirection::Negative => !forward,
        }
    }

    /// Whether the axis, seen by the first look, has come to the begin, and has not gone beyond the end as seen by the
    /// second one.
    fn is_inside(
        &self,
        forward: bool,
        looks: [f64; 2],
        period: Option<f64>,
        track: &Track,
    ) -> bool {
        let CamSwitch { first_on, last_on, .. } = self.switch;
        let length = last_on - first_on;
        let length = match period {
            // What is longer comes round to itself, and goes on beyond.
            Some(period) if length < period => crate::axis::fmod(length, period),
            None if length < 0.0 => return false,
            _ => length,
        };
        // Along the direction of travel: from where it is switched on to where it is switched off.
        let (sign, entry) = if forward { (1.0, first_on) } else { (-1.0, -first_on - length) };
        let slack = if self.inside { track.hysteresis.abs() } else { 0.0 };
        let (entry, length) = (entry - slack, length + 2.0 * slack);
        let [on, off] = looks.map(|look| sign * look);
        let Some(period) = period else { return on >= entry && off <= entry + length };
        // The last of its places, a period apart, that has been come to.
        let entry = entry + ((on - entry) / period).floor() * period;
        length + on - off >= period || off <= entry + length
    }

    fn by_time(&mut self, way: [f64; 2], duration: f64, at: &Ahead, track: &Track) -> bool {
        let [from, to] = way;
        let duration = duration + track.off_compensation;
        let passage = match self.switch.direction {
            SwitchDirection::Both => Passage::Every,
            SwitchDirection::Positive => Passage::Positive,
            SwitchDirection::Negative => Passage::Negative,
        };
        let action = Action::Timed {
            delay_ns: ns(track.on_compensation.max(0.0)),
            duration_ns: ns(duration.max(0.0)),
        };
        let tappet = Tappet { group: 0, master: self.switch.first_on, passage, action };
        let watch =
            self.watch.get_or_insert_with(|| Watch::new(&[tappet], track.hysteresis, at.period));
        for trigger in watch.passed(&Move { from, to, from_ns: at.from_ns, to_ns: at.now_ns }) {
            // One that is to be off before it is on is never on.
            if duration > 0.0 {
                self.bit.take(&trigger);
            }
        }
        self.bit.at(at.now_ns)
    }
}

#[expect(clippy::cast_possible_truncation, reason = "saturates")]
fn ns(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}
