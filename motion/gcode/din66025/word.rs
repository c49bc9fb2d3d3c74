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
    /// The name of a variable is in place of a number.
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
#[repr(u8)]
pub(super) enum Letter {
    /// Block number.
    N = b'N',
    /// Command.
    G = b'G',
    /// Target.
    X = b'X',
    /// Target.
    Y = b'Y',
    /// Target.
    Z = b'Z',
    /// Target of an extra axis.
    P = b'P',
    /// Target of an extra axis.
    Q = b'Q',
    /// Target of an extra axis.
    U = b'U',
    /// Target of an extra axis.
    V = b'V',
    /// Target of an extra axis.
    W = b'W',
    /// Centre or intersection of tangents, x.
    I = b'I',
    /// Centre or intersection of tangents, y.
    J = b'J',
    /// Direction of the ellipse, condition of a jump, parameter of an M function.
    K = b'K',
    /// Place of a switch, target of a jump, parameter of an M function.
    L = b'L',
    /// Radius, or ratio of the axes of an ellipse.
    R = b'R',
    /// Tool radius, or value for a variable.
    D = b'D',
    /// Acceleration or, below zero, deceleration.
    E = b'E',
    /// Feed.
    F = b'F',
    /// Switch.
    H = b'H',
    /// Auxiliary function.
    M = b'M',
    /// Place of a switch, variable to change, parameters of an M function.
    O = b'O',
    /// S profile of an axis.
    S = b'S',
}

/// True if the value has no decimals; faster than `fract`.
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

/// The letters in the order of the alphabet.
const LETTERS: [Letter; 22] = {
    use Letter::{D, E, F, G, H, I, J, K, L, M, N, O, P, Q, R, S, U, V, W, X, Y, Z};
    [D, E, F, G, H, I, J, K, L, M, N, O, P, Q, R, S, U, V, W, X, Y, Z]
};

impl Letter {
    /// The letter `byte` is, whatever its case.
    ///
    /// # Errors
    /// [`DecodeError::UnknownLetter`].
    #[inline]
    pub(super) fn from_byte(byte: u8) -> Result<Self, DecodeError> {
        let upper = byte.to_ascii_uppercase();
        let index = LETTERS.binary_search_by_key(&upper, |letter| *letter as u8);
        let known = index.ok().and_then(|index| LETTERS.get(index).copied());
        known.ok_or_else(|| DecodeError::UnknownLetter(char::from(upper)))
    }

    /// True for the letters that say where to go.
    pub(super) const fn is_target(self) -> bool {
        matches!(
            self,
            Self::X | Self::Y | Self::Z | Self::P | Self::Q | Self::U | Self::V | Self::W
        )
    }

    pub(super) fn as_char(self) -> char {
        char::from(self as u8)
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
                return Some(DecodeError::SwitchNumber(value));
            }
            // Which commands there are is Command's to say.
            Self::G | Self::H => return None,
            Self::S => {
                return (!(3.0..=11.0).contains(&value.abs()) || (4.0..7.0).contains(&value.abs()))
                    .then_some(DecodeError::ProfileAxis(value));
            }
            Self::M => (0.0, f64::from(u16::MAX), ""),
            Self::F if value <= 0.0 => return Some(DecodeError::NonPositiveFeed(value)),
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
        Command::Motion(self).number()
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

/// Every command and the number after G.
const COMMANDS: [(u8, Command); 24] = {
    use Command::{Centers, Jump, SetPosition, Targets, Variable};
    const fn motion(motion: Motion) -> Command {
        Command::Motion(motion)
    }
    const NONE: Marks = Marks(0);
    const fn begin(number: u8, starts: Marks) -> (u8, Command) {
        (number, Command::Preparation { number, starts, ends: NONE })
    }
    const fn end(number: u8, ends: Marks) -> (u8, Command) {
        (number, Command::Preparation { number, starts: NONE, ends })
    }
    [
        (0, motion(Motion::Rapid)),
        (1, motion(Motion::Line)),
        (2, motion(Motion::Arc { clockwise: true })),
        (3, motion(Motion::Arc { clockwise: false })),
        (5, motion(Motion::Spline)),
        (6, motion(Motion::Parabola)),
        (8, motion(Motion::Ellipse { clockwise: true })),
        (9, motion(Motion::Ellipse { clockwise: false })),
        (20, Jump),
        (36, Variable { add: false }),
        (37, Variable { add: true }),
        end(40, Marks::CORRECTION_END),
        begin(41, Marks::CORRECTION_LEFT),
        begin(42, Marks::CORRECTION_RIGHT),
        end(50, Marks::CORNERS_END),
        begin(51, Marks::SMOOTHING),
        begin(52, Marks::ROUNDING),
        end(60, Marks::LOOPS_END),
        begin(61, Marks::LOOPS),
        (90, Targets { relative: false }),
        (91, Targets { relative: true }),
        (92, SetPosition),
        (98, Centers { relative: false }),
        (99, Centers { relative: true }),
    ]
};

impl Command {
    /// The command of `G<number>`.
    ///
    /// # Errors
    /// [`DecodeError::UnknownCommand`].
    #[expect(clippy::float_cmp, reason = "G words are whole numbers")]
    pub(super) fn from_number(number: f64) -> Result<Self, DecodeError> {
        let found = COMMANDS.iter().find(|(code, _)| f64::from(*code) == number);
        found.map(|(_, command)| *command).ok_or(DecodeError::UnknownCommand(number))
    }

    /// The number after G.
    pub(super) fn number(self) -> u8 {
        COMMANDS.iter().find(|(_, command)| *command == self).map_or(0, |(code, _)| *code)
    }
}
