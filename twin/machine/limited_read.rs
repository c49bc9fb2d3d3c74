//! Limited file reading: read a whole file, up to a maximum size.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Bytes of a file at most: more than a cam of as many points as there may be, with every digit.
const MOST_BYTES: u64 = 256 << 20;

/// The bytes of a file; what has no end, as a device may, ends with an error.
///
/// # Errors
/// If it cannot be read, or is longer ([`io::ErrorKind::FileTooLarge`]).
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    up_to(path, MOST_BYTES)
}

fn up_to(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    let mut bytes = Vec::new();
    if length <= most {
        file.take(most + 1).read_to_end(&mut bytes)?;
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

    /// A device says that it has no bytes, and has no end.
    #[cfg(unix)]
    #[test]
    fn what_has_no_end_ends() {
        let error = up_to(Path::new("/dev/zero"), 1000).unwrap_err();
        assert_eq!(error.to_string(), "it is longer than 1000 bytes");
    }
}
