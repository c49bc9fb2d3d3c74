//! The board over the wire: one exchange at a time, each with a deadline.

use std::{borrow::Cow, sync::Arc};

use tokio_modbus::{Request, Response};
use tokio_serial::{DataBits, FlowControl, StopBits};

mod access;
mod exchange;
mod homing;
mod lock;
mod memory;
mod motion;
pub(crate) mod options;
mod outcome;
pub(crate) mod port;
mod ranges;
mod settings;

pub use memory::Snapshot;
pub use options::{AxisOptions, EncoderOptions, Following, InterpCncOptions};
pub use settings::Identity;

use self::exchange::Sending;
use super::{Command, Line, Parity};
use crate::{
    client::port::SharedPort,
    protocol::registers::{
        AXES, COMMAND, FIRST_OUTPUT, OUTPUTS, STATE_REGISTERS, STATUS, Status, join,
    },
};
use twin_drives::{
    Action, Clock, DriveError, Exchange, Exchanges, ProtocolFault, Stamp, pause::Pause,
    port::open_serial, transport::Transport,
};

/// Reads after which no more silence is waited for.
const MOST_LEFTOVERS: u32 = 64;

/// Status and positions, registers 1024 to 1035.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardState {
    /// Status bits.
    pub status: Status,
    /// Position counters X, Y, Z, A, B, steps.
    pub positions: [i32; AXES],
}

impl BoardState {
    fn from_registers(registers: &[u16]) -> Option<Self> {
        let registers: &[u16; STATE_REGISTERS as usize] = registers.try_into().ok()?;
        let [high, low, counters @ ..] = *registers;
        let mut positions = [0; AXES];
        for (position, pair) in positions.iter_mut().zip(counters.chunks_exact(2)) {
            let &[high, low] = pair else { continue };
            *position = join(high, low).cast_signed();
        }
        Some(Self { status: Status(join(high, low)), positions })
    }
}

/// The board as a Modbus address. All calls need a tokio runtime with I/O and time.
///
/// After an exchange without a proper answer the answer may still come, and would be taken for that to the next
/// request. Before the next request, unless it is a stop, the driver therefore asks something else, whose answer is like no
/// other, and throws away what comes before it.
pub struct InterpCnc {
    port: Arc<str>,
    options: InterpCncOptions,
    transport: SharedPort,
    /// The last request has been answered: what comes now answers nothing, and there is no need to wait for silence.
    in_step: bool,
    /// An answer may still be on its way.
    late: bool,
    /// Which of the witness reads was the last.
    turn: u8,
    exchanges: Exchanges,
    /// Silence between the last frame and the next.
    silence: Option<Pause>,
    /// Whether it has its thread to itself.
    alone: bool,
}

impl std::fmt::Debug for InterpCnc {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { port, options, late, .. } = self;
        f.debug_struct("InterpCnc")
            .field("port", port)
            .field("options", options)
            .field("late", late)
            .finish()
    }
}

impl InterpCnc {
    /// Opens the serial port. Sends nothing.
    ///
    /// # Errors
    /// If an option is impossible or the port cannot be opened.
    pub fn open(port: &str, options: &InterpCncOptions) -> Result<Self, DriveError> {
        let name: Arc<str> = port.into();
        options.check(&name)?;
        let Line { baud, parity } = options.line;
        let parity = match parity {
            Parity::None => tokio_serial::Parity::None,
            Parity::Even => tokio_serial::Parity::Even,
            Parity::Odd => tokio_serial::Parity::Odd,
        };
        let serial = tokio_serial::new(port, baud)
            .parity(parity)
            .data_bits(DataBits::Eight)
            .stop_bits(StopBits::One)
            .flow_control(FlowControl::None);
        let stream = open_serial(port, serial).map_err(|source| DriveError::Transport {
            at: Exchange {
                port: Arc::clone(&name),
                address: options.address,
                action: Action::Open,
            },
            source,
        })?;
        Ok(Self::attach(name, stream, options))
    }

    /// The board at the other end of any stream of bytes.
    pub fn attach(
        port: Arc<str>,
        transport: impl Transport + 'static,
        options: &InterpCncOptions,
    ) -> Self {
        let transport = SharedPort::new(transport, options.echo);
        // What lies in the input from before is nobody's answer: the first exchange starts by clearing it.
        Self {
            port,
            options: options.clone(),
            transport,
            in_step: false,
            late: false,
            turn: 0,
            exchanges: Exchanges::new(options.turnaround),
            silence: None,
            alone: false,
        }
    }

    /// Keeps silences to the microsecond by putting its thread to sleep for up to 1.2 ms, which nobody else may need
    /// meanwhile. The timers of a runtime, which it waits for otherwise, make exchanges a fifth longer.
    #[must_use]
    pub fn alone(self) -> Self {
        Self { alone: true, ..self }
    }

