//! Tracking errors of twin and drives: maximum and root mean square, against the set-points and against each other.

use nalgebra::Point3;
use twin_kinematics::{AxisVector, Kinematics};
use twin_machine::Machine;
use twin_path::Place;

/// Running maximum and root mean square of one error. SI.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    maximum: Option<(f64, Place)>,
    sum_of_squares: f64,
    count: u64,
}

impl Statistics {
    /// Takes one error into account.
    pub fn include(&mut self, error: f64, place: Place) {
        let error = error.abs();
        if self.maximum.is_none_or(|(maximum, _)| error > maximum) {
            self.maximum = Some((error, place));
        }
        self.sum_of_squares += error * error;
        self.count += 1;
    }

    /// The largest error and the block in which it was made; `None` before the first.
    pub fn maximum(&self) -> Option<(f64, Place)> {
        self.maximum
    }

    /// Root mean square; 0 before the first error.
    #[expect(clippy::cast_precision_loss, reason = "counts of samples stay far below 2^53")]
    pub fn rms(&self) -> f64 {
        if self.count == 0 { 0.0 } else { (self.sum_of_squares / self.count as f64).sqrt() }
    }
}

/// The three comparisons of one quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorStatistics {
    /// Simulated machine against set-point.
    pub twin: Statistics,
    /// Drives against set-point.
    pub drives: Statistics,
    /// Drives against simulated machine.
    pub drives_against_twin: Statistics,
}

/// Measured axis positions and the tool position that follows from them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Axis positions, m or rad.
    pub axes: AxisVector,
    /// Tool tip in the machine frame, m.
    pub tool: Point3<f64>,
}

impl Measured {
    /// By forward kinematics; `None` if the axes give no pose.
    pub fn new(machine: &Machine, axes: AxisVector) -> Option<Self> {
        let pose = machine.kinematics.forward(&axes).ok()?;
        Some(Self { axes, tool: pose.position })
    }
}

/// Gathers the errors of a run.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Of the tool tip, m.
    pub tool: ErrorStatistics,
    /// Of each axis, m or rad, machine-file order.
    pub axes: Vec<ErrorStatistics>,
}

impl Comparison {
    /// For a machine with this many axes.
    pub fn new(axes: usize) -> Self {
        Self { tool: ErrorStatistics::default(), axes: vec![ErrorStatistics::default(); axes] }
    }

    /// One instant of the simulated machine.
    pub fn twin(&mut self, setpoint: &Measured, twin: &Measured, place: Place) {
        self.include(setpoint, twin, place, |statistics| &mut statistics.twin);
    }

    /// One sample of the drives, with set-point and simulated machine at the same instant.
    pub fn drives(
        &mut self,
        setpoint: &Measured,
        twin: &Measured,
        drives: &Measured,
        place: Place,
    ) {
        self.include(setpoint, drives, place, |statistics| &mut statistics.drives);
        self.include(twin, drives, place, |statistics| &mut statistics.drives_against_twin);
    }

    fn include(
        &mut self,
        reference: &Measured,
        actual: &Measured,
        place: Place,
        which: impl Fn(&mut ErrorStatistics) -> &mut Statistics,
    ) {
        which(&mut self.tool).include((actual.tool - reference.tool).norm(), place);
        let pairs = reference.axes.iter().zip(actual.axes.iter());
        for (statistics, (reference, actual)) in self.axes.iter_mut().zip(pairs) {
            which(statistics).include(actual - reference, place);
        }
    }
}
