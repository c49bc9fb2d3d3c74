//! Repair commands: `twin drive` command lines that correct what a start-up check has found, for the user to copy.

use crate::emulated::software_limits;
use twin_bim2ax::protocol::parameter::{AxisParameter, Parameter};
use twin_bim2ax::{ByteOrder, MOST_POSITION, ModuleAxis};
use twin_drives::ParameterId;
use twin_interpcnc::{Parity, protocol::parameters};
use twin_machine::{Axis, DriveFamily, Machine};
use twin_smartdrive::protocol::parameters::{PARAMETERS, POSITION_MAX, POSITION_MIN};

/// Beginning of the line that makes set parameters take effect.
pub(crate) const THEN: &str = "then:";

/// The command `twin drive FAMILY --port …` for a device of the machine file, with all options of its line; `address`
/// is that of a drive on a bus.
pub(crate) fn command(machine: &Machine, device: usize, address: usize) -> Option<String> {
    let entry = machine.drives.get(device)?;
    let port = quoted(entry.port.as_deref().unwrap_or("PORT"));
    let command = match entry.family() {
        DriveFamily::InterpCnc(board) => {
            let address = board.address;
            let baud = match board.baud {
                115_200 => String::new(),
                baud => format!(" --baud {baud}"),
            };
            let parity = match board.parity {
                Parity::None => "",
                Parity::Even => " --parity even",
                Parity::Odd => " --parity odd",
            };
            let echo = if board.echo { " --echo" } else { "" };
            format!("twin drive interpcnc --port {port} --address {address}{baud}{parity}{echo}")
        }
        DriveFamily::SmartDrive(_) => {
            format!("twin drive smartdrive --port {port} --address {address}")
        }
        DriveFamily::Bim2Ax(module) => {
            let map = module.map_offset.map_or(String::new(), |at| format!(" --map {at}"));
            let little =
                if module.byte_order == ByteOrder::Little { " --little-endian" } else { "" };
            format!("twin drive bim2ax --port {port}{map}{little}")
        }
        DriveFamily::Other => return None,
    };
    let deadline = entry.answer_ms.map_or(String::new(), |ms| format!(" --deadline {ms}"));
    let assumed = entry.assumed.iter();
    let assumed =
        assumed.map(|(name, value)| format!(" --assume {}", quoted(&format!("{name}={value}"))));
    Some(command + &deadline + &assumed.collect::<String>())
}

/// The command that moves an axis of the machine by hand, to a position (m or rad) or by ten millimetres or degrees, at this
/// part of its largest velocity where the command wants one.
pub(crate) fn move_by_hand(
    machine: &Machine,
    axis: usize,
    to: Option<f64>,
    part: f64,
) -> Option<String> {
    let axis = machine.axes.get(axis)?;
    let (place, counting) = (axis.drive.as_ref()?, axis.counting()?);
    let device = machine.drives.get(place.device)?;
    let command = command(machine, place.device, place.index)?;
    let (word, counts) = match to {
        Some(to) => ("move", counting.whole(to)?),
        None => ("jog", counting.whole(axis.to_si(10.0))?),
    };
    let speed = (counting.increments(axis.max_velocity).abs() * part).max(1.0);
    Some(match device.family() {
        DriveFamily::InterpCnc(_) => {
            format!(
                "{command} {word} {} {counts} --speed {speed:.0}",
                device.axis_name(place.index)
            )
        }
        DriveFamily::SmartDrive(_) => format!("{command} {word} {counts}"),
        DriveFamily::Bim2Ax(_) => {
            format!("{command} {word} {} {counts}", device.axis_name(place.index))
        }
        DriveFamily::Other => return None,
    })
}

/// The command that gives a parameter of a device a value, which may be a word for one.
pub(crate) fn set_to(
    machine: &Machine,
    device: usize,
    id: ParameterId,
    value: &str,
) -> Option<String> {
    let command = command(machine, device, id.address.into())?;
    let name = match machine.drives.get(device)?.family() {
        DriveFamily::InterpCnc(_) => parameters::name(id.number).unwrap_or(id.number.to_string()),
        DriveFamily::SmartDrive(_) => {
            let known = PARAMETERS.iter().find(|entry| entry.index == id.number);
            known.map_or(id.number.to_string(), |entry| entry.name.to_owned())
        }
        DriveFamily::Bim2Ax(_) => {
            Parameter::from_number(id.number).map_or(id.number.to_string(), Parameter::word)
        }
        DriveFamily::Other => return None,
    };
    Some(format!("set it: {command} set {name} {value}"))
}

/// The commands that give a parameter of a device a value, and let it count.
pub(crate) fn set(machine: &Machine, device: usize, id: ParameterId, value: i64) -> Vec<String> {
    let set = set_to(machine, device, id, &value.to_string());
    set.into_iter().chain(then(machine, device, id)).collect()
}

