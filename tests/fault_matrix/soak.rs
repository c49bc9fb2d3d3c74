//! Simulated soak: a day of machine time with random faults of every kind, on devices that live on through all of them.
//!
//! Each worker has a device of one family. Event after event, a random fault occurs during a random activity; then the
//! device is brought back to work as in the matrix and returns to its start. With `TWIN_LONG` these are 24 h
//! of machine time in all, otherwise a few minutes, or as many hours as `TWIN_SOAK_HOURS`. `TWIN_SOAK_SEED` decides
//! every event.
//!
//! The parameters of a fault are random as well, so that the matrix has no exact outcome for it. Whatever they are:
//!
//! * An activity ends where the axis was sent, by device, driver and set-point, or an error is reported. Exceptions are
//!   those of the matrix: corruption that a check sum does not find (`expected::passes_the_check`).
//! * After stopping by all means no axis moves; one that is unplugged goes on to its target and no farther.
//! * Afterwards the device works.
//! * Nothing panics.

use std::{
    any::Any,
    collections::BTreeMap,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use twin_drives::{Clock, Direction, DriveError, WireFault};

use crate::{
    MOST_REPEATS, TURN,
    expected::{Expected, expected, passes_the_check},
    faults::{DeviceFault, Doing, Family, Fault},
    rig::{Rig, RigClock, SPEED},
    scenario::{Cell, Outcome, Strike, Trial, is_meant, sound},
};

/// Machine time in all, h: with `TWIN_LONG`, and otherwise.
const LONG_H: f64 = 24.0;
const SHORT_H: f64 = 0.1;
/// Devices side by side.
const WORKERS: usize = 40;
/// Events of a hundred after which an axis may have been behind its plan: outages are up to three times as long as in the matrix.
const MOST_BEHIND: usize = 2;
/// Failures after which the soak ends early.
const MOST_FAILURES: usize = 20;
/// Environment variables: machine time in all, seed of all events, and events to be repeated, `WORKER.EVENT` or
/// `WORKER.FIRST-LAST`.
const HOURS: &str = "TWIN_SOAK_HOURS";
const SEED: &str = "TWIN_SOAK_SEED";
const EVENTS: &str = "TWIN_SOAK_EVENTS";

/// Random numbers: `SplitMix64` (Steele, Lea and Flood, 2014).
struct Random(u64);

impl Random {
    /// Random numbers of an event.
    fn of(seed: u64, worker: usize, event: usize) -> Self {
        let mut random = Self(seed);
        for part in [worker, event] {
            random.0 = random.next() ^ part as u64;
        }
        random
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ mixed >> 31
    }

    /// A number from `first` to `last`.
    fn between(&mut self, first: i64, last: i64) -> i64 {
        first + (self.next() % (last - first + 1).unsigned_abs()).cast_signed()
    }

    fn count(&mut self, first: u32, last: u32) -> u32 {
        u32::try_from(self.between(first.into(), last.into())).unwrap_or(last)
    }

    fn bytes(&mut self, first: u32, last: u32) -> usize {
        self.count(first, last) as usize
    }

    fn one_of<T: Copy>(&mut self, list: &[T]) -> T {
        list[(self.next() % list.len() as u64) as usize]
    }
}

/// Family of a worker's devices: each family has as many workers, and the seed decides which.
fn family(seed: u64, worker: usize) -> Family {
    let first = Random(seed).bytes(0, Family::ALL.len() as u32 - 1);
    Family::ALL[(first + worker) % Family::ALL.len()]
}

/// Draws the parameters of an event.
fn draw(seed: u64, worker: usize, event: usize) -> Trial {
    let family = family(seed, worker);
    let random = &mut Random::of(seed, worker, event);
    let mut faults = Fault::all();
    let directions = [Direction::Request, Direction::Answer];
    if family != Family::Bim2Ax {
        // A bus has no noise before a frame.
        faults.extend(directions.map(|way| Fault::Wire(way, WireFault::Noise { bytes: 1 })));
    }
    let (fault, doing) = loop {
        let (fault, doing) = (random.one_of(&faults), random.one_of(&Doing::ALL));
        if is_meant(family, fault, doing) {
            break (draw_parameters(random, fault), doing);
        }
    };
    let strike = draw_strike(random, fault, doing);
    let frames = if matches!(fault, Fault::Wire(..)) { random.count(1, 6) } else { 1 };
    let buffered = family == Family::Segments && random.count(0, 1) == 1;
    Trial {
        fault,
        doing,
        seed: random.next(),
        frames,
        buffered,
        otherwise: None,
        strike,
        lives_on: true,
    }
}

/// The fault with other parameters.
fn draw_parameters(random: &mut Random, fault: Fault) -> Fault {
    let Fault::Wire(direction, wire) = fault else { return fault };
    let wire = match wire {
        WireFault::Corrupt { .. } => WireFault::Corrupt { bytes: random.bytes(1, 4) },
        WireFault::Lose { .. } => WireFault::Lose { bytes: random.bytes(1, 4) },
        WireFault::Double { .. } => WireFault::Double { bytes: random.bytes(1, 4) },
        WireFault::Noise { .. } => WireFault::Noise { bytes: random.bytes(1, 8) },
        WireFault::Truncate { .. } => WireFault::Truncate { keep: random.bytes(0, 6) },
        WireFault::Refuse { .. } => WireFault::Refuse { code: random.count(1, 6) as u8 },
        // Up to 500 ms of the wall clock.
        WireFault::Delay { .. } => {
            WireFault::Delay { ns: i64::from(SPEED) * random.between(1, 500) * 1_000_000 }
        }
        other => other,
    };
    Fault::Wire(direction, wire)
}

/// Draws the request or position at which a fault occurs, before the activity ends.
fn draw_strike(random: &mut Random, fault: Fault, doing: Doing) -> Strike {
    let of_wire = matches!(fault, Fault::Wire(..));
    let after = match doing {
        Doing::Idle if of_wire => Some(random.count(1, 2)),
        Doing::Idle => None,
        Doing::Looking => Some(random.count(0, 10)),
        Doing::ToHome => Some(random.count(1, 3)),
        Doing::Homing => Some(random.count(4, 16)),
        Doing::Moving => None,
        Doing::Stopping | Doing::Halting | Doing::FarStopping | Doing::FarHalting => {
            Some(random.count(0, if of_wire { 2 } else { 1 }))
        }
    };
    let position = random.between(300, 12_000);
    let followed_ns = random.between(2_000, 11_000) * 1_000_000;
    Strike { after, position, followed_ns }
}

/// True if an event may take more than about 10 s of the wall clock: only a long soak has it.
fn is_slow(trial: &Trial) -> bool {
    match trial.fault {
        Fault::Wire(..) => trial.frames > 2,
        Fault::Device(DeviceFault::Outage | DeviceFault::Stuck) => true,
        Fault::Device(DeviceFault::Gone) => {
            matches!(trial.doing, Doing::FarStopping | Doing::FarHalting)
        }
        Fault::Device(_) => false,
    }
}

/// Result of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Result {
    Survived,
    Reported,
    /// No driver can detect it: a shaft without encoder, a frame that passes its check.
    Unseen,
    /// A busy computer kept a sound device waiting, before the fault.
    Late,
    /// It went where it was sent, but behind its plan: longer outages than those of the matrix, and a busy computer.
    Behind,
}

