//! The module without hardware: its memory, its parameters and its motion.
//!
//! [`Module`] is pure and deterministic: time and accesses of its host come from the caller.
//! [`EmulatedModule`] serves one in real time on a memory file for other processes;
//! [`super::SharedModule`] is for the same process.
//!
//! Where the manual is silent the module behaves by its [`Assumptions`] and by what `drives/bim2ax/emulator/axis` says.
//! In addition: an interrupt takes effect 300 µs later, the time the module needs for it (9.2.4); the RAM is 0 at the start; bytes that do
//! not exist read $FF; values out of the range of a parameter are refused as numbers out of range are; a refused
//! order of the zone "Paramètre" is echoed with the value 0; RESET is obeyed always, also with a wrong check sum and
//! in motion; writing any parameter makes the check sum right, and the module works again after RESET; the last
//! encoder position is stored in points; an axis with an absolute encoder starts where that shows it to be.

pub(crate) mod axis;
mod bus;
mod control;
mod eeprom;
mod interrupt;
mod memory_file;
mod parameters;
mod shared;

pub use axis::{Bench, Contact, EncoderBench, EncoderKind};
pub use control::{Control, Event};
pub use eeprom::Eeprom;
pub use memory_file::{EmulatedModule, EmulatorOptions};
pub use shared::SharedModule;

use super::{AXES, Assumptions, Corrections, ModuleAxis};
use crate::{
    AxisSettings,
    emulator::axis::Axis,
    protocol::{
        bits::{coefficient, encoder_message, message},
        memory::{
            BIM2AX_BOCM, ByteOrder, HOST_PAGE, IDENTIFIER, INTERRUPT, NOT_RUNNING, PAGE_REGISTER,
            WINDOW_LENGTH,
        },
        parameter::{AxisParameter, Parameter},
        zone::{ParameterExchange, Target, ZoneBytes},
    },
};
use bus::{LateAnswer, LateRequest, Page};
use twin_drives::{FaultyWire, emulator_host::Agenda};

/// Bytes of RAM.
const RAM_LENGTH: usize = 1024;
/// First version that takes and refreshes several zones with one interrupt.
const ZONES_AT_ONCE: u16 = 15;

/// Version, rating and timing of a module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModuleOptions {
    /// Version of the software, parameter $63. From 15 on, several zones go with one interrupt.
    pub version: u16,
    /// Rating, mA: 1000, 2000 or 5000. Parameter $62.
    pub rating_ma: u32,
    /// Byte order of its numbers.
    pub byte_order: ByteOrder,
    /// From an interrupt to its effect, ns.
    pub interrupt_ns: i64,
    /// From power-up or RESET to the start of the software, ns.
    pub boot_ns: i64,
    /// Duration of reading plugs, ns (2.2.6: "environ 700 millisecondes").
    pub plugs_ns: i64,
    /// The order "phases on" is known, which revision D of the manual has added.
    pub phases_on_order: bool,
    /// Correction of moves by its encoders.
    pub corrections: Corrections,
    /// Assumptions where the manual is silent.
    pub assumptions: Assumptions,
}

impl Default for ModuleOptions {
    /// Version 15, 2 A, big-endian, 300 µs, half a second to start, 700 ms for plugs.
    fn default() -> Self {
        Self {
            version: ZONES_AT_ONCE,
            rating_ma: 2000,
            byte_order: ByteOrder::Big,
            interrupt_ns: 300_000,
            boot_ns: 500_000_000,
            plugs_ns: 700_000_000,
            phases_on_order: true,
            corrections: Corrections::default(),
            assumptions: Assumptions::default(),
        }
    }
}

/// Surroundings of a module: contacts, motors, encoders and plugs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Surroundings {
    /// Motors and switches of axes 1 and 2.
    pub benches: [Bench; AXES],
    /// Encoders.
    pub encoders: [Option<EncoderBench>; AXES],
    /// Values of the plugs; none if absent.
    pub plugs: [Option<u32>; AXES],
}

/// The module at one instant.
#[derive(Clone, Debug)]
pub struct Module {
    options: ModuleOptions,
    /// What the bus does to what is written.
    bus: FaultyWire,
    agenda: Agenda<Event>,
    /// Page 7 as the module heard it last.
    heard: Page,
    late_requests: Vec<LateRequest>,
    late_answers: Vec<LateAnswer>,
    /// After a refresh these bits of the byte at this offset of page 6 are wrong.
    garbled: Option<(u8, u8)>,
    /// The zone "Position" that is shown instead of what is.
    stuck: Option<ZoneBytes>,
    now_ns: i64,
    ram: [u8; RAM_LENGTH],
    page: u8,
    eeprom: Eeprom,
    /// Values that act: those written since the last RESET that need one are not among them.
    active: Eeprom,
    axes: [Axis; AXES],
    surroundings: Surroundings,
    /// When the software will run.
    running_ns: i64,
    running: bool,
    /// When the pending interrupt takes effect.
    interrupt_ns: Option<i64>,
    served: u64,
    starts: u64,
    targets: [Target; AXES],
    /// Answer to the last parameter order.
    answer: ParameterExchange,
    /// Error bits of the last parameter order.
    errors: u32,
    /// Plugs as last read.
    plugs: [Option<u32>; AXES],
    /// Plugs being read, and when they will have been.
    reading_plugs: Option<(u16, i64)>,
    /// Ends of moves whose positions have been stored.
    stored_ends: [u64; AXES],
    stores: u64,
}

