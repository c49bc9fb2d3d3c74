//! Single lines from rest to rest with a feed, against the closed form with limited jerk.

use crate::path::Limits;
use crate::seven_segments::{Reaches, duration};
use crate::solvers::{Fineness, segments};
use std::collections::HashMap;
use twin_planner::planned_motion::ProfileSegment;

/// Random numbers (`SplitMix64`).
pub struct Random(pub u64);

impl Random {
    /// Uniform on a logarithmic scale.
    pub fn within(&mut self, from: f64, to: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let high = u32::try_from((z ^ (z >> 31)) >> 32).expect("32 bits");
        from * (to / from).powf(f64::from(high) / f64::from(u32::MAX))
    }
}

/// Plan of a line.
struct Line {
    /// Duration of the closed form, s, and the limits that it reaches.
    least: (f64, Reaches),
    /// What the plan takes longer, s.
    excess: f64,
    /// Largest velocity, acceleration and jerk as parts of their limits.
    most: [f64; 3],
}

/// Plans a line of `length`, m, with a feed, m/s.
fn line(length: f64, feed: f64, axis: Limits) -> Line {
    let rates = |_: f64| [vec![1.0], vec![0.0], vec![0.0]];
    let plan = segments(&[axis], true, (length, feed), rates, Fineness::ordinary());
    let (segments, effort) = plan.expect("a plan");
    assert_eq!((effort.failed, effort.exceeded), (0, 0), "{length} m, {feed} m/s, {axis:?}");
    let limits = Limits { velocity: feed.min(axis.velocity), ..axis };
    let mut most = [0.0_f64; 3];
    for segment in &segments {
        for part in 0..=8_u8 {
            let u = segment.length() * f64::from(part) / 8.0;
            let (b, acceleration) = segment.at_position(u);
            let values = [
                b.sqrt() / limits.velocity,
                acceleration / limits.acceleration,
                segment.jerk_at(u) / limits.jerk,
            ];
            for (most, value) in most.iter_mut().zip(values) {
                *most = most.max(value.abs());
            }
        }
    }
    let least = duration(length, limits);
    let found: f64 = segments.iter().map(ProfileSegment::duration).sum();
    Line { least, excess: found - least.0, most }
}

/// 0.053 mm at F6: the ramps take 2.6 ms each.
#[test]
fn a_slow_short_line_takes_its_feed() {
    let axis = Limits { velocity: 0.4, acceleration: 3.0, jerk: 60.0 };
    let Line { least: (least, _), excess, most } = line(5.3e-5, 1e-4, axis);
    assert!((least - 0.532_581_99).abs() < 1e-8, "{least} s");
    assert!((0.0..1e-4 * least).contains(&excess), "{excess:e} s");
    assert!(keeps(most), "{most:?}");
}

/// True if these parts of the limits of velocity, acceleration and jerk are allowed.
fn keeps([velocity, acceleration, jerk]: [f64; 3]) -> bool {
    velocity <= 1.001 && acceleration <= 1.001 && jerk <= 1.05
}

/// Above this jerk, m/s³, the acceleration builds up within a few of the shortest cells (40 µs at both ends, 80 µs between).
const HIGH_JERK: f64 = 1e3;

/// Lengths of 0.01 mm to 300 mm, feeds of 0.05 mm/s to 400 mm/s, jerks of 500 mm/s³ to 10⁸ mm/s³, within all limits. The plan
/// is not faster than the closed form. It is slower by at most 10⁻³; above 10⁶ mm/s³, by at most 2·10⁻³ (0.1 ms).
#[test]
fn lines_with_a_feed_take_the_closed_form() {
    let mut random = Random(1);
    let mut counts: HashMap<String, (u32, f64)> = HashMap::new();
    let (mut longest, mut largest, mut peak) = (0.0_f64, [0.0_f64; 2], [0.0_f64; 3]);
    for _ in 0..400 {
        let [length, feed] = [random.within(1e-5, 0.3), random.within(5e-5, 0.4)];
        let [acceleration, jerk] = [random.within(0.3, 30.0), random.within(0.5, 1e5)];
        // What takes long is mostly cruise.
        if length > 4.0 * feed {
            continue;
        }
        let axis = Limits { velocity: 0.4, acceleration, jerk };
        let Line { least: (least, reaches), excess, most } = line(length, feed, axis);
        let case = format!("{length:e} m, {feed:e} m/s, {axis:?}: {least} s, {excess:+e} s");
        let (part, high) = (excess / least, jerk > HIGH_JERK);
        assert!(part > -1e-6 && excess < 1e-4, "{case}");
        assert!(part < if high { 2e-3 } else { 1e-3 }, "{case}");
        assert!(keeps(most), "{case}: {most:?}");
        longest = longest.max(excess);
        largest[usize::from(high)] = largest[usize::from(high)].max(part);
        for (peak, most) in peak.iter_mut().zip(most) {
            *peak = peak.max(most);
        }
        let count = counts.entry(format!("{reaches:?}")).or_default();
        *count = (count.0 + 1, count.1.max(part));
    }
    let [low, high] = largest;
    println!("{longest:.1e} s, {low:.1e}, above 10⁶ mm/s³ {high:.1e}; {peak:?}; {counts:?}");
    assert!(counts.len() == 4 && counts.values().all(|(count, _)| *count >= 20), "{counts:?}");
}
