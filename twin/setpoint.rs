//! Axis set-points, one per cycle: the stream that physics and drives both receive, and the transform that produces it.

use crate::bridge::{Bridge, BridgeSetpoint};
use crate::m_function::MCall;
use twin_kinematics::{
    AxisMotion, AxisSource, AxisVector, Kinematics, KinematicsError, Pose, ToolMotion,
};
use twin_machine::Machine;
use twin_machine::axis_couplings::{AxesError, AxisCouplings};
use twin_machine::tappets::{MasterPlace, Signal, TappetBits};
use twin_path::Place;
use twin_planner::controller::ToolSetpoint;

/// Planning horizon of set-points for drives, ahead of the wall clock, ns. A device that retargets thirty times a
/// second needs to see its next turning point; a stop requested by the user takes effect after this time.
pub const HORIZON_NS: i64 = 250_000_000;

/// Set-points of all axes at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisSetpoint {
    /// Since the start of the program, ns.
    pub time_ns: i64,
    /// The block being traversed.
    pub place: Place,
    /// Axes in machine-file order.
    pub axes: AxisMotion,
    /// The tool in the machine frame.
    pub tool: ToolMotion,
    /// The M function at which the path waits.
    pub m_call: Option<MCall>,
    /// Velocity along the path, m/s.
    pub path_velocity: f64,
    /// Programmed velocity along the path, m/s; `None` on a rapid.
    pub feed: Option<f64>,
    /// True during a probing move.
    pub probing: bool,
    /// Tappet signals that are on, in the order of the program's signals.
    pub tappets: TappetBits,
    /// Switches of the path that are on (`dwSwitches`): bit n − 1 is switch n.
    pub switches: u32,
}

/// How long drives that follow late may need behind the last set-point, ns.
const LONGEST_ARRIVAL_NS: i64 = 2_000_000_000;

/// Set-points that stay where `last` is, a cycle each, for as long as drives that follow late may need.
pub(crate) fn resting_behind(
    last: &AxisSetpoint,
    cycle_ns: i64,
) -> impl Iterator<Item = AxisSetpoint> + use<> {
    let resting = AxisSetpoint {
        axes: AxisMotion::at_rest(last.axes.position),
        tool: ToolMotion::at_rest(last.tool.pose),
        path_velocity: 0.0,
        m_call: None,
        ..*last
    };
    let cycles = 1..=LONGEST_ARRIVAL_NS / cycle_ns.max(1);
    cycles.map(move |cycle| AxisSetpoint { time_ns: resting.time_ns + cycle * cycle_ns, ..resting })
}

/// Turns tool set-points into axis set-points. Rotary axes go on from turn to turn along the path.
#[derive(Clone, Debug)]
pub struct Transformer<'m> {
    machine: &'m Machine,
    near: AxisVector,
    has_additional: bool,
    couplings: AxisCouplings<'m>,
    /// The block of the last set-point, if it jumps.
    jumping: Option<Place>,
    /// Switches of the path at the last set-point.
    switches: u32,
    /// True before the first set-point of a program that begins where another one ended.
    continues: bool,
}

impl<'m> Transformer<'m> {
    /// For a program that starts anywhere: the first answer is the one nearest to the middle of the software limits.
    pub fn new(machine: &'m Machine) -> Self {
        let mut sources = machine.kinematics.sources().iter();
        let has_additional = sources.any(|source| matches!(source, AxisSource::Additional(_)));
        let couplings = AxisCouplings::for_program(machine);
        Self {
            machine,
            near: machine.middle(),
            has_additional,
            couplings,
            jumping: None,
            switches: 0,
            continues: false,
        }
    }

    /// For a program that begins with the axes at `start`, where the program before it ended, m or rad.
    pub(crate) fn continuing(machine: &'m Machine, start: AxisVector) -> Self {
        Self { near: start, continues: true, ..Self::new(machine) }
    }

    /// The axes have come to `near` since the last set-point, m or rad.
    pub(crate) fn continue_at(&mut self, near: AxisVector) {
        self.near = near;
    }

    /// True before the first set-point of a program that begins where another one ended.
    pub(crate) fn continues(&self) -> bool {
        self.continues
    }

    /// Signals of the tappets: the bits of the set-points in their order.
    pub(crate) fn signals(&self) -> &[Signal] {
        self.couplings.signals()
    }

    /// Position of the master that switched a signal last, at the last set-point.
    pub(crate) fn tappet_master(&self, signal: usize) -> Option<MasterPlace> {
        self.couplings.tappet_master(signal)
    }

    /// Tappets that did not act because there were too many in a cycle.
    pub(crate) fn lost_tappets(&self) -> u64 {
        self.couplings.lost_tappets()
    }

