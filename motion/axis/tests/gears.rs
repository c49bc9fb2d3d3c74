//! Tests of gears and phasing (manual 5.4).

use super::blocks::endless;
use super::framework::to;
use super::rig::{CYCLE, Rig, linear, rotary};
use crate::{
    AxisConfig, AxisState, Block, Decouple, GearIn, GearInPos, GearInPosRun, Movement, Outputs,
    Phasing, SmcError,
};

/// One cycle of a master and its slave.
pub(super) fn pair<T>(
    master: &mut Rig,
    slave: &mut Rig,
    lead: impl FnOnce(&mut crate::Axis),
    follow: impl FnOnce(&crate::Axis, &mut crate::Axis) -> T,
) -> T {
    master.cycle(lead);
    slave.cycle(|axis| follow(&master.axis, axis))
}

pub(super) fn gear(ratio_numerator: i32, ratio_denominator: u32) -> Block<GearIn> {
    Block::new(GearIn {
        ratio_numerator,
        ratio_denominator,
        acceleration: 50.0,
        deceleration: 50.0,
    })
}

#[test]
fn a_gear_couples_velocities() {
    let (mut master, mut slave) = (linear(), linear());
    let (mut lead, mut block) = (endless(10.0), gear(-3, 2));
    for _ in 0..20 {
        master.cycle(|axis| lead.call(true, axis));
    }
    let mut count = 0;
    loop {
        let shown = pair(
            &mut master,
            &mut slave,
            |axis| _ = lead.call(true, axis),
            |master, axis| block.follow(true, master, axis),
        );
        count += 1;
        assert!(slave.axis.set_acceleration().abs() <= 50.0 + 1e-9);
        if shown.done {
            break;
        }
    }
    // −15 u/s with 50 u/s² take 0.3 s.
    assert_eq!(count, 30);
    assert!((slave.axis.set_velocity() + 15.0).abs() < 1e-9);
    assert_eq!(slave.axis.state(), AxisState::SynchronizedMotion);
    let (before, at) = (master.axis.set_position(), slave.axis.set_position());
    // In gear the ways are exactly in the ratio, whatever the master does.
    let mut back = to(0.0);
    for _ in 0..100 {
        let shown = pair(
            &mut master,
            &mut slave,
            |axis| _ = back.call(true, axis),
            |master, axis| block.follow(true, master, axis),
        );
        assert!(shown.done);
        let ways = [master.axis.set_position() - before, slave.axis.set_position() - at];
        assert!((ways[1] + 1.5 * ways[0]).abs() < 1e-9, "{ways:?}");
    }
}

#[test]
fn a_gear_follows_actual_values_of_a_master_without_power() {
    let (mut master, mut slave) = (linear(), linear());
    master.power.regulator_on = false;
    let mut block = gear(2, 1);
    let mut turned = 0.0;
    let mut shown = Outputs::default();
    for _ in 0..100 {
        turned += 0.05;
        master.drive.feedback_mut().position = turned;
        master.drive.feedback_mut().velocity = 5.0;
        master.axis.begin_cycle(&master.drive.feedback());
        master.power.call(true, &mut master.axis);
        shown = slave.cycle(|axis| block.follow(true, &master.axis, axis));
    }
    assert!(shown.done);
    assert!((slave.axis.set_velocity() - 10.0).abs() < 1e-9);
}

#[test]
fn gears_refuse_wrong_inputs() {
    let (master, mut slave) = (linear(), linear());
    let mut error = |inputs: GearIn| {
        slave.cycle(|axis| Block::new(inputs).follow(true, &master.axis, axis)).error
    };
    let good = gear(1, 1).inputs;
    assert_eq!(error(GearIn { ratio_denominator: 0, ..good }), Some(SmcError::GiRatioDenom));
    assert_eq!(error(GearIn { acceleration: 0.0, ..good }), Some(SmcError::GiInvalidAcc));
    assert_eq!(error(GearIn { deceleration: -1.0, ..good }), Some(SmcError::GiInvalidDec));
}

#[test]
fn phasing_refuses_a_rotary_axis_without_a_period() {
    let movement = Movement::Rotary { period: 0.0 };
    let master = Rig::new(AxisConfig { movement, ..AxisConfig::default() });
    let mut slave = linear();
    let phasing = Phasing { phase_shift: 1.0, velocity: 1.0, acceleration: 1.0, deceleration: 1.0 };
    let shown = slave.cycle(|axis| Block::new(phasing).follow(true, &master.axis, axis));
    assert_eq!(shown.error, Some(SmcError::PhRotaryaxisPeriod0));
}

