//! Ctrl-C and the other signals that end a program.

use crate::command::Failure;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering};
use std::time::Duration;
use tokio::signal::unix::{SignalKind, signal};

/// What asks for the end, and what people call it. The last two only stop machines; anything else is ended and suspended by
/// them as usual.
const KINDS: [(SignalKind, &str); 5] = [
    (SignalKind::interrupt(), "Ctrl-C"),
    (SignalKind::terminate(), "SIGTERM"),
    (SignalKind::hangup(), "SIGHUP"),
    (SignalKind::quit(), "Ctrl-\\"),
    (SignalKind::from_raw(SIGTSTP), "Ctrl-Z"),
];
/// How many of them end any program.
const USUAL: usize = 3;

/// As POSIX systems on which `twin` runs number it; tokio has no name for it.
const SIGTSTP: i32 = if cfg!(target_os = "macos") { 18 } else { 20 };

/// Number and kinds of the signals that have asked for the end.
#[derive(Clone, Debug)]
pub(in crate::command) struct Interrupt {
    count: Arc<AtomicU32>,
    /// Places among [`KINDS`] of the first that came, and of the last.
    first: Arc<AtomicU8>,
    last: Arc<AtomicU8>,
    /// Which are not minded, bit by bit.
    ignored: u64,
}

/// None has come yet.
const NONE: u8 = u8::MAX;

impl Interrupt {
    /// Handler for commands that run a program. Ctrl-C and SIGTERM stop it whoever has started it; a script that starts
    /// it in the background has Ctrl-C ignored. Under nohup it goes on when the terminal is closed.
    pub(in crate::command) fn catch() -> Result<Self, Failure> {
        Self::catch_but(ignored() & bit(SignalKind::hangup()), USUAL)
    }

    /// Handler for commands that move real drives. It also handles signals that would end or suspend the program and
    /// let the drives go on.
    pub(in crate::command) fn catch_for_drives() -> Result<Self, Failure> {
        Self::catch_but(ignored() & bit(SignalKind::hangup()), KINDS.len())
    }

    /// Handler for servers: signals that were ignored at the start stay ignored.
    pub(in crate::command) fn catch_as_started() -> Result<Self, Failure> {
        Self::catch_but(ignored(), USUAL)
    }

    /// The first `kinds`, but for those that are `ignored`, bit by bit, which stay as they are.
    fn catch_but(ignored: u64, kinds: usize) -> Result<Self, Failure> {
        let none = || Arc::new(AtomicU8::new(NONE));
        let caught =
            Self { count: Arc::new(AtomicU32::new(0)), first: none(), last: none(), ignored };
        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build();
        let runtime = runtime.map_err(Failure::Interrupt)?;
        for (place, (kind, _)) in (0..).zip(KINDS).take(kinds) {
            if ignored & bit(kind) != 0 {
                continue;
            }
            let _inside = runtime.enter();
            // From here on they end nothing by themselves.
            let mut signal = signal(kind).map_err(Failure::Interrupt)?;
            let counter = caught.clone();
            runtime.spawn(async move {
                while signal.recv().await.is_some() {
                    counter.came(place);
                }
            });
        }
        let listen = move || runtime.block_on(std::future::pending::<()>());
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

    /// Name of the first signal, for people.
    pub(in crate::command) fn name(&self) -> &'static str {
        called(&self.first)
    }

    /// Name of the last signal, for people.
    pub(in crate::command) fn latest(&self) -> &'static str {
        called(&self.last)
    }

    /// Name of the signal that ends the run, unless it is Ctrl-C at the keyboard.
    pub(super) fn signal(&self) -> Option<&'static str> {
        Some(self.name()).filter(|name| !name.starts_with("Ctrl"))
    }

    /// Instruction for people on how to end a program that waits for nothing else.
    pub(in crate::command) fn how_it_ends(&self) -> &'static str {
        if self.ignored & bit(SignalKind::interrupt()) == 0 {
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
    KINDS.get(place).map_or("Ctrl-C", |(_, name)| name)
}

/// Where a signal is in a mask of the system: the first one is bit 0.
fn bit(kind: SignalKind) -> u64 {
    1 << (kind.as_raw_value() - 1)
}

/// The signals that the program was started to ignore, bit by bit (the first is bit 0), as the system reports it; none where it
/// does not.
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}
