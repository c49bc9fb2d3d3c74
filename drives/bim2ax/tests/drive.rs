//! The module as a drive, in real time, on a memory file served by another thread.

use std::time::Instant as WallClock;

use super::*;
use crate::{
    Drive, DriveError, IncrementMotion, SetpointStream,
    bim2ax::{
        Bim2AxDrive, Bim2AxDriveOptions, MemoryFile,
        bits::message,
        emulator::{EmulatedModule, EmulatorOptions},
    },
};

/// The clock of these tests.
#[expect(
    clippy::disallowed_methods,
    reason = "these tests run in real time and are their own session"
)]
fn wall_clock() -> impl Fn() -> i64 + Send + Sync + Copy {
    let zero = WallClock::now();
    move || i64::try_from(zero.elapsed().as_nanos()).unwrap()
}

/// A plan of two axes: a line to and fro, at rest before and after.
struct Plan<C> {
    clock: C,
    start_ns: i64,
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
        let time = (time_ns as f64 * 1e-9).clamp(0.0, 2.0 * HALF_S);
        let mut motion = IncrementMotion::default();
        for (axis, stroke) in [STROKE, -0.5 * STROKE].into_iter().enumerate() {
            motion.position[axis] = stroke * (1.0 - (time / HALF_S - 1.0).abs());
            let sense = if time <= 0.0 || time >= 2.0 * HALF_S {
                0.0
            } else if time < HALF_S {
                1.0
            } else {
                -1.0
            };
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
    let mut memory = MemoryFile::open(module.path()).unwrap();
    let mut identifier = [0];
    while identifier != [0x4E] {
        crate::bim2ax::Memory::read(&mut memory, 0xFF, &mut identifier).unwrap();
        std::thread::yield_now();
    }
    (folder, module)
}

/// A drive whose deadlines are for a machine that does other things, too.
fn drive(module: &EmulatedModule) -> Bim2AxDrive {
    let mut options = Bim2AxDriveOptions::new();
    options.driver.deadline = Duration::from_millis(500);
    let path = module.path();
    let memory = MemoryFile::open(path).unwrap();
    Bim2AxDrive::new(path.to_str().unwrap(), memory, &options).unwrap()
}

#[test]
fn it_follows_a_plan_and_ends_on_it() {
    let (_folder, module) = emulated();
    let mut drive = drive(&module);
    let clock = wall_clock();
    let plan = Plan { clock, start_ns: clock() + 300_000_000 };
    let first = drive.probe(&plan).unwrap();
    assert_eq!((first.position, first.moving), ([0; 5], false));
    drive.enable().unwrap();
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
    // It has been sent to the turning points, which no leg passes: there to the whole µstep, unless this machine was
    // too busy to let it get there before the plan had turned. Half the way it must have gone.
    assert!((300..=600).contains(&farthest[0]), "{farthest:?} in {samples} samples");
    assert!((-300..=-150).contains(&farthest[1]), "{farthest:?} in {samples} samples");
}

#[test]
fn positions_moves_homing_and_stops() {
    let (_folder, module) = emulated();
    let mut drive = drive(&module);
    let clock = wall_clock();
    let plan = Plan { clock, start_ns: i64::MAX / 2 };
    drive.probe(&plan).unwrap();
    drive.enable().unwrap();

    let mut position = [0; 5];
    position[..2].copy_from_slice(&[700, -900]);
    drive.set_position(&position).unwrap();
    assert_eq!(drive.sample(&plan).unwrap().position, position);

    position[..2].copy_from_slice(&[800, -950]);
    drive.move_to(&position, &[4000.0; 5]).unwrap();
    while drive.sample(&plan).unwrap().moving {}
    assert_eq!(drive.sample(&plan).unwrap().position, position);

    drive.home(Duration::from_secs(20)).unwrap();
    assert_eq!(drive.sample(&plan).unwrap().position, [0; 5]);
    assert_eq!(module.module().shaft(ModuleAxis::One), -400);

    position[..2].copy_from_slice(&[3000, 0]);
    drive.move_to(&position, &[1000.0; 5]).unwrap();
    drive.soft_stop().unwrap();
    let stopped = drive.sample(&plan).unwrap();
    assert!(!stopped.moving && stopped.position[0] < 3000);

    drive.move_to(&position, &[1000.0; 5]).unwrap();
    drive.hard_stop().unwrap();
    let error = drive.sample(&plan).unwrap_err();
    let hard_stopped = |messages| messages & message::HARD_STOPPED != 0;
    assert!(
        matches!(error, DriveError::AxisMessages { axis: 1, messages, .. } if hard_stopped(messages)),
        "{error}"
    );
    let speed = drive.move_to(&position, &[0.2; 5]).unwrap_err();
    assert!(matches!(speed, DriveError::Range { .. }), "{speed}");
    position[0] = 4_194_304;
    let beyond = drive.move_to(&position, &[1000.0; 5]).unwrap_err();
    assert!(matches!(beyond, DriveError::Range { .. }), "{beyond}");
    assert!(matches!(drive.set_output(1, true), Err(DriveError::Range { .. })));
}

#[test]
fn an_eeprom_survives_a_restart_and_the_file_goes_with_the_emulator() {
    let (folder, module) = emulated();
    let mut drive = drive(&module);
    let plan = Plan { clock: wall_clock(), start_ns: i64::MAX / 2 };
    drive.probe(&plan).unwrap();
    drive.enable().unwrap();
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
    assert!(matches!(second, Err(crate::EmulatorError::LinkTaken { .. })));
    assert!(module.path().exists());
    let precious = folder.path().join("precious");
    std::fs::write(&precious, "precious").unwrap();
    let refused = EmulatedModule::start(&EmulatorOptions::new(&precious), || 0);
    assert!(matches!(refused, Err(crate::EmulatorError::LinkTaken { .. })));
    assert_eq!(std::fs::read_to_string(&precious).unwrap(), "precious");
    assert!(MemoryFile::open(&precious).is_err(), "too short");
}
