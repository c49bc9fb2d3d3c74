//! One device of every family, with switches on its way, behind the trait.

use std::time::Duration;

use tempfile::TempDir;

use super::common::WallClock;
use twin_bim2ax as bim2ax;
use twin_bim2ax::{
    Bim2AxDrive, Bim2AxDriveOptions, Contact, MemoryFile, ModuleAxis,
    emulator::{Eeprom, EmulatedModule},
    protocol::{
        bits::coefficient,
        parameter::{AxisParameter, Parameter},
    },
};
use twin_drives::{Control, Drive, homing::Switch};
use twin_interpcnc as interpcnc;
use twin_interpcnc::{
    AxisOptions, BoardAxis, InterpCncDrive, InterpCncOptions,
    emulator::{Cam, EmulatedBoard, Wire},
};
use twin_smartdrive as smartdrive;
use twin_smartdrive::{
    SmartDriveBus, SmartDriveOptions, StepsPerTurn,
    emulator::{DeviceOptions, EmulatedBus, HomingOptions, Input},
};

/// A device of two axes. Its home switches are pressed from [`FAR`] to [`HOME`] increments from where the axes are, and
/// limit switches below [`Bench::limit`].
pub(crate) struct Bench {
    pub(crate) drive: Box<dyn Drive>,
    /// The clock of its emulator.
    pub(crate) clock: WallClock,
    /// Home switch of the first axis.
    pub(crate) home: Switch,
    /// First increment on which the negative limit switch is not pressed.
    pub(crate) limit: i32,
    /// Takes its supply away for a moment.
    pub(crate) brown_out: Box<dyn Fn()>,
    /// The files of its emulator.
    _files: Option<TempDir>,
}

/// First increment on which the home switches are not pressed, in the positive direction.
pub(crate) const HOME: i32 = -400;
/// Last increment on which they are, in the negative direction.
pub(crate) const FAR: i32 = -900;
/// Where the limit switches of boards and drives are; a module's are further out.
const LIMIT: i32 = -1500;

impl Bench {
    /// Enables it with the axes at 0 and 77.
    pub(crate) fn enable(&mut self) {
        self.drive.enable().unwrap();
        self.drive.set_position(&[0, 77, 0, 0, 0]).unwrap();
    }

    /// Waits until the axes are at rest.
    pub(crate) fn rest(&mut self) {
        while self.drive.sample(&self.clock).unwrap().moving {}
    }
}

/// Axes X and Y of an InterpCNC with home switches on IN5 and IN6, normally open, and a limit switch of X on IN8.
pub(crate) fn interpcnc() -> Bench {
    interpcnc_with(Wire::default(), interpcnc::Assumptions::default())
}

/// The same behind a wire and with an EEPROM that take hardly any time, for tests that write all of it.
pub(crate) fn quick_interpcnc() -> Bench {
    let wire = Wire { turnaround: Duration::ZERO, ..Wire::default() };
    let assumptions =
        interpcnc::Assumptions { eeprom_write_ns: 10_000, ..interpcnc::Assumptions::default() };
    interpcnc_with(wire, assumptions)
}

fn interpcnc_with(wire: Wire, assumptions: interpcnc::Assumptions) -> Bench {
    let clock = WallClock::new();
    let cam = |axis, input, from, to| Cam { input, axis, from, to, normally_closed: false };
    let mut options = interpcnc::emulator::EmulatorOptions { wire, ..Default::default() };
    options.board.assumptions = assumptions;
    options.bench.cams = vec![
        cam(BoardAxis::X, 5, FAR, HOME),
        cam(BoardAxis::Y, 6, FAR, HOME),
        cam(BoardAxis::X, 8, -1_000_000, LIMIT),
    ];
    let board = EmulatedBoard::start(&options, move || clock.now()).unwrap();
    let axis = |axis| AxisOptions {
        acceleration_khz_per_s: 500,
        deceleration_khz_per_s: 500,
        max_speed_hz: 100_000,
        ..AxisOptions::new(axis)
    };
    let mut options = InterpCncOptions::new(vec![axis(BoardAxis::X), axis(BoardAxis::Y)]);
    options.assumptions = assumptions;
    // Other tests and builds may keep the emulator waiting.
    options.deadline = Duration::from_secs(2);
    let drive = InterpCncDrive::open(board.path().to_str().unwrap(), &options).unwrap();
    let home = Switch::Input { number: 5, pressed: true };
    let brown_out = Box::new(move || {
        let event = interpcnc::emulator::Event::BrownOut { off_ns: 0 };
        board.control(Control::Event(event)).unwrap();
    });
    Bench { drive: Box::new(drive), clock, home, limit: LIMIT, brown_out, _files: None }
}

