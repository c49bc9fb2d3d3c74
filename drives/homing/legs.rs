//! The legs of a way that is watched by looks alone.

use super::Seen;

/// A leg is what the axis goes in so long, s: several looks on any usual wire. Where they take longer it rests between legs.
pub(super) const LEG_S: f64 = 0.5;
/// The next leg is sent when less than this part of one is left.
const LEFT: f64 = 0.5;

/// A way under way, if any: its axis is sent to the end of a leg, and on only when somebody has looked.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Legs {
    way: Option<Way>,
}

#[derive(Clone, Copy, Debug)]
struct Way {
    /// Where all of it ends, increments.
    end: f64,
    velocity: f64,
    /// Length of a leg, whole increments.
    leg: f64,
    /// Where the axis has been sent.
    sent: f64,
    /// It was seen at rest there: what the switch says from now on is of that place.
    rests: bool,
}

/// Length of a leg at a speed, increments/s.
pub(super) fn leg(velocity: f64) -> f64 {
    (velocity * LEG_S).ceil().max(1.0)
}

impl Way {
    /// The end of a leg from here.
    fn leg_from(&self, position: f64) -> f64 {
        let left = self.end - position;
        if left.abs() <= self.leg {
            return self.end;
        }
        (position + self.leg.copysign(left)).round()
    }

    /// Whether the axis has been sent to the end of the way.
    fn is_last(&self) -> bool {
        (self.sent - self.end).abs() < 0.5
    }

    /// Whether the axis is where it was sent.
    fn is_there(&self, position: f64) -> bool {
        (self.sent - position).abs() <= 1.0
    }
}

impl Legs {
    /// Another way, to `end` at `velocity` (increments, increments/s); where its first leg ends.
    pub(super) fn begin(&mut self, from: f64, end: f64, velocity: f64) -> f64 {
        let leg = leg(velocity);
        let mut way = Way { end, velocity, leg, sent: from, rests: false };
        way.sent = way.leg_from(from);
        self.way = Some(way);
        way.sent
    }

    /// What was seen, for a sequence that knows of no legs: at the end of one the axis goes on.
    pub(super) fn seen(&self, seen: &Seen) -> Seen {
        let between = self.way.is_some_and(|way| !way.is_last() && way.is_there(seen.position));
        Seen { moving: seen.moving || between, ..*seen }
    }

    /// The end of the next leg and its velocity, once it is time for it: near the end of the one under way, or where the axis
    /// rests there if the device takes no other target before. A switch is looked at before the position: one at the end of a
    /// leg is seen by the look after that with which the axis came to rest.
    pub(super) fn next(&mut self, seen: &Seen, retargets: bool) -> Option<(f64, f64)> {
        let way = self.way.as_mut().filter(|way| !way.is_last())?;
        let left = (way.sent - seen.position).abs();
        let stands = !seen.moving && way.is_there(seen.position);
        let stood = std::mem::replace(&mut way.rests, stands);
        let near = retargets && seen.moving && left < LEFT * way.leg;
        if !(stands && stood || near) {
            return None;
        }
        way.rests = false;
        way.sent = way.leg_from(seen.position);
        Some((way.sent, way.velocity))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(position: f64, moving: bool) -> Seen {
        let (time_ns, switch_ns, index, limit) = (0, 0, None, None);
        Seen { time_ns, position, moving, switch_ns, open: true, index, limit }
    }

    #[test]
    fn an_axis_is_sent_half_a_second_ahead_and_on_when_it_has_been_looked_at() {
        let mut legs = Legs::default();
        // 2000 increments/s: 1000 at a time.
        assert!((legs.begin(70.0, -2530.0, 2000.0) + 930.0).abs() < 1e-9);
        assert_eq!(legs.next(&seen(-300.0, true), true), None);
        assert_eq!(legs.next(&seen(-431.0, true), true), Some((-1431.0, 2000.0)));
        // One that takes no target while it moves rests between legs, which is not the end of the way.
        let mut waits = legs;
        assert_eq!(waits.next(&seen(-1400.0, true), false), None);
        assert!(waits.seen(&seen(-1431.0, false)).moving);
        // Whether it is on its switch is seen when it is looked at once more.
        assert_eq!(waits.next(&seen(-1431.0, false), false), None);
        assert_eq!(waits.next(&seen(-1431.0, false), false), Some((-2431.0, 2000.0)));
        // The end is that of the whole way, and there it rests.
        assert_eq!(legs.next(&seen(-1530.0, true), true), Some((-2530.0, 2000.0)));
        assert_eq!(legs.next(&seen(-2400.0, true), true), None);
        assert!(!legs.seen(&seen(-2530.0, false)).moving);
        // At rest elsewhere it has not arrived.
        assert!(!legs.seen(&seen(-2000.0, false)).moving);
    }

    #[test]
    fn legs_have_an_increment_at_least_and_end_where_the_way_does() {
        let mut legs = Legs::default();
        assert!((legs.begin(0.0, 1e6, 0.5) - 1.0).abs() < 1e-9);
        // A way shorter than a leg is one.
        assert!((legs.begin(5.0, -3.0, 1000.0) + 3.0).abs() < 1e-9);
        assert_eq!(legs.next(&seen(-3.0, false), true), None);
        // Without a way nothing is changed.
        assert!(!Legs::default().seen(&seen(0.0, false)).moving);
    }
}
