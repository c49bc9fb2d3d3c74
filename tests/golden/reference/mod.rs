//! Generated chapters of the book: machine file keys, command line, rules, report.
//!
//! Each test makes its chapter from the code and compares it with the file. After an intended change the chapters are
//! written with
//!
//! ```sh
//! TWIN_BOOK=write cargo test -p twin --test golden -- reference
//! ```

mod command_line;
mod controls;
mod machine_file;
mod report;
mod rules;

use crate::root;
use std::{env, fs};

/// Compares a chapter with what is `made` from the code, or writes it.
fn compare(chapter: &str, made: &str) {
    let path = root().join("docs/src/reference").join(chapter);
    if env::var_os("TWIN_BOOK").is_some_and(|value| value == "write") {
        fs::write(&path, made).expect("writable");
    }
    let written = fs::read_to_string(&path).unwrap_or_default();
    let lines = written.lines().zip(made.lines()).position(|(one, other)| one != other);
    assert!(
        written == made,
        "docs/src/reference/{chapter} differs from the code at line {}: TWIN_BOOK=write makes it anew",
        lines.unwrap_or(written.lines().count().min(made.lines().count())) + 1
    );
}

/// Text in the cell of a table: in one line, bars escaped.
fn cell(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|")
}
