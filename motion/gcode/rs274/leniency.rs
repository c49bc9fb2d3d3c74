//! Leniency: what shops run although LinuxCNC refuses it. A warning with its count says so; it is an error with
//! [`DecoderOptions::strict`](super::DecoderOptions::strict).

use super::error::DecodeError;
use super::state::Feed;
use std::fmt;

/// Feed of a program that sets none, mm/min and degrees/min: slow, whatever is cut.
const FEED: f64 = 100.0;

/// Something that LinuxCNC refuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leniency {
    /// A file without M2, M30 or a second `%` at its end.
    NoEnd,
    /// `%` at the end, and none at the beginning.
    ClosingPercent,
    /// Coordinates before any word that says how to move.
    NoMotionWord,
    /// A motion with a feed before any F.
    NoFeed,
    /// I, J or K along the normal of an arc's plane.
    CenterOutsidePlane(char),
    /// An M word that LinuxCNC does not know.
    UnknownM(u16),
}

impl Leniency {
    /// Its error where it is refused.
    pub(super) fn refusal(self) -> DecodeError {
        match self {
            Self::NoEnd => DecodeError::MissingEnd,
            Self::ClosingPercent => DecodeError::MissingPercent,
            Self::NoMotionWord => DecodeError::AxesWithoutMotion,
            Self::NoFeed => DecodeError::MissingFeed,
            Self::CenterOutsidePlane(letter) => DecodeError::CenterOutsidePlane(letter),
            Self::UnknownM(number) => {
                DecodeError::UnsupportedCode { letter: 'M', number: number.into() }
            }
        }
    }
}

/// What is read instead.
impl fmt::Display for Leniency {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoEnd => {
                f.write_str("the program ends with its file, without M2, M30 or a second %")
            }
            Self::ClosingPercent => {
                f.write_str("the program ends with %, but does not begin with it")
            }
            Self::NoMotionWord => {
                f.write_str("coordinates before any motion word (G0, G1, ...) are read as G0")
            }
            Self::NoFeed => write!(
                f,
                "motion before any F is read with {FEED} mm/min: write F, or the sender sets another"
            ),
            Self::CenterOutsidePlane(letter) => {
                write!(f, "{letter} of an arc has no effect along the normal of its plane")
            }
            Self::UnknownM(number) => {
                write!(f, "M{number} is read as an M function at which the path waits")
            }
        }
    }
}

impl Feed {
    /// That of a program without F.
    pub(super) const ASSUMED: Self = Self { linear: FEED * 1e-3 / 60.0, rotary: FEED / 60.0 };
}
