//! Gaps of the path in a profile: the axes cross them on their own while the path waits, as in a check.

use super::machine_path::{MachinePath, efforts};
use super::{Binding, ProfileItem, ProfileSample};
use crate::bridge::Bridge;
use crate::messages::bridged;
use twin_kinematics::{AxisMotion, AxisVector};
use twin_machine::Machine;
use twin_path::Place;
use twin_planner::controller::ToolSetpoint;

/// Finds the gaps of a path (G92 inside a program) and adds the samples and the time of the axes that cross them.
#[derive(Debug)]
pub(super) struct Gaps<'m> {
    machine: &'m Machine,
    /// Position of the axes at the last sample, and the block that jumps from there.
    before: Option<AxisVector>,
    jumping: Option<Place>,
    bridge: Option<Bridge>,
    /// First sample behind the gap that is being crossed.
    behind: Option<ProfileSample>,
    /// Time that the path has waited so far, ns.
    later_ns: i64,
}

impl<'m> Gaps<'m> {
    pub(super) fn new(machine: &'m Machine) -> Self {
        Self { machine, before: None, jumping: None, bridge: None, behind: None, later_ns: 0 }
    }

    /// Takes the position of the axes at `tool`. True if they cross a gap to get there.
    pub(super) fn opens(
        &mut self,
        axes: &MachinePath<'_>,
        tool: &ToolSetpoint,
        position: &AxisVector,
    ) -> bool {
        let jumping = std::mem::replace(&mut self.jumping, tool.jumping.then_some(tool.place));
        // At a jump the axes stay where they are for a cycle; a plan within their limits already has its end there.
        let stays = self.before.filter(|_| tool.jumping);
        let to = stays.unwrap_or_else(|| axes.without_slaves(position));
        let from = self.before.replace(to);
        self.bridge = from
            .zip(jumping)
            .and_then(|(from, place)| Bridge::new(self.machine, [&from, &to], place));
        self.bridge.is_some()
    }

    /// The item for the sample of the last set-point: the sample itself or, before a gap, the note about it.
    #[expect(clippy::large_types_passed_by_value, reason = "it moves into the item")]
    pub(super) fn pass(&mut self, sample: ProfileSample) -> ProfileItem {
        let sample = ProfileSample { time_ns: sample.time_ns + self.later_ns, ..sample };
        match &self.bridge {
            Some(bridge) => {
                self.behind = Some(sample);
                ProfileItem::Finding(bridged(self.machine, bridge, false))
            }
            None => ProfileItem::Sample(Box::new(sample)),
        }
    }

    /// The next sample of a gap that is being crossed; the last one is that behind the gap.
    pub(super) fn cross(&mut self, axes: &MachinePath<'_>) -> Option<ProfileItem> {
        let behind = self.behind?;
        let bridge = self.bridge.as_mut()?;
        // The sample before the gap is a cycle before the one behind it.
        let since_ns = bridge.now_ns();
        let time_ns = behind.time_ns + since_ns;
        let place = bridge.place;
        let sample = if let Some(motion) = bridge.next() {
            let AxisMotion { position, velocity, acceleration } = axes.with_slaves(&motion);
            let torque = axes.torque(&position, &velocity, &acceleration);
            ProfileSample {
                time_ns,
                place,
                feed: 0.0,
                path_velocity: 0.0,
                path_acceleration: 0.0,
                path_jerk: 0.0,
                position,
                velocity,
                acceleration,
                jerk: AxisVector::zeros(position.len()),
                effort: torque.map(|torque| efforts(&torque, [0.0, 1.0], &velocity)),
                binding: Some(Binding::Stop),
                ..behind
            }
        } else {
            (self.bridge, self.behind) = (None, None);
            self.later_ns += since_ns;
            ProfileSample { time_ns, ..behind }
        };
        Some(ProfileItem::Sample(Box::new(sample)))
    }
}
