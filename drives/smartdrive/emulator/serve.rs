//! Devices on a stream of bytes in real time, at the pace of a wire.

use std::{io, time::Duration};

use tokio::{
    io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt},
    sync::mpsc::Receiver,
    time::sleep,
};

use super::{Device, Input};
use crate::pause::TIMER;
use crate::ramp::whole_ns;
use crate::{
    Clock,
    smartdrive::{Alarms, frame::command_length, wire_time},
};

/// Longer than any frame: what exceeds it is noise, which silence ends.
const MOST_BYTES: usize = 256;
/// How slow the wire and the devices are, and what else the line does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wire {
    /// From the execution of a command to the first byte of its answer, at most 50 ms on a device in order.
    pub response: Duration,
    /// Silence that ends a frame that is not whole. The device takes 10 bit times, which no pseudo-terminal can tell.
    pub frame_timeout: Duration,
    /// Whether commands come back before their answers, as some RS485 adapters have it.
    pub echo: bool,
}

impl Default for Wire {
    /// 2 ms, 5 ms, no echo.
    fn default() -> Self {
        Self {
            response: Duration::from_millis(2),
            frame_timeout: Duration::from_millis(5),
            echo: false,
        }
    }
}

/// What happens to a device other than on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// An input changes.
    Input {
        /// Which.
        input: Input,
        /// Its level.
        level: bool,
    },
    /// Analog input 1 or 2 changes.
    Analog {
        /// 1 or 2.
        number: u8,
        /// 0 to 32767.
        value: u16,
    },
    /// The supply changes, V.
    Supply(u16),
    /// The cause of alarms comes or goes.
    Fault {
        /// Which.
        alarms: Alarms,
        /// Comes or goes.
        present: bool,
    },
    /// The rotor is blocked for a moment.
    Stall,
}

/// An event and the device it happens to, counted from 0 in the order of the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Control {
    /// Place on the bus, from 0.
    pub device: usize,
    /// What happens.
    pub event: Event,
}

impl Device {
    /// Lets something happen.
    pub fn happen(&mut self, event: Event) {
        match event {
            Event::Input { input, level } => self.set_input(input, level),
            Event::Analog { number, value } => self.set_analog(number, value),
            Event::Supply(volts) => self.set_supply(volts),
            Event::Fault { alarms, present } => self.set_fault(alarms, present),
            Event::Stall => self.stall(),
        }
    }
}

/// Devices on one line, whose times differ from the clock's by a constant.
struct Bus {
    devices: Vec<(Device, i64)>,
}

impl Bus {
    fn advance_to(&mut self, clock_ns: i64) {
        for (device, offset_ns) in &mut self.devices {
            device.advance(clock_ns + *offset_ns - device.now_ns());
        }
    }

    /// All devices hear a frame. Two that have the same address answer at once, which leaves nothing to be read.
    fn handle(&mut self, frame: &[u8]) -> Option<Vec<u8>> {
        let answers = self.devices.iter_mut().filter_map(|(device, _)| device.handle(frame));
        answers.reduce(|one, other| one.iter().zip(&other).map(|(a, b)| a & b).collect())
    }

    fn into_devices(self) -> Vec<Device> {
        self.devices.into_iter().map(|(device, _)| device).collect()
    }
}

/// Serves `devices` on `stream` until `control` is closed or the stream ends, and gives the devices back.
///
/// A command is executed when its bytes have passed the wire; its answer arrives a response time and its own time on
/// the wire later. Both instants are computed, so that what the devices do does not depend on how precisely this task
/// is woken.
///
/// # Errors
/// If the stream cannot be read or written.
pub async fn serve<S: AsyncRead + AsyncWrite + Unpin>(
    mut stream: S,
    devices: Vec<Device>,
    wire: &Wire,
    clock: &dyn Clock,
    mut control: Receiver<Control>,
) -> io::Result<Vec<Device>> {
    let start_ns = clock.now_ns();
    let offset = |device: Device| {
        let offset_ns = device.now_ns() - start_ns;
        (device, offset_ns)
    };
    let mut bus = Bus { devices: devices.into_iter().map(offset).collect() };
    let mut received = Received::default();
    let mut answer: Option<(i64, Vec<u8>)> = None;
    let mut chunk = [0; 256];
    loop {
        if answer.is_none()
            && let Some((frame, passed_ns)) = received.whole_frame()
        {
            if wire.echo {
                stream.write_all(&frame).await?;
            }
            bus.advance_to(passed_ns);
            answer = bus.handle(&frame).map(|bytes| {
                let arrives = whole_ns(wire.response) + whole_ns(wire_time(bytes.len()));
                (passed_ns + arrives, bytes)
            });
            continue;
        }
        let pause = match &answer {
            Some((due_ns, _)) => nanoseconds(due_ns - clock.now_ns()).saturating_sub(TIMER),
            None => wire.frame_timeout,
        };
        let idle = answer.is_none() && received.bytes.is_empty();
        tokio::select! {
            biased;
            message = control.recv() => {
                bus.advance_to(clock.now_ns());
                let Some(Control { device, event }) = message else {
                    return Ok(bus.into_devices());
                };
                if let Some((device, _)) = bus.devices.get_mut(device) {
                    device.happen(event);
                }
            }
            count = stream.read(&mut chunk), if answer.is_none() => {
                let bytes = chunk.get(..count?).unwrap_or_default();
                if bytes.is_empty() {
                    return Ok(bus.into_devices());
                }
                received.add(bytes, clock.now_ns());
            }
            () = sleep(pause), if !idle => match answer.take() {
                Some((due_ns, bytes)) => {
                    let left = nanoseconds(due_ns - clock.now_ns());
                    if left > TIMER {
                        answer = Some((due_ns, bytes));
                    } else {
                        std::thread::sleep(left);
                        stream.write_all(&bytes).await?;
                    }
                }
                // Silence: what is there is no frame.
                None => received.bytes.clear(),
            }
        }
    }
}

/// Bytes that have come and are not yet executed.
#[derive(Debug, Default)]
struct Received {
    bytes: Vec<u8>,
    /// Arrival of the first byte.
    since_ns: i64,
    /// Arrival of the last byte.
    until_ns: i64,
}

impl Received {
    fn add(&mut self, bytes: &[u8], now_ns: i64) {
        if self.bytes.is_empty() {
            self.since_ns = now_ns;
        }
        self.until_ns = now_ns;
        let room = MOST_BYTES.saturating_sub(self.bytes.len());
        self.bytes.extend(bytes.iter().take(room));
    }

    /// The frame at the head and when its last byte has passed the wire.
    fn whole_frame(&mut self) -> Option<(Vec<u8>, i64)> {
        let length = command_length(&self.bytes)?;
        if self.bytes.len() < length {
            return None;
        }
        let rest = self.bytes.split_off(length);
        let frame = std::mem::replace(&mut self.bytes, rest);
        let passed_ns = self.until_ns.max(self.since_ns + whole_ns(wire_time(frame.len())));
        self.since_ns = passed_ns;
        Some((frame, passed_ns))
    }
}

fn nanoseconds(ns: i64) -> Duration {
    Duration::from_nanos(u64::try_from(ns).unwrap_or(0))
}
