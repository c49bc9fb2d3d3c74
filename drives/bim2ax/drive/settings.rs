//! Identity, inputs, parameters and limits of a module for the trait [`twin_drives::Drive`].

use super::{Bim2AxDrive, no_clock};
use crate::{
    Assumptions, ModuleAxis,
    protocol::{
        bits::message,
        parameter::{AxisParameter, Parameter, Range},
        zone::Positions,
    },
};
use twin_drives::{
    Action, AxisSignals, Bits, Clock, DeviceLimits, DriveError, Exchange, Identity, MAX_DRIVE_AXES,
    ParameterId, ParameterInfo, Signals, UnitIdentity, find_parameter,
};

/// Inputs of an axis, as the messages show them (2.2.1).
const INPUT_NAMES: [&str; 3] = ["end switch +", "end switch -", "home cam"];
const INPUT_MESSAGES: [u16; 3] = [message::PLUS_SWITCH, message::MINUS_SWITCH, message::ON_CAM];

/// A parameter of a module of this rating, mA; `place` says which axis of the caller's one of the module is.
fn describe(
    number: u16,
    rating_ma: i64,
    assumed: &Assumptions,
    place: impl Fn(ModuleAxis) -> Option<usize>,
) -> Option<ParameterInfo> {
    let parameter = Parameter::from_number(number)?;
    let values = parameter.range().values(rating_ma);
    let unit = match parameter.range() {
        Range::Current => "mA",
        Range::Distance | Range::Position => "µsteps",
        _ => "",
    };
    let axis = match parameter {
        Parameter::Axis(_, axis) => Some(axis),
        _ => None,
    };
    let at_once = matches!(parameter, Parameter::Axis(AxisParameter::HoldingCurrent, _))
        && assumed.holding_current_at_once;
    Some(ParameterInfo {
        axis: axis.and_then(place),
        unit,
        writable: parameter.range() != Range::ReadOnly,
        needs_restart: parameter.needs_reset() && !at_once,
        ..ParameterInfo::new(ParameterId { address: 0, number }, parameter.word(), values)
    })
}

/// The 32 bits of a parameter as a number: with sign where it can have one.
fn number(parameter: Parameter, bits: u32) -> i64 {
    match parameter.range() {
        Range::Position | Range::Signed | Range::ReadOnly => bits.cast_signed().into(),
        _ => bits.into(),
    }
}

/// The 32 bits of a number.
fn bits(value: i64) -> Option<u32> {
    u32::try_from(value).ok().or_else(|| i32::try_from(value).ok().map(i32::cast_unsigned))
}

impl Bim2AxDrive {
    pub(super) fn who(&mut self) -> Result<Identity, DriveError> {
        let identity = self.runtime.block_on(self.module.identify_any(&no_clock))?;
        let Some(identity) = identity else {
            let details = vec![("EEPROM", "its check sum is wrong".to_owned())];
            let unit = UnitIdentity { address: 0, firmware: None, serial: None, details };
            return Ok(Identity { family: "BIM2AX-BOCM", units: vec![unit] });
        };
        let rating = match identity.rating_ma {
            -1 => "unknown".to_owned(),
            rating_ma => format!("{rating_ma} mA"),
        };
        let unit = UnitIdentity {
            address: 0,
            firmware: Some(identity.version.to_string()),
            serial: None,
            details: vec![("current rating", rating)],
        };
        Ok(Identity { family: "BIM2AX-BOCM", units: vec![unit] })
    }

    pub(super) fn all_signals(&mut self, clock: &dyn Clock) -> Result<Signals, DriveError> {
        let (seen, stamp) = self.look(clock)?;
        Ok(self.to_signals(&seen, stamp.middle_ns()))
    }

    fn to_signals(&self, seen: &Positions, time_ns: i64) -> Signals {
        let mut signals = Signals { time_ns, ..Signals::default() };
        let (mut levels, mut count) = (0_u64, 0_u8);
        for (axis, signals) in self.options.axes.iter().zip(&mut signals.axes) {
            let messages = seen.messages.get(axis.index()).copied().unwrap_or(0);
            let [plus, minus, cam] = INPUT_MESSAGES.map(|bit| messages & bit != 0);
            for (on, place) in [plus, minus, cam].into_iter().zip(count..) {
                levels |= u64::from(on) << place;
            }
            count += 3;
            *signals = AxisSignals {
                positive_limit: Some(plus),
                negative_limit: Some(minus),
                home: Some(cam),
            };
        }
        signals.inputs = Bits::new(levels, count, &INPUT_NAMES);
        signals
    }

    /// Parameters $A, $14 and the soft limits, which count once the axis is homed.
    pub(super) fn axis_limits(&mut self) -> Result<[DeviceLimits; MAX_DRIVE_AXES], DriveError> {
        // What a host has written since is to count.
        self.prepare(false)?;
        let mut limits = [DeviceLimits::default(); MAX_DRIVE_AXES];
        for (limits, settings) in limits.iter_mut().zip(&self.settings) {
            *limits = DeviceLimits {
                speed: Some(settings.speed(u16::MAX)),
                acceleration: Some(settings.rate()),
                deceleration: Some(settings.rate()),
                lowest: Some(settings.soft_minus.into()),
                highest: Some(settings.soft_plus.into()),
            };
        }
        Ok(limits)
    }

