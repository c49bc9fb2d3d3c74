//! Test rig: a device of each family, emulated at the far end of its real transport and driven by its real driver.

use std::time::{Duration, Instant};

use tempfile::TempDir;
use twin_bim2ax as bim2ax;
use twin_bim2ax::{
    Bim2AxDrive, Bim2AxDriveOptions, Contact, EncoderBench, MemoryFile, ModuleAxis,
    emulator::{EmulatedModule, Module, ModuleOptions},
    protocol::{
        bits::definition,
        parameter::{AxisParameter, Parameter},
    },
};
use twin_drives::{
    Accelerated, Action, Clock, Control, Direction, Drive, DriveError, Exchange, FaultRule,
    IncrementMotion, MAX_DRIVE_AXES, ParameterId, SetpointStream, Speed, When, WireFault,
};
use twin_interpcnc as interpcnc;
use twin_interpcnc::{
    BoardAxis, EncoderOptions, Following, InterpCncDrive, InterpCncOptions,
    emulator::{Bench, BoardOptions, Cam, EmulatedBoard, EncoderLink},
};
use twin_smartdrive as smartdrive;
use twin_smartdrive::{
    Alarms, Mode, SmartDriveBus, SmartDriveOptions, StepsPerTurn, TagLayout,
    emulator::{DeviceOptions, EmulatedBus, Input},
};

use crate::{
    assumed::Otherwise,
    faults::{DeviceFault, Family},
    scenario::SENSES,
};

/// Speed of devices and plans relative to the wall clock.
pub(crate) const SPEED: u32 = 5;
/// Longest time the drivers wait for an answer: other tests and builds may keep the emulator waiting.
pub(crate) const DEADLINE: Duration = Duration::from_millis(400);
/// Frames that are delayed come after the deadline and before the driver trusts the wire again.
const DELAY: Duration = Duration::from_millis(500);
pub(crate) const WORST_LATENCY: Duration = Duration::from_millis(650);
/// Duration of a supply outage: longer than the drivers wait for one answer, repeats and late ones included.
pub(crate) const OUTAGE: Duration = Duration::from_secs(5);
/// Longest time that homing may take, ns of the device.
const HOMING_NS: i64 = 20_000_000_000;
/// Looks for a fault of a module at its interface, 1 ms apart: longer than its emulator waits between two looks.
const SETTLING_LOOKS: u32 = 2000;
/// How far a plan is known ahead: shorter than drivers wait for an answer.
const HORIZON: Duration = Duration::from_millis(100);
/// The longest way to the home switch, increments, for devices that take one.
pub(crate) const HOMING_WAY: u32 = 12_000;
/// Release positions of the home switches of drives on a line, increments: at another place in each.
const SWITCHES: [f64; 2] = [-15_000.0, -18_000.0];
/// Segments that are left in a board's buffer, the way of each, increments, and their speed, increments/s: half a minute of
/// the device.
const SEGMENTS: i32 = 15;
const SEGMENT: i32 = 4000;
const SEGMENT_HZ: u32 = 2000;

/// The wall clock, from its first look on.
#[derive(Clone, Copy)]
struct Wall(Instant);

impl Clock for Wall {
    fn now_ns(&self) -> i64 {
        nanoseconds(self.0.elapsed())
    }
}

/// The clock of devices and plans.
#[derive(Clone, Copy)]
pub(crate) struct RigClock {
    clock: Accelerated<Wall>,
    /// Device time per wall time.
    pub(crate) speed: u32,
}

impl RigClock {
    #[expect(
        clippy::disallowed_methods,
        reason = "drives on real transports need real time, if a fast one; nothing here is judged by it"
    )]
    pub(crate) fn new(speed: u32) -> Self {
        Self { clock: Accelerated::new(Wall(Instant::now()), Speed::times(speed)), speed }
    }

    /// A duration of the wall clock in device time, ns.
    fn ns(self, duration: Duration) -> i64 {
        nanoseconds(duration) * i64::from(self.speed)
    }

    /// How far plans are known ahead, ns of the device.
    pub(crate) fn horizon_ns(self) -> i64 {
        self.ns(HORIZON)
    }
}

