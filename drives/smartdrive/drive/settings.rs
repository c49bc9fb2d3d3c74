//! Identity, inputs, parameters and limits of the drives for the trait [`twin_drives::Drive`].

use super::{SmartDriveBus, no_clock};
use crate::{
    IoUpdate, SetEffect, StepsPerTurn, ZeroRate,
    protocol::parameters::{
        ACCELERATION_MAX, ADDRESS, CID, DECELERATION_MAX, Entry, FULL_STEPS, PARAMETERS, PID,
        POSITION_MAX, POSITION_MIN, RELEASE, STEP_DIVISOR, VELOCITY_MAX,
    },
};
use twin_drives::{
    Action, Axes, AxisSignals, Bits, Clock, DeviceLimits, DriveError, Exchange, Identity,
    MAX_DRIVE_AXES, ParameterId, ParameterInfo, Signals, UnitIdentity, find_parameter,
};

/// Outputs of a drive: RDY, BRK, LED.
pub const OUTPUTS: u8 = 3;
/// Outputs of a drive, from bit 0 of IOUPDATE on.
const OUTPUT_NAMES: [&str; 3] = ["RDY", "BRK", "LED"];
/// Inputs of a drive, from bit 3 of IOUPDATE on.
const INPUT_NAMES: [&str; 5] = ["GO", "DIR", "OFF", "LIMP", "LIMN"];
/// Bits of the limit switches.
const LIMP: u8 = 1 << 6;
const LIMN: u8 = 1 << 7;

/// "Release": major in bits 15 to 12, minor in 11 to 4, fix in 3 to 0.
fn release(bits: i64) -> String {
    format!("{}.{}.{}", bits >> 12 & 0xF, bits >> 4 & 0xFF, bits & 0xF)
}

/// A parameter of the drive with this address, which is this axis.
fn describe(entry: &Entry, address: u8, axis: usize) -> ParameterInfo {
    let values = entry.values();
    let id = ParameterId { address, number: entry.index };
    ParameterInfo {
        axis: Some(axis),
        unit: entry.unit,
        writable: entry.writable,
        of_the_line: entry.index == ADDRESS,
        ..ParameterInfo::new(id, entry.name.to_owned(), values)
    }
}

impl SmartDriveBus {
    /// The working value of a parameter.
    fn value(&mut self, address: u8, index: u16) -> Result<i64, DriveError> {
        let asked = self.runtime.block_on(self.bus.parameter(address, index));
        asked.map(|parameter| parameter.working)
    }

    pub(super) fn who(&mut self) -> Result<Identity, DriveError> {
        let addresses: Vec<u8> = self.axes().collect();
        let units = addresses.into_iter().map(|address| {
            let firmware = Some(release(self.value(address, RELEASE)?));
            let details = vec![
                ("PID", format!("{:X}h", self.value(address, PID)?)),
                ("CID", format!("{:X}h", self.value(address, CID)?)),
            ];
            Ok(UnitIdentity { address, firmware, serial: None, details })
        });
        Ok(Identity { family: "SmartDRIVE", units: units.collect::<Result<_, DriveError>>()? })
    }

    pub(super) fn all_signals(&mut self, clock: &dyn Clock) -> Result<Signals, DriveError> {
        let addresses: Vec<u8> = self.axes().collect();
        let sent_ns = clock.now_ns();
        let mut signals = Signals::default();
        let (mut inputs, mut outputs, mut count) = (0_u64, 0_u64, 0_u8);
        for (address, axis) in addresses.into_iter().zip(&mut signals.axes) {
            let shown = self.runtime.block_on(self.bus.io(address, IoUpdate::default()))?;
            outputs |= u64::from(shown.levels & 0b111) << (3 * count);
            inputs |= u64::from(shown.levels >> 3) << (5 * count);
            count += 1;
            // Which input is the home switch lies in CfgHome, which the manual does not explain.
            *axis = AxisSignals {
                positive_limit: Some(shown.levels & LIMP != 0),
                negative_limit: Some(shown.levels & LIMN != 0),
                home: None,
            };
        }
        signals.time_ns = i64::midpoint(sent_ns, clock.now_ns());
        signals.inputs = Bits::new(inputs, 5 * count, &INPUT_NAMES);
        signals.outputs = Bits::new(outputs, 3 * count, &OUTPUT_NAMES);
        Ok(signals)
    }

    pub(super) fn switch_output(&mut self, output: u8, on: bool) -> Result<(), DriveError> {
        let action = Action::SwitchOutput { output, on };
        let place = output.checked_sub(1);
        let axis = place.and_then(|place| self.axes().nth((place / OUTPUTS).into()));
        let Some((place, address)) = place.zip(axis) else {
            let count = u32::try_from(self.axes().count()).unwrap_or(u32::MAX);
            return Err(DriveError::Value {
                at: self.bus.at(self.axes().next().unwrap_or(0), action),
                what: "output",
                value: output.into(),
                unit: "",
                low: 1.0,
                high: f64::from(count) * f64::from(OUTPUTS),
            });
        };
        let mask = 1 << (place % OUTPUTS);
        let (set, clear) = if on { (mask, 0) } else { (0, mask) };
        let update = IoUpdate { clear, set, ..IoUpdate::default() };
        let shown = self.runtime.block_on(self.bus.io(address, update))?;
        if (shown.levels & mask != 0) == on {
            Ok(())
        } else {
            Err(DriveError::NotSwitched { at: self.bus.at(address, action), on })
        }
    }

