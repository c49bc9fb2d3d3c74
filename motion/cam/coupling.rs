//! Cam coupling: a slave that follows a cam (`MC_CamTableSelect`, `MC_CamIn`, `MC_CamOut`, manual 4.6 and 5.4).
//!
//! With x = master · scaling + offset, both of the master, the slave is at scaling · y(x) + offset, both of the slave.
//! A periodic cam goes on as y(x + Offset1) + Offset2: in every pass Offset1 loses the width of the cam and Offset2
//! gains its rise (manual 4.6.2).

use super::knot::Derivatives;
use super::passage::{Lead, LookAhead, Move, Watch};
use super::selection::{CamInput, CamTable, StartMode};
use super::tappet::Tappet;
use super::unwrap::Unwrap;
use crate::coupling_output::check;
pub use crate::coupling_output::{Coupled, CouplingError, MAX_TRIGGERS, TappetData};
use crate::ramp_in::{RampIn, RampInLimits};
use twin_profile::State;

/// A slave on its cam, cycle by cycle.
#[doc(alias = "MC_CamIn")]
#[derive(Clone, Debug)]
pub struct CamCoupling {
    table: CamTable,
    input: CamInput,
    unwrap: Unwrap,
    /// Added to the master's position before it is scaled.
    master_shift: f64,
    /// Added to the slave's position at the end: where it was for relative starts, whole periods otherwise.
    slave_shift: f64,
    bridge: Option<RampIn>,
    watch: Watch,
    start_ns: i64,
    now_ns: i64,
    x: f64,
    /// Where tappets are looked for, on the scale of the cam, and where that began.
    ahead: LookAhead,
    began: f64,
    passes: f64,
    ended: bool,
    output: Coupled,
}

impl CamCoupling {
    /// Couples a slave to its master (`MC_CamIn`, rising edge of `Execute`); the first set-point is in
    /// [`Self::output`]. Offsets of a coupling before are forgotten.
    ///
    /// # Errors
    /// [`CouplingError`] if the master is off the cam (626), a ramp lacks its limits (627), or a value is not
    /// finite.
    pub fn start(
        table: CamTable,
        input: CamInput,
        master: &State,
        slave: &State,
        now_ns: i64,
    ) -> Result<Self, CouplingError> {
        check(master, "master")?;
        check(slave, "slave")?;
        input.check()?;
        let limits = match input.start_mode {
            StartMode::Absolute | StartMode::Relative => None,
            _ => Some(input.ramp_limits()?),
        };
        let master_shift = if table.master_absolute { 0.0 } else { -master.position };
        let x = (master.position + master_shift) * input.master_scaling + input.master_offset;
        let curve = table.cam.curve();
        if !curve.contains(x) {
            let (min, max) = (curve.start(), curve.end());
            return Err(CouplingError::MasterOutOfRange { master: x, min, max });
        }
        let watch = Watch::of(&table.cam, input.tappet_hysteresis, table.periodic);
        let unwrap = Unwrap::new(table.master_period, master.position);
        let (_, passes) = if table.periodic { curve.wrap(x) } else { (x, 0.0) };
        let relative = input.start_mode == StartMode::Relative || !table.slave_absolute;
        let velocity = master.velocity * input.master_scaling;
        let ahead = LookAhead::new(x, velocity, input.tappet_dead_time_s);
        let output = Coupled {
            slave: *slave,
            in_sync: false,
            end_of_profile: false,
            tappets: TappetData { now_ns, ..TappetData::default() },
        };
        let mut coupling = Self {
            table,
            input,
            unwrap,
            master_shift,
            slave_shift: if relative { slave.position } else { 0.0 },
            bridge: None,
            watch,
            start_ns: now_ns,
            now_ns,
            x,
            ahead,
            began: ahead.looked(),
            passes,
            ended: false,
            output,
        };
        if let Some(limits) = limits {
            coupling.lay_bridge(master, slave, &limits);
        }
        coupling.set_output(master);
        Ok(coupling)
    }

    /// Ramp-in from the slave's motion to the cam's motion.
    fn lay_bridge(&mut self, master: &State, slave: &State, limits: &RampInLimits) {
        let cam = self.on_cam(master);
        let velocity = slave.velocity - cam.velocity;
        let mut distance = cam.position - slave.position;
        if let Some(period) = self.table.slave_period.filter(|period| *period > 0.0) {
            let stop = limits.stop(velocity);
            let turns = match self.input.start_mode {
                // As far ahead as a slave that is too fast needs to stop, and less than a turn further.
                StartMode::RampInPositive => ((distance - stop.max(0.0)) / period).floor(),
                StartMode::RampInNegative => ((distance - stop.min(0.0)) / period).ceil(),
                _ => (distance / period).round(),
            };
            distance -= turns * period;
            self.slave_shift -= turns * period;
        }
        self.bridge = Some(RampIn::new(distance, velocity, limits));
    }

    /// Motion of the slave on the cam, without bridges.
    fn on_cam(&self, master: &State) -> State {
        let curve = self.table.cam.curve();
        let Derivatives { position, velocity, acceleration, .. } =
            if self.table.periodic { curve.repeated(self.x) } else { curve.at(self.x) };
        let CamInput { master_scaling, slave_scaling, slave_offset, .. } = self.input;
        let v = master.velocity * master_scaling;
        let a = master.acceleration * master_scaling;
        State {
            position: slave_scaling * position + slave_offset + self.slave_shift,
            velocity: slave_scaling * velocity * v,
            acceleration: slave_scaling * (acceleration * v * v + velocity * a),
        }
    }

