//! Processor load for benchmarks: two busy threads per core.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{Builder, JoinHandle, available_parallelism};

/// Threads that reckon for nothing until this is dropped.
pub(crate) struct Load {
    end: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Load {
    /// Two for every core, at the priority of whoever starts them.
    pub(crate) fn start() -> Self {
        let end = Arc::new(AtomicBool::new(false));
        let cores = available_parallelism().map_or(1, std::num::NonZero::get);
        let threads = (0..2 * cores).map(|_| {
            let end = Arc::clone(&end);
            let reckon = move || {
                while !end.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            };
            Builder::new().name("load".to_owned()).spawn(reckon).expect("a thread")
        });
        Self { threads: threads.collect(), end }
    }
}

impl Drop for Load {
    fn drop(&mut self) {
        self.end.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            thread.join().expect("a thread that only reckons");
        }
    }
}
