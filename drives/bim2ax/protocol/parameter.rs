//! The parameters of the module (manual 3).

use crate::{AXES, DriveMode, REFERENCES};
use twin_drives::Values;

/// Largest target and reference position, µsteps (2.1.2: 0x003FFFFF).
pub const MOST_POSITION: i32 = 4_194_303;

/// Orders of the zone "Paramètre" (2.1.3).
pub mod order {
    /// Writes a parameter.
    pub const WRITE: u16 = 0x1000;
    /// Reads a parameter.
    pub const READ: u16 = 0x2000;
    /// Reads plug 1, 2 or both (number 3).
    pub const READ_PLUGS: u16 = 0x4000;
    /// Resets the module.
    pub const RESET: u16 = 0x8000;
}

/// One of the module's axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModuleAxis {
    /// Axis 1.
    One,
    /// Axis 2.
    Two,
}

impl ModuleAxis {
    /// Both.
    pub const ALL: [Self; AXES] = [Self::One, Self::Two];

    /// 0 or 1.
    pub fn index(self) -> usize {
        match self {
            Self::One => 0,
            Self::Two => 1,
        }
    }

    /// 1 or 2.
    pub fn number(self) -> u16 {
        match self {
            Self::One => 1,
            Self::Two => 2,
        }
    }
}

/// Values that a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// Sixteen bits, each with a meaning of its own.
    Bits,
    /// A drive mode.
    Mode,
    /// mA, within the rating of the module.
    Current,
    /// A distance without sign, µsteps.
    Distance,
    /// 1 to 65535.
    Positive,
    /// ±4194303 µsteps.
    Position,
    /// 32 bits with sign.
    Signed,
    /// Number of bits of an absolute encoder: at most 27 (SSI; `EnDat` 25).
    EncoderBits,
    /// Means nothing, takes anything.
    Unused,
    /// Cannot be written.
    ReadOnly,
}

impl Range {
    /// The numbers that a module of this rating, mA, takes.
    pub fn values(self, rating_ma: i64) -> Values {
        let most = i64::from(MOST_POSITION);
        match self {
            Self::Bits => Values::Between(0, 0xFFFF),
            Self::Mode => {
                let modes = (0..=u16::MAX).filter(|code| DriveMode::from_code(*code).is_some());
                Values::OneOf(modes.map(i64::from).collect())
            }
            // 3.1.3: from 3 % of the rating on.
            Self::Current => Values::Between(rating_ma * 3 / 100, rating_ma),
            Self::Distance => Values::Between(0, i32::MAX.into()),
            Self::Positive => Values::Between(1, 0xFFFF),
            Self::Position => Values::Between(-most, most),
            Self::EncoderBits => Values::Between(0, 27),
            Self::Signed | Self::ReadOnly => Values::Between(i32::MIN.into(), i32::MAX.into()),
            Self::Unused => Values::Between(0, u32::MAX.into()),
        }
    }
}

/// Parameter that each axis has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisParameter {
    /// Coefficient (3.1.1).
    Coefficient,
    /// Drive mode (3.1.2).
    Mode,
    /// Motor current, mA (3.1.3).
    MotorCurrent,
    /// Holding current, mA (3.1.4).
    HoldingCurrent,
    /// "Arrêt origine", µsteps (3.1.5).
    OriginStop,
    /// Fast speed (3.1.6).
    FastSpeed,
    /// Start-stop speed, elsewhere "vitesse mini" (3.1.7).
    StartStopSpeed,
    /// Way of the unidirectional approach, µsteps (3.1.8).
    Approach,
    /// Soft limit +, µsteps (3.1.9).
    SoftPlus,
    /// Soft limit −, µsteps (3.1.10).
    SoftMinus,
    /// Acceleration and deceleration (3.1.11).
    Acceleration,
    /// Reference position 1 to 10, µsteps (3.1.12).
    Reference(u8),
    /// Homing hysteresis, µsteps (3.1.13).
    Hysteresis,
    /// Dividend: µsteps per turn (3.1.14).
    Dividend,
    /// Divisor: encoder points per turn (3.1.15).
    Divisor,
    /// Offset of an absolute encoder, points (3.1.16).
    EncoderOffset,
    /// Unused (3.1.17).
    Unused,
    /// Bits of an absolute encoder (3.1.18).
    EncoderBits,
    /// Encoder definition (3.1.19).
    EncoderDefinition,
    /// Last stored position (3.1.20.1).
    LastPosition,
    /// State of the phases, not significant (3.1.20.2).
    Phases,
    /// CRC of the axis's parameters (3.1.20.5).
    ParameterCrc,
    /// Last stored position of the encoder (2.1.3).
    LastEncoderPosition,
}

use AxisParameter as P;

