//! Switch points of a path (H words, manual 3.2.1) and the outputs that follow them.
//!
//! A switching has the time of the first set-point that shows it (`dwSwitches`).

use twin_path::Place;

/// Number of switches (manual 6.2.9): 1 to 32.
pub const SWITCHES: u8 = 32;

/// More switchings than these are counted, not kept.
const MOST_POINTS: usize = 10_000;

/// `[[switch_outputs]]` of a machine file: an output that is on while a switch of the path is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SwitchOutput {
    /// Number of the switch, 1 to 32.
    pub number: u8,
    /// The device, an index into [`crate::Machine::drives`].
    pub device: usize,
    /// The output, from 1, as [`twin_drives::Drive::set_output`] counts them.
    pub output: u8,
}

/// A switch that changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SwitchPoint {
    /// Number of the switch, 1 to 32.
    pub number: u8,
    /// On or off.
    pub on: bool,
    /// Set-point at which it is seen, ns.
    pub time_ns: i64,
    /// Block of that set-point.
    pub place: Place,
}

/// Everything that the path switches along a program.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SwitchPoints {
    first: Vec<SwitchPoint>,
    count: u64,
    last: u32,
}

impl SwitchPoints {
    /// The first 10,000 switchings, in the order of time.
    pub fn first(&self) -> &[SwitchPoint] {
        &self.first
    }

    /// Number of switchings that were not kept.
    pub fn left_out(&self) -> u64 {
        self.count.saturating_sub(u64::try_from(self.first.len()).unwrap_or(u64::MAX))
    }

    /// Observes the switches at a set-point.
    pub fn observe(&mut self, switches: u32, (time_ns, place): (i64, Place)) {
        let before = std::mem::replace(&mut self.last, switches);
        for (number, on) in changed(before, switches) {
            self.count += 1;
            if self.first.len() < MOST_POINTS {
                self.first.push(SwitchPoint { number, on, time_ns, place });
            }
        }
    }
}

/// The switches that are not as before, each with what it is now; bit n − 1 is switch n.
pub fn changed(before: u32, now: u32) -> impl Iterator<Item = (u8, bool)> {
    let changed = before ^ now;
    // Nothing changes in nearly every cycle.
    let most = if changed == 0 { 0 } else { SWITCHES };
    (1..=most)
        .filter(move |number| changed >> (number - 1) & 1 == 1)
        .map(move |number| (number, now >> (number - 1) & 1 == 1))
}

/// Whether the path changes a switch of this number: that of `points`.
pub fn has(points: &SwitchPoints, number: u8) -> bool {
    points.first.iter().any(|point| point.number == number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_change_is_kept_in_order() {
        let mut points = SwitchPoints::default();
        let place = |line| Place::at(line);
        for (time_ns, switches) in [(0, 0), (1, 0b10), (2, 0b10), (3, 1 << 31), (4, 1 << 31)] {
            points.observe(switches, (time_ns, place(1)));
        }
        let found: Vec<_> =
            points.first().iter().map(|one| (one.number, one.on, one.time_ns)).collect();
        assert_eq!(found, [(2, true, 1), (2, false, 3), (32, true, 3)]);
        assert_eq!(points.left_out(), 0);
        assert!(has(&points, 32) && !has(&points, 1));
    }
}
