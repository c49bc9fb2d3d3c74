//! What set-points and simulated machine were a short while ago.

use crate::compare::Measured;
use crate::machine::Machine;
use crate::plant::AxisFeedback;
use crate::setpoint::AxisSetpoint;
use std::collections::VecDeque;
use twin_kinematics::AxisVector;
use twin_motion::Place;

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
