//! Work offsets and tool offset: the transform between program and machine coordinates, and their parameters.

use super::options::{DecoderOptions, LengthUnit, Position, ToolReference};
use super::tool_table::Tool;
use nalgebra::Isometry3;

/// Numbers of the parameters that are kept here: home positions, G92, coordinate systems, tool in the spindle.
const FIRST: u16 = 5161;
const LAST: u16 = 5413;
/// Parameter of the first value of each group; those of X, Y, Z, A, B, C, U, V, W begin there.
const G28: u16 = 5161;
const G30: u16 = 5181;
const G92_ACTIVE: u16 = 5210;
const G92: u16 = 5211;
const SYSTEM: u16 = 5220;
const TOOL: u16 = 5400;

/// First parameter of coordinate system 0 (G54) to 8 (G59.3). The rotation follows behind W.
fn system_parameter(system: usize) -> u16 {
    const FIRST: [u16; 9] = [5221, 5241, 5261, 5281, 5301, 5321, 5341, 5361, 5381];
    FIRST[system.min(8)]
}

/// A stored position that G28 and G30 go to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Home {
    /// G28, set by G28.1.
    First,
    /// G30, set by G30.1.
    Second,
}

impl Home {
    fn parameter(self) -> u16 {
        match self {
            Self::First => G28,
            Self::Second => G30,
        }
    }
}

/// New values of some axes: degrees for A, B, C, m for the others.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AxisValues(pub(super) [Option<f64>; 9]);

impl AxisValues {
    /// Puts them into `position`.
    pub(super) fn replace(&self, position: &mut Position) {
        let before = position.axes();
        *position = from_axes(|axis| self.0[axis].unwrap_or(before[axis]));
    }
}

fn from_axes(value: impl FnMut(usize) -> f64) -> Position {
    Position::from_axes(std::array::from_fn(value))
}

/// True if the values of an axis are lengths.
fn is_length(axis: usize) -> bool {
    !matches!(axis, 3..=5)
}

/// Values of all axes in `units` and degrees.
fn in_units(position: &Position, units: LengthUnit) -> [f64; 9] {
    let axes = position.axes();
    std::array::from_fn(
        |axis| {
            if is_length(axis) { units.convert_metres(axes[axis]) } else { axes[axis] }
        },
    )
}

/// Rotation about Z of a coordinate system (G10 L2 R).
#[derive(Clone, Copy, Debug)]
struct Rotation {
    /// Counter-clockwise.
    degrees: f64,
    sin: f64,
    cos: f64,
}

impl Default for Rotation {
    fn default() -> Self {
        Self::new(0.0)
    }
}

impl Rotation {
    fn new(degrees: f64) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Self { degrees, sin, cos }
    }

    fn is_none(self) -> bool {
        self.degrees == 0.0
    }

    /// A vector of the coordinate system in the directions of the machine frame.
    fn apply(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        if self.is_none() {
            return [x, y, z];
        }
        [self.cos * x - self.sin * y, self.sin * x + self.cos * y, z]
    }

    /// The other way round.
    fn undo(self, vector: [f64; 3]) -> [f64; 3] {
        Self { sin: -self.sin, ..self }.apply(vector)
    }
}

pub(super) fn add<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|axis| a[axis] + b[axis])
}

pub(super) fn subtract<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

/// `a` + `b`, axis by axis.
pub(super) fn sum(a: &Position, b: &Position) -> Position {
    Position::from_axes(add(a.axes(), b.axes()))
}

/// `a` - `b`, axis by axis.
fn difference(a: &Position, b: &Position) -> Position {
    Position::from_axes(subtract(a.axes(), b.axes()))
}

