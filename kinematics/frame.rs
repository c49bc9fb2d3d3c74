//! Where the work lies in the machine (SoftMotion manual 8.3).

use crate::{Pose, ToolMotion};
use nalgebra::{Isometry3, Matrix2, Point3, Translation3, UnitQuaternion, Vector2, Vector3};
use std::f64::consts::TAU;

/// The work frame, in which the program is written, as it lies in the machine frame: turned, then shifted.
///
/// Directions ([`Pose::direction`]) are turned in space and seen from above: the direction d in the work frame is the
/// vector R·(cos d, sin d, 0), and its direction in the machine frame is the angle of its projection on the machine's
/// x-y plane. For a frame that is only turned about z this adds the yaw. A frame that is upside down reverses the sense.
/// Whole turns are kept: the result is continuous in d. (Should a tilted frame show its x-y plane edge-on, a direction
/// that points straight up or down has no projection; it is then taken to turn as fast as it does in the work frame.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkFrame {
    machine_from_work: Isometry3<f64>,
    seen_from_above: Above,
}

/// What a work frame does to directions.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Above {
    /// Only turned about z: the yaw, rad.
    Turned(f64),
    /// Tilted.
    Tilted {
        /// Upper left corner of the rotation matrix: what is left of a horizontal vector seen from above.
        projection: Matrix2<f64>,
        /// Projected direction of the work frame's x axis, rad.
        start: f64,
        /// 1, or −1 for a frame that is upside down.
        sense: f64,
    },
}

impl WorkFrame {
    /// A work frame with its origin at `translation` (m, machine frame), turned about the machine's x axis by
    /// `roll`, then about y by `pitch`, then about z by `yaw` (rad): R = Rz(yaw)·Ry(pitch)·Rx(roll), the `dA`, `dB`,
    /// `dC` of `SMC_UnitVectorToRPY`.
    pub fn new(translation: Vector3<f64>, roll: f64, pitch: f64, yaw: f64) -> Self {
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let machine_from_work = Isometry3::from_parts(Translation3::from(translation), rotation);
        let seen_from_above = if roll == 0.0 && pitch == 0.0 {
            Above::Turned(yaw)
        } else {
            let projection =
                rotation.to_rotation_matrix().matrix().fixed_view::<2, 2>(0, 0).into_owned();
            let x = projection.column(0);
            let sense = if projection.determinant() < 0.0 { -1.0 } else { 1.0 };
            Above::Tilted { projection, start: x.y.atan2(x.x), sense }
        };
        Self { machine_from_work, seen_from_above }
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

    /// A point of the machine frame (m) in the work frame: `SMC_CoordinateTransformation3D`.
    pub fn point_to_work(&self, point: &Point3<f64>) -> Point3<f64> {
        self.machine_from_work.inverse_transform_point(point)
    }

    /// A free vector (a velocity, an acceleration, a normal) of the work frame in the machine frame.
    pub fn vector_to_machine(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        self.machine_from_work.transform_vector(vector)
    }

    /// A tool pose of the work frame in the machine frame.
    pub fn pose_to_machine(&self, pose: &Pose) -> Pose {
        Pose {
            position: self.point_to_machine(&pose.position),
            direction: self.direction_to_machine(pose.direction)[0],
        }
    }

    /// A tool motion of the work frame in the machine frame.
    pub fn motion_to_machine(&self, motion: &ToolMotion) -> ToolMotion {
        let [direction, slope, curvature] = self.direction_to_machine(motion.pose.direction);
        let rate = motion.direction_velocity;
        ToolMotion {
            pose: Pose { position: self.point_to_machine(&motion.pose.position), direction },
            velocity: self.vector_to_machine(&motion.velocity),
            acceleration: self.vector_to_machine(&motion.acceleration),
            direction_velocity: slope * rate,
            direction_acceleration: slope * motion.direction_acceleration + curvature * rate * rate,
        }
    }

    /// The direction in the machine frame and its first and second derivative by the direction in the work frame.
    fn direction_to_machine(&self, direction: f64) -> [f64; 3] {
        let (projection, start, sense) = match self.seen_from_above {
            Above::Turned(yaw) => return [direction + yaw, 1.0, 0.0],
            Above::Tilted { projection, start, sense } => (projection, start, sense),
        };
        // The projection is a linear map, so it is where it started, turned by as much as the direction, after every
        // half turn and never more than a half turn from there in between: this tells which turn it is in.
        let turned = start + sense * direction;
        let (sin, cos) = direction.sin_cos();
        let seen = projection * Vector2::new(cos, sin);
        let length_squared = seen.norm_squared();
        if length_squared < 1e-24 {
            return [turned, sense, 0.0];
        }
        let angle = seen.y.atan2(seen.x);
        let slope = projection.determinant() / length_squared;
        let change = projection * Vector2::new(-sin, cos);
        let curvature = -2.0 * slope * seen.dot(&change) / length_squared;
        [angle + TAU * ((turned - angle) / TAU).round(), slope, curvature]
    }
}

impl Default for WorkFrame {
    fn default() -> Self {
        Self::identity()
    }
}
