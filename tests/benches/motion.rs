//! Benchmark of the motion pipeline, from program text to set-points: decode, prepare and plan, sample; and LinuxCNC's
//! interpreter, if it is installed.
//!
//! Throughput counts lines or set-points, on one core. Machines are noisy: compare within one run. Numbers are printed,
//! nothing fails on them.

#![allow(
    clippy::expect_used,
    missing_docs,
    unreachable_pub,
    reason = "a benchmark that cannot be set up has failed"
)]

mod contour;
mod peer;
mod pipeline;

use contour::{Contour, Dialect, din66025_options, rs274_options};
use criterion::measurement::WallTime;
use criterion::{
    BatchSize, BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main,
};
use pipeline::{Failure, count, elements, plan, prepare, sample};
use std::hint::black_box;
use std::io::Read;
use twin_gcode::{din66025, rs274};
use twin_path::PathElement;

/// Lines of the generated program.
const LINES: u32 = 200_000;

/// An ordinary program of lines and arcs, a minute long.
const PLATE: &str = include_str!("../../examples/plate.cnc");

/// The generated program.
fn text(dialect: Dialect) -> String {
    let mut text = String::new();
    Contour::new(dialect, LINES).read_to_string(&mut text).expect("made in memory");
    text
}

fn din66025(text: &str) -> impl Iterator<Item = Result<PathElement, Failure>> {
    elements(din66025::Decoder::new(text.as_bytes(), din66025_options()))
}

fn rs274(text: &str) -> impl Iterator<Item = Result<PathElement, Failure>> {
    elements(rs274::Decoder::new(text.as_bytes(), rs274_options()))
}

/// A group that counts lines of the generated program.
fn lines<'a>(criterion: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(20).throughput(Throughput::Elements(LINES.into()));
    group
}

fn decode_stage(criterion: &mut Criterion) {
    let texts = [text(Dialect::Din66025), text(Dialect::Rs274)];
    let [din, rs] = &texts;
    let mut group = lines(criterion, "decode");
    group.bench_function("DIN 66025", |bencher| bencher.iter(|| count(din66025(black_box(din)))));
    group.bench_function("RS274", |bencher| bencher.iter(|| count(rs274(black_box(rs)))));
    group.finish();
    let mut group = lines(criterion, "decode, prepare and plan");
    group.bench_function("DIN 66025", |bencher| {
        bencher.iter(|| plan(prepare(din66025(black_box(din)))));
    });
    group.bench_function("RS274", |bencher| {
        bencher.iter(|| plan(prepare(rs274(black_box(rs)))));
    });
    group.finish();
}

fn plan_stage(criterion: &mut Criterion) {
    let decoded = decoded(&text(Dialect::Din66025));
    let mut group = lines(criterion, "prepare and plan");
    group.bench_function("elements", |bencher| {
        bencher.iter_batched(
            || decoded.clone(),
            |decoded| plan(prepare(decoded.into_iter().map(Ok))),
            BatchSize::LargeInput,
        );
    });
    group.finish();
}

fn decoded(text: &str) -> Vec<PathElement> {
    din66025(text).collect::<Result<_, _>>().expect("a program without errors")
}

fn sample_stage(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sample");
    for (name, text) in [("lines and arcs", PLATE), ("short lines", &text(Dialect::Din66025))] {
        let path: Vec<_> = prepare(decoded(text).into_iter().map(Ok))
            .collect::<Result<_, _>>()
            .expect("a path without errors");
        let setpoints = sample(path.clone().into_iter().map(Ok));
        group.throughput(Throughput::Elements(setpoints as u64));
        group.bench_function(name, |bencher| {
            bencher.iter_batched(
                || path.clone(),
                |path| sample(path.into_iter().map(Ok)),
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

criterion_group!(motion, decode_stage, plan_stage, sample_stage, peer::compare);
criterion_main!(motion);
