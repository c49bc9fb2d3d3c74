//! Curve distance: the largest difference between two cams.

use super::bounds::Peak;
use super::curve::Curve;
use super::knot::Piece;
use super::polynomial::{Coefficients, extremes, shifted};

impl Curve {
    /// The largest distance between the slave's positions on two curves, and where; exact: on every stretch on which both
    /// are one polynomial their difference is one, too. Only masters that both ranges hold count.
    pub fn largest_distance(&self, other: &Self) -> Peak {
        let (start, end) = (self.start().max(other.start()), self.end().min(other.end()));
        let mut found = Peak { value: 0.0, master: start };
        let mut joints: Vec<f64> = self.joints().chain(other.joints()).collect();
        joints.retain(|joint| (start..=end).contains(joint));
        joints.sort_by(f64::total_cmp);
        joints.dedup();
        for pair in joints.windows(2) {
            let [from, to] = pair else { continue };
            // What holds the middle holds all of the stretch.
            let middle = f64::midpoint(*from, *to);
            let (Some(one), Some(two)) = (holding(self, middle), holding(other, middle)) else {
                continue;
            };
            let [mut apart, two] = [one, two].map(|piece| from_there(piece, *from));
            for (apart, two) in apart.iter_mut().zip(two) {
                *apart -= two;
            }
            let reached = extremes(&apart, to - from);
            for (at, value) in [(reached.at_min, reached.min), (reached.at_max, reached.max)] {
                if value.abs() > found.value {
                    found = Peak { value: value.abs(), master: from + at };
                }
            }
        }
        found
    }
}

fn holding(curve: &Curve, master: f64) -> Option<&Piece> {
    let index = curve.pieces().partition_point(|piece| piece.start <= master);
    curve.pieces().get(index.checked_sub(1)?)
}

/// The position on a piece, counted from a master.
fn from_there(piece: &Piece, master: f64) -> Coefficients {
    let [position, ..] = piece.polynomials();
    shifted(&position, master - piece.start)
}
