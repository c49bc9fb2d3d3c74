//! Random slaves: gears and cams behind a master that moves at random.

use super::in_pos::InPos;
use super::on_cam::OnCam;
use super::*;

/// Behind a [`Lead`].
pub(super) fn all() -> Blocks {
    vec![
        limited(
            |it: &GearIn, begun| {
                let ratio = f64::from(it.ratio_numerator) / f64::from(it.ratio_denominator);
                // In gear it does what the master does, in whatever direction.
                let most = it.acceleration.max(it.deceleration).max(60.0 * ratio.abs());
                let own_rates = [it.acceleration, it.deceleration];
                let [up, down] = if begun.done { [most; 2] } else { own_rates };
                own(10.0 * ratio.abs(), up, down)
            },
            |random, _, _| GearIn {
                ratio_numerator: random.one_of(&[-3, -2, -1, 0, 1, 2, 3]),
                ratio_denominator: random.one_of(&[2, 2, 3, 5, 0]),
                acceleration: rate(random),
                deceleration: rate(random),
            },
        ),
        limited(
            |it: &Phasing, _| {
                // What falls in the shift may grow in the sum.
                let rate = it.acceleration.max(it.deceleration) + 60.0;
                let sum = limits(it.velocity + 10.0, rate, rate);
                Promise::Limits(AxisLimits { jerk: 1.5 * JERK, ..sum })
            },
            |random, _, _| Phasing {
                phase_shift: way(random),
                velocity: random.between(0.1, 5.0),
                acceleration: rate(random).min(100.0),
                deceleration: rate(random).min(100.0),
            },
        ),
        gear_in_pos(Fault::default()),
        cam_in(Fault::default()),
        // One more, so that cams are switched between.
        cam_in(Fault::default()),
        // On with whatever velocity there was; an acceleration takes its time.
        limited(|_, begun| own(begun.from.velocity.abs(), STEEPEST, STEEPEST), |_, _, _| Decouple),
    ]
}

pub(super) fn gear_in_pos(fault: Fault<GearInPos>) -> Box<dyn Called> {
    // Until it is coupled its motion goes on.
    Box::new(moving(|_, _| own(0.0, 0.0, 0.0), gear, fault, InPos::default()))
}

pub(super) fn cam_in(fault: Fault<CamIn>) -> Box<dyn Called> {
    let inputs =
        |random: &mut _, _: &_, _: &_| CamIn { table: table(random), input: cam_input(random) };
    Box::new(moving(on_cam, inputs, fault, OnCam::new()))
}

/// A gear with a place, ahead of the master.
fn gear(random: &mut Random, axis: &Axis, master: &Axis) -> GearInPos {
    let sign = if master.set_velocity() < 0.0 { -1.0 } else { 1.0 };
    GearInPos {
        ratio_numerator: random.one_of(&[-3, -1, 1, 2, 3]),
        ratio_denominator: random.one_of(&[1, 2, 5, 0]),
        master_sync_position: master.set_position() + sign * random.between(2.0, 30.0),
        slave_sync_position: axis.set_position() + way(random),
        master_start_distance: random.one_of(&[0.0, 5.0, 20.0]),
    }
}

/// The cam itself has at most 0.94·1500 u/s³ of the master's jerk, 3·0.072·15·90 of its velocity and acceleration and
/// 0.019·15³ of its velocity alone, 1762 u/s³ together; the ramp adds the axis's jerk. The cam's acceleration is at most
/// 0.94·90 of the master's and 0.072·15² of its velocity, 101 u/s²; the ramp adds its own, and at first the slave's.
fn on_cam(it: &CamIn, begun: &Begun) -> Promise {
    const OF_CAM: f64 = 101.0;
    let CamIn { table, input } = it;
    let ramp = input.acceleration.max(input.deceleration);
    let rate = OF_CAM + ramp.max(begun.from.acceleration.abs() + OF_CAM);
    let steps = table.as_ref().is_some_and(|table| table.master_absolute);
    Promise::OnCam { rate, jerk: JERK + 1762.0, steps }
}

fn table(random: &mut Random) -> Option<CamTable> {
    let knots = [(0.0, 0.0), (40.0, way(random)), (90.0, 0.0)].map(|(x, y)| Knot::at_rest(x, y));
    let table = cam(&knots, on_cam::tappets(random));
    let table = CamTable {
        periodic: random.one_in(2),
        master_absolute: random.one_in(2),
        slave_absolute: random.one_in(2),
        ..table
    };
    (!random.one_in(20)).then_some(table)
}

fn cam_input(random: &mut Random) -> CamInput {
    // The other two are allowed to jump.
    let modes = [StartMode::RampIn, StartMode::RampInPositive, StartMode::RampInNegative];
    CamInput {
        master_scaling: random.between(0.5, 1.5),
        slave_offset: way(random),
        slave_scaling: random.between(-1.0, 1.0),
        start_mode: random.one_of(&modes),
        velocity_difference: speed(random),
        acceleration: rate(random),
        deceleration: rate(random),
        tappet_hysteresis: random.one_of(&[0.0, 2.0]),
        ..CamInput::default()
    }
}

/// An axis that is led about, for others to follow: at most 10 u/s and 60 u/s².
pub(super) struct Lead {
    pub(super) rig: Rig,
    to: Block<MoveAbsolute>,
    on: Block<MoveVelocity>,
    halt: Block<Halt>,
    which: usize,
}

impl Lead {
    pub(super) fn new(config: AxisConfig) -> Self {
        let (acceleration, deceleration) = (60.0, 60.0);
        let to = MoveAbsolute { acceleration, deceleration, ..to(30.0).inputs };
        let on = MoveVelocity { acceleration, deceleration, ..endless(10.0).inputs };
        let rig = Rig::new(AxisConfig { jerk: 0.5 * JERK, ..config });
        let halt = Block::new(Halt { deceleration });
        Self { rig, to: Block::new(to), on: Block::new(on), halt, which: 0 }
    }

    pub(super) fn cycle(&mut self, random: &mut Random) {
        let Self { rig, to, on, halt, which } = self;
        let changes = random.one_in(150);
        if changes {
            *which = random.one_of(&[0, 1, 1, 2]);
            to.inputs.position = random.between(0.0, 90.0);
            to.inputs.direction = random.direction();
            on.inputs.velocity = random.between(0.0, 10.0);
            on.inputs.direction = random.one_of(&[Direction::Positive, Direction::Negative]);
        }
        // Old ones are called until they say so; the new one begins the cycle after.
        let execute = [0, 1, 2].map(|index| index == *which && !changes);
        rig.cycle(|axis| {
            to.call(execute[0], axis);
            on.call(execute[1], axis);
            halt.call(execute[2], axis);
        });
    }
}
