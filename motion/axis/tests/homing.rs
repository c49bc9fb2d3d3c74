//! Tests of homing by the drive (manual 5.3).

use super::*;

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
        let mut before = -10.0;
        let cycles = rig.until(|axis| {
            let (shown, velocity) = (home.call(true, axis), axis.set_velocity());
            let change = (velocity - before).abs();
            assert!(change <= 20.0 * CYCLE + 1e-9, "{ramp:?}: {before} {velocity}");
            before = velocity;
            let busy = (shown.busy, shown.error, axis.state()) == (true, None, AxisState::Homing);
            assert!(shown.done || busy, "{shown:?}");
            shown.done
        });
        assert_eq!((rig.axis.state(), rig.axis.set_velocity()), (AxisState::Standstill, 0.0));
        let place = rig.axis.set_position();
        if ramp == RampType::Trapezoid {
            assert!(cycles == 51 && (place - 2.5).abs() < 1e-9, "{place} after {cycles} cycles");
        } else {
            assert!(cycles > 51 && place < 2.5, "{ramp:?}: {place} after {cycles} cycles");
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

#[test]
fn the_drive_homes_itself() {
    let (mut rig, mut homing) = (linear().at(3.0), home(-7.0, 0.0));
    rig.call(&mut homing, true);
    assert_eq!((rig.axis.state(), rig.axis.home), (AxisState::Homing, Some(-7.0)));
    // Begun again it goes on to its end.
    rig.call(&mut homing, false);
    let count = rig.until(|axis| {
        let shown = homing.call(true, axis);
        assert_eq!((shown.error, shown.command_aborted), (None, false), "{shown:?}");
        shown.done
    });
    assert!(count < 100, "{count}");
    assert_eq!((rig.axis.set_position(), rig.axis.act_position()), (-7.0, -7.0));
    assert_eq!(rig.axis.home, None);
    // Not from motion.
    let mut moving = endless(5.0);
    rig.call(&mut moving, true);
    let shown = rig.cycle(|axis| [moving.call(true, axis), home(0.0, 0.0).call(true, axis)]);
    assert_eq!(shown[1].error, Some(SmcError::HAxisWasntStandstill));
}

/// By the drive's answers: the number of calls, the error of the block, and that of the axis.
#[test]
fn a_drive_that_does_not_home_is_an_error() {
    type Answer = fn(&mut Feedback);
    let rows: [(&str, Answer, u32, SmcError, i64); 4] = [
        ("idle", |it| it.homing = Homing::Idle, 101, SmcError::HAxisDidntStartHoming, 171),
        ("no stop", |it| it.homing = Homing::StopFailed, 2, SmcError::HErrorWhenStopping, 173),
        ("silence", |it| it.communicating = false, 2, SmcError::HAxisDidntAnswer, 1),
        ("an error", |it| it.error = Some(9), 2, SmcError::DiGeneralCommunicationError, 9),
    ];
    for (name, answer, calls, error, of_axis) in rows {
        let (mut rig, mut block) = (linear(), home(5.0, 0.0));
        let (count, shown) = rig.fails(&mut block, |rig| {
            rig.drive.feedback_mut().homing = Homing::Busy;
            answer(rig.drive.feedback_mut());
        });
        assert_eq!((count, shown.error), (calls, Some(error)), "{name}");
        let state = (rig.axis.state(), rig.axis.error_id());
        assert_eq!(state, (AxisState::ErrorStop, Some(of_axis)), "{name}");
    }
}

#[test]
fn homing_that_is_left_off_does_not_go_back() {
    let mut rig = linear();
    rig.drive.feedback_mut().position = 33.0;
    for power in [false, true] {
        rig.power.regulator_on = power;
        rig.run(2, |_| ());
    }
    rig.call(&mut home(5.0, 0.0), true);
    // The drive counts from its reference by now: 33 is 5. The program does not call the block any more.
    rig.cycle(|_| ());
    assert_eq!((rig.axis.state(), rig.axis.error_id()), (AxisState::ErrorStop, Some(30)));
    assert_eq!((rig.axis.set_position(), rig.drive.feedback().position), (5.0, 5.0));
}
