//! Chunked input: a program that arrives in pieces gives the same plan as one that arrives at once.

use super::machines::Machine;
use std::fmt::Write as _;
use std::io::{self, BufRead, Read};
use twin_gcode::decode::Item;
use twin_gcode::rs274::{Decoder, DecoderOptions};
use twin_path::prepare::{CheckError, CheckVelocities};
use twin_planner::blended_path::BlendOptions;
use twin_planner::planned_motion::SegmentLaw;
use twin_planner::time_optimal::{LimitOptions, Planned, Planner};

/// Largest number of bytes given at a time.
struct Pieces<'t> {
    text: &'t [u8],
    size: usize,
}

impl Read for Pieces<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.text.len().min(self.size).min(buffer.len());
        let (now, later) = self.text.split_at(count);
        buffer[..count].copy_from_slice(now);
        self.text = later;
        Ok(count)
    }
}

impl BufRead for Pieces<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        Ok(&self.text[..self.size.min(self.text.len())])
    }

    fn consume(&mut self, amount: usize) {
        self.text = &self.text[amount..];
    }
}

/// Rows of short lines, half circles between them, and now and then a pause.
fn program() -> String {
    let mut text = String::from("G21 G90 G17 G64\nG0 X280 Y-20 Z20\nF3000\n");
    for row in 0..30 {
        let (y, aside) = (-20.0 + f64::from(row), if row % 2 == 0 { 1.0 } else { -1.0 });
        let from = if row % 2 == 0 { 280.0 } else { 290.0 };
        for step in 1..=5 {
            let x = from + 2.0 * aside * f64::from(step);
            writeln!(text, "G1 X{x:.3} Y{:.3}", y + 0.02 * f64::from(step % 2)).unwrap();
        }
        let (turn, x) = if row % 2 == 0 { ("G3", from + 10.0) } else { ("G2", from - 10.0) };
        writeln!(text, "G1 Y{y:.3}\n{turn} X{x:.3} Y{:.3} I0 J0.5", y + 1.0).unwrap();
        if row % 9 == 8 {
            text.push_str("G4 P0.1\n");
        }
    }
    text
}

/// What comes next: the line, and how it is gone through.
fn planned(text: &str, size: usize, jerk: bool) -> Vec<(u32, Option<(f64, SegmentLaw)>)> {
    let reader = Pieces { text: text.as_bytes(), size };
    let options = DecoderOptions {
        rapid_velocity: 0.15,
        acceleration: 1.0,
        deceleration: 1.0,
        ..DecoderOptions::default()
    };
    let elements = Decoder::new(reader, options).filter_map(|item| match item.unwrap() {
        Item::Element(element) => Some(Ok::<_, CheckError>(element)),
        Item::Warning(_) => None,
    });
    let checked = CheckVelocities::new(elements, std::f64::consts::PI);
    let options = LimitOptions::new(BlendOptions::new(5e-5));
    let planner = Planner::new(checked, Machine::Gantry3.path(jerk), options);
    let parts = planner.map(|part| match part.unwrap() {
        Planned::Hold { .. } => unreachable!("nobody has asked for it"),
        Planned::Leg(leg) => {
            (leg.element.place().line, Some((leg.stretch.length(), leg.stretch.law())))
        }
        Planned::Pause(element) => (element.place().line, None),
    });
    parts.collect()
}

#[test]
fn pieces_make_no_difference() {
    let text = program();
    for jerk in [true, false] {
        let whole = planned(&text, usize::MAX, jerk);
        assert!(whole.len() > 500 && whole.iter().any(|(_, motion)| motion.is_none()));
        for size in [1, 7, 1000] {
            assert!(planned(&text, size, jerk) == whole, "{size} bytes at a time");
        }
    }
}
