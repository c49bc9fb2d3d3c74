//! Benchmark of the stages behind the set-points: transform, physics step. The stages before them are in `motion.rs`.
//!
//! Throughput counts set-points or cycles. These machines are noisy: compare within one run.

#![allow(
    clippy::expect_used,
    missing_docs,
    reason = "a benchmark that cannot be set up has failed"
)]

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::path::Path;
use twin::plant::Plant;
use twin::program::{Dialect, ProgramFile, ProgramItem};
use twin::setpoint::{AxisSetpoint, Transformer};
use twin::simulated::Simulated;
use twin_kinematics::Kinematics;
use twin_machine::Machine;
use twin_planner::controller::ToolSetpoint;

fn machine() -> Machine {
    let root =
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace is above the crate");
    Machine::load(&root.join("machines/scara2.toml")).expect("shipped with the product")
}

/// Set-points of the shipped program.
fn setpoints(machine: &Machine) -> Vec<ToolSetpoint> {
    let root =
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace is above the crate");
    let path = root.join("examples/plate.cnc");
    let program = ProgramFile::new(
        &path,
        Some(Dialect::Din66025),
        twin::program::settings::ReadSettings::default(),
    )
    .expect("a known dialect");
    let items = program
        .open(machine, twin::m_function::Acknowledgement::default())
        .expect("shipped with the product");
    items
        .filter_map(|item| match item {
            ProgramItem::Setpoint(setpoint) => Some(setpoint),
            _ => None,
        })
        .collect()
}

fn transform_stage(criterion: &mut Criterion) {
    let machine = machine();
    let tools = setpoints(&machine);
    let mut group = criterion.benchmark_group("transform");
    group.throughput(Throughput::Elements(tools.len() as u64));
    group.bench_function("scara2 with Z, positions to accelerations", |bencher| {
        bencher.iter(|| {
            let mut transformer = Transformer::new(&machine);
            tools.iter().filter_map(|tool| transformer.axes(black_box(tool), None).ok()).count()
        });
    });
    let axes: Vec<_> = {
        let mut transformer = Transformer::new(&machine);
        tools.iter().filter_map(|tool| transformer.axes(tool, None).ok()).collect()
    };
    group.bench_function("scara2 with Z, forward", |bencher| {
        bencher.iter(|| {
            let poses = axes
                .iter()
                .filter_map(|axes| machine.kinematics.forward(black_box(&axes.axes.position)).ok());
            poses.count()
        });
    });
    group.finish();
}

fn physics_stage(criterion: &mut Criterion) {
    let machine = machine();
    let mut transformer = Transformer::new(&machine);
    let setpoints: Vec<AxisSetpoint> = setpoints(&machine)
        .iter()
        .take(2000)
        .filter_map(|tool| transformer.axes(tool, None).ok())
        .collect();
    let start = setpoints.first().expect("the program moves").axes.position;
    let mut group = criterion.benchmark_group("physics");
    group.throughput(Throughput::Elements(setpoints.len() as u64));
    group.bench_function("scara2, cycles of 1 ms", |bencher| {
        bencher.iter_batched(
            || Simulated::new(&machine, &start).expect("shipped with the product"),
            |mut twin| {
                for setpoint in &setpoints {
                    twin.command(setpoint).expect("a checked program");
                }
                twin
            },
            BatchSize::LargeInput,
        );
    });
    group.finish();
}

criterion_group!(stages, transform_stage, physics_stage);
criterion_main!(stages);
