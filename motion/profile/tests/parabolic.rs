//! Tests of jerk-limited ramps.

use super::random::{Case, Random};
use super::{close, sampled};
use crate::{AxisLimits, Profile, RampType, State};

fn plan(case: &Case, ramp: RampType) -> Profile {
    let Case { from, target, end_velocity, limits } = *case;
    Profile::to_position(from, target, end_velocity, limits, ramp).unwrap()
}

/// The greatest value for a check: the limits for a velocity.
fn rate(limits: &AxisLimits, state: State) -> f64 {
    if state.velocity * state.acceleration > 0.0 {
        limits.acceleration
    } else {
        limits.deceleration
    }
}

fn keeps_everything(case: &Case, profile: &Profile) {
    let Case { from, target, end_velocity, limits } = *case;
    let scale = target.abs().max(from.position.abs()).max(limits.velocity * profile.duration());
    let begin = profile.at(0.0);
    assert!(
        close(begin.velocity, from.velocity) && close(begin.acceleration, from.acceleration),
        "{case:?} {begin:?}"
    );
    let last = profile.at(profile.duration() * (1.0 - 1e-15));
    assert!((last.position - target).abs() <= 1e-9 * scale, "{case:?}: {last:?}");
    assert!((last.velocity - end_velocity).abs() <= 1e-7 * limits.velocity, "{case:?}: {last:?}");
    let mut before: Option<(f64, State)> = None;
    for (time, state) in sampled(profile, 200) {
        assert!(
            state.velocity.abs() <= limits.velocity * (1.0 + 1e-9),
            "{case:?} {time}: {state:?}"
        );
        let free = state.velocity.abs() < 1e-6 * limits.velocity;
        let most =
            if free { limits.acceleration.max(limits.deceleration) } else { rate(&limits, state) };
        assert!(state.acceleration.abs() <= most * (1.0 + 1e-9), "{case:?} {time}: {state:?}");
        if let Some((earlier, previous)) = before {
            let step = time - earlier;
            assert!(
                (state.acceleration - previous.acceleration).abs()
                    <= limits.jerk * step * (1.0 + 1e-9) + 1e-7 * most,
                "{case:?} {time}"
            );
            let mean = 0.5 * (state.acceleration + previous.acceleration);
            assert!(
                (state.velocity - previous.velocity - mean * step).abs()
                    <= 0.25 * limits.jerk * step * step * (1.0 + 1e-9) + 1e-7 * limits.velocity,
                "{case:?} {time}"
            );
        }
        before = Some((time, state));
    }
}

#[test]
fn limits_and_ends_of_random_moves() {
    for (seed, ramp, equal) in [
        (1, RampType::Parabolic, true),
        (2, RampType::Parabolic, false),
        (3, RampType::Sigmoid, true),
        (4, RampType::Sigmoid, false),
    ] {
        let mut random = Random(seed);
        let mut count = 0;
        while count < 5000 {
            let case = Case::new(&mut random, equal);
            if case.keeps_velocity() {
                keeps_everything(&case, &plan(&case, ramp));
                count += 1;
            }
        }
    }
}

/// With limits that differ the time lies between those with both as large and both as small as the larger and the
/// smaller one.
#[test]
fn limits_that_differ_are_between_equal_ones() {
    let mut random = Random(5);
    let mut count = 0;
    while count < 5000 {
        let case = Case::new(&mut random, false);
        if !case.keeps_velocity() {
            continue;
        }
        count += 1;
        let with = |rate: f64| {
            let limits = AxisLimits { acceleration: rate, deceleration: rate, ..case.limits };
            plan(&Case { limits, ..case }, RampType::Parabolic).duration()
        };
        let AxisLimits { acceleration, deceleration, .. } = case.limits;
        let (least, most) =
            (with(acceleration.max(deceleration)), with(acceleration.min(deceleration)));
        let time = plan(&case, RampType::Parabolic).duration();
        assert!(
            least * (1.0 - 1e-9) <= time && time <= most * (1.0 + 1e-9),
            "{least} {time} {most}: {case:?}"
        );
    }
}

/// From rest to rest with equal limits, where the duration has closed forms.
#[test]
fn rest_to_rest_takes_what_the_closed_forms_say() {
    let mut random = Random(6);
    let mut forms = [0; 3];
    for _ in 0..5000 {
        let case = Case::new(&mut random, true);
        let AxisLimits { velocity, acceleration: rate, jerk, .. } = case.limits;
        let from = State::resting(case.from.position);
        let length = (case.target - from.position).abs();
        // Digest 6.2: T = Δv/a + a/j, or 2·√(Δv/j) for Δv < a²/j.
        let ramp = |v: f64| {
            if v < rate * rate / jerk { 2.0 * (v / jerk).sqrt() } else { v / rate + rate / jerk }
        };
        let (form, expected) = if length >= velocity * ramp(velocity) {
            (0, length / velocity + ramp(velocity))
        } else if length >= 2.0 * rate.powi(3) / (jerk * jerk) {
            let part = rate / jerk;
            (1, part + (part * part + 4.0 * length / rate).sqrt())
        } else {
            (2, 4.0 * (0.5 * length / jerk).cbrt())
        };
        forms[form] += 1;
        let profile = plan(&Case { from, end_velocity: 0.0, ..case }, RampType::Parabolic);
        assert!(close(profile.duration(), expected), "{case:?}: {} {expected}", profile.duration());
    }
    assert!(forms.iter().all(|&count| count > 100), "{forms:?}");
}
