//! Tests of the coupling: starts, ramp-in, ends and changes of cams (manual 4.6).

use super::{CYCLE_NS, at, moving, started, tappet};
use crate::{
    Action, Cam, CamCoupling, CamInput, CamTable, CouplingError, Element, Factors, Knot,
    MasterMotion, Passage, StartMode, slave_set_position,
};
use proptest::prelude::*;
use std::sync::Arc;
use twin_profile::State;

fn cam(knots: &[Knot]) -> Arc<Cam> {
    super::cam(knots, Vec::new())
}

/// Half the master, 0 to 100.
fn straight() -> Arc<Cam> {
    let line = |master: f64| Knot { velocity: 0.5, ..Knot::at_rest(master, master / 2.0) };
    cam(&[line(0.0), line(100.0)])
}

/// At rest at both ends: 0 to 100 lifts by 50.
fn lift() -> Arc<Cam> {
    cam(&[Knot::at_rest(0.0, 0.0), Knot::at_rest(100.0, 50.0)])
}

/// The first set-point.
fn start(table: CamTable, mode: StartMode, master: f64, slave: f64) -> f64 {
    let input = CamInput {
        start_mode: mode,
        velocity_difference: 1.0,
        acceleration: 1.0,
        deceleration: 1.0,
        ..CamInput::default()
    };
    started(table, input, at(master), at(slave)).output().slave.position
}

/// The matrix of manual 4.6.1, on the lift at 50: the cam says 25, the slave is at 7.
#[test]
fn start_modes_and_slave_absolute() {
    use StartMode::{Absolute, RampIn, RampInNegative, RampInPositive, Relative};
    for slave_absolute in [true, false] {
        let table = || CamTable { slave_absolute, ..CamTable::new(lift()) };
        let absolute = if slave_absolute { 25.0 } else { 32.0 };
        for (mode, expected, goal) in [
            (Absolute, absolute, absolute),
            (Relative, 32.0, 32.0),
            (RampIn, 7.0, absolute),
            (RampInPositive, 7.0, absolute),
            (RampInNegative, 7.0, absolute),
        ] {
            let found = start(table(), mode, 50.0, 7.0);
            assert!((found - expected).abs() < 1e-12, "{mode:?} {slave_absolute}: {found}");
            let input = CamInput { start_mode: mode, ..CamInput::default() };
            let set = slave_set_position(table(), input, &at(50.0), &at(7.0)).expect("a position");
            assert!((set - goal).abs() < 1e-12, "{mode:?} {slave_absolute}: {set}");
        }
    }
}

#[test]
fn a_relative_master_begins_at_zero() {
    let table = || CamTable { master_absolute: false, ..CamTable::new(lift()) };
    assert_eq!(start(table(), StartMode::Absolute, 1234.0, 0.0), 0.0);
    let no_zero = cam(&[Knot::at_rest(10.0, 0.0), Knot::at_rest(20.0, 5.0)]);
    let table = CamTable { cam: no_zero, ..table() };
    let refused = CamCoupling::start(table, CamInput::default(), &at(15.0), &at(0.0), 0);
    let error = refused.expect_err("no zero");
    assert_eq!(error, CouplingError::MasterOutOfRange { master: 0.0, min: 10.0, max: 20.0 });
    assert_eq!(error.number(), Some(626));
}

#[test]
fn what_does_not_start() {
    let start = |input, master| {
        CamCoupling::start(CamTable::new(lift()), input, &at(master), &at(0.0), 0).map(|_| ())
    };
    let plain = CamInput::default();
    let outside = |master| Err(CouplingError::MasterOutOfRange { master, min: 0.0, max: 100.0 });
    assert_eq!(start(plain, -0.5), outside(-0.5));
    assert_eq!(start(CamInput { master_offset: 60.0, ..plain }, 50.0), outside(110.0));
    let ramp = CamInput {
        start_mode: StartMode::RampIn,
        velocity_difference: 1.0,
        acceleration: 1.0,
        ..plain
    };
    let error = start(ramp, 50.0).expect_err("no deceleration");
    assert_eq!(error, CouplingError::RampNeedsValues { name: "Deceleration", value: 0.0 });
    assert_eq!(error.number(), Some(627));
    assert!(start(CamInput { slave_scaling: f64::NAN, ..plain }, 50.0).is_err());
    assert!(start(plain, f64::NAN).is_err());
}

