//! Invariants of random block sequences: one owner, legal states, limits, continuity, and one end of every execution.

mod alone;
mod called;
mod checker;
mod coupled;
mod direct;
mod faults;
mod in_pos;
mod legal;
mod on_cam;
mod random;
mod tables;

use super::*;
use alone::{rate, speed, way};
use called::{Begun, Called, Fault, Look, Owning, Watch, limited, moving, own};
use checker::{Checker, Promise, limits};
use coupled::Lead;
use legal::Keeper;
pub(super) use legal::is_arrow;
pub(super) use random::Random;
use std::fmt::Write as _;

/// Largest velocity of an axis, u/s; blocks are given half of it.
const FASTEST: f64 = 30.0;
/// Largest rate that a block is given, u/s²; on top of each other two of them.
const STEEPEST: f64 = 200.0;
const JERK: f64 = 2_000.0;

type Kind = (Movement, RampType);
type Blocks = Vec<Box<dyn Called>>;
type Checked = Result<(), String>;

/// Counts of executions that were done, aborted and failed.
type Seen = [u32; 3];

/// Change after a call, by its number, of the axis or of what the block has shown.
type Spoil<'a> = dyn FnMut(u32, &mut Axis, &mut Outputs) + 'a;

/// Ends that a block shows, in the same order.
fn ends(shown: Outputs) -> [bool; 3] {
    [shown.done, shown.command_aborted, shown.error.is_some()]
}

/// Disturbances.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Around {
    /// Now and then the program is not called for a cycle.
    Forgotten,
    /// Also the zero moves, the power fails, the drive has errors and captures positions.
    Everything,
    /// As the first, on an axis with software limits.
    Limits,
}

/// Software limits, u.
const WINDOW: [f64; 2] = [-40.0, 40.0];

/// Calls the blocks of an axis at random.
struct Run {
    random: Random,
    axis: Axis,
    drive: VirtualDrive,
    lead: Lead,
    blocks: Blocks,
    execute: Vec<bool>,
    reset: Reset,
    around: Around,
    without_power: u32,
    /// The block that has taken the axis in this cycle, and may have ended already.
    taker: Option<usize>,
    /// The block that has commanded the axis first in this cycle.
    first: Option<usize>,
    /// State in which a block has released the axis in this cycle.
    ended: Option<State>,
    /// Acceleration of a follower of the master's positions from the master's change of velocity, u/s².
    followed: f64,
    seen: Vec<Seen>,
    resets: u32,
    calls: u32,
}

impl Run {
    fn new(seed: u64, (movement, ramp): Kind, blocks: Blocks, around: Around) -> Self {
        let config = AxisConfig {
            movement,
            ramp,
            jerk: JERK,
            max_velocity: FASTEST,
            max_acceleration: STEEPEST,
            max_deceleration: STEEPEST,
            software_limits: (around == Around::Limits).then_some(WINDOW),
            ..AxisConfig::default()
        };
        let Rig { axis, drive, .. } = Rig::new(config);
        Self {
            random: Random(seed),
            axis,
            drive,
            lead: Lead::new(config),
            execute: vec![false; blocks.len()],
            seen: vec![[0; 3]; blocks.len()],
            blocks,
            reset: Reset::default(),
            around,
            without_power: 0,
            taker: None,
            first: None,
            ended: None,
            followed: 0.0,
            resets: 0,
            calls: 0,
        }
    }

    /// At least this number of block calls.
    fn calls(&mut self, calls: u32, spoil: &mut Spoil<'_>) -> Checked {
        let mut checker = Checker::new(&self.axis, self.blocks.len());
        while self.calls < calls {
            let before = self.lead.rig.axis.set_velocity();
            self.lead.cycle(&mut self.random);
            // A follower of the master's positions is steeper by this slope.
            let slope = if before == 0.0 { 0.0 } else { self.axis.set_velocity() / before };
            self.followed = (slope * (self.lead.rig.axis.set_velocity() - before)).abs() / CYCLE;
            self.cycle(&mut checker, spoil)
                .map_err(|what| format!("call {}: {what}", self.calls))?;
        }
        Ok(())
    }

