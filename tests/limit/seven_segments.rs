//! Least time from rest to rest over a distance with limited velocity, acceleration and jerk: up to seven segments of
//! constant jerk.

use crate::path::Limits;

/// Limits that the motion reaches in addition to that of jerk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaches {
    Both,
    AccelerationAlone,
    VelocityAlone,
    Neither,
}

/// Duration of the motion over `distance`, s, and the limits it reaches.
///
/// A speed v is reached from rest in t(v) = v/A + A/J, or 2·√(v/J) if it is less than A²/J; the way is v·t/2, since a
/// symmetric ramp has half of v on average.
pub fn duration(distance: f64, limits: Limits) -> (f64, Reaches) {
    let Limits { velocity, acceleration, jerk } = limits;
    let full = velocity >= acceleration * acceleration / jerk;
    let ramp = if full {
        velocity / acceleration + acceleration / jerk
    } else {
        2.0 * (velocity / jerk).sqrt()
    };
    if distance >= velocity * ramp {
        let reaches = if full { Reaches::Both } else { Reaches::VelocityAlone };
        return (ramp + distance / velocity, reaches);
    }
    // No cruise: distance = v·t(v).
    let half = 0.5 * acceleration / jerk;
    let peak = acceleration * ((half * half + distance / acceleration).sqrt() - half);
    if peak >= acceleration * acceleration / jerk {
        (2.0 * (peak / acceleration + acceleration / jerk), Reaches::AccelerationAlone)
    } else {
        (4.0 * (0.5 * distance / jerk).cbrt(), Reaches::Neither)
    }
}

/// The same without a limit of jerk: a trapezoid or a triangle of velocity.
pub fn trapezoid(distance: f64, velocity: f64, acceleration: f64) -> f64 {
    if distance * acceleration >= velocity * velocity {
        distance / velocity + velocity / acceleration
    } else {
        2.0 * (distance / acceleration).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits { velocity: 0.4, acceleration: 3.0, jerk: 60.0 };

    /// Way, largest velocity and largest acceleration of jerks that last so long.
    fn integrated(segments: &[(f64, f64)]) -> [f64; 3] {
        let [mut s, mut v, mut a] = [0.0_f64; 3];
        let [mut fastest, mut strongest] = [0.0_f64; 2];
        for (jerk, time) in segments {
            s += time * (v + time * (a / 2.0 + time * jerk / 6.0));
            v += time * (a + time * jerk / 2.0);
            a += time * jerk;
            fastest = fastest.max(v);
            strongest = strongest.max(a.abs());
        }
        assert!(v.abs() < 1e-12 && a.abs() < 1e-12, "it ends at rest");
        [s, fastest, strongest]
    }

    /// The profile of this duration, integrated, goes the distance and reaches what it is said to reach and no more:
    /// with the first of its times and the sum of all given, the rest follows from symmetry.
    #[test]
    fn profiles_go_the_distance() {
        let slow = Limits { velocity: 0.1, ..LIMITS };
        let cases = [
            (0.3, LIMITS, Reaches::Both),
            (0.03, LIMITS, Reaches::AccelerationAlone),
            (0.3, slow, Reaches::VelocityAlone),
            (0.005, LIMITS, Reaches::Neither),
        ];
        for (distance, limits, expected) in cases {
            let Limits { velocity, acceleration, jerk } = limits;
            let (duration, reaches) = super::duration(distance, limits);
            assert_eq!(reaches, expected);
            // Of one ramp: jerk for t1, constant acceleration for t2, jerk for t1; then cruise for t4.
            let (t1, t2, t4) = match reaches {
                Reaches::Both => {
                    let t1 = acceleration / jerk;
                    let t2 = velocity / acceleration - t1;
                    (t1, t2, duration - 2.0 * (2.0 * t1 + t2))
                }
                Reaches::AccelerationAlone => {
                    let t1 = acceleration / jerk;
                    (t1, 0.5 * duration - 2.0 * t1, 0.0)
                }
                Reaches::VelocityAlone => {
                    let t1 = (velocity / jerk).sqrt();
                    (t1, 0.0, duration - 4.0 * t1)
                }
                Reaches::Neither => (0.25 * duration, 0.0, 0.0),
            };
            assert!(t1 > 0.0 && t2 >= 0.0 && t4 >= 0.0, "{reaches:?}: {t1} {t2} {t4}");
            let ramp = [(jerk, t1), (0.0, t2), (-jerk, t1)];
            let brake = [(-jerk, t1), (0.0, t2), (jerk, t1)];
            let [way, fastest, strongest] =
                integrated(&[&ramp[..], &[(0.0, t4)], &brake[..]].concat());
            assert!((way - distance).abs() < 1e-12, "{reaches:?}: {way} m");
            let at = |value: f64, limit: f64, reached: bool| {
                if reached { (value - limit).abs() < 1e-12 } else { value < limit }
            };
            let [speed, force] = match reaches {
                Reaches::Both => [true, true],
                Reaches::AccelerationAlone => [false, true],
                Reaches::VelocityAlone => [true, false],
                Reaches::Neither => [false, false],
            };
            assert!(at(fastest, velocity, speed), "{reaches:?}: {fastest} m/s");
            assert!(at(strongest, acceleration, force), "{reaches:?}: {strongest} m/s²");
        }
    }

    /// Where one case goes over into the next, both say the same; so does the trapezoid at boundless jerk.
    #[test]
    fn cases_meet() {
        let Limits { velocity, acceleration, jerk } = LIMITS;
        let near = |at: f64, limits: Limits| {
            let (below, one) = duration(at * (1.0 - 1e-9), limits);
            let (above, other) = duration(at * (1.0 + 1e-9), limits);
            assert!(one != other, "nothing changes at {at}");
            assert!((above - below).abs() < 1e-8, "{below} {above}");
        };
        near(velocity * (velocity / acceleration + acceleration / jerk), LIMITS);
        near(2.0 * acceleration.powi(3) / jerk.powi(2), LIMITS);
        let slow = Limits { velocity: 0.1, ..LIMITS };
        near(0.1 * 2.0 * (0.1 / jerk).sqrt(), slow);
        for distance in [0.3, 0.03] {
            let (duration, _) = duration(distance, Limits { jerk: 1e12, ..LIMITS });
            assert!((duration - trapezoid(distance, velocity, acceleration)).abs() < 1e-9);
        }
    }
}
