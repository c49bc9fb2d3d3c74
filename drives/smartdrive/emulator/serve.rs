//! Devices on a stream of bytes, at the pace of a wire.

use std::{
    io,
    path::{Path, PathBuf},
    time::Duration,
};

use tokio::{
    io::{AsyncRead, AsyncWrite},
    sync::mpsc::Receiver,
};

use super::{Control, Device, DeviceOptions, Happening};
use crate::{BAUD, Execution, protocol::frame::command_length, wire_time};
use twin_drives::{
    Clock, EmulatorError, FaultyWire, Speed,
    emulator_host::{self, DeviceSpeed, Emulated, Hosting, SerialDevice, replace, restored},
};

/// Delays of the wire and the devices, and echo of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wire {
    /// From the last byte of a command to the first byte of its answer, at most 50 ms on a device in order.
    pub response: Duration,
    /// Instant of the execution within that time. Not documented; `Between` is its middle.
    pub execution: Execution,
    /// Silence that ends a frame that is not whole. The device takes 10 bit times, which no pseudo-terminal can show.
    pub frame_timeout: Duration,
    /// Whether commands come back before their answers, as some RS485 adapters have it.
    pub echo: bool,
}

impl Default for Wire {
    /// 2 ms, carried out on arrival, 5 ms, no echo.
    fn default() -> Self {
        Self {
            response: Duration::from_millis(2),
            execution: Execution::OnArrival,
            frame_timeout: Duration::from_millis(5),
            echo: false,
        }
    }
}

/// Settings of emulated devices.
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
    /// Speed of the devices' time against the clock, their wire included.
    pub speed: Speed,
}

/// Devices on a pseudo-terminal, on a thread of their own. Dropping it stops them.
pub type EmulatedBus = Emulated<ServedBus>;

/// Serves `devices` on `stream` until `control` is closed or the stream ends, and gives the devices back.
///
/// A command is carried out when its bytes have passed the wire ([`Wire::execution`]); its answer arrives a response
/// time and its own time on the wire later. Both instants are computed, so that what the devices do does not depend on
/// how precisely this task is woken.
///
/// # Errors
/// If the stream cannot be read or written.
pub async fn serve<S: AsyncRead + AsyncWrite + Unpin>(
    stream: S,
    devices: Vec<Device>,
    wire: &Wire,
    clock: &dyn Clock,
    control: Receiver<Control>,
) -> io::Result<Vec<Device>> {
    let (bus, faults) = (ServedBus::new(devices, *wire, Vec::new()), FaultyWire::new(0));
    let served = emulator_host::serve(stream, bus, faults, (clock, false), control).await?;
    Ok(served.devices)
}

/// Devices on one line.
#[derive(Debug)]
pub struct ServedBus {
    devices: Vec<Device>,
    wire: Wire,
    now_ns: i64,
    /// Files of their flash memories.
    files: Vec<PathBuf>,
    /// Of each device, as they were last looked at.
    saves: Vec<u64>,
}

impl ServedBus {
    fn new(devices: Vec<Device>, wire: Wire, files: Vec<PathBuf>) -> Self {
        let saves = devices.iter().map(Device::saves).collect();
        Self { devices, wire, now_ns: 0, files, saves }
    }

    /// What all devices answer. Two that have the same address answer at once, which leaves nothing to be read.
    fn together(&mut self, answer: impl Fn(&mut Device) -> Option<Vec<u8>>) -> Option<Vec<u8>> {
        let answers = self.devices.iter_mut().filter_map(answer);
        answers.reduce(|one, other| one.iter().zip(&other).map(|(a, b)| a & b).collect())
    }
}

impl SerialDevice for ServedBus {
    type Options = EmulatorOptions;
    type Event = Happening;
    type Seen = Vec<Device>;

    const FAMILY: &'static str = "smartdrive";

    fn hosting(options: &EmulatorOptions) -> Hosting<'_> {
        Hosting {
            link: options.link.as_deref(),
            files: &options.files,
            any_speed: options.any_speed,
            seed: options.seed,
            speed: options.speed,
        }
    }

    fn power_up(options: &EmulatorOptions) -> Result<Self, EmulatorError> {
        let one = |(place, device): (usize, &DeviceOptions)| {
            let remembered = match options.files.get(place) {
                Some(path) => remembered(path, device)?,
                None => {
                    options.flash.get(place).and_then(|image| Device::with_flash(device, image))
                }
            };
            Ok(remembered.unwrap_or_else(|| Device::new(device)))
        };
        let devices = options.devices.iter().enumerate().map(one);
        Ok(Self::new(devices.collect::<Result<_, _>>()?, options.wire, options.files.clone()))
    }

    fn line_speed(&self) -> DeviceSpeed {
        DeviceSpeed::new(BAUD)
    }

    fn seen(&self) -> Vec<Device> {
        self.devices.clone()
    }

    fn now_ns(&self) -> i64 {
        self.now_ns
    }

    fn advance_to(&mut self, time_ns: i64) {
        let passed_ns = (time_ns - self.now_ns).max(0);
        self.devices.iter_mut().for_each(|device| device.advance(passed_ns));
        self.now_ns += passed_ns;
    }

    fn happen(&mut self, Happening { device, event }: Happening) {
        if let Some(device) = self.devices.get_mut(device) {
            device.happen(event);
        }
    }

    /// Commands tell their length.
    fn whole(&self, bytes: &[u8]) -> Option<usize> {
        command_length(bytes).filter(|length| *length <= bytes.len())
    }

    fn handle(&mut self, frame: &[u8]) -> Option<Vec<u8>> {
        self.together(|device| device.handle(frame))
    }

    fn refuse(&mut self, frame: &[u8], code: u8) -> Option<Vec<u8>> {
        self.together(|device| device.refusal(frame, code.into()))
    }

    fn wire_time(&self, bytes: usize) -> Duration {
        wire_time(bytes)
    }

    fn silence(&self) -> Duration {
        self.wire.frame_timeout
    }

    fn before_execution(&self) -> Duration {
        match self.wire.execution {
            Execution::OnArrival => Duration::ZERO,
            Execution::Between => self.wire.response / 2,
            Execution::BeforeAnswer => self.wire.response,
        }
    }

    fn turnaround(&self) -> Duration {
        self.wire.response.saturating_sub(self.before_execution())
    }

    fn echoes(&self) -> bool {
        self.wire.echo
    }

    fn stores_at_ns(&self) -> Option<i64> {
        let due = |device: &Device| Some(device.save_due_ns()? - device.now_ns() + self.now_ns);
        self.devices.iter().filter_map(due).min()
    }

    fn keep(&mut self) -> io::Result<()> {
        for (place, (device, known)) in self.devices.iter().zip(&mut self.saves).enumerate() {
            if device.saves() != *known {
                *known = device.saves();
                if let Some(path) = self.files.get(place) {
                    replace(path, &device.flash())?;
                }
            }
        }
        Ok(())
    }
}

/// The device of a file; none if the file is new.
fn remembered(path: &Path, options: &DeviceOptions) -> Result<Option<Device>, EmulatorError> {
    const OTHER: &str = "this is not an image of the flash memory of an emulated SmartDRIVE";
    let found = restored(path, |image| Device::with_flash(options, image).ok_or(OTHER))?;
    if found.is_none() {
        replace(path, &Device::new(options).flash())
            .map_err(|source| EmulatorError::File { path: path.to_path_buf(), source })?;
    }
    Ok(found)
}
