//! Tests of moves to positions and by distances.

use super::*;

#[test]
fn a_rotary_axis_goes_the_way_it_is_told() {
    for (direction, expected) in [
        (Direction::Shortest, 20.0),
        (Direction::Positive, 20.0),
        (Direction::Negative, -340.0),
        (Direction::Fastest, 20.0),
        // It came to 350 the short way, backwards.
        (Direction::Current, -340.0),
    ] {
        let (mut rig, mut block) = (rotary().at(350.0), to(10.0));
        assert_eq!(rig.axis.set_position(), 350.0);
        block.inputs.direction = direction;
        let [way, _] = way(&mut rig, |axis| block.call(true, axis).done);
        assert_eq!(rig.axis.set_position(), 10.0);
        assert!((way - expected).abs() < 1e-6, "{direction:?}: {way}");
    }
}

#[test]
fn an_absolute_move_from_motion_goes_past_and_comes_back() {
    let (mut rig, mut first, mut back) = (linear(), to(100.0), to(2.2));
    rig.until(|axis| {
        first.call(true, axis);
        axis.set_position() > 2.0
    });
    let mut furthest = 0.0_f64;
    rig.until(|axis| {
        let done = back.call(true, axis).done;
        furthest = furthest.max(axis.set_position());
        done
    });
    assert_eq!(rig.axis.set_position(), 2.2);
    // 10 u/s need 0.5 u.
    assert!(furthest > 2.45 && furthest < 2.65, "{furthest}");
}

#[test]
fn an_additive_move_adds_to_the_pending_target() {
    let mut rig = linear();
    rig.calls(20, &mut to(10.0));
    rig.done(&mut add(5.0));
    assert!((rig.axis.set_position() - 15.0).abs() < 1e-12);
    // At a standstill it counts from the axis's position, and forward.
    rig.done(&mut add(5.0));
    assert!((rig.axis.set_position() - 20.0).abs() < 1e-12);
    // In continuous motion, too: 10 u/s under 100 u/s².
    assert_eq!(rig.done(&mut endless(-10.0)), 10);
    let here = rig.axis.set_position();
    rig.done(&mut add(-5.0));
    assert!((rig.axis.set_position() - (here - 5.0)).abs() < 1e-9);
    // Across the period of a rotary axis.
    let mut rig = rotary().at(355.0);
    rig.calls(50, &mut to(5.0));
    rig.done(&mut add(4.0));
    assert!((rig.axis.set_position() - 9.0).abs() < 1e-9, "{}", rig.axis.set_position());
}

/// The part of it that is done; the rest ends with that motion (manual 5.3).
#[test]
fn an_additive_move_counts_what_a_motion_on_top_has_added() {
    for (distance, whole) in [(10.0, true), (60.0, false)] {
        let (mut rig, mut below, mut more) = (linear(), to(100.0), add(50.0));
        let (mut on_top, mut added) = (on_top(distance, 50.0, 100.0), 0.0);
        for _ in 0..100 {
            let before = rig.axis.set_position();
            rig.cycle(|axis| {
                below.call(true, axis);
                let under = axis.set_position() - before;
                on_top.call(true, axis);
                added += axis.set_position() - before - under;
            });
        }
        assert_eq!((added - distance).abs() < 1e-9, whole, "{added}");
        assert!(added > 9.9 && rig.axis.set_position() < 100.0, "on its way");
        let aim = rig.axis.pending(rig.axis.overlay.position).expect("a target");
        assert!((aim - 100.0 - added).abs() < 1e-9, "{aim}");
        rig.until(|axis| {
            [more.call(true, axis), below.call(true, axis), on_top.call(true, axis)][0].done
        });
        let expected = 100.0 + added + 50.0;
        assert!((rig.axis.set_position() - expected).abs() < 1e-9, "{}", rig.axis.set_position());
    }
    let (mut rig, mut on_top, mut more) = (linear(), on_top(20.0, 5.0, 100.0), add(7.0));
    rig.calls(50, &mut on_top);
    assert_eq!(rig.axis.pending(rig.axis.overlay.position), Some(20.0));
    rig.until(|axis| [more.call(true, axis), on_top.call(true, axis)][0].done);
    assert!((rig.axis.set_position() - 27.0).abs() < 1e-9);
}

#[test]
fn an_additive_move_adds_to_a_target_of_the_same_cycle() {
    let mut rig = rotary();
    rig.done(&mut Block::new(MoveRelative { velocity: 100.0, ..by(2_000.0).inputs }));
    let (mut first, mut more) = (to(rig.axis.set_position() + 90.0), add(10.0));
    let [way, _] = way(&mut rig, |axis| [first.call(true, axis), more.call(true, axis)][1].done);
    assert!((way - 100.0).abs() < 1e-6, "{way}");
}

/// At 100 u/s, 340 u away on a turn of 360: forward it takes 3.9 s, back and round 2.673 s (the vector axis-direction).
#[test]
fn a_rotary_axis_that_moves_goes_the_way_it_is_told() {
    use Direction::{Current, Fastest, Negative, Positive, Shortest};
    for (direction, cycles) in
        [(Positive, 390), (Current, 390), (Negative, 268), (Shortest, 268), (Fastest, 268)]
    {
        let (mut rig, mut turning) = (rotary(), endless(100.0));
        rig.calls(150, &mut turning);
        rig.axis.shift_zero(0.0, false).expect("a number");
        let inputs = MoveAbsolute { velocity: 100.0, direction, ..to(340.0).inputs };
        let (mut there, mut before) = (Block::new(inputs), 100.0);
        let count = rig.until(|axis| {
            let shown = there.call(true, axis);
            turning.call(true, axis);
            assert!((axis.set_velocity() - before).abs() < 1.0 + 1e-9, "100 u/s²");
            before = axis.set_velocity();
            shown.done
        });
        assert_eq!(count, cycles, "{direction:?}");
        assert!((rig.axis.set_position() - 340.0).abs() < 1e-9);
    }
}

