//! The module as a drive: in real time on a memory file served by another thread, and in virtual time.

use super::*;
use crate::Fault;
use crate::tests::common::wall_clock;
use crate::{
    Bim2AxDrive, Bim2AxDriveOptions, MemoryFile,
    emulator::{Control, EmulatedModule, EmulatorOptions, Event},
    protocol::bits::message,
};
use twin_drives::{
    Axes, Direction, Drive, DriveError, FaultRule, IncrementMotion, SetpointStream, When, WireFault,
};

/// A plan of two axes: a line to and fro, at rest before and after.
pub(super) struct Plan<C> {
    pub(super) clock: C,
    pub(super) start_ns: i64,
}

/// µsteps and seconds of half the plan.
const STROKE: f64 = 600.0;
const HALF_S: f64 = 0.75;

#[expect(clippy::cast_precision_loss, reason = "seconds")]
impl<C: Fn() -> i64 + Sync> SetpointStream for Plan<C> {
    fn now_ns(&self) -> i64 {
        (self.clock)() - self.start_ns
    }

    fn at(&self, time_ns: i64) -> IncrementMotion {
        // From −1 to 1: the plan turns at 0.
        let part = (time_ns as f64 * 1e-9 / HALF_S - 1.0).clamp(-1.0, 1.0);
        let sense = if part.abs() < 1.0 { -part.signum() } else { 0.0 };
        let mut motion = IncrementMotion::default();
        for (axis, stroke) in [STROKE, -0.5 * STROKE].into_iter().enumerate() {
            motion.position[axis] = stroke * (1.0 - part.abs());
            motion.velocity[axis] = stroke / HALF_S * sense;
        }
        motion
    }

    fn horizon_ns(&self) -> i64 {
        250_000_000
    }
}

/// An emulator on a memory file in a folder that lives as long as it.
fn emulated() -> (tempfile::TempDir, EmulatedModule) {
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("eeprom");
    std::fs::write(&image, eeprom().to_bytes()).unwrap();
    let mut options = EmulatorOptions::new(&folder.path().join("module"));
    options.eeprom = Some(image);
    options.surroundings = surroundings();
    options.module.boot_ns = 0;
    let module = EmulatedModule::start(&options, wall_clock()).unwrap();
    // Until its status is there, the file is that of a module that runs and has no identifier.
    let mut memory = MemoryFile::shared(module.path()).unwrap();
    let mut identifier = [0];
    while identifier != [0x4E] {
        crate::Memory::read(&mut memory, 0xFF, &mut identifier).unwrap();
        std::thread::yield_now();
    }
    (folder, module)
}

/// A drive whose deadlines are for a machine that does other things, too, enabled; and a plan that has not begun.
fn drive(module: &EmulatedModule) -> (Bim2AxDrive, Plan<impl Fn() -> i64 + Sync + Copy + use<>>) {
    let mut options = Bim2AxDriveOptions::new();
    options.driver.deadline = Duration::from_secs(5);
    let path = module.path();
    let memory = MemoryFile::open(path).unwrap();
    let mut drive = Bim2AxDrive::new(path.to_str().unwrap(), memory, &options).unwrap();
    let plan = Plan { clock: wall_clock(), start_ns: i64::MAX / 2 };
    let first = drive.probe(&plan).unwrap();
    assert_eq!((first.position, first.moving), ([0; 5], false));
    drive.enable().unwrap();
    (drive, plan)
}

#[test]
fn it_follows_a_plan_and_ends_on_it() {
    let (_folder, module) = emulated();
    let (mut drive, mut plan) = drive(&module);
    plan.start_ns = (plan.clock)() + 300_000_000;
    let mut farthest = [0, 0];
    let mut samples = 0;
    while plan.now_ns() < 2_000_000_000 {
        let sample = drive.follow(&plan).unwrap();
        samples += 1;
        farthest[0] = farthest[0].max(sample.position[0]);
        farthest[1] = farthest[1].min(sample.position[1]);
    }
    let last = drive.sample(&plan).unwrap();
    assert_eq!((last.position, last.moving), ([0; 5], false));
    // How far it got before the plan turned depends on what else this machine had to do; beyond it must not go.
    assert!((0..=600).contains(&farthest[0]), "{farthest:?} in {samples} samples");
    assert!((-300..=0).contains(&farthest[1]), "{farthest:?} in {samples} samples");
}

