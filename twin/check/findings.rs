//! Findings of one program, with a maximum number per severity.

use crate::finding::{self, Finding, Rule, Severity};
use std::collections::{BTreeMap, VecDeque};
use twin_machine::Axis;
use twin_path::{LineKey, Place};
use twin_physics::Part;

/// Findings beyond this number of each severity are counted, not kept: a program that is wrong on every one of ten
/// million lines is reported as well by its first thousand.
pub(super) const MAX_FINDINGS: usize = 1000;

/// Number of findings, of those that are only counted, that are remembered, so that each is counted once: more than belong to one
/// line.
const REMEMBERED: usize = 64;

/// Subject of a finding besides its line and rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum About {
    /// An axis, in machine-file order.
    Axis(usize),
    /// Two parts.
    Parts([Part; 2]),
    /// A loose body, or a gripper that missed, in machine-file order.
    Handling(usize),
    /// The simulated machine, where the plan has a finding of its own.
    Simulated,
}

/// What makes a finding one finding: line, rule, what it is about and column, and of what is only worth knowing also what it
/// says: two blocks of a line say two things. Later ones that agree in this only raise its value and lower its feed.
type Key = (LineKey, Rule, Option<About>, Option<usize>, Option<String>);

/// Findings, bounded in number. Each severity has room of its own, so that no number of warnings hides an error, and so have
/// findings about axes and parts, so that they hide nothing that is wrong with the text.
#[derive(Debug, Default)]
pub(super) struct Findings {
    /// By severity, and whether they are about axes or parts.
    kept: BTreeMap<(Severity, bool), BTreeMap<Key, Finding>>,
    left_out: u64,
    /// The worst error that is not kept.
    worst_left_out: Option<Finding>,
    /// What was counted lately, each with the last line up to then.
    left_out_lately: VecDeque<(LineKey, (Severity, Key))>,
}

impl Findings {
    pub(super) fn add(&mut self, about: Option<About>, finding: Finding) {
        let column = finding.columns.as_ref().map(|columns| columns.start);
        let severity = finding.severity;
        let is_statement = severity == Severity::Note && about.is_none() && finding.value.is_none();
        let said = is_statement.then(|| finding.message.clone());
        let key = (finding.place().key(), finding.rule, about, column, said);
        let kept = self.kept.entry((severity, about.is_some())).or_default();
        if let Some(kept) = kept.get_mut(&key) {
            // A feed is small enough if it is so wherever the finding was made.
            let feeds = kept.largest_feed_mm_per_s.zip(finding.largest_feed_mm_per_s);
            let feed = feeds.map(|(one, other)| one.min(other));
            // Where no feed helps one of them, the remedy is that of it.
            let remedy = match (kept.largest_feed_mm_per_s, finding.largest_feed_mm_per_s) {
                (None, Some(_)) => kept.hint.clone(),
                (Some(_), None) => finding.hint.clone(),
                _ => None,
            };
            if finding.excess() > kept.excess() {
                *kept = finding;
            }
            kept.largest_feed_mm_per_s = feed;
            if remedy.is_some() {
                kept.hint = remedy;
            }
        } else if kept.len() < MAX_FINDINGS {
            kept.insert(key, finding);
        } else {
            let worst = self.worst_left_out.as_ref();
            if severity == Severity::Error
                && worst.is_none_or(|worst| finding::is_worse(&finding, worst))
            {
                self.worst_left_out = Some(finding);
            }
            self.leave_out((severity, key));
        }
    }

    /// Counts a finding that is not kept.
    fn leave_out(&mut self, key: (Severity, Key)) {
        let (_, (line, ..)) = key;
        // Entries up to one whose last line comes before this line are of other lines.
        let mut near = self.left_out_lately.iter().rev().take_while(|(last, _)| *last >= line);
        if !near.any(|(_, known)| *known == key) {
            self.left_out += 1;
            if self.left_out_lately.len() == REMEMBERED {
                self.left_out_lately.pop_front();
            }
            let last = self.left_out_lately.back().map_or(line, |(last, _)| line.max(*last));
            self.left_out_lately.push_back((last, key));
        }
    }

    /// Findings about the axis with this index.
    pub(super) fn of_axis<'f>(&'f mut self, index: usize, axis: &'f Axis) -> AxisFindings<'f> {
        AxisFindings { findings: self, about: About::Axis(index), axis }
    }

    /// True if another finding of this severity about an axis would be kept.
    pub(super) fn has_room(&self, severity: Severity) -> bool {
        self.kept.get(&(severity, true)).is_none_or(|kept| kept.len() < MAX_FINDINGS)
    }

    pub(super) fn any_error(&self) -> bool {
        [true, false].iter().any(|about| self.kept.contains_key(&(Severity::Error, *about)))
    }

    /// All that were kept, the worst error at the end if it is not among them, and how many others were not kept.
    pub(super) fn into_list(self) -> (Vec<Finding>, u64) {
        let mut list: Vec<_> = self.kept.into_values().flat_map(BTreeMap::into_values).collect();
        let mut left_out = self.left_out;
        let worst = finding::worst(&list);
        let more = self
            .worst_left_out
            .filter(|error| worst.is_none_or(|worst| finding::is_worse(error, worst)));
        if let Some(error) = more {
            list.push(error);
            left_out -= 1;
        }
        (list, left_out)
    }
}

