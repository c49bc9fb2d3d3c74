//! Random sequences of blocks keep what always has to hold: one owner, legal states, limits, continuous motion, and
//! every beginning of a block coming to exactly one end.

use super::rig::CYCLE;
use crate::axis::profile::RampType;
use crate::axis::{
    Axis, AxisConfig, AxisState, Block, Direction, Halt, MoveAbsolute, MoveAdditive, MoveRelative,
    MoveSuperImposed, MoveVelocity, Movement, Outputs, Power, Reset, Stop, VirtualDrive,
};

/// Calls of blocks to each axis, at least.
const CALLS: u32 = 50_000;
/// Largest velocity that a block, or two on top of each other, are given, u/s.
const FASTEST: f64 = 30.0;
/// Largest rate that a block is given, u/s²; on top of each other two of them.
const STEEPEST: f64 = 200.0;
const JERK: f64 = 2_000.0;

/// Numbers that only look random: the same in every run (splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut it = self.0;
        it = (it ^ (it >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        it = (it ^ (it >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        it ^ (it >> 31)
    }

    /// In [from, to).
    fn between(&mut self, from: f64, to: f64) -> f64 {
        let part = u32::try_from(self.next() >> 32).unwrap();
        from + (to - from) * f64::from(part) / (f64::from(u32::MAX) + 1.0)
    }

    fn one_in(&mut self, count: u64) -> bool {
        self.next().is_multiple_of(count)
    }
}

/// One begun execution of a block, from its edge on.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    open: bool,
    reached: bool,
    before: Outputs,
    ends: u32,
}

/// What has to hold, cycle after cycle.
#[derive(Debug)]
struct Checker {
    movement: Movement,
    ramp: RampType,
    state: AxisState,
    position: f64,
    velocity: f64,
    acceleration: f64,
    tallies: Vec<Tally>,
}

impl Checker {
    fn new(axis: &Axis, blocks: usize) -> Self {
        Self {
            movement: axis.movement(),
            ramp: axis.ramp(),
            state: axis.state(),
            position: axis.set_position(),
            velocity: 0.0,
            acceleration: 0.0,
            tallies: vec![Tally::default(); blocks],
        }
    }

    /// What a block shows.
    fn block(&mut self, index: usize, rising: bool, shown: Outputs) -> Result<(), String> {
        let tally = &mut self.tallies[index];
        let shows = [shown.done, shown.command_aborted, shown.error.is_some()];
        if shows.iter().filter(|it| **it).count() > 1 {
            return Err(format!("block {index} shows {shown:?} at once"));
        }
        if rising {
            *tally = Tally { open: true, ..Tally::default() };
        }
        let came = (shown.done && (rising || !tally.before.done))
            || (shown.command_aborted && (rising || !tally.before.command_aborted))
            || (shown.error.is_some() && (rising || tally.before.error.is_none()));
        if came {
            let reached_only = shown.done && shown.busy;
            if !tally.open {
                return Err(format!("block {index} ends twice: {shown:?}"));
            }
            if reached_only {
                if tally.reached {
                    return Err(format!("block {index} reaches its velocity twice"));
                }
                tally.reached = true;
            } else {
                tally.open = false;
                tally.ends += 1;
            }
        }
        if shown.busy && !tally.open {
            return Err(format!("block {index} is busy after its end"));
        }
        tally.before = shown;
        Ok(())
    }

    /// What the axis does in this cycle; `owners` blocks say that they move it.
    fn cycle(&mut self, axis: &Axis, owners: &[i64]) -> Result<(), String> {
        // States: every step of this cycle is a way of the diagram (two of them at most).
        let legal = self.state.leads_to(axis.state())
            || self.state == axis.state()
            || AxisState::ALL
                .iter()
                .any(|via| self.state.leads_to(*via) && via.leads_to(axis.state()));
        if !legal {
            return Err(format!("{:?} to {:?}", self.state, axis.state()));
        }
        // Owners: those who think they move it are the one that does.
        let claims = owners.iter().filter(|owner| axis.owner() == **owner && **owner != 0).count();
        if claims > 1 || (axis.owner() != 0) != (claims == 1) {
            return Err(format!("{claims} blocks own {}", axis.owner()));
        }
        if axis.owner() != 0 && !(axis.state().is_motion() || axis.state() == AxisState::Stopping) {
            return Err(format!("{} moves it in {:?}", axis.owner(), axis.state()));
        }
        self.motion(axis)?;
        self.state = axis.state();
        Ok(())
    }

    /// Continuous, and within the limits.
    fn motion(&mut self, axis: &Axis) -> Result<(), String> {
        let (position, velocity) = (axis.set_position(), axis.set_velocity());
        let acceleration = axis.set_acceleration();
        let way = position - self.position;
        let way = match self.movement {
            Movement::Linear => way,
            Movement::Rotary { period } => {
                if !(0.0..period).contains(&position) {
                    return Err(format!("{position} is outside the period"));
                }
                way - period * (way / period).round()
            }
        };
        // Block and block on top have half the velocity each.
        if velocity.abs() > FASTEST * (1.0 + 1e-9) {
            return Err(format!("{velocity} u/s"));
        }
        let rate = 2.0 * STEEPEST;
        if acceleration.abs() > rate * (1.0 + 1e-9) {
            return Err(format!("{acceleration} u/s²"));
        }
        // No step of the position: the way is the mean velocity's, but for what the rate can add.
        let mean = 0.5 * (velocity + self.velocity) * CYCLE;
        if (way - mean).abs() > 0.25 * rate * CYCLE * CYCLE + 1e-9 {
            return Err(format!("a way of {way} with {velocity} after {} u/s", self.velocity));
        }
        let change = (velocity - self.velocity).abs();
        if change > rate * CYCLE * (1.0 + 1e-9) {
            return Err(format!("{velocity} after {} u/s", self.velocity));
        }
        if self.ramp == RampType::Parabolic {
            let change = (acceleration - self.acceleration).abs();
            // Two motions on top of each other have the jerk each.
            if change > 2.0 * JERK * CYCLE * (1.0 + 1e-6) {
                return Err(format!("{acceleration} after {} u/s²", self.acceleration));
            }
        }
        (self.position, self.velocity, self.acceleration) = (position, velocity, acceleration);
        Ok(())
    }
}

/// The blocks, with Execute of each.
struct Blocks {
    absolute: Block<MoveAbsolute>,
    relative: Block<MoveRelative>,
    additive: Block<MoveAdditive>,
    velocity: Block<MoveVelocity>,
    halt: Block<Halt>,
    stop: Block<Stop>,
    on_top: MoveSuperImposed,
    execute: [bool; 7],
}

impl Blocks {
    fn new() -> Self {
        let (velocity, acceleration, deceleration) = (1.0, 1.0, 1.0);
        let (distance, direction) = (0.0, Direction::Shortest);
        Self {
            absolute: Block::new(MoveAbsolute {
                position: 0.0,
                velocity,
                acceleration,
                deceleration,
                direction,
            }),
            relative: Block::new(MoveRelative { distance, velocity, acceleration, deceleration }),
            additive: Block::new(MoveAdditive { distance, velocity, acceleration, deceleration }),
            velocity: Block::new(MoveVelocity { velocity, acceleration, deceleration, direction }),
            halt: Block::new(Halt { deceleration }),
            stop: Block::new(Stop { deceleration }),
            on_top: MoveSuperImposed::new(distance, velocity, acceleration, deceleration),
            execute: [false; 7],
        }
    }

    /// Other inputs for all of them, now and then wrong ones.
    fn change(&mut self, random: &mut Random) {
        let mut rate = || {
            if random.one_in(50) { 0.0 } else { random.between(0.2 * STEEPEST, STEEPEST) }
        };
        let [a, d, e, f] = [rate(), rate(), rate(), rate()];
        let speed = random.between(0.1, 0.5 * FASTEST);
        let distance = random.between(-20.0, 20.0);
        let directions = [
            Direction::Negative,
            Direction::Shortest,
            Direction::Positive,
            Direction::Current,
            Direction::Fastest,
        ];
        let index = usize::try_from(random.next() % 5).unwrap();
        let direction = directions[index];
        let position = random.between(0.0, 90.0);
        self.absolute.inputs =
            MoveAbsolute { position, velocity: speed, acceleration: a, deceleration: d, direction };
        self.relative.inputs =
            MoveRelative { distance, velocity: speed, acceleration: d, deceleration: a };
        self.additive.inputs =
            MoveAdditive { distance, velocity: speed, acceleration: e, deceleration: a };
        self.velocity.inputs =
            MoveVelocity { velocity: speed, acceleration: e, deceleration: f, direction };
        self.halt.inputs.deceleration = e;
        self.stop.inputs.deceleration = f;
        self.on_top.distance = distance * 0.3;
        self.on_top.velocity_diff = random.between(0.1, 0.5 * FASTEST);
        (self.on_top.acceleration, self.on_top.deceleration) = (a, e);
    }

    fn call(&mut self, index: usize, axis: &mut Axis) -> Outputs {
        let execute = self.execute[index];
        match index {
            0 => self.absolute.call(execute, axis),
            1 => self.relative.call(execute, axis),
            2 => self.additive.call(execute, axis),
            3 => self.velocity.call(execute, axis),
            4 => self.halt.call(execute, axis),
            5 => self.stop.call(execute, axis),
            _ => self.on_top.call(execute, axis),
        }
    }

    fn owners(&self) -> [i64; 6] {
        [
            self.absolute.owner(),
            self.relative.owner(),
            self.additive.owner(),
            self.velocity.owner(),
            self.halt.owner(),
            self.stop.owner(),
        ]
        .map(Option::unwrap_or_default)
    }
}

/// How often each kind of end came, and how many calls there were.
#[derive(Debug, Default)]
struct Seen {
    done: u32,
    aborted: u32,
    failed: u32,
    resets: u32,
}

/// Calls the blocks of an axis at random; `spoil` may break a rule on the way.
fn run(
    seed: u64,
    movement: Movement,
    ramp: RampType,
    mut spoil: impl FnMut(u32, &mut Axis, &mut Outputs),
) -> Result<Seen, String> {
    let mut random = Random(seed);
    let mut axis = Axis::new(AxisConfig {
        movement,
        ramp,
        cycle: CYCLE,
        jerk: JERK,
        max_velocity: FASTEST,
        max_acceleration: STEEPEST,
        max_deceleration: STEEPEST,
        ..AxisConfig::default()
    });
    let mut drive = VirtualDrive::new(0.0);
    let power = Power { regulator_on: true, drive_start: true };
    for _ in 0..3 {
        axis.begin_cycle(&drive.feedback());
        power.call(true, &mut axis);
        drive.follow(&axis.end_cycle());
    }
    let (mut blocks, mut reset) = (Blocks::new(), Reset::default());
    let mut checker = Checker::new(&axis, blocks.execute.len());
    let (mut seen, mut calls) = (Seen::default(), 0);
    while calls < CALLS {
        axis.begin_cycle(&drive.feedback());
        power.call(true, &mut axis);
        // Now and then a cycle without the program: error 30.
        let forgotten = random.one_in(400);
        // The one on top is called last, as the manual has it.
        for index in 0..blocks.execute.len() {
            if forgotten {
                break;
            }
            let was = blocks.execute[index];
            if random.one_in(if was { 60 } else { 100 }) {
                blocks.execute[index] = !was;
                blocks.change(&mut random);
            }
            let mut shown = blocks.call(index, &mut axis);
            calls += 1;
            spoil(calls, &mut axis, &mut shown);
            let before = checker.tallies[index].before;
            checker
                .block(index, blocks.execute[index] && !was, shown)
                .map_err(|what| format!("call {calls}: {what}"))?;
            seen.done += u32::from(shown.done && !before.done);
            seen.aborted += u32::from(shown.command_aborted && !before.command_aborted);
            seen.failed += u32::from(shown.error.is_some() && before.error.is_none());
        }
        let in_error = axis.state() == AxisState::ErrorStop;
        seen.resets += u32::from(reset.call(in_error && !forgotten, &mut axis).done);
        drive.follow(&axis.end_cycle());
        let owners = blocks.owners();
        // A block that is not called does not know yet that it has lost the axis.
        checker.cycle(&axis, &owners).map_err(|what| format!("call {calls}: {what}"))?;
    }
    Ok(seen)
}

const KINDS: [(Movement, RampType); 6] = [
    (Movement::Linear, RampType::Trapezoid),
    (Movement::Linear, RampType::Sigmoid),
    (Movement::Linear, RampType::Parabolic),
    (Movement::Rotary { period: 90.0 }, RampType::Trapezoid),
    (Movement::Rotary { period: 90.0 }, RampType::Sigmoid),
    (Movement::Rotary { period: 90.0 }, RampType::Parabolic),
];

#[test]
fn random_sequences_keep_what_has_to_hold() {
    for (movement, ramp) in KINDS {
        for seed in 0..8 {
            let seen = run(seed, movement, ramp, |_, _, _| ());
            let seen = seen.unwrap_or_else(|what| panic!("{movement:?} {ramp:?} {seed}: {what}"));
            // It is no proof if nothing happens.
            assert!(seen.done > 20 && seen.aborted > 20 && seen.failed > 5, "{seen:?}");
            assert!(seen.resets > 0, "{seen:?}");
        }
    }
}

#[test]
fn the_checker_sees_what_is_broken() {
    type Spoil = fn(u32, &mut Axis, &mut Outputs);
    let spoils: [(&str, Spoil); 8] = [
        ("position", |call, axis, _| {
            if call > 5_000 {
                axis.base.position += 0.05;
            }
        }),
        ("velocity", |call, axis, _| {
            if call == 5_000 {
                axis.base.velocity += 5.0;
                axis.show_set_values();
            }
        }),
        ("limit", |call, axis, _| {
            if call > 5_000 {
                axis.base.velocity = 31.0;
            }
        }),
        ("acceleration", |call, axis, _| {
            if call > 5_000 {
                axis.base.acceleration = 401.0;
            }
        }),
        ("owner", |call, axis, _| {
            if call > 5_000 {
                axis.values.owner = 77_777;
            }
        }),
        ("state", |call, axis, _| {
            if call > 5_000 && axis.owner() == 0 {
                axis.values.owner = 0;
                axis.enter(AxisState::Homing);
            }
        }),
        ("done twice", |call, _, shown| {
            shown.done |= call % 3_001 == 0;
        }),
        ("two at once", |_, _, shown| {
            shown.command_aborted |= shown.done;
        }),
    ];
    for (what, spoil) in spoils {
        let (movement, ramp) = KINDS[0];
        let found = (0..8).any(|seed| run(seed, movement, ramp, spoil).is_err());
        assert!(found, "nobody sees a wrong {what}");
    }
}
