//! Controls that a program can be meant for (`--for`), and what they do not take as LinuxCNC does.

mod table;
mod words;

pub(super) use table::row;
pub use table::{CONTROL_WORDS, Cell, ControlWord, Reading};
pub(super) use words::{check, forgive, percent, unequal_radii};

use super::block::{Block, Letter, Letters};
use super::error::{DecodeError, Problem};
use super::settings::OffsetError;
use super::word::{Motion, OneShot, Spline};
use std::fmt;

/// A control whose dialect of RS274 is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Control {
    /// LinuxCNC 2.9.
    LinuxCnc,
    /// grbl 1.1.
    Grbl,
    /// grblHAL.
    GrblHal,
    /// FluidNC 3.
    FluidNc,
    /// Fanuc's milling controls, series 0i to 31i.
    Fanuc,
    /// Mach3 Mill.
    Mach3,
    /// CoDeSys SoftMotion 2.3, in its dialect of DIN 66025.
    SoftMotion,
}

impl Control {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::LinuxCnc,
        Self::Grbl,
        Self::GrblHal,
        Self::FluidNc,
        Self::Fanuc,
        Self::Mach3,
        Self::SoftMotion,
    ];

    /// The names on the command line and those that the makers write, in the order of the variants.
    const NAMES: [[&str; 2]; 7] = [
        ["linuxcnc", "LinuxCNC"],
        ["grbl", "grbl"],
        ["grblhal", "grblHAL"],
        ["fluidnc", "FluidNC"],
        ["fanuc", "Fanuc"],
        ["mach3", "Mach3"],
        ["softmotion", "SoftMotion"],
    ];

    /// Its name on the command line and in machine files.
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize][0]
    }

    /// Its name in messages.
    pub(super) const fn title(self) -> &'static str {
        Self::NAMES[self as usize][1]
    }
}

/// Numbers that a control reads differently, and the decoder with it.
impl Control {
    /// The number of a G word as LinuxCNC has it.
    pub(super) fn g_number(self, number: f64) -> f64 {
        match (self, number) {
            (Self::Mach3, 70.0 | 71.0) => number - 50.0,
            _ => number,
        }
    }

    /// True if it takes an arc with these radii at its ends, mm, that LinuxCNC takes in a program in mm.
    pub(in crate::rs274) fn takes_radii(self, radius: f64, end_radius: f64) -> bool {
        let difference = (radius - end_radius).abs();
        match self {
            Self::LinuxCnc => true,
            Self::Mach3 => difference <= 0.002,
            // Others have grbl's rule, or a looser one.
            _ => difference <= 0.005 || (difference <= 0.5 && difference <= 1e-3 * radius),
        }
    }

    /// Gives `block` the words of LinuxCNC. Mach3's G59 P1 to P9 are G54 to G59.3. Fanuc's G4 X is in seconds, K repeats
    /// canned cycles, and G5 P and G5.1 Q, which change how the control looks ahead, leave the path as it is.
    ///
    /// # Errors
    /// [`OffsetError::System`], and [`DecodeError::MissingWord`] of G5 and G5.1.
    pub(super) fn translate(self, block: &mut Block, motion: Motion) -> Result<(), Problem> {
        if self == Self::Mach3
            && block.g.system == Some(5)
            && let Some(number) = block.whole(Letter::P, 1)?
        {
            let system = u8::try_from(number).ok().filter(|number| *number <= 9);
            block.g.system = Some(system.ok_or(OffsetError::System(number))? - 1);
            block.drop(Letters::of("P"));
        }
        if self != Self::Fanuc {
            return Ok(());
        }
        let needed = match block.g.motion {
            Some(Motion::Spline(Spline::Cubic)) => {
                Some((Letter::P, "G5", "P10000 (on) or P0 (off)"))
            }
            Some(Motion::Spline(Spline::Quadratic)) => {
                Some((Letter::Q, "G5.1", "Q1 (on) or Q0 (off)"))
            }
            _ => None,
        };
        if let Some((letter, code, word)) = needed {
            block.get(letter).ok_or_else(|| DecodeError::missing(code, word))?;
            block.drop(Letters::of("PQRXYZ"));
            block.g.motion = None;
        }
        let dwells = block.g.one_shot == Some(OneShot::Dwell);
        if dwells && block.g.motion.is_none() {
            block.scale(Letter::X, 1e3);
            block.rename(Letter::X, Letter::P);
        }
        if matches!(block.g.motion.unwrap_or(motion), Motion::Cycle(_)) {
            block.rename(Letter::K, Letter::L);
        }
        Ok(())
    }

    /// True if F counts degrees as mm where rotary axes move along with others.
    pub(super) fn adds_rotary_feed(self) -> bool {
        matches!(self, Self::GrblHal | Self::FluidNc | Self::Fanuc)
    }

    /// P of a dwell, s.
    pub(super) fn seconds(self, p: f64) -> f64 {
        if self == Self::Fanuc { p * 1e-3 } else { p }
    }

    /// Program and number of calls of M98 P.
    pub(super) fn calls(self, (program, count): (u32, u32), has_l: bool) -> (u32, u32) {
        if self == Self::Fanuc && program > 9999 && !has_l {
            (program % 10_000, program / 10_000)
        } else {
            (program, count)
        }
    }
}

/// The name as its makers write it.
impl fmt::Display for Control {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.title())
    }
}

/// Something that a control does not take as LinuxCNC does.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlFinding {
    /// The control.
    pub control: Control,
    /// The word, or what it is.
    pub word: String,
    /// What the control does.
    pub cell: Cell,
    /// How to write it for this control; empty if unknown.
    pub rewrite: &'static str,
}

impl ControlFinding {
    /// What to do about it.
    pub(super) fn hint(&self) -> Option<String> {
        match (self.rewrite, self.control) {
            ("", _) => None,
            (ControlWord::PATH, Control::SoftMotion) => Some(
                "`twin path PROGRAM --for softmotion --format din66025` writes it without this word"
                    .to_owned(),
            ),
            (ControlWord::PATH, control) => Some(format!(
                "`twin path PROGRAM --for {} --format rs274` writes it without this word",
                control.name()
            )),
            (rewrite, _) => Some(rewrite.to_owned()),
        }
    }
}

impl fmt::Display for ControlFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { control, word, cell, .. } = self;
        let probably = if cell.certain { "" } else { "probably " };
        match (cell.reading, cell.reason) {
            (Reading::Different | Reading::Same | Reading::Followed, reason) => {
                write!(f, "{control} {probably}reads {word} differently: {reason}")
            }
            (Reading::Unknown, _) => write!(f, "it is not known what {control} does with {word}"),
            (Reading::PassedOver, "") => write!(f, "{control} {probably}passes over {word}"),
            (Reading::PassedOver, reason) => {
                write!(f, "{control} {probably}passes over {word}: {reason}")
            }
            (Reading::Refused, "") => write!(f, "{control} {probably}refuses {word}"),
            (Reading::Refused, reason) => write!(f, "{control} {probably}refuses {word}: {reason}"),
        }
    }
}
