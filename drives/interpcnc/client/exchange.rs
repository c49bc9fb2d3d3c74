//! One exchange: a request, its answer within the deadline, and when it took place.

use std::{io, time::Duration};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    time::{Instant, timeout},
};
use tokio_modbus::{
    Error, ProtocolError, Request, Response, Slave,
    client::{Client, rtu},
};

use super::{InterpCnc, MOST_LEFTOVERS};
use crate::{
    Exception,
    protocol::{
        frame::{open, seal},
        registers::STATUS,
    },
};
use twin_drives::exchanges::Repeats;
use twin_drives::pause::Pause;
use twin_drives::ramp::whole_ns;
use twin_drives::{Action, Clock, DriveError, ProtocolFault, Stamp};

/// Numbers of registers that only [`InterpCnc::resume_step`] reads: this many, from this one on.
const FIRST_WITNESS: u8 = 3;
const WITNESSES: u8 = 8;

/// Whether a request is sent again where its answer is lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sending {
    /// At once.
    Repeated,
    /// No.
    Once,
    /// At once, whatever late answers may come.
    Stop,
}

impl InterpCnc {
    /// Sends a request, and gives what `understood` makes of the answer. A stop does not wait for late answers: they show
    /// themselves by what they confirm.
    pub(super) async fn asked<T>(
        &mut self,
        (action, sending): (Action, Sending),
        request: &Request<'_>,
        clock: &dyn Clock,
        understood: impl Fn(&mut Self, &Response) -> Result<T, DriveError>,
    ) -> Result<(T, Stamp), DriveError> {
        let repeats = self.exchanges.begin();
        // The first loss is the cause: later ones may only show that the wire is gone.
        let mut cause = None;
        loop {
            let settled = match sending {
                Sending::Stop => Ok(()),
                _ => self.settle(action, &repeats).await,
            };
            let outcome = match settled {
                Ok(()) => self.exchange(action, request.clone(), clock).await,
                Err(error) => Err(error),
            };
            match outcome.and_then(|(answer, stamp)| Ok((understood(self, &answer)?, stamp))) {
                Err(error) if error.is_lost() => {
                    let first = cause.unwrap_or(error);
                    if sending == Sending::Once || !self.exchanges.may_repeat(&repeats) {
                        return Err(first);
                    }
                    cause = Some(first);
                }
                Ok(done) => {
                    self.exchanges.done();
                    return Ok(done);
                }
                failed => return failed,
            }
        }
    }

    /// An answer to something else came: answers may be out of step.
    pub(super) fn distrust(&mut self, action: Action, fault: ProtocolFault) -> DriveError {
        self.in_step = false;
        self.late = true;
        self.exchanges.lost();
        DriveError::Protocol { at: self.at(action), fault }
    }

    /// Makes sure that no answer to an earlier request can come any more.
    pub(super) async fn settle(
        &mut self,
        action: Action,
        repeats: &Repeats,
    ) -> Result<(), DriveError> {
        while self.late {
            match self.resume_step(action).await {
                Err(error) if error.is_lost() && self.exchanges.may_repeat(repeats) => {}
                done => done?,
            }
        }
        Ok(())
    }

