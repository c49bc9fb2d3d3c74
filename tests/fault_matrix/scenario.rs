//! Scenarios: the activity of the axis during a fault, and its outcome.

use std::{f64::consts::PI, sync::OnceLock, thread, time::Duration};

use twin_drives::{
    Action, Axes, Clock, DecimalRatio, Direction, DriveError, IncrementMotion, MAX_DRIVE_AXES,
    Sample, SetpointStream, WireFault,
};

use crate::{
    assumed::Otherwise,
    faults::{DeviceFault, Doing, Family, Fault},
    rig::{AxisTruth, OUTAGE, Rest, Rig, RigClock, Truth},
    track::Track,
};

/// Target and speed of moves from rest, increments and increments/s.
pub(crate) const TARGET: i64 = 4000;
const SPEED: f64 = 4000.0;
/// Target of the last move.
const AFTERWARDS: i64 = 321;
/// Speed of the way back to the begin, increments/s.
const RETURN_SPEED: f64 = 10_000.0;
/// Plan: half a cosine from 0 to there in so many seconds, units of the axis, and in increments by [`ratio`].
const STROKE_U: f64 = 192.0;
const STROKE: f64 = 16_000.0;
const DURATION_S: f64 = 16.0;
/// Its highest speed, increments/s.
const PEAK: f64 = 0.5 * STROKE * PI / DURATION_S;
/// Looks after which an axis no longer comes to rest.
pub(crate) const MOST_LOOKS: u32 = 20_000;
/// Looks in a row with the same position after which an axis rests, and where its status says that it moves.
const SAME_LOOKS: u32 = 20;
const STUCK_LOOKS: u32 = 300;
/// Time after which an axis that still moves is not followed any longer, ns of the plan.
const MOST_FOLLOWED_NS: i64 = 60_000_000_000;
/// Cycles of following after the end of the plan and of the motion.
const CYCLES_AFTERWARDS: u32 = 40;
/// Attempts at getting a device back, or looks whether it rests, and the pause between them.
pub(crate) const MOST_ATTEMPTS: u32 = 100;
pub(crate) const PAUSE: Duration = Duration::from_millis(10);

/// The sense in which the axes of a rig go: what is meant for one and done by the other brings that to the wrong side.
pub(crate) const SENSES: [i64; 2] = [1, -1];

/// Units of an axis to increments: no binary fraction.
fn ratio() -> DecimalRatio {
    DecimalRatio::new(250, 3.0, 0).expect("neither is 0")
}

/// Outcome of the activity.
#[derive(Debug)]
pub(crate) enum Outcome {
    /// It was done as if nothing had happened.
    Survived,
    /// The driver said that and why it could not be done.
    Told(DriveError),
    /// The driver said nothing, and it was not done.
    Lost(String),
    /// The driver said nothing and it was done, but on the way the axis was farther from the plan than outages explain.
    Astray(String),
    /// What was to go wrong had not begun: a sound device could not be brought to what it was to be doing.
    NotBegun(DriveError),
}

/// A cell of the table.
#[derive(Debug)]
pub(crate) struct Cell {
    pub(crate) outcome: Outcome,
    /// False if the activity ended before its fault.
    pub(crate) struck: bool,
    /// After stopping by all means, with the fault still there.
    pub(crate) stopped: bool,
    pub(crate) truth: Truth,
    /// End positions of axes that went on: the driver's last command, the devices' targets and the last set-point
    /// agree. None if nothing was followed or reached.
    pub(crate) ends: Option<Vec<i64>>,
    /// Getting it going again, and moving it.
    pub(crate) usable: Result<(), String>,
    /// Result for an unplugged axis that went on; none for other faults.
    pub(crate) goes_on: Option<Result<(), String>>,
}

/// A plan of one axis: at rest, half a cosine, at rest.
pub(crate) struct Plan {
    pub(crate) clock: RigClock,
    pub(crate) start_ns: i64,
}

#[expect(clippy::cast_precision_loss, reason = "seconds")]
impl SetpointStream for Plan {
    fn now_ns(&self) -> i64 {
        self.clock.now_ns() - self.start_ns
    }

