//! Work offsets and tool length offset: the transform between program and machine coordinates.

use super::options::{LengthUnit, Position, ToolReference};

/// Offsets between the program's coordinates and the machine frame.
///
/// ```text
/// machine = program + G5x + G92 (+ tool length, if the path is that of the controlled point)
/// ```
#[derive(Clone, Debug)]
pub(super) struct Offsets {
    systems: [Position; 9],
    system: usize,
    g92: Position,
    /// What G92.3 brings back.
    kept_g92: Position,
    tool: [f64; 3],
    reference: ToolReference,
    /// All of them together.
    sum: Position,
}

impl Offsets {
    pub(super) fn new(systems: &[Position; 9], reference: ToolReference) -> Self {
        let mut offsets = Self {
            systems: *systems,
            system: 0,
            g92: Position::default(),
            kept_g92: Position::default(),
            tool: [0.0; 3],
            reference,
            sum: Position::default(),
        };
        offsets.add_up();
        offsets
    }

    /// Program to machine frame, m and degrees.
    pub(super) fn sum(&self) -> &Position {
        &self.sum
    }

    /// Offset that G53, G28 and G30 add to a position of the controlled point, m.
    pub(super) fn machine_frame(&self) -> [f64; 3] {
        match self.reference {
            ToolReference::ControlPoint => [0.0; 3],
            ToolReference::Tip => self.tool.map(|tool| -tool),
        }
    }

    /// Selects G54 (0) to G59.3 (8).
    pub(super) fn select(&mut self, system: u8) {
        self.system = usize::from(system);
        self.add_up();
    }

    /// The word of the system in force, in tenths: 540 for G54 to 593 for G59.3.
    pub(super) fn system_number(&self) -> f64 {
        const NUMBERS: [f64; 9] = [540.0, 550.0, 560.0, 570.0, 580.0, 590.0, 591.0, 592.0, 593.0];
        NUMBERS[self.system]
    }

    /// True if the length of a tool is in force.
    pub(super) fn has_tool_length(&self) -> bool {
        self.tool.iter().any(|length| *length != 0.0)
    }

    /// From the tip of the tool to the point whose path it is, m.
    pub(super) fn point_from_tip(&self) -> [f64; 3] {
        match self.reference {
            ToolReference::ControlPoint => self.tool,
            ToolReference::Tip => [0.0; 3],
        }
    }

    /// Sets the tool's length (G43, G49) and returns by how much it moves the reference point away from where the
    /// machine holds it, m.
    pub(super) fn set_tool(&mut self, tool: [f64; 3]) -> [f64; 3] {
        let before = self.machine_frame();
        self.tool = tool;
        self.add_up();
        let mut moved = self.machine_frame();
        for (moved, before) in moved.iter_mut().zip(before) {
            *moved -= before;
        }
        moved
    }

    /// Makes the origin such that `machine` has the coordinates `linear` (m) and `rotary` (degrees) where they are
    /// given (G92).
    pub(super) fn set_g92(
        &mut self,
        machine: &Position,
        linear: [Option<f64>; 3],
        rotary: [Option<f64>; 3],
    ) {
        let shift = |g92: &mut [f64; 3], sum: &[f64; 3], machine: &[f64; 3], values: [_; 3]| {
            for (((g92, sum), machine), value) in g92.iter_mut().zip(sum).zip(machine).zip(values) {
                if let Some(value) = value {
                    let others: f64 = sum - *g92;
                    *g92 = machine - others - value;
                }
            }
        };
        shift(&mut self.g92.linear, &self.sum.linear, &machine.linear, linear);
        shift(&mut self.g92.rotary, &self.sum.rotary, &machine.rotary, rotary);
        self.kept_g92 = self.g92;
        self.add_up();
    }

    /// G92.1.
    pub(super) fn clear_g92(&mut self) {
        self.kept_g92 = Position::default();
        self.suspend_g92();
    }

    /// G92.2.
    pub(super) fn suspend_g92(&mut self) {
        self.g92 = Position::default();
        self.add_up();
    }

    /// G92.3.
    pub(super) fn restore_g92(&mut self) {
        self.g92 = self.kept_g92;
        self.add_up();
    }

    fn add_up(&mut self) {
        let system = self.systems[self.system];
        let tool = self.point_from_tip();
        self.sum = Position {
            linear: std::array::from_fn(|axis| {
                let part = |values: &[f64; 3]| values[axis];
                part(&system.linear) + part(&self.g92.linear) + part(&tool)
            }),
            rotary: std::array::from_fn(|axis| {
                let part = |values: &[f64; 3]| values[axis];
                part(&system.rotary) + part(&self.g92.rotary)
            }),
        };
    }
}

/// Position of the tool: in the machine frame (m, degrees) and in the coordinates of the program.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Location {
    pub(super) machine: Position,
    /// X, Y, Z in the units of the program: what LinuxCNC calculates with, so that numbers of the program stay what
    /// they are, and comparing them means something.
    pub(super) program: [f64; 3],
    /// A, B, C of the program, degrees.
    pub(super) program_rotary: [f64; 3],
}

impl Location {
    pub(super) fn new(machine: Position, offsets: &Offsets, units: LengthUnit) -> Self {
        let mut location = Self { machine, ..Self::default() };
        location.find_program(offsets, units);
        location
    }

    /// Point of the straight line to `end` at `part` of it: this place up to 0, `end` from 1 on. A coordinate that does
    /// not move keeps its number, bit for bit.
    #[expect(clippy::float_cmp, reason = "the same number or another one")]
    pub(super) fn toward(
        &self,
        end: &Self,
        part: f64,
        offsets: &Offsets,
        units: LengthUnit,
    ) -> Self {
        if part <= 0.0 {
            return *self;
        }
        if part >= 1.0 {
            return *end;
        }
        let between = |from: f64, to: f64| from + (to - from) * part;
        let mut at = *end;
        let machine = at.machine.linear.iter_mut().zip(self.machine.linear);
        let sum = offsets.sum();
        for (((machine, from), program), sum) in machine.zip(&mut at.program).zip(sum.linear) {
            if *machine != from {
                *machine = between(from, *machine);
                *program = units.convert_metres(*machine - sum);
            }
        }
        let machine = at.machine.rotary.iter_mut().zip(self.machine.rotary);
        for (((machine, from), program), sum) in machine.zip(&mut at.program_rotary).zip(sum.rotary)
        {
            if *machine != from {
                *machine = between(from, *machine);
                *program = *machine - sum;
            }
        }
        at
    }

    /// Calculates the program's coordinates anew, after another offset or unit.
    pub(super) fn find_program(&mut self, offsets: &Offsets, units: LengthUnit) {
        let sum = offsets.sum();
        let program = self.program.iter_mut().zip(self.machine.linear).zip(sum.linear);
        for ((program, machine), sum) in program {
            *program = units.convert_metres(machine - sum);
        }
        let program = self.program_rotary.iter_mut().zip(self.machine.rotary).zip(sum.rotary);
        for ((program, machine), sum) in program {
            *program = machine - sum;
        }
    }
}