/// A drive of 3200 µsteps a turn, with its factory's ceilings.
pub(crate) fn smartdrive_axis(address: u8) -> smartdrive::AxisOptions {
    smartdrive::AxisOptions {
        address,
        turn: StepsPerTurn::new(200, 16).unwrap(),
        velocity_rpm: 500,
        acceleration_rpm_per_s: 2000,
        deceleration_rpm_per_s: 0,
    }
}

/// Drives 3 and 7 with home switches on DIR, sought in the negative direction.
pub(crate) fn smartdrive() -> Bench {
    let clock = WallClock::new();
    let cam = |input, from: i32, to: i32| smartdrive::emulator::Cam {
        input,
        from: from.into(),
        to: to.into(),
    };
    let device = |address| DeviceOptions {
        address,
        homing: HomingOptions { input: Input::Dir, positive: false, ..HomingOptions::default() },
        cams: vec![cam(Input::Dir, FAR, HOME), cam(Input::LimN, -1_000_000, LIMIT)],
        ..DeviceOptions::default()
    };
    let devices = vec![device(3), device(7)];
    let options = smartdrive::emulator::EmulatorOptions { devices, ..Default::default() };
    let bus = EmulatedBus::start(&options, move || clock.now()).unwrap();
    let mut options = SmartDriveOptions::new(vec![smartdrive_axis(3), smartdrive_axis(7)]);
    options.deadline = Duration::from_secs(2);
    options.mode_change = Duration::from_secs(10);
    let drive = SmartDriveBus::open(bus.path().to_str().unwrap(), &options).unwrap();
    let home = Switch::Input { number: 2, pressed: true };
    let brown_out = Box::new(move || {
        bus.control(smartdrive::emulator::Event::BrownOut { off_ns: 0 }.to(0)).unwrap();
    });
    Bench { drive: Box::new(drive), clock, home, limit: LIMIT, brown_out, _files: None }
}

/// Parameters of a module with both axes, and these bits of their coefficients.
pub(crate) fn eeprom(bits: u16) -> Eeprom {
    let mut eeprom = Eeprom::new(2000);
    for axis in ModuleAxis::ALL {
        let mut set = |parameter, value| eeprom.set(Parameter::Axis(parameter, axis), value);
        set(AxisParameter::Coefficient, (coefficient::PRESENT | bits).into());
        set(AxisParameter::Mode, 0x0060);
        set(AxisParameter::StartStopSpeed, 1000);
        set(AxisParameter::FastSpeed, 10_000);
        set(AxisParameter::Acceleration, 20_000);
    }
    eeprom
}

/// Both axes of a BIM2AX-BOCM with cams, and end switches at ±3000.
pub(crate) fn bim2ax() -> Bench {
    let clock = WallClock::new();
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("eeprom");
    let eeprom = eeprom(coefficient::CAM_CLOSES | coefficient::SWITCHES_CLOSE);
    std::fs::write(&image, eeprom.to_bytes()).unwrap();
    let path = folder.path().join("module");
    let mut options = bim2ax::emulator::EmulatorOptions::new(&path);
    options.eeprom = Some(image);
    options.module.boot_ns = 0;
    for bench in &mut options.surroundings.benches {
        bench.plus = Some(Contact::above(3000, true));
        bench.minus = Some(Contact::below(-3000, true));
        bench.cam = Some(Contact::between(FAR.into(), i64::from(HOME) - 1, true));
    }
    let module = EmulatedModule::start(&options, move || clock.now()).unwrap();
    // Until its status is there, the file is that of a module that runs and has no identifier.
    let mut memory = MemoryFile::shared(module.path()).unwrap();
    let mut identifier = [0];
    while identifier != [0x4E] {
        bim2ax::Memory::read(&mut memory, 0xFF, &mut identifier).unwrap();
        std::thread::yield_now();
    }
    let mut options = Bim2AxDriveOptions::new();
    options.driver.deadline = Duration::from_secs(5);
    options.driver.reset_deadline = Duration::from_secs(20);
    let memory = MemoryFile::open(module.path()).unwrap();
    let drive = Bim2AxDrive::new(module.path().to_str().unwrap(), memory, &options).unwrap();
    let (home, limit) = (Switch::Home, -2999);
    let brown_out = Box::new(move || {
        let event = bim2ax::emulator::Event::BrownOut { off_ns: 0 };
        module.control(Control::Event(event));
    });
    Bench { drive: Box::new(drive), clock, home, limit, brown_out, _files: Some(folder) }
}

/// Makes a check with a device of each family, whose name a failure shows.
pub(crate) fn in_every_family(interpcnc: fn() -> Bench, check: fn(Bench)) {
    let starts = [interpcnc, smartdrive, bim2ax];
    for (family, start) in ["InterpCNC", "SmartDRIVE", "BIM2AX"].into_iter().zip(starts) {
        println!("{family}");
        check(start());
    }
}