    fn at(&self, time_ns: i64) -> IncrementMotion {
        let angle = PI * (time_ns as f64 * 1e-9 / DURATION_S).clamp(0.0, 1.0);
        let mut motion = IncrementMotion::default();
        // The second axis, where there is one, goes the other way.
        for (axis, sense) in SENSES.into_iter().enumerate() {
            let units = sense as f64 * 0.5 * STROKE_U * (1.0 - angle.cos());
            motion.position[axis] = ratio().increments_of(units);
            motion.velocity[axis] = sense as f64 * PEAK * angle.sin();
        }
        motion
    }

    fn horizon_ns(&self) -> i64 {
        self.clock.horizon_ns()
    }
}

/// True if a plan has ended long enough ago for a stuck status to show.
pub(crate) fn is_over(plan: &impl SetpointStream) -> bool {
    plan.now_ns() > 18_000_000_000
}

/// Instant of an activity at which its fault occurs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strike {
    /// Requests until then; none: as many as the activity itself says.
    pub(crate) after: Option<u32>,
    /// Position on a followed plan beyond which it occurs, increments.
    pub(crate) position: i64,
    /// Time for which a plan is followed before the stop, ns of the device.
    pub(crate) followed_ns: i64,
}

impl Default for Strike {
    /// Follows for 1 s of wall time.
    fn default() -> Self {
        Self { after: None, position: 300, followed_ns: 5_000_000_000 }
    }
}

/// Parameters of a cell other than its family.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trial {
    pub(crate) fault: Fault,
    pub(crate) doing: Doing,
    /// Seed of the random choices.
    pub(crate) seed: u64,
    /// Frames that a fault of the wire befalls; 0: all, until something is said.
    pub(crate) frames: u32,
    /// True if segments wait in the device's buffer when it is stopped.
    pub(crate) buffered: bool,
    /// Assumption that differs from the usual one.
    pub(crate) otherwise: Option<Otherwise>,
    pub(crate) strike: Strike,
    /// True if the device has had other faults before, and lives on. Its driver may then have forgotten where it has sent an
    /// axis that arrived, and a fault may have been shown before.
    pub(crate) lives_on: bool,
}

impl Rig {
    /// Makes the fault occur after a number of requests, unless the trial has its own.
    pub(crate) fn goes_wrong(&self, trial: &Trial, after: u32) {
        let after = trial.strike.after.unwrap_or(after);
        match trial.fault {
            Fault::Wire(direction, fault) => self.spoil(direction, fault, trial.frames, after),
            Fault::Device(fault) => self.upset(fault, true, after),
        }
    }

    pub(crate) fn to(&mut self, target: i64) -> Result<(), DriveError> {
        // The second axis, where there is one, goes the other way.
        let mut targets = [target; MAX_DRIVE_AXES];
        targets[1] = SENSES[1] * target;
        self.drive().move_to(&targets, &[SPEED; MAX_DRIVE_AXES])
    }

    /// What the driver remembers to have sent the axes to is what the devices are going to: of every axis of which the
    /// driver says that it knows.
    fn agrees(&mut self) -> Result<(), String> {
        let commanded = self.drive().commanded();
        let count = self.drive().axis_count();
        let truth = self.truth();
        for (axis, (commanded, truth)) in commanded.iter().zip(truth.axes).take(count).enumerate() {
            if commanded.is_some() && *commanded != truth.target {
                return Err(format!(
                    "axis {axis}: sent to {commanded:?} as the driver has it, {truth:?}"
                ));
            }
        }
        Ok(())
    }

    /// Where the axes rest, if that is where the driver has sent them last, where the devices were to go, and `units`,
    /// the last set-point, by the exact ratio.
    fn ends(&mut self, units: f64, lives_on: bool) -> Result<Vec<i64>, String> {
        let last = ratio().increments(units).ok_or_else(|| format!("{units} cannot be counted"))?;
        let commanded = self.drive().commanded();
        let count = self.drive().axis_count();
        let truth = self.truth();
        let axes = SENSES.into_iter().zip(commanded).zip(truth.axes).take(count);
        let ends = axes.enumerate().map(|(axis, ((sense, commanded), truth))| {
            let last = sense * last;
            let right = Some(last);
            let believes = commanded == right || lives_on && commanded.is_none();
            if believes && truth.target == right && truth.counter == last {
                return Ok(last);
            }
            Err(format!(
                "axis {axis}: the last set-point is {last}, the driver has sent {commanded:?}, {truth:?}"
            ))
        });
        ends.collect()
    }

