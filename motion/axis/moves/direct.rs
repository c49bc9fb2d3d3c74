//! Set-points given by the program every cycle (`SMC_Follow…`, `SMC_ControlAxis…`; manual 2.2.5).

use crate::ownership::Start;
use crate::{Axis, AxisState, Block, Motion, Progress, SmcError, Stage};
use twin_profile::{AxisLimits, Profile, State};

/// A set-point that a program gives every cycle. Nothing is checked by the `SMC_Follow…` blocks, but that it is a number:
/// without one a moving axis brakes, with error 30.
///
/// As a [`Block`] it is `SMC_FollowPosition`, `SMC_FollowVelocity` or `SMC_FollowPositionVelocity`: it moves the axis from
/// the rising edge until another block does.
#[doc(alias = "SMC_FollowPosition")]
#[doc(alias = "SMC_FollowVelocity")]
#[doc(alias = "SMC_FollowPositionVelocity")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Follow {
    /// A position, u.
    Position(f64),
    /// A velocity, u/s.
    Velocity(f64),
    /// A position, u, and a velocity, u/s, that fit each other.
    PositionVelocity(f64, f64),
}

impl Follow {
    /// The state it asks for, one cycle after the axis's last set-point.
    fn wanted(self, axis: &Axis) -> State {
        let (before, cycle) = (axis.saved_base, axis.cycle());
        let to = |position: f64| before.position + short_way(axis, position);
        let (position, velocity) = match self {
            Self::Position(position) => (to(position), short_way(axis, position) / cycle),
            Self::Velocity(velocity) => {
                (before.position + 0.5 * (before.velocity + velocity) * cycle, velocity)
            }
            Self::PositionVelocity(position, velocity) => (to(position), velocity),
        };
        State { position, velocity, acceleration: (velocity - before.velocity) / cycle }
    }

    fn is_finite(self) -> bool {
        match self {
            Self::Position(value) | Self::Velocity(value) => value.is_finite(),
            Self::PositionVelocity(position, velocity) => (position + velocity).is_finite(),
        }
    }
}

/// A value that is not a number is not a set-point. At rest the axis stays; in motion that is as if the block had not
/// been called: an error 30, with which the axis brakes.
fn without_setpoint(axis: &Axis) -> Result<Progress, SmcError> {
    let State { position, velocity, .. } = axis.saved_base;
    if velocity != 0.0 {
        return Err(SmcError::FbWasntCalledDuringMotion);
    }
    Ok(Progress { setpoint: State::resting(position), stage: Stage::Busy })
}

/// From the last set-point to the program's `position`, on a rotary axis the short way round, u.
fn short_way(axis: &Axis, position: f64) -> f64 {
    let way = axis.to_drive(position) - axis.saved_base.position;
    axis.period().map_or(way, |period| way - period * (way / period).round())
}

impl Motion for Follow {
    type With = ();
    type Run = ();
    const STATE: AxisState = AxisState::SynchronizedMotion;
    const LIVE: bool = true;

    fn plan(&self, _start: Start, _axis: &Axis, (): ()) -> Result<(), SmcError> {
        Ok(())
    }

    fn step(&self, (): &mut (), axis: &mut Axis, (): ()) -> Result<Progress, SmcError> {
        if !self.is_finite() {
            return without_setpoint(axis);
        }
        let setpoint = self.wanted(axis);
        Ok(Progress { setpoint, stage: Stage::Busy })
    }
}

/// A set-point that is watched: a jump is bridged (`SMC_ControlAxisByPos`, `SMC_ControlAxisByPosVel`,
/// `SMC_ControlAxisByVel`, manual 2.2.5).
///
/// With `avoid_gaps`, a set-point that needs more than `fSWMaxVelocity` in the cycle is a jump, and so is a position that
/// does not fit its velocity: [`ControlOutputs::stop_ipo`] holds the interpolator while the axis goes to the set-point with
/// the gap values. A set-point that moves on meanwhile is met with its velocity.
///
/// For positions a step of the velocity below that is not a jump, as in the manual: the axis follows it with any
/// acceleration ([`Axis::exceeds_limits`] reports it). Only the first set-point must also keep `fSWMaxAcceleration` and
/// `fSWMaxDeceleration`, and velocities without positions always must.
///
/// Gap values that are not positive are replaced by the axis's own.
#[doc(alias = "SMC_ControlAxisByPos")]
#[doc(alias = "SMC_ControlAxisByPosVel")]
#[doc(alias = "SMC_ControlAxisByVel")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlAxisBy {
    /// The set-point.
    pub setpoint: Follow,
    /// `bAvoidGaps`: bridge jumps.
    pub avoid_gaps: bool,
    /// `fGapVelocity`, u/s.
    pub gap_velocity: f64,
    /// `fGapAcceleration`, u/s².
    pub gap_acceleration: f64,
    /// `fGapDeceleration`, u/s².
    pub gap_deceleration: f64,
}

