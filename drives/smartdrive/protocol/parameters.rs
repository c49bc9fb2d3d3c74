//! Parameters and variables: index, type, range, access, unit, and what the emulated device has from the factory.
//!
//! Source: "Paramètres de configuration" and "Variables". The manual gives no factory values; the emulator chooses
//! them. Errata: `VelExitHome` is printed in rpm/s and is a speed; `Dec_Setpoint` and `Acc_Current` both are printed
//! with index 85, of which the second is assumed to be 86.

use twin_drives::Values;

/// Format of a stored number: its size and its sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// 16 bits without sign, or not negative.
    Word,
    /// 16 bits with sign.
    Signed,
    /// 16 bits, not negative, 32768 is one: Q1.15.
    Fraction,
    /// 32 bits without sign, or not negative.
    Long,
    /// 32 bits with sign.
    SignedLong,
}

impl Kind {
    /// Whether it takes two words, the low one at the index and the high one at the next.
    pub fn is_long(self) -> bool {
        matches!(self, Self::Long | Self::SignedLong)
    }
}

/// A parameter or variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Index; of the low word.
    pub index: u16,
    /// Name as in the manual without `PAR_`, `VAR_`.
    pub name: &'static str,
    /// Type.
    pub kind: Kind,
    /// Smallest value.
    pub low: i64,
    /// Largest value.
    pub high: i64,
    /// Unit, empty if there is none.
    pub unit: &'static str,
    /// Whether it can be changed.
    pub writable: bool,
    /// Factory setting of the emulated device.
    pub factory: i64,
}

impl Entry {
    const fn new(index: u16, name: &'static str, kind: Kind) -> Self {
        let (low, high) = match kind {
            Kind::Word => (0, 0xFFFF),
            Kind::Signed => (-32_768, 32_767),
            Kind::Fraction => (0, 32_767),
            Kind::Long => (0, 0xFFFF_FFFF),
            Kind::SignedLong => (-0x8000_0000, 0x7FFF_FFFF),
        };
        Self { index, name, kind, low, high, unit: "", writable: true, factory: 0 }
    }

    const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    const fn range(self, low: i64, high: i64) -> Self {
        Self { low, high, ..self }
    }

    const fn factory(self, factory: i64) -> Self {
        Self { factory, ..self }
    }

    const fn read_only(self) -> Self {
        Self { writable: false, ..self }
    }

    /// Values that it takes: of `StepDivisor` the powers of 2.
    pub fn values(&self) -> Values {
        if self.index == STEP_DIVISOR {
            Values::OneOf((self.low..=self.high).filter(|value| self.accepts(*value)).collect())
        } else {
            Values::Between(self.low, self.high)
        }
    }

    /// Whether it can have this value.
    pub fn accepts(&self, value: i64) -> bool {
        let power = self.index != STEP_DIVISOR || value.count_ones() == 1;
        power && (self.low..=self.high).contains(&value)
    }

    /// The value in 32 bits, or in the 16 bits that count.
    pub fn value(&self, bits: u32) -> i64 {
        let [a, b, ..] = bits.to_le_bytes();
        let word = u16::from_le_bytes([a, b]);
        match self.kind {
            Kind::Word | Kind::Fraction => word.into(),
            Kind::Signed => word.cast_signed().into(),
            Kind::Long => bits.into(),
            Kind::SignedLong => bits.cast_signed().into(),
        }
    }
}

/// Indices of parameters that have a meaning for driver and device.
pub const RELEASE: u16 = 0;
/// Address on the bus.
pub const ADDRESS: u16 = 2;
/// Product, 5342h.
pub const PID: u16 = 12;
/// List of parameters, 0101h.
pub const CID: u16 = 13;
/// Lower position limit.
pub const POSITION_MIN: u16 = 26;
/// Upper position limit.
pub const POSITION_MAX: u16 = 28;
/// Ceiling of speeds.
pub const VELOCITY_MAX: u16 = 30;
/// Ceiling of accelerations.
pub const ACCELERATION_MAX: u16 = 31;
/// Ceiling of decelerations.
pub const DECELERATION_MAX: u16 = 32;
/// Deceleration in emergencies.
pub const DECELERATION_LIMIT: u16 = 33;
/// Full steps of a turn.
pub const FULL_STEPS: u16 = 43;
/// µsteps of a full step.
pub const STEP_DIVISOR: u16 = 44;
/// Resolution of encoder 1; that of encoder 2 is two further.
pub const ENCODER_1: u16 = 48;
/// Resolution of encoder 2.
pub const ENCODER_2: u16 = 50;
/// Position that the home switch has.
pub const POSITION_OFFSET: u16 = 100;
/// Distance of the modes that advance by steps.
pub const PUSH_PULL_DISTANCE: u16 = 102;
/// Speed towards the home switch.
pub const VELOCITY_ENTER_HOME: u16 = 116;
/// Settings of homing, in bits that the manual does not explain.
pub const HOME_CONFIGURATION: u16 = 120;
/// Speed off the home switch.
pub const VELOCITY_EXIT_HOME: u16 = 117;
/// Acceleration of homing.
pub const ACCELERATION_HOME: u16 = 118;
/// Deceleration on the home switch.
pub const DECELERATION_HOME: u16 = 119;

