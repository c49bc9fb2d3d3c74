//! Tests of stops against closed forms, numerical bounds and a search.

#![expect(clippy::float_cmp, reason = "given, or at rest exactly")]

use super::*;
use proptest::prelude::*;

fn stop(velocity: f64, acceleration: f64, most: f64, jerk: Option<f64>) -> AxisStop {
    let limits = StopLimits { acceleration: most, jerk };
    AxisStop::new(0.25, velocity, acceleration, &limits).unwrap()
}

fn near(one: f64, other: f64) {
    assert!((one - other).abs() <= 1e-12 * other.abs().max(1.0), "{one} is not {other}");
}

#[test]
fn closed_forms() {
    // 2 m/s at 4 m/s²: 0.5 s, v²/2A = 0.5 m, whatever the acceleration was.
    let plain = stop(-2.0, 17.0, 4.0, None);
    near(plain.duration(), 0.5);
    near(plain.distance(), -0.5);
    assert_eq!(plain.at(0.25), (0.25 - 0.375, -1.0, 4.0));
    // With jerk v/A + A/J, and half the mean velocity over all of it, by symmetry.
    let eased = stop(2.0, 0.0, 4.0, Some(16.0));
    near(eased.duration(), 0.75);
    near(eased.distance(), 0.75);
    // Too slow for all of A: 2·√(v/J).
    let short = stop(0.25, 0.0, 4.0, Some(16.0));
    near(short.duration(), 0.25);
    near(short.distance(), 0.25 * 0.125);
    // Releasing −4 at 16 takes 0.25 s and 0.5 m/s: nothing else is needed.
    let released = stop(0.5, -4.0, 4.0, Some(16.0));
    near(released.duration(), 0.25);
    near(released.distance(), 16.0 * 0.25f64.powi(3) / 6.0);
    assert_eq!(stop(0.0, 0.0, 1.0, Some(1.0)).duration(), 0.0);
}

#[test]
fn what_is_no_limit_is_refused() {
    for limit in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for (most, jerk) in [(limit, None), (1.0, Some(limit))] {
            let limits = StopLimits { acceleration: most, jerk };
            let error = AxisStop::new(0.0, 1.0, 0.0, &limits).unwrap_err();
            assert!(matches!(error, StopError::Limits { axis: 0, .. }), "{error}");
        }
    }
    let limits = [StopLimits { acceleration: 1.0, jerk: None }; 2];
    let mut motion = AxisMotion::at_rest(AxisVector::from_values([0.0, 1.0]));
    motion.velocity = AxisVector::from_values([0.0, f64::NAN]);
    assert_eq!(EmergencyStop::new(&motion, &limits), Err(StopError::Motion { axis: 1 }));
    let error = EmergencyStop::new(&motion, &limits[..1]).unwrap_err();
    assert_eq!(error, StopError::AxisCount { motion: 2, limits: 1 });
}

#[test]
fn axes_stop_each_for_itself() {
    let limits = [(4.0, None), (4.0, Some(16.0))]
        .map(|(acceleration, jerk)| StopLimits { acceleration, jerk });
    let motion = AxisMotion {
        position: AxisVector::from_values([1.0, 2.0]),
        velocity: AxisVector::from_values([2.0, -2.0]),
        acceleration: AxisVector::zeros(2),
    };
    let stop = EmergencyStop::new(&motion, &limits).unwrap();
    near(stop.duration(), 0.75);
    assert_eq!(stop.axes().map(AxisStop::duration).collect::<Vec<_>>(), [0.5, 0.75]);
    near(stop.distance()[0], 0.5);
    near(stop.distance()[1], -0.75);
    let at = stop.at(0.6);
    assert_eq!((at.position[0], at.velocity[0], at.acceleration[0]), (1.5, 0.0, 0.0));
    assert!(at.velocity[1] < 0.0 && at.acceleration[1] > 0.0, "{at:?}");
    assert_eq!(stop.at(1.0), AxisMotion::at_rest(AxisVector::from_values([1.5, 1.25])));
    assert_eq!(stop.at(0.0).velocity, motion.velocity);
}

