//! The serial port, shared between the Modbus client that uses it and the driver that may have to take it back.

use std::{
    collections::VecDeque,
    io,
    pin::Pin,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    task::{Context, Poll, ready},
};

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};

use twin_drives::transport::Transport;

/// A transport, and what has been sent on it and is to be heard again.
struct Port<T: ?Sized> {
    /// Bytes whose echo has not come yet; none is kept where there is no echo.
    echo: Option<VecDeque<u8>>,
    /// Bytes that are still missing of the answer awaited, if one is.
    missing: Option<usize>,
    transport: T,
}

impl Port<dyn Transport> {
    fn read(&mut self, cx: &mut Context<'_>, buf: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        let Some(echo) = &mut self.echo else {
            return Pin::new(&mut self.transport).poll_read(cx, buf);
        };
        let mut chunk = [0; 256];
        // Nothing left of what was read would mean the end of the stream: read on until something is.
        loop {
            let room = chunk.len().min(buf.remaining());
            let mut read = ReadBuf::new(chunk.get_mut(..room).unwrap_or_default());
            ready!(Pin::new(&mut self.transport).poll_read(cx, &mut read))?;
            if read.filled().is_empty() {
                return Poll::Ready(Ok(()));
            }
            let left = without_echo(read.filled(), echo);
            if !left.is_empty() {
                buf.put_slice(left);
                return Poll::Ready(Ok(()));
            }
        }
    }
}

/// One of several handles on a transport. Only one of them is used at a time: a client is dropped before the port
/// it leaves behind is cleared and handed to its successor.
#[derive(Clone)]
pub(crate) struct SharedPort(Arc<Mutex<Port<dyn Transport>>>);

impl SharedPort {
    /// With `echo`, every byte sent comes back before the answer and is taken away.
    pub(crate) fn new(transport: impl Transport + 'static, echo: bool) -> Self {
        Self(Arc::new(Mutex::new(Port {
            echo: echo.then(VecDeque::new),
            missing: None,
            transport,
        })))
    }

    fn lock(&self) -> MutexGuard<'_, Port<dyn Transport + 'static>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// No echo is awaited any more.
    pub(crate) fn forget_echo(&self) {
        self.lock().echo.iter_mut().for_each(VecDeque::clear);
    }

    /// An answer of this many bytes is awaited, or none: reading on after as many is an error, [`io::ErrorKind::InvalidData`].
    pub(crate) fn expect(&self, bytes: Option<usize>) {
        self.lock().missing = bytes;
    }
}

/// What is left of bytes without the echo at their head. A byte that is not the one awaited ends the echo: it is
/// garbled, and the check sum of what follows will show it.
fn without_echo<'a>(mut bytes: &'a [u8], echo: &mut VecDeque<u8>) -> &'a [u8] {
    while let (Some(awaited), Some((byte, rest))) = (echo.front(), bytes.split_first()) {
        if awaited != byte {
            echo.clear();
            break;
        }
        echo.pop_front();
        bytes = rest;
    }
    bytes
}

impl AsyncRead for SharedPort {
    fn poll_read(
        self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buf: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let port = &mut *self.lock();
        let before = buf.filled().len();
        let read = port.read(cx, buf);
        match (&read, &mut port.missing) {
            (Poll::Ready(Ok(())), Some(missing)) => {
                *missing = missing.saturating_sub(buf.filled().len() - before);
            }
            // All of it has come, and whoever reads still sees no answer.
            (Poll::Pending, Some(0)) => return Poll::Ready(Err(io::ErrorKind::InvalidData.into())),
            _ => {}
        }
        read
    }
}

impl AsyncWrite for SharedPort {
    fn poll_write(
        self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buf: &[u8],
    ) -> Poll<io::Result<usize>> {
        let port = &mut *self.lock();
        let count = ready!(Pin::new(&mut port.transport).poll_write(cx, buf))?;
        if let Some(echo) = &mut port.echo {
            echo.extend(buf.iter().take(count));
        }
        Poll::Ready(Ok(count))
    }

    fn poll_flush(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.lock().transport).poll_flush(cx)
    }

    fn poll_shutdown(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.lock().transport).poll_shutdown(cx)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_echo_is_taken_away_byte_by_byte() {
        let mut echo = VecDeque::from([1, 2, 3, 4]);
        assert_eq!(without_echo(&[1, 2], &mut echo), []);
        assert_eq!(without_echo(&[3, 4, 9, 8], &mut echo), [9, 8]);
        assert_eq!(without_echo(&[1, 2], &mut echo), [1, 2]);
        // A garbled echo passes.
        let mut echo = VecDeque::from([1, 2, 3]);
        assert_eq!(without_echo(&[1, 7, 3], &mut echo), [7, 3]);
        assert!(echo.is_empty());
    }
}
