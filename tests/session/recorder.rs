//! Recorder of everything that a run shows.

use std::collections::VecDeque;
use twin::compare::Measured;
use twin::m_function::MCall;
use twin::session::{Answer, DriveSample, Observer, TwinCycle};
use twin_kinematics::AxisMotion;
use twin_physics::MotorState;

/// One cycle of the simulated machine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cycle {
    pub(crate) time_ns: i64,
    pub(crate) line: u32,
    /// Of the set-point, m/s.
    pub(crate) path_velocity: f64,
    pub(crate) axes: AxisMotion,
    pub(crate) wanted: Measured,
    pub(crate) twin: Measured,
}

/// One sample of the drives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Heard {
    pub(crate) time_ns: i64,
    pub(crate) drives: Measured,
}

/// Remembers everything, and does something of the test's at every cycle.
pub(crate) struct Recorder<'a> {
    pub(crate) cycles: Vec<Cycle>,
    /// States of the motors in every cycle; empty for machines that do not report them.
    pub(crate) motors: Vec<Vec<MotorState>>,
    pub(crate) heard: Vec<Heard>,
    /// M functions, and whether it was asked about them.
    pub(crate) m_functions: Vec<(MCall, bool)>,
    /// Answers that it will give; after the last one nobody answers.
    pub(crate) answers: VecDeque<Answer>,
    each: Box<dyn FnMut(i64) + 'a>,
}

impl<'a> Recorder<'a> {
    pub(crate) fn new() -> Self {
        Self::with(|_| {})
    }

    /// `each` is told the time of every cycle, ns.
    pub(crate) fn with(each: impl FnMut(i64) + 'a) -> Self {
        Self {
            cycles: Vec::new(),
            motors: Vec::new(),
            heard: Vec::new(),
            m_functions: Vec::new(),
            answers: VecDeque::new(),
            each: Box::new(each),
        }
    }

    /// The recorded data, without the action of each cycle.
    pub(crate) fn ended(self) -> Recorder<'static> {
        let Self { cycles, motors, heard, m_functions, answers, .. } = self;
        Recorder { cycles, motors, heard, m_functions, answers, each: Box::new(|_| {}) }
    }

    pub(crate) fn last(&self) -> &Cycle {
        self.cycles.last().expect("a cycle was executed")
    }

    /// The simulated machine was brought to rest where it belongs: the last set-points stand still, and it with them.
    #[track_caller]
    pub(crate) fn assert_twin_at_rest(&self) {
        let [.., before, last] = &self.cycles[..] else { panic!("two cycles") };
        assert_eq!(last.path_velocity, 0.0);
        let moved = (last.twin.tool - before.twin.tool).norm();
        assert!(moved < 5e-7, "the tool of the twin moved {moved} m in the last cycle");
        let off = (last.twin.tool - last.wanted.tool).norm();
        assert!(off < 5e-6, "the tool of the twin is {off} m from its set-point");
    }
}

impl Observer for Recorder<'_> {
    fn twin(&mut self, cycle: &TwinCycle<'_>) {
        self.cycles.push(Cycle {
            time_ns: cycle.setpoint.time_ns,
            line: cycle.setpoint.place.line,
            path_velocity: cycle.setpoint.path_velocity,
            axes: cycle.setpoint.axes,
            wanted: *cycle.wanted,
            twin: *cycle.twin,
        });
        self.motors.push(cycle.motors.to_vec());
        (self.each)(cycle.setpoint.time_ns);
    }

    fn m_function(&mut self, call: &MCall, asked: bool) {
        self.m_functions.push((*call, asked));
    }

    fn answer(&mut self) -> Answer {
        self.answers.pop_front().unwrap_or(Answer::Nobody)
    }

    fn drives(&mut self, sample: &DriveSample<'_>) {
        self.heard.push(Heard { time_ns: sample.time_ns, drives: *sample.drives });
    }
}
