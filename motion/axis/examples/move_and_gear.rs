//! A master that moves to a position (`MC_MoveAbsolute`) and a slave geared to it (`MC_GearIn`).
//!
//! ```text
//! cargo run -p twin-axis --example move_and_gear
//! ```

use std::error::Error;
use twin_axis::{
    Axis, AxisConfig, Block, Direction, GearIn, Master, MoveAbsolute, Power, VirtualDrive,
};

/// Cycle time, s.
const CYCLE: f64 = 0.001;
/// Target of the master, mm.
const TARGET: f64 = 90.0;

fn main() -> Result<(), Box<dyn Error>> {
    let config = AxisConfig { cycle: CYCLE, ..AxisConfig::default() };
    let mut master = Axis::new(config);
    let mut slave = Axis::new(AxisConfig { drive_id: 1, ..config });
    let mut drives = [VirtualDrive::new(0.0), VirtualDrive::new(0.0)];
    let power = Power { regulator_on: true, drive_start: true };
    // 90 mm at 60 mm/s and 300 mm/s²: 1.5 s + 0.2 s.
    let mut move_absolute = Block::new(MoveAbsolute {
        position: TARGET,
        velocity: 60.0,
        acceleration: 300.0,
        deceleration: 300.0,
        direction: Direction::Positive,
    });
    // One millimetre of the slave for three of the master.
    let mut gear = Block::new(GearIn {
        ratio_numerator: 1,
        ratio_denominator: 3,
        acceleration: 1000.0,
        deceleration: 1000.0,
    });

    let (mut begun, mut done) = (None, None);
    for cycle in 0_u32..4000 {
        master.begin_cycle(&drives[0].feedback());
        slave.begin_cycle(&drives[1].feedback());
        let powered = [&mut master, &mut slave].map(|axis| power.call(true, axis).status);
        // The slave is coupled while the master is still at rest.
        let coupled = gear.call_with(powered[1], &mut slave, Master::of(&master));
        let moved = move_absolute.call(powered[0] && coupled.done, &mut master);
        if let Some(error) = moved.error.or(coupled.error) {
            return Err(error.into());
        }
        begun = begun.or(moved.busy.then_some(cycle));
        done = done.or(moved.done.then_some(cycle));
        drives[0].follow(&master.end_cycle());
        drives[1].follow(&slave.end_cycle());
    }

    let (Some(begun), Some(done)) = (begun, done) else { return Err("no end of the move".into()) };
    let duration = f64::from(done - begun) * CYCLE;
    println!("master: {:.3} mm after {duration:.3} s", master.act_position());
    println!("slave:  {:.3} mm, ratio 1:3", slave.act_position());
    assert!((duration - 1.7).abs() <= 2.0 * CYCLE);
    assert!((master.act_position() - TARGET).abs() <= 1e-9);
    assert!((slave.act_position() - TARGET / 3.0).abs() <= 1e-9);
    Ok(())
}