/// Findings about one axis.
#[derive(Debug)]
pub(super) struct AxisFindings<'f> {
    findings: &'f mut Findings,
    about: About,
    axis: &'f Axis,
}

impl AxisFindings<'_> {
    pub(super) fn add(&mut self, finding: Finding) {
        self.findings.add(Some(self.about), finding);
    }

    /// Counts an overload (SI) whose finding would not be kept; true if so: no message is needed.
    pub(super) fn count_unkept(
        &mut self,
        (severity, rule): (Severity, Rule),
        place: Place,
        value: f64,
        limit: f64,
    ) -> bool {
        let Findings { kept, worst_left_out, .. } = &*self.findings;
        let kept = kept.get(&(severity, true)).filter(|kept| kept.len() == MAX_FINDINGS);
        let Some(kept) = kept else {
            return false;
        };
        let key = (place.key(), rule, Some(self.about), None, None);
        let ratio = finding::limit_ratio(self.axis.from_si(value), self.axis.from_si(limit));
        // No overload is worse than an error of another kind.
        let is_worst = worst_left_out
            .as_ref()
            .is_none_or(|worst| finding::overload(worst).is_some_and(|worst| ratio > worst));
        // Most lines come after those of which something is kept.
        let is_kept =
            kept.last_key_value().is_some_and(|(last, _)| *last >= key) && kept.contains_key(&key);
        if is_kept || (severity == Severity::Error && is_worst) {
            return false;
        }
        self.findings.leave_out((severity, key));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::{About, Findings};
    use crate::finding::{Finding, Rule, Severity};
    use twin_path::Place;

    const GANTRY3: &str = include_str!("../../tests/data/machines/gantry3.toml");

    fn found(severity: Severity, message: &str) -> Finding {
        let place = Place::at(7);
        let finding = Finding::error(Rule::FunctionBlock, place, message.to_owned());
        Finding { severity, ..finding }
    }

    /// Overloads whose messages are not needed are kept, counted and compared as if they had one.
    #[test]
    fn overloads_without_messages_count_as_others() {
        let machine =
            twin_machine::Machine::parse(std::path::Path::new("machine.toml"), GANTRY3).unwrap();
        let axis = &machine.axes[0];
        let [mut with, mut without] = [Findings::default(), Findings::default()];
        let mut random = 1_u32;
        for number in 0..6000_u32 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Some lines again and again, and some values twice.
            let place = Place::at(number / 2 + random % 3);
            let value = 1.0 + f64::from(random >> 20) * 1e-3;
            let warns = random.is_multiple_of(5);
            let rule = if warns { Rule::AxisJerk } else { Rule::AxisVelocity };
            let severity = if warns { Severity::Warning } else { Severity::Error };
            let made = || {
                let finding = Finding::error(rule, place, format!("{value}"));
                let (value, limit) = (axis.from_si(value), axis.from_si(0.3));
                Finding { severity, ..finding.with_value(value, limit, "mm/s") }
            };
            with.add(Some(About::Axis(0)), made());
            let mut found = without.of_axis(0, axis);
            if !found.count_unkept((severity, rule), place, value, 0.3) {
                found.add(made());
            }
            if number == 4000 {
                let reach = Finding::error(Rule::Reach, place, "out of reach".to_owned());
                with.add(None, reach.clone());
                without.add(None, reach);
            }
        }
        let (list, left_out) = with.into_list();
        assert!(left_out > 1000);
        assert_eq!(without.into_list(), (list, left_out));
    }

    /// Errors beyond the number that is kept are counted; the worst of them is kept all the same.
    #[test]
    fn the_worst_error_is_never_left_out() {
        let limit = |line: u32, factor: f64| {
            let place = Place::at(line);
            let finding = Finding::error(Rule::AxisVelocity, place, format!("line {line}"));
            finding.with_value(factor, 1.0, "mm/s")
        };
        for (worst, kept, left_out) in
            [(5.0, super::MAX_FINDINGS + 1, 29), (1.5, super::MAX_FINDINGS, 30)]
        {
            let mut findings = Findings::default();
            for line in 1..=1030 {
                let factor = if line == 1010 { worst } else { 2.0 };
                findings.add(Some(About::Axis(0)), limit(line, factor));
            }
            let (list, more) = findings.into_list();
            assert_eq!((list.len(), more), (kept, left_out));
            let named = crate::finding::worst(&list).and_then(|one| one.value);
            assert_eq!(named, Some(f64::max(worst, 2.0)));
        }
    }

    /// Notes of one line that say different things are all kept, once each; of errors the worst.
    #[test]
    fn notes_of_one_line_do_not_hide_each_other() {
        let mut findings = Findings::default();
        for said in ["a jerk is assumed", "X at 100 mm", "X at 100 mm", "X at 200 mm"] {
            findings.add(None, found(Severity::Note, said));
        }
        for value in [2.0, 5.0, 3.0] {
            let error = found(Severity::Error, &format!("{value} mm")).with_value(value, 1.0, "mm");
            findings.add(Some(About::Axis(0)), error);
        }
        let (mut list, left_out) = findings.into_list();
        list.sort_by(|a, b| a.message.cmp(&b.message));
        let said: Vec<_> = list.iter().map(|finding| finding.message.as_str()).collect();
        assert_eq!(said, ["5 mm", "X at 100 mm", "X at 200 mm", "a jerk is assumed"]);
        assert_eq!(left_out, 0);
    }
}
