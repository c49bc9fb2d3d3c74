//! Expected outcome of every fault: from the manuals, and from what drivers promise (`drives-notes`, module pages).
//!
//! * Idempotent requests are repeated: InterpCNC reads, stops and moves (command 80), ATB PING and GOTO, BIM2AX reads
//!   and stops. They survive corrupted frames. Segments of InterpCNC (command 6) and orders of BIM2AX are sent once: if
//!   corrupted, the former are reported, the latter as well unless a plan is followed.
//! * Both check sums find corrupted bytes, but the XOR of ATB does not find two swapped ones. The bus of BIM2AX finds
//!   nothing: corruption shows in the final axis position.
//! * No family watches its master: an unplugged device goes on to its target.
//! * A hard stop leaves boards locked and drives off, and a module reports a hard stop of an axis that moved: an alarm
//!   or a reset with the same effect is consistent with that.
//! * InterpCNC and BIM2AX without encoders do not detect a held shaft; with an encoder they report it, and a soft stop
//!   reports it once the axis is at rest.

use twin_bim2ax as bim2ax;
use twin_drives::{Direction, DriveError, WireFault};
use twin_smartdrive as smartdrive;

use crate::{
    faults::{DeviceFault, Doing, Family, Fault},
    scenario::{Cell, Outcome},
};

/// Cause of a fault as an error names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cause {
    /// No answer, or one that is garbled, within the deadline.
    NoAnswer,
    /// The device refuses.
    Refused,
    /// ENABLE is lost, or the board is locked since.
    Locked,
    /// An alarm with its name, or the power that is absent.
    Alarm,
    /// The module is starting, or phases are off, or the drive is not in its mode any more: it has been reset.
    Reset,
    /// The axis has been stopped without ramp.
    StoppedHard,
    /// Nobody is there.
    Gone,
    /// What was begun does not end.
    Unfinished,
    /// The axis is elsewhere than it was sent.
    Elsewhere,
    /// Homing has ended without its switch.
    NotHomed,
    /// The encoder shows the axis elsewhere than its counter.
    Encoder,
    /// Moves are confirmed, and the axis stays at rest.
    NoEffect,
}

impl Cause {
    pub(crate) fn of(error: &DriveError) -> Option<Self> {
        let text = error.to_string();
        match error.fault() {
            Some(smartdrive::Fault::Rejected(_)) => return Some(Self::Refused),
            Some(smartdrive::Fault::Alarm(_)) => return Some(Self::Alarm),
            None => {}
        }
        if let Some(fault) = error.fault() {
            return Some(match fault {
                bim2ax::Fault::NotRunning => Self::Reset,
                bim2ax::Fault::Identity { .. } => Self::Gone,
                bim2ax::Fault::AxisMessages { .. } if text.contains("power absent") => Self::Alarm,
                bim2ax::Fault::AxisMessages { .. } if text.contains("phases off") => Self::Reset,
                bim2ax::Fault::AxisMessages { .. } if text.contains("order") => Self::Refused,
                bim2ax::Fault::AxisMessages { .. } if text.contains("stopped hard") => {
                    Self::StoppedHard
                }
                _ => return None,
            });
        }
        Some(match error {
            DriveError::Timeout { .. } | DriveError::Protocol { .. } => Self::NoAnswer,
            DriveError::Device { .. } => Self::Refused,
            DriveError::Locked { .. } | DriveError::EnableOpen { .. } => Self::Locked,
            DriveError::Stalled { .. } => Self::Alarm,
            DriveError::Mode { .. } => Self::Reset,
            DriveError::Moving { .. } | DriveError::Unfinished { .. } => Self::Unfinished,
            DriveError::NotArrived { .. } => Self::Elsewhere,
            DriveError::NoEffect { .. } => Self::NoEffect,
            DriveError::EncoderDiffers { .. } if text.contains("by its encoder") => Self::Encoder,
            DriveError::NotHomed { .. } | DriveError::HomingFailed { .. } => Self::NotHomed,
            _ => return None,
        })
    }
}

