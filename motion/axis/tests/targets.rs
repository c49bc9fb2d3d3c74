//! Tests of moves to positions and by distances.

use super::blocks::endless;
use super::framework::to;
use super::rig::{self, Rig, linear, rotary};
use crate::{
    AxisConfig, Block, Direction, Halt, MoveAbsolute, MoveAdditive, MoveContinuousAbsolute,
    MoveRelative, MoveVelocity, Points, PositionProfile, SmcError, Stop,
};
use twin_profile::{ProfilePoint, RampType};

/// Where a rotary axis at 350 u that rests goes for 10 u, in u.
fn way(direction: Direction) -> f64 {
    let mut rig = rotary();
    let mut there = to(350.0);
    rig.until(|axis| there.call(true, axis).done);
    assert_eq!(rig.axis.set_position(), 350.0);
    let mut block = to(10.0);
    block.inputs.direction = direction;
    let (mut way, mut before) = (0.0, 350.0_f64);
    rig.until(|axis| {
        let done = block.call(true, axis).done;
        let step = axis.set_position() - before;
        way += step - 360.0 * (step / 360.0).round();
        before = axis.set_position();
        assert!((0.0..360.0).contains(&before));
        done
    });
    assert_eq!(rig.axis.set_position(), 10.0);
    way
}

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
        let way = way(direction);
        assert!((way - expected).abs() < 1e-6, "{direction:?}: {way}");
    }
}

