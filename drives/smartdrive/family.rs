//! The family as the list of families takes it: keys of a bus, and the way to a drive, an emulator and a prediction.

use std::time::Duration;

use crate::{
    Assumptions, AxisOptions, BusDelays, OUTPUTS, SmartDriveBus, SmartDriveOptions,
    SmartDrivePrediction, StepsPerTurn,
    emulator::{DeviceOptions, EmulatedBus, EmulatorOptions, Wire},
    protocol::parameters,
};
use twin_drives::{
    Drive, DriveError, Prediction,
    family::{
        Abilities, AxisDemand, ConnectError, Connected, Device, DeviceClock, EMULATED_DEADLINE,
        Family, Keys, assumptions, counted, is_assumed_otherwise, microseconds,
    },
};

/// SmartDRIVE devices.
#[derive(Clone, Copy, Debug)]
pub struct SmartDriveFamily;

impl Family for SmartDriveFamily {
    fn kind(&self) -> &'static str {
        "smartdrive"
    }

    fn title(&self) -> &'static str {
        "SmartDRIVE"
    }

    fn axis_key(&self) -> &'static str {
        "drive_address"
    }

    fn axis(&self, keys: &dyn Keys) -> Option<usize> {
        usize::try_from(keys.integer("drive_address", 1..=31)?).ok()
    }

    fn axis_name(&self, index: usize) -> String {
        format!("address {index}")
    }

    fn outputs(&self, axes: usize) -> u32 {
        u32::try_from(axes).unwrap_or_default().saturating_mul(OUTPUTS.into())
    }

    fn misplaced_address(&self, key: &str) -> Option<(String, String)> {
        Some((
            format!(
                "`{key}` does not belong here: on a line of SmartDRIVEs each axis gives the address of its drive"
            ),
            "write `drive_address = …`, 1 to 31, in the [[axes]] that hang on it".to_owned(),
        ))
    }

    fn is_assumed_otherwise(&self, name: &str, value: &str) -> bool {
        is_assumed_otherwise::<Assumptions>(name, value)
    }

    fn read(&self, keys: &dyn Keys) -> Option<Box<dyn Device>> {
        SmartDriveEntry::read(keys).map(|entry| Box::new(entry) as Box<dyn Device>)
    }
}

/// The drives of a bus, which are alike, as a machine file describes them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SmartDriveEntry {
    /// µsteps of a turn of the motor: full steps (parameter 43) times divisor (44).
    pub turn: StepsPerTurn,
    /// Parameter 43.
    pub full_steps: u16,
    /// Parameter 44.
    pub microsteps: u16,
    /// Acceleration of their ramps, rpm/s; at most parameter 31.
    pub acceleration_rpm_per_s: u16,
    /// Deceleration, rpm/s, at most parameter 32; 0: as the acceleration.
    pub deceleration_rpm_per_s: u16,
    /// Assumptions where the manual is silent.
    pub assumptions: Assumptions,
    /// Time an emulated drive takes to answer, µs.
    pub response_us: u32,
}

impl SmartDriveEntry {
    fn read(keys: &dyn Keys) -> Option<Self> {
        let full_steps = keys.integer("full_steps_per_turn", 1..=32_767).unwrap_or(200);
        let divisor = keys.integer("microsteps", 1..=1024).unwrap_or(16);
        let acceleration = keys.integer("acceleration_rpm_per_s", 1..=32_767).unwrap_or(30_000);
        let deceleration = keys.integer("deceleration_rpm_per_s", 0..=32_767).unwrap_or(0);
        let response_us = microseconds(keys, "emulated_turnaround_ms", 2.0);
        let [full_steps, microsteps] = [full_steps, divisor].map(u16::try_from);
        let (full_steps, microsteps) = (full_steps.ok()?, microsteps.ok()?);
        let turn = StepsPerTurn::new(full_steps, microsteps);
        if turn.is_none() {
            let message = format!("`microsteps` is {divisor}; a step has 1, 2, 4, … or 1024");
            keys.complain("microsteps", message);
        }
        Some(Self {
            turn: turn?,
            full_steps,
            microsteps,
            acceleration_rpm_per_s: u16::try_from(acceleration).ok()?,
            deceleration_rpm_per_s: u16::try_from(deceleration).ok()?,
            assumptions: assumptions(keys),
            response_us,
        })
    }

