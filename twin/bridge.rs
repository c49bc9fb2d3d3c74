//! Gap bridging: every axis goes on its own from one set-point to the next where no path leads (`SMC_ControlAxisByPos` with
//! `bAvoidGaps`, manual 2.2.5 and 11.7.1).
//!
//! The axes move as fast as their limits in the machine file allow, which take the place of `fGapVelocity`,
//! `fGapAcceleration` and `fGapDeceleration`. The path waits meanwhile (`bStopIpo`).

use crate::tolerance::{ROUNDING, exceeds};
use twin_kinematics::{AxisMotion, AxisVector};
use twin_machine::{Axis, Machine};
use twin_number::seconds;
use twin_path::Place;
use twin_profile::{AxisLimits, Profile, RampType, State};

/// A gap of the path, and the motion of the axes across it.
#[derive(Clone, Debug)]
pub(crate) struct Bridge {
    /// The block that makes the gap.
    pub(crate) place: Place,
    /// Motion of every axis, in machine-file order, m or rad.
    profiles: Vec<Profile>,
    limits: Vec<(AxisLimits, RampType)>,
    cycle_ns: i64,
    /// Time since the set-point before the gap, ns.
    now_ns: i64,
    /// Time of the stop on the way, ns.
    braked_ns: Option<i64>,
}

impl Bridge {
    /// The way of the axes from rest at `from` to rest at `to`; none if no axis exceeds its velocity by being there in the
    /// next cycle: that is not a jump (manual 2.2.5).
    pub(crate) fn new(
        machine: &Machine,
        [from, to]: [&AxisVector; 2],
        place: Place,
    ) -> Option<Self> {
        let cycle = seconds(machine.cycle_ns);
        let mut ways = from.iter().zip(to.iter()).zip(&machine.axes);
        if !ways.any(|((from, to), axis)| exceeds((to - from) / cycle, axis.max_velocity)) {
            return None;
        }
        let limits: Vec<_> = machine.axes.iter().map(limits).collect();
        let ways = from.iter().zip(to.iter()).zip(&limits);
        let profiles = ways.map(|((from, to), (limits, ramp))| {
            Profile::to_position(State::resting(*from), *to, 0.0, *limits, *ramp).ok()
        });
        let profiles = profiles.collect::<Option<Vec<_>>>()?;
        let cycle_ns = machine.cycle_ns;
        Some(Self { place, profiles, limits, cycle_ns, now_ns: 0, braked_ns: None })
    }

    /// Duration, s.
    pub(crate) fn duration(&self) -> f64 {
        let durations = self.profiles.iter().map(Profile::duration);
        seconds(self.braked_ns.unwrap_or_default()) + durations.fold(0.0, f64::max)
    }

    /// Distance of each axis from start to end, m or rad.
    pub(crate) fn ways(&self) -> impl Iterator<Item = f64> + '_ {
        self.profiles.iter().map(|profile| profile.end().position - profile.start().position)
    }

    /// The axes one cycle later; none if they are at the end of the gap then, or at rest after a stop.
    pub(crate) fn next(&mut self) -> Option<AxisMotion> {
        let next_ns = self.now_ns + self.cycle_ns;
        let known_ns = if self.is_braked() { self.now_ns } else { next_ns };
        if seconds(known_ns) >= self.duration() * (1.0 - ROUNDING) {
            return None;
        }
        self.now_ns = next_ns;
        let states: Vec<_> = self.states().collect();
        let of = |value: fn(&State) -> f64| AxisVector::from_values(states.iter().map(value));
        Some(AxisMotion {
            position: of(|state| state.position),
            velocity: of(|state| state.velocity),
            acceleration: of(|state| state.acceleration),
        })
    }

    fn states(&self) -> impl Iterator<Item = State> + '_ {
        let time = seconds(self.now_ns - self.braked_ns.unwrap_or_default());
        self.profiles.iter().map(move |profile| profile.at(time))
    }

    /// Time of the latest set-point since the one before the gap, ns.
    pub(crate) fn now_ns(&self) -> i64 {
        self.now_ns
    }

    /// True after [`Self::brake`]: the axes do not get to the end of the gap.
    pub(crate) fn is_braked(&self) -> bool {
        self.braked_ns.is_some()
    }

    /// Brings every axis to rest as fast as it can.
    pub(crate) fn brake(&mut self) {
        if self.is_braked() {
            return;
        }
        let halts = self.states().zip(&self.limits);
        let halts = halts.map(|(state, (limits, ramp))| Profile::halt(state, *limits, *ramp).ok());
        if let Some(profiles) = halts.collect::<Option<Vec<_>>>() {
            self.profiles = profiles;
            self.braked_ns = Some(self.now_ns);
        }
    }
}

/// One instant of the way across a gap, slaves of gears and cams aside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BridgeSetpoint {
    /// Since the start of the program, ns.
    pub(crate) time_ns: i64,
    /// The block that makes the gap.
    pub(crate) place: Place,
    /// Axes in machine-file order.
    pub(crate) axes: AxisMotion,
}

/// The limits of an axis, and the ramps that keep them.
fn limits(axis: &Axis) -> (AxisLimits, RampType) {
    let Axis { max_velocity, max_acceleration, max_deceleration, max_jerk, .. } = *axis;
    let (jerk, ramp) = max_jerk
        .map_or((max_acceleration, RampType::Trapezoid), |jerk| (jerk, RampType::Parabolic));
    let limits = AxisLimits {
        velocity: max_velocity,
        acceleration: max_acceleration,
        deceleration: max_deceleration,
        jerk,
    };
    (limits, ramp)
}
