//! One benchmark per stage: decode, plan, transform, physics step.
//!
//! Throughput counts lines, set-points or cycles. These machines are noisy: compare within one run.

#![allow(
    clippy::expect_used,
    missing_docs,
    reason = "a benchmark that cannot be set up has failed"
)]

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use std::fmt::Write;
use std::hint::black_box;
use std::path::Path;
use twin::machine::Machine;
use twin::plant::Plant;
use twin::program::{Dialect, ProgramFile, ProgramItem};
use twin::setpoint::{AxisSetpoint, Transformer};
use twin::simulated::Simulated;
use twin_kinematics::Kinematics;
use twin_motion::din66025::{Decoder, DecoderOptions, Item};
use twin_motion::interpolate::{DEFAULT_CYCLE_NS, Interpolator, LookAhead, ToolSetpoint};
use twin_motion::path::PathElement;
use twin_motion::prepare::{CheckError, CheckVelocities};

const LINES: u32 = 20_000;

/// Short segments on a gentle curve: what CAM systems write.
fn program() -> String {
    let mut text = String::from("% spiral\nG92 X300 Y0 Z20 F60 E800 E-800\n");
    for number in 1..=LINES {
        let turn = f64::from(number) * 0.01;
        let (x, y) = (300.0 + 40.0 * turn.sin(), 40.0 * turn.cos() - 40.0);
        writeln!(text, "N{number} G1 X{x:.4} Y{y:.4}").expect("a string takes everything");
    }
    text
}

fn decode(text: &str) -> impl Iterator<Item = PathElement> {
    let options = DecoderOptions { start: [0.3, 0.0, 0.02], ..DecoderOptions::default() };
    Decoder::new(text.as_bytes(), options).filter_map(|item| match item {
        Ok(Item::Element(element)) => Some(element),
        _ => None,
    })
}

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
    let program =
        ProgramFile::new(&path, Some(Dialect::Din66025), twin::settings::ReadSettings::default())
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

fn decode_stage(criterion: &mut Criterion) {
    let text = program();
    let mut group = criterion.benchmark_group("decode");
    group.throughput(Throughput::Elements(LINES.into()));
    group
        .bench_function("lines of G1", |bencher| bencher.iter(|| decode(black_box(&text)).count()));
    group.finish();
}

fn plan_stage(criterion: &mut Criterion) {
    let text = program();
    let elements: Vec<_> = decode(&text).collect();
    let plan = |elements: Vec<PathElement>| {
        let checked = CheckVelocities::new(elements.into_iter().map(Ok::<_, CheckError>), 0.1);
        LookAhead::new(checked)
    };
    let mut group = criterion.benchmark_group("plan");
    group.throughput(Throughput::Elements(LINES.into()));
    group.bench_function("elements looked ahead", |bencher| {
        bencher.iter_batched(
            || elements.clone(),
            |elements| plan(elements).count(),
            BatchSize::LargeInput,
        );
    });
    let count = Interpolator::new(plan(elements.clone()), DEFAULT_CYCLE_NS).count();
    group.throughput(Throughput::Elements(count as u64));
    group.bench_function("set-points", |bencher| {
        bencher.iter_batched(
            || elements.clone(),
            |elements| Interpolator::new(plan(elements), DEFAULT_CYCLE_NS).count(),
            BatchSize::LargeInput,
        );
    });
    group.finish();
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

criterion_group!(stages, decode_stage, plan_stage, transform_stage, physics_stage);
criterion_main!(stages);
