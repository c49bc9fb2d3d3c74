//! `SMC_GetTrackingError` (2.2.8).

use std::collections::VecDeque;

use super::Maximum;

/// Distance of an axis from where it was told to be some cycles ago, as the wire delays what it says.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackingError {
    /// `byDeadTimeCycles`.
    dead_time_cycles: u8,
    /// Set positions, the oldest first; one more than the dead time at most.
    set: VecDeque<f64>,
    current: Option<f64>,
    most: Maximum,
}

impl TrackingError {
    /// Of an axis whose actual position is that of so many cycles ago.
    pub fn new(dead_time_cycles: u8) -> Self {
        let set = VecDeque::with_capacity(usize::from(dead_time_cycles) + 1);
        Self { dead_time_cycles, set, current: None, most: Maximum::default() }
    }

    /// One cycle: `period` is that of a rotary axis, over whose end the shorter way counts. The largest error is forgotten
    /// while `reset` is true, and remembered with the stamp that came with it. A cycle without `enable` changes nothing and
    /// begins the dead time anew.
    pub fn update(
        &mut self,
        enable: bool,
        reset: bool,
        (set, actual): (f64, f64),
        period: Option<f64>,
        time_stamp: u32,
    ) {
        if !enable {
            self.set.clear();
            self.current = None;
            return;
        }
        self.set.push_back(set);
        if self.set.len() > usize::from(self.dead_time_cycles) + 1 {
            self.set.pop_front();
        }
        let full = self.set.len() == usize::from(self.dead_time_cycles) + 1;
        self.current = self.set.front().filter(|_| full).map(|set| {
            let away = set - actual;
            match period {
                Some(period) if period > 0.0 => away - period * (away / period).round(),
                _ => away,
            }
        });
        self.most.update(reset, self.current.unwrap_or(0.0), time_stamp);
    }

    /// The error now: set − actual, technical units; `None` until the dead time has passed once.
    pub fn current(&self) -> Option<f64> {
        self.current
    }

    /// The largest error so far, without sign, and its stamp.
    pub fn most(&self) -> Maximum {
        self.most
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An axis that follows a ramp of 2 u a cycle, and says where it was three cycles ago.
    #[test]
    fn a_dead_time_is_no_error() {
        let mut tracking = TrackingError::new(3);
        let mut seen = Vec::new();
        for cycle in 0..20_u32 {
            let set = 2.0 * f64::from(cycle);
            let late = 2.0 * (f64::from(cycle) - 3.0);
            // In cycle 10 it lags by 0.75.
            let actual = if cycle == 10 { late - 0.75 } else { late };
            tracking.update(true, false, (set, actual), None, 100 + cycle);
            seen.push(tracking.current());
        }
        assert_eq!(seen[..3], [None; 3]);
        assert_eq!((seen[3], seen[10], seen[19]), (Some(0.0), Some(0.75), Some(0.0)));
        assert_eq!(tracking.most(), Maximum { value: 0.75, time: 110 });
        tracking.update(true, true, (40.0, 34.0), None, 121);
        assert_eq!(tracking.most(), Maximum::default());
        tracking.update(false, false, (40.0, 0.0), None, 122);
        assert_eq!((tracking.current(), tracking.most()), (None, Maximum::default()));
    }

    #[test]
    fn rotary_axes_go_the_shorter_way() {
        let mut tracking = TrackingError::new(0);
        tracking.update(true, false, (1.0, 359.0), Some(360.0), 7);
        assert_eq!(tracking.current(), Some(2.0));
        tracking.update(true, false, (359.0, 2.0), Some(360.0), 8);
        assert_eq!(tracking.current(), Some(-3.0));
        assert_eq!(tracking.most(), Maximum { value: 3.0, time: 8 });
    }
}
