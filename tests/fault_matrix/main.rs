//! Every fault of every family in every state, over its real transport: what comes of it, as a table.
//!
//! `cargo test -p twin-drives --test fault_matrix -- --nocapture` prints it. What is expected of each cell stands in
//! `expected.rs`, before anything is run; the device is asked for the truth behind the driver's back.

#![expect(clippy::expect_used, reason = "a test that cannot be set up has failed")]
#![expect(clippy::indexing_slicing, reason = "one axis, and one device")]
#![expect(clippy::cast_possible_truncation, reason = "small whole numbers")]
#![expect(clippy::match_same_arms, reason = "tables: each line has its own reason")]

mod expected;
mod faults;
mod kill;
mod rig;
mod scenario;
mod stopping;
mod track;

use std::{
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use expected::{Expected, expected, frames, seed};
use faults::{Doing, Family, Fault};
use scenario::{Outcome, Trial, cell, is_meaningless, is_meant};

/// Cells made at the same time: most of the time they wait for deadlines.
const WORKERS: usize = 20;
/// Cells of a hundred that may be made again for a deadline that has passed, each once: more of them are no accident.
const MOST_REPEATS: usize = 5;

/// A cell that has been made.
struct Made {
    expected: Expected,
    /// What it came to, in a word, and what is wrong with that.
    text: String,
    wrong: Option<String>,
    /// Whether that is a deadline which has passed and nothing else.
    late: bool,
}

fn make(family: Family, fault: Fault, doing: Doing) -> Made {
    let wanted = expected(family, fault, doing);
    let (frames, seed) = (frames(family, fault, doing), seed(family, fault, doing));
    let buffered = family == Family::Segments;
    let trial = Trial { fault, doing, seed, frames, buffered };
    let made = cell(family, &trial, rig::clock(rig::SPEED));
    let said = match &made.outcome {
        Outcome::Told(error) => expected::Cause::of(error)
            .map_or_else(|| "told".to_owned(), |cause| format!("told {cause:?}")),
        Outcome::Survived if wanted == Expected::Unseen => "unseen".to_owned(),
        Outcome::Survived => "survived".to_owned(),
        Outcome::Lost(_) => "LOST".to_owned(),
        Outcome::NotBegun(_) => "not begun".to_owned(),
    };
    let motion = if made.stopped { "" } else { ", goes on" };
    // Where driver, device and set-point agree that the axes stand.
    let ends = made.ends.iter().flatten().map(i64::to_string).collect::<Vec<_>>().join("/");
    let ends = if ends.is_empty() { ends } else { format!(" ={ends}") };
    let wrong = wanted.check(&made).err();
    let late = wanted.is_surplus_timeout(&made);
    Made { expected: wanted, text: format!("{said}{motion}{ends}"), wrong, late }
}

#[test]
fn every_fault_comes_to_what_it_should() {
    // Some of them, for those who look into one: FAULT_MATRIX="InterpCnc/answer: drop/Idle".
    let wanted = std::env::var("FAULT_MATRIX").unwrap_or_default();
    let mut jobs = Vec::new();
    for fault in Fault::all() {
        for family in Family::ALL {
            for doing in Doing::ALL {
                let name = format!("{family:?}/{}/{doing:?}", fault.name());
                let meant = name.contains(&wanted) && is_meant(family, fault, doing);
                jobs.push((fault, family, doing, meant));
            }
        }
    }
    let next = AtomicUsize::new(0);
    let made: Vec<Mutex<Option<Made>>> = jobs.iter().map(|_| Mutex::new(None)).collect();
    thread::scope(|scope| {
        for worker in 0..WORKERS {
            let work = || {
                while let Some((place, (fault, family, doing, meant))) =
                    Some(next.fetch_add(1, Ordering::SeqCst)).and_then(|p| Some((p, jobs.get(p)?)))
                {
                    if *meant {
                        let one = make(*family, *fault, *doing);
                        *made[place].lock().expect("a cell") = Some(one);
                    }
                }
            };
            let name = format!("faults {worker}");
            thread::Builder::new().name(name).spawn_scoped(scope, work).expect("a thread");
        }
    });

    // A machine that is too busy may keep sound devices waiting beyond their deadlines: where that is all that is not as
    // expected, the cell is made again, alone and once. What was lost unnoticed, what could not be stopped and every other
    // difference stands.
    let mut again = Vec::new();
    for ((fault, family, doing, _), made) in jobs.iter().zip(&made) {
        let mut made = made.lock().expect("a cell");
        let late = made.as_mut().filter(|made| made.late);
        if let Some(why) = late.and_then(|made| made.wrong.take()) {
            again.push(format!("{family:?}, {}, {doing:?}: {why}", fault.name()));
            *made = Some(make(*family, *fault, *doing));
        }
    }

    println!(
        "{:<30} {:<11} {}",
        "fault",
        "family",
        Doing::ALL.map(|doing| format!("{:<24}", format!("{doing:?}"))).concat()
    );
    let mut wrong = Vec::new();
    let (mut count, mut rows) = (0, jobs.iter().zip(&made));
    for fault in Fault::all() {
        for family in Family::ALL {
            let row: Vec<_> = rows.by_ref().take(Doing::ALL.len()).collect();
            let cells = row.iter().map(|((fault, family, doing, _), made)| {
                let made = made.lock().expect("a cell");
                let Some(made) = &*made else {
                    let meant = is_meant(*family, *fault, *doing);
                    return format!("{:<24}", if meant { "" } else { "-" });
                };
                count += 1;
                let mark = if let Some(why) = &made.wrong {
                    let (name, wanted) = (fault.name(), made.expected.name());
                    wrong.push(format!("{family:?}, {name}, {doing:?}: {wanted} expected, {why}"));
                    "! "
                } else {
                    ""
                };
                format!("{:<24}", format!("{mark}{}", made.text))
            });
            let cells: Vec<String> = cells.collect();
            let why = is_meaningless(family, fault).unwrap_or_default();
            println!("{:<30} {:<11} {}{why}", fault.name(), format!("{family:?}"), cells.concat());
        }
    }
    for why in &again {
        println!("made again: {why}");
    }
    println!("{count} cells, {} not as expected, {} made again", wrong.len(), again.len());
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    assert!(100 * again.len() <= MOST_REPEATS * count, "too many were made again");
}
