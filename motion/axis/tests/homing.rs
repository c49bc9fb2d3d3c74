//! Tests of homing by the drive (manual 5.3).

use super::rig::{CYCLE, Rig, home, linear};
use crate::{AxisConfig, AxisState, Block, Home, Homing, SmcError};
use twin_profile::RampType;

/// A drive that reports its reference, 5 u, while it still goes back with 10 u/s.
fn found_in_motion(rig: &mut Rig, home: &mut Block<Home>) {
    rig.call(home, true);
    for way in [0.3, 0.2, 0.1] {
        let feedback = rig.drive.feedback_mut();
        (feedback.homing, feedback.position, feedback.velocity) = (Homing::Busy, 5.0 + way, -10.0);
        let shown = rig.call(home, true);
        assert!(shown.busy && !shown.done && shown.error.is_none(), "{shown:?}");
    }
    let feedback = rig.drive.feedback_mut();
    (feedback.homing, feedback.position, feedback.velocity) = (Homing::Done, 5.0, -10.0);
}

/// From 10 u/s with 20 u/s² it takes half a second and 2.5 u; with the other ramps longer, and no step of the velocity either.
#[test]
fn an_axis_that_still_moves_at_its_reference_is_brought_to_rest() {
    for ramp in [RampType::Trapezoid, RampType::Sigmoid, RampType::Parabolic] {
        let mut rig = Rig::new(AxisConfig { ramp, jerk: 100.0, ..AxisConfig::default() });
        let mut home = home(5.0, 20.0);
        found_in_motion(&mut rig, &mut home);
        let (mut before, mut cycles) = (-10.0, 0);
        loop {
            let shown = rig.call(&mut home, true);
            let velocity = rig.axis.set_velocity();
            assert!(
                (velocity - before).abs() <= 20.0 * CYCLE + 1e-9,
                "{ramp:?}: {before} {velocity}"
            );
            before = velocity;
            if shown.done {
                break;
            }
            assert!(shown.busy && shown.error.is_none(), "{shown:?}");
            assert_eq!(rig.axis.state(), AxisState::Homing);
            cycles += 1;
        }
        assert_eq!((rig.axis.state(), rig.axis.set_velocity()), (AxisState::Standstill, 0.0));
        let place = rig.axis.set_position();
        if ramp == RampType::Trapezoid {
            assert!(cycles == 50 && (place - 2.5).abs() < 1e-9, "{place} after {cycles} cycles");
        } else {
            assert!(cycles > 50 && place < 2.5, "{ramp:?}: {place} after {cycles} cycles");
        }
    }
}

/// "Is a deceleration defined?" (173, manual 9.3): an axis that has to stop without a deceleration.
#[test]
fn stopping_behind_homing_without_a_deceleration_is_173() {
    for deceleration in [0.0, -1.0, f64::NAN] {
        let (mut rig, mut block) = (linear(), home(5.0, deceleration));
        found_in_motion(&mut rig, &mut block);
        let shown = rig.call(&mut block, true);
        assert_eq!(shown.error.map(SmcError::number), Some(173));
        assert_eq!(rig.axis.state(), AxisState::ErrorStop);
        // With the drive at rest nothing has to stop.
        let mut rig = linear();
        rig.done(&mut home(5.0, deceleration));
        assert_eq!(rig.axis.set_position(), 5.0);
    }
}
