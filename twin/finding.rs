//! Findings: faults of a program, each with its rule, severity, line, value and limit.

pub use crate::rule::{Rule, Severity};
use crate::tolerance::exceeds;
use serde::{Serialize, Serializer};
use std::ops::Range;
use std::sync::Arc;
use twin_machine::section::Elsewhere;
use twin_path::{FileLine, FilePath, Place};

/// One thing found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// The rule.
    pub rule: Rule,
    /// The severity.
    pub severity: Severity,
    /// Line of the file, from 1.
    pub line: u32,
    /// The subroutine file that has the line; none if the program itself does.
    #[serde(serialize_with = "file_name", skip_serializing_if = "Option::is_none")]
    pub file: Option<FilePath>,
    /// Line of the program that calls the subroutine file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub called_from: Option<u32>,
    /// N word of the block, if it has one.
    pub block: Option<u32>,
    /// The fault, with value and limit.
    pub message: String,
    /// The axis concerned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<String>,
    /// The value found, in `unit`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// The limit it breaks, in `unit`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Unit of `value` and `limit`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<&'static str>,
    /// The largest feed with which this would not be found, mm/s, where a lower feed helps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_feed_mm_per_s: Option<f64>,
    /// Remedy, for people.
    #[serde(skip)]
    pub hint: Option<String>,
    /// Bytes of the line to underline.
    #[serde(skip)]
    pub columns: Option<Range<usize>>,
    /// Problems of the file that is named there, for people.
    #[serde(skip)]
    pub elsewhere: Option<Arc<Elsewhere>>,
}

impl Finding {
    /// An error of `rule` at `place`.
    pub fn error(rule: Rule, place: Place, message: String) -> Self {
        Self {
            rule,
            severity: Severity::Error,
            line: place.line_in_file(),
            file: place.file(),
            called_from: place.called_from(),
            block: place.block,
            message,
            axis: None,
            value: None,
            limit: None,
            unit: None,
            largest_feed_mm_per_s: None,
            hint: None,
            columns: None,
            elsewhere: None,
        }
    }

    /// With the numbers behind it.
    #[must_use]
    pub fn with_value(mut self, value: f64, limit: f64, unit: &'static str) -> Self {
        self.value = Some(value);
        self.limit = Some(limit);
        self.unit = Some(unit);
        self
    }

    /// The place it is about.
    pub fn place(&self) -> Place {
        let within = self.file.map(|file| FileLine { file, line: self.line });
        let line = self.called_from.unwrap_or(self.line);
        Place { line, block: self.block, within }
    }

    /// How far its value is from its limit, in `unit`; 0 without one.
    pub fn excess(&self) -> f64 {
        self.value.zip(self.limit).map_or(0.0, |(value, limit)| (value - limit).abs())
    }
}

/// Writes the name of a subroutine file; see [`Finding::file`].
#[expect(clippy::ref_option, clippy::trivially_copy_pass_by_ref, reason = "as serde wants it")]
pub(crate) fn file_name<S: Serializer>(
    file: &Option<FilePath>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_some(&file.map(|file| file.to_string()))
}

/// Brings findings into the order they are shown in: the worst first, then by line.
pub fn sort(findings: &mut [Finding]) {
    for Finding { rule, severity, .. } in &*findings {
        debug_assert!(rule.severities().contains(severity), "{rule:?} has {severity:?}");
    }
    // What the user has asked to go wrong explains the rest.
    let consequence = |finding: &Finding| finding.rule != Rule::Fault;
    findings.sort_by(|a, b| {
        consequence(a)
            .cmp(&consequence(b))
            .then(b.severity.cmp(&a.severity))
            .then(a.place().key().cmp(&b.place().key()))
            .then(a.rule.cmp(&b.rule))
            .then_with(|| a.axis.cmp(&b.axis))
    });
}

/// A program in which nothing moves.
pub(crate) fn nothing_moves() -> Finding {
    let message = "the program has no block that moves anything".to_owned();
    Finding::error(Rule::Syntax, Place::at(1), message)
}

/// The worst error, of equal ones the first.
pub fn worst(findings: &[Finding]) -> Option<&Finding> {
    let errors = findings.iter().filter(|finding| finding.severity == Severity::Error);
    errors.reduce(|worst, next| if is_worse(next, worst) { next } else { worst })
}

/// True if an error is worse than another: only the other one is an overload, or it is a larger multiple of its limit, or both
/// have one rule and it is farther from its limit.
pub(crate) fn is_worse(error: &Finding, than: &Finding) -> bool {
    match (overload(error), overload(than)) {
        (None, Some(_)) => true,
        (Some(ratio), Some(other)) => exceeds(ratio, other),
        (None, None) => error.rule == than.rule && exceeds(error.excess(), than.excess()),
        (Some(_), None) => false,
    }
}

/// Ratio of the value of an overload to its limit; none if the finding is about something else.
pub(crate) fn overload(finding: &Finding) -> Option<f64> {
    match finding.rule {
        Rule::AxisVelocity | Rule::AxisAcceleration | Rule::AxisVelocityStep | Rule::AxisJerk => {
            finding.value.zip(finding.limit).map(|(value, limit)| limit_ratio(value, limit))
        }
        _ => None,
    }
}

/// Ratio of a value to its limit.
pub(crate) fn limit_ratio(value: f64, limit: f64) -> f64 {
    (value / limit).abs()
}

/// True if any finding makes the program unfit for the machine.
pub fn unfit(findings: &[Finding]) -> bool {
    findings.iter().any(|finding| finding.severity == Severity::Error)
}
