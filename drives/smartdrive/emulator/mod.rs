//! Drives without hardware: parameters, modes, inputs, motion and alarms of each, byte for byte on the wire.
//!
//! [`Device`] is pure and deterministic: time, frames and events at its inputs come from the caller.
//! [`EmulatedBus`] serves several in real time on a pseudo-terminal.
//!
//! Where the manual is silent the device behaves by its [`DeviceOptions`] and their [`super::Assumptions`]. Beyond those
//! (see also `crate::emulator::motion`): an index that does not exist is NOTAVAILABLE, one that cannot be written and a value out of
//! range are BADPARAMS; a new address counts with the next command; homing approaches at `VelEnterHome`, brakes on the
//! switch and leaves it at `VelExitHome`; while it runs STOP ends it and other motion commands are refused as WORKING;
//! modes with inputs use GO for GOP and START and DIR for GON; an alarm whose cause is still there comes back when a
//! mode is chosen; the bootloader answers nothing.

mod control;
mod execute;
mod homing;
mod inputs;
mod memory;
mod modes;
pub(crate) mod motion;
mod options;
mod power;
mod serve;
#[cfg(test)]
mod tests;

pub use control::{Condition, Control, Event, Happening};
pub use inputs::Input;
pub use options::{Cam, DeviceOptions, HomingOptions};
pub use serve::{EmulatedBus, EmulatorOptions, ServedBus, Wire, serve};

use control::Shown;
use homing::Homing;
use inputs::{CAPTURE_NS, Pins};
use memory::Memory;

use super::{Alarms, LoadSource, Mode, RejectCode, SetEffect, Status, TrajectoryFlags};
use crate::{
    emulator::motion::{Ceilings, Generator},
    protocol::{
        frame,
        parameters::{ADDRESS, ENCODER_1, ENCODER_2},
    },
};
use twin_drives::ramp::State;

/// Distance of the instants at which switches, homing and inputs are looked at, ns.
const TICK_NS: i64 = CAPTURE_NS;

/// What a long command does when its time has passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Work {
    /// Only the mode changes.
    None,
    /// SAVE.
    Save,
    /// LOAD.
    Load(LoadSource),
}

/// Whether the device obeys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// It does.
    Running,
    /// The mode changes; `STA_MODE` is 31.
    Changing { until_ns: i64, mode: Mode, work: Work },
    /// It boots until then.
    Booting { until_ns: i64 },
    /// No supply, or held in the bootloader.
    Dead,
}

/// A device at one instant.
#[derive(Clone, Debug)]
pub struct Device {
    options: DeviceOptions,
    now_ns: i64,
    phase: Phase,
    mode: Mode,
    memory: Memory,
    generator: Generator,
    /// Where position 0 is, µsteps from where the axis stood at the start.
    origin: f64,
    /// Where the encoders are 0, in the same way.
    encoder_zeros: [f64; 2],
    homing: Option<Homing>,
    pins: Pins,
    analog: [u16; 2],
    supply_v: u16,
    /// Causes of alarms that are there.
    faults: Alarms,
    /// Alarms shown.
    alarms: Alarms,
    /// Levels of GO and DIR that the present mode has seen.
    seen: modes::Seen,
    /// Bits of STA that nothing in the manual sets.
    conditions: u16,
    /// What is shown instead of what is.
    stuck: Option<Shown>,
    /// Moves to come that are confirmed and not carried out.
    ignored_moves: u32,
    frames_handled: u64,
}

impl Device {
    /// A device that has just booted, at rest.
    pub fn new(options: &DeviceOptions) -> Self {
        let mut device = Self {
            options: options.clone(),
            now_ns: 0,
            phase: Phase::Running,
            mode: Mode::Off,
            memory: Memory::new(options.address, options.release),
            generator: Generator::at_rest(0.0),
            origin: 0.0,
            encoder_zeros: [0.0; 2],
            homing: None,
            pins: Pins::default(),
            analog: [0; 2],
            supply_v: options.supply_v,
            faults: Alarms::default(),
            alarms: Alarms::default(),
            seen: modes::Seen::default(),
            conditions: 0,
            stuck: None,
            ignored_moves: 0,
            frames_handled: 0,
        };
        device.start_up();
        device
    }

