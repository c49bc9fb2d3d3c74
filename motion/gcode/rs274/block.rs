//! Block: the words of one line.

use super::error::{DecodeError, Problem};
use super::flow::FlowError;
use super::message::Message;
use super::parameters::Target;
use super::word::{CodeError, GWords, MWords};
use std::ops::Range;

/// A letter with a number, other than G, M, N and O.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Letter(u8);

/// A set of letters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Letters(u32);

impl Letter {
    pub(super) const A: Self = Self(0);
    pub(super) const B: Self = Self(1);
    pub(super) const C: Self = Self(2);
    pub(super) const D: Self = Self(3);
    pub(super) const E: Self = Self(4);
    pub(super) const F: Self = Self(5);
    pub(super) const H: Self = Self(7);
    pub(super) const I: Self = Self(8);
    pub(super) const J: Self = Self(9);
    pub(super) const K: Self = Self(10);
    pub(super) const L: Self = Self(11);
    pub(super) const P: Self = Self(15);
    pub(super) const Q: Self = Self(16);
    pub(super) const R: Self = Self(17);
    pub(super) const S: Self = Self(18);
    pub(super) const T: Self = Self(19);
    pub(super) const U: Self = Self(20);
    pub(super) const V: Self = Self(21);
    pub(super) const W: Self = Self(22);
    pub(super) const X: Self = Self(23);
    pub(super) const Y: Self = Self(24);
    pub(super) const Z: Self = Self(25);
    /// `@`: distance from the origin.
    pub(super) const RADIUS: Self = Self(26);
    /// `^`: angle about the origin.
    pub(super) const ANGLE: Self = Self(27);
    /// `$`: number of the spindle.
    pub(super) const SPINDLE: Self = Self(28);

    /// The axes in the order of coordinates.
    pub(super) const AXES: [Self; 9] =
        [Self::X, Self::Y, Self::Z, Self::A, Self::B, Self::C, Self::U, Self::V, Self::W];
    /// The words of an arc's centre in the order of coordinates.
    pub(super) const CENTER: [Self; 3] = [Self::I, Self::J, Self::K];

    /// The letter of an ASCII letter in upper case, `@`, `^` or `$`.
    const fn new(upper: u8) -> Self {
        match upper {
            b'@' => Self::RADIUS,
            b'^' => Self::ANGLE,
            b'$' => Self::SPINDLE,
            _ => Self(upper.wrapping_sub(b'A') % 26),
        }
    }

    pub(super) fn as_char(self) -> char {
        match self {
            Self::RADIUS => '@',
            Self::ANGLE => '^',
            Self::SPINDLE => '$',
            Self(index) => char::from(b'A' + index),
        }
    }

    fn index(self) -> usize {
        usize::from(self.0)
    }

    const fn bit(self) -> u32 {
        1 << self.0
    }
}

impl Letters {
    /// The words that are executed.
    const KNOWN: Self = Self::AXES.with(Self::of("DEFHIJKLPQRST$"));
    pub(super) const LINEAR: Self = Letters::of("XYZ");
    pub(super) const ROTARY: Self = Letters::of("ABC");
    pub(super) const PARALLEL: Self = Letters::of("UVW");
    /// The axes that are extra axes of the path.
    pub(super) const EXTRA: Self = Self::ROTARY.with(Self::PARALLEL);
    pub(super) const CENTER: Self = Self::of("IJK");
    pub(super) const POLAR: Self = Letters::of("@^");
    pub(super) const AXES: Self = Self::LINEAR.with(Self::EXTRA).with(Self::POLAR);

    /// Those in `text`: ASCII letters in upper case, `@`, `^` and `$`.
    pub(super) const fn of(text: &str) -> Self {
        let (mut bits, mut index) = (0, 0);
        while index < text.len() {
            bits |= Letter::new(text.as_bytes()[index]).bit();
            index += 1;
        }
        Self(bits)
    }

