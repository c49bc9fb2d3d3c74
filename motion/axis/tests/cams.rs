//! Tests of axes that follow a cam, and of the starts of cams (manual 4.6, 5.4).

use super::*;

/// 0 to 100 lifts by 10, at rest at both ends.
fn lift(tappets: Vec<Tappet>) -> CamTable {
    let knots = [Knot::at_rest(0.0, 0.0), Knot::at_rest(50.0, 10.0), Knot::at_rest(100.0, 0.0)];
    cam(&knots, tappets)
}

#[test]
fn a_slave_follows_its_cam() {
    let (mut axes, mut lead) = ([linear(), linear()], endless(10.0));
    let mut block = cam_in(lift(Vec::new()), CamInput::default());
    let curve = lift(Vec::new()).cam.curve().clone();
    let mut before = 0.0;
    for _ in 0..1500 {
        let shown = follow(&mut axes, &mut lead, &mut block);
        assert!(shown.done && shown.error.is_none(), "in step from the start: {shown:?}");
        let [master, slave] = axes.each_ref().map(|rig| &rig.axis);
        assert_eq!(slave.state(), AxisState::SynchronizedMotion);
        let expected = curve.repeated(master.set_position());
        let position = slave.set_position();
        assert!((position - expected.position).abs() < 1e-9);
        let velocity = expected.velocity * master.set_velocity();
        assert!((slave.set_velocity() - velocity).abs() < 1e-9);
        assert!((position - before).abs() <= 0.4 * 10.0 * CYCLE);
        before = position;
    }
    assert!(axes[0].axis.set_position() > 140.0, "beyond the end");
}

/// Calls a block, and anew with the next cam in the cycle in which its cam ends: true then.
fn in_turn(
    block: &mut Block<CamIn>,
    next: &mut Option<CamIn>,
    master: &Axis,
    axis: &mut Axis,
) -> bool {
    block.follow(true, master, axis);
    let ended = block.running().is_some_and(|run| run.coupling().output().end_of_profile);
    let Some(inputs) = next.take_if(|_| ended) else { return false };
    block.follow(false, master, axis);
    block.inputs = inputs;
    block.follow(true, master, axis);
    true
}

/// The example of two cams in turn (manual 4.6.2, 11.6): Execute falls and rises in the cycle of `EndOfProfile`.
#[test]
fn two_cams_in_turn() {
    let line = |master: f64, slave: f64| Knot { velocity: 0.1, ..Knot::at_rest(master, slave) };
    let once = |knots: &[Knot]| CamTable {
        periodic: false,
        slave_absolute: false,
        ..cam(knots, Vec::new())
    };
    let up = once(&[line(0.0, 0.0), line(360.0, 36.0)]);
    let on = once(&[line(0.0, 0.0), Knot::at_rest(360.0, 18.0)]);
    let (mut master, mut slave, mut lead) = (rotary(), linear(), endless(90.0));
    let mut block = cam_in(up, CamInput::default());
    let (mut next, mut before) = (Some(cam_in(on, CamInput::default()).inputs), 0.0);
    for _ in 0..1000 {
        master.call(&mut lead, true);
        slave.cycle(|axis| in_turn(&mut block, &mut next, &master.axis, axis));
        let position = slave.axis.set_position();
        assert!((-1e-9..=0.1 * 0.9 + 1e-9).contains(&(position - before)), "{before} {position}");
        before = position;
    }
    assert!(next.is_none());
    assert!((before - 54.0).abs() < 1e-9, "{before}");
}

