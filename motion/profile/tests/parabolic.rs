//! Tests of jerk-limited ramps, and of ramps of all kinds under absurd limits.

use super::*;

fn plan(case: &Case, ramp: RampType) -> Profile {
    let Case { from, target, end_velocity, limits } = *case;
    Profile::to_position(from, target, end_velocity, limits, ramp).unwrap()
}

fn keeps_everything(case: &Case, profile: &Profile) {
    let Case { from, target, end_velocity, limits } = *case;
    let scale = target.abs().max(from.position.abs()).max(limits.velocity * profile.duration());
    let begin = profile.at(0.0);
    assert!(close(begin.velocity, from.velocity), "{case:?} {begin:?}");
    assert!(close(begin.acceleration, from.acceleration), "{case:?} {begin:?}");
    let last = profile.at(profile.duration() * (1.0 - 1e-15));
    assert!((last.position - target).abs() <= 1e-9 * scale, "{case:?}: {last:?}");
    assert!((last.velocity - end_velocity).abs() <= 1e-7 * limits.velocity, "{case:?}: {last:?}");
    let (mut earlier, mut previous) = (0.0, begin);
    for (time, state) in sampled(profile, 200) {
        let State { velocity, acceleration, .. } = state;
        let fastest = limits.velocity * (1.0 + 1e-9);
        assert!(velocity.abs() <= fastest, "{case:?} {time}: {state:?}");
        let free = velocity.abs() < 1e-6 * limits.velocity;
        let most =
            if free { limits.acceleration.max(limits.deceleration) } else { rate(&limits, state) };
        assert!(acceleration.abs() <= most * (1.0 + 1e-9), "{case:?} {time}: {state:?}");
        let step = time - earlier;
        let change = (acceleration - previous.acceleration).abs();
        let by_jerk = limits.jerk * step * (1.0 + 1e-9);
        assert!(change <= by_jerk + 1e-7 * most, "{case:?} {time}");
        let mean = 0.5 * (acceleration + previous.acceleration);
        let off = (velocity - previous.velocity - mean * step).abs();
        assert!(off <= 0.25 * by_jerk * step + 1e-7 * limits.velocity, "{case:?} {time}");
        (earlier, previous) = (time, state);
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
        for case in cases(seed, 5000, equal, Case::keeps_velocity) {
            keeps_everything(&case, &plan(&case, ramp));
        }
    }
}

/// The time lies between those with both as large and both as small.
#[test]
fn limits_that_differ_are_between_equal_ones() {
    for case in cases(5, 5000, false, Case::keeps_velocity) {
        let with = |rate: f64| {
            let limits = AxisLimits { acceleration: rate, deceleration: rate, ..case.limits };
            plan(&Case { limits, ..case }, RampType::Parabolic).duration()
        };
        let AxisLimits { acceleration, deceleration, .. } = case.limits;
        let least = with(acceleration.max(deceleration));
        let most = with(acceleration.min(deceleration));
        let time = plan(&case, RampType::Parabolic).duration();
        let between = least * (1.0 - 1e-9)..=most * (1.0 + 1e-9);
        assert!(between.contains(&time), "{time} in {between:?}: {case:?}");
    }
}

/// From rest to rest with equal limits, where the duration has closed forms.
#[test]
fn rest_to_rest_takes_what_the_closed_forms_say() {
    let mut forms = [0; 3];
    for case in cases(6, 5000, true, |_| true) {
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

/// Limits of a million different proportions.
#[test]
fn limits_of_all_proportions_end_where_they_should_or_are_refused() {
    let mut random = Random(12);
    for _ in 0..20_000 {
        let mut positive = || random.decades(-3.0, 3.0);
        let limits = AxisLimits {
            velocity: positive(),
            acceleration: positive(),
            deceleration: positive(),
            jerk: positive(),
        };
        let mut any = |scale: f64| {
            let size = random.decades(-3.0, 1.0) * scale;
            if random.once_in(4.0) { 0.0 } else { size * random.signed().signum() }
        };
        let from = State {
            position: any(100.0),
            velocity: any(limits.velocity),
            acceleration: any(limits.acceleration),
        };
        let target = any(1000.0);
        let end_velocity = 0.1 * any(limits.velocity);
        for ramp in [RampType::Trapezoid, RampType::Parabolic, RampType::Sigmoid] {
            let profile = match Profile::to_position(from, target, end_velocity, limits, ramp) {
                Ok(profile) => profile,
                Err(ProfileError::EndVelocity { .. }) => continue,
                Err(error) => panic!("{error}: {from:?} {target} {end_velocity} {limits:?}"),
            };
            let about = format!("{ramp:?} {from:?} {target} {end_velocity} {limits:?}");
            let mut furthest = target.abs().max(from.position.abs());
            for part in 0..=100 {
                let state = profile.at(f64::from(part) / 100.0 * profile.duration());
                let sum = state.position + state.velocity + state.acceleration;
                assert!(sum.is_finite(), "{about}");
                furthest = furthest.max(state.position.abs());
            }
            // Times have digits of their own.
            let last = profile.at(profile.duration() * (1.0 - 1e-15));
            let scale = furthest + last.velocity.abs() * profile.duration();
            let off = (last.position - target).abs();
            assert!(off <= 1e-9 * scale, "{about}: {last:?}, {off:e} of {scale:e}");
        }
    }
}
