//! Outputs that a thread of their own writes: a file that is full, slow or gone never holds up its writer.
//!
//! Items wait in a queue of at most `CAPACITY` bytes. An output ends early when it fails, or when it takes data too
//! slowly for the queue; the items before that are written, all later ones are counted as lost.

use std::io;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The queue holds at most this, bytes, or one item that is larger.
const CAPACITY: usize = 16 << 20;
/// Number of items that it holds at most.
const ITEMS: usize = 1 << 14;
/// How long [`Background::open`] waits for an output that does not open, such as a pipe that nobody reads.
const OPENING: Duration = Duration::from_millis(250);

/// Destination of items, called on the thread of the output.
pub trait Sink<T>: Sized {
    /// Writes an item.
    ///
    /// # Errors
    /// If it cannot be written; nothing is written after that.
    fn write(&mut self, item: T) -> io::Result<()>;

    /// Completes the output after the last item.
    ///
    /// # Errors
    /// If that is not possible.
    fn finish(self) -> io::Result<()>;

    /// Closes an output that has failed; keeps the items before.
    fn cut(self) {}
}

/// A part of an output.
#[derive(Debug, Default)]
pub struct Item<T> {
    /// Time of the program that it is about, ns.
    pub time_ns: i64,
    /// Line of the program that it is about.
    pub line: u32,
    /// Size in memory, bytes.
    pub bytes: usize,
    /// Number of records in it.
    pub records: u64,
    /// What is written.
    pub data: T,
}

/// Early end of an output.
#[derive(Debug)]
pub struct Ended {
    /// Time of the first item that is not in the output, ns; of the last one if only the end is missing.
    pub time_ns: i64,
    /// Line of that item.
    pub line: u32,
    /// The cause.
    pub cause: io::Error,
    /// Number of records that are not in the output.
    pub lost: u64,
}

/// An output with its queue and thread.
///
/// ```
/// use std::io::{Result, Write};
/// use std::time::Duration;
/// use twin_viz::{Background, Item, Sink};
///
/// /// A device on which nothing can be written.
/// struct Full(std::fs::File);
///
/// impl Sink<&'static str> for Full {
///     fn write(&mut self, text: &'static str) -> Result<()> {
///         self.0.write_all(text.as_bytes())
///     }
///
///     fn finish(self) -> Result<()> {
///         Ok(())
///     }
/// }
///
/// # fn main() -> Result<()> {
/// let mut log = Background::open("log", || Ok(Full(std::fs::File::create("/dev/full")?)))?;
/// for time_ns in [0, 1_000_000] {
///     log.send(Item { time_ns, line: 1, bytes: 8, records: 1, data: "X 0.000\n" }, Duration::ZERO);
/// }
/// let ended = log.finish(Duration::from_secs(10)).unwrap_err();
/// assert_eq!((ended.time_ns, ended.lost), (0, 2));
/// assert_eq!(ended.cause.kind(), std::io::ErrorKind::StorageFull);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Background<T> {
    queue: Option<SyncSender<Item<T>>>,
    shared: Arc<Shared>,
    /// Number of records that were to be written.
    records: u64,
    /// Time and line of the first item that the queue had no room for.
    refused: Option<(i64, u32)>,
}

#[derive(Debug, Default)]
struct Shared {
    progress: Mutex<Progress>,
    changed: Condvar,
}

/// Progress of the thread.
#[derive(Debug, Default)]
struct Progress {
    is_open: bool,
    /// Size of what is not written yet.
    waiting: usize,
    /// Time and line of the next item to be written, or of the last one.
    at: (i64, u32),
    /// Number of records that are written.
    written: u64,
    /// How the thread has ended.
    done: Option<io::Result<()>>,
}

impl<T: Send + 'static> Background<T> {
    /// Opens an output on a thread called `name`.
    ///
    /// # Errors
    /// If it cannot be opened, and that is known within a quarter of a second; otherwise it ends early.
    pub fn open<S: Sink<T>>(
        name: &str,
        open: impl FnOnce() -> io::Result<S> + Send + 'static,
    ) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let (queue, items) = sync_channel(ITEMS);
        let on_thread = shared.clone();
        let run = move || on_thread.run(open, &items);
        std::thread::Builder::new().name(name.to_owned()).spawn(run)?;
        let is_opening = |progress: &Progress| !progress.is_open && progress.done.is_none();
        if let Some(Err(cause)) = shared.wait(OPENING, is_opening).done.take() {
            return Err(cause);
        }
        Ok(Self { queue: Some(queue), shared, records: 0, refused: None })
    }
}

impl<T> Background<T> {
    /// Passes on an item. If the queue is full, it waits for room, `patience` at most; then the output ends.
    pub fn send(&mut self, item: Item<T>, patience: Duration) {
        let (at, bytes) = ((item.time_ns, item.line), item.bytes);
        let is_full =
            |progress: &Progress| progress.waiting > 0 && progress.waiting + bytes > CAPACITY;
        self.records += item.records;
        if let Some(queue) = self.queue.as_ref().filter(|_| self.refused.is_none()) {
            let mut progress = self.shared.wait(patience, |it| it.done.is_none() && is_full(it));
            if !is_full(&progress) && queue.try_send(item).is_ok() {
                if progress.waiting == 0 {
                    progress.at = at;
                }
                progress.waiting += bytes;
                return;
            }
        }
        self.refused.get_or_insert(at);
    }

    /// Declares that nothing more comes.
    pub fn close(&mut self) {
        self.queue = None;
    }

