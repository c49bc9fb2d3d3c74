//! Heading: the direction of the path seen from above, for an axis that turns a knife or the last arm of a SCARA.

use nalgebra::Vector2;
use twin_kinematics::direction_rates;
use twin_path::{PathElement, PathPoint};

/// A tangent whose horizontal part is no longer than this goes straight up or down: what is left, a nanometre per metre,
/// is rounding.
const UPRIGHT: f64 = 1e-9;

/// Direction of the path seen from above, in the program's frame (SoftMotion manual 8.2.1 and 8.2.2).
///
/// It is that of the path as programmed: a knife backed up along its cut does not turn round. At rest it is that of the
/// element under way. Where the path has no direction seen from above (straight up or down, dwells, M functions, jumps,
/// elements without length), it stays as it was. If nothing came before, it is that in which the path will first go,
/// as far as the look-ahead reaches, so that a knife turns before it is lowered; 0 if that is not known yet. As long as
/// it is not, it is looked for at rest only: no knife turns while it goes down.
///
/// It steps where the path has a corner and, by a whole turn, where it passes −x.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Heading {
    /// Angle about +z, rad, 0 = +x, −π to π.
    pub along: f64,
    /// Its rate, rad/s: that of the element under way.
    pub rate: f64,
    /// Its acceleration, rad/s².
    pub acceleration: f64,
}

impl Heading {
    /// At `point` of a path that is travelled with a velocity (m/s) and acceleration (m/s²) along it, `backwards` if the
    /// path is the programmed one reversed. None where it has no direction seen from above.
    ///
    /// With the direction θ(s): θ̇ = θ′·ṡ and θ̈ = θ″·ṡ² + θ′·s̈. Derivatives too large for a number, on arcs too small for
    /// any machine, count as none, like those of the path itself.
    #[inline]
    pub(crate) fn at(
        point: &PathPoint,
        [velocity, acceleration]: [f64; 2],
        backwards: bool,
    ) -> Option<Self> {
        let along = angle(point, backwards)?;
        let derivatives = [point.curvature.xy(), point.curvature_rate.xy(), Vector2::zeros()];
        let [first, second, _] = direction_rates(point.tangent.xy(), derivatives)?;
        let rates = [first * velocity, second * (velocity * velocity) + first * acceleration];
        let [rate, acceleration] =
            if rates.iter().all(|rate| rate.is_finite()) { rates } else { [0.0; 2] };
        Some(Self { along, rate, acceleration })
    }

    /// The direction in which `element` sets off; on one that does so straight up or down, that half-way.
    pub(super) fn of_start(element: &PathElement, backwards: bool) -> Option<f64> {
        if !element.kind.is_motion() {
            return None;
        }
        let at = |s| angle(&element.at(s), backwards);
        at(0.0).or_else(|| at(0.5 * element.length()))
    }

    /// The direction in which `element` arrives.
    fn of_end(element: &PathElement, backwards: bool) -> Option<f64> {
        let moves = element.kind.is_motion();
        moves.then(|| element.at(element.length())).and_then(|point| angle(&point, backwards))
    }
}

/// Memory of the direction of the path.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bearing {
    /// None before the first.
    pub(super) latest: Option<f64>,
    /// The path is the programmed one reversed.
    pub(super) backwards: bool,
}

impl Bearing {
    /// The heading where the path has the direction `now`; if it has none and had none before, that which `ahead` finds.
    pub(super) fn follow(
        &mut self,
        now: Option<Heading>,
        ahead: impl FnOnce() -> Option<f64>,
    ) -> Heading {
        self.latest = now.map(|heading| heading.along).or(self.latest).or_else(ahead);
        now.unwrap_or(Heading { along: self.latest.unwrap_or_default(), ..Heading::default() })
    }

    /// `element` has been passed to its end: the last set-point on it lies up to a cycle before, or there was none.
    pub(super) fn pass(&mut self, element: &PathElement) {
        self.latest = Heading::of_end(element, self.backwards).or(self.latest);
    }
}

fn angle(point: &PathPoint, backwards: bool) -> Option<f64> {
    let ahead = point.tangent.xy();
    direction(if backwards { -ahead } else { ahead })
}

/// The angle of a tangent seen from above, rad, 0 = +x, −π to π; none where it goes straight up or down.
pub(crate) fn direction(tangent: Vector2<f64>) -> Option<f64> {
    // Without −0: it is on the other side of the cut along −x.
    (tangent.norm() > UPRIGHT).then(|| (tangent.y + 0.0).atan2(tangent.x))
}
