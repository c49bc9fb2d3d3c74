//! Jumps of a cam at its joints, and those that a master passes.

use super::curve::Curve;

/// Jumps of a curve's slave, of a periodic curve or not; [`Curve::real_jumps`] gives the largest.
///
/// Of a curve that is not periodic both ends are among them, where the slave stays from now on, or leaves at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Joints {
    /// By ascending places.
    places: Vec<Joint>,
    width: f64,
    repeated: bool,
}

/// A place where a slave jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Its place on the scale of the cam, passes included, u.
    pub place: f64,
    /// By how much position (u) and y′ rise there towards greater places; 0 where they do not.
    pub rises: [f64; 2],
}

impl Joints {
    /// Those of a curve.
    pub fn of(curve: &Curve, repeated: bool) -> Self {
        let (start, end) = (curve.start(), curve.end());
        let width = end - start;
        let sizes = curve.jump_sizes();
        let joint = |place: f64, rises: [f64; 2]| {
            let [position, velocity] = rises;
            let real = |rise: f64, size: f64| if Curve::is_jump(rise, size) { rise } else { 0.0 };
            let rises = [real(position, sizes[0]), real(velocity, sizes[1])];
            rises.iter().any(|rise| *rise != 0.0).then_some(Joint { place, rises })
        };
        let pieces = curve.pieces();
        let inner = pieces.iter().zip(pieces.iter().skip(1)).filter_map(|(before, after)| {
            let (from, to) = (before.end(), after.begin());
            joint(after.start, [to.position - from.position, to.velocity - from.velocity])
        });
        let [first, last] = [curve.at(start), curve.at(end)];
        let ends = if repeated {
            [joint(start, [0.0, first.velocity - last.velocity]), None]
        } else {
            [joint(start, [0.0, first.velocity]), joint(end, [0.0, -last.velocity])]
        };
        let [begin, stop] = ends;
        Self { places: begin.into_iter().chain(inner).chain(stop).collect(), width, repeated }
    }

    /// True if the slave does not jump.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Those that a master passes from one place to another, the first one not included: where each rises most, if it does.
    pub fn passed(&self, from: f64, to: f64) -> [Option<Joint>; 2] {
        let mut found: [Option<Joint>; 2] = [None; 2];
        let mut take = |joint: &Joint, by: f64| {
            for (index, slot) in found.iter_mut().enumerate() {
                let rise = |joint: &Joint| joint.rises.get(index).map_or(0.0, |rise| rise.abs());
                if rise(joint) > slot.as_ref().map_or(0.0, rise) {
                    *slot = Some(Joint { place: joint.place + by, ..*joint });
                }
            }
        };
        let (low, high) = (from.min(to), from.max(to));
        // Where it is begun from is behind the master, and what it comes to is passed.
        let passes = |place: f64| {
            if to >= from { low < place && place <= high } else { low <= place && place < high }
        };
        let all = self.repeated && high - low >= self.width;
        // The first pass that there is something of.
        let Some(first) = self.places.first().map(|joint| joint.place) else { return found };
        let [one, last] = if self.repeated && !all {
            [low, high].map(|place| ((place - first) / self.width).floor())
        } else {
            [0.0; 2]
        };
        let mut pass = one;
        while pass <= last {
            let by = pass * self.width;
            let begin =
                if all { 0 } else { self.places.partition_point(|joint| joint.place + by < low) };
            for joint in self.places.get(begin..).unwrap_or_default() {
                if !all && joint.place + by > high {
                    break;
                }
                if all || passes(joint.place + by) {
                    take(joint, by);
                }
            }
            let next = pass + 1.0;
            // So far away no number tells one pass from the next.
            if next <= pass {
                break;
            }
            pass = next;
        }
        found
    }
}
