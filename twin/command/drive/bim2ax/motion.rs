//! What moves the axes of a module, and what they have to be like before.

use super::super::consent::Consent;
use super::super::session::{Session, no_clock};
use super::super::words;
use super::module::{Module, of};
use crate::command::Failure;
use std::time::Duration;
use twin_drives::bim2ax::bits::message;
use twin_drives::bim2ax::zone::Positions;
use twin_drives::bim2ax::{AxisSettings, ModuleAxis};

pub(super) fn unlock(
    session: &Session,
    module: &mut Module,
    axes: &[ModuleAxis],
) -> Result<(), Failure> {
    standing(session, module, "unlock")?;
    session.ask(module.driver.energise(axes, &no_clock))?;
    say!("motors have current");
    Ok(())
}

/// What both axes say, none of which moves.
pub(super) fn standing(
    session: &Session,
    module: &mut Module,
    what: &str,
) -> Result<Positions, Failure> {
    let (seen, _) = session.ask(module.driver.positions(&no_clock))?;
    if seen.messages.iter().any(|messages| messages & message::MOVING != 0) {
        let port = &module.port;
        return Err(Failure::Usage(format!("{port}: an axis moves: `stop` before `{what}`")));
    }
    Ok(seen)
}

/// What the module's parameters say about an axis.
fn settings(
    session: &Session,
    module: &mut Module,
    axis: ModuleAxis,
) -> Result<AxisSettings, Failure> {
    session.ask(module.driver.axis_settings(axis, &no_clock))
}

pub(super) fn home(
    session: &Session,
    module: &mut Module,
    consent: Consent,
    axes: &[ModuleAxis],
    patience: Duration,
) -> Result<(), Failure> {
    use twin_drives::bim2ax::bits::coefficient::HOME_PLUS;
    let seen = standing(session, module, "home")?;
    let mut said = Vec::with_capacity(axes.len());
    for axis in axes {
        let of_axis = settings(session, module, *axis)?;
        let sign = if of_axis.has(HOME_PLUS) { "+" } else { "-" };
        let speed = of_axis.speed(of_axis.fast_speed);
        let (from, _) = of(&seen, *axis);
        said.push(format!(
            "axis {} from {from} towards {sign} to its cam, at {speed} µsteps/s at most",
            axis.number()
        ));
    }
    let longest = patience.as_secs();
    consent.ask(&format!("home {}, for {longest} s at most", said.join("; ")))?;
    let seen = session.motion(module, async |module| {
        module.driver.home_to_end(axes, patience, &no_clock).await
    })?;
    for axis in axes {
        say!("axis {} is home, at {}", axis.number(), of(&seen, *axis).0);
    }
    Ok(())
}

pub(super) fn travel(
    session: &Session,
    module: &mut Module,
    consent: Consent,
    axis: ModuleAxis,
    target: i32,
    speed: Option<u16>,
) -> Result<(), Failure> {
    let seen = standing(session, module, "move")?;
    let (from, _) = of(&seen, axis);
    let of_axis = settings(session, module, axis)?;
    let per_s = of_axis.speed(speed.unwrap_or(of_axis.fast_speed));
    let number = axis.number();
    consent
        .ask(&format!("move axis {number} from {from} to {target} µsteps at {per_s} µsteps/s"))?;
    // An axis may approach its target from one side, and go further for that.
    let way = f64::from(target) - f64::from(from);
    let distance = way.abs() + 2.0 * f64::from(of_axis.approach);
    let patience = words::patience(distance, per_s, of_axis.rate());
    session.motion(module, async |module| {
        module.driver.travel(axis, (target, speed), patience, &no_clock).await
    })?;
    say!("axis {number} stands at {target}");
    Ok(())
}
