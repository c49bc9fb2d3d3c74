//! The words that controls take, from `words.tsv`: a row for each word, a column for each control.
//!
//! A cell is `+` (as LinuxCNC), `-` (refused), `o` (passed over), `~` (read differently), `=` (read differently, and so by the
//! decoder for that control) or `?` (unknown; with another sign behind it: probable), and a reason.

use super::Control;
use std::collections::HashMap;
use std::sync::LazyLock;

/// What a control does with a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// The same as LinuxCNC.
    Same,
    /// An error or alarm.
    Refused,
    /// Nothing.
    PassedOver,
    /// Something else.
    Different,
    /// Something else, which the decoder does too if it reads for this control.
    Followed,
    /// No source says.
    Unknown,
}

/// A cell of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// What the control does.
    pub reading: Reading,
    /// False if it is only probable.
    pub certain: bool,
    /// The reason, or what it does instead; may be empty.
    pub reason: &'static str,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct ControlWord {
    /// A word such as `G81`, words such as `G54-G59`, or what a program may contain.
    pub word: &'static str,
    /// For each control in the order of [`Control::ALL`].
    pub cells: [Cell; Control::ALL.len()],
    /// What LinuxCNC does with it.
    pub meaning: &'static str,
    /// How to write it for controls that refuse it; empty if unknown. [`Self::PATH`] if `twin path` writes a program without it.
    pub rewrite: &'static str,
}

impl ControlWord {
    /// [`Self::rewrite`] of words that are not part of a path.
    pub const PATH: &'static str = "path";

    fn of_line(line: &'static str) -> Option<Self> {
        let mut fields = line.split('\t');
        let word = fields.next()?;
        let mut cells =
            [Cell { reading: Reading::Unknown, certain: true, reason: "" }; Control::ALL.len()];
        for cell in &mut cells {
            *cell = Cell::of_text(fields.next()?)?;
        }
        Some(Self { word, cells, meaning: fields.next()?, rewrite: fields.next()? })
    }

    /// The cell of a control.
    pub fn cell(&self, control: Control) -> Option<Cell> {
        let column = Control::ALL.iter().position(|other| *other == control)?;
        self.cells.get(column).copied()
    }
}

impl Cell {
    fn of_text(text: &'static str) -> Option<Self> {
        let (certain, text) =
            text.strip_prefix("? ").map_or((true, text), |probable| (false, probable));
        let (sign, reason) = text.split_once(' ').unwrap_or((text, ""));
        let reading = match sign {
            "+" => Reading::Same,
            "-" => Reading::Refused,
            "o" => Reading::PassedOver,
            "~" => Reading::Different,
            "=" => Reading::Followed,
            "?" => Reading::Unknown,
            _ => return None,
        };
        Some(Self { reading, certain, reason })
    }
}

/// All rows, in the order of the book.
pub static CONTROL_WORDS: LazyLock<Vec<ControlWord>> = LazyLock::new(|| {
    include_str!("words.tsv").lines().skip(1).filter_map(ControlWord::of_line).collect()
});

/// Rows by each of their words.
static BY_WORD: LazyLock<HashMap<String, &'static ControlWord>> = LazyLock::new(|| {
    CONTROL_WORDS
        .iter()
        .flat_map(|row| words_of(row.word).into_iter().map(move |word| (word, row)))
        .collect()
});

/// The row of a word.
pub(in crate::rs274) fn row(word: &str) -> Option<&'static ControlWord> {
    BY_WORD.get(word).copied()
}

/// `G54-G59` are six words.
fn words_of(text: &str) -> Vec<String> {
    let range = text.split_once('-').and_then(|(first, last)| {
        let letter = first.get(..1)?;
        let numbers =
            first.get(1..)?.parse::<u16>().ok()?..=last.strip_prefix(letter)?.parse().ok()?;
        Some(numbers.map(|number| format!("{letter}{number}")).collect())
    });
    range.unwrap_or_else(|| vec![text.to_owned()])
}