/// Of 30 ms; begun before the block is started again (manual 5.5: the value stays as it is).
#[test]
fn a_timed_tappet_goes_on_over_a_restart() {
    let action = Action::Timed { delay_ns: 0, duration_ns: 30_000_000 };
    let timed = Tappet { group: 1, master: 50.05, passage: Passage::Every, action };
    let (mut axes, mut lead) = ([linear(), linear()], endless(10.0));
    let mut block = cam_in(lift(vec![timed]), CamInput::default());
    let mut bit = TappetBit::default();
    let (mut on, mut restarts) = (0, 0);
    // The master is at the tappet after 5 s.
    for _ in 0..900 {
        let [master, slave] = &mut axes;
        master.call(&mut lead, true);
        slave.cycle(|axis| {
            if bit.value() && restarts == 0 {
                restarts += 1;
                block.follow(false, &master.axis, axis);
            }
            block.follow(true, &master.axis, axis)
        });
        let tappets = &block.running().expect("on the cam").coupling().output().tappets;
        assert_eq!(tappets.now_ns, slave.axis.now_ns());
        on += i32::from(switched(&mut bit, tappets));
    }
    assert!(axes[0].axis.set_position() > 80.0, "beyond the tappet");
    assert_eq!((on, restarts), (3, 1));
}

/// The first way of the slave, and all of it until it is in step with a master at rest at 20. It begins at 7.
fn ways(slave: fn() -> Rig, table: CamTable, start_mode: StartMode) -> [f64; 2] {
    let (master, mut slave) = (linear().at(20.0), slave().at(7.0));
    let mut block = cam_in(table, CamInput { start_mode, ..ramp_in(100.0, 1000.0) });
    let mut is_done = |axis: &mut Axis| {
        let shown = block.follow(true, &master.axis, axis);
        assert!(shown.error.is_none(), "{shown:?}");
        shown.done
    };
    let mut done = false;
    let [first, _] = way(&mut slave, |axis| {
        done = is_done(axis);
        true
    });
    let rest = if done { 0.0 } else { way(&mut slave, is_done)[0] };
    [first, first + rest]
}

/// The cam has 10 at the master's position, or 0 if its zero is put there; a rotary slave has a period of 360.
#[test]
fn every_start_mode_with_every_choice_of_the_table() {
    use StartMode::{Absolute, RampIn, RampInNegative, RampInPositive, Relative};
    // MasterAbsolute, SlaveAbsolute; the ways with absolute, relative and the ramps, which are [ramp_in, _pos, _neg].
    let matrix = [
        (true, true, 3.0, 10.0, [3.0, 3.0, -357.0]),
        (true, false, 10.0, 10.0, [10.0, 10.0, -350.0]),
        (false, true, -7.0, 0.0, [-7.0, 353.0, -7.0]),
        (false, false, 0.0, 0.0, [0.0, 0.0, 0.0]),
    ];
    for (master_absolute, slave_absolute, absolute, relative, ramps) in matrix {
        // Linear slaves ignore the direction.
        for (rig, ramps) in [(linear as fn() -> Rig, [ramps[0]; 3]), (rotary, ramps)] {
            for (mode, way, jumps) in [
                (Absolute, absolute, true),
                (Relative, relative, true),
                (RampIn, ramps[0], false),
                (RampInPositive, ramps[1], false),
                (RampInNegative, ramps[2], false),
            ] {
                let table = CamTable { master_absolute, slave_absolute, ..straight(100.0, 0.5) };
                let [first, all] = ways(rig, table, mode);
                // A jump is all of it at once, a ramp 1000 u/s² from rest in a cycle of 10 ms.
                let first = if jumps { first - way } else { (first.abs() - 0.05).max(0.0) };
                let near = first.abs() < 1e-9 && (all - way).abs() < 1e-9;
                let absolute = (master_absolute, slave_absolute);
                assert!(near, "{mode:?}, absolute {absolute:?}: {first} {all}");
            }
        }
    }
}

