//! Benchmark of the inverse transforms: tool positions to axes, without and with velocities and accelerations, for
//! every kind; and LinuxCNC's kinematics, if its sources and a C compiler are installed.
//!
//! Throughput counts tool positions, on one core. Machines are noisy: compare within one run. Numbers are printed,
//! nothing fails on them.

#![allow(
    clippy::expect_used,
    missing_docs,
    missing_debug_implementations,
    unreachable_pub,
    reason = "a benchmark that cannot be set up has failed; the machines are those of a test, too"
)]

mod machines;
mod peer;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use machines::{Placed, Visit, each};
use nalgebra::SVector;
use std::hint::black_box;
use std::time::Duration;
use twin_kinematics::transform::{Motion, Transform};
use twin_kinematics::{Kinematics, KinematicsError};

/// Tool positions per table, few enough to stay in the cache nearest to the core.
pub(crate) const PLACES: usize = 512;

/// Moving tools at the places of a machine.
pub(crate) fn motions<T, const N: usize>(placed: &Placed<T, N>) -> Vec<Motion<N>> {
    let velocities = machines::spread(placed.tools.len(), [[-0.5, 0.5]; N]);
    let accelerations = machines::spread(placed.tools.len(), [[-5.0, 5.0]; N]);
    let all = placed.tools.iter().zip(velocities).zip(accelerations);
    all.map(|((position, velocity), acceleration)| Motion {
        position: *position,
        velocity,
        acceleration,
    })
    .collect()
}

/// Axis positions for every place, added up so that none can be left out.
#[inline(never)]
pub(crate) fn positions<T: Transform<N>, const N: usize>(
    machine: &T,
    tools: &[SVector<f64, N>],
) -> Result<SVector<f64, N>, KinematicsError> {
    let mut sum = SVector::zeros();
    for tool in tools {
        sum += machine.to_axes(tool)?;
    }
    Ok(sum)
}

/// The same with velocities and accelerations.
#[inline(never)]
pub(crate) fn with_derivatives<T: Transform<N>, const N: usize>(
    machine: &T,
    tools: &[Motion<N>],
    near: &[SVector<f64, N>],
) -> Result<[SVector<f64, N>; 3], KinematicsError> {
    let mut sum = [SVector::zeros(); 3];
    for (tool, near) in tools.iter().zip(near) {
        let axes = machine.axis_motion(tool, near)?;
        let [position, velocity, acceleration] = &mut sum;
        *position += axes.position;
        *velocity += axes.velocity;
        *acceleration += axes.acceleration;
    }
    Ok(sum)
}

struct Group<'a> {
    group: BenchmarkGroup<'a, WallTime>,
    derivatives: bool,
}

impl Visit for Group<'_> {
    fn visit<T: Transform<N> + Kinematics, const N: usize>(
        &mut self,
        name: &'static str,
        placed: &Placed<T, N>,
    ) {
        let Placed { machine, tools, axes } = placed;
        let motions = motions(placed);
        if self.derivatives {
            self.group.bench_function(name, |bencher| {
                bencher.iter(|| {
                    with_derivatives(black_box(machine), black_box(&motions), black_box(axes))
                });
            });
        } else {
            self.group.bench_function(name, |bencher| {
                bencher.iter(|| positions(black_box(machine), black_box(tools)));
            });
        }
    }
}

fn transforms(criterion: &mut Criterion) {
    for (name, derivatives) in [("positions", false), ("velocities and accelerations", true)] {
        let mut group = criterion.benchmark_group(name);
        group
            .sample_size(20)
            .warm_up_time(Duration::from_millis(300))
            .measurement_time(Duration::from_secs(1))
            .throughput(Throughput::Elements(PLACES as u64));
        let mut visit = Group { group, derivatives };
        each(PLACES, &mut visit);
        visit.group.finish();
    }
}

criterion_group!(all, transforms, peer::compare);
criterion_main!(all);
