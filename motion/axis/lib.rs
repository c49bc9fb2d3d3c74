//! Single axes after PLCopen: state and motion blocks (manual chapters 2 and 5).
//!
//! All quantities are in the technical unit u of the axis, as in SoftMotion: u, u/s, u/s², u/s³.
//!
//! ```text
//! Feedback ─▶ Axis::begin_cycle ─▶ blocks (Power, MoveAbsolute, GearIn …) ─▶ Axis::end_cycle ─▶ Command
//! ```
//!
//! [`Axis`] is the manual's `AXIS_REF` with its drive interface. [`Block`] applies the rules of function blocks to a
//! [`Motion`]. The blocks have the manual's names without their prefix; the documentation search finds them by the
//! prefixed names, too (`MC_MoveAbsolute`).
//!
//! There is no clock and no input or output: the caller gives the cycle time and the drive's feedback.
//!
//! ```
//! use twin_axis::{Axis, AxisConfig, Block, Direction, MoveAbsolute, Power, VirtualDrive};
//!
//! // A linear axis with a cycle of 1 ms, on a virtual drive.
//! let mut axis = Axis::new(AxisConfig::default());
//! let mut drive = VirtualDrive::new(0.0);
//! let power = Power { regulator_on: true, drive_start: true };
//! // To 250 mm at 200 mm/s and 1000 mm/s²: s/v + v/a = 1.25 s + 0.2 s.
//! let mut go = Block::new(MoveAbsolute {
//!     position: 250.0,
//!     velocity: 200.0,
//!     acceleration: 1000.0,
//!     deceleration: 1000.0,
//!     direction: Direction::Positive,
//! });
//! for cycle in 0..1500 {
//!     axis.begin_cycle(&drive.feedback());
//!     let powered = power.call(true, &mut axis).status;
//!     go.call(powered, &mut axis);
//!     drive.follow(&axis.end_cycle());
//! }
//! assert!((axis.act_position() - 250.0).abs() < 1e-9);
//! assert!(go.duration().is_none(), "the move is over");
//! ```

mod axis;
mod block;
mod config;
mod cycle;
mod diagnose;
mod direction;
mod drive;
mod error;
mod gear;
mod latch;
mod master;
mod math;
mod moves;
mod ownership;
mod state;
#[cfg(test)]
mod tests;

pub use axis::Axis;
pub use block::{Block, Motion, Progress, Stage};
pub use config::{AxisConfig, Movement};
pub use diagnose::{Largest, TrackingError, tracking_error};
pub use direction::Direction;
pub use drive::{Capture, Command, Feedback, Homing, VirtualDrive};
pub use error::{Language, SmcError};
pub use gear::{CamIn, CamRun, Decouple, GearIn, GearInPos, GearInPosRun, Phasing};
pub use latch::Outputs;
pub use master::Master;
pub use math::{atan2, fmod};
pub use moves::{
    AbortTrigger, AccelerationProfile, ControlAxis, ControlAxisBy, ControlOutputs, Follow, Halt,
    Home, MoveAbsolute, MoveAdditive, MoveContinuousAbsolute, MoveContinuousRelative, MoveRelative,
    MoveSuperImposed, MoveVelocity, Planned, PlannedMotion, Points, PositionProfile, Power,
    PowerStatus, Probed, Reset, Stop, SuperImposed, TableRun, TouchProbe, Trigger, VelocityProfile,
    Watched,
};
pub use ownership::{Refusal, Start};
pub use state::AxisState;
