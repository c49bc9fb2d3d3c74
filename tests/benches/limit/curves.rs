//! Smooth curves with their derivatives in closed form.

use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Position of the tool and its first three derivatives by the curve's parameter.
pub type Jet = [Vector3<f64>; 4];

/// A curve from the parameter 0 to `end`, m: its length, about or exactly.
pub struct Curve {
    pub name: &'static str,
    pub end: f64,
    pub at: Box<dyn Fn(f64) -> Jet>,
}

impl Curve {
    pub fn at(&self, s: f64) -> Jet {
        (self.at)(s)
    }
}

/// r·(cos(ωt + φ)) and its derivatives by t.
fn wave(r: f64, omega: f64, phase: f64, t: f64) -> [f64; 4] {
    let (sine, cosine) = (omega * t + phase).sin_cos();
    [cosine, -omega * sine, -omega * omega * cosine, omega * omega * omega * sine].map(|x| r * x)
}

fn jet(x: [f64; 4], y: [f64; 4], z: [f64; 4]) -> Jet {
    std::array::from_fn(|order| Vector3::new(x[order], y[order], z[order]))
}

const QUARTER: f64 = TAU / 4.0;

fn placed(centre: Vector3<f64>, mut jet: Jet) -> Jet {
    jet[0] += centre;
    jet
}

/// Once round `centre` while the height swings.
pub fn circle(centre: Vector3<f64>, radius: f64) -> Curve {
    let at = move |s: f64| {
        let omega = 1.0 / radius;
        let [x, y] = [0.0, -QUARTER].map(|phase| wave(radius, omega, phase, s));
        placed(centre, jet(x, y, wave(0.1 * radius, omega, QUARTER, s)))
    };
    Curve { name: "circle", end: TAU * radius, at: Box::new(at) }
}

/// Three waves in x while there are two in y.
pub fn lissajous(centre: Vector3<f64>, radius: f64) -> Curve {
    let end = 14.0 * radius;
    let at = move |s: f64| {
        let omega = TAU / end;
        let x = wave(radius, 3.0 * omega, 0.4, s);
        let y = wave(radius, 2.0 * omega, -QUARTER, s);
        placed(centre, jet(x, y, wave(0.2 * radius, omega, 1.0, s)))
    };
    Curve { name: "lissajous", end, at: Box::new(at) }
}

/// From near the middle outwards.
pub fn spiral(centre: Vector3<f64>, radius: f64) -> Curve {
    const TURNS: f64 = 4.0;
    let end = TAU * TURNS * 0.6 * radius;
    let at = move |s: f64| {
        let omega = TAU * TURNS / end;
        let slope = 0.8 * radius / end;
        let r = 0.2 * radius + slope * s;
        // Leibniz: the radius has one derivative alone.
        let wound = |phase: f64| {
            let [w0, w1, w2, w3] = wave(1.0, omega, phase, s);
            [r * w0, r * w1 + slope * w0, r * w2 + 2.0 * slope * w1, r * w3 + 3.0 * slope * w2]
        };
        let z = [0.1 * slope * s, 0.1 * slope, 0.0, 0.0];
        placed(centre, jet(wound(0.0), wound(-QUARTER), z))
    };
    Curve { name: "spiral", end, at: Box::new(at) }
}

/// A quintic B-spline about scattered points: four continuous derivatives.
pub fn spline(centre: Vector3<f64>, radius: f64) -> Curve {
    const POINTS: usize = 24;
    let mut state = 7_u64;
    let mut next = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(state >> 32).expect("32 bits")) / f64::from(u32::MAX) * 2.0 - 1.0
    };
    let points: Vec<Vector3<f64>> = (0..POINTS)
        .map(|_| Vector3::new(next(), next(), 0.3 * next()) * (radius * 0.95) + centre)
        .collect();
    let spans = POINTS - 5;
    let end = 0.5 * radius * crate::path::as_float(spans);
    let at = move |s: f64| {
        let scale = crate::path::as_float(spans) / end;
        let place = (s * scale).clamp(0.0, crate::path::as_float(spans));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a small count"
        )]
        let span = (place.floor() as usize).min(spans - 1);
        let local = place - crate::path::as_float(span);
        let mut jet = Jet::default();
        for (index, point) in points[span..span + 6].iter().enumerate() {
            let weights = basis(index, local);
            for (order, (slot, weight)) in jet.iter_mut().zip(weights).enumerate() {
                let order = i32::try_from(order).expect("a small order");
                *slot += point * (weight * scale.powi(order));
            }
        }
        jet
    };
    Curve { name: "spline", end, at: Box::new(at) }
}

/// Weight of the control point `index` of six, and its derivatives, at 0 ≤ t ≤ 1 within the span. The uniform quintic
/// B-spline is M(x) = Σ (−1)^k·C(6, k)·(x − k)₊⁵ / 5!, of which this is the piece x = t + 5 − index.
fn basis(index: usize, t: f64) -> [f64; 4] {
    const BINOMIALS: [f64; 6] = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0];
    let piece = 5 - index;
    let mut weights = [0.0; 4];
    for (k, binomial) in BINOMIALS.iter().enumerate().take(piece + 1) {
        let x = t + crate::path::as_float(piece - k);
        let powers = [x.powi(5), 5.0 * x.powi(4), 20.0 * x.powi(3), 60.0 * x.powi(2)];
        for (weight, power) in weights.iter_mut().zip(powers) {
            *weight += binomial * power / 120.0;
        }
    }
    weights
}

/// Loops along a circle that never are where they have been before.
pub fn rosette(centre: Vector3<f64>, radius: f64, end: f64) -> Curve {
    let at = move |s: f64| {
        // The larger circle is that of the carrier.
        let (slow, fast) = (0.45 / (0.6 * radius), 1.7 / (0.4 * radius));
        let share = |phase: f64| {
            let carrier = wave(0.6 * radius, slow, phase, s);
            let turner = wave(0.4 * radius, 0.45 * fast, phase, s);
            std::array::from_fn(|order| carrier[order] + turner[order])
        };
        let z = wave(0.2 * radius, 0.37 * slow, 0.3, s);
        placed(centre, jet(share(0.0), share(-QUARTER), z))
    };
    Curve { name: "rosette", end, at: Box::new(at) }
}

/// Derivatives are those of the positions: checked before anything is measured with them.
pub fn check(curve: &Curve) {
    let h = curve.end * 1e-5;
    for part in 1..20 {
        let s = curve.end * (f64::from(part) + 0.37) / 21.0;
        let [before, here, after] = [s - h, s, s + h].map(|s| curve.at(s));
        for order in 0..3 {
            let difference = (after[order] - before[order]) / (2.0 * h);
            let scale = here[order + 1].norm().max(here[order].norm() * TAU / curve.end);
            let error = (difference - here[order + 1]).norm();
            assert!(error < 1e-4 * scale, "{} at {s}: order {order} is {error} off", curve.name);
        }
    }
}
