//! Queue file writer.

use super::{BLOCK, END, Generator, MAGIC, MAX_BLOCK_BYTES, QueueWriteError, VERSION, record};
use crate::PathElement;
use crc32fast::Hasher;
use std::io::{self, Write};

/// Writes path elements to a queue file. Only [`Self::finish`] makes it a whole one: a file that is left without is
/// found to be truncated.
#[derive(Debug)]
pub struct QueueWriter<W> {
    out: W,
    block: Vec<u8>,
    element: Vec<u8>,
    blocks: u64,
    elements: u64,
    total: Hasher,
}

impl<W: Write> QueueWriter<W> {
    /// Begins a queue of elements from `generator`. Every block is one write.
    ///
    /// # Errors
    /// What `out` says.
    pub fn new(mut out: W, generator: Generator) -> io::Result<Self> {
        let mut header = MAGIC.to_vec();
        header.extend(VERSION.to_le_bytes());
        header.extend([generator.number(), 0]);
        seal(&mut header, Hasher::new());
        out.write_all(&header)?;
        Ok(Self {
            out,
            block: Vec::new(),
            element: Vec::new(),
            blocks: 0,
            elements: 0,
            total: Hasher::new(),
        })
    }

    /// Appends an element (`SMC_APPENDOBJ`).
    ///
    /// # Errors
    /// [`QueueWriteError::Content`] if the element has numbers that cannot be read again, which leaves the queue as it
    /// is; or what the file says, after which it is not whole any more.
    pub fn write(&mut self, element: &PathElement) -> Result<(), QueueWriteError> {
        self.element.clear();
        record::write(&mut self.element, element);
        record::read(&mut self.element.as_slice())
            .map_err(|error| QueueWriteError::Content { place: element.place, error })?;
        if self.block.len() + self.element.len() > MAX_BLOCK_BYTES {
            self.write_block()?;
        }
        self.block.append(&mut self.element);
        self.elements += 1;
        Ok(())
    }

    /// Elements written so far.
    pub fn elements(&self) -> u64 {
        self.elements
    }

    /// Writes the remaining elements and the end record, and returns the writer.
    ///
    /// # Errors
    /// What it says.
    pub fn finish(mut self) -> io::Result<W> {
        self.write_block()?;
        let mut end = vec![END];
        end.extend(self.elements.to_le_bytes());
        end.extend(self.total.finalize().to_le_bytes());
        seal(&mut end, Hasher::new());
        self.out.write_all(&end)?;
        self.out.flush()?;
        Ok(self.out)
    }

    fn write_block(&mut self) -> io::Result<()> {
        if self.block.is_empty() {
            return Ok(());
        }
        self.total.update(&self.block);
        let mut bytes = Vec::with_capacity(self.block.len() + 9);
        bytes.push(BLOCK);
        // At most MAX_BLOCK_BYTES.
        bytes.extend(u32::try_from(self.block.len()).unwrap_or(u32::MAX).to_le_bytes());
        bytes.append(&mut self.block);
        let mut hasher = Hasher::new();
        hasher.update(&self.blocks.to_le_bytes());
        seal(&mut bytes, hasher);
        self.blocks += 1;
        self.out.write_all(&bytes)
    }
}

/// Appends the checksum of `bytes`, begun with what `hasher` has seen.
fn seal(bytes: &mut Vec<u8>, mut hasher: Hasher) {
    hasher.update(bytes);
    bytes.extend(hasher.finalize().to_le_bytes());
}