/// Expected outcome of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Expected {
    /// It is survived.
    Survived,
    /// It is reported, with one of these causes, and the axis stops on request.
    Told(&'static [Cause]),
    /// It is reported like that or survived, as two answers are read at once or one after the other: both are sound.
    Either(&'static [Cause]),
    /// It is reported; the device cannot be reached and goes on to where it was sent.
    GoesOn(&'static [Cause]),
    /// The driver cannot know: the counter is right and the mechanics are elsewhere.
    Unseen,
}

impl Expected {
    /// Checks that a cell is as expected; the error says why it is not.
    pub(crate) fn check(self, cell: &Cell) -> Result<(), String> {
        cell.usable.as_ref().map_err(|why| format!("not usable afterwards: {why}"))?;
        if !cell.struck && matches!(cell.outcome, Outcome::Survived) {
            return Err("its fault has not occurred".to_owned());
        }
        #[expect(clippy::cast_precision_loss, reason = "a counter")]
        let apart = (cell.truth.counter as f64 - cell.truth.mechanical).abs();
        match (self, &cell.outcome) {
            (_, Outcome::Lost(what) | Outcome::Astray(what)) => {
                return Err(format!("lost unnoticed: {what}"));
            }
            (_, Outcome::NotBegun(error)) => return Err(format!("it does not begin: {error}")),
            (Self::Unseen, Outcome::Survived) if apart < 100.0 => {
                return Err("the mechanics have not been held".to_owned());
            }
            (Self::Survived | Self::Unseen | Self::Either(_), Outcome::Survived) => {}
            (
                Self::Told(causes) | Self::Either(causes) | Self::GoesOn(causes),
                Outcome::Told(error),
            ) => {
                let cause = Cause::of(error);
                if !cause.is_some_and(|cause| causes.contains(&cause)) {
                    return Err(format!("{error} ({cause:?} instead of {causes:?})"));
                }
            }
            (_, outcome) => return Err(format!("{outcome:?}")),
        }
        match self {
            Self::GoesOn(_) => cell.goes_on.clone().unwrap_or_else(|| Err("no end".to_owned())),
            _ if cell.stopped => Ok(()),
            _ => Err("it cannot be stopped".to_owned()),
        }
    }

    /// True if a cell fails only because something was late: a computer that is too busy may keep sound devices waiting
    /// beyond their deadlines, or from going where they were sent, so that they arrive where they should but are behind
    /// the plan on the way. What was lost unnoticed or could not be stopped is no accident, nor is any other error.
    pub(crate) fn is_late(self, cell: &Cell) -> bool {
        let late = match &cell.outcome {
            Outcome::Told(error) | Outcome::NotBegun(error) => {
                matches!(error, DriveError::Timeout { .. })
            }
            Outcome::Astray(_) => true,
            Outcome::Survived | Outcome::Lost(_) => false,
        };
        late && self.check(cell).is_err() && cell.stopped && cell.usable.is_ok()
    }

    /// True if nothing needs to be reported.
    pub(crate) fn is_survivable(self) -> bool {
        matches!(self, Self::Survived | Self::Either(_) | Self::Unseen)
    }

    /// As the table says it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Survived => "survived",
            Self::Told(_) => "told, stopped",
            Self::Either(_) => "survived or told, stopped",
            Self::GoesOn(_) => "told, goes on",
            Self::Unseen => "unseen",
        }
    }
}

use Cause::{
    Alarm, Elsewhere, Encoder, Gone, Locked, NoAnswer, NoEffect, NotHomed, Refused, Reset,
    Unfinished,
};
use Expected::{Either, GoesOn, Survived, Told, Unseen};

/// Frames that a fault of the wire befalls: one, but while a plan is followed two in a row, or what spoils an order until
/// that is reported (0).
pub(crate) fn frames(family: Family, fault: Fault, doing: Doing) -> u32 {
    let Fault::Wire(direction, wire) = fault else { return 1 };
    match (family, doing) {
        (Family::InterpCnc | Family::Segments, Doing::Moving) => 2,
        // Only orders count for what spoils what is written.
        (Family::Bim2Ax, Doing::Moving) => match (direction, wire) {
            (
                Direction::Request,
                WireFault::Refuse { .. } | WireFault::Truncate { .. } | WireFault::Reorder,
            ) => 0,
            (_, WireFault::Corrupt { .. } | WireFault::Duplicate) => 1,
            (Direction::Answer, WireFault::Truncate { .. } | WireFault::Reorder) => 1,
            _ => 2,
        },
        _ => 1,
    }
}

