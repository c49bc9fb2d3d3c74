//! Paths in 3D: the programmed one, and those travelled.

use nalgebra::{Point3, distance};
use rerun::{LineStrips3D, Points3D, Radius, RecordingStream};

use super::At;
use crate::error::VizError;
use crate::frame::{MoveKind, PathStrip};
use crate::palette;
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

/// Logs programmed moves, cuts and rapids apart, as the `piece`-th of the path.
pub(super) fn log_programmed(
    stream: &RecordingStream,
    piece: usize,
    strips: &[PathStrip],
) -> Result<(), VizError> {
    let kinds = [
        (MoveKind::Cut, "cuts", palette::cut(), CUT_WIDTH),
        (MoveKind::Rapid, "rapids", palette::rapid(), RAPID_WIDTH),
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
pub(super) fn log_marker(
    stream: &RecordingStream,
    entity: &str,
    color: rerun::Color,
) -> Result<(), VizError> {
    let dot = Points3D::new([[0.0_f32; 3]])
        .with_colors([color])
        .with_radii([Radius::new_ui_points(MARKER_RADIUS)]);
    stream.log_static(format!("{entity}/dot"), &dot)?;
    Ok(())
}

/// The path travelled by a tool: pieces, each sent once, and the newest end, which is replaced as the tool moves.
///
/// It does not exist in the recording until the tool has a position.
#[derive(Debug)]
pub(super) struct Trail {
    color: rerun::Color,
    has_looks: bool,
    pieces: String,
    newest: String,
    piece: Vec<Point3<f64>>,
    begun_ns: i64,
    last: Option<At>,
}

impl Trail {
    /// The trail of a tool in its colour.
    pub(super) fn new(name: &str, color: rerun::Color) -> Self {
        let (pieces, newest) = (format!("trail/{name}"), format!("trail/newest/{name}"));
        Self { color, has_looks: false, pieces, newest, piece: Vec::new(), begun_ns: 0, last: None }
    }

    /// Adds where the tool is now.
    pub(super) fn add(
        &mut self,
        stream: &RecordingStream,
        at: At,
        tool: &Point3<f64>,
    ) -> Result<(), VizError> {
        let is_due =
            self.last.is_none_or(|last| at.time_ns.saturating_sub(last.time_ns) >= SAMPLE_NS);
        let has_moved = self.piece.last().is_none_or(|last| distance(last, tool) > STILL);
        if !is_due || !has_moved {
            return Ok(());
        }
        if self.piece.len() <= 1 {
            self.begun_ns = at.time_ns;
        }
        self.piece.push(*tool);
        self.last = Some(at);
        if at.time_ns.saturating_sub(self.begun_ns) >= PIECE_NS {
            self.flush(stream)
        } else {
            Ok(())
        }
    }

    /// Shows what has not been sent yet, up to where the tool is now, at the stream's time.
    pub(super) fn log_newest(
        &mut self,
        stream: &RecordingStream,
        tool: &Point3<f64>,
    ) -> Result<(), VizError> {
        if !self.has_looks {
            self.has_looks = true;
            let looks = LineStrips3D::update_fields()
                .with_colors([self.color])
                .with_radii([Radius::new_ui_points(TRAIL_WIDTH)]);
            stream.log_static(self.pieces.as_str(), &looks)?;
            stream.log_static(self.newest.as_str(), &looks)?;
        }
        let points: Vec<[f32; 3]> = self.piece.iter().chain([tool]).map(point_mm).collect();
        stream.log(self.newest.as_str(), &LineStrips3D::update_fields().with_strips([points]))?;
        Ok(())
    }

    /// Sends the piece, at the stream's time; the next begins where it ends.
    pub(super) fn flush(&mut self, stream: &RecordingStream) -> Result<(), VizError> {
        if let [_, .., end] = self.piece.as_slice() {
            let end = *end;
            let points: Vec<[f32; 3]> = self.piece.iter().map(point_mm).collect();
            stream
                .log(self.pieces.as_str(), &LineStrips3D::update_fields().with_strips([points]))?;
            self.piece.clear();
            self.piece.push(end);
        }
        Ok(())
    }
}
