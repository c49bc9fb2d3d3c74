//! Tests of step motors beyond their pull-out torque, in closed form: loss of step, rest position of the rotor, number
//! of lost steps.
//!
//! They also test the load angle at which a step is lost.

use std::f64::consts::FRAC_PI_2;

use super::elastic::{machine, slide};
use super::motors::{FULL_STEP, lost_in, stepper};
use super::*;

/// s.
const CYCLE: f64 = 1e-3;

/// A motor that is asked for ever more speed.
struct Pulled<'a> {
    /// kg.
    mass: f64,
    /// Dry friction, N.
    coulomb: f64,
    /// N·s/m.
    viscous: f64,
    /// Pull-out force by speed.
    curve: &'a [[f64; 2]],
    /// With which the field speeds up, m/s².
    acceleration: f64,
}

impl Pulled<'_> {
    /// The speed at which the pull-out force is all that friction and acceleration take.
    fn pull_out_speed(&self) -> f64 {
        let left = |speed: f64| {
            let after = self.curve.iter().position(|[end, _]| *end >= speed).unwrap();
            let [[start, first], [end, last]] = [self.curve[after - 1], self.curve[after]];
            let pull_out = first + (last - first) * (speed - start) / (end - start);
            pull_out - self.coulomb - self.viscous * speed - self.mass * self.acceleration
        };
        let (mut low, mut high) = (1e-6, self.curve[self.curve.len() - 1][0]);
        assert!(left(low) > 0.0 && left(high) < 0.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if left(middle) > 0.0 { low = middle } else { high = middle }
        }
        low
    }

    /// From m·dv/dt = −c − d·v: the time until rest, s, and the way, m, from `speed`.
    fn coasting(&self, speed: f64) -> [f64; 2] {
        let Self { mass, coulomb, viscous, .. } = *self;
        if viscous == 0.0 {
            return [mass * speed / coulomb, 0.5 * mass * speed * speed / coulomb];
        }
        let time = mass / viscous * (viscous * speed / coulomb).ln_1p();
        [time, (mass * speed - coulomb * time) / viscous]
    }
}

