//! Touch probe: the tool of the simulated machine during a probing move.

#[cfg(test)]
mod tests;

use crate::plant::{ProbeMiss, ProbeTouch};
use crate::setpoint::AxisSetpoint;
use twin_kinematics::AxisVector;
use twin_path::Place;
use twin_physics::{ClearanceScan, Part, PhysicsError, YieldingTool};

/// Nearer than this a probe touches, m: what it takes to switch. The path ends where nothing is left between.
const TOUCH: f64 = 1e-6;

/// How far a probe may go into what it has touched before it counts as a tool again, m.
const OVERTRAVEL: f64 = 1e-3;

/// The tool as a probe.
#[derive(Clone, Debug)]
pub(crate) struct TouchProbe {
    scan: ClearanceScan,
    /// Nearer than this it touches, m.
    reach: f64,
    /// What it has touched and not come free of.
    touching: Option<[Part; 2]>,
    search: Option<Search>,
}

/// A probing move under way.
#[derive(Clone, Copy, Debug)]
struct Search {
    place: Place,
    /// Where the plan was in its last cycle, and whether it touches there.
    end: AxisVector,
    end_touches: bool,
    /// The move began in touch: it is one that comes free.
    comes_free: bool,
    found: bool,
    /// The nearest that the tool came, m.
    nearest: f64,
}

/// Result of a cycle.
#[derive(Debug)]
pub(crate) struct Felt {
    /// Parts without contact force against the tool from now on.
    pub(crate) yielding: YieldingTool,
    pub(crate) touch: Option<ProbeTouch>,
    pub(crate) missed: Option<ProbeMiss>,
}

impl TouchProbe {
    /// A probe that `scan` measures, on axes that come within `resolution` (m) of where they are sent.
    pub(crate) fn new(scan: ClearanceScan, resolution: f64) -> Self {
        Self { scan, reach: TOUCH + resolution, touching: None, search: None }
    }

    /// Another tool, which `scan` measures, touches nothing yet.
    pub(crate) fn change_tool(&mut self, scan: ClearanceScan) {
        (self.scan, self.touching) = (scan, None);
    }

    /// Probe state at the present axis positions. After its move the probe yields only to the part that it touched, and
    /// is stiff when it has come free of that, or has gone too far into it. Drives that follow `late` come to the end
    /// of the move while the plan waits there.
    pub(crate) fn feel(
        &mut self,
        setpoint: &AxisSetpoint,
        position: &AxisVector,
        late: bool,
    ) -> Result<Felt, PhysicsError> {
        let waits = self.search.is_some_and(|search| late && search.end == setpoint.axes.position);
        if setpoint.probing || waits {
            // Another probing move may follow at once.
            let goes_on = |search: &Search| search.place == setpoint.place || waits;
            let ended = self.search.take_if(|search| !goes_on(search));
            let missed = ended.and_then(|search| search.missed());
            let touch = self.search(setpoint, position)?;
            return Ok(Felt { yielding: YieldingTool::Always, touch, missed });
        }
        let missed = self.search.take().and_then(|search| search.missed());
        let Some([one, other]) = self.touching else {
            return Ok(Felt { yielding: YieldingTool::Never, touch: None, missed });
        };
        let distance = self.scan.between([one, other], position)?;
        let touches =
            distance.is_some_and(|distance| (-OVERTRAVEL..=self.reach).contains(&distance));
        let part = if one == Part::Tool { other } else { one };
        self.touching = touches.then_some([one, other]);
        let yielding = if touches { YieldingTool::To(part) } else { YieldingTool::Never };
        Ok(Felt { yielding, touch: None, missed })
    }

    /// A cycle of a probing move.
    fn search(
        &mut self,
        setpoint: &AxisSetpoint,
        position: &AxisVector,
    ) -> Result<Option<ProbeTouch>, PhysicsError> {
        let nearest = self.scan.nearest(position)?;
        let distance = nearest.map_or(f64::INFINITY, |nearest| nearest.distance);
        let touching = nearest.filter(|nearest| nearest.distance <= self.reach);
        let touching = touching.map(|nearest| nearest.parts);
        let planned = self.scan.nearest(&setpoint.axes.position)?;
        let end_touches = planned.is_some_and(|nearest| nearest.distance <= self.reach);
        // Where a move begins that is to come free there is nothing new.
        let begins = self.search.is_none();
        let mut search = self.search.unwrap_or(Search {
            place: setpoint.place,
            end: setpoint.axes.position,
            end_touches,
            comes_free: touching.is_some(),
            found: false,
            nearest: f64::INFINITY,
        });
        let touched = touching.is_some() && self.touching.is_none() && !begins && !search.found;
        search.found |= touched;
        search.nearest = search.nearest.min(distance);
        (search.end, search.end_touches) = (setpoint.axes.position, end_touches);
        self.search = Some(search);
        self.touching = touching;
        let place = search.place;
        Ok(touched.then_some(ProbeTouch { place, position: *position }))
    }

    /// The move under way, if it has not touched what the plan ends at.
    pub(crate) fn missed(&self) -> Option<ProbeMiss> {
        self.search?.missed()
    }
}

impl Search {
    /// If it has not touched what the plan ends at.
    fn missed(&self) -> Option<ProbeMiss> {
        let misses = self.end_touches && !self.comes_free && !self.found;
        misses.then_some(ProbeMiss { place: self.place, nearest: self.nearest })
    }
}
