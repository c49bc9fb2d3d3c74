//! Least time from rest to rest over a distance with limited velocity, acceleration and jerk: up to seven segments of
//! constant jerk, in closed form.
//!
//! With the limits V, A and J over a distance D, the fastest motion raises the velocity to a peak v ≤ V by a ramp, cruises,
//! and lowers it by the mirrored ramp.
//!
//! **Ramp.** Jerk J for t₁, constant acceleration for t₂, jerk −J for t₁. The velocity changes by J·t₁·(t₁ + t₂) = v.
//!
//! - If v ≥ A²/J, the ramp reaches A: t₁ = A/J, t₂ = v/A − A/J, and its time is t(v) = v/A + A/J.
//! - If v < A²/J, it does not: t₁ = √(v/J), t₂ = 0 and t(v) = 2·√(v/J).
//!
//! A ramp is point-symmetric about its middle. Its mean velocity is v/2, its distance v·t(v)/2, that of both v·t(v).
//!
//! **With cruise**, D ≥ V·t(V): the peak is V, the cruise takes (D − V·t(V))/V, and the total is
//! 2·t(V) + D/V − t(V) = t(V) + D/V.
//!
//! **Without cruise**, D = v·t(v), and the total is 2·t(v):
//!
//! - If the ramp reaches A, v²/A + v·A/J = D, so v = A·(√(h² + D/A) − h) with h = A/2J.
//! - Otherwise D = 2·v·√(v/J) with v = J·t₁², so D = 2·J·t₁³, and the total is 4·t₁ = 4·∛(D/2J).

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

    /// Distance, limits of velocity, acceleration and jerk, and the duration that Ruckig computes, in m and s: six of each of
    /// the four kinds, after 0.053 mm at 0.1 mm/s.
    ///
    /// Ruckig 0.19.4 (the Python package `ruckig`), one degree of freedom, from 0 to `target_position` = the distance with
    /// velocities and accelerations of 0 at both ends; `max_velocity`, `max_acceleration` and `max_jerk` are the limits,
    /// `min_acceleration` is −`max_acceleration`. The duration is `trajectory.duration` after
    /// `Ruckig(1).calculate(input, trajectory)`, to 12 digits. `motion/profile/tests/ruckig_durations.py` computes it from
    /// lines `0 0 0 distance 0 velocity acceleration acceleration jerk`.
    const RUCKIG: [[f64; 5]; 25] = [
        [5.3e-5, 0.000_1, 3.0, 60.0, 0.532_581_988_897],
        [0.000_281_7, 0.000_194, 6.012, 1.21, 1.477_386_197_99],
        [0.002_507, 0.001_337, 0.391_8, 244.9, 1.880_105_784_9],
        [1.472e-5, 0.002_463, 0.413_8, 1.513, 0.067_775_534_84],
        [0.000_795_5, 0.084_38, 0.530_5, 7.627, 0.149_444_110_799],
        [0.006_443, 0.25, 4.279, 63.36, 0.148_186_160_981],
        [4.424e-5, 0.000_144_1, 1.242, 10_600.0, 0.307_242_211_046],
        [6.444e-5, 0.009_311, 5.688, 47.1, 0.035_244_785_163_5],
        [0.002_833, 8.791e-5, 0.394_8, 6.177, 32.233_685_389_8],
        [0.011_12, 0.002_333, 1.275, 635.4, 4.770_227_536_91],
        [0.001_069, 0.000_739_6, 11.64, 2537.0, 1.446_455_740_74],
        [0.000_123_8, 0.008_73, 3.369, 21_780.0, 0.016_926_941_679_3],
        [0.018_44, 0.000_665, 27.38, 2.113, 27.764_803_917_6],
        [0.000_744_7, 0.045_1, 0.604_1, 195.4, 0.073_380_508_836_7],
        [1.498e-5, 0.020_28, 10.15, 545.3, 0.009_579_483_594_41],
        [0.001_326, 0.019_55, 0.396_7, 2616.0, 0.117_259_303_664],
        [0.007_894, 0.375_9, 13.21, 16.13, 0.250_190_555_276],
        [0.000_533_6, 0.020_36, 0.332_8, 140.1, 0.082_494_758_904_5],
        [5.654e-5, 0.000_143_2, 0.393_6, 5907.0, 0.395_262_856_181],
        [3.794e-5, 0.000_462_8, 1.816, 20_820.0, 0.082_321_326_336_6],
        [2.295e-5, 0.002_833, 3.767, 24_090.0, 0.009_009_382_331_92],
        [5.596e-5, 0.051_51, 3.486, 6742.0, 0.008_546_906_469_44],
        [0.000_764_2, 0.190_9, 3.023, 329.8, 0.042_259_959_206_8],
        [0.003_067, 0.057_55, 0.489, 466.8, 0.159_442_734_338],
        [2.125e-5, 0.020_51, 11.09, 28_450.0, 0.003_185_609_231_42],
    ];

    #[test]
    fn durations_are_those_of_ruckig() {
        for [distance, velocity, acceleration, jerk, theirs] in RUCKIG {
            let limits = Limits { velocity, acceleration, jerk };
            let (ours, reaches) = duration(distance, limits);
            assert!(
                (ours / theirs - 1.0).abs() < 1e-9,
                "{limits:?}, {reaches:?}: {ours}, {theirs}"
            );
        }
    }
}
