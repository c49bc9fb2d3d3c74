//! The assumptions about the board by name.

use std::time::Duration;

use super::{Assumptions, BaudCode, BoardStop, OPEN_QUESTIONS, OutputCode};
use crate::{
    Assumed, AssumedError, OpenQuestion,
    assumed::{Said, field},
};

/// Longest time, ns, that makes sense.
const MOST_NS: i64 = 10_000_000_000;
const STOPS: [(&str, BoardStop); 2] =
    [("at-once", BoardStop::AtOnce), ("on-ramp", BoardStop::OnRamp)];

impl Assumed for Assumptions {
    const NAMES: &'static [&'static str] = &[
        "buffer_segments",
        "arguments_stay",
        "lock_coil",
        "silence",
        "most_read",
        "most_written",
        "segment_acceleration",
        "segment_start_stop",
        "broadcasts",
        "locked_exception",
        "busy_axis_refuses",
        "enable_loss",
        "enable_loss_keeps_segments",
        "limit_stop",
        "reversal_gap_ns",
        "home_one_by_one",
        "baud_code",
        "line_at_restart",
        "output_code",
        "eeprom_write_ns",
        "eeprom_refuses",
        "exceptions_address",
        "exceptions_value",
        "exceptions_failure",
    ];
    const QUESTIONS: &'static [OpenQuestion] = &OPEN_QUESTIONS;

    fn unit(name: &str) -> &'static str {
        match &*field(name) {
            "buffer_segments" => "segments",
            "silence" => "µs",
            "most_read" | "most_written" => "registers",
            "segment_acceleration" | "segment_start_stop" => "(number of a parameter)",
            "reversal_gap_ns" | "eeprom_write_ns" => "ns",
            "locked_exception" | "exceptions_address" | "exceptions_value"
            | "exceptions_failure" => "(code)",
            _ => "",
        }
    }

    fn set(&mut self, name: &str, value: &str) -> Result<(), AssumedError> {
        const BAUD: [(&str, BaudCode); 3] =
            [("raw", BaudCode::Raw), ("hundreds", BaudCode::Hundreds), ("index", BaudCode::Index)];
        const OUTPUT: [(&str, OutputCode); 2] =
            [("mask", OutputCode::Mask), ("number", OutputCode::Number)];
        let said = Said { name, value };
        match &*field(name) {
            "buffer_segments" => said.number(&mut self.buffer_segments, &(1..=1024)),
            "arguments_stay" => said.yes_no(&mut self.arguments_stay),
            "lock_coil" => said.yes_no(&mut self.lock_coil),
            "silence" => {
                // Microseconds.
                let silence = said.optional(&(1..=1_000_000))?;
                self.silence = silence.map(Duration::from_micros);
                Ok(())
            }
            "most_read" => said.number(&mut self.most_read, &(1..=125)),
            "most_written" => said.number(&mut self.most_written, &(1..=123)),
            "segment_acceleration" => said.number(&mut self.segment_acceleration, &(0..=383)),
            "segment_start_stop" => said.number(&mut self.segment_start_stop, &(0..=383)),
            "broadcasts" => said.yes_no(&mut self.broadcasts),
            "locked_exception" => {
                self.locked_exception = said.optional(&(1..=255))?;
                Ok(())
            }
            "busy_axis_refuses" => said.yes_no(&mut self.busy_axis_refuses),
            "enable_loss" => said.choice(&mut self.enable_loss, &STOPS),
            "enable_loss_keeps_segments" => said.yes_no(&mut self.enable_loss_keeps_segments),
            "limit_stop" => said.choice(&mut self.limit_stop, &STOPS),
            "reversal_gap_ns" => said.number(&mut self.reversal_gap_ns, &(0..=MOST_NS)),
            "home_one_by_one" => said.yes_no(&mut self.home_one_by_one),
            "baud_code" => said.choice(&mut self.baud_code, &BAUD),
            "line_at_restart" => said.yes_no(&mut self.line_at_restart),
            "output_code" => said.choice(&mut self.output_code, &OUTPUT),
            "eeprom_write_ns" => said.number(&mut self.eeprom_write_ns, &(0..=MOST_NS)),
            "eeprom_refuses" => said.yes_no(&mut self.eeprom_refuses),
            "exceptions_address" => said.number(&mut self.exceptions.address, &(1..=255)),
            "exceptions_value" => said.number(&mut self.exceptions.value, &(1..=255)),
            "exceptions_failure" => said.number(&mut self.exceptions.failure, &(1..=255)),
            _ => Err(AssumedError::Unknown { name: name.to_owned(), known: Self::NAMES }),
        }
    }
}
