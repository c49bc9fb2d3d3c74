//! Ctrl-C, and the signals that ask a program to end.

use crate::command::Failure;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering};
use std::time::Duration;
use tokio::signal::unix::{SignalKind, signal};

/// What people call what asks for an end.
const NAMES: [&str; 3] = ["Ctrl-C", "SIGTERM", "SIGHUP"];

/// How often somebody has asked for the end.
#[derive(Clone, Debug)]
pub(in crate::command) struct Interrupt {
    count: Arc<AtomicU32>,
    /// Place among [`NAMES`] of the first that came.
    first: Arc<AtomicU8>,
}

/// None has come yet.
const NONE: u8 = u8::MAX;

impl Interrupt {
    pub(in crate::command) fn catch() -> Result<Self, Failure> {
        let caught =
            Self { count: Arc::new(AtomicU32::new(0)), first: Arc::new(AtomicU8::new(NONE)) };
        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build();
        let runtime = runtime.map_err(Failure::Interrupt)?;
        let kinds = [SignalKind::interrupt(), SignalKind::terminate(), SignalKind::hangup()];
        let mut signals = Vec::with_capacity(kinds.len());
        for kind in kinds {
            let _inside = runtime.enter();
            // From here on they end nothing by themselves.
            signals.push(signal(kind).map_err(Failure::Interrupt)?);
        }
        let counter = caught.clone();
        let listen = move || {
            runtime.block_on(async {
                let [one, two, three] = &mut *signals else { return };
                loop {
                    let place = tokio::select! {
                        Some(()) = one.recv() => 0,
                        Some(()) = two.recv() => 1,
                        Some(()) = three.recv() => 2,
                        else => return,
                    };
                    counter.came(place);
                }
            });
        };
        let thread = std::thread::Builder::new().name("signals".to_owned()).spawn(listen);
        thread.map_err(Failure::Interrupt)?;
        Ok(caught)
    }

    fn came(&self, place: u8) {
        // The first one is what the program ends for; nobody has to read it when there is one already.
        self.first.compare_exchange(NONE, place, Ordering::Relaxed, Ordering::Relaxed).ok();
        self.count.fetch_add(1, Ordering::Relaxed);
    }

    pub(in crate::command) fn count(&self) -> u32 {
        self.count.load(Ordering::Relaxed)
    }

    /// What has asked for the end, as people call it.
    pub(in crate::command) fn name(&self) -> &'static str {
        let first = usize::from(self.first.load(Ordering::Relaxed));
        NAMES.get(first).copied().unwrap_or("Ctrl-C")
    }

    /// What ends the run, where that is nobody at the keyboard.
    pub(super) fn signal(&self) -> Option<&'static str> {
        Some(self.name()).filter(|name| *name != "Ctrl-C")
    }

    /// Sleeps until the next one.
    pub(in crate::command) fn wait(&self) {
        let before = self.count();
        while self.count() == before {
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}
