//! The board's memory: which address holds what, and what may be written.
//!
//! Source: the address tables of the manual. Reserved addresses within the tables read 0 and cannot be written.

use std::ops::RangeInclusive;

use super::{Board, bench::Condition, eeprom::KEPT, rtu::Refusal};
use crate::{
    BoardStop,
    protocol::{
        parameters::{self, FIRST_PARAMETER, PARAMETERS},
        registers::{AXES, BoardAxis, COMMAND, COMMAND_REGISTERS, words},
    },
};

/// Outputs OUT1 to OUT32 as coils.
const OUTPUTS: RangeInclusive<u16> = 256..=287;
/// Coil of the board lock; its polarity is not stated.
const LOCK: u16 = 288;
/// User bits.
const USER_BITS: RangeInclusive<u16> = 320..=415;
/// All coils, reserved ones included.
const COILS: RangeInclusive<u16> = 256..=511;
/// All discrete inputs, reserved ones included.
const DISCRETE: RangeInclusive<u16> = 2048..=2303;
/// All input registers.
const INPUT_REGISTERS: RangeInclusive<u16> = 1024..=1055;
/// First and last holding register.
const HOLDING: RangeInclusive<u16> = COMMAND..=6636;
/// Analog outputs, 0 to 1023.
const ANALOG_OUTPUTS: RangeInclusive<u16> = 4146..=4147;
/// Largest value of an analog output ("0 à 1023").
const MOST_ANALOG: u16 = 1023;
/// OUT17 to OUT32, OUT1 to OUT16.
const OUTPUTS_HIGH: u16 = 4148;
const OUTPUTS_LOW: u16 = 4149;
/// Encoder and counters, read only.
const COUNTERS: RangeInclusive<u16> = 4218..=4223;
const RESERVED: RangeInclusive<u16> = 4224..=4351;
/// Registers per recipe, 1 to 250.
const RECIPE_SIZE: u16 = 5632;
/// Recipe shown on page 0; three more follow.
const RECIPE_INDEX: u16 = 5633;
/// Page 0; three more follow, 250 registers each.
const RECIPE_PAGES: u16 = FIRST_RECIPE;
/// First register of the recipe pages.
pub(super) const FIRST_RECIPE: u16 = 5637;
const RECIPE_PAGE: u16 = 250;
/// EEPROM registers for recipes.
pub(super) const RECIPE_REGISTERS: usize = 5000;

/// Registers and bits that only hold what was written to them.
#[derive(Clone, Debug)]
pub(super) struct Memory {
    holding: Vec<u16>,
    recipes: Vec<u16>,
    user_bits: [bool; 96],
    /// Bit 0 = OUT1.
    pub(super) outputs: u32,
    /// Bit 0 = IN1.
    pub(super) inputs: u32,
    /// 0 to 1023.
    pub(super) analog_inputs: [u16; 4],
    /// Pulse counters A and B.
    pub(super) pulses: [u32; 2],
}

impl Memory {
    /// RAM after power-up, with what the EEPROM has stored.
    pub(super) fn new(stored: &[u16]) -> Self {
        let mut memory = Self {
            holding: vec![0; HOLDING.len()],
            recipes: vec![0; RECIPE_REGISTERS],
            user_bits: [false; 96],
            outputs: 0,
            inputs: 0,
            analog_inputs: [0; 4],
            pulses: [0; 2],
        };
        let (kept, recipes) = stored.split_at_checked(KEPT.len()).unwrap_or_default();
        for (address, value) in KEPT.zip(kept) {
            memory.store(address, *value);
        }
        for (place, value) in memory.recipes.iter_mut().zip(recipes) {
            *place = *value;
        }
        memory
    }

    /// A new board's memory.
    pub(super) fn factory() -> Self {
        let mut memory = Self::new(&[]);
        memory.store(RECIPE_SIZE, RECIPE_PAGE);
        memory
    }

    /// What goes to the EEPROM.
    pub(super) fn kept(&self) -> Vec<u16> {
        KEPT.map(|address| self.load(address)).chain(self.recipes.iter().copied()).collect()
    }

    /// A holding register as it was written; 0 outside the map.
    fn load(&self, address: u16) -> u16 {
        let place = address.checked_sub(COMMAND).map(usize::from);
        place.and_then(|place| self.holding.get(place)).copied().unwrap_or(0)
    }

    fn store(&mut self, address: u16, value: u16) {
        let place = address.checked_sub(COMMAND).map(usize::from);
        if let Some(register) = place.and_then(|place| self.holding.get_mut(place)) {
            *register = value;
        }
    }

    /// The command registers are 0 from now on, but for the first `count`.
    pub(super) fn forget_arguments(&mut self, written: usize) {
        let arguments = self.holding.iter_mut().take(COMMAND_REGISTERS.into()).skip(written);
        arguments.for_each(|argument| *argument = 0);
    }

