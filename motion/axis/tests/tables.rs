//! Motion through the points of a table (manual 5.3).

use super::rig::{CYCLE, linear};
use crate::axis::profile::ProfilePoint;
use crate::axis::{
    AccelerationProfile, AxisState, Block, Points, PositionProfile, SmcError, VelocityProfile,
};

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
