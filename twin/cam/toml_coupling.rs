//! `[coupling]` of cams in TOML: what `MC_CamIn` gets.

use super::form::{Coupling, START_MODES, WANTED, no_scaling};
use super::toml_form::ANY;
use crate::section::Section;
use twin_motion::cam::{CamInput, StartMode};

pub(super) fn coupling(section: &Section<'_>) -> Option<Coupling> {
    let number = |key: &str, default: f64| {
        if section.has(key) {
            section.number(key, ANY)
        } else {
            section.accept(key);
            Some(default)
        }
    };
    let least = |key: &str| {
        let range = 0.0..=*ANY.end();
        if section.has(key) {
            section.number(key, range)
        } else {
            section.accept(key);
            Some(0.0)
        }
    };
    let modes: Vec<(&str, StartMode)> = START_MODES.to_vec();
    let start_mode = if section.has("start_mode") {
        section.choice("start_mode", &modes)
    } else {
        section.accept("start_mode");
        Some(StartMode::Absolute)
    };
    // All of them are looked at, so that what is known is known.
    let [master_offset, slave_offset] =
        ["master_offset", "slave_offset"].map(|key| number(key, 0.0));
    let [master_scaling, slave_scaling] =
        ["master_scaling", "slave_scaling"].map(|key| number(key, 1.0));
    let [velocity_difference, acceleration, deceleration, tappet_hysteresis] =
        ["velocity_difference", "acceleration", "deceleration", "tappet_hysteresis"].map(least);
    let said = WANTED.iter().any(|key| section.has(key));
    let usual = [master_offset, master_scaling, slave_offset, slave_scaling];
    let mut wanted = usual;
    for ((slot, key), usual) in wanted.iter_mut().zip(WANTED).zip(usual) {
        // What is not said is wanted as it is.
        *slot = number(key, usual.unwrap_or_default());
    }
    let dead_time_s = number("dead_time_s", 0.0);
    let [_, two, _, four] = WANTED;
    let mut moves = true;
    for (key, value) in [
        ("master_scaling", master_scaling),
        ("slave_scaling", slave_scaling),
        (two, wanted[1].filter(|_| section.has(two))),
        (four, wanted[3].filter(|_| section.has(four))),
    ] {
        if let Some(message) = value.and_then(|value| no_scaling(&format!("`{key}`"), value)) {
            section.complain_at(key, message);
            moves = false;
        }
    }
    let input = CamInput {
        master_offset: master_offset?,
        master_scaling: master_scaling?,
        slave_offset: slave_offset?,
        slave_scaling: slave_scaling?,
        start_mode: start_mode?,
        velocity_difference: velocity_difference?,
        acceleration: acceleration?,
        deceleration: deceleration?,
        tappet_hysteresis: tappet_hysteresis?,
        // Of the file it stands beside these inputs.
        tappet_dead_time_s: 0.0,
    };
    let wanted = [wanted[0]?, wanted[1]?, wanted[2]?, wanted[3]?];
    let coupling = Coupling { input, dead_time_s: dead_time_s?, wanted: said.then_some(wanted) };
    moves.then_some(coupling)
}