/// Offsets between the program's coordinates and the machine frame.
///
/// ```text
/// machine = Rz(rotation) (program + G92) + G5x (+ tool offset, if the path is that of the controlled point)
/// ```
///
/// A coordinate system is in force as it was when it was selected or set with G10. Parameters that the program sets
/// act when their system is selected the next time, or with G92.3, G28 and G30, as in LinuxCNC.
#[derive(Clone, Debug, Default)]
pub(super) struct Offsets {
    /// Parameters from [`FIRST`] on, in the units of the machine and degrees.
    values: Vec<f64>,
    /// Units of the machine.
    units: LengthUnit,
    system: usize,
    origin: Position,
    rotation: Rotation,
    g92: Position,
    tool: Position,
    reference: ToolReference,
    /// The frame of the path in the machine frame, if it is another one.
    pub(super) work_frame: Option<Isometry3<f64>>,
    /// All of them together, where nothing is rotated.
    sum: Position,
}

impl Offsets {
    pub(super) fn new(options: &DecoderOptions) -> Self {
        let mut offsets = Self {
            values: vec![0.0; usize::from(LAST - FIRST) + 1],
            units: options.units,
            tool: options.tool_offset,
            reference: options.reference,
            // Where both frames are the same, numbers of the program stay what they are.
            work_frame: Some(options.work_frame).filter(|frame| *frame != Isometry3::identity()),
            ..Self::default()
        };
        offsets.store(G28, &options.g28);
        offsets.store(G30, &options.g30);
        for (index, system) in options.work_offsets.iter().enumerate() {
            offsets.store(system_parameter(index), system);
        }
        for (number, value) in options.parameters.iter() {
            offsets.set_parameter(number, value);
        }
        let number = offsets.value(SYSTEM);
        let system = (0..9_u8).find(|system| (f64::from(*system) + 1.0 - number).abs() < 0.5);
        offsets.set_selected(system.unwrap_or(0));
        if offsets.value(G92_ACTIVE) != 0.0 {
            offsets.g92 = offsets.stored(G92);
        }
        offsets.add_up();
        offsets
    }

    /// Value of a parameter in the units of the machine (lengths) or degrees: #5161 to #5390 and #5400 to #5413.
    /// `None` for those that are not kept here.
    pub(super) fn parameter(&self, number: u16) -> Option<f64> {
        self.values.get(usize::from(number.checked_sub(FIRST)?)).copied()
    }

    /// Sets a parameter; those of the tool (#5400 to #5413) and others that are not kept here stay as they are.
    pub(super) fn set_parameter(&mut self, number: u16, value: f64) {
        if number < TOOL {
            self.set_value(number, value);
        }
    }

    fn set_value(&mut self, number: u16, value: f64) {
        let index = number.checked_sub(FIRST).map(usize::from);
        if let Some(slot) = index.and_then(|index| self.values.get_mut(index)) {
            *slot = value;
        }
    }

    fn value(&self, number: u16) -> f64 {
        self.parameter(number).unwrap_or_default()
    }

    /// Position in nine parameters from `number` on, m and degrees.
    fn stored(&self, number: u16) -> Position {
        let mut numbers = number..;
        from_axes(|axis| {
            let value = numbers.next().map_or(0.0, |number| self.value(number));
            if is_length(axis) { self.units.to_metres(value) } else { value }
        })
    }

    fn store(&mut self, number: u16, position: &Position) {
        for (number, value) in (number..).zip(in_units(position, self.units)) {
            self.set_value(number, value);
        }
    }

    /// Rotation of the coordinate system in force about Z, degrees; none if its axes are those of the machine.
    pub(super) fn rotation(&self) -> Option<f64> {
        (!self.rotation.is_none()).then_some(self.rotation.degrees)
    }

    /// A vector of the program in the directions of the machine frame.
    pub(super) fn turn(&self, vector: [f64; 3]) -> [f64; 3] {
        self.rotation.apply(vector)
    }

    /// The point of these coordinates of the program (m) in the machine frame, m.
    pub(super) fn to_machine(&self, program: [f64; 3]) -> [f64; 3] {
        if self.rotation.is_none() {
            return add(program, self.sum.linear);
        }
        let turned = self.rotation.apply(add(program, self.g92.linear));
        add(add(turned, self.origin.linear), self.point_from_tip())
    }

