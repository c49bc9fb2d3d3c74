//! Velocity and acceleration that the axes allow along a path element, for programs that leave them open.

use crate::{DirectionRule, Machine};
use std::sync::Arc;
use twin_kinematics::{
    AxisSource, AxisVector, Kinematics, MachineAxes, Pose, ToolMotion, WorkFrame,
};
use twin_path::{ElementKind, PathElement, Shape};

/// Velocity of rapids in RS274 where no axis limits it, m/s.
pub(crate) const RAPID_VELOCITY: f64 = 0.1;

/// Acceleration along the path in RS274 where no axis limits it, m/s².
pub(crate) const ACCELERATION: f64 = 1.0;

/// Distance between the points of an element that are looked at, m, and how many there are at most.
const STEP: f64 = 5e-3;
const MOST_POINTS: u32 = 32;

/// Part of an acceleration that stays for the path where a curve takes more than the rest of it.
const SPARE: f64 = 0.5;

/// Part of an element that decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Where the axes can do least: the whole element is within their limits.
    Weakest,
    /// Where they can do most, for plans that mind the axes everywhere else.
    Strongest,
}

/// Limits of the axes as limits of the path. RS274 has no word for the velocity of rapids and for accelerations.
#[derive(Clone, Debug)]
pub struct AxisPace {
    kinematics: Arc<MachineAxes>,
    frame: WorkFrame,
    direction: DirectionRule,
    limits: Vec<Limit>,
    /// Unit of the axes: radians or metres of what the program gives them.
    units: Vec<f64>,
    near: AxisVector,
}

/// Limits of an axis, SI.
#[derive(Clone, Copy, Debug)]
struct Limit {
    velocity: f64,
    acceleration: f64,
    deceleration: f64,
}

/// Derivatives of the axes by the length of the path.
struct Rates {
    first: AxisVector,
    second: AxisVector,
}

impl AxisPace {
    pub(crate) fn of(machine: &Machine) -> Self {
        let limits = machine.axis_limits().into_iter().map(|limit| Limit {
            velocity: limit.velocity.value,
            acceleration: limit.acceleration,
            deceleration: limit.deceleration,
        });
        Self {
            kinematics: Arc::clone(&machine.kinematics),
            frame: machine.frame,
            direction: machine.direction,
            limits: limits.collect(),
            units: machine.axes.iter().map(|axis| axis.to_si(1.0)).collect(),
            near: machine.middle(),
        }
    }

    /// Lowers the velocity of a rapid and the accelerations of any motion to what the axes can do in its direction.
    pub fn limit(&self, element: &mut PathElement, along: Along) {
        let length = element.length();
        let points = if element.kind.is_motion() && length > 0.0 {
            self.points(element, length)
        } else {
            Vec::new()
        };
        let choose = |values: &mut dyn Iterator<Item = f64>| match along {
            Along::Weakest => values.fold(f64::INFINITY, f64::min),
            Along::Strongest => values.fold(0.0, f64::max),
        };
        // Where no axis of the machine moves, nothing limits the path.
        let open = |value: f64, default| if value.is_finite() { value } else { default };
        if matches!(element.kind, ElementKind::Rapid) && !points.is_empty() {
            let velocity = choose(&mut points.iter().map(|rates| self.velocity(rates)));
            element.feed = element.feed.min(velocity);
        }
        element.feed = open(element.feed, RAPID_VELOCITY);
        if !points.is_empty() {
            let v2 = element.feed.powi(2);
            let [up, down] = [false, true].map(|slows| {
                choose(&mut points.iter().map(|rates| self.acceleration(rates, v2, slows)))
            });
            element.acceleration = element.acceleration.min(up);
            element.deceleration = element.deceleration.min(down);
        }
        element.acceleration = open(element.acceleration, ACCELERATION);
        element.deceleration = open(element.deceleration, ACCELERATION);
    }

    /// Derivatives at points of an element; none where the machine does not come.
    fn points(&self, element: &PathElement, length: f64) -> Vec<Rates> {
        let straight = matches!(element.shape, Shape::Line { .. });
        let Some(first) = self.rates(element, 0.0, length) else { return Vec::new() };
        // The axes of a gantry move along a line as evenly as the tool.
        if straight && first.second.iter().all(|rate| *rate == 0.0) {
            return vec![first];
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within bounds"
        )]
        let count = (length / STEP).ceil().clamp(2.0, f64::from(MOST_POINTS)) as u32;
        let rest = (1..=count).map(|index| length * f64::from(index) / f64::from(count));
        let rest = rest.filter_map(|s| self.rates(element, s, length));
        std::iter::once(first).chain(rest).collect()
    }

    fn rates(&self, element: &PathElement, s: f64, length: f64) -> Option<Rates> {
        let point = element.shape.at(s);
        let extra = element.extra().map(|extra| {
            let pairs = extra.start.iter().zip(extra.end);
            let moved: Vec<_> = pairs.map(|(start, end)| (end - start) / length).collect();
            moved
        });
        let extra = |number: u8| {
            let rates = extra.as_ref().and_then(|rates| rates.get(usize::from(number)));
            rates.copied().unwrap_or_default()
        };
        let turning = match self.direction {
            DirectionRule::Additional(number, _) => extra(number).to_radians(),
            DirectionRule::Path(..) | DirectionRule::Fixed(_) => 0.0,
        };
        let work = ToolMotion {
            pose: Pose { position: point.position, direction: self.direction.at_start() },
            velocity: point.tangent,
            acceleration: point.curvature,
            direction_velocity: turning,
            direction_acceleration: 0.0,
        };
        let motion = self.frame.motion_to_machine(&work);
        let motion = self.kinematics.inverse_motion(&motion, &self.near).ok()?;
        let (mut first, second) = (motion.velocity, motion.acceleration);
        let sources = self.kinematics.sources().iter().zip(&self.units);
        for (slot, (source, unit)) in first.iter_mut().zip(sources) {
            if let AxisSource::Additional(number) = *source {
                *slot = extra(number) * unit;
            }
        }
        Some(Rates { first, second })
    }

    /// The largest velocity of the path, m/s.
    fn velocity(&self, rates: &Rates) -> f64 {
        let axes = rates.first.iter().zip(rates.second.iter()).zip(&self.limits);
        let largest = axes.map(|((first, second), limit)| {
            let bend = (1.0 - SPARE) * limit.acceleration.min(limit.deceleration) / second.abs();
            (limit.velocity / first.abs()).min(bend.sqrt())
        });
        largest.fold(f64::INFINITY, f64::min)
    }

    /// The largest acceleration along the path at the squared velocity `v2`, m/s².
    fn acceleration(&self, rates: &Rates, v2: f64, slows: bool) -> f64 {
        let axes = rates.first.iter().zip(rates.second.iter()).zip(&self.limits);
        let largest = axes.map(|((first, second), limit)| {
            let all = if slows { limit.deceleration } else { limit.acceleration };
            (all - second.abs() * v2).max(SPARE * all) / first.abs()
        });
        largest.fold(f64::INFINITY, f64::min)
    }
}