/// Parameter, number for axis 1 (axis 2 has the next), name, range, whether it needs a RESET.
const PAIRS: [(P, u16, &str, Range, bool); 22] = [
    (P::Coefficient, 0x00, "coefficient", Range::Bits, true),
    (P::Mode, 0x02, "drive mode", Range::Mode, true),
    (P::MotorCurrent, 0x04, "motor current", Range::Current, true),
    (P::HoldingCurrent, 0x06, "holding current", Range::Current, true),
    (P::OriginStop, 0x08, "origin stop", Range::Distance, true),
    (P::FastSpeed, 0x0A, "fast speed", Range::Positive, true),
    (P::StartStopSpeed, 0x0C, "start-stop speed", Range::Positive, true),
    (P::Approach, 0x0E, "unidirectional approach", Range::Distance, false),
    (P::SoftPlus, 0x10, "soft limit +", Range::Position, false),
    (P::SoftMinus, 0x12, "soft limit -", Range::Position, false),
    (P::Acceleration, 0x14, "acceleration", Range::Positive, true),
    (P::Hysteresis, 0x2A, "homing hysteresis", Range::Distance, false),
    (P::Dividend, 0x2C, "dividend", Range::Positive, true),
    (P::Divisor, 0x2E, "divisor", Range::Positive, true),
    (P::EncoderOffset, 0x30, "encoder offset", Range::Signed, true),
    (P::Unused, 0x32, "unused", Range::Unused, true),
    (P::EncoderBits, 0x34, "encoder bits", Range::EncoderBits, true),
    (P::EncoderDefinition, 0x36, "encoder definition", Range::Bits, true),
    (P::LastPosition, 0x38, "last position", Range::ReadOnly, false),
    (P::Phases, 0x3A, "phases", Range::ReadOnly, false),
    (P::ParameterCrc, 0x3E, "CRC of the parameters", Range::ReadOnly, false),
    (P::LastEncoderPosition, 0x40, "last encoder position", Range::ReadOnly, false),
];

/// First reference position of axis 1; those of axis 2 follow.
const FIRST_REFERENCE: u16 = 0x16;

/// A parameter of the module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// One of an axis.
    Axis(AxisParameter, ModuleAxis),
    /// $3C: CRC of the flash, read-only.
    FlashCrc,
    /// $3D: reserved, read-only.
    Reserved,
    /// $62: rating in mA (1000, 2000, 5000), −1 if it is not known; read-only.
    Rating,
    /// $63: version of the software, read-only.
    Version,
}

/// Signs in words, lest they look like options.
fn sign(word: &str) -> &str {
    match word {
        "+" => "plus",
        "-" => "minus",
        other => other,
    }
}

impl Parameter {
    /// Its number; none for a reference position other than 1 to 10.
    pub fn number(self) -> Option<u16> {
        match self {
            Self::Axis(AxisParameter::Reference(place), axis) => {
                let places = u16::try_from(REFERENCES).ok()?;
                let place = u16::from(place);
                let first = FIRST_REFERENCE + places * (axis.number() - 1);
                (1..=places).contains(&place).then(|| first + place - 1)
            }
            Self::Axis(parameter, axis) => {
                let pair = PAIRS.iter().find(|(known, ..)| *known == parameter)?;
                Some(pair.1 + axis.number() - 1)
            }
            Self::FlashCrc => Some(0x3C),
            Self::Reserved => Some(0x3D),
            Self::Rating => Some(0x62),
            Self::Version => Some(0x63),
        }
    }

    /// The parameter of a number; none if there is none.
    pub fn from_number(number: u16) -> Option<Self> {
        let singles = [Self::FlashCrc, Self::Reserved, Self::Rating, Self::Version];
        let references = (1..=10).map(AxisParameter::Reference);
        let pairs = PAIRS.iter().map(|(parameter, ..)| *parameter).chain(references);
        let of_axes =
            pairs.flat_map(|parameter| ModuleAxis::ALL.map(|axis| Self::Axis(parameter, axis)));
        of_axes.chain(singles).find(|parameter| parameter.number() == Some(number))
    }

    /// Values that it takes.
    pub fn range(self) -> Range {
        match self {
            Self::Axis(AxisParameter::Reference(_), _) => Range::Position,
            Self::Axis(parameter, _) => PAIRS
                .iter()
                .find(|(known, ..)| *known == parameter)
                .map_or(Range::ReadOnly, |(_, _, _, range, _)| *range),
            _ => Range::ReadOnly,
        }
    }

    /// True if a written value acts after RESET only.
    pub fn needs_reset(self) -> bool {
        let Self::Axis(parameter, _) = self else { return false };
        PAIRS.iter().any(|(known, _, _, _, reset)| *known == parameter && *reset)
    }

    /// The one name that it has in files, in messages and on the command line: that of the manual in lower case, without
    /// blanks, with the axis at its end.
    pub fn word(self) -> String {
        let words: Vec<&str> = self.name().split(' ').map(sign).collect();
        let name = words.join("-").to_lowercase();
        match self {
            Self::Axis(AxisParameter::Reference(place), axis) => {
                format!("{name}-{place}-{}", axis.number())
            }
            Self::Axis(_, axis) => format!("{name}-{}", axis.number()),
            _ => name,
        }
    }

