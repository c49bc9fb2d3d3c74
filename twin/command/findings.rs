//! Findings on a terminal, with the program lines they refer to.

use super::{causes, underline};
use crate::finding::{self, Finding, Severity};
use crate::program::{Dialect, ProgramFile};
use miette::{
    Diagnostic, LabeledSpan, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents,
};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::io::{self, BufRead, IsTerminal, Read, Write};
use std::ops::Range;
use std::path::Path;
use twin_machine::text;
use twin_number::counted;
use twin_path::{FilePath, Place};

/// How many findings a person is shown.
const SHOWN_FINDINGS: usize = 20;

/// The verdict with the number of errors and warnings, and the worst finding if it is not fit.
pub(super) fn verdict(findings: &[Finding], left_out: u64) -> String {
    let count = |severity| findings.iter().filter(|finding| finding.severity == severity).count();
    let errors = count(Severity::Error);
    let warnings = count(Severity::Warning);
    let verdict = if errors == 0 { "fit" } else { "not fit" };
    let left_out = match left_out {
        0 => String::new(),
        more => format!(" (and {more} findings more, left out)"),
    };
    let worst = finding::worst(findings).map(|worst| {
        let place = worst.place();
        format!("\n  worst: {place}: {}", worst.message)
    });
    format!(
        "{verdict}: {}, {}{left_out}{}",
        counted(errors, "error"),
        counted(warnings, "warning"),
        worst.unwrap_or_default()
    )
}

/// Which findings are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shown {
    /// The first causes; notes take one line together.
    Brief,
    /// The first causes, and notes as well.
    WithNotes,
    /// All of them.
    All,
}

/// Shows findings on standard error with their program lines, the worst first, and findings of one cause once.
pub(super) fn findings(program: &ProgramFile, findings: &[Finding], which: Shown) {
    let is_note = |finding: &Finding| finding.severity == Severity::Note;
    // Notes come last.
    let weighty = findings.partition_point(|finding| !is_note(finding));
    let (findings, in_brief) =
        if which != Shown::Brief || !findings.iter().skip(weighty).all(is_note) {
            (findings, &[][..])
        } else {
            findings.split_at(weighty)
        };
    let causes = causes::of(findings);
    let most = if which == Shown::All { causes.len() } else { SHOWN_FINDINGS };
    let shown = causes.get(..most).unwrap_or(&causes);
    let lines = lines_of(program, shown.iter().map(|cause| cause.worst));
    for cause in shown {
        let finding = cause.worst;
        let source = lines.get(&(finding.file, finding.line)).map(|line| {
            let words = match program.dialect() {
                Dialect::Job => underline::key(line, finding),
                _ => underline::words(line, finding),
            };
            let (text, words) = excerpt(line, words);
            let file = finding.file.map_or(program.path(), |file| file.path());
            let name = file.display().to_string();
            (Line { name, number: finding.line, text }, words)
        });
        let others = finding.elsewhere.as_ref().map_or_else(Vec::new, |other| other.shown());
        let shown = ShownFinding { finding, others, source, dialect: program.dialect() };
        let mut text = String::new();
        let handler = miette::GraphicalReportHandler::new_themed(theme()).with_links(false);
        if handler.render_report(&mut text, &shown).is_ok() {
            // A message that cannot be shown must not end the command.
            writeln!(io::stderr(), "{}", text.trim_end()).unwrap_or_default();
        }
        if let Some(others) = cause.others() {
            writeln!(io::stderr(), "  {others}").unwrap_or_default();
        }
    }
    if causes.len() > shown.len() {
        let listed: usize = shown.iter().map(causes::Cause::count).sum();
        let rest = findings.len() - listed;
        writeln!(io::stderr(), "… and {rest} more; `twin check -v` shows them").unwrap_or_default();
    }
    if let Some(line) = brief(in_brief) {
        writeln!(io::stderr(), "{line}").unwrap_or_default();
    }
}

