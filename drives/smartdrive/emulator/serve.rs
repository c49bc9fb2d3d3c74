//! Devices on a stream of bytes, at the pace of a wire.

use std::{io, time::Duration};

use tokio::{
    io::{AsyncRead, AsyncWrite},
    sync::mpsc::Receiver,
};

use super::{Control, Device, Happening};
use crate::{Execution, protocol::frame::command_length, wire_time};
use twin_drives::{
    Clock, FaultyWire, emulator_host as slave,
    emulator_host::{Message, Slave},
};

/// How slow the wire and the devices are, and what else the line does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wire {
    /// From the last byte of a command to the first byte of its answer, at most 50 ms on a device in order.
    pub response: Duration,
    /// When in that time the command is carried out. Not documented; `Between` is its middle.
    pub execution: Execution,
    /// Silence that ends a frame that is not whole. The device takes 10 bit times, which no pseudo-terminal can tell.
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
    let bus = Bus::new(devices, *wire, Box::new(|_, _| Ok(())));
    let served = slave::serve(stream, bus, FaultyWire::new(0), (clock, false), control).await?;
    Ok(served.devices)
}

/// As [`serve`] and as precise as the thread can, on a wire with faults; `stored` is called whenever a device has saved
/// its parameters.
pub(super) async fn serve_with<S: AsyncRead + AsyncWrite + Unpin>(
    stream: S,
    devices: Vec<Device>,
    (wire, faults): (Wire, FaultyWire),
    clock: &dyn Clock,
    control: Receiver<Message<Bus>>,
    stored: Box<Stored>,
) -> io::Result<Vec<Device>> {
    let bus = Bus::new(devices, wire, stored);
    let served = slave::serve(stream, bus, faults, (clock, true), control).await?;
    Ok(served.devices)
}

/// What is done with a device that has saved its parameters, and its place on the bus.
pub(super) type Stored = dyn FnMut(usize, &Device) -> io::Result<()> + Send;

/// Devices on one line.
pub(super) struct Bus {
    devices: Vec<Device>,
    wire: Wire,
    now_ns: i64,
    stored: Box<Stored>,
    /// Of each device, as they were last looked at.
    saves: Vec<u64>,
}

impl Bus {
    fn new(devices: Vec<Device>, wire: Wire, stored: Box<Stored>) -> Self {
        let saves = devices.iter().map(Device::saves).collect();
        Self { devices, wire, now_ns: 0, stored, saves }
    }

    /// What all devices answer. Two that have the same address answer at once, which leaves nothing to be read.
    fn together(&mut self, answer: impl Fn(&mut Device) -> Option<Vec<u8>>) -> Option<Vec<u8>> {
        let answers = self.devices.iter_mut().filter_map(answer);
        answers.reduce(|one, other| one.iter().zip(&other).map(|(a, b)| a & b).collect())
    }
}

impl Slave for Bus {
    type Event = Happening;
    type Seen = Vec<Device>;

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
                (self.stored)(place, device)?;
            }
        }
        Ok(())
    }
}
