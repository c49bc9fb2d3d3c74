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

/// Reports a line of %.
pub(in crate::rs274) fn percent(control: Control, out: &mut Output) {
    report(control, "%", None, Some(0..1), out);
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
    let begin = line.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or_default();
    if line.get(begin) == Some(&b'/') {
        report(control, "block delete /", None, Some(begin..begin + 1), out);
    }
    for (word, columns) in &block.seen {
        report(control, word, None, Some(columns.clone()), out);
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
    find(block.m_count > 1, "several M words in a block");
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
    let others = Letters::AXES.without(Letters::of("Z"));
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
