//! `[coupling]` of cams in TOML: inputs of `MC_CamIn`.

use crate::cam_file::form::{Coupling, START_MODES, WANTED, no_scaling};
use crate::cam_file::toml_form::ANY;
use crate::section::Section;
use twin_cam::CamInput;

/// Reads the section. What is wrong with it is noted there, and a file with a note is refused.
pub(super) fn coupling(section: &Section<'_>) -> Coupling {
    let number = |key: &str, default: f64| section.number(key, ANY).unwrap_or(default);
    let scaling = |key: &str, default: f64| {
        let value = number(key, default);
        if section.has(key)
            && let Some(message) = no_scaling(&format!("`{key}`"), value)
        {
            section.complain_at(key, message);
        }
        value
    };
    let magnitude = |key: &str| section.number(key, 0.0..=*ANY.end()).unwrap_or(0.0);
    let start_mode = section.choice("start_mode", &START_MODES).unwrap_or_default();
    let [master_offset, slave_offset] =
        ["master_offset", "slave_offset"].map(|key| number(key, 0.0));
    let [master_scaling, slave_scaling] =
        ["master_scaling", "slave_scaling"].map(|key| scaling(key, 1.0));
    let [velocity_difference, acceleration, deceleration, tappet_hysteresis] =
        ["velocity_difference", "acceleration", "deceleration", "tappet_hysteresis"].map(magnitude);
    // A wanted value that the file leaves out is that of the input.
    let [one, two, three, four] = WANTED;
    let wanted = [
        number(one, master_offset),
        scaling(two, master_scaling),
        number(three, slave_offset),
        scaling(four, slave_scaling),
    ];
    let input = CamInput {
        master_offset,
        master_scaling,
        slave_offset,
        slave_scaling,
        start_mode,
        velocity_difference,
        acceleration,
        deceleration,
        tappet_hysteresis,
        // In the file it is a key of its own next to these inputs.
        tappet_dead_time_s: 0.0,
    };
    let wanted = WANTED.iter().any(|key| section.has(key)).then_some(wanted);
    Coupling { input, dead_time_s: number("dead_time_s", 0.0), wanted }
}
