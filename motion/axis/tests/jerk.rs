//! Tests of slaves that come onto their cams and into gear: under limited jerk without a step of the acceleration (manual 2.1.3, 4.6.1).

use super::*;
use proptest::prelude::*;

/// Jerk of the axes, u/s³.
const JERK: f64 = 500.0;

fn rig(ramp: RampType, movement: Movement) -> Rig {
    Rig::new(AxisConfig { ramp, movement, jerk: JERK, ..AxisConfig::default() })
}

fn ramps() -> impl Strategy<Value = RampType> {
    prop_oneof![Just(RampType::Trapezoid), Just(RampType::Sigmoid), Just(RampType::Parabolic)]
}

fn movement() -> impl Strategy<Value = Movement> {
    prop_oneof![Just(Movement::Linear), Just(Movement::Rotary { period: 90.0 })]
}

fn mode() -> impl Strategy<Value = StartMode> {
    use StartMode::{RampIn, RampInNegative, RampInPositive};
    prop_oneof![Just(RampIn), Just(RampInPositive), Just(RampInNegative)]
}

/// Up by `rise` and down again in a turn.
fn lift(rise: f64) -> CamTable {
    let knots = [Knot::at_rest(0.0, 0.0), Knot::at_rest(180.0, rise), Knot::at_rest(360.0, 0.0)];
    cam(&knots, Vec::new())
}

/// Acceleration of a master, u/s²: a gentle one lasts until its slave meets it. At 1.5 times what the jerk gives in a cycle
/// parabolic slaves come into gear while it begins to change.
fn pull() -> impl Strategy<Value = f64> {
    prop_oneof![3.0..100.0_f64, 1.5 * JERK * CYCLE..1.55 * JERK * CYCLE]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, ..ProptestConfig::default() })]

    /// Whatever its master does at that time.
    #[test]
    fn a_slave_comes_into_gear_within_the_jerk(
        sigmoid in any::<bool>(), alone in -20.0..20.0_f64, wait in 0..60_u32,
        masters in [-20.0..20.0_f64, -20.0..20.0_f64], against in any::<bool>(),
        rates in [20.0..150.0_f64, 20.0..150.0_f64], turns in 1..120_u32, pull in pull(),
    ) {
        let ramp = if sigmoid { RampType::Sigmoid } else { RampType::Parabolic };
        let mut rigs = [rig(ramp, Movement::Linear), rig(ramp, Movement::Linear)];
        let gently = |velocity: f64| {
            let direction = if velocity < 0.0 { Direction::Negative } else { Direction::Positive };
            let (velocity, acceleration, deceleration) = (velocity.abs(), pull, pull);
            Block::new(MoveVelocity { velocity, acceleration, deceleration, direction })
        };
        let (mut leads, mut own) = (masters.map(gently), endless(alone));
        for _ in 0..wait {
            rigs[0].call(&mut leads[0], true);
            rigs[1].call(&mut own, true);
        }
        let mut block = Block::new(GearIn {
            ratio_numerator: if against { -1 } else { 1 },
            ratio_denominator: 1,
            acceleration: rates[0],
            deceleration: rates[1],
        });
        let mut before = rigs[1].axis.set_acceleration();
        let mut coupled = 0;
        for cycle in 0..6000 {
            // The master turns to its second velocity on the way.
            let lead = &mut leads[usize::from(cycle >= turns)];
            coupled += u32::from(follow(&mut rigs, lead, &mut block).done);
            let now = rigs[1].axis.set_acceleration();
            prop_assert!(
                (now - before).abs() <= JERK * CYCLE * (1.0 + 1e-6),
                "{cycle}: {now} after {before} u/s²"
            );
            before = now;
            if coupled > 5 {
                break;
            }
        }
        prop_assert!(coupled > 5);
        let [master, slave] = rigs.each_ref().map(|rig| rig.axis.set_velocity());
        let ratio = f64::from(block.inputs.ratio_numerator);
        prop_assert!((slave - ratio * master).abs() < 1e-9, "{slave} {master} u/s");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// From any motion, relative to the cam within its own rates.
    #[test]
    fn a_slave_comes_onto_its_cam_within_the_jerk(
        ramp in ramps(), movement in movement(), start_mode in mode(), rise in -40.0..40.0_f64,
        alone in -40.0..40.0_f64, wait in 0..200_u32, slave_offset in -100.0..100.0_f64,
        velocity in 1.0..60.0_f64, rates in [20.0..150.0_f64, 20.0..150.0_f64],
    ) {
        let (mut master, mut lead) = (rotary(), endless(30.0));
        master.done(&mut lead);
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
        // Velocity and acceleration of the slave relative to the cam's.
        let relative = |master: &Rig, slave: &Rig| {
            let at = cam.curve().at(master.axis.set_position());
            let v = master.axis.set_velocity();
            let a = slave.axis.set_acceleration() - at.acceleration * v * v;
            [slave.axis.set_velocity() - at.velocity * v, a]
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
            let steps = ramp == RampType::Trapezoid;
            prop_assert!(steps || (a - a0).abs() <= JERK * CYCLE * (1.0 + 1e-6), "{} after {}", a, a0);
            prop_assert!(v.abs() <= fastest + 1e-6, "{} u/s", v);
            prop_assert!(a.abs() <= steepest + 1e-6, "{} u/s²", a);
            let way = short(&slave.axis, slave.axis.set_position() - position);
            let mean = 0.5 * (u0 + slave.axis.set_velocity());
            let bend = if steps { 0.25 * steepest.max(rates[0] + rates[1]) * CYCLE.powi(2) } else { 0.1 * (JERK + 500.0) * CYCLE.powi(3) };
            prop_assert!((way - mean * CYCLE).abs() < bend, "{} {}", way, mean * CYCLE);
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
        // Decoupled it goes on alone with the velocity that it has there; an acceleration takes its time.
        if ramp == RampType::Trapezoid {
            let velocity = slave.axis.set_velocity();
            slave.calls(10, &mut Block::new(Decouple));
            prop_assert!((slave.axis.set_velocity() - velocity).abs() < 1e-9);
            prop_assert_eq!(slave.axis.state(), AxisState::ContinuousMotion);
        }
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
    // Such a ramp needs a jerk: error 627 without one.
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
