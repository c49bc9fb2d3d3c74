//! Fault matrix: every fault of every drive family in every state, over its real transport, with its outcome as a
//! table.
//!
//! `cargo test -p twin --test fault_matrix -- --nocapture` prints it. `expected.rs` has the expectation of each
//! cell, written before any run; the test reads the true state from the emulated device, not from the driver.

#![expect(clippy::expect_used, clippy::panic, reason = "a test that cannot be set up has failed")]
#![expect(clippy::indexing_slicing, reason = "one axis, and one device")]
#![expect(clippy::cast_possible_truncation, reason = "small whole numbers")]
#![expect(clippy::match_same_arms, reason = "tables: each line has its own reason")]

mod assumed;
mod expected;
mod faults;
mod kill;
mod outside;
mod rig;
mod scenario;
mod soak;
mod stopping;
mod track;

// Fixtures that golden tests share.
#[allow(dead_code, reason = "the golden tests use all of it")]
#[path = "../golden/desk.rs"]
mod desk;
#[allow(dead_code, reason = "the golden tests use all of it")]
#[path = "../golden/shop.rs"]
mod shop;

use std::{
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use assumed::Otherwise;
use expected::{Expected, expected, expected_with_encoder, frames};
use faults::{DeviceFault, Doing, Family, Fault};
use rig::{RigClock, SPEED};
use scenario::{Outcome, Strike, Trial, cell, is_meaningless, is_meant};

/// Cells made at the same time: most of the time they wait for deadlines.
const WORKERS: usize = 20;
/// Cells that are made one after the other are so far apart in the table: those of one family that follow a plan, which is
/// the most work, are not all made at the same time.
const STRIDE: usize = 97;
/// Cells of a hundred that may be made again for something that was late: more of them are no accident.
const MOST_REPEATS: usize = 5;
/// An axis may have been behind its plan in one of so many cells, and in one more in all.
const MOST_BEHIND: usize = 200;
/// Repeats of a cell in which an axis was behind its plan, at the speed of the wall clock, where a delay on a busy computer is a
/// fifth in device time: set-points that a driver loses by chance would be lost in one of them.
const REPEATS: usize = 5;

/// Matrix and soak take turns: each of them makes as much work as the computer carries.
static TURN: Mutex<()> = Mutex::new(());

/// A cell that has been made.
struct Made {
    expected: Expected,
    /// What it came to, in a word, and what is wrong with that.
    text: String,
    wrong: Option<String>,
    /// True if that is something that was late and nothing else.
    late: bool,
    /// True if that is an axis that was behind its plan on the way.
    behind: bool,
}

/// A line of the table.
#[derive(Clone, Copy)]
struct Row {
    fault: Fault,
    family: Family,
    /// Assumption that differs from the usual one.
    otherwise: Option<Otherwise>,
}

impl Row {
    /// All of them: every fault of every family, and some where something is otherwise.
    fn all() -> Vec<Self> {
        let usual = Fault::all()
            .into_iter()
            .flat_map(|fault| Family::ALL.map(|family| Self { fault, family, otherwise: None }));
        let otherwise = Otherwise::all().into_iter().flat_map(|one| {
            let row = |fault| Self { fault, family: one.family, otherwise: Some(one) };
            one.faults().map(row)
        });
        let fault = Fault::Device(DeviceFault::Stall);
        let held = Otherwise::encoders().into_iter().map(|one| Self {
            fault,
            family: one.family,
            otherwise: Some(one),
        });
        usual.chain(otherwise).chain(held).collect()
    }

    /// True if a cell of it is made.
    fn is_meant(&self, doing: Doing) -> bool {
        let here = self.otherwise.is_none_or(|otherwise| otherwise.is_meant(doing));
        if self.has_encoder() && doing == Doing::Looking {
            return true;
        }
        here && is_meant(self.family, self.fault, doing)
    }

    /// True if the axis has an encoder, and its shaft is held.
    fn has_encoder(&self) -> bool {
        self.otherwise.is_some_and(Otherwise::has_encoder)
    }

    /// Name of the cell.
    fn name(&self, doing: Doing) -> String {
        let name = format!("{:?}/{}/{doing:?}", self.family, self.fault.name());
        self.otherwise.map_or(name.clone(), |otherwise| format!("{name}/{}", otherwise.name()))
    }

    /// Remark at its end.
    fn remark(&self) -> String {
        let meaningless = is_meaningless(self.family, self.fault).map(str::to_owned);
        meaningless.or(self.otherwise.map(Otherwise::name)).unwrap_or_default()
    }
}

/// Makes a cell; `speed`: device time per wall time.
fn make(row: Row, doing: Doing, speed: u32) -> Made {
    let Row { fault, family, otherwise } = row;
    let wanted = if row.has_encoder() {
        expected_with_encoder(family, doing)
    } else {
        expected(family, fault, doing)
    };
    let frames = frames(family, fault, doing);
    let seed = otherwise.and_then(|otherwise| otherwise.seed(fault, doing));
    let seed = seed.unwrap_or_else(|| expected::seed(family, fault, doing));
    // What is put into the buffer past the driver is not what it watches.
    let buffered = family == Family::Segments && !row.has_encoder();
    let strike = Strike::default();
    let trial = Trial { fault, doing, seed, frames, buffered, otherwise, strike, lives_on: false };
    let made = cell(family, &trial, RigClock::new(speed));
    let said = match &made.outcome {
        Outcome::Told(error) => expected::Cause::of(error)
            .map_or_else(|| "told".to_owned(), |cause| format!("told {cause:?}")),
        Outcome::Survived if wanted == Expected::Unseen => "unseen".to_owned(),
        Outcome::Survived => "survived".to_owned(),
        Outcome::Lost(_) => "LOST".to_owned(),
        Outcome::Astray(_) => "ASTRAY".to_owned(),
        Outcome::NotBegun(_) => "not begun".to_owned(),
    };
    let motion = if made.stopped { "" } else { ", goes on" };
    // Where driver, device and set-point agree that the axes rest.
    let ends = made.ends.iter().flatten().map(i64::to_string).collect::<Vec<_>>().join("/");
    let ends = if ends.is_empty() { ends } else { format!(" ={ends}") };
    let wrong = wanted.check(&made).err();
    let late = wanted.is_late(&made);
    let behind = matches!(made.outcome, Outcome::Astray(_));
    Made { expected: wanted, text: format!("{said}{motion}{ends}"), wrong, late, behind }
}

#[test]
fn every_fault_comes_to_what_it_should() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    // Some of them, for those who look into one: FAULT_MATRIX="InterpCnc/answer: drop/Idle" or FAULT_MATRIX=outside.
    let wanted = std::env::var("FAULT_MATRIX").unwrap_or_default();
    let rows = Row::all();
    let cells = rows.iter().flat_map(|row| Doing::ALL.map(|doing| (*row, doing)));
    let meant = |(row, doing): (Row, Doing)| {
        (row, doing, row.is_meant(doing) && row.name(doing).contains(&wanted))
    };
    let jobs: Vec<_> = cells.map(meant).collect();
    let spread = |first| (first..jobs.len()).step_by(STRIDE);
    let order: Vec<usize> = (0..STRIDE).flat_map(spread).filter(|place| jobs[*place].2).collect();
    let next = AtomicUsize::new(0);
    let made: Vec<Mutex<Option<Made>>> = jobs.iter().map(|_| Mutex::new(None)).collect();
    thread::scope(|scope| {
        for worker in 0..WORKERS {
            let work = || {
                while let Some(place) = order.get(next.fetch_add(1, Ordering::SeqCst)) {
                    let (row, doing, _) = jobs[*place];
                    *made[*place].lock().expect("a cell") = Some(make(row, doing, SPEED));
                }
            };
            let name = format!("faults {worker}");
            thread::Builder::new().name(name).spawn_scoped(scope, work).expect("a thread");
        }
    });

    // A computer that is too busy keeps sound devices waiting: where that is all that is not as expected, the cell is made
    // again when the others are done: one whose axis was behind its plan on the way as often as it takes to tell accident from
    // driver, and each time it has to be right, within the same bound. What was lost unnoticed, what could not be stopped and
    // every other difference stands.
    let (mut again, mut behind) = (Vec::new(), 0);
    for ((row, doing, _), made) in jobs.iter().zip(&made) {
        let mut made = made.lock().expect("a cell");
        let Some(made) = &mut *made else { continue };
        if !made.late {
            continue;
        }
        behind += usize::from(made.behind);
        assert!(behind <= 1 + jobs.len() / MOST_BEHIND, "too many are behind their plans");
        again.push(format!("{}: {}", row.name(*doing), made.wrong.clone().unwrap_or_default()));
        if made.behind {
            let mut others = thread::scope(|scope| {
                let slow = || make(*row, *doing, 1);
                let slow: Vec<_> = (0..REPEATS).map(|_| scope.spawn(slow)).collect();
                slow.into_iter().map(|one| one.join().expect("a cell")).collect::<Vec<_>>()
            });
            let wrong = others.iter().position(|one| one.wrong.is_some());
            *made = others.swap_remove(wrong.unwrap_or(0));
        } else {
            *made = make(*row, *doing, SPEED);
        }
    }

    println!(
        "{:<30} {:<11} {}",
        "fault",
        "family",
        Doing::ALL.map(|doing| format!("{:<24}", format!("{doing:?}"))).concat()
    );
    let mut wrong = Vec::new();
    let (mut count, mut left) = (0, jobs.iter().zip(&made));
    for row in &rows {
        let mut shown = false;
        let cells = left.by_ref().take(Doing::ALL.len()).map(|((_, doing, _), made)| {
            let made = made.lock().expect("a cell");
            let Some(made) = &*made else {
                let mark = if row.is_meant(*doing) { "" } else { "-" };
                return format!("{mark:<24}");
            };
            (count, shown) = (count + 1, true);
            let mark = if let Some(why) = &made.wrong {
                let wanted = made.expected.name();
                wrong.push(format!("{}: {wanted} expected, {why}", row.name(*doing)));
                "! "
            } else {
                ""
            };
            format!("{:<24}", format!("{mark}{}", made.text))
        });
        let cells: Vec<String> = cells.collect();
        // Where only some are asked for, the others are of no interest.
        if shown || wanted.is_empty() {
            let family = format!("{:?}", row.family);
            let remark = row.remark();
            println!("{:<30} {family:<11} {}{remark}", row.fault.name(), cells.concat());
        }
    }
    for why in &again {
        println!("made again: {why}");
    }
    println!("{count} cells, {} not as expected, {} made again", wrong.len(), again.len());
    wrong.extend(outside::outside_faults(&wanted));
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    assert!(100 * again.len() <= MOST_REPEATS * count, "too many were made again");
    assert!(behind <= 1 + count / MOST_BEHIND, "too many were behind their plans");
}
