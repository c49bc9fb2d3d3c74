//! Work frame: position and orientation of the program's coordinates in the machine frame (SoftMotion manual 8.3).

mod above;
mod cuboid;
mod unit_vectors;

pub use cuboid::{Cuboid, CuboidError};
pub use unit_vectors::{FrameError, UNIT_VECTOR_TOLERANCE, UnitVectors};

use crate::{Pose, ToolJerk, ToolMotion};
use above::Above;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

/// The work frame, in which the program is written, as it lies in the machine frame: turned, then shifted.
///
/// Directions ([`Pose::direction`]) are turned in space and seen from above: the direction d in the work frame is the
/// vector R·(cos d, sin d, 0), and its direction in the machine frame is the angle of its projection on the machine's
/// x-y plane. For a frame that is only turned about z this adds the yaw. A frame that is upside down reverses the sense.
/// Whole turns are kept: the result is continuous in d. (Should a tilted frame show its x-y plane edge-on, a direction
/// that points straight up or down has no projection; it is then taken to turn as fast as it does in the work frame.
/// From above such a frame shows two directions only, so they have no way back: on that way, too, they are taken to
/// turn as fast in one frame as in the other.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkFrame {
    machine_from_work: Isometry3<f64>,
    seen_from_above: Above,
}

impl WorkFrame {
    /// A work frame with its origin at `translation` (m, machine frame), turned about the machine's x axis by
    /// `roll`, then about y by `pitch`, then about z by `yaw` (rad): R = Rz(yaw)·Ry(pitch)·Rx(roll), the `dA`, `dB`,
    /// `dC` of `SMC_UnitVectorToRPY` ([`UnitVectors::roll_pitch_yaw`]).
    pub fn new(translation: Vector3<f64>, roll: f64, pitch: f64, yaw: f64) -> Self {
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let placed = Self::placed(rotation, translation);
        if roll == 0.0 && pitch == 0.0 {
            // As given, with its whole turns.
            return Self { seen_from_above: Above::Turned { start: yaw, sense: 1.0 }, ..placed };
        }
        placed
    }

    /// A work frame turned by `rotation`, with its origin at `translation` (m, machine frame).
    ///
    /// [`UnitVectors::rotation`] gives the rotation to axes that are known as vectors.
    pub fn placed(rotation: UnitQuaternion<f64>, translation: Vector3<f64>) -> Self {
        let machine_from_work = Isometry3::from_parts(Translation3::from(translation), rotation);
        let seen_from_above = if rotation.i == 0.0 && rotation.j == 0.0 {
            // Both signs are the same rotation; this one has its angle within half a turn.
            let sign = rotation.w.signum();
            let start = 2.0 * (sign * rotation.k).atan2(sign * rotation.w);
            Above::Turned { start, sense: 1.0 }
        } else {
            Above::new(&rotation.to_rotation_matrix())
        };
        Self { machine_from_work, seen_from_above }
    }

    /// The work frame on a cuboid of which six points were probed: origin in its corner, z out of face A, x along the
    /// edge of A and B. [`Cuboid`] has the sketch.
    pub fn from_cuboid(cuboid: &Cuboid) -> Self {
        Self::placed(cuboid.unit_vectors().rotation(), cuboid.corner().coords)
    }

    /// The work frame that is the machine frame.
    pub fn identity() -> Self {
        Self::new(Vector3::zeros(), 0.0, 0.0, 0.0)
    }

    /// The placement itself: takes work coordinates to machine coordinates.
    pub const fn machine_from_work(&self) -> &Isometry3<f64> {
        &self.machine_from_work
    }

    /// A point of the work frame (m) in the machine frame.
    pub fn point_to_machine(&self, point: &Point3<f64>) -> Point3<f64> {
        self.machine_from_work.transform_point(point)
    }

    /// A point of the machine frame (m) in the work frame: `SMC_CoordinateTransformation3D`
    /// ([`UnitVectors::coordinate_transformation`]).
    pub fn point_to_work(&self, point: &Point3<f64>) -> Point3<f64> {
        self.machine_from_work.inverse_transform_point(point)
    }

    /// A free vector (a velocity, an acceleration, a normal) of the work frame in the machine frame.
    pub fn vector_to_machine(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        self.machine_from_work.transform_vector(vector)
    }

    /// A tool pose of the work frame in the machine frame.
    pub fn pose_to_machine(&self, pose: &Pose) -> Pose {
        let [direction, ..] = self.seen_from_above.of(pose.direction);
        Pose { position: self.point_to_machine(&pose.position), direction }
    }

    /// A tool pose of the machine frame in the work frame.
    pub fn pose_to_work(&self, pose: &Pose) -> Pose {
        let [direction, ..] = self.seen_from_above.inverse().of(pose.direction);
        Pose { position: self.point_to_work(&pose.position), direction }
    }

    /// A tool motion of the work frame in the machine frame.
    pub fn motion_to_machine(&self, motion: &ToolMotion) -> ToolMotion {
        let [direction, slope, curvature, _] = self.seen_from_above.of(motion.pose.direction);
        let rate = motion.direction_velocity;
        ToolMotion {
            pose: Pose { position: self.point_to_machine(&motion.pose.position), direction },
            velocity: self.vector_to_machine(&motion.velocity),
            acceleration: self.vector_to_machine(&motion.acceleration),
            direction_velocity: slope * rate,
            direction_acceleration: slope * motion.direction_acceleration + curvature * rate * rate,
        }
    }

    /// The jerk in the machine frame of a tool that moves as `motion` in the work frame, with the jerk `jerk` there.
    ///
    /// In a tilted frame the direction's also depends on its rate and acceleration: a tool that turns steadily in the
    /// work does not look like it from above.
    pub fn jerk_to_machine(&self, motion: &ToolMotion, jerk: &ToolJerk) -> ToolJerk {
        let [_, slope, curvature, third] = self.seen_from_above.of(motion.pose.direction);
        let (rate, acceleration) = (motion.direction_velocity, motion.direction_acceleration);
        let direction = slope * jerk.direction
            + 3.0 * curvature * rate * acceleration
            + third * rate * rate * rate;
        ToolJerk { linear: self.vector_to_machine(&jerk.linear), direction }
    }
}

impl Default for WorkFrame {
    fn default() -> Self {
        Self::identity()
    }
}
