//! The set-points of a program, by whatever planning: the same for a check and for a run, so that what is run is what was
//! checked.

use crate::finding::Rule;
use crate::limit::{LimitFailure, LimitRules, Limits, Profile, ProfileItem};
use crate::m_function::{Acknowledgement, MCall, Waiting};
use crate::machine::Machine;
use crate::program::{ProgramFile, ProgramItem, Setpoints};
use twin_motion::interpolate::ToolSetpoint;

/// The set-points of a program, as the controller itself plans them or within the limits of the axes.
#[derive(Debug)]
pub(crate) struct Planning<'m>(Plan<'m>);

#[derive(Debug)]
enum Plan<'m> {
    Controller(Box<Setpoints>),
    Axes(Box<WithinAxes<'m>>),
}

impl<'m> Planning<'m> {
    /// The program `program` on `machine`, with M functions acknowledged as `rules` say.
    ///
    /// # Errors
    /// If it cannot be opened, or the machine is none whose axes a path can be planned for.
    pub(crate) fn new(
        machine: &'m Machine,
        program: &ProgramFile,
        limits: Limits,
        rules: Acknowledgement,
    ) -> Result<Self, LimitFailure> {
        Ok(Self(match limits {
            Limits::Softmotion => Plan::Controller(Box::new(program.open(machine, rules)?)),
            Limits::Axes => Plan::Axes(Box::new(WithinAxes::new(machine, program, rules)?)),
        }))
    }

    /// Bytes of the file read so far.
    pub(crate) fn bytes_read(&self) -> u64 {
        match &self.0 {
            Plan::Controller(setpoints) => setpoints.bytes_read(),
            Plan::Axes(within) => within.profile.bytes_read(),
        }
    }

    /// Path elements decoded so far.
    pub(crate) fn elements(&self) -> u64 {
        match &self.0 {
            Plan::Controller(setpoints) => setpoints.elements(),
            Plan::Axes(within) => within.profile.file().elements(),
        }
    }

    /// Length of the path decoded so far, m.
    pub(crate) fn length(&self) -> f64 {
        match &self.0 {
            Plan::Controller(setpoints) => setpoints.length(),
            Plan::Axes(within) => within.profile.file().length(),
        }
    }

    /// Diagnostics of the text that were left out because there are too many.
    pub(crate) fn left_out(&self) -> u64 {
        match &self.0 {
            Plan::Controller(setpoints) => setpoints.left_out(),
            Plan::Axes(within) => within.profile.file().left_out(),
        }
    }

    /// The M function at which the last set-point stands.
    pub(crate) fn m_call(&self) -> Option<MCall> {
        match &self.0 {
            Plan::Controller(setpoints) => setpoints.m_call(),
            Plan::Axes(within) => within.waiting.call(),
        }
    }

    /// Whether the path goes on only when [`Self::acknowledge`] is called.
    pub(crate) fn waits_for_word(&self) -> bool {
        match &self.0 {
            Plan::Controller(setpoints) => setpoints.waits_for_word(),
            Plan::Axes(within) => within.waiting.for_word(),
        }
    }

    /// The M function is done; the path goes on with the next set-point.
    pub(crate) fn acknowledge(&mut self) {
        match &mut self.0 {
            Plan::Controller(setpoints) => setpoints.acknowledge(),
            Plan::Axes(within) => within.waiting.tell(),
        }
    }

    /// Asks for set-points that brake along the path and end; false if this planning has none.
    pub(crate) fn request_stop(&mut self) -> bool {
        match &mut self.0 {
            Plan::Controller(setpoints) => {
                setpoints.request_stop();
                true
            }
            Plan::Axes(_) => false,
        }
    }
}

impl Iterator for Planning<'_> {
    type Item = ProgramItem;

    fn next(&mut self) -> Option<ProgramItem> {
        match &mut self.0 {
            Plan::Controller(setpoints) => setpoints.next(),
            Plan::Axes(within) => within.next(),
        }
    }
}

/// A program within the limits of the axes.
#[derive(Debug)]
struct WithinAxes<'m> {
    profile: Profile<'m>,
    cycle_ns: i64,
    waiting: Waiting,
    /// The last one.
    tool: Option<ToolSetpoint>,
    /// The profile knows M functions that take their time. Those that somebody has to acknowledge take it one cycle each, and
    /// all that follows is later by what they have taken beyond that, ns.
    later_ns: i64,
}

impl<'m> WithinAxes<'m> {
    fn new(
        machine: &'m Machine,
        program: &ProgramFile,
        rules: Acknowledgement,
    ) -> Result<Self, LimitFailure> {
        let profile = Profile::new(program, machine, LimitRules::default())?;
        Ok(Self {
            profile: profile.for_check(&rules),
            cycle_ns: machine.cycle_ns,
            waiting: Waiting::new(rules),
            tool: None,
            later_ns: 0,
        })
    }

    /// The path rests where it is for one cycle more.
    fn wait(&mut self) -> Option<ToolSetpoint> {
        let mut tool = self.tool?;
        tool.time_ns += self.cycle_ns;
        self.later_ns += self.cycle_ns;
        self.tool = Some(tool);
        Some(tool)
    }

    /// The set-point of the profile's last sample.
    fn take(&mut self) -> Option<ToolSetpoint> {
        let mut tool = *self.profile.tool()?;
        tool.time_ns += self.later_ns;
        // Two of the same number in a row are two calls all the same.
        let left = self.profile.has_entered();
        self.waiting.see(left, tool.m_function, tool.place, tool.time_ns);
        self.tool = Some(tool);
        Some(tool)
    }
}

impl Iterator for WithinAxes<'_> {
    type Item = ProgramItem;

    fn next(&mut self) -> Option<ProgramItem> {
        if self.waiting.for_word()
            && let Some(tool) = self.wait()
        {
            return Some(ProgramItem::Setpoint(tool));
        }
        loop {
            match self.profile.next()? {
                ProfileItem::Sample(_) => {
                    if let Some(tool) = self.take() {
                        return Some(ProgramItem::Setpoint(tool));
                    }
                }
                // Whoever takes set-points finds that out itself.
                ProfileItem::Finding(finding) if finding.rule == Rule::AxisPosition => {}
                ProfileItem::Finding(finding) => return Some(ProgramItem::Diagnostic(finding)),
                ProfileItem::Io(error) => return Some(ProgramItem::Io(error)),
            }
        }
    }
}
