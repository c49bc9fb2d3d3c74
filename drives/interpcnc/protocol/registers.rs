//! Addresses, bits and limits of the InterpCNC V2.1 board as its Modbus manual (firmware up to 5.30) gives them.
//!
//! Addresses are those of the protocol data unit, counted from zero; some PLC tools show one more. Values of 32 bits
//! lie in two registers, high word first ("PF" then "pf"), positions in two's complement.

use std::fmt;

/// Number of axes of the board: X, Y, Z, A, B.
pub const AXES: usize = 5;

/// "Registres en Lecture/Ecriture (Holding registers)": first command register. Writing it starts the command.
pub const COMMAND: u16 = 4096;
/// Number of command registers (4096 to 4145).
pub const COMMAND_REGISTERS: u16 = 50;
/// "Adresses des Registres en lecture seule": status, high word; low word, then five positions follow.
pub const STATUS: u16 = 1024;
/// Registers of status (2) and five positions (10).
pub const STATE_REGISTERS: u16 = 12;

/// Coil of the first of the [`OUTPUTS`] outputs.
pub const FIRST_OUTPUT: u16 = 256;
/// Number of outputs.
pub const OUTPUTS: u8 = 32;

/// Number of inputs.
pub const INPUTS: u8 = 32;

/// Registers from status to extended status, reserved ones included.
pub const SNAPSHOT_REGISTERS: u16 = 32;
/// Input registers of the extended status, high word.
pub const EXTENDED_STATUS: u16 = 1054;
/// Holding register of analog output 1; that of output 2 follows.
pub const ANALOG_OUTPUT: u16 = 4146;
/// Largest value of an analog output.
pub const MAX_ANALOG: u16 = 1023;
/// Holding registers of the encoder position; those of pulse counters A and B follow.
pub const ENCODER: u16 = 4218;
/// Holding register of the recipes' size.
pub const RECIPE_SIZE: u16 = 5632;

/// Largest step frequency the board makes, Hz (published vendor sources; the manual is silent).
pub const MAX_SPEED_HZ: u32 = 200_000;

/// The board's status, registers 1024 and 1025 ("Détails du registre de status").
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status(pub u32);

impl Status {
    /// B5: the command buffer is empty.
    pub const BUFFER_EMPTY: u32 = 1 << 5;
    /// B6: the command buffer is frozen.
    pub const BUFFER_FROZEN: u32 = 1 << 6;
    /// B7: the ENABLE input is inactive.
    pub const EMERGENCY_STOP: u32 = 1 << 7;
    /// B8: moves and outputs are inhibited.
    pub const BOARD_LOCKED: u32 = 1 << 8;
    /// B10: homing of the machine (command 71) is under way.
    pub const HOMING_IN_PROGRESS: u32 = 1 << 10;
    /// B11: the last homing of the machine has failed.
    pub const HOMING_ERROR: u32 = 1 << 11;
    /// B12: a probing move (command 40) is under way.
    pub const PROBE_IN_PROGRESS: u32 = 1 << 12;
    /// B13: the last probing move has failed.
    pub const PROBE_ERROR: u32 = 1 << 13;
    /// B14: the EEPROM is being written.
    pub const EEPROM_BUSY: u32 = 1 << 14;
    /// B15: the last write to the EEPROM has failed.
    pub const EEPROM_ERROR: u32 = 1 << 15;
    /// B17: a speed override is in effect.
    pub const OVERRIDDEN: u32 = 1 << 17;
    /// B22: first of five bits, axis in an independent move ("Async Moving").
    pub const ASYNC_MOVING_SHIFT: u32 = 22;
    /// B27: first of five bits, either limit switch of the axis is active.
    pub const LIMIT_SWITCH_SHIFT: u32 = 27;

    /// True if the ENABLE input is inactive (B7).
    pub fn enable_open(self) -> bool {
        self.0 & Self::EMERGENCY_STOP != 0
    }

    /// True if moves and outputs are inhibited (B8).
    pub fn locked(self) -> bool {
        self.0 & Self::BOARD_LOCKED != 0
    }

    /// True while a probing move is under way (B12).
    pub fn probing(self) -> bool {
        self.0 & Self::PROBE_IN_PROGRESS != 0
    }

    /// True if the last probing move has failed (B13).
    pub fn probe_failed(self) -> bool {
        self.0 & Self::PROBE_ERROR != 0
    }

    /// True if one of the bits is set.
    pub fn has(self, bits: u32) -> bool {
        self.0 & bits != 0
    }

    /// Axes in an interpolated move (B0 to B4).
    pub fn interpolating(self) -> AxisMask {
        AxisMask::from_bits(self.0)
    }

    /// Axes in an independent move (B22 to B26).
    pub fn independent(self) -> AxisMask {
        AxisMask::from_bits(self.0 >> Self::ASYNC_MOVING_SHIFT)
    }

    /// True if all interpolated moves are finished: the buffer is empty (B5) and none is under way.
    pub fn segments_finished(self) -> bool {
        self.has(Self::BUFFER_EMPTY) && self.interpolating().is_empty()
    }

    /// Axes in an interpolated (B0 to B4) or independent (B22 to B26) move.
    pub fn moving(self) -> AxisMask {
        AxisMask::from_bits(self.0 | self.0 >> Self::ASYNC_MOVING_SHIFT)
    }

    /// True if these axes are in no move and none waits in the buffer (B5) that could begin one.
    pub fn stopped(self, axes: AxisMask) -> bool {
        self.has(Self::BUFFER_EMPTY) && self.moving().intersection(axes).is_empty()
    }

    /// Axes on a limit switch (B27 to B31).
    pub fn on_limit_switch(self) -> AxisMask {
        AxisMask::from_bits(self.0 >> Self::LIMIT_SWITCH_SHIFT)
    }
}

