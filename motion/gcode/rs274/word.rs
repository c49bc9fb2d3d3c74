//! Meaning of G and M words, and their modal groups.

use super::LengthUnit;
use super::offsets::Home;
use twin_path::{Plane, Probing};

/// Group 1: what the axis words of this line and the following ones do.
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
    /// G38.2 to G38.5.
    Probe(Probing),
    /// G33, G33.1 and G76.
    Thread(Thread),
    /// G73, G74 and G81 to G89.
    Cycle(Cycle),
    /// G80: nothing, axis words are errors.
    Off,
}

/// A canned cycle: the number after G.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cycle(pub(super) u16);

/// A motion that follows the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Thread {
    /// G33.
    Straight,
    /// G33.1.
    RigidTap,
    /// G76.
    Cycle,
}

/// Meaning of F.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum FeedMode {
    /// G94.
    #[default]
    PerMinute,
    /// G93.
    InverseTime,
    /// G95.
    PerRevolution,
}

impl Motion {
    /// The number after G.
    pub(super) fn number(self) -> f64 {
        match self {
            Self::Rapid => 0.0,
            Self::Line => 1.0,
            Self::Arc { clockwise: true } => 2.0,
            Self::Arc { clockwise: false } => 3.0,
            Self::Probe(probing) => probing.g_number(),
            Self::Thread(Thread::Straight) => 33.0,
            Self::Thread(Thread::RigidTap) => 33.1,
            Self::Thread(Thread::Cycle) => 76.0,
            Self::Cycle(Cycle(number)) => number.into(),
            Self::Off => 80.0,
        }
    }
}

/// Group 0: what holds for one line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OneShot {
    /// G4.
    Dwell,
    /// G10.
    SetData,
    /// G28 and G30.
    GoHome(Home),
    /// G28.1 and G30.1.
    SaveHome(Home),
    /// G52.
    LocalOffset,
    /// G53.
    MachineFrame,
    /// G92.
    SetPosition,
    /// G92.1.
    ClearOffset,
    /// G92.2.
    SuspendOffset,
    /// G92.3.
    RestoreOffset,
}

/// Group 7: cutter radius compensation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compensate {
    /// G40.
    Off,
    /// G41 (left), G42: diameter of a tool of the table.
    Tool { left: bool },
    /// G41.1 (left), G42.1: diameter D.
    Diameter { left: bool },
}

impl Compensate {
    /// The number after G.
    pub(super) fn number(self) -> f64 {
        match self {
            Self::Off => 40.0,
            Self::Tool { left: true } => 41.0,
            Self::Tool { left: false } => 42.0,
            Self::Diameter { left: true } => 41.1,
            Self::Diameter { left: false } => 42.1,
        }
    }
}

/// Group 8: tool offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ToolLength {
    /// G49.
    Off,
    /// G43: that of the tool table.
    Table,
    /// G43.1: the axis words.
    Direct,
    /// G43.2: that of the tool table, added to the offset in force.
    Added,
}

/// Work coordinate systems G54 to G59.3, in tenths.
const SYSTEMS: [u16; 9] = [540, 550, 560, 570, 580, 590, 591, 592, 593];

/// G words of a line but for their columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct GWords {
    pub(super) motion: Option<Motion>,
    pub(super) one_shot: Option<OneShot>,
    /// G92.1, G92.2 or G92.3.
    pub(super) g92_switch: Option<OneShot>,
    pub(super) plane: Option<Plane>,
    pub(super) units: Option<LengthUnit>,
    pub(super) compensation: Option<Compensate>,
    /// G43 to G43.2, G49.
    pub(super) tool_length: Option<ToolLength>,
    /// G54 to G59.3 as 0 to 8.
    pub(super) system: Option<u8>,
    /// G61 (true), G64.
    pub(super) exact_path: Option<bool>,
    /// G91 (true), G90.
    pub(super) relative: Option<bool>,
    /// G90.1 (true), G91.1.
    pub(super) absolute_centers: Option<bool>,
    /// G93 to G95.
    pub(super) feed_mode: Option<FeedMode>,
    /// G96 (true), G97.
    pub(super) surface_speed: Option<bool>,
    /// G7 (true), G8.
    pub(super) diameters: Option<bool>,
    /// G98 (true), G99.
    pub(super) initial_level: Option<bool>,
}

/// Error of a G or M word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CodeError {
    /// Not executed.
    Unsupported,
    /// Another one of its group is in the line already.
    Conflict,
}

/// Puts `value` into `slot`.
fn set<T>(slot: &mut Option<T>, value: T) -> Result<(), CodeError> {
    if slot.is_some() {
        return Err(CodeError::Conflict);
    }
    *slot = Some(value);
    Ok(())
}

