//! Path that follows the measured positions of a workpiece (`SMC_XInterpolator`, manual 6.6).

use super::inputs::Workpiece;
use super::source::Halt;
use super::stream::Prepared;
use crate::finding::{Finding, Rule, Severity};
use std::iter::Map;
use std::num::NonZeroU32;
use std::sync::Arc;
use std::task::Poll;
use twin_path::prepare::CheckedElement;
use twin_path::{PathElement, Place};
use twin_planner::controller::{ToolSetpoint, XInterpolator};

type Strip = fn(Result<CheckedElement, Halt>) -> Result<PathElement, Halt>;

/// A path that ends while its workpiece moves on.
fn goes_on(velocity: f64, place: Place) -> Finding {
    let message = format!(
        "the set-points end while the workpiece still moves the path on with {:.3} mm/s: the axes stop within a cycle; let the \
         positions come to rest where the path ends",
        velocity.abs() * 1e3
    );
    let finding = Finding::error(Rule::AxisAcceleration, place, message);
    Finding { severity: Severity::Warning, ..finding }
}

/// The path of a program along the positions of a workpiece.
#[derive(Debug)]
pub(super) struct ByPosition {
    interpolator: XInterpolator<Map<Prepared, Strip>>,
    positions: Arc<[f64]>,
    next: usize,
    /// Cycle, s.
    cycle: f64,
    /// Position and velocity of the workpiece at the last set-point, m and m/s.
    latest: Option<[f64; 2]>,
    stopping: bool,
    /// Velocity along the path at the last set-point, m/s, and its block.
    along: Option<(f64, Place)>,
}

impl ByPosition {
    pub(super) fn new(path: Prepared, workpiece: &Workpiece, cycle: NonZeroU32) -> Self {
        let Workpiece { positions, offset, direction } = workpiece;
        let strip: Strip = |next| next.map(CheckedElement::into_element);
        Self {
            interpolator: XInterpolator::new(path.map(strip), cycle, *direction, *offset),
            positions: Arc::clone(positions),
            next: 0,
            cycle: f64::from(cycle.get()) * 1e-9,
            latest: None,
            stopping: false,
            along: None,
        }
    }

    /// The next set-point; none behind the end of the path or of the positions.
    pub(super) fn next(&mut self) -> Option<Result<ToolSetpoint, Halt>> {
        let (x, rests) = if self.stopping { self.braked()? } else { (self.measured()?, false) };
        let velocity = self.latest.map_or(0.0, |[before, _]| (x - before) / self.cycle);
        self.latest = Some([x, velocity]);
        let Poll::Ready(Some(next)) = self.interpolator.poll_cycle(x, rests) else { return None };
        if let Ok(tool) = &next {
            self.along = Some((tool.path_velocity, tool.place));
        }
        Some(next)
    }

    /// Error if the set-points end here before the motion has come to rest.
    pub(super) fn ending(&self) -> Option<Finding> {
        let (velocity, place) = self.along?;
        // What a cycle takes away is rest.
        let rest = self.interpolator.deceleration()? * self.cycle;
        (velocity.abs() > rest).then(|| goes_on(velocity, place))
    }

    fn measured(&mut self) -> Option<f64> {
        let x = self.positions.get(self.next).copied();
        self.next += 1;
        x
    }

    /// The position a cycle later while the workpiece brakes with the deceleration of the element under way, and whether it
    /// rests then.
    fn braked(&self) -> Option<(f64, bool)> {
        let [x, velocity] = self.latest?;
        let step = self.interpolator.deceleration()? * self.cycle;
        let left = velocity.signum() * (velocity.abs() - step).max(0.0);
        Some((x + left * self.cycle, left == 0.0))
    }

    /// From now on the workpiece brakes, and the path ends where it rests.
    pub(super) fn request_stop(&mut self) {
        self.stopping = true;
    }
}