#[test]
fn an_absolute_move_from_motion_goes_past_and_comes_back() {
    let mut rig = linear();
    let mut first = to(100.0);
    rig.until(|axis| {
        first.call(true, axis);
        axis.set_position() > 2.0
    });
    let mut back = to(2.2);
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

fn add(distance: f64) -> Block<MoveAdditive> {
    Block::new(MoveAdditive { distance, velocity: 10.0, acceleration: 100.0, deceleration: 100.0 })
}

#[test]
fn an_additive_move_adds_to_the_pending_target() {
    let mut rig = linear();
    let mut first = to(10.0);
    for _ in 0..20 {
        rig.cycle(|axis| first.call(true, axis));
    }
    let mut more = add(5.0);
    rig.until(|axis| more.call(true, axis).done);
    assert!((rig.axis.set_position() - 15.0).abs() < 1e-12);
    assert_eq!(rig.axis.read_parameter(1105), Ok(15.0), "fAimPosition");
    // At a standstill it counts from where the axis is, and forward.
    let mut again = add(5.0);
    rig.until(|axis| again.call(true, axis).done);
    assert!((rig.axis.set_position() - 20.0).abs() < 1e-12);
}

#[test]
fn an_additive_move_of_a_rotary_axis_adds_across_the_period() {
    let mut rig = rotary();
    let mut first = to(355.0);
    rig.until(|axis| first.call(true, axis).done);
    let mut on = to(5.0);
    for _ in 0..50 {
        rig.cycle(|axis| on.call(true, axis));
    }
    let mut more = add(4.0);
    rig.until(|axis| more.call(true, axis).done);
    assert!((rig.axis.set_position() - 9.0).abs() < 1e-9, "{}", rig.axis.set_position());
}

/// What has been added on top is part of where the axis goes; what is still to come ends with the motion on top (manual
/// 5.3). On top of nothing, that is the block whose target it is.
#[test]
fn an_additive_move_counts_what_a_motion_on_top_has_added() {
    for (distance, whole) in [(10.0, true), (60.0, false)] {
        let mut rig = linear();
        let (mut below, mut on_top) = (to(100.0), rig::on_top(distance, 50.0, 100.0, 100.0));
        let (mut more, mut added) = (add(50.0), 0.0);
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
        let Ok(aim) = rig.axis.read_parameter(1105) else { panic!("fAimPosition") };
        assert!((aim - 100.0 - added).abs() < 1e-9, "{aim}");
        rig.until(|axis| {
            let shown = more.call(true, axis);
            below.call(true, axis);
            on_top.call(true, axis);
            shown.done
        });
        let expected = 100.0 + added + 50.0;
        assert!((rig.axis.set_position() - expected).abs() < 1e-9, "{}", rig.axis.set_position());
    }
    let mut rig = linear();
    let (mut on_top, mut more) = (rig::on_top(20.0, 5.0, 100.0, 100.0), add(7.0));
    for _ in 0..50 {
        rig.cycle(|axis| on_top.call(true, axis));
    }
    assert_eq!(rig.axis.read_parameter(1105), Ok(20.0), "fAimPosition");
    rig.until(|axis| {
        let shown = more.call(true, axis);
        on_top.call(true, axis);
        shown.done
    });
    assert!((rig.axis.set_position() - 27.0).abs() < 1e-9);
}

/// Two blocks in one cycle, on an axis that has turned many times before: the second one adds to the first one's target.
#[test]
fn an_additive_move_adds_to_a_target_of_the_same_cycle() {
    let mut rig = rotary();
    let mut turns = Block::new(MoveRelative {
        distance: 2_000.0,
        velocity: 100.0,
        acceleration: 100.0,
        deceleration: 100.0,
    });
    rig.until(|axis| turns.call(true, axis).done);
    let start = rig.axis.set_position();
    let (mut first, mut more) = (to(start + 90.0), add(10.0));
    let (mut way, mut before) = (0.0, start);
    rig.until(|axis| {
        first.call(true, axis);
        let shown = more.call(true, axis);
        let step = axis.set_position() - before;
        way += step - 360.0 * (step / 360.0).round();
        before = axis.set_position();
        shown.done
    });
    assert!((way - 100.0).abs() < 1e-6, "{way}");
}

/// At 100 u/s, 340 u away on a turn of 360: forward it takes 3.9 s, back and round 2.673 s (the vector axis-direction).
#[test]
fn a_rotary_axis_that_moves_goes_the_way_it_is_told() {
    use Direction::{Current, Fastest, Negative, Positive, Shortest};
    for (direction, cycles) in
        [(Positive, 390), (Current, 390), (Negative, 268), (Shortest, 268), (Fastest, 268)]
    {
        let mut rig = rotary();
        let mut turning = endless(100.0);
        for _ in 0..150 {
            rig.cycle(|axis| turning.call(true, axis));
        }
        rig.axis.shift_zero(0.0, false).expect("a number");
        let mut there = Block::new(MoveAbsolute {
            position: 340.0,
            velocity: 100.0,
            acceleration: 100.0,
            deceleration: 100.0,
            direction,
        });
        let mut before = 100.0;
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

/// Execute falls and rises from cycle to cycle: the way to the target is as long as if it had been begun once, for one that
/// takes least time from every state there is on the way.
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

/// A table counts from the period in which the axis is, wherever it has turned to before, and goes over its end.
#[test]
fn a_table_of_positions_goes_over_the_end_of_the_period() {
    let mut rig = rotary();
    let mut turning = endless(100.0);
    for _ in 0..1_000 {
        rig.cycle(|axis| turning.call(true, axis));
    }
    let mut there = to(350.0);
    rig.until(|axis| {
        let shown = there.call(true, axis);
        turning.call(true, axis);
        shown.done
    });
    let point = ProfilePoint { delta_time: 2.0, value: 370.0 };
    let mut table = Block::new(PositionProfile(Points::new(vec![point])));
    let mut fastest = 0.0_f64;
    rig.until(|axis| {
        let shown = table.call(true, axis);
        fastest = fastest.max(axis.set_velocity().abs());
        shown.done
    });
    assert!((rig.axis.set_position() - 10.0).abs() < 1e-9, "{}", rig.axis.set_position());
    // 20 u in 2 s by a cubic between rests: 3/2 of the mean velocity.
    assert!((fastest - 15.0).abs() < 1e-9, "{fastest}");
}

#[test]
fn in_continuous_motion_an_additive_move_counts_from_here() {
    let mut rig = linear();
    let mut endless = Block::new(MoveVelocity {
        velocity: 10.0,
        acceleration: 100.0,
        deceleration: 100.0,
        direction: Direction::Negative,
    });
    let reached = rig.until(|axis| endless.call(true, axis).done);
    assert_eq!(reached, 10, "10 u/s under 100 u/s²");
    let here = rig.axis.set_position();
    let mut more = add(-5.0);
    rig.until(|axis| more.call(true, axis).done);
    assert!((rig.axis.set_position() - (here - 5.0)).abs() < 1e-9);
}

#[test]
fn every_block_refuses_wrong_limits_with_its_own_number() {
    let mut rig = linear();
    let (velocity, acceleration, deceleration) = (10.0, 0.0, 100.0);
    let relative = MoveRelative { distance: 1.0, velocity, acceleration, deceleration };
    let continuous = MoveContinuousAbsolute {
        position: 5.0,
        velocity,
        end_velocity: 1.0,
        end_velocity_direction: Direction::Positive,
        acceleration,
        deceleration,
        direction: Direction::Positive,
    };
    let mut additive = add(1.0);
    additive.inputs.acceleration = f64::NAN;
    let mut on_top = rig::on_top(1.0, -1.0, 100.0, 100.0);
    let shown = rig.cycle(|axis| {
        [
            Block::new(relative).call(true, axis),
            additive.call(true, axis),
            on_top.call(true, axis),
            Block::new(continuous).call(true, axis),
            Block::new(Stop { deceleration: 0.0 }).call(true, axis),
            Block::new(Halt { deceleration: -1.0 }).call(true, axis),
        ]
    });
    let numbers = shown.map(|shown| shown.error.map(SmcError::number));
    assert_eq!(numbers, [226, 251, 276, 451, 181, 181].map(Some));
}

#[test]
fn an_endless_motion_needs_a_direction() {
    for (direction, expected) in [
        (Direction::Shortest, Some(SmcError::MvDirectionNotApplicable)),
        (Direction::Fastest, Some(SmcError::MvDirectionNotApplicable)),
        (Direction::Current, None),
    ] {
        let mut rig = linear();
        let mut block = Block::new(MoveVelocity {
            velocity: 10.0,
            acceleration: 100.0,
            deceleration: 100.0,
            direction,
        });
        assert_eq!(rig.cycle(|axis| block.call(true, axis)).error, expected);
        block.inputs.velocity = -10.0;
        block.inputs.direction = Direction::Positive;
        rig.cycle(|axis| block.call(false, axis));
        let shown = rig.cycle(|axis| block.call(true, axis));
        assert_eq!(shown.error, Some(SmcError::MvInvalidAccdecValues), "{direction:?}");
    }
}
