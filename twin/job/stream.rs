//! Set-point source of a job: one set-point per cycle.

use super::block::Fired;
use super::engine::{Engine, State};
use super::pace::{Bears, Pace};
use super::start::starts;
use super::{Call, read};
use crate::finding::{Finding, Rule};
use crate::messages::cam_remark;
use crate::program::ProgramFile;
use crate::setpoint::AxisSetpoint;
use crate::setpoint_source::PlanItem;
use std::collections::VecDeque;
use std::io;
use twin_cam::Trigger;
use twin_kinematics::{AxisMotion, AxisVector, Kinematics};
use twin_machine::section::Problem;
use twin_machine::tappets::{MasterPlace, Signal, TappetBits, Tracks};
use twin_machine::{Axis, Machine};
use twin_number::{seconds, significant};
use twin_path::Place;

/// Set-points of a job on a machine, one per cycle, from rest to rest.
#[derive(Debug)]
pub(crate) struct JobSetpoints<'m> {
    machine: &'m Machine,
    /// None after the end.
    engine: Option<Engine>,
    problems: VecDeque<Finding>,
    /// Two set-points of the job, between which it is.
    from: Instant,
    to: Instant,
    /// The set-point behind both.
    next: Instant,
    pace: Pace,
    /// Of the last set-point; none before the first.
    time_ns: Option<i64>,
    /// Everything is done and at rest with the set-point behind both.
    done: bool,
    /// That set-point has been given.
    over: bool,
    stopping: bool,
    blocks: u64,
    bytes: u64,
    /// Way of the tool, m.
    length: f64,
    last: Option<AxisSetpoint>,
    /// Signals of tappets.
    tracks: Tracks,
    /// Tappets that have acted in the job's time, but not yet in real time.
    pending: Vec<Fired>,
    /// Possible masters of tappets: name, period and unit.
    masters: Vec<(String, Option<f64>, &'static str)>,
    lost: u64,
}

#[derive(Clone, Debug, Default)]
struct Instant {
    states: Vec<State>,
    /// The same by the zeros of the axes, which blocks may move.
    positions: Vec<f64>,
    place: Place,
    /// Tappets that acted since the set-point before.
    fired: Vec<Fired>,
    /// In the time of the job.
    time_ns: i64,
}

impl Instant {
    fn of(engine: &Engine) -> Self {
        let (states, place) = (engine.states().collect(), engine.place());
        let positions = engine.positions().collect();
        Self { states, positions, place, fired: Vec::new(), time_ns: engine.now_ns() }
    }
}

impl<'m> JobSetpoints<'m> {
    /// The job `program` on `machine`. Its errors come as findings.
    ///
    /// # Errors
    /// If it cannot be read.
    pub(crate) fn open(machine: &'m Machine, program: &ProgramFile) -> io::Result<Self> {
        let text = program.text()?;
        let mut setpoints = Self {
            machine,
            engine: None,
            problems: VecDeque::new(),
            from: Instant::default(),
            to: Instant::default(),
            next: Instant::default(),
            pace: Pace::new(program.settings().inputs.override_factor.factor()),
            time_ns: None,
            done: false,
            over: false,
            stopping: false,
            blocks: 0,
            bytes: u64::try_from(text.len()).unwrap_or(u64::MAX),
            length: 0.0,
            last: None,
            tracks: Tracks::default(),
            pending: Vec::new(),
            masters: Vec::new(),
            lost: 0,
        };
        match read(&text, program.path(), machine) {
            Ok(mut job) => {
                setpoints.tracks = job.tracks.clone();
                setpoints.masters = job.masters(machine);
                setpoints.problems =
                    job.calls.iter().flat_map(|call| message(call, &setpoints.masters)).collect();
                setpoints.blocks = u64::try_from(job.calls.len()).unwrap_or(u64::MAX);
                let start = match starts(machine, &job.starts, &mut job.calls) {
                    Ok(start) => start,
                    Err(finding) => {
                        setpoints.problems.push_back(*finding);
                        return Ok(setpoints);
                    }
                };
                let engine = Engine::new(job, machine, &start);
                setpoints.from = Instant::of(&engine);
                setpoints.to = setpoints.from.clone();
                setpoints.next = setpoints.from.clone();
                setpoints.engine = Some(engine);
            }
            Err(problems) => {
                setpoints.problems = problems.iter().map(|one| finding(&text, one)).collect();
            }
        }
        Ok(setpoints)
    }

