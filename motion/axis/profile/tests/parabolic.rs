//! Ramps of limited jerk.

use super::random::{Case, Random};
use super::{close, sampled};
use crate::axis::profile::{AxisLimits, Profile, RampType, State};

fn plan(case: &Case) -> Profile {
    let Case { from, target, end_velocity, limits } = *case;
    Profile::to_position(from, target, end_velocity, limits, RampType::Parabolic).unwrap()
}

/// The greatest value for a check: the limits for a velocity.
fn rate(limits: &AxisLimits, state: State) -> f64 {
    if state.velocity * state.acceleration > 0.0 { limits.acceleration } else { limits.deceleration }
}

fn keeps_everything(case: &Case, profile: &Profile) {
    let Case { from, target, end_velocity, limits } = *case;
    let scale = target.abs().max(from.position.abs()).max(limits.velocity * profile.duration());
    let begin = profile.at(0.0);
    assert!(close(begin.velocity, from.velocity) && close(begin.acceleration, from.acceleration), "{case:?} {begin:?}");
    let last = profile.at(profile.duration() * (1.0 - 1e-15));
    assert!((last.position - target).abs() <= 1e-9 * scale, "{case:?}: {last:?}");
    assert!((last.velocity - end_velocity).abs() <= 1e-7 * limits.velocity, "{case:?}: {last:?}");
    let mut before: Option<(f64, State)> = None;
    for (time, state) in sampled(profile, 200) {
        assert!(state.velocity.abs() <= limits.velocity * (1.0 + 1e-9), "{case:?} {time}: {state:?}");
        let free = state.velocity.abs() < 1e-6 * limits.velocity;
        let most = if free { limits.acceleration.max(limits.deceleration) } else { rate(&limits, state) };
        assert!(state.acceleration.abs() <= most * (1.0 + 1e-9), "{case:?} {time}: {state:?}");
        if let Some((earlier, previous)) = before {
            let step = time - earlier;
            assert!((state.acceleration - previous.acceleration).abs() <= limits.jerk * step * (1.0 + 1e-9) + 1e-7 * most, "{case:?} {time}");
            let mean = 0.5 * (state.acceleration + previous.acceleration);
            assert!((state.velocity - previous.velocity - mean * step).abs() <= 0.25 * limits.jerk * step * step * (1.0 + 1e-9) + 1e-7 * limits.velocity, "{case:?} {time}");
        }
        before = Some((time, state));
    }
}

#[test]
fn limits_and_ends_of_random_moves() {
    let mut random = Random(1);
    let mut count = 0;
    while count < 5000 {
        let case = Case::new(&mut random, true);
        if case.keeps_velocity() {
            keeps_everything(&case, &plan(&case));
            count += 1;
        }
    }
}