/// Notes in one line: the message of a single one, or how many each rule has and the first line.
fn brief(notes: &[Finding]) -> Option<String> {
    if let [note] = notes {
        let place = Place { block: None, ..note.place() };
        return Some(format!("note: {place}: {}", note.message));
    }
    let mut rules: BTreeMap<&str, (usize, Place)> = BTreeMap::new();
    for note in notes {
        let place = Place { block: None, ..note.place() };
        let (count, first) = rules.entry(note.rule.name()).or_insert((0, place));
        (*count, *first) = (*count + 1, (*first).min(place));
    }
    let rules: Vec<_> = rules
        .into_iter()
        .map(|(rule, (count, first))| match count {
            1 => format!("{rule} ({first})"),
            _ => format!("{rule} ({count}, from {first} on)"),
        })
        .collect();
    (!rules.is_empty()).then(|| format!("notes: {}; `twin check -v` shows them", rules.join(", ")))
}

/// Colours only on a terminal.
fn theme() -> miette::GraphicalTheme {
    match (io::stderr().is_terminal(), std::env::var_os("NO_COLOR")) {
        (true, None) => miette::GraphicalTheme::unicode(),
        _ => miette::GraphicalTheme::unicode_nocolor(),
    }
}

/// The beginnings of the lines that findings are about, by their subroutine file, read from the files again: nothing keeps
/// the program in memory.
fn lines_of<'f>(
    program: &ProgramFile,
    findings: impl Iterator<Item = &'f Finding>,
) -> BTreeMap<(Option<FilePath>, u32), String> {
    let mut wanted: BTreeMap<_, BTreeSet<_>> = BTreeMap::new();
    for finding in findings {
        wanted.entry(finding.file).or_default().insert(finding.line);
    }
    let mut lines = BTreeMap::new();
    for (file, wanted) in wanted {
        let of_file = lines_of_file(file.map_or(program.path(), |file| file.path()), &wanted);
        lines.extend(of_file.into_iter().map(|(line, text)| ((file, line), text)));
    }
    lines
}

/// The beginnings of the `wanted` lines of a file; none if it cannot be read.
fn lines_of_file(path: &Path, wanted: &BTreeSet<u32>) -> BTreeMap<u32, String> {
    let mut lines = BTreeMap::new();
    let Some(last) = wanted.last().copied() else { return lines };
    // A pipe cannot be read twice.
    if !path.is_file() {
        return lines;
    }
    let Ok(mut reader) = text::lines_of(path) else { return lines };
    let mut buffer = Vec::new();
    for number in 1..=last {
        buffer.clear();
        let read = reader.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut buffer);
        if !matches!(read, Ok(1..)) {
            break;
        }
        if buffer.last() != Some(&b'\n') && reader.skip_until(b'\n').is_err() {
            break;
        }
        if wanted.contains(&number) {
            lines.insert(number, printable(&buffer));
        }
    }
    lines
}

/// More of a line is not read to show it, bytes.
const LONGEST_LINE: u64 = 1 << 16;

/// The text of a line, byte for byte, with a question mark for bytes that are not text.
fn printable(line: &[u8]) -> String {
    let mut text = String::with_capacity(line.len());
    for chunk in line.utf8_chunks() {
        let plain = |character: char| if character.is_ascii_control() { '?' } else { character };
        text.extend(
            chunk.valid().trim_end_matches(['\r', '\n']).replace('\t', " ").chars().map(plain),
        );
        text.extend(chunk.invalid().iter().map(|_| '?'));
    }
    text
}

/// More of a line than this is not shown, bytes.
const SHOWN_BYTES: usize = 200;

/// The part of a long line around the first of `words`, and the words in it.
fn excerpt(line: &str, words: Vec<Range<usize>>) -> (String, Vec<Range<usize>>) {
    if line.len() <= SHOWN_BYTES {
        return (line.to_owned(), words);
    }
    let first = words.first().map_or(0, |word| word.start);
    let start = line.floor_char_boundary(first.saturating_sub(SHOWN_BYTES / 2));
    let end = line.floor_char_boundary(start + SHOWN_BYTES);
    let text = line.get(start..end).unwrap_or_default();
    let (before, after) =
        (if start > 0 { "…" } else { "" }, if end < line.len() { "…" } else { "" });
    let words = words
        .into_iter()
        .filter(|word| word.start < end)
        .map(|word| word.start - start + before.len()..word.end.min(end) - start + before.len())
        .collect();
    (format!("{before}{text}{after}"), words)
}

/// One line of a program that knows its number.
#[derive(Debug)]
struct Line {
    name: String,
    number: u32,
    text: String,
}

