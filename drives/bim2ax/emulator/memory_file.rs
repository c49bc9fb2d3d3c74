//! A module on a memory file, on a thread of its own.

use std::{
    fs::{self, File, OpenOptions, TryLockError},
    io::{self, Write},
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    },
    time::Duration,
};

use super::{Control, Eeprom, Module, ModuleOptions, Surroundings};
use crate::protocol::memory::{
    BIM2AX_BOCM, HOST_PAGE, IDENTIFIER, INTERRUPT, MODULE_PAGE, Mapping, PAGE_REGISTER, RECEIPTS,
    WINDOW_LENGTH, file_offset,
};
use twin_drives::{
    Accelerated, Clock, EmulatorError, Speed,
    emulator_host::{Host, LockedFile, replace, restored},
    port::FILE_LENGTH,
};

/// Said of a file that is none.
const NO_IMAGE: &str = "this is not an image of the EEPROM of an emulated BIM2AX-BOCM";
/// Pause between two looks at the file.
const PAUSE: Duration = Duration::from_micros(200);

/// Settings of an emulated module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EmulatorOptions {
    /// The memory file ([`super::super::MemoryFile`] says what is in it). It is made if it does not exist, and
    /// removed at the end.
    pub path: PathBuf,
    /// The module.
    pub module: ModuleOptions,
    /// Surroundings of its axes.
    pub surroundings: Surroundings,
    /// File with the image of the EEPROM, read at the start if it exists and replaced whenever something is stored;
    /// none for an EEPROM that is as new at every start.
    pub eeprom: Option<PathBuf>,
    /// Decides what faults by chance do.
    pub seed: u64,
    /// Speed of the module's time against the clock. It looks at its file no more often for that.
    pub speed: Speed,
}

impl EmulatorOptions {
    /// A module on this memory file with everything else at its default.
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_path_buf(),
            module: ModuleOptions::default(),
            surroundings: Surroundings::default(),
            eeprom: None,
            seed: 0,
            speed: Speed::REAL,
        }
    }
}

/// A running emulator. Dropping it stops it.
#[derive(Debug)]
pub struct EmulatedModule {
    path: PathBuf,
    module: Arc<Mutex<Module>>,
    host: Host<SyncSender<()>, ()>,
}

impl EmulatedModule {
    /// Powers a module up. `clock` gives the time by which its axes move.
    ///
    /// # Errors
    /// If the file is there and is no memory file, if files cannot be made, read or mapped, or there is no thread.
    pub fn start(
        options: &EmulatorOptions,
        clock: impl Clock + 'static,
    ) -> Result<Self, EmulatorError> {
        let mut lock = options.eeprom.as_deref().map(LockedFile::lock).transpose()?;
        let stored = options.eeprom.as_deref();
        let stored = stored
            .map(|path| restored(path, |image| Eeprom::of_image(image).ok_or(NO_IMAGE)))
            .transpose()?;
        let eeprom = stored.flatten().unwrap_or_else(|| Eeprom::new(options.module.rating_ma));
        lock.iter_mut().for_each(LockedFile::keep);
        let file = memory_file(&options.path)?;
        let mapping = Mapping::new(file, 0, FILE_LENGTH)
            .map_err(|source| EmulatorError::File { path: options.path.clone(), source })?;
        let mut module = Module::new(&options.module, &eeprom, &options.surroundings);
        module.set_seed(options.seed);
        let clock = Accelerated::new(clock, options.speed);
        let module = Arc::new(Mutex::new(module));
        let (end, ended) = sync_channel(1);
        let server = Server {
            module: Arc::clone(&module),
            start_ns: clock.now_ns(),
            clock: Box::new(clock),
            mapping,
            interrupts: 0,
            served: 0,
            starts: 0,
            eeprom: options.eeprom.clone(),
            stores: 0,
            gone: false,
        };
        let name = format!("bim2ax {}", options.path.display());
        let locks = lock.into_iter().collect();
        let host = Host::start(name, end, locks, move || server.run(&ended))?;
        Ok(Self { path: options.path.clone(), module, host })
    }

    /// The memory file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The module, to press its switches and break it. While it is held it does not serve its host.
    pub fn module(&self) -> MutexGuard<'_, Module> {
        self.module.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes something happen to the module or its bus.
    pub fn control(&self, what: Control) {
        self.module().control(what);
    }

    /// Powers the module down and gives it back as it was then.
    ///
    /// # Errors
    /// If the emulator has ended before, because of its files.
    pub fn stop(mut self) -> Result<Module, EmulatorError> {
        let path = self.path.clone();
        self.host.stop(|source| EmulatorError::File { path, source })?;
        let module = self.module().clone();
        Ok(module)
    }
}

