//! Tests of the trapezoidal profile.

use super::program::magnitude;
use crate::controller::profile::{Limits, Profile};
use proptest::prelude::*;

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance
}

/// Vector `ipo-trapezoid`: L=100 F=20 E40 E−80 from rest to rest.
#[test]
fn ipo_trapezoid() {
    let limits = Limits { feed: 0.02, acceleration: 0.04, deceleration: 0.08 };
    let profile = Profile::new(0.1, 0.0, 0.0, limits);
    for (found, expected) in profile.phases().into_iter().zip([0.5, 4.625, 0.25]) {
        assert!(close(found, expected, 1e-12), "{found} is not {expected}");
    }
    assert!(close(profile.duration(), 5.375, 1e-12));
    for (time, position_mm) in
        [(0.25, 1.25), (1.0, 15.0), (5.25, 99.375), (5.375, 100.0), (9.0, 100.0)]
    {
        let position = profile.at(time).position;
        assert!(close(1e3 * position, position_mm, 1e-11), "{position} at {time}");
    }
    assert_eq!(profile.at(0.25).acceleration, 0.04);
    assert_eq!(profile.at(1.0).acceleration, 0.0);
    assert_eq!(profile.at(5.25).acceleration, -0.08);
    assert!(close(profile.at(5.25).velocity, 0.01, 1e-14));
}

/// Vector `ipo-triangle`: L=5, F=20 is never reached.
#[test]
fn ipo_triangle() {
    let limits = Limits { feed: 0.02, acceleration: 0.04, deceleration: 0.08 };
    let profile = Profile::new(0.005, 0.0, 0.0, limits);
    assert!(close(1e3 * profile.peak_velocity(), 16.329_931_619, 1e-8));
    assert!(close(profile.duration(), 0.612_372_436, 1e-8));
}

#[test]
fn constant_velocity_has_one_phase() {
    let limits = Limits { feed: 0.02, acceleration: 0.04, deceleration: 0.08 };
    let profile = Profile::new(0.1, 0.02, 0.02, limits);
    assert_eq!(profile.phases(), [0.0, 5.0, 0.0]);
    assert_eq!(profile.at(2.5).position, 0.05);
}

#[test]
fn one_ramp_over_the_whole_length_has_one_phase() {
    // 2·0.5·0.01 = 0.1².
    let limits = Limits { feed: 1.0, acceleration: 0.5, deceleration: 0.5 };
    let up = Profile::new(0.01, 0.0, 0.1, limits);
    assert!(close(up.duration(), 0.2, 1e-15));
    assert!(close(up.peak_velocity(), 0.1, 1e-15));
    let down = Profile::new(0.01, 0.1, 0.0, limits);
    assert!(close(down.duration(), 0.2, 1e-15));
    assert!(close(down.at(0.1).position, 0.0075, 1e-15));
}

#[test]
fn nothing_to_travel_takes_no_time() {
    let limits = Limits { feed: 1.0, acceleration: 0.5, deceleration: 0.5 };
    for velocity in [0.0, 0.3, 1.0] {
        let profile = Profile::new(0.0, velocity, velocity, limits);
        assert_eq!(profile.duration(), 0.0);
        assert_eq!((profile.at(0.0).position, profile.at(0.0).velocity), (0.0, velocity));
    }
}

#[test]
fn a_rounding_out_of_reach_is_taken_for_reachable() {
    let limits = Limits { feed: 1e3, acceleration: 1.0, deceleration: 1.0 };
    for (start, end) in [(1e3, 1e3 - 2e-13), (1e3 - 2e-13, 1e3)] {
        let profile = Profile::new(1e-12, start, end, limits);
        assert!(profile.duration() > 0.0 && profile.duration() < 2e-15);
        assert_eq!(profile.at(1.0).position, 1e-12);
        assert_eq!(profile.at(1.0).velocity, end);
        assert!(profile.at(0.0).velocity <= start.max(end));
    }
}

