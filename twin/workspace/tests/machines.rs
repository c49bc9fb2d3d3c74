//! Tests of the workspaces of whole machines: gantry, SCARA and others, their sections and extents.

use super::near;
use crate::workspace::{Cut, Section, View, Way, Workspace, WorkspaceError};
use nalgebra::Point3;
use std::f64::consts::PI;
use std::path::Path;
use twin_machine::Machine;

pub(super) fn machine(name: &str) -> Machine {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    Machine::load(&folder.join("machines").join(name)).unwrap()
}

fn extent(section: &Section<'_>) -> [f64; 4] {
    let [low, high] = section.within.extent().unwrap();
    [low.x, high.x, low.y, high.y]
}

fn all_near(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    let fits = found.iter().zip(expected).all(|(one, other)| (one - other).abs() <= tolerance);
    assert!(fits, "{found:?}, expected {expected:?}");
}

/// The software limits of machines/gantry3.toml, with a tool of 40 mm.
#[test]
fn the_workspace_of_a_gantry_is_its_limits() {
    let machine = machine("gantry3.toml");
    let workspace = Workspace::survey(&machine, &View::default()).unwrap();
    let extent_of = workspace.extent;
    all_near(extent_of.min.coords.as_slice(), &[-0.05, -0.25, -0.1], 1e-9);
    all_near(extent_of.max.coords.as_slice(), &[0.65, 0.45, 0.08], 1e-9);
    assert_eq!((workspace.reach, workspace.turns_tool), (None, false));
    let horizontal = workspace.horizontal();
    // Where programs start: Z20.
    assert_eq!(horizontal.cut, Cut::Horizontal { height: 0.02 });
    near(horizontal.within.area(), 0.7 * 0.7, 1e-7);
    all_near(&extent(&horizontal), &[-0.05, 0.65, -0.25, 0.45], 1e-6);
    let vertical = workspace.vertical().unwrap();
    near(vertical.within.area(), 0.7 * 0.18, 1e-7);
    all_near(&extent(&vertical), &[-0.05, 0.65, -0.1, 0.08], 1e-6);
    // Every direction is as good as any other.
    near(horizontal.best.unwrap().measure, 1.0, 1e-6);
    near(horizontal.worst.unwrap().measure, 1.0, 1e-6);
    let example = workspace.example(&horizontal).unwrap().unwrap();
    assert_eq!(example.position, Point3::new(0.3, 0.1, 0.02));
    all_near(&example.axes, &[0.3, 0.1, 0.06], 1e-12);
    for (way, (axis, speed)) in example.ways.iter().zip([(0, 0.4), (1, 0.4), (2, 0.2)]) {
        assert_eq!(way.fastest, Some((axis, speed)), "{}", way.name);
    }
}

/// What two arms of 250 and 200 mm sweep with A between ±150° and B between 0 and 150° (elbow low).
#[test]
fn the_workspace_of_a_scara_is_what_its_arms_sweep() {
    let machine = machine("scara2.toml");
    let workspace = Workspace::survey(&machine, &View::default()).unwrap();
    let [first, second] = [0.25, 0.2];
    let [turn, bend] = [150.0_f64.to_radians(), 150.0_f64.to_radians()];
    all_near(&workspace.reach.unwrap().distances, &[0.05, 0.45], 1e-12);
    let horizontal = workspace.horizontal();
    // dx dy = |det J| dA dB with det J = L1 L2 sin B.
    let area = 2.0 * turn * first * second * (1.0 - bend.cos());
    // At A = -150° the region ends in a cusp, of which what is thinner than a cell is missed.
    near(horizontal.within.area() / area, 1.0, 1e-4);

    // x: stretched along +x; the least where the whole arm points to 180° with A at its limit, or both arms point there.
    let left = first * turn.cos() - second;
    // y: stretched along ±y; both are within A's limits.
    let expected = [left, 0.45, -0.45, 0.45];
    let box_of = workspace.extent;
    all_near(&[box_of.min.x, box_of.max.x, box_of.min.y, box_of.max.y], &expected, 1e-9);
    all_near(&[box_of.min.z, box_of.max.z], &[-0.12, 0.08], 1e-9);
    all_near(&extent(&horizontal), &expected, 1e-5);

    near(horizontal.worst.unwrap().measure, 0.0, 1e-2);
    // Nothing is better than the best bend of the elbow; the measure does not depend on A.
    let example = workspace.example(&horizontal).unwrap().unwrap();
    let Point3 { coords: at } = example.position;
    let cosine =
        (at.x * at.x + at.y * at.y - first * first - second * second) / (2.0 * first * second);
    let b = cosine.acos();
    let a = at.y.atan2(at.x) - (second * b.sin()).atan2(first + second * b.cos());
    all_near(&example.axes, &[a, b, 0.08], 1e-12);
    // The inverse of J, column by column: [cos(A+B), -x] / (L1 sin B), over L2 in the second row; the same with sin.
    let scale = 1.0 / (first * b.sin());
    let columns = [
        [(a + b).cos() * scale, -at.x * scale / second, 0.0],
        [(a + b).sin() * scale, -at.y * scale / second, 0.0],
        [0.0, 0.0, 1.0],
    ];
    let limits = [240.0_f64.to_radians(), 300.0_f64.to_radians(), 0.3];
    for (way, column) in example.ways.iter().zip(columns) {
        all_near(&way.rates, &column, 1e-9);
        let speeds = column.into_iter().zip(limits).map(|(rate, limit)| limit / rate.abs());
        near(way.fastest.unwrap().1, speeds.fold(f64::INFINITY, f64::min), 1e-9);
    }
}

