//! Block inputs as a job file gives them.

use super::direct::Point;
use super::kind::Asks;
use super::probe::JobTrigger;
use super::read::{FAR, Known, LONGEST};
use twin_axis::{Direction, Follow, Points};
use twin_machine::section::Section;
use twin_profile::{MOST_POINTS, ProfilePoint};

/// The inputs of a block, in units of its axis and its master.
pub(super) struct Values<'s> {
    pub(super) section: &'s Section<'s>,
    pub(super) known: &'s Known,
    pub(super) master: Option<&'s Known>,
    /// Triggers of the job.
    pub(super) triggers: &'s [JobTrigger],
}

impl Values<'_> {
    pub(super) fn key(&self, name: &str) -> String {
        format!("{name}_{}", self.known.kind.unit())
    }

    /// A required way or position of the axis.
    pub(super) fn length(&self, name: &str) -> Option<f64> {
        self.section.required_number(&self.key(name), -FAR..=FAR)
    }

    fn master_key(&self, name: &str) -> Option<String> {
        Some(format!("{name}_{}", self.master?.kind.unit()))
    }

    /// A required position of the master.
    pub(super) fn of_master(&self, name: &str) -> Option<f64> {
        self.section.required_number(&self.master_key(name)?, -FAR..=FAR)
    }

    /// A distance of the master; by default 0.
    pub(super) fn distance_of_master(&self, name: &str) -> f64 {
        let distance = self.master_key(name).and_then(|key| self.section.number(&key, 0.0..=FAR));
        distance.unwrap_or(0.0)
    }

    /// Limit of the axis for an acceleration or, by its name, a deceleration.
    fn limit(&self, name: &str) -> Option<f64> {
        match name {
            "deceleration" => self.known.max_deceleration,
            _ => self.known.max_acceleration,
        }
    }

    /// An acceleration; by default the limit of the axis.
    pub(super) fn acceleration(&self, name: &str) -> Option<f64> {
        let key = format!("{}_per_s2", self.key(name));
        let said = self.section.number(&key, 1e-6..=FAR);
        if !self.section.has(&key) && self.limit(name).is_none() {
            let message = format!("a block that moves \"{}\" needs `{key}`", self.known.name);
            self.section.complain(message);
        }
        said.or(self.limit(name))
    }

    /// An acceleration that is needed in some cases only; by default the limit of the axis, and 0 without a limit.
    pub(super) fn optional_acceleration(&self, name: &str) -> f64 {
        let said = self.section.number(&format!("{}_per_s2", self.key(name)), 1e-6..=FAR);
        said.or(self.limit(name)).unwrap_or(0.0)
    }

    /// Acceleration and deceleration; the same if only the acceleration is given, the limits of the axis if neither is.
    pub(super) fn accelerations(&self) -> Option<[f64; 2]> {
        let acceleration = self.acceleration("acceleration");
        let given = self.section.has(&format!("{}_per_s2", self.key("acceleration")));
        let otherwise = if given { acceleration } else { self.known.max_deceleration };
        let key = format!("{}_per_s2", self.key("deceleration"));
        let deceleration = self.section.number(&key, 1e-6..=FAR);
        Some([acceleration?, deceleration.or(otherwise)?])
    }

    /// Velocity (by this name), acceleration and deceleration.
    pub(super) fn rates(&self, velocity: &str) -> Option<[f64; 3]> {
        let key = format!("{}_per_s", self.key(velocity));
        let velocity = self.section.required_number(&key, 0.0..=FAR);
        let [acceleration, deceleration] = self.accelerations()?;
        Some([velocity?, acceleration, deceleration])
    }

    /// A way or place, velocity, acceleration and deceleration.
    pub(super) fn moved(&self, way: &str, velocity: &str) -> Option<(f64, [f64; 3])> {
        let (way, rates) = (self.length(way), self.rates(velocity));
        Some((way?, rates?))
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

    /// Direction in which an axis goes on.
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

    /// The number of the trigger that is named.
    pub(super) fn trigger(&self) -> Option<usize> {
        let name = self.section.required_text("trigger")?;
        let found = self.triggers.iter().position(|trigger| trigger.name == name);
        if found.is_none() {
            let names: Vec<_> = self.triggers.iter().map(|one| one.name.as_str()).collect();
            let there = if names.is_empty() {
                "there are no [[triggers]]".to_owned()
            } else {
                format!("there are {}", names.join(", "))
            };
            let message = format!("there is no trigger \"{name}\"; {there}");
            self.section.complain_at("trigger", message);
        }
        found
    }

    /// The window of a probe, if there is one; `None` if one end is missing.
    #[expect(clippy::option_option, reason = "a mistake, and no window")]
    pub(super) fn window(&self) -> Option<Option<[f64; 2]>> {
        let keys = ["first_position", "last_position"].map(|name| self.key(name));
        let [first, last] = keys.each_ref().map(|key| self.section.number(key, -FAR..=FAR));
        match (first, last) {
            (Some(first), Some(last)) => Some(Some([first, last])),
            (None, None) => Some(None),
            _ => {
                let [first, last] = keys;
                self.section.complain(format!("a window has both `{first}` and `{last}`"));
                None
            }
        }
    }

    /// Set-points over time.
    pub(super) fn setpoints(&self, asks: Asks) -> Option<Vec<Point>> {
        let sections = self.section.sections("points");
        if sections.is_empty() {
            self.section.complain("set-points need `points`".to_owned());
        }
        let (place, speed) = (self.key("position"), format!("{}_per_s", self.key("velocity")));
        let count = sections.len();
        let points = (1..).zip(sections).map(|(index, point)| {
            let after = point.required_number("delta_s", 1e-6..=LONGEST);
            let position = || point.required_number(&place, -FAR..=FAR);
            let velocity = || point.required_number(&speed, -FAR..=FAR);
            let setpoint = match asks {
                Asks::Position => position().map(Follow::Position),
                Asks::Velocity => velocity().map(Follow::Velocity),
                Asks::Both => {
                    let both = (position(), velocity());
                    both.0.zip(both.1).map(|(y, v)| Follow::PositionVelocity(y, v))
                }
            };
            let Some(Follow::Velocity(last) | Follow::PositionVelocity(_, last)) = setpoint else {
                point.finish();
                return Some(Point { after: after?, setpoint: setpoint? });
            };
            if index == count && last.abs() > 0.0 {
                let message = format!("the last `{speed}` is {last}: set-points end at rest, 0");
                point.complain_at(&speed, message);
            }
            point.finish();
            Some(Point { after: after?, setpoint: setpoint? })
        });
        points.collect::<Vec<_>>().into_iter().collect()
    }
}
