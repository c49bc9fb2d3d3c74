//! Ambiguity of a path that is followed by position: places where an X has more than one point (manual 6.6).

use super::XDirection;
use twin_path::{ElementKind, PathElement};

/// X and lengths are equal to within this, m: rounding.
const EQUAL: f64 = 1e-9;

/// Points of an element that are compared with each other; the box around it is exact.
const POINTS: u32 = 128;

/// Reason why [`super::XInterpolator`] jumps on an element. "So that this happens without a jump, every X position must
/// have exactly one position on the path" (manual 6.6).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum XAmbiguity {
    /// X goes back against the direction of the workpiece, by this, m.
    Back(f64),
    /// X stays while the tool moves, by this, m; additional axes alone count as [`PathElement::length`] has it.
    Step(f64),
    /// The position is set anew (G92), so far away, m.
    Jump(f64),
}

impl XAmbiguity {
    /// What makes `element` ambiguous for a workpiece that moves in `direction`; `None` if each X has one point on it.
    pub fn of(element: &PathElement, direction: XDirection) -> Option<Self> {
        let sign = if direction == XDirection::Positive { 1.0 } else { -1.0 };
        let (start, end) = (element.start(), element.end());
        if element.kind == ElementKind::Jump {
            let way = (end - start).norm();
            return (way > EQUAL).then_some(Self::Jump(way));
        }
        let length = element.length();
        if length <= EQUAL {
            return None;
        }
        let [from, to] = [sign * start.x, sign * end.x];
        let bounds = element.shape.bounds();
        let ends = [sign * bounds.min.x, sign * bounds.max.x];
        let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        let mut back = (from - low).max(high - to);
        // A spline may turn twice between its ends.
        let mut farthest = from;
        for point in 1..POINTS {
            let s = length * f64::from(point) / f64::from(POINTS);
            let x = sign * element.at(s).position.x;
            farthest = farthest.max(x);
            back = back.max(farthest - x);
        }
        if back > EQUAL {
            Some(Self::Back(back))
        } else if to - from <= EQUAL {
            Some(Self::Step(length))
        } else {
            None
        }
    }
}
