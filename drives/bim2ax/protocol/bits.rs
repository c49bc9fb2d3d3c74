//! The bits of the module's registers, by their names in the manual (rev. D, 05/2013).

/// Registers "Ordre UC axe 1 et 2" (2.1.1) and, where the meaning is "running" or "done", their acknowledgement
/// "Acquittement ordre UC" (2.2.2).
pub mod uc {
    /// Homing; acknowledged while it runs (5.1).
    pub const HOME: u16 = 0x0001;
    /// Programmed move; acknowledged while it runs (6).
    pub const PROGRAMMED: u16 = 0x0002;
    /// Abandon the move, with ramp; taken in motion (5.6).
    pub const ABANDON: u16 = 0x0008;
    /// Manual move towards +, until 0 is written (5.2).
    pub const MANUAL_PLUS: u16 = 0x0010;
    /// Manual move towards −, until 0 is written (5.2).
    pub const MANUAL_MINUS: u16 = 0x0020;
    /// Go to the + end switch (5.3).
    pub const TO_PLUS_SWITCH: u16 = 0x0040;
    /// Go to the − end switch (5.3).
    pub const TO_MINUS_SWITCH: u16 = 0x0080;
    /// Hard stop without ramp; taken in motion (5.5).
    pub const HARD_STOP: u16 = 0x0100;
    /// Phases off; taken at standstill (5.4).
    pub const PHASES_OFF: u16 = 0x0200;
    /// Phases on; taken at standstill (2.1.1, revision D).
    pub const PHASES_ON: u16 = 0x0400;
    /// Motor test; taken at standstill (5.7, whose "bit 5" of the acknowledgement is bit 15 in the table).
    pub const MOTOR_TEST: u16 = 0x8000;
    /// All orders that are moves.
    pub const MOVES: u16 =
        HOME | PROGRAMMED | MANUAL_PLUS | MANUAL_MINUS | TO_PLUS_SWITCH | TO_MINUS_SWITCH;
}

/// Registers "Ordre bloc axe 1 et 2" (2.1.1) and "Acquittement ordre bloc" (2.2.2). Bit 9, "programmed
/// acceleration", is a remnant of an older module and has no effect.
pub mod bloc {
    /// Number of the reference position, 1 to 10; 0 for the target of the Position zone. Acknowledged at the end.
    pub const REFERENCE: u32 = 0x0000_000F;
    /// Declares the present position to be 0.
    pub const ZERO: u32 = 0x0000_0010;
    /// Declares the present position to be the last one stored, or with [`PRESET`] that of the Position zone.
    pub const FORCE: u32 = 0x0000_0020;
    /// The target is relative to the present position.
    pub const RELATIVE: u32 = 0x0000_0040;
    /// With [`FORCE`]: the position of the Position zone ($C0DE is forbidden).
    pub const PRESET: u32 = 0x0000_0080;
    /// At the speed of the Position zone, else at the fast speed.
    pub const PROGRAMMED_SPEED: u32 = 0x0000_0100;
    /// Without unidirectional approach.
    pub const WITHOUT_APPROACH: u32 = 0x0000_0800;
    /// Acknowledgement only: no such reference position.
    pub const BAD_REFERENCE: u32 = 0x0100_0000;
    /// Bits that mean something in the acknowledgement; the manual's $50000000 (6.4.1) is of none of them.
    pub const ACKNOWLEDGED: u32 = BAD_REFERENCE | FORCE | ZERO | REFERENCE;
    /// The preset that is forbidden (6.3).
    pub const FORBIDDEN_PRESET: i32 = 0xC0DE;
}

/// Registers "Messages axe 1 et 2" (2.2.1, 7).
pub mod message {
    /// On the + end switch.
    pub const PLUS_SWITCH: u16 = 0x0001;
    /// On the − end switch.
    pub const MINUS_SWITCH: u16 = 0x0002;
    /// At or beyond the + soft limit.
    pub const PLUS_LIMIT: u16 = 0x0004;
    /// At or beyond the − soft limit.
    pub const MINUS_LIMIT: u16 = 0x0008;
    /// Homing done.
    pub const HOMED: u16 = 0x0010;
    /// Moving.
    pub const MOVING: u16 = 0x0020;
    /// Stopped hard.
    pub const HARD_STOPPED: u16 = 0x0040;
    /// Phases off.
    pub const PHASES_OFF: u16 = 0x0080;
    /// A phase is open.
    pub const PHASE_OPEN: u16 = 0x0200;
    /// A short circuit between phases.
    pub const PHASE_SHORT: u16 = 0x0400;
    /// Power is absent.
    pub const POWER_ABSENT: u16 = 0x0800;
    /// On the home cam.
    pub const ON_CAM: u16 = 0x2000;
    /// An order during a move, or two orders at a time: refused.
    pub const REFUSED: u16 = 0x4000;
}

