//! Passive joints of a tripod in closed form, from the pose of the platform.
//!
//! A rod swings about a direction a and then about b, at right angles to it. This turns its direction e, straight down
//! in its own frame, to u. The second turn takes e to a v, the first takes v to u, and neither changes the component
//! along its own direction:
//!
//! ```text
//! v = (a·u)·a + (b·e)·b + γ·a×b,    γ² = |u|² − (a·u)² − (b·e)²
//! ```
//!
//! (Murray, Li and Sastry, *A Mathematical Introduction to Robotic Manipulation*, 1994, section 3.2, subproblem 2.) γ
//! is 0 where the rod is in line with a. Beyond that the rod is mounted the other way round, so the sign of γ is that
//! of the rest pose. Three turns about one point carry the platform. The first two are of that kind and bring the
//! direction c of the third to its place; then the third follows.

use nalgebra::{Isometry3, Point3, Unit, UnitQuaternion, Vector3};
use twin_urdf::{Joint, JointDrive, Model};

use crate::linkage::{Hanging, chain, hanging, platform};

/// Largest cosine of a right angle.
const SQUARE: f64 = 1e-12;

/// Two turns, one after the other.
#[derive(Clone, Copy, Debug)]
struct Turns {
    /// Their directions where nothing has turned yet.
    axes: [Vector3<f64>; 2],
    /// The vector that they turn.
    arm: Vector3<f64>,
    /// Sign of γ.
    side: f64,
}

impl Turns {
    /// With the joints at `rest`; `None` if they are not at right angles, or at rest in line with what they turn.
    fn new(axes: [Vector3<f64>; 2], arm: Vector3<f64>, rest: f64) -> Option<Self> {
        let [a, b] = axes;
        let turned = about(&b, rest) * arm;
        let side = a.cross(&b).dot(&turned);
        let distinct = a.dot(&b).abs() <= SQUARE && side.abs() > SQUARE * arm.norm();
        distinct.then_some(Self { axes, arm, side: side.signum() })
    }

    /// Both angles, rad, with which they turn their arm to `target`, which is as long.
    fn to(&self, target: &Vector3<f64>) -> [f64; 2] {
        let [a, b] = &self.axes;
        let (along_a, along_b) = (a.dot(target), b.dot(&self.arm));
        let squared = target.norm_squared() - along_a * along_a - along_b * along_b;
        let across = a.cross(b) * (self.side * squared.max(0.0).sqrt());
        let between = a * along_a + b * along_b + across;
        [angle(a, &between, target), angle(b, &self.arm, &between)]
    }
}

/// A rod and its joints.
#[derive(Clone, Debug)]
struct Rod {
    /// The axis that moves its carriage, and where it hangs with the carriage at 0, machine frame.
    axis: usize,
    upper: Vector3<f64>,
    /// Frame of the first joint in the machine's.
    frame: UnitQuaternion<f64>,
    turns: Turns,
    /// Its lower end in the frame of the platform.
    lower: Point3<f64>,
    joints: [usize; 2],
}

/// The ball joint that carries the platform.
#[derive(Clone, Debug)]
struct Ball {
    /// Turn of the rod's frame against that of its first joint, nothing turned.
    rod: UnitQuaternion<f64>,
    /// Frame of the first joint in that of the rod.
    frame: UnitQuaternion<f64>,
    turns: Turns,
    /// Frame of the platform in that of the first joint, nothing turned.
    platform: UnitQuaternion<f64>,
    /// Across the last direction, to see how far it has turned.
    across: Vector3<f64>,
    joints: [usize; 3],
}

/// The passive joints of one tripod.
#[derive(Clone, Debug)]
pub(super) struct PassiveJoints {
    /// That which carries the platform first.
    rods: Vec<Rod>,
    ball: Ball,
}

impl PassiveJoints {
    /// Passive joints of `model`; `None` if it is not a tripod, or its joints are not at right angles.
    pub(super) fn of(model: &Model) -> Option<Self> {
        let hanging = hanging(model)?;
        let rods = hanging.iter().map(|rod| Rod::of(model, rod)).collect::<Option<_>>()?;
        Some(Self { rods, ball: Ball::of(model)? })
    }

