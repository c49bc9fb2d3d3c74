//! Legal state transitions from PLCopen's diagram, and blocks that cannot be aborted.

use super::*;

/// True if the diagram has an arrow (PLCopen; manual 2.4, 5.2), or the state stays.
pub(in crate::tests) fn is_arrow(from: AxisState, to: AxisState) -> bool {
    use AxisState::{ErrorStop, Homing, PowerOff, Standstill, Stopping};
    let stays = from == to;
    let fails = to == PowerOff || (to == ErrorStop && from != ErrorStop);
    stays
        || fails
        || match from {
            Standstill => true,
            PowerOff | ErrorStop | Stopping => to == Standstill,
            // A homing is ended by itself, by a stop or by an error.
            Homing => [Standstill, Stopping].contains(&to),
            _ => to != Homing,
        }
}

/// State in which a block moves the axis (manual 5.2, 5.3).
pub(super) fn demanded(block: &str) -> AxisState {
    match short(block) {
        "MoveAbsolute" | "MoveRelative" | "MoveAdditive" | "Halt" | "PositionProfile" => {
            AxisState::DiscreteMotion
        }
        "MoveVelocity"
        | "MoveContinuousAbsolute"
        | "MoveContinuousRelative"
        | "VelocityProfile"
        | "AccelerationProfile"
        | "Decouple" => AxisState::ContinuousMotion,
        "CamIn" | "GearIn" | "GearInPos" | "Phasing" | "Follow" | "ControlAxisBy" => {
            AxisState::SynchronizedMotion
        }
        "Stop" => AxisState::Stopping,
        "Home" => AxisState::Homing,
        other => panic!("nobody says in which state {other} moves the axis"),
    }
}

/// The last part of a name of a type.
pub(super) fn short(name: &str) -> &str {
    name.rsplit("::").next().unwrap_or(name)
}

/// A block that no other may take the axis from: `MC_Stop` until it is done and Execute is FALSE, homing but for a stop.
#[derive(Clone, Copy, Debug)]
pub(super) struct Keeper {
    owner: i64,
    stops: bool,
}

impl Keeper {
    /// The keeper after a call.
    pub(super) fn after(
        before: Option<Self>,
        axis: &Axis,
        (caller, execute): (&str, bool),
        mover: Option<&str>,
    ) -> Result<Option<Self>, String> {
        let name = mover.map_or("", short);
        let stops = name == "Stop";
        let keeps = stops || name == "Home";
        let now = keeps.then(|| Self { owner: axis.owner(), stops });
        let failed = [AxisState::ErrorStop, AxisState::PowerOff].contains(&axis.state());
        let Some(kept) = before.filter(|before| axis.owner() != before.owner && !failed) else {
            return Ok(now);
        };
        let caller = short(caller);
        let let_go = axis.owner() == 0 && axis.state() == AxisState::Standstill;
        let allowed = match (kept.stops, caller) {
            // At its end, at rest and without Execute, or begun again.
            (true, "Stop") => keeps || (let_go && !execute && axis.set_velocity() == 0.0),
            (false, "Home") => keeps || let_go,
            (false, "Stop") => true,
            _ => false,
        };
        if allowed {
            return Ok(now);
        }
        let kept = if kept.stops { "a stop that is held" } else { "a homing" };
        Err(format!("{caller} takes the axis from {kept}: {:?}", axis.state()))
    }
}
