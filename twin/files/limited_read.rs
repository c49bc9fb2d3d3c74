//! Limited reading: whole files up to a maximum size, and lines of streams up to a maximum length.

use crate::text::Text;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Most bytes of a table: more than a cam of as many points as there may be, with every digit.
const MOST_TABLE: u64 = 256 << 20;
/// Most bytes of a TOML or XML file. It is read as a whole and needs many times its size in memory.
const MOST_TEXT: u64 = 16 << 20;
/// Most bytes of a line of a stream.
pub const MOST_LINE: usize = 1 << 16;

/// Reads the bytes of a table in text; lone CRs become LFs.
///
/// # Errors
/// If it cannot be read, is in UTF-16, or has more than 256 MiB ([`io::ErrorKind::FileTooLarge`]).
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    all_of(Text::of(open(path, MOST_TABLE)?)?, MOST_TABLE)
}

/// Reads the text of a whole file in TOML or XML.
///
/// # Errors
/// As [`read`], with more than 16 MiB, and if it is not UTF-8.
pub fn read_to_string(path: &Path) -> io::Result<String> {
    as_text(all_of(Text::of(open(path, MOST_TEXT)?)?, MOST_TEXT)?)
}

/// Reads a file of at most `most` bytes, as they are.
///
/// # Errors
/// If it cannot be read, or has more bytes ([`io::ErrorKind::FileTooLarge`]).
pub fn read_binary(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    all_of(open(path, most)?, most)
}

/// Reads a stream to its end, which comes after at most `most` bytes.
///
/// # Errors
/// If it cannot be read, or has more bytes ([`io::ErrorKind::FileTooLarge`]).
pub fn all_of(stream: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    stream.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(too_long(format_args!(
            "it has more than {most} bytes, the most that are read"
        )));
    }
    Ok(bytes)
}

/// The text that `bytes` are.
///
/// # Errors
/// [`io::ErrorKind::InvalidData`] if they are not UTF-8.
pub fn as_text(bytes: Vec<u8>) -> io::Result<String> {
    String::from_utf8(bytes)
        .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error.utf8_error()))
}

/// Opens a file; one that says that it is too long is not read at all.
fn open(path: &Path, most: u64) -> io::Result<File> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    if length > most {
        return Err(too_long(format_args!("it has {length} bytes, and at most {most} are read")));
    }
    Ok(file)
}

fn too_long(what: std::fmt::Arguments<'_>) -> io::Error {
    let message = format!("{what}; check that it is the right one, or shorten it");
    io::Error::new(io::ErrorKind::FileTooLarge, message)
}

/// Stream of lines that may go on for ever, of which each has at most [`MOST_LINE`] bytes: reading on in a longer one fails
/// with [`io::ErrorKind::FileTooLarge`]. Lines end with LF or CR.
#[derive(Debug)]
pub struct LimitedLines<R> {
    inner: R,
    /// Number of the line that is being read, from 1, and its bytes so far.
    line: u64,
    length: usize,
    /// The last byte was a CR, with which an LF is one end.
    after_cr: bool,
}

impl<R> LimitedLines<R> {
    /// The lines of `inner`.
    pub fn new(inner: R) -> Self {
        Self { inner, line: 1, length: 0, after_cr: false }
    }
}

impl<R: Read> Read for LimitedLines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.length > MOST_LINE {
            let line = self.line;
            return Err(too_long(format_args!(
                "line {line} has more than {MOST_LINE} bytes, the most that are read"
            )));
        }
        let count = self.inner.read(buffer)?;
        for byte in buffer.iter().take(count) {
            match byte {
                b'\n' if self.after_cr => {}
                b'\n' | b'\r' => (self.line, self.length) = (self.line + 1, 0),
                _ => self.length += 1,
            }
            self.after_cr = *byte == b'\r';
            if self.length > MOST_LINE {
                break;
            }
        }
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::{LimitedLines, MOST_LINE, MOST_TABLE, all_of, read_binary};
    use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
    use std::path::Path;

    #[test]
    fn no_more_than_there_may_be() {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(b"12345").unwrap();
        assert_eq!(read_binary(file.path(), 5).unwrap(), b"12345");
        let error = read_binary(file.path(), 4).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::FileTooLarge);
        let said =
            "it has 5 bytes, and at most 4 are read; check that it is the right one, or shorten it";
        assert_eq!(error.to_string(), said);
        // A file with a hole, of which nothing need be read.
        file.seek(SeekFrom::Start(MOST_TABLE)).unwrap();
        file.write_all(b"6").unwrap();
        assert_eq!(super::read(file.path()).unwrap_err().kind(), ErrorKind::FileTooLarge);
    }

    #[test]
    fn texts_of_other_systems() {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(b"a = 1\rb = 2").unwrap();
        assert_eq!(super::read_to_string(file.path()).unwrap(), "a = 1\nb = 2");
        file.write_all(b"\xff").unwrap();
        assert_eq!(super::read_to_string(file.path()).unwrap_err().kind(), ErrorKind::InvalidData);
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(b"\xfe\xff\0a").unwrap();
        let error = super::read_to_string(file.path()).unwrap_err();
        assert_eq!(error.to_string(), "this is text in UTF-16 (big-endian); save it as UTF-8");
    }

    /// A device says that it has no bytes, and has no end.
    #[cfg(unix)]
    #[test]
    fn what_has_no_end_ends() {
        let error = read_binary(Path::new("/dev/zero"), 1000).unwrap_err();
        let said = "it has more than 1000 bytes, the most that are read; \
                    check that it is the right one, or shorten it";
        assert_eq!(error.to_string(), said);
    }

    #[test]
    fn lines_end_in_time_and_streams_need_not() {
        let longest = vec![b'x'; MOST_LINE];
        let line = [&longest[..], b"\r\n"].concat();
        let lines = [&line[..], &line[..], &longest[..]].concat();
        assert_eq!(all_of(LimitedLines::new(&lines[..]), 1 << 20).unwrap(), lines);
        let lines = [&line[..], b"1\n\n", &longest[..], b"x", &line[..]].concat();
        let mut begun = Vec::new();
        let error = LimitedLines::new(&lines[..]).read_to_end(&mut begun).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::FileTooLarge);
        assert!(error.to_string().starts_with("line 4 has more than 65536 bytes, the most"));
        assert!(begun.starts_with(&line));
    }
}
