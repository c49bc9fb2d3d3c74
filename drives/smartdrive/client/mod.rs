//! The bus over the wire: one exchange at a time, each with a deadline.

pub(crate) mod in_step;
mod memory;
pub(crate) mod options;
pub(crate) mod requests;
mod search;
mod travel;

pub use memory::ParameterValue;
pub use options::{AxisOptions, SmartDriveOptions};
pub use requests::{DriveState, IoState};

use std::{io, pin::Pin, sync::Arc, time::Duration};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    task::yield_now,
    time::{Instant, Sleep, sleep, timeout},
};
use tokio_serial::{DataBits, FlowControl, Parity, StopBits};

use super::{BAUD, BadFrame, Command, Execution, Fault, RejectCode, wire_time};
use crate::{
    client::search::Search,
    protocol::frame::{Answer, answer_length, encode},
};
use twin_drives::{
    Action, Clock, DriveError, Exchange, Exchanges, ProtocolFault, Stamp, port::open_serial,
    ramp::whole_ns, transport::Transport,
};

/// Multiple of the worst latency that late answers are waited for at most.
const MOST_PAUSES: u32 = 4;
/// Refusals, of frames that were spoilt on their way, after which a command is refused.
const REFUSALS: u32 = 2;
/// Reads after which no more silence is waited for.
const MOST_LEFTOVERS: u32 = 64;
/// Silence after which what has come late is all there is.
const QUIET: Duration = Duration::from_millis(2);

/// The master of a bus with one or more drives. All calls need a tokio runtime with I/O and time.
///
/// After an exchange without a proper answer the answer may still come, and would be taken for that to the next
/// command. Before the next command, unless it is a broadcast, the driver therefore waits until no answer can come any
/// more and throws away what has come. Then, and whenever something comes that answers nothing, it asks what is known of
/// every drive until question and answer agree: answers do not tell what they answer.
pub struct SmartDrive {
    port: Arc<str>,
    options: SmartDriveOptions,
    transport: Box<dyn Transport>,
    /// Something may be in the input that answers nothing.
    dirty: bool,
    /// An answer may still be on its way.
    late: bool,
    /// Drives, by the bits of their addresses, whose next answer may be one to something else.
    pub(super) doubtful: u32,
    /// Which of the known questions was asked last.
    pub(super) turn: bool,
    exchanges: Exchanges,
    /// Silence between the last frame and the next.
    silence: Option<Pin<Box<Sleep>>>,
}

impl std::fmt::Debug for SmartDrive {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { port, options, late, .. } = self;
        f.debug_struct("SmartDrive")
            .field("port", port)
            .field("options", options)
            .field("late", late)
            .finish_non_exhaustive()
    }
}

impl Command {
    /// What an error says was being done.
    pub(crate) fn action(&self) -> Action {
        Action::Atb { code: self.code(), name: self.name() }
    }
}

impl SmartDrive {
    /// Opens the serial port. Sends nothing.
    ///
    /// # Errors
    /// If an option is impossible or the port cannot be opened.
    pub fn open(port: &str, options: &SmartDriveOptions) -> Result<Self, DriveError> {
        let name: Arc<str> = port.into();
        options.check(&name)?;
        let serial = tokio_serial::new(port, BAUD)
            .parity(Parity::None)
            .data_bits(DataBits::Eight)
            .stop_bits(StopBits::One)
            .flow_control(FlowControl::None);
        let stream = open_serial(port, serial).map_err(|source| DriveError::Transport {
            at: Exchange {
                port: Arc::clone(&name),
                address: options.axes.first().map_or(0, |axis| axis.address),
                action: Action::Open,
            },
            source,
        })?;
        Ok(Self::attach(name, stream, options))
    }

    /// The bus at the other end of any stream of bytes.
    pub fn attach(
        port: Arc<str>,
        transport: impl Transport + 'static,
        options: &SmartDriveOptions,
    ) -> Self {
        let transport = Box::new(transport);
        // What lies in the input from before is nobody's answer: the first exchange starts by clearing it.
        Self {
            port,
            options: options.clone(),
            transport,
            dirty: true,
            late: false,
            doubtful: 0,
            turn: false,
            exchanges: Exchanges::new(options.turnaround),
            silence: None,
        }
    }

    /// Exchange of an error, with the action under way.
    pub(crate) fn at(&self, address: u8, action: Action) -> Exchange {
        Exchange { port: Arc::clone(&self.port), address, action }
    }

    /// Whether a command or an answer may still be on its way.
    pub(crate) fn is_late(&self) -> bool {
        self.late
    }

    /// Statistics of its exchanges.
    pub(crate) fn exchanges(&self) -> &Exchanges {
        &self.exchanges
    }

