//! The device without hardware: it moves by the common profile generator, and brakes when its master is silent.

use crate::assumptions::Assumptions;
use crate::protocol::{self, AXES, BAUD, Refusal, Request, State, wire_time};
use std::time::Duration;
use twin_drives::EmulatorError;
use twin_drives::Speed;
use twin_drives::emulator_host::{DeviceSpeed, Emulated, Hosting, SerialDevice};
use twin_drives::ramp::{Motion, Ramp, whole_ns};

/// Acceleration and deceleration of every axis, steps/s².
const RATE: f64 = 1e6;
/// From a request to its answer.
const TURNAROUND: Duration = Duration::from_millis(1);

/// A running device.
pub(crate) type EmulatedOwn = Emulated<OwnDevice>;

/// The device.
#[derive(Clone, Debug)]
pub(crate) struct OwnDevice {
    assumptions: Assumptions,
    axes: [Motion; AXES],
    enabled: bool,
    now_ns: i64,
    /// The last request came then.
    heard_ns: i64,
}

fn ramp(speed: f64, target: f64) -> Ramp {
    Ramp { start_stop: 0.0, acceleration: RATE, speed: speed.max(1.0), deceleration: RATE, target }
}

impl OwnDevice {
    fn new(assumptions: Assumptions) -> Self {
        let axes = [Motion::at_rest(0.0); AXES];
        Self { assumptions, axes, enabled: false, now_ns: 0, heard_ns: 0 }
    }

    pub(crate) fn state(&self) -> State {
        State {
            position: self.axes.map(|axis| axis.at(self.now_ns).position.round() as i64),
            moving: self.is_moving(),
            enabled: self.enabled,
        }
    }

    fn is_moving(&self) -> bool {
        self.axes.iter().any(|axis| axis.moving(self.now_ns))
    }

    fn brake(&mut self, at_ns: i64) {
        self.axes = self.axes.map(|axis| Motion::stop(at_ns, axis.at(at_ns), &ramp(1.0, 0.0)));
    }

    fn execute(&mut self, request: Request) -> Result<State, Refusal> {
        let now_ns = self.now_ns;
        match request {
            Request::State => {}
            Request::Enable(false) | Request::Zero(_) if self.is_moving() => {
                return Err(Refusal::Moving);
            }
            Request::Enable(on) => self.enabled = on,
            Request::Zero(position) => {
                self.axes = position.map(|position| Motion::at_rest(position as f64));
            }
            Request::Move(_) if !self.enabled => return Err(Refusal::Locked),
            Request::Move(targets) => {
                for (axis, (target, speed)) in self.axes.iter_mut().zip(targets) {
                    if speed > 0.0 {
                        let state = axis.at(now_ns);
                        *axis = Motion::plan(now_ns, state, &ramp(speed, target as f64));
                    }
                }
            }
            Request::Stop { now: false } => self.brake(now_ns),
            Request::Stop { now: true } => {
                self.axes = self.axes.map(|axis| Motion::at_rest(axis.at(now_ns).position.round()));
                self.enabled = false;
            }
        }
        Ok(self.state())
    }
}

impl SerialDevice for OwnDevice {
    type Options = Assumptions;
    /// Nothing happens to it but what its wire does.
    type Event = ();
    type Seen = State;

    const FAMILY: &'static str = "own";

    fn hosting(_options: &Assumptions) -> Hosting<'_> {
        Hosting { link: None, files: &[], any_speed: true, seed: 0, speed: Speed::REAL }
    }

    fn power_up(options: &Assumptions) -> Result<Self, EmulatorError> {
        Ok(Self::new(*options))
    }

    fn line_speed(&self) -> DeviceSpeed {
        DeviceSpeed::new(BAUD)
    }

    fn seen(&self) -> State {
        self.state()
    }

    fn now_ns(&self) -> i64 {
        self.now_ns
    }

    fn advance_to(&mut self, time_ns: i64) {
        let silent_ns = self.heard_ns.saturating_add(whole_ns(self.assumptions.watchdog));
        if (self.now_ns..time_ns).contains(&silent_ns)
            && self.axes.iter().any(|axis| axis.moving(silent_ns))
        {
            self.brake(silent_ns);
        }
        self.now_ns = self.now_ns.max(time_ns);
    }

    fn happen(&mut self, (): ()) {}

    fn whole(&self, bytes: &[u8]) -> Option<usize> {
        bytes.iter().position(|byte| *byte == b'\n').map(|end| end + 1)
    }

    fn handle(&mut self, frame: &[u8]) -> Option<Vec<u8>> {
        let request = Request::decode(frame)?;
        self.heard_ns = self.now_ns;
        Some(protocol::encode(self.execute(request)))
    }

    fn refuse(&mut self, frame: &[u8], code: u8) -> Option<Vec<u8>> {
        Request::decode(frame).map(|_| protocol::encode(Err(Refusal::Other(code))))
    }

    fn wire_time(&self, bytes: usize) -> Duration {
        wire_time(bytes)
    }

    fn silence(&self) -> Duration {
        Duration::from_millis(5)
    }

    fn before_execution(&self) -> Duration {
        Duration::ZERO
    }

    fn turnaround(&self) -> Duration {
        TURNAROUND
    }
}
