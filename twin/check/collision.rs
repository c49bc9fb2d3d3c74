//! Collision check: clearance between machine, obstacles and links at every set-point.

use super::findings::{About, Findings};
use super::messages;
use crate::m_function::MCall;
use crate::setpoint::AxisSetpoint;
use crate::spindle::Spindle;
use twin_machine::{Machine, SimulationError};
use twin_path::Place;
use twin_physics::{Clearance, ClearanceScan, Part};

/// Blocks that are kept: a picture of more shows no more.
const MOST_BLOCKS: usize = 100_000;

/// Depth to which parts may be in each other without a finding, m: a body that stands on another touches it.
const TOUCHING: f64 = 1e-6;

/// Smallest clearance in one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockClearance {
    /// The block.
    pub place: Place,
    /// Time, ns since the start of the program.
    pub time_ns: i64,
    /// The two parts and their distance.
    pub nearest: Clearance,
    /// Tool of the tool table in the spindle, by its number.
    pub tool: Option<u32>,
    /// It may touch: it is a probe that does, or has not come free yet.
    pub may_touch: bool,
}

impl BlockClearance {
    /// Takes in what comes next, if that is of the same block.
    pub fn include(&mut self, next: &Self) -> bool {
        let is_same = self.place == next.place;
        if is_same && next.is_nearer_than(self) {
            *self = *next;
        }
        is_same
    }

    /// True if this clearance is smaller.
    pub fn is_nearer_than(&self, other: &Self) -> bool {
        self.nearest.distance < other.nearest.distance
    }

    /// True if the two parts overlap. A probe must not overlap, either: it stops where it touches.
    pub fn is_collision(&self) -> bool {
        self.nearest.distance < -TOUCHING
    }

    /// Names of the two parts.
    pub fn names(&self, machine: &Machine) -> [String; 2] {
        self.nearest.parts.map(|part| machine.part_name_with(part, self.tool))
    }

    /// A sentence about it as the least of all, with the names of the machine.
    pub fn message(&self, machine: &Machine) -> String {
        let Self { place, nearest, .. } = self;
        let [one, other] = self.names(machine);
        if self.is_collision() {
            let depth = -nearest.distance * 1e3;
            return format!(
                "least clearance: none; {one} is {depth:.3} mm deep in {other}, {place}"
            );
        }
        let distance = nearest.distance.max(0.0) * 1e3;
        format!("least clearance: {distance:.3} mm between {one} and {other}, {place}")
    }
}

/// Smallest clearances of a program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clearances {
    /// The least, block by block, in the order in which they were run through; the first hundred thousand.
    pub blocks: Vec<BlockClearance>,
    /// The least of all.
    pub least: Option<BlockClearance>,
}

/// Collision check of every set-point.
#[derive(Debug)]
pub(super) struct Way {
    scan: ClearanceScan,
    spindle: Spindle,
    /// Clearances below this are reported, m.
    wanted: f64,
    /// What a probe has touched and not come away from.
    touched: Option<[Part; 2]>,
    /// Workspace: what is nearer than is wanted.
    near: Vec<Clearance>,
    found: Clearances,
}

impl Way {
    /// The collision check of `machine` with the tools of `spindle`; `None` if the machine file has none.
    pub(super) fn new(
        machine: &Machine,
        spindle: &Spindle,
    ) -> Result<Option<Self>, SimulationError> {
        let scan = scan_with(machine, spindle)?;
        let wanted = machine.collision.as_ref().map_or(0.0, |collision| collision.clearance);
        Ok(scan.map(|scan| Self {
            scan,
            spindle: spindle.clone(),
            wanted,
            touched: None,
            near: Vec::new(),
            found: Clearances::default(),
        }))
    }

    /// Observes the M function at which the path waits.
    pub(super) fn observe(
        &mut self,
        machine: &Machine,
        call: &MCall,
    ) -> Result<(), SimulationError> {
        if self.spindle.observe(call)
            && let Some(scan) = scan_with(machine, &self.spindle)?
        {
            self.scan = scan;
        }
        Ok(())
    }

    /// Smallest clearance at a set-point; `None` where the links have no pose, which is another finding.
    pub(super) fn look(
        &mut self,
        machine: &Machine,
        setpoint: &AxisSetpoint,
        findings: &mut Findings,
    ) -> Option<BlockClearance> {
        let axes = &setpoint.axes.position;
        let nearest = self.scan.nearest(axes).ok()??;
        self.scan.nearer_than(self.wanted.max(0.0), axes, &mut self.near).ok()?;
        // What a probe has touched it may be near to until it has come away from it.
        let by_probe = |parts: &[Part; 2]| setpoint.probing && parts.contains(&Part::Tool);
        self.touched = if setpoint.probing {
            let is_touched = |one: &&Clearance| by_probe(&one.parts) && one.distance <= TOUCHING;
            self.near.iter().find(is_touched).map(|one| one.parts)
        } else {
            self.touched.filter(|parts| self.near.iter().any(|one| one.parts == *parts))
        };
        let may_touch = |parts: &[Part; 2]| by_probe(parts) || self.touched == Some(*parts);

        let AxisSetpoint { place, time_ns, .. } = *setpoint;
        let of = |nearest: Clearance| BlockClearance {
            place,
            time_ns,
            nearest,
            tool: self.spindle.number(),
            may_touch: may_touch(&nearest.parts),
        };
        let now = of(nearest);
        for one in self.near.iter().map(|one| of(*one)) {
            let about = Some(About::Parts(one.nearest.parts));
            if one.is_collision() {
                findings.add(about, messages::in_the_way(machine, &one));
            } else if self.wanted > 0.0 && one.nearest.distance < self.wanted && !one.may_touch {
                findings.add(about, messages::too_near(machine, &one, self.wanted));
            }
        }
        if self.found.least.is_none_or(|least| now.is_nearer_than(&least)) {
            self.found.least = Some(now);
        }
        let room = self.found.blocks.len() < MOST_BLOCKS;
        let is_known = self.found.blocks.last_mut().is_some_and(|block| block.include(&now));
        if !is_known && room {
            self.found.blocks.push(now);
        }
        Some(now)
    }

    pub(super) fn into_found(self) -> Clearances {
        self.found
    }
}

/// The scan of `machine` with the tool in the spindle.
fn scan_with(
    machine: &Machine,
    spindle: &Spindle,
) -> Result<Option<ClearanceScan>, SimulationError> {
    let scan = machine.clearance_scan_with(spindle.tool());
    scan.map_err(|error| SimulationError::of(machine, error))
}
