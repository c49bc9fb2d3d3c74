//! Problems of a TOML file: place, message and help, and their diagnostics.

use crate::limited_read;
use miette::{Diagnostic, NamedSource, SourceSpan};
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// One problem and its place in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Bytes of the text.
    pub span: Range<usize>,
    /// The fault.
    pub message: String,
    /// Suggested correction, where one can be guessed.
    pub help: Option<String>,
    /// Problems of the file that is named here.
    pub elsewhere: Option<Arc<Elsewhere>>,
}

/// Problems of a file that another one names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Elsewhere {
    /// The file.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// Everything that is wrong with it, in file order.
    pub problems: Vec<Problem>,
}

impl Elsewhere {
    /// A diagnostic for every problem, with its line.
    pub fn shown(&self) -> Vec<Shown> {
        self.problems.iter().map(|problem| shown(&self.path, &self.text, problem)).collect()
    }
}

impl fmt::Display for Elsewhere {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        for (index, problem) in self.problems.iter().enumerate() {
            let before = self.text.get(..problem.span.start).unwrap_or_default();
            let line = before.matches('\n').count() + 1;
            let parting = if index == 0 { ":" } else { ";" };
            write!(f, "{parting} line {line}: {}", problem.message)?;
        }
        Ok(())
    }
}

fn shown(path: &Path, text: &str, problem: &Problem) -> Shown {
    let Problem { span, message, help, elsewhere } = problem.clone();
    let text = NamedSource::new(path.display().to_string(), text.to_owned());
    let others = elsewhere.map_or_else(Vec::new, |elsewhere| elsewhere.shown());
    Shown { message, help, text, span: span.into(), others }
}

/// Errors of a machine file, or of a scenario for one.
#[derive(Debug, thiserror::Error)]
pub enum MachineFileError {
    /// The file cannot be read.
    #[error("cannot read {what} {}: {source}", path.display())]
    Read {
        /// "machine file" or "scenario".
        what: &'static str,
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The content of the file is invalid.
    #[error("{what} {} has {} problem(s)", path.display(), problems.len())]
    Content {
        /// As above.
        what: &'static str,
        /// The file.
        path: PathBuf,
        /// Its text.
        text: String,
        /// Everything that is wrong with it, in file order.
        problems: Vec<Problem>,
    },
}

impl MachineFileError {
    /// One report per problem, for people.
    pub fn reports(self) -> Vec<miette::Report> {
        match self {
            Self::Read { .. } => vec![miette::Report::msg(self.to_string())],
            Self::Content { path, text, problems, .. } => problems
                .iter()
                .map(|problem| miette::Report::new(shown(&path, &text, problem)))
                .collect(),
        }
    }
}

/// A problem together with the text it is about.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{message}")]
#[diagnostic(severity(Error))]
pub struct Shown {
    message: String,
    #[help]
    help: Option<String>,
    #[source_code]
    text: NamedSource<String>,
    #[label("here")]
    span: SourceSpan,
    /// Problems of the file that is named here.
    #[related]
    others: Vec<Shown>,
}

/// Reads the file `path`, a `what` of the user, and parses its text.
///
/// Errors: [`MachineFileError`] if the file cannot be read, is too long or is not UTF-8, and with all that `parse`
/// finds wrong.
pub(crate) fn load<T>(
    what: &'static str,
    path: &Path,
    parse: impl FnOnce(&str) -> Result<T, Vec<Problem>>,
) -> Result<T, MachineFileError> {
    let path = path.to_owned();
    let text = match limited_read::read_to_string(&path) {
        Ok(text) => text,
        Err(source) => return Err(MachineFileError::Read { what, path, source }),
    };
    parse(&text).map_err(|problems| MachineFileError::Content { what, path, text, problems })
}