    /// Options it was opened with.
    pub fn options(&self) -> &SmartDriveOptions {
        &self.options
    }

    /// Sends a command to the drive at `address` (1 to 31) and takes its answer; success means that the drive has
    /// accepted it, not that it is finished.
    ///
    /// Only commands that are idempotent ([`Command::is_idempotent`]) are sent again if no proper answer comes. After
    /// an error of any other it is unknown whether the drive has executed it. Where drives refuse frames that were spoilt
    /// on their way ([`BadFrame::Refused`]), any command that is refused so is sent again once: it was not executed.
    ///
    /// # Errors
    /// If the address does not exist, if the drive refuses the command, or if no proper answer comes.
    pub async fn send(
        &mut self,
        address: u8,
        command: &Command,
        clock: &dyn Clock,
    ) -> Result<(Answer, Stamp), DriveError> {
        let at = self.at(address, command.action());
        if !super::ADDRESSES.contains(&address) {
            let value = f64::from(address);
            return Err(DriveError::Value {
                at,
                what: "address",
                value,
                unit: "",
                low: 1.0,
                high: 31.0,
            });
        }
        let repeats = self.exchanges.begin();
        // Drives that cannot be brought in step are asked so once more.
        let (mut refusals, mut out_of_step) = (0, 0);
        loop {
            let outcome = match self.settled_step(&at, command).await {
                Ok(()) => self.exchange(&at, &encode(address, command), clock).await,
                Err(error) => Err(error),
            };
            match outcome {
                Err(error) if error.is_lost() && command.is_idempotent() => {
                    let stepless = matches!(
                        error,
                        DriveError::Protocol { fault: ProtocolFault::OutOfStep, .. }
                    );
                    out_of_step += u32::from(stepless);
                    if out_of_step > 1 || !self.exchanges.may_repeat(&repeats) {
                        return Err(error);
                    }
                }
                Ok((answer, _)) if answer.status.rejected() => {
                    let reason = RejectCode::from_number(answer.tag).unwrap_or(RejectCode::Generic);
                    let spoilt = self.options.assumptions.bad_frame == BadFrame::Refused(reason);
                    refusals += 1;
                    if spoilt && refusals < REFUSALS {
                        continue;
                    }
                    self.exchanges.done();
                    return Err(Fault::Rejected(reason).at(at));
                }
                Ok(done) => {
                    self.exchanges.done();
                    return Ok(done);
                }
                failed => return failed,
            }
        }
    }

    /// As [`Self::settle`], until question and answer agree.
    async fn settled_step(&mut self, at: &Exchange, command: &Command) -> Result<(), DriveError> {
        self.settle(at).await?;
        self.resume_step(at, command).await
    }

    /// Sends a command to all drives, which execute it and do not answer. Waits for no late answer: this is how drives
    /// are stopped.
    ///
    /// # Errors
    /// If the port cannot be written.
    pub async fn broadcast(&mut self, command: &Command) -> Result<(), DriveError> {
        let at = self.at(0, command.action());
        self.pause().await;
        let frame = encode(0, command);
        // An adapter may echo it.
        self.dirty = true;
        let written = timeout(self.options.deadline, self.write(&frame)).await;
        let pause = wire_time(frame.len()) + self.options.broadcast_pause;
        self.silence = Some(Box::pin(sleep(pause)));
        match written {
            Ok(Ok(())) => Ok(()),
            Ok(Err(source)) => Err(DriveError::Transport { at, source }),
            Err(_) => Err(DriveError::Timeout { at, deadline: self.options.deadline }),
        }
    }

    /// Waits for late answers, and throws away what answers nothing. Whether there was nothing of the kind: else drives
    /// may be out of step.
    pub(super) async fn settle(&mut self, at: &Exchange) -> Result<bool, DriveError> {
        self.pause().await;
        if self.late {
            // After several losses answers of several questions may still come.
            let losses = self.exchanges.losses().in_row.clamp(1, MOST_PAUSES);
            sleep(self.options.worst_latency.saturating_mul(losses)).await;
        }
        let clean = if self.late || self.dirty {
            let clean = self.clear(at).await?;
            (self.late, self.dirty) = (false, false);
            clean
        } else {
            self.drain(at).await?
        };
        if !clean {
            self.doubt_all();
        }
        Ok(clean)
    }

    async fn pause(&mut self) {
        if let Some(silence) = self.silence.take() {
            silence.await;
        }
    }

    /// As [`Self::settle`], and waits for what else may come.
    pub(super) async fn quiet(&mut self, at: &Exchange) -> Result<bool, DriveError> {
        self.dirty = true;
        self.settle(at).await
    }

