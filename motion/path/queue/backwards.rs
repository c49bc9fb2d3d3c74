//! Reversed path in bounded memory, through a spool file.

use super::{MAX_BLOCK_BYTES, record};
use crate::operations::Modes;
use crate::{Marks, PathElement};
use std::io::{self, Read, Seek, SeekFrom, Write};

/// The whole path backwards (manual 3.3), like [`crate::reversed`], through a file for paths that do not fit in
/// memory. The first element comes when upstream has ended; its errors come at once.
#[derive(Debug)]
pub struct Backwards<I, F> {
    upstream: I,
    /// Elements in their order, with the active sections as marks.
    spool: F,
    /// Lengths of the pieces of the spool, bytes.
    pieces: Vec<u32>,
    bytes: u64,
    /// The piece that is being written, or the rest of the one that was read.
    piece: Vec<u8>,
    modes: Modes,
    elements: Vec<PathElement>,
    next: Option<PathElement>,
    before: Marks,
    turned: bool,
}

impl<I, F> Backwards<I, F> {
    /// The path of `upstream` from its end; `spool` is an empty file of its own.
    pub fn new(upstream: I, spool: F) -> Self {
        Self {
            upstream,
            spool,
            pieces: Vec::new(),
            bytes: 0,
            piece: Vec::new(),
            modes: Modes::default(),
            elements: Vec::new(),
            next: None,
            before: Marks::default(),
            turned: false,
        }
    }
}

impl<I, F: Read + Write + Seek> Backwards<I, F> {
    fn keep(&mut self, mut element: PathElement) -> io::Result<()> {
        element.marks = self.modes.along(element.marks);
        record::write(&mut self.piece, &element);
        if self.piece.len() >= MAX_BLOCK_BYTES { self.write_piece() } else { Ok(()) }
    }

    fn write_piece(&mut self) -> io::Result<()> {
        // One record more than MAX_BLOCK_BYTES at most.
        self.pieces.push(u32::try_from(self.piece.len()).unwrap_or(u32::MAX));
        self.bytes += self.piece.len() as u64;
        self.spool.write_all(&self.piece)?;
        self.piece.clear();
        Ok(())
    }

    /// The next element from the end, as it was kept.
    fn take(&mut self) -> io::Result<Option<PathElement>> {
        while self.elements.is_empty() {
            let Some(length) = self.pieces.pop() else { return Ok(None) };
            self.bytes = self.bytes.saturating_sub(length.into());
            self.spool.seek(SeekFrom::Start(self.bytes))?;
            self.piece.clear();
            Read::take(&mut self.spool, length.into()).read_to_end(&mut self.piece)?;
            let mut rest = self.piece.as_slice();
            while !rest.is_empty() {
                self.elements.push(record::read(&mut rest).map_err(io::Error::other)?);
            }
        }
        Ok(self.elements.pop())
    }

    fn turn(&mut self) -> io::Result<()> {
        self.turned = true;
        self.write_piece()?;
        self.next = self.take()?;
        Ok(())
    }

    fn pass(&mut self) -> io::Result<Option<PathElement>> {
        let Some(element) = self.next.take() else { return Ok(None) };
        self.next = self.take()?;
        let after = self.next.as_ref().map_or_else(Marks::default, |next| next.marks);
        let before = std::mem::replace(&mut self.before, element.marks);
        Ok(Some(element.backwards(before, element.marks, after)))
    }
}

impl<I, F, E> Iterator for Backwards<I, F>
where
    I: Iterator<Item = Result<PathElement, E>>,
    F: Read + Write + Seek,
    E: From<io::Error>,
{
    type Item = Result<PathElement, E>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.turned {
            let done = match self.upstream.next() {
                Some(Ok(element)) => self.keep(element),
                Some(error) => return Some(error),
                None => self.turn(),
            };
            if let Err(error) = done {
                // What cannot be kept cannot be given back.
                self.turned = true;
                (self.next, self.elements, self.pieces) = (None, Vec::new(), Vec::new());
                return Some(Err(error.into()));
            }
        }
        match self.pass() {
            Ok(element) => element.map(Ok),
            Err(error) => {
                (self.next, self.elements, self.pieces) = (None, Vec::new(), Vec::new());
                Some(Err(error.into()))
            }
        }
    }
}