    /// Coordinates of the program (m) of a point in the machine frame, m.
    pub(super) fn to_program(&self, machine: [f64; 3]) -> [f64; 3] {
        if self.rotation.is_none() {
            return subtract(machine, self.sum.linear);
        }
        let from_origin = subtract(subtract(machine, self.point_from_tip()), self.origin.linear);
        subtract(self.rotation.undo(from_origin), self.g92.linear)
    }

    /// Coordinates of the program (m and degrees) of a position in the machine frame.
    fn program(&self, machine: &Position) -> Position {
        let linear = self.to_program(machine.linear);
        Position { linear, ..difference(machine, &self.sum) }
    }

    /// Offset that G53, G28 and G30 add to a position of the controlled point, m and degrees. With rotary axes they
    /// leave the tool out in LinuxCNC.
    pub(super) fn machine_frame(&self) -> Position {
        let tip_offset = self.tip_offset();
        let offset = difference(&tip_offset, &self.tool);
        Position { rotary: tip_offset.rotary, ..offset }
    }

    /// The system in force: 0 for G54 to 8 for G59.3.
    pub(super) fn system(&self) -> u8 {
        u8::try_from(self.system).unwrap_or_default()
    }

    /// The word of the system in force, in tenths: 540 for G54 to 593 for G59.3.
    pub(super) fn system_number(&self) -> f64 {
        const NUMBERS: [f64; 9] = [540.0, 550.0, 560.0, 570.0, 580.0, 590.0, 591.0, 592.0, 593.0];
        NUMBERS[self.system]
    }

    /// True if a tool offset other than zero is in force (G43 to G43.2).
    pub(super) fn has_tool_length(&self) -> bool {
        self.tool != Position::default()
    }

    /// From the tip of the tool to the point whose path it is, m.
    pub(super) fn point_from_tip(&self) -> [f64; 3] {
        self.tip_offset().linear
    }

    /// The same for all axes, m and degrees.
    fn tip_offset(&self) -> Position {
        match self.reference {
            ToolReference::ControlPoint => self.tool,
            ToolReference::Tip => Position::default(),
        }
    }

    /// Tool offset in force, m and degrees.
    pub(super) fn tool(&self) -> &Position {
        &self.tool
    }

    /// Sets the tool offset (G43 to G43.2, G49). The machine stays where it is: a path of the tip jumps, and
    /// `machine` with it.
    pub(super) fn set_tool(&mut self, tool: Position, machine: &mut Position) {
        if self.reference == ToolReference::Tip {
            *machine = sum(machine, &difference(&self.tool, &tool));
        }
        self.tool = tool;
        self.add_up();
    }

    /// Fills the parameters of the tool in the spindle (#5400 to #5413).
    pub(super) fn load(&mut self, tool: &Tool) {
        self.set_value(TOOL, f64::from(tool.number));
        self.store(TOOL + 1, &tool.position());
        self.set_value(TOOL + 10, self.units.convert_metres(tool.diameter));
        self.set_value(TOOL + 11, tool.front_angle);
        self.set_value(TOOL + 12, tool.back_angle);
        self.set_value(TOOL + 13, f64::from(tool.orientation));
    }

    /// The controlled point when the reference point of the path is at `machine`: m and degrees.
    fn controlled_point(&self, machine: &Position) -> Position {
        match self.reference {
            ToolReference::ControlPoint => *machine,
            ToolReference::Tip => sum(machine, &self.tool),
        }
    }

