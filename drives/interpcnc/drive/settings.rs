//! Identity, inputs, parameters and limits of the board for the trait [`twin_drives::Drive`].

use super::{InterpCncDrive, no_clock};
use crate::protocol::{
    parameters::{self, FIRST_PARAMETER, PARAMETERS},
    registers::{BoardAxis, MAX_SPEED_HZ},
};
use twin_drives::{
    Action, AxisSignals, Bits, Clock, DeviceLimits, DriveError, Exchange, Identity, MAX_DRIVE_AXES,
    ParameterId, ParameterInfo, Signals, UnitIdentity, find_parameter,
};

/// Names of inputs and outputs.
const INPUT_NAMES: [&str; 32] = [
    "IN1", "IN2", "IN3", "IN4", "IN5", "IN6", "IN7", "IN8", "IN9", "IN10", "IN11", "IN12", "IN13",
    "IN14", "IN15", "IN16", "IN17", "IN18", "IN19", "IN20", "IN21", "IN22", "IN23", "IN24", "IN25",
    "IN26", "IN27", "IN28", "IN29", "IN30", "IN31", "IN32",
];
const OUTPUT_NAMES: [&str; 32] = [
    "OUT1", "OUT2", "OUT3", "OUT4", "OUT5", "OUT6", "OUT7", "OUT8", "OUT9", "OUT10", "OUT11",
    "OUT12", "OUT13", "OUT14", "OUT15", "OUT16", "OUT17", "OUT18", "OUT19", "OUT20", "OUT21",
    "OUT22", "OUT23", "OUT24", "OUT25", "OUT26", "OUT27", "OUT28", "OUT29", "OUT30", "OUT31",
    "OUT32",
];
/// Parameters up to the last that says what an input is for.
const INPUT_PARAMETERS: u16 = 124;

/// Largest number of parameters that are asked for one by one; more by asking for all.
const AT_ONCE: usize = 7;

/// An input and the level that it has on its switch.
type Switch = Option<(u8, bool)>;

/// What the inputs are for, by the board's parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Wiring {
    axes: [AxisSwitches; MAX_DRIVE_AXES],
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct AxisSwitches {
    positive: Switch,
    negative: Switch,
    home: Switch,
}

impl Wiring {
    /// Of axes, by parameters 0 to 123.
    fn new(parameters: &[u32], axes: impl Iterator<Item = BoardAxis>) -> Self {
        let value = |number: u16| parameters.get(usize::from(number)).copied().unwrap_or(0);
        let switch = |number: u16, closed: bool| {
            let input =
                u8::try_from(value(number)).ok().filter(|input| (1..=32).contains(input))?;
            Some((input, !closed))
        };
        let mut wiring = Self::default();
        for (switches, axis) in wiring.axes.iter_mut().zip(axes) {
            let limit = |positive| {
                let number = parameters::limit_input(axis, positive);
                switch(number, value(number + 1) == 1)
            };
            let polarity = value(parameters::HOME_POLARITY);
            let home_closed = polarity & u32::from(axis.mask().bits()) != 0;
            switches.positive = limit(true);
            switches.negative = limit(false);
            switches.home = switch(parameters::home_input(axis), home_closed);
        }
        wiring
    }

    /// What inputs with these levels say about the axes.
    fn signals(&self, inputs: &Bits) -> [AxisSignals; MAX_DRIVE_AXES] {
        let on = |switch: Switch| {
            let (input, level) = switch?;
            inputs.get(input).map(|found| found == level)
        };
        self.axes.map(|switches| AxisSignals {
            positive_limit: on(switches.positive),
            negative_limit: on(switches.negative),
            home: on(switches.home),
        })
    }
}

impl InterpCncDrive {
    pub(super) fn who(&mut self) -> Result<Identity, DriveError> {
        let identity = self.runtime.block_on(self.board.identify(&no_clock))?;
        let recipes = if identity.has_recipes { "yes, firmware 5.30 or later" } else { "no" };
        let line = identity.line.map_or_else(
            || format!("codes {} and {}", identity.speed, identity.parity),
            |line| format!("{} baud, {}", line.baud, line.parity),
        );
        let unit = UnitIdentity {
            address: self.board.options().address,
            firmware: None,
            serial: None,
            details: vec![
                ("address by parameter 103", identity.address.to_string()),
                ("line", line),
                ("recipes", recipes.to_owned()),
            ],
        };
        Ok(Identity { family: "InterpCNC", units: vec![unit] })
    }