/// Seed that decides which bytes a fault hits, so that each cell has one outcome: the first number that it makes,
/// divided by the count of what may be hit, leaves the place.
pub(crate) fn seed(family: Family, fault: Fault, doing: Doing) -> u64 {
    match (family, fault, doing) {
        // Rest 2 of 9 pairs of different bytes of "02 63 A0 0F 00 00 4B 00 D0 07 ..": those of the target.
        (
            Family::SmartDrive | Family::Pair,
            Fault::Wire(Direction::Request, WireFault::Reorder),
            Doing::Idle,
        ) => 15,
        // Rest 5 of 30: the last byte of the target, after the numbers of zone and status.
        (
            Family::Bim2Ax,
            Fault::Wire(Direction::Request, WireFault::Corrupt { .. }),
            Doing::Idle,
        ) => 1,
        // Rests 3 of 2520, and so of all counts from 4 to 10: within a frame, not at its begin, where noise is.
        (_, Fault::Wire(_, WireFault::Lose { .. } | WireFault::Double { .. }), _) => 2054,
        // A multiple of 2520, and so of all counts up to 10: the first.
        _ => 2779,
    }
}

pub(crate) fn expected(family: Family, fault: Fault, doing: Doing) -> Expected {
    match fault {
        Fault::Wire(direction, wire) => match family {
            Family::InterpCnc | Family::Segments => on_modbus(family, wire, doing),
            Family::SmartDrive | Family::Pair => on_atb(direction, wire, doing),
            Family::Bim2Ax => on_bus(direction, wire, doing),
        },
        Fault::Device(fault) => of_device(family, fault, doing),
    }
}

/// True if the check sum of the family may not find what a fault does to a frame: the device may then do something
/// else than it was commanded, and the driver may read something else than was answered.
pub(crate) fn passes_the_check(family: Family, fault: Fault) -> bool {
    let Fault::Wire(_, wire) = fault else { return false };
    match (family, wire) {
        // A CRC-16 finds every error of up to 16 bits in a row, and misses one of 65,536 others.
        (Family::InterpCnc | Family::Segments, _) => false,
        // The XOR of two bytes that change places is the same; of several that are others it is in one of 255 cases.
        (Family::SmartDrive | Family::Pair, WireFault::Reorder) => true,
        (Family::SmartDrive | Family::Pair, WireFault::Corrupt { bytes }) => bytes > 1,
        (Family::SmartDrive | Family::Pair, _) => false,
        // There is none.
        (Family::Bim2Ax, WireFault::Corrupt { .. } | WireFault::Truncate { .. }) => true,
        (Family::Bim2Ax, _) => false,
    }
}

/// Expected outcome of a held shaft on an axis with an encoder.
pub(crate) fn expected_with_encoder(family: Family, doing: Doing) -> Expected {
    match (family, doing) {
        // A stop without ramp needs no shaft that turns, and what is lost with it is lost anyway.
        (_, doing) if doing.halts() => Survived,
        // A leg or a segment may be so slow, or so near to its end, that it is stopped within what numbers are rounded by:
        // (1300² − 1000²)/40000 are 17 µsteps of a module.
        (Family::Bim2Ax | Family::Segments, Doing::Stopping) => Either(&[Encoder]),
        _ => Told(&[Encoder]),
    }
}

fn on_modbus(family: Family, wire: WireFault, doing: Doing) -> Expected {
    match (wire, doing) {
        // Answered twice; what comes after an answer answers nothing.
        (WireFault::Duplicate, _) => Survived,
        // Reads and stops are repeated, but not where the board itself refuses.
        (WireFault::Refuse { .. }, _) => Told(&[Refused]),
        // Commands 71 and 6 are sent once, and 80 again. Between two segments the board is looked at.
        (_, Doing::ToHome) => Told(&[NoAnswer]),
        (_, Doing::Moving) if family == Family::Segments => Either(&[NoAnswer]),
        _ => Survived,
    }
}

