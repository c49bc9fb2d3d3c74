//! Allocation test: no heap allocation between set-points and axes, because that code runs a thousand times a second
//! and must not wait for memory.
//!
//! The test calls every method of every transform, directly and through `dyn`, alone and in a whole machine, with valid
//! and refused input. Allocation during setup of a machine is allowed.

#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    dead_code,
    missing_docs,
    missing_debug_implementations,
    unreachable_pub,
    reason = "a test fails where it cannot be set up; the modules are those of others, too"
)]

mod control;
#[path = "../memory/counter.rs"]
mod counter;
#[path = "../benches/transforms/machines.rs"]
mod machines;
mod methods;

use machines::{Placed, Visit, each};
use nalgebra::{Vector2, Vector3};
use std::hint::black_box;
use twin_kinematics::{
    AxisSource, AxisVector, Coordinate, Kinematics, MachineAxes, Pose, ToPath, ToolJerk,
    ToolMotion, Transform, WorkFrame, direction_rates,
};

/// Number of positions tried on each machine.
const PLACES: usize = 20;

/// Calls, and those of them that asked for memory.
#[derive(Debug, Default)]
struct Calls {
    made: usize,
    refused: usize,
    asking: Vec<String>,
}

impl Calls {
    /// Calls a method and notes its name if it asks for memory.
    fn call<T>(&mut self, of: &str, method: &str, run: impl FnOnce() -> T) {
        let asked = counter::asked_during(|| {
            black_box(run());
        });
        self.made += 1;
        if asked > 0 {
            self.asking.push(format!("{of}: {method}"));
        }
    }

    /// The same for a method that may refuse; must it?
    fn attempt<T, E>(
        &mut self,
        of: &str,
        method: &str,
        refused: bool,
        run: impl FnOnce() -> Result<T, E>,
    ) {
        let mut found = true;
        self.call(of, method, || found = black_box(run()).is_err());
        assert_eq!(found, refused, "{of}: {method}");
        self.refused += usize::from(found);
    }
}

impl Visit for Calls {
    fn visit<T: Transform<N> + Kinematics, const N: usize>(
        &mut self,
        name: &'static str,
        placed: &Placed<T, N>,
    ) {
        for (tool, axes) in placed.tools.iter().zip(&placed.axes) {
            methods::of_transform(self, name, &placed.machine, tool, axes);
        }
        let alone: Box<dyn Kinematics> = Box::new(placed.machine.clone());
        for axes in &placed.axes {
            methods::of_kinematics(
                self,
                name,
                &*alone,
                &AxisVector::from_values(axes.iter().copied()),
            );
        }
        methods::of_refusals(self, name, &*alone);
        let whole = in_a_machine(&placed.machine);
        for axes in &placed.axes {
            let own = whole.axis_count() - N;
            let others = [0.3, 0.2].into_iter().take(own);
            let axes = AxisVector::from_values(axes.iter().copied().chain(others));
            methods::of_kinematics(self, name, &whole, &axes);
            self.call(name, "fold", || whole.fold(&axes));
        }
        methods::of_refusals(self, name, &whole);
    }
}

/// A machine with the axes of a transform, one along z if it has none, and an additional one.
fn in_a_machine<T: Transform<N> + Kinematics, const N: usize>(transform: &T) -> MachineAxes {
    let has_z = Transform::coordinates(transform).contains(&Coordinate::Z);
    let own = if has_z { None } else { Some(AxisSource::Coordinate(Coordinate::Z)) };
    let sources = (0..N).map(AxisSource::Transform).chain(own).chain([AxisSource::Additional(0)]);
    let tool = Vector3::new(0.01, 0.02, -0.1);
    let machine = MachineAxes::new(Box::new(transform.clone()), sources.collect(), tool);
    machine.expect("a machine").with_periods(&[Some(1.0); 2]).expect("periods")
}

#[test]
fn nothing_on_the_way_to_the_axes_asks_for_memory() {
    let mut calls = Calls::default();
    each(PLACES, &mut calls);
    assert_eq!(calls.asking, [""; 0]);
    println!("{} calls, {} of them refused", calls.made, calls.refused);
    assert!(calls.made > 11 * PLACES * 40 && calls.refused > 11 * 10, "{calls:?}");
}

#[test]
fn no_frame_or_direction_asks_for_memory() {
    let mut calls = Calls::default();
    let mut motion = ToolMotion::at_rest(Pose { position: [0.1, 0.2, 0.3].into(), direction: 0.4 });
    motion.velocity = Vector3::new(1.0, 2.0, 3.0);
    motion.direction_velocity = 0.5;
    let jerk = ToolJerk { linear: Vector3::new(3.0, 2.0, 1.0), direction: 0.6 };
    let shift = Vector3::new(0.3, 0.2, 0.1);
    for frame in [WorkFrame::new(shift, 0.0, 0.0, 0.7), WorkFrame::new(shift, 0.2, -0.3, 0.7)] {
        let of = "WorkFrame";
        calls.call(of, "pose_to_machine", || frame.pose_to_machine(&motion.pose));
        calls.call(of, "pose_to_work", || frame.pose_to_work(&motion.pose));
        calls.call(of, "motion_to_machine", || frame.motion_to_machine(&motion));
        calls.call(of, "jerk_to_machine", || frame.jerk_to_machine(&motion, &jerk));
    }
    let path = Vector2::new(1.0, 2.0);
    calls.call("ToPath", "direction", || ToPath::Left.direction(path));
    calls.call("", "direction_rates", || direction_rates(path, [path.yx(), path, path.yx()]));
    assert_eq!(calls.asking, [""; 0]);
}
