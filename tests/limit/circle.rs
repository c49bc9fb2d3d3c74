//! Least time round a circle about the origin, counter-clockwise from (r, 0), for two equal axes with limited velocity
//! or acceleration, in closed form.
//!
//! At every moment one axis is at its limit, so that every piece of the motion is that of a single axis with constant
//! velocity or acceleration. In parts of r and of the acceleration limit A (times in √(r/A)), with β = v²/(A·r):
//!
//! ```text
//!   from rest at θ = 0, ÿ = 1:    ẏ² = 2·sin θ,               β = 2·sin θ / cos² θ
//!   as far as ẍ ≥ −1:             tan θ + 2·sin θ / cos³ θ ≤ 1
//!   then ẍ = −1:                  ẋ² = ẋ₁² + 2·(cos θ₁ − cos θ),  β = ẋ² / sin² θ
//!   to the top with ÿ = −1:       ẏ² = 2·(1 − sin θ),         β = 2 / (1 + sin θ)
//! ```
//!
//! At the top all of ÿ is centripetal and β is 1 at most. From there on to the next top, that of x, the motion goes on
//! with ÿ = −1 to the diagonal and is mirrored there.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI, SQRT_2};

/// A root of a rising function between two places.
fn root(mut low: f64, mut high: f64, rising: impl Fn(f64) -> f64) -> f64 {
    assert!(rising(low) < 0.0 && rising(high) > 0.0, "no root");
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if rising(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// An eighth of the circle between a top and a diagonal in motion: a fall of 1 − 1/√2 at constant acceleration.
fn eighth() -> f64 {
    (2.0 * (1.0 - FRAC_1_SQRT_2)).sqrt()
}

/// Once round with β = 1 at start and end, s.
pub fn rolling(radius: f64, acceleration: f64) -> f64 {
    8.0 * eighth() * (radius / acceleration).sqrt()
}

/// Once round from rest to rest, s.
pub fn rest_to_rest(radius: f64, acceleration: f64) -> f64 {
    let first = root(0.0, 0.5, |angle| angle.tan() + 2.0 * angle.sin() / angle.cos().powi(3) - 1.0);
    let ydot = (2.0 * first.sin()).sqrt();
    let xdot = ydot * first.tan();
    let squared_xdot = |angle: f64| xdot * xdot + 2.0 * (first.cos() - angle.cos());
    let second = root(first, FRAC_PI_2, |angle| {
        squared_xdot(angle) / angle.sin().powi(2) - 2.0 / (1.0 + angle.sin())
    });
    let quarter = ydot + (squared_xdot(second).sqrt() - xdot) + (2.0 * (1.0 - second.sin())).sqrt();
    (2.0 * quarter + 4.0 * eighth()) * (radius / acceleration).sqrt()
}

/// Once round from rest to rest with no more than the speed `feed`, s. It is reached before x brakes: F² ≤ 0.6·A·r.
pub fn with_feed(radius: f64, acceleration: f64, feed: f64) -> f64 {
    let share = feed * feed / (acceleration * radius);
    assert!(share <= 0.6, "it is too fast for the closed form");
    let first = root(0.0, 0.5, |angle| 2.0 * angle.sin() / angle.cos().powi(2) - share);
    2.0 * feed * first.cos() / acceleration + 2.0 * (PI - first) * radius / feed
}

/// Once round in motion where velocities alone are limited: in turn the axes move with constant velocity between the
/// diagonals, s. It takes accelerations of up to 2·√2·V²/r.
pub fn with_velocity(radius: f64, velocity: f64) -> f64 {
    4.0 * SQRT_2 * radius / velocity
}