#[test]
fn a_cam_that_is_not_periodic_holds_its_ends() {
    let table = CamTable { periodic: false, ..CamTable::new(straight()) };
    let mut coupling = started(table, CamInput::default(), moving(0.0, 10.0), at(0.0));
    assert!(!coupling.output().end_of_profile, "standing at the begin is no end");
    let mut now = 0;
    let mut step = |master: State| {
        now += CYCLE_NS;
        let found = coupling.step(&master, now).expect("somewhere");
        (found.slave.position, found.slave.velocity, found.end_of_profile)
    };
    assert_eq!(step(moving(50.0, 10.0)), (25.0, 5.0, false));
    assert_eq!(step(moving(100.0, 10.0)), (50.0, 5.0, true));
    assert_eq!(step(moving(130.0, 10.0)), (50.0, 0.0, true));
    assert_eq!(step(moving(140.0, 10.0)), (50.0, 0.0, true));
    // "The action of the cam does not end with leaving the range" (manual 4.6.1).
    assert_eq!(step(moving(80.0, -10.0)), (40.0, -5.0, false));
    assert_eq!(step(moving(-20.0, -10.0)), (0.0, 0.0, true));
}

#[test]
fn a_periodic_cam_pulses_at_its_ends() {
    let table = CamTable::new(straight());
    let mut coupling = started(table, CamInput::default(), at(90.0), at(45.0));
    let masters = [99.0, 101.0, 102.0, 200.0, 230.0, 199.0];
    let ends = [false, true, false, true, false, true];
    for (now, (master, end)) in (1..).zip(masters.into_iter().zip(ends)) {
        let found = coupling.step(&moving(master, 10.0), now * CYCLE_NS).expect("somewhere");
        assert_eq!((found.slave.position, found.end_of_profile), (master / 2.0, end), "{master}");
    }
    assert_eq!(coupling.offsets(), (-100.0, 50.0));
    assert_eq!(coupling.release(), 5.0);
}

/// A rotary master of 360 and a cam of 100: the passes go on over the end of the turn.
#[test]
fn a_rotary_master_goes_on() {
    let table = CamTable { master_period: Some(360.0), ..CamTable::new(straight()) };
    let mut coupling = started(table, CamInput::default(), at(0.0), at(0.0));
    for step in 1..200_i32 {
        let whole = f64::from(step) * 7.0;
        let found = coupling.step(&at(whole % 360.0), i64::from(step) * CYCLE_NS);
        let found = found.expect("somewhere").slave.position;
        assert!((found - whole / 2.0).abs() < 1e-9, "{whole}: {found}");
    }
}

/// Example 4.6.2: two cams in turn without a jump of position or velocity, relatively.
#[test]
fn cams_in_turn() {
    let line = |master: f64, slave: f64| Knot { velocity: 0.25, ..Knot::at_rest(master, slave) };
    let first = cam(&[Knot::at_rest(0.0, 0.0), line(360.0, 90.0)]);
    let second = cam(&[line(0.0, 0.0), Knot::at_rest(360.0, 45.0)]);
    let select = |cam: &Arc<Cam>| CamTable {
        periodic: false,
        slave_absolute: false,
        master_period: Some(360.0),
        ..CamTable::new(Arc::clone(cam))
    };
    let master = |step: i32| moving(f64::from(step) * 0.7 % 360.0, 700.0);
    let mut coupling = started(select(&first), CamInput::default(), master(0), at(500.0));
    let (mut before, mut changes) = (*coupling.output(), 0);
    for step in 1..1100_i32 {
        let now = i64::from(step) * CYCLE_NS;
        let mut found = *coupling.step(&master(step), now).expect("somewhere");
        if found.end_of_profile && changes == 0 {
            changes += 1;
            // The slave is at the end of the first cam, 90 on; the second one takes over in the same cycle.
            assert!((found.slave.position - 590.0).abs() < 1e-9);
            let table = select(&second);
            coupling =
                CamCoupling::start(table, CamInput::default(), &master(step), &found.slave, now)
                    .expect("a start");
            let jump = coupling.jump_from(&before.slave);
            assert!(jump.velocity.abs() < 0.5, "{jump:?}");
            found = *coupling.output();
        }
        let by = found.slave.position - before.slave.position;
        // 0.7 of the master a cycle at slopes of up to 90/360 · 1.875.
        assert!((0.0..=0.7 * 0.47).contains(&by), "{step}: {by}");
        before = found;
    }
    assert_eq!(changes, 1);
    assert!((before.slave.position - 635.0).abs() < 1e-9);
}

