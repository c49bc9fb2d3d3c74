//! A board on a stream of bytes, at the pace of a wire.

use std::{io, path::PathBuf, time::Duration};

use tokio::{
    io::{AsyncRead, AsyncWrite},
    sync::mpsc::Receiver,
};

use super::{Bench, Board, BoardOptions, Control, Event, rtu};
use crate::{Line, protocol::frame};
use twin_drives::{
    Clock, EmulatorError, FaultyWire, Speed,
    emulator_host::{self, DeviceSpeed, Emulated, Hosting, SerialDevice, replace, restored},
};

/// Delays of the wire and the board. Pseudo-terminals pass bytes at once, so the emulator waits in their place.
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

/// Settings of an emulated board.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EmulatorOptions {
    /// The board at power-up.
    pub board: BoardOptions,
    /// Emulated delays. Its line is that of the bytes; the board's own only shows in its parameters, until these ask for
    /// another: in the file of the EEPROM, or when the board starts anew.
    pub wire: Wire,
    /// Symbolic link to make to the pseudo-terminal; it is removed at the end.
    pub link: Option<PathBuf>,
    /// Surroundings of the board.
    pub bench: Bench,
    /// File with the EEPROM. If it is there the board powers up with it, else with the parameters of a new one; what
    /// the board stores goes there at once.
    pub eeprom: Option<PathBuf>,
    /// It understands masters whatever speed they have set on their side of the pseudo-terminal; otherwise one at another
    /// speed gets no answer, as from the device. Masters that set no speed find the right one.
    pub any_speed: bool,
    /// Decides what faults by chance do.
    pub seed: u64,
    /// Speed of the board's time against the clock, its wire included.
    pub speed: Speed,
}

/// A board on a pseudo-terminal, on a thread of its own. Dropping it stops it.
pub type EmulatedBoard = Emulated<ServedBoard>;

/// Serves `board` on `stream` until `control` is closed or the stream ends, and gives the board back.
///
/// A request is executed when its bytes have passed the wire and the silence that ends a frame has passed; its
/// answer arrives a turnaround and its own time on the wire later. Both instants are computed, so that the board's
/// actions do not depend on how precisely this task is woken.
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
    let (served, faults) = (ServedBoard::new(board, *wire, None), FaultyWire::new(0));
    let served = emulator_host::serve(stream, served, faults, (clock, false), control).await?;
    Ok(served.board)
}

/// A board that is being served.
#[derive(Debug)]
pub struct ServedBoard {
    board: Board,
    wire: Wire,
    /// File of the EEPROM.
    file: Option<PathBuf>,
    /// Generation of the EEPROM in the file.
    generation: u64,
    /// The board's line, as it was last looked at.
    line: Line,
    /// Speed of the terminal.
    speed: DeviceSpeed,
}

impl ServedBoard {
    fn new(board: Board, wire: Wire, file: Option<PathBuf>) -> Self {
        let (generation, line) = (board.eeprom_generation(), board.line());
        let speed = DeviceSpeed::new(wire.line.baud);
        Self { board, wire, file, generation, line, speed }
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

impl SerialDevice for ServedBoard {
    type Options = EmulatorOptions;
    type Event = Event;
    type Seen = Box<Board>;

    const FAMILY: &'static str = "interpcnc";

    fn hosting(options: &EmulatorOptions) -> Hosting<'_> {
        Hosting {
            link: options.link.as_deref(),
            files: options.eeprom.as_slice(),
            any_speed: options.any_speed,
            seed: options.seed,
            speed: options.speed,
        }
    }

    fn power_up(options: &EmulatorOptions) -> Result<Self, EmulatorError> {
        let stored = options
            .eeprom
            .as_deref()
            .map(|path| restored(path, |image| Board::with_eeprom(&options.board, image)));
        let stored = stored.transpose()?.flatten();
        let mut board = stored.unwrap_or_else(|| Board::new(&options.board));
        board.set_bench(options.bench.clone());
        let mut wire = options.wire;
        if board.line() != options.board.line {
            // The EEPROM says so.
            wire.line = board.line();
        }
        Ok(Self::new(board, wire, options.eeprom.clone()))
    }

    fn line_speed(&self) -> DeviceSpeed {
        self.speed.clone()
    }

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
    /// its bytes do not show its end.
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
        match &self.file {
            Some(path) => replace(path, &self.board.eeprom()),
            None => Ok(()),
        }
    }
}
