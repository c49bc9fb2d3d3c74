//! What all errors of devices have: where they happened.

use super::{Axes, DriveError, Exchange};

impl DriveError {
    /// Where and in the course of what it happened.
    pub fn at(&self) -> &Exchange {
        match self {
            Self::Transport { at, .. }
            | Self::Timeout { at, .. }
            | Self::Protocol { at, .. }
            | Self::Device { at, .. }
            | Self::Rejected { at, .. }
            | Self::Alarm { at, .. }
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
            | Self::HomingFailed { at, .. }
            | Self::HomeCount { at, .. }
            | Self::EncoderDiffers { at, .. }
            | Self::EncoderFault { at, .. }
            | Self::ProbeFailed { at }
            | Self::EepromFailed { at }
            | Self::NotKept { at, .. }
            | Self::ParameterDiffers { at, .. }
            | Self::NotWritten { at, .. }
            | Self::Identity { at, .. }
            | Self::NotRunning { at }
            | Self::ByteOrder { at }
            | Self::AxisMessages { at, .. }
            | Self::CardMessages { at, .. }
            | Self::Range { at, .. }
            | Self::Unsupported { at, .. }
            | Self::NoParameter { at, .. }
            | Self::ReadOnly { at, .. }
            | Self::ParameterValue { at, .. }
            | Self::Setting { at, .. } => at,
        }
    }

    /// Which axes of the device it is about, where it says; that of a station with one axis is named by [`Self::at`].
    pub fn axes(&self) -> Option<Axes> {
        match self {
            Self::LimitSwitch { axes, .. }
            | Self::Moving { axes, .. }
            | Self::HomingFailed { axes, .. } => Some(*axes),
            Self::NotArrived { axis, .. }
            | Self::HomeCount { axis, .. }
            | Self::EncoderDiffers { axis, .. }
            | Self::NotWritten { axis, .. } => Some(*axis),
            Self::AxisMessages { axis, .. } | Self::EncoderFault { axis, .. } => {
                let place = u32::from(*axis).checked_sub(1)?;
                1_u8.checked_shl(place).map(Axes::Numbers)
            }
            _ => None,
        }
    }

    /// Whether an encoder says it: counters and orders are as they should be, and the shaft is not.
    pub fn is_of_encoder(&self) -> bool {
        matches!(self, Self::EncoderDiffers { .. } | Self::EncoderFault { .. })
    }

    /// Whether the device takes parameters and tells none: a module the check sum of whose EEPROM is wrong.
    pub fn takes_writes_only(&self) -> bool {
        use crate::bim2ax::bits::card::CHECKSUM;
        matches!(self, Self::CardMessages { messages, .. } if messages & CHECKSUM != 0)
    }

    /// Whether nothing is wrong but that an axis is on its limit switch.
    pub fn is_limit_switch(&self) -> bool {
        match self {
            Self::LimitSwitch { .. } => true,
            Self::AxisMessages { messages, .. } => {
                use crate::bim2ax::bits::message::{
                    HARD_STOPPED, MINUS_SWITCH, PHASE_OPEN, PHASE_SHORT, PHASES_OFF, PLUS_SWITCH,
                    POWER_ABSENT,
                };
                let wrong = HARD_STOPPED | PHASES_OFF | PHASE_OPEN | PHASE_SHORT | POWER_ABSENT;
                messages & (PLUS_SWITCH | MINUS_SWITCH) != 0 && messages & wrong == 0
            }
            _ => false,
        }
    }
}