/// Upright through the first axis: as high as Z goes, as wide as the arms are within their limits along that line.
#[test]
fn a_scara_is_cut_through_its_first_axis() {
    let machine = machine("scara2.toml");
    for azimuth in [0.0, 0.5 * PI, 0.9 * PI, -2.0] {
        let view = View { azimuth, ..View::default() };
        let vertical = Workspace::survey(&machine, &view).unwrap().vertical().unwrap();
        // Which distances lie within the limits, one by one.
        let fits = |along: f64| {
            let direction = if along < 0.0 { azimuth + PI } else { azimuth };
            let r = along.abs();
            let cosine = (r * r - 0.25 * 0.25 - 0.2 * 0.2) / (2.0 * 0.25 * 0.2);
            if cosine.abs() > 1.0 {
                return false;
            }
            let b = cosine.acos();
            let a = direction - (0.2 * b.sin()).atan2(0.25 + 0.2 * b.cos());
            // In -180° to 180°.
            let a = a.sin().atan2(a.cos());
            b.to_degrees() <= 150.0 && a.to_degrees().abs() <= 150.0
        };
        let steps = 90_000;
        let count =
            (0..=steps).filter(|step| fits(-0.45 + 0.9 * f64::from(*step) / f64::from(steps)));
        #[expect(clippy::cast_precision_loss, reason = "90,000")]
        let width = count.count() as f64 * 0.9 / f64::from(steps);
        near(vertical.within.area(), width * 0.2, 1e-5);
        let [.., low, high] = extent(&vertical);
        all_near(&[low, high], &[-0.12, 0.08], 1e-6);
    }
}

#[test]
fn what_cannot_be_looked_at_is_an_error() {
    let machine = machine("gantry3.toml");
    let survey = |view: View| Workspace::survey(&machine, &view).map(drop);
    let height = View { height: Some(0.081), ..View::default() };
    let error = survey(height).unwrap_err();
    assert!(matches!(error, WorkspaceError::Height { .. }), "{error}");
    let said = error.to_string();
    assert!(said.contains("81.000 mm") && said.contains("-100.000 to 80.000"), "{said}");
    let direction = View { direction: Some(1.0), ..View::default() };
    assert_eq!(survey(direction), Err(WorkspaceError::Direction));
    survey(View { height: Some(0.08), ..View::default() }).unwrap();
}

/// The same questions, the same answers.
#[test]
fn a_survey_is_repeatable() {
    let machine = machine("scara2.toml");
    let survey = || {
        let workspace = Workspace::survey(&machine, &View::default()).unwrap();
        let section = workspace.horizontal();
        (workspace.extent, section.within.clone(), section.best, section.middle())
    };
    assert_eq!(survey(), survey());
}

