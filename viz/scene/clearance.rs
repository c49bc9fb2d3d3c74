//! Clearance between machine and surroundings: a plot over time, and a line in 3D where it is small.

use rerun::{LineStrips3D, Points3D, Radius};

use super::At;
use super::series::Series;
use crate::error::Result;
use crate::frame::ClearanceFrame;
use crate::palette;
use crate::recorder::Recorder;
use crate::units::{mm, point_mm};

/// Nearer than this the nearest points are joined, m.
pub(super) const NEAR: f64 = 0.02;
/// Where they are joined.
const LINE: &str = "nearest/line";
/// And where they are.
const POINTS: &str = "nearest/points";
/// Half the width of the line, points.
const LINE_WIDTH: f32 = 2.0;
/// Radius of its ends, points: they are seen where the line is too short to be.
const POINT_RADIUS: f32 = 3.5;

/// The clearance in the recording.
#[derive(Debug)]
pub(super) struct ClearanceTrack {
    distance: Series,
    wanted: Series,
    /// Wanted clearance, m.
    limit: f64,
    is_joined: bool,
}

impl ClearanceTrack {
    /// A track with the wanted clearance `limit` (m); 0 if only contact is reported.
    pub(super) fn new(limit: f64) -> Self {
        let series = |name, color| Series::new(format!("clearance/{name}"), name, color);
        Self {
            distance: series("twin", palette::twin()),
            wanted: series("wanted", palette::limit()),
            limit,
            is_joined: false,
        }
    }

    /// Adds how near it is.
    pub(super) fn add(&mut self, at: At, clearance: &ClearanceFrame<'_>) {
        self.distance.add_length(at, clearance.distance);
        if self.limit > 0.0 {
            self.wanted.add_length(at, self.limit);
        }
    }

    /// Joins the nearest points, or no longer, at the stream's time.
    pub(super) fn join(
        &mut self,
        stream: &mut Recorder,
        clearance: Option<&ClearanceFrame<'_>>,
    ) -> Result<()> {
        let Some(clearance) = clearance.filter(|clearance| clearance.distance < NEAR) else {
            if std::mem::take(&mut self.is_joined) {
                stream.log(LINE, &LineStrips3D::clear_fields())?;
                stream.log(POINTS, &Points3D::clear_fields())?;
            }
            return Ok(());
        };
        self.is_joined = true;
        let ends = clearance.points.each_ref().map(point_mm);
        let color = palette::nearness(clearance.distance / NEAR);
        let [one, other] = clearance.parts;
        let words = format!("{:.2} mm, {one} to {other}", mm(clearance.distance));
        let line = LineStrips3D::new([ends])
            .with_colors([color])
            .with_radii([Radius::new_ui_points(LINE_WIDTH)])
            .with_labels([words])
            .with_show_labels(true);
        stream.log(LINE, &line)?;
        let points = Points3D::new(ends)
            .with_colors([color])
            .with_radii([Radius::new_ui_points(POINT_RADIUS)]);
        stream.log(POINTS, &points)?;
        Ok(())
    }

    /// Sends what the plot holds back.
    pub(super) fn flush(&mut self, stream: &mut Recorder) -> Result<()> {
        self.distance.flush(stream)?;
        self.wanted.flush(stream)
    }
}
