//! Text files: encoding and line ends, recognised at the beginning of the text.
//!
//! All text files go through here. Text is UTF-8 or an 8-bit code page; UTF-16 and UTF-32 are refused by name, and as
//! programs binary files.
//! Lines end with LF or CR LF; lone CRs are read as LF, so that places in the file stay the same.

use std::fs::File;
use std::io::{self, BufRead, Read, Seek, SeekFrom};
use std::path::Path;

/// Bytes that are looked at.
const HEAD: usize = 1 << 16;

/// Byte pairs of which every second byte is 0 in UTF-16 without a byte order mark.
const PAIRS: usize = 32;

/// Of text at most one byte in this number is a control character.
const MOST_CONTROLS: usize = 16;

/// Name of the encoding of the text that begins with `head`, if twin does not read it.
pub fn foreign_encoding(head: &[u8]) -> Option<&'static str> {
    match head {
        [0xff, 0xfe, 0, 0, ..] => Some("UTF-32 (little-endian)"),
        [0, 0, 0xfe, 0xff, ..] => Some("UTF-32 (big-endian)"),
        [0xff, 0xfe, ..] => Some("UTF-16 (little-endian)"),
        [0xfe, 0xff, ..] => Some("UTF-16 (big-endian)"),
        _ => {
            let (pairs, _) = head.as_chunks::<2>();
            let pairs = pairs.get(..PAIRS.min(pairs.len())).unwrap_or_default();
            let all = |is: fn(&[u8; 2]) -> bool| pairs.len() >= 2 && pairs.iter().all(is);
            if all(|[first, second]| *first != 0 && *second == 0) {
                Some("UTF-16 (little-endian)")
            } else if all(|[first, second]| *first == 0 && *second != 0) {
                Some("UTF-16 (big-endian)")
            } else {
                None
            }
        }
    }
}

/// Refuses data that begin with `head` and have many control characters. Single ones are for those who read the text, as
/// the 0 at the end of a program from a control.
fn check_binary(head: &[u8]) -> io::Result<()> {
    let end = head.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    let head = head.get(..end).unwrap_or_default();
    // Without the blanks, the ends of lines and files, and ESC, 27, of tapes.
    let is_control = |byte: &u8| matches!(byte, 0..=8 | 14..=25 | 28..=31 | 127);
    let count = head.iter().filter(|byte| is_control(byte)).count();
    let is_binary = count > 1 && count > head.len() / MOST_CONTROLS;
    let first = head.iter().enumerate().find(|(_, byte)| is_control(byte));
    let Some((at, byte)) = first.filter(|_| is_binary) else { return Ok(()) };
    let before = head.get(..at).unwrap_or_default();
    let lines = (1_usize..).zip(before.split(|byte| *byte == b'\n'));
    let (line, begun) = lines.last().unwrap_or((1, before));
    let column = begun.len() + 1;
    let message =
        format!("this is not a text program: byte {byte:#04x} at line {line}, column {column}");
    Err(io::Error::new(io::ErrorKind::InvalidData, message))
}

/// True if lines of the text that begins with `head` end with CR alone.
fn ends_lines_with_cr(head: &[u8]) -> bool {
    !head.contains(&b'\n') && head.windows(2).any(|pair| pair.first() == Some(&b'\r'))
}

/// Reader of text; a reader for binary data passes every byte as it is ([`Text::binary`]).
#[derive(Debug)]
pub struct Text<R> {
    inner: R,
    /// Bytes that were looked at and cannot be read again, from `at` on.
    head: Vec<u8>,
    at: usize,
    /// CR is read as LF.
    cr_is_lf: bool,
}

impl Text<File> {
    /// Opens the text file `path`.
    ///
    /// # Errors
    /// If it cannot be read, or is not text in UTF-8 or a code page.
    pub fn open(path: &Path) -> io::Result<Self> {
        Self::of(File::open(path)?)
    }

