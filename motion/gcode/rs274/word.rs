//! Meaning of G and M words, and their modal groups.

use super::LengthUnit;
use super::offsets::Home;
use twin_path::{Plane, Probing};

/// Group 1: what the axis words of this line and the following ones do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
    /// G5 to G5.2.
    Spline(Spline),
    /// G38.2 to G38.5.
    Probe(Probing),
    /// G33, G33.1 and G76.
    Thread(Thread),
    /// G73, G74 and G81 to G89.
    Cycle(Cycle),
    /// G80: nothing, axis words are errors.
    #[default]
    Off,
}

/// A kind of spline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spline {
    /// G5.
    Cubic,
    /// G5.1.
    Quadratic,
    /// G5.2: a control point of a NURBS.
    Nurbs,
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
            Self::Spline(spline) => spline.number(),
            Self::Probe(probing) => probing.g_number(),
            Self::Thread(Thread::Straight) => 33.0,
            Self::Thread(Thread::RigidTap) => 33.1,
            Self::Thread(Thread::Cycle) => 76.0,
            Self::Cycle(Cycle(number)) => number.into(),
            Self::Off => 80.0,
        }
    }
}

impl Spline {
    /// The number after G.
    pub(super) fn number(self) -> f64 {
        match self {
            Self::Cubic => 5.0,
            Self::Quadratic => 5.1,
            Self::Nurbs => 5.2,
        }
    }
}

/// Group 0: what holds for one line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OneShot {
    /// G4.
    Dwell,
    /// G5.3.
    EndNurbs,
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

/// Group 13: path control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PathControl {
    /// G61.
    ExactPath,
    /// G61.1.
    ExactStop,
    /// G64.
    Blend,
}

/// Modal groups of G words, with LinuxCNC's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Group {
    NonModal = 0,
    Motion = 1,
    Plane = 2,
    Distance = 3,
    Centers = 4,
    FeedMode = 5,
    Units = 6,
    Compensation = 7,
    ToolLength = 8,
    ReturnLevel = 10,
    System = 12,
    PathControl = 13,
    SpindleMode = 14,
    Diameter = 15,
    /// G92.1 to G92.3: next to other words without a group.
    G92 = 16,
}

/// G words of a line but for their columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct GWords {
    /// Groups that are taken, a bit each.
    pub(super) groups: u32,
    pub(super) motion: Option<Motion>,
    pub(super) one_shot: Option<OneShot>,
    /// G92.1, G92.2 or G92.3.
    pub(super) g92_switch: Option<OneShot>,
    pub(super) plane: Option<Plane>,
    /// G17.1 to G19.1 (true), G17 to G19.
    pub(super) parallel_plane: Option<bool>,
    pub(super) units: Option<LengthUnit>,
    pub(super) compensation: Option<Compensate>,
    /// G43 to G43.2, G49.
    pub(super) tool_length: Option<ToolLength>,
    /// G54 to G59.3 as 0 to 8.
    pub(super) system: Option<u8>,
    pub(super) path_control: Option<PathControl>,
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

/// Number of a G word in tenths, its group, and its meaning.
type GWord = (u16, Group, fn(&mut GWords));