/// A = x + y and B = x - y, each within ±700 mm: a square on its corner.
#[test]
fn the_workspace_of_an_h_belt_stands_on_its_corner() {
    let machine = machine("gantry_h2.toml");
    let workspace = Workspace::survey(&machine, &View::default()).unwrap();
    let horizontal = workspace.horizontal();
    near(horizontal.within.area(), 2.0 * 0.7 * 0.7, 2e-6);
    all_near(&extent(&horizontal), &[-0.7, 0.7, -0.7, 0.7], 1e-4);
    // Belts move the carriage by (1, 1)/2 and (1, -1)/2: singular values of 1/√2, and 1 for the axis of Z.
    for measure in [horizontal.best, horizontal.worst] {
        near(measure.unwrap().measure, 0.5_f64.sqrt(), 1e-9);
    }
    let [along_x, along_y, _] = &workspace.example(&horizontal).unwrap().unwrap().ways[..] else {
        panic!("three ways");
    };
    all_near(&along_x.rates, &[1.0, 1.0, 0.0], 1e-12);
    all_near(&along_y.rates, &[1.0, -1.0, 0.0], 1e-12);
}

/// A hand of 40 mm that keeps its direction moves what two arms sweep, but does not change it.
#[test]
fn a_hand_moves_the_workspace_of_its_wrist() {
    let machine = machine("scara3.toml");
    for direction in [0.0, 1.0, -2.5] {
        let view = View { direction: Some(direction), ..View::default() };
        let workspace = Workspace::survey(&machine, &view).unwrap();
        assert!(workspace.turns_tool);
        let horizontal = workspace.horizontal();
        let [limit, bend] = [150.0_f64.to_radians(), 150.0_f64.to_radians()];
        near(horizontal.within.area() / (2.0 * limit * 0.05 * (1.0 - bend.cos())), 1.0, 1e-4);
        let [_, right, low, high] = extent(&horizontal);
        let (sin, cos) = direction.sin_cos();
        let expected = [0.45 + 0.04 * cos, -0.45 + 0.04 * sin, 0.45 + 0.04 * sin];
        all_near(&[right, low, high], &expected, 1e-5);
        let example = workspace.example(&horizontal).unwrap().unwrap();
        assert_eq!(example.ways.len(), 4);
        assert!(example.ways.iter().map(Way::turns).eq([false, false, false, true]));
        // The three angles add up to the direction of the hand, give or take whole turns.
        let turned = example.axes[..3].iter().sum::<f64>() - direction;
        all_near(&[turned.cos(), turned.sin()], &[1.0, 0.0], 1e-9);
    }
}

/// q = z + tool + √(L² − d²), d from the middle of each pair's upper ends to that of its lower ones, within 240 to 560 mm.
#[test]
fn the_workspace_of_a_tripod_is_where_its_rods_let_it_be() {
    let machine = machine("tripod.toml");
    let workspace = Workspace::survey(&machine, &View::default()).unwrap();
    let ring = |radius: f64| (radius * radius - 0.025 * 0.025).sqrt();
    let radius = ring(0.26) - ring(0.06);
    let fits = |x: f64, y: f64, z: f64| {
        [90.0_f64, 210.0, 330.0].into_iter().all(|angle| {
            let (sin, cos) = angle.to_radians().sin_cos();
            let d = (x - radius * cos).hypot(y - radius * sin);
            let carriage = z + 0.05 + (0.16 - d * d).sqrt();
            (0.24..=0.56).contains(&carriage)
        })
    };
    let count = |inside: &dyn Fn(f64, f64) -> bool| {
        let steps = || (-600..600).map(|step| (f64::from(step) + 0.5) * 5e-4);
        let hits = steps().flat_map(|x| steps().filter(move |y| inside(x, *y)));
        hits.fold(0.0, |area, _| area + 2.5e-7)
    };
    let horizontal = workspace.horizontal();
    near(horizontal.within.area(), count(&|x, y| fits(x, y, 0.06)), 2e-5);
    near(workspace.vertical().unwrap().within.area(), count(&|x, z| fits(x, 0.0, z)), 2e-5);
    // Three of a kind: the best place is the middle.
    let Point3 { coords: best } = horizontal.best.unwrap().position;
    all_near(best.as_slice(), &[0.0, 0.0, 0.06], 1e-6);
    // Highest and lowest on the axis, with all carriages at a limit.
    let rods = (0.16 - radius * radius).sqrt();
    let box_of = workspace.extent;
    all_near(&[box_of.min.z, box_of.max.z], &[0.24 - rods - 0.05, 0.56 - rods - 0.05], 1e-9);
}
