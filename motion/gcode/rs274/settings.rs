//! Offsets set by the program: coordinate systems and tools (G10), G52, G92, home positions (G28.1, G30.1), tool offset
//! (G43 to G43.2, G49).

use super::block::{Block, Letter, Letters};
use super::error::{DecodeError, Problem};
use super::input_output::rounded;
use super::offsets::{AxisValues, sum};
use super::options::Position;
use super::output::Output;
use super::state::State;
use super::tool_table::Tool;
use super::word::{OneShot, ToolLength};
use twin_number::Short;

/// Error of a block that sets an offset.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OffsetError {
    /// G10 without an L that it has.
    #[error(
        "{}; G10 needs L1, L10 or L11 (tool), or L2 or L20 (coordinate system)",
        .0.map_or_else(|| "L is missing".to_owned(), |l| format!("G10 has no L{l}"))
    )]
    Kind(Option<u32>),
    /// G10 L0 with a tool in the spindle.
    #[error("G10 L0 needs an empty spindle, but tool {0} is in it; program T0 M6 before it")]
    LoadedTool(u32),
    /// G10 for a tool without anything to set.
    #[error(
        "G10 L{0} sets nothing; add an axis word, R (radius), I and J (angles) or Q (orientation)"
    )]
    NothingToSet(u32),
    /// G43.2 with axis words.
    #[error(
        "{0} cannot be used with G43.2, which takes only H; give offsets in axis words with G43.1"
    )]
    AxisWithH(char),
    /// G59 P of Mach3 above 9.
    #[error(
        "the work offset G59 P{0} is not read: there are 1 to 9 (G54 to G59.3); set one of them to its values (G10 L2 P9) and select that"
    )]
    System(u32),
    /// An arc in G18 or G19 in a rotated coordinate system.
    #[error(
        "arcs in G18 and G19 are not supported in a coordinate system that is rotated by {} degrees; use G17, or a system without rotation (G10 L2 R0)",
        Short(*.0)
    )]
    RotatedArc(f64),
}

/// The largest angle of a rotary axis or a coordinate system, degrees, and the largest length, m.
const MAX_ANGLE: f64 = 1e9;
const MAX_LENGTH: f64 = 1e3;
/// The largest number of a tool's orientation, and of a coordinate system.
const MAX_DIGIT: f64 = 9.0;

impl State {
    /// The axis words of `block`, m and degrees.
    fn axis_values(&self, block: &Block) -> Result<AxisValues, Problem> {
        let mut values = AxisValues::default();
        for (slot, axis) in values.0.iter_mut().zip(Letter::AXES) {
            *slot = if Letters::ROTARY.contains(axis) {
                limited(block, axis, block.get(axis), MAX_ANGLE, "°")?
            } else {
                self.length(block, axis)?
            };
        }
        Ok(values)
    }

    /// The number of a word that is a length, m.
    pub(super) fn length(&self, block: &Block, letter: Letter) -> Result<Option<f64>, Problem> {
        let metres = block.get(letter).map(|length| self.units.to_metres(length));
        limited(block, letter, metres, MAX_LENGTH, " m")
    }

    /// G10, G28.1, G30.1, G52 and G92.
    pub(super) fn set_offsets(
        &mut self,
        shot: OneShot,
        block: &Block,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let machine = self.location.machine;
        match shot {
            OneShot::SetData => return self.set_data(block, out),
            OneShot::SaveHome(home) => self.offsets.save_home(home, &machine),
            OneShot::LocalOffset | OneShot::SetPosition => {
                let values = self.axis_values(block)?;
                if shot == OneShot::LocalOffset {
                    self.offsets.set_local(&values);
                } else {
                    self.offsets.set_g92(&machine, &values);
                }
                self.location.find_program(&self.offsets, self.units);
            }
            _ => {}
        }
        if shot == OneShot::SetPosition {
            // As programmed, without the rounding of the offset.
            for (program, axis) in self.location.program.iter_mut().zip(Letter::AXES) {
                *program = block.get(axis).unwrap_or(*program);
            }
        }
        Ok(())
    }

