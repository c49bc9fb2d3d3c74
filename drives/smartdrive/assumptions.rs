//! Assumptions about the drives where the manual is silent.
//!
//! Paragraphs are those of the digest that the tests list (`drives/tests/assumptions.rs`).

use super::{AnswerLength, RejectCode};
use crate::protocol::parameters::{ACCELERATION_CURRENT, DECELERATION_SETPOINT};
use twin_drives::assumptions::{Choice, FLAG, assumptions};

/// Reaction of a drive to a frame for itself whose check sum or length is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BadFrame {
    /// It says nothing.
    Silent,
    /// It refuses it.
    Refused(RejectCode),
}

/// State of an output whose bit is in both bytes of IOUPDATE.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BothBits {
    /// Stays as it is.
    Unchanged,
    /// Becomes active.
    Set,
    /// Becomes inactive.
    Clear,
}

/// Origin of STEP.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepFrom {
    /// The set-point, where that is just now.
    Setpoint,
    /// The target of the GOTO or STEP under way, so that steps add up; without one the set-point.
    Target,
}

/// Stop of a drive on LIMP and LIMN.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitStop {
    /// With `DecLim`.
    Emergency,
    /// With `DecMax`.
    Deceleration,
    /// Without ramp.
    AtOnce,
}

/// Meaning of `PosOffset` for homing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomePosition {
    /// The position where the switch releases.
    IsOffset,
    /// The way that the drive goes on from there, at `VelExitHome`; its end is position 0.
    GoesOffset,
}

/// Index of the variable `Acc_Current`; the manual prints 85, as for `Dec_Setpoint`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AccCurrent {
    /// At 86, after `Dec_Setpoint`.
    At86,
    /// At 85: `Dec_Setpoint` cannot be read, and there is no 86.
    At85,
}

impl AccCurrent {
    /// Index of `Acc_Current`.
    pub fn index(self) -> u16 {
        match self {
            Self::At86 => ACCELERATION_CURRENT,
            Self::At85 => DECELERATION_SETPOINT,
        }
    }

    /// Index of `Dec_Setpoint`, if it has one.
    pub fn deceleration_index(self) -> Option<u16> {
        (self == Self::At86).then_some(DECELERATION_SETPOINT)
    }
}

/// Meaning of a `DecMax` or `DecLim` of 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ZeroRate {
    /// `AccMax`.
    AsAcceleration,
    /// No ceiling: what is asked for counts, and the largest is a stop without ramp.
    Unlimited,
}

/// Instant from which a value of SET acts; GET shows it at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetEffect {
    /// At once.
    AtOnce,
    /// With the next mode.
    WithMode,
    /// SET begins the present mode anew (RTD), which takes as long as MODE and loses the position.
    RestartsMode,
}

const CODES: Choice<RejectCode> = Choice(&[
    ("generic", RejectCode::Generic),
    ("working", RejectCode::Working),
    ("bad-mode", RejectCode::BadMode),
    ("bad-params", RejectCode::BadParams),
    ("not-available", RejectCode::NotAvailable),
]);

