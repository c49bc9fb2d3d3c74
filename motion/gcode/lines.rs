//! Bounded reading: lines of a program, and files that are kept whole.

use std::io::{self, BufRead, Read};

/// Reads a line and its end, at most `limit` + 1 bytes of it into `line`, and skips the rest. Its length in the file;
/// none at the end.
pub(crate) fn read_line(
    reader: &mut impl BufRead,
    limit: usize,
    line: &mut Vec<u8>,
) -> io::Result<Option<u64>> {
    line.clear();
    let mut length = reader.by_ref().take(limit as u64 + 1).read_until(b'\n', line)?;
    if line.len() > limit && line.last() != Some(&b'\n') {
        length = length.saturating_add(reader.skip_until(b'\n')?);
    }
    Ok((length > 0).then_some(length as u64))
}

/// Reads a file, at most `limit` + 1 bytes of it.
pub(crate) fn read_file(reader: impl Read, limit: u64) -> io::Result<Vec<u8>> {
    let mut text = Vec::new();
    reader.take(limit + 1).read_to_end(&mut text)?;
    Ok(text)
}

/// The lines of `text`, their ends included.
pub(crate) fn lines(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split_inclusive(|byte| *byte == b'\n')
}
