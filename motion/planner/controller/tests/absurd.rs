//! Tests with absurd numbers: no panic, no NaN, and the limits hold.

use super::modes::run_in;
use super::program::{Elements, Pen, magnitude, planned, run};
use crate::controller::{DEFAULT_CYCLE_NS, Inputs, Override, VelocityMode};
use proptest::prelude::*;

fn absurd_programs() -> impl Strategy<Value = Elements> {
    let length =
        prop_oneof![Just(0.0), Just(1e-12), Just(1e6), Just(5e-324), magnitude(-15.0..8.0)];
    let limit = || prop_oneof![Just(1e-9), Just(1e3), magnitude(-9.0..6.0)];
    let radius = prop_oneof![Just(1e-12), Just(1e6), magnitude(-12.0..6.0)];
    let step = (any::<bool>(), length, radius, -10.0..10.0_f64, limit(), limit(), limit());
    prop::collection::vec(step, 1..30).prop_map(|steps| {
        let mut pen = Pen::new(1.0, 1.0, 1.0);
        for (straight, length, radius, sweep, feed, acceleration, deceleration) in steps {
            (pen.feed, pen.acceleration, pen.deceleration) = (feed, acceleration, deceleration);
            if straight {
                pen.line(length)
            } else {
                pen.arc(radius, sweep, length)
            };
        }
        pen.take()
    })
}

fn modes() -> impl Strategy<Value = VelocityMode> {
    prop_oneof![
        Just(VelocityMode::Trapezoid),
        Just(VelocityMode::Sigmoid),
        magnitude(-9.0..9.0).prop_map(|jerk| VelocityMode::JerkLimited { jerk }),
    ]
}

proptest! {
    #[test]
    fn absurd_programs_stay_finite(elements in absurd_programs(), stop_after in 0_i64..300, mode in modes()) {
        let whole: Vec<_> = elements.iter().flatten().cloned().collect();
        for planned in planned(elements.clone()) {
            let planned = planned.unwrap();
            prop_assert!(planned.end_velocity() <= planned.element().feed);
            prop_assert!(planned.start_velocity() <= planned.element().feed);
            let duration = planned.profile().duration();
            prop_assert!(duration.is_finite() && duration >= 0.0, "{planned:?}");
            prop_assert!(duration > 0.0 || !planned.element().has_path());
        }
        let mut interpolator = run_in(mode, elements);
        for n in 0..600_i64 {
            if n == stop_after {
                interpolator.request_stop();
            }
            let demand = |at, inputs| (n == stop_after * at / 4).then_some(inputs);
            let base = Inputs { mode, ..Inputs::default() };
            let low = Inputs { override_factor: Override::new(0.01).unwrap(), ..base };
            let demands = [
                demand(1, low),
                demand(2, Inputs { single_step: true, ..base }),
                demand(3, Inputs { slow_stop: n % 2 == 0, emergency_stop: n % 3 == 0, ..base }),
            ];
            if let Some(inputs) = demands.into_iter().flatten().last() {
                interpolator.set_inputs(inputs);
            }
            let Some(setpoint) = interpolator.next() else { break };
            let setpoint = setpoint.unwrap();
            let element = &whole[setpoint.place.line as usize - 1];
            prop_assert_eq!(setpoint.time_ns, n * i64::from(DEFAULT_CYCLE_NS.get()));
            prop_assert!(setpoint.position.coords.iter().all(|x| x.is_finite()), "{setpoint:?}");
            prop_assert!(setpoint.velocity.iter().all(|x| x.is_finite()), "{setpoint:?}");
            prop_assert!(setpoint.acceleration.iter().all(|x| x.is_finite()), "{setpoint:?}");
            prop_assert!(setpoint.path_velocity >= 0.0 && setpoint.path_velocity <= element.feed * (1.0 + 1e-8));
            prop_assert!(interpolator.path_length().is_finite() && interpolator.duration().is_finite());
        }
    }
}

/// The largest numbers [`twin_path::prepare::CheckVelocities`] lets through, and the smallest there are.
#[test]
fn extreme_limits_do_not_overflow() {
    for big in [1e-300, 5e-324, 1e100] {
        for other in [1e-300, 1.0, 1e100] {
            let mut pen = Pen::new(big, other, big);
            pen.line(1e-3).line(1e99).line(5e-324);
            (pen.feed, pen.acceleration, pen.deceleration) = (other, big, other);
            pen.line(1.0).line(1e-200).line(1.0);
            let mut interpolator = run(pen.take());
            for setpoint in interpolator.by_ref().take(100) {
                let setpoint = setpoint.unwrap();
                assert!(
                    setpoint.position.x.is_finite() && setpoint.path_velocity >= 0.0,
                    "{setpoint:?}"
                );
            }
            interpolator.request_stop();
            for setpoint in interpolator.take(100) {
                assert!(setpoint.unwrap().position.x.is_finite());
            }
        }
    }
}