    /// Whether two drives of a line have each kept to the side to which they were sent.
    fn sides(&self, family: Family) -> Result<(), String> {
        let truth = self.truth();
        let wrong = |(sense, axis): (i64, AxisTruth)| {
            #[expect(clippy::cast_precision_loss, reason = "1 or -1")]
            let way = sense as f64 * axis.mechanical;
            way < -1.0
        };
        if family == Family::Pair && SENSES.into_iter().zip(truth.axes).any(wrong) {
            return Err(format!("one has done what was for the other: {truth:?}"));
        }
        Ok(())
    }

    /// Looks until the axis has stood for a while; where.
    pub(crate) fn rests(&mut self) -> Result<i64, DriveError> {
        let rest = Rest(self.clock);
        let (mut last, mut same) = ([0; MAX_DRIVE_AXES], 0);
        for _ in 0..MOST_LOOKS {
            let Sample { position, moving, .. } = self.drive().sample(&rest)?;
            same = if position == last { same + 1 } else { 0 };
            last = position;
            if same >= if moving { STUCK_LOOKS } else { SAME_LOOKS } {
                break;
            }
        }
        Ok(last[0])
    }

    fn says_it_moves(&mut self) -> bool {
        let rest = Rest(self.clock);
        self.drive().sample(&rest).is_ok_and(|sample| sample.moving)
    }

    pub(crate) fn moves(&mut self) -> Result<(), DriveError> {
        let rest = Rest(self.clock);
        while !self.drive().sample(&rest)?.moving {}
        Ok(())
    }

    fn idle(&mut self, trial: &Trial) -> Outcome {
        match trial.fault {
            // What says where to go.
            Fault::Wire(..) => self.goes_wrong(trial, self.order(trial.otherwise)),
            Fault::Device(fault) => {
                self.goes_wrong(trial, 0);
                assert!(self.settle(fault) || trial.lives_on, "{fault:?} does not show");
            }
        }
        match self.to(TARGET).and_then(|()| self.rests()) {
            Ok(TARGET) => Outcome::Survived,
            Ok(found) => Outcome::Lost(format!("{found} instead of {TARGET}")),
            Err(error) => Outcome::Told(error),
        }
    }

    /// On its way to a target; the next request asks where it is.
    fn looking(&mut self, trial: &Trial) -> Outcome {
        if let Err(error) = self.to(TARGET).and_then(|()| self.moves()) {
            return Outcome::NotBegun(error);
        }
        self.goes_wrong(trial, 0);
        match self.rests() {
            Ok(TARGET) => Outcome::Survived,
            // A status that goes on saying that it moves: whoever waits for it gives up.
            Ok(_) if self.says_it_moves() => Outcome::Told(unfinished(STUCK_LOOKS)),
            Ok(found) => Outcome::Lost(format!("{found} instead of {TARGET}")),
            Err(error) => Outcome::Told(error),
        }
    }

    fn homing(&mut self, trial: &Trial) -> Outcome {
        if let Err(error) = self.prepare_homing() {
            return Outcome::NotBegun(error);
        }
        // The first requests begin homing; later ones ask how far it is.
        let after = if trial.doing == Doing::ToHome { self.homing_order() } else { 8 };
        self.goes_wrong(trial, after);
        match self.home() {
            Ok(()) if self.is_on_switches() => {
                self.rests().map_or_else(Outcome::Told, |_| Outcome::Survived)
            }
            Ok(()) => Outcome::Lost(format!("homed at {:?}", self.truth())),
            Err(error) => Outcome::Told(error),
        }
    }

