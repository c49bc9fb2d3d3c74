//! The zone "Paramètre" and what RESET does.

use super::Module;
use crate::{
    AXES, EncoderKind, ModuleAxis,
    emulator::axis::{Axis, Encoder, saturated},
    protocol::{
        bits::{card, coefficient, definition},
        parameter::{AxisParameter, Parameter, order},
        zone::ParameterExchange,
    },
};

impl Module {
    /// Carries out an order of the zone "Paramètre".
    pub(super) fn parameter_order(&mut self, asked: &ParameterExchange) {
        let ParameterExchange { order, number, value, .. } = *asked;
        let answer = |value| ParameterExchange { order, number, value, messages: 0 };
        // 8.1: with a wrong check sum only writes are accepted.
        let healthy = self.active.sound();
        let outcome = match order {
            order::WRITE => self.write(number, value).map(|()| value),
            order::READ if healthy => self.read(number).ok_or(card::BAD_READ),
            order::READ_PLUGS if healthy && (1..=3).contains(&number) => {
                self.reading_plugs = Some((number, self.now_ns + self.options.plugs_ns));
                self.errors = 0;
                self.answer = ParameterExchange::default();
                return;
            }
            order::READ_PLUGS if healthy => Err(card::BAD_READ),
            order::RESET => {
                self.restart();
                return;
            }
            order::READ | order::READ_PLUGS => return,
            _ => Err(card::BAD_ORDER),
        };
        self.errors = outcome.err().unwrap_or(0);
        self.answer = answer(outcome.unwrap_or(0));
    }

    fn write(&mut self, number: u16, value: u32) -> Result<(), u32> {
        if self.axes.iter().any(Axis::moving) {
            return Err(card::MOVING);
        }
        let parameter = Parameter::from_number(number).ok_or(card::BAD_WRITE)?;
        if !parameter.takes(value, self.options.rating_ma) {
            return Err(card::BAD_WRITE);
        }
        let Parameter::Axis(of_axis, axis) = parameter else { return Err(card::BAD_WRITE) };
        self.store(of_axis, axis, value);
        self.eeprom.seal();
        let holding = of_axis == AxisParameter::HoldingCurrent;
        if !parameter.needs_reset() || holding && self.options.assumptions.holding_current_at_once {
            self.active.set(parameter, value);
            let settings = self.active.settings(axis);
            if let Some(axis) = self.axes.get_mut(axis.index()) {
                axis.set_settings(&settings);
            }
        }
        // Even if the current acts after RESET, the phases are on at once (3, 7.6).
        if holding && let Some(axis) = self.axes.get_mut(axis.index()) {
            axis.energise();
        }
        Ok(())
    }

    fn read(&self, number: u16) -> Option<u32> {
        Some(match Parameter::from_number(number)? {
            Parameter::Rating => self.options.rating_ma,
            Parameter::Version => self.options.version.into(),
            // Any constant stands for the CRC of a flash that is not there.
            Parameter::FlashCrc => 0xB2AC,
            Parameter::Reserved | Parameter::Axis(AxisParameter::Phases, _) => 0,
            Parameter::Axis(AxisParameter::ParameterCrc, axis) => {
                self.eeprom.parameter_crc(axis).into()
            }
            stored @ Parameter::Axis(..) => self.eeprom.get(stored),
        })
    }

    /// Stores a value of an axis.
    pub(super) fn store(&mut self, parameter: AxisParameter, axis: ModuleAxis, value: u32) {
        self.eeprom.set(Parameter::Axis(parameter, axis), value);
        self.stores += 1;
    }

    /// Stores the offset of an absolute encoder, if it has changed.
    pub(super) fn store_offset(&mut self, axis: ModuleAxis) {
        let encoder = self.axis(axis).encoder();
        let absolute = matches!(encoder.kind(), Some(EncoderKind::Ssi | EncoderKind::EnDat));
        let offset = encoder.offset().cast_unsigned();
        let parameter = Parameter::Axis(AxisParameter::EncoderOffset, axis);
        if absolute && self.eeprom.get(parameter) != offset {
            self.store(AxisParameter::EncoderOffset, axis, offset);
        }
    }

    /// "Messages carte".
    pub(super) fn card_messages(&self) -> u32 {
        let [one, two] = &self.axes;
        let bits = [
            (card::CHECKSUM, !self.active.sound()),
            (card::AXIS_1, one.settings().has(coefficient::PRESENT)),
            (card::AXIS_2, two.settings().has(coefficient::PRESENT)),
        ];
        let set = bits.into_iter().filter(|(_, set)| *set);
        set.fold(self.errors, |word, (bit, _)| word | bit)
    }