    /// Settings of the drive of an axis.
    pub fn axis(&self, demand: &AxisDemand) -> AxisOptions {
        let velocity = counted(self.turn.rpm(demand.speed), 32_767);
        AxisOptions {
            address: u8::try_from(demand.index).unwrap_or(0),
            turn: self.turn,
            velocity_rpm: u16::try_from(velocity).unwrap_or(32_767),
            acceleration_rpm_per_s: self.acceleration_rpm_per_s,
            deceleration_rpm_per_s: self.deceleration_rpm_per_s,
        }
    }

    fn axes(&self, demands: &[AxisDemand]) -> Vec<AxisOptions> {
        demands.iter().map(|demand| self.axis(demand)).collect()
    }
}

impl Device for SmartDriveEntry {
    fn family(&self) -> &'static dyn Family {
        &SmartDriveFamily
    }

    fn copied(&self) -> Box<dyn Device> {
        Box::new(self.clone())
    }

    /// Speeds are whole turns per minute; a quarter of the largest is one, too.
    fn abilities(&self) -> Abilities {
        let speeds = self.turn.steps(4.0)..=self.turn.steps(f64::from(i16::MAX));
        Abilities { speeds, counts: f64::from(i32::MAX), start_stop: None }
    }

    fn response_us(&self) -> u32 {
        self.response_us
    }

    fn expect_response_us(&mut self, response_us: u32) {
        self.response_us = response_us;
    }

    fn waits(&self, said: Option<Duration>) -> [Duration; 2] {
        let usual = SmartDriveOptions::new(Vec::new());
        [said.unwrap_or(usual.deadline), usual.worst_latency]
    }

    fn open(
        &self,
        port: &str,
        axes: &[AxisDemand],
        [deadline, worst_latency]: [Duration; 2],
    ) -> Result<Box<dyn Drive>, DriveError> {
        let options = SmartDriveOptions {
            assumptions: self.assumptions,
            deadline,
            worst_latency,
            ..SmartDriveOptions::new(self.axes(axes))
        };
        Ok(Box::new(SmartDriveBus::open(port, &options)?))
    }

    fn emulate(
        &self,
        demands: &[AxisDemand],
        clock: DeviceClock,
    ) -> Result<Connected, ConnectError> {
        let axes = self.axes(demands);
        let devices = axes.iter().map(|axis| DeviceOptions {
            address: axis.address,
            assumptions: self.assumptions,
            ..DeviceOptions::default()
        });
        let response = Duration::from_micros(self.response_us.into());
        let options = EmulatorOptions {
            devices: devices.collect(),
            wire: Wire { response, ..Wire::default() },
            ..EmulatorOptions::default()
        };
        let emulator = EmulatedBus::start(&options, clock)?;
        let port = emulator.path().display().to_string();
        let options = SmartDriveOptions {
            deadline: EMULATED_DEADLINE,
            assumptions: self.assumptions,
            ..SmartDriveOptions::new(axes.clone())
        };
        let mut bus = SmartDriveBus::open(&port, &options)?;
        // Emulated drives come from the factory: they get the parameters that real ones have been given.
        bus.run(async |bus| {
            for (axis, demand) in axes.iter().zip(demands) {
                let [lowest, highest] = demand.limits.unwrap_or_default();
                let deceleration = axis.deceleration_rpm_per_s.max(axis.acceleration_rpm_per_s);
                for (parameter, value) in [
                    (parameters::FULL_STEPS, i64::from(self.full_steps)),
                    (parameters::STEP_DIVISOR, self.microsteps.into()),
                    (parameters::VELOCITY_MAX, axis.velocity_rpm.into()),
                    (parameters::ACCELERATION_MAX, axis.acceleration_rpm_per_s.into()),
                    (parameters::DECELERATION_MAX, deceleration.into()),
                    (parameters::POSITION_MIN, lowest.into()),
                    (parameters::POSITION_MAX, highest.into()),
                ] {
                    bus.set_parameter(axis.address, parameter, value).await?;
                }
            }
            Ok::<_, DriveError>(())
        })?;
        Ok((Box::new(emulator), Box::new(bus)))
    }

    fn prediction(&self, axes: &[AxisDemand]) -> Box<dyn Prediction> {
        let response = Duration::from_micros(self.response_us.into());
        let answers = self.assumptions.answer_length;
        let delays = BusDelays { response, answers, ..BusDelays::default() };
        Box::new(SmartDrivePrediction::new(&self.axes(axes), delays))
    }
}
