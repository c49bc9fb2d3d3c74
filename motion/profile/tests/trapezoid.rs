//! Tests of ramps of constant acceleration.

use super::*;
use proptest::prelude::*;

fn moving(position: f64, velocity: f64) -> State {
    State { position, velocity, acceleration: 0.0 }
}

fn plan(from: State, target: f64, end_velocity: f64, limits: AxisLimits) -> Profile {
    Profile::to_position(from, target, end_velocity, limits, RampType::Trapezoid).unwrap()
}

#[test]
fn rest_to_rest() {
    // L 100, v 20, a 40, d 80: the numbers of `ipo-trapezoid`.
    let profile = plan(State::resting(0.0), 100.0, 0.0, limits(20.0, 40.0, 80.0));
    assert!(close(profile.duration(), 5.375));
    for (time, position) in [(0.25, 1.25), (1.0, 15.0), (5.25, 99.375)] {
        assert!(close(profile.at(time).position, position), "{time}: {:?}", profile.at(time));
    }
    assert!(close(profile.at(5.3).acceleration, -80.0));
    // And backwards.
    let back = plan(State::resting(100.0), 0.0, 0.0, limits(20.0, 40.0, 80.0));
    for (time, state) in sampled(&profile, 100) {
        let mirror = back.at(time);
        assert!(close(mirror.position, 100.0 - state.position));
        assert!(close(mirror.velocity, -state.velocity));
    }
}

#[test]
fn the_end_velocity_has_a_direction() {
    // To 10 with −20 u/s: past it by 2 u, to rest, and back through it.
    let fall = 20.0 * 20.0 / 200.0;
    let profile = plan(State::resting(0.0), 10.0, -20.0, limits(1000.0, 100.0, 100.0));
    let top = sampled(&profile, 10_000).iter().map(|(_, s)| s.position).fold(0.0, f64::max);
    assert!((top - 10.0 - fall).abs() < 1e-4, "{top}");
    assert!(close(profile.end().velocity, -20.0));
    // On with it for ever.
    let later = profile.at(profile.duration() + 3.0);
    assert!(close(later.position, 10.0 - 60.0) && close(later.velocity, -20.0));
    // Onto the place where it stands with a velocity: backs up by the run-up first.
    let profile = plan(State::resting(5.0), 5.0, 20.0, limits(1000.0, 100.0, 100.0));
    let least = sampled(&profile, 10_000).iter().map(|(_, s)| s.position).fold(5.0, f64::min);
    assert!((least - 3.0).abs() < 1e-4, "{least}");
}

#[test]
fn short_ways_from_motion() {
    // Faster than the limit: it brakes first.
    let profile = plan(moving(0.0, 50.0), 1000.0, 0.0, limits(20.0, 10.0, 30.0));
    assert!(close(profile.at(1.0).velocity, 20.0));
    assert!(close(profile.at(1.0).position, 35.0));
    assert!(close(profile.at(2.0).position, 55.0));
    // 10 u to go and 50 u to brake: to rest after 1 s, back over 40 u in 2·√(40/100) s.
    let profile = plan(moving(0.0, 100.0), 10.0, 0.0, limits(1000.0, 100.0, 100.0));
    assert!(close(profile.duration(), 1.0 + 2.0 * 0.4_f64.sqrt()));
    assert!(close(profile.at(1.0).position, 50.0));
    assert_eq!(profile.at(9.0), State::resting(10.0));
    // Nothing to do, and only to brake.
    let profile = plan(State::resting(3.0), 3.0, 0.0, limits(1.0, 1.0, 1.0));
    assert!(profile.duration() == 0.0 && profile.at(0.0) == State::resting(3.0));
    let straight = plan(moving(0.0, 10.0), 5.0, 0.0, limits(20.0, 10.0, 10.0));
    assert!(close(straight.duration(), 1.0));
}

#[test]
fn to_a_velocity_and_to_rest() {
    let limits = limits(100.0, 20.0, 40.0);
    let turn = Profile::to_velocity(moving(7.0, -40.0), 60.0, limits, RampType::Trapezoid).unwrap();
    assert!(close(turn.duration(), 1.0 + 3.0));
    assert!(close(turn.end().position, 7.0 - 20.0 + 90.0));
    assert!(close(turn.at(5.0).position, 77.0 + 60.0));
    let halt = Profile::halt(moving(0.0, -40.0), limits, RampType::Trapezoid).unwrap();
    assert_eq!(halt.at(10.0), State::resting(-20.0));
}

