//! Tests of efforts along paths: a peer's inverse dynamics, their mechanical power, and limits with friction.

use proptest::prelude::*;

use super::parallel::rows_of;
use super::scara::{circle, feed_forwards, scara};
use super::*;
use twin_planner::time_optimal::{DragRow, Row};

pub(super) const FREE: AxisLoad = AxisLoad {
    effort_limit: f64::INFINITY,
    coulomb_friction: 0.0,
    viscous_friction: 0.0,
    armature: 0.0,
    headroom: 0.0,
};

fn drag_row(row: &EffortRow) -> DragRow {
    let [a, b, drag] = row.per_limit();
    DragRow { row: Row { a, b }, drag }
}

/// Efforts on the circle of the reference at time `t`, by a path parameter u = t + 0.1·sin(3t) that goes neither as fast
/// as time nor evenly.
fn on_circle(dynamics: &mut PathDynamics, t: f64) -> JointVector {
    let (speed, acceleration) = (1.0 + 0.3 * (3.0 * t).cos(), -0.9 * (3.0 * t).sin());
    let [position, velocity, change] = circle(t);
    let first = velocity / speed;
    let second = (change - first * acceleration) / (speed * speed);
    let [position, first, second] = [position, first, second].map(|values| axis_vector(&values, 3));
    let torque = dynamics.at(&position, &first, &second).unwrap();
    joint_vector(torque.axes().iter().map(|axis| axis.effort(acceleration, speed)))
}

#[test]
fn efforts_on_a_circle_are_pinocchios() {
    let mut dynamics = PathDynamics::new(&scara(), &[FREE; 3], down()).unwrap();
    for [cycle, expected @ ..] in feed_forwards() {
        let effort = on_circle(&mut dynamics, (cycle + 0.5) * 1e-3);
        assert!((effort - joints(expected)).amax() < 1e-12, "{cycle}: {effort} {expected:?}");
    }
}

/// Every row of the peer's file, if it is there (`TWIN_SHARED` or next to the workspace).
#[test]
fn all_efforts_on_the_circle_are_pinocchios() {
    let columns = ["t_s", "tau_ff1", "tau_ff2", "tau_ff3"];
    let Some(rows) = rows_of("scara_circle.csv", columns) else { return };
    let mut dynamics = PathDynamics::new(&scara(), &[FREE; 3], down()).unwrap();
    let apart = rows.iter().map(|[time, expected @ ..]| {
        (on_circle(&mut dynamics, time + 0.5e-3) - joints(*expected)).amax()
    });
    let worst = apart.fold(0.0, f64::max);
    println!("{} rows, at most {worst:e} Nm or N apart", rows.len());
    assert!(rows.len() >= 5000 && worst < 1e-11, "{} rows, {worst} apart", rows.len());
}

#[test]
fn a_lift_and_its_rotor() {
    let load = AxisLoad { armature: 2.0, viscous_friction: 30.0, coulomb_friction: 4.0, ..FREE };
    let load = AxisLoad { effort_limit: 100.0, ..load };
    let mut dynamics = PathDynamics::new(&lift(3.0), &[load], down()).unwrap();
    // Half as fast as the path, and bending.
    let torque = dynamics.at(&axes([0.2]), &axes([0.5]), &axes([-0.1])).unwrap();
    let [axis] = torque.axes() else { panic!("one axis") };
    let expected = [2.5, -0.5, 3.0 * G, 15.0, 4.0];
    let found = [axis.inertia, axis.centrifugal, axis.weight, axis.viscous, axis.dry];
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12, "{found} is not {expected}");
    }
    // Upwards 100 − 3·g − 4 N are left for 15 N·s/m.
    let most = (100.0 - 3.0 * G - 4.0) / 15.0;
    let (speed, limiting) = torque.largest_speed().unwrap();
    assert!((speed - most).abs() < 1e-12 && limiting == 0);
    assert_eq!((torque.overloaded(), torque.rows().count()), (None, 2));
    let weak = AxisLoad { effort_limit: 33.0, ..load };
    let mut dynamics = PathDynamics::new(&lift(3.0), &[weak], down()).unwrap();
    let torque = dynamics.at(&axes([0.2]), &axes([0.5]), &axes([0.0])).unwrap();
    assert_eq!((torque.overloaded(), torque.largest_speed()), (Some(0), Some((0.0, 0))));
    assert!(torque.rows().any(|row| row.limit < 0.0));
}

