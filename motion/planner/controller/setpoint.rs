//! Tool set-point: the interpolator's output per cycle.

use super::Heading;
use nalgebra::{Point3, Vector3};
use twin_path::Place;
use twin_path::{EXTRA_AXES, ExtraPosition, MParameters};

/// Set-point of the tool at one instant, in the work frame: the output of [`super::Interpolator`] per cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolSetpoint {
    /// Time since the start of the program, ns.
    pub time_ns: i64,
    /// The block whose element is being traversed (`iActObjectSourceNo`).
    pub place: Place,
    /// True on a rapid (G0): the tool is not engaged.
    pub rapid: bool,
    /// True on a probing move (G38.2 to G38.5), at whose end a probe may touch something.
    pub probing: bool,
    /// True on a jump (G92): the set-point after it is elsewhere, and no path leads there.
    pub jumping: bool,
    /// Status of the interpolator (`iStatus`).
    pub status: Status,
    /// Number of the switch passed last (`iLastSwitch`); 0 before the first.
    pub last_switch: u8,
    /// The M function that waits to be acknowledged (`wM`).
    pub m_function: Option<u16>,
    /// Its parameters (`SMC_GetMParameters`, manual 6.2.10); none of them without an M function.
    pub m_parameters: MParameters,
    /// State of all switches (`dwSwitches`): bit n − 1 is switch n.
    pub switches: u32,
    /// Programmed velocity along the path (F), m/s.
    pub feed: f64,
    /// Position, m (`piSetPosition`).
    pub position: Point3<f64>,
    /// Velocity, m/s.
    pub velocity: Vector3<f64>,
    /// Acceleration, m/s².
    pub acceleration: Vector3<f64>,
    /// Velocity along the path, m/s.
    pub path_velocity: f64,
    /// Path length since the start, m; jumps have none. `dWayPos` with the input `dLastWayPos` wired to it.
    pub way: f64,
    /// Direction of the path seen from above (what `SMC_CalcDirectionFromVector` starts from, manual 8.2.2).
    pub heading: Heading,
    /// The extra axes P Q U V W; zero as long as the program has not named any.
    pub extra: ExtraMotion,
}

/// Position, velocity and acceleration of the extra axes, in their technical unit u.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExtraMotion {
    /// Positions, u.
    pub position: ExtraPosition,
    /// Velocities, u/s.
    pub velocity: [f64; EXTRA_AXES.len()],
    /// Accelerations, u/s².
    pub acceleration: [f64; EXTRA_AXES.len()],
}

impl ToolSetpoint {
    /// Direction of the motion (`vecActTangent`): a unit vector, zero at rest.
    pub fn tangent(&self) -> Vector3<f64> {
        self.velocity.try_normalize(0.0).unwrap_or_default()
    }
}

/// Status of the interpolator: `SMC_INT_STATUS`. `IPO_UNKNOWN` (0) does not occur.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Status {
    /// `IPO_INIT` (1): the path has not begun, its beginning is not wholly known.
    #[default]
    Init,
    /// `IPO_ACCEL` (2).
    Accelerating,
    /// `IPO_CONSTANT` (3).
    Constant,
    /// `IPO_DECEL` (4).
    Decelerating,
    /// `IPO_FINISHED` (5): nothing follows.
    Finished,
    /// `IPO_WAIT` (6): at rest until somebody or something lets it go on.
    Waiting,
}

impl Status {
    /// The manual's number of it.
    pub const fn number(self) -> u8 {
        match self {
            Self::Init => 1,
            Self::Accelerating => 2,
            Self::Constant => 3,
            Self::Decelerating => 4,
            Self::Finished => 5,
            Self::Waiting => 6,
        }
    }

    /// True if the path has begun and not ended (`bWorking`).
    pub const fn is_working(self) -> bool {
        !matches!(self, Self::Init | Self::Finished)
    }

    /// By the sign of an acceleration along the path.
    pub(crate) fn of_acceleration(acceleration: f64) -> Self {
        if acceleration > 0.0 {
            Self::Accelerating
        } else if acceleration < 0.0 {
            Self::Decelerating
        } else {
            Self::Constant
        }
    }
}
