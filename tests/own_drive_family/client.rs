//! Client: one exchange at a time, each with a deadline.

use crate::protocol::{self, BAUD, Refusal, Request, State};
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::runtime::{Builder, Runtime};
use tokio::time::timeout;
use tokio_serial::SerialStream;
use twin_drives::{Action, DeviceFault, DriveError, Exchange, ProtocolFault, port::open_serial};

impl DeviceFault for Refusal {}

/// A device on a serial port.
#[derive(Debug)]
pub(crate) struct Client {
    port: Arc<str>,
    deadline: Duration,
    stream: SerialStream,
    /// Last, so that the port is closed while its runtime exists.
    runtime: Runtime,
}

impl Client {
    pub(crate) fn open(port: &str, deadline: Duration) -> Result<Self, DriveError> {
        let failed = |source| {
            let at = Exchange { port: port.into(), address: 0, action: Action::Open };
            DriveError::Transport { at, source }
        };
        let runtime = Builder::new_current_thread().enable_all().build().map_err(failed)?;
        let stream = {
            let _inside = runtime.enter();
            open_serial(port, tokio_serial::new(port, BAUD)).map_err(failed)?
        };
        Ok(Self { port: port.into(), deadline, stream, runtime })
    }

    pub(crate) fn at(&self, action: Action) -> Exchange {
        Exchange { port: Arc::clone(&self.port), address: 0, action }
    }

    /// Sends a request and gives the state that answers it. What has come before belongs to no request.
    pub(crate) fn ask(
        &mut self,
        name: &'static str,
        request: Request,
    ) -> Result<State, DriveError> {
        let at = self.at(Action::Command { number: 0, name });
        let Self { deadline, stream, runtime, .. } = self;
        let exchange = async {
            let mut chunk = [0; 256];
            while stream.try_read(&mut chunk).is_ok_and(|count| count > 0) {}
            stream.write_all(&request.encode()).await?;
            let mut line = Vec::new();
            while line.last() != Some(&b'\n') {
                line.push(stream.read_u8().await?);
            }
            Ok(line)
        };
        // A timer needs its runtime.
        let answered = runtime.block_on(async { timeout(*deadline, exchange).await });
        let line = match answered {
            Err(_elapsed) => return Err(DriveError::Timeout { at, deadline: *deadline }),
            Ok(Err(source)) => return Err(DriveError::Transport { at, source }),
            Ok(Ok(line)) => line,
        };
        match protocol::decode(&line) {
            Some(Ok(state)) => Ok(state),
            Some(Err(refusal)) => Err(DriveError::device(at, refusal)),
            None => Err(DriveError::Protocol { at, fault: ProtocolFault::Garbled }),
        }
    }
}
