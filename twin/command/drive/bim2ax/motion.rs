//! Motion of the axes of a module by hand, and their state before.

use super::super::family::Travel;
use super::super::session::no_clock;
use super::super::words;
use super::Module;
use super::card::of;
use crate::command::Failure;
use std::time::Duration;
use twin_bim2ax::protocol::bits::message;
use twin_bim2ax::protocol::zone::Positions;
use twin_bim2ax::{AxisSettings, MOST_POSITION, ModuleAxis};

impl Module {
    /// What both axes say, none of which moves.
    pub(super) fn at_rest(&mut self, what: &str) -> Result<Positions, Failure> {
        let (seen, _) = self.session.ask(self.card.driver.positions(&no_clock))?;
        if seen.messages.iter().any(|messages| messages & message::MOVING != 0) {
            let port = &self.card.port;
            return Err(Failure::Usage(format!("{port}: an axis moves: `stop` before `{what}`")));
        }
        Ok(seen)
    }

    /// What the module's parameters say about an axis.
    fn settings(&mut self, axis: ModuleAxis) -> Result<AxisSettings, Failure> {
        self.session.ask(self.card.driver.axis_settings(axis, &no_clock))
    }

    pub(super) fn home_axes(
        &mut self,
        axes: &[ModuleAxis],
        timeout: Option<Duration>,
    ) -> Result<(), Failure> {
        use twin_bim2ax::protocol::bits::coefficient::HOME_PLUS;
        let seen = self.at_rest("home")?;
        let mut said = Vec::with_capacity(axes.len());
        let mut patience = Duration::ZERO;
        for axis in axes {
            let of_axis = self.settings(*axis)?;
            let sign = if of_axis.has(HOME_PLUS) { "+" } else { "-" };
            // Whatever the fast speed is (5.1).
            let speed = of_axis.start_stop();
            let longest = timeout.unwrap_or_else(|| homing_time(&of_axis));
            patience = patience.max(longest);
            let way = longest.as_secs_f64() * speed;
            let (from, _) = of(&seen, *axis);
            said.push(format!(
                "axis {} from {from} towards {sign} to its cam, at its start-stop speed of {speed} µsteps/s, {way:.0} µsteps at most",
                axis.number()
            ));
        }
        let longest = patience.as_secs();
        self.consent.ask(&format!("home {}, for {longest} s at most", said.join("; ")))?;
        let after = self.session.motion(&mut self.card, async |card| {
            card.driver.home_to_end(axes, patience, &no_clock).await
        })?;
        let counts_on = self.card.driver.options().assumptions.homing_keeps_position;
        for axis in axes {
            let (number, at) = (axis.number(), of(&after, *axis).0);
            if !counts_on && at != 0 {
                return Err(Failure::Usage(format!(
                    "axis {number} is home, and counts {at} instead of 0: does the module count on through homing? Then say so, here and to runs: \
                     `--assume homing_keeps_position=true`, or `homing_keeps_position = \"true\"` in [drives.assumptions]"
                )));
            }
            say!("axis {number} is home, at {at}");
            if counts_on && at == 0 && of(&seen, *axis).0 != 0 {
                say!(
                    "note: it counts 0 now, though `homing_keeps_position` is assumed; if its home was not at 0 before, that is wrong"
                );
            }
        }
        Ok(())
    }

    pub(super) fn plan_move(
        &mut self,
        axis: ModuleAxis,
        speed: Option<u16>,
        target: &dyn Fn(i32) -> Result<i32, Failure>,
    ) -> Result<Travel<Option<u16>>, Failure> {
        let seen = self.at_rest("move")?;
        let (from, messages) = of(&seen, axis);
        let target = target(from)?;
        let settings = self.settings(axis)?;
        let homed = messages & message::HOMED != 0;
        within(&settings, (axis, homed), target).map_err(Failure::Usage)?;
        let per_s = settings.speed(speed.unwrap_or(settings.fast_speed));
        let number = axis.number();
        let capped = speed.filter(|speed| *speed > settings.fast_speed);
        let capped = capped.map_or(String::new(), |speed| {
            let unit = settings.mode.speed_unit();
            let fast = settings.fast_speed;
            format!(" ({speed} is beyond the fast speed, {fast}; in {unit} µsteps/s each)")
        });
        let gets =
            if messages & message::PHASES_OFF == 0 { "" } else { "; its motor gets current" };
        let question = format!(
            "move axis {number} from {from} to {target} µsteps at {per_s} µsteps/s{capped}{gets}"
        );
        // An axis may approach its target from one side, and go further for that.
        let way = f64::from(target) - f64::from(from);
        let distance = way.abs() + 2.0 * f64::from(settings.approach);
        let patience = words::patience(distance, per_s, settings.rate());
        Ok(Travel { target, question, profile: speed, patience })
    }
}

