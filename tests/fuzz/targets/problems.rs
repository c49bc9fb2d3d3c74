//! Invariants of the problems of a TOML file.

use std::path::Path;
use twin_machine::section::{MachineFileError, Problem};

/// Reports of one file at most: the first hundred, and the number of the others.
const REPORTS: usize = 101;

/// Checks problems of `text`: there is one, in file order, at places in the text, with messages that format.
pub fn sound(what: &'static str, text: &str, problems: Vec<Problem>) {
    assert!(!problems.is_empty(), "{what} refused without a problem");
    // Each key that is there is wrong once, each that is absent is missed once.
    assert!(problems.len() <= 2 * text.len() + 100, "{} problems", problems.len());
    assert!(problems.is_sorted_by_key(|problem| problem.span.start), "{problems:?}");
    for problem in &problems {
        assert!(text.get(problem.span.clone()).is_some(), "{:?} is outside", problem.span);
        assert!(!problem.message.trim().is_empty(), "{problem:?}");
        assert!(problem.help.as_ref().is_none_or(|help| !help.trim().is_empty()), "{problem:?}");
    }
    let (path, text) = (Path::new("fuzz.toml").to_owned(), text.to_owned());
    let error = MachineFileError::Content { what, path, text, problems };
    assert!(error.to_string().contains("fuzz.toml"), "{error}");
    let reports = error.reports();
    assert!((1..=REPORTS).contains(&reports.len()), "{} reports", reports.len());
    // With its line and a part of the text.
    assert!(reports.iter().take(3).all(|report| !format!("{report:?}").is_empty()));
}
