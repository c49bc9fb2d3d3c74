//! Kill test: the program dies in the middle of a move, and each device must stop within the plan's horizon.
//!
//! The driver runs in a process of its own (this binary again) and is killed. Its last command is within the plan's
//! horizon: the axis ends no farther than the plan's position `horizon` after the last instant at which the process
//! lived, so it goes on for at most look-ahead × speed. A move to a target (the approach to the start of a program) and
//! homing are one order: they go on to their end, which is the target, or the home switch or the longest way that the
//! board was given.

use std::{
    process::{Child, Command},
    thread,
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use twin_bim2ax::{Bim2Ax, Bim2AxDrive, Bim2AxDriveOptions, Bim2AxOptions, MemoryFile, ModuleAxis};
use twin_drives::{Drive, IncrementMotion, MAX_DRIVE_AXES, SetpointStream};
use twin_interpcnc as interpcnc;
use twin_interpcnc::{BoardAxis, Following, InterpCncDrive, InterpCncOptions};
use twin_smartdrive as smartdrive;
use twin_smartdrive::{SmartDriveBus, SmartDriveOptions, StepsPerTurn};

use crate::{
    faults::Family,
    rig::{HOMING_WAY, Rig, RigClock},
};

/// Speed of the plan, increments/s, and how far ahead of now it is known, ns.
const SPEED: f64 = 2000.0;
const HORIZON_NS: i64 = 300_000_000;
/// Target of an approach, increments.
const TARGET: i64 = 4000;
/// The longest way that homing may go where it is not to find its switch, increments.
const NEARBY: u32 = 1000;
/// Looks at the device at most, and the pause between them.
const MOST_LOOKS: u32 = 3000;
const PAUSE: Duration = Duration::from_millis(10);
/// Environment variable with the child's task.
const WHAT: &str = "FAULT_MATRIX_CHILD";
const PORT: &str = "FAULT_MATRIX_PORT";
const START: &str = "FAULT_MATRIX_START";

/// Activity of the process that is killed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Doing {
    /// InterpCNC, command 80.
    Retargeted,
    /// InterpCNC, command 6.
    Buffered,
    /// SmartDRIVE, GOTO.
    GoTo,
    /// BIM2AX, legs.
    Legs,
    /// A move to a target.
    Approach(Family),
    /// The device's own homing.
    Homing(Family),
    /// InterpCNC, homing that is not allowed to go as far as its switch.
    HomingNearby,
}

impl Doing {
    const ALL: [Self; 11] = [
        Self::Retargeted,
        Self::Buffered,
        Self::GoTo,
        Self::Legs,
        Self::Approach(Family::InterpCnc),
        Self::Approach(Family::SmartDrive),
        Self::Approach(Family::Bim2Ax),
        Self::Homing(Family::InterpCnc),
        Self::Homing(Family::SmartDrive),
        Self::Homing(Family::Bim2Ax),
        Self::HomingNearby,
    ];

    fn family(self) -> Family {
        match self {
            Self::Retargeted | Self::Buffered | Self::HomingNearby => Family::InterpCnc,
            Self::Approach(family) | Self::Homing(family) => family,
            Self::GoTo => Family::SmartDrive,
            Self::Legs => Family::Bim2Ax,
        }
    }
}

/// Time that two processes share, ns.
#[expect(clippy::disallowed_methods, reason = "two processes have no other clock in common")]
fn now_ns() -> i64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).expect("after 1970");
    i64::try_from(now.as_nanos()).expect("before 2262")
}

/// A straight line that does not end.
struct Line {
    start_ns: i64,
}

impl SetpointStream for Line {
    fn now_ns(&self) -> i64 {
        now_ns() - self.start_ns
    }

    #[expect(clippy::cast_precision_loss, reason = "seconds")]
    fn at(&self, time_ns: i64) -> IncrementMotion {
        let mut motion = IncrementMotion::default();
        motion.position[0] = SPEED * (time_ns as f64 * 1e-9).max(0.0);
        motion.velocity[0] = if time_ns < 0 { 0.0 } else { SPEED };
        motion
    }