/// A field that speeds up: beyond the pull-out torque the rotor falls out of step, coasts to rest under its friction alone, since the
/// field passes it to and fro, and stays there until the field comes to rest: what it loses is the way of the field less its own.
#[test]
fn past_the_pull_out_torque_the_closed_form_number_of_steps_is_lost() {
    let slow: &[[f64; 2]] = &[[0.0, 100.0], [0.1, 90.0], [0.3, 30.0]];
    // More than a turn of the field in a step of the simulation.
    let fast: &[[f64; 2]] = &[[0.0, 100.0], [0.8, 80.0], [1.2, 20.0]];
    for (mass, coulomb, viscous, curve, acceleration, hold) in [
        (20.0, 60.0, 0.0, slow, 0.06, 2.5),
        (20.0, 40.0, 50.0, slow, 0.06, 2.5),
        (20.0, 80.0, 0.0, slow, 0.06, 4.0),
        (30.0, 25.0, 60.0, slow, 0.06, 4.0),
        (10.0, 50.0, 0.0, fast, 0.3, 2.0),
        (4.0, 40.0, 10.0, fast, 0.3, 2.0),
    ] {
        let pulled = Pulled { mass, coulomb, viscous, curve, acceleration };
        let case = format!("{mass} kg, {coulomb} N, {viscous} N·s/m");
        let speed = pulled.pull_out_speed();
        let [coasting, coast] = pulled.coasting(speed);
        assert!(coasting + 0.1 < hold, "{case}: it takes {coasting} s to rest");
        let drive = AxisDriveParameters {
            friction: FrictionParameters::new(coulomb, viscous),
            ..stepper(curve)
        };
        let mut machine = machine(&slide(mass), drive);
        let (mut position, mut velocity) = (0.0, 0.0);
        let (mut time, mut held, mut rest) = (0.0, 0.0, 0.0);
        // Where the field is when it should pull the rotor out, where it is when it does, and what the rotor does.
        let (mut predicted_out, mut out, mut lost) = (None, None, 0);
        let (mut anchor, mut at_rest) = (None, None);
        while rest < 0.3 {
            let a = if held == 0.0 && velocity < 1.1 * speed {
                acceleration * f64::min(time / 0.1, 1.0)
            } else if held < hold {
                held += CYCLE;
                0.0
            } else if velocity > 0.0 {
                (-velocity / CYCLE).max(-5.0)
            } else {
                rest += CYCLE;
                0.0
            };
            time += CYCLE;
            position += CYCLE * (velocity + 0.5 * CYCLE * a);
            velocity += CYCLE * a;
            let before = machine.axis_state().position[0];
            machine.step(&motion([[position], [velocity], [a]])).unwrap();
            lost += lost_in(&mut machine);
            if velocity >= speed {
                predicted_out.get_or_insert(position);
            }
            let now = machine.axis_state().position[0];
            if lost > 0 && out.is_none() {
                out = Some(velocity);
            }
            if lost >= 40 && anchor.is_none() {
                // In the middle of the cycle.
                anchor = Some([0.5 * (before + now), (now - before) / CYCLE]);
            }
            if held >= hold && at_rest.is_none() {
                at_rest = Some(now);
            }
        }
        let (out, predicted_out) = (out.expect(&case), predicted_out.unwrap());
        assert!((out / speed - 1.0).abs() < 0.03, "{case}: out at {out} m/s, not {speed} m/s");

        // From where it has only just fallen out, it coasts.
        let ([from, moving], at_rest) = (anchor.unwrap(), at_rest.unwrap());
        let [_, way] = pulled.coasting(moving);
        let coasted = at_rest - from;
        let apart = (coasted / way - 1.0).abs();
        assert!(apart < 0.03, "{case}: coasted {coasted} m, not {way} m from {moving} m/s");

        let rotor = predicted_out + coast;
        let predicted = (position - rotor) / FULL_STEP;
        #[expect(clippy::cast_precision_loss, reason = "thousands")]
        let found = lost as f64;
        assert!(predicted > 5e3, "{case}: {predicted}");
        let apart = (found - predicted).abs();
        assert!(apart <= f64::max(4.0, 0.01 * predicted), "{case}: {lost} lost, not {predicted}");
        assert_eq!(lost % 4, 0, "{case}: {lost} are not whole turns of the field");
        // It is behind by those, up to the angle at which friction can hold it.
        let behind = (position - machine.axis_state().position[0]) / FULL_STEP - found;
        assert!(behind.abs() <= 1.0, "{case}: {behind} full steps away from its place");
    }
}

/// Set free at a load angle below two full steps the rotor goes back to where it was; beyond that it falls to the next place where the
/// field holds it, four full steps away, and that is when the steps are reported.
#[test]
fn steps_are_lost_at_a_load_angle_of_two_full_steps() {
    for way in [1.0, -1.0] {
        let cases =
            [(0, 0), (16, 0), (31, 0), (33, 1), (64, 1), (95, 1), (97, 2), (159, 2), (161, 3)];
        for (sixteenths, turns) in cases {
            let ahead = way * f64::from(sixteenths) / 16.0;
            let drive = AxisDriveParameters {
                friction: FrictionParameters::new(0.0, 30.0),
                ..stepper(&[[0.0, 200.0]])
            };
            let mut machine = machine(&slide(1.0), drive);
            assert!(machine.fail(0, Fault::Jam));
            // A sixteenth of a step per cycle.
            for cycle in 1..=sixteenths {
                machine.hold([way * f64::from(cycle) / 16.0 * FULL_STEP], 1);
            }
            machine.hold([ahead * FULL_STEP], 1);
            assert!((machine.load_angle(0).unwrap() - ahead).abs() < 1e-9);
            #[expect(clippy::cast_possible_truncation, reason = "1 or −1")]
            let expected = i64::from(4 * turns) * way as i64;
            assert_eq!(lost_in(&mut machine), expected, "{ahead} full steps ahead");
            machine.free(0);
            let state = machine.hold([ahead * FULL_STEP], 1500);
            let wanted = (ahead - way * 4.0 * f64::from(turns)) * FULL_STEP;
            assert!((state.position[0] - wanted).abs() < 1e-9, "{ahead}: {state:?}");
            assert_eq!(lost_in(&mut machine), 0, "{ahead}: no more while it swings");
        }
    }
}