/// The G words, in the order of their numbers.
#[rustfmt::skip]
const G_WORDS: [GWord; 81] = [
    (  0, Group::Motion,       |g| g.motion = Some(Motion::Rapid)),
    ( 10, Group::Motion,       |g| g.motion = Some(Motion::Line)),
    ( 20, Group::Motion,       |g| g.motion = Some(Motion::Arc { clockwise: true })),
    ( 30, Group::Motion,       |g| g.motion = Some(Motion::Arc { clockwise: false })),
    ( 40, Group::NonModal,     |g| g.one_shot = Some(OneShot::Dwell)),
    ( 50, Group::Motion,       |g| g.motion = Some(Motion::Spline(Spline::Cubic))),
    ( 51, Group::Motion,       |g| g.motion = Some(Motion::Spline(Spline::Quadratic))),
    ( 52, Group::Motion,       |g| g.motion = Some(Motion::Spline(Spline::Nurbs))),
    ( 53, Group::NonModal,     |g| g.one_shot = Some(OneShot::EndNurbs)),
    ( 70, Group::Diameter,     |g| g.diameters = Some(true)),
    ( 80, Group::Diameter,     |g| g.diameters = Some(false)),
    (100, Group::NonModal,     |g| g.one_shot = Some(OneShot::SetData)),
    (170, Group::Plane,        |g| g.set_plane(Plane::Xy, false)),
    (171, Group::Plane,        |g| g.set_plane(Plane::Xy, true)),
    (180, Group::Plane,        |g| g.set_plane(Plane::Zx, false)),
    (181, Group::Plane,        |g| g.set_plane(Plane::Zx, true)),
    (190, Group::Plane,        |g| g.set_plane(Plane::Yz, false)),
    (191, Group::Plane,        |g| g.set_plane(Plane::Yz, true)),
    (200, Group::Units,        |g| g.units = Some(LengthUnit::Inch)),
    (210, Group::Units,        |g| g.units = Some(LengthUnit::Millimetre)),
    (280, Group::NonModal,     |g| g.one_shot = Some(OneShot::GoHome(Home::First))),
    (281, Group::NonModal,     |g| g.one_shot = Some(OneShot::SaveHome(Home::First))),
    (300, Group::NonModal,     |g| g.one_shot = Some(OneShot::GoHome(Home::Second))),
    (301, Group::NonModal,     |g| g.one_shot = Some(OneShot::SaveHome(Home::Second))),
    (330, Group::Motion,       |g| g.motion = Some(Motion::Thread(Thread::Straight))),
    (331, Group::Motion,       |g| g.motion = Some(Motion::Thread(Thread::RigidTap))),
    (382, Group::Motion,       |g| g.motion = Some(Motion::Probe(Probing::TOUCH))),
    (383, Group::Motion,       |g| g.motion = Some(Motion::Probe(Probing::TRY_TOUCH))),
    (384, Group::Motion,       |g| g.motion = Some(Motion::Probe(Probing::RELEASE))),
    (385, Group::Motion,       |g| g.motion = Some(Motion::Probe(Probing::TRY_RELEASE))),
    (400, Group::Compensation, |g| g.compensation = Some(Compensate::Off)),
    (410, Group::Compensation, |g| g.compensation = Some(Compensate::Tool { left: true })),
    (411, Group::Compensation, |g| g.compensation = Some(Compensate::Diameter { left: true })),
    (420, Group::Compensation, |g| g.compensation = Some(Compensate::Tool { left: false })),
    (421, Group::Compensation, |g| g.compensation = Some(Compensate::Diameter { left: false })),
    (430, Group::ToolLength,   |g| g.tool_length = Some(ToolLength::Table)),
    (431, Group::ToolLength,   |g| g.tool_length = Some(ToolLength::Direct)),
    (432, Group::ToolLength,   |g| g.tool_length = Some(ToolLength::Added)),
    (490, Group::ToolLength,   |g| g.tool_length = Some(ToolLength::Off)),
    (520, Group::NonModal,     |g| g.one_shot = Some(OneShot::LocalOffset)),
    (530, Group::NonModal,     |g| g.one_shot = Some(OneShot::MachineFrame)),
    (540, Group::System,       |g| g.system = Some(0)),
    (550, Group::System,       |g| g.system = Some(1)),
    (560, Group::System,       |g| g.system = Some(2)),
    (570, Group::System,       |g| g.system = Some(3)),
    (580, Group::System,       |g| g.system = Some(4)),
    (590, Group::System,       |g| g.system = Some(5)),
    (591, Group::System,       |g| g.system = Some(6)),
    (592, Group::System,       |g| g.system = Some(7)),
    (593, Group::System,       |g| g.system = Some(8)),
    (610, Group::PathControl,  |g| g.path_control = Some(PathControl::ExactPath)),
    (611, Group::PathControl,  |g| g.path_control = Some(PathControl::ExactStop)),
    (640, Group::PathControl,  |g| g.path_control = Some(PathControl::Blend)),
    (730, Group::Motion,       |g| g.motion = Some(Motion::Cycle(Cycle(73)))),
    (740, Group::Motion,       |g| g.motion = Some(Motion::Cycle(Cycle(74)))),
    (760, Group::Motion,       |g| g.motion = Some(Motion::Thread(Thread::Cycle))),
    (800, Group::Motion,       |g| g.motion = Some(Motion::Off)),
    (810, Group::Motion,       |g| g.motion = Some(Motion::Cycle(Cycle(81)))),
    (820, Group::Motion,       |g| g.motion = Some(Motion::Cycle(Cycle(82)))),
    (830, Group::Motion,       |g| g.motion = Some(Motion::Cycle(Cycle(83)))),
    (840, Group::Motion,       |g| g.motion = Some(Motion::Cycle(Cycle(84)))),
    (850, Group::Motion,       |g| g.motion = Some(Motion::Cycle(Cycle(85)))),
    (860, Group::Motion,       |g| g.motion = Some(Motion::Cycle(Cycle(86)))),
    (870, Group::Motion,       |g| g.motion = Some(Motion::Cycle(Cycle(87)))),
    (880, Group::Motion,       |g| g.motion = Some(Motion::Cycle(Cycle(88)))),
    (890, Group::Motion,       |g| g.motion = Some(Motion::Cycle(Cycle(89)))),
    (900, Group::Distance,     |g| g.relative = Some(false)),
    (901, Group::Centers,      |g| g.absolute_centers = Some(true)),
    (910, Group::Distance,     |g| g.relative = Some(true)),
    (911, Group::Centers,      |g| g.absolute_centers = Some(false)),
    (920, Group::NonModal,     |g| g.one_shot = Some(OneShot::SetPosition)),
    (921, Group::G92,          |g| g.g92_switch = Some(OneShot::ClearOffset)),
    (922, Group::G92,          |g| g.g92_switch = Some(OneShot::SuspendOffset)),
    (923, Group::G92,          |g| g.g92_switch = Some(OneShot::RestoreOffset)),
    (930, Group::FeedMode,     |g| g.feed_mode = Some(FeedMode::InverseTime)),
    (940, Group::FeedMode,     |g| g.feed_mode = Some(FeedMode::PerMinute)),
    (950, Group::FeedMode,     |g| g.feed_mode = Some(FeedMode::PerRevolution)),
    (960, Group::SpindleMode,  |g| g.surface_speed = Some(true)),
    (970, Group::SpindleMode,  |g| g.surface_speed = Some(false)),
    (980, Group::ReturnLevel,  |g| g.initial_level = Some(true)),
    (990, Group::ReturnLevel,  |g| g.initial_level = Some(false)),
];