/// The board's extended status, registers 1054 and 1055 ("Détails du registre de status étendu").
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExtendedStatus(pub u32);

impl ExtendedStatus {
    /// B18, then every second bit: homing (command 78) of X, Y, Z, A, B is under way; the bit after it: has failed.
    pub const HOMING_SHIFT: u32 = 18;

    /// True if one of the bits is set.
    pub fn has(self, bits: u32) -> bool {
        self.0 & bits != 0
    }

    /// Axes whose motion is or was towards larger positions (B0 to B4).
    pub fn positive(self) -> AxisMask {
        AxisMask::from_bits(self.0)
    }

    /// Axes that home by command 78.
    pub fn homing(self) -> AxisMask {
        self.every_second(Self::HOMING_SHIFT)
    }

    /// Axes whose last homing by command 78 has failed.
    pub fn homing_failed(self) -> AxisMask {
        self.every_second(Self::HOMING_SHIFT + 1)
    }

    fn every_second(self, first: u32) -> AxisMask {
        let shifts = (first..).step_by(2);
        let set = BoardAxis::ALL.into_iter().zip(shifts).filter(|(_, bit)| self.0 >> bit & 1 == 1);
        set.fold(AxisMask::NONE, |mask, (axis, _)| mask.union(axis.mask()))
    }
}

/// One of the board's axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum BoardAxis {
    /// Bit 0.
    X = 1,
    /// Bit 1.
    Y = 2,
    /// Bit 2.
    Z = 3,
    /// Bit 3.
    A = 4,
    /// Bit 4.
    B = 5,
}

impl BoardAxis {
    /// All axes in the order of registers and bits.
    pub const ALL: [Self; AXES] = [Self::X, Self::Y, Self::Z, Self::A, Self::B];

    /// 0 for X … 4 for B.
    pub fn index(self) -> usize {
        usize::from(self.number() - 1)
    }

    /// 1 for X … 5 for B, as command 78 counts.
    pub fn number(self) -> u8 {
        self as u8
    }

    /// The axis alone in a mask.
    pub fn mask(self) -> AxisMask {
        AxisMask(1 << (self.number() - 1))
    }
}

impl fmt::Display for BoardAxis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, f)
    }
}

/// A set of axes: b0 X, b1 Y, b2 Z, b3 A, b4 B.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AxisMask(u8);

impl AxisMask {
    /// No axis.
    pub const NONE: Self = Self(0);
    /// All five.
    pub const ALL: Self = Self(0b1_1111);

    /// The low five bits.
    pub fn from_bits(bits: u32) -> Self {
        let [_, _, _, low] = bits.to_be_bytes();
        Self(low & Self::ALL.0)
    }

    /// A mask register: at least one axis and nothing above bit 4.
    pub fn from_register(value: u16) -> Option<Self> {
        let mask = u8::try_from(value).ok()?;
        (1..=Self::ALL.0).contains(&mask).then_some(Self(mask))
    }

    /// As five bits.
    pub fn bits(self) -> u8 {
        self.0
    }

    /// True without any axis.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// True if the axis is in the set.
    pub fn contains(self, axis: BoardAxis) -> bool {
        self.0 & axis.mask().0 != 0
    }

    /// Axes of both sets.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Axes of this set that are not in the other.
    #[must_use]
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Axes in both sets.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// The axes, X first.
    pub fn axes(self) -> impl Iterator<Item = BoardAxis> {
        BoardAxis::ALL.into_iter().filter(move |axis| self.contains(*axis))
    }
}

/// High and low word of a 32-bit value.
pub(crate) fn words(value: u32) -> [u16; 2] {
    let [a, b, c, d] = value.to_be_bytes();
    [u16::from_be_bytes([a, b]), u16::from_be_bytes([c, d])]
}

/// The 32-bit value of a high and a low word.
pub(crate) fn join(high: u16, low: u16) -> u32 {
    u32::from(high) << 16 | u32::from(low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn status_bits_name_their_axes() {
        // B0 and B23 move, B31 is on a switch, B7 and B8 are set.
        let status = Status(1 | 1 << 7 | 1 << 8 | 1 << 23 | 1 << 31);
        assert!(status.enable_open() && status.locked());
        assert_eq!(status.moving().axes().collect::<Vec<_>>(), [BoardAxis::X, BoardAxis::Y]);
        assert_eq!(status.on_limit_switch().axes().collect::<Vec<_>>(), [BoardAxis::B]);
    }

    #[test]
    fn extended_status_bits_name_their_axes() {
        // B1 direction of Y, B18 X homes, B25 A has failed, B27 B has failed.
        let status = ExtendedStatus(1 << 1 | 1 << 18 | 1 << 25 | 1 << 27);
        assert_eq!(status.positive(), BoardAxis::Y.mask());
        assert_eq!(status.homing(), BoardAxis::X.mask());
        assert_eq!(status.homing_failed().axes().collect::<Vec<_>>(), [BoardAxis::A, BoardAxis::B]);
    }

    #[test]
    fn a_mask_register_names_one_to_five_axes() {
        assert_eq!(AxisMask::from_register(0), None);
        assert_eq!(AxisMask::from_register(32), None);
        assert_eq!(AxisMask::from_register(0x101), None);
        assert_eq!(AxisMask::from_register(31), Some(AxisMask::ALL));
        assert_eq!(AxisMask::from_register(4), Some(BoardAxis::Z.mask()));
    }

    #[test]
    fn words_are_high_then_low() {
        assert_eq!(words(100_000), [0x0001, 0x86A0]);
        assert_eq!(join(0xFFFF, 0xEC78).cast_signed(), -5000);
    }
}
