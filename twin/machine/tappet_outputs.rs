//! `[[tappet_outputs]]` and `[[switch_outputs]]`: outputs of drives that follow the tappets of cams and the switches of a path.

use super::drives::Seen;
use crate::section::Section;
use crate::switch_points::{SWITCHES, SwitchOutput};
use crate::tappets::TappetOutput;
use twin_drives::family::Family;
use twin_interpcnc::InterpCncFamily;
use twin_interpcnc::protocol::registers::OUTPUTS as BOARD_OUTPUTS;

/// Reads the tappet outputs; `drives` are the devices with the number of their axes.
pub(super) fn read(root: &Section<'_>, drives: &[(&Seen, usize)]) -> Vec<TappetOutput> {
    let mut outputs: Vec<TappetOutput> = Vec::new();
    for section in root.sections("tappet_outputs") {
        let axis = section.required_text("axis").map(str::to_owned);
        let group = section.required_integer("group", i16::MIN.into()..=i16::MAX.into());
        let device = device(&section, drives);
        let (_, most) = device.unwrap_or((0, i64::from(BOARD_OUTPUTS)));
        let output = section.required_integer("output", 1..=most);
        let group = group.and_then(|group| i16::try_from(group).ok());
        let output = output.and_then(|output| u8::try_from(output).ok());
        if let (Some(axis), Some(group), Some((device, _)), Some(output)) =
            (axis, group, device, output)
        {
            let one = TappetOutput { axis, group, device, output };
            if outputs.iter().any(|other| (other.device, other.output) == (device, output)) {
                let message =
                    format!("output {output} of this drive follows other tappets already");
                section.complain_at("output", message);
            } else {
                outputs.push(one);
            }
        }
        section.finish();
    }
    outputs
}

/// Reads the outputs that follow switches of the path, none of which follows `tappets` already.
pub(super) fn read_switches(
    root: &Section<'_>,
    drives: &[(&Seen, usize)],
    tappets: &[TappetOutput],
) -> Vec<SwitchOutput> {
    let mut outputs: Vec<SwitchOutput> = Vec::new();
    for section in root.sections("switch_outputs") {
        let number = section.required_integer("h", 1..=SWITCHES.into());
        let device = device(&section, drives);
        let (_, most) = device.unwrap_or((0, i64::from(BOARD_OUTPUTS)));
        let output = section.required_integer("output", 1..=most);
        let [number, output] =
            [number, output].map(|value| value.and_then(|value| u8::try_from(value).ok()));
        if let (Some(number), Some((device, _)), Some(output)) = (number, device, output) {
            let by_tappets = tappets.iter().map(|other| (other.device, other.output));
            let by_switches = outputs.iter().map(|other| (other.device, other.output));
            let mut taken = by_tappets.chain(by_switches);
            if taken.any(|other| other == (device, output)) {
                let message =
                    format!("output {output} of this drive follows something else already");
                section.complain_at("output", message);
            } else {
                outputs.push(SwitchOutput { number, device, output });
            }
        }
        section.finish();
    }
    outputs
}

/// True for boards, whose outputs are for the machine.
fn is_board(family: &dyn Family) -> bool {
    family.kind() == InterpCncFamily.kind()
}

/// The device and its number of outputs; the first one with outputs unless the section names one.
fn device(section: &Section<'_>, drives: &[(&Seen, usize)]) -> Option<(usize, i64)> {
    // A kind that does not exist is reported elsewhere.
    let outputs = |(seen, axes): &(&Seen, usize)| {
        seen.family.map_or(0, |family| i64::from(family.outputs(*axes)))
    };
    let Some(name) = section.text("drive") else {
        // As with M functions: a board rather than others.
        let with = || drives.iter().enumerate().filter(|(_, drive)| outputs(drive) > 0);
        let board = with().find(|(_, (seen, _))| seen.family.is_some_and(is_board));
        let found = board.or_else(|| with().next());
        if found.is_none() && !section.has("drive") {
            section.complain("there is no [[drives]] that has outputs".to_owned());
        }
        return found.map(|(index, drive)| (index, outputs(drive)));
    };
    let Some((index, drive)) = drives.iter().enumerate().find(|(_, (seen, _))| seen.name == name)
    else {
        section.complain_at("drive", format!("there is no drive \"{name}\" among [[drives]]"));
        return None;
    };
    let count = outputs(drive);
    if count == 0 && drive.0.family.is_some() {
        section.complain_at("drive", format!("drive \"{name}\" has no outputs"));
        return None;
    }
    (count > 0).then_some((index, count))
}