impl Module {
    /// A module that gets its power now, at time 0; its shafts are at 0.
    pub fn new(options: &ModuleOptions, eeprom: &Eeprom, surroundings: &Surroundings) -> Self {
        let stand = |bench: &Bench| Axis::power_up(0, &AxisSettings::default(), bench, 0, 0, 0);
        let mut module = Self {
            options: *options,
            bus: FaultyWire::new(0),
            agenda: Agenda::default(),
            heard: [0; WINDOW_LENGTH as usize],
            late_requests: Vec::new(),
            late_answers: Vec::new(),
            garbled: None,
            stuck: None,
            now_ns: 0,
            ram: [0; RAM_LENGTH],
            page: 0,
            eeprom: eeprom.clone(),
            active: eeprom.clone(),
            axes: surroundings.benches.each_ref().map(stand),
            surroundings: *surroundings,
            running_ns: 0,
            running: false,
            interrupt_ns: None,
            served: 0,
            starts: 0,
            targets: [Target::default(); AXES],
            answer: ParameterExchange::default(),
            errors: 0,
            plugs: [None; AXES],
            reading_plugs: None,
            stored_ends: [0; AXES],
            stores: 0,
        };
        module.restart();
        module
    }

    /// Lets time pass up to `time_ns`, never backwards.
    pub fn advance(&mut self, time_ns: i64) {
        loop {
            let due = [
                (!self.running).then_some(self.running_ns),
                self.interrupt_ns,
                self.reading_plugs.map(|(_, due_ns)| due_ns),
                self.late_requests.iter().map(|late| late.due_ns).min(),
                self.late_answers.iter().map(|late| late.due_ns).min(),
            ];
            let Some(due_ns) = due.into_iter().flatten().min().filter(|due| *due <= time_ns) else {
                break;
            };
            self.pass(due_ns);
            if !self.running && self.running_ns <= due_ns {
                self.start_software();
            }
            if let Some((plugs, at_ns)) = self.reading_plugs
                && at_ns <= due_ns
            {
                self.reading_plugs = None;
                self.plugs_read(plugs);
            }
            if self.interrupt_ns.is_some_and(|at_ns| at_ns <= due_ns) {
                self.interrupt_ns = None;
                self.hear();
            }
            self.hear_late(due_ns);
            self.say_late(due_ns);
        }
        self.pass(time_ns);
    }

    /// The axes move.
    fn pass(&mut self, time_ns: i64) {
        self.now_ns = self.now_ns.max(time_ns);
        self.axes.iter_mut().for_each(|axis| axis.advance(time_ns));
        self.store_positions();
    }

    /// The time, ns.
    pub fn now_ns(&self) -> i64 {
        self.now_ns
    }

    /// Reads for the host at an offset from the module's base.
    pub fn bus_read(&self, offset: u8) -> u8 {
        match offset {
            _ if self.bus.is_disconnected() => 0xFF,
            0..WINDOW_LENGTH => self.ram.get(self.ram_place(offset)).copied().unwrap_or(0xFF),
            PAGE_REGISTER if self.running => 0,
            PAGE_REGISTER => NOT_RUNNING,
            IDENTIFIER => BIM2AX_BOCM,
            _ => 0xFF,
        }
    }

    /// Writes for the host at an offset from the module's base.
    pub fn bus_write(&mut self, offset: u8, value: u8) {
        match offset {
            _ if self.bus.is_disconnected() => {}
            0..WINDOW_LENGTH => {
                let place = self.ram_place(offset);
                if let Some(byte) = self.ram.get_mut(place) {
                    *byte = value;
                }
                if offset == INTERRUPT && self.page == HOST_PAGE {
                    self.interrupt();
                }
            }
            PAGE_REGISTER => self.page = value & 7,
            _ => {}
        }
    }

    fn ram_place(&self, offset: u8) -> usize {
        usize::from(self.page) * usize::from(WINDOW_LENGTH) + usize::from(offset)
    }

    /// Interrupts the module. While its software does not run, interrupts are lost.
    fn interrupt(&mut self) {
        if self.running {
            // One that is pending already is not served twice.
            self.interrupt_ns.get_or_insert(self.now_ns + self.options.interrupt_ns.max(0));
        }
    }

