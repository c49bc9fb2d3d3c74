//! A board on a stream of bytes, at the pace of a wire.

use std::{io, time::Duration};

use tokio::{
    io::{AsyncRead, AsyncWrite},
    sync::mpsc::Receiver,
};

use super::{Board, Control, Event, rtu};
use crate::{Line, protocol::frame};
use twin_drives::{
    Clock, FaultyWire, emulator_host as slave,
    emulator_host::{Message, Slave},
    pty::DeviceSpeed,
};

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
    let speed = DeviceSpeed::new(wire.line.baud);
    let served = Served::new(board, (*wire, speed), Box::new(|_| Ok(())));
    let faults = FaultyWire::new(0);
    slave::serve(stream, served, faults, (clock, false), control).await.map(|served| served.board)
}

/// As [`serve`] and as precise as the thread can, on a wire with faults and a terminal at `speed`; `stored` is called whenever the EEPROM has
/// stored something.
pub(super) async fn serve_with<S: AsyncRead + AsyncWrite + Unpin>(
    stream: S,
    board: Board,
    (wire, faults, speed): (&Wire, FaultyWire, DeviceSpeed),
    clock: &dyn Clock,
    control: Receiver<Message<Served>>,
    stored: Box<Stored>,
) -> io::Result<Board> {
    let served = Served::new(board, (*wire, speed), stored);
    slave::serve(stream, served, faults, (clock, true), control).await.map(|served| served.board)
}

/// What is done with a board whose EEPROM has stored something.
pub(super) type Stored = dyn FnMut(&Board) -> io::Result<()> + Send;

/// A board that is being served.
pub(super) struct Served {
    board: Board,
    wire: Wire,
    stored: Box<Stored>,
    /// Of the EEPROM, as it was last looked at.
    generation: u64,
    /// The board's line, as it was last looked at.
    line: Line,
    /// Of its terminal.
    speed: DeviceSpeed,
}

impl Served {
    fn new(board: Board, (wire, speed): (Wire, DeviceSpeed), stored: Box<Stored>) -> Self {
        let (generation, line) = (board.eeprom_generation(), board.line());
        Self { board, wire, stored, generation, line, speed }
    }

    /// The bytes go by the board's line if it has changed that.
    fn go_by_line(&mut self) {
        if self.board.line() != self.line {
            self.line = self.board.line();
            self.wire.line = self.line;
            self.speed.set(self.line.baud);
        }
    }
}

impl Slave for Served {
    type Event = Event;
    type Seen = Box<Board>;

    fn seen(&self) -> Box<Board> {
        Box::new(self.board.clone())
    }

    fn now_ns(&self) -> i64 {
        self.board.now_ns()
    }

    fn advance_to(&mut self, time_ns: i64) {
        self.board.advance(time_ns - self.board.now_ns());
    }

    fn happen(&mut self, event: Event) {
        self.board.happen(event);
        // A board that starts anew takes the line of its parameters.
        self.go_by_line();
    }

    /// The request at the head, if its length is known and its check sum is right. Anything else waits for silence:
    /// its end cannot be told from its bytes.
    fn whole(&self, bytes: &[u8]) -> Option<usize> {
        let length = rtu::request_length(bytes)?;
        frame::open(bytes.get(..length)?).map(|_| length)
    }

    fn handle(&mut self, frame: &[u8]) -> Option<Vec<u8>> {
        let answer = self.board.handle(frame);
        // The line may have been changed by this request: its answer goes by the new one already.
        self.go_by_line();
        answer
    }

    fn refuse(&mut self, frame: &[u8], code: u8) -> Option<Vec<u8>> {
        self.board.refusal(frame, code)
    }

    fn wire_time(&self, bytes: usize) -> Duration {
        self.wire.line.duration(bytes)
    }

    fn silence(&self) -> Duration {
        self.board.assumptions().silence_on(self.wire.line)
    }

    fn before_execution(&self) -> Duration {
        self.silence()
    }

    fn turnaround(&self) -> Duration {
        self.wire.turnaround
    }

    fn stores_at_ns(&self) -> Option<i64> {
        self.board.eeprom_due_ns()
    }

    fn keep(&mut self) -> io::Result<()> {
        let generation = self.board.eeprom_generation();
        if std::mem::replace(&mut self.generation, generation) == generation {
            return Ok(());
        }
        (self.stored)(&self.board)
    }
}