    fn set_output(&mut self, master: &State) {
        let mut slave = self.on_cam(master);
        let mut in_sync = true;
        if let Some(bridge) = &self.bridge {
            #[expect(clippy::cast_precision_loss, reason = "a time since the start")]
            let seconds = self.now_ns.saturating_sub(self.start_ns) as f64 * 1e-9;
            let (left, velocity, acceleration, over) = bridge.at(seconds);
            slave.position -= left;
            slave.velocity += velocity;
            slave.acceleration += acceleration;
            in_sync = over;
            if over {
                self.bridge = None;
            }
        }
        self.output.slave = slave;
        self.output.in_sync = in_sync;
    }

    /// A cycle: the master as it is now.
    ///
    /// # Errors
    /// [`CouplingError::NotFinite`] if it is nowhere; nothing has changed then.
    pub fn step(&mut self, master: &State, now_ns: i64) -> Result<&Coupled, CouplingError> {
        check(master, "master")?;
        let (from, from_ns) = (self.x, self.now_ns);
        let position = self.unwrap.follow(master.position);
        let CamInput { master_scaling, master_offset, .. } = self.input;
        self.x = (position + self.master_shift) * master_scaling + master_offset;
        self.now_ns = now_ns;
        self.output.end_of_profile = self.passes_end(from);
        let velocity = master.velocity * master_scaling;
        let CamInput { tappet_dead_time_s, tappet_hysteresis, .. } = self.input;
        let by = Lead { dead_time_s: tappet_dead_time_s, hysteresis: tappet_hysteresis };
        let [from, to] = self.ahead.follow(self.x, velocity, by);
        let step = Move { from, to, from_ns, to_ns: now_ns };
        let mut tappets = TappetData { now_ns, ..TappetData::default() };
        let mut found = self.watch.passed(&step);
        for slot in &mut tappets.triggers {
            *slot = found.next();
        }
        tappets.lost = found.count();
        self.output.tappets = tappets;
        self.set_output(master);
        Ok(&self.output)
    }

    #[expect(clippy::float_cmp, reason = "counts of passes; an end that is stood on")]
    fn passes_end(&mut self, from: f64) -> bool {
        let curve = self.table.cam.curve();
        if self.table.periodic {
            let (_, passes) = curve.wrap(self.x);
            let changed = passes != self.passes;
            self.passes = passes;
            return changed;
        }
        let (start, end) = (curve.start(), curve.end());
        if self.x > end || self.x < start {
            self.ended = true;
        } else if self.x == end || self.x == start {
            // It has come here from inside, or has not left again.
            self.ended |= self.x != from;
        } else {
            self.ended = false;
        }
        self.ended
    }

    /// Output of the last cycle, or of the start.
    pub fn output(&self) -> &Coupled {
        &self.output
    }

    /// The cam it follows.
    pub fn table(&self) -> &CamTable {
        &self.table
    }

    /// Position of the master on the scale of the cam, passes included.
    pub fn place(&self) -> f64 {
        self.x
    }

    /// The tappets on which the master stood at the start: they have not been passed by that, and act when it comes to them again.
    pub fn stood_on(&self) -> impl Iterator<Item = &Tappet> {
        let curve = self.table.cam.curve();
        let seam = self.table.periodic.then(|| [curve.start(), curve.end()]);
        self.table.cam.tappets().iter().filter(move |tappet| tappet.is_at(self.began, seam))
    }

    /// Offset1 and Offset2 of the manual (4.6.2): the slave is at y(x + Offset1) + Offset2, before it is scaled.
    pub fn offsets(&self) -> (f64, f64) {
        let curve = self.table.cam.curve();
        (-self.passes * (curve.end() - curve.start()), self.passes * curve.rise())
    }

    /// Jump of the slave's set-points at the start, against its motion before: position (on a rotary slave the
    /// shortest), velocity and acceleration. Cams that are switched between have to match (manual 4.6.2).
    pub fn jump_from(&self, slave: &State) -> State {
        let mut position = self.output.slave.position - slave.position;
        if let Some(period) = self.table.slave_period.filter(|period| *period > 0.0) {
            position -= (position / period).round() * period;
        }
        State {
            position,
            velocity: self.output.slave.velocity - slave.velocity,
            acceleration: self.output.slave.acceleration - slave.acceleration,
        }
    }

    /// Lets the slave go (`MC_CamOut`): it moves on with this velocity, u/s.
    #[doc(alias = "MC_CamOut")]
    pub fn release(self) -> f64 {
        self.output.slave.velocity
    }
}

/// Position of a slave if it were coupled now (`SMC_GetCamSlaveSetPosition`, manual 5.5), ramps aside; nothing moves.
///
/// # Errors
/// As [`CamCoupling::start`].
#[doc(alias = "SMC_GetCamSlaveSetPosition")]
pub fn slave_set_position(
    table: CamTable,
    input: CamInput,
    master: &State,
    slave: &State,
) -> Result<f64, CouplingError> {
    let relative = input.start_mode == StartMode::Relative;
    let start_mode = if relative { StartMode::Relative } else { StartMode::Absolute };
    let coupling = CamCoupling::start(table, CamInput { start_mode, ..input }, master, slave, 0)?;
    Ok(coupling.output.slave.position)
}