/// How long homing may take: the way between the soft limits at the start-stop speed, at which all of it goes (5.1).
fn homing_time(axis: &AxisSettings) -> Duration {
    const USUAL: Duration = Duration::from_mins(1);
    const MOST: Duration = Duration::from_hours(1);
    let [low, high] = [axis.soft_minus, axis.soft_plus];
    if low <= -MOST_POSITION && high >= MOST_POSITION {
        // No limits: how long the axis is nobody knows.
        return USUAL;
    }
    // On the cam it leaves it first, goes on by the hysteresis and comes back.
    let way = f64::from(high) - f64::from(low)
        + 2.0 * f64::from(axis.hysteresis)
        + f64::from(axis.origin_stop);
    let time = Duration::try_from_secs_f64((way / axis.start_stop()).max(0.0)).unwrap_or(MOST);
    Duration::from_secs(time.as_secs() + 10).clamp(USUAL, MOST)
}

/// No axis goes beyond what its counter holds; of one that is homed the soft limits count: the module would brake there, short
/// of its target.
fn within(
    settings: &AxisSettings,
    (axis, homed): (ModuleAxis, bool),
    target: i32,
) -> Result<(), String> {
    let number = axis.number();
    if !(-MOST_POSITION..=MOST_POSITION).contains(&target) {
        return Err(format!(
            "axis {number} cannot go to {target} µsteps: its positions are -{MOST_POSITION} to {MOST_POSITION} (nothing was sent)"
        ));
    }
    let [low, high] = [settings.soft_minus, settings.soft_plus];
    if !homed || (low..=high).contains(&target) {
        return Ok(());
    }
    let (limit, sign) = if target > high { (high, '+') } else { (low, '-') };
    Err(format!(
        "axis {number} cannot go to {target} µsteps: its soft limit {sign} is at {limit} µsteps (nothing was sent)"
    ))
}

#[cfg(test)]
mod tests {
    use super::{AxisSettings, Duration, ModuleAxis, homing_time, within};

    #[test]
    fn a_target_beyond_a_soft_limit_of_a_homed_axis_is_refused_with_the_limit() {
        let limited = AxisSettings { soft_minus: -800, soft_plus: 4000, ..<_>::default() };
        let to = |target, homed| within(&limited, (ModuleAxis::Two, homed), target);
        assert_eq!([to(-800, true), to(4000, true), to(9999, false)], [Ok(()), Ok(()), Ok(())]);
        let beyond = to(4001, true).unwrap_err();
        assert!(beyond.contains("axis 2 cannot go to 4001 µsteps: its soft limit + is at 4000"));
        let below = to(-801, true).unwrap_err();
        assert!(below.contains("its soft limit - is at -800 µsteps"), "{below}");
        let counted = to(-4_194_304, false).unwrap_err();
        assert!(counted.contains("its positions are -4194303 to 4194303"), "{counted}");
        assert_eq!(to(4_194_303, false), Ok(()));
    }

    /// 5.1: homing goes at the start-stop speed, here 100 steps/s of 16 µsteps; 480 000 µsteps take 300 s.
    #[test]
    fn homing_has_time_for_the_way_between_the_soft_limits() {
        let unlimited = AxisSettings::default();
        assert_eq!(homing_time(&unlimited), Duration::from_mins(1));
        let limited = AxisSettings { soft_minus: -80_000, soft_plus: 400_000, ..unlimited };
        assert_eq!(homing_time(&limited), Duration::from_secs(310));
        // Off the cam by the hysteresis and back, and on by the way to the origin: 3200 µsteps are 2 s.
        let further = AxisSettings { hysteresis: 1600, origin_stop: 1600, ..limited };
        assert_eq!(homing_time(&further), Duration::from_secs(313));
        let short = AxisSettings { soft_minus: 0, soft_plus: 1600, ..unlimited };
        assert_eq!(homing_time(&short), Duration::from_mins(1));
        let endless = AxisSettings { soft_minus: 0, ..unlimited };
        assert_eq!(homing_time(&endless), Duration::from_secs(2631));
        let slow = AxisSettings { start_stop_speed: 1, ..endless };
        assert_eq!(homing_time(&slow), Duration::from_hours(1));
    }
}
