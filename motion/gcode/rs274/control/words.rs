//! Words of a line that not every control takes.

use super::table::row;
use super::{Control, ControlFinding, Reading};
use crate::rs274::block::{Block, Letter, Letters};
use crate::rs274::error::DecodeError;
use crate::rs274::flow::Keyword;
use crate::rs274::leniency::Leniency;
use crate::rs274::output::Output;
use crate::rs274::state::State;
use crate::rs274::word::{Motion, OneShot, ToolLength};
use std::ops::Range;
use twin_path::Plane;

impl Leniency {
    /// The row of what it forgives.
    fn word(self) -> &'static str {
        match self {
            Self::NoEnd | Self::ClosingPercent => "program without an end",
            Self::NoMotionWord => "coordinates before any motion word",
            Self::NoFeed => "motion without any F",
            Self::CenterOutsidePlane(_) => "arc with a centre off its plane",
            Self::UnknownM(_) => "other M words",
        }
    }
}

/// Passes over what LinuxCNC refuses and another control may take.
pub(in crate::rs274) fn forgive(
    control: Control,
    leniency: Leniency,
    columns: Option<Range<usize>>,
    out: &mut Output,
) {
    if control == Control::LinuxCnc {
        out.remark(columns, leniency.refusal(), true);
    } else {
        let word = match leniency {
            Leniency::UnknownM(number) => Some(format!("M{number}")),
            _ => None,
        };
        // What has a row of its own has been found there.
        if word.as_deref().is_some_and(|word| row(word).is_some()) {
            return;
        }
        report(control, leniency.word(), word, columns, out);
    }
}

/// Reports an arc that ends at another distance from its centre than it begins.
pub(in crate::rs274) fn unequal_radii(control: Control, out: &mut Output) {
    report(control, "arc with unequal radii", None, None, out);
}

/// Looks for words of a line that `control` does not take as LinuxCNC does.
pub(in crate::rs274) fn check(
    control: Control,
    line: &[u8],
    block: &Block,
    keyword: Option<Keyword>,
    state: &State,
    out: &mut Output,
) {
    let mut scan = Scan { line, at: 0, words: Vec::new() };
    scan.run();
    for (word, columns) in scan.words {
        report(control, &word, None, Some(columns), out);
    }
    if is_long(control, line) {
        report(control, "long line", None, None, out);
    }
    for word in features(control, block, keyword, state) {
        report(control, word, None, None, out);
    }
}

/// True if `control` does not read lines of this length.
fn is_long(control: Control, line: &[u8]) -> bool {
    let bytes = line.trim_ascii_end().len();
    match control {
        Control::LinuxCnc => bytes > 252,
        Control::Grbl => {
            let mut comment = false;
            let counts = |byte: &&u8| {
                comment |= **byte == b'(';
                let counts = !comment && !byte.is_ascii_whitespace();
                comment &= **byte != b')';
                counts
            };
            let text = line.split(|byte| *byte == b';').next().unwrap_or_default();
            text.iter().filter(counts).count() > 79
        }
        Control::GrblHal | Control::Mach3 => bytes > 256,
        Control::FluidNc => bytes > 127,
        Control::Fanuc | Control::SoftMotion => false,
    }
}

/// What a block contains beyond single words.
fn features(
    control: Control,
    block: &Block,
    keyword: Option<Keyword>,
    state: &State,
) -> Vec<&'static str> {
    let mut found = Vec::new();
    let mut find = |condition: bool, word| {
        if condition {
            found.push(word);
        }
    };
    if let Some(keyword) = keyword {
        find(
            true,
            match keyword {
                Keyword::Program => "program number",
                Keyword::Sub | Keyword::EndSub | Keyword::Return | Keyword::Call => "O sub",
                Keyword::If | Keyword::ElseIf | Keyword::Else | Keyword::EndIf => "O if",
                _ => "O while",
            },
        );
    }
    let motion = block.g.motion.unwrap_or(state.motion);
    let plane = block.g.plane.unwrap_or(state.plane);
    let moves = block.letters().meets(Letters::AXES.with(Letters::CENTER));
    let has = |letter| block.get(letter).is_some();
    if moves && matches!(motion, Motion::Arc { .. }) && block.g.one_shot.is_none() {
        let [first, second] = match plane {
            Plane::Xy => [Letter::X, Letter::Y],
            Plane::Zx => [Letter::Z, Letter::X],
            Plane::Yz => [Letter::Y, Letter::Z],
        };
        find(!has(first) && !has(second), "full circle without an end");
        find(block.get(Letter::R).is_some_and(|radius| radius < 0.0), "arc with R below 0");
        find(has(Letter::P), "arc with P");
        find(plane == Plane::Zx, "arc in G18");
        find(plane == Plane::Yz, "arc in G19");
    }
    find(moves && matches!(motion, Motion::Cycle(_)) && has(Letter::L), "canned cycle with L");
    if block.g.one_shot == Some(OneShot::Dwell) {
        find(
            block.get(Letter::P).is_some_and(|seconds| seconds.fract() != 0.0),
            "G4 with a fraction of a second",
        );
    }
    if block.g.one_shot == Some(OneShot::SetData) {
        let is = |number: f64| block.get(Letter::L).is_some_and(|l| (l - number).abs() < 0.5);
        find(is(1.0), "G10 L1");
        find(is(2.0), "G10 L2");
        find(is(2.0) && has(Letter::R), "G10 L2 with R");
        find(is(10.0), "G10 L10");
        find(is(11.0), "G10 L11");
        find(is(20.0), "G10 L20");
        find(block.get(Letter::P).is_some_and(|p| p > 6.5) && !is(1.0), "G10 with P7 to P9");
    }
    let machine = block.g.one_shot == Some(OneShot::MachineFrame);
    find(machine && motion == Motion::Line, "G53 with G1");
    let others = Letters::AXES.without(Letters::of(&[Letter::Z]));
    let direct = block.g.tool_length == Some(ToolLength::Direct);
    find(direct && block.letters().meets(others), "G43.1 with other axes than Z");
    find(block.number.is_some_and(|number| number > 99_999), "N above 99999");
    find(block.number.is_some_and(|number| number > 10_000_000), "N above 10000000");
    let needs_n = control == Control::SoftMotion && !(block.is_empty() && keyword.is_none());
    find(block.number.is_none() && needs_n, "block without N");
    found
}