    /// Reads as many registers as nothing else reads, until that answer comes. A line keeps the order of what is on it:
    /// after this answer there is none to an earlier request.
    async fn resume_step(&mut self, action: Action) -> Result<(), DriveError> {
        if let Some(silence) = self.silence.take() {
            silence.over().await;
        }
        self.clear(action).await?;
        // Another number than the last times, whose answers may still come.
        self.turn = (self.turn + 1) % WITNESSES;
        let count = FIRST_WITNESS + self.turn;
        let [high, low] = STATUS.to_be_bytes();
        let frame = seal(vec![self.options.address, 4, high, low, 0, count]);
        let (length, address) = (5 + 2 * usize::from(count), self.options.address);
        let is_due = |received: &[u8]| {
            let last = received.len().checked_sub(length).and_then(|from| received.get(from..));
            let opened = last.and_then(open);
            opened.is_some_and(|(of, function, data)| {
                (of, function, data.first()) == (address, 4, Some(&(2 * count)))
            })
        };
        let (wire, deadline) = self.deadline(frame.len(), length);
        let begun = Instant::now();
        let outcome = timeout(deadline, async {
            self.transport.write_all(&frame).await?;
            self.transport.flush().await?;
            let (mut received, mut chunk) = (Vec::new(), [0; 256]);
            while !is_due(&received) {
                match self.transport.read(&mut chunk).await? {
                    0 => return Err(io::ErrorKind::UnexpectedEof.into()),
                    more => received.extend_from_slice(chunk.get(..more).unwrap_or_default()),
                }
            }
            Ok(())
        })
        .await;
        self.silence = Some(Pause::begin(self.options.silence(), self.alone));
        match outcome {
            Ok(Ok(())) => {
                self.exchanges.answered(begun.elapsed(), wire);
                (self.late, self.in_step) = (false, true);
                Ok(())
            }
            Ok(Err(source)) => Err(DriveError::Transport { at: self.at(action), source }),
            Err(_) => {
                self.exchanges.lost();
                Err(DriveError::Timeout { at: self.at(action), deadline })
            }
        }
    }

    /// Time of the bytes of a request and its answer on the wire, with the silence before, and the deadline that follows.
    fn deadline(&self, sent_bytes: usize, answer_bytes: usize) -> (Duration, Duration) {
        let wire = self.options.line.duration(sent_bytes.saturating_add(answer_bytes));
        (wire, self.exchanges.deadline(wire + self.options.silence(), self.options.deadline))
    }

    /// Throws away what has come until the line is silent. A line that never is shows in the answer.
    async fn clear(&mut self, action: Action) -> Result<(), DriveError> {
        self.transport.forget_echo();
        self.transport.expect(None);
        let mut leftovers = [0; 256];
        for _ in 0..MOST_LEFTOVERS {
            match timeout(self.options.silence(), self.transport.read(&mut leftovers)).await {
                Err(_) | Ok(Ok(0)) => return Ok(()),
                Ok(Ok(_)) => {}
                Ok(Err(source)) => {
                    return Err(DriveError::Transport { at: self.at(action), source });
                }
            }
        }
        Ok(())
    }

    /// Throws away what has come since the last answer, and so answers nothing (an answer that came twice), without
    /// waiting for more.
    async fn drain(&mut self, action: Action) -> Result<(), DriveError> {
        let mut leftovers = [0; 256];
        for _ in 0..MOST_LEFTOVERS {
            // A timer of no time still takes a tick of the runtime, a millisecond.
            let come = tokio::select! {
                biased;
                read = self.transport.read(&mut leftovers) => read,
                () = std::future::ready(()) => break,
            };
            match come {
                Ok(0) => break,
                Ok(_) => {}
                Err(source) => {
                    return Err(DriveError::Transport { at: self.at(action), source });
                }
            }
        }
        Ok(())
    }

