//! Streaming of a file while it grows.

use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use tiny_http::Request;

/// Poll interval of a file that has not grown.
const POLL: Duration = Duration::from_millis(50);
/// Bytes sent at once.
const CHUNK: usize = 64 * 1024;

/// Answers with the file, from its beginning to its end and on as it grows, until it is complete or `stop` is set.
///
/// The answer is in chunks (RFC 9112, section 7.1), each sent when there is something to send: `tiny_http` would hold
/// back the last 8 KiB.
pub(super) fn send(
    request: Request,
    path: &Path,
    complete: &AtomicBool,
    stop: &AtomicBool,
) -> std::io::Result<()> {
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) => {
            super::refuse(request, 404);
            return Err(error);
        }
    };
    let mut out = request.into_writer();
    out.write_all(
        b"HTTP/1.1 200 OK\r\nContent-Type: application/octet-stream\r\nCache-Control: no-store\r\n\
          Transfer-Encoding: chunked\r\n\r\n",
    )?;
    out.flush()?;
    copy_growing(file, &mut out, complete, stop)
}

fn copy_growing(
    mut file: impl Read,
    out: &mut impl Write,
    complete: &AtomicBool,
    stop: &AtomicBool,
) -> std::io::Result<()> {
    let mut buffer = vec![0; CHUNK];
    while !stop.load(Ordering::Acquire) {
        // Asked before reading: what was written before it was set is then seen by the read.
        let was_complete = complete.load(Ordering::Acquire);
        let count = file.read(&mut buffer)?;
        match buffer.get(..count) {
            Some(bytes) if !bytes.is_empty() => {
                write!(out, "{count:x}\r\n")?;
                out.write_all(bytes)?;
                out.write_all(b"\r\n")?;
                out.flush()?;
            }
            _ if was_complete => break,
            _ => std::thread::sleep(POLL),
        }
    }
    out.write_all(b"0\r\n\r\n")?;
    out.flush()
}
