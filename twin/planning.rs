//! The set-points of a program, by whatever planning: the same for a check and for a run, so that what is run is what was
//! checked.

use crate::finding::Rule;
use crate::limit::{LimitFailure, LimitRules, Limits, Profile, ProfileItem};
use crate::m_function::{Acknowledgement, MCall, Waiting};
use crate::machine::Machine;
use crate::program::{Findings, ProgramFile, ProgramItem, Setpoints};
use std::io;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::task::Poll;
use std::thread::Scope;
use twin_motion::interpolate::ToolSetpoint;

/// Set-points that a thread may be ahead: seconds of them, where planning a window takes a part of one.
const AHEAD: usize = 4096;

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
        Ok(match limits {
            Limits::Softmotion => Self(Plan::Controller(Box::new(program.open(machine, rules)?))),
            Limits::Axes => {
                let motion = Motion::new(machine, program, &rules)?;
                Self::within_axes(machine, Source::Here(Box::new(motion)), rules)
            }
        })
    }

    /// As [`Self::new`], for whoever cannot wait while a window of the path is planned: that is done in a thread of `scope`,
    /// ahead. It ends when the planning is dropped.
    ///
    /// # Errors
    /// As [`Self::new`], and if no thread can be had.
    pub(crate) fn ahead<'scope>(
        scope: &'scope Scope<'scope, '_>,
        machine: &'m Machine,
        program: &'scope ProgramFile,
        limits: Limits,
        rules: Acknowledgement,
    ) -> Result<Self, LimitFailure>
    where
        'm: 'scope,
    {
        if limits == Limits::Softmotion {
            return Self::new(machine, program, limits, rules);
        }
        let (sender, items) = sync_channel(AHEAD);
        let (opened, whether_opened) = sync_channel(1);
        let for_motion = rules.clone();
        let plan = move || {
            // Where that is refused, it is as it was.
            crate::priority::ordinary().unwrap_or_default();
            let motion = match Motion::new(machine, program, &for_motion) {
                Ok(motion) => motion,
                Err(failure) => return opened.send(Err(failure)).unwrap_or_default(),
            };
            opened.send(Ok(())).unwrap_or_default();
            for next in motion {
                if sender.send(next).is_err() {
                    return;
                }
            }
        };
        std::thread::Builder::new().name("planner".to_owned()).spawn_scoped(scope, plan)?;
        let gone = |_| LimitFailure::Read(io::Error::other("its thread has ended"));
        whether_opened.recv().map_err(gone)??;
        Ok(Self::within_axes(machine, Source::Thread(items), rules))
    }

    fn within_axes(machine: &Machine, profile: Source<'m>, rules: Acknowledgement) -> Self {
        Self(Plan::Axes(Box::new(WithinAxes {
            profile,
            cycle_ns: machine.cycle_ns,
            waiting: Waiting::new(rules),
            tool: None,
            later_ns: 0,
        })))
    }

    /// What comes next; with `waits`, or where no thread is ahead, it is there when this returns.
    pub(crate) fn poll(&mut self, waits: bool) -> Poll<Option<ProgramItem>> {
        match &mut self.0 {
            Plan::Controller(setpoints) => Poll::Ready(setpoints.next()),
            Plan::Axes(within) => within.poll(waits),
        }
    }

    /// What is known of the file; nothing of what another thread reads.
    fn file(&self) -> Option<&Findings> {
        match &self.0 {
            Plan::Axes(within) => match &within.profile {
                Source::Here(motion) => Some(motion.0.file()),
                Source::Thread(_) => None,
            },
            Plan::Controller(_) => None,
        }
    }

    /// Bytes of the file read so far.
    pub(crate) fn bytes_read(&self) -> u64 {
        match &self.0 {
            Plan::Controller(setpoints) => setpoints.bytes_read(),
            Plan::Axes(_) => self.file().map_or(0, Findings::bytes_read),
        }
    }

    /// Path elements decoded so far.
    pub(crate) fn elements(&self) -> u64 {
        match &self.0 {
            Plan::Controller(setpoints) => setpoints.elements(),
            Plan::Axes(_) => self.file().map_or(0, Findings::elements),
        }
    }

    /// Length of the path decoded so far, m.
    pub(crate) fn length(&self) -> f64 {
        match &self.0 {
            Plan::Controller(setpoints) => setpoints.length(),
            Plan::Axes(_) => self.file().map_or(0.0, Findings::length),
        }
    }

    /// Diagnostics of the text that were left out because there are too many.
    pub(crate) fn left_out(&self) -> u64 {
        match &self.0 {
            Plan::Controller(setpoints) => setpoints.left_out(),
            Plan::Axes(_) => self.file().map_or(0, Findings::left_out),
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
        match self.poll(true) {
            Poll::Ready(next) => next,
            Poll::Pending => None,
        }
    }
}

