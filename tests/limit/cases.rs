//! Paths whose least time is known in closed form.

use crate::circle;
use crate::path::{Limits, Path, Rates, equal};
use crate::seven_segments::{duration, trapezoid};
use nalgebra::Vector2;
use std::f64::consts::TAU;
use twin_kinematics::scara::{Elbow, Scara2};
use twin_kinematics::transform::{Differential, Transform};

/// Path with its least time in closed form.
pub struct Case {
    pub name: String,
    /// Largest path parameter; the smallest is 0.
    pub end: f64,
    /// The path at these nodes.
    pub path: Box<dyn Fn(Vec<f64>) -> Path>,
    /// True if the jerk limits apply.
    pub jerk: bool,
    /// Squared rates at start and end, where they are not 0.
    pub ends: [f64; 2],
    /// The least time, s.
    pub duration: f64,
}

impl Case {
    /// True if it begins and ends at rest.
    pub fn rests(&self) -> bool {
        self.ends.iter().all(|squared| *squared <= 0.0)
    }

    /// The path in equal cells.
    pub fn path(&self, cells: usize) -> Path {
        (self.path)(equal(self.end, cells))
    }
}

/// All of them.
pub fn all() -> Vec<Case> {
    let mut cases = lines();
    cases.extend(circles());
    cases.extend(scara_lines());
    cases
}

/// Limits, distances and what they are for: both limits reached, one of them, none.
const RAMPS: [(f64, Limits, &str); 4] = [
    (0.3, Limits { velocity: 0.4, acceleration: 3.0, jerk: 60.0 }, "V and A"),
    (0.03, Limits { velocity: 0.4, acceleration: 3.0, jerk: 60.0 }, "A, not V"),
    (0.3, Limits { velocity: 0.1, acceleration: 3.0, jerk: 60.0 }, "V, not A"),
    (0.005, Limits { velocity: 0.4, acceleration: 3.0, jerk: 60.0 }, "neither"),
];

/// A line whose axes move by `way` while the parameter goes from 0 to `length`.
fn line(limits: Vec<Limits>, way: Vec<f64>, length: f64) -> Box<dyn Fn(Vec<f64>) -> Path> {
    Box::new(move |nodes| {
        let zero = vec![0.0; way.len()];
        let first = way.iter().map(|way| way / length).collect();
        let rates: Rates = [first, zero.clone(), zero];
        Path::new(limits.clone(), nodes, |_| rates.clone())
    })
}

fn lines() -> Vec<Case> {
    let mut cases = Vec::new();
    for (distance, limits, reaches) in RAMPS {
        let (least, _) = duration(distance, limits);
        let without = trapezoid(distance, limits.velocity, limits.acceleration);
        for (jerk, duration) in [(true, least), (false, without)] {
            cases.push(Case {
                name: format!("line along an axis, {}: {reaches}", word(jerk)),
                end: distance,
                path: line(vec![limits], vec![distance], distance),
                jerk,
                ends: [0.0; 2],
                duration,
            });
            // A diagonal (3, -4, 12)/13: of every kind of limit another axis is the one that counts.
            let share = [3.0 / 13.0, 4.0 / 13.0, 12.0 / 13.0];
            let Limits { velocity: v, acceleration: a, jerk: j } = limits;
            let wide = 1.5;
            let of = |share: f64, bind: [bool; 3]| {
                let [v, a, j] = [(v, bind[0]), (a, bind[1]), (j, bind[2])]
                    .map(|(limit, bind)| share * limit * if bind { 1.0 } else { wide });
                Limits { velocity: v, acceleration: a, jerk: j }
            };
            let limits = vec![
                of(share[0], [true, false, false]),
                of(share[1], [false, true, false]),
                of(share[2], [false, false, true]),
            ];
            let way = vec![distance * share[0], -distance * share[1], distance * share[2]];
            cases.push(Case {
                name: format!("line in space, {}: {reaches}", word(jerk)),
                end: distance,
                path: line(limits, way, distance),
                jerk,
                ends: [0.0; 2],
                duration,
            });
        }
    }
    cases
}

fn word(jerk: bool) -> &'static str {
    if jerk { "with jerk" } else { "without jerk" }
}

/// Once round a circle about the origin from (r, 0).
fn round(radius: f64, limits: Limits, feed: f64) -> Box<dyn Fn(Vec<f64>) -> Path> {
    Box::new(move |nodes| {
        let path = Path::new(vec![limits; 2], nodes, |s| {
            let (sine, cosine) = (s / radius).sin_cos();
            [
                vec![-sine, cosine],
                vec![-cosine / radius, -sine / radius],
                vec![sine / radius.powi(2), -cosine / radius.powi(2)],
            ]
        });
        Path { feed, ..path }
    })
}

fn circles() -> Vec<Case> {
    let (radius, far) = (0.05, 1e3);
    let acceleration = 2.0;
    let free = Limits { velocity: far, acceleration, jerk: far };
    let case = |name: &str, path, squared: f64, duration| Case {
        name: format!("circle, {name}"),
        end: TAU * radius,
        path,
        jerk: false,
        ends: [squared; 2],
        duration,
    };
    let quick = acceleration * radius;
    let feed = (0.5 * quick).sqrt();
    let steady = quick.sqrt();
    let velocity = 0.15;
    let strong = Limits { velocity, acceleration: 3.0 * velocity * velocity / radius, jerk: far };
    vec![
        case(
            "rolling, as fast as accelerations allow",
            round(radius, free, f64::INFINITY),
            quick,
            circle::rolling(radius, acceleration),
        ),
        case(
            "rolling, at the largest constant speed",
            round(radius, free, steady),
            quick,
            TAU * radius / steady,
        ),
        case(
            "from rest to rest",
            round(radius, free, f64::INFINITY),
            0.0,
            circle::rest_to_rest(radius, acceleration),
        ),
        case(
            "from rest to rest with a feed",
            round(radius, free, feed),
            0.0,
            circle::with_feed(radius, acceleration, feed),
        ),
        case(
            "rolling, as fast as velocities allow",
            round(radius, strong, f64::INFINITY),
            velocity * velocity,
            circle::with_velocity(radius, velocity),
        ),
    ]
}