impl Clock for RigClock {
    fn now_ns(&self) -> i64 {
        self.clock.now_ns()
    }

    fn wait(&self, ns: i64) -> Duration {
        self.clock.wait(ns)
    }
}

fn nanoseconds(duration: Duration) -> i64 {
    i64::try_from(duration.as_nanos()).expect("not for 292 years")
}

/// Nobody's plan: rest at 0.
pub(crate) struct Rest(pub(crate) RigClock);

impl SetpointStream for Rest {
    fn now_ns(&self) -> i64 {
        self.0.now_ns()
    }

    fn at(&self, _: i64) -> IncrementMotion {
        IncrementMotion::default()
    }

    fn horizon_ns(&self) -> i64 {
        1_000_000_000
    }
}

/// True state of the device, independent of the driver.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Truth {
    /// Counter, increments.
    pub(crate) counter: i64,
    /// True if the axis moves.
    pub(crate) moving: bool,
    /// True if another axis of its line moves.
    pub(crate) other_moves: bool,
    /// Segments that wait in the device's buffer.
    pub(crate) waiting: usize,
    /// Position of the mechanics, increments from the start.
    pub(crate) mechanical: f64,
    /// The axes one by one; only the first where there is no other.
    pub(crate) axes: [AxisTruth; 2],
}

/// True state of one axis.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AxisTruth {
    /// Target that the device itself moves to; none if it has no target.
    pub(crate) target: Option<i64>,
    pub(crate) counter: i64,
    pub(crate) mechanical: f64,
}

impl Truth {
    /// True if the first `count` axes are not past their targets, where they have targets.
    #[expect(clippy::cast_precision_loss, reason = "small numbers")]
    pub(crate) fn goes_ahead(&self, count: usize) -> bool {
        SENSES.into_iter().zip(&self.axes).take(count).all(|(sense, axis)| {
            let ahead = |target: i64| (sense * target) as f64 >= sense as f64 * axis.mechanical;
            axis.target.is_none_or(ahead)
        })
    }

    fn of(axes: [AxisTruth; 2], moving: bool, other_moves: bool) -> Self {
        let AxisTruth { counter, mechanical, .. } = axes[0];
        Self { counter, moving, other_moves, waiting: 0, mechanical, axes }
    }
}

enum Device {
    Board(EmulatedBoard, Option<InterpCncDrive>),
    Bus(EmulatedBus, Option<SmartDriveBus>),
    /// Its files are in a folder that lives as long as it.
    Module(EmulatedModule, Option<Bim2AxDrive>, #[expect(dead_code, reason = "kept")] TempDir),
}

/// A device and its driver; one axis.
pub(crate) struct Rig {
    device: Device,
    pub(crate) clock: RigClock,
    /// Position that the followed plan had reached when the fault occurred.
    pub(crate) reached: Option<f64>,
    /// End of the last segment that was left in the device's buffer.
    pub(crate) queued: Option<i64>,
    /// Counters of the axes at the driver's position 0.
    origin: [i64; 2],
}

impl Rig {
    /// The seed decides which bytes faults befall.
    pub(crate) fn new(family: Family, seed: u64, clock: RigClock) -> Self {
        Self::assuming(family, seed, clock, None)
    }

    /// The same where something is otherwise than usually assumed, on both sides.
    pub(crate) fn assuming(
        family: Family,
        seed: u64,
        clock: RigClock,
        otherwise: Option<Otherwise>,
    ) -> Self {
        let device = match family {
            Family::InterpCnc => board(clock, seed, Following::Retargeted, otherwise),
            Family::Segments => {
                let acceleration_khz_per_s = 50;
                board(
                    clock,
                    seed,
                    Following::Buffered { start_stop_hz: 200, acceleration_khz_per_s },
                    otherwise,
                )
            }
            Family::SmartDrive => bus(clock, seed, 1, otherwise),
            Family::Pair => bus(clock, seed, 2, otherwise),
            Family::Bim2Ax => module(clock, seed, otherwise),
        };
        Self { device, clock, reached: None, queued: None, origin: [0; 2] }
    }

