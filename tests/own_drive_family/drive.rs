//! The device as a [`Drive`].

use crate::client::Client;
use crate::protocol::{AXES, Request, State};
use std::time::Duration;
use twin_drives::{
    Action, Drive, DriveError, Identity, Increments, MAX_DRIVE_AXES, Sample, SetpointStream,
    UnitIdentity,
};

/// Moves aim at the plan this far ahead: a master that dies leaves no longer a move behind, ns.
pub(crate) const AHEAD_NS: i64 = 40_000_000;

/// A device with three axes; increments are steps.
#[derive(Debug)]
pub(crate) struct OwnDrive {
    client: Client,
    axes: usize,
    /// Positions of the last sample.
    seen: [i64; AXES],
}

impl OwnDrive {
    pub(crate) fn open(port: &str, axes: usize, deadline: Duration) -> Result<Self, DriveError> {
        Ok(Self { client: Client::open(port, deadline)?, axes, seen: [0; AXES] })
    }

    fn sampled(&mut self, before_ns: i64, after_ns: i64, state: State) -> Sample {
        self.seen = state.position;
        let mut position = [0; MAX_DRIVE_AXES];
        position[..AXES].copy_from_slice(&state.position);
        Sample { time_ns: i64::midpoint(before_ns, after_ns), position, moving: state.moving }
    }

    fn ask(
        &mut self,
        stream: &dyn SetpointStream,
        name: &'static str,
        request: Request,
    ) -> Result<(Sample, State), DriveError> {
        let before_ns = stream.now_ns();
        let state = self.client.ask(name, request)?;
        Ok((self.sampled(before_ns, stream.now_ns(), state), state))
    }
}

impl Drive for OwnDrive {
    fn describe(&self) -> String {
        format!("own device at {}", self.client.at(Action::Open).port)
    }

    fn axis_count(&self) -> usize {
        self.axes
    }

    fn identity(&mut self) -> Result<Identity, DriveError> {
        self.client.ask("state", Request::State)?;
        Ok(Identity { family: "Own", units: vec![UnitIdentity::default()] })
    }

    fn probe(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        Ok(self.ask(stream, "state", Request::State)?.0)
    }

    fn enable(&mut self) -> Result<(), DriveError> {
        self.client.ask("enable", Request::Enable(true)).map(drop)
    }

    fn disable(&mut self) -> Result<(), DriveError> {
        self.client.ask("lock", Request::Enable(false)).map(drop)
    }

    fn set_output(&mut self, output: u8, _on: bool) -> Result<(), DriveError> {
        let at = self.client.at(Action::SwitchOutput { output, on: false });
        Err(DriveError::Unsupported { at, what: "outputs" })
    }

    fn set_position(&mut self, position: &Increments) -> Result<(), DriveError> {
        let [a, b, c, ..] = *position;
        self.client.ask("zero", Request::Zero([a, b, c])).map(drop)
    }

    fn move_to(
        &mut self,
        target: &Increments,
        speed: &[f64; MAX_DRIVE_AXES],
    ) -> Result<(), DriveError> {
        let axes = std::array::from_fn(|axis| (target[axis], speed[axis]));
        self.client.ask("move", Request::Move(axes)).map(drop)
    }

    fn sample(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        let (sample, state) = self.ask(stream, "state", Request::State)?;
        if state.enabled {
            Ok(sample)
        } else {
            Err(DriveError::Locked { at: self.client.at(Action::ReadState) })
        }
    }

    /// One move of all axes towards the plan ahead, at the speed that brings them there in time.
    fn follow(&mut self, stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        let ahead = stream.at(stream.now_ns() + AHEAD_NS);
        let axes = std::array::from_fn(|axis| {
            let target = ahead.position[axis].round() as i64;
            let way = (target - self.seen[axis]).unsigned_abs() as f64;
            (target, way / (AHEAD_NS as f64 * 1e-9))
        });
        self.ask(stream, "move", Request::Move(axes)).map(|(sample, _)| sample)
    }

    fn soft_stop(&mut self) -> Result<(), DriveError> {
        self.client.ask("stop", Request::Stop { now: false }).map(drop)
    }

    fn hard_stop(&mut self) -> Result<(), DriveError> {
        self.client.ask("halt", Request::Stop { now: true }).map(drop)
    }
}
