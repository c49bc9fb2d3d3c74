//! Messages about failed homing by a switch, in terms of the command line.

use crate::clock::Clock;
use crate::command::Failure;
use crate::command::run::Interrupt;
use crate::startup::Still;
use twin_drives::homing::{HomingError, HomingFault, Switch};
use twin_drives::{Drive, SetpointStream, Signals};

/// Search of an axis for its switch.
#[derive(Clone, Copy)]
pub(super) struct Search<'a> {
    pub(super) name: &'a str,
    /// What its increments are called.
    pub(super) unit: &'static str,
    pub(super) switch: Switch,
    /// How far it is sent at a time, increments.
    pub(super) leg: f64,
}

/// What the manual's blocks say, by the options that they come from.
pub(super) fn axis_error(error: &HomingFault) -> String {
    match error {
        HomingFault::NeedsHardwareLimit => {
            "modes 4, 5 and 6 go on in their direction and need the limit switches: without --ignore-limits and --on-limit"
                .to_owned()
        }
        error => error.to_string(),
    }
}

/// A drive that does not show the switch.
pub(super) fn no_switch(switch: Switch, signals: &Signals) -> String {
    match switch {
        Switch::Home => {
            "the drive does not report which input the home switch is at: `--input N` says it, as `inputs` numbers them"
                .to_owned()
        }
        Switch::Input { number, .. } => {
            let count = signals.inputs.count();
            format!("--input {number}: the drive shows {count} inputs, 1 to {count}")
        }
        switch => format!("the drive does not show {switch}"),
    }
}

impl Search<'_> {
    /// What the switch is.
    pub(super) fn place(&self) -> String {
        match self.switch {
            Switch::Input { number, .. } => format!("input {number}"),
            Switch::Home => "its home switch".to_owned(),
            Switch::PositiveLimit | Switch::NegativeLimit => "its limit switch".to_owned(),
        }
    }

    /// Why homing has failed, and what has become of the axis, as every other command says it.
    pub(super) fn failure(
        &self,
        error: &HomingError,
        drive: &mut dyn Drive,
        interrupt: &Interrupt,
    ) -> Failure {
        let why = self.why(error, drive, interrupt);
        // Whether it is at rest has been said.
        let rest = match error {
            HomingError::NotStopped { .. } => String::new(),
            _ => self.rest(drive),
        };
        Failure::Usage(format!("homing {}: {why}{rest}", self.name))
    }

    /// Without the axis, whose only name is that of its drive.
    fn why(&self, error: &HomingError, drive: &mut dyn Drive, interrupt: &Interrupt) -> String {
        match error {
            HomingError::Axis { error: error @ HomingFault::Travel { .. }, .. } => {
                format!("{error}{}", self.looked_for(drive))
            }
            HomingError::Axis { error, .. } => axis_error(error),
            HomingError::Drive(error) => error.to_string(),
            HomingError::NoSwitch { switch, .. } => no_switch(*switch, &Signals::default()),
            HomingError::Moving { .. } => "an axis of the device moves".to_owned(),
            HomingError::NotStopped { why, source } => format!(
                "{}; and the axis could not be stopped: {source}; whether it is at rest is not known, and it may go on for {} {}: use \
                 the emergency stop",
                self.why(why, drive, interrupt),
                self.leg,
                self.unit
            ),
            HomingError::Aborted { .. } => format!("stopped by {}", interrupt.name()),
        }
    }

    /// What a switch that has not come was looked for at, and what that shows.
    fn looked_for(&self, drive: &mut dyn Drive) -> String {
        let clock = Clock::start();
        let signals = drive.signals(&|| clock.now_ns()).ok();
        let pressed = signals.and_then(|signals| self.switch.pressed(&signals, 0));
        let place = self.place();
        let shows = match (self.switch, pressed) {
            (_, None) => String::new(),
            (Switch::Input { pressed: level, .. }, Some(pressed)) => {
                let level = if level == pressed { "on" } else { "off" };
                let counts = if pressed { "pressed" } else { "not pressed" };
                format!(", which is {level}: {counts}")
            }
            (_, Some(true)) => ", which is pressed".to_owned(),
            (_, Some(false)) => ", which is not pressed".to_owned(),
        };
        format!(
            "; looked for at {place}{shows}; is its wire whole, and does `inputs` show it when it is pressed by hand?"
        )
    }

    /// Whether the axis is at rest, and where.
    fn rest(&self, drive: &mut dyn Drive) -> String {
        let stream: &dyn SetpointStream = &Still::new(Clock::start());
        if drive.shows_restart().unwrap_or(false) {
            return "; the device shows itself as after a restart: the position of the axis is not known; `unlock`, then home it again"
                .to_owned();
        }
        let Ok(sample) = drive.probe(stream) else { return "; the axis was stopped".to_owned() };
        let at = sample.position.first().copied().unwrap_or(0);
        let unit = self.unit;
        if sample.moving {
            format!("; the axis brakes, at {at} {unit}")
        } else {
            format!("; the axis is at rest, at {at} {unit}")
        }
    }
}
