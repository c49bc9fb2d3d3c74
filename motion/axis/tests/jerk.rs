//! Tests of couplings under limited jerk: no step of the acceleration when a slave comes onto its cam or into its gear
//! (manual 2.1.3, 4.6.1, 5.4).

use super::rig::{CYCLE, Rig, cam, cam_in, endless, in_pos, ramp_in, rotary, short};
use crate::{Axis, AxisConfig, Block, GearInPosRun, MoveVelocity, Movement, SmcError};
use proptest::prelude::*;
use twin_cam::{Cam, CamInput, CamTable, Knot, StartMode};
use twin_profile::RampType;

/// Jerk of the axes, u/s³.
const JERK: f64 = 500.0;

fn rig(ramp: RampType, movement: Movement) -> Rig {
    Rig::new(AxisConfig { ramp, movement, jerk: JERK, ..AxisConfig::default() })
}

fn limited() -> impl Strategy<Value = RampType> {
    prop_oneof![Just(RampType::Sigmoid), Just(RampType::Parabolic)]
}

fn movement() -> impl Strategy<Value = Movement> {
    prop_oneof![Just(Movement::Linear), Just(Movement::Rotary { period: 90.0 })]
}

fn mode() -> impl Strategy<Value = StartMode> {
    use StartMode::{RampIn, RampInNegative, RampInPositive};
    prop_oneof![Just(RampIn), Just(RampInPositive), Just(RampInNegative)]
}

/// A master that turns at 30 u/s.
fn turning() -> (Rig, Block<MoveVelocity>) {
    let (mut master, mut lead) = (rotary(), endless(30.0));
    master.done(&mut lead);
    (master, lead)
}

/// Up by `rise` and down again in a turn.
fn lift(rise: f64) -> CamTable {
    let knots = [Knot::at_rest(0.0, 0.0), Knot::at_rest(180.0, rise), Knot::at_rest(360.0, 0.0)];
    cam(&knots, Vec::new())
}

/// Velocity and acceleration of a slave on the cam.
fn on(cam: &Cam, master: &Axis) -> [f64; 2] {
    let at = cam.curve().at(master.set_position());
    let velocity = master.set_velocity();
    [at.velocity * velocity, at.acceleration * velocity * velocity]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// From any motion a slave comes onto a cam: relative to the cam its acceleration changes by at most the axis's jerk and
    /// stays within its own rates; it arrives, and is on the cam then.
    #[test]
    fn a_slave_comes_onto_its_cam_within_the_jerk(
        ramp in limited(), movement in movement(), start_mode in mode(), rise in -40.0..40.0_f64,
        alone in -40.0..40.0_f64, wait in 0..200_u32, slave_offset in -100.0..100.0_f64,
        velocity in 1.0..60.0_f64, rates in [20.0..150.0_f64, 20.0..150.0_f64],
    ) {
        let (mut master, mut lead) = turning();
        let (mut slave, mut before) = (rig(ramp, movement), endless(alone));
        let table = lift(rise);
        let cam = table.cam.clone();
        for _ in 0..wait {
            master.call(&mut lead, true);
            slave.call(&mut before, true);
        }
        let input = CamInput {
            slave_offset, start_mode, velocity_difference: velocity,
            acceleration: rates[0], deceleration: rates[1], ..CamInput::default()
        };
        let mut block = cam_in(table, input);
        let relative = |master: &Rig, slave: &Rig| {
            let [v, a] = on(&cam, &master.axis);
            [slave.axis.set_velocity() - v, slave.axis.set_acceleration() - a]
        };
        let [mut v0, mut a0] = relative(&master, &slave);
        // What it brings along may be beyond the block's limits until it has been taken back.
        let fastest = velocity.max(v0.abs() + 0.5 * a0 * a0 / JERK);
        let steepest = rates[0].max(rates[1]).max(a0.abs());
        let mut position = slave.axis.set_position();
        let mut in_sync = 0;
        for _ in 0..20_000 {
            master.call(&mut lead, true);
            let u0 = slave.axis.set_velocity();
            let shown = slave.cycle(|axis| block.follow(true, &master.axis, axis));
            prop_assert_eq!(shown.error, None);
            let [v, a] = relative(&master, &slave);
            prop_assert!((a - a0).abs() <= JERK * CYCLE * (1.0 + 1e-6), "{} after {}", a, a0);
            prop_assert!(v.abs() <= fastest + 1e-6, "{} u/s", v);
            prop_assert!(a.abs() <= steepest + 1e-6, "{} u/s²", a);
            let way = short(&slave.axis, slave.axis.set_position() - position);
            let mean = 0.5 * (u0 + slave.axis.set_velocity());
            prop_assert!((way - mean * CYCLE).abs() < 0.1 * (JERK + 500.0) * CYCLE.powi(3), "{} {}", way, mean * CYCLE);
            let backwards = start_mode == StartMode::RampInPositive && v0 >= 0.0 && a0 >= 0.0;
            prop_assert!(slave.axis.period().is_none() || !backwards || v >= -1e-9, "back with {}", v);
            (v0, a0, position) = (v, a, slave.axis.set_position());
            prop_assert_eq!(shown.done, block.running().expect("it follows").is_in_sync());
            if shown.done {
                let place = cam.curve().at(master.axis.set_position()).position + slave_offset;
                prop_assert!((position - slave.axis.wrapped(place)).abs() < 1e-7, "{} {}", position, place);
                in_sync += 1;
                if in_sync > 100 {
                    break;
                }
            }
        }
        prop_assert!(in_sync > 100, "it does not come onto its cam");
    }

    /// A gear in position begins with the acceleration that the slave has, and ends with the master's; meanwhile it
    /// changes no faster than the polynomial's third derivative, which the Bernstein form of it bounds.
    #[test]
    fn a_gear_in_position_begins_with_the_slaves_acceleration(
        ramp in limited(), alone in 5.0..40.0_f64, wait in 2..120_u32, ahead in 20.0..80.0_f64,
        way in -20.0..60.0_f64, ratio in 1..4_i32, window in any::<bool>(),
    ) {
        let mut master = rig(RampType::Trapezoid, Movement::Linear);
        let mut lead = endless(30.0);
        master.done(&mut lead);
        let mut slave = rig(ramp, Movement::Linear);
        let mut before = endless(alone);
        for _ in 0..wait {
            master.call(&mut lead, true);
            slave.call(&mut before, true);
        }
        let places = [master.axis.set_position() + ahead, slave.axis.set_position() + way];
        let mut block = in_pos([ratio, 2], places, if window { 15.0 } else { 0.0 });
        prop_assert!(!block.is_active());
        let (slope, mut jerk) = (0.5 * f64::from(ratio), None);
        for _ in 0..600 {
            let state = [slave.axis.set_position(), slave.axis.set_velocity(), slave.axis.set_acceleration()];
            let [y0, v0, a0] = state;
            let x0 = master.axis.set_position();
            master.call(&mut lead, true);
            let shown = slave.cycle(|axis| block.follow(true, &master.axis, axis));
            prop_assert!(shown.error.is_none() && block.is_active());
            if jerk.is_none() && block.running().is_some_and(GearInPosRun::is_coupling) {
                // Control points of the polynomial over the time that the master takes.
                let t = (block.inputs.master_sync_position - x0) / 30.0;
                let (y1, v1) = (block.inputs.slave_sync_position, slope * 30.0);
                let mut b = [y0, y0 + v0 * t / 5.0, 0.0, 0.0, y1 - v1 * t / 5.0, y1];
                b[2] = 2.0 * b[1] - b[0] + a0 * t * t / 20.0;
                b[3] = 2.0 * b[4] - b[5];
                let third = |i: usize| b[i + 3] - 3.0 * b[i + 2] + 3.0 * b[i + 1] - b[i];
                jerk = Some(60.0 / t.powi(3) * third(0).abs().max(third(1).abs()).max(third(2).abs()));
            }
            let change = (slave.axis.set_acceleration() - a0).abs();
            let most = if shown.done { jerk } else { Some(jerk.unwrap_or(JERK)) };
            let most = most.expect("it has been coupling") * CYCLE;
            prop_assert!(change <= most * (1.0 + 1e-6) + 1e-6, "{} u/s² in a cycle, allowed {}", change, most);
            if shown.done {
                let x = master.axis.set_position() - block.inputs.master_sync_position;
                let place = block.inputs.slave_sync_position + slope * x;
                prop_assert!((slave.axis.set_position() - place).abs() < 1e-7);
                prop_assert!((slave.axis.set_velocity() - slope * 30.0).abs() < 1e-7);
            }
        }
        prop_assert!(jerk.is_some(), "it has not begun");
    }
}

