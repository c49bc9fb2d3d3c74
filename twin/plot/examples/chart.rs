//! Chart of a trapezoidal move as SVG on the standard output.
//!
//! ```text
//! cargo run -p twin-plot --example chart > move.svg
//! ```

use std::error::Error;
use twin_plot::{Across, Chart, Color, Row, Series, Shape, Stroke};

/// Way, mm; velocity, mm/s; acceleration, mm/s².
const MOVE: [f64; 3] = [100.0, 50.0, 500.0];
/// Limit of the axis, mm/s.
const LIMIT: f64 = 60.0;

fn main() -> Result<(), Box<dyn Error>> {
    let [way, most, acceleration] = MOVE;
    let duration = way / most + most / acceleration;
    let (mut velocity, mut position) = (Series::default(), Series::default());
    let (steps, mut at) = (2100_u32, 0.0);
    let step = duration / f64::from(steps);
    for index in 0..=steps {
        let time = duration * f64::from(index) / f64::from(steps);
        let value = most.min(acceleration * time).min(acceleration * (duration - time)).max(0.0);
        velocity.push(time, Some(value));
        position.push(time, Some(at));
        at += value * step;
    }
    // The sum of the velocities is the way.
    let end = position.points().last().map_or(0.0, |point| point.1);
    if (end - way).abs() > 1e-3 {
        return Err(format!("{end} mm instead of {way} mm").into());
    }

    let row = |name, unit, range, limits: &[f64], series: &Series, color| {
        let mut row = Row::fitted(name, unit, 180.0, Some(range), limits);
        row.shapes.push(Shape::Line(series.points().to_vec(), Stroke::solid(color, 2.0)));
        row
    };
    let [blue, orange] = [0, 1].map(Color::series);
    let chart = Chart {
        title: format!("{way} mm at {most} mm/s"),
        subtitle: format!("{duration} s with {acceleration} mm/s²"),
        across: Across::time([0.0, duration]),
        rows: vec![
            row("velocity", "mm/s", [0.0, most], &[LIMIT], &velocity, blue),
            row("position", "mm", [0.0, way], &[], &position, orange),
        ],
        strips: Vec::new(),
        legend: Vec::new(),
    };
    let svg = chart.svg();
    if !svg.contains("velocity") || !svg.trim_end().ends_with("</svg>") {
        return Err("the chart is not complete".into());
    }
    println!("{svg}");
    Ok(())
}
