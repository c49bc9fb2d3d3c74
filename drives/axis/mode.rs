//! What is exchanged with a drive (2.1.3).
//!
//! All three families take positions and tell positions, and close what loop they have themselves: there is nothing that a run
//! could choose, and a master that asks for another type is refused here. That is all this type is for; `twin` has no key for what
//! can only be one value. Controller modes (2.2.4) are those of `twin-motion`'s axis.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_manual() {
        let types: Vec<_> = (0..9).map(ControlType::from_number).collect();
        assert_eq!(types[0], Some(ControlType::Configurable));
        assert_eq!(types[4], Some(ControlType::PositionPosition));
        assert_eq!((types[7], types[8]), (Some(ControlType::Configurable), None));
        let taken = ControlType::ALL.into_iter().filter(|control| control.check().is_ok());
        assert_eq!(taken.collect::<Vec<_>>(), [ControlType::PositionPosition]);
    }
}
