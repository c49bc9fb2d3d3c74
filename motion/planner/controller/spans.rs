//! Span planning: the next leg of the path for profiles without steps of the acceleration.
//!
//! Consecutive elements with the same limits and without a bound on the velocity between them form one *span*: a ramp
//! goes through all of them (manual 6.2.9). At the ends of a span, where feed, acceleration or a transition velocity
//! change, the acceleration is 0. With sin² ramps, which are as long as those with constant acceleration, that takes no
//! extra time.

use super::Source;
use super::look_ahead::LookAhead;
use super::ramp::{Ramp, Smoothness};
use twin_path::prepare::CheckedElement;

/// Lengths are equal to within this part of them, and this much, m: what is left of a span after a ramp down was set
/// off in time.
const ROUNDING: f64 = 1e-9;
const NOTHING: f64 = 1e-12;

/// Elements with the same limits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    length: f64,
    feed: f64,
    up: f64,
    down: f64,
    /// Largest velocity at its end.
    end_velocity: f64,
    /// Number of elements, that under way included.
    elements: usize,
}

impl Span {
    fn new(element: &CheckedElement, length: f64, end_velocity: f64, scale: f64) -> Self {
        Self {
            length,
            feed: scale * element.feed,
            up: element.acceleration,
            down: element.deceleration,
            end_velocity,
            elements: 1,
        }
    }

    /// True if `next` behind it has the same limits, exactly, and nothing in between has others.
    fn takes(&self, next: &Self) -> bool {
        let same = |a: f64, b: f64| a.to_bits() == b.to_bits();
        self.end_velocity >= self.feed
            && same(self.feed, next.feed)
            && same(self.up, next.up)
            && same(self.down, next.down)
    }
}

/// Present state of the path, without acceleration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Now<'e> {
    pub(super) element: &'e CheckedElement,
    /// Largest velocity at the element's end.
    pub(super) end_velocity: f64,
    /// Travelled on the element, m.
    pub(super) at: f64,
    pub(super) velocity: f64,
    /// To rest, as soon as may be.
    pub(super) halting: bool,
    /// It may be faster than it should, because the override was lowered.
    pub(super) over: bool,
}

/// Next leg of the path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg {
    pub(super) ramp: Ramp,
    /// Its begin, from the start of the element under way, m; negative when that is not the one in which it began.
    pub(super) from: f64,
    /// It ends at the end of an element: how many elements end until then, that included.
    pub(super) ends: Option<usize>,
}

/// Decides what comes next. `spans` is scratch space.
pub(super) fn decide<I, E>(
    plan: &mut LookAhead<I, E>,
    now: Now<'_>,
    smoothness: Smoothness,
    spans: &mut Vec<Span>,
) -> Leg
where
    I: Source<Item = Result<CheckedElement, E>>,
{
    loop {
        let more = gather(plan, now, spans);
        let (end, bounded) = asked(spans, smoothness, more);
        let Some(front) = spans.first() else {
            return Leg { ramp: Ramp::constant(0.0, 0.0), from: now.at, ends: Some(1) };
        };
        let (leg, by_end) = next_leg(front, end, now, smoothness);
        let limited = bounded && by_end && !now.halting;
        if limited && pull_some(plan, spans.len()) {
            continue;
        }
        plan.set_limited(limited);
        return leg;
    }
}

/// Takes more of the path from upstream; false if there is none.
fn pull_some<I, E>(plan: &mut LookAhead<I, E>, known: usize) -> bool
where
    I: Source<Item = Result<CheckedElement, E>>,
{
    let mut count = 0;
    while count < known.max(64) && plan.pull() {
        count += 1;
    }
    count > 0
}

