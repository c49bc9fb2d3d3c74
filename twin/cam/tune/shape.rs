//! Points of a cam moved within tolerances, in the units of the axes.

use super::super::check::CamUse;
use super::{TuneError, same};
use twin_cam::tune::{Tolerance, Wish, reshape, soften};
use twin_cam::{Element, Knot, Quantity, Shape, SlaveLimits, Source};
use twin_machine::cam_file::CamFile;

/// A shape before and after, with what it was made for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shaped {
    pub(crate) knots: Vec<Knot>,
    /// The largest velocity of the master, or the peak of the slave, before.
    pub(crate) before: f64,
    /// The same afterwards.
    pub(crate) after: f64,
    /// What limits it now, and where the master is then.
    pub(crate) limited: Option<(Quantity, f64)>,
    pub(crate) programs: usize,
}

/// What a shape is to be best in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ShapeGoal {
    /// The largest velocity of the master.
    Speed,
    /// The smallest peak of the slave's acceleration or jerk at the master's velocity.
    Peak(Quantity),
}

/// Which points may be moved, and by how much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PointTolerance {
    /// Master of the point; `None`: all of them.
    pub(crate) master: Option<f64>,
    pub(crate) tolerance: Tolerance,
}

/// Moves points of the cam. The slave stays where it is at every tappet, and points keep their masters.
/// [`TuneError`] if there are no such points, or nothing limits the slave.
pub(crate) fn shape(
    file: &CamFile,
    using: &CamUse,
    points: &[PointTolerance],
    goal: ShapeGoal,
) -> Result<Shaped, TuneError> {
    let Shape::Polynomial(knots) = file.cam.shape() else { return Err(TuneError::NoPoints) };
    let tolerances = tolerances(file.source.as_ref(), knots, points)?;
    let factors = using.factors();
    let (fast, far) = (factors.master.abs(), factors.slave.abs());
    let SlaveLimits { velocity, acceleration, jerk } = using.limits.motion;
    // On the scale of the cam: the limits of y, and the master as the cam sees it.
    let wish = Wish {
        tolerances,
        held: file.cam.tappets().iter().map(|tappet| tappet.master).collect(),
        limits: SlaveLimits {
            velocity: velocity / far,
            acceleration: acceleration / far,
            jerk: jerk / far,
        },
        position: positions(file, using),
        master_acceleration: using.master.acceleration * fast,
        master_jerk: using.master.jerk * fast,
        repeated: using.repeated,
    };
    match goal {
        ShapeGoal::Speed => {
            // What the check refuses is refused in the same numbers: those of the axes.
            file.cam
                .curve()
                .largest_master_velocity(
                    &using.limits.motion,
                    &using.master,
                    factors,
                    using.repeated,
                )
                .map_err(TuneError::TooFast)?;
            let found = reshape(knots, &wish)?;
            Ok(Shaped {
                knots: found.knots,
                before: found.before.value / fast,
                after: found.after.value / fast,
                limited: found
                    .after
                    .limited
                    .map(|(quantity, place)| (quantity, using.master_at(place))),
                programs: found.programs,
            })
        }
        ShapeGoal::Peak(quantity) => {
            let found = soften(knots, &wish, quantity, using.master.velocity * fast)?;
            Ok(Shaped {
                knots: found.knots,
                before: found.before.value * far,
                after: found.after.value * far,
                limited: Some((quantity, using.master_at(found.after.master))),
                programs: found.programs,
            })
        }
    }
}

/// Limits of the slave's position on the scale of the cam; none of a cam that gains in every pass, which goes everywhere.
fn positions(file: &CamFile, using: &CamUse) -> [f64; 2] {
    if using.repeated && file.cam.curve().rise() != 0.0 {
        return [f64::NEG_INFINITY, f64::INFINITY];
    }
    let input = &using.coupling.input;
    let [one, other] =
        using.limits.position.map(|limit| (limit - input.slave_offset) / input.slave_scaling);
    [one.min(other), one.max(other)]
}

/// One for every point; the ends of lines have none.
fn tolerances(
    source: Option<&Source>,
    knots: &[Knot],
    points: &[PointTolerance],
) -> Result<Vec<Tolerance>, TuneError> {
    let on_line = |master: f64| {
        source.is_some_and(|source| {
            source.elements.iter().any(|element| match element {
                Element::Line { from, to } => same(from[0], master) || same(to[0], master),
                Element::Point(_) => false,
            })
        })
    };
    let mut found = vec![Tolerance::default(); knots.len()];
    for point in points {
        let mut any = false;
        for (slot, knot) in found.iter_mut().zip(knots) {
            let meant = point
                .master
                .is_none_or(|master| (master - knot.master).abs() <= 1e-9 * master.abs().max(1.0));
            if meant && !on_line(knot.master) {
                *slot = point.tolerance;
                any = true;
            }
        }
        if let (false, Some(master)) = (any, point.master) {
            let masters = knots.iter().map(|knot| knot.master);
            let points = masters.filter(|master| !on_line(*master)).collect();
            return Err(TuneError::NoPoint { master, points });
        }
    }
    Ok(found)
}
