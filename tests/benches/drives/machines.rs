//! Machines on the measured devices: a gantry on a board, on a bus, and on a module with a board.

use std::path::Path;
use twin_machine::Machine;

/// 320, 320 and 640 increments per mm.
const GANTRY3: &str = include_str!("../../../machines/gantry3.toml");

/// A gantry on a board: X, Y, Z.
pub(crate) fn on_board() -> Machine {
    machine(GANTRY3)
}

/// The same on a bus of three drives that answer after `turnaround_ms`.
pub(crate) fn on_bus(turnaround_ms: f64) -> Machine {
    let bus = format!("\"smartdrive\"\nemulated_turnaround_ms = {turnaround_ms:?}");
    let text = GANTRY3.replace("\"interpcnc\"", &bus);
    let addressed = [("X", 1), ("Y", 2), ("Z", 3)].iter().fold(text, |text, (axis, address)| {
        text.replace(&format!("drive_axis = \"{axis}\""), &format!("drive_address = {address}"))
    });
    machine(&addressed)
}

/// X and Y on a module, Z on a board.
pub(crate) fn on_module() -> Machine {
    let module = "[[drives]]\nname = \"module\"\nkind = \"bim2ax\"\n\n[[drives]]";
    let text = GANTRY3
        .replacen("[[drives]]", module, 1)
        .replace("drive = \"board\"\ndrive_axis = \"X\"", "drive = \"module\"\ndrive_axis = \"1\"")
        .replace("drive = \"board\"\ndrive_axis = \"Y\"", "drive = \"module\"\ndrive_axis = \"2\"");
    machine(&text)
}

fn machine(text: &str) -> Machine {
    match Machine::parse(Path::new("gantry3.toml"), text) {
        Ok(machine) => machine,
        Err(problems) => panic!("{problems:#?}"),
    }
}