    /// The driver leaves: another may open the port.
    pub(crate) fn leave(&mut self) {
        match &mut self.device {
            Device::Board(_, drive) => *drive = None,
            Device::Bus(_, drive) => *drive = None,
            Device::Module(_, drive, _) => *drive = None,
        }
    }

    /// Port of the device, for a driver.
    pub(crate) fn port(&self) -> &str {
        match &self.device {
            Device::Board(board, _) => board.path().to_str().expect("a name"),
            Device::Bus(bus, _) => bus.path().to_str().expect("a name"),
            Device::Module(module, ..) => module.path().to_str().expect("a name"),
        }
    }

    pub(crate) fn drive(&mut self) -> &mut dyn Drive {
        match &mut self.device {
            Device::Board(_, drive) => drive.as_mut().expect("it has not left"),
            Device::Bus(_, drive) => drive.as_mut().expect("it has not left"),
            Device::Module(_, drive, _) => drive.as_mut().expect("it has not left"),
        }
    }

    /// Position after homing, increments from the start: the edge of its switch.
    pub(crate) fn switch(&self) -> f64 {
        match &self.device {
            Device::Board(..) => -3000.0,
            Device::Bus(..) => SWITCHES[0],
            Device::Module(..) => -1500.0,
        }
    }

    /// The switches of all axes of the line.
    fn switches(&self) -> Vec<f64> {
        match &self.device {
            Device::Bus(bus, _) => {
                let count = bus.look().expect("the emulator runs").len();
                (0..count).map(|index| SWITCHES[index]).collect()
            }
            _ => vec![self.switch()],
        }
    }

    /// True if every axis is on its own switch.
    pub(crate) fn is_on_switches(&self) -> bool {
        let truth = self.truth();
        let mut axes = truth.axes.iter().zip(self.switches());
        axes.all(|(axis, switch)| (axis.mechanical - switch).abs() < 300.0)
    }

    /// True if a device obeys nothing after a hard stop until it is enabled.
    pub(crate) fn is_off_after_hard_stop(&self) -> bool {
        !matches!(self.device, Device::Module(..))
    }

    /// Leaves segments from a place on in the buffer of a board that follows by them, more than are carried out before a
    /// stop that is lost has been sent again.
    pub(crate) fn queue_segments(&mut self, from: i32) -> Result<(), DriveError> {
        let Device::Board(_, Some(drive)) = &mut self.device else { return Ok(()) };
        let clock = self.clock;
        let (board, runtime) = drive.board();
        for target in (1..=SEGMENTS).map(|count| from + count * SEGMENT) {
            let targets = [Some(target), None, None, None, None];
            let segment = interpcnc::Command::Interpolated { speed_hz: SEGMENT_HZ, targets };
            runtime.block_on(board.send(&segment, &clock))?;
            self.queued = Some(target.into());
        }
        Ok(())
    }

    /// Number of the request that carries the target in a move from rest: a module is read before, and once more if an
    /// order to one axis could end a move of the other.
    pub(crate) fn order(&self, otherwise: Option<Otherwise>) -> u32 {
        let again = otherwise.is_some_and(Otherwise::looks_at_the_others);
        if matches!(self.device, Device::Module(..)) { 2 + u32::from(again) } else { 1 }
    }

    /// Number of the request that starts homing: a board is asked first if it has a home switch (parameter 29), and its
    /// error of an earlier homing is cleared (command 66).
    pub(crate) fn homing_order(&self) -> u32 {
        if matches!(self.device, Device::Board(..)) { 3 } else { 1 }
    }

    /// Prepares a device for its first homing.
    pub(crate) fn prepare_homing(&mut self) -> Result<(), DriveError> {
        let is_board = matches!(self.device, Device::Board(..));
        if is_board { prepare_homing(self.drive()) } else { Ok(()) }
    }

