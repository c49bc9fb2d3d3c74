//! Digital inputs and outputs.

use super::MAX_DRIVE_AXES;

/// A set of digital signals, each with the name its maker gives it.
///
/// The names repeat where several units of the same kind are one device: the second unit's signals follow the first's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bits {
    /// Levels, the first signal lowest.
    levels: u64,
    /// How many signals there are, at most 64.
    count: u8,
    /// Names of the signals of one unit.
    names: &'static [&'static str],
}

impl Bits {
    /// `count` signals (at most 64) with these levels, of units whose signals have these names.
    pub fn new(levels: u64, count: u8, names: &'static [&'static str]) -> Self {
        let count = count.min(64);
        let known = 1_u64.checked_shl(count.into()).map_or(u64::MAX, |beyond| beyond - 1);
        Self { levels: levels & known, count, names }
    }

    /// Levels, the first signal lowest.
    pub fn levels(&self) -> u64 {
        self.levels
    }

    /// Number of signals.
    pub fn count(&self) -> u8 {
        self.count
    }

    /// Level of signal `number`, from 1; `None` if there is none.
    pub fn get(&self, number: u8) -> Option<bool> {
        let place = number.checked_sub(1).filter(|place| *place < self.count)?;
        Some(self.levels >> place & 1 == 1)
    }

    /// Name of signal `number`, from 1; with the unit in front, from 1, where there are several.
    pub fn name(&self, number: u8) -> Option<String> {
        let place = usize::from(number.checked_sub(1).filter(|place| *place < self.count)?);
        let unit = place.checked_div(self.names.len())?;
        let name = self.names.get(place.checked_rem(self.names.len())?)?;
        let several = usize::from(self.count) > self.names.len();
        Some(if several { format!("{}.{name}", unit + 1) } else { (*name).to_owned() })
    }

    /// Number of the signal with a name, whatever its case.
    pub fn number(&self, name: &str) -> Option<u8> {
        (1..=self.count)
            .find(|number| self.name(*number).is_some_and(|known| known.eq_ignore_ascii_case(name)))
    }

    /// All signals: number from 1, name, level.
    pub fn iter(&self) -> impl Iterator<Item = (u8, String, bool)> + use<'_> {
        (1..=self.count).filter_map(|number| Some((number, self.name(number)?, self.get(number)?)))
    }
}

/// Meaning of the inputs of a device for one axis. Absent are inputs that the device does not have or does not distinguish.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AxisSignals {
    /// On the limit switch towards larger positions.
    pub positive_limit: Option<bool>,
    /// On the limit switch towards smaller positions.
    pub negative_limit: Option<bool>,
    /// On the home switch.
    pub home: Option<bool>,
}

/// Inputs and outputs of a device at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signals {
    /// Middle of the exchange on the caller's clock, ns; of the exchanges where it takes several.
    pub time_ns: i64,
    /// Inputs. Probes are ordinary inputs of all families.
    pub inputs: Bits,
    /// Outputs as the device shows them, numbered as [`crate::Drive::set_output`] does.
    pub outputs: Bits,
    /// Whether the enable input lets the device work; `None` if the input does not exist.
    pub enable: Option<bool>,
    /// Inputs with a meaning for the axes.
    pub axes: [AxisSignals; MAX_DRIVE_AXES],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signals_have_numbers_and_names() {
        let one = Bits::new(0b110, 2, &["IN1", "IN2"]);
        assert_eq!((one.levels(), one.get(1), one.get(2)), (0b10, Some(false), Some(true)));
        assert_eq!((one.get(0), one.get(3), one.name(3)), (None, None, None));
        assert_eq!(one.number("in2"), Some(2));
        let two = Bits::new(0b0101, 4, &["LIMP", "LIMN"]);
        let all: Vec<_> = two.iter().collect();
        let named = [(1, "1.LIMP", true), (2, "1.LIMN", false), (3, "2.LIMP", true)];
        for (found, (number, name, on)) in all.iter().zip(named) {
            assert_eq!(*found, (number, name.to_owned(), on));
        }
        assert_eq!((all.len(), two.number("2.LIMN")), (4, Some(4)));
        let none = Bits::default();
        assert_eq!((none.count(), none.iter().count()), (0, 0));
        assert_eq!(Bits::new(u64::MAX, 64, &[]).levels(), u64::MAX);
    }
}
