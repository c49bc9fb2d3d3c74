//! The assumptions about the drives by name.

use super::{
    AccCurrent, AnswerLength, Assumptions, BadFrame, BothBits, HomePosition, LimitStop,
    OPEN_QUESTIONS, RejectCode, SetEffect, StepFrom, ZeroRate,
};
use crate::{
    Assumed, AssumedError, OpenQuestion,
    assumed::{Said, field},
};

const CODES: [(&str, RejectCode); 5] = [
    ("generic", RejectCode::Generic),
    ("working", RejectCode::Working),
    ("bad-mode", RejectCode::BadMode),
    ("bad-params", RejectCode::BadParams),
    ("not-available", RejectCode::NotAvailable),
];

impl Assumed for Assumptions {
    const NAMES: &'static [&'static str] = &[
        "bad_frame",
        "wrong_length",
        "unknown_code",
        "answer_length",
        "both_bits",
        "silent_while_changing",
        "refuses_beyond_ceilings",
        "step_from",
        "clamps_targets",
        "limit_stop",
        "home_position",
        "applies_words_at_once",
        "extends_signs",
        "acc_current",
        "zero_rate",
        "set_effect",
    ];
    const QUESTIONS: &'static [OpenQuestion] = &OPEN_QUESTIONS;

    fn set(&mut self, name: &str, value: &str) -> Result<(), AssumedError> {
        let said = Said { name, value };
        match &*field(name) {
            "bad_frame" => {
                let refused = CODES.map(|(name, code)| (name, BadFrame::Refused(code)));
                let silent = [("silent", BadFrame::Silent)];
                said.choice(&mut self.bad_frame, &[&silent[..], &refused].concat())
            }
            "wrong_length" => said.choice(&mut self.wrong_length, &CODES),
            "unknown_code" => said.choice(&mut self.unknown_code, &CODES),
            "answer_length" => said.choice(
                &mut self.answer_length,
                &[("four", AnswerLength::Four), ("as-command", AnswerLength::AsCommand)],
            ),
            "both_bits" => said.choice(
                &mut self.both_bits,
                &[
                    ("unchanged", BothBits::Unchanged),
                    ("set", BothBits::Set),
                    ("clear", BothBits::Clear),
                ],
            ),
            "silent_while_changing" => said.yes_no(&mut self.silent_while_changing),
            "refuses_beyond_ceilings" => said.yes_no(&mut self.refuses_beyond_ceilings),
            "step_from" => said.choice(
                &mut self.step_from,
                &[("setpoint", StepFrom::Setpoint), ("target", StepFrom::Target)],
            ),
            "clamps_targets" => said.yes_no(&mut self.clamps_targets),
            "limit_stop" => said.choice(
                &mut self.limit_stop,
                &[
                    ("emergency", LimitStop::Emergency),
                    ("deceleration", LimitStop::Deceleration),
                    ("at-once", LimitStop::AtOnce),
                ],
            ),
            "home_position" => said.choice(
                &mut self.home_position,
                &[("is-offset", HomePosition::IsOffset), ("goes-offset", HomePosition::GoesOffset)],
            ),
            "applies_words_at_once" => said.yes_no(&mut self.applies_words_at_once),
            "extends_signs" => said.yes_no(&mut self.extends_signs),
            "acc_current" => said.choice(
                &mut self.acc_current,
                &[("86", AccCurrent::At86), ("85", AccCurrent::At85)],
            ),
            "zero_rate" => said.choice(
                &mut self.zero_rate,
                &[
                    ("as-acceleration", ZeroRate::AsAcceleration),
                    ("unlimited", ZeroRate::Unlimited),
                ],
            ),
            "set_effect" => said.choice(
                &mut self.set_effect,
                &[
                    ("at-once", SetEffect::AtOnce),
                    ("with-mode", SetEffect::WithMode),
                    ("restarts-mode", SetEffect::RestartsMode),
                ],
            ),
            _ => Err(AssumedError::Unknown { name: name.to_owned(), known: Self::NAMES }),
        }
    }
}