/// Judges a cell; the error says what is wrong with it.
fn judge(family: Family, trial: &Trial, cell: &Cell) -> std::result::Result<Result, String> {
    let expected = expected(family, trial.fault, trial.doing);
    let passes = passes_the_check(family, trial.fault);
    let result = match &cell.outcome {
        Outcome::Told(DriveError::Timeout { .. }) if !cell.struck => Result::Late,
        Outcome::Lost(what) if !cell.struck => return Err(format!("before its fault: {what}")),
        Outcome::Told(error) if !cell.struck => return Err(format!("before its fault: {error}")),
        Outcome::Told(_) => Result::Reported,
        Outcome::Survived if expected == Expected::Unseen => Result::Unseen,
        // What a device does by itself is reported, whenever that happens.
        Outcome::Survived
            if matches!(trial.fault, Fault::Device(_)) && !expected.is_survivable() =>
        {
            return Err("nothing is reported".to_owned());
        }
        Outcome::Survived => Result::Survived,
        Outcome::Lost(_) if passes => Result::Unseen,
        Outcome::Lost(what) => return Err(format!("lost unnoticed: {what}")),
        Outcome::Astray(_) => Result::Behind,
        Outcome::NotBegun(DriveError::Timeout { .. }) => Result::Late,
        Outcome::NotBegun(error) => return Err(format!("it does not begin: {error}")),
    };
    match &cell.goes_on {
        Some(goes_on) => goes_on.clone()?,
        None if cell.stopped => {}
        None => return Err(format!("it cannot be stopped: {:?}", cell.outcome)),
    }
    cell.usable.as_ref().map_err(|why| format!("not usable afterwards: {why}"))?;
    Ok(result)
}