/// The known path as spans, up to the first stop. True if there is no stop in it, so that more may follow.
fn gather<I, E>(plan: &LookAhead<I, E>, now: Now<'_>, spans: &mut Vec<Span>) -> bool
where
    I: Source<Item = Result<CheckedElement, E>>,
{
    spans.clear();
    let scale = plan.scale();
    let remaining = (now.element.path_length() - now.at).max(0.0);
    let mut last = Span::new(now.element, remaining, now.end_velocity, scale);
    for queued in plan.known() {
        if last.end_velocity <= 0.0 {
            break;
        }
        let element = &queued.element;
        let next = Span::new(element, element.path_length(), queued.end_velocity, scale);
        if last.takes(&next) {
            last.length += next.length;
            last.end_velocity = next.end_velocity;
            last.elements += 1;
        } else {
            spans.push(last);
            last = next;
        }
    }
    spans.push(last);
    last.end_velocity > 0.0
}

/// The largest velocity at the end of the first span, and whether that is less than it would be if more of the path
/// were known.
fn asked(spans: &[Span], smoothness: Smoothness, more: bool) -> (f64, bool) {
    let (mut velocity, mut bounded) = (0.0, more);
    for pair in spans.windows(2).rev() {
        let [before, span] = pair else { continue };
        let limit = before.end_velocity.min(span.feed);
        // Under limited jerk a ramp to rest may be shorter than one to a small velocity.
        let [to_rest, to_next] = [0.0, velocity]
            .map(|velocity| smoothness.reach(velocity, span.length, span.down, limit));
        velocity = to_rest.max(to_next);
        bounded = bounded && velocity < limit;
    }
    (velocity, bounded)
}

/// The next leg along `span` that leads to its end with at most `end`, and whether it would be another one if `end`
/// were larger.
fn next_leg(span: &Span, end: f64, now: Now<'_>, smoothness: Smoothness) -> (Leg, bool) {
    let Span { length, feed, up, down, elements, .. } = *span;
    let v = now.velocity;
    let leg = |ramp, ends: bool| Leg { ramp, from: now.at, ends: ends.then_some(elements) };
    let to_end = |to: f64, rate| leg(Ramp::over(length, [v, to], rate, smoothness), true);
    let room = length * (1.0 - ROUNDING) - NOTHING;

    let stop = smoothness.length(v, 0.0, down);
    if now.halting && stop < room {
        return (leg(Ramp::between([v, 0.0], down, smoothness), false), false);
    }
    if now.halting && end > 0.0 {
        let slowest = smoothness.slowest(v, 0.0, length, down);
        return (to_end(if now.over { slowest } else { slowest.min(end) }, down), false);
    }
    // What can be reached at all.
    let end = if v < end { smoothness.reach(v, length, up, end) } else { end };
    let brake = if v > end { smoothness.length(v, end, down) } else { 0.0 };
    if v > end && brake >= room {
        let late = brake > length * (1.0 + ROUNDING) + NOTHING;
        let to = if !late || end <= 0.0 {
            end
        } else if stop <= length * (1.0 + ROUNDING) + NOTHING {
            smoothness.below(v, end, length, down)
        } else if now.over {
            smoothness.slowest(v, end, length, down).max(end)
        } else {
            end
        };
        return (to_end(to, down), true);
    }
    if v > feed * (1.0 + ROUNDING) {
        let slowing = smoothness.length(v, feed, down) + smoothness.length(feed, end, down);
        return if slowing <= room {
            (leg(Ramp::between([v, feed], down, smoothness), false), false)
        } else {
            (to_end(end, down), true)
        };
    }
    let peak = smoothness.peak([v, end], length, [up, down], feed);
    let by_end = peak < feed;
    if v <= 0.0 || peak > v * (1.0 + ROUNDING) {
        let rise = smoothness.length(v, peak, up);
        return if rise >= room {
            (to_end(peak.min(end.max(v)), up), by_end)
        } else {
            (leg(Ramp::between([v, peak], up, smoothness), false), by_end)
        };
    }
    let cruise = length - brake;
    (leg(Ramp::constant(v, cruise), brake <= 0.0), by_end)
}
