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
        let group = group.and_then(|group| i16::try_from(group).ok());
        let output = output(&section, drives);
        let taken: Vec<_> = outputs.iter().map(|other| (other.device, other.output)).collect();
        if let (Some(axis), Some(group), Some((device, output))) = (axis, group, output)
            && is_free(&section, (device, output), &taken, "other tappets")
        {
            outputs.push(TappetOutput { axis, group, device, output });
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
        let number = number.and_then(|number| u8::try_from(number).ok());
        let output = output(&section, drives);
        let by_tappets = tappets.iter().map(|other| (other.device, other.output));
        let by_switches = outputs.iter().map(|other| (other.device, other.output));
        let taken: Vec<_> = by_tappets.chain(by_switches).collect();
        if let (Some(number), Some((device, output))) = (number, output)
            && is_free(&section, (device, output), &taken, "something else")
        {
            outputs.push(SwitchOutput { number, device, output });
        }
        section.finish();
    }
    outputs
}

/// The device and the output that a section names.
fn output(section: &Section<'_>, drives: &[(&Seen, usize)]) -> Option<(usize, u8)> {
    let device = device(section, drives);
    let (_, most) = device.unwrap_or((0, i64::from(BOARD_OUTPUTS)));
    let output = section.required_integer("output", 1..=most);
    Some((device?.0, u8::try_from(output?).ok()?))
}

/// Complains if an output is among those `taken`, by `others`.
fn is_free(section: &Section<'_>, at: (usize, u8), taken: &[(usize, u8)], others: &str) -> bool {
    let free = !taken.contains(&at);
    if !free {
        let message = format!("output {} of this drive follows {others} already", at.1);
        section.complain_at("output", message);
    }
    free
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
            section.complain("there is no [[drives]] that has outputs");
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
