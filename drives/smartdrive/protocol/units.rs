//! µsteps and turns.

/// µsteps of one turn: full steps × divisor (parameters 43 and 44).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepsPerTurn(u32);

impl StepsPerTurn {
    /// One µstep a turn.
    pub(crate) const ONE: Self = Self(1);

    /// `full_steps` (1 to 32767) times `divisor` (a power of two up to 1024); `None` if they are anything else.
    pub fn new(full_steps: u16, divisor: u16) -> Option<Self> {
        let possible =
            (1..=32_767).contains(&full_steps) && divisor.is_power_of_two() && divisor <= 1024;
        possible.then(|| Self(u32::from(full_steps) * u32::from(divisor)))
    }

    /// µsteps.
    pub fn get(self) -> u32 {
        self.0
    }

    /// Turns per minute as µsteps/s, or turns per minute and second as µsteps/s².
    pub fn steps(self, rpm: f64) -> f64 {
        rpm * f64::from(self.0) / 60.0
    }

    /// µsteps/s as turns per minute, or µsteps/s² as turns per minute and second.
    pub fn rpm(self, steps_per_s: f64) -> f64 {
        steps_per_s * 60.0 / f64::from(self.0)
    }

    /// µsteps as degrees.
    pub fn degrees(self, steps: f64) -> f64 {
        steps * 360.0 / f64::from(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The digest's example (§3): 200 full steps of 16 µsteps.
    #[test]
    fn units_are_those_of_the_example() {
        let turn = StepsPerTurn::new(200, 16).unwrap();
        assert_eq!(turn.get(), 3200);
        assert!((turn.steps(1.0) - 53.333_333_333).abs() < 1e-9);
        assert!((turn.degrees(1.0) - 0.1125).abs() < 1e-12);
        assert!((turn.rpm(turn.steps(300.0)) - 300.0).abs() < 1e-9);
    }

    #[test]
    fn steps_that_no_motor_has_are_refused() {
        for (full_steps, divisor) in [(0, 1), (32_768, 1), (200, 0), (200, 3), (200, 2048)] {
            assert_eq!(StepsPerTurn::new(full_steps, divisor), None, "{full_steps}, {divisor}");
        }
        assert!(StepsPerTurn::new(32_767, 1024).is_some());
    }
}
