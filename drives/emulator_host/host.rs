//! Thread that serves an emulated device until it is stopped or dropped.

use std::{
    fmt, io,
    thread::{Builder, JoinHandle},
};

use super::LockedFile;
use crate::EmulatorError;

/// Thread of an emulated device. `C` controls it and ends it when it is dropped; `D` is the device that comes back.
pub struct Host<C, D> {
    control: Option<C>,
    thread: Option<JoinHandle<io::Result<D>>>,
    _locks: Vec<LockedFile>,
}

impl<C, D> fmt::Debug for Host<C, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Host").field("serves", &self.thread.is_some()).finish_non_exhaustive()
    }
}

impl<C, D: Send + 'static> Host<C, D> {
    /// Starts a thread of this name. `serve` returns when `control` is dropped. The files stay locked meanwhile.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn start(
        name: String,
        control: C,
        locks: Vec<LockedFile>,
        serve: impl FnOnce() -> io::Result<D> + Send + 'static,
    ) -> Result<Self, EmulatorError> {
        let thread = Builder::new().name(name).spawn(serve);
        let thread = thread.map_err(|source| EmulatorError::Thread { source })?;
        Ok(Self { control: Some(control), thread: Some(thread), _locks: locks })
    }

    /// The control of the device while it is served.
    pub fn control(&self) -> Option<&C> {
        self.control.as_ref()
    }

    /// Ends the thread and gives back the device.
    ///
    /// # Errors
    /// [`EmulatorError::Ended`] after a panic; otherwise the error that ended the service before, as `named`.
    pub fn stop(
        &mut self,
        named: impl FnOnce(io::Error) -> EmulatorError,
    ) -> Result<D, EmulatorError> {
        self.control = None;
        let thread = self.thread.take().ok_or(EmulatorError::Ended)?;
        thread.join().map_err(|_panic| EmulatorError::Ended)?.map_err(named)
    }
}

impl<C, D> Drop for Host<C, D> {
    fn drop(&mut self) {
        self.control = None;
        if let Some(thread) = self.thread.take() {
            // The result has no reader any more.
            drop(thread.join());
        }
    }
}
