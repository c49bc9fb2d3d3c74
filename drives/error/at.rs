//! Properties that all errors of devices have: place, axes, kind.

use super::{Axes, DriveError, Exchange};

impl DriveError {
    /// Exchange in which it happened.
    pub fn at(&self) -> &Exchange {
        match self {
            Self::Transport { at, .. }
            | Self::Timeout { at, .. }
            | Self::Protocol { at, .. }
            | Self::Device { at, .. }
            | Self::Mode { at, .. }
            | Self::Stalled { at }
            | Self::NotHomed { at }
            | Self::Parameter { at, .. }
            | Self::Value { at, .. }
            | Self::NotSwitched { at, .. }
            | Self::Locked { at }
            | Self::EnableOpen { at }
            | Self::NotLocked { at }
            | Self::LimitSwitch { at, .. }
            | Self::Moving { at, .. }
            | Self::Unfinished { at, .. }
            | Self::NotArrived { at, .. }
            | Self::NoEffect { at, .. }
            | Self::HomingFailed { at, .. }
            | Self::EncoderDiffers { at, .. }
            | Self::EepromFailed { at }
            | Self::NotKept { at, .. }
            | Self::ParameterDiffers { at, .. }
            | Self::NotWritten { at, .. }
            | Self::Range { at, .. }
            | Self::Unsupported { at, .. }
            | Self::NoParameter { at, .. }
            | Self::ReadOnly { at, .. }
            | Self::ParameterValue { at, .. }
            | Self::Setting { at, .. } => at,
        }
    }

    /// Axes of the device that it is about, where it says; that of a device with one axis is named by [`Self::at`].
    pub fn axes(&self) -> Option<Axes> {
        match self {
            Self::Device { fault, .. } => fault.axes(),
            Self::LimitSwitch { axes, .. }
            | Self::Moving { axes, .. }
            | Self::HomingFailed { axes, .. } => Some(*axes),
            Self::NotArrived { axis, .. }
            | Self::NoEffect { axis, .. }
            | Self::EncoderDiffers { axis, .. }
            | Self::NotWritten { axis, .. } => Some(*axis),
            _ => None,
        }
    }

    /// Whether no proper answer came: the device may or may not have done what it was asked.
    pub fn is_lost(&self) -> bool {
        matches!(self, Self::Timeout { .. } | Self::Protocol { .. })
    }

    /// Whether an encoder says it: counters and orders are as they should be, and the shaft is not.
    pub fn is_of_encoder(&self) -> bool {
        match self {
            Self::Device { fault, .. } => fault.is_of_encoder(),
            error => matches!(error, Self::EncoderDiffers { .. }),
        }
    }

    /// Whether the device takes parameters and reports none.
    pub fn takes_writes_only(&self) -> bool {
        matches!(self, Self::Device { fault, .. } if fault.takes_writes_only())
    }

    /// Whether nothing is wrong but that an axis is on its limit switch.
    pub fn is_limit_switch(&self) -> bool {
        match self {
            Self::Device { fault, .. } => fault.is_limit_switch(),
            error => matches!(error, Self::LimitSwitch { .. }),
        }
    }
}