    fn horizon_ns(&self) -> i64 {
        HORIZON_NS
    }
}

/// The process that is killed; nothing where nobody asks for it.
#[test]
fn child() {
    let Ok(what) = std::env::var(WHAT) else { return };
    let port = std::env::var(PORT).expect("where");
    let start_ns = std::env::var(START).expect("when").parse().expect("ns");
    let doing = Doing::ALL.into_iter().find(|doing| format!("{doing:?}") == what).expect("what");
    let mut drive = open(doing, &port);
    let line = Line { start_ns };
    drive.probe(&line).expect("it answers");
    drive.enable().expect("it obeys");
    match doing {
        Doing::Approach(_) => {
            drive.move_to(&[TARGET; MAX_DRIVE_AXES], &[SPEED; MAX_DRIVE_AXES]).expect("it moves");
        }
        Doing::Homing(_) => home(&mut *drive, HOMING_WAY),
        Doing::HomingNearby => home(&mut *drive, NEARBY),
        _ => loop {
            drive.follow(&line).expect("it follows");
        },
    }
    loop {
        thread::sleep(PAUSE);
    }
}

fn home(drive: &mut dyn Drive, way: u32) {
    if drive.describe().starts_with("InterpCNC") {
        crate::rig::prepare_homing(drive).expect("it takes parameters");
    }
    let mut ways = [None; MAX_DRIVE_AXES];
    ways[0] = Some(way);
    drive.begin_homing(&ways).expect("it homes");
}

fn open(doing: Doing, port: &str) -> Box<dyn Drive> {
    let deadline = Duration::from_secs(5);
    match doing.family() {
        Family::InterpCnc | Family::Segments => {
            let mut options =
                InterpCncOptions::new(vec![interpcnc::AxisOptions::new(BoardAxis::X)]);
            options.deadline = deadline;
            if doing == Doing::Buffered {
                options.following =
                    Following::Buffered { start_stop_hz: 200, acceleration_khz_per_s: 50 };
            }
            Box::new(InterpCncDrive::open(port, &options).expect("it opens"))
        }
        Family::SmartDrive | Family::Pair => {
            let axis = smartdrive::AxisOptions {
                address: 2,
                turn: StepsPerTurn::new(200, 16).expect("a turn"),
                velocity_rpm: 500,
                acceleration_rpm_per_s: 2000,
                deceleration_rpm_per_s: 2000,
            };
            let mut options = SmartDriveOptions::new(vec![axis]);
            (options.deadline, options.mode_change) = (deadline, deadline);
            Box::new(SmartDriveBus::open(port, &options).expect("it opens"))
        }
        Family::Bim2Ax => {
            let mut options = Bim2AxDriveOptions::new();
            options.axes = vec![ModuleAxis::One];
            options.driver.deadline = deadline;
            let memory = MemoryFile::open(port.as_ref()).expect("it is there");
            Box::new(Bim2AxDrive::new(port, memory, &options).expect("it opens"))
        }
    }
}

fn spawn(doing: Doing, port: &str, start_ns: i64) -> Child {
    Command::new(std::env::current_exe().expect("this"))
        .args(["--exact", "kill::child", "--nocapture"])
        .env(WHAT, format!("{doing:?}"))
        .env(PORT, port)
        .env(START, start_ns.to_string())
        .spawn()
        .expect("it starts")
}

/// Looks again and again whether something holds.
fn comes(holds: impl Fn() -> bool) -> bool {
    (0..MOST_LOOKS).any(|_| {
        thread::sleep(PAUSE);
        holds()
    })
}

/// Lets a process move an axis and kills it. Where the axis was when it was dead, and where its plan reached then.
fn killed(doing: Doing, rig: &Rig) -> (i64, f64) {
    // It has until then to begin.
    let start_ns = now_ns() + 1_000_000_000;
    let mut process = spawn(doing, rig.port(), start_ns);
    let begun = comes(|| rig.truth().mechanical.abs() > 500.0);
    process.kill().expect("it lives");
    process.wait().expect("it is dead");
    let line = Line { start_ns };
    let reached = line.at(line.now_ns() + HORIZON_NS).position[0];
    assert!(begun, "{doing:?} does not move");
    (rig.truth().counter, reached)
}

