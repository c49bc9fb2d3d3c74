//! Benchmark of the simulated machines against MuJoCo 4 (RK4 with steps of 1 ms), with collisions on, on one core: the
//! same machines, controller and collision geometry in one run.
//!
//! Every row is a machine that follows a circle for two seconds from rest. Motors get the controller's output every
//! millisecond and hold it, so that the motion has an exact solution, which our simulation reaches to all digits with
//! steps of 100 µs; errors are those of the tool tip against it. Times are per simulated millisecond. Machines are
//! noisy: both run in turn, and ratios are taken within a round. MuJoCo moves its loop in C (`mujoco.rollout`) with the
//! efforts that it had before; ours includes the controller. Numbers are printed, nothing fails on them.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    missing_docs,
    missing_debug_implementations,
    unreachable_pub,
    reason = "a benchmark that cannot be set up has failed"
)]

mod machines;
mod peer;
#[path = "../python.rs"]
mod python;
mod table;

use machines::{PERIOD, Task};
use nalgebra::Point3;
use peer::Peer;
use std::hint::black_box;
use std::time::Instant;
use table::Row;

/// Each of which times both.
const ROUNDS: usize = 9;
/// Of ours per millisecond, for the exact solution.
const FINE: i64 = 10;

fn main() {
    // Not when cargo only tests that benchmarks can be run.
    let measure = std::env::args().any(|argument| argument == "--bench");
    let tasks = machines::all();
    if !measure {
        for task in &tasks {
            check(task);
        }
        return;
    }
    let mut peer = Peer::start();
    table::head();
    for task in &tasks {
        measured(task, peer.as_mut()).print();
    }
    for task in &tasks {
        elastic(task).print();
    }
}

/// With springs, play and friction between motors and axes, under the machine's own drives. Its error is against steps of 2 µs.
fn elastic(task: &Task) -> Row {
    let error = apart(&task.elastic_tips(PERIOD), &task.elastic_tips(2e-6));
    let ours = (0..ROUNDS).map(|_| {
        let mut machine = task.elastic(PERIOD);
        per_period(task, || task.set.iter().for_each(|set| Task::follow(&mut machine, set)))
    });
    let name = format!("{}, elastic", task.name);
    Row { name, ours: ours.collect(), error, theirs: Vec::new(), peer_error: None }
}

fn measured(task: &Task, mut peer: Option<&mut Peer>) -> Row {
    let exact = task.tips(FINE);
    let error = apart(&task.tips(1), &exact);
    let peer_error = peer.as_deref_mut().map(|peer| apart(&peer.take(task), &exact));
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        ours.push(timed(task));
        theirs.extend(peer.as_deref_mut().map(Peer::again));
    }
    Row { name: task.name.to_owned(), ours, error, theirs, peer_error }
}

/// s per period.
fn timed(task: &Task) -> f64 {
    let mut machine = task.machine(1);
    let time = per_period(task, || {
        task.set.iter().for_each(|set| task.advance(&mut machine, set, 1));
    });
    black_box(machine.axis_state());
    time
}

/// s that `run` takes for each of the task's periods.
#[expect(clippy::disallowed_methods, reason = "a benchmark is about time")]
fn per_period(task: &Task, run: impl FnOnce()) -> f64 {
    let start = Instant::now();
    run();
    start.elapsed().as_secs_f64() / f64::from(u32::try_from(task.set.len()).expect("a short run"))
}

/// The largest distance, m.
fn apart(one: &[Point3<f64>], other: &[Point3<f64>]) -> f64 {
    assert_eq!(one.len(), other.len());
    one.iter().zip(other).map(|(one, other)| (one - other).norm()).fold(0.0, f64::max)
}

/// The machine does what the benchmark is about: it follows its circle, and steps of a millisecond are as good as shorter ones.
fn check(task: &Task) {
    let tips = task.tips(1);
    let error = task.following_error(&tips);
    assert!(error < 2e-4, "{}: the tip is {error} m off its circle", task.name);
    let difference = apart(&tips, &task.tips(FINE));
    assert!(difference < 1e-10, "{}: steps of a millisecond are {difference} m off", task.name);
}
