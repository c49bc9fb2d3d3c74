//! Motion of the axes of an InterpCNC board by hand.

use super::super::family::Travel;
use super::super::session::{BRAKING, RestPosition, Stopping, no_clock};
use super::super::words;
use super::coupled::with_follower;
use super::{HandBoard, Ramps};
use crate::command::Failure;
use std::time::Duration;
use twin_drives::{Action, DriveError};
use twin_interpcnc::protocol::registers::Status;
use twin_interpcnc::{
    AxisValues, BoardAxis, BoardState, InterpCnc, MoveProfile, protocol::parameters,
};

impl Stopping for InterpCnc {
    async fn soft_stop(&mut self) -> Result<(), DriveError> {
        self.ramp_stop(BRAKING, &no_clock).await.map(|_| ())
    }

    async fn hard_stop(&mut self) -> Result<(), DriveError> {
        self.stop_and_lock(&no_clock).await.map(|_| ())
    }

    async fn rest_position(&mut self) -> Result<RestPosition, DriveError> {
        let (state, _) = self.state(&no_clock).await?;
        if state.status.locked() && state.positions == [0; BoardAxis::ALL.len()] {
            return Ok(RestPosition::Lost("the board is locked, and all its counters are 0"));
        }
        let axes = BoardAxis::ALL.into_iter().zip(state.positions);
        let said: Vec<_> = axes.map(|(axis, at)| format!("{axis} {at}")).collect();
        Ok(RestPosition::Known(said.join(", ")))
    }
}

/// Position of an axis.
fn of(state: &BoardState, axis: BoardAxis) -> i32 {
    state.positions.get(axis.index()).copied().unwrap_or(0)
}

impl HandBoard {
    /// The state of a board that obeys and none of whose axes moves.
    fn obeying(&mut self, what: &str) -> Result<BoardState, Failure> {
        let state = self.at_rest(what)?;
        self.board.check_obeys(&state, Action::ReadState)?;
        Ok(state)
    }

    /// The state of a board none of whose axes moves.
    pub(super) fn at_rest(&mut self, what: &str) -> Result<BoardState, Failure> {
        let (state, _) = self.session.ask(self.board.state(&no_clock))?;
        if state.status.moving().is_empty() && !state.status.has(Status::HOMING_IN_PROGRESS) {
            return Ok(state);
        }
        Err(Failure::Usage(format!("an axis moves: `stop` before `{what}`")))
    }

    pub(super) fn plan_move(
        &mut self,
        axis: BoardAxis,
        ramps: Ramps,
        target: &dyn Fn(i32) -> Result<i32, Failure>,
    ) -> Result<Travel<MoveProfile>, Failure> {
        let state = self.obeying("move")?;
        self.follower = self.follower(&[axis], "move")?;
        let from = of(&state, axis);
        let target = target(from)?;
        let also = match self.follower {
            Some(follower) => {
                let at = of(&state, follower);
                // By the same steps; a counter that overflows starts again at the other end.
                let end = at.wrapping_add(target.wrapping_sub(from));
                format!(", {} from {at} to {end}", with_follower(Some(follower)))
            }
            None => String::new(),
        };
        let speed = ramps.speed;
        let question =
            format!("move axis {axis} from {from} to {target} steps at {speed} steps/s{also}");
        let profile = MoveProfile {
            start_stop_hz: ramps.start_stop,
            acceleration_khz_per_s: ramps.acceleration,
            speed_hz: speed,
            deceleration_khz_per_s: ramps.deceleration,
            target,
        };
        let slowest = 1000.0 * f64::from(ramps.acceleration.min(ramps.deceleration));
        let distance = f64::from(target) - f64::from(from);
        let patience = words::patience(distance, speed.into(), slowest);
        Ok(Travel { target, question, profile, patience })
    }

    /// Reports the position of the follower.
    pub(super) fn report_follower(&mut self) -> Result<(), Failure> {
        if let Some(axis) = self.follower {
            let (state, _) = self.session.ask(self.board.state(&no_clock))?;
            say!("axis {axis}, which has gone along, is at {}", of(&state, axis));
        }
        Ok(())
    }

    pub(super) fn home_axes(&mut self, axes: &[BoardAxis], max_stroke: i32) -> Result<(), Failure> {
        let state = self.obeying("home")?;
        self.follower = self.follower(axes, "home")?;
        let follower = self.follower;
        let mut strokes = AxisValues::default();
        let mut said = Vec::with_capacity(axes.len());
        let mut patience = Duration::ZERO;
        for axis in axes {
            let mut parameter = |number| self.session.ask(self.board.parameter(number, &no_clock));
            let input = parameter(parameters::home_input(*axis))?;
            let speed = parameter(parameters::home_speed(*axis))?;
            let positive = parameter(parameters::home_direction(*axis))? == 1;
            if input == 0 {
                let name = axis.to_string().to_lowercase();
                let message = format!(
                    "axis {axis} has no home switch: `set home-input-{name} N` says at which input it is"
                );
                return Err(Failure::Usage(message));
            }
            if let Some(stroke) = strokes.get_mut(axis.index()) {
                *stroke = Some(max_stroke);
            }
            let from = of(&state, *axis);
            let sign = if positive { "+" } else { "-" };
            let also = match follower.filter(|_| *axis == BoardAxis::X) {
                Some(follower) => {
                    format!(", {} from {}", with_follower(Some(follower)), of(&state, follower))
                }
                None => String::new(),
            };
            said.push(format!(
                "axis {axis} from {from} towards {sign} until input {input} says so, {max_stroke} steps at most, at {speed} steps/s{also}"
            ));
            // There, and off the switch much slower; axes may go one after the other.
            patience +=
                words::patience(max_stroke.into(), speed.max(1).into(), f64::from(speed.max(1)));
        }
        let patience = patience.saturating_add(Duration::from_mins(1));
        let longest = patience.as_secs();
        self.consent.ask(&format!("home {}, for {longest} s at most", said.join("; ")))?;
        let state = self.session.motion(&mut self.board, async |board| {
            board.home_machine(&strokes, patience, &no_clock).await
        })?;
        let zeroes =
            self.session.ask(self.board.parameter(parameters::ZERO_AFTER_HOMING, &no_clock))? == 1;
        for axis in axes {
            let position = of(&state, *axis);
            if zeroes && position != 0 {
                return Err(Failure::Usage(format!(
                    "axis {axis} is home, and counts {position} instead of 0, though parameter {} is 1 (zero-after-homing): has something \
                     else moved it or written its counter? `status`, then `home` again",
                    parameters::ZERO_AFTER_HOMING
                )));
            }
            say!("axis {axis} is home, at {position}");
        }
        self.report_follower()?;
        if !zeroes {
            say!(
                "note: the board leaves its counters as they are (zero-after-homing is 0), so that they do not count from home; a run wants \
                 `set zero-after-homing 1`, and homing after that"
            );
        }
        Ok(())
    }
}