    /// The text of an open file, from its beginning.
    ///
    /// # Errors
    /// If it cannot be read, or is not text in UTF-8 or a code page.
    pub fn of(file: File) -> io::Result<Self> {
        let mut text = Self::new(file)?;
        text.rewind();
        Ok(text)
    }

    /// As [`Self::of`], for a program.
    ///
    /// # Errors
    /// Those of [`Self::of`], and with the place of the first control character if the file is binary.
    pub fn of_program(file: File) -> io::Result<Self> {
        let mut text = Self::new(file)?;
        check_binary(&text.head)?;
        text.rewind();
        Ok(text)
    }

    /// Goes back to the beginning, if the file can.
    fn rewind(&mut self) {
        if self.inner.rewind().is_ok() {
            self.head.clear();
        }
    }
}

impl<R> Text<R> {
    /// Bytes as they are.
    pub fn binary(inner: R) -> Self {
        Self { inner, head: Vec::new(), at: 0, cr_is_lf: false }
    }

    /// The file or stream.
    pub fn inner(&self) -> &R {
        &self.inner
    }
}

impl<R: Read> Text<R> {
    /// The text of a stream.
    ///
    /// # Errors
    /// If it cannot be read, or is not text in UTF-8 or a code page.
    pub fn new(mut inner: R) -> io::Result<Self> {
        let mut head = vec![0; HEAD];
        let mut length = 0;
        // A stream may give few bytes at a time; four decide on the mark.
        while length < 4 {
            match inner.read(head.get_mut(length..).unwrap_or_default()) {
                Ok(0) => break,
                Ok(count) => length += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        head.truncate(length);
        if let Some(encoding) = foreign_encoding(&head) {
            let message = format!("this is text in {encoding}; save it as UTF-8");
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        let cr_is_lf = ends_lines_with_cr(&head);
        Ok(Self { inner, head, at: 0, cr_is_lf })
    }
}

impl<R: Read> Read for Text<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut rest = self.head.get(self.at..).unwrap_or_default();
        let count = if rest.is_empty() {
            self.inner.read(buffer)?
        } else {
            let count = rest.read(buffer)?;
            self.at += count;
            count
        };
        if self.cr_is_lf {
            let read = buffer.get_mut(..count).unwrap_or_default();
            read.iter_mut().filter(|byte| **byte == b'\r').for_each(|byte| *byte = b'\n');
        }
        Ok(count)
    }
}

impl<R: Seek> Seek for Text<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let place = self.inner.seek(to)?;
        self.head.clear();
        Ok(place)
    }
}

/// Reader of the lines of the text file `path`.
///
/// # Errors
/// If it cannot be read, or is not text in UTF-8 or a code page.
pub fn lines_of(path: &Path) -> io::Result<impl BufRead + Seek + use<>> {
    Ok(io::BufReader::with_capacity(HEAD, Text::open(path)?))
}

#[cfg(test)]
mod tests {
    use super::{Text, check_binary, foreign_encoding, lines_of};
    use std::io::{BufRead, ErrorKind, Read, Seek, SeekFrom, Write};

    /// `text` in UTF-16, as the Unicode standard (3.10, D96 to D98) has it.
    fn utf_16(text: &str, mark: bool, big: bool) -> Vec<u8> {
        let mark = mark.then_some(0xfeff);
        let units = mark.into_iter().chain(text.encode_utf16());
        units.flat_map(|unit| if big { unit.to_be_bytes() } else { unit.to_le_bytes() }).collect()
    }

