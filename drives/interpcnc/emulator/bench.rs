//! Mechanics around an emulated board: switches and cams along the axes, an encoder, and manual actions.

use super::Board;
use crate::protocol::registers::BoardAxis;

/// Something that presses the switch of an input while an axis is between two places: a home or limit switch, or a
/// piece that a probe touches (which ends nowhere).
///
/// Places are those of the mechanics: steps from where the axis stood at the first power-up, whatever its counter says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cam {
    /// Input, 1 to 32.
    pub input: u8,
    /// Axis along which it lies.
    pub axis: BoardAxis,
    /// First step on which the switch is pressed.
    pub from: i32,
    /// First step on which it is released.
    pub to: i32,
    /// Whether pressing opens the contact (NC), so that the input is 0 while pressed; else it closes it (NO).
    pub normally_closed: bool,
}

/// An encoder on an axis: `counts` per `steps` of the mechanics, exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderLink {
    /// Axis whose mechanics turn it.
    pub axis: BoardAxis,
    /// Counts (edges of A and B) for `steps` steps; negative if it turns the other way.
    pub counts: i32,
    /// Steps, more than 0.
    pub steps: u32,
    /// Counts per revolution: the index C is 1 on the first count of each. 0: no index.
    pub counts_per_revolution: u32,
}

/// Surroundings of the board.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Bench {
    /// Switches and cams; several may press the same input.
    pub cams: Vec<Cam>,
    /// The encoder, if there is one.
    pub encoder: Option<EncoderLink>,
}

/// The bench, and what hands do to the inputs.
#[derive(Clone, Debug, Default)]
pub(super) struct Surroundings {
    pub(super) bench: Bench,
    /// Levels set by hand, bit 0 = IN1.
    by_hand: u32,
    /// Inputs whose level is set by hand although cams press them.
    forced: u32,
}

/// Conditions of the board that nothing on Modbus brings about, and that a bench may: the USB side, the Basic
/// interpreter and the torch height control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Condition {
    /// B6: the command buffer is frozen; no further segment starts.
    BufferFrozen,
    /// B17: a speed override is in effect.
    Overridden,
    /// B18: a speed override is allowed.
    OverrideAllowed,
    /// B19: waiting for an input.
    WaitingForInput,
    /// B20: an input that was waited for did not come.
    WaitTimeout,
    /// B21: torch height control is active.
    HeightControl,
    /// Extended B5: Basic has lost characters that it sent.
    BasicTxOverrun,
    /// Extended B6: Basic has lost characters that it received.
    BasicRxOverrun,
    /// Extended B7: a Basic program runs.
    BasicRunning,
    /// Extended B9: a master has written recipe data; the board sets it, what reads the recipes ends it (assumed).
    RecipesChanged,
}

impl Condition {
    /// Bits of status and extended status.
    pub(super) fn bits(self) -> (u32, u32) {
        match self {
            Self::BufferFrozen => (1 << 6, 0),
            Self::Overridden => (1 << 17, 0),
            Self::OverrideAllowed => (1 << 18, 0),
            Self::WaitingForInput => (1 << 19, 0),
            Self::WaitTimeout => (1 << 20, 0),
            Self::HeightControl => (1 << 21, 0),
            Self::BasicTxOverrun => (0, 1 << 5),
            Self::BasicRxOverrun => (0, 1 << 6),
            Self::BasicRunning => (0, 1 << 7),
            Self::RecipesChanged => (0, 1 << 9),
        }
    }
}

/// Where a step begins: half a step before its middle, where the axis is exactly on it.
fn edge(step: i32) -> f64 {
    f64::from(step) - 0.5
}

/// Bit of an input, 1 to 32; 0 of any other.
pub(super) fn input_bit(number: u32) -> u32 {
    number.checked_sub(1).and_then(|place| 1_u32.checked_shl(place)).unwrap_or(0)
}

impl Board {
    /// Puts the board onto a bench, from now on.
    pub fn set_bench(&mut self, bench: Bench) {
        self.surroundings.bench = bench;
        self.settle();
    }

    /// Surroundings of the board.
    pub fn bench(&self) -> &Bench {
        &self.surroundings.bench
    }

