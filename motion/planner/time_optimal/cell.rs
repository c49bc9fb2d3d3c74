//! Cell: a part of an element of the blended path with its limits at both ends.

use super::bound::{AxisLimits, Cap, Disc, FIRST_FURTHER_ROW, Rates, Row};
use super::drag::DragRow;
use crate::blended_path::BlendedElement;
use crate::planned_motion::ProfileSegment;
use std::sync::Arc;
use twin_kinematics::AxisVector;

/// Rows along the path: the programmed acceleration and deceleration.
pub(super) const ALONG: usize = FIRST_FURTHER_ROW as usize;

/// Sample: the limits at one place of an element.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    pub(super) position: AxisVector,
    pub(super) rates: Rates,
    pub(super) cap: Cap,
    /// Bound of u̇² at a joint, if this is one.
    pub(super) transition: Cap,
    /// The programmed accelerations along the path.
    pub(super) along: [Row; ALONG],
    /// Rows of [`AxisPath::further`].
    pub(super) further: Vec<DragRow>,
    /// Drag is counted as it is at this u̇; for more at any other.
    pub(super) reference: f64,
    pub(super) disc: Option<Disc>,
}

impl Sample {
    /// Puts all half planes into `rows`, in the order of their numbers.
    pub(super) fn put_rows(&self, rows: &mut Vec<Row>) {
        rows.clear();
        rows.extend(self.along);
        rows.extend(self.further.iter().map(|row| row.tangent(self.reference)));
    }

    /// The bound of u̇².
    pub(super) fn cap(&self) -> f64 {
        self.cap.v2
    }

    /// The largest acceleration, jerk and velocity, of any axis and along the path, where the motion is that of `segment` at
    /// `u`, each as a part of the limit.
    pub(super) fn excess(
        &self,
        limits: &[AxisLimits],
        segment: &ProfileSegment,
        u: f64,
    ) -> [f64; 3] {
        let (b, a) = segment.at_position(u);
        let (v, jerk) = (b.sqrt(), segment.jerk_at(u));
        let Rates { first, second, third } = &self.rates;
        let axes = first.iter().zip(second.iter()).zip(third.iter()).zip(limits);
        let along = self.along.iter().map(|row| row.a * a + row.b * b);
        let further = self.further.iter().map(|row| row.part(a, v));
        let cap = self.cap.min(self.transition);
        let mut worst = [along.chain(further).fold(0.0, f64::max), 0.0, v / cap.v2.sqrt()];
        if let Some(Disc { a: first, b: second }) = &self.disc {
            let square: f64 =
                first.iter().zip(second).map(|(d1, d2)| (d1 * a + d2 * b).powi(2)).sum();
            worst[0] = worst[0].max(square.sqrt());
        }
        for (((d1, d2), d3), limits) in axes {
            let acceleration = d1 * a + d2 * b;
            worst[0] = worst[0].max(acceleration.abs() / limits.acceleration_at(*d1, acceleration));
            worst[2] = worst[2].max((d1 * v).abs() / limits.velocity);
            if let Some(limit) = limits.jerk {
                let jerk = d1 * jerk + 3.0 * d2 * a * v + d3 * b * v;
                worst[1] = worst[1].max(jerk.abs() / limit);
            }
        }
        worst
    }
}

/// A part of an element.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    pub(super) element: Arc<BlendedElement>,
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) start: Arc<Sample>,
    pub(super) end: Arc<Sample>,
    pub(super) middle: Arc<Sample>,
    /// Bound of u̇² at its end: a joint that is not rounded.
    pub(super) joint: Cap,
    /// By how much acceleration, jerk and velocity are limited more tightly than they are, because between the places where
    /// limits are asked for they were exceeded.
    pub(super) tight: [f64; 3],
    /// True if jerks are limited at its ends as well, because they were exceeded there.
    pub(super) dense: bool,
    /// True if all axes move as evenly as the path: the same limits hold everywhere in it.
    pub(super) is_even: bool,
}

impl Cell {
    /// Sample at a part of the length of a cell in which the axes move evenly.
    pub(super) fn between(&self, part: f64) -> Sample {
        let ends = self.start.position.iter().zip(self.end.position.iter());
        let position = AxisVector::from_values(ends.map(|(from, to)| from + part * (to - from)));
        Sample { position, transition: Cap::NONE, ..Sample::clone(&self.start) }
    }

    pub(super) fn length(&self) -> f64 {
        self.to - self.from
    }
}
