//! Braking off the path: every axis stops on its own at its largest deceleration and jerk.

use crate::setpoint::AxisSetpoint;
use std::f64::consts::TAU;
use twin_kinematics::{AxisMotion, Kinematics, ToolMotion};
use twin_machine::Machine;
use twin_number::seconds;
use twin_planner::time_optimal::emergency::{EmergencyStop, StopError, StopLimits};

/// Time constants of the slowest position loop for which the set-points rest at the end, for what follows them to rest as well.
const SETTLING: f64 = 10.0;

/// The set-points behind `from`, one per cycle, until all axes rest; none if they rest there.
///
/// # Errors
/// If the motion or the limits are none that an axis can be braked with; those of a machine file are.
pub(super) fn braking<'m>(
    machine: &'m Machine,
    from: &AxisSetpoint,
) -> Result<impl Iterator<Item = AxisSetpoint> + use<'m>, StopError> {
    let limits: Vec<_> = machine
        .axes
        .iter()
        .map(|axis| StopLimits { acceleration: axis.max_deceleration, jerk: axis.max_jerk })
        .collect();
    let stop = EmergencyStop::new(&from.axes, &limits)?;
    let moves = stop.duration() > 0.0;
    let end = if moves { stop.duration() + settling(machine) } else { 0.0 };
    let mut last = *from;
    let begun_ns = from.time_ns;
    Ok(std::iter::from_fn(move || {
        if seconds(last.time_ns - begun_ns) >= end {
            return None;
        }
        let time_ns = last.time_ns + machine.cycle_ns;
        let axes = stop.at(seconds(time_ns - begun_ns));
        let tool = tool(machine, &axes, &last);
        let path_velocity = tool.velocity.norm();
        last = AxisSetpoint { time_ns, axes, tool, path_velocity, m_call: None, ..last };
        Some(last)
    }))
}

/// The set-points behind `from`, where all axes rest, until what follows them rests as well.
pub(super) fn resting(
    machine: &Machine,
    from: &AxisSetpoint,
) -> impl Iterator<Item = AxisSetpoint> + use<> {
    let (cycle_ns, until) = (machine.cycle_ns, settling(machine));
    let (from, mut after_ns) = (AxisSetpoint { m_call: None, ..*from }, 0);
    std::iter::from_fn(move || {
        after_ns += cycle_ns;
        (seconds(after_ns) <= until)
            .then(|| AxisSetpoint { time_ns: from.time_ns + after_ns, ..from })
    })
}

/// How long the simulated machine takes to come to rest behind its set-points, s.
fn settling(machine: &Machine) -> f64 {
    let bandwidths = machine.axes.iter().map(|axis| axis.simulated.bandwidth_hz);
    let slowest = bandwidths.fold(f64::INFINITY, f64::min);
    // The gain of the position loop is a quarter of the bandwidth.
    SETTLING * 4.0 / (TAU * slowest)
}

/// Where the axes have the tool. Off the path it may come to where the transform knows no tool; it is then shown where it was
/// last.
fn tool(machine: &Machine, axes: &AxisMotion, last: &AxisSetpoint) -> ToolMotion {
    let known = machine.kinematics.forward_motion(axes).ok();
    known.unwrap_or_else(|| ToolMotion::at_rest(last.tool.pose))
}

#[cfg(test)]
mod tests {
    use super::braking;
    use crate::setpoint::AxisSetpoint;
    use std::path::Path;
    use twin_kinematics::{AxisMotion, Kinematics, ToolMotion};
    use twin_machine::Machine;
    use twin_machine::tappets::TappetBits;
    use twin_path::Place;

    /// Every axis brakes with its deceleration, v / d long and v² / 2d far.
    #[test]
    fn axes_brake_with_their_deceleration() {
        let text = include_str!("../../tests/data/machines/gantry3.toml");
        let (accelerated, braked) =
            ("max_acceleration_mm_per_s2 = 3000.0", "max_deceleration_mm_per_s2 = 1000.0");
        assert!(text.contains(accelerated));
        let text = text.replacen(accelerated, &format!("{accelerated}\n{braked}"), 1);
        let machine = Machine::parse(Path::new("gantry3.toml"), &text).expect("a machine");
        let rest = AxisMotion::at_rest(machine.start_axes().expect("a start"));
        let mut moving = rest;
        moving.velocity[0] = 0.2;
        let pose = machine.kinematics.forward(&rest.position).expect("in reach");
        let from = AxisSetpoint {
            time_ns: 0,
            place: Place::default(),
            axes: moving,
            tool: ToolMotion::at_rest(pose),
            m_call: None,
            path_velocity: 0.2,
            feed: Some(0.2),
            probing: false,
            tappets: TappetBits::default(),
            switches: 0,
        };
        let stop: Vec<_> = braking(&machine, &from).expect("limits").collect();
        let duration = 0.2 / 1.0;
        let moves = stop.iter().filter(|setpoint| setpoint.axes.velocity[0] > 1e-9).count();
        let took = f64::from(u32::try_from(moves).expect("few")) * 1e-3;
        assert!((took - duration).abs() < 1.5e-3, "{took} s, not {duration} s");
        let way = stop.last().expect("set-points").axes.position[0] - rest.position[0];
        assert!((way - 0.2 * 0.2 / 2.0).abs() < 1e-9, "{way} m");
    }
}
