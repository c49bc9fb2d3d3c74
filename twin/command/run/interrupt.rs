//! Ctrl-C.

use crate::command::Failure;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

/// Ctrl-C, counted.
#[derive(Clone, Debug)]
pub(in crate::command) struct Interrupt {
    count: Arc<AtomicU32>,
}

impl Interrupt {
    pub(in crate::command) fn catch() -> Result<Self, Failure> {
        let count = Arc::new(AtomicU32::new(0));
        let counter = Arc::clone(&count);
        ctrlc::set_handler(move || {
            counter.fetch_add(1, Ordering::Relaxed);
        })?;
        Ok(Self { count })
    }

    pub(in crate::command) fn count(&self) -> u32 {
        self.count.load(Ordering::Relaxed)
    }

    /// Sleeps until the next Ctrl-C.
    pub(in crate::command) fn wait(&self) {
        let before = self.count();
        while self.count() == before {
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}
