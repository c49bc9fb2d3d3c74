//! Listing: the first lines of a program and of a queue as text (`SMC_ShowCNCREF`, `SMC_ShowQueue`, manual 7).

use nalgebra::Point3;
use std::fmt;
use std::io::{self, BufRead, Read};
use twin_path::Place;
use twin_path::{ElementKind, PathElement, Shape};

/// Lines or objects that the manual's blocks show.
pub const SHOWN: usize = 10;

/// Longer lines are cut off, bytes.
const MAX_LINE_BYTES: u64 = 1 << 10;

/// The first `count` lines of a program as they are (`SMC_ShowCNCREF` shows [`SHOWN`]). Very long ones are cut off.
///
/// # Errors
/// What the reader says.
pub fn first_lines(mut reader: impl BufRead, count: usize) -> io::Result<Vec<String>> {
    let mut lines = Vec::new();
    while lines.len() < count {
        let mut line = Vec::new();
        if reader.by_ref().take(MAX_LINE_BYTES).read_until(b'\n', &mut line)? == 0 {
            break;
        }
        if line.last() != Some(&b'\n') {
            reader.skip_until(b'\n')?;
        }
        lines.push(String::from_utf8_lossy(&line).trim_end_matches(['\r', '\n']).to_owned());
    }
    Ok(lines)
}

/// Kind of an object: `SMC_GEOINFO.iMoveType` (manual 6.5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MoveType {
    /// Line.
    Lin,
    /// Arc, clockwise.
    Clw,
    /// Arc, counter-clockwise.
    Cclw,
    /// Cubic.
    Spline,
    /// Ellipse, clockwise.
    EllClw,
    /// Ellipse, counter-clockwise.
    EllCclw,
    /// Positioning.
    LinPos,
    /// The position is set (G92).
    InitPos,
    /// M function.
    MCommand,
    /// Dwell: not one of the manual's.
    Dwell,
    /// Probing move: not one of the manual's.
    Probe,
}

impl MoveType {
    /// Kind of `element`.
    pub fn of(element: &PathElement) -> Self {
        match (element.kind, &element.shape) {
            (ElementKind::Rapid, _) => Self::LinPos,
            (ElementKind::Jump, _) => Self::InitPos,
            (ElementKind::MFunction { .. }, _) => Self::MCommand,
            (ElementKind::Dwell { .. }, _) => Self::Dwell,
            (ElementKind::Probe { .. }, _) => Self::Probe,
            (ElementKind::Cut, Shape::Line { .. }) => Self::Lin,
            (ElementKind::Cut, Shape::Arc(arc)) if arc.sweep() < 0.0 => Self::Clw,
            (ElementKind::Cut, Shape::Arc(_)) => Self::Cclw,
            (ElementKind::Cut, Shape::Ellipse(ellipse)) if ellipse.sweep() < 0.0 => Self::EllClw,
            (ElementKind::Cut, Shape::Ellipse(_)) => Self::EllCclw,
            (ElementKind::Cut, Shape::Cubic(_)) => Self::Spline,
        }
    }

    /// The manual's number, none for dwells and probing moves; and the name in lists.
    const fn number_and_name(self) -> (Option<u8>, &'static str) {
        match self {
            Self::Lin => (Some(1), "LIN"),
            Self::Clw => (Some(2), "CLW"),
            Self::Cclw => (Some(3), "CCLW"),
            Self::Spline => (Some(5), "SPLINE"),
            Self::EllClw => (Some(8), "ELLCLW"),
            Self::EllCclw => (Some(9), "ELLCCLW"),
            Self::LinPos => (Some(100), "LINPOS"),
            Self::InitPos => (Some(110), "INITPOS"),
            Self::MCommand => (Some(120), "MCOMMAND"),
            Self::Dwell => (None, "DWELL"),
            Self::Probe => (None, "PROBE"),
        }
    }

    /// The manual's number; it has none for dwells and probing moves.
    pub const fn number(self) -> Option<u8> {
        self.number_and_name().0
    }
}

impl fmt::Display for MoveType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.number_and_name().1)
    }
}

/// One object of a queue as `SMC_ShowQueue` shows it. [`fmt::Display`] makes a line of text of it that fits below
/// [`QUEUE_HEADING`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QueueRow {
    /// Number of the object, from 0.
    pub number: u64,
    /// Its block.
    pub place: Place,
    /// Its kind.
    pub move_type: MoveType,
    /// Start, m.
    pub start: Point3<f64>,
    /// End, m.
    pub end: Point3<f64>,
    /// Velocity (`dVel`), m/s.
    pub velocity: f64,
    /// Velocity at its end (`dVelEnd`), m/s.
    pub end_velocity: f64,
}

/// Head of the columns of a [`QueueRow`], in mm and mm/s.
pub const QUEUE_HEADING: &str = "number  line  type                            start (mm)                             end (mm)      dVel   dVelEnd (mm/s)";

impl QueueRow {
    /// Object `number` of a queue.
    pub fn new(number: u64, element: &PathElement) -> Self {
        Self {
            number,
            place: element.place,
            move_type: MoveType::of(element),
            start: element.start(),
            end: element.end(),
            velocity: element.feed,
            end_velocity: element.end_velocity,
        }
    }
}

impl fmt::Display for QueueRow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:>6} {:>5}  {:<8}", self.number, self.place.line, self.move_type)?;
        for point in [self.start, self.end] {
            for metres in point.iter() {
                write!(f, " {:>11.3}", metres * 1e3)?;
            }
            f.write_str(" ")?;
        }
        write!(f, "{:>8.2}  ", self.velocity * 1e3)?;
        if self.end_velocity.is_finite() {
            write!(f, "{:>8.2}", self.end_velocity * 1e3)
        } else {
            // Not known before the velocities are checked.
            write!(f, "{:>8}", "–")
        }
    }
}