/// Counts of a soak.
#[derive(Default)]
struct Counts {
    /// By fault, and by result.
    faults: BTreeMap<(String, Result), usize>,
    machine_ns: i64,
    /// Devices beyond the first of each worker.
    fresh: usize,
    /// Axes left moving, unreported events, and others that failed.
    moving: usize,
    unreported: usize,
    failures: Vec<String>,
}

/// Kind of a fault without its parameters, as a line of the summary.
fn kind(fault: Fault) -> String {
    let name = fault.name();
    if matches!(fault, Fault::Wire(_, WireFault::Noise { .. })) {
        return name.replace(|letter: char| letter.is_ascii_digit(), "").replace(" bytes of ", "");
    }
    let kind = name.split(|letter: char| letter.is_ascii_digit()).next().unwrap_or(&name).trim();
    let kind = kind.trim_end_matches(" to").trim_end_matches(" with").trim_end_matches(" for");
    kind.to_owned()
}

/// A soak under way.
struct Soak {
    seed: u64,
    counts: Mutex<Counts>,
    failed: AtomicUsize,
    /// Leaves slow events out.
    is_short: bool,
    /// Prints each event.
    is_verbose: bool,
}

impl Soak {
    fn new(seed: u64, is_short: bool, is_verbose: bool) -> Self {
        Self { seed, counts: Mutex::default(), failed: AtomicUsize::new(0), is_short, is_verbose }
    }

    fn counts(&self) -> std::sync::MutexGuard<'_, Counts> {
        self.counts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes the events of a worker up to the last, or until its machine time is over.
    fn live(&self, worker: usize, events: std::ops::RangeInclusive<usize>, machine_ns: i64) {
        let family = family(self.seed, worker);
        let clock = RigClock::new(SPEED);
        let mut device: Option<(usize, Rig)> = None;
        for event in events {
            if clock.now_ns() > machine_ns || self.failed.load(Ordering::SeqCst) >= MOST_FAILURES {
                break;
            }
            let trial = draw(self.seed, worker, event);
            if self.is_short && is_slow(&trial) {
                continue;
            }
            if self.is_verbose {
                println!("{worker}.{event}: {family:?}, {trial:?}");
            }
            let (first, mut rig) =
                device.take().unwrap_or_else(|| (event, sound(family, trial.seed, clock, None)));
            rig.set_seed(trial.seed);
            let made = catch_unwind(AssertUnwindSafe(|| trial.made_by(family, &mut rig)));
            let result = match &made {
                Ok(cell) => judge(family, &trial, cell),
                Err(panic) => Err(format!("it panics: {}", words(&**panic))),
            };
            if self.is_verbose {
                println!("{worker}.{event}: {result:?}, {made:?}");
            }
            self.count(&trial, made.as_ref().ok(), result.as_ref().ok());
            if let Err(why) = &result {
                self.fail(worker, (first, event), &trial, why);
            }
            let usable = made.is_ok_and(|cell| cell.usable.is_ok());
            let begins = if usable { rig.begin_again() } else { Err("not usable".to_owned()) };
            match begins {
                Ok(()) => device = Some((first, rig)),
                Err(why) => {
                    // Only what passes its check may change a device for good.
                    if usable && !passes_the_check(family, trial.fault) {
                        self.fail(worker, (first, event), &trial, &why);
                    }
                    println!("fresh device after {worker}.{event}, {trial:?}: {why}");
                    self.counts().fresh += 1;
                }
            }
        }
        self.counts().machine_ns += clock.now_ns();
    }

    fn count(&self, trial: &Trial, cell: Option<&Cell>, result: Option<&Result>) {
        let mut counts = self.counts();
        if let Some(result) = result {
            *counts.faults.entry((kind(trial.fault), *result)).or_default() += 1;
            return;
        }
        let Some(cell) = cell else { return };
        let moves = match &cell.goes_on {
            Some(goes_on) => goes_on.is_err(),
            None => !cell.stopped,
        };
        counts.moving += usize::from(moves);
        counts.unreported += usize::from(!matches!(cell.outcome, Outcome::Told(_)));
    }