/// Half a minute of braking and minutes of creeping before the last turn, in a hundredth of a second.
#[test]
fn a_slow_way_ends_with_a_sharp_turn() {
    let (v0, limits) = (19.725_996_891_344_263, limits(1.0, 86.036, 1.0));
    for (target, end_velocity) in [(-71.627, 0.694_867), (1.5, 1.0), (90.0, -1.0), (0.0, 0.0)] {
        let profile = plan(moving(1.5, v0), target, end_velocity, limits);
        ends_at(&profile, target, end_velocity).unwrap();
        // To rest; the other way up to the limit and along; and where it turns again, to rest and up to the end.
        let (far, up) = (1.5 + 0.5 * v0 * v0, 1.0 / 86.036);
        let along = far - target - 0.5 * up;
        let rest = if end_velocity < 0.0 {
            along
        } else {
            along + 0.5 * end_velocity * end_velocity * up - 0.5 + 1.0 + end_velocity * up
        };
        let time = v0 + up + rest;
        assert!((profile.duration() - time).abs() < 1e-9 * time, "{} {time}", profile.duration());
    }
}

/// Just before its end a profile is what the last constant acceleration leads from to the end.
fn ends_at(profile: &Profile, target: f64, end_velocity: f64) -> Result<(), String> {
    let time = profile.duration() * (1.0 - 1e-12);
    let (last, left) = (profile.at(time), profile.duration() - time);
    let velocity = last.velocity + last.acceleration * left;
    let position = last.position + 0.5 * (last.velocity + velocity) * left;
    if (position - target).abs() < 1e-9 && (velocity - end_velocity).abs() < 1e-9 {
        Ok(())
    } else {
        Err(format!("{last:?} {left} s before {target} with {end_velocity}"))
    }
}

prop_compose! {
    fn cases()(
        v0 in -30.0..30.0_f64, v1 in -1.0..1.0_f64, way in -100.0..100.0_f64, most in 1.0..40.0_f64,
        up in 1.0..100.0_f64, down in 1.0..100.0_f64,
    ) -> (State, f64, f64, AxisLimits) {
        (moving(1.5, v0), 1.5 + way, v1 * most, limits(most, up, down))
    }
}

/// The least time by bisection over the furthest places that can be reached in a time, from an own simulation: within
/// the limits, greedily up and in time down.
fn furthest(v0: f64, v1: f64, limits: AxisLimits, time: f64) -> Option<f64> {
    // Times to velocities: piecewise linear, 0 at standstill, as the speed grows or falls.
    let AxisLimits { velocity, acceleration, deceleration, .. } = limits;
    let up = |v: f64| if v < 0.0 { v / deceleration } else { v / acceleration };
    let down = |v: f64| if v < 0.0 { v / acceleration } else { v / deceleration };
    let of_up = |t: f64| if t < 0.0 { t * deceleration } else { t * acceleration };
    let of_down = |t: f64| if t < 0.0 { t * acceleration } else { t * deceleration };
    let count = 4000;
    let mut way = 0.0;
    let step = time / f64::from(count);
    for index in 0..count {
        let now = (f64::from(index) + 0.5) * step;
        let rising = of_up(up(v0) + now);
        let falling = of_down(down(v1) + time - now);
        way += rising.min(falling).min(velocity) * step;
    }
    let reachable = of_up(up(v0) + time) >= v1 && of_down(down(v1) + time) >= v0;
    reachable.then_some(way)
}

proptest! {
    #[test]
    fn limits_ends_and_continuity((from, target, end_velocity, limits) in cases()) {
        let profile = plan(from, target, end_velocity, limits);
        prop_assert!(close(profile.at(0.0).velocity, from.velocity));
        ends_at(&profile, target, end_velocity).map_err(TestCaseError::fail)?;
        let (mut earlier, mut previous) = (0.0, profile.at(0.0));
        let mut within = from.velocity.abs() <= limits.velocity;
        for (time, state) in sampled(&profile, 500) {
            let speed = state.velocity.abs();
            within |= speed <= limits.velocity;
            prop_assert!(!within || speed <= limits.velocity * (1.0 + 1e-12), "{time} {state:?}");
            let most = rate(&limits, state);
            let turning = speed < 1e-9;
            prop_assert!(turning || state.acceleration.abs() <= most * (1.0 + 1e-12), "{time} {state:?}");
            let largest = limits.acceleration.max(limits.deceleration);
            let step = time - earlier;
            prop_assert!((state.velocity - previous.velocity).abs() <= largest * step + 1e-9);
            let mean = 0.5 * (state.velocity + previous.velocity);
            prop_assert!((state.position - previous.position - mean * step).abs() <= largest * step * step + 1e-9);
            (earlier, previous) = (time, state);
        }
    }

    #[test]
    fn as_fast_as_can_be((from, target, end_velocity, limits) in cases()) {
        prop_assume!(from.velocity.abs() <= limits.velocity);
        let way = target - from.position;
        let profile = plan(from, target, end_velocity, limits);
        // Neither the furthest nor, mirrored, the nearest place of a shorter time lies on the other side of the target.
        for part in [0.3, 0.6, 0.8, 0.9, 0.98] {
            let time = part * profile.duration();
            let most = furthest(from.velocity, end_velocity, limits, time);
            let least = furthest(-from.velocity, -end_velocity, limits, time);
            if let (Some(most), Some(least)) = (most, least) {
                prop_assert!(!(-least + 1e-3 < way && way < most - 1e-3), "{part}: {least} {way} {most}");
            }
        }
    }
}
