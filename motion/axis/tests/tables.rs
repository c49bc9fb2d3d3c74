//! Tests of motion through the points of a table (manual 5.3).

use super::*;

fn points(points: &[(f64, f64)]) -> Points {
    let point = |&(delta_time, value): &(f64, f64)| ProfilePoint { delta_time, value };
    Points::new(points.iter().map(point).collect())
}

fn table<M: Motion + Clone>(of: fn(Points) -> M, pairs: &[(f64, f64)]) -> Block<M> {
    Block::new(of(points(pairs)))
}

#[test]
fn a_position_profile_goes_through_its_points() {
    let mut rig = linear();
    rig.axis.shift_zero(100.0, false).expect("a number");
    let mut block = table(PositionProfile, &[(1.0, 10.0), (1.0, 15.0), (5.0, 99.0)]);
    (block.inputs.0.array_size, block.inputs.0.offset) = (2, 100.0);
    rig.calls(50, &mut block);
    // Worked in the vector axis-position-profile.
    assert!((rig.axis.set_position() - 103.59375).abs() < 1e-9);
    assert_eq!(f64::from(50 + rig.done(&mut block)) * CYCLE, 2.0);
    assert!((rig.axis.set_position() - 115.0).abs() < 1e-12);
    assert_eq!((rig.axis.set_velocity(), rig.axis.state()), (0.0, AxisState::Standstill));
}

#[test]
fn velocity_and_acceleration_profiles_are_integrated() {
    let mut rig = linear();
    rig.done(&mut table(VelocityProfile, &[(1.0, 10.0), (1.0, 0.0)]));
    // Two parabolas each way, mean velocity 5 u/s.
    assert!((rig.axis.set_position() - 10.0).abs() < 1e-9);
    assert_eq!(rig.axis.state(), AxisState::Standstill);
    let mut block = table(AccelerationProfile, &[(0.0, 0.0), (1.0, 10.0), (2.0, 10.0), (1.0, 0.0)]);
    rig.done(&mut block);
    // The vector axis-acceleration-profile; it goes on with 30 u/s.
    assert!((rig.axis.set_position() - 70.0).abs() < 1e-9);
    assert_eq!(rig.axis.state(), AxisState::ContinuousMotion);
    rig.call(&mut block, true);
    assert!((rig.axis.set_position() - 70.0 - 30.0 * CYCLE).abs() < 1e-9);
}

/// Accelerations that cancel out end at rest, although the sum of the parts is rounded.
#[test]
fn profiles_that_cancel_out_end_at_rest() {
    let mut random = Random(5);
    for _ in 0..300 {
        let mut rig = linear();
        let steps = [(); 3].map(|()| random.between(0.05, 0.4));
        let [up, flat, down] = steps.map(|step| (step * 1e3).round() * 1e-3);
        let rate = (random.between(1.0, 20.0) * 10.0).round() * 0.1;
        let there = [(up, rate), (flat, rate), (down, 0.0)];
        let back = there.map(|(step, rate)| (step, -rate));
        rig.done(&mut table(AccelerationProfile, &[there, back].concat()));
        assert_eq!((rig.axis.set_velocity(), rig.axis.state()), (0.0, AxisState::Standstill));
        // The trapezoid's area, twice; each half takes its whole time with the mean velocity that symmetry gives it.
        let velocity = rate * (0.5 * (up + down) + flat);
        let gained = velocity * (up + flat + down);
        assert!((rig.axis.set_position() - gained).abs() < 1e-9, "{there:?}");
        // A last velocity of 0 once it is scaled: 0.1 of 10·v, and an offset of −v.
        let mut block = table(VelocityProfile, &[(up, 500.0), (down, 10.0 * rate)]);
        (block.inputs.0.scale, block.inputs.0.offset) = (0.1, -rate);
        rig.done(&mut block);
        assert_eq!((rig.axis.set_velocity(), rig.axis.state()), (0.0, AxisState::Standstill));
    }
}

