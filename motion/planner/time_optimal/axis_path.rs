//! [`AxisPath`]: axis positions and rates at points of the blended path, through the machine's kinematics.

use super::bound::{AxisLimits, Cap, Rates};
use super::drag::DragRow;
use crate::blended_path::{BlendedElement, BlendedPoint};
use twin_kinematics::{
    AxisDisc, AxisVector, Kinematics, KinematicsError, MAX_AXES, Pose, ToolDisc, ToolJerk,
    ToolMotion,
};

/// A machine has no more further rows than this: both directions of every motor.
pub const MOST_FURTHER_ROWS: usize = 2 * MAX_AXES;

/// The axes at one point of the course.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisPoint {
    /// Their positions, m or rad.
    pub position: AxisVector,
    /// Their derivatives by the parameter.
    pub rates: Rates,
}

/// A machine as feed limiting sees it.
pub trait AxisPath {
    /// Limits of the axes, in their order.
    fn limits(&self) -> &[AxisLimits];

    /// Axis positions before the first point: the first answer is the one nearest to it.
    fn home(&self) -> AxisVector;

    /// The axes where the course is at `s` (m) of `element`, near `near`.
    ///
    /// # Errors
    /// What the kinematics refuses.
    fn axes(
        &self,
        element: &BlendedElement,
        s: f64,
        near: &AxisVector,
    ) -> Result<AxisPoint, KinematicsError>;

    /// Positions of the axes there: those of [`Self::axes`].
    ///
    /// # Errors
    /// As [`Self::axes`].
    fn position(
        &self,
        element: &BlendedElement,
        s: f64,
        near: &AxisVector,
    ) -> Result<AxisVector, KinematicsError> {
        Ok(self.axes(element, s, near)?.position)
    }

    /// A disc of the parameter about `s` of `element`, where the axes are at `point`, on which they are analytic; none if
    /// nothing is known of that.
    fn disc(&self, element: &BlendedElement, s: f64, point: &AxisPoint) -> Option<AxisDisc> {
        let _ = (element, s, point);
        None
    }

    /// Number of rows of [`Self::further`], the same at every place: at most [`MOST_FURTHER_ROWS`].
    fn further_rows(&self) -> usize {
        0
    }

    /// What limits the motion at `point` beside velocities, accelerations and jerks of the axes, like the torques of
    /// motors: rows, written into `rows` where they are not those that hold always ([`DragRow::default`]), and a bound
    /// on u̇².
    fn further(&self, point: &AxisPoint, rows: &mut [DragRow]) -> Cap {
        let _ = (point, rows);
        Cap::NONE
    }
}

/// Kinematics without work frame and additional axes. The direction of the tool is that of the path where the course knows it
/// ([`BlendOptions::turning`](crate::blended_path::BlendOptions::turning)), else 0.
#[derive(Debug)]
pub struct KinematicPath<K> {
    kinematics: K,
    limits: Vec<AxisLimits>,
    home: AxisVector,
}

impl<K: Kinematics> KinematicPath<K> {
    /// The machine `kinematics` with `limits` of its axes, which begins near `home`.
    pub fn new(kinematics: K, limits: Vec<AxisLimits>, home: AxisVector) -> Self {
        Self { kinematics, limits, home }
    }
}

impl<K: Kinematics> AxisPath for KinematicPath<K> {
    fn limits(&self) -> &[AxisLimits] {
        &self.limits
    }

    fn home(&self) -> AxisVector {
        self.home
    }

    fn axes(
        &self,
        element: &BlendedElement,
        s: f64,
        near: &AxisVector,
    ) -> Result<AxisPoint, KinematicsError> {
        let point = element.at(s);
        let bearing = element.bearing(s, &point).unwrap_or_default();
        let BlendedPoint { position, first, second, third, .. } = point;
        // With the parameter in the place of time, derivatives by time are those by the parameter.
        let tool = ToolMotion {
            pose: Pose { position, direction: bearing.along },
            velocity: first,
            acceleration: second,
            direction_velocity: bearing.first,
            direction_acceleration: bearing.second,
        };
        let jerk = ToolJerk { linear: third, direction: bearing.third };
        axis_point(&self.kinematics, &tool, &jerk, near)
    }

    fn disc(&self, element: &BlendedElement, s: f64, _point: &AxisPoint) -> Option<AxisDisc> {
        let point = element.at(s);
        let bearing = element.bearing(s, &point).unwrap_or_default();
        let pose = Pose { position: point.position, direction: bearing.along };
        let (path, turn) = (element.disc(s), element.bearing_disc(s, &point));
        self.kinematics.disc(&ToolDisc {
            pose,
            rate: point.first,
            bend: path.bend,
            turn_rate: bearing.first,
            turn_bend: turn.bend,
            radius: within(path.radius, element).min(turn.radius),
        })
    }
}

/// Discs need not be wider than this many lengths of an element.
const WIDE: f64 = 1e4;

/// `radius`, or what is more than wide enough for `element`.
pub fn within(radius: f64, element: &BlendedElement) -> f64 {
    radius.min(WIDE * element.length())
}

/// The axes of `kinematics` for a tool and its jerk, both with the parameter in the place of time.
///
/// # Errors
/// What the kinematics refuses.
pub fn axis_point(
    kinematics: &dyn Kinematics,
    tool: &ToolMotion,
    jerk: &ToolJerk,
    near: &AxisVector,
) -> Result<AxisPoint, KinematicsError> {
    let (motion, third) = kinematics.inverse_jerk(tool, jerk, near)?;
    let rates = Rates { first: motion.velocity, second: motion.acceleration, third };
    Ok(AxisPoint { position: motion.position, rates })
}
