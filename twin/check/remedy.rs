//! Remedies where no lower feed keeps an axis within its limits: another elbow, the part moved, another plan. The first two are
//! checked on their path element before they are advised.

use super::pieces::{EXACT, Open, PieceCheck, Wrong};
use crate::limit::{MachinePath, Trial};
use crate::messages::move_part;
use nalgebra::Vector3;
use twin_kinematics::{Kinematics, Pose};
use twin_planner::extremes::Floor;

/// Places of an element among which the one nearest to the edge of the reach is looked for.
const PLACES: u32 = 64;
/// Distance over which the way from the edge is found, m.
const SLIGHTLY: f64 = 1e-6;
/// Moves of the part that are tried, and how exact the answer is, m.
const MOVES: [f64; 9] = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5];
const LEAST_MOVE: f64 = 1e-5;

impl PieceCheck<'_> {
    /// Remedies for a value that no lower feed cures.
    pub(super) fn remedy(&self, open: &Open, wrong: &Wrong, has_e: bool) -> String {
        let mut ways = Vec::new();
        let other = match self.machine.dimensions.get("elbow").and_then(|elbow| elbow.as_str()) {
            Some("high") => "low",
            _ => "high",
        };
        if self.machine.kind.starts_with("scara") && self.cures(open, wrong.axis, Trial::Mirrored) {
            ways.push(format!("use the other elbow (`elbow = \"{other}\"` in [kinematics])"));
        }
        if let Some(by) = self.move_inwards(open, wrong.axis) {
            ways.push(move_part(&by));
        }
        if let Some(lower) = self.lower_rate(open, wrong).filter(|_| has_e) {
            ways.push(format!("lower E to {lower}"));
        }
        let programmed = self.plans_as_programmed();
        let found = self.unlimited(wrong.axis).and_then(|floor| {
            self.extremes(&self.path, open, (wrong.axis, floor), [open.fastest, 1.0])
        });
        let steps = found.is_none_or(|found| found.step.value > self.step_limit(wrong.axis));
        if programmed && !steps {
            ways.push("plan within the limits of the axes (--limits axes)".to_owned());
        }
        if ways.is_empty() {
            ways.push("keep the path away from here".to_owned());
        }
        format!("no lower feed helps here: {}", ways.join(", or "))
    }

    /// The acceleration of the element, mm/s², with which an axis keeps its limits along it, if one is known.
    fn lower_rate(&self, open: &Open, wrong: &Wrong) -> Option<f64> {
        let (value, limit) = wrong.finding.value.zip(wrong.finding.limit)?;
        let largest = open.element.acceleration().max(open.element.deceleration()) * 1e3;
        // Rounded down to three digits.
        let lower = largest * limit / value;
        let digit = 10.0_f64.powf(lower.log10().floor() - 2.0);
        let lower = (lower * (1.0 + 1e-9) / digit).floor() * digit;
        (lower > 0.0 && self.keeps(&self.path, open, wrong.axis, lower / largest)).then_some(lower)
    }

    /// Move of the part away from the edge of the reach, m, machine frame, with which an axis keeps its limits along the element
    /// at its feed.
    fn move_inwards(&self, open: &Open, axis: usize) -> Option<Vector3<f64>> {
        let margin = |position: Vector3<f64>, direction: f64| {
            let pose = Pose { position: position.into(), direction };
            self.machine.kinematics.margins(&pose).map_or(f64::NAN, |margins| margins.boundary)
        };
        let places = (0..=PLACES).map(|part| {
            let s = open.element.length() * f64::from(part) / f64::from(PLACES);
            let Pose { position, direction } = self.path.pose(&open.element, s);
            (margin(position.coords, direction), position.coords, direction)
        });
        let (least, place, direction) = places.min_by(|one, other| one.0.total_cmp(&other.0))?;
        let slope = |index| margin(place + Vector3::ith(index, SLIGHTLY), direction) - least;
        let inwards = Vector3::new(slope(0), slope(1), slope(2)).try_normalize(0.0)?;
        let cures = |way: &f64| self.cures(open, axis, Trial::Moved(inwards * *way));
        let mut enough = MOVES.into_iter().find(cures)?;
        let mut less = 0.0;
        while enough - less > LEAST_MOVE {
            let middle = enough.midpoint(less);
            if cures(&middle) { enough = middle } else { less = middle }
        }
        Some(inwards * enough)
    }

    /// True if an axis keeps its limits along the element, with its feed, under a trial, and no other axis loses them by it.
    fn cures(&self, open: &Open, axis: usize, trial: Trial) -> bool {
        let path = MachinePath::without_motors(self.machine).under(trial);
        let mut others = (0..self.machine.axes.len()).filter(|other| *other != axis);
        let keeps = |path: &MachinePath<'_>, axis| self.keeps(path, open, axis, 1.0);
        keeps(&path, axis) && others.all(|other| keeps(&path, other) || !keeps(&self.path, other))
    }

    /// True if an axis keeps its limits along the element with its feed and a part of its accelerations.
    fn keeps(&self, path: &MachinePath<'_>, open: &Open, axis: usize, part: f64) -> bool {
        let Some((of, floor)) = self.machine.axes.get(axis).zip(self.unlimited(axis)) else {
            return false;
        };
        let floor = Floor {
            position: of.position_limits,
            acceleration: of.max_acceleration,
            deceleration: of.own_deceleration(),
            ..floor
        };
        let found = self.extremes(path, open, (axis, floor), [open.fastest, part]);
        found.is_some_and(|found| {
            found.position.is_none()
                && found.velocity.value <= EXACT * floor.velocity
                && found.acceleration.value <= EXACT * floor.acceleration
                && floor.deceleration.is_none_or(|most| found.deceleration.value <= EXACT * most)
                && found.step.value <= self.step_limit(axis)
        })
    }
}
