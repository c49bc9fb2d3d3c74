//! The EEPROM of the emulated module.

use crate::{
    AxisSettings, DriveMode, ModuleAxis, REFERENCES,
    protocol::parameter::{AxisParameter, Parameter},
};

/// Parameters that are stored: $0 to $41.
const STORED: usize = 0x42;
/// Bytes of an image: the values and their check sum.
const IMAGE_LENGTH: usize = 4 * STORED + 2;

/// The parameters as they are stored, or rubbish.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Eeprom {
    values: [u32; STORED],
    sound: bool,
}

impl Eeprom {
    /// A module of this rating (mA) set up as [`AxisSettings::default`] says, both axes alike: half and a quarter of
    /// the rating as currents, encoders of 2000 points on motors of 200 steps. The manual gives no defaults.
    pub fn new(rating_ma: u32) -> Self {
        let mut eeprom = Self { values: [0; STORED], sound: true };
        let settings = AxisSettings::default();
        for axis in ModuleAxis::ALL {
            let mut set = |parameter, value| eeprom.set(Parameter::Axis(parameter, axis), value);
            set(AxisParameter::Coefficient, settings.coefficient.into());
            set(AxisParameter::Mode, settings.mode.code().into());
            set(AxisParameter::MotorCurrent, rating_ma / 2);
            set(AxisParameter::HoldingCurrent, rating_ma / 4);
            set(AxisParameter::OriginStop, settings.origin_stop);
            set(AxisParameter::FastSpeed, settings.fast_speed.into());
            set(AxisParameter::StartStopSpeed, settings.start_stop_speed.into());
            set(AxisParameter::Approach, settings.approach);
            set(AxisParameter::SoftPlus, settings.soft_plus.cast_unsigned());
            set(AxisParameter::SoftMinus, settings.soft_minus.cast_unsigned());
            set(AxisParameter::Acceleration, settings.acceleration.into());
            set(AxisParameter::Hysteresis, settings.hysteresis);
            set(AxisParameter::Dividend, 200 * u32::from(settings.mode.microsteps()));
            set(AxisParameter::Divisor, 2000);
            set(AxisParameter::EncoderBits, 24);
        }
        eeprom
    }

    /// The EEPROM of a new card: its check sum is wrong (8.1).
    pub fn blank() -> Self {
        Self { values: [0; STORED], sound: false }
    }

    /// False if the check sum is wrong.
    pub fn sound(&self) -> bool {
        self.sound
    }

    /// Spoils the check sum.
    pub fn spoil(&mut self) {
        self.sound = false;
    }

    /// Makes the check sum right: writing a parameter does.
    pub(super) fn seal(&mut self) {
        self.sound = true;
    }

    /// The stored value of a parameter; 0 for one that is not stored.
    pub fn get(&self, parameter: Parameter) -> u32 {
        place(parameter).and_then(|place| self.values.get(place)).copied().unwrap_or(0)
    }

    /// Stores a value, whatever it is.
    pub fn set(&mut self, parameter: Parameter, value: u32) {
        if let Some(slot) = place(parameter).and_then(|place| self.values.get_mut(place)) {
            *slot = value;
        }
    }

    /// A value of 16 bits.
    pub(super) fn word(&self, parameter: AxisParameter, axis: ModuleAxis) -> u16 {
        let [.., high, low] = self.get(Parameter::Axis(parameter, axis)).to_be_bytes();
        u16::from_be_bytes([high, low])
    }

    /// A value with sign.
    pub(super) fn signed(&self, parameter: AxisParameter, axis: ModuleAxis) -> i32 {
        self.get(Parameter::Axis(parameter, axis)).cast_signed()
    }

    /// What the values say about the motion of an axis. A drive mode that does not exist counts as full steps; the
    /// mode $0001 of either axis is that of both (3.1.2).
    pub(super) fn settings(&self, axis: ModuleAxis) -> AxisSettings {
        let long = |parameter| self.get(Parameter::Axis(parameter, axis));
        let forced = ModuleAxis::ALL.iter().any(|axis| {
            self.word(AxisParameter::Mode, *axis) == DriveMode::FULL_STEP_TWO_WINDINGS.code()
        });
        let mode = if forced {
            DriveMode::FULL_STEP_TWO_WINDINGS
        } else {
            DriveMode::from_code(self.word(AxisParameter::Mode, axis))
                .unwrap_or(DriveMode::FULL_STEP)
        };
        let mut references = [0; REFERENCES];
        for (place, reference) in (1..).zip(&mut references) {
            *reference = self.signed(AxisParameter::Reference(place), axis);
        }
        AxisSettings {
            coefficient: self.word(AxisParameter::Coefficient, axis),
            mode,
            origin_stop: long(AxisParameter::OriginStop),
            fast_speed: self.word(AxisParameter::FastSpeed, axis),
            start_stop_speed: self.word(AxisParameter::StartStopSpeed, axis),
            approach: long(AxisParameter::Approach),
            soft_plus: self.signed(AxisParameter::SoftPlus, axis),
            soft_minus: self.signed(AxisParameter::SoftMinus, axis),
            acceleration: self.word(AxisParameter::Acceleration, axis),
            references,
            hysteresis: long(AxisParameter::Hysteresis),
        }
    }