fn on_atb(direction: Direction, wire: WireFault, doing: Doing) -> Expected {
    match (wire, doing) {
        // Stops are broadcast three times, and broadcasts are not answered.
        (WireFault::Refuse { .. }, _) if doing.stops() || doing.halts() => Survived,
        (WireFault::Refuse { .. }, _) => Told(&[Refused]),
        // An echo is skipped, and what comes after an answer thrown away.
        (WireFault::Echo, Doing::ToHome) => Survived,
        // A drive that gets a command twice refuses the second time: a long command is running. Of two answers that are there at once
        // the last counts; one that comes later answers nothing.
        (WireFault::Duplicate, Doing::ToHome) if direction == Direction::Request => {
            Either(&[Refused])
        }
        (WireFault::Duplicate, Doing::ToHome) => Survived,
        // TRJINIT is sent once: a drive that has homed meanwhile would home again.
        (_, Doing::ToHome) => Told(&[NoAnswer]),
        // The XOR is the same: the drive goes to another target. Elsewhere the first two bytes change places (`seed`),
        // and what comes is addressed to nobody.
        (WireFault::Reorder, Doing::Idle) if direction == Direction::Request => Told(&[Elsewhere]),
        _ => Survived,
    }
}

fn on_bus(direction: Direction, wire: WireFault, doing: Doing) -> Expected {
    let request = direction == Direction::Request;
    match (wire, doing) {
        (WireFault::Duplicate, _) => Survived,
        // Reads are not refused, and stops are repeated where they are not acknowledged.
        (WireFault::Refuse { .. }, Doing::Idle | Doing::Moving | Doing::ToHome) => Told(&[Refused]),
        (WireFault::Refuse { .. }, _) => Survived,
        (WireFault::Drop | WireFault::Delay { .. }, Doing::Idle | Doing::ToHome) => {
            Told(&[NoAnswer])
        }
        // A leg whose order is lost is looked after, and another one begun.
        (WireFault::Drop | WireFault::Delay { .. }, Doing::Moving) => Either(&[NoAnswer]),
        // The zone with the order alone: of its first word one byte is missing, and 0 is no order. Nothing begins.
        (WireFault::Truncate { .. }, Doing::ToHome) if request => Told(&[Refused]),
        // Orders that do not come whole or not first are not taken: there is no receipt.
        (
            WireFault::Truncate { .. } | WireFault::Reorder,
            Doing::Idle | Doing::Moving | Doing::ToHome,
        ) if request => Told(&[NoAnswer]),
        // The number of the zone is another one (`seed`): what is asked for is not what comes back.
        (WireFault::Corrupt { .. }, Doing::ToHome) if request => Told(&[NoAnswer]),
        // The target is another one (`seed`). While a leg is under way it is a look that is spoilt.
        (WireFault::Corrupt { .. }, Doing::Idle) if request => Told(&[Elsewhere]),
        // What is read falsely once is read rightly the next time.
        _ => Survived,
    }
}