    /// Follows a plan, and something goes wrong on the way if it is to. How far the axis is away from the plan without
    /// that is `usual`; where the plan reached when it went wrong is noted.
    fn moving(&mut self, trial: Option<&Trial>, usual: f64) -> (Outcome, [Track; 2]) {
        let mut tracks = [Track::default(), Track::default()];
        let mut astray = Ok(());
        let outcome = self.follows(trial, &mut tracks, &mut astray);
        // What the driver has told is not lost.
        let near = tracks.iter().try_for_each(|track| track.check(usual, PEAK));
        let outcome = match (outcome, astray, near) {
            (Outcome::Survived, Err(lost), _) if trial.is_some() => Outcome::Lost(lost),
            (Outcome::Survived, _, Err(far)) if trial.is_some() => Outcome::Astray(far),
            (outcome, ..) => outcome,
        };
        (outcome, tracks)
    }

    /// `astray` is called the first time that the devices go elsewhere than the driver believes.
    fn follows(
        &mut self,
        trial: Option<&Trial>,
        tracks: &mut [Track; 2],
        astray: &mut Result<(), String>,
    ) -> Outcome {
        let start_ns = self.clock.now_ns() + 100_000_000;
        let plan = Plan { clock: self.clock, start_ns };
        let position = trial.map_or(0, |trial| trial.strike.position);
        let mut spoilt = trial.is_none();
        // Long enough after its end that what is left undone is made good, whatever was lost on the way.
        let mut left = CYCLES_AFTERWARDS;
        // It rests where the plan begins; from now on it is looked at.
        for track in &mut *tracks {
            track.note((plan.now_ns(), plan.now_ns()), (0.0, 0.0), 0.0);
        }
        let count = self.drive().axis_count();
        let mut moves = true;
        while left > 0 {
            // After a long outage an axis comes back at a limited speed, which may take longer than the plan.
            if is_over(&plan) && !(moves && plan.now_ns() < MOST_FOLLOWED_NS) {
                left -= 1;
            }
            match self.drive().follow(&plan) {
                Err(error) => return Outcome::Told(error),
                Ok(sample) if sample.moving && !spoilt && sample.position[0] > position => {
                    spoilt = true;
                    if let Some(trial) = trial {
                        self.goes_wrong(trial, 0);
                        let known_ns = plan.now_ns() + self.clock.horizon_ns();
                        self.reached = Some(plan.at(known_ns).position[0]);
                    }
                }
                Ok(_) => {}
            }
            let from_ns = plan.now_ns();
            let truth = self.truth();
            moves = truth.moving || truth.other_moves;
            let to_ns = plan.now_ns();
            let (from, to) = (plan.at(from_ns).position, plan.at(to_ns).position);
            for (axis, track) in tracks.iter_mut().enumerate().take(count) {
                #[expect(clippy::cast_precision_loss, reason = "a counter")]
                let counter = truth.axes[axis].counter as f64;
                let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
                track.note((from_ns, to_ns), (low, high), counter);
            }
            if astray.is_ok() {
                *astray = self.agrees();
            }
        }
        match self.rests() {
            Ok(found) if found == (STROKE as i64) => Outcome::Survived,
            Ok(found) => {
                let (commanded, truth) = (self.drive().commanded(), self.truth());
                Outcome::Lost(format!("{found} instead of {STROKE}, {commanded:?}, {truth:?}"))
            }
            Err(error) => Outcome::Told(error),
        }
    }

