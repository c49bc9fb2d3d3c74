//! Limited file reading: read a whole text file, up to a maximum size.

use crate::text::Text;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Bytes of a table at most: more than a cam of as many points as there may be, with every digit.
const MOST_BYTES: u64 = 256 << 20;
/// Bytes of a TOML or XML file at most. It is read as a whole and needs many times its size in memory.
const MOST_TEXT: u64 = 16 << 20;

/// The bytes of a table in text; what has no end, as a device may, ends with an error.
///
/// # Errors
/// If it cannot be read, in UTF-16, or longer ([`io::ErrorKind::FileTooLarge`]).
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    up_to(path, MOST_BYTES)
}

/// The text of a whole file in TOML or XML.
///
/// # Errors
/// As [`read`], for a shorter one, and if it is not UTF-8.
pub fn read_to_string(path: &Path) -> io::Result<String> {
    String::from_utf8(up_to(path, MOST_TEXT)?)
        .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error.utf8_error()))
}

fn up_to(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    let mut bytes = Vec::new();
    if length <= most {
        Text::of(file)?.take(most + 1).read_to_end(&mut bytes)?;
    }
    if length <= most && bytes.len() as u64 <= most {
        return Ok(bytes);
    }
    let message = format!("it is longer than {most} bytes");
    Err(io::Error::new(io::ErrorKind::FileTooLarge, message))
}

#[cfg(test)]
mod tests {
    use super::{MOST_BYTES, up_to};
    use std::io::{ErrorKind, Seek, SeekFrom, Write};
    use std::path::Path;

    #[test]
    fn no_more_than_there_may_be() {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(b"12345").unwrap();
        assert_eq!(up_to(file.path(), 5).unwrap(), b"12345");
        let error = up_to(file.path(), 4).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::FileTooLarge);
        assert_eq!(error.to_string(), "it is longer than 4 bytes");
        // A file with a hole, of which nothing need be read.
        file.seek(SeekFrom::Start(MOST_BYTES)).unwrap();
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
        let error = up_to(Path::new("/dev/zero"), 1000).unwrap_err();
        assert_eq!(error.to_string(), "it is longer than 1000 bytes");
    }
}
