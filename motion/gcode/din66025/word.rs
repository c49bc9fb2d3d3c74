//! Words of the language: letters, numbers and their ranges.

use super::error::DecodeError;
use std::ops::Range;
use twin_path::Marks;

/// A word of a block.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Word {
    pub(super) letter: Letter,
    /// Its number, or that of its variable; 0 for the name of something that has none.
    pub(super) value: f64,
    /// Bytes of the line.
    pub(super) columns: Range<usize>,
    /// The name of a variable stands in place of a number.
    pub(super) named: bool,
}

impl Word {
    /// The name in place of its number, if it has one: bytes of the line.
    pub(super) fn name(&self) -> Option<Range<usize>> {
        // A letter and $ before it, $ behind it.
        self.named.then(|| self.columns.start + 2..self.columns.end - 1)
    }
}

/// The letters of the language (manual 3.2).
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
    /// Target of an extra axis.
    P,
    /// Target of an extra axis.
    Q,
    /// Target of an extra axis.
    U,
    /// Target of an extra axis.
    V,
    /// Target of an extra axis.
    W,
    /// Centre or intersection of tangents, x.
    I,
    /// Centre or intersection of tangents, y.
    J,
    /// Direction of the ellipse, condition of a jump, parameter of an M function.
    K,
    /// Place of a switch, target of a jump, parameter of an M function.
    L,
    /// Radius, or ratio of the axes of an ellipse.
    R,
    /// Tool radius, or value for a variable.
    D,
    /// Acceleration or, below zero, deceleration.
    E,
    /// Feed.
    F,
    /// Switch.
    H,
    /// Auxiliary function.
    M,
    /// Place of a switch, variable to change, parameters of an M function.
    O,
    /// S profile of an axis.
    S,
}

/// True if there are no decimals; faster than asking for them.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::float_cmp,
    reason = "what does not survive the way there and back is not whole, or large and therefore whole"
)]
fn is_whole(value: f64) -> bool {
    value as i64 as f64 == value || value.abs() >= 1e18
}

/// Beyond these no machine is meant, and the squares of lengths lose the micrometre.
const MAX_POSITION_MM: f64 = 1e6;
/// Flat arcs have centres far away.
const MAX_RADIUS_MM: f64 = 1e9;
const MAX_FEED_MM_PER_S: f64 = 1e6;
const MAX_ACCELERATION_MM_PER_S2: f64 = 1e9;
/// What has no unit may be any number that is still exact to the thousandth.
const MAX_NUMBER: f64 = 1e12;

/// The letters from A to Z.
const LETTERS: [Option<Letter>; 26] = [
    None,
    None,
    None,
    Some(Letter::D),
    Some(Letter::E),
    Some(Letter::F),
    Some(Letter::G),
    Some(Letter::H),
    Some(Letter::I),
    Some(Letter::J),
    Some(Letter::K),
    Some(Letter::L),
    Some(Letter::M),
    Some(Letter::N),
    Some(Letter::O),
    Some(Letter::P),
    Some(Letter::Q),
    Some(Letter::R),
    Some(Letter::S),
    None,
    Some(Letter::U),
    Some(Letter::V),
    Some(Letter::W),
    Some(Letter::X),
    Some(Letter::Y),
    Some(Letter::Z),
];

impl Letter {
    /// The letter `byte` is, whatever its case.
    ///
    /// # Errors
    /// [`DecodeError::UnknownLetter`].
    #[inline]
    pub(super) fn from_byte(byte: u8) -> Result<Self, DecodeError> {
        let upper = byte.to_ascii_uppercase();
        let index = usize::from(upper.wrapping_sub(b'A'));
        let known = LETTERS.get(index).copied().flatten();
        known.ok_or_else(|| DecodeError::UnknownLetter { letter: char::from(upper) })
    }

    /// True for the letters that say where to go.
    pub(super) const fn is_target(self) -> bool {
        matches!(
            self,
            Self::X | Self::Y | Self::Z | Self::P | Self::Q | Self::U | Self::V | Self::W
        )
    }

    pub(super) fn as_char(self) -> char {
        match self {
            Self::N => 'N',
            Self::G => 'G',
            Self::X => 'X',
            Self::Y => 'Y',
            Self::Z => 'Z',
            Self::P => 'P',
            Self::Q => 'Q',
            Self::U => 'U',
            Self::V => 'V',
            Self::W => 'W',
            Self::I => 'I',
            Self::J => 'J',
            Self::K => 'K',
            Self::L => 'L',
            Self::R => 'R',
            Self::D => 'D',
            Self::E => 'E',
            Self::F => 'F',
            Self::H => 'H',
            Self::M => 'M',
            Self::O => 'O',
            Self::S => 'S',
        }
    }