    /// Whether the module is off the bus ([`Control::Disconnect`]).
    pub fn is_disconnected(&self) -> bool {
        self.bus.is_disconnected()
    }

    /// After every refresh from now on, these bits of the byte at this offset of page 6 are wrong; or none.
    pub fn set_garbled(&mut self, garbled: Option<(u8, u8)>) {
        self.garbled = garbled;
    }

    /// Sets the seed of faults by chance; the faults of the bus so far are gone.
    pub fn set_seed(&mut self, seed: u64) {
        self.bus = FaultyWire::new(seed);
    }

    /// The surroundings.
    pub fn surroundings(&self) -> &Surroundings {
        &self.surroundings
    }

    /// Presses a switch, breaks a wire, plugs something in or out.
    pub fn set_surroundings(&mut self, surroundings: &Surroundings) {
        self.surroundings = *surroundings;
        let parts = surroundings.benches.iter().zip(surroundings.encoders);
        for (axis, (bench, encoder)) in self.axes.iter_mut().zip(parts) {
            axis.set_bench(bench);
            axis.encoder_mut().set_bench(encoder);
        }
        self.store_positions();
    }

    /// Takes the module's power away for so long, ns: RAM and positions are lost, motors rest where they are.
    pub fn brown_out(&mut self, off_ns: i64) {
        self.ram = [0; RAM_LENGTH];
        self.heard = [0; WINDOW_LENGTH as usize];
        self.late_requests.clear();
        self.late_answers.clear();
        self.page = 0;
        self.restart();
        self.running_ns = self.running_ns.saturating_add(off_ns.max(0));
    }

    /// The EEPROM, as it would be found after power-down.
    pub fn eeprom(&self) -> &Eeprom {
        &self.eeprom
    }

    /// Spoils the check sum of the EEPROM, which is found at the next RESET or start.
    pub fn spoil_eeprom(&mut self) {
        self.eeprom.spoil();
    }

    /// Number of times that the EEPROM has stored something.
    pub fn stores(&self) -> u64 {
        self.stores
    }

    /// Starts of the software.
    pub fn starts(&self) -> u64 {
        self.starts
    }

    /// Current in the windings of a motor, mA: none with phases off, the motor current in motion, else the holding
    /// current, which the motor current limits (3.1.4).
    pub fn current_ma(&self, axis: ModuleAxis) -> u32 {
        let of = self.axis(axis);
        let long = |parameter| self.active.get(Parameter::Axis(parameter, axis));
        let most = long(AxisParameter::MotorCurrent);
        if of.messages() & message::PHASES_OFF != 0 || !self.running {
            0
        } else if of.moving() {
            most
        } else {
            long(AxisParameter::HoldingCurrent).min(most)
        }
    }

    /// Current with which the motor test is made, mA: 60 or the holding current (3.1.1.13).
    pub fn test_current_ma(&self, axis: ModuleAxis) -> u32 {
        if self.axis(axis).settings().has(coefficient::TEST_AT_60_MA) {
            60
        } else {
            self.active.get(Parameter::Axis(AxisParameter::HoldingCurrent, axis))
        }
    }

    /// Interrupts that have taken effect.
    pub fn served(&self) -> u64 {
        self.served
    }

    /// The watchdog relay: dropped until the software runs, and with a wrong check sum (4, 8.1).
    pub fn watchdog(&self) -> bool {
        self.running && self.active.sound()
    }

    /// Position of an axis between its steps, µsteps.
    pub fn position(&self, axis: ModuleAxis) -> f64 {
        self.axis(axis).state().position
    }

    /// End of the programmed move under way, µsteps; the counter if there is none.
    pub fn target(&self, axis: ModuleAxis) -> i32 {
        self.axis(axis).target()
    }

    /// Speed of an axis, µsteps/s.
    pub fn velocity(&self, axis: ModuleAxis) -> f64 {
        self.axis(axis).state().velocity
    }

    /// Whole µstep of the shaft of a motor.
    pub fn shaft(&self, axis: ModuleAxis) -> i64 {
        self.axis(axis).shaft()
    }

    fn axis(&self, axis: ModuleAxis) -> &Axis {
        let [one, two] = &self.axes;
        match axis {
            ModuleAxis::One => one,
            ModuleAxis::Two => two,
        }
    }

    /// "Message codeur" of an axis.
    fn encoder_messages(&self, axis: ModuleAxis) -> u16 {
        let of = self.axis(axis);
        let plug = self.plugs.get(axis.index()).copied().flatten();
        let bits =
            [(encoder_message::PLUG, plug.is_none()), (encoder_message::CORRECTED, of.corrected())];
        let own = of.encoder().messages();
        bits.into_iter().filter(|(_, set)| *set).fold(own, |word, (bit, _)| word | bit)
    }
}
