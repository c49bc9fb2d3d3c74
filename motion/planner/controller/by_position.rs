//! Interpolation by the measured position of an axis (`SMC_XInterpolator`, manual 6.6).

use super::heading::{Bearing, Heading};
use super::setpoint::Status;
use super::switches::SwitchBoard;
use super::{ExtraMotion, Source, ToolSetpoint};
use std::f64::consts::PI;
use std::num::NonZeroU32;
use std::task::Poll;
use twin_path::{ElementKind, PathElement};

/// Direction of the workpiece along X (`eDirection`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum XDirection {
    /// X grows.
    Positive,
    /// X becomes less.
    Negative,
}

/// Follows a path by a workpiece that something else moves along X: the set-point is the point of the path whose X is
/// the measured position less an offset. The other axes then cut the contour while the workpiece passes.
///
/// Every X must occur once on the path, in the order of the direction ([`super::XAmbiguity`] finds where it does not);
/// where the path stands still in X (a step), it is passed in one cycle. Should the workpiece move back, the set-point goes back on the element under way, no
/// further, and switches are not undone. The velocity is the workpiece's: feed, acceleration and profile do not
/// matter (`iVelMode` has no effect), nor does anything wait: there is no M function (`wM`) and no `IPO_WAIT`.
#[derive(Debug)]
pub struct XInterpolator<I> {
    source: I,
    cycle_ns: i64,
    now_ns: i64,
    sign: f64,
    offset: f64,
    element: Option<PathElement>,
    switched: usize,
    board: SwitchBoard,
    /// Path length of the elements done, m.
    done: f64,
    way: f64,
    velocity: f64,
    /// The latest direction of the path, at first that of the workpiece's passage: nothing is looked ahead at.
    bearing: Bearing,
    ended: bool,
}

impl<I, E> XInterpolator<I>
where
    I: Source<Item = Result<PathElement, E>>,
{
    /// Along the path of `source`; `offset` (m, `dXOffset`) is the measured position at which the workpiece's zero lies
    /// at the path's.
    pub fn new(source: I, cycle_ns: NonZeroU32, direction: XDirection, offset: f64) -> Self {
        Self {
            source,
            cycle_ns: i64::from(cycle_ns.get()),
            now_ns: 0,
            sign: if direction == XDirection::Positive { 1.0 } else { -1.0 },
            offset,
            element: None,
            switched: 0,
            board: SwitchBoard::default(),
            done: 0.0,
            way: 0.0,
            velocity: 0.0,
            bearing: Bearing {
                latest: Some(if direction == XDirection::Positive { 0.0 } else { PI }),
                backwards: false,
            },
            ended: false,
        }
    }

    /// The set-point for a measured position `x` (m, of `X_Axis`): `Ready(None)` after the one at the end of the path,
    /// `Pending` as long as there is no path. Ends the path where it is with `abort` (`bAbort`).
    pub fn poll_cycle(&mut self, x: f64, abort: bool) -> Poll<Option<Result<ToolSetpoint, E>>> {
        if self.ended {
            return Poll::Ready(None);
        }
        if self.element.is_none() {
            match self.source.poll_next() {
                Poll::Ready(Some(Ok(element))) => self.element = Some(element),
                Poll::Ready(Some(Err(error))) => return self.fail(error),
                Poll::Ready(None) => {
                    self.ended = true;
                    return Poll::Ready(None);
                }
                Poll::Pending => return Poll::Pending,
            }
        }
        let first = self.now_ns == 0;
        let along = self.sign * (x - self.offset);
        while let Some(element) = &self.element {
            if along < self.sign * element.end().x {
                break;
            }
            match self.source.poll_next() {
                Poll::Ready(Some(Ok(next))) => {
                    self.done += element.length();
                    self.bearing.pass(element);
                    self.board.pass_all(element.switches(), &mut self.switched);
                    self.element = Some(next);
                    self.switched = 0;
                }
                Poll::Ready(Some(Err(error))) => return self.fail(error),
                Poll::Ready(None) => {
                    self.ended = true;
                    break;
                }
                // It stays at the end of what there is.
                Poll::Pending => break,
            }
        }
        self.ended = self.ended || abort;
        Poll::Ready(self.setpoint(along, first).map(Ok))
    }

    fn fail(&mut self, error: E) -> Poll<Option<Result<ToolSetpoint, E>>> {
        self.ended = true;
        Poll::Ready(Some(Err(error)))
    }

    #[expect(clippy::cast_precision_loss, reason = "a cycle is shorter than 5 s")]
    fn setpoint(&mut self, along: f64, first: bool) -> Option<ToolSetpoint> {
        let element = self.element.as_ref()?;
        let s = place(element, self.sign, along);
        let cycle = self.cycle_ns as f64 * 1e-9;
        let way = self.done + s;
        let velocity = if first { 0.0 } else { (way - self.way) / cycle };
        let acceleration = (velocity - self.velocity) / cycle;
        let point = element.at(s);
        let now = Heading::at(&point, [velocity, acceleration], false);
        let heading = self.bearing.follow(now.filter(|_| element.kind.is_motion()), || None);
        let mut extra = ExtraMotion::default();
        if let Some(at) = element.extra_at(s) {
            extra.position = at.position;
            for (slot, first) in extra.velocity.iter_mut().zip(at.first) {
                *slot = first * velocity;
            }
            let derivatives = at.first.iter().zip(at.second);
            for (slot, (first, second)) in extra.acceleration.iter_mut().zip(derivatives) {
                *slot = second * (velocity * velocity) + first * acceleration;
            }
        }
        self.board.pass(element.switches(), &mut self.switched, s, element.length());
        let status = if self.ended {
            Status::Finished
        } else {
            Status::of_acceleration(acceleration * velocity)
        };
        let time_ns = self.now_ns;
        self.now_ns = time_ns.saturating_add(self.cycle_ns);
        (self.way, self.velocity) = (way, velocity);
        Some(ToolSetpoint {
            time_ns,
            place: element.place,
            rapid: element.kind == ElementKind::Rapid,
            probing: element.kind.is_probe(),
            status,
            last_switch: self.board.last,
            m_function: None,
            switches: self.board.states,
            feed: element.feed,
            position: point.position,
            velocity: point.tangent * velocity,
            acceleration: point.curvature * (velocity * velocity) + point.tangent * acceleration,
            path_velocity: velocity,
            way,
            heading,
            extra,
        })
    }
}

/// Path length at which the X of `element`, times `sign`, is `along`: by bisection, since X grows along it.
fn place(element: &PathElement, sign: f64, along: f64) -> f64 {
    let length = element.length();
    if along <= sign * element.start().x {
        return 0.0;
    }
    if along >= sign * element.end().x {
        return length;
    }
    let (mut low, mut high) = (0.0, length);
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if sign * element.at(middle).position.x <= along {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}