    fn cycle(&mut self, checker: &mut Checker, spoil: &mut Spoil<'_>) -> Checked {
        let was_moving = self.mover();
        self.taker = None;
        self.first = None;
        self.ended = None;
        self.disturb();
        self.axis.begin_cycle(&self.drive.feedback());
        checker.states(&mut self.axis)?;
        self.without_power = self.without_power.saturating_sub(1);
        let power = Power { regulator_on: true, drive_start: true };
        power.call(self.without_power == 0, &mut self.axis);
        if self.around == Around::Everything && self.random.one_in(300) {
            let place = self.random.between(-50.0, 50.0);
            let relative = self.random.one_in(2);
            self.axis.shift_zero(place, relative).expect("a number");
        }
        // The master's zero moves, too, but not under an absolute cam, which makes its slave step.
        let steps = was_moving.map(|index| self.blocks[index].promise());
        if self.around == Around::Everything
            && self.random.one_in(300)
            && !matches!(steps, Some(Promise::OnCam { steps: true, .. }))
        {
            let place = self.random.between(0.0, 90.0);
            self.lead.rig.axis.shift_zero(place, false).expect("a number");
        }
        // Now and then a cycle without the program: error 30.
        let forgotten = self.random.one_in(600);
        if !forgotten {
            self.call_blocks(checker, spoil)?;
        }
        let in_error = self.axis.state() == AxisState::ErrorStop;
        self.resets += u32::from(self.reset.call(in_error && !forgotten, &mut self.axis).done);
        checker.states(&mut self.axis)?;
        self.drive.follow(&self.axis.end_cycle());
        self.keeps_the_end()?;
        let mover = self.mover().map(|index| self.blocks[index].name());
        checker.called(&mut self.axis, ("", true), mover)?;
        let owners: Vec<_> = self.blocks.iter().map(|block| block.owner()).collect();
        // A block that is not called does not notice the loss of the axis.
        let promise = self.promise(was_moving);
        let on_top = self.blocks.iter().find_map(|block| block.on_top());
        let on_top = on_top.unwrap_or(limits(0.0, 0.0, 0.0));
        let checked = checker.owned(&self.axis, &owners);
        let checked =
            checked.and_then(|()| checker.motion(&self.axis, promise, &on_top, self.followed));
        checked.map_err(|what| {
            let name = |index: Option<usize>| index.map_or("", |index| self.blocks[index].name());
            let [mover, before, taker] = [self.mover(), was_moving, self.taker].map(name);
            let (state, error) = (self.axis.state(), self.axis.error_id());
            format!("{what}, moved by {mover} after {before}, taken by {taker}, in {state:?} with {error:?}")
        })
    }

    /// A block that begins in the cycle in which another one ends goes on from there, but for direct set-points and cams.
    fn keeps_the_end(&self) -> Checked {
        let Some(ended) = self.ended else { return Ok(()) };
        let taker = self.taker.map_or("", |index| self.blocks[index].name());
        let elsewhere = ["Follow", "ControlAxis", "CamIn"].iter().any(|it| taker.contains(it));
        let left = [AxisState::ErrorStop, AxisState::PowerOff, AxisState::Homing];
        let on_top = self.axis.overlay_owner != 0;
        if elsewhere || on_top || left.contains(&self.axis.state()) {
            return Ok(());
        }
        let now = self.axis.total();
        let way = now.position - ended.position;
        if short(&self.axis, way).abs() > 1e-9 || now.velocity != 0.0 {
            return Err(format!("a block has ended at {ended:?}, {taker} makes it {now:?}"));
        }
        Ok(())
    }

