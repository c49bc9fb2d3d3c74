//! Set-point checks: axis limits, jumps, and the deviation of the simulated machine.

use super::cam_jumps::CamJumps;
use super::findings::{About, Findings};
use super::instant::Instant;
use super::messages;
use super::pieces::PieceCheck;
use super::{Clearances, Outcome};
use crate::bridge::{Bridge, BridgeSetpoint};
use crate::finding;
use crate::finding::Finding;
use crate::m_function::{MCall, MCalls};
use crate::messages::no_axes;
use crate::peak::{AxisPeak, Peak};
use crate::planning::Planning;
use crate::program::Dialect;
use crate::setpoint::{AxisSetpoint, Transformer};
use crate::tolerance::{exceeds, is_hidden};
use std::collections::BTreeSet;
use twin_kinematics::{AxisSource, AxisVector, Kinematics, KinematicsError};
use twin_machine::axis_couplings::AxesError;
use twin_machine::switch_points::SwitchPoints;
use twin_machine::tappets::Switched;
use twin_machine::{DirectionRule, Machine};
use twin_number::seconds;
use twin_path::EXTRA_AXES;
use twin_path::Place;
use twin_planner::controller::ToolSetpoint;
use twin_planner::planned_motion::PlannedPiece;

/// Checker of every set-point.
#[derive(Debug)]
pub(super) struct Checker<'m> {
    machine: &'m Machine,
    dialect: Dialect,
    pub(super) transformer: Transformer<'m>,
    /// Velocity of rapids where the machine file and not the program says it, m/s.
    rapids: Option<f64>,
    /// By which factors limits of velocity, acceleration and jerk may be exceeded.
    slack: [f64; 3],
    pub(super) findings: Findings,
    peaks: Vec<AxisPeak>,
    last: Option<AxisSetpoint>,
    start: Option<AxisVector>,
    duration_ns: i64,
    /// Set-points that the machine cannot take.
    untaken: i64,
    /// Axes that follow blocks, gears or cams, and no path.
    free: Vec<bool>,
    /// Axes that turn the tool with the path: where the plan is not known piece by piece, they may step as well.
    turning: Vec<bool>,
    jumps: CamJumps<'m>,
    /// Where the plan is known piece by piece.
    pieces: Option<PieceCheck<'m>>,
    /// Set-points of which the pieces say everything are left out.
    leaves_out: bool,
    /// Findings say which feed would do.
    feeds: bool,
    /// Additional axes that the machine does not have, each reported once.
    reported_missing: [bool; EXTRA_AXES.len()],
}

impl<'m> Checker<'m> {
    pub(super) fn new(
        machine: &'m Machine,
        rapids: Option<f64>,
        slack: [f64; 3],
        dialect: Dialect,
    ) -> Self {
        Self {
            dialect,
            rapids,
            machine,
            transformer: Transformer::new(machine),
            slack,
            findings: cam_remarks(machine),
            peaks: vec![AxisPeak::default(); machine.axes.len()],
            last: None,
            start: None,
            duration_ns: 0,
            untaken: 0,
            free: free_axes(machine, dialect == Dialect::Job),
            turning: turning_axes(machine),
            jumps: CamJumps::new(machine),
            pieces: None,
            leaves_out: false,
            feeds: true,
            reported_missing: [false; EXTRA_AXES.len()],
        }
    }

    /// Findings without the feeds that would do, which take time to find.
    pub(super) fn without_feeds(self) -> Self {
        Self { feeds: false, ..self }
    }

    /// Begins where the program before ended, if there is one.
    pub(super) fn continue_from(&mut self, start: Option<AxisVector>) {
        if let Some(start) = start {
            self.transformer = Transformer::continuing(self.machine, start);
            self.start = Some(start);
        }
    }

    /// Starts the check of a job or a program. `every_cycle`: every set-point is needed, not only what the pieces of the plan
    /// leave open.
    pub(super) fn begin(&mut self, items: &mut Planning<'_>, every_cycle: bool) {
        if let Some(job) = items.job() {
            self.jumps.leave_out(job);
        }
        if items.record(self.turning.contains(&true)) {
            self.by_pieces();
            if !every_cycle && self.machine.couplings.is_empty() {
                items.leave_out_cycles();
                self.leaves_out = true;
            }
        }
    }

