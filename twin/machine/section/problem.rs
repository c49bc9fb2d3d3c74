//! Problems of a TOML file: place, message and help, and their diagnostics.

use crate::limited_read;
use miette::{Diagnostic, NamedSource, SourceSpan};
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Problems of a file that are shown: each is looked up in its text.
const MOST_SHOWN: usize = 100;

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
        shown(&self.path, &self.text, &self.problems)
    }
}

impl fmt::Display for Elsewhere {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        for (index, problem) in self.problems.iter().take(MOST_SHOWN).enumerate() {
            let before = self.text.get(..problem.span.start).unwrap_or_default();
            let line = before.matches('\n').count() + 1;
            let parting = if index == 0 { ":" } else { ";" };
            write!(f, "{parting} line {line}: {}", problem.message)?;
        }
        if self.problems.len() > MOST_SHOWN {
            write!(f, "; {}", left_out(self.problems.len() - MOST_SHOWN))?;
        }
        Ok(())
    }
}

/// A diagnostic for each of the first [`MOST_SHOWN`] problems, and how many others there are.
fn shown(path: &Path, text: &str, problems: &[Problem]) -> Vec<Shown> {
    let text: Arc<str> = text.into();
    let shown = problems.iter().take(MOST_SHOWN).map(|problem| {
        let Problem { span, message, help, elsewhere } = problem.clone();
        let text = Some(NamedSource::new(path.display().to_string(), text.clone()));
        let others = elsewhere.map_or_else(Vec::new, |elsewhere| elsewhere.shown());
        Shown { message, help, text, span: Some(span.into()), others }
    });
    let left = problems.len().saturating_sub(MOST_SHOWN);
    let message = left_out(left);
    let others = Shown { message, help: None, text: None, span: None, others: Vec::new() };
    shown.chain((left > 0).then_some(others)).collect()
}

fn left_out(number: usize) -> String {
    format!("{number} problems more, left out")
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
    /// One report per problem, for people; of very many the first, and their number.
    pub fn reports(self) -> Vec<miette::Report> {
        match self {
            Self::Read { .. } => vec![miette::Report::msg(self.to_string())],
            Self::Content { path, text, problems, .. } => {
                shown(&path, &text, &problems).into_iter().map(miette::Report::new).collect()
            }
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
    text: Option<NamedSource<Arc<str>>>,
    #[label("here")]
    span: Option<SourceSpan>,
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
