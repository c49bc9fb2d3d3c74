//! Tests with limits of a million different proportions: every profile is finite and reaches its end.

use super::random::Random;
use crate::{AxisLimits, Profile, ProfileError, RampType, State};

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
                assert!(
                    (state.position + state.velocity + state.acceleration).is_finite(),
                    "{about}"
                );
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