    pub(super) const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    pub(super) const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// True if they have one in common.
    pub(super) const fn meets(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    pub(super) const fn contains(self, letter: Letter) -> bool {
        self.0 & letter.bit() != 0
    }

    /// The first of them in the alphabet.
    pub(super) fn first(self) -> Option<Letter> {
        u8::try_from(self.0.trailing_zeros()).ok().filter(|index| *index < 29).map(Letter)
    }
}

/// A parameter and its new value.
#[derive(Clone, Debug)]
pub(super) struct Assignment {
    pub(super) target: Target,
    pub(super) value: f64,
}

/// A line but for its comments.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    /// The N word.
    pub(super) number: Option<u32>,
    pub(super) g: GWords,
    pub(super) m: MWords,
    /// M98 or M99.
    pub(super) subroutine: Option<u16>,
    /// M words that LinuxCNC does not know, with their bytes.
    pub(super) other_m: Vec<(u16, Range<usize>)>,
    /// Parameters that are set.
    pub(super) assignments: Vec<Assignment>,
    /// The last comment, if it is a message.
    pub(super) message: Option<Message>,
    /// What not every control takes, with its first bytes, if the program is meant for one.
    pub(super) seen: Vec<(String, Range<usize>)>,
    present: Letters,
    values: [f64; 29],
    columns: [Range<usize>; 29],
    /// Number of M words.
    pub(super) m_count: u8,
    /// Bytes of the last G or M word.
    code: Option<Range<usize>>,
}

/// The largest number of M words in a line.
const MAX_M_WORDS: u8 = 4;

/// Numbers beyond this mean nothing, whatever their letter.
const MAX_NUMBER: f64 = 1e12;

/// How near a number must be to a whole one that is meant.
const WHOLE: f64 = 1e-4;

impl Block {
    /// Makes it an empty line.
    pub(super) fn clear(&mut self) {
        self.number = None;
        self.g = GWords::default();
        self.m = MWords::default();
        self.subroutine = None;
        self.other_m.clear();
        self.seen.clear();
        self.assignments.clear();
        self.message = None;
        self.present = Letters::default();
        self.m_count = 0;
        self.code = None;
    }

    /// True if nothing is in it.
    pub(super) fn is_empty(&self) -> bool {
        self.present == Letters::default()
            && self.g == GWords::default()
            && self.m == MWords::default()
            && self.subroutine.is_none()
            && self.other_m.is_empty()
            && self.assignments.is_empty()
            && self.message.is_none()
    }

    /// True if its only word, but for N, is an M word.
    pub(super) fn is_single_m(&self) -> bool {
        self.m_count == 1 && self.g == GWords::default() && self.present == Letters::default()
    }

    /// Its words with a number of their own.
    pub(super) fn letters(&self) -> Letters {
        self.present
    }

    /// The number of the word with this letter.
    pub(super) fn get(&self, letter: Letter) -> Option<f64> {
        self.present.contains(letter).then(|| self.values[letter.index()])
    }

    /// The block with the X of a radius for that of a diameter.
    pub(super) fn with_radius(&self) -> Self {
        let mut block = self.clone();
        block.scale(Letter::X, 0.5);
        block
    }

    /// The bytes of the word with this letter; those of the last one if it has been cleared since.
    pub(super) fn columns(&self, letter: Letter) -> Option<Range<usize>> {
        self.columns.get(letter.index()).cloned()
    }

    /// An error at the word with this letter; of the line as a whole if it is not in the block.
    pub(super) fn at(&self, letter: Letter, error: impl Into<DecodeError>) -> Problem {
        let columns = self.get(letter).and_then(|_| self.columns(letter));
        Problem { columns, error: error.into() }
    }

    /// `value`, which the word with this letter leads to, if it is in `range`; `unit` is its unit with a blank before it.
    ///
    /// # Errors
    /// [`DecodeError::OutOfRange`].
    pub(super) fn within(
        &self,
        letter: Letter,
        value: f64,
        range: [f64; 2],
        unit: &'static str,
    ) -> Result<f64, Problem> {
        let [min, max] = range;
        if (min..=max).contains(&value) {
            return Ok(value);
        }
        let name = letter.as_char();
        Err(self.at(letter, DecodeError::OutOfRange { letter: name, value, min, max, unit }))
    }

