//! Single axes after PLCopen: state, parameters and motion blocks (manual chapters 2 and 5).
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
mod virtual_axes;

pub use axis::{Access, Axis, PARAMETERS, Parameter, Value};
pub use block::{Block, Motion, Progress, Stage};
pub use config::{AxisConfig, Movement};
pub use diagnose::{Largest, TrackingError, tracking_error};
pub use direction::Direction;
pub use drive::{
    Answer, Capture, Command, ControllerMode, Feedback, Homing, Transfer, VirtualDrive,
};
pub use error::{Language, SmcError};
pub use gear::{
    CamIn, CamRun, CamSwitch, Decouple, DigitalCamSwitch, GearIn, GearInPos, GearInPosRun, Phasing,
    SwitchDirection, SwitchOutputs, TappetMode, Track,
};
pub use latch::Outputs;
pub use master::Master;
pub use math::{atan2, fmod, sgn};
pub use moves::{
    AbortTrigger, AccelerationProfile, AxisStatus, ControlAxis, ControlAxisBy, ControlOutputs,
    Follow, Halt, Home, HomingBySwitch, HomingMode, MoveAbsolute, MoveAdditive,
    MoveContinuousAbsolute, MoveContinuousRelative, MoveRelative, MoveSuperImposed, MoveVelocity,
    ParameterNumber, Planned, PlannedMotion, Points, PositionProfile, Power, PowerStatus, Probed,
    ReadParameter, Reset, SetControllerMode, Stop, SuperImposed, TableRun, TouchProbe, Trigger,
    VelocityProfile, Watched, WriteParameter,
};
pub use ownership::{Refusal, Start};
pub use state::AxisState;
pub use virtual_axes::{Encoder, EncoderConfig, EncoderOutputs, TimeAxis, units};
