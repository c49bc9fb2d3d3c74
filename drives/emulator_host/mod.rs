//! Emulated devices on a stream of bytes, at the pace of a wire that may have faults: what all families have that hang
//! on a serial line.
//!
//! A request is carried out when its bytes have passed the wire, and its answer arrives when the device has taken its
//! time and the bytes have passed the wire back. All instants are computed from the arrival of the bytes, in the
//! device's own time, so that what a device does does not depend on how precisely this task is woken, nor on how fast
//! that time passes ([`crate::Speed`]).

mod received;

use std::{
    io,
    sync::mpsc::{SyncSender, sync_channel},
    time::Duration,
};

use tokio::{
    io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt},
    sync::mpsc::{Receiver, Sender},
    time::sleep,
};

use crate::{
    Clock, Control, Direction, EmulatorError, FaultyWire, control::Agenda, pause::TIMER,
    ramp::whole_ns,
};
use received::Received;

/// One or more devices at the end of a wire, pure and told the time.
pub trait Slave {
    /// What can happen to it.
    type Event;
    /// What somebody sees who looks at it.
    type Seen;

    /// What it is like now.
    fn seen(&self) -> Self::Seen;

    /// Its own time, ns.
    fn now_ns(&self) -> i64;

    /// Lets its time pass up to an instant, never backwards.
    fn advance_to(&mut self, time_ns: i64);

    /// Something happens to it.
    fn happen(&mut self, event: Self::Event);

    /// Length of the request at the head of these bytes, if it is there as a whole and its end can be told.
    fn whole(&self, bytes: &[u8]) -> Option<usize>;

    /// Carries out a request, or whatever silence has ended, and gives the answer, if there is one.
    fn handle(&mut self, frame: &[u8]) -> Option<Vec<u8>>;

    /// The answer that refuses a request unexecuted with a code of the family, if it is one to be answered at all.
    fn refuse(&mut self, frame: &[u8], code: u8) -> Option<Vec<u8>>;

    /// Time that bytes take on the wire.
    fn wire_time(&self, bytes: usize) -> Duration;

    /// Silence that ends what cannot be told to be whole.
    fn silence(&self) -> Duration;

    /// From the last byte of a request to its execution.
    fn before_execution(&self) -> Duration;

    /// From the execution of a request to the first byte of its answer.
    fn turnaround(&self) -> Duration;

    /// Whether whole requests come back to the master in any case, before their answers.
    fn echoes(&self) -> bool {
        false
    }

    /// When something that is to be kept is next stored without a request, ns.
    fn stores_at_ns(&self) -> Option<i64> {
        None
    }

