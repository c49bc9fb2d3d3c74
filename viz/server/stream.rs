//! Streaming of a file while it grows.

use std::fs::File;
use std::io::{Error, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use futures_util::Stream;
use futures_util::stream::unfold;
use tokio::sync::{OwnedSemaphorePermit, watch};

/// Poll interval of a file that has not grown.
const POLL: Duration = Duration::from_millis(50);
/// Bytes sent at once.
const CHUNK: usize = 64 * 1024;

/// A file and its reader.
struct Growing {
    file: File,
    complete: Arc<AtomicBool>,
    stop: watch::Receiver<bool>,
    _reader: OwnedSemaphorePermit,
}

impl Growing {
    /// What has been added; none if nothing more comes, or on `stop`.
    async fn next(&mut self) -> Result<Option<Vec<u8>>, Error> {
        let mut bytes = vec![0; CHUNK];
        while !*self.stop.borrow() {
            // Asked before reading: what was written before it was set is then seen by the read.
            let was_complete = self.complete.load(Ordering::Acquire);
            let count = self.file.read(&mut bytes)?;
            if count > 0 {
                bytes.truncate(count);
                return Ok(Some(bytes));
            }
            if was_complete {
                break;
            }
            // Either the time is over, or the server ends.
            drop(tokio::time::timeout(POLL, self.stop.changed()).await);
        }
        Ok(None)
    }
}

/// The file, from its beginning to its end and on as it grows, until it is `complete`, or `stop`.
pub(super) fn growing(
    file: File,
    complete: Arc<AtomicBool>,
    stop: watch::Receiver<bool>,
    reader: OwnedSemaphorePermit,
) -> impl Stream<Item = Result<Vec<u8>, Error>> {
    let growing = Growing { file, complete, stop, _reader: reader };
    unfold(growing, async |mut growing| {
        let next = growing.next().await.transpose()?;
        Some((next, growing))
    })
}
