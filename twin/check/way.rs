//! What is in the way of the machine.

use super::findings::{About, Findings};
use super::sentence;
use crate::machine::{Machine, SimulationError};
use crate::physics::{Clearance, ClearanceScan, Part};
use crate::setpoint::AxisSetpoint;
use twin_motion::Place;

/// Blocks that are kept: a picture of more shows no more.
const MOST_BLOCKS: usize = 100_000;

/// How deep parts may be in each other without that being told, m: what stands on something touches it.
const TOUCHING: f64 = 1e-6;

/// What came nearest to what in one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockClearance {
    /// The block.
    pub place: Place,
    /// When, ns since the start of the program.
    pub time_ns: i64,
    /// What, and how near.
    pub nearest: Clearance,
}

/// How near everything came.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clearances {
    /// The least, block by block, in the order in which they were run through; the first hundred thousand.
    pub blocks: Vec<BlockClearance>,
    /// The least of all.
    pub least: Option<BlockClearance>,
}

/// Looks at every set-point.
#[derive(Debug)]
pub(super) struct Way {
    scan: ClearanceScan,
    /// Nearer than this is told, m.
    wanted: f64,
    /// What a probe has touched and not come away from.
    touched: Option<[Part; 2]>,
    /// Workspace: what is nearer than is wanted.
    near: Vec<Clearance>,
    found: Clearances,
}

impl Way {
    /// `None` if nothing is looked for.
    pub(super) fn new(machine: &Machine) -> Result<Option<Self>, SimulationError> {
        let scan = machine.clearance_scan();
        let scan = scan.map_err(|error| SimulationError::of(machine, error))?;
        let wanted = machine.collision.as_ref().map_or(0.0, |collision| collision.clearance);
        Ok(scan.map(|scan| Self {
            scan,
            wanted,
            touched: None,
            near: Vec::new(),
            found: Clearances::default(),
        }))
    }

    pub(super) fn look(
        &mut self,
        machine: &Machine,
        setpoint: &AxisSetpoint,
        findings: &mut Findings,
    ) {
        // Where no links can be there is another finding.
        let Ok(Some(nearest)) = self.scan.nearest(&setpoint.axes.position) else { return };
        let AxisSetpoint { place, time_ns, .. } = *setpoint;
        let now = BlockClearance { place, time_ns, nearest };
        let is_nearer = |than: &BlockClearance| nearest.distance < than.nearest.distance;
        if self.found.least.as_ref().is_none_or(is_nearer) {
            self.found.least = Some(now);
        }
        let room = self.found.blocks.len() < MOST_BLOCKS;
        let block = self.found.blocks.last_mut().filter(|block| block.place == place);
        match block {
            Some(block) if is_nearer(block) => *block = now,
            Some(_) => {}
            None => self.found.blocks.extend(room.then_some(now)),
        }
        if self
            .scan
            .nearer_than(self.wanted.max(0.0), &setpoint.axes.position, &mut self.near)
            .is_err()
        {
            return;
        }
        // What a probe has touched it may be near to until it has come away from it.
        if setpoint.probing {
            let is_touched =
                |one: &&Clearance| one.parts.contains(&Part::Tool) && one.distance <= TOUCHING;
            self.touched = self.near.iter().find(is_touched).map(|one| one.parts);
        } else {
            self.touched =
                self.touched.filter(|parts| self.near.iter().any(|one| one.parts == *parts));
        }
        for one in &self.near {
            let is_probe = setpoint.probing && one.parts.contains(&Part::Tool);
            let about = Some(About::Parts(one.parts));
            if one.distance < -TOUCHING {
                findings.add(about, sentence::in_the_way(machine, place, one));
            } else if !(is_probe || self.touched == Some(one.parts)) && one.distance < self.wanted {
                findings.add(about, sentence::too_near(machine, place, one, self.wanted));
            }
        }
    }

    pub(super) fn into_found(self) -> Clearances {
        self.found
    }
}
