//! The inputs of blocks as a job's file says them.

use super::read::{FAR, Known, LONGEST};
use crate::machine::section::Section;
use twin_motion::axis::profile::{MOST_POINTS, ProfilePoint};
use twin_motion::axis::{Direction, Points};

/// The inputs of a block, in units of its axis and its master.
pub(super) struct Values<'s> {
    pub(super) section: &'s Section<'s>,
    pub(super) known: &'s Known,
    pub(super) master: Option<&'s Known>,
}

impl Values<'_> {
    pub(super) fn key(&self, name: &str) -> String {
        format!("{name}_{}", self.known.kind.unit())
    }

    /// A way or place of the axis that has to be said.
    pub(super) fn length(&self, name: &str) -> Option<f64> {
        self.section.required_number(&self.key(name), -FAR..=FAR)
    }

    /// A way or place of the master.
    pub(super) fn of_master(&self, name: &str) -> Option<f64> {
        let unit = self.master?.kind.unit();
        self.section.required_number(&format!("{name}_{unit}"), -FAR..=FAR)
    }

    pub(super) fn optional_of_master(
        &self,
        name: &str,
        range: std::ops::RangeInclusive<f64>,
    ) -> Option<f64> {
        let unit = self.master?.kind.unit();
        self.section.number(&format!("{name}_{unit}"), range)
    }

    /// An acceleration; that of the axis's limits, if it is not said.
    pub(super) fn acceleration(&self, name: &str) -> Option<f64> {
        let key = format!("{}_per_s2", self.key(name));
        let said = self.section.number(&key, 1e-6..=FAR);
        if !self.section.has(&key) && self.known.max_acceleration.is_none() {
            let message = format!("a block that moves \"{}\" needs `{key}`", self.known.name);
            self.section.complain(message);
        }
        said.or(self.known.max_acceleration)
    }

    /// Acceleration and deceleration; the same, if one is said.
    pub(super) fn accelerations(&self) -> Option<[f64; 2]> {
        let acceleration = self.acceleration("acceleration")?;
        let key = format!("{}_per_s2", self.key("deceleration"));
        let deceleration = self.section.number(&key, 1e-6..=FAR).unwrap_or(acceleration);
        Some([acceleration, deceleration])
    }

    /// Velocity (by this name), acceleration and deceleration.
    pub(super) fn rates(&self, velocity: &str) -> Option<[f64; 3]> {
        let key = format!("{}_per_s", self.key(velocity));
        let velocity = self.section.required_number(&key, 0.0..=FAR);
        let [acceleration, deceleration] = self.accelerations()?;
        Some([velocity?, acceleration, deceleration])
    }

    pub(super) fn direction(&self, otherwise: Direction) -> Direction {
        let words = [
            ("positive", Direction::Positive),
            ("negative", Direction::Negative),
            ("shortest", Direction::Shortest),
            ("current", Direction::Current),
            ("fastest", Direction::Fastest),
        ];
        self.section.choice("direction", &words).unwrap_or(otherwise)
    }

    /// In which direction an axis goes on.
    pub(super) fn end_direction(&self) -> Direction {
        let words = [
            ("positive", Direction::Positive),
            ("negative", Direction::Negative),
            ("current", Direction::Current),
        ];
        self.section.choice("end_direction", &words).unwrap_or(Direction::Current)
    }

    /// A speed that may be 0.
    pub(super) fn speed(&self, name: &str) -> Option<f64> {
        self.section.required_number(&format!("{}_per_s", self.key(name)), 0.0..=FAR)
    }

    /// The points of a profile, whose values are `name` with `suffix` behind the unit; with its scale and offset.
    pub(super) fn points(&self, name: &str, suffix: &str) -> Option<Points> {
        let key = format!("{}{suffix}", self.key(name));
        let sections = self.section.sections("points");
        let count = sections.len();
        if !(1..=MOST_POINTS).contains(&count) {
            let message =
                format!("a profile has 1 to {MOST_POINTS} `points`, this one has {count}");
            self.section.complain(message);
        }
        let points = sections.into_iter().map(|point| {
            let delta_time = point.required_number("delta_s", 0.0..=LONGEST);
            let value = point.required_number(&key, -FAR..=FAR);
            point.finish();
            Some(ProfilePoint { delta_time: delta_time?, value: value? })
        });
        let points = points.collect::<Vec<_>>().into_iter().collect::<Option<Vec<_>>>();
        let absolute = self.section.flag("absolute").unwrap_or(true);
        let scale = self.section.number("scale", -FAR..=FAR).unwrap_or(1.0);
        let key = format!("{}{suffix}", self.key("offset"));
        let offset = self.section.number(&key, -FAR..=FAR).unwrap_or(0.0);
        Some(Points { absolute, scale, offset, ..Points::new(points?) })
    }
}
