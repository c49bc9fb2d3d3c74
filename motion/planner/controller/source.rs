//! Source of the interpolator's elements, which may have nothing *yet*.

use std::sync::mpsc::{Receiver, TryRecvError};
use std::task::Poll;

/// A stream that is asked, never waited for: what feeds the interpolator while the path is still being prepared.
///
/// Every iterator is one that always has an answer. For the manual's two tasks (11.7: a slow one decodes and prepares
/// into a queue, a fast one interpolates out of it) there is [`Incoming`].
pub trait Source {
    /// Its items.
    type Item;

    /// The next item: `Ready(None)` is the end of the path (`bEndOfList`), `Pending` that there is nothing *yet*.
    fn poll_next(&mut self) -> Poll<Option<Self::Item>>;
}

impl<I: Iterator> Source for I {
    type Item = I::Item;

    fn poll_next(&mut self) -> Poll<Option<I::Item>> {
        Poll::Ready(self.next())
    }
}

/// Items that another thread sends through a (bounded) channel; the end comes when the sender is dropped.
#[derive(Debug)]
pub struct Incoming<T>(pub Receiver<T>);

impl<T> Source for Incoming<T> {
    type Item = T;

    fn poll_next(&mut self) -> Poll<Option<T>> {
        match self.0.try_recv() {
            Ok(item) => Poll::Ready(Some(item)),
            Err(TryRecvError::Empty) => Poll::Pending,
            Err(TryRecvError::Disconnected) => Poll::Ready(None),
        }
    }
}