    /// Sets the passive joints in `values` for the axes at `axes` and the platform at `platform`.
    pub(super) fn follow(&self, axes: &[f64], platform: &Isometry3<f64>, values: &mut [f64]) {
        let mut carrier = None;
        for rod in &self.rods {
            let height = axes.get(rod.axis).copied().unwrap_or_default();
            let hung = (platform * rod.lower).coords - rod.upper - Vector3::z() * height;
            let angles = rod.turns.to(&rod.frame.inverse_transform_vector(&hung));
            put(values, rod.joints, angles);
            let [a, b] = rod.turns.axes;
            let [first, second] = angles;
            carrier = carrier.or_else(|| Some(rod.frame * about(&a, first) * about(&b, second)));
        }
        let Some(carrier) = carrier else { return };
        let Ball { rod, frame, turns, platform: place, across, joints } = &self.ball;
        let first_joint = carrier * rod * frame;
        let turned = first_joint.inverse() * platform.rotation * place.inverse();
        let [first, second] = turns.to(&(turned * turns.arm));
        let [a, b] = &turns.axes;
        let last = (about(a, first) * about(b, second)).inverse() * turned;
        put(values, *joints, [first, second, angle(&turns.arm, across, &(last * across))]);
    }
}

impl Rod {
    fn of(model: &Model, hanging: &Hanging<'_>) -> Option<Self> {
        let Hanging { slide, swing, tilt, ends: [end, lower] } = hanging;
        let tilted = tilt.origin.rotation;
        let axes = [swing.axis.into_inner(), tilted * tilt.axis.into_inner()];
        let upper = slide.origin * Point3::from(swing.origin.translation.vector);
        Some(Self {
            axis: slide.drive.axis()?,
            upper: upper.coords,
            frame: slide.origin.rotation * swing.origin.rotation,
            turns: Turns::new(axes, tilted * end.coords, rest(tilt))?,
            lower: *lower,
            joints: [number(model, swing)?, number(model, tilt)?],
        })
    }
}

impl Ball {
    fn of(model: &Model) -> Option<Self> {
        let chain = chain(model, platform(model)?);
        let [_, _, tilt, first, second, third, fixed @ ..] = chain.as_slice() else { return None };
        let to_second = second.origin.rotation;
        let to_third = to_second * third.origin.rotation;
        let last = to_third * third.axis.into_inner();
        let axes = [first.axis.into_inner(), to_second * second.axis.into_inner()];
        let [_, b] = axes;
        let fixed =
            fixed.first().map_or_else(UnitQuaternion::identity, |joint| joint.origin.rotation);
        Some(Self {
            rod: tilt.origin.rotation,
            frame: first.origin.rotation,
            turns: Turns::new(axes, last, rest(second))?,
            platform: to_third * fixed,
            across: last.cross(&b).try_normalize(SQUARE)?,
            joints: [number(model, first)?, number(model, second)?, number(model, third)?],
        })
    }
}

fn rest(joint: &Joint) -> f64 {
    if let JointDrive::Passive { rest } = joint.drive { rest } else { 0.0 }
}

fn number(model: &Model, joint: &Joint) -> Option<usize> {
    let number = joint.child.checked_sub(1)?;
    model.joints.get(number).is_some().then_some(number)
}

fn put<const N: usize>(values: &mut [f64], joints: [usize; N], angles: [f64; N]) {
    for (joint, angle) in joints.into_iter().zip(angles) {
        if let Some(value) = values.get_mut(joint) {
            *value = angle;
        }
    }
}

/// A turn by `angle` about the unit vector `axis`.
fn about(axis: &Vector3<f64>, angle: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Unit::new_unchecked(*axis), angle)
}

/// By how much a turn about the unit vector `axis` takes `from` to `to`, rad.
fn angle(axis: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
    axis.dot(&from.cross(to)).atan2(from.dot(to) - axis.dot(from) * axis.dot(to))
}
