//! Settings of the driver and what follows from them for the wire.

use std::{sync::Arc, time::Duration};

use crate::protocol::line::Execution;

use crate::{Assumptions, emulator::motion::Ceilings, protocol::units::StepsPerTurn};
use twin_drives::{Action, DriveError, Exchange, MAX_DRIVE_AXES};

/// One drive on the bus and the ceilings it is driven with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisOptions {
    /// Address on the bus, 1 to 31.
    pub address: u8,
    /// µsteps of a turn; parameters 43 and 44.
    pub turn: StepsPerTurn,
    /// Largest speed, rpm, at most parameter 30.
    pub velocity_rpm: u16,
    /// Largest acceleration, rpm/s, at most parameter 31.
    pub acceleration_rpm_per_s: u16,
    /// Largest deceleration, rpm/s, at most parameter 32; 0: as the acceleration.
    pub deceleration_rpm_per_s: u16,
}

impl AxisOptions {
    /// The ceilings of a drive whose parameters are these options.
    pub(crate) fn ceilings(&self) -> Ceilings {
        Ceilings {
            turn: self.turn,
            velocity: self.velocity_rpm,
            acceleration: self.acceleration_rpm_per_s,
            deceleration: self.deceleration_rpm_per_s,
            emergency: self.deceleration_rpm_per_s,
            positions: (0, 0),
            assumptions: Assumptions::default(),
        }
    }
}

/// Settings of the driver of a bus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SmartDriveOptions {
    /// Drives in use, one axis each, in the order of the arrays of [`twin_drives::Drive`]; at most five.
    pub axes: Vec<AxisOptions>,
    /// Added to the time that the bytes of an exchange and the turnaround of the drive take: the longest delay of computer and
    /// adapter.
    pub deadline: Duration,
    /// Longest turnaround of drives and adapter until it is measured: a drive confirms a command within 20 to 50 ms.
    pub turnaround: Duration,
    /// Time after which a request or an answer that is late comes no more: a stop is sent again after it, and drives that are out
    /// of step are asked again.
    pub worst_latency: Duration,
    /// Instant at which drives execute commands: samples are stamped with it.
    pub execution: Execution,
    /// Pause of the client between an answer and the next command. Drives take bytes that follow each other within
    /// 10 bit times for one frame; a serial port and its operating system pause longer by themselves.
    pub silence: Duration,
    /// Pause of the client after a broadcast, which nobody answers, in addition to its time on the wire.
    pub broadcast_pause: Duration,
    /// Number of times that a stop without confirmation (broadcast) is sent.
    pub stop_broadcasts: u32,
    /// Longest time a change of mode may take; the manual says about 250 ms.
    pub mode_change: Duration,
    /// Longest time homing may take.
    pub homing: Duration,
    /// Assumptions where the manual is silent.
    pub assumptions: Assumptions,
}

impl SmartDriveOptions {
    /// 20 ms added, 80 ms until the turnaround is measured, stops sent three times, one second for changes of mode, one minute for homing.
    pub fn new(axes: Vec<AxisOptions>) -> Self {
        Self {
            axes,
            deadline: Duration::from_millis(20),
            turnaround: Duration::from_millis(80),
            worst_latency: Duration::from_millis(100),
            execution: Execution::Between,
            silence: Duration::ZERO,
            broadcast_pause: Duration::from_millis(2),
            stop_broadcasts: 3,
            mode_change: Duration::from_secs(1),
            homing: Duration::from_mins(1),
            assumptions: Assumptions::default(),
        }
    }

    /// Checks what no bus could do.
    pub(crate) fn check(&self, port: &Arc<str>) -> Result<(), DriveError> {
        let first = self.axes.first().map_or(0, |axis| axis.address);
        let within = |address, setting, value: u32, low, high| {
            let at = || Exchange { port: Arc::clone(port), address, action: Action::Open };
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                Err(DriveError::Setting { at: at(), setting, value, low, high })
            }
        };
        let count = u32::try_from(self.axes.len()).unwrap_or(u32::MAX);
        let most = u32::try_from(MAX_DRIVE_AXES).unwrap_or(u32::MAX);
        within(first, "number of axes", count, 1, most)?;
        for (index, axis) in self.axes.iter().enumerate() {
            let earlier = self.axes.iter().take(index);
            let same = earlier.filter(|other| other.address == axis.address).count();
            let same = u32::try_from(same).unwrap_or(u32::MAX);
            within(axis.address, "drives with the address of another", same, 0, 0)?;
            within(axis.address, "address", axis.address.into(), 1, 31)?;
            let ceiling =
                |setting, value: u16, low| within(axis.address, setting, value.into(), low, 32_767);
            ceiling("largest speed (rpm)", axis.velocity_rpm, 1)?;
            ceiling("acceleration (rpm/s)", axis.acceleration_rpm_per_s, 1)?;
            ceiling("deceleration (rpm/s)", axis.deceleration_rpm_per_s, 0)?;
        }
        within(first, "broadcasts of a stop", self.stop_broadcasts, 1, 100)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(address: u8) -> AxisOptions {
        AxisOptions {
            address,
            turn: StepsPerTurn::new(200, 16).unwrap(),
            velocity_rpm: 600,
            acceleration_rpm_per_s: 3000,
            deceleration_rpm_per_s: 0,
        }
    }

    #[test]
    fn impossible_settings_are_named() {
        let port: Arc<str> = "p".into();
        let good = SmartDriveOptions::new(vec![axis(1), axis(2)]);
        assert!(good.check(&port).is_ok());
        let refused = |axes: Vec<AxisOptions>| match SmartDriveOptions::new(axes).check(&port) {
            Err(DriveError::Setting { setting, .. }) => setting,
            other => panic!("{other:?}"),
        };
        assert_eq!(refused(vec![]), "number of axes");
        assert_eq!(refused((1..=6).map(axis).collect()), "number of axes");
        assert_eq!(refused(vec![axis(0)]), "address");
        assert_eq!(refused(vec![axis(32)]), "address");
        assert_eq!(refused(vec![axis(2), axis(2)]), "drives with the address of another");
        let slow = AxisOptions { velocity_rpm: 0, ..axis(1) };
        assert_eq!(refused(vec![slow]), "largest speed (rpm)");
        let gentle = AxisOptions { acceleration_rpm_per_s: 0, ..axis(1) };
        assert_eq!(refused(vec![gentle]), "acceleration (rpm/s)");
        let none = SmartDriveOptions { stop_broadcasts: 0, ..good };
        assert!(matches!(none.check(&port), Err(DriveError::Setting { .. })));
    }
}