impl GWords {
    /// Adds the G word whose number is `tenths` / 10.
    pub(super) fn add(&mut self, tenths: u16) -> Result<(), CodeError> {
        let shot = |words: &mut Self, shot| set(&mut words.one_shot, shot);
        match tenths {
            0 => self.motion(Motion::Rapid),
            10 => self.motion(Motion::Line),
            20 => self.motion(Motion::Arc { clockwise: true }),
            30 => self.motion(Motion::Arc { clockwise: false }),
            382 => self.motion(Motion::Probe(Probing::TOUCH)),
            383 => self.motion(Motion::Probe(Probing::TRY_TOUCH)),
            384 => self.motion(Motion::Probe(Probing::RELEASE)),
            385 => self.motion(Motion::Probe(Probing::TRY_RELEASE)),
            330 => self.motion(Motion::Thread(Thread::Straight)),
            331 => self.motion(Motion::Thread(Thread::RigidTap)),
            760 => self.motion(Motion::Thread(Thread::Cycle)),
            730 | 740 | 810 | 820 | 830 | 840 | 850 | 860 | 870 | 880 | 890 => {
                self.motion(Motion::Cycle(Cycle(tenths / 10)))
            }
            800 => self.motion(Motion::Off),
            40 => shot(self, OneShot::Dwell),
            100 => shot(self, OneShot::SetData),
            280 => shot(self, OneShot::GoHome(Home::First)),
            281 => shot(self, OneShot::SaveHome(Home::First)),
            300 => shot(self, OneShot::GoHome(Home::Second)),
            301 => shot(self, OneShot::SaveHome(Home::Second)),
            520 => shot(self, OneShot::LocalOffset),
            530 => shot(self, OneShot::MachineFrame),
            920 => shot(self, OneShot::SetPosition),
            921 => set(&mut self.g92_switch, OneShot::ClearOffset),
            922 => set(&mut self.g92_switch, OneShot::SuspendOffset),
            923 => set(&mut self.g92_switch, OneShot::RestoreOffset),
            170 => set(&mut self.plane, Plane::Xy),
            180 => set(&mut self.plane, Plane::Zx),
            190 => set(&mut self.plane, Plane::Yz),
            200 => set(&mut self.units, LengthUnit::Inch),
            210 => set(&mut self.units, LengthUnit::Millimetre),
            400 => set(&mut self.compensation, Compensate::Off),
            410 => set(&mut self.compensation, Compensate::Tool { left: true }),
            420 => set(&mut self.compensation, Compensate::Tool { left: false }),
            411 => set(&mut self.compensation, Compensate::Diameter { left: true }),
            421 => set(&mut self.compensation, Compensate::Diameter { left: false }),
            430 => set(&mut self.tool_length, ToolLength::Table),
            431 => set(&mut self.tool_length, ToolLength::Direct),
            432 => set(&mut self.tool_length, ToolLength::Added),
            490 => set(&mut self.tool_length, ToolLength::Off),
            610 => set(&mut self.exact_path, true),
            640 => set(&mut self.exact_path, false),
            900 => set(&mut self.relative, false),
            910 => set(&mut self.relative, true),
            901 => set(&mut self.absolute_centers, true),
            911 => set(&mut self.absolute_centers, false),
            930 => set(&mut self.feed_mode, FeedMode::InverseTime),
            940 => set(&mut self.feed_mode, FeedMode::PerMinute),
            950 => set(&mut self.feed_mode, FeedMode::PerRevolution),
            960 => set(&mut self.surface_speed, true),
            970 => set(&mut self.surface_speed, false),
            70 => set(&mut self.diameters, true),
            80 => set(&mut self.diameters, false),
            980 => set(&mut self.initial_level, true),
            990 => set(&mut self.initial_level, false),
            _ => match (0..).zip(SYSTEMS).find(|(_, code)| *code == tenths) {
                Some((system, _)) => set(&mut self.system, system),
                None => Err(CodeError::Unsupported),
            },
        }
    }

    /// G80 may be in one block with any other motion, which then holds, and with another G80.
    fn motion(&mut self, motion: Motion) -> Result<(), CodeError> {
        match (self.motion, motion) {
            (Some(Motion::Off), _) => self.motion = Some(motion),
            (Some(_), Motion::Off) => {}
            _ => return set(&mut self.motion, motion),
        }
        Ok(())
    }
}

/// M words of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct MWords {
    /// M6.
    pub(super) tool_change: bool,
    /// M61.
    pub(super) tool_number: bool,
    /// M3, M4, M5 or M19.
    pub(super) spindle: Option<u16>,
    /// M7, M8 or M9.
    pub(super) coolant: Option<u16>,
    /// M0, M1, M2, M30 or M60.
    pub(super) stop: Option<u16>,
}

impl MWords {
    /// Adds M`number`.
    pub(super) fn add(&mut self, number: u16) -> Result<(), CodeError> {
        match number {
            0 | 1 | 2 | 30 | 60 => set(&mut self.stop, number),
            3..=5 | 19 => set(&mut self.spindle, number),
            6 | 61 if self.tool_change || self.tool_number => Err(CodeError::Conflict),
            6 => {
                self.tool_change = true;
                Ok(())
            }
            61 => {
                self.tool_number = true;
                Ok(())
            }
            7..=9 => set(&mut self.coolant, number),
            _ => Err(CodeError::Unsupported),
        }
    }
}
