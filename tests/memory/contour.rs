//! Generated program: short lines on a gentle curve, as CAM systems write them, of any length.

use std::fmt::Write;
use std::io::{self, Read};
use twin_gcode::{din66025, rs274};

/// The two dialects. The lines between beginning and end are the same in both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// SoftMotion's.
    Din66025,
    /// LinuxCNC's.
    Rs274,
}

/// The program, made as it is read: it is never held as a whole. Its lines are 0.4 mm long.
#[derive(Debug)]
pub struct Contour {
    dialect: Dialect,
    lines: u32,
    next: u32,
    /// The latest line, read up to `at`.
    text: String,
    at: usize,
}

/// Where the contour begins, m.
const START: [f64; 3] = [0.3, 0.0, 0.02];

/// Along the contour, m/s².
const ACCELERATION: f64 = 0.8;

impl Contour {
    /// With `lines` lines of G1.
    pub fn new(dialect: Dialect, lines: u32) -> Self {
        let text = match dialect {
            Dialect::Din66025 => "% contour\nN0 G92 X300 Y0 Z20 F60 E800 E-800\n",
            Dialect::Rs274 => "G21 G90 F3600\n",
        };
        Self { dialect, lines, next: 1, text: text.to_owned(), at: 0 }
    }

    /// Makes the next line; false if there is none.
    fn advance(&mut self) -> bool {
        self.text.clear();
        self.at = 0;
        let number = self.next;
        if number <= self.lines {
            self.next += 1;
            let turn = f64::from(number) * 0.01;
            let (x, y) = (300.0 + 40.0 * turn.sin(), 40.0 * turn.cos() - 40.0);
            return writeln!(self.text, "N{number} G1 X{x:.4} Y{y:.4}").is_ok();
        }
        if number == self.lines + 1 && self.dialect == Dialect::Rs274 {
            self.next += 1;
            self.text.push_str("M2\n");
        }
        !self.text.is_empty()
    }
}

impl Read for Contour {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.at >= self.text.len() && !self.advance() {
            return Ok(0);
        }
        let mut rest = self.text.as_bytes().get(self.at..).unwrap_or_default();
        let count = rest.read(buffer)?;
        self.at += count;
        Ok(count)
    }
}

/// Decoder options for it.
pub fn din66025_options() -> din66025::DecoderOptions {
    din66025::DecoderOptions { start: START, ..din66025::DecoderOptions::default() }
}

/// Decoder options for it.
pub fn rs274_options() -> rs274::DecoderOptions {
    rs274::DecoderOptions {
        start: rs274::Position { linear: START, ..rs274::Position::default() },
        acceleration: ACCELERATION,
        deceleration: ACCELERATION,
        ..rs274::DecoderOptions::default()
    }
}