#[test]
fn positions_moves_homing_and_stops() {
    let (_folder, module) = emulated();
    let (mut drive, plan) = drive(&module);
    let at = |one, two| [one, two, 0, 0, 0];
    drive.set_position(&at(700, -900)).unwrap();
    assert_eq!(drive.sample(&plan).unwrap().position, at(700, -900));

    drive.move_to(&at(800, -950), &[4000.0; 5]).unwrap();
    while drive.sample(&plan).unwrap().moving {}
    assert_eq!(drive.sample(&plan).unwrap().position, at(800, -950));

    drive.home(Duration::from_secs(20)).unwrap();
    assert_eq!(drive.sample(&plan).unwrap().position, [0; 5]);
    assert_eq!(module.module().shaft(ModuleAxis::One), -400);

    // Half a minute each, so that the stops come before the ends.
    drive.move_to(&at(2900, 0), &[100.0; 5]).unwrap();
    drive.soft_stop().unwrap();
    let stopped = drive.sample(&plan).unwrap();
    assert!(!stopped.moving && stopped.position[0] < 2900);

    drive.move_to(&at(2900, 0), &[100.0; 5]).unwrap();
    drive.hard_stop().unwrap();
    let error = drive.sample(&plan).unwrap_err();
    let Some(Fault::AxisMessages { axis: 1, messages }) = error.fault() else { panic!("{error}") };
    assert_ne!(messages & message::HARD_STOPPED, 0, "{error}");
    for (place, speed) in [(2900, 0.2), (4_194_304, 1000.0)] {
        let error = drive.move_to(&at(place, 0), &[speed; 5]).unwrap_err();
        assert!(matches!(error, DriveError::Range { .. }), "{error}");
    }
    assert!(matches!(drive.set_output(1, true), Err(DriveError::Unsupported { .. })));
}

#[test]
fn an_eeprom_survives_a_restart_and_the_file_goes_with_the_emulator() {
    let (folder, module) = emulated();
    let (mut drive, plan) = drive(&module);
    drive.move_to(&[40, -60, 0, 0, 0], &[1000.0; 5]).unwrap();
    while drive.sample(&plan).unwrap().moving {}
    let path = module.path().to_path_buf();
    let stored = module.stop().unwrap().eeprom().clone();
    assert!(!path.exists());
    let image = std::fs::read(folder.path().join("eeprom")).unwrap();
    assert_eq!(Eeprom::from_bytes(&image), stored);
    let last = Parameter::Axis(AxisParameter::LastPosition, ModuleAxis::Two);
    assert_eq!(stored.get(last).cast_signed(), -60);
}

#[test]
fn files_that_are_no_memory_or_in_use_are_left_alone() {
    let (folder, module) = emulated();
    let second = EmulatedModule::start(&EmulatorOptions::new(module.path()), || 0);
    assert!(matches!(second, Err(twin_drives::EmulatorError::LinkTaken { .. })));
    assert!(module.path().exists());
    let precious = folder.path().join("precious");
    std::fs::write(&precious, "precious").unwrap();
    let refused = EmulatedModule::start(&EmulatorOptions::new(&precious), || 0);
    assert!(matches!(refused, Err(twin_drives::EmulatorError::LinkTaken { .. })));
    assert_eq!(std::fs::read_to_string(&precious).unwrap(), "precious");
    assert!(MemoryFile::open(&precious).is_err(), "too short");
}

