//! The commands and their data.
//!
//! Source: "Description des commandes" and the sections after it. Errata: the frame of IOUPDATE is printed with code
//! 00h, which is RESET; GOTO with speed and acceleration has eight bytes of data and so is 63h; STEP stands in the
//! table only, here as GOTO; TRJRUN has no code.

use crate::RejectCode;

/// Modes of a device, "MODE".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// 0, power off.
    Off = 0,
    /// 1, special application.
    Custom = 1,
    /// 3, obeys the bus.
    Remote = 3,
    /// 4, position by the analog input.
    Position = 4,
    /// 5, speed, inputs GOP and GON.
    Velocity = 5,
    /// 6, speed, inputs GO and DIR.
    VelocityDirection = 6,
    /// 7, speed, inputs STARTP/STOPP and STARTN/STOPN.
    VelocityStartStop = 7,
    /// 8, speed, inputs START/STOP and DIR.
    VelocityStartStopDirection = 8,
    /// 9, fixed distance, inputs GOP and GON.
    Advance = 9,
    /// 10, fixed distance, inputs GO and DIR.
    AdvanceDirection = 10,
    /// 11, to and fro without switch.
    PushPull = 11,
    /// 12, to and fro with a home switch.
    PushPullHome = 12,
    /// 31, the mode is changing; not a mode to choose.
    Changing = 31,
}

impl Mode {
    /// All modes that can be chosen.
    pub const ALL: [Self; 12] = [
        Self::Off,
        Self::Custom,
        Self::Remote,
        Self::Position,
        Self::Velocity,
        Self::VelocityDirection,
        Self::VelocityStartStop,
        Self::VelocityStartStopDirection,
        Self::Advance,
        Self::AdvanceDirection,
        Self::PushPull,
        Self::PushPullHome,
    ];

    /// Number on the wire.
    pub fn number(self) -> u8 {
        self as u8
    }

    /// The mode with a number that can be chosen.
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| mode.number() == number)
    }
}

/// Effect of TRJINIT.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Init {
    /// 0, the generator, internal.
    All = 0,
    /// 1, the present position becomes 0.
    Position = 1,
    /// 2, homing.
    Homing = 2,
    /// 3, both encoders become 0 (from release 1.2.0.310, as the next two).
    Encoders = 3,
    /// 4, encoder 1 becomes 0.
    Encoder1 = 4,
    /// 5, encoder 2 becomes 0.
    Encoder2 = 5,
}

impl Init {
    /// All of them, by number.
    pub const ALL: [Self; 6] =
        [Self::All, Self::Position, Self::Homing, Self::Encoders, Self::Encoder1, Self::Encoder2];

    /// Number on the wire.
    pub fn number(self) -> u8 {
        self as u8
    }
}

/// Source of the parameters of LOAD.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadSource {
    /// 0, saved values.
    Saved,
    /// `FFFFh`, factory values.
    Factory,
}

/// Data of IOUPDATE; bits: 7 LIMN, 6 LIMP, 5 OFF, 4 DIR, 3 GO, 2 LED, 1 BRK, 0 RDY.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IoUpdate {
    /// Outputs to deactivate.
    pub clear: u8,
    /// Outputs to activate; one that is in both stays as it is.
    pub set: u8,
    /// Captures of active edges to clear.
    pub clear_active: u8,
    /// Captures of inverse edges to clear.
    pub clear_reverse: u8,
}

/// A command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// 00h: restarts the device; it stays in its bootloader if asked to.
    Reset {
        /// Stay in the bootloader.
        bootloader: bool,
    },
    /// 01h: position, state of the trajectory or alarms.
    Ping,
    /// 04h: chooses a mode, `None` the configured one (255).
    Mode(Option<Mode>),
    /// 05h: switches outputs, shows inputs and their edges.
    IoUpdate(IoUpdate),
    /// 4Eh: changes a variable.
    Write {
        /// Index.
        variable: u16,
        /// New value.
        value: u32,
    },
    /// 0Fh: reads a variable.
    Read {
        /// Index.
        variable: u16,
    },
    /// 11h: changes the working value of a parameter.
    Set {
        /// Index.
        parameter: u16,
        /// New value.
        value: u16,
    },
    /// 12h: reads saved, working and factory value of a parameter.
    Get {
        /// Index.
        parameter: u16,
    },
    /// 13h: saves the working values.
    Save,
    /// 14h: loads the working values.
    Load(LoadSource),
    /// 20h: trajectory generator.
    TrajectoryInit(Init),
    /// 21h: runs at a speed.
    Start {
        /// rpm, with sign.
        speed: i16,
        /// rpm/s, 0 for the largest.
        rate: u16,
    },
    /// 22h: stops.
    Stop {
        /// rpm/s, 0 for the largest.
        rate: u16,
    },
    /// 23h, 63h: goes to a position.
    GoTo {
        /// µsteps.
        target: i32,
        /// Speed limit, rpm, and acceleration, rpm/s, 0 for the largest; without them both are the largest (23h).
        profile: Option<(u16, u16)>,
    },
    /// 24h, 64h: goes a distance.
    Step {
        /// µsteps.
        distance: i32,
        /// As that of GOTO.
        profile: Option<(u16, u16)>,
    },
}

