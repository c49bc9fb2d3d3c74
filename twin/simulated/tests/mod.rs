//! Tests of the simulated machine on shipped machine files, URDF models, plates that hit and faults.

#![expect(clippy::float_cmp, reason = "given in the file, rounded before, or to be exact")]

mod faults;
mod plates;
mod shipped;
mod urdf;

use crate::plant::Plant;
use crate::setpoint::AxisSetpoint;
use crate::simulated::Simulated;
use std::path::Path;
use twin_kinematics::{AxisMotion, AxisVector, Pose, ToolMotion};
use twin_machine::Machine;
use twin_machine::tappets::TappetBits;
use twin_path::Place;
use twin_physics::PhysicsError;

fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

fn load(text: &str) -> Machine {
    Machine::parse(Path::new("machine.toml"), text)
        .unwrap_or_else(|problems| panic!("{problems:#?}"))
}

/// A set-point of axes, with the tool at rest.
pub(crate) fn setpoint(time_ns: i64, axes: AxisMotion) -> AxisSetpoint {
    AxisSetpoint {
        time_ns,
        place: Place::default(),
        axes,
        tool: ToolMotion::at_rest(Pose::at(0.0, 0.0, 0.0)),
        m_call: None,
        path_velocity: 0.0,
        feed: None,
        probing: false,
        tappets: TappetBits::default(),
        switches: 0,
    }
}

/// Positions of the axes after a cycle to a set-point.
fn step(twin: &mut Simulated, time_ns: i64, axes: AxisMotion) -> Result<AxisVector, PhysicsError> {
    twin.command(&setpoint(time_ns, axes))?;
    Ok(twin.feedback()?.expect("feedback").position)
}

/// `text` with the first `from` replaced, which must be there.
fn edited(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from} is not in the file");
    text.replacen(from, to, 1)
}