/// A hair before the end of the period counts as 0; a first point without time gives the period that is meant.
#[test]
fn a_profile_of_a_rotary_axis_begins_where_it_stands() {
    let hair = 360.0 - 6e-14;
    for (place, pairs, expected) in [
        (hair, &[(1.0, 10.0)][..], 10.0),
        (hair, &[(0.0, 0.0), (1.0, 10.0)], 10.0),
        (hair, &[(0.0, 360.0), (1.0, 350.0)], -10.0),
        (0.0, &[(0.0, 360.0), (1.0, 350.0)], -10.0),
        (0.0, &[(1.0, 350.0)], 350.0),
        (350.0, &[(1.0, 10.0)], -340.0),
        (350.0, &[(0.0, -10.0), (1.0, 10.0)], 20.0),
    ] {
        let (mut rig, mut block) = (rotary().at(place), table(PositionProfile, pairs));
        let [way, _] = way(&mut rig, |axis| block.call(true, axis).done);
        assert!((way - expected).abs() < 1e-9, "{place} {pairs:?}: {way}");
    }
}

/// One point is enough; a point without time only gives the begin of the motion.
#[test]
fn tables_of_one_point() {
    let (mut rig, mut block, mut count) = (linear(), table(PositionProfile, &[(2.0, 8.0)]), 0);
    let [_, fastest] = way(&mut rig, |axis| {
        count += 1;
        block.call(true, axis).done
    });
    // A cubic between rests: 3/2 of the mean velocity in the middle.
    assert_eq!((count, rig.axis.set_position()), (200, 8.0));
    assert!((fastest - 6.0).abs() < 1e-9, "{fastest}");
    // To 10 u/s in 1 s by two parabolas: 5 u; with an acceleration that grows to 10 u/s²: 10/6 u and 5 u/s.
    let mut rig = linear();
    assert_eq!(rig.done(&mut table(VelocityProfile, &[(1.0, 10.0)])), 100);
    assert!((rig.axis.set_position() - 5.0).abs() < 1e-9);
    assert_eq!(rig.axis.set_velocity(), 10.0);
    let mut rig = linear();
    assert_eq!(rig.done(&mut table(AccelerationProfile, &[(1.0, 10.0)])), 100);
    assert!((rig.axis.set_position() - 10.0 / 6.0).abs() < 1e-9);
    assert!((rig.axis.set_velocity() - 5.0).abs() < 1e-9);
    // At its begin it is done at once; another point without time cannot be reached.
    let at = |axis: &mut Axis, value| {
        let pairs = [(0.0, value)];
        [
            table(PositionProfile, &pairs).call(true, axis),
            table(VelocityProfile, &pairs).call(true, axis),
        ]
    };
    let shown: [[Outputs; 2]; 2] = linear().cycle(|axis| [at(axis, 0.0), at(axis, 1.0)]);
    assert_eq!(shown.map(|pair| pair.map(|it| it.done)), [[true; 2], [false; 2]]);
    let errors = [[None; 2], [Some(SmcError::PpStep0ms), Some(SmcError::VpStep0ms)]];
    assert_eq!(shown.map(|pair| pair.map(|it| it.error)), errors);
}

#[test]
fn tables_that_are_none_are_refused() {
    let mut rig = linear();
    let mut too_few = points(&[(1.0, 10.0)]);
    too_few.array_size = 2;
    let sizes = [SmcError::PpArraysize, SmcError::VpArraysize, SmcError::ApArraysize];
    let steps = [SmcError::PpStep0ms, SmcError::VpStep0ms, SmcError::ApStep0ms];
    for (given, expected) in [
        (too_few, sizes),
        (points(&[]), sizes),
        (points(&[(1.0, 1.0); 101]), sizes),
        (points(&[(1.0, 10.0), (0.0, 20.0)]), steps),
    ] {
        let shown = [
            rig.call(&mut Block::new(PositionProfile(given.clone())), true).error,
            rig.call(&mut Block::new(VelocityProfile(given.clone())), true).error,
            rig.call(&mut Block::new(AccelerationProfile(given.clone())), true).error,
        ];
        assert_eq!(shown, expected.map(Some), "{given:?}");
    }
}

/// It counts from the period in which the axis is, however far it has turned before.
#[test]
fn a_table_of_positions_goes_over_the_end_of_the_period() {
    let (mut rig, mut turning, mut there) = (rotary(), endless(100.0), to(350.0));
    rig.calls(1_000, &mut turning);
    rig.until(|axis| [there.call(true, axis), turning.call(true, axis)][0].done);
    let mut table = table(PositionProfile, &[(2.0, 370.0)]);
    let [_, fastest] = way(&mut rig, |axis| table.call(true, axis).done);
    assert!((rig.axis.set_position() - 10.0).abs() < 1e-9, "{}", rig.axis.set_position());
    // 20 u in 2 s by a cubic between rests: 3/2 of the mean velocity.
    assert!((fastest - 15.0).abs() < 1e-9, "{fastest}");
}