#[test]
fn rotary_slaves_are_ramped_in_their_direction() {
    // The cam says 10, the slave is at 350 of 360: 20 forwards or 340 backwards.
    let table = || CamTable {
        slave_period: Some(360.0),
        ..CamTable::new(cam(&[Knot::at_rest(0.0, 10.0), Knot::at_rest(100.0, 10.0)]))
    };
    for (start_mode, goal) in [
        (StartMode::RampIn, 370.0),
        (StartMode::RampInPositive, 370.0),
        (StartMode::RampInNegative, 10.0),
    ] {
        let input = CamInput {
            start_mode,
            velocity_difference: 50.0,
            acceleration: 100.0,
            deceleration: 200.0,
            ..CamInput::default()
        };
        let mut coupling = started(table(), input, at(0.0), at(350.0));
        let sign = if goal > 350.0 { 1.0 } else { -1.0 };
        let mut before = 350.0;
        for step in 1..10_000 {
            let found = coupling.step(&at(0.0), step * CYCLE_NS).expect("somewhere");
            assert!((found.slave.position - before) * sign >= -1e-9);
            assert!(found.slave.velocity.abs() <= 50.0 + 1e-9);
            before = found.slave.position;
        }
        assert!((before - goal).abs() < 1e-9, "{start_mode:?}: {before}");
        assert!(coupling.output().in_sync);
    }
}

/// Tappets of a cycle beyond the reported ones are counted.
#[test]
fn tappets_of_a_cycle() {
    let tappets = (1..=5).map(|i| tappet(1, f64::from(i) * 10.0, Passage::Every, Action::On));
    let knots = [Knot::at_rest(0.0, 0.0), Knot::at_rest(100.0, 50.0)];
    let table = CamTable::new(super::cam(&knots, tappets.collect()));
    let mut coupling = started(table, CamInput::default(), at(0.0), at(0.0));
    let found = coupling.step(&at(100.0), CYCLE_NS).expect("somewhere").tappets;
    let times: Vec<_> = found.triggers().map(|trigger| trigger.time_ns).collect();
    // Interpolated: 10, 20 and 30 of 100.
    assert_eq!((times.as_slice(), found.lost), (&[100_000, 200_000, 300_000][..], 2));
}

fn input() -> impl Strategy<Value = CamInput> {
    let ramp = prop::array::uniform3(0.5..50.0_f64);
    (-20.0..20.0_f64, 0.2..3.0_f64, -20.0..20.0_f64, -3.0..3.0_f64, ramp).prop_map(
        |(master_offset, master_scaling, slave_offset, slave_scaling, [v, a, d])| CamInput {
            master_offset,
            master_scaling,
            slave_offset,
            slave_scaling,
            start_mode: StartMode::RampIn,
            velocity_difference: v,
            acceleration: a,
            deceleration: d,
            ..CamInput::default()
        },
    )
}