/// Words of the parameter memory: one more than the last index.
pub const PARAMETER_WORDS: usize = 121;

/// Highest non-negative 16-bit number.
const P16: i64 = 32_767;

/// All parameters.
pub const PARAMETERS: [Entry; 29] = [
    Entry::new(RELEASE, "Release", Kind::Word).factory(0x1020).read_only(),
    Entry::new(ADDRESS, "ATB_Address", Kind::Word).range(1, 31).factory(1),
    Entry::new(PID, "PID", Kind::Word).range(0x5342, 0x5342).factory(0x5342).read_only(),
    Entry::new(CID, "CID", Kind::Word).range(0x0101, 0x0101).factory(0x0101).read_only(),
    Entry::new(16, "Flags", Kind::Long),
    Entry::new(POSITION_MIN, "Trj_PosMin", Kind::SignedLong).unit("µsteps"),
    Entry::new(POSITION_MAX, "Trj_PosMax", Kind::SignedLong).unit("µsteps"),
    Entry::new(VELOCITY_MAX, "Trj_VelMax", Kind::Word).range(1, P16).unit("rpm").factory(500),
    Entry::new(ACCELERATION_MAX, "Trj_AccMax", Kind::Word)
        .range(1, P16)
        .unit("rpm/s")
        .factory(2000),
    Entry::new(DECELERATION_MAX, "Trj_DecMax", Kind::Word)
        .range(0, P16)
        .unit("rpm/s")
        .factory(2000),
    Entry::new(DECELERATION_LIMIT, "Trj_DecLim", Kind::Word)
        .range(0, P16)
        .unit("rpm/s")
        .factory(10_000),
    Entry::new(FULL_STEPS, "Mot_FullSteps", Kind::Word).range(1, P16).factory(200),
    Entry::new(STEP_DIVISOR, "Mot_StepDivisor", Kind::Word).range(1, 1024).factory(16),
    Entry::new(ENCODER_1, "Enc1_Resolution", Kind::Word).range(1, P16).unit("inc").factory(4000),
    Entry::new(ENCODER_2, "Enc2_Resolution", Kind::Word).range(1, P16).unit("inc").factory(4000),
    Entry::new(65, "Cur_Max", Kind::Fraction).unit("/32768").factory(16_384),
    Entry::new(66, "Cur_Idle", Kind::Fraction).unit("/32768").factory(9830),
    Entry::new(67, "Cur_Run", Kind::Fraction).unit("/32768").factory(26_214),
    Entry::new(68, "Cur_Acc", Kind::Fraction).unit("/32768").factory(32_767),
    Entry::new(POSITION_OFFSET, "App_PosOffset", Kind::SignedLong).unit("µsteps"),
    Entry::new(PUSH_PULL_DISTANCE, "App_PushPullDist", Kind::SignedLong)
        .unit("µsteps")
        .factory(3200),
    Entry::new(104, "App_PushPullDistAlt", Kind::SignedLong).unit("µsteps").factory(1600),
    Entry::new(106, "App_AutoGOPeriod", Kind::Long).range(0, 0x7FFF_FFFF).unit("ms"),
    Entry::new(108, "App_AutoGODuration", Kind::Long).range(0, 0x7FFF_FFFF).unit("ms"),
    Entry::new(VELOCITY_ENTER_HOME, "App_VelEnterHome", Kind::Word)
        .range(0, P16)
        .unit("rpm")
        .factory(120),
    Entry::new(VELOCITY_EXIT_HOME, "App_VelExitHome", Kind::Word)
        .range(0, P16)
        .unit("rpm")
        .factory(15),
    Entry::new(ACCELERATION_HOME, "App_AccHome", Kind::Word)
        .range(0, P16)
        .unit("rpm/s")
        .factory(1000),
    Entry::new(DECELERATION_HOME, "App_DecHome", Kind::Word)
        .range(0, P16)
        .unit("rpm/s")
        .factory(2000),
    Entry::new(HOME_CONFIGURATION, "App_CfgHome", Kind::Word),
];

