//! A board on a stream of bytes in real time, at the pace of a wire.

use std::{io, time::Duration};

use tokio::{
    io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt},
    sync::mpsc::Receiver,
    time::sleep,
};

use super::{Board, Control, rtu};
use crate::ramp::whole_ns;
use crate::{Clock, Direction, FaultyWire, interpcnc::Line};

/// Longer than any frame (256 bytes): what exceeds it is noise, which silence ends.
const MOST_BYTES: usize = 512;

/// How slow the wire and the board are. Pseudo-terminals pass bytes at once, so the emulator waits in their place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wire {
    /// Speed and parity.
    pub line: Line,
    /// From the execution of a request to the first byte of its answer. Unknown for the real board.
    pub turnaround: Duration,
}

impl Default for Wire {
    /// 115200 baud, no parity, 2 ms.
    fn default() -> Self {
        Self { line: Line::default(), turnaround: Duration::from_millis(2) }
    }
}

/// Serves `board` on `stream` until `control` is closed or the stream ends, and gives the board back.
///
/// A request is executed when its bytes have passed the wire and the silence that ends a frame has passed; its
/// answer arrives a turnaround and its own time on the wire later. Both instants are computed, so that what the
/// board does does not depend on how precisely this task is woken.
///
/// # Errors
/// If the stream cannot be read or written.
pub async fn serve<S: AsyncRead + AsyncWrite + Unpin>(
    stream: S,
    board: Board,
    wire: &Wire,
    clock: &dyn Clock,
    control: Receiver<Control>,
) -> io::Result<Board> {
    let faults = FaultyWire::new(0);
    // Others may need this thread.
    let timer = Duration::ZERO;
    serve_with(stream, board, (wire, faults, timer), clock, control, &mut |_| Ok(())).await
}

/// As [`serve`], on a wire with faults; the last `timer` of a wait is slept away with the thread; `stored` is called whenever the EEPROM has stored something.
pub(super) async fn serve_with<S: AsyncRead + AsyncWrite + Unpin>(
    mut stream: S,
    board: Board,
    (wire, faults, timer): (&Wire, FaultyWire, Duration),
    clock: &dyn Clock,
    mut control: Receiver<Control>,
    stored: &mut (dyn FnMut(&Board) -> io::Result<()> + Send),
) -> io::Result<Board> {
    let mut served = Served {
        offset_ns: board.now_ns() - clock.now_ns(),
        generation: board.eeprom_generation(),
        line: board.line(),
        board,
        wire: *wire,
        faults,
        received: Received::default(),
        busy_until_ns: i64::MIN,
        outgoing: Vec::new(),
    };
    let mut chunk = [0; 256];
    loop {
        served.execute_whole_frames(clock.now_ns());
        served.keep(stored)?;
        let due_ns = served.due_ns();
        let pause = due_ns.map(|due_ns| nanoseconds(due_ns - clock.now_ns()).saturating_sub(timer));
        tokio::select! {
            biased;
            message = control.recv() => {
                served.advance_to(clock.now_ns());
                match message {
                    None => {
                        served.keep(stored)?;
                        return Ok(served.board);
                    }
                    Some(message) => message.apply(&mut served.board, &mut served.faults),
                }
            }
            count = stream.read(&mut chunk) => {
                let bytes = chunk.get(..count?).unwrap_or_default();
                if bytes.is_empty() {
                    return Ok(served.board);
                }
                served.received.add(bytes, clock.now_ns());
            }
            () = sleep(pause.unwrap_or_default()), if pause.is_some() => {
                let left = nanoseconds(due_ns.unwrap_or(i64::MIN).saturating_sub(clock.now_ns()));
                if left > timer {
                    continue;
                }
                std::thread::sleep(left);
                let now_ns = clock.now_ns();
                for bytes in served.take_due(now_ns) {
                    stream.write_all(&bytes).await?;
                }
                served.execute_whole_frames(now_ns);
                served.end_frame(now_ns);
                served.store_if_due(now_ns);
            }
        }
    }
}

/// A board that is being served.
struct Served {
    board: Board,
    wire: Wire,
    faults: FaultyWire,
    received: Received,
    /// Board time less clock time, ns.
    offset_ns: i64,
    /// The board is answering until then, and hears nothing, ns on the clock.
    busy_until_ns: i64,
    /// What will arrive at the master, and when.
    outgoing: Vec<(i64, Vec<u8>)>,
    /// Of the EEPROM, as it was last looked at.
    generation: u64,
    /// The board's line, as it was last looked at.
    line: Line,
}

impl Served {
    /// Hands on what the EEPROM has stored since the last time.
    fn keep(
        &mut self,
        stored: &mut (dyn FnMut(&Board) -> io::Result<()> + Send),
    ) -> io::Result<()> {
        let generation = self.board.eeprom_generation();
        if std::mem::replace(&mut self.generation, generation) == generation {
            return Ok(());
        }
        stored(&self.board)
    }