proptest! {
    /// A ramp begins where the slave is and as it moves, keeps its limits next to the cam, and ends on the cam.
    #[test]
    fn ramps_bridge(input in input(), slave in -50.0..50.0_f64, velocity in -20.0..20.0_f64, share in 0.0..1.0_f64) {
        let table = CamTable { slave_absolute: true, ..CamTable::new(lift()) };
        let place = share * 100.0;
        let master = |step: i64| {
            let x = place + 0.02 * f64::from(i32::try_from(step).expect("few"));
            moving((x - input.master_offset) / input.master_scaling, 20.0 / input.master_scaling)
        };
        let begin = moving(slave, velocity);
        let mut coupling = started(table.clone(), input, master(0), begin);
        let jump = coupling.jump_from(&begin);
        prop_assert!(jump.position.abs() < 1e-9 && jump.velocity.abs() < 1e-9, "{jump:?}");
        let plain = CamInput { start_mode: StartMode::Absolute, ..input };
        let mut direct = started(table, plain, master(0), begin);
        let most = input.velocity_difference.max((velocity - direct.output().slave.velocity).abs());
        let mut synchronous = coupling.output().in_sync;
        let mut step = 0;
        while !synchronous {
            step += 1;
            prop_assert!(step < 1_000_000, "it comes onto the cam");
            let on_cam = direct.step(&master(step), step * CYCLE_NS).expect("somewhere").slave;
            let found = coupling.step(&master(step), step * CYCLE_NS).expect("somewhere");
            prop_assert!((found.slave.velocity - on_cam.velocity).abs() <= most + 1e-9);
            synchronous = found.in_sync;
            if synchronous {
                prop_assert!((found.slave.position - on_cam.position).abs() < 1e-9);
            }
        }
    }

    /// Velocity and acceleration of the slave are the derivatives of its position, and within the cam's bounds.
    #[test]
    fn set_points_belong_together(input in input(), start in 0.0..100.0_f64, speed in -30.0..30.0_f64, pull in -30.0..30.0_f64) {
        let input = CamInput { start_mode: StartMode::Absolute, ..input };
        let cam = lift();
        let master = |t: f64| State {
            position: (start - input.master_offset) / input.master_scaling + speed * t + pull * t * t / 2.0,
            velocity: speed + pull * t,
            acceleration: pull,
        };
        let mut coupling = started(CamTable::new(Arc::clone(&cam)), input, master(0.0), at(0.0));
        let h = 1e-4;
        let mut states = vec![coupling.output().slave];
        for step in 1..=2_i32 {
            let t = f64::from(step) * h;
            states.push(coupling.step(&master(t), i64::from(step) * 100_000).expect("somewhere").slave);
        }
        let slope = (states[2].position - states[0].position) / (2.0 * h);
        prop_assert!((slope - states[1].velocity).abs() < 1e-3 * (1.0 + states[1].velocity.abs()));
        // The third derivative of the lift jumps where it begins again.
        let bend = (states[2].velocity - states[0].velocity) / (2.0 * h);
        prop_assert!((bend - states[1].acceleration).abs() < 0.1 * (1.0 + states[1].acceleration.abs()), "{bend} {:?}", states[1]);
        let motion = MasterMotion { velocity: master(h).velocity.abs(), acceleration: pull.abs(), jerk: 0.0 };
        let factors = Factors { master: input.master_scaling, slave: input.slave_scaling };
        let peak = cam.curve().peak(crate::Quantity::Acceleration, &motion, factors);
        prop_assert!(states[1].acceleration.abs() <= peak.value * (1.0 + 1e-9) + 1e-9);
    }
}

/// Elements of the editor are not needed to follow a cam, but give the same one.
#[test]
fn a_source_is_followed() {
    let mut source = crate::Source::new("lift");
    source.period = None;
    source.master.max = 100.0;
    source.elements =
        vec![Element::Point(Knot::at_rest(0.0, 0.0)), Element::Point(Knot::at_rest(100.0, 50.0))];
    let made = source.compile(crate::Compile::Polynomial).expect("a cam");
    assert_eq!(made.curve(), lift().curve());
}
