//! Properties of every transform over random machines and poses: round trips and derivatives.

use super::machines::{self, Placed, Reach};
use super::{differences, seeded};
use crate::transform::{Differential, Motion};
use crate::{Coordinate, Transform};
use nalgebra::SVector;
use proptest::prelude::*;
use proptest::test_runner::{TestCaseError, TestRunner};

/// m.
const LENGTH: f64 = 1e-12;
/// rad.
const ANGLE: f64 = 1e-12;
/// Of derivatives against differences, relative.
const DIFFERENCE: f64 = 1e-8;

type Tested = Result<(), TestCaseError>;

#[track_caller]
fn check<T: Transform<N>, const N: usize>(
    machines: impl Strategy<Value = Placed<T, N>>,
    test: impl Fn(&T, SVector<f64, N>) -> Tested,
) {
    let mut runner = TestRunner::new(seeded());
    let run = runner.run(&machines, |Placed { machine, axes }| test(&machine, axes));
    run.unwrap_or_else(|error| panic!("{error}"));
}

/// No axis is off by more than a length or an angle may be.
fn axes_agree<T: Transform<N>, const N: usize>(
    machine: &T,
    found: &SVector<f64, N>,
    expected: &SVector<f64, N>,
) -> Tested {
    for ((found, expected), rotary) in found.iter().zip(expected).zip(machine.rotary()) {
        let tolerance = if rotary { ANGLE } else { LENGTH };
        prop_assert!((found - expected).abs() <= tolerance, "{found} {expected} in {machine:?}");
    }
    Ok(())
}

fn tools_agree<T: Transform<N>, const N: usize>(
    machine: &T,
    found: &SVector<f64, N>,
    expected: &SVector<f64, N>,
) -> Tested {
    let coordinates = machine.coordinates().iter();
    for ((found, expected), coordinate) in found.iter().zip(expected).zip(coordinates) {
        let tolerance = if *coordinate == Coordinate::Direction { ANGLE } else { LENGTH };
        let off = (found - expected).abs();
        prop_assert!(off <= tolerance, "{coordinate}: {found} {expected} in {machine:?}");
    }
    Ok(())
}

fn round_trips<T: Transform<N>, const N: usize>(machine: &T, axes: SVector<f64, N>) -> Tested {
    let tool = machine.to_tool(&axes).unwrap();
    prop_assert_eq!(machine.branch_at(&axes), machine.branch());
    let back = machine.to_axes_near(&tool, &axes).unwrap();
    axes_agree(machine, &back, &axes)?;
    tools_agree(machine, &machine.to_tool(&back).unwrap(), &tool)?;
    let margins = machine.margins(&tool);
    prop_assert!(margins.boundary > 0.0 && margins.branch > 0.0, "{margins:?}");
    Ok(())
}

/// The derivatives of `f` agree with its differences of the best step within reach, to the size of what they are made of.
fn derivatives_agree<const N: usize>(
    what: &str,
    f: impl Fn(f64) -> Option<SVector<f64, N>>,
    found: &[SVector<f64, N>],
    sizes: &[f64],
) -> Tested {
    let mut errors = [f64::INFINITY; 3];
    let mut step = 0.1;
    while step > 1e-4 {
        let reached = (-5..=5).all(|count| f(f64::from(count) * step).is_some());
        if reached {
            let differences = differences(|t| f(t).unwrap().into(), step);
            for (((error, found), size), difference) in
                errors.iter_mut().zip(found).zip(sizes).zip(differences)
            {
                *error = error.min((found - SVector::from(difference)).norm() / size.max(1.0));
            }
        }
        step /= 1.6;
    }
    for (order, (error, found)) in errors.iter().zip(found).enumerate() {
        // The higher the order, the fewer digits differences keep.
        let tolerance = [0.01, 1.0, 10.0][order] * DIFFERENCE;
        prop_assert!(*error <= tolerance, "{what} {}: {found} is off by {error}", order + 1);
    }
    Ok(())
}

/// A path through `start` with these derivatives.
fn path<const N: usize>(
    start: SVector<f64, N>,
    [v, a, j]: [SVector<f64, N>; 3],
) -> impl Fn(f64) -> SVector<f64, N> {
    move |t: f64| start + v * t + a * (t * t / 2.0) + j * (t * t * t / 6.0)
}

/// Derivatives that depend on the pose alone, so that cases are the same in every run; of the order of the machine's size.
fn some_derivatives<const N: usize>(seed: f64, size: f64) -> [SVector<f64, N>; 3] {
    [1.0, 2.0, 3.0].map(|order: f64| {
        let rows = (0_u32..).map(|row| seed * 10.0 + order * 1.7 + f64::from(row) * 2.3);
        SVector::from_iterator(rows.map(|angle| angle.sin() * size).take(N))
    })
}

