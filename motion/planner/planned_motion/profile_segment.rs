//! Profile segment: motion through one cell over time.

use std::f64::consts::FRAC_PI_2;

/// Velocities and accelerations are the same to this part of them.
const SAME: f64 = 1e-9;

/// Motion of the path in a cell: the parameter from the start of the cell and its derivatives by time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// u from the start of the cell, m.
    pub position: f64,
    /// u̇, m/s.
    pub velocity: f64,
    /// ü, m/s².
    pub acceleration: f64,
    /// u⃛, m/s³.
    pub jerk: f64,
}

/// Law of motion in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SegmentLaw {
    /// u̇² = `b` + 2·`a`·u + `gamma`·u²: the acceleration is linear in u.
    Quadratic {
        /// u̇² at the start, m²/s².
        b: f64,
        /// ü at the start, m/s².
        a: f64,
        /// dü/du, 1/s².
        gamma: f64,
    },
    /// From rest, with constant jerk.
    Launch {
        /// u⃛, m/s³.
        jerk: f64,
    },
    /// To rest, with constant jerk: a launch backwards.
    Landing {
        /// u⃛, m/s³.
        jerk: f64,
    },
    /// With constant jerk from any motion.
    Jerk {
        /// u̇ at the start, m/s.
        velocity: f64,
        /// ü at the start, m/s².
        acceleration: f64,
        /// u⃛, m/s³.
        jerk: f64,
    },
}

/// Profile segment: a cell of the path and the law of motion through it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileSegment {
    length: f64,
    law: SegmentLaw,
    duration: f64,
}

impl ProfileSegment {
    /// A cell of `length` gone through by `law`, whose u̇² must be positive at least at one end and nowhere negative.
    pub fn new(length: f64, law: SegmentLaw) -> Self {
        let duration = match law {
            SegmentLaw::Quadratic { b, a, gamma } => quadratic_duration(length, b, a, gamma),
            SegmentLaw::Launch { jerk } | SegmentLaw::Landing { jerk } => {
                (6.0 * length / jerk).cbrt()
            }
            SegmentLaw::Jerk { velocity, acceleration, jerk } => {
                jerk_duration(length, velocity, acceleration, jerk)
            }
        };
        Self { length, law, duration }
    }

    /// A cell of this `length` (m), with the u̇² (m²/s²) at both ends and the same acceleration all the way.
    pub fn uniform(length: f64, from: f64, to: f64) -> Self {
        Self::new(
            length,
            SegmentLaw::Quadratic { b: from, a: 0.5 * (to - from) / length, gamma: 0.0 },
        )
    }

    /// A cell of this `length` (m), with the u̇² (m²/s²) at both ends; b = `middle` bends it in Bézier's way.
    pub fn bent(length: f64, from: f64, middle: f64, to: f64) -> Self {
        let a = (middle - from) / length;
        let gamma = (from - 2.0 * middle + to) / (length * length);
        Self::new(length, SegmentLaw::Quadratic { b: from, a, gamma })
    }

    /// From rest to u̇² = `b` (m²/s²) over `length` (m), with constant jerk.
    pub fn launch(length: f64, b: f64) -> Self {
        Self::new(length, SegmentLaw::Launch { jerk: rest_jerk(length, b) })
    }

    /// From u̇² = `b` (m²/s²) to rest over `length` (m), with constant jerk.
    pub fn landing(length: f64, b: f64) -> Self {
        Self::new(length, SegmentLaw::Landing { jerk: rest_jerk(length, b) })
    }

    /// `duration` s with constant `jerk` (m/s³), from `velocity` (m/s) and `acceleration` (m/s²) to the end of `length` (m). The
    /// velocity is never negative.
    pub(crate) fn jerk(
        (length, duration): (f64, f64),
        [velocity, acceleration, jerk]: [f64; 3],
    ) -> Self {
        Self { length, law: SegmentLaw::Jerk { velocity, acceleration, jerk }, duration }
    }