impl Drop for EmulatedModule {
    fn drop(&mut self) {
        // An error that ended it before has no reader any more, nor has a file that cannot be removed.
        drop(self.host.stop(|source| EmulatorError::Thread { source }));
        drop(fs::remove_file(&self.path));
    }
}

/// Makes the memory file, or takes one that is left over. It stays locked as long as it is mapped.
fn memory_file(path: &Path) -> Result<File, EmulatorError> {
    let failed = |source| EmulatorError::File { path: path.to_path_buf(), source };
    let taken = || EmulatorError::LinkTaken { path: path.to_path_buf() };
    match fs::metadata(path) {
        Ok(found) if found.is_file() && usize::try_from(found.len()) == Ok(FILE_LENGTH) => {}
        Ok(_) => return Err(taken()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(failed(error)),
    }
    let mut open = OpenOptions::new();
    // Not truncated: a host may have it mapped still.
    let open = open.read(true).write(true).create(true).truncate(false);
    let mut file = open.open(path).map_err(failed)?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => return Err(taken()),
        Err(TryLockError::Error(source)) => return Err(failed(source)),
    }
    file.write_all(&[0; FILE_LENGTH]).map_err(failed)?;
    Ok(file)
}

/// The thread's own.
struct Server {
    module: Arc<Mutex<Module>>,
    clock: Box<dyn Clock>,
    start_ns: i64,
    mapping: Mapping,
    /// Interrupts by the host so far, as the file counts them.
    interrupts: u8,
    /// Interrupts that have taken effect and been written to the file.
    served: u64,
    /// Starts of the software, after each of which the RAM is another.
    starts: u64,
    eeprom: Option<PathBuf>,
    stores: u64,
    /// The module is off the bus.
    gone: bool,
}

impl Server {
    fn run(mut self, ended: &Receiver<()>) -> io::Result<()> {
        let module = Arc::clone(&self.module);
        let lock = || module.lock().unwrap_or_else(PoisonError::into_inner);
        self.mapping.store(file_offset::IDENTIFIER, BIM2AX_BOCM)?;
        self.say(&lock())?;
        loop {
            {
                let mut module = lock();
                module.advance(self.clock.now_ns() - self.start_ns);
                let interrupts = self.mapping.load(file_offset::INTERRUPTS)?;
                if interrupts != self.interrupts {
                    self.interrupts = interrupts;
                    if !module.is_disconnected() {
                        self.hear(&mut module)?;
                    }
                }
                if module.is_disconnected() != self.gone {
                    self.gone = module.is_disconnected();
                    self.mapping.store(file_offset::IDENTIFIER, module.bus_read(IDENTIFIER))?;
                    self.say(&module)?;
                }
                self.mapping.store(file_offset::STATUS, module.bus_read(PAGE_REGISTER))?;
                if module.served() != self.served && !self.gone {
                    self.served = module.served();
                    self.say(&module)?;
                    let count = self.mapping.load(file_offset::SERVED)?;
                    self.mapping.store(file_offset::SERVED, count.wrapping_add(1))?;
                }
                if module.starts() != self.starts {
                    self.starts = module.starts();
                    self.say(&module)?;
                }
                if module.stores() != self.stores {
                    self.stores = module.stores();
                    if let Some(path) = &self.eeprom {
                        replace(path, &module.eeprom().to_bytes())?;
                    }
                }
            }
            match ended.recv_timeout(PAUSE) {
                Err(RecvTimeoutError::Timeout) => {}
                Ok(()) | Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
        }
    }

    /// Takes what the host has written, and its interrupt.
    fn hear(&self, module: &mut Module) -> io::Result<()> {
        for offset in 0..INTERRUPT {
            let byte = self.mapping.load(place(HOST_PAGE, offset))?;
            module.set_ram(HOST_PAGE, offset, byte);
        }
        for offset in [0, RECEIPTS] {
            let byte = self.mapping.load(place(MODULE_PAGE, offset))?;
            module.set_ram(MODULE_PAGE, offset, byte);
        }
        module.interrupt();
        Ok(())
    }

    /// Writes what the module says: which zone has been refreshed comes last, when the zone is there.
    fn say(&self, module: &Module) -> io::Result<()> {
        for offset in (0..WINDOW_LENGTH).rev() {
            // Of a module that is gone nothing is seen.
            let byte = if self.gone { 0xFF } else { module.ram(MODULE_PAGE, offset) };
            self.mapping.store(place(MODULE_PAGE, offset), byte)?;
        }
        Ok(())
    }
}

fn place(page: u8, offset: u8) -> usize {
    usize::from(page) * usize::from(WINDOW_LENGTH) + usize::from(offset)
}
