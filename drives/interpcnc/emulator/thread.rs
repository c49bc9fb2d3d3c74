//! An emulated board on a pseudo-terminal, on a thread of its own.

use std::{
    io,
    path::{Path, PathBuf},
    thread::{Builder, JoinHandle},
};

use tokio::{runtime, sync::mpsc};
use tokio_serial::SerialStream;

use super::{Board, BoardOptions, Control, Wire, serve};
use crate::{Clock, EmulatorError, pty::PseudoTerminal};

/// What to emulate.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EmulatorOptions {
    /// The board at power-up.
    pub board: BoardOptions,
    /// Emulated delays. Its line is that of the bytes; the board's own only shows in its parameters.
    pub wire: Wire,
    /// Symbolic link to make to the pseudo-terminal; it is removed at the end.
    pub link: Option<PathBuf>,
}

/// A running emulator. Dropping it stops it.
#[derive(Debug)]
pub struct EmulatedBoard {
    terminal: PseudoTerminal,
    /// Closed to end the thread.
    control: Option<mpsc::Sender<Control>>,
    thread: Option<JoinHandle<io::Result<Board>>>,
}

impl EmulatedBoard {
    /// Powers a board up. `clock` gives the time by which its axes move.
    ///
    /// # Errors
    /// If there is no pseudo-terminal or no thread to be had, or the link cannot be made.
    pub fn start(
        options: &EmulatorOptions,
        clock: impl Clock + 'static,
    ) -> Result<Self, EmulatorError> {
        let (master, terminal) = PseudoTerminal::open(options.link.as_deref())?;
        let failed = |source| EmulatorError::Thread { source };
        let runtime =
            runtime::Builder::new_current_thread().enable_all().build().map_err(failed)?;
        let stream = {
            let _inside = runtime.enter();
            SerialStream::try_from(master)
                .map_err(|error| EmulatorError::Terminal { source: error.into() })?
        };
        let (control, messages) = mpsc::channel(64);
        let (board, wire) = (Board::new(&options.board), options.wire);
        let thread = Builder::new()
            .name(format!("interpcnc {}", terminal.path().display()))
            .spawn(move || runtime.block_on(serve(stream, board, &wire, &clock, messages)))
            .map_err(failed)?;
        Ok(Self { terminal, control: Some(control), thread: Some(thread) })
    }

    /// Where to open the board: the pseudo-terminal itself.
    pub fn path(&self) -> &Path {
        self.terminal.path()
    }

    /// Opens or closes the ENABLE input.
    ///
    /// # Errors
    /// If the emulator has ended.
    pub fn set_enable(&self, closed: bool) -> Result<(), EmulatorError> {
        self.send(Control::Enable(closed))
    }

    /// Sets input `number` (1 to 32).
    ///
    /// # Errors
    /// If the emulator has ended.
    pub fn set_input(&self, number: u8, level: bool) -> Result<(), EmulatorError> {
        self.send(Control::Input { number, level })
    }

    /// Powers the board down and gives it back as it was then.
    ///
    /// # Errors
    /// If the emulator has ended before, because of its terminal.
    pub fn stop(mut self) -> Result<Board, EmulatorError> {
        self.control = None;
        let thread = self.thread.take().ok_or(EmulatorError::Ended)?;
        thread
            .join()
            .map_err(|_panic| EmulatorError::Ended)?
            .map_err(|source| EmulatorError::Terminal { source })
    }

    fn send(&self, message: Control) -> Result<(), EmulatorError> {
        // The emulator takes messages as they come: the queue is full only if it no longer runs.
        let control = self.control.as_ref().ok_or(EmulatorError::Ended)?;
        control.try_send(message).map_err(|_unsent| EmulatorError::Ended)
    }
}

impl Drop for EmulatedBoard {
    fn drop(&mut self) {
        self.control = None;
        if let Some(thread) = self.thread.take() {
            // Its result matters to nobody any more.
            drop(thread.join());
        }
    }
}
