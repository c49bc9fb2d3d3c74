//! `MC_CamIn`: couples a slave to a cam.

use crate::ownership::Start;
use crate::{Axis, AxisState, Master, Motion, Progress, SmcError, Stage};
use twin_cam::{Approach, CamCoupling, CamInput, CamTable, CouplingError, Gap, StartMode};
use twin_profile::{AxisLimits, RampType, State};

/// The slave follows a cam (`MC_CamIn`, manual 5.4); `done` is `InSync`. What `MC_CamTableSelect` gives is a
/// [`CamTable`]; the periods of master and slave are those of the axes.
///
/// [`CamRun::coupling`] has `EndOfProfile` and the tappets, by the clock of the slave ([`Axis::now_ns`]), which goes on when
/// the block is started again. The master's acceleration counts as well, so that the slave's acceleration is exact.
///
/// The manual begins a cam with the master's position at the rising edge and does not define it for a master that has moved
/// in this cycle already. Here a master that was at rest when the cycle began counts where it was: a cam that it leaves at
/// once is not an error 626, and it passes the tappets on its way. A moving master counts where it is now.
///
/// The slave is strictly at the position of the cam for the master's position (manual 4.6.2): under an absolute cam it steps
/// when `MC_SetPosition` moves the master's zero. A cam with `MasterAbsolute` FALSE stays at the master's old position.
///
/// A ramp onto the cam has the ramp type of the axis: sigmoid and parabolic ramps do not step the slave's acceleration and
/// add at most the axis's jerk (`fMaxJerk`) to the cam's own. The manual's block has no input for it.
#[doc(alias = "MC_CamIn")]
#[doc(alias = "MC_CamTableSelect")]
#[derive(Clone, Debug)]
pub struct CamIn {
    /// `CamTableID`: the cam selected, if one is.
    pub table: Option<CamTable>,
    /// The other inputs.
    pub input: CamInput,
}

/// A cam that is followed.
#[derive(Clone, Debug)]
pub struct CamRun {
    coupling: CamCoupling,
    /// From positions of the program to set-points, which are unwound and in the drive's coordinates.
    shift: f64,
    seconds: f64,
    /// The master's zero at the start: a cam that lies where the master was stays there.
    zero: f64,
    /// Ramp-in with limited jerk; other ramps are the coupling's.
    approach: Option<Approach>,
}

impl CamRun {
    /// Cam, tappets and `EndOfProfile`. During a ramp with limited jerk the coupling already has the slave on the cam;
    /// [`Self::is_in_sync`] is true once it is.
    pub fn coupling(&self) -> &CamCoupling {
        &self.coupling
    }

    /// `InSync`: whether the slave is on its cam.
    #[must_use]
    pub fn is_in_sync(&self) -> bool {
        self.approach.is_none() && self.coupling.output().in_sync
    }
}

impl CamIn {
    /// True if the slave comes onto its cam with a ramp.
    fn ramps(&self) -> bool {
        !matches!(self.input.start_mode, StartMode::Absolute | StartMode::Relative)
    }

    /// The master at the rising edge, `lead` s before this cycle's set-points.
    fn begins_at(&self, master: Master, lead: f64) -> State {
        if let Some(position) = master.stood.filter(|_| lead > 0.0) {
            return State::resting(position);
        }
        let mut from = now(master);
        if self.ramps() {
            // A ramp begins at the positions of slave and master a cycle ago.
            from.velocity -= master.acceleration * lead;
            from.position -= f64::midpoint(from.velocity, master.velocity) * lead;
        }
        from
    }

    /// Limits of a ramp-in with limited jerk; none for another start.
    fn limited(&self, axis: &Axis) -> Result<Option<AxisLimits>, CouplingError> {
        if !self.ramps() || axis.ramp() == RampType::Trapezoid {
            return Ok(None);
        }
        let [velocity, acceleration, deceleration] = self.input.ramp()?;
        Ok(Some(axis.limits(velocity, acceleration, deceleration)))
    }
}

impl Motion for CamIn {
    type With = Master;
    type Run = CamRun;
    const STATE: AxisState = AxisState::SynchronizedMotion;