    #[test]
    fn encodings_by_name() {
        for text in ["%\nN10 G1 X10 F10\n", "name = \"gantry\"\n", "0;0\r\n1;2\r\n"] {
            for mark in [true, false] {
                let little = utf_16(text, mark, false);
                let big = utf_16(text, mark, true);
                assert_eq!(foreign_encoding(&little), Some("UTF-16 (little-endian)"));
                assert_eq!(foreign_encoding(&big), Some("UTF-16 (big-endian)"));
            }
            assert_eq!(foreign_encoding(text.as_bytes()), None);
            assert_eq!(foreign_encoding(format!("\u{feff}{text}").as_bytes()), None);
        }
        assert_eq!(foreign_encoding(b"\xff\xfe\0\0%\0\0\0"), Some("UTF-32 (little-endian)"));
        assert_eq!(foreign_encoding(b"\0\0\xfe\xff\0\0\0%"), Some("UTF-32 (big-endian)"));
        // Latin-1, one byte that is 0, and next to nothing.
        for text in [&b"(caf\xe9)\n"[..], b"G1 X1\0 Y2\n", b"%\0", b"%", b""] {
            assert_eq!(foreign_encoding(text), None);
        }
        let error = Text::new(&utf_16("%\n", true, false)[..]).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidData);
        assert_eq!(error.to_string(), "this is text in UTF-16 (little-endian); save it as UTF-8");
    }

    /// The first bytes of files of other programs, and their first control character.
    #[test]
    fn binary_data() {
        for (data, place) in [
            (&b"MZ\x90\0\x03\0"[..], "byte 0x00 at line 1, column 4"),
            (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "byte 0x00 at line 3, column 1"),
            (b"PK\x03\x04\x14\0\x08", "byte 0x03 at line 1, column 3"),
            (b"\x91\x02\xf3\xaa\x17\xee\x9c\x05\xd1", "byte 0x02 at line 1, column 2"),
        ] {
            let error = check_binary(data).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::InvalidData);
            assert_eq!(error.to_string(), format!("this is not a text program: {place}"));
        }
        // Comments in a code page, the end of a file of MS-DOS and of some controls, and characters of a tape reader.
        for text in [
            &b"(\xc4nderung f\xfcr Fr\xe4ser)\n"[..],
            b"%\nM30\n%\n\x1a",
            b"%\x12\nG0 X1 Y2 Z3\n",
            b"G0 X10\nM2\n\0\0\0\0\0\0\0\0",
        ] {
            assert!(check_binary(text).is_ok(), "{text:?}");
        }
        assert!(check_binary(b"\x1b[31m (\x1b[0m)\n").is_ok());
    }

    #[test]
    fn line_ends() {
        for (text, lines) in [
            (&b"% a\rN10\r\rN20\r"[..], &b"% a\nN10\n\nN20\n"[..]),
            (b"% a\rN10", b"% a\nN10"),
            (b"% a\r\nN10\r\n", b"% a\r\nN10\r\n"),
            // What is mixed stays, and so does a single line.
            (b"% a\nN10\rN20\n", b"% a\nN10\rN20\n"),
            (b"% a\r", b"% a\r"),
            (b"", b""),
        ] {
            let mut read = Vec::new();
            Text::new(text).unwrap().read_to_end(&mut read).unwrap();
            assert_eq!(read, lines);
        }
        let mut raw = Vec::new();
        Text::binary(&b"\xff\xfe\r1"[..]).read_to_end(&mut raw).unwrap();
        assert_eq!(raw, b"\xff\xfe\r1");
    }

    #[test]
    fn files() {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(b"% a\rN10\rN20").unwrap();
        let mut reader = lines_of(file.path()).unwrap();
        let mut line = String::new();
        reader.read_line(&mut line).unwrap();
        reader.seek(SeekFrom::Start(4)).unwrap();
        reader.read_line(&mut line).unwrap();
        assert_eq!(line, "% a\nN10\n");
        file.as_file().set_len(0).unwrap();
        file.rewind().unwrap();
        file.write_all(&utf_16("name = 1", true, true)).unwrap();
        assert!(lines_of(file.path()).is_err());
        // What has no end is not read to its end.
        assert!(Text::new(std::io::repeat(b' ')).is_ok());
    }
}
