//! `[[m_functions]]`: outputs that M functions switch.

use crate::section::Section;
use std::ops::RangeInclusive;
use twin_interpcnc::protocol::registers::OUTPUTS;

/// `[[m_functions]]` of a machine file: outputs that an M function switches.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MFunction {
    /// Its number.
    pub number: u16,
    /// Outputs of the drives that it switches on, from 1.
    pub outputs_on: Vec<u8>,
    /// Outputs that it switches off.
    pub outputs_off: Vec<u8>,
    /// Time from its beginning until the path goes on, ns: a spindle comes up to speed.
    pub time_ns: i64,
}

/// Outputs of the board.
const OUTPUT: RangeInclusive<i64> = 1..=OUTPUTS as i64;

/// Reads the M functions; `drives` is true if there is a device with outputs.
pub(super) fn read(root: &Section<'_>, drives: bool) -> Vec<MFunction> {
    let mut functions: Vec<MFunction> = Vec::new();
    for section in root.sections("m_functions") {
        let number = section.required_integer("m", 0..=65_535);
        let outputs = |key| {
            let outputs = section.integers(key, &OUTPUT, usize::from(OUTPUTS));
            outputs.into_iter().filter_map(|output| u8::try_from(output).ok()).collect::<Vec<_>>()
        };
        let (outputs_on, outputs_off) = (outputs("outputs_on"), outputs("outputs_off"));
        let time_ms = section.integer("time_ms", 0..=86_400_000).unwrap_or(0);
        if !(drives || outputs_on.is_empty() && outputs_off.is_empty()) {
            section.complain("there is no [[drives]] that has outputs");
        }
        let keys = ["outputs_on", "outputs_off", "time_ms"];
        if !keys.into_iter().any(|key| section.has(key)) {
            section.complain("it has neither outputs nor `time_ms`");
        }
        if let Some(both) = outputs_on.iter().find(|output| outputs_off.contains(output)) {
            section.complain_at(
                "outputs_off",
                format!("output {both} is switched on and off by the same M function"),
            );
        }
        if let Some(number) = number.and_then(|number| u16::try_from(number).ok()) {
            if functions.iter().any(|function| function.number == number) {
                section.complain_at("m", format!("M{number} is there already"));
            }
            let time_ns = time_ms * 1_000_000;
            functions.push(MFunction { number, outputs_on, outputs_off, time_ns });
        }
        section.finish();
    }
    functions
}