/// A SCARA whose arms both turn linearly with g(u) = u + 0.4·sin(2πu)/(2π): one of them needs longest.
fn scara_lines() -> Vec<Case> {
    const EVEN: f64 = 0.4;
    // The first counts for velocity and jerk, the second for acceleration.
    let limits = vec![
        Limits { velocity: 4.2, acceleration: 30.0, jerk: 800.0 },
        Limits { velocity: 5.2, acceleration: 28.0, jerk: 1500.0 },
    ];
    let starts = Vector2::new(-0.4, 0.7);
    let mut cases = Vec::new();
    let ways: [(Vector2<f64>, _); 2] =
        [(Vector2::new(1.4, 1.5), "long"), (Vector2::new(0.1, 0.11), "short")];
    for (way, name) in ways {
        let along = |of: fn(&Limits) -> f64| {
            let axes = limits.iter().zip(way.iter());
            axes.map(|(limits, way)| of(limits) / way.abs()).fold(f64::INFINITY, f64::min)
        };
        let share = Limits {
            velocity: along(|limits| limits.velocity),
            acceleration: along(|limits| limits.acceleration),
            jerk: along(|limits| limits.jerk),
        };
        let (least, _) = duration(1.0, share);
        let without = trapezoid(1.0, share.velocity, share.acceleration);
        for (jerk, duration) in [(true, least), (false, without)] {
            let limits = limits.clone();
            cases.push(Case {
                name: format!("SCARA, both arms linear, {}: {name}", word(jerk)),
                end: 1.0,
                path: Box::new(move |nodes| {
                    Path::new(limits.clone(), nodes, |u| {
                        let turn = TAU * u;
                        let g = u + EVEN * turn.sin() / TAU;
                        let rates = [
                            1.0 + EVEN * turn.cos(),
                            -EVEN * TAU * turn.sin(),
                            -EVEN * TAU * TAU * turn.cos(),
                        ];
                        through_tool(&(starts + way * g), &rates.map(|rate| way * rate))
                    })
                }),
                jerk,
                ends: [0.0; 2],
                duration,
            });
        }
    }
    cases
}

/// The rates of the arms by way of the tool: what the transform makes of the tool's path.
fn through_tool(axes: &Vector2<f64>, rates: &[Vector2<f64>; 3]) -> Rates {
    let scara = Scara2::new([0.25, 0.2], [0.0; 2], Elbow::Low).expect("a SCARA");
    let (tool, differential) = scara.at_axes(axes).expect("within reach");
    let tool_rates = differential.lead_jerk(rates).expect("a SCARA always leads");
    let (back, differential) = scara.at_tool(&tool, axes).expect("within reach");
    assert!((back - axes).norm() < 1e-12);
    let followed = differential.follow_jerk(&tool_rates).expect("no arm is stretched");
    followed.map(|rate| rate.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::as_float;
    use crate::reachability;

    /// The closed forms without jerk are the limits of the slow linear programs on ever finer grids. Limits at the ends
    /// of cells alone make these err by as much as a cell is long: two grids tell where that leads.
    #[test]
    fn closed_forms_are_limits_of_linear_programs() {
        for case in all().into_iter().filter(|case| !case.jerk) {
            let found = [4_000, 8_000].map(|cells| {
                let path = case.path(cells);
                let squared = reachability::between(&path, case.ends[0], case.ends[1]);
                assert!(path.acceleration_use(&squared) <= 1.0 + 1e-9, "{}", case.name);
                path.duration(&squared)
            });
            let limit = 2.0 * found[1] - found[0];
            let error = limit / case.duration - 1.0;
            println!(
                "{:50} {:.9} s, {error:+.1e}; coarse {:+.1e}, fine {:+.1e}",
                case.name,
                case.duration,
                found[0] / case.duration - 1.0,
                found[1] / case.duration - 1.0
            );
            assert!(error.abs() < 1e-6, "{}: {limit} s instead of {}", case.name, case.duration);
        }
    }

    /// Jerk limits cost time, and the two of every line differ.
    #[test]
    fn jerk_limits_cost_time() {
        let (with, without): (Vec<_>, Vec<_>) =
            all().into_iter().filter(|case| !case.name.starts_with("circle")).partition(|c| c.jerk);
        assert_eq!(with.len(), without.len());
        for (with, without) in with.iter().zip(&without) {
            assert!(with.duration > without.duration * 1.01, "{}", with.name);
        }
    }

    /// On the way through tool coordinates the arms keep the rates they had.
    #[test]
    fn arms_move_linearly() {
        let case = all().pop().expect("a case");
        let path = case.path(100);
        for (node, [first, second, third]) in path.nodes.iter().zip(&path.rates) {
            for rate in [first, second, third] {
                let skew = rate[0] / 0.1 - rate[1] / 0.11;
                assert!(skew.abs() < 1e-7 * (rate[0] / 0.1).abs().max(1.0), "{node}: {skew}");
            }
        }
        let mean = path.rates.iter().map(|rates| rates[0][0]).sum::<f64>() - path.rates[0][0][0];
        assert!((mean / as_float(100) - 0.1).abs() < 1e-12);
    }
}
