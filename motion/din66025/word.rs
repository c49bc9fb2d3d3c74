//! Words: a letter and a number.

use super::error::DecodeError;
use std::ops::Range;

/// A word of a block.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Word {
    pub(super) letter: Letter,
    pub(super) value: f64,
    /// Bytes of the line.
    pub(super) columns: Range<usize>,
}

/// The letters that are executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Letter {
    /// Block number.
    N,
    /// Command.
    G,
    /// Target.
    X,
    /// Target.
    Y,
    /// Target.
    Z,
    /// Centre, x.
    I,
    /// Centre, y.
    J,
    /// Radius.
    R,
    /// Acceleration or, below zero, deceleration.
    E,
    /// Feed.
    F,
}

/// Beyond these no machine is meant, and the squares of lengths lose the micrometre.
const MAX_POSITION_MM: f64 = 1e6;
/// Flat arcs have centres far away.
const MAX_RADIUS_MM: f64 = 1e9;
const MAX_FEED_MM_PER_S: f64 = 1e6;
const MAX_ACCELERATION_MM_PER_S2: f64 = 1e9;

impl Letter {
    /// The letter `byte` is, whatever its case.
    ///
    /// # Errors
    /// [`DecodeError::LetterNotSupported`] and [`DecodeError::UnknownLetter`].
    pub(super) fn from_byte(byte: u8) -> Result<Self, DecodeError> {
        Ok(match byte.to_ascii_uppercase() {
            b'N' => Self::N,
            b'G' => Self::G,
            b'X' => Self::X,
            b'Y' => Self::Y,
            b'Z' => Self::Z,
            b'I' => Self::I,
            b'J' => Self::J,
            b'R' => Self::R,
            b'E' => Self::E,
            b'F' => Self::F,
            upper @ (b'D' | b'H' | b'K' | b'L' | b'M' | b'O' | b'P' | b'Q' | b'S' | b'U' | b'V'
            | b'W') => {
                return Err(DecodeError::LetterNotSupported { letter: char::from(upper) });
            }
            upper => return Err(DecodeError::UnknownLetter { letter: char::from(upper) }),
        })
    }

    pub(super) fn as_char(self) -> char {
        match self {
            Self::N => 'N',
            Self::G => 'G',
            Self::X => 'X',
            Self::Y => 'Y',
            Self::Z => 'Z',
            Self::I => 'I',
            Self::J => 'J',
            Self::R => 'R',
            Self::E => 'E',
            Self::F => 'F',
        }
    }

    /// What is wrong with `value` as this letter's number, if anything.
    pub(super) fn check(self, value: f64) -> Option<DecodeError> {
        let letter = self.as_char();
        let (min, max, unit) = match self {
            Self::N | Self::G if value.is_finite() && value.fract() != 0.0 => {
                return Some(DecodeError::NotWhole { letter, value });
            }
            Self::N => (0.0, f64::from(u32::MAX), ""),
            // Which numbers there are is Command's to say.
            Self::G => return None,
            Self::F if value <= 0.0 => return Some(DecodeError::NonPositiveFeed { value }),
            Self::F => (0.0, MAX_FEED_MM_PER_S, " mm/s"),
            Self::E if value == 0.0 => return Some(DecodeError::ZeroAcceleration),
            Self::E => (-MAX_ACCELERATION_MM_PER_S2, MAX_ACCELERATION_MM_PER_S2, " mm/s²"),
            Self::X | Self::Y | Self::Z => (-MAX_POSITION_MM, MAX_POSITION_MM, " mm"),
            Self::I | Self::J | Self::R => (-MAX_RADIUS_MM, MAX_RADIUS_MM, " mm"),
        };
        let inside = value >= min && value <= max;
        (!inside).then_some(DecodeError::OutOfRange { letter, value, min, max, unit })
    }
}

/// A motion, G0 to G3: what repeats in blocks without a G word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    /// G0.
    Rapid,
    /// G1.
    Line,
    /// G2 or G3.
    Arc {
        /// G2.
        clockwise: bool,
    },
}

impl Motion {
    /// The number after G.
    pub(super) fn number(self) -> u8 {
        match self {
            Self::Rapid => 0,
            Self::Line => 1,
            Self::Arc { clockwise: true } => 2,
            Self::Arc { clockwise: false } => 3,
        }
    }
}

/// What a G word asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Command {
    /// G0 to G3.
    Motion(Motion),
    /// G90, G91: targets are absolute, or relative to the present position.
    Targets {
        /// G91.
        relative: bool,
    },
    /// G92.
    SetPosition,
    /// G98, G99: I and J are absolute, or relative to the start of the arc.
    Centers {
        /// G99.
        relative: bool,
    },
}

impl Command {
    /// The command of `G<number>`.
    ///
    /// # Errors
    /// [`DecodeError::CommandNotSupported`] and [`DecodeError::UnknownCommand`].
    pub(super) fn from_number(number: f64) -> Result<Self, DecodeError> {
        let unknown = DecodeError::UnknownCommand { number };
        if !(0.0..=99.0).contains(&number) {
            return Err(unknown);
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "it is 0 to 99"
        )]
        let code = number as u8;
        Ok(match code {
            0 => Self::Motion(Motion::Rapid),
            1 => Self::Motion(Motion::Line),
            2 => Self::Motion(Motion::Arc { clockwise: true }),
            3 => Self::Motion(Motion::Arc { clockwise: false }),
            90 => Self::Targets { relative: false },
            91 => Self::Targets { relative: true },
            92 => Self::SetPosition,
            98 => Self::Centers { relative: false },
            99 => Self::Centers { relative: true },
            5 | 6 | 8 | 9 | 20 | 36 | 37 | 40..=42 | 50..=52 | 60 | 61 => {
                return Err(DecodeError::CommandNotSupported { number: code });
            }
            _ => return Err(unknown),
        })
    }

    /// The number after G.
    pub(super) fn number(self) -> u8 {
        match self {
            Self::Motion(motion) => motion.number(),
            Self::Targets { relative: false } => 90,
            Self::Targets { relative: true } => 91,
            Self::SetPosition => 92,
            Self::Centers { relative: false } => 98,
            Self::Centers { relative: true } => 99,
        }
    }
}
