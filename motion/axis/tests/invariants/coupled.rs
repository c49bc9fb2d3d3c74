//! What slaves promise beside their states, and what is switched along the way.

use super::called::{Called, Moving};
use super::checker::Promise;
use super::random::Random;
use super::{CYCLE, JERK};
use crate::axis::profile::RampType;
use crate::axis::{
    Axis, CamIn, CamSwitch, DigitalCamSwitch, GearInPos, Master, Outputs, SwitchDirection, Track,
};
use crate::cam::{Action, Passage, Tappet, TappetValue};
use std::any::type_name;

/// Output 2 is output 0 so much later.
pub(super) const DELAY_CYCLES: usize = 10;

/// Output 0 between 10 and 30 u, output 1 masked, output 2 as output 0 but later.
pub(super) fn switches() -> DigitalCamSwitch {
    let direction = SwitchDirection::Both;
    let [first_on, last_on] = [10.0, 30.0];
    let switch = |track| CamSwitch { track, first_on, last_on, direction, duration: None };
    let mut tracks = [Track::default(); 32];
    // Half a cycle less, so that no rounding moves it into the next one.
    let later = 9.5 * CYCLE;
    (tracks[2].on_compensation, tracks[2].off_compensation) = (later, later);
    let mut block = DigitalCamSwitch::new(&[1, 2, 3].map(switch), tracks);
    block.enable_mask = !0b10;
    block
}

/// [`CYCLE`], ns.
const CYCLE_NS: i64 = 10_000_000;

/// How long a pulse of a tappet is from its passage to its end, ns.
const PULSE_NS: i64 = 50_000_000;

/// Of group 1 pulses, of group 2 everything else.
pub(super) fn tappets(random: &mut Random) -> Vec<Tappet> {
    let timed = Action::Timed { delay_ns: 20_000_000, duration_ns: PULSE_NS - 20_000_000 };
    let tappet = |random: &mut Random, group, action| Tappet {
        group,
        master: random.between(0.0, 90.0),
        passage: random.one_of(&[Passage::Positive, Passage::Negative, Passage::Every]),
        action,
    };
    let other = random.one_of(&[Action::On, Action::Off, Action::Invert]);
    vec![tappet(random, 1, timed), tappet(random, 1, timed), tappet(random, 2, other)]
}

/// A cam with what its tappets switch.
pub(super) struct OnCam {
    pub(super) moving: Moving<CamIn>,
    value: TappetValue,
    /// When a pulse was begun last.
    begun_ns: i64,
    /// Who ramps onto the cam, and how much faster than that it is.
    ramp: Option<(i64, f64, f64)>,
}

impl OnCam {
    pub(super) fn new(moving: Moving<CamIn>) -> Self {
        Self { moving, value: TappetValue::new(1, false, false), begun_ns: 0, ramp: None }
    }

    /// Tappets act in the cycle that tells of them, and no pulse hangs.
    fn see_tappets(&mut self, axis: &Axis) -> Result<(), String> {
        let Some(run) = self.moving.block.running() else { return Ok(()) };
        let data = &run.coupling().output().tappets;
        let now = axis.now_ns();
        if data.now_ns != now {
            return Err(format!("tappets of {} at {now}", data.now_ns));
        }
        let mut before = i64::MIN;
        for trigger in data.triggers() {
            let time = trigger.time_ns;
            if time < before || time > now || time < now - CYCLE_NS - 1 {
                return Err(format!("{trigger:?} at {now}, after {before}"));
            }
            before = time;
            if trigger.group == 1 {
                self.begun_ns = time;
            }
        }
        let on = self.value.step(data);
        // A pulse is shown for a cycle at least, and one that ended while nobody looked until somebody does.
        if on && now > self.begun_ns + PULSE_NS + 2 * CYCLE_NS {
            return Err(format!("a pulse of {} is still there at {now}", self.begun_ns));
        }
        Ok(())
    }

