//! What is exchanged with a drive, and what its loop controls (2.1.3, 2.2.4).
//!
//! All three families take positions and tell positions, and close what loop they have themselves: there is nothing that a run
//! could choose, and a master that asks for another type or mode is refused here with the manual's error. That is all these
//! types are for; `twin` has no key for what can only be one value.

use super::AxisError;

/// `wControlType`: what the drive is told and what it tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlType {
    /// 1: torque.
    Torque,
    /// 2: velocity, and velocity back.
    VelocityVelocity,
    /// 3: velocity, and position back.
    VelocityPosition,
    /// 4: position, and position back.
    PositionPosition,
    /// 5: position and velocity, both back.
    PositionVelocity,
    /// 6: velocity.
    Velocity,
    /// 7: as `wCyclicDataS1` to `wCyclicDataR3` say.
    Configurable,
}

impl ControlType {
    /// All, by number from 1.
    pub const ALL: [Self; 7] = [
        Self::Torque,
        Self::VelocityVelocity,
        Self::VelocityPosition,
        Self::PositionPosition,
        Self::PositionVelocity,
        Self::Velocity,
        Self::Configurable,
    ];

    /// The type of a number; 0 stands for 7 in one of the manual's tables (2.4).
    pub fn from_number(number: u16) -> Option<Self> {
        match number {
            0 => Some(Self::Configurable),
            number => Self::ALL.get(usize::from(number.checked_sub(1)?)).copied(),
        }
    }

    /// Checks that a [`crate::Drive`] exchanges this: all families take positions and give positions.
    ///
    /// # Errors
    /// [`AxisError::ControlType`] for any other.
    pub fn check(self) -> Result<(), AxisError> {
        let here = self == Self::PositionPosition;
        if here { Ok(()) } else { Err(AxisError::ControlType { control: self }) }
    }
}

/// `SMC_CONTROLLER_MODE`, parameters 1091 and 1092.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ControllerMode {
    /// 1, `SMC_torque`.
    #[doc(alias = "SMC_torque")]
    Torque,
    /// 2, `SMC_velocity`.
    #[doc(alias = "SMC_velocity")]
    Velocity,
    /// 3, `SMC_position`.
    #[doc(alias = "SMC_position")]
    #[default]
    Position,
    /// 4, `SMC_current`.
    #[doc(alias = "SMC_current")]
    Current,
}

impl ControllerMode {
    /// The mode of a number.
    pub fn from_number(number: u8) -> Option<Self> {
        match number {
            1 => Some(Self::Torque),
            2 => Some(Self::Velocity),
            3 => Some(Self::Position),
            4 => Some(Self::Current),
            _ => None,
        }
    }

    /// `SMC_SetControllerMode` for a [`crate::Drive`]: step motors of all families are in position mode and stay there.
    ///
    /// # Errors
    /// [`AxisError::ControllerMode`] (70) for any other.
    pub fn check(self) -> Result<(), AxisError> {
        let here = self == Self::Position;
        if here { Ok(()) } else { Err(AxisError::ControllerMode { mode: self }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_manual() {
        let types: Vec<_> = (0..9).map(ControlType::from_number).collect();
        assert_eq!(types[0], Some(ControlType::Configurable));
        assert_eq!(types[4], Some(ControlType::PositionPosition));
        assert_eq!((types[7], types[8]), (Some(ControlType::Configurable), None));
        let modes: Vec<_> = (0..6).filter_map(ControllerMode::from_number).collect();
        let [torque, velocity, current] =
            [ControllerMode::Torque, ControllerMode::Velocity, ControllerMode::Current];
        assert_eq!(modes, [torque, velocity, ControllerMode::default(), current]);
        for mode in [torque, velocity, current] {
            assert_eq!(mode.check().unwrap_err().number(), Some(70));
        }
        assert_eq!(ControllerMode::Position.check(), Ok(()));
        let taken = ControlType::ALL.into_iter().filter(|control| control.check().is_ok());
        assert_eq!(taken.collect::<Vec<_>>(), [ControlType::PositionPosition]);
    }
}
