//! Tests of singularity measures, margins and branches against closed forms.

use super::seeded;
use crate::gantry::{BeltLayout, Gantry3, GantryCutter3, GantryH2, Sense};
use crate::scara::{Elbow, Scara2, Scara3};
use crate::tripod::{CalibratedTripod, Tripod, TripodDeviations, TripodDimensions};
use crate::{
    AxisSource, AxisVector, Branch, Coordinate, Kinematics, KinematicsError, MachineAxes, Margins,
    Pose, ReachOf, Transform,
};
use nalgebra::{SVector, Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

/// [`Transform::margins`], which [`Kinematics`] has for poses.
fn margins_at<const N: usize>(transform: &impl Transform<N>, tool: &SVector<f64, N>) -> Margins {
    transform.margins(tool)
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{found} {expected}");
}

/// Straight axes move the tool as fast as themselves; a belt moves it by half of what each drive does.
#[test]
fn gantries_are_nowhere_singular() {
    let gantry = Gantry3::new([0.1, 0.2, 0.3]).unwrap();
    let found = gantry.dexterity(&AxisVector::zeros(3), 0.5).unwrap();
    assert_eq!((found.smallest, found.largest), (1.0, 1.0));
    let belt = GantryH2::new([0.0; 2], BeltLayout::default()).unwrap();
    let found = belt.dexterity(&AxisVector::zeros(2), 0.5).unwrap();
    near(found.smallest, FRAC_1_SQRT_2);
    near(found.smallest / found.largest, 1.0);
    let cutter = GantryCutter3::new([0.0; 4], Sense::Clockwise).unwrap();
    near(cutter.dexterity(&AxisVector::zeros(4), 0.5).unwrap().smallest, 1.0);
    let margins = Kinematics::margins(&gantry, &Pose::at(1.0, 2.0, 3.0)).unwrap();
    assert!(margins.boundary.is_infinite() && margins.branch.is_infinite());
    assert_eq!(Kinematics::branch(&gantry), Branch::Only);
}

/// Equal arms at a right angle: the singular values of L·(−1 −1; 1 0) are L times the golden ratio and its inverse.
#[test]
fn a_scara_at_a_right_angle() {
    let scara = Scara2::new([0.3, 0.3], [0.0; 2], Elbow::Low).unwrap();
    let axes = AxisVector::from_values([0.0, FRAC_PI_2]);
    let found = scara.dexterity(&axes, 0.6).unwrap();
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    near(found.largest, 0.5 * golden);
    near(found.smallest, 0.5 / golden);
    near(found.smallest / found.largest, 1.0 / (golden * golden));
    let jacobian = Kinematics::jacobian(&scara, &axes).unwrap();
    for (axis, expected) in [(0, [-0.3, 0.3, 0.0]), (1, [-0.3, 0.0, 0.0])] {
        let column = Coordinate::TRANSLATIONS.map(|coordinate| jacobian.get(coordinate, axis));
        let error = (Vector3::from(column) - Vector3::from(expected)).norm();
        assert!(error < 1e-16, "{column:?}");
    }
    near(jacobian.tool_velocity(&AxisVector::from_values([1.0, -1.0]))[1], 0.3);
}

/// Axes that do not move the tool do not count, and z has an axis of its own.
#[test]
fn whole_machines_are_as_singular_as_their_transform() {
    let scara = Scara2::new([0.3, 0.3], [0.0; 2], Elbow::Low).unwrap();
    let [a, b] = [0, 1].map(AxisSource::Transform);
    let sources = vec![AxisSource::Additional(0), b, AxisSource::Coordinate(Coordinate::Z), a];
    let machine = MachineAxes::new(Box::new(scara), sources, Vector3::zeros()).unwrap();
    let axes = AxisVector::from_values([7.0, FRAC_PI_2, 0.1, 0.0]);
    let alone = scara.dexterity(&AxisVector::from_values([0.0, FRAC_PI_2]), 0.6).unwrap();
    let found = machine.dexterity(&axes, 0.6).unwrap();
    near(found.smallest, alone.smallest);
    // z is moved as fast as its axis, which is faster than anything the arms do.
    near(found.largest, 1.0);
    assert!(machine.is_rotary(1) && !machine.is_rotary(0) && !machine.moves_tool(0));
}

#[test]
fn periods_fold_and_must_be_some() {
    let with_periods = |periods: &[Option<f64>]| {
        let cutter = GantryCutter3::new([0.0; 4], Sense::CounterClockwise).unwrap();
        let sources = (0..4).map(AxisSource::Transform).collect();
        MachineAxes::new(Box::new(cutter), sources, Vector3::zeros()).unwrap().with_periods(periods)
    };
    let machine = with_periods(&[None, None, None, Some(6.0)]).unwrap();
    let folded = machine.fold(&AxisVector::from_values([-1.0, 9.0, 2.0, -1.0]));
    assert_eq!(*folded, [-1.0, 9.0, 2.0, 5.0]);
    let error = with_periods(&[None, Some(0.0)]).unwrap_err();
    assert_eq!(error.to_string(), "axis 2 has a period of 0; it must be above 0");
}

#[test]
fn axes_have_their_branch() {
    for (elbow, branch, beta) in
        [(Elbow::Low, Branch::ElbowLow, 1.0), (Elbow::High, Branch::ElbowHigh, -1.0)]
    {
        let scara = Scara3::new([0.3, 0.2, 0.1], [0.5, 1.5, 2.5], elbow).unwrap();
        let axes = AxisVector::from_values([0.5, 1.5 + beta, 0.0]);
        assert_eq!(Kinematics::branch_at(&scara, &axes), Ok(branch));
        assert_eq!(Kinematics::branch(&scara), branch);
        // A whole turn later it is the same one.
        let turned = AxisVector::from_values([0.5, 1.5 + beta + std::f64::consts::TAU, 0.0]);
        assert_eq!(Kinematics::branch_at(&scara, &turned), Ok(branch));
    }
    assert_eq!(Branch::ElbowHigh.to_string(), "elbow high");
}

pub(super) const TRIPOD: TripodDimensions = TripodDimensions {
    inner_radius: 0.05,
    outer_radius: 0.3,
    rod_length: 0.4,
    rod_distance: 0.06,
    rotation: 0.0,
};

/// With its overhang, the difference of the middles of its rod pairs: 40 and √(300² − 30²) mm from its axis.
fn tripod() -> (Tripod, f64) {
    (Tripod::new(TRIPOD, [0.0; 3]).unwrap(), (0.3_f64 * 0.3 - 0.0009).sqrt() - 0.04)
}

/// Rods are level where the platform is their length away from the overhang.
#[test]
fn tripods_end_where_rods_are_horizontal() {
    let (tripod, overhang) = tripod();
    // Away from A along −x the rods of A are the first to be horizontal.
    let edge = overhang - 0.4;
    for inside in [0.01, -0.02] {
        near(margins_at(&tripod, &Vector3::new(edge + inside, 0.0, 0.0)).boundary, inside);
    }
    let error = tripod.to_axes(&Vector3::new(edge - 0.02, 0.0, 0.25)).unwrap_err();
    let KinematicsError::Unreachable { target, of: ReachOf::Rod(0), distance, reach } = error
    else {
        panic!("{error:?}")
    };
    near(target[0], edge - 0.02);
    near(target[2], 0.25);
    near(distance, 0.42);
    near(reach[1], 0.4);
    assert!(error.to_string().contains("carriage A to span 420.000 mm sideways"), "{error}");
    // In the middle the points on the carriages are in a level plane.
    let margins = margins_at(&tripod, &Vector3::new(0.0, 0.0, -0.3));
    near(margins.branch, (0.16 - overhang * overhang).sqrt());
    // Carriage A so low that its rods would point up from it; carriages too far apart.
    for carriages in [[-0.42, 0.0, 0.0], [0.0, 0.0, 0.9]] {
        let error = tripod.to_tool(&Vector3::from(carriages)).unwrap_err();
        assert!(matches!(error, KinematicsError::Apart(_)), "{error:?}");
    }
}

/// Carriages a degree out of place: the platform tilts, and its way ends before any rod is level.
#[test]
fn measured_tripods_end_where_their_way_ends() {
    let deviations = TripodDeviations {
        tower_angles: [1.0_f64, -1.0, 1.0].map(f64::to_radians),
        ..TripodDeviations::default()
    };
    let tripod = CalibratedTripod::new(TRIPOD.rods(&deviations).unwrap(), [0.0; 3]).unwrap();
    let tool = Vector3::new(-0.08, 0.02, -0.3);
    let margin = margins_at(&tripod, &tool).boundary;
    let around = |way: f64| {
        (0..240).filter(move |number| {
            let (sin, cos) = (f64::from(*number) * 1.5).to_radians().sin_cos();
            tripod.to_axes(&(tool + Vector3::new(cos, sin, 0.0) * way)).is_ok()
        })
    };
    // The directions between those that were looked in may end a little nearer.
    assert_eq!(around(0.99 * margin).count(), 240, "{margin}");
    assert!(around(1.001 * margin).count() < 240, "{margin}");
    assert!((margin - margins_at(&self::tripod().0, &tool).boundary).abs() < 0.02, "{margin}");
}

proptest! {
    #![proptest_config(seeded())]

    /// The product of the singular values is the determinant, L1·L2·sin β.
    #[test]
    fn singular_values_multiply_to_the_determinant(
        arms in prop::array::uniform2(0.05..1.0), alpha in -3.0..3.0, beta in -3.0..3.0, length in 0.1..1.0,
    ) {
        let scara = Scara2::new(arms, [0.0; 2], Elbow::Low).unwrap();
        let found = scara.dexterity(&AxisVector::from_values([alpha, beta]), length).unwrap();
        let expected = (arms[0] * arms[1] * f64::sin(beta)).abs() / (length * length);
        prop_assert!((found.smallest * found.largest - expected).abs() <= 1e-13 * found.largest, "{found:?}");
    }

    #[test]
    fn margins_are_how_far_one_can_go(
        arms in prop::array::uniform2(0.1..0.5), part in 0.0..1.0, angle in -3.0..3.0,
    ) {
        let scara = Scara2::new(arms, [0.0; 2], Elbow::High).unwrap();
        let [inner, outer] = scara.reach();
        let r = inner + part * (outer - inner);
        let direction = Vector2::new(f64::cos(angle), f64::sin(angle));
        let margin = margins_at(&scara, &(direction * r)).boundary;
        let outwards = outer - r < r - inner;
        let there = |part: f64| if outwards { r + part * margin } else { r - part * margin };
        prop_assert!(scara.to_axes(&(direction * there(0.999_999))).is_ok());
        let beyond = scara.to_axes(&(direction * there(1.000_001)));
        prop_assert!(beyond.is_err() || inner < 1e-6 || margin < 1e-9, "{margin}");
        let deeper = margins_at(&scara, &(direction * (outer + 0.01))).boundary;
        prop_assert!((deeper + 0.01).abs() < 1e-12);
    }

    /// Rods of unequal height: the plane's distance is that of its points' common perpendicular.
    #[test]
    fn tripods_lose_hold_in_the_plane_of_their_carriages(
        x in -0.1..0.1, y in -0.1..0.1,
    ) {
        let (tripod, overhang) = tripod();
        let tool = Vector3::new(x, y, 0.0);
        let axes = tripod.to_axes(&tool).unwrap();
        // The mirror image of the platform at the plane is as far from all three points.
        let margin = margins_at(&tripod, &tool).branch;
        let points = [0.0_f64, 120.0, 240.0].map(f64::to_radians).map(|angle| Vector2::new(angle.cos(), angle.sin()) * overhang);
        let points = [points[0].push(axes.x), points[1].push(axes.y), points[2].push(axes.z)];
        let normal = (points[1] - points[0]).cross(&(points[2] - points[0])).normalize();
        prop_assert!(normal.z > 0.0);
        let mirrored = tool + normal * (2.0 * margin);
        for point in points {
            prop_assert!(((mirrored - point).norm() - 0.4).abs() < 1e-12);
        }
    }
}