    /// A device that has just booted, with the parameters of an image of its flash memory; `None` if the image is
    /// damaged.
    pub fn with_flash(options: &DeviceOptions, image: &[u8]) -> Option<Self> {
        let mut device = Self::new(options);
        device.memory.restore(image).then_some(device)
    }

    /// An image of the flash memory: the saved parameters.
    pub fn flash(&self) -> Vec<u8> {
        self.memory.to_bytes()
    }

    /// Number of times that SAVE has been executed since power-up.
    pub fn saves(&self) -> u64 {
        self.memory.saves()
    }

    /// End of the SAVE under way, ns since power-up; none if there is none.
    pub fn save_due_ns(&self) -> Option<i64> {
        match self.phase {
            Phase::Changing { until_ns, work: Work::Save, .. } => Some(until_ns),
            _ => None,
        }
    }

    /// Time since power-up, ns.
    pub fn now_ns(&self) -> i64 {
        self.now_ns
    }

    /// Address on the bus.
    pub fn address(&self) -> u8 {
        let [address, _] = self.memory.word(ADDRESS).to_le_bytes();
        address
    }

    /// The mode shown in STA.
    pub fn mode(&self) -> Mode {
        match self.phase {
            Phase::Changing { .. } => Mode::Changing,
            _ => self.mode,
        }
    }

    /// Alarms shown.
    pub fn alarms(&self) -> Alarms {
        self.alarms
    }

    /// Position counter, µsteps.
    pub fn counter(&self) -> i32 {
        self.generator.counter(self.now_ns)
    }

    /// Position between the µsteps and velocity, µsteps and µsteps/s.
    pub fn motion(&self) -> (f64, f64) {
        let State { position, velocity } = self.generator.state(self.now_ns);
        (position, velocity)
    }

    /// Target of the GOTO or STEP that was taken last, µsteps; none once something else has moved or stopped the drive.
    pub fn target(&self) -> Option<i32> {
        self.generator.target()
    }

    /// Position of the mechanics, µsteps from that at the start, whatever position 0 was since.
    pub fn mechanical(&self) -> f64 {
        self.origin + self.generator.state(self.now_ns).position
    }

    /// Frames that were whole, error-free and for this device.
    pub fn frames_handled(&self) -> u64 {
        self.frames_handled
    }

    /// Outputs: bit 2 LED, 1 BRK, 0 RDY.
    pub fn outputs(&self) -> u8 {
        self.pins.levels() & 0b111
    }

    /// Lets time pass.
    pub fn advance(&mut self, ns: i64) {
        let then = self.now_ns.saturating_add(ns.max(0));
        while self.now_ns < then {
            let mut next = then;
            if let Phase::Changing { until_ns, .. } | Phase::Booting { until_ns } = self.phase {
                next = next.min(until_ns.max(self.now_ns + 1));
            }
            if self.must_look() {
                next = next.min((self.now_ns.div_euclid(TICK_NS) + 1) * TICK_NS);
            }
            self.now_ns = next;
            self.look();
        }
    }

    /// Whether something may happen before the next command.
    fn must_look(&self) -> bool {
        let moving = self.generator.is_under_way(self.now_ns);
        self.homing.is_some()
            || self.pins.is_settling()
            || moving && !self.options.cams.is_empty()
            || !matches!(self.mode, Mode::Off | Mode::Remote | Mode::Custom)
    }

    /// Looks at everything that may have happened by now.
    fn look(&mut self) {
        match self.phase {
            Phase::Changing { until_ns, mode, work } if self.now_ns >= until_ns => {
                match work {
                    Work::None => {}
                    Work::Save => self.memory.save(),
                    Work::Load(source) => self.memory.load(source == LoadSource::Factory),
                }
                self.phase = Phase::Running;
                self.activate(mode);
            }
            Phase::Booting { until_ns } if self.now_ns >= until_ns => self.start_up(),
            _ => {}
        }
        self.operate_cams();
        self.pins.settle(self.now_ns);
        self.home();
        self.obey_inputs();
    }

    /// Sets an input. Inputs with a cam follow the cam while the axis moves.
    pub fn set_input(&mut self, input: Input, level: bool) {
        self.pins.set_input(self.now_ns, input, level);
        self.obey_limits();
    }

    /// Sets analog input 1 or 2 (0 to 32767).
    pub fn set_analog(&mut self, number: u8, value: u16) {
        let place = usize::from(number).checked_sub(1);
        if let Some(analog) = place.and_then(|place| self.analog.get_mut(place)) {
            *analog = value.min(32_767);
        }
    }

