//! What the manual leaves open about the drives, and what is assumed instead.
//!
//! Paragraphs are those of the digest that the tests list (`drives/tests/assumptions.rs`).

use super::{
    RejectCode,
    parameters::{ACCELERATION_CURRENT, DECELERATION_SETPOINT},
};

/// What a drive makes of a frame for itself whose check sum or length is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BadFrame {
    /// It says nothing.
    Silent,
    /// It refuses it.
    Refused(RejectCode),
}

/// How long the data of an answer are: the column RR of the table of commands, which the manual does not explain.
///
/// The manual draws answers of nine bytes and all entries of RR are 0, but the check sum of an answer goes over
/// `RSP_DAT_LEN` bytes of data, as that of a command over `CMD_DAT_LEN` = 4·2^EE.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnswerLength {
    /// RR is the exponent of the answer, `RSP_DAT_LEN` = 4·2^RR: four bytes.
    Four,
    /// RR is none, and the answer has as many bytes of data as its command, 4·2^EE: what is drawn comes first, zeros
    /// follow up to TAG.
    AsCommand,
}

/// What an output does whose bit is in both bytes of IOUPDATE.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BothBits {
    /// Stays as it is.
    Unchanged,
    /// Becomes active.
    Set,
    /// Becomes inactive.
    Clear,
}

/// Where STEP counts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepFrom {
    /// The set-point, where that is just now.
    Setpoint,
    /// The target of the GOTO or STEP under way, so that steps add up; without one the set-point.
    Target,
}

/// How a drive brakes on LIMP and LIMN.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitStop {
    /// With `DecLim`.
    Emergency,
    /// With `DecMax`.
    Deceleration,
    /// Without ramp.
    AtOnce,
}

/// What `PosOffset` is to homing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomePosition {
    /// The position where the switch releases.
    IsOffset,
    /// The way that the drive goes on from there, at `VelExitHome`; its end is position 0.
    GoesOffset,
}

/// Where the variable `Acc_Current` is; the manual prints 85, as for `Dec_Setpoint`.
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

/// What a `DecMax` or `DecLim` of 0 means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ZeroRate {
    /// `AccMax`.
    AsAcceleration,
    /// No ceiling: what is asked for counts, and the largest is a stop without ramp.
    Unlimited,
}

/// When the drive goes by a value of SET; GET shows it at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetEffect {
    /// At once.
    AtOnce,
    /// When a mode next begins.
    WithMode,
    /// SET begins the present mode anew (RTD), which takes as long as MODE and loses the position.
    RestartsMode,
}

/// What is assumed where the manual is silent. The emulated drive behaves by it, and the driver expects it where it
/// matters to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "questions that have nothing to do with each other"
)]
pub struct Assumptions {
    /// What becomes of a frame with a wrong check sum or length (§1). The driver sends any command again that is
    /// refused so. Default silence.
    pub bad_frame: BadFrame,
    /// With what a command is refused whose code goes with another length of data (§2). Default BADPARAMS.
    pub wrong_length: RejectCode,
    /// With what a code is refused that is none (§2). Default NOTAVAILABLE.
    pub unknown_code: RejectCode,
    /// How many bytes of data an answer has, column RR (§5). The driver awaits as many. Default four.
    pub answer_length: AnswerLength,
    /// Bits in both bytes of IOUPDATE (§2); the driver sends none. Default unchanged.
    pub both_bits: BothBits,
    /// While a mode changes the drive is silent instead of answering PING, READ and GET and refusing the rest as
    /// WORKING (§2). The driver waits for it either way. Default false.
    pub silent_while_changing: bool,
    /// Speeds and rates beyond their ceilings are refused as BADPARAMS instead of clamped (§2). The driver asks for no
    /// more than its options say, which its start-up check compares with the ceilings. Default false.
    pub refuses_beyond_ceilings: bool,
    /// Where STEP counts from (§2). Default the set-point.
    pub step_from: StepFrom,
    /// Targets outside the position limits are moved to the limit instead of refused as BADPARAMS (§2). The driver tells
    /// either. Default false.
    pub clamps_targets: bool,
    /// How LIMP and LIMN stop (§2). Default with `DecLim`.
    pub limit_stop: LimitStop,
    /// What `PosOffset` is to homing (§2). Default the position of the switch.
    pub home_position: HomePosition,
    /// Each word of a 32-bit parameter counts as soon as it is set, instead of both with the high one (§4), which the
    /// driver sets last. Default false.
    pub applies_words_at_once: bool,
    /// Variables of 16 bits with sign fill the upper half of the answer with their sign; else it is 0 (§4). The driver
    /// reads both. Default true.
    pub extends_signs: bool,
    /// Where `Acc_Current` is (§5). Default 86.
    pub acc_current: AccCurrent,
    /// What a `DecMax` or `DecLim` of 0 means (§5). Default `AccMax`.
    pub zero_rate: ZeroRate,
    /// When SET takes effect (§5). Default at once.
    pub set_effect: SetEffect,
}

impl Default for Assumptions {
    fn default() -> Self {
        Self {
            bad_frame: BadFrame::Silent,
            wrong_length: RejectCode::BadParams,
            unknown_code: RejectCode::NotAvailable,
            answer_length: AnswerLength::Four,
            both_bits: BothBits::Unchanged,
            silent_while_changing: false,
            refuses_beyond_ceilings: false,
            step_from: StepFrom::Setpoint,
            clamps_targets: false,
            limit_stop: LimitStop::Emergency,
            home_position: HomePosition::IsOffset,
            applies_words_at_once: false,
            extends_signs: true,
            acc_current: AccCurrent::At86,
            zero_rate: ZeroRate::AsAcceleration,
            set_effect: SetEffect::AtOnce,
        }
    }
}
