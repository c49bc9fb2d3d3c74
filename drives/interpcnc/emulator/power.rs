//! Power-up, power failures, and motors that do not follow.

use super::{
    BadImage, Board, BoardOptions, Buffer, Eeprom, Homings, Probe, Surroundings,
    eeprom::from_image, map::Memory, motion::Axis,
};
use crate::{
    BoardStop, Line, Parity,
    protocol::{
        parameters,
        registers::{AXES, BoardAxis},
    },
};

impl Board {
    /// A new board just powered up: locked, all counters 0. Its parameters are those of a new board, which are assumed:
    /// moderate speeds, no switches.
    pub fn new(options: &BoardOptions) -> Self {
        let mut memory = Memory::factory();
        let assumed = &options.assumptions;
        let Line { baud, parity } = options.line;
        let mut values = vec![
            (parameters::MODBUS_SPEED, assumed.baud_code.encode(baud).unwrap_or(0)),
            (parameters::MODBUS_PARITY, parity.code()),
            (parameters::MODBUS_ADDRESS, options.address.into()),
            (parameters::DEFAULT_ACCELERATION, 50),
            (parameters::DEFAULT_START_STOP, 200),
            (parameters::HOME_START_STOP, 200),
            (parameters::HOME_SLOW_SPEED, 500),
            (parameters::ZERO_AFTER_HOMING, 1),
        ];
        for axis in BoardAxis::ALL {
            values.push((parameters::home_speed(axis), 5000));
            values.push((parameters::home_acceleration(axis), 50));
        }
        for (number, value) in values {
            memory.set_parameter(number, value);
        }
        Self::powered(options, memory.kept())
    }

    /// A board with the EEPROM of an earlier one ([`Self::eeprom`]), just powered up.
    ///
    /// # Errors
    /// If the bytes are no such EEPROM.
    pub fn with_eeprom(options: &BoardOptions, image: &[u8]) -> Result<Self, BadImage> {
        Ok(Self::powered(options, from_image(image)?))
    }

    fn powered(options: &BoardOptions, stored: Vec<u16>) -> Self {
        let memory = Memory::new(&stored);
        let mut board = Self {
            address: options.address,
            line: options.line,
            assumptions: options.assumptions,
            now_ns: 0,
            axes: [Axis::default(); AXES],
            memory,
            eeprom: Eeprom::new(stored),
            surroundings: Surroundings::default(),
            probe: Probe::default(),
            homings: Homings::default(),
            buffer: Buffer::default(),
            conditions: (0, 0),
            stuck: None,
            ignored_moves: 0,
            locked: true,
            enable_input: options.enable,
            counts: options.counts,
            enabled: options.enable,
            open_since_ns: None,
            dead_until_ns: 0,
            frames_handled: 0,
            frames_seen: 0,
        };
        board.boot();
        board
    }

    /// The firmware starts.
    fn boot(&mut self) {
        self.take_line_parameters();
        self.memory.outputs = self.memory.parameter(parameters::OUTPUTS_AT_START);
        self.locked = true;
        self.memory.reset_analog_outputs();
        if self.enabled {
            self.unlock_automatically();
        }
        self.settle();
    }

    /// Station and line as parameters 101 to 103 say, as far as they make sense.
    pub(super) fn take_line_parameters(&mut self) {
        let value = |number| self.memory.parameter(number);
        let baud = self.assumptions.baud_code.decode(value(parameters::MODBUS_SPEED));
        let parity = Parity::from_code(value(parameters::MODBUS_PARITY));
        let address = u8::try_from(value(parameters::MODBUS_ADDRESS)).ok();
        self.line.baud = baud.unwrap_or(self.line.baud);
        self.line.parity = parity.unwrap_or(self.line.parity);
        let address = address.filter(|address| (1..=247).contains(address));
        self.address = address.unwrap_or(self.address);
    }

    /// The supply fails and is back after so long: the axes stop at once, all that is in RAM is lost, counters
    /// included, and so is what was being written to the EEPROM.
    pub fn brown_out(&mut self, off_ns: i64) {
        let now = self.now_ns;
        self.axes.iter_mut().for_each(|axis| axis.power_cycle(now));
        let inputs = self.memory.inputs;
        let analog_inputs = self.memory.analog_inputs;
        self.eeprom.power_cycle();
        self.memory = Memory::new(self.eeprom.stored());
        (self.memory.inputs, self.memory.analog_inputs) = (inputs, analog_inputs);
        self.probe.power_cycle();
        self.homings = Homings::default();
        self.buffer = Buffer::default();
        self.conditions = (0, 0);
        self.enabled = self.enable_input;
        self.open_since_ns = None;
        self.dead_until_ns = now.saturating_add(off_ns.max(0));
        self.boot();
    }

    /// Sets a parameter as it was before power-up, without a write to the EEPROM.
    pub(crate) fn set_parameter(&mut self, number: u16, value: u32) {
        self.memory.set_parameter(number, value);
        self.eeprom = Eeprom::new(self.memory.kept());
    }

    /// True while the supply is off.
    pub(super) fn is_dead(&self) -> bool {
        self.now_ns < self.dead_until_ns
    }

    /// The motor of an axis stalls, so that the mechanics rest while the counter goes on, or follows again.
    pub fn set_stalled(&mut self, axis: BoardAxis, stalled: bool) {
        let now = self.now_ns;
        if let Some(axis) = self.axes.get_mut(axis.index()) {
            axis.set_stalled(now, stalled);
        }
        self.settle();
    }

    /// Status and extended status are shown as they are now, whatever happens, or as they are.
    pub fn set_stuck_status(&mut self, stuck: bool) {
        self.stuck = stuck.then(|| (self.status().0, self.extended_status()));
    }

    /// Everything stops without ramp and locks, as by command 43.
    pub fn stop_and_lock(&mut self) {
        self.lock(BoardStop::AtOnce);
        self.settle();
    }
}