    /// Done part of the job, as bytes of its file, if the job gives its duration: the file is read completely at the start.
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a share of the size of a file"
    )]
    pub(crate) fn bytes_done(&self) -> Option<u64> {
        let part = self.engine.as_ref().map_or(Some(1.0), Engine::progress)?;
        Some((part * self.bytes as f64) as u64)
    }

    /// Number of block calls; none after the end.
    #[cfg(test)]
    pub(super) fn block_calls(&self) -> Option<u64> {
        self.engine.as_ref().map(Engine::block_calls)
    }

    /// Number of its blocks.
    pub(crate) fn blocks(&self) -> u64 {
        self.blocks
    }

    /// Way of the tool so far, m.
    pub(crate) fn length(&self) -> f64 {
        self.length
    }

    /// Scales the time of the job by `factor` from now on; more than 1 is 1.
    pub(crate) fn set_override(&mut self, factor: f64) {
        if !self.stopping {
            self.pace.want(factor);
        }
    }

    /// True if the time of the job passes at the requested rate.
    pub(crate) fn follows_override(&self) -> bool {
        self.pace.is_as_wanted()
    }

    /// Brings all axes to rest together, on their cams and in their gears, and ends.
    pub(crate) fn request_stop(&mut self) {
        self.stopping = true;
        self.pace.want(0.0);
    }

    /// The next cycle of the job.
    fn go_on(&mut self, engine: &mut Engine) -> Result<(), Box<Finding>> {
        std::mem::swap(&mut self.from, &mut self.to);
        self.to.clone_from(&self.next);
        // The tappets of the next set-point are known already.
        self.pending.append(&mut self.to.fired);
        self.over = self.done;
        self.next.fired.clear();
        if !self.done {
            if engine.step()? {
                self.next.states.clear();
                self.next.states.extend(engine.states());
                self.next.positions.clear();
                self.next.positions.extend(engine.positions());
                self.next.place = engine.place();
                self.next.fired.extend_from_slice(engine.fired());
                self.next.time_ns = engine.now_ns();
                self.lost = engine.lost();
                self.problems.extend(engine.take_notes());
            } else {
                self.done = true;
            }
        }
        Ok(())
    }

    /// Signals that tappets have switched on at `time_ns`. Delays, durations and dead times pass in real time at any pace: at
    /// half the pace a dead time looks half as far ahead of the master.
    fn tappets(&mut self, time_ns: i64) -> TappetBits {
        let rate = self.pace.rate();
        let now = self.pace.phase() * seconds(self.machine.cycle_ns);
        let (tracks, from_ns) = (&mut self.tracks, self.from.time_ns);
        self.pending.retain(|fired| {
            let Fired { slave, master, trigger, dead_time } = fired;
            // Time since then in the time of the job. A tappet that comes too late for its dead time acts now.
            let since = seconds(from_ns.saturating_sub(trigger.time_ns)) + now;
            let ago = since - (dead_time * (1.0 - rate)).max(0.0);
            if ago < 0.0 {
                return true;
            }
            let ago = if rate > 0.0 { ago / rate } else { 0.0 };
            #[expect(clippy::cast_possible_truncation, reason = "some cycles; it saturates")]
            let time_ns = time_ns.saturating_sub((ago * 1e9).round() as i64);
            tracks.take(*slave, *master, &Trigger { time_ns, ..*trigger });
            false
        });
        self.tracks.at(time_ns)
    }

    /// True if blocks release `slave` from its cam on `master` in the machine file, or move the zero of one of them.
    pub(crate) fn disturbs(&self, slave: usize, master: usize) -> bool {
        self.engine.as_ref().is_some_and(|engine| engine.disturbs(slave, master))
    }

    /// Signals of the tappets: the bits of the set-points in their order.
    pub(crate) fn signals(&self) -> &[Signal] {
        self.tracks.signals()
    }

    /// Tappets that did not act because there were too many in a cycle.
    pub(crate) fn lost_tappets(&self) -> u64 {
        self.lost
    }

    /// Position of the master that switched a signal last, at the last set-point.
    pub(crate) fn tappet_master(&self, signal: usize) -> Option<MasterPlace> {
        let index = self.tracks.master(signal)?;
        let (name, period, unit) = self.masters.get(index)?;
        let [from, to] = [&self.from, &self.to].map(|instant| instant.states.get(index).copied());
        let cycle = seconds(self.machine.cycle_ns);
        let now = self.pace.between(from?, to?, self.pace.rate(), cycle);
        let position = self.from.positions.get(index)? + now.position - from?.position;
        let position = period.map_or(position, |period| position.rem_euclid(period));
        Some(MasterPlace { axis: name.clone(), position, unit })
    }

    /// The set-point at `time_ns`; `before` is the pace a cycle ago.
    fn setpoint(&mut self, time_ns: i64, before: f64) -> Result<AxisSetpoint, Box<Finding>> {
        let cycle = seconds(self.machine.cycle_ns);
        let mut axes = AxisMotion::at_rest(AxisVector::zeros(self.machine.axes.len()));
        let AxisMotion { position, velocity, acceleration } = &mut axes;
        let slots = position.iter_mut().zip(velocity.iter_mut()).zip(acceleration.iter_mut());
        let states = self.from.states.iter().zip(&self.to.states).zip(&self.machine.axes);
        for (((position, velocity), acceleration), ((from, to), axis)) in slots.zip(states) {
            let state = self.pace.between(*from, *to, before, cycle);
            *position = axis.to_si(state.position);
            *velocity = axis.to_si(state.velocity);
            *acceleration = axis.to_si(state.acceleration);
        }
        let place = self.from.place;
        let tool = self.machine.kinematics.forward_motion(&axes).map_err(|error| {
            Box::new(Finding::error(Rule::Reach, place, format!("the tool is nowhere: {error}")))
        })?;
        // The speed of axes counts if they do not move the tool.
        let fastest =
            axes.velocity.iter().fold(0.0, |most: f64, velocity| most.max(velocity.abs()));
        let tool_speed = tool.velocity.norm();
        Ok(AxisSetpoint {
            time_ns,
            place,
            axes,
            tool,
            m_call: None,
            switches: 0,
            path_velocity: if tool_speed > 0.0 { tool_speed } else { fastest },
            feed: None,
            probing: false,
            tappets: self.tappets(time_ns),
        })
    }

    fn poll(&mut self, engine: &mut Engine) -> Option<Result<AxisSetpoint, Box<Finding>>> {
        let Some(last_ns) = self.time_ns else {
            // Two set-points ahead are known from the beginning.
            for _ in 0..2 {
                if let Err(finding) = self.go_on(engine) {
                    return Some(Err(finding));
                }
            }
            self.time_ns = Some(0);
            return Some(self.setpoint(0, self.pace.rate()));
        };
        if self.over || (self.stopping && self.pace.stands()) {
            return None;
        }
        let before = self.pace.rate();
        let around = [&self.from, &self.to, &self.next].into_iter();
        let states = around.flat_map(|instant| {
            instant.states.iter().copied().zip(self.machine.axes.iter().map(bears))
        });
        for _ in 0..self.pace.advance(states, seconds(self.machine.cycle_ns)) {
            if let Err(finding) = self.go_on(engine) {
                return Some(Err(finding));
            }
        }
        let time_ns = last_ns.saturating_add(self.machine.cycle_ns);
        self.time_ns = Some(time_ns);
        Some(self.setpoint(time_ns, before))
    }
}