    /// Silence that ends a frame.
    fn silence(&self) -> Duration {
        self.board.assumptions().silence_on(self.wire.line)
    }

    fn advance_to(&mut self, clock_ns: i64) {
        self.board.advance(clock_ns + self.offset_ns - self.board.now_ns());
    }

    /// Executes the whole frames that have come, unless the board is still answering.
    fn execute_whole_frames(&mut self, now_ns: i64) {
        while now_ns >= self.busy_until_ns
            && let Some(frame) = self.received.whole_frame()
        {
            let (since, until) = (self.received.since_ns, self.received.until_ns);
            self.arrived(&frame, since, until);
            self.received.since_ns = until;
        }
    }

    /// Silence has ended what has come, if it has.
    fn end_frame(&mut self, now_ns: i64) {
        if now_ns >= self.busy_until_ns && self.received.silent_ns(self.silence()) <= now_ns {
            let (since, until) = (self.received.since_ns, self.received.until_ns);
            let frame = std::mem::take(&mut self.received.bytes);
            self.arrived(&frame, since, until);
        }
    }

    fn store_if_due(&mut self, now_ns: i64) {
        if self.board.eeprom_due_ns().is_some_and(|due_ns| due_ns - self.offset_ns <= now_ns) {
            self.advance_to(now_ns);
        }
    }

    /// The next instant at which something happens without anything coming.
    fn due_ns(&self) -> Option<i64> {
        let silent = (!self.received.bytes.is_empty())
            .then(|| self.received.silent_ns(self.silence()).max(self.busy_until_ns));
        let stored = self.board.eeprom_due_ns().map(|due_ns| due_ns - self.offset_ns);
        self.outgoing.iter().map(|(due_ns, _)| *due_ns).chain(silent).chain(stored).min()
    }

    /// What has arrived at the master by now, in the order in which it does.
    fn take_due(&mut self, now_ns: i64) -> Vec<Vec<u8>> {
        self.outgoing.sort_by_key(|(due_ns, _)| *due_ns);
        let count = self.outgoing.partition_point(|(due_ns, _)| *due_ns <= now_ns);
        self.outgoing.drain(..count).map(|(_, bytes)| bytes).collect()
    }

    /// A frame has come whose bytes came between two instants: through the wire, which may do something to it.
    fn arrived(&mut self, frame: &[u8], since_ns: i64, until_ns: i64) {
        let passed_ns = until_ns.max(since_ns + whole_ns(self.wire.line.duration(frame.len())));
        let passed = self.faults.pass(Direction::Request, frame);
        if passed.echo {
            self.outgoing.push((passed_ns, frame.to_vec()));
        }
        for (later_ns, piece) in passed.pieces {
            self.execute(&piece, passed_ns.saturating_add(later_ns), passed.refusal);
        }
    }

    /// Executes a frame whose last byte has come at an instant.
    fn execute(&mut self, frame: &[u8], passed_ns: i64, refusal: Option<u8>) {
        let executed_ns = passed_ns.saturating_add(whole_ns(self.silence()));
        self.advance_to(executed_ns);
        let answer = match refusal {
            Some(code) => self.board.refusal(frame, code),
            None => self.board.handle(frame),
        };
        if self.board.line() != self.line {
            self.line = self.board.line();
            self.wire.line = self.line;
        }
        let Some(answer) = answer else { return };
        let took = self.wire.turnaround + self.wire.line.duration(answer.len());
        let answered_ns = executed_ns.saturating_add(whole_ns(took));
        self.busy_until_ns = self.busy_until_ns.max(answered_ns);
        let passed = self.faults.pass(Direction::Answer, &answer);
        let pieces = passed.pieces.into_iter();
        self.outgoing
            .extend(pieces.map(|(later_ns, piece)| (answered_ns.saturating_add(later_ns), piece)));
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

    /// When silence has ended what has come, ns.
    fn silent_ns(&self, silence: Duration) -> i64 {
        if self.bytes.is_empty() {
            return i64::MAX;
        }
        self.until_ns.saturating_add(whole_ns(silence))
    }

    /// The frame at the head, if its length is known and its check sum is right. Anything else waits for silence:
    /// its end cannot be told from its bytes.
    fn whole_frame(&mut self) -> Option<Vec<u8>> {
        let length = rtu::request_length(&self.bytes)?;
        rtu::open(self.bytes.get(..length)?)?;
        let rest = self.bytes.split_off(length);
        Some(std::mem::replace(&mut self.bytes, rest))
    }
}

fn nanoseconds(ns: i64) -> Duration {
    Duration::from_nanos(u64::try_from(ns).unwrap_or(0))
}
