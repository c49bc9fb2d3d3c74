//! Tests of cam starts: the table of manual 4.6.1, and an absolute change of cams (4.6.2).

use super::blocks::endless;
use super::framework::to;
use super::rig::{CYCLE, Rig, linear, rotary};
use crate::{Axis, AxisConfig, Block, CamIn, SmcError};
use std::sync::Arc;
use twin_cam::{Action, Cam, CamInput, CamTable, Knot, Passage, Shape, StartMode, Tappet};
use twin_profile::RampType;

fn cam(knots: &[Knot]) -> CamTable {
    let cam = Cam::new("cam", Shape::Polynomial(knots.to_vec()), Vec::new()).expect("a cam");
    CamTable::new(Arc::new(cam))
}

/// `slope` times the master, over `width`.
fn straight(width: f64, slope: f64) -> CamTable {
    let knot = |x: f64| Knot { velocity: slope, ..Knot::at_rest(x, slope * x) };
    cam(&[knot(0.0), knot(width)])
}

fn at(rig: fn() -> Rig, place: f64) -> Rig {
    let mut rig = rig();
    let mut there = to(place);
    rig.until(|axis| there.call(true, axis).done);
    rig
}

/// The first way of the slave, and all of it until it is in step with a master that stands at 20. It begins at 7.
fn ways(slave: fn() -> Rig, table: CamTable, start_mode: StartMode) -> [f64; 2] {
    let (master, mut slave) = (at(linear, 20.0), at(slave, 7.0));
    let input = CamInput {
        start_mode,
        velocity_difference: 100.0,
        acceleration: 1000.0,
        deceleration: 1000.0,
        ..CamInput::default()
    };
    let mut block = Block::new(CamIn { table: Some(table), input });
    let (mut before, mut all, mut first) = (7.0, 0.0, None);
    for _ in 0..1000 {
        let shown = slave.cycle(|axis| block.follow(true, &master.axis, axis));
        assert!(shown.error.is_none(), "{shown:?}");
        let way = slave.axis.set_position() - before;
        let way = slave.axis.period().map_or(way, |it| way - it * (way / it).round());
        before = slave.axis.set_position();
        all += way;
        first.get_or_insert(way);
        if shown.done {
            return [first.unwrap_or_default(), all];
        }
    }
    panic!("it does not come onto its cam");
}

/// The cam says 10 where the master is, or 0 if its zero is laid there. In brackets: what a ramp in both directions does
/// on a rotary slave of 360.
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
        let table = || CamTable { master_absolute, slave_absolute, ..straight(100.0, 0.5) };
        let about = format!("MasterAbsolute {master_absolute}, SlaveAbsolute {slave_absolute}");
        for rig in [linear, rotary] {
            for (mode, way) in [(Absolute, absolute), (Relative, relative)] {
                let found = ways(rig, table(), mode);
                // With a jump, if there is one: all of it at once.
                assert!((found[0] - way).abs() < 1e-9, "{about}, {mode:?}: {found:?}");
                assert!((found[1] - way).abs() < 1e-9, "{about}, {mode:?}: {found:?}");
            }
        }
        // On linear slaves the directions count for nothing.
        for (rig, ramps) in [(linear as fn() -> Rig, [ramps[0]; 3]), (rotary, ramps)] {
            for (mode, way) in [RampIn, RampInPositive, RampInNegative].into_iter().zip(ramps) {
                let [first, all] = ways(rig, table(), mode);
                // 1000 u/s² from rest in a cycle of 10 ms.
                assert!(first.abs() <= 0.05 + 1e-9, "{about}, {mode:?}: a step of {first}");
                assert!((all - way).abs() < 1e-9, "{about}, {mode:?}: {all}");
            }
        }
    }
}