    fn call_blocks(&mut self, checker: &mut Checker, spoil: &mut Spoil<'_>) -> Checked {
        let count = self.blocks.len();
        let often = 60 * u64::try_from(count).unwrap();
        for index in 0..count {
            let was = self.execute[index];
            let random = &mut self.random;
            if random.one_in(if was { 60 } else { often }) {
                self.execute[index] = !was;
                // Inputs of one that runs do not count.
                let other = usize::try_from(random.next()).unwrap() % count;
                for index in [index, other] {
                    self.blocks[index].change(random, &self.axis, &self.lead.rig.axis);
                }
            }
            let execute = self.execute[index];
            let block = &mut self.blocks[index];
            let owners = self.axis.values.owners;
            let was_owned = [self.axis.owner(), self.axis.overlay_owner];
            self.axis.commands = [0; 2];
            let mut shown = block.call(execute, random, &mut self.axis, &self.lead.rig.axis);
            if self.axis.commands[0] > 0 {
                self.first.get_or_insert(index);
            }
            let name = block.name();
            let watched = block.watch(shown, &self.axis, &self.lead.rig.axis);
            watched.map_err(|what| format!("{name}: {what}"))?;
            if self.axis.values.owners != owners && block.on_top().is_none() {
                self.taker = Some(index);
                self.ended = self.ended.filter(|_| self.axis.owner() != 0);
            }
            let nobody = self.axis.owner() == 0 && self.axis.overlay_owner == 0;
            if shown.done && was_owned[0] != 0 && nobody {
                self.ended = Some(self.axis.total());
            }
            self.calls += 1;
            spoil(self.calls, &mut self.axis, &mut shown);
            let owner = self.axis.owner();
            if block.moves() {
                let layer = usize::from(block.on_top().is_some());
                let has = [owner, self.axis.overlay_owner][layer];
                if shown.busy && (has == 0 || block.owner() != has) {
                    return Err(format!("{name}: is busy and does not have the axis"));
                }
                let owners = [was_owned[layer], owners, block.owner()];
                checker.commanded(name, layer, &self.axis, owners)?;
            }
            let mover = self.blocks.iter().find(|it| owner != 0 && it.owner() == owner);
            checker.called(&mut self.axis, (name, execute), mover.map(|it| it.name()))?;
            if legal::short(name) == "Stop" && shown.command_aborted {
                return Err("a stop is aborted".to_owned());
            }
            let before = checker.before(index);
            let checked = checker.block(index, name, execute && !was, shown);
            checked.map_err(|what| format!("{name}: {what}"))?;
            for end in 0..3 {
                let came = ends(shown)[end] && !ends(before)[end];
                self.seen[index][end] += u32::from(came);
            }
        }
        Ok(())
    }

    /// Disturbances by the drive.
    fn disturb(&mut self) {
        if self.around != Around::Everything {
            return;
        }
        let feedback = self.drive.feedback_mut();
        feedback.captured =
            (self.axis.capture.is_some() && self.random.one_in(50)).then_some(feedback.position);
        if self.random.one_in(3_000) {
            feedback.error = Some(7);
        }
        feedback.communicating = !self.random.one_in(3_000);
        if self.random.one_in(3_000) {
            self.without_power = 5;
        }
    }

    /// The block that moves the axis.
    fn mover(&self) -> Option<usize> {
        let owner = self.axis.owner();
        self.blocks.iter().position(|block| owner != 0 && block.owner() == owner)
    }

    /// Promise of the block that moves the axis in this cycle, or has ended in it.
    fn promise(&self, was_moving: Option<usize>) -> Promise {
        let of = |index: Option<usize>| index.map(|index| self.blocks[index].promise());
        let (before, now) = (of(was_moving), of(self.mover()));
        if before == Some(Promise::Nothing) {
            return Promise::Nothing;
        }
        if self.axis.braking.is_some() {
            return Promise::USUAL;
        }
        let promise = of(self.taker).or(now).or(before).unwrap_or(Promise::USUAL);
        // A cam takes over from where another block has moved the slave in this cycle, and who begins after the end of another one
        // goes on from there: the set-point is that of the other one.
        let cam = self.taker.is_some_and(|index| self.blocks[index].name().contains("CamIn"));
        let other = of(self.first.filter(|_| cam || self.ended.is_some()));
        match (promise, other) {
            (Promise::OnCam { rate, jerk, steps }, Some(Promise::Limits(other))) => {
                let rate = rate.max(other.acceleration).max(other.deceleration);
                Promise::OnCam { rate, jerk: jerk.max(other.jerk), steps }
            }
            (Promise::Limits(own), Some(Promise::Limits(other))) => {
                Promise::Limits(twin_profile::AxisLimits {
                    velocity: own.velocity.max(other.velocity),
                    acceleration: own.acceleration.max(other.acceleration),
                    deceleration: own.deceleration.max(other.deceleration),
                    jerk: own.jerk.max(other.jerk),
                })
            }
            _ => promise,
        }
    }
}