    /// Homes all axes as `twin run` does, and waits for them.
    pub(crate) fn home(&mut self) -> Result<(), DriveError> {
        let rest = Rest(self.clock);
        let mut ways = [None; MAX_DRIVE_AXES];
        let count = self.drive().axis_count();
        ways.iter_mut().take(count).for_each(|way| *way = Some(HOMING_WAY));
        let begun_ns = self.clock.now_ns();
        self.drive().begin_homing(&ways)?;
        let at = || Exchange { port: "rig".into(), address: 1, action: Action::ReadState };
        while self.drive().sample(&rest)?.moving {
            if self.clock.now_ns() - begun_ns > HOMING_NS {
                let patience = Duration::from_nanos(HOMING_NS.unsigned_abs());
                return Err(DriveError::Unfinished { at: at(), patience });
            }
        }
        let homed = self.drive().homed()?;
        if homed.iter().take(count).all(|homed| *homed == Some(true)) {
            return Ok(());
        }
        Err(DriveError::NotHomed { at: at() })
    }

    /// The driver is at position 0, and nothing is planned any more. A family may keep its zero in the driver alone.
    pub(crate) fn note_origin(&mut self) {
        (self.reached, self.queued, self.origin) = (None, None, [0; 2]);
        self.origin = self.truth().axes.map(|axis| axis.counter);
    }

    /// True state; counters and targets from the driver's position 0.
    pub(crate) fn truth(&self) -> Truth {
        let mut truth = self.raw_truth();
        for (axis, origin) in truth.axes.iter_mut().zip(self.origin) {
            axis.counter -= origin;
            axis.target = axis.target.map(|target| target - origin);
        }
        truth.counter = truth.axes[0].counter;
        truth
    }

    fn raw_truth(&self) -> Truth {
        match &self.device {
            Device::Board(board, _) => {
                let board = board.look().expect("the emulator runs");
                let axis = AxisTruth {
                    target: Some(board.target(BoardAxis::X).into()),
                    counter: board.counters()[0].into(),
                    mechanical: board.mechanical(BoardAxis::X),
                };
                let moving = board.velocity(BoardAxis::X) != 0.0;
                let waiting = board.waiting_segments();
                Truth { waiting, ..Truth::of([axis, AxisTruth::default()], moving, false) }
            }
            Device::Bus(bus, _) => {
                let devices = bus.look().expect("the emulator runs");
                let mut axes = [AxisTruth::default(); 2];
                for (axis, device) in axes.iter_mut().zip(&devices) {
                    *axis = AxisTruth {
                        target: device.target().map(i64::from),
                        counter: device.counter().into(),
                        mechanical: device.mechanical(),
                    };
                }
                let moves = |device: &smartdrive::emulator::Device| device.motion().1 != 0.0;
                Truth::of(axes, moves(&devices[0]), devices.iter().skip(1).any(moves))
            }
            Device::Module(module, ..) => {
                let module = module.module();
                #[expect(clippy::cast_possible_truncation, reason = "a counter")]
                let counter = module.position(ModuleAxis::One).round() as i64;
                #[expect(clippy::cast_precision_loss, reason = "a counter")]
                let mechanical = module.shaft(ModuleAxis::One) as f64;
                let target = Some(module.target(ModuleAxis::One).into());
                let moving = module.velocity(ModuleAxis::One) != 0.0;
                let axis = AxisTruth { target, counter, mechanical };
                Truth::of([axis, AxisTruth::default()], moving, false)
            }
        }
    }

    /// Something goes wrong with the wire, with so many frames from the next on; 0: with all.
    pub(crate) fn spoil(&self, direction: Direction, fault: WireFault, frames: u32, after: u32) {
        let fault = match fault {
            WireFault::Delay { ns: 0 } => WireFault::Delay { ns: self.clock.ns(DELAY) },
            other => other,
        };
        let when = if frames == 0 { When::Always } else { When::Next(frames) };
        let rule = FaultRule { direction, when, fault };
        match &self.device {
            Device::Board(board, _) => {
                board.control(Control::Fault(rule).after(after)).expect("the emulator runs");
            }
            Device::Bus(bus, _) => {
                bus.control(Control::Fault(rule).after(after)).expect("the emulator runs");
            }
            Device::Module(module, ..) => module.control(Control::Fault(rule).after(after)),
        }
    }