/// 3 kg and a rotor of 2 kg at 4 m/s² up to 0.5 m/s take 20 N, 15 N of drag, 4 N of dry friction and the weight: of which the
/// headroom leaves 0.8² of what is spare to the mass, and 0.8 to the drag.
#[test]
fn motors_with_enough_for_every_motion_are_known() {
    let most = [[0.5, 4.0]];
    for (headroom, spare) in [(0.0, 35.0), (0.2, (20.0 + 0.8 * 15.0) / 0.64)] {
        for (more, enough) in [(1e-9, true), (-1e-9, false)] {
            let effort_limit = 3.0 * G + 4.0 + spare + more;
            let load = AxisLoad { armature: 2.0, viscous_friction: 30.0, headroom, ..FREE };
            let load = AxisLoad { coulomb_friction: 4.0, effort_limit, ..load };
            let dynamics = PathDynamics::new(&lift(3.0), &[load], down()).unwrap();
            assert_eq!(dynamics.always_enough(&most), [enough], "{headroom} {more}");
        }
    }
    // Without limits of the axis nothing is enough, and where something turns nothing is known.
    let load = AxisLoad { effort_limit: 1e9, ..FREE };
    let dynamics = PathDynamics::new(&lift(3.0), &[load], down()).unwrap();
    assert_eq!(dynamics.always_enough(&[[0.5, f64::INFINITY]]), [false]);
    let dynamics = PathDynamics::new(&crooked(), &[load; 3], down()).unwrap();
    assert_eq!(dynamics.always_enough(&[[0.5, 4.0]; 3]), [false; 3]);
}

