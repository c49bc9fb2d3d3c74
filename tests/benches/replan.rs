//! Benchmark of replanning: computing time from a change of the override to the next planned item.
//!
//! The paths are rounded zigzags of lines of 0.2 mm to 40 mm. At a series of times the override changes; items that
//! begin more than 0.1 s later are taken back, and the benchmark waits for the next item. It prints a table.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::cast_precision_loss,
    dead_code,
    missing_docs,
    missing_debug_implementations,
    unreachable_pub,
    reason = "a table that cannot be made has failed; the machines are those of a test"
)]

#[path = "../planner/machines.rs"]
mod machines;

use machines::Machine;
use nalgebra::Point3;
use std::collections::VecDeque;
use std::f64::consts::PI;
use std::time::Instant;
use twin_path::Place;
use twin_path::prepare::{CheckError, CheckVelocities};
use twin_path::{ElementKind, PathElement, Shape};
use twin_planner::blended_path::{BlendOptions, Order};
use twin_planner::time_optimal::{LimitOptions, Planned, Planner};

/// Values to which the override changes.
const FACTORS: [f64; 5] = [0.0, 0.1, 0.5, 0.9, 1.5];
/// Between two changes, s of the path; each is the first one in a program of its own.
const EVERY: f64 = 0.11;
/// What begins within this time, s, goes on as it was planned, and so much is known, s.
const LEAD: f64 = 0.1;
const AHEAD: f64 = 1.0;

/// Cost of one replanning.
struct Attempt {
    seconds: f64,
    work: u64,
    in_time: bool,
}

fn main() {
    if !std::env::args().any(|argument| argument == "--bench") {
        return; // cargo only tests that benchmarks can be run
    }
    println!(
        "{:10}{:>9}{:>9}{:>10}{:>9}{:>9}{:>9}{:>12}{:>14}",
        "machine",
        "override",
        "changes",
        "not found",
        "half ms",
        "95 % ms",
        "all ms",
        "most work",
        "µs per work"
    );
    let mut all = Vec::new();
    for machine in Machine::ALL {
        for factor in FACTORS {
            let mut attempts = Vec::new();
            let mut time = 0.05;
            while let Some(attempt) = attempt(machine, factor, time) {
                attempts.push(attempt);
                time += EVERY;
            }
            print(machine.name(), &format!("{:.0} %", 100.0 * factor), &mut attempts);
            all.append(&mut attempts);
        }
    }
    print("all", "", &mut all);
}

fn print(machine: &str, factor: &str, attempts: &mut [Attempt]) {
    attempts.sort_by(|one, other| one.seconds.total_cmp(&other.seconds));
    let at =
        |part: usize| 1e3 * attempts[(attempts.len() * part / 100).min(attempts.len() - 1)].seconds;
    let missed = attempts.iter().filter(|attempt| !attempt.in_time).count();
    let most = attempts.iter().map(|attempt| attempt.work).max().unwrap_or_default();
    let seconds: f64 = attempts.iter().map(|attempt| attempt.seconds).sum();
    let work: u64 = attempts.iter().map(|attempt| attempt.work).sum();
    println!(
        "{machine:10}{factor:>9}{:>9}{missed:>10}{:>9.1}{:>9.1}{:>9.1}{most:>12}{:>14.2}",
        attempts.len(),
        at(50),
        at(95),
        at(100),
        1e6 * seconds / work as f64
    );
}

/// The override becomes `factor` at `time`, s, of the program; none if that is over by then.
fn attempt(machine: Machine, factor: f64, time: f64) -> Option<Attempt> {
    let elements = program(machine).into_iter().map(Ok::<_, CheckError>);
    let blending = BlendOptions { order: Order::Acceleration, ..BlendOptions::new(1e-5) };
    let path = machine.path(true);
    let mut planner =
        Planner::new(CheckVelocities::new(elements, PI), path, LimitOptions::new(blending));
    let mut ahead: VecDeque<(f64, Planned)> = VecDeque::new();
    let mut end = 0.0;
    while end < time + LEAD + AHEAD {
        let Some(item) = planner.next() else { break };
        let item = item.expect("a plan");
        let begins = end;
        if let Planned::Leg(leg) = &item {
            end += leg.stretch.duration();
        }
        ahead.push_back((begins, item));
    }
    let kept = ahead.partition_point(|(begins, _)| *begins < time + LEAD);
    let back = ahead.split_off(kept);
    if back.is_empty() {
        return None;
    }
    #[expect(clippy::disallowed_methods, reason = "a benchmark is about time")]
    let begun = Instant::now();
    planner.take_back(back.into_iter().map(|(_, item)| Ok(item)));
    planner.set_override(factor);
    let next = planner.next();
    let seconds = begun.elapsed().as_secs_f64();
    next?.expect("a plan");
    let effort = planner.effort();
    Some(Attempt { seconds, work: effort.most_replanning, in_time: effort.not_replanned == 0 })
}

/// In the middle of the machine's room.
fn program(machine: Machine) -> Vec<PathElement> {
    let [min, max] = machine.room();
    let mut at = Point3::from(0.5 * (min + max));
    let mut elements = Vec::new();
    for index in 0..48_u8 {
        let number = f64::from(index);
        // Golden angles look in all directions.
        let direction = 2.4 * number;
        let length = [0.04, 0.0002, 0.012, 0.003, 0.02, 0.0007][usize::from(index % 6)];
        let mut end = at;
        end.x += length * direction.cos();
        end.y += length * direction.sin();
        // Back to the middle.
        end.x -= 0.5 * (end.x - 0.5 * (min.x + max.x));
        end.y -= 0.5 * (end.y - 0.5 * (min.y + max.y));
        let place = Place::at(u32::from(index) + 1);
        let shape = Shape::Line { start: at, end };
        let made = PathElement::new(place, ElementKind::Cut, shape);
        elements.push(PathElement { feed: 0.15, acceleration: 2.0, deceleration: 2.0, ..made });
        at = end;
    }
    elements
}
