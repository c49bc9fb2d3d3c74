//! Calls of every method on the solve path.

use super::Calls;
use nalgebra::SVector;
use twin_kinematics::transform::{Differential, Motion, Transform};
use twin_kinematics::{AxisMotion, AxisVector, Kinematics, ToolJerk};

/// Derivatives that are not 0.
fn derivative<const N: usize>(first: f64) -> SVector<f64, N> {
    let mut value = first;
    SVector::from_fn(|_, _| {
        value = 0.7 * value - 0.1;
        value
    })
}

/// Of a transform as it is, the tool being at `tool` with the axes at `axes`.
pub fn of_transform<T: Transform<N>, const N: usize>(
    calls: &mut Calls,
    of: &str,
    machine: &T,
    tool: &SVector<f64, N>,
    axes: &SVector<f64, N>,
) {
    let [velocity, acceleration, jerk] = [0.3, -0.4, 0.5].map(derivative::<N>);
    calls.attempt(of, "to_tool", false, || machine.to_tool(axes));
    calls.attempt(of, "to_axes", false, || machine.to_axes(tool));
    calls.attempt(of, "to_axes_near", false, || machine.to_axes_near(tool, axes));
    calls.call(of, "turn_to", || {
        let mut turned = *axes;
        machine.turn_to(&mut turned, &velocity);
        turned
    });
    let moving = Motion { position: *tool, velocity, acceleration };
    calls.attempt(of, "axis_motion", false, || machine.axis_motion(&moving, axes));
    let moving = Motion { position: *axes, velocity, acceleration };
    calls.attempt(of, "tool_motion", false, || machine.tool_motion(&moving));
    calls.call(of, "branch", || machine.branch());
    calls.call(of, "branch_at", || machine.branch_at(axes));
    calls.call(of, "margins", || machine.margins(tool));
    calls.call(of, "singular", || machine.singular(tool));
    calls.call(of, "holding", || machine.clone().holding(&[0.01, 0.02, 0.03].into()));

    calls.attempt(of, "at_axes", false, || machine.at_axes(axes));
    calls.attempt(of, "at_tool", false, || machine.at_tool(tool, axes));
    let (_, one) = machine.at_axes(axes).expect("within reach");
    let (_, other) = machine.at_tool(tool, axes).expect("within reach");
    for there in [one, other] {
        let some = |found: bool| if found { Ok(()) } else { Err(()) };
        let all = [velocity, acceleration, jerk];
        calls.attempt(of, "follow", false, || {
            some(there.follow(&velocity, &acceleration).is_some())
        });
        calls.attempt(of, "follow_jerk", false, || some(there.follow_jerk(&all).is_some()));
        calls.attempt(of, "lead", false, || some(there.lead(&velocity, &acceleration).is_some()));
        calls.attempt(of, "lead_jerk", false, || some(there.lead_jerk(&all).is_some()));
        calls.attempt(of, "jacobian", false, || some(there.jacobian().is_some()));
    }
}

/// Of a machine behind the trait, with the axes at `position`.
pub fn of_kinematics(calls: &mut Calls, of: &str, machine: &dyn Kinematics, position: &AxisVector) {
    let of = &format!("dyn {of}, {} axes", position.len());
    let small = |first: f64| {
        AxisVector::from_values(derivative::<8>(first).iter().copied().take(position.len()))
    };
    let (velocity, acceleration) = (small(0.3), small(-0.4));
    let axes = AxisMotion { position: *position, velocity, acceleration };
    let tool = machine.forward_motion(&axes).expect("within reach");
    let tool_jerk = ToolJerk { linear: [0.1, 0.2, 0.3].into(), direction: 0.4 };
    // What a motion of the axes leads to, the axes can follow.
    calls.attempt(of, "forward", false, || machine.forward(position));
    calls.attempt(of, "inverse", false, || machine.inverse(&tool.pose, position));
    calls.attempt(of, "forward_motion", false, || machine.forward_motion(&axes));
    calls.attempt(of, "inverse_motion", false, || machine.inverse_motion(&tool, position));
    calls.attempt(of, "inverse_jerk", false, || machine.inverse_jerk(&tool, &tool_jerk, position));
    calls.attempt(of, "jacobian", false, || machine.jacobian(position));
    calls.attempt(of, "branch_at", false, || machine.branch_at(position));
    calls.attempt(of, "margins", false, || machine.margins(&tool.pose));
    calls.attempt(of, "dexterity", false, || machine.dexterity(position, 0.5));
    calls.call(of, "branch", || machine.branch());
    calls.call(of, "others", || {
        (
            machine.axis_count(),
            machine.coordinates().len(),
            machine.is_rotary(0),
            machine.moves_tool(0),
        )
    });
}

/// Of a machine asked for what it cannot do: what is not a number, too few axes and, if there is an end to it, what is
/// out of reach.
pub fn of_refusals(calls: &mut Calls, of: &str, machine: &dyn Kinematics) {
    let of = &format!("dyn {of} refusing");
    let bad = AxisVector::from_values(std::iter::repeat_n(f64::NAN, machine.axis_count()));
    let short = AxisVector::zeros(machine.axis_count() - 1);
    for axes in [bad, short] {
        let motion = AxisMotion { position: axes, velocity: axes, acceleration: axes };
        calls.attempt(of, "forward", true, || machine.forward(&axes));
        calls.attempt(of, "forward_motion", true, || machine.forward_motion(&motion));
        calls.attempt(of, "jacobian", true, || machine.jacobian(&axes));
        calls.attempt(of, "dexterity", true, || machine.dexterity(&axes, 0.5));
        calls.attempt(of, "branch_at", true, || machine.branch_at(&axes));
    }
    let near = AxisVector::zeros(machine.axis_count());
    let mut far = twin_kinematics::ToolMotion::at_rest(twin_kinematics::Pose::at(3.0, 2.0, 0.0));
    let ends = machine.inverse(&far.pose, &near).is_err();
    assert_eq!(ends, !of.contains("Gantry"), "{of}");
    for refused in [ends, true] {
        calls.attempt(of, "inverse", refused, || machine.inverse(&far.pose, &near));
        calls.attempt(of, "inverse_motion", refused, || machine.inverse_motion(&far, &near));
        let jerk = ToolJerk::default();
        calls.attempt(of, "inverse_jerk", refused, || machine.inverse_jerk(&far, &jerk, &near));
        far.pose.position.x = f64::NAN;
    }
}