    pub(super) fn axis_limits(&mut self) -> Result<[DeviceLimits; MAX_DRIVE_AXES], DriveError> {
        let addresses: Vec<u8> = self.axes().collect();
        let mut limits = [DeviceLimits::default(); MAX_DRIVE_AXES];
        let zero_rate = self.bus.options().assumptions.zero_rate;
        for (index, (address, limits)) in addresses.into_iter().zip(&mut limits).enumerate() {
            let mut value = |index| self.value(address, index);
            let narrow = |value: i64| u16::try_from(value).unwrap_or(0);
            let turn = StepsPerTurn::new(narrow(value(FULL_STEPS)?), narrow(value(STEP_DIVISOR)?));
            let mut ceiling = |index| {
                let rpm = narrow(value(index)?);
                Ok::<_, DriveError>(turn.map(|turn| turn.steps(rpm.into())))
            };
            limits.speed = ceiling(VELOCITY_MAX)?;
            limits.acceleration = ceiling(ACCELERATION_MAX)?;
            let deceleration = ceiling(DECELERATION_MAX)?.filter(|rate| *rate > 0.0);
            limits.deceleration = match zero_rate {
                ZeroRate::AsAcceleration => deceleration.or(limits.acceleration),
                ZeroRate::Unlimited => deceleration,
            };
            let (low, high) = (value(POSITION_MIN)?, value(POSITION_MAX)?);
            if low < high {
                let zero = self.zeros.get(index).copied().unwrap_or(0);
                limits.lowest = Some(low.saturating_add(zero));
                limits.highest = Some(high.saturating_add(zero));
            }
        }
        Ok(limits)
    }

    pub(super) fn all_parameters(&self) -> Vec<ParameterInfo> {
        let of_drive =
            |(axis, address)| PARAMETERS.iter().map(move |entry| describe(entry, address, axis));
        self.axes().enumerate().flat_map(of_drive).collect()
    }

    fn parameter_at(&self, id: ParameterId, written: bool) -> Exchange {
        let action = Action::Parameter { number: id.number, name: "parameter", written };
        self.bus.at(id.address, action)
    }

    pub(super) fn read_parameter(&mut self, id: ParameterId) -> Result<i64, DriveError> {
        find_parameter(self.all_parameters(), id, || self.parameter_at(id, false))?;
        self.value(id.address, id.number)
    }

    /// Those whose saved copy is another than the working value.
    pub(super) fn unsaved(&mut self, ids: &[ParameterId]) -> Result<Vec<ParameterId>, DriveError> {
        let mut unsaved = Vec::new();
        for id in ids {
            find_parameter(self.all_parameters(), *id, || self.parameter_at(*id, false))?;
            let asked = self.bus.parameter(id.address, id.number);
            let copies = self.runtime.block_on(asked)?;
            if copies.working != copies.saved {
                unsaved.push(*id);
            }
        }
        Ok(unsaved)
    }

    pub(super) fn write_parameter(
        &mut self,
        id: ParameterId,
        value: i64,
    ) -> Result<(), DriveError> {
        let at = || self.parameter_at(id, true);
        find_parameter(self.all_parameters(), id, at)?.check(value, at)?;
        let index = self.axes().position(|address| address == id.address).unwrap_or(0);
        match self.bus.options().assumptions.set_effect {
            SetEffect::AtOnce => {}
            SetEffect::WithMode => {
                if let Some(outdated) = self.outdated.get_mut(index) {
                    *outdated = true;
                }
            }
            SetEffect::RestartsMode => {
                let seen = self.state(id.address, &no_clock)?;
                if seen.0.moving() {
                    let (at, axes) = (self.parameter_at(id, true), Axes::Only);
                    return Err(DriveError::Moving { at, axes });
                }
                self.restart();
                self.position_lost(index);
            }
        }
        let set = self.bus.set_parameter(id.address, id.number, value);
        self.runtime.block_on(set).map(|_| ())
    }

    /// A drive goes by all its parameters: its mode has begun anew.
    pub(super) fn renewed(&mut self, index: usize) {
        if let Some(outdated) = self.outdated.get_mut(index) {
            *outdated = false;
        }
    }

    /// SAVE for every drive, which makes its position 0.
    pub(super) fn save(&mut self) -> Result<(), DriveError> {
        let seen = self.states(&no_clock)?;
        self.check_rest(&seen)?;
        self.restart();
        let addresses: Vec<u8> = self.axes().collect();
        for (index, address) in addresses.into_iter().enumerate() {
            self.position_lost(index);
            self.runtime.block_on(self.bus.save(address))?;
            self.renewed(index);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use twin_drives::Values;

    /// Digest, section 4: 1020h is release 1.2.0; and its vector 28.
    #[test]
    fn releases_are_three_numbers() {
        assert_eq!(release(0x1020), "1.2.0");
        assert_eq!(release(0xFFFF), "15.255.15");
    }

    #[test]
    fn parameters_are_those_of_the_table() {
        let divisor = PARAMETERS.iter().find(|entry| entry.index == 44).unwrap();
        let info = describe(divisor, 3, 1);
        let powers = (0..=10).map(|power| 1 << power).collect();
        assert_eq!((info.values, info.axis, info.id.address), (Values::OneOf(powers), Some(1), 3));
        let deaf: Vec<_> = PARAMETERS.iter().map(|entry| describe(entry, 1, 0)).collect();
        let deaf = deaf.into_iter().filter(|info| info.of_the_line).map(|info| info.name);
        assert_eq!(deaf.collect::<Vec<_>>(), ["ATB_Address"]);
    }
}
