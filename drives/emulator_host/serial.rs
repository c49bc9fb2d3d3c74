//! Emulated devices on a serial line, at the pace of a wire that may have faults.
//!
//! A request is carried out when its bytes have passed the wire, and its answer arrives when the device has taken its
//! time and the bytes have passed the wire back. All instants are computed from the arrival of the bytes, in the
//! device's own time, so that what a device does does not depend on how precisely this task is woken, nor on how fast
//! that time passes ([`crate::Speed`]).

use std::{
    fmt, io,
    path::{Path, PathBuf},
    sync::mpsc::{SyncSender, sync_channel},
    time::Duration,
};

use tokio::{
    io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt},
    runtime,
    sync::mpsc::{Receiver, Sender, channel},
    time::sleep,
};
use tokio_serial::SerialStream;

use super::{Agenda, Control, DeviceSpeed, Host, LockedFile, PseudoTerminal, received::Received};
use crate::{
    Accelerated, Clock, Direction, EmulatorError, FaultyWire, Speed, pause::TIMER, ramp::whole_ns,
};

/// Settings of the host for a device.
#[derive(Clone, Copy, Debug)]
pub struct Hosting<'a> {
    /// Symbolic link to the pseudo-terminal.
    pub link: Option<&'a Path>,
    /// Files with the memories of the devices, locked as long as they are served.
    pub files: &'a [PathBuf],
    /// Masters are understood at any speed of their side.
    pub any_speed: bool,
    /// Seed of faults by chance.
    pub seed: u64,
    /// Speed of the devices' time against the clock.
    pub speed: Speed,
}

/// One or more devices at the end of a wire. They are pure: time comes from the host.
pub trait SerialDevice: Sized {
    /// Everything that is chosen about the devices.
    type Options;
    /// Event other than on the wire.
    type Event;
    /// State of the devices for somebody who looks.
    type Seen;

    /// Name of the family in lower case.
    const FAMILY: &'static str;

    /// Settings of the host.
    fn hosting(options: &Self::Options) -> Hosting<'_>;

    /// The devices after power-up, with the memories of their files.
    ///
    /// # Errors
    /// If a file cannot be read or made, or holds something else.
    fn power_up(options: &Self::Options) -> Result<Self, EmulatorError>;

    /// Speed of their line, which they may change.
    fn line_speed(&self) -> DeviceSpeed;

    /// Their present state.
    fn seen(&self) -> Self::Seen;

    /// Their own time, ns.
    fn now_ns(&self) -> i64;

    /// Lets their time pass up to an instant, never backwards.
    fn advance_to(&mut self, time_ns: i64);

    /// Makes an event happen to them.
    fn happen(&mut self, event: Self::Event);

    /// Length of the request at the head of these bytes, if it is there as a whole and its end is known.
    fn whole(&self, bytes: &[u8]) -> Option<usize>;

    /// Executes a request, or whatever silence has ended, and gives the answer, if it has one.
    fn handle(&mut self, frame: &[u8]) -> Option<Vec<u8>>;

    /// Answer that refuses a request unexecuted with a code of the family; none of a request without an answer.
    fn refuse(&mut self, frame: &[u8], code: u8) -> Option<Vec<u8>>;

    /// Time that bytes take on the wire.
    fn wire_time(&self, bytes: usize) -> Duration;

    /// Silence that ends a request of unknown length.
    fn silence(&self) -> Duration;

    /// From the last byte of a request to its execution.
    fn before_execution(&self) -> Duration;

    /// From the execution of a request to the first byte of its answer.
    fn turnaround(&self) -> Duration;

    /// Whether whole requests come back to the master in any case, before their answers.
    fn echoes(&self) -> bool {
        false
    }

    /// Next instant at which the devices store something without a request, ns.
    fn stores_at_ns(&self) -> Option<i64> {
        None
    }

