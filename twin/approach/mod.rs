//! Approach: planned motion of the drives from where they are to the start of a program.
//!
//! It is checked before anything moves, cycle by cycle as a program is: reach, software limits, and the clearance to the
//! obstacles of the machine file, of which the tool must not touch the stock either. By default the tool goes up along its
//! axis, across at one height and down: at the lowest height that is clear, in steps of a centimetre above the higher of both
//! ends.
//!
//! ```text
//!        ┌──────── across ───────┐
//!     up │                       │ down
//!   tool ┴                       ┴ start
//! ```

mod error;
mod follow;
mod step;
#[cfg(test)]
mod tests;

pub use error::ApproachError;
pub use follow::{FollowError, follow};
pub use step::Leg;

use crate::setpoint::AxisSetpoint;
use nalgebra::Vector3;
use step::{Line, Step};
use twin_gcode::rs274::Tool;
use twin_kinematics::{AxisMotion, AxisVector, Coordinate, Kinematics, Pose, ToolMotion};
use twin_machine::tappets::TappetBits;
use twin_machine::{ApproachOrder, Machine, SimulationError};
use twin_number::{fixed, seconds};
use twin_path::Place;
use twin_physics::{Clearance, ClearanceScan};

/// Depth to which parts may be in each other without a collision, m.
const TOUCHING: f64 = 1e-6;

/// Distance between two heights that are tried, m.
const HEIGHTS: f64 = 0.01;

/// Most heights that are tried.
const MOST_HEIGHTS: u32 = 200;

/// Effect of an axis on a coordinate that counts as none, m or rad per m or rad.
const NO_EFFECT: f64 = 1e-9;

/// Tolerance of software limits, m or rad.
const LIMIT_TOLERANCE: f64 = 1e-9;

/// A checked way from rest to rest.
#[derive(Clone, Debug)]
pub struct Approach {
    from: AxisVector,
    steps: Vec<Step>,
    /// Least clearance on the way, if the machine file has obstacles.
    nearest: Option<Clearance>,
    /// Least clearance on the way across, m; infinite if there is none.
    across: f64,
    /// Tool of a tool table in the spindle, by its number.
    tool: Option<u32>,
}

impl Approach {
    /// The way of all axes from `from` to `to` (m or rad), as the machine file wants it, with at most `factor` times the
    /// largest velocity of each axis. `tool` of a tool table is in the spindle, or else that of the machine file.
    ///
    /// # Errors
    /// [`ApproachError`] if no way is clear.
    pub fn plan(
        machine: &Machine,
        tool: Option<&Tool>,
        [from, to]: [&AxisVector; 2],
        factor: f64,
    ) -> Result<Self, ApproachError> {
        let mut planner = Planner::new(machine, tool, factor)?;
        planner.check_start(from)?;
        let straight = |from: AxisVector, to: AxisVector| Line::of_axes(Leg::Straight, from, to);
        let lines = match machine.conditions.approach.order {
            ApproachOrder::Together => vec![straight(*from, *to)],
            ApproachOrder::AxisByAxis => {
                one_by_one(Leg::Straight, *from, to, 0..machine.axes.len())
            }
            ApproachOrder::RetractFirst => match Lift::of(machine, from)? {
                Lift::None => vec![straight(*from, *to)],
                lift => return planner.retract_first(&lift, from, to),
            },
        };
        planner.check(lines, *from)
    }

    /// The way of `axes`, by their places in the machine file, to their zeros, one after the other, with `tool` in the spindle.
    ///
    /// # Errors
    /// [`ApproachError`] if it is not clear.
    pub fn homing(
        machine: &Machine,
        tool: Option<&Tool>,
        from: &AxisVector,
        axes: &[usize],
    ) -> Result<Self, ApproachError> {
        let mut planner = Planner::new(machine, tool, 1.0)?;
        planner.check_start(from)?;
        let zeros = AxisVector::zeros(from.len());
        planner.check(one_by_one(Leg::Home, *from, &zeros, axes.iter().copied()), *from)
    }

    /// True if nothing moves.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Axis positions at its start, m or rad.
    pub fn from(&self) -> &AxisVector {
        &self.from
    }