    /// On the cam it moves as the cam does (manual 4.6.1: scaling · y(x)), beside it no faster than the ramp may.
    fn see_motion(&mut self, axis: &Axis, master: &Axis) -> Result<(), String> {
        /// Of a rise of 20 u over 40 u between rests: 15/8 and 10/√3 of what a straight line has.
        const STEEPEST: [f64; 2] = [0.9375, 0.072_169];
        let before = self.ramp.take();
        let owner = self.moving.owner();
        let Some(run) = self.moving.block.running().filter(|_| owner == axis.owner()) else {
            return Ok(());
        };
        let (coupling, input) = (run.coupling(), &self.moving.taken.input);
        let Master { velocity, acceleration, .. } = Master::of(master);
        let (scaling, of_master) = (input.slave_scaling, input.master_scaling);
        let (v, a) = (velocity * of_master, acceleration * of_master);
        let curve = coupling.table().cam.curve();
        let x = coupling.place();
        let at = if coupling.table().periodic { curve.repeated(x) } else { curve.at(x) };
        let expected = scaling * at.velocity * v;
        let bent = scaling * (at.acceleration * v * v + at.velocity * a);
        let [steep, curved] = STEEPEST;
        if expected.abs() > scaling.abs() * steep * v.abs() + 1e-9
            || bent.abs() > scaling.abs() * (curved * v * v + steep * a.abs()) + 1e-9
        {
            return Err(format!("a cam of {expected} u/s and {bent} u/s² under {v} and {a}"));
        }
        let (faster, more) = (axis.base.velocity - expected, axis.base.acceleration - bent);
        if run.is_in_sync() {
            return if faster.abs() > 1e-6 || more.abs() > 1e-4 {
                Err(format!("in step, but {faster} u/s and {more} u/s² beside the cam"))
            } else {
                Ok(())
            };
        }
        let limited = axis.ramp() != RampType::Trapezoid;
        if let Some((_, last, rate)) = before.filter(|(who, ..)| *who == owner) {
            let settling = if limited { 0.5 * rate * rate / JERK } else { 0.0 };
            let most = input.velocity_difference.max(last.abs() + settling);
            if faster.abs() > most * (1.0 + 1e-9) + 1e-6 {
                return Err(format!("{faster} u/s beside the cam after {last}, allowed {most}"));
            }
        }
        self.ramp = Some((owner, faster, more));
        Ok(())
    }
}

impl Called for OnCam {
    fn call(
        &mut self,
        execute: bool,
        random: &mut Random,
        axis: &mut Axis,
        master: &Axis,
    ) -> Outputs {
        self.moving.call(execute, random, axis, master)
    }

    fn watch(&mut self, _: Outputs, axis: &Axis, master: &Axis) -> Result<(), String> {
        self.see_tappets(axis)?;
        self.see_motion(axis, master)
    }

    fn change(&mut self, random: &mut Random, axis: &Axis, master: &Axis) {
        self.moving.change(random, axis, master);
    }

    fn name(&self) -> &'static str {
        type_name::<CamIn>()
    }

    fn owner(&self) -> i64 {
        self.moving.owner()
    }

    fn promise(&self) -> Promise {
        self.moving.promise()
    }
}

/// A gear with a place to be in step at: from there on it is as fast as its ratio says.
pub(super) struct InPos(pub(super) Moving<GearInPos>);

impl Called for InPos {
    fn call(
        &mut self,
        execute: bool,
        random: &mut Random,
        axis: &mut Axis,
        master: &Axis,
    ) -> Outputs {
        self.0.call(execute, random, axis, master)
    }

    fn watch(&mut self, shown: Outputs, axis: &Axis, master: &Axis) -> Result<(), String> {
        let GearInPos { ratio_numerator, ratio_denominator, .. } = self.0.taken;
        let ratio = f64::from(ratio_numerator) / f64::from(ratio_denominator);
        let expected = ratio * Master::of(master).velocity;
        let faster = axis.base.velocity - expected;
        if shown.done && shown.busy && faster.abs() > 1e-6 {
            return Err(format!("in step, but {faster} u/s beside {expected}"));
        }
        Ok(())
    }

    fn change(&mut self, random: &mut Random, axis: &Axis, master: &Axis) {
        self.0.change(random, axis, master);
    }

    fn name(&self) -> &'static str {
        type_name::<GearInPos>()
    }

    fn owner(&self) -> i64 {
        self.0.owner()
    }

    fn promise(&self) -> Promise {
        self.0.promise()
    }
}
