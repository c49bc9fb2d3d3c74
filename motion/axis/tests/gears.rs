//! Tests of gears and phasing (manual 5.4).

use super::*;

/// How far the slave is ahead of its master, u.
fn lead_of([master, slave]: &[Rig; 2]) -> f64 {
    slave.axis.set_position() - master.axis.set_position()
}

#[test]
fn a_gear_couples_velocities() {
    let (mut axes, mut lead, mut block) = ([linear(), linear()], endless(10.0), gear(-3, 2));
    axes[0].calls(20, &mut lead);
    // −15 u/s with 50 u/s² take 0.3 s.
    for cycle in 1..=30 {
        assert_eq!(follow(&mut axes, &mut lead, &mut block).done, cycle == 30);
        assert!(axes[1].axis.set_acceleration().abs() <= 50.0 + 1e-9);
    }
    assert!((axes[1].axis.set_velocity() + 15.0).abs() < 1e-9);
    assert_eq!(axes[1].axis.state(), AxisState::SynchronizedMotion);
    let before = axes.each_ref().map(|rig| rig.axis.set_position());
    // In gear the ways are exactly in the ratio, whatever the master does.
    let mut back = to(0.0);
    for _ in 0..100 {
        assert!(follow(&mut axes, &mut back, &mut block).done);
        let ways = [0, 1].map(|index| axes[index].axis.set_position() - before[index]);
        assert!((ways[1] + 1.5 * ways[0]).abs() < 1e-9, "{ways:?}");
    }
}

#[test]
fn a_gear_follows_actual_values_of_a_master_without_power() {
    let ([mut master, mut slave], mut block) = ([linear(), linear()], gear(2, 1));
    master.power.regulator_on = false;
    let (mut turned, mut shown) = (0.0, Outputs::default());
    for _ in 0..100 {
        turned += 0.05;
        master.drive.feedback_mut().position = turned;
        master.drive.feedback_mut().velocity = 5.0;
        master.axis.begin_cycle(&master.drive.feedback());
        master.power.call(true, &mut master.axis);
        shown = slave.cycle(|axis| block.follow(true, &master.axis, axis));
    }
    assert!(shown.done);
    assert_eq!(master.axis.act_velocity(), 5.0);
    assert!((slave.axis.set_velocity() - 10.0).abs() < 1e-9);
}

#[test]
fn out_of_gear_the_slave_goes_on() {
    let (mut axes, mut lead, mut block) = ([linear(), linear()], endless(10.0), gear(1, 2));
    let mut out = Block::new(Decouple);
    for _ in 0..100 {
        follow(&mut axes, &mut lead, &mut block);
    }
    let [master, slave] = &mut axes;
    let shown = slave.cycle(|axis| [out.call(true, axis), block.follow(true, &master.axis, axis)]);
    assert!(shown[0].done && shown[1].command_aborted);
    assert_eq!(slave.axis.state(), AxisState::ContinuousMotion);
    let before = slave.axis.set_position();
    slave.calls(10, &mut out);
    assert!((slave.axis.set_position() - before - 5.0 * 10.0 * CYCLE).abs() < 1e-9);
    assert_eq!(slave.axis.set_velocity(), 5.0);
}

/// Meets at 15 of the master and 6 of the slave with twice its velocity, from 5 u of the master on.
fn meets_at_15() -> Block<GearInPos> {
    in_pos([2, 1], [15.0, 6.0], 5.0)
}

#[test]
fn a_gear_in_position_waits_for_its_window() {
    let (mut axes, mut lead, mut block) = ([linear(), linear()], endless(10.0), meets_at_15());
    let mut began = None;
    for _ in 0..300 {
        let before = axes[1].axis.set_velocity();
        let shown = follow(&mut axes, &mut lead, &mut block);
        let [master, slave] = axes.each_ref().map(|rig| &rig.axis);
        let at = master.set_position();
        assert!(slave.set_position() == 0.0 || at > 10.0 - 1e-9);
        if block.running().is_some_and(GearInPosRun::is_coupling) {
            began.get_or_insert(at);
        }
        assert_eq!(shown.done, at >= 15.0 - 1e-9, "{at}");
        if shown.done {
            assert!((slave.set_position() - 6.0 - 2.0 * (at - 15.0)).abs() < 1e-9);
            assert!((slave.set_velocity() - 20.0).abs() < 1e-9);
        }
        // No step of the velocity: over 0.5 s to 20 u/s, a quintic's peak slope is below 4 times the mean.
        assert!((slave.set_velocity() - before).abs() < 4.0 * 20.0 * CYCLE / 0.5);
    }
    let began = began.expect("it couples");
    assert!((10.0..10.2).contains(&began), "{began}");
}