    /// Duration, s.
    pub fn duration(&self) -> f64 {
        self.steps.iter().map(Step::duration).sum()
    }

    /// Least clearance on the way; `None` if the machine file has no obstacles.
    pub fn nearest(&self) -> Option<&Clearance> {
        self.nearest.as_ref()
    }

    /// Names of the two parts that come nearest to each other, and their distance (m); `None` if the machine file has no obstacles.
    pub fn nearest_names(&self, machine: &Machine) -> Option<([String; 2], f64)> {
        let nearest = self.nearest.as_ref()?;
        let names = nearest.parts.map(|part| machine.part_name_with(part, self.tool));
        Some((names, nearest.distance))
    }

    /// What moves, step by step: `Z to 40.000 mm; tool tip at X 0.000 Y 0.000 Z 20.000 mm`.
    pub fn described<'a>(&'a self, machine: &'a Machine) -> impl Iterator<Item = String> + 'a {
        self.steps.iter().map(|step| {
            let ends = step.line.from.iter().zip(step.line.to.iter()).zip(&machine.axes);
            let moved = ends.filter(|((from, to), _)| (*to - *from).abs() > 5e-7);
            let moved = moved.map(|((_, to), axis)| {
                format!("{} to {} {}", axis.name, fixed(axis.from_si(*to), 3), axis.unit())
            });
            let moved = moved.collect::<Vec<_>>().join(", ");
            match machine.kinematics.forward(&step.line.to) {
                Ok(tip) => format!("{moved}; tool tip at {}", place((tip.position * 1e3).into())),
                Err(_) => moved,
            }
        })
    }

    /// One set-point per cycle, the first at time 0 at rest, the last at rest at the end.
    pub fn setpoints<'a>(
        &'a self,
        machine: &'a Machine,
    ) -> impl Iterator<Item = AxisSetpoint> + 'a {
        let cycles = self.steps.iter().flat_map(|step| motions(machine, step));
        let start = std::iter::once(AxisMotion::at_rest(self.from));
        // All of them have been computed once: what fails has no way.
        let motions = start.chain(cycles.map_while(Result::ok));
        (0..).zip(motions).map(|(cycle, axes)| AxisSetpoint {
            time_ns: cycle * machine.cycle_ns,
            place: Place::default(),
            axes,
            tool: ToolMotion::at_rest(Pose::at(0.0, 0.0, 0.0)),
            m_call: None,
            path_velocity: 0.0,
            feed: None,
            probing: false,
            tappets: TappetBits::default(),
            switches: 0,
        })
    }
}

/// A tool tip in words, mm.
fn place([x, y, z]: [f64; 3]) -> String {
    let [x, y, z] = [x, y, z].map(|value| fixed(value, 3));
    format!("X {x} Y {y} Z {z} mm")
}

/// Lines of `axes` to `to`, one after the other.
fn one_by_one(
    leg: Leg,
    from: AxisVector,
    to: &AxisVector,
    axes: impl Iterator<Item = usize>,
) -> Vec<Line> {
    let mut at = from;
    let lines = axes.map(|axis| {
        let before = at;
        if let (Some(slot), Some(to)) = (at.get_mut(axis), to.get(axis)) {
            *slot = *to;
        }
        Line::of_axes(leg, before, at)
    });
    lines.collect()
}

/// The axis that moves the tool along its axis and does nothing else, by its place in the machine file.
pub fn lifting_axis(machine: &Machine, at: &AxisVector) -> Option<usize> {
    match Lift::of(machine, at) {
        Ok(Lift::Axis(axis, _)) => Some(axis),
        Ok(Lift::None | Lift::Tool) | Err(_) => None,
    }
}

/// The axes in every cycle of a step behind the first, the last of them at rest.
fn motions<'a>(
    machine: &'a Machine,
    step: &'a Step,
) -> impl Iterator<Item = Result<AxisMotion, ApproachError>> + 'a {
    let cycle = seconds(machine.cycle_ns);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "minutes")]
    let cycles = (step.duration() / cycle).ceil() as u64;
    #[expect(clippy::cast_precision_loss, reason = "minutes")]
    let time = move |number: u64| number as f64 * cycle;
    (1..=cycles.max(1)).map(move |number| step.at(&machine.kinematics, time(number)))
}