    /// Hands on what has been stored since the last time.
    ///
    /// # Errors
    /// If it cannot be kept.
    fn keep(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// What is asked of a served slave from the side.
#[derive(Debug)]
pub enum Message<T: Slave> {
    /// Something happens.
    Control(Control<T::Event>),
    /// Somebody wants to see it as it is now.
    Look(SyncSender<T::Seen>),
}

impl<T: Slave> From<Control<T::Event>> for Message<T> {
    fn from(control: Control<T::Event>) -> Self {
        Self::Control(control)
    }
}

/// Serves `slave` on `stream` until `control` is closed or the stream ends, and gives the slave back.
///
/// With `precise`, the last stretch of every wait is slept by the thread, which is to have nothing else to do.
///
/// # Errors
/// If the stream cannot be read or written, or the slave cannot keep what it stores.
pub async fn serve<T: Slave, S: AsyncRead + AsyncWrite + Unpin, M: Into<Message<T>>>(
    mut stream: S,
    slave: T,
    wire: FaultyWire,
    (clock, precise): (&dyn Clock, bool),
    mut control: Receiver<M>,
) -> io::Result<T> {
    let mut served = Served {
        offset_ns: slave.now_ns() - clock.now_ns(),
        slave,
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
        served.slave.keep()?;
        let left = served.due_ns().map(|due_ns| clock.wait(due_ns - clock.now_ns()));
        let pause = left.map(|left| left.saturating_sub(early));
        tokio::select! {
            biased;
            message = control.recv() => {
                served.advance_to(clock.now_ns());
                let Some(message) = message else {
                    served.slave.keep()?;
                    return Ok(served.slave);
                };
                match message.into() {
                    Message::Control(control) => served.obey(control),
                    // Who no longer waits is not told.
                    Message::Look(to) => drop(to.try_send(served.slave.seen())),
                }
            }
            count = stream.read(&mut chunk) => {
                let bytes = chunk.get(..count?).unwrap_or_default();
                if bytes.is_empty() {
                    return Ok(served.slave);
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

/// A slave that is being served. Instants are those of the clock.
struct Served<T: Slave> {
    slave: T,
    wire: FaultyWire,
    agenda: Agenda<T::Event>,
    received: Received,
    /// The slave's time less the clock's, ns.
    offset_ns: i64,
    /// The slave is answering until then, and hears nothing, ns.
    busy_until_ns: i64,
    /// Requests that a fault of the wire has delayed.
    incoming: Vec<Delayed>,
    /// What will arrive at the master, and when.
    outgoing: Vec<(i64, Vec<u8>)>,
}

impl<T: Slave> Served<T> {
    fn advance_to(&mut self, clock_ns: i64) {
        self.slave.advance_to(clock_ns.saturating_add(self.offset_ns));
    }

    fn obey(&mut self, control: Control<T::Event>) {
        let slave = &mut self.slave;
        self.agenda.obey(control, &mut self.wire, &mut |event| slave.happen(event));
    }

    /// Carries out what has come whole or arrives late, unless the slave is still answering.
    fn execute_due(&mut self, now_ns: i64) {
        while let Some(place) = self.incoming.iter().position(|request| request.due_ns <= now_ns) {
            let Delayed { due_ns, frame, refusal } = self.incoming.remove(place);
            self.execute(&frame, due_ns, refusal);
        }
        while now_ns >= self.busy_until_ns
            && let Some(length) = self.slave.whole(&self.received.bytes)
        {
            let (frame, since_ns, until_ns) = self.received.take(length);
            self.arrived(&frame, since_ns, until_ns);
        }
    }

    /// Silence has ended what has come, if it has.
    fn end_frame(&mut self, now_ns: i64) {
        let silent = self.received.silent_ns(self.slave.silence()) <= now_ns;
        if silent && now_ns >= self.busy_until_ns && !self.received.bytes.is_empty() {
            let (frame, since_ns, until_ns) = self.received.take(usize::MAX);
            self.arrived(&frame, since_ns, until_ns);
        }
    }

    /// When the slave stores something next, ns.
    fn stores_at_ns(&self) -> Option<i64> {
        self.slave.stores_at_ns().map(|due_ns| due_ns.saturating_sub(self.offset_ns))
    }

    fn store_if_due(&mut self, now_ns: i64) {
        if self.stores_at_ns().is_some_and(|due_ns| due_ns <= now_ns) {
            self.advance_to(now_ns);
        }
    }

    /// The next instant at which something happens without anything coming, ns.
    fn due_ns(&self) -> Option<i64> {
        let silent = (!self.received.bytes.is_empty()).then(|| {
            let silent_ns = self.received.silent_ns(self.slave.silence());
            // What is whole waits for the slave alone.
            let whole = self.slave.whole(&self.received.bytes).is_some();
            if whole { self.busy_until_ns } else { silent_ns.max(self.busy_until_ns) }
        });
        let outgoing = self.outgoing.iter().map(|(due_ns, _)| *due_ns);
        let incoming = self.incoming.iter().map(|request| request.due_ns);
        outgoing.chain(incoming).chain(silent).chain(self.stores_at_ns()).min()
    }

    /// What has arrived at the master by now, in the order in which it does.
    fn take_due(&mut self, now_ns: i64) -> Vec<Vec<u8>> {
        self.outgoing.sort_by_key(|(due_ns, _)| *due_ns);
        let count = self.outgoing.partition_point(|(due_ns, _)| *due_ns <= now_ns);
        self.outgoing.drain(..count).map(|(_, bytes)| bytes).collect()
    }

    /// A request has come whose bytes came between two instants: through the wire, which may do something to it.
    fn arrived(&mut self, frame: &[u8], since_ns: i64, until_ns: i64) {
        let on_wire = whole_ns(self.slave.wire_time(frame.len()));
        let passed_ns = until_ns.max(since_ns.saturating_add(on_wire));
        for control in self.agenda.request() {
            self.advance_to(passed_ns);
            self.obey(control);
        }
        let passed = self.wire.pass(Direction::Request, frame);
        if passed.echo || self.slave.echoes() && self.slave.whole(frame).is_some() {
            self.outgoing.push((passed_ns, frame.to_vec()));
        }
        for (later_ns, frame) in passed.pieces {
            if later_ns > 0 {
                let due_ns = passed_ns.saturating_add(later_ns);
                self.incoming.push(Delayed { due_ns, frame, refusal: passed.refusal });
            } else {
                self.execute(&frame, passed_ns, passed.refusal);
            }
        }
    }

    /// Carries out a request whose last byte has come at an instant.
    fn execute(&mut self, frame: &[u8], passed_ns: i64, refusal: Option<u8>) {
        let executed_ns = passed_ns.saturating_add(whole_ns(self.slave.before_execution()));
        self.advance_to(executed_ns);
        let answer = match refusal {
            Some(code) => self.slave.refuse(frame, code),
            None => self.slave.handle(frame),
        };
        let Some(answer) = answer else { return };
        let took = self.slave.turnaround() + self.slave.wire_time(answer.len());
        let answered_ns = executed_ns.saturating_add(whole_ns(took));
        self.busy_until_ns = self.busy_until_ns.max(answered_ns);
        let passed = self.wire.pass(Direction::Answer, &answer);
        let pieces = passed.pieces.into_iter();
        self.outgoing
            .extend(pieces.map(|(later_ns, piece)| (answered_ns.saturating_add(later_ns), piece)));
    }
}

/// Asks the slave served behind `control` for what it is like now.
///
/// # Errors
/// If it is no longer served.
pub fn look<T: Slave>(control: Option<&Sender<Message<T>>>) -> Result<T::Seen, EmulatorError> {
    let (to, seen) = sync_channel(1);
    send(control, Message::Look(to))?;
    seen.recv().map_err(|_ended| EmulatorError::Ended)
}

/// Hands a message to the slave served behind `control`.
///
/// # Errors
/// If it is no longer served.
pub fn send<T: Slave>(
    control: Option<&Sender<Message<T>>>,
    message: Message<T>,
) -> Result<(), EmulatorError> {
    // The emulator takes messages as they come: the queue is full only if it no longer runs.
    let control = control.ok_or(EmulatorError::Ended)?;
    control.try_send(message).map_err(|_unsent| EmulatorError::Ended)
}
