//! Tool tracks: marker, trail and error of the set-point, the twin and the drives.

use nalgebra::Point3;

use super::At;
use super::due::Due;
use super::series::Series;
use super::trail::{self, Trail};
use crate::error::Result;
use crate::recorder::Recorder;
use crate::units::point_mm;

/// Marker, trail and error of a tool. None of them exists in the recording until the tool has a position.
#[derive(Debug)]
pub(super) struct ToolTrack {
    entity: String,
    color: rerun::Color,
    has_marker: bool,
    pose_due: Due,
    trail: Trail,
    /// Where the tool was last, m.
    tool: Option<Point3<f64>>,
    /// Distance to the set-point; the set-point itself has none.
    error: Option<Series>,
}

impl ToolTrack {
    /// A tool, its colour, and the plot of its error.
    pub(super) fn new(name: &str, color: rerun::Color, error: Option<Series>) -> Self {
        Self {
            entity: format!("tool/{name}"),
            color,
            has_marker: false,
            pose_due: Due::every(super::POSE_INTERVAL_NS),
            trail: Trail::new(name, color),
            tool: None,
            error,
        }
    }

    /// Adds the tool's position and its distance from the set-point, m. The stream must be at that time.
    pub(super) fn add(
        &mut self,
        stream: &mut Recorder,
        at: At,
        tool: &Point3<f64>,
        error: f64,
    ) -> Result<()> {
        self.tool = Some(*tool);
        self.trail.add(stream, at, tool)?;
        if let Some(series) = &mut self.error {
            series.add_length(at, error);
        }
        if self.pose_due.take(at.time_ns) {
            self.log_marker(stream, tool)?;
        }
        Ok(())
    }

    /// The end of the trail that is not yet in a piece, up to where the tool was last, mm.
    pub(super) fn newest(&self) -> Option<Vec<[f32; 3]>> {
        let tool = self.tool.as_ref()?;
        Some(self.trail.piece().iter().chain([tool]).map(point_mm).collect())
    }

    /// Sends what the plot holds back.
    pub(super) fn flush_error(&mut self, stream: &mut Recorder) -> Result<()> {
        self.error.as_mut().map_or(Ok(()), |error| error.flush(stream))
    }

    /// Sends the end of the trail.
    pub(super) fn flush_trail(&mut self, stream: &mut Recorder) -> Result<()> {
        self.trail.flush(stream)
    }

    /// The close-up looks from the frame of the set-point, so markers are at the origin of their frames.
    fn log_marker(&mut self, stream: &mut Recorder, tool: &Point3<f64>) -> Result<()> {
        if !self.has_marker {
            self.has_marker = true;
            trail::log_dot(stream, &self.entity, self.color)?;
        }
        let position = rerun::Transform3D::update_fields().with_translation(point_mm(tool));
        stream.log(self.entity.as_str(), &position)?;
        Ok(())
    }
}
