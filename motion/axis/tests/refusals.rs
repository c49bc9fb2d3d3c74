//! Tests of the errors that blocks show for wrong inputs, by the manual's numbers (9.3).

use super::*;

/// A call of a block with Execute, a master and its axis, both at rest at 0.
type Call = Box<dyn Fn(&Axis, &mut Axis) -> Outputs>;

fn alone<M: Motion<With = ()> + Clone + 'static>(inputs: M) -> Call {
    Box::new(move |_, axis| Block::new(inputs.clone()).call(true, axis))
}

fn behind<M: Motion<With = Master> + Clone + 'static>(inputs: M) -> Call {
    Box::new(move |master, axis| Block::new(inputs.clone()).follow(true, master, axis))
}

fn on_cam(input: CamInput) -> Call {
    behind(cam_in(straight(100.0, 0.5), input).inputs)
}

#[test]
fn every_block_refuses_wrong_inputs_with_its_own_number() {
    let absolute = past_5(4.0, Direction::Positive);
    let relative = MoveContinuousRelative {
        distance: 5.0,
        velocity: 10.0,
        end_velocity: 4.0,
        end_velocity_direction: Direction::Positive,
        acceleration: 100.0,
        deceleration: 100.0,
    };
    let (shortest, fastest) = (Direction::Shortest, Direction::Fastest);
    let (geared, shifted) = (gear(1, 1).inputs, phasing(-7.0, 0.0, 40.0).inputs);
    let input = CamInput::default();
    let rows: [(u16, Call); 21] = [
        (226, alone(MoveRelative { acceleration: 0.0, ..by(1.0).inputs })),
        (251, alone(MoveAdditive { acceleration: f64::NAN, ..add(1.0).inputs })),
        (276, Box::new(|_, axis| on_top(1.0, -1.0, 100.0).call(true, axis))),
        (181, alone(Stop { deceleration: 0.0 })),
        (181, alone(Halt { deceleration: -1.0 })),
        (426, alone(MoveContinuousRelative { end_velocity: 11.0, ..relative })),
        (427, alone(MoveContinuousRelative { end_velocity_direction: shortest, ..relative })),
        (451, alone(MoveContinuousAbsolute { acceleration: 0.0, ..absolute })),
        (452, alone(MoveContinuousAbsolute { end_velocity_direction: fastest, ..absolute })),
        (453, alone(MoveContinuousAbsolute { direction: fastest, ..absolute })),
        (302, alone(endless_in(shortest, 10.0).inputs)),
        (302, alone(endless_in(fastest, 10.0).inputs)),
        (301, alone(endless_in(Direction::Positive, -10.0).inputs)),
        (675, behind(GearIn { ratio_denominator: 0, ..geared })),
        (676, behind(GearIn { acceleration: 0.0, ..geared })),
        (677, behind(GearIn { deceleration: -1.0, ..geared })),
        (725, behind::<Phasing>(shifted)),
        (625, behind(CamIn { table: None, input })),
        (626, on_cam(CamInput { master_offset: -1.0, ..input })),
        (627, on_cam(ramp_in(0.0, 0.0))),
        (628, on_cam(CamInput { slave_scaling: f64::NAN, ..input })),
    ];
    let (master, mut rig) = (linear(), linear());
    for (number, call) in rows {
        let shown = rig.cycle(|axis| call(&master.axis, axis));
        assert_eq!(shown.error.map(SmcError::number), Some(number));
    }
    let movement = Movement::Rotary { period: 0.0 };
    let master = Rig::new(AxisConfig { movement, ..AxisConfig::default() });
    let shown = rig.cycle(|axis| phasing(1.0, 1.0, 1.0).follow(true, &master.axis, axis));
    assert_eq!(shown.error, Some(SmcError::PhRotaryaxisPeriod0));
    // The current direction is one.
    assert_eq!(rig.call(&mut endless_in(Direction::Current, 10.0), true).error, None);
}
