//! Tests of the motors in a recording.

use super::*;
use crate::frame::MotorFrame;
use rerun::external::re_sdk_types::components::Visible;

/// A rotary step motor that is watched for its warmth, and a linear servo of which nothing is known but what it gives.
fn motors(ms: u32) -> [MotorFrame; 2] {
    let ms = f64::from(ms);
    let stepper = MotorFrame {
        effort: -2.0 * ms,
        effort_limit: Some(80.0 - ms),
        power: -3.0 * ms,
        utilisation: Some(ms * 1e-2),
        warmth: Some(0.5 + ms * 1e-3),
        load_angle: Some(ms * -1e-2),
    };
    [stepper, MotorFrame { effort: 7.5, power: 0.25, ..MotorFrame::default() }]
}

/// Frames one ms apart; with motors where `has_motors` says so.
fn record(milliseconds: u32, has_motors: impl Fn(u32) -> bool) -> Read {
    written(|scene| {
        for ms in 0..milliseconds {
            let motors = motors(ms);
            log_motors(scene, ms, if has_motors(ms) { &motors } else { &[] }).unwrap();
        }
    })
}

fn log_motors(scene: &mut Scene, ms: u32, motors: &[MotorFrame]) -> Result<(), VizError> {
    scene.frame(&Frame { motors, ..still(ms, &[Isometry3::identity(); 2]) })
}

#[test]
fn what_motors_do_comes_back_at_its_time_and_line() {
    type Of = fn(f64) -> f64;
    let read = record(25, |_| true);
    let series: [(&str, &str, Of); 8] = [
        ("motor/torque_nm/A/twin", "A twin (Nm)", |ms| -2.0 * ms),
        ("motor/torque_nm/A/limit", "A limit (Nm)", |ms| 80.0 - ms),
        ("motor/power_w/A/twin", "A twin (W)", |ms| -3.0 * ms),
        ("motor/utilisation_percent/A/twin", "A twin (%)", |ms| ms),
        ("motor/warmth_percent/A/twin", "A twin (%)", |ms| 50.0 + 0.1 * ms),
        ("motor/load_angle_full_steps/A/twin", "A twin (full steps)", |ms| -1e-2 * ms),
        ("motor/force_n/Z/twin", "Z twin (N)", |_| 7.5),
        ("motor/power_w/Z/twin", "Z twin (W)", |_| 0.25),
    ];
    for (entity, name, wanted) in &series {
        assert_plot(&read, entity, 25, wanted);
        assert_eq!(read.names(entity), [*name]);
        // What motors can give is often far more than they do and would hide the rest.
        let visible = rerun::SeriesLines::descriptor_visible_series();
        let visible = read.each(entity, &visible, |visible: Visible| visible.0.0);
        assert_eq!(visible, [!entity.ends_with("limit")], "{entity}");
    }
    assert_plot(&read, "error/axis_deg/A/twin", 25, |_| 0.0);
    assert_plot(&read, "error/axis_mm/Z/twin", 25, |_| 0.0);
    // What is not known is not there.
    let found = read.entities(|path| path.starts_with("/motor"));
    let mut wanted = series.map(|(entity, ..)| format!("/{entity}"));
    wanted.sort();
    assert_eq!(found, wanted);
}

#[test]
fn motors_have_a_tab_with_what_is_known_of_them() {
    let parts = record(1, |_| true).names_of_parts();
    let has = |part: &str| parts.iter().any(|name| name.starts_with(part));
    for part in [
        "Errors and speed",
        "Motors",
        "Motor forces at the axes (N)",
        "Motor torques at the axes (Nm)",
        "Mechanical power (W)",
        "Motor utilisation (%",
        "Warmth of the windings",
        "Load angle of step motors (full steps)",
        "Tool error (mm)",
    ] {
        assert!(has(part), "no {part}: {parts:?}");
    }
    let servo = [MotorFrame::default(); 2];
    let axes = [AxisUnit::Linear, AxisUnit::Linear].map(|unit| Axis { name: "X".to_owned(), unit });
    assert_eq!(MotorPlot::of(&axes, &servo), [MotorPlot::Force, MotorPlot::Power]);
    assert_eq!(MotorPlot::of(&axes, &[]), []);
}

#[test]
fn where_motors_are_not_known_nothing_is_shown_of_them() {
    let read = record(30, |_| false);
    assert_eq!(read.entities(|path| path.starts_with("/motor")), [""; 0]);
    let parts = read.names_of_parts();
    assert!(parts.iter().any(|name| name == "Tool error (mm)"), "{parts:?}");
    assert!(!parts.iter().any(|name| name.contains("otor")), "{parts:?}");
}

#[test]
fn motors_that_are_heard_of_late_get_their_tab_then() {
    let read = record(30, |ms| ms >= 10 && ms % 5 == 0);
    assert_eq!(read.activations, 2);
    assert!(read.names_of_parts().iter().any(|name| name == "Motors"));
    let times: Vec<_> =
        read.scalars("motor/power_w/A/twin").iter().map(|row| row.0 / 1_000_000).collect();
    assert_eq!(times, [10, 15, 20, 25]);
}

#[test]
fn motors_of_another_machine_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = open_file(&folder.path().join("a.rrd"));
    let error = log_motors(&mut scene, 0, &motors(0)[..1]).unwrap_err();
    assert_miscounted(&error, "motors", [2, 1]);
}