    /// This one and the `next` as one, if both have the same constant jerk and the motion goes on.
    pub(crate) fn joined(&self, next: &Self) -> Option<Self> {
        let (
            SegmentLaw::Jerk { velocity, acceleration, jerk },
            SegmentLaw::Jerk { velocity: from, acceleration: rate, jerk: other },
        ) = (self.law, next.law)
        else {
            return None;
        };
        let end = self.at(self.duration);
        let near =
            |one: f64, other: f64| (one - other).abs() <= SAME * (one.abs() + other.abs() + SAME);
        let goes_on = jerk.to_bits() == other.to_bits()
            && near(end.velocity, from)
            && near(end.acceleration, rate);
        let takes = (self.length + next.length, self.duration + next.duration);
        goes_on.then(|| Self::jerk(takes, [velocity, acceleration, jerk]))
    }

    /// Length of the cell, m.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Time for it, s.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// √|γ| where γ is not 0: how fast the exponential functions are that it is made of, 1/s.
    pub(crate) fn rate(&self) -> Option<f64> {
        match self.law {
            SegmentLaw::Quadratic { gamma, .. } if gamma != 0.0 => Some(gamma.abs().sqrt()),
            _ => None,
        }
    }

    /// Its law of motion.
    pub fn law(&self) -> SegmentLaw {
        self.law
    }

    /// u̇² and ü where the parameter is `u` from the start.
    pub fn at_position(&self, u: f64) -> (f64, f64) {
        let rest = |jerk: f64, u: f64| {
            let t = (6.0 * u.max(0.0) / jerk).cbrt();
            ((0.5 * jerk * t * t).powi(2), jerk * t)
        };
        match self.law {
            SegmentLaw::Quadratic { b, a, gamma } => {
                ((b + u * (2.0 * a + gamma * u)).max(0.0), a + gamma * u)
            }
            SegmentLaw::Launch { jerk } => rest(jerk, u),
            SegmentLaw::Landing { jerk } => {
                let (b, a) = rest(jerk, self.length - u);
                (b, -a)
            }
            SegmentLaw::Jerk { velocity, acceleration, jerk } => {
                // Where it rests at its end, the position says little about the time.
                let time = if u >= self.length {
                    self.duration
                } else {
                    jerk_duration(u.max(0.0), velocity, acceleration, jerk)
                };
                let Progress { velocity, acceleration, .. } = self.at(time);
                (velocity * velocity, acceleration)
            }
        }
    }

    /// u⃛ where the parameter is `u` from the start.
    pub fn jerk_at(&self, u: f64) -> f64 {
        match self.law {
            SegmentLaw::Quadratic { gamma, .. } => gamma * self.at_position(u).0.sqrt(),
            SegmentLaw::Launch { jerk }
            | SegmentLaw::Landing { jerk }
            | SegmentLaw::Jerk { jerk, .. } => jerk,
        }
    }

    /// Motion `time` s after the start of the cell.
    pub fn at(&self, time: f64) -> Progress {
        let time = time.clamp(0.0, self.duration);
        match self.law {
            SegmentLaw::Quadratic { b, a, gamma } => {
                let start = b.max(0.0).sqrt();
                let (s, c) = hyperbolic(gamma, time);
                let position = (start * s + a * c).clamp(0.0, self.length);
                // u̇ = v₀·S′ + a·C′ with S′ = 1 + γ·C and C′ = S.
                let velocity = (start * (1.0 + gamma * c) + a * s).max(0.0);
                let acceleration = a + gamma * position;
                Progress { position, velocity, acceleration, jerk: gamma * velocity }
            }
            SegmentLaw::Launch { jerk } => constant_jerk(jerk, time),
            SegmentLaw::Landing { jerk } => {
                let left = constant_jerk(jerk, self.duration - time);
                Progress {
                    position: self.length - left.position,
                    velocity: left.velocity,
                    acceleration: -left.acceleration,
                    jerk,
                }
            }
            SegmentLaw::Jerk { velocity, acceleration, jerk } => {
                let way = time * (velocity + time * (0.5 * acceleration + time * jerk / 6.0));
                Progress {
                    position: way.clamp(0.0, self.length),
                    velocity: (velocity + time * (acceleration + 0.5 * time * jerk)).max(0.0),
                    acceleration: acceleration + time * jerk,
                    jerk,
                }
            }
        }
    }
}

fn constant_jerk(jerk: f64, time: f64) -> Progress {
    Progress {
        position: jerk * time * time * time / 6.0,
        velocity: 0.5 * jerk * time * time,
        acceleration: jerk * time,
        jerk,
    }
}

