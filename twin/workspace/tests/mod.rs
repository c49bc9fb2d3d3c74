//! Expectations are closed forms: areas and lengths of circles, rings and boxes, and of what two arms sweep.

mod machines;
mod region;
mod svg;

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, expected {expected}");
}
