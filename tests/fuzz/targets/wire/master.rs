//! Masters of the serial families on a line that spoils answers: what they take is what the device says, or an error.

use std::collections::VecDeque;
use std::fmt::Debug;
use std::io;
use std::pin::Pin;
use std::task::{Context, Poll, Waker};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::runtime::Builder;
use tokio::time::timeout;
use twin_drives::{DriveError, no_clock};
use twin_interpcnc::emulator::{Board, BoardOptions};
use twin_interpcnc::{Command, InterpCnc, InterpCncOptions};
use twin_smartdrive::emulator::{Device, DeviceOptions};
use twin_smartdrive::{SmartDrive, SmartDriveOptions};

/// A call that goes on for longer, in simulated time, does not end.
const LONGEST: Duration = Duration::from_secs(60);

/// Line to a device. Each answer takes two bytes of `faults`: kind of the fault, and where.
struct Line {
    device: Box<dyn FnMut(&[u8]) -> Option<Vec<u8>> + Send>,
    faults: VecDeque<u8>,
    /// Answer that comes with the next one.
    late: Vec<u8>,
    coming: VecDeque<u8>,
    reader: Option<Waker>,
}

impl Line {
    fn spoilt(&mut self, mut answer: Vec<u8>) -> Vec<u8> {
        let kind = self.faults.pop_front().unwrap_or(0);
        let place = usize::from(self.faults.pop_front().unwrap_or(0)) % answer.len();
        match kind % 8 {
            1 => answer[place] ^= 1 << (kind / 32),
            2 => answer.truncate(place),
            3 => answer.clear(),
            4 => answer.extend(vec![kind; place]),
            5 => self.late = std::mem::take(&mut answer),
            _ => {}
        }
        answer
    }
}

impl AsyncRead for Line {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        if self.coming.is_empty() {
            self.reader = Some(context.waker().clone());
            return Poll::Pending;
        }
        let count = buffer.remaining().min(self.coming.len());
        buffer.put_slice(&self.coming.drain(..count).collect::<Vec<_>>());
        Poll::Ready(Ok(()))
    }
}

impl AsyncWrite for Line {
    fn poll_write(
        mut self: Pin<&mut Self>,
        _: &mut Context<'_>,
        request: &[u8],
    ) -> Poll<io::Result<usize>> {
        let late = std::mem::take(&mut self.late);
        self.coming.extend(late);
        if let Some(answer) = (self.device)(request) {
            let answer = self.spoilt(answer);
            self.coming.extend(answer);
        }
        self.reader.take().into_iter().for_each(Waker::wake);
        Poll::Ready(Ok(request.len()))
    }

    fn poll_flush(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        Poll::Ready(Ok(()))
    }

    fn poll_shutdown(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        Poll::Ready(Ok(()))
    }
}

fn line(device: impl FnMut(&[u8]) -> Option<Vec<u8>> + Send + 'static, faults: &[u8]) -> Line {
    let faults = faults.iter().copied().collect();
    let (late, coming) = (Vec::new(), VecDeque::new());
    Line { device: Box::new(device), faults, late, coming, reader: None }
}

/// What is read with faults is what is read without, or an error that names the port.
fn agree<T: Debug + PartialEq>(read: impl Fn(&[u8]) -> Vec<Result<T, DriveError>>, faults: &[u8]) {
    for (faulty, right) in read(faults).into_iter().zip(read(&[])) {
        match faulty {
            Ok(value) => assert_eq!(value, right.expect("without faults it is read")),
            Err(error) => assert!(error.to_string().contains("fuzz"), "{error}"),
        }
    }
}

/// The calls within [`LONGEST`].
fn within<F: Future>(calls: F) -> F::Output {
    let runtime = Builder::new_current_thread().enable_time().start_paused(true).build();
    let ended = async { timeout(LONGEST, calls).await.expect("the calls end") };
    runtime.expect("a runtime").block_on(ended)
}

pub fn interpcnc(faults: &[u8]) {
    let read = |faults: &[u8]| {
        let mut board = Board::new(&BoardOptions::default());
        let positions = [1, -2, 3, -4, 5].map(|steps| Some(steps * 70_001));
        board
            .send(&Command::Reset { unlock: true, homing_error: true, probe_error: true })
            .expect("it unlocks");
        board.send(&Command::WritePosition { positions }).expect("it takes counters");
        let line = line(move |request| board.handle(request), faults);
        let mut master = InterpCnc::attach("fuzz".into(), line, &InterpCncOptions::new(Vec::new()));
        within(async {
            let mut values = Vec::new();
            for number in [86, 101, 102, 103] {
                let state = master.state(&no_clock).await;
                values.push(state.map(|(state, _)| state.positions.map(i64::from)));
                let value = master.parameter(number, &no_clock).await;
                values.push(value.map(|value| [value.into(), 0, 0, 0, 0]));
            }
            values
        })
    };
    agree(read, faults);
}

pub fn smartdrive(faults: &[u8]) {
    let read = |faults: &[u8]| {
        let mut device = Device::new(&DeviceOptions::default());
        let line = line(move |request| device.handle(request), faults);
        let options = SmartDriveOptions::new(Vec::new());
        let mut master = SmartDrive::attach("fuzz".into(), line, &options);
        within(async {
            let mut values = Vec::new();
            for number in [0, 30, 31, 32, 43, 44] {
                let state = master.state(1, &no_clock).await;
                values.push(
                    state.map(|(state, _)| i64::from(state.position) << 8 | i64::from(state.mode)),
                );
                let copies = master.parameter(1, number).await;
                values.push(copies.map(|copies| copies.working));
            }
            values
        })
    };
    agree(read, faults);
}