    /// The command registers.
    pub(super) fn command(&self) -> [u16; COMMAND_REGISTERS as usize] {
        self.holding.first_chunk().copied().unwrap_or([0; COMMAND_REGISTERS as usize])
    }

    /// Parameter `number`, two registers, high word first.
    pub(super) fn parameter(&self, number: u16) -> u32 {
        let address = FIRST_PARAMETER + 2 * number.min(PARAMETERS - 1);
        u32::from(self.load(address)) << 16 | u32::from(self.load(address + 1))
    }

    pub(super) fn set_parameter(&mut self, number: u16, value: u32) {
        let address = FIRST_PARAMETER + 2 * number.min(PARAMETERS - 1);
        let [high, low] = words(value);
        self.store(address, high);
        self.store(address + 1, low);
    }

    /// Analog outputs at their values for a locked board.
    pub(super) fn reset_analog_outputs(&mut self) {
        for (address, number) in ANALOG_OUTPUTS.zip(parameters::ANALOG_LOCKED..) {
            let value = u16::try_from(self.parameter(number)).unwrap_or(u16::MAX);
            self.store(address, value.min(MOST_ANALOG));
        }
    }

    /// Analog outputs 1 and 2, 0 to 1023.
    pub(super) fn analog_outputs(&self) -> [u16; 2] {
        [self.load(*ANALOG_OUTPUTS.start()), self.load(*ANALOG_OUTPUTS.end())]
    }

    /// Place in the recipe store of a page register.
    fn recipe_place(&self, address: u16) -> Result<usize, Refusal> {
        let offset = address - RECIPE_PAGES;
        let size = self.load(RECIPE_SIZE);
        let index = self.load(RECIPE_INDEX + offset / RECIPE_PAGE);
        let offset = offset % RECIPE_PAGE;
        let place = usize::from(index) * usize::from(size) + usize::from(offset);
        if offset < size && place < RECIPE_REGISTERS { Ok(place) } else { Err(Refusal::Address) }
    }
}

fn bit(bits: u32, place: u16) -> bool {
    bits >> place & 1 == 1
}

impl Board {
    /// Coils, function 1.
    pub(super) fn coil(&self, address: u16) -> Result<bool, Refusal> {
        if OUTPUTS.contains(&address) {
            Ok(bit(self.memory.outputs, address - OUTPUTS.start()))
        } else if address == LOCK {
            Ok(self.locked == self.assumptions.lock_coil)
        } else if USER_BITS.contains(&address) {
            let place = usize::from(address - USER_BITS.start());
            Ok(self.memory.user_bits.get(place).is_some_and(|bit| *bit))
        } else if COILS.contains(&address) {
            Ok(false)
        } else {
            Err(Refusal::Address)
        }
    }

    /// True if functions 5 and 15 may write the coil.
    pub(super) fn coil_is_writable(address: u16) -> bool {
        OUTPUTS.contains(&address) || address == LOCK || USER_BITS.contains(&address)
    }

    /// Writes one coil. A locked board leaves its outputs alone.
    pub(super) fn set_coil(&mut self, address: u16, value: bool) {
        if OUTPUTS.contains(&address) {
            let mask = 1 << (address - OUTPUTS.start());
            let outputs =
                if value { self.memory.outputs | mask } else { self.memory.outputs & !mask };
            self.set_outputs(outputs);
        } else if address == LOCK {
            if value == self.assumptions.lock_coil {
                self.lock(BoardStop::AtOnce);
            } else {
                self.unlock();
            }
        } else if let Some(place) = address.checked_sub(*USER_BITS.start())
            && let Some(bit) = self.memory.user_bits.get_mut(usize::from(place))
        {
            *bit = value;
        }
    }

    fn set_outputs(&mut self, outputs: u32) {
        if !self.locked {
            self.memory.outputs = outputs;
        }
    }

    /// Whether any of the coils is an output: a locked board does not switch those.
    pub(super) fn switches_outputs(places: &[(u16, bool)]) -> bool {
        places.iter().any(|(address, _)| OUTPUTS.contains(address))
    }

    /// Whether any of the registers is an output.
    pub(super) fn sets_outputs(places: &[(u16, u16)]) -> bool {
        let is_output = |address| {
            [OUTPUTS_HIGH, OUTPUTS_LOW].contains(&address) || ANALOG_OUTPUTS.contains(&address)
        };
        places.iter().any(|(address, _)| is_output(*address))
    }

    /// Discrete inputs, function 2.
    pub(super) fn discrete(&self, address: u16) -> Result<bool, Refusal> {
        match address {
            2048..=2063 => Ok(bit(self.memory.inputs, address - 2048)),
            2080..=2111 => Ok(bit(self.shown_status().0, address - 2080)),
            2112..=2116 => Ok(bit(self.shown_status().1, address - 2112)),
            2117..=2119 => {
                let place = usize::from(address - 2117);
                Ok(self.encoder_inputs().get(place).copied().unwrap_or(false))
            }
            _ if DISCRETE.contains(&address) => Ok(false),
            _ => Err(Refusal::Address),
        }
    }