/// Codes CC.
const RESET: u8 = 0x00;
const PING: u8 = 0x01;
const MODE: u8 = 0x04;
const IOUPDATE: u8 = 0x05;
const WRITE: u8 = 0x0E;
const READ: u8 = 0x0F;
const SET: u8 = 0x11;
const GET: u8 = 0x12;
const SAVE: u8 = 0x13;
const LOAD: u8 = 0x14;
const TRJINIT: u8 = 0x20;
const START: u8 = 0x21;
const STOP: u8 = 0x22;
const GOTO: u8 = 0x23;
const STEP: u8 = 0x24;
/// EE = 1: eight bytes of data.
const EIGHT: u8 = 1 << 6;

impl Command {
    /// CMD: the code with the length of the data.
    pub fn code(&self) -> u8 {
        match self {
            Self::Reset { .. } => RESET,
            Self::Ping => PING,
            Self::Mode(_) => MODE,
            Self::IoUpdate(_) => IOUPDATE,
            Self::Write { .. } => EIGHT | WRITE,
            Self::Read { .. } => READ,
            Self::Set { .. } => SET,
            Self::Get { .. } => GET,
            Self::Save => SAVE,
            Self::Load(_) => LOAD,
            Self::TrajectoryInit(_) => TRJINIT,
            Self::Start { .. } => START,
            Self::Stop { .. } => STOP,
            Self::GoTo { profile: None, .. } => GOTO,
            Self::GoTo { .. } => EIGHT | GOTO,
            Self::Step { profile: None, .. } => STEP,
            Self::Step { .. } => EIGHT | STEP,
        }
    }