    /// Coordinates (m, degrees) in coordinate system `system`, as it is stored, of `point`, machine frame. G92 is the
    /// stored one (with `g92`, and if #5210 is not 0), as in LinuxCNC.
    fn in_system(&self, system: usize, point: &Position, g92: bool) -> Position {
        let mut at = difference(point, &self.stored(system_parameter(system)));
        at.linear = self.stored_rotation(system).undo(at.linear);
        if g92 && self.value(G92_ACTIVE) != 0.0 {
            at = difference(&at, &self.stored(G92));
        }
        at
    }

    fn stored_rotation(&self, system: usize) -> Rotation {
        Rotation::new(self.value(system_parameter(system) + 9))
    }

    /// Coordinate system of the P word of G10: 1 to 9, or 0 for the one in force.
    pub(super) fn system_of(&self, p: u32) -> usize {
        usize::try_from(p).ok().and_then(|p| p.checked_sub(1)).unwrap_or(self.system)
    }

    /// Sets origin and rotation (degrees) of coordinate system `system` (G10 L2).
    pub(super) fn set_system(&mut self, system: usize, values: &AxisValues, rotation: Option<f64>) {
        let number = system_parameter(system);
        let mut origin = self.stored(number);
        values.replace(&mut origin);
        self.store(system_parameter(system), &origin);
        if let Some(degrees) = rotation {
            self.set_value(number + 9, degrees);
        }
        self.refresh(system);
    }

    /// Makes the origin of coordinate system `system` such that the tool at `machine` has the coordinates `values`
    /// there (G10 L20).
    pub(super) fn set_coordinates(
        &mut self,
        system: usize,
        machine: &Position,
        values: &AxisValues,
    ) {
        let now = self.in_system(system, &difference(machine, &self.tip_offset()), true);
        let mut wanted = now;
        values.replace(&mut wanted);
        let mut shift = difference(&now, &wanted);
        shift.linear = self.stored_rotation(system).apply(shift.linear);
        let origin = sum(&self.stored(system_parameter(system)), &shift);
        self.store(system_parameter(system), &origin);
        self.refresh(system);
    }

    /// Offset of a tool (m, degrees) with which the coordinates in the system in force, or in G59.3 without G92
    /// (`fixture`), become `values`; `before` where they are not given (G10 L10, L11).
    pub(super) fn touch_off(
        &self,
        fixture: bool,
        machine: &Position,
        values: &AxisValues,
        before: &Position,
    ) -> Position {
        let system = if fixture { 8 } else { self.system };
        let now = self.in_system(system, &self.controlled_point(machine), !fixture).axes();
        let rotation = self.stored_rotation(system);
        let before = Position { linear: rotation.undo(before.linear), ..*before }.axes();
        let mut offset =
            from_axes(|axis| values.0[axis].map_or(before[axis], |value| now[axis] - value));
        offset.linear = rotation.apply(offset.linear);
        offset
    }

    /// Lets a change of a coordinate system act if it is in force.
    fn refresh(&mut self, system: usize) {
        if system == self.system {
            self.load_system();
        }
    }

    /// Selects G54 (0) to G59.3 (8).
    pub(super) fn select(&mut self, system: u8) {
        if usize::from(system) != self.system {
            self.set_selected(system);
        }
    }

    fn set_selected(&mut self, system: u8) {
        self.system = usize::from(system);
        self.set_value(SYSTEM, f64::from(system) + 1.0);
        self.load_system();
    }

    fn load_system(&mut self) {
        self.origin = self.stored(system_parameter(self.system));
        self.rotation = self.stored_rotation(self.system);
        self.add_up();
    }

    /// Makes the origin such that the point at `machine` has the coordinates `values` (G92).
    pub(super) fn set_g92(&mut self, machine: &Position, values: &AxisValues) {
        let program = self.program(machine);
        let mut wanted = program;
        values.replace(&mut wanted);
        self.g92 = sum(&self.g92, &difference(&program, &wanted));
        self.apply_g92();
    }

    /// Sets the offset of G92 itself (G52).
    pub(super) fn set_local(&mut self, values: &AxisValues) {
        values.replace(&mut self.g92);
        self.apply_g92();
    }