    /// Throws away what has come until the line is silent; whether nothing has. A line that never is silent shows in the
    /// answer.
    async fn clear(&mut self, at: &Exchange) -> Result<bool, DriveError> {
        let mut leftovers = [0; 256];
        for reads in 0..MOST_LEFTOVERS {
            match timeout(QUIET, self.transport.read(&mut leftovers)).await {
                Err(_) | Ok(Ok(0)) => return Ok(reads == 0),
                Ok(Ok(_)) => {}
                Ok(Err(source)) => return Err(DriveError::Transport { at: at.clone(), source }),
            }
        }
        Ok(false)
    }

    /// Throws away what has come since the last answer, without waiting for more; whether nothing has.
    async fn drain(&mut self, at: &Exchange) -> Result<bool, DriveError> {
        // A runtime that has been busy has not looked at the port yet.
        yield_now().await;
        let mut leftovers = [0; 256];
        let come = tokio::select! {
            biased;
            read = self.transport.read(&mut leftovers) => read,
            () = std::future::ready(()) => return Ok(true),
        };
        match come {
            Ok(0) => Ok(true),
            // More may be behind it.
            Ok(_) => self.clear(at).await.map(|_| false),
            Err(source) => Err(DriveError::Transport { at: at.clone(), source }),
        }
    }

    /// The bytes of a frame must follow each other closely: they are written in one piece.
    async fn write(&mut self, frame: &[u8]) -> io::Result<()> {
        self.transport.write_all(frame).await?;
        self.transport.flush().await
    }

    /// Sends a frame and takes the answer within the deadline.
    pub(super) async fn exchange(
        &mut self,
        at: &Exchange,
        frame: &[u8],
        clock: &dyn Clock,
    ) -> Result<(Answer, Stamp), DriveError> {
        let length = answer_length(frame, self.options.assumptions.answer_length);
        let wire = wire_time(frame.len() + length);
        let deadline = self.exchanges.deadline(wire, self.options.deadline);
        // Also if the caller gives up in the middle.
        self.late = true;
        let doubtful = self.doubtful;
        self.doubt(at.address);
        let mut search = Search::new(frame, at.address, length);
        let begun = Instant::now();
        let sent_ns = clock.now_ns();
        let outcome = timeout(deadline, async {
            self.write(frame).await?;
            let mut chunk = [0; 64];
            loop {
                let count = self.transport.read(&mut chunk).await?;
                if count == 0 {
                    return Err(io::ErrorKind::UnexpectedEof.into());
                }
                if let Some(answer) = search.take(chunk.get(..count).unwrap_or_default()) {
                    return Ok(Some(answer));
                }
                if search.is_spoilt() {
                    return Ok(None);
                }
            }
        });
        let outcome = outcome.await;
        let took = begun.elapsed();
        let answered_ns = clock.now_ns().max(sent_ns);
        if !self.options.silence.is_zero() {
            self.silence = Some(Box::pin(sleep(self.options.silence)));
        }
        let at = at.clone();
        match outcome {
            Ok(Ok(Some(answer))) => {
                self.exchanges.answered(took, wire);
                self.late = false;
                self.doubtful = doubtful;
                self.dirty = search.is_noisy();
                if search.hides_answers() {
                    self.doubt_all();
                }
                let bytes = (frame.len(), search.length);
                Ok((answer, self.stamp((sent_ns, answered_ns), bytes)))
            }
            Ok(Err(source)) => Err(DriveError::Transport { at, source }),
            Ok(Ok(None)) | Err(_) => {
                self.exchanges.lost();
                // An answer that has come spoilt comes no more.
                (self.late, self.dirty) = (!search.is_spoilt(), true);
                match search.fault() {
                    Some(fault) => Err(DriveError::Protocol { at, fault }),
                    None => Err(DriveError::Timeout { at, deadline }),
                }
            }
        }
    }

    /// A drive carries a command out between its last byte and the first of the answer.
    fn stamp(
        &self,
        (sent_ns, answered_ns): (i64, i64),
        (sent_bytes, answer_bytes): (usize, usize),
    ) -> Stamp {
        let first = sent_ns + whole_ns(wire_time(sent_bytes));
        let last = answered_ns - whole_ns(wire_time(answer_bytes));
        let executed_ns = match self.options.execution {
            Execution::Between => i64::midpoint(first, last),
            Execution::OnArrival => first,
            Execution::BeforeAnswer => last,
        };
        // A line faster than its baud rate (a pseudo-terminal) may make the wire times exceed the exchange.
        let executed_ns = executed_ns.clamp(sent_ns, answered_ns);
        Stamp { sent_ns, executed_ns, uncertainty_ns: (last - first).max(0) / 2, answered_ns }
    }
}