/// Time for `length` with constant jerk from this velocity and acceleration: the first root of a cubic, between bounds by halving
/// and Newton's method.
fn jerk_duration(length: f64, velocity: f64, acceleration: f64, jerk: f64) -> f64 {
    let left = |t: f64| t * (velocity + t * (0.5 * acceleration + t * jerk / 6.0)) - length;
    let rate = |t: f64| velocity + t * (acceleration + 0.5 * t * jerk);
    if length <= 0.0 {
        return 0.0;
    }
    // Where the velocity ends to be positive nothing further is reached.
    let turn = first_turn(velocity, acceleration, jerk);
    let mut low = 0.0;
    let mut high = if turn.is_finite() { turn } else { f64::MIN_POSITIVE.sqrt() };
    while turn.is_infinite() && left(high) < 0.0 {
        (low, high) = (high, 2.0 * high);
    }
    let mut time = f64::midpoint(low, high);
    for _ in 0..200 {
        let error = left(time);
        if error > 0.0 {
            high = time;
        } else {
            low = time;
        }
        let next = time - error / rate(time);
        let next = if next > low && next < high { next } else { f64::midpoint(low, high) };
        if (next - time).abs() <= 1e-15 * time {
            break;
        }
        time = next;
    }
    time
}

/// When a velocity that is positive first becomes 0 with constant jerk; infinite if it never does.
fn first_turn(velocity: f64, acceleration: f64, jerk: f64) -> f64 {
    let root = acceleration * acceleration - 2.0 * jerk * velocity;
    // Citardauq's form has no cancellation where both terms have one sign.
    let time = if root < 0.0 {
        f64::INFINITY
    } else if acceleration > 0.0 {
        if jerk < 0.0 { (acceleration + root.sqrt()) / -jerk } else { f64::INFINITY }
    } else {
        2.0 * velocity / (root.sqrt() - acceleration)
    };
    if time > 0.0 { time } else { f64::INFINITY }
}

/// The jerk that leads from rest to u̇² = `b` within `length`.
fn rest_jerk(length: f64, b: f64) -> f64 {
    // b = ¼·j^⅔·(6·length)^4/3.
    (4.0 * b).powf(1.5) / (36.0 * length * length)
}

/// S(t) = sinh(√γ·t)/√γ and C(t) = (cosh(√γ·t) − 1)/γ, which solve u⃛ = γ·u̇; sine and cosine for γ < 0.
fn hyperbolic(gamma: f64, time: f64) -> (f64, f64) {
    let z = gamma * time * time;
    if z.abs() < 1e-2 {
        // To the last digit by series.
        let s = time * (1.0 + z / 6.0 * (1.0 + z / 20.0 * (1.0 + z / 42.0 * (1.0 + z / 72.0))));
        let c = 0.5
            * time
            * time
            * (1.0 + z / 12.0 * (1.0 + z / 30.0 * (1.0 + z / 56.0 * (1.0 + z / 90.0))));
        return (s, c);
    }
    let root = gamma.abs().sqrt();
    let half = 0.5 * root * time;
    if gamma > 0.0 {
        ((2.0 * half).sinh() / root, 2.0 * half.sinh().powi(2) / gamma)
    } else {
        ((2.0 * half).sin() / root, -2.0 * half.sin().powi(2) / gamma)
    }
}