/// The parameter that has a word at `index`, and whether that is its high word.
pub fn parameter_at(index: u16) -> Option<(&'static Entry, bool)> {
    PARAMETERS.iter().find_map(|entry| {
        if entry.index == index {
            Some((entry, false))
        } else if entry.kind.is_long() && entry.index + 1 == index {
            Some((entry, true))
        } else {
            None
        }
    })
}

/// Indices of variables that have a meaning for driver and device.
pub const ANALOG_1: u16 = 42;
/// The second analog input.
pub const ANALOG_2: u16 = 43;
/// Encoder 1.
pub const VAR_ENCODER_1: u16 = 44;
/// Encoder 2.
pub const VAR_ENCODER_2: u16 = 45;
/// Supply, V.
pub const SUPPLY: u16 = 67;
/// Present alarms.
pub const ALARM_STATUS: u16 = 68;
/// Position asked of the motor.
pub const POSITION_SETPOINT: u16 = 74;
/// Position.
pub const POSITION_ACTUAL: u16 = 75;
/// Speed asked of the motor.
pub const VELOCITY_SETPOINT: u16 = 78;
/// Speed.
pub const VELOCITY_ACTUAL: u16 = 79;
/// Internal scale of speeds.
pub const VELOCITY_ATTENUATION: u16 = 81;
/// Acceleration of the last command.
pub const ACCELERATION_SETPOINT: u16 = 84;
/// Deceleration of the last command.
pub const DECELERATION_SETPOINT: u16 = 85;
/// Present acceleration; printed as 85.
pub const ACCELERATION_CURRENT: u16 = 86;
/// Output RDY; BRK and LED follow.
pub const OUTPUT_RDY: u16 = 128;
/// Output LED, the last.
pub const OUTPUT_LED: u16 = 130;
/// State of input GO; its captures (any edge, active, inverse) follow, then DIR, OFF, LIMP and LIMN in the same way.
pub const INPUT_GO: u16 = 136;
/// Capture of the inverse edge of LIMN, the last.
pub const REVERSE_LIMN: u16 = 155;

const fn variable(index: u16, name: &'static str, kind: Kind) -> Entry {
    Entry::new(index, name, kind).read_only()
}

/// All variables.
pub const VARIABLES: [Entry; 37] = [
    variable(ANALOG_1, "Analog1", Kind::Word).range(0, P16),
    variable(ANALOG_2, "Analog2", Kind::Word).range(0, P16),
    variable(VAR_ENCODER_1, "Encoder1", Kind::SignedLong).unit("inc"),
    variable(VAR_ENCODER_2, "Encoder2", Kind::SignedLong).unit("inc"),
    variable(SUPPLY, "Alm_Supply", Kind::Word).range(0, P16).unit("V"),
    variable(ALARM_STATUS, "Alm_Status", Kind::Word),
    variable(POSITION_SETPOINT, "Pos_Setpoint", Kind::SignedLong).unit("µsteps"),
    variable(POSITION_ACTUAL, "Pos_Actual", Kind::SignedLong).unit("µsteps"),
    variable(VELOCITY_SETPOINT, "Vel_Setpoint", Kind::Signed).unit("rpm"),
    variable(VELOCITY_ACTUAL, "Vel_Actual", Kind::Signed).unit("rpm"),
    variable(VELOCITY_ATTENUATION, "Vel_Atten", Kind::Fraction).unit("/32768"),
    variable(ACCELERATION_SETPOINT, "Acc_Setpoint", Kind::Signed).range(0, P16).unit("rpm/s"),
    variable(DECELERATION_SETPOINT, "Dec_Setpoint", Kind::Signed).range(0, P16).unit("rpm/s"),
    variable(ACCELERATION_CURRENT, "Acc_Current", Kind::Signed).unit("rpm/s"),
    Entry::new(OUTPUT_RDY, "Out_RDY", Kind::Word),
    Entry::new(129, "Out_BRK", Kind::Word),
    Entry::new(OUTPUT_LED, "Out_LED", Kind::Word),
    variable(INPUT_GO, "Inp_GO", Kind::Word),
    variable(137, "Chg_GO", Kind::Word),
    variable(138, "Act_GO", Kind::Word),
    variable(139, "Rev_GO", Kind::Word),
    variable(140, "Inp_DIR", Kind::Word),
    variable(141, "Chg_DIR", Kind::Word),
    variable(142, "Act_DIR", Kind::Word),
    variable(143, "Rev_DIR", Kind::Word),
    variable(144, "Inp_OFF", Kind::Word),
    variable(145, "Chg_OFF", Kind::Word),
    variable(146, "Act_OFF", Kind::Word),
    variable(147, "Rev_OFF", Kind::Word),
    variable(148, "Inp_LIMP", Kind::Word),
    variable(149, "Chg_LIMP", Kind::Word),
    variable(150, "Act_LIMP", Kind::Word),
    variable(151, "Rev_LIMP", Kind::Word),
    variable(152, "Inp_LIMN", Kind::Word),
    variable(153, "Chg_LIMN", Kind::Word),
    variable(154, "Act_LIMN", Kind::Word),
    variable(REVERSE_LIMN, "Rev_LIMN", Kind::Word),
];