    /// Error of `value` as this letter's number, if any.
    #[inline]
    pub(super) fn check(self, value: f64) -> Option<DecodeError> {
        let letter = self.as_char();
        let (min, max, unit) = match self {
            Self::N | Self::G | Self::H | Self::M | Self::S
                if value.is_finite() && !is_whole(value) =>
            {
                return Some(DecodeError::NotWhole { letter, value });
            }
            Self::N => (0.0, f64::from(u32::MAX), ""),
            Self::H if value == 0.0 || value.abs() > f64::from(SWITCHES) => {
                return Some(DecodeError::SwitchNumber { value });
            }
            // Which commands there are is Command's to say.
            Self::G | Self::H => return None,
            Self::S => {
                return (!(3.0..=11.0).contains(&value.abs()) || (4.0..7.0).contains(&value.abs()))
                    .then_some(DecodeError::ProfileAxis { value });
            }
            Self::M => (0.0, f64::from(u16::MAX), ""),
            Self::F if value <= 0.0 => return Some(DecodeError::NonPositiveFeed { value }),
            Self::F => (0.0, MAX_FEED_MM_PER_S, " mm/s"),
            Self::E if value == 0.0 => return Some(DecodeError::ZeroAcceleration),
            Self::E => (-MAX_ACCELERATION_MM_PER_S2, MAX_ACCELERATION_MM_PER_S2, " mm/s²"),
            Self::X | Self::Y | Self::Z => (-MAX_POSITION_MM, MAX_POSITION_MM, " mm"),
            Self::P | Self::Q | Self::U | Self::V | Self::W => {
                (-MAX_POSITION_MM, MAX_POSITION_MM, "")
            }
            Self::I | Self::J | Self::R => (-MAX_RADIUS_MM, MAX_RADIUS_MM, " mm"),
            Self::K | Self::L | Self::O | Self::D => (-MAX_NUMBER, MAX_NUMBER, ""),
        };
        let inside = value >= min && value <= max;
        (!inside).then_some(DecodeError::OutOfRange { letter, value, min, max, unit })
    }
}

/// Switches there are (manual 6.2.9: `dwSwitches`).
pub(super) const SWITCHES: u8 = 32;

/// A path command: what repeats in blocks without a G word.
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
    /// G5.
    Spline,
    /// G6.
    Parabola,
    /// G8 or G9.
    Ellipse {
        /// G8.
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
            Self::Spline => 5,
            Self::Parabola => 6,
            Self::Ellipse { clockwise: true } => 8,
            Self::Ellipse { clockwise: false } => 9,
        }
    }

    /// The words it looks at besides its targets.
    pub(super) fn words(self) -> &'static [Letter] {
        match self {
            Self::Rapid | Self::Line | Self::Spline => &[],
            Self::Arc { .. } => &[Letter::I, Letter::J, Letter::R],
            Self::Parabola => &[Letter::I, Letter::J],
            Self::Ellipse { .. } => &[Letter::I, Letter::J, Letter::K, Letter::R],
        }
    }
}

/// Command of a G word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Command {
    /// G0 to G9.
    Motion(Motion),
    /// G20.
    Jump,
    /// G36, G37: a variable is set, or added to.
    Variable {
        /// G37.
        add: bool,
    },
    /// G40 to G42, G50 to G52, G60, G61: path preparation begins with the next object, or ends behind the last.
    Preparation {
        /// The number after G.
        number: u8,
        /// Marks for the next object; none for an end.
        starts: Marks,
        /// Marks for the last object; none for a beginning.
        ends: Marks,
    },
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
    /// [`DecodeError::UnknownCommand`].
    pub(super) fn from_number(number: f64) -> Result<Self, DecodeError> {
        let unknown = || DecodeError::UnknownCommand { number };
        if !(0.0..=99.0).contains(&number) {
            return Err(unknown());
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "it is 0 to 99"
        )]
        let code = number as u8;
        let begin = |starts| Self::Preparation { number: code, starts, ends: Marks::default() };
        let end = |ends| Self::Preparation { number: code, starts: Marks::default(), ends };
        Ok(match code {
            0 => Self::Motion(Motion::Rapid),
            1 => Self::Motion(Motion::Line),
            2 => Self::Motion(Motion::Arc { clockwise: true }),
            3 => Self::Motion(Motion::Arc { clockwise: false }),
            5 => Self::Motion(Motion::Spline),
            6 => Self::Motion(Motion::Parabola),
            8 => Self::Motion(Motion::Ellipse { clockwise: true }),
            9 => Self::Motion(Motion::Ellipse { clockwise: false }),
            20 => Self::Jump,
            36 => Self::Variable { add: false },
            37 => Self::Variable { add: true },
            40 => end(Marks::CORRECTION_END),
            41 => begin(Marks::CORRECTION_LEFT),
            42 => begin(Marks::CORRECTION_RIGHT),
            50 => end(Marks::CORNERS_END),
            51 => begin(Marks::SMOOTHING),
            52 => begin(Marks::ROUNDING),
            60 => end(Marks::LOOPS_END),
            61 => begin(Marks::LOOPS),
            90 => Self::Targets { relative: false },
            91 => Self::Targets { relative: true },
            92 => Self::SetPosition,
            98 => Self::Centers { relative: false },
            99 => Self::Centers { relative: true },
            _ => return Err(unknown()),
        })
    }

    /// The number after G.
    pub(super) fn number(self) -> u8 {
        match self {
            Self::Motion(motion) => motion.number(),
            Self::Jump => 20,
            Self::Variable { add: false } => 36,
            Self::Variable { add: true } => 37,
            Self::Preparation { number, .. } => number,
            Self::Targets { relative: false } => 90,
            Self::Targets { relative: true } => 91,
            Self::SetPosition => 92,
            Self::Centers { relative: false } => 98,
            Self::Centers { relative: true } => 99,
        }
    }
}