/// The command that lets a parameter count once it is set; none where it does at once, and is kept.
fn then(machine: &Machine, device: usize, id: ParameterId) -> Option<String> {
    let command = command(machine, device, id.address.into())?;
    let (word, why) = match machine.drives.get(device)?.family() {
        // They are kept as soon as they are set.
        DriveFamily::InterpCnc(_) | DriveFamily::Other => return None,
        DriveFamily::SmartDrive(_) => {
            ("save", "keeps it when the drive is switched off; its position becomes 0")
        }
        DriveFamily::Bim2Ax(_) => Parameter::from_number(id.number)
            .filter(|parameter| parameter.needs_reset())
            .map(|_| ("reset", "lets it act; positions and homing are lost"))?,
    };
    Some(format!("{THEN}   {command} {word}   ({why})"))
}

/// The commands that give the device the software limits of the machine file, and what the machine file would have to say for
/// the device's; none for families without any.
pub(crate) fn set_limits(machine: &Machine, device: usize, axis: &Axis) -> Vec<String> {
    let Some((entry, place)) = machine.drives.get(device).zip(axis.drive.as_ref()) else {
        return Vec::new();
    };
    let (address, numbers, most) = match entry.family() {
        DriveFamily::InterpCnc(_) | DriveFamily::Other => return Vec::new(),
        DriveFamily::SmartDrive(_) => {
            let address = u8::try_from(place.index).unwrap_or(0);
            (address, [POSITION_MIN, POSITION_MAX].map(Some), [i32::MIN, i32::MAX])
        }
        DriveFamily::Bim2Ax(_) => {
            let Some(on_module) = ModuleAxis::ALL.get(place.index) else { return Vec::new() };
            let limits = [AxisParameter::SoftMinus, AxisParameter::SoftPlus];
            let numbers = limits.map(|limit| Parameter::Axis(limit, *on_module).number());
            (0, numbers, [-MOST_POSITION, MOST_POSITION])
        }
    };
    let [low, high] = most;
    let wanted = software_limits(axis).unwrap_or(most).map(|limit| limit.clamp(low, high));
    let commands = numbers.into_iter().zip(wanted).filter_map(|(number, limit)| {
        Some(set(machine, device, ParameterId { address, number: number? }, limit.into()))
    });
    let mut said: Vec<String> = Vec::new();
    for line in commands.flatten() {
        // What makes them count is said once, at the end.
        if let Some(place) = said.iter().position(|other| *other == line) {
            said.remove(place);
        }
        said.push(line);
    }
    let [least, most] = ["min", "max"].map(|end| format!("`position_{end}_{}`", axis.unit()));
    let (name, file) = (&axis.name, machine.path.display());
    said.push(format!("or {least} and {most} of axis {name} in {file}"));
    said
}

/// A path as a shell takes it.
fn quoted(path: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+:@%=,".contains(c);
    if !path.is_empty() && path.chars().all(plain) {
        path.to_owned()
    } else {
        format!("'{}'", path.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::{command, quoted};
    use std::path::Path;
    use twin_machine::Machine;

    /// What is copied drives the device as the run does, also where the manual leaves something open.
    #[test]
    fn commands_assume_what_the_machine_file_assumes() {
        let text = include_str!("../machines/gantry3.toml");
        let with = |lines: &str| {
            let text = text.replacen("[preparation]", &format!("{lines}\n[preparation]"), 1);
            let machine = Machine::parse(Path::new("machine.toml"), &text).unwrap();
            command(&machine, 0, 1).unwrap()
        };
        let plain = with("");
        assert!(plain.starts_with("twin drive interpcnc --port /dev/ttyUSB0"), "{plain}");
        let said = with("[drives.assumptions]\nmost_read = \"32\"\nbroadcasts = \"false\"\n");
        let [read, broadcasts] = ["most_read=32", "broadcasts=false"];
        assert_eq!(
            said.len(),
            plain.len() + read.len() + broadcasts.len() + 2 * " --assume ".len()
        );
        for assumed in [read, broadcasts] {
            assert!(said.contains(&format!(" --assume {assumed}")), "{said}");
        }
        // What is assumed anyway is not said.
        assert_eq!(with("[drives.assumptions]\nbroadcasts = \"true\"\n"), plain);
    }

    #[test]
    fn paths_are_quoted_for_a_shell_where_they_have_to_be() {
        assert_eq!(quoted("/dev/serial/by-id/usb-FTDI_1:0"), "/dev/serial/by-id/usb-FTDI_1:0");
        assert_eq!(quoted("my board"), "'my board'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
    }
}