fn of_device(family: Family, fault: DeviceFault, doing: Doing) -> Expected {
    match (fault, family, doing) {
        // Nobody answers before the supply is back. What asks again for long enough finds what a reset leaves behind.
        (DeviceFault::Outage, Family::Bim2Ax, _) => Told(&[NoAnswer, Reset]),
        (DeviceFault::Outage, _, _) => Told(&[NoAnswer]),

        // What a hard stop is to bring about is there already: boards are locked and drives off after power-up, without
        // ENABLE and in alarm, and stand. (A module keeps obeying, and says what is wrong.)
        (
            DeviceFault::BrownOut | DeviceFault::Alarm,
            Family::InterpCnc | Family::Segments | Family::SmartDrive | Family::Pair,
            _,
        ) if doing.halts() => Survived,
        // Nor does a stop without ramp need a shaft that turns.
        (DeviceFault::Stall, _, _) if doing.halts() => Survived,
        // Nothing shows that it is off.
        (DeviceFault::Stuck, Family::SmartDrive | Family::Pair, _) if doing.halts() => {
            Told(&[Reset])
        }

        // After power-up a board is locked, a drive off, a module without phases.
        (DeviceFault::BrownOut, Family::InterpCnc | Family::Segments, _) => Told(&[Locked]),
        (DeviceFault::BrownOut, Family::SmartDrive | Family::Pair, _) => Told(&[Reset, NoAnswer]),
        (DeviceFault::BrownOut, Family::Bim2Ax, _) => Told(&[Reset, NoAnswer]),

        // A rotor that is held for a moment while it rests anyway.
        (DeviceFault::Stall, Family::SmartDrive | Family::Pair, Doing::Idle) => Survived,
        (DeviceFault::Stall, Family::SmartDrive | Family::Pair, _) => Told(&[Alarm]),
        // The switch does not come.
        (DeviceFault::Stall, Family::InterpCnc, Doing::Homing) => Told(&[NotHomed, Unfinished]),
        (DeviceFault::Stall, Family::Bim2Ax, Doing::Homing) => Told(&[Unfinished]),
        // A stop needs no shaft that turns.
        (DeviceFault::Stall, _, _) if doing.stops() => Survived,
        (DeviceFault::Stall, _, _) => Unseen,

        (DeviceFault::Alarm, Family::InterpCnc | Family::Segments, _) => Told(&[Locked]),
        (DeviceFault::Alarm, _, _) => Told(&[Alarm]),

        (DeviceFault::Ignored, _, _) => Told(&[NoEffect]),

        (DeviceFault::Gone, Family::Bim2Ax, _) => GoesOn(&[Gone]),
        (DeviceFault::Gone, _, _) => GoesOn(&[NoAnswer]),

        // Counters of a board are no part of its status: moves are seen to end, stops and homing are not.
        (DeviceFault::Stuck, Family::InterpCnc, Doing::Idle) => Survived,
        (DeviceFault::Stuck, Family::InterpCnc, Doing::Moving) => Survived,
        (DeviceFault::Stuck, Family::Segments, Doing::Moving) => Survived,
        (DeviceFault::Stuck, _, Doing::Homing) => Told(&[Unfinished]),
        (DeviceFault::Stuck, _, _) if doing.stops() || doing.halts() => Told(&[Unfinished]),
        // While looking: on its way and at the same place for longer than any that moves.
        (DeviceFault::Stuck, _, Doing::Idle | Doing::Looking) => Told(&[Elsewhere]),
        (DeviceFault::Stuck, Family::Bim2Ax, Doing::Moving) => Told(&[Unfinished, Elsewhere]),
        (DeviceFault::Stuck, _, _) => Told(&[Elsewhere]),
    }
}

#[test]
fn only_what_is_late_is_made_again() {
    use twin_drives::{Action, Axes, Exchange};

    use crate::rig::Truth;

    let at = || Exchange { port: "port".into(), address: 1, action: Action::ReadState };
    let timeout = || DriveError::Timeout { at: at(), deadline: std::time::Duration::ZERO };
    let cell = |outcome| Cell {
        outcome,
        struck: true,
        stopped: true,
        truth: Truth::default(),
        ends: None,
        usable: Ok(()),
        goes_on: None,
    };
    let late = cell(Outcome::Told(timeout()));
    assert!(Survived.is_late(&late) && Told(&[Refused]).is_late(&late));
    assert!(Survived.is_late(&cell(Outcome::NotBegun(timeout()))));
    let astray = || Outcome::Astray("it was behind".to_owned());
    assert!(Survived.is_late(&cell(astray())));
    // A deadline that was to pass is not late; nor is anything else.
    assert!(!Told(&[NoAnswer]).is_late(&late));
    for wrong in [
        cell(Outcome::Lost("it has gone on".to_owned())),
        cell(Outcome::Told(DriveError::Moving { at: at(), axes: Axes::Only })),
        cell(Outcome::NotBegun(DriveError::Moving { at: at(), axes: Axes::Only })),
        cell(Outcome::Survived),
        Cell { stopped: false, ..cell(Outcome::Told(timeout())) },
        Cell { stopped: false, ..cell(astray()) },
        Cell { usable: Err("it is not".to_owned()), ..cell(Outcome::Told(timeout())) },
    ] {
        assert!(Told(&[Refused]).check(&wrong).is_err(), "{wrong:?}");
        assert!(!Told(&[Refused]).is_late(&wrong), "{wrong:?}");
    }
    // One that goes on as it was to, but for another reason, could not be stopped.
    let gone = Cell { stopped: false, goes_on: Some(Ok(())), ..late };
    assert!(!GoesOn(&[Gone]).is_late(&gone));
}
