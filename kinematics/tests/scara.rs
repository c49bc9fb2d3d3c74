//! Tests of `Scara2` beyond the worked vectors and the properties of all transforms.

use super::machines::elbows;
use super::seeded;
use crate::scara::{Elbow, Scara2};
use crate::{
    AxisVector, Coordinate, DimensionError, Kinematics, KinematicsError, Pose, ReachOf, ToolMotion,
    Transform,
};
use nalgebra::{Point3, Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

fn solve(scara: &Scara2, x: f64, y: f64) -> Result<[f64; 2], KinematicsError> {
    scara.to_axes(&Vector2::new(x, y)).map(Into::into)
}

fn tip(scara: &Scara2, axes: [f64; 2]) -> [f64; 2] {
    scara.to_tool(&axes.into()).unwrap().into()
}

fn axes(values: [f64; 2]) -> AxisVector {
    AxisVector::from_values(values)
}

/// The machine of the SoftMotion vectors `trafo-scara2-*`: arms 250 and 200 mm, offsets 10° and −20°.
fn manual(elbow: Elbow) -> Scara2 {
    Scara2::new([0.25, 0.2], [10_f64.to_radians(), -20_f64.to_radians()], elbow).unwrap()
}

#[test]
fn trafo_scara2_unreachable() {
    for elbow in [Elbow::Low, Elbow::High] {
        let pose = Pose::at(0.4, 0.3, 0.0);
        let error = manual(elbow).inverse(&pose, &AxisVector::zeros(2)).unwrap_err();
        let KinematicsError::Unreachable { target, of: ReachOf::Arms, distance, reach } = error
        else {
            panic!("{error}")
        };
        assert_eq!(Point3::from(target), pose.position);
        assert!((distance - 0.5).abs() < 1e-15);
        assert!((reach[0] - 0.05).abs() < 1e-15 && (reach[1] - 0.45).abs() < 1e-15);
        let said = "(400.000, 300.000, 0.000) mm is 500.000 mm away, reach is 50.000 to 450.000 mm";
        assert_eq!(error.to_string(), said);
    }
}

/// Arms 3 and 4, tip 5 away: a right angle at the elbow, and the elbow on the right of the line to the tip when low.
#[test]
fn right_triangle() {
    for (elbow, sign) in [(Elbow::Low, 1.0), (Elbow::High, -1.0)] {
        let scara = Scara2::new([3.0, 4.0], [0.0; 2], elbow).unwrap();
        let [alpha, beta] = solve(&scara, 5.0, 0.0).unwrap();
        assert!((beta - sign * PI / 2.0).abs() < 1e-15, "{beta}");
        assert!((alpha + sign * 4_f64.atan2(3.0)).abs() < 1e-15, "{alpha}");
    }
}

#[test]
fn both_arms_point_along_x_when_the_axes_are_at_their_offsets() {
    let scara = manual(Elbow::Low);
    let [x, y] = tip(&scara, scara.offsets());
    assert!((x - 0.45).abs() < 1e-15 && y.abs() < 1e-16, "{x} {y}");
    assert_eq!((scara.arms(), scara.elbow()), ([0.25, 0.2], Elbow::Low));
}

#[test]
fn refuses_arms_without_length() {
    let refusal = |arms, offset| Scara2::new(arms, [0.0, offset], Elbow::Low).unwrap_err();
    let error = refusal([0.25, 0.0], 0.0);
    assert_eq!(error, DimensionError::ArmLength { arm: 1, length: 0.0 });
    assert_eq!(error.to_string(), "arm 2 is 0.000 mm long; it must be longer than 0");
    assert_eq!(refusal([f64::INFINITY, 0.2], 0.0), DimensionError::NotFinite);
    assert_eq!(refusal([0.25, 0.2], f64::NAN), DimensionError::NotFinite);
}

#[test]
fn refuses_what_is_no_number_and_the_wrong_number_of_axes() {
    let scara = manual(Elbow::Low);
    let near = AxisVector::zeros(2);
    let pose = Pose::at(0.3, 0.2, 0.0);
    let lost = KinematicsError::NotFinite;
    assert_eq!(scara.inverse(&Pose::at(0.3, f64::NAN, 0.0), &near), Err(lost));
    assert_eq!(scara.inverse(&pose, &axes([0.0, f64::INFINITY])), Err(lost));
    assert_eq!(scara.forward(&axes([0.0, f64::NAN])), Err(lost));
    for x in [f64::NAN, 1e200] {
        assert!(matches!(solve(&scara, x, 0.0), Err(KinematicsError::Unreachable { .. })), "{x}");
    }
    let count = KinematicsError::AxisCount { given: 3, expected: 2 };
    assert_eq!(scara.inverse(&pose, &AxisVector::zeros(3)), Err(count));
    assert_eq!(scara.forward(&AxisVector::zeros(3)), Err(count));
    let mut tool = ToolMotion::at_rest(pose);
    tool.velocity.x = f64::INFINITY;
    assert_eq!(scara.inverse_motion(&tool, &near), Err(lost));
    // Nor does it leave its plane.
    assert!(scara.inverse(&Pose::at(0.3, 0.2, 1e-10), &near).is_ok());
    let expected = KinematicsError::NoAxis { coordinate: Coordinate::Z, value: 0.001 };
    assert_eq!(scara.inverse(&Pose::at(0.3, 0.2, 0.001), &near), Err(expected));
}

/// Equal arms reach their own axis, where the direction of the first arm is free: it stays where it is.
#[test]
fn equal_arms_fold_onto_the_axis() {
    for elbow in [Elbow::Low, Elbow::High] {
        let scara = Scara2::new([0.2, 0.2], [0.3, 0.0], elbow).unwrap();
        for zero in [0.0, -0.0] {
            let found = scara.inverse(&Pose::at(zero, zero, 0.0), &axes([1.25, 3.0])).unwrap();
            assert!((found[0] - 1.25).abs() < 1e-15, "{found:?}");
            assert!((found[1] - PI).abs() < 1e-15, "{found:?}");
            assert!((solve(&scara, zero, zero).unwrap()[0] - 0.3).abs() < 1e-15);
        }
    }
}

prop_compose! {
    fn machines()(
        arms in prop::array::uniform2(0.05..1.0),
        offsets in prop::array::uniform2(-TAU..TAU),
        elbow in elbows(),
    ) -> Scara2 {
        Scara2::new(arms, offsets, elbow).unwrap()
    }
}

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn forward_undoes_inverse(
        scara in machines(), part in 0.0..=1.0, angle in -PI..PI, turns in prop::array::uniform2(-20.0..20.0),
    ) {
        let [inner, outer] = scara.reach();
        let r = inner + part * (outer - inner);
        let pose = Pose::at(r * angle.cos(), r * angle.sin(), 0.0);
        let near = axes(turns);
        let found = scara.inverse(&pose, &near).unwrap();
        let back = scara.forward(&found).unwrap();
        prop_assert!((back.position - pose.position).norm() < 1e-13 * outer, "{found:?} {back:?}");
        for (found, near) in found.iter().zip(turns) {
            prop_assert!((found - near).abs() <= PI + 1e-12, "{found} {near}");
        }
        let beta = (found[1] - scara.offsets()[1]).rem_euclid(TAU);
        let low = beta <= PI + 1e-12;
        let high = beta >= PI - 1e-12 || beta <= 1e-12;
        prop_assert!(if scara.elbow() == Elbow::Low { low } else { high }, "{beta}");
    }

    /// The other branch reaches the same point with the elbow mirrored at the line to it.
    #[test]
    fn branches_mirror_each_other(arms in prop::array::uniform2(0.05..1.0), part in 0.01..0.99, angle in -1.5..1.5) {
        let [low, high] = [Elbow::Low, Elbow::High].map(|elbow| Scara2::new(arms, [0.0; 2], elbow).unwrap());
        let [inner, outer] = low.reach();
        let r = inner + part * (outer - inner);
        let [x, y] = [r * f64::cos(angle), r * f64::sin(angle)];
        let ([a1, b1], [a2, b2]) = (solve(&low, x, y).unwrap(), solve(&high, x, y).unwrap());
        prop_assert!(b1 > 0.0 && (b1 + b2).abs() < 1e-15, "{b1} {b2}");
        let sum = (a1 + a2 - 2.0 * angle).rem_euclid(TAU);
        prop_assert!(sum.min(TAU - sum) < 1e-12, "{a1} {a2} {angle}");
    }

    #[test]
    fn edges_of_the_reach_are_sharp(scara in machines(), angle in -PI..PI) {
        let [inner, outer] = scara.reach();
        let solve = |r: f64| solve(&scara, r * angle.cos(), r * angle.sin());
        let step = 1e-12 * outer;
        prop_assert!(solve(outer).is_ok() && solve(outer - step).is_ok());
        prop_assert!(solve(inner).is_ok() && solve(inner + step).is_ok());
        prop_assert!(solve(outer + step).is_err(), "{:?}", solve(outer + step));
        if inner > step {
            prop_assert!(solve(inner - step).is_err(), "{:?}", solve(inner - step));
        }
    }

    #[test]
    fn on_an_edge_the_tool_can_only_rest(scara in machines(), angle in -PI..PI, outside in any::<bool>()) {
        let r = scara.reach()[usize::from(outside)];
        let near = axes(scara.offsets());
        let pose = Pose::at(r * angle.cos(), r * angle.sin(), 0.0);
        let mut tool = ToolMotion::at_rest(pose);
        let rest = scara.inverse_motion(&tool, &near).unwrap();
        prop_assert_eq!(rest.position, scara.inverse(&pose, &near).unwrap());
        prop_assert!(rest.velocity.iter().chain(rest.acceleration.iter()).all(|value| *value == 0.0));
        tool.velocity = Vector3::new(0.0, 1e-3, 0.0);
        let singular = Err(KinematicsError::Singular(pose.position.into()));
        prop_assert_eq!(scara.inverse_motion(&tool, &near), singular);
    }
}
