//! Fuzz target: programs of all commands through all kinds of path preparation and an interpolator whose inputs change.
//! Most of them decode without an error, unlike random bytes.

#![no_main]

mod path;

use libfuzzer_sys::fuzz_target;
use std::fmt::Write;
use std::num::NonZeroUsize;
use twin_gcode::din66025::{Decoder, DecoderOptions};
use twin_planner::controller::{Inputs, Override, VelocityMode};
use twin_path::PathElement;
use twin_path::prepare::{CircularLimits, Preparation, Rounding, Smoothing, ToolRadiusOptions};

/// Blocks of a program at most.
const BLOCKS: usize = 400;

fuzz_target!(|bytes: &[u8]| {
    let Some((head, blocks)) = bytes.split_first_chunk::<8>() else { return };
    let text = program(blocks);
    let decoder = Decoder::new(text.as_bytes(), DecoderOptions::default());
    let path = path::decoded(decoder, 8 * (BLOCKS + 2));
    let [stages, window, demands @ ..] = head;
    let preparation = preparation(*stages, *window, &path);
    let prepared = path::prepared(&path, &preparation);
    path::sampled(prepared, false, |cycle| demand(cycle, *demands));
});

/// A block is eight bytes: what it does, and four numbers.
fn program(blocks: &[u8]) -> String {
    let mut text = String::from("% fuzz\nN0 F100 E1000 E-1000 D5\n");
    for (number, block) in (1..).zip(blocks.chunks_exact(8).take(BLOCKS)) {
        let [command, small, numbers @ ..] = *<&[u8; 8]>::try_from(block).expect("eight");
        let mut hundredths = numbers
            .chunks_exact(2)
            .map(|pair| f64::from(i16::from_le_bytes(pair.try_into().expect("two"))) / 100.0);
        let mut next = || hundredths.next().unwrap_or_default();
        let (x, y, i) = (next(), next(), next());
        let j = f64::from(small as i8);
        let k = u32::from(small);
        let words = match command % 24 {
            0 => format!("G0 X{x} Y{y}"),
            1..=6 => format!("G1 X{x} Y{y}"),
            7 => format!("G1 X{x} Z{y}"),
            8 => format!("G2 X{x} Y{y} R{}", i.abs()),
            9 => format!("G3 X{x} Y{y} R{}", i.abs()),
            // From a point, half around: the centre fits.
            10 => format!("G91 G2 X{} Y{} I{i} J{j}", 2.0 * i, 2.0 * j).replace("G91 ", ""),
            11 => format!("G3 I{i} J{j} Z{y}"),
            12 => format!("G5 X{x} Y{y}"),
            13 => format!("G6 X{x} Y{y} I{i} J{j}"),
            14 => format!("G8 X{x} Y{y} I{i} J{j} K{k} R0.5"),
            15 => format!("G9 I{i} J{j} K{k} R0.5"),
            16 => ["G40", "G41", "G42", "G50", "G51", "G52", "G60", "G61"]
                .get(usize::from(small % 8))
                .map(ToString::to_string)
                .unwrap_or_default(),
            17 => format!("G1 D{}", i.abs() / 10.0),
            18 => format!("G1 X{x} H{} O0.5", 1 + small % 32),
            19 => format!("G1 X{x} P{y} Q{i}"),
            20 => format!(
                "G1 F{} E{} E-{}",
                1.0 + x.abs(),
                1.0 + y.abs() * 10.0,
                1.0 + i.abs() * 10.0
            ),
            21 => format!("G92 X{x} Y{y}"),
            22 => ["G90", "G91", "G98", "G99", "S3", "S-3", "S7", "S-7"]
                .get(usize::from(small % 8))
                .map(ToString::to_string)
                .unwrap_or_default(),
            _ => format!("G1 X{x} M{k}"),
        };
        writeln!(text, "N{number} {words}").expect("a string takes everything");
    }
    text
}

fn preparation(stages: u8, window: u8, path: &[PathElement]) -> Preparation {
    if stages == 0 {
        return path::by_marks(path);
    }
    let small = f64::from(window) * 1e-4;
    Preparation {
        tool_radius: (stages % 4 == 1)
            .then_some(ToolRadiusOptions { radius: small, ..ToolRadiusOptions::default() }),
        smoothing: (stages % 4 == 2).then(Smoothing::default),
        rounding: (stages % 4 == 3).then(Rounding::default),
        loops: if stages & 4 == 0 { None } else { NonZeroUsize::new(usize::from(window)) },
        circular: (stages & 8 != 0)
            .then_some(CircularLimits { acceleration: small, acceleration_jump: small }),
    }
}

/// The change of this cycle, if there is one.
fn demand(cycle: usize, demands: [u8; 6]) -> Option<Inputs> {
    let [mode, first, second, third, factor, flags] = demands;
    let mode = match mode % 4 {
        0 | 1 => VelocityMode::Trapezoid,
        2 => VelocityMode::Sigmoid,
        _ => VelocityMode::JerkLimited { jerk: f64::from(mode) },
    };
    let base = Inputs { mode, ..Inputs::default() };
    if cycle == 0 {
        return Some(base);
    }
    if cycle == usize::from(first) {
        let override_factor = Override::new(f64::from(factor) / 64.0).ok()?;
        return Some(Inputs { override_factor, ..base });
    }
    if cycle == usize::from(second) * 2 {
        return Some(Inputs {
            slow_stop: flags & 1 != 0,
            emergency_stop: flags & 2 != 0,
            single_step: flags & 4 != 0,
            wait_at_next_stop: flags & 8 != 0,
            abort: flags & 16 != 0,
            acknowledge_m: flags & 32 == 0,
            ..base
        });
    }
    (cycle == usize::from(second) * 2 + usize::from(third)).then_some(base)
}
