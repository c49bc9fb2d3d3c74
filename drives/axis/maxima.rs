//! `SMC_GetMaxSetVelocity` and `SMC_GetMaxSetAccDec` (2.2.8).

use super::SetValues;

/// A largest value, without sign, and the stamp (`dwTimeStamp`) that came with it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Maximum {
    /// The value.
    pub value: f64,
    /// `dwTimeAtMax`.
    pub time: u32,
}

impl Maximum {
    /// Takes a value into account; while `reset` (`bResetMax`) is true, it is 0.
    pub fn update(&mut self, reset: bool, value: f64, time_stamp: u32) {
        if reset {
            *self = Self::default();
        } else if value.abs() > self.value {
            *self = Self { value: value.abs(), time: time_stamp };
        }
    }
}

/// `SMC_GetMaxSetVelocity`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MaxSetVelocity(Maximum);

impl MaxSetVelocity {
    /// One cycle with these set values; without `enable` it is not measured.
    pub fn update(
        &mut self,
        enable: bool,
        reset: bool,
        set: &SetValues,
        time_stamp: u32,
    ) -> Maximum {
        if enable {
            self.0.update(reset, set.velocity, time_stamp);
        }
        self.0
    }
}

/// `SMC_GetMaxSetAccDec`: of accelerations and decelerations the larger one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MaxSetAccDec(Maximum);

impl MaxSetAccDec {
    /// One cycle with these set values; without `enable` it is not measured.
    pub fn update(
        &mut self,
        enable: bool,
        reset: bool,
        set: &SetValues,
        time_stamp: u32,
    ) -> Maximum {
        if enable {
            self.0.update(reset, set.acceleration, time_stamp);
        }
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn largest_values_are_kept_with_their_stamps() {
        let (mut velocity, mut change) = (MaxSetVelocity::default(), MaxSetAccDec::default());
        let cycles = [(3.0, 10.0), (-5.0, -20.0), (5.0, 15.0), (4.0, 0.0)];
        for (stamp, (v, a)) in (1..).zip(cycles) {
            let set = SetValues { velocity: v, acceleration: a };
            velocity.update(true, false, &set, stamp);
            change.update(true, false, &set, stamp);
        }
        let faster = SetValues { velocity: 9.0, acceleration: 90.0 };
        assert_eq!(velocity.update(false, true, &faster, 5), Maximum { value: 5.0, time: 2 });
        assert_eq!(change.update(false, false, &faster, 5), Maximum { value: 20.0, time: 2 });
        assert_eq!(velocity.update(true, true, &faster, 6), Maximum::default());
        assert_eq!(velocity.update(true, false, &faster, 7), Maximum { value: 9.0, time: 7 });
    }
}
