//! Configuration of an axis: ratio, sense, movement type and period (2.1.3), and its change (`SMC_ChangeGearingRatio`).
//!
//! For masters that keep an axis as SoftMotion does, and for [`super::Encoder`]. `twin` reads its ratios from machine files, where
//! they are whatever a builder reads off gear and belt (10^12 increments, 9.525 mm) and need not fit the 32 bits of a
//! [`Ratio`]; it never changes one while it runs.

use super::{AxisError, Modulo, Place, Ratio};

/// `nDirection` of an axis: whether its units count as the increments do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// 1.
    #[default]
    Positive,
    /// −1.
    Negative,
}

impl Direction {
    /// 1 or −1.
    pub fn sign(self) -> i8 {
        match self {
            Self::Positive => 1,
            Self::Negative => -1,
        }
    }
}

/// `iMovementType`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Movement {
    /// 0: positions repeat after `fPositionPeriod` technical units.
    Rotary {
        /// The period.
        period: f64,
    },
    /// 1.
    Linear,
}

/// How an axis' increments become technical units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gearing {
    /// With the sense in it.
    ratio: Ratio,
    direction: Direction,
    modulo: Option<Modulo>,
}

impl Gearing {
    /// Of this ratio (technical units for increments), sense and movement.
    ///
    /// # Errors
    /// [`AxisError::Gearing`] (90) if a value is 0 or the period impossible ([`Modulo::new`]).
    pub fn new(
        units: i32,
        increments: u32,
        direction: Direction,
        movement: Movement,
    ) -> Result<Self, AxisError> {
        let turned = match direction {
            Direction::Positive => Some(units),
            Direction::Negative => units.checked_neg(),
        };
        let wrong = || AxisError::Gearing { what: "iRatioTechUnitsNum", value: units.into() };
        let ratio = Ratio::new(turned.ok_or_else(wrong)?, increments)?;
        let modulo = match movement {
            Movement::Linear => None,
            Movement::Rotary { period } => Some(Modulo::new(ratio, period)?),
        };
        Ok(Self { ratio, direction, modulo })
    }

    /// The ratio, with the sense in it.
    pub fn ratio(&self) -> Ratio {
        self.ratio
    }

    /// The sense.
    pub fn direction(&self) -> Direction {
        self.direction
    }

    /// Movement type and period.
    pub fn movement(&self) -> Movement {
        match &self.modulo {
            Some(modulo) => Movement::Rotary { period: modulo.period() },
            None => Movement::Linear,
        }
    }

    /// The period of a rotary axis.
    pub fn modulo(&self) -> Option<&Modulo> {
        self.modulo.as_ref()
    }

    /// Where the axis is, technical units: in [0, period[ and its turns if it is rotary.
    pub fn place(&self, increments: i64) -> Place {
        match &self.modulo {
            Some(modulo) => modulo.place(increments),
            None => Place { turns: 0, position: self.ratio.units(increments) },
        }
    }

    /// `SMC_ChangeGearingRatio`: another ratio, movement and period. The axis group must be reset after it, keeping the
    /// ratio ([`super::AxisGroup::reset`]); what has been reckoned with the old one is void.
    ///
    /// # Errors
    /// [`AxisError::Powered`] (91) if the drive is powered; as [`Self::new`]. The old gearing stays then.
    #[doc(alias = "SMC_ChangeGearingRatio")]
    pub fn change(
        &mut self,
        powered: bool,
        units: i32,
        increments: u32,
        movement: Movement,
    ) -> Result<(), AxisError> {
        if powered {
            return Err(AxisError::Powered);
        }
        *self = Self::new(units, increments, self.direction, movement)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_linear_or_rotary_and_turn_either_way() {
        let linear = Gearing::new(5, 2000, Direction::Negative, Movement::Linear).unwrap();
        assert!((linear.place(4000).position + 10.0).abs() < 1e-12);
        assert_eq!((linear.direction().sign(), linear.movement()), (-1, Movement::Linear));
        let rotary = Movement::Rotary { period: 360.0 };
        let table = Gearing::new(360, 3600, Direction::Positive, rotary).unwrap();
        let place = table.place(-10);
        assert_eq!((place.turns, table.movement()), (-1, rotary));
        assert!((place.position - 359.0).abs() < 1e-12);
        assert_eq!(table.direction().sign(), 1);
        let least = Gearing::new(i32::MIN, 1, Direction::Negative, Movement::Linear);
        assert_eq!(least.unwrap_err().number(), Some(90));
    }

    #[test]
    fn a_gearing_changes_without_power_only() {
        let mut gearing = Gearing::new(1, 100, Direction::Positive, Movement::Linear).unwrap();
        let before = gearing;
        let rotary = Movement::Rotary { period: 10.0 };
        assert_eq!(gearing.change(true, 1, 200, rotary).unwrap_err().number(), Some(91));
        assert_eq!(gearing.change(false, 0, 200, rotary).unwrap_err().number(), Some(90));
        assert_eq!(gearing, before);
        gearing.change(false, 1, 200, rotary).unwrap();
        assert!((gearing.place(2100).position - 0.5).abs() < 1e-12);
        assert_eq!(gearing.ratio().denominator(), 200);
    }
}