    pub(super) fn all_parameters(&mut self) -> Result<Vec<ParameterInfo>, DriveError> {
        let asked = self.module.parameter(Parameter::Rating, &no_clock);
        let rating_ma = match self.runtime.block_on(asked) {
            Err(error) if error.takes_writes_only() => -1,
            value => value?.cast_signed(),
        };
        // Where the software does not know its rating, the largest module decides.
        let rating_ma = if rating_ma > 0 { rating_ma } else { 5000 };
        let axes = &self.options.axes;
        let place = |axis| axes.iter().position(|used| *used == axis);
        let assumed = &self.options.driver.assumptions;
        let known =
            (0..=0xFF).filter_map(|number| describe(number, rating_ma.into(), assumed, place));
        Ok(known.collect())
    }

    fn parameter_at(&self, id: ParameterId, written: bool) -> Exchange {
        let name = Parameter::from_number(id.number).map_or("unknown", Parameter::name);
        self.module.at(Action::Parameter { number: id.number, name, written })
    }

    fn known(&self, id: ParameterId, written: bool) -> Result<Parameter, DriveError> {
        let parameter = Parameter::from_number(id.number).filter(|_| id.address == 0);
        let at = || self.parameter_at(id, written);
        parameter.ok_or_else(|| DriveError::NoParameter { at: at(), id })
    }

    pub(super) fn read_parameter(&mut self, id: ParameterId) -> Result<i64, DriveError> {
        let parameter = self.known(id, false)?;
        let asked = self.module.parameter(parameter, &no_clock);
        Ok(number(parameter, self.runtime.block_on(asked)?))
    }

    pub(super) fn write_parameter(
        &mut self,
        id: ParameterId,
        value: i64,
    ) -> Result<(), DriveError> {
        let parameter = self.known(id, true)?;
        let all = self.all_parameters()?;
        let at = || self.parameter_at(id, true);
        let info = find_parameter(all, id, at)?;
        info.check(value, at)?;
        let Some(bits) = bits(value) else {
            return Err(DriveError::ParameterValue { at: at(), id, value, values: info.values });
        };
        // What the driver knows of the axes may be wrong from now on.
        self.settings.clear();
        self.runtime.block_on(self.module.set_parameter(parameter, bits, &no_clock))?;
        let found = match self.read_parameter(id) {
            // The module has confirmed number and value, and nothing more.
            Err(error) if error.takes_writes_only() => return Ok(()),
            found => found?,
        };
        if found == value {
            return Ok(());
        }
        let found = self::bits(found).unwrap_or(0);
        Err(DriveError::NotKept {
            at: self.parameter_at(id, true),
            address: id.number,
            written: bits,
            found,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is described takes what [`Parameter::takes`] takes, at every edge.
    #[test]
    fn described_values_are_those_that_are_taken() {
        for number_of in 0..=0x63 {
            let Some(parameter) = Parameter::from_number(number_of) else { continue };
            let info = describe(number_of, 2000, &Assumptions::default(), |_| None).unwrap();
            let edges = [-5_000_000, -4_194_304, -4_194_303, -1, 0, 1, 27, 28, 59, 60, 2000, 2001]
                .into_iter()
                .chain([0x400, 0x401, 65_535, 65_536, 4_194_303, 4_194_304, i32::MAX, i32::MIN]);
            for value in edges {
                let raw = value.cast_unsigned();
                let takes = parameter.takes(raw, 2000);
                let described = info.writable && info.values.contain(number(parameter, raw));
                assert_eq!(described, takes, "{number_of:X} = {value}");
            }
        }
    }

    #[test]
    fn numbers_keep_their_bits() {
        for value in [0, 1, -1, i64::from(i32::MIN), i64::from(u32::MAX)] {
            let kept = bits(value).unwrap();
            assert_eq!(i64::from(kept).rem_euclid(1 << 32), value.rem_euclid(1 << 32));
        }
        assert_eq!((bits(1 << 32), bits(i64::from(i32::MIN) - 1)), (None, None));
        let one = |axis| (axis == ModuleAxis::Two).then_some(0);
        let usual = Assumptions::default();
        let reference = describe(0x29, 1000, &usual, one).unwrap();
        assert_eq!(reference.name, "reference-position-10-2");
        assert_eq!(
            (reference.axis, describe(0x28, 1000, &usual, |_| None).unwrap().axis),
            (Some(0), None)
        );
    }

    /// The holding current acts after RESET, unless it is assumed to act at once; the motor current always does.
    #[test]
    fn a_restart_is_needed_where_it_is_assumed() {
        for (at_once, number, needed) in [(false, 6, true), (true, 6, false), (true, 4, true)] {
            let assumed = Assumptions { holding_current_at_once: at_once, ..Default::default() };
            let info = describe(number, 2000, &assumed, |_| None).unwrap();
            assert_eq!(info.needs_restart, needed, "{number}");
        }
    }
}