    /// "CRC16 des paramètres" of an axis, over those that can be written (3.1.20.5). The manual does not say which
    /// CRC; this is CRC-16/CCITT-FALSE over the values, most significant byte first.
    pub(super) fn parameter_crc(&self, axis: ModuleAxis) -> u16 {
        let of_axis = |number: &u16| {
            Parameter::from_number(*number)
                .is_some_and(|parameter| matches!(parameter, Parameter::Axis(_, of) if of == axis))
        };
        let values = (0..0x38).filter(of_axis).filter_map(Parameter::from_number);
        crc16(values.flat_map(|parameter| self.get(parameter).to_be_bytes()))
    }

    /// The image, to be kept in a file: values from $0 to $41, four bytes each, most significant first, and a check
    /// sum over them (CRC-16/CCITT-FALSE), which is wrong if that of the EEPROM is.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes: Vec<u8> = self.values.iter().flat_map(|value| value.to_be_bytes()).collect();
        let sum = crc16(bytes.iter().copied());
        let sum = if self.sound { sum } else { !sum };
        bytes.extend(sum.to_be_bytes());
        bytes
    }

    /// An EEPROM whose image [`Self::to_bytes`] has made, sound or not; `None` if these bytes are something else.
    pub fn of_image(bytes: &[u8]) -> Option<Self> {
        let eeprom = Self::from_bytes(bytes);
        (eeprom.to_bytes() == bytes).then_some(eeprom)
    }

    /// An EEPROM with this image. One of another length, or with a wrong check sum, is that of a card whose check
    /// sum is wrong; what values there are, are kept.
    pub fn from_bytes(bytes: &[u8]) -> Self {
        let mut eeprom = Self::blank();
        let (values, sum) = bytes.split_at(bytes.len().min(4 * STORED));
        for (value, stored) in eeprom.values.iter_mut().zip(values.chunks_exact(4)) {
            let &[a, b, c, d] = stored else { continue };
            *value = u32::from_be_bytes([a, b, c, d]);
        }
        eeprom.sound =
            bytes.len() == IMAGE_LENGTH && *sum == crc16(values.iter().copied()).to_be_bytes();
        eeprom
    }
}

/// Where a parameter is stored.
fn place(parameter: Parameter) -> Option<usize> {
    parameter.number().map(usize::from).filter(|number| *number < STORED)
}

/// CRC-16/CCITT-FALSE: polynomial $1021, start $FFFF.
fn crc16(bytes: impl Iterator<Item = u8>) -> u16 {
    bytes.fold(0xFFFF, |sum, byte| {
        (0..8).fold(sum ^ u16::from(byte) << 8, |sum, _| {
            if sum & 0x8000 == 0 { sum << 1 } else { sum << 1 ^ 0x1021 }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_sum_is_the_published_one() {
        // CRC RevEng catalogue: CRC-16/IBM-3740 (CCITT-FALSE) of "123456789" is $29B1.
        assert_eq!(crc16(b"123456789".iter().copied()), 0x29B1);
    }

    #[test]
    fn images_come_back_and_every_changed_bit_is_found() {
        let mut eeprom = Eeprom::new(2000);
        eeprom.set(
            Parameter::Axis(AxisParameter::SoftMinus, ModuleAxis::Two),
            (-5_i32).cast_unsigned(),
        );
        let image = eeprom.to_bytes();
        assert_eq!(Eeprom::from_bytes(&image), eeprom);
        for place in 0..image.len() {
            let mut changed = image.clone();
            changed[place] ^= 0x10;
            assert!(!Eeprom::from_bytes(&changed).sound(), "byte {place}");
            assert!(!Eeprom::from_bytes(&image[..place]).sound(), "{place} bytes");
        }
        eeprom.spoil();
        assert_eq!(Eeprom::from_bytes(&eeprom.to_bytes()), eeprom);
        assert_eq!(Eeprom::of_image(&eeprom.to_bytes()), Some(eeprom));
        assert_eq!(Eeprom::of_image(&image).map(|eeprom| eeprom.sound()), Some(true));
        let mut changed = image.clone();
        changed[0] ^= 1;
        for other in [&[][..], b"[machine]\n", &image[1..], &changed] {
            assert_eq!(Eeprom::of_image(other), None);
        }
    }

    #[test]
    fn full_steps_in_two_windings_are_for_both_axes() {
        // 3.1.2: "Si il est choisi pour un axe, l'autre axe passe automatiquement dans ce même mode."
        let mut eeprom = Eeprom::new(1000);
        eeprom.set(Parameter::Axis(AxisParameter::Mode, ModuleAxis::Two), 1);
        for axis in ModuleAxis::ALL {
            assert_eq!(eeprom.settings(axis).mode, DriveMode::FULL_STEP_TWO_WINDINGS);
        }
    }
}