    /// Writes memories that have changed since the last time to their files.
    ///
    /// # Errors
    /// If a file cannot be written.
    fn keep(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Message to a served device other than on its wire.
#[derive(Debug)]
pub enum Message<T: SerialDevice> {
    /// Something happens.
    Control(Control<T::Event>),
    /// Somebody asks for the present state.
    Look(SyncSender<T::Seen>),
}

impl<T: SerialDevice> From<Control<T::Event>> for Message<T> {
    fn from(control: Control<T::Event>) -> Self {
        Self::Control(control)
    }
}

/// Serves devices on `stream` until `control` is closed or the stream ends, and gives them back.
///
/// With `precise`, the thread sleeps through the last part of every wait; it must have nothing else to do.
///
/// # Errors
/// If the stream cannot be read or written, or the file of a memory cannot be written.
pub async fn serve<T: SerialDevice, S: AsyncRead + AsyncWrite + Unpin, M: Into<Message<T>>>(
    mut stream: S,
    device: T,
    wire: FaultyWire,
    (clock, precise): (&dyn Clock, bool),
    mut control: Receiver<M>,
) -> io::Result<T> {
    let mut served = Served {
        offset_ns: device.now_ns() - clock.now_ns(),
        device,
        wire,
        agenda: Agenda::default(),
        received: Received::default(),
        busy_until_ns: i64::MIN,
        incoming: Vec::new(),
        outgoing: Vec::new(),
    };
    let early = if precise { TIMER } else { Duration::ZERO };
    let mut chunk = [0; 256];
    loop {
        served.execute_due(clock.now_ns());
        served.device.keep()?;
        let left = served.due_ns().map(|due_ns| clock.wait(due_ns - clock.now_ns()));
        let pause = left.map(|left| left.saturating_sub(early));
        tokio::select! {
            biased;
            message = control.recv() => {
                served.advance_to(clock.now_ns());
                let Some(message) = message else {
                    served.device.keep()?;
                    return Ok(served.device);
                };
                match message.into() {
                    Message::Control(control) => served.obey(control),
                    // Nobody may wait any more.
                    Message::Look(to) => drop(to.try_send(served.device.seen())),
                }
            }
            count = stream.read(&mut chunk) => {
                let bytes = chunk.get(..count?).unwrap_or_default();
                if bytes.is_empty() {
                    return Ok(served.device);
                }
                served.received.add(bytes, clock.now_ns());
            }
            () = sleep(pause.unwrap_or_default()), if pause.is_some() => {
                if let Some(due_ns) = served.due_ns().filter(|_| precise) {
                    let left = clock.wait(due_ns - clock.now_ns());
                    // A timer may also come far too early: then it is set once more.
                    std::thread::sleep(left.min(TIMER));
                }
                let now_ns = clock.now_ns();
                for bytes in served.take_due(now_ns) {
                    stream.write_all(&bytes).await?;
                }
                served.execute_due(now_ns);
                served.end_frame(now_ns);
                served.store_if_due(now_ns);
            }
        }
    }
}

/// A request on its way that is delayed.
struct Delayed {
    due_ns: i64,
    frame: Vec<u8>,
    refusal: Option<u8>,
}

/// A device that is being served. Instants are those of the clock.
struct Served<T: SerialDevice> {
    device: T,
    wire: FaultyWire,
    agenda: Agenda<T::Event>,
    received: Received,
    /// The device's time less the clock's, ns.
    offset_ns: i64,
    /// The device is answering until then, and hears nothing, ns.
    busy_until_ns: i64,
    /// Requests that a fault of the wire has delayed.
    incoming: Vec<Delayed>,
    /// What will arrive at the master, and when.
    outgoing: Vec<(i64, Vec<u8>)>,
}

impl<T: SerialDevice> Served<T> {
    fn advance_to(&mut self, clock_ns: i64) {
        self.device.advance_to(clock_ns.saturating_add(self.offset_ns));
    }

    fn obey(&mut self, control: Control<T::Event>) {
        let device = &mut self.device;
        self.agenda.obey(control, &mut self.wire, &mut |event| device.happen(event));
    }

    /// Carries out what has come whole or arrives late, unless the device is still answering.
    fn execute_due(&mut self, now_ns: i64) {
        while let Some(place) = self.incoming.iter().position(|request| request.due_ns <= now_ns) {
            let Delayed { due_ns, frame, refusal } = self.incoming.remove(place);
            self.execute(&frame, due_ns, refusal);
        }
        while now_ns >= self.busy_until_ns
            && let Some(length) = self.device.whole(&self.received.bytes)
        {
            let (frame, since_ns, until_ns) = self.received.take(length);
            self.arrived(&frame, since_ns, until_ns);
        }
    }

    /// Silence has ended what has come, if it has.
    fn end_frame(&mut self, now_ns: i64) {
        let silent = self.received.silent_ns(self.device.silence()) <= now_ns;
        if silent && now_ns >= self.busy_until_ns && !self.received.bytes.is_empty() {
            let (frame, since_ns, until_ns) = self.received.take(usize::MAX);
            self.arrived(&frame, since_ns, until_ns);
        }
    }

    /// When the device stores something next, ns.
    fn stores_at_ns(&self) -> Option<i64> {
        self.device.stores_at_ns().map(|due_ns| due_ns.saturating_sub(self.offset_ns))
    }

    fn store_if_due(&mut self, now_ns: i64) {
        if self.stores_at_ns().is_some_and(|due_ns| due_ns <= now_ns) {
            self.advance_to(now_ns);
        }
    }

    /// The next instant at which something happens without anything coming, ns.
    fn due_ns(&self) -> Option<i64> {
        let silent = (!self.received.bytes.is_empty()).then(|| {
            let silent_ns = self.received.silent_ns(self.device.silence());
            // What is whole waits for the device alone.
            let whole = self.device.whole(&self.received.bytes).is_some();
            if whole { self.busy_until_ns } else { silent_ns.max(self.busy_until_ns) }
        });
        let outgoing = self.outgoing.iter().map(|(due_ns, _)| *due_ns);
        let incoming = self.incoming.iter().map(|request| request.due_ns);
        outgoing.chain(incoming).chain(silent).chain(self.stores_at_ns()).min()
    }

    /// What has arrived at the master by now, in the order in which it does.
    fn take_due(&mut self, now_ns: i64) -> Vec<Vec<u8>> {
        let count = self.outgoing.partition_point(|(due_ns, _)| *due_ns <= now_ns);
        self.outgoing.drain(..count).map(|(_, bytes)| bytes).collect()
    }

    /// A request has come whose bytes came between two instants: through the wire, which may do something to it.
    fn arrived(&mut self, frame: &[u8], since_ns: i64, until_ns: i64) {
        let on_wire = whole_ns(self.device.wire_time(frame.len()));
        let passed_ns = until_ns.max(since_ns.saturating_add(on_wire));
        for control in self.agenda.request() {
            self.advance_to(passed_ns);
            self.obey(control);
        }
        let passed = self.wire.pass(Direction::Request, frame);
        if passed.echo || self.device.echoes() && self.device.whole(frame).is_some() {
            self.send(passed_ns, frame.to_vec());
        }
        for (later_ns, frame) in passed.pieces {
            // A wire keeps the order of what is on it.
            let before_ns = self.incoming.last().map(|request| request.due_ns);
            if later_ns > 0 || before_ns.is_some() {
                let due_ns = passed_ns.saturating_add(later_ns);
                let due_ns = due_ns.max(before_ns.unwrap_or(due_ns));
                self.incoming.push(Delayed { due_ns, frame, refusal: passed.refusal });
            } else {
                self.execute(&frame, passed_ns, passed.refusal);
            }
        }
    }

    /// Carries out a request whose last byte has come at an instant.
    fn execute(&mut self, frame: &[u8], passed_ns: i64, refusal: Option<u8>) {
        let executed_ns = passed_ns.saturating_add(whole_ns(self.device.before_execution()));
        self.advance_to(executed_ns);
        let answer = match refusal {
            Some(code) => self.device.refuse(frame, code),
            None => self.device.handle(frame),
        };
        let Some(answer) = answer else { return };
        let took = self.device.turnaround() + self.device.wire_time(answer.len());
        let answered_ns = executed_ns.saturating_add(whole_ns(took));
        self.busy_until_ns = self.busy_until_ns.max(answered_ns);
        let passed = self.wire.pass(Direction::Answer, &answer);
        for (later_ns, piece) in passed.pieces {
            self.send(answered_ns.saturating_add(later_ns), piece);
        }
    }

    /// Bytes arrive at the master at an instant, and not before those that were sent earlier.
    fn send(&mut self, due_ns: i64, bytes: Vec<u8>) {
        let before_ns = self.outgoing.last().map_or(due_ns, |(due_ns, _)| *due_ns);
        self.outgoing.push((due_ns.max(before_ns), bytes));
    }
}

/// Devices that are served on a pseudo-terminal. Dropping it ends them.
pub struct Emulated<T: SerialDevice> {
    host: Host<Sender<Message<T>>, T>,
    terminal: PseudoTerminal,
}

impl<T: SerialDevice> fmt::Debug for Emulated<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.terminal.path();
        f.debug_struct("Emulated").field(T::FAMILY, &path).finish_non_exhaustive()
    }
}