    /// Sends a request and takes the answer, whichever it is, within the deadline.
    pub(super) async fn exchange(
        &mut self,
        action: Action,
        request: Request<'_>,
        clock: &dyn Clock,
    ) -> Result<(Response, Stamp), DriveError> {
        if let Some(silence) = self.silence.take() {
            silence.over().await;
        }
        if std::mem::take(&mut self.in_step) {
            self.drain(action).await?;
        } else {
            self.clear(action).await?;
        }
        // A client keeps what it has read too much: each answers but one request.
        let mut client = rtu::attach_slave(self.transport.clone(), Slave(self.options.address));
        let sent_bytes = request_bytes(&request);
        let (_, deadline) = self.deadline(sent_bytes, due_bytes(&request));
        self.transport.expect(Some(due_bytes(&request)));
        let begun = Instant::now();
        let sent_ns = clock.now_ns();
        // If the caller gives up meanwhile, the answer may come later.
        let late = std::mem::replace(&mut self.late, true);
        let outcome = timeout(deadline, client.call(request)).await;
        let took = begun.elapsed();
        self.transport.expect(None);
        let answered_ns = clock.now_ns();
        self.silence = Some(Pause::begin(self.options.silence(), self.alone));
        let at = self.at(action);
        let error = match outcome {
            Ok(Ok(Ok(response))) => {
                (self.in_step, self.late) = (true, late);
                let bytes = sent_bytes.saturating_add(answer_bytes(&response));
                self.exchanges.answered(took, self.options.line.duration(bytes));
                let stamp = self.stamp(sent_ns, answered_ns, sent_bytes, answer_bytes(&response));
                return Ok((response, stamp));
            }
            Ok(Ok(Err(code))) => {
                (self.in_step, self.late) = (true, late);
                return Err(DriveError::device(at, Exception(code.into())));
            }
            Ok(Err(Error::Protocol(mismatch))) => {
                DriveError::Protocol { at, fault: fault(&mismatch) }
            }
            Ok(Err(Error::Transport(source))) if source.kind() == io::ErrorKind::InvalidData => {
                DriveError::Protocol { at, fault: ProtocolFault::Garbled }
            }
            Ok(Err(Error::Transport(source))) => DriveError::Transport { at, source },
            Err(_) => DriveError::Timeout { at, deadline },
        };
        if error.is_lost() {
            self.exchanges.lost();
        }
        Err(error)
    }

    fn stamp(
        &self,
        sent_ns: i64,
        answered_ns: i64,
        sent_bytes: usize,
        answer_bytes: usize,
    ) -> Stamp {
        let (line, answered_ns) = (self.options.line, answered_ns.max(sent_ns));
        let first = sent_ns + whole_ns(line.duration(sent_bytes));
        let last = answered_ns - whole_ns(line.duration(answer_bytes));
        // A line faster than its baud rate (a pseudo-terminal) may make the wire times exceed the exchange.
        let executed_ns = i64::midpoint(first, last).clamp(sent_ns, answered_ns);
        Stamp { sent_ns, executed_ns, uncertainty_ns: (last - first).max(0) / 2, answered_ns }
    }
}

/// Length of the frame of a request.
fn request_bytes(request: &Request<'_>) -> usize {
    match request {
        Request::WriteMultipleRegisters(_, words) => 9 + 2 * words.len(),
        Request::WriteMultipleCoils(_, coils) => 9 + coils.len().div_ceil(8),
        _ => 8,
    }
}

/// Length of the frame of the answer that is due to a request.
fn due_bytes(request: &Request<'_>) -> usize {
    match request {
        Request::ReadInputRegisters(_, count) | Request::ReadHoldingRegisters(_, count) => {
            5 + 2 * usize::from(*count)
        }
        Request::ReadCoils(_, count) | Request::ReadDiscreteInputs(_, count) => {
            5 + usize::from(*count).div_ceil(8)
        }
        _ => 8,
    }
}

/// Length of the frame of an answer.
fn answer_bytes(response: &Response) -> usize {
    match response {
        Response::ReadInputRegisters(words) | Response::ReadHoldingRegisters(words) => {
            5 + 2 * words.len()
        }
        Response::ReadCoils(bits) | Response::ReadDiscreteInputs(bits) => {
            5 + bits.len().div_ceil(8)
        }
        _ => 8,
    }
}

fn fault(error: &ProtocolError) -> ProtocolFault {
    match error {
        ProtocolError::HeaderMismatch { .. } => ProtocolFault::Station,
        ProtocolError::FunctionCodeMismatch { request, result } => {
            let received = match result {
                Ok(response) => response.function_code(),
                Err(exception) => exception.function,
            };
            ProtocolFault::Function { sent: request.value(), received: received.value() }
        }
    }
}
