//! Paths in 3D: the programmed path, and the travelled trails.

use nalgebra::{Point3, distance};
use rerun::{LineStrips3D, Points3D, Radius};

use super::At;
use crate::error::Result;
use crate::frame::{MoveKind, PathStrip};
use crate::palette;
use crate::recorder::Recorder;
use crate::units::point_mm;

/// A corner of a trail at most every 4 ms: an arc of 10 mm radius at 100 mm/s is then drawn to 2 µm.
const SAMPLE_NS: i64 = 4_000_000;
/// A piece of a trail goes out when it spans this much of the program: few pieces are quicker to draw.
const PIECE_NS: i64 = 200_000_000;
/// A tool that has moved less than this has not moved, m.
const STILL: f64 = 1e-7;
/// Half the width of trails, points.
const TRAIL_WIDTH: f32 = 1.25;
/// Half the width of the programmed path, points.
const CUT_WIDTH: f32 = 0.75;
/// Half the width of rapids, points.
const RAPID_WIDTH: f32 = 0.5;
/// Radius of the markers of the tools, points.
const MARKER_RADIUS: f32 = 4.0;

/// Logs programmed moves, cuts, rapids and probing moves apart, and what preparation has made of them, as the `piece`-th of the path.
pub(super) fn log_programmed(
    stream: &mut Recorder,
    piece: usize,
    strips: &[PathStrip],
) -> Result<()> {
    let kinds = [
        (MoveKind::Cut, "cuts", palette::cut(), CUT_WIDTH),
        (MoveKind::Rapid, "rapids", palette::rapid(), RAPID_WIDTH),
        (MoveKind::Probe, "probing", palette::probing(), CUT_WIDTH),
        (MoveKind::Prepared, "prepared", palette::prepared(), CUT_WIDTH),
    ];
    for (kind, folder, color, width) in kinds {
        let lines: Vec<Vec<[f32; 3]>> = strips
            .iter()
            .filter(|strip| strip.kind == kind)
            .map(|strip| strip.points.iter().map(point_mm).collect())
            .collect();
        if !lines.is_empty() {
            let lines = LineStrips3D::new(lines)
                .with_colors([color])
                .with_radii([Radius::new_ui_points(width)]);
            stream.log_static(format!("program/{folder}/{piece}"), &lines)?;
        }
    }
    Ok(())
}

/// Logs the marker of a tool: a dot at the origin of its frame.
pub(super) fn log_dot(stream: &mut Recorder, entity: &str, color: rerun::Color) -> Result<()> {
    let dot = Points3D::new([[0.0_f32; 3]])
        .with_colors([color])
        .with_radii([Radius::new_ui_points(MARKER_RADIUS)]);
    stream.log_static(format!("{entity}/dot"), &dot)?;
    Ok(())
}

/// Logs the ends of the trails that are not yet in a piece, at the stream's time: set-point, twin and, if there are
/// any, drives.
pub(super) fn log_newest(
    stream: &mut Recorder,
    ends: impl IntoIterator<Item = Vec<[f32; 3]>>,
) -> Result<()> {
    let ends = LineStrips3D::new(ends)
        .with_colors([palette::setpoint(), palette::twin(), palette::drives()])
        .with_radii([Radius::new_ui_points(TRAIL_WIDTH)]);
    stream.log("trail/newest", &ends)?;
    Ok(())
}

/// The path travelled by a tool, in pieces, each sent once.
#[derive(Debug)]
pub(super) struct Trail {
    entity: String,
    color: rerun::Color,
    has_looks: bool,
    piece: Vec<Point3<f64>>,
    begun_ns: i64,
    last_ns: Option<i64>,
}

impl Trail {
    /// The trail of a tool in its colour.
    pub(super) fn new(name: &str, color: rerun::Color) -> Self {
        let entity = format!("trail/{name}");
        Self { entity, color, has_looks: false, piece: Vec::new(), begun_ns: 0, last_ns: None }
    }

    /// The piece that is not sent yet; it begins at the end of the last one.
    pub(super) fn piece(&self) -> &[Point3<f64>] {
        &self.piece
    }

    /// Adds where the tool is now.
    pub(super) fn add(&mut self, stream: &mut Recorder, at: At, tool: &Point3<f64>) -> Result<()> {
        let is_due = self.last_ns.is_none_or(|last| at.time_ns.saturating_sub(last) >= SAMPLE_NS);
        let has_moved = self.piece.last().is_none_or(|last| distance(last, tool) > STILL);
        if !is_due || !has_moved {
            return Ok(());
        }
        if self.piece.len() <= 1 {
            self.begun_ns = at.time_ns;
        }
        self.piece.push(*tool);
        self.last_ns = Some(at.time_ns);
        if at.time_ns.saturating_sub(self.begun_ns) >= PIECE_NS {
            self.flush(stream)
        } else {
            Ok(())
        }
    }

    /// Sends the piece, at the stream's time; the next begins where it ends.
    pub(super) fn flush(&mut self, stream: &mut Recorder) -> Result<()> {
        if let [_, .., end] = self.piece.as_slice() {
            let end = *end;
            let points: Vec<[f32; 3]> = self.piece.iter().map(point_mm).collect();
            if !self.has_looks {
                self.has_looks = true;
                let looks = LineStrips3D::update_fields()
                    .with_colors([self.color])
                    .with_radii([Radius::new_ui_points(TRAIL_WIDTH)]);
                stream.log_static(self.entity.as_str(), &looks)?;
            }
            let piece = LineStrips3D::update_fields().with_strips([points]);
            stream.log(self.entity.as_str(), &piece)?;
            self.piece.clear();
            self.piece.push(end);
        }
        Ok(())
    }
}