fn moves<T: Transform<N>, const N: usize>(machine: &T, axes: SVector<f64, N>) -> Tested {
    let (tool, differential) = machine.at_axes(&axes).unwrap();
    tools_agree(machine, &tool, &machine.to_tool(&axes).unwrap())?;

    // The Jacobian, column by column.
    let jacobian = differential.jacobian().unwrap();
    let size = jacobian.norm();
    for axis in 0..N {
        let unit = SVector::<f64, N>::from_fn(|row, _| if row == axis { 1.0 } else { 0.0 });
        let tool = |t: f64| machine.to_tool(&(axes + unit * t)).ok();
        derivatives_agree("jacobian", tool, &[jacobian.column(axis).into()], &[size])?;
    }

    // The tool moves, the axes follow.
    let length = machine.characteristic_length();
    let given = some_derivatives(tool[0], length);
    let (position, differential) = machine.at_tool(&tool, &axes).unwrap();
    axes_agree(machine, &position, &axes)?;
    let followed = differential.follow_jerk(&given).unwrap();
    let moving = path(tool, given);
    // Orders are made of those before them.
    let mut size = 0.0_f64;
    let sizes = followed.map(|order| {
        size = size.max(order.norm());
        size
    });
    let there = |t: f64| machine.to_axes_near(&moving(t), &axes).ok();
    derivatives_agree("axes", there, &followed, &sizes)?;
    let motion = Motion { position: tool, velocity: given[0], acceleration: given[1] };
    let found = machine.axis_motion(&motion, &axes).unwrap();
    prop_assert!((found.velocity - followed[0]).norm() <= 1e-13 * followed[0].norm());
    prop_assert!((found.acceleration - followed[1]).norm() <= 1e-13 * followed[1].norm());

    // And back.
    let (_, differential) = machine.at_axes(&position).unwrap();
    let led = differential.lead_jerk(&followed).unwrap();
    let mut scale = length;
    for ((found, expected), axes) in led.iter().zip(&given).zip(&followed) {
        scale = scale.max(axes.norm() * jacobian.norm());
        prop_assert!((found - expected).norm() <= 1e-10 * scale, "{found} {expected}");
    }
    let led = machine.tool_motion(&found).unwrap();
    prop_assert!((led.velocity - given[0]).norm() <= 1e-11 * scale);
    prop_assert!((led.acceleration - given[1]).norm() <= 1e-11 * scale);
    Ok(())
}

macro_rules! transforms {
    ($($name:ident: $machines:expr;)*) => {$(
        mod $name {
            use super::*;

            #[test]
            fn round_trips() {
                check($machines, |machine, axes| super::round_trips(machine, axes));
            }

            #[test]
            fn moves() {
                check($machines, |machine, axes| super::moves(machine, axes));
            }
        }
    )*};
}

transforms! {
    gantry2: machines::gantry2();
    gantry3: machines::gantry3();
    gantry_cutter2: machines::gantry_cutter2();
    gantry_cutter3: machines::gantry_cutter3();
    gantry2_tool: machines::gantry2_tool();
    gantry3_tool: machines::gantry3_tool();
    gantry_h2: machines::gantry_h2();
    scara2: machines::scara2(Reach::Inside);
    scara2_tool: machines::scara2_tool();
    scara3: machines::scara3(Reach::Inside);
    tripod: machines::tripod(Reach::Inside);
    calibrated_tripod: machines::calibrated(Reach::Inside);
}

#[test]
fn round_trips_close_to_the_edge() {
    check(machines::scara2(Reach::Close), round_trips);
    check(machines::scara3(Reach::Close), round_trips);
    check(machines::tripod(Reach::Close), round_trips);
    check(machines::calibrated(Reach::Close), round_trips);
}

/// Without deviations the numerical solution is the closed form.
#[test]
fn calibrated_tripods_without_deviations_are_ideal() {
    use crate::tripod::{CalibratedTripod, TripodDeviations};
    let wide = machines::tripod(Reach::Inside)
        .prop_filter("loose", |placed| placed.machine.dimensions().rod_distance > 0.05);
    check(wide, |ideal, axes| {
        let rods = ideal.dimensions().rods(&TripodDeviations::default()).unwrap();
        let tip = nalgebra::Vector3::new(0.01, -0.02, -0.1);
        let calibrated = CalibratedTripod::new(rods, ideal.offsets()).unwrap().holding(&tip);
        let tool = ideal.holding(&tip).to_tool(&axes).unwrap();
        axes_agree(&calibrated, &calibrated.to_axes(&tool).unwrap(), &axes)?;
        tools_agree(&calibrated, &calibrated.to_tool(&axes).unwrap(), &tool)
    });
}

/// Fast steps with three equations and Newton's method with six find the same, or that a tool is out of reach.
#[test]
fn calibrated_tripods_are_as_by_newton() {
    let agree = |machine: &crate::tripod::CalibratedTripod, tool: SVector<f64, 3>| {
        let given = some_derivatives(tool[0], machine.characteristic_length());
        let (found, slow) = (machine.at_tool(&tool, &tool), machine.by_newton(&tool, &given));
        let ((position, differential), [expected, slow @ ..]) = match (found, slow) {
            (Ok(found), Ok(slow)) => (found, slow),
            (found, slow) => {
                prop_assert_eq!(found.err(), slow.err());
                return Ok(());
            }
        };
        axes_agree(machine, &position, &expected)?;
        // Orders are made of those before them.
        let mut size = 0.0_f64;
        for (found, slow) in differential.follow_jerk(&given).unwrap().iter().zip(slow) {
            size = size.max(slow.norm());
            prop_assert!((found - slow).norm() <= 1e-9 * size, "{found} {slow} in {machine:?}");
        }
        Ok(())
    };
    for reach in [Reach::Inside, Reach::Close] {
        check(machines::calibrated(reach), |machine, axes| {
            let (tool, size) = (machine.to_tool(&axes).unwrap(), machine.characteristic_length());
            // Through the place to where the rods end, and beyond.
            let outwards = nalgebra::Vector3::new(1.0, 0.3, 0.0).normalize() * size;
            for way in [0.0, 1e-7, 1e-5, 1e-3, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0] {
                agree(machine, tool + outwards * way)?;
                agree(machine, tool - outwards * way)?;
            }
            Ok(())
        });
    }
}
