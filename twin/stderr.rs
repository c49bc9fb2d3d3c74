//! Standard error output that never fails.

use std::fmt::Arguments;
use std::io::{self, Write};

/// Says something on standard error, like `eprintln!`, and never fails: a terminal that has been closed, or a pipe that nobody
/// reads any more, must not end a program that still has axes to bring to rest.
macro_rules! stderr {
    ($($words:tt)*) => { $crate::stderr::line(format_args!($($words)*)) };
}

/// A line for people.
pub(crate) fn line(words: Arguments<'_>) {
    writeln!(io::stderr().lock(), "{words}").ok();
}