    /// G92.1 to G92.3.
    pub(super) fn switch_g92(&mut self, shot: OneShot) {
        match shot {
            OneShot::ClearOffset => self.offsets.clear_g92(),
            OneShot::SuspendOffset => self.offsets.suspend_g92(),
            OneShot::RestoreOffset => self.offsets.restore_g92(),
            _ => return,
        }
        self.location.find_program(&self.offsets, self.units);
    }

    /// G10.
    fn set_data(&mut self, block: &Block, out: &mut Output) -> Result<(), Problem> {
        let kind = block.whole(Letter::L, 0)?;
        match kind {
            // Reads the tool table again, which has not changed.
            Some(0) if self.tool != 0 => {
                Err(block.at(Letter::L, OffsetError::LoadedTool(self.tool)))
            }
            Some(0) => Ok(()),
            Some(l @ (1 | 10 | 11)) => self.set_tool_data(l, block, out),
            Some(l @ (2 | 20)) => self.set_system_data(l, block),
            _ => Err(block.at(Letter::L, OffsetError::Kind(kind))),
        }
    }

    /// G10 L2 and L20.
    fn set_system_data(&mut self, l: u32, block: &Block) -> Result<(), Problem> {
        let system =
            block.whole_within(Letter::P, [0.0, MAX_DIGIT])?.ok_or_else(|| missing_number(l))?;
        let unused =
            if l == 2 { &[Letter::I, Letter::J][..] } else { &[Letter::I, Letter::J, Letter::R] };
        for letter in unused {
            if block.get(*letter).is_some() {
                return Err(block.at(*letter, DecodeError::UnusedWord(letter.as_char())));
            }
        }
        let system = self.offsets.system_of(system);
        let values = self.axis_values(block)?;
        if l == 2 {
            let rotation = limited(block, Letter::R, block.get(Letter::R), MAX_ANGLE, "°")?;
            self.offsets.set_system(system, &values, rotation);
        } else {
            self.offsets.set_coordinates(system, &self.location.machine, &values);
        }
        self.location.find_program(&self.offsets, self.units);
        Ok(())
    }

    /// G10 L1, L10 and L11.
    fn set_tool_data(&mut self, l: u32, block: &Block, out: &mut Output) -> Result<(), Problem> {
        const USED: Letters = Letters::AXES.with(Letters::of("IJQR"));
        let number = block.whole(Letter::P, 1)?;
        let number = number.ok_or_else(|| missing_number(l))?;
        let mut tool = self.find_tool(number, Letter::P, block, out)?;
        if !block.letters().meets(USED) {
            return Err(OffsetError::NothingToSet(l).into());
        }
        let values = self.axis_values(block)?;
        let mut offset = tool.position();
        if l == 1 {
            values.replace(&mut offset);
        } else {
            let machine = &self.location.machine;
            let mut found = self.offsets.touch_off(l == 11, machine, &values, &offset);
            // Of X and Y both may change, of the others only those that are named.
            if values.0[..2] == [None; 2] {
                found.linear[..2].copy_from_slice(&offset.linear[..2]);
            }
            offset = found;
        }
        tool.set_position(&offset);
        if let Some(radius) = self.length(block, Letter::R)? {
            tool.diameter = 2.0 * radius;
        }
        tool.front_angle = block.get(Letter::I).unwrap_or(tool.front_angle);
        tool.back_angle = block.get(Letter::J).unwrap_or(tool.back_angle);
        tool.orientation = block
            .whole_within(Letter::Q, [0.0, MAX_DIGIT])?
            .and_then(|digit| u8::try_from(digit).ok())
            .unwrap_or(tool.orientation);
        self.tools.get_or_insert_default().insert(tool);
        if number == self.tool {
            self.offsets.load(&tool);
        }
        Ok(())
    }