impl SourceCode for Line {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        _context_lines_before: usize,
        _context_lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        if span.offset() + span.len() > self.text.len() {
            return Err(MietteError::OutOfBounds);
        }
        let whole = SourceSpan::from(0..self.text.len());
        let line = usize::try_from(self.number).unwrap_or(usize::MAX).saturating_sub(1);
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            self.text.as_bytes(),
            whole,
            line,
            0,
            1,
        )))
    }
}

#[derive(Debug)]
struct ShownFinding<'a> {
    finding: &'a Finding,
    /// Problems of the file that is named there.
    others: Vec<twin_machine::section::Shown>,
    /// The line and the words to underline.
    source: Option<(Line, Vec<Range<usize>>)>,
    /// In which words to speak of feeds.
    dialect: Dialect,
}

impl fmt::Display for ShownFinding<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = self.finding.place();
        if place.line == 0 {
            // Of no line of the program: the message says of what.
            return f.write_str(&self.finding.message);
        }
        write!(f, "{place}: {}", self.finding.message)
    }
}

impl std::error::Error for ShownFinding<'_> {}

impl Diagnostic for ShownFinding<'_> {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.finding.rule.name()))
    }

    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.finding.severity {
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
            Severity::Note => miette::Severity::Advice,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        if let Some(hint) = &self.finding.hint {
            return Some(Box::new(hint.as_str()));
        }
        let feed = self.finding.largest_feed_mm_per_s.filter(|feed| *feed >= 1e-3)?;
        let feed = match self.dialect {
            Dialect::Din66025 => format!("F{}", floor_3(feed)),
            // Per minute, in whichever unit.
            Dialect::Rs274 => format!("{} mm/min", floor_3(feed * 60.0)),
            Dialect::Job | Dialect::Dxf => format!("{} mm/s", floor_3(feed)),
        };
        Some(Box::new(format!("with {feed} or less this axis stays within its limit here")))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|(line, _)| line as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let (_, words) = self.source.as_ref()?;
        // The words may be those of other axes, which it moves with.
        let mut axis = self.finding.axis.as_ref().map(|axis| format!("axis {axis}"));
        let label =
            move |word: &Range<usize>| LabeledSpan::new_with_span(axis.take(), word.clone());
        Some(Box::new(words.iter().map(label)))
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        let others = self.others.iter().map(|other| other as &dyn Diagnostic);
        (!self.others.is_empty()).then(|| Box::new(others) as Box<dyn Iterator<Item = _>>)
    }
}

/// Three significant digits, rounded down: a feed that is recommended must not be too large.
fn floor_3(value: f64) -> String {
    if !(value.is_finite() && value > 0.0) {
        return "0".to_owned();
    }
    let digits = value.log10().floor();
    let unit = 10f64.powf(digits - 2.0);
    // What is a round number but for rounding stays one.
    let floored = (value / unit * (1.0 + 1e-9)).floor() * unit;
    let decimals = if digits >= 2.0 {
        0
    } else if digits >= 1.0 {
        1
    } else if digits >= 0.0 {
        2
    } else {
        6
    };
    format!("{floored:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::{SHOWN_BYTES, excerpt, floor_3, printable};

    #[test]
    #[expect(clippy::single_range_in_vec_init, reason = "one word is underlined")]
    fn a_long_line_is_shown_around_what_is_wrong() {
        let line = format!("{}X31O{}", "é".repeat(500), "é".repeat(500));
        let (text, words) = excerpt(&line, vec![1000..1004]);
        assert!(text.len() <= SHOWN_BYTES + 2 * "…".len());
        assert_eq!(text.get(words[0].clone()), Some("X31O"));
        let (text, words) = excerpt("N1 X2", vec![3..5]);
        assert_eq!((text.as_str(), words), ("N1 X2", vec![3..5]));
    }

    #[test]
    fn what_is_no_text_keeps_its_place() {
        assert_eq!(printable(b"N1\tX\xff\xfe\x1b[31mY2\r\n"), "N1 X???[31mY2");
    }

    #[test]
    fn recommended_feeds_are_rounded_down() {
        assert_eq!(floor_3(299.999_999_999_99), "300");
        assert_eq!(floor_3(123.9), "123");
        assert_eq!(floor_3(12.39), "12.3");
        assert_eq!(floor_3(1.239), "1.23");
        assert_eq!(floor_3(0.012_39), "0.012300");
        assert_eq!(floor_3(f64::NAN), "0");
    }
}
