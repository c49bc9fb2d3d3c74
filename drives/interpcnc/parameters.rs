//! Numbers of the board's parameters, 32 bits each, saved in its EEPROM.
//!
//! The manual gives 88 (page 12), 101 (page 24) and 103 (page 3), and names of others. All other numbers come from
//! the vendor's published sources; meanings of values that neither gives are among the [`super::Assumptions`].

use super::registers::{AXES, BoardAxis, INPUTS, MAX_SPEED_HZ};
use crate::{ParameterId, ParameterInfo, Values};

/// First register of parameter 0, high word; the low word follows ("Paramètres sauvegardés", 4352 to 5119).
pub const FIRST_PARAMETER: u16 = 4352;
/// Number of parameters that Modbus shows.
pub const PARAMETERS: u16 = 384;

/// `EE_DEFAULT_ACCEL`: acceleration and deceleration of interpolated moves, 1000 steps/s².
pub const DEFAULT_ACCELERATION: u16 = 4;
/// `EE_DEFAULT_STARTF`: start and stop frequency of interpolated moves, steps/s.
pub const DEFAULT_START_STOP: u16 = 5;
/// `EE_ORIGINE_STARTF_RAPIDE`: start and stop frequency of command 71, steps/s.
pub const HOME_START_STOP: u16 = 14;
/// `EE_ORIGINE_SPEED_LENTE`: speed off the switch in command 71, steps/s.
pub const HOME_SLOW_SPEED: u16 = 15;
/// `EE_AU`: input that acts as the ENABLE input does; 0 = none.
pub const EMERGENCY_STOP_INPUT: u16 = 22;
/// `EE_POLARITY_FDC`: polarity of special inputs, bit 0 that of the emergency stop.
pub const SPECIAL_POLARITY: u16 = 28;
/// `EE_POLARITY_OM`: polarity of home switches, bit 0 that of X.
pub const HOME_POLARITY: u16 = 32;
/// `EE_OUTPUT_START`: outputs after power-up, bit 0 = OUT1.
pub const OUTPUTS_AT_START: u16 = 47;
/// `EE_COUPLAGE_AXE`: 1 = A goes along with X, 2 = B does.
pub const COUPLING: u16 = 86;
/// `EE_OUTPUT_SET_NC_READY`: outputs that unlocking sets.
pub const SET_WHEN_UNLOCKED: u16 = 87;
/// `EE_INPUT_UNLOCK`: input that unlocks; 0 and polarity 1: unlocked as soon as ENABLE is there.
pub const UNLOCK_INPUT: u16 = 88;
/// `EE_INPUT_UNLOCK_POLARITY`: 0 = NO, 1 = NC.
pub const UNLOCK_POLARITY: u16 = 89;
/// `EE_OUTPUT_RESET_NC_READY`: outputs that unlocking resets.
pub const RESET_WHEN_UNLOCKED: u16 = 92;
/// `EE_OUTPUT_SET_NC_NOT_READY`: outputs that locking sets.
pub const SET_WHEN_LOCKED: u16 = 93;
/// `EE_OUTPUT_RESET_NC_NOT_READY`: outputs that locking resets.
pub const RESET_WHEN_LOCKED: u16 = 94;
/// `EE_MODBUS_SPEED`: speed of the serial line.
pub const MODBUS_SPEED: u16 = 101;
/// `EE_MODBUS_POLARITY`: parity of the serial line.
pub const MODBUS_PARITY: u16 = 102;
/// `EE_MODBUS_BASE_ADRESS`: station address.
pub const MODBUS_ADDRESS: u16 = 103;
/// `EE_ORIGINE_RESET_POS_SOFT`: 1 = command 71 sets the counters to 0.
pub const ZERO_AFTER_HOMING: u16 = 128;
/// `EE_AOUT1_LOCKED_VALUE`: analog output 1 of a locked board; that of output 2 follows.
pub const ANALOG_LOCKED: u16 = 130;

/// A parameter that each axis has, of X, Y, Z, A, B.
fn of_axis(numbers: [u16; 5], axis: BoardAxis) -> u16 {
    let [x, y, z, a, b] = numbers;
    match axis {
        BoardAxis::X => x,
        BoardAxis::Y => y,
        BoardAxis::Z => z,
        BoardAxis::A => a,
        BoardAxis::B => b,
    }
}