    fn apply_g92(&mut self) {
        let g92 = self.g92;
        self.store(G92, &g92);
        self.set_value(G92_ACTIVE, 1.0);
        self.add_up();
    }

    /// G92.1.
    pub(super) fn clear_g92(&mut self) {
        for number in G92..G92 + 9 {
            self.set_value(number, 0.0);
        }
        self.suspend_g92();
    }

    /// G92.2.
    pub(super) fn suspend_g92(&mut self) {
        self.g92 = Position::default();
        self.set_value(G92_ACTIVE, 0.0);
        self.add_up();
    }

    /// G92.3.
    pub(super) fn restore_g92(&mut self) {
        self.g92 = self.stored(G92);
        self.set_value(G92_ACTIVE, 1.0);
        self.add_up();
    }

    /// Target of G28 or G30: the controlled point, machine frame, m and degrees.
    pub(super) fn home(&self, home: Home) -> Position {
        self.stored(home.parameter())
    }

    /// Makes the point at `machine`, frame of the path, the target of G28 or G30 (G28.1, G30.1).
    pub(super) fn save_home(&mut self, home: Home, machine: &Position) {
        let mut point = self.controlled_point(machine);
        point.linear = self.controlled_in_machine(point.linear);
        self.store(home.parameter(), &point);
    }

    fn add_up(&mut self) {
        self.sum = sum(&sum(&self.origin, &self.g92), &self.tip_offset());
    }
}

/// Position of the tool: in the machine frame (m, degrees) and in the coordinates of the program.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Location {
    pub(super) machine: Position,
    /// X, Y, Z, A, B, C, U, V, W in the units of the program and degrees: what LinuxCNC calculates with, so that
    /// numbers of the program stay what they are, and comparing them means something.
    pub(super) program: [f64; 9],
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
        let (from, to) = (self.machine.axes(), end.machine.axes());
        let machine = from_axes(|axis| {
            let (from, to) = (from[axis], to[axis]);
            if from == to { to } else { from + (to - from) * part }
        });
        let mut at = Self::new(machine, offsets, units);
        for ((slot, from), to) in at.program.iter_mut().zip(self.program).zip(end.program) {
            if from == to {
                *slot = to;
            }
        }
        at
    }

    /// Changes one coordinate of the program. Coordinates of the machine that stay keep their number, bit for bit.
    #[expect(clippy::float_cmp, reason = "the same number or another one")]
    pub(super) fn set_program(
        &mut self,
        axis: usize,
        value: f64,
        offsets: &Offsets,
        units: LengthUnit,
    ) {
        let turned = offsets.rotation().is_some() && axis < 2;
        if turned && self.program[axis] == value {
            return;
        }
        self.program[axis] = value;
        match axis {
            3..=5 => self.machine.rotary[axis - 3] = value + offsets.sum.rotary[axis - 3],
            6.. => {
                self.machine.parallel[axis - 6] =
                    units.to_metres(value) + offsets.sum.parallel[axis - 6];
            }
            _ => {
                let [x, y, z, ..] = self.program;
                let machine = offsets.to_machine([x, y, z].map(|length| units.to_metres(length)));
                let changed = if turned { 0..2 } else { axis..axis + 1 };
                self.machine.linear[changed.clone()].copy_from_slice(&machine[changed]);
            }
        }
    }

    /// Takes over one coordinate of `other`, bit for bit.
    pub(super) fn copy_axis(&mut self, axis: usize, other: &Self) {
        let mut machine = self.machine.axes();
        machine[axis] = other.machine.axes()[axis];
        self.machine = Position::from_axes(machine);
        self.program[axis] = other.program[axis];
    }

    /// Calculates the program's coordinates anew, after another offset or unit.
    pub(super) fn find_program(&mut self, offsets: &Offsets, units: LengthUnit) {
        self.program = in_units(&offsets.program(&self.machine), units);
    }
}
