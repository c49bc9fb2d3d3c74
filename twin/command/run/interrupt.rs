//! Ctrl-C, and the signals that ask a program to end.

use crate::command::Failure;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering};
use std::time::Duration;
use tokio::signal::unix::{Signal, SignalKind, signal};

/// What people call what asks for an end.
const NAMES: [&str; 3] = ["Ctrl-C", "SIGTERM", "SIGHUP"];

/// How often somebody has asked for the end.
#[derive(Clone, Debug)]
pub(in crate::command) struct Interrupt {
    count: Arc<AtomicU32>,
    /// Places among [`NAMES`] of the first that came, and of the last.
    first: Arc<AtomicU8>,
    last: Arc<AtomicU8>,
    /// Which are not minded, bit by bit.
    ignored: u64,
}

/// None has come yet.
const NONE: u8 = u8::MAX;

impl Interrupt {
    /// For what moves machines: Ctrl-C and SIGTERM stop them whoever has started the program, and a script that starts it in
    /// the background has Ctrl-C ignored. Whoever starts it with nohup wants it to go on when the terminal is closed.
    pub(in crate::command) fn catch() -> Result<Self, Failure> {
        Self::catch_but(ignored() & 1 << (SignalKind::hangup().as_raw_value() - 1))
    }

    /// For what serves others: whoever has started it decides which signals end it.
    pub(in crate::command) fn catch_as_started() -> Result<Self, Failure> {
        Self::catch_but(ignored())
    }

    /// All but these, bit by bit, which stay as they are.
    fn catch_but(ignored: u64) -> Result<Self, Failure> {
        let none = || Arc::new(AtomicU8::new(NONE));
        let caught =
            Self { count: Arc::new(AtomicU32::new(0)), first: none(), last: none(), ignored };
        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build();
        let runtime = runtime.map_err(Failure::Interrupt)?;
        let kinds = [SignalKind::interrupt(), SignalKind::terminate(), SignalKind::hangup()];
        let mut signals = Vec::with_capacity(kinds.len());
        for kind in kinds {
            let _inside = runtime.enter();
            let minded = ignored >> (kind.as_raw_value() - 1) & 1 == 0;
            // From here on they end nothing by themselves.
            signals.push(minded.then(|| signal(kind)).transpose().map_err(Failure::Interrupt)?);
        }
        let counter = caught.clone();
        let listen = move || {
            runtime.block_on(async {
                let [one, two, three] = &mut *signals else { return };
                loop {
                    let place = tokio::select! {
                        () = come(one) => 0,
                        () = come(two) => 1,
                        () = come(three) => 2,
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
        self.last.store(place, Ordering::Relaxed);
        self.count.fetch_add(1, Ordering::Release);
    }

    pub(in crate::command) fn count(&self) -> u32 {
        self.count.load(Ordering::Acquire)
    }

    /// What has asked for the end first, as people call it.
    pub(in crate::command) fn name(&self) -> &'static str {
        called(&self.first)
    }

    /// What has asked for the end last.
    pub(in crate::command) fn latest(&self) -> &'static str {
        called(&self.last)
    }

    /// What ends the run, where that is nobody at the keyboard.
    pub(super) fn signal(&self) -> Option<&'static str> {
        Some(self.name()).filter(|name| *name != "Ctrl-C")
    }

    /// What ends a program that waits for nothing else, for people.
    pub(in crate::command) fn how_it_ends(&self) -> &'static str {
        if self.ignored >> (SignalKind::interrupt().as_raw_value() - 1) & 1 == 0 {
            "Ctrl-C ends it."
        } else {
            "SIGTERM ends it (Ctrl-C does not: it was started in the background)."
        }
    }

    /// Sleeps until the next one.
    pub(in crate::command) fn wait(&self) {
        let before = self.count();
        while self.count() == before {
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

fn called(place: &AtomicU8) -> &'static str {
    let place = usize::from(place.load(Ordering::Relaxed));
    NAMES.get(place).copied().unwrap_or("Ctrl-C")
}

/// Waits for a signal; for ever for one that is not minded.
async fn come(signal: &mut Option<Signal>) {
    if let Some(signal) = signal
        && signal.recv().await.is_some()
    {
        return;
    }
    std::future::pending::<()>().await;
}

/// The signals that the program was started to ignore, bit by bit (the first is bit 0), as the system tells it; none where it
/// does not.
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}
