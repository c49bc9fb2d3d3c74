//! One exchange: a request, its answer within the deadline, and when it took place.

use std::io;

use tokio::{
    io::AsyncReadExt,
    time::{sleep, timeout},
};
use tokio_modbus::{
    Error, ProtocolError, Request, Response, Slave,
    client::{Client, rtu},
};

use super::{ATTEMPTS, InterpCnc, MOST_LEFTOVERS};
use crate::Exception;
use twin_drives::pause::Pause;
use twin_drives::ramp::whole_ns;
use twin_drives::{Action, Clock, DriveError, ProtocolFault, Stamp};

impl InterpCnc {
    /// An exchange that may be repeated, and what `understood` makes of its answer.
    pub(super) async fn asked_twice<T>(
        &mut self,
        action: Action,
        request: &Request<'_>,
        clock: &dyn Clock,
        understood: impl Fn(&Response) -> Option<T>,
    ) -> Result<T, DriveError> {
        let mut attempt = 1;
        loop {
            let outcome = self.settled_exchange(action, request.clone(), clock).await;
            match outcome.and_then(|(answer, _)| {
                understood(&answer).ok_or_else(|| self.distrust(action, ProtocolFault::Garbled))
            }) {
                Err(DriveError::Timeout { .. } | DriveError::Protocol { .. })
                    if attempt < ATTEMPTS =>
                {
                    attempt += 1;
                }
                done => return done,
            }
        }
    }

    /// An answer to something else came: answers may be out of step.
    pub(super) fn distrust(&mut self, action: Action, fault: ProtocolFault) -> DriveError {
        self.in_step = false;
        self.late = true;
        DriveError::Protocol { at: self.at(action), fault }
    }

    /// One exchange after any late answer has been waited for.
    pub(super) async fn settled_exchange(
        &mut self,
        action: Action,
        request: Request<'_>,
        clock: &dyn Clock,
    ) -> Result<(Response, Stamp), DriveError> {
        if self.late {
            sleep(self.options.worst_latency).await;
            // What has come meanwhile is thrown away before the request is sent.
            (self.late, self.in_step) = (false, false);
        }
        self.exchange(action, request, clock).await
    }

    /// Throws away what has come until the line is silent. A line that never is shows in the answer.
    async fn clear(&mut self, action: Action) -> Result<(), DriveError> {
        self.transport.forget_echo();
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
        let sent_ns = clock.now_ns();
        // If the caller gives up meanwhile, the answer may come later.
        let late = std::mem::replace(&mut self.late, true);
        let outcome = timeout(self.options.deadline, client.call(request)).await;
        let answered_ns = clock.now_ns();
        self.silence = Some(Pause::begin(self.options.silence(), self.alone));
        let at = self.at(action);
        let error = match outcome {
            Ok(Ok(Ok(response))) => {
                (self.in_step, self.late) = (true, late);
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
            Err(_) => DriveError::Timeout { at, deadline: self.options.deadline },
        };
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
