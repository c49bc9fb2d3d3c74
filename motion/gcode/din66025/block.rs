//! Block of a program: evaluates its words from right to left.

use super::error::{DecodeError, Problem};
use super::word::{Command, Letter, Word};
use std::ops::Range;
use twin_path::{AxisMask, MAX_SWITCHES};

/// Values stored by the words of a block, in the units of the program.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Block {
    /// The N word.
    pub(super) number: Option<u32>,
    pub(super) command: Option<Command>,
    /// X Y Z (mm), P Q U V W (u).
    pub(super) target: [Option<f64>; 8],
    /// I, J, mm.
    pub(super) center: [Option<f64>; 2],
    /// R: mm, or a ratio.
    pub(super) radius: Option<f64>,
    /// K.
    pub(super) k: Option<f64>,
    /// L.
    pub(super) l: Option<f64>,
    /// O.
    pub(super) o: Option<Operand>,
    /// D: mm, or a value.
    pub(super) d: Option<f64>,
    /// F, mm/s.
    pub(super) feed: Option<f64>,
    /// E above zero, mm/s².
    pub(super) acceleration: Option<f64>,
    /// E below zero without its sign, mm/s².
    pub(super) deceleration: Option<f64>,
    /// M.
    pub(super) m: Option<f64>,
    /// H words, from right to left: with what L or O had stored by then.
    pub(super) switches: [Option<Request>; MAX_SWITCHES],
    /// S words: axes switched on, and off.
    pub(super) profiles: [AxisMask; 2],
}

/// An O word: a number, or the name of a variable (bytes of the line).
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Operand {
    Number(f64),
    Name(Range<usize>),
}

/// An H word.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Request {
    pub(super) number: f64,
    pub(super) at: Option<SwitchPlace>,
    pub(super) columns: Range<usize>,
}

/// Place of a switch along its object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SwitchPlace {
    /// L: mm from the start, or below zero from the end.
    Length(f64),
    /// O: a part of the length.
    Part(f64),
}

/// Errors and warnings of a block.
#[derive(Debug, Default)]
pub(super) struct Complaints {
    pub(super) problems: Vec<Problem>,
    pub(super) notes: Vec<Problem>,
}

impl Block {
    /// Executes `words` from right to left.
    pub(super) fn new(words: &[Word], complaints: &mut Complaints) -> Self {
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
        let mut place = None;
        for word in words.iter().rev() {
            block.store(word, first, &mut place, complaints);
        }
        if let Some(Word { value, columns, .. }) = first {
            match Command::from_number(*value) {
                Ok(command) => block.command = Some(command),
                Err(error) => complaints.problems.push(Problem { columns: columns.clone(), error }),
            }
        }
        block
    }

    /// `place` is what the L or O nearest on the right has stored for the next H.
    fn store(
        &mut self,
        word: &Word,
        first: Option<&Word>,
        place: &mut Option<SwitchPlace>,
        complaints: &mut Complaints,
    ) {
        let value = word.value;
        let [x, y, z, p, q, u, v, w] = &mut self.target;
        let [i, j] = &mut self.center;
        let variable = match word.letter {
            Letter::X => x,
            Letter::Y => y,
            Letter::Z => z,
            Letter::P => p,
            Letter::Q => q,
            Letter::U => u,
            Letter::V => v,
            Letter::W => w,
            Letter::I => i,
            Letter::J => j,
            Letter::K => &mut self.k,
            Letter::R => &mut self.radius,
            Letter::D => &mut self.d,
            Letter::F => &mut self.feed,
            Letter::M => &mut self.m,
            Letter::E if value < 0.0 => {
                let before = self.deceleration.replace(-value);
                return Self::warn_twice(before.is_some(), word, complaints);
            }
            Letter::E => &mut self.acceleration,
            Letter::L => {
                *place = Some(SwitchPlace::Length(value));
                self.l = Some(value);
                return;
            }
            Letter::O => {
                *place = Some(SwitchPlace::Part(value));
                self.o = Some(word.name().map_or(Operand::Number(value), Operand::Name));
                return;
            }
            Letter::H => return self.store_switch(word, *place, complaints),
            Letter::S => {
                let axis = profile_axis(value);
                let [on, off] = &mut self.profiles;
                let (into, out_of) = if value > 0.0 { (on, off) } else { (off, on) };
                *into = into.with(axis);
                *out_of = out_of.without(axis);
                return;
            }
            Letter::N | Letter::G => {
                let error = match (word.letter, first) {
                    (Letter::N, _) => DecodeError::MisplacedN(value),
                    (_, Some(first)) => DecodeError::SecondG { first: first.value, second: value },
                    (_, None) => DecodeError::MisplacedG(value),
                };
                complaints.problems.push(Problem { columns: word.columns.clone(), error });
                return;
            }
        };
        let before = variable.replace(value);
        Self::warn_twice(before.is_some(), word, complaints);
    }

    /// The leftmost of several words of a letter acts last.
    fn warn_twice(twice: bool, word: &Word, complaints: &mut Complaints) {
        if twice {
            let error =
                DecodeError::DuplicateWord { letter: word.letter.as_char(), value: word.value };
            complaints.notes.push(Problem { columns: word.columns.clone(), error });
        }
    }

    fn store_switch(&mut self, word: &Word, at: Option<SwitchPlace>, complaints: &mut Complaints) {
        let columns = word.columns.clone();
        if let Some(slot) = self.switches.iter_mut().find(|slot| slot.is_none()) {
            *slot = Some(Request { number: word.value, at, columns });
        } else {
            let error = DecodeError::TooManySwitches(MAX_SWITCHES);
            complaints.problems.push(Problem { columns, error });
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "Letter::check lets only whole u32 pass"
)]
pub(super) fn block_number(value: f64) -> u32 {
    value as u32
}

/// The axis of an S word, whatever its sign.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "Letter::check lets only 3 and 7 to 11 pass"
)]
fn profile_axis(value: f64) -> AxisMask {
    AxisMask::from_s_number(value.abs() as u8).unwrap_or_default()
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