    fn fail(&self, worker: usize, (first, event): (usize, usize), trial: &Trial, why: &str) {
        self.failed.fetch_add(1, Ordering::SeqCst);
        let long = if self.is_short { "" } else { "TWIN_LONG=1 " };
        let again = |events: String| {
            format!(
                "    {long}{SEED}={} {EVENTS}={worker}.{events} cargo test --workspace --locked --test fault_matrix soak -- --nocapture",
                self.seed
            )
        };
        let family = family(self.seed, worker);
        let mut text = format!("{worker}.{event}: {family:?}, {trial:?}: {why}\n  alone:\n");
        text += &again(event.to_string());
        if first != event {
            text += "\n  with all earlier events of its device:\n";
            text += &again(format!("{first}-{event}"));
        }
        println!("{text}");
        self.counts().failures.push(text);
    }
}

/// Message of a panic.
pub(crate) fn words(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message")
}

/// Worker and events of `WORKER.EVENT` or `WORKER.FIRST-LAST`.
fn repeated(text: &str) -> Option<(usize, std::ops::RangeInclusive<usize>)> {
    let (worker, events) = text.split_once('.')?;
    let (first, last) = events.split_once('-').unwrap_or((events, events));
    Some((worker.parse().ok()?, first.parse().ok()?..=last.parse().ok()?))
}

fn print(counts: &Counts, wall_s: f64) {
    let all = [Result::Survived, Result::Reported, Result::Unseen, Result::Behind, Result::Late];
    println!(
        "{:<30}{}",
        "fault",
        all.map(|result| format!("{:>10}", format!("{result:?}"))).concat()
    );
    let mut names: Vec<_> = counts.faults.keys().map(|(name, _)| name).collect();
    names.dedup();
    let of = |name: &str, result| *counts.faults.get(&(name.to_owned(), result)).unwrap_or(&0);
    let line = |name: &str, numbers: [usize; 5]| {
        println!("{name:<30}{}", numbers.map(|number| format!("{number:>10}")).concat());
    };
    for name in &names {
        line(name, all.map(|result| of(name, result)));
    }
    line("all", all.map(|result| names.iter().map(|name| of(name, result)).sum()));
    #[expect(clippy::cast_precision_loss, reason = "hours")]
    let hours = counts.machine_ns as f64 * 1e-9 / 3600.0;
    println!(
        "{hours:.2} h of machine time in {wall_s:.0} s, {} kinds of faults, {} fresh devices",
        names.len(),
        counts.fresh
    );
    println!(
        "{} failures, {} axes left moving, {} unreported events",
        counts.failures.len(),
        counts.moving,
        counts.unreported
    );
}

#[test]
fn a_soak_leaves_no_axis_moving_and_no_event_unreported() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let seed = std::env::var(SEED).map_or(1, |text| text.parse().expect("a seed is a number"));
    let usual_h = if std::env::var_os("TWIN_LONG").is_some() { LONG_H } else { SHORT_H };
    let hours = std::env::var(HOURS).map_or(usual_h, |text| text.parse().expect("hours"));
    #[expect(clippy::cast_precision_loss, reason = "a small number")]
    let each_ns = (hours * 3600e9 / WORKERS as f64) as i64;
    let events = std::env::var(EVENTS).ok();
    let soak = Soak::new(seed, hours < 1.0, events.is_some());
    let wall = RigClock::new(1);
    if let Some(text) = events {
        let (worker, events) =
            repeated(&text).expect("events are WORKER.EVENT or WORKER.FIRST-LAST");
        println!("soak with seed {seed}, events {text}");
        soak.live(worker, events, i64::MAX);
    } else {
        println!("soak with seed {seed}, {WORKERS} devices");
        thread::scope(|scope| {
            for worker in 0..WORKERS {
                let soak = &soak;
                let live = move || soak.live(worker, 0..=usize::MAX, each_ns);
                let name = format!("soak {worker}");
                thread::Builder::new().name(name).spawn_scoped(scope, live).expect("a thread");
            }
        });
    }
    let counts = soak.counts();
    #[expect(clippy::cast_precision_loss, reason = "seconds")]
    print(&counts, wall.now_ns() as f64 * 1e-9);
    assert!(counts.failures.is_empty(), "\n{}", counts.failures.join("\n"));
    assert!(!counts.faults.is_empty(), "nothing was made");
    // As in the matrix: a busy computer may keep a sound device waiting now and then.
    let of = |result| counts.faults.iter().filter(move |((_, of), _)| *of == result);
    let number = |result| of(result).map(|(_, count)| count).sum::<usize>();
    let events = counts.faults.values().sum::<usize>();
    assert!(
        100 * number(Result::Behind) <= MOST_BEHIND * events.max(100),
        "too many are behind their plans"
    );
    assert!(100 * number(Result::Late) <= MOST_REPEATS * events.max(20), "too many are late");
}