#[test]
fn braking_to_rest_takes_the_time_of_the_textbook() {
    let stop = Profile::braking(0.04, 0.2, 0.0, 0.5);
    assert!(close(stop.duration(), 0.4, 1e-15));
    assert!(close(stop.at(0.2).position, 0.03, 1e-15));
    assert!(close(stop.at(0.2).velocity, 0.1, 1e-15));
    assert_eq!(stop.at(0.2).acceleration, -0.5);
}

prop_compose! {
    /// Length, limits and two velocities within reach of each other.
    fn profiles()(
        length in magnitude(-12.0..6.0),
        feed in magnitude(-9.0..3.0),
        acceleration in magnitude(-3.0..3.0),
        deceleration in magnitude(-3.0..3.0),
        start in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0],
        end in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0],
    ) -> (f64, f64, f64, Limits) {
        let start_velocity = start * feed;
        let start_v2 = start_velocity * start_velocity;
        let least = (start_v2 - 2.0 * deceleration * length).max(0.0).sqrt();
        let most = (start_v2 + 2.0 * acceleration * length).sqrt().min(feed);
        let end_velocity = (least + end * (most - least)).min(feed);
        (length, start_velocity, end_velocity, Limits { feed, acceleration, deceleration })
    }
}

proptest! {
    /// Integrating the accelerations over the phases gives length and end velocity back.
    #[test]
    fn accelerations_integrate_to_length_and_end_velocity((length, start, end, limits) in profiles()) {
        let profile = Profile::new(length, start, end, limits);
        let [rise, cruise, fall] = profile.phases();
        prop_assert!(rise >= 0.0 && cruise >= 0.0 && fall >= 0.0 && profile.duration().is_finite());
        let Limits { feed, acceleration, deceleration } = limits;
        let peak = start + acceleration * rise;
        let last = peak - deceleration * fall;
        let travelled = 0.5 * (start + peak) * rise + peak * cruise + 0.5 * (peak + last) * fall;
        prop_assert!(close(travelled, length, 1e-11 * length), "{travelled} m of {length} m, {profile:?}");
        prop_assert!(close(last, end, 1e-11 * peak), "{last} m/s instead of {end} m/s, {profile:?}");
        prop_assert!(profile.peak_velocity() <= feed);
        prop_assert_eq!(profile.at(profile.duration()).position, length);
        prop_assert_eq!(profile.at(profile.duration()).velocity, end);
    }

    /// Nothing faster would do: it cruises at the feed or not at all.
    #[test]
    fn profiles_are_the_fastest((length, start, end, limits) in profiles()) {
        let profile = Profile::new(length, start, end, limits);
        let [_, cruise, _] = profile.phases();
        prop_assert!(profile.peak_velocity() == limits.feed || cruise <= 1e-12 * profile.duration());
    }

    /// Sampled states fit together: v is the derivative of s, within the limits.
    #[test]
    fn states_are_continuous((length, start, end, limits) in profiles()) {
        let profile = Profile::new(length, start, end, limits);
        let step = profile.duration() / 1000.0;
        let rate = limits.acceleration.max(limits.deceleration);
        let mut last = profile.at(0.0);
        prop_assert!(close(last.velocity, start, 1e-12 * start));
        for n in 1..=1000 {
            let state = profile.at(f64::from(n) * step);
            prop_assert!(state.velocity >= 0.0 && state.velocity <= limits.feed);
            prop_assert!(state.acceleration <= limits.acceleration);
            prop_assert!(-state.acceleration <= limits.deceleration);
            let change = (state.velocity - last.velocity).abs();
            prop_assert!(change <= rate * step * (1.0 + 1e-9) + 1e-12 * limits.feed, "{change} in {step}");
            let moved = state.position - last.position;
            let expected = 0.5 * (state.velocity + last.velocity) * step;
            let tolerance = 0.25 * rate * step * step + 1e-12 * length;
            prop_assert!(close(moved, expected, tolerance), "{moved} m, expected {expected} m");
            last = state;
        }
    }
}
