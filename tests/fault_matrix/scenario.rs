//! What is done with the axis while something goes wrong, and what comes of it.

use std::{f64::consts::PI, thread, time::Duration};

use twin_drives::{
    Action, Axes, Clock, Direction, DriveError, IncrementMotion, MAX_DRIVE_AXES, Sample,
    SetpointStream, WireFault,
};

use crate::{
    faults::{DeviceFault, Doing, Family, Fault},
    rig::{Rest, Rig, Truth},
};

/// Where moves from rest go, and how fast, increments and increments/s.
const TARGET: i64 = 4000;
const SPEED: f64 = 4000.0;
/// Far enough that it is not reached while something is stopped.
const FAR: i64 = 1_000_000;
/// Where the last move of all goes.
const AFTERWARDS: i64 = 321;
/// Plan: half a cosine from 0 to there in so many seconds.
const STROKE: f64 = 6000.0;
const DURATION_S: f64 = 2.0;
/// Looks after which an axis no longer comes to rest.
const MOST_LOOKS: u32 = 20_000;
/// Looks in a row with the same position after which an axis rests, and where its status says that it moves.
const SAME_LOOKS: u32 = 20;
const STUCK_LOOKS: u32 = 300;
/// Cycles of following after the end of the plan.
const CYCLES_AFTERWARDS: u32 = 40;
/// Attempts at getting a device back, or looks whether it stands, and the pause between them.
const MOST_ATTEMPTS: u32 = 100;
const PAUSE: Duration = Duration::from_millis(10);

/// What became of what was being done.
#[derive(Debug)]
pub(crate) enum Outcome {
    /// It was done as if nothing had happened.
    Survived,
    /// The driver said that and why it could not be done.
    Told(DriveError),
    /// The driver said nothing, and it was not done.
    Lost(String),
}

/// A cell of the table.
#[derive(Debug)]
pub(crate) struct Cell {
    pub(crate) outcome: Outcome,
    /// After stopping by all means, with the fault still there.
    pub(crate) stopped: bool,
    pub(crate) truth: Truth,
    /// Getting it going again, and moving it.
    pub(crate) usable: Result<(), String>,
}

/// A plan of one axis: at rest, half a cosine, at rest.
struct Plan<C> {
    clock: C,
    start_ns: i64,
}

#[expect(clippy::cast_precision_loss, reason = "seconds")]
impl<C: Clock> SetpointStream for Plan<C> {
    fn now_ns(&self) -> i64 {
        self.clock.now_ns() - self.start_ns
    }

    fn at(&self, time_ns: i64) -> IncrementMotion {
        let angle = PI * (time_ns as f64 * 1e-9 / DURATION_S).clamp(0.0, 1.0);
        let mut motion = IncrementMotion::default();
        motion.position[0] = 0.5 * STROKE * (1.0 - angle.cos());
        motion.velocity[0] = 0.5 * STROKE * angle.sin() * PI / DURATION_S;
        motion
    }

    fn horizon_ns(&self) -> i64 {
        500_000_000
    }
}

/// Whether a plan has ended for so long that a stuck status shows.
fn is_over(plan: &impl SetpointStream) -> bool {
    plan.now_ns() > 4_000_000_000
}

/// What a cell is made of, beside its family.
#[derive(Clone, Copy)]
pub(crate) struct Trial {
    pub(crate) fault: Fault,
    pub(crate) doing: Doing,
    /// Frames that a fault of the wire befalls; 0: all, until something is said.
    pub(crate) frames: u32,
}