    pub(super) fn all_signals(&mut self, clock: &dyn Clock) -> Result<Signals, DriveError> {
        let wiring = if let Some(wiring) = self.wiring {
            wiring
        } else {
            let asked = self.board.parameters(0, INPUT_PARAMETERS, &no_clock);
            let values = self.runtime.block_on(asked)?;
            Wiring::new(&values, self.axes())
        };
        self.wiring = Some(wiring);
        let sent_ns = clock.now_ns();
        let found = self.runtime.block_on(self.board.snapshot(clock))?;
        let inputs = Bits::new(found.inputs.into(), 32, &INPUT_NAMES);
        Ok(Signals {
            time_ns: i64::midpoint(sent_ns, clock.now_ns()),
            inputs,
            outputs: Bits::new(found.outputs.into(), 32, &OUTPUT_NAMES),
            enable: Some(!found.state.status.enable_open()),
            axes: wiring.signals(&inputs),
        })
    }

    /// The board clamps speeds; accelerations come with every move, and it has no limits of positions.
    pub(super) fn axis_limits(&self) -> [DeviceLimits; MAX_DRIVE_AXES] {
        let mut limits = [DeviceLimits::default(); MAX_DRIVE_AXES];
        for (limits, _) in limits.iter_mut().zip(self.axes()) {
            limits.speed = Some(MAX_SPEED_HZ.into());
        }
        limits
    }

    fn parameter_at(&self, id: ParameterId, written: bool) -> Exchange {
        let address = FIRST_PARAMETER.saturating_add(id.number.saturating_mul(2));
        self.board.at(if written {
            Action::Write { what: "parameter", address, count: 2 }
        } else {
            Action::Read { what: "parameter", address, count: 2 }
        })
    }

    pub(super) fn all_parameters(&self) -> Vec<ParameterInfo> {
        let in_use: Vec<_> = self.axes().collect();
        let place = |axis| in_use.iter().position(|used| *used == axis);
        (0..PARAMETERS).map(|number| parameters::describe(number, place)).collect()
    }

    pub(super) fn read_parameter(&mut self, id: ParameterId) -> Result<i64, DriveError> {
        find_parameter(self.all_parameters(), id, || self.parameter_at(id, false))?;
        let value = self.runtime.block_on(self.board.parameter(id.number, &no_clock))?;
        Ok(value.into())
    }

    /// Many at a time: all of them take seven exchanges.
    pub(super) fn read_parameters(&mut self, ids: &[ParameterId]) -> Result<Vec<i64>, DriveError> {
        if ids.len() <= AT_ONCE {
            return ids.iter().map(|id| self.read_parameter(*id)).collect();
        }
        let asked = self.board.parameters(0, PARAMETERS, &no_clock);
        let all = self.runtime.block_on(asked)?;
        let value = |id: &ParameterId| {
            let value = all.get(usize::from(id.number)).filter(|_| id.address == 0);
            let none = || DriveError::NoParameter { at: self.parameter_at(*id, false), id: *id };
            value.map(|value| i64::from(*value)).ok_or_else(none)
        };
        ids.iter().map(value).collect()
    }

    pub(super) fn write_parameter(
        &mut self,
        id: ParameterId,
        value: i64,
    ) -> Result<(), DriveError> {
        let at = || self.parameter_at(id, true);
        let info = find_parameter(self.all_parameters(), id, at)?;
        info.check(value, at)?;
        let Ok(bits) = u32::try_from(value) else {
            return Err(DriveError::ParameterValue { at: at(), id, value, values: info.values });
        };
        self.wiring = None;
        let options = self.board.options();
        // Four registers' writes and the exchanges around them.
        let eeprom = std::time::Duration::from_nanos(
            u64::try_from(options.assumptions.eeprom_write_ns).unwrap_or(0).saturating_mul(4),
        );
        let patience = eeprom + options.patience();
        let kept = self.board.set_parameter(id.number, bits, patience, &no_clock);
        self.runtime.block_on(kept)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parameters 104 to 123, 29 and 32: X− on IN3 (NO), Y+ on IN4 (NC), home switches of X on IN5 (NO), Y on IN6 (NC).
    #[test]
    fn parameters_say_what_inputs_are_for() {
        let mut parameters = [0; 124];
        for (number, value) in
            [(104, 3), (105, 0), (110, 4), (111, 1), (29, 5), (30, 6), (32, 0b10), (112, 33)]
        {
            parameters[number] = value;
        }
        let axes = [BoardAxis::Y, BoardAxis::X, BoardAxis::Z];
        let wiring = Wiring::new(&parameters, axes.into_iter());
        let [y, x, z, ..] = wiring.signals(&Bits::new(0b1_0100, 32, &INPUT_NAMES));
        let (on, off) = (Some(true), Some(false));
        assert_eq!((x.positive_limit, x.negative_limit, x.home), (None, on, on));
        // Both of Y's are normally closed and their inputs are 0.
        assert_eq!((y.positive_limit, y.negative_limit, y.home), (on, None, on));
        assert_eq!(z, AxisSignals::default());
        let [y, x, ..] = wiring.signals(&Bits::new(0b10_1000, 32, &INPUT_NAMES));
        assert_eq!((x.negative_limit, x.home), (off, off));
        assert_eq!((y.positive_limit, y.home), (off, off));
    }
}