/// Reports what `control` does with `word`, a row of the table; `shown` is its name if it is another one.
fn report(
    control: Control,
    word: &str,
    shown: Option<String>,
    columns: Option<Range<usize>>,
    out: &mut Output,
) {
    let Some(row) = row(word) else { return };
    let Some(cell) = row.cell(control) else { return };
    if matches!(cell.reading, Reading::Same | Reading::Followed) {
        return;
    }
    let refused = cell.reading == Reading::Refused && cell.certain;
    let word = shown.unwrap_or_else(|| word.to_owned());
    out.remark(
        columns,
        DecodeError::OfControl(ControlFinding { control, word, cell, rewrite: row.rewrite }),
        refused,
    );
}

/// A line on the way to its words.
struct Scan<'a> {
    line: &'a [u8],
    at: usize,
    words: Vec<(String, Range<usize>)>,
}

impl Scan<'_> {
    fn add(&mut self, word: impl Into<String>, columns: Range<usize>) {
        let word = word.into();
        if !self.words.iter().any(|(known, _)| *known == word) {
            self.words.push((word, columns));
        }
    }

    fn peek(&self) -> Option<u8> {
        self.line.get(self.at).copied()
    }

    /// Reads all of the line, which has no errors.
    fn run(&mut self) {
        let mut m_words = 0;
        while let Some(byte) = self.peek() {
            let start = self.at;
            self.at += 1;
            match byte.to_ascii_uppercase() {
                b'(' => {
                    while self.peek().is_some_and(|byte| byte != b')') {
                        self.at += 1;
                    }
                }
                b';' => return self.add("comment with ;", start..self.line.len()),
                b'/' if self.words.is_empty() => self.add("block delete /", start..self.at),
                b'%' => self.add("%", start..self.at),
                b'#' => self.parameter(start),
                b'=' => self.skip_name(),
                b'[' => {
                    self.add("expressions", start..self.at);
                    self.skip_expression();
                }
                b'@' | b'^' => self.add("@ and ^", start..self.at),
                b'$' => self.add("$", start..self.at),
                b'N' => {
                    self.number();
                }
                // What follows is a label.
                b'O' if self.words.is_empty() => return,
                letter @ b'A'..=b'Z' => {
                    let number = self.number();
                    if number.is_empty() {
                        self.skip_name();
                    }
                    let columns = start..self.at;
                    m_words += usize::from(letter == b'M');
                    if m_words > 1 {
                        self.add("several M words in a block", columns.clone());
                    }
                    self.add(name(letter, &number), columns.clone());
                    let is_length = matches!(letter, b'X' | b'Y' | b'Z' | b'I' | b'J' | b'R');
                    let whole = number.bytes().any(|digit| digit != b'0') && !number.contains('.');
                    if is_length && whole {
                        self.add("length without a decimal point", columns);
                    }
                }
                _ => {}
            }
        }
    }

    /// Goes behind the name of a function, if there is one.
    fn skip_name(&mut self) {
        self.skip_blanks();
        while self.peek().is_some_and(|byte| byte.is_ascii_alphabetic()) {
            self.at += 1;
        }
    }

    /// Goes behind the brackets of an expression, but for its parameters.
    fn skip_expression(&mut self) {
        let mut depth = 1;
        while let Some(byte) = self.peek().filter(|_| depth > 0) {
            match byte {
                b'[' => depth += 1,
                b']' => depth -= 1,
                b'#' => {
                    let start = self.at;
                    self.at += 1;
                    self.parameter(start);
                    continue;
                }
                _ => {}
            }
            self.at += 1;
        }
    }

    /// The parameter behind `#` at `start`.
    fn parameter(&mut self, start: usize) {
        self.skip_blanks();
        let named = self.peek() == Some(b'<');
        self.add(if named { "named parameters" } else { "parameters" }, start..self.at);
        while named && self.peek().is_some_and(|byte| byte != b'>') {
            self.at += 1;
        }
    }

    fn skip_blanks(&mut self) {
        while self.peek().is_some_and(|byte| byte.is_ascii_whitespace()) {
            self.at += 1;
        }
    }

    /// The digits and the point that follow, without blanks and signs.
    fn number(&mut self) -> String {
        let mut number = String::new();
        self.skip_blanks();
        if matches!(self.peek(), Some(b'+' | b'-')) {
            self.at += 1;
        }
        self.skip_blanks();
        while let Some(byte @ (b'0'..=b'9' | b'.')) = self.peek() {
            number.push(char::from(byte));
            self.at += 1;
            self.skip_blanks();
        }
        number
    }
}

/// `G1` of G and `01.0`; other words are their letter.
fn name(letter: u8, number: &str) -> String {
    match number.parse::<f64>() {
        Ok(number) if matches!(letter, b'G' | b'M') => format!("{}{number}", char::from(letter)),
        _ => char::from(letter).to_string(),
    }
}