/// 10 u from rest to rest with 10 u/s²: 2 s with steps of the acceleration. With 100 u/s³ the peak v has v²/10 + v/10 = 10,
/// so that v = 9.512 u/s and the way takes 2·(v/10 + 0.1) = 2.102 s.
#[test]
fn a_ramp_takes_as_long_as_its_jerk_needs() {
    for (ramp, seconds) in [(RampType::Trapezoid, 2.0), (RampType::Parabolic, 2.1025)] {
        let config = AxisConfig { ramp, jerk: 100.0, ..AxisConfig::default() };
        let (master, mut slave) = (Rig::new(config), Rig::new(config));
        let input = CamInput { slave_offset: 10.0, ..ramp_in(50.0, 10.0) };
        let mut block = cam_in(lift(5.0), input);
        let cycles = slave.until(|axis| block.follow(true, &master.axis, axis).done);
        assert!((f64::from(cycles) - seconds / CYCLE).abs() <= 1.0, "{ramp:?}: {cycles}");
        assert!((slave.axis.set_position() - 10.0).abs() < 1e-9);
    }
}

/// Such a ramp needs a jerk: error 627 without one, and the motion of the slave goes on.
#[test]
fn a_ramp_without_a_jerk_is_an_error_627() {
    let config = AxisConfig { ramp: RampType::Parabolic, ..AxisConfig::default() };
    let (master, mut slave) = (Rig::new(config), Rig::new(config));
    let full = CamInput { slave_offset: 3.0, ..ramp_in(1.0, 1.0) };
    let error = Some(SmcError::CiRampinNeedsVelaccValues);
    for (input, jerk, expected) in
        [(ramp_in(0.0, 0.0), 100.0, error), (full, 0.0, error), (full, 100.0, None)]
    {
        slave.axis.values.max_jerk = jerk;
        let mut block = cam_in(lift(5.0), input);
        let shown = slave.cycle(|axis| block.follow(true, &master.axis, axis));
        assert_eq!(shown.error, expected);
    }
}
