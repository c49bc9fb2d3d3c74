//! Preparation of a path: tool radius correction around the outside of a square (G41).
//!
//! ```text
//! cargo run -p twin-path --example tool_radius
//! ```

use nalgebra::Point3;
use std::error::Error;
use std::f64::consts::FRAC_PI_2;
use twin_path::prepare::{Notices, ToolRadius, ToolRadiusError, ToolRadiusOptions};
use twin_path::{ElementKind, Marks, PathElement, Place, Shape};

/// Side of the square, m.
const SIDE: f64 = 0.04;
/// Radius of the tool, m.
const RADIUS: f64 = 0.005;

fn main() -> Result<(), Box<dyn Error>> {
    // Clockwise, so that the tool on the left is outside. A rapid leads there and another one away.
    let away = [-0.02, -0.02];
    let corners = [away, [0.0, 0.0], [0.0, SIDE], [SIDE, SIDE], [SIDE, 0.0], [0.0, 0.0], away];
    let mut path = Vec::new();
    for (line, ends) in (1_u32..).zip(corners.windows(2)) {
        let [start, end] = ends else { continue };
        let [start, end] = [start, end].map(|[x, y]| Point3::new(*x, *y, 0.0));
        let kind = if matches!(line, 1 | 6) { ElementKind::Rapid } else { ElementKind::Cut };
        let place = Place { block: Some(10 * line), ..Place::at(line) };
        let mut element = PathElement::new(place, kind, Shape::Line { start, end });
        element.tool_radius = RADIUS;
        element.marks = match line {
            2 => Marks::CORRECTION_LEFT,
            5 => Marks::CORRECTION_END,
            _ => Marks::default(),
        };
        path.push(Ok::<_, ToolRadiusError>(element));
    }

    let notices = Notices::default();
    let corrected =
        ToolRadius::new(path.into_iter(), ToolRadiusOptions::default(), notices.clone());
    let (mut length, mut nearest) = (0.0, f64::INFINITY);
    for element in corrected {
        let element = element?;
        let [start, end] = [element.start(), element.end()]
            .map(|point| format!("({:.3}, {:.3})", point.x * 1e3, point.y * 1e3));
        let (place, kind, mm) = (element.place, element.kind, element.length() * 1e3);
        println!("{place}: {kind:?} from {start} to {end} mm, {mm:.3} mm");
        if element.kind == ElementKind::Cut {
            length += element.length();
            for part in 0_u32..=20 {
                let at = element.at(element.length() * f64::from(part) / 20.0).position;
                nearest = f64::min(nearest, distance(at.x, at.y));
            }
        }
    }
    if let Some(notice) = notices.take() {
        return Err(format!("unexpected notice: {notice:?}").into());
    }
    // Four sides, and a quarter circle of the tool's radius around each of the three corners between them.
    let expected = 4.0 * SIDE + 3.0 * FRAC_PI_2 * RADIUS;
    println!("cut: {:.3} mm; the tool's centre keeps {:.3} mm", length * 1e3, nearest * 1e3);
    for (found, expected) in [(length, expected), (nearest, RADIUS)] {
        if (found - expected).abs() > 1e-12 {
            return Err(format!("{found} m instead of {expected} m").into());
        }
    }
    Ok(())
}

/// Distance of a point outside from the square, m.
fn distance(x: f64, y: f64) -> f64 {
    let outside = |value: f64| (-value).max(value - SIDE).max(0.0);
    outside(x).hypot(outside(y))
}
