//! A board on a stream of bytes in real time, at the pace of a wire.

use std::{io, time::Duration};

use tokio::{
    io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt},
    sync::mpsc::Receiver,
    time::sleep,
};

use super::{Board, rtu};
use crate::{Clock, interpcnc::Line};

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

/// What happens to the board other than on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// The ENABLE input closes (true) or opens.
    Enable(bool),
    /// An input changes.
    Input {
        /// 1 to 32.
        number: u8,
        /// Its level.
        level: bool,
    },
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
    mut stream: S,
    mut board: Board,
    wire: &Wire,
    clock: &dyn Clock,
    mut control: Receiver<Control>,
) -> io::Result<Board> {
    // Board time and clock time differ by this.
    let offset_ns = board.now_ns() - clock.now_ns();
    let advance_to =
        |board: &mut Board, clock_ns: i64| board.advance(clock_ns + offset_ns - board.now_ns());
    let mut received = Received::default();
    let mut answer: Option<(i64, Vec<u8>)> = None;
    let mut chunk = [0; 256];
    loop {
        if answer.is_none()
            && let Some(frame) = received.whole_frame()
        {
            answer =
                execute(&mut board, &frame, received.since_ns, received.until_ns, wire, advance_to);
            received.since_ns = received.until_ns;
            continue;
        }
        let pause = match &answer {
            Some((due_ns, _)) => nanoseconds(due_ns - clock.now_ns()),
            None => wire.line.silence(),
        };
        let idle = answer.is_none() && received.bytes.is_empty();
        tokio::select! {
            biased;
            message = control.recv() => {
                advance_to(&mut board, clock.now_ns());
                match message {
                    None => return Ok(board),
                    Some(Control::Enable(closed)) => board.set_enable(closed),
                    Some(Control::Input { number, level }) => board.set_input(number, level),
                }
            }
            count = stream.read(&mut chunk), if answer.is_none() => {
                let bytes = chunk.get(..count?).unwrap_or_default();
                if bytes.is_empty() {
                    return Ok(board);
                }
                received.add(bytes, clock.now_ns());
            }
            () = sleep(pause), if !idle => match answer.take() {
                Some((due_ns, bytes)) if clock.now_ns() < due_ns => answer = Some((due_ns, bytes)),
                Some((_, bytes)) => stream.write_all(&bytes).await?,
                // Silence has ended the frame.
                None => {
                    let (since, until) = (received.since_ns, received.until_ns);
                    let frame = std::mem::take(&mut received.bytes);
                    answer = execute(&mut board, &frame, since, until, wire, advance_to);
                }
            }
        }
    }
}

/// Executes a frame whose bytes came between two instants; the answer and when it has arrived at the other end.
fn execute(
    board: &mut Board,
    frame: &[u8],
    since_ns: i64,
    until_ns: i64,
    wire: &Wire,
    advance_to: impl Fn(&mut Board, i64),
) -> Option<(i64, Vec<u8>)> {
    let passed_ns = until_ns.max(since_ns + whole(wire.line.duration(frame.len())));
    let executed_ns = passed_ns + whole(wire.line.silence());
    advance_to(board, executed_ns);
    let answer = board.handle(frame)?;
    Some((executed_ns + whole(wire.turnaround) + whole(wire.line.duration(answer.len())), answer))
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

    /// The frame at the head, if its length is known and its check sum is right. Anything else waits for silence:
    /// its end cannot be told from its bytes.
    fn whole_frame(&mut self) -> Option<Vec<u8>> {
        let length = rtu::request_length(&self.bytes)?;
        rtu::open(self.bytes.get(..length)?)?;
        let rest = self.bytes.split_off(length);
        Some(std::mem::replace(&mut self.bytes, rest))
    }
}

fn whole(duration: Duration) -> i64 {
    i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX)
}

fn nanoseconds(ns: i64) -> Duration {
    Duration::from_nanos(u64::try_from(ns).unwrap_or(0))
}
