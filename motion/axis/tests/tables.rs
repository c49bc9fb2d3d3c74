//! Tests of motion through the points of a table (manual 5.3).

use super::invariants::Random;
use super::rig::{CYCLE, linear, rotary};
use crate::{
    AccelerationProfile, AxisState, Block, Points, PositionProfile, SmcError, VelocityProfile,
};
use twin_profile::ProfilePoint;

fn points(points: &[(f64, f64)]) -> Points {
    let point = |&(delta_time, value): &(f64, f64)| ProfilePoint { delta_time, value };
    Points::new(points.iter().map(point).collect())
}

#[test]
fn a_position_profile_goes_through_its_points() {
    let mut rig = linear();
    rig.axis.shift_zero(100.0, false).expect("a number");
    let mut table = points(&[(1.0, 10.0), (1.0, 15.0), (5.0, 99.0)]);
    (table.array_size, table.offset) = (2, 100.0);
    let mut block = Block::new(PositionProfile(table));
    let mut count = 0;
    rig.until(|axis| {
        let done = block.call(true, axis).done;
        count += 1;
        if count == 50 {
            // Worked in the vector axis-position-profile.
            assert!((axis.set_position() - 103.59375).abs() < 1e-9);
        }
        done
    });
    assert_eq!(f64::from(count) * CYCLE, 2.0);
    assert!((rig.axis.set_position() - 115.0).abs() < 1e-12);
    assert_eq!((rig.axis.set_velocity(), rig.axis.state()), (0.0, AxisState::Standstill));
}

#[test]
fn velocity_and_acceleration_profiles_are_integrated() {
    let mut rig = linear();
    let mut block = Block::new(VelocityProfile(points(&[(1.0, 10.0), (1.0, 0.0)])));
    rig.until(|axis| block.call(true, axis).done);
    // Two parabolas each way, mean velocity 5 u/s.
    assert!((rig.axis.set_position() - 10.0).abs() < 1e-9);
    assert_eq!(rig.axis.state(), AxisState::Standstill);
    let mut block = Block::new(AccelerationProfile(points(&[
        (0.0, 0.0),
        (1.0, 10.0),
        (2.0, 10.0),
        (1.0, 0.0),
    ])));
    rig.until(|axis| block.call(true, axis).done);
    // The vector axis-acceleration-profile; it goes on with 30 u/s.
    assert!((rig.axis.set_position() - 70.0).abs() < 1e-9);
    assert_eq!(rig.axis.state(), AxisState::ContinuousMotion);
    rig.cycle(|axis| block.call(true, axis));
    assert!((rig.axis.set_position() - 70.0 - 30.0 * CYCLE).abs() < 1e-9);
}

/// What goes up and comes down by the same ends at rest, though the sum of its parts is rounded.
#[test]
fn profiles_that_cancel_out_end_at_rest() {
    let mut random = Random(5);
    for _ in 0..300 {
        let mut rig = linear();
        let steps: Vec<_> = (0..3).map(|_| random.between(0.05, 0.4)).collect();
        let [up, flat, down] =
            [steps[0], steps[1], steps[2]].map(|step| (step * 1e3).round() * 1e-3);
        let rate = (random.between(1.0, 20.0) * 10.0).round() * 0.1;
        let there = [(up, rate), (flat, rate), (down, 0.0)];
        let back = there.map(|(step, rate)| (step, -rate));
        let mut block = Block::new(AccelerationProfile(points(&[there, back].concat())));
        rig.until(|axis| block.call(true, axis).done);
        assert_eq!((rig.axis.set_velocity(), rig.axis.state()), (0.0, AxisState::Standstill));
        // The trapezoid's area, twice; each half takes its whole time with the mean velocity that symmetry gives it.
        let velocity = rate * (0.5 * (up + down) + flat);
        let gained = velocity * (up + flat + down);
        assert!((rig.axis.set_position() - gained).abs() < 1e-9, "{there:?}");
        // A last velocity of 0 once it is scaled: 0.1 of 10·v, and an offset of −v.
        let v = rate;
        let mut table = points(&[(up, 500.0), (down, 10.0 * v)]);
        (table.scale, table.offset) = (0.1, -v);
        let mut block = Block::new(VelocityProfile(table));
        rig.until(|axis| block.call(true, axis).done);
        assert_eq!((rig.axis.set_velocity(), rig.axis.state()), (0.0, AxisState::Standstill));
    }
}