/// Modal groups of M words, with LinuxCNC's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MGroup {
    Stop = 4,
    InputOutput = 5,
    ToolChange = 6,
    Spindle = 7,
    Coolant = 8,
    Overrides = 9,
    User = 10,
}

/// M words of a line, by their numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct MWords {
    /// Groups that are taken, a bit each.
    pub(super) groups: u32,
    /// M6 or M61.
    pub(super) tool_change: Option<u16>,
    /// M3, M4, M5 or M19.
    pub(super) spindle: Option<u16>,
    /// M7, M8 or M9.
    pub(super) coolant: Option<u16>,
    /// M48 to M53.
    pub(super) overrides: Option<u16>,
    /// M62 to M68.
    pub(super) input_output: Option<u16>,
    /// M70 to M73.
    pub(super) modes: Option<u16>,
    /// M100 to M199.
    pub(super) user: Option<u16>,
    /// M0, M1, M2, M30 or M60.
    pub(super) stop: Option<u16>,
}

/// First and last number of M words, their group, and where a block keeps the number.
type MWord = (u16, u16, MGroup, fn(&mut MWords) -> &mut Option<u16>);

/// The M words. M98 and M99 are those of `flow/mod.rs`.
#[rustfmt::skip]
const M_WORDS: [MWord; 12] = [
    ( 0,  2, MGroup::Stop,       |m| &mut m.stop),
    ( 3,  5, MGroup::Spindle,    |m| &mut m.spindle),
    ( 6,  6, MGroup::ToolChange, |m| &mut m.tool_change),
    ( 7,  9, MGroup::Coolant,    |m| &mut m.coolant),
    (19, 19, MGroup::Spindle,    |m| &mut m.spindle),
    (30, 30, MGroup::Stop,       |m| &mut m.stop),
    (48, 53, MGroup::Overrides,  |m| &mut m.overrides),
    (60, 60, MGroup::Stop,       |m| &mut m.stop),
    (61, 61, MGroup::ToolChange, |m| &mut m.tool_change),
    (62, 68, MGroup::InputOutput, |m| &mut m.input_output),
    (70, 73, MGroup::Spindle,    |m| &mut m.modes),
    (100, 199, MGroup::User,     |m| &mut m.user),
];

/// Error of a G or M word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CodeError {
    /// Not executed.
    Unsupported,
    /// Another one of its group is in the line already.
    Conflict,
}

/// Takes the group with `number`.
///
/// # Errors
/// [`CodeError::Conflict`] if it is taken.
fn take(groups: &mut u32, number: u32) -> Result<(), CodeError> {
    let before = *groups;
    *groups |= 1 << number;
    if *groups == before { Err(CodeError::Conflict) } else { Ok(()) }
}

impl GWords {
    /// Adds the G word whose number is `tenths` / 10.
    pub(super) fn add(&mut self, tenths: u16) -> Result<(), CodeError> {
        let index = G_WORDS.binary_search_by_key(&tenths, |(number, ..)| *number);
        let (_, group, mean) =
            index.ok().and_then(|index| G_WORDS.get(index)).ok_or(CodeError::Unsupported)?;
        let before = self.motion;
        let taken = take(&mut self.groups, *group as u32);
        mean(self);
        if taken.is_err() && *group == Group::Motion {
            // G80 may be next to another motion, which then holds, and to another G80.
            match (before, self.motion) {
                (Some(Motion::Off), _) => return Ok(()),
                (_, Some(Motion::Off)) => {
                    self.motion = before;
                    return Ok(());
                }
                _ => {}
            }
        }
        taken
    }

    fn set_plane(&mut self, plane: Plane, parallel: bool) {
        (self.plane, self.parallel_plane) = (Some(plane), Some(parallel));
    }
}

impl MWords {
    /// True if LinuxCNC knows M`number`.
    pub(super) fn knows(number: u16) -> bool {
        M_WORDS.iter().any(|(first, last, ..)| (*first..=*last).contains(&number))
    }

    /// Adds M`number`.
    pub(super) fn add(&mut self, number: u16) -> Result<(), CodeError> {
        let row = M_WORDS.iter().find(|(first, last, ..)| (*first..=*last).contains(&number));
        let (.., group, slot) = row.ok_or(CodeError::Unsupported)?;
        take(&mut self.groups, *group as u32)?;
        *slot(self) = Some(number);
        Ok(())
    }
}