#[test]
fn only_motors_with_limits_have_rows() {
    let limited = AxisLoad { effort_limit: 10.0, ..FREE };
    let mut dynamics = PathDynamics::new(&crooked(), &[FREE, limited, FREE], down()).unwrap();
    let zero = axes([0.0; 3]);
    let torque = dynamics.at(&zero, &axes([1.0; 3]), &zero).unwrap();
    assert!(torque.rows().map(|row| row.axis).eq([1, 1]));
    assert_eq!(torque.largest_speed(), None);
    let wrong = AxisLoad { viscous_friction: -1.0, ..FREE };
    let error = PathDynamics::new(&crooked(), &[FREE, wrong, FREE], down()).unwrap_err();
    assert!(
        matches!(error, PhysicsError::DriveParameter { axis: 1, parameter, .. } if parameter == "viscous_friction")
    );
    let error = dynamics.at(&axes([0.0; 2]), &zero, &zero).unwrap_err();
    assert!(matches!(error, PhysicsError::AxisCount { given: 2, expected: 3 }));
    let error = dynamics.at(&axes([0.0, f64::NAN, 0.0]), &zero, &zero).unwrap_err();
    assert!(matches!(error, PhysicsError::Input(_)));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// The power of all motors is the growth of kinetic and potential energy, by differences over time, on a machine in
    /// which nothing is aligned.
    #[test]
    fn power_becomes_energy(
        position in prop::array::uniform3(-1.0..1.0f64),
        first in prop::array::uniform3(-2.0..2.0f64),
        second in prop::array::uniform3(-5.0..5.0f64),
        speed in 0.1..2.0f64,
        acceleration in -5.0..5.0f64,
    ) {
        let mut dynamics = PathDynamics::new(&crooked(), &[FREE; 3], down()).unwrap();
        let torque = dynamics.at(&axes(position), &axes(first), &axes(second)).unwrap();
        let power: f64 = torque.axes().iter().zip(first)
            .map(|(axis, first)| axis.effort(acceleration, speed) * first * speed).sum();
        let energies = Unfolded::new(&crooked(), 3, down(), JointVector::zeros());
        let [position, first, second] = [position, first, second].map(joints);
        let energy = |t: f64| {
            let (s, rate) = (t * (speed + 0.5 * t * acceleration), speed + t * acceleration);
            let velocity = (first + second * s) * rate;
            energies.energy(&(position + (first + second * (0.5 * s)) * s), &velocity)
        };
        let dt = 1e-4;
        let growth = (8.0 * (energy(dt) - energy(-dt)) - (energy(2.0 * dt) - energy(-2.0 * dt))) / (12.0 * dt);
        prop_assert!((power - growth).abs() < 1e-6 * growth.abs().max(10.0), "{power} W, {growth} W");
    }

    /// Wherever the rows and the largest speed are kept, the motor is within its limit, dry friction of either sign, at
    /// every override within the headroom; the reference speed does not matter for that.
    #[test]
    fn rows_are_never_optimistic(
        mass in 0.5..20.0f64,
        rates in (-2.0..2.0f64, -5.0..5.0f64),
        friction in (0.0..40.0f64, 0.0..10.0f64),
        spare in 1.0..200.0f64,
        headroom in 0.0..0.6f64,
        reference in 0.0..5.0f64,
        motion in (-1.0..1.0f64, 0.0..1.0f64),
    ) {
        let (viscous_friction, coulomb_friction) = friction;
        let effort_limit = mass * G + coulomb_friction + spare;
        let load = AxisLoad { effort_limit, coulomb_friction, viscous_friction, armature: 0.0, headroom };
        let mut dynamics = PathDynamics::new(&lift(mass), &[load], down()).unwrap();
        let torque = dynamics.at(&axes([0.0]), &axes([rates.0]), &axes([rates.1])).unwrap();
        let axis = torque.axes()[0];
        prop_assert!(axis.holds());
        let most = torque.largest_speed().map_or(10.0, |(speed, _)| speed.min(10.0));
        let mut speed = motion.1 * most;
        let rows: Vec<_> = torque.rows().map(|row| drag_row(&row).tangent(reference)).collect();
        // The fastest there is room for, and an acceleration within it: rest is always possible.
        let bounds = |speed: f64| rows.iter().fold([f64::NEG_INFINITY, f64::INFINITY], |[low, high], row| {
            let bound = (1.0 - row.b * speed * speed) / row.a;
            if row.a > 0.0 { [low, high.min(bound)] } else { [low.max(bound), high] }
        });
        prop_assert!(bounds(0.0)[0] < 0.0 && bounds(0.0)[1] > 0.0);
        while bounds(speed)[0] > bounds(speed)[1] {
            speed *= 0.5;
        }
        let [low, high] = bounds(speed);
        for acceleration in [low, high, low + (high - low) * (0.5 + 0.5 * motion.0)] {
            for part in 0..=40 {
                let factor = f64::from(part) / 40.0 / (1.0 - headroom);
                let effort = axis.effort(acceleration * factor * factor, speed * factor);
                for dry in [-coulomb_friction, coulomb_friction] {
                    let effort = (effort + dry).abs();
                    prop_assert!(effort <= effort_limit * (1.0 + 1e-9), "{effort} N of {effort_limit} N");
                }
            }
        }
    }

    /// At the reference speed, rows give the motor all that friction leaves.
    #[test]
    fn rows_are_exact_at_their_reference(
        first in 0.1..2.0f64,
        second in -5.0..5.0f64,
        part in 0.01..1.0f64,
    ) {
        let load = AxisLoad { effort_limit: 100.0, coulomb_friction: 5.0, viscous_friction: 20.0, ..FREE };
        let mut dynamics = PathDynamics::new(&lift(4.0), &[load], down()).unwrap();
        let torque = dynamics.at(&axes([0.0]), &axes([first]), &axes([second])).unwrap();
        let speed = part * torque.largest_speed().unwrap().0;
        let [up, _] = torque.axes()[0].rows(0);
        let tangent = drag_row(&up).tangent(speed);
        let acceleration = (1.0 - tangent.b * speed * speed) / tangent.a;
        let effort = torque.axes()[0].effort(acceleration, speed) + 5.0;
        prop_assert!((effort - 100.0).abs() < 1e-9, "{effort} N");
        // Newton: what is accelerated is the mass alone.
        let falling = 4.0 * (first * acceleration + second * speed * speed + G);
        prop_assert!((effort - falling - 20.0 * first * speed - 5.0).abs() < 1e-9);
    }
    /// Up to the largest constant speed every motor keeps it, beyond one does not; where there is none all speeds are kept.
    #[test]
    fn the_largest_constant_speed_is_the_first_too_fast(
        position in prop::array::uniform3(-1.0..1.0f64),
        first in prop::array::uniform3(-2.0..2.0f64),
        second in prop::array::uniform3(-20.0..20.0f64),
        viscous_friction in 0.0..30.0f64,
        effort_limit in 150.0..400.0f64,
    ) {
        let load = AxisLoad { effort_limit, coulomb_friction: 3.0, viscous_friction, ..FREE };
        let mut dynamics = PathDynamics::new(&crooked(), &[load; 3], down()).unwrap();
        let torque = dynamics.at(&axes(position), &axes(first), &axes(second)).unwrap();
        for axis in torque.axes().iter().filter(|axis| axis.holds()) {
            let keeps = |speed: f64| {
                // Viscous friction only where it is to be overcome.
                let plain = axis.centrifugal * speed * speed + axis.weight;
                let drag = axis.viscous * speed;
                let demands = [plain + drag.max(0.0), -plain + (-drag).max(0.0)];
                demands.into_iter().all(|demand| demand + 3.0 <= effort_limit * (1.0 + 1e-9))
            };
            let most = axis.largest_constant_speed();
            for part in 0..=100 {
                prop_assert!(keeps(most.min(1e3) * f64::from(part) / 100.0), "{axis:?} {most}");
            }
            prop_assert!(most.is_infinite() || !keeps(most * (1.0 + 1e-6)), "{axis:?} {most}");
        }
    }
}
