//! Real drives: opens the ports of a machine file and connects the drivers.

use crate::emulated::{driver_options, module_options, smartdrive_axis};
use crate::troubleshooting::advice_in_run;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use twin_bim2ax::{
    Bim2AxDrive, Bim2AxDriveOptions, Bim2AxOptions, MappedMemory, Master, Memory, MemoryFile,
    ModuleAxis,
};
use twin_drives::{Action, Drive, DriveError, Exchange};
use twin_interpcnc::{InterpCncDrive, InterpCncOptions};
use twin_machine::{Bim2AxEntry, DeviceEntry, DriveFamily, Machine};
use twin_smartdrive::{SmartDriveBus, SmartDriveOptions};

/// Errors that leave a device without a driver.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The machine file does not say where it is.
    #[error("{file}: device `{device}` has no `port`, which says where it is")]
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

/// Response timeout of the driver of a device, and the pause before it asks again. The pause keeps a late response from
/// being taken for another.
pub(crate) fn waits(device: &DeviceEntry) -> [Duration; 2] {
    let said = device.answer_ms.map(|time_ms| Duration::from_millis(time_ms.into()));
    let usual = match &device.family {
        DriveFamily::InterpCnc(_) => {
            let usual = InterpCncOptions::new(Vec::new());
            [usual.deadline, usual.worst_latency]
        }
        DriveFamily::SmartDrive(_) => {
            let usual = SmartDriveOptions::new(Vec::new());
            [usual.deadline, usual.worst_latency]
        }
        DriveFamily::Bim2Ax(_) => {
            let usual = Bim2AxOptions::default();
            return [said.unwrap_or(usual.deadline), usual.worst_latency];
        }
    };
    said.map_or(usual, |deadline| [deadline, 2 * deadline])
}

/// Opens the port of a device, by its place in [`Machine::drives`], with its driver. Sends nothing.
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
    let [deadline, worst_latency] = waits(device);
    let drive = match &device.family {
        DriveFamily::InterpCnc(entry) => {
            let options = InterpCncOptions {
                echo: entry.echo,
                deadline,
                worst_latency,
                ..driver_options(machine, (index, entry))
            };
            InterpCncDrive::open(port, &options).map(boxed)
        }
        DriveFamily::SmartDrive(entry) => {
            let axes = machine.axes_of(index).map(|(_, axis)| smartdrive_axis(axis, entry));
            let assumptions = entry.assumptions;
            let options = SmartDriveOptions {
                assumptions,
                deadline,
                worst_latency,
                ..SmartDriveOptions::new(axes.collect())
            };
            SmartDriveBus::open(port, &options).map(boxed)
        }
        DriveFamily::Bim2Ax(entry) => module(machine, (index, entry), (port, deadline)).map(boxed),
    };
    drive.map_err(|source| {
        let source = Box::new(source);
        OpenError::Drive { device: device.name.clone(), source }
    })
}

fn boxed<D: Drive + 'static>(drive: D) -> Box<dyn Drive> {
    Box::new(drive)
}

fn module(
    machine: &Machine,
    (index, entry): (usize, &Bim2AxEntry),
    (port, deadline): (&str, Duration),
) -> Result<Bim2AxDrive, DriveError> {
    let places = machine.axes_of(index).filter_map(|(_, axis)| Some(axis.drive.as_ref()?.index));
    let axes = places.filter_map(|place| ModuleAxis::ALL.get(place).copied()).collect();
    let Bim2AxEntry { byte_order, assumptions, .. } = *entry;
    let driver = Bim2AxOptions { byte_order, assumptions, deadline, ..Bim2AxOptions::default() };
    let options = Bim2AxDriveOptions { driver, axes, ..module_options(entry) };
    let failed = |source| {
        let port: Arc<str> = port.into();
        DriveError::Transport { at: Exchange { port, address: 0, action: Action::Open }, source }
    };
    let memory = module_memory(Path::new(port), entry.map_offset).map_err(failed)?;
    Bim2AxDrive::new(port, memory, &options)
}

/// The memory of a module, a device or an emulator's file, locked against other masters.
///
/// # Errors
/// If it cannot be opened, or another program is its master.
pub(crate) fn module_memory(path: &Path, map_offset: Option<u64>) -> io::Result<ModuleMemory> {
    let Some(start) = map_offset else { return Ok(ModuleMemory::File(MemoryFile::open(path)?)) };
    let memory = MappedMemory::open(path, start)?;
    Ok(ModuleMemory::Device { memory, _master: Master::of_device(path, start)? })
}

/// As [`module_memory`], also if another program is the master: for a stop, which has to get through.
///
/// # Errors
/// If it cannot be opened.
pub(crate) fn module_beside(path: &Path, map_offset: Option<u64>) -> io::Result<ModuleMemory> {
    match (module_memory(path, map_offset), map_offset) {
        (Err(error), None) if error.kind() == io::ErrorKind::ResourceBusy => {
            Ok(ModuleMemory::Beside(Box::new(MemoryFile::beside(path)?)))
        }
        (Err(error), Some(start)) if error.kind() == io::ErrorKind::ResourceBusy => {
            Ok(ModuleMemory::Beside(Box::new(MappedMemory::open(path, start)?)))
        }
        (memory, _) => memory,
    }
}

/// The memory of a module.
pub(crate) enum ModuleMemory {
    File(MemoryFile),
    /// Others are kept from it as long as this lives.
    Device {
        memory: MappedMemory,
        _master: Master,
    },
    /// Another program is its master.
    Beside(Box<dyn Memory>),
}

impl std::fmt::Debug for ModuleMemory {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::File(_) => "a memory file",
            Self::Device { .. } => "a device",
            Self::Beside(_) => "a module that has another master",
        })
    }
}

impl ModuleMemory {
    /// True if another program is the master of the module.
    pub(crate) fn is_beside(&self) -> bool {
        matches!(self, Self::Beside(_))
    }
}

impl Memory for ModuleMemory {
    fn read(&mut self, offset: u8, bytes: &mut [u8]) -> io::Result<()> {
        match self {
            Self::File(memory) => memory.read(offset, bytes),
            Self::Device { memory, .. } => memory.read(offset, bytes),
            Self::Beside(memory) => memory.read(offset, bytes),
        }
    }

    fn write(&mut self, offset: u8, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::File(memory) => memory.write(offset, bytes),
            Self::Device { memory, .. } => memory.write(offset, bytes),
            Self::Beside(memory) => memory.write(offset, bytes),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{module_beside, module_memory};
    use std::io::ErrorKind;

    #[test]
    fn a_module_of_a_device_has_one_master() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("device");
        std::fs::write(&path, [0; 512]).unwrap();
        let first = module_memory(&path, Some(256)).unwrap();
        // Two on one device are two modules, as in `/dev/mem`.
        let other = module_memory(&path, Some(0)).unwrap();
        // The same, and one that would lie across both.
        for start in [256, 0, 128] {
            let refused = module_memory(&path, Some(start)).unwrap_err();
            assert_eq!(refused.kind(), ErrorKind::ResourceBusy, "{start}");
        }
        assert!(module_beside(&path, Some(256)).unwrap().is_beside(), "a stop gets through");
        drop(first);
        assert!(!module_beside(&path, Some(256)).unwrap().is_beside());
        assert!(module_memory(&path, Some(256)).is_ok());
        assert!(module_beside(&path, Some(0)).unwrap().is_beside());
        drop(other);
        assert!(module_memory(&path, Some(128)).is_ok());
    }
}