    /// From now on the axes that follow the path are checked by the pieces of its plan.
    fn by_pieces(&mut self) {
        let near = self.start.unwrap_or_else(|| self.machine.middle());
        let pieces = PieceCheck::new(self.machine, near, self.slack, self.free.clone());
        self.pieces = Some(if self.feeds { pieces } else { pieces.without_feeds() });
    }

    /// Checks the pieces of the plan that are over.
    pub(super) fn pieces(&mut self, items: &mut Planning<'_>) {
        while let Some(piece) = items.next_piece() {
            let Some(pieces) = &mut self.pieces else { continue };
            pieces.take(&piece, &mut self.peaks, &mut self.findings, self.rapids);
            if self.leaves_out {
                self.transformer.continue_at(pieces.near);
                let (peaks, findings) = (&mut self.peaks, &mut self.findings);
                self.untaken += pieces.sample(&piece, self.duration_ns, peaks, findings);
            }
            self.additional_axes(&piece);
        }
    }

    /// Reports additional axes of a piece that the machine does not have.
    fn additional_axes(&mut self, piece: &PlannedPiece) {
        let element = piece.element.element();
        let Some(extra) = element.extra() else { return };
        let pairs = extra.start.iter().zip(extra.end);
        let is_u = element.details.as_ref().map(|details| details.third_is_u);
        self.missing_axes(element.place, is_u, pairs.map(|(start, end)| (end - start).abs() > 0.0));
    }

    /// Reports additional axes that move and that the machine does not have, each once.
    fn missing_axes(
        &mut self,
        place: Place,
        is_u: Option<bool>,
        moves: impl Iterator<Item = bool>,
    ) {
        for ((number, letter), _) in (0..).zip(EXTRA_AXES).zip(moves).filter(|(_, moves)| *moves) {
            let reported = self.reported_missing.get_mut(usize::from(number));
            if !self.machine.kinematics.sources().contains(&AxisSource::Additional(number))
                && self.machine.direction.additional() != Some(number)
                && reported.is_some_and(|reported| !std::mem::replace(reported, true))
            {
                let finding = messages::no_additional_axis(place, letter, self.dialect, is_u);
                self.findings.add(None, finding);
            }
        }
    }

    /// Time of the last set-point, ns.
    pub(super) fn time_ns(&self) -> i64 {
        self.duration_ns
    }

    /// `None` if the machine cannot take this set-point, at which the path may wait for `m_call`.
    pub(super) fn tool(
        &mut self,
        tool: &ToolSetpoint,
        m_call: Option<MCall>,
    ) -> Option<AxisSetpoint> {
        self.duration_ns = tool.time_ns;
        // In the blend at the end of an element the additional axes of the next one move.
        if self.pieces.is_none() {
            let moves = tool.extra.velocity.iter().map(|velocity| *velocity != 0.0);
            self.missing_axes(tool.place, None, moves);
        }
        let setpoint = self.transformer.axes(tool, m_call);
        if setpoint.is_ok() && self.start.is_none() {
            for (names, groups) in self.transformer.stood_on_tappets() {
                let finding = crate::messages::starts_on_tappets(tool.place, names, &groups);
                self.findings.add(None, finding);
            }
        }
        let moves = tool.path_velocity > 0.0;
        self.taken((tool.place, moves), setpoint, self.pieces.is_some())
    }

    /// The way of the axes to a set-point to which the path jumps, which is noted.
    pub(super) fn bridge(&mut self, tool: &ToolSetpoint) -> Option<Bridge> {
        let is_first = self.transformer.continues();
        let bridge = self.transformer.bridge(tool)?;
        self.findings.add(None, crate::messages::bridged(self.machine, &bridge, is_first));
        Some(bridge)
    }

    /// Checks an instant of the way across a gap; none if the machine cannot take it.
    pub(super) fn bridging(&mut self, instant: &BridgeSetpoint) -> Option<AxisSetpoint> {
        self.duration_ns = instant.time_ns;
        let setpoint = self.transformer.bridging(instant);
        self.taken((instant.place, true), setpoint, false)
    }

