//! Numbers of pictures, whatever their size.

use super::found::{LIFT, cam, using};
use crate::cam::check::AxisLimits;
use crate::cam::picture::{Recorded, Shown, cam_chart, on_stretches};
use std::sync::Arc;
use twin_cam::{CamCoupling, CamInput, CamTable, TappetBit};
use twin_machine::cam_file::CamFile;
use twin_profile::State;

/// Where the dots of a recorded run are, and the highest place of the first curve.
fn dots_and_top(picture: &str) -> (Vec<f64>, f64) {
    let value = |line: &str, key: &str| {
        let text = line.split(&format!(" {key}=\"")).nth(1)?.split('"').next()?;
        text.parse::<f64>().ok()
    };
    let dots =
        picture.lines().filter(|line| line.starts_with("<circle") && line.contains("r=\"1.5\""));
    let dots = dots.filter_map(|line| value(line, "cy")).collect();
    let curve = picture
        .lines()
        .find(|line| line.starts_with("<polyline") && line.matches(',').count() > 100)
        .expect("a curve");
    let points =
        curve.split("points=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("points");
    let y = points.split_whitespace().filter_map(|point| point.split_once(',')?.1.parse().ok());
    (dots, y.fold(f64::INFINITY, f64::min))
}

/// Powers of ten stand with the unit where numbers would have no room, and recorded positions lie on their curve all the same: here
/// the top of the lift, 100 mm times the scaling.
#[test]
fn large_and_small_numbers_have_their_power_of_ten() {
    let file = cam(LIFT);
    for (scaling, unit) in
        [(1.0, "(mm)"), (1e4, "(10⁶ mm)"), (1e-6, "(10⁻⁶ mm)"), (2e-5, "(10⁻³ mm)")]
    {
        let mut use_it = using(&file, 1.0, AxisLimits::NONE);
        use_it.coupling.input.slave_scaling = scaling;
        let shown = [Shown { file: &file, using: &use_it, name: "lift" }];
        let recorded = Recorded { points: vec![(180.0, 100.0 * scaling)], ..Recorded::default() };
        let picture = cam_chart("lift", "", &shown, &recorded).svg();
        assert!(picture.contains(&format!(">{unit}</text>")), "{scaling}: {unit}");
        let (dots, top) = dots_and_top(&picture);
        let [dot] = dots.as_slice() else { panic!("{dots:?}") };
        assert!((dot - top).abs() <= 0.2, "{scaling}: {dot}, {top}");
    }
    // The jerk is 60 · 100/180³ · 0.5³ at most: 0.13 · 10⁻³.
    let slow = using(&file, 0.5, AxisLimits::NONE);
    let shown = [Shown { file: &file, using: &slow, name: "lift" }];
    let picture = cam_chart("lift", "", &shown, &Recorded::default()).svg();
    assert!(picture.contains("(10⁻⁶ mm/s³)") && !picture.contains("0.0005"), "no power of ten");
}

/// What a curve reaches is told without its rounding, and the line at 0 of an error is no limit.
#[test]
fn rounding_and_zeros_are_not_told() {
    let file = cam(LIFT);
    let mut use_it = using(&file, 1.0, AxisLimits::NONE);
    use_it.coupling.input.slave_offset = -1e-13;
    let errors = vec![(0.0, 0.5), (180.0, -0.5)];
    let recorded =
        Recorded { points: vec![(0.0, 0.0), (180.0, 100.0)], errors: [errors.clone(), errors] };
    let mut drawn = |limits: AxisLimits| {
        use_it.limits = limits;
        let shown = [Shown { file: &file, using: &use_it, name: "lift" }];
        cam_chart("lift", "", &shown, &recorded).svg()
    };
    let has = |picture: &str, words: &str| picture.contains(&format!(">{words}</text>"));
    let without = drawn(AxisLimits::NONE);
    assert!(has(&without, "0 … 100") && has(&without, "-0.5 … 0.5"), "{without}");
    assert!(has(&without, "error of the slave") && !has(&without, "limit"), "{without}");
    assert!(has(&drawn(AxisLimits { position: [-5.0, 110.0], ..AxisLimits::NONE }), "limit"));
}

/// What is drawn of tappets that only invert is the first pass of a run, which begins with all off and on the tappet at its begin; and
/// if every pass is the other way round, the picture says so. The witness is the block itself, from the begin of the cam on, forwards and
/// back.
#[test]
fn tappets_that_invert_are_drawn_as_in_the_first_pass() {
    for (tappets, turns) in [
        (&[100.0][..], true),
        (&[0.0], true),
        (&[50.0, 200.0, 300.0], true),
        (&[50.0, 200.0], false),
        (&[0.0, 360.0], false),
        (&[0.0, 90.0, 360.0], true),
    ] {
        let told: Vec<_> = tappets
            .iter()
            .map(|at| format!("{{ group = 3, master = {at:?}, action = \"invert\" }}"))
            .collect();
        let text = format!("{}\ntappets = [{}]\n", without_tappets(), told.join(", "));
        let file = cam(&text);
        for scaling in [1.0, -1.0] {
            let mut use_it = using(&file, 1.0, AxisLimits::NONE);
            (use_it.repeated, use_it.coupling.input.master_scaling) = (true, scaling);
            let shown = Shown { file: &file, using: &use_it, name: "inverts" };
            let drawn = on_stretches(&shown, 3);
            let passes = of_a_run(&file, scaling);
            for (pass, found) in passes.iter().enumerate() {
                for (place, on) in found {
                    let bar = drawn.iter().any(|[begin, end]| (*begin..=*end).contains(place));
                    let other = turns && pass % 2 == 1;
                    assert_eq!(*on, bar ^ other, "{tappets:?} {scaling} {pass} {place} {drawn:?}");
                }
            }
            let picture = cam_chart("inverts", "", &[shown], &Recorded::default()).svg();
            let words =
                "tappets that are on in the first pass; the next one is the other way round";
            let says = picture.contains(&format!(">{words}</text>"));
            assert_eq!(says, turns, "{tappets:?}");
        }
    }
}

fn without_tappets() -> &'static str {
    LIFT.split("tappets = [").next().expect("a cam")
}

/// The bit of group 3 in the middle of every degree, pass by pass.
fn of_a_run(file: &CamFile, scaling: f64) -> Vec<Vec<(f64, bool)>> {
    let at = |degrees: f64| State::resting(scaling * degrees);
    let begin = if scaling < 0.0 { 360.0 } else { 0.0 };
    let input = CamInput { master_scaling: scaling, master_offset: begin, ..CamInput::default() };
    let table = CamTable::new(Arc::new(file.cam.clone()));
    let mut run = CamCoupling::start(table, input, &at(0.0), &at(0.0), 0).expect("on the cam");
    let mut bit = TappetBit::default();
    let mut passes = Vec::new();
    let mut now_ns = 0;
    for pass in 0..3 {
        let mut found = Vec::new();
        for degree in 0..360 {
            let along = f64::from(degree) + 0.5;
            now_ns += 1_000_000;
            // The master goes forwards, and the cam the way of the scaling.
            let way = f64::from(pass) * 360.0 + along;
            let acted = run.step(&State::resting(way), now_ns).expect("somewhere").tappets;
            for trigger in acted.triggers().filter(|trigger| trigger.group == 3) {
                bit.take(trigger);
            }
            let place = if scaling < 0.0 { 360.0 - along } else { along };
            found.push((place, bit.at(acted.now_ns)));
        }
        passes.push(found);
    }
    passes
}
