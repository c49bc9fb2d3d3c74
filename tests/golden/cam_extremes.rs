//! Cams with very large and very small numbers, and very many points.

use crate::desk::Desk;
use std::fmt::Write;

const LIFT: &str = "name = \"lift\"\nmaster = { min = 0, max = 360, unit = \"deg\" }\nslave = { min = 0, max = 100, unit = \"mm\", period = 100 }\n\
                    elements = [{ master = 0, slave = 0 }, { master = 180, slave = 100 }, { master = 360, slave = 0 }]\n";

/// A slope of 15/8 · 100/180 mm/deg times 10¹⁵ leaves the master 9.6e-16 deg/s of 1 mm/s, which is not 0.
#[test]
fn numbers_next_to_nothing_are_told() {
    let desk = Desk::new();
    desk.write("lift.toml", LIFT);
    let check = |more: &str| desk.twin(&format!("cam check lift.toml {more}"));
    let large = "--master-scaling 1e15 --max-velocity 1";
    check(&format!("{large} --master-velocity 1e15"))
        .ended(1, "the master may go 9.6e-16 deg/s at most")
        .says("the master may go 9.6e-16 deg/s");
    // No table is wider than a page, though its jerk has 10¹⁵ cubed.
    for more in [
        "--master-velocity 1e15 --slave-scaling 1e15",
        "--master-scaling 1e-15 --slave-offset 1e15",
    ] {
        let done = check(more);
        done.ended(0, "");
        let widest = done.stdout.lines().map(|line| line.chars().count()).max().expect("a table");
        assert!(widest < 140, "{widest}: {}", done.stdout);
    }
    for factor in ["1e-300", "-1e-16", "5e-324"] {
        check(&format!("--master-scaling {factor}"))
            .ended(2, &format!("the scaling is {factor}; 1e-15 is the least scaling"));
    }
}

/// The polylines of a picture, as places.
fn lines(picture: &str) -> Vec<Vec<(f64, f64)>> {
    let point = |pair: &str| {
        let (x, y) = pair.split_once(',').expect("two numbers");
        (x.parse().expect("a number"), y.parse().expect("a number"))
    };
    let tags = picture.split("<polyline ").skip(1);
    let points = tags.map(|tag| tag.split("points=\"").nth(1).expect("points").split('"').next());
    points.map(|text| text.expect("an end").split_whitespace().map(point).collect()).collect()
}

/// A table of 200,000 points, up and down by 1 from each to the next, and one point that stands out by 40 either way: the picture
/// is no larger than others are, and shows how far the table goes, in every column and at both points.
#[test]
fn pictures_of_long_tables_are_short() {
    const COUNT: usize = 200_000;
    let desk = Desk::new();
    let mut text = String::from("master_deg,slave_mm\n");
    for index in 0..=COUNT {
        let even = if index % 2 == 0 { 1.0 } else { -1.0 };
        let slave = match index {
            50_001 => 40.0,
            150_001 => -40.0,
            _ => even,
        };
        writeln!(text, "{index},{slave}").expect("written");
    }
    desk.write("long.csv", &text);
    desk.twin("cam plot long.csv -o long.svg").ended(0, "");
    let picture = desk.text("long.svg");
    assert!(picture.len() < 1_000_000, "{} bytes", picture.len());
    let lines = lines(&picture);
    let wide = |line: &&Vec<(f64, f64)>| line.len() > 1000;
    // Position and velocity are noise; the acceleration of straight lines is 0.
    let curves: Vec<_> = lines.iter().filter(wide).collect();
    assert!(curves.len() >= 2, "{} curves", curves.len());
    let position = curves[0];
    let (left, right) = (position[0].0, position[position.len() - 1].0);
    let at = |share: f64| left + (right - left) * share;
    let top = position.iter().min_by(|one, other| one.1.total_cmp(&other.1)).expect("a point");
    let bottom = position.iter().max_by(|one, other| one.1.total_cmp(&other.1)).expect("a point");
    assert!(
        (top.0 - at(0.25)).abs() <= 0.1 && (bottom.0 - at(0.75)).abs() <= 0.1,
        "{top:?} {bottom:?}"
    );
    // 80 mm from top to bottom, the band beside 2 mm: in every fifth of a hundredth of the width.
    let unit = (bottom.1 - top.1) / 80.0;
    let middle = top.1.midpoint(bottom.1);
    for part in 0..500 {
        let [from, to] = [0, 1].map(|more| at(f64::from(part + more) / 500.0));
        let inside: Vec<_> = position.iter().filter(|(x, _)| (from..=to).contains(x)).collect();
        for sign in [-1.0, 1.0] {
            let reached = inside.iter().any(|(_, y)| (y - (middle + sign * unit)).abs() <= 0.02);
            assert!(reached, "part {part}: {inside:?}");
        }
    }
}