/// A drive in virtual time, which only passes while it sleeps; its module; and a plan that has not begun.
pub(super) struct Virtual<C> {
    pub(super) drive: Bim2AxDrive,
    pub(super) module: SharedModule,
    pub(super) plan: Plan<C>,
}

pub(super) fn virtual_drive(
    (eeprom, surroundings): (&Eeprom, &Surroundings),
    module: &ModuleOptions,
    options: &Bim2AxDriveOptions,
) -> Virtual<impl Fn() -> i64 + Send + Sync + Clone + use<>> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_time()
        .start_paused(true)
        .build()
        .unwrap();
    let handle = runtime.handle().clone();
    let zero = runtime.block_on(async { Instant::now() });
    let clock = move || {
        let _inside = handle.enter();
        i64::try_from(zero.elapsed().as_nanos()).unwrap()
    };
    let module = SharedModule::new(Module::new(module, eeprom, surroundings), clock.clone());
    let drive = Bim2AxDrive::on(runtime, "module", module.clone(), options).unwrap();
    Virtual { drive, module, plan: Plan { clock, start_ns: i64::MAX / 2 } }
}

impl<C: Fn() -> i64 + Sync> Virtual<C> {
    /// Probed and enabled.
    pub(super) fn ready(mut self) -> Self {
        self.drive.probe(&self.plan).unwrap();
        self.drive.enable().unwrap();
        self
    }

    pub(super) fn now_ns(&self) -> i64 {
        (self.plan.clock)()
    }

    /// Follows the plan until `to_ns` of it.
    pub(super) fn follow(&mut self, to_ns: i64) {
        while self.plan.now_ns() < to_ns {
            self.drive.follow(&self.plan).unwrap();
        }
    }

    /// Looks until the axes rest.
    pub(super) fn rests(&mut self) -> Result<[i64; 2], DriveError> {
        let end_ns = self.now_ns() + 60_000_000_000;
        loop {
            let sample = self.drive.sample(&self.plan)?;
            if !sample.moving {
                return Ok([sample.position[0], sample.position[1]]);
            }
            assert!(self.now_ns() < end_ns, "it does not end");
        }
    }

    /// Begins a move of both axes at full speed.
    pub(super) fn begin(&mut self, [one, two]: [i64; 2]) -> Result<(), DriveError> {
        self.drive.move_to(&[one, two, 0, 0, 0], &[10_000.0; 5])
    }

    /// Moves both axes at full speed, until they rest.
    pub(super) fn goes(&mut self, to: [i64; 2]) -> Result<[i64; 2], DriveError> {
        self.begin(to)?;
        self.rests()
    }

    /// Homes both axes.
    pub(super) fn homes(&mut self) -> Result<[i64; 2], DriveError> {
        self.drive.begin_homing(&[Some(1), Some(1), None, None, None]).unwrap();
        self.rests()
    }

    pub(super) fn homed(&mut self) -> [Option<bool>; 2] {
        let homed = self.drive.homed().unwrap();
        [homed[0], homed[1]]
    }
}

pub(super) fn quick() -> ModuleOptions {
    ModuleOptions { boot_ns: 0, ..ModuleOptions::default() }
}

