//! Tool in the spindle along an RS274 program: the tool of the table that M6 or M61 has put in.

use crate::m_function::MCall;
use twin_gcode::rs274::{Position, Tool, ToolTable};

/// Tool that a program leaves in the spindle, and the tool offset that it leaves in force (G43). LinuxCNC keeps both at M2 and M30.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolLeft {
    /// Number of the tool, 0 = none.
    pub number: u32,
    /// The offset, m and degrees.
    pub offset: Position,
}

/// Tool in the spindle. Without a tool table it is that of `[tool]` of the machine file.
#[derive(Clone, Debug, Default)]
pub struct Spindle {
    /// The tools of the program.
    tools: ToolTable,
    number: u32,
    /// The last M function.
    last_call: Option<u64>,
}

impl Spindle {
    /// The spindle at the beginning of a program with `tools`, with tool `number` in it.
    pub fn new(tools: ToolTable, number: u32) -> Self {
        Self { tools, number, last_call: None }
    }

    /// Observes the M function at which the path waits: M6 and M61 put tool K into the spindle. True if that is another one.
    pub fn observe(&mut self, call: &MCall) -> bool {
        let is_next = self.last_call.replace(call.index) != Some(call.index);
        let Some(number) = call.parameters.k else { return false };
        if !is_next || !matches!(call.number, 6 | 61) || self.tools.as_slice().is_empty() {
            return false;
        }
        let is_it = |tool: &&Tool| (f64::from(tool.number) - number).abs() < 0.5;
        let number = self.tools.as_slice().iter().find(is_it).map_or(0, |tool| tool.number);
        std::mem::replace(&mut self.number, number) != number
    }

    /// The tool, if the table has it.
    pub fn tool(&self) -> Option<&Tool> {
        self.tools.get(self.number)
    }

    /// Its number for messages, if the table has it.
    pub fn number(&self) -> Option<u32> {
        self.tool().map(|tool| tool.number)
    }
}