/// A master comes onto its cam in the very cycle in which the block begins: until then the slave has gone on with the
/// acceleration it had, p + v·T + a·T²/2, and its velocity is v + a·T; with every kind of ramp.
#[test]
fn a_slave_that_accelerates_waits_for_its_master() {
    for ramp in [RampType::Trapezoid, RampType::Sigmoid, RampType::Parabolic] {
        let config = AxisConfig { ramp, jerk: 500.0, ..AxisConfig::default() };
        let mut master = at(linear, -2.0);
        let mut slave = Rig::new(config);
        let [mut lead, mut faster] = [30.0, 90.0].map(endless);
        let table = CamTable { periodic: false, ..straight(100.0, 0.5) };
        let input = CamInput {
            start_mode: StartMode::RampIn,
            velocity_difference: 100.0,
            acceleration: 50.0,
            deceleration: 50.0,
            ..CamInput::default()
        };
        let mut block = Block::new(CamIn { table: Some(table), input });
        let state =
            |axis: &Axis| [axis.set_position(), axis.set_velocity(), axis.set_acceleration()];
        let mut before = state(&slave.axis);
        loop {
            master.cycle(|axis| lead.call(true, axis));
            if master.axis.set_position() >= 0.0 {
                break;
            }
            slave.cycle(|axis| faster.call(true, axis));
            before = state(&slave.axis);
        }
        let [position, velocity, acceleration] = before;
        assert!(velocity > 1.0 && acceleration > 5.0, "{ramp:?}: {before:?}");
        let shown = slave.cycle(|axis| block.follow(true, &master.axis, axis));
        assert!(shown.busy && shown.error.is_none(), "{ramp:?}: {shown:?}");
        let [now, fast, _] = state(&slave.axis);
        let expected = position + (velocity + 0.5 * acceleration * CYCLE) * CYCLE;
        assert!((now - expected).abs() < 1e-9, "{ramp:?}: {now} {expected}");
        let expected = velocity + acceleration * CYCLE;
        assert!((fast - expected).abs() < 1e-9, "{ramp:?}: {fast} {expected}");
    }
}

/// A master that stood moves off, the way that leaves the cam, in the very cycle in which the block begins: it was on the cam,
/// so that the slave stays at its end (manual 4.6.1); with every ramp of the master, and with every way onto the cam.
#[test]
fn a_master_that_leaves_its_cam_at_once_was_on_it() {
    use StartMode::{Absolute, RampIn, Relative};
    for ramp in [RampType::Trapezoid, RampType::Sigmoid, RampType::Parabolic] {
        for (start_mode, periodic) in
            [(Absolute, false), (Relative, false), (RampIn, false), (Absolute, true)]
        {
            let config = AxisConfig { ramp, jerk: 500.0, ..AxisConfig::default() };
            let (mut master, mut slave) = (Rig::new(config), Rig::new(config));
            let mut back = to(-30.0);
            let table = CamTable { periodic, ..straight(100.0, 0.5) };
            let input = CamInput {
                start_mode,
                velocity_difference: 100.0,
                acceleration: 50.0,
                deceleration: 50.0,
                ..CamInput::default()
            };
            let mut block = Block::new(CamIn { table: Some(table), input });
            let about = format!("{ramp:?}, {start_mode:?}, periodic {periodic}");
            let mut ended = false;
            loop {
                let there = master.cycle(|axis| back.call(true, axis).done);
                let shown = slave.cycle(|axis| block.follow(true, &master.axis, axis));
                assert!(shown.error.is_none(), "{about}: {shown:?}");
                let output = block.running().expect("on the cam").coupling().output();
                ended |= output.end_of_profile;
                // Periodic it goes on by half the master's way, else it stands.
                let place = if periodic { 0.5 * master.axis.set_position() } else { 0.0 };
                let way = (slave.axis.set_position() - place).abs();
                assert!(way < 1e-9, "{about}: {way} beside {place}");
                if there {
                    break;
                }
            }
            assert!(ended, "{about}");
        }
    }
}

/// One that has moved before is where it is in the cycle of the edge: beside the cam it is refused (626).
#[test]
fn a_moving_master_is_where_it_is_at_the_edge() {
    let (mut master, mut slave) = (linear(), linear());
    let mut back = to(-30.0);
    let mut block = Block::new(CamIn {
        table: Some(CamTable { periodic: false, ..straight(100.0, 0.5) }),
        input: CamInput::default(),
    });
    master.cycle(|axis| back.call(true, axis));
    master.cycle(|axis| back.call(true, axis));
    let shown = slave.cycle(|axis| block.follow(true, &master.axis, axis));
    assert_eq!(shown.error.map(SmcError::number), Some(626));
}