#[test]
fn out_of_gear_the_slave_goes_on() {
    let (mut master, mut slave) = (linear(), linear());
    let (mut lead, mut block, mut out) = (endless(10.0), gear(1, 2), Block::new(Decouple));
    for _ in 0..100 {
        pair(
            &mut master,
            &mut slave,
            |axis| _ = lead.call(true, axis),
            |master, axis| block.follow(true, master, axis),
        );
    }
    let shown = slave.cycle(|axis| [out.call(true, axis), block.follow(true, &master.axis, axis)]);
    assert!(shown[0].done && shown[1].command_aborted);
    assert_eq!(slave.axis.state(), AxisState::ContinuousMotion);
    let before = slave.axis.set_position();
    for _ in 0..10 {
        slave.cycle(|axis| out.call(true, axis));
    }
    assert!((slave.axis.set_position() - before - 5.0 * 10.0 * CYCLE).abs() < 1e-9);
    assert_eq!(slave.axis.set_velocity(), 5.0);
}

fn in_pos() -> Block<GearInPos> {
    Block::new(GearInPos {
        ratio_numerator: 2,
        ratio_denominator: 1,
        master_sync_position: 15.0,
        slave_sync_position: 6.0,
        master_start_distance: 5.0,
    })
}

#[test]
fn a_gear_in_position_waits_for_its_window() {
    let (mut master, mut slave) = (linear(), linear());
    let (mut lead, mut block) = (endless(10.0), in_pos());
    let mut began = None;
    for _ in 0..300 {
        let before = slave.axis.set_velocity();
        let shown = pair(
            &mut master,
            &mut slave,
            |axis| _ = lead.call(true, axis),
            |master, axis| block.follow(true, master, axis),
        );
        let at = master.axis.set_position();
        let coupling = block.running().is_some_and(GearInPosRun::is_coupling);
        assert!(slave.axis.set_position() == 0.0 || at > 10.0 - 1e-9);
        if coupling && began.is_none() {
            began = Some(at);
        }
        assert_eq!(shown.done, at >= 15.0 - 1e-9, "{at}");
        if shown.done {
            assert!((slave.axis.set_position() - 6.0 - 2.0 * (at - 15.0)).abs() < 1e-9);
            assert!((slave.axis.set_velocity() - 20.0).abs() < 1e-9);
        }
        // No step of the velocity: over 0.5 s to 20 u/s, a quintic's peak slope is below 4 times the mean.
        assert!((slave.axis.set_velocity() - before).abs() < 4.0 * 20.0 * CYCLE / 0.5);
    }
    let began = began.expect("it couples");
    assert!((10.0..10.2).contains(&began), "{began}");
}

/// Beyond the place already: a linear master comes to it when it goes back, a rotary one the next time round.
#[test]
fn a_gear_in_position_whose_master_is_beyond_the_place_waits_for_it() {
    for (turns, velocity) in [(false, -10.0), (true, 50.0)] {
        let rig = || if turns { rotary() } else { linear() };
        let (mut master, mut slave) = (rig(), linear());
        master.axis.shift_zero(20.0, false).expect("a number");
        let (mut lead, mut back, mut block) = (endless(50.0), endless(velocity), in_pos());
        let mut in_step = 0;
        for cycle in 0..1_500 {
            let shown = pair(
                &mut master,
                &mut slave,
                |axis| {
                    back.call(cycle >= 100, axis);
                    lead.call(cycle < 100, axis);
                },
                |master, axis| block.follow(true, master, axis),
            );
            let at = master.axis.set_position();
            let window = if turns { 10.0..15.0 } else { 15.0..20.0 };
            if in_step == 0 && !shown.done && !window.contains(&at) {
                assert_eq!(slave.axis.set_position(), 0.0, "{at}");
            }
            if shown.done && in_step < 100 {
                in_step += 1;
                let beyond = at - 15.0;
                assert!((slave.axis.set_position() - 6.0 - 2.0 * beyond).abs() < 1e-9, "{at}");
                assert!(beyond * velocity >= -1e-9, "{at}");
            }
        }
        assert_eq!(in_step, 100);
    }
}

/// Phasing takes over from a gear that is not in gear yet without a step, has the master's velocity, and shifts then.
#[test]
fn phasing_takes_over_from_a_gear_that_ramps_in() {
    let (mut master, mut slave) = (linear(), linear());
    let (mut lead, mut ramping) = (endless(20.0), gear(1, 1));
    let mut block = Block::new(Phasing {
        phase_shift: 3.0,
        velocity: 4.0,
        acceleration: 40.0,
        deceleration: 40.0,
    });
    let (mut coupled, mut done) = (None, None);
    let mut before = 0.0;
    for cycle in 0..1_000 {
        let shown = pair(
            &mut master,
            &mut slave,
            |axis| _ = lead.call(true, axis),
            |master, axis| {
                let shown = ramping.follow(true, master, axis);
                assert!(!shown.done, "it still ramps");
                (cycle >= 30).then(|| block.follow(true, master, axis))
            },
        );
        let velocity = slave.axis.set_velocity();
        let rate = if cycle < 30 { 50.0 } else { 40.0 };
        assert!((velocity - before).abs() <= rate * CYCLE + 1e-9, "{cycle}");
        before = velocity;
        let lag = slave.axis.set_position() - master.axis.set_position();
        if cycle >= 30 && coupled.is_none() && velocity == 20.0 {
            coupled = Some(lag);
        }
        if shown.is_some_and(|shown| shown.done) && done.is_none() {
            done = Some(lag);
        }
    }
    let (coupled, done) = (coupled.expect("coupled"), done.expect("shifted"));
    assert!((done - coupled - 3.0).abs() < 1e-9, "{coupled} {done}");
}

