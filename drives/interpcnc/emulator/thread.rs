//! An emulated board on a pseudo-terminal, on a thread of its own.

use std::{
    io,
    path::{Path, PathBuf},
    thread::{Builder, JoinHandle},
};

use tokio::{runtime, sync::mpsc};
use tokio_serial::SerialStream;

use super::{
    Bench, Board, BoardOptions, Control, Event, Wire,
    serve::{Served, serve_with},
};
use twin_drives::{
    Accelerated, Clock, EmulatorError, FaultyWire, Speed, emulator_host as slave,
    emulator_host::Message,
    locked_file::{LockedFile, replace},
    pty::{DeviceSpeed, PseudoTerminal},
};

/// What to emulate.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EmulatorOptions {
    /// The board at power-up.
    pub board: BoardOptions,
    /// Emulated delays. Its line is that of the bytes; the board's own only shows in its parameters, until these ask for
    /// another: in the file of the EEPROM, or when the board starts anew.
    pub wire: Wire,
    /// Symbolic link to make to the pseudo-terminal; it is removed at the end.
    pub link: Option<PathBuf>,
    /// What stands around the board.
    pub bench: Bench,
    /// File with the EEPROM. If it is there the board powers up with it, else with the parameters of a new one; what
    /// the board stores goes there at once.
    pub eeprom: Option<PathBuf>,
    /// It understands masters whatever speed they have set on their side of the pseudo-terminal; otherwise one at another
    /// speed gets no answer, as from the device. Masters that set no speed find the right one.
    pub any_speed: bool,
    /// Decides what faults by chance do.
    pub seed: u64,
    /// How many times faster than its clock the board lives, its wire included.
    pub speed: Speed,
}

/// A running emulator. Dropping it stops it.
pub struct EmulatedBoard {
    terminal: PseudoTerminal,
    /// Closed to end the thread.
    control: Option<mpsc::Sender<Message<Served>>>,
    thread: Option<JoinHandle<io::Result<Board>>>,
    _lock: Option<LockedFile>,
}

impl std::fmt::Debug for EmulatedBoard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("EmulatedBoard").field("path", &self.path()).finish_non_exhaustive()
    }
}

impl EmulatedBoard {
    /// Powers a board up. `clock` gives the time by which its axes move.
    ///
    /// # Errors
    /// If there is no pseudo-terminal or no thread to be had, the link cannot be made, or the file with the EEPROM
    /// cannot be read or is none.
    pub fn start(
        options: &EmulatorOptions,
        clock: impl Clock + 'static,
    ) -> Result<Self, EmulatorError> {
        let mut lock = options.eeprom.as_deref().map(LockedFile::lock).transpose()?;
        let mut board = power_up(options)?;
        lock.iter_mut().for_each(LockedFile::keep);
        board.set_bench(options.bench.clone());
        let (master, mut terminal) = PseudoTerminal::open(options.link.as_deref())?;
        let failed = |source| EmulatorError::Thread { source };
        let runtime =
            runtime::Builder::new_current_thread().enable_all().build().map_err(failed)?;
        let stream = {
            let _inside = runtime.enter();
            SerialStream::try_from(master)
                .map_err(|error| EmulatorError::Terminal { source: error.into() })?
        };
        let mut wire = options.wire;
        if board.line() != options.board.line {
            // The EEPROM says so.
            wire.line = board.line();
        }
        let speed = DeviceSpeed::new(wire.line.baud);
        let stream = terminal.at_speed(stream, &speed, options.any_speed)?;
        let (control, messages) = mpsc::channel(64);
        let faults = FaultyWire::new(options.seed);
        let clock = Accelerated::new(clock, options.speed);
        let file = options.eeprom.clone();
        let thread = Builder::new()
            .name(format!("interpcnc {}", terminal.path().display()))
            .spawn(move || {
                let stored = Box::new(move |board: &Board| match &file {
                    Some(path) => replace(path, &board.eeprom()),
                    None => Ok(()),
                });
                let wire = (&wire, faults, speed);
                runtime.block_on(serve_with(stream, board, wire, &clock, messages, stored))
            })
            .map_err(failed)?;
        Ok(Self { terminal, control: Some(control), thread: Some(thread), _lock: lock })
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
        self.control(Control::Event(Event::Enable(closed)))
    }

    /// Sets input `number` (1 to 32).
    ///
    /// # Errors
    /// If the emulator has ended.
    pub fn set_input(&self, number: u8, level: bool) -> Result<(), EmulatorError> {
        self.control(Control::Event(Event::Input { number, level }))
    }

    /// Makes something happen to the board or the wire.
    ///
    /// # Errors
    /// If the emulator has ended.
    pub fn control(&self, what: Control) -> Result<(), EmulatorError> {
        slave::send(self.control.as_ref(), what.into())
    }

    /// The board as it is now.
    ///
    /// # Errors
    /// If the emulator has ended.
    pub fn look(&self) -> Result<Box<Board>, EmulatorError> {
        slave::look(self.control.as_ref())
    }

    /// Powers the board down and gives it back as it was then.
    ///
    /// # Errors
    /// If the emulator has ended before, because of its terminal or the file with its EEPROM.
    pub fn stop(mut self) -> Result<Board, EmulatorError> {
        self.control = None;
        let thread = self.thread.take().ok_or(EmulatorError::Ended)?;
        thread
            .join()
            .map_err(|_panic| EmulatorError::Ended)?
            .map_err(|source| EmulatorError::Terminal { source })
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

/// The board with the EEPROM of its file, if there is one.
fn power_up(options: &EmulatorOptions) -> Result<Board, EmulatorError> {
    let Some(path) = &options.eeprom else { return Ok(Board::new(&options.board)) };
    let failed = |source| EmulatorError::File { path: path.clone(), source };
    match std::fs::read(path) {
        Ok(image) => Board::with_eeprom(&options.board, &image)
            .map_err(|bad| failed(io::Error::new(io::ErrorKind::InvalidData, bad))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Board::new(&options.board)),
        Err(error) => Err(failed(error)),
    }
}
