//! An emulated module in the same process.

use std::{
    fmt, io,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use crate::emulator::Module;
use crate::protocol::memory::{Memory, offsets};
use twin_drives::Clock;

/// An emulated module that several can hold: one as its host, others to press its switches. Every access first lets
/// the module's time pass up to the clock's.
#[derive(Clone)]
pub struct SharedModule {
    module: Arc<Mutex<Module>>,
    clock: Arc<dyn Clock>,
}

impl fmt::Debug for SharedModule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SharedModule").field("module", &self.module).finish_non_exhaustive()
    }
}

impl SharedModule {
    /// Shares a module whose time is that of `clock`.
    pub fn new(module: Module, clock: impl Clock + 'static) -> Self {
        Self { module: Arc::new(Mutex::new(module)), clock: Arc::new(clock) }
    }

    /// The module, now. Nobody else gets at it while the guard lives, this thread included.
    pub fn module(&self) -> MutexGuard<'_, Module> {
        let mut module = self.module.lock().unwrap_or_else(PoisonError::into_inner);
        module.advance(self.clock.now_ns());
        module
    }
}

impl Memory for SharedModule {
    fn read(&mut self, offset: u8, bytes: &mut [u8]) -> io::Result<()> {
        let module = self.module();
        for (offset, byte) in offsets(offset, bytes.len())?.zip(bytes) {
            *byte = module.bus_read(offset);
        }
        Ok(())
    }

    fn write(&mut self, offset: u8, bytes: &[u8]) -> io::Result<()> {
        let mut module = self.module();
        for (offset, byte) in offsets(offset, bytes.len())?.zip(bytes) {
            module.bus_write(offset, *byte);
        }
        Ok(())
    }
}
