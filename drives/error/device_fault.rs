//! Fault that a device reports in the terms of its family.

use std::any::Any;

use super::{Axes, DriveError, Exchange};

/// A fault that a device reports in the terms of its family: a refusal, an alarm, message bits.
///
/// Its text is what the user reads after place and action.
pub trait DeviceFault: std::error::Error + Any + Send + Sync {
    /// The axes of the device that it is about, where it says.
    fn axes(&self) -> Option<Axes> {
        None
    }

    /// Whether an encoder says it.
    fn is_of_encoder(&self) -> bool {
        false
    }

    /// Whether nothing is wrong but that an axis is on its limit switch.
    fn is_limit_switch(&self) -> bool {
        false
    }

    /// Whether the device takes parameters and reports none.
    fn takes_writes_only(&self) -> bool {
        false
    }
}

impl DriveError {
    /// A fault in the terms of a family.
    pub fn device(at: Exchange, fault: impl DeviceFault) -> Self {
        Self::Device { at, fault: Box::new(fault) }
    }

    /// The fault, if it is one of this family.
    pub fn fault<F: DeviceFault>(&self) -> Option<&F> {
        match self {
            Self::Device { fault, .. } => (fault.as_ref() as &dyn Any).downcast_ref(),
            _ => None,
        }
    }
}
