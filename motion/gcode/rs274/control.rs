//! Controls that a program can be written for (`--for`).

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

    /// Its name on the command line and in machine files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::LinuxCnc => "linuxcnc",
            Self::Grbl => "grbl",
            Self::GrblHal => "grblhal",
            Self::FluidNc => "fluidnc",
            Self::Fanuc => "fanuc",
            Self::Mach3 => "mach3",
            Self::SoftMotion => "softmotion",
        }
    }
}

/// The name as its makers write it.
impl fmt::Display for Control {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LinuxCnc => "LinuxCNC",
            Self::Grbl => "grbl",
            Self::GrblHal => "grblHAL",
            Self::FluidNc => "FluidNC",
            Self::Fanuc => "Fanuc",
            Self::Mach3 => "Mach3",
            Self::SoftMotion => "SoftMotion",
        })
    }
}
