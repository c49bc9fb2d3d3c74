//! Grouping of findings by cause, for output to people.

use crate::finding::{Finding, Rule, Severity};
use crate::tolerance::exceeds;
use twin_path::Place;

/// More lines are not listed.
const LISTED: usize = 8;

/// Findings that say the same of several lines.
#[derive(Debug)]
pub(super) struct Cause<'f> {
    /// The one that is farthest from its limit.
    pub(super) worst: &'f Finding,
    /// Places of the others.
    others: Vec<Place>,
}

/// What findings of one cause have in common: all but place and numbers.
type Key<'f> = (Severity, Rule, Option<&'f str>, String);

fn key(finding: &Finding) -> Key<'_> {
    // A note of a block or a probe has a number of its own: each is shown.
    let is_single = [Rule::FunctionBlock, Rule::Probe].contains(&finding.rule);
    if finding.severity == Severity::Note && is_single {
        let axis = finding.axis.as_deref();
        return (finding.severity, finding.rule, axis, finding.message.clone());
    }
    let is_number =
        |word: &str| word.trim_matches(|c: char| !c.is_ascii_alphanumeric()).parse::<f64>().is_ok();
    let words = finding.message.split_whitespace().filter(|word| !is_number(word));
    let words: Vec<_> = words.collect();
    (finding.severity, finding.rule, finding.axis.as_deref(), words.join(" "))
}

/// The findings by their causes, in the order of the first of each.
pub(super) fn of(findings: &[Finding]) -> Vec<Cause<'_>> {
    let mut keys: Vec<Key<'_>> = Vec::new();
    let mut causes: Vec<Cause<'_>> = Vec::new();
    for finding in findings {
        let key = key(finding);
        let known = keys.iter().position(|known| *known == key);
        if let Some(cause) = known.and_then(|known| causes.get_mut(known)) {
            let is_worse = exceeds(finding.excess(), cause.worst.excess());
            let other =
                if is_worse { std::mem::replace(&mut cause.worst, finding) } else { finding };
            cause.others.push(Place { block: None, ..other.place() });
        } else {
            keys.push(key);
            causes.push(Cause { worst: finding, others: Vec::new() });
        }
    }
    causes
}

/// Number of a line, behind the name of its subroutine file.
fn number(place: &Place) -> String {
    let line = place.line_in_file();
    place.file().map_or_else(|| line.to_string(), |file| format!("{file}:{line}"))
}

impl Cause<'_> {
    /// Number of findings with this cause.
    pub(super) fn count(&self) -> usize {
        self.others.len() + 1
    }

    /// The other lines with the same finding, if there are any.
    pub(super) fn others(&self) -> Option<String> {
        let mut lines = self.others.clone();
        lines.sort_unstable();
        lines.dedup();
        lines.retain(|line| line.key() != self.worst.place().key());
        if lines.is_empty() {
            return None;
        }
        let listed: Vec<_> = lines.iter().take(LISTED).map(number).collect();
        let more = if lines.len() > LISTED { ", …" } else { "" };
        let plural = if lines.len() == 1 { "line" } else { "lines" };
        Some(format!("… and in {} more {plural}: {}{more}", lines.len(), listed.join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use super::of;
    use crate::finding::{Finding, Rule, Severity};
    use twin_path::Place;

    fn found(line: u32, axis: &str, message: &str) -> Finding {
        let mut finding = Finding::error(Rule::AxisVelocity, Place::at(line), message.to_owned());
        finding.axis = Some(axis.to_owned());
        finding
    }

    #[test]
    fn one_cause_is_told_once_with_the_lines_of_all() {
        let mut findings: Vec<_> = (1..=12)
            .map(|line| found(line, "X", &format!("velocity {line}.5 mm/s is above 400")))
            .collect();
        findings.push(found(3, "Y", "velocity 7.5 mm/s is above 400"));
        findings.push(found(4, "X", "another matter"));
        let causes = of(&findings);
        let shown: Vec<_> = causes.iter().map(|cause| (cause.worst.line, cause.count())).collect();
        assert_eq!(shown, [(1, 12), (3, 1), (4, 1)]);
        let others = causes[0].others().unwrap();
        assert_eq!(others, "… and in 11 more lines: 2, 3, 4, 5, 6, 7, 8, 9, …");
        assert_eq!(causes[1].others(), None);
        // A word is not a number.
        let probes =
            [found(1, "X", "G38.2 meets nothing at 5"), found(2, "X", "G38.3 meets nothing at 7")];
        assert_eq!(of(&probes).len(), 2);
        // What probes have found is shown for each of them, where it is not the same.
        let message = |rule, line, message: &str| {
            let place = Place::at(line);
            let finding = Finding::error(rule, place, message.to_owned());
            Finding { severity: Severity::Note, ..finding }
        };
        for rule in [Rule::FunctionBlock, Rule::Probe] {
            let recorded = [
                message(rule, 3, "X at 48.3 mm"),
                message(rule, 5, "X at 98.3 mm"),
                message(rule, 9, "X at 98.3 mm"),
            ];
            let counts: Vec<_> = of(&recorded).iter().map(super::Cause::count).collect();
            assert_eq!(counts, [1, 2], "{rule:?}");
        }
        // Twice in the same line counts as one line.
        let twice =
            [found(5, "X", "velocity 1"), found(5, "X", "velocity 2"), found(6, "X", "velocity 3")];
        assert_eq!(of(&twice)[0].others().as_deref(), Some("… and in 1 more line: 6"));
    }
}
