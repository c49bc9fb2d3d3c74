//! Encoder check: compares the counter of an axis with the position its encoder shows.
//!
//! Counter and encoder are read one after the other while the axis moves, so the encoder is read between two readings
//! of the counter. Both bound its position. On a move that takes the time T, with an acceleration of at most a, and
//! that starts, stops or reverses at the start-stop speed u, an axis is never farther than
//!
//! ```text
//! a·T²/8 + u·T/2
//! ```
//!
//! from the interval between its ends (the largest distance from the chord of a move with that acceleration, and of one
//! with a kink of 2u in its middle). This distance is added to the tolerance, as are one step of the counter and one
//! point of the encoder for rounding. At rest T is 0 and both are compared directly.

/// A counter jumps where it is made 0 on the way. It goes no farther by itself than the axis does at its highest speed, but for
/// when exactly each look was: so much more, increments.
const JUMP: f64 = 16.0;

/// Ratio and limits of an axis with an encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderLimits {
    /// Points that the encoder counts, less than 0 if it counts down where the counter counts up …
    pub points: i32,
    /// … for this number of increments of the counter.
    pub increments: u32,
    /// So far encoder and counter may be apart, increments.
    pub tolerance: u32,
    /// So far the numbers of both may be off because they are whole, in addition to one point of the encoder, increments.
    pub rounding: u32,
    /// Largest acceleration or deceleration, increments/s².
    pub rate: f64,
    /// Start-stop speed, increments/s.
    pub start_stop: f64,
    /// Largest speed, increments/s.
    pub fastest: f64,
}

/// Range of the counter while the encoder was read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// Seen before, increments.
    pub before: i64,
    /// Seen after it, increments.
    pub after: i64,
    /// From the begin of one look to the end of the other, s.
    pub duration: f64,
}

impl Passed {
    /// Nothing: it rests there.
    pub fn at_rest(counter: i64) -> Self {
        Self { before: counter, after: counter, duration: 0.0 }
    }
}

/// Counter and encoder are farther apart than they may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Apart {
    /// Counter, at its reading nearest to the encoder, increments.
    pub counter: i64,
    /// Counter by the encoder, increments.
    pub encoder: i64,
}

/// A shaft with an encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderCheck {
    limits: EncoderLimits,
    /// Points and counter that belong together, once they are known.
    reference: Option<(i32, i64)>,
}

impl EncoderCheck {
    /// A shaft whose reference is not known yet.
    pub fn new(limits: &EncoderLimits) -> Self {
        Self { limits: *limits, reference: None }
    }

    /// Allowed distance between encoder and counter, increments.
    pub fn tolerance(&self) -> u32 {
        self.limits.tolerance
    }

    /// Whether it is known which points belong to which counter.
    pub fn is_known(&self) -> bool {
        self.reference.is_some()
    }

    /// These belong together: the axis rests.
    pub fn refer(&mut self, points: i32, counter: i64) {
        self.reference = Some((points, counter));
    }

    /// The counter, the encoder or the shaft has been put elsewhere.
    pub fn forget(&mut self) {
        self.reference = None;
    }

    /// What the counter would be by the encoder, increments. The registers of encoders wrap.
    fn counter_of(&self, points: i32) -> Option<i64> {
        let (from, counter) = self.reference?;
        let EncoderLimits { points: per, increments, .. } = self.limits;
        let way = i128::from(points.wrapping_sub(from)) * i128::from(increments);
        let way = i64::try_from(way.checked_div(i128::from(per))?).ok()?;
        Some(counter.saturating_add(way))
    }

    /// How much farther apart than the tolerance both may be for the way that the axis has made meanwhile, increments.
    fn slack(&self, duration: f64) -> f64 {
        let EncoderLimits { points, increments, rounding, rate, start_stop, .. } = self.limits;
        let point = f64::from(increments) / f64::from(points).abs().max(1.0);
        let way = rate * duration * duration / 8.0 + start_stop * duration / 2.0;
        way + point + f64::from(rounding)
    }

    /// Whether the encoder is beyond what the counter passed; nothing while it is not known which points belong to which
    /// counter.
    pub fn apart(&self, passed: &Passed, points: i32) -> Option<Apart> {
        self.beyond(passed, points, f64::from(self.limits.tolerance))
    }

    fn beyond(&self, passed: &Passed, points: i32, tolerance: f64) -> Option<Apart> {
        let encoder = self.counter_of(points)?;
        let (low, high) = (passed.before.min(passed.after), passed.before.max(passed.after));
        let counter = encoder.clamp(low, high);
        #[expect(clippy::cast_precision_loss, reason = "counters have 32 bits")]
        let apart = encoder.saturating_sub(counter).saturating_abs() as f64;
        (apart > tolerance + self.slack(passed.duration)).then_some(Apart { counter, encoder })
    }