    /// Something goes wrong with the device (true), or no more, with the so-many-th request from now; 0: now.
    pub(crate) fn upset(&self, fault: DeviceFault, on: bool, after: u32) {
        let off_ns = self.clock.ns(OUTAGE);
        let ignored = if on { u32::MAX } else { 0 };
        match &self.device {
            Device::Board(board, _) => {
                use interpcnc::emulator::Event;
                let event = |event| Control::Event(event);
                let what = match fault {
                    DeviceFault::BrownOut => event(Event::BrownOut { off_ns: 0 }),
                    DeviceFault::Outage => event(Event::BrownOut { off_ns }),
                    DeviceFault::Stall => event(Event::Stall(BoardAxis::X, on)),
                    DeviceFault::Alarm => event(Event::Enable(!on)),
                    DeviceFault::Stuck => event(Event::StuckStatus(on)),
                    DeviceFault::Ignored => event(Event::IgnoreMoves(ignored)),
                    DeviceFault::Gone => Control::Disconnect(on),
                };
                board.control(what.after(after)).expect("the emulator runs");
            }
            Device::Bus(bus, _) => {
                use smartdrive::emulator::Event;
                let what = match fault {
                    DeviceFault::BrownOut => Event::BrownOut { off_ns: 0 }.to(0),
                    DeviceFault::Outage => Event::BrownOut { off_ns }.to(0),
                    DeviceFault::Stall => Event::Stall.to(0),
                    DeviceFault::Alarm => {
                        Event::Fault { alarms: Alarms::OVERTEMPERATURE, present: on }.to(0)
                    }
                    DeviceFault::Stuck => Event::StuckStatus(on).to(0),
                    DeviceFault::Ignored => Event::IgnoreMoves(ignored).to(0),
                    DeviceFault::Gone => Control::Disconnect(on),
                };
                bus.control(what.after(after)).expect("the emulator runs");
            }
            Device::Module(module, ..) => {
                use bim2ax::emulator::Event;
                let what = match fault {
                    DeviceFault::BrownOut => Control::Event(Event::BrownOut { off_ns: 0 }),
                    DeviceFault::Outage => Control::Event(Event::BrownOut { off_ns }),
                    DeviceFault::Stall => Control::Event(Event::Stall(ModuleAxis::One, on)),
                    DeviceFault::Alarm => Control::Event(Event::Power(ModuleAxis::One, !on)),
                    DeviceFault::Stuck => Control::Event(Event::StuckStatus(on)),
                    DeviceFault::Ignored => Control::Event(Event::IgnoreMoves(ignored)),
                    DeviceFault::Gone => Control::Disconnect(on),
                };
                module.control(what.after(after));
            }
        }
    }

    /// Random choices of the wire start anew.
    pub(crate) fn set_seed(&self, seed: u64) {
        match &self.device {
            Device::Board(board, _) => board.control(Control::Seed(seed)).expect("it runs"),
            Device::Bus(bus, _) => bus.control(Control::Seed(seed)).expect("it runs"),
            Device::Module(module, ..) => module.control(Control::Seed(seed)),
        }
    }

    /// The wire is sound again.
    pub(crate) fn mend(&self) {
        match &self.device {
            Device::Board(board, _) => board.control(Control::NoFaults).expect("it runs"),
            Device::Bus(bus, _) => bus.control(Control::NoFaults).expect("it runs"),
            Device::Module(module, ..) => module.control(Control::NoFaults),
        }
    }

    /// Waits until a fault of the device shows at its interface, as far as that takes time; true if it does.
    pub(crate) fn settle(&self, fault: DeviceFault) -> bool {
        match (&self.device, fault) {
            (Device::Board(board, _), DeviceFault::Alarm) => {
                // The filter of the ENABLE input.
                while !board.look().expect("the emulator runs").status().enable_open() {
                    std::thread::sleep(Duration::from_millis(1));
                }
                true
            }
            (
                Device::Module(module, ..),
                DeviceFault::BrownOut | DeviceFault::Outage | DeviceFault::Gone,
            ) => {
                // The emulator writes its status byte into the file when it next looks at it.
                let mut memory = MemoryFile::shared(module.path()).expect("it is there");
                (0..SETTLING_LOOKS).any(|_| {
                    std::thread::sleep(Duration::from_millis(1));
                    let mut status = [0];
                    bim2ax::Memory::read(&mut memory, 0xFD, &mut status).expect("it is there");
                    status[0] & 1 != 0
                })
            }
            _ => true,
        }
    }