    /// Slaves and masters, by name, whose master was on tappets of their cam at the first set-point, with the tappet
    /// groups.
    pub(crate) fn stood_on_tappets(&self) -> impl Iterator<Item = ([&'m str; 2], Vec<i16>)> {
        let machine = self.machine;
        let name = |index: usize| machine.axes.get(index).map_or("", |axis| axis.name.as_str());
        let stood = self.couplings.stood_on_tappets();
        stood.map(move |(coupling, groups)| ([coupling.axis, coupling.master].map(name), groups))
    }

    /// The additional axes go where the program says, in their technical unit: degrees or mm.
    fn add_additional(&self, tool: &ToolSetpoint, axes: &mut AxisMotion) {
        let AxisMotion { position, velocity, acceleration } = axes;
        let values = position.iter_mut().zip(velocity.iter_mut()).zip(acceleration.iter_mut());
        let sources = self.machine.kinematics.sources().iter().zip(&self.machine.axes);
        for (((position, velocity), acceleration), (source, axis)) in values.zip(sources) {
            let AxisSource::Additional(number) = *source else { continue };
            let of = |values: &[f64; 5]| {
                axis.to_si(values.get(usize::from(number)).copied().unwrap_or_default())
            };
            *position = of(&tool.extra.position);
            *velocity = of(&tool.extra.velocity);
            *acceleration = of(&tool.extra.acceleration);
        }
    }

    /// The axes for one tool set-point, at which the path may stand for `m_call`. Additional axes that the machine does
    /// not have are left out.
    ///
    /// # Errors
    /// What the kinematics refuses, and what the gears and cams of the machine do.
    pub fn axes(
        &mut self,
        tool: &ToolSetpoint,
        m_call: Option<MCall>,
    ) -> Result<AxisSetpoint, AxesError> {
        let (mut motion, mut axes) = self.without_slaves(tool)?;
        self.near = axes.position;
        self.jumping = tool.jumping.then_some(tool.place);
        self.switches = tool.switches;
        self.couplings.apply(&mut axes, tool.time_ns)?;
        if self.couplings.moves_tool() {
            motion = self.machine.kinematics.forward_motion(&axes)?;
        }
        Ok(AxisSetpoint {
            time_ns: tool.time_ns,
            place: tool.place,
            axes,
            tool: motion,
            m_call,
            path_velocity: tool.path_velocity,
            feed: (!tool.rapid).then_some(tool.feed),
            probing: tool.probing,
            tappets: self.couplings.tappets(),
            switches: self.switches,
        })
    }

    /// Tool in the machine frame, and the axes without the slaves of gears and cams.
    fn without_slaves(
        &self,
        tool: &ToolSetpoint,
    ) -> Result<(ToolMotion, AxisMotion), KinematicsError> {
        let [direction, direction_velocity, direction_acceleration] =
            self.machine.direction.at(tool);
        let work = ToolMotion {
            pose: Pose { position: tool.position, direction },
            velocity: tool.velocity,
            acceleration: tool.acceleration,
            direction_velocity,
            direction_acceleration,
        };
        let motion = self.machine.frame.motion_to_machine(&work);
        let mut axes = self.machine.kinematics.inverse_motion(&motion, &self.near)?;
        if self.has_additional {
            self.add_additional(tool, &mut axes);
        }
        Ok((motion, axes))
    }

    /// The motion of the axes from the last set-point to `tool`, if the path jumps there, or from the end of the program before.
    pub(crate) fn bridge(&mut self, tool: &ToolSetpoint) -> Option<Bridge> {
        let place =
            if std::mem::take(&mut self.continues) { tool.place } else { self.jumping.take()? };
        // A set-point out of reach is an error of its own.
        let (_, axes) = self.without_slaves(tool).ok()?;
        Bridge::new(self.machine, [&self.near, &axes.position], place)
    }

    /// The axes for one instant of a bridge.
    ///
    /// # Errors
    /// As [`Self::axes`].
    pub(crate) fn bridging(&mut self, instant: &BridgeSetpoint) -> Result<AxisSetpoint, AxesError> {
        let BridgeSetpoint { time_ns, place, mut axes } = *instant;
        self.near = axes.position;
        self.couplings.apply(&mut axes, time_ns)?;
        let tool = self.machine.kinematics.forward_motion(&axes)?;
        Ok(AxisSetpoint {
            time_ns,
            place,
            axes,
            tool,
            m_call: None,
            path_velocity: tool.velocity.norm(),
            feed: None,
            probing: false,
            tappets: self.couplings.tappets(),
            switches: self.switches,
        })
    }
}
