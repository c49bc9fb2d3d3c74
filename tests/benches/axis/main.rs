//! Benchmark of single-axis profiles: moves per second for each ramp. Ruckig's C++ library plans the same jerk-limited
//! moves in the same run (`tests/peers/ruckig_moves.py`), if Python, its wheel and a C++ compiler are installed.
//!
//! Both check their input. Machines are noisy: compare within one run. Numbers are printed, nothing fails on them.

#![allow(
    clippy::expect_used,
    missing_docs,
    missing_debug_implementations,
    unreachable_pub,
    reason = "a benchmark that cannot be set up has failed"
)]

mod peer;
#[path = "../python.rs"]
mod python;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use twin_profile::{AxisLimits, Profile, RampType, State};

/// Moves per table.
const MOVES: usize = 4096;

/// A move to be planned.
#[derive(Clone, Copy)]
pub struct Move {
    pub from: State,
    pub target: f64,
    pub end_velocity: f64,
    pub limits: AxisLimits,
}

impl Move {
    /// Duration with `ramp`, s.
    pub fn duration(&self, ramp: RampType) -> f64 {
        let Self { from, target, end_velocity, limits } = *self;
        let profile = Profile::to_position(from, target, end_velocity, limits, ramp);
        match &profile {
            Ok(profile) => black_box(profile).duration(),
            Err(_) => f64::NAN,
        }
    }
}

/// Evenly spread from 0 to 1, the same in every run (a golden-ratio sequence per dimension).
fn spread(index: usize, dimension: i32) -> f64 {
    let index = f64::from(u32::try_from(index).expect("a small table"));
    (0.5 + index * 0.618_033_988_749_894_9_f64.powf(1.0 / f64::from(dimension))).fract()
}

/// From rest to rest, or with `moving` from any state of motion within the limits, half of them to a velocity.
pub fn moves(moving: bool) -> Vec<Move> {
    let one = |index: usize| {
        let at = |dimension| spread(index, dimension);
        let power =
            |dimension, from: f64, to: f64| 10.0_f64.powf(from + (to - from) * at(dimension));
        let velocity = power(1, 0.0, 2.0);
        let acceleration = power(2, 0.5, 2.5);
        let limits = AxisLimits {
            velocity,
            acceleration,
            deceleration: acceleration,
            jerk: acceleration * power(3, 0.0, 2.0),
        };
        let signed = |dimension| 2.0 * at(dimension) - 1.0;
        let target = power(4, -1.0, 2.0) * signed(5).signum();
        if !moving {
            return Move { from: State::resting(0.0), target, end_velocity: 0.0, limits };
        }
        let from = State {
            position: 0.0,
            velocity: 0.5 * velocity * signed(6),
            acceleration: 0.5 * acceleration.min((velocity * limits.jerk).sqrt()) * signed(7),
        };
        let end_velocity = if index.is_multiple_of(2) { 0.0 } else { velocity * signed(8) };
        Move { from, target, end_velocity, limits }
    };
    (0..MOVES).map(one).collect()
}

fn ours(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("axis");
    group.throughput(Throughput::Elements(MOVES as u64));
    for (what, moving) in [("rest to rest", false), ("in motion", true)] {
        let moves = moves(moving);
        for ramp in [RampType::Trapezoid, RampType::Parabolic, RampType::Sigmoid] {
            group.bench_function(format!("{what}, {ramp:?}").to_lowercase(), |bencher| {
                bencher.iter(|| moves.iter().map(|one| black_box(one).duration(ramp)).sum::<f64>());
            });
        }
    }
}

criterion_group!(benches, ours, peer::compare);
criterion_main!(benches);