impl<T: SerialDevice<Event: Send, Seen: Send> + Send + 'static> Emulated<T> {
    /// Powers the devices up. `clock` gives the time by which their axes move.
    ///
    /// # Errors
    /// If the system gives no pseudo-terminal or no thread, the link cannot be made, or the file of a memory cannot be
    /// read or made, or holds something else.
    pub fn start(options: &T::Options, clock: impl Clock + 'static) -> Result<Self, EmulatorError> {
        let Hosting { link, files, any_speed, seed, speed } = T::hosting(options);
        let locks = files.iter().map(|file| LockedFile::lock(file));
        let mut locks = locks.collect::<Result<Vec<_>, _>>()?;
        let device = T::power_up(options)?;
        locks.iter_mut().for_each(LockedFile::keep);
        let (master, mut terminal) = PseudoTerminal::open(link)?;
        let runtime = runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|source| EmulatorError::Thread { source })?;
        let stream = {
            let _inside = runtime.enter();
            SerialStream::try_from(master)
                .map_err(|error| EmulatorError::Terminal { source: error.into() })?
        };
        let stream = terminal.at_speed(stream, &device.line_speed(), any_speed)?;
        let (control, messages) = channel(64);
        let (wire, clock) = (FaultyWire::new(seed), Accelerated::new(clock, speed));
        let name = format!("{} {}", T::FAMILY, terminal.path().display());
        let host = Host::start(name, control, locks, move || {
            runtime.block_on(serve(stream, device, wire, (&clock, true), messages))
        })?;
        Ok(Self { host, terminal })
    }

    /// Path at which a master opens them: the pseudo-terminal itself.
    pub fn path(&self) -> &Path {
        self.terminal.path()
    }

    /// Makes something happen to the devices or the wire.
    ///
    /// # Errors
    /// If the emulator has ended.
    pub fn control(&self, what: Control<T::Event>) -> Result<(), EmulatorError> {
        self.send(what.into())
    }

    /// Makes an event happen to the devices.
    ///
    /// # Errors
    /// If the emulator has ended.
    pub fn happen(&self, event: T::Event) -> Result<(), EmulatorError> {
        self.control(Control::Event(event))
    }

    /// Present state of the devices.
    ///
    /// # Errors
    /// If the emulator has ended.
    pub fn look(&self) -> Result<T::Seen, EmulatorError> {
        let (to, seen) = sync_channel(1);
        self.send(Message::Look(to))?;
        seen.recv().map_err(|_ended| EmulatorError::Ended)
    }

    /// Powers the devices down and gives their last state.
    ///
    /// # Errors
    /// If the emulator has ended before, because of its terminal or a file.
    pub fn stop(mut self) -> Result<T::Seen, EmulatorError> {
        let device = self.host.stop(|source| EmulatorError::Terminal { source })?;
        Ok(device.seen())
    }

    fn send(&self, message: Message<T>) -> Result<(), EmulatorError> {
        // The emulator takes messages as they come: the queue is full only if it no longer runs.
        let control = self.host.control().ok_or(EmulatorError::Ended)?;
        control.try_send(message).map_err(|_unsent| EmulatorError::Ended)
    }
}