/// The variable with an index.
pub fn variable_at(index: u16) -> Option<&'static Entry> {
    VARIABLES.iter().find(|entry| entry.index == index)
}

/// The entry of a name, whatever its case, among `entries`.
pub fn named(entries: &'static [Entry], name: &str) -> Option<&'static Entry> {
    entries.iter().find(|entry| entry.name.eq_ignore_ascii_case(name))
}

/// A fraction as Q1.15: `None` outside [0, 1).
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "just compared")]
pub fn to_q15(fraction: f64) -> Option<u16> {
    let value = (fraction * 32_768.0).round();
    (0.0..32_768.0).contains(&value).then_some(value as u16)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Index, words and range of the manual's table, typed off it once more.
    #[test]
    fn parameters_are_those_of_the_manual() {
        let p16 = [(30, 1), (31, 1), (32, 0), (33, 0), (43, 1), (48, 1), (50, 1)];
        for (index, low) in p16 {
            let (entry, _) = parameter_at(index).unwrap();
            assert!(entry.accepts(low) && entry.accepts(32_767), "{index}");
            assert!(!entry.accepts(low - 1) && !entry.accepts(32_768), "{index}");
        }
        for index in [26, 28, 100, 102, 104] {
            let (entry, high) = parameter_at(index + 1).unwrap();
            assert!(high && entry.index == index && entry.kind == Kind::SignedLong);
            assert!(entry.accepts(-2_147_483_648) && !entry.accepts(2_147_483_648));
        }
        let (divisor, _) = parameter_at(44).unwrap();
        let accepted: Vec<i64> = (-1..5000).filter(|value| divisor.accepts(*value)).collect();
        assert_eq!(accepted, [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024]);
        let read_only: Vec<u16> =
            PARAMETERS.iter().filter(|entry| !entry.writable).map(|entry| entry.index).collect();
        assert_eq!(read_only, [0, 12, 13]);
        for index in [1, 3, 14, 15, 18, 34, 45, 49, 51, 64, 69, 99, 110, 115, 121] {
            assert_eq!(parameter_at(index), None, "{index}");
        }
        assert!(PARAMETERS.iter().all(|entry| entry.accepts(entry.factory)));
        assert!(!parameter_at(2).unwrap().0.accepts(0) && !parameter_at(2).unwrap().0.accepts(32));
    }

    #[test]
    fn variables_are_those_of_the_manual() {
        let indices: Vec<u16> = VARIABLES.iter().map(|entry| entry.index).collect();
        let expected = [42, 43, 44, 45, 67, 68, 74, 75, 78, 79, 81, 84, 85, 86, 128, 129, 130];
        assert_eq!(indices[..17], expected);
        assert_eq!(indices[17..], (136..=155).collect::<Vec<u16>>());
        let writable = VARIABLES.iter().filter(|entry| entry.writable);
        assert_eq!(writable.map(|entry| entry.index).collect::<Vec<_>>(), [128, 129, 130]);
        // 136 + 4·k for GO, DIR, OFF, LIMP, LIMN.
        assert_eq!(variable_at(148).unwrap().name, "Inp_LIMP");
        assert_eq!(named(&VARIABLES, "rev_limn").unwrap().index, 155);
    }

    /// "Annexe": 0.3 · 32768 = 9830.
    #[test]
    fn fractions_are_q15() {
        assert_eq!(to_q15(0.3), Some(9830));
        assert_eq!((to_q15(1.0), to_q15(-0.1), to_q15(0.0)), (None, None, Some(0)));
    }

    #[test]
    fn bits_are_read_with_their_sign() {
        let value = |index, bits| variable_at(index).unwrap().value(bits);
        assert_eq!(value(75, 0xFFFF_FC18), -1000);
        assert_eq!(value(79, 0xFFFF_FDA8), -600);
        assert_eq!(value(68, 0x0001_0008), 8);
    }
}
