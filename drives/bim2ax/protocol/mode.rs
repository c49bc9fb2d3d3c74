//! "Mode de commande" (parameters 2 and 3; manual 3.1.2).

/// Drive mode: microsteps of the motor, and unit of its speeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DriveMode {
    code: u16,
    microsteps: u16,
    per_step: bool,
}

impl DriveMode {
    /// The modes there are, with microsteps per step. The unit of speeds in the two modes that older modules have
    /// ($0002, $0004) is not given; it is taken to be µsteps/s.
    const MODES: [(u16, u16); 16] = [
        (0x0000, 1),
        (0x0001, 1),
        (0x0002, 2),
        (0x0004, 32),
        (0x0010, 2),
        (0x0020, 4),
        (0x0030, 8),
        (0x0040, 16),
        (0x0050, 32),
        (0x0060, 64),
        (0x0100, 2),
        (0x0200, 4),
        (0x0300, 8),
        (0x0400, 16),
        (0x0500, 32),
        (0x0600, 64),
    ];

    /// Full steps with current in one winding.
    pub const FULL_STEP: Self = Self { code: 0, microsteps: 1, per_step: false };
    /// Full steps with current in both windings; an axis in this mode forces the other into it.
    pub const FULL_STEP_TWO_WINDINGS: Self = Self { code: 1, microsteps: 1, per_step: false };

    /// The mode of a parameter's value; none if the mode does not exist.
    pub fn from_code(code: u16) -> Option<Self> {
        let (_, microsteps) = Self::MODES.into_iter().find(|(known, _)| *known == code)?;
        Some(Self { code, microsteps, per_step: code >= 0x0100 })
    }

    /// The parameter's value.
    pub fn code(self) -> u16 {
        self.code
    }

    /// Microsteps per step, 1 to 64.
    pub fn microsteps(self) -> u16 {
        self.microsteps
    }

    /// Unit of speeds, µsteps/s, and of accelerations, µsteps/s².
    pub fn speed_unit(self) -> f64 {
        if self.per_step { f64::from(self.microsteps) } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_of_both_kinds_of_mode_are_related_as_in_the_manual() {
        // 3.1.2, note: 1000 steps/s in mode $0600 are 64000 µsteps/s in mode $0060.
        let (per_step, per_microstep) =
            (DriveMode::from_code(0x0600).unwrap(), DriveMode::from_code(0x0060).unwrap());
        assert!((1000.0 * per_step.speed_unit() - 64_000.0).abs() < f64::EPSILON);
        assert!((64_000.0 * per_microstep.speed_unit() - 64_000.0).abs() < f64::EPSILON);
    }

    #[test]
    fn exactly_the_modes_of_the_table_exist() {
        let divisions = [2, 4, 8, 16, 32, 64];
        for (place, microsteps) in (1..).zip(divisions) {
            assert_eq!(
                DriveMode::from_code(place << 4).map(DriveMode::microsteps),
                Some(microsteps)
            );
            assert_eq!(
                DriveMode::from_code(place << 8).map(DriveMode::microsteps),
                Some(microsteps)
            );
        }
        assert_eq!(DriveMode::from_code(2).map(DriveMode::microsteps), Some(2));
        assert_eq!(DriveMode::from_code(4).map(DriveMode::microsteps), Some(32));
        assert_eq!(DriveMode::from_code(0), Some(DriveMode::FULL_STEP));
        assert_eq!(DriveMode::from_code(1), Some(DriveMode::FULL_STEP_TWO_WINDINGS));
        assert_eq!((0..=u16::MAX).filter(|code| DriveMode::from_code(*code).is_some()).count(), 16);
    }
}
