//! Real drives: opens the ports of a machine file and connects the drivers.

use crate::emulated::demands;
use crate::troubleshooting::advice_in_run;
use twin_drives::{Drive, DriveError};
use twin_machine::{DeviceEntry, Machine};

/// Errors that leave a device without a driver.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The machine file does not say where it is.
    #[error("{file}: device `{device}` needs a `port`: its serial port, or its memory file")]
    NoPort {
        /// The machine file.
        file: String,
        /// The device's name in it.
        device: String,
    },
    /// The port, or the driver.
    #[error("device `{device}`: {source}")]
    Drive {
        /// The device's name in the machine file.
        device: String,
        /// Why.
        source: Box<DriveError>,
    },
}

impl OpenError {
    /// Remedy.
    pub fn advice(&self) -> Option<String> {
        match self {
            Self::NoPort { .. } => None,
            Self::Drive { source, .. } => {
                advice_in_run(source).map(|advice| format!("help: {advice}"))
            }
        }
    }
}

/// Opens the port of a device, by its place in [`Machine::drives`], with its client. Sends nothing.
///
/// # Errors
/// [`OpenError`].
pub fn open(
    machine: &Machine,
    (index, device): (usize, &DeviceEntry),
) -> Result<Box<dyn Drive>, OpenError> {
    let Some(port) = &device.port else {
        let (file, device) = (machine.path.display().to_string(), device.name.clone());
        return Err(OpenError::NoPort { file, device });
    };
    let opened = device.device.open(port, &demands(machine, index), device.waits());
    opened.map_err(|source| {
        let source = Box::new(source);
        OpenError::Drive { device: device.name.clone(), source }
    })
}