assumptions! {
    /// Assumptions where the manual is silent. The emulated device behaves by them, and the client expects them where it
    /// matters to it.
    pub struct Assumptions {
        bad_frame: BadFrame = BadFrame::Silent, Choice(&[
                ("silent", BadFrame::Silent),
                ("generic", BadFrame::Refused(RejectCode::Generic)),
                ("working", BadFrame::Refused(RejectCode::Working)),
                ("bad-mode", BadFrame::Refused(RejectCode::BadMode)),
                ("bad-params", BadFrame::Refused(RejectCode::BadParams)),
                ("not-available", BadFrame::Refused(RejectCode::NotAvailable)),
            ]),
            (13, "What becomes of a frame with a wrong check sum or length?",
                "refused", "sends any command again that is refused so");
        wrong_length: RejectCode = RejectCode::BadParams, CODES,
            (75, "With what is a wrong length of data refused?",
                "any other code", "never sends one");
        unknown_code: RejectCode = RejectCode::NotAvailable, CODES,
            (75, "With what is an unknown code refused?",
                "any other code", "never sends one");
        answer_length: AnswerLength = AnswerLength::Four,
            Choice(&[("four", AnswerLength::Four), ("as-command", AnswerLength::AsCommand)]),
            (139, "What is the column RR, and how long are the data of an answer?",
                "as long as those of the command", "awaits so many bytes");
        both_bits: BothBits = BothBits::Unchanged,
            Choice(&[("unchanged", BothBits::Unchanged), ("set", BothBits::Set), ("clear", BothBits::Clear)]),
            (75, "What does an output do whose bit is in CLR and in SET?",
                "set, cleared", "sends such bits in neither");
        silent_while_changing: bool = false, FLAG,
            (79, "Does a device answer while its mode changes?",
                "silence", "asks until it is over");
        refuses_beyond_ceilings: bool = false, FLAG,
            (83, "What becomes of speeds and rates beyond their ceilings?",
                "refused as BADPARAMS", "asks for no more than its own");
        step_from: StepFrom = StepFrom::Setpoint,
            Choice(&[("setpoint", StepFrom::Setpoint), ("target", StepFrom::Target)]),
            (83, "What does STEP count from?",
                "the target of the move under way", "hands the distance on; follows and moves by GOTO");
        clamps_targets: bool = false, FLAG,
            (83, "What becomes of targets outside the position limits?",
                "moved to the limit", "says where the drive stands instead");
        limit_stop: LimitStop = LimitStop::Emergency, Choice(&[
                ("emergency", LimitStop::Emergency),
                ("deceleration", LimitStop::Deceleration),
                ("at-once", LimitStop::AtOnce),
            ]),
            (83, "How does a drive stop on LIMP and LIMN?",
                "with DecMax, without ramp", "sees it stop");
        home_position: HomePosition = HomePosition::IsOffset,
            Choice(&[("is-offset", HomePosition::IsOffset), ("goes-offset", HomePosition::GoesOffset)]),
            (85, "What is PosOffset to homing?",
                "the way to go on by, to position 0", "takes the position that the drive shows");
        applies_words_at_once: bool = false, FLAG,
            (93, "When does a 32-bit parameter change?",
                "with each of its words", "sets the high word last");
        extends_signs: bool = true, FLAG,
            (126, "Are signs of 16-bit variables extended?",
                "0 in the upper half", "reads the lower half");
        acc_current: AccCurrent = AccCurrent::At86,
            Choice(&[("86", AccCurrent::At86), ("85", AccCurrent::At85)]),
            (143, "Where is Acc_Current?",
                "85, and Dec_Setpoint cannot be read", "does without it");
        zero_rate: ZeroRate = ZeroRate::AsAcceleration,
            Choice(&[("as-acceleration", ZeroRate::AsAcceleration), ("unlimited", ZeroRate::Unlimited)]),
            (147, "What is a DecMax or DecLim of 0?",
                "no ceiling", "checks its own deceleration by it");
        set_effect: SetEffect = SetEffect::AtOnce, Choice(&[
                ("at-once", SetEffect::AtOnce),
                ("with-mode", SetEffect::WithMode),
                ("restarts-mode", SetEffect::RestartsMode),
            ]),
            (148, "When does SET take effect?",
                "when a mode begins, or it begins the mode anew", "chooses the mode anew when enabled, or waits for it");
    }
    others {
        "Wire.frame_timeout" = "5ms",
            (9, "What silence ends a frame that is not whole?",
                "any; 86.8 µs on the device", "writes every frame in one piece");
        "SmartDriveOptions.silence" = "0ns",
            (9, "What silence does the driver keep before a command?",
                "any", "waits so long after an answer");
        "Wire.response" = "2ms",
            (10, "How long does a device take for its answer?",
                "0 to 50 ms", "waits up to its deadline");
        "SmartDriveOptions.turnaround" = "80ms",
            (10, "How long may a drive take for its answer until its turnaround is measured?",
                "any", "asks again, and gives up after three losses");
        "Wire.execution" = "OnArrival",
            (10, "When in that time does a device carry a command out?",
                "in the middle, before the answer", "stamps samples so");
        "SmartDriveOptions.execution" = "Between",
            (10, "When does the driver take it to be carried out?",
                "on arrival, before the answer", "stamps samples so");
        "DeviceOptions.configured_mode" = "Off",
            (77, "Which mode does power-up choose?",
                "any other", "looks at the mode before it chooses one");
        "DeviceOptions.mode_change" = "250ms",
            (79, "How long does a change of mode take?",
                "any time", "waits SmartDriveOptions.mode_change at most");
        "DeviceOptions.boot" = "300ms",
            (79, "How long is a device silent after RESET?",
                "any time", "returns at once, and gets no answer meanwhile");
        "DeviceOptions.homing" = "HomingOptions { input: Go, positive: false, timeout: 30s }",
            (85, "Where is the home switch, in which direction, how long is it sought?",
                "any input, both directions, any time", "waits SmartDriveOptions.homing at most");
        "DeviceOptions.layout" = "Diagram",
            (0, "Which layout have the trajectory flags?",
                "table", "reads both");
    }
}
