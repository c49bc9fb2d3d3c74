//! A block: what its words store, from right to left.

use super::error::{DecodeError, Problem};
use super::word::{Command, Letter, Word};
use std::ops::Range;

/// What the words of a block stored, in the units of the program.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Block {
    /// The N word.
    pub(super) number: Option<u32>,
    pub(super) command: Option<Command>,
    /// X, Y, Z, mm.
    pub(super) target: [Option<f64>; 3],
    /// I, J, mm.
    pub(super) center: [Option<f64>; 2],
    /// R, mm.
    pub(super) radius: Option<f64>,
    /// F, mm/s.
    pub(super) feed: Option<f64>,
    /// E above zero, mm/s².
    pub(super) acceleration: Option<f64>,
    /// E below zero without its sign, mm/s².
    pub(super) deceleration: Option<f64>,
}

impl Block {
    /// Executes `words` from right to left.
    pub(super) fn new(words: &[Word], problems: &mut Vec<Problem>) -> Self {
        let mut block = Self::default();
        let words = match words {
            [Word { letter: Letter::N, value, .. }, rest @ ..] => {
                block.number = Some(block_number(*value));
                rest
            }
            _ => words,
        };
        let (first, words) = match words {
            [first @ Word { letter: Letter::G, .. }, rest @ ..] => (Some(first), rest),
            _ => (None, words),
        };
        for word in words.iter().rev() {
            block.store(word, first.map(|first| first.value), problems);
        }
        if let Some(Word { value, columns, .. }) = first {
            match Command::from_number(*value) {
                Ok(command) => block.command = Some(command),
                Err(error) => problems.push(Problem { columns: columns.clone(), error }),
            }
        }
        block
    }

    fn store(&mut self, word: &Word, first_g: Option<f64>, problems: &mut Vec<Problem>) {
        let [x, y, z] = &mut self.target;
        let [i, j] = &mut self.center;
        let variable = match word.letter {
            Letter::X => x,
            Letter::Y => y,
            Letter::Z => z,
            Letter::I => i,
            Letter::J => j,
            Letter::R => &mut self.radius,
            Letter::F => &mut self.feed,
            Letter::E if word.value < 0.0 => {
                self.deceleration = Some(-word.value);
                return;
            }
            Letter::E => &mut self.acceleration,
            Letter::N | Letter::G => {
                let number = word.value;
                let error = match (word.letter, first_g) {
                    (Letter::N, _) => DecodeError::MisplacedN { number },
                    (_, Some(first)) => DecodeError::SecondG { first, second: number },
                    (_, None) => DecodeError::MisplacedG { number },
                };
                problems.push(Problem { columns: word.columns.clone(), error });
                return;
            }
        };
        *variable = Some(word.value);
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "Letter::check lets only whole u32 pass"
)]
fn block_number(value: f64) -> u32 {
    value as u32
}

/// The bytes to point at for the words of `letters`: from the first to the last of them, or of all words if there are
/// none.
pub(super) fn columns_of(words: &[Word], letters: &[Letter]) -> Range<usize> {
    let span = |mut words: &mut dyn Iterator<Item = &Word>| {
        let first = words.next()?;
        let last = (&mut words).last().unwrap_or(first);
        Some(first.columns.start..last.columns.end)
    };
    span(&mut words.iter().filter(|word| letters.contains(&word.letter)))
        .or_else(|| span(&mut words.iter()))
        .unwrap_or_default()
}
