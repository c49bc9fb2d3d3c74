//! Examples of the manual (11.2–11.5), cycle by cycle.

use super::*;

fn absolute(position: f64, direction: Direction) -> Block<MoveAbsolute> {
    let (velocity, acceleration, deceleration) = (100.0, 100.0, 100.0);
    Block::new(MoveAbsolute { position, velocity, acceleration, deceleration, direction })
}

/// 11.2: three linear drives of a gantry from −50 to +50 cm, in mm, and a rotary one, in degrees. (The manual prints
/// ±5000 mm.)
#[test]
fn a_gantry_and_a_rotary_drive() {
    let gantry = AxisConfig {
        software_limits: Some([-500.0, 500.0]),
        max_velocity: 500.0,
        max_acceleration: 5_000.0,
        max_deceleration: 5_000.0,
        ..AxisConfig::default()
    };
    for (drive_id, end) in [(1, 500.0), (2, -500.0), (3, 500.0)] {
        let mut rig = Rig::new(AxisConfig { drive_id, ..gantry });
        let mut fast = absolute(end, Direction::Shortest);
        fast.inputs.velocity = 400.0;
        rig.done(&mut fast);
        assert_eq!((rig.axis.set_position(), rig.axis.error_id()), (end, None));
        let mut beyond = absolute(end * 1.01, Direction::Shortest);
        rig.until(|axis| beyond.call(true, axis).error.is_some());
        assert_eq!(rig.axis.error_id(), Some(10), "SMC_DI_SWLIMITS_EXCEEDED");
    }
    let mut rig = Rig::new(AxisConfig {
        movement: Movement::Rotary { period: 360.0 },
        drive_id: 4,
        ..AxisConfig::default()
    });
    rig.done(&mut absolute(270.0, Direction::Positive));
    rig.run(2, |_| ());
    assert_eq!(rig.axis.act_position(), 270.0);
}

/// 11.3: power until `Status`, then to `p` again and again; another `p` is gone to after the one before.
#[test]
fn power_and_move_absolute() {
    let mut axis = Axis::new(AxisConfig { cycle: CYCLE, ..AxisConfig::default() });
    let mut drive = VirtualDrive::new(0.0);
    let (mut init, mut p) = (false, 100.0);
    let mut move_absolute = absolute(p, Direction::Shortest);
    let mut reached = Vec::new();
    for cycle in 0..500 {
        axis.begin_cycle(&drive.feedback());
        if init {
            move_absolute.inputs.position = p;
            if move_absolute.call(true, &mut axis).done {
                reached.push((cycle, axis.set_position()));
                move_absolute.call(false, &mut axis);
            }
        } else {
            let power = Power { regulator_on: true, drive_start: true };
            init = power.call(true, &mut axis).status;
        }
        drive.follow(&axis.end_cycle());
        if cycle == 50 {
            // "If one forces the value of p", on the way.
            p = 0.0;
        }
    }
    // 100 u with 100 u/s and 100 u/s²: 1 s up, 1 s down. Afterwards it is done in each cycle there and then.
    let (first, place) = reached[0];
    assert_eq!((reached.iter().filter(|(_, place)| *place == 100.0).count(), place), (1, 100.0));
    let back = reached[1];
    assert_eq!(back, (first + 200, 0.0));
    assert!((200..=203).contains(&first), "{first}");
    assert!(reached[2..].iter().all(|(_, place)| *place == 0.0));
}

/// 11.4: a rotary axis turns by `MC_MoveVelocity`; `MC_MoveAbsolute` interrupts it, in positive direction only.
#[test]
fn move_velocity_and_move_absolute_in_turn() {
    let mut rig = rotary();
    let mut turn = endless(50.0);
    let mut go = absolute(10.0, Direction::Positive);
    for _ in 0..2 {
        rig.until(|axis| {
            turn.call(true, axis);
            go.call(false, axis);
            axis.set_position() > 20.0 && axis.set_position() < 30.0
        });
        assert_eq!(rig.axis.state(), AxisState::ContinuousMotion);
        // 350 u on, not 15 back.
        let (mut aborted, mut way, mut before) = (false, 0.0, rig.axis.set_position());
        let from = before;
        rig.until(|axis| {
            aborted |= turn.call(true, axis).command_aborted;
            let done = go.call(true, axis).done;
            let step = (axis.set_position() - before).rem_euclid(360.0);
            assert!(step < 100.0 * CYCLE + 1e-9, "backwards: {step}");
            way += step;
            before = axis.set_position();
            done
        });
        assert!(aborted);
        assert!((way - (370.0 - from)).abs() < 1e-9, "{way} from {from}");
        assert_eq!((rig.axis.set_position(), rig.axis.state()), (10.0, AxisState::Standstill));
        rig.cycle(|axis| (turn.call(false, axis), go.call(false, axis)));
    }
}

/// 11.5: a virtual axis of 10 u that turns at 1 u/s, the time, leads a linear drive through a periodic cam with an
/// inverting tappet.
#[test]
fn a_cam_over_a_virtual_time_axis() {
    let knots = [Knot::at_rest(0.0, 0.0), Knot::at_rest(4.0, 100.0), Knot::at_rest(10.0, 0.0)];
    let tappet = Tappet { group: 1, master: 2.0, passage: Passage::Every, action: Action::Invert };
    let table_select = cam(&knots, vec![tappet]);
    let curve = table_select.cam.curve().clone();
    let mut cam_in = cam_in(table_select, ramp_in(100.0, 100.0));
    let mut time = Rig::new(AxisConfig {
        movement: Movement::Rotary { period: 10.0 },
        ..AxisConfig::default()
    });
    let mut runs = endless(1.0);
    let mut bit = TappetBit::default();
    let mut drive = linear();
    // The drive is not at the begin of the cam.
    drive.done(&mut absolute(5.0, Direction::Shortest));
    let (mut changes, mut in_sync, mut before) = (Vec::new(), None, false);
    let mut velocity = 0.0;
    for cycle in 0..3500_u32 {
        time.call(&mut runs, true);
        let tappet = drive.cycle(|axis| {
            let shown = cam_in.follow(true, &time.axis, axis);
            assert!(shown.error.is_none() && !shown.command_aborted, "{shown:?}");
            in_sync = in_sync.or(shown.done.then_some(cycle));
            let run = cam_in.running();
            run.is_some_and(|run| switched(&mut bit, &run.coupling().output().tappets))
        });
        // At most what the cam asks for, 100·π²/2/4² u/s² or so, and 100 u/s² of the ramp.
        let change = (drive.axis.set_velocity() - velocity).abs();
        assert!(change < 150.0 * CYCLE, "cycle {cycle}: {change}");
        velocity = drive.axis.set_velocity();
        if in_sync.is_some() {
            let place = curve.at(time.axis.set_position()).position;
            assert!((drive.axis.set_position() - place).abs() < 1e-9, "cycle {cycle}");
        }
        if tappet != before {
            changes.push(cycle);
        }
        before = tappet;
    }
    // 5 u with 100 u/s² take 2·√(5/100) s.
    assert!(in_sync.is_some_and(|cycle| (44..=46).contains(&cycle)), "{in_sync:?}");
    // At 2, 12, 22 and 32 s: every 10 s.
    assert_eq!(changes.len(), 4, "{changes:?}");
    let mut late =
        changes.iter().zip([200, 1200, 2200, 3200]).map(|(at, cycle)| at.abs_diff(cycle));
    assert!(late.all(|late| late <= 1), "{changes:?}");
}