impl<C: Clock + Copy + 'static> Rig<C> {
    fn goes_wrong(&self, trial: &Trial, after: u32) {
        match trial.fault {
            Fault::Wire(direction, fault) => self.spoil(direction, fault, trial.frames, after),
            Fault::Device(fault) => self.upset(fault, true, after),
        }
    }

    fn to(&mut self, target: i64) -> Result<(), DriveError> {
        let (mut targets, speeds) = ([0; MAX_DRIVE_AXES], [SPEED; MAX_DRIVE_AXES]);
        targets[0] = target;
        self.drive().move_to(&targets, &speeds)
    }

    /// Looks until the axis has stood for a while; where.
    fn rests(&mut self) -> Result<i64, DriveError> {
        let rest = Rest(self.clock);
        let (mut last, mut same) = (0, 0);
        for _ in 0..MOST_LOOKS {
            let Sample { position, moving, .. } = self.drive().sample(&rest)?;
            same = if position[0] == last { same + 1 } else { 0 };
            last = position[0];
            if same >= if moving { STUCK_LOOKS } else { SAME_LOOKS } {
                break;
            }
        }
        Ok(last)
    }

    fn moves(&mut self) -> Result<(), DriveError> {
        let rest = Rest(self.clock);
        while !self.drive().sample(&rest)?.moving {}
        Ok(())
    }

    fn idle(&mut self, trial: &Trial) -> Outcome {
        match trial.fault {
            // What says where to go.
            Fault::Wire(..) => self.goes_wrong(trial, self.order()),
            Fault::Device(fault) => {
                self.goes_wrong(trial, 0);
                self.settle(fault);
            }
        }
        match self.to(TARGET).and_then(|()| self.rests()) {
            Ok(TARGET) => Outcome::Survived,
            Ok(found) => Outcome::Lost(format!("{found} instead of {TARGET}")),
            Err(error) => Outcome::Told(error),
        }
    }

    fn homing(&mut self, trial: &Trial) -> Outcome {
        // The first requests begin homing; later ones ask how far it is.
        self.goes_wrong(trial, 8);
        match self.home() {
            Ok(()) if (self.truth().mechanical - self.switch()).abs() < 300.0 => {
                self.rests().map_or_else(Outcome::Told, |_| Outcome::Survived)
            }
            Ok(()) => Outcome::Lost(format!("homed at {:?}", self.truth())),
            Err(error) => Outcome::Told(error),
        }
    }

    fn moving(&mut self, trial: &Trial) -> Outcome {
        let start_ns = self.clock.now_ns() + 100_000_000;
        let plan = Plan { clock: self.clock, start_ns };
        let mut spoilt = false;
        // Long enough after its end that what is left undone is made good, whatever was lost on the way.
        let mut left = CYCLES_AFTERWARDS;
        while left > 0 {
            if is_over(&plan) {
                left -= 1;
            }
            match self.drive().follow(&plan) {
                Err(error) => return Outcome::Told(error),
                Ok(sample) if sample.moving && !spoilt && sample.position[0] > 300 => {
                    spoilt = true;
                    self.goes_wrong(trial, 0);
                }
                Ok(_) => {}
            }
        }
        match self.rests() {
            Ok(found) if found == (STROKE as i64) => Outcome::Survived,
            Ok(found) => Outcome::Lost(format!("{found} instead of {STROKE}")),
            Err(error) => Outcome::Told(error),
        }
    }

    fn stopping(&mut self, trial: &Trial) -> Outcome {
        if let Err(error) = self.to(FAR).and_then(|()| self.moves()) {
            return Outcome::Lost(format!("it does not begin: {error}"));
        }
        self.goes_wrong(trial, u32::from(!matches!(trial.fault, Fault::Wire(..))));
        let stopped = self.drive().soft_stop();
        if let Fault::Device(fault) = trial.fault {
            self.settle(fault);
        }
        match stopped.and_then(|()| self.rests()) {
            Ok(_) => Outcome::Survived,
            Err(error) => Outcome::Told(error),
        }
    }

    /// What sessions do when something is said: they stop, by all means.
    fn stops(&mut self) -> bool {
        let soft = self.drive().soft_stop();
        if soft.is_err() {
            drop(self.drive().hard_stop());
        }
        // On its ramp, where its status does not tell.
        for _ in 0..MOST_ATTEMPTS {
            if !self.truth().moving {
                return true;
            }
            thread::sleep(PAUSE);
        }
        false
    }

    /// Back to work, as the manuals demand: the fault is gone, the device is stopped, enabled, told where it is.
    fn recover(&mut self, trial: &Trial, family: Family) -> Result<(), String> {
        self.mend();
        if let Fault::Device(fault) = trial.fault
            && fault != DeviceFault::BrownOut
            && (family, fault) != (Family::SmartDrive, DeviceFault::Stall)
        {
            self.upset(fault, false, 0);
        }
        let mut last = String::new();
        for attempt in 0..MOST_ATTEMPTS {
            match self.back_to_work() {
                Ok(()) => return Ok(()),
                Err(error) => last = error.to_string(),
            }
            if attempt == 2 {
                self.power_cycle();
            }
            thread::sleep(PAUSE);
        }
        Err(last)
    }

    fn back_to_work(&mut self) -> Result<(), DriveError> {
        let rest = Rest(self.clock);
        self.drive().soft_stop()?;
        self.drive().probe(&rest)?;
        self.drive().enable()?;
        self.drive().set_position(&[0; MAX_DRIVE_AXES])?;
        self.to(AFTERWARDS)?;
        let found = self.rests()?;
        if found == AFTERWARDS {
            return Ok(());
        }
        let at = twin_drives::Exchange { port: "".into(), station: 0, action: Action::ReadState };
        Err(DriveError::NotArrived { at, axis: Axes::Only, target: AFTERWARDS, found })
    }
}

/// Makes a cell of the table.
pub(crate) fn cell<C: Clock + Copy + 'static>(family: Family, trial: &Trial, clock: C) -> Cell {
    let mut rig = Rig::new(family, clock);
    let rest = Rest(clock);
    // A machine that is busy may keep even a sound device waiting for too long.
    let mut begin = || rig.drive().probe(&rest).and_then(|_| rig.drive().enable());
    (0..MOST_ATTEMPTS).find(|_| begin().is_ok()).expect("it is sound");
    let outcome = match trial.doing {
        Doing::Idle => rig.idle(trial),
        Doing::Homing => rig.homing(trial),
        Doing::Moving => rig.moving(trial),
        Doing::Stopping => rig.stopping(trial),
    };
    if trial.frames == 0 && matches!(trial.fault, Fault::Wire(Direction::Request, _)) {
        // It was to last until it was told.
        rig.mend();
    }
    let truth = rig.truth();
    let stopped = rig.stops();
    let usable = rig.recover(trial, family);
    let usable = usable.and_then(|()| {
        let truth = rig.truth();
        // The driver's last word on where it is, and the device's.
        let told = rig.drive().sample(&rest).map_err(|error| error.to_string())?;
        let agree = !truth.moving && told.position[0] == AFTERWARDS;
        if agree { Ok(()) } else { Err(format!("{told:?}, and in truth {truth:?}")) }
    });
    Cell { outcome, stopped, truth, usable }
}

/// Whether a fault means nothing to a family.
pub(crate) fn is_meaningless(family: Family, fault: Fault) -> Option<&'static str> {
    match (family, fault) {
        (Family::Bim2Ax, Fault::Wire(_, WireFault::WrongCheck)) => Some("no check sums on a bus"),
        (Family::Bim2Ax, Fault::Wire(_, WireFault::Echo)) => Some("no echo on a bus"),
        _ => None,
    }
}