/// Positions of a rotary axis: where it stands a hair before the end of its period is 0, and a first point says which of the
/// same places is meant.
#[test]
fn a_profile_of_a_rotary_axis_begins_where_it_stands() {
    let stands = |place: f64| {
        let mut rig = rotary();
        let mut there = super::framework::to(place);
        rig.until(|axis| there.call(true, axis).done);
        rig
    };
    let hair = 360.0 - 6e-14;
    for (place, table, way) in [
        (hair, points(&[(1.0, 10.0)]), 10.0),
        (hair, points(&[(0.0, 0.0), (1.0, 10.0)]), 10.0),
        (hair, points(&[(0.0, 360.0), (1.0, 350.0)]), -10.0),
        (0.0, points(&[(0.0, 360.0), (1.0, 350.0)]), -10.0),
        (0.0, points(&[(1.0, 350.0)]), 350.0),
        (350.0, points(&[(1.0, 10.0)]), -340.0),
        (350.0, points(&[(0.0, -10.0), (1.0, 10.0)]), 20.0),
    ] {
        let mut rig = stands(place);
        let mut block = Block::new(PositionProfile(table.clone()));
        let (mut travelled, mut last) = (0.0, rig.axis.total().position);
        rig.until(|axis| {
            let done = block.call(true, axis).done;
            let way = axis.total().position - last;
            travelled += way - 360.0 * (way / 360.0).round();
            last = axis.total().position;
            done
        });
        assert!((travelled - way).abs() < 1e-9, "{place} {table:?}: {travelled}");
    }
}

/// One point is enough; one without time says where the motion begins, and nothing more.
#[test]
fn tables_of_one_point() {
    let mut rig = linear();
    let mut block = Block::new(PositionProfile(points(&[(2.0, 8.0)])));
    let mut fastest = 0.0_f64;
    let count = rig.until(|axis| {
        let done = block.call(true, axis).done;
        fastest = fastest.max(axis.set_velocity());
        done
    });
    // A cubic between rests: 3/2 of the mean velocity in the middle.
    assert_eq!((count, rig.axis.set_position()), (200, 8.0));
    assert!((fastest - 6.0).abs() < 1e-9, "{fastest}");
    // To 10 u/s in 1 s by two parabolas: 5 u; with an acceleration that grows to 10 u/s²: 10/6 u and 5 u/s.
    let mut rig = linear();
    let mut block = Block::new(VelocityProfile(points(&[(1.0, 10.0)])));
    assert_eq!(rig.until(|axis| block.call(true, axis).done), 100);
    assert!((rig.axis.set_position() - 5.0).abs() < 1e-9);
    assert_eq!(rig.axis.set_velocity(), 10.0);
    let mut rig = linear();
    let mut block = Block::new(AccelerationProfile(points(&[(1.0, 10.0)])));
    assert_eq!(rig.until(|axis| block.call(true, axis).done), 100);
    assert!((rig.axis.set_position() - 10.0 / 6.0).abs() < 1e-9);
    assert!((rig.axis.set_velocity() - 5.0).abs() < 1e-9);
    // At once, where it begins; elsewhere there is no way without time.
    let mut rig = linear();
    let at = |value| points(&[(0.0, value)]);
    let shown = rig.cycle(|axis| {
        [
            Block::new(PositionProfile(at(0.0))).call(true, axis),
            Block::new(VelocityProfile(at(0.0))).call(true, axis),
            Block::new(PositionProfile(at(1.0))).call(true, axis),
            Block::new(VelocityProfile(at(1.0))).call(true, axis),
        ]
    });
    assert_eq!(shown.map(|shown| shown.done), [true, true, false, false]);
    let errors = [None, None, Some(SmcError::PpStep0ms), Some(SmcError::VpStep0ms)];
    assert_eq!(shown.map(|shown| shown.error), errors);
}

#[test]
fn tables_that_are_none_are_refused() {
    let mut rig = linear();
    let mut too_few = points(&[(1.0, 10.0)]);
    too_few.array_size = 2;
    let none = points(&[]);
    let too_many = points(&[(1.0, 1.0); 101]);
    let no_time = points(&[(1.0, 10.0), (0.0, 20.0)]);
    for (table, sizes) in [(too_few, true), (none, true), (too_many, true), (no_time, false)] {
        let shown = rig.cycle(|axis| {
            [
                Block::new(PositionProfile(table.clone())).call(true, axis).error,
                Block::new(VelocityProfile(table.clone())).call(true, axis).error,
                Block::new(AccelerationProfile(table.clone())).call(true, axis).error,
            ]
        });
        let expected = if sizes {
            [SmcError::PpArraysize, SmcError::VpArraysize, SmcError::ApArraysize]
        } else {
            [SmcError::PpStep0ms, SmcError::VpStep0ms, SmcError::ApStep0ms]
        };
        assert_eq!(shown, expected.map(Some), "{table:?}");
    }
}
