//! Problems of a TOML file: place, message and help, and their diagnostics.

use crate::bounded;
use miette::{Diagnostic, LabeledSpan, NamedSource, Severity, SourceCode};
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// One thing wrong, and where in the text.
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
    pub(crate) fn shown(&self) -> Vec<Shown> {
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
    let source = NamedSource::new(path.display().to_string(), text.to_owned());
    let others = problem.elsewhere.as_ref().map_or_else(Vec::new, |elsewhere| elsewhere.shown());
    Shown { problem: problem.clone(), source, others }
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
        /// Why.
        source: std::io::Error,
    },
    /// The file is not what it must be.
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
#[derive(Debug)]
pub(crate) struct Shown {
    problem: Problem,
    source: NamedSource<String>,
    /// Problems of the file that is named here.
    others: Vec<Shown>,
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.problem.message)
    }
}

impl std::error::Error for Shown {}

impl Diagnostic for Shown {
    fn severity(&self) -> Option<Severity> {
        Some(Severity::Error)
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.problem.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let label = LabeledSpan::new_with_span(Some("here".to_owned()), self.problem.span.clone());
        Some(Box::new(std::iter::once(label)))
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        let others = self.others.iter().map(|other| other as &dyn Diagnostic);
        (!self.others.is_empty()).then(|| Box::new(others) as Box<dyn Iterator<Item = _>>)
    }
}

/// The text of a file.
pub(crate) fn read_text(what: &'static str, path: &Path) -> Result<String, MachineFileError> {
    let text = bounded::read_to_string(path);
    text.map_err(|source| MachineFileError::Read { what, path: path.to_owned(), source })
}