/// A weight hangs on a motor at the angle whose sine it is of the holding torque, up to the last of it; beyond that it falls freely,
/// since a motor out of step holds nothing on average.
#[test]
fn a_weight_above_the_holding_torque_falls() {
    let weight = 3.0 * G;
    for part in [0.5, 0.9, 0.99, 0.999, 1.001, 1.01, 1.2] {
        let mut machine = machine(&lift(3.0), stepper(&[[0.0, weight / part]]));
        let (mut lost, mut fallen, mut time) = (0, [None; 2], 0.0);
        for _ in 0..1500 {
            let state = machine.hold([0.0], 1);
            lost += lost_in(&mut machine);
            time += CYCLE;
            for (fallen, depth) in fallen.iter_mut().zip([0.1, 0.9]) {
                if fallen.is_none() && state.position[0] < -depth {
                    *fallen = Some([time, state.position[0], state.velocity[0]]);
                }
            }
        }
        if part < 1.0 {
            assert_eq!((lost, fallen), (0, [None; 2]), "{part}");
            let angle = part.asin() / FRAC_PI_2;
            assert!((machine.load_angle(0).unwrap() - angle).abs() < 1e-6, "{part}");
            assert!(machine.axis_state().position[0].abs() < 1e-9, "{part}");
            continue;
        }
        let [Some([begin, x, v]), Some([end, y, w])] = fallen else { panic!("{part}: {lost}") };
        // v² = 2·g·s, and g times the time.
        let pull = 0.5 * (w * w - v * v) / (x - y);
        assert!((pull / G - 1.0).abs() < 3e-3, "{part}: falls with {pull} m/s²");
        assert!(((v - w) / (end - begin) / G - 1.0).abs() < 5e-3, "{part}: {v} to {w} m/s");
        let behind = -machine.axis_state().position[0] / FULL_STEP;
        #[expect(clippy::cast_precision_loss, reason = "some ten thousand")]
        let lost = lost as f64;
        // The nearest place at which the field would hold it.
        assert!((behind - lost).abs() <= 3.1 && lost > 3e4, "{part}: {lost}, {behind} behind");
    }
}

/// A field that passes the rotor many times in a millisecond, and more than once in a step of the simulation, does not take it along: a
/// rotor without friction stays slow (fine steps leave a few per mille of a newton, of what damping does at the start), and one
/// with a little stays where it is.
#[test]
fn a_field_that_is_too_fast_for_the_rotor_leaves_it_at_rest() {
    for tenths in 8..=30 {
        // Once in an eighth of a millisecond at 0.8 m/s, and nearly so.
        for speed in [0.1, 0.1003].map(|tenth| f64::from(tenths) * tenth) {
            for coulomb in [0.0, 5.0] {
                let drive = AxisDriveParameters {
                    friction: FrictionParameters::new(coulomb, 0.0),
                    ..stepper(&[[0.0, 100.0]])
                };
                let mut machine = machine(&slide(10.0), drive);
                let mut lost = 0;
                for cycle in 1..=1000 {
                    let position = f64::from(cycle) * CYCLE * speed;
                    machine.step(&motion([[position], [speed], [0.0]])).unwrap();
                    lost += lost_in(&mut machine);
                }
                let state = machine.axis_state();
                let case = format!("{speed} m/s, {coulomb} N: {state:?}");
                let mean_force = 10.0 * state.velocity[0];
                assert!(mean_force.abs() < if coulomb > 0.0 { 0.01 } else { 0.04 }, "{case}");
                let most = if coulomb > 0.0 { 1e-3 } else { 4e-3 };
                assert!(state.position[0].abs() < most, "{case}");
                #[expect(clippy::cast_precision_loss, reason = "some ten thousand")]
                let behind = (speed - state.position[0]) / FULL_STEP - lost as f64;
                assert!(behind.abs() <= 2.0, "{case}: {lost} lost");
            }
        }
    }
}