    /// The supply of the line off and on again by hand: the only way to reset a drive in its bootloader.
    pub(crate) fn power_cycle(&self) {
        if let Device::Bus(bus, _) = &self.device {
            for index in 0..bus.look().expect("the emulator runs").len() {
                let off = smartdrive::emulator::Event::BrownOut { off_ns: 0 }.to(index);
                bus.control(off).expect("the emulator runs");
            }
        }
    }
}

/// The parameters with which an InterpCNC homes.
pub(crate) fn prepare_homing(drive: &mut dyn Drive) -> Result<(), DriveError> {
    // Switch on IN1, speed, acceleration, start-stop, slow.
    let parameters = [(29, 1), (12, 2000), (13, 50), (14, 400), (15, 1000)];
    parameters.into_iter().try_for_each(|(number, value)| {
        drive.set_parameter(ParameterId { address: 0, number }, value)
    })
}

fn board(clock: RigClock, seed: u64, following: Following, otherwise: Option<Otherwise>) -> Device {
    let switch =
        Cam { input: 1, axis: BoardAxis::X, from: -9000, to: -3000, normally_closed: false };
    let has_encoder = otherwise.is_some_and(Otherwise::has_encoder);
    let mut assumptions = interpcnc::Assumptions::default();
    if let Some(otherwise) = otherwise {
        otherwise.assume(&mut assumptions);
    }
    let options = interpcnc::emulator::EmulatorOptions {
        board: BoardOptions { assumptions, ..BoardOptions::default() },
        bench: Bench { cams: vec![switch], encoder: has_encoder.then_some(ENCODER) },
        seed,
        ..interpcnc::emulator::EmulatorOptions::default()
    };
    let board = EmulatedBoard::start(&options, clock).expect("it starts");
    let axis = interpcnc::AxisOptions {
        acceleration_khz_per_s: 100,
        deceleration_khz_per_s: 100,
        max_speed_hz: 20_000,
        ..interpcnc::AxisOptions::new(BoardAxis::X)
    };
    let mut options = InterpCncOptions::new(vec![axis]);
    options.assumptions = assumptions;
    options.following = following;
    options.encoder = has_encoder.then_some(EncoderOptions {
        axis: ENCODER.axis,
        points: ENCODER.counts,
        increments: ENCODER.steps,
        tolerance: ENCODER_TOLERANCE,
    });
    (options.deadline, options.turnaround) = (DEADLINE, Duration::ZERO);
    options.worst_latency = WORST_LATENCY;
    let path = board.path().to_str().expect("a name").to_owned();
    let drive = InterpCncDrive::open(&path, &options).expect("it opens");
    Device::Board(board, Some(drive))
}

/// The encoder of a board that has one, and how far it may be from the counter, increments: a shaft that is held while its axis
/// stops out of the plan stays (1300² − 200²)/200000 = 8 increments behind.
const ENCODER: EncoderLink =
    EncoderLink { axis: BoardAxis::X, counts: 4, steps: 1, counts_per_revolution: 0 };
const ENCODER_TOLERANCE: u32 = 2;

/// Addresses of drives. Not 1, with which two bytes of a PING that change places make a RESET.
const FIRST: u8 = 2;

fn bus(clock: RigClock, seed: u64, count: u8, otherwise: Option<Otherwise>) -> Device {
    let mut assumptions = smartdrive::Assumptions::default();
    if let Some(otherwise) = otherwise {
        otherwise.assume(&mut assumptions);
    }
    let layout = otherwise.map_or(TagLayout::Diagram, Otherwise::layout);
    let addresses = FIRST..FIRST + count;
    let switch = |address: u8| {
        let to = SWITCHES[usize::from(address - FIRST)];
        smartdrive::emulator::Cam { input: Input::Go, from: -90_000.0, to }
    };
    let device = |address| DeviceOptions {
        address,
        cams: vec![switch(address)],
        configured_mode: Mode::Off,
        assumptions,
        layout,
        ..DeviceOptions::default()
    };
    let options = smartdrive::emulator::EmulatorOptions {
        devices: addresses.clone().map(device).collect(),
        seed,
        ..smartdrive::emulator::EmulatorOptions::default()
    };
    let bus = EmulatedBus::start(&options, clock).expect("it starts");
    let axis = |address| smartdrive::AxisOptions {
        address,
        turn: StepsPerTurn::new(200, 16).expect("a turn"),
        velocity_rpm: 500,
        acceleration_rpm_per_s: 2000,
        deceleration_rpm_per_s: 2000,
    };
    let mut options = SmartDriveOptions::new(addresses.map(axis).collect());
    (options.deadline, options.turnaround) = (DEADLINE, Duration::ZERO);
    options.worst_latency = WORST_LATENCY;
    options.assumptions = assumptions;
    options.mode_change = Duration::from_secs(10);
    let path = bus.path().to_str().expect("a name").to_owned();
    let drive = SmartDriveBus::open(&path, &options).expect("it opens");
    Device::Bus(bus, Some(drive))
}

fn module(clock: RigClock, seed: u64, otherwise: Option<Otherwise>) -> Device {
    let folder = tempfile::tempdir().expect("a folder");
    let image = folder.path().join("eeprom");
    let mut eeprom = bim2ax::emulator::Eeprom::new(2000);
    let values = [
        (AxisParameter::Mode, 0x0060),
        (AxisParameter::StartStopSpeed, 1000),
        (AxisParameter::FastSpeed, 10_000),
        (AxisParameter::Acceleration, 20_000),
    ];
    let has_encoder = otherwise.is_some_and(Otherwise::has_encoder);
    let encoder = [
        (AxisParameter::Dividend, 12_800),
        (AxisParameter::Divisor, 4000),
        (AxisParameter::EncoderDefinition, definition::PRESENT.into()),
    ];
    let encoder = encoder.into_iter().filter(|_| has_encoder);
    for (parameter, value) in values.into_iter().chain(encoder) {
        eeprom.set(Parameter::Axis(parameter, ModuleAxis::One), value);
    }
    std::fs::write(&image, eeprom.to_bytes()).expect("it is written");
    let mut options = bim2ax::emulator::EmulatorOptions::new(&folder.path().join("module"));
    options.eeprom = Some(image);
    options.seed = seed;
    options.surroundings.benches[0].cam = Some(Contact::between(-9000, -1500, true));
    options.surroundings.encoders[0] = has_encoder.then(|| EncoderBench {
        points_per_turn: 4000,
        microsteps_per_turn: 12_800,
        ..EncoderBench::default()
    });
    // Long enough to be seen by a driver that has to wait for its turn.
    options.module.boot_ns = 2_000_000_000;
    if let Some(otherwise) = otherwise {
        otherwise.assume(&mut options.module.assumptions);
        options.module.byte_order = otherwise.byte_order();
        options.module.phases_on_order = otherwise.phases_on_order();
    }
    let ModuleOptions { assumptions, byte_order, .. } = options.module;
    let module = EmulatedModule::start(&options, clock).expect("it starts");
    while !runs(&module.module()) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let mut options = Bim2AxDriveOptions::new();
    options.axes = vec![ModuleAxis::One];
    if has_encoder {
        (options.encoder_axes, options.encoder_tolerance) = (options.axes.clone(), Some(0));
    }
    (options.driver.assumptions, options.driver.byte_order) = (assumptions, byte_order);
    (options.driver.deadline, options.driver.worst_latency) = (DEADLINE, WORST_LATENCY);
    let path = module.path().to_str().expect("a name").to_owned();
    let memory = MemoryFile::open(module.path()).expect("it is there");
    let drive = Bim2AxDrive::new(&path, memory, &options).expect("it opens");
    Device::Module(module, Some(drive), folder)
}

fn runs(module: &Module) -> bool {
    module.bus_read(0xFD) & 1 == 0
}