    /// The parameter of a name: its [`Self::word`], or the manual's with its axis, as in "fast speed of axis 2", whatever its
    /// case.
    pub fn named(text: &str) -> Option<Self> {
        let plain = text.to_lowercase().replace(" of axis ", "-");
        let plain = plain.split(' ').map(sign).collect::<Vec<_>>().join("-");
        (0..=0x63).filter_map(Self::from_number).find(|parameter| parameter.word() == plain)
    }

    /// Name in the manual.
    pub fn name(self) -> &'static str {
        match self {
            Self::Axis(AxisParameter::Reference(_), _) => "reference position",
            Self::Axis(parameter, _) => PAIRS
                .iter()
                .find(|(known, ..)| *known == parameter)
                .map_or("unknown", |(_, _, name, ..)| name),
            Self::FlashCrc => "CRC of the flash",
            Self::Reserved => "reserved",
            Self::Rating => "current rating",
            Self::Version => "software version",
        }
    }

    /// True if a module of this rating (mA) takes the value, given as the 32 bits that are written.
    pub fn takes(self, value: u32, rating_ma: u32) -> bool {
        let signed = value.cast_signed();
        match self.range() {
            Range::Bits => value <= u16::MAX.into(),
            Range::Mode => {
                u16::try_from(value).is_ok_and(|code| DriveMode::from_code(code).is_some())
            }
            // 3.1.3: from 30, 60 or 150 mA to 1000, 2000 or 5000 mA.
            Range::Current => (rating_ma * 3 / 100..=rating_ma).contains(&value),
            Range::Distance => signed >= 0,
            Range::Positive => (1..=u16::MAX.into()).contains(&value),
            Range::Position => (-MOST_POSITION..=MOST_POSITION).contains(&signed),
            Range::EncoderBits => value <= 27,
            Range::Signed | Range::Unused => true,
            Range::ReadOnly => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_parameters_belong_together() {
        // 3: $0 to $41, $62 and $63.
        let known: Vec<u16> =
            (0..=u16::MAX).filter(|number| Parameter::from_number(*number).is_some()).collect();
        assert_eq!(known, (0..=0x41).chain([0x62, 0x63]).collect::<Vec<_>>());
        for number in known {
            assert_eq!(Parameter::from_number(number).unwrap().number(), Some(number));
        }
        let axis = |parameter, axis| Parameter::Axis(parameter, axis).number();
        assert_eq!(axis(P::FastSpeed, ModuleAxis::Two), Some(0x0B));
        assert_eq!(axis(P::Reference(1), ModuleAxis::One), Some(0x16));
        assert_eq!(axis(P::Reference(10), ModuleAxis::One), Some(0x1F));
        assert_eq!(axis(P::Reference(1), ModuleAxis::Two), Some(0x20));
        assert_eq!(axis(P::Reference(10), ModuleAxis::Two), Some(0x29));
        assert_eq!(axis(P::Reference(11), ModuleAxis::One), None);
        assert_eq!(axis(P::EncoderDefinition, ModuleAxis::One), Some(0x36));
    }

    #[test]
    fn resets_are_needed_as_the_manual_lists() {
        // 3, note: $0 to $D, $14 and $15, $2C to $37.
        for number in (0..=0x41).chain([0x62, 0x63]) {
            let listed = matches!(number, 0..=0x0D | 0x14 | 0x15 | 0x2C..=0x37);
            assert_eq!(Parameter::from_number(number).unwrap().needs_reset(), listed, "{number:X}");
        }
    }

    #[test]
    fn ranges_are_those_of_the_manual() {
        let takes = |number, value: i32| {
            Parameter::from_number(number).unwrap().takes(value.cast_unsigned(), 2000)
        };
        for (number, low, high) in [
            (0x04, 60, 2000),
            (0x0A, 1, 65_535),
            (0x0D, 1, 65_535),
            (0x10, -4_194_303, 4_194_303),
            (0x29, -4_194_303, 4_194_303),
            (0x34, 0, 27),
            (0x2F, 1, 65_535),
        ] {
            assert!(takes(number, low) && takes(number, high), "{number:X}");
            assert!(!takes(number, low - 1) && !takes(number, high + 1), "{number:X}");
        }
        assert!(takes(0x30, i32::MIN) && takes(0x02, 0x600) && !takes(0x02, 0x700));
        for number in (0x38..=0x41).chain([0x62, 0x63]) {
            assert!(!takes(number, 1), "{number:X} is read-only");
        }
        for (rating, least) in [(1000, 30), (2000, 60), (5000, 150)] {
            let current = Parameter::from_number(5).unwrap();
            assert!(current.takes(least, rating) && !current.takes(least - 1, rating));
        }
    }
}
