//! Test of interpolator and axes wired as in the manual's examples (11.7.1): `bStopIpo` of every axis to
//! `bEmergency_Stop`.

use super::program::{Pen, run};
use crate::controller::Inputs;
use std::task::Poll;
use twin_axis::{Axis, AxisConfig, ControlAxis, ControlAxisBy, Follow, Power, VirtualDrive};

/// Of the axes, m/s and m/s²: the path stays below, a jump does not.
const FASTEST: f64 = 0.2;
const HARDEST: f64 = 3.0;
const GAP: f64 = 0.05;

struct Wired {
    axis: Axis,
    drive: VirtualDrive,
    control: ControlAxis,
}

impl Wired {
    fn at(position: f64) -> Self {
        let axis = Axis::new(AxisConfig {
            cycle: 1e-3,
            max_velocity: FASTEST,
            max_acceleration: HARDEST,
            max_deceleration: HARDEST,
            ..AxisConfig::default()
        });
        let control = ControlAxis::new(ControlAxisBy {
            setpoint: Follow::Position(position),
            avoid_gaps: true,
            gap_velocity: GAP,
            gap_acceleration: 1.0,
            gap_deceleration: 1.0,
        });
        let mut wired = Self { axis, drive: VirtualDrive::new(position), control };
        for _ in 0..3 {
            wired.cycle(None);
        }
        wired
    }

    /// A cycle towards a set-point; `bStopIpo`.
    fn cycle(&mut self, setpoint: Option<f64>) -> bool {
        self.axis.begin_cycle(&self.drive.feedback());
        Power { regulator_on: true, drive_start: true }.call(true, &mut self.axis);
        let stop_ipo = setpoint.is_some_and(|setpoint| {
            self.control.inputs().setpoint = Follow::Position(setpoint);
            let shown = self.control.call(true, &mut self.axis);
            assert_eq!((shown.error, shown.command_aborted), (None, false));
            shown.stop_ipo
        });
        self.drive.follow(&self.axis.end_cycle());
        stop_ipo
    }
}

/// The path begins at 0, 0; X is 30 mm away. It is brought there with the gap velocity, 50 mm/s with 1 m/s²: 0.6 s and
/// 0.05 s; meanwhile the interpolator waits, and Y with it. Then both go 100 mm to the end, in 1.1 s.
#[test]
fn an_axis_beside_the_path_holds_the_interpolator() {
    let (feed, acceleration) = (0.1, 1.0);
    let elements = Pen::new(feed, acceleration, acceleration).line(0.1).take();
    let mut interpolator = run(elements);
    let mut axes = [Wired::at(0.03), Wired::at(0.0)];
    let (mut stop_ipo, mut held, mut cycles) = (false, 0, 0);
    loop {
        assert!(cycles < 5000);
        let inputs = Inputs { emergency_stop: stop_ipo, ..Inputs::default() };
        let Poll::Ready(next) = interpolator.poll_cycle(&inputs) else { panic!("it is all there") };
        let Some(setpoint) = next else { break };
        let setpoint = setpoint.unwrap();
        if stop_ipo {
            assert_eq!(setpoint.position.x, 0.0, "it waits at the beginning");
            assert_eq!(setpoint.path_velocity, 0.0);
            held += 1;
        }
        let wanted = [setpoint.position.x, setpoint.position.y];
        let before = axes.each_ref().map(|wired| wired.axis.set_position());
        stop_ipo = false;
        for (wired, wanted) in axes.iter_mut().zip(wanted) {
            stop_ipo |= wired.cycle(Some(wanted));
        }
        for (wired, before) in axes.iter().zip(before) {
            let way = (wired.axis.set_position() - before).abs();
            assert!(way <= FASTEST * 1e-3 + 1e-12, "{way}");
        }
        cycles += 1;
    }
    assert!((645..=655).contains(&held), "{held}");
    assert!((1100 + held - 2..=1100 + held + 5).contains(&cycles), "{cycles}");
    let ends = axes.each_ref().map(|wired| wired.axis.set_position());
    assert!((ends[0] - 0.1).abs() < 1e-12 && ends[1].abs() < 1e-12, "{ends:?}");
}
