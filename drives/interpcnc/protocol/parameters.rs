//! Numbers of the board's parameters, 32 bits each, saved in its EEPROM.
//!
//! The manual gives 88 (page 12), 101 (page 24) and 103 (page 3), and names of others. All other numbers come from
//! the vendor's published sources; meanings of values that neither gives are among the [`crate::Assumptions`].

use super::registers::{AXES, BoardAxis, INPUTS, MAX_SPEED_HZ};
use twin_drives::{ParameterId, ParameterInfo, Values};

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
/// `EE_MODBUS_BASE_ADRESS`: address address.
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

/// Values that a parameter takes, as far as they are known: there are 32 inputs and five axes. A parameter whose values nobody
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
        MODBUS_PARITY | COUPLING => return Values::Between(0, 2),
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

/// Number, name, the vendor's name and unit of what belongs to the board as a whole.
const NAMES: [(u16, &str, &str, &str); 19] = [
    (DEFAULT_ACCELERATION, "default-acceleration", "EE_DEFAULT_ACCEL", "1000 steps/s²"),
    (DEFAULT_START_STOP, "default-start-stop", "EE_DEFAULT_STARTF", "steps/s"),
    (HOME_START_STOP, "home-start-stop", "EE_ORIGINE_STARTF_RAPIDE", "steps/s"),
    (HOME_SLOW_SPEED, "home-slow-speed", "EE_ORIGINE_SPEED_LENTE", "steps/s"),
    (EMERGENCY_STOP_INPUT, "emergency-stop-input", "EE_AU", ""),
    (SPECIAL_POLARITY, "special-polarity", "EE_POLARITY_FDC", ""),
    (HOME_POLARITY, "home-polarity", "EE_POLARITY_OM", ""),
    (OUTPUTS_AT_START, "outputs-at-start", "EE_OUTPUT_START", ""),
    (COUPLING, "coupling", "EE_COUPLAGE_AXE", ""),
    (SET_WHEN_UNLOCKED, "set-when-unlocked", "EE_OUTPUT_SET_NC_READY", ""),
    (UNLOCK_INPUT, "unlock-input", "EE_INPUT_UNLOCK", ""),
    (UNLOCK_POLARITY, "unlock-polarity", "EE_INPUT_UNLOCK_POLARITY", ""),
    (RESET_WHEN_UNLOCKED, "reset-when-unlocked", "EE_OUTPUT_RESET_NC_READY", ""),
    (SET_WHEN_LOCKED, "set-when-locked", "EE_OUTPUT_SET_NC_NOT_READY", ""),
    (RESET_WHEN_LOCKED, "reset-when-locked", "EE_OUTPUT_RESET_NC_NOT_READY", ""),
    (MODBUS_SPEED, "modbus-speed", "EE_MODBUS_SPEED", ""),
    (MODBUS_PARITY, "modbus-parity", "EE_MODBUS_POLARITY", ""),
    (MODBUS_ADDRESS, "modbus-address", "EE_MODBUS_BASE_ADRESS", ""),
    (ZERO_AFTER_HOMING, "zero-after-homing", "EE_ORIGINE_RESET_POS_SOFT", ""),
];

/// What each axis has: which number, the name before that of the axis, and the unit.
fn of_each(axis: BoardAxis) -> [(u16, &'static str, &'static str); 8] {
    let limit = |positive| limit_input(axis, positive);
    [
        (home_direction(axis), "home-direction", ""),
        (home_speed(axis), "home-speed", "steps/s"),
        (home_acceleration(axis), "home-acceleration", "1000 steps/s²"),
        (home_input(axis), "home-input", ""),
        (limit(false), "limit-minus-input", ""),
        (limit(false) + 1, "limit-minus-polarity", ""),
        (limit(true), "limit-plus-input", ""),
        (limit(true) + 1, "limit-plus-polarity", ""),
    ]
}

/// The one name that a parameter has in files, in messages and on the command line; none of those that nobody explains.
pub fn name(number: u16) -> Option<String> {
    if let Some((_, name, ..)) = NAMES.iter().find(|(known, ..)| *known == number) {
        return Some((*name).to_owned());
    }
    for axis in BoardAxis::ALL {
        let found = of_each(axis).into_iter().find(|(known, ..)| *known == number);
        if let Some((_, name, _)) = found {
            return Some(format!("{name}-{}", axis.to_string().to_lowercase()));
        }
    }
    let output = number.checked_sub(ANALOG_LOCKED).filter(|output| *output <= 1)?;
    Some(format!("analog-{}-locked", output + 1))
}

/// The parameter of a name, ours or the vendor's, whatever its case.
pub fn named(text: &str) -> Option<u16> {
    let of_vendor = NAMES.iter().find(|(_, _, vendor, _)| vendor.eq_ignore_ascii_case(text));
    let ours = || {
        (0..PARAMETERS)
            .find(|number| name(*number).is_some_and(|name| name.eq_ignore_ascii_case(text)))
    };
    of_vendor.map(|(number, ..)| *number).or_else(ours)
}

/// What is known about a parameter; `place` says which axis of the caller's an axis of the board is.
pub(crate) fn describe(number: u16, place: impl Fn(BoardAxis) -> Option<usize>) -> ParameterInfo {
    let id = ParameterId { address: 0, number };
    let info = |name: String, unit| ParameterInfo {
        unit,
        of_the_line: (MODBUS_SPEED..=MODBUS_ADDRESS).contains(&number),
        ..ParameterInfo::new(id, name, values(number))
    };
    if let Some((.., unit)) = NAMES.iter().find(|(known, ..)| *known == number) {
        return info(name(number).unwrap_or_default(), *unit);
    }
    for axis in BoardAxis::ALL {
        let found = of_each(axis).into_iter().find(|(known, ..)| *known == number);
        if let Some((.., unit)) = found {
            let named = info(name(number).unwrap_or_default(), unit);
            return ParameterInfo { axis: place(axis), ..named };
        }
    }
    info(name(number).unwrap_or_else(|| format!("parameter {number}")), "")
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
            (COUPLING, 2, true),
            (COUPLING, 3, false),
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
        let called = |number| describe(number, place).name;
        for (number, said) in [
            (4, "default-acceleration"),
            (101, "modbus-speed"),
            (104, "limit-minus-input-x"),
            (105, "limit-minus-polarity-x"),
            (123, "limit-plus-polarity-b"),
            (131, "analog-2-locked"),
            (383, "parameter 383"),
        ] {
            assert_eq!(called(number), said);
            assert_eq!(named(said), (number != 383).then_some(number), "{said}");
        }
        // The vendor's names are understood, too.
        assert_eq!((named("EE_DEFAULT_ACCEL"), named("ee_modbus_speed")), (Some(4), Some(101)));
        assert_eq!(named("nonsense"), None);
        assert_eq!((describe(30, place).axis, describe(29, place).axis), (Some(0), None));
        let of_the_line: Vec<_> =
            (0..PARAMETERS).filter(|number| describe(*number, place).of_the_line).collect();
        assert_eq!(of_the_line, [101, 102, 103]);
        let numbers: std::collections::HashSet<_> =
            NAMES.iter().map(|(number, ..)| number).collect();
        assert_eq!(numbers.len(), NAMES.len());
    }
}
