//! Context of a drive error: the action and exchange in which it happened, and faults of the protocol.

use std::{fmt, sync::Arc};

/// Action under way with a device when something went wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Nothing: the driver knows the outcome without asking.
    Nothing,
    /// Opening and configuring the port.
    Open,
    /// Reading status and positions.
    ReadState,
    /// Sending a command of the device's own numbering.
    Command {
        /// Number on the wire.
        number: u16,
        /// Name in the manual.
        name: &'static str,
    },
    /// Sending a command of the protocol ATB, whose manual has them in hexadecimal.
    Atb {
        /// Code on the wire.
        code: u8,
        /// Name in the manual.
        name: &'static str,
    },
    /// Switching a digital output.
    SwitchOutput {
        /// Number of the output, from 1.
        output: u8,
        /// On or off.
        on: bool,
    },
    /// Reading registers or bits.
    Read {
        /// Content.
        what: &'static str,
        /// First address.
        address: u16,
        /// Number of them.
        count: u16,
    },
    /// Writing registers or bits.
    Write {
        /// Content.
        what: &'static str,
        /// First address.
        address: u16,
        /// Number of them.
        count: u16,
    },
    /// Looking at identifier and status of a module on a bus.
    Identify,
    /// Reading a zone of a module's memory.
    ReadZone {
        /// Number of the zone.
        zone: u8,
        /// Name in the manual.
        name: &'static str,
    },
    /// Writing a zone of a module's memory.
    WriteZone {
        /// Number of the zone.
        zone: u8,
        /// Name in the manual.
        name: &'static str,
    },
    /// Giving an order to the axes of a module.
    Order {
        /// The order's bits.
        bits: u16,
        /// Name.
        name: &'static str,
    },
    /// Reading or writing a parameter.
    Parameter {
        /// Its number.
        number: u16,
        /// Name.
        name: &'static str,
        /// Written, else read.
        written: bool,
    },
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => f.write_str("nothing"),
            Self::Open => f.write_str("opening the port"),
            Self::ReadState => f.write_str("reading status and positions"),
            Self::Command { number, name } => write!(f, "command {number} ({name})"),
            Self::Atb { code, name } => write!(f, "command {code:02X}h ({name})"),
            Self::SwitchOutput { output, on } => {
                write!(f, "switching output {output} {}", if *on { "on" } else { "off" })
            }
            Self::Read { what, address, count } => {
                write!(f, "reading {what} ({count} from {address})")
            }
            Self::Write { what, address, count } => {
                write!(f, "writing {what} ({count} from {address})")
            }
            Self::Identify => f.write_str("looking at identifier and status"),
            Self::ReadZone { zone, name } => write!(f, "reading zone {zone} ({name})"),
            Self::WriteZone { zone, name } => write!(f, "writing zone {zone} ({name})"),
            Self::Order { bits, name } => write!(f, "order ${bits:04X} ({name})"),
            Self::Parameter { number, name, written } => {
                let what = if *written { "writing" } else { "reading" };
                write!(f, "{what} parameter ${number:02X} ({name})")
            }
        }
    }
}

/// Port, address and action of an error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exchange {
    /// Path of the port.
    pub port: Arc<str>,
    /// Station (slave) address on that port; 0 where the device has none.
    pub address: u8,
    /// Action under way.
    pub action: Action,
}

impl fmt::Display for Exchange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.port)?;
        if self.address != 0 {
            write!(f, ", address {}", self.address)?;
        }
        if self.action == Action::Nothing {
            return Ok(());
        }
        write!(f, ": {}", self.action)
    }
}

/// An answer that arrived in time and is not the answer to what was asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProtocolFault {
    /// Another address answered.
    #[error("another address answered")]
    Station,
    /// The answer belongs to another function.
    #[error("function {sent} was asked, the answer belongs to function {received}")]
    Function {
        /// Function code sent.
        sent: u8,
        /// Function code received.
        received: u8,
    },
    /// The answer has another number of registers than asked for.
    #[error("{expected} registers were asked for, {received} came")]
    Length {
        /// Registers asked for.
        expected: usize,
        /// Registers received.
        received: usize,
    },
    /// A write was confirmed for other registers than those written.
    #[error(
        "{count} registers at {address} were written, the device confirms {confirmed_count} at {confirmed_address}"
    )]
    Confirmation {
        /// First register written.
        address: u16,
        /// Registers written.
        count: u16,
        /// First register confirmed.
        confirmed_address: u16,
        /// Registers confirmed.
        confirmed_count: u16,
    },
    /// The bytes make no frame (wrong check sum, noise).
    #[error("the answer is garbled")]
    Garbled,
    /// Answers do not belong to the questions: more come than were asked for, or later than they may.
    #[error(
        "answers cannot be matched to requests: more came than were requested, or they came too late"
    )]
    OutOfStep,
}
