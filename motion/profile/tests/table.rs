//! Tests of profiles through the points of a table.

use super::*;

fn points(pairs: &[(f64, f64)]) -> Vec<ProfilePoint> {
    pairs.iter().map(|&(delta_time, value)| ProfilePoint { delta_time, value }).collect()
}

fn table(points: &[ProfilePoint]) -> ProfileTable<'_> {
    ProfileTable { points, absolute: true, scale: 1.0, offset: 0.0 }
}

const MOVING: State = State { position: 3.0, velocity: 2.0, acceleration: 5.0 };

#[test]
fn positions_are_twice_continuous() {
    let points = points(&[(0.5, 4.0), (1.0, 2.0), (0.25, 2.5), (2.0, -7.0)]);
    let profile = TableProfile::positions(MOVING, table(&points)).unwrap();
    assert!(close(profile.duration(), 3.75));
    assert!(close(profile.at(0.0).position, 3.0) && close(profile.at(0.0).velocity, 2.0));
    let mut time = 0.0;
    for point in &points {
        time += point.delta_time;
        assert!(close(profile.at(time).position, point.value), "{time}");
        if time < 3.7 {
            let (before, after) = (profile.at(time - 1e-9), profile.at(time + 1e-9));
            assert!((before.velocity - after.velocity).abs() < 1e-6);
            let step = (before.acceleration - after.acceleration).abs();
            assert!(step < 1e-6, "{before:?} {after:?}");
        }
    }
    let last = profile.at(3.75 - 1e-12);
    assert!((last.velocity).abs() < 1e-9, "{last:?}");
    assert_eq!(profile.at(5.0), State::resting(-7.0));
}

#[test]
fn a_cubic_is_met_everywhere() {
    // One interval is one Hermite polynomial: from (0, 2) to (10, 0) in 1 s.
    let points = points(&[(1.0, 10.0)]);
    let from = State { position: 0.0, velocity: 2.0, acceleration: 0.0 };
    let profile = TableProfile::positions(from, table(&points)).unwrap();
    for t in [0.1_f64, 0.5, 0.9] {
        let expected = 2.0 * (t.powi(3) - 2.0 * t * t + t) + 10.0 * (3.0 * t * t - 2.0 * t.powi(3));
        assert!(close(profile.at(t).position, expected), "{t}");
    }
}

#[test]
fn velocities_without_acceleration_at_the_points() {
    let points = points(&[(2.0, 6.0), (1.0, 6.0), (4.0, -2.0)]);
    let profile = TableProfile::velocities(MOVING, table(&points)).unwrap();
    for (time, velocity) in [(0.0, 2.0), (1.0, 4.0), (2.0, 6.0), (2.5, 6.0), (3.0, 6.0), (5.0, 2.0)]
    {
        assert!(close(profile.at(time).velocity, velocity), "{time}: {:?}", profile.at(time));
    }
    // A quarter of the way in time is an eighth of the change.
    assert!(close(profile.at(0.5).velocity, 2.5));
    for time in [0.0, 2.0, 3.0, 7.0 - 1e-12] {
        assert!(profile.at(time).acceleration.abs() < 1e-9, "{time}");
    }
    // Means by times: 4·2 + 6·1 + 2·4.
    assert!(close(profile.end().position, 3.0 + 22.0) && close(profile.end().velocity, -2.0));
    assert!(close(profile.at(8.0).position, 23.0));
}

#[test]
fn accelerations_in_lines() {
    let points = points(&[(1.0, 10.0), (2.0, 10.0), (1.0, 0.0)]);
    let from = State { acceleration: 0.0, ..MOVING };
    let profile = TableProfile::accelerations(from, table(&points)).unwrap();
    assert!(close(profile.end().velocity, 32.0) && close(profile.end().position, 3.0 + 8.0 + 60.0));
    assert!(close(profile.at(0.5).acceleration, 5.0));
    assert!(profile.at(9.0).acceleration.abs() < 1e-12);
}

#[test]
fn relative_scaled_and_moved() {
    let values = points(&[(1.0, 10.0), (1.0, 15.0)]);
    let given = ProfileTable { absolute: false, scale: 2.0, offset: 1.0, ..table(&values) };
    let profile = TableProfile::positions(MOVING, given).unwrap();
    assert!(close(profile.at(1.0).position, 3.0 + 21.0));
    assert!(close(profile.end().position, 3.0 + 31.0));
    let profile = TableProfile::velocities(MOVING, given).unwrap();
    assert!(close(profile.end().velocity, 2.0 + 31.0));
    let profile = TableProfile::accelerations(MOVING, given).unwrap();
    assert!(close(profile.at(1.0).acceleration, 5.0 + 21.0));
}

#[test]
fn tables_that_are_refused() {
    let refused = |pairs: &[(f64, f64)]| {
        TableProfile::positions(State::resting(0.0), table(&points(pairs))).map(|_| ())
    };
    assert_eq!(refused(&[]), Err(ProfileError::Points { count: 0, most: 100 }));
    assert_eq!(refused(&[(1.0, 0.0); 101]), Err(ProfileError::Points { count: 101, most: 100 }));
    assert_eq!(refused(&[(1.0, 0.0); 100]), Ok(()));
    let step = |point, step| Err(ProfileError::TimeStep { point, step });
    assert_eq!(refused(&[(1.0, 0.0), (0.0, 1.0)]), step(2, 0.0));
    assert_eq!(refused(&[(-1.0, 0.0)]), step(1, -1.0));
    let jump = ProfileError::Jump { quantity: "position", is: 0.0, asked: 1.0 };
    assert_eq!(refused(&[(0.0, 1.0)]), Err(jump));
    assert!(matches!(refused(&[(1.0, f64::NAN)]), Err(ProfileError::NotFinite { .. })));
    assert!(matches!(refused(&[(f64::INFINITY, 1.0)]), Err(ProfileError::NotFinite { .. })));
    // Only its first point, where the axis is: nothing to do.
    let here = points(&[(0.0, 0.0)]);
    let profile = TableProfile::positions(State::resting(0.0), table(&here)).unwrap();
    assert_eq!(profile.at(0.0), State::resting(0.0));
    let error = TableProfile::velocities(MOVING, table(&here)).unwrap_err();
    assert_eq!(error.to_string(), "the first point has the velocity 0, where the axis has 2");
}
