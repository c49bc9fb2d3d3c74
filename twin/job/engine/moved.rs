//! Axis of a job with an ideal drive.

use super::super::Job;
use super::State;
use crate::finding::{Finding, Rule, Severity};
use twin_axis::{Axis, AxisConfig, AxisState, Block, Halt, Movement, Power, VirtualDrive};
use twin_number::significant;
use twin_path::Place;
use twin_profile::RampType;

/// Cycles until a drive has its power.
const SWITCHING_ON: usize = 3;

/// Default jerk of an axis over its acceleration, 1/s: a tenth of a second to the full acceleration.
const JERK: f64 = 10.0;

/// Part of the largest acceleration that is rounding.
const ROUNDING: f64 = 1e-12;

/// An axis with its drive.
#[derive(Debug)]
pub(super) struct Moved {
    pub(super) name: String,
    /// mm or deg.
    pub(super) unit: &'static str,
    pub(super) axis: Axis,
    pub(super) drive: VirtualDrive,
    pub(super) state: State,
    /// The last set-point as the drive gets it.
    pub(super) shown: f64,
    /// Brings it to rest at the end.
    pub(super) halt: Option<Block<Halt>>,
    pub(super) max_acceleration: f64,
    pub(super) max_deceleration: f64,
    pub(super) max_velocity: f64,
    /// Jump of the position in the last cycle, beyond its largest and its commanded velocity; 0 without a jump.
    pub(super) jumped: f64,
    /// The block that has taken it last.
    pub(super) taken_by: Option<usize>,
    /// The block that has begun last to move it on top of that.
    pub(super) topped_by: Option<usize>,
}

/// Data of an axis: name, period, largest velocity, acceleration and jerk, largest deceleration, and start position.
pub(super) struct Moving {
    pub(super) name: String,
    pub(super) unit: &'static str,
    pub(super) period: Option<f64>,
    pub(super) limits: (f64, f64, Option<f64>),
    pub(super) deceleration: f64,
    pub(super) start: f64,
}

impl Moving {
    /// The jerk limit, or its default.
    fn jerk(&self) -> f64 {
        let (_, acceleration, jerk) = self.limits;
        jerk.unwrap_or(JERK * acceleration)
    }

    /// Message about the default, with the key that replaces it.
    pub(super) fn assumed_jerk(&self) -> String {
        let Self { name, unit, .. } = self;
        format!(
            "`max_jerk_{unit}_per_s3` of axis {name} is missing, so that {} {unit}/s³ is used, {JERK} times its acceleration",
            significant(self.jerk(), 6)
        )
    }
}

impl Moved {
    pub(super) fn new(moving: Moving, config: AxisConfig) -> Self {
        let jerk = moving.jerk();
        let Moving { name, unit, period, limits, deceleration, start } = moving;
        let (velocity, acceleration, _) = limits;
        let axis = Axis::new(AxisConfig {
            movement: period.map_or(Movement::Linear, |period| Movement::Rotary { period }),
            jerk,
            max_velocity: velocity,
            max_acceleration: acceleration,
            max_deceleration: deceleration,
            ..config
        });
        let shown = axis.wrapped(start);
        Self {
            name,
            unit,
            axis,
            drive: VirtualDrive::new(shown),
            state: State { position: start, ..State::default() },
            shown,
            halt: None,
            taken_by: None,
            topped_by: None,
            max_acceleration: acceleration,
            max_deceleration: deceleration,
            max_velocity: velocity,
            jumped: 0.0,
        }
    }

    pub(super) fn switched_on(mut self) -> Self {
        for _ in 0..SWITCHING_ON {
            self.begin();
            self.end();
        }
        self
    }

    pub(super) fn begin(&mut self) {
        self.axis.begin_cycle(&self.drive.feedback());
        Power { regulator_on: true, drive_start: true }.call(true, &mut self.axis);
    }

    pub(super) fn end(&mut self) {
        let command = self.axis.end_cycle();
        self.drive.follow(&command);
        let mut way = command.position - self.shown;
        if let Some(period) = self.axis.period() {
            way -= period * (way / period).round();
        }
        let cycle = self.axis.cycle();
        let commanded = f64::midpoint(self.state.velocity, command.velocity) * cycle;
        let beyond =
            way.abs() > self.max_velocity * cycle && (way - commanded).abs() > way.abs() / 2.0;
        self.jumped = if beyond && command.home.is_none() { way } else { 0.0 };
        // The drive has set a new zero at rest.
        self.shown = match command.home {
            Some(_) => self.drive.feedback().position,
            None => command.position,
        };
        self.state = State {
            position: self.state.position + way,
            velocity: command.velocity,
            acceleration: command.acceleration,
        };
    }

    /// At the end of the job: brakes, unless it follows a master that still moves and brakes itself. Set-points, phase shifts
    /// and superimposed motions brake without a moving master.
    pub(super) fn halt(&mut self, master_moves: bool) {
        let moves = match self.axis.state() {
            AxisState::DiscreteMotion | AxisState::ContinuousMotion => true,
            AxisState::SynchronizedMotion => !master_moves && !self.stands(),
            _ => false,
        };
        if self.halt.is_none() && moves {
            self.halt = Some(Block::new(Halt { deceleration: self.max_deceleration }));
        }
        if let Some(halt) = &mut self.halt {
            halt.call(true, &mut self.axis);
        }
    }

    /// True if its velocity is constant, except for rounding of the acceleration.
    pub(super) fn is_steady(&self) -> bool {
        self.state.acceleration.abs() <= ROUNDING * self.max_acceleration
    }

    pub(super) fn stands(&self) -> bool {
        self.state.velocity == 0.0 && self.state.acceleration == 0.0
    }
}

/// Notes on axes without a jerk limit that blocks move on jerk-limited ramps, with the assumed jerk.
pub(super) fn assumed_jerks(job: &Job, assumed: &[Option<String>]) -> Vec<Finding> {
    let ramp = match job.ramp {
        RampType::Trapezoid => return Vec::new(),
        RampType::Sigmoid => "sigmoid",
        RampType::Parabolic => "parabolic",
    };
    let note = |(axis, said): (usize, &Option<String>)| {
        let call = job.calls.iter().find(|call| call.axis == axis)?;
        let message = format!("`ramp = \"{ramp}\"` needs a jerk: {}", said.as_ref()?);
        let place = Place::at(call.line);
        let mut finding = Finding::error(Rule::FunctionBlock, place, message);
        finding.severity = Severity::Note;
        Some(finding)
    };
    assumed.iter().enumerate().filter_map(note).collect()
}