    /// Input registers, function 4.
    pub(super) fn input_register(&self, address: u16) -> Result<u16, Refusal> {
        let half = |value: u32, low: bool| {
            let [high_word, low_word] = words(value);
            if low { low_word } else { high_word }
        };
        match address {
            1024 | 1025 => Ok(half(self.shown_status().0, address == 1025)),
            1026..=1035 => {
                let axis = usize::from((address - 1026) / 2);
                let counter = self.counters().get(axis).copied().unwrap_or(0);
                Ok(half(counter.cast_unsigned(), address % 2 == 1))
            }
            1036 | 1037 => Ok(half(self.memory.inputs, address == 1037)),
            1038 | 1039 => Ok(half(self.memory.outputs, address == 1039)),
            1040..=1043 => {
                let place = usize::from(address - 1040);
                Ok(self.memory.analog_inputs.get(place).copied().unwrap_or(0))
            }
            1044 | 1045 => Ok(half(self.probe.position().cast_unsigned(), address == 1045)),
            1054 | 1055 => Ok(half(self.shown_status().1, address == 1055)),
            _ if INPUT_REGISTERS.contains(&address) => Ok(0),
            _ => Err(Refusal::Address),
        }
    }

    /// Holding registers, function 3.
    pub(super) fn holding(&self, address: u16) -> Result<u16, Refusal> {
        let half = |value: u32, first: u16| {
            let [high, low] = words(value);
            Ok(if address == first { high } else { low })
        };
        let [pulses_a, pulses_b] = self.memory.pulses;
        match address {
            OUTPUTS_HIGH | OUTPUTS_LOW => half(self.memory.outputs, OUTPUTS_HIGH),
            _ if COUNTERS.contains(&address) && !self.counts => Err(Refusal::Address),
            4218 | 4219 => half(self.encoder().cast_unsigned(), 4218),
            4220 | 4221 => half(pulses_a, 4220),
            4222 | 4223 => half(pulses_b, 4222),
            _ if address >= RECIPE_PAGES && HOLDING.contains(&address) => {
                let place = self.memory.recipe_place(address)?;
                self.memory.recipes.get(place).copied().ok_or(Refusal::Address)
            }
            _ if HOLDING.contains(&address) => Ok(self.memory.load(address)),
            _ => Err(Refusal::Address),
        }
    }

    /// Whether functions 6 and 16 may write `value` to the register.
    pub(super) fn check_holding(&self, address: u16, value: u16) -> Result<(), Refusal> {
        match address {
            _ if !HOLDING.contains(&address)
                || COUNTERS.contains(&address)
                || RESERVED.contains(&address) =>
            {
                Err(Refusal::Address)
            }
            _ if ANALOG_OUTPUTS.contains(&address) && value > MOST_ANALOG => Err(Refusal::Value),
            RECIPE_SIZE if !(1..=RECIPE_PAGE).contains(&value) => Err(Refusal::Value),
            _ if address >= RECIPE_PAGES => self.memory.recipe_place(address).map(|_| ()),
            _ => Ok(()),
        }
    }

    /// Writes one register that [`Self::check_holding`] has passed.
    pub(super) fn set_holding(&mut self, address: u16, value: u16) {
        match address {
            OUTPUTS_HIGH => self.set_outputs(u32::from(value) << 16 | self.memory.outputs & 0xFFFF),
            OUTPUTS_LOW => self.set_outputs(u32::from(value) | self.memory.outputs & 0xFFFF_0000),
            RECIPE_SIZE => {
                if value != self.memory.load(RECIPE_SIZE) {
                    self.memory.recipes.fill(0);
                }
                self.memory.store(RECIPE_SIZE, value);
            }
            _ if address >= RECIPE_PAGES => {
                let place = self.memory.recipe_place(address).ok();
                if let Some(register) = place.and_then(|place| self.memory.recipes.get_mut(place)) {
                    *register = value;
                }
                self.conditions.1 |= Condition::RecipesChanged.bits().1;
            }
            _ if ANALOG_OUTPUTS.contains(&address) && self.locked => {}
            _ => self.memory.store(address, value),
        }
    }

    /// One bit per axis, X in bit 0.
    pub(super) fn axis_bits(&self, of: impl Fn(&super::motion::Axis) -> bool) -> u32 {
        BoardAxis::ALL
            .iter()
            .zip(&self.axes)
            .filter(|(_, axis)| of(axis))
            .fold(0, |bits, (name, _)| bits | u32::from(name.mask().bits()))
    }

    /// Position counters.
    pub fn counters(&self) -> [i32; AXES] {
        self.axes.each_ref().map(|axis| axis.counter(self.now_ns))
    }
}