/// A phase shift goes on whatever the master does meanwhile: turning back, too.
#[test]
fn a_phase_shift_comes_on_top_of_a_master_that_turns() {
    let (mut master, mut slave) = (linear(), linear());
    let (mut lead, mut back) = (endless(20.0), endless(-20.0));
    let mut block = Block::new(Phasing {
        phase_shift: 6.0,
        velocity: 4.0,
        acceleration: 40.0,
        deceleration: 40.0,
    });
    let (mut begun, mut ended) = (None, None);
    for cycle in 0..400 {
        let before = slave.axis.set_position() - master.axis.set_position();
        let shown = pair(
            &mut master,
            &mut slave,
            |axis| {
                back.call(cycle >= 60, axis);
                lead.call(cycle < 60, axis);
            },
            |master, axis| block.follow(true, master, axis),
        );
        let lag = slave.axis.set_position() - master.axis.set_position();
        // Behind it falls back while it comes up to speed; then it only comes nearer.
        if lag > before + 1e-9 && begun.is_none() && cycle > 20 {
            begun = Some(before);
        }
        if shown.done {
            ended.get_or_insert(lag);
            assert!(ended.is_some_and(|ended| (lag - ended).abs() < 1e-9), "{cycle} {lag}");
        }
    }
    let (begun, ended) = (begun.expect("shifts"), ended.expect("has shifted"));
    assert!(
        master.axis.set_velocity() < 0.0 && (ended - begun - 6.0).abs() < 1e-9,
        "{begun} {ended}"
    );
}

#[test]
fn a_master_that_reverses_while_coupling_is_an_error_775() {
    let (mut master, mut slave) = (linear(), linear());
    let (mut lead, mut back, mut block) = (endless(10.0), endless(-10.0), in_pos());
    let mut error = None;
    for _ in 0..300 {
        let reversing = master.axis.set_position() > 12.0 || error.is_some();
        let shown = pair(
            &mut master,
            &mut slave,
            |axis| {
                if back.owner().is_some() || reversing {
                    back.call(true, axis);
                } else {
                    lead.call(true, axis);
                }
            },
            |master, axis| block.follow(true, master, axis),
        );
        error = error.or(shown.error);
    }
    assert_eq!(error, Some(SmcError::GipMasterDirectionChange));
    assert_eq!((slave.axis.state(), slave.axis.error_id()), (AxisState::ErrorStop, Some(775)));
    assert_eq!(slave.axis.set_velocity(), 0.0);
}

#[test]
fn a_phase_shift_comes_on_top_of_the_masters_motion() {
    let (mut master, mut slave) = (rotary(), rotary());
    let (mut lead, mut settle) = (endless(20.0), gear(1, 1));
    let mut block = Block::new(Phasing {
        phase_shift: -7.0,
        velocity: 4.0,
        acceleration: 40.0,
        deceleration: 40.0,
    });
    let distance = |master: &Rig, slave: &Rig| {
        let distance = slave.axis.set_position() - master.axis.set_position();
        distance - 360.0 * (distance / 360.0).round()
    };
    for _ in 0..100 {
        pair(
            &mut master,
            &mut slave,
            |axis| _ = lead.call(true, axis),
            |master, axis| settle.follow(true, master, axis),
        );
    }
    let before = distance(&master, &slave);
    let mut done = 0;
    for _ in 0..1_000 {
        let shown = pair(
            &mut master,
            &mut slave,
            |axis| _ = lead.call(true, axis),
            |master, axis| block.follow(true, master, axis),
        );
        assert!((slave.axis.set_velocity() - 20.0).abs() <= 4.0 + 1e-9);
        if shown.done {
            done += 1;
            assert!((distance(&master, &slave) - before + 7.0).abs() < 1e-9);
        }
    }
    // 7 u with 4 u/s and 40 u/s² take 1.85 s.
    assert!((1_000 - 190..1_000 - 180).contains(&done), "{done}");
    let wrong = Phasing { velocity: 0.0, ..block.inputs };
    let shown = slave.cycle(|axis| Block::new(wrong).follow(true, &master.axis, axis));
    assert_eq!(shown.error, Some(SmcError::PhInvalidVelaccdec));
}