/// A program within the limits of the axes.
#[derive(Debug)]
struct WithinAxes<'m> {
    profile: Source<'m>,
    cycle_ns: i64,
    waiting: Waiting,
    /// The last one.
    tool: Option<ToolSetpoint>,
    /// The profile knows M functions that take their time. Those that somebody has to acknowledge take it one cycle each, and
    /// all that follows is later by what they have taken beyond that, ns.
    later_ns: i64,
}

impl WithinAxes<'_> {
    /// The path rests where it is for one cycle more.
    fn wait(&mut self) -> Option<ToolSetpoint> {
        let mut tool = self.tool?;
        tool.time_ns += self.cycle_ns;
        self.later_ns += self.cycle_ns;
        self.tool = Some(tool);
        Some(tool)
    }

    fn poll(&mut self, waits: bool) -> Poll<Option<ProgramItem>> {
        if self.waiting.for_word()
            && let Some(tool) = self.wait()
        {
            return Poll::Ready(Some(ProgramItem::Setpoint(tool)));
        }
        let next = match &mut self.profile {
            Source::Here(profile) => profile.next(),
            Source::Thread(items) if waits => items.recv().ok(),
            Source::Thread(items) => match items.try_recv() {
                Ok(item) => Some(item),
                Err(TryRecvError::Empty) => return Poll::Pending,
                Err(TryRecvError::Disconnected) => None,
            },
        };
        Poll::Ready(next.map(|Next { item, enters }| match item {
            ProgramItem::Setpoint(mut tool) => {
                tool.time_ns += self.later_ns;
                // Two of the same number in a row are two calls all the same.
                self.waiting.see(enters, tool.m_function, tool.place, tool.time_ns);
                self.tool = Some(tool);
                ProgramItem::Setpoint(tool)
            }
            other => other,
        }))
    }
}

/// Where the motion within the limits of the axes comes from.
#[derive(Debug)]
enum Source<'m> {
    Here(Box<Motion<'m>>),
    /// From a thread of its own, which is ahead.
    Thread(Receiver<Next>),
}

/// What comes next.
#[derive(Debug)]
struct Next {
    item: ProgramItem,
    /// It is the first set-point on its element.
    enters: bool,
}

/// The motion within the limits of the axes.
#[derive(Debug)]
struct Motion<'m>(Profile<'m>);

impl<'m> Motion<'m> {
    fn new(
        machine: &'m Machine,
        program: &ProgramFile,
        rules: &Acknowledgement,
    ) -> Result<Self, LimitFailure> {
        let profile = Profile::new(program, machine, LimitRules::default())?;
        Ok(Self(profile.for_check(rules)))
    }
}

impl Iterator for Motion<'_> {
    type Item = Next;

    fn next(&mut self) -> Option<Next> {
        let Self(profile) = self;
        loop {
            let item = match profile.next()? {
                ProfileItem::Sample(_) => match profile.tool() {
                    Some(tool) => ProgramItem::Setpoint(*tool),
                    None => continue,
                },
                // Whoever takes set-points finds that out itself.
                ProfileItem::Finding(finding) if finding.rule == Rule::AxisPosition => continue,
                ProfileItem::Finding(finding) => ProgramItem::Diagnostic(finding),
                ProfileItem::Io(error) => ProgramItem::Io(error),
            };
            return Some(Next { item, enters: profile.has_entered() });
        }
    }
}