    /// The tool of this number, which `letter` names. Without a tool table every tool has length zero, with a warning;
    /// tool 0 is none, and always there.
    pub(super) fn find_tool(
        &self,
        number: u32,
        letter: Letter,
        block: &Block,
        out: &mut Output,
    ) -> Result<Tool, Problem> {
        if let Some(tool) = self.tools.as_ref().and_then(|tools| tools.get(number)) {
            return Ok(*tool);
        }
        if !self.assumes_tools && number != 0 {
            return Err(block.at(letter, DecodeError::UnknownTool(number)));
        }
        if number != 0 && block.g.tool_length.is_some() {
            let columns = block.get(letter).and_then(|_| block.columns(letter));
            out.warning(columns, DecodeError::NoToolTable(number));
        }
        Ok(Tool { number, ..Tool::default() })
    }

    /// Puts tool `number` into the spindle; only its number changes (M61) or the machine has done it (M6).
    pub(super) fn load_tool(&mut self, number: u32) {
        self.tool = number;
        let tool = self.tools.as_ref().and_then(|tools| tools.get(number).copied());
        self.offsets.load(&tool.unwrap_or(Tool { number, ..Tool::default() }));
    }

    /// M61.
    pub(super) fn set_tool_number(
        &mut self,
        block: &Block,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let number = rounded(block, Letter::Q)?.ok_or_else(|| {
            DecodeError::missing("M61", "Q, the number of the tool in the spindle (0 = none)")
        })?;
        self.find_tool(number, Letter::Q, block, out)?;
        self.load_tool(number);
        self.m_function(61, Some(f64::from(number)), out);
        Ok(())
    }

    /// G43 to G43.2 and G49.
    pub(super) fn set_tool_length(
        &mut self,
        block: &Block,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let Some(kind) = block.g.tool_length else { return Ok(()) };
        let named = block.whole(Letter::H, 0)?;
        let mut offset = *self.offsets.tool();
        match kind {
            ToolLength::Off => offset = Position::default(),
            ToolLength::Table => {
                // H0 is the tool in the spindle.
                let number = named.filter(|tool| *tool != 0).unwrap_or(self.tool);
                offset = self.find_tool(number, Letter::H, block, out)?.position();
            }
            ToolLength::Direct => self.axis_values(block)?.replace(&mut offset),
            ToolLength::Added => {
                let mut axes = Letter::AXES.into_iter();
                if let Some(letter) = axes.find(|letter| block.get(*letter).is_some()) {
                    return Err(block.at(letter, OffsetError::AxisWithH(letter.as_char())));
                }
                let number = named.ok_or_else(|| {
                    DecodeError::missing("G43.2", "H, the tool whose offset is added")
                })?;
                let number = if number == 0 { self.tool } else { number };
                let tool = self.find_tool(number, Letter::H, block, out)?.position();
                offset = sum(&offset, &tool);
            }
        }
        let before = self.location.machine;
        self.offsets.set_tool(offset, &mut self.location.machine);
        if let Some(tool) = &mut self.compensation.tool {
            let moved = self.location.machine.linear.iter().zip(before.linear);
            for (tool, (now, before)) in tool.linear.iter_mut().zip(moved) {
                *tool += now - before;
            }
        }
        self.location.find_program(&self.offsets, self.units);
        let now = self.location.machine;
        Ok(self.note_extra(&before, &now)?)
    }
}

fn missing_number(l: u32) -> DecodeError {
    let system = "of the coordinate system (1 for G54 to 9 for G59.3, 0 for the one in force)";
    DecodeError::missing(format!("G10 L{l}"), format!("P: the number of the tool, or {system}"))
}

/// `value` if it is from -`max` to `max`.
fn limited(
    block: &Block,
    letter: Letter,
    value: Option<f64>,
    max: f64,
    unit: &'static str,
) -> Result<Option<f64>, Problem> {
    value.map(|value| block.within(letter, value, [-max, max], unit)).transpose()
}