    /// Back to work, as the manuals demand: the fault is gone, the device is stopped, enabled, told where it is.
    fn recover(&mut self, trial: &Trial, family: Family) -> Result<(), String> {
        self.mend();
        if let Fault::Device(fault) = trial.fault
            && !matches!(fault, DeviceFault::BrownOut | DeviceFault::Outage)
            && !(matches!(family, Family::SmartDrive | Family::Pair) && fault == DeviceFault::Stall)
        {
            self.upset(fault, false, 0);
        }
        if trial.fault == Fault::Device(DeviceFault::Outage) {
            // Whoever wants it back waits for its supply.
            thread::sleep(OUTAGE);
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
        let at = twin_drives::Exchange { port: "".into(), address: 0, action: Action::ReadState };
        Err(DriveError::NotArrived { at, axis: Axes::Only, target: AFTERWARDS, found })
    }

    /// Moves a sound device to the start position of a new one, and makes that its 0.
    pub(crate) fn begin_again(&mut self) -> Result<(), String> {
        let rest = Rest(self.clock);
        let said = |error: DriveError| error.to_string();
        let away = self.truth();
        let mut targets = self.drive().sample(&rest).map_err(said)?.position;
        for (target, axis) in targets.iter_mut().zip(&away.axes) {
            *target -= axis.mechanical.round() as i64;
        }
        self.drive().move_to(&targets, &[RETURN_SPEED; MAX_DRIVE_AXES]).map_err(said)?;
        self.rests().map_err(said)?;
        self.drive().set_position(&[0; MAX_DRIVE_AXES]).map_err(said)?;
        self.note_origin();
        let truth = self.truth();
        let near = |axis: &AxisTruth| axis.counter == 0 && axis.mechanical.abs() <= 0.5;
        if truth.axes.iter().all(near) {
            return Ok(());
        }
        Err(format!("not back where it began: {truth:?}, from {away:?}"))
    }
}

/// What whoever waits for a move makes of it when it has not ended after so many looks.
fn unfinished(looks: u32) -> DriveError {
    let at = twin_drives::Exchange { port: "".into(), address: 0, action: Action::ReadState };
    DriveError::Unfinished { at, patience: looks * PAUSE }
}

/// Makes a cell of the table, with a fresh device.
pub(crate) fn cell(family: Family, trial: &Trial, clock: RigClock) -> Cell {
    trial.made_by(family, &mut sound(family, trial.seed, clock, trial.otherwise))
}

impl Trial {
    /// Makes a cell with a device that is at rest, obeys and is at 0.
    pub(crate) fn made_by(&self, family: Family, rig: &mut Rig) -> Cell {
        let (trial, rest) = (self, Rest(rig.clock));
        let outcome = match trial.doing {
            Doing::Idle => rig.idle(trial),
            Doing::Looking => rig.looking(trial),
            Doing::ToHome | Doing::Homing => rig.homing(trial),
            Doing::Moving => {
                let usual = usual(family, rig.clock);
                rig.moving(Some(trial), usual).0
            }
            Doing::Stopping | Doing::Halting | Doing::FarStopping | Doing::FarHalting => {
                rig.stopping(trial)
            }
        };
        if trial.frames == 0 && matches!(trial.fault, Fault::Wire(Direction::Request, _)) {
            // It was to last until it was reported.
            rig.mend();
        }
        let mut outcome = outcome;
        let last = match trial.doing {
            #[expect(clippy::cast_precision_loss, reason = "a small number")]
            Doing::Idle | Doing::Looking => Some(ratio().units_of(TARGET as f64)),
            Doing::Moving => Some(STROKE_U),
            Doing::ToHome
            | Doing::Homing
            | Doing::Stopping
            | Doing::Halting
            | Doing::FarStopping
            | Doing::FarHalting => None,
        };
        let mut ends = None;
        if let (Outcome::Survived | Outcome::Astray(_), Some(last)) = (&outcome, last) {
            match rig.ends(last, trial.lives_on) {
                Ok(found) => ends = Some(found),
                Err(lost) => outcome = Outcome::Lost(lost),
            }
        }
        // Homing goes to one side in all drives.
        if !matches!(trial.doing, Doing::ToHome | Doing::Homing)
            && let Err(lost) = rig.sides(family)
        {
            outcome = Outcome::Lost(lost);
        }
        let truth = rig.truth();
        // An attempt takes two frames at least, which a longer fault spoils.
        let stopped = rig.stops(trial.frames.div_ceil(2).max(1));
        let follows = matches!(trial.doing, Doing::Moving | Doing::Stopping | Doing::Halting);
        let struck = !follows || rig.reached.is_some();
        let gone = struck && trial.fault == Fault::Device(DeviceFault::Gone);
        let goes_on = gone.then(|| rig.goes_on(trial.doing, &truth));
        let usable = rig.recover(trial, family);
        let usable = usable.and_then(|()| {
            let truth = rig.truth();
            // The driver's last word on where it is, and the device's.
            let told = rig.drive().sample(&rest).map_err(|error| error.to_string())?;
            let moves = truth.moving || truth.other_moves;
            let both = family != Family::Pair || told.position[1] == SENSES[1] * AFTERWARDS;
            let agree = !moves && told.position[0] == AFTERWARDS && both;
            // A family may keep the new zero in its driver alone: of the device, only that it is where it was to go counts.
            for (sense, axis) in SENSES.into_iter().zip(truth.axes).take(rig.drive().axis_count()) {
                let commanded = rig.drive().commanded()[usize::from(sense < 0)];
                if commanded != Some(sense * AFTERWARDS) || axis.target != Some(axis.counter) {
                    return Err(format!("sent to {commanded:?} as the driver has it, {truth:?}"));
                }
            }
            if agree { Ok(()) } else { Err(format!("{told:?}, and in truth {truth:?}")) }
        });
        Cell { outcome, struck, stopped, truth, ends, usable, goes_on }
    }
}

/// A device that obeys.
pub(crate) fn sound(
    family: Family,
    seed: u64,
    clock: RigClock,
    otherwise: Option<Otherwise>,
) -> Rig {
    let mut rig = Rig::assuming(family, seed, clock, otherwise);
    let rest = Rest(clock);
    // A machine that is busy may keep even a sound device waiting for too long.
    let mut begin = || rig.drive().probe(&rest).and_then(|_| rig.drive().enable());
    let mut begun = begin();
    for _ in 1..MOST_ATTEMPTS {
        if begun.is_ok() {
            break;
        }
        begun = begin();
    }
    assert!(begun.is_ok(), "{family:?} {otherwise:?} is sound: {begun:?}");
    rig
}

/// How far an axis of a family is away from the plan at most when nothing goes wrong, increments. Measured once for the speed of
/// the wall clock and once for [`SPEED`](crate::rig::SPEED).
fn usual(family: Family, clock: RigClock) -> f64 {
    static USUAL: [[OnceLock<f64>; Family::ALL.len()]; 2] =
        [const { [const { OnceLock::new() }; Family::ALL.len()] }; 2];
    let place = Family::ALL.iter().position(|other| *other == family).expect("one of all");
    *USUAL[usize::from(clock.speed == 1)][place].get_or_init(|| {
        let attempt = || sound(family, 0, clock, None).moving(None, 0.0);
        let (mut outcome, mut tracks) = attempt();
        for _ in 1..MOST_ATTEMPTS {
            // A machine that is busy may keep even a sound device waiting for too long.
            if !matches!(outcome, Outcome::Told(DriveError::Timeout { .. })) {
                break;
            }
            (outcome, tracks) = attempt();
        }
        assert!(matches!(outcome, Outcome::Survived), "{family:?} without faults: {outcome:?}");
        let usual = tracks.iter().map(|track| track.usual(PEAK)).fold(0.0, f64::max);
        println!("{family:?} is {usual:.0} increments off the plan without faults");
        usual
    })
}

/// True if a cell is made: the columns of the variants are those in which they differ from their families.
pub(crate) fn is_meant(family: Family, fault: Fault, doing: Doing) -> bool {
    let of_wire = matches!(fault, Fault::Wire(..));
    let differs = match family {
        Family::Segments => matches!(doing, Doing::Moving | Doing::Stopping | Doing::Halting),
        _ => true,
    };
    // Segments go from buffer to axes; of other moves than those of a plan whoever waits for them sees that they do not come.
    let ignored = fault == Fault::Device(DeviceFault::Ignored);
    if ignored && (family == Family::Segments || doing != Doing::Moving) {
        return false;
    }
    // What befalls the device while it gets the command to home shows when it homes.
    let of_command = doing != Doing::ToHome || of_wire;
    // What becomes of a device that moves shows in the other columns; of two, the other moves as well.
    let looks = doing != Doing::Looking || of_wire || family == Family::Pair;
    differs && of_command && looks && is_meaningless(family, fault).is_none()
}

/// Reason why a fault means nothing to a family, if so.
pub(crate) fn is_meaningless(family: Family, fault: Fault) -> Option<&'static str> {
    match (family, fault) {
        (Family::Bim2Ax, Fault::Wire(_, WireFault::WrongCheck)) => Some("no check sums on a bus"),
        (Family::Bim2Ax, Fault::Wire(_, WireFault::Lose { .. } | WireFault::Double { .. })) => {
            Some("no bytes one after the other on a bus")
        }
        (Family::Bim2Ax, Fault::Wire(_, WireFault::Echo)) => Some("no echo on a bus"),
        _ => None,
    }
}
