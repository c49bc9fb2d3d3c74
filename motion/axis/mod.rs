//! Single axes after PLCopen: their state, their parameters and the blocks that move them (manual chapters 2 and 5).
//!
//! All quantities are in the technical unit u of the axis, as SoftMotion has them: u, u/s, u/s², u/s³.
//!
//! ```text
//! Feedback ─▶ Axis::begin_cycle ─▶ blocks (Power, MoveAbsolute, GearIn …) ─▶ Axis::end_cycle ─▶ Command
//! ```
//!
//! [`Axis`] is the manual's `AXIS_REF` with its drive interface. [`Block`] gives the rules of function blocks to whatever
//! is a [`Motion`]. The blocks carry the manual's names without their prefix; the prefixed ones find them in the search
//! of this documentation (`MC_MoveAbsolute`).
//!
//! No clock and no input or output: the cycle time is told, and what the drive says is given.

mod axis_ref;
mod block;
mod config;
mod cycle;
mod diagnose;
mod direction;
mod drive;
mod error;
mod errors;
mod gear;
mod latch;
mod master;
mod math;
mod moves;
mod ownership;
mod single;
mod state;
#[cfg(test)]
mod tests;
mod virtual_axes;

pub use axis_ref::{Access, PARAMETERS, Parameter, Value};
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
pub use single::Axis;
pub use state::AxisState;
pub use virtual_axes::{Encoder, EncoderConfig, EncoderOutputs, TimeAxis, units};
