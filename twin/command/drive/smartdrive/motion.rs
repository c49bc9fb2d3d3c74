//! Motion of a SmartDRIVE by hand, and its state before.

use super::super::family::Travel;
use super::super::words;
use super::Ramps;
use super::axis::{Axis, Unit};
use super::show::{mode, turns};
use crate::command::Failure;
use twin_smartdrive::protocol::parameters::{self, FULL_STEPS, STEP_DIVISOR};
use twin_smartdrive::{DriveState, Mode};

/// No drive goes beyond its position limits, which count where the lower is below the upper.
fn within([low, high]: [i64; 2], target: i32) -> Result<(), String> {
    let target = i64::from(target);
    if low >= high || (low..=high).contains(&target) {
        return Ok(());
    }
    let (name, index, limit) = if target < low {
        ("Trj_PosMin", parameters::POSITION_MIN, low)
    } else {
        ("Trj_PosMax", parameters::POSITION_MAX, high)
    };
    Err(format!(
        "it cannot go to {target} µsteps: {name} (parameter {index}) is {limit} µsteps (nothing was sent)"
    ))
}

impl Axis {
    /// The state of a drive that does not move.
    pub(super) fn at_rest(&mut self, what: &str) -> Result<DriveState, Failure> {
        let state = self.session.ask(self.unit.state())?;
        if turns(&state) {
            let at = self.unit.at();
            let message = format!("{at}: the axis moves: `stop` before `{what}`");
            return Err(Failure::Usage(message));
        }
        Ok(state)
    }

    /// The same, which has to obey the bus.
    fn obeying(&mut self, what: &str) -> Result<DriveState, Failure> {
        let state = self.at_rest(what)?;
        if state.mode != Mode::Remote.number() {
            let (at, mode) = (self.unit.at(), mode(state.mode));
            let message = format!("{at}: it is in mode {mode}: `unlock` first");
            return Err(Failure::Usage(message));
        }
        Ok(state)
    }

    /// The working value of a parameter.
    fn working(&mut self, index: u16) -> Result<i64, Failure> {
        let Unit { bus, address, .. } = &mut self.unit;
        Ok(self.session.ask(bus.parameter(*address, index))?.working)
    }

    pub(super) fn home_axis(&mut self) -> Result<(), Failure> {
        let from = self.obeying("home")?.position;
        let address = self.unit.address;
        let enter = self.working(parameters::VELOCITY_ENTER_HOME)?;
        let offset = self.working(parameters::POSITION_OFFSET)?;
        let configured = self.working(parameters::HOME_CONFIGURATION)?;
        let longest = self.unit.bus.options().homing.as_secs();
        self.consent.ask(&format!(
            "home the axis at address {address} from {from} to its switch, which is at {offset} µsteps, at {enter} rpm, for {longest} s \
             at most, in the direction that the drive is set to (CfgHome is {configured}, which its manual does not explain: the \
             axis may go either way)"
        ))?;
        let position =
            self.session.motion(&mut self.unit, async |unit| unit.bus.home(address).await)?;
        say!("home, at {position}");
        Ok(())
    }

    pub(super) fn plan_move(
        &mut self,
        ramps: Ramps,
        target: &dyn Fn(i32) -> Result<i32, Failure>,
    ) -> Result<Travel<(u16, u16)>, Failure> {
        let from = self.obeying("move")?.position;
        let target = target(from)?;
        let narrow = |value: i64| u16::try_from(value).unwrap_or(u16::MAX);
        let speed = narrow(self.working(parameters::VELOCITY_MAX)?);
        let acceleration = narrow(self.working(parameters::ACCELERATION_MAX)?);
        let full_steps = narrow(self.working(FULL_STEPS)?);
        let turn = f64::from(full_steps) * f64::from(narrow(self.working(STEP_DIVISOR)?));
        let low = self.working(parameters::POSITION_MIN)?;
        let limits = [low, self.working(parameters::POSITION_MAX)?];
        let at = self.unit.at();
        within(limits, target).map_err(|why| Failure::Usage(format!("{at}: {why}")))?;
        // More than its ceilings no drive does.
        let speed = ramps.speed.map_or(speed, |wanted| wanted.min(speed));
        let acceleration =
            ramps.acceleration.map_or(acceleration, |wanted| wanted.min(acceleration));
        let address = self.unit.address;
        let question = format!(
            "move the axis at address {address} from {from} to {target} µsteps at {speed} rpm"
        );
        let per_s = |rpm: u16| f64::from(rpm.max(1)) * turn / 60.0;
        let distance = f64::from(target) - f64::from(from);
        let patience = words::patience(distance, per_s(speed), per_s(acceleration));
        Ok(Travel { target, question, profile: (speed, acceleration), patience })
    }
}

#[cfg(test)]
mod tests {
    use super::within;

    /// `PAR_Trj_PosMin` and `PAR_Trj_PosMax`, 26 and 28.
    #[test]
    fn a_target_beyond_a_position_limit_is_refused_with_the_limit() {
        assert_eq!([within([-5, 9], -5), within([-5, 9], 9)], [Ok(()), Ok(())]);
        assert_eq!([within([0, 0], i32::MAX), within([7, -7], 99)], [Ok(()), Ok(())]);
        let beyond = within([-5, 9], 10).unwrap_err();
        assert!(beyond.contains("to 10 µsteps: Trj_PosMax (parameter 28) is 9 µsteps"), "{beyond}");
        let below = within([-5, 9], -6).unwrap_err();
        assert!(below.contains("Trj_PosMin (parameter 26) is -5 µsteps"), "{below}");
    }
}
