//! Benchmark of cam curves: points per second on one core, for steadily moving masters and for random masters, and the
//! cost of the bounds.
//!
//! Machines are noisy: compare within one run. Numbers are printed, nothing fails on them.

#![allow(
    clippy::expect_used,
    missing_docs,
    unreachable_pub,
    reason = "a benchmark that cannot be set up has failed"
)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use twin_cam::{
    Curve, Equidistant, Factors, Interpolation, Knot, MasterMotion, SlaveLimits, TableScale,
    VariableType,
};

/// Master positions of a run.
const POINTS: u32 = 100_000;

/// Numbers that come again with their seed (splitmix64).
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let share = ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low) * share
    }
}

/// Points at uneven distances over one turn.
fn polynomial(points: u32) -> Curve {
    let mut random = Random(points.into());
    let mut masters: Vec<f64> = (2..points).map(|_| random.between(0.0, 360.0)).collect();
    masters.extend([0.0, 360.0]);
    masters.sort_by(f64::total_cmp);
    let knots: Vec<_> = masters
        .into_iter()
        .map(|master| Knot {
            master,
            slave: random.between(-100.0, 100.0),
            velocity: random.between(-1.0, 1.0),
            acceleration: random.between(-0.1, 0.1),
        })
        .collect();
    Curve::polynomial(&knots).expect("a curve")
}

fn table(points: u32) -> Curve {
    let table = Equidistant {
        variable: VariableType::Lreal,
        start: 0.0,
        end: 360.0,
        periodic: true,
        slave: TableScale::IDENTITY,
        interpolation: Interpolation::Cubic,
        values: (0..points).map(|i| f64::from(i * i % 101)).collect(),
    };
    table.curve().expect("a curve")
}

fn evaluation(criterion: &mut Criterion) {
    let mut random = Random(8);
    let anywhere: Vec<f64> = (0..POINTS).map(|_| random.between(0.0, 360.0)).collect();
    let mut sorted = anywhere.clone();
    sorted.sort_by(f64::total_cmp);
    let curves = [
        ("polynomial of 20 points", polynomial(20)),
        ("polynomial of 1,000 points", polynomial(1000)),
        ("table of 10,000 points", table(10_000)),
    ];
    let mut group = criterion.benchmark_group("evaluate y, y\u{2032}, y\u{2033}, y\u{2034}");
    group.throughput(Throughput::Elements(POINTS.into()));
    for (name, curve) in &curves {
        for (order, masters) in [("sorted", &sorted), ("random", &anywhere)] {
            group.bench_function(format!("{name}, {order}"), |bencher| {
                bencher.iter(|| {
                    for master in black_box(masters) {
                        black_box(curve.repeated(*master));
                    }
                });
            });
        }
    }
    group.finish();
}

fn bounds(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("exact bounds");
    let master = MasterMotion { velocity: 10.0, acceleration: 20.0, jerk: 0.0 };
    let limits = SlaveLimits { velocity: 1e6, acceleration: 1e9, jerk: f64::INFINITY };
    for points in [20, 1000] {
        let curve = polynomial(points);
        group.throughput(Throughput::Elements(u64::from(points) - 1));
        group.bench_function(format!("bounds, {points} points"), |bencher| {
            bencher.iter(|| black_box(&curve).bounds(&master, Factors::default()));
        });
        group.bench_function(format!("largest velocity, {points} points"), |bencher| {
            bencher.iter(|| {
                black_box(&curve)
                    .largest_master_velocity(&limits, &master, Factors::default(), false)
                    .expect("a velocity")
            });
        });
    }
    group.finish();
}

criterion_group!(benches, evaluation, bounds);
criterion_main!(benches);