    /// Plugs have been read.
    pub(super) fn plugs_read(&mut self, number: u16) {
        for ((place, shown), plugged) in (0..).zip(&mut self.plugs).zip(self.surroundings.plugs) {
            if number >> place & 1 != 0 {
                *shown = plugged;
            }
        }
        self.answer = ParameterExchange { order: order::READ_PLUGS, number, ..self.answer };
    }

    /// Power-up or RESET: the software stops, motors stop where they are, phases are off.
    pub(super) fn restart(&mut self) {
        self.store_positions();
        self.running = false;
        self.running_ns = self.now_ns + self.options.boot_ns.max(0);
        self.interrupt_ns = None;
        self.reading_plugs = None;
        self.answer = ParameterExchange::default();
        self.errors = 0;
        self.active = self.eeprom.clone();
        let mut axes = self.axes;
        for (axis, of) in axes.iter_mut().zip(ModuleAxis::ALL) {
            *axis = self.started(of);
        }
        self.axes = axes;
        self.stored_ends = [0; AXES];
    }

    /// The software starts; it has read the plugs.
    pub(super) fn start_software(&mut self) {
        self.running = true;
        self.starts += 1;
        self.plugs = self.surroundings.plugs;
    }

    /// An axis after RESET.
    fn started(&self, axis: ModuleAxis) -> Axis {
        let before = self.axis(axis);
        let word = |parameter| self.active.word(parameter, axis);
        let encoder_definition = word(AxisParameter::EncoderDefinition);
        let (dividend, divisor) = (word(AxisParameter::Dividend), word(AxisParameter::Divisor));
        let [.., bits] = word(AxisParameter::EncoderBits).to_be_bytes();
        let offset = self.active.signed(AxisParameter::EncoderOffset, axis);
        let bench = self.surroundings.encoders.get(axis.index()).copied().flatten();
        let mut encoder =
            Encoder::reset(bench, dividend, divisor, offset, bits, encoder_definition);

        let last = self.active.signed(AxisParameter::LastPosition, axis);
        let last_points = self.active.signed(AxisParameter::LastEncoderPosition, axis);
        let incremental = encoder.kind() == Some(EncoderKind::Incremental);
        let reload = if incremental { Reload::of(encoder_definition) } else { Reload::default() };
        let shaft = before.shaft();
        let position = match reload.motor {
            // Homing is not needed with an absolute encoder (5.1): the position is what it shows.
            Source::Nothing if !incremental => encoder.steps(shaft).unwrap_or(0),
            Source::Nothing => 0,
            Source::Motor => last,
            Source::Encoder => scaled(last_points, dividend, divisor),
        };
        match reload.encoder {
            Source::Nothing if incremental => encoder.set_points(shaft, 0),
            Source::Nothing => {}
            Source::Motor => encoder.set_steps(shaft, last),
            Source::Encoder => encoder.set_points(shaft, last_points.into()),
        }
        let settings = self.active.settings(axis);
        let mut started =
            Axis::power_up(self.now_ns, &settings, before.bench(), shaft, position, last);
        *started.encoder_mut() = encoder;
        started.set_assumptions(self.options.assumptions);
        started.set_corrections(self.options.corrections);
        started
    }
}

/// What a position is reloaded from at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Source {
    #[default]
    Nothing,
    /// The last position of the motor.
    Motor,
    /// The last position of the encoder.
    Encoder,
}

/// Bits 11 to 13 of the encoder definition (3.1.19.9).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Reload {
    motor: Source,
    encoder: Source,
}

impl Reload {
    fn of(encoder_definition: u16) -> Self {
        let (motor, encoder) = match encoder_definition & definition::RELOAD {
            0x2000 => (Source::Motor, Source::Nothing),
            0x1000 => (Source::Nothing, Source::Encoder),
            0x3000 => (Source::Encoder, Source::Encoder),
            0x0800 => (Source::Motor, Source::Motor),
            0x2800 => (Source::Motor, Source::Encoder),
            _ => (Source::Nothing, Source::Nothing),
        };
        Self { motor, encoder }
    }
}

/// Points as steps.
fn scaled(points: i32, dividend: u16, divisor: u16) -> i32 {
    saturated(i64::from(points) * i64::from(dividend) / i64::from(divisor.max(1)))
}