/// §4 of the digest leaves open what a module counts at home. The cam of both ends at −400: axes that count 700 and −900 where
/// they start from 0 have 300 and −1300 there if they count on, else 0.
#[test]
fn a_count_at_home_that_contradicts_what_is_assumed_is_told() {
    for (device, driver) in [(false, false), (true, true), (true, false), (false, true)] {
        let mut module = quick();
        module.assumptions.homing_keeps_position = device;
        let mut options = Bim2AxDriveOptions::new();
        options.driver.assumptions.homing_keeps_position = driver;
        let mut rig = virtual_drive((&eeprom(), &surroundings()), &module, &options).ready();
        rig.drive.set_position(&[700, -900, 0, 0, 0]).unwrap();
        let home = if device { [300, -1300] } else { [0, 0] };
        assert_eq!(rig.homes().unwrap(), home, "{device} {driver}");
        if device == driver {
            assert_eq!(rig.homed(), [Some(true); 2], "{device} {driver}");
            continue;
        }
        let error = rig.drive.homed().unwrap_err();
        let said = error.to_string();
        assert!(said.contains("`homing_keeps_position`"), "{said}");
        match error.fault() {
            Some(&Fault::HomeCount { axis: Axes::Numbers(0b01), counted_on, before, found }) => {
                assert_eq!((counted_on, found), (driver, home[0]));
                // It was last seen within a look of 300: 20 ms at 1000 µsteps/s are 20.
                assert!((300..=320).contains(&before), "{said}");
            }
            _ => panic!("{error}"),
        }
        // It is reported once; that the axes are homed the module says.
        assert_eq!(rig.homed(), [Some(true); 2]);
    }
}

#[test]
fn in_virtual_time_it_follows_as_well_as_its_wire_allows() {
    let mut eeprom = eeprom();
    for axis in BOTH {
        // Nothing in its way.
        let bits = coefficient::PRESENT | coefficient::IGNORE_SWITCHES;
        set(&mut eeprom, axis, AxisParameter::Coefficient, bits.into());
    }
    let free = (&eeprom, &Surroundings::default());
    let mut rig = virtual_drive(free, &quick(), &Bim2AxDriveOptions::new()).ready();
    rig.plan.start_ns = rig.now_ns() + 100_000_000;
    let Virtual { mut drive, module, plan } = rig;
    let mut worst = 0.0_f64;
    let mut orders = 0;
    let mut moved = false;
    while plan.now_ns() < 1_700_000_000 {
        let sample = drive.follow(&plan).unwrap();
        let planned = plan.at(sample.time_ns).position;
        orders += i32::from(sample.moving && !moved);
        moved = sample.moving;
        for (found, planned) in sample.position.iter().zip(planned).take(2) {
            #[expect(clippy::cast_precision_loss, reason = "small")]
            let found = *found as f64;
            // While the plan turns at once the axis rests between two legs, and begins the next late.
            worst = worst.max((found - planned).abs());
        }
    }
    // 800 µsteps/s, below the start-stop speed: no ramps. A look takes 1 ms and begins when the leg has ended, an
    // order counts 300 µs to 1 ms after it was given, and the first leg is planned with the 10 ms of the manual
    // until it is known better: 12 ms at worst, of which a leg may be ahead or behind for the whole at the plan's
    // begin and turn. A µstep for rounding, and one for the time stamp.
    assert!(worst <= 800.0 * 0.012 + 2.0, "{worst} with {orders} orders");
    assert!(orders >= 6, "{orders}");
    for axis in BOTH {
        assert!(module.module().position(axis).abs() < 0.5);
    }
}

/// A drive of axes with nothing in their way, 100 ms before its plan.
fn free() -> Virtual<impl Fn() -> i64 + Sync + use<>> {
    let mut eeprom = eeprom();
    for axis in BOTH {
        let bits = coefficient::PRESENT | coefficient::IGNORE_SWITCHES;
        set(&mut eeprom, axis, AxisParameter::Coefficient, bits.into());
    }
    let surroundings = Surroundings::default();
    let options = Bim2AxDriveOptions::new();
    let mut rig = virtual_drive((&eeprom, &surroundings), &quick(), &options).ready();
    rig.plan.start_ns = rig.now_ns() + 100_000_000;
    rig
}

