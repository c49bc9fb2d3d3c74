//! Largest feed of every line that the axes allow at constant velocity.

use super::plan::Profile;
use super::{Binding, Quantity};
use crate::finding::{Finding, Rule, Severity};
use twin_gcode::refeed::LineLimit;
use twin_machine::Machine;
use twin_number::significant;
use twin_path::Place;
use twin_physics::TorqueAlongPath;
use twin_planner::time_optimal::{AxisLimits, AxisPath, Followed, Rates};

/// Feeds that differ by no more than this part of them are the same.
const SAME: f64 = 1e-9;

/// A line, and the largest feed with which all of it could be travelled at constant velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LineFeed {
    place: Place,
    rapid: bool,
    /// m/s.
    programmed: f64,
    /// m/s.
    feed: f64,
    /// What allows no more.
    binding: Option<Binding>,
}

impl LineFeed {
    /// Adds another piece of it.
    fn include(&mut self, piece: &Self) {
        self.programmed = self.programmed.max(piece.programmed);
        if piece.feed < self.feed {
            (self.feed, self.binding) = (piece.feed, piece.binding);
        }
    }

    pub(super) fn limit(&self) -> LineLimit {
        LineLimit { line: self.place.line, rapid: self.rapid, feed: self.feed }
    }

    /// Finding if the programmed feed cannot be held.
    pub(super) fn reduced(&self, machine: &Machine) -> Option<Finding> {
        let binding = self.binding.filter(|_| self.feed < self.programmed * (1.0 - SAME))?;
        let (programmed, feed) = (self.programmed * 1e3, self.feed * 1e3);
        let what = if self.rapid { "velocity of this rapid" } else { "programmed feed" };
        let message = format!(
            "the {what} of {} mm/s cannot be held: {} allows {} mm/s somewhere in this line",
            significant(programmed, 6),
            binding.words(&machine.axes),
            significant(feed, 6),
        );
        let finding = Finding::error(Rule::FeedReduced, self.place, message);
        let axis = binding.axis(&machine.axes).map(|axis| axis.name.clone());
        Some(Finding {
            severity: Severity::Note,
            largest_feed_mm_per_s: axis.as_ref().map(|_| feed),
            axis,
            ..finding.with_value(feed, programmed, "mm/s")
        })
    }
}

impl Profile<'_> {
    /// Keeps the feed with which the line could go here at constant velocity. Blends are left out: a controller that has
    /// none has corners there, which no feed makes smooth.
    pub(super) fn include(
        &mut self,
        rates: &Rates,
        torque: Option<&TorqueAlongPath>,
        followed: &Followed,
    ) {
        let Followed { element, progress, .. } = followed;
        if !element.element().kind.is_motion() || element.is_turn() {
            return;
        }
        let s = progress.position;
        let head = element.head().map_or(0.0, |blend| blend.half_width());
        let tail = element.length() - element.tail().map_or(0.0, |blend| blend.half_width());
        let mut least = (element.feed(), None);
        let mut allow = |feed: f64, binding: Binding| {
            if feed < least.0 {
                least = (feed, Some(binding));
            }
        };
        if s >= head && s <= tail {
            for (axis, feeds) in largest_feeds(self.axes.limits(), rates).enumerate() {
                for (feed, quantity) in feeds {
                    allow(feed, self.of_axis(axis, quantity));
                }
            }
            if let Some(torque) = torque {
                let (speed, axis) = self.axes.largest_speed(torque);
                allow(speed, Binding::Axis { axis, quantity: Quantity::Effort });
            }
        }
        allow(self.speed_on_curve(element, s), Binding::Centripetal);
        let (feed, binding) = least;
        let (place, rapid) = (element.place(), element.rapid());
        let piece = LineFeed { place, rapid, programmed: element.feed(), feed, binding };
        match &mut self.line {
            Some(held) if held.place.key() == place.key() && held.rapid == rapid => {
                held.include(&piece);
            }
            held => {
                let whole = held.replace(piece);
                self.leave_line(whole);
            }
        }
    }

    /// A line is over.
    pub(super) fn leave_line(&mut self, line: Option<LineFeed>) {
        let Some(line) = line else { return };
        if !self.tells_feeds {
            self.lines.push(line.limit());
        } else if let Some(finding) = line.reduced(self.machine) {
            self.watch.tell(finding);
        }
    }
}

/// The largest constant velocities along the path within the limits of each axis, m/s.
fn largest_feeds<'a>(
    limits: &'a [AxisLimits],
    rates: &'a Rates,
) -> impl Iterator<Item = [(f64, Quantity); 3]> + 'a {
    let Rates { first, second, third } = rates;
    let axes = first.iter().zip(second.iter()).zip(third.iter()).zip(limits);
    axes.map(|(((d1, d2), d3), limits)| {
        let jerk = limits.jerk.unwrap_or(f64::INFINITY);
        [
            (limits.velocity / d1.abs(), Quantity::Velocity),
            ((limits.acceleration_at(*d1, *d2) / d2.abs()).sqrt(), Quantity::Acceleration),
            ((jerk / d3.abs()).cbrt(), Quantity::Jerk),
        ]
    })
}