    /// Sets input `number` (IN1 to IN32), also against a cam.
    pub fn set_input(&mut self, number: u8, level: bool) {
        let bit = input_bit(number.into());
        let hand = &mut self.surroundings;
        hand.by_hand = if level { hand.by_hand | bit } else { hand.by_hand & !bit };
        hand.forced |= bit;
        self.settle();
    }

    /// Takes the hand off input `number`: its cams press it again. Without cams it keeps its level.
    pub fn release_input(&mut self, number: u8) {
        self.surroundings.forced &= !input_bit(number.into());
        self.settle();
    }

    /// Inputs, bit 0 = IN1.
    pub fn inputs(&self) -> u32 {
        self.memory.inputs
    }

    /// Voltage at analog input `number` (1 to 4) as the board reads it, 0 to 1023.
    pub fn set_analog_input(&mut self, number: u8, value: u16) {
        let place = usize::from(number).checked_sub(1);
        if let Some(input) = place.and_then(|place| self.memory.analog_inputs.get_mut(place)) {
            *input = value.min(1023);
        }
    }

    /// Pulses arrive at counter A (false) or B (true); the counters wrap.
    pub fn add_pulses(&mut self, second: bool, count: u32) {
        let [a, b] = &mut self.memory.pulses;
        let counter = if second { b } else { a };
        *counter = counter.wrapping_add(count);
    }

    /// Brings a condition about that nothing on Modbus does, or ends it.
    pub fn set_condition(&mut self, condition: Condition, on: bool) {
        let (status, extended) = condition.bits();
        let set = |word: u32, bits: u32| if on { word | bits } else { word & !bits };
        self.conditions = (set(self.conditions.0, status), set(self.conditions.1, extended));
        self.settle();
    }

    /// Position of the mechanics of an axis, steps from that at the first power-up.
    pub fn mechanical(&self, axis: BoardAxis) -> f64 {
        self.axes.get(axis.index()).map_or(0.0, |axis| axis.mechanical(self.now_ns))
    }

    /// Levels of all inputs as hands and cams make them.
    pub(super) fn input_levels(&self) -> u32 {
        let around = &self.surroundings;
        let (mut wired, mut pressed, mut inverted) = (0, 0, 0);
        for cam in &around.bench.cams {
            let bit = input_bit(cam.input.into());
            let place = self.mechanical(cam.axis);
            wired |= bit;
            if cam.normally_closed {
                inverted |= bit;
            }
            if place >= edge(cam.from) && place < edge(cam.to) {
                pressed |= bit;
            }
        }
        let by_cams = wired & !around.forced;
        (around.by_hand & !by_cams) | ((pressed ^ inverted) & by_cams)
    }

    /// The next instant at which an axis reaches or leaves a cam.
    pub(super) fn next_edge(&self) -> Option<i64> {
        let edges = |cam: &Cam| {
            let axis = self.axes.get(cam.axis.index()).filter(|axis| axis.moving(self.now_ns))?;
            let reached = [cam.from, cam.to]
                .into_iter()
                .filter_map(|step| axis.crossing(self.now_ns, edge(step)));
            reached.min()
        };
        self.surroundings.bench.cams.iter().filter_map(edges).min()
    }

    /// Counts of the encoder.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "whole, and a float cast saturates as a counter may"
    )]
    pub(super) fn encoder(&self) -> i32 {
        self.surroundings.bench.encoder.map_or(0, |link| {
            let steps = self.mechanical(link.axis);
            (steps * f64::from(link.counts) / f64::from(link.steps.max(1))).floor() as i32
        })
    }

    /// Encoder inputs A, B and C: a quarter of a period apart, and once per revolution.
    pub(super) fn encoder_inputs(&self) -> [bool; 3] {
        let Some(link) = self.surroundings.bench.encoder else { return [false; 3] };
        let count = self.encoder();
        let turn = i64::from(link.counts_per_revolution);
        let index = turn > 0 && i64::from(count).rem_euclid(turn) == 0;
        let quarter = count.rem_euclid(4);
        [quarter == 1 || quarter == 2, quarter >= 2, index]
    }
}