/// Time for `length` with u̇² = b + 2·a·u + γ·u².
fn quadratic_duration(length: f64, b: f64, a: f64, gamma: f64) -> f64 {
    let from = b.max(0.0).sqrt();
    let to = (b + length * (2.0 * a + gamma * length)).max(0.0).sqrt();
    // Through the mean velocity; exact for γ = 0.
    let mut time = 2.0 * length / (from + to);
    if gamma == 0.0 {
        // Newton's method would divide by the velocity, which may be 0 at the end.
        return time;
    }
    let z = gamma * time * time;
    if z.abs() > 0.5 {
        // Closed form: √γ·T = ln((√γ·v₁ + a₁)/(√γ·v₀ + a₀)), or the angle between the two phases.
        let end = a + gamma * length;
        let root = gamma.abs().sqrt();
        time = if gamma > 0.0 {
            let forward = ((root * to + end) / (root * from + a)).ln();
            let backward = ((root * from - a) / (root * to - end)).ln();
            let best = if a + end >= 0.0 { forward } else { backward };
            best / root
        } else {
            let phase =
                |v: f64, a: f64| if v == 0.0 && a == 0.0 { FRAC_PI_2 } else { (root * v).atan2(a) };
            // The acceleration falls along the way: from phase(v₀, a₀) to phase(v₁, a₁).
            (phase(to, end) - phase(from, a)).abs() / root
        };
    }
    // Newton's method on the position reached, which takes the rounding of either form away.
    for _ in 0..4 {
        let (s, c) = hyperbolic(gamma, time);
        let velocity = from * (1.0 + gamma * c) + a * s;
        let step = (from * s + a * c - length) / velocity;
        if !step.is_finite() || step.abs() > 0.5 * time {
            break;
        }
        time -= step;
        if step.abs() <= 1e-15 * time {
            break;
        }
    }
    time
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Time by the midpoint rule, in a variable that takes the roots at the ends away.
    fn quadrature(stretch: &ProfileSegment) -> f64 {
        const PARTS: u32 = 20_000;
        let value = |index: u32| {
            let w = (f64::from(index) + 0.5) / f64::from(PARTS);
            // u = L·(10w³ − 15w⁴ + 6w⁵): no slope and no curvature at both ends.
            let u = stretch.length * w * w * w * (10.0 - w * (15.0 - 6.0 * w));
            let slope = stretch.length * 30.0 * (w * (1.0 - w)).powi(2);
            slope / stretch.at_position(u).0.sqrt()
        };
        (0..PARTS).map(value).sum::<f64>() / f64::from(PARTS)
    }

    fn check(stretch: &ProfileSegment) {
        let time = stretch.duration();
        let end = stretch.at(time);
        assert!(
            (end.position - stretch.length).abs() <= 1e-12 * stretch.length,
            "{stretch:?} {end:?}"
        );
        let expected = quadrature(stretch);
        assert!((time - expected).abs() <= 1e-6 * expected, "{stretch:?}: {time} {expected}");
        // Each derivative is that of the one before.
        let h = time * 1e-4;
        for part in [0.2, 0.5, 0.8] {
            let t = part * time;
            let [before, here, after] = [t - h, t, t + h].map(|t| stretch.at(t));
            let close = |difference: f64, value: f64, size: f64| {
                assert!(
                    (difference - value).abs() <= 1e-5 * size,
                    "{stretch:?}: {difference} {value}"
                );
            };
            let speed = stretch.length / time;
            close((after.position - before.position) / (2.0 * h), here.velocity, speed);
            close((after.velocity - before.velocity) / (2.0 * h), here.acceleration, speed / time);
            close(
                (after.acceleration - before.acceleration) / (2.0 * h),
                here.jerk,
                speed / time / time,
            );
            let (b, a) = stretch.at_position(here.position);
            close(b.sqrt(), here.velocity, speed);
            close(a, here.acceleration, speed / time);
        }
    }

    proptest! {
        #[test]
        fn time_and_way_fit(length in 1e-6..1.0_f64, from in 1e-3..1.0_f64, middle in 1e-3..1.0_f64, to in 1e-3..1.0_f64) {
            check(&ProfileSegment::bent(length, from, middle, to));
        }

        #[test]
        fn from_and_to_rest(length in 1e-9..1.0_f64, b in 1e-6..1.0_f64) {
            check(&ProfileSegment::launch(length, b));
            check(&ProfileSegment::landing(length, b));
            let end = ProfileSegment::launch(length, b).at(1e9);
            prop_assert!((end.velocity.powi(2) - b).abs() <= 1e-12 * b);
            prop_assert!(ProfileSegment::landing(length, b).at(1e9).velocity.abs() <= 0.0);
        }
    }

    #[test]
    fn uniform_from_rest_is_the_school_formula() {
        let stretch = ProfileSegment::uniform(0.5, 0.0, 1.0);
        assert!((stretch.duration() - 1.0).abs() < 1e-15);
        assert!((stretch.at(0.5).position - 0.125).abs() < 1e-15);
        check(&stretch);
        check(&ProfileSegment::uniform(0.5, 1.0, 0.0));
    }

    /// Where the square of the velocity at the end is 0 but for its rounding, the time is that of the school formula as well.
    #[test]
    fn uniform_to_rest_takes_its_time() {
        let (length, b) = (3.890_243_159_207_496e-8, 7.934_570_312_567_944e-8_f64);
        let time = ProfileSegment::uniform(length, b, 0.0).duration();
        assert!((time / (2.0 * length / b.sqrt()) - 1.0).abs() < 1e-9, "{time}");
    }
}