/// `EE_ORIGINE_XSENS` …: direction of command 71, 1 = positive.
pub fn home_direction(axis: BoardAxis) -> u16 {
    of_axis([9, 10, 11, 38, 50], axis)
}

/// `EE_ORIGINE_SPEED_RAPIDE` …: speed of command 71 towards the switch, steps/s.
pub fn home_speed(axis: BoardAxis) -> u16 {
    of_axis([12, 53, 54, 55, 56], axis)
}

/// `EE_ORIGINE_ACCEL_RAPIDE` …: acceleration and deceleration of command 71, 1000 steps/s².
pub fn home_acceleration(axis: BoardAxis) -> u16 {
    of_axis([13, 57, 58, 59, 60], axis)
}

/// `EE_FDC_ORIGINEX` …: input of the home switch, 0 = none.
pub fn home_input(axis: BoardAxis) -> u16 {
    of_axis([29, 30, 31, 41, 51], axis)
}

/// `EE_FDC_XNEG` … (104 to 123): input of a limit switch, 0 = none. The number after it is that of its polarity,
/// 0 = NO, 1 = NC.
pub fn limit_input(axis: BoardAxis, positive: bool) -> u16 {
    of_axis([104, 108, 112, 116, 120], axis) + if positive { 2 } else { 0 }
}

/// What a parameter takes, as far as that is known: there are 32 inputs and five axes. A parameter whose values nobody
/// explains takes any number.
pub fn values(number: u16) -> Values {
    let input = Values::Between(0, INPUTS.into());
    let yes_no = Values::Between(0, 1);
    let speed = Values::Between(0, MAX_SPEED_HZ.into());
    let word = Values::Between(0, u16::MAX.into());
    match number {
        EMERGENCY_STOP_INPUT | UNLOCK_INPUT => return input,
        UNLOCK_POLARITY | ZERO_AFTER_HOMING => return yes_no,
        HOME_POLARITY => return Values::Between(0, (1 << AXES) - 1),
        DEFAULT_START_STOP | HOME_START_STOP | HOME_SLOW_SPEED => return speed,
        DEFAULT_ACCELERATION => return word,
        MODBUS_PARITY => return Values::Between(0, 2),
        MODBUS_ADDRESS => return Values::Between(1, 247),
        _ => {}
    }
    if (ANALOG_LOCKED..=ANALOG_LOCKED + 1).contains(&number) {
        return Values::Between(0, 1023);
    }
    for axis in BoardAxis::ALL {
        let limits = [limit_input(axis, false), limit_input(axis, true)];
        if number == home_input(axis) || limits.contains(&number) {
            return input;
        } else if number == home_direction(axis) || limits.iter().any(|one| number == one + 1) {
            return yes_no;
        } else if number == home_speed(axis) {
            return speed;
        } else if number == home_acceleration(axis) {
            return word;
        }
    }
    Values::Between(0, u32::MAX.into())
}

/// Number, name and unit of what belongs to the board as a whole.
const NAMES: [(u16, &str, &str); 19] = [
    (DEFAULT_ACCELERATION, "EE_DEFAULT_ACCEL", "1000 steps/s²"),
    (DEFAULT_START_STOP, "EE_DEFAULT_STARTF", "steps/s"),
    (HOME_START_STOP, "EE_ORIGINE_STARTF_RAPIDE", "steps/s"),
    (HOME_SLOW_SPEED, "EE_ORIGINE_SPEED_LENTE", "steps/s"),
    (EMERGENCY_STOP_INPUT, "EE_AU", ""),
    (SPECIAL_POLARITY, "EE_POLARITY_FDC", ""),
    (HOME_POLARITY, "EE_POLARITY_OM", ""),
    (OUTPUTS_AT_START, "EE_OUTPUT_START", ""),
    (COUPLING, "EE_COUPLAGE_AXE", ""),
    (SET_WHEN_UNLOCKED, "EE_OUTPUT_SET_NC_READY", ""),
    (UNLOCK_INPUT, "EE_INPUT_UNLOCK", ""),
    (UNLOCK_POLARITY, "EE_INPUT_UNLOCK_POLARITY", ""),
    (RESET_WHEN_UNLOCKED, "EE_OUTPUT_RESET_NC_READY", ""),
    (SET_WHEN_LOCKED, "EE_OUTPUT_SET_NC_NOT_READY", ""),
    (RESET_WHEN_LOCKED, "EE_OUTPUT_RESET_NC_NOT_READY", ""),
    (MODBUS_SPEED, "EE_MODBUS_SPEED", ""),
    (MODBUS_PARITY, "EE_MODBUS_POLARITY", ""),
    (MODBUS_ADDRESS, "EE_MODBUS_BASE_ADRESS", ""),
    (ZERO_AFTER_HOMING, "EE_ORIGINE_RESET_POS_SOFT", ""),
];