/// Every tenth answer is lost, to a look or to an order.
#[test]
fn a_lost_answer_costs_an_exchange() {
    let Virtual { mut drive, module, plan } = free();
    let (direction, when) = (Direction::Answer, When::Every(10));
    let rule = FaultRule { direction, when, fault: WireFault::Drop };
    module.module().control(Control::Fault(rule));
    let mut worst = 0.0_f64;
    while plan.now_ns() < 1_700_000_000 {
        let sample = drive.follow(&plan).unwrap();
        let planned = plan.at(sample.time_ns).position;
        #[expect(clippy::cast_precision_loss, reason = "small")]
        let found = sample.position.map(|found| found as f64);
        for (found, planned) in found.iter().zip(planned).take(2) {
            worst = worst.max((found - planned).abs());
        }
    }
    let losses = drive.losses();
    assert!(losses.total > 10 && losses.in_row == 0, "{losses:?}");
    // 10 ms until the answer counts as lost, 20 ms until nothing late can come, a look and the order: less than 50 ms, twice
    // where a second loss follows, of 800 µsteps/s.
    assert!(worst > 800.0 * 0.02 && worst < 800.0 * 0.1, "{worst}");
    for axis in BOTH {
        assert!(module.module().position(axis).abs() < 0.5);
    }
}

#[test]
fn an_order_without_effect_is_repeated_once() {
    for (ignored, goes_on) in [(1, true), (u32::MAX, false)] {
        let Virtual { mut drive, module, plan } = free();
        module.module().happen(Event::IgnoreMoves(ignored));
        let mut outcome = Ok(());
        while plan.now_ns() < 1_700_000_000 && outcome.is_ok() {
            outcome = drive.follow(&plan).map(|_| ());
        }
        match outcome {
            Ok(()) => assert!(goes_on),
            Err(DriveError::NoEffect { axis: Axes::Numbers(_), found: 0, .. }) => {
                // Within a few looks of 5 ms after two legs have begun.
                assert!(!goes_on && plan.now_ns() < 200_000_000, "{}", plan.now_ns());
            }
            Err(error) => panic!("{error}"),
        }
    }
}

#[test]
fn an_axis_alone_is_followed_too() {
    let mut options = Bim2AxDriveOptions::new();
    options.axes = vec![ModuleAxis::Two];
    let mut rig = virtual_drive((&eeprom(), &surroundings()), &quick(), &options).ready();
    rig.plan.start_ns = rig.now_ns();
    rig.follow(700_000_000);
    // The first axis of the plan is the second of the module; 560 of 600 µsteps are due.
    let (one, two) = (ModuleAxis::One, ModuleAxis::Two);
    let module = rig.module.module();
    let (rests, moves) = (module.position(one), module.position(two));
    assert!(rests == 0.0 && (540.0..580.0).contains(&moves), "{rests} {moves}");
}

#[test]
fn modules_without_the_order_for_phases_are_enabled_by_a_motor_test() {
    for phases_on_order in [true, false] {
        let options = ModuleOptions { phases_on_order, ..quick() };
        let usual = (&eeprom(), &surroundings());
        let Virtual { mut drive, module, plan } =
            virtual_drive(usual, &options, &Bim2AxDriveOptions::new());
        drive.probe(&plan).unwrap();
        assert_eq!(module.module().current_ma(ModuleAxis::One), 0);
        drive.enable().unwrap();
        assert_eq!(module.module().current_ma(ModuleAxis::One), 500);
        let mut broken = surroundings();
        broken.benches[0].power = false;
        module.module().set_surroundings(&broken);
        let error = drive.enable().unwrap_err();
        assert!(matches!(error.fault(), Some(Fault::AxisMessages { axis: 1, .. })), "{error}");
    }
}

#[test]
fn axes_must_be_named_once() {
    for axes in [vec![], vec![ModuleAxis::One; 2], vec![ModuleAxis::One; 3]] {
        let mut options = Bim2AxDriveOptions::new();
        options.axes = axes;
        let module = Module::new(&ModuleOptions::default(), &eeprom(), &surroundings());
        let refused = Bim2AxDrive::new("module", SharedModule::new(module, || 0), &options);
        assert!(matches!(refused, Err(DriveError::Setting { setting: "number of axes", .. })));
    }
}
