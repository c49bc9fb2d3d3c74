//! History of set-points and twin positions, for comparison with late samples of the drives.

use crate::compare::Measured;
use crate::plant::AxisFeedback;
use crate::setpoint::AxisSetpoint;
use std::collections::VecDeque;
use twin_kinematics::AxisVector;
use twin_machine::Machine;
use twin_path::Place;

/// How long set-points and twin are remembered for samples of the drives that come late, in cycles.
const HISTORY: usize = 4000;

/// Set-points and simulated machine of the last seconds, to compare late samples with.
#[derive(Debug)]
pub(super) struct History {
    cycle_ns: i64,
    first_ns: i64,
    entries: VecDeque<Entry>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    place: Place,
    wanted: AxisVector,
    twin: AxisVector,
}

impl History {
    pub(super) fn new(machine: &Machine) -> Self {
        Self { cycle_ns: machine.cycle_ns, first_ns: 0, entries: VecDeque::with_capacity(HISTORY) }
    }

    pub(super) fn push(
        &mut self,
        machine: &Machine,
        setpoint: &AxisSetpoint,
        feedback: &AxisFeedback,
    ) -> Option<(Measured, Measured)> {
        if self.entries.len() == HISTORY {
            self.entries.pop_front();
            self.first_ns += self.cycle_ns;
        }
        let (wanted, twin) = (setpoint.axes.position, feedback.position);
        self.entries.push_back(Entry { place: setpoint.place, wanted, twin });
        let tool = setpoint.tool.pose.position;
        Some((Measured { axes: wanted, tool }, Measured::new(machine, twin)?))
    }

    /// The block at `time_ns`; nothing if that is no longer known.
    pub(super) fn place(&self, time_ns: i64) -> Option<Place> {
        let index = usize::try_from((time_ns - self.first_ns).checked_div(self.cycle_ns)?).ok()?;
        self.entries.get(index).or(self.entries.back()).map(|entry| entry.place)
    }

    /// Set-point and twin at `time_ns`, interpolated; at the ends they rest. `None` if that is no longer known.
    #[expect(clippy::cast_precision_loss, reason = "a fraction of a cycle")]
    pub(super) fn at(
        &self,
        machine: &Machine,
        time_ns: i64,
    ) -> Option<(Place, Measured, Measured)> {
        let since = time_ns - self.first_ns;
        if since < 0 {
            return None;
        }
        let index = usize::try_from(since / self.cycle_ns).ok()?;
        let last = self.entries.back()?;
        let from = self.entries.get(index).unwrap_or(last);
        let to = self.entries.get(index + 1).unwrap_or(last);
        let fraction = (since % self.cycle_ns) as f64 / self.cycle_ns as f64;
        let between = |from: &AxisVector, to: &AxisVector| {
            let values = from.iter().zip(to.iter()).map(|(from, to)| from + (to - from) * fraction);
            Measured::new(machine, AxisVector::from_values(values))
        };
        Some((from.place, between(&from.wanted, &to.wanted)?, between(&from.twin, &to.twin)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setpoint::Transformer;
    use nalgebra::{Point3, Vector3};
    use std::path::Path;
    use twin_planner::controller::ToolSetpoint;

    const GANTRY3: &str = include_str!("../../tests/data/machines/gantry3.toml");

    /// `cycles` cycles in which X goes 1 mm each, the simulated machine 0.1 mm behind; one line per cycle.
    fn history(machine: &Machine, cycles: u32) -> History {
        let mut history = History::new(machine);
        for cycle in 0..cycles {
            let time_ns = i64::from(cycle) * machine.cycle_ns;
            let tool = ToolSetpoint {
                time_ns,
                place: Place::at(cycle),
                rapid: false,
                feed: 0.1,
                position: Point3::new(1e-3 * f64::from(cycle), 0.0, 0.0),
                velocity: Vector3::zeros(),
                acceleration: Vector3::zeros(),
                path_velocity: 0.0,
                ..ToolSetpoint::default()
            };
            let setpoint = Transformer::new(machine).axes(&tool, None).unwrap();
            let mut position = setpoint.axes.position;
            position[0] -= 1e-4;
            history.push(machine, &setpoint, &AxisFeedback { time_ns, position }).unwrap();
        }
        history
    }

    #[test]
    fn between_cycles_it_is_between_and_at_the_end_it_rests() {
        let machine = Machine::parse(Path::new("machine.toml"), GANTRY3).unwrap();
        let history = history(&machine, 4);
        let at = |time_ns| {
            let (place, wanted, twin) = history.at(&machine, time_ns)?;
            assert!((wanted.tool.x - twin.tool.x - 1e-4).abs() < 1e-15);
            Some((place.line, (wanted.axes[0] * 1e9).round()))
        };
        assert_eq!(at(-1), None);
        assert_eq!(at(0), Some((0, 0.0)));
        assert_eq!(at(1_250_000), Some((1, 1_250_000.0)));
        assert_eq!(at(2_999_999), Some((2, 2_999_999.0)));
        assert_eq!(at(3_000_000), Some((3, 3_000_000.0)));
        assert_eq!(at(9_000_000_000), Some((3, 3_000_000.0)));
        assert!(History::new(&machine).at(&machine, 0).is_none());
        let line = |time_ns| history.place(time_ns).map(|place| place.line);
        assert_eq!(
            [-1_000_000, 0, 1_250_000, 9_000_000_000].map(line),
            [None, Some(0), Some(1), Some(3)]
        );
    }

    #[test]
    fn only_the_last_seconds_are_remembered() {
        let machine = Machine::parse(Path::new("machine.toml"), GANTRY3).unwrap();
        let cycles = u32::try_from(HISTORY).unwrap() + 500;
        let history = history(&machine, cycles);
        assert_eq!(history.entries.len(), HISTORY);
        assert!(history.at(&machine, 499_000_000).is_none());
        let (place, wanted, _) = history.at(&machine, 500_500_000).unwrap();
        assert_eq!(place.line, 500);
        assert!((wanted.axes[0] - 0.5005).abs() < 1e-12);
    }
}
