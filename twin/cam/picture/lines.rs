//! Lines over the master.

use super::Shown;
use twin_plot::Point;

/// Points of a line over the whole width, and columns that are distinguished.
const POINTS: f64 = 1800.0;

/// A value over the master; where it jumps the line has a gap. Jumps between polynomials that are no wider than a column of
/// the picture are steep lines.
pub(super) fn line_of(shown: &Shown<'_>, value: impl Fn(f64) -> f64) -> Vec<Point> {
    let curve = shown.file.cam.curve();
    let joints: Vec<_> = curve.joints().collect();
    let width = curve.end() - curve.start();
    let mut line: Vec<Point> = Vec::new();
    let mut narrow = [false; 2];
    for pair in joints.windows(2) {
        let [from, to] = pair else { continue };
        let count = ((to - from) / width * POINTS).ceil().clamp(1.0, POINTS);
        narrow = [narrow[1], (to - from) * POINTS < width];
        let places = (0_u32..).map(f64::from).take_while(|index| *index <= count);
        for index in places {
            // Its own end, not the begin of the next.
            let inside = from + (to - from) * index / count;
            let place = if index < count { inside } else { to.next_down() };
            let point = (shown.using.master_at(place), value(place));
            let jumps = |last: &Point| index == 0.0 && !alike(last.1, point.1);
            if narrow != [true; 2] && line.last().is_some_and(jumps) {
                line.push((point.0, f64::NAN));
            }
            line.push(point);
        }
    }
    line
}

fn alike(one: f64, other: f64) -> bool {
    (one - other).abs() <= 1e-6 * one.abs().max(other.abs())
}