impl ControlAxisBy {
    fn gap_limits(&self, axis: &Axis) -> AxisLimits {
        let own = axis.implicit_limits();
        let or = |value: f64, own: f64| if value > 0.0 && value.is_finite() { value } else { own };
        AxisLimits {
            velocity: or(self.gap_velocity, own.velocity),
            acceleration: or(self.gap_acceleration, own.acceleration),
            deceleration: or(self.gap_deceleration, own.deceleration),
            jerk: own.jerk,
        }
    }

    /// Limits of the bridge relative to a set-point that moves with `velocity`, so that the axis keeps its own.
    fn relative(&self, velocity: f64, axis: &Axis) -> Option<AxisLimits> {
        let limits = self.gap_limits(axis);
        let room = axis.implicit_limits().velocity - velocity.abs();
        // What grows for the set-point may fall for the axis.
        let rate = limits.acceleration.min(limits.deceleration);
        (room > 0.0).then_some(AxisLimits {
            velocity: limits.velocity.min(room),
            acceleration: rate,
            deceleration: rate,
            ..limits
        })
    }

    /// One cycle of the bridge to a set-point that moves with `velocity`; whether it ends with it.
    fn bridge(&self, wanted: State, velocity: f64, axis: &Axis) -> Option<(State, bool)> {
        let (from, ramp, cycle) = (axis.saved_base, axis.ramp(), axis.cycle());
        let limits = self.gap_limits(axis);
        let relative = self.relative(velocity, axis).filter(|_| velocity != 0.0);
        let (profile, origin, moving) = match (self.setpoint, relative) {
            (Follow::Velocity(velocity), _) => {
                (Profile::to_velocity(from, velocity, limits, ramp), 0.0, 0.0)
            }
            // Relative to the set-point, which was a cycle's way behind.
            (_, Some(limits)) => {
                let origin = wanted.position - velocity * cycle;
                let from = State {
                    position: from.position - origin,
                    velocity: from.velocity - velocity,
                    ..from
                };
                (Profile::to_position(from, 0.0, 0.0, limits, ramp), wanted.position, velocity)
            }
            // At rest, or faster than the axis may be.
            (_, None) => (Profile::to_position(from, wanted.position, 0.0, limits, ramp), 0.0, 0.0),
        };
        let profile = profile.ok()?;
        let ends = profile.duration() <= cycle * (1.0 + 1e-9);
        // With a velocity the axis goes on for the rest of the cycle.
        let State { position, velocity, acceleration } = profile.at(cycle);
        let state =
            State { position: origin + position, velocity: moving + velocity, acceleration };
        Some((state, ends))
    }

    /// True if a set-point is a jump for an axis that has moved as `before`.
    fn jumps(&self, wanted: State, before: State, axis: &Axis) -> bool {
        let mean = (wanted.position - before.position) / axis.cycle();
        match self.setpoint {
            Follow::Velocity(_) => exceeds(wanted, before, axis, true, true),
            Follow::Position(_) => exceeds(wanted, before, axis, true, false),
            Follow::PositionVelocity(..) => {
                // The way fits if its mean velocity is between both; otherwise the axis would have to accelerate
                // and brake within the cycle.
                let (low, high) =
                    (before.velocity.min(wanted.velocity), before.velocity.max(wanted.velocity));
                let excess = mean - mean.clamp(low, high);
                let acceleration = 2.0 * excess / axis.cycle();
                let detour = State { velocity: 0.0, acceleration, ..wanted };
                let whole = State { velocity: mean, ..wanted };
                exceeds(wanted, before, axis, true, false)
                    || exceeds(whole, before, axis, true, false)
                    || exceeds(detour, State::default(), axis, false, true)
            }
        }
    }
}

/// A watched set-point on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Watched {
    bridging: bool,
    /// The last set-point, u; none before the first one.
    last: Option<f64>,
}

impl Watched {
    /// `bStopIpo`: a jump is being bridged.
    #[must_use]
    pub fn stop_ipo(&self) -> bool {
        self.bridging
    }
}

