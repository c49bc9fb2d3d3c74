//! An axis of a drive as SoftMotion's `DriveBasic` library sees it (manual 2.1.3 to 2.2.9, 2.5 and 10.4): technical units,
//! limits, axis groups, homing by switch, diagnosis, and parameters on file.
//!
//! Everything here is pure and told the time, but for what moves a device through [`crate::Drive`]
//! ([`homing::home_by_switch`]) and what reads or sets its parameters ([`backup`]). Files are anything that reads or
//! writes. Where the manual has a number for an error, [`AxisError::number`] gives it.

pub mod backup;
mod decimal;
mod error;
mod gearing;
mod group;
pub mod homing;
mod limits;
mod log;
mod maxima;
mod mode;
mod modulo;
mod ratio;
mod times;
mod tracking;

pub use decimal::DecimalRatio;
pub use error::AxisError;
pub use gearing::{Direction, Gearing, Movement};
pub use group::{AxisGroup, GroupPhase, GroupTask, StartStep};
pub use limits::{AxisLimits, LimitWatch, SetValues, SoftwareMaxima};
pub use log::{DiagnosticLog, LogFormat, LogSelection, LogValues};
pub use maxima::{MaxSetAccDec, MaxSetVelocity, Maximum};
pub use mode::ControlType;
pub use modulo::{Modulo, Place};
pub use ratio::Ratio;
pub use times::TaskTimes;
pub use tracking::TrackingError;
