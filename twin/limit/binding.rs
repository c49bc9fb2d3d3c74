//! Binding limit: the limit of an axis or of the path that determines the velocity at an instant.

use twin_machine::Axis;
use twin_machine::axis_kind::AxisKind;

/// Limited quantity of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quantity {
    /// m/s or rad/s.
    Velocity,
    /// m/s² or rad/s².
    Acceleration,
    /// m/s³ or rad/s³.
    Jerk,
    /// Steps or revolutions that its drive can make in a second.
    DriveSpeed,
    /// Force or torque of its motor.
    Effort,
}

/// The limit that holds the path back at an instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Binding {
    /// One of an axis, by its place in the machine file.
    Axis {
        /// Which axis.
        axis: usize,
        /// What of it.
        quantity: Quantity,
    },
    /// The programmed feed (F), or the velocity of rapids.
    Feed,
    /// The programmed acceleration along the path (E above zero).
    PathAcceleration,
    /// The programmed deceleration along the path (E below zero).
    PathDeceleration,
    /// The change of the acceleration along the path.
    PathJerk,
    /// The acceleration of the tool tip in space.
    ToolAcceleration,
    /// The acceleration towards the centre of a curve, or its jump where an arc begins or ends.
    Centripetal,
    /// The velocity that an element asks for at its end.
    EndVelocity,
    /// The path has to stop: corners, G0, M functions, dwells.
    Stop,
}

impl Binding {
    /// Time gained by a limit `raised` by this part, if `rate` (s) is the derivative of the time by that part. Where a
    /// limit alone decides, the time goes with a power of it: with 1/v, 1/√a and 1/∛j.
    pub(super) fn gain(self, rate: f64, raised: f64) -> f64 {
        let power = match self {
            Self::Axis { quantity: Quantity::Velocity | Quantity::DriveSpeed, .. }
            | Self::Feed
            | Self::EndVelocity
            | Self::Stop => 1.0,
            Self::Axis { quantity: Quantity::Acceleration | Quantity::Effort, .. }
            | Self::PathAcceleration
            | Self::PathDeceleration
            | Self::ToolAcceleration
            | Self::Centripetal => 0.5,
            Self::Axis { quantity: Quantity::Jerk, .. } | Self::PathJerk => 1.0 / 3.0,
        };
        rate / power * (1.0 - (1.0 + raised).powf(-power))
    }
}

impl Quantity {
    /// As reports and tables for other programs call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Velocity => "axis-velocity",
            Self::Acceleration => "axis-acceleration",
            Self::Jerk => "axis-jerk",
            Self::DriveSpeed => "drive-speed",
            Self::Effort => "axis-effort",
        }
    }

    const fn words(self, kind: AxisKind) -> &'static str {
        match (self, kind) {
            (Self::Velocity, _) => "velocity",
            (Self::Acceleration, _) => "acceleration",
            (Self::Jerk, _) => "jerk",
            (Self::DriveSpeed, _) => "speed of the drive",
            (Self::Effort, kind) => kind.effort_name(),
        }
    }
}

impl Binding {
    /// As reports and tables for other programs call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Axis { quantity, .. } => quantity.name(),
            Self::Feed => "feed",
            Self::PathAcceleration => "path-acceleration",
            Self::PathDeceleration => "path-deceleration",
            Self::PathJerk => "path-jerk",
            Self::ToolAcceleration => "tool-acceleration",
            Self::Centripetal => "centripetal",
            Self::EndVelocity => "end-velocity",
            Self::Stop => "stop",
        }
    }

    /// The axis, if it is a limit of one.
    pub fn axis(self, axes: &[Axis]) -> Option<&Axis> {
        match self {
            Self::Axis { axis, .. } => axes.get(axis),
            _ => None,
        }
    }

    /// In words.
    pub fn words(self, axes: &[Axis]) -> String {
        let words = match self {
            Self::Axis { quantity, .. } => {
                return self.axis(axes).map_or_else(
                    || quantity.words(AxisKind::Linear).to_owned(),
                    |axis| format!("{} of {}", quantity.words(axis.kind), axis.name),
                );
            }
            Self::Feed => "programmed feed (F)",
            Self::PathAcceleration => "programmed acceleration (E)",
            Self::PathDeceleration => "programmed deceleration (E)",
            Self::PathJerk => "jerk along the path",
            Self::ToolAcceleration => "acceleration of the tool tip",
            Self::Centripetal => "acceleration towards the centre of curves",
            Self::EndVelocity => "velocity at the end of an element",
            Self::Stop => "stop",
        };
        words.to_owned()
    }
}