/// How the tool goes along its axis.
enum Lift {
    /// It does not.
    None,
    /// By this axis alone, with this many m per m or rad.
    Axis(usize, f64),
    /// By several axes together.
    Tool,
}

impl Lift {
    fn of(machine: &Machine, at: &AxisVector) -> Result<Self, ApproachError> {
        let jacobian = machine.kinematics.jacobian(at).map_err(ApproachError::Tool)?;
        let effect = |coordinate, axis| jacobian.get(coordinate, axis);
        let acts = |coordinate, axis| effect(coordinate, axis).abs() > NO_EFFECT;
        let lifting: Vec<_> =
            (0..machine.axes.len()).filter(|axis| acts(Coordinate::Z, *axis)).collect();
        let others = [Coordinate::X, Coordinate::Y, Coordinate::Direction];
        Ok(match lifting[..] {
            [] => Self::None,
            [axis] if !others.iter().any(|other| acts(*other, axis)) => {
                Self::Axis(axis, effect(Coordinate::Z, axis))
            }
            _ => Self::Tool,
        })
    }
}

struct Planner<'m> {
    machine: &'m Machine,
    scan: Option<ClearanceScan>,
    /// Tool of a tool table in the spindle, by its number.
    tool: Option<u32>,
    factor: f64,
}

impl<'m> Planner<'m> {
    fn new(machine: &'m Machine, tool: Option<&Tool>, factor: f64) -> Result<Self, ApproachError> {
        let scan = machine.scan_without_cuts(tool);
        let scan = scan.map_err(|error| SimulationError::of(machine, error))?;
        Ok(Self { machine, scan, tool: tool.map(|tool| tool.number), factor })
    }

    fn tip(&self, axes: &AxisVector) -> Result<Pose, ApproachError> {
        self.machine.kinematics.forward(axes).map_err(ApproachError::Tool)
    }

    fn tip_mm(&self, axes: &AxisVector) -> Result<[f64; 3], ApproachError> {
        Ok((self.tip(axes)?.position.coords * 1e3).into())
    }

    /// Names of the two parts, that which moves first, and depth in mm.
    fn hit(&self, nearest: &Clearance) -> (String, String, f64) {
        let [part, other] = nearest.parts.map(|part| self.machine.part_name_with(part, self.tool));
        (part, other, -nearest.distance * 1e3)
    }

    fn nearest(&mut self, axes: &AxisVector) -> Result<Option<Clearance>, ApproachError> {
        let Some(scan) = &mut self.scan else { return Ok(None) };
        let nearest = scan.nearest(axes);
        Ok(nearest.map_err(|error| SimulationError::of(self.machine, error))?)
    }

    /// Fails if parts overlap before anything moves.
    fn check_start(&mut self, from: &AxisVector) -> Result<(), ApproachError> {
        let Some(nearest) = self.nearest(from)?.filter(|one| one.distance < -TOUCHING) else {
            return Ok(());
        };
        let (part, other, depth_mm) = self.hit(&nearest);
        Err(ApproachError::Inside { part, other, depth_mm, tip_mm: self.tip_mm(from)? })
    }

    /// The tool up, across and down, at the lowest height at which the way across keeps the clearance that the machine file
    /// wants, or else at the lowest that is clear.
    fn retract_first(
        &mut self,
        lift: &Lift,
        from: &AxisVector,
        to: &AxisVector,
    ) -> Result<Approach, ApproachError> {
        let ends = [self.tip(from)?, self.tip(to)?];
        let highest = ends[0].position.z.max(ends[1].position.z);
        let safe = self.machine.conditions.approach.safe_z;
        let lowest = safe.map_or(highest, |safe| highest.max(safe));
        let wanted = self.machine.collision.as_ref().map_or(0.0, |collision| collision.clearance);
        let mut at = |height: f64| {
            let lines = self.lines_at(height, lift, [from, to], ends)?;
            self.check(lines, *from)
        };
        let is_wide = |approach: &Approach| approach.across >= wanted;
        let mut found = at(lowest);
        if safe.is_some() || found.as_ref().is_ok_and(is_wide) {
            return found;
        }
        for number in 1..MOST_HEIGHTS {
            // Whole centimetres.
            match at(((lowest / HEIGHTS).floor() + f64::from(number)) * HEIGHTS) {
                Ok(approach) if is_wide(&approach) => return Ok(approach),
                Ok(approach) if found.is_err() => found = Ok(approach),
                Err(error) if error.ends_search() => break,
                Ok(_) | Err(_) => {}
            }
        }
        found
    }