/// Until then it goes on with its acceleration: p + v·T + a·T²/2 and v + a·T.
#[test]
fn a_slave_that_accelerates_waits_for_its_master() {
    for ramp in [RampType::Trapezoid, RampType::Sigmoid, RampType::Parabolic] {
        let mut master = linear().at(-2.0);
        let mut slave = Rig::new(AxisConfig { ramp, jerk: 500.0, ..AxisConfig::default() });
        let [mut lead, mut faster] = [30.0, 90.0].map(endless);
        let table = CamTable { periodic: false, ..straight(100.0, 0.5) };
        let mut block = cam_in(table, ramp_in(100.0, 50.0));
        let cycles = master.until(|axis| {
            lead.call(true, axis);
            axis.set_position() >= 0.0
        });
        slave.calls(cycles - 1, &mut faster);
        let before = slave.axis.total();
        let State { position, velocity, acceleration } = before;
        assert!(velocity > 1.0 && acceleration > 5.0, "{ramp:?}: {before:?}");
        let shown = slave.cycle(|axis| block.follow(true, &master.axis, axis));
        assert!(shown.busy && shown.error.is_none(), "{ramp:?}: {shown:?}");
        let now = [slave.axis.set_position(), slave.axis.set_velocity()];
        let fast = velocity + acceleration * CYCLE;
        let place = position + 0.5 * (velocity + fast) * CYCLE;
        let off = [now[0] - place, now[1] - fast];
        assert!(off.iter().all(|off| off.abs() < 1e-9), "{ramp:?}: {off:?}");
    }
}

/// The slave stays at the cam's end (manual 4.6.1).
#[test]
fn a_master_that_leaves_its_cam_at_once_was_on_it() {
    use StartMode::{Absolute, RampIn, Relative};
    for ramp in [RampType::Trapezoid, RampType::Sigmoid, RampType::Parabolic] {
        for (start_mode, periodic) in
            [(Absolute, false), (Relative, false), (RampIn, false), (Absolute, true)]
        {
            let config = AxisConfig { ramp, jerk: 500.0, ..AxisConfig::default() };
            let (mut axes, mut back) = ([config; 2].map(Rig::new), to(-30.0));
            let table = CamTable { periodic, ..straight(100.0, 0.5) };
            let mut block = cam_in(table, CamInput { start_mode, ..ramp_in(100.0, 50.0) });
            let about = format!("{ramp:?}, {start_mode:?}, periodic {periodic}");
            let mut ended = false;
            loop {
                let shown = follow(&mut axes, &mut back, &mut block);
                assert!(shown.error.is_none(), "{about}: {shown:?}");
                let output = block.running().expect("on the cam").coupling().output();
                ended |= output.end_of_profile;
                let [master, slave] = axes.each_ref().map(|rig| rig.axis.set_position());
                // A periodic cam goes on by half the master's way; otherwise the slave is at rest.
                let place = if periodic { 0.5 * master } else { 0.0 };
                assert!((slave - place).abs() < 1e-9, "{about}: {slave}, not {place}");
                if back.owner().is_none() {
                    break;
                }
            }
            assert!(ended, "{about}");
        }
    }
}

/// A master that was moving before counts where it is in the cycle of the edge: outside the cam it is refused (626).
#[test]
fn a_moving_master_is_where_it_is_at_the_edge() {
    let (mut master, mut slave) = (linear(), linear());
    let table = CamTable { periodic: false, ..straight(100.0, 0.5) };
    let mut block = cam_in(table, CamInput::default());
    master.calls(2, &mut to(-30.0));
    let shown = slave.cycle(|axis| block.follow(true, &master.axis, axis));
    assert_eq!(shown.error.map(SmcError::number), Some(626));
}

#[test]
fn a_tappet_next_to_the_start_acts() {
    let tappet =
        |group, master| Tappet { group, master, passage: Passage::Positive, action: Action::On };
    // From rest with 100 u/s² the master is at 0.005 u after a cycle of 10 ms.
    let tappets = vec![tappet(1, 0.0), tappet(2, 0.004), tappet(3, 0.006)];
    let table = cam(&[Knot::at_rest(0.0, 0.0), Knot::at_rest(100.0, 50.0)], tappets);
    let (mut axes, mut lead) = ([linear(), linear()], to(30.0));
    let (mut block, mut acted) = (cam_in(table, CamInput::default()), Vec::new());
    for cycle in 0..3 {
        follow(&mut axes, &mut lead, &mut block);
        let coupling = block.running().expect("on the cam").coupling();
        acted.extend(coupling.output().tappets.triggers().map(|trigger| (cycle, trigger.group)));
        let stood: Vec<_> = coupling.stood_on().map(|tappet| tappet.group).collect();
        assert_eq!(stood, [1], "the tappet at the start");
    }
    assert_eq!(acted, [(0, 2), (1, 3)]);
}