/// Execute falls and rises from cycle to cycle; the least time is taken from every state on the way.
#[test]
fn a_move_that_is_begun_anew_all_the_time_arrives_as_soon() {
    for ramp in [RampType::Trapezoid, RampType::Parabolic] {
        let count = |toggles: bool| {
            let mut rig = Rig::new(AxisConfig { ramp, jerk: 1_000.0, ..AxisConfig::default() });
            let (mut there, mut cycles) = (to(30.0), 0);
            rig.until(|axis| {
                cycles += 1;
                there.call(!toggles || cycles % 2 == 1, axis);
                axis.set_position() == 30.0 && axis.set_velocity() == 0.0
            })
        };
        let [once, anew] = [false, true].map(count);
        assert!(anew.abs_diff(once) <= 2, "{ramp:?}: {anew} instead of {once} cycles");
    }
}

#[test]
fn a_superimposed_distance_adds_to_the_motion_below() {
    let (mut rig, mut below, mut on_top) = (linear(), to(20.0), on_top(3.0, 5.0, 100.0));
    rig.calls(20, &mut below);
    let [_, fastest] = way(&mut rig, |axis| {
        let (lower, upper) = (below.call(true, axis), on_top.call(true, axis));
        assert!(!lower.command_aborted && lower.error.is_none() && !upper.command_aborted);
        upper.done
    });
    assert!((fastest - 15.0).abs() < 1e-9, "{fastest}");
    rig.until(|axis| [below.call(true, axis), on_top.call(true, axis)][0].done);
    assert_eq!(rig.axis.set_position(), 23.0);
    assert_eq!(rig.axis.state(), AxisState::Standstill);
}

#[test]
fn a_superimposed_motion_outlives_one_that_ends_and_dies_with_one_that_is_aborted() {
    let (mut rig, mut below, mut above) = (linear(), to(1.0), on_top(5.0, 2.0, 100.0));
    rig.cycle(|axis| (below.call(true, axis), above.call(true, axis)));
    rig.until(|axis| [below.call(true, axis), above.call(true, axis)][0].done);
    assert_eq!(rig.axis.state(), AxisState::DiscreteMotion, "still moving");
    rig.done(&mut above);
    assert!((rig.axis.set_position() - 6.0).abs() < 1e-12);
    assert_eq!(rig.axis.state(), AxisState::Standstill);

    let (mut below, mut above, mut other) = (to(50.0), on_top(5.0, 2.0, 100.0), to(0.0));
    rig.run(20, |axis| (below.call(true, axis), above.call(true, axis)));
    let velocity = rig.axis.set_velocity();
    let shown = rig.cycle(|axis| {
        other.call(true, axis);
        [below.call(true, axis), above.call(true, axis)]
    });
    assert_eq!(shown.map(|shown| shown.command_aborted), [true, true]);
    assert!((velocity - rig.axis.set_velocity() - 1.0).abs() < 1e-9, "it brakes from both");
    rig.done(&mut other);
    assert_eq!(rig.axis.set_position(), 0.0);
}

#[test]
fn a_continuous_move_has_its_end_velocity_at_the_position() {
    for (end_velocity, end_velocity_direction, expected) in [
        (4.0, Direction::Positive, 4.0),
        (4.0, Direction::Negative, -4.0),
        (0.0, Direction::Current, 0.0),
    ] {
        let mut rig = linear();
        let mut block = Block::new(past_5(end_velocity, end_velocity_direction));
        rig.done(&mut block);
        assert_eq!(rig.axis.set_velocity(), expected);
        assert_eq!(rig.axis.state(), AxisState::ContinuousMotion);
        // Within a cycle after the position, and on with the velocity.
        let past = (rig.axis.set_position() - 5.0) * expected.signum();
        assert!((-1e-9..=end_velocity * CYCLE + 1e-9).contains(&past), "{past}");
        let before = rig.axis.set_position();
        assert!(rig.call(&mut block, true).done);
        assert!((rig.axis.set_position() - before - expected * CYCLE).abs() < 1e-9);
    }
}

#[test]
fn shifting_the_zero_moves_no_axis() {
    let (mut rig, mut block) = (linear(), to(10.0));
    rig.calls(50, &mut block);
    let (position, velocity) = (rig.axis.set_position(), rig.axis.set_velocity());
    let driven = rig.drive.feedback().position;
    rig.axis.shift_zero(100.0, true).expect("a number");
    assert!((rig.axis.set_position() - position - 100.0).abs() < 1e-12);
    rig.call(&mut block, true);
    assert!((rig.drive.feedback().position - driven - velocity * CYCLE).abs() < 1e-9);
    rig.done(&mut block);
    assert!((rig.axis.set_position() - 110.0).abs() < 1e-9, "the target moves with the zero");
    assert_eq!(rig.drive.feedback().position, 10.0);
    rig.axis.shift_zero(-2.0, false).expect("a number");
    assert_eq!(rig.axis.set_position(), -2.0);
    rig.cycle(|_| ());
    assert_eq!(rig.axis.act_position(), -2.0);
    // The method and the block both refuse a position that is not a number.
    assert_eq!(rig.axis.shift_zero(f64::NAN, false), Err(SmcError::WpParamInvalid));
    let shown = rig.call(&mut home(f64::NAN, 0.0), true);
    assert_eq!(shown.error, Some(SmcError::WpParamInvalid));
    assert_eq!(rig.axis.state(), AxisState::Standstill);
}
