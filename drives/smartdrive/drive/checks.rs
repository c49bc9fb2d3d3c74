//! Checks of drives: product and version, fault-free operation, rest, and power off.

use std::time::Duration;

use tokio::time::timeout;

use super::{SmartDriveBus, no_clock};
use crate::{
    AxisOptions, Command, DriveState, Fault, Mode, RejectCode, TrajectoryFlags, ZeroRate,
    protocol::parameters::{
        ACCELERATION_MAX, CID, DECELERATION_MAX, FULL_STEPS, PID, STEP_DIVISOR, VELOCITY_MAX,
    },
};
use twin_drives::{Action, Axes, DriveError};

/// `PID` and `CID` of the family.
const PRODUCT: i64 = 0x5342;
const LIST: i64 = 0x0101;

impl SmartDriveBus {
    /// Checks that a drive obeys and has not been stopped.
    pub(super) fn check(
        &self,
        address: u8,
        state: &DriveState,
        action: Action,
    ) -> Result<(), DriveError> {
        let at = || self.bus.at(address, action);
        let expected = Mode::Remote.number();
        if !state.alarms.is_empty() {
            Err(Fault::Alarm(state.alarms).at(at()))
        } else if state.mode != expected {
            Err(DriveError::Mode { at: at(), expected, found: state.mode })
        } else if state.flags.contains(TrajectoryFlags::STALLED) {
            Err(DriveError::Stalled { at: at() })
        } else if state.flags.contains(TrajectoryFlags::LIMITED) && !state.homing {
            Err(DriveError::LimitSwitch { at: at(), axes: Axes::Only })
        } else {
            Ok(())
        }
    }

    /// A refusal for the mode is an alarm if there is one.
    pub(super) fn explain(&mut self, address: u8, error: DriveError) -> DriveError {
        if Fault::rejection(&error) != Some(RejectCode::BadMode) {
            return error;
        }
        match self.state(address, &no_clock) {
            Ok((state, _)) => self.check(address, &state, error.at().action).err().unwrap_or(error),
            Err(error) => error,
        }
    }

    /// Checks that a drive is one, and set as the options say.
    pub(super) fn identify(&mut self, axis: &AxisOptions) -> Result<(), DriveError> {
        let assumed = self.bus.options().assumptions;
        let mut value = |index: u16| {
            let asked = self.runtime.block_on(self.bus.parameter(axis.address, index));
            asked.map(|parameter| parameter.working)
        };
        let product = value(PID)?;
        let list = value(CID)?;
        let turn = value(FULL_STEPS)? * value(STEP_DIVISOR)?;
        let (velocity, acceleration) = (value(VELOCITY_MAX)?, value(ACCELERATION_MAX)?);
        let deceleration = match (value(DECELERATION_MAX)?, assumed.zero_rate) {
            (0, ZeroRate::AsAcceleration) => acceleration,
            (0, ZeroRate::Unlimited) => i64::MAX,
            (ceiling, _) => ceiling,
        };
        let wanted = match axis.deceleration_rpm_per_s {
            0 => axis.acceleration_rpm_per_s,
            rate => rate,
        };
        let exactly = |name, unit, expected: i64, found: i64| {
            (name, unit, expected, found, expected == found)
        };
        let at_least = |name, unit, expected: u16, found: i64| {
            (name, unit, expected.into(), found, found >= expected.into())
        };
        let checks = [
            exactly("PID", "", PRODUCT, product),
            exactly("CID", "", LIST, list),
            exactly("Mot_FullSteps · Mot_StepDivisor", "µsteps", axis.turn.get().into(), turn),
            at_least("Trj_VelMax", "rpm", axis.velocity_rpm, velocity),
            at_least("Trj_AccMax", "rpm/s", axis.acceleration_rpm_per_s, acceleration),
            at_least("Trj_DecMax", "rpm/s", wanted, deceleration),
        ];
        for (name, unit, expected, found, right) in checks {
            if !right {
                let at = self.bus.at(axis.address, Action::ReadState);
                return Err(DriveError::Parameter { at, name, unit, expected, found });
            }
        }
        Ok(())
    }

    /// Asks every drive until it does not move, and notes those that say so; what the first says that does not.
    pub(super) fn wait_for_rest(&mut self, action: Action) -> Result<(), DriveError> {
        let options = self.bus.options();
        let braking = |axis: &AxisOptions| {
            let rate = match axis.deceleration_rpm_per_s {
                0 => axis.acceleration_rpm_per_s,
                rate => rate,
            };
            f64::from(axis.velocity_rpm) / f64::from(rate.max(1))
        };
        let slowest = options.axes.iter().map(braking).fold(0.0, f64::max);
        let count = u32::try_from(options.axes.len()).unwrap_or(1);
        let exchange = 4 * (options.deadline + options.turnaround + options.worst_latency);
        let patience = Duration::from_secs_f64(slowest) + exchange * count;
        let addresses: Vec<u8> = self.axes().collect();
        let mut failed = None;
        for address in addresses {
            let at_rest = async {
                loop {
                    let (state, _) = self.bus.state(address, &no_clock).await?;
                    // An answer from before the stop must not be taken for one of now.
                    if !state.moving() && self.bus.witness(address, &Command::Ping).await? {
                        return Ok(());
                    }
                }
            };
            let rested = self.runtime.block_on(async { timeout(patience, at_rest).await });
            let rested = rested.unwrap_or_else(|_| {
                let at = self.bus.at(address, action);
                Err(DriveError::Moving { at, axes: Axes::Only })
            });
            match rested {
                Ok(()) => self.standing.push(address),
                Err(error) => drop(failed.get_or_insert(error)),
            }
        }
        failed.map_or(Ok(()), Err)
    }

    /// Waits until a drive is off, and switches it off once more if it has not heard.
    pub(super) fn switched_off(&mut self, address: u8, off: &Command) -> Result<(), DriveError> {
        let (state, _) = self.state(address, &no_clock)?;
        // In alarm it is off already.
        if !state.alarms.is_empty() {
            return Ok(());
        }
        if ![Mode::Off.number(), Mode::Changing.number()].contains(&state.mode) {
            match self.runtime.block_on(self.bus.send(address, off, &no_clock)) {
                // It has heard the first one and is changing its mode, whatever it shows: what comes of that is asked next.
                Err(error) if Fault::rejection(&error) == Some(RejectCode::Working) => {}
                sent => drop(sent?),
            }
        }
        let found = match self.runtime.block_on(self.bus.changed(address, off)) {
            Ok(found) => found,
            Err(error) if matches!(error.fault(), Some(Fault::Alarm(_))) => return Ok(()),
            Err(error) => return Err(error),
        };
        let expected = Mode::Off.number();
        if found == expected {
            Ok(())
        } else {
            let at = self.bus.at(address, off.action());
            Err(DriveError::Mode { at, expected, found })
        }
    }
}
