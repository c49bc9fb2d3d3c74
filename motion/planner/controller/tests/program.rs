//! Builder of test paths out of lines and arcs, by hand and at random.

use crate::controller::{
    DEFAULT_CYCLE_NS, Interpolator, IpoError, LookAhead, PlannedElement, ToolSetpoint,
};
use nalgebra::{Point3, Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use std::num::NonZeroUsize;
use twin_path::Place;
use twin_path::prepare::{CheckError, CheckVelocities};
use twin_path::{Arc, Cubic, Details, ElementKind, Ellipse, PathElement, Shape, Switch};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Error {
    Check(CheckError),
    Ipo(IpoError),
    Upstream(u32),
}

impl From<IpoError> for Error {
    fn from(error: IpoError) -> Self {
        Error::Ipo(error)
    }
}

impl From<CheckError> for Error {
    fn from(error: CheckError) -> Self {
        Error::Check(error)
    }
}

pub(super) type Elements = Vec<Result<PathElement, Error>>;

/// Appends elements to one another; heading and limits stay until they are changed.
#[derive(Clone, Debug)]
pub(super) struct Pen {
    pub(super) elements: Elements,
    pub(super) at: Point3<f64>,
    /// Direction in the plane, rad.
    pub(super) heading: f64,
    pub(super) feed: f64,
    pub(super) acceleration: f64,
    pub(super) deceleration: f64,
}

impl Pen {
    pub(super) fn new(feed: f64, acceleration: f64, deceleration: f64) -> Self {
        let at = Point3::origin();
        Self { elements: Vec::new(), at, heading: 0.0, feed, acceleration, deceleration }
    }

    fn push(&mut self, kind: ElementKind, shape: Shape) {
        let line = u32::try_from(self.elements.len()).unwrap() + 1;
        let place = Place { block: Some(10 * line), ..Place::at(line) };
        self.elements.push(Ok(PathElement {
            feed: self.feed,
            acceleration: self.acceleration,
            deceleration: self.deceleration,
            ..PathElement::new(place, kind, shape)
        }));
    }

    fn straight(&mut self, kind: ElementKind, by: Vector3<f64>) {
        let (start, end) = (self.at, self.at + by);
        self.push(kind, Shape::Line { start, end });
        self.at = end;
    }

    fn ahead(&self, length: f64) -> Vector3<f64> {
        Vector3::new(self.heading.cos(), self.heading.sin(), 0.0) * length
    }

    pub(super) fn line(&mut self, length: f64) -> &mut Self {
        self.straight(ElementKind::Cut, self.ahead(length));
        self
    }

    pub(super) fn rapid(&mut self, length: f64) -> &mut Self {
        self.straight(ElementKind::Rapid, self.ahead(length));
        self
    }

    /// Straight up, or down.
    pub(super) fn lift(&mut self, rise: f64) -> &mut Self {
        self.straight(ElementKind::Cut, Vector3::z() * rise);
        self
    }

    pub(super) fn jump(&mut self, by: [f64; 3]) -> &mut Self {
        self.straight(ElementKind::Jump, by.into());
        self
    }

    pub(super) fn turn(&mut self, angle: f64) -> &mut Self {
        self.heading += angle;
        self
    }

    /// Tangential arc, `sweep` positive to the left.
    pub(super) fn arc(&mut self, radius: f64, sweep: f64, rise: f64) -> &mut Self {
        let to_center = self.heading + PI.copysign(sweep) / 2.0;
        let center = self.at + Vector3::new(to_center.cos(), to_center.sin(), 0.0) * radius;
        let start_angle = to_center + PI;
        let end_angle = start_angle + sweep;
        let end = center + Vector3::new(end_angle.cos() * radius, end_angle.sin() * radius, rise);
        self.push(ElementKind::Cut, Shape::Arc(Arc::new(self.at, end, center, sweep)));
        self.at = end;
        self.heading += sweep;
        self
    }

    /// Waits for M function `number`.
    pub(super) fn m(&mut self, number: u16) -> &mut Self {
        self.straight(ElementKind::MFunction { number }, Vector3::zeros());
        self
    }

    /// Waits for a time.
    pub(super) fn dwell(&mut self, time_ns: i64) -> &mut Self {
        self.straight(ElementKind::Dwell { time_ns }, Vector3::zeros());
        self
    }

    /// The details of the latest element.
    pub(super) fn details(&mut self) -> &mut Details {
        let latest = self.elements.last_mut().unwrap().as_mut().unwrap();
        latest.details.get_or_insert_default()
    }

    /// A switch point on the latest element.
    pub(super) fn switch(&mut self, number: u8, on: bool, at: f64) -> &mut Self {
        assert!(self.details().switches.add(Switch { number, on, at }));
        self
    }

    /// Tangential piece of an ellipse whose half axes are `across` and `along` the heading, `sweep` (eccentric angle)
    /// positive to the left.
    pub(super) fn ellipse(&mut self, across: f64, along: f64, sweep: f64) -> &mut Self {
        let normal =
            Vector2::new(-self.heading.sin(), self.heading.cos()) * 1.0_f64.copysign(sweep);
        let center = self.at.xy() + normal * across;
        let major = -normal * across;
        let left = Vector2::new(-major.y, major.x) / across;
        let end = center + major * sweep.cos() + left * (along * sweep.sin());
        let end = Point3::new(end.x, end.y, self.at.z);
        let ellipse = Ellipse::new(self.at, end, center, major, along, sweep);
        self.curve(Shape::Ellipse(Box::new(ellipse)))
    }

    /// Tangential cubic of about `length` that turns by `angle`.
    pub(super) fn cubic(&mut self, length: f64, angle: f64) -> &mut Self {
        let ahead = |heading: f64| Vector2::new(heading.cos(), heading.sin()) * length;
        let chord = ahead(self.heading + 0.5 * angle);
        let end = self.at + Vector3::new(chord.x, chord.y, 0.0);
        let tangents = [self.heading, self.heading + angle].map(ahead);
        let cubic = Cubic::hermite(self.at, end, tangents[0], tangents[1]);
        self.curve(Shape::Cubic(Box::new(cubic)))
    }

    fn curve(&mut self, shape: Shape) -> &mut Self {
        let tangent = shape.end_tangent();
        self.at = shape.end();
        self.heading = tangent.y.atan2(tangent.x);
        self.push(ElementKind::Cut, shape);
        self
    }

    pub(super) fn fail(&mut self, code: u32) -> &mut Self {
        self.elements.push(Err(Error::Upstream(code)));
        self
    }

    pub(super) fn feed(&mut self, feed: f64) -> &mut Self {
        self.feed = feed;
        self
    }

    pub(super) fn take(&mut self) -> Elements {
        std::mem::take(&mut self.elements)
    }
}

/// Turns up to here are passed without a stop in all these tests, rad.
const ANGLE_TOLERANCE: f64 = 0.1;

pub(super) type Checked = CheckVelocities<std::vec::IntoIter<Result<PathElement, Error>>, Error>;

pub(super) fn checked(elements: Elements) -> Checked {
    CheckVelocities::new(elements.into_iter(), ANGLE_TOLERANCE)
}

pub(super) fn planned(elements: Elements) -> LookAhead<Checked, Error> {
    LookAhead::new(checked(elements))
}

pub(super) fn planned_within(
    elements: Elements,
    window: usize,
) -> impl Iterator<Item = Result<PlannedElement, Error>> {
    LookAhead::with_window(checked(elements), NonZeroUsize::new(window).unwrap())
}

pub(super) fn run(elements: Elements) -> Interpolator<LookAhead<Checked, Error>, Error> {
    Interpolator::new(planned(elements), DEFAULT_CYCLE_NS)
}

pub(super) fn setpoints(elements: Elements) -> Vec<ToolSetpoint> {
    run(elements).map(Result::unwrap).collect()
}

/// 10 to the power of `exponents`, uniformly.
pub(super) fn magnitude(exponents: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    exponents.prop_map(|exponent| 10_f64.powf(exponent))
}

/// One step of a random program.
#[derive(Clone, Copy, Debug)]
enum Step {
    Line(f64),
    Rapid(f64),
    Arc { radius: f64, sweep: f64, rise: f64 },
    Ellipse { across: f64, along: f64, sweep: f64 },
    Cubic { length: f64, angle: f64 },
    Turn(f64),
    Limits { feed: f64, acceleration: f64, deceleration: f64 },
    Repeat,
    Jump,
}

/// Random programs of lines, arcs and helices of 0.05 mm to 30 mm, F 1 mm/s to 500 mm/s, E 20 mm/s² to 20 m/s²;
/// most transitions are smooth, some turn a little, some stop.
pub(super) fn programs() -> impl Strategy<Value = Elements> {
    prop_oneof![programs_of(false, false), programs_of(true, false)]
}

/// The same with ellipses and cubics.
pub(super) fn curved_programs() -> impl Strategy<Value = Elements> {
    prop_oneof![programs_of(false, true), programs_of(true, true)]
}

/// The same without jumps, rapids and elements of length zero.
pub(super) fn smooth_programs() -> impl Strategy<Value = Elements> {
    programs_of(false, false)
}

fn programs_of(stops: bool, curves: bool) -> impl Strategy<Value = Elements> {
    let length = || magnitude(-4.3..-1.5);
    let (rare, curved) = (u32::from(stops), 3 * u32::from(curves));
    let step = prop_oneof![
        8 => length().prop_map(Step::Line),
        6 => (magnitude(-3.5..-1.5), magnitude(-2.0..TAU.log10()), any::<bool>(), -1e-3..1e-3).prop_map(
            |(radius, sweep, left, rise)| {
                let sweep = if left { sweep } else { -sweep };
                // A climb that turns the tangent by less than the tolerance.
                Step::Arc { radius, sweep, rise: 10.0 * rise * radius * sweep }
            }
        ),
        3 => (-0.09..0.09).prop_map(Step::Turn),
        2 => (magnitude(-3.0..-0.3), magnitude(-1.7..1.3), magnitude(-1.7..1.3)).prop_map(
            |(feed, acceleration, deceleration)| Step::Limits { feed, acceleration, deceleration }
        ),
        curved => (magnitude(-3.5..-1.7), magnitude(-3.5..-1.7), 0.1..TAU, any::<bool>()).prop_map(
            |(across, along, sweep, left)| {
                Step::Ellipse { across, along, sweep: if left { sweep } else { -sweep } }
            }
        ),
        curved => (length(), -1.5..1.5).prop_map(|(length, angle)| Step::Cubic { length, angle }),
        rare => (0.2..3.0).prop_map(Step::Turn),
        rare => length().prop_map(Step::Rapid),
        rare => Just(Step::Repeat),
        rare => Just(Step::Jump),
    ];
    prop::collection::vec(step, 1..60).prop_map(|steps| {
        let mut pen = Pen::new(0.1, 1.0, 0.5);
        for step in steps {
            match step {
                Step::Line(length) => _ = pen.line(length),
                Step::Rapid(length) => _ = pen.rapid(length),
                Step::Arc { radius, sweep, rise } => _ = pen.arc(radius, sweep, rise),
                Step::Ellipse { across, along, sweep } => _ = pen.ellipse(across, along, sweep),
                Step::Cubic { length, angle } => _ = pen.cubic(length, angle),
                Step::Turn(angle) => _ = pen.turn(angle),
                Step::Limits { feed, acceleration, deceleration } => {
                    (pen.feed, pen.acceleration, pen.deceleration) =
                        (feed, acceleration, deceleration);
                }
                Step::Repeat => _ = pen.line(0.0),
                Step::Jump => _ = pen.jump([0.01, -0.02, 0.005]),
            }
        }
        pen.take()
    })
}