/// Register "Messages carte" (2.2.3, 8).
pub mod card {
    /// Check sum of the EEPROM: only parameter writes are accepted.
    pub const CHECKSUM: u32 = 0x01;
    /// Axis 1 is declared.
    pub const AXIS_1: u32 = 0x02;
    /// Axis 2 is declared.
    pub const AXIS_2: u32 = 0x04;
    /// A write to no parameter, or to a read-only one.
    pub const BAD_WRITE: u32 = 0x08;
    /// A read of no parameter.
    pub const BAD_READ: u32 = 0x10;
    /// A write while an axis moves.
    pub const MOVING: u32 = 0x20;
    /// No such parameter order.
    pub const BAD_ORDER: u32 = 0x40;
    /// The errors of the last operation.
    pub const ERRORS: u32 = BAD_WRITE | BAD_READ | MOVING | BAD_ORDER;
}

/// Registers "Message codeur axe 1 et 2" (2.2.4).
pub mod encoder_message {
    /// The divisor is 0: steps cannot be computed.
    pub const DIVISOR_ZERO: u16 = 0x0001;
    /// Encoder fault, until RESET.
    pub const FAULT: u16 = 0x0002;
    /// The plug is absent or badly programmed.
    pub const PLUG: u16 = 0x0004;
    /// The last programmed move needed at least one correction.
    pub const CORRECTED: u16 = 0x0010;
    /// The alarm bit of an EnDat encoder.
    pub const ALARM: u16 = 0x0020;
    /// An EnDat encoder is recognised and declared.
    pub const ENDAT: u16 = 0x2000;
    /// An SSI encoder is recognised and declared.
    pub const SSI: u16 = 0x4000;
    /// An incremental encoder is recognised and declared.
    pub const INCREMENTAL: u16 = 0x8000;
}

/// Parameters 0 and 1, "Coefficient d'axe" (3.1.1).
pub mod coefficient {
    /// A motor is connected; without, no order is obeyed.
    pub const PRESENT: u16 = 0x0001;
    /// Homing runs towards +.
    pub const HOME_PLUS: u16 = 0x0002;
    /// The motor turns the other way round.
    pub const REVERSE: u16 = 0x0004;
    /// The inputs of the end switches are swapped.
    pub const SWAP_SWITCHES: u16 = 0x0008;
    /// There are no end switches.
    pub const IGNORE_SWITCHES: u16 = 0x0010;
    /// No programmed move before homing.
    pub const HOMING_MANDATORY: u16 = 0x0040;
    /// The home cam closes its contact, else opens it.
    pub const CAM_CLOSES: u16 = 0x0080;
    /// Programmed moves arrive from one side.
    pub const APPROACH: u16 = 0x0100;
    /// Programmed moves arrive towards +.
    pub const APPROACH_PLUS: u16 = 0x0200;
    /// An end switch stops without ramp.
    pub const BRUTAL_STOP: u16 = 0x0400;
    /// Homing does not clear the cam first.
    pub const STAY_ON_CAM: u16 = 0x0800;
    /// The motor test is made with 60 mA, else with the holding current.
    pub const TEST_AT_60_MA: u16 = 0x1000;
    /// The end switches close their contacts, else open them.
    pub const SWITCHES_CLOSE: u16 = 0x4000;
    /// No motor test at the begin and end of every move.
    pub const NO_MOTOR_TEST: u16 = 0x8000;
}

/// Parameters $36 and $37, "Définition codeurs" (3.1.19).
pub mod definition {
    /// There is an encoder.
    pub const PRESENT: u16 = 0x0001;
    /// It counts the other way round.
    pub const INVERT: u16 = 0x0002;
    /// Incremental: A and B without their complements.
    pub const SINGLE_ENDED: u16 = 0x0004;
    /// Incremental: homing on the index, not on the cam.
    pub const HOME_ON_INDEX: u16 = 0x0008;
    /// SSI: Gray code.
    pub const GRAY: u16 = 0x0010;
    /// SSI: with parity.
    pub const PARITY: u16 = 0x0020;
    /// Stored positions that an incremental encoder reloads at the start: three bits with a table of their own.
    pub const RELOAD: u16 = 0x3800;
}
