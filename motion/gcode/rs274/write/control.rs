//! Words of the controls.
//!
//! Sources: LinuxCNC 2.9's documentation; `gcode.c` of grbl 1.1, of grblHAL and of FluidNC 3; Fanuc's operator's manuals
//! (series 0i and 15i); Mach3's manual of the mill. M7 of grbl needs a build option and counts as missing.

use crate::rs274::Control;

impl Control {
    /// The lines before the first move: modes that the program relies on.
    pub(super) fn header(self) -> &'static str {
        match self {
            Self::Fanuc => "G21\nG17 G90 G94 G40 G49 G80 G54\n",
            _ => "G21 G17 G90 G94 G91.1\nG40 G49 G80 G54\n",
        }
    }

    /// Decimals of lengths (mm) and angles (degrees).
    pub(super) fn decimals(self) -> usize {
        // More are lost in increments of a micrometre.
        if self == Self::Fanuc { 3 } else { 4 }
    }

    /// True if it has P, the turns of an arc.
    pub(super) fn has_turns(self) -> bool {
        matches!(self, Self::LinuxCnc | Self::GrblHal | Self::FluidNc)
    }

    /// True if it has A, B and C.
    pub(super) fn has_rotary_axes(self) -> bool {
        self != Self::Grbl
    }

    /// True if F counts degrees as mm where rotary axes move along with others.
    pub(super) fn adds_rotary_feed(self) -> bool {
        matches!(self, Self::GrblHal | Self::FluidNc | Self::Fanuc)
    }

    /// True if it has G38.2 to G38.5.
    pub(super) fn has_probing(self) -> bool {
        !matches!(self, Self::Fanuc | Self::Mach3)
    }

    /// True if it has the M function `number`.
    pub(super) fn has_m(self, number: u16) -> bool {
        match number {
            0 | 1 | 3..=5 | 8 | 9 => true,
            6 | 7 => self != Self::Grbl,
            19 => matches!(self, Self::LinuxCnc | Self::Fanuc),
            60 => matches!(self, Self::LinuxCnc | Self::GrblHal),
            62..=68 => matches!(self, Self::LinuxCnc | Self::GrblHal | Self::FluidNc),
            100..=199 => matches!(self, Self::LinuxCnc | Self::Mach3),
            _ => false,
        }
    }

    /// True if it takes an arc with these radii at its ends, mm, that LinuxCNC takes in a program in mm.
    pub(super) fn takes_radii(self, radius: f64, end_radius: f64) -> bool {
        // grbl's rule, the strictest one that is known.
        let difference = (radius - end_radius).abs();
        self == Self::LinuxCnc
            || difference <= 0.005
            || (difference <= 0.5 && difference <= 1e-3 * radius)
    }
}
