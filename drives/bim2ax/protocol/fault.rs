//! Faults that a module reports, or that its memory shows.

use super::bits::{card, message};
use super::describe::{describe_card, describe_encoder, describe_messages};
use twin_drives::{Axes, DeviceFault, DriveError, Exchange};

/// A fault that a module reports, or that its memory shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// Another device than expected is there, or none.
    #[error("identifier {found:02X}h found instead of {expected:02X}h")]
    Identity {
        /// Identifier of the device expected.
        expected: u8,
        /// Identifier that was read.
        found: u8,
    },
    /// The module's software does not run: it has just been switched on or reset.
    #[error("the module's software does not run: wait until it has started, or look at its supply")]
    NotRunning,
    /// The module's numbers are not in the byte order that is set.
    #[error(
        "the bytes of the module's numbers come in the other order: set the byte order to the other one"
    )]
    ByteOrder,
    /// An axis does not do what was asked, or has stopped by itself.
    #[error("axis {axis}: {}", describe_messages(*messages))]
    AxisMessages {
        /// Axis, from 1.
        axis: u8,
        /// The module's message bits for it.
        messages: u16,
    },
    /// The module refuses a parameter order, or obeys no orders at all.
    #[error("{}", describe_card(*messages))]
    CardMessages {
        /// The module's message bits.
        messages: u32,
    },
    /// An encoder, or the module that reads it, reports that it does not work.
    #[error("the encoder of axis {axis}: {}", describe_encoder(*messages))]
    Encoder {
        /// Axis, from 1.
        axis: u8,
        /// "Message codeur".
        messages: u16,
    },
    /// Homing has ended on its cam, and the counter shows something else than is assumed: a module that does not make it
    /// 0, or makes it 0 where it is expected to count on (assumption `homing_keeps_position`).
    #[error(
        "{axis} is home and counts {found} {}, {}",
        axis.unit(),
        if *counted_on {
            format!("after {before} a moment ago: its counter has not counted on, as `homing_keeps_position` assumes")
        } else {
            "not 0: does it count on through homing (assumption `homing_keeps_position`)?".to_owned()
        }
    )]
    HomeCount {
        /// The axis.
        axis: Axes,
        /// Whether the counter is expected to count on through homing.
        counted_on: bool,
        /// Last count on its way, increments.
        before: i64,
        /// Count at home, increments.
        found: i64,
    },
}

impl DeviceFault for Fault {
    fn axes(&self) -> Option<Axes> {
        match self {
            Self::AxisMessages { axis, .. } | Self::Encoder { axis, .. } => {
                let place = u32::from(*axis).checked_sub(1)?;
                1_u8.checked_shl(place).map(Axes::Numbers)
            }
            Self::HomeCount { axis, .. } => Some(*axis),
            _ => None,
        }
    }

    fn is_of_encoder(&self) -> bool {
        matches!(self, Self::Encoder { .. })
    }

    fn is_limit_switch(&self) -> bool {
        use message::{
            HARD_STOPPED, MINUS_SWITCH, PHASE_OPEN, PHASE_SHORT, PHASES_OFF, PLUS_SWITCH,
            POWER_ABSENT,
        };
        let wrong = HARD_STOPPED | PHASES_OFF | PHASE_OPEN | PHASE_SHORT | POWER_ABSENT;
        matches!(self, Self::AxisMessages { messages, .. }
            if messages & (PLUS_SWITCH | MINUS_SWITCH) != 0 && messages & wrong == 0)
    }

    /// A module whose EEPROM has a wrong check sum.
    fn takes_writes_only(&self) -> bool {
        matches!(self, Self::CardMessages { messages } if messages & card::CHECKSUM != 0)
    }
}

impl Fault {
    /// As an error.
    pub(crate) fn at(self, at: Exchange) -> DriveError {
        DriveError::device(at, self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use twin_drives::Action;

    #[test]
    fn modules_on_a_bus_have_no_station() {
        let action = Action::Order { bits: 0x0100, name: "hard stop" };
        let at = Exchange { port: "/dev/uio0".into(), address: 0, action };
        let text = Fault::AxisMessages { axis: 2, messages: 0x0A00 }.at(at).to_string();
        assert_eq!(
            text,
            "/dev/uio0: order $0100 (hard stop): axis 2: phase open, power absent, homing not done"
        );
    }
}