    /// Completes the output, which may take `patience`.
    ///
    /// # Errors
    /// If it has ended before its time.
    pub fn finish(&mut self, patience: Duration) -> Result<(), Ended> {
        self.close();
        let mut progress = self.shared.wait(patience, |progress| progress.done.is_none());
        let slow = || io::Error::new(io::ErrorKind::TimedOut, "too slow, or nobody reads it");
        let ((time_ns, line), cause) = match (progress.done.take(), self.refused) {
            (Some(Err(cause)), _) => (progress.at, cause),
            (None, _) => (progress.at, slow()),
            (Some(Ok(())), Some(refused)) => (refused, slow()),
            (Some(Ok(())), None) => return Ok(()),
        };
        Err(Ended { time_ns, line, cause, lost: self.records - progress.written })
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Progress> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits while something is so, `patience` at most.
    fn wait(
        &self,
        patience: Duration,
        is_so: impl Fn(&Progress) -> bool,
    ) -> MutexGuard<'_, Progress> {
        let waited = self.changed.wait_timeout_while(self.lock(), patience, |it| is_so(it));
        waited.unwrap_or_else(PoisonError::into_inner).0
    }

    fn change(&self, change: impl FnOnce(&mut Progress)) {
        change(&mut self.lock());
        self.changed.notify_all();
    }

    /// Writes all that comes.
    fn run<T, S: Sink<T>>(&self, open: impl FnOnce() -> io::Result<S>, items: &Receiver<Item<T>>) {
        let written = open().and_then(|mut sink| {
            self.change(|progress| progress.is_open = true);
            for Item { time_ns, line, bytes, records, data } in items {
                self.change(|progress| progress.at = (time_ns, line));
                if let Err(error) = sink.write(data) {
                    sink.cut();
                    return Err(error);
                }
                self.change(|progress| {
                    progress.waiting = progress.waiting.saturating_sub(bytes);
                    progress.written += records;
                });
            }
            sink.finish()
        });
        self.change(|progress| progress.done = Some(written));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LONG: Duration = Duration::from_mins(1);

    /// Takes an item for each word; fails at item `fails`.
    struct Slow {
        words: Receiver<()>,
        fails: u32,
        written: Arc<Mutex<Vec<u32>>>,
    }

    impl Sink<u32> for Slow {
        fn write(&mut self, item: u32) -> io::Result<()> {
            self.words.recv().ok();
            if item == self.fails {
                return Err(io::Error::from(io::ErrorKind::StorageFull));
            }
            self.written.lock().unwrap().push(item);
            Ok(())
        }

        fn finish(self) -> io::Result<()> {
            Ok(())
        }
    }

    fn item(data: u32, bytes: usize) -> Item<u32> {
        Item { time_ns: i64::from(data) * 10, line: data, bytes, records: 2, data }
    }

    #[test]
    fn items_after_the_one_that_fails_are_lost_and_counted() {
        let (word, words) = sync_channel(9);
        let written = Arc::new(Mutex::new(Vec::new()));
        let slow = Slow { words, fails: 3, written: written.clone() };
        let mut output = Background::open("test", || Ok(slow)).unwrap();
        (1..=5).for_each(|data| output.send(item(data, 1), Duration::ZERO));
        (1..=3).for_each(|_| word.send(()).unwrap());
        let ended = output.finish(LONG).unwrap_err();
        assert_eq!(ended.cause.kind(), io::ErrorKind::StorageFull);
        assert_eq!((ended.time_ns, ended.line, ended.lost), (30, 3, 6));
        assert_eq!(*written.lock().unwrap(), [1, 2]);
    }

    #[test]
    fn an_output_that_takes_nothing_holds_nobody_up() {
        let (word, words) = sync_channel(0);
        let written = Arc::new(Mutex::new(Vec::new()));
        let slow = Slow { words, fails: 9, written: written.clone() };
        let mut output = Background::open("test", || Ok(slow)).unwrap();
        (1..=2).for_each(|data| output.send(item(data, CAPACITY / 2), LONG));
        output.send(item(3, 1), Duration::ZERO);
        output.send(item(4, 1), LONG);
        let ended = output.finish(Duration::ZERO).unwrap_err();
        assert_eq!(ended.cause.kind(), io::ErrorKind::TimedOut);
        assert_eq!((ended.time_ns, ended.line, ended.lost), (10, 1, 8));
        drop(word);
    }

    #[test]
    fn an_output_that_catches_up_is_whole() {
        let (word, words) = sync_channel(9);
        let written = Arc::new(Mutex::new(Vec::new()));
        let slow = Slow { words, fails: 9, written: written.clone() };
        let mut output = Background::open("test", || Ok(slow)).unwrap();
        (0..3).for_each(|_| word.send(()).unwrap());
        (1..=3).for_each(|data| output.send(item(data, CAPACITY), LONG));
        output.finish(LONG).unwrap();
        assert_eq!(*written.lock().unwrap(), [1, 2, 3]);
    }

    #[test]
    fn an_output_that_cannot_be_opened_is_an_error_at_once() {
        let refused = || Err::<Slow, _>(io::Error::from(io::ErrorKind::ReadOnlyFilesystem));
        let error = Background::open("test", refused).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::ReadOnlyFilesystem);
    }

    #[test]
    fn an_output_that_does_not_open_ends_with_the_run() {
        let (word, words) = sync_channel::<()>(0);
        let never = move || {
            words.recv().ok();
            Err::<Slow, _>(io::Error::from(io::ErrorKind::Interrupted))
        };
        let mut output = Background::open("test", never).unwrap();
        output.send(item(1, 1), Duration::ZERO);
        let ended = output.finish(Duration::ZERO).unwrap_err();
        assert_eq!((ended.time_ns, ended.lost), (10, 2));
        drop(word);
    }
}