/// A master that is past the position already: a linear one comes to it when it goes back, a rotary one the next time round.
#[test]
fn a_gear_in_position_whose_master_is_beyond_the_place_waits_for_it() {
    for (turns, velocity) in [(false, -10.0), (true, 50.0)] {
        let mut axes = [if turns { rotary() } else { linear() }, linear()];
        axes[0].axis.shift_zero(20.0, false).expect("a number");
        let (mut leads, mut block) = ([50.0, velocity].map(endless), meets_at_15());
        let mut in_step = 0;
        for cycle in 0..1_500 {
            let shown = follow(&mut axes, &mut leads[usize::from(cycle >= 100)], &mut block);
            let [at, place] = axes.each_ref().map(|rig| rig.axis.set_position());
            let window = if turns { 10.0..15.0 } else { 15.0..20.0 };
            if in_step == 0 && !shown.done && !window.contains(&at) {
                assert_eq!(place, 0.0, "{at}");
            }
            if shown.done && in_step < 100 {
                in_step += 1;
                let beyond = at - 15.0;
                assert!((place - 6.0 - 2.0 * beyond).abs() < 1e-9, "{at}");
                assert!(beyond * velocity >= -1e-9, "{at}");
            }
        }
        assert_eq!(in_step, 100);
    }
}

#[test]
fn phasing_takes_over_from_a_gear_that_ramps_in() {
    let (mut axes, mut lead, mut ramping) = ([linear(), linear()], endless(20.0), gear(1, 1));
    let mut block = phasing(3.0, 4.0, 40.0);
    let (mut coupled, mut done, mut before) = (None, None, 0.0);
    for cycle in 0..1_000 {
        let shown = pair(
            &mut axes,
            |axis| _ = lead.call(true, axis),
            |master, axis| {
                let shown = ramping.follow(true, master, axis);
                assert!(!shown.done, "it still ramps");
                (cycle >= 30).then(|| block.follow(true, master, axis))
            },
        );
        let velocity = axes[1].axis.set_velocity();
        let rate = if cycle < 30 { 50.0 } else { 40.0 };
        assert!((velocity - before).abs() <= rate * CYCLE + 1e-9, "{cycle}");
        before = velocity;
        if cycle >= 30 && velocity == 20.0 {
            coupled.get_or_insert(lead_of(&axes));
        }
        if shown.is_some_and(|shown| shown.done) {
            done.get_or_insert(lead_of(&axes));
        }
    }
    let (coupled, done) = (coupled.expect("coupled"), done.expect("shifted"));
    assert!((done - coupled - 3.0).abs() < 1e-9, "{coupled} {done}");
}

#[test]
fn a_phase_shift_comes_on_top_of_a_master_that_turns() {
    let (mut axes, mut leads) = ([linear(), linear()], [20.0, -20.0].map(endless));
    let mut block = phasing(6.0, 4.0, 40.0);
    let (mut begun, mut ended) = (None, None);
    for cycle in 0..400 {
        let before = lead_of(&axes);
        let shown = follow(&mut axes, &mut leads[usize::from(cycle >= 60)], &mut block);
        let lag = lead_of(&axes);
        // It falls back while it comes up to speed; then it only comes nearer.
        if lag > before + 1e-9 && cycle > 20 {
            begun.get_or_insert(before);
        }
        if shown.done {
            ended.get_or_insert(lag);
            assert!(ended.is_some_and(|ended| (lag - ended).abs() < 1e-9), "{cycle} {lag}");
        }
    }
    let (begun, ended) = (begun.expect("shifts"), ended.expect("has shifted"));
    assert!(axes[0].axis.set_velocity() < 0.0);
    assert!((ended - begun - 6.0).abs() < 1e-9, "{begun} {ended}");
}