    /// Begins to change to a mode: the present one is switched off at once.
    fn change_mode(&mut self, mode: Mode, work: Work) {
        self.power_off(TrajectoryFlags::NONE);
        let until_ns = self.after(self.options.mode_change);
        self.phase = Phase::Changing { until_ns, mode, work };
    }

    /// A mode begins: TRJINIT, unless the cause of an alarm is there.
    fn activate(&mut self, mode: Mode) {
        self.set_position(0);
        if self.options.assumptions.set_effect != SetEffect::AtOnce {
            self.memory.take_effect();
        }
        self.mode = mode;
        self.seen = modes::Seen::now(&self.pins);
        if !self.faults.is_empty() {
            self.raise(self.faults);
        } else if mode == Mode::PushPullHome {
            self.begin_homing();
        }
    }

    /// The present position is `position` from now on; moves are cancelled.
    fn set_position(&mut self, position: i32) {
        let before = self.mechanical();
        self.generator.reset(position);
        self.origin = before - f64::from(position);
        self.obey_limits();
    }

    fn after(&self, duration: std::time::Duration) -> i64 {
        self.now_ns.saturating_add(i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX))
    }

    fn ceilings(&self) -> Ceilings {
        self.memory.ceilings(&self.options.assumptions)
    }

    fn operate_cams(&mut self) {
        let position = self.mechanical();
        let mut changed = false;
        for input in Input::ALL {
            let mut wired = self.options.cams.iter().filter(|cam| cam.input == input).peekable();
            // Any of several switches on one wire makes it active.
            if wired.peek().is_some() {
                let level = wired.any(|cam| (cam.from..=cam.to).contains(&position));
                changed |= self.pins.set_input(self.now_ns, input, level);
            }
        }
        if changed {
            self.obey_limits();
        }
    }

    /// Limit switches stop motions towards them, but for the one that homing uses as its home switch.
    fn obey_limits(&mut self) {
        let home = self.homing.as_ref().map(|_| self.options.homing.input);
        let active = |input| self.pins.is_active(input) && home != Some(input);
        let (positive, negative) = (active(Input::LimP), active(Input::LimN));
        self.generator.set_switches(self.now_ns, &self.ceilings(), positive, negative);
    }

    /// Increments of encoder 0 or 1.
    #[expect(clippy::cast_possible_truncation, reason = "the counter keeps the low 32 bits")]
    fn encoder(&self, place: usize) -> i32 {
        let index = if place == 0 { ENCODER_1 } else { ENCODER_2 };
        let zero = self.encoder_zeros.get(place).copied().unwrap_or(0.0);
        let turns = (self.mechanical() - zero) / f64::from(self.ceilings().turn.get());
        (turns * f64::from(self.memory.word(index))).round() as i64 as i32
    }

    /// STA without the bits that depend on the command.
    fn status(&self) -> Status {
        Status::new(self.address(), self.mode().number())
            .with(Status::SEQUENCE_BUSY, self.homing.is_some())
            .with(self.conditions, true)
    }

    /// TAG of the state of the trajectory.
    fn trajectory_tag(&self) -> u16 {
        let flags = self.generator.flags(self.now_ns);
        let homing = self.homing.is_some() && self.options.build >= 310;
        let done = !homing && !matches!(self.phase, Phase::Changing { .. });
        let flags = if done { flags } else { flags.without(TrajectoryFlags::DONE) };
        flags.tag(self.options.layout)
    }

    /// Takes one frame and gives the answer, if the device answers.
    pub fn handle(&mut self, frame: &[u8]) -> Option<Vec<u8>> {
        let Some((address, command)) = frame::decode(frame) else { return self.bad_frame(frame) };
        let assumed = &self.options.assumptions;
        let command = command.map_err(|reason| match reason {
            _ if frame::has_wrong_length(frame) => assumed.wrong_length,
            // Of what can be decoded only unknown codes are.
            RejectCode::NotAvailable => assumed.unknown_code,
            reason => reason,
        });
        let own = self.address();
        if !self.is_alive() || address != own && address != 0 {
            return None;
        }
        self.frames_handled += 1;
        let answer = self.answer(command, own);
        (address != 0).then(|| self.sealed(frame, answer))
    }
}