/// In that first cycle tappets are passed, too: one that is so near is not lost.
#[test]
fn a_tappet_just_beside_the_start_acts() {
    let tappet =
        |group, master| Tappet { group, master, passage: Passage::Positive, action: Action::On };
    // From rest with 100 u/s² the master is at 0.005 u after a cycle of 10 ms.
    let tappets = vec![tappet(1, 0.0), tappet(2, 0.004), tappet(3, 0.006)];
    let knots = vec![Knot::at_rest(0.0, 0.0), Knot::at_rest(100.0, 50.0)];
    let cam = Arc::new(Cam::new("cam", Shape::Polynomial(knots), tappets).expect("a cam"));
    let (mut master, mut slave) = (linear(), linear());
    let mut lead = to(30.0);
    let mut block =
        Block::new(CamIn { table: Some(CamTable::new(cam)), input: CamInput::default() });
    let mut acted = Vec::new();
    for cycle in 0..3 {
        master.cycle(|axis| lead.call(true, axis));
        slave.cycle(|axis| block.follow(true, &master.axis, axis));
        let coupling = block.running().expect("on the cam").coupling();
        acted.extend(coupling.output().tappets.triggers().map(|trigger| (cycle, trigger.group)));
        let stood: Vec<_> = coupling.stood_on().map(|tappet| tappet.group).collect();
        assert_eq!(stood, [1], "the one on which it stood");
    }
    assert_eq!(acted, [(0, 2), (1, 3)]);
}

/// Changes from `first` to `second` with an absolute start when the first one ends, with `slave_offset`; the largest
/// change of the velocity then and afterwards, and where the slave is when the master has gone on to 90.
fn changed(
    rig: fn() -> Rig,
    first: CamTable,
    second: &CamTable,
    slave_offset: f64,
) -> ([f64; 2], f64) {
    let (mut master, mut slave) = (rotary(), rig());
    let mut lead = endless(90.0);
    let mut block = Block::new(CamIn { table: Some(first), input: CamInput::default() });
    let (mut change, mut largest, mut before, mut switched) = (0.0_f64, 0.0_f64, [0.0; 2], None);
    for count in 0..600 {
        master.cycle(|axis| lead.call(true, axis));
        slave.cycle(|axis| {
            block.follow(true, &master.axis, axis);
            let ended = block.running().is_some_and(|run| run.coupling().output().end_of_profile);
            if ended && switched.is_none() {
                switched = Some(count);
                block.follow(false, &master.axis, axis);
                let input = CamInput { slave_offset, ..CamInput::default() };
                block.inputs = CamIn { table: Some(second.clone()), input };
                block.follow(true, &master.axis, axis);
            }
        });
        let way = slave.axis.set_position() - before[0];
        let way = slave.axis.period().map_or(way, |it| way - it * (way / it).round());
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

/// An absolute start puts the slave where the new cam says, which has to be where it is already: by the period of a
/// rotary slave, or by `SlaveOffset`; else it jumps (manual 4.6.2, 2b).
#[test]
fn an_absolute_change_of_cams_needs_the_slave_to_be_there() {
    let once = |table: CamTable| CamTable { periodic: false, ..table };
    // 0 to 360 in one turn of the master, and from there on the same again, a little differently.
    let first = || once(straight(360.0, 1.0));
    let knot = |x: f64, y: f64| Knot { velocity: 1.0, ..Knot::at_rest(x, y) };
    let second = || once(cam(&[knot(0.0, 0.0), knot(180.0, 170.0), knot(360.0, 360.0)]));
    let expected = second().cam.curve().at(90.0).position;
    // On a rotary slave 360 is 0. The quintics bend by a few u/s a cycle at most.
    let ([change, after], place) = changed(rotary, first(), &second(), 0.0);
    assert!(change < 1.0 && after < 1.0, "{change} {after}");
    assert!((place - expected).abs() < 1e-6, "{place} {expected}");
    // On a linear one it jumps back by 360 u in a cycle.
    let ([change, _], place) = changed(linear, first(), &second(), 0.0);
    assert!((change - 360.0 / CYCLE).abs() < 1.0, "{change}");
    assert!((place - expected).abs() < 1e-6, "{place}");
    // With SlaveOffset it goes on.
    let ([change, after], place) = changed(linear, first(), &second(), 360.0);
    assert!(change < 1.0 && after < 1.0, "{change} {after}");
    assert!((place - 360.0 - expected).abs() < 1e-6, "{place}");
}