/// The steps of the velocity at an absolute change of cams and later, and the slave's place with the master at 90.
fn changed(rig: fn() -> Rig, second: &CamTable, slave_offset: f64) -> ([f64; 2], f64) {
    let (mut master, mut slave, mut lead) = (rotary(), rig(), endless(90.0));
    // 0 to 360 in one turn of the master.
    let first = CamTable { periodic: false, ..straight(360.0, 1.0) };
    let mut block = cam_in(first, CamInput::default());
    let input = CamInput { slave_offset, ..CamInput::default() };
    let mut next = Some(cam_in(second.clone(), input).inputs);
    let (mut change, mut largest, mut before, mut switched) = (0.0_f64, 0.0_f64, [0.0; 2], None);
    for count in 0..600 {
        master.call(&mut lead, true);
        if slave.cycle(|axis| in_turn(&mut block, &mut next, &master.axis, axis)) {
            switched = Some(count);
        }
        let way = short(&slave.axis, slave.axis.set_position() - before[0]);
        let step = (way - before[1]).abs() / CYCLE;
        match switched {
            Some(at) if at == count => change = step,
            Some(_) => largest = largest.max(step),
            None => {}
        }
        before = [slave.axis.set_position(), way];
        if switched.is_some_and(|at| count > at + 10) && master.axis.set_position() >= 90.0 - 1e-9 {
            break;
        }
    }
    assert!(switched.is_some());
    ([change, largest], before[0])
}

/// By the period of a rotary slave, or by `SlaveOffset`; otherwise it jumps (manual 4.6.2, 2b).
#[test]
fn an_absolute_change_of_cams_needs_the_slave_to_be_there() {
    // The same again, a little differently.
    let knot = |x: f64, y: f64| Knot { velocity: 1.0, ..Knot::at_rest(x, y) };
    let knots = [knot(0.0, 0.0), knot(180.0, 170.0), knot(360.0, 360.0)];
    let second = CamTable { periodic: false, ..cam(&knots, Vec::new()) };
    let expected = second.cam.curve().at(90.0).position;
    // On a rotary slave 360 is 0, and with SlaveOffset a linear one goes on. The quintics bend by a few u/s a cycle at most.
    for (rig, offset) in [(rotary as fn() -> Rig, 0.0), (linear, 360.0)] {
        let ([change, after], place) = changed(rig, &second, offset);
        assert!(change < 1.0 && after < 1.0, "{change} {after}");
        assert!((place - offset - expected).abs() < 1e-6, "{place} {expected}");
    }
    // A linear slave jumps back by 360 u in a cycle.
    let ([change, _], place) = changed(linear, &second, 0.0);
    assert!((change - 360.0 / CYCLE).abs() < 1.0, "{change}");
    assert!((place - expected).abs() < 1e-6, "{place}");
}

/// The block below has been called in this cycle already, the superimposed one has not.
#[test]
fn a_cam_takes_over_both_motions_that_there_are() {
    let (master, mut slave) = (linear(), linear());
    let mut block = cam_in(straight(100.0, 0.5), ramp_in(20.0, 50.0));
    let (mut below, mut on_top) = (endless(5.0), on_top(50.0, 3.0, 100.0));
    slave.run(50, |axis| (below.call(true, axis), on_top.call(true, axis)));
    assert!((slave.axis.set_velocity() - 8.0).abs() < 1e-9);
    let before = slave.axis.set_position();
    slave.cycle(|axis| {
        below.call(true, axis);
        block.follow(true, &master.axis, axis);
        on_top.call(true, axis);
    });
    let way = slave.axis.set_position() - before;
    assert!((way - 8.0 * CYCLE).abs() < 1e-9, "{way}");
    assert!((slave.axis.set_velocity() - 8.0).abs() < 1e-9);
}