const LINEAR: Movement = Movement::Linear;
const ROTARY: Movement = Movement::Rotary { period: 90.0 };
const KINDS: [Kind; 6] = [
    (LINEAR, RampType::Trapezoid),
    (LINEAR, RampType::Sigmoid),
    (LINEAR, RampType::Parabolic),
    (ROTARY, RampType::Trapezoid),
    (ROTARY, RampType::Sigmoid),
    (ROTARY, RampType::Parabolic),
];

#[test]
fn random_moves_keep_what_has_to_hold() {
    for kind in KINDS {
        for seed in 0..8 {
            let mut run = Run::new(seed, kind, called::single(), Around::Forgotten);
            let found = run.calls(50_000, &mut |_, _, _| ());
            found.unwrap_or_else(|what| panic!("{kind:?} {seed}: {what}"));
            // Every kind of end occurs.
            let seen = [0, 1, 2].map(|end| run.seen.iter().map(|it| it[end]).sum::<u32>());
            assert!(seen[0] > 20 && seen[1] > 20 && seen[2] > 5, "{seen:?}");
            assert!(run.resets > 0);
        }
    }
}

/// Beyond its software limits an axis only brakes, also after resets there: 2.25 u from 30 u/s with 200 u/s², 3 u more until
/// the jerk allows it, and as much again for a remaining acceleration.
#[test]
fn random_moves_stay_within_the_software_limits() {
    for ramp in [RampType::Trapezoid, RampType::Sigmoid, RampType::Parabolic] {
        let mut beyond = 0;
        for seed in 0..8 {
            let mut run = Run::new(seed, (LINEAR, ramp), called::single(), Around::Limits);
            let found = run.calls(50_000, &mut |_, axis, _| {
                let place = axis.set_position();
                assert!(place.abs() < WINDOW[1] + 8.25, "{ramp:?} {seed}: {place}");
                beyond += u32::from(axis.error_id() == Some(10));
            });
            found.unwrap_or_else(|what| panic!("{ramp:?} {seed}: {what}"));
        }
        assert!(beyond > 100, "{beyond}");
    }
}

/// Gears, cams, direct set-points, homing, tables and probes as well, while the zero moves and power and drive fail.
#[test]
fn random_blocks_of_all_kinds_keep_what_has_to_hold() {
    let mut broken = String::new();
    for kind in KINDS {
        let mut sum: Vec<Seen> = Vec::new();
        for seed in 0..12 {
            let mut run = Run::new(seed, kind, called::all(), Around::Everything);
            if let Err(what) = run.calls(400_000, &mut |_, _, _| ()) {
                writeln!(broken, "{kind:?} {seed}: {what}").unwrap();
            }
            sum.resize(run.seen.len(), [0; 3]);
            for (sum, seen) in sum.iter_mut().flatten().zip(run.seen.iter().flatten()) {
                *sum += seen;
            }
        }
        for (block, seen) in called::all().iter().zip(&sum) {
            if seen.iter().zip(block.exceptions()).any(|(seen, never)| *seen == 0 && !never) {
                writeln!(broken, "{kind:?}: {}: {seen:?}", block.name()).unwrap();
            }
        }
    }
    assert!(broken.is_empty(), "{broken}");
}
