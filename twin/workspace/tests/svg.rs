//! Tests of the workspace picture: its labels and scale, and what is filled.

use super::machines::machine;
use crate::workspace::{Scale, View, Workspace, picture};

/// Numbers of attributes like `key="1.5"`.
fn attribute(text: &str, key: &str) -> f64 {
    let (_, rest) = text.split_once(&format!("{key}=\"")).unwrap();
    rest.split_once('"').unwrap().0.parse().unwrap()
}

#[test]
fn a_picture_names_what_it_shows() {
    let machine = machine("scara2.toml");
    let workspace = Workspace::survey(&machine, &View::default()).unwrap();
    let horizontal = workspace.horizontal();
    let example = workspace.example(&horizontal).unwrap().unwrap();
    let text = picture(&workspace, &horizontal, Some(&example));
    let words = [
        "Workspace of scara2",
        "horizontal section at z 20 mm; 4885 cm²",
        "A beyond its limits",
        "B beyond its limits",
        "edge of the workspace",
        "edge of the reach",
        "start of programs",
        "worked example",
        "singularity measure",
        "x (mm)",
    ];
    for word in words {
        assert!(text.contains(word), "{word}");
    }
    // At this height Z is within its limits everywhere.
    assert!(!text.contains("Z beyond"));
    let (width, height) = (attribute(&text, "width"), attribute(&text, "height"));
    assert!(
        (700.0..900.0).contains(&width) && (700.0..900.0).contains(&height),
        "{width} {height}"
    );
    assert!(text.contains(&format!(r#"viewBox="0 0 {width} {height}""#)));
    // Every band of the measure has its colour, in the section and in the scale.
    let scale = Scale::up_to(horizontal.best.unwrap().measure);
    for band in 0..scale.bands() {
        let color = scale.color(band).to_string();
        assert!(text.matches(&color).count() >= 2, "{band}: {color}");
    }
    let vertical = picture(&workspace, &workspace.vertical().unwrap(), None);
    assert!(vertical.contains("Z beyond its limits") && vertical.contains("z (mm)"));
    assert!(!vertical.contains("worked example"));
}

/// Holes stay free: points in the picture are asked whether they lie in what is filled for the workspace.
#[test]
fn what_is_out_of_reach_is_not_filled() {
    let machine = machine("scara2.toml");
    let workspace = Workspace::survey(&machine, &View::default()).unwrap();
    let horizontal = workspace.horizontal();
    let text = picture(&workspace, &horizontal, None);
    let color = Scale::up_to(horizontal.best.unwrap().measure).color(0).to_string();
    let area = text.lines().find(|line| line.contains("measure") && line.contains(&color));
    let (_, commands) = area.unwrap().split_once("d=\"M").unwrap();
    // Closed lines through places in mm.
    let commands = commands.split('"').next().unwrap().trim_end_matches('Z');
    let place = |place: &str| {
        let (x, y) = place.split_once(' ').unwrap();
        (x.parse::<f64>().unwrap(), y.parse::<f64>().unwrap())
    };
    let loops: Vec<Vec<_>> =
        commands.split("ZM").map(|one| one.split('L').map(place).collect()).collect();
    // How often they go around a point.
    let winding = |x: f64, y: f64| {
        let (x, y) = (x + 0.05, y + 0.05);
        let sides = loops.iter().flat_map(|one| one.iter().zip(one.iter().cycle().skip(1)));
        sides.fold(0_i32, |count, ((x1, y1), (x2, y2))| {
            let side = (x2 - x1) * (y - y1) - (x - x1) * (y2 - y1);
            if *y1 <= y && *y2 > y && side > 0.0 {
                count + 1
            } else if *y1 > y && *y2 <= y && side < 0.0 {
                count - 1
            } else {
                count
            }
        })
    };
    for (x, y) in [(300.0, 0.0), (130.0, 0.0), (0.0, 440.0), (-300.0, 100.0), (200.0, -300.0)] {
        assert_eq!(winding(x, y).abs(), 1, "{x} {y}");
    }
    // In the hole, where A is beyond its limits, and out of reach.
    for (x, y) in [(100.0, 30.0), (0.0, 0.0), (-200.0, -200.0), (-440.0, 0.0), (440.0, 200.0)] {
        assert_eq!(winding(x, y), 0, "{x} {y}");
    }
}