#[test]
fn a_move_whose_program_dies_ends_within_its_look_ahead() {
    for doing in [Doing::Retargeted, Doing::Buffered, Doing::GoTo, Doing::Legs] {
        let (_, (left, reached), end) = ends(doing);
        let end = end.counter;
        println!("{doing:?}: planned up to {reached:.0}");
        #[expect(clippy::cast_precision_loss, reason = "a counter")]
        let beyond = end as f64 - reached;
        assert!(end >= left && beyond <= 1.0, "{doing:?} ends at {end} instead of {reached}");
    }
}

/// Kills the process that has begun something with a device of its own; the numbers of [`killed`], and the axis at rest.
fn ends(doing: Doing) -> (Rig, (i64, f64), crate::rig::Truth) {
    let mut rig = Rig::new(doing.family(), 0, RigClock::new(1));
    rig.leave();
    let (left, reached) = killed(doing, &rig);
    let rests = comes(|| !rig.truth().moving);
    let end = rig.truth();
    println!("{doing:?}: dead at {left}, ends at {:.0}", end.mechanical);
    assert!(rests, "{doing:?} goes on");
    (rig, (left, reached), end)
}

#[test]
fn an_approach_whose_program_dies_goes_the_whole_way_and_no_farther() {
    for family in [Family::InterpCnc, Family::SmartDrive, Family::Bim2Ax] {
        let (.., end) = ends(Doing::Approach(family));
        assert_eq!(end.counter, TARGET, "{family:?}");
    }
}

#[test]
fn homing_whose_program_dies_goes_on_to_its_switch_or_as_far_as_it_was_allowed() {
    for family in [Family::InterpCnc, Family::SmartDrive, Family::Bim2Ax] {
        let (rig, _, end) = ends(Doing::Homing(family));
        assert!((end.mechanical - rig.switch()).abs() < 300.0, "{family:?}: {end:?}");
    }
    let (.., end) = ends(Doing::HomingNearby);
    // The way, and the ramp from 2000 steps/s at 50000 steps/s².
    let most = -(f64::from(NEARBY) + 40.0 + 1.0);
    assert!((most..-500.0).contains(&end.mechanical), "{end:?}");
}

/// The masters of serial ports and of devices that are mapped are kept apart by the system; those of a memory file by a lock
/// that dies with its program.
#[test]
fn a_memory_file_has_one_master_until_that_is_killed_and_a_stop_gets_through() {
    let mut rig = Rig::new(Family::Bim2Ax, 0, RigClock::new(1));
    rig.leave();
    let port = rig.port().to_owned();
    let mut process = spawn(Doing::Approach(Family::Bim2Ax), &port, now_ns());
    // For so long that its order has been acknowledged: what comes between is garbled for both.
    let begun = comes(|| rig.truth().mechanical.abs() > 500.0);
    let refused = MemoryFile::open(port.as_ref()).map(|_| ());
    let beside = MemoryFile::shared(port.as_ref()).expect("it is there");
    let options = Bim2AxOptions { deadline: Duration::from_secs(5), ..Bim2AxOptions::default() };
    let mut module = Bim2Ax::new(&port, beside, &options);
    let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build();
    let stopped = runtime.expect("a runtime").block_on(module.abandon(&|| 0));
    let rests = comes(|| !rig.truth().moving);
    let lives = process.try_wait().expect("it is ours").is_none();
    process.kill().expect("it lives");
    process.wait().expect("it is dead");
    assert!(begun && lives);
    let refused = refused.expect_err("it has a master");
    assert_eq!(refused.kind(), std::io::ErrorKind::ResourceBusy);
    let said = refused.to_string();
    assert!(said.contains(&port) && said.contains("another program"), "{said}");
    stopped.expect("the module obeys whoever is its master");
    assert!(rests && rig.truth().counter < TARGET, "it goes on");
    MemoryFile::open(port.as_ref()).expect("its master is dead");
}