#[test]
fn a_master_that_reverses_while_coupling_is_an_error_775() {
    let (mut axes, mut leads) = ([linear(), linear()], [10.0, -10.0].map(endless));
    let (mut block, mut back, mut error) = (meets_at_15(), false, None);
    for _ in 0..300 {
        back |= axes[0].axis.set_position() > 12.0;
        error = error.or(follow(&mut axes, &mut leads[usize::from(back)], &mut block).error);
    }
    let slave = &axes[1].axis;
    assert_eq!(error, Some(SmcError::GipMasterDirectionChange));
    assert_eq!((slave.state(), slave.error_id()), (AxisState::ErrorStop, Some(775)));
    assert_eq!(slave.set_velocity(), 0.0);
}

#[test]
fn a_phase_shift_comes_on_top_of_the_masters_motion() {
    let (mut axes, mut lead, mut settle) = ([rotary(), rotary()], endless(20.0), gear(1, 1));
    let mut block = phasing(-7.0, 4.0, 40.0);
    let distance = |axes: &[Rig; 2]| short(&axes[0].axis, lead_of(axes));
    for _ in 0..100 {
        follow(&mut axes, &mut lead, &mut settle);
    }
    let before = distance(&axes);
    let mut done = 0;
    for _ in 0..1_000 {
        let shown = follow(&mut axes, &mut lead, &mut block);
        assert!((axes[1].axis.set_velocity() - 20.0).abs() <= 4.0 + 1e-9);
        if shown.done {
            done += 1;
            assert!((distance(&axes) - before + 7.0).abs() < 1e-9);
        }
    }
    // 7 u with 4 u/s and 40 u/s² take 1.85 s.
    assert!((1_000 - 190..1_000 - 180).contains(&done), "{done}");
}

#[test]
fn a_motion_on_top_of_a_gear_comes_once() {
    let (mut master, mut slave) = (linear(), linear());
    let (mut lead, mut on_top) = (endless(10.0), on_top(7.0, 5.0, 50.0));
    let (acceleration, deceleration) = (100.0, 100.0);
    let mut block = Block::new(GearIn { acceleration, deceleration, ..gear(1, 1).inputs });
    let (mut done, mut before) = (false, 0.0);
    for cycle in 0..500 {
        master.call(&mut lead, true);
        done |= slave.cycle(|axis| {
            block.follow(true, &master.axis, axis);
            on_top.call(cycle > 100, axis).done
        });
        let position = slave.axis.set_position();
        assert!((0.0..=15.0 * CYCLE + 1e-9).contains(&(position - before)), "{cycle}: {position}");
        before = position;
    }
    assert!(done);
    // 10 u/s are reached together; then the master's way and 7 u.
    assert!((before - master.axis.set_position() - 7.0).abs() < 1e-9, "{before}");
}

/// Over the positions of one that starts from rest it would be infinitely fast.
#[test]
fn a_moving_slave_waits_for_a_steady_master() {
    let (mut axes, mut alone) = ([linear(), linear()], endless(8.0));
    axes[0].run(50, |_| ());
    axes[1].calls(50, &mut alone);
    let mut lead = Block::new(MoveVelocity { acceleration: 40.0, ..endless(10.0).inputs });
    let mut block = in_pos([1, 1], [20.0, axes[1].axis.set_position() + 25.0], 0.0);
    let (mut began, mut before) = (None, axes[1].axis.set_velocity());
    for cycle in 0..400 {
        let shown = follow(&mut axes, &mut lead, &mut block);
        let velocity = axes[1].axis.set_velocity();
        if block.running().is_some_and(GearInPosRun::is_coupling) && began.is_none() {
            began = Some(cycle);
            // A quarter more than 8 u/s at most, as the master's.
            assert!((velocity - before).abs() <= 0.25 * 8.0 + 1e-9, "{velocity}");
        }
        assert_eq!(shown.done, axes[0].axis.set_position() >= 20.0 - 1e-9);
        before = velocity;
    }
    // 0.4 u/s more each cycle: the fifth is a quarter more than the fourth.
    assert_eq!(began, Some(4));
    let behind = axes[1].axis.set_position() - block.inputs.slave_sync_position;
    assert!((behind - (axes[0].axis.set_position() - 20.0)).abs() < 1e-9);
}