    /// Exchange of an error, with the action under way.
    pub(crate) fn at(&self, action: Action) -> Exchange {
        Exchange { port: Arc::clone(&self.port), address: self.options.address, action }
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
    pub fn options(&self) -> &InterpCncOptions {
        &self.options
    }

    /// Reads status and positions; asked again at once if no proper answer comes.
    ///
    /// # Errors
    /// If no proper answer comes.
    pub async fn state(&mut self, clock: &dyn Clock) -> Result<(BoardState, Stamp), DriveError> {
        let request = Request::ReadInputRegisters(STATUS, STATE_REGISTERS);
        self.asked((Action::ReadState, Sending::Repeated), &request, clock, Self::state_of).await
    }

    /// Sends a command; success means that the board has accepted it, not that it is finished.
    ///
    /// Only commands that are idempotent ([`Command::is_idempotent`]) are sent again if no proper answer comes. After
    /// an error of any other it is unknown whether the board has executed it.
    ///
    /// # Errors
    /// If a value is beyond what the board takes, if the board refuses it, or if no proper answer comes.
    pub async fn send(
        &mut self,
        command: &Command,
        clock: &dyn Clock,
    ) -> Result<Stamp, DriveError> {
        self.check(command)?;
        let sending = match command {
            Command::RampStopAxes { .. } | Command::RampStop | Command::Stop => Sending::Stop,
            _ if command.is_idempotent() => Sending::Repeated,
            _ => Sending::Once,
        };
        let registers = command.registers();
        let request = Request::WriteMultipleRegisters(COMMAND, Cow::Borrowed(&registers));
        let confirmed =
            |board: &mut Self, answer: &Response| board.confirmed(command, &registers, answer);
        let outcome = self.asked((command.action(), sending), &request, clock, confirmed).await;
        match outcome {
            Ok(((), stamp)) => Ok(stamp),
            Err(error) => Err(self.if_locked(error, clock).await),
        }
    }

    /// Switches output `output` (1 to 32) and reads it back: a locked board confirms the write and leaves the output
    /// alone. Asked again at once if no proper answer comes.
    ///
    /// # Errors
    /// If the output does not exist, the board refuses it or is locked, or no proper answer comes.
    pub async fn set_output(
        &mut self,
        output: u8,
        on: bool,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let action = Action::SwitchOutput { output, on };
        if !(1..=OUTPUTS).contains(&output) {
            return Err(DriveError::Range {
                at: self.at(action),
                register: FIRST_OUTPUT,
                value: output.into(),
                unit: "",
                low: 1.0,
                high: OUTPUTS.into(),
            });
        }
        let coil = FIRST_OUTPUT + u16::from(output) - 1;
        let write = Request::WriteSingleCoil(coil, on);
        let done = Response::WriteSingleCoil(coil, on);
        let confirmed = |answer: &Response| (*answer == done).then_some(());
        if let Err(error) = self.understood(action, &write, clock, confirmed).await {
            return Err(self.if_locked(error, clock).await);
        }
        let read = Request::ReadCoils(coil, 1);
        let state = self.understood(action, &read, clock, |answer| match answer {
            Response::ReadCoils(coils) => coils.first().copied(),
            _ => None,
        });
        if state.await? == on { Ok(()) } else { Err(DriveError::Locked { at: self.at(action) }) }
    }

    /// Checks that the board is neither locked nor without ENABLE.
    ///
    /// # Errors
    /// [`DriveError::EnableOpen`], [`DriveError::Locked`]; `action` is what they name.
    pub fn check_obeys(&self, state: &BoardState, action: Action) -> Result<(), DriveError> {
        if state.status.enable_open() {
            Err(DriveError::EnableOpen { at: self.at(action) })
        } else if state.status.locked() {
            Err(DriveError::Locked { at: self.at(action) })
        } else {
            Ok(())
        }
    }

    fn state_of(&mut self, response: &Response) -> Result<BoardState, DriveError> {
        let registers = match response {
            Response::ReadInputRegisters(registers) => registers.as_slice(),
            _ => &[],
        };
        BoardState::from_registers(registers).ok_or_else(|| {
            let fault = ProtocolFault::Length {
                expected: STATE_REGISTERS.into(),
                received: registers.len(),
            };
            self.distrust(Action::ReadState, fault)
        })
    }

    fn confirmed(
        &mut self,
        command: &Command,
        written: &[u16],
        response: &Response,
    ) -> Result<(), DriveError> {
        let (confirmed_address, confirmed_count) = match response {
            Response::WriteMultipleRegisters(address, count) => (*address, *count),
            _ => (0, 0),
        };
        let count = u16::try_from(written.len()).unwrap_or(u16::MAX);
        if (confirmed_address, confirmed_count) == (COMMAND, count) {
            return Ok(());
        }
        let fault = ProtocolFault::Confirmation {
            address: COMMAND,
            count,
            confirmed_address,
            confirmed_count,
        };
        Err(self.distrust(command.action(), fault))
    }
}
