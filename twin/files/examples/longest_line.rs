//! Reads a stream whose line never ends, as far as lines are read.
//!
//! ```sh
//! cargo run -p twin-files --example longest_line
//! ```

use std::io::{self, BufRead, BufReader};
use twin_files::limited_read::{LimitedLines, MOST_LINE};

fn main() -> io::Result<()> {
    let stream = LimitedLines::new(io::Read::chain(&b"first\n"[..], io::repeat(b'x')));
    let mut lines = BufReader::new(stream).lines();
    assert_eq!(lines.next().transpose()?.as_deref(), Some("first"));
    let Some(Err(error)) = lines.next() else {
        return Err(io::Error::other("a line without an end was read"));
    };
    println!("{error}");
    assert!(error.to_string().starts_with(&format!("line 2 has more than {MOST_LINE} bytes")));
    Ok(())
}
