//! Host of emulated devices: thread, pseudo-terminal, clock, faults of the wire and locked files, for any family.
//!
//! A family on a serial line gives its devices as a [`SerialDevice`]; [`Emulated`] serves them on a pseudo-terminal, and
//! [`serve`] on any stream of bytes. A family with another way to its device serves itself on a [`Host`].

mod control;
mod host;
mod locked_file;
mod received;
mod serial;
mod terminal;

pub use control::{Agenda, Control};
pub use host::Host;
pub use locked_file::{LockedFile, replace, restored};
pub use serial::{Emulated, Hosting, Message, SerialDevice, serve};
pub use terminal::{DeviceSpeed, PseudoTerminal};