/// Notes on a block's cam before anything moves: remarks about its elements, and a gain in every pass because the cam is
/// periodic by default. `axes` are names, periods and units.
fn message(
    call: &Call,
    axes: &[(String, Option<f64>, &'static str)],
) -> impl Iterator<Item = Finding> {
    let axis = axes.get(call.axis);
    let name = axis.map(|(name, ..)| name.clone());
    let remarks = call.block.cam_remarks().iter();
    let shown = name.clone();
    let remarks = remarks.map(move |remark| cam_remark(call.place(), shown.clone(), remark));
    let gain = call.block.gain_unsaid().map(|gain| {
        let message = format!(
            "`periodic` is missing, so the cam repeats: the slave gains {} {} in every pass",
            significant(gain, 6),
            axis.map_or("", |(_, _, unit)| unit)
        );
        let mut note = call.note(&name.unwrap_or_default(), message);
        note.hint = Some("`periodic = false` has the slave stay at the end of the cam".to_owned());
        note
    });
    remarks.chain(gain)
}

impl Iterator for JobSetpoints<'_> {
    type Item = PlanItem;

    fn next(&mut self) -> Option<PlanItem> {
        if let Some(problem) = self.problems.pop_front() {
            return Some(PlanItem::Diagnostic(problem));
        }
        let mut engine = self.engine.take()?;
        match self.poll(&mut engine)? {
            Ok(setpoint) => {
                self.engine = Some(engine);
                if let Some(last) = self.last.replace(setpoint) {
                    let way = setpoint.tool.pose.position - last.tool.pose.position;
                    self.length += way.norm();
                }
                Some(PlanItem::Axes(Box::new(setpoint)))
            }
            // It is the last item.
            Err(finding) => Some(PlanItem::Diagnostic(*finding)),
        }
    }
}

/// Limits of an axis of the machine for the pace, in its unit.
fn bears(axis: &Axis) -> Bears {
    Bears {
        acceleration: axis.from_si(axis.smallest_acceleration()),
        jerk: axis.max_jerk.map_or(f64::INFINITY, |jerk| axis.from_si(jerk)),
    }
}

/// A mistake of the file as a finding.
fn finding(text: &str, problem: &Problem) -> Finding {
    let Problem { span, message, help, elsewhere } = problem;
    let before = text.get(..span.start).unwrap_or_default();
    let line = u32::try_from(before.matches('\n').count() + 1).unwrap_or(u32::MAX);
    let begin = before.rfind('\n').map_or(0, |end| end + 1);
    let length = text.get(begin..).unwrap_or_default().lines().next().map_or(0, str::len);
    let column = span.start - begin.min(span.start);
    let end = (span.end.saturating_sub(begin)).min(length).max(column);
    let place = Place::at(line);
    let mut finding = Finding::error(Rule::Syntax, place, message.clone());
    finding.hint.clone_from(help);
    finding.elsewhere.clone_from(elsewhere);
    finding.columns = Some(column..end);
    finding
}
