//! What moves a SmartDRIVE, and what it has to be like before.

use super::super::consent::Consent;
use super::super::session::Session;
use super::super::words;
use super::Ramps;
use super::axis::Axis;
use super::show::{mode, turns};
use crate::command::Failure;
use twin_drives::smartdrive::parameters::{self, FULL_STEPS, STEP_DIVISOR};
use twin_drives::smartdrive::{DriveState, Mode};

/// The state of a drive that obeys and does not move.
pub(super) fn standing(
    session: &Session,
    axis: &mut Axis,
    what: &str,
) -> Result<DriveState, Failure> {
    let state = session.ask(axis.state())?;
    if turns(&state) {
        let message =
            format!("{}: it moves, which `{what}` could end or spoil: `stop` first", axis.at());
        return Err(Failure::Usage(message));
    }
    Ok(state)
}

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

/// The same, which has to obey the bus.
fn obeying(session: &Session, axis: &mut Axis, what: &str) -> Result<DriveState, Failure> {
    let state = standing(session, axis, what)?;
    if state.mode != Mode::Remote.number() {
        let message = format!("{}: it is in mode {}: `unlock` first", axis.at(), mode(state.mode));
        return Err(Failure::Usage(message));
    }
    Ok(state)
}

pub(super) fn home(session: &Session, axis: &mut Axis, consent: Consent) -> Result<(), Failure> {
    let from = obeying(session, axis, "home")?.position;
    let address = axis.address;
    let mut working =
        |index| session.ask(axis.bus.parameter(address, index)).map(|copies| copies.working);
    let enter = working(parameters::VELOCITY_ENTER_HOME)?;
    let offset = working(parameters::POSITION_OFFSET)?;
    let configured = working(parameters::HOME_CONFIGURATION)?;
    let longest = axis.bus.options().homing.as_secs();
    consent.ask(&format!(
        "home the axis at address {address} from {from} to its switch, which is at {offset} µsteps, at {enter} rpm, for {longest} s \
         at most, in the direction that the drive is set to (CfgHome is {configured}, which its manual does not explain: the \
         axis may go either way)"
    ))?;
    let position = session.motion(axis, async |axis| axis.bus.home(address).await)?;
    say!("home, at {position}");
    Ok(())
}

pub(super) fn travel(
    session: &Session,
    axis: &mut Axis,
    consent: Consent,
    target: i32,
    ramps: Ramps,
) -> Result<(), Failure> {
    let from = obeying(session, axis, "move")?.position;
    let address = axis.address;
    let mut working = |index| {
        let value = session.ask(axis.bus.parameter(address, index))?.working;
        Ok::<u16, Failure>(u16::try_from(value).unwrap_or(u16::MAX))
    };
    let largest = [working(parameters::VELOCITY_MAX)?, working(parameters::ACCELERATION_MAX)?];
    let turn = f64::from(working(FULL_STEPS)?) * f64::from(working(STEP_DIVISOR)?);
    let mut limit =
        |index| session.ask(axis.bus.parameter(address, index)).map(|copies| copies.working);
    let limits = [limit(parameters::POSITION_MIN)?, limit(parameters::POSITION_MAX)?];
    within(limits, target).map_err(|why| Failure::Usage(format!("{}: {why}", axis.at())))?;
    let [speed, acceleration] = largest;
    // More than its ceilings no drive does.
    let speed = ramps.speed.map_or(speed, |wanted| wanted.min(speed));
    let acceleration = ramps.acceleration.map_or(acceleration, |wanted| wanted.min(acceleration));
    consent.ask(&format!(
        "move the axis at address {address} from {from} to {target} µsteps at {speed} rpm"
    ))?;
    let per_s = |rpm: u16| f64::from(rpm.max(1)) * turn / 60.0;
    let distance = f64::from(target) - f64::from(from);
    let patience = words::patience(distance, per_s(speed), per_s(acceleration));
    let profile = Some((speed, acceleration));
    session.motion(axis, async |axis| axis.bus.travel(address, target, profile, patience).await)?;
    say!("stands at {target}");
    Ok(())
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