/// What is known about a parameter; `place` says which axis of the caller's an axis of the board is.
pub(crate) fn describe(number: u16, place: impl Fn(BoardAxis) -> Option<usize>) -> ParameterInfo {
    let id = ParameterId { station: 0, number };
    let info = |name: String, unit| ParameterInfo {
        unit,
        of_the_line: (MODBUS_SPEED..=MODBUS_ADDRESS).contains(&number),
        ..ParameterInfo::new(id, name, values(number))
    };
    if let Some((_, name, unit)) = NAMES.iter().find(|(known, ..)| *known == number) {
        return info((*name).to_owned(), *unit);
    }
    for axis in BoardAxis::ALL {
        let limit = |positive| limit_input(axis, positive);
        let of_axis = [
            (home_direction(axis), "home direction", ""),
            (home_speed(axis), "home speed", "steps/s"),
            (home_acceleration(axis), "home acceleration", "1000 steps/s²"),
            (home_input(axis), "home switch input", ""),
            (limit(false), "limit switch - input", ""),
            (limit(false) + 1, "limit switch - polarity", ""),
            (limit(true), "limit switch + input", ""),
            (limit(true) + 1, "limit switch + polarity", ""),
        ];
        if let Some((_, name, unit)) = of_axis.into_iter().find(|(known, ..)| *known == number) {
            let named = info(format!("{name} of {axis}"), unit);
            return ParameterInfo { axis: place(axis), ..named };
        }
    }
    match number.checked_sub(ANALOG_LOCKED) {
        Some(output @ 0..=1) => info(format!("EE_AOUT{}_LOCKED_VALUE", output + 1), ""),
        _ => info(format!("parameter {number}"), ""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inputs are IN1 to IN32, axes five, stations 1 to 247.
    #[test]
    fn values_are_those_that_the_board_has() {
        let y = BoardAxis::Y;
        for (number, value, possible) in [
            (home_input(y), 32, true),
            (home_input(y), 33, false),
            (limit_input(y, true), 33, false),
            (limit_input(y, true) + 1, 2, false),
            (home_direction(y), 2, false),
            (HOME_POLARITY, 31, true),
            (HOME_POLARITY, 32, false),
            (MODBUS_ADDRESS, 0, false),
            (home_speed(y), 65_536, true),
            // Nobody says what this one is.
            (383, u32::MAX.into(), true),
        ] {
            assert_eq!(values(number).contain(value), possible, "{number} = {value}");
        }
    }

    /// Numbers of the digest (section 4) and of published sources.
    #[test]
    fn parameters_are_described() {
        let place = |axis| (axis == BoardAxis::Y).then_some(0);
        let named = |number| describe(number, place).name;
        assert_eq!((named(4), named(101)), ("EE_DEFAULT_ACCEL".into(), "EE_MODBUS_SPEED".into()));
        assert_eq!(
            (named(104), named(105)),
            ("limit switch - input of X".into(), "limit switch - polarity of X".into())
        );
        assert_eq!(
            (named(123), named(131)),
            ("limit switch + polarity of B".into(), "EE_AOUT2_LOCKED_VALUE".into())
        );
        assert_eq!(named(383), "parameter 383");
        assert_eq!((describe(30, place).axis, describe(29, place).axis), (Some(0), None));
        let of_the_line: Vec<_> =
            (0..PARAMETERS).filter(|number| describe(*number, place).of_the_line).collect();
        assert_eq!(of_the_line, [101, 102, 103]);
        let numbers: std::collections::HashSet<_> =
            NAMES.iter().map(|(number, ..)| number).collect();
        assert_eq!(numbers.len(), NAMES.len());
    }
}
