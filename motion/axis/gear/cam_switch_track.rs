//! Cam switch in time: an advance is looked up ahead of the axis, a delay waits (`MC_DigitalCamSwitch`).
//!
//! ```text
//! position ── ahead by an advance ─▶ on from its begin to its end ── later by a delay ─▶ output
//! ```

use super::track::{CamSwitch, SwitchDirection, Track};
use twin_cam::passage::{Heading, Lead, LookAhead, Move, Watch};
use twin_cam::{Action, MAX_PULSES, Passage, Tappet, TappetBit};

/// The axis in a cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ahead {
    /// Unwound, u.
    pub(super) position: f64,
    /// u/s.
    pub(super) velocity: f64,
    pub(super) period: Option<f64>,
    /// True if it went forwards when it moved last.
    pub(super) went_forwards: bool,
    /// True if nothing is known of where it was before.
    pub(super) begins: bool,
    pub(super) from_ns: i64,
    pub(super) now_ns: i64,
}

/// A switch with its state.
#[derive(Clone, Debug)]
pub(super) struct Switched {
    switch: CamSwitch,
    /// Direction of the axis, and the positions looked at for switching on and off.
    seen: Option<(Heading, [LookAhead; 2])>,
    /// By position: the passes of the axis, with the times of the output.
    spans: Vec<Span>,
    /// By time.
    watch: Option<Watch>,
    bit: TappetBit,
}

/// Time for which an output is on, ns.
#[derive(Clone, Copy, Debug)]
struct Span {
    /// Number of the pass, one a period.
    pass: f64,
    on_ns: i64,
    /// None while the axis is there.
    off_ns: Option<i64>,
}

/// No place.
const NONE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

impl Switched {
    pub(super) fn new(switch: CamSwitch) -> Self {
        let bit = TappetBit::default();
        Self { switch, seen: None, spans: Vec::new(), watch: None, bit }
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
        let [on_later, off_later] =
            [track.on_compensation, track.off_compensation].map(|later| ns(later.max(0.0)));
        let slack = track.hysteresis.abs();
        let within = |slack: f64| {
            if self.counts(forward) { self.passes(forward, looks, at.period, slack) } else { NONE }
        };
        let ([first, last], [lowest, highest]) = (within(0.0), within(slack));
        // At the begin nothing has been passed: the output shows the present position.
        let on_ns = at.now_ns.saturating_add(if at.begins { 0 } else { on_later });
        if at.begins {
            self.spans.clear();
        }
        for span in self.spans.iter_mut().filter(|span| span.off_ns.is_none()) {
            if !(lowest..=highest).contains(&span.pass) {
                span.off_ns = Some(at.now_ns.saturating_add(off_later));
            }
        }
        // The newest ones first, should there be more than are kept.
        let (newest, by) = if forward { (last, -1.0) } else { (first, 1.0) };
        let passes = std::iter::successors(Some(newest), |pass| Some(pass + by));
        for pass in passes.take_while(|pass| (first..=last).contains(pass)).take(MAX_PULSES) {
            let is_same = |span: &Span| span.off_ns.is_none() && (span.pass - pass).abs() < 0.5;
            if self.spans.len() < MAX_PULSES && !self.spans.iter().any(is_same) {
                self.spans.push(Span { pass, on_ns, off_ns: None });
            }
        }
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

    /// First and last pass, one a period, that the axis has reached by the first look and not left by the second one, with
    /// this slack.
    fn passes(
        &self,
        forward: bool,
        [on, off]: [f64; 2],
        period: Option<f64>,
        slack: f64,
    ) -> [f64; 2] {
        let CamSwitch { first_on, last_on, .. } = self.switch;
        // Backwards it comes to the end first.
        let [at_begin, at_end] = if forward { [on, off] } else { [off, on] };
        let length = last_on - first_on;
        let Some(period) = period else {
            let inside = at_begin >= first_on - slack && at_end <= last_on + slack;
            return if inside && length >= 0.0 { [0.0, 0.0] } else { NONE };
        };
        // A range longer than a period ends behind its next begin.
        let (whole, rest) = if length < period {
            (0.0, crate::fmod(length, period))
        } else {
            (1.0, length - period)
        };
        let begun = |pass: f64| at_begin >= first_on + pass * period - slack;
        let goes_on = |pass: f64| at_end <= first_on + (pass + whole) * period + rest + slack;
        // A quotient may have been rounded over a place.
        let last = ((at_begin + slack - first_on) / period).floor();
        let last = [last + 1.0, last].into_iter().find(|pass| begun(*pass)).unwrap_or(last - 1.0);
        let first = ((at_end - slack - rest - first_on) / period).ceil() - whole;
        let first =
            [first - 1.0, first].into_iter().find(|pass| goes_on(*pass)).unwrap_or(first + 1.0);
        [first, last]
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
            // A pulse that ends before it begins does not show.
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
