//! Tests of the tracking error of both ways of following, against closed forms.

use super::*;
use crate::{
    BoardAxis, Following,
    tests::{MS, Plan, line, sines, steep_axes},
};

const BUFFERED: Following =
    Following::Buffered { start_stop_hz: 200, acceleration_khz_per_s: 1000 };

/// Two sines of different frequency, from rest to rest.
fn slow_sines(amplitude: f64) -> impl Fn(f64) -> IncrementMotion + Sync {
    sines(vec![(amplitude, 0.5), (amplitude, 0.25)])
}

/// A plan of which only the shape counts.
fn plan(end_s: f64, of: impl Fn(f64) -> IncrementMotion + Sync) -> impl SetpointStream {
    Plan::new(|| 0, 0, end_s, of)
}

#[test]
fn segments_end_where_the_plan_ends() {
    let plan = plan(4.0, slow_sines(4000.0));
    let mut prediction = board_prediction(&steep_axes(2), &Wire::default(), BUFFERED, None);
    let mut farthest = 0.0_f64;
    for time in -200..5500_i64 {
        farthest = farthest.max(prediction.advance(&plan, time * MS).position[0]);
    }
    assert!(farthest > 7900.0, "{farthest}");
    let end = prediction.advance(&plan, 5500 * MS);
    for axis in 0..2 {
        let planned = plan.at(5500 * MS).position[axis];
        assert!((end.position[axis] - planned).abs() <= 0.6, "{} {planned}", end.position[axis]);
        assert_eq!(end.velocity[axis].to_bits(), 0.0_f64.to_bits());
    }
    assert_eq!(
        (prediction.axis_count(), prediction.copied().exchanges()),
        (2, prediction.exchanges())
    );
}

#[test]
fn segments_that_need_no_ramp_are_as_near_as_rounding() {
    // Slower than the start frequency: a segment has constant speed, as the plan has.
    let start = Following::Buffered { start_stop_hz: 2000, acceleration_khz_per_s: 1000 };
    let plan = plan(3.0, line(1500.0));
    let found = predict(&plan, &steep_axes(2), &Wire::default(), start, (-200 * MS, 4000 * MS));
    // The first segment can only begin an exchange after the plan does: at most 20 ms at 1500 steps/s.
    assert!(found.largest[0] < 32.0, "{found:?}");
    assert!(found.rms[0] < 8.0 && found.rms[1] < 4.0, "{found:?}");
}

#[test]
fn stops_between_segments_cost_what_they_must() {
    // At 20 kHz in a straight line the axis must stop between segments of at most 250 ms: with ramps of 1000 kHz/s
    // it is 20 ms slower up and down, and makes that good in between: a swing of at least v·t/4 for t = 20 ms.
    let plan = plan(3.0, line(20e3));
    let axes = steep_axes(2);
    let window = (-200 * MS, 4000 * MS);
    let buffered = predict(&plan, &axes, &Wire::default(), BUFFERED, window);
    let retargeted = predict(&plan, &axes, &Wire::default(), Following::Retargeted, window);
    assert!(buffered.largest[0] > 20e3 * 0.02 / 4.0, "{buffered:?}");
    // It does keep up: never farther behind than a segment's worth.
    assert!(buffered.largest[0] < 20e3 * 0.12, "{buffered:?}");
    assert!(buffered.rms[0] > retargeted.rms[0], "{buffered:?} {retargeted:?}");
}

#[test]
fn a_summary_is_of_the_prediction() {
    let plan = plan(4.0, slow_sines(4000.0));
    let axes = steep_axes(2);
    for following in [Following::Retargeted, BUFFERED] {
        let found = predict(&plan, &axes, &Wire::default(), following, (-100 * MS, 5000 * MS));
        let mut prediction = board_prediction(&axes, &Wire::default(), following, None);
        let (mut squares, mut largest) = ([0.0; 2], [0.0_f64; 2]);
        for time in -100..=5000_i64 {
            let position = prediction.advance(&plan, time * MS).position;
            for axis in 0..2 {
                let error = position[axis] - plan.at(time * MS).position[axis];
                squares[axis] += error * error;
                largest[axis] = largest[axis].max(error.abs());
            }
        }
        for axis in 0..2 {
            assert!((found.rms[axis] - (squares[axis] / 5101.0).sqrt()).abs() < 1e-9);
            assert_eq!(found.largest[axis].to_bits(), largest[axis].to_bits());
        }
        // The digest's table: 115 to 125 exchanges per second with a turnaround of 2 ms.
        assert!((110.0..150.0).contains(&found.exchanges_per_s), "{found:?}");
    }
}

#[test]
fn retargeting_is_nearer_to_a_sine_than_segments_are() {
    let plan = plan(4.0, slow_sines(4000.0));
    let predicted = |following| {
        predict(&plan, &steep_axes(2), &Wire::default(), following, (-200 * MS, 5000 * MS))
    };
    let (retargeted, buffered) = (predicted(Following::Retargeted), predicted(BUFFERED));
    for axis in 0..2 {
        assert!(retargeted.rms[axis] < buffered.rms[axis], "{retargeted:?} {buffered:?}");
    }
    // 12566 steps/s at most: segments stay within 60 ms of the plan.
    assert!(buffered.largest[0] < 12_566.0 * 0.06, "{buffered:?}");
}

/// 115200 baud, 2 ms: command 80 takes 8.538 ms, a look 8.712, the encoder 6.976, once in eight looks (bytes, two silences of
/// 1.75 ms, the answering time).
#[test]
fn reading_the_encoder_costs_what_its_bytes_do() {
    let axes = steep_axes(3);
    let encoder =
        EncoderOptions { axis: BoardAxis::Y, points: 4000, increments: 3200, tolerance: 10 };
    let byte = 10.0 / 115_200.0;
    let [command, look, reading] = [35.0, 37.0, 17.0].map(|bytes| bytes * byte + 0.0055);
    let wire = Wire::default();
    for (following, exchanges) in
        [(Following::Retargeted, 3.0 * command), (BUFFERED, (29.0 + 8.0) * byte + 0.0055)]
    {
        let rates =
            |encoder| board_prediction(&axes, &wire, following, encoder).rates().samples_per_s;
        let (without, with) = (exchanges + look, exchanges + look + reading / 8.0);
        assert!((rates(None) * without - 1.0).abs() < 1e-3, "{following:?}");
        assert!((rates(Some(encoder)) * with - 1.0).abs() < 1e-3, "{following:?}");
        // And what is done is that: on the way one exchange more in eight rounds, so that there are fewer of the others.
        let plan = plan(4.0, slow_sines(4000.0));
        let [without, with] = [None, Some(encoder)].map(|encoder| {
            let mut prediction = board_prediction(&axes, &wire, following, encoder);
            let moved: Vec<_> = (0..3000_i64)
                .map(|time_ms| prediction.advance(&plan, time_ms * MS).position)
                .collect();
            (prediction.exchanges(), moved)
        });
        assert!(with.0 > without.0 && with.1 != without.1, "{following:?}");
    }
    // An axis that is not in use has no encoder here.
    let elsewhere = EncoderOptions { axis: BoardAxis::B, ..encoder };
    let of = |encoder| board_prediction(&axes, &wire, Following::Retargeted, encoder).rates();
    assert_eq!(of(Some(elsewhere)), of(None));
}