    /// Checks a set-point, unless the machine cannot take it.
    fn taken(
        &mut self,
        (place, moves): (Place, bool),
        setpoint: Result<AxisSetpoint, AxesError>,
        by_pieces: bool,
    ) -> Option<AxisSetpoint> {
        match setpoint {
            Ok(setpoint) => Some(*self.setpoint(&setpoint, by_pieces)),
            Err(error) => {
                // The pieces report how far a motion leads out of reach.
                let reach =
                    matches!(error, AxesError::Kinematics(KinematicsError::Unreachable { .. }));
                if !(by_pieces && moves && reach) {
                    self.findings.add(None, no_axes(place, &error));
                }
                self.last = None;
                self.untaken += 1;
                None
            }
        }
    }

    /// Checks a set-point of the axes, and returns it.
    pub(super) fn axes<'s>(&mut self, setpoint: &'s AxisSetpoint) -> &'s AxisSetpoint {
        self.setpoint(setpoint, false)
    }

    /// The same; `by_pieces`: axes that follow the path are checked elsewhere.
    fn setpoint<'s>(&mut self, setpoint: &'s AxisSetpoint, by_pieces: bool) -> &'s AxisSetpoint {
        self.duration_ns = setpoint.time_ns;
        let last = self.last.replace(*setpoint);
        self.start.get_or_insert(setpoint.axes.position);
        for (axis, finding) in self.jumps.look(setpoint) {
            self.findings.add(Some(About::Axis(axis)), finding);
        }
        let machine = self.machine;
        let [faster, harder, jerkier] = self.slack;
        let cycle = seconds(machine.cycle_ns);
        for (index, (axis, peak)) in machine.axes.iter().zip(&mut self.peaks).enumerate() {
            let now = Instant::of(setpoint, index);
            let of = |axes: &[bool]| axes.get(index).copied().unwrap_or_default();
            let (slaved, turns) = (of(&self.free), of(&self.turning));
            let before = last.as_ref().map(|last| Instant::of(last, index));
            let rapids = self.rapids;
            let mut report = |mut finding: Finding| {
                if setpoint.feed.is_none()
                    && let Some(velocity) = rapids
                {
                    finding.hint = Some(messages::rapid_hint(velocity));
                }
                self.findings.add(Some(About::Axis(index)), finding);
            };
            peak.include_position([now.position; 2]);
            if let Some(finding) =
                crate::messages::beyond_position(axis, setpoint.place, now.position)
            {
                report(finding);
            }
            if by_pieces && !slaved {
                continue;
            }

            let slows = axis.slows(now.velocity, now.acceleration, cycle);
            let limit = axis.acceleration_limit(slows);
            peak.velocity.include(now.velocity, setpoint.place);
            if exceeds(now.velocity, faster * axis.max_velocity) {
                report(messages::too_fast(axis, setpoint.place, now.velocity));
            }
            peak.include_acceleration(axis, slows, now.acceleration, setpoint.place);
            if exceeds(now.acceleration, harder * limit) {
                report(messages::too_hard(axis, setpoint.place, now.acceleration, slows));
            }

            let Some(before) = before else { continue };
            // What only the difference between cycles shows belongs to the block of the cycle in which it happens, which the
            // set-point before began; where no path is followed, to the one that has begun with the set-point that is new.
            let of_cycle = if slaved { now.place } else { before.place };
            let stepped = (now.position - before.position) / cycle;
            let at_rest = now.path_velocity <= 0.0 && before.path_velocity <= 0.0;
            let most = faster * axis.max_velocity;
            let too_fast = exceeds(now.velocity, most) || exceeds(before.velocity, most);
            if is_hidden(stepped, [now.velocity, before.velocity], at_rest, most) {
                peak.velocity.include(stepped, of_cycle);
                if exceeds(stepped, most) {
                    report(messages::too_fast(axis, of_cycle, stepped));
                }
            }
            // An axis that follows no path may step, and so may one that turns the tool with the path at a corner too small
            // to stop at.
            let jump = now.jump(&before, cycle);
            let falls =
                axis.own_deceleration().is_some() && now.velocity.abs() < before.velocity.abs();
            let jump_limit = harder * axis.acceleration_limit(falls);
            if (slaved || turns)
                && !too_fast
                && !exceeds(stepped, most)
                && !exceeds(now.acceleration, harder * limit)
                && exceeds(jump, jump_limit)
            {
                peak.include_acceleration(axis, falls, jump, of_cycle);
                report(messages::too_hard(axis, of_cycle, jump, falls));
            }
            let jerk = (now.acceleration - before.acceleration) / cycle;
            // An acceleration that comes up is of this block, one that ends of the one before.
            let rises = now.acceleration.abs() >= before.acceleration.abs();
            let place = if rises { now.place } else { before.place };
            peak.jerk.include(jerk, place);
            if let Some(limit) = axis.max_jerk.filter(|limit| exceeds(jerk, jerkier * *limit)) {
                report(messages::too_jerky(axis, place, jerk, limit));
            }
        }
        setpoint
    }

    /// Compares the simulated machine with its set-point.
    pub(super) fn following(&mut self, setpoint: &AxisSetpoint, actual: &AxisVector) {
        let pairs = setpoint.axes.position.iter().zip(actual.iter());
        let axes = self.machine.axes.iter().zip(&mut self.peaks);
        for (index, ((axis, peak), (wanted, actual))) in axes.zip(pairs).enumerate() {
            let error = (actual - wanted).abs();
            peak.following_error.get_or_insert(Peak::default()).include(error, setpoint.place);
            if let Some(finding) = messages::ran_away(axis, setpoint.place, *wanted, *actual) {
                self.findings.add(Some(About::Axis(index)), finding);
            }
            if let Some(limit) = axis.max_following_error.filter(|limit| exceeds(error, *limit)) {
                let finding = messages::too_far(axis, setpoint.place, error, limit);
                self.findings.add(Some(About::Axis(index)), finding);
            }
        }
    }

    pub(super) fn finish(mut self) -> Outcome {
        if let Some(pieces) = &mut self.pieces {
            pieces.finish(&mut self.peaks, &mut self.findings, self.rapids);
        }
        let edge = self.pieces.as_ref().and_then(PieceCheck::nearest_to_edge);
        let (mut findings, findings_left_out) = self.findings.into_list();
        messages::leave_out_consequences(&mut findings);
        crate::messages::add_moves(self.machine, &mut findings);
        messages::leave_out_nearness(&mut findings);
        finding::sort(&mut findings);
        Outcome {
            elements: 0,
            length: 0.0,
            duration_ns: self.duration_ns,
            untaken_ns: self.untaken.saturating_mul(self.machine.cycle_ns),
            peaks: self.peaks,
            findings,
            findings_left_out,
            start: self.start,
            end: self.last.map(|last| last.axes.position),
            bodies: Vec::new(),
            loads: Vec::new(),
            clearances: Clearances::default(),
            edge,
            following: None,
            tappets: Switched::default(),
            switch_points: SwitchPoints::default(),
            m_calls: BTreeSet::new(),
            m_functions: MCalls::default(),
            start_tool: None,
            tool: None,
        }
    }
}

/// Remarks about elements of the machine file's cams: of no line of the program.
fn cam_remarks(machine: &Machine) -> Findings {
    let mut findings = Findings::default();
    for coupling in &machine.couplings {
        for remark in coupling.remarks() {
            let axis = machine.axes.get(coupling.axis).map(|axis| axis.name.clone());
            let finding = crate::messages::cam_remark(Place::default(), axis, remark);
            findings.add(Some(About::Axis(coupling.axis)), finding);
        }
    }
    findings
}

/// Axes that turn the tool with the path.
fn turning_axes(machine: &Machine) -> Vec<bool> {
    let with_path = matches!(machine.direction, DirectionRule::Path(..));
    (0..machine.axes.len()).map(|index| with_path && machine.kinematics.is_rotary(index)).collect()
}

/// Which axes follow no path: all of a job, and the slaves of the machine's gears and cams.
pub(super) fn free_axes(machine: &Machine, is_job: bool) -> Vec<bool> {
    let slave = |index| machine.couplings.iter().any(|coupling| coupling.axis == index);
    (0..machine.axes.len()).map(|index| is_job || slave(index)).collect()
}