    /// The bytes of the last word with a number of its own; of the last G or M word if there is none.
    pub(super) fn last_columns(&self) -> Option<Range<usize>> {
        let present = (0..29).map(Letter).filter(|letter| self.present.contains(*letter));
        let last = present.filter_map(|letter| self.columns(letter)).max_by_key(|it| it.end);
        last.or_else(|| self.code.clone())
    }

    /// Multiplies the number of a word.
    pub(super) fn scale(&mut self, letter: Letter, factor: f64) {
        self.values[letter.index()] *= factor;
    }

    /// Leaves out words.
    pub(super) fn drop(&mut self, letters: Letters) {
        self.present = self.present.without(letters);
    }

    /// Gives the number of `from` to `to` instead, if it is there and the other one is not.
    pub(super) fn rename(&mut self, from: Letter, to: Letter) {
        let Some(value) = self.get(from).filter(|_| self.get(to).is_none()) else { return };
        self.values[to.index()] = value;
        self.columns[to.index()] = self.columns[from.index()].clone();
        self.present = self.present.without(Letters(from.bit())).with(Letters(to.bit()));
    }

    /// The same block with these coordinates in place of the polar ones.
    pub(super) fn with_coordinates(&self, x: f64, y: f64) -> Self {
        let mut block = self.clone();
        for (letter, value) in [(Letter::X, x), (Letter::Y, y)] {
            block.values[letter.index()] = value;
        }
        let coordinates = Letters::of("XY");
        block.present = block.present.without(Letters::POLAR).with(coordinates);
        block
    }

    /// Adds the word of an ASCII letter other than N and O, or returns its error.
    pub(super) fn add(
        &mut self,
        upper: u8,
        value: f64,
        columns: Range<usize>,
        strict: bool,
        problems: &mut Vec<Problem>,
    ) {
        if matches!(upper, b'G' | b'M') {
            self.code = Some(columns.clone());
        }
        let result = match upper {
            b'G' => self.add_g(value),
            b'M' => self.add_m(value, &columns, strict),
            _ => self.add_word(Letter::new(upper), value, &columns),
        };
        if let Err(error) = result {
            problems.push(Problem { columns: Some(columns), error });
        }
    }

    fn add_word(
        &mut self,
        letter: Letter,
        value: f64,
        columns: &Range<usize>,
    ) -> Result<(), DecodeError> {
        let name = letter.as_char();
        if !Letters::KNOWN.contains(letter) {
            return Err(DecodeError::UnsupportedLetter(name));
        }
        if self.present.contains(letter) {
            return Err(DecodeError::RepeatedWord(name));
        }
        if value.abs() > MAX_NUMBER {
            let (min, max) = (-MAX_NUMBER, MAX_NUMBER);
            return Err(DecodeError::OutOfRange { letter: name, value, min, max, unit: "" });
        }
        self.values[letter.index()] = value;
        self.columns[letter.index()] = columns.clone();
        self.present = self.present.with(Letters(letter.bit()));
        Ok(())
    }

    fn add_g(&mut self, value: f64) -> Result<(), DecodeError> {
        let unsupported = || DecodeError::UnsupportedCode { letter: 'G', number: value };
        // One decimal; the number may be off by a little.
        let tenths = whole_number(value * 10.0, 10.0 * WHOLE, 999).ok_or_else(unsupported)?;
        self.g.add(tenths).map_err(|error| match error {
            CodeError::Unsupported => unsupported(),
            CodeError::Conflict => DecodeError::Conflict { letter: 'G', number: value },
        })
    }