    /// Name in the manual.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Reset { .. } => "RESET",
            Self::Ping => "PING",
            Self::Mode(_) => "MODE",
            Self::IoUpdate(_) => "IOUPDATE",
            Self::Write { .. } => "WRITE",
            Self::Read { .. } => "READ",
            Self::Set { .. } => "SET",
            Self::Get { .. } => "GET",
            Self::Save => "SAVE",
            Self::Load(_) => "LOAD",
            Self::TrajectoryInit(_) => "TRJINIT",
            Self::Start { .. } => "START",
            Self::Stop { .. } => "STOP",
            Self::GoTo { .. } => "GOTO",
            Self::Step { .. } => "STEP",
        }
    }

    /// Whether a repeat does what once does: it may be sent again if its answer does not come.
    pub fn is_idempotent(&self) -> bool {
        matches!(
            self,
            Self::Ping
                | Self::Read { .. }
                | Self::Get { .. }
                | Self::GoTo { .. }
                | Self::Stop { .. }
        )
    }

    /// Whether it is accepted in [`Mode::Remote`] only.
    pub fn needs_remote(&self) -> bool {
        matches!(
            self,
            Self::TrajectoryInit(_)
                | Self::Start { .. }
                | Self::Stop { .. }
                | Self::GoTo { .. }
                | Self::Step { .. }
        )
    }

    /// The data, 4 or 8 bytes.
    pub fn data(&self) -> Vec<u8> {
        let first = |byte: u8| vec![byte, 0, 0, 0];
        let words = |low: u16, high: u16| [low.to_le_bytes(), high.to_le_bytes()].concat();
        match *self {
            Self::Reset { bootloader } => first(bootloader.into()),
            Self::Ping | Self::Save => first(0),
            Self::Mode(mode) => first(mode.map_or(255, Mode::number)),
            Self::IoUpdate(IoUpdate { clear, set, clear_active, clear_reverse }) => {
                vec![clear, set, clear_active, clear_reverse]
            }
            Self::Write { variable, value } => {
                [words(variable, 0), value.to_le_bytes().to_vec()].concat()
            }
            Self::Read { variable } => words(variable, 0),
            Self::Set { parameter, value } => words(parameter, value),
            Self::Get { parameter } => words(parameter, 0),
            Self::Load(LoadSource::Saved) => words(0, 0),
            Self::Load(LoadSource::Factory) => words(0xFFFF, 0),
            Self::TrajectoryInit(init) => first(init.number()),
            Self::Start { speed, rate } => words(speed.cast_unsigned(), rate),
            Self::Stop { rate } => words(0, rate),
            Self::GoTo { target: way, profile } | Self::Step { distance: way, profile } => {
                let profile = profile.map(|(speed, rate)| words(speed, rate));
                [way.to_le_bytes().to_vec(), profile.unwrap_or_default()].concat()
            }
        }
    }

    /// Lengths of the data that belong to CMD; `None` if the code does not exist.
    pub(crate) fn lengths(code: u8) -> Option<&'static [usize]> {
        match code & 0x3F {
            WRITE => Some(&[8]),
            GOTO | STEP => Some(&[4, 8]),
            RESET | PING | MODE | IOUPDATE | READ | SET..=LOAD | TRJINIT..=STOP => Some(&[4]),
            _ => None,
        }
    }

    /// Decodes CMD and data, whose length is that of CMD.
    ///
    /// # Errors
    /// The reason for which the device refuses it: an unknown code, a length that does not belong to the code (assumed
    /// to be a wrong parameter), a mode or operation that does not exist.
    pub fn decode(code: u8, data: &[u8]) -> Result<Self, RejectCode> {
        let known = Self::lengths(code).is_some();
        let code = code & 0x3F;
        match *data {
            _ if !known => Err(RejectCode::NotAvailable),
            [a, b, c, d] => Self::decode_four(code, [a, b, c, d]),
            [a, b, c, d, e, f, g, h] => {
                let (first, second) = ([a, b, c, d], [e, f, g, h]);
                let profile = Some((u16::from_le_bytes([e, f]), u16::from_le_bytes([g, h])));
                match code {
                    WRITE => Ok(Self::Write {
                        variable: u16::from_le_bytes([a, b]),
                        value: u32::from_le_bytes(second),
                    }),
                    GOTO => Ok(Self::GoTo { target: i32::from_le_bytes(first), profile }),
                    STEP => Ok(Self::Step { distance: i32::from_le_bytes(first), profile }),
                    _ => Err(RejectCode::BadParams),
                }
            }
            _ => Err(RejectCode::BadParams),
        }
    }

    fn decode_four(code: u8, data: [u8; 4]) -> Result<Self, RejectCode> {
        let [first, second, third, fourth] = data;
        let low = u16::from_le_bytes([first, second]);
        let high = u16::from_le_bytes([third, fourth]);
        let way = i32::from_le_bytes(data);
        let decoded = match code {
            RESET => Some(Self::Reset { bootloader: first == 1 }),
            PING => Some(Self::Ping),
            MODE if first == 255 => Some(Self::Mode(None)),
            MODE => Mode::from_number(first).map(|mode| Self::Mode(Some(mode))),
            IOUPDATE => Some(Self::IoUpdate(IoUpdate {
                clear: first,
                set: second,
                clear_active: third,
                clear_reverse: fourth,
            })),
            READ => Some(Self::Read { variable: low }),
            SET => Some(Self::Set { parameter: low, value: high }),
            GET => Some(Self::Get { parameter: low }),
            SAVE => Some(Self::Save),
            LOAD if low == 0 => Some(Self::Load(LoadSource::Saved)),
            LOAD if low == 0xFFFF => Some(Self::Load(LoadSource::Factory)),
            TRJINIT => {
                Init::ALL.into_iter().find(|init| init.number() == first).map(Self::TrajectoryInit)
            }
            START => Some(Self::Start { speed: low.cast_signed(), rate: high }),
            STOP => Some(Self::Stop { rate: high }),
            GOTO => Some(Self::GoTo { target: way, profile: None }),
            STEP => Some(Self::Step { distance: way, profile: None }),
            _ => None,
        };
        decoded.ok_or(RejectCode::BadParams)
    }
}