    /// The same while an axis homes, whose counter may be made 0 on the way: which points belong to which counter is forgotten
    /// where it jumps. One that jumps by less than the axis can have moved does not put the shaft in doubt.
    pub fn apart_homing(&mut self, passed: &Passed, points: i32) -> Option<Apart> {
        let jump = 2.0 * self.limits.fastest * passed.duration + JUMP;
        #[expect(clippy::cast_precision_loss, reason = "counters have 32 bits")]
        if passed.before.abs_diff(passed.after) as f64 > jump {
            self.forget();
        }
        self.beyond(passed, points, f64::from(self.limits.tolerance) + jump)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 4 points for 3 increments, 10 increments of tolerance.
    const WATCHING: EncoderLimits = EncoderLimits {
        points: 4,
        increments: 3,
        tolerance: 10,
        rounding: 1,
        rate: 10_000.0,
        start_stop: 100.0,
        fastest: 2000.0,
    };

    fn known(limits: &EncoderLimits) -> EncoderCheck {
        let mut shaft = EncoderCheck::new(limits);
        shaft.refer(1000, -500);
        shaft
    }

    #[test]
    fn at_rest_the_tolerance_counts_and_what_is_not_whole() {
        let shaft = known(&WATCHING);
        // 400 points are 300 increments.
        let at = |counter| shaft.apart(&Passed::at_rest(counter), 1400);
        assert_eq!(at(-200), None);
        // 10, a step of the counter and a point, 0.75 of one.
        assert_eq!([at(-211), at(-189)], [None, None]);
        assert_eq!(at(-212), Some(Apart { counter: -212, encoder: -200 }));
        assert_eq!(at(-188), Some(Apart { counter: -188, encoder: -200 }));
        // Nothing is known of a shaft that has not been seen at rest.
        let unknown = EncoderCheck::new(&WATCHING);
        assert!(!unknown.is_known() && unknown.apart(&Passed::at_rest(9000), 0).is_none());
    }

    #[test]
    fn an_encoder_that_counts_down_and_one_that_wraps_are_followed() {
        let down = EncoderLimits { points: -4, ..WATCHING };
        let shaft = known(&down);
        assert_eq!(shaft.apart(&Passed::at_rest(-800), 1400), None);
        // One that is said to count up shows the way that is counted, twice.
        let wrong = known(&WATCHING).apart(&Passed::at_rest(-800), 1400);
        assert_eq!(wrong, Some(Apart { counter: -800, encoder: -200 }));
        let mut shaft = EncoderCheck::new(&WATCHING);
        shaft.refer(i32::MAX - 199, 0);
        assert_eq!(shaft.apart(&Passed::at_rest(300), i32::MIN + 200), None);
        assert!(shaft.apart(&Passed::at_rest(0), i32::MIN + 200).is_some());
    }

    /// Every way with these accelerations, start-stop speeds and turns, looked at whenever: a shaft that follows is never
    /// beyond, and one that is held is as soon as it is out of the stretch by more than what is allowed.
    #[test]
    fn a_shaft_that_follows_is_within_whatever_the_way() {
        let EncoderLimits { rate, start_stop, .. } = WATCHING;
        // There and back with full acceleration around the turn, which comes at 0.1 s: the worst way of all.
        let way = |time: f64| {
            let before = 0.1 - time;
            let along = start_stop * before.abs() + 0.5 * rate * before * before;
            #[expect(clippy::cast_possible_truncation, reason = "hundreds")]
            let counter = (200.0 - along).floor() as i64;
            counter
        };
        let shaft = known(&WATCHING);
        for first in 0..200 {
            for apart in 1..60 {
                let [first, apart] = [f64::from(first) * 1e-3, f64::from(apart) * 1e-3];
                for part in 0..=4 {
                    let between = first + apart * f64::from(part) / 4.0;
                    let passed =
                        Passed { before: way(first), after: way(first + apart), duration: apart };
                    let points = 1000 + i32::try_from((way(between) + 500) * 4 / 3).unwrap();
                    assert_eq!(shaft.apart(&passed, points), None, "{first} {apart} {part}");
                }
            }
        }
        // Held at -500 while the counter goes from 0 to 20 in 20 ms: 0.5 of acceleration, 1 of start-stop speed.
        let passed = Passed { before: -487, after: -467, duration: 0.02 };
        assert_eq!(shaft.apart(&passed, 1000), None);
        let passed = Passed { before: -485, after: -465, duration: 0.02 };
        assert_eq!(shaft.apart(&passed, 1000), Some(Apart { counter: -485, encoder: -500 }));
    }

    #[test]
    fn a_counter_that_is_made_zero_while_it_homes_is_no_held_shaft() {
        let mut shaft = known(&WATCHING);
        let at = |before, after| Passed { before, after, duration: 0.01 };
        // 2 · 2000 · 0.01 + 16 = 56 increments are what the axis and the looks account for.
        assert_eq!(shaft.apart_homing(&at(-500, -520), 1000 - 13), None);
        assert!(shaft.is_known());
        assert_eq!(shaft.apart_homing(&at(-520, 0), 1000 - 27), None);
        assert!(!shaft.is_known());
        // The shaft is held: nothing jumps.
        let mut held = known(&WATCHING);
        assert_eq!(held.apart_homing(&at(-560, -565), 1000), None);
        let told = held.apart_homing(&at(-580, -590), 1000);
        assert_eq!(told, Some(Apart { counter: -580, encoder: -500 }));
    }
}