    fn add_m(
        &mut self,
        value: f64,
        columns: &Range<usize>,
        strict: bool,
    ) -> Result<(), DecodeError> {
        let unsupported = || DecodeError::UnsupportedCode { letter: 'M', number: value };
        self.m_count += 1;
        if self.m_count > MAX_M_WORDS {
            self.m_count = MAX_M_WORDS;
            return Err(DecodeError::TooManyMWords(MAX_M_WORDS));
        }
        let number = whole_number(value, WHOLE, 999).ok_or_else(unsupported)?;
        if matches!(number, 98 | 99) {
            let before = self.subroutine.replace(number);
            let conflict = DecodeError::Conflict { letter: 'M', number: value };
            return if before.is_none() { Ok(()) } else { Err(conflict) };
        }
        if !strict && !MWords::knows(number) {
            self.other_m.push((number, columns.clone()));
            return Ok(());
        }
        self.m.add(number).map_err(|error| match error {
            CodeError::Unsupported => unsupported(),
            CodeError::Conflict => DecodeError::Conflict { letter: 'M', number: value },
        })
    }

    /// Program and number of calls of M98; both 0 for M99.
    ///
    /// # Errors
    /// [`FlowError::MissingProgram`], [`FlowError::Beside`] and those of the numbers.
    pub(super) fn check_subroutine(&self, m: u16) -> Result<(u32, u32), Problem> {
        let used = if m == 98 { Letters::of("LP") } else { Letters::default() };
        let other = self.letters().without(used).first();
        let has_m = self.m != MWords::default() || !self.other_m.is_empty();
        let code = match (self.g == GWords::default(), !has_m) {
            (false, _) => Some('G'),
            (_, false) => Some('M'),
            _ => None,
        };
        if let Some(letter) = other.map(Letter::as_char).or(code) {
            // Without another word A is not in the block, and the error is of the line.
            return Err(self.at(other.unwrap_or(Letter::A), FlowError::Beside(letter)));
        }
        if m != 98 {
            return Ok((0, 0));
        }
        let program = self.whole_within(Letter::P, [0.0, MAX_PROGRAM])?;
        let program = program.ok_or(FlowError::MissingProgram)?;
        Ok((program, self.whole(Letter::L, 0)?.unwrap_or(1)))
    }

    /// Checks that the number `value` of a word of `code` is more than `limit`.
    ///
    /// # Errors
    /// [`DecodeError::TooSmall`], at the word if it is in the block.
    pub(super) fn check_above(
        &self,
        code: &str,
        letter: Letter,
        value: f64,
        limit: f64,
    ) -> Result<(), Problem> {
        if value > limit {
            return Ok(());
        }
        let (code, name) = (code.to_owned(), letter.as_char());
        Err(self.at(letter, DecodeError::TooSmall { code, letter: name, value, limit }))
    }

    /// The number of a word that takes whole numbers of at least `min`; `None` if it is not there.
    ///
    /// # Errors
    /// [`DecodeError::NotWhole`] and [`DecodeError::OutOfRange`].
    pub(super) fn whole(&self, letter: Letter, min: u32) -> Result<Option<u32>, Problem> {
        self.whole_within(letter, [f64::from(min), MAX_COUNT])
    }

    /// The same for numbers in `range`, which must not be below 0.
    pub(super) fn whole_within(
        &self,
        letter: Letter,
        range: [f64; 2],
    ) -> Result<Option<u32>, Problem> {
        let Some(value) = self.get(letter) else { return Ok(None) };
        let rounded = value.round();
        if (value - rounded).abs() > WHOLE {
            return Err(self.at(letter, DecodeError::NotWhole { letter: letter.as_char(), value }));
        }
        let whole = self.within(letter, rounded, range, "")?;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "checked above"
        )]
        Ok(Some(whole as u32))
    }
}

/// The largest P of M98: Fanuc's has the number of calls in it.
const MAX_PROGRAM: f64 = 99_999_999.0;

/// The largest number of tools, turns and repetitions.
const MAX_COUNT: f64 = 1e6;

/// `value` as a whole number from 0 to `max`, if it is one but for `tolerance`.
fn whole_number(value: f64, tolerance: f64, max: u16) -> Option<u16> {
    let rounded = value.round();
    if (value - rounded).abs() > tolerance || !(0.0..=f64::from(max)).contains(&rounded) {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked above")]
    Some(rounded as u16)
}