/// The shortest of the stops that go with one jerk for t₁, hold what they have, and release it, found by trying t₁:
/// the hold that then leads to rest follows from the velocity left.
fn tried(velocity: f64, acceleration: f64, most: f64, jerk: f64, tries: u32) -> f64 {
    let mut best = f64::INFINITY;
    let longest = (acceleration.abs() + most) / jerk;
    for sign in [-1.0, 1.0] {
        for count in 0..=tries {
            let t = longest * f64::from(count) / f64::from(tries);
            let held = acceleration + sign * jerk * t;
            let begun = velocity + t * (acceleration + 0.5 * sign * jerk * t);
            let left = begun + held * held.abs() / (2.0 * jerk);
            let hold = -left / held;
            // Beyond the limit only on the way back to it.
            if held.abs() <= most * (1.0 + 1e-9) && hold >= 0.0 {
                best = best.min(t + hold + held.abs() / jerk);
            }
        }
    }
    best
}

/// True if any acceleration within the limits can come to rest in `time`: at every instant it lies between what the
/// jerk allows from the start and what it allows to the end, and so does the velocity gained. Summed numerically.
fn can_rest(velocity: f64, acceleration: f64, most: f64, jerk: f64, time: f64) -> bool {
    let steps = 4000;
    let step = time / f64::from(steps);
    let (mut low, mut high) = (velocity, velocity);
    for count in 0..steps {
        let t = step * (f64::from(count) + 0.5);
        let room = jerk * (time - t);
        let (least, largest) = (
            (acceleration - jerk * t).max((-most).min(acceleration + jerk * t)).max(-room),
            (acceleration + jerk * t).min(most.max(acceleration - jerk * t)).min(room),
        );
        if least > largest + 1e-9 * most {
            return false;
        }
        low += step * least;
        high += step * largest;
    }
    low <= 0.0 && high >= 0.0
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn limits_are_kept_and_motion_is_continuous(
        velocity in -3.0..3.0f64,
        part in -2.5..2.5f64,
        most in 0.1..50.0f64,
        jerk in prop_oneof![Just(None), (1.0..5e3f64).prop_map(Some)],
    ) {
        let start = part * most;
        let stop = stop(velocity, start, most, jerk);
        let count = 5000;
        let step = stop.duration() / f64::from(count);
        let mut before = stop.at(0.0);
        prop_assert_eq!((before.0, before.1), (0.25, velocity));
        if jerk.is_some() {
            prop_assert!((before.2 - start).abs() <= 1e-12 * most);
        }
        for index in 1..=count {
            let now = stop.at(step * f64::from(index));
            // What is beyond the limit at the start comes back without going further.
            let allowed = if jerk.is_some() { before.2.abs().max(most) } else { most };
            prop_assert!(now.2.abs() <= allowed * (1.0 + 1e-9), "{now:?}");
            if let Some(jerk) = jerk {
                prop_assert!((now.2 - before.2).abs() <= jerk * step * (1.0 + 1e-6) + 1e-9 * most);
            }
            // Differences of position and velocity are velocity and acceleration.
            let largest = allowed.max(now.2.abs());
            prop_assert!((now.1 - before.1).abs() <= largest * step * (1.0 + 1e-9) + 1e-12);
            let mean = 0.5 * (now.1 + before.1);
            let bend = largest * step * step + 1e-12;
            prop_assert!((now.0 - before.0 - mean * step).abs() <= bend, "{before:?} {now:?}");
            before = now;
        }
        before = stop.at(stop.duration());
        prop_assert!((before.0 - 0.25 - stop.distance()).abs() < 1e-14, "{before:?}");
        prop_assert_eq!((before.1, before.2), (0.0, 0.0));
        prop_assert_eq!(stop.at(stop.duration() + 1.0), before);
        let almost = stop.at(stop.duration() * (1.0 - 1e-12));
        prop_assert!((almost.0 - before.0).abs() < 1e-9 && almost.1.abs() < 1e-9, "{almost:?}");
    }

    #[test]
    fn nothing_rests_sooner(
        velocity in -3.0..3.0f64,
        part in -2.5..2.5f64,
        most in 0.5..50.0f64,
        jerk in 5.0..1e3f64,
    ) {
        let acceleration = part * most;
        let duration = stop(velocity, acceleration, most, Some(jerk)).duration();
        let tried = tried(velocity, acceleration, most, jerk, 20_000);
        prop_assert!(tried >= duration * (1.0 - 1e-9), "{tried} is less than {duration}");
        prop_assert!(tried <= duration * (1.0 + 2e-3), "{tried} is more than {duration}");
        for part in [0.3, 0.6, 0.9, 0.99] {
            prop_assert!(!can_rest(velocity, acceleration, most, jerk, part * duration));
        }
        prop_assert!(can_rest(velocity, acceleration, most, jerk, duration * 1.01 + 1e-6));
    }
}
