//! Emulated devices on a pseudo-terminal, on a thread of its own.

use std::{
    io,
    path::{Path, PathBuf},
    thread::{Builder, JoinHandle},
};

use tokio::{runtime, sync::mpsc};
use tokio_serial::SerialStream;

use super::{
    Control, Device, DeviceOptions, Event, Wire,
    serve::{Bus, serve_with},
};
use crate::BAUD;
use twin_drives::{
    Accelerated, Clock, EmulatorError, FaultyWire, Speed, emulator_host as slave,
    emulator_host::Message,
    locked_file::{LockedFile, replace},
    pty::{DeviceSpeed, PseudoTerminal},
};

/// What to emulate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EmulatorOptions {
    /// The devices on the bus.
    pub devices: Vec<DeviceOptions>,
    /// Images of their flash memories, in the same order; a device without one, or with one that is damaged, is as it
    /// left the factory.
    pub flash: Vec<Vec<u8>>,
    /// Files that keep flash memories, in the same order. What is in a file counts instead of an image, a file that is
    /// not there is made, and SAVE replaces it at once. A device without a file forgets.
    pub files: Vec<PathBuf>,
    /// Emulated delays.
    pub wire: Wire,
    /// Symbolic link to make to the pseudo-terminal; it is removed at the end.
    pub link: Option<PathBuf>,
    /// It understands masters whatever speed they have set on their side of the pseudo-terminal; otherwise one at another
    /// speed gets no answer, as from the device. Masters that set no speed find the right one.
    pub any_speed: bool,
    /// Decides what faults by chance do.
    pub seed: u64,
    /// How many times faster than their clock the devices live, their wire included.
    pub speed: Speed,
}

/// A running emulator. Dropping it stops it.
pub struct EmulatedBus {
    terminal: PseudoTerminal,
    /// Closed to end the thread.
    control: Option<mpsc::Sender<Message<Bus>>>,
    thread: Option<JoinHandle<io::Result<Vec<Device>>>>,
    _locks: Vec<LockedFile>,
}

impl std::fmt::Debug for EmulatedBus {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("EmulatedBus").field("path", &self.path()).finish_non_exhaustive()
    }
}

impl EmulatedBus {
    /// Powers the devices up. `clock` gives the time by which their axes move.
    ///
    /// # Errors
    /// If there is no pseudo-terminal or no thread to be had, the link cannot be made, or a file of flash memory cannot be
    /// read or made or is none.
    pub fn start(
        options: &EmulatorOptions,
        clock: impl Clock + 'static,
    ) -> Result<Self, EmulatorError> {
        let locks = options.files.iter().map(|file| LockedFile::lock(file));
        let mut locks = locks.collect::<Result<Vec<_>, _>>()?;
        let devices = power_up(options)?;
        locks.iter_mut().for_each(LockedFile::keep);
        let (master, mut terminal) = PseudoTerminal::open(options.link.as_deref())?;
        let failed = |source| EmulatorError::Thread { source };
        let runtime =
            runtime::Builder::new_current_thread().enable_all().build().map_err(failed)?;
        let stream = {
            let _inside = runtime.enter();
            SerialStream::try_from(master)
                .map_err(|error| EmulatorError::Terminal { source: error.into() })?
        };
        let stream = terminal.at_speed(stream, &DeviceSpeed::new(BAUD), options.any_speed)?;
        let (control, messages) = mpsc::channel(64);
        let wire = (options.wire, FaultyWire::new(options.seed));
        let clock = Accelerated::new(clock, options.speed);
        let files = options.files.clone();
        let thread = Builder::new()
            .name(format!("smartdrive {}", terminal.path().display()))
            .spawn(move || {
                let stored =
                    Box::new(move |place: usize, device: &Device| match files.get(place) {
                        Some(path) => replace(path, &device.flash()),
                        None => Ok(()),
                    });
                runtime.block_on(serve_with(stream, devices, wire, &clock, messages, stored))
            })
            .map_err(failed)?;
        Ok(Self { terminal, control: Some(control), thread: Some(thread), _locks: locks })
    }

    /// Where to open the bus: the pseudo-terminal itself.
    pub fn path(&self) -> &Path {
        self.terminal.path()
    }

    /// Lets something happen to a device, counted from 0.
    ///
    /// # Errors
    /// If the emulator has ended.
    pub fn happen(&self, device: usize, event: Event) -> Result<(), EmulatorError> {
        self.control(event.to(device))
    }

    /// Makes something happen to a device or the wire.
    ///
    /// # Errors
    /// If the emulator has ended.
    pub fn control(&self, what: Control) -> Result<(), EmulatorError> {
        slave::send(self.control.as_ref(), what.into())
    }

    /// The devices as they are now, in the order of the bus.
    ///
    /// # Errors
    /// If the emulator has ended.
    pub fn look(&self) -> Result<Vec<Device>, EmulatorError> {
        slave::look(self.control.as_ref())
    }

    /// Powers the devices down and gives them back as they were then.
    ///
    /// # Errors
    /// If the emulator has ended before, because of its terminal or a file of flash memory.
    pub fn stop(mut self) -> Result<Vec<Device>, EmulatorError> {
        self.control = None;
        let thread = self.thread.take().ok_or(EmulatorError::Ended)?;
        thread
            .join()
            .map_err(|_panic| EmulatorError::Ended)?
            .map_err(|source| EmulatorError::Terminal { source })
    }
}

impl Drop for EmulatedBus {
    fn drop(&mut self) {
        self.control = None;
        if let Some(thread) = self.thread.take() {
            // Its result matters to nobody any more.
            drop(thread.join());
        }
    }
}

/// The devices with the flash memories of their files or images. A file that is not there is made.
fn power_up(options: &EmulatorOptions) -> Result<Vec<Device>, EmulatorError> {
    let one = |(place, device): (usize, &DeviceOptions)| {
        let remembered = match options.files.get(place) {
            Some(path) => kept(path, device)?,
            None => options.flash.get(place).and_then(|image| Device::with_flash(device, image)),
        };
        Ok(remembered.unwrap_or_else(|| Device::new(device)))
    };
    options.devices.iter().enumerate().map(one).collect()
}

/// The device of a file; none if the file is new.
fn kept(path: &Path, options: &DeviceOptions) -> Result<Option<Device>, EmulatorError> {
    const NONE: &str = "this is no image of the flash memory of an emulated SmartDRIVE";
    let failed = |source| EmulatorError::File { path: path.to_path_buf(), source };
    match std::fs::read(path) {
        Ok(image) => {
            let bad = || failed(io::Error::new(io::ErrorKind::InvalidData, NONE));
            Device::with_flash(options, &image).ok_or_else(bad).map(Some)
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            replace(path, &Device::new(options).flash()).map_err(failed)?;
            Ok(None)
        }
        Err(error) => Err(failed(error)),
    }
}