    fn plan(&self, start: Start, axis: &Axis, master: Master) -> Result<CamRun, SmcError> {
        let Some(table) = self.table.clone() else { return Err(SmcError::CiNoCamSelected) };
        let table = CamTable { master_period: master.period, slave_period: axis.period(), ..table };
        // If another block has moved the slave in this cycle, the cam takes over from there (manual 4.6.2).
        let moved = axis.values.moved_in_this_cycle;
        let (state, lead) =
            if moved { (axis.total_after_cycle(), 0.0) } else { (start.state, start.lead) };
        let from = self.begins_at(master, lead);
        let zero = master.zero;
        let limits = self.limited(axis).map_err(number)?;
        let start_mode = if limits.is_some() { StartMode::Absolute } else { self.input.start_mode };
        let input = CamInput { start_mode, ..self.input };
        let begin = |master: &State, slave: State, lead: f64| {
            let State { position, velocity, acceleration } = slave;
            let inside = axis.in_program(position);
            let slave = State { position: inside, ..slave };
            // The axis's clock, and pulses of tappets, go on from one cam to the next.
            let start_ns = axis.now_ns().saturating_sub(nanoseconds(lead));
            let coupling = CamCoupling::start(table.clone(), input, master, &slave, start_ns);
            let coupling = coupling.map_err(number)?;
            let on_cam = coupling.output().slave;
            let gap = Gap {
                distance: on_cam.position - inside,
                velocity: velocity - on_cam.velocity,
                acceleration: acceleration - on_cam.acceleration,
                period: axis.period(),
                mode: self.input.start_mode,
            };
            let approach = limits.map(|limits| Approach::new(gap, limits, axis.ramp()));
            // The axis's jerk, or the way, allows no ramp.
            let approach = approach.transpose();
            let approach = approach.map_err(|_invalid| SmcError::CiRampinNeedsVelaccValues)?;
            let (approach, turned) = approach.unzip();
            let shift = position - inside - turned.unwrap_or_default();
            let seconds = lead - axis.cycle();
            Ok::<_, SmcError>(CamRun { coupling, shift, seconds, zero, approach })
        };
        // If the master comes onto the cam in this cycle, the slave first goes on with its acceleration.
        let State { position, velocity, acceleration } = state;
        let later = State {
            position: position + (velocity + 0.5 * acceleration * lead) * lead,
            velocity: velocity + acceleration * lead,
            acceleration,
        };
        begin(&from, state, lead).or_else(|_outside| begin(&now(master), later, 0.0))
    }

    fn step(
        &self,
        run: &mut CamRun,
        axis: &mut Axis,
        master: Master,
    ) -> Result<Progress, SmcError> {
        run.seconds += axis.cycle();
        let mut at = now(master);
        if !run.coupling.table().master_absolute {
            at.position -= master.zero - run.zero;
        }
        run.coupling.step(&at, axis.now_ns()).map_err(number)?;
        let slave = run.coupling.output().slave;
        let on_cam = State { position: slave.position + run.shift, ..slave };
        // A cycle that rounds to just before the end is the end.
        let time = run.seconds + 1e-9 * axis.cycle();
        let ramped = run.approach.as_ref().and_then(|approach| approach.at(time, on_cam));
        if ramped.is_none() {
            run.approach = None;
        }
        let setpoint = ramped.unwrap_or(on_cam);
        let stage = if run.is_in_sync() { Stage::Reached } else { Stage::Busy };
        Ok(Progress { setpoint, stage })
    }
}

fn now(master: Master) -> State {
    let Master { position, velocity, acceleration, .. } = master;
    State { position, velocity, acceleration }
}

#[expect(clippy::cast_possible_truncation, reason = "a cycle")]
fn nanoseconds(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}

fn number(error: CouplingError) -> SmcError {
    match error {
        CouplingError::MasterOutOfRange { .. } => SmcError::CiMasterOutOfScale,
        CouplingError::RampNeedsValues { .. } => SmcError::CiRampinNeedsVelaccValues,
        CouplingError::NotFinite { .. } => SmcError::CiScalingIncorrect,
    }
}
