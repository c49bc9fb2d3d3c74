//! Motion of single axes (manual 2.1.3, 5.3).

use super::vector::{Vector, check};
use twin_profile::{
    AxisLimits, Profile, ProfilePoint, ProfileTable, RampType, State, TableProfile,
};

#[test]
pub(crate) fn ramps() {
    check("axis-ramps", |vector| {
        let (changes, jerks) = (vector.numbers("dv"), vector.numbers("j"));
        let rate = vector.number("a");
        let ramp = |index: usize, ramp: RampType| {
            let (velocity, jerk) = (changes[index], jerks[index]);
            let limits = AxisLimits { velocity, acceleration: rate, deceleration: rate, jerk };
            Profile::to_velocity(State::resting(0.0), velocity, limits, ramp).expect("a ramp")
        };
        let parabolic = ramp(0, RampType::Parabolic);
        vector.expect("parabolic/T", [parabolic.duration()]);
        vector.expect("parabolic/dist", [parabolic.end().position]);
        // The middle of a ramp is where its acceleration peaks, its beginning where a sine's jerk does.
        let peak = |profile: &Profile| profile.at(0.5 * profile.duration()).acceleration;
        let jerk = |profile: &Profile| profile.at(1e-6).acceleration / 1e-6;
        let short = ramp(1, RampType::Parabolic);
        vector.expect("parabolic_short/T", [short.duration()]);
        vector.expect("parabolic_short/peak_a", [peak(&short)]);
        for (index, name) in [(2, "sin2"), (3, "sin2_acc")] {
            let sine = ramp(index, RampType::Sigmoid);
            vector.expect(&format!("{name}/T"), [sine.duration()]);
            vector.expect(&format!("{name}/peak_a"), [peak(&sine)]);
            vector.expect(&format!("{name}/peak_j"), [jerk(&sine)]);
        }
    });
}

/// The vector's table, with times since the point before.
fn points(vector: &Vector, values: &str) -> Vec<ProfilePoint> {
    let times = vector.numbers("t");
    let before = [0.0].into_iter().chain(times.iter().copied());
    let steps = times.iter().zip(before).map(|(time, before)| time - before);
    let values = vector.numbers(values);
    assert_eq!(values.len(), times.len());
    steps.zip(values).map(|(delta_time, value)| ProfilePoint { delta_time, value }).collect()
}

fn table(points: &[ProfilePoint]) -> ProfileTable<'_> {
    ProfileTable { points, absolute: true, scale: 1.0, offset: 0.0 }
}

#[test]
pub(crate) fn position_profile() {
    check("axis-position-profile", |vector| {
        let points = points(vector, "p");
        let profile =
            TableProfile::positions(State::resting(0.0), table(&points)).expect("a profile");
        vector.expect("v_at_1", [profile.at(1.0).velocity]);
        vector.expect("p_at_0_5", [profile.at(0.5).position]);
        vector.expect("p_at_1_5", [profile.at(1.5).position]);
    });
}

#[test]
pub(crate) fn acceleration_profile() {
    check("axis-acceleration-profile", |vector| {
        let points = points(vector, "a");
        let profile =
            TableProfile::accelerations(State::resting(0.0), table(&points)).expect("a profile");
        vector.expect("v_end", [profile.end().velocity]);
        vector.expect("p_end", [profile.end().position]);
    });
}