impl Motion for ControlAxisBy {
    type With = ();
    type Run = Watched;
    const STATE: AxisState = AxisState::SynchronizedMotion;
    const LIVE: bool = true;

    fn plan(&self, _start: Start, _axis: &Axis, (): ()) -> Result<Watched, SmcError> {
        Ok(Watched::default())
    }

    fn step(&self, run: &mut Watched, axis: &mut Axis, (): ()) -> Result<Progress, SmcError> {
        if !self.setpoint.is_finite() {
            return without_setpoint(axis);
        }
        let (wanted, before) = (self.setpoint.wanted(axis), axis.saved_base);
        // At the takeover the axis may be elsewhere than the set-points, or have another velocity.
        let begins = run.last.is_none() && exceeds(wanted, before, axis, true, true);
        run.bridging |= self.avoid_gaps && (begins || self.jumps(wanted, before, axis));
        let setpoint = if run.bridging {
            let moves = self.moves(run.last, wanted, axis);
            // The manual has no error for limits without a possible bridge.
            let bridge = self.bridge(wanted, moves, axis).ok_or(SmcError::MaInvalidVelaccValues)?;
            run.bridging = !bridge.1;
            bridge.0
        } else {
            wanted
        };
        run.last = Some(wanted.position);
        Ok(Progress { setpoint, stage: Stage::Busy })
    }
}

impl ControlAxisBy {
    /// Velocity of the set-point itself, u/s: as given, or since the `last` one, if that is not a jump either.
    fn moves(&self, last: Option<f64>, wanted: State, axis: &Axis) -> f64 {
        let State { velocity, .. } = wanted;
        match self.setpoint {
            Follow::Velocity(_) | Follow::PositionVelocity(..) => velocity,
            Follow::Position(_) => {
                let way = last.map_or(0.0, |last| wanted.position - last);
                let way = axis.period().map_or(way, |it| way - it * (way / it).round());
                let velocity = way / axis.cycle();
                let fits = velocity.abs() < axis.implicit_limits().velocity;
                if fits { velocity } else { 0.0 }
            }
        }
    }
}

/// [`ControlAxisBy`] with `bEnable`.
#[derive(Clone, Debug)]
pub struct ControlAxis {
    block: Block<ControlAxisBy>,
}

/// Outputs of [`ControlAxis`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ControlOutputs {
    /// `bCommandAborted`: another block has taken the axis.
    pub command_aborted: bool,
    /// `bError` and `iErrorID`.
    pub error: Option<SmcError>,
    /// `bStopIpo`: the interpolator has to wait (`bEmergency_Stop`).
    pub stop_ipo: bool,
}

impl ControlAxis {
    /// A block with these inputs, not enabled.
    #[must_use]
    pub fn new(inputs: ControlAxisBy) -> Self {
        Self { block: Block::new(inputs) }
    }

    /// The inputs; they count every cycle.
    pub fn inputs(&mut self) -> &mut ControlAxisBy {
        &mut self.block.inputs
    }

    /// Calls it, for a cycle, with `bEnable` and its axis. Not enabled, it releases an axis at rest; in motion
    /// that is an error 30, as for every block that is not called any more.
    pub fn call(&mut self, enable: bool, axis: &mut Axis) -> ControlOutputs {
        if !enable {
            let owner = self.block.owner().filter(|owner| axis.owns(*owner));
            // In motion the axis brakes by itself; an axis of another block is not touched.
            if owner.is_none() || axis.set_velocity() == 0.0 {
                if let Some(owner) = owner {
                    axis.release(owner);
                }
                self.block = Block::new(self.block.inputs);
            }
            return ControlOutputs::default();
        }
        let shown = self.block.call(true, axis);
        let stop_ipo = self.block.running().is_some_and(Watched::stop_ipo);
        ControlOutputs { command_aborted: shown.command_aborted, error: shown.error, stop_ipo }
    }
}

/// True if a set-point asks for more than the axis's software maxima.
pub(crate) fn exceeds(
    wanted: State,
    before: State,
    axis: &Axis,
    velocity: bool,
    rates: bool,
) -> bool {
    /// Allowance for rounding.
    const SLACK: f64 = 1.0 + 1e-6;
    let limits = axis.implicit_limits();
    let grows = wanted.velocity.abs() >= before.velocity.abs();
    let rate = if grows { limits.acceleration } else { limits.deceleration };
    (velocity && wanted.velocity.abs() > limits.velocity * SLACK)
        || (rates && wanted.acceleration.abs() > rate * SLACK)
}
