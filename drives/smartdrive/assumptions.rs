//! Assumptions about the drives where the manual is silent.
//!
//! Paragraphs are those of the digest that the tests list (`drives/tests/assumptions.rs`).

use super::{AnswerLength, RejectCode};
use twin_drives::assumptions::{Choice, assumptions};

/// Reaction of a drive to a frame for itself whose check sum or length is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BadFrame {
    /// It says nothing.
    Silent,
    /// It refuses it.
    Refused(RejectCode),
}

/// Meaning of `PosOffset` for homing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomePosition {
    /// The position where the switch releases.
    IsOffset,
    /// The way that the drive goes on from there, at `VelExitHome`; its end is position 0.
    GoesOffset,
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
        answer_length: AnswerLength = AnswerLength::Four,
            Choice(&[("four", AnswerLength::Four), ("as-command", AnswerLength::AsCommand)]),
            (139, "What is the column RR, and how long are the data of an answer?",
                "as long as those of the command", "awaits so many bytes");
        home_position: HomePosition = HomePosition::IsOffset,
            Choice(&[("is-offset", HomePosition::IsOffset), ("goes-offset", HomePosition::GoesOffset)]),
            (85, "What is PosOffset to homing?",
                "the way to go on by, to position 0", "takes the position that the drive shows");
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
        "SmartDriveOptions.deadline" = "100ms",
            (10, "How long does the driver wait for an answer?",
                "any", "gives up then");
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
