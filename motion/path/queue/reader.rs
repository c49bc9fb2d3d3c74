//! Queue file reader (`SMC_ReadNCQueue`).

use super::{
    BLOCK, ContentError, END, Generator, HEADER_BYTES, MAGIC, MAX_BLOCK_BYTES, QueueReadError,
    VERSION, record,
};
use crate::PathElement;
use crc32fast::Hasher;
use std::io::{ErrorKind, Read};
use std::iter::FusedIterator;

/// Reads a queue file (`SMC_ReadNCQueue`, manual 10.2) as an iterator over its path elements.
///
/// Elements are handed out in order, each after the checksum of its block has been found right. An iterator that ends
/// without an error has read the whole queue; after an error nothing follows.
#[doc(alias = "SMC_ReadNCQueue")]
#[derive(Debug)]
pub struct QueueReader<R> {
    reader: R,
    generator: Generator,
    /// Bytes read.
    offset: u64,
    /// The present block's payload and how much of it has been handed out.
    block: Vec<u8>,
    used: usize,
    blocks: u64,
    elements: u64,
    total: Hasher,
    ended: bool,
}

impl<R: Read> QueueReader<R> {
    /// Begins to read; every block is one read or a few.
    ///
    /// # Errors
    /// [`QueueReadError`] if this is not a queue file of this version.
    pub fn new(reader: R) -> Result<Self, QueueReadError> {
        let mut reader = Self {
            reader,
            generator: Generator::Decoder,
            offset: 0,
            block: Vec::new(),
            used: 0,
            blocks: 0,
            elements: 0,
            total: Hasher::new(),
            ended: false,
        };
        let mut header = [0; HEADER_BYTES];
        let read = reader.fill(&mut header);
        // Another file may be shorter than a header.
        let begun = usize::try_from(reader.offset).unwrap_or(HEADER_BYTES);
        if let Some((wrong, _)) =
            (0..).zip(header.iter().zip(MAGIC)).take(begun).find(|(_, (is, should))| *is != should)
        {
            return Err(QueueReadError::NotAQueue(wrong));
        }
        read?;
        let [_, _, _, _, _, _, _, _, low, high, generator, zero, sum @ ..] = header;
        let version = u16::from_le_bytes([low, high]);
        if version != VERSION {
            return Err(QueueReadError::Version { offset: 8, version });
        }
        let [covered @ .., _, _, _, _] = &header;
        if crc32fast::hash(covered) != u32::from_le_bytes(sum) {
            return Err(QueueReadError::Checksum(12));
        }
        let unknown = |offset, field, value| QueueReadError::Content {
            offset,
            error: ContentError::Unknown { field, value },
        };
        reader.generator =
            Generator::from_number(generator).ok_or_else(|| unknown(10, "generator", generator))?;
        if zero != 0 {
            return Err(unknown(11, "zero", zero));
        }
        Ok(reader)
    }

    /// Stage that generated the elements.
    pub fn generator(&self) -> Generator {
        self.generator
    }

    /// Elements handed out so far (`iObjectsRead`).
    pub fn elements(&self) -> u64 {
        self.elements
    }

    fn pull(&mut self) -> Result<Option<PathElement>, QueueReadError> {
        while self.used >= self.block.len() {
            if !self.read_block()? {
                return Ok(None);
            }
        }
        let mut rest = self.block.get(self.used..).unwrap_or_default();
        let element = record::read(&mut rest);
        self.used = self.block.len() - rest.len();
        let element = element.map_err(|error| QueueReadError::Content {
            // Of what has been read, the checksum and the rest of the block lie behind.
            offset: self.offset.saturating_sub(4 + rest.len() as u64),
            error,
        })?;
        self.elements += 1;
        Ok(Some(element))
    }

    /// Reads and verifies the next block; false at the end of the queue.
    fn read_block(&mut self) -> Result<bool, QueueReadError> {
        let at = self.offset;
        let [tag] = self.array()?;
        match tag {
            BLOCK => {}
            END => {
                self.read_end()?;
                return Ok(false);
            }
            tag => return Err(QueueReadError::Tag { offset: at, tag }),
        }
        let length_bytes = self.array()?;
        let length = u32::from_le_bytes(length_bytes);
        let size = usize::try_from(length)
            .ok()
            .filter(|size| (1..=MAX_BLOCK_BYTES).contains(size))
            .ok_or(QueueReadError::BlockLength { offset: at + 1, length })?;
        let mut block = std::mem::take(&mut self.block);
        block.resize(size, 0);
        self.fill(&mut block)?;
        let mut hasher = Hasher::new();
        hasher.update(&self.blocks.to_le_bytes());
        hasher.update(&[tag]);
        hasher.update(&length_bytes);
        hasher.update(&block);
        self.verify(hasher)?;
        self.total.update(&block);
        self.blocks += 1;
        self.block = block;
        self.used = 0;
        Ok(true)
    }

    fn read_end(&mut self) -> Result<(), QueueReadError> {
        let at = self.offset;
        let count: [u8; 8] = self.array()?;
        let total: [u8; 4] = self.array()?;
        let mut hasher = Hasher::new();
        hasher.update(&[END]);
        hasher.update(&count);
        hasher.update(&total);
        self.verify(hasher)?;
        let expected = u64::from_le_bytes(count);
        if expected != self.elements {
            return Err(QueueReadError::Count { offset: at, expected, found: self.elements });
        }
        if u32::from_le_bytes(total) != self.total.clone().finalize() {
            return Err(QueueReadError::Checksum(at + 8));
        }
        let mut more = [0];
        match self.fill(&mut more) {
            Err(QueueReadError::Truncated(_)) => Ok(()),
            Err(error) => Err(error),
            Ok(()) => Err(QueueReadError::Trailing(self.offset - 1)),
        }
    }

    /// Compares with the checksum that comes next.
    fn verify(&mut self, hasher: Hasher) -> Result<(), QueueReadError> {
        let offset = self.offset;
        let sum = u32::from_le_bytes(self.array()?);
        if sum == hasher.finalize() { Ok(()) } else { Err(QueueReadError::Checksum(offset)) }
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], QueueReadError> {
        let mut bytes = [0; N];
        self.fill(&mut bytes)?;
        Ok(bytes)
    }

    fn fill(&mut self, mut bytes: &mut [u8]) -> Result<(), QueueReadError> {
        while !bytes.is_empty() {
            match self.reader.read(bytes) {
                Ok(0) => return Err(QueueReadError::Truncated(self.offset)),
                Ok(read) => {
                    self.offset += read as u64;
                    bytes = std::mem::take(&mut bytes).get_mut(read..).unwrap_or_default();
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(source) => return Err(QueueReadError::Io { offset: self.offset, source }),
            }
        }
        Ok(())
    }
}

impl<R: Read> Iterator for QueueReader<R> {
    type Item = Result<PathElement, QueueReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let item = self.pull().transpose();
        self.ended = !matches!(item, Some(Ok(_)));
        item
    }
}

impl<R: Read> FusedIterator for QueueReader<R> {}