    /// Up to `height`, across and down.
    fn lines_at(
        &self,
        height: f64,
        lift: &Lift,
        [from, to]: [&AxisVector; 2],
        ends: [Pose; 2],
    ) -> Result<Vec<Line>, ApproachError> {
        let lifted = |pose: Pose| Pose {
            position: pose.position + Vector3::z() * (height - pose.position.z),
            ..pose
        };
        let high = ends.map(lifted);
        let legs = [Leg::Up, Leg::Across, Leg::Down];
        if let Lift::Axis(axis, effect) = *lift {
            let raised = |axes: &AxisVector, pose: Pose| {
                let mut axes = *axes;
                if let Some(slot) = axes.get_mut(axis) {
                    *slot += (height - pose.position.z) / effect;
                }
                axes
            };
            let [before, behind] = [raised(from, ends[0]), raised(to, ends[1])];
            let ways = [[*from, before], [before, behind], [behind, *to]];
            let lines = legs.into_iter().zip(ways);
            return Ok(lines.map(|(leg, [from, to])| Line::of_axes(leg, from, to)).collect());
        }
        let kinematics = &self.machine.kinematics;
        let inverse = |leg: Leg, pose: &Pose, near: &AxisVector| {
            kinematics.inverse(pose, near).map_err(|source| ApproachError::Reach { leg, source })
        };
        let before = inverse(Leg::Up, &high[0], from)?;
        let behind = inverse(Leg::Across, &high[1], to)?;
        let ways = [
            ([*from, before], [ends[0], high[0]]),
            ([before, behind], high),
            ([behind, *to], [high[1], ends[1]]),
        ];
        let lines = legs.into_iter().zip(ways);
        Ok(lines.map(|(leg, ([from, to], tip))| Line { leg, from, to, tip: Some(tip) }).collect())
    }

    /// The motion along `lines`, checked cycle by cycle.
    fn check(&mut self, lines: Vec<Line>, from: AxisVector) -> Result<Approach, ApproachError> {
        let (nearest, across) = (self.nearest(&from)?, f64::INFINITY);
        let mut approach = Approach { from, steps: Vec::new(), nearest, across, tool: self.tool };
        for line in lines.into_iter().filter(|line| !line.is_empty()) {
            let step = Step::new(self.machine, line, self.factor)?;
            for axes in motions(self.machine, &step) {
                let position = axes?.position;
                self.check_limits(&step, &from, &position)?;
                let Some(now) = self.nearest(&position)? else { continue };
                let leg = step.line.leg;
                if now.distance < -TOUCHING {
                    let (part, other, depth_mm) = self.hit(&now);
                    let tip_mm = self.tip_mm(&position)?;
                    return Err(ApproachError::Collision { leg, part, other, depth_mm, tip_mm });
                }
                if leg == Leg::Across {
                    approach.across = approach.across.min(now.distance);
                }
                if approach.nearest.is_none_or(|nearest| now.distance < nearest.distance) {
                    approach.nearest = Some(now);
                }
            }
            approach.steps.push(step);
        }
        Ok(approach)
    }

    /// Software limits of every axis; one that begins beyond them may come back.
    fn check_limits(
        &self,
        step: &Step,
        from: &AxisVector,
        position: &AxisVector,
    ) -> Result<(), ApproachError> {
        for (axis, (from, position)) in
            self.machine.axes.iter().zip(from.iter().zip(position.iter()))
        {
            let [low, high] = axis.position_limits;
            let beyond = if *position < low.min(*from) - LIMIT_TOLERANCE {
                low
            } else if *position > high.max(*from) + LIMIT_TOLERANCE {
                high
            } else {
                continue;
            };
            return Err(ApproachError::Limit {
                leg: step.line.leg,
                axis: axis.name.clone(),
                position: axis.from_si(*position),
                limit: axis.from_si(beyond),
                unit: axis.unit(),
            });
        }
        Ok(())
    }
}
